//! Blue noise on a surface, in a progressive order.
//!
//! [`BlueNoise`] holds levels of points. Level `l` is a maximal-as-darts-go Poisson-disk set of radius
//! `r0 * 2^(-l/2)` on top of all the levels before it, so every level about doubles the count, and any prefix of the
//! order is well spaced. The order depends on the surface and the seed alone, never on how much of it is used: a
//! longer prefix contains a shorter one.
//!
//! Dart throwing in parallel after Wei 2008, "Parallel Poisson disk sampling", section 4: space is cut into cells no
//! smaller than the radius, cells of one of eight parities are worked on together (their darts cannot conflict), and
//! within a cell darts fly in the order of their keys. So the result is the same on any number of threads.

use glam::{IVec3, Vec3};
use rayon::prelude::*;

use super::Mesh;
use crate::math::rng::Key;
use crate::task::{Cancelled, Task};

/// Darts per squared radius of area; a full disk set has about 0.7 points on that area, half of them from the levels
/// before. More darts fill the last gaps at the same cost each.
const DARTS: f64 = 3.0;

/// Edge of a cell in radii, at least 1. Larger cells mean fewer look-ups and more distance tests.
const CELL: f32 = 2.0;

/// Places that are made in one go.
const RUN: usize = 4096;

/// A place on a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// The place, cm.
    pub position: Vec3,
    /// Triangle of the mesh.
    pub triangle: u32,
    /// Weights of the triangle's corners, summing to 1.
    pub barycentric: Vec3,
}

impl Sample {
    /// The place on `triangle` with these weights.
    pub fn on(mesh: &Mesh, triangle: u32, barycentric: Vec3) -> Self {
        let [a, b, c] = mesh.corners(triangle as usize);
        let position = a * barycentric.x + b * barycentric.y + c * barycentric.z;
        Self { position, triangle, barycentric }
    }

    /// A number for this place: the same place, the same number.
    pub fn id(&self) -> u64 {
        let p = self.position + Vec3::ZERO;
        [p.x, p.y, p.z].iter().fold(Key::new(0, "place"), |key, x| key.with(u64::from(x.to_bits()))).bits()
    }

    /// A per-corner value of the mesh, interpolated.
    pub fn interpolate<T>(&self, mesh: &Mesh, values: &[T]) -> T
    where
        T: Copy + std::ops::Mul<f32, Output = T> + std::ops::Add<Output = T>,
    {
        let [a, b, c] = mesh.triangles[self.triangle as usize].map(|v| values[v as usize]);
        a * self.barycentric.x + b * self.barycentric.y + c * self.barycentric.z
    }
}

/// Some triangles of a mesh, ready for picking places evenly by area.
#[derive(Clone, Debug)]
pub struct Patch {
    triangles: Vec<u32>,
    corners: Vec<[Vec3; 3]>,
    /// Area up to and with each triangle, cm^2.
    cumulative: Vec<f64>,
}

impl Patch {
    /// Triangles without area are left out; `None` when nothing is left.
    pub fn new(mesh: &Mesh, triangles: impl IntoIterator<Item = u32>) -> Option<Self> {
        let mut patch = Self { triangles: Vec::new(), corners: Vec::new(), cumulative: Vec::new() };
        let mut area = 0.0;
        for t in triangles {
            let twice = f64::from(mesh.area_vector(t as usize).length());
            if twice > 0.0 && twice.is_finite() {
                area += 0.5 * twice;
                patch.triangles.push(t);
                patch.corners.push(mesh.corners(t as usize));
                patch.cumulative.push(area);
            }
        }
        (!patch.triangles.is_empty()).then_some(patch)
    }

    /// Its area, cm^2.
    pub fn area(&self) -> f64 {
        self.cumulative.last().copied().unwrap_or(0.0)
    }

    /// Its triangles, in the order given.
    pub fn triangles(&self) -> &[u32] {
        &self.triangles
    }

    /// Place `i` of `count` that share the area evenly: one in each of `count` stretches of equal area.
    pub fn stratified(&self, i: usize, count: usize, key: Key) -> Sample {
        let bits = key.with(i as u64).bits();
        let at = self.place(i, count, bits);
        self.pick(self.cumulative.partition_point(|&c| c <= at), bits)
    }

