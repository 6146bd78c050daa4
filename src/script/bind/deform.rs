//! Deformation: lattices, pins, and what they do to hair, heads and clips.

use std::sync::Arc;

use glam::{Quat, Vec3};

use super::super::call::{Call, Result};
use super::super::registry::{Entry, Getter, Noun};
use super::super::session::Raised;
use super::clip::{MovingLocks, MovingStrands};
use super::garment::Cloth;
use super::head::give;
use super::overlay;
use super::piece::Piece;
use super::strands::Lock;
use super::tuft::{Wig, ground, settled as settled_tufts, tuft_error};
use crate::deform::{
    self, Bend, DeformError, Deformer, Hold, Lattice, Lift, Move, Pin, Pins, PointKind, Selection, Taper,
};
use crate::geometry::{Bounds, OrientedBox, Strands};
use crate::groom::{Body, keep_out};
use crate::head::{Head, matching};
use crate::math::Digest;
use crate::params::{Angle, Direction, FieldType, Function, Kind, Object, Params, Reader, Value};
use crate::scene::Overlay;
use crate::task::{Warned, Warning};
use crate::tuft::{Stroke, Tuft, TuftError, Tufts};

impl Object for Lattice {
    const NAME: &'static str = "Lattice";
}

impl Object for Pins {
    const NAME: &'static str = "Pins";
}

crate::params! {
    /// A lattice of control points: a box around what is to be moved, or any parallelepiped.
    pub struct LatticeFields("coif.lattice") {
        /// What it goes around: a garment, hair, a head, or a box.
        around: Value = Value::Nil, takes("Garment|Strands|Tufts|Piece|Head|Box|nil");
        /// How much larger it is than that.
        margin: f32 = 0.5, unit("cm"), range(0.0, 100.0);
        /// A corner, instead of `around`.
        corner: Option<Vec3>, unit("cm");
        /// The three edges from that corner, right-handed.
        edges: Vec<Vec3> = vec![], takes("Point[]");
        /// Into how many pieces each edge is divided: control points go from 0 to these.
        divisions: Vec<u32> = vec![4, 4, 4];
    }
}

crate::params! {
    /// Moves control points: scales and turns them about a place, then shifts them. Without `i`, `j`, `k` or `group` all of
    /// them; fixed ones stay.
    pub struct MoveFields("Lattice:move") {
        /// Along the first edge (to the head's left): one index, or { first, last }.
        i: Value = Value::Nil, takes("number|number[]|nil");
        /// Along the second edge (up).
        j: Value = Value::Nil, takes("number|number[]|nil");
        /// Along the third edge (to the front).
        k: Value = Value::Nil, takes("number|number[]|nil");
        /// A named group.
        group: Option<String>;
        /// How far; or a function that is told where a point stands and its indices, and returns how far.
        by: Value = Value::Nil, takes("Point|fun(place: vector, i: number, j: number, k: number): vector");
        /// Stretch along the axes of space: one number for all, or three.
        scale: Value = Value::Nil, takes("number|Point|nil");
        /// Turn about `axis`.
        turn: Angle = Angle::degrees(0.0), range(-360.0, 360.0);
        /// The axis of the turn.
        axis: Direction = Direction(Vec3::Y);
        /// The place that scaling and turning leave where it is; the middle of the points when left out.
        about: Option<Vec3>, unit("cm");
    }
}

crate::params! {
    /// Gives control points a name, to move them by it later.
    pub struct GroupFields("Lattice:group") {
        /// The name.
        name: String;
        /// Along the first edge: one index, or { first, last }.
        i: Value = Value::Nil, takes("number|number[]|nil");
        /// Along the second edge.
        j: Value = Value::Nil, takes("number|number[]|nil");
        /// Along the third edge.
        k: Value = Value::Nil, takes("number|number[]|nil");
    }
}

crate::params! {
    /// Says what control points are for: `overall`, `feature` or `fixed`. It may change between steps.
    pub struct MarkFields("Lattice:mark") {
        /// The kind.
        kind: PointKind;
        /// Along the first edge: one index, or { first, last }.
        i: Value = Value::Nil, takes("number|number[]|nil");
        /// Along the second edge.
        j: Value = Value::Nil, takes("number|number[]|nil");
        /// Along the third edge.
        k: Value = Value::Nil, takes("number|number[]|nil");
        /// A named group.
        group: Option<String>;
    }
}

crate::params! {
    /// Holds places of the object itself: what is near them moves less, and they do not move at all.
    pub struct HoldFields("Lattice:hold") {
        /// The places.
        points: Vec<Vec3>, positional(), unit("cm");
        /// How sharply the hold falls off: the exponent of the affinity.
        power: f32 = 2.0, range(0.5, 8.0);
    }
}

crate::params! {
    /// Lets overall control points follow the feature points that were moved, held back by the fixed ones.
    pub struct FollowFields("Lattice:follow") {
        /// The exponent of the affinity.
        power: f32 = 2.0, range(0.5, 8.0);
    }
}

