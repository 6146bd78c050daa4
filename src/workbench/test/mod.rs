//! `coif test`: finds test files, runs their tests one after the other, compares and keeps golden pictures.

mod golden;
mod junit;

use std::collections::BTreeSet;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use super::output::{Output, WriteError, Written, write_all};
use crate::render::{Speed, png};
use crate::script::{Diagnostic, Files, Options, Place, Sources, TestOutcome, run_test};
use crate::task::Task;

pub use junit::junit;

/// How the name of a test file ends.
pub const ENDING: &str = "_test.lua";

/// What is wanted of `coif test`.
#[derive(Clone, Debug)]
pub struct TestOptions {
    /// A test file, or a folder that is searched for `*_test.lua`, its own folders included.
    pub path: PathBuf,
    /// Only tests whose name, or whose file's name, contains this.
    pub filter: Option<String>,
    /// Keep what was drawn as the new golden pictures.
    pub accept: bool,
    /// Folder for difference pictures.
    pub out: PathBuf,
    /// Limits of each single test; the script in it is not used.
    pub script: Options,
}

/// How a test ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Every expectation held.
    Passed,
    /// Some did not, or there was an error.
    Failed,
    /// Nothing failed but golden pictures, which were written anew: to be looked at and run again.
    Accepted,
}

/// A test that was run.
#[derive(Debug)]
pub struct TestResult {
    /// Its file.
    pub file: PathBuf,
    /// Its name; empty for what is wrong with the file as a whole.
    pub name: String,
    /// Where it stands.
    pub place: Option<Place>,
    /// How it ended.
    pub verdict: Verdict,
    /// What failed, in order.
    pub failures: Vec<Diagnostic>,
    /// Warnings on the way.
    pub warnings: Vec<Diagnostic>,
    /// What was printed.
    pub log: Vec<String>,
    /// Expectations that were checked.
    pub checks: usize,
    /// How long it took.
    pub time: Duration,
    /// The texts that diagnostics speak about.
    pub sources: Sources,
}

/// What came out of `coif test`.
#[derive(Debug, Default)]
pub struct TestReport {
    /// Every test that was run, in order of files and of tests in them.
    pub results: Vec<TestResult>,
    /// Tests that the filter left out.
    pub left_out: usize,
    /// Golden pictures that no test refers to.
    pub unused: Vec<PathBuf>,
    /// Golden pictures that were written.
    pub accepted: Vec<Written>,
    /// Difference pictures that were written.
    pub differences: Vec<Written>,
    /// Every file that was asked for.
    pub dependencies: BTreeSet<PathBuf>,
}

impl TestReport {
    /// How many tests ended like this.
    pub fn count(&self, verdict: Verdict) -> usize {
        self.results.iter().filter(|r| r.verdict == verdict).count()
    }

    /// True when there were tests, all passed, nothing was accepted and no golden picture is unused.
    pub fn is_passed(&self) -> bool {
        !self.results.is_empty() && self.count(Verdict::Passed) == self.results.len() && self.unused.is_empty()
    }
}

