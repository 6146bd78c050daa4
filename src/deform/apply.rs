//! Deformers applied to values: points, meshes with their normals, strands with their roots.

use std::sync::Arc;

use glam::{Quat, Vec3};
use rayon::prelude::*;

use super::{Cage, DeformError, Lattice, Pins, Warp};
use crate::geometry::{Mesh, Strands};
use crate::math::{Digest, trig};
use crate::task::Task;

/// Anything that says where every place goes.
#[derive(Clone, Debug)]
pub enum Deformer {
    /// A grid of control points.
    Lattice(Arc<Lattice>),
    /// A closed surface of control points.
    Cage(Arc<Cage>),
    /// Fixed and operated points.
    Pins(Arc<Pins>),
    /// A smooth motion through pairs of places.
    Warp(Arc<Warp>),
}

impl Deformer {
    /// Moves `points` to `out`, of the same length.
    ///
    /// # Errors
    /// Cancelling.
    pub fn apply(&self, points: &[Vec3], out: &mut [Vec3], task: &Task) -> Result<(), DeformError> {
        match self {
            Self::Lattice(lattice) => lattice.apply(points, out, task),
            Self::Cage(cage) => cage.apply(points, out, task),
            Self::Pins(pins) => pins.apply(points, out, task),
            Self::Warp(warp) => warp.apply(points, out, task),
        }
    }

    /// Feeds all of it to a key.
    pub fn digest(&self, into: &mut Digest) {
        match self {
            Self::Lattice(lattice) => lattice.digest(into),
            Self::Cage(cage) => cage.digest(into),
            Self::Pins(pins) => pins.digest(into),
            Self::Warp(warp) => warp.digest(into),
        }
    }
}

/// What of a hairstyle takes part in a deformation.
#[derive(Clone, Copy, Debug)]
pub struct Hold<'a> {
    /// Length along every strand, from its root, over which the motion comes in, cm. With 0 the roots move as well.
    pub root: f32,
    /// Per strand whether it takes part; empty for all.
    pub which: &'a [bool],
}

impl Default for Hold<'_> {
    /// Everything, roots as well.
    fn default() -> Self {
        Self { root: 0.0, which: &[] }
    }
}

impl Hold<'_> {
    /// How much of the motion a node takes that is `along` cm from its root.
    pub fn share(&self, along: f32) -> f32 {
        if self.root > 0.0 { trig::smoothstep(0.0, self.root, along) } else { 1.0 }
    }

    fn takes(&self, strand: usize) -> bool {
        self.which.is_empty() || self.which[strand]
    }
}

/// All of them one after the other, each applied to what the one before it gave.
///
/// # Errors
/// Cancelling.
pub fn points(points: &[Vec3], by: &[Deformer], task: &Task) -> Result<Vec<Vec3>, DeformError> {
    all(points.to_vec(), by, task)
}

/// The same without a copy at the beginning.
///
/// # Errors
/// Cancelling.
pub fn all(mut points: Vec<Vec3>, by: &[Deformer], task: &Task) -> Result<Vec<Vec3>, DeformError> {
    let mut next = vec![Vec3::ZERO; points.len()];
    for (i, deformer) in by.iter().enumerate() {
        task.progress("deform", i as f32 / by.len() as f32);
        deformer.apply(&points, &mut next, task)?;
        std::mem::swap(&mut points, &mut next);
    }
    Ok(points)
}

/// A surface moved. Normals turn with the surface; where no triangle around a vertex has moved they keep their bits.
///
/// # Errors
/// Cancelling.
pub fn mesh(mesh: &Mesh, by: &[Deformer], task: &Task) -> Result<Mesh, DeformError> {
    Ok(turned(mesh, points(&mesh.positions, by, task)?))
}

/// The same surface with other positions: given normals are turned as the surface has turned at each vertex, so that
/// hard edges stay hard.
pub fn turned(mesh: &Mesh, positions: Vec<Vec3>) -> Mesh {
    let mut moved = Mesh { positions, ..mesh.clone() };
    if mesh.normals.is_empty() || moved.positions == mesh.positions {
        return moved;
    }
    let smooth = |of: &Mesh| {
        let mut of = Mesh { positions: of.positions.clone(), triangles: of.triangles.clone(), ..Mesh::default() };
        of.compute_normals();
        of.normals
    };
    let (before, after) = (smooth(mesh), smooth(&moved));
    for (v, normal) in moved.normals.iter_mut().enumerate() {
        if before[v] != after[v] {
            *normal = (arc(before[v], after[v]) * *normal).normalize_or(after[v]);
        }
    }
    moved
}

/// The shortest turn between unit vectors, exact for very small turns as well.
fn arc(from: Vec3, to: Vec3) -> Quat {
    let (axis, w) = (from.cross(to), 1.0 + from.dot(to));
    if w > 1e-4 { Quat::from_xyzw(axis.x, axis.y, axis.z, w).normalize() } else { Quat::from_rotation_arc(from, to) }
}

/// Hair moved, with its roots held as `hold` says.
///
/// # Errors
/// Cancelling.
pub fn strands(strands: &Strands, by: &[Deformer], hold: &Hold, task: &Task) -> Result<Strands, DeformError> {
    let moved = points(&strands.points, by, task)?;
    let mut out = strands.clone();
    let mut rest = out.points.as_mut_slice();
    let mut pieces = Vec::with_capacity(strands.count());
    for i in 0..strands.count() {
        let (piece, after) = std::mem::take(&mut rest).split_at_mut(strands.range(i).len());
        pieces.push(piece);
        rest = after;
    }
    pieces.into_par_iter().enumerate().for_each(|(i, nodes)| {
        if !hold.takes(i) {
            return;
        }
        let (from, to) = (strands.strand(i), &moved[strands.range(i)]);
        let mut along = 0.0;
        for k in 0..nodes.len() {
            if k > 0 {
                along += from[k].distance(from[k - 1]);
            }
            let by = to[k] - from[k];
            if to[k] != from[k] {
                let share = hold.share(along);
                nodes[k] = if share >= 1.0 { to[k] } else { from[k] + by * share };
            }
        }
    });
    if hold.root <= 0.0 {
        for (i, root) in out.roots.iter_mut().enumerate() {
            if hold.takes(i) {
                root.position = moved[strands.range(i).start];
            }
        }
    }
    Ok(out)
}