    /// [`Patch::stratified`] for every `i` in a range; one search for all.
    fn stratified_run(&self, range: std::ops::Range<usize>, count: usize, key: Key) -> impl Iterator<Item = Sample> {
        let first = self.area() * (range.start as f64 / count as f64);
        let mut slot = self.cumulative.partition_point(|&c| c <= first);
        range.map(move |i| {
            let bits = key.with(i as u64).bits();
            let at = self.place(i, count, bits);
            while slot + 1 < self.cumulative.len() && self.cumulative[slot] <= at {
                slot += 1;
            }
            self.pick(slot, bits)
        })
    }

    /// Where in the cumulative area place `i` lies.
    fn place(&self, i: usize, count: usize, bits: u64) -> f64 {
        self.area() * ((i as f64 + unit21(bits)) / count as f64)
    }

    /// Uniform on a triangle (Turk 1990): a square root for one coordinate, a fraction for the other.
    fn pick(&self, slot: usize, bits: u64) -> Sample {
        let slot = slot.min(self.triangles.len() - 1);
        let (u, v) = (unit21(bits >> 21) as f32, unit21(bits >> 42) as f32);
        let root = u.sqrt();
        let barycentric = Vec3::new(1.0 - root, root * (1.0 - v), root * v);
        let [a, b, c] = self.corners[slot];
        Sample {
            position: a * barycentric.x + b * barycentric.y + c * barycentric.z,
            triangle: self.triangles[slot],
            barycentric,
        }
    }
}

/// Uniform in 0..1 from the lowest 21 bits; a 64-bit number holds three.
fn unit21(bits: u64) -> f64 {
    (bits & 0x1f_ffff) as f64 / f64::from(1 << 21)
}

/// A progressive blue-noise order of places on a patch, grown level by level.
#[derive(Clone, Debug)]
pub struct BlueNoise {
    patch: std::sync::Arc<Patch>,
    key: Key,
    order: Vec<Sample>,
    /// Where each level ends in `order`.
    ends: Vec<usize>,
}

struct Dart {
    /// Parity of the cell in the top bits, then its coordinates.
    cell: u64,
    priority: u32,
    /// Number of its place.
    place: u32,
}

impl BlueNoise {
    /// No level yet.
    pub fn new(patch: std::sync::Arc<Patch>, seed: u64) -> Self {
        Self { patch, key: Key::new(seed, "blue noise"), order: Vec::new(), ends: Vec::new() }
    }

    /// All places so far, in order.
    pub fn order(&self) -> &[Sample] {
        &self.order
    }

    /// Where each level ends in [`BlueNoise::order`].
    pub fn levels(&self) -> &[usize] {
        &self.ends
    }

    /// Least distance between any two places of the levels up to `level`, cm.
    pub fn radius(&self, level: usize) -> f32 {
        (self.patch.area() / 8.0 / 2.0_f64.powi(level as i32)).sqrt() as f32
    }

    /// Adds the next level.
    ///
    /// # Errors
    /// [`Cancelled`]; the order is then as before.
    pub fn grow(&mut self, task: &Task) -> Result<(), Cancelled> {
        task.check()?;
        let level = self.ends.len();
        let radius = self.radius(level);
        let grid = Cells::new(radius * CELL);
        let (samples, darts) = self.darts(level, radius, &grid);
        task.check()?;

        let runs = runs(&darts);
        let mut table = Table::new(runs.len() + self.order.len());
        let mut points: Vec<Vec3> = self.order.iter().map(|s| s.position).collect();
        for (i, &p) in points.iter().enumerate() {
            table.insert(grid.key(grid.cell(p)), i);
        }
        let mut accepted: Vec<usize> = Vec::new();
        for phase in runs.chunk_by(|a, b| darts[a.0].cell >> 60 == darts[b.0].cell >> 60) {
            task.check()?;
            let found: Vec<Vec<usize>> = phase
                .par_chunks(256)
                .map(|chunk| {
                    let (mut near, mut hits) = (Vec::new(), Vec::new());
                    for &(begin, end) in chunk {
                        near.clear();
                        let centre = grid.cell(samples[darts[begin].place as usize].position);
                        for offset in AROUND {
                            table.each(grid.key(centre + offset), |i| near.push(points[i]));
                        }
                        for (i, dart) in darts[begin..end].iter().enumerate() {
                            let p = samples[dart.place as usize].position;
                            if near.iter().all(|q| q.distance_squared(p) >= radius * radius) {
                                near.push(p);
                                hits.push(begin + i);
                            }
                        }
                    }
                    hits
                })
                .collect();
            for dart in found.into_iter().flatten() {
                table.insert(darts[dart].cell, points.len());
                points.push(samples[darts[dart].place as usize].position);
                accepted.push(dart);
            }
        }
        accepted.sort_unstable_by_key(|&d| (darts[d].priority, darts[d].place));
        self.order.extend(accepted.iter().map(|&d| samples[darts[d].place as usize]));
        self.ends.push(self.order.len());
        Ok(())
    }

