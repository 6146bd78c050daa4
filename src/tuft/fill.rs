//! Tufts between tufts (Shimosoyama, Yamamoto, Noma 2015, section 4).
//!
//! Numbers in brackets are the paper's equations; `docs/methods/tufts.md` lists every departure.

use std::f32::consts::{FRAC_PI_2, PI, TAU};

use glam::{Quat, Vec3};

use super::{Ground, Section, Stroke, Tuft, TuftError, azimuth_elevation, toward};
use crate::math::{rng::Key, trig};
use crate::task::{Warned, Warning};

/// The constant k of (3), which the paper leaves open: tufts per cm of distance at density 100, on a head of scale 1.
/// At the greatest density neighbouring roots lie about 1 cm apart, at density 10 about 10 cm.
pub const TUFTS_PER_CM: f32 = 1.0;

/// Greatest jitter of a root's azimuth and elevation (section 4.3).
pub const JITTER: f32 = PI / 20.0;

crate::params! {
    /// More tufts between given ones: around the head, and in rows towards crown and neck.
    pub struct FillOptions("coif.fill") {
        /// Density from tuft to tuft.
        around: f32 = 50.0, range(1.0, 100.0);
        /// Density of rows towards the crown; none when left out.
        up: Option<f32>, range(1.0, 100.0);
        /// Density of rows towards the neck; none when left out.
        down: Option<f32>, range(1.0, 100.0);
        /// How far roots are strewn: 1 is up to 9 degrees in azimuth and elevation.
        jitter: f32 = 0.0, range(0.0, 1.0);
        /// Another number strews the roots otherwise.
        seed: u64 = 0;
        /// Also where hair does not grow: on the face and low on the neck.
        everywhere: bool = false;
    }
}

impl Default for FillOptions {
    fn default() -> Self {
        Self { around: 50.0, up: None, down: None, jitter: 0.0, seed: 0, everywhere: false }
    }
}

/// True where roots may lie (8): not on the face, not low on the neck. Radians, azimuth as in [`azimuth_elevation`].
pub fn grows_hair(azimuth: f32, elevation: f32) -> bool {
    let faces = azimuth > -5.0 * PI / 6.0 && azimuth < -PI / 6.0;
    elevation > if faces { 0.0 } else { -PI / 3.0 }
}

/// How far B lies from A about the head: (alpha, beta, e) by (1) and (2). `full` goes all the way around; beta is
/// signed, B's elevation less A's; e is in the unit of the vectors, which are measured from the reference point.
pub fn distance_around(a: Vec3, b: Vec3, full: bool) -> (f32, f32, f32) {
    let ((az_a, el_a), (az_b, el_b)) = (azimuth_elevation(a), azimuth_elevation(b));
    let alpha = if full { TAU } else { (az_b - az_a).rem_euclid(TAU) };
    let beta = el_b - el_a;
    let angle = trig::acos(trig::cos(beta) * trig::cos(alpha));
    let gamma = if alpha > PI { TAU - angle } else { angle };
    (alpha, beta, 0.5 * (a.length() + b.length()) * gamma)
}

/// N of (3) for a distance `e` in cm.
pub fn count_around(density: f32, e: f32, scale: f32) -> usize {
    // A hundred-thousandth of slack: a distance that is whole but for rounding counts as whole.
    (density / 100.0 * TUFTS_PER_CM * e / scale + 1e-5).floor().max(0.0) as usize
}

/// The step in elevation between rows (7), radians.
pub fn row_step(density: f32) -> f32 {
    FRAC_PI_2 - 9.0 / 20.0 * PI * density / 100.0
}

