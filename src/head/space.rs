//! Head space: where it lies, and the boxes and directions that go with it.

use glam::{Affine3A, Quat, Vec3};

use super::detect::Shape;
use super::ear::Ear;
use super::{Head, HeadError, Landmarks};
use crate::geometry::{Mesh, OrientedBox, Solid};
use crate::math::trig;
use crate::params::nearest;

/// From head space to the landmarks' space: the origin between the ears, turned about Y so that the ears lie left
/// and right.
pub(super) fn placement(marks: &Landmarks) -> Result<Affine3A, HeadError> {
    let bad = |what: String| Err(HeadError::BadLandmarks { what });
    if let Some((name, p)) = Landmarks::NAMES.iter().zip(marks.all()).find(|(_, p)| !p.is_finite()) {
        return bad(format!("`{name}` is not finite: `{p}`"));
    }
    if marks.height() <= 1e-3 {
        return bad(format!(
            "the chin at y = {:.2} is not below the vertex at y = {:.2}",
            marks.chin.y, marks.vertex.y
        ));
    }
    let across = (marks.left_ear - marks.right_ear).with_y(0.0);
    if across.length() < 0.1 * marks.height() {
        return bad(format!("the ears are `{:.2}` cm apart", across.length()));
    }
    let forward = marks.forehead - marks.occiput;
    if across.cross(Vec3::Y).dot(forward) <= 0.0 {
        return bad("the left ear is on the right side".into());
    }
    // +X turned by `yaw` about Y is (cos yaw, 0, -sin yaw).
    let yaw = trig::atan2(-across.z, across.x);
    Ok(Affine3A::from_rotation_translation(Quat::from_rotation_y(yaw), marks.between_ears()))
}

/// The middle of the skull: halfway between forehead and occiput, at a third of the way from the ears to the vertex.
pub(super) fn centre(marks: &Landmarks) -> Vec3 {
    let y = marks.between_ears().y;
    Vec3::new(0.0, y + (marks.vertex.y - y) * 0.35, (marks.forehead.z + marks.occiput.z) * 0.5)
}

/// Triangles of the head and the neck: not lower than 0.2 heads under the chin and the nape, not farther than 1.4 heads away.
pub(super) fn growing(mesh: &Mesh, marks: &Landmarks) -> Vec<u32> {
    let (height, centre) = (marks.height(), centre(marks));
    let low = marks.chin.y.min(marks.nape.y) - 0.2 * height;
    (0..mesh.triangles.len() as u32)
        .filter(|&t| {
            let [a, b, c] = mesh.corners(t as usize);
            let middle = (a + b + c) / 3.0;
            middle.y > low && middle.distance(centre) < 1.4 * height
        })
        .collect()
}

/// Measures both ears of a mesh in head space.
pub(super) fn ears(mesh: &Mesh, solid: &Solid, marks: &Landmarks) -> [Option<Ear>; 2] {
    let height = marks.height();
    let reach = mesh.bounds().size().x.min(1.5 * height);
    let shape = Shape { bvh: solid.bvh(), frame: Affine3A::IDENTITY, reach };
    [(marks.left_ear, 1.0), (marks.right_ear, -1.0)]
        .map(|(ear, sign)| Ear::measure(&shape, ear - Vec3::Z * (0.03 * height), height, sign))
}

impl Head {
    /// Names for [`Head::box_named`].
    pub const BOXES: [&'static str; 7] = ["all", "behind", "front", "left", "right", "above", "below"];

    /// A generous box in head space, named after the side of the ears it lies on.
    ///
    /// `all` reaches, times [`Head::scale`], 60 cm to the sides, 60 cm forward and back, 40 cm up and 120 cm down.
    /// The others are its halves: `behind` and `front` of the ears (z = 0), `left` and `right` of the middle
    /// (x = 0), `above` and `below` the ears (y = 0).
    ///
    /// # Errors
    /// An unknown name, with the nearest one.
    pub fn box_named(&self, name: &str) -> Result<OrientedBox, HeadError> {
        let (mut lo, mut hi) = (Vec3::new(-60.0, -120.0, -60.0), Vec3::new(60.0, 40.0, 60.0));
        match name {
            "all" => {}
            "behind" => hi.z = 0.0,
            "front" => lo.z = 0.0,
            "left" => lo.x = 0.0,
            "right" => hi.x = 0.0,
            "above" => lo.y = 0.0,
            "below" => hi.y = 0.0,
            _ => return Err(HeadError::UnknownBox { name: name.to_owned(), nearest: nearest(name, Head::BOXES) }),
        }
        Ok(OrientedBox::between(lo * self.scale, hi * self.scale))
    }

    /// Unit direction from [`Head::centre`] to the crown, halfway between vertex and occiput.
    pub fn crown(&self) -> Vec3 {
        let [up, back] =
            [self.landmarks.vertex, self.landmarks.occiput].map(|p| (p - self.centre()).normalize_or_zero());
        (up + back).normalize_or(Vec3::Y)
    }

    /// A place over the skin in a direction from [`Head::centre`]: `azimuth` radians from the face towards the head's
    /// left, `elevation` radians up, `height` cm (times [`Head::scale`]) over the skin.
    pub fn point(&self, azimuth: f32, elevation: f32, height: f32) -> Vec3 {
        let level = trig::cos(elevation);
        let direction = Vec3::new(trig::sin(azimuth) * level, trig::sin(elevation), trig::cos(azimuth) * level);
        let reach = self.landmarks.height();
        let skin = self.skin(direction, reach).map_or(self.centre() + direction * (0.4 * reach), |s| s.position);
        skin + direction * (height * self.scale)
    }
}
