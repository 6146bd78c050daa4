//! The reference: Markdown, a page per noun, one for the functions, and an index.

use std::fmt::Write;

use super::Document;
use super::words::{called, class, default, first_sentence, functions as all_functions, one_line, shared};
use crate::params::{Field, Kind};
use crate::script::bind::SEED;
use crate::script::object::OPERATORS;
use crate::script::registry::{Entry, Getter, Noun, Registry, Shape};

/// Says that a page is made.
const MADE: &str = "<!-- Made by `coif api`. Do not edit. -->\n\n";

/// All pages.
pub fn pages(registry: &Registry) -> Vec<Document> {
    let mut pages = vec![
        Document { name: "README.md".into(), text: index(registry) },
        Document { name: "functions.md".into(), text: functions(registry) },
    ];
    pages.extend(
        registry.nouns.iter().map(|n| Document { name: format!("{}.md", n.name), text: noun_page(registry, n) }),
    );
    pages
}

fn index(registry: &Registry) -> String {
    let mut out =
        format!("{MADE}# Reference\n\nEverything that a hairstyle script can call, from the program itself.\n");
    out.push_str("\n## Functions\n\n| function | gives | |\n| --- | --- | --- |\n");
    for entry in all_functions(registry) {
        let (anchor, gives) = (anchor(entry.name), linked(registry, entry.returns));
        let about = cell(&first_sentence(entry.doc));
        let _ = writeln!(out, "| [`{}`](functions.md#{anchor}) | {gives} | {about} |", entry.name);
    }
    out.push_str("\n## Values\n\n| value | | methods and figures |\n| --- | --- | --- |\n");
    for noun in &registry.nouns {
        let methods = noun.methods.iter().map(|m| format!("`:{}`", m.short_name()));
        let figures = noun.getters.iter().map(|g| format!("`.{}`", g.name));
        let names = methods.chain(figures).collect::<Vec<_>>().join(" ");
        let _ = writeln!(out, "| [{0}]({0}.md) | {1} | {names} |", noun.name, cell(&first_sentence(noun.doc)));
    }
    out.push_str(
        "\nConstants are [at the end of the functions](functions.md#constants). `coif.lua` in this folder is the same \
         for editors: see [Completion in the editor](../how-to/editor.md).\n",
    );
    out
}

fn functions(registry: &Registry) -> String {
    let mut out = format!("{MADE}# Functions\n");
    for entry in all_functions(registry) {
        function(&mut out, registry, entry);
    }
    out.push_str("\n## Constants\n\n| name | value | |\n| --- | --- | --- |\n");
    for constant in registry.constants.iter().chain([&SEED]) {
        let _ = writeln!(out, "| `{}` | `{}` | {} |", constant.name, (constant.value)(), cell(constant.doc));
    }
    out
}

fn noun_page(registry: &Registry, noun: &Noun) -> String {
    let mut out = format!("{MADE}# {}\n\n{}\n", noun.name, one_line(noun.doc));
    let makers: Vec<String> = makers(registry, noun.name).collect();
    if !makers.is_empty() {
        let _ = write!(out, "\nMade by {}.\n", makers.join(", "));
    }
    if !noun.getters.is_empty() {
        out.push_str("\n## Figures\n\n| figure | | |\n| --- | --- | --- |\n");
        for Getter { name, doc, returns, .. } in &noun.getters {
            let _ = writeln!(out, "| `.{name}` | {} | {} |", linked(registry, returns), cell(&one_line(doc)));
        }
    }
    let operators: Vec<String> = OPERATORS
        .iter()
        .filter(|(_, _, method)| noun.methods.iter().any(|m| m.short_name() == *method))
        .map(|(_, sign, method)| format!("`a {sign} b` for `a:{method}(b)`"))
        .collect();
    if !operators.is_empty() {
        let _ = write!(out, "\n## Operators\n\n{}.\n", operators.join(", "));
    }
    if let Some(entry) = called(noun) {
        let _ = write!(out, "\n`value {{ ... }}` is short for `value:{} {{ ... }}`.\n", entry.short_name());
    }
    if let Some(lookup) = noun.lookup {
        let _ = write!(out, "\nIts other names give a {}.\n", linked(registry, lookup.returns));
    }
    for method in &noun.methods {
        function(&mut out, registry, method);
    }
    out
}

/// Links to what gives a noun, other than its own methods.
fn makers<'a>(registry: &'a Registry, noun: &'a str) -> impl Iterator<Item = String> + 'a {
    let functions = all_functions(registry).map(|e| (e, "functions"));
    let methods = registry.nouns.iter().filter(move |n| n.name != noun);
    let methods = methods.flat_map(|n| n.methods.iter().map(move |e| (e, n.name)));
    functions
        .chain(methods)
        .filter(move |(entry, _)| entry.returns == noun)
        .map(|(entry, page)| format!("[`{}`]({page}.md#{})", entry.name, anchor(entry.name)))
}

