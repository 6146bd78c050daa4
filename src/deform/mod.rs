//! Free-form deformation with fixed points (Liu, Liu 2011): lattices, cages, pins, girths; for any points whatever.
//!
//! A [`Deformer`] says where every place in space goes: a [`Lattice`], a [`Cage`] of scattered control points,
//! [`Pins`], or a [`Warp`] fitted to pairs of places. What it is applied to is plain points; [`mesh`] and [`strands`] see to normals,
//! seams and roots. [`fit`] finds the control motion that gives a garment a wanted girth.
//!
//! `docs/methods/deform.md` has the method, its sources and every departure; equations are numbered as in the paper.

mod apply;
mod cage;
mod controls;
mod dense;
mod error;
mod fit;
mod kernel;
mod lattice;
mod mean;
mod pins;
mod shell;
mod verbs;
mod warp;

#[cfg(test)]
mod cage_tests;
#[cfg(test)]
mod tests;

pub use apply::{Deformer, Hold, all, mesh, points, strands};
pub use cage::Cage;
pub use error::DeformError;
pub use fit::{Band, FitOptions, Fitted, Measure, Target, fit, outline};
pub use lattice::{Lattice, MOST_DIVISIONS, Move, Selection};
pub use pins::{Pin, Pins};
pub use shell::{MOST_CAGE_DIVISIONS, MOST_POINTS};
pub use verbs::{Bend, Lift, Taper};
pub use warp::Warp;

crate::choices! {
    /// What a control point is for. It may change from step to step.
    pub enum PointKind {
        /// One of many that are spread evenly: takes part in what moves everything.
        Overall = "overall",
        /// Moved for a wanted effect.
        Feature = "feature",
        /// Stays where it is, and holds what is near it.
        Fixed = "fixed",
    }
}

/// Where moved control points turn space inside out.
#[derive(Clone, Debug, PartialEq)]
pub struct Folded {
    /// The control points next to it.
    pub points: Vec<String>,
    /// Where it was before, cm.
    pub place: glam::Vec3,
}

/// The least and the greatest exponent of an affinity.
pub const POWERS: (f32, f32) = (0.5, 8.0);

/// Refuses exponents of an affinity that give no smooth motion.
fn check_power(power: f32) -> Result<(), DeformError> {
    let (low, high) = POWERS;
    if (low..=high).contains(&power) {
        return Ok(());
    }
    let (value, low, high) = (f64::from(power), f64::from(low), f64::from(high));
    Err(DeformError::OutOfRange { what: "the exponent".into(), value, low, high })
}
