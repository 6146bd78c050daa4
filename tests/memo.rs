//! What the memo promises: what has not changed is not computed again, and nobody can tell but by the clock.

use std::path::Path;
use std::sync::Arc;

use coif::export::{Format, StrandForm};
use coif::render::SheetOptions;
use coif::scene::Scene;
use coif::script::{Ending, Memo, Memory, Options, Origin, Outcome, run};
use coif::task::Task;
use coif::workbench::{self, Films, Report, RunOptions};

const SCRIPT: &str = r##"-- A style that tries every step, and warns.
local head = coif.head()
local down = coif.domain.directional { box = head:box("all"), direction = coif.down, noise = 0.1 }
local far = coif.domain.directional { box = coif.box { min = { 90, 90, 90 }, max = { 91, 91, 91 } }, direction = coif.up }
local grown = head:scalp():guides { count = 40, length = 6, step = 1 }:grow {
  global = coif.queue { down },
  locals = { { where = function(root) return root.x > 0 end, queue = coif.queue { far } } },
}
local waved = grown:natural { coif.domain.curl { box = head:box("all"), period = 4, radius = 0.3 } }
local hair = waved:fill { strands = 200, material = coif.material.hair { root_colour = "#201008" } }
return coif.scene { head, hair, views = { "front" } }
"##;

const STEPS: [&str; 4] = ["Region:guides", "Guides:grow", "Strands:natural", "Strands:fill"];

fn options(memo: &Arc<Memo>) -> Options {
    Options { memo: Arc::clone(memo), ..Options::new("style/a.lua") }
}

fn script(text: &str, memo: &Arc<Memo>) -> Outcome {
    let files = Memory::default().with("style/a.lua", text);
    let outcome = run(&options(memo), Arc::new(files), &Task::new());
    assert_eq!(outcome.ending, Ending::Done, "{:?}", outcome.diagnostics);
    outcome
}

/// The steps that were computed.
fn computed(outcome: &Outcome) -> Vec<&str> {
    let steps: Vec<_> = outcome.timings.iter().filter(|t| t.origin.is_some()).collect();
    assert_eq!(steps.iter().map(|t| &*t.what).collect::<Vec<_>>(), STEPS, "every step says where it is from");
    steps.into_iter().filter(|t| t.origin == Some(Origin::Computed)).map(|t| &*t.what).collect()
}

fn edited(from: &str, to: &str) -> String {
    assert_eq!(SCRIPT.matches(from).count(), 1, "`{from}`");
    SCRIPT.replace(from, to)
}

fn hair(scene: &Scene) -> &coif::scene::Hair {
    scene.hair().next().unwrap().1
}

#[test]
fn only_what_changed_is_computed() {
    let memo = Arc::default();
    let first = script(SCRIPT, &memo);
    assert_eq!(computed(&first), STEPS);
    assert_eq!(computed(&script(SCRIPT, &memo)), [""; 0]);
    // A colour, an unused value, an equal predicate, an equal number.
    for (from, to) in [
        ("#201008", "#c0a080"),
        ("local waved", "local unused = head:point { azimuth = 30 }\nlocal waved"),
        ("return root.x > 0", "return not (root.x <= 0)"),
        ("period = 4", "period = 2 + 2"),
        ("views = { \"front\" }", "views = { \"back\", \"left\" }, background = \"dark\""),
    ] {
        assert_eq!(computed(&script(&edited(from, to), &memo)), [""; 0], "{to}");
    }
    // From the step that changed on, everything that depends on it.
    for (from, to, steps) in [
        ("radius = 0.3", "radius = 0.4", &STEPS[2..]),
        ("noise = 0.1", "noise = 0.2", &STEPS[1..]),
        // The queue acts nowhere: the same guides grow, and nothing after them asks why.
        ("return root.x > 0", "return root.x > 1", &STEPS[1..2]),
        ("count = 40", "count = 41", &STEPS[..]),
        ("strands = 200", "strands = 210", &STEPS[3..]),
        ("head:scalp()", "head:scalp():where(function(p) return p.y > 2 end)", &STEPS[..]),
        // Only the members keep off a parting.
        ("head:scalp()", "head:scalp():parting { { 0, 12, 8 }, { 0, 13, -2 } }", &STEPS[3..]),
    ] {
        assert_eq!(computed(&script(&edited(from, to), &memo)), steps, "{to}");
    }
    assert_eq!(computed(&script(SCRIPT, &memo)), [""; 0], "the first style is still there");
    let seeded = Options { seed: 5, ..options(&memo) };
    let seeded = run(&seeded, Arc::new(Memory::default().with("style/a.lua", SCRIPT)), &Task::new());
    assert_eq!(computed(&seeded), STEPS);
}

