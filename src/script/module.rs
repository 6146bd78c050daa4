//! `require`: other scripts below the style's folder, and the library that ships with Coif.

use std::path::{Path, PathBuf};

use mlua::Lua;

use super::files::{AccessError, tidy};
use super::session::{Session, session};
use super::{strict, trace};

/// The library that ships with Coif, by module name.
pub const LIBRARY: &[(&str, &str)] = &[("coif/looks", include_str!("../../scripts/looks.lua"))];

/// Prefix of the shipped library's files in messages.
const SHIPPED: &str = "<coif>/";

/// The part of `require` that runs the module is Lua, so that a trace goes right through it.
const REQUIRE: &str = "local find, done = ...
return function(name)
  local module, known = find(name)
  if not module then return known end
  return done(name, known, module())
end";

/// Makes the global `require`.
///
/// # Errors
/// When Lua has no memory left.
pub fn prepare(lua: &Lua) -> mlua::Result<()> {
    let find = lua.create_function(|lua, name: mlua::Value| {
        let Some(name) = name.as_string().map(|n| n.to_string_lossy()) else {
            let message = format!("`require` takes the name of a module, got a {}", name.type_name());
            return Err(strict::raise(lua, &message, Some("write require \"name\"".into()), Some("require".into())));
        };
        find(lua, &name)
    })?;
    let done = lua.create_function(|lua, (name, file, value): (String, String, mlua::Value)| {
        if value.is_nil() {
            let message = format!("the module `{name}` returns nothing");
            let hint = "end it with `return`, usually of a table of functions";
            return Err(strict::raise(lua, &message, Some(hint.into()), Some(name)));
        }
        lua.set_named_registry_value(&key(&file), &value)?;
        Ok(value)
    })?;
    let require: mlua::Function = lua.load(REQUIRE).set_name("=coif").call((find, done))?;
    lua.globals().raw_set("require", require)
}

fn key(file: &str) -> String {
    format!("coif module {file}")
}

/// The module's function and file, or nil and the value it gave before.
fn find(lua: &Lua, name: &str) -> mlua::Result<(mlua::Value, mlua::Value)> {
    let session = session(lua)?;
    let (file, text) = match locate(lua, &session, name) {
        Ok(found) => found,
        Err((message, hint)) => return Err(strict::raise(lua, &message, hint, Some(name.to_owned()))),
    };
    let value: mlua::Value = lua.named_registry_value(&key(&file))?;
    if !value.is_nil() {
        return Ok((mlua::Value::Nil, value));
    }
    // Not loaded, but on the stack: it is being loaded.
    if trace::frames(lua, 0).iter().any(|frame| frame.file == file) {
        let message = format!("`{name}` requires itself in a circle");
        let hint = "move what both need into a third module";
        return Err(strict::raise(lua, &message, Some(hint.into()), Some(name.to_owned())));
    }
    session.sources.borrow_mut().insert(file.clone(), text.clone());
    let function = lua.load(text).set_name(format!("@{file}")).set_mode(mlua::chunk::ChunkMode::Text).into_function();
    match function {
        Ok(function) => Ok((mlua::Value::Function(function), mlua::Value::String(lua.create_string(&file)?))),
        Err(e) => {
            let mut raised = trace::syntax(&session, &e);
            raised.0[0].trace = trace::frames(lua, 0);
            Err(raised.into())
        }
    }
}

type Found = Result<(String, String), (String, Option<String>)>;

/// Name in messages and text of a module.
fn locate(lua: &Lua, session: &Session, name: &str) -> Found {
    if name.starts_with("coif/") {
        return match LIBRARY.iter().find(|(n, _)| *n == name) {
            Some((name, text)) => Ok((format!("{SHIPPED}{name}.lua"), (*text).to_owned())),
            None => {
                let nearest = crate::params::nearest(name, LIBRARY.iter().map(|(n, _)| *n));
                let hint = match nearest {
                    Some(n) => format!("did you mean `{n}`?"),
                    None => format!(
                        "it has {}",
                        LIBRARY.iter().map(|(n, _)| format!("`{n}`")).collect::<Vec<_>>().join(", ")
                    ),
                };
                Err((format!("Coif's library has no `{name}`"), Some(hint)))
            }
        };
    }
    // `./x` and `../x` start at the file that asks, `x` at the style's folder.
    let folder = if name.starts_with('.') {
        let asking = trace::frames(lua, 0).first().map(|f| PathBuf::from(&f.file)).unwrap_or_default();
        asking.parent().map(Path::to_path_buf).unwrap_or_default()
    } else {
        session.options.folder()
    };
    let stem = tidy(&folder.join(name.strip_suffix(".lua").unwrap_or(name)));
    let mut first = None;
    let mut with_ending = stem.clone().into_os_string();
    with_ending.push(".lua");
    for path in [PathBuf::from(with_ending), stem.join("init.lua")] {
        match session.access.read(&path) {
            Ok(bytes) => match String::from_utf8(bytes) {
                Ok(text) => return Ok((path.to_string_lossy().into_owned(), text)),
                Err(_) => return Err((format!("`{}` is not a text in UTF-8", path.display()), None)),
            },
            Err(e) => drop(first.get_or_insert(e)),
        }
    }
    Err(match first {
        Some(AccessError::Outside(_)) => (
            format!("the module `{name}` lies outside of the script's folder"),
            Some(format!("`require` looks below `{}` only", display(&session.options.folder()))),
        ),
        Some(AccessError::Missing { path, nearest }) => {
            let hint = match nearest {
                Some(n) => format!("did you mean `{}`?", n.trim_end_matches(".lua")),
                None => format!("`{}` does not exist", path.display()),
            };
            (format!("there is no module `{name}`"), Some(hint))
        }
        Some(other) => (other.to_string(), other.hint()),
        None => (format!("there is no module `{name}`"), None),
    })
}

fn display(folder: &Path) -> String {
    if folder.as_os_str().is_empty() { ".".into() } else { folder.display().to_string() }
}
