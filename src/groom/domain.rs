//! Constraint domains: what a script may ask of them.

use std::sync::Arc;

use glam::Vec3;

use super::natural::Natural;
use crate::geometry::OrientedBox;
use crate::params::{Angle, Direction, Function, Object};

crate::params! {
    /// A directional domain: inside its box hair is drawn in one direction. A strand that has been inside and leaves the
    /// box is never again acted upon; one that never comes in keeps the domain waiting.
    pub struct Directional("coif.domain.directional") {
        /// Where it acts.
        r#box: OrientedBox;
        /// Where to it draws.
        direction: Direction;
        /// Weight among the domains that act together.
        strength: f32 = 1.0, range(0.0, 1000.0);
        /// Order within the queue: higher acts first, equal priorities act together.
        priority: i32 = 0;
        /// Standard deviation of the gaussian noise on the direction, step by step.
        noise: f32 = 0.0, range(0.0, 10.0);
        /// What messages and the debug view call it.
        name: Option<String>;
    }
}

crate::params! {
    /// A gather domain: hair is drawn to a core, and let go once it is there, or once it is farther from where it was
    /// caught than the core is. The tangent t then becomes `direction + scatter * t`: a negative scatter flips the spread
    /// of a bundle through its knot.
    pub struct Gather("coif.domain.gather") {
        /// The point it draws to.
        core: Vec3, unit("cm");
        /// How near to the core counts as there.
        core_radius: f32 = 1.0, unit("cm"), range(0.0, 1000.0);
        /// Weight among the domains that act together.
        strength: f32 = 1.0, range(0.0, 1000.0);
        /// How much of the old tangent stays when it lets go; needs `direction`.
        scatter: f32 = 0.0, range(-100.0, 100.0);
        /// Where to hair leaves the core; without it the tangent stays as it is.
        direction: Option<Direction>;
        /// Order within the queue: higher acts first, equal priorities act together.
        priority: i32 = 0;
        /// Standard deviation of the gaussian noise on the direction, step by step.
        noise: f32 = 0.0, range(0.0, 10.0);
        /// What messages and the debug view call it.
        name: Option<String>;
    }
}

crate::choices! {
    /// Which way a curl turns.
    pub enum Turn {
        /// As a right-handed screw.
        Right = "right",
        /// As a left-handed screw.
        Left = "left",
        /// Right-handed on the head's left, left-handed on its right: the two sides mirror each other.
        Mirrored = "mirrored",
        /// Either, guide by guide.
        Random = "random",
    }
}

crate::choices! {
    /// What a custom curve is a function of.
    pub enum Measure {
        /// The curve runs once over each period.
        Period = "period",
        /// The curve runs once over the whole part of the strand inside the box.
        Part = "part",
        /// The curve runs once over `period` cm and keeps its last value from there on.
        Length = "length",
    }
}

crate::params! {
    /// A natural domain that waves hair in a plane.
    pub struct Wave("coif.domain.wave") {
        /// Where it acts.
        r#box: OrientedBox;
        /// Length of one wave.
        period: f32, unit("cm"), range(0.05, 1000.0);
        /// Greatest distance from the axis.
        radius: f32 = 0.4, unit("cm"), range(0.0, 100.0);
        /// Radius at the end of the part inside the box; the same as `radius` when left out.
        radius_tip: Option<f32>, unit("cm"), range(0.0, 100.0);
        /// Part of the length over which the wave rises at its start.
        smooth: f32 = 0.25, range(0.001, 0.5);
        /// Part of the length over which it falls at its end, 0 for not at all; as `smooth` when left out.
        smooth_end: Option<f32>, range(0.0, 0.5);
        /// Where in the wave it starts.
        phase: Angle = Angle::degrees(0.0), range(-360.0, 360.0);
        /// How much the phase differs from guide to guide: 0 not at all, 1 by up to a whole turn.
        phase_variation: f32 = 0.0, range(0.0, 1.0);
        /// How much the radius differs from guide to guide, as a part of it.
        radius_variation: f32 = 0.0, range(0.0, 1.0);
        /// Turns the plane of the wave about the strand: 0 waves towards the head and away from it, 90 along the head.
        tilt: Angle = Angle::degrees(0.0), range(-360.0, 360.0);
        /// Order within the queue: higher acts first.
        priority: i32 = 0;
        /// Standard deviation of gaussian noise on the displacement, as a part of the radius.
        noise: f32 = 0.0, range(0.0, 10.0);
        /// What messages and the debug view call it.
        name: Option<String>;
    }
}

