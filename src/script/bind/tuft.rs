//! Stylised hair: tufts, the fill between them, their methods.

use std::sync::Arc;

use rayon::prelude::*;

use super::super::call::{Call, Result};
use super::super::limits::Need;
use super::super::memo::Kept;
use super::super::registry::{Entry, Getter, Noun};
use super::super::session::Raised;
use super::head::{PointFields, give};
use crate::geometry::Bounds;
use crate::head::Head;
use crate::math::{Colour, Digest};
use crate::params::{Angle, Direction, FieldType, Kind, Object, Params, Reader, Table, Value};
use crate::scene::TuftMaterial;
use crate::task::{Warned, Warning};
use crate::tuft::{DipOptions, FillOptions, Ground, Tuft, TuftError, TuftOptions, Tufts, dips, fill, lift};

/// How often a profile's function is asked.
const PROFILE_SAMPLES: usize = 33;
/// Dips of one call that are told one by one.
const TOLD: usize = 3;

/// Tufts on their head, with their looks.
#[derive(Clone, Debug)]
pub struct Wig {
    /// The tufts; their colours are indices into `palette`.
    pub tufts: Arc<Tufts>,
    /// What they grow on.
    pub head: Arc<Head>,
    /// Looks, at least one.
    pub palette: Vec<TuftMaterial>,
}

impl Object for Wig {
    const NAME: &'static str = "Tufts";
}

impl Object for TuftMaterial {
    const NAME: &'static str = "TuftMaterial";
}

/// A look of stylised hair: one made by `coif.material.tuft`, its fields, or a colour alone.
#[derive(Clone, Debug)]
pub struct TuftLook(pub TuftMaterial);

impl FieldType for TuftLook {
    fn kind() -> Kind {
        Kind::OneOf(vec![
            Kind::Object(<TuftMaterial as Object>::NAME),
            Kind::Struct("coif.material.tuft"),
            Colour::kind(),
        ])
    }
    fn read(value: &Value, reader: &mut Reader) -> Option<Self> {
        match value {
            Value::Handle(h) => match h.get::<TuftMaterial>() {
                Some(material) => Some(Self((*material).clone())),
                None => reader.wrong_type("a TuftMaterial", value),
            },
            Value::Table(table) => <TuftMaterial as Params>::read(table, reader).map(Self),
            Value::Text(_) => {
                Colour::read(value, reader).map(|colour| Self(TuftMaterial { colour, ..TuftMaterial::default() }))
            }
            other => reader.wrong_type("a TuftMaterial, its fields in braces, or a colour", other),
        }
    }
}

crate::params! {
    /// What else a tuft takes.
    pub struct TuftExtras("coif.tuft") {
        /// The head it grows on; needed only when the script made several.
        head: Option<Arc<Head>>;
        /// Its look: `coif.material.tuft { ... }`, its fields, or a colour as "#6b432b".
        material: Option<TuftLook>;
        /// Moves control points outward where the tuft would run through the head.
        lift: bool = false;
        /// How deep it may lie in the head without a warning, as a fraction of its thickness there.
        dip: f32 = 0.5, range(0.0, 1.0);
    }
}

crate::params! {
    /// What else a fill takes.
    pub struct FillExtras("coif.fill") {
        /// The tufts to fill between, in order, each with the same number of control points. From each to the next the
        /// fill goes about the head from left over back to right; a single tuft, or the same one twice, goes all the
        /// way around. They are part of the result.
        tufts: Vec<Arc<Wig>>, positional();
        /// Moves control points outward where a tuft would run through the head.
        lift: bool = false;
        /// How deep a tuft may lie in the head without a warning, as a fraction of its thickness there.
        dip: f32 = 0.5, range(0.0, 1.0);
    }
}

crate::params! {
    /// Both tufts and others of the same head; also written `a + b`. What is in both is there once.
    pub struct UnionFields("Tufts:union") {
        /// The others.
        other: Arc<Wig>;
    }
}

crate::params! {
    /// Each tuft turned about its own root.
    pub struct RotatedFields("Tufts:rotated") {
        /// By how much.
        angle: Angle, range(-3600.0, 3600.0);
        /// About which direction; straight out of the skin at the root when left out.
        axis: Option<Direction>;
    }
}

