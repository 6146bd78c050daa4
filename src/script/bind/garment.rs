//! Garments: pieces and loaded meshes, their parts, tapes and girths.

use std::io;
use std::path::Path;
use std::sync::Arc;

use glam::Vec3;

use super::super::call::{Call, Result};
use super::super::registry::{Entry, Getter, Noun, Shape};
use super::deform::{DeformFields, Verb, deformers, drawn, key_of};
use super::head::give;
use super::lattice::failed;
use super::overlay;
use crate::deform::{self, Band, Bend, DeformError, Deformer, FitOptions, Lift, Measure, Taper, Target};
use crate::garment::{self, DressOptions, FormOptions, Garment, ShirtOptions, SkirtOptions, Tape, TrousersOptions};
use crate::geometry::slice::Side;
use crate::geometry::{Mesh, Solid};
use crate::head::Head;
use crate::head::load::{self, Axis, FileBytes, LoadOptions, Unit};
use crate::math::{Colour, Digest};
use crate::params::{FieldType, Handle, Object, Params, Table, Value};
use crate::scene::{MeshMaterial, Overlay};
use crate::task::{Warned, Warning};

/// A garment with its look.
#[derive(Clone, Debug)]
pub struct Cloth {
    /// The surface, its parts and tapes.
    pub garment: Arc<Garment>,
    /// How it looks.
    pub material: MeshMaterial,
    /// Lattices, pins and held points that made it, for the debug view.
    pub overlay: Arc<Overlay>,
    /// Place in the script that made it.
    pub source: Arc<str>,
}

impl Object for Cloth {
    const NAME: &'static str = "Garment";
}

crate::params! {
    /// How cloth looks.
    pub struct ClothLook("Garment:material") {
        /// Its colour.
        colour: Colour = Colour::hex(0x6f_83_a8);
        /// 0 mirror to 1 chalk.
        roughness: f32 = 0.85, range(0.0, 1.0);
    }
}

crate::params! {
    /// A garment, or any other mesh, from a file: OBJ, glTF or GLB. Its groups, objects and materials are its parts. It
    /// stays where it is in the file, but for `at`.
    pub struct LoadFields("coif.garment.load") {
        /// The file, beside the script or below its folder.
        file: String;
        /// What one unit of the file is; metres for glTF, centimetres for OBJ when left out.
        unit: Option<Unit>;
        /// The axis of the file that points up; "y" when left out.
        up: Option<Axis>;
        /// The axis of the file that points to the front; "z", or "-y" when z is up.
        forward: Option<Axis>;
        /// Only these groups, objects or materials; everything when left out.
        groups: Vec<String> = vec![];
        /// How far it is moved.
        at: Vec3 = Vec3::ZERO, unit("cm");
    }
}

crate::params! {
    /// What a tape reads.
    pub struct GirthFields("Garment:girth") {
        /// The name of a tape.
        tape: Option<String>;
        /// Or any height.
        height: Option<f32>, unit("cm");
        /// Which of several outlines: the largest, or the largest on one side.
        side: Option<Side>;
        /// Only these parts.
        parts: Vec<String> = vec![];
        /// As a tape measure reads it, or along the cloth into every fold.
        measure: Measure = Measure::Tape;
    }
}

crate::params! {
    /// Puts a tape around it: a name for a height.
    pub struct TapeFields("Garment:tape") {
        /// Its name.
        name: String;
        /// Its height.
        height: f32, unit("cm");
        /// Which of several outlines.
        side: Side = Side::Middle;
        /// Only around these parts.
        parts: Vec<String> = vec![];
    }
}

crate::params! {
    /// Finds the motion of control points that makes tapes read what is wanted, each to a tenth of a millimetre:
    /// `garment:fit { waist = 67 }`. The rest is held: nothing moves beyond the tapes above and below.
    pub struct FitFields("Garment:fit") {
        /// How girths are measured.
        measure: Measure = Measure::Tape;
        /// Places of the cloth that stay: "back", "front", "left", "right", or a list of points.
        hold: Value = Value::Nil, takes("\"back\"|\"front\"|\"left\"|\"right\"|Point[]|nil");
        /// How sharply the hold falls off: the exponent of the affinity.
        power: f32 = 2.0, range(0.5, 8.0);
        /// How far above and below a tape the cloth may move, at most.
        reach: f32 = 18.0, unit("cm"), range(1.0, 100.0);
        /// How far sewn-on parts follow.
        soft: f32 = 8.0, unit("cm"), range(0.1, 50.0);
    }
}

