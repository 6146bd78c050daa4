//! From a script to files.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use super::budget::Budget;
use super::film::{Films, films};
use super::keep::{Shows, kept, scene_key};
use super::output::{Output, Unwritten, WriteError, Written, write_until};
use super::{PartFigures, figures};
use crate::export::{
    CyHairOptions, ExportError, Format, GlbOptions, MotionForm, PartMotion, StrandForm, UsdaOptions, cyhair, glb,
    guides_glb, motions, usda,
};
use crate::math::Digest;
use crate::render::{PngError, RenderError, SheetOptions, Speed, png, sheet};
use crate::scene::{Background, Scene, View};
use crate::script::{self, Ending, Files, Origin, Outcome};
use crate::task::Task;
use crate::tuft::TuftError;

/// What is wanted of a run.
#[derive(Clone, Debug)]
pub struct RunOptions {
    /// The script and its parameters.
    pub script: script::Options,
    /// Folder of the outputs.
    pub out: PathBuf,
    /// A second picture with domains, guides, partings and roots.
    pub debug: bool,
    /// Instead of the script's background.
    pub background: Option<Background>,
    /// Instead of the script's views.
    pub views: Option<Vec<View>>,
    /// Size and fineness of the picture.
    pub sheet: SheetOptions,
    /// What strands become in the GLB.
    pub strands: StrandForm,
    /// Farthest that a written strand may lie from its true course, and a vertex of what moves from its place at any frame,
    /// cm; the usual when left out.
    pub tolerance: Option<f32>,
    /// How strands that move are written in the GLB.
    pub motion: MotionForm,
    /// A second GLB with the guides.
    pub guides: bool,
    /// The files for other programs.
    pub formats: Vec<Format>,
    /// Strips, animations, turntables.
    pub films: Films,
    /// Most triangles of all tufts together.
    pub triangles: Option<usize>,
    /// Count the strands that are inside the head.
    pub count_inside: bool,
}

/// A step of a run and how long it took.
#[derive(Clone, Copy, Debug)]
pub struct Stage {
    /// `script`, `picture`, `glb`.
    pub what: &'static str,
    /// Wall-clock time.
    pub time: Duration,
    /// Whether the memo had its result; none for a step whose result is not kept.
    pub origin: Option<Origin>,
}

