//! Natural deformation: waves, curls and any other curve laid over finished strands, (5) to (8).
//!
//! The strand as it is serves as the axis. The queue of natural domains is followed along it, which gives the interval
//! [s0, s1] of arc length where each domain acts, exactly where the axis crosses its box. Nodes move within the
//! rotation-minimising frame: along the normal N, which leads away from the head wherever a strand bends around it, and
//! along the binormal B.

use std::f32::consts::TAU;
use std::sync::Arc;

use glam::{Vec2, Vec3};

use super::domain::{Curl, Domain, Measure, NaturalOptions, Turn, Wave};
use super::error::{GroomError, check_size, check_value};
use super::grow::{never_entered, stuck_warning};
use super::layout;
use super::noise;
use super::queue::{Entered, Stage, stages};
use crate::geometry::clear::{Clear, Outcome, Scratch};
use crate::geometry::{OrientedBox, Root, Solid, Strands, curve, curve::Resampler, frames, slide::Body};
use crate::math::{rng::Key, trig};
use crate::params::{Function, Object};
use crate::task::{Task, Warned};

crate::params! {
    /// Lays waves and curls over strands. The domains form a queue of their own, by their priorities: each acts on the
    /// part of a strand inside its box, one stage after the other.
    pub struct DeformOptions("Strands:natural") {
        /// The natural domains.
        domains: Vec<Arc<Domain>>, positional();
        /// Takes a strand's root (a vector), returns true for the strands to change; all when left out.
        r#where: Option<Function>, takes("(root: vector): boolean");
        /// Least distance of hair from the skin.
        margin: f32 = 0.05, unit("cm"), range(0.005, 10.0);
        /// Another seed gives other random numbers.
        seed: u64 = 0;
    }
}

/// The curve of a natural domain.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// Equation (5): `An sin` along the normal, `Ab cos` along the binormal.
    Helix {
        /// An at the interval's start, cm.
        normal: f32,
        /// Ab at the interval's start, cm.
        binormal: f32,
        /// Both at the interval's end, as a part of what they are at its start.
        tip: f32,
    },
    /// Offsets along normal and binormal in cm, evenly spaced over what `over` says, straight between; at least one.
    Table {
        /// The offsets.
        offsets: Arc<[Vec2]>,
        /// What they run over.
        over: Measure,
    },
}

/// A natural domain, resolved.
#[derive(Clone, Debug, PartialEq)]
pub struct Natural {
    /// Where it acts.
    pub region: OrientedBox,
    /// Its curve.
    pub shape: Shape,
    /// T, cm.
    pub period: f32,
    /// Sigma at the start, in (0, 0.5].
    pub smooth: f32,
    /// Sigma at the end, in 0..=0.5; 0 for no fall.
    pub smooth_end: f32,
    /// Added to the angle, radians.
    pub phase: f32,
    /// 0..=1: up to how much of a turn is added strand by strand.
    pub phase_variation: f32,
    /// 0..=1: up to how much of the radius is taken off strand by strand.
    pub radius_variation: f32,
    /// Turn of the frame about the strand, radians; mirrored on the head's right.
    pub tilt: f32,
    /// Which way it turns.
    pub turn: Turn,
    /// Deviation of the noise, as a part of the radius.
    pub noise: f32,
    /// Order within the queue.
    pub priority: i32,
    /// The name that the script gave it.
    pub name: Option<String>,
}

impl From<&Wave> for Natural {
    fn from(w: &Wave) -> Self {
        Self {
            region: w.r#box,
            shape: helix(w.radius, w.radius_tip, 0.0),
            period: w.period,
            smooth: w.smooth,
            smooth_end: w.smooth_end.unwrap_or(w.smooth),
            phase: w.phase.radians,
            phase_variation: w.phase_variation,
            radius_variation: w.radius_variation,
            tilt: w.tilt.radians,
            turn: Turn::Right,
            noise: w.noise,
            priority: w.priority,
            name: w.name.clone(),
        }
    }
}

