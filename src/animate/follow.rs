//! A lock on a head that moves: carried along, with its handle lagging behind.
//!
//! The lock is posed as the head sees it and then carried along, so its root stays on the skin. The handle is pulled
//! after the place where the moving head would have it, by a damped spring in space: `q'' = o^2 (p - q) - 2 z o q'` with
//! the angular frequency `o` and the damping ratio `z`.

use glam::{Affine3A, Vec3};

use super::AnimateError;
use crate::geometry::Clip;

crate::params! {
    /// How the tip of a lock lags behind a head that moves.
    #[derive(PartialEq)]
    pub struct Lag("coif.lag") {
        /// How fast it swings: slow for long and heavy locks.
        frequency: f32 = 1.5, unit("1/s"), range(0.1, 20.0);
        /// How soon the swing dies: 0 never, 1 without swinging over.
        damping: f32 = 0.35, range(0.02, 4.0);
        /// How much of the lag is shown.
        amount: f32 = 1.0, range(0.0, 2.0);
    }
}

/// The greatest part of a swing's radian in one step of the integration.
const STEP: f32 = 0.05;
/// Laps of a loop after which the swing has become the same in every lap, whatever the damping.
const MOST_LAPS: usize = 64;
/// Laps that end so near to each other are the same, cm.
const SAME: f32 = 1e-3;

/// The handle's places as the head sees them, one per frame: `path` is where the handle would be on a head at rest, `head`
/// what the head does. Without a lag the path itself.
///
/// # Errors
/// No frames, or not as many as the path has.
pub fn lagging(path: &[Vec3], head: &Clip<Affine3A>, lag: &Lag, looped: bool) -> Result<Vec<Vec3>, AnimateError> {
    let (Some(&first), Some(start)) = (path.first(), head.at(0)) else { return Err(AnimateError::NoFrames) };
    AnimateError::check("rate", head.rate, 0.01, 1000.0)?;
    let (o, z) = (std::f32::consts::TAU * lag.frequency, lag.damping);
    AnimateError::check("frequency", lag.frequency, 0.1, 20.0)?;
    AnimateError::check("damping", z, 0.02, 4.0)?;
    let pose = |f: usize| head.at(f).map_or(Affine3A::IDENTITY, |a| **a);
    let wanted: Vec<Vec3> = path.iter().enumerate().map(|(f, p)| pose(f).transform_point3(*p)).collect();
    let n = path.len();
    let steps = (o * (1.0 + z) / (STEP * head.rate)).ceil().max(1.0) as usize;
    let h = 1.0 / (head.rate * steps as f32);
    let (mut q, mut v) = (start.transform_point3(first), Vec3::ZERO);
    let lap = |q: &mut Vec3, v: &mut Vec3| {
        let mut places = Vec::with_capacity(n);
        for f in 0..n {
            places.push(*q);
            let next = if f + 1 < n {
                wanted[f + 1]
            } else if looped {
                wanted[0]
            } else {
                break;
            };
            for k in 1..=steps {
                // Semi-implicit, damping included: no step size makes it gain energy from that.
                let p = wanted[f].lerp(next, k as f32 / steps as f32);
                *v = (*v + (p - *q) * (o * o * h)) / (1.0 + 2.0 * z * o * h);
                *q += *v * h;
            }
        }
        places
    };
    let mut places = lap(&mut q, &mut v);
    if looped {
        for _ in 1..MOST_LAPS {
            let before = places[0];
            places = lap(&mut q, &mut v);
            if places[0].distance(before) < SAME && q.distance(places[0]) < SAME {
                break;
            }
        }
    }
    let seen = |(f, place): (usize, Vec3)| path[f] + (pose(f).inverse().transform_point3(place) - path[f]) * lag.amount;
    Ok(places.into_iter().enumerate().map(seen).collect())
}

