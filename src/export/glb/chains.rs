//! Joint chains that carry strands in motion: few polylines of joints, each shared by the strands around it.
//!
//! A chain lies along a guide, or along a strand where no guide will do. Its joints are the nodes that its own bends need;
//! each is turned by the least turn that takes its segment from the one before it, so a segment keeps its length and only
//! turns are keyed, but where lengths change. A node of a strand follows at most four joints of the chains whose roots and
//! tips move most like its own, by the weights that fit all frames best: least squares over weights that are not negative
//! and sum to one (Lawson, Hanson 1974). Then its place at rest is shifted a little, to where all frames fit best (Le, Deng
//! 2012): a joint turns what is around it, while hair beside a guide is mostly shifted. Strands that come out farther off
//! than the tolerance get chains themselves, until none does.

#![allow(clippy::needless_range_loop, reason = "several lists are gone through in step")]

use std::collections::BTreeSet;

use glam::{Affine3A, Mat3, Quat, Vec3};
use rayon::prelude::*;

use super::keys::{Placing, reduce, share};
use crate::task::{Cancelled, Task};

/// Joints that a vertex follows at most: what programs read.
pub const FOLLOWED: usize = 4;

/// What chains may take.
#[derive(Clone, Copy, Debug)]
pub struct Most {
    /// How many joints.
    pub joints: usize,
    /// About how many bytes.
    pub bytes: usize,
}

impl Most {
    /// As many joints as a file can number.
    pub const ALL: Self = Self { joints: 65_535, bytes: usize::MAX };
    /// As many as programs still move with ease, unless they are asked for.
    pub const EASY: usize = 4096;
}

/// The parts of the tolerance that a chain's own bends, its keys and its lengths may take.
const BENDS: f32 = 0.4;
const KEYS: f32 = 0.2;
const LENGTHS: f32 = 0.1;
/// Chains that are tried for a strand.
const TRIED: usize = 10;
/// Frames that weights are fitted to.
const FITTED: usize = 24;
/// Rounds in which chains are added, before all strands that are left get their own.
const ROUNDS: usize = 16;

/// A polyline at rest and at every frame, cm, as seen from the node that carries it.
#[derive(Clone, Debug, Default)]
pub struct Way {
    /// At rest.
    pub rest: Vec<Vec3>,
    /// At each frame.
    pub frames: Vec<Vec<Vec3>>,
}

/// What a chain lies along.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Along {
    /// A guide, by its index.
    Guide(usize),
    /// A strand, by its index.
    Strand(usize),
}

/// One chain of joints.
#[derive(Clone, Debug)]
pub struct Chain {
    /// What it lies along.
    pub along: Along,
    /// Per joint: where it is at rest.
    pub rest: Vec<Placing>,
    /// The frames that have keys.
    pub keys: Vec<usize>,
    /// Per joint: its turn within the joint before it, at every key; none where it is the same at all.
    pub turns: Vec<Option<Vec<Quat>>>,
    /// The same for where it is within the joint before it, cm.
    pub shifts: Vec<Option<Vec<Vec3>>>,
    /// Per joint: its part of the way from root to tip.
    parts: Vec<f32>,
    /// Per frame and joint: leads from rest to where the file's keys have it.
    played: Vec<Affine3A>,
    /// What strands are compared with.
    traits: Traits,
}

/// What a node follows: joints, numbered through all chains, and how much, in 65535ths that sum to 65535.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Followed {
    /// The joints; 0 where the weight is 0.
    pub joints: [u16; FOLLOWED],
    /// The weights, greatest first.
    pub weights: [u16; FOLLOWED],
}

/// All chains of a part, and what its nodes follow.
#[derive(Clone, Debug, Default)]
pub struct Chains {
    /// The chains.
    pub chains: Vec<Chain>,
    /// Per node that is drawn.
    pub followed: Vec<Followed>,
    /// Per node that is drawn: how far it is to be shifted at rest, cm; never more than the tolerance.
    pub shifts: Vec<Vec3>,
    /// The farthest that a vertex lies from where it is at a frame, cm.
    pub error: f32,
}

