//! The table of contents of the language: every function and every noun, described once.
//!
//! The globals that a script sees, the reference pages and the editor definitions are all made from this.

use std::sync::OnceLock;

use super::call::{Call, Result};
use crate::params::{Field, Handle, Object, Params, Value};

/// How a function takes its arguments.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// One table with named fields: `coif.domain.gather { core = ... }`.
    Table,
    /// One after the other: `head:at("temple", { 0, 1, 0 })`; the fields give their names and order.
    Positional,
}

/// A function or a method.
pub struct Entry {
    /// `coif.domain.gather` or `Guides:grow`.
    pub name: &'static str,
    /// What it does, in one or two sentences.
    pub doc: &'static str,
    /// Its arguments.
    pub fields: fn() -> Vec<Field>,
    /// How they are given.
    pub shape: Shape,
    /// What comes back: a noun, `vector`, `number`.
    pub returns: &'static str,
    /// When it gives a table: what messages call that table, whose names are then strict.
    pub sealed: Option<&'static str>,
    /// What it does.
    pub call: fn(&Call) -> Result<Value>,
}

impl Entry {
    /// A function that takes one table, described by `P`.
    pub const fn table<P: Params>(name: &'static str, returns: &'static str, call: fn(&Call) -> Result<Value>) -> Self {
        Self { name, doc: P::DOC, fields: P::fields, shape: Shape::Table, returns, sealed: None, call }
    }

    /// A function that takes one table, described by `A` and `B` together.
    pub const fn both<A: Params, B: Params>(
        name: &'static str,
        returns: &'static str,
        call: fn(&Call) -> Result<Value>,
    ) -> Self {
        let fields = || A::fields().into_iter().chain(B::fields()).collect();
        Self { name, doc: A::DOC, fields, shape: Shape::Table, returns, sealed: None, call }
    }

    /// A function that takes the fields of `P` one after the other.
    pub const fn positional<P: Params>(
        name: &'static str,
        returns: &'static str,
        call: fn(&Call) -> Result<Value>,
    ) -> Self {
        Self { name, doc: P::DOC, fields: P::fields, shape: Shape::Positional, returns, sealed: None, call }
    }

    /// A function without arguments.
    pub const fn plain(
        name: &'static str,
        doc: &'static str,
        returns: &'static str,
        call: fn(&Call) -> Result<Value>,
    ) -> Self {
        Self { name, doc, fields: Vec::new, shape: Shape::Positional, returns, sealed: None, call }
    }

    /// The same with another description.
    #[must_use]
    pub const fn about(mut self, doc: &'static str) -> Self {
        self.doc = doc;
        self
    }

    /// The same, giving a table with strict names; `what` is what messages call it.
    #[must_use]
    pub const fn sealed(mut self, what: &'static str) -> Self {
        self.sealed = Some(what);
        self
    }

    /// The name after the last `.` or `:`.
    pub fn short_name(&self) -> &'static str {
        self.name.rsplit(['.', ':']).next().unwrap_or(self.name)
    }
}

/// A figure of a noun: `strands.count`.
pub struct Getter {
    /// As a script writes it.
    pub name: &'static str,
    /// What it is.
    pub doc: &'static str,
    /// Its type: `number`, `vector`.
    pub returns: &'static str,
    /// Reads it.
    pub get: fn(&Handle) -> Value,
}

/// Finds what a noun has by other names than those it was described with: the parts of a tested scene.
#[derive(Clone, Copy)]
pub struct Lookup {
    /// The type of what is behind them.
    pub returns: &'static str,
    /// All such names of a value.
    pub names: fn(&mlua::Lua, &Handle) -> mlua::Result<Vec<String>>,
    /// What is behind one of them.
    pub get: fn(&mlua::Lua, &Handle, &str) -> mlua::Result<Value>,
}

/// A kind of value that Coif makes.
pub struct Noun {
    /// As messages and the reference call it.
    pub name: &'static str,
    /// What it is.
    pub doc: &'static str,
    /// Its methods.
    pub methods: Vec<Entry>,
    /// Its figures.
    pub getters: Vec<Getter>,
    /// Names that differ from value to value.
    pub lookup: Option<Lookup>,
    /// What `tostring` gives, without the angle brackets.
    pub text: fn(&Handle) -> String,
}

impl Noun {
    /// The noun of an object type.
    pub fn of<T: Object>(
        doc: &'static str,
        methods: Vec<Entry>,
        getters: Vec<Getter>,
        text: fn(&Handle) -> String,
    ) -> Self {
        Self { name: T::NAME, doc, methods, getters, lookup: None, text }
    }

    /// The same with names that differ from value to value.
    #[must_use]
    pub fn with_lookup(mut self, lookup: Lookup) -> Self {
        self.lookup = Some(lookup);
        self
    }
}

/// A constant: `coif.up`.
pub struct Constant {
    /// `coif.up`.
    pub name: &'static str,
    /// What it is.
    pub doc: &'static str,
    /// Its value.
    pub value: fn() -> Value,
}

/// The whole language.
pub struct Registry {
    /// Functions below `coif`.
    pub functions: Vec<Entry>,
    /// Functions below `coif` that only `coif test` gives.
    pub test_functions: Vec<Entry>,
    /// Kinds of values.
    pub nouns: Vec<Noun>,
    /// Constants below `coif`.
    pub constants: Vec<Constant>,
}

/// The whole language, in the order of the reference.
pub fn registry() -> &'static Registry {
    static REGISTRY: OnceLock<Registry> = OnceLock::new();
    REGISTRY.get_or_init(super::bind::registry)
}

/// The noun of that name.
pub fn noun(name: &str) -> Option<&'static Noun> {
    registry().nouns.iter().find(|n| n.name == name)
}
