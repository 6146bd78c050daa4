//! `coif sheet`: variations of a style on one contact sheet.

use std::path::PathBuf;
use std::sync::Arc;

use glam::Mat3;

use super::output::{Output, Written, write_until};
use super::run::RunError;
use super::variations::{MOST_COMBINATIONS, Variation, combinations};
use crate::render::camera::{self, Framing, frame};
use crate::render::{Cell, SheetOptions, Speed, contact, png, views};
use crate::scene::{Background, Scene, View};
use crate::script::{self, Diagnostic, Ending, Files, Options, Outcome};
use crate::task::Task;

/// What is wanted of a contact sheet.
#[derive(Clone, Debug)]
pub struct ContactOptions {
    /// The style, and the parameters that do not vary.
    pub script: Options,
    /// What varies: the first across, the others down.
    pub vary: Vec<Variation>,
    /// The view of every cell; the scene's first one when left out.
    pub view: Option<View>,
    /// Instead of one view this many around the head, side by side, at one scale.
    pub turntable: Option<u32>,
    /// Size and fineness of a cell.
    pub sheet: SheetOptions,
    /// Each picture framed on its own, as a run's is; otherwise one framing holds them all, so that they compare.
    pub fit: bool,
    /// Instead of the style's background.
    pub background: Option<Background>,
    /// Folder of the output.
    pub out: PathBuf,
}

/// What came out of it.
#[derive(Debug)]
pub struct ContactReport {
    /// Every run so far, with what it varied; only the last can have failed.
    pub runs: Vec<(String, Outcome)>,
    /// Pictures on the sheet.
    pub cells: usize,
    /// The file, `NAME.sheet.png`; or why there is none.
    pub written: Result<Vec<Written>, RunError>,
}

/// Makes a contact sheet. Nothing is written when anything fails; `tell` hears of each run before it begins.
///
/// Each cell shows the very scene that a run with these parameters makes; with `fit` it has the very pixels that the
/// run with this view alone draws at this size.
pub fn contact_sheet(
    options: &ContactOptions,
    files: &Arc<dyn Files>,
    task: &Task,
    mut tell: impl FnMut(usize, usize, &str),
) -> ContactReport {
    let mut report = ContactReport { runs: vec![], cells: 0, written: Err(RunError::Script) };
    report.written = cells(options, files, task, &mut tell, &mut report.runs).and_then(|(cells, background)| {
        report.cells = cells.len();
        let name = options.script.name();
        let across = match (options.turntable, options.vary.first()) {
            (Some(n), _) => n as usize,
            (None, Some(first)) => first.values.len(),
            (None, None) => 1,
        };
        let mut about: Vec<String> =
            options.vary.iter().map(|v| format!("{}: {}", v.name, v.values.join(", "))).collect();
        about.extend(options.script.set.iter().map(|(name, value)| format!("{name}={value}")));
        let sheet = contact(&name, &about.join("  ·  "), &cells, across, background)?;
        let bytes = png::encode(&sheet, Speed::Balanced)?;
        if task.is_cancelled() {
            return Err(RunError::Cancelled);
        }
        let output = Output { name: format!("{name}.sheet.png"), bytes: bytes.into() };
        Ok(write_until(&options.out, &[output], task)?)
    });
    report
}

fn cells(
    options: &ContactOptions,
    files: &Arc<dyn Files>,
    task: &Task,
    tell: &mut impl FnMut(usize, usize, &str),
    runs: &mut Vec<(String, Outcome)>,
) -> Result<(Vec<Cell>, Background), RunError> {
    let all = combinations(&options.vary);
    let (mut cells, mut made, mut waiting) = (vec![], vec![], 0);
    let mut background = options.background.unwrap_or(Background::White);
    for (i, combination) in all.iter().enumerate() {
        let label = combination.iter().map(|(name, value)| format!("{name}={value}")).collect::<Vec<_>>().join("  ");
        tell(i, all.len(), &label);
        let mut outcome = script::run(&varied(&options.script, combination), Arc::clone(files), &task.child());
        if i == 0 && outcome.ending == Ending::Done {
            // Told now, and not after the hours that the good values before a bad one may take.
            outcome.diagnostics.extend(refused(options, &outcome));
        }
        let is_refused = outcome.diagnostics.iter().any(|d| d.severity == script::Severity::Error);
        let (ending, scene) = (outcome.ending, outcome.scene.take());
        runs.push((label.clone(), outcome));
        let scene = match (ending, scene) {
            (Ending::Done, Some(scene)) if !is_refused => scene.still(),
            (Ending::Cancelled, _) => return Err(RunError::Cancelled),
            _ => return Err(RunError::Script),
        };
        if options.background.is_none() && i == 0 {
            background = scene.look.background;
        }
        let (sights, names) = sights(options, &scene);
        let framing = frame(&scene, &sights);
        // Scenes wait for the last framing; what is too much to keep is made again then.
        let bytes: usize = scene.hair().map(|(_, hair)| hair.strands.bytes()).sum();
        let kept = if options.fit || waiting + bytes <= WAITING { Some(scene) } else { None };
        waiting += bytes;
        let mut one = Made { combination, label, scene: kept, sights, names, framing };
        if options.fit {
            cells.extend(one.cells(options, None, background, files, task)?);
        } else {
            made.push(one);
        }
    }
    let framings: Vec<(Vec<Mat3>, Framing)> = made.iter().map(|m| (m.sights.clone(), m.framing.clone())).collect();
    for one in &mut made {
        // A parameter may decide where a style is looked at from.
        let like: Vec<Framing> = framings.iter().filter(|f| f.0 == one.sights).map(|f| f.1.clone()).collect();
        let all = Framing::around(&like, &one.sights);
        cells.extend(one.cells(options, all.as_ref(), background, files, task)?);
    }
    Ok((cells, background))
}

