//! One run of a script, from its text to its scene.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::Arc;
use std::time::Duration;

use mlua::{Lua, MultiValue};

use super::convert::Reading;
use super::files::Files;
use super::sandbox::{Deadline, Interruptible};
use super::session::{Raised, Rest, Session, Thinned, Timing};
use super::{Diagnostic, Limits, Memo, Parameter, Sources, bind, protect, sandbox, trace};
use crate::head::load::Unit;
use crate::params::Value;
use crate::scene::Scene;
use crate::task::Task;

/// What parameters are given by, for messages.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SetBy {
    /// `--set name=value`.
    #[default]
    Option,
    /// The table of `t:run "style.lua" { name = value }`.
    Table,
}

/// What a run is asked for.
#[derive(Clone, Debug)]
pub struct Options {
    /// The script.
    pub script: PathBuf,
    /// Parameters by name, as text.
    pub set: BTreeMap<String, String>,
    /// Seed of all randomness.
    pub seed: u64,
    /// Head that `coif.head()` gives instead of the built-in one.
    pub head: Option<PathBuf>,
    /// What one unit of that head's file is; by its format when not given.
    pub head_unit: Option<Unit>,
    /// Folders and files that may be read besides the script's folder.
    pub allow: Vec<PathBuf>,
    /// Longest time for the script and everything it calls.
    pub time_limit: Duration,
    /// How much it may make.
    pub limits: Limits,
    /// The seed was given by its name among parameters, which may mean a parameter of the script.
    pub names_seed: bool,
    /// What the parameters were given by.
    pub set_by: SetBy,
    /// Most members of each fill, for a draft; the strands are drawn as much wider as there are fewer of them.
    pub draft: Option<usize>,
    /// What earlier runs have computed; runs that share it find it again.
    pub memo: Arc<Memo>,
}

impl Options {
    /// A run of `script` with seed 0, a minute's time and a memo of its own.
    pub fn new(script: impl Into<PathBuf>) -> Self {
        Self {
            script: script.into(),
            set: BTreeMap::new(),
            seed: 0,
            head: None,
            head_unit: None,
            allow: vec![],
            time_limit: Duration::from_secs(60),
            limits: Limits::default(),
            names_seed: false,
            set_by: SetBy::default(),
            draft: None,
            memo: Arc::default(),
        }
    }

    /// The folder of the script; empty for the current one.
    pub fn folder(&self) -> PathBuf {
        self.script.parent().map(Path::to_path_buf).unwrap_or_default()
    }

    /// The script's name without folder and ending: the name of the style.
    pub fn name(&self) -> String {
        self.script.file_stem().map_or_else(|| "style".into(), |s| s.to_string_lossy().into_owned())
    }
}

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// With a scene.
    Done,
    /// With errors.
    Failed,
    /// The task was cancelled from outside.
    Cancelled,
}

/// What came out of a run.
#[derive(Debug)]
pub struct Outcome {
    /// How it ended.
    pub ending: Ending,
    /// The scene, if it is [`Ending::Done`].
    pub scene: Option<Scene>,
    /// Errors and warnings, errors first.
    pub diagnostics: Vec<Diagnostic>,
    /// What the script printed.
    pub log: Vec<String>,
    /// Parameters that it declared, in order.
    pub parameters: Vec<Parameter>,
    /// Every file that it asked for, missing ones too.
    pub dependencies: BTreeSet<PathBuf>,
    /// The texts that diagnostics speak about.
    pub sources: Sources,
    /// Calls that took half a millisecond or more, or whose value the memo keeps, in order.
    pub timings: Vec<Timing>,
    /// How strands that were let settle came to rest, in order.
    pub rests: Vec<Rest>,
    /// What a draft has left out.
    pub thinned: Thinned,
}

/// Runs a script. The task is spent afterwards: running out of time cancels it.
pub fn run(options: &Options, files: Arc<dyn Files>, task: &Task) -> Outcome {
    run_session(&Rc::new(Session::new(options, files, [], task)))
}

/// Runs the script of a session.
pub(super) fn run_session(session: &Rc<Session>) -> Outcome {
    let (options, task) = (&session.options, &session.task);
    let deadline = Deadline::start(task, options.time_limit);
    let result = script(session).and_then(|scene| unknown_parameters(session).map(|()| scene));
    let (ending, scene, mut diagnostics) = match result {
        _ if deadline.has_passed() => (Ending::Failed, None, vec![out_of_time(options)]),
        _ if task.is_cancelled() => (Ending::Cancelled, None, vec![]),
        Ok(scene) => (Ending::Done, Some(scene), vec![]),
        Err(raised) => (Ending::Failed, None, raised.0),
    };
    diagnostics.extend(session.warnings.take());
    Outcome {
        ending,
        scene,
        diagnostics,
        log: session.log.take(),
        parameters: session.parameters.take(),
        dependencies: session.access.asked(),
        sources: session.sources.take(),
        timings: session.timings.take(),
        rests: session.rests.take(),
        thinned: session.thinned.take(),
    }
}

