//! What surfaces leave of a lamp's light: depths as the lamp sees them.

use glam::{Mat3, Vec2, Vec3};

use crate::geometry::{Bounds, Mesh};

/// Cells along each side of a map of depths.
const MAP: usize = Depths::CELLS;

/// The surfaces as a lamp sees them: per cell the depth of the nearest.
#[derive(Clone, Debug)]
pub struct Depths {
    axes: Mat3,
    origin: Vec2,
    cell: f32,
    nearest: Vec<f32>,
}

impl Depths {
    /// Cells along each side.
    pub const CELLS: usize = 384;

    /// What a lamp in the direction `to_light` sees of `meshes`.
    pub fn new(meshes: &[&Mesh], to_light: Vec3) -> Self {
        let points = || meshes.iter().flat_map(|m| m.positions.iter().copied());
        let mut map = Self::framed(points(), to_light);
        map.nearest = vec![f32::NEG_INFINITY; MAP * MAP];
        for mesh in meshes {
            let cells: Vec<Vec3> = mesh.positions.iter().map(|&p| map.cell_of(p)).collect();
            for t in &mesh.triangles {
                map.cover(t.map(|v| cells[v as usize]));
            }
        }
        map
    }

    /// The same of surfaces that `draw` knows: it is given the way from a place to its column, its row and its depth, and
    /// gives the nearest depth of every cell, row by row.
    pub fn drawn(
        points: impl Iterator<Item = Vec3>,
        to_light: Vec3,
        draw: impl FnOnce(&(dyn Fn(Vec3) -> Vec3 + Sync)) -> Vec<f32>,
    ) -> Self {
        let mut map = Self::framed(points, to_light);
        map.nearest = draw(&|p| map.cell_of(p));
        map
    }

    /// A map without depths, over all places.
    fn framed(points: impl Iterator<Item = Vec3>, to_light: Vec3) -> Self {
        let right = to_light.any_orthonormal_vector();
        let axes = Mat3::from_cols(right, to_light.cross(right), to_light);
        let bounds = Bounds::of(points.map(|p| axes.transpose() * p).filter(|p| p.is_finite()));
        let bounds = if bounds.is_empty() { Bounds::of([Vec3::ZERO]) } else { bounds };
        let cell = (bounds.size().truncate().max_element() / (MAP as f32 - 4.0)).max(1e-4);
        let origin = bounds.min.truncate() - Vec2::splat(2.0 * cell);
        Self { axes, origin, cell, nearest: vec![] }
    }

    /// Column, row and depth of a place.
    fn cell_of(&self, p: Vec3) -> Vec3 {
        let q = self.axes.transpose() * p;
        ((q.truncate() - self.origin) / self.cell).extend(q.z)
    }

    fn cover(&mut self, c: [Vec3; 3]) {
        if c.iter().any(|p| !p.is_finite()) {
            return;
        }
        let (lo, hi) = (c[0].min(c[1]).min(c[2]), c[0].max(c[1]).max(c[2]));
        let edge = |a: Vec3, b: Vec3, x: f32, y: f32| (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x);
        let area = edge(c[0], c[1], c[2].x, c[2].y);
        if area.abs() < 1e-9 {
            return;
        }
        for y in lo.y.max(0.0) as usize..=(hi.y as usize).min(MAP - 1) {
            for x in lo.x.max(0.0) as usize..=(hi.x as usize).min(MAP - 1) {
                let (px, py) = (x as f32 + 0.5, y as f32 + 0.5);
                let (u, v) = (edge(c[1], c[2], px, py) / area, edge(c[2], c[0], px, py) / area);
                if u >= 0.0 && v >= 0.0 && u + v <= 1.0 {
                    let z = c[0].z * u + c[1].z * v + c[2].z * (1.0 - u - v);
                    let cell = &mut self.nearest[y * MAP + x];
                    *cell = cell.max(z);
                }
            }
        }
    }

    /// The direction to the lamp.
    pub fn lamp(&self) -> Vec3 {
        self.axes.z_axis
    }

    /// The fraction of the lamp that the surfaces leave free at `p`; its edge is as soft as a wide lamp's.
    pub fn sample(&self, p: Vec3) -> f32 {
        let q = self.axes.transpose() * p;
        let at = (q.truncate() - self.origin) / self.cell - Vec2::splat(0.5);
        if !(at.min_element() > 0.0 && at.max_element() < MAP as f32 - 1.0) {
            return 1.0;
        }
        // 0.45 cm of lamp at the distance of a nose, in rings; depth within 0.5 cm counts in part.
        let reach = 0.45 / self.cell;
        let mut free = 0.0;
        for (x, y) in RING {
            let s = at + Vec2::new(x, y) * reach;
            let (i, j) = (s.x.clamp(0.0, MAP as f32 - 2.0), s.y.clamp(0.0, MAP as f32 - 2.0));
            let (column, row) = (i as u32, j as u32);
            let (fx, fy) = (i - column as f32, j - row as f32);
            let k = row as usize * MAP + column as usize;
            let lit = |k: usize| (1.0 - (self.nearest[k] - q.z - 0.25) / 0.5).clamp(0.0, 1.0);
            let (lo, hi) = (lit(k) + (lit(k + 1) - lit(k)) * fx, lit(k + MAP) + (lit(k + MAP + 1) - lit(k + MAP)) * fx);
            free += lo + (hi - lo) * fy;
        }
        free / RING.len() as f32
    }
}

/// Places on a disc of radius 1: the middle and two rings.
const RING: [(f32, f32); 13] = [
    (0.0, 0.0),
    (0.5, 0.0),
    (-0.5, 0.0),
    (0.0, 0.5),
    (0.0, -0.5),
    (0.92, 0.38),
    (0.38, 0.92),
    (-0.38, 0.92),
    (-0.92, 0.38),
    (-0.92, -0.38),
    (-0.38, -0.92),
    (0.38, -0.92),
    (0.92, -0.38),
];
