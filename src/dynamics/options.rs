//! How hair moves: what a script may say about it.

use std::sync::Arc;

use super::error::{DynamicsError, check_value};
use super::force::{Field, Force, GravityOptions};
use crate::params::Direction;

crate::choices! {
    /// How far a segment is from its length.
    pub enum Lengths {
        /// (d - r) / d, with the root of the squared distance.
        Exact = "exact",
        /// (D - r^2) / (D + r^2), equation 11: without a root.
        RootFree = "root_free",
    }
}

crate::choices! {
    /// How segments are brought to their lengths.
    pub enum Solver {
        /// All segments of a strand at once.
        Chain = "chain",
        /// One after the other, each end by half.
        Pairs = "pairs",
    }
}

crate::params! {
    /// What `settle` and `simulate` both take.
    pub struct HairOptions("Strands:simulate") {
        /// What acts on the hair; the earth's gravity when left out.
        forces: Option<Vec<Arc<Force>>>;
        /// How strongly the air brakes hair: the part of its speed that it loses in a second, at first. 2 in `settle`
        /// and 3 in `simulate` when left out.
        drag: Option<f32>, unit("1/s"), range(0.0, 1000.0);
        /// How well hair keeps its shape: a strand of this length that sticks out level sags by a tenth of it under its
        /// own weight. Bare hair holds about 4 cm, with wax 10, with spray 20; 0 is limp.
        hold: f32 = 4.0, unit("cm"), range(0.0, 1000.0);
        /// True when roots keep their direction; otherwise strands hang from their roots as from a hinge.
        clamped: bool = true;
        /// True when hair keeps out of the head.
        collide: bool = true;
        /// Least distance of hair from the skin.
        margin: f32 = 0.05, unit("cm"), range(0.005, 10.0);
        /// How much hair sticks to the skin that it lies on: 0 slides freely.
        friction: f32 = 0.3, range(0.0, 10.0);
        /// How strongly hair that is crowded spreads: the acceleration where it gets thinner to a third over one
        /// `spacing`.
        repulsion: f32 = 0.0, unit("cm/s^2"), range(0.0, 100_000.0);
        /// How near hair is crowded.
        spacing: f32 = 1.0, unit("cm"), range(0.05, 100.0);
        /// Steps in a second of simulated time.
        steps: f32 = 240.0, unit("1/s"), range(24.0, 100_000.0);
        /// How often in a step segments are brought to their lengths.
        iterations: usize = 2, range(1.0, 100.0);
        /// How far a segment is from its length: with a square root, or without.
        lengths: Lengths = Lengths::Exact;
        /// How segments are brought to their lengths: all of a strand at once, or one after the other, which lets long
        /// strands stretch unless there are many `iterations`.
        solver: Solver = Solver::Chain;
        /// Another seed gives other gusts.
        seed: u64 = 0;
    }
}

impl Default for HairOptions {
    fn default() -> Self {
        Self {
            forces: None,
            drag: None,
            hold: 4.0,
            clamped: true,
            collide: true,
            margin: 0.05,
            friction: 0.3,
            repulsion: 0.0,
            spacing: 1.0,
            steps: 240.0,
            iterations: 2,
            lengths: Lengths::Exact,
            solver: Solver::Chain,
            seed: 0,
        }
    }
}

/// The earth's gravity.
pub const EARTH: f32 = 981.0;

impl HairOptions {
    /// The forces, gravity when none were named.
    pub fn acting(&self) -> Vec<Arc<Force>> {
        self.forces.clone().unwrap_or_else(|| {
            let down = GravityOptions { strength: EARTH, direction: Direction(glam::Vec3::NEG_Y) };
            vec![Arc::new(Force::from(Field::Gravity(down)))]
        })
    }

    /// Bending stiffness over mass per length, cm^4/s^2: a beam of length L that is held level at one end sags by
    /// g L^4 / 8B at the other.
    pub fn stiffness(&self) -> f32 {
        EARTH * self.hold * self.hold * self.hold / 0.8
    }

    /// Checks every number by itself; [`super::settle`] and [`super::simulate`] check them against each other.
    ///
    /// # Errors
    /// A number that is none or out of range.
    pub fn check(&self) -> Result<(), DynamicsError> {
        check_value("the drag", self.drag.unwrap_or(0.0), 0.0, 1000.0)?;
        check_value("the hold", self.hold, 0.0, 1000.0)?;
        check_value("the margin", self.margin, 0.005, 10.0)?;
        check_value("the friction", self.friction, 0.0, 10.0)?;
        check_value("the repulsion", self.repulsion, 0.0, 100_000.0)?;
        check_value("the spacing", self.spacing, 0.05, 100.0)?;
        check_value("the number of steps per second", self.steps, 1.0, 1e6)?;
        check_value("the number of iterations", self.iterations as f32, 0.0, 1000.0)?;
        self.acting().iter().enumerate().try_for_each(|(i, f)| f.check(i))
    }
}
