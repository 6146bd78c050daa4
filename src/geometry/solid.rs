//! The inside and outside of a closed surface.

use std::collections::BTreeMap;
use std::sync::OnceLock;

use glam::Vec3;

use super::cells::{Cells, Vicinity};
use super::{Bounds, Bvh, Closest, Hit, Mesh, MeshError};
use crate::math::trig;

/// Why a mesh has no inside.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SolidError {
    /// The mesh itself is bad.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// It encloses nothing, even with its holes closed.
    #[error("the mesh encloses no volume (`{volume:.3}` cm3 in a box of `{box_volume:.3}` cm3)")]
    NoVolume {
        /// Signed volume with the holes closed, cm^3.
        volume: f64,
        /// Volume of the bounding box, cm^3.
        box_volume: f64,
    },
}

/// A place on the surface of a [`Solid`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// The place.
    pub position: Vec3,
    /// Unit normal, outward; smooth across edges and corners in the sense of the pseudonormal.
    pub normal: Vec3,
    /// Distance from the point asked for: positive outside, negative inside.
    pub distance: f32,
    /// Triangle of the mesh; those that close holes come after the mesh's own.
    pub triangle: u32,
}

/// A mesh that can tell inside from outside.
///
/// Holes (a neck, eye sockets) are closed with a fan about their middle first; a mesh that faces inward is turned
/// around. The sign of the distance comes from the angle-weighted pseudonormal of the closest feature (Baerentzen and
/// Aanaes 2005), which is exact for closed manifold meshes.
pub struct Solid {
    positions: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    bvh: Bvh,
    face_normals: Vec<Vec3>,
    /// Per triangle: sum of the normals on both sides of the edges 01, 12, 20.
    edge_normals: Vec<[Vec3; 3]>,
    vertex_normals: Vec<Vec3>,
    bounds: Bounds,
    own_triangles: usize,
    cells: OnceLock<Cells>,
}

impl std::fmt::Debug for Solid {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Solid({} triangles)", self.triangles.len())
    }
}

impl Solid {
    /// Welds, closes and orients a mesh.
    ///
    /// # Errors
    /// A bad mesh, or one that encloses less than a ten-thousandth of its bounding box.
    pub fn new(mesh: &Mesh) -> Result<Self, SolidError> {
        mesh.validate()?;
        let weld = mesh.weld();
        let mut positions = mesh.positions.clone();
        let mut triangles: Vec<[u32; 3]> = mesh.triangles.iter().map(|t| t.map(|v| weld[v as usize])).collect();
        close_holes(&mut positions, &mut triangles);

        let volume = signed_volume(&positions, &triangles);
        let bounds = mesh.bounds();
        let size = bounds.size().as_dvec3();
        let box_volume = size.x * size.y * size.z;
        // Written so that NaN is refused too.
        if !(volume.abs() > box_volume * 1e-4 && volume.abs() > 0.0) {
            return Err(SolidError::NoVolume { volume, box_volume });
        }
        if volume < 0.0 {
            for t in &mut triangles {
                t.swap(1, 2);
            }
        }

        let bvh = Bvh::new(&positions, &triangles);
        let (face_normals, edge_normals, vertex_normals) = pseudonormals(&positions, &triangles);
        Ok(Self {
            positions,
            triangles,
            bvh,
            face_normals,
            edge_normals,
            vertex_normals,
            bounds,
            own_triangles: mesh.triangles.len(),
            cells: OnceLock::new(),
        })
    }

    /// The tree over all triangles, those that close holes included.
    pub fn bvh(&self) -> &Bvh {
        &self.bvh
    }

    /// Bounds of the surface.
    pub fn bounds(&self) -> Bounds {
        self.bounds
    }

    /// True for a triangle that was added to close a hole.
    pub fn is_closing(&self, triangle: u32) -> bool {
        triangle as usize >= self.own_triangles
    }

    /// The point of the surface closest to `p`.
    pub fn closest(&self, p: Vec3) -> SurfacePoint {
        let far = f32::MAX.sqrt();
        self.closest_within(p, far).unwrap_or_else(|| {
            let nowhere =
                Closest { position: self.positions[0], triangle: 0, barycentric: Vec3::X, distance: far, slot: 0 };
            self.signed(p, &nowhere)
        })
    }

