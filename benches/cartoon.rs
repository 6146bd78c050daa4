//! From save to picture: a whole cartoon style, three views of 1024 x 1024.
//!
//! Each round saves the script with an edit that was never made before, runs it with the memo of all earlier rounds, and
//! ends when the picture is in its place; `coif watch` adds its quiet period before that and the other files after it.
//! Printed are median and 95th percentile of the wall clock, and the processor time per round (all threads together),
//! which other programs on the machine disturb least; and beside them the time of filling the picture's bytes.
//!
//! `cargo bench --bench cartoon -- [ROUNDS] [SAMPLES]`; SAMPLES per pixel and side, 2 as `coif run` draws; `coif watch` draws 1.

use std::hint::black_box;
use std::sync::Arc;
use std::time::{Duration, Instant};

use coif::export::{Format, StrandForm};
use coif::render::SheetOptions;
use coif::scene::View;
use coif::script::{Disk, Options};
use coif::task::Task;
use coif::workbench::{self, Films, Report, RunOptions};

mod timing;

use timing::{ms, processor_time, tell};

const SCRIPTS: [(&str, &str); 2] = [
    ("twin_tails", include_str!("../examples/cartoon/twin_tails.lua")),
    ("bob", include_str!("../examples/cartoon/bob.lua")),
];
const SIZE: u32 = 1024;

/// An edit: its name, and the script with it made for the `n`th time.
type Edit = (&'static str, fn(&str, usize) -> String);

const EDITS: &[Edit] = &[
    // Heights over the skin are used in one place of each style, for every lock.
    ("every stroke", |text, n| edited(text, " or 0 }", &format!(" or 0.{n:04} }}"))),
    ("a look", |text, n| edited(text, "shine = ", &format!("shine = 0.{n:04} + "))),
    ("a comment", |text, n| format!("-- version {n}\n{text}")),
    ("nothing", |text, _| text.to_owned()),
];

fn edited(text: &str, from: &str, to: &str) -> String {
    assert!(text.contains(from), "the example has changed: no `{from}`");
    text.replacen(from, to, 1)
}

fn main() {
    // `cargo bench` adds `--bench`.
    let numbers: Vec<usize> = std::env::args().skip(1).filter_map(|a| a.parse().ok()).collect();
    let rounds = numbers.first().map_or(20, |&n| n.max(1));
    let supersample = numbers.get(1).map_or(2, |&n| n as u32);
    for (name, text) in SCRIPTS {
        let dir = tempfile::tempdir().expect("a temporary folder");
        let options = RunOptions {
            script: Options::new(dir.path().join(format!("{name}.lua"))),
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
        let threads = rayon::current_num_threads();
        println!(
            "{name}, 3 views of {SIZE} x {SIZE}, {supersample} x {supersample} samples, {rounds} rounds, {threads} threads"
        );
        let (first, cpu, report) = round(&options, text);
        println!("{:18} {:>8}              cpu {:>8}", "the first run", ms(first), ms(cpu));
        tell(&report);
        for (name, edit) in EDITS {
            let mut times = vec![];
            let (mut cpu, mut last) = (Duration::ZERO, None);
            for n in 0..rounds {
                let (time, own, report) = round(&options, &edit(text, n + 1));
                times.push(time);
                cpu += own;
                last = Some(report);
            }
            times.sort();
            let at = |part: f64| ms(times[((times.len() as f64 * part) as usize).min(times.len() - 1)]);
            println!("{name:18} {:>8} p95 {:>8} cpu {:>8}", at(0.5), at(0.95), ms(cpu / rounds as u32));
            if let Some(report) = last {
                tell(&report);
            }
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
}

/// Saves, runs, and says how long it took on the wall and on all processors.
fn round(options: &RunOptions, text: &str) -> (Duration, Duration, Report) {
    let before = processor_time();
    let started = Instant::now();
    std::fs::write(&options.script.script, text).expect("the script can be saved");
    let report = workbench::preview(options, Arc::new(Disk), &Task::new());
    let time = started.elapsed();
    assert!(report.written.is_ok(), "{:?} {:?}", report.written, report.outcome.diagnostics);
    (time, processor_time().saturating_sub(before), report)
}
