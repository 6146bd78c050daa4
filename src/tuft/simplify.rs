//! Fewer triangles for a closed mesh that is no tuft: a cap, a bun, a ring.
//!
//! Vertices are taken out one by one, each onto a neighbour (half-edge collapse), the one first that moves the surface
//! least. How far that is follows Ronfard and Rossignac 1996: a vertex answers for the planes of all triangles that it has
//! replaced. Vertices keep their places, normals and texture coordinates, and seams keep their vertices.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet, BinaryHeap};

use glam::Vec3;

use crate::geometry::Mesh;

/// The order in which a mesh's vertices can go.
pub(super) struct Simplifier<'a> {
    mesh: &'a Mesh,
    /// Per vertex: one number for all vertices at its place.
    place: Vec<u32>,
    /// What goes onto what, as vertices of the mesh; and how far the surface has strayed by then, cm.
    steps: Vec<(u32, u32, f32)>,
}

struct Work<'a> {
    mesh: &'a Mesh,
    place: Vec<u32>,
    /// Per place: a vertex there, and whether it is the only one.
    vertex: Vec<(u32, bool)>,
    triangles: Vec<Option<[u32; 3]>>,
    /// Per place: its triangles.
    around: Vec<Vec<u32>>,
    /// Per place: the triangles whose planes it answers for.
    zone: Vec<Vec<u32>>,
    planes: Vec<(Vec3, f32)>,
}

/// How far a new triangle may turn against the one that it replaces, as a cosine.
const TURN: f32 = 0.3;

impl<'a> Simplifier<'a> {
    pub(super) fn new(mesh: &'a Mesh) -> Self {
        let mut work = Work::new(mesh);
        let mut steps = Vec::new();
        let mut farthest = 0.0_f32;
        let mut stamps = vec![0_u32; work.vertex.len()];
        // Costs are positive, so their bits are in order.
        let mut queue: BinaryHeap<Reverse<(u32, u32, u32, u32)>> = BinaryHeap::new();
        for u in 0..work.vertex.len() as u32 {
            if let Some((cost, v)) = work.best(u) {
                queue.push(Reverse((cost.to_bits(), u, v, 0)));
            }
        }
        while let Some(Reverse((cost, u, v, stamp))) = queue.pop() {
            if stamp != stamps[u as usize] {
                continue;
            }
            farthest = farthest.max(f32::from_bits(cost));
            let Some(onto) = work.collapse(u, v) else { continue };
            steps.push((work.vertex[u as usize].0, onto, farthest));
            stamps[u as usize] += 1;
            let mut near: BTreeSet<u32> = work.neighbours(v);
            near.insert(v);
            for w in near {
                stamps[w as usize] += 1;
                if let Some((cost, to)) = work.best(w) {
                    queue.push(Reverse((cost.to_bits(), w, to, stamps[w as usize])));
                }
            }
        }
        Self { mesh, place: work.place, steps }
    }

    fn steps_within(&self, tolerance: f32) -> usize {
        self.steps.partition_point(|s| s.2 <= tolerance)
    }

    /// How many triangles are left when the surface may stray so far, cm.
    pub(super) fn triangles(&self, tolerance: f32) -> usize {
        self.mesh.triangles.len() - 2 * self.steps_within(tolerance)
    }

    /// The mesh with so many triangles.
    pub(super) fn mesh(&self, tolerance: f32) -> Mesh {
        let mut to: Vec<u32> = (0..self.place.len() as u32).collect();
        for &(from, onto, _) in &self.steps[..self.steps_within(tolerance)] {
            to[from as usize] = onto;
        }
        let last = |mut v: u32| {
            while to[v as usize] != v {
                v = to[v as usize];
            }
            v
        };
        let mut fresh: BTreeMap<u32, u32> = BTreeMap::new();
        let mut mesh = Mesh::default();
        for t in &self.mesh.triangles {
            let t = t.map(last);
            let [a, b, c] = t.map(|v| self.place[v as usize]);
            if a == b || b == c || c == a {
                continue;
            }
            let corners = t.map(|v| {
                *fresh.entry(v).or_insert_with(|| {
                    let v = v as usize;
                    mesh.positions.push(self.mesh.positions[v]);
                    mesh.normals.extend(self.mesh.normals.get(v));
                    mesh.uvs.extend(self.mesh.uvs.get(v));
                    mesh.positions.len() as u32 - 1
                })
            });
            mesh.triangles.push(corners);
        }
        mesh
    }
}

