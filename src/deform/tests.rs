//! Laws of deformation.

use std::sync::Arc;

use glam::{Affine3A, Mat3, Quat, Vec3};

use super::*;
use crate::geometry::bvh::tests::sphere;
use crate::geometry::slice::Side;
use crate::geometry::{Bounds, Mesh, Root, Strands};
use crate::math::rng::Key;
use crate::math::trig;
use crate::task::Task;

fn cloud(n: u64, low: Vec3, high: Vec3) -> Vec<Vec3> {
    let key = Key::new(11, "cloud");
    let at = |i: u64| Vec3::new(key.with(i).with(1).unit(), key.with(i).with(2).unit(), key.with(i).with(3).unit());
    (0..n).map(|i| low + (high - low) * at(i)).collect()
}

fn slanted() -> Lattice {
    let edges = [Vec3::new(4.0, 0.5, 0.0), Vec3::new(-0.3, 6.0, 0.4), Vec3::new(0.2, -0.5, 3.0)];
    Lattice::new(Vec3::new(-2.0, -3.0, -1.5), edges, [3, 4, 2]).unwrap()
}

/// Every control point shaken.
fn shaken(lattice: Lattice, by: f32) -> Lattice {
    let key = Key::new(4, "shaken");
    let points: Vec<u32> = (0..lattice.count() as u32).collect();
    lattice.placed(&points, |i, p| p + key.with(u64::from(i)).gaussian3() * by).unwrap()
}

fn run(by: &Deformer, points: &[Vec3]) -> Vec<Vec3> {
    super::points(points, std::slice::from_ref(by), &Task::new()).unwrap()
}

fn bits(points: &[Vec3]) -> Vec<[u32; 3]> {
    points.iter().map(|p| p.to_array().map(f32::to_bits)).collect()
}

/// Equation (5) as it is printed: the sum of places, not of displacements, in double precision.
fn printed(lattice: &Lattice, q: Vec3) -> Vec3 {
    let b = |i: usize, n: usize, s: f64| {
        let choose = (0..i).fold(1.0, |c, k| c * (n - k) as f64 / (k + 1) as f64);
        choose * s.powi(i as i32) * (1.0 - s).powi((n - i) as i32)
    };
    let (local, [l, m, n]) = (lattice.local(q).as_dvec3(), lattice.divisions());
    let weight = |[i, j, k]: [usize; 3]| b(i, l, local.x) * b(j, m, local.y) * b(k, n, local.z);
    (0..lattice.count())
        .map(|p| lattice.place(p).as_dvec3() * weight(lattice.indices(p)))
        .sum::<glam::DVec3>()
        .as_vec3()
}

#[test]
fn the_lattice_is_the_printed_sum() {
    let lattice = shaken(slanted(), 0.7);
    let points: Vec<Vec3> = cloud(400, Vec3::splat(-4.0), Vec3::splat(4.0));
    let inside: Vec<Vec3> = points.into_iter().filter(|&p| lattice.contains(p)).collect();
    assert!(inside.len() > 50);
    for (p, q) in inside.iter().zip(run(&Deformer::Lattice(Arc::new(lattice.clone())), &inside)) {
        assert!(q.distance(printed(&lattice, *p)) < 2e-5, "{p}");
    }
}

#[test]
fn the_basis_sums_to_one() {
    // All control points moved alike: every place inside moves by just that, whatever the divisions.
    for divisions in [[1, 1, 1], [2, 3, 4], [5, 5, 5], [32, 1, 7]] {
        let lattice = Lattice::around(Bounds { min: Vec3::ZERO, max: Vec3::ONE }, divisions).unwrap();
        let all: Vec<u32> = (0..lattice.count() as u32).collect();
        let lattice = lattice.moved(&all, &Move { by: Vec3::new(1.0, -2.0, 3.0), ..Move::default() }).unwrap();
        for p in cloud(100, Vec3::ZERO, Vec3::ONE) {
            assert!((lattice.at(p) - p).distance(Vec3::new(1.0, -2.0, 3.0)) < 1e-5, "{divisions:?} {p}");
        }
    }
}

