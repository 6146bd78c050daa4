//! What moves: strands and stylised hair over time, and motions of the head.
//!
//! A script counts frames from 1, the core from 0.

use std::sync::Arc;

use glam::{Affine3A, Vec3};
use rayon::prelude::*;

use super::super::call::{Call, Result};
use super::super::registry::{Entry, Getter, Noun};
use super::head::give;
use super::piece::Piece;
use super::strands::Lock;
use super::tuft::Wig;
use crate::geometry::{Bounds, Clip, Strands};
use crate::head::{Head, HeadMotion, MotionOptions};
use crate::params::{Handle, Object, Table, Value};
use crate::scene::Locks;

/// Strands in motion, on their head.
#[derive(Clone, Debug)]
pub struct MovingStrands {
    /// At rest, with the head, the look and everything else that does not move.
    pub rest: Lock,
    /// The strands at each frame, of the topology that they have at rest.
    pub strands: Clip<Strands>,
    /// The guides that they follow, at each frame; the strands again when these are the guides.
    pub guides: Clip<Strands>,
    /// What the head did meanwhile, when that is in the frames; none when they are as seen from the head.
    pub motion: Option<Arc<HeadMotion>>,
    /// Key of everything that the frames came from.
    pub key: u128,
}

impl Object for MovingStrands {
    const NAME: &'static str = "StrandsClip";
}

impl MovingStrands {
    /// Guides, or strands that follow none, in motion.
    pub fn new(rest: Lock, strands: Clip<Strands>, motion: Option<Arc<HeadMotion>>, key: u128) -> Self {
        Self { rest, guides: strands.clone(), strands, motion, key }
    }
}

/// Stylised hair at rest.
#[derive(Clone, Debug)]
pub enum StillLocks {
    /// Tufts.
    Tufts(Wig),
    /// A cap, a bun or a ring.
    Piece(Arc<Piece>),
}

impl StillLocks {
    /// The head it is on.
    pub fn head(&self) -> &Arc<Head> {
        match self {
            Self::Tufts(wig) => &wig.head,
            Self::Piece(piece) => &piece.head,
        }
    }

    /// As it stands in a scene.
    pub fn locks(&self) -> Locks {
        match self {
            Self::Tufts(wig) => Locks::tufts(Arc::clone(&wig.tufts), wig.palette.clone()),
            Self::Piece(piece) => Locks::piece(piece.kind, (*piece.mesh).clone(), piece.material.clone()),
        }
    }
}

/// Stylised hair in motion.
#[derive(Clone, Debug)]
pub struct MovingLocks {
    /// At rest.
    pub rest: StillLocks,
    /// Every vertex of its mesh at each frame, cm; the mesh is that of [`StillLocks::locks`].
    pub surface: Clip<Vec<Vec3>>,
    /// What the head did meanwhile, when that is in the frames; none when they are as seen from the head.
    pub motion: Option<Arc<HeadMotion>>,
    /// Place in the script that made it.
    pub source: Arc<str>,
}

impl Object for MovingLocks {
    const NAME: &'static str = "LocksClip";
}

crate::params! {
    /// The strands of one frame.
    pub struct FrameFields("StrandsClip:frame") {
        /// Which frame, from 1; past the end a loop begins anew, anything else stands still.
        frame: usize, range(1.0, 1e9);
    }
}

crate::params! {
    /// Where a place of the head at rest is at a frame.
    pub struct PlaceFields("Motion:place") {
        /// The place at rest.
        point: Vec3, unit("cm");
        /// Which frame, from 1; past the end a loop begins anew, anything else stands still.
        frame: usize, range(1.0, 1e9);
    }
}

/// `Head:motion`, which stands with the head's other methods.
pub fn head_methods() -> Vec<Entry> {
    vec![Entry::table::<MotionOptions>("Head:motion", "Motion", motion)]
}

/// How many frames, how fast, how long.
macro_rules! time {
    ($ty:ty, $clip:ident) => {
        [
            Getter {
                name: "frames",
                doc: "How many frames.",
                returns: "number",
                get: |h| h.get::<$ty>().map_or(Value::Nil, |m| Value::Number(m.$clip.count() as f64)),
            },
            Getter {
                name: "rate",
                doc: "Frames in a second.",
                returns: "number",
                get: |h| h.get::<$ty>().map_or(Value::Nil, |m| number(m.$clip.rate)),
            },
            Getter {
                name: "seconds",
                doc: "How long it lasts.",
                returns: "number",
                get: |h| h.get::<$ty>().map_or(Value::Nil, |m| number(m.$clip.duration())),
            },
            Getter {
                name: "loops",
                doc: "True when the first frame follows the last.",
                returns: "boolean",
                get: |h| h.get::<$ty>().map_or(Value::Nil, |m| Value::Bool(m.$clip.looped)),
            },
        ]
    };
}