    /// The places of a level's darts, and the darts sorted by phase, cell and priority.
    fn darts(&self, level: usize, radius: f32, grid: &Cells) -> (Vec<Sample>, Vec<Dart>) {
        let count = (DARTS * self.patch.area() / f64::from(radius * radius)).ceil().max(1.0) as usize;
        let key = self.key.with(level as u64);
        let mut samples = vec![Sample { position: Vec3::ZERO, triangle: 0, barycentric: Vec3::X }; count];
        samples.par_chunks_mut(RUN).enumerate().for_each(|(run, samples)| {
            let range = run * RUN..run * RUN + samples.len();
            for (slot, sample) in samples.iter_mut().zip(self.patch.stratified_run(range, count, key)) {
                *slot = sample;
            }
        });
        let mut darts: Vec<Dart> = samples
            .par_iter()
            .enumerate()
            .map(|(i, sample)| {
                let priority = (key.with(i as u64).with(1).bits() >> 32) as u32;
                Dart { cell: grid.key(grid.cell(sample.position)), priority, place: i as u32 }
            })
            .collect();
        darts.par_sort_unstable_by_key(|d| (d.cell, d.priority, d.place));
        (samples, darts)
    }
}

/// The cells around one, itself first: what is nearest refuses most darts.
const AROUND: [IVec3; 27] = {
    let mut around = [IVec3::ZERO; 27];
    let mut n = 0;
    while n < 27 {
        // Number 13 is the middle; it changes places with number 0.
        let m = if n == 0 {
            13
        } else if n == 13 {
            0
        } else {
            n
        };
        around[n as usize] = IVec3::new(m % 3 - 1, m / 3 % 3 - 1, m / 9 - 1);
        n += 1;
    }
    around
};

/// Begin and end of every stretch of darts in one cell.
fn runs(darts: &[Dart]) -> Vec<(usize, usize)> {
    let mut begin = 0;
    darts
        .chunk_by(|a, b| a.cell == b.cell)
        .map(|run| {
            begin += run.len();
            (begin - run.len(), begin)
        })
        .collect()
}

/// Cubic cells of space.
struct Cells {
    scale: f32,
}

impl Cells {
    fn new(edge: f32) -> Self {
        Self { scale: 1.0 / edge }
    }

    fn cell(&self, p: Vec3) -> IVec3 {
        // `floor` by truncation: several times faster than the portable one.
        let q = p * self.scale;
        let near = q.as_ivec3();
        near - IVec3::select(q.cmplt(near.as_vec3()), IVec3::ONE, IVec3::ZERO)
    }

    /// The parity in the top bits, then 20 bits for each coordinate.
    fn key(&self, cell: IVec3) -> u64 {
        let bits = |c: i32| u64::from((c as u32).wrapping_add(1 << 19) & 0xf_ffff);
        let parity = (cell.x & 1) | (cell.y & 1) << 1 | (cell.z & 1) << 2;
        (parity as u64) << 60 | bits(cell.x) << 40 | bits(cell.y) << 20 | bits(cell.z)
    }
}

/// From cells to lists of points: open addressing, and a chain through the points.
struct Table {
    keys: Vec<u64>,
    first: Vec<u32>,
    next: Vec<u32>,
}

const NONE: u32 = u32::MAX;
const FREE: u64 = u64::MAX;

impl Table {
    fn new(cells: usize) -> Self {
        let size = (cells * 2).next_power_of_two().max(64);
        Self { keys: vec![FREE; size], first: vec![NONE; size], next: Vec::new() }
    }

    fn slot(&self, key: u64) -> usize {
        let mask = self.keys.len() - 1;
        let mut slot = (key.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 32) as usize & mask;
        while self.keys[slot] != key && self.keys[slot] != FREE {
            slot = (slot + 1) & mask;
        }
        slot
    }