    /// The point of the surface closest to `p`, unless it is farther away than `max`.
    pub fn closest_within(&self, p: Vec3, max: f32) -> Option<SurfacePoint> {
        // What is closest to the middle of a cell is a good first guess; the answer does not depend on it.
        let guess = self.cells.get().and_then(|cells| cells.guess(&cells.around(p)));
        self.guessed(p, max, guess).map(|found| found.0)
    }

    /// The same, for a point whose surroundings are known.
    pub fn closest_around(&self, p: Vec3, around: &Vicinity, max: f32) -> Option<SurfacePoint> {
        self.guessed(p, max, self.cells().guess(around)).map(|found| found.0)
    }

    /// The closest point, and where in the tree its triangle stands, which makes a guess for places near it.
    pub(super) fn guessed(&self, p: Vec3, max: f32, guess: Option<u32>) -> Option<(SurfacePoint, u32)> {
        self.bvh.closest_guessed(p, max, guess).map(|c| (self.signed(p, &c), c.slot))
    }

    /// Exact distance to the surface: positive outside, negative inside.
    pub fn signed_distance(&self, p: Vec3) -> f32 {
        self.closest(p).distance
    }

    /// True for a point strictly inside.
    pub fn contains(&self, p: Vec3) -> bool {
        self.bounds.contains(p) && self.clearance(p) <= 0.0 && self.signed_distance(p) < 0.0
    }

    /// A quick lower bound on the distance to the surface: a positive answer means that `p` is outside and at least
    /// that far away; zero or less means "ask [`Solid::signed_distance`]". Over smooth skin it falls short of the
    /// distance by less than a hundredth of the solid's size.
    pub fn clearance(&self, p: Vec3) -> f32 {
        self.around(p).clearance
    }

    /// What is known at once about the surface around `p`.
    pub fn around(&self, p: Vec3) -> Vicinity {
        self.cells().around(p)
    }

    /// True only if the whole segment from `a` to `b` is outside; false means "ask [`Solid::is_crossed`]".
    pub fn is_surely_outside(&self, a: Vec3, b: Vec3) -> bool {
        self.is_way_free((a, &self.around(a)), (b, &self.around(b)))
    }

    /// The same, where the surroundings of both ends are known.
    pub fn is_way_free(&self, a: (Vec3, &Vicinity), b: (Vec3, &Vicinity)) -> bool {
        let cells = self.cells();
        cells.is_free(a.1, a.0, b.0) || cells.is_free(b.1, b.0, a.0)
    }

    fn cells(&self) -> &Cells {
        self.cells.get_or_init(|| Cells::build(self))
    }

    /// True when the segment from `a` to `b` meets the surface: [`Solid::segment_hit`] without the place.
    pub fn is_crossed(&self, a: Vec3, b: Vec3) -> bool {
        self.bvh.is_crossed(a, b)
    }

    /// Where the segment from `a` to `b` first meets the surface.
    pub fn segment_hit(&self, a: Vec3, b: Vec3) -> Option<Hit> {
        self.bvh.segment_hit(a, b)
    }

    fn signed(&self, p: Vec3, c: &Closest) -> SurfacePoint {
        let t = c.triangle as usize;
        let normal = self.feature_normal(t, c.barycentric);
        let outward = (p - c.position).dot(normal) >= 0.0;
        SurfacePoint {
            position: c.position,
            normal: normal.try_normalize().unwrap_or(self.face_normals[t]),
            distance: if outward { c.distance } else { -c.distance },
            triangle: c.triangle,
        }
    }

    /// Pseudonormal of the corner, edge or face that the weights lie on.
    fn feature_normal(&self, t: usize, weights: Vec3) -> Vec3 {
        let on = weights.to_array().map(|w| w > 0.0);
        match on {
            [true, false, false] => self.vertex_normals[self.triangles[t][0] as usize],
            [false, true, false] => self.vertex_normals[self.triangles[t][1] as usize],
            [false, false, true] => self.vertex_normals[self.triangles[t][2] as usize],
            [true, true, false] => self.edge_normals[t][0],
            [false, true, true] => self.edge_normals[t][1],
            [true, false, true] => self.edge_normals[t][2],
            _ => self.face_normals[t],
        }
    }
}

fn signed_volume(positions: &[Vec3], triangles: &[[u32; 3]]) -> f64 {
    triangles
        .iter()
        .map(|t| {
            let [a, b, c] = t.map(|v| positions[v as usize].as_dvec3());
            a.dot(b.cross(c)) / 6.0
        })
        .sum()
}

