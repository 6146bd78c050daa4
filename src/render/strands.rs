//! Lines on their way to the picture: projected once, simplified to a fraction of a pixel, sorted into tiles.

use std::sync::atomic::{AtomicU32, Ordering};

use glam::Vec3;
use rayon::prelude::*;

use crate::geometry::Root;
use crate::task::{Cancelled, Task};

use super::camera::Camera;
use super::shade::Coat;

/// Polylines that one task projects; fixed, so that the order of segments does not depend on the threads.
const CHUNK: usize = 256;
/// How far a simplified line may leave the true one, pixels.
const TOLERANCE: f32 = 0.2;
/// Longest segment in pixels: order in depth is by segment, so long ones are cut.
const LONGEST: f32 = 14.0;
/// Most nodes that one simplified segment replaces.
const MERGED: usize = 10;
/// Pieces one segment may be cut into; what is longer is mostly outside the picture anyway.
const PIECES: f32 = 4096.0;

/// Many lines that look alike.
#[derive(Clone, Copy, Debug)]
pub struct Bundle<'a> {
    /// All nodes, line after line, cm.
    pub points: &'a [Vec3],
    /// Where each line begins in `points`, and the end.
    pub offsets: &'a [u32],
    /// Width in pixels at the first and at the last node.
    pub width: [f32; 2],
    /// How they are coloured.
    pub ink: Ink<'a>,
}

/// How lines are coloured.
#[derive(Clone, Copy, Debug)]
pub enum Ink<'a> {
    /// Shaded as hair; one root per line.
    Hair(Coat, &'a [Root]),
    /// A linear colour per node.
    Flat(&'a [Vec3]),
}

impl Bundle<'_> {
    /// The node of a line that lies at or before the fraction `along` of it.
    pub fn node(&self, line: usize, along: f32) -> usize {
        let (first, end) = (self.offsets[line] as usize, self.offsets[line + 1] as usize);
        // Half a step of what a vertex can hold, so that rounding does not lose a node.
        first + ((along + 0.5 / ALONG) * (end - first - 1) as f32) as usize
    }
}

/// Steps in which a vertex knows its place along its line.
const ALONG: f32 = 65_535.0;

/// A place on a line in the picture. 16 bytes: reading these, scattered as they are, is what a tile does most.
#[derive(Clone, Copy, Debug)]
pub struct Vertex {
    /// Pixels and depth.
    pub at: Vec3,
    along: u16,
    /// Line within the chunk.
    line: u16,
}

impl Vertex {
    /// Where along its line, 0 first node to 1 last.
    pub fn along(&self) -> f32 {
        f32::from(self.along) / ALONG
    }
}

/// Simplified lines and which tiles they touch. Segment `i` joins the vertices `i` and `i + 1`.
#[derive(Debug)]
pub struct Chunk {
    /// Which bundle.
    pub bundle: u32,
    /// The bundle's line that is the chunk's first.
    first: usize,
    /// Vertices, line after line.
    pub vertices: Vec<Vertex>,
    /// Colours of the vertices as far as they are known: 10 bits per channel of the square root, and one that is always
    /// set. Tiles that share a vertex find the same colour, so it does not matter which comes first.
    colours: Vec<AtomicU32>,
    /// Segments, tile after tile: how far behind the nearest vertex in the upper half, which segment in the lower. So a
    /// tile knows the order without looking at the vertices, which lie scattered.
    segments: Vec<u64>,
    /// Where each tile begins in `segments`, and the end.
    starts: Vec<u32>,
}

impl Chunk {
    /// Which line of the bundle a vertex is on.
    pub fn line(&self, vertex: &Vertex) -> usize {
        self.first + usize::from(vertex.line)
    }

    /// The linear colour of a vertex, found by `shade` when it is asked for first. Channels are within 0..=1.
    pub fn colour(&self, vertex: usize, shade: impl FnOnce() -> Vec3) -> Vec3 {
        let mut bits = self.colours[vertex].load(Ordering::Relaxed);
        if bits == 0 {
            let c = shade().clamp(Vec3::ZERO, Vec3::ONE).map(f32::sqrt) * 1023.0 + Vec3::splat(0.5);
            bits = 1 << 30 | (c.x as u32) << 20 | (c.y as u32) << 10 | c.z as u32;
            self.colours[vertex].store(bits, Ordering::Relaxed);
        }
        let c = Vec3::new((bits >> 20 & 1023) as f32, (bits >> 10 & 1023) as f32, (bits & 1023) as f32) / 1023.0;
        c * c
    }

