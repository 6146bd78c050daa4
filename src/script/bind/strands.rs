//! Strands: grown guides, and the hair that fills the space between them.

use std::sync::Arc;

use super::super::call::{Call, Result};
use super::super::limits::Need;
use super::super::registry::{Entry, Getter, Noun};
use super::clip::MovingStrands;
use super::head::give;
use super::overlay;
use super::region::Area;
use crate::geometry::{Clip, Root, Strands};
use crate::groom::{
    Deform, DeformOptions, Fill, FillOptions, NaturalQueue, count_inside, deform, deform_clip, deformed_points, fill,
    fill_clip, member_nodes,
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

/// What to write where a colour's name was written.
const MATERIAL_HINT: &str =
    "write `{ root_colour = \"#3a1d12\", tip_colour = \"#7d4427\" }`, or take one of `require \"coif/looks\"`";

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
            other => reader.problem(
                format!("expected a HairMaterial, or its fields in braces, got {} `{other}`", other.type_name()),
                Some(MATERIAL_HINT.to_owned()),
            ),
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
    methods.extend(super::dynamics::methods());
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

/// What `natural` was called with, besides the strands.
struct Naturals {
    queue: NaturalQueue,
    which: Vec<bool>,
    margin: f32,
    seed: u64,
}

impl Naturals {
    fn read(call: &Call, lock: &Lock) -> Result<Self> {
        let options: DeformOptions = call.read()?;
        let queue = NaturalQueue::new(options.domains).map_err(|e| call.groom(&e))?;
        let which = match options.r#where {
            Some(test) => call.choose(test, "where", &lock.strands.roots)?,
            None => vec![],
        };
        Ok(Self { queue, which, margin: options.margin, seed: call.seed(options.seed) })
    }

    fn input<'a>(&'a self, lock: &'a Lock) -> Deform<'a> {
        Deform {
            strands: &lock.strands,
            queue: &self.queue,
            which: &self.which,
            solid: Some(&lock.area.head.solid),
            margin: self.margin,
            seed: self.seed,
        }
    }

    fn digest(&self, lock: &Lock, into: &mut Digest) {
        into.key(lock.area.head.key()).data(&self.queue.domains()).flags(&self.which).floats(&[self.margin]);
        into.number(self.seed);
    }

    /// The lock with other strands. Deformed guides are guides still; deformed members keep theirs.
    fn lock(&self, lock: &Lock, strands: Arc<Strands>) -> Lock {
        let mut overlay = Overlay::clone(&lock.overlay);
        overlay.extend(&overlay::naturals(self.queue.domains()));
        let is_guide = Arc::ptr_eq(&lock.strands, &lock.guides);
        let guides = if is_guide { Arc::clone(&strands) } else { Arc::clone(&lock.guides) };
        Lock { strands, guides, overlay: Arc::new(overlay), ..lock.clone() }
    }
}

fn natural(call: &Call) -> Result<Value> {
    let this = call.this::<Lock>()?;
    let naturals = Naturals::read(call, &this)?;
    let mut key = Digest::new("natural 1");
    key.key(call.session.options.memo.content(&this.strands));
    naturals.digest(&this, &mut key);
    let input = naturals.input(&this);
    let points = match call.session.options.memo.get::<Strands>(key.finish()) {
        Some((known, _)) => known.points.len(),
        None => deformed_points(&input, call.task()).map_err(|e| call.groom(&e))?,
    };
    call.claim("", Need { points: points as u64, ..Need::strands(this.strands.count(), 0) })?;
    let make = || deform(&input, call.task()).map_err(|e| call.groom(&e));
    let strands = call.memo_strands(&key, &this.strands.sources, make)?;
    Ok(give(naturals.lock(&this, strands)))
}

/// `StrandsClip:natural`.
pub fn natural_clip(call: &Call) -> Result<Value> {
    let this = call.this::<MovingStrands>()?;
    let naturals = Naturals::read(call, &this.rest)?;
    let mut key = Digest::new("natural clip 1");
    key.key(this.key);
    naturals.digest(&this.rest, &mut key);
    let input = naturals.input(&this.rest);
    let head = this.motion.as_ref().map(|m| &m.clip);
    let points = deformed_points(&input, call.task()).map_err(|e| call.groom(&e))?;
    call.claim(
        "",
        frames(Need { points: points as u64, ..Need::strands(this.rest.strands.count(), 0) }, &this.strands),
    )?;
    let make = || deform_clip(&input, &this.strands, head, call.task()).map_err(|e| call.groom(&e));
    let moving = call.memo_moving(&key, &this.rest.strands.sources, make)?;
    let is_guide = Arc::ptr_eq(&this.rest.strands, &this.rest.guides);
    let rest = naturals.lock(&this.rest, Arc::new(moving.rest.clone()));
    let strands = moving.frames.clone();
    let guides = if is_guide { strands.clone() } else { this.guides.clone() };
    Ok(give(MovingStrands { rest, strands, guides, motion: this.motion.clone(), key: key.finish() }))
}

/// What `fill` was called with, besides the guides.
struct Filling {
    options: FillOptions,
    material: Option<Look>,
    area: Area,
    /// All of them.
    roots: Arc<Vec<Root>>,
    /// How many of these grow, fewer for a draft: the first of their order are a sparser fill of the same region.
    few: usize,
    source: Arc<str>,
}