/// Frames as the head sees them, carried along with it.
#[must_use]
pub fn carried(clip: &Clip<Vec<Vec3>>, head: &Clip<Affine3A>) -> Clip<Vec<Vec3>> {
    let carry = |(f, frame): (usize, &std::sync::Arc<Vec<Vec3>>)| match head.at(f) {
        Some(pose) => std::sync::Arc::new(frame.iter().map(|p| pose.transform_point3(*p)).collect()),
        None => std::sync::Arc::clone(frame),
    };
    Clip { rate: clip.rate, looped: clip.looped, frames: clip.frames.iter().enumerate().map(carry).collect() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::trig;
    use std::sync::Arc;

    fn head(frames: usize, at: impl Fn(usize) -> Affine3A) -> Clip<Affine3A> {
        Clip::new(24.0, (0..frames).map(|f| Arc::new(at(f))).collect())
    }

    const LAG: Lag = Lag { frequency: 2.0, damping: 0.3, amount: 1.0 };

    #[test]
    fn on_a_head_at_rest_nothing_lags() {
        let path = vec![Vec3::new(1.0, -9.0, 3.0); 30];
        for looped in [false, true] {
            let out = lagging(&path, &head(30, |_| Affine3A::IDENTITY), &LAG, looped).unwrap();
            assert!(out.iter().zip(&path).all(|(a, b)| a.distance(*b) < 1e-4));
        }
    }

    #[test]
    fn after_a_jerk_it_swings_about_its_place_and_comes_to_rest() {
        let path = vec![Vec3::NEG_Y * 9.0; 120];
        let jerk = head(120, |f| Affine3A::from_translation(if f == 0 { Vec3::ZERO } else { Vec3::X * 3.0 }));
        let out = lagging(&path, &jerk, &LAG, false).unwrap();
        let swing: Vec<f32> = out.iter().map(|p| p.x).collect();
        assert!(swing[1] < -1.0 && swing.iter().copied().fold(f32::MIN, f32::max) > 0.5);
        assert!(swing[100..].iter().all(|x| x.abs() < 0.02), "{:?}", &swing[100..]);
        // The damped frequency: from one passage upwards to the next.
        let up: Vec<usize> = (1..120).filter(|&f| swing[f - 1] < 0.0 && swing[f] >= 0.0).take(2).collect();
        let period = (up[1] - up[0]) as f32 / 24.0;
        let exact = 1.0 / (2.0 * (1.0 - 0.09_f32).sqrt());
        assert!((period - exact).abs() < 1.5 / 24.0, "{period} {exact}");
        assert!(out.iter().all(|p| (p.y + 9.0).abs() < 1e-4 && p.z.abs() < 1e-4));
        let half = lagging(&path, &jerk, &Lag { amount: 0.5, ..LAG }, false).unwrap();
        assert!((half[1].x - 0.5 * swing[1]).abs() < 1e-4);
    }

    #[test]
    fn a_loop_s_lag_closes() {
        let n = 48;
        let turn = |f: usize| Affine3A::from_rotation_y(0.6 * trig::sin(std::f32::consts::TAU * f as f32 / n as f32));
        let mut nod = head(n, turn);
        nod.looped = true;
        let out = lagging(&vec![Vec3::new(0.0, -5.0, -12.0); n], &nod, &LAG, true).unwrap();
        let most = out.windows(2).map(|w| w[0].distance(w[1])).fold(0.0, f32::max);
        assert!(most > 0.1 && out[n - 1].distance(out[0]) <= most, "{most}");
        let again = lagging(&vec![Vec3::new(0.0, -5.0, -12.0); n], &nod, &LAG, true).unwrap();
        assert_eq!(out, again);
    }

    #[test]
    fn carried_frames_are_moved_as_the_head_is() {
        let clip = Clip::new(24.0, (0..3).map(|_| Arc::new(vec![Vec3::X])).collect());
        let by = head(2, |f| Affine3A::from_translation(Vec3::Y * f as f32));
        let out = carried(&clip, &by);
        assert_eq!(*out.frames[0], [Vec3::X]);
        assert_eq!(*out.frames[2], [Vec3::X + Vec3::Y]);
        assert_eq!(lagging(&[], &by, &LAG, false), Err(AnimateError::NoFrames));
    }
}
