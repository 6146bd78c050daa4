//! Where a script is: its stack, and errors of Luau turned into diagnostics.

use mlua::Lua;

use super::session::{Raised, Session};
use super::{Diagnostic, Frame};
use crate::params::Value;

/// The scripts on the stack, innermost first, from `level` on; what is not a script is left out.
pub fn frames(lua: &Lua, level: usize) -> Vec<Frame> {
    // A stack overflow is thousands of levels deep; nobody reads them.
    const DEEPEST: usize = 64;
    (level..level + DEEPEST)
        .map_while(|level| {
            lua.inspect_stack(level, |d| {
                let source = d.source().source?;
                let file = source.strip_prefix('@')?.to_owned();
                let function = d.names().name.map(|n| n.into_owned());
                Some(Frame { file, line: d.current_line()?, function })
            })
        })
        .flatten()
        .collect()
}

/// Turns whatever a script raised into diagnostics; to be called while the stack still stands.
pub fn describe(lua: &Lua, session: &Session, error: &mlua::Value) -> Raised {
    if let mlua::Value::Error(e) = error
        && let Some(raised) = Raised::inside(e)
    {
        return raised;
    }
    let mut trace = frames(lua, 0);
    let (mut diagnostic, written) = match error {
        mlua::Value::String(s) => (Diagnostic::error(""), Some(s.to_string_lossy())),
        mlua::Value::Error(e) => (Diagnostic::error(""), Some(plain(e))),
        mlua::Value::Table(t) => (thrown_table(t), None),
        other => {
            let value = super::convert::Reading::default().value(other).unwrap_or_default();
            (Diagnostic::error(format!("the script raised `{value}`")), None)
        }
    };
    let sources = session.sources.borrow();
    let mut line = trace.first().map(|f| (f.file.clone(), f.line));
    if let Some(written) = written {
        let mut message = written.as_str();
        // `error("...", 2)` names another level than the innermost; the prefix is right. A coroutine adds a second.
        while let Some((file, number, rest)) = prefix(message, |file| sources.text(file).is_some()) {
            line = Some((file.to_owned(), number));
            message = rest;
        }
        diagnostic.message = lower(message);
        diagnostic.hints.extend(advice(message));
    }
    if let Some((file, number)) = line {
        if let Some(i) = trace.iter().position(|f| f.file == file && f.line == number) {
            trace.drain(..=i);
        }
        let word = quoted(&diagnostic.message);
        diagnostic.place = Some(match word {
            Some(word) => sources.word(&file, number, &word),
            None => sources.line(&file, number),
        });
    }
    diagnostic.trace = trace;
    Raised(vec![diagnostic])
}

/// A syntax error as a diagnostic.
pub fn syntax(session: &Session, error: &mlua::Error) -> Raised {
    let text = plain(error);
    let sources = session.sources.borrow();
    let Some((file, line, message)) = prefix(&text, |file| sources.text(file).is_some()) else {
        return Raised(vec![Diagnostic::error(lower(&text))]);
    };
    let mut diagnostic = Diagnostic::error(lower(message));
    diagnostic.label = Some("the script cannot be read on from here".into());
    let got = message.rsplit_once("got ").map(|(_, got)| got.trim_matches('\'').to_owned());
    diagnostic.place = Some(match got {
        Some(word) if word != "<eof>" => sources.word(file, line, &word),
        _ => sources.line(file, line),
    });
    Raised(vec![diagnostic])
}

/// `error({ message = ..., hint = ... })`, or any other table.
fn thrown_table(table: &mlua::Table) -> Diagnostic {
    let text = |key: &str| table.raw_get::<Option<String>>(key).ok().flatten();
    match text("message") {
        Some(message) => Diagnostic::error(message).hint_opt(text("hint")),
        None => {
            let value = super::convert::Reading::default().value(&mlua::Value::Table(table.clone()));
            Diagnostic::error(format!("the script raised `{}`", value.unwrap_or(Value::Text("a table".into()))))
        }
    }
}

/// The message of an error without mlua's own words and traceback.
fn plain(error: &mlua::Error) -> String {
    match error {
        mlua::Error::CallbackError { cause, .. } | mlua::Error::WithContext { cause, .. } => plain(cause),
        mlua::Error::SyntaxError { message, .. } => message.clone(),
        mlua::Error::RuntimeError(text) | mlua::Error::MemoryError(text) => {
            text.split("\nstack traceback:").next().unwrap_or_default().to_owned()
        }
        other => other.to_string(),
    }
}

/// Splits `style.lua:12: message`.
fn prefix(text: &str, is_source: impl Fn(&str) -> bool) -> Option<(&str, usize, &str)> {
    text.match_indices(':').find_map(|(i, _)| {
        let file = &text[..i];
        let (number, rest) = text[i + 1..].split_once(':')?;
        is_source(file).then_some(())?;
        Some((file, number.parse().ok()?, rest.trim_start()))
    })
}

/// The first word in single quotes: what Luau says a message is about.
fn quoted(message: &str) -> Option<String> {
    let (_, rest) = message.split_once('\'')?;
    let (word, _) = rest.split_once('\'')?;
    Some(word.to_owned())
}

/// Messages begin in lower case.
fn lower(message: &str) -> String {
    let mut chars = message.chars();
    match (chars.next(), chars.next()) {
        // Not "NaN" or "I ...".
        (Some(first), Some(second)) if second.is_lowercase() => {
            first.to_lowercase().chain(message.chars().skip(1)).collect()
        }
        _ => message.to_owned(),
    }
}

/// What usually helps against one of Luau's own errors.
fn advice(message: &str) -> Option<String> {
    if let Some(name) = message.strip_prefix("attempt to index nil with ") {
        return Some(format!(
            "what stands before {} is nil: was it ever set, and in this scope?",
            name.replace('\'', "`")
        ));
    }
    if message.starts_with("attempt to call a nil value") {
        return Some("no function of that name is known here; a local function must stand above its use".into());
    }
    if message.starts_with("attempt to call missing method") {
        return Some("the value before the `:` has no such method".into());
    }
    if message.starts_with("attempt to perform arithmetic") && message.contains("nil") {
        return Some("one of the two values was never set".into());
    }
    if message.starts_with("attempt to perform arithmetic") && message.contains("table") {
        return Some("only vectors can be calculated with: write vector.create(x, y, z) instead of { x, y, z }".into());
    }
    if message.contains("stack overflow") {
        return Some("a function calls itself without end".into());
    }
    if message.contains("not enough memory") {
        return Some("a script may use 512 MiB; strands and meshes do not count".into());
    }
    None
}