    /// Points must be inserted in the order of their numbers.
    fn insert(&mut self, key: u64, point: usize) {
        let slot = self.slot(key);
        self.keys[slot] = key;
        self.next.push(self.first[slot]);
        self.first[slot] = point as u32;
    }

    fn each(&self, key: u64, mut f: impl FnMut(usize)) {
        let mut point = self.first[self.slot(key)];
        while point != NONE {
            f(point as usize);
            point = self.next[point as usize];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    fn ball() -> Mesh {
        super::super::bvh::tests::sphere(24, 10.0)
    }

    fn grown(mesh: &Mesh, seed: u64, count: usize) -> BlueNoise {
        let patch = Arc::new(Patch::new(mesh, 0..mesh.triangles.len() as u32).unwrap());
        let mut noise = BlueNoise::new(patch, seed);
        while noise.order().len() < count {
            noise.grow(&Task::new()).unwrap();
        }
        noise
    }

    fn least_distance(points: &[Sample]) -> f32 {
        let mut best = f32::INFINITY;
        for (i, a) in points.iter().enumerate() {
            for b in &points[..i] {
                best = best.min(a.position.distance(b.position));
            }
        }
        best
    }

    #[test]
    fn every_level_keeps_its_distance_and_fills_the_surface() {
        let mesh = ball();
        let noise = grown(&mesh, 1, 2000);
        for (level, &end) in noise.levels().iter().enumerate() {
            let radius = noise.radius(level);
            assert!(least_distance(&noise.order()[..end]) >= radius, "level {level}");
            // A random set with no room left covers 0.547 of the plane by disks of half the radius; with our darts
            // a few gaps stay open.
            let cover = end as f64 * std::f64::consts::FRAC_PI_4 * f64::from(radius * radius) / noise.patch.area();
            assert!(level < 4 || (0.38..0.6).contains(&cover), "level {level}: {cover}");
        }
    }

    #[test]
    fn any_prefix_is_better_spaced_than_random() {
        let mesh = ball();
        let noise = grown(&mesh, 5, 1500);
        for count in [50, 200, 700, 1300] {
            let random: Vec<Sample> =
                (0..count).map(|i| noise.patch.stratified(i, count, Key::new(9, "random"))).collect();
            let ours = least_distance(&noise.order()[..count]);
            assert!(ours > 2.0 * least_distance(&random), "{count}: {ours}");
            // Never worse than the level it is in: sqrt 2 below the ideal of its count.
            let ideal = (noise.patch.area() / count as f64).sqrt() as f32;
            assert!(ours > 0.5 * ideal, "{count}: {ours} of {ideal}");
        }
    }

    #[test]
    fn places_follow_area() {
        let mesh = ball();
        let noise = grown(&mesh, 2, 20_000);
        let n = noise.order().len() as f32;
        // Archimedes: slices of equal height have equal area.
        for k in 0..10 {
            let (lo, hi) = (-10.0 + 2.0 * k as f32, -8.0 + 2.0 * k as f32);
            let share = noise.order().iter().filter(|s| s.position.y >= lo && s.position.y < hi).count() as f32 / n;
            assert!((share - 0.1).abs() < 0.006, "slice {k}: {share}");
        }
    }

    #[test]
    fn threads_and_repetition_change_nothing() {
        let mesh = ball();
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
        let one = pool.install(|| grown(&mesh, 3, 5000));
        let pool = rayon::ThreadPoolBuilder::new().num_threads(5).build().unwrap();
        let five = pool.install(|| grown(&mesh, 3, 5000));
        assert_eq!(one.order(), five.order());
        assert_ne!(one.order(), grown(&mesh, 4, 5000).order());
    }

    #[test]
    fn a_cancelled_level_leaves_the_order_whole() {
        let mesh = ball();
        let mut noise = grown(&mesh, 3, 100);
        let before = noise.order().to_vec();
        let task = Task::new();
        task.cancel();
        assert_eq!(noise.grow(&task), Err(Cancelled));
        assert_eq!(noise.order(), before);
    }

    #[test]
    fn flat_triangles_are_left_out() {
        let mut mesh = ball();
        let n = mesh.triangles.len() as u32;
        mesh.triangles.push([0, 0, 1]);
        assert!(Patch::new(&mesh, [n]).is_none());
        assert!(Patch::new(&mesh, []).is_none());
        assert_eq!(Patch::new(&mesh, [0, n]).unwrap().triangles(), [0]);
    }
}
