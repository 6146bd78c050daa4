//! Triangle meshes.

use glam::{Affine3A, Vec2, Vec3};

use super::Bounds;
use crate::math::Digest;

/// A named set of triangles: an OBJ group or object, a glTF mesh or material.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Group {
    /// The name as the file or the builder gives it.
    pub name: String,
    /// Indices into [`Mesh::triangles`], ascending.
    pub triangles: Vec<u32>,
}

/// A triangle mesh. Counter-clockwise triangles face outward.
///
/// `normals` and `uvs` are either empty or one per position. Where uv or normals have a seam, positions repeat:
/// [`Solid`](super::Solid) and everything that asks for topology welds equal positions first.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Vertex positions in cm.
    pub positions: Vec<Vec3>,
    /// Three indices into `positions` each.
    pub triangles: Vec<[u32; 3]>,
    /// Unit normals, one per position, or empty.
    pub normals: Vec<Vec3>,
    /// Texture coordinates, one per position (v up), or empty.
    pub uvs: Vec<Vec2>,
    /// Named parts; a triangle may be in several or in none.
    pub groups: Vec<Group>,
}

/// Why a [`Mesh`] is not one.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MeshError {
    /// No triangle at all.
    #[error("the mesh has no triangles")]
    Empty,
    /// A coordinate is NaN or infinite.
    #[error("vertex {vertex} is not finite: `{position}`")]
    NotFinite {
        /// Index into `positions`.
        vertex: usize,
        /// Its value.
        position: Vec3,
    },
    /// A triangle names a vertex that does not exist.
    #[error("triangle {triangle} names vertex {vertex}, but there are only {count}")]
    IndexOutOfRange {
        /// Index into `triangles`.
        triangle: usize,
        /// The vertex it names.
        vertex: u32,
        /// How many vertices there are.
        count: usize,
    },
    /// `normals` or `uvs` is neither empty nor one per position.
    #[error("{count} {what} for {positions} vertices")]
    AttributeCount {
        /// "normals" or "uvs".
        what: &'static str,
        /// How many there are.
        count: usize,
        /// How many there should be.
        positions: usize,
    },
}

impl Mesh {
    /// Feeds all of it to a key.
    pub fn digest(&self, into: &mut Digest) {
        into.vectors(&self.positions).numbers(self.triangles.as_flattened()).vectors(&self.normals).planar(&self.uvs);
        into.number(self.groups.len() as u64);
        for group in &self.groups {
            into.bytes(group.name.as_bytes()).numbers(&group.triangles);
        }
    }

    /// Checks everything that the rest of Coif relies on.
    ///
    /// # Errors
    /// The first [`MeshError`] found.
    pub fn validate(&self) -> Result<(), MeshError> {
        if self.triangles.is_empty() {
            return Err(MeshError::Empty);
        }
        if let Some(vertex) = self.positions.iter().position(|p| !p.is_finite()) {
            return Err(MeshError::NotFinite { vertex, position: self.positions[vertex] });
        }
        let count = self.positions.len();
        for (triangle, t) in self.triangles.iter().enumerate() {
            if let Some(&vertex) = t.iter().find(|&&v| v as usize >= count) {
                return Err(MeshError::IndexOutOfRange { triangle, vertex, count });
            }
        }
        for (what, len) in [("normals", self.normals.len()), ("uvs", self.uvs.len())] {
            if len != 0 && len != count {
                return Err(MeshError::AttributeCount { what, count: len, positions: count });
            }
        }
        Ok(())
    }

    /// The corners of a triangle.
    pub fn corners(&self, triangle: usize) -> [Vec3; 3] {
        self.triangles[triangle].map(|v| self.positions[v as usize])
    }

    /// Twice the area times the unit normal of a triangle.
    pub fn area_vector(&self, triangle: usize) -> Vec3 {
        let [a, b, c] = self.corners(triangle);
        (b - a).cross(c - a)
    }

    /// Bounds of all positions.
    pub fn bounds(&self) -> Bounds {
        Bounds::of(self.positions.iter().copied())
    }

    /// The group of that name.
    pub fn group(&self, name: &str) -> Option<&Group> {
        self.groups.iter().find(|g| g.name == name)
    }