impl From<&Curl> for Natural {
    fn from(c: &Curl) -> Self {
        Self {
            region: c.r#box,
            shape: helix(c.radius, c.radius_tip, c.flatness),
            period: c.period,
            smooth: c.smooth,
            smooth_end: c.smooth_end.unwrap_or(c.smooth),
            phase: c.phase.radians,
            phase_variation: c.phase_variation,
            radius_variation: c.radius_variation,
            tilt: 0.0,
            turn: c.turn,
            noise: c.noise,
            priority: c.priority,
            name: c.name.clone(),
        }
    }
}

/// Waves and helices; a radius of 0 that grows is given by a tiny one, so that the tip is still a part of it.
fn helix(radius: f32, tip: Option<f32>, flatness: f32) -> Shape {
    let start = radius.max(1e-6);
    Shape::Helix { normal: start, binormal: start * flatness, tip: tip.map_or(1.0, |tip| tip / start) }
}

impl Natural {
    /// A custom curve: `options`, and the curve's function sampled evenly over 0..=1, both ends included.
    pub fn custom(options: &NaturalOptions, offsets: Arc<[Vec2]>) -> Self {
        Self {
            region: options.r#box,
            shape: Shape::Table { offsets, over: options.over },
            period: options.period,
            smooth: options.smooth,
            smooth_end: options.smooth_end.unwrap_or(options.smooth),
            phase: options.phase.radians,
            phase_variation: options.phase_variation,
            radius_variation: options.radius_variation,
            tilt: options.tilt.radians,
            turn: Turn::Right,
            noise: options.noise,
            priority: options.priority,
            name: options.name.clone(),
        }
    }

    /// The offsets (n, b) in cm at arc length `s` of the interval [s0, s1], by (5), for a strand whose phase is moved by
    /// `phase` radians.
    pub fn offset(&self, s: f32, s0: f32, s1: f32, phase: f32) -> Vec2 {
        let along = s - s0;
        let size = scale_with(s, s0, s1, self.smooth, self.smooth_end);
        let angle = TAU * along / self.period + phase;
        match &self.shape {
            Shape::Helix { normal, binormal, tip } => {
                let radius = size * (1.0 + (tip - 1.0) * (along / (s1 - s0)).clamp(0.0, 1.0));
                let b = if *binormal == 0.0 { 0.0 } else { fade(along, self.period) * binormal * trig::cos(angle) };
                Vec2::new(normal * trig::sin(angle), b) * radius
            }
            Shape::Table { offsets, over } => {
                let turns = angle / TAU;
                let u = match over {
                    Measure::Period => turns - turns.floor(),
                    Measure::Part => (along / (s1 - s0)).clamp(0.0, 1.0),
                    Measure::Length => turns.clamp(0.0, 1.0),
                };
                let at = u * (offsets.len() - 1) as f32;
                let i = (at as usize).min(offsets.len() - 1);
                let next = offsets[(i + 1).min(offsets.len() - 1)];
                offsets[i].lerp(next, at - i as f32) * size
            }
        }
    }

    /// The greatest distance between nodes that still shows the curve: twelve nodes in a period.
    fn spacing(&self, s0: f32, s1: f32) -> f32 {
        match &self.shape {
            Shape::Helix { .. } => self.period / 12.0,
            Shape::Table { over: Measure::Part, .. } => (s1 - s0) / 32.0,
            Shape::Table { .. } => self.period / 24.0,
        }
    }

    fn check(&self, name: &str) -> Result<(), GroomError> {
        if !self.region.is_valid() {
            return Err(GroomError::EmptyBox { domain: name.into(), size: self.region.half * 2.0 });
        }
        check_value(format!("the period of {name}"), self.period, 1e-3, f32::MAX)?;
        check_value(format!("the smoothing of {name}"), self.smooth, 1e-6, 0.5)?;
        check_value(format!("the smoothing at the end of {name}"), self.smooth_end, 0.0, 0.5)?;
        check_value(format!("the noise of {name}"), self.noise, 0.0, f32::MAX)?;
        for (what, value) in [("phase", self.phase), ("tilt", self.tilt)] {
            check_value(format!("the {what} of {name}"), value, f32::MIN, f32::MAX)?;
        }
        match &self.shape {
            Shape::Helix { normal, binormal, tip } => {
                for radius in [*normal, *binormal, normal * tip, binormal * tip] {
                    check_value(format!("a radius of {name}"), radius, 0.0, 1e4)?;
                }
            }
            Shape::Table { offsets, .. } => {
                check_value(format!("the number of offsets of {name}"), offsets.len() as f32, 1.0, 1e7)?;
                for o in offsets.iter() {
                    check_value(format!("an offset of {name}"), o.x, -1e4, 1e4)?;
                    check_value(format!("an offset of {name}"), o.y, -1e4, 1e4)?;
                }
            }
        }
        Ok(())
    }

