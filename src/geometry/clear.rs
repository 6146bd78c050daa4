//! Finished strands kept out of the body: no node and no segment inside, beyond the root's own first segment.
//!
//! [`Clear::strand`] first looks whether a strand is clear, which is quick where the body is far. If it is not, nodes
//! are pushed out along the surface's normal, and their neighbours with them, smoothly; a few rounds of this keep the
//! strand's shape. What is still not clear then (folds, thin parts that a strand goes through) is laid again, node by
//! node, sliding along the skin. What cannot be laid at all is cut.

use std::ops::Range;

use glam::Vec3;
use rayon::prelude::*;

use super::slide::Body;
use super::{Solid, Strands, Vicinity};
use crate::task::{Cancelled, Task};

/// Keeps strands out of a body.
#[derive(Clone, Copy, Debug)]
pub struct Clear<'a> {
    /// The body and the margin.
    pub body: Body<'a>,
}

/// Memory that is used again from strand to strand.
#[derive(Clone, Debug, Default)]
pub struct Scratch {
    push: Vec<Vec3>,
    sum: Vec<(Vec3, f32)>,
    wanted: Vec<Vec3>,
}

/// What became of a strand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// Nothing had to be done, or the whole strand could be kept.
    Clear,
    /// The strand ends where it could not go on; its last nodes lie on its last segment.
    Cut,
    /// There is no way out of the body from its root.
    Stuck,
}

