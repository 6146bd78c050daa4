//! Members: the strands between the guides.
//!
//! A member mixes the tangents of the guides around its root and grows along the mixture from its own root. It listens
//! only to guides on its side of every parting, and the more they agree with the nearest of them, the more.

use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

use glam::Vec3;
use rayon::prelude::*;

use super::error::{GroomError, check_size, check_value};
use super::grow::stuck_warning;
use super::guides::check_root;
use super::layout;
use super::natural::first_normal;
use super::neighbours::{Nearest, agreement};
use super::noise::gaussian3;
use crate::geometry::clear::{Clear, Outcome, Scratch};
use crate::geometry::{Root, Solid, Strands, curve, curve::Resampler, frames, slide::Body};
use crate::math::{rng::Key, trig};
use crate::task::{Task, Warned, Warning};

crate::params! {
    /// Fills the scalp with strands between guides.
    pub struct FillOptions("Strands:fill") {
        /// How many strands.
        strands: usize = 40_000, range(1.0, 1e15);
        /// Nodes per strand; when left out as many as the guides' bends need, at most as many as the guides have or 128.
        nodes: Option<usize>, range(2.0, 4096.0);
        /// How many guides a strand follows at most.
        neighbours: usize = 4, range(1.0, 8.0);
        /// How much shorter strands may be than their guides, as a part of the length.
        length_variation: f32 = 0.05, range(0.0, 1.0);
        /// Standard deviation of the gaussian noise on the tangents, smooth along the strand.
        noise: f32 = 0.02, range(0.0, 10.0);
        /// Part of the strands that stray, with six times the noise.
        flyaway: f32 = 0.0, range(0.0, 1.0);
        /// How far strands gather round their guide: 0 leaves them evenly spread, 1 brings all tips to the guide's tip.
        clump: f32 = 0.0, range(0.0, 1.0);
        /// Where along the strand gathering begins, as a part of the length.
        clump_start: f32 = 0.0, range(0.0, 0.95);
        /// Depth of the layer of hair over the guides.
        thickness: f32 = 0.4, unit("cm"), range(0.0, 20.0);
        /// Least distance of hair from the skin.
        margin: f32 = 0.03, unit("cm"), range(0.005, 10.0);
        /// Another seed gives other random numbers.
        seed: u64 = 0;
    }
}

/// True when a parting lies between two places on the scalp.
pub type Separated<'a> = dyn Fn(Vec3, Vec3) -> bool + Sync + 'a;

/// What [`fill`] fills.
#[derive(Clone, Copy)]
pub struct Fill<'a> {
    /// The guides, finished.
    pub guides: &'a Strands,
    /// The members' roots.
    pub roots: &'a [Root],
    /// How.
    pub options: &'a FillOptions,
    /// Partings.
    pub separated: Option<&'a Separated<'a>>,
    /// The body to keep out of, if there is one.
    pub solid: Option<&'a Solid>,
    /// The place in the script that asked for it.
    pub source: &'a Arc<str>,
}

/// Most guides that one member can follow.
const MOST: usize = 8;
/// Guides that are looked at before all of them are.
const NEAR: usize = 16;
/// Pieces of the noise along a strand.
const KNOTS: usize = 8;

