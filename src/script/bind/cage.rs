//! Cages and warps: scattered control points.

use std::sync::Arc;

use glam::{Quat, Vec3};

use super::super::call::{Call, Result};
use super::super::registry::{Entry, Getter, Noun};
use super::garment::Cloth;
use super::head::give;
use super::lattice::{PinFields, failed, points_of};
use crate::deform::{Cage, DeformError, Move, PointKind, Warp};
use crate::params::{Angle, Direction, FieldType, Function, Object, Reader, Value};

impl Object for Cage {
    const NAME: &'static str = "Cage";
}

impl Object for Warp {
    const NAME: &'static str = "Warp";
}

crate::params! {
    /// A control point of a cage; with a target it goes there at once.
    pub struct CagePointFields("coif.cage.point") {
        /// Where it is.
        at: Vec3, unit("cm");
        /// Where it goes.
        to: Option<Vec3>, unit("cm");
        /// A name, to move it by.
        name: Option<String>;
        /// What it is for; `feature` with a target and `overall` without one when left out.
        kind: Option<PointKind>;
    }
}

crate::params! {
    /// A cage of scattered control points, without a grid: what is inside follows them, what is outside stays. The points
    /// are given (`{ at = place, to = place, name = "chin" }`, on all sides of what moves), or made around something, or
    /// they are the vertices of a closed mesh.
    pub struct CageFields("coif.cage") {
        /// Four control points or more, at most 500, on all sides of their middle.
        points: Vec<CagePointFields> = vec![], positional();
        /// Instead: what a cage is made around. It is a box with divided sides that is drawn in to it.
        around: Value = Value::Nil, takes("Garment|Strands|Tufts|Piece|Head|Box|nil");
        /// Of a cage that is made around something: into how many pieces each edge of the box is divided.
        divisions: u32 = 2, range(1.0, 8.0);
        /// Of a cage that is made around something: how far off it is.
        margin: f32 = 1.0, unit("cm"), range(0.0, 100.0);
        /// Instead: a closed mesh of at most 500 vertices, as loaded with `coif.garment.load`.
        mesh: Option<Arc<Cloth>>;
    }
}

