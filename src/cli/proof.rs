//! `coif sheet`, `coif test` and `coif diff`: their arguments and what they do.

use std::path::PathBuf;
use std::sync::Arc;

use clap::Args;

use super::args::{LimitArguments, ScriptArguments, background, view};
use super::{CANCELLED, DONE, SCRIPT, USAGE, WRITE, barrier, is_styled, print, proof_text, say, script_options, tell};
use crate::render::SheetOptions;
use crate::scene::{Background, View};
use crate::script::{Disk, Files, Options};
use crate::workbench::diff::{DiffOptions, diff};
use crate::workbench::sheet::{ContactOptions, contact_sheet, count_cells};
use crate::workbench::test::{TestError, TestOptions, junit, test};
use crate::workbench::variations::Variation;
use crate::workbench::{Output, RunError, write_all};

/// `coif sheet`.
#[derive(Args, Debug)]
pub struct SheetArguments {
    #[command(flatten)]
    pub script: ScriptArguments,
    /// Vary a parameter, or `seed`: length=20..60:5, seed=1..4, style=a,b,c. The first goes across, the others down
    #[arg(long, value_name = "NAME=VALUES", value_parser = variation, required_unless_present = "turntable")]
    pub vary: Vec<Variation>,
    /// Views around the head instead of one
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=360))]
    pub turntable: Option<u32>,
    /// View of every picture; the script's first one by default
    #[arg(long, value_name = "VIEW", value_parser = view, conflicts_with = "turntable")]
    pub view: Option<View>,
    /// Width of one picture in pixels
    #[arg(long, value_name = "PX", default_value_t = 280, value_parser = clap::value_parser!(u32).range(16..=4096))]
    pub size: u32,
    /// Fit every picture to its own style, as `coif run` does, instead of showing all at one scale
    #[arg(long)]
    pub fit: bool,
    /// Background, instead of the script's [white, dark]
    #[arg(long, value_name = "COLOUR", value_parser = background)]
    pub background: Option<Background>,
    /// Folder for the output, NAME.sheet.png
    #[arg(short, long, value_name = "DIR", default_value = "out")]
    pub out: PathBuf,
    /// Print errors and warnings only
    #[arg(short, long)]
    pub quiet: bool,
}

/// `coif test`.
#[derive(Args, Debug)]
pub struct TestArguments {
    /// A test file, or a folder to search for *_test.lua
    #[arg(default_value = ".")]
    pub path: PathBuf,
    /// Run only tests whose name or file contains this
    #[arg(long, value_name = "TEXT")]
    pub filter: Option<String>,
    /// Keep the previews as the new golden pictures; the run still fails, so that nothing passes unseen
    #[arg(long)]
    pub accept: bool,
    /// Write the results as JUnit XML too
    #[arg(long, value_name = "FILE")]
    pub junit: Option<PathBuf>,
    /// Folder for difference pictures, NAME.diff.png
    #[arg(short, long, value_name = "DIR", default_value = "out")]
    pub out: PathBuf,
    /// Let tests and styles read below this folder too; may be repeated
    #[arg(long, value_name = "DIR")]
    pub allow: Vec<PathBuf>,
    #[command(flatten)]
    pub limits: LimitArguments,
    /// Threads to use; all of the machine's by default. The result does not depend on it
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// Print failures and the summary only
    #[arg(short, long)]
    pub quiet: bool,
}

/// `coif diff`.
#[derive(Args, Debug)]
pub struct DiffArguments {
    #[command(flatten)]
    pub script: ScriptArguments,
    /// The style to compare it with: another one, or another version
    pub other: PathBuf,
    /// View of the picture; the script's first one by default
    #[arg(long, value_name = "VIEW", value_parser = view)]
    pub view: Option<View>,
    /// Width of each of the picture's three panels in pixels
    #[arg(long, value_name = "PX", default_value_t = 480, value_parser = clap::value_parser!(u32).range(16..=4096))]
    pub size: u32,
    /// Folder for the picture, A_B.diff.png: before, changes, after
    #[arg(short, long, value_name = "DIR", default_value = "out")]
    pub out: PathBuf,
    /// Print the changes as one JSON object on standard output
    #[arg(long)]
    pub json: bool,
    /// List every changed strand by its id in that object
    #[arg(long, requires = "json")]
    pub each: bool,
    /// Draw no picture
    #[arg(long)]
    pub no_picture: bool,
}

fn variation(text: &str) -> Result<Variation, String> {
    Variation::parse(text).map_err(|e| e.to_string())
}

fn cell(size: u32) -> SheetOptions {
    SheetOptions { width: size, height: size * 9 / 8, lettering: false, ..SheetOptions::default() }
}

