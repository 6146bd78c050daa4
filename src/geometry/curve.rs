//! Curves through points: centripetal Catmull-Rom, and resampling uniform in arc length.

use glam::Vec3;

/// Tangent vectors (per unit of the curve's parameter 0..=1) at both ends of the segment from `p[1]` to `p[2]` of the
/// centripetal Catmull-Rom spline (Yuksel, Schaefer, Keyser 2011, knots spaced by the square root of the distance):
/// no cusps and no loops within a segment, also where nodes lie unevenly.
fn hermite(p: [Vec3; 4]) -> (Vec3, Vec3) {
    let knot = |a: Vec3, b: Vec3| a.distance(b).sqrt();
    let (t01, t12, t23) = (knot(p[0], p[1]), knot(p[1], p[2]), knot(p[2], p[3]));
    let chord = p[2] - p[1];
    let m1 = if t01 > 0.0 { chord + t12 * ((p[1] - p[0]) / t01 - (p[2] - p[0]) / (t01 + t12)) } else { chord };
    let m2 = if t23 > 0.0 { chord + t12 * ((p[3] - p[2]) / t23 - (p[3] - p[1]) / (t12 + t23)) } else { chord };
    (m1, m2)
}

/// The segment `i` of the spline through `points`, at `u` in 0..=1. Beyond the ends the polyline is mirrored.
pub fn catmull_rom(points: &[Vec3], i: usize, u: f32) -> Vec3 {
    let p = window(points, i);
    let (m1, m2) = hermite(p);
    evaluate(p, m1, m2, u)
}

fn window(points: &[Vec3], i: usize) -> [Vec3; 4] {
    let (a, b) = (points[i], points[i + 1]);
    let before = if i > 0 { points[i - 1] } else { a + a - b };
    let after = points.get(i + 2).copied().unwrap_or(b + b - a);
    [before, a, b, after]
}

fn evaluate(p: [Vec3; 4], m1: Vec3, m2: Vec3, u: f32) -> Vec3 {
    let v = 1.0 - u;
    p[1] * (v * v * (1.0 + 2.0 * u)) + p[2] * (u * u * (3.0 - 2.0 * u)) + m1 * (u * v * v) - m2 * (u * u * v)
}

/// Arc length of a polyline.
pub fn length(points: &[Vec3]) -> f32 {
    points.windows(2).map(|w| w[0].distance(w[1])).sum()
}

/// Resamples polylines; keeps its scratch memory between calls.
#[derive(Clone, Debug, Default)]
pub struct Resampler {
    /// The spline, finely sampled, with its arc length so far.
    dense: Vec<(Vec3, f32)>,
}

impl Resampler {
    /// Samples per segment of the input: the arc length of a chord polyline over a quarter turn per segment is then
    /// short by less than 0.2 %.
    const FINE: usize = 8;

    /// Writes `out.len()` nodes onto the centripetal Catmull-Rom spline through `points`, evenly spaced in arc
    /// length; both ends stay. `place`, called for each node of `out`, is told where it lies in `points`, as a
    /// fractional index. Returns the spline's arc length. Wants at least two points and two places.
    pub fn uniform(&mut self, points: &[Vec3], out: &mut [Vec3], mut place: impl FnMut(usize, f32)) -> f32 {
        let (Some(&first), Some(&last)) = (points.first(), points.last()) else { return 0.0 };
        self.dense.clear();
        self.dense.push((first, 0.0));
        let (mut total, mut before) = (0.0_f32, first);
        for i in 0..points.len() - 1 {
            let p = window(points, i);
            let (m1, m2) = hermite(p);
            for k in 1..=Self::FINE {
                let q = if k == Self::FINE { p[2] } else { evaluate(p, m1, m2, k as f32 / Self::FINE as f32) };
                total += q.distance(before);
                before = q;
                self.dense.push((q, total));
            }
        }
        let steps = out.len().saturating_sub(1).max(1);
        let mut at = 0;
        for (j, node) in out.iter_mut().enumerate() {
            let s = total * (j as f32 / steps as f32);
            while at + 2 < self.dense.len() && self.dense[at + 1].1 < s {
                at += 1;
            }
            let Some(&(b, sb)) = self.dense.get(at + 1) else {
                *node = first;
                place(j, 0.0);
                continue;
            };
            let (a, sa) = self.dense[at];
            let u = if sb > sa { ((s - sa) / (sb - sa)).clamp(0.0, 1.0) } else { 0.0 };
            *node = a.lerp(b, u);
            place(j, (at as f32 + u) / Self::FINE as f32);
        }
        if let Some(node) = out.last_mut() {
            *node = last;
        }
        if let Some(node) = out.first_mut() {
            *node = first;
        }
        total
    }
}