#[test]
fn an_affine_motion_of_the_control_points_moves_everything_affinely() {
    let map = Affine3A::from_mat3_translation(
        Mat3::from_cols(Vec3::new(1.2, 0.3, 0.0), Vec3::new(-0.2, 0.7, 0.1), Vec3::new(0.4, 0.0, 1.5)),
        Vec3::new(3.0, -1.0, 0.5),
    );
    let lattice = slanted();
    let all: Vec<u32> = (0..lattice.count() as u32).collect();
    let lattice = lattice.placed(&all, |_, p| map.transform_point3(p)).unwrap();
    for p in cloud(300, Vec3::splat(-1.2), Vec3::splat(1.2)) {
        assert!(lattice.contains(p));
        assert!(lattice.at(p).distance(map.transform_point3(p)) < 1e-5, "{p}");
    }
}

#[test]
fn nothing_moved_is_identity_to_the_bit() {
    let mut points = cloud(500, Vec3::splat(-4.0), Vec3::splat(4.0));
    points.extend([Vec3::ZERO, Vec3::new(-0.0, 0.0, -0.0), Vec3::new(-0.0, 1.0, 0.5)]);
    let pins = Pins::new(&[Vec3::ZERO, Vec3::X], &[(Vec3::Y, Vec3::Y)], 2.0).unwrap();
    let held = slanted().holding(&[Vec3::ZERO], 2.0).unwrap();
    let warp = Warp::new([Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z].map(|p| (p, p)).to_vec()).unwrap();
    for by in [
        Deformer::Lattice(Arc::new(slanted())),
        Deformer::Lattice(Arc::new(held)),
        Deformer::Pins(Arc::new(pins)),
        Deformer::Warp(Arc::new(warp)),
    ] {
        assert_eq!(bits(&run(&by, &points)), bits(&points), "{by:?}");
    }
    // A control point moved and moved back.
    let there = slanted().moved(&[7], &Move { by: Vec3::X, ..Move::default() }).unwrap();
    let back = there.placed(&[7], |i, _| slanted().rest(i as usize)).unwrap();
    assert!(back.is_still());
}

#[test]
fn nothing_outside_moves() {
    let lattice = shaken(slanted(), 2.0);
    let points = cloud(3000, Vec3::splat(-9.0), Vec3::splat(9.0));
    let moved = run(&Deformer::Lattice(Arc::new(lattice.clone())), &points);
    let mut counts = [0, 0];
    for (p, q) in points.iter().zip(&moved) {
        let inside = lattice.contains(*p);
        counts[usize::from(inside)] += 1;
        assert!(inside || p == q);
    }
    assert!(counts[0] > 100 && counts[1] > 20, "{counts:?}");
    // Without the outer two layers moved, value and slope go on at the border.
    let lattice = Lattice::around(Bounds { min: Vec3::ZERO, max: Vec3::ONE }, [1, 6, 1]).unwrap();
    let middle = lattice.select(&Selection { ranges: [None, Some((2, 4)), None], group: None }).unwrap();
    let lattice = lattice.moved(&middle, &Move { by: Vec3::X, ..Move::default() }).unwrap();
    let near = lattice.at(Vec3::new(0.5, 1e-3, 0.5)).x - 0.5;
    assert!(near > 0.0 && near < 3e-5, "{near}");
}

#[test]
fn flat_inverted_and_endless_lattices_are_refused() {
    let new = |s, t, u| Lattice::new(Vec3::ZERO, [s, t, u], [1, 1, 1]);
    assert!(matches!(new(Vec3::X, Vec3::Y, Vec3::ZERO), Err(DeformError::Flat { .. })));
    assert!(matches!(new(Vec3::X, Vec3::Y, Vec3::X + Vec3::Y), Err(DeformError::Flat { .. })));
    assert!(matches!(new(Vec3::X, Vec3::Z, Vec3::Y), Err(DeformError::Inverted { .. })));
    assert!(matches!(new(Vec3::X, Vec3::NAN, Vec3::Y), Err(DeformError::NotFinite { .. })));
    assert!(new(Vec3::X * 1e-3, Vec3::Y * 1e-3, Vec3::Z * 1e-3).is_ok());
    let many = Lattice::new(Vec3::ZERO, [Vec3::X, Vec3::Y, Vec3::Z], [1, 33, 1]);
    assert!(matches!(many, Err(DeformError::OutOfRange { .. })));
    let zero = Lattice::new(Vec3::ZERO, [Vec3::X, Vec3::Y, Vec3::Z], [0, 3, 1]);
    assert!(matches!(zero, Err(DeformError::OutOfRange { .. })));
    let far = slanted().placed(&[0], |_, _| Vec3::splat(f32::INFINITY));
    assert!(matches!(far, Err(DeformError::NotFinite { .. })));
}