    /// The largest radius, cm.
    fn radius(&self) -> f32 {
        match &self.shape {
            Shape::Helix { normal, binormal, tip } => normal.max(*binormal) * tip.max(1.0),
            Shape::Table { offsets, .. } => offsets.iter().map(|o| o.length()).fold(0.0, f32::max),
        }
    }
}

/// Equation (6): 0 where the interval starts, exp(-T / (s - s0)) after.
pub fn fade(along: f32, period: f32) -> f32 {
    if along > 0.0 { trig::exp(-period / along) } else { 0.0 }
}

/// P of equation (7): a step from 0 to 1 with a continuous derivative.
pub fn ramp(b: f32) -> f32 {
    if b <= 0.0 {
        0.0
    } else if b <= 0.5 {
        2.0 * b * b
    } else if b < 1.0 {
        1.0 - 2.0 * (b - 1.0) * (b - 1.0)
    } else {
        1.0
    }
}

/// Equation (8): rises over the part `sigma` of [s0, s1], stays at 1, falls over the same part.
pub fn scale(s: f32, s0: f32, s1: f32, sigma: f32) -> f32 {
    scale_with(s, s0, s1, sigma, sigma)
}

/// (8) with a sigma of its own for the fall; with 0 there is none.
fn scale_with(s: f32, s0: f32, s1: f32, rise: f32, fall: f32) -> f32 {
    let length = s1 - s0;
    if s <= 0.5 * (s0 + s1) {
        ramp((s - s0) / (rise * length))
    } else if fall > 0.0 {
        1.0 - ramp((s - (s1 - fall * length)) / (fall * length))
    } else {
        1.0
    }
}

/// Natural domains in stages.
#[derive(Clone, Debug)]
pub struct NaturalQueue {
    domains: Vec<Arc<Domain>>,
    naturals: Vec<Arc<Natural>>,
    stages: Vec<Stage>,
}

impl Object for NaturalQueue {
    const NAME: &'static str = "NaturalQueue";
}

/// Where a domain acts on a strand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Index of the domain.
    pub domain: usize,
    /// Arc length where it starts, cm.
    pub s0: f32,
    /// Arc length where it ends, cm.
    pub s1: f32,
}

impl NaturalQueue {
    /// Forms the stages.
    ///
    /// # Errors
    /// A domain of another kind, a box without volume, a number out of its range.
    pub fn new(domains: Vec<Arc<Domain>>) -> Result<Self, GroomError> {
        let mut naturals = Vec::new();
        for (i, domain) in domains.iter().enumerate() {
            let Domain::Natural(natural) = &**domain else {
                return Err(GroomError::WrongKind { domain: domain.label(i), queue: "natural domains" });
            };
            natural.check(&domain.label(i))?;
            naturals.push(Arc::clone(natural));
        }
        let stages = stages(naturals.iter().map(|n| n.priority));
        Ok(Self { domains, naturals, stages })
    }

    /// The domains, as written.
    pub fn domains(&self) -> &[Arc<Domain>] {
        &self.domains
    }