crate::params! {
    /// Moves control points: scales and turns them about a place, then shifts them. Without `points`, `near` or `where` all
    /// of them; fixed ones stay.
    pub struct CageMoveFields("Cage:move") {
        /// Which, by name or by number from 1: one, or a list.
        points: Value = Value::Nil, takes("string|number|(string|number)[]|nil");
        /// Those near this place; without `within` the nearest one alone.
        near: Option<Vec3>, unit("cm");
        /// How near.
        within: Option<f32>, unit("cm"), range(0.0, 1000.0);
        /// Those for which a function returns true: it is told where a point stands, and its number.
        r#where: Option<Function>, takes("(place: vector, number: number): boolean");
        /// How far; or a function that is told where a point stands and its number, and returns how far.
        by: Value = Value::Nil, takes("Point|fun(place: vector, number: number): vector");
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
    /// Says what control points are for: `overall`, `feature` or `fixed`. It may change between steps.
    pub struct CageMarkFields("Cage:mark") {
        /// The kind.
        kind: PointKind;
        /// Which, by name or by number from 1: one, or a list.
        points: Value = Value::Nil, takes("string|number|(string|number)[]|nil");
        /// Those near this place; without `within` the nearest one alone.
        near: Option<Vec3>, unit("cm");
        /// How near.
        within: Option<f32>, unit("cm"), range(0.0, 1000.0);
        /// Those for which a function returns true: it is told where a point stands, and its number.
        r#where: Option<Function>, takes("(place: vector, number: number): boolean");
    }
}

crate::params! {
    /// Holds places of the object itself: what is near them moves less, and they do not move at all.
    pub struct CageHoldFields("Cage:hold") {
        /// The places.
        points: Vec<Vec3>, positional(), unit("cm");
        /// How sharply the hold falls off: the exponent of the affinity.
        power: f32 = 2.0, range(0.5, 8.0);
    }
}

crate::params! {
    /// Lets overall control points follow the feature points that were moved, held back by the fixed ones.
    pub struct CageFollowFields("Cage:follow") {
        /// The exponent of the affinity.
        power: f32 = 2.0, range(0.5, 8.0);
    }
}

crate::params! {
    /// Where a control point stands.
    pub struct CagePlaceFields("Cage:place") {
        /// Its name, or its number from 1.
        point: Value, takes("string|number");
    }
}

crate::params! {
    /// A smooth motion of all space through scattered points: a point with a target goes there, one without stays. It has
    /// no border, and far away it goes on; so give points that stay on the other side too.
    pub struct WarpFields("coif.warp") {
        /// Four points or more that do not lie in a plane, as of `coif.pins`.
        points: Vec<PinFields>, positional();
    }
}

/// `coif.cage`, `coif.warp`.
pub fn functions() -> Vec<Entry> {
    vec![Entry::table::<CageFields>("coif.cage", "Cage", cage), Entry::table::<WarpFields>("coif.warp", "Warp", warp)]
}

/// Cages and warps.
pub fn nouns() -> Vec<Noun> {
    let methods = vec![
        Entry::table::<CageMoveFields>("Cage:move", "Cage", move_points),
        Entry::table::<CageMarkFields>("Cage:mark", "Cage", mark),
        Entry::table::<CageHoldFields>("Cage:hold", "Cage", hold),
        Entry::table::<CageFollowFields>("Cage:follow", "Cage", follow),
        Entry::positional::<CagePlaceFields>("Cage:place", "vector", place),
    ];
    let getters = vec![Getter {
        name: "count",
        doc: "How many control points.",
        returns: "number",
        get: |h| h.get::<Cage>().map_or(Value::Nil, |c| Value::Number(c.count() as f64)),
    }];
    let cage = Noun::of::<Cage>(
        "A closed surface of scattered control points; what is inside follows them, what is outside stays.",
        methods,
        getters,
        |h| h.get::<Cage>().map_or_else(String::new, |c| format!("cage of {} control points", c.count())),
    );
    let warp = Noun::of::<Warp>("A smooth motion of all space through scattered points.", vec![], vec![], |h| {
        h.get::<Warp>().map_or_else(String::new, |w| format!("warp through {} points", w.pairs().len()))
    });
    vec![cage, warp]
}

fn cage(call: &Call) -> Result<Value> {
    let fields: CageFields = call.read()?;
    let given = [!fields.points.is_empty(), !matches!(fields.around, Value::Nil), fields.mesh.is_some()];
    match given.iter().filter(|g| **g).count() {
        1 => {}
        0 => {
            let hint = "say what it goes around: `around = hair`, or give control points: `{ at = place }, ...`".into();
            return Err(call.problem("the cage has no control points", Some(hint)));
        }
        _ => {
            let path = if given[2] { "mesh" } else { "around" };
            let hint = Some("give points, or `around`, or `mesh`, one of them".into());
            return Err(call.problem_at(path, "the cage has its control points twice", hint));
        }
    }
    if let Some(mesh) = &fields.mesh {
        return Cage::of(&mesh.garment.mesh).map(give).map_err(|e| failed(call, "mesh", &e));
    }
    if given[1] {
        let Some(places) = points_of(&fields.around) else {
            let (of, kind) = (&fields.around, fields.around.type_name());
            let message = format!("expected a Garment, Strands, Tufts, a Piece, a Head or a Box, got {kind} `{of}`");
            return Err(call.problem_at("around", message, None));
        };
        let made = Cage::around(&places, fields.divisions, fields.margin);
        return made.map(give).map_err(|e| {
            failed(call, if matches!(e, DeformError::OutOfRange { .. }) { "divisions" } else { "around" }, &e)
        });
    }
    let made = Cage::through(fields.points.iter().map(|p| (p.name.clone(), p.at)).collect());
    let mut cage = made.map_err(|e| failed(call, "", &e))?;
    for (i, point) in fields.points.iter().enumerate() {
        let kind = point.kind.unwrap_or(if point.to.is_some() { PointKind::Feature } else { PointKind::Overall });
        if kind == PointKind::Fixed && point.to.is_some() {
            let hint = Some("leave out `to`, or choose another `kind`".to_owned());
            return Err(call.problem_at(&format!("[{}].to", i + 1), "a fixed point has no target", hint));
        }
        cage = cage.marked(&[i as u32], kind);
        if let Some(to) = point.to {
            cage = cage.placed(&[i as u32], |_, _| to).map_err(|e| failed(call, "", &e))?;
        }
    }
    Ok(give(cage))
}

fn warp(call: &Call) -> Result<Value> {
    let fields: WarpFields = call.read()?;
    for (i, point) in fields.points.iter().enumerate() {
        if point.kind == Some(PointKind::Fixed) && point.to.is_some() {
            let hint = Some("leave out `to`, or choose another `kind`".to_owned());
            return Err(call.problem_at(&format!("[{}].to", i + 1), "a fixed point has no target", hint));
        }
    }
    let pairs = fields.points.iter().map(|p| (p.at, p.to.unwrap_or(p.at))).collect();
    Warp::new(pairs).map(give).map_err(|e| failed(call, "", &e))
}

/// One control point, by name or number.
fn one(call: &Call, cage: &Cage, value: &Value) -> Result<u32> {
    match value {
        Value::Text(name) => cage.named(name).map_err(|e| failed(call, "points", &e)),
        Value::Number(n) if n.fract() == 0.0 && *n >= 1.0 && *n <= cage.count() as f64 => Ok(*n as u32 - 1),
        Value::Number(n) => {
            let message = format!("there is no control point `{n}`: they go from 1 to {}", cage.count());
            Err(call.problem_at("points", message, None))
        }
        other => {
            let hint = Some("write a name, as \"chin\", a number, as 3, or a list of them".to_owned());
            Err(call.problem_at("points", format!("`{other}` is no control point"), hint))
        }
    }
}

/// What control points a call speaks of.
struct Which<'a> {
    points: &'a Value,
    near: Option<Vec3>,
    within: Option<f32>,
    test: Option<Function>,
}