crate::params! {
    /// Pushes the cloth out of a body where it dips in, smoothly.
    pub struct ClearFields("Garment:clear") {
        /// The body: a dress form, any garment that encloses something, or a head.
        body: Value, takes("Garment|Head");
        /// How far from the body it shall lie.
        margin: f32 = 0.3, unit("cm"), range(0.0, 10.0);
    }
}

crate::params! {
    /// The same garment somewhere else.
    pub struct ShiftFields("Garment:shifted") {
        /// How far.
        by: Vec3, unit("cm");
    }
}

crate::params! {
    /// A measuring tape laid around it, as a thing to be seen.
    pub struct RibbonFields("Garment:ribbon") {
        /// The name of a tape.
        tape: String;
        /// Its width.
        width: f32 = 1.6, unit("cm"), range(0.2, 20.0);
        /// Its colour.
        colour: Colour = Colour::hex(0xf2_c1_2e);
        /// Whether pictures say beside it what it reads.
        label: bool = true;
    }
}

/// `coif.garment`.
pub fn functions() -> Vec<Entry> {
    vec![
        Entry::both::<SkirtOptions, ClothLook>("coif.garment.skirt", "Garment", |c| made(c, SkirtOptions::build)),
        Entry::both::<DressOptions, ClothLook>("coif.garment.dress", "Garment", |c| made(c, DressOptions::build)),
        Entry::both::<ShirtOptions, ClothLook>("coif.garment.shirt", "Garment", |c| made(c, ShirtOptions::build)),
        Entry::both::<TrousersOptions, ClothLook>("coif.garment.trousers", "Garment", |c| {
            made(c, TrousersOptions::build)
        }),
        Entry::both::<FormOptions, ClothLook>("coif.garment.form", "Garment", |c| made(c, FormOptions::build)),
        Entry::both::<LoadFields, ClothLook>("coif.garment.load", "Garment", load_file),
    ]
}

/// A garment.
pub fn noun() -> Noun {
    let named = |name, doc, fields: fn() -> Vec<crate::params::Field>, call| Entry {
        name,
        doc,
        fields,
        shape: Shape::Table,
        returns: "Garment",
        sealed: None,
        call,
    };
    let methods = vec![
        Entry::table::<GirthFields>("Garment:girth", "number", girth),
        Entry::table::<TapeFields>("Garment:tape", "Garment", tape),
        named("Garment:fit", FitFields::DOC, fit_fields, fit),
        named("Garment:split", SPLIT, split_fields, split),
        Entry::table::<ClearFields>("Garment:clear", "Garment", clear),
        Entry::table::<DeformFields>("Garment:deform", "Garment", moved::<DeformFields>),
        Entry::table::<Bend>("Garment:bend", "Garment", moved::<Bend>),
        Entry::table::<Taper>("Garment:taper", "Garment", moved::<Taper>),
        Entry::table::<Lift>("Garment:lift", "Garment", moved::<Lift>),
        Entry::positional::<ShiftFields>("Garment:shifted", "Garment", shifted),
        Entry::table::<RibbonFields>("Garment:ribbon", "Garment", ribbon),
        Entry::table::<ClothLook>("Garment:material", "Garment", material).about("The same garment with another look."),
        Entry::plain("Garment:parts", "The names of its parts.", "string[]", parts),
        Entry::plain("Garment:tapes", "The names of its tapes.", "string[]", tapes),
        Entry::plain(
            "Garment:stats",
            "Figures: `vertices`, `triangles`, `parts`, `min` and `max` (corners of the bounding box), and the girth of \
             every tape by its name.",
            "table",
            stats,
        )
        .sealed("the table of figures"),
    ];
    let getters = vec![Getter {
        name: "kind",
        doc: "`skirt`, `dress`, `shirt`, `trousers`, `form`, or the name of its file.",
        returns: "string",
        get: |h| h.get::<Cloth>().map_or(Value::Nil, |c| Value::Text(c.garment.kind.clone())),
    }];
    Noun::of::<Cloth>("A garment: a surface in named parts, with tapes around it.", methods, getters, |h: &Handle| {
        h.get::<Cloth>()
            .map_or_else(String::new, |c| format!("{} of {} triangles", c.garment.kind, c.garment.mesh.triangles.len()))
    })
}

impl Cloth {
    fn with(&self, garment: Garment) -> Self {
        Self { garment: Arc::new(garment), ..self.clone() }
    }

