//! From strands to lines in the picture: projected, thinned to what can show, simplified to a fraction of a pixel,
//! coloured, sorted into tiles.

use glam::Vec3;
use rayon::prelude::*;

use crate::geometry::Root;
use crate::task::{Cancelled, Task};

use super::camera::Camera;
use super::shade::{Coat, Lanes, Studio};
use super::tiles::{Binned, Tiles, Vertex};
use super::veil::{Marks, Sieve};

/// Lines that one task projects; fixed, so that the order of segments does not depend on the threads.
const CHUNK: usize = 256;
/// How far a simplified line may leave the true one, pixels.
const TOLERANCE: f32 = 0.2;
/// Longest segment in pixels: order in depth is by segment, so long ones are cut.
const LONGEST: f32 = 14.0;
/// Most nodes that one simplified segment replaces.
const MERGED: usize = 10;
/// Pieces one segment may be cut into; what is longer is mostly outside the picture anyway.
const PIECES: f32 = 4096.0;
/// Vertices after which a chunk is closed and another begun.
const FULL: usize = 1 << 20;

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
    /// How far in pixels beyond its middle a line may colour pixels.
    pub fn margin(&self) -> f32 {
        // Cover is counted across the longer axis: a slanted line is wider there, by up to the square root of two.
        0.75 * self.width[0].max(self.width[1]) + 1.0
    }
}

/// The nodes of one line in the picture, each coordinate apart.
#[derive(Default)]
pub struct Projected {
    /// Pixels from the left.
    pub x: Vec<f32>,
    /// Pixels from the top.
    pub y: Vec<f32>,
    /// Depth, cm.
    pub z: Vec<f32>,
}

impl Projected {
    /// Takes the nodes of a line; false when it has none to draw or one of them is not a number.
    pub fn project(&mut self, bundle: &Bundle, line: usize, camera: &Camera) -> bool {
        let points = &bundle.points[bundle.offsets[line] as usize..bundle.offsets[line + 1] as usize];
        for axis in [&mut self.x, &mut self.y, &mut self.z] {
            axis.resize(points.len(), 0.0);
        }
        points.len() >= 2 && project(points, camera.rows(), &mut self.x, &mut self.y, &mut self.z)
    }

    /// How many nodes there are.
    pub fn count(&self) -> usize {
        self.x.len()
    }

    /// Pixels and depth of a node.
    pub fn at(&self, k: usize) -> Vec3 {
        Vec3::new(self.x[k], self.y[k], self.z[k])
    }

    /// True when the chord from node `first` to node `last` is short enough and near all nodes between.
    fn follows(&self, first: usize, last: usize) -> bool {
        let (a, b) = (self.at(first).truncate(), self.at(last).truncate());
        let chord = b - a;
        let square = chord.length_squared();
        if square > LONGEST * LONGEST {
            return false;
        }
        (first + 1..last).all(|k| {
            let q = self.at(k).truncate() - a;
            let along = q.dot(chord);
            if square < 1e-12 || along < 0.0 || along > square {
                q.length_squared().min((q - chord).length_squared()) <= TOLERANCE * TOLERANCE
            } else {
                let off = q.perp_dot(chord);
                off * off <= TOLERANCE * TOLERANCE * square
            }
        })
    }
}

/// Projects `points` by the rows of a camera; false when one is not finite.
#[multiversion::multiversion(targets("x86_64+avx2"))]
fn project(points: &[Vec3], rows: [[f32; 4]; 3], x: &mut [f32], y: &mut [f32], z: &mut [f32]) -> bool {
    let n = points.len();
    let (x, y, z) = (&mut x[..n], &mut y[..n], &mut z[..n]);
    let mut off = 0.0;
    for i in 0..n {
        let p = points[i];
        let row = |r: [f32; 4]| p.x * r[0] + p.y * r[1] + p.z * r[2] + r[3];
        (x[i], y[i], z[i]) = (row(rows[0]), row(rows[1]), row(rows[2]));
    }
    for i in 0..n {
        // Stays 0 as long as all are finite.
        off += (x[i] + y[i] + z[i]) * 0.0;
    }
    off == 0.0
}

/// Projects all bundles, leaves out what `sieve` does not draw, simplifies, colours and sorts the rest into tiles.
///
/// # Errors
/// [`Cancelled`].
pub fn gather(
    bundles: &[Bundle],
    camera: &Camera,
    tiles: Tiles,
    sieve: Sieve,
    studio: &Studio,
    task: &Task,
) -> Result<Vec<Binned>, Cancelled> {
    let mut jobs = Vec::new();
    for bundle in bundles {
        let count = bundle.offsets.len().saturating_sub(1);
        jobs.extend((0..count).step_by(CHUNK).map(|first| (bundle, first..(first + CHUNK).min(count))));
    }
    let chunks: Result<Vec<Vec<Binned>>, Cancelled> = jobs
        .into_par_iter()
        .map(|(bundle, lines)| {
            task.check()?;
            let mut pen = Pen::new(bundle, tiles, sieve, studio);
            let mut nodes = Projected::default();
            for line in lines {
                if nodes.project(bundle, line, camera) {
                    pen.line(line, &nodes);
                }
            }
            pen.close();
            Ok(pen.chunks)
        })
        .collect();
    Ok(chunks?.into_iter().flatten().collect())
}

