//! How fine a tuft's mesh is: by tolerance, by counts, within a budget.

use std::f32::consts::PI;

use glam::Vec3;
use rayon::prelude::*;

use super::simplify::Simplifier;
use super::skin::{self, Surface};
use super::{Section, Tuft, TuftError, Tufts};
use crate::geometry::Mesh;
use crate::math::trig;

/// How many rings and sides a tuft's mesh has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Detail {
    /// As few as keep the mesh within this distance of the true surface, cm.
    Tolerance(f32),
    /// So many rings, evenly spaced in arc length, and so many sides. Split tufts move one ring to where the prongs part
    /// and round the sides up to a multiple of twice the tips.
    Counts {
        /// Rings between the ends, an open end's own ring included; at least 1.
        rings: u32,
        /// Vertices around a ring, at least 3.
        sides: u32,
    },
    /// A ring at every control point but the tip, as in Ren, Zhao, Geng 2010: 20 points and 40 sides give 1,520
    /// triangles when both ends are pointed.
    ControlPoints {
        /// Vertices around a ring, at least 3.
        sides: u32,
    },
}

impl Detail {
    /// Checks the numbers.
    ///
    /// # Errors
    /// A count or tolerance out of range.
    pub fn validate(self) -> Result<(), TuftError> {
        match self {
            Self::Tolerance(t) => TuftError::check("tolerance", t, 1e-4, 1000.0).map(drop),
            Self::Counts { rings, sides } => {
                TuftError::check("rings", rings as f32, 1.0, 4096.0)?;
                TuftError::check("sides", sides as f32, 3.0, 1024.0).map(drop)
            }
            Self::ControlPoints { sides } => TuftError::check("sides", sides as f32, 3.0, 1024.0).map(drop),
        }
    }
}

/// Where the rings of one tuft stand and how many sides they have.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Plan {
    /// Fractions of arc length, rising.
    pub(super) rings: Vec<f32>,
    pub(super) sides: usize,
    pub(super) open_root: bool,
    pub(super) open_tip: bool,
}

/// Ends smaller than this are points, cm.
const POINTED: f32 = 1e-4;
/// Shares of a tolerance for what rings and what sides leave out; the rest is for the diagonals of twisted quads and for
/// what lies between the samples.
const RING_SHARE: f32 = 0.4;
const SIDE_SHARE: f32 = 0.45;
/// Even places along the stroke among which rings are chosen: a ring can be no nearer to its neighbour than 1/192.
const PLACES: usize = 192;

impl Plan {
    pub(super) fn new(surface: &Surface, detail: Detail, control_points: usize) -> Self {
        match detail {
            Detail::Tolerance(tolerance) => Refinement::new(surface).plan(tolerance),
            Detail::Counts { rings, sides } => {
                let mut plan = Self::ends(surface, sides as usize);
                let rings = (rings as usize).max(1 + usize::from(plan.open_root && plan.open_tip));
                let stations = rings + usize::from(!plan.open_root) + usize::from(!plan.open_tip);
                let first = usize::from(!plan.open_root);
                plan.rings = (first..first + rings).map(|i| i as f32 / (stations - 1) as f32).collect();
                plan.part(surface.section);
                plan
            }
            Detail::ControlPoints { sides } => {
                let mut plan = Self::ends(surface, sides as usize);
                plan.rings.extend(plan.open_root.then_some(0.0));
                plan.rings.extend((0..control_points - 1).map(|i| surface.sweep.control(i)));
                plan.rings.extend(plan.open_tip.then_some(1.0));
                plan.part(surface.section);
                plan
            }
        }
    }

    fn ends(surface: &Surface, sides: usize) -> Self {
        let open = |t| {
            let (w, h) = surface.section.radii(t);
            w.min(h) > POINTED
        };
        Self { rings: Vec::new(), sides, open_root: open(0.0), open_tip: open(1.0) }
    }

    /// Moves the nearest ring that may move to where the prongs part.
    fn part(&mut self, section: &Section) {
        let Some(split) = section.split else { return };
        let movable = usize::from(self.open_root)..self.rings.len() - usize::from(self.open_tip);
        let nearest =
            movable.min_by(|&a, &b| (self.rings[a] - split.from).abs().total_cmp(&(self.rings[b] - split.from).abs()));
        match nearest {
            Some(i) => self.rings[i] = split.from,
            None => self.rings.insert(usize::from(self.open_root), split.from),
        }
    }

    /// Number of triangles of the mesh.
    pub(super) fn triangles(&self, section: &Section) -> usize {
        match section.split {
            Some(s) => skin::split_triangles(self, s.from, s.tips as usize),
            None => skin::size(self.rings.len(), self.sides).1,
        }
    }
}

