//! Deformation: what lattices, cages, pins and warps do to hair, heads and clips.

use std::sync::Arc;

use glam::Vec3;

use super::super::call::{Call, Result};
use super::super::registry::Entry;
use super::carry::{CarryFields, carry_moving_locks, carry_moving_strands, carry_piece, carry_strands, carry_tufts};
use super::clip::{MovingLocks, MovingStrands};
use super::head::give;
use super::lattice::failed;
use super::overlay;
use super::piece::Piece;
use super::strands::Lock;
use super::tuft::{Wig, settled as settled_tufts, tuft_error};
use crate::deform::{self, Bend, Cage, DeformError, Deformer, Folded, Hold, Lattice, Lift, Pins, Taper, Warp};
use crate::geometry::Strands;
use crate::groom::{Body, keep_out};
use crate::head::Head;
use crate::math::Digest;
use crate::params::{FieldType, Function, Kind, Object, Params, Reader, Value};
use crate::scene::Overlay;
use crate::task::{Warned, Warning};
use crate::tuft::{Stroke, Tuft, Tufts};

crate::params! {
    /// Moves it by lattices, cages, pins and warps, one after the other.
    pub struct DeformFields("deform") {
        /// Lattices, cages, pins and warps, in the order they act.
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

/// Anything that deforms.
#[derive(Clone, Debug)]
pub struct By(pub Deformer);

impl FieldType for By {
    fn kind() -> Kind {
        Kind::OneOf([Lattice::NAME, Cage::NAME, Pins::NAME, Warp::NAME].map(Kind::Object).to_vec())
    }
    fn read(value: &Value, reader: &mut Reader) -> Option<Self> {
        if let Value::Handle(h) = value {
            if let Some(lattice) = h.get::<Lattice>() {
                return Some(Self(Deformer::Lattice(lattice)));
            }
            if let Some(cage) = h.get::<Cage>() {
                return Some(Self(Deformer::Cage(cage)));
            }
            if let Some(pins) = h.get::<Pins>() {
                return Some(Self(Deformer::Pins(pins)));
            }
            if let Some(warp) = h.get::<Warp>() {
                return Some(Self(Deformer::Warp(warp)));
            }
        }
        reader.wrong_type("a Lattice, a Cage, Pins or a Warp", value)
    }
}

/// A method that deforms: what it does to the points of a value.
pub trait Verb: Params {
    /// The deformers, one after the other; lattices of verbs are made around `points`.
    ///
    /// # Errors
    /// What no lattice can be made of.
    fn deformers(&self, points: &[Vec3]) -> std::result::Result<Vec<Deformer>, DeformError>;

    /// True when the script has moved their control points itself, so that it wants to know when they fold.
    fn is_by_hand(&self) -> bool {
        false
    }
}

impl Verb for DeformFields {
    fn deformers(&self, _: &[Vec3]) -> std::result::Result<Vec<Deformer>, DeformError> {
        Ok(self.by.iter().map(|b| b.0.clone()).collect())
    }

    fn is_by_hand(&self) -> bool {
        true
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
        Entry::table::<CarryFields>("StrandsClip:carry", "StrandsClip", carry_moving_strands),
    ]
}

/// The methods of stylised hair in motion.
pub fn moving_locks_methods() -> Vec<Entry> {
    vec![
        Entry::table::<DeformFields>("LocksClip:deform", "LocksClip", moving_locks::<DeformFields>),
        Entry::table::<Bend>("LocksClip:bend", "LocksClip", moving_locks::<Bend>),
        Entry::table::<Taper>("LocksClip:taper", "LocksClip", moving_locks::<Taper>),
        Entry::table::<Lift>("LocksClip:lift", "LocksClip", moving_locks::<Lift>),
        Entry::table::<CarryFields>("LocksClip:carry", "LocksClip", carry_moving_locks),
    ]
}

/// The deformers of a call on a value with these points.
pub fn deformers<V: Verb>(call: &Call, verb: &V, points: &[Vec3]) -> Result<Vec<Deformer>> {
    let by = verb.deformers(points).map_err(|e| failed(call, "", &e))?;
    if verb.is_by_hand() {
        for (i, one) in by.iter().enumerate() {
            folded(call, (by.len() > 1).then_some(i + 1), one);
        }
        // Later ones act on what the first has moved.
        if let Some(Deformer::Cage(cage)) = by.first() {
            torn(call, cage, points);
        }
    }
    Ok(by)
}

/// Warns of what folds over itself; `number` tells several deformers apart.
fn folded(call: &Call, number: Option<usize>, by: &Deformer) {
    let of = |what: &str, found: Folded| {
        let what = number.map_or_else(|| format!("the {what}"), |n| format!("number {n}, a {what},"));
        let Vec3 { x, y, z } = found.place;
        format!("{what} folds over itself near ({x:.1}, {y:.1}, {z:.1}), at {}", found.points.join(", "))
    };
    let message = match by {
        Deformer::Lattice(lattice) => lattice.folded().map(|f| of("lattice", f)),
        Deformer::Cage(cage) => cage.folded().map(|f| of("cage", f)),
        Deformer::Pins(_) | Deformer::Warp(_) => None,
    };
    if let Some(message) = message {
        let hint = "what is there turns inside out: move the point less far, or its neighbours with it";
        call.warn("", Warning::new(message).hint(hint));
    }
}

/// Warns of what a cage leaves behind.
fn torn(call: &Call, cage: &Cage, points: &[Vec3]) {
    let count = cage.left_behind(points);
    if count > 0 {
        let message =
            format!("{count} of {} points lie just outside of the cage where it moves, and stay behind", points.len());
        call.warn("", Warning::new(message).hint("make the cage larger, as with `margin = 3`"));
    }
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
            Deformer::Cage(cage) => all.extend(&overlay::cage(cage)),
            Deformer::Pins(pins) => all.extend(&overlay::pins(pins)),
            Deformer::Warp(warp) => all.extend(&overlay::warp(warp)),
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
