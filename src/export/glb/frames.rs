//! The frames of a ribbon: which way it faces at every node.

use glam::Vec3;

use crate::geometry::frames;

/// Cosine of the angle to the skin's normal below which a strand lies rather than stands: 45 degrees.
const LYING: f32 = std::f32::consts::FRAC_1_SQRT_2;

/// A node of a ribbon.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Position, cm.
    pub position: Vec3,
    /// Unit direction from root to tip.
    pub tangent: Vec3,
    /// Unit normal of the ribbon, orthogonal to the tangent.
    pub normal: Vec3,
    /// Share of the length from the root, 0..=1.
    pub v: f32,
}

/// Frames at `positions` that turn about the strand no more than they must, and face as the skin does (`outward`) where
/// the strand first lies down on it.
///
/// Nodes may coincide; where a direction cannot be told, the one before it holds.
pub fn ribbon(positions: impl ExactSizeIterator<Item = Vec3>, outward: Vec3, out: &mut Vec<Frame>) {
    out.clear();
    out.extend(positions.map(|position| Frame { position, tangent: Vec3::ZERO, normal: Vec3::ZERO, v: 0.0 }));
    tangents(out, outward);
    transport(out);
    face(out, outward);
}

/// The frames of a strand that has moved, from those at rest: at the root as at rest but for the least turn that the
/// tangent's makes necessary, and on from there turning no more than they must. They follow a motion smoothly, and `v`
/// is that at rest.
pub fn moved(rest: &[Frame], positions: impl Iterator<Item = Vec3>, out: &mut Vec<Frame>) {
    out.clear();
    out.extend(positions.zip(rest).map(|(position, rest)| Frame { position, ..*rest }));
    let Some(first) = rest.first() else { return };
    tangents(out, first.tangent);
    if let Some(now) = out.first_mut() {
        let turned = glam::Quat::from_rotation_arc(first.tangent, now.tangent) * first.normal;
        now.normal = frames::perpendicular(turned, now.tangent);
    }
    for i in 1..out.len() {
        let (a, b) = (out[i - 1], out[i]);
        out[i].normal = frames::transport(a.normal, a.position, a.tangent, b.position, b.tangent);
    }
    for (now, rest) in out.iter_mut().zip(rest) {
        now.v = rest.v;
    }
}

/// Fills tangents (the bisector of the two segments at a node) and `v`.
fn tangents(frames: &mut [Frame], outward: Vec3) {
    let count = frames.len();
    let segment = |frames: &[Frame], i: usize| frames[i + 1].position - frames[i].position;
    let mut before = (0..count.saturating_sub(1))
        .find_map(|i| segment(frames, i).try_normalize())
        .or_else(|| outward.try_normalize())
        .unwrap_or(Vec3::Y);
    let mut length = 0.0;
    for i in 0..count {
        frames[i].v = length;
        let after = if i + 1 < count { segment(frames, i) } else { Vec3::ZERO };
        length += after.length();
        let after = after.try_normalize().unwrap_or(before);
        frames[i].tangent = (before + after).try_normalize().unwrap_or(before);
        before = after;
    }
    for (i, frame) in frames.iter_mut().enumerate() {
        frame.v = if length > 0.0 { frame.v / length } else { i as f32 / (count - 1) as f32 };
    }
}

/// Fills rotation-minimising normals, the first one arbitrary.
fn transport(frames: &mut [Frame]) {
    let Some(first) = frames.first_mut() else { return };
    first.normal = first.tangent.any_orthonormal_vector();
    for i in 1..frames.len() {
        let (a, b) = (frames[i - 1], frames[i]);
        frames[i].normal = frames::transport(a.normal, a.position, a.tangent, b.position, b.tangent);
    }
}