    /// Replaces the normals by the angle-weighted mean of the triangles around each position (Thuermer and Wuethrich
    /// 1998). Vertices at the very same position share one normal, so seams in uv do not show.
    pub fn compute_normals(&mut self) {
        let weld = self.weld();
        let mut sums = vec![Vec3::ZERO; self.positions.len()];
        for t in 0..self.triangles.len() {
            let p = self.corners(t);
            let n = self.area_vector(t).normalize_or_zero();
            for k in 0..3 {
                let (u, v) = (p[(k + 1) % 3] - p[k], p[(k + 2) % 3] - p[k]);
                let angle = crate::math::trig::atan2(u.cross(v).length(), u.dot(v));
                sums[weld[self.triangles[t][k] as usize] as usize] += n * angle;
            }
        }
        self.normals = weld.iter().map(|&w| sums[w as usize].try_normalize().unwrap_or(Vec3::Y)).collect();
    }

    /// The same surface with other positions, one per vertex; normals are made anew where there were any.
    #[must_use]
    pub fn moved(&self, positions: &[Vec3]) -> Self {
        let mut mesh = Self { positions: positions.to_vec(), ..self.clone() };
        if !self.normals.is_empty() {
            mesh.compute_normals();
        }
        mesh
    }

    /// The surface moved as a whole: turned, shifted, evenly scaled.
    #[must_use]
    pub fn transformed(&self, by: &Affine3A) -> Self {
        let mut mesh = self.clone();
        mesh.positions.iter_mut().for_each(|p| *p = by.transform_point3(*p));
        mesh.normals.iter_mut().for_each(|n| *n = by.transform_vector3(*n).normalize_or_zero());
        mesh
    }

    /// For every vertex the first vertex at the very same position.
    pub fn weld(&self) -> Vec<u32> {
        let mut order: Vec<u32> = (0..self.positions.len() as u32).collect();
        let key = |v: u32| {
            // `+ 0.0` makes -0 and 0 one place.
            let p = self.positions[v as usize] + Vec3::ZERO;
            (p.x.to_bits(), p.y.to_bits(), p.z.to_bits(), v)
        };
        order.sort_unstable_by_key(|&v| key(v));
        let mut weld = vec![0; order.len()];
        let mut first = 0;
        for (i, &v) in order.iter().enumerate() {
            let (a, b) = (key(order[first]), key(v));
            if (a.0, a.1, a.2) != (b.0, b.1, b.2) {
                first = i;
            }
            weld[v as usize] = order[first];
        }
        weld
    }

    /// The signed volume in cm^3: positive for a closed mesh that faces outward.
    pub fn volume(&self) -> f64 {
        (0..self.triangles.len())
            .map(|t| {
                let [a, b, c] = self.corners(t).map(|p| p.as_dvec3());
                a.dot(b.cross(c)) / 6.0
            })
            .sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tetrahedron() -> Mesh {
        Mesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z],
            triangles: vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
            ..Mesh::default()
        }
    }

    #[test]
    fn volume_of_a_tetrahedron() {
        assert!((tetrahedron().volume() - 1.0 / 6.0).abs() < 1e-7);
    }

    #[test]
    fn repeated_positions_share_a_normal() {
        let mut mesh = tetrahedron();
        mesh.positions.push(Vec3::X);
        mesh.triangles[3] = [4, 2, 3];
        mesh.compute_normals();
        assert_eq!(mesh.weld(), [0, 1, 2, 3, 1]);
        assert_eq!(mesh.normals[1], mesh.normals[4]);
    }

    #[test]
    fn bad_meshes_are_named() {
        assert_eq!(Mesh::default().validate(), Err(MeshError::Empty));
        let mut mesh = tetrahedron();
        mesh.triangles[1][2] = 9;
        assert_eq!(mesh.validate(), Err(MeshError::IndexOutOfRange { triangle: 1, vertex: 9, count: 4 }));
        let mut mesh = tetrahedron();
        mesh.positions[2].y = f32::NAN;
        assert!(matches!(mesh.validate(), Err(MeshError::NotFinite { vertex: 2, .. })));
    }
}
