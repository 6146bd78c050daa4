//! Steps of hair under forces, beside the machine's limit.
//!
//!     cargo bench --bench dynamics
//!
//! Items are steps; particles times steps a second follow from the counts.

use std::hint::black_box;
use std::sync::{Arc, LazyLock};

use coif::dynamics::{
    Body, EARTH, Field, Force, GravityOptions, Hair, HairOptions, Lengths, Plan, Poses, SettleOptions, Skin, Solver,
    World, settle,
};
use coif::geometry::{Root, Strands};
use coif::head::{Head, mannequin};
use coif::math::rng::Key;
use coif::params::Direction;
use coif::task::Task;
use divan::Bencher;
use divan::counter::{BytesCount, ItemsCount};
use glam::{Vec2, Vec3};

fn main() {
    divan::main();
}

/// Level strands, 3 cm a segment.
fn level(count: u64, nodes: usize) -> Strands {
    let mut strands = Strands { sources: vec!["bench.lua:1".into()], ..Strands::new() };
    for id in 0..count {
        let at = Key::new(1, "bench").with(id).direction() * 9.0;
        let root = Root { id, position: at, normal: Vec3::X, uv: Vec2::ZERO, triangle: 0 };
        strands.push(root, 0, (0..nodes).map(|k| at + Vec3::X * (3.0 * k as f32)));
    }
    strands.stage = vec![0; strands.points.len()];
    strands
}

/// The built-in head and its grid, as scripts pass them.
static HEAD: LazyLock<(Head, Skin)> = LazyLock::new(|| {
    let head = Head::mannequin(mannequin::Style::Adult).expect("the built-in head");
    let skin = Skin::new(&head.solid);
    (head, skin)
});

fn body() -> Body<'static> {
    Body { solid: &HEAD.0.solid, skin: &HEAD.1 }
}

/// Strands that stand out of the upper part and the back of the head.
fn standing(count: u64, nodes: usize, length: f32) -> Strands {
    let mut strands = Strands { sources: vec!["bench.lua:1".into()], ..Strands::new() };
    let ways = (0..).map(|id| (id, Key::new(2, "bench roots").with(id).direction()));
    for (id, d) in ways.filter(|(_, d)| d.y > 0.0 || d.z < -0.3).take(count as usize) {
        let skin = HEAD.0.solid.closest(Vec3::new(0.0, 5.0, -1.0) + d * 14.0);
        let root = Root { id, position: skin.position, normal: skin.normal, uv: Vec2::ZERO, triangle: 0 };
        let at = |k: usize| skin.position + skin.normal * (0.01 + length * k as f32 / (nodes - 1) as f32);
        strands.push(root, 0, (0..nodes).map(at));
    }
    strands.stage = vec![0; strands.points.len()];
    strands
}

/// Steps in one go.
const STEPS: usize = 48;

fn steps(bencher: Bencher, strands: &Strands, body: Option<Body>, change: impl Fn(&mut HairOptions)) {
    let gravity = Field::Gravity(GravityOptions { strength: EARTH, direction: Direction(Vec3::NEG_Y) });
    let mut options =
        HairOptions { hold: 0.0, forces: Some(vec![Arc::new(Force::from(gravity))]), ..HairOptions::default() };
    change(&mut options);
    let (poses, acting) = (Poses::still(), options.acting());
    let plan = Plan {
        step: 1.0 / options.steps,
        duration: 10.0,
        poses: &poses,
        is_loop: false,
        is_settling: false,
        drag: 3.0,
        is_balanced: false,
        is_loose: false,
    };
    let hair = Hair { strands, options: &options, pinned: &[], body };
    let mut world = World::new(hair, plan, &acting).expect("good strands");
    bencher.counter(ItemsCount::new(STEPS)).bench_local(|| world.advance(STEPS, &Task::new()));
}

/// The paper's scene, 2,500 strands of 10 segments, without bending: both forms, both orders.
#[divan::bench(args = ["chain exact", "chain root_free", "pairs exact", "pairs root_free"])]
fn paper(bencher: Bencher, form: &str) {
    steps(bencher, &level(2500, 11), None, |o| {
        o.solver = if form.starts_with("chain") { Solver::Chain } else { Solver::Pairs };
        o.lengths = if form.ends_with("exact") { Lengths::Exact } else { Lengths::RootFree };
    });
}

/// The same with bending.
#[divan::bench]
fn bending(bencher: Bencher) {
    steps(bencher, &level(2500, 11), None, |o| o.hold = 4.0);
}

/// The paper's count with the head to keep out of: limp in both orders, and with bending.
#[divan::bench(args = ["pairs", "chain", "chain with bending"])]
fn head(bencher: Bencher, form: &str) {
    steps(bencher, &standing(2500, 11, 30.0), Some(body()), |o| {
        o.solver = if form == "pairs" { Solver::Pairs } else { Solver::Chain };
        o.hold = if form.ends_with("bending") { 4.0 } else { 0.0 };
    });
}

/// 800 guides of 64 nodes let settle as `strands:settle {}` does.
#[divan::bench(args = ["without head", "with head"], sample_count = 5, sample_size = 1)]
fn settled(bencher: Bencher, how: &str) {
    let strands = standing(800, 64, 40.0);
    let options = HairOptions::default();
    let body = (how == "with head").then(body);
    let hair = Hair { strands: &strands, options: &options, pinned: &[], body };
    let limits = SettleOptions { limit: 10.0, rest_speed: 0.5 };
    bencher.bench_local(|| settle(&hair, &limits, &Task::new()).expect("good strands"));
}

/// Particles, in strands of 10 segments.
#[divan::bench(args = [1_000, 10_000, 100_000, 1_000_000])]
fn particles(bencher: Bencher, count: u64) {
    steps(bencher, &level(count / 11, 11), None, |_| {});
}

/// The machine's limit: storing the places of the paper's scene as often.
#[divan::bench]
fn plain_store(bencher: Bencher) {
    let mut places = vec![Vec3::ZERO; 27_500];
    bencher.counter(BytesCount::of_many::<Vec3>(27_500 * STEPS)).bench_local(|| {
        for _ in 0..STEPS {
            black_box(&mut places).fill(black_box(Vec3::ONE));
        }
    });
}
