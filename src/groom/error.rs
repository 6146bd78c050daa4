//! What can be wrong with a call.

use glam::Vec3;

use crate::task::Cancelled;

/// Why hair could not be grown.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum GroomError {
    /// The run was stopped from outside.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// There is nothing to grow from.
    #[error("there are no {what}")]
    Nothing {
        /// "roots", "guides".
        what: &'static str,
    },
    /// More than the machine should be asked for.
    #[error("`{count}` {what} would take about {gigabytes:.1} GB; at most {limit} are allowed")]
    TooMany {
        /// "strands", "nodes".
        what: &'static str,
        /// How many were asked for.
        count: u64,
        /// How many are allowed.
        limit: u64,
        /// Memory they would take, in 10^9 bytes.
        gigabytes: f64,
    },
    /// The step does not fit the length.
    #[error("a step of `{step}` cm does not fit a length of `{length}` cm")]
    Step {
        /// The step, cm.
        step: f32,
        /// The length, cm.
        length: f32,
    },
    /// A box without volume.
    #[error("the box of {domain} has no volume: its size is `{size}`")]
    EmptyBox {
        /// Which domain.
        domain: String,
        /// The box's edge lengths.
        size: Vec3,
    },
    /// A number is NaN or infinite, or lies outside what its field allows.
    #[error("{what} is `{value}`")]
    Value {
        /// What it is of.
        what: String,
        /// The number.
        value: f32,
    },
    /// A domain stands in a queue of the other kind.
    #[error("{domain} cannot stand in a queue of {queue}")]
    WrongKind {
        /// Which domain.
        domain: String,
        /// "forces" or "natural domains".
        queue: &'static str,
    },
    /// A list has the wrong number of entries.
    #[error("{count} {what} for {expected} strands")]
    Count {
        /// What is counted.
        what: &'static str,
        /// How many there are.
        count: usize,
        /// How many there should be.
        expected: usize,
    },
    /// A frame of a clip has other strands than those at rest.
    #[error("frame {frame} has other strands, or other numbers of nodes, than the strands at rest")]
    Topology {
        /// From 1.
        frame: usize,
    },
    /// A clip that takes more memory than it should.
    #[error(
        "`{strands}` strands with {nodes} nodes in all over {frames} frames would take about {gigabytes:.1} GB; at most \
         {limit} are allowed"
    )]
    Clip {
        /// How many strands.
        strands: usize,
        /// How many nodes all of them have.
        nodes: usize,
        /// How many frames.
        frames: usize,
        /// Memory they would take, in 10^9 bytes.
        gigabytes: f64,
        /// Memory they may take, in 10^9 bytes.
        limit: f64,
    },
    /// The guides are no proper strands.
    #[error(transparent)]
    Strands(#[from] crate::geometry::StrandsError),
}

impl GroomError {
    /// What to do about it.
    pub fn hint(&self) -> Option<String> {
        match self {
            Self::Nothing { .. } => Some("is the region empty, or its density 0?".into()),
            Self::TooMany { .. } => Some("a real head has 100000 to 150000 hairs; 64 nodes each are plenty".into()),
            Self::Step { length, .. } => Some(format!("make the step a small part of the length: {}", length / 50.0)),
            Self::EmptyBox { .. } => Some("every edge must be longer than 0, and finite".into()),
            Self::WrongKind { queue, .. } => Some(if *queue == "forces" {
                "natural domains go into `strands:natural { ... }`, after growing".into()
            } else {
                "directional and gather domains go into a queue for `guides:grow { ... }`".into()
            }),
            Self::Clip { strands, gigabytes, limit, .. } => {
                let fit = (*strands as f64 * limit / gigabytes / 1000.0).floor() * 1000.0;
                Some(format!("about {fit} strands would fit; fewer nodes, frames, or a lower rate help too"))
            }
            Self::Cancelled(_) | Self::Topology { .. } | Self::Value { .. } | Self::Count { .. } | Self::Strands(_) => {
                None
            }
        }
    }
}

/// Greatest number of strands in one call.
pub const MAX_STRANDS: u64 = 5_000_000;
/// Greatest number of nodes in one call.
pub const MAX_NODES: u64 = 2_000_000_000;

/// Refuses what no machine should be asked for.
pub fn check_size(strands: u64, nodes: u64) -> Result<(), GroomError> {
    // A node is a point and a stage; a strand has its root, its guide, its source and its offset.
    let gigabytes = (nodes as f64 * 13.0 + strands as f64 * 64.0) / 1e9;
    if strands > MAX_STRANDS {
        return Err(GroomError::TooMany { what: "strands", count: strands, limit: MAX_STRANDS, gigabytes });
    }
    if nodes > MAX_NODES {
        return Err(GroomError::TooMany { what: "nodes", count: nodes, limit: MAX_NODES, gigabytes });
    }
    Ok(())
}

/// Refuses numbers that are none, or outside `lo..=hi`.
pub fn check_value(what: impl Into<String>, value: f32, lo: f32, hi: f32) -> Result<(), GroomError> {
    if value >= lo && value <= hi { Ok(()) } else { Err(GroomError::Value { what: what.into(), value }) }
}

/// Refuses points with a coordinate that is none.
pub fn check_point(what: impl Into<String>, p: Vec3) -> Result<(), GroomError> {
    match p.to_array().into_iter().find(|c| !c.is_finite()) {
        Some(value) => Err(GroomError::Value { what: what.into(), value }),
        None => Ok(()),
    }
}
