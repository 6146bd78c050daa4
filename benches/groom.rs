//! Growing, deforming and filling, beside the time of plainly storing the same bytes.
//!
//! The body is an egg of 20,000 triangles on a slab of shoulders, in the place and the size of a head.

use std::sync::{Arc, LazyLock};

use coif::geometry::{Mesh, OrientedBox, Root, Solid, Strands};
use coif::groom::*;
use coif::math::{rng::Key, trig};
use coif::params::{Angle, Direction};
use coif::task::Task;
use divan::{Bencher, black_box, counter::BytesCount};
use glam::{Vec2, Vec3};

fn main() {
    divan::main();
}

/// The head's half axes, cm.
const HEAD: Vec3 = Vec3::new(7.5, 11.5, 9.5);

fn egg(rings: usize) -> Mesh {
    let around = 2 * rings;
    let mut mesh = Mesh::default();
    for i in 0..=rings {
        for j in 0..around {
            let a = std::f32::consts::PI * i as f32 / rings as f32;
            let b = std::f32::consts::TAU * j as f32 / around as f32;
            let ring = if i == 0 || i == rings { 0.0 } else { trig::sin(a) };
            mesh.positions.push(Vec3::new(ring * trig::cos(b), trig::cos(a), ring * trig::sin(b)) * HEAD);
        }
    }
    for i in 0..rings {
        for j in 0..around {
            let at = |i: usize, j: usize| (i * around + j % around) as u32;
            if i > 0 {
                mesh.triangles.push([at(i, j), at(i, j + 1), at(i + 1, j)]);
            }
            if i + 1 < rings {
                mesh.triangles.push([at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)]);
            }
        }
    }
    mesh
}

static BODY: LazyLock<Solid> = LazyLock::new(|| {
    let solid = Solid::new(&egg(71)).expect("an egg has a volume");
    solid.clearance(Vec3::ZERO);
    solid
});

fn roots(count: u64, seed: u64) -> Vec<Root> {
    let key = Key::new(seed, "bench roots");
    (0..)
        .map(|i| (i, key.with(i).direction()))
        .filter(|(_, d)| d.y > 0.0 || d.z < -0.3)
        .take(count as usize)
        .map(|(id, d)| {
            let at = BODY.closest(d * HEAD * 1.2);
            Root { id, position: at.position, normal: at.normal, uv: Vec2::ZERO, triangle: at.triangle }
        })
        .collect()
}

fn queue() -> Queue {
    let above = OrientedBox::aligned(Vec3::new(0.0, 25.0, 0.0), Vec3::new(80.0, 60.0, 80.0));
    let below = OrientedBox::aligned(Vec3::new(0.0, -45.0, 0.0), Vec3::new(80.0, 80.0, 80.0));
    let down = |r#box, direction: Vec3, priority| {
        Arc::new(Domain::Directional(Directional {
            r#box,
            direction: Direction(direction.normalize()),
            strength: 1.0,
            priority,
            noise: 0.02,
            name: None,
        }))
    };
    Queue::new(vec![down(above, Vec3::new(0.0, -1.0, -0.4), 2), down(below, Vec3::NEG_Y, 1)]).expect("a good queue")
}

fn guides(count: u64, steps: f32) -> Guides {
    let options = GuideOptions {
        count: count as usize,
        length: 0.4 * steps,
        length_variation: 0.0,
        step: 0.4,
        stiffness: 3.0,
        limit: None,
        lay: None,
        lay_from: None,
        lay_amount: 0.7,
        noise: 0.0,
        seed: 1,
    };
    Guides { roots: roots(count, 1), options, source: "bench.lua:1".into() }
}

fn grown(guides: &Guides, queue: &Queue) -> Strands {
    let input = Grow { guides, global: Some(queue), locals: &[], local_of: &[], solid: Some(&BODY), margin: 0.05 };
    grow(&input, &Task::new()).expect("good guides").value
}

/// 1,000 guides, 200,000 growth steps.
#[divan::bench(args = [(800, 100), (1000, 200)])]
fn growth(bencher: Bencher, (count, steps): (u64, u32)) {
    let (guides, queue) = (guides(count, steps as f32), queue());
    bencher.bench_local(|| grown(black_box(&guides), &queue));
}

/// A curl of 6 cm on 800 guides.
#[divan::bench]
fn natural(bencher: Bencher) {
    let strands = grown(&guides(800, 100.0), &queue());
    let everywhere = OrientedBox::aligned(Vec3::ZERO, Vec3::splat(200.0));
    let curl = Curl {
        r#box: everywhere,
        period: 6.0,
        radius: 0.6,
        radius_tip: None,
        flatness: 1.0,
        turn: Turn::Mirrored,
        smooth: 0.25,
        smooth_end: None,
        phase: Angle::degrees(0.0),
        phase_variation: 0.1,
        radius_variation: 0.2,
        priority: 0,
        noise: 0.1,
        name: None,
    };
    let queue =
        NaturalQueue::new(vec![Arc::new(Domain::Natural(Arc::new(Natural::from(&curl))))]).expect("a good queue");
    let input = Deform { strands: &strands, queue: &queue, which: &[], solid: Some(&BODY), margin: 0.05, seed: 1 };
    bencher.bench_local(|| deform(black_box(&input), &Task::new()));
}

/// 800 guides to 40,000 members of 64 nodes: without a body, and kept out of one.
#[divan::bench(args = [false, true])]
fn members(bencher: Bencher, is_clear: bool) {
    let strands = grown(&guides(800, 100.0), &queue());
    let roots = roots(40_000, 2);
    let options = FillOptions {
        strands: roots.len(),
        nodes: Some(64),
        neighbours: 4,
        length_variation: 0.1,
        noise: 0.02,
        flyaway: 0.0,
        clump: 0.0,
        clump_start: 0.0,
        thickness: 0.4,
        margin: 0.03,
        seed: 1,
    };
    let source = "bench.lua:2".into();
    let solid = is_clear.then_some(&*BODY);
    let input = Fill { guides: &strands, roots: &roots, options: &options, separated: None, solid, source: &source };
    bencher.counter(BytesCount::of_many::<Vec3>(40_000 * 64)).bench_local(|| fill(black_box(&input), &Task::new()));
}

/// The machine's limit: storing the bytes of 40,000 strands of 64 nodes, on one thread, into fresh and into warm memory.
#[divan::bench(args = [false, true])]
fn plain_store(bencher: Bencher, is_warm: bool) {
    let bencher = bencher.counter(BytesCount::of_many::<Vec3>(40_000 * 64));
    let mut warm = vec![Vec3::ZERO; 40_000 * 64];
    if is_warm {
        bencher.bench_local(|| black_box(&mut warm).fill(black_box(Vec3::ONE)));
    } else {
        bencher.bench_local(|| vec![black_box(Vec3::ONE); 40_000 * 64]);
    }
}
