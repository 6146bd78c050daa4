//! Shirts and dresses: a torso with armholes, sleeves sewn into them.

use std::f32::consts::TAU;

use glam::Vec3;

use super::figure::{AXIS, BUST, Figure, HIP, WAIST, angles};
use super::loft::{Loft, turned_in};
use super::skirt::{SkirtOptions, drape};
use super::{Garment, Tape};
use crate::geometry::slice::Side;
use crate::math::trig;
use crate::params::Angle;

/// Columns around the torso.
const COLUMNS: usize = 144;
/// Columns of an armhole, to each side of the middle of the arm.
const HALF_HOLE: usize = 14;
/// Height of the neckline at the sides of the neck, cm.
const NECK: f32 = -17.6;
/// Heights of an armhole's top and bottom, cm.
const HOLE: (f32, f32) = (-21.6, -36.0);
/// Rows of a torso above the armpit.
const ROWS: usize = 30;

crate::params! {
    /// A shirt with sleeves.
    #[derive(PartialEq)]
    pub struct ShirtOptions("coif.garment.shirt") {
        /// Girth around the bust.
        bust: f32 = 88.0, unit("cm"), range(50.0, 200.0);
        /// Girth around the waist.
        waist: f32 = 66.0, unit("cm"), range(40.0, 200.0);
        /// Girth around the hip.
        hip: f32 = 92.0, unit("cm"), range(50.0, 200.0);
        /// From the neck to the hem.
        length: f32 = 63.0, unit("cm"), range(40.0, 90.0);
        /// Length of the sleeves; 0 leaves them out.
        sleeves: f32 = 24.0, unit("cm"), range(0.0, 62.0);
        /// How far the sleeves stand off the body.
        spread: Angle = Angle::degrees(38.0), range(15.0, 85.0);
        /// How low the neckline is cut in front.
        neckline: f32 = 4.5, unit("cm"), range(0.0, 16.0);
    }
}

crate::params! {
    /// A sleeveless dress: a close bodice, and a skirt that falls in folds.
    #[derive(PartialEq)]
    pub struct DressOptions("coif.garment.dress") {
        /// Girth around the bust.
        bust: f32 = 84.0, unit("cm"), range(50.0, 200.0);
        /// Girth around the waist.
        waist: f32 = 57.0, unit("cm"), range(40.0, 200.0);
        /// Girth around the hip.
        hip: f32 = 90.0, unit("cm"), range(50.0, 250.0);
        /// Girth of the hem, as a tape around its folds reads it.
        hem: f32 = 210.0, unit("cm"), range(50.0, 800.0);
        /// From the waist to the hem.
        length: f32 = 56.0, unit("cm"), range(20.0, 98.0);
        /// How many folds; 0 for none.
        folds: u32 = 14, range(0.0, 60.0);
        /// How deep the folds are at the hem.
        fold_depth: f32 = 3.5, unit("cm"), range(0.0, 20.0);
        /// How low the neckline is cut in front.
        neckline: f32 = 8.0, unit("cm"), range(0.0, 16.0);
    }
}

impl ShirtOptions {
    /// The shirt.
    pub fn build(&self) -> Garment {
        let figure = Figure::new(self.bust, self.waist, self.hip);
        let mut loft = Loft::default();
        let sleeve = (self.sleeves > 0.0).then_some((self.sleeves, self.spread.radians));
        let bottom = NECK - self.length;
        torso(&mut loft, &figure, self.neckline, bottom, sleeve, true);
        Garment { kind: "shirt".into(), mesh: loft.finish(), tapes: tapes(bottom) }
    }
}

impl DressOptions {
    /// The dress.
    pub fn build(&self) -> Garment {
        let figure = Figure::new(self.bust, self.waist, self.hip);
        let mut loft = Loft::default();
        torso(&mut loft, &figure, self.neckline, WAIST, None, false);
        let cut = SkirtOptions {
            waist: self.waist,
            hip: self.hip,
            hem: self.hem,
            length: self.length,
            folds: self.folds,
            fold_depth: self.fold_depth,
        };
        loft.sheet("skirt", &drape(&figure, WAIST, self.length, &cut, 0.0), |_, _| true);
        Garment { kind: "dress".into(), mesh: loft.finish(), tapes: tapes(WAIST - self.length) }
    }
}

fn tapes(bottom: f32) -> Vec<Tape> {
    let parts = ["bust", "waist", "hip", "skirt"].map(String::from).to_vec();
    let at = |name: &str, height: f32| Tape { name: name.into(), height, side: Side::Middle, parts: parts.clone() };
    let mut tapes = vec![at("bust", BUST), at("waist", WAIST)];
    if bottom < HIP - 1.0 {
        tapes.push(at("hip", HIP));
    }
    tapes
}

