//! Signed distance primitives and their blends: what the mannequin is carved from.
//!
//! Formulas after I. Quilez, "Distance functions" and "Smooth minimum". Every blend has a finite reach `k`: where two
//! surfaces are further apart than `k`, the nearer one is kept unchanged. That makes it exact to skip a far feature.

use glam::{Vec2, Vec3};

/// Smooth union, C2, reaching `k` cm.
pub fn join(a: f32, b: f32, k: f32) -> f32 {
    let h = (k - (a - b).abs()).max(0.0) / k;
    a.min(b) - h * h * h * k / 6.0
}

/// Smooth intersection, C2, reaching `k` cm.
pub fn meet(a: f32, b: f32, k: f32) -> f32 {
    -join(-a, -b, k)
}

/// Smoothly takes `b` away from `a`.
pub fn carve(a: f32, b: f32, k: f32) -> f32 {
    meet(a, -b, k)
}

/// Whether a feature may change a field of value `d` at `p`. The ball is drawn so large that no blend of the feature
/// reaches more than 2 cm beyond it; where this is false, the feature changes nothing and need not be computed.
pub fn near(p: Vec3, d: f32, centre: Vec3, radius: f32) -> bool {
    (p - centre).length_squared() < (radius + 2.0 + d.abs()) * (radius + 2.0 + d.abs())
}

/// Distance to an ellipsoid: exact on the surface and to first order around it.
pub fn ellipsoid(p: Vec3, centre: Vec3, radii: Vec3) -> f32 {
    let q = p - centre;
    let k0 = (q / radii).length();
    let k1 = (q / (radii * radii)).length();
    if k1 < 1e-9 { -radii.min_element() } else { k0 * (k0 - 1.0) / k1 }
}

/// Distance to a sphere.
pub fn sphere(p: Vec3, centre: Vec3, radius: f32) -> f32 {
    (p - centre).length() - radius
}

/// Distance to a tube from `a` to `b` whose radius goes from `ra` to `rb`.
pub fn tube(p: Vec3, a: Vec3, b: Vec3, ra: f32, rb: f32) -> f32 {
    let (pa, ba) = (p - a, b - a);
    let h = (pa.dot(ba) / ba.length_squared()).clamp(0.0, 1.0);
    (pa - ba * h).length() - (ra + (rb - ra) * h)
}

/// Distance to a tube bent along the quadratic curve `a`, `b`, `c`, whose radius goes `ra`, `rb`, `rc`: the curve is
/// taken as `N` straight pieces.
pub fn bent_tube<const N: usize>(p: Vec3, [a, b, c]: [Vec3; 3], [ra, rb, rc]: [f32; 3]) -> f32 {
    let (mut nearest, mut from, mut from_r) = (f32::MAX, a, ra);
    for i in 1..=N {
        let t = i as f32 / N as f32;
        let (u, v, w) = ((1.0 - t) * (1.0 - t), 2.0 * t * (1.0 - t), t * t);
        let (to, to_r) = (a * u + b * v + c * w, ra * u + rb * v + rc * w);
        nearest = nearest.min(tube(p, from, to, from_r, to_r));
        (from, from_r) = (to, to_r);
    }
    nearest
}

/// Distance in a plane to an ellipse around the origin, to first order.
pub fn ellipse(q: Vec2, radii: Vec2) -> f32 {
    let k0 = (q / radii).length();
    let k1 = (q / (radii * radii)).length();
    if k1 < 1e-9 { -radii.min_element() } else { k0 * (k0 - 1.0) / k1 }
}

/// A smooth curve through `(x, y)` knots with ascending `x` (Catmull-Rom slopes), constant beyond the ends.
pub fn curve<const N: usize>(knots: &[[f32; 2]; N], x: f32) -> f32 {
    let i = knots.iter().position(|k| k[0] > x).unwrap_or(N);
    if i == 0 {
        return knots[0][1];
    }
    if i == N {
        return knots[N - 1][1];
    }
    let slope = |i: usize| {
        let (a, b) = (i.saturating_sub(1), (i + 1).min(N - 1));
        if i == 0 || i == N - 1 { 0.0 } else { (knots[b][1] - knots[a][1]) / (knots[b][0] - knots[a][0]) }
    };
    let ([x0, y0], [x1, y1]) = (knots[i - 1], knots[i]);
    let (d, t) = (x1 - x0, (x - x0) / (x1 - x0));
    let (t2, t3) = (t * t, t * t * t);
    y0 * (2.0 * t3 - 3.0 * t2 + 1.0)
        + slope(i - 1) * d * (t3 - 2.0 * t2 + t)
        + y1 * (3.0 * t2 - 2.0 * t3)
        + slope(i) * d * (t3 - t2)
}