crate::params! {
    /// Each tuft several times, set around the head with its roots on the skin.
    pub struct ArrayFields("Tufts:array") {
        /// How many there are of each then.
        count: u32, range(1.0, 1000.0);
        /// From one to the next.
        step: Angle, range(-360.0, 360.0);
        /// The axis through the middle of the skull that they are turned about.
        axis: Direction = Direction(glam::Vec3::Y);
    }
}

crate::params! {
    /// The same tufts with another look.
    pub struct MaterialFields("Tufts:material") {
        /// `coif.material.tuft { ... }`, its fields, or a colour.
        material: TuftLook;
    }
}

/// `coif.tuft`, `coif.fill`, `coif.material.tuft`.
pub fn functions() -> Vec<Entry> {
    vec![
        Entry::both::<TuftOptions, TuftExtras>("coif.tuft", "Tufts", tuft),
        Entry::both::<FillOptions, FillExtras>("coif.fill", "Tufts", fill_between),
        Entry::table::<TuftMaterial>("coif.material.tuft", "TuftMaterial", material),
    ]
}

/// Tufts and their material.
pub fn nouns() -> Vec<Noun> {
    let mut methods = vec![
        Entry::positional::<UnionFields>("Tufts:union", "Tufts", union),
        Entry::plain("Tufts:mirrored", "All tufts on the head's other side.", "Tufts", mirrored),
        Entry::table::<RotatedFields>("Tufts:rotated", "Tufts", rotated),
        Entry::table::<ArrayFields>("Tufts:array", "Tufts", array),
        Entry::positional::<MaterialFields>("Tufts:material", "Tufts", with_material),
        Entry::plain(
            "Tufts:stats",
            "Figures: `tufts`, `triangles`, `mean_length`, `longest`, `shortest` (cm along the stroke, with the buried \
             start), `dips` (places that lie too deep in the head), `deepest` (cm, of these), `min` and `max` (corners \
             of the bounding box).",
            "table",
            stats,
        )
        .sealed("the table of figures"),
    ];
    methods.extend(super::deform::tufts_methods());
    let getters = vec![Getter {
        name: "count",
        doc: "How many tufts.",
        returns: "number",
        get: |h| h.get::<Wig>().map_or(Value::Nil, |w| Value::Number(w.tufts.count() as f64)),
    }];
    let tufts = Noun::of::<Wig>("Locks of stylised hair on a head.", methods, getters, |h| {
        h.get::<Wig>().map_or_else(String::new, |w| match w.tufts.count() {
            1 => "1 tuft".to_owned(),
            n => format!("{n} tufts"),
        })
    });
    let look = "How stylised hair looks; made by `coif.material.tuft`.";
    let material = Noun::of::<TuftMaterial>(look, vec![], vec![], |h| {
        h.get::<TuftMaterial>().map_or_else(String::new, |m| format!("tuft material {}", m.colour))
    });
    vec![tufts, material]
}

/// The head as tufts see it.
pub fn ground(head: &Head) -> Ground<'_> {
    Ground { solid: &head.solid, reference: head.centre(), scale: head.scale }
}

/// The head that a call means: the one it names, else the only one that the script made.
pub fn head_of(call: &Call, given: Option<Arc<Head>>) -> Result<Arc<Head>> {
    if let Some(head) = given {
        return Ok(head);
    }
    let heads: Vec<Arc<Head>> = call.session.heads.borrow().values().cloned().collect();
    match heads.as_slice() {
        [one] => Ok(Arc::clone(one)),
        [] => Err(call.problem("there is no head yet", Some("make one before: `local head = coif.head()`".into()))),
        [..] => {
            let message = format!("the script made {} heads, and this could grow on each", heads.len());
            Err(call.problem(message, Some("say on which one: `head = head`".into())))
        }
    }
}

impl Wig {
    /// This and the other's tufts, those that are in both once. Both are of one head.
    pub fn joined(&self, other: &Self) -> Self {
        let known = |t: &Tuft| {
            let same =
                |k: &Tuft| k.stroke == t.stroke && k.section == t.section && k.up == t.up && k.colour == t.colour;
            self.tufts.tufts.iter().any(same)
        };
        self.with_more(other, |t| !known(t))
    }

    /// This one's tufts, then all of the other's. Both are of one head.
    pub fn followed(&self, other: &Self) -> Self {
        self.with_more(other, |_| true)
    }

