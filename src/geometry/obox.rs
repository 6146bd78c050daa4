//! Oriented boxes.

use glam::{Mat3, Vec3};

use super::Bounds;

/// A box with its own axes. Points on the border are inside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrientedBox {
    /// Middle, cm.
    pub centre: Vec3,
    /// Columns: unit axes, orthogonal, right-handed.
    pub axes: Mat3,
    /// Half edge lengths along the axes, cm, each positive.
    pub half: Vec3,
}

impl OrientedBox {
    /// A box along the world's axes with the given middle and edge lengths.
    pub fn aligned(centre: Vec3, size: Vec3) -> Self {
        Self { centre, axes: Mat3::IDENTITY, half: size * 0.5 }
    }

    /// A box between two opposite corners, in any order.
    pub fn between(a: Vec3, b: Vec3) -> Self {
        Self::aligned((a + b) * 0.5, (a - b).abs())
    }

    /// The same box turned about its middle.
    #[must_use]
    pub fn rotated(self, rotation: Mat3) -> Self {
        Self { axes: rotation * self.axes, ..self }
    }

    /// `p` along the box's axes, from its middle.
    pub fn to_local(&self, p: Vec3) -> Vec3 {
        self.axes.transpose() * (p - self.centre)
    }

    /// True for a point inside or on the border.
    pub fn contains(&self, p: Vec3) -> bool {
        self.to_local(p).abs().cmple(self.half).all()
    }

    /// False for a box without volume or with a coordinate that is not finite.
    pub fn is_valid(&self) -> bool {
        self.centre.is_finite() && self.half.is_finite() && self.half.min_element() > 0.0
    }

    /// The fractions t in 0..=1 of the segment from `a` to `b` that lie inside: (first, last), if any do.
    pub fn clip(&self, a: Vec3, b: Vec3) -> Option<(f32, f32)> {
        let (p, d) = (self.to_local(a), self.axes.transpose() * (b - a));
        let (mut t0, mut t1) = (0.0_f32, 1.0_f32);
        for k in 0..3 {
            if d[k] == 0.0 {
                if p[k].abs() > self.half[k] {
                    return None;
                }
                continue;
            }
            let (u, v) = ((-self.half[k] - p[k]) / d[k], (self.half[k] - p[k]) / d[k]);
            t0 = t0.max(u.min(v));
            t1 = t1.min(u.max(v));
        }
        (t0 <= t1).then_some((t0, t1))
    }

    /// The eight corners.
    pub fn corners(&self) -> [Vec3; 8] {
        std::array::from_fn(|i| {
            let sign = |bit: usize| if i >> bit & 1 == 1 { 1.0 } else { -1.0 };
            self.centre + self.axes * (self.half * Vec3::new(sign(0), sign(1), sign(2)))
        })
    }

    /// Axis-aligned bounds.
    pub fn bounds(&self) -> Bounds {
        Bounds::of(self.corners())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inside_follows_the_axes() {
        let b = OrientedBox::aligned(Vec3::X, Vec3::new(4.0, 1.0, 1.0))
            .rotated(Mat3::from_rotation_z(std::f32::consts::FRAC_PI_2));
        assert!(b.contains(Vec3::new(1.0, 1.9, 0.0)));
        assert!(!b.contains(Vec3::new(2.9, 0.0, 0.0)));
    }

    #[test]
    fn clipping_gives_the_part_inside() {
        let b = OrientedBox::aligned(Vec3::ZERO, Vec3::splat(2.0));
        assert_eq!(b.clip(Vec3::new(-3.0, 0.0, 0.0), Vec3::new(1.0, 0.0, 0.0)), Some((0.5, 1.0)));
        assert_eq!(b.clip(Vec3::new(-3.0, 2.0, 0.0), Vec3::new(1.0, 2.0, 0.0)), None);
    }
}
