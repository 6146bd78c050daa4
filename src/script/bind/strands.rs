//! Strands: grown guides, and the hair that fills the space between them.

use std::sync::Arc;

use super::super::call::{Call, Result};
use super::super::limits::Need;
use super::super::registry::{Entry, Getter, Noun};
use super::head::give;
use super::overlay;
use super::region::Area;
use crate::geometry::{Root, Strands};
use crate::groom::{
    Deform, DeformOptions, Fill, FillOptions, NaturalQueue, count_inside, deform, deformed_points, fill, member_nodes,
};
use crate::head::MOST_ROOTS;
use crate::math::Digest;
use crate::params::{Object, Table, Value};
use crate::scene::{HairMaterial, Overlay};

/// Strands on their head, with their look.
#[derive(Clone, Debug)]
pub struct Lock {
    /// The strands.
    pub strands: Arc<Strands>,
    /// The guides they follow; themselves when they are guides.
    pub guides: Arc<Strands>,
    /// Where they grow.
    pub area: Area,
    /// How they look.
    pub material: HairMaterial,
    /// Domains, partings and roots.
    pub overlay: Arc<Overlay>,
    /// Place in the script that made them.
    pub source: Arc<str>,
    /// How many strands each of them stands for: 1, but in a draft more.
    pub stands_for: f32,
}

impl Object for Lock {
    const NAME: &'static str = "Strands";
}

crate::params! {
    /// What else `fill` takes.
    pub struct FillExtras("Strands:fill") {
        /// Strands per square centimetre, instead of `strands`.
        density: Option<f32>, unit("1/cm^2"), range(0.0001, 100000.0);
        /// Where to fill; where the guides grow when left out.
        region: Option<Arc<Area>>;
        /// How the hair looks: `coif.material.hair { ... }`.
        material: Option<Look>;
    }
}

crate::params! {
    /// The same strands with another look.
    pub struct MaterialFields("Strands:material") {
        /// `coif.material.hair { ... }`, or its fields.
        material: Look;
    }
}

/// A hair material, given as one or by its fields.
#[derive(Clone, Debug)]
pub struct Look(HairMaterial);

impl crate::params::FieldType for Look {
    fn kind() -> crate::params::Kind {
        use crate::params::Kind;
        Kind::OneOf(vec![Kind::Object(HairMaterial::NAME), Kind::Struct("coif.material.hair")])
    }
    fn read(value: &Value, reader: &mut crate::params::Reader) -> Option<Self> {
        match value {
            Value::Handle(h) => match h.get::<HairMaterial>() {
                Some(material) => Some(Self((*material).clone())),
                None => reader.wrong_type("a HairMaterial", value),
            },
            Value::Table(table) => crate::params::Params::read(table, reader).map(Self),
            other => reader.wrong_type("a HairMaterial, or its fields in braces", other),
        }
    }
}

/// Strands.
pub fn noun() -> Noun {
    let mut methods = vec![
        Entry::table::<DeformOptions>("Strands:natural", "Strands", natural),
        Entry::both::<FillOptions, FillExtras>("Strands:fill", "Strands", fill_strands),
        Entry::positional::<MaterialFields>("Strands:material", "Strands", material),
        Entry::plain(
            "Strands:stats",
            "Figures: `strands`, `points`, `guides`, `mean_length`, `longest`, `shortest` (cm), `inside` (strands with a \
             node or a segment inside the head), `min` and `max` (corners of the bounding box).",
            "table",
            stats,
        )
        .sealed("the table of figures"),
    ];
    methods.extend(super::deform::strands_methods());
    let getters = vec![Getter {
        name: "count",
        doc: "How many strands.",
        returns: "number",
        get: |h| h.get::<Lock>().map_or(Value::Nil, |l| Value::Number(l.strands.count() as f64)),
    }];
    Noun::of::<Lock>("Strands of hair on a head.", methods, getters, |h| {
        h.get::<Lock>()
            .map_or_else(String::new, |l| format!("{} strands, {} points", l.strands.count(), l.strands.points.len()))
    })
}

fn natural(call: &Call) -> Result<Value> {
    let (this, options) = (call.this::<Lock>()?, call.read::<DeformOptions>()?);
    let queue = NaturalQueue::new(options.domains).map_err(|e| call.groom(&e))?;
    let which = match options.r#where {
        Some(test) => call.choose(test, "where", &this.strands.roots)?,
        None => vec![],
    };
    let input = Deform {
        strands: &this.strands,
        queue: &queue,
        which: &which,
        solid: Some(&this.area.head.solid),
        margin: options.margin,
        seed: call.seed(options.seed),
    };
    let mut key = Digest::new("natural 1");
    key.key(this.area.head.key()).key(call.session.options.memo.content(&this.strands));
    key.data(&queue.domains()).flags(&which).floats(&[options.margin]).number(input.seed);
    let points = match call.session.options.memo.get::<Strands>(key.finish()) {
        Some((known, _)) => known.points.len(),
        None => deformed_points(&input, call.task()).map_err(|e| call.groom(&e))?,
    };
    call.claim("", Need { points: points as u64, ..Need::strands(this.strands.count(), 0) })?;
    let sources = &this.strands.sources;
    let strands = call.memo_strands(&key, sources, || deform(&input, call.task()).map_err(|e| call.groom(&e)))?;
    let mut overlay = Overlay::clone(&this.overlay);
    overlay.extend(&overlay::naturals(queue.domains()));
    // Deformed guides are guides still; deformed members keep theirs.
    let is_guide = Arc::ptr_eq(&this.strands, &this.guides);
    let guides = if is_guide { Arc::clone(&strands) } else { Arc::clone(&this.guides) };
    Ok(give(Lock { strands, guides, overlay: Arc::new(overlay), ..Lock::clone(&this) }))
}