    fn key(&self, what: &str) -> Digest {
        let mut key = Digest::new(what);
        self.garment.mesh.digest(&mut key);
        key.data(&self.garment.tapes);
        key
    }
}

fn look(fields: &ClothLook) -> MeshMaterial {
    MeshMaterial { colour: fields.colour, roughness: fields.roughness }
}

/// A piece of the library.
fn made<P: Params + std::fmt::Debug>(call: &Call, build: fn(&P) -> Garment) -> Result<Value> {
    let (options, extras) = call.read_both::<P, ClothLook>()?;
    let mut key = Digest::new("garment 1");
    key.bytes(P::NAME.as_bytes()).data(&options);
    let garment = call.memo(&key, || Ok(Warned::clean(build(&options))))?;
    Ok(give(Cloth { garment, material: look(&extras), overlay: Arc::default(), source: call.source() }))
}

fn load_file(call: &Call) -> Result<Value> {
    let (fields, extras) = call.read_both::<LoadFields, ClothLook>()?;
    let options = LoadOptions { unit: fields.unit, up: fields.up, forward: fields.forward, groups: fields.groups };
    let mesh = read_mesh(call, &fields.file, &options, fields.at)?;
    let stem =
        Path::new(&fields.file).file_stem().map_or_else(|| "garment".into(), |s| s.to_string_lossy().into_owned());
    let garment = Arc::new(Garment::new(&stem, mesh));
    Ok(give(Cloth { garment, material: look(&extras), overlay: Arc::default(), source: call.source() }))
}

/// The mesh of a file named by the fields `file` and `groups` of a call, moved by `at`.
pub fn read_mesh(call: &Call, file: &str, options: &LoadOptions, at: Vec3) -> Result<Mesh> {
    let path = call.session.options.folder().join(file);
    let bytes = call.session.access.read(&path).map_err(|e| call.problem_at("file", e.to_string(), e.hint()))?;
    let folder = path.parent().map(ToOwned::to_owned).unwrap_or_default();
    let beside = |name: &str| call.session.access.read(&folder.join(name)).map_err(|e| io::Error::other(e.to_string()));
    let loaded = load::load(&FileBytes { name: file, bytes: &bytes }, options, &beside).map_err(|e| {
        let field = if matches!(e, load::LoadError::UnknownGroup { .. }) { "groups" } else { "file" };
        call.problem_at(field, e.to_string(), e.hint())
    })?;
    let mut mesh = call.warned(loaded).mesh;
    mesh.positions.iter_mut().for_each(|p| *p += at);
    Ok(mesh)
}

/// The tape of that name.
fn named<'a>(call: &Call, garment: &'a Garment, path: &str, name: &str) -> Result<&'a Tape> {
    garment.tape(name).ok_or_else(|| {
        let known: Vec<&str> = garment.tapes.iter().map(|t| t.name.as_str()).collect();
        let hint = match crate::params::nearest(name, known.iter().copied()) {
            Some(near) => format!("did you mean `{near}`?"),
            None if known.is_empty() => "put one around it: `garment:tape { name = \"waist\", height = -57 }`".into(),
            None => format!("it has {}", known.join(", ")),
        };
        call.problem_at(path, format!("the {} has no tape `{name}`", garment.kind), Some(hint))
    })
}

/// Refuses parts that are not there.
fn known_parts(call: &Call, garment: &Garment, parts: &[String]) -> Result<()> {
    for (i, part) in parts.iter().enumerate() {
        if garment.mesh.group(part).is_none() {
            let known = garment.parts();
            let hint = match crate::params::nearest(part, known.iter().copied()) {
                Some(near) => format!("did you mean `{near}`?"),
                None => format!("it has {}", known.join(", ")),
            };
            let message = format!("the {} has no part `{part}`", garment.kind);
            return Err(call.problem_at(&format!("parts[{}]", i + 1), message, Some(hint)));
        }
    }
    Ok(())
}

fn band(garment: &Garment, tape: &Tape, reach: f32) -> Band {
    let (low, high) = garment.reach(tape, reach);
    let there: Vec<String> = tape.parts.iter().filter(|p| garment.mesh.group(p).is_some()).cloned().collect();
    Band { name: tape.name.clone(), height: tape.height, low, high, side: tape.side, part: garment.triangles(&there) }
}