/// Strands in motion, stylised hair in motion, motions of the head.
pub fn nouns() -> Vec<Noun> {
    let mut methods = vec![
        Entry::positional::<FrameFields>("StrandsClip:frame", "Strands", frame),
        Entry::plain(
            "StrandsClip:stats",
            "Figures: `frames`, `seconds`, `strands`, `points`, `guides`, `travel` (cm, the farthest that a node comes \
             from where it is in the first frame), `stretch` (the greatest part by which a strand's length differs from \
             that in the first frame), `min` and `max` (corners of the bounding box of all frames).",
            "table",
            stats,
        )
        .sealed("the table of figures"),
    ];
    methods.extend(super::deform::moving_strands_methods());
    let mut getters = vec![Getter {
        name: "count",
        doc: "How many strands.",
        returns: "number",
        get: |h| h.get::<MovingStrands>().map_or(Value::Nil, |m| Value::Number(m.rest.strands.count() as f64)),
    }];
    getters.extend(time!(MovingStrands, strands));
    let doc = "Strands in motion: frames at equal distances in time. What takes strands takes them frame by frame.";
    let strands = Noun::of::<MovingStrands>(doc, methods, getters, |h| {
        h.get::<MovingStrands>()
            .map_or_else(String::new, |m| format!("{} frames of {} strands", m.strands.count(), m.rest.strands.count()))
    });
    let doc = "Stylised hair in motion: frames of its surface at equal distances in time.";
    let locks =
        Noun::of::<MovingLocks>(doc, super::deform::moving_locks_methods(), time!(MovingLocks, surface).into(), |h| {
            h.get::<MovingLocks>()
                .map_or_else(String::new, |m| format!("{} frames of stylised hair", m.surface.count()))
        });
    let methods = vec![Entry::positional::<PlaceFields>("Motion:place", "vector", place)];
    let motion = Noun::of::<HeadMotion>(
        "A motion of the head; made by `Head:motion`.",
        methods,
        time!(HeadMotion, clip).into(),
        |h: &Handle| h.get::<HeadMotion>().map_or_else(String::new, |m| format!("{} frames of a head", m.clip.count())),
    );
    vec![strands, locks, motion]
}

/// The number that a person would write.
fn number(n: f32) -> Value {
    Value::Number(n.to_string().parse().unwrap_or_else(|_| f64::from(n)))
}

fn motion(call: &Call) -> Result<Value> {
    let (head, options) = (call.this::<Head>()?, call.read::<MotionOptions>()?);
    Ok(give(HeadMotion::new(&head, &options).map_err(|e| call.problem(e.to_string(), e.hint()))?))
}

fn place(call: &Call) -> Result<Value> {
    let (this, fields) = (call.this::<HeadMotion>()?, call.read::<PlaceFields>()?);
    let at = this.clip.at(fields.frame - 1).map_or(Affine3A::IDENTITY, |t| **t);
    Ok(Value::Vector(at.transform_point3(fields.point)))
}

fn frame(call: &Call) -> Result<Value> {
    let (this, fields) = (call.this::<MovingStrands>()?, call.read::<FrameFields>()?);
    let at = |clip: &Clip<Strands>, still: &Arc<Strands>| Arc::clone(clip.at(fields.frame - 1).unwrap_or(still));
    let (strands, guides) = (at(&this.strands, &this.rest.strands), at(&this.guides, &this.rest.guides));
    Ok(give(Lock { strands, guides, ..this.rest.clone() }))
}

fn stats(call: &Call) -> Result<Value> {
    let this = call.this::<MovingStrands>()?;
    let (clip, first) = (&this.strands, this.strands.at(0).unwrap_or(&this.rest.strands));
    let lengths: Vec<f32> = (0..first.count()).into_par_iter().map(|i| first.length(i)).collect();
    let (mut bounds, mut travel, mut stretch) = (Bounds::EMPTY, 0.0_f32, 0.0_f32);
    for frame in &clip.frames {
        bounds = bounds.union(frame.bounds());
        let ways = frame.points.par_iter().zip(&first.points).map(|(a, b)| a.distance(*b));
        travel = travel.max(ways.reduce(|| 0.0, f32::max));
        let parts = lengths.par_iter().enumerate().map(|(i, l)| (frame.length(i) / l.max(1e-6) - 1.0).abs());
        stretch = stretch.max(parts.reduce(|| 0.0, f32::max));
    }
    let count = |n: usize| Value::Number(n as f64);
    let fields = [
        ("frames", count(clip.count())),
        ("seconds", number(clip.duration())),
        ("strands", count(first.count())),
        ("points", count(first.points.len())),
        ("guides", count(this.rest.guides.count())),
        ("travel", number(travel)),
        ("stretch", number(stretch)),
        ("min", Value::Vector(bounds.min)),
        ("max", Value::Vector(bounds.max)),
    ];
    let fields = fields.into_iter().map(|(k, v)| (k.to_owned(), v)).collect();
    Ok(Value::Table(Table { fields, ..Table::default() }))
}
