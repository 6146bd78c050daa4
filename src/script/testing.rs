//! Scripted tests: runs a `*_test.lua` file once to learn its tests, then once for each of them.
//!
//! Every test has a VM, a deadline and a seed of its own, so none sees what another left behind, and an error in one
//! stops no other. The test function `coif.test` exists in these runs only.

use std::cell::{Cell, RefCell};
use std::collections::BTreeSet;
use std::path::PathBuf;
use std::rc::Rc;
use std::sync::Arc;

use super::call::Call;
use super::files::Files;
use super::host::{self, Options};
use super::session::{Raised, Session};
use super::{Diagnostic, Place, Severity, Sources, bind};
use crate::render::Picture;
use crate::task::Task;

/// A test that a file declares.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Declared {
    /// What it is called, unique within its file.
    pub name: String,
    /// Where it stands.
    pub place: Option<Place>,
}

/// A picture that a test compared with a golden one.
#[derive(Clone, Debug)]
pub struct Preview {
    /// Its name, without folder and ending.
    pub name: String,
    /// The golden picture's file.
    pub golden: PathBuf,
    /// What was drawn.
    pub actual: Picture,
    /// Expected, mask and actual, when there is a golden picture and it differs.
    pub panels: Option<Picture>,
    /// True when the golden picture is there and the same.
    pub is_same: bool,
    /// Where the test asks for it.
    pub place: Option<Place>,
}

/// What came out of one run of a test file.
#[derive(Debug, Default)]
pub struct TestOutcome {
    /// True when the task was cancelled from outside.
    pub is_cancelled: bool,
    /// Failed expectations and errors, in order; empty when the test passed.
    pub failures: Vec<Diagnostic>,
    /// Warnings of the test file and of the styles that it ran.
    pub warnings: Vec<Diagnostic>,
    /// What was printed.
    pub log: Vec<String>,
    /// Expectations that were checked.
    pub checks: usize,
    /// Tests that the file declares, in order.
    pub declared: Vec<Declared>,
    /// Previews, in order.
    pub previews: Vec<Preview>,
    /// Every file that was asked for, missing ones too.
    pub dependencies: BTreeSet<PathBuf>,
    /// The texts that diagnostics speak about.
    pub sources: Sources,
}

/// The state of one run of a test file, shared by the bindings.
#[derive(Default)]
pub(super) struct Tests {
    /// Number of the test to be run; none to learn their names.
    pub wanted: Option<usize>,
    /// True inside a test.
    pub is_running: Cell<bool>,
    pub declared: RefCell<Vec<Declared>>,
    pub failures: RefCell<Vec<Diagnostic>>,
    pub checks: Cell<usize>,
    pub previews: RefCell<Vec<Preview>>,
    pub dependencies: RefCell<BTreeSet<PathBuf>>,
}

impl Tests {
    /// The state that belongs to a call.
    ///
    /// # Errors
    /// When the call is not made under `coif test`.
    pub fn of(call: &Call) -> Result<Rc<Self>, Raised> {
        Self::in_vm(call.lua()).ok_or_else(|| call.problem("there is no test running", None))
    }

    /// The state of a VM, if it runs tests.
    pub fn in_vm(lua: &mlua::Lua) -> Option<Rc<Self>> {
        lua.app_data_ref::<Rc<Self>>().map(|t| Rc::clone(&t))
    }
}

/// Runs a test file: its test number `wanted` (from 0, in the order declared), or none of them, to learn their names.
///
/// Besides the file's own folder it may read below the current one, where the styles that it tests usually lie.
pub fn run_test(options: &Options, wanted: Option<usize>, files: Arc<dyn Files>, task: &Task) -> TestOutcome {
    let task = task.child();
    let session = Rc::new(Session::new(options, files, [PathBuf::from(".")], &task));
    let tests = Rc::new(Tests { wanted, ..Tests::default() });
    let deadline = super::sandbox::Deadline::start(&task, options.time_limit);
    let result = host::chunk(&session, |lua| {
        lua.set_app_data(Rc::clone(&tests));
        bind::install_for_tests(lua)
    });
    let mut failures = tests.failures.take();
    let is_cancelled = task.is_cancelled() && !deadline.has_passed();
    if deadline.has_passed() {
        failures = vec![host::out_of_time(options)];
    } else if let Err(Raised(diagnostics)) = result {
        failures.extend(diagnostics);
    }
    let mut dependencies = tests.dependencies.take();
    dependencies.extend(session.access.asked());
    TestOutcome {
        is_cancelled,
        failures,
        warnings: session.warnings.take().into_iter().filter(|d| d.severity == Severity::Warning).collect(),
        log: session.log.take(),
        checks: tests.checks.get(),
        declared: tests.declared.take(),
        previews: tests.previews.take(),
        dependencies,
        sources: session.sources.take(),
    }
}
