//! Where the head is at a time.

use std::sync::Arc;

use glam::{Affine3A, Quat, Vec3};

use super::error::{DynamicsError, check_value};
use crate::geometry::Clip;

/// The motion of the head between the frames of a clip: a curve through them without jerks.
#[derive(Clone, Debug)]
pub struct Poses {
    rate: f32,
    looped: bool,
    poses: Vec<(Quat, Vec3)>,
}

impl Poses {
    /// Of a clip of turns and shifts.
    ///
    /// # Errors
    /// A frame that is not finite, or that does more than turn and shift.
    pub fn new(clip: &Clip<Affine3A>) -> Result<Self, DynamicsError> {
        let mut poses: Vec<(Quat, Vec3)> = vec![];
        for (i, frame) in clip.frames.iter().map(Arc::as_ref).enumerate() {
            let m = frame.matrix3;
            let off =
                (m.transpose() * m).to_cols_array().into_iter().zip([1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]);
            let off = off.map(|(a, b)| (a - b).abs()).fold(m.determinant() - 1.0, f32::max);
            check_value(format!("what frame {} of the head's motion scales or shears by", i + 1), off, -1e-3, 1e-3)?;
            for c in frame.translation.to_array() {
                check_value(format!("the shift of frame {} of the head's motion", i + 1), c, -1e6, 1e6)?;
            }
            let mut turn = Quat::from_mat3a(&m).normalize();
            if poses.last().is_some_and(|p| p.0.dot(turn) < 0.0) {
                turn = -turn;
            }
            poses.push((turn, frame.translation.into()));
        }
        Ok(Self { rate: clip.rate, looped: clip.looped, poses })
    }

    /// No motion.
    pub fn still() -> Self {
        Self { rate: 1.0, looped: false, poses: vec![] }
    }

    /// The head at a time, s.
    pub fn at(&self, time: f32) -> Affine3A {
        if self.poses.is_empty() {
            return Affine3A::IDENTITY;
        }
        let count = self.poses.len() as i64;
        let x = time * self.rate;
        let base = x.floor();
        // Frames are hit to the bit but for rounding of the time.
        let (base, u) = if x - base > 0.999_9 { (base + 1.0, 0.0) } else { (base, x - base) };
        let u = if u < 1e-4 { 0.0 } else { u };
        let pose = |k: i64| {
            let k = base as i64 + k;
            self.poses[if self.looped { k.rem_euclid(count) } else { k.clamp(0, count - 1) } as usize]
        };
        let (a, b, c, d) = (pose(-1), pose(0), pose(1), pose(2));
        if u == 0.0 {
            return Affine3A::from_rotation_translation(b.0, b.1);
        }
        // A turn and its negative are the same; a loop may come back to the other one.
        let near = |q: Quat, to: Quat| if q.dot(to) < 0.0 { -q } else { q };
        let (qb, qc) = (b.0, near(c.0, b.0));
        let (qa, qd) = (near(a.0, qb), near(d.0, qc));
        let turn = qb
            + (qc - qa) * (0.5 * u)
            + (qa * 2.0 - qb * 5.0 + qc * 4.0 - qd) * (0.5 * u * u)
            + (qb * 3.0 - qa - qc * 3.0 + qd) * (0.5 * u * u * u);
        let shift = b.1
            + (c.1 - a.1) * (0.5 * u)
            + (a.1 * 2.0 - b.1 * 5.0 + c.1 * 4.0 - d.1) * (0.5 * u * u)
            + (b.1 * 3.0 - a.1 - c.1 * 3.0 + d.1) * (0.5 * u * u * u);
        Affine3A::from_rotation_translation(turn.normalize(), shift)
    }
}
