//! Heads: `coif.head` and its methods.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

use glam::Vec3;

use super::super::call::{Call, Result};
use super::super::files::AccessError;
use super::super::limits::Need;
use super::super::registry::{Entry, Getter, Noun};
use super::super::session::Session;
use super::region::Area;
use crate::geometry::OrientedBox;
use crate::head::load::{self, Axis, FileBytes, LoadError, LoadOptions, Unit};
use crate::head::mannequin::Style;
use crate::head::{Head, HeadError, Landmarks, Parting, Region};
use crate::math::Digest;
use crate::params::{Angle, Handle, Object, Table, Value};
use crate::task::Warned;

crate::params! {
    /// The head that hair grows on: the built-in mannequin, or a mesh from a file. `--head FILE` on the command line
    /// takes the place of either.
    pub struct HeadFields("coif.head") {
        /// Which mannequin.
        style: Style = Style::Adult;
        /// A mesh instead of the mannequin: OBJ, glTF or GLB, beside the script or below its folder.
        file: Option<String>;
        /// What one unit of the file is; metres for glTF, centimetres for OBJ when left out.
        unit: Option<Unit>;
        /// The axis of the file that points up; "y" when left out.
        up: Option<Axis>;
        /// The axis of the file that the face looks along; "z", or "-y" when z is up.
        forward: Option<Axis>;
        /// Only these groups, objects or materials of the file; everything when left out.
        groups: Vec<String> = vec![];
        /// Landmarks by name, in the file's own axes and unit, instead of those found from the shape.
        landmarks: Value = Value::Table(Table::default()), takes("table<string, Point>");
        /// What `--head FILE` does: false grows the style on that head instead of this one; true grows it on this head and
        /// carries it to that one, which is right for a style in plain coordinates.
        carry: bool = false;
    }
}

crate::params! {
    /// A landmark plus an offset in cm (to the head's left, up, to the front) that grows with the head.
    pub struct AtFields("Head:at") {
        /// `vertex`, `forehead`, `left_temple`, `right_temple`, `left_ear`, `right_ear`, `occiput`, `nape`, `chin`.
        landmark: String, choices(&Landmarks::NAMES);
        /// From there, for an adult's head.
        offset: Vec3 = Vec3::ZERO, unit("cm");
    }
}

crate::params! {
    /// A half of the space about the head, or all of it, as a box.
    pub struct BoxFields("Head:box") {
        /// `all`, `behind`, `front`, `left`, `right`, `above`, `below` the ears.
        name: String, choices(&Head::BOXES);
    }
}

crate::params! {
    /// A place over the skin, in a direction from the middle of the skull.
    pub struct PointFields("Head:point") {
        /// From the face towards the head's left: 90 is the left ear, 180 the back.
        azimuth: Angle = Angle::degrees(0.0), range(-360.0, 360.0);
        /// Upwards: 90 is the top.
        elevation: Angle = Angle::degrees(0.0), range(-90.0, 90.0);
        /// Over the skin, for an adult's head.
        height: f32 = 0.0, unit("cm"), range(-20.0, 200.0);
    }
}

crate::params! {
    /// The place of the skin that is nearest to a point.
    pub struct SkinFields("Head:skin") {
        /// Any point.
        point: Vec3, unit("cm");
    }
}

crate::params! {
    /// A region that a closed curve on the head encloses.
    pub struct RegionFields("Head:region") {
        /// Points of the curve, in order, three or more; they are laid on the head.
        points: Vec<Vec3>, positional();
        /// False for straight edges.
        smooth: bool = true;
    }
}

crate::params! {
    /// A group, an object or a material of the head's file, as a region.
    pub struct GroupFields("Head:group") {
        /// Its name.
        name: String;
    }
}

crate::params! {
    /// A region from a picture over the head's texture coordinates: white grows hair, black none, grey less.
    pub struct MaskFields("Head:mask") {
        /// A PNG file, beside the script or below its folder.
        file: String;
    }
}

crate::params! {
    /// A parting: a line on the scalp that strands never blend across. Lay it through a region by `Region:parting`.
    pub struct PartingFields("Head:parting") {
        /// Points of the line, in order, two or more; they are laid on the skin.
        points: Vec<Vec3>, positional();
    }
}

crate::params! {
    /// Tells the side of a parting: 1 on the head's left of a parting that runs from the forehead backward, -1 on its
    /// right, 0 on it.
    pub struct SideFields("Parting:side") {
        /// Any point.
        point: Vec3, unit("cm");
    }
}

/// `coif.head`.
pub fn functions() -> Vec<Entry> {
    vec![Entry::table::<HeadFields>("coif.head", "Head", head)]
}

