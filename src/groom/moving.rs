//! Strands in motion: members that follow guides from frame to frame, waves and curls that stay where they are.
//!
//! What decides about a strand is decided once, at rest: which guides a member follows and how much, how many nodes it
//! has, where a domain acts, in which direction a frame along a strand starts. A frame only asks where the guides are
//! now, so nothing flickers. With a motion of the head all of this happens as seen from the head.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use glam::{Affine3A, Quat, Vec3};
use rayon::prelude::*;

use super::error::GroomError;
use super::fill::{Fill, Prepared, Worker, check, left_out, usual_nodes};
use super::natural::{Deform, deform, deform_frame};
use crate::geometry::clear::{Outcome, Scratch};
use crate::geometry::slide::Body;
use crate::geometry::{Clear, Clip, Root, Solid, Strands};
use crate::task::{Task, Warned};

/// Most memory of one clip, in 10^9 bytes.
const MOST: f64 = 4.0;

/// Strands at rest and at each frame, of one topology.
#[derive(Clone, Debug)]
pub struct Moving {
    /// At rest.
    pub rest: Strands,
    /// At each frame.
    pub frames: Clip<Strands>,
}

/// Refuses a clip of more than [`MOST`].
fn check_memory(strands: usize, nodes: usize, frames: usize) -> Result<(), GroomError> {
    let gigabytes = frames as f64 * (nodes as f64 * 12.0 + strands as f64 * 64.0) / 1e9;
    let limit = MOST;
    if gigabytes > limit { Err(GroomError::Clip { strands, nodes, frames, gigabytes, limit }) } else { Ok(()) }
}

/// A frame as seen from the head.
fn from_head(frame: &Strands, head: Option<&Affine3A>) -> Strands {
    match head {
        Some(by) => frame.transformed(&by.inverse()),
        None => frame.clone(),
    }
}

fn check_topology(rest: &Strands, clip: &Clip<Strands>) -> Result<(), GroomError> {
    match clip.frames.iter().position(|f| f.offsets != rest.offsets || f.points.len() != rest.points.len()) {
        Some(i) => Err(GroomError::Topology { frame: i + 1 }),
        None => Ok(()),
    }
}

/// The guides and weights of a member.
type Choice = Option<(usize, Vec<(usize, f32)>)>;

/// Grows one member from every root, at rest (along `input.guides`) and at each frame of the guides' clip. `head` is the
/// motion of the head that is in the frames. A member that finds no way out of the head in any frame grows in none.
///
/// # Errors
/// As [`fill`](super::fill()); frames of another topology than the guides at rest, more memory than a clip may take.
pub fn fill_clip(
    input: &Fill,
    guides: &Clip<Strands>,
    head: Option<&Clip<Affine3A>>,
    task: &Task,
) -> Result<Warned<Moving>, GroomError> {
    check_topology(input.guides, guides)?;
    let at = |i: usize| head.and_then(|h| h.at(i)).map(|t| &**t);
    let (n, count) = (input.roots.len(), guides.count());
    // As many nodes as the sharpest bends of any frame need.
    let mut nodes = check(input)?;
    if input.options.nodes.is_none() {
        nodes = guides.frames.iter().map(|f| usual_nodes(f)).fold(nodes, usize::max);
    }
    check_memory(n, n * nodes, count + 1)?;

    let thickness = input.options.thickness;
    let rest = Prepared::new(input.guides, nodes, thickness, None).agreeing(input.guides);
    task.check()?;
    let choices: Vec<Choice> = input
        .roots
        .par_iter()
        .map_init(Worker::default, |worker, root| {
            worker.choose(input, &rest, root).map(|guide| (guide, worker.weights.clone()))
        })
        .collect();

    let stuck: Vec<AtomicBool> = (0..n).map(|_| false.into()).collect();
    let members = |prepared: &Prepared| -> Result<Vec<Vec3>, GroomError> {
        let mut points = vec![Vec3::ZERO; n * nodes];
        points.par_chunks_mut(nodes).enumerate().for_each_init(Worker::default, |worker, (i, points)| {
            let Some((guide, weights)) = &choices[i] else { return };
            if task.is_cancelled() {
                return;
            }
            worker.weights.clone_from(weights);
            worker.grow(input, prepared, *guide, &input.roots[i], points);
            if let Some(solid) = input.solid {
                let clear = Clear { body: Body { solid, margin: input.options.margin } };
                if clear.strand(points, &mut worker.scratch) == Outcome::Stuck {
                    stuck[i].store(true, Ordering::Relaxed);
                }
            }
        });
        task.check()?;
        Ok(points)
    };
    let mut still = members(&rest)?;
    let mut frames = Vec::with_capacity(count);
    for (i, frame) in guides.frames.iter().enumerate() {
        task.progress("filling", i as f32 / count as f32);
        let guides = from_head(frame, at(i));
        guides.validate()?;
        frames.push(members(&Prepared::new(&guides, nodes, thickness, Some(&rest.firsts)))?);
    }
    task.progress("filling", 1.0);

    let is_stuck = |i: usize| stuck[i].load(Ordering::Relaxed);
    let kept: Vec<usize> = (0..n).filter(|&i| choices[i].is_some() && !is_stuck(i)).collect();
    let alone = choices.iter().filter(|c| c.is_none()).count();
    let warnings = left_out(alone, n - alone - kept.len(), n);
    let keep = |points: &mut Vec<Vec3>| {
        for (to, &from) in kept.iter().enumerate() {
            points.copy_within(from * nodes..(from + 1) * nodes, to * nodes);
        }
        points.truncate(kept.len() * nodes);
    };
    keep(&mut still);
    let roots: Vec<Root> = kept.iter().map(|&i| input.roots[i]).collect();
    let guide = |i: usize| choices[i].as_ref().map_or(0, |c| c.0);
    let rest = Strands {
        points: still,
        offsets: (0..=kept.len()).map(|i| (i * nodes) as u32).collect(),
        guide: kept.iter().map(|&i| guide(i) as u32).collect(),
        source: vec![0; kept.len()],
        sources: vec![Arc::clone(input.source)],
        stage: kept.iter().flat_map(|&i| &rest.stages[guide(i) * nodes..(guide(i) + 1) * nodes]).copied().collect(),
        roots,
    };
    let frames = frames.into_iter().enumerate().map(|(i, mut points)| {
        keep(&mut points);
        // Stages do not change; frames do without them.
        let frame = Strands { points, stage: vec![], ..without_nodes(&rest) };
        Arc::new(at(i).map_or_else(|| frame.clone(), |by| frame.transformed(by)))
    });
    let frames = Clip { rate: guides.rate, looped: guides.looped, frames: frames.collect() };
    Ok(Warned { value: Moving { rest, frames }, warnings })
}

