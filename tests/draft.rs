//! What a first look promises: a true part of the hair, only where it is worth it, and never instead of the whole.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use coif::export::{Format, StrandForm};
use coif::render::SheetOptions;
use coif::scene::Hair;
use coif::script::{Ending, Memory, Options, Origin};
use coif::task::Task;
use coif::workbench::{Films, Report, RunError, RunOptions, draft};

const SCRIPT: &str = r##"
local head = coif.head()
local down = coif.domain.directional { box = head:box("all"), direction = coif.down, noise = 0.1 }
local hair = head:scalp():guides { count = 40, length = 6, step = 1 }:grow { global = coif.queue { down } }
  :fill { strands = 200, material = coif.material.hair { root_colour = "#201008", width = 0.1 } }
return coif.scene { head, hair, views = { "front" } }
"##;

const MEMBERS: usize = 50;

fn edited(from: &str, to: &str) -> String {
    assert_eq!(SCRIPT.matches(from).count(), 1, "`{from}`");
    SCRIPT.replace(from, to)
}

/// A folder of outputs, and a memo that all runs share.
struct Bench {
    out: tempfile::TempDir,
    script: Options,
    /// Width and height of a view.
    size: u32,
}

impl Bench {
    fn new() -> Self {
        Self { out: tempfile::tempdir().unwrap(), script: Options::new("style/a.lua"), size: 48 }
    }

    fn options(&self) -> RunOptions {
        RunOptions {
            script: self.script.clone(),
            out: self.out.path().to_path_buf(),
            debug: false,
            background: None,
            views: None,
            sheet: SheetOptions { width: self.size, height: self.size, supersample: 1, ..SheetOptions::default() },
            strands: StrandForm::None,
            tolerance: Some(0.05),
            motion: coif::export::MotionForm::Auto,
            guides: false,
            formats: vec![Format::Glb],
            films: Films { moving: true, turntable: false },
            count_inside: false,
            triangles: None,
        }
    }

    /// Runs a script; what was told on the way, and the whole report. `told` is called with the draft in place.
    fn looks_with(&self, text: &str, task: &Task, told: impl Fn(&Report)) -> (Option<Look>, Report) {
        let sketch = RefCell::new(None);
        let files = Arc::new(Memory::default().with("style/a.lua", text));
        let report = draft::preview_drafted(&self.options(), MEMBERS, files, task, |report| {
            told(report);
            *sketch.borrow_mut() = Some(Look::of(report, self.picture()));
        });
        (sketch.into_inner(), report)
    }

    fn looks(&self, text: &str) -> (Option<Look>, Report) {
        self.looks_with(text, &Task::new(), |_| {})
    }

    fn picture(&self) -> Vec<u8> {
        std::fs::read(self.out.path().join("a.png")).unwrap_or_default()
    }
}

/// What there is to see.
struct Look {
    hair: Vec<Hair>,
    name: String,
    picture: Vec<u8>,
    computed: Vec<String>,
}

impl Look {
    fn of(report: &Report, picture: Vec<u8>) -> Self {
        let scene = report.outcome.scene.as_ref().unwrap();
        let computed = report.outcome.timings.iter().filter(|t| t.origin == Some(Origin::Computed));
        Self {
            hair: scene.hair().map(|(_, h)| h.clone()).collect(),
            name: scene.name.clone(),
            picture,
            computed: computed.map(|t| t.what.clone()).collect(),
        }
    }
}

#[test]
fn a_draft_is_a_true_part_of_the_hair_and_as_dense() {
    let bench = Bench::new();
    let (sketch, report) = bench.looks(SCRIPT);
    let (sketch, whole) = (sketch.expect("a draft"), Look::of(&report, bench.picture()));
    let (few, all) = (&sketch.hair[0], &whole.hair[0]);
    assert_eq!((few.strands.count(), all.strands.count()), (MEMBERS, 200));
    let by_id: BTreeMap<u64, usize> = all.strands.roots.iter().enumerate().map(|(i, r)| (r.id, i)).collect();
    for i in 0..few.strands.count() {
        let same = by_id[&few.strands.roots[i].id];
        assert_eq!(few.strands.strand(i), all.strands.strand(same), "the very same strand");
    }
    assert_eq!(few.guides.points, all.guides.points);
    // Four times fewer, four times wider.
    assert_eq!((few.material.width, all.material.width), (0.4, 0.1));
    // It is called a draft, and the picture after it is not the same.
    assert!(sketch.name.ends_with("draft") && whole.name == "a");
    assert!(!sketch.picture.is_empty() && sketch.picture != whole.picture);
    // What the draft has grown is not grown again.
    assert_eq!(sketch.computed, ["Region:guides", "Guides:grow", "Strands:fill"]);
    assert_eq!(whole.computed, ["Strands:fill"]);
}

#[test]
fn the_whole_picture_is_the_same_with_a_draft_before_it_or_none() {
    let (with, without) = (Bench::new(), Bench::new());
    with.looks(SCRIPT);
    let files = Arc::new(Memory::default().with("style/a.lua", SCRIPT));
    let report = coif::workbench::preview(&without.options(), files, &Task::new());
    assert!(report.written.is_ok());
    assert_eq!(with.picture(), without.picture());
}

