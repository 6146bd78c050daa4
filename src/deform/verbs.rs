//! Bend, taper, lift: lattices that are made from a few words.

use glam::{Mat3, Quat, Vec3};

use super::{DeformError, Lattice, Move, PointKind};
use crate::geometry::Bounds;
use crate::params::{Angle, Direction};

/// Divisions along the direction of the motion.
const ALONG: u32 = 6;
/// Layers of control points at the near end that stay, so that value and slope go on where the lattice begins.
const STILL: usize = 2;

crate::params! {
    /// Bends it, as a whole: what lies at the far end turns by the angle, in between by a part of it.
    pub struct Bend("bend") {
        /// By how much at the far end.
        angle: Angle, range(-180.0, 180.0);
        /// Which way the far end goes.
        towards: Direction = Direction(Vec3::Z);
        /// From the near end to the far end.
        along: Direction = Direction(Vec3::NEG_Y);
        /// Where it begins, as a part of the way from the near end.
        from: f32 = 0.0, range(0.0, 0.95);
    }
}

crate::params! {
    /// Makes it narrower, or wider (flared), towards the far end.
    pub struct Taper("taper") {
        /// Width at the far end as a multiple of what it was: below 1 narrows, above 1 flares.
        width: f32, range(0.01, 10.0);
        /// From the near end to the far end.
        along: Direction = Direction(Vec3::NEG_Y);
        /// Where it begins, as a part of the way from the near end.
        from: f32 = 0.0, range(0.0, 0.95);
        /// The axis that it narrows towards goes through this place; the middle when left out.
        about: Option<Vec3>, unit("cm");
    }
}

crate::params! {
    /// Lifts it: what lies at the far end is moved by the whole distance, what lies at the near end stays.
    pub struct Lift("lift") {
        /// How far at the far end.
        by: f32, unit("cm"), range(-100.0, 100.0);
        /// Which way.
        towards: Direction = Direction(Vec3::Y);
        /// From the near end to the far end; as `towards` when left out.
        along: Option<Direction>;
        /// Where it begins, as a part of the way from the near end.
        from: f32 = 0.0, range(0.0, 0.95);
    }
}

impl Bend {
    /// The lattice that bends points; `None` when there is nothing to bend.
    ///
    /// # Errors
    /// Places where numbers end.
    pub fn lattice(&self, points: &[Vec3]) -> Result<Option<Lattice>, DeformError> {
        let Some(Cage { lattice, axes, size, start }) = cage(points, self.along.0, self.from)? else { return Ok(None) };
        let along = axes.col(1);
        let side = self.towards.0 - along * self.towards.0.dot(along);
        let Some(side) = side.try_normalize() else { return Ok(Some(lattice)) };
        let length = size.y;
        // An arc of the same length as the straight line it comes from, its control points by the tangents at its ends.
        let (angle, axis) = (self.angle.radians, along.cross(side));
        let moved = lattice.clone().placed(&all(&lattice), |i, p| {
            let [_, j, _] = lattice.indices(i as usize);
            let h = (j as f32 - (STILL - 1) as f32).max(0.0) / (ALONG as f32 - (STILL - 1) as f32);
            let far = length * (j as f32 / ALONG as f32);
            let hinge = start + along * (length * (STILL - 1) as f32 / ALONG as f32);
            let run = far - length * (STILL - 1) as f32 / ALONG as f32;
            if run <= 0.0 || angle == 0.0 {
                return p;
            }
            let phi = angle * h;
            // The arc from the hinge, as far as this layer.
            let (s, c) = (crate::math::trig::sin(phi), crate::math::trig::cos(phi));
            let (ahead, aside) =
                if phi.abs() < 1e-4 { (run, 0.5 * run * phi) } else { (run * s / phi, run * (1.0 - c) / phi) };
            let across = p - (start + along * far);
            hinge + along * ahead + side * aside + Quat::from_axis_angle(axis, phi) * across
        })?;
        Ok(Some(moved))
    }
}

