//! The plane that a head is symmetric about.

use glam::{Affine3A, Quat, Vec3};

use super::crop::Crop;
use crate::geometry::sample::Patch;
use crate::geometry::{Bvh, Mesh};
use crate::math::rng::Key;

/// Places that are mirrored to judge a plane.
const PROBES: usize = 240;

/// A vertical plane: its turn about Y and where it stands.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plane {
    /// Radians about Y from "the face looks to +Z"; positive turns the face to +X.
    pub yaw: f32,
    /// Distance along the plane's normal from the crop's middle, cm.
    pub offset: f32,
    /// Mean squared distance between the head and its mirror image, cm^2.
    pub residual: f32,
}

/// Finds the plane by mirroring places on the head and asking how far they land from it.
pub(super) struct Search<'a> {
    bvh: &'a Bvh,
    middle: Vec3,
    size: f32,
    probes: Vec<Vec3>,
}

impl<'a> Search<'a> {
    /// `None` when the head has no area.
    pub fn new(mesh: &Mesh, bvh: &'a Bvh, crop: &Crop) -> Option<Self> {
        let patch = Patch::new(mesh, crop.triangles(mesh, 0.0))?;
        let key = Key::new(0, "symmetry");
        let probes = (0..PROBES).map(|i| patch.stratified(i, PROBES, key).position).collect();
        Some(Self { bvh, middle: crop.middle, size: crop.height(), probes })
    }

    /// The best plane within 45 degrees of x = const.
    pub fn best(&self) -> Plane {
        let straight = self.refined(self.plane(0.0, 0.0), 0.0);
        let centroid = self.probes.iter().sum::<Vec3>() / self.probes.len() as f32 - self.middle;
        let start = [15.0_f32, -15.0, 30.0, -30.0, 45.0, -45.0]
            .map(|yaw| {
                let yaw = yaw.to_radians();
                self.plane(yaw, centroid.dot(Quat::from_rotation_y(yaw) * Vec3::X))
            })
            .into_iter()
            .fold(straight, |a, b| if self.cost(&b) < self.cost(&a) { b } else { a });
        let best = self.refined(start, 8.0);
        // A head as good as symmetric about its own file's plane stays as it is.
        let slack = (0.001 * self.size) * (0.001 * self.size);
        if straight.residual <= best.residual * 1.02 + slack { straight } else { best }
    }

    /// The plane across: what a face that looks to +X or -X is symmetric about.
    pub fn across(&self) -> Plane {
        self.refined(self.plane(std::f32::consts::FRAC_PI_2, 0.0), 0.0)
    }

    /// From the plane's own frame (x = 0 is the plane, +Z forward, origin in the crop's middle) to the mesh's.
    pub fn frame(&self, plane: &Plane) -> Affine3A {
        let turn = Quat::from_rotation_y(plane.yaw);
        Affine3A::from_rotation_translation(turn, self.middle + turn * Vec3::X * plane.offset)
    }

    fn plane(&self, yaw: f32, offset: f32) -> Plane {
        let normal = Quat::from_rotation_y(yaw) * Vec3::X;
        let cap = (0.15 * self.size) * (0.15 * self.size);
        let sum: f32 = self
            .probes
            .iter()
            .map(|&p| {
                let mirrored = p - normal * (2.0 * ((p - self.middle).dot(normal) - offset));
                self.bvh.closest(mirrored, 0.15 * self.size).map_or(cap, |c| c.distance * c.distance)
            })
            .sum();
        Plane { yaw, offset, residual: sum / self.probes.len() as f32 }
    }

    /// A round head is symmetric about every plane: then the one nearest to straight is meant.
    fn cost(&self, plane: &Plane) -> f32 {
        let bias = 0.004 * self.size * plane.yaw / 45.0_f32.to_radians();
        plane.residual + bias * bias
    }

    /// Pattern search: tries a step in each direction, halves it when none helps. No turn when `degrees` is zero.
    fn refined(&self, start: Plane, degrees: f32) -> Plane {
        let (mut best, mut turn, mut shift) = (start, degrees.to_radians(), 0.08 * self.size);
        while shift > 0.0005 * self.size {
            let steps = [(turn, 0.0), (-turn, 0.0), (0.0, shift), (0.0, -shift)];
            let found = steps
                .iter()
                .filter(|s| s.0 != 0.0 || s.1 != 0.0)
                .map(|s| self.plane(best.yaw + s.0, best.offset + s.1))
                .min_by(|a, b| self.cost(a).total_cmp(&self.cost(b)));
            match found {
                Some(plane) if self.cost(&plane) < self.cost(&best) => best = plane,
                _ => (turn, shift) = (turn * 0.5, shift * 0.5),
            }
        }
        best
    }
}
