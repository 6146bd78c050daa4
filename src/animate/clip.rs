//! Frames: the handles of a rig along their paths.

use std::sync::Arc;

use glam::Vec3;
use rayon::prelude::*;

use super::{AnimateError, Posed, Rig};
use crate::geometry::Clip;
use crate::task::{Task, Warned, Warning};

/// Weights beyond these are further from the states than blends of them look good, and worth a warning.
const REACH: std::ops::RangeInclusive<f64> = -1.5..=2.5;
/// Frames between two looks at the task.
const CHECK: usize = 4;
/// Two laps of a loop that end further apart than this share of the mesh's size are not the same.
const SAME_LAP: f64 = 1e-3;

/// A rig over time.
#[derive(Clone, Debug)]
pub struct Animation {
    /// All vertices of the mesh, frame by frame, cm.
    pub clip: Clip<Vec<Vec3>>,
    /// How each frame was found.
    pub posed: Vec<Posed>,
}

/// Poses a rig frame by frame: handle `i` is at `paths[i][f]` in frame `f`.
///
/// A loop's first frame is posed from its last: it is gone through again until it ends as it began.
///
/// # Errors
/// Paths that do not fit the rig, a frame that does not come to rest, a cancelled task.
pub fn animate(
    rig: &Rig,
    paths: &[Vec<Vec3>],
    rate: f32,
    looped: bool,
    task: &Task,
) -> Result<Warned<Animation>, AnimateError> {
    let count = checked(rig, paths, rate)?;
    let mut poser = rig.poser();
    let (mut frames, mut posed) = (Vec::with_capacity(count), Vec::with_capacity(count));
    let mut warnings = Vec::new();
    let mut targets = vec![Vec3::ZERO; paths.len()];
    let mut pose = |frame: usize, poser: &mut super::Poser| {
        if frame.is_multiple_of(CHECK) {
            task.check()?;
        }
        targets.iter_mut().zip(paths).for_each(|(to, path)| *to = path[frame]);
        let mut positions = vec![Vec3::ZERO; rig.rest.len()];
        let found = poser.pose(&targets, &mut positions);
        if !found.converged {
            let (iterations, step) = (found.iterations, found.step as f32);
            return Err(AnimateError::NotConverged { frame: frame + 1, iterations, step });
        }
        Ok((positions, found))
    };
    for frame in 0..count {
        let (positions, found) = pose(frame, &mut poser)?;
        frames.push(Arc::new(positions));
        posed.push(found);
    }
    if looped && count > 1 {
        let off = |a: &[Vec3], b: &[Vec3]| a.iter().zip(b).map(|(a, b)| a.distance(*b)).fold(0.0_f32, f32::max);
        let near = (SAME_LAP * rig.size) as f32;
        // Where a handle's place allows several poses, the way it came by decides: one more lap settles that.
        let mut gap = off(&pose(0, &mut poser)?.0, &frames[0]);
        if gap > near {
            for frame in 0..count {
                let (positions, found) = pose(frame, &mut poser)?;
                (frames[frame], posed[frame]) = (Arc::new(positions), found);
            }
            gap = off(&pose(0, &mut poser)?.0, &frames[0]);
        }
        if gap > near {
            let message = format!("the loop does not close: its first frame comes back `{gap:.2}` cm off");
            warnings
                .push(Warning::new(message).hint("add a state, so that the handle's place says more about the pose"));
        }
    }
    warnings.extend(reach(&posed));
    Ok(Warned { value: Animation { clip: Clip { rate, looped, frames }, posed }, warnings })
}

/// Many rigs with their paths at once, on as many threads as there are. The results do not depend on their number.
///
/// # Errors
/// That of the first rig with one, with its index.
pub fn animate_all(
    rigs: &[(Rig, Vec<Vec<Vec3>>)],
    rate: f32,
    looped: bool,
    task: &Task,
) -> Result<Vec<Warned<Animation>>, (usize, AnimateError)> {
    let done = std::sync::atomic::AtomicUsize::new(0);
    let all: Vec<_> = rigs
        .par_iter()
        .map(|(rig, paths)| {
            let result = animate(rig, paths, rate, looped, task);
            let done = done.fetch_add(1, std::sync::atomic::Ordering::Relaxed) + 1;
            task.progress("animating", done as f32 / rigs.len() as f32);
            result
        })
        .collect();
    all.into_iter().enumerate().map(|(i, r)| r.map_err(|e| (i, e))).collect()
}

/// The number of frames, when the paths fit.
fn checked(rig: &Rig, paths: &[Vec<Vec3>], rate: f32) -> Result<usize, AnimateError> {
    AnimateError::check("rate", rate, 0.01, 1000.0)?;
    if paths.len() != rig.handles() {
        return Err(AnimateError::PathCount { paths: paths.len(), handles: rig.handles() });
    }
    let count = paths.first().map_or(0, Vec::len);
    if count == 0 {
        return Err(AnimateError::NoFrames);
    }
    for (i, path) in paths.iter().enumerate() {
        if path.len() != count {
            return Err(AnimateError::PathFrames { handle: i + 1, count: path.len(), first: count });
        }
        if let Some(frame) = path.iter().position(|p| !p.is_finite()) {
            return Err(AnimateError::Target { handle: i + 1, frame: frame + 1, position: path[frame] });
        }
    }
    Ok(count)
}

/// A warning about frames in which the handles are further than the states reach.
fn reach(posed: &[Posed]) -> Option<Warning> {
    let worst = |p: &Posed| p.weights.iter().copied().max_by(|a, b| a.abs().total_cmp(&b.abs())).unwrap_or(0.0);
    let far: Vec<usize> = (0..posed.len()).filter(|&f| !posed[f].weights.iter().all(|w| REACH.contains(w))).collect();
    let (first, last) = (far.first()?, far.last()?);
    let weight = far.iter().map(|&f| worst(&posed[f])).max_by(|a, b| a.abs().total_cmp(&b.abs()))?;
    let frames =
        if first == last { format!("frame {}", first + 1) } else { format!("frames {} to {}", first + 1, last + 1) };
    let message = format!("the handle goes further than the states show: {frames}, a state weighs up to `{weight:.1}`");
    Some(Warning::new(message).hint("shorten the path, or add a state posed as far as it goes"))
}
