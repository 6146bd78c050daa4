//! The figure that pieces are cut for: a woman's torso in head space.

use std::f32::consts::{PI, TAU};

use glam::{Vec2, Vec3};

use crate::geometry::slice;
use crate::math::trig;

/// Heights of the tapes, cm below the ears of an adult's head.
pub const BUST: f32 = -39.0;
/// Height of the waist.
pub const WAIST: f32 = -57.0;
/// Height of the hip.
pub const HIP: f32 = -77.0;
/// Height of the fork of the legs.
pub const FORK: f32 = -85.0;
/// Where the torso's axis lies, front to back.
pub const AXIS: f32 = -3.5;

/// One row: height, half width, depth to the front, depth to the back, exponent, how far the breasts stand out.
type Row = [f32; 6];

/// Half widths and depths of a torso, from the neck down, cm; they are scaled to the measures.
const ROWS: [Row; 16] = [
    [-13.0, 5.4, 5.0, 5.2, 2.0, 0.0],
    [-16.0, 5.6, 5.0, 5.5, 2.0, 0.0],
    [-18.0, 7.0, 5.2, 6.2, 2.0, 0.0],
    [-19.8, 11.0, 5.6, 7.2, 2.1, 0.0],
    [-21.5, 15.0, 6.3, 8.0, 2.3, 0.0],
    [-23.5, 17.0, 7.2, 8.6, 2.5, 0.0],
    [-28.0, 17.0, 8.2, 9.2, 2.6, 0.5],
    [-33.0, 16.2, 8.8, 9.4, 2.5, 1.6],
    [-39.0, 15.2, 9.0, 9.0, 2.4, 2.5],
    [-44.5, 13.8, 8.8, 8.2, 2.3, 1.3],
    [-50.0, 12.4, 8.2, 7.4, 2.2, 0.1],
    [-57.0, 11.6, 7.8, 7.0, 2.2, 0.0],
    [-64.0, 13.6, 8.8, 8.4, 2.2, 0.0],
    [-72.0, 16.2, 9.4, 10.6, 2.3, 0.0],
    [-77.0, 17.0, 9.4, 11.4, 2.3, 0.0],
    [-86.0, 16.4, 9.0, 10.6, 2.3, 0.0],
];

/// Distance between the rows of a figure's table, cm.
const STEP: f32 = 0.25;

/// A torso of given girths.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// Rows at even steps from the neck down, scaled to the measures.
    rows: Vec<Row>,
}

impl Figure {
    /// A torso with these girths (cm) at [`BUST`], [`WAIST`] and [`HIP`].
    pub fn new(bust: f32, waist: f32, hip: f32) -> Self {
        let columns: Vec<Spline> = (1..6).map(|c| Spline::new(ROWS.iter().map(|r| (-r[0], r[c])).collect())).collect();
        let row = |y: f32| -> Row {
            let mut row = [y; 6];
            row[1..].iter_mut().zip(&columns).for_each(|(value, spline)| *value = spline.at(-y));
            row[5] = row[5].max(0.0);
            row
        };
        let of = |girth: f32, at: f32| girth / tape(&row(at));
        let (bust, waist, hip) = (of(bust, BUST), of(waist, WAIST), of(hip, HIP));
        // Neck and shoulders follow the bust a little.
        let top = 1.0 + 0.35 * (bust - 1.0);
        let knots = [(13.0, top), (24.0, top), (-BUST, bust), (-WAIST, waist), (-HIP, hip), (86.0, hip)];
        let scale = Spline::new(knots.to_vec());
        let count = ((ROWS[0][0] - ROWS[ROWS.len() - 1][0]) / STEP) as usize;
        let scaled = |i: usize| {
            let y = ROWS[0][0] - STEP * i as f32;
            let (mut row, by) = (row(y), scale.at(-y));
            [1, 2, 3, 5].into_iter().for_each(|c| row[c] *= by);
            row
        };
        Self { rows: (0..=count).map(scaled).collect() }
    }

