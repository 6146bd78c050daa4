//! Leaving out nodes that a polyline can do without.

use glam::Vec3;
use rayon::prelude::*;

use crate::geometry::Strands;
use crate::task::{Cancelled, Task};

/// Strands per unit of parallel work: some hundred thousand bytes of output, so scheduling costs nothing.
const BLOCK: usize = 256;

/// Some consecutive strands with the nodes that are kept of them.
#[derive(Clone, Debug)]
pub(super) struct Block {
    /// Index of the first strand.
    pub first: usize,
    /// Indices into [`Strands::points`], strand after strand; the first and the last node of a strand are kept.
    pub nodes: Vec<u32>,
    /// Per strand: where it ends in `nodes`.
    pub ends: Vec<u32>,
}

impl Block {
    /// The strands with their kept nodes: (index of the strand, indices into [`Strands::points`]).
    pub fn strands(&self) -> impl Iterator<Item = (usize, &[u32])> {
        let mut start = 0;
        self.ends.iter().enumerate().map(move |(k, &end)| {
            let nodes = &self.nodes[start..end as usize];
            start = end as usize;
            (self.first + k, nodes)
        })
    }
}

/// Reduces every strand so that no point of it is farther than `tolerance` (cm) from the reduced polyline, at rest and at
/// all `frames` of the same topology: what is straight at rest may bend.
pub(super) fn reduce(
    strands: &Strands,
    frames: &[&Strands],
    tolerance: f32,
    task: &Task,
) -> Result<Vec<Block>, Cancelled> {
    let count = strands.count();
    (0..count.div_ceil(BLOCK))
        .into_par_iter()
        .map(|b| {
            task.check()?;
            let range = b * BLOCK..((b + 1) * BLOCK).min(count);
            let mut block = Block { first: range.start, nodes: Vec::new(), ends: Vec::with_capacity(range.len()) };
            let mut scratch = Scratch::default();
            for i in range {
                let poses = || std::iter::once(strands).chain(frames.iter().copied()).map(|s| s.strand(i));
                keep(poses, tolerance, strands.offsets[i], &mut scratch, &mut block.nodes);
                block.ends.push(block.nodes.len() as u32);
            }
            Ok(block)
        })
        .collect()
}

#[derive(Default)]
struct Scratch {
    /// Ends of the stretches still to be looked at, nearest to the root last.
    stack: Vec<usize>,
}

