//! The head as strands in motion feel it: distances on a grid.
//!
//! Exact distances to a mesh take a microsecond each; a grid answers in a few nanoseconds, to some hundredths of a
//! millimetre over a skull. It is only for the way: finished frames are cleared against the mesh itself.

use glam::Vec3;
use rayon::prelude::*;

use crate::geometry::{Bounds, Solid};

/// Signed distances to a solid at the corners of equal cells, mixed between them in proportion.
pub struct Skin {
    bounds: Bounds,
    /// Cells in a centimetre.
    fine: f32,
    counts: [usize; 3],
    distances: Vec<f32>,
}

impl std::fmt::Debug for Skin {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Skin({:?})", self.counts)
    }
}

impl Skin {
    /// Cells along the longest side.
    const LONGEST: f32 = 96.0;
    /// How far around the solid the grid goes, cm.
    const AROUND: f32 = 1.5;

    /// Asks the solid at every corner. Where it is far away a bound on the distance does.
    pub fn new(solid: &Solid) -> Self {
        let bounds = solid.bounds().grown(Self::AROUND);
        let size = bounds.size().max_element() / Self::LONGEST;
        let counts = bounds.size().to_array().map(|s| (s / size).ceil() as usize + 2);
        let distances = (0..counts.iter().product()).into_par_iter().map(|i: usize| {
            let (x, y, z) = (i % counts[0], i / counts[0] % counts[1], i / counts[0] / counts[1]);
            let p = bounds.min + Vec3::new(x as f32, y as f32, z as f32) * size;
            let clearance = solid.clearance(p);
            // Far enough from the surface that no cell next to it is asked for a direction.
            if clearance > 4.0 * size { clearance } else { solid.signed_distance(p) }
        });
        Self { bounds, fine: 1.0 / size, counts, distances: distances.collect() }
    }

    /// The distance from `p` to the surface, negative inside, and how it changes with the place. Outside of the grid
    /// there is a lower bound, and no change.
    #[inline]
    pub fn at(&self, p: Vec3) -> (f32, Vec3) {
        let q = (p - self.bounds.min) * self.fine;
        let limit = Vec3::new(self.counts[0] as f32, self.counts[1] as f32, self.counts[2] as f32) - 1.001;
        if !(q.cmpge(Vec3::ZERO).all() && q.cmple(limit).all()) {
            let out = (p - p.clamp(self.bounds.min, self.bounds.max)).length();
            return (Self::AROUND.min(1.0) + out, Vec3::ZERO);
        }
        let (x, y, z) = (q.x as usize, q.y as usize, q.z as usize);
        let (u, v, w) = (q.x - x as f32, q.y - y as f32, q.z - z as f32);
        let [nx, ny, _] = self.counts;
        let i = x + nx * (y + ny * z);
        let d = |k: usize| self.distances[k];
        let (a, b, c, e) = (i, i + nx, i + nx * ny, i + nx * ny + nx);
        let (d00, d10, d01, d11) =
            ((d(a), d(a + 1) - d(a)), (d(b), d(b + 1) - d(b)), (d(c), d(c + 1) - d(c)), (d(e), d(e + 1) - d(e)));
        let (e00, e10, e01, e11) = (d00.0 + d00.1 * u, d10.0 + d10.1 * u, d01.0 + d01.1 * u, d11.0 + d11.1 * u);
        let (low, high) = (e00 + (e10 - e00) * v, e01 + (e11 - e01) * v);
        let along = (d00.1 * (1.0 - v) + d10.1 * v) * (1.0 - w) + (d01.1 * (1.0 - v) + d11.1 * v) * w;
        let up = (e10 - e00) * (1.0 - w) + (e11 - e01) * w;
        (low + (high - low) * w, Vec3::new(along, up, high - low) * self.fine)
    }

    /// How much the distance may fall short of what [`Skin::at`] says, cm: half a cell's diagonal.
    pub fn slack(&self) -> f32 {
        0.9 / self.fine
    }

    /// Memory that it takes.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.distances)
    }
}
