//! The ear: a dished plate with helix, antihelix, concha, tragus and lobe.

use glam::{Vec2, Vec3};

use super::field::{bent_tube, carve, ellipse, ellipsoid, join, meet, sphere};

/// Where an ear sits and how large it is.
pub struct Ear {
    /// Middle of the ear's plate.
    pub centre: Vec3,
    /// Unit vectors of the plate: backward, up along the ear, outward.
    pub axes: [Vec3; 3],
    /// Size; 1 is an ear 6.4 cm tall.
    pub scale: f32,
}

impl Ear {
    /// Distance to the ear joined with what is behind it.
    pub fn join_to(&self, head: f32, p: Vec3) -> f32 {
        let q = (p - self.centre) / self.scale;
        // Nothing of the ear is further than 3.4 from its centre, and no blend below reaches further than 1.6.
        if q.length() > 3.4 + 1.7 + (head / self.scale).abs() {
            return head;
        }
        let e = Vec3::new(q.dot(self.axes[0]), q.dot(self.axes[1]), q.dot(self.axes[2]));
        self.scale * Self::shape(e, head / self.scale)
    }

    /// `e`: x backward, y up, z outward from the plate. The helix's rim lies near z = 0.3.
    fn shape(e: Vec3, head: f32) -> f32 {
        // An egg, narrower below.
        let narrow = 1.0 + 0.11 * (e.y - 1.0);
        let flat = Vec2::new((e.x - 0.08 * (e.y - 0.5)) / narrow.clamp(0.55, 1.25), e.y);
        let outline = ellipse(flat, Vec2::new(1.62, 3.1));
        // Root: fills the space between the plate and the head, so no narrow gap is left behind the ear.
        let root = ellipsoid(e, Vec3::new(-0.45, 0.05, -1.0), Vec3::new(1.6, 2.9, 1.05));
        let plate = meet(outline + 0.1, (e.z + 0.2).abs() - 0.26, 0.3);
        let mut d = join(head, root, 1.6);
        d = join(d, plate, 0.8);
        // Concha.
        d = carve(d, ellipsoid(e, Vec3::new(-0.35, -0.35, 0.25), Vec3::new(0.85, 1.25, 0.75)), 0.35);
        // Helix: a roll along the outline, from the crus over the top and down behind.
        let fade = ((e.x + 1.5) * 0.8 + (e.y - 0.3).abs() * 0.5).clamp(0.0, 1.0);
        let rim = Vec2::new(outline + 0.22, e.z - 0.12).length() - 0.30 * (0.35 + 0.65 * fade);
        let rim = meet(rim, -e.y - 2.1, 1.0);
        d = join(d, rim, 0.18);
        let crus = bent_tube::<4>(
            e,
            [Vec3::new(-0.35, 0.15, -0.15), Vec3::new(-1.1, 0.4, 0.1), Vec3::new(-1.35, 1.6, 0.1)],
            [0.12, 0.2, 0.24],
        );
        d = join(d, crus, 0.25);
        // Antihelix.
        let anti = bent_tube::<6>(
            e,
            [Vec3::new(0.0, 1.7, 0.0), Vec3::new(1.05, 0.6, 0.12), Vec3::new(0.15, -1.35, 0.1)],
            [0.2, 0.26, 0.24],
        );
        d = join(d, anti, 0.3);
        // Tragus and antitragus.
        d = join(d, ellipsoid(e, Vec3::new(-1.2, -0.45, 0.05), Vec3::new(0.36, 0.55, 0.42)), 0.35);
        d = join(d, sphere(e, Vec3::new(-0.05, -1.5, 0.05), 0.3), 0.4);
        // Lobe.
        let lobe = ellipsoid(e, Vec3::new(-0.42, -2.2, -0.22), Vec3::new(0.85, 0.95, 0.4));
        join(d, lobe, 0.4)
    }
}