/// Why tests could not be run at all.
#[derive(Debug, thiserror::Error)]
pub enum TestError {
    /// There is nothing at the path.
    #[error("there is no file or folder `{}`", .0.display())]
    Missing(PathBuf),
    /// A folder without tests.
    #[error("there is no `*{ENDING}` in `{}`", .0.display())]
    NoTests(PathBuf),
    /// The filter leaves nothing.
    #[error("no test's name contains `{0}`")]
    NothingLeft(String),
    /// Stopped from outside.
    #[error("cancelled")]
    Cancelled,
    /// A folder could not be read.
    #[error("cannot read `{}`: {error}", .path.display())]
    Unreadable {
        /// The folder.
        path: PathBuf,
        /// What the system says.
        error: io::Error,
    },
    /// A picture could not be written.
    #[error(transparent)]
    Write(#[from] WriteError),
}

/// The test files at a path, sorted.
///
/// # Errors
/// A path without tests.
pub fn find(path: &Path) -> Result<Vec<PathBuf>, TestError> {
    if path.is_file() {
        return Ok(vec![path.to_path_buf()]);
    }
    if !path.is_dir() {
        return Err(TestError::Missing(path.to_path_buf()));
    }
    let (mut found, mut folders) = (vec![], vec![path.to_path_buf()]);
    while let Some(folder) = folders.pop() {
        let unreadable = |error| TestError::Unreadable { path: folder.clone(), error };
        for entry in std::fs::read_dir(&folder).map_err(unreadable)? {
            let entry = entry.map_err(unreadable)?;
            let name = entry.file_name().to_string_lossy().into_owned();
            // Not through links: one to a folder above would never end.
            let kind = entry.file_type().map_err(unreadable)?;
            if kind.is_dir() && !name.starts_with('.') {
                folders.push(entry.path());
            } else if name.ends_with(ENDING) && entry.path().is_file() {
                // `./a` reads worse than `a` in messages.
                found.push(entry.path().strip_prefix("./").map(Path::to_path_buf).unwrap_or(entry.path()));
            }
        }
    }
    found.sort();
    if found.is_empty() { Err(TestError::NoTests(path.to_path_buf())) } else { Ok(found) }
}

/// Runs tests; `tell` hears of each as it ends.
///
/// # Errors
/// When nothing could be run, or a picture could not be written. Failed tests are no error here.
pub fn test(
    options: &TestOptions,
    files: &Arc<dyn Files>,
    task: &Task,
    mut tell: impl FnMut(&TestResult),
) -> Result<TestReport, TestError> {
    let found = find(&options.path)?;
    let mut report = TestReport::default();
    let mut goldens = golden::Goldens::default();
    let mut done = |report: &mut TestReport, result: TestResult| {
        tell(&result);
        report.results.push(result);
    };
    for file in &found {
        let started = Instant::now();
        let script = Options { script: file.clone(), ..options.script.clone() };
        let run = |wanted| run_test(&script, wanted, Arc::clone(files), task);
        let listing = run(None);
        goldens.see(file);
        if listing.is_cancelled {
            return Err(TestError::Cancelled);
        }
        report.dependencies.extend(listing.dependencies.iter().cloned());
        let declared = listing.declared.clone();
        let is_broken = !listing.failures.is_empty() || declared.is_empty();
        if is_broken {
            let mut result = result(file, String::new(), None, listing, started.elapsed());
            if result.failures.is_empty() {
                let hint = "declare one: `coif.test(\"what it shows\", function(t) ... end)`";
                result.failures.push(Diagnostic::error(format!("`{}` has no test", file.display())).hint(hint));
                result.verdict = Verdict::Failed;
            }
            goldens.is_complete = false;
            done(&mut report, result);
            continue;
        }
        for (number, test) in declared.into_iter().enumerate() {
            let is_wanted = |f: &String| test.name.contains(f.as_str()) || file.to_string_lossy().contains(f.as_str());
            if !options.filter.as_ref().is_none_or(is_wanted) {
                report.left_out += 1;
                goldens.is_complete = false;
                continue;
            }
            let started = Instant::now();
            let mut outcome = run(Some(number));
            if outcome.is_cancelled {
                return Err(TestError::Cancelled);
            }
            report.dependencies.extend(outcome.dependencies.iter().cloned());
            let previews = std::mem::take(&mut outcome.previews);
            let mut result = result(file, test.name, test.place, outcome, started.elapsed());
            let differing = previews.iter().filter(|p| !p.is_same).count();
            if differing < result.failures.len() && result.verdict == Verdict::Failed {
                goldens.is_complete = false;
            }
            for preview in previews {
                if let Some(failure) = goldens.refer(&preview) {
                    result.failures.push(failure);
                    result.verdict = Verdict::Failed;
                    continue;
                }
                if preview.is_same {
                    continue;
                }
                let bytes = |picture| Arc::new(png::encode(picture, Speed::Balanced).unwrap_or_default());
                if options.accept {
                    let name = format!("{}.png", preview.name);
                    let folder = preview.golden.parent().unwrap_or(Path::new("."));
                    report.accepted.extend(write_all(folder, &[Output { name, bytes: bytes(&preview.actual) }])?);
                    if result.failures.len() == differing {
                        result.verdict = Verdict::Accepted;
                    }
                } else {
                    // Without a golden picture there is only the new one to look at.
                    let (panels, ending) = match &preview.panels {
                        Some(panels) => (panels, "diff.png"),
                        None => (&preview.actual, "new.png"),
                    };
                    let name = format!("{}.{ending}", goldens.out_name(&preview));
                    report.differences.extend(write_all(&options.out, &[Output { name, bytes: bytes(panels) }])?);
                }
            }
            done(&mut report, result);
        }
    }
    match &options.filter {
        Some(filter) if report.results.is_empty() => Err(TestError::NothingLeft(filter.clone())),
        _ => {
            report.unused = goldens.unused(&found);
            Ok(report)
        }
    }
}

fn result(file: &Path, name: String, place: Option<Place>, outcome: TestOutcome, time: Duration) -> TestResult {
    TestResult {
        file: file.to_path_buf(),
        name,
        place,
        verdict: if outcome.failures.is_empty() { Verdict::Passed } else { Verdict::Failed },
        failures: outcome.failures,
        warnings: outcome.warnings,
        log: outcome.log,
        checks: outcome.checks,
        time,
        sources: outcome.sources,
    }
}