/// Heads and partings.
pub fn nouns() -> Vec<Noun> {
    let mut methods = vec![
        Entry::positional::<AtFields>("Head:at", "vector", at),
        Entry::positional::<BoxFields>("Head:box", "Box", box_named),
        Entry::table::<PointFields>("Head:point", "vector", point),
        Entry::positional::<SkinFields>("Head:skin", "vector", skin),
        Entry::positional::<SkinFields>("Head:normal", "vector", normal)
            .about("The direction straight out of the skin, at the place nearest to a point."),
        Entry::plain("Head:scalp", "The natural scalp: where hair grows on a person.", "Region", scalp),
        Entry::table::<RegionFields>("Head:region", "Region", region),
        Entry::positional::<GroupFields>("Head:group", "Region", group),
        Entry::positional::<MaskFields>("Head:mask", "Region", mask),
        Entry::table::<PartingFields>("Head:parting", "Parting", parting),
    ];
    methods.extend(super::clip::head_methods());
    methods.extend(super::deform::head_methods());
    let getters = vec![
        Getter {
            name: "scale",
            doc: "Height from chin to vertex over an adult's 23 cm; offsets are multiplied by it.",
            returns: "number",
            get: |h| h.get::<Head>().map_or(Value::Nil, |h| Value::Number(f64::from(h.scale))),
        },
        Getter {
            name: "name",
            doc: "What it is called: `mannequin`, or its file.",
            returns: "string",
            get: |h| h.get::<Head>().map_or(Value::Nil, |h| Value::Text(h.name.clone())),
        },
        Getter {
            name: "centre",
            doc: "The middle of the skull.",
            returns: "vector",
            get: |h| h.get::<Head>().map_or(Value::Nil, |h| Value::Vector(h.centre())),
        },
    ];
    let text = |h: &Handle| {
        h.get::<Head>().map_or_else(String::new, |h| format!("head {}, {} triangles", h.name, h.mesh.triangles.len()))
    };
    let head = Noun::of::<Head>(
        "A head in head space: its origin lies between the ears, x points to its left, y up, z to the front, in cm.",
        methods,
        getters,
        text,
    );
    let side = vec![Entry::positional::<SideFields>("Parting:side", "number", side)];
    let text = |h: &Handle| {
        h.get::<Parting>().map_or_else(String::new, |p| format!("parting of {} points", p.curtain.line().len()))
    };
    vec![head, Noun::of::<Parting>("A line on the scalp that strands never blend across.", side, vec![], text)]
}

/// Any object as a value.
pub fn give<T: Object>(value: T) -> Value {
    Value::Handle(Handle::new(Arc::new(value)))
}

fn head(call: &Call) -> Result<Value> {
    let fields: HeadFields = call.read()?;
    // The same head for the same words: parts of a style share what is computed for it.
    let key = format!("{:?} {fields:?}", call.session.options.head);
    if let Some(head) = call.session.heads.borrow().get(&key) {
        return Ok(Value::Handle(Handle::new(Arc::clone(head))));
    }
    let of_run = || match &call.session.options.head {
        Some(path) => {
            let options = LoadOptions { unit: call.session.options.head_unit, ..LoadOptions::default() };
            from_file(call, path, "", &options, &BTreeMap::new()).map(Some)
        }
        None => Ok(None),
    };
    let instead = if fields.carry { None } else { of_run()? };
    let head = match (instead, &fields.file) {
        (Some(head), _) => head,
        (None, Some(file)) => {
            let options = LoadOptions {
                unit: fields.unit,
                up: fields.up,
                forward: fields.forward,
                groups: fields.groups.clone(),
            };
            let path = call.session.options.folder().join(file);
            from_file(call, &path, "file", &options, &landmarks(call, &fields)?)?
        }
        (None, None) => {
            let lone = [
                ("unit", fields.unit.is_some()),
                ("up", fields.up.is_some()),
                ("forward", fields.forward.is_some()),
                ("groups", !fields.groups.is_empty()),
                ("landmarks", !landmarks(call, &fields)?.is_empty()),
            ];
            if let Some((name, _)) = lone.iter().find(|(_, is_given)| *is_given) {
                let hint = "name the file: `file = \"anna.glb\"`".to_owned();
                return Err(call.problem_at(name, format!("`{name}` is about a file, but there is none"), Some(hint)));
            }
            built_in(call, fields.style)?
        }
    };
    if fields.carry
        && let Some(to) = of_run()?
    {
        call.session.carries.borrow_mut().push((Arc::clone(&head), to));
    }
    call.claim("", Need::triangles(head.mesh.triangles.len()))?;
    call.session.heads.borrow_mut().insert(key, Arc::clone(&head));
    Ok(Value::Handle(Handle::new(head)))
}

