//! Forces at one moment, ready to be added up for eight strands at a time.

use glam::{Affine3A, Mat3, Vec3};

use super::force::{FallOff, Field, Force, REFERENCE, Zone};
use super::gust::Gusts;
use super::lanes::{LANES, Lanes, each};
use crate::math::rng::Key;

/// A force whose tables are made.
#[derive(Clone, Debug)]
pub struct Prepared<'a> {
    force: &'a Force,
    gusts: Option<[Gusts; 2]>,
}

/// Forces with their tables, over a span of time.
#[derive(Clone, Debug)]
pub struct Forces<'a>(Vec<Prepared<'a>>);

impl<'a> Forces<'a> {
    /// Prepares forces for a clip of `duration` s in which hair stays within `reach` cm of the origin. In a loop the
    /// gusts come round after the whole duration.
    pub fn new(forces: &[&'a Force], duration: f32, reach: f32, seed: u64, is_loop: bool) -> Self {
        let prepared = forces.iter().enumerate().map(|(i, &force)| {
            let gusts = match &force.field {
                Field::Wind(o) if o.gust > 0.0 && duration > 0.0 => {
                    let key = Key::new(o.seed ^ seed, "gusts").with(i as u64);
                    let round = is_loop.then(|| (duration / o.period).round().max(1.0) as u64);
                    let lag = reach / (o.speed * period(o.period, duration, is_loop));
                    let make = |n| Gusts::new(key.with(n), lag, 2.0 * duration / o.period + lag + 2.0, round);
                    Some([make(0), make(1)])
                }
                _ => None,
            };
            Prepared { force, gusts }
        });
        Self(prepared.collect())
    }

    /// The forces at a time; `pose` is where the head is then. `looped` is the duration of a loop.
    pub fn at(&self, time: f32, pose: &Affine3A, looped: Option<f32>, is_settling: bool) -> Vec<Acting<'_>> {
        let phase = looped.map_or(time, |duration| time.rem_euclid(duration));
        let acting = self.0.iter().filter_map(|prepared| {
            let force = prepared.force;
            let factor = if is_settling { 1.0 } else { force.factor(phase) };
            let strength = force.strength() * factor;
            if strength == 0.0 {
                return None;
            }
            let place = |p: Vec3| if force.follows { pose.transform_point3(p) } else { p };
            let direction = |v: Vec3| if force.follows { pose.transform_vector3(v) } else { v };
            let shape = match &force.field {
                Field::Gravity(o) => Shape::Even(direction(o.direction.0) * strength),
                Field::Wind(o) => {
                    let along = direction(o.direction.0);
                    match prepared.gusts.as_ref().filter(|_| !is_settling) {
                        None => Shape::Even(along * strength),
                        Some(gusts) => {
                            let period = period(o.period, looped.unwrap_or(0.0), looped.is_some());
                            let side =
                                along.cross(if along.y.abs() < 0.9 { Vec3::Y } else { Vec3::Z }).normalize_or_zero();
                            Shape::Gusty {
                                along: along * strength,
                                across: side * (strength * o.gust * SIDEWAYS),
                                gust: o.gust,
                                lag: along / (o.speed * period),
                                now: time / period,
                                gusts,
                            }
                        }
                    }
                }
                Field::Attractor(o) => Shape::Point {
                    centre: place(o.centre),
                    strength: -strength,
                    inner: o.radius,
                    rim: 1.0 / o.rim.max(1e-3),
                    core: if o.radius > 0.0 { 0.0 } else { 0.5 },
                    fall_off: o.fall_off,
                },
                Field::Repeller(o) => Shape::Point {
                    centre: place(o.centre),
                    strength,
                    inner: -1.0,
                    rim: 1.0,
                    core: o.core,
                    fall_off: o.fall_off,
                },
                Field::Vortex(o) => Shape::Swirl {
                    centre: place(o.centre),
                    axis: direction(o.axis.0),
                    strength,
                    core: o.core,
                    fall_off: o.fall_off,
                },
            };
            let zone = force.zone.map(|z| if force.follows { z.moved(pose) } else { z });
            let zone = zone.map(|z| match z {
                Zone::Box(b) => Border::Box { centre: b.centre, inverse: b.axes.transpose(), half: b.half },
                Zone::Ball { centre, radius } => Border::Ball { centre, radius },
            });
            Some(Acting { shape, zone, fade: 1.0 / force.edge.max(1e-3) })
        });
        acting.collect()
    }
}

/// How much of a gust goes to the side.
const SIDEWAYS: f32 = 0.35;

/// The period of gusts, changed so that a loop holds a whole number of them.
fn period(period: f32, duration: f32, is_loop: bool) -> f32 {
    if is_loop { duration / (duration / period).round().max(1.0) } else { period }
}

/// A force at one moment.
#[derive(Clone, Debug)]
pub struct Acting<'a> {
    shape: Shape<'a>,
    zone: Option<Border>,
    /// One over the way that it fades out over.
    fade: f32,
}

#[derive(Clone, Debug)]
enum Shape<'a> {
    Even(Vec3),
    Gusty { along: Vec3, across: Vec3, gust: f32, lag: Vec3, now: f32, gusts: &'a [Gusts; 2] },
    Point { centre: Vec3, strength: f32, inner: f32, rim: f32, core: f32, fall_off: FallOff },
    Swirl { centre: Vec3, axis: Vec3, strength: f32, core: f32, fall_off: FallOff },
}

