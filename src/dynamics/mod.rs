//! Force-field dynamics of strands (Song, Wu 2012): chains of particles that fall, blow and come to rest.
//!
//! [`settle`] moves strands under [`Force`]s until they are at rest and gives strands back, which any other stage may
//! take; [`simulate`] keeps every frame and gives a clip. Both are pure functions over geometry values; neither lets a
//! strand into the head. The equations are numbered as in the paper; `docs/methods/dynamics.md` tells of every departure
//! from it.

// Loops over the lanes index several rows at once; comparisons are negated so that NaN is refused.
#![allow(clippy::needless_range_loop, clippy::neg_cmp_op_on_partial_ord)]

mod acting;
mod bend;
mod error;
mod finish;
mod force;
mod gust;
mod lanes;
mod length;
mod options;
mod packet;
mod pose;
mod repel;
mod run;
mod skin;
mod step;
mod world;

#[cfg(test)]
mod tests;

pub use error::DynamicsError;
pub use force::{
    AttractorOptions, FallOff, Field, Force, GravityOptions, REFERENCE, RepellerOptions, VortexOptions, WindOptions,
    Zone,
};
pub use options::{EARTH, HairOptions, Lengths, Solver};
pub use pose::Poses;
pub use run::{SettleOptions, Settled, SimulateOptions, settle, simulate};
pub use skin::Skin;
pub use world::{Body, Hair, Plan, World};
