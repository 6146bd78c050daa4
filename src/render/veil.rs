//! Where hair is so dense that nothing shows behind it.
//!
//! Nine strands out of ten lie behind others. A few of them tell about where: one in [`STEP`] is projected, its cover
//! counted that many times, and in every cell of the picture the depth is found by which that makes the cell opaque.
//! Segments that lie behind are left out before anything costly is done to them. The guess decides the time only: where
//! pixels turn out to be open after all, the segments left out that touch one of these are drawn in a second round.

use glam::Vec3;
use rayon::prelude::*;

use crate::task::{Cancelled, Task};

use super::camera::Camera;
use super::fast;
use super::strands::{Bundle, Projected};
use super::surface::Layer;

/// Edge of a cell in pixels.
const CELL: usize = 8;
/// One strand in so many is looked at.
const STEP: usize = 16;
/// Cover after which a cell is taken for opaque: what passes between strands laid at random is e to the power of minus
/// this, and one part in 64 is the end of drawing.
const OPAQUE: f32 = 6.0;
/// Lines that one task looks at.
const SHARE: usize = 4096;

/// The depth behind which nothing shows, for each cell of the picture.
#[derive(Clone, Debug)]
pub struct Veil {
    map: Map,
    /// Because of the surfaces, which is certain; and because of them or the hair, which is a guess. Negative infinity
    /// where nothing hides anything, infinity outside the picture.
    depths: Vec<[f32; 2]>,
}

/// Squares of a picture with one more around it for all that lies outside.
#[derive(Clone, Copy, Debug)]
struct Map {
    columns: usize,
    rows: usize,
    per_pixel: f32,
}

impl Map {
    fn new(width: usize, height: usize, edge: usize) -> Self {
        Self { columns: width.div_ceil(edge) + 2, rows: height.div_ceil(edge) + 2, per_pixel: 1.0 / edge as f32 }
    }

    /// The square that holds a place in pixels.
    #[inline(always)]
    fn at(self, x: f32, y: f32) -> u32 {
        let square = |v: f32, n: usize| {
            let (v, last) = (v * self.per_pixel + 1.0, (n - 1) as f32);
            let v = if v > 0.0 { v } else { 0.0 };
            fast::floor(if v < last { v } else { last })
        };
        square(y, self.rows) * self.columns as u32 + square(x, self.columns)
    }

    /// The squares of the picture, row by row, without those around.
    fn inner(self) -> impl Iterator<Item = usize> {
        (1..self.rows - 1).flat_map(move |y| (1..self.columns - 1).map(move |x| y * self.columns + x))
    }
}

/// Finds the squares of nodes and of the middles between them.
#[multiversion::multiversion(targets("x86_64+avx2"))]
fn squares(map: Map, x: &[f32], y: &[f32], nodes: &mut [u32], middles: &mut [u32]) {
    let n = x.len();
    let (y, nodes, middles) = (&y[..n], &mut nodes[..n], &mut middles[..n - 1]);
    for k in 0..n {
        nodes[k] = map.at(x[k], y[k]);
    }
    let (x1, y1) = (&x[1..n], &y[1..n]);
    for k in 0..n - 1 {
        middles[k] = map.at(0.5 * (x[k] + x1[k]), 0.5 * (y[k] + y1[k]));
    }
}

/// A piece of a strand: its cell, depth and cover in pixels.
#[derive(Clone, Copy, Default)]
struct Patch {
    cell: u32,
    z: f32,
    cover: f32,
}