#[test]
fn selections_groups_and_kinds() {
    let lattice = slanted();
    let top = Selection { ranges: [None, Some((4, 4)), None], group: None };
    assert_eq!(lattice.select(&top).unwrap().len(), 4 * 3);
    assert_eq!(lattice.select(&Selection::default()).unwrap().len(), lattice.count());
    let past = Selection { ranges: [Some((0, 4)), None, None], group: None };
    assert_eq!(lattice.select(&past).unwrap_err(), DeformError::NoControlPoint { axis: 'i', index: 4, last: 3 });
    let points = lattice.select(&top).unwrap();
    let lattice = lattice.named("top", points.clone());
    let both = Selection { ranges: [Some((0, 0)), None, None], group: Some("top".into()) };
    assert_eq!(lattice.select(&both).unwrap().len(), 3);
    let error = lattice.select(&Selection { group: Some("tpo".into()), ..Selection::default() }).unwrap_err();
    assert_eq!(error.hint().as_deref(), Some("did you mean `top`?"));

    // A point may change kind between steps: fixed ones stay in a move of all, and move once they are free again.
    let all: Vec<u32> = (0..lattice.count() as u32).collect();
    let up = Move { by: Vec3::Y, ..Move::default() };
    let held = lattice.marked(&points, PointKind::Fixed).moved(&all, &up).unwrap();
    assert!(points.iter().all(|&i| held.place(i as usize) == held.rest(i as usize)));
    assert_eq!(held.place(0), held.rest(0) + Vec3::Y);
    assert_eq!(held.clone().moved(&points, &up).unwrap_err(), DeformError::AllFixed { count: 12 });
    let free = held.marked(&points, PointKind::Feature).moved(&points, &up).unwrap();
    assert_eq!(free.place(points[0] as usize), free.rest(points[0] as usize) + Vec3::Y);
}

#[test]
fn overall_points_follow_features_and_are_held_by_fixed_ones() {
    let lattice = Lattice::around(Bounds { min: Vec3::ZERO, max: Vec3::splat(4.0) }, [4, 4, 4]).unwrap();
    let face = |k: i64| Selection { ranges: [None, None, Some((k, k))], group: None };
    let (back, front) = (lattice.select(&face(0)).unwrap(), lattice.select(&face(4)).unwrap());
    let lattice = lattice.marked(&back, PointKind::Fixed).marked(&front[12..13], PointKind::Feature);
    let lattice =
        lattice.moved(&front[12..13], &Move { by: Vec3::Z, ..Move::default() }).unwrap().followed(2.0).unwrap();
    let went = |i: usize| (lattice.place(i) - lattice.rest(i)).length();
    assert!(back.iter().all(|&i| went(i as usize) == 0.0));
    assert_eq!(went(front[12] as usize), 1.0);
    let beside = went(front[11] as usize);
    assert!(beside > 0.2 && beside < 1.5, "{beside}");
}

#[test]
fn held_points_stay_and_what_is_near_them_moves_less() {
    let all: Vec<u32> = (0..slanted().count() as u32).collect();
    let free = slanted().moved(&all, &Move { by: Vec3::Z, ..Move::default() }).unwrap();
    let back = [Vec3::new(0.3, 0.2, -0.9), Vec3::new(-0.4, 1.0, -0.8)];
    let held = free.clone().holding(&back, 4.0).unwrap();
    for p in back {
        assert!(free.at(p) != p);
        assert_eq!(bits(&[held.at(p)]), bits(&[p]));
    }
    let went = |z: f32| (held.at(Vec3::new(0.3, 0.2, z)) - Vec3::new(0.3, 0.2, z)).z;
    assert!(went(-0.8) < went(-0.4) && went(-0.4) < went(0.4) && went(0.4) <= 1.0);
    assert!(went(-0.8) < 0.1, "{}", went(-0.8));
}

#[test]
fn lattices_nest_and_follow_each_other() {
    let (inner, outer) = (shaken(slanted(), 0.3), {
        let big = Lattice::around(Bounds { min: Vec3::splat(-9.0), max: Vec3::splat(9.0) }, [2, 2, 2]).unwrap();
        shaken(big, 1.0)
    });
    let points = cloud(200, Vec3::splat(-8.0), Vec3::splat(8.0));
    let by = [Deformer::Lattice(Arc::new(inner.clone())), Deformer::Lattice(Arc::new(outer.clone()))];
    let both = super::points(&points, &by, &Task::new()).unwrap();
    for (p, q) in points.iter().zip(&both) {
        assert_eq!(*q, outer.at(inner.at(*p)));
    }
}