crate::params! {
    /// Where a control point stands.
    pub struct PlaceFields("Lattice:place") {
        /// Index along the first edge, from 0.
        i: u32;
        /// Index along the second edge, from 0.
        j: u32;
        /// Index along the third edge, from 0.
        k: u32;
    }
}

crate::params! {
    /// A control point: it goes from `at` to `to`; without a target it stays.
    pub struct PinFields("coif.pin") {
        /// Where it is.
        at: Vec3, unit("cm");
        /// Where it goes.
        to: Option<Vec3>, unit("cm");
        /// A name, to mark it by later.
        name: Option<String>;
        /// What it is for; `feature` with a target and `fixed` without one when left out. Any other kind without a target
        /// rides along.
        kind: Option<PointKind>;
    }
}

crate::params! {
    /// Fixed points and operated points: every operated point lands on its target, no fixed point moves, and between them
    /// each place follows those that are near.
    pub struct PinsFields("coif.pins") {
        /// The points: `{ at = { 0, 0, 0 } }` stays, `{ at = { 0, 0, 5 }, to = { 0, 1, 6 } }` is moved.
        points: Vec<PinFields>, positional();
        /// How much more a near point counts than a far one: the exponent of the affinity.
        power: f32 = 2.0, range(0.5, 8.0);
    }
}

crate::params! {
    /// The next step: gives a named point another kind, and perhaps a target.
    pub struct PinMarkFields("Pins:mark") {
        /// The name of the point.
        name: String;
        /// Its kind from now on.
        kind: PointKind;
        /// Where it goes now.
        to: Option<Vec3>, unit("cm");
    }
}

crate::params! {
    /// Moves it by lattices and pins, one after the other.
    pub struct DeformFields("deform") {
        /// Lattices and pins, in the order they act.
        by: Vec<By>, positional();
    }
}

crate::params! {
    /// How hair takes part.
    pub struct HairFields("Strands:deform") {
        /// Length along each strand, from its root, over which the motion comes in: roots stay on the head. With 0 they
        /// move as well.
        roots: f32 = 3.0, unit("cm"), range(0.0, 100.0);
        /// Which of it: a function that takes a root (a vector) and returns true or false.
        r#where: Option<Function>, takes("(root: vector): boolean");
        /// How far strands are kept from the skin.
        margin: f32 = 0.1, unit("cm"), range(0.0, 2.0);
    }
}

crate::params! {
    /// Carries it to another head: the smooth motion through the landmarks of both heads moves every point, roots are laid on
    /// the new skin, and what then lies in the new head is moved out.
    pub struct CarryFields("carry") {
        /// The other head.
        to: Arc<Head>;
    }
}

/// Anything that deforms.
#[derive(Clone, Debug)]
pub struct By(pub Deformer);

impl FieldType for By {
    fn kind() -> Kind {
        Kind::OneOf(vec![Kind::Object(Lattice::NAME), Kind::Object(Pins::NAME)])
    }
    fn read(value: &Value, reader: &mut Reader) -> Option<Self> {
        if let Value::Handle(h) = value {
            if let Some(lattice) = h.get::<Lattice>() {
                return Some(Self(Deformer::Lattice(lattice)));
            }
            if let Some(pins) = h.get::<Pins>() {
                return Some(Self(Deformer::Pins(pins)));
            }
        }
        reader.wrong_type("a Lattice or Pins", value)
    }
}

/// A method that deforms: what it does to the points of a value.
pub trait Verb: Params {
    /// The deformers, one after the other; lattices of verbs are made around `points`.
    ///
    /// # Errors
    /// What no lattice can be made of.
    fn deformers(&self, points: &[Vec3]) -> std::result::Result<Vec<Deformer>, DeformError>;
}

impl Verb for DeformFields {
    fn deformers(&self, _: &[Vec3]) -> std::result::Result<Vec<Deformer>, DeformError> {
        Ok(self.by.iter().map(|b| b.0.clone()).collect())
    }
}

macro_rules! verbs {
    ($($ty:ty),*) => {$(
        impl Verb for $ty {
            fn deformers(&self, points: &[Vec3]) -> std::result::Result<Vec<Deformer>, DeformError> {
                Ok(self.lattice(points)?.map(|l| Deformer::Lattice(Arc::new(l))).into_iter().collect())
            }
        }
    )*};
}
verbs!(Bend, Taper, Lift);

/// `coif.lattice`, `coif.pins`.
pub fn functions() -> Vec<Entry> {
    vec![
        Entry::table::<LatticeFields>("coif.lattice", "Lattice", lattice),
        Entry::table::<PinsFields>("coif.pins", "Pins", pins),
    ]
}

