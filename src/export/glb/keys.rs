//! Keys: the frames that an animation keeps, with the rest between them.

use glam::{Affine3A, Quat, Vec3};

use crate::geometry::Bounds;

/// The frames to keep of `0..count`, the first and the last among them, so that `error(from, to, frame)` of every frame
/// between two kept ones is at most `tolerance`. From each kept frame the next is as far on as can be.
pub fn reduce(count: usize, tolerance: f32, error: impl Fn(usize, usize, usize) -> f32) -> Vec<usize> {
    let mut kept = vec![0];
    let mut from = 0;
    while from + 1 < count {
        let mut to = from + 1;
        while to + 1 < count && (from + 1..=to).all(|frame| error(from, to + 1, frame) <= tolerance) {
            to += 1;
        }
        kept.push(to);
        from = to;
    }
    kept
}

/// The part of the way from one frame to another.
pub fn share(from: usize, to: usize, frame: usize) -> f32 {
    (frame - from) as f32 / (to - from).max(1) as f32
}

/// A turn and a move, cm: what a node of an animation is set to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placing {
    /// Unit quaternion.
    pub turn: Quat,
    /// Then moved by so much, cm.
    pub shift: Vec3,
}

impl Placing {
    /// Of rigid transforms; each turn is the nearer one of the two quaternions that it has.
    pub fn of(transforms: impl IntoIterator<Item = Affine3A>) -> Vec<Self> {
        let mut before = Quat::IDENTITY;
        transforms
            .into_iter()
            .map(|t| {
                let (_, turn, shift) = t.to_scale_rotation_translation();
                let turn = turn.normalize();
                before = if before.dot(turn) < 0.0 { -turn } else { turn };
                Self { turn: before, shift }
            })
            .collect()
    }

    /// The transform.
    pub fn transform(&self) -> Affine3A {
        Affine3A::from_rotation_translation(self.turn, self.shift)
    }

    /// Between two, as programs go between two keys.
    pub fn between(a: &Self, b: &Self, t: f32) -> Self {
        Self { turn: slerp(a.turn, b.turn, t), shift: a.shift.lerp(b.shift, t) }
    }
}

/// Spherical interpolation the short way, as the specification has it, with the portable functions.
fn slerp(a: Quat, b: Quat, t: f32) -> Quat {
    use crate::math::trig;
    let dot = a.dot(b);
    let (b, dot) = if dot < 0.0 { (-b, -dot) } else { (b, dot) };
    if dot > 0.9995 {
        return (a * (1.0 - t) + b * t).normalize();
    }
    let angle = trig::acos(dot.clamp(-1.0, 1.0));
    let (x, y) = (trig::sin((1.0 - t) * angle), trig::sin(t * angle));
    ((a * x + b * y) / trig::sin(angle)).normalize()
}

/// The frames to keep of placings, and per frame what is then between them; no point within `bounds` is farther than
/// `tolerance` cm from its place at any frame.
pub fn placings(all: &[Placing], bounds: Bounds, tolerance: f32) -> (Vec<usize>, Vec<Placing>, f32) {
    let corners: Vec<Vec3> = (0..8_u32)
        .map(|i| {
            let pick = |bit: u32, lo: f32, hi: f32| if i & bit == 0 { lo } else { hi };
            let (a, b) = (bounds.min, bounds.max);
            Vec3::new(pick(1, a.x, b.x), pick(2, a.y, b.y), pick(4, a.z, b.z))
        })
        .collect();
    let between = |from: usize, to: usize, frame: usize| Placing::between(&all[from], &all[to], share(from, to, frame));
    let error = |placing: &Placing, frame: usize| {
        let (a, b) = (placing.transform(), all[frame].transform());
        corners.iter().map(|c| a.transform_point3(*c).distance(b.transform_point3(*c))).fold(0.0, f32::max)
    };
    let kept = reduce(all.len(), tolerance, |from, to, frame| error(&between(from, to, frame), frame));
    let mut played = Vec::with_capacity(all.len());
    for w in kept.windows(2) {
        played.extend((w[0]..w[1]).map(|frame| between(w[0], w[1], frame)));
    }
    played.extend(all.last());
    let worst = played.iter().enumerate().map(|(f, p)| error(p, f)).fold(0.0, f32::max);
    (kept, played, worst)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn straight_stretches_keep_their_ends() {
        let heights: Vec<f32> = (0..21).map(|i| if i < 10 { i as f32 } else { 20.0 - i as f32 }).collect();
        let error = |a: usize, b: usize, f: usize| {
            let t = share(a, b, f);
            (heights[a] + (heights[b] - heights[a]) * t - heights[f]).abs()
        };
        assert_eq!(reduce(21, 1e-3, error), [0, 10, 20]);
        assert_eq!(reduce(21, 100.0, error), [0, 20]);
        assert_eq!(reduce(2, 0.0, error), [0, 1]);
        assert_eq!(reduce(1, 0.0, error), [0]);
    }

    #[test]
    fn a_whole_turn_is_kept_within_the_tolerance() {
        let turn = |i: usize| Affine3A::from_rotation_y(std::f32::consts::TAU * i as f32 / 48.0);
        let all = Placing::of((0..=48).map(turn));
        let bounds = Bounds { min: Vec3::splat(-10.0), max: Vec3::splat(10.0) };
        let (kept, played, worst) = placings(&all, bounds, 0.01);
        // Turning evenly about a fixed axis needs keys only because a turn of half a circle or more has two ways.
        assert!(kept.len() <= 5 && worst <= 0.01, "{kept:?} {worst}");
        for (i, placing) in played.iter().enumerate() {
            let p = Vec3::new(10.0, -10.0, 10.0);
            assert!(placing.transform().transform_point3(p).distance(turn(i).transform_point3(p)) <= 0.0101);
        }
        assert!(all.windows(2).all(|w| w[0].turn.dot(w[1].turn) > 0.9));
    }
}