impl Clear<'_> {
    /// Rounds of smooth pushing.
    const ROUNDS: usize = 8;
    /// Nodes on each side that follow a pushed one.
    const FOLLOW: usize = 5;

    /// Moves the nodes of a strand, root first, out of the body. The root stays where it is.
    pub fn strand(&self, points: &mut [Vec3], scratch: &mut Scratch) -> Outcome {
        if points.len() < 2 {
            return Outcome::Stuck;
        }
        let mut scan = 1..points.len();
        for _ in 0..Self::ROUNDS {
            let Some(pushed) = self.pushes(points, scan, &mut scratch.push) else { return Outcome::Clear };
            let lo = pushed.start.saturating_sub(Self::FOLLOW).max(1);
            let hi = (pushed.end + Self::FOLLOW).min(points.len());
            self.spread(points, lo..hi, scratch);
            // Only what moved has to be looked at again, with the segment after it.
            scan = lo..(hi + 1).min(points.len());
        }
        if self.is_clear(points) { Outcome::Clear } else { self.lay_again(points, &mut scratch.wanted) }
    }

    /// The margin at a node: it rises from the skin over the first of them.
    fn margin_at(&self, points: &[Vec3], k: usize) -> f32 {
        self.body.margin.min((0.45 * k as f32 * points[0].distance(points[1])).max(0.002))
    }

    /// Writes how far the nodes of `scan` have to move, and says which do, if any; the rest of `push` is zero.
    fn pushes(&self, points: &[Vec3], scan: Range<usize>, push: &mut Vec<Vec3>) -> Option<Range<usize>> {
        let solid = self.body.solid;
        let mut pushed: Option<Range<usize>> = None;
        let mut at = |k: usize, by: Vec3| {
            let range = pushed.get_or_insert_with(|| {
                push.clear();
                push.resize(points.len(), Vec3::ZERO);
                k..k + 1
            });
            *range = range.start.min(k)..range.end.max(k + 1);
            if by.length_squared() > push[k].length_squared() {
                push[k] = by;
            }
        };
        // Around the node before this one no surface is nearer than `free`.
        let mut free = 0.0;
        // What is known around it, where that was looked up.
        let mut before: Option<Vicinity> = None;
        if scan.start > 1 {
            let around = solid.around(points[scan.start - 1]);
            (free, before) = (around.clearance.max(0.0), Some(around));
        }
        let mut was_inside = false;
        for k in scan {
            let (a, b) = (points[k - 1], points[k]);
            let way = a.distance(b);
            // The distance falls by no more than the way: while it lasts, nothing needs to be asked.
            if k > 1 && free - way >= self.body.margin {
                free -= way;
                before = None;
                continue;
            }
            let around = solid.around(b);
            let clearance = around.clearance.max(0.0);
            let at_a = before.replace(around);
            let mut known = None;
            let mut is_surely_outside = || {
                *known.get_or_insert_with(|| {
                    let at_a = at_a.unwrap_or_else(|| solid.around(a));
                    solid.is_way_free((a, &at_a), (b, &around))
                })
            };
            if clearance >= self.body.margin
                && (k == 1 || is_surely_outside() || is_covered(solid, (a, free), (b, clearance), 2))
            {
                (free, was_inside) = (clearance, false);
                continue;
            }
            let margin = self.margin_at(points, k);
            let reach = way.max(self.body.margin);
            let most = if k == 1 || was_inside { f32::MAX.sqrt() } else { reach };
            let near = solid.closest_around(b, &around, most);
            let Some(near) = near else {
                // No surface as near as the last node: the way does not cross one.
                free = reach;
                continue;
            };
            let crosses =
                k > 1 && free + near.distance.max(0.0) <= way && !is_surely_outside() && solid.is_crossed(a, b);
            was_inside = near.distance < 0.0;
            free = near.distance.max(0.0);
            if near.distance < 0.98 * margin {
                at(k, near.position + near.normal * margin - b);
            }
            if crosses {
                // The deepest of a few places between the ends says how far both have to go.
                let mut deepest = near;
                for u in [0.2, 0.4, 0.6, 0.8] {
                    let p = a.lerp(b, u);
                    let around = solid.around(p);
                    // Only what may be deeper has to be asked for.
                    if around.clearance.max(0.0) >= deepest.distance && around.clearance > 0.0 {
                        continue;
                    }
                    if let Some(s) = solid.closest_around(p, &around, f32::MAX.sqrt())
                        && s.distance < deepest.distance
                    {
                        deepest = s;
                    }
                }
                let by = deepest.normal * (margin - deepest.distance.min(0.0));
                at(k, by);
                at(k - 1, by);
            }
        }
        pushed
    }

    /// Moves the nodes of `range` by the pushes of their neighbours.
    fn spread(&self, points: &mut [Vec3], range: Range<usize>, scratch: &mut Scratch) {
        scratch.sum.clear();
        scratch.sum.resize(range.len(), (Vec3::ZERO, 0.0));
        for k in range.clone() {
            let by = scratch.push[k];
            if by == Vec3::ZERO {
                continue;
            }
            let (lo, hi) = (k.saturating_sub(Self::FOLLOW).max(range.start), (k + Self::FOLLOW + 1).min(range.end));
            for j in lo..hi {
                let u = k.abs_diff(j) as f32 / (Self::FOLLOW + 1) as f32;
                let weight = (1.0 - u * u) * (1.0 - u * u);
                let sum = &mut scratch.sum[j - range.start];
                sum.0 += by * weight;
                sum.1 += weight;
            }
        }
        for (k, &(sum, weight)) in range.zip(&scratch.sum) {
            let smooth = sum / weight.max(1.0);
            let own = scratch.push[k];
            // A node that must move moves far enough along its own push, whatever its neighbours want.
            let short = if own == Vec3::ZERO { 0.0 } else { (1.0 - smooth.dot(own) / own.length_squared()).max(0.0) };
            points[k] += smooth + own * short;
        }
    }

    /// True when no node and no segment beyond the first is inside.
    pub fn is_clear(&self, points: &[Vec3]) -> bool {
        !is_inside(self.body.solid, points)
    }

    /// Lays the strand again: every node where it was wanted if the way there is free, otherwise a step that slides.
    fn lay_again(&self, points: &mut [Vec3], wanted: &mut Vec<Vec3>) -> Outcome {
        wanted.clear();
        wanted.extend_from_slice(points);
        let solid = self.body.solid;
        let step = wanted[0].distance(wanted[1]);
        let Some(first) = self.way_out(wanted[0], wanted[1], step) else { return Outcome::Stuck };
        points[1] = first;
        // What sliding adds is given back slowly, so that the strand finds its way to where it was.
        let mut behind = first - wanted[1];
        for k in 2..points.len() {
            let (v, h) = (points[k - 1], wanted[k].distance(wanted[k - 1]));
            let goal = wanted[k] + behind * 0.8;
            let margin = self.margin_at(points, k);
            let is_free = |q: Vec3| {
                let clearance = solid.clearance(q);
                clearance > v.distance(q) || (!solid.contains(q) && !solid.is_crossed(v, q))
            };
            let direct = solid.clearance(goal) >= margin || solid.signed_distance(goal) >= 0.98 * margin;
            let end = if direct && is_free(goal) {
                goal
            } else {
                let t = (goal - v).try_normalize().unwrap_or(Vec3::NEG_Y);
                self.body.step(v, v, t, h, margin, &mut 0.0).0
            };
            if !end.is_finite() || !is_free(end) {
                return Self::cut(points, k);
            }
            behind = end - wanted[k];
            points[k] = end;
        }
        if self.is_clear(points) {
            return Outcome::Clear;
        }
        // Not reached but by rounding: keep the part that is clear.
        let clear = (2..points.len()).take_while(|&k| self.is_clear(&points[..=k])).count() + 2;
        if clear > 2 || self.is_clear(&points[..2]) { Self::cut(points, clear) } else { Outcome::Stuck }
    }

    /// A first node outside, near `wanted`.
    fn way_out(&self, root: Vec3, wanted: Vec3, step: f32) -> Option<Vec3> {
        let solid = self.body.solid;
        let margin = self.body.margin.min(0.45 * step);
        let near = solid.closest(wanted);
        if near.distance >= margin {
            return Some(wanted);
        }
        let at_root = solid.closest(root).normal;
        let places = [
            near.position + near.normal * margin,
            root + at_root * margin.max(0.1 * step),
            root + at_root * margin.max(step),
        ];
        places.into_iter().find(|&p| p.is_finite() && solid.signed_distance(p) > 0.0)
    }

    /// Ends the strand before node `k`: what is left of it goes onto its last segment.
    fn cut(points: &mut [Vec3], k: usize) -> Outcome {
        let n = points.len();
        let (a, b) = (points[k - 2], points[k - 1]);
        let pieces = (n - k + 1) as f32;
        for (j, p) in points[k - 1..].iter_mut().enumerate() {
            *p = a.lerp(b, (j + 1) as f32 / pieces);
        }
        // With k = 2 the last segment is the root's own, whose inner part may touch the skin.
        if k == 2 {
            points[1..].fill(b);
        }
        Outcome::Cut
    }
}

