//! Where tufts run through the head, and how to lift them out.

use glam::Vec3;
use rayon::prelude::*;

use super::skin::{self, Surface};
use super::{Ground, Stroke, Tuft, TuftError, Tufts};
use crate::task::{Cancelled, Task, Warning};

crate::params! {
    /// How deep a tuft may lie in the head.
    #[derive(PartialEq)]
    pub struct DipOptions("coif.dip") {
        /// Allowed depth as a fraction of the tuft's thickness there; 0.5 keeps the centre line outside.
        allowed: f32 = 0.5, range(0.0, 1.0);
    }
}

impl Default for DipOptions {
    fn default() -> Self {
        Self { allowed: 0.5 }
    }
}

/// A depth that does not show, whatever the thickness, cm on a head of scale 1.
const INVISIBLE: f32 = 0.02;
/// Stations along a stroke that are tried.
const STATIONS: usize = 96;
/// Sides of a section that are tried.
const SIDES: usize = 12;

/// The deepest place of one run of a tuft through the head.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dip {
    /// Index of the tuft.
    pub tuft: usize,
    /// Place along the stroke, fraction of arc length from the buried start.
    pub t: f32,
    /// The place of the tuft's surface that is deepest.
    pub position: Vec3,
    /// Depth below the head's surface, cm.
    pub depth: f32,
    /// The tuft's thickness there, cm.
    pub thickness: f32,
}

impl Dip {
    /// What to tell the user.
    pub fn warning(&self) -> Warning {
        let p = self.position;
        let message = format!(
            "tuft {} dips `{:.2}` cm into the head at {{ {:.1}, {:.1}, {:.1} }}, {:.0} % along; it is {:.2} cm thick there",
            self.tuft + 1,
            self.depth,
            p.x,
            p.y,
            p.z,
            self.t * 100.0,
            self.thickness
        );
        Warning::new(message).hint("move the control points outward, let them be lifted, or write `bury = true`")
    }
}

/// The end of the buried base, as a fraction of arc length: one greatest thickness beyond the root, but at most half of
/// the way from there to the tip.
pub fn base_end(tuft: &Tuft) -> f32 {
    base(&tuft.surface())
}

fn base(surface: &Surface) -> f32 {
    let root = surface.sweep.control(0);
    let thickest = (0..=32).map(|i| 2.0 * surface.section.radii(i as f32 / 32.0).1).fold(0.0, f32::max);
    root + (thickest / surface.sweep.length()).min(0.5 * (1.0 - root))
}

/// The depth at one station; 0 when it is no more than allowed.
struct Probe {
    t: f32,
    depth: f32,
    position: Vec3,
    normal: Vec3,
    allowed: f32,
    thickness: f32,
}

fn probes(tuft: &Tuft, options: &DipOptions, ground: &Ground) -> Vec<Probe> {
    let surface = tuft.surface();
    let from = base(&surface);
    let unit = skin::outline(SIDES);
    let tips = tuft.section.split.map_or(1, |s| s.tips as usize);
    (0..STATIONS + 1)
        .into_par_iter()
        .with_min_len(8)
        .map(|i| {
            let t = from + (1.0 - from) * i as f32 / STATIONS as f32;
            let cut = surface.cut(t);
            let thickness = 2.0 * surface.section.radii(t).1;
            let allowed = (options.allowed * thickness).max(INVISIBLE * ground.scale);
            let centre = cut.frame.centre;
            let mut deepest = Probe { t, depth: 0.0, position: centre, normal: Vec3::Y, allowed, thickness };
            let clear = ground.solid.clearance(centre);
            for k in 0..tips {
                // Prongs are tried at the corners of their own slices, a whole section at its own.
                for o in &unit {
                    let (lo, width) = (2.0 * k as f32 / tips as f32 - 1.0, 2.0 / tips as f32);
                    let x = lo + width * (o.x + 1.0) * 0.5;
                    let y = o.y.signum() * (1.0 - x * x).max(0.0).sqrt();
                    let p = if tips == 1 { cut.place(o.x, o.y) } else { cut.prong(surface.section, (k, tips), x, y) };
                    // A depth that is allowed, or less than another one here, need not be known: the distance changes
                    // no faster than the place.
                    let matters = deepest.depth.max(allowed);
                    let near = clear > 0.0 && p.distance(centre) - clear <= matters;
                    if near || ground.solid.clearance(p) > 0.0 {
                        continue;
                    }
                    if ground.solid.closest_within(p, matters).is_some() {
                        continue;
                    }
                    let on = ground.solid.closest(p);
                    if -on.distance > deepest.depth {
                        deepest = Probe { depth: -on.distance, position: p, normal: on.normal, ..deepest };
                    }
                }
            }
            deepest
        })
        .collect()
}