/// Lattices and pins.
pub fn nouns() -> Vec<Noun> {
    let methods = vec![
        Entry::table::<MoveFields>("Lattice:move", "Lattice", move_points),
        Entry::table::<GroupFields>("Lattice:group", "Lattice", group),
        Entry::table::<MarkFields>("Lattice:mark", "Lattice", mark),
        Entry::table::<HoldFields>("Lattice:hold", "Lattice", hold),
        Entry::table::<FollowFields>("Lattice:follow", "Lattice", follow),
        Entry::positional::<PlaceFields>("Lattice:place", "vector", place),
    ];
    let getters = vec![Getter {
        name: "count",
        doc: "How many control points.",
        returns: "number",
        get: |h| h.get::<Lattice>().map_or(Value::Nil, |l| Value::Number(l.count() as f64)),
    }];
    let text = |h: &crate::params::Handle| {
        h.get::<Lattice>().map_or_else(String::new, |l| {
            let [a, b, c] = l.divisions();
            format!("lattice of {a} x {b} x {c} divisions")
        })
    };
    let lattice = Noun::of::<Lattice>(
        "A grid of control points; what is inside follows them, what is outside stays.",
        methods,
        getters,
        text,
    );
    let methods = vec![
        Entry::plain(
            "Pins:settled",
            "The next step: every point stands where this step leaves it, and none has a target yet.",
            "Pins",
            settled,
        ),
        Entry::table::<PinMarkFields>("Pins:mark", "Pins", mark_pin),
    ];
    let text =
        |h: &crate::params::Handle| h.get::<Pins>().map_or_else(String::new, |p| format!("{} pins", p.points().len()));
    vec![lattice, Noun::of::<Pins>("Fixed points and operated points in space.", methods, vec![], text)]
}

/// The methods of strands.
pub fn strands_methods() -> Vec<Entry> {
    vec![
        Entry::both::<DeformFields, HairFields>("Strands:deform", "Strands", strands::<DeformFields>),
        Entry::both::<Bend, HairFields>("Strands:bend", "Strands", strands::<Bend>),
        Entry::both::<Taper, HairFields>("Strands:taper", "Strands", strands::<Taper>),
        Entry::both::<Lift, HairFields>("Strands:lift", "Strands", strands::<Lift>),
        Entry::table::<CarryFields>("Strands:carry", "Strands", carry_strands),
    ]
}

/// The methods of tufts.
pub fn tufts_methods() -> Vec<Entry> {
    vec![
        Entry::both::<DeformFields, HairFields>("Tufts:deform", "Tufts", tufts::<DeformFields>),
        Entry::both::<Bend, HairFields>("Tufts:bend", "Tufts", tufts::<Bend>),
        Entry::both::<Taper, HairFields>("Tufts:taper", "Tufts", tufts::<Taper>),
        Entry::both::<Lift, HairFields>("Tufts:lift", "Tufts", tufts::<Lift>),
        Entry::table::<CarryFields>("Tufts:carry", "Tufts", carry_tufts),
    ]
}

/// The methods of caps, buns and rings.
pub fn piece_methods() -> Vec<Entry> {
    vec![
        Entry::table::<DeformFields>("Piece:deform", "Piece", piece::<DeformFields>),
        Entry::table::<Bend>("Piece:bend", "Piece", piece::<Bend>),
        Entry::table::<Taper>("Piece:taper", "Piece", piece::<Taper>),
        Entry::table::<Lift>("Piece:lift", "Piece", piece::<Lift>),
        Entry::table::<CarryFields>("Piece:carry", "Piece", carry_piece),
    ]
}

/// The methods of heads.
pub fn head_methods() -> Vec<Entry> {
    vec![
        Entry::table::<DeformFields>("Head:deform", "Head", head::<DeformFields>),
        Entry::table::<Bend>("Head:bend", "Head", head::<Bend>),
        Entry::table::<Taper>("Head:taper", "Head", head::<Taper>),
        Entry::table::<Lift>("Head:lift", "Head", head::<Lift>),
    ]
}

/// The methods of strands in motion.
pub fn moving_strands_methods() -> Vec<Entry> {
    vec![
        Entry::both::<DeformFields, HairFields>("StrandsClip:deform", "StrandsClip", moving_strands::<DeformFields>),
        Entry::both::<Bend, HairFields>("StrandsClip:bend", "StrandsClip", moving_strands::<Bend>),
        Entry::both::<Taper, HairFields>("StrandsClip:taper", "StrandsClip", moving_strands::<Taper>),
        Entry::both::<Lift, HairFields>("StrandsClip:lift", "StrandsClip", moving_strands::<Lift>),
    ]
}

/// The methods of stylised hair in motion.
pub fn moving_locks_methods() -> Vec<Entry> {
    vec![
        Entry::table::<DeformFields>("LocksClip:deform", "LocksClip", moving_locks::<DeformFields>),
        Entry::table::<Bend>("LocksClip:bend", "LocksClip", moving_locks::<Bend>),
        Entry::table::<Taper>("LocksClip:taper", "LocksClip", moving_locks::<Taper>),
        Entry::table::<Lift>("LocksClip:lift", "LocksClip", moving_locks::<Lift>),
    ]
}

/// An error of the methods, about a field when it is of one.
pub fn failed(call: &Call, path: &str, error: &DeformError) -> Raised {
    call.problem_at(path, error.to_string(), error.hint())
}

