//! Calling into a script so that whatever it raises comes back as diagnostics.

use mlua::{Function, Lua, MultiValue};

use super::session::{Raised, session};
use super::{Diagnostic, trace};

const XPCALL: &str = "coif protected call";
const HANDLER: &str = "coif error handler";

/// Puts what [`call`] needs aside, before scripts can touch the globals.
///
/// # Errors
/// When Lua has no memory left.
pub fn prepare(lua: &Lua) -> mlua::Result<()> {
    lua.set_named_registry_value(XPCALL, lua.globals().get::<Function>("xpcall")?)?;
    // The handler runs on top of the stack that raised, so the trace is whole.
    let handler = lua.create_function(|lua, error: mlua::Value| {
        let session = session(lua)?;
        Ok(mlua::Value::Error(Box::new(trace::describe(lua, &session, &error).into())))
    })?;
    lua.set_named_registry_value(HANDLER, handler)
}

/// Calls a function.
///
/// # Errors
/// What it raised.
pub fn call(lua: &Lua, function: &Function, args: MultiValue) -> Result<MultiValue, Raised> {
    let outcome = (|| {
        let xpcall: Function = lua.named_registry_value(XPCALL)?;
        let handler: Function = lua.named_registry_value(HANDLER)?;
        let mut all = args;
        all.push_front(mlua::Value::Function(handler));
        all.push_front(mlua::Value::Function(function.clone()));
        xpcall.call::<MultiValue>(all)
    })();
    match outcome {
        Ok(mut values) => match values.pop_front() {
            Some(mlua::Value::Boolean(true)) => Ok(values),
            _ => Err(match values.pop_front() {
                Some(mlua::Value::Error(e)) => unpack(&e),
                // The handler itself failed: out of memory, or no stack left for it.
                Some(mlua::Value::String(s)) => Raised(vec![Diagnostic::error(s.to_string_lossy())]),
                _ => Raised(vec![Diagnostic::error("the script failed")]),
            }),
        },
        Err(e) => Err(unpack(&e)),
    }
}

fn unpack(error: &mlua::Error) -> Raised {
    Raised::inside(error).unwrap_or_else(|| {
        let text = error.to_string();
        Raised(vec![Diagnostic::error(text.split("\nstack traceback").next().unwrap_or_default())])
    })
}
