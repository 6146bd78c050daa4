//! Closed curves on a head: which places they enclose.
//!
//! The skull is seen from its middle, so a place is a direction. Directions are laid out in a plane about the middle
//! of the curve (Lambert's azimuthal equal-area projection, one to one up to the opposite side of the head), where
//! the winding number tells inside from outside.

use glam::{Mat3, Vec2, Vec3};

/// Steps along each edge, so that a straight edge in the plane stands for a great circle.
const STEPS: usize = 8;

/// A closed curve on a head.
#[derive(Clone, Debug)]
pub(super) struct Polygon {
    centre: Vec3,
    /// Rows: two axes across, the pole.
    frame: Mat3,
    outline: Vec<Vec2>,
    low: Vec2,
    high: Vec2,
    /// Least and greatest distance from the centre of what is still this head's skin.
    shell: (f32, f32),
}

impl Polygon {
    /// From at least three control points, seen from `centre`; `smooth` rounds the corners. A curve about half of the
    /// head encloses the half around `crown`, a smaller one what it is wrapped around.
    pub fn new(centre: Vec3, crown: Vec3, controls: &[Vec3], smooth: bool) -> Option<Self> {
        let points = curve(&arms(centre, controls)?, smooth);
        // The mean direction of the curve, by its length on the unit sphere: it does not depend on how the control
        // points crowd.
        let directions = || points.iter().map(|p| p.normalize_or_zero());
        let next = directions().cycle().skip(1);
        let (sum, length) = directions().zip(next).fold((Vec3::ZERO, 0.0), |(sum, length), (a, b)| {
            let step = a.distance(b);
            (sum + (a + b) * (0.5 * step), length + step)
        });
        let mean = sum / length.max(1e-9);
        let pole = if mean.length() > 0.4 { mean.normalize() } else { crown };
        Self::around(centre, pole, controls, smooth)
    }

    /// The same, enclosing the direction `pole` from the centre.
    pub fn around(centre: Vec3, pole: Vec3, controls: &[Vec3], smooth: bool) -> Option<Self> {
        let arms = arms(centre, controls)?;
        let points = curve(&arms, smooth);
        let across = pole.any_orthonormal_vector();
        let frame = Mat3::from_cols(across, pole.cross(across), pole).transpose();
        let radii = || arms.iter().map(|a| a.length());
        let shell = (0.55 * radii().fold(f32::INFINITY, f32::min), 1.3 * radii().fold(0.0, f32::max));
        let outline: Vec<Vec2> = points.iter().map(|a| flatten(&frame, *a)).collect();
        let low = outline.iter().copied().fold(Vec2::INFINITY, Vec2::min);
        let high = outline.iter().copied().fold(Vec2::NEG_INFINITY, Vec2::max);
        Some(Self { centre, frame, outline, low, high, shell })
    }

    /// True for a place that the curve encloses.
    pub fn contains(&self, p: Vec3) -> bool {
        let arm = p - self.centre;
        let radius = arm.length();
        if !(self.shell.0..=self.shell.1).contains(&radius) {
            return false;
        }
        let q = flatten(&self.frame, arm);
        if q.cmplt(self.low).any() || q.cmpgt(self.high).any() {
            return false;
        }
        let mut winding = 0;
        let mut a = self.outline[self.outline.len() - 1];
        for &b in &self.outline {
            if (a.y <= q.y) != (b.y <= q.y) {
                let left = (b - a).perp_dot(q - a);
                if b.y > a.y && left > 0.0 {
                    winding += 1;
                } else if b.y < a.y && left < 0.0 {
                    winding -= 1;
                }
            }
            a = b;
        }
        winding != 0
    }
}

/// The control points from the centre; those in the centre itself are left out.
fn arms(centre: Vec3, controls: &[Vec3]) -> Option<Vec<Vec3>> {
    let arms: Vec<Vec3> = controls.iter().map(|&p| p - centre).filter(|a| a.length() > 1e-4).collect();
    (arms.len() >= 3).then_some(arms)
}

/// The control points with their edges filled in, closed.
fn curve(arms: &[Vec3], smooth: bool) -> Vec<Vec3> {
    let n = arms.len();
    let mut points = Vec::with_capacity(n * STEPS);
    for i in 0..n {
        let [p0, p1, p2, p3] = [n - 1, 0, 1, 2].map(|k| arms[(i + k) % n]);
        for k in 0..STEPS {
            let t = k as f32 / STEPS as f32;
            points.push(if smooth {
                // Catmull and Rom 1974, in Barry and Goldman's uniform form.
                let (a, b) = ((p2 - p0) * 0.5, (p3 - p1) * 0.5);
                let (t2, t3) = (t * t, t * t * t);
                p1 * (2.0 * t3 - 3.0 * t2 + 1.0) + a * (t3 - 2.0 * t2 + t) + p2 * (3.0 * t2 - 2.0 * t3) + b * (t3 - t2)
            } else {
                p1.lerp(p2, t)
            });
        }
    }
    points
}

fn flatten(frame: &Mat3, arm: Vec3) -> Vec2 {
    let d = *frame * arm.normalize_or(Vec3::Y);
    if d.z <= -0.999_999 {
        // The opposite pole is the rim of the plane's disk.
        return Vec2::X * 2.0;
    }
    // |q| = sqrt(2 (1 - cos theta)).
    let scale = (2.0 / (1.0 + d.z)).sqrt();
    Vec2::new(d.x, d.y) * scale
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rng::Key;

    #[test]
    fn a_cap_is_a_cap_whatever_the_winding() {
        let ring: Vec<Vec3> = (0..40)
            .map(|i| {
                let a = std::f32::consts::TAU * i as f32 / 40.0;
                Vec3::new(crate::math::trig::cos(a), 0.3, crate::math::trig::sin(a)) * 10.0
            })
            .collect();
        let mut back = ring.clone();
        back.reverse();
        for ring in [ring, back] {
            let cap = Polygon::new(Vec3::ZERO, Vec3::Y, &ring, true).unwrap();
            for i in 0..500 {
                let d = Key::new(3, "cap").with(i).direction();
                let slope = d.y / Vec3::new(d.x, 0.0, d.z).length();
                if (slope - 0.3).abs() > 0.01 {
                    assert_eq!(cap.contains(d * 10.0), slope > 0.3, "{d}");
                }
            }
        }
    }

    #[test]
    fn what_lies_behind_the_skin_or_far_out_is_outside() {
        let square = [
            Vec3::new(-2.0, 10.0, -2.0),
            Vec3::new(2.0, 10.0, -2.0),
            Vec3::new(2.0, 10.0, 2.0),
            Vec3::new(-2.0, 10.0, 2.0),
        ];
        let polygon = Polygon::new(Vec3::ZERO, Vec3::Z, &square, false).unwrap();
        assert!(polygon.contains(Vec3::Y * 10.0));
        assert!(!polygon.contains(Vec3::Y * 3.0));
        assert!(!polygon.contains(Vec3::Y * 30.0));
        assert!(!polygon.contains(Vec3::new(2.3, 10.0, 0.0)));
        assert!(!polygon.contains(Vec3::Y * -10.0));
    }

    #[test]
    fn too_few_points_are_no_polygon() {
        assert!(Polygon::new(Vec3::ZERO, Vec3::Y, &[Vec3::X, Vec3::Y], false).is_none());
        assert!(Polygon::new(Vec3::X, Vec3::Y, &[Vec3::X, Vec3::X, Vec3::Y], false).is_none());
    }
}