// --- lattices and pins ---------------------------------------------------------------------------------------------

fn lattice(call: &Call) -> Result<Value> {
    let fields: LatticeFields = call.read()?;
    let [l, m, n] = fields.divisions[..] else {
        let message = format!("`divisions` has {} numbers", fields.divisions.len());
        return Err(call.problem_at("divisions", message, Some("give three: { 4, 4, 4 }".into())));
    };
    let made = match (&fields.around, fields.corner) {
        (Value::Nil, None) => {
            let hint = "say what it goes around: `around = hair`, or give a `corner` and three `edges`".to_owned();
            return Err(call.problem("the lattice has no place", Some(hint)));
        }
        (Value::Nil, Some(corner)) => {
            let [s, t, u] = fields.edges[..] else {
                let message = format!("`edges` has {} vectors", fields.edges.len());
                let hint = "give three: { { 10, 0, 0 }, { 0, 10, 0 }, { 0, 0, 10 } }".to_owned();
                return Err(call.problem_at("edges", message, Some(hint)));
            };
            Lattice::new(corner, [s, t, u], [l, m, n])
        }
        (_, Some(_)) => {
            return Err(call.problem_at(
                "corner",
                "`around` and `corner` both say where it is",
                Some("leave one of them out".into()),
            ));
        }
        (around, None) => match around {
            Value::Handle(h) if h.get::<OrientedBox>().is_some() => {
                let b = h.get::<OrientedBox>().unwrap_or_else(|| Arc::new(OrientedBox::aligned(Vec3::ZERO, Vec3::ONE)));
                let half = b.half + Vec3::splat(fields.margin);
                let edge = |a: usize| b.axes.col(a) * (2.0 * half[a]);
                let edges = [edge(0), edge(1), edge(2)];
                Lattice::new(b.centre - b.axes * half, edges, [l, m, n])
            }
            other => {
                let bounds = bounds_of(other).ok_or_else(|| {
                    let message = format!(
                        "expected a Garment, Strands, Tufts, a Piece, a Head or a Box, got {} `{other}`",
                        other.type_name()
                    );
                    call.problem_at("around", message, None)
                })?;
                Lattice::around(bounds.grown(fields.margin), [l, m, n])
            }
        },
    };
    made.map(give)
        .map_err(|e| failed(call, if matches!(e, DeformError::OutOfRange { .. }) { "divisions" } else { "" }, &e))
}

/// The bounds of anything that has some.
fn bounds_of(value: &Value) -> Option<Bounds> {
    let Value::Handle(h) = value else { return None };
    if let Some(lock) = h.get::<Lock>() {
        return Some(lock.strands.bounds());
    }
    if let Some(wig) = h.get::<Wig>() {
        return Some(wig.tufts.mesh().mesh.bounds());
    }
    if let Some(piece) = h.get::<Piece>() {
        return Some(piece.mesh.bounds());
    }
    if let Some(cloth) = h.get::<Cloth>() {
        return Some(cloth.garment.mesh.bounds());
    }
    h.get::<Head>().map(|head| head.mesh.bounds())
}

/// An index range of a script: nothing, a number, or two.
fn range(call: &Call, path: &str, value: &Value) -> Result<Option<(i64, i64)>> {
    let whole = |v: &Value| match v {
        Value::Number(n) if n.fract() == 0.0 && n.abs() < 1e9 => Some(*n as i64),
        _ => None,
    };
    let found = match value {
        Value::Nil => return Ok(None),
        Value::Table(t) if t.fields.is_empty() => match t.items.as_slice() {
            [a, b] => whole(a).zip(whole(b)),
            _ => None,
        },
        v => whole(v).map(|n| (n, n)),
    };
    found.map(Some).ok_or_else(|| {
        let hint = "write one index, as 2, or the first and the last, as { 0, 2 }".to_owned();
        call.problem_at(path, format!("`{value}` is no index"), Some(hint))
    })
}

fn select(call: &Call, lattice: &Lattice, [i, j, k]: [&Value; 3], group: Option<&String>) -> Result<Vec<u32>> {
    let ranges = [range(call, "i", i)?, range(call, "j", j)?, range(call, "k", k)?];
    lattice.select(&Selection { ranges, group: group.cloned() }).map_err(|e| {
        let path = match &e {
            DeformError::NoControlPoint { axis, .. } => axis.to_string(),
            _ => "group".to_owned(),
        };
        failed(call, &path, &e)
    })
}