static ADULT: OnceLock<Arc<Head>> = OnceLock::new();
static CARTOON: OnceLock<Arc<Head>> = OnceLock::new();

/// Every head that a run can have used, once: those it made, and the mannequins.
pub fn heads(session: &Session) -> Vec<Arc<Head>> {
    let mut all: Vec<Arc<Head>> = vec![];
    let carries = session.carries.borrow();
    let to = carries.iter().map(|(_, to)| to);
    for head in session.heads.borrow().values().chain(to).chain(ADULT.get()).chain(CARTOON.get()) {
        if !all.iter().any(|known| Arc::ptr_eq(known, head)) {
            all.push(Arc::clone(head));
        }
    }
    all
}

/// A mannequin; made once per process, for it depends on nothing.
fn built_in(call: &Call, style: Style) -> Result<Arc<Head>> {
    let made = match style {
        Style::Adult => &ADULT,
        Style::Cartoon => &CARTOON,
    };
    if let Some(head) = made.get() {
        return Ok(Arc::clone(head));
    }
    let head = Head::mannequin(style);
    let head = Arc::new(head.map_err(|e| head_error(call, "style", &e))?);
    Ok(Arc::clone(made.get_or_init(|| head)))
}

/// Loads a head; `path` is the field to blame.
fn from_file(
    call: &Call,
    file: &Path,
    path: &str,
    options: &LoadOptions,
    landmarks: &BTreeMap<String, Vec3>,
) -> Result<Arc<Head>> {
    let bytes = call.session.access.read(file).map_err(|e| call.problem_at(path, e.to_string(), e.hint()))?;
    let folder = file.parent().map(Path::to_path_buf).unwrap_or_default();
    let read = |name: &str| call.session.access.read(&folder.join(name));
    let mut key = Digest::new("head file 1");
    key.data(&file.file_name()).data(options).data(landmarks).bytes(&bytes);
    // Which files it refers to is known from its content; what they hold counts too.
    let mut names = key.clone();
    names.bytes(b"names");
    let memo = &call.session.options.memo;
    let known = memo.get::<Vec<String>>(names.finish()).map(|found| found.0);
    let add = |key: &mut Digest, name: &str, bytes: Option<&[u8]>| {
        key.bytes(name.as_bytes()).flags(&[bytes.is_some()]).bytes(bytes.unwrap_or_default());
    };
    if let Some(known) = &known {
        known.iter().for_each(|name| add(&mut key, name, read(name).ok().as_deref()));
        return call.memo(&key, || loaded(call, (file, &bytes), path, options, landmarks, &read));
    }
    // The first time the names are found on the way.
    let asked = RefCell::new(BTreeMap::new());
    let noting = |name: &str| {
        let bytes = read(name);
        asked.borrow_mut().insert(name.to_owned(), bytes.as_ref().ok().cloned());
        bytes
    };
    let head = loaded(call, (file, &bytes), path, options, landmarks, &noting)?;
    let asked = asked.into_inner();
    asked.iter().for_each(|(name, bytes)| add(&mut key, name, bytes.as_deref()));
    memo.put(names.finish(), &Arc::new(asked.into_keys().collect::<Vec<String>>()), &[]);
    call.memo(&key, || Ok(head))
}

/// What the mesh file refers to, by its name beside it.
type Beside<'a> = dyn Fn(&str) -> std::result::Result<Vec<u8>, AccessError> + 'a;

/// A head from the bytes of its file.
fn loaded(
    call: &Call,
    (file, bytes): (&Path, &[u8]),
    path: &str,
    options: &LoadOptions,
    landmarks: &BTreeMap<String, Vec3>,
    beside: &Beside,
) -> Result<Warned<Head>> {
    let name = file.to_string_lossy();
    let siblings = |name: &str| beside(name).map_err(|e| io::Error::other(e.to_string()));
    let field = |e: &LoadError| match e {
        LoadError::UnknownGroup { .. } => "groups",
        LoadError::Axes { .. } => "forward",
        _ => path,
    };
    let failed = |e: LoadError| {
        let message = e.to_string();
        // Some errors name the file themselves.
        let message = if message.contains(&*name) { message } else { format!("`{name}`: {message}") };
        call.problem_at(field(&e), message, e.hint())
    };
    let Warned { value: mesh, mut warnings } =
        load::load_until(&FileBytes { name: &name, bytes }, options, &siblings, call.task()).map_err(failed)?;
    load::check_head_size(mesh.mesh.bounds(), mesh.unit).map_err(failed)?;
    let landmarks = landmarks.iter().map(|(name, &p)| (name.clone(), mesh.from_file * p)).collect();
    let stem = file.file_stem().map_or_else(|| "head".into(), |s| s.to_string_lossy().into_owned());
    call.room(path, Need::triangles(mesh.mesh.triangles.len()))?;
    let head = Head::from_mesh_until(mesh.mesh, &stem, &landmarks, call.task());
    let head = head.map_err(|e| head_error(call, path, &e))?;
    warnings.extend(head.warnings);
    Ok(Warned { value: head.value, warnings })
}

