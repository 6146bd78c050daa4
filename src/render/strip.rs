//! Strips: some frames of a scene that moves side by side, numbered.

use super::animation::{Shot, film};
use super::contact::{Cell, contact};
use super::sheet::{Picture, RenderError, SheetOptions};
use super::{camera, sheet};
use crate::scene::{Scene, View};
use crate::task::Task;

/// Frames in a row.
const ACROSS: usize = 8;

/// The frames that the scene shows in its strip, from its first view, all framed alike, under their numbers from 1;
/// `None` for a scene that does not move.
///
/// # Errors
/// [`RenderError`]: cancelled, or a size out of range.
pub fn strip(scene: &Scene, options: &SheetOptions, task: &Task) -> Result<Option<Picture>, RenderError> {
    let Some(timeline) = scene.timeline() else { return Ok(None) };
    let frames = if scene.shown.strip.is_empty() { timeline.strip() } else { scene.shown.strip.clone() };
    let view = scene.views.first().copied().unwrap_or(View::Front);
    let sight = camera::axes(view);
    let shots: Vec<Shot> = frames.iter().map(|&frame| Shot { frame, sight }).collect();
    let pictures = film(scene, &shots, options, task)?;
    let label = |frame: &usize| (frame + 1).to_string();
    let cells: Vec<Cell> =
        pictures.into_iter().zip(&frames).map(|(picture, frame)| Cell { picture, label: label(frame) }).collect();
    let seconds = (timeline.frames - usize::from(!timeline.looped)) as f32 / timeline.rate;
    let about = format!(
        "{} frames at {} in a second · {seconds:.1} s{} · {}",
        sheet::grouped(timeline.frames),
        timeline.rate,
        if timeline.looped { " · loop" } else { "" },
        view.text()
    );
    contact(&scene.name, &about, &cells, ACROSS, scene.look.background).map(Some)
}
