//! Lattices, cages, pins and warps over a million vertices, beside copying the same bytes. `cargo bench --bench deform`.

use coif::deform::{Cage, Lattice, Pins, Warp};
use coif::geometry::Bounds;
use coif::math::rng::Key;
use coif::task::Task;
use divan::{Bencher, black_box, counter::ItemsCount};
use glam::Vec3;
use rayon::prelude::*;

const POINTS: usize = 1_000_000;

fn main() {
    divan::main();
}

fn points() -> Vec<Vec3> {
    let key = Key::new(1, "bench");
    (0..POINTS as u64).map(|i| key.with(i).direction() * key.with(i).unit() * 20.0).collect()
}

/// Every control point moved.
fn lattice(divisions: u32) -> Lattice {
    let bounds = Bounds { min: Vec3::splat(-21.0), max: Vec3::splat(21.0) };
    let lattice = Lattice::around(bounds, [divisions; 3]).expect("a box");
    let all: Vec<u32> = (0..lattice.count() as u32).collect();
    let key = Key::new(2, "bench");
    lattice.placed(&all, |i, p| p + key.with(u64::from(i)).gaussian3()).expect("free points")
}

fn bench_lattice(bencher: Bencher, divisions: u32) {
    let (points, lattice) = (points(), lattice(divisions));
    let mut out = points.clone();
    bencher.counter(ItemsCount::new(POINTS)).bench_local(|| {
        lattice.apply(black_box(&points), &mut out, &Task::new()).expect("not cancelled");
    });
}

/// As 5 x 5 x 5 is counted elsewhere: 125 control points.
#[divan::bench]
fn lattice_of_5_x_5_x_5_points(bencher: Bencher) {
    bench_lattice(bencher, 4);
}

/// As the paper counts: 5 x 5 x 5 divisions, 216 control points.
#[divan::bench]
fn lattice_of_5_x_5_x_5_divisions(bencher: Bencher) {
    bench_lattice(bencher, 5);
}

fn bench_pins(bencher: Bencher, power: f32, operated: usize) {
    let points = points();
    let key = Key::new(3, "bench");
    let fixed: Vec<Vec3> = (0..8).map(|i| key.with(i).direction() * 18.0).collect();
    let moved: Vec<(Vec3, Vec3)> = (0..operated as u64)
        .map(|i| (key.with(i + 50).direction() * 15.0, key.with(i + 90).direction() * 17.0))
        .collect();
    let pins = Pins::new(&fixed, &moved, power).expect("points apart");
    let mut out = points.clone();
    bencher.counter(ItemsCount::new(POINTS)).bench_local(|| {
        pins.apply(black_box(&points), &mut out, &Task::new()).expect("not cancelled");
    });
}

#[divan::bench]
fn pins_with_8_fixed_points(bencher: Bencher) {
    bench_pins(bencher, 2.0, 1);
}

#[divan::bench]
fn pins_with_8_fixed_and_3_operated_points(bencher: Bencher) {
    bench_pins(bencher, 2.0, 3);
}

#[divan::bench]
fn pins_with_8_fixed_points_and_exponent_2_5(bencher: Bencher) {
    bench_pins(bencher, 2.5, 1);
}

/// Scattered control points, all of them moved: mean-value coordinates of every vertex.
#[divan::bench(args = [12, 60], sample_count = 20)]
fn cage_of_scattered_points(bencher: Bencher, count: u64) {
    let points = points();
    let key = Key::new(6, "bench");
    let scattered = (0..count).map(|i| (None, key.with(i).direction() * 30.0)).collect();
    let cage = Cage::through(scattered).expect("points all around");
    let all: Vec<u32> = (0..cage.count() as u32).collect();
    let cage = cage.placed(&all, |i, p| p + key.with(u64::from(i) + 500).gaussian3()).expect("free points");
    let mut out = points.clone();
    bencher.counter(ItemsCount::new(POINTS)).bench_local(|| {
        cage.apply(black_box(&points), &mut out, &Task::new()).expect("not cancelled");
    });
}

#[divan::bench]
fn warp_of_60_pairs(bencher: Bencher) {
    let points = points();
    let key = Key::new(5, "bench");
    let pair =
        |i: u64| (key.with(i).direction() * 12.0, key.with(i).direction() * 12.0 + key.with(i + 500).gaussian3());
    let warp = Warp::new((0..60).map(pair).collect()).expect("places apart");
    let mut out = points.clone();
    bencher.counter(ItemsCount::new(POINTS)).bench_local(|| {
        warp.apply(black_box(&points), &mut out, &Task::new()).expect("not cancelled");
    });
}

/// The machine's limit: the same bytes read and written, on all threads.
#[divan::bench]
fn copy_of_the_same_bytes(bencher: Bencher) {
    let points = points();
    let mut out = points.clone();
    bencher.counter(ItemsCount::new(POINTS)).bench_local(|| {
        let from = black_box(&points);
        from.par_chunks(8192).zip(out.par_chunks_mut(8192)).for_each(|(a, b)| b.copy_from_slice(a));
    });
}
