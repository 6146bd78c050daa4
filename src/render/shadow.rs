//! Light inside hair: a grid of how much stands in the way, and how much light from one side reaches each cell.
//!
//! Transmittance is carried from layer to layer of the grid, away from the light; each cell takes the bilinear mean of
//! what the layer before it lets through (the slicing of Kniss et al. 2003, "A model for volume lighting"). One sweep
//! costs one pass over the grid whatever the number of strands, and its shadows are soft as those of a wide lamp.

use glam::{Vec3, Vec4};
use rayon::prelude::*;

use crate::geometry::{Bounds, Mesh, Strands};
use crate::task::{Cancelled, Task};

use super::fast;

/// Cells along the longest side of the grid.
const CELLS: f32 = 112.0;
/// Smallest cell in cm: finer ones would show single strands of the preview as blotches.
const FINEST: f32 = 0.16;
/// Optical depth of one cell that holds a piece of skin.
const SKIN: f32 = 5.0;
/// Groups of strands that are summed apart and then in order, so that the sum does not depend on the threads.
const GROUPS: usize = 4;

/// Numbers on a regular grid over space.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    /// Middle of the first cell.
    origin: Vec3,
    /// Edge of a cell, cm.
    cell: f32,
    /// Cells along x, y, z.
    size: [usize; 3],
    /// z fastest, then y, then x.
    values: Vec<f32>,
}

impl Grid {
    /// A grid over `bounds` with one free cell on every side and at most `CELLS` along its longest side.
    fn over(bounds: Bounds) -> Self {
        let bounds = if bounds.is_empty() { Bounds::of([Vec3::splat(-1.0), Vec3::ONE]) } else { bounds };
        let cell = (bounds.size().max_element() / CELLS).max(FINEST);
        let bounds = bounds.grown(1.5 * cell);
        let size = (bounds.size() / cell).to_array().map(|n| (n.ceil() as usize).clamp(2, CELLS as usize + 8));
        Self { origin: bounds.min + Vec3::splat(0.5 * cell), cell, size, values: vec![0.0; size.iter().product()] }
    }

    /// Edge of a cell in cm.
    pub fn cell(&self) -> f32 {
        self.cell
    }

    fn index(&self, p: Vec3) -> Option<usize> {
        let q = (p - self.origin) / self.cell + Vec3::splat(0.5);
        let n = self.size;
        let inside = q.min_element() >= 0.0 && q.x < n[0] as f32 && q.y < n[1] as f32 && q.z < n[2] as f32;
        inside.then(|| (q.x as usize * n[1] + q.y as usize) * n[2] + q.z as usize)
    }

    /// The cell at or before `p`, the fractions on to the next, and the steps along x and y.
    fn place(&self, p: Vec3) -> (usize, Vec3, [usize; 2]) {
        let n = self.size;
        let top = Vec3::new(n[0] as f32 - 1.001, n[1] as f32 - 1.001, n[2] as f32 - 1.001);
        let q = ((p - self.origin) / self.cell).max(Vec3::ZERO).min(top);
        let (x, y, z) = (q.x as usize, q.y as usize, q.z as usize);
        let f = q - Vec3::new(x as f32, y as f32, z as f32);
        (x * n[1] * n[2] + y * n[2] + z, f, [n[1] * n[2], n[2]])
    }

    /// The value at `p` between the cells around it; outside the grid that of its border.
    pub fn sample(&self, p: Vec3) -> f32 {
        let (i, f, [sx, sy]) = self.place(p);
        let v = &self.values;
        let row = |i: usize| v[i] + (v[i + 1] - v[i]) * f.z;
        let plane = |i: usize| {
            let (a, b) = (row(i), row(i + sy));
            a + (b - a) * f.y
        };
        let (a, b) = (plane(i), plane(i + sx));
        a + (b - a) * f.x
    }

