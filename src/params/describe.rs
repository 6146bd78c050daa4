//! The description of a parameter struct.

use super::{FieldType, Reader, Table};

/// What a field takes.
#[derive(Clone, Debug, PartialEq)]
pub enum Kind {
    /// A number.
    Number,
    /// A whole number.
    Integer,
    /// True or false.
    Bool,
    /// Text.
    Text,
    /// One of these texts.
    Choice(&'static [&'static str]),
    /// `{x, y, z}` or a vector, in cm.
    Point,
    /// `{x, y, z}` or a vector of any length but zero.
    Direction,
    /// `"#rrggbb"` or `{r, g, b}` with channels 0..1.
    Colour,
    /// A list.
    List(Box<Kind>),
    /// Any of these.
    OneOf(Vec<Kind>),
    /// A function.
    Function,
    /// A value that Coif made.
    Object(&'static str),
    /// A table with fields of its own, by the name of its struct.
    Struct(&'static str),
    /// Anything.
    Any,
}

/// One parameter.
#[derive(Clone, Debug)]
pub struct Field {
    /// As a script writes it.
    pub name: &'static str,
    /// What it means.
    pub doc: &'static str,
    /// What it takes.
    pub kind: Kind,
    /// Its unit, if it has one.
    pub unit: Option<&'static str>,
    /// Least and greatest value, both allowed.
    pub range: Option<(f64, f64)>,
    /// What it is when left out, as a script would write it; `nil` for "may be left out".
    pub default: Option<String>,
    /// True when it is the list part of the table.
    pub is_positional: bool,
    /// True when it stands for every name that a script may choose itself.
    pub is_any_name: bool,
    /// What it takes, told more closely than `kind` does: `(root: vector): boolean` for a function, `Parting|vector[]`
    /// for anything else. For the editor definitions and the reference.
    pub takes: Option<&'static str>,
    /// The fields of the struct that it is, or that its list is of.
    pub nested: Option<fn() -> Vec<Field>>,
}

impl Field {
    /// A field of type `T`.
    pub fn new<T: FieldType>(name: &'static str, doc: &'static str) -> Self {
        let default = T::absent().map(|_| "nil".to_owned());
        // A field that is a word of Rust (`box`, `where`) is written `r#box` there and `box` in a script.
        let name = name.strip_prefix("r#").unwrap_or(name);
        Self {
            name,
            doc: doc.trim(),
            kind: T::kind(),
            unit: T::unit(),
            range: None,
            default,
            is_positional: false,
            is_any_name: false,
            takes: None,
            nested: T::nested(),
        }
    }

    /// With a default.
    #[must_use]
    pub fn default<T: FieldType>(mut self, value: &T) -> Self {
        self.default = Some(value.show());
        self
    }

    /// With a unit.
    #[must_use]
    pub fn unit(mut self, unit: &'static str) -> Self {
        self.unit = Some(unit);
        self
    }

    /// With limits, both allowed.
    #[must_use]
    pub fn range(mut self, lo: f64, hi: f64) -> Self {
        self.range = Some((lo, hi));
        self
    }

    /// Taken from the list part of the table instead of a named field.
    #[must_use]
    pub fn positional(mut self) -> Self {
        self.is_positional = true;
        self
    }

    /// Standing for every name that a script may choose itself.
    #[must_use]
    pub fn any_name(mut self) -> Self {
        self.is_any_name = true;
        self
    }

    /// With a closer word on what it takes.
    #[must_use]
    pub fn takes(mut self, what: &'static str) -> Self {
        self.takes = Some(what);
        self
    }

    /// A text that must be one of these.
    #[must_use]
    pub fn choices(mut self, texts: &'static [&'static str]) -> Self {
        self.kind = Kind::Choice(texts);
        self
    }

    /// Its limits in words: `0 to 10`, `1 or more`.
    pub fn interval(&self) -> Option<String> {
        // An upper end that no one reaches only says "no limit here": what it costs is told elsewhere.
        self.range.map(|(lo, hi)| if hi >= 1e12 { format!("{lo} or more") } else { format!("{lo} to {hi}") })
    }

    /// True when a script must give it.
    pub fn is_required(&self) -> bool {
        self.default.is_none()
    }
}

/// A struct that a script fills by a table; implement it by [`params!`](crate::params!).
pub trait Params: Sized {
    /// What a script calls: `coif.domain.gather`.
    const NAME: &'static str;
    /// What it is.
    const DOC: &'static str;
    /// Its fields, in the order they are documented.
    fn fields() -> Vec<Field>;
    /// Reads a table, collecting every problem in `reader`; `None` when there was one.
    fn read(table: &Table, reader: &mut Reader) -> Option<Self>;
}

/// Two structs that share one table; their fields must have different names.
impl<A: Params, B: Params> Params for (A, B) {
    const NAME: &'static str = A::NAME;
    const DOC: &'static str = A::DOC;

    fn fields() -> Vec<Field> {
        A::fields().into_iter().chain(B::fields()).collect()
    }

    fn read(table: &Table, reader: &mut Reader) -> Option<Self> {
        reader.reject_unknown(table, &Self::fields(), Self::NAME);
        let part = |own: &[Field]| Table {
            items: if own.iter().any(|f| f.is_positional) { table.items.clone() } else { vec![] },
            fields: own.iter().filter_map(|f| Some((f.name.to_owned(), table.fields.get(f.name)?.clone()))).collect(),
        };
        let (a, b) = (A::read(&part(&A::fields()), reader), B::read(&part(&B::fields()), reader));
        Some((a?, b?))
    }
}
