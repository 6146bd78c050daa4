//! Shapes whose mixtures are the frames of a surface that moves: morph targets and their weights.
//!
//! Principal component analysis of the displacements from rest, by the small matrix of the frames' inner products
//! (Sirovich 1987, the method of snapshots; for meshes Alexa and Mueller 2000). As many shapes as a tolerance asks for:
//! what programs pay for is the number of shapes, and few are enough for motions that are smooth.

use glam::Vec3;
use rayon::prelude::*;

use crate::task::{Cancelled, Task};

/// Vertices that the directions are found from.
const SAMPLED: usize = 20_000;
/// Frames that the directions are found from.
const SNAPSHOTS: usize = 192;

/// Positions (cm) and normals of all vertices of a primitive; normals may be none.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Vertices {
    /// Positions.
    pub positions: Vec<Vec3>,
    /// Unit normals, one per vertex or none.
    pub normals: Vec<Vec3>,
}

impl Vertices {
    fn scaled(&self, by: f32) -> Self {
        let scaled = |all: &[Vec3]| all.iter().map(|v| *v * by).collect();
        Self { positions: scaled(&self.positions), normals: scaled(&self.normals) }
    }

    fn add(&mut self, other: &Self, times: f32) {
        let add = |all: &mut [Vec3], more: &[Vec3]| all.iter_mut().zip(more).for_each(|(v, m)| *v += *m * times);
        add(&mut self.positions, &other.positions);
        add(&mut self.normals, &other.normals);
    }
}

/// Shapes and what is mixed of them.
#[derive(Clone, Debug, Default)]
pub struct Basis {
    /// Displacements from rest, of positions and of normals, that the weight 1 adds.
    pub shapes: Vec<Vertices>,
    /// Per frame the weight of every shape, -1 to 1.
    pub weights: Vec<Vec<f32>>,
    /// The farthest that a vertex of a mixture lies from where it is at a frame, cm.
    pub error: f32,
}

impl Basis {
    /// The same mixtures with weights from 0 to 1 alone, for programs that know no others: a shape whose weight goes both
    /// ways is counted from its least one, and one more shape, which comes first and stays at 1, makes up for that.
    #[must_use]
    pub fn with_weights_from_zero(mut self) -> Self {
        let mut shift: Option<Vertices> = None;
        for (k, shape) in self.shapes.iter_mut().enumerate() {
            let of = |f: fn(f32, f32) -> f32| self.weights.iter().map(|w| w[k]).fold(0.0, f);
            let (least, most) = (of(f32::min), of(f32::max));
            if least == 0.0 {
                continue;
            }
            let (from, scale) = if most == 0.0 { (0.0, -1.0) } else { (least, most - least) };
            if from < 0.0 {
                let sum = shift.get_or_insert_with(|| shape.scaled(0.0));
                sum.add(shape, from);
            }
            *shape = shape.scaled(scale);
            self.weights.iter_mut().for_each(|w| w[k] = ((w[k] - from) / scale).clamp(0.0, 1.0));
        }
        if let Some(shift) = shift {
            self.shapes.insert(0, shift);
            self.weights.iter_mut().for_each(|w| w.insert(0, 1.0));
        }
        self
    }

    /// Per shape the farthest that it moves a vertex, cm.
    pub fn reaches(&self) -> Vec<f32> {
        self.shapes.iter().map(|s| s.positions.par_iter().map(|p| p.length()).reduce(|| 0.0, f32::max)).collect()
    }
}

/// What some of the vertices say about how many shapes are needed.
pub struct Sampled {
    /// Displacements of the sampled vertices, frame by frame.
    moved: Vec<Vec<Vec3>>,
    /// What the shapes so far leave of them.
    left: Vec<Vec<Vec3>>,
    snapshots: Vec<usize>,
    directions: Vec<Vec<f64>>,
    weights: Vec<Vec<f32>>,
    wanted: usize,
}

