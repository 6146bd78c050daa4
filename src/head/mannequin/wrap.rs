//! Draws a grid onto the surface of a distance field.

use glam::Vec3;
use rayon::prelude::*;

use super::Form;
use super::grid::Half;

/// How far from the surface the wrapping begins, in cm: there the level set has hardly an ear or a nose.
const START: f32 = 1.2;
/// Rounds in which the grid closes in on the surface.
const CLOSING: usize = 10;
/// Rounds on the surface itself.
const RESTING: usize = 26;
/// On the surface the direction to it is sought anew every so many rounds; on the way every other round.
const REFRESH: usize = 4;
/// Half edge of the tetrahedron of samples, in cm.
const PROBE: f32 = 0.03;

/// Value, outward unit normal and steepness of a field, from four samples at the corners of a tetrahedron.
fn probe(distance: fn(Vec3) -> f32, p: Vec3) -> (f32, Vec3, f32) {
    const CORNERS: [Vec3; 4] =
        [Vec3::new(1.0, -1.0, -1.0), Vec3::new(-1.0, -1.0, 1.0), Vec3::new(-1.0, 1.0, -1.0), Vec3::new(1.0, 1.0, 1.0)];
    let (mut sum, mut slope) = (0.0, Vec3::ZERO);
    for corner in CORNERS {
        let d = distance(mirrored(p + corner * PROBE));
        sum += d;
        slope += corner * d;
    }
    let slope = slope / (4.0 * PROBE);
    (sum * 0.25, slope.try_normalize().unwrap_or(Vec3::Y), slope.length())
}

/// The same place on the left side.
fn mirrored(p: Vec3) -> Vec3 {
    Vec3::new(p.x.abs(), p.y, p.z)
}

/// A vertex on its way: its place, the step that one unit of the field's value asks for, and the edge wanted there.
#[derive(Clone, Copy)]
struct Traveller {
    p: Vec3,
    step: Vec3,
    edge: f32,
}

impl Traveller {
    /// One Newton step of at most `limit` cm towards the level set `level`.
    fn approach(self, distance: fn(Vec3) -> f32, level: f32, limit: f32) -> Self {
        let (value, normal, slope) = probe(distance, self.p);
        let step = normal / slope.max(0.3);
        Self { p: self.p - (step * (value - level)).clamp_length_max(limit), step, ..self }
    }

    /// The same with the direction of the last step.
    fn approach_again(self, distance: fn(Vec3) -> f32, level: f32, limit: f32) -> Self {
        let value = distance(mirrored(self.p));
        Self { p: self.p - (self.step * (value - level)).clamp_length_max(limit), ..self }
    }

    /// Vertices of the middle stay there, the others stay left of it.
    fn settle(mut self, middle: bool) -> Self {
        self.p.x = if middle { 0.0 } else { self.p.x.max(0.0) };
        self
    }
}

/// The wrapped positions of the half grid.
///
/// The cage is first drawn onto a level set outside the form and follows it inward while it is relaxed. Coming from
/// outside, ears and nose take the share of the grid that their surface needs.
pub fn wrap(form: &Form, half: &Half) -> Vec<Vec3> {
    let mut travellers: Vec<Traveller> = half
        .cage
        .par_iter()
        .enumerate()
        .map(|(v, &p)| {
            let mut start = Traveller { p, step: Vec3::Y, edge: 1.0 };
            // Out of the form by the straight way: from inside the nose the field would lead into the face.
            for _ in 0..8 {
                let d = (form.distance)(mirrored(start.p));
                if d >= START {
                    break;
                }
                start.p += half.outward[v] * (START - d).clamp(0.0, 1.0);
            }
            (0..3).fold(start, |t, _| t.approach(form.distance, START, 2.0).settle(half.middle[v]))
        })
        .collect();
    let rounds = CLOSING + RESTING;
    for round in 0..rounds {
        let level = START * (CLOSING as f32 - 1.0 - round as f32).max(0.0) / CLOSING as f32;
        let fresh = round % if round < CLOSING { 2 } else { REFRESH } == 0;
        let landings = if round + 1 == rounds { 2 } else { 0 };
        travellers = (0..travellers.len())
            .into_par_iter()
            .with_min_len(256)
            .map(|v| {
                let mut t = travellers[v];
                // Only along the surface: a pull inward would draw the grid through thin parts.
                let (pull, normal) = (pull(half, &travellers, v), t.step.normalize_or_zero());
                t.p += (pull - normal * pull.dot(normal)) * 0.8;
                t = t.settle(half.middle[v]);
                t = if fresh {
                    t.edge = (form.edge)(t.p);
                    t.approach(form.distance, level, 0.5)
                } else {
                    t.approach_again(form.distance, level, 0.3)
                };
                t = t.settle(half.middle[v]);
                (0..landings).fold(t, |t, _| t.approach(form.distance, 0.0, 0.5).settle(half.middle[v]))
            })
            .collect();
    }
    travellers.iter().map(|t| t.p).collect()
}

/// Where the neighbours of a vertex draw it: each the more, the shorter edges should be there.
fn pull(half: &Half, travellers: &[Traveller], v: usize) -> Vec3 {
    let Traveller { p, edge, .. } = travellers[v];
    let (mut sum, mut weights) = (Vec3::ZERO, 0.0);
    for &w in &half.neighbours[v] {
        let other = &travellers[w as usize];
        let weight = 1.0 / (edge + other.edge);
        sum += (other.p - p) * weight;
        weights += weight;
    }
    sum / weights
}

/// Where the ray from `from` along the unit vector `direction` meets the surface, by sphere tracing; the last place
/// reached if it does not.
pub fn cast(distance: fn(Vec3) -> f32, from: Vec3, direction: Vec3) -> Vec3 {
    let mut p = from;
    for _ in 0..200 {
        let d = distance(mirrored(p));
        p += direction * (d * 0.6).clamp(-1.0, 1.0);
        if d.abs() < 1e-5 {
            break;
        }
    }
    p
}
