//! `coif sheet`: variations of a style on one contact sheet.

use std::path::PathBuf;
use std::sync::Arc;

use glam::Mat3;

use super::output::{Output, Written, write_all};
use super::run::RunError;
use super::variations::{MOST_COMBINATIONS, Variation, combinations};
use crate::render::{Cell, Picture, SheetOptions, Speed, camera, contact, png, views};
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
/// Each cell has the very pixels that a run with these parameters and this view alone draws at this size.
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
        Ok(write_all(&options.out, &[Output { name: format!("{name}.sheet.png"), bytes: bytes.into() }])?)
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
    let mut cells = vec![];
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
            (Ending::Done, Some(scene)) if !is_refused => scene,
            (Ending::Cancelled, _) => return Err(RunError::Cancelled),
            _ => return Err(RunError::Script),
        };
        if options.background.is_none() && i == 0 {
            background = scene.look.background;
        }
        let (pictures, names) = pictures(options, scene, background, task)?;
        cells.extend(pictures.into_iter().zip(names).map(|(picture, view)| Cell {
            picture,
            label: if label.is_empty() {
                view
            } else if options.turntable.is_some() {
                format!("{label}  {view}")
            } else {
                label.clone()
            },
        }));
    }
    Ok((cells, background))
}

/// The options of one combination.
fn varied(options: &Options, combination: &[(String, String)]) -> Options {
    let mut options = options.clone();
    for (name, value) in combination {
        match value.parse() {
            Ok(seed) if name == "seed" => options.seed = seed,
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
                wrong.push(Diagnostic::error(message).hint_opt(problem.hint));
            }
        }
    }
    wrong
}

/// The pictures of one run, with the names of their views.
fn pictures(
    options: &ContactOptions,
    scene: Scene,
    background: Background,
    task: &Task,
) -> Result<(Vec<Picture>, Vec<String>), RunError> {
    let mut scene = scene.still();
    scene.look.background = background;
    let own = scene.views.first().copied().unwrap_or(View::Front);
    let (sights, names): (Vec<Mat3>, Vec<String>) = match options.turntable {
        Some(n) => {
            let degrees = |k: u32| 360.0 * k as f32 / n as f32;
            let name = |k: u32| format!("{}°", (degrees(k) * 10.0).round() / 10.0);
            ((0..n).map(|k| camera::turned(degrees(k).to_radians())).collect(), (0..n).map(name).collect())
        }
        None => {
            let view = options.view.unwrap_or(own);
            (vec![camera::axes(view)], vec![view.text().to_owned()])
        }
    };
    Ok((views(&scene, &sights, None, &options.sheet, task)?, names))
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
