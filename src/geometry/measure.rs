//! Figures of strands as a whole: how much of a surface they cover, how symmetric they are.

use glam::Vec3;
use rayon::prelude::*;

use super::{Bounds, Bvh, Strands};

/// Nodes that a strand is thinned to before symmetry is measured.
const NODES: usize = 6;

/// Places whose mirror image is looked for.
const PROBES: usize = 4000;

/// For each of `places` whether any segment of the strands, roots included, comes within `reach` cm of it.
pub fn covered(places: &[Vec3], strands: &[&Strands], reach: f32) -> Vec<bool> {
    let finite = || places.iter().copied().filter(|p| p.is_finite());
    let bounds = Bounds::of(finite()).grown(reach);
    if bounds.is_empty() || reach.is_nan() || reach <= 0.0 {
        return vec![false; places.len()];
    }
    // A grid of cells no smaller than the reach, at most 64 on a side; a segment asks the cells its neighbourhood meets.
    let cell = (bounds.size().max_element() / 64.0).max(reach);
    let size = (bounds.size() / cell).floor().as_uvec3() + 1;
    let index = |p: Vec3| ((p - bounds.min) / cell).max(Vec3::ZERO).as_uvec3().min(size - 1);
    let flat = |x: u32, y: u32, z: u32| ((x * size.y + y) * size.z + z) as usize;
    let mut cells: Vec<Vec<u32>> = vec![vec![]; size.element_product() as usize];
    for (i, place) in places.iter().enumerate().filter(|(_, p)| p.is_finite()) {
        let c = index(*place);
        cells[flat(c.x, c.y, c.z)].push(i as u32);
    }
    let mark = |mut is_covered: Vec<bool>, line: &[Vec3]| {
        for w in line.windows(2) {
            let near = Bounds::of([w[0], w[1]]).grown(reach);
            if near.min.cmpgt(bounds.max).any() || near.max.cmplt(bounds.min).any() || !near.size().is_finite() {
                continue;
            }
            let (lo, hi) = (index(near.min), index(near.max));
            for x in lo.x..=hi.x {
                for y in lo.y..=hi.y {
                    for i in (lo.z..=hi.z).flat_map(|z| &cells[flat(x, y, z)]) {
                        let is = &mut is_covered[*i as usize];
                        *is = *is || to_segment(places[*i as usize], w[0], w[1]) <= reach;
                    }
                }
            }
        }
        is_covered
    };
    let none = || vec![false; places.len()];
    let either = |mut a: Vec<bool>, b: Vec<bool>| {
        a.iter_mut().zip(b).for_each(|(a, b)| *a |= b);
        a
    };
    strands
        .iter()
        .map(|s| (0..s.count()).into_par_iter().fold(none, |done, i| mark(done, s.strand(i))).reduce(none, either))
        .fold(none(), either)
}

/// Distance from `p` to the segment from `a` to `b`.
fn to_segment(p: Vec3, a: Vec3, b: Vec3) -> f32 {
    let d = b - a;
    let t = ((p - a).dot(d) / d.length_squared().max(f32::MIN_POSITIVE)).clamp(0.0, 1.0);
    p.distance(a + d * t)
}

/// Mean distance in cm from the mirror image of the strands, at the plane x = 0, to the strands themselves: 0 for a
/// perfect mirror image, about half the distance between neighbouring strands for a symmetric style with roots of its
/// own on either side. Each strand is thinned to six nodes, and at most 4,000 of these are mirrored. 0 for no strands.
pub fn mirror_distance(strands: &[&Strands]) -> f32 {
    let (mut nodes, mut segments) = (vec![], vec![]);
    for line in strands.iter().flat_map(|s| s.iter()).filter(|l| !l.is_empty() && l.iter().all(|p| p.is_finite())) {
        let first = nodes.len() as u32;
        let count = line.len().min(NODES);
        nodes.extend((0..count).map(|k| line[k * (line.len() - 1) / (count - 1).max(1)]));
        // A segment is a triangle whose last two corners are one.
        segments.extend((first + 1..nodes.len() as u32).map(|k| [k - 1, k, k]));
    }
    if segments.is_empty() {
        return 0.0;
    }
    let bvh = Bvh::new(&nodes, &segments);
    let step = nodes.len().div_ceil(PROBES);
    let distances: Vec<f64> = nodes
        .par_iter()
        .step_by(step)
        .map(|p| {
            let mirrored = Vec3::new(-p.x, p.y, p.z);
            bvh.closest(mirrored, f32::MAX.sqrt()).map_or(0.0, |c| f64::from(c.distance))
        })
        .collect();
    (distances.iter().sum::<f64>() / distances.len() as f64) as f32
}

#[cfg(test)]
mod tests {
    use glam::Vec2;

    use super::*;
    use crate::geometry::Root;
    use crate::math::rng::Key;

    fn strands(lines: &[Vec<Vec3>]) -> Strands {
        let mut s = Strands::new();
        for (i, line) in lines.iter().enumerate() {
            let root = Root { id: i as u64, position: line[0], normal: Vec3::Y, uv: Vec2::ZERO, triangle: 0 };
            s.push(root, 0, line.iter().copied());
        }
        s
    }

    fn random(key: Key, n: usize, nodes: usize) -> Vec<Vec<Vec3>> {
        let node = |k: Key| k.direction() * k.with(1).range(0.0, 8.0);
        (0..n).map(|i| (0..nodes).map(|j| node(key.with(i as u64).with(j as u64))).collect()).collect()
    }

    #[test]
    fn covered_is_what_brute_force_finds() {
        let key = Key::new(1, "covered");
        let lines = random(key, 30, 4);
        let hair = strands(&lines);
        let places: Vec<Vec3> = random(key.with(7), 1, 400).remove(0);
        for reach in [0.05, 0.4, 1.3, 30.0] {
            let brute: Vec<bool> = places
                .iter()
                .map(|&p| lines.iter().any(|l| l.windows(2).any(|w| to_segment(p, w[0], w[1]) <= reach)))
                .collect();
            assert_eq!(covered(&places, &[&hair], reach), brute, "{reach}");
        }
        assert!(covered(&places, &[], 1.0).iter().all(|c| !c));
        assert!(covered(&[], &[&hair], 1.0).is_empty());
        for none in [0.0, -1.0, f32::NAN] {
            assert!(covered(&places, &[&hair], none).iter().all(|c| !c));
        }
    }

    #[test]
    fn a_mirror_image_has_distance_zero() {
        let key = Key::new(2, "mirror");
        let half = random(key, 40, 5);
        let other = half.iter().map(|l| l.iter().map(|p| Vec3::new(-p.x, p.y, p.z)).collect());
        let both: Vec<Vec<Vec3>> = half.iter().cloned().chain(other).collect();
        assert!(mirror_distance(&[&strands(&both)]) < 1e-5);
        // The two halves as two parts are the same hair.
        assert!(mirror_distance(&[&strands(&both[..40]), &strands(&both[40..])]) < 1e-5);
        // Moved sideways by 3 cm, straight strands that stand side by side in y miss their images by 6 cm.
        let upright = |x: f32| -> Vec<Vec<Vec3>> {
            (0..9).map(|i| vec![Vec3::new(x, i as f32, 0.0), Vec3::new(x, i as f32, 9.0)]).collect()
        };
        assert!((mirror_distance(&[&strands(&upright(3.0))]) - 6.0).abs() < 1e-4);
        assert_eq!(mirror_distance(&[]), 0.0);
    }
}