    /// The transmittance at `p` of a grid made for the direction `to_light`: outside the grid nothing stands in the way,
    /// so there it is that of the point where the way to the light enters the grid, and 1 where it passes by.
    pub fn sample_toward(&self, p: Vec3, to_light: Vec3) -> f32 {
        let far = Vec3::new(self.size[0] as f32 - 1.0, self.size[1] as f32 - 1.0, self.size[2] as f32 - 1.0);
        let (lo, hi) = (self.origin, self.origin + far * self.cell);
        if p.cmpge(lo).all() && p.cmple(hi).all() {
            return self.sample(p);
        }
        let (mut enter, mut leave) = (0.0_f32, f32::INFINITY);
        for k in 0..3 {
            if to_light[k].abs() < 1e-6 {
                if p[k] < lo[k] || p[k] > hi[k] {
                    return 1.0;
                }
                continue;
            }
            let (a, b) = ((lo[k] - p[k]) / to_light[k], (hi[k] - p[k]) / to_light[k]);
            enter = enter.max(a.min(b));
            leave = leave.min(a.max(b));
        }
        if enter <= leave { self.sample(p + to_light * enter) } else { 1.0 }
    }

    /// The openness at `p`; outside the grid it rises to 1 within six cells.
    pub fn sample_sky(&self, p: Vec3) -> f32 {
        let far = Vec3::new(self.size[0] as f32 - 1.0, self.size[1] as f32 - 1.0, self.size[2] as f32 - 1.0);
        let off = p.distance(p.max(self.origin).min(self.origin + far * self.cell));
        let inside = self.sample(p);
        inside + (1.0 - inside) * (off / (6.0 * self.cell)).min(1.0)
    }

    /// Cells of this grid with the value of another at their middles.
    fn resampled(&self, other: &Self) -> Vec<f32> {
        let n = self.size;
        (0..self.values.len())
            .into_par_iter()
            .map(|i| {
                let at = Vec3::new((i / (n[1] * n[2])) as f32, (i / n[2] % n[1]) as f32, (i % n[2]) as f32);
                other.sample(self.origin + at * self.cell)
            })
            .collect()
    }

    /// A grid of half as many cells along each side, each the mean of eight.
    fn halved(&self) -> Self {
        let size = self.size.map(|n| n.div_ceil(2).max(2));
        let mut values = Vec::with_capacity(size.iter().product());
        let n = self.size;
        for x in 0..size[0] {
            for y in 0..size[1] {
                for z in 0..size[2] {
                    let mut sum = 0.0;
                    for k in 0..8 {
                        let (a, b, c) = (2 * x + (k >> 2), 2 * y + (k >> 1 & 1), 2 * z + (k & 1));
                        if a < n[0] && b < n[1] && c < n[2] {
                            sum += self.values[(a * n[1] + b) * n[2] + c];
                        }
                    }
                    values.push(sum / 8.0);
                }
            }
        }
        Self { origin: self.origin + Vec3::splat(0.5 * self.cell), cell: 2.0 * self.cell, size, values }
    }

    /// Mean over neighbours along one axis with the weights 1 2 1.
    fn blur(&mut self, axis: usize) {
        let stride = [self.size[1] * self.size[2], self.size[2], 1][axis];
        let n = self.size[axis];
        for start in 0..self.values.len() {
            if !(start / stride).is_multiple_of(n) {
                continue;
            }
            let mut before = 0.0;
            for k in 0..n {
                let i = start + k * stride;
                let here = self.values[i];
                let after = if k + 1 < n { self.values[i + stride] } else { 0.0 };
                self.values[i] = 0.25 * before + 0.5 * here + 0.25 * after;
                before = here;
            }
        }
    }
}

/// What stands in the way of light: optical depth per cm of path.
///
/// Skin is shaded by hair alone, and by a finer map of the head (`Depths`): the cells are too coarse for a nose.
#[derive(Clone, Debug)]
pub struct Density {
    /// Strands: their cross-section.
    pub hair: Grid,
    /// Strands and skin.
    pub whole: Grid,
    /// `hair` at half the resolution.
    pub coarse_hair: Grid,
    /// `whole` at half the resolution.
    pub coarse: Grid,
}

