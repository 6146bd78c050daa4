//! Lattices: a parallelepiped of control points around what is to be moved.
//!
//! Local coordinates are equations (2) to (4) of Liu and Liu 2011, the motion is their (5) in terms of displacements: a
//! point moves by the Bernstein mean of how far the control points have moved. Since the basis sums to 1 and reproduces
//! the local coordinates, that is the same as (5) in exact arithmetic; in floating point it leaves a point whose control
//! points have not moved exactly where it is.

use std::collections::BTreeMap;

use glam::{DMat3, DVec3, Mat3, Vec3};
use rayon::prelude::*;

use super::controls::Controls;
use super::kernel::{self, Grid};
use super::{DeformError, Folded, PointKind};
use crate::geometry::Bounds;
use crate::math::Digest;
use crate::task::Task;

/// The most divisions along one edge.
pub const MOST_DIVISIONS: u32 = 32;
/// Points that are moved between two looks at the task.
const PIECE: usize = 8192;

/// A parallelepiped divided `l` x `m` x `n`, with a control point at every corner of the division.
#[derive(Clone, Debug, PartialEq)]
pub struct Lattice {
    origin: Vec3,
    /// Columns: the edges S, T, U, cm.
    edges: Mat3,
    divisions: [usize; 3],
    /// At rest where the even division has them (1).
    controls: Controls,
    groups: BTreeMap<String, Vec<u32>>,
}

/// Which control points: by index ranges, both ends included, or by the name of a group; without either all of them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Selection {
    /// Along S, T and U.
    pub ranges: [Option<(i64, i64)>; 3],
    /// A named group; with ranges, what is in both.
    pub group: Option<String>,
}

/// How selected control points move: scaled and turned about a place, then shifted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Move {
    /// Shift, cm.
    pub by: Vec3,
    /// Stretch along the three axes of space, 1 is none.
    pub scale: Vec3,
    /// Rotation.
    pub turn: glam::Quat,
    /// The place that stays; the middle of the selected points when not given.
    pub about: Option<Vec3>,
}

impl Default for Move {
    fn default() -> Self {
        Self { by: Vec3::ZERO, scale: Vec3::ONE, turn: glam::Quat::IDENTITY, about: None }
    }
}

impl Move {
    /// Where a point goes that stands at `p`, with the middle of all that move.
    pub fn of(&self, p: Vec3, middle: Vec3) -> Vec3 {
        if *self == Self::default() {
            return p;
        }
        let about = self.about.unwrap_or(middle);
        about + self.turn * ((p - about) * self.scale) + self.by
    }
}

/// The indices of control point number `index` along S, T, U.
fn indices(divisions: [usize; 3], index: usize) -> [usize; 3] {
    let (m, n) = (divisions[1] + 1, divisions[2] + 1);
    [index / (m * n), index / n % m, index % n]
}

fn called(divisions: [usize; 3], index: usize) -> String {
    let [a, b, c] = indices(divisions, index);
    format!("control point {a}, {b}, {c}")
}

impl Lattice {
    /// A lattice with its corner at `origin` and edges `s`, `t`, `u`, divided evenly (1).
    ///
    /// # Errors
    /// Edges that are flat, left-handed or not finite; divisions out of 1 to [`MOST_DIVISIONS`].
    pub fn new(origin: Vec3, [s, t, u]: [Vec3; 3], divisions: [u32; 3]) -> Result<Self, DeformError> {
        for (what, value) in [("the corner", origin), ("edge s", s), ("edge t", t), ("edge u", u)] {
            if !value.is_finite() {
                return Err(DeformError::NotFinite { what: what.into(), value });
            }
        }
        let (ds, dt, du) = (s.as_dvec3(), t.as_dvec3(), u.as_dvec3());
        let volume = dt.cross(du).dot(ds);
        let longest = ds.length() * dt.length() * du.length();
        if !(longest > 1e-12 && volume.abs() > 1e-6 * longest) {
            return Err(DeformError::Flat { s, t, u });
        }
        if volume < 0.0 {
            return Err(DeformError::Inverted { s, t, u });
        }
        if let Some(&value) = divisions.iter().find(|d| !(1..=MOST_DIVISIONS).contains(d)) {
            let (low, high) = (1.0, f64::from(MOST_DIVISIONS));
            return Err(DeformError::OutOfRange { what: "a division".into(), value: f64::from(value), low, high });
        }
        let divisions = divisions.map(|d| d as usize);
        let count = divisions.iter().map(|d| d + 1).product();
        let edges = Mat3::from_cols(s, t, u);
        let rest = |index: usize| {
            let at = indices(divisions, index);
            let part = |a: usize| at[a] as f32 / divisions[a] as f32;
            origin + edges * Vec3::new(part(0), part(1), part(2))
        };
        let controls = Controls::new((0..count).map(rest).collect());
        Ok(Self { origin, edges, divisions, controls, groups: BTreeMap::new() })
    }

