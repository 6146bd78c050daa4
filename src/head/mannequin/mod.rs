//! The built-in mannequin: a shop-window head, modelled in code.
//!
//! The form is a signed distance field of blended primitives ([`field`]; [`adult`], [`cartoon`], [`ear`]). A mesh of
//! quads laid around it in rings ([`grid`]) is drawn onto the field and relaxed ([`wrap`]). Only the half with `x >= 0`
//! is computed; the other is its exact mirror image.

mod adult;
mod cartoon;
mod ear;
mod field;
mod grid;
mod wrap;

#[cfg(test)]
mod tests;

use glam::Vec3;

use crate::geometry::Mesh;

crate::choices! {
    /// Which mannequin.
    pub enum Style {
        /// An adult of common proportions, 23 cm from chin to vertex.
        Adult = "adult",
        /// A cartoon child: large skull, small low face, large closed eyes.
        Cartoon = "cartoon",
    }
}

/// How many landmarks [`landmarks`] gives.
pub const LANDMARK_COUNT: usize = 9;

/// Everything that makes one mannequin.
struct Form {
    /// Signed distance in cm to the half with `x >= 0`.
    distance: fn(Vec3) -> f32,
    /// Wanted length of an edge in cm at a place, for the relaxation.
    edge: fn(Vec3) -> f32,
    /// Rings of the cage from the top cap down, where it is known.
    rings: &'static [grid::Ring],
    /// `(columns, degrees)`: how many columns of the half go to the next so many degrees, from the front.
    columns: &'static [(usize, f32)],
    /// The group that a place of the half belongs to.
    zone: fn(Vec3) -> grid::Zone,
    /// Where the landmarks are sought: a point outside (right of the middle for the right
    /// one of a pair) and the direction to the surface as on the left side.
    landmarks: [(&'static str, Vec3, Vec3); LANDMARK_COUNT],
}

/// The form of a style.
fn form(style: Style) -> Form {
    match style {
        Style::Adult => adult::form(),
        Style::Cartoon => cartoon::form(),
    }
}

/// The mannequin in head space: a closed surface, exactly mirrored in x, with unit normals and a cylindrical uv whose
/// seam runs down the middle of the back (v up). Its groups "face", "head" (the rest of the head), "ear_left",
/// "ear_right", "neck" and "shoulders" do not overlap and leave nothing out.
pub fn mesh(style: Style) -> Mesh {
    let form = form(style);
    let half = grid::Half::new(&form);
    let positions = wrap::wrap(&form, &half);
    grid::assemble(&form, &half, &positions)
}

/// Named points on the surface of the mannequin, in head space; the two ears' middle is the origin.
pub fn landmarks(style: Style) -> [(&'static str, Vec3); LANDMARK_COUNT] {
    let form = form(style);
    form.landmarks.map(|(name, from, towards)| {
        let mut p = wrap::cast(form.distance, Vec3::new(from.x.abs(), from.y, from.z), towards.normalize());
        if from.x < 0.0 {
            p.x = -p.x;
        }
        (name, p)
    })
}
