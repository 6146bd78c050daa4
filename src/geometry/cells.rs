//! What is known at once of a solid's surface around a place: lower bounds on the distance, kept in cells.
//!
//! Space around the solid is cut into large cells, those near the surface into 512 small ones, which share leaves: a
//! leaf is a cube of one, 8 or 64 small cells, or a large cell. A look-up is three steps: large cell, small cell, leaf.
//!
//! Two lower bounds come from a leaf. The distance is 1-Lipschitz, so in a cell with centre c it is at least
//! d(c) - |p - c|. And whatever is closest to a point of the cell lies within R = |d(c)| + 2 r of c, where r is half the
//! cell's diagonal: if all of the surface in that ball is below a plane n . x = h, the distance is at least n . p - h,
//! which is far better close to a surface that is nearly flat at this scale.

use glam::Vec3;
use rayon::prelude::*;

use super::{Bounds, Solid, SurfacePoint};

/// Leaves of a solid, finer near its surface.
pub(super) struct Cells {
    bounds: Bounds,
    /// Edge of a large cell, cm.
    size: f32,
    /// One over it.
    per_size: f32,
    counts: [usize; 3],
    /// Per large cell: its leaf, or [`FINE`] and the number of its small cells' block.
    large: Vec<u32>,
    /// Leaves of small cells, 512 for each large cell that has them.
    small: Vec<u32>,
    leaves: Vec<Leaf>,
    /// Per leaf: the place in the tree of the triangle that is closest to its centre.
    closest: Vec<u32>,
}

/// A cube, and what is known of the surface around it.
#[derive(Clone, Copy)]
struct Leaf {
    centre: Vec3,
    /// Distance at the centre.
    distance: f32,
    /// What is closest to any of its points is below this plane; without a plane the height is infinite.
    normal: Vec3,
    height: f32,
}

/// What is known at once of the surface around a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vicinity {
    /// A lower bound on the distance to the surface: positive only outside, and then not more than the distance, cm.
    pub clearance: f32,
    leaf: u32,
}

/// Normal and height.
type Plane = (Vec3, f32);

/// Marks a large cell that has small ones.
const FINE: u32 = 1 << 31;
/// No leaf: outside of all cells.
const NONE: u32 = u32::MAX;

/// A leaf in the making, and where it lies among the small cells of its large one.
struct Unit {
    large: u32,
    /// Its first small cell, and how many it spans along each side.
    first: [u32; 3],
    span: u32,
    centre: Vec3,
    /// No less than the distance at its centre.
    most: f32,
    /// The place in the tree of a triangle near it.
    guess: Option<u32>,
}

impl Cells {
    /// Large cells along the longest side.
    const LARGE: f32 = 16.0;
    /// How often a large cell may be halved.
    const LEVELS: u32 = 3;
    /// Small cells along one side of a large one.
    const SMALL: u32 = 1 << Self::LEVELS;
    const BLOCK: usize = (Self::SMALL * Self::SMALL * Self::SMALL) as usize;

    pub(super) fn build(solid: &Solid) -> Self {
        let bounds = solid.bounds().grown(solid.bounds().size().max_element() * 0.02);
        let size = bounds.size().max_element() / Self::LARGE;
        let counts = bounds.size().to_array().map(|s| ((s / size).ceil() as usize).max(1));
        let mut cells = Self {
            bounds,
            size,
            per_size: size.recip(),
            counts,
            large: vec![NONE; counts.iter().product()],
            small: Vec::new(),
            leaves: Vec::new(),
            closest: Vec::new(),
        };
        let mut level: Vec<Unit> = (0..cells.large.len())
            .map(|i| {
                let at = [i % counts[0], i / counts[0] % counts[1], i / counts[0] / counts[1]];
                let centre = bounds.min + (Vec3::from(at.map(|n| n as f32)) + 0.5) * size;
                let most = f32::MAX.sqrt();
                Unit { large: i as u32, first: [0; 3], span: Self::SMALL, centre, most, guess: None }
            })
            .collect();
        let mut half = size * 0.5;
        for depth in 0..=Self::LEVELS {
            // The half diagonal is where the first bound turns useless at the cell's corners.
            let is_near = |d: f32| d.abs() < 1.25 * half * 3.0_f32.sqrt();
            let found: Vec<(f32, u32, Option<Plane>)> = (level.par_iter())
                .map(|unit| {
                    let found = solid.guessed(unit.centre, unit.most, unit.guess);
                    let Some((near, slot)) = found.or_else(|| solid.guessed(unit.centre, f32::MAX.sqrt(), None)) else {
                        return (0.0, 0, None);
                    };
                    let is_last = depth == Self::LEVELS && is_near(near.distance);
                    let plane = if is_last { plane(solid, unit.centre, half, &near, slot) } else { None };
                    (near.distance, slot, plane)
                })
                .collect();
            let mut below = Vec::new();
            for (unit, (distance, slot, plane)) in level.iter().zip(found) {
                if depth < Self::LEVELS && is_near(distance) {
                    let span = unit.span / 2;
                    below.extend((0..8).map(|k| {
                        let bit = |axis: u32| k >> axis & 1;
                        let sign = |axis: u32| if bit(axis) == 1 { 0.5 } else { -0.5 };
                        Unit {
                            large: unit.large,
                            first: [0, 1, 2].map(|axis| unit.first[axis as usize] + bit(axis) * span),
                            span,
                            centre: unit.centre + Vec3::new(sign(0), sign(1), sign(2)) * half,
                            most: distance.abs() + 0.26 * reach(half),
                            guess: Some(slot),
                        }
                    }));
                } else {
                    let (normal, height) = plane.unwrap_or((Vec3::ZERO, f32::INFINITY));
                    cells.add(unit, Leaf { centre: unit.centre, distance, normal, height }, slot);
                }
            }
            level = below;
            half *= 0.5;
        }
        cells
    }