#[derive(Clone, Copy, Debug)]
enum Border {
    Box { centre: Vec3, inverse: Mat3, half: Vec3 },
    Ball { centre: Vec3, radius: f32 },
}

impl Acting<'_> {
    /// Adds its acceleration at eight places, cm/s^2.
    #[inline(always)]
    pub fn add(&self, at: &[Lanes; 3], out: &mut [Lanes; 3]) {
        if let (Shape::Even(a), None) = (&self.shape, &self.zone) {
            for l in 0..LANES {
                out[0][l] += a.x;
                out[1][l] += a.y;
                out[2][l] += a.z;
            }
            return;
        }
        let weight = self.zone.as_ref().map_or([1.0; LANES], |zone| inside(zone, self.fade, at));
        match &self.shape {
            Shape::Even(a) => {
                for l in 0..LANES {
                    out[0][l] += a.x * weight[l];
                    out[1][l] += a.y * weight[l];
                    out[2][l] += a.z * weight[l];
                }
            }
            Shape::Gusty { along, across, gust, lag, now, gusts } => {
                let times = each(|l| now - (at[0][l] * lag.x + at[1][l] * lag.y + at[2][l] * lag.z));
                let (main, side) = (gusts[0].at(&times), gusts[1].at(&times));
                for l in 0..LANES {
                    // A gust takes the wind away at most; it never draws.
                    let m = (1.0 + gust * main[l]).max(0.0) * weight[l];
                    let s = side[l] * weight[l];
                    out[0][l] += along.x * m + across.x * s;
                    out[1][l] += along.y * m + across.y * s;
                    out[2][l] += along.z * m + across.z * s;
                }
            }
            Shape::Point { centre, strength, inner, rim, core, fall_off } => {
                let away = from(at, *centre);
                let square = each(|l| away[0][l] * away[0][l] + away[1][l] * away[1][l] + away[2][l] * away[2][l]);
                let size = by_distance(&square, *core, *fall_off);
                let size = each(|l| {
                    let outside = ((square[l].sqrt() - inner) * rim).clamp(0.0, 1.0);
                    size[l] * strength * outside * weight[l]
                });
                for l in 0..LANES {
                    out[0][l] += away[0][l] * size[l];
                    out[1][l] += away[1][l] * size[l];
                    out[2][l] += away[2][l] * size[l];
                }
            }
            Shape::Swirl { centre, axis, strength, core, fall_off } => {
                let away = from(at, *centre);
                let along = each(|l| away[0][l] * axis.x + away[1][l] * axis.y + away[2][l] * axis.z);
                let (x, y, z) = (
                    each(|l| away[0][l] - along[l] * axis.x),
                    each(|l| away[1][l] - along[l] * axis.y),
                    each(|l| away[2][l] - along[l] * axis.z),
                );
                let square = each(|l| x[l] * x[l] + y[l] * y[l] + z[l] * z[l]);
                let size = by_distance(&square, *core, *fall_off);
                let size = each(|l| size[l] * strength * weight[l]);
                for l in 0..LANES {
                    out[0][l] += (axis.y * z[l] - axis.z * y[l]) * size[l];
                    out[1][l] += (axis.z * x[l] - axis.x * z[l]) * size[l];
                    out[2][l] += (axis.x * y[l] - axis.y * x[l]) * size[l];
                }
            }
        }
    }
}

/// The way from a centre to eight places.
#[inline(always)]
fn from(at: &[Lanes; 3], centre: Vec3) -> [Lanes; 3] {
    [each(|l| at[0][l] - centre.x), each(|l| at[1][l] - centre.y), each(|l| at[2][l] - centre.z)]
}

/// What to multiply the way from the centre with, by its squared length, for a force of strength 1 at [`REFERENCE`].
/// Within `core` it goes to zero smoothly.
#[inline(always)]
fn by_distance(square: &Lanes, core: f32, fall_off: FallOff) -> Lanes {
    let core = core * core + 1e-12;
    match fall_off {
        FallOff::Constant => each(|l| 1.0 / (square[l] + core).sqrt()),
        FallOff::Proportional => [1.0 / REFERENCE; LANES],
        FallOff::Inverse => each(|l| REFERENCE / (square[l] + core)),
    }
}

/// 1 deep inside, 0 outside, and between them over the edge.
#[inline(always)]
fn inside(zone: &Border, fade: f32, at: &[Lanes; 3]) -> Lanes {
    match zone {
        Border::Ball { centre, radius } => {
            let away = from(at, *centre);
            each(|l| {
                let square = away[0][l] * away[0][l] + away[1][l] * away[1][l] + away[2][l] * away[2][l];
                ((radius - square.sqrt()) * fade).clamp(0.0, 1.0)
            })
        }
        Border::Box { centre, inverse, half } => {
            let away = from(at, *centre);
            let m = inverse.to_cols_array_2d();
            each(|l| {
                let along = |k: usize| (m[0][k] * away[0][l] + m[1][k] * away[1][l] + m[2][k] * away[2][l]).abs();
                let depth = (half.x - along(0)).min(half.y - along(1)).min(half.z - along(2));
                (depth * fade).clamp(0.0, 1.0)
            })
        }
    }
}
