//! `coif.params`: what a person may turn without reading the script.

use super::super::call::{Call, Result};
use super::super::host::{Options, SetBy};
use super::super::registry::{Entry, Shape};
use crate::math::Colour;
use crate::params::{Field, Kind, Params, Problem, Reader, Table, Value};

/// A parameter that a script declares.
#[derive(Clone, Debug)]
pub struct Parameter {
    /// Its name.
    pub name: String,
    /// What it takes: `number`, `integer`, `boolean`, `text`, `choice`, `colour`, `point`.
    pub kind: ParameterKind,
    /// What it is unless set.
    pub default: Value,
    /// What it is in this run.
    pub value: Value,
    /// Least value.
    pub min: Option<f64>,
    /// Greatest value.
    pub max: Option<f64>,
    /// Unit, for people.
    pub unit: Option<String>,
    /// What it means.
    pub doc: String,
    /// What a choice may be.
    pub choices: Vec<String>,
}

impl Parameter {
    /// The value that a text from outside stands for, as `--set` takes it.
    ///
    /// # Errors
    /// Why the parameter does not take it.
    pub fn given(&self, text: &str) -> std::result::Result<Value, Problem> {
        let value = match self.kind {
            ParameterKind::Number | ParameterKind::Integer => text.trim().parse().ok().map(Value::Number),
            ParameterKind::Boolean => text.trim().parse().ok().map(Value::Bool),
            ParameterKind::Text | ParameterKind::Choice | ParameterKind::Colour => Some(Value::Text(text.to_owned())),
            ParameterKind::Point => {
                let numbers = text.split(',').filter_map(|n| n.trim().parse().ok());
                let items: Vec<Value> = numbers.map(Value::Number).collect();
                Some(Value::Table(Table { items, ..Table::default() }))
            }
        };
        let value = value.ok_or_else(|| Problem {
            path: String::new(),
            message: format!("`{text}` is not a {}", self.kind.text()),
            hint: None,
        })?;
        check(self, &value)
    }
}

crate::choices! {
    /// What a parameter takes.
    pub enum ParameterKind {
        /// Any number.
        Number = "number",
        /// A whole number.
        Integer = "integer",
        /// True or false.
        Boolean = "boolean",
        /// Any text.
        Text = "text",
        /// One of some texts.
        Choice = "choice",
        /// `#rrggbb`.
        Colour = "colour",
        /// Three numbers.
        Point = "point",
    }
}

crate::params! {
    /// One parameter: `length = { 45, min = 10, max = 80, unit = "cm", doc = "longest strand" }`, or just `length = 45`.
    pub struct Declaration("coif.params") {
        /// What it is unless set from outside: a number, true or false, a text, `"#rrggbb"`, a point.
        default: Vec<Value>, positional(), takes("number|boolean|string|Point");
        /// Least value of a number.
        min: Option<f32>;
        /// Greatest value of a number.
        max: Option<f32>;
        /// True when a number must be whole.
        integer: bool = false;
        /// Unit of a number, for people.
        unit: Option<String>;
        /// What it means, in one line.
        doc: String = String::new();
        /// What a text may be.
        choices: Vec<String> = vec![];
    }
}

/// `coif.params`.
pub fn functions() -> Vec<Entry> {
    let declare = Entry {
        name: "coif.params",
        doc: "Declares the style's parameters and gives their values: the defaults, or what `--set name=value` says. \
              Each is a default, or a table of a default with `min`, `max`, `integer`, `unit`, `doc`, `choices`.",
        fields: || vec![any_parameter()],
        shape: Shape::Table,
        returns: "table",
        sealed: Some("the table of parameters"),
        call: declare,
    };
    vec![declare]
}

/// What stands behind the name of a parameter.
fn any_parameter() -> Field {
    let kinds = vec![Kind::Struct(Declaration::NAME), Kind::Number, Kind::Bool, Kind::Text, Kind::Point];
    let doc = "A parameter, by the name that it shall have.";
    Field { kind: Kind::OneOf(kinds), ..Field::new::<Option<Declaration>>("parameter", doc).any_name() }
}

fn declare(call: &Call) -> Result<Value> {
    let mut problems = vec![];
    let mut values = Table::default();
    if let Some(first) = call.table().items.first() {
        let hint = "every parameter has a name: { length = 45 }".to_owned();
        return Err(call.problem(format!("a parameter without a name: `{first}`"), Some(hint)));
    }
    // A Lua table has no order; the text of the call has.
    let mut declarations: Vec<_> = call.table().fields.iter().map(|(n, v)| (call.place_of(n), n, v)).collect();
    declarations.sort_by_key(|d| d.0);
    for (_, name, value) in declarations {
        match parameter(name, value).and_then(|p| set(p, &call.session.options)) {
            Ok(parameter) => {
                values.fields.insert(name.clone(), parameter.value.clone());
                let mut declared = call.session.parameters.borrow_mut();
                declared.retain(|p| p.name != *name);
                declared.push(parameter);
            }
            Err(more) => problems.extend(more),
        }
    }
    if problems.is_empty() { Ok(Value::Table(values)) } else { Err(call.problems(problems)) }
}

