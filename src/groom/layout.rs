//! Strands of different lengths in one buffer, written by many threads.

use glam::Vec3;
use rayon::prelude::*;

use crate::geometry::Strands;
use crate::task::{Cancelled, Task};

/// The parts of `buffer` that belong to the single strands.
pub fn split<'a, T>(mut buffer: &'a mut [T], offsets: &[u32]) -> Vec<&'a mut [T]> {
    offsets
        .windows(2)
        .map(|w| {
            let (strand, rest) = std::mem::take(&mut buffer).split_at_mut((w[1] - w[0]) as usize);
            buffer = rest;
            strand
        })
        .collect()
}

/// Offsets of strands with these numbers of nodes.
pub fn offsets(counts: impl Iterator<Item = usize>) -> Vec<u32> {
    let mut sum = 0_u32;
    std::iter::once(0)
        .chain(counts.map(|n| {
            sum += n as u32;
            sum
        }))
        .collect()
}

/// Calls `write(scratch, strand, nodes, stages)` for every strand, in parallel; stops early when the task is cancelled
/// and reports progress as `what`.
///
/// Strands whose roots are neighbours follow each other, for they ask for the same guides and the same part of the head:
/// in the order of their numbers, which is all over the head, most of the time would go into fetching these anew.
pub fn write_all<S: Send>(
    strands: &mut Strands,
    task: &Task,
    what: &str,
    scratch: impl Fn() -> S + Sync + Send,
    write: impl Fn(&mut S, usize, &mut [Vec3], &mut [u8]) + Sync + Send,
) -> Result<(), Cancelled> {
    /// Strands per piece of work: a cancel is noticed within a few milliseconds.
    const PIECE: usize = 32;
    /// Pieces between two reports: a listener may be slow.
    const REPORT: usize = 16;
    let n = strands.count();
    let points = split(&mut strands.points, &strands.offsets);
    let stages = split(&mut strands.stage, &strands.offsets);
    let mut work: Vec<(u32, usize, &mut [Vec3], &mut [u8])> = points
        .into_iter()
        .zip(stages)
        .zip(&strands.roots)
        .enumerate()
        .map(|(i, ((points, stages), root))| (along_the_surface(root.position), i, points, stages))
        .collect();
    work.par_sort_unstable_by_key(|w| (w.0, w.1));
    let done = std::sync::atomic::AtomicUsize::new(0);
    work.par_chunks_mut(PIECE).for_each_init(scratch, |scratch, strands| {
        if task.is_cancelled() {
            return;
        }
        for (_, i, points, stages) in strands.iter_mut() {
            write(scratch, *i, points, stages);
        }
        let pieces = done.fetch_add(1, std::sync::atomic::Ordering::Relaxed) + 1;
        if pieces.is_multiple_of(REPORT) {
            task.progress(what, (pieces * PIECE) as f32 / n as f32);
        }
    });
    task.check()
}

/// The place of a point on a curve through all of space that keeps neighbours together (Morton 1966): ten bits of each
/// coordinate in turn, in steps of an eighth of a centimetre.
fn along_the_surface(p: Vec3) -> u32 {
    // Beyond 64 cm all are neighbours; a coordinate that is none counts as the least.
    let spread = |c: f32| {
        let n = ((c + 64.0) * 8.0).clamp(0.0, 1023.0) as u32;
        (0..10).fold(0, |all, bit| all | (n >> bit & 1) << (3 * bit))
    };
    spread(p.x) | spread(p.y) << 1 | spread(p.z) << 2
}

/// Keeps the first `counts[i]` nodes of every strand; a strand of fewer than two nodes goes altogether. `guide` is left
/// to whoever knows what it points at.
pub fn compact(strands: &mut Strands, counts: &[usize]) {
    let (mut to, mut kept) = (0, 0);
    let mut ends = vec![0_u32];
    for (i, &count) in counts.iter().enumerate() {
        if count < 2 {
            continue;
        }
        let from = strands.offsets[i] as usize;
        strands.points.copy_within(from..from + count, to);
        strands.stage.copy_within(from..from + count, to);
        strands.roots[kept] = strands.roots[i];
        strands.guide[kept] = strands.guide[i];
        strands.source[kept] = strands.source[i];
        to += count;
        kept += 1;
        ends.push(to as u32);
    }
    strands.points.truncate(to);
    strands.stage.truncate(to);
    strands.roots.truncate(kept);
    strands.guide.truncate(kept);
    strands.source.truncate(kept);
    strands.offsets = ends;
}
