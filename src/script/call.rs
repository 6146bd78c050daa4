//! One call from a script: its arguments read strictly, its errors and warnings given a place.

use std::cell::{Cell, OnceCell};
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use mlua::{Lua, MultiValue};

use super::convert::{Reading, to_lua};
use super::limits::Need;
use super::memo::{Kept, Origin};
use super::registry::{Entry, Shape};
use super::session::{Raised, Session, Timing};
use super::source::CallText;
use super::{Diagnostic, Frame, Severity, protect, strict, trace};
use crate::geometry::{Root, Strands};
use crate::groom::{GroomError, Moving};
use crate::math::{Digest, rng::Key};
use crate::params::{self, Function, Handle, Object, Params, Problem, Table, Value};
use crate::task::{Task, Warned, Warning};

/// What bindings give back.
pub type Result<T> = std::result::Result<T, Raised>;

/// A call in progress.
pub struct Call<'a> {
    /// The run.
    pub session: &'a Session,
    /// For calling the script's own functions.
    lua: &'a Lua,
    entry: &'static Entry,
    this: Option<Handle>,
    table: Table,
    functions: Vec<mlua::Function>,
    stack: OnceCell<Vec<Frame>>,
    origin: Cell<Option<Origin>>,
}

/// Runs a function of the registry for a script.
///
/// # Errors
/// A [`Raised`] with every problem of the arguments, or what the function raised.
pub fn invoke(lua: &Lua, session: &Session, entry: &'static Entry, args: MultiValue) -> mlua::Result<mlua::Value> {
    let mut call = Call {
        session,
        lua,
        entry,
        this: None,
        table: Table::default(),
        functions: vec![],
        stack: OnceCell::new(),
        origin: Cell::new(None),
    };
    call.take(args)?;
    let started = Instant::now();
    let value = (entry.call)(&call)?;
    let time = started.elapsed();
    let origin = call.origin.get();
    if time.as_micros() >= 500 || origin.is_some() {
        let timing = Timing { what: entry.name.to_owned(), source: call.source().to_string(), time, origin };
        session.timings.borrow_mut().push(timing);
    }
    let value = to_lua(lua, &value)?;
    if let (Some(what), mlua::Value::Table(table)) = (entry.sealed, &value) {
        strict::seal(lua, table, what)?;
    }
    Ok(value)
}

