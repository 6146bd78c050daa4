//! Strict reading of a script's table, with every problem told at once.

use super::{Field, Params, Table, Value};

/// Something wrong with a table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Problem {
    /// Where in the table: `locals[2].queue`; empty for the table itself.
    pub path: String,
    /// What is wrong, with the offending value in backticks.
    pub message: String,
    /// What to do.
    pub hint: Option<String>,
}

/// A type that a field can have.
pub trait FieldType: Sized {
    /// Its description.
    fn kind() -> super::Kind;
    /// Reads a value; on `None` a problem was pushed.
    fn read(value: &Value, reader: &mut Reader) -> Option<Self>;
    /// What it is when the script leaves it out and there is no default; `None`: it must be given.
    fn absent() -> Option<Self> {
        None
    }
    /// The unit that goes with the type itself.
    fn unit() -> Option<&'static str> {
        None
    }
    /// The fields, when it is a struct or a list of structs.
    fn nested() -> Option<fn() -> Vec<Field>> {
        None
    }
    /// As a number, for the range check.
    fn number(&self) -> Option<f64> {
        None
    }
    /// As a script would write it, for the reference.
    fn show(&self) -> String {
        String::new()
    }
}

/// Reads a whole table.
///
/// # Errors
/// Every problem found, in the order of the fields.
pub fn read<T: Params>(table: &Table) -> Result<T, Vec<Problem>> {
    let mut reader = Reader::default();
    let value = T::read(table, &mut reader);
    match value {
        Some(value) if reader.problems.is_empty() => Ok(value),
        _ => Err(reader.problems),
    }
}

/// The nearest of `names` to a misspelt one, if any is near enough to be meant.
pub fn nearest<'a>(wrong: &str, names: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    names
        .into_iter()
        .map(|name| (strsim::damerau_levenshtein(&wrong.to_lowercase(), &name.to_lowercase()), name))
        .filter(|&(distance, name)| {
            // Two changes make any short word of any other: `pairs` of `hair`.
            let most = if wrong.len() <= 4 { 1 } else { 1 + name.len().max(wrong.len()) / 4 };
            distance <= most
        })
        .min()
        .map(|(_, name)| name)
}

/// Collects problems while a table is read.
#[derive(Debug, Default)]
pub struct Reader {
    path: Vec<String>,
    problems: Vec<Problem>,
}

impl Reader {
    /// All problems so far.
    pub fn problems(self) -> Vec<Problem> {
        self.problems
    }

    /// Notes a problem at the current place; always `None`, to be returned.
    pub fn problem<T>(&mut self, message: impl Into<String>, hint: Option<String>) -> Option<T> {
        let mut path = String::new();
        for step in &self.path {
            if !step.starts_with('[') && !path.is_empty() {
                path.push('.');
            }
            path.push_str(step);
        }
        self.problems.push(Problem { path, message: message.into(), hint });
        None
    }

    /// Notes that `value` is not `wanted` ("a number").
    pub fn wrong_type<T>(&mut self, wanted: &str, value: &Value) -> Option<T> {
        self.problem(format!("expected {wanted}, got {} `{value}`", value.type_name()), None)
    }

    /// Reads something one step deeper (`queue` or `[2]`).
    pub fn inside<T>(&mut self, step: impl Into<String>, read: impl FnOnce(&mut Self) -> T) -> T {
        self.path.push(step.into());
        let result = read(self);
        self.path.pop();
        result
    }

    /// Notes every field of `table` that is not among `fields`.
    pub fn reject_unknown(&mut self, table: &Table, fields: &[Field], owner: &str) {
        let named = || fields.iter().filter(|f| !f.is_positional).map(|f| f.name);
        for key in table.fields.keys() {
            if !named().any(|name| name == key) {
                let hint = match nearest(key, named()) {
                    Some(name) => format!("did you mean `{name}`?"),
                    None if named().next().is_none() => format!("`{owner}` takes no named fields"),
                    None if matches!(key.as_str(), "color" | "colour") && named().any(|n| n == "material") => {
                        "colours are in `material`".to_owned()
                    }
                    None => format!("`{owner}` takes {}", named().collect::<Vec<_>>().join(", ")),
                };
                self.problem::<()>(format!("unknown field `{key}`"), Some(hint));
            }
        }
        if !table.items.is_empty() && !fields.iter().any(|f| f.is_positional) {
            let hint = format!("write `name = value`; `{owner}` takes {}", named().collect::<Vec<_>>().join(", "));
            self.problem::<()>(format!("a value without a name: `{}`", table.items[0]), Some(hint));
        }
    }

    /// Reads one field of `table`.
    pub fn field<T: FieldType>(&mut self, table: &Table, field: &Field, default: Option<T>) -> Option<T> {
        let list;
        let value = if field.is_positional {
            list = Value::Table(Table { items: table.items.clone(), ..Table::default() });
            (!table.items.is_empty()).then_some(&list)
        } else {
            table.fields.get(field.name).filter(|v| !matches!(v, Value::Nil))
        };
        let Some(value) = value else {
            return default.or_else(T::absent).or_else(|| {
                let what = if field.is_positional { "an entry" } else { field.name };
                let unit = field.unit.map(|u| format!(" ({u})")).unwrap_or_default();
                let first = field.doc.lines().next().unwrap_or_default().trim_end_matches('.');
                self.problem(format!("missing field `{what}`"), Some(format!("{what}{unit}: {first}")))
            });
        };
        let read = |reader: &mut Self| {
            let read = T::read(value, reader)?;
            let (Some((lo, hi)), Some(n)) = (field.range, read.number()) else { return Some(read) };
            if n >= lo && n <= hi {
                return Some(read);
            }
            let unit = field.unit.map(|u| format!(" {u}")).unwrap_or_default();
            let takes = field.interval().unwrap_or_default();
            reader.problem(format!("`{n}` is out of range"), Some(format!("it takes {takes}{unit}")))
        };
        if field.is_positional { read(self) } else { self.inside(field.name, read) }
    }

    /// Reads one of `texts`.
    pub fn choice<'a>(&mut self, value: &'a Value, texts: &[&str]) -> Option<&'a str> {
        let Value::Text(text) = value else { return self.wrong_type("a string", value) };
        if texts.contains(&text.as_str()) {
            return Some(text);
        }
        let hint = match nearest(text, texts.iter().copied()) {
            Some(name) => format!("did you mean \"{name}\"?"),
            None => format!("it takes {}", texts.iter().map(|t| format!("\"{t}\"")).collect::<Vec<_>>().join(", ")),
        };
        self.problem(format!("`\"{text}\"` is not one of the choices"), Some(hint))
    }
}