impl<'a> Work<'a> {
    fn new(mesh: &'a Mesh) -> Self {
        let mut known: BTreeMap<[u32; 3], u32> = BTreeMap::new();
        let mut vertex: Vec<(u32, bool)> = Vec::new();
        let mut place = Vec::with_capacity(mesh.positions.len());
        for (v, p) in mesh.positions.iter().enumerate() {
            let bits = (*p + Vec3::ZERO).to_array().map(f32::to_bits);
            let at = *known.entry(bits).or_insert_with(|| {
                vertex.push((v as u32, true));
                vertex.len() as u32 - 1
            });
            vertex[at as usize].1 &= vertex[at as usize].0 == v as u32;
            place.push(at);
        }
        let triangles: Vec<Option<[u32; 3]>> = mesh.triangles.iter().map(|&t| Some(t)).collect();
        let mut around = vec![Vec::new(); vertex.len()];
        for (i, t) in mesh.triangles.iter().enumerate() {
            for v in t {
                around[place[*v as usize] as usize].push(i as u32);
            }
        }
        let planes = (0..mesh.triangles.len())
            .map(|i| {
                let normal = mesh.area_vector(i).normalize_or_zero();
                (normal, normal.dot(mesh.corners(i)[0]))
            })
            .collect();
        Self { mesh, place, vertex, triangles, zone: around.clone(), around, planes }
    }

    fn at(&self, place: u32) -> Vec3 {
        self.mesh.positions[self.vertex[place as usize].0 as usize]
    }

    fn corners(&self, triangle: u32) -> [u32; 3] {
        self.triangles[triangle as usize].map_or([0; 3], |t| t.map(|v| self.place[v as usize]))
    }

    fn neighbours(&self, u: u32) -> BTreeSet<u32> {
        self.around[u as usize].iter().flat_map(|&t| self.corners(t)).filter(|&v| v != u).collect()
    }

    /// The neighbour that a vertex moves onto with the least harm, and how much that is; none for a vertex that must stay.
    fn best(&self, u: u32) -> Option<(f32, u32)> {
        if !self.vertex[u as usize].1 || self.around[u as usize].is_empty() {
            return None;
        }
        let near = self.neighbours(u);
        let mut best: Option<(f32, u32)> = None;
        for &v in &near {
            // Exactly the two triangles on the edge go, and the surface stays a manifold.
            if near.intersection(&self.neighbours(v)).count() != 2 {
                continue;
            }
            let cost = self.cost(u, v, best.map_or(f32::INFINITY, |b| b.0));
            if cost < best.map_or(f32::INFINITY, |b| b.0) {
                best = Some((cost, v));
            }
        }
        best
    }

    /// How far the surface strays when `u` moves onto `v`; infinite when it folds or when that is more than `limit`.
    fn cost(&self, u: u32, v: u32, limit: f32) -> f32 {
        let (from, to) = (self.at(u), self.at(v));
        let mut cost = 0.0_f32;
        for &t in &self.zone[u as usize] {
            let (normal, height) = self.planes[t as usize];
            cost = cost.max((normal.dot(to) - height).abs());
            if cost >= limit {
                return f32::INFINITY;
            }
        }
        // The old place lies off the new triangles, too.
        let mut off = f32::INFINITY;
        for &t in &self.around[u as usize] {
            let corners = self.corners(t);
            if corners.contains(&v) {
                continue;
            }
            let before = corners.map(|c| self.at(c));
            let after = corners.map(|c| if c == u { to } else { self.at(c) });
            let normal = |[a, b, c]: [Vec3; 3]| (b - a).cross(c - a).normalize_or_zero();
            let turned = normal(after);
            if turned.dot(normal(before)) < TURN {
                return f32::INFINITY;
            }
            off = off.min(turned.dot(from - to).abs());
        }
        if off.is_finite() { cost.max(off) } else { f32::INFINITY }
    }

    /// Moves `u` onto `v`; the vertex of the mesh that stands for it there. `None` when that cannot be done any more.
    fn collapse(&mut self, u: u32, v: u32) -> Option<u32> {
        let gone = std::mem::take(&mut self.around[u as usize]);
        let onto =
            gone.iter().filter_map(|&t| self.triangles[t as usize]).flatten().find(|&c| self.place[c as usize] == v);
        let Some(onto) = onto else {
            self.around[u as usize] = gone;
            return None;
        };
        for t in gone {
            let corners = self.corners(t);
            if corners.contains(&v) {
                self.triangles[t as usize] = None;
                for c in corners.into_iter().filter(|&c| c != u) {
                    self.around[c as usize].retain(|&other| other != t);
                }
            } else {
                if let Some(corners) = &mut self.triangles[t as usize] {
                    for c in corners.iter_mut().filter(|c| self.place[**c as usize] == u) {
                        *c = onto;
                    }
                }
                self.around[v as usize].push(t);
            }
        }
        let zone = std::mem::take(&mut self.zone[u as usize]);
        let all = &mut self.zone[v as usize];
        all.extend(zone);
        all.sort_unstable();
        all.dedup();
        Some(onto)
    }
}
