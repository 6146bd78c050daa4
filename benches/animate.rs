//! The lock of Ren, Zhao, Geng 2010 along a path, beside bare solves of the same factored system. `cargo bench --bench animate`.

use coif::animate::{Rig, animate, animate_all};
use coif::geometry::Mesh;
use coif::task::Task;
use coif::tuft::{Detail, Section, Stroke, Tuft};
use divan::{Bencher, counter::ItemsCount};
use glam::{Quat, Vec3};

fn main() {
    divan::main();
}

/// 20 control points and 40 sides: 1,520 triangles. The lock hangs down and swings by `angle` (radians) at its tip.
fn lock(angle: f32, towards: Vec3) -> Mesh {
    let point = |k: i32| {
        let s = k as f32 / 19.0;
        let axis = towards.cross(Vec3::NEG_Y).normalize();
        Vec3::new(9.0, 2.0, 0.0) + Quat::from_axis_angle(axis, -angle * s) * Vec3::new(0.0, -25.0 * s, 0.0)
    };
    let stroke = Stroke::new((0..20).map(point).collect(), Vec3::ZERO, 1.0).expect("points apart");
    let mut tuft = Tuft::new(stroke, Section::round(4.0, 0.3)).expect("a plain section");
    tuft.detail = Detail::ControlPoints { sides: 40 };
    tuft.up = Some(Vec3::Z);
    tuft.mesh()
}

/// Three states and a path of 40 frames from side to side.
fn scene() -> (Rig, Vec<Vec3>) {
    let (rest, left, right) = (lock(0.0, Vec3::X), lock(1.0, Vec3::X), lock(1.2, Vec3::NEG_X + Vec3::Z));
    assert_eq!(rest.triangles.len(), 1520);
    let root = rest.positions.len() - 80;
    let rig = Rig::new(&rest, &[&left.positions, &right.positions], &[root as u32], &[root as u32 + 79]);
    let rig = rig.expect("a lock").value;
    let at = |state| rig.handle_at(0, state).expect("three states");
    let (from, middle, to) = (at(1), at(0), at(2));
    let path = (0..40).map(|f| {
        let t = f as f32 / 39.0;
        let (a, b) = (from.lerp(middle, t), middle.lerp(to, t));
        a.lerp(b, t)
    });
    let path = path.collect();
    (rig, path)
}

#[divan::bench]
fn forty_frames_of_1520_triangles_and_three_states(bencher: Bencher) {
    let (rig, path) = scene();
    let paths = [path];
    let made = animate(&rig, &paths, 24.0, false, &Task::new()).expect("it comes to rest").value;
    let all: u32 = made.posed.iter().map(|p| p.iterations).sum();
    eprintln!("iterations {all} for 40 frames, {} unknowns, {} in the factor", rig.unknowns(), rig.factor_entries());
    bencher.counter(ItemsCount::new(40_usize)).bench_local(|| animate(&rig, &paths, 24.0, false, &Task::new()));
}

/// The least a frame could be: the system solved once for three coordinates.
#[divan::bench]
fn a_bare_solve_for_three_coordinates(bencher: Bencher) {
    let (rig, _) = scene();
    let mut x = vec![[1.0; 12]; rig.unknowns()];
    bencher.counter(ItemsCount::new(1_usize)).bench_local(|| rig.bare_solve(&mut x));
}

#[divan::bench]
fn making_the_rig(bencher: Bencher) {
    bencher.bench_local(scene);
}

#[divan::bench(sample_count = 8)]
fn sixty_locks_of_forty_frames_on_all_cores(bencher: Bencher) {
    let all: Vec<(Rig, Vec<Vec<Vec3>>)> = (0..60).map(|_| scene()).map(|(rig, path)| (rig, vec![path])).collect();
    bencher.counter(ItemsCount::new(2400_usize)).bench_local(|| animate_all(&all, 24.0, false, &Task::new()));
}