impl Taper {
    /// The lattice that tapers points; `None` when there is nothing to taper.
    ///
    /// # Errors
    /// Places where numbers end.
    pub fn lattice(&self, points: &[Vec3]) -> Result<Option<Lattice>, DeformError> {
        let Some(Cage { mut lattice, axes, start, .. }) = cage(points, self.along.0, self.from)? else {
            return Ok(None);
        };
        let along = axes.col(1);
        let through = self.about.unwrap_or(start);
        for j in STILL..=ALONG as usize {
            let h = (j - STILL + 1) as f32 / (ALONG as usize - STILL + 1) as f32;
            let scale = 1.0 + (self.width - 1.0) * h;
            let layer: Vec<u32> =
                (0..lattice.count() as u32).filter(|&i| lattice.indices(i as usize)[1] == j).collect();
            lattice = lattice.placed(&layer, |_, p| {
                let foot = through + along * (p - through).dot(along);
                if scale == 1.0 { p } else { foot + (p - foot) * scale }
            })?;
        }
        Ok(Some(lattice))
    }
}

impl Lift {
    /// The lattice that lifts points; `None` when there is nothing to lift.
    ///
    /// # Errors
    /// Places where numbers end.
    pub fn lattice(&self, points: &[Vec3]) -> Result<Option<Lattice>, DeformError> {
        let along = self.along.unwrap_or(self.towards);
        let Some(Cage { mut lattice, .. }) = cage(points, along.0, self.from)? else { return Ok(None) };
        for j in STILL..=ALONG as usize {
            let h = (j - STILL + 1) as f32 / (ALONG as usize - STILL + 1) as f32;
            let layer: Vec<u32> =
                (0..lattice.count() as u32).filter(|&i| lattice.indices(i as usize)[1] == j).collect();
            lattice = lattice.moved(&layer, &Move { by: self.towards.0 * (self.by * h), ..Move::default() })?;
        }
        Ok(Some(lattice))
    }
}

/// A lattice whose T runs along the motion.
struct Cage {
    lattice: Lattice,
    /// Columns: its unit edges.
    axes: Mat3,
    size: Vec3,
    /// The middle of the layer of control points at the near end.
    start: Vec3,
}

/// A lattice around points with T along `along`, from a part of the way to a little beyond the far end. Its first two
/// layers are fixed.
fn cage(points: &[Vec3], along: Vec3, from: f32) -> Result<Option<Cage>, DeformError> {
    // S across, to the head's left where that is across, so that a mirrored value gets the mirrored lattice.
    let other = if along.x.abs() < 0.9 { Vec3::X } else { Vec3::Z };
    let across = (other - along * other.dot(along)).normalize();
    let axes = Mat3::from_cols(across, along, across.cross(along));
    let turn = axes.transpose();
    let bounds = Bounds::of(points.iter().map(|&p| turn * p));
    if bounds.is_empty() {
        return Ok(None);
    }
    let slack = 0.01 * bounds.size().max_element().max(1e-3);
    let mut low = bounds.min - Vec3::splat(slack);
    let high = bounds.max + Vec3::splat(slack);
    // What lies at the near end is exactly on the border, where nothing moves.
    low.y = bounds.min.y + from * bounds.size().y;
    let size = high - low;
    let edges = [axes.col(0) * size.x, axes.col(1) * size.y, axes.col(2) * size.z];
    let lattice = Lattice::new(axes * low, edges, [1, ALONG, 1])?;
    let still: Vec<u32> = (0..lattice.count() as u32).filter(|&i| lattice.indices(i as usize)[1] < STILL).collect();
    let lattice = lattice.marked(&still, PointKind::Fixed);
    let free: Vec<u32> = (0..lattice.count() as u32).filter(|i| !still.contains(i)).collect();
    let lattice = lattice.marked(&free, PointKind::Feature);
    let start = axes * Vec3::new(0.5 * (low.x + high.x), low.y, 0.5 * (low.z + high.z));
    Ok(Some(Cage { lattice, axes, size, start }))
}

fn all(lattice: &Lattice) -> Vec<u32> {
    (0..lattice.count() as u32).collect()
}