impl Sampled {
    /// Looks at some vertices of every frame.
    ///
    /// # Errors
    /// [`Cancelled`].
    pub fn new(
        rest: &Vertices,
        frames: usize,
        at: impl Fn(usize) -> Vertices,
        tolerance: f32,
        task: &Task,
    ) -> Result<Self, Cancelled> {
        let count = rest.positions.len();
        let step = count.div_ceil(SAMPLED).max(1);
        let mut moved: Vec<Vec<Vec3>> = Vec::with_capacity(frames);
        for f in 0..frames {
            task.check()?;
            task.progress("shapes", 0.3 * f as f32 / frames as f32);
            let now = at(f).positions;
            moved.push((0..count).step_by(step).map(|v| now[v] - rest.positions[v]).collect());
        }
        let stride = frames.div_ceil(SNAPSHOTS).max(1);
        let snapshots: Vec<usize> = (0..frames).step_by(stride).collect();
        let directions = directions(&snapshots.iter().map(|&f| &*moved[f]).collect::<Vec<_>>());
        let (left, weights) = (moved.clone(), vec![vec![]; frames]);
        let mut sampled = Self { moved, left, snapshots, directions, weights, wanted: 0 };
        while !sampled.is_complete() && sampled.farthest() > 0.7 * tolerance {
            sampled.add();
            task.check()?;
        }
        Ok(sampled)
    }

    /// Shapes that the sampled vertices need.
    pub fn wanted(&self) -> usize {
        self.wanted
    }

    fn is_complete(&self) -> bool {
        self.wanted == self.directions.len()
    }

    fn farthest(&self) -> f32 {
        self.left.par_iter().flatten().map(|d| d.length()).reduce(|| 0.0, f32::max)
    }

    fn add(&mut self) {
        let direction = &self.directions[self.wanted];
        add_shape(direction, &self.snapshots, &self.moved, &mut self.left, &mut self.weights);
        self.wanted += 1;
    }

    /// The fewest shapes found with which every vertex at every frame is within `tolerance` cm of `at(frame)`; at the most
    /// as many as there are frames, which meets them all but for rounding.
    ///
    /// # Errors
    /// [`Cancelled`].
    pub fn basis(
        mut self,
        rest: &Vertices,
        at: impl Fn(usize) -> Vertices,
        tolerance: f32,
        task: &Task,
    ) -> Result<Basis, Cancelled> {
        let frames = self.weights.len();
        loop {
            let mut basis = Basis { shapes: vec![], weights: self.weights.clone(), error: 0.0 };
            basis.shapes = shapes(rest, &self.directions[..self.wanted], &self.snapshots, &at, task)?;
            for (k, shape) in basis.shapes.iter_mut().enumerate() {
                let most = self.weights.iter().map(|w| w[k].abs()).fold(0.0, f32::max).max(1e-20);
                shape.positions.iter_mut().chain(&mut shape.normals).for_each(|d| *d *= most);
                basis.weights.iter_mut().for_each(|w| w[k] /= most);
            }
            for f in 0..frames {
                task.check()?;
                task.progress("shapes", 0.6 + 0.4 * f as f32 / frames as f32);
                basis.error = basis.error.max(error(rest, &at(f).positions, &basis, f));
            }
            if basis.error <= tolerance || self.is_complete() {
                return Ok(basis);
            }
            // The vertices that were not sampled ask for more.
            for _ in 0..(self.wanted / 8).max(1) {
                if !self.is_complete() {
                    self.add();
                }
            }
        }
    }
}

/// How far the mixture of a frame lies from its positions, at most, cm.
fn error(rest: &Vertices, now: &[Vec3], basis: &Basis, frame: usize) -> f32 {
    let mixed = |v: usize| {
        let shapes = basis.shapes.iter().zip(&basis.weights[frame]);
        shapes.fold(rest.positions[v], |p, (shape, w)| p + shape.positions[v] * *w)
    };
    now.par_iter().enumerate().map(|(v, p)| p.distance(mixed(v))).reduce(|| 0.0, f32::max)
}