    /// A lattice along the axes of space.
    ///
    /// # Errors
    /// As [`Lattice::new`].
    pub fn around(bounds: Bounds, divisions: [u32; 3]) -> Result<Self, DeformError> {
        let size = bounds.size();
        let edges = [Vec3::X * size.x, Vec3::Y * size.y, Vec3::Z * size.z];
        Self::new(bounds.min, edges, divisions)
    }

    /// Divisions along S, T, U.
    pub fn divisions(&self) -> [usize; 3] {
        self.divisions
    }

    /// The corner and the edges.
    pub fn frame(&self) -> (Vec3, Mat3) {
        (self.origin, self.edges)
    }

    /// How many control points there are.
    pub fn count(&self) -> usize {
        self.controls.moves.len()
    }

    /// The number of a control point.
    pub fn index(&self, [i, j, k]: [usize; 3]) -> usize {
        (i * (self.divisions[1] + 1) + j) * (self.divisions[2] + 1) + k
    }

    /// The indices of control point number `index` along S, T, U.
    pub fn indices(&self, index: usize) -> [usize; 3] {
        indices(self.divisions, index)
    }

    /// Where a control point stands in the even division (1).
    pub fn rest(&self, index: usize) -> Vec3 {
        self.controls.rest[index]
    }

    /// Where a control point stands now.
    pub fn place(&self, index: usize) -> Vec3 {
        self.controls.place(index)
    }

    /// What a control point is for.
    pub fn kind(&self, index: usize) -> PointKind {
        self.controls.kinds[index]
    }

    /// Points of the object that are held.
    pub fn held(&self) -> &[Vec3] {
        &self.controls.held
    }

    /// The names of its groups.
    pub fn groups(&self) -> impl Iterator<Item = &str> {
        self.groups.keys().map(String::as_str)
    }

    /// True when no control point has moved.
    pub fn is_still(&self) -> bool {
        self.controls.is_still()
    }

    /// Local coordinates (s, t, u) of a place, 0 to 1 inside (2)-(4).
    pub fn local(&self, p: Vec3) -> Vec3 {
        (self.inverse() * (p - self.origin).as_dvec3()).as_vec3()
    }

    /// True for a place that the lattice can move.
    pub fn contains(&self, p: Vec3) -> bool {
        let local = self.local(p);
        local.cmpge(Vec3::ZERO).all() && local.cmple(Vec3::ONE).all()
    }

    /// The control points of a selection, ascending.
    ///
    /// # Errors
    /// An index or a group that is not there.
    pub fn select(&self, selection: &Selection) -> Result<Vec<u32>, DeformError> {
        let mut ranges = [(0, 0); 3];
        for (a, range) in ranges.iter_mut().enumerate() {
            let last = self.divisions[a];
            let (lo, hi) = selection.ranges[a].unwrap_or((0, last as i64));
            for index in [lo, hi] {
                if !(0..=last as i64).contains(&index) {
                    return Err(DeformError::NoControlPoint { axis: ['i', 'j', 'k'][a], index, last });
                }
            }
            *range = (lo.min(hi) as usize, lo.max(hi) as usize);
        }
        let inside = |index: u32| {
            let at = self.indices(index as usize);
            (0..3).all(|a| (ranges[a].0..=ranges[a].1).contains(&at[a]))
        };
        Ok(match &selection.group {
            None => (0..self.count() as u32).filter(|&i| inside(i)).collect(),
            Some(name) => self.group(name)?.iter().copied().filter(|&i| inside(i)).collect(),
        })
    }

