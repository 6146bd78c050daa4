//! The texts of scripts, and finding in them what a message is about.
//!
//! Luau tells the line of a call and nothing finer. The rest is read from the text: [`Sources::field`] finds the call's
//! table on that line and walks down to the field at fault.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

use super::Place;
use super::lexer::{Kind, Token, tokens};

/// Every script that was read, by the name it has in messages.
#[derive(Clone, Debug, Default)]
pub struct Sources(BTreeMap<String, Arc<str>>);

impl Sources {
    /// Adds a script.
    pub fn insert(&mut self, file: impl Into<String>, text: impl Into<Arc<str>>) {
        self.0.insert(file.into(), text.into());
    }

    /// Adds every script of another run.
    pub fn extend(&mut self, other: Self) {
        self.0.extend(other.0);
    }

    /// The text of a script.
    pub fn text(&self, file: &str) -> Option<&str> {
        self.0.get(file).map(|t| &**t)
    }

    /// A stretch of bytes as a place.
    pub fn place(&self, file: &str, span: Range<usize>) -> Place {
        let before = self.text(file).and_then(|t| t.get(..span.start)).unwrap_or_default();
        let line = before.matches('\n').count() + 1;
        let column = before.rsplit('\n').next().unwrap_or_default().chars().count() + 1;
        Place { file: file.to_owned(), line, column, span }
    }

    /// A whole line, without the blanks at both ends.
    pub fn line(&self, file: &str, line: usize) -> Place {
        let text = self.text(file).unwrap_or_default();
        let start: usize = text.split_inclusive('\n').take(line.saturating_sub(1)).map(str::len).sum();
        let whole = text[start..].split('\n').next().unwrap_or_default();
        let code = whole.trim();
        let start = start + (whole.len() - whole.trim_start().len());
        Place { line, ..self.place(file, start..start + code.len()) }
    }

    /// The word `name` in a line, or else the whole line.
    pub fn word(&self, file: &str, line: usize, name: &str) -> Place {
        let all = self.line(file, line);
        let found = self
            .text(file)
            .map(tokens)
            .unwrap_or_default()
            .into_iter()
            .find(|t| t.line == line && t.kind != Kind::Blank && t.text.trim_matches(['"', '\'']) == name)
            .map(|t| self.place(file, t.range()));
        found.unwrap_or(all)
    }

    /// What `path` (`locals[2].queue`, or `unknown` below it) means in the table of the call to `function` in a line.
    ///
    /// `positional` names the arguments when the function takes no table; the first step of the path is then one of
    /// them. Falls back to what encloses it, to the function's name, to the line.
    pub fn field(&self, file: &str, line: usize, call: &CallText) -> Place {
        let Some(text) = self.text(file) else { return self.line(file, line) };
        let tokens: Vec<Token> = tokens(text).into_iter().filter(|t| t.kind != Kind::Blank).collect();
        let name = call.function.rsplit(['.', ':']).next().unwrap_or(call.function);
        let is_call = |i: usize| {
            let after = tokens.get(i + 1);
            tokens[i].kind == Kind::Name && after.is_some_and(|t| t.kind == Kind::Text || matches!(t.text, "(" | "{"))
        };
        // The name alone, without a call, is the second choice: it may be a variable of the same name.
        let on_line = || (0..tokens.len()).filter(|&i| tokens[i].line == line && tokens[i].text == name);
        let calls: Vec<usize> = on_line().filter(|&i| is_call(i)).collect();
        let calls = if calls.is_empty() { on_line().collect() } else { calls };
        let mut best: Option<(bool, Range<usize>)> = None;
        for i in calls {
            let (is_whole, span) = descend(&tokens, i, call);
            if best.is_none() || (is_whole && best.as_ref().is_some_and(|(whole, _)| !whole)) {
                best = Some((is_whole, span));
            }
        }
        match best {
            Some((_, span)) => self.place(file, span),
            None => self.line(file, line),
        }
    }
}

