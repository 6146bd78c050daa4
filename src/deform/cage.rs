//! Cages: a closed surface of scattered control points; what is inside follows them.
//!
//! The paper wishes for free-form deformation without a grid. Here the control points are the corners of a closed cage of
//! triangles, and a place inside moves by the mean of their motions, weighted by its mean-value coordinates (Ju, Schaefer,
//! Warren 2005): smooth inside, linear on every triangle, 1 at its own corner, exact for affine motions.
//! `docs/methods/deform.md` compares them with what else there is.

use std::collections::BTreeMap;

use glam::{DMat3, DVec3, Vec3};
use rayon::prelude::*;

use super::controls::Controls;
use super::kernel;
use super::mean::{self, Shell};
use super::shell::{self, Faces};
use super::{DeformError, Folded, Move, PointKind, dense};
use crate::geometry::Mesh;
use crate::math::Digest;
use crate::task::Task;

/// Points that are moved between two looks at the task.
const PIECE: usize = 2048;

/// A closed surface of control points.
#[derive(Clone, Debug, PartialEq)]
pub struct Cage {
    controls: Controls,
    names: Vec<Option<String>>,
    /// Faces with three or more corners. A face with more has one more corner in its middle, which is no control point:
    /// it stands at the mean of the others.
    faces: Vec<Vec<u32>>,
}

impl Cage {
    /// Through scattered points, with or without a name, that lie around their middle: each is a control point.
    ///
    /// # Errors
    /// Too few or too many points, two in one direction from the middle, or none on one side of it; a name twice.
    pub fn through(points: Vec<(Option<String>, Vec3)>) -> Result<Self, DeformError> {
        let (names, places): (Vec<_>, Vec<_>) = points.into_iter().unzip();
        let mut known = BTreeMap::new();
        for (i, name) in names.iter().enumerate() {
            if let Some(name) = name
                && let Some(first) = known.insert(name.clone(), i)
            {
                let (first, second) = (format!("point {}", first + 1), format!("point {}", i + 1));
                return Err(DeformError::SameName { first, second, name: name.clone() });
            }
        }
        let called = |i: usize| called(&names, i);
        let faces = shell::through(places, &called)?;
        Ok(Self { names, ..Self::of_faces(faces) })
    }

    /// Around points: a box with divided sides that is drawn in to them.
    ///
    /// # Errors
    /// No points, divisions out of 1 to 8.
    pub fn around(places: &[Vec3], divisions: u32, margin: f32) -> Result<Self, DeformError> {
        Ok(Self::of_faces(shell::around(places, divisions, margin)?))
    }

    /// A closed mesh.
    ///
    /// # Errors
    /// A mesh that is open, turned different ways, too large, or has triangles without an area.
    pub fn of(mesh: &Mesh) -> Result<Self, DeformError> {
        Ok(Self::of_faces(shell::of(mesh)?))
    }

    fn of_faces(Faces { points, faces }: Faces) -> Self {
        let count = points.len();
        Self { controls: Controls::new(points), names: vec![None; count], faces }
    }

    /// How many control points there are.
    pub fn count(&self) -> usize {
        self.controls.rest.len()
    }

    /// Where a control point was at first.
    pub fn rest(&self, index: usize) -> Vec3 {
        self.controls.rest[index]
    }

    /// Where a control point stands now.
    pub fn place(&self, index: usize) -> Vec3 {
        self.controls.place(index)
    }

    /// What a control point is for.
    pub fn kind(&self, index: usize) -> PointKind {
        self.controls.kinds[index]
    }

    /// The name of a control point.
    pub fn name(&self, index: usize) -> Option<&str> {
        self.names[index].as_deref()
    }

    /// Points of the object that are held.
    pub fn held(&self) -> &[Vec3] {
        &self.controls.held
    }

    /// The faces, anticlockwise as seen from outside.
    pub fn faces(&self) -> &[Vec<u32>] {
        &self.faces
    }

    /// True when no control point has moved.
    pub fn is_still(&self) -> bool {
        self.controls.is_still()
    }