impl Veil {
    /// Of these lines over this surface, `behind` whose depth by so much nothing shows if it is all there (`solid` is 1).
    ///
    /// # Errors
    /// [`Cancelled`].
    pub fn new(
        bundles: &[Bundle],
        camera: &Camera,
        layer: &Layer,
        solid: f32,
        behind: f32,
        task: &Task,
    ) -> Result<Self, Cancelled> {
        let (columns, rows) = (camera.width.div_ceil(CELL), camera.height.div_ceil(CELL));
        let mut jobs = vec![];
        for bundle in bundles {
            let count = bundle.offsets.len().saturating_sub(1);
            jobs.extend((0..count).step_by(SHARE).map(|first| (bundle, first..(first + SHARE).min(count))));
        }
        let patches: Result<Vec<Vec<Patch>>, Cancelled> = jobs
            .into_par_iter()
            .map(|(bundle, lines)| {
                task.check()?;
                let (mut patches, mut nodes) = (vec![], Projected::default());
                for group in lines.step_by(STEP) {
                    // A different one of each group, so that no order of the strands is mistaken for their places.
                    let line = group + (group / STEP).wrapping_mul(0x9e37_79b1) % (1 << 20) * STEP / (1 << 20);
                    if line + 1 < bundle.offsets.len() {
                        cover(bundle, line, camera, columns, rows, &mut nodes, &mut patches);
                    }
                }
                Ok(patches)
            })
            .collect();
        let patches = by_cell(&patches?, columns * rows);
        let surface = match solid >= 1.0 {
            true => opaque_surface(layer, columns, rows, behind),
            false => vec![f32::NEG_INFINITY; columns * rows],
        };
        let map = Map::new(camera.width, camera.height, CELL);
        let mut depths = vec![[f32::INFINITY; 2]; map.columns * map.rows];
        for (c, i) in map.inner().enumerate() {
            depths[i] = [surface[c], surface[c].max(opaque_hair(patches.of(c)))];
        }
        Ok(Self { map, depths })
    }

    /// A veil that hides nothing in the picture.
    #[cfg(test)]
    pub fn none(camera: &Camera) -> Self {
        let map = Map::new(camera.width, camera.height, CELL);
        let mut depths = vec![[f32::INFINITY; 2]; map.columns * map.rows];
        map.inner().for_each(|i| depths[i] = [f32::NEG_INFINITY; 2]);
        Self { map, depths }
    }
}

/// What a round draws: at first the segments in front of the veil, then those behind it that touch an open pixel.
#[derive(Clone, Copy, Debug)]
pub struct Sieve<'a> {
    /// The guess.
    pub veil: &'a Veil,
    /// Of the second round.
    pub holes: Option<&'a Holes>,
}

/// Marks of the segments of a line, and what it takes to find them.
#[derive(Debug, Default)]
pub struct Marks {
    nodes: Vec<u32>,
    middles: Vec<u32>,
    /// True for the segments to be drawn.
    pub kept: Vec<bool>,
}

/// Segments longer than this, in pixels, are judged in pieces.
const LONG: f32 = 2.0 * CELL as f32;

impl Sieve<'_> {
    /// Marks the segments of a line that are drawn, as far as is known without cutting them.
    pub fn mark(&self, line: &Projected, marks: &mut Marks) {
        let n = line.x.len();
        marks.nodes.resize(n, 0);
        marks.middles.resize(n - 1, 0);
        marks.kept.resize(n - 1, false);
        squares(self.veil.map, &line.x, &line.y, &mut marks.nodes, &mut marks.middles);
        let depths = &self.veil.depths;
        let z = &line.z;
        let seen = |square: u32, z: f32| depths[square as usize].map(|depth| z >= depth);
        let mut before = seen(marks.nodes[0], z[0]);
        for k in 0..n - 1 {
            let after = seen(marks.nodes[k + 1], z[k + 1]);
            let middle = seen(marks.middles[k], 0.5 * (z[k] + z[k + 1]));
            let [possible, front] = [0, 1].map(|i| before[i] | middle[i] | after[i]);
            before = after;
            let (dx, dy) = ((line.x[k + 1] - line.x[k]).abs(), (line.y[k + 1] - line.y[k]).abs());
            marks.kept[k] = match self.holes {
                _ if dx.max(dy) > LONG => true,
                None => front,
                Some(holes) => possible && !front && holes.touch(line.at(k), line.at(k + 1)),
            };
        }
    }

    /// The same for one segment, at most [`LONG`].
    pub fn keeps(&self, a: Vec3, b: Vec3) -> bool {
        let middle = 0.5 * (a + b);
        let [possible, front] = [a, middle, b]
            .map(|p| self.veil.depths[self.veil.map.at(p.x, p.y) as usize].map(|depth| p.z >= depth))
            .into_iter()
            .fold([false; 2], |[p, f], [q, g]| [p | q, f | g]);
        match self.holes {
            None => front,
            Some(holes) => possible && !front && holes.touch(a, b),
        }
    }
}

