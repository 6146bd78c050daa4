//! One step of a growing or laid strand against a body: collision, and sliding along the skin.

use glam::Vec3;

use super::{Solid, frames};

/// A body that growth ends keep out of, by a margin.
#[derive(Clone, Copy, Debug)]
pub struct Body<'a> {
    /// The body.
    pub solid: &'a Solid,
    /// Least distance of a node from the skin, cm.
    pub margin: f32,
}

impl Body<'_> {
    /// How often a step is turned before it is cut short.
    const TURNS: usize = 6;

    /// A step of length `h` from `v` along the unit vector `t`, at least `margin` from the skin: where it ends and the
    /// tangent that leads there. An end that would come into the body, or pass through a part of it, is moved out along
    /// the surface's normal; the tangent follows it and the step is taken again, so that the strand slides along the
    /// skin at its own pace instead of stalling. `start` is where the test of the way begins: a little above the skin
    /// for the root. `free` is a distance from `v` within which there is no surface, kept from step to step.
    pub fn step(&self, v: Vec3, start: Vec3, t: Vec3, h: f32, margin: f32, free: &mut f32) -> (Vec3, Vec3) {
        let straight = v + t * h;
        *free -= h;
        if *free >= margin {
            return (straight, t);
        }
        *free = self.solid.clearance(straight);
        if *free >= h.max(margin) {
            return (straight, t);
        }
        *free = 0.0;
        let mut tangent = t;
        let mut best = None;
        for turn in 0..Self::TURNS {
            let end = v + tangent * h;
            let Some((out, is_way_free)) = self.push(start, end, margin) else { return (end, tangent) };
            if is_way_free {
                best = Some(out);
            }
            let turned = (out - v).try_normalize().filter(|_| out.distance(v) > 0.05 * h);
            tangent = turned.unwrap_or_else(|| {
                // Head on: the step would be turned back into itself. Go along the skin instead, and where the skin
                // gives no direction, down.
                let n = self.solid.closest(v).normal;
                let along = tangent - n * tangent.dot(n);
                if along.length() > 1e-3 { along.normalize() } else { frames::perpendicular(Vec3::NEG_Y, n) }
            });
            // Lean outwards a little more each time: a concave place may need it.
            if turn >= 2 {
                let n = self.solid.closest(v).normal;
                tangent = (tangent + n * (0.25 * turn as f32)).try_normalize().unwrap_or(n);
            }
        }
        // No step of full length was found: take the last end that could be reached, or keep to the skin here.
        let end = best.unwrap_or_else(|| {
            let near = self.solid.closest(v);
            near.position + near.normal * margin.max(near.distance + 0.1 * h)
        });
        let tangent = (end - v).try_normalize().unwrap_or(tangent);
        (end, tangent)
    }

    /// `None` when the way from `start` to `end` is free and `end` keeps the margin; otherwise `end` moved out, and
    /// whether the way to that place is free.
    fn push(&self, start: Vec3, end: Vec3, margin: f32) -> Option<(Vec3, bool)> {
        let near = self.solid.closest(end);
        let far = near.distance >= margin;
        // Rounding at the margin itself must not count as a touch for ever.
        let keeps = near.distance >= 0.98 * margin;
        let way = start.distance(end);
        let hit = if far && near.distance >= way { None } else { self.solid.segment_hit(start, end) };
        let out = match hit {
            None if keeps => return None,
            // Through a thin part (an ear) the nearest place may be on its other side: leave on the side of the hit.
            Some(hit) if near.distance > 0.0 => {
                let side = self.solid.closest(hit.position).normal;
                end + side * (margin - (end - hit.position).dot(side))
            }
            _ => near.position + near.normal * margin,
        };
        let out = match self.solid.closest_within(out, margin) {
            Some(again) => again.position + again.normal * margin,
            None => out,
        };
        Some((out, !self.solid.is_crossed(start, out) && !self.solid.contains(out)))
    }
}