/// The `landmarks` field: a table of points by name.
fn landmarks(call: &Call, fields: &HeadFields) -> Result<BTreeMap<String, Vec3>> {
    let Value::Table(table) = &fields.landmarks else {
        return Err(call.problem_at(
            "landmarks",
            format!("expected a table, got {}", fields.landmarks.type_name()),
            None,
        ));
    };
    let mut reader = crate::params::Reader::default();
    let mut out = BTreeMap::new();
    for (name, value) in &table.fields {
        let path = format!("landmarks.{name}");
        if let Some(p) = reader.inside(path, |r| <Vec3 as crate::params::FieldType>::read(value, r)) {
            out.insert(name.clone(), p);
        }
    }
    let problems = reader.problems();
    if problems.is_empty() { Ok(out) } else { Err(call.problems(problems)) }
}

/// An error about a head, blamed on a field.
fn head_error(call: &Call, path: &str, error: &HeadError) -> super::super::session::Raised {
    call.problem_at(path, error.to_string(), error.hint())
}

fn at(call: &Call) -> Result<Value> {
    let (head, fields) = (call.this::<Head>()?, call.read::<AtFields>()?);
    let place = head.at(&fields.landmark, fields.offset).map_err(|e| head_error(call, "landmark", &e))?;
    Ok(Value::Vector(place))
}

fn box_named(call: &Call) -> Result<Value> {
    let (head, fields) = (call.this::<Head>()?, call.read::<BoxFields>()?);
    let named: OrientedBox = head.box_named(&fields.name).map_err(|e| head_error(call, "name", &e))?;
    Ok(give(named))
}

fn point(call: &Call) -> Result<Value> {
    let (head, fields) = (call.this::<Head>()?, call.read::<PointFields>()?);
    Ok(Value::Vector(head.point(fields.azimuth.radians, fields.elevation.radians, fields.height)))
}

fn skin(call: &Call) -> Result<Value> {
    let (head, fields) = (call.this::<Head>()?, call.read::<SkinFields>()?);
    Ok(Value::Vector(head.closest(fields.point).position))
}

fn normal(call: &Call) -> Result<Value> {
    let (head, fields) = (call.this::<Head>()?, call.read::<SkinFields>()?);
    Ok(Value::Vector(head.root(&head.closest(fields.point)).normal))
}

fn scalp(call: &Call) -> Result<Value> {
    let head = call.this::<Head>()?;
    Ok(give(Area::new(Arc::clone(&head), head.scalp())))
}

fn region(call: &Call) -> Result<Value> {
    let (head, fields) = (call.this::<Head>()?, call.read::<RegionFields>()?);
    let region = Region::polygon(&head, &fields.points, fields.smooth);
    Ok(give(Area::new(Arc::clone(&head), region.map_err(|e| call.problem(e.to_string(), e.hint()))?)))
}

fn group(call: &Call) -> Result<Value> {
    let (head, fields) = (call.this::<Head>()?, call.read::<GroupFields>()?);
    let region = Region::group(&head, &fields.name);
    Ok(give(Area::new(Arc::clone(&head), region.map_err(|e| call.problem_at("name", e.to_string(), e.hint()))?)))
}

fn mask(call: &Call) -> Result<Value> {
    let (head, fields) = (call.this::<Head>()?, call.read::<MaskFields>()?);
    let path: PathBuf = call.session.options.folder().join(&fields.file);
    let bytes = call.session.access.read(&path).map_err(|e| call.problem_at("file", e.to_string(), e.hint()))?;
    let mask = super::picture::grey(&bytes)
        .map_err(|e| call.problem_at("file", format!("`{}` is not a PNG picture: {e}", fields.file), None))?;
    let region = Region::mask(&head, Arc::new(mask));
    Ok(give(Area::new(Arc::clone(&head), region.map_err(|e| call.problem(e.to_string(), e.hint()))?)))
}

fn parting(call: &Call) -> Result<Value> {
    let (head, fields) = (call.this::<Head>()?, call.read::<PartingFields>()?);
    let parting = Parting::new(&head, &fields.points).map_err(|e| call.problem(e.to_string(), None))?;
    Ok(give(parting))
}

fn side(call: &Call) -> Result<Value> {
    let (parting, fields) = (call.this::<Parting>()?, call.read::<SideFields>()?);
    Ok(Value::Number(f64::from(parting.side(fields.point))))
}
