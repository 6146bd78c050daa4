//! What can be wrong with a call.

use crate::geometry::StrandsError;
use crate::task::Cancelled;

/// Why strands could not be moved.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DynamicsError {
    /// The run was stopped from outside.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// The strands are no proper strands.
    #[error(transparent)]
    Strands(#[from] StrandsError),
    /// There is nothing to move.
    #[error("there are no strands to move")]
    Nothing,
    /// More than the machine should be asked for.
    #[error("`{count}` {what}; at most {limit} are allowed")]
    TooMany {
        /// "nodes", "nodes in all frames".
        what: &'static str,
        /// How many were asked for.
        count: u64,
        /// How many are allowed.
        limit: u64,
    },
    /// A number is NaN or infinite, or lies outside what its field allows.
    #[error("{what} is `{value}`")]
    Value {
        /// What it is of.
        what: String,
        /// The number.
        value: f32,
    },
    /// A segment without length has no direction to keep.
    #[error("segment {segment} of strand {strand} has a length of `{length}` cm")]
    Segment {
        /// Index of the strand.
        strand: usize,
        /// Number of the segment, from 1 at the root.
        segment: usize,
        /// Its length, cm.
        length: f32,
    },
    /// A force changes so fast from place to place that a step would jump over it.
    #[error("{force} is too strong for `{steps}` steps per second")]
    Stiff {
        /// Which force.
        force: String,
        /// Steps per second that were asked for.
        steps: f32,
        /// Steps per second that it needs.
        needed: f32,
    },
    /// All forces together throw a node farther in one step than a segment is long.
    #[error(
        "forces of up to `{acceleration:.0}` cm/s2 move hair {way:.2} cm in a step, more than half a segment of {segment:.2} cm"
    )]
    Fast {
        /// Sum of the greatest accelerations, cm/s^2.
        acceleration: f32,
        /// The way in one step, cm.
        way: f32,
        /// Mean length of a segment, cm, of the strand where it is least.
        segment: f32,
        /// Steps per second that it needs.
        needed: f32,
    },
    /// The head moves so fast that strands cannot follow.
    #[error("the head moves roots by `{way:.2}` cm in a step, more than two segments of {segment:.2} cm")]
    Head {
        /// The way of a root in one step, cm.
        way: f32,
        /// Mean length of a segment, cm, of the strand where it is least.
        segment: f32,
        /// Steps per second that it needs.
        needed: f32,
    },
    /// Stiffer than numbers of this precision can carry.
    #[error("a hold of `{hold}` cm is too stiff for segments of {segment:.3} cm at {steps} steps per second")]
    Hold {
        /// The hold, cm.
        hold: f32,
        /// Mean length of a segment, cm, of the strand where it is least.
        segment: f32,
        /// Steps per second.
        steps: f32,
        /// The greatest hold that works, cm.
        most: f32,
    },
    /// The grid of the repulsion would be larger than memory allows.
    #[error("a spacing of `{spacing}` cm is too fine for hair that fills {size} cm")]
    Spacing {
        /// The spacing, cm.
        spacing: f32,
        /// Edge lengths of the hair's bounds.
        size: String,
        /// The least spacing that works, cm.
        least: f32,
    },
    /// A motion of the head with another rate.
    #[error("the motion of the head has `{motion}` frames per second, the clip {clip}")]
    Rate {
        /// Of the motion.
        motion: f32,
        /// Of the clip.
        clip: f32,
    },
}

impl DynamicsError {
    /// What to do about it.
    pub fn hint(&self) -> Option<String> {
        Some(match self {
            Self::Cancelled(_) | Self::Strands(_) | Self::Value { .. } => return None,
            Self::Nothing => "is the region empty, or its density 0?".into(),
            Self::TooMany { .. } => "move guides, and fill between them afterwards".into(),
            Self::Segment { .. } => {
                "strands that were cut against the head cannot be moved; give them more room".into()
            }
            Self::Stiff { needed, .. } => format!("raise `steps` to {needed:.0}, or lower its `strength`"),
            Self::Fast { needed, .. } => {
                format!("raise `steps` to {needed:.0}, lower the strengths, or give strands fewer nodes")
            }
            Self::Head { needed, .. } => format!("raise `steps` to {needed:.0}, or let the head move more slowly"),
            Self::Hold { most, .. } => format!("lower `hold` to {most:.1}, raise `steps`, or give strands fewer nodes"),
            Self::Spacing { least, .. } => format!("raise `spacing` to {least:.2}"),
            Self::Rate { motion, .. } => format!("write `rate = {motion}`, or leave `rate` out"),
        })
    }
}

/// Refuses numbers that are none, or outside `lo..=hi`.
pub fn check_value(what: impl Into<String>, value: f32, lo: f32, hi: f32) -> Result<(), DynamicsError> {
    if value >= lo && value <= hi { Ok(()) } else { Err(DynamicsError::Value { what: what.into(), value }) }
}