/// `count` nodes evenly spaced in arc length on the spline through `points`; see [`Resampler::uniform`].
pub fn resampled(points: &[Vec3], count: usize) -> Vec<Vec3> {
    let mut out = vec![Vec3::ZERO; count];
    Resampler::default().uniform(points, &mut out, |_, _| ());
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{rng::Key, trig};
    use proptest::prelude::*;

    fn circle(n: usize, radius: f32, turn: f32) -> Vec<Vec3> {
        (0..n)
            .map(|i| {
                let a = turn * i as f32 / (n - 1) as f32;
                Vec3::new(radius * trig::cos(a), radius * trig::sin(a), 0.0)
            })
            .collect()
    }

    #[test]
    fn nodes_are_kept_at_the_spline_s_knots() {
        let points = circle(9, 3.0, 4.0);
        for i in 0..8 {
            assert!(catmull_rom(&points, i, 0.0).distance(points[i]) < 1e-5);
            assert!(catmull_rom(&points, i, 1.0).distance(points[i + 1]) < 1e-5);
        }
        // Both sides of a knot leave it in the same direction.
        for i in 0..7 {
            let before = points[i + 1] - catmull_rom(&points, i, 0.999);
            let after = catmull_rom(&points, i + 1, 0.001) - points[i + 1];
            assert!(before.normalize().dot(after.normalize()) > 0.999);
        }
    }

    #[test]
    fn an_arc_keeps_its_length_and_its_shape() {
        let arc = circle(24, 5.0, 3.0);
        for count in [24, 50, 200] {
            let out = resampled(&arc, count);
            assert!((length(&out) - 15.0).abs() < 0.02, "{count}: {}", length(&out));
            for p in &out {
                assert!((p.length() - 5.0).abs() < 0.01, "{p}");
            }
            let step = 15.0 / (count - 1) as f32;
            for w in out.windows(2) {
                assert!((w[0].distance(w[1]) - step).abs() < 0.01 * step, "uneven at {count}");
            }
        }
    }

    #[test]
    fn degenerate_polylines_stay_finite() {
        let p = Vec3::new(1.0, 2.0, 3.0);
        for points in [vec![p; 2], vec![p, p, p + Vec3::X, p + Vec3::X], vec![p; 5]] {
            for q in resampled(&points, 7) {
                assert!(q.is_finite());
            }
        }
    }

    #[test]
    fn places_grow_from_first_to_last() {
        let mut places = vec![];
        Resampler::default().uniform(&circle(10, 2.0, 3.0), &mut [Vec3::ZERO; 33], |_, at| places.push(at));
        assert_eq!((places[0], places[32]), (0.0, 9.0));
        assert!(places.windows(2).all(|w| w[0] < w[1]));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]
        #[test]
        fn a_smooth_walk_keeps_its_length(seed in 0_u64..1_000_000, extra in 0_usize..80) {
            let key = Key::new(seed, "walk");
            let (mut p, mut t) = (Vec3::ZERO, Vec3::Y);
            let mut points = vec![p];
            for i in 0..40 {
                t = (t + key.with(i).direction() * 0.3).normalize();
                p += t * key.with(i).with(9).range(0.3, 0.6);
                points.push(p);
            }
            let out = resampled(&points, 41 + extra);
            prop_assert!((length(&out) / length(&points) - 1.0).abs() < 0.015);
            prop_assert_eq!(out[0], points[0]);
            prop_assert_eq!(out[40 + extra], points[40]);
        }
    }
}