fn pins(power: f32) -> Pins {
    let fixed = [Vec3::ZERO, Vec3::new(3.0, 0.0, 1.0), Vec3::new(-2.0, 1.0, 0.5), Vec3::new(0.5, -3.0, 0.0)];
    let moved = [
        (Vec3::new(0.0, 2.0, 2.0), Vec3::new(0.5, 2.5, 3.0)),
        (Vec3::new(1.0, -1.0, 2.0), Vec3::new(1.0, -1.5, 1.0)),
        (Vec3::new(-4.0, 0.0, 0.0), Vec3::new(-4.0, 0.1, 0.0)),
    ];
    Pins::new(&fixed, &moved, power).unwrap()
}

#[test]
fn fixed_points_stay_and_operated_points_land_exactly() {
    for power in [0.5, 1.0, 2.0, 2.7, 3.0, 4.0, 8.0] {
        let pins = pins(power);
        for pin in pins.points() {
            let lands = pin.to.unwrap_or(pin.at);
            assert_eq!(bits(&[pins.at(pin.at)]), bits(&[lands]), "{power} {pin:?}");
            // And the field is continuous there: it is not only the place itself that is treated so.
            let beside = pin.at + Vec3::new(1e-4, -1e-4, 1e-4);
            let slack = if power < 1.0 { 0.2 } else { 0.01 };
            assert!(pins.at(beside).distance(lands) < slack, "{power} {}", pins.at(beside).distance(lands));
        }
    }
}

#[test]
fn one_fixed_point_turns_and_scales_about_itself() {
    let (o, p, to) = (Vec3::new(1.0, 2.0, 3.0), Vec3::new(2.0, 2.0, 3.0), Vec3::new(1.0, 4.0, 3.0));
    let pins = Pins::new(&[o], &[(p, to)], 2.0).unwrap();
    let turn = Quat::from_rotation_z(std::f32::consts::FRAC_PI_2);
    for q in cloud(50, Vec3::splat(-5.0), Vec3::splat(5.0)) {
        assert!(pins.at(q).distance(o + turn * (q - o) * 2.0) < 1e-4);
    }
    // Half a turn has many axes; any will do, but the target is met.
    let half = Pins::new(&[Vec3::ZERO], &[(Vec3::Y, Vec3::NEG_Y * 2.0)], 2.0).unwrap();
    assert!(half.at(Vec3::Y * 1.001).distance(Vec3::NEG_Y * 2.002) < 1e-4);
}

#[test]
fn pins_of_one_operated_point_are_the_papers_mean() {
    let fixed = [Vec3::ZERO, Vec3::new(3.0, 0.0, 1.0), Vec3::new(-2.0, 1.0, 0.5)];
    let (p, to) = (Vec3::new(0.0, 2.0, 2.0), Vec3::new(0.5, 2.5, 3.0));
    let alone: Vec<Pins> = fixed.iter().map(|&o| Pins::new(&[o], &[(p, to)], 2.0).unwrap()).collect();
    let together = Pins::new(&fixed, &[(p, to)], 3.0).unwrap();
    for q in cloud(100, Vec3::splat(-5.0), Vec3::splat(5.0)) {
        let weights: Vec<f32> = fixed.iter().map(|o| q.distance(*o).recip().powi(3)).collect();
        let sum: f32 = weights.iter().sum();
        let mean: Vec3 = alone.iter().zip(&weights).map(|(one, w)| (one.at(q) - q) * (w / sum)).sum();
        assert!(together.at(q).distance(q + mean) < 1e-4);
    }
}

#[test]
fn wrong_pins_are_refused() {
    let (a, b) = (Vec3::ZERO, Vec3::X);
    assert_eq!(Pins::new(&[], &[(a, b)], 2.0).unwrap_err(), DeformError::Nothing { what: "fixed points" });
    assert!(matches!(Pins::new(&[a, a], &[], 2.0), Err(DeformError::SamePlace { .. })));
    assert!(matches!(Pins::new(&[a], &[(a, b)], 2.0), Err(DeformError::SamePlace { .. })));
    assert!(matches!(Pins::new(&[a], &[(b, a)], 2.0), Err(DeformError::OntoFixed { .. })));
    assert!(matches!(Pins::new(&[a], &[(b, Vec3::NAN)], 2.0), Err(DeformError::NotFinite { .. })));
    for power in [0.0, 9.0, f32::NAN] {
        assert!(matches!(Pins::new(&[a], &[], power), Err(DeformError::OutOfRange { .. })));
    }
}

