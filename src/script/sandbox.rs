//! A Luau VM without doors: no files, no clock, no processes, no environment, bounded memory and time.

use std::cell::Cell;
use std::ffi::c_int;
use std::ptr;
use std::rc::Rc;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Sender, channel};
use std::time::Duration;

use mlua::{Lua, LuaOptions, StdLib};

use super::session::Session;
use super::{module, protect, strict};
use crate::math::rng::Key;
use crate::task::Task;

/// What a script's own values may take, bytes.
const MEMORY: usize = 512 << 20;

/// What a script may print, bytes.
const LONGEST_LOG: usize = 1 << 20;

/// Globals of Luau that a pure function has no use for, or that lead out.
const REMOVED: &[&str] =
    &["collectgarbage", "debug", "gcinfo", "getfenv", "io", "loadstring", "newproxy", "os", "require", "setfenv"];

/// A new VM for one run, without `coif` yet.
///
/// # Errors
/// When Lua cannot be set up.
pub fn open(session: Rc<Session>) -> mlua::Result<Lua> {
    let libraries = StdLib::TABLE
        | StdLib::STRING
        | StdLib::MATH
        | StdLib::COROUTINE
        | StdLib::BIT
        | StdLib::BUFFER
        | StdLib::VECTOR
        | StdLib::UTF8;
    let lua = Lua::new_with(libraries, LuaOptions::new())?;
    let own = usize::try_from(session.options.limits.memory).unwrap_or(MEMORY).min(MEMORY);
    lua.set_memory_limit(own)?;
    let globals = lua.globals();
    for name in REMOVED {
        globals.raw_set(*name, mlua::Value::Nil)?;
    }
    seed_random(&lua, session.options.seed)?;
    globals.raw_set("print", lua.create_function(print)?)?;
    lua.set_app_data(session);
    protect::prepare(&lua)?;
    module::prepare(&lua)?;
    Ok(lua)
}

/// Locks the VM: libraries and globals cannot be changed, misspelt names are errors.
///
/// # Errors
/// When Lua has no memory left.
pub fn close(lua: &Lua) -> mlua::Result<()> {
    let globals = lua.globals();
    for name in strict::names(&globals) {
        if name != "_G"
            && let Ok(library) = globals.raw_get::<mlua::Table>(name.as_str())
        {
            if library.is_readonly() {
                continue;
            }
            strict::seal(lua, &library, &format!("`{name}`"))?;
        }
    }
    let meta = lua.create_table()?;
    let index = lua.create_function(|lua, (table, key): (mlua::Table, mlua::Value)| {
        let Some(key) = key.as_string().map(|k| k.to_string_lossy()) else { return Ok(mlua::Value::Nil) };
        if REMOVED.contains(&key.as_str()) {
            let hint = "a style is a pure function: no files, clock, processes or code made at run time";
            return Err(strict::raise(lua, &format!("`{key}` does not exist here"), Some(hint.into()), Some(key)));
        }
        let mut names = strict::names(&table);
        names.extend(strict::locals(lua));
        let hint = match crate::params::nearest(&key, names.iter().map(String::as_str)) {
            Some(name) => format!("did you mean `{name}`?"),
            None => format!("set it first: `local {key} = ...`"),
        };
        Err::<mlua::Value, _>(strict::raise(lua, &format!("unknown name `{key}`"), Some(hint), Some(key)))
    })?;
    meta.raw_set("__index", index)?;
    meta.raw_set("__metatable", false)?;
    meta.set_readonly(true);
    globals.set_metatable(Some(meta))?;
    lua.sandbox(true)
}