    /// The number of a named control point.
    ///
    /// # Errors
    /// A name that none has.
    pub fn named(&self, name: &str) -> Result<u32, DeformError> {
        let found = self.names.iter().position(|n| n.as_deref() == Some(name));
        found.map(|i| i as u32).ok_or_else(|| DeformError::Unknown {
            what: "control point",
            name: name.to_owned(),
            known: self.names.iter().flatten().cloned().collect(),
        })
    }

    /// With another kind for these control points.
    #[must_use]
    pub fn marked(mut self, points: &[u32], kind: PointKind) -> Self {
        self.controls.mark(points, kind);
        self
    }

    /// With these control points moved from where they stand; those that are fixed stay.
    ///
    /// # Errors
    /// When all of them are fixed, or one would end where numbers end.
    pub fn moved(self, points: &[u32], by: &Move) -> Result<Self, DeformError> {
        let middle = self.controls.middle(points);
        self.placed(points, |_, p| by.of(p, middle))
    }

    /// With these control points where `place` puts them; it is told the number and where the point stands.
    ///
    /// # Errors
    /// As [`Cage::moved`].
    pub fn placed(mut self, points: &[u32], place: impl FnMut(u32, Vec3) -> Vec3) -> Result<Self, DeformError> {
        self.controls.put(points, |i| called(&self.names, i), place)?;
        Ok(self)
    }

    /// With points of the object that stay where they are, as [`Lattice::holding`](super::Lattice::holding).
    ///
    /// # Errors
    /// A point that is not finite, an exponent out of 0.5 to 8.
    pub fn holding(mut self, points: &[Vec3], power: f32) -> Result<Self, DeformError> {
        self.controls.hold(points, power)?;
        Ok(self)
    }

    /// The next step: overall control points follow the feature points, pulled back by the fixed ones.
    ///
    /// # Errors
    /// As [`Pins::new`](super::Pins::new).
    pub fn followed(mut self, power: f32) -> Result<Self, DeformError> {
        self.controls.follow(power, |i| called(&self.names, i))?;
        Ok(self)
    }

    /// Corners with the middles of faces, how far each has moved, and triangles.
    fn triangulated(&self) -> (Vec<Vec3>, Vec<Vec3>, Vec<[u32; 3]>) {
        let (mut at, mut by, mut triangles) = (self.controls.rest.clone(), self.controls.moves.clone(), vec![]);
        for ring in &self.faces {
            if let &[a, b, c] = ring.as_slice() {
                triangles.push([a, b, c]);
                continue;
            }
            let mean = |of: &[Vec3]| {
                (ring.iter().map(|&v| of[v as usize].as_dvec3()).sum::<DVec3>() / ring.len() as f64).as_vec3()
            };
            let middle = at.len() as u32;
            let (place, motion) = (mean(&self.controls.rest), mean(&self.controls.moves));
            at.push(place);
            by.push(motion);
            triangles.extend((0..ring.len()).map(|k| [ring[k], ring[(k + 1) % ring.len()], middle]));
        }
        (at, by, triangles)
    }

    fn shell(&self) -> Shell {
        let (at, by, triangles) = self.triangulated();
        Shell::new(&at, &by, &triangles)
    }

    /// Which places are inside or on the surface: what the cage can move.
    pub fn contains(&self, places: &[Vec3]) -> Vec<bool> {
        let shell = self.shell();
        places.par_chunks(PIECE).flat_map_iter(|piece| mean::inside(&shell, piece)).collect()
    }

    /// Where one place goes.
    pub fn at(&self, p: Vec3) -> Vec3 {
        let mut out = [p];
        let _ = self.apply(&[p], &mut out, &Task::new());
        out[0]
    }

    /// Moves `points` to `out`, of the same length. What is outside stays to the bit; a control point goes exactly to its
    /// place.
    ///
    /// # Errors
    /// Cancelling.
    pub fn apply(&self, points: &[Vec3], out: &mut [Vec3], task: &Task) -> Result<(), DeformError> {
        if self.is_still() {
            out.copy_from_slice(points);
            return Ok(());
        }
        let shell = self.shell();
        let limit = self.controls.limit();
        points.par_chunks(PIECE).zip(out.par_chunks_mut(PIECE)).try_for_each(|(from, to)| {
            task.check()?;
            mean::cage(&shell, from, to);
            for (p, q) in from.iter().zip(to.iter_mut()).filter(|(p, q)| p != q) {
                if let Some(i) = self.controls.rest.iter().position(|o| o == p) {
                    *q = self.place(i);
                }
            }
            if let Some(limit) = &limit {
                kernel::limit(limit, from, to);
            }
            Ok(())
        })
    }

