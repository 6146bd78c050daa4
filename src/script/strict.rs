//! Tables that cannot be changed and that answer a misspelt name with the nearest one.

use mlua::Lua;

use super::session::{Raised, session};
use super::trace;
use super::{Diagnostic, Place};
use crate::params::nearest;

/// Seals a table: read-only, and an error for every name it does not have.
///
/// `what` is what messages call it: "`coif.domain`".
///
/// # Errors
/// When Lua has no memory left.
pub fn seal(lua: &Lua, table: &mlua::Table, what: &str) -> mlua::Result<()> {
    let what = what.to_owned();
    let meta = lua.create_table()?;
    meta.raw_set(
        "__index",
        lua.create_function(move |lua, (table, key): (mlua::Table, mlua::Value)| {
            let Some(key) = key.as_string().map(|k| k.to_string_lossy()) else { return Ok(mlua::Value::Nil) };
            let names = names(&table);
            Err(unknown(lua, &what, &key, names.iter().map(String::as_str)))
        })?,
    )?;
    // Keeps `setmetatable` and `getmetatable` away from it.
    meta.raw_set("__metatable", false)?;
    meta.set_readonly(true);
    table.set_metatable(Some(meta))?;
    table.set_readonly(true);
    Ok(())
}

/// The names in a table, sorted.
pub fn names(table: &mlua::Table) -> Vec<String> {
    let mut names: Vec<String> = table
        .pairs::<mlua::Value, mlua::Value>()
        .flatten()
        .filter_map(|(k, _)| Some(k.as_string()?.to_string_lossy()))
        .collect();
    names.sort();
    names
}

/// The error for a name that `what` does not have.
pub fn unknown<'a>(lua: &Lua, what: &str, key: &str, names: impl IntoIterator<Item = &'a str>) -> mlua::Error {
    let names: Vec<&str> = names.into_iter().collect();
    let hint = match nearest(key, names.iter().copied()) {
        Some(name) => format!("did you mean `{name}`?"),
        None if names.is_empty() => "it has no names at all".to_owned(),
        None => format!("it has {}", names.iter().map(|n| format!("`{n}`")).collect::<Vec<_>>().join(", ")),
    };
    raise(lua, &format!("{what} has no `{key}`"), Some(hint), Some(key.to_owned()))
}

/// An error at the running line, marking `word` in it.
pub fn raise(lua: &Lua, message: &str, hint: Option<String>, word: Option<String>) -> mlua::Error {
    let session = match session(lua) {
        Ok(session) => session,
        Err(e) => return e,
    };
    let mut trace = trace::frames(lua, 0);
    let mut diagnostic = Diagnostic::error(message).hint_opt(hint);
    if !trace.is_empty() {
        let top = trace.remove(0);
        let sources = session.sources.borrow();
        let place: Place = match word {
            Some(word) => sources.word(&top.file, top.line, &word),
            None => sources.line(&top.file, top.line),
        };
        diagnostic.place = Some(place);
    }
    diagnostic.trace = trace;
    Raised(vec![diagnostic]).into()
}