/// Runs `coif sheet`.
pub fn command_sheet(arguments: &SheetArguments) -> u8 {
    let twice = arguments.vary.iter().enumerate().find(|(i, v)| arguments.vary[..*i].iter().any(|w| w.name == v.name));
    if let Some((_, v)) = twice {
        say(&format!("error: `--vary {}` is given twice\n", v.name));
        return USAGE;
    }
    if let Err(message) = count_cells(&arguments.vary, arguments.turntable) {
        say(&format!("error: {message}\n"));
        return USAGE;
    }
    let bad_seed = |v: &&Variation| v.name == "seed" && v.values.iter().any(|s| s.parse::<u64>().is_err());
    if let Some(v) = arguments.vary.iter().find(bad_seed) {
        say(&format!("error: `--vary seed={}`: seeds are whole numbers, 0 or more\n", v.values.join(",")));
        return USAGE;
    }
    let options = ContactOptions {
        script: script_options(&arguments.script),
        vary: arguments.vary.clone(),
        view: arguments.view,
        turntable: arguments.turntable,
        sheet: cell(arguments.size),
        fit: arguments.fit,
        background: arguments.background,
        out: arguments.out.clone(),
    };
    let quiet = arguments.quiet;
    let report = barrier::run(&arguments.script, move |task| {
        contact_sheet(&options, &disk(), task, |i, all, label| {
            if !quiet {
                say(&format!("{:>8}  {label}\n", format!("{} of {all}", i + 1)));
            }
        })
    });
    let report = match report {
        Ok(report) => report,
        Err(code) => return code,
    };
    let mut told = vec![];
    for (label, outcome) in &report.runs {
        // What every run says alike is said once.
        let text: Vec<String> = outcome.diagnostics.iter().map(ToString::to_string).collect();
        if text.is_empty() || told.contains(&text) {
            continue;
        }
        told.push(text);
        if !label.is_empty() {
            say(&format!("with {label}:\n"));
        }
        tell(outcome);
    }
    match &report.written {
        Ok(written) => {
            if !quiet {
                say(&proof_text::wrote(written));
            }
            DONE
        }
        Err(error) => failed(error),
    }
}

/// Runs `coif test`.
pub fn command_test(arguments: &TestArguments) -> u8 {
    let script = Options {
        allow: arguments.allow.clone(),
        time_limit: arguments.limits.time_limit,
        limits: arguments.limits.limits(),
        ..Options::new(&arguments.path)
    };
    let options = TestOptions {
        path: arguments.path.clone(),
        filter: arguments.filter.clone(),
        accept: arguments.accept,
        out: arguments.out.clone(),
        script,
    };
    let quiet = arguments.quiet;
    let report = barrier::on(arguments.threads, move |task| {
        test(&options, &disk(), task, |result| say(&proof_text::result(result, quiet, is_styled())))
    });
    let report = match report {
        Ok(Ok(report)) => report,
        Ok(Err(TestError::Cancelled)) => {
            say("cancelled\n");
            return CANCELLED;
        }
        Ok(Err(TestError::Write(error))) => {
            say(&format!("error: {error}\n"));
            return WRITE;
        }
        Ok(Err(
            error @ (TestError::Missing(_)
            | TestError::NoTests(_)
            | TestError::NothingLeft(_)
            | TestError::Unreadable { .. }),
        )) => {
            say(&format!("error: {error}\n"));
            return SCRIPT;
        }
        Err(code) => return code,
    };
    say(&proof_text::test_summary(&report));
    if let Some(path) = &arguments.junit {
        let folder = path.parent().map(|p| if p.as_os_str().is_empty() { ".".into() } else { p.to_path_buf() });
        let name = path.file_name().map(|n| n.to_string_lossy().into_owned());
        let (Some(folder), Some(name)) = (folder, name) else {
            say(&format!("error: `--junit {}` is not a file's name\n", path.display()));
            return USAGE;
        };
        if let Err(error) = write_all(&folder, &[Output { name, bytes: junit(&report).into_bytes().into() }]) {
            say(&format!("error: {error}\n"));
            return WRITE;
        }
    }
    if report.is_passed() { DONE } else { SCRIPT }
}

/// Runs `coif diff`.
pub fn command_diff(arguments: &DiffArguments) -> u8 {
    let before = script_options(&arguments.script);
    let options = DiffOptions {
        after: Options { script: arguments.other.clone(), ..before.clone() },
        before,
        view: arguments.view,
        sheet: cell(arguments.size),
        each: arguments.each,
        out: (!arguments.no_picture).then(|| arguments.out.clone()),
    };
    let report = match barrier::run(&arguments.script, move |task| diff(&options, &disk(), task)) {
        Ok(report) => report,
        Err(code) => return code,
    };
    report.outcomes.iter().for_each(tell);
    match &report.result {
        Ok((changes, written)) => {
            if arguments.json {
                print(&proof_text::changes_json(changes, written));
            } else {
                print(&proof_text::changes(changes));
                say(&proof_text::wrote(written));
            }
            DONE
        }
        Err(error) => failed(error),
    }
}

fn disk() -> Arc<dyn Files> {
    Arc::new(Disk)
}

/// Says why nothing was written, and gives the exit code.
fn failed(error: &RunError) -> u8 {
    match error {
        RunError::Script => SCRIPT,
        RunError::Cancelled => {
            say("cancelled; nothing was written\n");
            CANCELLED
        }
        RunError::Write(error) => {
            say(&format!("error: {error}\n"));
            WRITE
        }
        other => {
            say(&format!("error: {other}; nothing was written\n"));
            SCRIPT
        }
    }
}