/// Pixels that are still open.
#[derive(Clone, Debug)]
pub struct Holes {
    /// Squares of 2 x 2 pixels: true where one of them, or one next to them, is open.
    fine: Map,
    open: Vec<bool>,
    /// The same of larger squares.
    coarse: Map,
    coarse_open: Vec<bool>,
}

/// Edge of the larger squares of [`Holes`]: with the neighbours they reach over half the distance between the ends of a
/// segment and its middle.
const COARSE: usize = LONG as usize / 4;

impl Holes {
    /// No holes in a picture of this size.
    pub fn new(width: usize, height: usize) -> Self {
        let (fine, coarse) = (Map::new(width, height, 2), Map::new(width, height, COARSE));
        let [open, coarse_open] = [fine, coarse].map(|map| vec![false; map.columns * map.rows]);
        Self { fine, open, coarse, coarse_open }
    }

    /// Notes that a pixel is open.
    pub fn add(&mut self, x: usize, y: usize) {
        // Squares that hold the pixel's neighbours.
        for row in [y.div_ceil(2), (y + 3) / 2] {
            for column in [x.div_ceil(2), (x + 3) / 2] {
                self.open[row * self.fine.columns + column] = true;
            }
        }
        let at = y / COARSE * self.coarse.columns + x / COARSE;
        for row in 0..3 {
            self.coarse_open[at + row * self.coarse.columns..][..3].fill(true);
        }
    }

    /// True when a segment passes an open pixel.
    fn touch(&self, a: Vec3, b: Vec3) -> bool {
        let d = b - a;
        let near = |t: f32| self.coarse_open[self.coarse.at(a.x + d.x * t, a.y + d.y * t) as usize];
        if !(near(0.5) || near(0.0) || near(1.0)) {
            return false;
        }
        let steps = (0.5 * d.x.abs().max(d.y.abs())).min(LONG) as usize + 1;
        let step = d / steps as f32;
        (0..=steps).any(|i| {
            let p = a + step * i as f32;
            self.open[self.fine.at(p.x, p.y) as usize]
        })
    }
}

/// Adds what a line covers.
fn cover(
    bundle: &Bundle,
    line: usize,
    camera: &Camera,
    columns: usize,
    rows: usize,
    nodes: &mut Projected,
    out: &mut Vec<Patch>,
) {
    if !nodes.project(bundle, line, camera) {
        return;
    }
    let last = (nodes.count() - 1) as f32;
    for k in 0..nodes.count() - 1 {
        let (a, b) = (nodes.at(k), nodes.at(k + 1));
        let length = (b - a).truncate().length();
        let width = bundle.width[0] + (bundle.width[1] - bundle.width[0]) * ((k as f32 + 0.5) / last);
        let pieces = (length / CELL as f32 + 0.5).clamp(1.0, 512.0) as usize;
        for piece in 0..pieces {
            let p = a + (b - a) * ((piece as f32 + 0.5) / pieces as f32);
            let (x, y) = (p.x / CELL as f32, p.y / CELL as f32);
            if x >= 0.0 && y >= 0.0 && x < columns as f32 && y < rows as f32 {
                let cell = (y as usize * columns + x as usize) as u32;
                out.push(Patch { cell, z: p.z, cover: width * length / pieces as f32 });
            }
        }
    }
}

/// Patches, cell after cell.
struct Sorted {
    patches: Vec<Patch>,
    starts: Vec<u32>,
}

impl Sorted {
    fn of(&self, cell: usize) -> &[Patch] {
        &self.patches[self.starts[cell] as usize..self.starts[cell + 1] as usize]
    }
}

fn by_cell(parts: &[Vec<Patch>], cells: usize) -> Sorted {
    let mut starts = vec![0_u32; cells + 1];
    for patch in parts.iter().flatten() {
        starts[patch.cell as usize + 1] += 1;
    }
    for c in 0..cells {
        starts[c + 1] += starts[c];
    }
    let mut next = starts.clone();
    let mut patches = vec![Patch::default(); starts[cells] as usize];
    for patch in parts.iter().flatten() {
        let at = &mut next[patch.cell as usize];
        patches[*at as usize] = *patch;
        *at += 1;
    }
    Sorted { patches, starts }
}

