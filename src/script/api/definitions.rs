//! The definitions for editors: a `---@meta` file that LuaLS and EmmyLua read.

use std::fmt::Write;

use super::words::{annotation, called, class, functions as all_functions, limits, one_line, returned, shared, wrap};
use crate::params::{Field, Kind, Value};
use crate::script::bind::SEED;
use crate::script::object::OPERATORS;
use crate::script::registry::{Constant, Entry, Noun, Registry, Shape};

/// What Luau has and other Luas do not, vectors above all.
const PREAMBLE: &str = include_str!("../../../scripts/luau.lua");

/// Width of a line of doc.
const WIDTH: usize = 112;

/// The whole file.
pub fn definitions(registry: &Registry) -> String {
    let mut out = PREAMBLE.trim_end().to_owned();
    out.push_str("\n\n---Hairstyles that are written.\n---@class coif\n");
    for constant in registry.constants.iter().chain([&SEED]) {
        let _ = writeln!(out, "---@field {} {} # {}", name(constant), kind_of(constant), constant.doc);
    }
    out.push_str("coif = {}\n");
    for folder in folders(registry) {
        let _ = write!(out, "\n---@class {folder}\n{folder} = {{}}\n");
    }
    for entry in all_functions(registry) {
        function(&mut out, registry, entry, entry.name);
    }
    for one in &registry.nouns {
        noun(&mut out, registry, one);
    }
    out
}

fn name(constant: &Constant) -> &'static str {
    constant.name.rsplit('.').next().unwrap_or(constant.name)
}

fn kind_of(constant: &Constant) -> &'static str {
    match (constant.value)() {
        Value::Vector(_) => "vector",
        Value::Number(_) => "number",
        Value::Text(_) => "string",
        Value::Bool(_) => "boolean",
        Value::Nil | Value::Table(_) | Value::Handle(_) | Value::Function(_) => "any",
    }
}

/// `coif.domain`, `coif.material`, in the order they are met.
fn folders(registry: &Registry) -> Vec<String> {
    let mut folders: Vec<String> = vec![];
    for entry in all_functions(registry) {
        let steps: Vec<&str> = entry.name.split('.').collect();
        for depth in 2..steps.len() {
            let folder = steps[..depth].join(".");
            if !folders.contains(&folder) {
                folders.push(folder);
            }
        }
    }
    folders
}

fn noun(out: &mut String, registry: &Registry, noun: &Noun) {
    out.push('\n');
    doc(out, noun.doc);
    let _ = writeln!(out, "---@class coif.{}", noun.name);
    for getter in &noun.getters {
        let _ = writeln!(
            out,
            "---@field {} {} # {}",
            getter.name,
            returned(registry, getter.returns),
            one_line(getter.doc)
        );
    }
    for (_, sign, method) in OPERATORS {
        let word = match *sign {
            "+" => "add",
            "-" => "sub",
            _ => "mul",
        };
        if noun.methods.iter().any(|m| m.short_name() == *method) {
            let _ = writeln!(out, "---@operator {word}(coif.{0}): coif.{0}", noun.name);
        }
    }
    if let Some(lookup) = noun.lookup {
        let _ = writeln!(out, "---@field [string] {}", returned(registry, lookup.returns));
    }
    if let Some(entry) = called(noun) {
        let class = class(entry);
        let argument = |f: &Field| format!("{}: {}", f.name, annotation(registry, &class, f));
        let arguments = (entry.fields)().iter().map(argument).collect::<Vec<_>>().join(", ");
        let _ = writeln!(out, "---@overload fun({arguments}): {}", returned(registry, entry.returns));
    }
    let _ = writeln!(out, "local {} = {{}}", noun.name);
    for method in &noun.methods {
        function(out, registry, method, method.name);
    }
}

/// A function or method with the class of its table.
fn function(out: &mut String, registry: &Registry, entry: &Entry, name: &str) {
    let fields = (entry.fields)();
    let class = class(entry);
    if entry.shape == Shape::Table && !fields.is_empty() {
        table(out, registry, &class, &format!("{class}.fields"), &fields, &format!("What `{name}` takes."));
    } else {
        inner_tables(out, registry, &class, &fields);
    }
    out.push('\n');
    doc(out, entry.doc);
    let arguments: Vec<&str> = match entry.shape {
        _ if fields.is_empty() => vec![],
        Shape::Table => {
            let mark = if fields.iter().any(Field::is_required) { "" } else { "?" };
            let _ = writeln!(out, "---@param fields{mark} {class}.fields");
            vec!["fields"]
        }
        Shape::Positional => {
            for field in &fields {
                let (name, mark) = (field.name, if field.is_required() { "" } else { "?" });
                let takes = annotation(registry, &class, field);
                let _ = writeln!(out, "---@param {name}{mark} {takes} # {}{}", one_line(field.doc), limits(field));
            }
            fields.iter().map(|f| f.name).collect()
        }
    };
    if entry.returns != "nil" {
        let _ = writeln!(out, "---@return {}", returned(registry, entry.returns));
    }
    let _ = writeln!(out, "function {name}({}) end", arguments.join(", "));
}

/// The classes of the tables in some fields.
fn inner_tables(out: &mut String, registry: &Registry, owner: &str, fields: &[Field]) {
    for field in fields {
        if let (Some(nested), Some(_)) = (field.nested, own_struct(registry, owner, &field.kind)) {
            let inner = format!("{owner}.{}", field.name);
            table(out, registry, &inner, &inner, &nested(), field.doc);
        }
    }
}

/// The class of a table, after those of the tables in it.
fn table(out: &mut String, registry: &Registry, owner: &str, class: &str, fields: &[Field], about: &str) {
    inner_tables(out, registry, owner, fields);
    out.push('\n');
    doc(out, about);
    let _ = writeln!(out, "---@class (exact) {class}");
    for field in fields {
        let name = match field {
            Field { is_positional: true, .. } => "[integer]".to_owned(),
            Field { is_any_name: true, .. } => "[string]".to_owned(),
            required if required.is_required() => field.name.to_owned(),
            _ => format!("{}?", field.name),
        };
        let takes = annotation(registry, owner, field);
        let _ = writeln!(out, "---@field {name} {takes} # {}{}", one_line(field.doc), limits(field));
    }
}

/// The struct in a kind that no function of its own describes.
fn own_struct<'a>(registry: &Registry, owner: &str, kind: &'a Kind) -> Option<&'a str> {
    match kind {
        Kind::Struct(name) => shared(registry, name, owner).is_none().then_some(*name),
        Kind::List(inner) => own_struct(registry, owner, inner),
        Kind::OneOf(kinds) => kinds.iter().find_map(|k| own_struct(registry, owner, k)),
        _ => None,
    }
}

fn doc(out: &mut String, text: &str) {
    for line in wrap(&one_line(text), WIDTH) {
        let _ = writeln!(out, "---{line}");
    }
}
