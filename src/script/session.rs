//! What one run knows: options, files, and everything that is collected on the way.

use std::cell::{Cell, RefCell};
use std::collections::BTreeMap;
use std::fmt;
use std::path::PathBuf;
use std::rc::Rc;
use std::sync::Arc;
use std::time::Duration;

use mlua::Lua;

use super::files::{Access, Files};
use super::limits::Need;
use super::memo::Origin;
use super::{Diagnostic, Options, Parameter, Sources};
use crate::head::Head;
use crate::task::Task;

/// Errors on their way out of a binding, through Lua, to the host.
#[derive(Clone, Debug)]
pub struct Raised(pub Vec<Diagnostic>);

impl Raised {
    /// The diagnostics in an error that has travelled through Lua.
    pub fn inside(error: &mlua::Error) -> Option<Self> {
        match error {
            mlua::Error::ExternalError(e) => e.downcast_ref::<Self>().cloned(),
            mlua::Error::CallbackError { cause, .. } | mlua::Error::WithContext { cause, .. } => Self::inside(cause),
            _ => None,
        }
    }
}

/// What a script sees that catches one with `pcall`.
impl fmt::Display for Raised {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let lines: Vec<String> = self.0.iter().map(ToString::to_string).collect();
        f.write_str(&lines.join("\n"))
    }
}

impl std::error::Error for Raised {}

impl From<Raised> for mlua::Error {
    fn from(raised: Raised) -> Self {
        Self::external(raised)
    }
}

/// Time that one call took.
#[derive(Clone, Debug)]
pub struct Timing {
    /// What was called: `Guides:grow`.
    pub what: String,
    /// Where: `ponytail.lua:17`.
    pub source: String,
    /// How long it took.
    pub time: Duration,
    /// Whether the memo had what is worth keeping of it; none where there is nothing worth keeping. A call with several
    /// such parts was computed when any of them was.
    pub origin: Option<Origin>,
}

/// How strands that were let settle came to rest.
#[derive(Clone, Debug, PartialEq)]
pub struct Rest {
    /// Where they were: `bundle.lua:16`.
    pub source: String,
    /// How many they are.
    pub strands: usize,
    /// How many of them still moved when the limit was reached; 0 when all came to rest.
    pub moving: usize,
    /// Simulated time until then, s.
    pub seconds: f32,
    /// Steps until then.
    pub steps: usize,
}

/// What a draft leaves out; in any other run nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Thinned {
    /// Members that the fills gave.
    pub members: usize,
    /// Members that they give in full.
    pub of: usize,
    /// How many of those in full the memo does not have yet.
    pub pending: usize,
}

/// The state of one run, shared by all bindings.
pub struct Session {
    /// What the run was asked for.
    pub options: Options,
    /// Files, confined and recorded.
    pub access: Access,
    /// To be polled by long computations.
    pub task: Task,
    /// Scripts read so far.
    pub sources: RefCell<Sources>,
    /// Warnings so far.
    pub warnings: RefCell<Vec<Diagnostic>>,
    /// Lines printed so far.
    pub log: RefCell<Vec<String>>,
    /// Bytes printed so far.
    pub logged: Cell<usize>,
    /// Parameters declared so far, in order.
    pub parameters: RefCell<Vec<Parameter>>,
    /// Calls that took time, in order.
    pub timings: RefCell<Vec<Timing>>,
    /// How strands came to rest, in order.
    pub rests: RefCell<Vec<Rest>>,
    /// What all calls so far have made or are about to make.
    pub claimed: Cell<Need>,
    /// What a draft has left out so far.
    pub thinned: Cell<Thinned>,
    /// Heads made so far, by what was asked for.
    pub heads: RefCell<BTreeMap<String, Arc<Head>>>,
    /// Heads whose hair is carried to another one at the end: (from, to).
    pub carries: RefCell<Vec<(Arc<Head>, Arc<Head>)>>,
}

/// The session of a VM.
///
/// # Errors
/// When the VM has none, which the host rules out.
pub fn session(lua: &Lua) -> mlua::Result<Rc<Session>> {
    lua.app_data_ref::<Rc<Session>>().map(|s| Rc::clone(&s)).ok_or_else(|| mlua::Error::runtime("no session"))
}

impl Session {
    /// A run that is about to begin. It may read below the script's folder, below `more`, and what its options allow.
    pub fn new(options: &Options, files: Arc<dyn Files>, more: impl IntoIterator<Item = PathBuf>, task: &Task) -> Self {
        let allowed = [options.folder()].into_iter().chain(options.allow.clone()).chain(options.head.clone());
        Self {
            options: options.clone(),
            access: Access::new(files, allowed.chain(more)),
            task: task.clone(),
            sources: RefCell::default(),
            warnings: RefCell::default(),
            log: RefCell::default(),
            logged: Cell::new(0),
            parameters: RefCell::default(),
            timings: RefCell::default(),
            rests: RefCell::default(),
            claimed: Cell::default(),
            thinned: Cell::default(),
            heads: RefCell::default(),
            carries: RefCell::default(),
        }
    }

    /// Notes a warning, once.
    pub fn warn(&self, warning: Diagnostic) {
        let mut warnings = self.warnings.borrow_mut();
        if !warnings.contains(&warning) {
            warnings.push(warning);
        }
    }
}
