//! Strips, animations and turntables of a scene, in memory.

use std::sync::Arc;

use super::keep::{Shows, kept, scene_key};
use super::output::Output;
use super::run::{RunError, RunOptions, Stage, found};
use crate::render::animation::{self, Shot};
use crate::render::{SheetOptions, Speed, camera, png, strip};
use crate::scene::{Scene, View};
use crate::task::Task;

/// Widest picture of a strip, pixels.
const STRIP: u32 = 240;
/// Widest picture of an animation, pixels.
const FILM: u32 = 320;
/// Pictures in a second of a turntable around what does not move.
const RATE: f32 = 24.0;

/// What is drawn of a scene besides its still picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Films {
    /// A strip and an animation, of a scene that moves.
    pub moving: bool,
    /// A view that goes around the scene.
    pub turntable: bool,
}

/// `NAME.strip.png` and `NAME.anim.png` of a scene that moves, `NAME.turntable.png` when asked for.
///
/// # Errors
/// What the renderer says; cancelled.
pub fn films(
    options: &RunOptions,
    scene: &Scene,
    task: &Task,
    stages: &mut Vec<Stage>,
) -> Result<Vec<Output>, RunError> {
    let (name, timeline) = (options.script.name(), scene.timeline());
    let mut outputs = vec![];
    if let (Some(timeline), true) = (&timeline, options.films.moving) {
        let sheet = sized(options, STRIP);
        let make = || match strip(scene, &sheet, task)? {
            Some(picture) => Ok(png::encode(&picture, Speed::Balanced)?),
            None => Ok(vec![]),
        };
        let bytes = keep(options, scene, ("strip", &sheet), stages, make)?;
        outputs.push(Output { name: format!("{name}.strip.png"), bytes });
        let sheet = sized(options, FILM);
        let view = scene.views.first().copied().unwrap_or(View::Front);
        let shots = animation::steady(timeline, camera::axes(view));
        let make = || film(scene, &shots, (&sheet, timeline.rate), task);
        let bytes = keep(options, scene, ("animation", &sheet), stages, make)?;
        outputs.push(Output { name: format!("{name}.anim.png"), bytes });
    }
    if options.films.turntable {
        let sheet = sized(options, FILM);
        let shots = animation::turntable(timeline.as_ref());
        let make = || film(scene, &shots, (&sheet, timeline.map_or(RATE, |t| t.rate)), task);
        let bytes = keep(options, scene, ("turntable", &sheet), stages, make)?;
        outputs.push(Output { name: format!("{name}.turntable.png"), bytes });
    }
    Ok(outputs)
}

/// The options of a picture that is no wider than `widest`.
fn sized(options: &RunOptions, widest: u32) -> SheetOptions {
    let sheet = &options.sheet;
    let width = sheet.width.min(widest).max(16);
    let height = (u64::from(sheet.height) * u64::from(width) / u64::from(sheet.width.max(1))) as u32;
    SheetOptions { width, height: height.max(16), lettering: false, columns: None, ..*sheet }
}

fn film(scene: &Scene, shots: &[Shot], (sheet, rate): (&SheetOptions, f32), task: &Task) -> Result<Vec<u8>, RunError> {
    let pictures = animation::film(scene, shots, sheet, task)?;
    Ok(animation::encode(&pictures, rate, Speed::Balanced)?)
}

fn keep(
    options: &RunOptions,
    scene: &Scene,
    (what, sheet): (&'static str, &SheetOptions),
    stages: &mut Vec<Stage>,
    make: impl FnOnce() -> Result<Vec<u8>, RunError>,
) -> Result<Arc<Vec<u8>>, RunError> {
    let memo = &options.script.memo;
    found(stages, what, || {
        let mut key = scene_key(what, scene, Shows::Hair, memo);
        key.data(&scene.shown).data(sheet);
        kept(memo, &key, make)
    })
}