/// What is known about the call that went wrong.
#[derive(Clone, Copy, Debug, Default)]
pub struct CallText<'a> {
    /// The function's name: `coif.domain.gather`, `Guides:grow`.
    pub function: &'a str,
    /// Where in the table, or empty for the call itself.
    pub path: &'a str,
    /// A field there that should not be.
    pub unknown: Option<&'a str>,
    /// The names of the arguments, when they are not in a table.
    pub positional: Option<&'a [&'a str]>,
}

/// Follows the path from the function's name at token `at`: (all of the path was found, where it ended).
fn descend(tokens: &[Token], at: usize, call: &CallText) -> (bool, Range<usize>) {
    let name = tokens[at].range();
    let mut steps: Vec<&str> = steps(call.path);
    let entries = match tokens.get(at + 1).map(|t| t.text) {
        Some("(") => entries(tokens, at + 2),
        // `f { ... }` and `f "..."`: one argument.
        Some(_) => vec![Entry { key: None, value: at + 1..end_of_term(tokens, at + 1) }],
        None => vec![],
    };
    let argument = match call.positional {
        Some(_) if steps.is_empty() => return (true, name),
        Some(names) => {
            let first = steps.remove(0);
            entries.get(names.iter().position(|&n| n == first).unwrap_or(usize::MAX))
        }
        None if steps.is_empty() && call.unknown.is_none() => return (true, name),
        None => entries.first(),
    };
    let Some(argument) = argument else { return (false, name) };
    let mut value = argument.value.clone();
    steps.extend(call.unknown);
    for (i, step) in steps.iter().enumerate() {
        let is_table = tokens.get(value.start).is_some_and(|t| t.text == "{");
        let inside = if is_table { self::entries(tokens, value.start + 1) } else { vec![] };
        let found = match step.strip_prefix('[').and_then(|s| s.trim_end_matches(']').parse::<usize>().ok()) {
            Some(index) => inside.iter().filter(|e| e.key.is_none()).nth(index - 1),
            None => inside.iter().find(|e| e.key.is_some_and(|k| tokens[k].text.trim_matches(['"', '\'']) == *step)),
        };
        let Some(found) = found else {
            // A missing part of a table: mark the table's own key or the call, not 20 lines of table.
            return (false, if i == 0 && !is_table { span(tokens, &value) } else { name });
        };
        if call.unknown.is_some() && i + 1 == steps.len() {
            return (true, found.key.map_or(name, |k| tokens[k].range()));
        }
        value = found.value.clone();
    }
    (true, span(tokens, &value))
}

/// `locals[2].queue` as `locals`, `[2]`, `queue`.
fn steps(path: &str) -> Vec<&str> {
    let mut out = vec![];
    for part in path.split('.').filter(|p| !p.is_empty()) {
        let mut rest = part;
        while let Some(i) = rest.get(1..).and_then(|r| r.find('[')).map(|i| i + 1) {
            out.push(&rest[..i]);
            rest = &rest[i..];
        }
        out.push(rest);
    }
    out
}

/// One entry of a table or one argument of a call, as token indices.
struct Entry {
    key: Option<usize>,
    value: Range<usize>,
}

/// The entries from token `at`, just after the opening bracket, to its closing one.
fn entries(tokens: &[Token], at: usize) -> Vec<Entry> {
    let mut out = vec![];
    let mut i = at;
    while i < tokens.len() && !matches!(tokens[i].text, "}" | ")" | "]") {
        let text = |k: usize| tokens.get(k).map(|t| t.text);
        let (key, start) = match (text(i), text(i + 1), text(i + 2), text(i + 3)) {
            (_, Some("="), ..) if tokens[i].kind == Kind::Name => (Some(i), i + 2),
            (Some("["), _, Some("]"), Some("=")) => (Some(i + 1), i + 4),
            _ => (None, i),
        };
        let mut end = start;
        while end < tokens.len() && !matches!(tokens[end].text, "," | ";" | "}" | ")" | "]") {
            end = end_of_group(tokens, end);
        }
        out.push(Entry { key, value: start..end });
        i = if matches!(text(end), Some("," | ";")) { end + 1 } else { end };
    }
    out
}