fn girth(call: &Call) -> Result<Value> {
    let (this, fields) = (call.this::<Cloth>()?, call.read::<GirthFields>()?);
    let garment = &this.garment;
    known_parts(call, garment, &fields.parts)?;
    let mut tape = match (&fields.tape, fields.height) {
        (Some(name), None) => named(call, garment, "tape", name)?.clone(),
        (None, Some(height)) => Tape { name: format!("{height} cm"), height, side: Side::Middle, parts: vec![] },
        _ => {
            let hint = "as in `garment:girth { tape = \"waist\" }` or `{ height = -57 }`".to_owned();
            return Err(call.problem("say which girth: either `tape` or `height`", Some(hint)));
        }
    };
    if let Some(side) = fields.side {
        tape.side = side;
    }
    if !fields.parts.is_empty() {
        tape.parts.clone_from(&fields.parts);
    }
    let outline = deform::outline(&garment.mesh, &band(garment, &tape, 1.0)).map_err(|e| failed(call, "", &e))?;
    Ok(number(fields.measure.of(&outline)))
}

fn number(n: f32) -> Value {
    Value::Number((f64::from(n) * 1e4).round() / 1e4)
}

fn tape(call: &Call) -> Result<Value> {
    let (this, fields) = (call.this::<Cloth>()?, call.read::<TapeFields>()?);
    known_parts(call, &this.garment, &fields.parts)?;
    let tape = Tape { name: fields.name, height: fields.height, side: fields.side, parts: fields.parts };
    deform::outline(&this.garment.mesh, &band(&this.garment, &tape, 1.0)).map_err(|e| failed(call, "height", &e))?;
    Ok(give(this.with(Garment::clone(&this.garment).with_tape(tape))))
}

/// The fields of `fit`: its own, and a girth by the name of any tape.
fn fit_fields() -> Vec<crate::params::Field> {
    let doc = "What the tape of that name shall read, cm.";
    let mut fields = FitFields::fields();
    fields.push(
        crate::params::Field::new::<Option<f32>>("girth", doc).any_name().unit("cm").takes("number|string|Point[]"),
    );
    fields
}

fn fit(call: &Call) -> Result<Value> {
    let this = call.this::<Cloth>()?;
    let garment = &this.garment;
    let own: Vec<&str> = FitFields::fields().iter().map(|f| f.name).collect();
    let (mut options, mut wanted) = (Table { items: call.table().items.clone(), ..Table::default() }, vec![]);
    let mut reader = crate::params::Reader::default();
    for (name, value) in &call.table().fields {
        if own.contains(&name.as_str()) {
            options.fields.insert(name.clone(), value.clone());
        } else if let Some(girth) = reader.inside(name.clone(), |r| f32::read(value, r)) {
            wanted.push((name.clone(), girth));
        }
    }
    let problems = reader.problems();
    if !problems.is_empty() {
        return Err(call.problems(problems));
    }
    let fields: FitFields = crate::params::read(&options).map_err(|p| call.problems(p))?;
    if wanted.is_empty() {
        return Err(
            call.problem("no tape is fitted", Some("say what it shall read: `garment:fit { waist = 67 }`".into()))
        );
    }
    let mut targets = vec![];
    for (name, girth) in wanted {
        if !(1.0..=10_000.0).contains(&girth) {
            let hint = "girths are in cm".to_owned();
            return Err(call.problem_at(&name, format!("`{girth}` is no girth"), Some(hint)));
        }
        let tape = named(call, garment, &name, &name)?;
        targets.push(Target { band: band(garment, tape, fields.reach), girth });
    }
    let held = held(call, garment, &fields.hold, &targets)?;
    let options = FitOptions { measure: fields.measure, held, power: fields.power, soft: fields.soft };
    let mut key = this.key("fit 1");
    key.data(&targets).data(&options);
    let error = |e: DeformError| {
        let path = match &e {
            DeformError::OutOfReach { tape, .. } | DeformError::Contradiction { tape, .. } => tape.clone(),
            _ => String::new(),
        };
        failed(call, &path, &e)
    };
    let fitted = call
        .memo(&key, || deform::fit(&garment.mesh, &targets, &options, call.task()).map(Warned::clean).map_err(error))?;
    let by: Vec<Deformer> = fitted.lattices.iter().map(|l| Deformer::Lattice(Arc::new(l.clone()))).collect();
    let garment = Garment { mesh: fitted.mesh.clone(), ..Garment::clone(garment) };
    Ok(give(Cloth { overlay: drawn(&this.overlay, &by), ..this.with(garment) }))
}