/// The strands that chains are made for.
pub trait Hair: Sync {
    /// How many strands there are.
    fn count(&self) -> usize;
    /// How many guides that move there are.
    fn guides(&self) -> usize;
    /// The guide that a strand follows most.
    fn guide(&self, strand: usize) -> Option<usize>;
    /// All nodes of a strand or guide.
    fn way(&self, along: Along) -> Way;
    /// The drawn nodes of a strand.
    fn drawn(&self, strand: usize) -> Way;
    /// The first of its drawn nodes, counted through all strands.
    fn first(&self, strand: usize) -> usize;
    /// The vertices of a strand, `each()` per node, at rest and at each frame.
    fn vertices(&self, strand: usize, drawn: &Way) -> Way;
    /// Vertices per node.
    fn each(&self) -> usize;
}

/// What tells whether two polylines move alike: the root at rest; where middle and tip are from it at rest, and how far
/// they come from there at some frames.
#[derive(Clone, Debug)]
struct Traits(Vec<Vec3>);

impl Traits {
    fn new(way: &Way) -> Self {
        let n = way.rest.len();
        let mut all = vec![way.rest[0]];
        for node in [n / 2, n - 1] {
            all.push(0.5 * (way.rest[node] - way.rest[0]));
            let f = way.frames.len();
            all.extend([f / 4, f / 2, 3 * f / 4].map(|f| way.frames[f][node] - way.rest[node]));
        }
        Self(all)
    }

    fn distance(&self, other: &Self) -> f32 {
        self.0.iter().zip(&other.0).map(|(a, b)| a.distance_squared(*b)).sum()
    }
}

/// About so many of `count`, evenly, the first and the last among them.
fn some(count: usize, most: usize) -> Vec<usize> {
    let n = count.min(most);
    (0..n).map(|i| if n == 1 { 0 } else { i * (count - 1) / (n - 1) }).collect()
}

/// Per joint of a chain its turn: each from the one before it by the least turn between their segments; `first` is that
/// of the first for a segment along `from`. The joint at the tip is as the one before it.
fn turns(points: &[Vec3], joints: &[usize], from: Vec3, first: Quat) -> Vec<Quat> {
    let (mut turn, mut before) = (first, from);
    let mut all = Vec::with_capacity(joints.len());
    for w in joints.windows(2) {
        let way = (points[w[1]] - points[w[0]]).try_normalize().unwrap_or(before);
        turn = (Quat::from_rotation_arc(before, way) * turn).normalize();
        before = way;
        all.push(turn);
    }
    all.push(turn);
    all
}

/// A turn in whole 32767ths, as the file has it, and what programs make of that.
pub fn sixteenth(turn: Quat) -> ([i16; 4], Quat) {
    let whole = turn.to_array().map(|x| (x * 32767.0).round() as i16);
    (whole, Quat::from_array(whole.map(|x| f32::from(x) / 32767.0)).normalize())
}

/// The least turns of all joints at rest, and the direction of the first segment.
fn resting(points: &[Vec3], joints: &[usize]) -> (Vec<Quat>, Vec3) {
    let first = (points[joints[1]] - points[0]).try_normalize().unwrap_or(Vec3::Y);
    (turns(points, joints, Vec3::Y, Quat::IDENTITY), first)
}

/// Leads from rest to a frame, for every joint.
fn moves(rest: &[Vec3], turned: &[Quat], now: &[Vec3], now_turned: &[Quat], joints: &[usize]) -> Vec<Affine3A> {
    let one = |(k, &j): (usize, &usize)| {
        let turn = now_turned[k] * turned[k].inverse();
        Affine3A::from_rotation_translation(turn, now[j] - turn * rest[j])
    };
    joints.iter().enumerate().map(one).collect()
}