/// Bytes of strands that wait for their picture: a dozen full heads of hair.
const WAITING: usize = 600 << 20;

/// A run of one combination, to be drawn.
struct Made<'a> {
    combination: &'a [(String, String)],
    label: String,
    scene: Option<Scene>,
    sights: Vec<Mat3>,
    names: Vec<String>,
    framing: Framing,
}

impl Made<'_> {
    fn cells(
        &mut self,
        options: &ContactOptions,
        framing: Option<&Framing>,
        background: Background,
        files: &Arc<dyn Files>,
        task: &Task,
    ) -> Result<Vec<Cell>, RunError> {
        let scene = self.scene.take().or_else(|| {
            let scene = script::run(&varied(&options.script, self.combination), Arc::clone(files), &task.child()).scene;
            scene.map(|scene| scene.still())
        });
        // A script that ran once fails the second time only if it is cancelled or its files change.
        let mut scene = scene.ok_or(if task.is_cancelled() { RunError::Cancelled } else { RunError::Script })?;
        scene.look.background = background;
        let pictures = views(&scene, &self.sights, framing, &options.sheet, task)?;
        let label = |view: &String| {
            if self.label.is_empty() {
                view.clone()
            } else if options.turntable.is_some() {
                format!("{}  {view}", self.label)
            } else {
                self.label.clone()
            }
        };
        Ok(pictures.into_iter().zip(&self.names).map(|(picture, view)| Cell { picture, label: label(view) }).collect())
    }
}

/// The options of one combination.
fn varied(options: &Options, combination: &[(String, String)]) -> Options {
    let mut options = options.clone();
    for (name, value) in combination {
        match value.parse() {
            Ok(seed) if name == "seed" => (options.seed, options.names_seed) = (seed, true),
            _ => drop(options.set.insert(name.clone(), value.clone())),
        }
    }
    options
}

/// Values that the declared parameters do not take.
fn refused(options: &ContactOptions, outcome: &Outcome) -> Vec<Diagnostic> {
    let mut wrong = vec![];
    for v in &options.vary {
        let Some(parameter) = outcome.parameters.iter().find(|p| p.name == v.name) else { continue };
        for value in &v.values {
            if let Err(problem) = parameter.given(value) {
                let message = format!("`--vary {}`: {}", v.name, problem.message);
                let example = format!("as in `--vary {}={}`", v.name, parameter.default);
                wrong.push(Diagnostic::error(message).hint(problem.hint.unwrap_or(example)));
            }
        }
    }
    wrong
}

/// Where the pictures of one run look from, and what that is called.
fn sights(options: &ContactOptions, scene: &Scene) -> (Vec<Mat3>, Vec<String>) {
    match options.turntable {
        Some(n) => {
            let degrees = |k: u32| 360.0 * k as f32 / n as f32;
            let name = |k: u32| format!("{}°", (degrees(k) * 10.0).round() / 10.0);
            ((0..n).map(|k| camera::turned(degrees(k).to_radians())).collect(), (0..n).map(name).collect())
        }
        None => {
            let view = options.view.or(scene.views.first().copied()).unwrap_or(View::Front);
            (vec![camera::axes(view)], vec![view.text().to_owned()])
        }
    }
}

/// How many cells the sheet will have, or that they are too many.
///
/// # Errors
/// A message.
pub fn count_cells(vary: &[Variation], turntable: Option<u32>) -> Result<usize, String> {
    let each = turntable.unwrap_or(1).max(1) as usize;
    let all = vary.iter().try_fold(each, |n, v| n.checked_mul(v.values.len()));
    match all {
        Some(n) if n <= MOST_COMBINATIONS => Ok(n),
        _ => Err(format!("that is more than {MOST_COMBINATIONS} pictures")),
    }
}
