//! The `coif` command: arguments, exit codes, and the only code that prints.
//!
//! Everything for people goes to standard error; standard output carries only what another program may read.

mod args;
mod barrier;
mod progress;
mod proof;
mod proof_text;
mod show;
mod text;
mod watch;

use std::collections::BTreeMap;
use std::io::{IsTerminal, Write};
use std::process::ExitCode;
use std::sync::Arc;

use clap::Parser;

use crate::export::{Format, StrandForm};
use crate::render::SheetOptions;
use crate::script::{self, Disk, Ending, Outcome, show_all};
use crate::workbench::{self, Films, NewError, RunError, RunOptions};

use args::{ApiArguments, Arguments, Command, NewArguments, ParamsArguments, RunArguments, ScriptArguments};
use progress::Progress;
use show::Show;

/// Done.
const DONE: u8 = 0;
/// The script, or a file that it asked for, is at fault.
const SCRIPT: u8 = 1;
/// The command line is at fault.
const USAGE: u8 = 2;
/// A file could not be written.
const WRITE: u8 = 3;
/// An error in Coif itself.
const INTERNAL: u8 = 70;
/// Cancelled.
const CANCELLED: u8 = 130;

/// Runs the command line of this process.
pub fn main() -> ExitCode {
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(e) => {
            // `--help` and `--version` arrive here too.
            let code = if e.use_stderr() { USAGE } else { DONE };
            let _ = e.print();
            return ExitCode::from(code);
        }
    };
    ExitCode::from(match arguments.command {
        Command::Run(run) => command_run(&run),
        Command::Watch(arguments) => watch::watch(&arguments),
        Command::Params(params) => command_params(&params),
        Command::New(new) => command_new(&new),
        Command::Api(api) => command_api(&api),
        Command::Sheet(sheet) => proof::command_sheet(&sheet),
        Command::Test(test) => proof::command_test(&test),
        Command::Diff(diff) => proof::command_diff(&diff),
    })
}

/// What the arguments ask for; `samples` per pixel along each side when they do not say.
fn run_options(arguments: &RunArguments, samples: u32) -> RunOptions {
    RunOptions {
        script: script_options(&arguments.script),
        out: arguments.out.clone(),
        debug: arguments.debug,
        background: arguments.background,
        views: arguments.views.clone(),
        sheet: SheetOptions {
            width: arguments.size,
            height: arguments.size * 9 / 8,
            supersample: arguments.samples.unwrap_or(samples),
            ..SheetOptions::default()
        },
        strands: arguments.strands,
        tolerance: arguments.tolerance,
        motion: arguments.motion,
        guides: arguments.guides && arguments.strands != StrandForm::None,
        formats: formats(&arguments.format),
        films: Films { moving: !arguments.still, turntable: arguments.turntable },
        count_inside: arguments.stats,
        triangles: arguments.triangles.map(|n| n as usize),
    }
}

/// Each once, in the order given.
fn formats(given: &[Format]) -> Vec<Format> {
    let mut formats = vec![];
    for &format in given {
        if !formats.contains(&format) {
            formats.push(format);
        }
    }
    formats
}

fn command_run(arguments: &RunArguments) -> u8 {
    let options = run_options(arguments, SheetOptions::default().supersample);
    let progress = Arc::new(Progress::new(!arguments.quiet));
    let bar = Arc::clone(&progress);
    let report = match barrier::run(&arguments.script, move |task| {
        workbench::run(&options, Arc::new(Disk), &bar.listen(task))
    }) {
        Ok(report) => report,
        Err(code) => return code,
    };
    progress.end();
    tell(&report.outcome);
    match &report.written {
        Ok(written) => {
            if !arguments.quiet {
                say(&text::summary(&report, written, arguments.timings));
            }
            if let Some((protocol, file)) = arguments.show.and_then(Show::protocol).zip(show::first(written)) {
                let _ = std::io::stderr().write_all(&show::picture(file, protocol, 2));
            }
            if arguments.stats {
                print(&text::stats(&report, written));
            }
            DONE
        }
        Err(RunError::Script) => SCRIPT,
        Err(RunError::Cancelled) => {
            say("cancelled; nothing was written\n");
            CANCELLED
        }
        Err(RunError::Write(error)) => {
            say(&format!("error: {error}\n"));
            WRITE
        }
        Err(error @ (RunError::Render(_) | RunError::Png(_) | RunError::Export(_) | RunError::Budget(_))) => {
            say(&format!("error: {error}; nothing was written\n"));
            SCRIPT
        }
    }
}

fn command_params(arguments: &ParamsArguments) -> u8 {
    let options = script_options(&arguments.script);
    let outcome = match barrier::run(&arguments.script, move |task| script::run(&options, Arc::new(Disk), task)) {
        Ok(outcome) => outcome,
        Err(code) => return code,
    };
    tell(&outcome);
    match outcome.ending {
        Ending::Done => {
            print(&if arguments.json { text::parameters_json(&outcome) } else { text::parameters(&outcome) });
            DONE
        }
        Ending::Failed => SCRIPT,
        Ending::Cancelled => CANCELLED,
    }
}

fn command_new(arguments: &NewArguments) -> u8 {
    match workbench::new(&arguments.folder) {
        Ok(files) => {
            say(&text::made(&arguments.folder, &files));
            DONE
        }
        Err(error) => {
            say(&format!("error: {error}\n"));
            if matches!(error, NewError::Name(_)) { USAGE } else { WRITE }
        }
    }
}

fn command_api(arguments: &ApiArguments) -> u8 {
    match workbench::api(&arguments.out) {
        Ok(written) => {
            say(&format!("{:>8}  {} files in {}\n", "wrote", written.len(), arguments.out.display()));
            DONE
        }
        Err(error) => {
            say(&format!("error: {error}\n"));
            WRITE
        }
    }
}

fn script_options(arguments: &ScriptArguments) -> script::Options {
    script::Options {
        set: arguments.set.iter().cloned().collect::<BTreeMap<_, _>>(),
        seed: arguments.seed,
        head: arguments.head.clone(),
        head_unit: arguments.head_unit,
        allow: arguments.allow.clone(),
        time_limit: arguments.limits.time_limit,
        limits: arguments.limits.limits(),
        ..script::Options::new(&arguments.script)
    }
}

/// What the script printed, and what was wrong with it.
fn tell(outcome: &Outcome) {
    for line in &outcome.log {
        say(&format!("{line}\n"));
    }
    say(&show_all(&outcome.diagnostics, &outcome.sources, is_styled()));
}

/// True when standard error is a terminal whose owner wants colours.
fn is_styled() -> bool {
    std::io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none_or(|v| v.is_empty())
}

/// To standard error; a reader that went away is not our business.
fn say(text: &str) {
    let _ = std::io::stderr().write_all(text.as_bytes());
}

/// To standard output.
fn print(text: &str) {
    let mut out = std::io::stdout().lock();
    let _ = out.write_all(text.as_bytes()).and_then(|()| out.flush());
}