fn script(session: &Rc<Session>) -> Result<Scene, Raised> {
    let (lua, returned) = chunk(session, bind::install)?;
    scene(&lua, session, &session.options.script.to_string_lossy(), returned)
}

/// Runs a session's file from its first line to its last, with what `install` makes of the global `coif`; gives what it
/// returned.
pub(super) fn chunk(
    session: &Rc<Session>,
    install: impl FnOnce(&Lua) -> mlua::Result<()>,
) -> Result<(Lua, MultiValue), Raised> {
    let path = &session.options.script;
    let file = path.to_string_lossy().into_owned();
    let bytes =
        session.access.read(path).map_err(|e| Raised(vec![Diagnostic::error(e.to_string()).hint_opt(e.hint())]))?;
    let text = String::from_utf8(bytes)
        .map_err(|_| Raised(vec![Diagnostic::error(format!("`{file}` is not a text in UTF-8"))]))?;
    session.sources.borrow_mut().insert(file.clone(), text.clone());
    let internal = |e: mlua::Error| Raised(vec![Diagnostic::error(format!("cannot start the script: {e}"))]);
    let lua = sandbox::open(Rc::clone(session)).map_err(internal)?;
    install(&lua).and_then(|()| sandbox::close(&lua)).map_err(internal)?;
    let chunk = lua.load(text).set_name(format!("@{file}")).set_mode(mlua::chunk::ChunkMode::Text);
    let main = chunk.into_function().map_err(|e| trace::syntax(session, &e))?;
    let returned = Interruptible::run(&lua, &session.task, || protect::call(&lua, &main, MultiValue::new()));
    Ok((lua, returned.map_err(internal)??))
}

/// The scene that a script returned.
fn scene(_lua: &Lua, session: &Session, file: &str, returned: MultiValue) -> Result<Scene, Raised> {
    let first = returned.into_iter().next().unwrap_or(mlua::Value::Nil);
    let value = Reading::default().value(&first).unwrap_or_default();
    if let Value::Handle(handle) = &value
        && let Some(scene) = bind::scene_of(handle)
    {
        return Ok(Scene::clone(&scene));
    }
    let message = match &value {
        Value::Nil => "the script returns nothing".to_owned(),
        other => format!("the script returns {} `{other}` instead of a Scene", other.type_name()),
    };
    let sources = session.sources.borrow();
    let lines = sources.text(file).map_or(1, |t| t.trim_end().lines().count().max(1));
    let mut diagnostic = Diagnostic::error(message).hint("end it with `return coif.scene { head, hair }`");
    diagnostic.place = Some(sources.line(file, lines));
    Err(Raised(vec![diagnostic]))
}

/// Names given by `--set` that no `coif.params` declared.
fn unknown_parameters(session: &Session) -> Result<(), Raised> {
    let declared = session.parameters.borrow();
    let names = || declared.iter().map(|p| p.name.as_str());
    if session.options.names_seed && names().any(|n| n == "seed") {
        let message = "`seed` is the seed of the run, and the script has a parameter of that name";
        let hint = "give the script's parameter another name, such as `variant`";
        return Err(Raised(vec![Diagnostic::error(message).hint(hint)]));
    }
    let unknown: Vec<Diagnostic> = session
        .options
        .set
        .keys()
        .filter(|name| !names().any(|n| n == *name))
        .map(|name| {
            let hint = match crate::params::nearest(name, names()) {
                Some(n) => format!("did you mean `{n}`?"),
                None if declared.is_empty() => "it declares none; see `coif.params`".to_owned(),
                None => format!("it has {}", names().map(|n| format!("`{n}`")).collect::<Vec<_>>().join(", ")),
            };
            Diagnostic::error(format!("the script has no parameter `{name}`")).hint(hint)
        })
        .collect();
    if unknown.is_empty() { Ok(()) } else { Err(Raised(unknown)) }
}

/// The error of a run that was stopped by its time limit.
pub(super) fn out_of_time(options: &Options) -> Diagnostic {
    let seconds = options.time_limit.as_secs_f64();
    Diagnostic::error(format!("`{}` ran longer than {seconds} s", options.script.display()))
        .hint("look for a loop without end, or give it more: `--time-limit 300`")
}