    fn with_more(&self, other: &Self, is_wanted: impl Fn(&Tuft) -> bool) -> Self {
        let mut palette = self.palette.clone();
        let places: Vec<u32> = other
            .palette
            .iter()
            .map(|look| {
                let at = palette.iter().position(|p| p == look).unwrap_or_else(|| {
                    palette.push(look.clone());
                    palette.len() - 1
                });
                at as u32
            })
            .collect();
        let fresh: Vec<Tuft> = other
            .tufts
            .tufts
            .iter()
            .map(|t| Tuft { colour: places.get(t.colour as usize).copied().unwrap_or(0), ..t.clone() })
            .filter(is_wanted)
            .collect();
        let mut tufts = Tufts::clone(&self.tufts);
        tufts.extend(&Tufts { tufts: fresh, sources: other.tufts.sources.clone() });
        Self { tufts: Arc::new(tufts), head: Arc::clone(&self.head), palette }
    }

    fn with(&self, tufts: Tufts) -> Self {
        Self { tufts: Arc::new(tufts), ..self.clone() }
    }
}

/// An error of the methods, about the field that it comes from. `points` is the field with the control points; `[]` when
/// the list part of the table has one tuft in each place.
pub fn tuft_error(call: &Call, points: &str, error: &TuftError) -> Raised {
    let of_list = match error {
        TuftError::PointCounts { number, .. } | TuftError::SectionKinds { number, .. } if points == "[]" => {
            format!("[{number}]")
        }
        _ => String::new(),
    };
    let (path, hint) = match error {
        TuftError::TooFewPoints { least: 2, .. } => {
            (points.to_owned(), Some("give the root and at least one point more: { root, tip }".to_owned()))
        }
        TuftError::TooFewPoints { least, .. } => {
            (points.to_owned(), Some(format!("give {least} points or more, in order around the head")))
        }
        TuftError::NotFinite { number, .. } => (format!("{points}[{number}]"), None),
        TuftError::RepeatedPoint { number, .. } => {
            (format!("{points}[{number}]"), Some("leave one of them out, or move it".to_owned()))
        }
        TuftError::NoOutside { .. } => {
            (format!("{points}[1]"), Some("start on the skin: `head:point { azimuth = 0, elevation = 60 }`".to_owned()))
        }
        TuftError::OutOfRange { what, .. } => {
            let field = what.split(' ').next().unwrap_or_default();
            let known = call.has_field(field);
            (if known { field.to_owned() } else { String::new() }, None)
        }
        TuftError::ProfileOrder { number, .. } => {
            let hint = "as in { { 0, 1, 0.6 }, { 0.5, 3, 1 }, { 1, 0, 0 } }".to_owned();
            (format!("profile[{number}]"), Some(hint))
        }
        TuftError::NoSize { .. } if call.has_field("profile") => ("profile".to_owned(), None),
        TuftError::NoSize { .. } => {
            (points.to_owned(), Some("choose a place farther from the root and the tip".to_owned()))
        }
        TuftError::Exclusive { second, .. } => ((*second).to_owned(), Some("leave one of them out".to_owned())),
        TuftError::RingsWithoutSides => ("rings".to_owned(), Some("give `sides` too, as in `sides = 24`".to_owned())),
        TuftError::PointCounts { before, .. } => {
            (of_list, Some(format!("give both strokes the same number of points, say {before}")))
        }
        TuftError::SectionKinds { .. } => {
            (of_list, Some("give both a `diameter`, both an `ellipse`, or both a `profile`".to_owned()))
        }
        TuftError::NoTufts => (String::new(), Some("as in `coif.fill { a, b, around = 60 }`".to_owned())),
        TuftError::NoRoot { .. } => {
            let hint = "hair grows above the ears over the face, and down to 60 degrees below elsewhere; \
                        `everywhere = true` lifts that";
            (String::new(), Some(hint.to_owned()))
        }
        TuftError::Budget { .. } | TuftError::Cancelled(_) => (String::new(), None),
    };
    call.problem_at(&path, error.to_string(), hint)
}

