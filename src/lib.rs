//! Coif: hairstyles that are written.
//!
//! A hairstyle script is a pure function from parameters to a scene; a styling method is a pure function over
//! geometry values. The modules below are the floors of the house, lowest first: each may use what stands above it
//! in this list (below it in the house), never what stands beside or over it. `tests/floors.rs` checks that.
//!
//! See `docs/architecture.md` for the way of the data and `docs/glossary.md` for the words.

pub mod math;
pub mod task;

pub mod params;

pub mod geometry;

pub mod head;

pub mod animate;
pub mod deform;
pub mod dynamics;
pub mod garment;
pub mod groom;
pub mod tuft;

pub mod scene;

pub mod export;
pub mod render;

pub mod script;

pub mod workbench;

pub mod cli;