/// The nodes of a polyline that are joints: with the two around it to follow, no other node is farther than `tolerance`
/// from its place.
fn joints(way: &Way, tolerance: f32) -> Vec<usize> {
    let n = way.rest.len();
    let mut joints = vec![0, n - 1];
    let frames = some(way.frames.len(), 12);
    loop {
        let (turned, first) = resting(&way.rest, &joints);
        let moved: Vec<Vec<Affine3A>> = frames
            .iter()
            .map(|&f| {
                let now = turns(&way.frames[f], &joints, first, turned_first(&turned));
                moves(&way.rest, &turned, &way.frames[f], &now, &joints)
            })
            .collect();
        let mut more = vec![];
        for (a, w) in joints.windows(2).enumerate() {
            let mut worst = (tolerance, None);
            for k in w[0] + 1..w[1] {
                let p = way.rest[k];
                let pairs = || {
                    frames
                        .iter()
                        .zip(&moved)
                        .map(|(&f, m)| (m[a].transform_point3(p), m[a + 1].transform_point3(p), way.frames[f][k]))
                };
                let (mut above, mut below) = (0.0, 1e-12);
                for (x, y, wanted) in pairs() {
                    above += (wanted - x).dot(y - x);
                    below += (y - x).length_squared();
                }
                let t = (above / below).clamp(0.0, 1.0);
                let error = pairs().map(|(x, y, wanted)| x.lerp(y, t).distance(wanted)).fold(0.0, f32::max);
                if error > worst.0 {
                    worst = (error, Some(k));
                }
            }
            more.extend(worst.1);
        }
        if more.is_empty() {
            return joints;
        }
        joints.extend(more);
        joints.sort_unstable();
    }
}

/// The turn of the first segment at rest, from which those of the frames start.
fn turned_first(turned: &[Quat]) -> Quat {
    turned.first().copied().unwrap_or(Quat::IDENTITY)
}