/// Finds the density of the given strands and surfaces.
///
/// `hair` is strands with their width at root and tip in cm.
///
/// # Errors
/// [`Cancelled`].
pub fn density(hair: &[(&Strands, f32, f32)], meshes: &[&Mesh], task: &Task) -> Result<Density, Cancelled> {
    let finite = |p: &&Vec3| p.is_finite();
    let mut bounds = Bounds::EMPTY;
    for (strands, ..) in hair {
        bounds = bounds.union(Bounds::of(strands.points.iter().filter(finite).copied()));
    }
    if bounds.is_empty() {
        for mesh in meshes {
            bounds = bounds.union(Bounds::of(mesh.positions.iter().filter(finite).copied()));
        }
    } else {
        // The head stands in the hair's light only where it is near the hair.
        bounds = bounds.grown(2.0);
    }
    let empty = Grid::over(bounds);
    let parts: Result<Vec<Vec<f32>>, Cancelled> = (0..GROUPS)
        .into_par_iter()
        .map(|group| {
            let mut values = vec![0.0_f32; empty.values.len()];
            for &(strands, root, tip) in hair {
                splat(strands, root, tip, group, &empty, &mut values, task)?;
            }
            Ok(values)
        })
        .collect();
    let mut grid = empty;
    for part in parts? {
        for (sum, v) in grid.values.iter_mut().zip(part) {
            *sum += v;
        }
    }
    (0..3).for_each(|axis| grid.blur(axis));
    let mut whole = grid.clone();
    let skin = SKIN / grid.cell;
    for mesh in meshes {
        task.check()?;
        for t in 0..mesh.triangles.len() {
            let [a, b, c] = mesh.corners(t);
            let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
            if !longest.is_finite() || longest > 200.0 {
                continue;
            }
            let steps = (longest / (0.6 * grid.cell)).ceil().max(1.0) as usize;
            for i in 0..=steps {
                for j in 0..=steps - i {
                    let (u, v) = (i as f32 / steps as f32, j as f32 / steps as f32);
                    if let Some(k) = grid.index(a + (b - a) * u + (c - a) * v) {
                        whole.values[k] = skin;
                    }
                }
            }
        }
    }
    Ok(Density { coarse: whole.halved(), coarse_hair: grid.halved(), hair: grid, whole })
}

/// Nodes of strands that are enough to tell the density of hair: of more, every other strand or fewer are counted, each
/// for all of its neighbours.
const ENOUGH: usize = 600_000;

/// Adds one group's strands: per segment width x length over the cell's volume, times pi/4 for the mean shadow of a
/// cylinder over all directions.
fn splat(
    strands: &Strands,
    root: f32,
    tip: f32,
    group: usize,
    grid: &Grid,
    values: &mut [f32],
    task: &Task,
) -> Result<(), Cancelled> {
    let per_volume = std::f32::consts::FRAC_PI_4 / (grid.cell * grid.cell * grid.cell);
    let count = strands.count();
    let step = (strands.points.len() / ENOUGH).clamp(1, 8);
    let end = (group + 1) * count / GROUPS;
    for (done, first) in (group * count / GROUPS..end).step_by(step).enumerate() {
        if done % 256 == 0 {
            task.check()?;
        }
        // One of the next few, by chance, so that no order of the strands is mistaken for their places.
        let few = step.min(end - first);
        let i = first + (done.wrapping_mul(0x9e37_79b1) >> 12) % few;
        let per_volume = per_volume * few as f32;
        let nodes = strands.strand(i);
        let last = (nodes.len() as f32 - 1.0).max(1.0);
        for (k, w) in nodes.windows(2).enumerate() {
            let length = w[0].distance(w[1]);
            if !length.is_finite() || length > 1e3 {
                continue;
            }
            let area = length * (root + (tip - root) * (k as f32 + 0.5) / last) * per_volume;
            let pieces = (length / grid.cell).ceil().max(1.0);
            for piece in 0..pieces as usize {
                let t = (piece as f32 + 0.5) / pieces;
                if let Some(cell) = grid.index(w[0] + (w[1] - w[0]) * t) {
                    values[cell] += area / pieces;
                }
            }
        }
    }
    Ok(())
}

/// Light of a row of cells: the mean, by the fractions `f`, of two rows of the layer before; and what of it they let pass.
#[multiversion::multiversion(targets("x86_64+avx2"))]
fn pass(near: &[f32], far: &[f32], f: [f32; 2], stands: &[f32], path: f32, light: &mut [f32], out: &mut [f32]) {
    let n = stands.len();
    let (near, far, light, out) = (&near[..=n], &far[..=n], &mut light[..n], &mut out[..n]);
    let (near1, far1) = (&near[1..=n], &far[1..=n]);
    for j in 0..n {
        let lo = near[j] * (1.0 - f[1]) + near1[j] * f[1];
        let hi = far[j] * (1.0 - f[1]) + far1[j] * f[1];
        light[j] = lo * (1.0 - f[0]) + hi * f[0];
        out[j] = light[j] * fast::exp(-stands[j] * path);
    }
}

