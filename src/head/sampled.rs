//! Values over a head's surface, known at some places and interpolated between them.
//!
//! A script's predicate or density function is asked once per place of a [`Lattice`]; after that no script runs. The
//! places are the mesh's own vertices and, where triangles are larger than [`EDGE`], a regular lattice on each.

use glam::Vec3;

use crate::geometry::Mesh;
use crate::geometry::sample::Sample;

/// Greatest distance between neighbouring places, in cm of an adult's head.
const EDGE: f32 = 0.8;

/// Most intervals on one edge, for a mesh with very large triangles.
const MOST: f32 = 48.0;

const NOWHERE: u32 = u32::MAX;

/// The places at which a head's values are asked for. It depends on the head alone.
#[derive(Clone, Debug)]
pub(super) struct Lattice {
    /// The places, in the order of the values.
    pub places: Vec<Sample>,
    /// Per triangle of the mesh: intervals per edge (1: values at its vertices; 0: none) and its first place.
    cells: Vec<(u32, u32)>,
    /// Per vertex of the mesh: its place.
    vertices: Vec<u32>,
}

impl Lattice {
    pub fn new(mesh: &Mesh, triangles: &[u32], scale: f32) -> Self {
        let mut lattice = Self {
            places: Vec::new(),
            cells: vec![(0, NOWHERE); mesh.triangles.len()],
            vertices: vec![NOWHERE; mesh.positions.len()],
        };
        for &t in triangles {
            let [a, b, c] = mesh.corners(t as usize);
            let edge = a.distance(b).max(b.distance(c)).max(c.distance(a));
            let n = (edge / (EDGE * scale)).ceil().clamp(1.0, MOST) as u32;
            if n == 1 {
                for (k, v) in mesh.triangles[t as usize].into_iter().enumerate() {
                    if lattice.vertices[v as usize] == NOWHERE {
                        lattice.vertices[v as usize] = lattice.places.len() as u32;
                        lattice.places.push(Sample::on(mesh, t, Vec3::AXES[k]));
                    }
                }
            }
            lattice.cells[t as usize] = (n, lattice.places.len() as u32);
            if n > 1 {
                for j in 0..=n {
                    for i in 0..=n - j {
                        let (u, v) = (i as f32 / n as f32, j as f32 / n as f32);
                        lattice.places.push(Sample::on(mesh, t, Vec3::new((1.0 - u - v).max(0.0), u, v)));
                    }
                }
            }
        }
        lattice
    }

    /// The value at a place, linear between the nearest three; 0 where nothing was asked.
    pub fn value(&self, mesh: &Mesh, values: &[f32], at: &Sample) -> f32 {
        let get = |i: u32| values.get(i as usize).copied().unwrap_or(0.0);
        let t = at.triangle as usize;
        let Some(&(n, first)) = self.cells.get(t) else { return 0.0 };
        if n <= 1 {
            if n == 0 {
                return 0.0;
            }
            let corners = mesh.triangles[t].map(|v| get(self.vertices[v as usize]));
            return Vec3::from(corners).dot(at.barycentric);
        }
        // The lattice's triangle around (x, y): the lower left half of a square, or the upper right one.
        let (x, y) = (at.barycentric.y.clamp(0.0, 1.0) * n as f32, at.barycentric.z.clamp(0.0, 1.0) * n as f32);
        let j = (y.floor() as u32).min(n - 1);
        let i = (x.floor() as u32).min(n - 1 - j);
        let (s, r) = ((x - i as f32).clamp(0.0, 1.0), (y - j as f32).clamp(0.0, 1.0));
        // Rows get shorter by one: row j begins after j rows of n + 1, n, ... places.
        let place = |i: u32, j: u32| get(first + j * (n + 1) - j * j.saturating_sub(1) / 2 + i);
        if s + r <= 1.0 || i + j + 2 > n {
            place(i, j) * (1.0 - s - r).max(0.0) + place(i + 1, j) * s + place(i, j + 1) * r
        } else {
            place(i + 1, j + 1) * (s + r - 1.0) + place(i, j + 1) * (1.0 - s) + place(i + 1, j) * (1.0 - r)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::sample::Patch;
    use crate::math::rng::Key;

    #[test]
    fn linear_functions_are_kept_exactly() {
        let mut mesh = crate::geometry::bvh::tests::sphere(6, 10.0);
        let fine = crate::geometry::bvh::tests::sphere(60, 3.0);
        let (offset, own) = (mesh.positions.len() as u32, mesh.triangles.len() as u32);
        mesh.positions.extend(&fine.positions);
        mesh.triangles.extend(fine.triangles.iter().map(|t| t.map(|v| v + offset)));
        let all: Vec<u32> = (0..mesh.triangles.len() as u32).collect();
        let lattice = Lattice::new(&mesh, &all, 1.0);
        assert!(lattice.cells[0].0 > 1 && lattice.cells[own as usize].0 == 1);
        let f = |p: Vec3| 0.5 + p.dot(Vec3::new(0.01, 0.02, -0.03));
        let values: Vec<f32> = lattice.places.iter().map(|s| f(s.position)).collect();
        let patch = Patch::new(&mesh, all).unwrap();
        for i in 0..2000 {
            let s = patch.stratified(i, 2000, Key::new(1, "lattice"));
            assert!((lattice.value(&mesh, &values, &s) - f(s.position)).abs() < 1e-4, "{s:?}");
        }
        // Corners and edges, where the halves meet.
        for b in [Vec3::X, Vec3::Y, Vec3::Z, Vec3::new(0.5, 0.5, 0.0), Vec3::new(0.0, 0.25, 0.75), Vec3::ONE / 3.0] {
            let s = Sample::on(&mesh, 3, b);
            assert!((lattice.value(&mesh, &values, &s) - f(s.position)).abs() < 1e-4, "{b}");
        }
    }

    #[test]
    fn nothing_is_known_outside() {
        let mesh = crate::geometry::bvh::tests::sphere(6, 10.0);
        let lattice = Lattice::new(&mesh, &[0], 1.0);
        let values = vec![1.0; lattice.places.len()];
        assert_eq!(lattice.value(&mesh, &values, &Sample::on(&mesh, 1, Vec3::X)), 0.0);
        assert_eq!(lattice.value(&mesh, &values, &Sample::on(&mesh, 0, Vec3::X)), 1.0);
    }
}