    fn group(&self, name: &str) -> Result<&[u32], DeformError> {
        let unknown = || DeformError::Unknown {
            what: "group",
            name: name.to_owned(),
            known: self.groups.keys().cloned().collect(),
        };
        self.groups.get(name).map(Vec::as_slice).ok_or_else(unknown)
    }

    /// With a name for these control points.
    #[must_use]
    pub fn named(mut self, name: &str, points: Vec<u32>) -> Self {
        self.groups.insert(name.to_owned(), points);
        self
    }

    /// With another kind for these control points.
    #[must_use]
    pub fn marked(mut self, points: &[u32], kind: PointKind) -> Self {
        self.controls.mark(points, kind);
        self
    }

    /// With these control points moved from where they stand; those that are fixed stay.
    ///
    /// # Errors
    /// When all of them are fixed, or one would end where numbers end.
    pub fn moved(self, points: &[u32], by: &Move) -> Result<Self, DeformError> {
        let middle = self.controls.middle(points);
        self.placed(points, |_, p| by.of(p, middle))
    }

    /// With these control points where `place` puts them; it is told the number and where the point stands.
    ///
    /// # Errors
    /// As [`Lattice::moved`].
    pub fn placed(mut self, points: &[u32], place: impl FnMut(u32, Vec3) -> Vec3) -> Result<Self, DeformError> {
        self.controls.put(points, |i| called(self.divisions, i), place)?;
        Ok(self)
    }

    /// With points of the object that stay where they are. A place moves the less the nearer it is to them: by the part
    /// of its affinity (inverse distance to the power of `power`) that belongs to moved control points.
    ///
    /// # Errors
    /// A point that is not finite, an exponent out of 0.5 to 8.
    pub fn holding(mut self, points: &[Vec3], power: f32) -> Result<Self, DeformError> {
        self.controls.hold(points, power)?;
        Ok(self)
    }

    /// The next step: overall control points follow the feature points, pulled back by the fixed ones, with each one's
    /// affinity. Without a moved feature point or a fixed point nothing happens.
    ///
    /// # Errors
    /// As [`Pins::new`](super::Pins::new).
    pub fn followed(mut self, power: f32) -> Result<Self, DeformError> {
        self.controls.follow(power, |i| called(self.divisions, i))?;
        Ok(self)
    }

    /// The place where the moved lattice is most folded over itself: where its Jacobian is least, when that is not above 0.
    /// Looked for at every control point and between neighbours; in lattices of many points at fewer places.
    pub fn folded(&self) -> Option<Folded> {
        if self.is_still() {
            return None;
        }
        let most = libm::cbrt(1e7 / self.count() as f64) as usize;
        let samples = self.divisions.map(|d| (2 * d + 1).min(most.max(5)));
        // Per axis and sample the basis and its slope.
        let tables = [0, 1, 2].map(|a| table(self.divisions[a], samples[a]));
        let (inverse, edges) = (self.inverse(), [0, 1, 2].map(|a| self.edges.col(a).as_dvec3()));
        let [_, m, n] = self.divisions.map(|d| d + 1);
        let mut least = (0.0, [0; 3]);
        for q in (0..samples[0] * samples[1] * samples[2])
            .map(|i| [i / (samples[1] * samples[2]), i / samples[2] % samples[1], i % samples[2]])
        {
            let [a, b, c] = [0, 1, 2].map(|axis| &tables[axis][q[axis]]);
            let mut slopes = edges;
            for (i, a) in a.iter().enumerate() {
                for (j, b) in b.iter().enumerate() {
                    let row = &self.controls.moves[(i * m + j) * n..][..n];
                    let [mut flat, mut steep] = [DVec3::ZERO; 2];
                    for (by, c) in row.iter().zip(c) {
                        flat += by.as_dvec3() * c[0];
                        steep += by.as_dvec3() * c[1];
                    }
                    slopes[0] += flat * (a[1] * b[0]);
                    slopes[1] += flat * (a[0] * b[1]);
                    slopes[2] += steep * (a[0] * b[0]);
                }
            }
            let volume = (DMat3::from_cols(slopes[0], slopes[1], slopes[2]) * inverse).determinant();
            if volume <= least.0 - 1e-9 {
                least = (volume, q);
            }
        }
        (least.0 < 0.0).then(|| {
            let local = [0, 1, 2].map(|a| least.1[a] as f32 / (samples[a] - 1) as f32);
            let at = [0, 1, 2].map(|a| (local[a] * self.divisions[a] as f32).round() as usize);
            let place = self.origin + self.edges * Vec3::from(local);
            Folded { points: vec![format!("control point {}, {}, {}", at[0], at[1], at[2])], place }
        })
    }