/// Where on its bundle a vertex lies.
#[derive(Clone, Copy)]
struct Place {
    line: u32,
    /// Index into the bundle's points.
    node: u32,
    /// On the way to the next node, 0..1.
    part: f32,
}

/// Writes lines down as vertices.
struct Pen<'a> {
    bundle: &'a Bundle<'a>,
    tiles: Tiles,
    sieve: Sieve<'a>,
    marks: Marks,
    studio: &'a Studio<'a>,
    margin: f32,
    /// Pixels and depth of the vertices.
    at: Vec<Vec3>,
    places: Vec<Place>,
    /// Vertices that are joined with the next.
    joined: Vec<u32>,
    chunks: Vec<Binned>,
}

impl<'a> Pen<'a> {
    fn new(bundle: &'a Bundle<'a>, tiles: Tiles, sieve: Sieve<'a>, studio: &'a Studio<'a>) -> Self {
        let (at, places, joined, chunks) = (vec![], vec![], vec![], vec![]);
        let marks = Marks::default();
        Self { bundle, tiles, sieve, marks, studio, margin: bundle.margin(), at, places, joined, chunks }
    }

    /// Takes what can show of a line.
    fn line(&mut self, line: usize, nodes: &Projected) {
        self.sieve.mark(nodes, &mut self.marks);
        let mut k = 0;
        while k < self.marks.kept.len() {
            let first = k;
            while self.marks.kept.get(k) == Some(&true) {
                k += 1;
            }
            if k > first {
                self.run(line, nodes, first, k);
            }
            k += 1;
        }
    }

    /// Takes the nodes from `first` to `last`, without those that do not show.
    fn run(&mut self, line: usize, nodes: &Projected, first: usize, last: usize) {
        let start = self.bundle.offsets[line] as usize;
        let place = |k: usize, part: f32| Place { line: line as u32, node: (start + k) as u32, part };
        self.begin(nodes.at(first), place(first, 0.0));
        let mut i = first;
        while i < last {
            let mut j = i + 1;
            while j < last && j - i < MERGED && nodes.follows(i, j + 1) {
                j += 1;
            }
            let (a, b) = (nodes.at(i), nodes.at(j));
            let length = (b - a).truncate().length();
            if j == i + 1 && length > LONGEST {
                self.cut(a, b, length, |part| place(i, part));
            } else {
                self.join(b, place(j, 0.0));
            }
            if self.at.len() >= FULL {
                self.close();
                self.begin(b, place(j, 0.0));
            }
            i = j;
        }
    }

    /// Takes those pieces of a long segment that can show.
    fn cut(&mut self, a: Vec3, b: Vec3, length: f32, place: impl Fn(f32) -> Place) {
        let pieces = (length / LONGEST).ceil().min(PIECES);
        let mut from = a;
        let mut apart = false;
        for piece in 1..=pieces as usize {
            let part = piece as f32 / pieces;
            let to = if part < 1.0 { a + (b - a) * part } else { b };
            if self.sieve.keeps(from, to) {
                if apart {
                    self.begin(from, place((piece - 1) as f32 / pieces));
                }
                self.join(to, place(part));
                apart = false;
            } else {
                apart = true;
            }
            from = to;
        }
        if apart {
            self.begin(b, place(1.0));
        }
    }

    fn begin(&mut self, at: Vec3, place: Place) {
        self.at.push(at);
        self.places.push(place);
    }

    fn join(&mut self, at: Vec3, place: Place) {
        self.joined.push(self.at.len() as u32 - 1);
        self.begin(at, place);
    }

    /// Makes a chunk of what was taken.
    fn close(&mut self) {
        if self.joined.is_empty() {
            return;
        }
        let mut vertices: Vec<Vertex> = Vec::with_capacity(self.at.len());
        let [root, tip] = self.bundle.width;
        match self.bundle.ink {
            Ink::Flat(colours) => vertices.extend(self.at.iter().zip(&self.places).map(|(&at, place)| {
                let width = root + (tip - root) * self.along(place);
                Vertex::new(at, width, colours[place.node as usize])
            })),
            Ink::Hair(coat, roots) => {
                let mut lanes = Lanes::default();
                for (at, places) in self.at.chunks(Lanes::COUNT).zip(self.places.chunks(Lanes::COUNT)) {
                    let mut alongs = [0.0; Lanes::COUNT];
                    for (lane, place) in places.iter().enumerate() {
                        alongs[lane] = self.along(place);
                        let strand = coat.strand(roots.get(place.line as usize).map_or(0, |r| r.id));
                        let (point, tangent) = self.course(place);
                        lanes.set(lane, point, tangent, &coat, &strand, alongs[lane]);
                    }
                    self.studio.hair(&coat, &mut lanes, at.len());
                    vertices.extend(
                        at.iter()
                            .enumerate()
                            .map(|(lane, &at)| Vertex::new(at, root + (tip - root) * alongs[lane], lanes.colour(lane))),
                    );
                }
            }
        }
        let shaded = matches!(self.bundle.ink, Ink::Hair(..));
        self.chunks.push(Binned::new(self.tiles, &vertices, &self.joined, self.margin, shaded));
        self.at.clear();
        self.places.clear();
        self.joined.clear();
    }