impl Filling {
    /// `times` is how often every strand is there: once, or in every frame.
    fn read(call: &Call, lock: &Lock, times: impl Fn(Need) -> Need) -> Result<Self> {
        let (mut options, extras) = call.read_both::<FillOptions, FillExtras>()?;
        options.seed = call.seed(options.seed);
        let area = match &extras.region {
            Some(area) if !Arc::ptr_eq(&area.head, &lock.area.head) => {
                let hint = "make both from one head, and make that once: `local head = coif.head()`".to_owned();
                return Err(call.problem_at("region", "the region is of another head", Some(hint)));
            }
            Some(area) => Area::clone(area),
            None => lock.area.clone(),
        };
        let draft = call.session.options.draft;
        let few = |count: usize| draft.map_or(count, |most| count.min(most.max(1)));
        let nodes = member_nodes(&lock.strands, &options);
        // What is refused whatever the limits has words of its own.
        if extras.density.is_none() && options.strands <= MOST_ROOTS {
            call.claim("strands", times(Need::strands(few(options.strands), nodes)))?;
        }
        let roots = area.roots(call, ("strands", options.strands), extras.density, options.seed)?;
        let few = few(roots.len());
        if extras.density.is_some() {
            call.claim("density", times(Need::strands(few, nodes)))?;
        }
        Ok(Self { options, material: extras.material, area, roots, few, source: call.source() })
    }

    /// Calls `make` with what the core takes.
    fn with<R>(&self, lock: &Lock, make: impl FnOnce(&Fill) -> R) -> R {
        let partings = &lock.area.partings;
        let separated = |a, b| partings.iter().any(|p| p.separates(a, b));
        make(&Fill {
            guides: &lock.strands,
            roots: &self.roots[..self.few],
            options: &self.options,
            separated: (!partings.is_empty()).then_some(&separated),
            solid: Some(&self.area.head.solid),
            source: &self.source,
        })
    }

    /// The key for so many of the roots.
    fn key(&self, mut key: Digest, count: usize, lock: &Lock) -> Digest {
        let roots = &self.roots[..count];
        key.key(self.area.head.key()).data(&self.options).packed(roots, Root::bytes).data(&lock.area.partings);
        key
    }

    /// Notes that a draft grows fewer strands; `is_known` says that all of them are there already.
    fn thin(&self, call: &Call, is_known: bool) {
        if call.session.options.draft.is_some() {
            let mut thinned = call.session.thinned.get();
            thinned.members += self.few;
            thinned.of += self.roots.len();
            thinned.pending += if is_known { 0 } else { self.roots.len() };
            call.session.thinned.set(thinned);
        }
    }

    /// The filled lock.
    fn lock(&self, lock: &Lock, strands: Arc<Strands>) -> Lock {
        Lock {
            strands,
            guides: Arc::clone(&lock.strands),
            area: lock.area.clone(),
            material: self.material.as_ref().map_or_else(|| lock.material.clone(), |look| look.0.clone()),
            overlay: Arc::clone(&lock.overlay),
            source: Arc::clone(&self.source),
            stands_for: self.roots.len() as f32 / self.few.max(1) as f32,
        }
    }
}

fn fill_strands(call: &Call) -> Result<Value> {
    let this = call.this::<Lock>()?;
    let filling = Filling::read(call, &this, |need| need)?;
    let memo = &call.session.options.memo;
    let key = |count| {
        let mut key = Digest::new("fill 1");
        key.key(memo.content(&this.strands));
        filling.key(key, count, &this)
    };
    filling.thin(call, memo.has(key(filling.roots.len()).finish()));
    let key = key(filling.few);
    let made = || filling.with(&this, |input| fill(input, call.task()).map_err(|e| call.groom(&e)));
    let strands = call.memo_strands(&key, &[Arc::clone(&filling.source)], made)?;
    Ok(give(filling.lock(&this, strands)))
}

/// `StrandsClip:fill`.
pub fn fill_clip_strands(call: &Call) -> Result<Value> {
    let this = call.this::<MovingStrands>()?;
    let filling = Filling::read(call, &this.rest, |need| frames(need, &this.strands))?;
    let key = |count| {
        let mut key = Digest::new("fill clip 1");
        key.key(this.key);
        filling.key(key, count, &this.rest)
    };
    filling.thin(call, call.session.options.memo.has(key(filling.roots.len()).finish()));
    let key = key(filling.few);
    let head = this.motion.as_ref().map(|m| &m.clip);
    let made = || {
        let make = |input: &Fill| fill_clip(input, &this.strands, head, call.task()).map_err(|e| call.groom(&e));
        filling.with(&this.rest, make)
    };
    let moving = call.memo_moving(&key, &[Arc::clone(&filling.source)], made)?;
    let rest = filling.lock(&this.rest, Arc::new(moving.rest.clone()));
    let (strands, guides) = (moving.frames.clone(), this.strands.clone());
    Ok(give(MovingStrands { rest, strands, guides, motion: this.motion.clone(), key: key.finish() }))
}

/// `StrandsClip:material`.
pub fn material_clip(call: &Call) -> Result<Value> {
    let (this, fields) = (call.this::<MovingStrands>()?, call.read::<MaterialFields>()?);
    let rest = Lock { material: fields.material.0, ..this.rest.clone() };
    Ok(give(MovingStrands { rest, ..MovingStrands::clone(&this) }))
}

/// What something takes in every frame of a clip, and at rest.
fn frames(once: Need, clip: &Clip<Strands>) -> Need {
    once.times(clip.count() as u64 + 1)
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
