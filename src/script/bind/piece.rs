//! Caps, buns, rings and loaded meshes: stylised hair that is not a tuft.

use std::sync::Arc;

use glam::Vec3;

use super::super::call::{Call, Result};
use super::super::registry::{Entry, Getter, Noun};
use super::garment::read_mesh;
use super::head::give;
use super::tuft::{TuftLook, Wig, ground, head_of, points_of, tuft_error};
use crate::geometry::Mesh;
use crate::head::Head;
use crate::head::load::{Axis, LoadOptions, Unit};
use crate::math::Digest;
use crate::params::{Object, Table, Value};
use crate::scene::{LockKind, TuftMaterial};
use crate::tuft::{BunOptions, CapOptions, RingOptions};

/// One surface of stylised hair.
#[derive(Clone, Debug)]
pub struct Piece {
    /// What it is.
    pub kind: LockKind,
    /// Its surface.
    pub mesh: Arc<Mesh>,
    /// The head it belongs to.
    pub head: Arc<Head>,
    /// How it looks.
    pub material: TuftMaterial,
    /// Place in the script that made it.
    pub source: Arc<str>,
}

impl Object for Piece {
    const NAME: &'static str = "Piece";
}

crate::params! {
    /// What else a cap, a bun or a mesh takes.
    pub struct PieceExtras("coif.cap") {
        /// The head it belongs to; needed only when the script made several.
        head: Option<Arc<Head>>;
        /// Its look: `coif.material.tuft { ... }`, its fields, or a colour as "#6b432b".
        material: Option<TuftLook>;
    }
}

crate::params! {
    /// What else a ring takes.
    pub struct RingExtras("coif.ring") {
        /// The tufts to put a ring around, each its own.
        tufts: Vec<Arc<Wig>>, positional();
        /// Its look: `coif.material.tuft { ... }`, its fields, or a colour as "#6b432b".
        material: Option<TuftLook>;
    }
}