    /// The direction of the line at a vertex, in pixels and depth, from its neighbours.
    pub fn direction(&self, vertex: usize) -> Vec3 {
        let here = &self.vertices[vertex];
        let beside = |k: Option<usize>| {
            k.and_then(|k| self.vertices.get(k)).filter(|v| v.line == here.line).map_or(here.at, |v| v.at)
        };
        beside(Some(vertex + 1)) - beside(vertex.checked_sub(1))
    }

    /// Segments that touch a tile, each with its step of [`DEPTHS`] in the upper 32 bits.
    pub fn segments(&self, tile: usize) -> &[u64] {
        &self.segments[self.starts[tile] as usize..self.starts[tile + 1] as usize]
    }
}

/// A picture cut into square tiles.
#[derive(Clone, Copy, Debug)]
pub struct Tiles {
    /// Edge in pixels.
    pub edge: usize,
    /// Tiles per row.
    pub columns: usize,
    /// Rows of tiles.
    pub rows: usize,
}

impl Tiles {
    /// Tiles of `edge` pixels over a picture.
    pub fn new(width: usize, height: usize, edge: usize) -> Self {
        Self { edge, columns: width.div_ceil(edge), rows: height.div_ceil(edge) }
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.columns * self.rows
    }

    /// Tiles that the box from `lo` to `hi` touches.
    fn touched(self, lo: Vec3, hi: Vec3) -> impl Iterator<Item = usize> {
        let e = self.edge as f32;
        let range = |lo: f32, hi: f32, n: usize| {
            // Also a NaN gives the empty range.
            let first = if lo > 0.0 { (lo / e) as usize } else { 0 };
            let end = if hi >= 0.0 { ((hi / e) as usize + 1).min(n) } else { 0 };
            first..end
        };
        let (xs, ys) = (range(lo.x, hi.x, self.columns), range(lo.y, hi.y, self.rows));
        ys.flat_map(move |y| xs.clone().map(move |x| y * self.columns + x))
    }
}

/// Projects, simplifies and sorts all bundles into tiles.
///
/// # Errors
/// [`Cancelled`].
pub fn gather(bundles: &[Bundle], camera: &Camera, tiles: Tiles, task: &Task) -> Result<Vec<Chunk>, Cancelled> {
    let mut jobs = Vec::new();
    for (b, bundle) in bundles.iter().enumerate() {
        let count = bundle.offsets.len().saturating_sub(1);
        jobs.extend((0..count).step_by(CHUNK).map(|first| (b, first, (first + CHUNK).min(count))));
    }
    let lines: Result<Vec<Vec<Vertex>>, Cancelled> = jobs
        .par_iter()
        .map(|&(b, first, end)| {
            task.check()?;
            let mut vertices = Vec::new();
            let mut nodes = Vec::new();
            let bundle = &bundles[b];
            for line in first..end {
                simplify(bundle, line, (line - first) as u16, camera, &mut nodes, &mut vertices);
            }
            Ok(vertices)
        })
        .collect();
    let lines = lines?;
    task.check()?;
    let depths = Depths::of(&lines);
    Ok(lines
        .into_par_iter()
        .zip(&jobs)
        .map(|(vertices, &(b, first, _))| sorted(b as u32, first, vertices, bundles[b].width, tiles, depths))
        .collect())
}

/// Steps of depth in which segments are ordered: 20 bits.
pub const DEPTHS: f32 = 1_048_575.0;

/// Depth in steps behind the nearest vertex.
#[derive(Clone, Copy)]
struct Depths {
    nearest: f32,
    steps_per_cm: f32,
}

