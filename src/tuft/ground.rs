//! The head as tufts see it.

use glam::Vec3;

use crate::geometry::Solid;
use crate::math::trig;

/// The surface that tufts grow on, with the point H that the papers measure angles from.
#[derive(Clone, Copy, Debug)]
pub struct Ground<'a> {
    /// The inside and outside of the head.
    pub solid: &'a Solid,
    /// The reference point H: inside the skull, in the middle of the head; cm.
    pub reference: Vec3,
    /// The head's size over the adult mannequin's.
    pub scale: f32,
}

impl Ground<'_> {
    /// Where a ray from the reference point leaves the head. Cavities are passed over: the place found has free space
    /// beyond it. Where the ray finds none, the surface point closest to the place it reached.
    pub fn surface(&self, direction: Vec3) -> Vec3 {
        let reach = self.solid.bounds().size().length() + self.reference.distance(self.solid.bounds().centre());
        let free = 0.02 * self.solid.bounds().size().max_element();
        let mut from = self.reference;
        // Eye sockets, a mouth bag: a handful of layers at most.
        for _ in 0..16 {
            let Some(hit) = self.solid.bvh().first_hit(from, direction, reach) else { break };
            let beyond = hit.position + direction * free;
            if self.solid.signed_distance(beyond) > 0.0 {
                return hit.position;
            }
            from = hit.position + direction * (free * 0.05);
        }
        self.solid.closest(self.reference + direction * (reach * 0.25)).position
    }

    /// The place of the surface on the ray from the reference point through `p`.
    pub fn below(&self, p: Vec3) -> Vec3 {
        self.surface((p - self.reference).try_normalize().unwrap_or(Vec3::Y))
    }
}

/// Azimuth and elevation in radians of a vector, as in Shimosoyama et al. 2015, turned to Y up: azimuth -pi..pi grows
/// from the head's left (+X, 0) to the back of the head (-Z, pi/2); the face (+Z) is at -pi/2. Elevation -pi/2..pi/2
/// is up. A vertical vector has azimuth 0.
pub fn azimuth_elevation(v: Vec3) -> (f32, f32) {
    (trig::atan2(-v.z, v.x), trig::atan2(v.y, trig::hypot(v.x, v.z)))
}

/// The unit vector of an azimuth and an elevation: the inverse of [`azimuth_elevation`].
pub fn toward(azimuth: f32, elevation: f32) -> Vec3 {
    let c = trig::cos(elevation);
    Vec3::new(c * trig::cos(azimuth), trig::sin(elevation), -c * trig::sin(azimuth))
}
