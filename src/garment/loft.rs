//! Lofts: rings of points joined to a surface.

use glam::{Vec2, Vec3};

use crate::geometry::{Group, Mesh};

/// A surface in the making.
#[derive(Debug, Default)]
pub struct Loft {
    /// What was made so far.
    pub mesh: Mesh,
}

impl Loft {
    /// Adds rings, top to bottom, each with the same number of points from right to left as seen from the front; `keep`
    /// says which quads (ring, column) are made. The triangles go into the part `name`.
    pub fn sheet(&mut self, name: &str, rings: &[Vec<Vec3>], keep: impl Fn(usize, usize) -> bool) {
        let first = self.mesh.positions.len() as u32;
        let columns = rings.first().map_or(0, Vec::len);
        let mut down = 0.0;
        for (r, ring) in rings.iter().enumerate() {
            if r > 0 {
                down +=
                    ring.iter().zip(&rings[r - 1]).map(|(a, b)| a.distance(*b)).sum::<f32>() / columns.max(1) as f32;
            }
            for (c, &p) in ring.iter().enumerate() {
                self.mesh.positions.push(p);
                self.mesh.uvs.push(Vec2::new(c as f32 / (columns - 1).max(1) as f32, 1.0 - down / 150.0));
            }
        }
        let at = |r: usize, c: usize| first + (r * columns + c) as u32;
        let mut triangles = Vec::new();
        for r in 0..rings.len().saturating_sub(1) {
            for c in 0..columns - 1 {
                if keep(r, c) {
                    triangles.push([at(r, c), at(r + 1, c), at(r + 1, c + 1)]);
                    triangles.push([at(r, c), at(r + 1, c + 1), at(r, c + 1)]);
                }
            }
        }
        self.add(name, &triangles);
    }

    /// Closes a ring with a fan about `middle`; `up` says whether it is seen from above.
    pub fn cap(&mut self, name: &str, ring: &[Vec3], middle: Vec3, up: bool) {
        let first = self.mesh.positions.len() as u32;
        self.mesh.positions.extend(ring);
        self.mesh.positions.push(middle);
        self.mesh.uvs.resize(self.mesh.positions.len(), Vec2::ZERO);
        let last = self.mesh.positions.len() as u32 - 1;
        let fan = (0..ring.len() as u32 - 1).map(|c| {
            let (a, b) = (first + c, first + c + 1);
            if up { [last, a, b] } else { [last, b, a] }
        });
        self.add(name, &fan.collect::<Vec<_>>());
    }

    fn add(&mut self, name: &str, triangles: &[[u32; 3]]) {
        let p = &self.mesh.positions;
        let flat = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|v| p[v as usize]);
            (b - a).cross(c - a).length_squared() <= 1e-12
        };
        let kept: Vec<[u32; 3]> = triangles.iter().copied().filter(|t| !flat(t)).collect();
        let from = self.mesh.triangles.len() as u32;
        self.mesh.triangles.extend(kept);
        let made = from..self.mesh.triangles.len() as u32;
        match self.mesh.groups.iter_mut().find(|g| g.name == name) {
            Some(group) => group.triangles.extend(made),
            None => self.mesh.groups.push(Group { name: name.to_owned(), triangles: made.collect() }),
        }
    }

    /// The finished mesh, with normals.
    pub fn finish(mut self) -> Mesh {
        self.mesh.groups.retain(|g| !g.triangles.is_empty());
        self.mesh.compute_normals();
        self.mesh
    }
}

/// The edge of cloth turned in: rings that go on from `rim` inwards by its thickness and back along the cloth by
/// `depth`. `before` is the ring before the rim. The first of them is the rim itself.
pub fn turned_in(before: &[Vec3], rim: &[Vec3], depth: f32) -> Vec<Vec<Vec3>> {
    const THICK: f32 = 0.18;
    let middle = rim.iter().copied().sum::<Vec3>() / rim.len() as f32;
    let steps = [(0.0, 0.0), (0.25, -0.7), (0.8, -0.9), (1.0, 0.0), (1.0, 4.0)];
    let back = |i: usize| (before[i] - rim[i]).normalize_or_zero();
    let inward = |i: usize| {
        let b = back(i);
        let m = middle - rim[i];
        (m - b * m.dot(b)).normalize_or_zero()
    };
    let place = |i: usize, (inn, along): (f32, f32)| {
        let along = if along > 1.0 { depth } else { along * THICK };
        rim[i] + inward(i) * (2.0 * inn * THICK) + back(i) * along
    };
    steps.iter().map(|&step| (0..rim.len()).map(|i| place(i, step)).collect()).collect()
}