#[test]
fn a_comment_recomputes_nothing_and_places_follow() {
    let memo = Arc::default();
    let first = script(SCRIPT, &memo);
    let moved = script(&format!("-- one line more\n{SCRIPT}"), &memo);
    assert_eq!(computed(&moved), [""; 0]);
    // The warning is told again, where the call is now.
    assert_eq!((first.diagnostics.len(), moved.diagnostics.len()), (1, 1), "{:?}", first.diagnostics);
    let (before, after) = (&first.diagnostics[0], &moved.diagnostics[0]);
    assert!(before.message.contains("no strand ever entered"), "{}", before.message);
    assert_eq!((&before.message, &before.hints), (&after.message, &after.hints));
    let line = |d: &coif::script::Diagnostic| d.place.as_ref().map(|p| p.line);
    assert_eq!(line(after), line(before).map(|l| l + 1));
    // Strands tell their new place, those of the first run their old one.
    let (old, new) = (first.scene.unwrap(), moved.scene.unwrap());
    let sources = |scene: &Scene| -> Vec<String> {
        let hair = hair(scene);
        hair.strands.sources.iter().chain(&hair.guides.sources).map(ToString::to_string).collect()
    };
    assert_eq!(sources(&old), ["a.lua:10", "a.lua:5"]);
    assert_eq!(sources(&new), ["a.lua:11", "a.lua:6"]);
    assert_eq!(hair(&old).strands.points, hair(&new).strands.points);
}

#[test]
fn a_small_memo_holds_its_bound_and_changes_nothing() {
    let (ample, small, none) = (Arc::default(), Arc::new(Memo::new(60_000)), Arc::new(Memo::new(0)));
    let mut points = vec![];
    for memo in [&ample, &small, &none, &small, &ample] {
        for text in [SCRIPT, &edited("period = 4", "period = 3"), SCRIPT] {
            let outcome = script(text, memo);
            points.push(hair(outcome.scene.as_ref().unwrap()).strands.points.clone());
            assert!(memo.bytes() <= 60_000 || Arc::ptr_eq(memo, &ample));
        }
    }
    assert!(!small.is_empty() && none.is_empty());
    assert_eq!(computed(&script(SCRIPT, &none)), STEPS);
    for three in points.chunks(3) {
        assert_eq!(three, &points[..3]);
    }
}