    /// Follows the queue along an axis: writes the interval of every domain that acted, in the order they end.
    pub fn intervals(&self, axis: &[Vec3], entered: Option<&Entered>, out: &mut Vec<Interval>) {
        #[derive(Clone, Copy)]
        enum State {
            Waiting,
            Active(f32),
            Dismissed,
        }
        out.clear();
        let mut states: Vec<State> = Vec::new();
        let (mut next, mut left, mut s) = (0, 0, 0.0_f32);
        for w in axis.windows(2) {
            let way = w[0].distance(w[1]);
            // The next stage is visible from where the last domain of this one let go, also within a segment.
            let mut cursor = 0.0_f32;
            loop {
                if left == 0 {
                    let Some(stage) = self.stages.get(next) else { break };
                    next += 1;
                    states.clear();
                    states.resize(stage.domains.len(), State::Waiting);
                    left = stage.domains.len();
                }
                let mut last = cursor;
                for (&domain, state) in self.stages[next - 1].domains.iter().zip(&mut states) {
                    let clip = self.naturals[domain].region.clip(w[0], w[1]).filter(|c| c.1 >= cursor);
                    let (s0, leaves) = match (*state, clip) {
                        (State::Active(s0), Some((_, t1))) => (s0, (t1 < 1.0).then_some(t1)),
                        (State::Active(s0), None) => (s0, Some(cursor)),
                        (State::Waiting, Some((t0, t1))) => {
                            if let Some(entered) = entered {
                                entered.note(domain);
                            }
                            (s + way * t0.max(cursor), (t1 < 1.0).then_some(t1))
                        }
                        (State::Waiting, None) | (State::Dismissed, _) => continue,
                    };
                    *state = State::Active(s0);
                    if let Some(t) = leaves {
                        *state = State::Dismissed;
                        left -= 1;
                        last = last.max(t);
                        out.push(Interval { domain, s0, s1: s + way * t });
                    }
                }
                if left > 0 {
                    break;
                }
                cursor = last;
            }
            s += way;
        }
        if let Some(stage) = next.checked_sub(1).map(|i| &self.stages[i]) {
            for (&domain, state) in stage.domains.iter().zip(&states) {
                if let State::Active(s0) = *state {
                    out.push(Interval { domain, s0, s1: s });
                }
            }
        }
        out.retain(|i| i.s1 - i.s0 > 1e-4);
    }
}

/// What [`deform`] changes, and by what.
#[derive(Clone, Copy, Debug)]
pub struct Deform<'a> {
    /// The strands.
    pub strands: &'a Strands,
    /// The natural domains.
    pub queue: &'a NaturalQueue,
    /// Per strand: whether it is changed. Empty: all are.
    pub which: &'a [bool],
    /// The body to keep out of, if there is one.
    pub solid: Option<&'a Solid>,
    /// Least distance of nodes from the body, cm.
    pub margin: f32,
    /// Seed of the variations and the noise.
    pub seed: u64,
}

/// Lays natural domains over strands. A strand with a period finer than its nodes can show gets more of them.
///
/// # Errors
/// No or bad strands, numbers out of range, too many nodes, or the task was cancelled.
pub fn deform(input: &Deform, task: &Task) -> Result<Warned<Strands>, GroomError> {
    deform_frame(input, None, task)
}

/// The same for a frame of a clip whose strands are `rest` at rest, which are of one topology: each domain acts on the
/// part of a strand that is in its box at rest, so that waves do not run along strands that move.
pub(super) fn deform_frame(input: &Deform, rest: Option<&Strands>, task: &Task) -> Result<Warned<Strands>, GroomError> {
    let from = input.strands;
    from.validate()?;
    let n = from.count();
    if n == 0 {
        return Err(GroomError::Nothing { what: "strands" });
    }
    check_value("the margin", input.margin, 0.005, f32::MAX)?;
    if !input.which.is_empty() && input.which.len() != n {
        return Err(GroomError::Count { what: "choices of strands", count: input.which.len(), expected: n });
    }

    let entered = Entered::new(input.queue.domains.len());
    let counts = count_nodes(&Deform { strands: rest.unwrap_or(from), ..*input }, &entered, task)?;
    check_size(n as u64, counts.iter().map(|&c| c as u64).sum())?;
    let offsets = layout::offsets(counts.iter().copied());
    let nodes = offsets.last().map_or(0, |&o| o as usize);
    let mut strands = Strands {
        points: vec![Vec3::ZERO; nodes],
        offsets,
        roots: from.roots.clone(),
        guide: from.guide.clone(),
        source: from.source.clone(),
        sources: from.sources.clone(),
        stage: vec![0; nodes],
    };
    let stuck: Vec<std::sync::atomic::AtomicBool> = (0..n).map(|_| false.into()).collect();
    layout::write_all(&mut strands, task, "waving and curling", Worker::default, |worker, i, points, stages| {
        if worker.strand(input, rest, i, points, stages) == Outcome::Stuck && rest.is_none() {
            stuck[i].store(true, std::sync::atomic::Ordering::Relaxed);
        }
    })?;
    task.progress("waving and curling", 1.0);

    // A strand that was outside before is outside as it was, so none is left out here but those that came in stuck.
    let mut warnings = Vec::new();
    for (i, is_stuck) in stuck.iter().enumerate() {
        if is_stuck.load(std::sync::atomic::Ordering::Relaxed) {
            let range = strands.range(i);
            let mut at = Resampler::default();
            at.uniform(from.strand(i), &mut strands.points[range], |_, _| ());
        }
    }
    let count = stuck.iter().filter(|s| s.load(std::sync::atomic::Ordering::Relaxed)).count();
    if count > 0 {
        warnings.push(stuck_warning(count, n, "strands"));
    }
    warnings.extend(entered.never().map(|d| never_entered(&input.queue.domains[d], d, "the natural queue", from)));
    Ok(Warned { value: strands, warnings })
}

