//! Pins: fixed points and operated points (Liu, Liu 2011, section 1.2).
//!
//! For one operated point P that goes to P', every fixed point O alone turns and scales space about itself so that OP
//! becomes OP'; that moves a place by dq. The motion is the mean of all dq, weighted by the affinity of the place to the
//! fixed points: the inverse distance to some power, normalised. So a fixed point never moves, and P lands on P'.
//!
//! The paper has one operated point. With several, each alone gives such a motion; their mean, weighted by the affinity
//! to the operated points, goes through every target and keeps every fixed point, and is the paper's for one.

use glam::{DMat3, DQuat, DVec3, Vec3};
use rayon::prelude::*;

use super::kernel::{self, Pinned};
use super::{DeformError, PointKind, check_power};
use crate::math::Digest;
use crate::task::Task;

/// Points closer together than this are one and the same, cm.
const SAME: f32 = 1e-5;
/// Points that are moved between two looks at the task.
const PIECE: usize = 8192;

/// A control point in space.
#[derive(Clone, Debug, PartialEq)]
pub struct Pin {
    /// Its name, if it has one.
    pub name: Option<String>,
    /// Where it is.
    pub at: Vec3,
    /// Where it goes; an operated point has a target, others have none.
    pub to: Option<Vec3>,
    /// What it is for: a fixed one holds, the others go to their target or ride along.
    pub kind: PointKind,
}

impl Pin {
    /// A point that stays.
    pub fn fixed(at: Vec3) -> Self {
        Self { name: None, at, to: None, kind: PointKind::Fixed }
    }

    /// A point that is moved.
    pub fn operated(at: Vec3, to: Vec3) -> Self {
        Self { name: None, at, to: Some(to), kind: PointKind::Feature }
    }

    fn called(&self, number: usize) -> String {
        self.name.as_ref().map_or_else(|| format!("point {}", number + 1), |n| format!("point `{n}`"))
    }
}

/// Fixed and operated points.
#[derive(Clone, Debug, PartialEq)]
pub struct Pins {
    points: Vec<Pin>,
    power: f32,
}

impl Pins {
    /// From fixed points and operated points with their targets; `power` is the exponent of the affinity, 0.5 to 8.
    ///
    /// # Errors
    /// As [`Pins::of`].
    pub fn new(fixed: &[Vec3], operated: &[(Vec3, Vec3)], power: f32) -> Result<Self, DeformError> {
        let fixed = fixed.iter().map(|&at| Pin::fixed(at));
        let operated = operated.iter().map(|&(at, to)| Pin::operated(at, to));
        Self::of(fixed.chain(operated).collect(), power)
    }

    /// From points of all kinds. A fixed point's target does not count; a point of another kind without a target rides
    /// along.
    ///
    /// # Errors
    /// No fixed point; two that act at one place; a target on a fixed point; numbers that are not finite or out of
    /// range.
    pub fn of(points: Vec<Pin>, power: f32) -> Result<Self, DeformError> {
        check_power(power)?;
        for (i, pin) in points.iter().enumerate() {
            for value in [Some(pin.at), pin.to].into_iter().flatten() {
                if !value.is_finite() {
                    return Err(DeformError::NotFinite { what: pin.called(i), value });
                }
            }
        }
        let pins = Self { points, power };
        if pins.fixed().next().is_none() {
            return Err(DeformError::Nothing { what: "fixed points" });
        }
        let acting: Vec<(usize, &Pin)> =
            pins.points.iter().enumerate().filter(|(_, p)| p.kind == PointKind::Fixed || p.to.is_some()).collect();
        for (n, &(i, a)) in acting.iter().enumerate() {
            for &(k, b) in &acting[..n] {
                if a.at.distance(b.at) < SAME {
                    return Err(DeformError::SamePlace { first: b.called(k), second: a.called(i), place: a.at });
                }
            }
        }
        for (i, p) in pins.points.iter().enumerate().filter(|(_, p)| p.kind != PointKind::Fixed) {
            let Some(to) = p.to else { continue };
            if let Some(&(k, o)) = acting.iter().find(|(_, o)| o.kind == PointKind::Fixed && o.at.distance(to) < SAME) {
                return Err(DeformError::OntoFixed { operated: p.called(i), fixed: o.called(k) });
            }
        }
        Ok(pins)
    }

