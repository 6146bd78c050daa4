//! Force objects: where they act, how strong, and when.
//!
//! Strengths are accelerations in cm/s^2, as the earth's 981, so that all of them compare; those that depend on the
//! distance are given at [`REFERENCE`] from the centre.

use std::sync::Arc;

use glam::{Affine3A, Vec3};

use super::error::{DynamicsError, check_value};
use crate::geometry::OrientedBox;
use crate::params::{Direction, Object};

/// The distance at which the strength of a point force is given, cm.
pub const REFERENCE: f32 = 10.0;

crate::choices! {
    /// How a force changes with the distance from its centre.
    pub enum FallOff {
        /// Equally strong everywhere.
        Constant = "constant",
        /// In proportion to the distance.
        Proportional = "proportional",
        /// In inverse proportion to the distance.
        Inverse = "inverse",
    }
}

crate::params! {
    /// A constant acceleration: gravity.
    pub struct GravityOptions("coif.force.gravity") {
        /// Acceleration.
        strength: f32 = 981.0, unit("cm/s^2"), range(0.0, 1_000_000.0);
        /// Where to.
        direction: Direction = Direction(Vec3::NEG_Y);
    }
}

crate::params! {
    /// Wind: an acceleration in one direction, which may come in gusts. Gusts travel with the wind; in `settle` it blows
    /// evenly.
    pub struct WindOptions("coif.force.wind") {
        /// Where to it blows.
        direction: Direction;
        /// Mean acceleration.
        strength: f32 = 500.0, unit("cm/s^2"), range(0.0, 1_000_000.0);
        /// How much gusts add and take, as a part of the strength: 0 blows evenly, 1 from calm to twice the strength.
        gust: f32 = 0.0, range(0.0, 3.0);
        /// Mean time from gust to gust.
        period: f32 = 1.0, unit("s"), range(0.05, 100.0);
        /// How fast gusts travel.
        speed: f32 = 200.0, unit("cm/s"), range(1.0, 100_000.0);
        /// Another seed gives other gusts.
        seed: u64 = 0;
    }
}

crate::params! {
    /// An attractor: hair farther than `radius` from the centre is drawn to it, the more the farther. It ties bundles.
    pub struct AttractorOptions("coif.force.attractor") {
        /// The point it draws to.
        centre: Vec3, unit("cm");
        /// Within this distance it does not act.
        radius: f32 = 1.0, unit("cm"), range(0.0, 1000.0);
        /// The way outside of `radius` over which it comes to its full strength.
        rim: f32 = 0.5, unit("cm"), range(0.0, 1000.0);
        /// Acceleration at 10 cm from the centre.
        strength: f32 = 1000.0, unit("cm/s^2"), range(0.0, 1_000_000.0);
        /// How it changes with the distance.
        fall_off: FallOff = FallOff::Proportional;
    }
}

crate::params! {
    /// A repeller: hair is driven away from the centre, the less the farther. It keeps bundles fluffy.
    pub struct RepellerOptions("coif.force.repeller") {
        /// The point it drives away from.
        centre: Vec3, unit("cm");
        /// Within this distance it weakens towards the centre, where it has no direction.
        core: f32 = 1.0, unit("cm"), range(0.01, 1000.0);
        /// Acceleration at 10 cm from the centre.
        strength: f32 = 1000.0, unit("cm/s^2"), range(0.0, 1_000_000.0);
        /// How it changes with the distance.
        fall_off: FallOff = FallOff::Inverse;
    }
}

crate::params! {
    /// A vortex: hair is swept around an axis. With an attractor on the axis it makes big curls.
    pub struct VortexOptions("coif.force.vortex") {
        /// A point on the axis.
        centre: Vec3, unit("cm");
        /// The axis; seen against its direction it turns anticlockwise.
        axis: Direction = Direction(Vec3::Y);
        /// Within this distance from the axis it weakens towards it.
        core: f32 = 1.0, unit("cm"), range(0.01, 1000.0);
        /// Acceleration at 10 cm from the axis.
        strength: f32 = 1000.0, unit("cm/s^2"), range(0.0, 1_000_000.0);
        /// How it changes with the distance from the axis.
        fall_off: FallOff = FallOff::Inverse;
    }
}