/// The places that `hold` speaks of.
fn held(call: &Call, garment: &Garment, hold: &Value, targets: &[Target]) -> Result<Vec<Vec3>> {
    /// The most places that a side is held by.
    const PLACES: usize = 48;
    let side = match hold {
        Value::Nil => return Ok(vec![]),
        Value::Text(side) => side,
        other => {
            let mut reader = crate::params::Reader::default();
            let points: Option<Vec<Vec3>> = reader.inside("hold", |r| FieldType::read(other, r));
            return points.ok_or_else(|| call.problems(reader.problems()));
        }
    };
    let out = match side.as_str() {
        "back" => Vec3::NEG_Z,
        "front" => Vec3::Z,
        "left" => Vec3::X,
        "right" => Vec3::NEG_X,
        other => {
            let sides = ["back", "front", "left", "right"];
            let hint = crate::params::nearest(other, sides).map(|n| format!("did you mean \"{n}\"?"));
            let hint = hint.unwrap_or_else(|| "it takes \"back\", \"front\", \"left\", \"right\", or points".into());
            return Err(call.problem_at("hold", format!("`{other}` is no side"), Some(hint)));
        }
    };
    let mut all = vec![];
    for target in targets {
        let outline = deform::outline(&garment.mesh, &target.band).map_err(|e| failed(call, "", &e))?;
        let axis = outline.centre();
        let mut places: Vec<Vec3> = (garment.mesh.positions.iter().copied())
            .filter(|p| p.y > target.band.low && p.y < target.band.high)
            .filter(|p| (*p - axis).with_y(0.0).normalize_or_zero().dot(out) > 0.55)
            .collect();
        places.sort_by(|a, b| a.y.total_cmp(&b.y).then(a.x.total_cmp(&b.x)).then(a.z.total_cmp(&b.z)));
        places.dedup();
        let step = places.len().div_ceil(PLACES).max(1);
        all.extend(places.into_iter().step_by(step));
    }
    Ok(all)
}

const SPLIT: &str = "Names parts by bands of heights: `garment:split { bust = { -48, -30 }, waist = { -67, -48 } }`.";

fn split_fields() -> Vec<crate::params::Field> {
    vec![crate::params::Field::new::<Option<Vec<f32>>>("part", "From which height to which, cm.").any_name().unit("cm")]
}

fn split(call: &Call) -> Result<Value> {
    let this = call.this::<Cloth>()?;
    let mut reader = crate::params::Reader::default();
    let mut bands = vec![];
    for (name, value) in &call.table().fields {
        match reader.inside(name.clone(), |r| Vec::<f32>::read(value, r)).as_deref() {
            Some([low, high]) if low < high => bands.push((name.clone(), *low, *high)),
            Some(_) => {
                let hint = "the lower and the upper height: { -67, -48 }".to_owned();
                return Err(call.problem_at(name, format!("`{value}` is no band of heights"), Some(hint)));
            }
            None => {}
        }
    }
    let problems = reader.problems();
    if !problems.is_empty() {
        return Err(call.problems(problems));
    }
    let garment = Garment::clone(&this.garment).split(&bands);
    if let Some((name, ..)) = bands.iter().find(|b| garment.mesh.group(&b.0).is_none_or(|g| g.triangles.is_empty())) {
        let bounds = garment.mesh.bounds();
        let hint = format!("it goes from {:.1} to {:.1} cm", bounds.min.y, bounds.max.y);
        return Err(call.problem_at(name, "there is nothing between these heights", Some(hint)));
    }
    Ok(give(this.with(garment)))
}

fn clear(call: &Call) -> Result<Value> {
    let (this, fields) = (call.this::<Cloth>()?, call.read::<ClearFields>()?);
    let body: Option<Arc<Solid>> = match &fields.body {
        Value::Handle(h) => match (h.get::<Cloth>(), h.get::<Head>()) {
            (Some(cloth), _) => {
                let solid = Solid::new(&cloth.garment.mesh);
                Some(Arc::new(solid.map_err(|e| call.problem_at("body", e.to_string(), None))?))
            }
            (None, Some(head)) => Some(Arc::clone(&head.solid)),
            (None, None) => None,
        },
        _ => None,
    };
    let Some(body) = body else {
        let message = format!("expected a Garment or a Head, got {} `{}`", fields.body.type_name(), fields.body);
        return Err(call.problem_at("body", message, None));
    };
    let mut key = this.key("clear 1");
    if let Value::Handle(h) = &fields.body {
        match (h.get::<Cloth>(), h.get::<Head>()) {
            (Some(cloth), _) => cloth.garment.mesh.digest(&mut key),
            (None, Some(head)) => _ = key.key(head.key()),
            (None, None) => {}
        }
    }
    key.floats(&[fields.margin]);
    let garment = call.memo(&key, || {
        let cleared = garment::clear(&this.garment.mesh, &body, fields.margin, call.task());
        let cleared = cleared.map_err(|e| failed(call, "", &DeformError::from(e)))?;
        let mut warned = Warned::clean(Garment {
            mesh: this.garment.mesh.moved(&cleared.positions),
            ..Garment::clone(&this.garment)
        });
        if cleared.left > 0 {
            let message = format!("{} vertices of the {} are still inside", cleared.left, this.garment.kind);
            warned.warnings.push(Warning::new(message).hint("make it wider before, or the `margin` larger"));
        }
        Ok(warned)
    })?;
    Ok(give(Cloth { garment, ..Cloth::clone(&this) }))
}

