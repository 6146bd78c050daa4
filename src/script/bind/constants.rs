//! Directions by name.

use glam::Vec3;

use super::super::registry::Constant;
use crate::params::Value;

/// `coif.up` and its kin, unit vectors in head space.
pub fn constants() -> Vec<Constant> {
    vec![
        Constant { name: "coif.up", doc: "Towards the crown, +Y.", value: || Value::Vector(Vec3::Y) },
        Constant { name: "coif.down", doc: "Towards the feet, -Y.", value: || Value::Vector(Vec3::NEG_Y) },
        Constant { name: "coif.front", doc: "Where the face looks, +Z.", value: || Value::Vector(Vec3::Z) },
        Constant { name: "coif.back", doc: "Away from the face, -Z.", value: || Value::Vector(Vec3::NEG_Z) },
        Constant { name: "coif.left", doc: "The head's own left, +X.", value: || Value::Vector(Vec3::X) },
        Constant { name: "coif.right", doc: "The head's own right, -X.", value: || Value::Vector(Vec3::NEG_X) },
    ]
}
