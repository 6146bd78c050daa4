//! Regions of a head: where hair grows.

use std::sync::Arc;

use super::super::call::{Call, Result};
use super::super::registry::{Entry, Getter, Noun};
use super::guides::Seedlings;
use super::head::give;
use crate::geometry::Root;
use crate::groom::{GuideOptions, Guides};
use crate::head::{Head, Parting, Region, RootsError, roots, roots_by_density};
use crate::math::Digest;
use crate::params::{Function, Object, Value};
use crate::task::Warned;

/// A region together with its head and its partings.
#[derive(Clone, Debug)]
pub struct Area {
    /// The head.
    pub head: Arc<Head>,
    /// The part of it.
    pub region: Region,
    /// Lines that strands never blend across.
    pub partings: Vec<Arc<Parting>>,
}

impl Object for Area {
    const NAME: &'static str = "Region";
}

impl Area {
    /// Without partings.
    pub fn new(head: Arc<Head>, region: Region) -> Self {
        Self { head, region, partings: vec![] }
    }

    /// So many roots on it (with the name of the field that says so), or by their density.
    ///
    /// # Errors
    /// Counts that make no sense, an empty region, cancelling.
    pub fn roots(&self, call: &Call, count: (&str, usize), density: Option<f32>, seed: u64) -> Result<Arc<Vec<Root>>> {
        let (field, count) = if density.is_some() { ("density", 0) } else { count };
        let (head, region, task) = (&self.head, &self.region, call.task());
        let mut key = Digest::new("roots 1");
        match density {
            Some(density) => key.number(0).floats(&[density]),
            None => key.number(1).number(count as u64),
        };
        region.digest(key.key(head.key()).number(seed));
        call.memo(&key, || {
            let found = match density {
                Some(density) => roots_by_density(head, region, density, seed, task),
                None => roots(head, region, count, seed, task),
            };
            found.map(Warned::clean).map_err(|e| match e {
                RootsError::Empty => call.problem(e.to_string(), e.hint()),
                e => call.problem_at(field, e.to_string(), e.hint()),
            })
        })
    }

    fn with(&self, region: Region) -> Self {
        Self { region, ..self.clone() }
    }
}

crate::params! {
    /// What is in either of two regions; also written `a + b`.
    pub struct UnionFields("Region:union") {
        /// The other region, of the same head.
        other: Arc<Area>;
    }
}

crate::params! {
    /// What is in both of two regions; also written `a * b`.
    pub struct IntersectFields("Region:intersect") {
        /// The other region, of the same head.
        other: Arc<Area>;
    }
}

crate::params! {
    /// What is in this region and not in another; also written `a - b`.
    pub struct MinusFields("Region:minus") {
        /// The other region, of the same head.
        other: Arc<Area>;
    }
}

crate::params! {
    /// The part of the region for whose places a function returns true.
    pub struct WhereFields("Region:where") {
        /// Takes a place on the head (a vector), returns true or false.
        test: Function, takes("(place: vector): boolean");
    }
}

crate::params! {
    /// The same region with hair thinned out.
    pub struct DensityFields("Region:density") {
        /// A number from 0 to 1, or a function that takes a place on the head (a vector) and returns one.
        density: Value, takes("number|fun(place: vector): number");
    }
}

crate::params! {
    /// The same region with a parting through it: strands on its two sides never blend.
    pub struct PartFields("Region:parting") {
        /// A parting, or a list of points to lay one through.
        line: Value, takes("Parting|Point[]");
    }
}

crate::params! {
    /// Tells whether the place of the skin nearest to a point is in the region.
    pub struct ContainsFields("Region:contains") {
        /// Any point.
        point: glam::Vec3, unit("cm");
    }
}

crate::params! {
    /// Another way to say how many guides.
    pub struct GuideDensity("Region:guides") {
        /// Guides per square centimetre, instead of `count`.
        density: Option<f32>, unit("1/cm^2"), range(0.0001, 10000.0);
    }
}

/// Regions.
pub fn noun() -> Noun {
    let methods = vec![
        Entry::both::<GuideOptions, GuideDensity>("Region:guides", "Guides", guides),
        Entry::positional::<UnionFields>("Region:union", "Region", union),
        Entry::positional::<IntersectFields>("Region:intersect", "Region", intersect),
        Entry::positional::<MinusFields>("Region:minus", "Region", minus),
        Entry::plain("Region:complement", "The rest of the head.", "Region", complement),
        Entry::positional::<WhereFields>("Region:where", "Region", filter),
        Entry::positional::<DensityFields>("Region:density", "Region", density),
        Entry::positional::<PartFields>("Region:parting", "Region", parting),
        Entry::positional::<ContainsFields>("Region:contains", "boolean", contains),
    ];
    let getters = vec![Getter {
        name: "area",
        doc: "Its area in square centimetres, each place weighted with its density.",
        returns: "number",
        get: |h| h.get::<Area>().map_or(Value::Nil, |a| Value::Number(a.region.area(&a.head))),
    }];
    Noun::of::<Area>("A part of a head's surface, with a density.", methods, getters, |h| {
        h.get::<Area>().map_or_else(String::new, |a| format!("region of {:.0} cm^2", a.region.area(&a.head)))
    })
}