/// Douglas and Peucker 1973 in space: a stretch is replaced by its chord when every node between lies within
/// `tolerance` of the chord, else it is split at the farthest node. The distance is to the chord as a *segment*: where
/// a strand turns back, the distance to the line would be too small. Segments are convex, so what holds for the nodes
/// of a stretch holds for all its points.
fn keep<'a, I: Iterator<Item = &'a [Vec3]>>(
    poses: impl Fn() -> I,
    tolerance: f32,
    offset: u32,
    scratch: &mut Scratch,
    out: &mut Vec<u32>,
) {
    let limit = tolerance * tolerance;
    let count = poses().next().map_or(2, <[Vec3]>::len);
    let mut from = 0;
    out.push(offset);
    scratch.stack.clear();
    scratch.stack.push(count - 1);
    while let Some(&to) = scratch.stack.last() {
        let (mut worst, mut split) = (limit, None);
        for points in poses() {
            let (a, chord) = (points[from], points[to] - points[from]);
            let squared = chord.length_squared();
            let inverse = if squared > 0.0 { 1.0 / squared } else { 0.0 };
            for (k, &p) in points.iter().enumerate().take(to).skip(from + 1) {
                let offset = p - a;
                let t = (offset.dot(chord) * inverse).clamp(0.0, 1.0);
                let distance = (offset - chord * t).length_squared();
                if distance > worst {
                    (worst, split) = (distance, Some(k));
                }
            }
        }
        match split {
            Some(k) => scratch.stack.push(k),
            None => {
                out.push(offset + to as u32);
                from = to;
                scratch.stack.pop();
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rng::Key;
    use crate::math::trig;

    fn kept(points: &[Vec3], tolerance: f32) -> Vec<u32> {
        let mut out = Vec::new();
        keep(|| std::iter::once(points), tolerance, 0, &mut Scratch::default(), &mut out);
        out
    }

    fn distance(p: Vec3, a: Vec3, b: Vec3) -> f32 {
        let d = b - a;
        let t = if d == Vec3::ZERO { 0.0 } else { ((p - a).dot(d) / d.length_squared()).clamp(0.0, 1.0) };
        p.distance(a + d * t)
    }

    /// Greatest distance of densely sampled points of the polyline from the whole reduced polyline.
    fn deviation(points: &[Vec3], kept: &[u32]) -> f32 {
        let mut worst = 0.0_f32;
        for w in points.windows(2) {
            for s in 0..8 {
                let p = w[0].lerp(w[1], s as f32 / 8.0);
                let nearest = kept
                    .windows(2)
                    .map(|k| distance(p, points[k[0] as usize], points[k[1] as usize]))
                    .fold(f32::INFINITY, f32::min);
                worst = worst.max(nearest);
            }
        }
        worst
    }

    #[test]
    fn deviation_stays_below_the_tolerance() {
        for seed in 0..200_u64 {
            let key = Key::new(seed, "polyline");
            let mut p = Vec3::ZERO;
            let points: Vec<Vec3> = (0..2 + seed % 70)
                .map(|i| {
                    p += key.with(i).direction() * 0.3 + Vec3::X * 0.3;
                    p
                })
                .collect();
            for tolerance in [0.0, 0.01, 0.1, 0.5, 10.0] {
                let kept = kept(&points, tolerance);
                assert_eq!((kept[0], kept[kept.len() - 1] as usize), (0, points.len() - 1));
                assert!(kept.windows(2).all(|w| w[0] < w[1]));
                let worst = deviation(&points, &kept);
                assert!(worst <= tolerance * 1.0001 + 1e-5, "{worst} > {tolerance} for seed {seed}");
            }
        }
    }

    #[test]
    fn straight_strands_keep_two_nodes_and_curls_keep_many() {
        let straight: Vec<Vec3> = (0..64).map(|i| Vec3::new(0.0, -(i as f32), 0.0)).collect();
        // Not 0: rounding moves nodes off their chord.
        assert_eq!(kept(&straight, 1e-5), [0, 63]);
        let curl: Vec<Vec3> = (0..64)
            .map(|i| {
                let a = i as f32 * 0.4;
                Vec3::new(trig::cos(a), -0.2 * i as f32, trig::sin(a))
            })
            .collect();
        assert!(kept(&curl, 0.02).len() > 40);
        assert!(kept(&curl, 0.2).len() < 32);
        assert_eq!(kept(&curl, 0.0).len(), 64);
    }

    #[test]
    fn what_bends_in_a_frame_keeps_its_nodes() {
        let straight: Vec<Vec3> = (0..9).map(|i| Vec3::Y * i as f32).collect();
        let bent: Vec<Vec3> = straight.iter().map(|p| *p + Vec3::X * (4.0 - p.y).abs()).collect();
        let mut out = Vec::new();
        keep(|| [&straight[..], &bent[..]].into_iter(), 0.1, 0, &mut Scratch::default(), &mut out);
        assert_eq!(out, [0, 4, 8]);
    }

    #[test]
    fn turning_back_is_kept() {
        // Measured against the line instead of the segment, the far point would vanish.
        let hook = [Vec3::ZERO, Vec3::X * 3.0, Vec3::X];
        assert_eq!(kept(&hook, 0.1), [0, 1, 2]);
        let spike = [Vec3::ZERO, Vec3::Y, Vec3::ZERO];
        assert_eq!(kept(&spike, 0.1), [0, 1, 2]);
        assert_eq!(kept(&[Vec3::ONE; 5], 0.0), [0, 4]);
    }

    #[test]
    fn blocks_hold_every_strand_in_order() {
        let mut strands = Strands::new();
        for i in 0..600_u64 {
            let root = crate::geometry::Root {
                id: i,
                position: Vec3::ZERO,
                normal: Vec3::Y,
                uv: glam::Vec2::ZERO,
                triangle: 0,
            };
            strands.push(root, 0, (0..2 + i % 5).map(|k| Vec3::new((k * k) as f32, k as f32, i as f32)));
        }
        let blocks = reduce(&strands, &[], 0.0, &Task::new()).unwrap();
        let all: Vec<(usize, Vec<u32>)> =
            blocks.iter().flat_map(|b| b.strands().map(|(i, n)| (i, n.to_vec()))).collect();
        assert_eq!(all.len(), 600);
        for (k, (i, nodes)) in all.iter().enumerate() {
            let range = strands.range(k);
            assert_eq!(*i, k);
            assert_eq!(*nodes, (range.start as u32..range.end as u32).collect::<Vec<_>>());
        }
        let task = Task::new();
        task.cancel();
        assert_eq!(reduce(&strands, &[], 0.0, &task).unwrap_err(), Cancelled);
    }
}
