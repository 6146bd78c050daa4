//! The preview of 40,000 strands of 64 points: three views of 1024 x 1024, step by step, beside plain memory.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use coif::geometry::{Mesh, Root, Strands};
use coif::math::rng::Key;
use coif::math::trig::{cos, sin};
use coif::render::{self, SheetOptions, Speed};
use coif::scene::{Body, Hair, HairMaterial, Look, MeshMaterial, Overlay, Part, Scene, Shown, View};
use coif::task::Task;
use divan::Bencher;
use glam::{Affine3A, Vec2, Vec3};

const STRANDS: usize = 40_000;
const POINTS: usize = 64;
/// A draft has one strand of so many, each so many times as wide.
const THINNED: usize = 7;
const VIEWS: [View; 3] = [View::Front, View::Left, View::ThreeQuarter];

/// An egg for a head, about 20,000 triangles.
fn egg() -> Mesh {
    let (rows, columns) = (100_u32, 100_u32);
    let mut mesh = Mesh::default();
    for i in 0..=rows {
        for j in 0..columns {
            let a = std::f32::consts::PI * i as f32 / rows as f32;
            let b = std::f32::consts::TAU * j as f32 / columns as f32;
            mesh.positions.push(Vec3::new(7.6 * sin(a) * sin(b), 12.0 * cos(a), 9.6 * sin(a) * cos(b)));
            if i < rows {
                let (p, q) = (i * columns + j, i * columns + (j + 1) % columns);
                mesh.triangles.extend([[p, p + columns, q], [q, p + columns, q + columns]]);
            }
        }
    }
    mesh.compute_normals();
    mesh
}

/// Long hair that falls over the egg in waves.
fn long(count: usize) -> Strands {
    let mut strands = Strands::new();
    strands.sources.push("bench".into());
    let (key, egg) = (Key::new(1, "bench"), Vec3::new(7.6, 12.0, 9.6));
    for i in 0.. {
        if strands.count() == count {
            break;
        }
        let key = key.with(i);
        let at = key.direction();
        if at.y < 0.2 && at.z > -0.2 {
            continue;
        }
        let shell = egg + Vec3::splat(0.2 + 0.8 * key.with(1).unit());
        let (mut p, mut d) = (at * egg, (at / egg).normalize());
        let root = Root { id: key.bits(), position: p, normal: d, uv: Vec2::ZERO, triangle: 0 };
        let nodes: Vec<Vec3> = (0..POINTS)
            .map(|k| {
                let here = p;
                d = (d + Vec3::new(0.0, -0.13, 0.0)).normalize();
                p += d * 0.6;
                let q = p / shell;
                if q.length_squared() < 1.0 {
                    p = q.normalize() * shell;
                }
                let wave = 0.3 * (k as f32 * 0.1).min(1.0) * sin(k as f32 * 0.5 + 6.0 * at.x);
                here + Vec3::new(at.x, 0.0, at.z) * wave
            })
            .collect();
        strands.push(root, 0, nodes);
    }
    strands
}

/// One in `thinned` of the strands, each drawn as much wider.
fn scene(thinned: usize) -> Scene {
    let strands = Arc::new(long(STRANDS / thinned));
    let material = HairMaterial::default();
    let material = HairMaterial { width: material.width * thinned as f32, ..material };
    let hair = Hair { guides: strands.clone(), strands, material, overlay: Arc::new(Overlay::default()) };
    let head = Body::Mesh(Arc::new(egg()), MeshMaterial::default());
    Scene {
        name: "bench".into(),
        parts: vec![
            Part { name: "head".into(), source: String::new(), body: head, motion: None },
            Part { name: "hair".into(), source: String::new(), body: Body::Hair(hair), motion: None },
        ],
        views: VIEWS.to_vec(),
        look: Look::default(),
        placement: Affine3A::IDENTITY,
        shown: Shown::default(),
        overlay: Arc::default(),
    }
}

fn options() -> SheetOptions {
    SheetOptions { width: 1024, height: 1024, supersample: 1, lettering: false, ..SheetOptions::default() }
}

/// The whole sheet, three views; as a draft of every seventh strand; and at two by two samples per pixel.
#[divan::bench(sample_count = 5, args = ["whole", "draft", "2 x 2 samples"])]
fn sheet(bencher: Bencher, how: &str) {
    let (scene, options) = match how {
        "draft" => (scene(THINNED), options()),
        "whole" => (scene(1), options()),
        _ => (scene(1), SheetOptions { supersample: 2, ..options() }),
    };
    bencher.bench_local(|| render::sheet(&scene, &options, &Task::new()).expect("a picture"));
}

/// Coding the sheet as PNG, for watching and for keeping.
#[divan::bench(sample_count = 5, args = [Speed::Fast, Speed::Balanced])]
fn png(bencher: Bencher, speed: Speed) {
    let picture = render::sheet(&scene(1), &options(), &Task::new()).expect("a picture");
    bencher.bench_local(|| render::png::encode(&picture, speed).expect("a file"));
}

/// The machine's limit: copying the points once for each view and writing the pixels once.
#[divan::bench(sample_count = 20)]
fn memory(bencher: Bencher) {
    let points = vec![Vec3::ONE; STRANDS * POINTS];
    let mut copy = vec![Vec3::ZERO; STRANDS * POINTS];
    let mut pixels = vec![0_u8; 1024 * 1024 * 3];
    bencher.bench_local(|| {
        for shade in 0..VIEWS.len() as u8 {
            copy.copy_from_slice(divan::black_box(&points));
            pixels.fill(divan::black_box(shade));
        }
    });
}

/// Times per step, summed over the views: the least of three runs.
fn breakdown() {
    let scene = scene(1);
    let mut best: Option<(Duration, BTreeMap<String, Duration>)> = None;
    for _ in 0..3 {
        let steps = Arc::new(Mutex::new((Instant::now(), String::new(), BTreeMap::new())));
        let seen = steps.clone();
        let task = Task::new().with_progress(move |what, _| {
            let mut s = seen.lock().expect("one thread");
            let (since, before) = (s.0, std::mem::replace(&mut s.1, what.to_owned()));
            *s.2.entry(before).or_insert(Duration::ZERO) += since.elapsed();
            s.0 = Instant::now();
        });
        let start = Instant::now();
        render::sheet(&scene, &options(), &task).expect("a picture");
        let (whole, steps) = (start.elapsed(), steps.lock().expect("one thread").2.clone());
        if best.as_ref().is_none_or(|b| whole < b.0) {
            best = Some((whole, steps));
        }
    }
    if let Some((whole, steps)) = best {
        println!("{STRANDS} strands x {POINTS} points, {} views of 1024 x 1024: {whole:.0?}", VIEWS.len());
        for (step, time) in steps.iter().filter(|(step, _)| !step.is_empty()) {
            println!("  {step:<12} {time:>8.1?}");
        }
    }
}

fn main() {
    breakdown();
    divan::main();
}
