//! Triangles into rows of samples.

use std::ops::Range;

use glam::Vec3;

/// Added to a number of up to four million, it leaves no room for a fraction: the rounded number stands in the lowest bits.
const WHOLE: f32 = 12_582_912.0;

/// Rows that are found together.
const ROWS: usize = 4;

/// How many samples of a row, whose middles lie half a step behind their numbers, come before `x`; at most `most`.
#[inline(always)]
fn before(x: f32, most: f32) -> u32 {
    // Also NaN becomes 0.
    let x = if x > 0.0 { x } else { 0.0 };
    let x = if x < most { x } else { most };
    (x + WHOLE).to_bits() & 0x3f_ffff
}

/// Growth of depth to the right and downward over a triangle; `None` for one seen edge-on.
#[inline]
pub fn gradient(a: Vec3, b: Vec3, c: Vec3) -> Option<(f32, f32)> {
    let whole = area(a, b, c);
    if whole.abs() < 1e-7 || whole.is_nan() {
        return None;
    }
    let (p, q, share) = (b - a, c - a, 1.0 / whole);
    Some(((p.z * q.y - q.z * p.y) * share, (p.x * q.z - q.x * p.z) * share))
}

/// Twice the area in the picture, negative for triangles that face the viewer.
#[inline]
pub fn area(a: Vec3, b: Vec3, c: Vec3) -> f32 {
    (b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y)
}

/// Runs over the samples inside a triangle, row by row: calls `run` with the row, its samples, the depth at the first, and
/// its growth from each to the next. Sample i of row j lies at (i + 0.5 + `shift`(j), j + 0.5). Neighbouring triangles share
/// an edge without gap or overlap: every edge is followed from its upper end.
///
/// `rows` are looked at, each of `width` samples, both at most four million.
#[inline(always)]
pub fn scan(
    corners: [Vec3; 3],
    rows: Range<usize>,
    width: usize,
    shift: impl Fn(usize) -> f32,
    mut run: impl FnMut(usize, Range<usize>, f32, f32),
) {
    let [mut a, mut b, mut d] = corners;
    // Most triangles of a small picture lie between two rows.
    let (low, high) = (a.y.min(b.y).min(d.y), a.y.max(b.y).max(d.y));
    let (first, end) = (before(low, rows.end as f32) as usize, before(high, rows.end as f32) as usize);
    let first = first.max(rows.start);
    if first >= end {
        return;
    }
    let Some(slope) = gradient(a, b, d) else { return };
    if b.y < a.y {
        std::mem::swap(&mut a, &mut b);
    }
    if d.y < a.y {
        std::mem::swap(&mut a, &mut d);
    }
    if d.y < b.y {
        std::mem::swap(&mut b, &mut d);
    }
    let per_row = |p: Vec3, q: Vec3| (q.x - p.x) / (q.y - p.y);
    let (long, upper, lower) = (per_row(a, d), per_row(a, b), per_row(b, d));
    let (least, most) = (a.z.min(b.z).min(d.z), a.z.max(b.z).max(d.z));
    let columns = width as f32;
    // Several rows at once, without branches, so that they become vector instructions.
    for top in (first..end).step_by(ROWS) {
        let (mut from, mut to, mut z, mut last) = ([0_i32; ROWS], [0_i32; ROWS], [0.0_f32; ROWS], [0.0_f32; ROWS]);
        for k in 0..ROWS {
            let (at, shift) = ((top + k) as i32 as f32 + 0.5, shift(top + k));
            let x = a.x + (at - a.y) * long;
            let (over, under) = (a.x + (at - a.y) * upper, b.x + (at - b.y) * lower);
            let other = if at < b.y { over } else { under };
            let (left, right) = if x < other { (x, other) } else { (other, x) };
            (from[k], to[k]) = (before(left - shift, columns) as i32, before(right - shift, columns) as i32);
            z[k] = a.z + slope.0 * (from[k] as f32 + 0.5 + shift - a.x) + slope.1 * (at - a.y);
            last[k] = z[k] + (to[k] - from[k] - 1) as f32 * slope.0;
        }
        for k in 0..ROWS.min(end - top) {
            if from[k] >= to[k] {
                continue;
            }
            let (y, range, z, last) = (top + k, from[k] as usize..to[k] as usize, z[k], last[k]);
            // Slivers seen edge-on: rounding must not throw them to the front.
            if z < least || z > most || last < least || last > most {
                for i in range.clone() {
                    let z = (z + (i - range.start) as f32 * slope.0).clamp(least, most);
                    run(y, i..i + 1, z, 0.0);
                }
            } else {
                run(y, range, z, slope.0);
            }
        }
    }
}

/// Notes the triangle `owner` for those samples of a row that it is nearest in.
#[inline(always)]
pub fn cover(near: &mut [f32], of: &mut [u32], z: f32, step: f32, owner: u32) {
    let count = near.len();
    let of = &mut of[..count];
    for k in 0..count {
        let z = z + step * k as f32;
        let nearer = z > near[k];
        near[k] = if nearer { z } else { near[k] };
        of[k] = if nearer { owner } else { of[k] };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rng::Key;

    #[test]
    fn neighbours_share_samples_without_gap_or_overlap() {
        // A fan about a point: every sample of the square it fills belongs to one triangle, at that one's depth.
        let key = Key::new(3, "scan");
        for turn in 0..40 {
            let key = key.with(turn);
            let middle = Vec3::new(key.range(6.0, 18.0), key.with(1).range(6.0, 18.0), 3.0);
            let ring = [(0.0, 0.0), (9.3, 0.0), (24.0, 0.0), (24.0, 24.0), (11.5, 24.0), (0.0, 24.0)];
            let at = |i: usize| Vec3::new(ring[i % 6].0, ring[i % 6].1, 1.0);
            for shift in [0.0, -0.125, 0.375] {
                let mut seen = [0; 24 * 24];
                for i in 0..6 {
                    scan(
                        [middle, at(i), at(i + 1)],
                        0..24,
                        24,
                        |_| shift,
                        |y, range, z, step| {
                            for x in range.clone() {
                                seen[y * 24 + x] += 1;
                                let z = z + step * (x - range.start) as f32;
                                assert!((1.0..=3.0).contains(&z), "{z}");
                            }
                        },
                    );
                }
                let count = seen.iter().filter(|&&n| n == 1).count();
                assert!(seen.iter().all(|&n| n <= 1) && count >= 23 * 24, "{count} of {}", 24 * 24);
            }
        }
    }

    #[test]
    fn triangles_that_are_none_or_far_off_are_left_out() {
        let far = Vec3::splat(1e30);
        for corners in
            [[Vec3::ZERO; 3], [Vec3::NAN; 3], [far, -far, far * Vec3::X], [far, far + Vec3::X, far + Vec3::Y]]
        {
            let (mut near, mut of) = ([0.0; 8], [0; 8]);
            scan(
                corners,
                0..8,
                8,
                |_| 0.0,
                |y, range, z, step| {
                    assert!(y < 8);
                    cover(&mut near[range.clone()], &mut of[range], z, step, 1);
                },
            );
            assert!(near.iter().all(|z| !z.is_nan()));
        }
    }
}