/// Grows one member from every root. A root without a guide on its side of the partings, or without a way out of the
/// head, grows none; a warning tells how many.
///
/// # Errors
/// No guides or roots, numbers out of range, too many strands or nodes, or the task was cancelled.
pub fn fill(input: &Fill, task: &Task) -> Result<Warned<Strands>, GroomError> {
    let nodes = check(input)?;
    let n = input.roots.len();
    let guides = Prepared::new(input.guides, nodes, input.options.thickness, None).agreeing(input.guides);
    task.check()?;
    let mut strands = Strands {
        points: vec![Vec3::ZERO; n * nodes],
        stage: vec![0; n * nodes],
        offsets: (0..=n).map(|i| (i * nodes) as u32).collect(),
        roots: input.roots.to_vec(),
        guide: vec![0; n],
        source: vec![0; n],
        sources: vec![Arc::clone(input.source)],
    };
    // Guide of each member, or why it has none.
    const ALONE: u32 = u32::MAX;
    const STUCK: u32 = u32::MAX - 1;
    let followed: Vec<AtomicU32> = (0..n).map(|_| AtomicU32::new(ALONE)).collect();
    layout::write_all(&mut strands, task, "filling", Worker::default, |worker, i, points, stages| {
        let Some(guide) = worker.choose(input, &guides, &input.roots[i]) else { return };
        worker.grow(input, &guides, guide, &input.roots[i], points);
        let mut answer = guide as u32;
        if let Some(solid) = input.solid {
            let clear = Clear { body: Body { solid, margin: input.options.margin } };
            if clear.strand(points, &mut worker.scratch) == Outcome::Stuck {
                answer = STUCK;
            }
        }
        stages.copy_from_slice(&guides.stages[guide * nodes..(guide + 1) * nodes]);
        followed[i].store(answer, Ordering::Relaxed);
    })?;
    task.progress("filling", 1.0);

    strands.guide = followed.iter().map(|g| g.load(Ordering::Relaxed)).collect();
    let count = |what: u32| strands.guide.iter().filter(|&&g| g == what).count();
    let (alone, stuck) = (count(ALONE), count(STUCK));
    let warnings = left_out(alone, stuck, n);
    if alone + stuck > 0 {
        let counts: Vec<usize> = strands.guide.iter().map(|&g| if g >= STUCK { 0 } else { nodes }).collect();
        layout::compact(&mut strands, &counts);
    }
    Ok(Warned { value: strands, warnings })
}

/// What is said of members that did not grow.
pub(super) fn left_out(alone: usize, stuck: usize, all: usize) -> Vec<Warning> {
    let mut warnings = Vec::new();
    if alone > 0 {
        let message = format!("`{alone}` of {all} strands were left out: no guide grows on their side of the parting");
        warnings.push(Warning::new(message).hint("ask for more guides, or move the parting"));
    }
    if stuck > 0 {
        warnings.push(stuck_warning(stuck, all, "strands"));
    }
    warnings
}

/// Refuses what cannot be filled; how many nodes the members get.
pub(super) fn check(input: &Fill) -> Result<usize, GroomError> {
    let options = input.options;
    input.guides.validate()?;
    for (what, count) in [("guides", input.guides.count()), ("roots", input.roots.len())] {
        if count == 0 {
            return Err(GroomError::Nothing { what });
        }
    }
    check_value("the margin", options.margin, 0.005, f32::MAX)?;
    for (what, value) in [
        ("the length variation", options.length_variation),
        ("the part of strands that stray", options.flyaway),
        ("the clump", options.clump),
        ("the clump's start", options.clump_start),
    ] {
        check_value(what, value, 0.0, 1.0)?;
    }
    check_value("the noise", options.noise, 0.0, f32::MAX)?;
    check_value("the thickness", options.thickness, 0.0, f32::MAX)?;
    let nodes = member_nodes(input.guides, options);
    let n = input.roots.len();
    check_size(n as u64, n as u64 * nodes as u64)?;
    input.roots.iter().try_for_each(check_root)?;
    Ok(nodes)
}

/// Nodes that every member has.
pub fn member_nodes(guides: &Strands, options: &FillOptions) -> usize {
    options.nodes.unwrap_or_else(|| usual_nodes(guides)).max(2)
}

/// Farthest that a member's segment may lie from the arc that it stands for, cm: half a pixel of a picture of 1024.
const SAGITTA: f32 = 0.02;
/// Greatest turn from segment to segment, radians: 11 segments per turn of a tight curl.
const TURN: f32 = 0.57;
/// Longest segment, cm: what lies over the head must not cut through it.
const LONGEST: f32 = 1.2;

