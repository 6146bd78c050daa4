//! Guides that are yet to grow.

use std::sync::Arc;

use super::super::call::{Call, Result};
use super::super::limits::Need;
use super::super::registry::{Entry, Getter, Noun};
use super::head::give;
use super::overlay;
use super::region::Area;
use super::strands::Lock;
use crate::geometry::Root;
use crate::groom::{Grow, GrowOptions, Guides, grow};
use crate::math::Digest;
use crate::params::{Object, Value};
use crate::scene::HairMaterial;

/// Roots of guides, on their head.
#[derive(Clone, Debug)]
pub struct Seedlings {
    /// The roots and what they share.
    pub guides: Guides,
    /// Where they stand.
    pub area: Area,
}

impl Object for Seedlings {
    const NAME: &'static str = "Guides";
}

/// Guides.
pub fn noun() -> Noun {
    let methods = vec![Entry::table::<GrowOptions>("Guides:grow", "Strands", grow_guides)];
    let getters = vec![
        Getter {
            name: "count",
            doc: "How many.",
            returns: "number",
            get: |h| h.get::<Seedlings>().map_or(Value::Nil, |g| Value::Number(g.guides.roots.len() as f64)),
        },
        Getter {
            name: "roots",
            doc: "Where they stand, as a list of vectors.",
            returns: "vector[]",
            get: |h| {
                h.get::<Seedlings>()
                    .map_or(Value::Nil, |g| super::list(g.guides.roots.iter().map(|r| Value::Vector(r.position))))
            },
        },
    ];
    Noun::of::<Seedlings>(
        "Roots of the strands that stand for wisps; `grow` makes strands of them.",
        methods,
        getters,
        |h| h.get::<Seedlings>().map_or_else(String::new, |g| format!("{} guides", g.guides.roots.len())),
    )
}

fn grow_guides(call: &Call) -> Result<Value> {
    let (this, options) = (call.this::<Seedlings>()?, call.read::<GrowOptions>()?);
    let mut local_of: Vec<Option<u16>> = vec![];
    if !options.locals.is_empty() {
        local_of = vec![None; this.guides.roots.len()];
        for (i, local) in options.locals.iter().enumerate() {
            let which = call.choose(local.r#where, &format!("locals[{}].where", i + 1), &this.guides.roots)?;
            if !which.contains(&true) {
                let warning = crate::task::Warning::new(format!("local queue {} acts on no guide", i + 1))
                    .hint("its `where` is true for no root");
                call.warn(&format!("locals[{}]", i + 1), warning);
            }
            for (own, is_meant) in local_of.iter_mut().zip(which) {
                if is_meant && own.is_none() {
                    *own = u16::try_from(i).ok();
                }
            }
        }
    }
    let locals: Vec<_> = options.locals.iter().map(|l| Arc::clone(&l.queue)).collect();
    let input = Grow {
        guides: &this.guides,
        global: options.global.as_deref(),
        locals: &locals,
        local_of: &local_of,
        solid: Some(&this.area.head.solid),
        margin: options.margin,
    };
    call.claim("", Need::strands(this.guides.roots.len(), this.guides.options.most_steps() + 1))?;
    let mut key = Digest::new("grow 1");
    key.key(this.area.head.key()).data(&this.guides.options).packed(&this.guides.roots, Root::bytes);
    key.data(&options.global).data(&locals).data(&local_of).floats(&[options.margin]);
    let source = Arc::clone(&this.guides.source);
    let strands = call.memo_strands(&key, &[source], || grow(&input, call.task()).map_err(|e| call.groom(&e)))?;
    let mut overlay = overlay::area(&this.area);
    let offset = options.global.as_ref().map_or(0, |q| q.stages().len());
    if let Some(queue) = &options.global {
        overlay.extend(&overlay::queue(queue, 0));
    }
    for queue in &locals {
        overlay.extend(&overlay::queue(queue, offset));
    }
    overlay.extend(&overlay::roots(&this.guides.roots));
    let lock = Lock {
        guides: Arc::clone(&strands),
        strands,
        area: this.area.clone(),
        material: HairMaterial::default(),
        overlay: Arc::new(overlay),
        source: call.source(),
        stands_for: 1.0,
    };
    Ok(give(lock))
}