crate::params! {
    /// Stylised hair from a file: OBJ, glTF or GLB. It stays where it is in the file, but for `at`. Several files of one
    /// topology are the states of a lock that moves: `coif.animate { states = { rest, bent }, ... }`.
    pub struct MeshFields("coif.mesh") {
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

/// `coif.cap`, `coif.bun`, `coif.ring`, `coif.mesh`.
pub fn functions() -> Vec<Entry> {
    vec![
        Entry::both::<CapOptions, PieceExtras>("coif.cap", "Piece", cap),
        Entry::both::<BunOptions, PieceExtras>("coif.bun", "Piece", bun),
        Entry::both::<RingOptions, RingExtras>("coif.ring", "Piece", ring),
        Entry::both::<MeshFields, PieceExtras>("coif.mesh", "Piece", mesh),
    ]
}

/// A cap, a bun, a ring or a loaded mesh.
pub fn noun() -> Noun {
    let getters = vec![
        Getter {
            name: "kind",
            doc: "`cap`, `bun`, `ring` or `mesh`.",
            returns: "string",
            get: |h| h.get::<Piece>().map_or(Value::Nil, |p| Value::Text(p.kind.text().to_owned())),
        },
        Getter {
            name: "triangles",
            doc: "How many triangles it has.",
            returns: "number",
            get: |h| h.get::<Piece>().map_or(Value::Nil, |p| Value::Number(p.mesh.triangles.len() as f64)),
        },
    ];
    Noun::of::<Piece>(
        "A cap, a bun, a ring or a loaded mesh of stylised hair.",
        super::deform::piece_methods(),
        getters,
        |h| {
            h.get::<Piece>()
                .map_or_else(String::new, |p| format!("{} of {} triangles", p.kind.text(), p.mesh.triangles.len()))
        },
    )
}

/// The head that a call names or means.
fn head(call: &Call) -> Result<Arc<Head>> {
    let given = match call.table().fields.get("head") {
        Some(Value::Handle(h)) => h.get::<Head>(),
        _ => None,
    };
    head_of(call, given)
}

fn piece(call: &Call, kind: LockKind, mesh: Arc<Mesh>, head: Arc<Head>, look: Option<TuftLook>) -> Value {
    let material = look.map_or_else(TuftMaterial::default, |l| l.0);
    give(Piece { kind, mesh, head, material, source: call.source() })
}

/// Points of the natural hairline, from the forehead over the head's left, for a cap without a border.
fn hairline(head: &Head) -> Vec<Vec3> {
    let left = [
        ("left_temple", [0.0, 0.0, 0.0]),
        ("left_ear", [-0.3, 3.4, 1.6]),
        ("left_ear", [-0.6, 3.0, -2.4]),
        ("left_ear", [-1.2, -2.0, -4.6]),
    ];
    let at = |name: &str, offset: [f32; 3]| head.at(name, Vec3::from(offset)).ok();
    let side: Vec<Vec3> = left.iter().filter_map(|&(name, offset)| at(name, offset)).collect();
    let mirrored = left.iter().rev().filter_map(|&(name, [x, y, z])| at(&name.replace("left", "right"), [-x, y, z]));
    let on_skin = |p: Vec3| head.closest(p).position;
    let front = head.landmarks.forehead;
    std::iter::once(front).chain(side).chain([head.landmarks.nape]).chain(mirrored).map(on_skin).collect()
}

fn cap(call: &Call) -> Result<Value> {
    let head = head(call)?;
    let mut table: Table = call.table().clone();
    if let Some(Value::Table(border)) = table.fields.get_mut("border") {
        points_of(call, &head, "border", &mut border.items)?;
    }
    let is_given = table.fields.contains_key("border");
    let (mut options, extras) = call.read_both_from::<CapOptions, PieceExtras>(&table)?;
    if !is_given {
        options.border = hairline(&head);
    }
    let mut key = Digest::new("cap 1");
    key.key(head.key()).data(&options);
    let mesh = call.memo(&key, || options.build(&ground(&head)).map_err(|e| tuft_error(call, "border", &e)))?;
    Ok(piece(call, LockKind::Cap, mesh, extras.head.unwrap_or(head), extras.material))
}

fn bun(call: &Call) -> Result<Value> {
    let head = head(call)?;
    let (options, extras) = call.read_both::<BunOptions, PieceExtras>()?;
    let mesh = options.build().map_err(|e| tuft_error(call, "position", &e))?;
    Ok(piece(call, LockKind::Bun, Arc::new(mesh), extras.head.unwrap_or(head), extras.material))
}

fn mesh(call: &Call) -> Result<Value> {
    let head = head(call)?;
    let (fields, extras) = call.read_both::<MeshFields, PieceExtras>()?;
    let options = LoadOptions { unit: fields.unit, up: fields.up, forward: fields.forward, groups: fields.groups };
    let mesh = read_mesh(call, &fields.file, &options, fields.at)?;
    Ok(piece(call, LockKind::Mesh, Arc::new(mesh), extras.head.unwrap_or(head), extras.material))
}

fn ring(call: &Call) -> Result<Value> {
    let (options, extras) = call.read_both::<RingOptions, RingExtras>()?;
    let Some(first) = extras.tufts.first() else {
        let hint = "as in `coif.ring { tail, at = 0.1 }`".to_owned();
        return Err(call.problem("a ring goes around tufts, and none are given", Some(hint)));
    };
    let mut all = Mesh::default();
    for tuft in extras.tufts.iter().flat_map(|w| &w.tufts.tufts) {
        let mesh = options.build(tuft).map_err(|e| tuft_error(call, "at", &e))?;
        let before = all.positions.len() as u32;
        all.positions.extend(mesh.positions);
        all.normals.extend(mesh.normals);
        all.uvs.extend(mesh.uvs);
        all.triangles.extend(mesh.triangles.iter().map(|t| t.map(|v| v + before)));
    }
    Ok(piece(call, LockKind::Ring, Arc::new(all), Arc::clone(&first.head), extras.material))
}