/// Nodes that a member needs to follow the bends of the guides: an arc of curvature k with segments of length h is left
/// by k h^2 / 8 and turns by k h. Of a guide's curvatures and of the guides the sharpest tenth does not count, for they
/// may have kinks.
pub(super) fn usual_nodes(guides: &Strands) -> usize {
    let most = (0..guides.count()).map(|g| guides.range(g).len()).max().unwrap_or(2).min(128);
    let mut wanted: Vec<f32> = (0..guides.count())
        .into_par_iter()
        .map_init(Vec::new, |curvatures: &mut Vec<f32>, g| {
            let points = guides.strand(g);
            curvatures.clear();
            // Over four segments, so that the noise of single steps does not look like a bend.
            curvatures.extend(points.windows(5).map(|w| {
                let (a, b) = ((w[2] - w[0]).normalize_or_zero(), (w[4] - w[2]).normalize_or_zero());
                let way = 0.5 * w.windows(2).map(|s| s[0].distance(s[1])).sum::<f32>();
                a.distance(b) / way.max(1e-6)
            }));
            let k = nine_tenths(curvatures).max(1e-6);
            let h = (8.0 * SAGITTA / k).sqrt().min(TURN / k).min(LONGEST);
            curve::length(points) / h
        })
        .collect();
    ((nine_tenths(&mut wanted).ceil() as usize + 1).max(16)).min(most)
}

/// The value that a tenth of all exceeds; 0 for none.
fn nine_tenths(values: &mut [f32]) -> f32 {
    if values.is_empty() {
        return 0.0;
    }
    let at = values.len() * 9 / 10;
    *values.select_nth_unstable_by(at, f32::total_cmp).1
}

/// Guides with equally many nodes each, and what members ask of them.
pub(super) struct Prepared {
    nodes: usize,
    /// Per guide and node.
    points: Vec<Vec3>,
    /// Per guide and segment: unit directions.
    tangents: Vec<Vec3>,
    /// The same, per guide as all x, all y, all z, for the inner loop.
    planes: Vec<f32>,
    /// Per guide and node: where the layer of hair rises to, away from the head, with length 1 but near the root.
    lifts: Vec<Vec3>,
    /// Per guide: the direction in which its frame starts.
    pub(super) firsts: Vec<Vec3>,
    /// Per guide and node.
    pub(super) stages: Vec<u8>,
    lengths: Vec<f32>,
    nearest: Nearest,
    /// Per guide: how far the guides near it agree with it.
    agreements: Vec<Vec<(u32, f32)>>,
}

impl Prepared {
    /// With guides in motion, `firsts` are those of the guides at rest: the frames then turn with the guides, and never
    /// by what the guides' bends would say anew.
    pub(super) fn new(guides: &Strands, nodes: usize, thickness: f32, firsts: Option<&[Vec3]>) -> Self {
        let n = guides.count();
        let mut points = vec![Vec3::ZERO; n * nodes];
        let mut tangents = vec![Vec3::ZERO; n * (nodes - 1)];
        let mut lifts = vec![Vec3::ZERO; n * nodes];
        let mut stages = vec![0; n * nodes];
        let (lengths, firsts) = points
            .par_chunks_mut(nodes)
            .zip(tangents.par_chunks_mut(nodes - 1))
            .zip(lifts.par_chunks_mut(nodes).zip(stages.par_chunks_mut(nodes)))
            .enumerate()
            .map_init(
                || (Resampler::default(), vec![Vec3::ZERO; nodes]),
                |(resampler, smooth), (g, ((points, tangents), (lifts, stages)))| {
                    let old = if guides.stage.is_empty() { &[][..] } else { &guides.stage[guides.range(g)] };
                    resampler.uniform(guides.strand(g), points, |j, at| {
                        stages[j] = old.get(at.ceil() as usize).copied().unwrap_or(0);
                    });
                    let mut last = guides.roots[g].normal;
                    for (t, w) in tangents.iter_mut().zip(points.windows(2)) {
                        last = (w[1] - w[0]).try_normalize().unwrap_or(last);
                        *t = last;
                    }
                    frames::tangents(points, smooth);
                    let first = match firsts.and_then(|f| f.get(g)) {
                        Some(&rest) => frames::perpendicular(rest, smooth[0]),
                        None => first_normal(points, smooth[0], &guides.roots[g]),
                    };
                    frames::normals(points, smooth, first, lifts);
                    let length = curve::length(points);
                    // The layer has its depth after four times that much.
                    for (j, lift) in lifts.iter_mut().enumerate() {
                        let s = length * j as f32 / (nodes - 1) as f32;
                        *lift *= trig::smoothstep(0.0, 4.0 * thickness.max(1e-3), s);
                    }
                    (length, first)
                },
            )
            .unzip();
        let nearest = Nearest::new(guides.roots.iter().map(|r| r.position).collect());
        let mut planes = Vec::with_capacity(tangents.len() * 3);
        for strand in tangents.chunks(nodes - 1) {
            for axis in 0..3 {
                planes.extend(strand.iter().map(|t| t[axis]));
            }
        }
        Self { nodes, points, tangents, planes, lifts, firsts, stages, lengths, nearest, agreements: Vec::new() }
    }

