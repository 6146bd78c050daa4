//! Stylised hair as closed meshes: tufts along strokes, the fill between them, caps, buns and rings.
//!
//! A [`Tuft`] is a [`Stroke`] (its centre line) and a [`Section`] (its thickness and shape along the way); [`Tufts`] are
//! many of them, and the mesh is made when asked. [`fill()`] puts more tufts between given ones, [`cap`] covers the scalp,
//! [`dip`] finds where a tuft runs through the head. The head is seen as a [`Ground`] only: its solid, its reference
//! point and its size. `docs/methods/tufts.md` has the method, its sources and every departure.

pub mod bun;
pub mod cap;
pub mod detail;
pub mod dip;
mod error;
pub mod fill;
mod ground;
mod options;
pub mod section;
mod simplify;
mod skin;
pub mod stroke;
mod sweep;
mod tufts;

#[cfg(test)]
mod tests;

pub use bun::{BunOptions, RingOptions, RingShape};
pub use cap::CapOptions;
pub use detail::{Detail, Reduction, reduce};
pub use dip::{Dip, DipOptions, Lifted, dips, lift};
pub use error::TuftError;
pub use fill::{FillOptions, fill};
pub use ground::{Ground, azimuth_elevation, toward};
pub use options::{Ellipse, TuftOptions};
pub use section::{Profile, ProfilePoint, Section, Split};
pub use stroke::Stroke;
pub use tufts::{Island, Tuft, TuftMesh, Tufts, TuftsError};