/// The depth at which patches, counted [`STEP`] times, make their cell opaque; negative infinity when they do not.
fn opaque_hair(patches: &[Patch]) -> f32 {
    let enough = OPAQUE * (CELL * CELL) as f32 / STEP as f32;
    if patches.iter().map(|p| p.cover).sum::<f32>() < enough {
        return f32::NEG_INFINITY;
    }
    let mut order: Vec<(f32, f32)> = patches.iter().map(|p| (p.z, p.cover)).collect();
    order.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.total_cmp(&b.1)));
    let mut sum = 0.0;
    for (z, cover) in order {
        sum += cover;
        if sum >= enough {
            return z;
        }
    }
    f32::NEG_INFINITY
}

/// The depth behind which surfaces hide everything, for each cell; they do so `behind` their own depth.
fn opaque_surface(layer: &Layer, columns: usize, rows: usize, behind: f32) -> Vec<f32> {
    let mut farthest = vec![f32::INFINITY; columns * rows];
    for (y, (depth, cover)) in layer.depth.chunks(layer.width).zip(layer.cover.chunks(layer.width)).enumerate() {
        let cells = &mut farthest[y / CELL * columns..][..columns];
        for ((cell, depth), cover) in cells.iter_mut().zip(depth.chunks(CELL)).zip(cover.chunks(CELL)) {
            for (&z, &part) in depth.iter().zip(cover) {
                *cell = cell.min(if part >= 1.0 { z - behind } else { f32::NEG_INFINITY });
            }
        }
    }
    farthest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cell_is_opaque_at_the_depth_where_its_cover_is_enough() {
        let patch = |z: f32| Patch { cell: 0, z, cover: 1.0 };
        let enough = (OPAQUE * (CELL * CELL) as f32 / STEP as f32).ceil() as usize;
        let few: Vec<Patch> = (1..enough).map(|i| patch(-(i as f32))).collect();
        assert_eq!(opaque_hair(&few), f32::NEG_INFINITY);
        // In whatever order they come: the depth of the one that makes it whole.
        let many: Vec<Patch> = (0..3 * enough).map(|i| patch(-((i * 7 % (3 * enough)) as f32))).collect();
        assert_eq!(opaque_hair(&many), 1.0 - enough as f32);
    }

    #[test]
    fn segments_that_pass_an_open_pixel_are_found() {
        let mut holes = Holes::new(100, 60);
        holes.add(41, 30);
        holes.add(99, 59);
        let at = |x: f32, y: f32| Vec3::new(x, y, 0.0);
        for a in [at(33.0, 26.0), at(41.5, 30.5), at(42.3, 29.0), at(48.0, 33.0)] {
            // Through the middle of the pixel and as far beyond.
            let b = 2.0 * at(41.5, 30.5) - a;
            assert!(holes.touch(a, b) && holes.touch(b, a), "{a} {b}");
        }
        assert!(holes.touch(at(99.0, 59.5), at(130.0, 70.0) * 0.8));
        for (a, b) in
            [(at(20.0, 30.0), at(34.0, 30.0)), (at(41.0, 36.0), at(41.0, 45.0)), (at(0.0, 0.0), at(10.0, 9.0))]
        {
            assert!(!holes.touch(a, b), "{a} {b}");
        }
    }

    #[test]
    fn every_place_has_a_square() {
        let map = Map::new(50, 30, 8);
        let all = (map.columns * map.rows) as u32;
        for x in [f32::NEG_INFINITY, -9.0, 0.0, 7.9, 8.1, 49.0, 51.0, 1e9, f32::INFINITY, f32::NAN] {
            assert!(map.at(x, 3.0) < all && map.at(3.0, x) < all && map.at(x, x) < all);
        }
        let inner: Vec<usize> = map.inner().collect();
        assert_eq!(inner.len(), 7 * 4);
        assert_eq!((map.at(0.5, 0.5) as usize, map.at(49.5, 29.5) as usize), (inner[0], inner[27]));
        assert!(!inner.contains(&(map.at(-1.0, 3.0) as usize)));
    }
}
