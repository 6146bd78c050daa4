//! Trousers.

use std::f32::consts::TAU;

use glam::Vec3;

use super::figure::{AXIS, FORK, Figure, HIP, Spline, WAIST};
use super::loft::{Loft, turned_in};
use super::skirt::ring;
use super::{Garment, Tape};
use crate::geometry::slice::Side;
use crate::math::trig;

/// Height of the waistband, cm.
const BAND: f32 = 3.5;
/// Columns of the seam between the legs.
const SEAM: usize = 24;

crate::params! {
    /// Trousers with a waistband.
    #[derive(PartialEq)]
    pub struct TrousersOptions("coif.garment.trousers") {
        /// Girth of the waistband.
        waist: f32 = 62.0, unit("cm"), range(40.0, 200.0);
        /// Girth around the hip.
        hip: f32 = 92.0, unit("cm"), range(50.0, 200.0);
        /// Girth of a leg at its hem.
        hem: f32 = 38.0, unit("cm"), range(20.0, 120.0);
        /// Girth of a leg at the knee.
        knee: f32 = 42.0, unit("cm"), range(25.0, 120.0);
        /// From the waist to the hem.
        length: f32 = 96.0, unit("cm"), range(38.0, 105.0);
    }
}

impl TrousersOptions {
    /// The trousers.
    pub fn build(&self) -> Garment {
        let figure = Figure::new(86.0, self.waist, self.hip);
        let mut loft = Loft::default();
        let top = WAIST + 0.5 * BAND;
        let band: Vec<Vec<Vec3>> = [0.0, 0.15, 0.5, 0.85, 1.0]
            .iter()
            .map(|u| ring(|a| figure.place(WAIST, a, 0.0).with_y(top - BAND * u)))
            .collect();
        let mut rows: Vec<Vec<Vec3>> = turned_in(&band[1], &band[0], 1.5).into_iter().rev().collect();
        rows.extend(band.into_iter().skip(1));
        loft.sheet("waistband", &rows, |_, _| true);
        let from = top - BAND;
        let count = 30;
        let sewn = rows[rows.len() - 1].clone();
        let mut hips: Vec<Vec<Vec3>> = (0..=count)
            .map(|r| {
                let y = from + (FORK - from) * r as f32 / count as f32;
                ring(|a| figure.place(y, a, 0.0))
            })
            .collect();
        hips[0] = sewn;
        loft.sheet("hip", &hips, |_, _| true);
        let fork = &hips[count];
        for sign in [1.0, -1.0] {
            let name = if sign > 0.0 { "left_leg" } else { "right_leg" };
            loft.sheet(name, &self.leg(fork, sign), |_, _| true);
        }
        let around = |name: &str, height: f32, side: Side, parts: &[&str]| Tape {
            name: name.into(),
            height,
            side,
            parts: parts.iter().map(ToString::to_string).collect(),
        };
        let trunk = ["waistband", "hip"];
        let mut tapes = vec![around("waist", WAIST, Side::Middle, &trunk), around("hip", HIP, Side::Middle, &trunk)];
        if self.length > 60.0 {
            tapes.push(around("left_knee", -111.0, Side::Middle, &["left_leg"]));
            tapes.push(around("right_knee", -111.0, Side::Middle, &["right_leg"]));
        }
        Garment { kind: "trousers".into(), mesh: loft.finish(), tapes }
    }

    /// Rings of one leg, from the fork to the hem.
    fn leg(&self, fork: &[Vec3], sign: f32) -> Vec<Vec<Vec3>> {
        let columns = fork.len() - 1;
        // The half of the fork's ring on this side, from front to back on the left and from back to front on the right,
        // then the seam between the legs back to where it began.
        let half: Vec<Vec3> = if sign > 0.0 { fork[columns / 2..].to_vec() } else { fork[..=columns / 2].to_vec() };
        let (first, last) = (half[0], half[half.len() - 1]);
        let outer = half.len() - 1;
        let mut edge = half;
        edge.extend((1..=SEAM).map(|i| {
            let u = i as f32 / SEAM as f32;
            let p = last.lerp(first, u);
            // The seam hangs a little.
            if i == SEAM { first } else { p - Vec3::Y * (2.6 * trig::sin(std::f32::consts::PI * u)) }
        }));
        let n = edge.len() - 1;
        let mut run = vec![0.0];
        for i in 0..n {
            run.push(run[i] + edge[i].distance(edge[i + 1]));
        }
        // The outer half takes more than half of the way around: both ends lie on the inner side.
        let shift = 0.5 * (TAU * run[outer] / run[n] - std::f32::consts::PI);
        let bottom = WAIST - self.length;
        let height = FORK - bottom;
        let rows = ((height / 1.3) as usize).max(8);
        let knee = -111.0_f32.max(bottom + 4.0);
        let thigh = 0.61 * self.hip;
        let girths = Spline::new(vec![(-FORK, thigh), (-knee, self.knee), (-bottom.min(knee - 1.0), self.hem)]);
        let mut rings = vec![edge.clone()];
        for r in 1..=rows {
            let y = FORK - height * r as f32 / rows as f32;
            let girth = girths.at(-y);
            let blend = trig::smoothstep(0.0, 1.0, ((FORK - y) / 22.0).clamp(0.0, 1.0));
            let t = (FORK - y) / 75.0;
            let middle = Vec3::new(sign * (0.505 * self.hip / TAU * 1.18 + 0.3 * t), y, AXIS - 1.0 * t);
            let radius = girth / TAU;
            let mut ring: Vec<Vec3> = (0..n)
                .map(|i| {
                    // From the front over the outer side to the back, and back along the inner side.
                    let a = TAU * run[i] / run[n];
                    let begin = if sign > 0.0 { 0.0 } else { std::f32::consts::PI };
                    let a = begin + a - shift;
                    let drape = 0.25 * trig::cos(0.35 * y + 2.0 * a) * trig::smoothstep(0.3, 1.0, t);
                    let round = middle + Vec3::new(trig::sin(a), 0.0, trig::cos(a) * 1.04) * (radius + drape);
                    edge[i].with_y(edge[i].y - FORK + y).lerp(round, blend)
                })
                .collect();
            ring.push(ring[0]);
            rings.push(ring);
        }
        let hem = turned_in(&rings[rows - 1], &rings[rows], 2.0);
        rings.extend(hem.into_iter().skip(1));
        rings
    }
}
