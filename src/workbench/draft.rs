//! The first look: a draft of the picture, where the whole one takes its time.
//!
//! A draft shows a true part of the hair: the first members of every fill's order, with the same nodes as in full,
//! drawn as much wider as there are fewer of them, at one sample per pixel. Whether there is one is decided by counts,
//! never by a clock: some fill must have more members than a draft gives it, and the memo must not have the picture
//! already.

use std::sync::Arc;

use super::run::{draw, is_drawn, prepare, preview};
use super::{Report, RunOptions};
use crate::render::SheetOptions;
use crate::script::{self, Ending, Files};
use crate::task::Task;

/// Most members that a fill has in a draft: enough to judge shape and flow by, few enough to be made and drawn at once.
pub const MEMBERS: usize = 6000;

/// What a draft's title has after the style's name.
pub const MARK: &str = " · draft";

/// Runs a script and writes its picture, as [`preview`] does, and before it a draft with at most `members` members in
/// each fill, if that is worth it; `told` hears of the draft when it is in place.
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
        sheet: SheetOptions { supersample: 1, ..options.sheet },
        ..options.clone()
    };
    // The time that the draft runs out of is its own.
    let mut sketch = prepare(&quick, Arc::clone(&files), &task.child());
    let thinned = sketch.outcome.thinned;
    if sketch.outcome.ending != Ending::Done || thinned.members == thinned.of {
        return preview(options, files, task);
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