#[test]
fn a_point_may_change_kind_between_steps() {
    let named = |name: &str, pin: Pin| Pin { name: Some(name.into()), ..pin };
    let first = Pins::of(
        vec![
            named("back", Pin::fixed(Vec3::NEG_Z)),
            named("front", Pin::operated(Vec3::Z, Vec3::Z * 1.5)),
            named("side", Pin { name: None, at: Vec3::X, to: None, kind: PointKind::Overall }),
        ],
        2.0,
    )
    .unwrap();
    let side = first.at(Vec3::X);
    assert!(side != Vec3::X, "it rides along");
    let second = first.settled().marked("front", PointKind::Fixed, None).unwrap();
    let second = second.marked("side", PointKind::Feature, Some(side + Vec3::X)).unwrap();
    assert_eq!(second.points()[1].at, Vec3::Z * 1.5);
    assert_eq!((second.at(Vec3::Z * 1.5), second.at(side)), (Vec3::Z * 1.5, side + Vec3::X));
    assert!(matches!(second.marked("sid", PointKind::Fixed, None), Err(DeformError::Unknown { .. })));
}

#[test]
fn mirrored_control_points_mirror_the_motion() {
    let flip = |p: Vec3| Vec3::new(-p.x, p.y, p.z);
    let points = cloud(300, Vec3::splat(-3.0), Vec3::splat(3.0));
    let flipped: Vec<Vec3> = points.iter().map(|&p| flip(p)).collect();

    let pins = pins(2.0);
    let mirrored = pins.points().iter().map(|p| Pin { at: flip(p.at), to: p.to.map(flip), ..p.clone() }).collect();
    let mirrored = Pins::of(mirrored, 2.0).unwrap();
    for (a, b) in run(&Deformer::Pins(Arc::new(pins)), &points)
        .into_iter()
        .zip(run(&Deformer::Pins(Arc::new(mirrored)), &flipped))
    {
        assert!(flip(a).distance(b) < 1e-5);
    }

    let box_of = || Lattice::around(Bounds { min: Vec3::splat(-2.5), max: Vec3::splat(2.5) }, [3, 3, 3]).unwrap();
    let lattice = shaken(box_of(), 0.4);
    let all: Vec<u32> = (0..lattice.count() as u32).collect();
    let mirrored = box_of()
        .placed(&all, |i, _| {
            let [a, b, c] = lattice.indices(i as usize);
            flip(lattice.place(lattice.index([3 - a, b, c])))
        })
        .unwrap();
    for (p, q) in points.iter().zip(&flipped) {
        assert!(flip(lattice.at(*p)).distance(mirrored.at(*q)) < 1e-5);
    }
    for verb in 0..3 {
        let (a, b) = (verb_of(verb, &points), verb_of(verb, &flipped));
        for (p, q) in points.iter().zip(&flipped) {
            assert!(flip(a.at(*p)).distance(b.at(*q)) < 1e-4, "verb {verb}");
        }
    }
}

fn verb_of(verb: usize, points: &[Vec3]) -> Lattice {
    let table = |fields: &[(&str, f64)]| crate::params::Table {
        items: vec![],
        fields: fields.iter().map(|(k, v)| ((*k).to_owned(), crate::params::Value::Number(*v))).collect(),
    };
    let lattice = match verb {
        0 => crate::params::read::<Bend>(&table(&[("angle", 60.0), ("from", 0.2)])).unwrap().lattice(points),
        1 => crate::params::read::<Taper>(&table(&[("width", 0.4)])).unwrap().lattice(points),
        _ => crate::params::read::<Lift>(&table(&[("by", 3.0)])).unwrap().lattice(points),
    };
    lattice.unwrap().unwrap()
}