/// Where the tufts dip into the head by more than allowed beyond their buried bases: for each run of a tuft through the
/// head its deepest place, in the order of the tufts, from root to tip. Tufts that may be buried are passed over.
///
/// # Errors
/// Cancelled.
pub fn dips(tufts: &Tufts, options: &DipOptions, ground: &Ground, task: &Task) -> Result<Vec<Dip>, Cancelled> {
    let found: Vec<Vec<Dip>> = tufts
        .tufts
        .par_iter()
        .enumerate()
        .map(|(index, tuft)| {
            task.check()?;
            if tuft.bury {
                return Ok(Vec::new());
            }
            let mut runs: Vec<Dip> = Vec::new();
            let mut inside = false;
            for p in probes(tuft, options, ground) {
                let deep = p.depth > p.allowed;
                let dip = Dip { tuft: index, t: p.t, position: p.position, depth: p.depth, thickness: p.thickness };
                match runs.last_mut() {
                    Some(last) if deep && inside => *last = if dip.depth > last.depth { dip } else { *last },
                    _ if deep => runs.push(dip),
                    _ => {}
                }
                inside = deep;
            }
            Ok(runs)
        })
        .collect::<Result<_, Cancelled>>()?;
    Ok(found.into_iter().flatten().collect())
}

/// What [`lift`] did.
#[derive(Clone, Debug)]
pub struct Lifted {
    /// The tuft, its control points moved out as far as needed.
    pub tuft: Tuft,
    /// How far the control point that moved most went, cm.
    pub moved: f32,
    /// The depth beyond what is allowed that is left, cm; 0 when the tuft lies outside.
    pub left: f32,
}

/// Moves a tuft's control points (never the root) out of the head until it dips no deeper than allowed.
///
/// Each round pushes the control points on both sides of every place that is too deep along the head's normal there, by
/// the excess and in proportion to their nearness along the stroke.
///
/// # Errors
/// Control points that fall together while they move.
pub fn lift(tuft: &Tuft, options: &DipOptions, ground: &Ground) -> Result<Lifted, TuftError> {
    const ROUNDS: usize = 24;
    let start = tuft.stroke.points().to_vec();
    let mut now = tuft.clone();
    let mut left = 0.0;
    if tuft.bury {
        return Ok(Lifted { tuft: now, moved: 0.0, left });
    }
    for round in 0..=ROUNDS {
        let sweep = now.surface().sweep;
        let places: Vec<f32> = (0..start.len()).map(|i| sweep.control(i)).collect();
        let mut push = vec![Vec3::ZERO; start.len()];
        left = 0.0;
        for p in probes(&now, options, ground) {
            let excess = p.depth - p.allowed;
            if excess <= 0.0 {
                continue;
            }
            left = f32::max(left, excess);
            // The control points on both sides of it
            let after = places.partition_point(|&s| s < p.t).clamp(1, places.len() - 1);
            let before = after - 1;
            let w = ((p.t - places[before]) / (places[after] - places[before]).max(1e-6)).clamp(0.0, 1.0);
            // A little more than the excess, for the curve follows its points only in part.
            let by = p.normal * (excess * 1.1 + 0.25 * p.allowed);
            for (i, weight) in [(before, 1.0 - w), (after, w)] {
                // The root cannot move: its neighbour does its part too.
                let (i, weight) = if i == 0 { (1, weight * 0.5) } else { (i, weight) };
                let wanted = by * weight.max(0.25);
                if wanted.length_squared() > push[i].length_squared() {
                    push[i] = wanted;
                }
            }
        }
        if left == 0.0 || round == ROUNDS {
            break;
        }
        let points = now.stroke.points().iter().zip(&push).map(|(&p, &by)| p + by).collect();
        let stroke = Stroke::new(points, now.stroke.reference(), now.stroke.depth())?;
        now = Tuft { stroke, ..now };
    }
    let moved = start.iter().zip(now.stroke.points()).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
    Ok(Lifted { tuft: now, moved, left })
}
