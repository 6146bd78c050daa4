//! Lua values to plain data and back.

use std::collections::BTreeMap;

use glam::Vec3;
use mlua::{AnyUserData, Function, Lua};

use super::object::Held;
use crate::params::{Table, Value};

/// Tables deeper than this are a mistake, or contain themselves.
const DEEPEST_TABLE: usize = 32;

/// Entries of all tables of one call together.
const MOST_ENTRIES: usize = 4_000_000;

/// Reads the arguments of one call, putting functions aside.
#[derive(Debug, Default)]
pub struct Reading {
    /// The functions met so far; [`Value::Function`] holds an index into them.
    pub functions: Vec<Function>,
    entries: usize,
}

impl Reading {
    /// A Lua value as plain data.
    ///
    /// # Errors
    /// What is wrong with it, as a message.
    pub fn value(&mut self, value: &mlua::Value) -> Result<Value, String> {
        self.deep(value, 0)
    }

    fn deep(&mut self, value: &mlua::Value, depth: usize) -> Result<Value, String> {
        Ok(match value {
            mlua::Value::Nil => Value::Nil,
            mlua::Value::Boolean(b) => Value::Bool(*b),
            mlua::Value::Integer(n) => Value::Number(*n as f64),
            mlua::Value::Number(n) => Value::Number(*n),
            mlua::Value::String(s) => Value::Text(s.to_string_lossy()),
            mlua::Value::Vector(v) => Value::Vector(Vec3::new(v.x(), v.y(), v.z())),
            mlua::Value::Function(f) => {
                self.functions.push(f.clone());
                Value::Function(self.functions.len() - 1)
            }
            mlua::Value::UserData(u) => Value::Handle(handle(u).ok_or("a value that Coif did not make")?),
            mlua::Value::Table(t) => Value::Table(self.table(t, depth)?),
            other => return Err(format!("expected plain data, got a {}", other.type_name())),
        })
    }

    fn table(&mut self, table: &mlua::Table, depth: usize) -> Result<Table, String> {
        if depth >= DEEPEST_TABLE {
            return Err(format!("a table that is nested more than {DEEPEST_TABLE} levels deep, or contains itself"));
        }
        let mut out = Table::default();
        let mut items: BTreeMap<u64, Value> = BTreeMap::new();
        for pair in table.pairs::<mlua::Value, mlua::Value>() {
            let (key, value) = pair.map_err(|e| e.to_string())?;
            self.entries += 1;
            if self.entries > MOST_ENTRIES {
                return Err(format!("more than {MOST_ENTRIES} entries in the tables of one call"));
            }
            let value = self.deep(&value, depth + 1)?;
            match key {
                mlua::Value::Integer(n) if n >= 1 => drop(items.insert(n as u64, value)),
                mlua::Value::Number(n) if n >= 1.0 && n.fract() == 0.0 => drop(items.insert(n as u64, value)),
                mlua::Value::String(s) => drop(out.fields.insert(s.to_string_lossy(), value)),
                other => {
                    let key = self.deep(&other, depth + 1)?;
                    return Err(format!("a table key that is neither a name nor a place in a list: `{key}`"));
                }
            }
        }
        if let Some((&last, _)) = items.last_key_value()
            && last > 2 * items.len() as u64 + 8
        {
            return Err(format!("a list with holes: its last entry is number {last}, but it has {}", items.len()));
        }
        for (i, value) in items {
            // A `nil` amid a list stays where it is, so that the reader can say which entry is missing.
            out.items.resize(i as usize - 1, Value::Nil);
            out.items.push(value);
        }
        Ok(out)
    }
}

/// What Coif put into a userdata.
fn handle(data: &AnyUserData) -> Option<crate::params::Handle> {
    data.borrow::<Held>().ok().map(|held| held.handle().clone())
}

/// A Lua vector.
pub fn vector(v: Vec3) -> mlua::Value {
    mlua::Value::Vector(mlua::Vector::new(v.x, v.y, v.z))
}

/// Plain data as a Lua value; functions become `nil`.
///
/// # Errors
/// When Lua has no memory left.
pub fn to_lua(lua: &Lua, value: &Value) -> mlua::Result<mlua::Value> {
    Ok(match value {
        Value::Nil | Value::Function(_) => mlua::Value::Nil,
        Value::Bool(b) => mlua::Value::Boolean(*b),
        Value::Number(n) => mlua::Value::Number(*n),
        Value::Text(t) => mlua::Value::String(lua.create_string(t)?),
        Value::Vector(v) => vector(*v),
        Value::Handle(h) => mlua::Value::UserData(lua.create_userdata(Held::new(h.clone()))?),
        Value::Table(t) => {
            let table = lua.create_table()?;
            for (i, item) in t.items.iter().enumerate() {
                table.raw_set(i + 1, to_lua(lua, item)?)?;
            }
            for (key, item) in &t.fields {
                table.raw_set(key.as_str(), to_lua(lua, item)?)?;
            }
            mlua::Value::Table(table)
        }
    })
}