    /// With what members need for choosing guides.
    pub(super) fn agreeing(mut self, guides: &Strands) -> Self {
        self.agreements = (0..self.lengths.len())
            .into_par_iter()
            .map_init(Vec::new, |found, g| {
                self.nearest.find(guides.roots[g].position, NEAR, found);
                found.iter().map(|&(_, other)| (other, self.agree(g, other as usize))).collect()
            })
            .collect();
        self
    }

    fn agree(&self, a: usize, b: usize) -> f32 {
        let tangents = |g: usize| &self.tangents[g * (self.nodes - 1)..(g + 1) * (self.nodes - 1)];
        agreement(tangents(a), tangents(b))
    }

    fn agreement(&self, a: usize, b: u32) -> f32 {
        let known = self.agreements[a].iter().find(|e| e.0 == b);
        known.map_or_else(|| self.agree(a, b as usize), |e| e.1)
    }
}

/// One thread's memory.
#[derive(Default)]
pub(super) struct Worker {
    found: Vec<(f32, u32)>,
    /// Guides on this side, nearest first: distance and index.
    near: Vec<(f32, u32)>,
    /// Guides that the member follows, and their weights, which sum to 1.
    pub(super) weights: Vec<(usize, f32)>,
    /// The mixed tangents: all x, all y, all z.
    mix: Vec<f32>,
    pub(super) scratch: Scratch,
}

impl Worker {
    /// Chooses the guides of a member and their weights; the one it follows most, if there is any.
    pub(super) fn choose(&mut self, input: &Fill, guides: &Prepared, root: &Root) -> Option<usize> {
        let wanted = input.options.neighbours.clamp(1, MOST);
        let count = guides.lengths.len();
        // First a few near ones; where partings take them all, every guide.
        let few = if input.separated.is_some() { NEAR } else { wanted + 1 };
        for k in [few.min(count), count] {
            guides.nearest.find(root.position, k, &mut self.found);
            self.near.clear();
            for &(d, g) in &self.found {
                let there = input.guides.roots[g as usize].position;
                if input.separated.is_none_or(|separated| !separated(root.position, there)) {
                    self.near.push((d.sqrt(), g));
                    if self.near.len() > wanted {
                        break;
                    }
                }
            }
            if !self.near.is_empty() {
                break;
            }
        }
        let &(_, first) = self.near.first()?;
        let first = first as usize;
        // Weights that fall to zero at the first guide that no longer counts (Franke and Little 1980), so that members
        // do not jump where that guide changes.
        let reach = match self.near.get(wanted) {
            Some(&(d, _)) => d,
            None => self.near.last().map_or(1.0, |l| l.0 * 1.5),
        }
        .max(1e-4);
        self.weights.clear();
        let mut sum = 0.0;
        for &(d, g) in self.near.iter().take(wanted) {
            let d = d.max(1e-3 * reach);
            let w = ((reach - d).max(0.0) / (reach * d)) * ((reach - d).max(0.0) / (reach * d));
            let w = w * if g as usize == first { 1.0 } else { guides.agreement(first, g) };
            if w > 0.0 {
                self.weights.push((g as usize, w));
                sum += w;
            }
        }
        if sum > 0.0 {
            self.weights.iter_mut().for_each(|w| w.1 /= sum);
        } else {
            self.weights.push((first, 1.0));
        }
        Some(first)
    }

