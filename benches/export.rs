//! Writing 40,000 strands of 64 nodes, beside plainly storing as many bytes.
//!
//! `cargo bench --bench export`

use std::sync::Arc;

use coif::export::{CyHairOptions, GlbOptions, StrandForm, UsdaOptions, cyhair, glb, usda};
use coif::geometry::{Root, Strands};
use coif::math::{rng::Key, trig};
use coif::scene::{Body, Hair, HairMaterial, Look, Overlay, Part, Scene, Shown, View};
use coif::task::Task;
use divan::Bencher;
use divan::counter::BytesCount;
use glam::{Affine3A, Quat, Vec2, Vec3};

const STRANDS: u64 = 40_000;
const NODES: usize = 64;

fn main() {
    divan::main();
}

/// Long hair on a ball of 9 cm: combed over it, then hanging, the lower half in loose waves.
fn scene() -> Scene {
    let mut strands = Strands::new();
    for id in 0..STRANDS {
        let key = Key::new(1, "bench").with(id);
        let mut normal = key.direction();
        normal.y = normal.y.abs();
        let root = Root { id, position: normal * 9.0, normal, uv: Vec2::ZERO, triangle: 0 };
        let axis = normal.cross(Vec3::NEG_Y).normalize_or(Vec3::X);
        let over = std::f32::consts::FRAC_PI_2 - trig::acos(normal.y);
        let phase = key.with(1).range(0.0, std::f32::consts::TAU);
        let end = Quat::from_axis_angle(axis, over) * normal * 9.5;
        strands.push(
            root,
            0,
            (0..NODES).map(|i| {
                let s = i as f32 * 0.6;
                let lying = 9.0 * over;
                let base = if s < lying {
                    Quat::from_axis_angle(axis, s / 9.0) * normal * (9.0 + 0.5 * trig::smoothstep(0.0, 1.0, s))
                } else {
                    end - Vec3::Y * (s - lying)
                };
                let wave = 0.6 * trig::smoothstep(15.0, 25.0, s);
                base + Vec3::new(trig::cos(phase + s), 0.0, trig::sin(phase + s)) * wave
            }),
        );
    }
    let strands = Arc::new(strands);
    let hair = Hair {
        guides: strands.clone(),
        strands,
        material: HairMaterial::default(),
        overlay: Arc::new(Overlay::default()),
    };
    Scene {
        name: "bench".into(),
        parts: vec![Part { name: "hair".into(), source: String::new(), body: Body::Hair(hair), motion: None }],
        views: vec![View::Front],
        look: Look::default(),
        placement: Affine3A::IDENTITY,
        shown: Shown::default(),
        overlay: Arc::default(),
    }
}

fn write(bencher: Bencher, options: &GlbOptions) {
    let (scene, task) = (scene(), Task::new());
    let bytes = glb(&scene, options, &task).expect("a good scene").len();
    bencher.counter(BytesCount::new(bytes)).bench_local(|| glb(&scene, options, &task));
}

/// The machine's limit: as many bytes as `ribbons` writes, into fresh memory.
#[divan::bench(sample_count = 12)]
fn store_the_bytes_of_ribbons(bencher: Bencher) {
    let bytes = glb(&scene(), &GlbOptions::default(), &Task::new()).expect("a good scene").len();
    bencher.counter(BytesCount::new(bytes)).bench_local(|| vec![1_u8; bytes]);
}

#[divan::bench(sample_count = 12)]
fn ribbons(bencher: Bencher) {
    write(bencher, &GlbOptions::default());
}

#[divan::bench(sample_count = 12)]
fn ribbons_with_every_node(bencher: Bencher) {
    write(bencher, &GlbOptions { tolerance: 0.0, ..GlbOptions::default() });
}

#[divan::bench(sample_count = 12)]
fn lines(bencher: Bencher) {
    write(bencher, &GlbOptions { strands: StrandForm::Lines, ..GlbOptions::default() });
}

#[divan::bench(sample_count = 12)]
fn usd_text(bencher: Bencher) {
    let (scene, task) = (scene(), Task::new());
    let options = UsdaOptions { guides: false, ..UsdaOptions::default() };
    let bytes = usda(&scene, &options, &task).expect("a good scene").len();
    bencher.counter(BytesCount::new(bytes)).bench_local(|| usda(&scene, &options, &task));
}

#[divan::bench(sample_count = 12)]
fn hair_file(bencher: Bencher) {
    let (scene, task) = (scene(), Task::new());
    let bytes = cyhair(&scene, &CyHairOptions::default(), &task).expect("a good scene").len();
    bencher.counter(BytesCount::new(bytes)).bench_local(|| cyhair(&scene, &CyHairOptions::default(), &task));
}