fn move_points(call: &Call) -> Result<Value> {
    let (this, fields) = (call.this::<Lattice>()?, call.read::<MoveFields>()?);
    let points = select(call, &this, [&fields.i, &fields.j, &fields.k], fields.group.as_ref())?;
    let mut reader = Reader::default();
    let scale = match &fields.scale {
        Value::Nil => Some(Vec3::ONE),
        Value::Number(n) => Some(Vec3::splat(*n as f32)),
        other => reader.inside("scale", |r| Vec3::read(other, r)),
    };
    let mut by = Some(Vec3::ZERO);
    let mut asked: Option<Vec<Vec3>> = None;
    match &fields.by {
        Value::Nil => {}
        Value::Function(f) => {
            let ask = |&index: &u32| {
                let at = this.indices(index as usize).map(|c| Value::Number(c as f64));
                let [i, j, k] = at;
                let answer = call.script(Function(*f), &[Value::Vector(this.place(index as usize)), i, j, k])?;
                let mut reader = Reader::default();
                if matches!(answer, Value::Nil) {
                    return Ok(Vec3::ZERO);
                }
                Vec3::read(&answer, &mut reader).ok_or_else(|| {
                    let hint = "it must return how far the point moves: a vector, or { x, y, z }".to_owned();
                    call.problem_at(
                        "by",
                        format!("the function returned {} `{answer}`", answer.type_name()),
                        Some(hint),
                    )
                })
            };
            asked = Some(points.iter().map(ask).collect::<Result<_>>()?);
        }
        other => by = reader.inside("by", |r| Vec3::read(other, r)),
    }
    let (Some(scale), Some(by)) = (scale, by) else { return Err(call.problems(reader.problems())) };
    let how = Move { by, scale, turn: Quat::from_axis_angle(fields.axis.0, fields.turn.radians), about: fields.about };
    let lattice = Lattice::clone(&this).moved(&points, &how).map_err(|e| failed(call, "", &e))?;
    let lattice = match asked {
        None => Ok(lattice),
        Some(by) => {
            let mut by = points.iter().zip(by).collect::<std::collections::BTreeMap<_, _>>();
            lattice.placed(&points, |i, p| p + by.remove(&i).unwrap_or_default())
        }
    };
    lattice.map(give).map_err(|e| failed(call, "by", &e))
}

fn group(call: &Call) -> Result<Value> {
    let (this, fields) = (call.this::<Lattice>()?, call.read::<GroupFields>()?);
    let points = select(call, &this, [&fields.i, &fields.j, &fields.k], None)?;
    Ok(give(Lattice::clone(&this).named(&fields.name, points)))
}

fn mark(call: &Call) -> Result<Value> {
    let (this, fields) = (call.this::<Lattice>()?, call.read::<MarkFields>()?);
    let points = select(call, &this, [&fields.i, &fields.j, &fields.k], fields.group.as_ref())?;
    Ok(give(Lattice::clone(&this).marked(&points, fields.kind)))
}

fn hold(call: &Call) -> Result<Value> {
    let (this, fields) = (call.this::<Lattice>()?, call.read::<HoldFields>()?);
    let held = Lattice::clone(&this).holding(&fields.points, fields.power);
    held.map(give).map_err(|e| failed(call, "", &e))
}

fn follow(call: &Call) -> Result<Value> {
    let (this, fields) = (call.this::<Lattice>()?, call.read::<FollowFields>()?);
    Lattice::clone(&this).followed(fields.power).map(give).map_err(|e| failed(call, "", &e))
}

fn place(call: &Call) -> Result<Value> {
    let (this, fields) = (call.this::<Lattice>()?, call.read::<PlaceFields>()?);
    let at = |n: u32| Value::Number(f64::from(n));
    let points = select(call, &this, [&at(fields.i), &at(fields.j), &at(fields.k)], None)?;
    Ok(points.first().map_or(Value::Nil, |&i| Value::Vector(this.place(i as usize))))
}

fn pins(call: &Call) -> Result<Value> {
    let fields: PinsFields = call.read()?;
    let points = fields.points.into_iter().enumerate().map(|(i, p)| {
        let kind = p.kind.unwrap_or(if p.to.is_some() { PointKind::Feature } else { PointKind::Fixed });
        if kind == PointKind::Fixed && p.to.is_some() {
            let hint = Some("leave out `to`, or choose another `kind`".to_owned());
            return Err(call.problem_at(&format!("[{}].to", i + 1), "a fixed point has no target", hint));
        }
        Ok(Pin { name: p.name, at: p.at, to: p.to, kind })
    });
    let points = points.collect::<Result<_>>()?;
    Pins::of(points, fields.power).map(give).map_err(|e| failed(call, "", &e))
}

fn settled(call: &Call) -> Result<Value> {
    Ok(give(call.this::<Pins>()?.settled()))
}

fn mark_pin(call: &Call) -> Result<Value> {
    let (this, fields) = (call.this::<Pins>()?, call.read::<PinMarkFields>()?);
    if fields.kind == PointKind::Fixed && fields.to.is_some() {
        let hint = Some("leave out `to`, or choose another `kind`".to_owned());
        return Err(call.problem_at("to", "a fixed point has no target", hint));
    }
    this.marked(&fields.name, fields.kind, fields.to).map(give).map_err(|e| {
        let path = if matches!(e, DeformError::Unknown { .. }) { "name" } else { "" };
        failed(call, path, &e)
    })
}

// --- what they are applied to --------------------------------------------------------------------------------------