/// Nodes that all strands together have after [`deform`].
///
/// # Errors
/// Bad strands, or the task was cancelled.
pub fn deformed_points(input: &Deform, task: &Task) -> Result<usize, GroomError> {
    input.strands.validate()?;
    Ok(count_nodes(input, &Entered::new(input.queue.domains.len()), task)?.iter().sum())
}

/// How many nodes every strand needs.
fn count_nodes(input: &Deform, entered: &Entered, task: &Task) -> Result<Vec<usize>, GroomError> {
    use rayon::prelude::*;
    let from = input.strands;
    let counts = (0..from.count())
        .into_par_iter()
        .map_init(Vec::new, |intervals, i| {
            let points = from.strand(i);
            if !input.which.get(i).copied().unwrap_or(true) || task.is_cancelled() {
                return points.len();
            }
            input.queue.intervals(points, Some(entered), intervals);
            let spacing = |v: &Interval| input.queue.naturals[v.domain].spacing(v.s0, v.s1);
            let finest = intervals.iter().map(spacing).fold(f32::INFINITY, f32::min);
            // A spline is longer than its polyline, by a little.
            points.len().max((1.02 * curve::length(points) / finest).ceil() as usize + 1)
        })
        .collect();
    task.check()?;
    Ok(counts)
}

/// The direction in which the frame of a strand starts: away from where the strand bends to, so that the normal leads
/// away from a head that it hangs around; for straight strands along the root's normal. It changes smoothly with the
/// strand, and mirrored strands get mirrored directions.
pub fn first_normal(points: &[Vec3], tangent: Vec3, root: &Root) -> Vec3 {
    let (Some(&first), Some(&last)) = (points.first(), points.last()) else { return root.normal };
    let across = |v: Vec3| v - tangent * v.dot(tangent);
    let bend = across((last - first).normalize_or_zero());
    let n = across(root.normal) * 0.1 + across(Vec3::Y) * 0.02 + across(Vec3::Z) * 0.004 - bend;
    frames::perpendicular(n, tangent)
}

/// One thread's memory.
#[derive(Default)]
struct Worker {
    resampler: Resampler,
    /// The strand at rest.
    axis: Vec<Vec3>,
    tangents: Vec<Vec3>,
    normals: Vec<Vec3>,
    lengths: Vec<f32>,
    intervals: Vec<Interval>,
    scratch: Scratch,
}

impl Worker {
    fn strand(
        &mut self,
        input: &Deform,
        rest: Option<&Strands>,
        i: usize,
        out: &mut [Vec3],
        stages: &mut [u8],
    ) -> Outcome {
        let from = input.strands;
        let points = from.strand(i);
        let old_stages = if from.stage.is_empty() { &[][..] } else { &from.stage[from.range(i)] };
        if points.len() == out.len() {
            out.copy_from_slice(points);
            stages.iter_mut().zip(old_stages).for_each(|(new, old)| *new = *old);
        } else {
            self.resampler.uniform(points, out, |j, at| {
                stages[j] = old_stages.get(at.ceil() as usize).copied().unwrap_or(0);
            });
        }
        if !input.which.get(i).copied().unwrap_or(true) {
            return Outcome::Clear;
        }
        let root = &from.roots[i];
        let first = match rest {
            Some(rest) => self.at_rest(input, rest, i, out),
            None => {
                input.queue.intervals(out, None, &mut self.intervals);
                None
            }
        };
        if self.intervals.is_empty() {
            return Outcome::Clear;
        }
        self.displace(input, root, first, out);
        match input.solid {
            Some(solid) => Clear { body: Body { solid, margin: input.margin } }.strand(out, &mut self.scratch),
            None => Outcome::Clear,
        }
    }