/// The order in which rings are worth having, found once for all tolerances.
///
/// Places are split where the surface strays farthest from the straight lines between two rings (Ramer 1972, Douglas
/// and Peucker 1973, on several lines along the surface at once). A place's key is how far it strays, but never more
/// than that of the split above it, so fewer rings at a larger tolerance are a subset of more at a smaller one.
pub(super) struct Refinement {
    ends: Plan,
    places: Vec<f32>,
    keys: Vec<f32>,
    /// Where the prongs part: index into `places` and number of tips.
    split: Option<(usize, usize)>,
    /// Greatest radius, with what a bend adds: (radius, bend part).
    round: (f32, f32),
    /// Greatest radius of a prong.
    prong: f32,
}

impl Refinement {
    pub(super) fn new(surface: &Surface) -> Self {
        let section = surface.section;
        let mut places: Vec<f32> = (0..=PLACES).map(|i| i as f32 / PLACES as f32).collect();
        let split = section.split.map(|s| {
            let nearest = ((s.from * PLACES as f32).round() as usize).clamp(1, PLACES - 1);
            places[nearest] = s.from;
            (nearest, s.tips as usize)
        });
        let cuts: Vec<_> = places.iter().map(|&t| surface.cut(t)).collect();
        let mut keys = vec![0.0; places.len()];

        // Lines along the body
        let unit = skin::outline(8);
        let last = split.map_or(PLACES, |(at, _)| at);
        let body: Vec<Vec<Vec3>> =
            cuts[..=last].iter().map(|c| unit.iter().map(|o| c.place(o.x, o.y)).collect()).collect();
        stray(&body, &mut keys[..=last]);

        // Lines along the prongs
        if let Some((at, tips)) = split {
            let rows: Vec<Vec<Vec3>> = cuts[at..]
                .iter()
                .map(|c| {
                    let prong = |i: usize| {
                        let (lo, hi) = (2.0 * i as f32 / tips as f32 - 1.0, 2.0 * (i + 1) as f32 / tips as f32 - 1.0);
                        [0.02, 0.5, 0.98].into_iter().flat_map(move |f: f32| {
                            let x = lo + (hi - lo) * f;
                            let y = (1.0 - x * x).sqrt();
                            [(x, y), (x, -y), (x, 0.0)].map(|(x, y)| c.prong(section, (i, tips), x, y))
                        })
                    };
                    (0..tips).flat_map(prong).collect()
                })
                .collect();
            stray(&rows, &mut keys[at..]);
        }

        let greatest = cuts.iter().fold((0.0_f32, 0.0_f32), |(w, h), c| (w.max(c.w), h.max(c.h)));
        let prong = split.map_or(0.0, |(at, tips)| (cuts[at].w / tips as f32).max(cuts[at].h));
        let bend = greatest.0 * section.bend.abs() * 0.25 + greatest.1 * section.bend.abs() * 0.5;
        Self { ends: Plan::ends(surface, 3), places, keys, split, round: (greatest.0.max(greatest.1), bend), prong }
    }

    pub(super) fn plan(&self, tolerance: f32) -> Plan {
        let (mut plan, last) = (self.ends.clone(), self.places.len() - 1);
        let wanted = |i: usize| {
            (i == 0 && plan.open_root)
                || (i == last && plan.open_tip)
                || self.split.is_some_and(|(at, _)| at == i)
                || self.keys[i] > RING_SHARE * tolerance
        };
        let mut rings: Vec<usize> = (0..=last).filter(|&i| wanted(i)).collect();
        if !rings.iter().any(|&i| i > 0 && i < last) {
            // At least one ring between the ends: where the surface strays farthest, the first of equals.
            let most = (1..last).fold(1, |m, i| if self.keys[i] > self.keys[m] { i } else { m });
            rings.insert(usize::from(plan.open_root), most);
        }
        plan.rings = rings.into_iter().map(|i| self.places[i]).collect();
        plan.sides = self.sides(tolerance * SIDE_SHARE);
        plan
    }

    /// The fewest sides whose chords stay within `sagitta` of the outline: r (1 - cos(pi/n)) for the roundest part of an
    /// ellipse, and for a bent one what the chord along the width misses.
    fn sides(&self, sagitta: f32) -> usize {
        let miss = |half_step: f32, radius: f32| {
            let sin = trig::sin(half_step);
            radius * (1.0 - trig::cos(half_step)) + self.round.1 * sin * sin
        };
        let fine = |n: usize| match self.split {
            None => miss(PI / n as f32, self.round.0) <= sagitta,
            Some((_, tips)) => {
                // The widest steps of the body are those round its ends, those of a prong lie on its cut side.
                let s = skin::arc_steps(n, tips);
                let end = trig::acos(1.0 - 2.0 / tips as f32);
                miss(0.5 * end / s as f32, self.round.0).max(miss(0.5 * PI / s as f32, self.prong)) <= sagitta
            }
        };
        let least = self.split.map_or(3, |(_, tips)| 2 * tips);
        let n = (least..1024).find(|&n| fine(n)).unwrap_or(1024);
        self.split.map_or(n, |(_, tips)| 2 * tips * skin::arc_steps(n, tips))
    }
}

