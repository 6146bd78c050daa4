//! Girths solved for: the control motion that makes a tape read what is wanted.
//!
//! Every tape has a band of heights, and a lattice around it whose outer two layers above and below are fixed, so that the
//! surface goes on with value and slope where the band ends. The three layers in the middle are feature points: they move
//! away from the axis of the tape's outline, all by the same factor. The girth grows with the factor, so that one number
//! is sought for each tape, by false position (the Illinois form), which keeps it between two bounds.

use glam::{Vec2, Vec3};

use super::{DeformError, Deformer, Lattice, Move, PointKind, all};
use crate::geometry::slice::{self, Outline, Side};
use crate::geometry::{Bounds, Mesh};
use crate::math::trig;
use crate::task::Task;

/// The least and the greatest factor, less 1.
const REACH: (f32, f32) = (-0.7, 3.0);
/// How near to the wanted girth is near enough, cm; the promise is 0.01.
const NEAR: f32 = 0.002;
/// Rounds over all tapes.
const ROUNDS: usize = 40;
/// Divisions of the lattices along the height.
const LAYERS: u32 = 6;
/// Heights in a band at which the outline is looked at, to tell the torso from the arms.
const HEIGHTS: usize = 9;

crate::choices! {
    /// How a girth is measured.
    pub enum Measure {
        /// As a tape measure does: the length of the convex hull of the outline.
        Tape = "tape",
        /// Along the outline itself, into every fold.
        Perimeter = "perimeter",
    }
}

impl Measure {
    /// The girth of an outline, cm.
    pub fn of(self, outline: &Outline) -> f32 {
        match self {
            Self::Tape => outline.tape(),
            Self::Perimeter => outline.perimeter(),
        }
    }
}

/// Where a girth is measured, and between which heights the surface may move for it.
#[derive(Clone, Debug, PartialEq)]
pub struct Band {
    /// Its name: `waist`.
    pub name: String,
    /// Height of the tape, cm.
    pub height: f32,
    /// Nothing below this height moves, cm.
    pub low: f32,
    /// Nothing above this height moves, cm.
    pub high: f32,
    /// Which outline.
    pub side: Side,
    /// Triangles of the part that is measured and moved; empty for the whole mesh.
    pub part: Vec<u32>,
}

/// A band and what its tape shall read.
#[derive(Clone, Debug, PartialEq)]
pub struct Target {
    /// Where.
    pub band: Band,
    /// The girth, cm.
    pub girth: f32,
}

/// What holds during a fit.
#[derive(Clone, Debug, PartialEq)]
pub struct FitOptions {
    /// How girths are measured.
    pub measure: Measure,
    /// Places on the surface that stay.
    pub held: Vec<Vec3>,
    /// Exponent of the affinity to them.
    pub power: f32,
    /// How far beyond a part what is sewn to it follows, cm.
    pub soft: f32,
}

impl Default for FitOptions {
    fn default() -> Self {
        Self { measure: Measure::Tape, held: vec![], power: 2.0, soft: 8.0 }
    }
}

/// What came out of a fit.
#[derive(Clone, Debug)]
pub struct Fitted {
    /// The surface.
    pub mesh: Mesh,
    /// The lattice of every target, in the order they act.
    pub lattices: Vec<Lattice>,
    /// What every tape reads now, cm.
    pub girths: Vec<f32>,
}

/// The outline that a tape goes around.
///
/// # Errors
/// When there is nothing at that height, or two legs and no side.
pub fn outline(mesh: &Mesh, band: &Band) -> Result<Outline, DeformError> {
    let mut is_part = vec![band.part.is_empty(); mesh.triangles.len()];
    band.part.iter().for_each(|&t| is_part[t as usize] = true);
    let outlines = slice::cut(mesh, band.height, |t| is_part[t as usize]);
    slice::outline(&outlines, band.side).cloned().ok_or_else(|| {
        if !outlines.is_empty() && band.side == Side::Middle {
            return DeformError::Sides { tape: band.name.clone() };
        }
        let bounds = Bounds::of(
            is_part
                .iter()
                .zip(&mesh.triangles)
                .filter(|(is, _)| **is)
                .flat_map(|(_, t)| t.map(|v| mesh.positions[v as usize])),
        );
        DeformError::NoCut { height: band.height, low: bounds.min.y, high: bounds.max.y }
    })
}