    /// Integrates the mixed tangents from the member's own root.
    pub(super) fn grow(&mut self, input: &Fill, guides: &Prepared, guide: usize, root: &Root, out: &mut [Vec3]) {
        let options = input.options;
        let nodes = guides.nodes;
        let segments = nodes - 1;
        let key = Key::new(options.seed, "member").with(root.id);
        let mixed: f32 = self.weights.iter().map(|&(g, w)| guides.lengths[g] * w).sum();
        let length = mixed * (1.0 - options.length_variation * key.with(1).unit());
        let h = length / segments as f32;
        let strays = key.with(2).unit() < options.flyaway;
        let noise = options.noise * if strays { 6.0 } else { 1.0 };

        // The mixture, plane by plane: plain loops over floats, which the compiler turns into vector code.
        self.mix.resize(3 * segments, 0.0);
        for (k, &(g, w)) in self.weights.iter().enumerate() {
            let from = &guides.planes[g * 3 * segments..(g + 1) * 3 * segments];
            if k == 0 {
                self.mix.iter_mut().zip(from).for_each(|(t, &f)| *t = f * w);
            } else {
                self.mix.iter_mut().zip(from).for_each(|(t, &f)| *t += f * w);
            }
        }
        if noise > 0.0 {
            self.add_noise(key, noise, segments);
        }
        // To segments of equal length; where the tangents cancel, the first guide's.
        let (x, yz) = self.mix.split_at_mut(segments);
        let (y, z) = yz.split_at_mut(segments);
        let mut least = f32::INFINITY;
        for ((x, y), z) in x.iter_mut().zip(y.iter_mut()).zip(z.iter_mut()) {
            let squared = *x * *x + *y * *y + *z * *z;
            let to_length = h / squared.max(1e-12).sqrt();
            least = if squared < least { squared } else { least };
            (*x, *y, *z) = (*x * to_length, *y * to_length, *z * to_length);
        }
        if least < 1e-6 {
            for j in 0..segments {
                if x[j] * x[j] + y[j] * y[j] + z[j] * z[j] < 0.81 * h * h {
                    let own = guides.tangents[guide * segments + j] * h;
                    (x[j], y[j], z[j]) = (own.x, own.y, own.z);
                }
            }
        }
        // Integration. The layer of hair: each member lies at its own height over the guides.
        let height = options.thickness * key.with(3).unit();
        let lifts = &guides.lifts[guide * nodes + 1..(guide + 1) * nodes];
        let mut p = root.position;
        out[0] = p;
        for ((((out, &lift), x), y), z) in out[1..].iter_mut().zip(lifts).zip(x).zip(y).zip(z) {
            p += Vec3::new(*x, *y, *z);
            *out = p + lift * height;
        }
        if options.clump > 0.0 {
            let points = &guides.points[guide * nodes..(guide + 1) * nodes];
            for (j, (p, &q)) in out.iter_mut().zip(points).enumerate().skip(1) {
                let u = j as f32 / segments as f32;
                *p = p.lerp(q, options.clump * trig::smoothstep(options.clump_start, 1.0, u));
            }
        }
    }
    /// Adds noise that runs straight from knot to knot.
    fn add_noise(&mut self, key: Key, noise: f32, segments: usize) {
        let pieces = KNOTS.min(segments);
        let knot = |k: usize| gaussian3(key.with(16 + k as u64)) * noise;
        let mut a = knot(0);
        for piece in 0..pieces {
            let b = knot(piece + 1);
            let (lo, hi) = (piece * segments / pieces, (piece + 1) * segments / pieces);
            let step = (b - a) / (hi - lo) as f32;
            for axis in 0..3 {
                let plane = &mut self.mix[axis * segments..(axis + 1) * segments];
                for (j, t) in plane[lo..hi].iter_mut().enumerate() {
                    *t += a[axis] + step[axis] * j as f32;
                }
            }
            a = b;
        }
    }
}