    /// A place of its surface: at a height, and an angle from the front (0) over the left (a quarter turn) to the back.
    /// `ease` is added all around, cm.
    pub fn place(&self, height: f32, angle: f32, ease: f32) -> Vec3 {
        let p = section(&self.row(height), angle);
        let p = p * (1.0 + ease / p.length().max(1e-6));
        Vec3::new(p.x, height, AXIS + p.y)
    }

    fn row(&self, height: f32) -> Row {
        let at = ((ROWS[0][0] - height) / STEP).clamp(0.0, (self.rows.len() - 1) as f32);
        let (a, b) = (self.rows[at as usize], self.rows[(at as usize + 1).min(self.rows.len() - 1)]);
        let part = at - at.floor();
        std::array::from_fn(|c| a[c] + (b[c] - a[c]) * part)
    }
}

/// The outline of a row at an angle from the front: (x, z) from the axis.
fn section(&[_, wide, front, back, exponent, breast]: &Row, angle: f32) -> Vec2 {
    let (s, c) = (trig::sin(angle), trig::cos(angle));
    let round = |v: f32| v.signum() * trig::pow(v.abs(), 2.0 / exponent);
    let x = wide * round(s);
    let mut z = if c >= 0.0 { front } else { back } * round(c);
    if c > 0.0 && breast > 0.0 {
        // Widths of the breasts go with the width of the torso.
        let off = (x.abs() / wide - 0.48) / 0.36;
        z += breast * trig::exp(-off * off) * trig::smoothstep(0.0, 0.5, c);
    }
    Vec2::new(x, z)
}

/// The girth of a row as a tape measure reads it, cm.
fn tape(row: &Row) -> f32 {
    const POINTS: usize = 720;
    let points = (0..POINTS).map(|i| section(row, TAU * i as f32 / POINTS as f32));
    slice::around(&slice::hull(points))
}

/// A natural cubic spline: twice continuous, straight beyond its ends.
pub struct Spline {
    knots: Vec<(f32, f32)>,
    /// Second derivatives at the knots.
    bends: Vec<f32>,
}

impl Spline {
    /// Through knots with ascending places, two or more.
    pub fn new(knots: Vec<(f32, f32)>) -> Self {
        let n = knots.len();
        let gap = |i: usize| knots[i + 1].0 - knots[i].0;
        let slope = |i: usize| (knots[i + 1].1 - knots[i].1) / gap(i);
        // The tridiagonal system of the second derivatives, by elimination.
        let (mut above, mut bends) = (vec![0.0; n], vec![0.0; n]);
        for i in 1..n - 1 {
            let pivot = 2.0 * (gap(i - 1) + gap(i)) - gap(i - 1) * above[i - 1];
            above[i] = gap(i) / pivot;
            bends[i] = (6.0 * (slope(i) - slope(i - 1)) - gap(i - 1) * bends[i - 1]) / pivot;
        }
        for i in (1..n - 1).rev() {
            bends[i] -= above[i] * bends[i + 1];
        }
        Self { knots, bends }
    }

    /// The value at a place.
    pub fn at(&self, x: f32) -> f32 {
        let last = self.knots.len() - 1;
        let i = self.knots[1..last].iter().take_while(|k| k.0 <= x).count();
        let ((x0, y0), (x1, y1)) = (self.knots[i], self.knots[i + 1]);
        let (h, x) = (x1 - x0, x.clamp(self.knots[0].0, self.knots[last].0));
        let (a, b) = ((x1 - x) / h, (x - x0) / h);
        a * y0 + b * y1 + ((a * a * a - a) * self.bends[i] + (b * b * b - b) * self.bends[i + 1]) * (h * h / 6.0)
    }
}

/// Angles of `count` columns around a section, from the back over the right, the front and the left to the back again;
/// the last repeats the first, for the seam in the texture.
pub fn angles(count: usize) -> Vec<f32> {
    (0..=count).map(|i| if i == count { PI } else { -PI + TAU * i as f32 / count as f32 }).collect()
}
