//! Rotations as vectors: polar decomposition, logarithm, and the branch of the logarithm.
//!
//! A rotation vector points along the axis, and its length is the angle. One rotation has many: the angle may grow by
//! whole turns. Blending scales the vector, so which one is taken decides which way round a lock turns.

use std::f64::consts::TAU;

use glam::{DMat3, DQuat, DVec3};

/// `T = R S` with a rotation and a symmetric positive definite stretch, by Newton's iteration for the polar factor,
/// scaled (Higham 1986). `None` when `T` turns space inside out, has no inverse or is not finite.
pub(super) fn polar(t: DMat3) -> Option<(DMat3, DMat3)> {
    if !t.is_finite() || t.determinant() <= 0.0 {
        return None;
    }
    let norm = |m: DMat3| m.x_axis.length_squared() + m.y_axis.length_squared() + m.z_axis.length_squared();
    let mut r = t;
    for _ in 0..64 {
        let back = r.inverse().transpose();
        if !back.is_finite() {
            return None;
        }
        let scale = (norm(back) / norm(r)).sqrt().sqrt();
        let next = 0.5 * (r * scale + back * (1.0 / scale));
        let change = norm(next - r);
        r = next;
        if change < 1e-28 {
            break;
        }
    }
    let s = r.transpose() * t;
    Some((r, 0.5 * (s + s.transpose())))
}

/// The shortest rotation vector of a rotation: angle 0 to pi.
pub(super) fn logarithm(r: DMat3) -> DVec3 {
    let q = DQuat::from_mat3(&r).normalize();
    let q = if q.w < 0.0 { -q } else { q };
    let v = q.xyz();
    let sin = v.length();
    if sin < 1e-9 { 2.0 * v } else { v * (2.0 * libm::atan2(sin, q.w) / sin) }
}

/// The rotation vector of the same rotation as `vector` that lies nearest to `beside`.
pub(super) fn branch(vector: DVec3, beside: DVec3) -> DVec3 {
    let angle = vector.length();
    if angle < 1e-6 {
        // Hardly any axis of its own: whole turns go about the neighbour's.
        let turns = (beside.length() / TAU).round();
        return vector + beside.normalize_or_zero() * (turns * TAU);
    }
    let axis = vector / angle;
    axis * (angle + TAU * ((axis.dot(beside) - angle) / TAU).round())
}

/// The rotation of a rotation vector, for checks; the blending has its own, many at a time.
#[cfg(test)]
pub(super) fn exponential(vector: DVec3) -> DMat3 {
    let angle = vector.length();
    if angle == 0.0 { DMat3::IDENTITY } else { DMat3::from_axis_angle(vector / angle, angle) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn vector(range: std::ops::Range<f64>) -> impl Strategy<Value = DVec3> {
        (range.clone(), range.clone(), range).prop_map(|(x, y, z)| DVec3::new(x, y, z))
    }

    fn distance(a: DMat3, b: DMat3) -> f64 {
        (a - b).to_cols_array().iter().fold(0.0, |m, x| m.max(x.abs()))
    }

    proptest! {
        #[test]
        fn polar_parts_are_a_rotation_and_a_stretch(
            turn in vector(-3.0..3.0), axes in vector(-2.0..2.0), sizes in vector(0.01..5.0),
        ) {
            let (r, v) = (exponential(turn), exponential(axes));
            let s = v * DMat3::from_diagonal(sizes) * v.transpose();
            let (rotation, stretch) = polar(r * s).unwrap();
            prop_assert!(distance(rotation, r) < 1e-9);
            prop_assert!(distance(stretch, s) < 1e-9);
        }

        #[test]
        fn a_logarithm_leads_back_and_is_short(turn in vector(-4.0..4.0)) {
            let r = exponential(turn);
            let log = logarithm(r);
            prop_assert!(log.length() < TAU / 2.0 + 1e-9);
            prop_assert!(distance(exponential(log), r) < 1e-9);
        }

        #[test]
        fn a_branch_is_the_same_rotation_and_no_other_is_nearer(turn in vector(-4.0..4.0), beside in vector(-9.0..9.0)) {
            let log = logarithm(exponential(turn));
            let near = branch(log, beside);
            prop_assert!(distance(exponential(near), exponential(log)) < 1e-8);
            for turns in -4..=4 {
                let other = log + log.normalize_or_zero() * (TAU * f64::from(turns));
                prop_assert!(near.distance(beside) <= other.distance(beside) + 1e-9);
            }
        }
    }

    #[test]
    fn what_is_no_stretched_rotation_is_refused() {
        assert!(polar(DMat3::ZERO).is_none());
        assert!(polar(-DMat3::IDENTITY).is_none());
        assert!(polar(DMat3::from_diagonal(DVec3::new(1.0, f64::NAN, 1.0))).is_none());
        let half = logarithm(DMat3::from_axis_angle(DVec3::Y, std::f64::consts::PI));
        assert!((half.length() - std::f64::consts::PI).abs() < 1e-9);
    }

    #[test]
    fn no_turn_beside_whole_turns_is_whole_turns() {
        let two = branch(DVec3::ZERO, DVec3::new(0.0, 12.4, 0.0));
        assert!(two.distance(DVec3::Y * (2.0 * TAU)) < 1e-9);
        assert_eq!(branch(DVec3::ZERO, DVec3::ZERO), DVec3::ZERO);
    }
}
