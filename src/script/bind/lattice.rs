//! Lattices and pins: what deforms.

use std::sync::Arc;

use glam::{Quat, Vec3};

use super::super::call::{Call, Result};
use super::super::registry::{Entry, Getter, Noun};
use super::super::session::Raised;
use super::garment::Cloth;
use super::head::give;
use super::piece::Piece;
use super::strands::Lock;
use super::tuft::Wig;
use crate::deform::{DeformError, Lattice, Move, Pin, Pins, PointKind, Selection};
use crate::geometry::{Bounds, OrientedBox};
use crate::head::Head;
use crate::params::{Angle, Direction, FieldType, Function, Object, Reader, Value};

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

/// An error of the methods, about a field when it is of one.
pub fn failed(call: &Call, path: &str, error: &DeformError) -> Raised {
    call.problem_at(path, error.to_string(), error.hint())
}

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
                let points = points_of(other).ok_or_else(|| {
                    let message = format!(
                        "expected a Garment, Strands, Tufts, a Piece, a Head or a Box, got {} `{other}`",
                        other.type_name()
                    );
                    call.problem_at("around", message, None)
                })?;
                Lattice::around(Bounds::of(points).grown(fields.margin), [l, m, n])
            }
        },
    };
    made.map(give)
        .map_err(|e| failed(call, if matches!(e, DeformError::OutOfRange { .. }) { "divisions" } else { "" }, &e))
}

/// The points of anything that has some.
pub fn points_of(value: &Value) -> Option<Vec<Vec3>> {
    let Value::Handle(h) = value else { return None };
    if let Some(b) = h.get::<OrientedBox>() {
        let sign = |i: usize, bit: usize| if i >> bit & 1 == 1 { 1.0 } else { -1.0 };
        let corner = |i: usize| b.centre + b.axes * (b.half * Vec3::new(sign(i, 0), sign(i, 1), sign(i, 2)));
        return Some((0..8).map(corner).collect());
    }
    if let Some(lock) = h.get::<Lock>() {
        return Some(lock.strands.points.clone());
    }
    if let Some(wig) = h.get::<Wig>() {
        return Some(wig.tufts.mesh().mesh.positions.clone());
    }
    if let Some(piece) = h.get::<Piece>() {
        return Some(piece.mesh.positions.clone());
    }
    if let Some(cloth) = h.get::<Cloth>() {
        return Some(cloth.garment.mesh.positions.clone());
    }
    h.get::<Head>().map(|head| head.mesh.positions.clone())
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