/// Closes every loop of edges that have a triangle on one side only with a fan about the loop's middle.
fn close_holes(positions: &mut Vec<Vec3>, triangles: &mut Vec<[u32; 3]>) {
    let mut balance: BTreeMap<(u32, u32), i32> = BTreeMap::new();
    for t in triangles.iter() {
        for k in 0..3 {
            let (a, b) = (t[k], t[(k + 1) % 3]);
            if a != b {
                *balance.entry((a.min(b), a.max(b))).or_default() += if a < b { 1 } else { -1 };
            }
        }
    }
    // The missing triangles run along the open edges in the opposite direction.
    let mut next: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    for (&(a, b), &n) in &balance {
        let (from, to) = if n > 0 { (b, a) } else { (a, b) };
        for _ in 0..n.unsigned_abs() {
            next.entry(from).or_default().push(to);
        }
    }
    while let Some((&start, _)) = next.iter().next() {
        let mut path = vec![start];
        // Follow open edges; whenever the path comes back to itself, what lies between is a loop to close.
        while let Some(&last) = path.last() {
            let Some(to) = next.get_mut(&last).and_then(Vec::pop) else { break };
            if next.get(&last).is_some_and(Vec::is_empty) {
                next.remove(&last);
            }
            if let Some(at) = path.iter().position(|&v| v == to) {
                let ring = path.split_off(at);
                let middle = ring.iter().map(|&v| positions[v as usize]).sum::<Vec3>() / ring.len() as f32;
                let centre = positions.len() as u32;
                positions.push(middle);
                for k in 0..ring.len() {
                    triangles.push([ring[k], ring[(k + 1) % ring.len()], centre]);
                }
            }
            path.push(to);
        }
        if let Some(v) = next.get(&start)
            && v.is_empty()
        {
            next.remove(&start);
        }
    }
}

type Normals = (Vec<Vec3>, Vec<[Vec3; 3]>, Vec<Vec3>);

/// Face, edge and vertex pseudonormals, not normalised but for the faces'.
fn pseudonormals(positions: &[Vec3], triangles: &[[u32; 3]]) -> Normals {
    let corners = |t: &[u32; 3]| t.map(|v| positions[v as usize]);
    let faces: Vec<Vec3> = triangles
        .iter()
        .map(|t| {
            let [a, b, c] = corners(t);
            (b - a).cross(c - a).normalize_or_zero()
        })
        .collect();
    let mut edges: BTreeMap<(u32, u32), Vec3> = BTreeMap::new();
    let mut vertices = vec![Vec3::ZERO; positions.len()];
    for (t, &n) in triangles.iter().zip(&faces) {
        let p = corners(t);
        for k in 0..3 {
            let (a, b) = (t[k], t[(k + 1) % 3]);
            *edges.entry((a.min(b), a.max(b))).or_default() += n;
            let (u, v) = (p[(k + 1) % 3] - p[k], p[(k + 2) % 3] - p[k]);
            vertices[a as usize] += n * trig::atan2(u.cross(v).length(), u.dot(v));
        }
    }
    let edges = triangles
        .iter()
        .map(|t| std::array::from_fn(|k| edges[&(t[k].min(t[(k + 1) % 3]), t[k].max(t[(k + 1) % 3]))]))
        .collect();
    (faces, edges, vertices)
}

#[cfg(test)]
mod tests {
    use super::super::bvh::tests::sphere;
    use super::*;
    use crate::math::rng::Key;

    #[test]
    fn a_sphere_has_an_inside() {
        let solid = Solid::new(&sphere(40, 5.0)).unwrap();
        let key = Key::new(3, "solid");
        for i in 0..2000 {
            let r = key.with(i).with(7).range(0.2, 9.0);
            let p = key.with(i).direction() * r;
            let d = solid.signed_distance(p);
            // The polyhedron lies within 5 (1 - cos(pi/80)) of the sphere.
            assert!((d - (r - 5.0)).abs() < 0.02, "{p} {d}");
            assert_eq!(solid.contains(p), d < 0.0);
            assert!(solid.clearance(p) <= d.max(0.0) + 1e-5, "{} against {d}", solid.clearance(p));
        }
        let sure = (0..2000).filter(|&i| {
            let p = key.with(i).direction() * 5.5;
            solid.clearance(p) > 0.0
        });
        assert!(sure.count() > 1900, "half a centimetre away the bound should nearly always do");
        let sure = (0..2000).filter(|&i| {
            let p = key.with(i).direction() * 5.06;
            solid.clearance(p) > 0.02
        });
        assert!(sure.count() > 1900, "so it should close to the surface, which is nearly flat");
    }

