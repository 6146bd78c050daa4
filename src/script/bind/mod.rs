//! The bindings, one file per noun.
//!
//! Each file has the same shape: parameter structs, then `functions()` or `noun()`, then what they do. A binding reads
//! its arguments strictly, calls the core, and gives the core's errors a place. This file is the table of contents.

mod animate;
mod cage;
mod carry;
mod clip;
mod constants;
mod deform;
mod domain;
mod dynamics;
mod force;
mod garment;
mod golden;
mod guides;
mod head;
mod lattice;
mod material;
mod overlay;
mod params;
mod picture;
mod piece;
mod posed;
mod region;
mod scene;
mod strands;
mod test;
mod tested;
mod tuft;

use mlua::Lua;

use super::call::invoke;
use super::convert::to_lua;
use super::registry::{Constant, Entry, Registry, registry as language};
use super::session::session;
use super::strict;
use crate::params::{Table, Value};

pub use params::Parameter;
pub use scene::scene_of;

/// The whole language.
pub fn registry() -> Registry {
    let functions = [
        params::functions(),
        head::functions(),
        domain::functions(),
        force::functions(),
        tuft::functions(),
        piece::functions(),
        animate::functions(),
        lattice::functions(),
        cage::functions(),
        garment::functions(),
        material::functions(),
        clip::functions(),
        scene::functions(),
    ];
    let nouns = [
        head::nouns(),
        vec![region::noun(), guides::noun(), strands::noun()],
        clip::nouns(),
        domain::nouns(),
        force::nouns(),
        tuft::nouns(),
        vec![animate::noun()],
        vec![piece::noun(), material::noun(), scene::noun(), test::noun()],
        lattice::nouns(),
        cage::nouns(),
        vec![garment::noun()],
        tested::nouns(),
    ];
    Registry {
        functions: functions.into_iter().flatten().collect(),
        test_functions: test::functions(),
        nouns: nouns.into_iter().flatten().collect(),
        constants: constants::constants(),
    }
}

/// The run's seed; what it is without `--seed`.
pub const SEED: Constant = Constant {
    name: "coif.seed",
    doc: "The seed of this run, from `--seed`; 0 without it.",
    value: || Value::Number(0.0),
};

/// A list as a value.
fn list(items: impl IntoIterator<Item = Value>) -> Value {
    Value::Table(Table { items: items.into_iter().collect(), ..Table::default() })
}

/// Makes the global `coif` from the registry.
///
/// # Errors
/// When Lua has no memory left.
pub fn install(lua: &Lua) -> mlua::Result<()> {
    install_all(lua, &[])
}

/// The same with what only tests may call.
///
/// # Errors
/// When Lua has no memory left.
pub fn install_for_tests(lua: &Lua) -> mlua::Result<()> {
    install_all(lua, &language().test_functions)
}

fn install_all(lua: &Lua, more: &'static [Entry]) -> mlua::Result<()> {
    let root = lua.create_table()?;
    let mut folders: Vec<(String, mlua::Table)> = vec![("coif".into(), root.clone())];
    let mut put = |name: &str, value: mlua::Value| -> mlua::Result<()> {
        let mut folder = root.clone();
        let mut path = "coif".to_owned();
        let steps: Vec<&str> = name.split('.').skip(1).collect();
        let Some((last, inner)) = steps.split_last() else { return Ok(()) };
        for step in inner {
            path = format!("{path}.{step}");
            folder = match folder.raw_get::<Option<mlua::Table>>(*step)? {
                Some(table) => table,
                None => {
                    let table = lua.create_table()?;
                    folder.raw_set(*step, &table)?;
                    folders.push((path.clone(), table.clone()));
                    table
                }
            };
        }
        folder.raw_set(*last, value)
    };
    for entry in language().functions.iter().chain(more) {
        let function =
            lua.create_function(move |lua, args: mlua::MultiValue| invoke(lua, &*session(lua)?, entry, args))?;
        put(entry.name, mlua::Value::Function(function))?;
    }
    for constant in &language().constants {
        put(constant.name, to_lua(lua, &(constant.value)())?)?;
    }
    let seed = session(lua)?.options.seed;
    put(SEED.name, mlua::Value::Number(seed as f64))?;
    for (path, table) in &folders {
        strict::seal(lua, table, &format!("`{path}`"))?;
    }
    lua.globals().raw_set("coif", root)
}
