//! How things look.

use std::sync::Arc;

use super::super::call::{Call, Result};
use super::super::registry::{Entry, Noun};
use crate::params::{Handle, Object, Value};
use crate::scene::HairMaterial;

impl Object for HairMaterial {
    const NAME: &'static str = "HairMaterial";
}

/// `coif.material.hair`.
pub fn functions() -> Vec<Entry> {
    vec![Entry::table::<HairMaterial>("coif.material.hair", "HairMaterial", hair)]
}

/// A material.
pub fn noun() -> Noun {
    Noun::of::<HairMaterial>("How hair looks; made by `coif.material.hair`.", vec![], vec![], |h| {
        h.get::<HairMaterial>()
            .map_or_else(String::new, |m| format!("hair material {} to {}", m.root_colour, m.tip_colour))
    })
}

fn hair(call: &Call) -> Result<Value> {
    let material: HairMaterial = call.read()?;
    Ok(Value::Handle(Handle::new(Arc::new(material))))
}
