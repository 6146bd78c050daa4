//! What a script hands over, as plain data.

use std::any::Any;
use std::collections::BTreeMap;
use std::fmt;
use std::sync::Arc;

use glam::Vec3;

/// A script's value.
#[derive(Clone, Debug, Default)]
pub enum Value {
    /// Nothing.
    #[default]
    Nil,
    /// True or false.
    Bool(bool),
    /// Any number.
    Number(f64),
    /// Text.
    Text(String),
    /// A native vector.
    Vector(Vec3),
    /// A table.
    Table(Table),
    /// A value that Coif made: a head, strands, a queue.
    Handle(Handle),
    /// A function, by its number in the call's list of functions.
    Function(usize),
}

/// A script's table: its list part and its named part.
#[derive(Clone, Debug, Default)]
pub struct Table {
    /// `{ a, b }`, from index 1.
    pub items: Vec<Value>,
    /// `{ name = value }`.
    pub fields: BTreeMap<String, Value>,
}

/// A type that scripts hold by reference.
pub trait Object: Any + Send + Sync {
    /// Its name in messages and in the reference: `Strands`.
    const NAME: &'static str;
}

/// A shared reference to an [`Object`].
#[derive(Clone)]
pub struct Handle {
    name: &'static str,
    value: Arc<dyn Any + Send + Sync>,
}

impl Handle {
    /// Wraps a value.
    pub fn new<T: Object>(value: Arc<T>) -> Self {
        Self { name: T::NAME, value }
    }

    /// The name of the type inside.
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// The value, if it is a `T`.
    pub fn get<T: Object>(&self) -> Option<Arc<T>> {
        Arc::clone(&self.value).downcast().ok()
    }
}

impl fmt::Debug for Handle {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "<{}>", self.name)
    }
}

impl Value {
    /// The type's name for messages: "a number".
    pub fn type_name(&self) -> String {
        match self {
            Self::Nil => "nothing".into(),
            Self::Bool(_) => "a boolean".into(),
            Self::Number(_) => "a number".into(),
            Self::Text(_) => "a string".into(),
            Self::Vector(_) => "a vector".into(),
            Self::Table(_) => "a table".into(),
            Self::Function(_) => "a function".into(),
            Self::Handle(h) => format!("a {}", h.name),
        }
    }
}

/// As a script would write it, shortened.
impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Nil => f.write_str("nil"),
            Self::Bool(b) => write!(f, "{b}"),
            Self::Number(n) => write!(f, "{n}"),
            Self::Text(t) if t.chars().count() > 60 => {
                write!(f, "{:?}", t.chars().take(57).chain("...".chars()).collect::<String>())
            }
            Self::Text(t) => write!(f, "{t:?}"),
            Self::Vector(v) => write!(f, "{{ {}, {}, {} }}", v.x, v.y, v.z),
            Self::Handle(h) => write!(f, "{h:?}"),
            Self::Function(_) => f.write_str("function"),
            Self::Table(t) => {
                let items = t.items.iter().map(ToString::to_string);
                let fields = t.fields.iter().map(|(k, v)| match v {
                    Self::Table(_) => format!("{k} = {{...}}"),
                    v => format!("{k} = {v}"),
                });
                let all: Vec<String> = items.chain(fields).collect();
                match all.len() {
                    0 => f.write_str("{}"),
                    1..=6 => write!(f, "{{ {} }}", all.join(", ")),
                    n => write!(f, "{{ {}, ... {n} in all }}", all[..5].join(", ")),
                }
            }
        }
    }
}