/// Why there are no files.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// The script is at fault; its diagnostics say how.
    #[error("the script failed")]
    Script,
    /// Stopped from outside.
    #[error("cancelled")]
    Cancelled,
    /// No picture.
    #[error(transparent)]
    Render(RenderError),
    /// No picture file.
    #[error(transparent)]
    Png(#[from] PngError),
    /// Too few triangles asked for.
    #[error("{0}")]
    Budget(TuftError),
    /// No GLB.
    #[error(transparent)]
    Export(ExportError),
    /// The files could not be put into place.
    #[error(transparent)]
    Write(#[from] WriteError),
}

impl From<Unwritten> for RunError {
    fn from(error: Unwritten) -> Self {
        match error {
            Unwritten::Cancelled(_) => Self::Cancelled,
            Unwritten::Write(error) => Self::Write(error),
        }
    }
}

impl From<RenderError> for RunError {
    fn from(error: RenderError) -> Self {
        match error {
            RenderError::Cancelled(_) => Self::Cancelled,
            other => Self::Render(other),
        }
    }
}

impl From<ExportError> for RunError {
    fn from(error: ExportError) -> Self {
        match error {
            ExportError::Cancelled(_) => Self::Cancelled,
            other => Self::Export(other),
        }
    }
}

/// What happened in a run.
#[derive(Debug)]
pub struct Report {
    /// What the script gave; its scene is the one that was drawn.
    pub outcome: Outcome,
    /// Figures of every part.
    pub figures: Vec<PartFigures>,
    /// Steps and their times, in order.
    pub stages: Vec<Stage>,
    /// What was done to keep within the triangles.
    pub budget: Option<Budget>,
    /// How the parts of the GLB move.
    pub motions: Vec<PartMotion>,
    /// The files, in the order they were put into place; or why there are none.
    pub written: Result<Vec<Written>, RunError>,
}

/// Runs a script and writes its picture and files. Nothing is written when anything fails.
pub fn run(options: &RunOptions, files: Arc<dyn Files>, task: &Task) -> Report {
    let mut report = prepare(options, files, task);
    finish(options, &mut report, task, |scene, stages| {
        let mut outputs = pictures(options, scene, Speed::Balanced, task, stages)?;
        outputs.extend(models(options, scene, task, stages)?);
        outputs.extend(films(options, scene, task, stages)?);
        Ok(outputs)
    });
    report
}

/// Runs a script and writes its picture only, coded quickly: the first half of [`run`], for somebody who waits.
pub fn preview(options: &RunOptions, files: Arc<dyn Files>, task: &Task) -> Report {
    let mut report = prepare(options, files, task);
    draw(options, &mut report, task);
    report
}

/// Writes what [`preview`] has left out; the report's stages and files are those of this half.
pub fn exports(options: &RunOptions, report: &mut Report, task: &Task) {
    report.stages.clear();
    finish(options, report, task, |scene, stages| {
        let mut outputs = models(options, scene, task, stages)?;
        outputs.extend(films(options, scene, task, stages)?);
        Ok(outputs)
    });
}

/// A scene with its figures, and nothing written yet.
pub(super) fn prepare(options: &RunOptions, files: Arc<dyn Files>, task: &Task) -> Report {
    let mut stages = vec![];
    let outcome = timed(&mut stages, "script", || script::run(&options.script, files, task));
    let mut report = Report { outcome, figures: vec![], stages, budget: None, motions: vec![], written: Ok(vec![]) };
    let Some(scene) = report.outcome.scene.as_mut() else { return report };
    if let Some(background) = options.background {
        scene.look.background = background;
    }
    if let Some(views) = &options.views {
        scene.views.clone_from(views);
    }
    if let Some(triangles) = options.triangles {
        match timed(&mut report.stages, "triangles", || super::budget::keep_within(scene, triangles)) {
            Ok(budget) => report.budget = Some(budget),
            Err(error) => {
                report.written = Err(RunError::Budget(error));
                return report;
            }
        }
    }
    report.figures = figures(scene);
    if options.count_inside {
        timed(&mut report.stages, "count", || super::figures::count_inside(&scene.still(), &mut report.figures));
    }
    report
}

/// The second half of [`preview`], after [`prepare`].
pub(super) fn draw(options: &RunOptions, report: &mut Report, task: &Task) {
    finish(options, report, task, |scene, stages| pictures(options, scene, Speed::Fast, task, stages));
}

/// True when the memo has all that [`draw`] would make.
pub(super) fn is_drawn(options: &RunOptions, scene: &Scene) -> bool {
    let is_kept =
        |debug| options.script.memo.has(picture_key(options, &shown(scene, debug), debug, Speed::Fast).finish());
    is_kept(false) && (!options.debug || is_kept(true))
}

/// Makes outputs from the report's scene and puts them into place.
fn finish(
    options: &RunOptions,
    report: &mut Report,
    task: &Task,
    make: impl FnOnce(&Scene, &mut Vec<Stage>) -> Result<Vec<Output>, RunError>,
) {
    if report.written.is_err() {
        return;
    }
    let stages = &mut report.stages;
    report.written = match (report.outcome.ending, &report.outcome.scene) {
        (Ending::Cancelled, _) => Err(RunError::Cancelled),
        (Ending::Done, Some(scene)) => make(scene, stages).and_then(|outputs| {
            // Cancelled at the very end: what was made is not wanted any more.
            task.check().map_err(|_| RunError::Cancelled)?;
            let glb = format!("{}.{}", options.script.name(), Format::Glb.ending());
            let moves = scene.timeline().is_some();
            if let Some(file) = outputs.iter().find(|o| moves && o.name == glb) {
                report.motions = motions(&file.bytes);
            }
            Ok(timed(stages, "write", || write_until(&options.out, &outputs, task))?)
        }),
        (Ending::Done | Ending::Failed, _) => Err(RunError::Script),
    };
}

/// The picture files of a run, in memory.
fn pictures(
    options: &RunOptions,
    scene: &Scene,
    speed: Speed,
    task: &Task,
    stages: &mut Vec<Stage>,
) -> Result<Vec<Output>, RunError> {
    let name = &options.script.name();
    let mut outputs =
        vec![Output { name: format!("{name}.png"), bytes: picture(options, scene, false, speed, task, stages)? }];
    if options.debug {
        let bytes = picture(options, scene, true, speed, task, stages)?;
        outputs.push(Output { name: format!("{name}.debug.png"), bytes });
    }
    Ok(outputs)
}

/// The files of a run for other programs, in memory.
fn models(options: &RunOptions, scene: &Scene, task: &Task, stages: &mut Vec<Stage>) -> Result<Vec<Output>, RunError> {
    let name = &options.script.name();
    let usual = GlbOptions::default();
    let glb_options = GlbOptions {
        strands: options.strands,
        tolerance: options.tolerance.unwrap_or(usual.tolerance),
        motion_tolerance: options.tolerance,
        motion: options.motion,
        ..usual
    };
    let memo = &options.script.memo;
    let key = |what| {
        let mut key = scene_key(what, scene, Shows::Places, memo);
        key.data(&glb_options);
        key
    };
    let mut outputs = vec![];
    for format in &options.formats {
        let (ending, what) = (format.ending(), format.text());
        let make = || match format {
            Format::Glb => glb(scene, &glb_options, task),
            Format::Usda => usda(scene, &UsdaOptions { guides: options.guides, ..UsdaOptions::default() }, task),
            Format::Hair => cyhair(&scene.still(), &CyHairOptions::default(), task),
        };
        let bytes = found(stages, what, || {
            let mut key = key(what);
            key.data(&options.guides).data(&scene.shown);
            kept(memo, &key, make)
        })?;
        outputs.push(Output { name: format!("{name}.{ending}"), bytes });
    }
    if options.guides {
        let make = || guides_glb(&scene.still(), &glb_options, task);
        let bytes = found(stages, "guides", || kept(memo, &key("guides glb 2"), make))?;
        outputs.push(Output { name: format!("{name}.guides.glb"), bytes });
    }
    Ok(outputs)
}

fn picture(
    options: &RunOptions,
    scene: &Scene,
    debug: bool,
    speed: Speed,
    task: &Task,
    stages: &mut Vec<Stage>,
) -> Result<Arc<Vec<u8>>, RunError> {
    let drawn = shown(scene, debug);
    found(stages, if debug { "debug picture" } else { "picture" }, || {
        let key = picture_key(options, &drawn, debug, speed);
        kept(&options.script.memo, &key, || Ok(png::encode(&sheet(&drawn, &options.sheet, task)?, speed)?))
    })
}

fn shown(scene: &Scene, debug: bool) -> Scene {
    let mut shown = scene.still();
    shown.look.debug = debug;
    shown
}

fn picture_key(options: &RunOptions, drawn: &Scene, debug: bool, speed: Speed) -> Digest {
    let shows = if debug { Shows::Domains } else { Shows::Hair };
    let mut key = scene_key("picture 1", drawn, shows, &options.script.memo);
    key.data(&options.sheet).data(&speed);
    key
}

/// Times a step that may be found in the memo.
pub(super) fn found<T, E>(
    stages: &mut Vec<Stage>,
    what: &'static str,
    work: impl FnOnce() -> Result<(T, Origin), E>,
) -> Result<T, E> {
    let result = timed(stages, what, work)?;
    if let Some(stage) = stages.last_mut() {
        stage.origin = Some(result.1);
    }
    Ok(result.0)
}

fn timed<R>(stages: &mut Vec<Stage>, what: &'static str, work: impl FnOnce() -> R) -> R {
    let started = Instant::now();
    let result = work();
    stages.push(Stage { what, time: started.elapsed(), origin: None });
    result
}