/// The deformers of a call on a value with these points.
pub fn deformers<V: Verb>(call: &Call, verb: &V, points: &[Vec3]) -> Result<Vec<Deformer>> {
    verb.deformers(points).map_err(|e| failed(call, "", &e))
}

/// A key of deformers.
pub fn key_of(by: &[Deformer], into: &mut Digest) {
    into.number(by.len() as u64);
    by.iter().for_each(|b| b.digest(into));
}

/// With what the deformers look like, for the debug view.
pub fn drawn(overlay: &Arc<Overlay>, by: &[Deformer]) -> Arc<Overlay> {
    let mut all = Overlay::clone(overlay);
    for one in by {
        match one {
            Deformer::Lattice(lattice) => all.extend(&overlay::lattice(lattice)),
            Deformer::Pins(pins) => all.extend(&overlay::pins(pins)),
            Deformer::Warp(_) => {}
        }
    }
    Arc::new(all)
}

/// Strands of the call's value that take part; empty for all.
fn which(call: &Call, fields: &HairFields, strands: &Strands) -> Result<Vec<bool>> {
    fields.r#where.map_or(Ok(vec![]), |test| call.choose(test, "where", &strands.roots))
}

/// The nodes of the strands that take part.
fn chosen(strands: &Strands, which: &[bool]) -> Vec<Vec3> {
    if which.is_empty() {
        return strands.points.clone();
    }
    (0..strands.count()).filter(|&i| which[i]).flat_map(|i| strands.strand(i).to_vec()).collect()
}

/// Strands deformed and kept out of their head.
fn moved(
    call: &Call,
    lock: &Lock,
    of: &Arc<Strands>,
    by: &[Deformer],
    fields: &HairFields,
    which: &[bool],
) -> Result<Arc<Strands>> {
    let head = &lock.area.head;
    let mut key = Digest::new("deform strands 1");
    key.key(head.key()).key(call.session.options.memo.content(of)).floats(&[fields.roots, fields.margin]).flags(which);
    key_of(by, &mut key);
    call.memo_strands(&key, &of.sources, || {
        let hold = Hold { root: fields.roots, which };
        let mut out = deform::strands(of, by, &hold, call.task()).map_err(|e| failed(call, "", &e))?;
        let body = Body { solid: &head.solid, margin: fields.margin };
        let changed: Vec<bool> = (0..of.count()).map(|i| of.strand(i) != out.strand(i)).collect();
        let [cut, stuck] = keep_out(&mut out, &|i| changed[i], body, call.task())
            .map_err(|e| failed(call, "", &DeformError::from(e)))?;
        let mut warned = Warned::clean(out);
        if cut + stuck > 0 {
            warned.warnings.push(
                Warning::new(format!("{} strands would run into the head, and end there", cut + stuck))
                    .hint("move them less, or let the motion come in over a longer way: `roots = 6`"),
            );
        }
        Ok(warned)
    })
}

fn strands<V: Verb>(call: &Call) -> Result<Value> {
    let this = call.this::<Lock>()?;
    let (verb, fields) = call.read_both::<V, HairFields>()?;
    let is_guide = Arc::ptr_eq(&this.strands, &this.guides);
    let of_strands = which(call, &fields, &this.strands)?;
    let by = deformers(call, &verb, &chosen(&this.strands, &of_strands))?;
    let strands = moved(call, &this, &this.strands, &by, &fields, &of_strands)?;
    let guides = if is_guide {
        Arc::clone(&strands)
    } else {
        let of_guides = which(call, &fields, &this.guides)?;
        moved(call, &this, &this.guides, &by, &fields, &of_guides)?
    };
    Ok(give(Lock { strands, guides, overlay: drawn(&this.overlay, &by), ..Lock::clone(&this) }))
}

fn moving_strands<V: Verb>(call: &Call) -> Result<Value> {
    let this = call.this::<MovingStrands>()?;
    let (verb, fields) = call.read_both::<V, HairFields>()?;
    let of_strands = which(call, &fields, &this.rest.strands)?;
    let by = deformers(call, &verb, &chosen(&this.rest.strands, &of_strands))?;
    let frames = |clip: &crate::geometry::Clip<Strands>, which: &[bool]| {
        clip.try_map(|i, frame| {
            call.task().progress("deform", i as f32 / clip.count() as f32);
            moved(call, &this.rest, frame, &by, &fields, which)
        })
    };
    let strands = frames(&this.strands, &of_strands)?;
    let is_one = this.strands.frames.iter().zip(&this.guides.frames).all(|(a, b)| Arc::ptr_eq(a, b));
    let guides =
        if is_one { strands.clone() } else { frames(&this.guides, &which(call, &fields, &this.rest.guides)?)? };
    let rest = Lock {
        strands: moved(call, &this.rest, &this.rest.strands, &by, &fields, &of_strands)?,
        overlay: drawn(&this.rest.overlay, &by),
        ..this.rest.clone()
    };
    let mut key = Digest::new("deform clip 1");
    key.key(this.key).floats(&[fields.roots, fields.margin]).flags(&of_strands);
    key_of(&by, &mut key);
    Ok(give(MovingStrands { rest, strands, guides, motion: this.motion.clone(), key: key.finish() }))
}

