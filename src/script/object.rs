//! The one userdata type: a value that Coif made, with the methods that the registry gives its noun.

use mlua::{AnyUserData, Lua, MetaMethod, UserData, UserDataMethods};

use super::call::invoke;
use super::registry::{self, Noun};
use super::session::session;
use super::strict;
use crate::params::Handle;

/// A [`Handle`] in a script's hands.
pub struct Held(Handle);

impl Held {
    /// Wraps a handle.
    pub fn new(handle: Handle) -> Self {
        Self(handle)
    }

    /// The handle inside.
    pub fn handle(&self) -> &Handle {
        &self.0
    }

    fn noun(&self) -> Option<&'static Noun> {
        registry::noun(self.0.name())
    }

    /// `value.name`: a method, a figure, or an error that names the nearest.
    fn index(&self, lua: &Lua, key: &str) -> mlua::Result<mlua::Value> {
        let Some(noun) = self.noun() else { return Ok(mlua::Value::Nil) };
        if let Some(entry) = noun.methods.iter().find(|m| m.short_name() == key) {
            return method(lua, entry).map(mlua::Value::Function);
        }
        if let Some(getter) = noun.getters.iter().find(|g| g.name == key) {
            return super::convert::to_lua(lua, &(getter.get)(&self.0));
        }
        let mut own = vec![];
        if let Some(lookup) = noun.lookup {
            own = (lookup.names)(lua, &self.0)?;
            if own.iter().any(|n| n == key) {
                return super::convert::to_lua(lua, &(lookup.get)(lua, &self.0, key)?);
            }
        }
        let names = noun.methods.iter().map(|m| m.short_name()).chain(noun.getters.iter().map(|g| g.name));
        let names = own.iter().map(String::as_str).chain(names);
        Err(strict::unknown(lua, &format!("a {}", noun.name), key, names))
    }
}

/// The Lua function of a method, made once per run.
fn method(lua: &Lua, entry: &'static registry::Entry) -> mlua::Result<mlua::Function> {
    let cache = format!("coif.{}", entry.name);
    if let Ok(function) = lua.named_registry_value::<mlua::Function>(&cache) {
        return Ok(function);
    }
    let function = lua.create_function(move |lua, args: mlua::MultiValue| invoke(lua, &*session(lua)?, entry, args))?;
    lua.set_named_registry_value(&cache, &function)?;
    Ok(function)
}

/// The method that calling a value stands for.
pub const CALLED: &str = "with";

/// `value { ... }`: its method [`CALLED`], where it has one.
fn call(lua: &Lua, this: &AnyUserData, args: mlua::MultiValue) -> mlua::Result<mlua::Value> {
    let noun = this.borrow::<Held>()?.noun();
    let Some(entry) = noun.and_then(|n| n.methods.iter().find(|m| m.short_name() == CALLED)) else {
        let message = format!("attempt to call a {}", noun.map_or("value", |n| n.name));
        return Err(strict::raise(lua, &message, Some("it is a value, not a function".into()), None));
    };
    let mut all = args;
    all.push_front(mlua::Value::UserData(this.clone()));
    invoke(lua, &*session(lua)?, entry, all)
}

/// Signs between two values, and the methods they stand for.
pub const OPERATORS: &[(MetaMethod, &str, &str)] =
    &[(MetaMethod::Add, "+", "union"), (MetaMethod::Sub, "-", "minus"), (MetaMethod::Mul, "*", "intersect")];

/// `a + b`, where the first has a method for it.
fn operate(lua: &Lua, sign: &str, name: &str, a: mlua::Value, b: mlua::Value) -> mlua::Result<mlua::Value> {
    let noun = |v: &mlua::Value| v.as_userdata().and_then(|u| u.borrow::<Held>().ok().and_then(|h| h.noun()));
    let entry = noun(&a).and_then(|n| n.methods.iter().find(|m| m.short_name() == name));
    match (entry, noun(&a), noun(&b)) {
        (Some(entry), Some(one), Some(two)) if one.name == two.name => {
            invoke(lua, &*session(lua)?, entry, mlua::MultiValue::from_vec(vec![a, b]))
        }
        (_, one, two) => {
            let what = |noun: Option<&Noun>, value: &mlua::Value| match noun {
                Some(noun) => format!("a {}", noun.name),
                None if value.is_number() || value.is_integer() => "a number".to_owned(),
                None => format!("a {}", value.type_name()),
            };
            let message = format!("`{sign}` does not go between {} and {}", what(one, &a), what(two, &b));
            let hint = "it goes between two regions, between two vectors, or between numbers".to_owned();
            Err(strict::raise(lua, &message, Some(hint), None))
        }
    }
}

impl UserData for Held {
    fn add_methods<M: UserDataMethods<Self>>(methods: &mut M) {
        methods.add_meta_method(MetaMethod::Index, |lua, this, key: mlua::Value| match key.as_string() {
            Some(key) => this.index(lua, &key.to_string_lossy()),
            None => Ok(mlua::Value::Nil),
        });
        methods.add_meta_method(MetaMethod::NewIndex, |lua, this, (key, _): (mlua::Value, mlua::Value)| {
            let message = format!("a {} cannot be changed", this.0.name());
            let hint = "every method gives a new value; nothing is changed in place";
            Err::<(), _>(strict::raise(lua, &message, Some(hint.into()), key.as_string().map(|k| k.to_string_lossy())))
        });
        for (meta, sign, name) in OPERATORS {
            methods.add_meta_function(*meta, move |lua, (a, b): (mlua::Value, mlua::Value)| {
                operate(lua, sign, name, a, b)
            });
        }
        methods.add_meta_function(MetaMethod::Call, |lua, (this, args): (AnyUserData, mlua::MultiValue)| {
            call(lua, &this, args)
        });
        methods.add_meta_method(MetaMethod::ToString, |_, this, ()| {
            Ok(this.noun().map_or_else(|| format!("{:?}", this.0), |n| format!("<{}>", (n.text)(&this.0))))
        });
    }
}