/// Moves the surface so that every tape reads its girth to a tenth of a millimetre.
///
/// # Errors
/// A girth out of reach (with what can be reached), girths that contradict each other, a tape where there is nothing.
pub fn fit(mesh: &Mesh, targets: &[Target], options: &FitOptions, task: &Task) -> Result<Fitted, DeformError> {
    let mut seats = Vec::with_capacity(targets.len());
    for target in targets {
        seats.push(Seat::new(mesh, target, options)?);
    }
    let mut factors = vec![0.0_f32; targets.len()];
    let girth_of = |t: usize, factors: &[f32]| -> Result<f32, DeformError> {
        task.check()?;
        let positions = moved(mesh, &seats, factors, task)?;
        let now = Mesh { positions, triangles: mesh.triangles.clone(), ..Mesh::default() };
        Ok(options.measure.of(&outline(&now, &targets[t].band)?))
    };
    for round in 0..ROUNDS {
        task.progress("fit", round as f32 / ROUNDS as f32);
        for t in 0..targets.len() {
            let mut with = |factor: f32| {
                let mut trial = factors.clone();
                trial[t] = factor;
                girth_of(t, &trial)
            };
            factors[t] = solve(&targets[t], factors[t], &mut with)?;
        }
        let off: Vec<f32> = (0..targets.len())
            .map(|t| Ok(girth_of(t, &factors)? - targets[t].girth))
            .collect::<Result<_, DeformError>>()?;
        if off.iter().all(|o| o.abs() <= 2.0 * NEAR) {
            let positions = moved(mesh, &seats, &factors, task)?;
            let lattices = seats.iter().zip(&factors).map(|(s, &f)| s.lattice(f)).collect::<Result<_, _>>()?;
            let girths = off.iter().zip(targets).map(|(o, t)| t.girth + o).collect();
            return Ok(Fitted { mesh: super::apply::turned(mesh, positions), lattices, girths });
        }
        if round + 1 == ROUNDS {
            let worst = (0..off.len()).max_by(|&a, &b| off[a].abs().total_cmp(&off[b].abs())).unwrap_or(0);
            let target = &targets[worst];
            let (tape, wanted) = (target.band.name.clone(), target.girth);
            return Err(DeformError::Contradiction { tape, wanted, off: off[worst].abs() });
        }
    }
    Err(DeformError::Nothing { what: "tapes" })
}

/// The factor that gives the wanted girth, starting from one that is near.
fn solve(
    target: &Target,
    start: f32,
    girth: &mut impl FnMut(f32) -> Result<f32, DeformError>,
) -> Result<f32, DeformError> {
    let now = girth(start)?;
    let mut a = (start, now - target.girth);
    if a.1.abs() <= NEAR {
        return Ok(start);
    }
    // Outwards from the start until the wanted girth lies between.
    let (low, high) = REACH;
    let mut step = (target.girth / now - 1.0) * 1.3 + 0.02 * (target.girth - now).signum();
    let mut b = a;
    while a.1 * b.1 > 0.0 {
        let next = (b.0 + step).clamp(low, high);
        if next == b.0 {
            let (least, most) = (girth(low)?, girth(high)?);
            let (tape, wanted, now) = (target.band.name.clone(), target.girth, girth(0.0)?);
            let (low, high) = (least.min(most), least.max(most));
            return Err(DeformError::OutOfReach { tape, wanted, now, low, high });
        }
        a = b;
        b = (next, girth(next)? - target.girth);
        step *= 2.0;
    }
    for _ in 0..80 {
        if b.1.abs() <= NEAR {
            return Ok(b.0);
        }
        let c = (a.0 * b.1 - b.0 * a.1) / (b.1 - a.1);
        let c = if c > a.0.min(b.0) && c < a.0.max(b.0) { c } else { 0.5 * (a.0 + b.0) };
        let f = girth(c)? - target.girth;
        if f.abs() <= NEAR {
            return Ok(c);
        }
        if f * b.1 < 0.0 {
            a = b;
        } else {
            // Illinois: an end that stays counts half, so that both ends come in.
            a.1 *= 0.5;
        }
        b = (c, f);
    }
    Ok(b.0)
}

/// The positions with every seat's lattice at its factor.
fn moved(mesh: &Mesh, seats: &[Seat], factors: &[f32], task: &Task) -> Result<Vec<Vec3>, DeformError> {
    let mut positions = mesh.positions.clone();
    for (seat, &factor) in seats.iter().zip(factors) {
        if factor != 0.0 {
            positions = seat.apply(positions, factor, task)?;
        }
    }
    Ok(positions)
}

/// A target's lattice at rest and what of the mesh takes part.
struct Seat {
    rest: Lattice,
    /// Feature points: the layers in the middle.
    features: Vec<u32>,
    axis: Vec3,
    /// How much of the motion every vertex takes.
    shares: Vec<f32>,
    /// Vertices that follow another one, with how much of its motion.
    follow: Vec<(u32, u32, f32)>,
}

impl Seat {
    fn new(mesh: &Mesh, target: &Target, options: &FitOptions) -> Result<Self, DeformError> {
        let band = &target.band;
        let found = outline(mesh, band)?;
        let axis = found.centre();
        let (shares, follow) = if band.part.is_empty() {
            (torso(mesh, band, options.soft), vec![])
        } else {
            sewn(mesh, &band.part, options.soft)
        };
        let bounds =
            Bounds::of(mesh.positions.iter().zip(&shares).filter(|(_, s)| **s > 0.0).map(|(&p, _)| p)).grown(1.0);
        let (mut low, mut high) = (bounds.min, bounds.max);
        (low.y, high.y) = (band.low, band.high);
        let rest =
            Lattice::around(Bounds { min: low, max: high }, [1, LAYERS, 1])?.holding(&options.held, options.power)?;
        let all: Vec<u32> = (0..rest.count() as u32).collect();
        let is_feature = |i: &u32| (2..=LAYERS as usize - 2).contains(&rest.indices(*i as usize)[1]);
        let (features, fixed): (Vec<u32>, Vec<u32>) = all.into_iter().partition(is_feature);
        let rest = rest.marked(&fixed, PointKind::Fixed).marked(&features, PointKind::Feature);
        Ok(Self { rest, features, axis, shares, follow })
    }

