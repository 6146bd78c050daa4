//! Which triangle is nearest in each sample.

use glam::Vec3;
use rayon::prelude::*;

use super::Toon;

/// No triangle.
pub(super) const NONE: u32 = u32::MAX;
/// Triangles that are sorted into bands together.
const CHUNK: usize = 1 << 13;

/// All surfaces as one view sees them, in bands of rows.
pub(super) struct Screen<'a> {
    toon: &'a Toon,
    /// Per vertex: in samples to the right and downward, and depth.
    pub(super) points: Vec<Vec3>,
    pub(super) width: usize,
    pub(super) height: usize,
    rows: usize,
    /// Per chunk of triangles and band: those that may be seen there.
    bins: Vec<Vec<Vec<u32>>>,
}

/// A band of rows with what is nearest; some rows of the next one may follow.
pub(super) struct Nearest {
    /// First row of the band.
    pub(super) top: usize,
    /// Rows of the band.
    pub(super) rows: usize,
    /// Rows with those that follow.
    pub(super) all: usize,
    pub(super) depth: Vec<f32>,
    pub(super) owner: Vec<u32>,
}

impl<'a> Screen<'a> {
    /// The sides of locks that face away are left out: locks are closed. Other bodies may be open.
    pub(super) fn new(
        toon: &'a Toon,
        width: usize,
        height: usize,
        rows: usize,
        project: impl Fn(Vec3) -> Vec3 + Sync,
    ) -> Self {
        let points: Vec<Vec3> = toon.vertices.par_iter().with_min_len(1 << 12).map(|v| project(v.position)).collect();
        let bands = height.div_ceil(rows);
        let bins = toon
            .triangles
            .par_chunks(CHUNK)
            .enumerate()
            .map(|(chunk, triangles)| {
                let mut bins = vec![Vec::new(); bands];
                for (i, t) in triangles.iter().enumerate() {
                    let index = (chunk * CHUNK + i) as u32;
                    let [a, b, c] = corners(&points, t);
                    let (lo, hi) = (a.min(b).min(c), a.max(b).max(c));
                    let seen = lo.x < width as f32 && lo.y < height as f32 && hi.x > 0.0 && hi.y > 0.0;
                    if !(seen && lo.is_finite() && hi.is_finite()) {
                        continue;
                    }
                    if area(a, b, c) >= 0.0 && !toon.lock(index).skin {
                        continue;
                    }
                    // One row more above: bands look one row ahead.
                    let first = (lo.y - 1.5).max(0.0) as usize / rows;
                    let last = hi.y.min(height as f32 - 1.0) as usize / rows;
                    for bin in &mut bins[first..=last] {
                        bin.push(index);
                    }
                }
                bins
            })
            .collect();
        Self { toon, points, width, height, rows, bins }
    }

    pub(super) fn bands(&self) -> usize {
        self.height.div_ceil(self.rows)
    }

    /// What is nearest in a band and in up to `more` rows after it.
    pub(super) fn nearest(&self, band: usize, more: usize) -> Nearest {
        let top = band * self.rows;
        let rows = self.rows.min(self.height - top);
        let all = (rows + more).min(self.height - top);
        let mut depth = vec![f32::NEG_INFINITY; self.width * all];
        let mut owner = vec![NONE; self.width * all];
        for &t in self.bins.iter().flat_map(|bins| &bins[band]) {
            let c = corners(&self.points, &self.toon.triangles[t as usize]);
            self.cover(c, top, all, |from, z, step| {
                let count = from.len();
                let (near, of) = (&mut depth[from.clone()], &mut owner[from]);
                for k in 0..count {
                    let z = z + step * k as f32;
                    let nearer = z > near[k];
                    near[k] = if nearer { z } else { near[k] };
                    of[k] = if nearer { t } else { of[k] };
                }
            });
        }
        Nearest { top, rows, all, depth, owner }
    }

    /// Runs over the samples inside a triangle row by row: the samples (counted from row `top`), the first's depth, and
    /// its growth. Neighbours share edges without gap or overlap: every edge is followed from its upper end.
    #[inline]
    fn cover(&self, c: [Vec3; 3], top: usize, rows: usize, mut run: impl FnMut(std::ops::Range<usize>, f32, f32)) {
        let [mut a, mut b, mut d] = c;
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
        let first = ceil(a.y - 0.5).max(top);
        let end = ceil(d.y - 0.5).min(top + rows);
        if first >= end {
            return;
        }
        let per_row = |p: Vec3, q: Vec3| (q.x - p.x) / (q.y - p.y);

        let (long, upper, lower) = (per_row(a, d), per_row(a, b), per_row(b, d));
        let (least, most) = (a.z.min(b.z).min(d.z), a.z.max(b.z).max(d.z));
        for y in first..end {
            let at = y as f32 + 0.5;
            let x = a.x + (at - a.y) * long;
            let other = if at < b.y { a.x + (at - a.y) * upper } else { b.x + (at - b.y) * lower };
            let (from, to) = (ceil(x.min(other) - 0.5), ceil(x.max(other) - 0.5).min(self.width));
            if from >= to {
                continue;
            }
            let left = from as f32 + 0.5;
            let z = a.z + slope.0 * (left - a.x) + slope.1 * (at - a.y);
            // Slivers seen edge-on: rounding must not throw them to the front.
            let span = (to - from - 1) as f32 * slope.0;
            let row = (y - top) * self.width;
            if z < least || z > most || z + span < least || z + span > most {
                for i in from..to {
                    let z = (z + (i - from) as f32 * slope.0).clamp(least, most);
                    run(row + i..row + i + 1, z, 0.0);
                }
            } else {
                run(row + from..row + to, z, slope.0);
            }
        }
    }
}

/// The least whole number not under `x`; 0 below 0.
#[inline(always)]
fn ceil(x: f32) -> usize {
    let whole = x.max(0.0) as i32;
    (whole + i32::from((whole as f32) < x)) as usize
}

#[inline]
pub(super) fn corners(points: &[Vec3], t: &[u32; 3]) -> [Vec3; 3] {
    [points[t[0] as usize], points[t[1] as usize], points[t[2] as usize]]
}

/// Twice the area in the picture, negative for triangles that face the viewer.
#[inline]
pub(super) fn area(a: Vec3, b: Vec3, c: Vec3) -> f32 {
    (b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y)
}

/// Growth of depth per sample to the right and downward; `None` for a triangle seen edge-on.
#[inline]
pub(super) fn gradient(a: Vec3, b: Vec3, c: Vec3) -> Option<(f32, f32)> {
    let whole = area(a, b, c);
    if whole.abs() < 1e-7 {
        return None;
    }
    let (p, q) = (b - a, c - a);
    Some(((p.z * q.y - q.z * p.y) / whole, (p.x * q.z - q.x * p.z) / whole))
}