impl Chain {
    /// A chain along a polyline; `moments` are the frames with the one that closes a loop.
    fn new(along: Along, way: &Way, moments: usize, tolerance: f32, is_fine: bool) -> Self {
        let nodes = if is_fine { (0..way.rest.len()).collect() } else { joints(way, BENDS * tolerance) };
        let count = nodes.len();
        let (turned, first) = resting(&way.rest, &nodes);
        let rest: Vec<Placing> =
            nodes.iter().zip(&turned).map(|(&j, &turn)| Placing { turn, shift: way.rest[j] }).collect();
        let frames = way.frames.len();
        // Where every joint is within the one before it, frame by frame; lengths that hardly change are kept.
        let global: Vec<Vec<Quat>> =
            way.frames.iter().map(|now| turns(now, &nodes, first, turned_first(&turned))).collect();
        let mut own: Vec<Vec<Placing>> = vec![Vec::with_capacity(count); frames];
        let mut at: Vec<Vec3> = vec![Vec3::ZERO; frames];
        let mut slides = vec![false; count];
        for k in 0..count {
            let still = match k {
                0 => rest[0].shift,
                _ => rest[k - 1].turn.inverse() * (rest[k].shift - rest[k - 1].shift),
            };
            let parent = |f: usize| if k == 0 { Quat::IDENTITY } else { global[f][k - 1] };
            let kept = |f: usize, at: &[Vec3]| at[f] + parent(f) * still;
            let drift = (0..frames).map(|f| kept(f, &at).distance(way.frames[f][nodes[k]])).fold(0.0, f32::max);
            slides[k] = drift > LENGTHS * tolerance;
            for f in 0..frames {
                let shift = if slides[k] { parent(f).inverse() * (way.frames[f][nodes[k]] - at[f]) } else { still };
                at[f] += parent(f) * shift;
                let turn = (parent(f).inverse() * global[f][k]).normalize();
                let turn = match f.checked_sub(1).map(|b| own[b][k].turn) {
                    Some(before) if before.dot(turn) < 0.0 => -turn,
                    _ => turn,
                };
                let turn = sixteenth(turn).1;
                own[f].push(Placing { turn, shift });
            }
        }
        // Keys, and what they make of it.
        let globals = |own: &dyn Fn(usize) -> Placing| -> Vec<Placing> {
            let mut all: Vec<Placing> = Vec::with_capacity(count);
            for k in 0..count {
                let local = own(k);
                all.push(match all.last() {
                    None => local,
                    Some(p) => {
                        Placing { turn: (p.turn * local.turn).normalize(), shift: p.shift + p.turn * local.shift }
                    }
                });
            }
            all
        };
        let exact: Vec<Vec<Placing>> = own.iter().map(|own| globals(&|k| own[k])).collect();
        let between = |from: usize, to: usize, frame: usize| {
            let (a, b, t) = (&own[from % frames], &own[to % frames], share(from, to, frame));
            globals(&|k| Placing::between(&a[k], &b[k], t))
        };
        let off = |from: usize, to: usize, frame: usize| {
            let now = between(from, to, frame);
            now.iter().zip(&exact[frame % frames]).map(|(a, b)| a.shift.distance(b.shift)).fold(0.0, f32::max)
        };
        let keys = reduce(moments, KEYS * tolerance, off);
        let inverse: Vec<Affine3A> = rest.iter().map(|r| r.transform().inverse()).collect();
        let mut played = Vec::with_capacity(frames * count);
        let mut key = 0;
        for frame in 0..frames {
            while key + 2 < keys.len() && keys[key + 1] <= frame {
                key += 1;
            }
            let now = match keys.get(key + 1) {
                Some(&to) => between(keys[key], to, frame),
                None => exact[frame].clone(),
            };
            played.extend(now.iter().zip(&inverse).map(|(now, back)| now.transform() * *back));
        }
        let turning = |k: usize| {
            let all: Vec<Quat> = keys.iter().map(|&f| own[f % frames][k].turn).collect();
            let still = all.iter().all(|t| t.dot(all[0]).abs() > 1.0 - 1e-7);
            (!still).then_some(all)
        };
        let shifting = |k: usize| slides[k].then(|| keys.iter().map(|&f| own[f % frames][k].shift).collect());
        let mut parts = vec![0.0];
        for w in way.rest.windows(2) {
            parts.push(parts[parts.len() - 1] + w[0].distance(w[1]));
        }
        let length = parts[parts.len() - 1].max(1e-9);
        Self {
            along,
            turns: (0..count).map(turning).collect(),
            shifts: (0..count).map(shifting).collect(),
            parts: nodes.iter().map(|&j| parts[j] / length).collect(),
            traits: Traits::new(way),
            rest,
            keys,
            played,
        }
    }

    fn joints(&self) -> usize {
        self.rest.len()
    }

    /// Bytes of its tracks, and of its part of the text.
    fn bytes(&self) -> usize {
        let (turning, shifting) = (self.turns.iter().flatten().count(), self.shifts.iter().flatten().count());
        let keys = self.keys.len();
        4 * keys + 150 + self.joints() * (64 + 180) + turning * (8 * keys + 210) + shifting * (12 * keys + 210)
    }

    /// The joint at the tip moves as the one before it unless it slides.
    fn moving(&self) -> usize {
        self.joints() - usize::from(self.shifts.last().is_some_and(Option::is_none))
    }
}

impl Chains {
    /// How many joints there are.
    pub fn joints(&self) -> usize {
        self.chains.iter().map(Chain::joints).sum()
    }

    /// About the bytes that they take in a file, with what so many vertices follow.
    pub fn bytes(&self, vertices: usize) -> usize {
        16 * vertices + self.chains.iter().map(Chain::bytes).sum::<usize>()
    }