    fn inverse(&self) -> DMat3 {
        let [s, t, u] = [0, 1, 2].map(|a| self.edges.col(a).as_dvec3());
        let volume = t.cross(u).dot(s);
        let rows: [DVec3; 3] = [t.cross(u) / volume, u.cross(s) / volume, s.cross(t) / volume];
        DMat3::from_cols(rows[0], rows[1], rows[2]).transpose()
    }

    /// Where one place goes.
    pub fn at(&self, p: Vec3) -> Vec3 {
        let mut out = [p];
        let _ = self.apply(&[p], &mut out, &Task::new());
        out[0]
    }

    /// Moves `points` to `out`, of the same length. What is outside stays to the bit, and so does every place whose
    /// control points have not moved.
    ///
    /// # Errors
    /// Cancelling.
    pub fn apply(&self, points: &[Vec3], out: &mut [Vec3], task: &Task) -> Result<(), DeformError> {
        let grid = Grid::new(self.origin, &self.inverse(), self.divisions, &self.controls.moves);
        let limit = self.controls.limit();
        points.par_chunks(PIECE).zip(out.par_chunks_mut(PIECE)).try_for_each(|(from, to)| {
            task.check()?;
            kernel::lattice(&grid, from, to);
            if let Some(limit) = &limit {
                kernel::limit(limit, from, to);
            }
            Ok(())
        })
    }

    /// Feeds all of it to a key that has a say in where points go.
    pub fn digest(&self, into: &mut Digest) {
        into.bytes(b"lattice 2").vectors(&[self.origin, self.edges.x_axis, self.edges.y_axis, self.edges.z_axis]);
        into.numbers(&self.divisions.map(|d| d as u32)).vectors(&self.controls.moves);
        into.vectors(&self.controls.held).floats(&[self.controls.power]);
    }
}

/// Bernstein polynomials of a degree and their slopes, at places spread evenly from 0 to 1.
fn table(degree: usize, samples: usize) -> Vec<Vec<[f64; 2]>> {
    let polynomials = |degree: usize, t: f64| {
        let mut row = vec![1.0];
        for _ in 0..degree {
            let mut next = vec![0.0; row.len() + 1];
            for (k, b) in row.iter().enumerate() {
                next[k] += (1.0 - t) * b;
                next[k + 1] += t * b;
            }
            row = next;
        }
        row
    };
    let at = |s: usize| {
        let t = s as f64 / (samples - 1) as f64;
        let (row, below) = (polynomials(degree, t), polynomials(degree - 1, t));
        let slope = |k: usize| {
            let left = if k > 0 { below[k - 1] } else { 0.0 };
            degree as f64 * (left - below.get(k).copied().unwrap_or(0.0))
        };
        (0..=degree).map(|k| [row[k], slope(k)]).collect()
    };
    (0..samples).map(at).collect()
}