#[test]
fn a_bend_keeps_lengths_and_turns_the_end_by_its_angle() {
    let line: Vec<Vec3> = (0..=100).map(|i| Vec3::new(0.0, -0.3 * i as f32, 0.0)).collect();
    let column: Vec<Vec3> = line.iter().flat_map(|&p| [p - Vec3::X, p + Vec3::X, p - Vec3::Z, p + Vec3::Z]).collect();
    let bend = verb_of(0, &column);
    let bent: Vec<Vec3> = line.iter().map(|&p| bend.at(p)).collect();
    let length = crate::geometry::curve::length(&bent);
    assert!((length - 30.0).abs() < 0.6, "{length}");
    let (first, last) = (bent[1] - bent[0], bent[100] - bent[99]);
    let angle = first.angle_between(last).to_degrees();
    assert!((angle - 60.0).abs() < 8.0, "{angle}");
    assert!(bent[100].z > 8.0 && bent[..20].iter().zip(&line).all(|(a, b)| a == b));
    let taper = verb_of(1, &column);
    let wide = taper.at(column[401]).distance(taper.at(column[400]));
    assert!((wide - 0.8).abs() < 0.1, "{wide}");
    let lift = verb_of(2, &column);
    assert!((lift.at(Vec3::ZERO).y - 3.0).abs() < 0.3 && lift.at(line[100]) == line[100]);
}

#[test]
fn a_warp_meets_its_pairs_and_affine_motions() {
    let key = Key::new(2, "warp");
    let places = cloud(30, Vec3::splat(-5.0), Vec3::splat(5.0));
    let pairs: Vec<(Vec3, Vec3)> =
        places.iter().enumerate().map(|(i, &p)| (p, p + key.with(i as u64).gaussian3())).collect();
    let warp = Warp::new(pairs.clone()).unwrap();
    assert!(pairs.iter().all(|&(a, b)| warp.at(a).distance(b) < 1e-4));
    let map = Affine3A::from_scale_rotation_translation(Vec3::new(1.1, 0.9, 1.3), Quat::from_rotation_x(0.4), Vec3::Y);
    let affine = Warp::new(places.iter().map(|&p| (p, map.transform_point3(p))).collect()).unwrap();
    for p in cloud(100, Vec3::splat(-40.0), Vec3::splat(40.0)) {
        assert!(affine.at(p).distance(map.transform_point3(p)) < 1e-3);
    }
    let flat: Vec<(Vec3, Vec3)> = places.iter().map(|p| (p.with_y(0.0), *p)).collect();
    assert!(matches!(Warp::new(flat), Err(DeformError::Degenerate { .. })));
    assert!(matches!(Warp::new(vec![]), Err(DeformError::Degenerate { count: 0 })));
}

#[test]
fn results_do_not_depend_on_how_points_are_divided() {
    let points = cloud(40_000, Vec3::splat(-3.0), Vec3::splat(3.0));
    let lattice = shaken(slanted(), 0.5).holding(&[Vec3::ONE], 2.5).unwrap();
    for by in [Deformer::Lattice(Arc::new(lattice)), Deformer::Pins(Arc::new(pins(2.0)))] {
        let whole = run(&by, &points);
        let one = |p: &Vec3| run(&by, std::slice::from_ref(p))[0];
        let single: Vec<Vec3> = points.iter().step_by(997).map(one).collect();
        let picked: Vec<Vec3> = whole.iter().step_by(997).copied().collect();
        assert_eq!(bits(&single), bits(&picked));
    }
}

#[test]
fn a_cancelled_task_stops() {
    let task = Task::new();
    task.cancel();
    let by = [Deformer::Lattice(Arc::new(shaken(slanted(), 0.5)))];
    assert!(matches!(super::points(&[Vec3::ZERO], &by, &task), Err(DeformError::Cancelled(_))));
}

fn hair() -> Strands {
    let mut strands = Strands { sources: vec!["test".into()], ..Strands::default() };
    for i in 0..5 {
        let at = Vec3::new(i as f32 - 2.0, 0.0, 0.0);
        let root = Root { id: i as u64, position: at, normal: Vec3::Y, uv: glam::Vec2::ZERO, triangle: 0 };
        strands.push(root, 0, (0..30).map(|k| at + Vec3::NEG_Y * (0.2 * k as f32)));
    }
    strands
}

#[test]
fn roots_are_held_and_the_motion_comes_in() {
    let strands = hair();
    let all = Lattice::around(Bounds { min: Vec3::splat(-8.0), max: Vec3::splat(8.0) }, [1, 1, 1]).unwrap();
    let all = all.moved(&(0..8).collect::<Vec<_>>(), &Move { by: Vec3::Z, ..Move::default() }).unwrap();
    let by = [Deformer::Lattice(Arc::new(all))];
    let held = super::strands(&strands, &by, &Hold { root: 2.0, which: &[] }, &Task::new()).unwrap();
    held.validate().unwrap();
    for i in 0..5 {
        assert_eq!((held.strand(i)[0], held.roots[i]), (strands.strand(i)[0], strands.roots[i]));
        assert!(held.strand(i).windows(2).all(|w| w[0].z <= w[1].z) && held.strand(i)[29].z == 1.0);
    }
    let which = [false, true, false, false, false];
    let one = super::strands(&strands, &by, &Hold { root: 0.0, which: &which }, &Task::new()).unwrap();
    assert_eq!((one.strand(0), one.strand(4)), (strands.strand(0), strands.strand(4)));
    assert_eq!(
        (one.roots[1].position, one.strand(1)[0]),
        (strands.roots[1].position + Vec3::Z, strands.strand(1)[0] + Vec3::Z)
    );
}

