//! From save to picture: the ponytail of 40,000 strands and a cartoon style, three views of 1024 x 1024.
//!
//! Each round saves the script with an edit that was never made before, runs it with the memo of all earlier rounds as
//! `coif watch` does, and ends when the whole picture is in its place; `coif watch` adds its quiet period before that and
//! the other files after it. Printed are median and 95th percentile of the wall clock to the first picture (a draft, or
//! the whole one) and to the whole one, and the processor time per round (all threads together), which other programs on
//! the machine disturb least; and beside them the time of filling the picture's bytes.
//!
//! `cargo bench --bench reload -- [ROUNDS] [STRANDS] [SAMPLES]`; SAMPLES per pixel and side, 2 as `coif run` draws; `coif watch` draws 1.

use std::hint::black_box;
use std::sync::Arc;
use std::time::{Duration, Instant};

use coif::export::{Format, StrandForm};
use coif::render::SheetOptions;
use coif::scene::View;
use coif::script::{Disk, Options};
use coif::task::Task;
use coif::workbench::{Films, Report, RunOptions, draft};

mod timing;

use timing::{ms, processor_time, tell};

const SCRIPT: &str = include_str!("../examples/ponytail.lua");
const CARTOON: &str = include_str!("../examples/cartoon/spiky_hero.lua");
const SIZE: u32 = 1024;

/// An edit: its name, and the script with it made for the `n`th time.
type Edit = (&'static str, fn(usize) -> String);

fn edited(from: &str, to: &str) -> String {
    changed(SCRIPT, from, to)
}

fn changed(script: &str, from: &str, to: &str) -> String {
    assert!(script.contains(from), "the example has changed: no `{from}`");
    script.replacen(from, to, 1)
}

const EDITS: &[Edit] = &[
    ("a domain", |n| edited("direction = { 0, -1, -0.06 }", &format!("direction = {{ 0, -1, -0.{:04} }}", 601 + n))),
    ("a natural domain", |n| edited("period = 11", &format!("period = 11.{:03}", n + 1))),
    ("a colour", |n| edited("material = looks.chestnut", &format!("material = {{ root_colour = '#{:06x}' }}", n + 1))),
    ("a comment", |n| format!("-- version {n}\n{SCRIPT}")),
    ("nothing", |_| SCRIPT.to_owned()),
    ("cartoon: a shape", |n| changed(CARTOON, "length = { 1,", &format!("length = {{ 1.{:04},", n + 1))),
    ("cartoon: a colour", |n| changed(CARTOON, "#f2b632", &format!("#{:06x}", 0x00f2_b632 + n + 1))),
    ("cartoon: a comment", |n| format!("-- version {n}\n{CARTOON}")),
];

fn main() {
    // `cargo bench` adds `--bench`.
    let numbers: Vec<usize> = std::env::args().skip(1).filter_map(|a| a.parse().ok()).collect();
    let (rounds, strands) = (numbers.first().map_or(20, |&n| n.max(1)), numbers.get(1).map_or(40_000, |&n| n));
    let supersample = numbers.get(2).map_or(2, |&n| n as u32);
    let dir = tempfile::tempdir().expect("a temporary folder");
    let script = Options::new(dir.path().join("ponytail.lua"));
    let options = RunOptions {
        script,
        out: dir.path().join("out"),
        debug: false,
        background: None,
        views: Some(vec![View::Front, View::Left, View::Back]),
        sheet: SheetOptions { width: SIZE, height: SIZE, columns: Some(3), supersample, ..SheetOptions::default() },
        strands: StrandForm::None,
        tolerance: Some(0.05),
        motion: coif::export::MotionForm::Auto,
        guides: false,
        formats: vec![Format::Glb],
        films: Films { moving: true, turntable: false },
        count_inside: false,
        triangles: None,
    };
    println!(
        "{strands} strands, 3 views of {SIZE} x {SIZE}, {supersample} x {supersample} samples, {rounds} rounds, {} threads",
        rayon::current_num_threads()
    );
    println!("{:20} {:>22}  {:>22}  {:>10}", "", "first picture, p95", "whole picture, p95", "processor");
    // Only the ponytail has a parameter for it.
    let mut hairy = options.clone();
    hairy.script.set.insert("strands".into(), strands.to_string());
    for (script, options) in [(SCRIPT, &hairy), (CARTOON, &options)] {
        let once = round(options, script);
        println!("{:20} {:>22}  {:>22}  {:>10}", "the first run", ms(once.first), ms(once.whole), ms(once.processor));
        tell(&once.report);
    }
    for (name, edit) in EDITS {
        let options = if name.starts_with("cartoon") { &options } else { &hairy };
        let all: Vec<Round> = (0..rounds).map(|n| round(options, &edit(n))).collect();
        let column = |time: fn(&Round) -> Duration| {
            let mut times: Vec<Duration> = all.iter().map(time).collect();
            times.sort();
            let at = |part: f64| ms(times[((times.len() as f64 * part) as usize).min(times.len() - 1)]);
            format!("{} {:>10}", at(0.5), at(0.95))
        };
        let processor = all.iter().map(|r| r.processor).sum::<Duration>() / rounds as u32;
        println!("{name:20} {:>22}  {:>22}  {:>10}", column(|r| r.first), column(|r| r.whole), ms(processor));
        if let Some(last) = all.last() {
            tell(&last.report);
        }
    }
    let mut bytes = vec![0_u8; (3 * SIZE * SIZE * 4) as usize];
    let mut times: Vec<Duration> = (0..100)
        .map(|n| {
            let started = Instant::now();
            black_box(&mut bytes).fill(black_box(n));
            started.elapsed()
        })
        .collect();
    times.sort();
    println!("{:18} {:>8} p95 {:>8}", "memset of pixels", ms(times[50]), ms(times[95]));
    println!("in the memo: {:.0} MB", options.script.memo.bytes() as f64 / 1e6);
}

/// One round's times, and what the whole run says.
struct Round {
    first: Duration,
    whole: Duration,
    processor: Duration,
    report: Report,
}

/// Saves, runs, and says how long it took on the wall and on all processors.
fn round(options: &RunOptions, text: &str) -> Round {
    let before = processor_time();
    let started = Instant::now();
    std::fs::write(&options.script.script, text).expect("the script can be saved");
    let mut first = None;
    let report = draft::preview_drafted(options, draft::MEMBERS, Arc::new(Disk), &Task::new(), |_| {
        first = Some(started.elapsed());
    });
    let whole = started.elapsed();
    assert!(report.written.is_ok(), "{:?} {:?}", report.written, report.outcome.diagnostics);
    let processor = processor_time().saturating_sub(before);
    Round { first: first.unwrap_or(whole), whole, processor, report }
}
