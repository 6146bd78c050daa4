//! Order, energy, length, symmetry, threads.

use glam::Affine3A;

use super::*;
use crate::dynamics::pose::Poses;
use crate::dynamics::world::{Plan, World};
use crate::geometry::{Clip, clear::count_inside};

fn plan(step: f32, duration: f32, poses: &Poses) -> Plan<'_> {
    Plan { step, duration, poses, is_loop: false, is_settling: false, drag: 0.0, is_balanced: false, is_loose: false }
}

/// Free particles: a constant acceleration is integrated exactly, one in proportion to the distance to the second
/// order, with and without air.
#[test]
fn half_the_step_leaves_a_quarter_of_the_error() {
    let start = strands(1, 2, |_, k| Vec3::new(8.0 + k as f32, 3.0, 0.0));
    let poses = Poses::still();
    let fall = |forces: Vec<Arc<Force>>, drag: f32, step: f32, steps: usize| {
        let options = HairOptions { iterations: 0, hold: 0.0, ..options(forces) };
        let hair = Hair { strands: &start, options: &options, pinned: &[], body: None };
        let acting = options.acting();
        let plan = Plan { is_loose: true, drag, ..plan(step, 1.0, &poses) };
        let mut world = World::new(hair, plan, &acting).unwrap();
        world.advance(steps, &Task::new()).unwrap();
        world.packets[0].at.get(0, 0)
    };
    let exact = fall(vec![gravity()], 0.0, 0.01, 20);
    assert!(exact.distance(Vec3::new(8.0, 3.0 - 0.5 * EARTH * 0.04, 0.0)) < 1e-4, "{exact}");
    for drag in [0.0_f32, 3.0] {
        let (w, t) = (6.0_f32, 0.2);
        let centre = Vec3::ZERO;
        let to = |h: f32| fall(vec![attractor(centre, 0.0, 10.0 * w * w)], drag, h, (t / h).round() as usize);
        // x'' = -w^2 x - c x', from rest.
        let (c, v) = (0.5 * drag, (w * w - 0.25 * drag * drag).sqrt());
        let left = trig::exp(-c * t) * (trig::cos(v * t) + c / v * trig::sin(v * t));
        let error = |h: f32| to(h).distance(Vec3::new(8.0, 3.0, 0.0) * left);
        let (one, half) = (error(1.0 / 50.0), error(1.0 / 100.0));
        assert!(one > 1e-3 && (3.6..4.4).contains(&(one / half)), "drag {drag}: {one} and {half}");
    }
}

/// A rod on a hinge: also with the lengths kept the scheme is of second order.
#[test]
fn a_pendulum_is_of_second_order_too() {
    let start = level(1, 2, 12.0);
    let poses = Poses::still();
    let swing = |step: f32| {
        let options = HairOptions { clamped: false, hold: 0.0, iterations: 4, ..options(vec![gravity()]) };
        let hair = Hair { strands: &start, options: &options, pinned: &[], body: None };
        let acting = options.acting();
        let mut world = World::new(hair, plan(step, 1.0, &poses), &acting).unwrap();
        world.advance((0.3 / step).round() as usize, &Task::new()).unwrap();
        world.packets[0].at.get(1, 0)
    };
    let truth = swing(1.0 / 1600.0);
    let (one, half) = (swing(1.0 / 50.0).distance(truth), swing(1.0 / 100.0).distance(truth));
    assert!(one > 1e-3 && (3.3..4.8).contains(&(one / half)), "{one} and {half}");
}

/// Energy over mass, cm^2/s^2, of limp hair that falls without air.
fn energies(segments: usize, lengths: Lengths) -> Vec<f32> {
    let start = level(1, segments + 1, 24.0 / segments as f32);
    let (poses, step) = (Poses::still(), 1.0 / 480.0);
    let options = HairOptions { clamped: false, hold: 0.0, lengths, ..options(vec![gravity()]) };
    let hair = Hair { strands: &start, options: &options, pinned: &[], body: None };
    let acting = options.acting();
    let mut world = World::new(hair, plan(step, 20.0, &poses), &acting).unwrap();
    (0..9600)
        .map(|_| {
            let before: Vec<Vec3> = (0..=segments).map(|k| world.packets[0].velocity.get(k, 0)).collect();
            let places: Vec<Vec3> = (0..=segments).map(|k| world.packets[0].at.get(k, 0)).collect();
            world.advance(1, &Task::new()).unwrap();
            (1..=segments)
                .map(|k| {
                    // The velocity at the places is the mean of those half a step before and after.
                    let v = 0.5 * (before[k] + world.packets[0].velocity.get(k, 0));
                    0.5 * v.length_squared() + EARTH * places[k].y
                })
                .sum::<f32>()
                / segments as f32
        })
        .collect()
}

