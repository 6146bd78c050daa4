//! Pictures of a scene: orthographic views on one sheet.
//!
//! [`sheet()`] does everything; it sees only a [`Scene`](crate::scene::Scene). The way of the data: [`camera`] frames the
//! views; [`shadow`] and [`depths`] find how much light reaches each place; [`surface`] draws the head, [`toon`] draws it in
//! flat tones with ink lines, both row by row with [`scan`]; [`strands`] projects and simplifies the hair, [`veil`] leaves out what is hidden, [`raster`]
//! lays the rest down front to back by [`tiles`], [`shade`] gives it colour; [`overlay`] makes the debug view;
//! [`lettering`] writes; [`png`] codes. [`mod@contact`] lays pictures out, [`animation`] draws scenes that move frame by
//! frame, [`mod@strip`] sets some of the frames side by side, [`mod@compare`] tells how far two differ.

pub mod animation;
pub mod camera;
pub mod compare;
pub mod contact;
pub mod depths;
pub mod fast;
pub mod lettering;
pub mod overlay;
pub mod png;
pub mod raster;
pub mod scan;
pub mod shade;
pub mod shadow;
pub mod sheet;
pub mod strands;
pub mod strip;
pub mod surface;
pub mod tiles;
pub mod toon;
pub mod veil;

#[cfg(test)]
mod tests;

pub use compare::{Difference, compare};
pub use contact::{Cell, contact};
pub use png::{PngError, Speed};
pub use sheet::{Picture, RenderError, SheetOptions, sheet, views};
pub use strip::strip;
