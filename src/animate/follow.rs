//! A lock on a head that moves: posed as the head sees it, and then carried along, so that its root stays on the skin.

use glam::{Affine3A, Vec3};

use crate::geometry::Clip;

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
    use std::sync::Arc;

    use glam::Vec3;

    use super::*;

    #[test]
    fn carried_frames_are_moved_as_the_head_is() {
        let clip = Clip::new(24.0, (0..3).map(|_| Arc::new(vec![Vec3::X])).collect());
        let poses = (0..2).map(|f| Arc::new(Affine3A::from_translation(Vec3::Y * f as f32)));
        let out = carried(&clip, &Clip::new(24.0, poses.collect()));
        assert_eq!(*out.frames[0], [Vec3::X]);
        assert_eq!(*out.frames[2], [Vec3::X + Vec3::Y]);
    }
}