#[test]
fn energy_does_not_drift() {
    for lengths in [Lengths::Exact, Lengths::RootFree] {
        let e = energies(1, lengths);
        // The whole swing is worth g times 24 cm.
        let swing = EARTH * 24.0;
        let mean = |part: &[f32]| part.iter().sum::<f32>() / part.len() as f32;
        let (early, late) = (mean(&e[480..1440]), mean(&e[8640..9600]));
        assert!((late - early).abs() < 0.005 * swing, "{early} to {late} of {swing}");
        // Ten segments whip chaotically: what is asked for is that energy never rises above what there was.
        let e = energies(10, lengths);
        let most = e[2..].iter().copied().fold(f32::MIN, f32::max);
        assert!(most < 0.03 * swing, "{most} of {swing}");
    }
}

/// Whatever strands whip about in, no segment is ever farther from its length than this.
const STRETCH: f32 = crate::dynamics::length::LOOSE + 0.001;

#[test]
fn lengths_are_kept() {
    let start = level(16, 64, 0.7);
    let poses = Poses::still();
    for lengths in [Lengths::Exact, Lengths::RootFree] {
        let forces = vec![gravity(), wind(Vec3::new(-1.0, 0.3, 1.0), 2500.0, 1.0)];
        let options = HairOptions { lengths, ..options(forces) };
        let hair = Hair { strands: &start, options: &options, pinned: &[], body: None };
        let acting = options.acting();
        let mut world = World::new(hair, plan(1.0 / 240.0, 2.0, &poses), &acting).unwrap();
        let mut worst = 0.0_f32;
        for _ in 0..480 {
            world.advance(1, &Task::new()).unwrap();
            let mut now = start.clone();
            crate::dynamics::packet::unpack(&world.packets, &start.offsets, &mut now.points);
            worst = worst.max(stretch(&now, &start));
        }
        assert!(worst < STRETCH, "{lengths:?}: {worst}");
    }
    // Finished strands are exact.
    let out = settled(&start, &options(vec![gravity()]), None);
    assert!(out.rested.is_some() && stretch(&out.strands, &start) < 1e-4, "{}", stretch(&out.strands, &start));
}

#[test]
fn both_forms_settle_in_the_same_place() {
    let solid = ball(8.0, 24);
    let skin = Skin::new(&solid);
    let start = standing(40, 8.0, 33, 0.6);
    let forces = vec![gravity(), wind(Vec3::X, 300.0, 0.0)];
    let settle_as = |lengths, body| settled(&start, &HairOptions { lengths, ..options(forces.clone()) }, body).strands;
    for body in [None, Some(Body { solid: &solid, skin: &skin })] {
        let (one, other) = (settle_as(Lengths::Exact, body), settle_as(Lengths::RootFree, body));
        let far: Vec<f32> = (0..start.count()).map(|i| one.strand(i)[32].distance(other.strand(i)[32])).collect();
        // A strand that stands upright may fall to either side, and on the skin rest before or behind a bump.
        let mut sorted = far.clone();
        sorted.sort_by(f32::total_cmp);
        assert!(sorted[29] < 0.05 && sorted[34] < 0.2 && sorted[39] < 2.0, "{far:?}");
    }
}

