//! The first look: a draft of the picture, where the whole one takes its time.
//!
//! A draft shows a true part of the hair: the first members of every fill's order, with the same nodes as in full,
//! drawn as much wider as there are fewer of them, with half of the pixels along each side. Whether there is one is
//! decided by counts, never by a clock: some fill must have more members than a draft gives it, or the picture must be a
//! large one, and the memo must not have it already.

use std::sync::Arc;

use super::run::{draw, is_drawn, prepare, preview};
use super::{Report, RunOptions};
use crate::render::SheetOptions;
use crate::scene::Scene;
use crate::script::{self, Ending, Files};
use crate::task::Task;

/// Most members that a fill has in a draft: enough to judge shape and flow by, few enough to be made and drawn at once.
pub const MEMBERS: usize = 4000;

/// Pixels of the picture along each side of one that a draft draws.
pub const COARSE: u32 = 2;

/// A picture with more pixels in its views has a draft, whatever it shows.
pub const LARGE: u64 = 2_500_000;

/// What a draft's title has after the style's name.
pub const MARK: &str = " · draft";

/// Runs a script and writes its picture, as [`preview`] does, and before it a draft with at most `members` members in
/// each fill, where it is worth that; `told` hears of the draft when it is in place.
///
/// A draft tells of no error: whatever is wrong, the whole run says it.
pub fn preview_drafted(
    options: &RunOptions,
    members: usize,
    files: Arc<dyn Files>,
    task: &Task,
    told: impl FnOnce(&Report),
) -> Report {
    let quick = RunOptions {
        script: script::Options { draft: Some(members), ..options.script.clone() },
        debug: false,
        count_inside: false,
        sheet: SheetOptions { supersample: 1, coarse: COARSE, ..options.sheet },
        ..options.clone()
    };
    // The time that the draft runs out of is its own.
    let mut sketch = prepare(&quick, Arc::clone(&files), &task.child());
    let thinned = sketch.outcome.thinned;
    if sketch.outcome.ending != Ending::Done {
        return preview(options, files, task);
    }
    if thinned.members == thinned.of {
        // What has run is the whole script.
        return if options.count_inside {
            preview(options, files, task)
        } else {
            twice(options, &quick, sketch, task, told)
        };
    }
    let mut whole = None;
    if thinned.pending == 0 {
        // Nothing has to be computed, and perhaps nothing drawn.
        let mut report = prepare(options, Arc::clone(&files), task);
        if report.outcome.scene.as_ref().is_none_or(|scene| is_drawn(options, scene)) {
            draw(options, &mut report, task);
            return report;
        }
        whole = Some(report);
    }
    if let Some(scene) = &mut sketch.outcome.scene {
        scene.name += MARK;
    }
    draw(&quick, &mut sketch, task);
    if sketch.written.is_ok() {
        told(&sketch);
    }
    drop(sketch);
    let mut report = whole.unwrap_or_else(|| prepare(options, files, task));
    draw(options, &mut report, task);
    report
}

/// Draws a scene of which nothing is left out: if its picture is large and not known, as a draft and then in full.
fn twice(
    options: &RunOptions,
    quick: &RunOptions,
    mut report: Report,
    task: &Task,
    told: impl FnOnce(&Report),
) -> Report {
    let is_large = |scene: &Scene| pixels(options, scene) > LARGE && !is_drawn(options, scene);
    if report.written.is_ok() && report.outcome.scene.as_ref().is_some_and(is_large) {
        let (name, stages) = (options.script.name(), report.stages.clone());
        let named = |report: &mut Report, name: String| {
            if let Some(scene) = &mut report.outcome.scene {
                scene.name = name;
            }
        };
        named(&mut report, format!("{name}{MARK}"));
        draw(quick, &mut report, task);
        if report.written.is_ok() {
            told(&report);
        }
        named(&mut report, name);
        (report.stages, report.written) = (stages, Ok(vec![]));
    }
    draw(options, &mut report, task);
    report
}

/// How many pixels all views of a scene have.
fn pixels(options: &RunOptions, scene: &Scene) -> u64 {
    u64::from(options.sheet.width) * u64::from(options.sheet.height) * scene.views.len().max(1) as u64
}
