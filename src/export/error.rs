//! Why a scene cannot be written.

use glam::Affine3A;

use crate::geometry::MeshError;
use crate::geometry::strands::StrandsError;
use crate::task::Cancelled;

/// Why a scene cannot be written.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ExportError {
    /// The file would be larger than the options or the format allow.
    #[error("the file would have {bytes} bytes, more than the {limit} allowed")]
    TooLarge {
        /// Bytes it would have.
        bytes: u64,
        /// Bytes it may have.
        limit: u64,
    },
    /// A surface is broken.
    #[error("part `{part}`: {error}")]
    Mesh {
        /// Name of the part.
        part: String,
        /// What is wrong with it.
        error: MeshError,
    },
    /// A frame of a part that moves does not fit it.
    #[error("part `{part}`: frame {frame} {what}")]
    Motion {
        /// Name of the part.
        part: String,
        /// From 1.
        frame: usize,
        /// What is wrong with it.
        what: &'static str,
    },
    /// Strands that move want more joints than a file can number.
    #[error(
        "part `{part}`: its motion cannot be kept within {tolerance} cm by joints: allow more, or write it as shapes"
    )]
    Joints {
        /// Name of the part.
        part: String,
        /// What was asked for, cm.
        tolerance: f32,
    },
    /// Strands are broken.
    #[error("part `{part}`: {error}")]
    Strands {
        /// Name of the part.
        part: String,
        /// What is wrong with them.
        error: StrandsError,
    },
    /// A strand names a guide or a source that does not exist.
    #[error("part `{part}`: strand {strand} names {what} {index}, but there are only {count}")]
    Dangling {
        /// Name of the part.
        part: String,
        /// Index of the strand.
        strand: usize,
        /// "guide" or "source".
        what: &'static str,
        /// The index it names.
        index: u32,
        /// How many there are.
        count: usize,
    },
    /// A strand has more segments than the format can count.
    #[error("part `{part}`: strand {strand} has {segments} segments, more than the {limit} that the format can count")]
    TooManySegments {
        /// Name of the part.
        part: String,
        /// Index of the strand.
        strand: usize,
        /// How many it has.
        segments: usize,
        /// How many it may have.
        limit: usize,
    },
    /// The scene's placement is not made of a move, a turn and a scale.
    #[error("the placement of the scene is not a move, a turn and a scale: `{placement}`")]
    Placement {
        /// Its value.
        placement: Affine3A,
    },
    /// A number of the options is negative, NaN or infinite.
    #[error("the tolerance `{tolerance}` is not a length in cm")]
    Tolerance {
        /// Its value.
        tolerance: f32,
    },
    /// The caller asked to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}