/// The tufts between `tufts`, without these themselves: first those around, then the rows towards the crown, then those
/// towards the neck, each in the order of their parents.
///
/// All roots lie on the head's surface. Nothing is checked for running through the head: see [`super::dip`].
///
/// # Errors
/// No tufts, different numbers of control points or kinds of section, densities out of 1..=100, a region that leaves no
/// root.
pub fn fill(tufts: &[Tuft], options: &FillOptions, ground: &Ground) -> Result<Warned<Vec<Tuft>>, TuftError> {
    check(tufts, options)?;
    let key = Key::new(options.seed, "tuft fill");
    let mut maker = Maker { options, ground, key, candidates: 0 };

    // Around: parents are the given tufts and those between them
    let mut parents: Vec<Tuft> = vec![tufts[0].clone()];
    let mut made: Vec<Tuft> = Vec::new();
    let pairs: Vec<(&Tuft, &Tuft)> = if tufts.len() == 1 {
        vec![(&tufts[0], &tufts[0])]
    } else {
        tufts.windows(2).map(|w| (&w[0], &w[1])).collect()
    };
    for (p, &(a, b)) in pairs.iter().enumerate() {
        let full = a.stroke == b.stroke;
        for w in maker.between(a, b, full, p)? {
            // A parent that the region refuses still has rows, as a given tuft would.
            made.extend(maker.admit(&w));
            parents.push(w);
        }
        if !full {
            parents.push(b.clone());
        }
    }

    // Rows
    for (density, sign, row_key) in [(options.up, 1.0, 1_u64), (options.down, -1.0, 2)] {
        let Some(density) = density else { continue };
        let step = row_step(density) * sign;
        for (o, parent) in parents.iter().enumerate() {
            let (_, elevation) = azimuth_elevation(parent.stroke.root() - ground.reference);
            for y in 1_u64.. {
                // At the pole itself all tufts of a row would share one root.
                if (elevation + step * y as f32).abs() >= FRAC_PI_2 - 1e-3 {
                    break;
                }
                let row = maker.tilted(parent, step * y as f32, key.with(row_key).with(o as u64).with(y))?;
                made.extend(maker.admit(&row));
            }
        }
    }

    let mut warnings = Vec::new();
    if made.is_empty() {
        if maker.candidates > 0 {
            return Err(TuftError::NoRoot { candidates: maker.candidates });
        }
        let hint = "raise `around`, or give `up` or `down` for rows";
        warnings.push(Warning::new("the tufts are too close together for the fill to add any").hint(hint));
    }
    Ok(Warned { value: made, warnings })
}

fn check(tufts: &[Tuft], options: &FillOptions) -> Result<(), TuftError> {
    if tufts.is_empty() {
        return Err(TuftError::NoTufts);
    }
    for (i, w) in tufts.windows(2).enumerate() {
        let (before, count) = (w[0].stroke.points().len(), w[1].stroke.points().len());
        if before != count {
            return Err(TuftError::PointCounts { number: i + 2, count, before });
        }
        let (before, kind) = (w[0].section.kind(), w[1].section.kind());
        if before != kind {
            return Err(TuftError::SectionKinds { number: i + 2, kind, before });
        }
    }
    TuftError::check("around", options.around, 1.0, 100.0)?;
    for (what, density) in [("up", options.up), ("down", options.down)] {
        if let Some(density) = density {
            TuftError::check(what, density, 1.0, 100.0)?;
        }
    }
    TuftError::check("jitter", options.jitter, 0.0, 1.0)?;
    Ok(())
}

struct Maker<'a> {
    options: &'a FillOptions,
    ground: &'a Ground<'a>,
    key: Key,
    /// Roots tried, for the message when none is left.
    candidates: usize,
}