/// The parts of a torso by height, from above: name and lower end, cm.
const PARTS: [(&str, f32); 3] = [("bust", -48.0), ("waist", -67.0), ("hip", f32::NEG_INFINITY)];

/// A torso from the neckline to `bottom`, with armholes, and sleeves (length, angle) in them.
fn torso(loft: &mut Loft, figure: &Figure, neckline: f32, bottom: f32, sleeve: Option<(f32, f32)>, has_hem: bool) {
    // Rows: evenly to the armpit with the armhole's ends on rows, then evenly to the hem.
    let hole_rows = (8, ROWS);
    let mut heights: Vec<f32> =
        (0..hole_rows.0).map(|r| NECK + (HOLE.0 - NECK) * r as f32 / hole_rows.0 as f32).collect();
    let down = (hole_rows.1 - hole_rows.0) as f32;
    heights.extend((0..hole_rows.1 - hole_rows.0).map(|r| HOLE.0 + (HOLE.1 - HOLE.0) * r as f32 / down));
    let below = ((HOLE.1 - bottom) / 0.9).ceil().max(1.0) as usize;
    heights.extend((0..=below).map(|r| HOLE.1 + (bottom - HOLE.1) * r as f32 / below as f32));
    let rows: Vec<Vec<Vec3>> = heights
        .iter()
        .map(|&y| {
            // The neckline dips in front; rows below it dip less and less, down to the bust.
            let dip = neckline * (1.0 - trig::smoothstep(NECK, BUST + 4.0, y));
            let mut ring: Vec<Vec3> = angles(COLUMNS)
                .into_iter()
                .map(|a| {
                    let c = trig::cos(a);
                    let front = if c > 0.0 { c * c * c } else { 0.12 * c * c };
                    let lower = y - dip * front;
                    figure.place(lower, a, 0.6 * trig::smoothstep(BUST, NECK, y))
                })
                .collect();
            ring[COLUMNS] = ring[0];
            ring
        })
        .collect();
    let middles = [COLUMNS / 4, 3 * COLUMNS / 4];
    let in_hole = |r: usize, c: usize| {
        (hole_rows.0..hole_rows.1).contains(&r) && middles.iter().any(|&m| (m - HALF_HOLE..m + HALF_HOLE).contains(&c))
    };
    // The hole is rounded: its outline is drawn in towards an ellipse.
    let rows = rounded(rows, hole_rows, &middles);
    for (i, &(name, low)) in PARTS.iter().enumerate() {
        let high = if i == 0 { f32::INFINITY } else { PARTS[i - 1].1 };
        let is_here = |r: usize| {
            let y = 0.5 * (heights[r] + heights[r + 1]);
            y < high && y >= low
        };
        let Some(first) = (0..rows.len() - 1).find(|&r| is_here(r)) else { continue };
        let last = (first..rows.len() - 1).take_while(|&r| is_here(r)).last().unwrap_or(first);
        loft.sheet(name, &rows[first..=last + 1], |r, c| !in_hole(first + r, c));
    }
    if has_hem {
        let n = rows.len();
        loft.sheet(
            if bottom < PARTS[1].1 { "hip" } else { "waist" },
            &turned_in(&rows[n - 2], &rows[n - 1], 1.6),
            |_, _| true,
        );
    }
    // A narrow band around the neck.
    let up: Vec<Vec3> = rows[0].iter().zip(&rows[1]).map(|(a, b)| *a + (*a - *b).normalize_or_zero() * 0.9).collect();
    let mut band: Vec<Vec<Vec3>> = turned_in(&rows[0], &up, 1.2).into_iter().rev().collect();
    band.push(rows[0].clone());
    loft.sheet("collar", &band, |_, _| true);
    for (side, &m) in middles.iter().enumerate() {
        let edge = outline(&rows, hole_rows, (m - HALF_HOLE, m + HALF_HOLE));
        let sign = if side == 0 { -1.0 } else { 1.0 };
        match sleeve {
            Some((length, spread)) => {
                let name = if sign > 0.0 { "left_sleeve" } else { "right_sleeve" };
                loft.sheet(name, &sleeve_rings(&edge, sign, length, spread), |_, _| true);
            }
            None => {
                let outside: Vec<Vec3> = edge.iter().map(|p| *p + Vec3::X * (-0.6 * sign)).collect();
                loft.sheet("armholes", &turned_in(&outside, &edge, 1.0), |_, _| true);
            }
        }
    }
}