/// What a force does.
#[derive(Clone, Debug)]
pub enum Field {
    /// The same everywhere.
    Gravity(GravityOptions),
    /// The same everywhere but for gusts.
    Wind(WindOptions),
    /// Towards a point.
    Attractor(AttractorOptions),
    /// Away from a point.
    Repeller(RepellerOptions),
    /// Around an axis.
    Vortex(VortexOptions),
}

/// A part of space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Zone {
    /// A box.
    Box(OrientedBox),
    /// A ball.
    Ball {
        /// Its middle, cm.
        centre: Vec3,
        /// Its radius, cm, above 0.
        radius: f32,
    },
}

impl Zone {
    /// True for a point inside or on the border.
    pub fn contains(&self, p: Vec3) -> bool {
        match self {
            Self::Box(b) => b.contains(p),
            Self::Ball { centre, radius } => p.distance_squared(*centre) <= radius * radius,
        }
    }

    /// The zone moved by a turn and a shift.
    #[must_use]
    pub fn moved(&self, by: &Affine3A) -> Self {
        match *self {
            Self::Box(b) => Self::Box(OrientedBox {
                centre: by.transform_point3(b.centre),
                axes: glam::Mat3::from(by.matrix3) * b.axes,
                half: b.half,
            }),
            Self::Ball { centre, radius } => Self::Ball { centre: by.transform_point3(centre), radius },
        }
    }
}

/// A force object.
#[derive(Clone, Debug)]
pub struct Force {
    /// What it does.
    pub field: Field,
    /// Where it acts; everywhere without.
    pub zone: Option<Zone>,
    /// The way inside the zone's border over which it fades out, cm; 0 ends at the border.
    pub edge: f32,
    /// Factors on the strength at times in seconds, in their order, linear between and the same before the first and
    /// after the last; 1 when empty. [`super::settle`] takes no notice of it.
    pub over_time: Arc<[(f32, f32)]>,
    /// True when it moves with the head.
    pub follows: bool,
    /// What messages call it.
    pub name: Option<String>,
}

impl Object for Force {
    const NAME: &'static str = "Force";
}

impl From<Field> for Force {
    /// A force that acts everywhere and always, and stays where it is.
    fn from(field: Field) -> Self {
        Self { field, zone: None, edge: 0.0, over_time: Arc::new([]), follows: false, name: None }
    }
}