/// Turns all normals by one angle, so that they agree with `outward` where the strand first lies. A strand often leaves
/// the skin along its normal, where every way to face is as good; and far from the root the skin's normal means nothing.
fn face(frames: &mut [Frame], outward: Vec3) {
    let standing = |f: &Frame| f.tangent.dot(outward);
    let lying = frames
        .iter()
        .find(|f| standing(f) <= LYING)
        .or_else(|| frames.iter().min_by(|a, b| standing(a).total_cmp(&standing(b))));
    let Some(at) = lying else { return };
    let (x, y) = (at.normal.dot(outward), at.tangent.cross(at.normal).dot(outward));
    let length = crate::math::trig::hypot(x, y);
    // Straight along the normal, or no usable normal (NaN fails every comparison): any way is as good.
    if length > 1e-4 {
        let (cos, sin) = (x / length, y / length);
        for f in frames {
            let turned = f.normal * cos + f.tangent.cross(f.normal) * sin;
            f.normal = turned.normalize_or(f.normal);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rng::Key;
    use crate::math::trig;

    fn of(positions: &[Vec3], outward: Vec3) -> Vec<Frame> {
        let mut out = Vec::new();
        ribbon(positions.iter().copied(), outward, &mut out);
        assert_eq!(out.len(), positions.len());
        for f in &out {
            assert!((f.tangent.length() - 1.0).abs() < 1e-5, "{f:?}");
            assert!((f.normal.length() - 1.0).abs() < 1e-5, "{f:?}");
            assert!(f.normal.dot(f.tangent).abs() < 1e-5, "{f:?}");
        }
        assert_eq!((out[0].v, out[out.len() - 1].v), (0.0, 1.0));
        assert!(out.windows(2).all(|w| w[0].v <= w[1].v));
        out
    }

    /// From the crown of a ball straight out, then over and along its back: a hair as it grows.
    fn combed(radius: f32) -> Vec<Vec3> {
        let mut points = vec![Vec3::Y * radius];
        points.extend((0..=40).map(|i| {
            let a = i as f32 * 0.04;
            Vec3::new(0.0, trig::cos(a), -trig::sin(a)) * (radius + 0.3)
        }));
        // Then hanging far below.
        points.extend((1..40).map(|i| points_end(radius) - Vec3::Y * i as f32));
        points
    }

    fn points_end(radius: f32) -> Vec3 {
        Vec3::new(0.0, trig::cos(1.6), -trig::sin(1.6)) * (radius + 0.3)
    }

    #[test]
    fn a_combed_strand_faces_outward_all_along() {
        // The root's normal leans forward, so at the hanging end it points against the outside (-Z).
        let normal = Vec3::new(0.0, 1.0, 0.3).normalize();
        for f in of(&combed(9.0), normal) {
            let outside = Vec3::new(0.0, f.position.y.max(0.0), f.position.z).normalize();
            assert!(f.normal.dot(outside) > 0.6 || f.tangent.dot(outside) > 0.8, "{f:?}");
            assert!(f.normal.x.abs() < 1e-4, "a plane strand keeps its plane");
        }
    }

    #[test]
    fn frames_do_not_twist() {
        // Along a helix a rotation-minimising frame turns against the Frenet frame by the torsion; between neighbours
        // the turn about the tangent must vanish: transporting by the smallest rotation gives the same normal.
        let helix: Vec<Vec3> = (0..400)
            .map(|i| {
                let a = i as f32 * 0.05;
                Vec3::new(trig::cos(a), -0.1 * a, trig::sin(a))
            })
            .collect();
        for w in of(&helix, Vec3::X).windows(2) {
            let turn = glam::Quat::from_rotation_arc(w[0].tangent, w[1].tangent);
            assert!((turn * w[0].normal).dot(w[1].normal) > 1.0 - 1e-5);
        }
    }

    #[test]
    fn degenerate_strands_still_have_frames() {
        of(&[Vec3::ONE; 4], Vec3::Z);
        of(&[Vec3::ONE; 2], Vec3::ZERO);
        of(&[Vec3::ZERO, Vec3::Y, Vec3::Y * 2.0], Vec3::Y);
        of(&[Vec3::ZERO, Vec3::Y, Vec3::ZERO, Vec3::ZERO, Vec3::X], Vec3::Y);
        of(&[Vec3::ZERO, Vec3::X], Vec3::NAN);
        for seed in 0..100 {
            let key = Key::new(seed, "frames");
            let points: Vec<Vec3> = (0..20).map(|i| key.with(i).direction()).collect();
            of(&points, key.with(99).direction());
        }
    }
}