    /// The triangle of the moved cage that is most turned over against the motion that all of it makes together; `None`
    /// when none is.
    pub fn folded(&self) -> Option<Folded> {
        if self.is_still() {
            return None;
        }
        let (at, by, triangles) = self.triangulated();
        let whole = affine(&self.controls.rest, &self.controls.moves)?;
        let worst = triangles
            .iter()
            .map(|&t| {
                let corners = t.map(|v| at[v as usize].as_dvec3());
                let moved = t.map(|v| (at[v as usize] + by[v as usize]).as_dvec3());
                let area = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a);
                let as_whole = area(corners.map(|p| whole * p)) * whole.determinant().signum();
                (area(moved).normalize_or_zero().dot(as_whole.normalize_or_zero()), t)
            })
            .min_by(|a, b| a.0.total_cmp(&b.0))?;
        let is_inside_out = whole.determinant() <= 0.0;
        (is_inside_out || worst.0 < 0.0).then(|| {
            let corners = worst.1.map(|v| v as usize);
            let points = corners.iter().filter(|&&v| v < self.count()).map(|&v| called(&self.names, v)).collect();
            Folded { points, place: corners.iter().map(|&v| at[v]).sum::<Vec3>() / 3.0 }
        })
    }

    /// How many of these places lie outside, but so near to a moved part of the cage that they are torn from what is
    /// inside: the cage moves farther there than they are away.
    pub fn left_behind(&self, places: &[Vec3]) -> usize {
        if self.is_still() {
            return 0;
        }
        let shell = self.shell();
        let farthest = self.controls.moves.iter().map(|m| m.length()).fold(0.0, f32::max);
        let (low, high) = shell.bounds();
        let (low, high) = (low.as_vec3() - Vec3::splat(farthest), high.as_vec3() + Vec3::splat(farthest));
        places
            .par_chunks(PIECE)
            .map(|piece| {
                let near: Vec<Vec3> =
                    piece.iter().copied().filter(|p| p.cmpge(low).all() && p.cmple(high).all()).collect();
                let inside = mean::inside(&shell, &near);
                let is_torn = |p: DVec3| {
                    let (triangle, weights) = shell.closest(p);
                    shell.on_surface(p).length() > shell.place(triangle, weights).distance(p)
                };
                near.iter().zip(inside).filter(|(p, inside)| !inside && is_torn(p.as_dvec3())).count()
            })
            .sum()
    }

    /// Feeds all of it to a key that has a say in where points go.
    pub fn digest(&self, into: &mut Digest) {
        into.bytes(b"cage 1")
            .vectors(&self.controls.rest)
            .vectors(&self.controls.moves)
            .vectors(&self.controls.held)
            .floats(&[self.controls.power]);
        for ring in &self.faces {
            into.number(ring.len() as u64).numbers(ring);
        }
    }
}

fn called(names: &[Option<String>], index: usize) -> String {
    names[index].as_ref().map_or_else(|| format!("control point {}", index + 1), |n| format!("control point `{n}`"))
}

/// The linear part of the affine motion that is nearest to the motion of points.
fn affine(at: &[Vec3], by: &[Vec3]) -> Option<DMat3> {
    let count = at.len() as f64;
    let middle = at.iter().map(|p| p.as_dvec3()).sum::<DVec3>() / count;
    let mut squares = vec![0.0; 9];
    let mut right = vec![[0.0; 3]; 3];
    for (p, m) in at.iter().zip(by) {
        let (p, m) = ((p.as_dvec3() - middle).to_array(), m.as_dvec3().to_array());
        for i in 0..3 {
            for k in 0..3 {
                squares[3 * i + k] += p[i] * p[k];
                right[i][k] += p[i] * m[k];
            }
        }
    }
    let x = dense::solve(squares, right)?;
    Some(DMat3::from_cols(x[0].into(), x[1].into(), x[2].into()) + DMat3::IDENTITY)
}