impl Depths {
    fn of(lines: &[Vec<Vertex>]) -> Self {
        let (far, near) = lines
            .par_iter()
            .map(|l| l.iter().fold((f32::INFINITY, f32::NEG_INFINITY), |(a, b), v| (a.min(v.at.z), b.max(v.at.z))))
            .reduce(|| (f32::INFINITY, f32::NEG_INFINITY), |a, b| (a.0.min(b.0), a.1.max(b.1)));
        Self { nearest: near, steps_per_cm: DEPTHS / (near - far).max(1e-3) }
    }

    fn step(self, z: f32) -> u64 {
        ((self.nearest - z) * self.steps_per_cm).clamp(0.0, DEPTHS) as u64
    }
}

/// Appends a line of the bundle, `number` within its chunk, without the nodes that do not show.
fn simplify(bundle: &Bundle, line: usize, number: u16, camera: &Camera, nodes: &mut Vec<Vec3>, out: &mut Vec<Vertex>) {
    let (start, end) = (bundle.offsets[line] as usize, bundle.offsets[line + 1] as usize);
    nodes.clear();
    nodes.extend(bundle.points[start..end].iter().map(|&p| camera.project(p)));
    let margin = bundle.width[0].max(bundle.width[1]) + 2.0;
    let (lo, hi) = nodes.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(lo, hi), &p| (lo.min(p), hi.max(p)));
    let outside =
        hi.x < -margin || hi.y < -margin || lo.x > camera.width as f32 + margin || lo.y > camera.height as f32 + margin;
    if nodes.len() < 2 || outside || nodes.iter().any(|p| !p.is_finite()) {
        return;
    }
    let last = (nodes.len() - 1) as f32;
    let vertex =
        |at, k: usize, part: f32| Vertex { at, along: ((k as f32 + part) / last * ALONG + 0.5) as u16, line: number };
    out.push(vertex(nodes[0], 0, 0.0));
    let mut i = 0;
    while i + 1 < nodes.len() {
        let mut j = i + 1;
        while j + 1 < nodes.len() && j - i < MERGED && follows(&nodes[i..=j + 1]) {
            j += 1;
        }
        let (a, b) = (nodes[i], nodes[j]);
        let length = (b - a).truncate().length();
        if j == i + 1 && length > LONGEST {
            let pieces = (length / LONGEST).ceil().min(PIECES);
            for piece in 1..pieces as usize {
                let part = piece as f32 / pieces;
                out.push(vertex(a + (b - a) * part, i, part));
            }
        }
        out.push(vertex(b, j, 0.0));
        i = j;
    }
}

/// True when the chord from first to last is short enough and near all nodes between.
fn follows(nodes: &[Vec3]) -> bool {
    let (a, b) = (nodes[0].truncate(), nodes[nodes.len() - 1].truncate());
    let chord = b - a;
    let length = chord.length();
    if length > LONGEST {
        return false;
    }
    nodes[1..nodes.len() - 1].iter().all(|p| {
        let q = p.truncate() - a;
        let along = q.dot(chord);
        if length < 1e-6 || along < 0.0 || along > length * length {
            q.length_squared().min((p.truncate() - b).length_squared()) <= TOLERANCE * TOLERANCE
        } else {
            q.perp_dot(chord).abs() <= TOLERANCE * length
        }
    })
}