    /// Finds where domains act on a strand at rest, for the strand as it is now, and in which direction its frame starts.
    fn at_rest(&mut self, input: &Deform, rest: &Strands, i: usize, now: &[Vec3]) -> Option<Vec3> {
        let (points, n) = (rest.strand(i), now.len());
        self.axis.resize(n, Vec3::ZERO);
        if points.len() == n {
            self.axis.copy_from_slice(points);
        } else {
            self.resampler.uniform(points, &mut self.axis, |_, _| ());
        }
        input.queue.intervals(&self.axis, None, &mut self.intervals);
        let longer = curve::length(now) / curve::length(&self.axis).max(1e-6);
        for interval in &mut self.intervals {
            (interval.s0, interval.s1) = (interval.s0 * longer, interval.s1 * longer);
        }
        self.tangents.resize(n, Vec3::ZERO);
        frames::tangents(&self.axis, &mut self.tangents[..n]);
        Some(first_normal(&self.axis, self.tangents[0], rest.roots.get(i)?))
    }

    /// `first` is the direction in which the frame starts, when that is known already.
    fn displace(&mut self, input: &Deform, root: &Root, first: Option<Vec3>, points: &mut [Vec3]) {
        let n = points.len();
        self.tangents.resize(n, Vec3::ZERO);
        self.normals.resize(n, Vec3::ZERO);
        frames::tangents(points, &mut self.tangents[..n]);
        let first = match first {
            Some(first) => frames::perpendicular(first, self.tangents[0]),
            None => first_normal(points, self.tangents[0], root),
        };
        frames::normals(points, &self.tangents[..n], first, &mut self.normals[..n]);
        let mut s = 0.0;
        self.lengths.clear();
        self.lengths.push(0.0);
        self.lengths.extend(points.windows(2).map(|w| {
            s += w[0].distance(w[1]);
            s
        }));

        let is_right = root.position.x < 0.0;
        for interval in &self.intervals {
            let natural = &input.queue.naturals[interval.domain];
            let key = Key::new(input.seed, "natural").with(interval.domain as u64).with(root.id);
            let phase = natural.phase + TAU * natural.phase_variation * key.with(1).unit();
            let size = 1.0 - natural.radius_variation * key.with(2).unit();
            let hand = match natural.turn {
                Turn::Right => 1.0,
                Turn::Left => -1.0,
                Turn::Mirrored => {
                    if is_right {
                        -1.0
                    } else {
                        1.0
                    }
                }
                Turn::Random => {
                    if key.with(3).unit() < 0.5 {
                        -1.0
                    } else {
                        1.0
                    }
                }
            };
            let tilt = if is_right { -natural.tilt } else { natural.tilt };
            let (sin, cos) = (trig::sin(tilt), trig::cos(tilt));
            let amount = natural.noise * natural.radius();
            for (k, p) in points.iter_mut().enumerate() {
                let s = self.lengths[k];
                if s < interval.s0 || s > interval.s1 {
                    continue;
                }
                let (t, normal) = (self.tangents[k], self.normals[k]);
                let binormal = t.cross(normal);
                let o = natural.offset(s, interval.s0, interval.s1, phase) * size;
                let (a, b) = (o.x, o.y * hand);
                *p += normal * (a * cos - b * sin) + binormal * (a * sin + b * cos);
                if amount > 0.0 {
                    // A knot of noise each quarter period: faster would be jagged, slower would not show.
                    let wobble = noise::smooth(key.with(4), 4.0 * s / natural.period) * amount;
                    *p += wobble * scale_with(s, interval.s0, interval.s1, natural.smooth, natural.smooth_end);
                }
            }
        }
    }
}