#[test]
fn there_is_one_only_where_it_is_worth_it() {
    let bench = Bench::new();
    let drafted = |text: &str| bench.looks(text).0.is_some();
    assert!(drafted(SCRIPT));
    // Nothing to draw: the very same, or a change that shows nowhere.
    assert!(!drafted(SCRIPT));
    assert!(!drafted(&format!("-- a remark\n{SCRIPT}")));
    // A colour: all strands have to be drawn again.
    assert!(drafted(&edited("#201008", "#c0a080")));
    assert!(drafted(&edited("noise = 0.1", "noise = 0.2")));
    // Back again: the memo has the picture.
    assert!(!drafted(SCRIPT));
    // As few strands as a draft has, or none at all.
    assert!(!drafted(&edited("strands = 200", "strands = 50")));
    assert!(!drafted("return coif.scene { coif.head() }"));
    // Two fills count each on its own.
    assert!(!drafted(&edited("strands = 200", "strands = 40").replace("head, hair", "head, hair, hair:material {}")));
}

#[test]
fn a_large_picture_has_a_draft_of_the_same_scene() {
    let script = "return coif.scene { coif.head(), views = { 'front' } }";
    let (large, plain) = (Bench { size: 1600, ..Bench::new() }, Bench { size: 1600, ..Bench::new() });
    let (sketch, report) = large.looks(script);
    let sketch = sketch.expect("a draft");
    assert!(report.written.is_ok() && sketch.name == "a · draft" && Look::of(&report, vec![]).name == "a");
    // Each step once, and the picture's last.
    let stages: Vec<&str> = report.stages.iter().map(|s| s.what).collect();
    assert_eq!(stages, ["script", "picture", "write"]);
    let files = Arc::new(Memory::default().with("style/a.lua", script));
    coif::workbench::preview(&plain.options(), files, &Task::new());
    assert_eq!(large.picture(), plain.picture(), "the whole picture is the same with a draft before it or none");
    // The draft has the same size and much the same pixels.
    let [draft, whole] =
        [sketch.picture, large.picture()].map(|bytes| coif::render::png::decode(&bytes).expect("a picture"));
    assert_eq!((draft.width, draft.height), (whole.width, whole.height));
    let off: u64 = draft.pixels.iter().zip(&whole.pixels).map(|(a, b)| u64::from(a.abs_diff(*b))).sum();
    let mean = off as f64 / draft.pixels.len() as f64;
    assert!(mean > 0.0 && mean < 1.0, "{mean}");
    // Known already.
    assert!(large.looks(script).0.is_none());
}

#[test]
fn a_draft_tells_of_no_error_and_hides_none() {
    let bench = Bench::new();
    let (sketch, report) = bench.looks("return coif.scenery {}");
    assert!(sketch.is_none() && matches!(report.written, Err(RunError::Script)));
    assert_eq!(report.outcome.diagnostics.len(), 1);
    // A script that wants all of its strands fails as a draft only.
    let (sketch, report) = bench.looks(&edited("return", "assert(hair.count == 200)\nreturn"));
    assert!(sketch.is_none() && report.written.is_ok(), "{:?}", report.outcome.diagnostics);
    // One that fails in full alone is told after the draft.
    let fails = edited("return", "assert(hair.count < 200)\nreturn");
    let (sketch, report) = Bench::new().looks(&fails);
    assert!(sketch.is_some() && matches!(report.written, Err(RunError::Script)));
    // At once where nothing has to be made to find out.
    let (sketch, report) = bench.looks(&fails);
    assert!(sketch.is_none() && matches!(report.written, Err(RunError::Script)));
}

#[test]
fn a_save_cancels_the_draft_and_what_comes_after_it() {
    // After the draft is in place.
    let (bench, task) = (Bench::new(), Task::new());
    let own = task.clone();
    let (sketch, report) = bench.looks_with(SCRIPT, &task, |_| own.cancel());
    let draft = sketch.expect("a draft").picture;
    assert!(matches!(report.written, Err(RunError::Cancelled)) && report.outcome.ending == Ending::Cancelled);
    assert_eq!(bench.picture(), draft, "the draft stays in place");

    // At any moment: the folder has either nothing, or a whole picture.
    let polls = |at: usize| {
        let (bench, count) = (Bench::new(), Arc::new(AtomicUsize::new(0)));
        let (task, counted) = (Task::new(), Arc::clone(&count));
        let own = task.clone();
        let task = task.with_polls(move || {
            if counted.fetch_add(1, Ordering::SeqCst) + 1 == at {
                own.cancel();
            }
        });
        let (sketch, report) = bench.looks_with(SCRIPT, &task, |_| {});
        (count.load(Ordering::SeqCst), sketch.is_some(), report.written.is_ok(), bench)
    };
    let (all, ..) = polls(usize::MAX);
    assert!(all > 20, "only {all} looks at the task");
    for part in 1..8 {
        let (_, is_drafted, is_whole, bench) = polls(all * part / 8);
        let names: Vec<_> = std::fs::read_dir(bench.out.path()).unwrap().map(|e| e.unwrap().file_name()).collect();
        assert_eq!(names.len(), usize::from(is_drafted || is_whole), "{part}: {names:?}");
        assert!(names.iter().all(|n| Path::new(n) == Path::new("a.png")));
    }
}