/// Reads one declaration.
fn parameter(name: &str, value: &Value) -> std::result::Result<Parameter, Vec<Problem>> {
    let whole = Table { items: vec![value.clone()], ..Table::default() };
    let table = match value {
        Value::Table(table) => table,
        _ => &whole,
    };
    let mut reader = Reader::default();
    let declaration: Option<Declaration> = reader.inside(name, |r| Params::read(table, r));
    let problems = reader.problems();
    let problem = |message: String, hint: Option<String>| vec![Problem { path: name.to_owned(), message, hint }];
    let Some(d) = declaration.filter(|_| problems.is_empty()) else { return Err(problems) };
    let [default] = d.default.as_slice() else {
        let hint = "a point is written { { 0, 1, 0 }, doc = \"...\" }";
        return Err(problem(format!("expected one default, got {}", d.default.len()), Some(hint.into())));
    };
    let kind = match default {
        Value::Number(_) if d.integer => ParameterKind::Integer,
        Value::Number(_) => ParameterKind::Number,
        Value::Bool(_) => ParameterKind::Boolean,
        Value::Text(_) if !d.choices.is_empty() => ParameterKind::Choice,
        Value::Text(t) if Colour::parse(t).is_some() => ParameterKind::Colour,
        Value::Text(_) => ParameterKind::Text,
        Value::Vector(_) | Value::Table(_) => ParameterKind::Point,
        Value::Nil | Value::Handle(_) | Value::Function(_) => {
            let hint = "a parameter is a number, true or false, a text or a point".to_owned();
            return Err(problem(format!("{} `{default}` cannot be a parameter", default.type_name()), Some(hint)));
        }
    };
    let bound = |b: Option<f32>| b.and_then(|b| b.to_string().parse::<f64>().ok());
    let parameter = Parameter {
        name: name.to_owned(),
        kind,
        default: default.clone(),
        value: default.clone(),
        min: bound(d.min),
        max: bound(d.max),
        unit: d.unit,
        doc: d.doc,
        choices: d.choices,
    };
    let value = check(&parameter, default).map_err(|p| vec![Problem { path: name.to_owned(), ..p }])?;
    Ok(Parameter { value: value.clone(), default: value, ..parameter })
}

/// Takes over what was given from outside.
fn set(parameter: Parameter, options: &Options) -> std::result::Result<Parameter, Vec<Problem>> {
    let Some(text) = options.set.get(&parameter.name) else { return Ok(parameter) };
    let name = parameter.name.clone();
    let from_outside = |p: Problem| {
        let default = &parameter.default;
        let (given, example) = match options.set_by {
            SetBy::Option => (format!("`--set {name}={text}`"), format!("as in `--set {name}={default}`")),
            SetBy::Table => {
                (format!("`{name}` in the table of parameters"), format!("as in `{{ {name} = {default} }}`"))
            }
        };
        vec![Problem { path: name.clone(), message: format!("{given}: {}", p.message), hint: p.hint.or(Some(example)) }]
    };
    let value = parameter.given(text).map_err(from_outside)?;
    Ok(Parameter { value, ..parameter })
}

/// The value as a script gets it, if the parameter takes it.
fn check(parameter: &Parameter, value: &Value) -> std::result::Result<Value, Problem> {
    let problem = |message: String, hint: Option<String>| Problem { path: String::new(), message, hint };
    match (parameter.kind, value) {
        (ParameterKind::Number | ParameterKind::Integer, Value::Number(n)) => {
            if !n.is_finite() {
                return Err(problem(format!("`{n}` is not a finite number"), None));
            }
            if parameter.kind == ParameterKind::Integer && n.fract() != 0.0 {
                return Err(problem(format!("`{n}` is not a whole number"), Some(format!("write {}", n.round()))));
            }
            if parameter.min.is_some_and(|min| *n < min) || parameter.max.is_some_and(|max| *n > max) {
                let unit = parameter.unit.as_ref().map(|u| format!(" {u}")).unwrap_or_default();
                let hint = match (parameter.min, parameter.max) {
                    (Some(min), Some(max)) => format!("it takes {min} to {max}{unit}"),
                    (Some(min), None) => format!("it takes {min}{unit} or more"),
                    (_, max) => format!("it takes {}{unit} or less", max.unwrap_or_default()),
                };
                return Err(problem(format!("`{n}` is out of range"), Some(hint)));
            }
            Ok(value.clone())
        }
        (ParameterKind::Choice, Value::Text(t)) => {
            let choices: Vec<&str> = parameter.choices.iter().map(String::as_str).collect();
            let mut reader = Reader::default();
            let found = reader.choice(value, &choices).is_some();
            if found { Ok(Value::Text(t.clone())) } else { Err(reader.problems().remove(0)) }
        }
        (ParameterKind::Colour, Value::Text(t)) if Colour::parse(t).is_none() => {
            Err(problem(format!("`{t}` is not a colour"), Some("write #rrggbb".into())))
        }
        (ParameterKind::Point, value) => {
            let mut reader = Reader::default();
            match <glam::Vec3 as crate::params::FieldType>::read(value, &mut reader) {
                Some(v) => Ok(Value::Vector(v)),
                None => Err(reader.problems().remove(0)),
            }
        }
        _ => Ok(value.clone()),
    }
}