/// A chunk with its segments counted into tiles.
fn sorted(bundle: u32, first: usize, vertices: Vec<Vertex>, width: [f32; 2], tiles: Tiles, depths: Depths) -> Chunk {
    let margin = Vec3::splat(0.5 * width[0].max(width[1]) + 1.0);
    let touched = |i: usize| {
        let (a, b) = (&vertices[i], &vertices[i + 1]);
        let joined = a.line == b.line;
        joined.then(|| tiles.touched(a.at.min(b.at) - margin, a.at.max(b.at) + margin)).into_iter().flatten()
    };
    let mut starts = vec![0_u32; tiles.count() + 1];
    let count = vertices.len().saturating_sub(1);
    for i in 0..count {
        for tile in touched(i) {
            starts[tile + 1] += 1;
        }
    }
    for tile in 0..tiles.count() {
        starts[tile + 1] += starts[tile];
    }
    let mut next = starts.clone();
    let mut segments = vec![0; starts[tiles.count()] as usize];
    for i in 0..count {
        let behind = depths.step(0.5 * (vertices[i].at.z + vertices[i + 1].at.z)) << 32;
        for tile in touched(i) {
            segments[next[tile] as usize] = behind | i as u64;
            next[tile] += 1;
        }
    }
    let colours = vertices.iter().map(|_| AtomicU32::new(0)).collect();
    Chunk { bundle, first, vertices, colours, segments, starts }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::camera::axes;
    use crate::scene::View;

    fn camera() -> Camera {
        let m = axes(View::Front);
        Camera {
            right: m.x_axis,
            up: m.y_axis,
            toward: m.z_axis,
            centre: Vec3::ZERO,
            scale: 10.0,
            width: 200,
            height: 200,
        }
    }

    fn chunks(lines: &[Vec<Vec3>]) -> (Vec<Chunk>, Vec<Vec3>, Vec<u32>) {
        let points: Vec<Vec3> = lines.iter().flatten().copied().collect();
        let mut offsets = vec![0];
        for line in lines {
            offsets.push(offsets[offsets.len() - 1] + line.len() as u32);
        }
        let bundle = Bundle { points: &points, offsets: &offsets, width: [1.0, 1.0], ink: Ink::Flat(&[]) };
        let chunks = gather(&[bundle], &camera(), Tiles::new(200, 200, 32), &Task::new()).unwrap();
        (chunks, points, offsets)
    }

    #[test]
    fn simplified_lines_stay_near_the_true_ones() {
        use crate::math::trig::{cos, sin};
        let line: Vec<Vec3> = (0..400)
            .map(|i| {
                let a = i as f32 * 0.05;
                Vec3::new(5.0 * cos(a), 0.02 * i as f32 - 4.0, 5.0 * sin(a))
            })
            .collect();
        let (chunks, points, _) = chunks(&[line]);
        let v = &chunks[0].vertices;
        assert!(v.len() < 350, "{} of 400", v.len());
        for p in &points {
            let p = camera().project(*p).truncate();
            let nearest = v
                .windows(2)
                .map(|w| {
                    let (a, b) = (w[0].at.truncate(), w[1].at.truncate());
                    let t = ((p - a).dot(b - a) / (b - a).length_squared().max(1e-9)).clamp(0.0, 1.0);
                    p.distance(a + (b - a) * t)
                })
                .fold(f32::INFINITY, f32::min);
            assert!(nearest <= TOLERANCE + 1e-3, "{nearest}");
        }
    }

    #[test]
    fn every_tile_finds_its_segments() {
        let lines = vec![
            vec![Vec3::new(-9.0, 8.0, 0.0), Vec3::new(9.0, -7.0, 2.0)],
            vec![Vec3::new(-30.0, 0.0, 0.0), Vec3::new(30.0, 1.0, 0.0)],
            vec![Vec3::new(50.0, 50.0, 0.0), Vec3::new(60.0, 50.0, 0.0)],
        ];
        let (chunks, ..) = chunks(&lines);
        let tiles = Tiles::new(200, 200, 32);
        for chunk in &chunks {
            assert!(chunk.vertices.iter().all(|v| v.line != 2), "a line outside the picture");
            for (s, w) in chunk.vertices.windows(2).enumerate().filter(|(_, w)| w[0].line == w[1].line) {
                let middle = (w[0].at + w[1].at) * 0.5;
                if middle.x < 0.0 || middle.y < 0.0 || middle.x >= 200.0 || middle.y >= 200.0 {
                    continue;
                }
                let tile = middle.y as usize / 32 * tiles.columns + middle.x as usize / 32;
                assert!(chunk.segments(tile).iter().any(|&k| k & 0xffff_ffff == s as u64));
                assert!((w[1].at - w[0].at).truncate().length() <= LONGEST + 1e-3);
            }
        }
    }

    #[test]
    fn vertices_know_their_nodes() {
        for n in [2_usize, 3, 64, 1000] {
            let offsets = [0, n as u32];
            let bundle = Bundle { points: &[], offsets: &offsets, width: [1.0, 1.0], ink: Ink::Flat(&[]) };
            for k in 0..n {
                let along = (k as f32 / (n - 1) as f32 * ALONG + 0.5) as u16;
                assert_eq!(bundle.node(0, f32::from(along) / ALONG), k, "of {n}");
            }
        }
    }
}
