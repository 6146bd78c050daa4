//! A measuring tape as a thing to be seen.

use glam::Vec3;

use super::loft::Loft;
use crate::geometry::Mesh;
use crate::geometry::slice::Outline;
use crate::math::trig;

/// How far it lies outside, and how thick it is, cm.
const OFF: (f32, f32) = (0.25, 0.12);

/// A band of that width around the convex hull of an outline, a little outside it.
pub fn ribbon(outline: &Outline, width: f32) -> Mesh {
    let hull = outline.hull();
    let height = outline.points.first().map_or(0.0, |p| p.y);
    let mut edge: Vec<Vec3> = Vec::new();
    // Straight pieces between the hull's corners are divided, so that the band is round where the cloth is.
    for (i, a) in hull.iter().enumerate() {
        let b = hull[(i + 1) % hull.len()];
        let pieces = (a.distance(b) / 0.6).ceil().max(1.0) as usize;
        edge.extend((0..pieces).map(|k| {
            let p = a.lerp(b, k as f32 / pieces as f32);
            Vec3::new(p.x, height, p.y)
        }));
    }
    let n = edge.len();
    if n < 3 {
        return Mesh::default();
    }
    let out = |i: usize| {
        let way = edge[(i + 1) % n] - edge[(i + n - 1) % n];
        // The hull runs counter-clockwise in (x, z): outwards is to the right of its way.
        Vec3::new(way.z, 0.0, -way.x).normalize_or_zero()
    };
    let section: Vec<(f32, f32)> = (0..=16)
        .map(|k| {
            let a = std::f32::consts::TAU * k as f32 / 16.0;
            let (s, c) = (trig::sin(a), trig::cos(a));
            // A flat oval.
            (OFF.0 + OFF.1 * c, 0.5 * width * s.signum() * trig::pow(s.abs(), 0.35))
        })
        .collect();
    let ring = |&(off, up): &(f32, f32)| {
        let mut ring: Vec<Vec3> = (0..n).rev().map(|i| edge[i] + out(i) * off + Vec3::Y * up).collect();
        ring.push(ring[0]);
        ring
    };
    let mut rings: Vec<Vec<Vec3>> = section.iter().rev().map(ring).collect();
    let last = rings.len() - 1;
    rings[last] = rings[0].clone();
    let mut loft = Loft::default();
    loft.sheet("tape", &rings, |_, _| true);
    loft.finish()
}