/// The control points of a call, ascending: those that meet everything it says.
fn select(call: &Call, cage: &Cage, which: &Which) -> Result<Vec<u32>> {
    let mut found: Vec<u32> = match which.points {
        Value::Nil => (0..cage.count() as u32).collect(),
        Value::Table(t) if t.fields.is_empty() => t.items.iter().map(|v| one(call, cage, v)).collect::<Result<_>>()?,
        other => vec![one(call, cage, other)?],
    };
    found.sort_unstable();
    found.dedup();
    match (which.near, which.within) {
        (None, Some(_)) => {
            let hint = Some("say of what place: `near = head:at(\"chin\")`".to_owned());
            return Err(call.problem_at("within", "`within` without `near`", hint));
        }
        (None, None) => {}
        (Some(p), within) => {
            let far = |i: u32| cage.place(i as usize).distance(p);
            let nearest = found.iter().map(|&i| far(i)).fold(f32::INFINITY, f32::min);
            found.retain(|&i| far(i) <= within.unwrap_or(nearest));
            if let (true, Some(within)) = (found.is_empty(), within) {
                let message = format!("no control point is within {within} cm: the nearest is {nearest:.1} cm away");
                return Err(call.problem_at("within", message, Some("let `within` be larger".into())));
            }
        }
    }
    if let Some(test) = which.test {
        let mut kept = vec![];
        for &i in &found {
            let answer = call.script(test, &[Value::Vector(cage.place(i as usize)), number(i)])?;
            match answer {
                Value::Bool(true) => kept.push(i),
                Value::Bool(false) => {}
                other => {
                    let message = format!("the function returned {} `{other}`", other.type_name());
                    let hint = "it must return true or false, as in `function(place) return place.y > 0 end`";
                    return Err(call.problem_at("where", message, Some(hint.into())));
                }
            }
        }
        if kept.is_empty() {
            let hint = Some("`--debug` draws the control points with their numbers".to_owned());
            return Err(call.problem_at("where", "the function chose no control point", hint));
        }
        found = kept;
    }
    Ok(found)
}