impl Force {
    /// What kind it is: "attractor".
    pub fn kind(&self) -> &'static str {
        match self.field {
            Field::Gravity(_) => "gravity",
            Field::Wind(_) => "wind",
            Field::Attractor(_) => "attractor",
            Field::Repeller(_) => "repeller",
            Field::Vortex(_) => "vortex",
        }
    }

    /// For messages: "the attractor `tie`", or "the attractor (force 2)" by its place.
    pub fn label(&self, index: usize) -> String {
        match &self.name {
            Some(name) => format!("the {} `{name}`", self.kind()),
            None => format!("the {} (force {})", self.kind(), index + 1),
        }
    }

    /// Its strength, cm/s^2.
    pub fn strength(&self) -> f32 {
        match &self.field {
            Field::Gravity(o) => o.strength,
            Field::Wind(o) => o.strength,
            Field::Attractor(o) => o.strength,
            Field::Repeller(o) => o.strength,
            Field::Vortex(o) => o.strength,
        }
    }

    /// The factor on its strength at a time, s.
    pub fn factor(&self, time: f32) -> f32 {
        let next = self.over_time.partition_point(|&(t, _)| t <= time);
        match (next.checked_sub(1).map(|i| self.over_time[i]), self.over_time.get(next)) {
            (Some((t0, f0)), Some(&(t1, f1))) => f0 + (f1 - f0) * (time - t0) / (t1 - t0),
            (Some((_, f)), None) | (None, Some(&(_, f))) => f,
            (None, None) => 1.0,
        }
    }

    /// The greatest factor on its strength, by its size.
    fn greatest_factor(&self) -> f32 {
        let over_time = self.over_time.iter().map(|&(_, f)| f.abs()).reduce(f32::max).unwrap_or(1.0);
        let gust = if let Field::Wind(o) = &self.field { 1.0 + o.gust } else { 1.0 };
        over_time * gust
    }

    /// An upper bound on the acceleration at any place within `reach` of its centre, cm/s^2.
    pub fn greatest(&self, reach: f32) -> f32 {
        let with = |fall_off: FallOff, near: f32| match fall_off {
            FallOff::Constant => 1.0,
            FallOff::Proportional => reach / REFERENCE,
            // The greatest of r / (r^2 + c^2) is 1 / 2c, at r = c.
            FallOff::Inverse => REFERENCE / near,
        };
        let by_place = match &self.field {
            Field::Gravity(_) | Field::Wind(_) => 1.0,
            Field::Attractor(o) => with(o.fall_off, o.radius.max(0.5)),
            Field::Repeller(o) => with(o.fall_off, 2.0 * o.core),
            Field::Vortex(o) => with(o.fall_off, 2.0 * o.core),
        };
        self.strength() * by_place * self.greatest_factor()
    }

    /// An upper bound on how fast the acceleration changes with the place, 1/s^2, but for jumps at borders.
    pub fn gradient(&self) -> f32 {
        let with = |fall_off: FallOff, near: f32| match fall_off {
            FallOff::Constant => 1.0 / near,
            FallOff::Proportional => 1.0 / REFERENCE,
            FallOff::Inverse => REFERENCE / (near * near),
        };
        let by_place = match &self.field {
            Field::Gravity(_) => 0.0,
            Field::Wind(o) => 6.0 / (o.speed * o.period) * o.gust / (1.0 + o.gust),
            Field::Attractor(o) => {
                let near = o.radius.max(0.5);
                let rim = if o.rim > 0.0 { with_rim(o.fall_off, o.radius, o.rim) } else { 0.0 };
                with(o.fall_off, near) + rim
            }
            Field::Repeller(o) => with(o.fall_off, o.core),
            Field::Vortex(o) => with(o.fall_off, o.core),
        };
        self.strength() * by_place * self.greatest_factor()
    }

    /// Checks what a script's reader does not see.
    ///
    /// # Errors
    /// A number that is none or out of range.
    pub fn check(&self, index: usize) -> Result<(), DynamicsError> {
        let label = self.label(index);
        let point = |what: &str, p: Vec3| {
            p.to_array().into_iter().try_for_each(|c| check_value(format!("the {what} of {label}"), c, -1e6, 1e6))
        };
        let unit =
            |what: &str, v: Vec3| check_value(format!("the length of the {what} of {label}"), v.length(), 0.99, 1.01);
        let size = |what: &str, v: f32, lo: f32| check_value(format!("the {what} of {label}"), v, lo, 1e6);
        size("strength", self.strength(), 0.0)?;
        match &self.field {
            Field::Gravity(o) => unit("direction", o.direction.0)?,
            Field::Wind(o) => {
                unit("direction", o.direction.0)?;
                size("gust", o.gust, 0.0)?;
                size("period", o.period, 0.01)?;
                size("speed", o.speed, 0.1)?;
            }
            Field::Attractor(o) => {
                point("centre", o.centre)?;
                size("radius", o.radius, 0.0)?;
                size("rim", o.rim, 0.0)?;
            }
            Field::Repeller(o) => {
                point("centre", o.centre)?;
                size("core", o.core, 0.01)?;
            }
            Field::Vortex(o) => {
                point("centre", o.centre)?;
                unit("axis", o.axis.0)?;
                size("core", o.core, 0.01)?;
            }
        }
        size("edge", self.edge, 0.0)?;
        for &(time, factor) in self.over_time.iter() {
            check_value(format!("a time of {label}"), time, -1e6, 1e6)?;
            check_value(format!("a factor of {label}"), factor, -1e3, 1e3)?;
        }
        match self.zone {
            Some(Zone::Box(b)) if !b.is_valid() => size("region's edge", b.half.min_element() * 2.0, f32::MIN_POSITIVE),
            Some(Zone::Ball { centre, radius }) => {
                point("region", centre)?;
                size("region's radius", radius, f32::MIN_POSITIVE)
            }
            _ => Ok(()),
        }
    }
}

/// How fast an attractor of strength 1 rises over its rim.
fn with_rim(fall_off: FallOff, radius: f32, rim: f32) -> f32 {
    let end = radius + rim;
    let at_end = match fall_off {
        FallOff::Constant => 1.0,
        FallOff::Proportional => end / REFERENCE,
        FallOff::Inverse => REFERENCE / end.max(0.5),
    };
    at_end / rim
}
