//! File formats: a [`Scene`](crate::scene::Scene) in, the bytes of a file out.
//!
//! One file or folder per format, all of one shape: `format(&Scene, &FormatOptions, &Task) -> Result<bytes>`. Nothing
//! here opens a file; whoever calls writes the bytes. The same scene and options give the same bytes on any number of
//! threads.
//!
//! * [`glb`](fn@glb): binary glTF 2.0, the head and the hair as ribbons or lines; [`guides_glb`]: the guides alone.
//! * [`usda`](fn@usda): USD as text, the head as a mesh, the hair and its guides as curves.
//! * [`cyhair`](fn@cyhair): the `.hair` files of Cem Yuksel, strands alone.

mod appearance;
pub mod cyhair;
mod error;
pub mod glb;
mod reduce;
pub mod usda;

pub use cyhair::{CyHairOptions, cyhair};
pub use error::ExportError;
pub use glb::{GlbOptions, MotionForm, PartMotion, StrandForm, glb, guides_glb, motions};
pub use usda::{UsdaOptions, usda};

use std::borrow::Cow;

use glam::Vec3;

use crate::geometry::strands::StrandsError;
use crate::geometry::{Mesh, Strands};
use crate::scene::{Body, Hair, Motion, Part};

crate::choices! {
    /// A file format.
    pub enum Format {
        /// Binary glTF: surfaces, and strands as ribbons or lines.
        Glb = "glb",
        /// USD as text: surfaces, strands and guides as curves.
        Usda = "usda",
        /// The `.hair` format: strands alone.
        Hair = "hair",
    }
}

impl Format {
    /// What the names of its files end in, without a dot.
    pub const fn ending(self) -> &'static str {
        self.text()
    }
}

/// Checks what every format relies on: finite nodes, and no strand that names a guide or source that is not there.
fn check_hair(part: &Part, hair: &Hair) -> Result<(), ExportError> {
    for strands in [&hair.strands, &hair.guides] {
        match strands.validate() {
            // Two parts of a style may grow from one root; no format minds.
            Ok(()) | Err(StrandsError::RepeatedId { .. }) => {}
            Err(error) => return Err(ExportError::Strands { part: part.name.clone(), error }),
        }
        check_sources(part, strands)?;
    }
    let count = hair.guides.count();
    match hair.strands.guide.iter().position(|&g| g as usize >= count) {
        Some(strand) => {
            let index = hair.strands.guide[strand];
            Err(ExportError::Dangling { part: part.name.clone(), strand, what: "guide", index, count })
        }
        None => Ok(()),
    }
}

/// Checks what no frame may have: other topology, numbers that are none.
///
/// # Errors
/// [`ExportError::Motion`] with the frame.
fn check_motion(part: &Part) -> Result<(), ExportError> {
    let Some(motion) = &part.motion else { return Ok(()) };
    let bad =
        |frame: usize, what: &'static str| Err(ExportError::Motion { part: part.name.clone(), frame: frame + 1, what });
    let points = |what: &[Vec3]| what.iter().all(|p| p.is_finite());
    let count = match (&part.body, motion) {
        (Body::Mesh(mesh, _), _) => mesh.positions.len(),
        (Body::Locks(locks), _) => locks.mesh.mesh.positions.len(),
        (Body::Hair(hair), _) => hair.strands.points.len(),
    };
    let found = match motion {
        Motion::Rigid(clip) => clip.frames.iter().position(|t| !t.is_finite()).map(|f| (f, "is not finite")),
        Motion::Surface(clip) => clip.frames.iter().enumerate().find_map(|(i, f)| match f {
            f if f.len() != count => Some((i, "has another number of vertices than the part at rest")),
            f if !points(f) => Some((i, "is not finite")),
            _ => None,
        }),
        Motion::Strands { strands, .. } => strands.frames.iter().enumerate().find_map(|(i, f)| match f {
            f if f.points.len() != count => Some((i, "has another number of nodes than the part at rest")),
            f if !points(&f.points) => Some((i, "is not finite")),
            _ => None,
        }),
    };
    match found {
        Some((frame, what)) => bad(frame, what),
        None => Ok(()),
    }
}

/// The frames of strands that move; none when they do not.
fn frames_of(part: &Part) -> Vec<&Strands> {
    match &part.motion {
        Some(Motion::Strands { strands, .. }) => strands.frames.iter().map(|f| &**f).collect(),
        Some(Motion::Rigid(_) | Motion::Surface(_)) | None => vec![],
    }
}

/// A set of strands without any list of sources is fine: then all indices are zero.
fn check_sources(part: &Part, strands: &Strands) -> Result<(), ExportError> {
    let count = strands.sources.len();
    match strands.source.iter().position(|&s| usize::from(s) >= count.max(1)) {
        Some(strand) => {
            let index = u32::from(strands.source[strand]);
            Err(ExportError::Dangling { part: part.name.clone(), strand, what: "source", index, count })
        }
        None => Ok(()),
    }
}

fn check_tolerance(tolerance: f32) -> Result<(), ExportError> {
    if tolerance.is_finite() && tolerance >= 0.0 { Ok(()) } else { Err(ExportError::Tolerance { tolerance }) }
}

/// The mesh with normals: its own, or computed ones when it has none.
fn with_normals(mesh: &Mesh) -> Cow<'_, Mesh> {
    if mesh.normals.is_empty() {
        let mut mesh = mesh.clone();
        mesh.compute_normals();
        Cow::Owned(mesh)
    } else {
        Cow::Borrowed(mesh)
    }
}