/// `math.random` with the run's seed: Luau's own is seeded from the clock.
fn seed_random(lua: &Lua, seed: u64) -> mlua::Result<()> {
    let math: mlua::Table = lua.globals().raw_get("math")?;
    let state = Rc::new(Cell::new((Key::new(seed, "math.random"), 0_u64)));
    let seeding = Rc::clone(&state);
    math.raw_set(
        "random",
        lua.create_function(move |_, (low, high): (Option<f64>, Option<f64>)| {
            let (key, n) = state.get();
            state.set((key, n + 1));
            // 53 bits: every double in 0..1 that a uniform number can be.
            let unit = (key.with(n).bits() >> 11) as f64 / (1_u64 << 53) as f64;
            let (low, high) = match (low, high) {
                (None, _) => return Ok(unit),
                (Some(high), None) => (1.0, high.floor()),
                (Some(low), Some(high)) => (low.floor(), high.floor()),
            };
            // Also catches NaN.
            if !(low <= high && high - low < 9e15) {
                return Err(mlua::Error::runtime(format!(
                    "math.random: the interval {low} to {high} is empty or too large"
                )));
            }
            Ok((low + (unit * (high - low + 1.0)).floor()).min(high))
        })?,
    )?;
    math.raw_set(
        "randomseed",
        lua.create_function(move |_, seed: f64| {
            seeding.set((Key::new(seed.to_bits(), "math.randomseed"), 0));
            Ok(())
        })?,
    )
}

/// `print`, into the run's log.
fn print(lua: &Lua, values: mlua::MultiValue) -> mlua::Result<()> {
    let session = super::session::session(lua)?;
    let mut line = String::new();
    for (i, value) in values.iter().enumerate() {
        if i > 0 {
            line.push('\t');
        }
        line.push_str(&value.to_string()?);
    }
    let logged = session.logged.get();
    if logged < LONGEST_LOG {
        session.logged.set(logged + line.len() + 1);
        let line = if logged + line.len() < LONGEST_LOG { line } else { "... and more, left out".to_owned() };
        session.log.borrow_mut().push(line);
    }
    Ok(())
}

thread_local! {
    /// The task of the script that runs on this thread.
    static RUNNING: Cell<*const Task> = const { Cell::new(ptr::null()) };
}

/// Lets the script be stopped while this lives: at every loop and call Luau asks whether the task was cancelled.
///
/// mlua's own interrupt costs 8 ns each time; this costs one load. Raised again at every safepoint, so no `pcall` can
/// keep it down.
pub struct Interruptible {
    before: *const Task,
}

impl Interruptible {
    /// From now on, until dropped. `task` must outlive it, which the borrow in [`Self::run`] sees to.
    #[allow(unsafe_code)]
    pub fn run<R>(lua: &Lua, task: &Task, body: impl FnOnce() -> R) -> mlua::Result<R> {
        // SAFETY: `lua_callbacks` gives the callback table of a live VM; setting its field is how Luau is told.
        unsafe {
            lua.exec_raw::<()>((), |state| (*mlua::ffi::lua_callbacks(state)).interrupt = Some(poll))?;
        }
        let _guard = Self { before: RUNNING.replace(task) };
        Ok(body())
    }
}

impl Drop for Interruptible {
    fn drop(&mut self) {
        RUNNING.set(self.before);
    }
}

#[allow(unsafe_code)]
unsafe extern "C-unwind" fn poll(state: *mut mlua::ffi::lua_State, gc: c_int) {
    // During garbage collection nothing may be raised.
    if gc >= 0 {
        return;
    }
    let task = RUNNING.get();
    // SAFETY: the pointer is set from a reference that lives as long as `Interruptible::run`, on this very thread.
    if !task.is_null() && unsafe { &*task }.is_cancelled() {
        // SAFETY: Luau allows raising from an interrupt; the message is a constant C string, and no Rust value with a
        // destructor is alive in this frame.
        unsafe { mlua::ffi::luaL_error(state, c"cancelled".as_ptr()) }
    }
}

/// Cancels a task after a time, unless dropped before.
pub struct Deadline {
    passed: Arc<AtomicBool>,
    _stop: Sender<()>,
}

impl Deadline {
    /// Starts the clock.
    pub fn start(task: &Task, limit: Duration) -> Self {
        let (stop, stopped) = channel::<()>();
        let passed = Arc::new(AtomicBool::new(false));
        let (task, flag) = (task.clone(), Arc::clone(&passed));
        std::thread::spawn(move || {
            if stopped.recv_timeout(limit) == Err(std::sync::mpsc::RecvTimeoutError::Timeout) {
                flag.store(true, Ordering::SeqCst);
                task.cancel();
            }
        });
        Self { passed, _stop: stop }
    }

    /// True once it has cancelled the task.
    pub fn has_passed(&self) -> bool {
        self.passed.load(Ordering::SeqCst)
    }
}
