//! Strands, forces and a head, ready to be moved step by step.

use std::sync::Arc;

use glam::{Affine3A, Vec3};
use rayon::prelude::*;

use super::acting::Forces;
use super::bend;
use super::error::DynamicsError;
use super::force::{Field, Force, Zone};
use super::lanes::LANES;
use super::options::HairOptions;
use super::packet::{Making, NONE, Packet, check_segments, pack, regroup};
use super::pose::Poses;
use super::repel::Repulsion;
use super::skin::Skin;
use super::step::{Moment, Rules, Scratch, advance};
use crate::geometry::{Solid, Strands};
use crate::math::trig;
use crate::task::Task;

/// A head to keep out of: the mesh, and its distances on a grid.
#[derive(Clone, Copy, Debug)]
pub struct Body<'a> {
    /// The mesh, for finished frames.
    pub solid: &'a Solid,
    /// Its grid, for the way to them.
    pub skin: &'a Skin,
}

/// What is moved, and how.
#[derive(Clone, Copy, Debug)]
pub struct Hair<'a> {
    /// The strands at first, seen from the head.
    pub strands: &'a Strands,
    /// How they move.
    pub options: &'a HairOptions,
    /// Nodes that lie in any of these at first are pinned to the head.
    pub pinned: &'a [Zone],
    /// The head to keep out of, if there is one.
    pub body: Option<Body<'a>>,
}

/// Most nodes in one call.
pub const MOST_NODES: u64 = 50_000_000;

/// How long and in which way hair is moved.
#[derive(Clone, Copy, Debug)]
pub struct Plan<'a> {
    /// Length of a step, s.
    pub step: f32,
    /// Duration of the whole, s.
    pub duration: f32,
    /// The head's motion.
    pub poses: &'a Poses,
    /// Whether the whole is a loop.
    pub is_loop: bool,
    /// Whether it is to come to rest: forces act evenly.
    pub is_settling: bool,
    /// What the air takes of the velocity in a second.
    pub drag: f32,
    /// Whether the shape at first is at rest under gravity.
    pub is_balanced: bool,
    /// Whether no node is pinned: for tests of free particles.
    pub is_loose: bool,
}

/// Strands in motion.
pub struct World<'a> {
    /// The strands.
    pub packets: Vec<Packet>,
    hair: Hair<'a>,
    plan: Plan<'a>,
    acting: &'a [Arc<Force>],
    forces: Forces<'a>,
    rules: Rules<'a>,
    repulsion: Option<Repulsion>,
    corners: Vec<Vec3>,
    done: usize,
}

/// While hair settles: least time between two stops of a strand, s.
const SWING: f32 = 0.1;

/// Steps after which crowding is looked at again.
const REFRESH: usize = 4;

impl<'a> World<'a> {
    /// Checks everything and makes it ready. `acting` are the forces of the hair's options.
    ///
    /// # Errors
    /// Numbers out of range, strands that cannot be moved, or a step that would blow up.
    pub fn new(hair: Hair<'a>, plan: Plan<'a>, acting: &'a [Arc<Force>]) -> Result<Self, DynamicsError> {
        let (strands, options) = (hair.strands, hair.options);
        options.check()?;
        strands.validate()?;
        if strands.count() == 0 {
            return Err(DynamicsError::Nothing);
        }
        let nodes = strands.points.len() as u64;
        if nodes > MOST_NODES {
            return Err(DynamicsError::TooMany { what: "nodes", count: nodes, limit: MOST_NODES });
        }
        check_segments(strands)?;
        let world = Self::made(hair, plan, acting);
        world.check()?;
        Ok(world)
    }