fn moved<V: Verb>(call: &Call) -> Result<Value> {
    let (this, verb) = (call.this::<Cloth>()?, call.read::<V>()?);
    let by = deformers(call, &verb, &this.garment.mesh.positions)?;
    let mut key = this.key("deform garment 1");
    key_of(&by, &mut key);
    let garment = call.memo(&key, || {
        let mesh = deform::mesh(&this.garment.mesh, &by, call.task()).map_err(|e| failed(call, "", &e))?;
        Ok(Warned::clean(Garment { mesh, ..Garment::clone(&this.garment) }))
    })?;
    Ok(give(Cloth { garment, overlay: drawn(&this.overlay, &by), ..Cloth::clone(&this) }))
}

fn shifted(call: &Call) -> Result<Value> {
    let (this, fields) = (call.this::<Cloth>()?, call.read::<ShiftFields>()?);
    let mut garment = Garment::clone(&this.garment);
    garment.mesh.positions.iter_mut().for_each(|p| *p += fields.by);
    garment.tapes.iter_mut().for_each(|t| t.height += fields.by.y);
    let mut overlay = Overlay::clone(&this.overlay);
    overlay.shift(fields.by);
    Ok(give(Cloth { overlay: Arc::new(overlay), ..this.with(garment) }))
}

fn ribbon(call: &Call) -> Result<Value> {
    let (this, fields) = (call.this::<Cloth>()?, call.read::<RibbonFields>()?);
    let tape = named(call, &this.garment, "tape", &fields.tape)?;
    let outline =
        deform::outline(&this.garment.mesh, &band(&this.garment, tape, 1.0)).map_err(|e| failed(call, "", &e))?;
    let garment = Garment::new("tape", garment::ribbon(&outline, fields.width));
    let mut overlay = Overlay::default();
    overlay.extend(&overlay::tape(&tape.name, &outline));
    if fields.label {
        overlay.notes.push(overlay::reading(&tape.name, &outline));
    }
    let material = MeshMaterial { colour: fields.colour, roughness: 0.7 };
    Ok(give(Cloth { garment: Arc::new(garment), material, overlay: Arc::new(overlay), source: call.source() }))
}

fn material(call: &Call) -> Result<Value> {
    let (this, fields) = (call.this::<Cloth>()?, call.read::<ClothLook>()?);
    Ok(give(Cloth { material: look(&fields), ..Cloth::clone(&this) }))
}

fn parts(call: &Call) -> Result<Value> {
    let this = call.this::<Cloth>()?;
    Ok(super::list(this.garment.parts().into_iter().map(|p| Value::Text(p.to_owned()))))
}

fn tapes(call: &Call) -> Result<Value> {
    let this = call.this::<Cloth>()?;
    Ok(super::list(this.garment.tapes.iter().map(|t| Value::Text(t.name.clone()))))
}

fn stats(call: &Call) -> Result<Value> {
    let this = call.this::<Cloth>()?;
    let garment = &this.garment;
    let bounds = garment.mesh.bounds();
    let mut fields = std::collections::BTreeMap::new();
    for tape in &garment.tapes {
        if let Ok(outline) = deform::outline(&garment.mesh, &band(garment, tape, 1.0)) {
            fields.insert(tape.name.clone(), number(outline.tape()));
        }
    }
    let count = |n: usize| Value::Number(n as f64);
    fields.insert("vertices".into(), count(garment.mesh.positions.len()));
    fields.insert("triangles".into(), count(garment.mesh.triangles.len()));
    fields.insert("parts".into(), count(garment.mesh.groups.len()));
    fields.insert("min".into(), Value::Vector(bounds.min));
    fields.insert("max".into(), Value::Vector(bounds.max));
    Ok(Value::Table(Table { fields, ..Table::default() }))
}