crate::params! {
    /// A natural domain that curls hair into a helix; with `radius_tip` a conical one.
    pub struct Curl("coif.domain.curl") {
        /// Where it acts.
        r#box: OrientedBox;
        /// Length along the strand of one turn.
        period: f32, unit("cm"), range(0.05, 1000.0);
        /// Greatest distance from the axis.
        radius: f32 = 0.5, unit("cm"), range(0.0, 100.0);
        /// Radius at the end of the part inside the box; the same as `radius` when left out.
        radius_tip: Option<f32>, unit("cm"), range(0.0, 100.0);
        /// The helix's other radius over the first: 1 is round, 0 a plane wave.
        flatness: f32 = 1.0, range(0.0, 10.0);
        /// Which way it turns.
        turn: Turn = Turn::Right;
        /// Part of the length over which the curl rises at its start.
        smooth: f32 = 0.25, range(0.001, 0.5);
        /// Part of the length over which it falls at its end, 0 for not at all; as `smooth` when left out.
        smooth_end: Option<f32>, range(0.0, 0.5);
        /// Where in the turn it starts.
        phase: Angle = Angle::degrees(0.0), range(-360.0, 360.0);
        /// How much the phase differs from guide to guide: 0 not at all, 1 by up to a whole turn.
        phase_variation: f32 = 0.0, range(0.0, 1.0);
        /// How much the radius differs from guide to guide, as a part of it.
        radius_variation: f32 = 0.0, range(0.0, 1.0);
        /// Order within the queue: higher acts first.
        priority: i32 = 0;
        /// Standard deviation of gaussian noise on the displacement, as a part of the radius.
        noise: f32 = 0.0, range(0.0, 10.0);
        /// What messages and the debug view call it.
        name: Option<String>;
    }
}

crate::params! {
    /// A natural domain with any curve, given as a function of 0 to 1 that returns two offsets in cm: away from the head,
    /// and to the side.
    pub struct NaturalOptions("coif.domain.natural") {
        /// Where it acts.
        r#box: OrientedBox;
        /// Takes a number from 0 to 1, returns the offsets away from the head and to the side, in cm.
        curve: Function, takes("(u: number): number, number?");
        /// What the function's number runs over.
        over: Measure = Measure::Period;
        /// Length along the strand that the function runs over; not used over "part".
        period: f32 = 5.0, unit("cm"), range(0.05, 1000.0);
        /// Part of the length over which the curve rises at its start.
        smooth: f32 = 0.25, range(0.001, 0.5);
        /// Part of the length over which it falls at its end, 0 for not at all; as `smooth` when left out.
        smooth_end: Option<f32>, range(0.0, 0.5);
        /// Where in the period it starts.
        phase: Angle = Angle::degrees(0.0), range(-360.0, 360.0);
        /// How much the phase differs from guide to guide: 0 not at all, 1 by up to a whole period.
        phase_variation: f32 = 0.0, range(0.0, 1.0);
        /// How much the offsets differ from guide to guide, as a part of them.
        radius_variation: f32 = 0.0, range(0.0, 1.0);
        /// Turns the offsets about the strand.
        tilt: Angle = Angle::degrees(0.0), range(-360.0, 360.0);
        /// Order within the queue: higher acts first.
        priority: i32 = 0;
        /// Standard deviation of gaussian noise on the displacement, as a part of the offset.
        noise: f32 = 0.0, range(0.0, 10.0);
        /// What messages and the debug view call it.
        name: Option<String>;
    }
}

/// A styling constraint with a region.
#[derive(Clone, Debug)]
pub enum Domain {
    /// A box with one direction.
    Directional(Directional),
    /// A pull towards a core.
    Gather(Gather),
    /// A box with a space curve.
    Natural(Arc<Natural>),
}

impl Object for Domain {
    const NAME: &'static str = "Domain";
}

impl Domain {
    /// Order within its queue.
    pub fn priority(&self) -> i32 {
        match self {
            Self::Directional(d) => d.priority,
            Self::Gather(g) => g.priority,
            Self::Natural(n) => n.priority,
        }
    }

    /// The name that the script gave it.
    pub fn name(&self) -> Option<&str> {
        match self {
            Self::Directional(d) => d.name.as_deref(),
            Self::Gather(g) => g.name.as_deref(),
            Self::Natural(n) => n.name.as_deref(),
        }
    }

    /// What kind it is: "directional".
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Directional(_) => "directional",
            Self::Gather(_) => "gather",
            Self::Natural(_) => "natural",
        }
    }

    /// Its box; a gather domain has none.
    pub fn region(&self) -> Option<&OrientedBox> {
        match self {
            Self::Directional(d) => Some(&d.r#box),
            Self::Gather(_) => None,
            Self::Natural(n) => Some(&n.region),
        }
    }

    /// For messages: "the gather domain `knot`", or "gather domain 2 of ..." by its place.
    pub fn label(&self, index: usize) -> String {
        match self.name() {
            Some(name) => format!("the {} domain `{name}`", self.kind()),
            None => format!("the {} domain {} (in the order written)", self.kind(), index + 1),
        }
    }
}