    fn add(&mut self, unit: &Unit, leaf: Leaf, slot: u32) {
        let number = self.leaves.len() as u32;
        self.leaves.push(leaf);
        self.closest.push(slot);
        let large = &mut self.large[unit.large as usize];
        if unit.span == Self::SMALL {
            *large = number;
            return;
        }
        if *large == NONE {
            *large = FINE | (self.small.len() / Self::BLOCK) as u32;
            self.small.extend([NONE; Self::BLOCK]);
        }
        let block = (*large & !FINE) as usize * Self::BLOCK;
        let [x, y, z] = unit.first;
        for (k, j) in (z..z + unit.span).flat_map(|k| (y..y + unit.span).map(move |j| (k, j))) {
            let row = block + (x + Self::SMALL * (j + Self::SMALL * k)) as usize;
            self.small[row..row + unit.span as usize].fill(number);
        }
    }

    /// What is known around `p`.
    #[inline]
    pub(super) fn around(&self, p: Vec3) -> Vicinity {
        let cell = (p - self.bounds.min) * self.per_size;
        let limit = Vec3::new(self.counts[0] as f32, self.counts[1] as f32, self.counts[2] as f32);
        if !(cell.cmpge(Vec3::ZERO).all() && cell.cmplt(limit).all()) {
            // Outside the box the box itself is the bound; NaN gives 0: "ask".
            let out = (p - p.clamp(self.bounds.min, self.bounds.max)).length();
            return Vicinity { clearance: if out > 0.0 { out } else { 0.0 }, leaf: NONE };
        }
        let whole = cell.as_uvec3();
        let mut number =
            self.large[whole.x as usize + self.counts[0] * (whole.y as usize + self.counts[1] * whole.z as usize)];
        if number & FINE != 0 {
            let fine =
                ((cell - whole.as_vec3()) * Self::SMALL as f32).as_uvec3().min(glam::UVec3::splat(Self::SMALL - 1));
            let at = fine.x + Self::SMALL * (fine.y + Self::SMALL * fine.z);
            number = self.small[(number & !FINE) as usize * Self::BLOCK + at as usize];
        }
        let leaf = &self.leaves[number as usize];
        let bound = leaf.distance - p.distance(leaf.centre);
        Vicinity { clearance: bound.max(leaf.normal.dot(p) - leaf.height), leaf: number }
    }

    /// The place in the tree of a triangle near there.
    pub(super) fn guess(&self, around: &Vicinity) -> Option<u32> {
        self.closest.get(around.leaf as usize).copied()
    }

    /// True when both ends are over the plane of the first one's cell and in the ball that it is good for: then so is
    /// all between them.
    pub(super) fn is_free(&self, around: &Vicinity, p: Vec3, q: Vec3) -> bool {
        let Some(leaf) = self.leaves.get(around.leaf as usize) else { return false };
        // Only the smallest have planes.
        let reach = leaf.distance.abs() + reach(self.size * 0.5 / Self::SMALL as f32);
        leaf.normal.dot(p) > leaf.height
            && leaf.normal.dot(q) > leaf.height
            && q.distance_squared(leaf.centre) <= reach * reach
    }
}

/// How much farther than its centre's the closest place of any point of a cell with this half edge may be from its
/// centre.
fn reach(half: f32) -> f32 {
    2.0 * half * 3.0_f32.sqrt()
}

/// The plane over everything that can be closest to a point of the cell about `c`, if the part of the cell over it is
/// outside the solid. `near` is closest to `c`, a triangle at `slot` of the tree.
fn plane(solid: &Solid, c: Vec3, half: f32, near: &SurfacePoint, slot: u32) -> Option<Plane> {
    let outward = (c - near.position) * near.distance.signum();
    let normal = if near.distance.abs() > 1e-3 * half { outward.normalize_or(near.normal) } else { near.normal };
    let reach = (near.distance.abs() + reach(half)) * 1.0001;
    let height = solid.bvh().support_within(c, reach, normal);
    // A little higher, for rounding.
    let height = height + 1e-5 * (height.abs() + reach);
    // No surface is in the part of the cell over the plane, so one place tells for all of it on which side it is.
    let top = c + Vec3::select(normal.cmpge(Vec3::ZERO), Vec3::splat(half), Vec3::splat(-half));
    let is_over = height.is_finite() && normal.dot(top) > height;
    let is_outside = || solid.guessed(top, reach, Some(slot)).is_some_and(|(near, _)| near.distance > 0.0);
    (is_over && is_outside()).then_some((normal, height))
}
