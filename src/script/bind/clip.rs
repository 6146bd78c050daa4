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
use super::strands::{FillExtras, Lock, MaterialFields, fill_clip_strands, material_clip, natural_clip};
use super::tuft::Wig;
use crate::geometry::{Bounds, Clip, Ease, Strands};
use crate::groom::{DeformOptions, FillOptions, pass_through};
use crate::head::{Head, HeadMotion, MOST_FRAMES, MotionOptions};
use crate::math::Digest;
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
    /// Strands in motion; when they are guides at rest, they are so in motion, else their guides stay at rest.
    pub fn new(rest: Lock, strands: Clip<Strands>, motion: Option<Arc<HeadMotion>>, key: u128) -> Self {
        let guides = if Arc::ptr_eq(&rest.strands, &rest.guides) {
            strands.clone()
        } else {
            Clip { frames: vec![Arc::clone(&rest.guides); strands.count()], ..strands.clone() }
        };
        Self { rest, strands, guides, motion, key }
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

crate::params! {
    /// Strands on their way through poses: the same strands, styled in different ways. Strands bend from pose to pose and
    /// keep their length.
    pub struct ClipFields("coif.clip") {
        /// The poses, two or more: strands of the same roots with the same numbers of nodes. The first is the rest.
        poses: Vec<Arc<Lock>>, positional();
        /// Time from each pose to the next.
        seconds: f32 = 1.0, unit("s"), range(0.01, 3600.0);
        /// Frames in a second.
        rate: f32 = 24.0, unit("1/s"), range(1.0, 240.0);
        /// How each pose is left and come to.
        ease: Ease = Ease::Smooth;
        /// True to go back from the last pose to the first, over and over.
        r#loop: bool = false;
        /// Least distance of hair from the skin.
        margin: f32 = 0.05, unit("cm"), range(0.005, 10.0);
    }
}

/// `coif.clip`.
pub fn functions() -> Vec<Entry> {
    vec![Entry::table::<ClipFields>("coif.clip", "StrandsClip", clip)]
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
        Entry::table::<DeformOptions>("StrandsClip:natural", "StrandsClip", natural_clip).about(
            "Lays waves and curls over strands in motion, as `Strands:natural` over strands. Each domain acts at every \
             frame on the part of a strand that is inside its box at rest.",
        ),
        Entry::both::<FillOptions, FillExtras>("StrandsClip:fill", "StrandsClip", fill_clip_strands).about(
            "Fills the scalp with strands between guides in motion, as `Strands:fill` between guides. A strand follows \
             the same guides by the same parts at every frame.",
        ),
        Entry::positional::<MaterialFields>("StrandsClip:material", "StrandsClip", material_clip),
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

fn clip(call: &Call) -> Result<Value> {
    let fields: ClipFields = call.read()?;
    let [rest, others @ ..] = fields.poses.as_slice() else {
        return Err(
            call.problem("a clip without poses", Some("as in `coif.clip { still, blown, loop = true }`".into()))
        );
    };
    if others.is_empty() {
        let hint = "give at least two, as in `coif.clip { still, blown, loop = true }`".to_owned();
        return Err(call.problem("a clip of one pose does not move", Some(hint)));
    }
    for (i, pose) in others.iter().enumerate() {
        let path = format!("[{}]", i + 2);
        if !Arc::ptr_eq(&pose.area.head, &rest.area.head) {
            let hint = "make all of them from one head: `local head = coif.head()`".to_owned();
            return Err(call.problem_at(&path, "this pose is of another head", Some(hint)));
        }
        if pose.strands.offsets != rest.strands.offsets {
            let (a, b) = (&rest.strands, &pose.strands);
            let message = format!(
                "the first pose has {} strands of {} nodes in all, this one {} of {}",
                a.count(),
                a.points.len(),
                b.count(),
                b.points.len()
            );
            let hint = "style the same guides in different ways, with the same `length` and `step`".to_owned();
            return Err(call.problem_at(&path, message, Some(hint)));
        }
    }
    let poses: Vec<Arc<Strands>> = fields.poses.iter().map(|p| Arc::clone(&p.strands)).collect();
    let legs = if fields.r#loop { poses.len() } else { others.len() };
    let steps = legs as f32 * fields.seconds * fields.rate;
    let count = if fields.r#loop { steps.round() as usize } else { (steps + 1e-3).floor() as usize + 1 };
    if !(2..=MOST_FRAMES).contains(&count) {
        let hint = format!("a clip has 2 to {MOST_FRAMES} frames: change `seconds` or `rate`");
        return Err(call.problem_at("seconds", format!("that makes `{count}` frames"), Some(hint)));
    }
    let way = |i: usize| {
        let at = if fields.r#loop {
            legs as f32 * i as f32 / count as f32
        } else {
            i as f32 / (fields.seconds * fields.rate)
        };
        let leg = (at as usize).min(legs - 1);
        (leg, (leg + 1) % poses.len(), fields.ease.at((at - leg as f32).clamp(0.0, 1.0)))
    };
    let ways: Vec<(usize, usize, f32)> = (0..count).map(way).collect();
    let mut key = Digest::new("clip 1");
    key.key(rest.area.head.key()).data(&ways).floats(&[fields.rate, fields.margin]);
    for pose in &poses {
        key.key(call.session.options.memo.content(pose));
    }
    let solid = Some((&*rest.area.head.solid, fields.margin));
    let frames = pass_through(&poses, &ways, solid, call.task()).map_err(|e| call.groom(&e))?;
    let clip = Clip { rate: fields.rate, looped: fields.r#loop, frames };
    let rest = Lock { source: call.source(), ..Lock::clone(rest) };
    Ok(give(MovingStrands::new(rest, clip, None, key.finish())))
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