/// Fills the keys of a run of places by the farthest straying of any of the lines through `rows`.
fn stray(rows: &[Vec<Vec3>], keys: &mut [f32]) {
    let mut open = vec![(0, rows.len() - 1, f32::INFINITY)];
    while let Some((a, b, above)) = open.pop() {
        let mut most = (0, 0.0_f32);
        for i in a + 1..b {
            let off = (0..rows[i].len())
                .map(|k| {
                    let (p, q) = (rows[a][k], rows[b][k]);
                    let chord = q - p;
                    let along = (rows[i][k] - p).dot(chord) / chord.length_squared().max(1e-20);
                    (p + chord * along.clamp(0.0, 1.0)).distance_squared(rows[i][k])
                })
                .fold(0.0, f32::max);
            if off > most.1 {
                most = (i, off);
            }
        }
        if most.1 > 1e-12 {
            let key = most.1.sqrt().min(above);
            keys[most.0] = key;
            open.push((a, most.0, key));
            open.push((most.0, b, key));
        }
    }
}

/// What [`reduce`] did.
#[derive(Clone, Debug)]
pub struct Reduction {
    /// The tufts with their new detail.
    pub tufts: Tufts,
    /// The other surfaces; none for those that stay as they are.
    pub pieces: Vec<Option<Mesh>>,
    /// Triangles before.
    pub before: usize,
    /// Triangles now: at most the budget.
    pub after: usize,
    /// No tuft strays farther from its true surface than this, cm, unless it did already, and no other surface farther
    /// from what it was; `None` when nothing had to change.
    pub tolerance: Option<f32>,
    /// Indices of the tufts that lost triangles, with their counts before and after.
    pub lowered: Vec<(usize, usize, usize)>,
}

/// Brings all tufts and all other closed surfaces (caps, buns, rings) together within `budget` triangles.
///
/// One tolerance for all, the smallest that meets the budget: rings and sides go first where the surface changes least
/// by it, on thin and straight tufts; of other surfaces single vertices. A tuft that is coarser already stays as it is. The
/// result depends on nothing but the surfaces and the budget.
///
/// # Errors
/// A budget that not even the coarsest meshes meet.
pub fn reduce(tufts: &Tufts, pieces: &[&Mesh], budget: usize) -> Result<Reduction, TuftError> {
    struct Item {
        refinement: Refinement,
        now: usize,
    }
    let planned = |tuft: &Tuft, surface: &Surface| {
        Plan::new(surface, tuft.detail, tuft.stroke.points().len()).triangles(&tuft.section)
    };
    let now: Vec<usize> = tufts.tufts.par_iter().map(|tuft| planned(tuft, &tuft.surface())).collect();
    let before = now.iter().sum::<usize>() + pieces.iter().map(|p| p.triangles.len()).sum::<usize>();
    if before <= budget {
        let (tufts, pieces) = (tufts.clone(), vec![None; pieces.len()]);
        return Ok(Reduction { tufts, pieces, before, after: before, tolerance: None, lowered: Vec::new() });
    }
    let items: Vec<Item> = tufts
        .tufts
        .par_iter()
        .zip(now)
        .map(|(tuft, now)| Item { refinement: Refinement::new(&tuft.surface()), now })
        .collect();
    let simpler: Vec<Simplifier> = pieces.par_iter().map(|piece| Simplifier::new(piece)).collect();
    let count = |tolerance: f32| -> Vec<usize> {
        items
            .par_iter()
            .zip(&tufts.tufts)
            .map(|(item, tuft)| item.now.min(item.refinement.plan(tolerance).triangles(&tuft.section)))
            .collect()
    };
    let rest = |tolerance: f32| simpler.iter().map(|s| s.triangles(tolerance)).sum::<usize>();
    let total = |tolerance: f32| count(tolerance).iter().sum::<usize>() + rest(tolerance);

    // Bisect in the logarithm: from 1 micrometre to 10 metres, far finer than any tuft's steps differ
    let (mut lo, mut hi) = (-4.0_f32, 3.0_f32);
    let at = |exponent: f32| trig::pow(10.0, exponent);
    let least = total(at(hi));
    if least > budget {
        return Err(TuftError::Budget { budget, least });
    }
    for _ in 0..40 {
        let middle = 0.5 * (lo + hi);
        if total(at(middle)) <= budget { hi = middle } else { lo = middle }
    }
    let tolerance = at(hi);
    let counts = count(tolerance);
    let mut reduced = tufts.clone();
    let mut lowered = Vec::new();
    for (i, (tuft, (item, &after))) in reduced.tufts.iter_mut().zip(items.iter().zip(&counts)).enumerate() {
        if after < item.now {
            tuft.detail = Detail::Tolerance(tolerance);
            lowered.push((i, item.now, after));
        }
    }
    let pieces = simpler
        .par_iter()
        .zip(pieces)
        .map(|(s, piece)| (s.triangles(tolerance) < piece.triangles.len()).then(|| s.mesh(tolerance)))
        .collect();
    let after = counts.iter().sum::<usize>() + rest(tolerance);
    Ok(Reduction { tufts: reduced, pieces, before, after, tolerance: Some(tolerance), lowered })
}