/// Just after a bracketed group or a function's body that begins at `at`, or after the single token.
fn end_of_group(tokens: &[Token], at: usize) -> usize {
    let mut depth = 0_usize;
    for i in at..tokens.len() {
        // An `if` that gives a value has no `end`; it stands where a statement cannot.
        let is_value = |i: usize| {
            i.checked_sub(1).is_some_and(|p| {
                matches!(
                    tokens[p].text,
                    "=" | "(" | "," | "{" | "return" | "and" | "or" | "not" | "else" | "+" | "-" | "*" | "/" | ".."
                )
            })
        };
        match tokens[i].text {
            "{" | "(" | "[" | "function" | "do" | "repeat" => depth += 1,
            "if" if depth > 0 && !is_value(i) => depth += 1,
            "}" | ")" | "]" | "end" | "until" => depth = depth.saturating_sub(1),
            _ => {}
        }
        if depth == 0 {
            return i + 1;
        }
    }
    tokens.len()
}

/// Just after the table or string that begins at `at`.
fn end_of_term(tokens: &[Token], at: usize) -> usize {
    end_of_group(tokens, at)
}

/// The bytes of some tokens; only the first line of a long value is marked.
fn span(tokens: &[Token], range: &Range<usize>) -> Range<usize> {
    let (Some(first), Some(last)) = (tokens.get(range.start), tokens.get(range.end.wrapping_sub(1))) else {
        return tokens.last().map_or(0..0, Token::range);
    };
    let last = if last.line == first.line {
        last
    } else {
        tokens[range.start..range.end].iter().take_while(|t| t.line == first.line).last().unwrap_or(first)
    };
    first.start..last.range().end.max(first.range().end)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = r#"local a = coif.domain.gather { core = x, radius = 2 } -- gather { core = 3 }
guides:grow {
  global = coif.queue { { 1, 2 } },
  locals = { { where = function(r) if r.x > 0, 1 then return { queue = 1 } end end, queue = side(1) },
             { ["queue"] = side(-1), when = "a, b = }" } },
}
head:at("temple", { 1, bad, 3 })
"#;

    fn mark(line: usize, call: &CallText) -> String {
        let mut sources = Sources::default();
        sources.insert("a.lua", TEXT);
        TEXT[sources.field("a.lua", line, call).span].to_owned()
    }

    #[test]
    fn fields_are_found_in_the_text() {
        let gather = CallText { function: "coif.domain.gather", ..CallText::default() };
        assert_eq!(mark(1, &CallText { path: "radius", ..gather }), "2");
        assert_eq!(mark(1, &CallText { unknown: Some("radius"), ..gather }), "radius");
        assert_eq!(mark(1, &CallText { path: "priority", ..gather }), "gather");
        assert_eq!(mark(1, &gather), "gather");
        let grow = CallText { function: "Guides:grow", ..CallText::default() };
        assert_eq!(mark(2, &CallText { path: "locals[1].queue", ..grow }), "side(1)");
        assert_eq!(mark(2, &CallText { path: "locals[2].queue", ..grow }), "side(-1)");
        assert_eq!(mark(2, &CallText { path: "locals[2]", unknown: Some("when"), ..grow }), "when");
        assert_eq!(mark(2, &CallText { path: "locals[2].when", ..grow }), "\"a, b = }\"");
        let at = CallText { function: "Head:at", positional: Some(&["name", "offset"]), ..CallText::default() };
        assert_eq!(mark(7, &CallText { path: "name", ..at }), "\"temple\"");
        assert_eq!(mark(7, &CallText { path: "offset[2]", ..at }), "bad");
    }

    #[test]
    fn lines_and_words() {
        let mut sources = Sources::default();
        sources.insert("a.lua", TEXT);
        let line = sources.line("a.lua", 3);
        assert_eq!((line.line, line.column), (3, 3));
        assert_eq!(&TEXT[line.span], "global = coif.queue { { 1, 2 } },");
        assert_eq!(sources.word("a.lua", 7, "at").column, 6);
        assert_eq!(sources.line("a.lua", 99).line, 99);
    }
}