    #[test]
    fn the_bound_holds_on_every_shape() {
        // Sharp edges, thin walls and large triangles: a star of spikes, and two plates with a slit between them.
        let mut star = sphere(8, 4.0);
        for (i, p) in star.positions.iter_mut().enumerate() {
            *p *= if i % 3 == 0 { 2.0 } else { 0.6 };
        }
        let box_at = |y: f32| {
            let corner = |k: u32| {
                let side = |bit: u32, half: f32| if k >> bit & 1 == 1 { half } else { -half };
                Vec3::new(side(0, 6.0), y + side(1, 0.2), side(2, 6.0))
            };
            (0..8).map(corner).collect::<Vec<_>>()
        };
        let sides: [[u32; 3]; 12] = [
            [0, 2, 1],
            [1, 2, 3],
            [4, 5, 6],
            [5, 7, 6],
            [0, 1, 4],
            [1, 5, 4],
            [2, 6, 3],
            [3, 6, 7],
            [0, 4, 2],
            [2, 4, 6],
            [1, 3, 5],
            [3, 7, 5],
        ];
        let plates = Mesh {
            positions: [box_at(0.5), box_at(-0.5)].concat(),
            triangles: sides.iter().chain(&sides.map(|t| t.map(|v| v + 8))).copied().collect(),
            ..Mesh::default()
        };
        for mesh in [star, plates] {
            let solid = Solid::new(&mesh).unwrap();
            let (key, bounds) = (Key::new(5, "bound"), solid.bounds().grown(0.3));
            let (mut positive, mut sure) = (0, 0);
            for i in 0..20_000 {
                let u = Vec3::new(key.with(i).unit(), key.with(i).with(1).unit(), key.with(i).with(2).unit());
                let p = bounds.min + bounds.size() * u;
                let (bound, distance) = (solid.clearance(p), solid.signed_distance(p));
                positive += u32::from(bound > 0.0);
                assert!(bound <= distance.max(0.0) + 1e-5, "{p}: {bound} against {distance}");
                let q = p + key.with(i).with(3).direction() * 0.1;
                if solid.is_surely_outside(p, q) {
                    sure += 1;
                    assert!(distance > 0.0 && solid.segment_hit(p, q).is_none(), "{p} to {q}");
                }
            }
            assert!(positive > 5000 && sure > 100, "{positive} {sure}");
        }
    }

    #[test]
    fn holes_are_closed_and_inward_meshes_turned() {
        let mut mesh = sphere(20, 5.0);
        let keep: Vec<[u32; 3]> = (0..mesh.triangles.len())
            .filter(|&t| mesh.corners(t).iter().any(|p| p.y > -3.0))
            .map(|t| mesh.triangles[t])
            .collect();
        mesh.triangles = keep;
        for t in &mut mesh.triangles {
            t.swap(0, 1);
        }
        let solid = Solid::new(&mesh).unwrap();
        assert!(solid.contains(Vec3::new(0.0, -2.5, 0.0)));
        assert!(!solid.contains(Vec3::new(0.0, -4.9, 0.0)));
        assert!(solid.signed_distance(Vec3::new(0.0, -8.0, 0.0)) > 3.0);
    }

    #[test]
    fn corners_and_edges_have_the_right_sign() {
        // A thin wedge: with plain face normals, points beyond its sharp edge get the wrong sign.
        let mesh = Mesh {
            positions: vec![Vec3::ZERO, Vec3::new(4.0, 0.3, -1.0), Vec3::new(4.0, 0.3, 1.0), Vec3::new(4.0, -0.3, 0.0)],
            triangles: vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
            ..Mesh::default()
        };
        let solid = Solid::new(&mesh).unwrap();
        let key = Key::new(1, "wedge");
        for i in 0..500 {
            let p = Vec3::new(-1.0, 0.0, 0.0) + key.with(i).direction() * 0.9;
            assert!(solid.signed_distance(p) > 0.0, "{p}");
        }
        assert!(solid.contains(Vec3::new(3.0, 0.05, 0.0)));
    }

    #[test]
    fn a_sheet_has_no_volume() {
        let sheet = Mesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::new(1.0, 1.0, 0.0)],
            triangles: vec![[0, 1, 2], [2, 1, 3]],
            ..Mesh::default()
        };
        assert!(matches!(Solid::new(&sheet), Err(SolidError::NoVolume { .. })));
    }
}