    /// Chains with which no vertex is farther than `tolerance` cm from its place at any frame. None when they would take
    /// more than `most`.
    ///
    /// # Errors
    /// [`Cancelled`].
    pub fn new(
        hair: &impl Hair,
        moments: usize,
        tolerance: f32,
        most: Most,
        task: &Task,
    ) -> Result<Option<Self>, Cancelled> {
        let count = hair.count();
        let seeds: Vec<Along> = match hair.guides() {
            0 => some(count, (count / 16).max(8)).into_iter().map(Along::Strand).collect(),
            guides => (0..guides).map(Along::Guide).collect(),
        };
        let nodes = hair.first(count);
        let (followed, shifts) = (vec![Followed::default(); nodes], vec![Vec3::ZERO; nodes]);
        let mut chains = Self { followed, shifts, ..Self::default() };
        // Chains that a strand has of its own: where one is not enough, another with all its nodes.
        let mut has_chain = vec![0; count];
        let mut errors = vec![f32::INFINITY; count];
        let mut nearest = vec![0; count];
        let mut open: Vec<usize> = (0..count).collect();
        let mut next = if hair.guides() > 0 { spread(hair, &seeds) } else { seeds };
        for round in 0.. {
            task.progress("joints", 1.0 - open.len() as f32 / count.max(1) as f32);
            let made: Vec<Chain> = next
                .par_iter()
                .map(|&along| {
                    task.check()?;
                    let is_fine = matches!(along, Along::Strand(s) if has_chain[s] > 1);
                    Ok(Chain::new(along, &hair.way(along), moments, tolerance, is_fine))
                })
                .collect::<Result<_, Cancelled>>()?;
            chains.chains.extend(made);
            if chains.joints() > most.joints || chains.bytes(nodes * hair.each()) > most.bytes {
                return Ok(None);
            }
            let firsts: Vec<usize> = chains
                .chains
                .iter()
                .scan(0, |sum, c| {
                    *sum += c.joints();
                    Some(*sum - c.joints())
                })
                .collect();
            let fits: Vec<Fit> = open
                .par_iter()
                .map(|&strand| {
                    task.check()?;
                    Ok(fit(hair, strand, &chains.chains, &firsts, tolerance))
                })
                .collect::<Result<_, Cancelled>>()?;
            for (&strand, fit) in open.iter().zip(&fits) {
                // More chains to choose from may by chance do worse.
                if fit.error < errors[strand] {
                    let own = hair.first(strand)..hair.first(strand + 1);
                    chains.followed[own.clone()].copy_from_slice(&fit.followed);
                    chains.shifts[own].copy_from_slice(&fit.shifts);
                    errors[strand] = fit.error;
                }
                nearest[strand] = fit.nearest;
            }
            open.retain(|&s| errors[s] > tolerance && has_chain[s] < 2);
            if open.is_empty() {
                break;
            }
            // The worst first; of those that move much alike only one in a round.
            open.sort_by(|&a, &b| errors[b].total_cmp(&errors[a]).then(a.cmp(&b)));
            next = vec![];
            let mut known: BTreeSet<Along> = chains.chains.iter().map(|c| c.along).collect();
            let mut taken = vec![0; chains.chains.len()];
            for &strand in &open {
                let used = &mut taken[nearest[strand]];
                *used += 1;
                if *used > 1 + round / 3 && round < ROUNDS {
                    continue;
                }
                let guide = hair.guide(strand).filter(|_| hair.guides() > 0).map(Along::Guide);
                match guide.filter(|g| !known.contains(g)) {
                    Some(guide) => {
                        known.insert(guide);
                        next.push(guide);
                    }
                    None => {
                        has_chain[strand] += 1;
                        next.push(Along::Strand(strand));
                    }
                }
            }
        }
        chains.error = errors.into_iter().fold(0.0, f32::max);
        // Rounding may keep a strand from its own chain by a little: then shapes do better.
        let is_within = chains.error <= 1.001 * tolerance || most.bytes == usize::MAX;
        Ok(is_within.then_some(chains))
    }
}

/// Some of the guides, those that move least alike first: a quarter, for a beginning.
fn spread(hair: &impl Hair, guides: &[Along]) -> Vec<Along> {
    let traits: Vec<Traits> = guides.par_iter().map(|&g| Traits::new(&hair.way(g))).collect();
    let wanted = guides.len().div_ceil(4).max(guides.len().min(8));
    let mut nearest = vec![f32::INFINITY; guides.len()];
    let mut chosen = vec![];
    let mut next = 0;
    while chosen.len() < wanted {
        chosen.push(guides[next]);
        for (near, other) in nearest.iter_mut().zip(&traits) {
            *near = near.min(other.distance(&traits[next]));
        }
        next = (0..guides.len()).fold(0, |best, i| if nearest[i] > nearest[best] { i } else { best });
        if nearest[next] == 0.0 {
            break;
        }
    }
    chosen
}

