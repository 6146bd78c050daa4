//! Which triangle is nearest in each sample.

use glam::Vec3;
use rayon::prelude::*;

use super::Toon;
use crate::render::scan::{area, cover, scan};

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
            scan(
                c,
                top..top + all,
                self.width,
                |_| 0.0,
                |y, range, z, step| {
                    let row = (y - top) * self.width;
                    let range = row + range.start..row + range.end;
                    cover(&mut depth[range.clone()], &mut owner[range], z, step, t);
                },
            );
        }
        Nearest { top, rows, all, depth, owner }
    }
}

#[inline]
pub(super) fn corners(points: &[Vec3], t: &[u32; 3]) -> [Vec3; 3] {
    [points[t[0] as usize], points[t[1] as usize], points[t[2] as usize]]
}
