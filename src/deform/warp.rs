//! Warps: a smooth motion of all space that takes given places to given places.
//!
//! Radial functions |x - c| with an affine part (Carr and others 2001): of all interpolants the one that bends least in
//! the sense of the biharmonic energy. It reproduces affine motions, needs no grid, and far away it goes on smoothly,
//! where a lattice ends; so it is what carries hair from one head to another.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::kernel::{self, Radial};
use super::{DeformError, dense};
use crate::math::Digest;
use crate::task::Task;

/// Points that are moved between two looks at the task.
const PIECE: usize = 8192;
/// The most pairs.
const MOST: usize = 1000;

/// A smooth motion through pairs of places.
#[derive(Clone, Debug, PartialEq)]
pub struct Warp {
    pairs: Vec<(Vec3, Vec3)>,
    weights: Vec<Vec3>,
    shift: Vec3,
    rows: [Vec3; 3],
    base: Vec3,
}

impl Warp {
    /// From pairs (place, where it goes), 4 to 1000 of them, that do not lie in a plane.
    ///
    /// # Errors
    /// Pairs that are too few, too many, too close together, flat or not finite.
    pub fn new(pairs: Vec<(Vec3, Vec3)>) -> Result<Self, DeformError> {
        let n = pairs.len();
        if let Some(&(a, b)) = pairs.iter().find(|(a, b)| !a.is_finite() || !b.is_finite()) {
            let value = if a.is_finite() { b } else { a };
            return Err(DeformError::NotFinite { what: "a place".into(), value });
        }
        if n > MOST {
            let (value, low, high) = (n as f64, 4.0, MOST as f64);
            return Err(DeformError::OutOfRange { what: "the number of points".into(), value, low, high });
        }
        if n < 4 {
            return Err(DeformError::Degenerate { count: n });
        }
        for (i, a) in pairs.iter().enumerate() {
            if let Some(k) = pairs[..i].iter().position(|b| b.0.distance(a.0) < 1e-4) {
                let (first, second) = (format!("point {}", k + 1), format!("point {}", i + 1));
                return Err(DeformError::SamePlace { first, second, place: a.0 });
            }
        }
        let base = pairs.iter().map(|p| p.0.as_dvec3()).sum::<DVec3>() / n as f64;
        let from: Vec<DVec3> = pairs.iter().map(|p| p.0.as_dvec3() - base).collect();
        // In units of the size of it all, so that the affine part weighs as much as the rest.
        let size = from.iter().map(|p| p.length()).fold(0.0, f64::max);
        let m = n + 4;
        let mut a = vec![0.0; m * m];
        let mut b = vec![[0.0; 3]; m];
        for i in 0..n {
            for k in 0..n {
                a[i * m + k] = from[i].distance(from[k]) / size;
            }
            for (c, x) in [1.0, from[i].x / size, from[i].y / size, from[i].z / size].into_iter().enumerate() {
                a[i * m + n + c] = x;
                a[(n + c) * m + i] = x;
            }
            b[i] = (pairs[i].1.as_dvec3() - pairs[i].0.as_dvec3()).to_array();
        }
        let x = dense::solve(a, b).ok_or(DeformError::Degenerate { count: n })?;
        let vector = |x: &[f64; 3], by: f64| (DVec3::from_array(*x) * by).as_vec3();
        let weights = x[..n].iter().map(|w| vector(w, 1.0 / size)).collect();
        let linear = [&x[n + 1], &x[n + 2], &x[n + 3]].map(|v| vector(v, 1.0 / size));
        let rows = [0, 1, 2].map(|r| Vec3::new(linear[0][r], linear[1][r], linear[2][r]));
        Ok(Self { weights, shift: vector(&x[n], 1.0), rows, base: base.as_vec3(), pairs })
    }

    /// The pairs.
    pub fn pairs(&self) -> &[(Vec3, Vec3)] {
        &self.pairs
    }

    /// Where one place goes.
    pub fn at(&self, p: Vec3) -> Vec3 {
        let mut out = [p];
        let _ = self.apply(&[p], &mut out, &Task::new());
        out[0]
    }

    /// Moves `points` to `out`, of the same length.
    ///
    /// # Errors
    /// Cancelling.
    pub fn apply(&self, points: &[Vec3], out: &mut [Vec3], task: &Task) -> Result<(), DeformError> {
        if self.pairs.iter().all(|(a, b)| a == b) {
            out.copy_from_slice(points);
            return Ok(());
        }
        let radial = Radial {
            centres: self.pairs.iter().map(|p| p.0).collect(),
            weights: self.weights.clone(),
            shift: self.shift,
            rows: self.rows,
            base: self.base,
        };
        points.par_chunks(PIECE).zip(out.par_chunks_mut(PIECE)).try_for_each(|(from, to)| {
            task.check()?;
            kernel::radial(&radial, from, to);
            Ok(())
        })
    }

    /// Feeds all of it to a key.
    pub fn digest(&self, into: &mut Digest) {
        let (from, to): (Vec<Vec3>, Vec<Vec3>) = self.pairs.iter().copied().unzip();
        into.bytes(b"warp 1").vectors(&from).vectors(&to);
    }
}