/// How a strand follows chains.
struct Fit {
    /// Per drawn node.
    followed: Vec<Followed>,
    /// Per drawn node, cm.
    shifts: Vec<Vec3>,
    /// The farthest that one of its vertices lies from its place, cm.
    error: f32,
    /// The chain that moves most like it.
    nearest: usize,
}

/// What the drawn nodes of a strand follow; `firsts` are the numbers of the chains' first joints.
fn fit(hair: &impl Hair, strand: usize, chains: &[Chain], firsts: &[usize], tolerance: f32) -> Fit {
    let drawn = hair.drawn(strand);
    let n = drawn.rest.len();
    let traits = Traits::new(&drawn);
    let apart = |c: &Chain| if c.along == Along::Strand(strand) { -1.0 } else { traits.distance(&c.traits) };
    let mut near: Vec<(f32, usize)> = chains.iter().enumerate().map(|(i, c)| (apart(c), i)).collect();
    let tried = TRIED.min(near.len());
    if tried < near.len() {
        near.select_nth_unstable_by(tried - 1, |a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    }
    near.truncate(tried);
    near.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let frames = some(drawn.frames.len(), FITTED);
    let vertices = hair.vertices(strand, &drawn);
    let (mut length, mut parts) = (0.0, vec![0.0]);
    for w in drawn.rest.windows(2) {
        length += w[0].distance(w[1]);
        parts.push(length);
    }
    let each = hair.each();
    let mut out =
        Fit { followed: Vec::with_capacity(n), shifts: Vec::with_capacity(n), error: 0.0, nearest: near[0].1 };
    let mut candidates: Vec<(usize, usize)> = vec![];
    let mut offsets: Vec<Vec3> = vec![];
    for k in 0..n {
        let part = parts[k] / length.max(1e-9);
        candidates.clear();
        for (rank, &(_, c)) in near.iter().enumerate() {
            let chain = &chains[c];
            let moving = chain.moving();
            let a = chain.parts.partition_point(|p| *p <= part).clamp(1, moving) - 1;
            let from = if rank < 3 { a.saturating_sub(1) } else { a };
            candidates.extend((from..=(a + 1).min(moving - 1)).map(|j| (c, j)));
        }
        let move_of = |(c, j): (usize, usize), frame: usize| &chains[c].played[frame * chains[c].joints() + j];
        let mut shift = Vec3::ZERO;
        let mut used: Vec<((usize, usize), f32)> = vec![];
        let mut followed = Followed::default();
        for _ in 0..2 {
            // How far each candidate would leave the node from its place.
            offsets.clear();
            let rest = drawn.rest[k] + shift;
            for &joint in &candidates {
                offsets.extend(frames.iter().map(|&f| move_of(joint, f).transform_point3(rest) - drawn.frames[f][k]));
            }
            let (chosen, weights) = best(&offsets, candidates.len(), frames.len());
            let numbered = chosen.iter().zip(&weights).map(|(&i, &w)| {
                let (c, j) = candidates[i];
                ((firsts[c] + j) as u16, w)
            });
            followed = quantised(numbered);
            let place = |joint: u16| {
                let c = firsts.partition_point(|f| *f <= usize::from(joint)) - 1;
                (c, usize::from(joint) - firsts[c])
            };
            let some = (0..FOLLOWED).filter(|&i| followed.weights[i] > 0);
            used = some.map(|i| (place(followed.joints[i]), f32::from(followed.weights[i]) / 65535.0)).collect();
            let mixed = |f: usize| {
                used.iter().fold(Affine3A::from_mat3(Mat3::ZERO), |sum, &(joint, w)| {
                    let by = move_of(joint, f);
                    let matrix = sum.matrix3 + by.matrix3 * w;
                    Affine3A { matrix3: matrix, translation: sum.translation + by.translation * w }
                })
            };
            // Where the place at rest fits best.
            let (mut left, mut right) = (Mat3::ZERO, Vec3::ZERO);
            for &f in &frames {
                let by = mixed(f);
                let off = by.transform_point3(drawn.rest[k]) - drawn.frames[f][k];
                let (matrix, turned) = (Mat3::from(by.matrix3), Mat3::from(by.matrix3).transpose());
                left += turned * matrix;
                right -= turned * off;
            }
            left += Mat3::from_diagonal(Vec3::splat(0.1 * frames.len() as f32));
            shift = (left.inverse() * right).clamp_length_max(tolerance);
            if !shift.is_finite() {
                shift = Vec3::ZERO;
            }
        }
        // As it is played.
        for v in k * each..(k + 1) * each {
            for (frame, wanted) in vertices.frames.iter().enumerate() {
                let rest = vertices.rest[v] + shift;
                let at = used.iter().map(|&(joint, w)| move_of(joint, frame).transform_point3(rest) * w).sum::<Vec3>();
                out.error = out.error.max(at.distance(wanted[v]));
            }
        }
        out.error = out.error.max(shift.length());
        out.followed.push(followed);
        out.shifts.push(shift);
    }
    out
}

/// Weights that are whole 65535ths, greatest first.
fn quantised(all: impl Iterator<Item = (u16, f64)>) -> Followed {
    let mut all: Vec<(u16, u16)> =
        all.map(|(j, w)| (j, (w * 65535.0).round() as u16)).filter(|(_, w)| *w > 0).collect();
    all.sort_by(|a, b| b.1.cmp(&a.1).then(a.0.cmp(&b.0)));
    let sum: i64 = all.iter().map(|(_, w)| i64::from(*w)).sum();
    if let Some(first) = all.first_mut() {
        first.1 = (i64::from(first.1) + 65535 - sum).clamp(0, 65535) as u16;
    }
    let mut out = Followed::default();
    for (i, (j, w)) in all.into_iter().take(FOLLOWED).enumerate() {
        (out.joints[i], out.weights[i]) = (j, w);
    }
    out
}

/// Of `count` candidates the at most four, with their weights, whose mixture is nearest to nothing: `offsets` has for each
/// candidate so many vectors.
fn best(offsets: &[Vec3], count: usize, each: usize) -> (Vec<usize>, Vec<f64>) {
    let of = |i: usize| &offsets[i * each..(i + 1) * each];
    let dot = |a: usize, b: usize| -> f64 { of(a).iter().zip(of(b)).map(|(a, b)| a.dot(*b)).sum::<f32>().into() };
    let own: Vec<f64> = (0..count).map(|i| dot(i, i)).collect();
    let first = (0..count).fold(0, |best, i| if own[i] < own[best] { i } else { best });
    let mut active = vec![first];
    let mut weights = vec![1.0];
    // Inner products with the active ones.
    let mut products: Vec<Vec<f64>> = vec![(0..count).map(|i| dot(first, i)).collect()];
    let enough = 1e-8 * each as f64;
    let mut before = f64::INFINITY;
    while active.len() < FOLLOWED {
        let slope = |i: usize| products.iter().zip(&weights).map(|(p, w)| p[i] * w).sum::<f64>();
        let now: f64 = active.iter().zip(&weights).map(|(&i, w)| w * slope(i)).sum();
        let next = (0..count).filter(|i| !active.contains(i)).map(|i| (slope(i), i));
        let Some((least, next)) = next.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))) else { break };
        // Rounding may have two candidates take each other's place for ever: every exchange has to be worth it.
        if now <= enough || least >= now * (1.0 - 1e-3) || now >= before * (1.0 - 1e-6) || now.is_nan() {
            break;
        }
        before = now;
        active.push(next);
        weights.push(0.0);
        products.push((0..count).map(|i| dot(next, i)).collect());
        // Where weights would become negative, as far as the first does; that one is left out.
        while let Some(solved) = solve(&active, &products) {
            let steps = solved.iter().zip(&weights).filter(|(s, _)| **s < 0.0).map(|(s, w)| w / (w - s));
            let step = steps.fold(1.0, f64::min);
            for (w, s) in weights.iter_mut().zip(&solved) {
                *w += step * (s - *w);
            }
            if step >= 1.0 {
                break;
            }
            let out = (0..active.len()).fold(0, |best, i| if weights[i] < weights[best] { i } else { best });
            active.remove(out);
            weights.remove(out);
            products.remove(out);
            if active.len() == 1 {
                weights = vec![1.0];
                break;
            }
        }
        if !active.contains(&next) {
            break;
        }
    }
    (active, weights)
}

