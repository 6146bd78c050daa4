//! Strokes: the centre lines of tufts.

use glam::{Quat, Vec3};

use super::{Ground, TuftError};
use crate::task::{Warned, Warning};

/// Control points closer together than this are one and the same, cm.
pub const SAME_POINT: f32 = 1e-3;

/// The centre line of a tuft: control points, and before them a start that is buried in the head.
///
/// The curve runs through the buried start P0 and all control points as a composite cubic Bezier (Shimosoyama,
/// Yamamoto, Noma 2015, section 3.1), C1 in its knots. The knots are centripetal, so that the short first span and
/// uneven points make neither loops nor cusps (Yuksel, Schaefer, Keyser 2011).
#[derive(Clone, Debug, PartialEq)]
pub struct Stroke {
    points: Vec<Vec3>,
    reference: Vec3,
    depth: f32,
}

impl Stroke {
    /// A stroke through `points` (at least two), whose start is buried `depth` (cm, more than 0) towards `reference`,
    /// the head's reference point; never beyond it.
    ///
    /// # Errors
    /// Too few points, repeated neighbours, numbers that are not finite, a start at the reference point.
    pub fn new(points: Vec<Vec3>, reference: Vec3, depth: f32) -> Result<Self, TuftError> {
        if points.len() < 2 {
            return Err(TuftError::TooFewPoints { what: "a stroke", least: 2, count: points.len() });
        }
        if let Some(i) = points.iter().position(|p| !p.is_finite()) {
            return Err(TuftError::NotFinite { number: i + 1, point: points[i] });
        }
        if let Some(i) = (1..points.len()).find(|&i| points[i].distance(points[i - 1]) < SAME_POINT) {
            return Err(TuftError::RepeatedPoint { number: i + 1, point: points[i] });
        }
        TuftError::check("depth", depth, 0.01, 100.0)?;
        if !reference.is_finite() || points[0].distance(reference) < 0.02 {
            return Err(TuftError::NoOutside { point: points[0] });
        }
        Ok(Self { points, reference, depth })
    }

    /// The same, with the start moved onto the head's surface, and a warning that says how far when that is more than
    /// a millimetre (times the head's scale). The other points stay where they are.
    ///
    /// # Errors
    /// As [`Stroke::new`].
    pub fn grounded(mut points: Vec<Vec3>, depth: f32, ground: &Ground) -> Result<Warned<Self>, TuftError> {
        let mut warnings = Vec::new();
        if let Some(start) = points.first_mut().filter(|p| p.is_finite()) {
            let on = ground.solid.closest(*start);
            let off = on.distance.abs();
            if off > 0.1 * ground.scale {
                let side = if on.distance > 0.0 { "outside" } else { "inside" };
                warnings.push(
                    Warning::new(format!("the stroke starts `{off:.2}` cm {side} the head; it was moved to the skin"))
                        .hint(format!(
                            "start at {{ {:.2}, {:.2}, {:.2} }}",
                            on.position.x, on.position.y, on.position.z
                        )),
                );
            }
            *start = on.position;
        }
        Ok(Warned { value: Self::new(points, ground.reference, depth)?, warnings })
    }

    /// The control points, root first, without the buried start.
    pub fn points(&self) -> &[Vec3] {
        &self.points
    }

    /// The first control point: on the head's surface.
    pub fn root(&self) -> Vec3 {
        self.points[0]
    }

    /// The head's reference point H.
    pub fn reference(&self) -> Vec3 {
        self.reference
    }

    /// How far the start is buried, cm.
    pub fn depth(&self) -> f32 {
        self.depth
    }

    /// The point P0: the root moved towards the reference point.
    pub fn buried_start(&self) -> Vec3 {
        let inward = self.reference - self.root();
        self.root() + inward.normalize_or_zero() * self.depth.min(inward.length())
    }

    /// Mirrored at the plane between the head's left and right (x = 0).
    #[must_use]
    pub fn mirrored(&self) -> Self {
        let flip = |p: &Vec3| Vec3::new(-p.x, p.y, p.z);
        Self { points: self.points.iter().map(flip).collect(), reference: flip(&self.reference), depth: self.depth }
    }

    /// Turned about its root by `angle` radians around `axis` (unit); root and buried start stay.
    #[must_use]
    pub fn rotated(&self, axis: Vec3, angle: f32) -> Self {
        let turn = Quat::from_axis_angle(axis, angle);
        let root = self.root();
        let mut points = self.points.clone();
        for p in &mut points[1..] {
            *p = root + turn * (*p - root);
        }
        Self { points, ..*self }
    }

    /// Turned as a whole about the reference point.
    #[must_use]
    pub fn turned(&self, turn: Quat) -> Self {
        let points = self.points.iter().map(|&p| self.reference + turn * (p - self.reference)).collect();
        Self { points, ..*self }
    }