/// Weights of the frame's displacements in the shapes, by `snapshots`: unit directions among the frames, the one that
/// explains most first. Those that explain nothing are left out.
fn directions(snapshots: &[&[Vec3]]) -> Vec<Vec<f64>> {
    let n = snapshots.len();
    let pairs: Vec<(usize, usize)> = (0..n).flat_map(|i| (i..n).map(move |j| (i, j))).collect();
    let product = |&(i, j): &(usize, usize)| -> f64 {
        snapshots[i].iter().zip(snapshots[j]).map(|(a, b)| a.as_dvec3().dot(b.as_dvec3())).sum()
    };
    let products: Vec<f64> = pairs.par_iter().map(product).collect();
    let mut matrix = vec![vec![0.0; n]; n];
    for (&(i, j), p) in pairs.iter().zip(products) {
        (matrix[i][j], matrix[j][i]) = (p, p);
    }
    let (values, vectors) = eigen(matrix);
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|&a, &b| values[b].total_cmp(&values[a]).then(a.cmp(&b)));
    let least = values.iter().copied().fold(0.0, f64::max) * 1e-12;
    order.retain(|&k| values[k] > least);
    order.iter().map(|&k| vectors.iter().map(|row| row[k]).collect()).collect()
}

/// Eigenvalues and eigenvectors (columns) of a symmetric matrix, by Jacobi's rotations.
fn eigen(mut a: Vec<Vec<f64>>) -> (Vec<f64>, Vec<Vec<f64>>) {
    let n = a.len();
    let mut v: Vec<Vec<f64>> = (0..n).map(|i| (0..n).map(|j| f64::from(u8::from(i == j))).collect()).collect();
    let scale: f64 = a.iter().flatten().map(|x| x * x).sum::<f64>().sqrt();
    for _ in 0..64 {
        let off: f64 = (0..n).map(|i| a[i][i + 1..].iter().map(|x| x * x).sum::<f64>()).sum();
        if off.sqrt() <= 1e-15 * scale {
            break;
        }
        for p in 0..n {
            for q in p + 1..n {
                if a[p][q].abs() <= 1e-300 {
                    continue;
                }
                let theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
                let t = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
                let c = 1.0 / (t * t + 1.0).sqrt();
                let s = t * c;
                for row in &mut a {
                    let (x, y) = (row[p], row[q]);
                    (row[p], row[q]) = (c * x - s * y, s * x + c * y);
                }
                let (head, tail) = a.split_at_mut(q);
                for (x, y) in head[p].iter_mut().zip(&mut tail[0]) {
                    (*x, *y) = (c * *x - s * *y, s * *x + c * *y);
                }
                for row in &mut v {
                    let (x, y) = (row[p], row[q]);
                    (row[p], row[q]) = (c * x - s * y, s * x + c * y);
                }
            }
        }
    }
    ((0..n).map(|i| a[i][i]).collect(), v)
}

/// Adds the shape of a direction: its weight in every frame is what the frame has of it, which is then taken off `left`.
fn add_shape(
    direction: &[f64],
    snapshots: &[usize],
    moved: &[Vec<Vec3>],
    left: &mut [Vec<Vec3>],
    weights: &mut [Vec<f32>],
) {
    let count = moved.first().map_or(0, Vec::len);
    let mix =
        |v: usize| snapshots.iter().zip(direction).map(|(&f, c)| moved[f][v].as_dvec3() * *c).sum::<glam::DVec3>();
    let shape: Vec<glam::DVec3> = (0..count).into_par_iter().map(mix).collect();
    let size: f64 = shape.iter().map(|s| s.length_squared()).sum();
    left.par_iter_mut().zip(weights).for_each(|(left, weights)| {
        // What is left has as much of the direction as the whole, for directions are at right angles.
        let dot: f64 = left.iter().zip(&shape).map(|(d, s)| d.as_dvec3().dot(*s)).sum();
        let weight = dot / size.max(1e-300);
        weights.push(weight as f32);
        for (d, s) in left.iter_mut().zip(&shape) {
            *d -= (*s * weight).as_vec3();
        }
    });
}