    fn made(hair: Hair<'a>, plan: Plan<'a>, acting: &'a [Arc<Force>]) -> Self {
        let (strands, options) = (hair.strands, hair.options);
        let pose = plan.poses.at(0.0);
        let gravity = |f: &Arc<Force>| match &f.field {
            Field::Gravity(o) if plan.is_balanced => o.direction.0 * (o.strength * f.factor(0.0)),
            _ => Vec3::ZERO,
        };
        let load: Vec3 = acting.iter().map(gravity).sum();
        let making = Making {
            pinned: hair.pinned,
            clamped: options.clamped,
            stiffness: options.stiffness(),
            load: pose.inverse().transform_vector3(load),
            step: plan.step,
            margin: options.margin,
            repels: options.repulsion > 0.0,
            pose,
            loose: plan.is_loose,
        };
        let forces: Vec<&Force> = acting.iter().map(Arc::as_ref).collect();
        let roots = strands.roots.iter().map(|r| r.position);
        let bounds = hair.body.map_or_else(|| crate::geometry::Bounds::of(roots), |b| b.solid.bounds());
        let corner = |i: usize| {
            let pick = |bit: usize, lo: f32, hi: f32| if i >> bit & 1 == 1 { hi } else { lo };
            Vec3::new(
                pick(0, bounds.min.x, bounds.max.x),
                pick(1, bounds.min.y, bounds.max.y),
                pick(2, bounds.min.z, bounds.max.z),
            )
        };
        Self {
            packets: pack(strands, &making),
            hair,
            plan,
            acting,
            forces: Forces::new(&forces, plan.duration, reach(strands), options.seed, plan.is_loop),
            rules: Rules {
                h: plan.step,
                kept: trig::exp(-plan.drag * plan.step),
                iterations: options.iterations,
                lengths: options.lengths,
                solver: options.solver,
                skin: hair.body.filter(|_| options.collide).map(|b| b.skin),
                friction: options.friction,
                stops: plan.is_settling.then(|| (SWING / plan.step).round() as usize),
            },
            repulsion: (options.repulsion > 0.0).then(|| Repulsion::new(options.repulsion, options.spacing)),
            corners: (0..8).map(corner).collect(),
            done: 0,
        }
    }

    /// Refuses what would blow up.
    fn check(&self) -> Result<(), DynamicsError> {
        let (options, h) = (self.hair.options, self.plan.step);
        let steps = 1.0 / h;
        // A step's length, for messages: as the script writes it, or shorter.
        let raised = |needed: f32| (needed * 1.02 / 10.0).ceil() * 10.0;
        let all: f32 = self.acting.iter().map(|f| f.gradient()).sum();
        if !(all * h * h <= 1.0) {
            let (i, force) = (self.acting.iter().enumerate())
                .max_by(|a, b| a.1.gradient().total_cmp(&b.1.gradient()))
                .ok_or(DynamicsError::Nothing)?;
            return Err(DynamicsError::Stiff {
                force: force.label(i),
                steps: steps.round(),
                needed: raised(all.sqrt()),
            });
        }
        let strands = self.hair.strands;
        let mean = |i: usize| strands.length(i) / (strands.range(i).len() - 1) as f32;
        let segment = (0..strands.count()).into_par_iter().map(mean).reduce(|| f32::MAX, f32::min);
        let reach = reach(strands);
        let acceleration = self.acting.iter().map(|f| f.greatest(reach)).sum::<f32>() + 2.0 * options.repulsion;
        let way = acceleration * h * h;
        if !(way <= segment) {
            let needed = raised((acceleration / segment).sqrt());
            return Err(DynamicsError::Fast { acceleration, way, segment, needed });
        }
        let stiffness = options.stiffness();
        let most = bend::MOST * segment * segment * segment * segment / (h * h);
        if !(stiffness <= most) {
            let most = (most * 0.8 / super::options::EARTH).cbrt();
            let steps = steps.round();
            return Err(DynamicsError::Hold { hold: options.hold, segment, steps, most: (most * 10.0).floor() / 10.0 });
        }
        let count = (self.plan.duration / h).round() as usize;
        let (mut way, mut pose) = (0.0_f32, self.plan.poses.at(0.0));
        if !self.plan.is_settling {
            for i in 1..=count {
                let next = self.plan.poses.at(i as f32 * h);
                way = way.max(self.way(&pose, &next));
                pose = next;
            }
        }
        if !(way <= 2.0 * segment) {
            return Err(DynamicsError::Head { way, segment, needed: raised(steps * way / (2.0 * segment)) });
        }
        Ok(())
    }

