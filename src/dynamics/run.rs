//! From strands to strands at rest, and to a clip.

use std::sync::Arc;

use glam::Affine3A;

use super::error::{DynamicsError, check_value};
use super::finish::{finish, frame};
use super::packet::unpack;
use super::pose::Poses;
use super::world::{Hair, Plan, World};
use crate::geometry::{Clip, Strands};
use crate::task::{Task, Warned, Warning};

crate::params! {
    /// Lets hair move under forces until it is at rest.
    pub struct SettleOptions("Strands:settle") {
        /// Simulated time after which it ends even if hair still moves.
        limit: f32 = 10.0, unit("s"), range(0.05, 600.0);
        /// The speed below which hair is at rest.
        rest_speed: f32 = 0.5, unit("cm/s"), range(0.001, 100.0);
    }
}

crate::params! {
    /// Lets hair move under forces, and keeps every frame.
    pub struct SimulateOptions("Strands:simulate") {
        /// How long; as long as the motion when left out, and 2 s without one.
        duration: Option<f32>, unit("s"), range(0.02, 3600.0);
        /// Frames in a second; as the motion when left out, and 24 without one.
        rate: Option<f32>, unit("1/s"), range(1.0, 240.0);
        /// True when the shape at first is the one that gravity leaves hair in: it moves only as wind and the head move
        /// it. With false it is the shape without weight, and hair first falls.
        balanced: bool = true;
        /// True when the last frame goes over into the first; as the motion when left out.
        r#loop: Option<bool>;
    }
}

impl SimulateOptions {
    fn rate(&self, motion: Option<&Clip<Affine3A>>) -> f32 {
        self.rate.or(motion.map(|m| m.rate)).unwrap_or(24.0)
    }

    fn duration(&self, motion: Option<&Clip<Affine3A>>) -> f32 {
        self.duration.or(motion.map(Clip::duration)).unwrap_or(2.0)
    }

    /// How many frames follow the first; with the motion that the head has.
    pub fn frames(&self, motion: Option<&Clip<Affine3A>>) -> usize {
        (self.duration(motion) * self.rate(motion)).round().max(1.0) as usize
    }
}

/// Most nodes in all frames of a clip.
const MOST_IN_FRAMES: u64 = 500_000_000;

/// What became of strands that were let settle.
#[derive(Clone, Debug, PartialEq)]
pub struct Settled {
    /// The strands.
    pub strands: Strands,
    /// Simulated time until they were at rest, s; none when they were not.
    pub rested: Option<f32>,
    /// Simulated time in all, s.
    pub time: f32,
    /// Steps in all.
    pub steps: usize,
    /// Strands that still moved at the end.
    pub moving: usize,
    /// The greatest speed of a node at the end, cm/s.
    pub speed: f32,
}

/// Steps between two looks at how fast hair is.
const LOOK: usize = 24;

/// Moves strands until they are at rest or the limit is reached; a warning tells of the latter.
///
/// # Errors
/// Numbers out of range, strands that cannot be moved, a step that would blow up, or the task was cancelled.
pub fn settle(hair: &Hair, options: &SettleOptions, task: &Task) -> Result<Warned<Settled>, DynamicsError> {
    check_value("the limit", options.limit, 0.0, 3600.0)?;
    check_value("the speed of rest", options.rest_speed, 1e-6, 1e6)?;
    let step = 1.0 / hair.options.steps;
    let poses = Poses::still();
    let plan = Plan {
        step,
        duration: options.limit,
        poses: &poses,
        is_loop: false,
        is_settling: true,
        drag: hair.options.drag.unwrap_or(2.0),
        is_balanced: false,
        is_loose: false,
    };
    let acting = hair.options.acting();
    let mut world = World::new(*hair, plan, &acting)?;
    let mut strands = hair.strands.clone();
    let way = options.rest_speed * LOOK as f32 * step;
    let mut moved = world.rest(0.0, &mut strands.points);
    while world.moving() > 0 && world.time() < options.limit {
        task.progress("settling", world.time() / options.limit);
        world.advance(LOOK, task)?;
        moved = world.rest(way, &mut strands.points);
    }
    task.progress("settling", 1.0);
    let (time, moving) = (world.time(), world.moving());
    let speed = moved / (LOOK as f32 * step);
    unpack(&world.packets, &hair.strands.offsets, &mut strands.points);
    let stuck = finish(hair, &mut strands, &Affine3A::IDENTITY);
    let mut warnings = stuck_warning(stuck, strands.count());
    if moving > 0 {
        let (count, limit) = (strands.count(), options.limit);
        let message =
            format!("hair still moved at up to `{speed:.1}` cm/s after {limit} s: {moving} of {count} strands");
        warnings
            .push(Warning::new(message).hint("raise `limit` or `drag`; a force that never balances keeps it moving"));
    }
    Ok(Warned {
        value: Settled { strands, rested: (moving == 0).then_some(time), time, steps: world.steps(), moving, speed },
        warnings,
    })
}