/// Tufts as they are kept: without their place in the script, and what there is to say of them.
struct Made {
    tufts: Vec<Tuft>,
    /// Each about a field of the call, or about all of it.
    warnings: Vec<(&'static str, Warning)>,
}

impl Kept for Made {
    fn bytes(&self) -> usize {
        self.tufts.iter().map(|t| size_of::<Tuft>() + 64 * t.stroke.points().len()).sum::<usize>()
            + self.warnings.len() * 256
    }
}

/// Tufts from the memo or made and settled, as of this call; their warnings told.
fn kept(
    call: &Call,
    mut key: Digest,
    head: &Head,
    (lifts, allowed): (bool, f32),
    make: impl FnOnce() -> Result<Made>,
) -> Result<Tufts> {
    key.key(head.key()).flags(&[lifts]).floats(&[allowed]);
    let made = call.memo(&key, || settle(call, make()?, head, lifts, allowed).map(Warned::clean))?;
    for (path, warning) in &made.warnings {
        call.warn(path, warning.clone());
    }
    Ok(Tufts::new(made.tufts.clone(), &call.source()))
}

/// Tufts that were moved, lifted out of the head when asked; dips are told.
pub fn settled(call: &Call, tufts: Tufts, head: &Head, lifts: bool, allowed: f32) -> Result<Tufts> {
    let sources: Vec<(u64, u16)> = tufts.tufts.iter().map(|t| (t.id, t.source)).collect();
    let made = settle(call, Made { tufts: tufts.tufts, warnings: vec![] }, head, lifts, allowed)?;
    for (path, warning) in made.warnings {
        call.warn(path, warning);
    }
    let own = |(tuft, (id, source)): (Tuft, (u64, u16))| Tuft { id, source, ..tuft };
    Ok(Tufts { tufts: made.tufts.into_iter().zip(sources).map(own).collect(), sources: tufts.sources })
}

/// Looks for tufts that run through the head: lifts them out when asked, warns of the rest.
fn settle(call: &Call, mut made: Made, head: &Head, lifts: bool, allowed: f32) -> Result<Made> {
    let (ground, options) = (ground(head), DipOptions { allowed });
    if lifts {
        let lifted: std::result::Result<Vec<Tuft>, TuftError> =
            made.tufts.par_iter().map(|t| lift(t, &options, &ground).map(|l| l.tuft)).collect();
        made.tufts = lifted.map_err(|e| tuft_error(call, "stroke", &e))?;
    }
    let tufts = Tufts::new(made.tufts, "");
    let mut found =
        dips(&tufts, &options, &ground, call.task()).map_err(|e| tuft_error(call, "stroke", &TuftError::from(e)))?;
    // The deepest first.
    found.sort_by(|a, b| b.depth.total_cmp(&a.depth).then(a.tuft.cmp(&b.tuft)));
    for dip in found.iter().take(TOLD) {
        let mut warning = dip.warning();
        if tufts.count() == 1 {
            warning.message = warning.message.replacen("tuft 1 dips", "the tuft dips", 1);
        }
        let hint = if lifts {
            "it could not be lifted out: move its control points outward, or write `bury = true`"
        } else {
            "move the control points outward, write `lift = true` to have them moved, or `bury = true` to allow it"
        };
        made.warnings.push(("", warning.hint(hint)));
    }
    if found.len() > TOLD {
        let more = found.len() - TOLD;
        let s = if more == 1 { "" } else { "s" };
        let warning = Warning::new(format!("{more} more place{s} dip into the head, less deep than these"));
        made.warnings.push(("", warning));
    }
    Ok(Made { tufts: tufts.tufts, ..made })
}

/// The arguments of `coif.tuft` with places of the form { azimuth = , elevation = , height = } made points, and a
/// profile's function sampled.
fn prepared(call: &Call, head: &Head) -> Result<Table> {
    let mut table = call.table().clone();
    if let Some(Value::Table(stroke)) = table.fields.get_mut("stroke") {
        points_of(call, head, "stroke", &mut stroke.items)?;
    }
    if let Some(Value::Function(f)) = table.fields.get("profile") {
        let ask = |i: usize| {
            let t = i as f64 / (PROFILE_SAMPLES - 1) as f64;
            let value = call.script(crate::params::Function(*f), &[Value::Number(t)])?;
            let two = match &value {
                Value::Table(pair) => match pair.items.as_slice() {
                    [Value::Number(w), Value::Number(h)] => Some((*w, *h)),
                    _ => None,
                },
                Value::Number(w) => Some((*w, *w)),
                _ => None,
            };
            match two {
                Some((w, h)) => Ok(super::list([t, w, h].map(Value::Number))),
                None => {
                    let hint = "it returns the width and the thickness in cm".to_owned();
                    Err(call.problem_at("profile", format!("`profile` returned `{value}` for {t}"), Some(hint)))
                }
            }
        };
        let items: Vec<Value> = (0..PROFILE_SAMPLES).map(ask).collect::<Result<_>>()?;
        table.fields.insert("profile".into(), super::list(items));
    }
    Ok(table)
}

/// Replaces { azimuth = , elevation = , height = } among `items` by the point over the head.
pub fn points_of(call: &Call, head: &Head, path: &str, items: &mut [Value]) -> Result<()> {
    let mut reader = Reader::default();
    for (i, item) in items.iter_mut().enumerate() {
        let Value::Table(table) = &*item else { continue };
        if !["azimuth", "elevation", "height"].iter().any(|k| table.fields.contains_key(*k)) {
            continue;
        }
        let read =
            reader.inside(path, |r| r.inside(format!("[{}]", i + 1), |r| <PointFields as Params>::read(table, r)));
        if let Some(p) = read {
            *item = Value::Vector(head.point(p.azimuth.radians, p.elevation.radians, p.height));
        }
    }
    let problems = reader.problems();
    if problems.is_empty() { Ok(()) } else { Err(call.problems(problems)) }
}

fn tuft(call: &Call) -> Result<Value> {
    let given = match call.table().fields.get("head") {
        Some(Value::Handle(h)) => h.get::<Head>(),
        _ => None,
    };
    let head = head_of(call, given)?;
    let table = prepared(call, &head)?;
    let (options, extras) = call.read_both_from::<TuftOptions, TuftExtras>(&table)?;
    let head = extras.head.unwrap_or(head);
    let mut key = Digest::new("tuft 1");
    key.data(&options);
    let tufts = kept(call, key, &head, (extras.lift, extras.dip), || {
        let made = options.build(&ground(&head)).map_err(|e| tuft_error(call, "stroke", &e))?;
        let warnings = made.warnings.into_iter().map(|w| ("stroke[1]", w)).collect();
        Ok(Made { tufts: vec![made.value], warnings })
    })?;
    let palette = vec![extras.material.map_or_else(TuftMaterial::default, |look| look.0)];
    Ok(give(Wig { tufts: Arc::new(tufts), head, palette }))
}

fn material(call: &Call) -> Result<Value> {
    Ok(give(call.read::<TuftMaterial>()?))
}

fn fill_between(call: &Call) -> Result<Value> {
    let (mut options, extras) = call.read_both::<FillOptions, FillExtras>()?;
    options.seed = call.seed(options.seed);
    let Some(first) = extras.tufts.first() else { return Err(tuft_error(call, "", &TuftError::NoTufts)) };
    for (i, wig) in extras.tufts.iter().enumerate() {
        same_head(call, &format!("[{}]", i + 1), first, wig)?;
    }
    // The same tuft twice goes all the way around, so the list is made before what is in it twice is dropped.
    let parents = extras.tufts.iter().skip(1).fold(Wig::clone(first), |all, wig| all.joined(wig));
    let mut chain: Vec<Tuft> = Vec::new();
    for wig in &extras.tufts {
        // Colours of each in the palette of all.
        chain.extend(wig.tufts.tufts.iter().map(|t| {
            let look = &wig.palette[t.colour as usize];
            let colour = parents.palette.iter().position(|p| p == look).unwrap_or(0) as u32;
            Tuft { colour, ..t.clone() }
        }));
    }
    let mut key = Digest::new("fill of tufts 1");
    key.data(&options).data(&chain);
    let fresh = kept(call, key, &first.head, (extras.lift, extras.dip), || {
        let list = if extras.tufts.iter().all(|w| w.tufts.count() == 1) { "[]" } else { "" };
        let made = fill(&chain, &options, &ground(&first.head)).map_err(|e| tuft_error(call, list, &e))?;
        Ok(Made { tufts: made.value, warnings: made.warnings.into_iter().map(|w| ("", w)).collect() })
    })?;
    Ok(give(parents.joined(&Wig { tufts: Arc::new(fresh), ..parents.clone() })))
}

/// Refuses tufts of two heads.
fn same_head(call: &Call, path: &str, a: &Wig, b: &Wig) -> Result<()> {
    if Arc::ptr_eq(&a.head, &b.head) {
        return Ok(());
    }
    let hint = "make both on one head, and make that once: `local head = coif.head()`".to_owned();
    Err(call.problem_at(path, "the tufts are of different heads", Some(hint)))
}

fn union(call: &Call) -> Result<Value> {
    let (this, fields) = (call.this::<Wig>()?, call.read::<UnionFields>()?);
    same_head(call, "other", &this, &fields.other)?;
    Ok(give(this.joined(&fields.other)))
}

fn mirrored(call: &Call) -> Result<Value> {
    let this = call.this::<Wig>()?;
    let ground = ground(&this.head);
    let mut all = this.tufts.mirrored();
    for tuft in &mut all.tufts {
        // A head that is not symmetric has its skin elsewhere on the other side.
        let on = ground.solid.closest(tuft.stroke.root());
        if on.distance.abs() > 0.1 * ground.scale {
            *tuft = tuft.along(tuft.stroke.moved_to(on.position));
        }
    }
    Ok(give(this.with(all)))
}

fn rotated(call: &Call) -> Result<Value> {
    let (this, fields) = (call.this::<Wig>()?, call.read::<RotatedFields>()?);
    let mut all = Tufts::clone(&this.tufts);
    for tuft in &mut all.tufts {
        let axis = fields.axis.map_or_else(|| this.head.root(&this.head.closest(tuft.stroke.root())).normal, |d| d.0);
        *tuft = Tuft { id: tuft.id, ..tuft.rotated(axis, fields.angle.radians) };
    }
    Ok(give(this.with(all)))
}

fn array(call: &Call) -> Result<Value> {
    let (this, fields) = (call.this::<Wig>()?, call.read::<ArrayFields>()?);
    let ground = ground(&this.head);
    // Their meshes are made later; the coarsest has a dozen triangles.
    call.claim("count", Need::triangles(12 * this.tufts.count() * fields.count as usize))?;
    let mut all = Tufts { tufts: vec![], sources: this.tufts.sources.clone() };
    for tuft in &this.tufts.tufts {
        let some = tuft.array(fields.count as usize, fields.axis.0, fields.step.radians, &ground);
        all.extend(&Tufts { tufts: some, sources: this.tufts.sources.clone() });
    }
    Ok(give(this.with(all)))
}

fn with_material(call: &Call) -> Result<Value> {
    let (this, fields) = (call.this::<Wig>()?, call.read::<MaterialFields>()?);
    let mut all = Tufts::clone(&this.tufts);
    all.tufts.iter_mut().for_each(|t| t.colour = 0);
    Ok(give(Wig { palette: vec![fields.material.0], ..this.with(all) }))
}

fn stats(call: &Call) -> Result<Value> {
    let this = call.this::<Wig>()?;
    let tufts = &this.tufts;
    let found = dips(tufts, &DipOptions::default(), &ground(&this.head), call.task())
        .map_err(|e| tuft_error(call, "", &TuftError::from(e)))?;
    let lengths: Vec<f32> = tufts.tufts.iter().map(Tuft::length).collect();
    let bounds = if lengths.is_empty() { Bounds::EMPTY } else { tufts.mesh().mesh.bounds() };
    let sum: f64 = lengths.iter().copied().map(f64::from).sum();
    let number = |n: f32| Value::Number(f64::from(n));
    let count = |n: usize| Value::Number(n as f64);
    let fields = [
        ("tufts", count(tufts.count())),
        ("triangles", count(tufts.triangle_count())),
        ("mean_length", Value::Number(sum / lengths.len().max(1) as f64)),
        ("longest", number(lengths.iter().copied().fold(0.0, f32::max))),
        ("shortest", number(lengths.iter().copied().reduce(f32::min).unwrap_or(0.0))),
        ("dips", count(found.len())),
        ("deepest", number(found.iter().map(|d| d.depth).fold(0.0, f32::max))),
        ("min", Value::Vector(bounds.min)),
        ("max", Value::Vector(bounds.max)),
    ];
    let fields = fields.into_iter().map(|(k, v)| (k.to_owned(), v)).collect();
    Ok(Value::Table(Table { fields, ..Table::default() }))
}