fn function(out: &mut String, registry: &Registry, entry: &Entry) {
    let fields = (entry.fields)();
    let usage = match entry.shape {
        _ if fields.is_empty() => format!("{}()", entry.name),
        Shape::Table => format!("{} {{ ... }}", entry.name),
        Shape::Positional => {
            let argument = |f: &Field| if f.is_required() { f.name.to_owned() } else { format!("[{}]", f.name) };
            format!("{}({})", entry.name, fields.iter().map(argument).collect::<Vec<_>>().join(", "))
        }
    };
    let gives = match entry.returns {
        "nil" => "nothing".to_owned(),
        other => linked(registry, other),
    };
    let _ = write!(out, "\n## {}\n\n`{usage}` gives {gives}.\n", entry.name);
    let _ = write!(out, "\n{}\n", one_line(entry.doc));
    table(out, registry, &class(entry), &fields);
}

fn table(out: &mut String, registry: &Registry, owner: &str, fields: &[Field]) {
    if fields.is_empty() {
        return;
    }
    out.push_str("\n| name | takes | default | |\n| --- | --- | --- | --- |\n");
    for field in fields {
        let name = match field {
            Field { is_positional: true, .. } => "the list".to_owned(),
            Field { is_any_name: true, .. } => "any name".to_owned(),
            _ => format!("`{}`", field.name),
        };
        let default = match default(field) {
            Some(text) => format!("`{}`", cell(&text)),
            None if field.is_required() && !field.is_any_name => "**required**".to_owned(),
            None => String::new(),
        };
        let takes = takes(registry, owner, field);
        let _ = writeln!(out, "| {name} | {takes} | {default} | {} |", cell(&one_line(field.doc)));
    }
    for field in fields {
        if let (Some(nested), true) = (field.nested, has_own_table(registry, owner, &field.kind)) {
            let what = if field.is_any_name { "Each of them".to_owned() } else { format!("`{}`", field.name) };
            let verb =
                if matches!(field.kind, Kind::List(_)) { "is a list of tables with" } else { "may be a table with" };
            let _ = write!(out, "\n{what} {verb}:\n");
            table(out, registry, &format!("{owner}.{}", field.name), &nested());
        }
    }
}

fn has_own_table(registry: &Registry, owner: &str, kind: &Kind) -> bool {
    match kind {
        Kind::Struct(name) => shared(registry, name, owner).is_none(),
        Kind::List(inner) => has_own_table(registry, owner, inner),
        Kind::OneOf(kinds) => kinds.iter().any(|k| has_own_table(registry, owner, k)),
        _ => false,
    }
}

/// What a field takes, in words, with its range and unit.
fn takes(registry: &Registry, owner: &str, field: &Field) -> String {
    let mut out = match (&field.kind, field.takes) {
        (Kind::Function, Some(signature)) => format!("`function{}`", cell(signature)),
        (_, Some(takes)) => format!("`{}`", cell(takes)),
        (Kind::List(inner), None) if field.is_positional => format!("each a {}", words(registry, owner, inner)),
        (kind, None) => words(registry, owner, kind),
    };
    if let Some(interval) = field.interval() {
        let _ = write!(out, ", {interval}");
    }
    if let Some(unit) = field.unit {
        let _ = write!(out, " {unit}");
    }
    out
}

fn words(registry: &Registry, owner: &str, kind: &Kind) -> String {
    match kind {
        Kind::Number => "number".into(),
        Kind::Integer => "whole number".into(),
        Kind::Bool => "true or false".into(),
        Kind::Text => "text".into(),
        Kind::Choice(texts) => texts.iter().map(|t| format!("`\"{t}\"`")).collect::<Vec<_>>().join(" "),
        Kind::Point => "point".into(),
        Kind::Direction => "direction".into(),
        Kind::Colour => "colour".into(),
        Kind::List(inner) => format!("list of {}", words(registry, owner, inner)),
        Kind::OneOf(kinds) => kinds.iter().map(|k| words(registry, owner, k)).collect::<Vec<_>>().join(" or "),
        Kind::Function => "function".into(),
        Kind::Object(name) => linked(registry, name),
        Kind::Struct(name) => match shared(registry, name, owner) {
            Some(entry) => format!("the fields of [`{}`](functions.md#{})", entry.name, anchor(entry.name)),
            None => "table".into(),
        },
        Kind::Any => "anything".into(),
    }
}

/// The name of a type, linked to its page if it has one.
fn linked(registry: &Registry, name: &str) -> String {
    match registry.nouns.iter().find(|n| n.name == name) {
        Some(noun) => format!("[{0}]({0}.md)", noun.name),
        None => name.to_owned(),
    }
}

/// Where the heading of that text can be linked to.
fn anchor(heading: &str) -> String {
    heading.to_lowercase().chars().filter(|c| c.is_alphanumeric() || *c == '_' || *c == '-').collect()
}

/// Text within a table.
fn cell(text: &str) -> String {
    text.replace('|', "\\|")
}