    /// The farthest that any place of the head moves between two poses.
    fn way(&self, from: &Affine3A, to: &Affine3A) -> f32 {
        let ways = self.corners.iter().map(|&c| to.transform_point3(c).distance(from.transform_point3(c)));
        ways.fold(0.0, f32::max)
    }

    /// The time of the next step's beginning, s.
    pub fn time(&self) -> f32 {
        // Counted, not added up: the last bits of a sum depend on its length.
        self.done as f32 * self.plan.step
    }

    /// Goes on by `steps` steps.
    ///
    /// # Errors
    /// Cancelled, or hair that repels has spread too far for its grid.
    pub fn advance(&mut self, steps: usize, task: &Task) -> Result<(), DynamicsError> {
        let mut left = steps;
        while left > 0 {
            let some = if self.repulsion.is_some() { left.min(REFRESH - self.done % REFRESH) } else { left };
            if let Some(repulsion) = &mut self.repulsion
                && self.done.is_multiple_of(REFRESH)
            {
                repulsion.push(&mut self.packets)?;
            }
            self.go(some, task)?;
            left -= some;
        }
        Ok(())
    }

    fn go(&mut self, steps: usize, task: &Task) -> Result<(), DynamicsError> {
        let looped = self.plan.is_loop.then_some(self.plan.duration);
        let h = self.plan.step;
        let (poses, forces) = (self.plan.poses, &self.forces);
        let mut moments = Vec::with_capacity(steps);
        let mut from = poses.at(self.time());
        for i in self.done..self.done + steps {
            let to = poses.at((i + 1) as f32 * h);
            moments.push(Moment {
                forces: forces.at(i as f32 * h, &from, looped, self.plan.is_settling),
                carry: to * from.inverse(),
                to,
                back: to.inverse(),
                way: if from == to { 0.0 } else { self.way(&from, &to) * 1.8 },
                is_first: i == 0,
            });
            from = to;
        }
        // Few packets at a time, so that all threads end together.
        self.packets.par_iter_mut().with_max_len(8).for_each_init(Scratch::default, |scratch, packet| {
            if !task.is_cancelled() {
                advance(packet, &moments, &self.rules, scratch);
            }
        });
        task.check()?;
        self.done += steps;
        Ok(())
    }

    /// Looks for strands at rest, see [`Packet::look`]. They are laid into `points` as they are and move no more; but while
    /// hair repels all of it has to be at rest together. Gives the greatest way of any strand since it was marked.
    pub fn rest(&mut self, way: f32, points: &mut [Vec3]) -> f32 {
        let moved = self.packets.par_iter_mut().map(|packet| packet.look(way)).reduce(|| 0.0, f32::max);
        let is_calm = |p: &Packet, l: usize| p.rests[l];
        let all = || self.packets.iter().all(|p| p.each_strand().all(|(l, ..)| is_calm(p, l)));
        if self.repulsion.is_some() && !all() {
            return moved;
        }
        let offsets = &self.hair.strands.offsets;
        for packet in &mut self.packets {
            for l in 0..LANES {
                if packet.strands[l] != NONE && is_calm(packet, l) {
                    let start = offsets[packet.strands[l] as usize] as usize;
                    for k in 0..packet.counts[l] {
                        points[start + k] = packet.at.get(k, l);
                    }
                    packet.strands[l] = NONE;
                }
            }
        }
        regroup(&mut self.packets);
        moved
    }

    /// How many steps are done.
    pub fn steps(&self) -> usize {
        self.done
    }

    /// How many strands still move.
    pub fn moving(&self) -> usize {
        self.packets.iter().map(|p| p.each_strand().count()).sum()
    }
}

/// The greatest distance from the head's middle that hair can reach, cm.
fn reach(strands: &Strands) -> f32 {
    let one = |i: usize| strands.strand(i)[0].length() + strands.length(i);
    (0..strands.count()).into_par_iter().map(one).reduce(|| 0.0, f32::max)
}