/// The weights, which sum to one, of the shortest mixture.
fn solve(active: &[usize], products: &[Vec<f64>]) -> Option<Vec<f64>> {
    let n = active.len();
    let most = (0..n).map(|i| products[i][active[i]]).fold(0.0, f64::max);
    let mut a: Vec<Vec<f64>> = (0..n).map(|i| (0..n).map(|j| products[i][active[j]]).collect()).collect();
    let mut x = vec![1.0; n];
    for (i, row) in a.iter_mut().enumerate() {
        row[i] += 1e-7 * most + f64::MIN_POSITIVE;
    }
    for i in 0..n {
        let pivot = a[i][i];
        if pivot.is_nan() || pivot <= 0.0 {
            return None;
        }
        for r in i + 1..n {
            let factor = a[r][i] / pivot;
            let (above, below) = a.split_at_mut(r);
            for (to, from) in below[0][i..].iter_mut().zip(&above[i][i..]) {
                *to -= factor * from;
            }
            x[r] -= factor * x[i];
        }
    }
    for i in (0..n).rev() {
        let sum: f64 = (i + 1..n).map(|k| a[i][k] * x[k]).sum();
        x[i] = (x[i] - sum) / a[i][i];
    }
    let sum: f64 = x.iter().sum();
    (sum.is_finite() && sum != 0.0).then(|| x.into_iter().map(|x| x / sum).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rng::Key;

    #[test]
    fn the_best_mixture_ends_and_is_no_worse_than_the_best_one() {
        // Candidates that are alike but for rounding, and some that are not: exchanges between them must come to an end.
        for case in 0..2000_u64 {
            let key = Key::new(case, "best");
            let (count, each) = (2 + (case % 23) as usize, 1 + (case % 7) as usize);
            let alike = 10_f32.powi(-(key.with(1).range(0.0, 9.0) as i32));
            let base: Vec<Vec3> = (0..each as u64).map(|f| key.with(2).with(f).direction()).collect();
            let offset = |i: usize, f: usize| {
                let own = key.with(3).with(i as u64).with(f as u64).direction();
                base[f] * key.with(4).with(i as u64 % 3).range(0.5, 1.5) + own * alike
            };
            let offsets: Vec<Vec3> =
                (0..count).flat_map(|i| (0..each).map(move |f| (i, f))).map(|(i, f)| offset(i, f)).collect();
            let (chosen, weights) = best(&offsets, count, each);
            assert!(!chosen.is_empty() && chosen.len() <= FOLLOWED && chosen.len() == weights.len());
            assert!(weights.iter().all(|w| *w >= -1e-9) && (weights.iter().sum::<f64>() - 1.0).abs() < 1e-6);
            let length = |mix: &dyn Fn(usize) -> Vec3| (0..each).map(|f| mix(f).length_squared()).sum::<f32>();
            let mixed = length(&|f| chosen.iter().zip(&weights).map(|(&i, &w)| offsets[i * each + f] * w as f32).sum());
            let single = (0..count).map(|i| length(&|f| offsets[i * each + f])).fold(f32::INFINITY, f32::min);
            assert!(mixed <= single * 1.001 + 1e-9, "{case}: {mixed} {single}");
        }
    }
}