/// The fraction of light from the direction `to_light` (a unit vector) that reaches each cell of `density`.
pub fn transmittance(density: &Grid, to_light: Vec3) -> Grid {
    let n = density.size;
    let strides = [n[1] * n[2], n[2], 1];
    let l = to_light.to_array();
    let a = (0..3).max_by(|&i, &j| l[i].abs().total_cmp(&l[j].abs())).unwrap_or(1);
    // Rows run along z, whose cells lie side by side, where they can.
    let (b, c) = [(1, 2), (0, 2), (0, 1)][a];
    let steep = l[a].abs().max(1e-6);
    let (db, dc) = (l[b] / steep, l[c] / steep);
    let path = density.cell / steep;
    let (nb, nc) = (n[b], n[c]);
    // What the layer before lets through, with a free border of one cell before and two behind.
    let row = nc + 3;
    let mut before = vec![1.0_f32; (nb + 3) * row];
    let mut out = before.clone();
    let mut values = vec![1.0_f32; density.values.len()];
    let (mut stands, mut light) = (vec![0.0_f32; nc], vec![0.0_f32; nc]);
    // The offset is within -1..=1 cells: its whole part is -1, 0 or 1 and its fraction is the same for all cells.
    let (wb, wc) = (db.floor(), dc.floor());
    let (fb, fc) = (db - wb, dc - wc);
    let from = (1 + wc as isize) as usize;
    for layer in 0..n[a] {
        let k = if l[a] > 0.0 { n[a] - 1 - layer } else { layer };
        for i in 0..nb {
            let above = (i as isize + 1 + wb as isize) as usize * row + from;
            let start = k * strides[a] + i * strides[b];
            let cells = (0..nc).map(|j| start + j * strides[c]);
            for (stands, cell) in stands.iter_mut().zip(cells.clone()) {
                *stands = density.values[cell];
            }
            let next = &mut out[(i + 1) * row + 1..][..nc];
            pass(
                &before[above..][..nc + 1],
                &before[above + row..][..nc + 1],
                [fb, fc],
                &stands,
                path,
                &mut light,
                next,
            );
            for (&light, cell) in light.iter().zip(cells) {
                values[cell] = light;
            }
        }
        std::mem::swap(&mut before, &mut out);
    }
    Grid { values, ..density.clone_frame() }
}

impl Grid {
    fn clone_frame(&self) -> Self {
        Self { origin: self.origin, cell: self.cell, size: self.size, values: Vec::new() }
    }
}

/// Four values per cell: the sky and three lamps, found together by one look-up.
#[derive(Clone, Debug)]
pub struct Lights {
    frame: Grid,
    values: Vec<Vec4>,
}

impl Lights {
    /// The openness `sky`, and the transmittance of `density` towards three lamps.
    pub fn new(density: &Grid, sky: &Grid, lamps: [Vec3; 3]) -> Self {
        let mut sweeps: Vec<Grid> = lamps.par_iter().map(|&d| transmittance(density, d)).collect();
        let sky = density.resampled(sky);
        let (c, b, a) = (sweeps.pop(), sweeps.pop(), sweeps.pop());
        let of = |g: &Option<Grid>, i: usize| g.as_ref().map_or(1.0, |g| g.values[i]);
        let values = sky.par_iter().enumerate().map(|(i, &s)| Vec4::new(s, of(&a, i), of(&b, i), of(&c, i))).collect();
        Self { frame: density.clone_frame(), values }
    }

    /// The four values at `p`, between the cells around it.
    pub fn sample(&self, p: Vec3) -> Vec4 {
        let (i, f, [sx, sy]) = self.frame.place(p);
        let v = &self.values;
        let row = |i: usize| v[i] + (v[i + 1] - v[i]) * f.z;
        let plane = |i: usize| {
            let (a, b) = (row(i), row(i + sy));
            a + (b - a) * f.y
        };
        let (a, b) = (plane(i), plane(i + sx));
        a + (b - a) * f.x
    }
}

