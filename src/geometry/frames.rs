//! Rotation-minimising frames along polylines.

use glam::Vec3;

/// Unit tangents at every node: the mean direction of the segments on both sides, the ends' own segment at the ends.
/// Nodes on the same place take the tangent before them.
pub fn tangents(points: &[Vec3], out: &mut [Vec3]) {
    let mut last = Vec3::Y;
    for i in 0..points.len().min(out.len()) {
        let before = if i > 0 { (points[i] - points[i - 1]).normalize_or_zero() } else { Vec3::ZERO };
        let after = points.get(i + 1).map_or(Vec3::ZERO, |q| (q - points[i]).normalize_or_zero());
        last = (before + after).try_normalize().or(after.try_normalize()).unwrap_or(last);
        out[i] = last;
    }
}

/// Carries the normal `n` of the frame at `a` (unit tangent `ta`) to `b` (unit tangent `tb`) by double reflection (Wang,
/// Juettler, Zheng, Liu 2008, table I): the frame turns as little as possible about the curve, with an error of fourth
/// order in the step. The result is a unit vector at a right angle to `tb`.
pub fn transport(n: Vec3, a: Vec3, ta: Vec3, b: Vec3, tb: Vec3) -> Vec3 {
    let v1 = b - a;
    let c1 = v1.length_squared();
    let (nl, tl) = if c1 > 0.0 {
        (n - v1 * (2.0 / c1 * v1.dot(n)), ta - v1 * (2.0 / c1 * v1.dot(ta)))
    } else {
        // The first reflection is in a plane of no direction: leave it out, and turn by the second alone.
        (n, -ta)
    };
    let v2 = tb - tl;
    let c2 = v2.length_squared();
    let r = if c2 > 0.0 { nl - v2 * (2.0 / c2 * v2.dot(nl)) } else { nl };
    perpendicular(r, tb)
}

/// The part of `v` at a right angle to the unit vector `t`, of length 1; any such vector when `v` is along `t`.
pub fn perpendicular(v: Vec3, t: Vec3) -> Vec3 {
    (v - t * v.dot(t)).try_normalize().unwrap_or_else(|| t.any_orthonormal_vector())
}

/// Writes the normals of the rotation-minimising frame along `points` with unit `tangents`, starting from the part of
/// `first` at a right angle to the first tangent. The binormal is `tangent x normal`.
pub fn normals(points: &[Vec3], tangents: &[Vec3], first: Vec3, out: &mut [Vec3]) {
    let Some(&t0) = tangents.first() else { return };
    let mut n = perpendicular(first, t0);
    for i in 0..points.len().min(out.len()) {
        if i > 0 {
            n = transport(n, points[i - 1], tangents[i - 1], points[i], tangents[i]);
        }
        out[i] = n;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{rng::Key, trig};
    use std::f32::consts::TAU;

    fn frame(points: &[Vec3], exact: Option<&[Vec3]>, first: Vec3) -> (Vec<Vec3>, Vec<Vec3>) {
        let mut t = vec![Vec3::ZERO; points.len()];
        match exact {
            Some(exact) => t.copy_from_slice(exact),
            None => tangents(points, &mut t),
        }
        let mut n = vec![Vec3::ZERO; points.len()];
        normals(points, &t, first, &mut n);
        (t, n)
    }

    #[test]
    fn frames_are_orthonormal_on_any_walk() {
        for seed in 0..20 {
            let key = Key::new(seed, "frames");
            let mut p = Vec3::ZERO;
            let points: Vec<Vec3> = (0..200)
                .map(|i| {
                    // Every tenth step stands still, which must not upset the frame.
                    p += key.with(i).direction() * if i % 10 == 0 { 0.0 } else { 0.4 };
                    p
                })
                .collect();
            let (t, n) = frame(&points, None, key.direction());
            for (t, n) in t.iter().zip(&n) {
                assert!((t.length() - 1.0).abs() < 1e-5 && (n.length() - 1.0).abs() < 1e-5 && t.dot(*n).abs() < 1e-5);
            }
        }
    }

    #[test]
    fn a_planar_curve_keeps_its_binormal() {
        let points: Vec<Vec3> = (0..100)
            .map(|i| {
                let u = i as f32 * 0.1;
                Vec3::new(u, trig::sin(2.0 * u), 0.0)
            })
            .collect();
        let (t, n) = frame(&points, None, Vec3::Y);
        for (t, n) in t.iter().zip(&n) {
            assert!(t.cross(*n).distance(Vec3::Z) < 1e-4);
        }
    }

    /// On a helix of radius r and pitch 2 pi c the Frenet frame turns about the tangent by the integral of the torsion,
    /// c / (r^2 + c^2) ds; the rotation-minimising frame stays behind by exactly that angle.
    #[test]
    fn a_helix_has_the_analytic_twist() {
        let (r, c) = (2.0_f32, 0.7_f32);
        let speed = trig::hypot(r, c);
        let n = 400;
        let at = |i: usize| 2.0 * TAU * i as f32 / n as f32;
        let points: Vec<Vec3> =
            (0..=n).map(|i| Vec3::new(r * trig::cos(at(i)), r * trig::sin(at(i)), c * at(i))).collect();
        let exact: Vec<Vec3> =
            (0..=n).map(|i| Vec3::new(-r * trig::sin(at(i)), r * trig::cos(at(i)), c) / speed).collect();
        let (t, normals) = frame(&points, Some(&exact), Vec3::NEG_X);
        for i in 0..=n {
            let frenet = Vec3::new(-trig::cos(at(i)), -trig::sin(at(i)), 0.0);
            let binormal = t[i].cross(frenet);
            let angle = c / (r * r + c * c) * speed * at(i);
            let expected = frenet * trig::cos(angle) - binormal * trig::sin(angle);
            assert!(normals[i].distance(expected) < 2e-3, "node {i}: {} against {expected}", normals[i]);
        }
    }

    #[test]
    fn nothing_and_standing_still() {
        let (t, n) = frame(&[Vec3::ONE; 4], None, Vec3::Y);
        assert!(t.iter().chain(&n).all(|v| v.is_finite() && (v.length() - 1.0).abs() < 1e-5));
        let turned = transport(Vec3::X, Vec3::ZERO, Vec3::Y, Vec3::ZERO, Vec3::Z);
        assert!((turned.length() - 1.0).abs() < 1e-6 && turned.dot(Vec3::Z).abs() < 1e-6);
    }
}