fn number(index: u32) -> Value {
    Value::Number(f64::from(index) + 1.0)
}

fn move_points(call: &Call) -> Result<Value> {
    let (this, fields) = (call.this::<Cage>()?, call.read::<CageMoveFields>()?);
    let which = Which { points: &fields.points, near: fields.near, within: fields.within, test: fields.r#where };
    let points = select(call, &this, &which)?;
    let mut reader = Reader::default();
    let scale = match &fields.scale {
        Value::Nil => Some(Vec3::ONE),
        Value::Number(n) => Some(Vec3::splat(*n as f32)),
        other => reader.inside("scale", |r| Vec3::read(other, r)),
    };
    let mut asked: Option<Vec<Vec3>> = None;
    let by = match &fields.by {
        Value::Nil => Some(Vec3::ZERO),
        Value::Function(f) => {
            let ask = |&i: &u32| {
                let answer = call.script(Function(*f), &[Value::Vector(this.place(i as usize)), number(i)])?;
                if matches!(answer, Value::Nil) {
                    return Ok(Vec3::ZERO);
                }
                Vec3::read(&answer, &mut Reader::default()).ok_or_else(|| {
                    let hint = "it must return how far the point moves: a vector, or { x, y, z }".to_owned();
                    let message = format!("the function returned {} `{answer}`", answer.type_name());
                    call.problem_at("by", message, Some(hint))
                })
            };
            asked = Some(points.iter().map(ask).collect::<Result<_>>()?);
            Some(Vec3::ZERO)
        }
        other => reader.inside("by", |r| Vec3::read(other, r)),
    };
    let (Some(scale), Some(by)) = (scale, by) else { return Err(call.problems(reader.problems())) };
    let how = Move { by, scale, turn: Quat::from_axis_angle(fields.axis.0, fields.turn.radians), about: fields.about };
    let mut cage = Cage::clone(&this).moved(&points, &how).map_err(|e| failed(call, "", &e))?;
    for (i, by) in
        points.iter().zip(asked.into_iter().flatten()).filter(|(i, _)| this.kind(**i as usize) != PointKind::Fixed)
    {
        cage = cage.placed(&[*i], |_, p| p + by).map_err(|e| failed(call, "by", &e))?;
    }
    Ok(give(cage))
}

fn mark(call: &Call) -> Result<Value> {
    let (this, fields) = (call.this::<Cage>()?, call.read::<CageMarkFields>()?);
    let which = Which { points: &fields.points, near: fields.near, within: fields.within, test: fields.r#where };
    let points = select(call, &this, &which)?;
    Ok(give(Cage::clone(&this).marked(&points, fields.kind)))
}

fn hold(call: &Call) -> Result<Value> {
    let (this, fields) = (call.this::<Cage>()?, call.read::<CageHoldFields>()?);
    Cage::clone(&this).holding(&fields.points, fields.power).map(give).map_err(|e| failed(call, "", &e))
}

fn follow(call: &Call) -> Result<Value> {
    let (this, fields) = (call.this::<Cage>()?, call.read::<CageFollowFields>()?);
    Cage::clone(&this).followed(fields.power).map(give).map_err(|e| failed(call, "", &e))
}

fn place(call: &Call) -> Result<Value> {
    let (this, fields) = (call.this::<Cage>()?, call.read::<CagePlaceFields>()?);
    let index = one(call, &this, &fields.point)?;
    Ok(Value::Vector(this.place(index as usize)))
}
