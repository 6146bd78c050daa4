//! Small mathematics over `glam`: the same bits on every platform.
//!
//! Geometry must not call the platform's `sin`, `exp` or `powf`, whose last bits differ between systems (a lint forbids
//! it); [`trig`] has the portable ones. Random numbers are keyed by *what they are for* ([`rng`]), never drawn from a
//! stream, so results do not depend on order or on threads.

pub mod colour;
pub mod digest;
pub mod rng;
pub mod trig;

pub use colour::Colour;
pub use digest::Digest;
