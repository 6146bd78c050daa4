//! What can be wrong with states, handles and paths.

use glam::Vec3;

use crate::geometry::MeshError;
use crate::task::Cancelled;

/// Why a lock cannot be animated. States are counted from 1, the rest is state 1; vertices, triangles and frames are
/// counted from 1 too, handles in the order given.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum AnimateError {
    /// Nothing to blend with.
    #[error("there is no state besides the rest")]
    NoStates,
    /// More states than the blend takes.
    #[error("`{count}` states besides the rest, it takes at most {limit}")]
    TooManyStates {
        /// How many there are.
        count: usize,
        /// How many there may be.
        limit: usize,
    },
    /// The rest is no proper mesh.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// A state with another number of vertices.
    #[error("state {state} has {count} vertices, the rest has {rest}")]
    VertexCount {
        /// Which state.
        state: usize,
        /// Its number of vertices.
        count: usize,
        /// That of the rest.
        rest: usize,
    },
    /// A state whose triangles join other vertices.
    #[error("triangle {triangle} of state {state} joins other vertices than that of the rest")]
    Topology {
        /// Which state.
        state: usize,
        /// The first triangle that differs.
        triangle: usize,
    },
    /// A coordinate of a state is NaN or infinite.
    #[error("vertex {vertex} of state {state} is not finite: `{position}`")]
    NotFinite {
        /// Which state.
        state: usize,
        /// Which vertex.
        vertex: usize,
        /// Its value.
        position: Vec3,
    },
    /// A triangle without area says nothing about how the surface is turned.
    #[error("triangle {triangle} of state {state} has no area; it lies at `{position}`")]
    Degenerate {
        /// Which state.
        state: usize,
        /// Which triangle.
        triangle: usize,
        /// Its first corner.
        position: Vec3,
    },
    /// A vertex that the mesh does not have, or that no triangle uses.
    #[error("{what} {vertex} belongs to no triangle; the mesh has {count} vertices")]
    NoVertex {
        /// "held vertex", "handle vertex".
        what: &'static str,
        /// Which vertex.
        vertex: usize,
        /// How many there are.
        count: usize,
    },
    /// The same vertex is held and handled.
    #[error("vertex {vertex} is both held and moved by handle {handle}")]
    HeldHandle {
        /// Which vertex.
        vertex: usize,
        /// Which handle.
        handle: usize,
    },
    /// Two handles move the same vertex.
    #[error("handles {first} and {second} both move vertex {vertex}")]
    RepeatedHandle {
        /// One of them.
        first: usize,
        /// The other.
        second: usize,
        /// Which vertex.
        vertex: usize,
    },
    /// A piece of the mesh that could be anywhere.
    #[error("a piece of {count} vertices with vertex {vertex}, at `{position}`, is neither held nor handled")]
    Loose {
        /// How many vertices hang together there.
        count: usize,
        /// One of them.
        vertex: usize,
        /// Where it is.
        position: Vec3,
    },
    /// A mesh so uneven that the system cannot be solved.
    #[error("the mesh is too uneven to be solved near vertex {vertex}, at `{position}`")]
    Uneven {
        /// Where the elimination failed.
        vertex: usize,
        /// Where that is.
        position: Vec3,
    },
    /// No frames.
    #[error("an animation of no frames")]
    NoFrames,
    /// The paths of several handles differ in length.
    #[error("the path of handle {handle} has {count} frames, that of handle 1 has {first}")]
    PathFrames {
        /// Which handle.
        handle: usize,
        /// Its number of frames.
        count: usize,
        /// That of the first.
        first: usize,
    },
    /// Not one path per handle.
    #[error("{paths} paths for {handles} handles")]
    PathCount {
        /// How many paths.
        paths: usize,
        /// How many handles.
        handles: usize,
    },
    /// A place on a path is NaN or infinite.
    #[error("handle {handle} is to be at `{position}` in frame {frame}")]
    Target {
        /// Which handle.
        handle: usize,
        /// Which frame.
        frame: usize,
        /// Where.
        position: Vec3,
    },
    /// The iterations did not come to rest.
    #[error("frame {frame} did not come to rest: after {iterations} iterations the surface still moves by `{step}` cm")]
    NotConverged {
        /// Which frame.
        frame: usize,
        /// How many iterations were made.
        iterations: u32,
        /// Greatest movement of a vertex in the last, cm.
        step: f32,
    },
    /// A path with too few points.
    #[error("a path needs at least {least} points, got {count}")]
    PathPoints {
        /// The fewest that make one.
        least: usize,
        /// How many there are.
        count: usize,
    },
    /// A point of a path is NaN or infinite.
    #[error("point {number} of the path is not finite: `{point}`")]
    PathPoint {
        /// Counted from 1.
        number: usize,
        /// Its value.
        point: Vec3,
    },
    /// Not one time per point.
    #[error("{times} times for {points} points")]
    TimeCount {
        /// How many times.
        times: usize,
        /// How many there should be.
        points: usize,
    },
    /// Times that do not rise.
    #[error("time {number} is `{time}`, after `{before}`: times must rise")]
    TimeOrder {
        /// Counted from 1.
        number: usize,
        /// Its value.
        time: f32,
        /// The one before it.
        before: f32,
    },
    /// A number outside its range.
    #[error("{what} is `{value}`, it takes {lo} to {hi}")]
    OutOfRange {
        /// The parameter.
        what: &'static str,
        /// Its value.
        value: f32,
        /// Least value allowed.
        lo: f32,
        /// Greatest value allowed.
        hi: f32,
    },
    /// Stopped from outside.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl AnimateError {
    /// What to do about it.
    pub fn hint(&self) -> Option<String> {
        let text = match self {
            Self::NoStates => "pose the lock at least once more, as in `states = { rest, left, right }`",
            Self::TooManyStates { .. } => "animate in two parts, or leave out states that lie between others",
            Self::VertexCount { .. } | Self::Topology { .. } => {
                "states must be the same mesh, posed: for tufts the same `rings`, `sides`, `tips` and kind of ends"
            }
            Self::Degenerate { .. } => "move its corners apart, or merge them into one place in every state",
            Self::HeldHandle { .. } => "hold fewer vertices, or put the handle elsewhere",
            Self::RepeatedHandle { .. } => "one vertex can follow one path only: leave one of them out",
            Self::Loose { .. } => "hold a vertex of it, or give it a handle",
            Self::Uneven { .. } => "make the triangles there more even",
            Self::PathFrames { .. } => "give all paths the same `frames`",
            Self::NotConverged { .. } => {
                "let the path pass nearer to where the states have the handle, or add a state posed there"
            }
            Self::TimeOrder { .. } => "a point that is to be waited at is given twice, with two times",
            _ => return None,
        };
        Some(text.to_owned())
    }

    /// `value`, if it lies within `lo..=hi`.
    pub(super) fn check(what: &'static str, value: f32, lo: f32, hi: f32) -> Result<f32, Self> {
        // Written so that NaN is refused too.
        if value >= lo && value <= hi { Ok(value) } else { Err(Self::OutOfRange { what, value, lo, hi }) }
    }
}