    fn lattice(&self, factor: f32) -> Result<Lattice, DeformError> {
        let scale = Vec3::new(1.0 + factor, 1.0, 1.0 + factor);
        self.rest.clone().moved(&self.features, &Move { scale, about: Some(self.axis), ..Move::default() })
    }

    fn apply(&self, positions: Vec<Vec3>, factor: f32, task: &Task) -> Result<Vec<Vec3>, DeformError> {
        let by = [Deformer::Lattice(std::sync::Arc::new(self.lattice(factor)?))];
        let wanted = all(positions.clone(), &by, task)?;
        let mut out = positions;
        let at = |v: u32, out: &[Vec3]| wanted[v as usize] - out[v as usize];
        let follow: Vec<(u32, Vec3)> = self.follow.iter().map(|&(v, to, share)| (v, at(to, &out) * share)).collect();
        for (v, (p, share)) in out.iter_mut().zip(&self.shares).enumerate() {
            if *share >= 1.0 {
                *p = wanted[v];
            } else if *share > 0.0 && wanted[v] != *p {
                *p += (wanted[v] - *p) * *share;
            }
        }
        for (v, by) in follow {
            if by != Vec3::ZERO {
                out[v as usize] += by;
            }
        }
        Ok(out)
    }
}

/// How much every vertex belongs to what the tape goes around: all of it within the outlines of the band, less and less
/// outside them. So arms beside the torso are left alone.
fn torso(mesh: &Mesh, band: &Band, soft: f32) -> Vec<f32> {
    let soft = soft.min(4.0);
    let step = (band.high - band.low) / (HEIGHTS - 1) as f32;
    let hulls: Vec<Option<Vec<Vec2>>> = (0..HEIGHTS)
        .map(|i| {
            let height = band.low + step * i as f32;
            outline(mesh, &Band { height, ..band.clone() }).ok().map(|o| o.hull())
        })
        .collect();
    let share = |p: &Vec3| {
        if p.y < band.low || p.y > band.high {
            return 0.0;
        }
        let u = ((p.y - band.low) / step).clamp(0.0, (HEIGHTS - 1) as f32);
        let (below, above) = (u.floor() as usize, u.ceil() as usize);
        let off = [below, above].into_iter().filter_map(|i| hulls[i].as_ref());
        let off = off.map(|h| slice::outside(h, Vec2::new(p.x, p.z))).fold(f32::INFINITY, f32::min);
        // A place at whose height no outline was found belongs to what is there.
        if off.is_finite() { 1.0 - trig::smoothstep(0.2 * soft, soft, off) } else { 1.0 }
    };
    mesh.positions.iter().map(share).collect()
}

/// Which vertices are of a part; those beyond its seams follow the nearest vertex of the seam, less and less.
fn sewn(mesh: &Mesh, part: &[u32], soft: f32) -> (Vec<f32>, Vec<(u32, u32, f32)>) {
    let same = mesh.weld();
    let mut is_part = vec![false; mesh.positions.len()];
    let mut is_own = vec![false; mesh.triangles.len()];
    for &t in part {
        is_own[t as usize] = true;
        mesh.triangles[t as usize].iter().for_each(|&v| is_part[same[v as usize] as usize] = true);
    }
    let is_part: Vec<bool> = same.iter().map(|&v| is_part[v as usize]).collect();
    let mut is_seam = vec![false; mesh.positions.len()];
    for (t, corners) in mesh.triangles.iter().enumerate() {
        if !is_own[t] {
            corners.iter().filter(|&&v| is_part[v as usize]).for_each(|&v| is_seam[v as usize] = true);
        }
    }
    let seam: Vec<u32> = (0..mesh.positions.len() as u32).filter(|&v| is_seam[v as usize]).collect();
    let mut follow = Vec::new();
    for v in 0..mesh.positions.len() as u32 {
        if is_part[v as usize] {
            continue;
        }
        let p = mesh.positions[v as usize];
        let near = seam.iter().map(|&s| (mesh.positions[s as usize].distance(p), s)).min_by(|a, b| a.0.total_cmp(&b.0));
        if let Some((distance, s)) = near.filter(|(d, _)| *d < soft) {
            follow.push((v, s, 1.0 - trig::smoothstep(0.0, soft, distance)));
        }
    }
    (is_part.into_iter().map(|is| if is { 1.0 } else { 0.0 }).collect(), follow)
}
