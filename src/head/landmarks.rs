//! The named places of a head.

use glam::{Affine3A, Vec3};

/// Named places on a head's surface, cm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Landmarks {
    /// The top of the head, in the middle.
    pub vertex: Vec3,
    /// The middle of the hairline over the face.
    pub forehead: Vec3,
    /// The hairline beside the left eye's brow.
    pub left_temple: Vec3,
    /// The hairline beside the right eye's brow.
    pub right_temple: Vec3,
    /// The left ear, at half its height, near its front.
    pub left_ear: Vec3,
    /// The right ear, at half its height, near its front.
    pub right_ear: Vec3,
    /// The hindmost place of the skull, in the middle.
    pub occiput: Vec3,
    /// The lower end of the hairline, in the middle of the neck's back.
    pub nape: Vec3,
    /// The tip of the chin, where it turns under.
    pub chin: Vec3,
}

impl Landmarks {
    /// Every name, in the order of the fields.
    pub const NAMES: [&'static str; 9] =
        ["vertex", "forehead", "left_temple", "right_temple", "left_ear", "right_ear", "occiput", "nape", "chin"];

    /// All places, in the order of [`Landmarks::NAMES`].
    pub fn all(&self) -> [Vec3; 9] {
        [
            self.vertex,
            self.forehead,
            self.left_temple,
            self.right_temple,
            self.left_ear,
            self.right_ear,
            self.occiput,
            self.nape,
            self.chin,
        ]
    }

    /// From all places, in the order of [`Landmarks::NAMES`].
    pub fn from_all(all: [Vec3; 9]) -> Self {
        let [vertex, forehead, left_temple, right_temple, left_ear, right_ear, occiput, nape, chin] = all;
        Self { vertex, forehead, left_temple, right_temple, left_ear, right_ear, occiput, nape, chin }
    }

    /// The place of that name; `left ear` and `left-ear` stand for `left_ear`.
    pub fn get(&self, name: &str) -> Option<Vec3> {
        Self::index(name).map(|i| self.all()[i])
    }

    /// The index of a name in [`Landmarks::NAMES`].
    pub fn index(name: &str) -> Option<usize> {
        let name = name.trim().replace([' ', '-'], "_");
        Self::NAMES.iter().position(|&n| n == name)
    }

    /// The same landmarks with one place changed; unchanged for an unknown name.
    #[must_use]
    pub fn with(self, name: &str, place: Vec3) -> Self {
        let mut all = self.all();
        if let Some(i) = Self::index(name) {
            all[i] = place;
        }
        Self::from_all(all)
    }

    /// The same landmarks, moved.
    #[must_use]
    pub fn transformed(&self, by: &Affine3A) -> Self {
        Self::from_all(self.all().map(|p| by.transform_point3(p)))
    }

    /// The middle between the ears.
    pub fn between_ears(&self) -> Vec3 {
        (self.left_ear + self.right_ear) * 0.5
    }

    /// Height from chin to vertex, cm.
    pub fn height(&self) -> f32 {
        self.vertex.y - self.chin.y
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_fields_agree() {
        let marks = Landmarks::from_all(std::array::from_fn(|i| Vec3::splat(i as f32)));
        assert_eq!(marks.get("vertex"), Some(marks.vertex));
        assert_eq!(marks.get("left ear"), Some(marks.left_ear));
        assert_eq!(marks.get("right-temple"), Some(marks.right_temple));
        assert_eq!(marks.get("chin"), Some(marks.chin));
        assert_eq!(marks.get("nose"), None);
        for (i, name) in Landmarks::NAMES.iter().enumerate() {
            assert_eq!(marks.with(name, Vec3::NEG_ONE).all()[i], Vec3::NEG_ONE, "{name}");
        }
    }
}
