//! Strands that fall, blow and come to rest.

use std::sync::Arc;

use super::super::call::{Call, Result};
use super::super::limits::Need;
use super::super::memo::Kept;
use super::super::registry::Entry;
use super::super::session::{Raised, Rest};
use super::clip::MovingStrands;
use super::force::Place;
use super::head::give;
use super::overlay;
use super::strands::Lock;
use crate::dynamics::{
    Body, DynamicsError, Hair, HairOptions, SettleOptions, SimulateOptions, Skin, Zone, settle, simulate,
};
use crate::geometry::{Clip, Strands};
use crate::groom::Moving;
use crate::head::{Head, HeadMotion};
use crate::math::Digest;
use crate::params::Value;
use crate::scene::Overlay;
use crate::task::Warned;

crate::params! {
    /// What is held.
    pub struct PinFields("Strands:settle") {
        /// Hair that lies in any of these at first is pinned to the head: a tie, a clasp.
        pinned: Vec<Place> = vec![];
    }
}

crate::params! {
    /// What is held, and what the head does.
    pub struct MotionFields("Strands:simulate") {
        /// Hair that lies in any of these at first is pinned to the head: a tie, a clasp.
        pinned: Vec<Place> = vec![];
        /// What the head does meanwhile: `head:motion { ... }`.
        motion: Option<Arc<HeadMotion>>;
    }
}

/// `Strands:settle`, `Strands:simulate`, which stand with the other methods of strands.
pub fn methods() -> Vec<Entry> {
    vec![
        Entry::both::<SettleOptions, (HairOptions, PinFields)>("Strands:settle", "Strands", settle_strands),
        Entry::both::<SimulateOptions, (HairOptions, MotionFields)>(
            "Strands:simulate",
            "StrandsClip",
            simulate_strands,
        ),
    ]
}

impl Kept for Rest {
    fn bytes(&self) -> usize {
        size_of::<Self>()
    }
}

impl Kept for Skin {
    fn bytes(&self) -> usize {
        Self::bytes(self)
    }
}

/// What is moved: the strands, and the guides that they follow when these are others.
fn parts(lock: &Lock) -> Vec<&Arc<Strands>> {
    if Arc::ptr_eq(&lock.strands, &lock.guides) { vec![&lock.strands] } else { vec![&lock.strands, &lock.guides] }
}

/// The grid of distances to a head, kept from run to run.
pub fn skin(call: &Call, head: &Head) -> Result<Arc<Skin>> {
    let mut key = Digest::new("skin 1");
    key.key(head.key());
    call.memo(&key, || Ok(Warned { value: Skin::new(&head.solid), warnings: vec![] }))
}

/// What both methods were called with besides their own options.
struct Moved {
    options: HairOptions,
    pinned: Vec<Zone>,
    skin: Option<Arc<Skin>>,
}

impl Moved {
    fn new(call: &Call, lock: &Lock, mut options: HairOptions, pinned: &[Place]) -> Result<Self> {
        options.seed = call.seed(options.seed);
        let skin = if options.collide { Some(skin(call, &lock.area.head)?) } else { None };
        Ok(Self { options, pinned: pinned.iter().map(|p| p.0).collect(), skin })
    }

    fn hair<'a>(&'a self, lock: &'a Lock, strands: &'a Strands) -> Hair<'a> {
        let body = self.skin.as_deref().map(|skin| Body { solid: &lock.area.head.solid, skin });
        Hair { strands, options: &self.options, pinned: &self.pinned, body }
    }

    fn digest(&self, call: &Call, lock: &Lock, strands: &Arc<Strands>, key: &mut Digest) {
        key.key(lock.area.head.key()).key(call.session.options.memo.content(strands));
        key.data(&self.options).data(&self.pinned);
    }

    fn overlay(&self, lock: &Lock) -> Arc<Overlay> {
        let mut out = Overlay::clone(&lock.overlay);
        out.extend(&overlay::forces(&self.options.acting(), &self.pinned));
        Arc::new(out)
    }
}

fn problem(call: &Call, error: &DynamicsError) -> Raised {
    call.problem(error.to_string(), error.hint())
}

fn settle_strands(call: &Call) -> Result<Value> {
    let this = call.this::<Lock>()?;
    let (own, (options, pins)) = call.read_both::<SettleOptions, (HairOptions, PinFields)>()?;
    let moved = Moved::new(call, &this, options, &pins.pinned)?;
    let mut out = vec![];
    for strands in parts(&this) {
        let points = strands.points.len() as u64;
        call.claim("", Need { points, ..Need::strands(strands.count(), 0) })?;
        let mut key = Digest::new("settle 2");
        key.data(&own);
        moved.digest(call, &this, strands, &mut key);
        let mut rest = Rest { source: String::new(), strands: strands.count(), moving: 0, seconds: 0.0, steps: 0 };
        let make = || match settle(&moved.hair(&this, strands), &own, call.task()) {
            Ok(Warned { value, warnings }) => {
                (rest.moving, rest.seconds, rest.steps) = (value.moving, value.time, value.steps);
                Ok(Warned { value: value.strands, warnings })
            }
            Err(e) => Err(problem(call, &e)),
        };
        out.push(call.memo_strands(&key, &strands.sources, make)?);
        // Kept beside the strands, so that a run that finds these still tells how they came to rest.
        let mut told = Digest::new("settle rest 1");
        told.key(key.finish());
        let kept = call.memo(&told, || Ok(Warned { value: rest, warnings: vec![] }))?;
        // Without steps nothing is known: the memo had kept the strands only.
        if kept.steps > 0 {
            let source = call.source().to_string();
            call.session.rests.borrow_mut().push(Rest { source, ..Rest::clone(&kept) });
        }
    }
    let strands = Arc::clone(&out[0]);
    let guides = Arc::clone(&out[out.len() - 1]);
    Ok(give(Lock { strands, guides, overlay: moved.overlay(&this), ..Lock::clone(&this) }))
}

fn simulate_strands(call: &Call) -> Result<Value> {
    let this = call.this::<Lock>()?;
    let (own, (options, more)) = call.read_both::<SimulateOptions, (HairOptions, MotionFields)>()?;
    let moved = Moved::new(call, &this, options, &more.pinned)?;
    let motion = more.motion.as_ref().map(|m| &m.clip);
    let count = own.frames(motion) as u64 + 1;
    let mut keys = Digest::new("simulate 1");
    let mut out: Vec<Clip<Strands>> = vec![];
    for strands in parts(&this) {
        let once = Need { points: strands.points.len() as u64, ..Need::strands(strands.count(), 0) };
        call.claim("", once.times(count))?;
        let mut key = Digest::new("simulate 1");
        key.data(&own).data(&motion);
        moved.digest(call, &this, strands, &mut key);
        let make = || match simulate(&moved.hair(&this, strands), &own, motion, call.task()) {
            Ok(Warned { value, warnings }) => {
                Ok(Warned { value: Moving { rest: Strands::clone(strands), frames: value }, warnings })
            }
            Err(e) => Err(problem(call, &e)),
        };
        out.push(call.memo_moving(&key, &strands.sources, make)?.frames.clone());
        keys.key(key.finish());
    }
    let guides = out[out.len() - 1].clone();
    let rest = Lock { overlay: moved.overlay(&this), source: call.source(), ..Lock::clone(&this) };
    Ok(give(MovingStrands { rest, strands: out.swap_remove(0), guides, motion: more.motion, key: keys.finish() }))
}