    /// All points, in the order they were given.
    pub fn points(&self) -> &[Pin] {
        &self.points
    }

    /// The exponent of the affinity.
    pub fn power(&self) -> f32 {
        self.power
    }

    fn fixed(&self) -> impl Iterator<Item = Vec3> {
        self.points.iter().filter(|p| p.kind == PointKind::Fixed).map(|p| p.at)
    }

    fn operated(&self) -> impl Iterator<Item = (Vec3, Vec3)> {
        self.points.iter().filter(|p| p.kind != PointKind::Fixed).filter_map(|p| Some((p.at, p.to?)))
    }

    /// The next step: every point stands where this step leaves it, and none has a target yet.
    #[must_use]
    pub fn settled(&self) -> Self {
        let settle = |p: &Pin| Pin { at: self.at(p.at), to: None, ..p.clone() };
        Self { points: self.points.iter().map(settle).collect(), power: self.power }
    }

    /// With another kind and target for the point of that name.
    ///
    /// # Errors
    /// A name that no point has, and as [`Pins::of`].
    pub fn marked(&self, name: &str, kind: PointKind, to: Option<Vec3>) -> Result<Self, DeformError> {
        let mut points = self.points.clone();
        let Some(pin) = points.iter_mut().find(|p| p.name.as_deref() == Some(name)) else {
            let known = self.points.iter().filter_map(|p| p.name.clone()).collect();
            return Err(DeformError::Unknown { what: "point", name: name.to_owned(), known });
        };
        (pin.kind, pin.to) = (kind, to);
        Self::of(points, self.power)
    }

    /// Where one place goes.
    pub fn at(&self, p: Vec3) -> Vec3 {
        let mut out = [p];
        let _ = self.apply(&[p], &mut out, &Task::new());
        out[0]
    }

    /// Moves `points` to `out`, of the same length.
    ///
    /// # Errors
    /// Cancelling.
    pub fn apply(&self, points: &[Vec3], out: &mut [Vec3], task: &Task) -> Result<(), DeformError> {
        let (fixed, operated): (Vec<Vec3>, Vec<_>) = (self.fixed().collect(), self.operated().collect());
        if operated.iter().all(|(p, to)| p == to) {
            out.copy_from_slice(points);
            return Ok(());
        }
        let turns = operated.iter().flat_map(|&(p, to)| fixed.iter().map(move |&o| turn(o, p, to))).collect();
        let pinned = Pinned { fixed, operated, turns, power: self.power };
        points.par_chunks(PIECE).zip(out.par_chunks_mut(PIECE)).try_for_each(|(from, to)| {
            task.check()?;
            kernel::pins(&pinned, from, to);
            Ok(())
        })
    }

    /// Feeds all of it to a key that has a say in where points go.
    pub fn digest(&self, into: &mut Digest) {
        let (fixed, operated): (Vec<Vec3>, Vec<_>) = (self.fixed().collect(), self.operated().collect());
        let (from, to): (Vec<Vec3>, Vec<Vec3>) = operated.into_iter().unzip();
        into.bytes(b"pins 1").vectors(&fixed).vectors(&from).vectors(&to).floats(&[self.power]);
    }
}

/// Rows of the turn and scale about `o` that take `p` to `to`, less the identity.
fn turn(o: Vec3, p: Vec3, to: Vec3) -> [Vec3; 3] {
    let (a, b) = ((p - o).as_dvec3(), (to - o).as_dvec3());
    let (la, lb) = (a.length(), b.length());
    let (ua, ub) = (a / la, b / lb);
    let rotation = if ua.dot(ub) < -1.0 + 1e-9 {
        // Half a turn may go about any axis across. This one is the same in a mirrored world.
        let other = if ua.y.abs() < 0.9 { DVec3::Y } else { DVec3::Z };
        DQuat::from_axis_angle(ua.cross(other).normalize(), std::f64::consts::PI)
    } else {
        DQuat::from_rotation_arc(ua, ub)
    };
    let less = DMat3::from_quat(rotation) * (lb / la) - DMat3::IDENTITY;
    [0, 1, 2].map(|k| less.row(k).as_vec3())
}