/// Moves strands for a time and keeps every frame, the first of which is the strands as they are. With a motion the
/// head moves, and what is in the frames moves with it.
///
/// # Errors
/// Numbers out of range, strands that cannot be moved, a step that would blow up, a motion of another rate, or the
/// task was cancelled.
pub fn simulate(
    hair: &Hair,
    options: &SimulateOptions,
    motion: Option<&Clip<Affine3A>>,
    task: &Task,
) -> Result<Warned<Clip<Strands>>, DynamicsError> {
    let rate = options.rate(motion);
    check_value("the rate", rate, 0.1, 10_000.0)?;
    if let Some(m) = motion.filter(|m| (m.rate - rate).abs() > 1e-3 * rate) {
        return Err(DynamicsError::Rate { motion: m.rate, clip: rate });
    }
    check_value("the duration", options.duration(motion), 0.0, 36_000.0)?;
    let is_loop = options.r#loop.unwrap_or_else(|| motion.is_some_and(|m| m.looped));
    let steps = options.frames(motion);
    let count = (steps as u64 + 1).saturating_mul(hair.strands.points.len() as u64);
    if count > MOST_IN_FRAMES {
        return Err(DynamicsError::TooMany { what: "nodes in all frames", count, limit: MOST_IN_FRAMES });
    }
    let poses = motion.map_or_else(|| Ok(Poses::still()), Poses::new)?;
    // Every frame falls on a step.
    let within = (hair.options.steps / rate).ceil().max(1.0) as usize;
    let plan = Plan {
        step: 1.0 / (rate * within as f32),
        duration: steps as f32 / rate,
        poses: &poses,
        is_loop,
        is_settling: false,
        drag: hair.options.drag.unwrap_or(3.0),
        is_balanced: options.balanced,
        is_loose: false,
    };
    let acting = hair.options.acting();
    let mut world = World::new(*hair, plan, &acting)?;
    let whole = if is_loop { 2 * steps } else { steps };
    let mut frames = vec![];
    let mut stuck = 0;
    for i in 0..=whole {
        task.progress("simulating", i as f32 / whole as f32);
        // A loop has run once before its frames are kept: it has forgotten how it began.
        if !is_loop || i >= steps {
            let (strands, out) = frame(hair, &world.packets, &poses.at(world.time()));
            stuck = stuck.max(out);
            frames.push(strands);
        }
        if i < whole {
            world.advance(within, task)?;
        }
    }
    if is_loop {
        close(hair, &mut frames, &poses, plan.duration, rate);
    }
    let frames = frames.into_iter().map(Arc::new).collect();
    Ok(Warned { value: Clip { rate, looped: is_loop, frames }, warnings: stuck_warning(stuck, hair.strands.count()) })
}

/// Closes a loop: its last frame, one too many, is where the first should be; the difference is spread over all.
fn close(hair: &Hair, frames: &mut Vec<Strands>, poses: &Poses, duration: f32, rate: f32) {
    let (Some(last), Some(first)) = (frames.pop(), frames.first()) else { return };
    let gap: Vec<_> = first.points.iter().zip(&last.points).map(|(a, b)| *a - *b).collect();
    let count = frames.len() as f32;
    for (i, strands) in frames.iter_mut().enumerate().skip(1) {
        let u = i as f32 / count;
        let weight = u * u * (3.0 - 2.0 * u);
        for (p, gap) in strands.points.iter_mut().zip(&gap) {
            *p += *gap * weight;
        }
        strands.roots.clone_from(&hair.strands.roots);
        finish(hair, strands, &poses.at(duration + i as f32 / rate));
    }
}

fn stuck_warning(stuck: usize, count: usize) -> Vec<Warning> {
    let message = format!("`{stuck}` of {count} strands could not be kept out of the head");
    if stuck == 0 { vec![] } else { vec![Warning::new(message).hint("do they begin outside of it?")] }
}