/// The rows with the corners of the armholes rounded off: columns within a hole's height are drawn apart.
fn rounded(mut rows: Vec<Vec<Vec3>>, (top, bottom): (usize, usize), middles: &[usize]) -> Vec<Vec<Vec3>> {
    let source = rows.clone();
    let middle = 0.5 * (top + bottom) as f32;
    let half = 0.5 * (bottom - top) as f32;
    let reach = 10.0;
    for (r, row) in rows.iter_mut().enumerate() {
        let v = ((r as f32 - middle) / half).abs();
        // How wide the hole is in this row, as a part of its greatest width.
        let want = if v < 1.0 { 0.45 + 0.55 * trig::pow(1.0 - trig::pow(v, 2.6), 0.5) } else { 0.45 };
        let fade = 1.0 - trig::smoothstep(1.0, 1.0 + 5.0 / half, v);
        for &m in middles {
            for off in -(HALF_HOLE as i32) - reach as i32..=HALF_HOLE as i32 + reach as i32 {
                let u = off.abs() as f32;
                // Columns of the hole are drawn together, those beside it drawn after.
                let inside = HALF_HOLE as f32;
                let to = if u <= inside {
                    u * want
                } else {
                    inside * want + (u - inside) * (reach + inside * (1.0 - want)) / reach
                };
                let to = u + (to - u) * fade;
                let at = m as f32 + to * (off.signum() as f32);
                let (lo, part) = (at.floor() as usize, at - at.floor());
                row[(m as i32 + off) as usize] = source[r][lo].lerp(source[r][lo + 1], part);
            }
        }
    }
    rows
}

/// The border of an armhole from the middle of its lower edge around; the last point repeats the first.
fn outline(rows: &[Vec<Vec3>], (top, bottom): (usize, usize), (left, right): (usize, usize)) -> Vec<Vec3> {
    let middle = (left + right) / 2;
    let mut edge: Vec<Vec3> = (middle..right).map(|c| rows[bottom][c]).collect();
    edge.extend((top + 1..=bottom).rev().map(|r| rows[r][right]));
    edge.extend((left + 1..=right).rev().map(|c| rows[top][c]));
    edge.extend((top..bottom).map(|r| rows[r][left]));
    edge.extend((left..=middle).map(|c| rows[bottom][c]));
    edge
}

/// Rings of a sleeve from the border of its armhole to the cuff and its turned-in edge.
fn sleeve_rings(edge: &[Vec3], sign: f32, length: f32, spread: f32) -> Vec<Vec<Vec3>> {
    let n = edge.len() - 1;
    let along = Vec3::new(sign * trig::sin(spread), -trig::cos(spread), 0.02).normalize();
    let shoulder = Vec3::new(sign * 15.6, -26.6, AXIS - 0.2);
    // Around the arm: from below over the front to above, as the border runs.
    let across = Vec3::Z;
    let under = along.cross(across) * sign;
    let mut run = vec![0.0];
    for i in 0..n {
        run.push(run[i] + edge[i].distance(edge[i + 1]));
    }
    let angle = |i: usize| TAU * run[i] / run[n];
    let turns_front = edge[n / 4].z > edge[0].z;
    let rows = ((length / 1.0) as usize).max(8);
    let mut rings = vec![edge.to_vec()];
    for r in 1..=rows {
        let t = r as f32 / rows as f32;
        let s = t * length;
        // From the armhole to the cuff the sleeve narrows; near the armhole it takes on the border's shape.
        let (high, deep) = (7.4 - 2.2 * t * (length / 60.0).max(0.35), 6.6 - 1.8 * t * (length / 60.0).max(0.35));
        let blend = trig::smoothstep(0.0, 11.0_f32.min(0.8 * length), s);
        let middle = shoulder + along * s + along * 1.5;
        let mut ring: Vec<Vec3> = (0..n)
            .map(|i| {
                let a = angle(i);
                let (below, beside) = (trig::cos(a), trig::sin(a) * if turns_front { 1.0 } else { -1.0 });
                // Cloth gathers in the bend under the arm.
                let crease = 0.28 * trig::cos(s * 0.9 + 1.2 * beside) * trig::smoothstep(0.0, 6.0, s) * (1.0 - 0.5 * t);
                let round = middle + under * (below * (high + crease)) + across * (beside * (deep + crease));
                // On the shoulder the cloth goes on outwards before it falls.
                let over = along.lerp(Vec3::new(0.94 * sign, -0.34, 0.0), 0.5 - 0.5 * below);
                let near = edge[i] + over * s;
                near.lerp(round, blend)
            })
            .collect();
        ring.push(ring[0]);
        rings.push(ring);
    }
    let cuff = turned_in(&rings[rows - 1], &rings[rows], 1.4);
    rings.extend(cuff.into_iter().skip(1));
    rings
}
