//! Garments: a small library of classed pieces, made from a few measures, and any mesh with named parts and tapes.
//!
//! A piece is a loft: super-elliptic sections whose tape girth is exactly the measure asked for, one above the other,
//! with folds where cloth falls freely. Armholes and the fork of trousers are part of one grid, so that sleeves and
//! legs are sewn on without a gap. Everything stands in head space: a piece fits below the built-in head.

mod clear;
mod figure;
mod form;
mod loft;
mod ribbon;
mod skirt;
mod top;
mod trousers;

#[cfg(test)]
mod tests;

use crate::geometry::slice::Side;
use crate::geometry::{Group, Mesh};

pub use clear::{Cleared, clear, clear_all};
pub use form::FormOptions;
pub use ribbon::ribbon;
pub use skirt::SkirtOptions;
pub use top::{DressOptions, ShirtOptions};
pub use trousers::TrousersOptions;

/// Where a girth of a garment is measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Tape {
    /// `bust`, `waist`, `hip`, or any name.
    pub name: String,
    /// Height, cm.
    pub height: f32,
    /// Which outline.
    pub side: Side,
    /// Names of the parts that it goes around; empty for everything.
    pub parts: Vec<String>,
}

/// A garment: a surface in named parts, and tapes around it.
#[derive(Clone, Debug, PartialEq)]
pub struct Garment {
    /// What it is: `skirt`, `shirt`, or the name of its file.
    pub kind: String,
    /// The surface; its groups are the parts.
    pub mesh: Mesh,
    /// Where it is measured.
    pub tapes: Vec<Tape>,
}

impl Garment {
    /// A mesh without tapes.
    pub fn new(kind: &str, mesh: Mesh) -> Self {
        Self { kind: kind.to_owned(), mesh, tapes: vec![] }
    }

    /// The names of its parts.
    pub fn parts(&self) -> Vec<&str> {
        self.mesh.groups.iter().map(|g| g.name.as_str()).collect()
    }

    /// The tape of that name.
    pub fn tape(&self, name: &str) -> Option<&Tape> {
        self.tapes.iter().find(|t| t.name == name)
    }

    /// The triangles of the parts that a tape goes around, ascending; none means all.
    pub fn triangles(&self, parts: &[String]) -> Vec<u32> {
        let mut all: Vec<u32> =
            self.mesh.groups.iter().filter(|g| parts.contains(&g.name)).flat_map(|g| g.triangles.clone()).collect();
        all.sort_unstable();
        all.dedup();
        all
    }

    /// With a tape more; one of the same name goes.
    #[must_use]
    pub fn with_tape(mut self, tape: Tape) -> Self {
        self.tapes.retain(|t| t.name != tape.name);
        self.tapes.push(tape);
        self
    }

    /// With its triangles in bands of heights: `(name, from, to)`, a triangle belongs where its middle is. Parts of the
    /// same names go, others stay.
    #[must_use]
    pub fn split(mut self, bands: &[(String, f32, f32)]) -> Self {
        self.mesh.groups.retain(|g| !bands.iter().any(|b| b.0 == g.name));
        for (name, low, high) in bands {
            let inside = |t: &u32| {
                let y = self.mesh.corners(*t as usize).iter().map(|p| p.y).sum::<f32>() / 3.0;
                (*low..*high).contains(&y)
            };
            let triangles: Vec<u32> = (0..self.mesh.triangles.len() as u32).filter(inside).collect();
            self.mesh.groups.push(Group { name: name.clone(), triangles });
        }
        self
    }

    /// For every tape the band of heights in which the surface may move for it: up to the next tape above and below that
    /// goes around the same parts, at most `reach` away.
    pub fn reach(&self, tape: &Tape, reach: f32) -> (f32, f32) {
        let others = self.tapes.iter().filter(|t| t.parts == tape.parts && t.height != tape.height);
        let (mut low, mut high) = (tape.height - reach, tape.height + reach);
        for other in others {
            if other.height < tape.height {
                low = low.max(other.height);
            } else {
                high = high.min(other.height);
            }
        }
        (low, high)
    }
}