fn moving_locks<V: Verb>(call: &Call) -> Result<Value> {
    let (this, verb) = (call.this::<MovingLocks>()?, call.read::<V>()?);
    let locks = this.rest.locks();
    let by = deformers(call, &verb, &locks.mesh.mesh.positions)?;
    let surface = this.surface.try_map(|i, frame| {
        call.task().progress("deform", i as f32 / this.surface.count() as f32);
        deform::points(frame, &by, call.task()).map(Arc::new).map_err(|e| failed(call, "", &e))
    })?;
    Ok(give(MovingLocks { surface, ..MovingLocks::clone(&this) }))
}

/// A tuft along its moved control points. What its root does is up to `hold`.
fn tuft_along(call: &Call, tuft: &Tuft, to: &[Vec3], hold: &Hold) -> Result<Tuft> {
    let from = tuft.stroke.points();
    let (mut along, mut points) = (0.0, Vec::with_capacity(from.len()));
    for k in 0..from.len() {
        if k > 0 {
            along += from[k].distance(from[k - 1]);
        }
        points.push(from[k] + (to[k] - from[k]) * hold.share(along));
    }
    let stroke = Stroke::new(points, tuft.stroke.reference(), tuft.stroke.depth());
    Ok(tuft.along(stroke.map_err(|e| tuft_error(call, "", &e))?))
}

fn tufts<V: Verb>(call: &Call) -> Result<Value> {
    let this = call.this::<Wig>()?;
    let (verb, fields) = call.read_both::<V, HairFields>()?;
    let takes: Vec<bool> = match fields.r#where {
        None => vec![true; this.tufts.count()],
        Some(test) => {
            let roots: Vec<_> =
                this.tufts.tufts.iter().map(|t| this.head.root(&this.head.closest(t.stroke.root()))).collect();
            call.choose(test, "where", &roots)?
        }
    };
    let chosen: Vec<Vec3> = this
        .tufts
        .tufts
        .iter()
        .zip(&takes)
        .filter(|(_, t)| **t)
        .flat_map(|(t, _)| t.stroke.points().to_vec())
        .collect();
    let by = deformers(call, &verb, &chosen)?;
    let hold = Hold { root: fields.roots, which: &[] };
    let mut all = Tufts::clone(&this.tufts);
    for (tuft, _) in all.tufts.iter_mut().zip(&takes).filter(|(_, t)| **t) {
        let to = deform::points(tuft.stroke.points(), &by, call.task()).map_err(|e| failed(call, "", &e))?;
        if to != tuft.stroke.points() {
            *tuft = tuft_along(call, tuft, &to, &hold)?;
        }
    }
    let all = settled_tufts(call, all, &this.head, false, 0.5)?;
    Ok(give(Wig { tufts: Arc::new(all), ..Wig::clone(&this) }))
}

fn piece<V: Verb>(call: &Call) -> Result<Value> {
    let (this, verb) = (call.this::<Piece>()?, call.read::<V>()?);
    let by = deformers(call, &verb, &this.mesh.positions)?;
    let mesh = deform::mesh(&this.mesh, &by, call.task()).map_err(|e| failed(call, "", &e))?;
    Ok(give(Piece { mesh: Arc::new(mesh), ..Piece::clone(&this) }))
}

fn head<V: Verb>(call: &Call) -> Result<Value> {
    let (this, verb) = (call.this::<Head>()?, call.read::<V>()?);
    let by = deformers(call, &verb, &this.mesh.positions)?;
    let mut key = Digest::new("deform head 1");
    key_of(&by, key.key(this.key()));
    let name = format!("{:?} {:032x}", "deformed", key.finish());
    if let Some(head) = call.session.heads.borrow().get(&name) {
        return Ok(Value::Handle(crate::params::Handle::new(Arc::clone(head))));
    }
    let head = call.memo(&key, || {
        let error = |e: DeformError| failed(call, "", &e);
        let mesh = deform::mesh(&this.mesh, &by, call.task()).map_err(error)?;
        let marks = deform::points(&this.landmarks.all(), &by, call.task()).map_err(error)?;
        let mut all = this.landmarks.all();
        all.copy_from_slice(&marks);
        let made = Head::with_landmarks(mesh, &this.name, crate::head::Landmarks::from_all(all));
        let mut made = made.map_err(|e| call.problem(e.to_string(), e.hint()))?;
        made.placement = this.placement * made.placement;
        Ok(Warned::clean(made))
    })?;
    call.session.heads.borrow_mut().insert(name, Arc::clone(&head));
    Ok(Value::Handle(crate::params::Handle::new(head)))
}

// --- to another head -----------------------------------------------------------------------------------------------

/// The motion from one head to another.
pub fn between(call: &Call, from: &Head, to: &Head) -> Result<Deformer> {
    let warp = deform::Warp::new(matching(from, to)).map_err(|e| failed(call, "to", &e))?;
    Ok(Deformer::Warp(Arc::new(warp)))
}