/// A box with a bump for a face: a head as far as a memo is concerned.
fn lump(wide: f32) -> String {
    let mut text = String::new();
    let (rows, columns) = (24_u32, 32_u32);
    for i in 0..=rows {
        for j in 0..columns {
            let (a, b) =
                (std::f32::consts::PI * i as f32 / rows as f32, std::f32::consts::TAU * j as f32 / columns as f32);
            let ring = if i == 0 || i == rows { 0.0 } else { coif::math::trig::sin(a) };
            let p = [
                wide * ring * coif::math::trig::sin(b),
                12.0 * coif::math::trig::cos(a),
                9.5 * ring * coif::math::trig::cos(b),
            ];
            text += &format!("v {} {} {}\n", p[0], p[1], p[2]);
        }
    }
    for i in 0..rows {
        for j in 0..columns {
            let at = |i: u32, j: u32| i * columns + j % columns + 1;
            text += &format!("f {} {} {} {}\n", at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
        }
    }
    text
}

#[test]
fn a_head_is_known_by_the_content_of_its_file() {
    let text = |file: &str| {
        format!(
            "local head = coif.head {{ file = '{file}', landmarks = {{ vertex = {{ 0, 12, 0 }}, forehead = {{ 0, 8, 7 }}, \
             left_temple = {{ 6, 4, 5 }}, right_temple = {{ -6, 4, 5 }}, left_ear = {{ 7.5, 0, 0 }}, \
             right_ear = {{ -7.5, 0, 0 }}, occiput = {{ 0, 2, -9.5 }}, nape = {{ 0, -6, -8 }}, chin = {{ 0, -11, 3 }} }} }}\n\
             local hair = head:scalp():guides {{ count = 10, length = 2, step = 1 }}:grow {{}}\n\
             return coif.scene {{ head, hair }}"
        )
    };
    let memo = Arc::default();
    let go = |file: &str, lump: &str| {
        let files = Memory::default().with("style/a.lua", text(file)).with(Path::new("style").join(file), lump);
        let outcome = run(&options(&memo), Arc::new(files), &Task::new());
        assert_eq!(outcome.ending, Ending::Done, "{:?}", outcome.diagnostics);
        let origin = |what: &str| outcome.timings.iter().find(|t| t.what == what).and_then(|t| t.origin);
        (origin("coif.head"), origin("Guides:grow"))
    };
    let (thick, thin) = (lump(7.5), lump(7.0));
    let (hit, made) = (Some(Origin::Hit), Some(Origin::Computed));
    assert_eq!(go("a.obj", &thick), (made, made));
    assert_eq!(go("a.obj", &thick), (hit, hit));
    assert_eq!(go("a.obj", &thin), (made, made));
    assert_eq!(go("heads/a.obj", &thick), (hit, hit), "another folder is no other head");
    // A remark in the file is another file, but the same head.
    assert_eq!(go("a.obj", &format!("# a remark\n{thick}")), (made, hit));
}

const TUFTS: &str = r##"-- Stylised hair, some of it too deep.
local head = coif.head { style = "cartoon" }
local function at(azimuth, height) return { azimuth = azimuth, elevation = 60, height = height } end
local a = coif.tuft { stroke = { at(-40, 0), at(-40, 3), at(-60, 4) }, diameter = 3, peak = 30, material = "#604020" }
local b = coif.tuft { stroke = { at(40, 0), at(40, 0.1), at(90, 0.1) }, diameter = 3, peak = 30 }
local all = coif.fill { a, b, around = 30, jitter = 0.5 }
local cap = coif.cap { material = "#302010" }
return coif.scene { head, cap, all, shading = "toon", views = { "front" } }
"##;

#[test]
fn tufts_their_fills_and_caps_are_kept() {
    let memo = Arc::default();
    let computed = |outcome: &Outcome| {
        let steps: Vec<_> = outcome.timings.iter().filter(|t| t.origin.is_some()).collect();
        let names: Vec<_> = steps.iter().map(|t| &*t.what).collect();
        assert_eq!(names, ["coif.tuft", "coif.tuft", "coif.fill", "coif.cap"], "every step says where it is from");
        let computed = steps.iter().filter(|t| t.origin == Some(Origin::Computed));
        computed.map(|t| format!("{} {}", t.what, t.source)).collect::<Vec<_>>()
    };
    let edit = |from: &str, to: &str| {
        assert_eq!(TUFTS.matches(from).count(), 1, "`{from}`");
        TUFTS.replace(from, to)
    };
    let first = script(TUFTS, &memo);
    assert_eq!(computed(&first).len(), 4);
    let same = script(TUFTS, &memo);
    assert_eq!(computed(&same), [""; 0]);
    // The warnings of what lies too deep are told again, in their places, and the tufts are the same.
    assert!(!first.diagnostics.is_empty() && first.diagnostics == same.diagnostics, "{:?}", first.diagnostics);
    let tufts = |o: &Outcome| o.scene.as_ref().unwrap().locks().map(|(_, l)| l.tufts.tufts.clone()).collect::<Vec<_>>();
    assert_eq!(tufts(&first), tufts(&same));
    let moved = script(&format!("-- one line more\n{TUFTS}"), &memo);
    assert_eq!(computed(&moved), [""; 0]);
    let lines = |o: &Outcome| o.diagnostics.iter().map(|d| d.place.as_ref().map(|p| p.line)).collect::<Vec<_>>();
    let later: Vec<_> = lines(&first).into_iter().map(|l| l.map(|l| l + 1)).collect();
    assert_eq!(lines(&moved), later);
    let sources = |o: &Outcome| o.scene.as_ref().unwrap().locks().nth(1).unwrap().1.tufts.sources.clone();
    assert_eq!((&*sources(&first)[0], &*sources(&moved)[0]), ("a.lua:4", "a.lua:5"));
    // A look makes nothing anew; a shape what it is the shape of, and what is made of it.
    assert_eq!(computed(&script(&edit("#302010", "#403020"), &memo)), [""; 0]);
    assert_eq!(computed(&script(&edit("shading = \"toon\", ", ""), &memo)), [""; 0]);
    assert_eq!(computed(&script(&edit("jitter = 0.5", "jitter = 0.7"), &memo)), ["coif.fill a.lua:6"]);
    let wider = script(&edit("at(-60, 4) }, diameter = 3", "at(-60, 4) }, diameter = 4"), &memo);
    assert_eq!(computed(&wider), ["coif.tuft a.lua:4", "coif.fill a.lua:6"]);
    // What is kept is what would be made.
    let fresh = script(TUFTS, &Arc::new(Memo::new(0)));
    assert_eq!(tufts(&script(TUFTS, &memo)), tufts(&fresh));
}

/// Runs a script with files in a folder of its own.
fn workbench(text: &str, memo: &Arc<Memo>) -> (Report, Vec<Vec<u8>>) {
    let out = tempfile::tempdir().unwrap();
    let options = RunOptions {
        script: options(memo),
        out: out.path().to_path_buf(),
        debug: true,
        background: None,
        views: None,
        sheet: SheetOptions { width: 48, height: 48, ..SheetOptions::default() },
        strands: StrandForm::Ribbons,
        tolerance: Some(0.05),
        motion: coif::export::MotionForm::Auto,
        guides: true,
        formats: vec![Format::Glb],
        films: Films { moving: true, turntable: false },
        count_inside: false,
        triangles: None,
    };
    let report = workbench::run(&options, Arc::new(Memory::default().with("style/a.lua", text)), &Task::new());
    let files = report.written.as_ref().unwrap().iter().map(|w| std::fs::read(&w.path).unwrap()).collect();
    (report, files)
}

fn made(report: &Report) -> Vec<&str> {
    report.stages.iter().filter(|s| s.origin == Some(Origin::Computed)).map(|s| s.what).collect()
}

#[test]
fn pictures_and_models_are_kept_and_the_bytes_are_the_same() {
    let (memo, none) = (Arc::default(), Arc::new(Memo::new(0)));
    let all = ["picture", "debug picture", "glb", "guides"];
    assert_eq!(made(&workbench(SCRIPT, &memo).0), all);
    assert_eq!(made(&workbench(&edited("and warns", "and always warns"), &memo).0), [""; 0]);
    // Files that name places in the script have to name the new ones; nothing that is drawn is computed.
    let moved = format!("-- one line more\n{SCRIPT}");
    assert_eq!(made(&workbench(&moved, &memo).0), ["glb", "guides"]);
    let coloured = edited("#201008", "#c0a080");
    assert_eq!(made(&workbench(&coloured, &memo).0), all);
    for text in [SCRIPT, &moved, &coloured] {
        let (kept, fresh) = (workbench(text, &memo), workbench(text, &none));
        assert_eq!((made(&kept.0), made(&fresh.0)), (vec![], all.to_vec()));
        assert!(kept.1 == fresh.1, "the files differ");
    }
}