/// Everything but the nodes.
fn without_nodes(strands: &Strands) -> Strands {
    Strands {
        points: vec![],
        stage: vec![],
        offsets: strands.offsets.clone(),
        roots: strands.roots.clone(),
        guide: strands.guide.clone(),
        source: strands.source.clone(),
        sources: strands.sources.clone(),
    }
}

/// Lays natural domains over strands (`input.strands`) at rest and at each frame of their clip. `head` is the motion of
/// the head that is in the frames.
///
/// # Errors
/// As [`deform`]; frames of another topology than the strands at rest, more memory than a clip may take.
pub fn deform_clip(
    input: &Deform,
    clip: &Clip<Strands>,
    head: Option<&Clip<Affine3A>>,
    task: &Task,
) -> Result<Warned<Moving>, GroomError> {
    check_topology(input.strands, clip)?;
    let Warned { value: rest, warnings } = deform(input, task)?;
    check_memory(rest.count(), rest.points.len(), clip.count() + 1)?;
    let frames = clip.try_map(|i, frame| {
        let by = head.and_then(|h| h.at(i)).map(|t| &**t);
        let strands = from_head(frame, by);
        let mut bent = deform_frame(&Deform { strands: &strands, ..*input }, Some(input.strands), task)?.value;
        bent.stage = vec![];
        Ok::<_, GroomError>(Arc::new(by.map_or_else(|| bent.clone(), |by| bent.transformed(by))))
    })?;
    Ok(Warned { value: Moving { rest, frames }, warnings })
}

/// Frames of strands on their way through poses, which are strands of one topology; `ways` says for each frame which
/// pose it comes from, to which it goes, and what part of the way is done. Segments turn and keep their length: strands
/// that are as long in all poses are so in all frames.
///
/// # Errors
/// Poses of another topology than the first, more memory than a clip may take, cancelled.
pub fn pass_through(
    poses: &[Arc<Strands>],
    ways: &[(usize, usize, f32)],
    solid: Option<(&Solid, f32)>,
    task: &Task,
) -> Result<Vec<Arc<Strands>>, GroomError> {
    let Some(first) = poses.first() else { return Err(GroomError::Nothing { what: "poses" }) };
    for (i, pose) in poses.iter().enumerate() {
        pose.validate()?;
        if pose.offsets != first.offsets {
            return Err(GroomError::Topology { frame: i + 1 });
        }
    }
    check_memory(first.count(), first.points.len(), ways.len())?;
    let frame = |&(from, to, t): &(usize, usize, f32)| -> Result<Arc<Strands>, GroomError> {
        task.check()?;
        let (Some(a), Some(b)) = (poses.get(from), poses.get(to)) else { return Ok(Arc::clone(first)) };
        if t <= 0.0 || t >= 1.0 || from == to {
            return Ok(Arc::clone(if t >= 1.0 { b } else { a }));
        }
        let strand = |scratch: &mut Scratch, i: usize| -> Vec<Vec3> {
            let (a, b) = (a.strand(i), b.strand(i));
            let mut at = a[0].lerp(b[0], t);
            let mut points = vec![at];
            for (a, b) in a.windows(2).zip(b.windows(2)) {
                let (x, y) = (a[1] - a[0], b[1] - b[0]);
                let (u, v) = (x.normalize_or_zero(), y.normalize_or_zero());
                let way = Quat::IDENTITY.slerp(Quat::from_rotation_arc(u, v), t) * u;
                at += way.normalize_or(u) * (x.length() + (y.length() - x.length()) * t);
                points.push(at);
            }
            if let Some((solid, margin)) = solid {
                Clear { body: Body { solid, margin } }.strand(&mut points, scratch);
            }
            points
        };
        let strands: Vec<Vec<Vec3>> = (0..a.count()).into_par_iter().map_init(Scratch::default, strand).collect();
        let mut roots = a.roots.clone();
        for (root, other) in roots.iter_mut().zip(&b.roots) {
            root.position = root.position.lerp(other.position, t);
            root.normal = root.normal.lerp(other.normal, t).normalize_or(root.normal);
        }
        Ok(Arc::new(Strands { points: strands.concat(), roots, ..without_nodes(a) }))
    };
    ways.iter().map(frame).collect()
}
