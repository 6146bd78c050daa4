//! Locks that move: MeshIK over posed examples (Sumner, Zwicker, Gotsman, Popovic 2005), handles and their paths (Ren, Zhao,
//! Geng 2010).
//!
//! A [`Rig`] is a mesh in several states with its held vertices and handles: the features of the states and the factored
//! system, made once. A [`Poser`] finds one frame after the other; [`animate`] goes along whole paths, and [`animate_all`]
//! does so for many locks at once. [`PathOptions`] says where a handle is in every frame; [`carried`] puts the lock on a head
//! that moves. `docs/methods/animate.md` has the method, its sources and every departure.

mod cholesky;
mod clip;
mod error;
mod feature;
mod follow;
mod order;
mod path;
mod pose;
mod rig;
mod rotation;
mod shape;

#[cfg(test)]
mod tests;

pub use clip::{Animation, animate, animate_all};
pub use error::AnimateError;
pub use feature::MOST_STATES;
pub use follow::carried;
pub use path::{PathCurve, PathOptions};
pub use pose::{Posed, Poser, TOLERANCE};
pub use rig::Rig;