/// Over how long a way from the root a strand comes back to where the warp alone would have it, cm.
const SETTLING: f32 = 4.0;

/// Strands laid on another head.
fn laid(call: &Call, of: &Arc<Strands>, from: &Head, to: &Head, by: &Deformer) -> Result<Arc<Strands>> {
    let mut key = Digest::new("carry strands 1");
    key.key(from.key()).key(to.key()).key(call.session.options.memo.content(of));
    call.memo_strands(&key, &of.sources, || {
        let by = std::slice::from_ref(by);
        let error = |e: DeformError| failed(call, "", &e);
        let mut out = deform::strands(of, by, &Hold::default(), call.task()).map_err(error)?;
        for i in 0..out.count() {
            let range = out.range(i);
            let root = to.root(&to.closest(out.points[range.start]));
            let off = root.position - out.points[range.start];
            let mut along = 0.0;
            let mut before = out.points[range.start];
            for k in range {
                let p = out.points[k];
                along += p.distance(before);
                before = p;
                out.points[k] += off * (1.0 - crate::math::trig::smoothstep(0.0, SETTLING * to.scale, along));
            }
            out.roots[i] = crate::geometry::Root { id: out.roots[i].id, ..root };
        }
        let body = Body { solid: &to.solid, margin: 0.1 * to.scale };
        let [cut, stuck] =
            keep_out(&mut out, &|_| true, body, call.task()).map_err(|e| failed(call, "", &DeformError::from(e)))?;
        let mut warned = Warned::clean(out);
        if cut + stuck > 0 {
            warned
                .warnings
                .push(Warning::new(format!("{} strands are cut short: they would run into the new head", cut + stuck)));
        }
        Ok(warned)
    })
}

/// Hair carried to another head.
pub fn carried_strands(call: &Call, lock: &Lock, to: &Arc<Head>) -> Result<Lock> {
    let from = &lock.area.head;
    let by = between(call, from, to)?;
    let strands = laid(call, &lock.strands, from, to, &by)?;
    let guides = if Arc::ptr_eq(&lock.strands, &lock.guides) {
        Arc::clone(&strands)
    } else {
        laid(call, &lock.guides, from, to, &by)?
    };
    let area = super::region::Area::new(Arc::clone(to), to.scalp());
    Ok(Lock { strands, guides, area, overlay: Arc::default(), ..lock.clone() })
}

/// Tufts carried to another head.
pub fn carried_tufts(call: &Call, wig: &Wig, to: &Arc<Head>) -> Result<Wig> {
    let by = [between(call, &wig.head, to)?];
    let (mut all, ground) = (Tufts::clone(&wig.tufts), ground(to));
    let grown = to.scale / wig.head.scale;
    for tuft in &mut all.tufts {
        let points = deform::points(tuft.stroke.points(), &by, call.task()).map_err(|e| failed(call, "", &e))?;
        let stroke = Stroke::new(points, ground.reference, tuft.stroke.depth() * grown);
        let stroke = stroke.map_err(|e: TuftError| tuft_error(call, "", &e))?;
        let on = ground.solid.closest(stroke.root());
        let (id, stroke) = (tuft.id, stroke.moved_to(on.position));
        *tuft = Tuft { id, ..tuft.along(stroke) };
    }
    let all = settled_tufts(call, all, to, true, 0.5)?;
    Ok(Wig { tufts: Arc::new(all), head: Arc::clone(to), palette: wig.palette.clone() })
}

/// A cap, a bun or a ring carried to another head.
pub fn carried_piece(call: &Call, piece: &Piece, to: &Arc<Head>) -> Result<Piece> {
    let by = [between(call, &piece.head, to)?];
    let mesh = deform::mesh(&piece.mesh, &by, call.task()).map_err(|e| failed(call, "", &e))?;
    let mesh = if piece.kind == crate::scene::LockKind::Cap {
        // A cap lies on the skin: what the warp leaves inside comes out.
        let cleared = crate::garment::clear(&mesh, &to.solid, 0.15 * to.scale, call.task());
        let cleared = cleared.map_err(|e| failed(call, "", &DeformError::from(e)))?;
        mesh.moved(&cleared.positions)
    } else {
        mesh
    };
    Ok(Piece { mesh: Arc::new(mesh), head: Arc::clone(to), ..piece.clone() })
}

fn carry_strands(call: &Call) -> Result<Value> {
    let (this, fields) = (call.this::<Lock>()?, call.read::<CarryFields>()?);
    Ok(give(carried_strands(call, &this, &fields.to)?))
}

fn carry_tufts(call: &Call) -> Result<Value> {
    let (this, fields) = (call.this::<Wig>()?, call.read::<CarryFields>()?);
    Ok(give(carried_tufts(call, &this, &fields.to)?))
}

fn carry_piece(call: &Call) -> Result<Value> {
    let (this, fields) = (call.this::<Piece>()?, call.read::<CarryFields>()?);
    Ok(give(carried_piece(call, &this, &fields.to)?))
}