#[test]
fn mirrored_hair_moves_as_in_a_mirror() {
    let key = Key::new(9, "mirror");
    let at = |sign: f32| {
        strands(12, 20, |i, k| {
            let d = (key.with(i).direction() + Vec3::Y).normalize();
            let p = Vec3::new(5.0, 0.0, 0.0) + d * (0.8 * k as f32) + Vec3::Z * trig::sin(k as f32 * 0.7);
            Vec3::new(sign * p.x, p.y, p.z)
        })
    };
    let forces = |sign: f32| {
        let vortex = VortexOptions {
            centre: Vec3::new(sign * 9.0, -4.0, 0.0),
            axis: Direction(Vec3::Y * sign),
            core: 1.0,
            strength: 600.0,
            fall_off: FallOff::Inverse,
        };
        vec![gravity(), Arc::new(Field::Vortex(vortex).into()), attractor(Vec3::new(sign * 3.0, -8.0, 1.0), 2.0, 500.0)]
    };
    let run = |sign: f32| {
        let (start, options) = (at(sign), options(forces(sign)));
        let hair = Hair { strands: &start, options: &options, pinned: &[], body: None };
        let sim = SimulateOptions { duration: Some(0.5), rate: Some(24.0), balanced: false, r#loop: None };
        simulate(&hair, &sim, None, &Task::new()).unwrap().value
    };
    let (left, right) = (run(1.0), run(-1.0));
    for (a, b) in left.frames.iter().zip(&right.frames) {
        for (p, q) in a.points.iter().zip(&b.points) {
            assert!(p.distance(Vec3::new(-q.x, q.y, q.z)) < 2e-3, "{p} {q}");
        }
    }
    assert!(apart(&left.frames[12], &left.frames[0]) > 3.0);
}

/// Turns by `angle` in half a second and stops.
pub fn turn(angle: f32) -> Clip<Affine3A> {
    let at = |i: usize| {
        let u = (i as f32 / 12.0).min(1.0);
        Arc::new(Affine3A::from_rotation_y(angle * u * u * (3.0 - 2.0 * u)))
    };
    Clip::new(24.0, (0..20).map(at).collect())
}

#[test]
fn nothing_comes_into_the_head() {
    let solid = ball(8.0, 24);
    let skin = Skin::new(&solid);
    let start = standing(120, 8.0, 24, 1.2);
    let forces = vec![gravity(), wind(Vec3::new(0.3, -0.2, 1.0), 1500.0, 1.0)];
    let body = Some(Body { solid: &solid, skin: &skin });
    for options in [
        options(forces.clone()),
        HairOptions { friction: 0.0, hold: 0.0, clamped: false, ..options(forces.clone()) },
        HairOptions { repulsion: 300.0, hold: 12.0, ..options(forces.clone()) },
    ] {
        let hair = Hair { strands: &start, options: &options, pinned: &[], body };
        let clip = simulate(
            &hair,
            &SimulateOptions { duration: None, rate: None, balanced: false, r#loop: None },
            Some(&turn(1.5)),
            &Task::new(),
        );
        let clip = clip.unwrap().value;
        assert_eq!(clip.count(), 20);
        for (frame, pose) in clip.frames.iter().zip(&turn(1.5).frames) {
            let seen = frame.transformed(&pose.inverse());
            assert_eq!(count_inside(&seen, &solid), 0);
            assert!(frame.validate().is_ok());
            for (i, w) in start.offsets.windows(2).enumerate() {
                let long = frame.length(i) / start.length(i);
                assert!(w[1] > w[0] && (0.9..1.1).contains(&long), "strand {i}: {long}");
            }
        }
        // Roots ride on the head.
        let root = clip.frames[19].points[0];
        assert!(root.distance(turn(1.5).frames[19].transform_point3(start.points[0])) < 1e-3);
    }
}

#[test]
fn threads_change_no_byte() {
    let solid = ball(8.0, 16);
    let skin = Skin::new(&solid);
    let start = standing(50, 8.0, 20, 0.9);
    let forces = vec![gravity(), wind(Vec3::X, 700.0, 1.0)];
    let options = HairOptions { repulsion: 200.0, ..options(forces) };
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let hair = Hair {
                strands: &start,
                options: &options,
                pinned: &[],
                body: Some(Body { solid: &solid, skin: &skin }),
            };
            let sim = SimulateOptions { duration: None, rate: None, balanced: true, r#loop: None };
            simulate(&hair, &sim, Some(&turn(1.0)), &Task::new()).unwrap().value
        })
    };
    let (one, two) = (run(1), run(2));
    for (a, b) in one.frames.iter().zip(&two.frames) {
        assert!(
            a.points
                .iter()
                .zip(&b.points)
                .all(|(p, q)| p.to_array().map(f32::to_bits) == q.to_array().map(f32::to_bits))
        );
    }
    // Nor does the company: a strand moves as it does alone, but for crowding.
    let alone = |count: u64| {
        let start = standing(count, 8.0, 20, 0.9);
        let options = HairOptions { repulsion: 0.0, ..options.clone() };
        settled(&start, &options, None).strands.strand(0).to_vec()
    };
    let (few, many) = (alone(1), alone(17));
    assert_eq!(few, many);
}
