//! Hair by layered multistage constraint domains (Han, Li, Geng, Liu, Shang 2012).
//!
//! [`grow`] grows guides step by step through the domains of [`Queue`]s, [`deform`] lays waves and curls over them, and
//! [`fill`] grows the members between them. All three are pure functions over geometry values; none lets a strand into
//! the head. Their parameters are described once, in the structs that a script fills.
//!
//! The words are those of `docs/glossary.md`; the equations are numbered as in the paper.

mod domain;
mod error;
mod fill;
mod grow;
mod guides;
mod layout;
mod moving;
mod natural;
mod neighbours;
mod noise;
mod queue;
mod region;

#[cfg(test)]
mod tests;

pub use crate::geometry::clear::{count_inside, is_inside, keep_out};
pub use crate::geometry::slide::Body;
pub use domain::{Curl, Directional, Domain, Gather, Measure, NaturalOptions, Turn, Wave};
pub use error::GroomError;
pub use fill::{Fill, FillOptions, Separated, fill, member_nodes};
pub use grow::{Grow, GrowOptions, LocalOptions, grow};
pub use guides::{GuideOptions, Guides};
pub use moving::{Moving, deform_clip, fill_clip, pass_through};
pub use natural::{Deform, DeformOptions, Natural, NaturalQueue, Shape, deform, deformed_points, fade, ramp, scale};
pub use queue::{Queue, QueueOptions, Stage, Walk};
pub use region::BoxOptions;