impl Call<'_> {
    /// Reads the arguments as plain data.
    fn take(&mut self, args: MultiValue) -> Result<()> {
        let mut args: Vec<mlua::Value> = args.into_iter().collect();
        let mut reading = Reading::default();
        if let Some((noun, method)) = self.entry.name.split_once(':') {
            let this = if args.is_empty() { None } else { reading.value(&args.remove(0)).ok() };
            match this {
                Some(Value::Handle(h)) if h.name() == noun => self.this = Some(h),
                _ => {
                    let message = format!("`{method}` is a method of a {noun}");
                    return Err(self.problem(message, Some(format!("write a colon: `value:{method}(...)`"))));
                }
            }
        }
        // A trailing nil is as good as nothing: `f(options)` with `options` left out.
        while args.last().is_some_and(mlua::Value::is_nil) {
            args.pop();
        }
        let fields = (self.entry.fields)();
        match self.entry.shape {
            Shape::Table => {
                if args.len() > 1 {
                    let message = format!("`{}` takes one table, got {} arguments", self.entry.name, args.len());
                    return Err(self.problem(message, Some("put everything into the braces: { a = 1, b = 2 }".into())));
                }
                match args.first().map(|a| reading.value(a)).transpose() {
                    Err(message) => return Err(self.problem(message, None)),
                    Ok(None) => {}
                    Ok(Some(Value::Table(table))) => self.table = table,
                    Ok(Some(other)) => {
                        let message = format!("expected a table, got {} `{other}`", other.type_name());
                        let first = fields.iter().find(|f| !f.is_positional).map_or("name", |f| f.name);
                        let hint = if fields.iter().any(|f| f.is_positional) {
                            format!("write it in braces: `{} {{ ... }}`", self.entry.name)
                        } else {
                            format!("write its fields in braces: `{} {{ {first} = ... }}`", self.entry.name)
                        };
                        return Err(self.problem(message, Some(hint)));
                    }
                }
            }
            Shape::Positional => {
                if args.len() > fields.len() {
                    let names: Vec<&str> = fields.iter().map(|f| f.name).collect();
                    let message = format!("`{}` takes {} arguments, got {}", self.entry.name, names.len(), args.len());
                    return Err(self.problem(message, Some(format!("it is called as {}", self.usage(&names)))));
                }
                for (field, arg) in fields.iter().zip(&args) {
                    match reading.value(arg) {
                        Ok(Value::Nil) => {}
                        Ok(value) => drop(self.table.fields.insert(field.name.to_owned(), value)),
                        Err(message) => {
                            let path = field.name.to_owned();
                            return Err(self.problems(vec![Problem { path, message, hint: None }]));
                        }
                    }
                }
            }
        }
        self.functions = reading.functions;
        Ok(())
    }

    fn usage(&self, names: &[&str]) -> String {
        format!("`{}({})`", self.entry.name, names.join(", "))
    }

    /// The arguments as a parameter struct.
    ///
    /// # Errors
    /// Every problem found in them.
    pub fn read<P: Params>(&self) -> Result<P> {
        params::read(&self.table).map_err(|problems| self.problems(problems))
    }

    /// The arguments as two parameter structs that share one table.
    ///
    /// # Errors
    /// Every problem found in them.
    pub fn read_both<A: Params, B: Params>(&self) -> Result<(A, B)> {
        self.read_both_from(&self.table)
    }

    /// A table that was made from the arguments, as two parameter structs.
    ///
    /// # Errors
    /// Every problem found in it.
    pub fn read_both_from<A: Params, B: Params>(&self, table: &Table) -> Result<(A, B)> {
        params::read(table).map_err(|problems| self.problems(problems))
    }

    /// A call's own seed together with the run's: with the run's seed 0 the call's own.
    pub fn seed(&self, own: u64) -> u64 {
        match self.session.options.seed {
            0 => own,
            run => Key::new(run, "run").with(own).bits(),
        }
    }

    /// Asks a predicate about every root.
    ///
    /// # Errors
    /// What it raised, or that it did not return true or false; `path` is its field.
    pub fn choose(&self, test: Function, path: &str, roots: &[Root]) -> Result<Vec<bool>> {
        let ask = |root: &Root| match self.script(test, &[Value::Vector(root.position)])? {
            Value::Bool(b) => Ok(b),
            other => {
                let message = format!("the function returned {} `{other}`", other.type_name());
                let hint = "it must return true or false, as in `function(root) return root.x > 0 end`";
                Err(self.problem_at(path, message, Some(hint.into())))
            }
        };
        roots.iter().map(ask).collect()
    }

    /// An error of the method, about the call.
    pub fn groom(&self, error: &GroomError) -> Raised {
        self.problem(error.to_string(), error.hint())
    }

    /// True when the function has a field of that name.
    pub fn has_field(&self, name: &str) -> bool {
        (self.entry.fields)().iter().any(|f| f.name == name)
    }

    /// The arguments as they came.
    pub fn table(&self) -> &Table {
        &self.table
    }

    /// What the method was called on.
    ///
    /// # Errors
    /// When it is of another type, which the registry rules out.
    pub fn this<T: Object>(&self) -> Result<Arc<T>> {
        self.this.as_ref().and_then(Handle::get).ok_or_else(|| self.problem(format!("this is not a {}", T::NAME), None))
    }

    /// Where the call stands: `ponytail.lua:24`.
    pub fn source(&self) -> Arc<str> {
        match self.stack().first() {
            Some(frame) => {
                let file = Path::new(&frame.file)
                    .strip_prefix(self.session.options.folder())
                    .unwrap_or(Path::new(&frame.file));
                format!("{}:{}", file.display(), frame.line).into()
            }
            None => "".into(),
        }
    }

    /// Asks for room for what the call is about to make.
    ///
    /// # Errors
    /// A limit of the run that it would pass; `path` is the field to blame.
    pub fn claim(&self, path: &str, need: Need) -> Result<()> {
        self.session.claimed.set(self.room(path, need)?);
        Ok(())
    }

    /// The same without taking the room; gives what would be taken in all.
    ///
    /// # Errors
    /// As [`Call::claim`].
    pub fn room(&self, path: &str, need: Need) -> Result<Need> {
        let claimed = self.session.options.limits.check(self.session.claimed.get(), need);
        claimed.map_err(|r| self.problem_at(path, r.message, Some(r.hint)))
    }

    /// The VM.
    pub fn lua(&self) -> &Lua {
        self.lua
    }

    /// For long computations.
    pub fn task(&self) -> &Task {
        &self.session.task
    }

    fn stack(&self) -> &[Frame] {
        self.stack.get_or_init(|| trace::frames(self.lua, 0))
    }

    /// Line and column of a field in the text of the call.
    pub fn place_of(&self, field: &str) -> (usize, usize) {
        let Some(top) = self.stack().first() else { return (0, 0) };
        let text = CallText { function: self.entry.name, path: field, unknown: None, positional: None };
        let place = self.session.sources.borrow().field(&top.file, top.line, &text);
        (place.line, place.column)
    }

    /// An error about the call as a whole.
    pub fn problem(&self, message: impl Into<String>, hint: Option<String>) -> Raised {
        self.problem_at("", message, hint)
    }

    /// An error about a field: `locals[2].queue`.
    pub fn problem_at(&self, path: &str, message: impl Into<String>, hint: Option<String>) -> Raised {
        self.problems(vec![Problem { path: path.to_owned(), message: message.into(), hint }])
    }

    /// Errors about fields.
    pub fn problems(&self, problems: Vec<Problem>) -> Raised {
        Raised(problems.into_iter().map(|p| self.diagnostic(Severity::Error, p)).collect())
    }

    fn diagnostic(&self, severity: Severity, problem: Problem) -> Diagnostic {
        let Problem { path, message, hint } = problem;
        let hint = hint.or_else(|| conversion(&message).map(ToOwned::to_owned));
        let mut diagnostic = Diagnostic { severity, ..Diagnostic::error(message) }.hint_opt(hint);
        let name = self.entry.name;
        diagnostic.label = Some(match path.as_str() {
            "" => format!("in `{name}`"),
            path => format!("`{path}` of `{name}`"),
        });
        let Some((top, trace)) = self.stack().split_first() else { return diagnostic };
        let unknown = diagnostic.message.strip_prefix("unknown field `").map(|rest| rest.trim_end_matches('`'));
        let names: Vec<&str> = (self.entry.fields)().iter().map(|f| f.name).collect();
        let positional = (self.entry.shape == Shape::Positional).then_some(names.as_slice());
        let text = CallText { function: name, path: &path, unknown, positional };
        let place = self.session.sources.borrow().field(&top.file, top.line, &text);
        diagnostic.place = Some(place);
        diagnostic.trace = trace.to_vec();
        diagnostic
    }

    /// A warning about the call, or about a field of it.
    pub fn warn(&self, path: &str, warning: Warning) {
        let problem = Problem { path: path.to_owned(), message: warning.message, hint: warning.hint };
        self.session.warn(self.diagnostic(Severity::Warning, problem));
    }

    /// The value, its warnings noted.
    pub fn warned<T>(&self, warned: Warned<T>) -> T {
        for warning in warned.warnings {
            self.warn("", warning);
        }
        warned.value
    }

    /// The value with this key, from the memo or computed; its warnings are given the place of this call.
    ///
    /// # Errors
    /// What `compute` raised; errors are not kept.
    pub fn memo<T: Kept>(&self, key: &Digest, compute: impl FnOnce() -> Result<Warned<T>>) -> Result<Arc<T>> {
        self.memo_revised(key, |_| {}, compute)
    }

    /// The same for strands, whose `sources` are no part of their geometry: they are always those given.
    ///
    /// # Errors
    /// What `compute` raised.
    pub fn memo_strands(
        &self,
        key: &Digest,
        sources: &[Arc<str>],
        compute: impl FnOnce() -> Result<Warned<Strands>>,
    ) -> Result<Arc<Strands>> {
        let revise = |strands: &mut Arc<Strands>| {
            if strands.sources != sources {
                Arc::make_mut(strands).sources = sources.to_vec();
            }
        };
        self.memo_revised(key, revise, compute)
    }

    /// The same for strands in motion.
    ///
    /// # Errors
    /// What `compute` raised.
    pub fn memo_moving(
        &self,
        key: &Digest,
        sources: &[Arc<str>],
        compute: impl FnOnce() -> Result<Warned<Moving>>,
    ) -> Result<Arc<Moving>> {
        let revise = |moving: &mut Arc<Moving>| {
            if moving.rest.sources != sources {
                let moving = Arc::make_mut(moving);
                moving.rest.sources = sources.to_vec();
                moving.frames.frames.iter_mut().for_each(|f| Arc::make_mut(f).sources = sources.to_vec());
            }
        };
        self.memo_revised(key, revise, compute)
    }

    fn memo_revised<T: Kept>(
        &self,
        key: &Digest,
        revise: impl FnOnce(&mut Arc<T>),
        compute: impl FnOnce() -> Result<Warned<T>>,
    ) -> Result<Arc<T>> {
        let (memo, key) = (&self.session.options.memo, key.finish());
        if let Some((value, warnings)) = memo.revised(key, revise) {
            self.origin.set(self.origin.get().or(Some(Origin::Hit)));
            return Ok(self.warned(Warned { value, warnings }));
        }
        let Warned { value, warnings } = compute()?;
        self.origin.set(Some(Origin::Computed));
        let value = Arc::new(value);
        memo.put(key, &value, &warnings);
        Ok(self.warned(Warned { value, warnings }))
    }

    /// Calls one of the script's own functions.
    ///
    /// # Errors
    /// What it raised, at the place in the function.
    pub fn script(&self, function: Function, args: &[Value]) -> Result<Value> {
        let Some(lua_function) = self.functions.get(function.0) else {
            return Err(self.problem("this function belongs to another call", None));
        };
        let lua_error = |e: mlua::Error| Raised::inside(&e).unwrap_or_else(|| self.problem(e.to_string(), None));
        let args: mlua::Result<Vec<mlua::Value>> = args.iter().map(|v| to_lua(self.lua, v)).collect();
        let args = MultiValue::from_vec(args.map_err(lua_error)?);
        let mut raised = protect::call(self.lua, lua_function, args);
        if let Err(raised) = &mut raised {
            // The function's own stack ends at the binding; who called that is known here.
            for diagnostic in &mut raised.0 {
                if diagnostic.trace.len() < self.stack().len() {
                    diagnostic.trace.extend_from_slice(self.stack());
                }
            }
        }
        let value = raised?;
        let first = value.into_iter().collect::<Vec<_>>();
        let mut reading = Reading::default();
        match first.as_slice() {
            [] => Ok(Value::Nil),
            [one] => reading.value(one).map_err(|m| self.problem(m, None)),
            many => {
                let items: std::result::Result<Vec<Value>, String> = many.iter().map(|v| reading.value(v)).collect();
                Ok(Value::Table(Table { items: items.map_err(|m| self.problem(m, None))?, ..Table::default() }))
            }
        }
    }
}

/// How to make what was wanted from what was given.
fn conversion(message: &str) -> Option<&'static str> {
    let (wanted, got) = message.strip_prefix("expected a ")?.split_once(", got a ")?;
    let got = got.split(' ').next()?;
    Some(match (wanted, got) {
        ("Queue", "Domain" | "table") => "put domains into a queue: `coif.queue { a, b }`",
        ("Domain", "Queue") => "give the domains themselves, without `coif.queue`",
        ("Domain", "table") => "make it one: `coif.domain.directional { ... }`, or another kind",
        ("Region", "Head") => "take a region of it: `head:scalp()`",
        _ => return None,
    })
}
