//! How types, defaults and docs are written.

use crate::params::{Field, Kind};
use crate::script::object::CALLED;
use crate::script::registry::{Entry, Noun, Registry, Shape};

/// Names of tables and texts that stand for a value of the core, declared by the preamble of the definitions.
const GIVEN: [&str; 3] = ["Point", "Direction", "Colour"];

/// A doc comment as one line.
pub fn one_line(doc: &str) -> String {
    doc.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// The first sentence of a doc comment.
pub fn first_sentence(doc: &str) -> String {
    let line = one_line(doc);
    match line.find(". ") {
        Some(end) => line[..=end].to_owned(),
        None => line,
    }
}

/// Lines of at most `width` characters.
pub fn wrap(text: &str, width: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split(' ') {
        let line = lines.last_mut().map_or(0, |l| l.chars().count());
        if line > 0 && line + 1 + word.chars().count() > width {
            lines.push(word.to_owned());
        } else if let Some(last) = lines.last_mut() {
            if line > 0 {
                last.push(' ');
            }
            last.push_str(word);
        }
    }
    lines
}

/// The class that stands for an entry: `coif.domain.gather`, `coif.Guides.grow`.
pub fn class(entry: &Entry) -> String {
    match entry.name.split_once(':') {
        Some((noun, method)) => format!("coif.{noun}.{method}"),
        None => entry.name.to_owned(),
    }
}

/// The function of that name that takes a table.
fn table_function<'a>(registry: &'a Registry, name: &str) -> Option<&'a Entry> {
    functions(registry).find(|e| e.name == name && e.shape == Shape::Table)
}

/// The function whose table a struct is, unless the struct is part of that very function's table.
pub fn shared<'a>(registry: &'a Registry, name: &str, owner: &str) -> Option<&'a Entry> {
    table_function(registry, name).filter(|e| owner != class(e))
}

/// A word for a type, as the definitions name it: `Head` is `coif.Head`.
pub fn annotated(registry: &Registry, text: &str) -> String {
    let is_name = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let mut out = String::new();
    let mut rest = text;
    while let Some(start) = rest.find(is_name) {
        let (before, from) = rest.split_at(start);
        let (word, after) = from.split_at(from.find(|c| !is_name(c)).unwrap_or(from.len()));
        out.push_str(before);
        if GIVEN.contains(&word) || registry.nouns.iter().any(|n| n.name == word) {
            out.push_str("coif.");
        }
        out.push_str(word);
        rest = after;
    }
    out + rest
}

/// What a field takes, as the definitions write it; of a positional field what each entry is. `owner` is the class of
/// the table that it is in.
pub fn annotation(registry: &Registry, owner: &str, field: &Field) -> String {
    if let Some(takes) = field.takes {
        let takes = annotated(registry, takes);
        return if is_function(&field.kind) { format!("fun{takes}") } else { takes };
    }
    match &field.kind {
        Kind::List(inner) if field.is_positional => kind(registry, owner, field, inner),
        other => kind(registry, owner, field, other),
    }
}

fn is_function(kind: &Kind) -> bool {
    matches!(kind, Kind::Function)
}

fn kind(registry: &Registry, owner: &str, field: &Field, of: &Kind) -> String {
    match of {
        // Scripts have one kind of number: 800 * 0.5 is whole too, which an editor would not see.
        Kind::Number | Kind::Integer => "number".into(),
        Kind::Bool => "boolean".into(),
        Kind::Text => "string".into(),
        Kind::Choice(texts) => texts.iter().map(|t| format!("\"{t}\"")).collect::<Vec<_>>().join("|"),
        Kind::Point => "coif.Point".into(),
        Kind::Direction => "coif.Direction".into(),
        Kind::Colour => "coif.Colour".into(),
        Kind::List(inner) => {
            let inner = kind(registry, owner, field, inner);
            if inner.contains('|') { format!("({inner})[]") } else { format!("{inner}[]") }
        }
        Kind::OneOf(kinds) => kinds.iter().map(|k| kind(registry, owner, field, k)).collect::<Vec<_>>().join("|"),
        Kind::Function => "function".into(),
        Kind::Object(name) => format!("coif.{name}"),
        Kind::Struct(name) => match shared(registry, name, owner) {
            Some(entry) => format!("{}.fields", class(entry)),
            None => format!("{owner}.{}", field.name),
        },
        Kind::Any => "any".into(),
    }
}

/// What comes back, as the definitions write it.
pub fn returned(registry: &Registry, returns: &str) -> String {
    match returns {
        "table" => "table<string, any>".into(),
        other => annotated(registry, other),
    }
}

/// Unit, range and default in square brackets, as far as there are any.
pub fn limits(field: &Field) -> String {
    let mut parts = vec![];
    if field.kind == Kind::Integer {
        parts.push("whole".to_owned());
    }
    parts.extend(field.unit.map(ToOwned::to_owned));
    parts.extend(field.interval());
    parts.extend(default(field).map(|d| format!("default {d}")));
    if parts.is_empty() { String::new() } else { format!(" [{}]", parts.join("; ")) }
}

/// The default, unless it is nothing: no value, no text, an empty list.
pub fn default(field: &Field) -> Option<String> {
    field.default.as_ref().filter(|d| !["", "nil", "\"\"", "{}"].contains(&d.as_str())).cloned()
}

/// Every function below `coif`, those of tests last.
pub fn functions(registry: &Registry) -> impl Iterator<Item = &Entry> {
    registry.functions.iter().chain(&registry.test_functions)
}

/// The method that `value { ... }` is short for, if a noun has it.
pub fn called(noun: &Noun) -> Option<&Entry> {
    noun.methods.iter().find(|m| m.short_name() == CALLED)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::script::registry::registry;

    #[test]
    fn names_of_nouns_are_told_from_other_words() {
        let text = annotated(registry(), "Parting|Point[]|fun(Headless: vector): \"head\"");
        assert_eq!(text, "coif.Parting|coif.Point[]|fun(Headless: vector): \"head\"");
    }

    #[test]
    fn docs_become_lines() {
        assert_eq!(one_line(" A b\n  c. D\n"), "A b c. D");
        assert_eq!(first_sentence(" A b\n c. D e."), "A b c.");
        assert_eq!(wrap("aa bb cc", 5), ["aa bb", "cc"]);
        assert_eq!(wrap("longer than", 3), ["longer", "than"]);
    }
}
