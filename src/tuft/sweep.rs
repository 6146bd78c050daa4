//! A stroke with arc length and frames: what sections are swept along.

use glam::Vec3;

use super::Stroke;
use super::stroke::{derivative, position};
use crate::geometry::frames::transport;
use crate::math::trig;

/// A place on a stroke with its axes, right-handed: `tangent` x `normal` = `binormal`, all unit.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    pub(super) centre: Vec3,
    pub(super) tangent: Vec3,
    /// Along the section's thickness, away from the head.
    pub(super) normal: Vec3,
    /// Along the section's width.
    pub(super) binormal: Vec3,
}

#[derive(Clone, Copy)]
struct Node {
    /// Arc length from the buried start.
    s: f32,
    position: Vec3,
    tangent: Vec3,
    normal: Vec3,
}

/// A stroke measured by arc length, with rotation-minimising frames.
///
/// The frames' one freedom, a constant turn about the tangent, is spent so that the thickness axis points away from
/// the head as well as it can (least squares over the stroke), or along a given direction.
pub(super) struct Sweep {
    beziers: Vec<[Vec3; 4]>,
    /// `steps` per span, and the end.
    nodes: Vec<Node>,
    steps: usize,
}

impl Sweep {
    pub(super) fn new(stroke: &Stroke, up: Option<Vec3>) -> Self {
        let beziers = stroke.beziers();
        // Enough that the table's arc length is good to a thousandth also for strokes of two points.
        let steps = (128 / beziers.len()).clamp(6, 32);
        let mut nodes: Vec<Node> = Vec::with_capacity(beziers.len() * steps + 1);
        let first = (beziers[0][3] - beziers[0][0]).try_normalize().unwrap_or(Vec3::Y);
        nodes.push(Node {
            s: 0.0,
            position: beziers[0][0],
            tangent: derivative(&beziers[0], 0.0).try_normalize().unwrap_or(first),
            normal: Vec3::ZERO,
        });
        nodes[0].normal = nodes[0].tangent.any_orthonormal_vector();
        for b in &beziers {
            for k in 1..=steps {
                let before = nodes[nodes.len() - 1];
                let u = k as f32 / steps as f32;
                let at = position(b, u);
                // Where a stroke turns back on itself the derivative may vanish: go on as before.
                let tangent = derivative(b, u).try_normalize().unwrap_or(before.tangent);
                let normal = transport(before.normal, before.position, before.tangent, at, tangent);
                nodes.push(Node { s: before.s + at.distance(before.position), position: at, tangent, normal });
            }
        }
        let mut sweep = Self { beziers, nodes, steps };
        sweep.orient(stroke.reference(), up);
        sweep
    }

    /// Turns all frames by the angle that brings the normals closest to the wanted directions.
    fn orient(&mut self, reference: Vec3, up: Option<Vec3>) {
        let nodes = &self.nodes;
        let sums = |wanted: &dyn Fn(&Node) -> Vec3| {
            nodes.windows(2).fold((0.0, 0.0), |(a, b), w| {
                let (n, weight) = (&w[1], w[1].s - w[0].s);
                let o = wanted(n);
                let binormal = n.tangent.cross(n.normal);
                (a + weight * o.dot(n.normal), b + weight * o.dot(binormal))
            })
        };
        // A spike that stands straight off the head has no side that faces away: take up, then the face's side.
        let length = self.length();
        let outward = move |n: &Node| (n.position - reference).normalize_or_zero();
        let given = move |_: &Node| up.unwrap_or_default();
        let mut choices: Vec<&dyn Fn(&Node) -> Vec3> = vec![&outward, &|_| Vec3::Y, &|_| Vec3::Z];
        if up.is_some() {
            choices.insert(0, &given);
        }
        let clear = |&(a, b): &(f32, f32)| trig::hypot(a, b) > 0.02 * length;
        let Some((a, b)) = choices.into_iter().map(sums).find(clear) else { return };
        let angle = trig::atan2(b, a);
        let (sin, cos) = (trig::sin(angle), trig::cos(angle));
        for n in &mut self.nodes {
            n.normal = (n.normal * cos + n.tangent.cross(n.normal) * sin).normalize_or_zero();
        }
    }

    /// Arc length from the buried start to the tip, cm.
    pub(super) fn length(&self) -> f32 {
        self.nodes[self.nodes.len() - 1].s
    }

    /// The fraction of arc length at control point `i`; 0 is the root's, the buried start lies before it.
    pub(super) fn control(&self, i: usize) -> f32 {
        self.nodes[(i + 1) * self.steps].s / self.length()
    }

    /// The frame at the fraction `t` in 0..=1 of the arc length.
    pub(super) fn at(&self, t: f32) -> Frame {
        let s = t * self.length();
        let i = self.nodes.partition_point(|n| n.s <= s).clamp(1, self.nodes.len() - 1) - 1;
        let (a, b) = (&self.nodes[i], &self.nodes[i + 1]);
        let w = if b.s > a.s { ((s - a.s) / (b.s - a.s)).clamp(0.0, 1.0) } else { 0.0 };
        let bezier = &self.beziers[i / self.steps];
        let u = ((i % self.steps) as f32 + w) / self.steps as f32;
        let centre = position(bezier, u);
        let tangent = derivative(bezier, u).try_normalize().unwrap_or(a.tangent);
        let normal = transport(a.normal, a.position, a.tangent, centre, tangent);
        Frame { centre, tangent, normal, binormal: tangent.cross(normal) }
    }
}