/// How open each cell is to a sky all around that is brighter above: 0 buried, 1 free.
///
/// # Errors
/// [`Cancelled`].
pub fn openness(coarse: &Grid, task: &Task) -> Result<Grid, Cancelled> {
    let directions: Vec<Vec3> = (0..27)
        .map(|k| Vec3::new((k / 9) as f32 - 1.0, (k / 3 % 3) as f32 - 1.0, (k % 3) as f32 - 1.0))
        .filter(|d| matches!(d.length_squared() as u32, 1 | 3))
        .map(Vec3::normalize)
        .collect();
    let sweeps: Vec<Grid> = directions.par_iter().map(|&d| transmittance(coarse, d)).collect();
    task.check()?;
    let mut open = coarse.clone_frame();
    open.values = vec![0.0; coarse.values.len()];
    let total: f32 = directions.iter().map(|d| 1.0 + 0.5 * d.y).sum();
    for (d, sweep) in directions.iter().zip(sweeps) {
        let weight = (1.0 + 0.5 * d.y) / total;
        for (sum, v) in open.values.iter_mut().zip(sweep.values) {
            *sum += weight * v;
        }
    }
    Ok(open)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn slab() -> Grid {
        // A layer of optical density 2 per cm between y = 0 and y = 1.
        let mut grid = Grid::over(Bounds { min: Vec3::splat(-2.0), max: Vec3::splat(2.0) });
        let n = grid.size;
        for i in 0..grid.values.len() {
            let y = grid.origin.y + grid.cell * (i / n[2] % n[1]) as f32;
            if (0.0..1.0).contains(&y) {
                grid.values[i] = 2.0;
            }
        }
        grid
    }

    #[test]
    fn a_slab_lets_through_what_beer_and_lambert_say() {
        let grid = slab();
        let light = transmittance(&grid, Vec3::Y);
        assert!((light.sample(Vec3::new(0.0, 1.6, 0.0)) - 1.0).abs() < 1e-4);
        let below = light.sample(Vec3::new(0.0, -0.5, 0.0));
        // One cell of uncertainty about the slab's thickness.
        let (lo, hi) = (fast::exp(-2.0 * (1.0 + grid.cell)), fast::exp(-2.0 * (1.0 - grid.cell)));
        assert!(below > lo && below < hi, "{below} not in {lo}..{hi}");
        // From below, the other way round.
        let light = transmittance(&grid, Vec3::NEG_Y);
        assert!((light.sample(Vec3::new(0.0, -0.5, 0.0)) - 1.0).abs() < 1e-4);
        assert!(light.sample(Vec3::new(0.0, 1.6, 0.0)) < hi);
    }

    #[test]
    fn a_slanted_light_goes_the_longer_way() {
        let grid = slab();
        let steep = transmittance(&grid, Vec3::Y).sample(Vec3::new(0.0, -0.3, 0.0));
        let slant = transmittance(&grid, Vec3::new(0.5, 1.0, 0.3).normalize()).sample(Vec3::new(0.0, -0.3, 0.0));
        assert!(slant < 0.9 * steep, "{slant} {steep}");
    }

    #[test]
    fn shadows_go_on_outside_the_grid() {
        let light = transmittance(&slab(), Vec3::Y);
        let under = light.sample_toward(Vec3::new(0.0, -40.0, 0.0), Vec3::Y);
        assert!((under - light.sample(Vec3::new(0.0, -0.5, 0.0))).abs() < 1e-3);
        assert_eq!(light.sample_toward(Vec3::new(50.0, -40.0, 0.0), Vec3::Y), 1.0);
        assert!((light.sample_toward(Vec3::new(0.0, 40.0, 0.0), Vec3::Y) - 1.0).abs() < 1e-3);
    }

    #[test]
    fn an_empty_scene_is_open() {
        let grid = density(&[], &[], &Task::new()).unwrap();
        let open = openness(&grid.coarse, &Task::new()).unwrap();
        assert!((open.sample(Vec3::ZERO) - 1.0).abs() < 1e-5);
        assert!(open.sample(Vec3::splat(1e9)).is_finite());
    }

    #[test]
    fn strands_keep_their_cross_section() {
        let mut strands = Strands::new();
        let root =
            crate::geometry::Root { id: 1, position: Vec3::ZERO, normal: Vec3::Y, uv: glam::Vec2::ZERO, triangle: 0 };
        strands.push(root, 0, [Vec3::ZERO, Vec3::new(0.0, 3.0, 0.0), Vec3::new(0.0, 3.0, 7.0)]);
        let grid = density(&[(&strands, 0.02, 0.02)], &[], &Task::new()).unwrap().hair;
        let area: f32 = grid.values.iter().sum::<f32>() * grid.cell.powi(3) / std::f32::consts::FRAC_PI_4;
        assert!((area - 10.0 * 0.02).abs() < 1e-4, "{area}");
    }
}
