//! Skirts.

use std::f32::consts::TAU;

use glam::Vec3;

use super::figure::{AXIS, Figure, HIP, WAIST, angles};
use super::loft::{Loft, turned_in};
use super::{Garment, Tape};
use crate::geometry::slice::{Side, around, hull};
use crate::math::trig;

/// Columns around.
const COLUMNS: usize = 144;
/// Height of the waistband, cm.
const BAND: f32 = 3.2;

crate::params! {
    /// A skirt with a waistband.
    #[derive(PartialEq)]
    pub struct SkirtOptions("coif.garment.skirt") {
        /// Girth of the waistband.
        waist: f32 = 57.0, unit("cm"), range(30.0, 200.0);
        /// Girth around the hip.
        hip: f32 = 88.0, unit("cm"), range(40.0, 250.0);
        /// Girth of the hem, as a tape around its folds reads it.
        hem: f32 = 170.0, unit("cm"), range(40.0, 800.0);
        /// From the waist to the hem.
        length: f32 = 58.0, unit("cm"), range(15.0, 110.0);
        /// How many folds; 0 for none.
        folds: u32 = 13, range(0.0, 60.0);
        /// How deep the folds are at the hem.
        fold_depth: f32 = 3.2, unit("cm"), range(0.0, 20.0);
    }
}

impl SkirtOptions {
    /// The skirt.
    pub fn build(&self) -> Garment {
        let mut loft = Loft::default();
        let figure = Figure::new(86.0, self.waist, self.hip);
        let top = WAIST + 0.5 * BAND;
        // The band: level cloth of its own, a little outside the skirt.
        let band: Vec<Vec<Vec3>> = [0.0, 0.15, 0.5, 0.85, 1.0]
            .iter()
            .map(|u| ring(|a| figure.place(WAIST, a, 0.0).with_y(top - BAND * u)))
            .collect();
        let inner = turned_in(&band[1], &band[0], 1.5);
        let mut rows: Vec<Vec<Vec3>> = inner.into_iter().rev().collect();
        rows.extend(band.into_iter().skip(1));
        let low = rows.last().cloned().unwrap_or_default();
        rows.push(low.iter().map(|p| toward(*p, 0.2) - Vec3::Y * 0.12).collect());
        loft.sheet("waistband", &rows, |_, _| true);
        loft.sheet("skirt", &drape(&figure, top - BAND, self.length - 0.5 * BAND, self, 0.25), |_, _| true);
        let tape = |name: &str, height: f32| Tape { name: name.into(), height, side: Side::Middle, parts: vec![] };
        let mut tapes = vec![tape("waist", WAIST)];
        if self.length > WAIST - HIP + 4.0 {
            tapes.push(tape("hip", HIP));
        }
        Garment { kind: "skirt".into(), mesh: loft.finish(), tapes }
    }
}

/// A place moved towards the axis by so much, cm.
fn toward(p: Vec3, by: f32) -> Vec3 {
    let out = Vec3::new(p.x, 0.0, p.z - AXIS);
    p - out.normalize_or_zero() * by
}

/// A ring of places by angle.
pub fn ring(place: impl Fn(f32) -> Vec3) -> Vec<Vec3> {
    let mut ring: Vec<Vec3> = angles(COLUMNS).into_iter().map(place).collect();
    // The seam is closed to the bit.
    ring[COLUMNS] = ring[0];
    ring
}

/// Rings of cloth that falls from a height: close to the figure down to the hip, then freely, wider and in folds. The
/// last rings are the turned-in hem.
pub fn drape(figure: &Figure, from: f32, length: f32, cut: &SkirtOptions, inside: f32) -> Vec<Vec<Vec3>> {
    let rows = ((length / 1.1) as usize).max(12);
    let hem = from - length;
    // How much of the way from close cloth to the hem's circle, by height. It leaves the figure above the hip.
    let leave = from - 0.12 * length.min(40.0);
    let free = |y: f32| trig::pow(((leave - y) / (leave - hem)).clamp(0.0, 1.0), 1.15);
    let folds =
        |y: f32| trig::smoothstep(0.0, 1.0, ((from - 3.0 - y) / (from - 3.0 - hem)).clamp(0.0, 1.0)) * cut.fold_depth;
    let wave = |a: f32| {
        if cut.folds == 0 {
            return 0.0;
        }
        // Uneven folds, the same on both sides.
        let k = cut.folds as f32;
        let w = trig::cos(k * a + 0.55 * trig::sin(2.0 * a) + 0.4 * trig::sin(3.0 * a));
        0.8 * w + 0.2 * w * w * w
    };
    let shape = |y: f32, wide: f32| -> Vec<Vec3> {
        ring(|a| {
            let close = figure.place(y.max(HIP), a, -inside).with_y(y);
            let circle = Vec3::new(wide * 1.06 * trig::sin(a), y, AXIS + wide * 0.94 * trig::cos(a));
            let p = close.lerp(circle, free(y));
            let out = Vec3::new(p.x, 0.0, p.z - AXIS).normalize_or_zero();
            // Cloth that stands out in a fold falls a little lower.
            let fold = wave(a) * folds(y);
            p + out * fold - Vec3::Y * (0.22 * fold * free(y))
        })
    };
    // The circle whose folded hem has the tape girth asked for.
    let tape = |ring: &[Vec3]| around(&hull(ring.iter().map(|p| glam::Vec2::new(p.x, p.z))));
    let mut wide = cut.hem / TAU;
    for _ in 0..30 {
        wide += (cut.hem - tape(&shape(hem, wide))) / TAU;
        wide = wide.max(1.0);
    }
    let mut rings: Vec<Vec<Vec3>> = (0..=rows).map(|r| shape(from - length * r as f32 / rows as f32, wide)).collect();
    let hem_rings = turned_in(&rings[rows - 1], &rings[rows], 2.0);
    rings.extend(hem_rings.into_iter().skip(1));
    rings
}