/// A tube around y with folds, from -40 to 40.
fn tube(radius: f32, folds: f32) -> Mesh {
    let (rings, sides) = (81, 64);
    let mut mesh = Mesh::default();
    for r in 0..rings {
        for s in 0..sides {
            let a = std::f32::consts::TAU * s as f32 / sides as f32;
            let wide = radius * (1.0 + folds * trig::cos(8.0 * a)) + 0.05 * (r as f32 - 40.0).abs();
            mesh.positions.push(Vec3::new(wide * trig::sin(a) * 1.2, r as f32 - 40.0, wide * trig::cos(a)));
        }
    }
    for r in 0..rings - 1 {
        for s in 0..sides {
            let at = |r: u32, s: u32| r * sides + s % sides;
            let (a, b, c, d) = (at(r, s), at(r, s + 1), at(r + 1, s + 1), at(r + 1, s));
            mesh.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    mesh.compute_normals();
    mesh
}

fn band(name: &str, height: f32, reach: f32) -> Band {
    Band { name: name.into(), height, low: height - reach, high: height + reach, side: Side::Middle, part: vec![] }
}

fn reading(mesh: &Mesh, band: &Band, measure: Measure) -> f32 {
    measure.of(&outline(mesh, band).unwrap())
}

#[test]
fn girths_are_solved_to_a_tenth_of_a_millimetre() {
    let tube = tube(9.0, 0.08);
    for measure in [Measure::Tape, Measure::Perimeter] {
        for girth in [40.0, 57.0, 67.0, 88.7, 120.0] {
            let waist = band("waist", 0.3, 12.0);
            let target = Target { band: waist.clone(), girth };
            let options = FitOptions { measure, ..FitOptions::default() };
            let fitted = fit(&tube, &[target], &options, &Task::new()).unwrap();
            let now = reading(&fitted.mesh, &waist, measure);
            assert!((now - girth).abs() <= 0.01 && (fitted.girths[0] - now).abs() < 1e-3, "{measure:?} {girth}: {now}");
            // Beyond the band all is as it was, normals too, and nothing moves up or down.
            for (v, (p, q)) in tube.positions.iter().zip(&fitted.mesh.positions).enumerate() {
                assert!(p.y == q.y && (p.y.abs() < 12.4 || p == q));
                assert!(p.y.abs() < 14.0 || fitted.mesh.normals[v] == tube.normals[v]);
            }
        }
    }
}

#[test]
fn several_girths_at_once_and_what_cannot_be() {
    let tube = tube(9.0, 0.0);
    let targets = [("bust", 18.0, 88.7), ("waist", 0.0, 57.0), ("hip", -20.0, 94.0)]
        .map(|(name, height, girth)| Target { band: band(name, height, 15.0), girth });
    let fitted = fit(&tube, &targets, &FitOptions::default(), &Task::new()).unwrap();
    for target in &targets {
        let now = reading(&fitted.mesh, &target.band, Measure::Tape);
        assert!((now - target.girth).abs() <= 0.01, "{} {now}", target.band.name);
    }
    let with = |girth, at: Band| fit(&tube, &[Target { band: at, girth }], &FitOptions::default(), &Task::new());
    for girth in [5.0, 900.0] {
        let Err(DeformError::OutOfReach { wanted, low, high, .. }) = with(girth, band("waist", 0.0, 10.0)) else {
            panic!("{girth} is out of reach")
        };
        assert!(wanted == girth && low > 5.0 && low < 62.0 && high < 900.0 && high > 62.0, "{low} {high}");
    }
    assert!(matches!(with(60.0, band("crown", 55.0, 10.0)), Err(DeformError::NoCut { .. })));
    // Two tapes at one place that want different things.
    let pull = [60.0, 70.0].map(|girth| Target { band: band("waist", 0.0, 10.0), girth });
    assert!(matches!(
        fit(&tube, &pull, &FitOptions::default(), &Task::new()),
        Err(DeformError::Contradiction { .. } | DeformError::OutOfReach { .. })
    ));
}

#[test]
fn the_back_is_held_while_the_girth_is_solved() {
    let tube = tube(9.0, 0.0);
    let waist = band("waist", 0.0, 12.0);
    let back: Vec<Vec3> = tube.positions.iter().copied().filter(|p| p.y.abs() < 8.0 && p.z < -8.8).collect();
    let options = FitOptions { held: back.clone(), power: 4.0, ..FitOptions::default() };
    let target = Target { band: waist.clone(), girth: 66.0 };
    let fitted = fit(&tube, &[target], &options, &Task::new()).unwrap();
    assert!((reading(&fitted.mesh, &waist, Measure::Tape) - 66.0).abs() <= 0.01);
    let mut front: f32 = 0.0;
    for (p, q) in tube.positions.iter().zip(&fitted.mesh.positions) {
        assert!(!back.contains(p) || p == q);
        front = front.max(if p.z > 8.0 { p.distance(*q) } else { 0.0 });
    }
    assert!(front > 0.4, "{front}");
}

#[test]
fn arms_beside_the_torso_are_left_alone() {
    let mut both = tube(9.0, 0.0);
    let body = both.positions.len();
    let arm = tube(3.0, 0.0);
    for side in [-1.0, 1.0] {
        let before = both.positions.len() as u32;
        both.positions.extend(arm.positions.iter().map(|p| Vec3::new(p.x + side * 26.0, p.y, p.z)));
        both.triangles.extend(arm.triangles.iter().map(|t| t.map(|v| v + before)));
    }
    both.compute_normals();
    let target = Target { band: band("waist", 0.0, 12.0), girth: 75.0 };
    let fitted = fit(&both, &[target], &FitOptions::default(), &Task::new()).unwrap();
    assert_eq!(fitted.mesh.positions[body..], both.positions[body..]);
    assert!((fitted.girths[0] - 75.0).abs() <= 0.01);
}

#[test]
fn seams_of_a_part_stay_closed() {
    // Upper and lower half with vertices of their own along the seam at y = 0.
    let whole = tube(9.0, 0.05);
    let mut mesh = Mesh::default();
    let mut part = vec![];
    for (t, corners) in whole.triangles.iter().enumerate() {
        let upper = whole.corners(t).iter().map(|p| p.y).sum::<f32>() > 0.0;
        if upper {
            part.push(mesh.triangles.len() as u32);
        }
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(corners.map(|v| whole.positions[v as usize]));
        mesh.triangles.push([first, first + 1, first + 2]);
    }
    let bust = Band { part, ..band("bust", 4.0, 10.0) };
    let fitted = fit(&mesh, &[Target { band: bust, girth: 80.0 }], &FitOptions::default(), &Task::new()).unwrap();
    let (before, after) = (mesh.weld(), fitted.mesh.weld());
    assert_eq!(before, after, "what was sewn together is sewn together still");
    let moved = |y: f32| {
        let of = mesh.positions.iter().zip(&fitted.mesh.positions).filter(|(p, _)| p.y == y);
        of.map(|(p, q)| p.distance(*q)).fold(0.0, f32::max)
    };
    assert!(moved(0.0) > 0.3 && moved(-3.0) > 0.05 && moved(-3.0) < moved(0.0) && moved(-9.0) == 0.0);
}

#[test]
fn normals_turn_with_the_surface_and_keep_their_bits_elsewhere() {
    let mut ball = sphere(24, 4.0);
    ball.compute_normals();
    let lattice =
        Lattice::around(Bounds { min: Vec3::new(-5.0, 0.0, -5.0), max: Vec3::splat(5.0) }, [2, 6, 2]).unwrap();
    let top = lattice.select(&Selection { ranges: [None, Some((3, 6)), None], group: None }).unwrap();
    let lattice = lattice.moved(&top, &Move { turn: Quat::from_rotation_z(0.5), ..Move::default() }).unwrap();
    let moved = super::mesh(&ball, &[Deformer::Lattice(Arc::new(lattice))], &Task::new()).unwrap();
    let mut fresh = moved.clone();
    fresh.compute_normals();
    for v in 0..ball.positions.len() {
        assert!(moved.normals[v].distance(fresh.normals[v]) < 1e-4 && moved.normals[v].is_normalized());
        assert!(ball.positions[v].y > -0.6 || moved.normals[v] == ball.normals[v]);
    }
}