/// The shapes of the directions on all vertices.
fn shapes(
    rest: &Vertices,
    directions: &[Vec<f64>],
    snapshots: &[usize],
    at: &impl Fn(usize) -> Vertices,
    task: &Task,
) -> Result<Vec<Vertices>, Cancelled> {
    let zero = |v: &[Vec3]| vec![Vec3::ZERO; v.len()];
    let empty = Vertices { positions: zero(&rest.positions), normals: zero(&rest.normals) };
    let mut shapes = vec![empty; directions.len()];
    for (i, &f) in snapshots.iter().enumerate() {
        task.check()?;
        task.progress("shapes", 0.3 + 0.3 * i as f32 / snapshots.len() as f32);
        let now = at(f);
        shapes.par_iter_mut().zip(directions).for_each(|(shape, direction)| {
            let c = direction[i] as f32;
            for (s, (a, b)) in shape.positions.iter_mut().zip(now.positions.iter().zip(&rest.positions)) {
                *s += (*a - *b) * c;
            }
            for (s, (a, b)) in shape.normals.iter_mut().zip(now.normals.iter().zip(&rest.normals)) {
                *s += (*a - *b) * c;
            }
        });
    }
    Ok(shapes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{rng::Key, trig};

    fn line(at: impl Fn(f32) -> Vec3) -> Vertices {
        Vertices { positions: (0..500).map(|i| at(i as f32 / 499.0)).collect(), normals: vec![] }
    }

    fn basis(
        rest: &Vertices,
        frames: usize,
        at: impl Fn(usize) -> Vertices,
        tolerance: f32,
        task: &Task,
    ) -> Result<Basis, Cancelled> {
        Sampled::new(rest, frames, &at, tolerance, task)?.basis(rest, at, tolerance, task)
    }

    #[test]
    fn a_motion_of_two_shapes_needs_two() {
        let rest = line(|t| Vec3::Y * t * 10.0);
        let at = |f: usize| {
            let (a, b) = (trig::sin(f as f32 * 0.3), trig::cos(f as f32 * 0.17) - 1.0);
            line(|t| Vec3::new(3.0 * a * t * t, 10.0 * t, 2.0 * b * trig::sin(5.0 * t)))
        };
        let basis = basis(&rest, 60, at, 1e-3, &Task::new()).unwrap();
        assert_eq!(basis.shapes.len(), 2);
        assert!(basis.error <= 1e-3 && basis.weights.iter().flatten().all(|w| w.abs() <= 1.0));
        // The same with weights from 0 to 1, of one shape more.
        let positive = basis.clone().with_weights_from_zero();
        assert!(basis.weights.iter().flatten().any(|w| *w < -0.1) && positive.shapes.len() == 3);
        assert!(positive.weights.iter().flatten().all(|w| (0.0..=1.0).contains(w)));
        for f in 0..60 {
            assert!(error(&rest, &at(f).positions, &basis, f) <= basis.error);
            assert!(error(&rest, &at(f).positions, &positive, f) <= basis.error + 1e-5);
        }
    }

    #[test]
    fn any_motion_is_met_and_a_looser_tolerance_needs_no_more_shapes() {
        // A line that is turned over, which no few shapes do, with noise on it.
        let rest = line(|t| Vec3::Y * t * 10.0);
        let at = |f: usize| {
            let (s, c) = (trig::sin(f as f32 * 0.1), trig::cos(f as f32 * 0.1));
            let noise = |t: f32| Key::new(f as u64, "noise").with((t * 1e4) as u64).direction() * 0.02;
            line(|t| Vec3::new(s * t * 10.0, c * t * 10.0, 0.0) + noise(t))
        };
        let fine = basis(&rest, 30, at, 1e-4, &Task::new()).unwrap();
        assert!(fine.error < 1e-3, "{}", fine.error);
        let rough = basis(&rest, 30, at, 0.1, &Task::new()).unwrap();
        assert!(rough.error <= 0.1 && rough.shapes.len() <= 4 && fine.shapes.len() == 30);
    }

    #[test]
    fn rest_needs_no_shape() {
        let rest = line(|t| Vec3::X * t);
        let basis = basis(&rest, 10, |_| rest.clone(), 0.01, &Task::new()).unwrap();
        assert!(basis.shapes.is_empty() && basis.error == 0.0 && basis.weights == vec![Vec::<f32>::new(); 10]);
    }
}