fn guides(call: &Call) -> Result<Value> {
    let area = call.this::<Area>()?;
    let (mut options, density) = call.read_both::<GuideOptions, GuideDensity>()?;
    options.seed = call.seed(options.seed);
    let roots = area.roots(call, ("count", options.count), density.density, options.seed)?;
    options.check(&roots).map_err(|e| call.groom(&e))?;
    let guides = Guides { roots: Vec::clone(&roots), options, source: call.source() };
    Ok(give(Seedlings { guides, area: Area::clone(&area) }))
}

/// The other region of a set operation, if it is of the same head.
fn other<'a>(call: &Call, this: &Area, other: &'a Arc<Area>) -> Result<&'a Area> {
    if Arc::ptr_eq(&this.head, &other.head) {
        return Ok(other);
    }
    let hint = "make both from one head, and make that once: `local head = coif.head()`".to_owned();
    Err(call.problem_at("other", "the two regions are of different heads", Some(hint)))
}

fn union(call: &Call) -> Result<Value> {
    let (this, fields) = (call.this::<Area>()?, call.read::<UnionFields>()?);
    let other = other(call, &this, &fields.other)?;
    Ok(give(joined(&this, other, this.region.or(&other.region))))
}

fn intersect(call: &Call) -> Result<Value> {
    let (this, fields) = (call.this::<Area>()?, call.read::<IntersectFields>()?);
    let other = other(call, &this, &fields.other)?;
    Ok(give(joined(&this, other, this.region.and(&other.region))))
}

fn minus(call: &Call) -> Result<Value> {
    let (this, fields) = (call.this::<Area>()?, call.read::<MinusFields>()?);
    let other = other(call, &this, &fields.other)?;
    Ok(give(this.with(this.region.minus(&other.region))))
}

/// With the partings of both.
fn joined(this: &Area, other: &Area, region: Region) -> Area {
    let mut area = this.with(region);
    for parting in &other.partings {
        if !area.partings.iter().any(|p| Arc::ptr_eq(p, parting)) {
            area.partings.push(Arc::clone(parting));
        }
    }
    area
}

fn complement(call: &Call) -> Result<Value> {
    let this = call.this::<Area>()?;
    Ok(give(this.with(this.region.complement())))
}

fn filter(call: &Call) -> Result<Value> {
    let (this, fields) = (call.this::<Area>()?, call.read::<WhereFields>()?);
    let places = Region::sample_points(&this.head);
    let which = call.choose(fields.test, "test", &places)?;
    let values = which.into_iter().map(|w| if w { 1.0 } else { 0.0 }).collect();
    let sampled = Region::sampled(&this.head, values, true).map_err(|e| call.problem(e.to_string(), e.hint()))?;
    Ok(give(this.with(this.region.and(&sampled))))
}

fn density(call: &Call) -> Result<Value> {
    let (this, fields) = (call.this::<Area>()?, call.read::<DensityFields>()?);
    let bad = |value: &Value| {
        let hint = "a density is a number from 0 (no hair) to 1 (all of it)".to_owned();
        call.problem_at("density", format!("`{value}` is not a density"), Some(hint))
    };
    let number = |value: Value| match value {
        Value::Number(n) if (0.0..=1.0).contains(&n) => Ok(n as f32),
        other => Err(bad(&other)),
    };
    match fields.density {
        Value::Function(f) => {
            let places: Vec<Root> = Region::sample_points(&this.head);
            let ask = |root: &Root| number(call.script(Function(f), &[Value::Vector(root.position)])?);
            let values: Vec<f32> = places.iter().map(ask).collect::<Result<_>>()?;
            let sampled =
                Region::sampled(&this.head, values, false).map_err(|e| call.problem(e.to_string(), e.hint()))?;
            Ok(give(this.with(this.region.times(&sampled))))
        }
        value => Ok(give(this.with(this.region.thinned(number(value)?)))),
    }
}

fn parting(call: &Call) -> Result<Value> {
    let (this, fields) = (call.this::<Area>()?, call.read::<PartFields>()?);
    let parting = match &fields.line {
        Value::Handle(h) => h.get::<Parting>(),
        _ => None,
    };
    let parting = match parting {
        Some(parting) => parting,
        None => {
            let mut reader = crate::params::Reader::default();
            let points: Option<Vec<glam::Vec3>> =
                reader.inside("line", |r| crate::params::FieldType::read(&fields.line, r));
            let Some(points) = points else { return Err(call.problems(reader.problems())) };
            Arc::new(Parting::new(&this.head, &points).map_err(|e| call.problem_at("line", e.to_string(), None))?)
        }
    };
    let mut area = Area::clone(&this);
    area.partings.push(parting);
    Ok(give(area))
}

fn contains(call: &Call) -> Result<Value> {
    let (this, fields) = (call.this::<Area>()?, call.read::<ContainsFields>()?);
    Ok(Value::Bool(this.region.contains(&this.head, &this.head.closest(fields.point))))
}