fn fill_strands(call: &Call) -> Result<Value> {
    let this = call.this::<Lock>()?;
    let (mut options, extras) = call.read_both::<FillOptions, FillExtras>()?;
    options.seed = call.seed(options.seed);
    let area = match &extras.region {
        Some(area) if !Arc::ptr_eq(&area.head, &this.area.head) => {
            let hint = "make both from one head, and make that once: `local head = coif.head()`".to_owned();
            return Err(call.problem_at("region", "the region is of another head", Some(hint)));
        }
        Some(area) => area,
        None => &this.area,
    };
    let head = &area.head;
    // The first roots of the order are a sparser fill of the same region.
    let draft = call.session.options.draft;
    let few = |count: usize| draft.map_or(count, |most| count.min(most.max(1)));
    let nodes = member_nodes(&this.strands, &options);
    // What is refused whatever the limits has words of its own.
    if extras.density.is_none() && options.strands <= MOST_ROOTS {
        call.claim("strands", Need::strands(few(options.strands), nodes))?;
    }
    let roots = area.roots(call, ("strands", options.strands), extras.density, options.seed)?;
    let few = few(roots.len());
    if extras.density.is_some() {
        call.claim("density", Need::strands(few, nodes))?;
    }
    let partings = &this.area.partings;
    let separated = |a, b| partings.iter().any(|p| p.separates(a, b));
    let source = call.source();
    let memo = &call.session.options.memo;
    let key = |roots: &[Root]| {
        let mut key = Digest::new("fill 1");
        key.key(head.key()).key(memo.content(&this.strands));
        key.data(&options).packed(roots, Root::bytes).data(partings);
        key
    };
    if draft.is_some() {
        let mut thinned = call.session.thinned.get();
        thinned.members += few;
        thinned.of += roots.len();
        thinned.pending += if memo.has(key(&roots).finish()) { 0 } else { roots.len() };
        call.session.thinned.set(thinned);
    }
    let input = Fill {
        guides: &this.strands,
        roots: &roots[..few],
        options: &options,
        separated: (!partings.is_empty()).then_some(&separated),
        solid: Some(&head.solid),
        source: &source,
    };
    let made = || fill(&input, call.task()).map_err(|e| call.groom(&e));
    let strands = call.memo_strands(&key(input.roots), &[Arc::clone(&source)], made)?;
    let material = extras.material.map_or_else(|| this.material.clone(), |look| look.0);
    Ok(give(Lock {
        strands,
        guides: Arc::clone(&this.strands),
        area: this.area.clone(),
        material,
        overlay: Arc::clone(&this.overlay),
        source,
        stands_for: roots.len() as f32 / few.max(1) as f32,
    }))
}

fn material(call: &Call) -> Result<Value> {
    let (this, fields) = (call.this::<Lock>()?, call.read::<MaterialFields>()?);
    Ok(give(Lock { material: fields.material.0, ..Lock::clone(&this) }))
}

fn stats(call: &Call) -> Result<Value> {
    let this = call.this::<Lock>()?;
    let strands = &this.strands;
    let lengths: Vec<f32> = (0..strands.count()).map(|i| strands.length(i)).collect();
    let sum: f64 = lengths.iter().copied().map(f64::from).sum();
    let bounds = strands.bounds();
    let number = |n: f64| Value::Number(n);
    let fields = [
        ("strands", number(strands.count() as f64)),
        ("points", number(strands.points.len() as f64)),
        ("guides", number(this.guides.count() as f64)),
        ("mean_length", number(sum / lengths.len().max(1) as f64)),
        ("longest", number(f64::from(lengths.iter().copied().fold(0.0, f32::max)))),
        ("shortest", number(f64::from(lengths.iter().copied().reduce(f32::min).unwrap_or(0.0)))),
        ("inside", number(count_inside(strands, &this.area.head.solid) as f64)),
        ("min", Value::Vector(bounds.min)),
        ("max", Value::Vector(bounds.max)),
    ];
    let fields = fields.into_iter().map(|(k, v)| (k.to_owned(), v)).collect();
    Ok(Value::Table(Table { fields, ..Table::default() }))
}