    /// Moved as a whole so that the root comes to `root`; the reference point stays.
    #[must_use]
    pub fn moved_to(&self, root: Vec3) -> Self {
        let by = root - self.root();
        Self { points: self.points.iter().map(|&p| p + by).collect(), ..*self }
    }

    /// `count` strokes, this one first, each turned by `step` radians about the `axis` (unit) through the reference
    /// point against the one before, and moved so that its root lies on the head.
    pub fn array(&self, count: usize, axis: Vec3, step: f32, ground: &Ground) -> Vec<Self> {
        (0..count)
            .map(|i| match i {
                0 => self.clone(),
                _ => {
                    let turned = self.turned(Quat::from_axis_angle(axis, step * i as f32));
                    turned.moved_to(ground.below(turned.root()))
                }
            })
            .collect()
    }

    /// Its points projected onto the plane through the root with that unit normal (Ren, Zhao, Geng 2010 model in such
    /// a plane). The buried start is no control point and stays on the line to the reference point.
    ///
    /// # Errors
    /// Neighbouring points that fall on one place.
    pub fn planar(&self, normal: Vec3) -> Result<Self, TuftError> {
        let root = self.root();
        let points = self.points.iter().map(|&p| p - normal * (p - root).dot(normal)).collect();
        Self::new(points, self.reference, self.depth)
    }

    /// The composite Bezier: one cubic per span, from the buried start to the tip, one span per control point.
    pub fn beziers(&self) -> Vec<[Vec3; 4]> {
        let mut p = Vec::with_capacity(self.points.len() + 1);
        p.push(self.buried_start());
        p.extend_from_slice(&self.points);
        beziers(&p)
    }

    /// Lengths of the spans in the knots for which [`Stroke::beziers`] is C1: square roots of the chords.
    pub fn knots(&self) -> Vec<f32> {
        let mut from = self.buried_start();
        self.points.iter().map(|&p| knot(std::mem::replace(&mut from, p), p)).collect()
    }
}

fn knot(a: Vec3, b: Vec3) -> f32 {
    a.distance(b).sqrt().max(1e-4)
}

/// Cubic Beziers through at least two points: slopes of the parabola through each point and its neighbours (Bessel),
/// which for inner points is the non-uniform Catmull-Rom spline.
pub(super) fn beziers(p: &[Vec3]) -> Vec<[Vec3; 4]> {
    let h: Vec<f32> = p.windows(2).map(|w| knot(w[0], w[1])).collect();
    let chord: Vec<Vec3> = p.windows(2).zip(&h).map(|(w, h)| (w[1] - w[0]) / *h).collect();
    let last = h.len();
    let slope = |i: usize| -> Vec3 {
        if last == 1 {
            return chord[0];
        }
        // At an end the parabola's own slope, between ends the weighted mean.
        if i == 0 {
            ((2.0 * h[0] + h[1]) * chord[0] - h[0] * chord[1]) / (h[0] + h[1])
        } else if i == last {
            let (a, b) = (h[last - 1], h[last - 2]);
            ((2.0 * a + b) * chord[last - 1] - a * chord[last - 2]) / (a + b)
        } else {
            (h[i] * chord[i - 1] + h[i - 1] * chord[i]) / (h[i - 1] + h[i])
        }
    };
    (0..last)
        .map(|i| [p[i], p[i] + slope(i) * (h[i] / 3.0), p[i + 1] - slope(i + 1) * (h[i] / 3.0), p[i + 1]])
        .collect()
}

/// The same through a closed loop of at least three points.
pub(super) fn closed_beziers(p: &[Vec3]) -> Vec<[Vec3; 4]> {
    let n = p.len();
    let h: Vec<f32> = (0..n).map(|i| knot(p[i], p[(i + 1) % n])).collect();
    let slope = |i: usize| {
        let (i, before) = (i % n, (i + n - 1) % n);
        let chord = |k: usize| (p[(k + 1) % n] - p[k]) / h[k];
        (h[i] * chord(before) + h[before] * chord(i)) / (h[before] + h[i])
    };
    (0..n)
        .map(|i| {
            let (a, b) = (p[i], p[(i + 1) % n]);
            [a, a + slope(i) * (h[i] / 3.0), b - slope(i + 1) * (h[i] / 3.0), b]
        })
        .collect()
}

/// Position on a cubic Bezier at `u` in 0..=1.
pub(super) fn position(b: &[Vec3; 4], u: f32) -> Vec3 {
    let v = 1.0 - u;
    b[0] * (v * v * v) + b[1] * (3.0 * v * v * u) + b[2] * (3.0 * v * u * u) + b[3] * (u * u * u)
}

/// Derivative of a cubic Bezier by `u`.
pub(super) fn derivative(b: &[Vec3; 4], u: f32) -> Vec3 {
    let v = 1.0 - u;
    ((b[1] - b[0]) * (v * v) + (b[2] - b[1]) * (2.0 * v * u) + (b[3] - b[2]) * (u * u)) * 3.0
}