/// True when balls that are free of the surface cover the segment between two places with these clearances; looks at
/// places between them, to the given depth.
fn is_covered(solid: &Solid, a: (Vec3, f32), b: (Vec3, f32), depth: u32) -> bool {
    let (way, reach) = (a.0.distance_squared(b.0), a.1 + b.1);
    if reach * reach > way {
        return true;
    }
    if depth == 0 {
        return false;
    }
    let middle = (a.0 + b.0) * 0.5;
    let clearance = solid.clearance(middle);
    clearance > 0.0
        && is_covered(solid, a, (middle, clearance), depth - 1)
        && is_covered(solid, (middle, clearance), b, depth - 1)
}

/// True when a node of the strand beyond its root, or a segment beyond its first, is inside the body or crosses its
/// surface.
pub fn is_inside(solid: &Solid, points: &[Vec3]) -> bool {
    let mut free = 0.0;
    let mut before: Option<Vicinity> = None;
    points.iter().enumerate().skip(1).any(|(k, &b)| {
        let a = points[k - 1];
        let way = a.distance(b);
        if k > 1 && free > way {
            free -= way;
            before = None;
            return false;
        }
        let around = solid.around(b);
        let clearance = around.clearance.max(0.0);
        let was_free = std::mem::replace(&mut free, clearance);
        let at_a = before.replace(around);
        let is_surely_outside = || {
            let at_a = at_a.unwrap_or_else(|| solid.around(a));
            solid.is_way_free((a, &at_a), (b, &around))
        };
        (clearance == 0.0 && solid.contains(b))
            || (k > 1
                && !is_surely_outside()
                && !is_covered(solid, (a, was_free), (b, clearance), 2)
                && solid.is_crossed(a, b))
    })
}

/// Moves the strands that `which` says out of the body; roots stay. Tells how many were cut short, and how many found no
/// way out at all.
///
/// # Errors
/// Cancelling.
pub fn keep_out(
    strands: &mut Strands,
    which: &(dyn Fn(usize) -> bool + Sync),
    body: Body,
    task: &Task,
) -> Result<[usize; 2], Cancelled> {
    let Strands { points, offsets, .. } = strands;
    let mut rest = points.as_mut_slice();
    let mut pieces = Vec::with_capacity(offsets.len().saturating_sub(1));
    for w in offsets.windows(2) {
        let (piece, after) = std::mem::take(&mut rest).split_at_mut((w[1] - w[0]) as usize);
        pieces.push(piece);
        rest = after;
    }
    let clear = Clear { body };
    let add = |a: [usize; 2], b: [usize; 2]| Ok([a[0] + b[0], a[1] + b[1]]);
    let work = pieces.into_par_iter().enumerate().map_init(Scratch::default, |scratch, (i, nodes)| {
        if !which(i) {
            return Ok([0, 0]);
        }
        if i.is_multiple_of(64) {
            task.check()?;
        }
        Ok(match clear.strand(nodes, scratch) {
            Outcome::Clear => [0, 0],
            Outcome::Cut => [1, 0],
            Outcome::Stuck => [0, 1],
        })
    });
    work.try_reduce(|| [0, 0], add)
}

/// How many strands have a node or a segment (the root's own first apart) inside the body, by the exact test.
pub fn count_inside(strands: &Strands, solid: &Solid) -> usize {
    (0..strands.count()).into_par_iter().filter(|&i| is_inside(solid, strands.strand(i))).count()
}
