//! The one userdata type: a value that Coif made, with the methods that the registry gives its noun.

use mlua::{Lua, MetaMethod, UserData, UserDataMethods};

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
        let names = noun.methods.iter().map(|m| m.short_name()).chain(noun.getters.iter().map(|g| g.name));
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
        methods.add_meta_method(MetaMethod::ToString, |_, this, ()| {
            Ok(this.noun().map_or_else(|| format!("{:?}", this.0), |n| format!("<{}>", (n.text)(&this.0))))
        });
    }
}