    /// How far along its line a place is, 0 root to 1 tip.
    fn along(&self, place: &Place) -> f32 {
        let offsets = &self.bundle.offsets[place.line as usize..];
        (place.node - offsets[0]) as f32 / (offsets[1] - offsets[0] - 1) as f32
            + place.part / (offsets[1] - offsets[0] - 1) as f32
    }

    /// Point and unit tangent of a line at a place, cm.
    fn course(&self, place: &Place) -> (Vec3, Vec3) {
        let offsets = &self.bundle.offsets[place.line as usize..];
        let (node, last) = (place.node as usize, offsets[1] as usize - 1);
        let points = self.bundle.points;
        let after = points[(node + 1).min(last)];
        if place.part > 0.0 {
            return (points[node].lerp(after, place.part), (after - points[node]).normalize_or_zero());
        }
        let before = points[node.saturating_sub(1).max(offsets[0] as usize)];
        (points[node], (after - before).normalize_or_zero())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::camera::axes;
    use crate::render::shade::Sky;
    use crate::render::shadow::density;
    use crate::render::veil::Veil;
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

    fn chunks(lines: &[Vec<Vec3>]) -> (Vec<Binned>, Vec<Vec3>) {
        let points: Vec<Vec3> = lines.iter().flatten().copied().collect();
        let mut offsets = vec![0];
        for line in lines {
            offsets.push(offsets[offsets.len() - 1] + line.len() as u32);
        }
        let (camera, task) = (camera(), Task::new());
        let density = density(&[], &[], &task).unwrap();
        let sky = Sky::new(&density, &task).unwrap();
        let studio = Studio::new(&camera, &density, &[], &sky);
        let ink = vec![Vec3::ONE; points.len()];
        let bundle = Bundle { points: &points, offsets: &offsets, width: [1.0, 1.0], ink: Ink::Flat(&ink) };
        let sieve = Sieve { veil: &Veil::none(&camera), holes: None };
        (gather(&[bundle], &camera, Tiles::new(200, 200, 32), sieve, &studio, &task).unwrap(), points)
    }

    /// Every segment once.
    fn segments(chunk: &Binned) -> Vec<[Vec3; 2]> {
        let tiles = Tiles::new(200, 200, 32);
        let mut all: Vec<[Vec3; 2]> =
            (0..tiles.count()).flat_map(|t| chunk.of(t)).map(|s| [s[0].at, s[1].at]).collect();
        all.sort_by(|a, b| {
            (a[0].to_array(), a[1].to_array()).partial_cmp(&(b[0].to_array(), b[1].to_array())).unwrap()
        });
        all.dedup();
        all
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
        let (chunks, points) = chunks(&[line]);
        let segments = segments(&chunks[0]);
        assert!(segments.len() < 350, "{} of 400", segments.len());
        for p in &points {
            let p = camera().project(*p).truncate();
            let nearest = segments
                .iter()
                .map(|w| {
                    let (a, b) = (w[0].truncate(), w[1].truncate());
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
            vec![Vec3::new(f32::NAN, 5.0, 0.0), Vec3::new(6.0, 5.0, 0.0)],
        ];
        let (chunks, _) = chunks(&lines);
        let tiles = Tiles::new(200, 200, 32);
        let all: Vec<[Vec3; 2]> = chunks.iter().flat_map(segments).collect();
        // Both lines within the picture come through whole: the first is 234 pixels long, the second fills a row.
        let length: f32 = all.iter().map(|w| (w[1] - w[0]).truncate().length()).sum();
        assert!((430.0..470.0).contains(&length), "{length}");
        for w in all {
            let middle = (w[0] + w[1]) * 0.5;
            assert!((w[1] - w[0]).truncate().length() <= LONGEST + 1e-3);
            if middle.min_element() < 0.0 || middle.truncate().max_element() >= 200.0 {
                continue;
            }
            let tile = middle.y as usize / 32 * tiles.columns + middle.x as usize / 32;
            let found = |chunk: &Binned| chunk.of(tile).iter().any(|s| s[0].at == w[0] && s[1].at == w[1]);
            assert!(chunks.iter().any(found), "{w:?}");
        }
    }
}