impl Maker<'_> {
    /// The N tufts between A and B; `pair` tells the pairs of a chain apart.
    fn between(&self, a: &Tuft, b: &Tuft, full: bool, pair: usize) -> Result<Vec<Tuft>, TuftError> {
        let h = self.ground.reference;
        let (pa, pb) = (a.stroke.points(), b.stroke.points());
        let (a1, b1) = (pa[0] - h, pb[0] - h);
        let (alpha, beta, e) = distance_around(a1, b1, full);
        let n = count_around(self.options.around, e, self.ground.scale);
        let share = |l: usize| l as f32 / (n + 1) as f32;

        // (4), and for every other number of the section alike
        let mut sections: Vec<Section> = Vec::with_capacity(n + 1);
        for l in 1..=n + 1 {
            let section = a.section.between(&b.section, share(l));
            let (kind, before) = (b.section.kind(), a.section.kind());
            sections.push(section.ok_or(TuftError::SectionKinds { number: pair + 2, kind, before })?);
        }

        // (5), with the sum to N + 1, so that the last gap counts too
        let widths: Vec<f64> = sections.iter().map(|s| f64::from(s.greatest_width())).collect();
        let total: f64 = widths.iter().sum();
        let (azimuth, elevation) = azimuth_elevation(a1);
        let mut sum = 0.0;
        let mut made = Vec::with_capacity(n);
        for l in 1..=n {
            sum += widths[l - 1];
            let f = (sum / total) as f32;
            let root = self.ground.surface(toward(azimuth + f * alpha, elevation + f * beta));

            // (6)
            let mut points = vec![root];
            for i in 1..pa.len() {
                let (step_a, step_b) = (pa[i] - pa[i - 1], pb[i] - pb[i - 1]);
                let length = step_a.length() + (step_b.length() - step_a.length()) * share(l);
                let direction = turned_between((step_a, a1), (step_b, b1), alpha, f);
                points.push(points[i - 1] + direction * length);
            }
            let depth = a.stroke.depth() + (b.stroke.depth() - a.stroke.depth()) * share(l);
            let stroke = Stroke::new(points, h, depth)?;
            let nearer = if share(l) < 0.5 { a } else { b };
            let tuft = Tuft { section: sections[l - 1].clone(), ..nearer.along(stroke) };
            let key = self.key.with(0).with(pair as u64).with(l as u64);
            made.push(self.strewn(&tuft, key)?);
        }
        Ok(made)
    }

    /// A tuft of a row: its parent turned as a whole in its own vertical plane about the reference point.
    fn tilted(&self, parent: &Tuft, by: f32, key: Key) -> Result<Tuft, TuftError> {
        let (azimuth, elevation) = azimuth_elevation(parent.stroke.root() - self.ground.reference);
        self.strewn(&self.swung(parent, azimuth, (0.0, by), elevation)?, key)
    }

    /// A tuft whose root is moved at random within the jitter; its stroke goes with it.
    fn strewn(&self, tuft: &Tuft, key: Key) -> Result<Tuft, TuftError> {
        let (azimuth, elevation) = azimuth_elevation(tuft.stroke.root() - self.ground.reference);
        let by = if self.options.jitter > 0.0 {
            let reach = JITTER * self.options.jitter;
            (key.with(1).range(-reach, reach), key.with(2).range(-reach, reach))
        } else {
            (0.0, 0.0)
        };
        if by == (0.0, 0.0) { Ok(tuft.clone()) } else { self.swung(tuft, azimuth, by, elevation) }
    }

    /// A tuft turned about the reference point by (azimuth, elevation), its root brought back to the surface.
    fn swung(&self, tuft: &Tuft, azimuth: f32, by: (f32, f32), elevation: f32) -> Result<Tuft, TuftError> {
        // The elevation stays off the poles.
        let limit = FRAC_PI_2 - 1e-3;
        let tilt = (elevation + by.1).clamp(-limit, limit) - elevation;
        // Raising the elevation turns from `toward(azimuth, 0)` to up: about the horizontal axis between them.
        let axis = toward(azimuth, 0.0).cross(Vec3::Y);
        let turn = Quat::from_rotation_y(by.0) * Quat::from_axis_angle(axis, tilt);
        let stroke = tuft.stroke.turned(turn);
        let root = self.ground.below(stroke.root());
        let moved = stroke.moved_to(root);
        let up = tuft.up.map(|u| turn * u);
        let stroke = Stroke::new(moved.points().to_vec(), self.ground.reference, moved.depth())?;
        Ok(Tuft { up, ..tuft.along(stroke) })
    }

    /// The tuft, if hair grows at its root.
    fn admit(&mut self, tuft: &Tuft) -> Option<Tuft> {
        self.candidates += 1;
        let (azimuth, elevation) = azimuth_elevation(tuft.stroke.root() - self.ground.reference);
        (self.options.everywhere || grows_hair(azimuth, elevation)).then(|| tuft.clone())
    }
}

/// The direction at the fraction `f` between two steps, by azimuth and elevation as (5) does it for the roots. Each step
/// comes with its tuft's root. Azimuths are taken against the root's, so that steps turn about the head with the roots;
/// a step that is vertical has its root's.
fn turned_between((a, root_a): (Vec3, Vec3), (b, root_b): (Vec3, Vec3), alpha: f32, f: f32) -> Vec3 {
    let relative = |step: Vec3, root: Vec3| {
        let (azimuth, elevation) = azimuth_elevation(step);
        let level = trig::hypot(step.x, step.z) > 1e-3 * step.length();
        let against = if level { azimuth - azimuth_elevation(root).0 } else { 0.0 };
        (against, elevation)
    };
    let ((az_a, el_a), (az_b, el_b)) = (relative(a, root_a), relative(b, root_b));
    // The shorter way from one to the other.
    let turn = (az_b - az_a + PI).rem_euclid(TAU) - PI;
    let azimuth = azimuth_elevation(root_a).0 + az_a + f * (alpha + turn);
    toward(azimuth, el_a + f * (el_b - el_a))
}
