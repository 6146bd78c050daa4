//! Laws of cages, and of what folds.

use std::sync::Arc;

use glam::{Affine3A, Mat3, Vec3};

use super::*;
use crate::geometry::bvh::tests::sphere;
use crate::geometry::{Bounds, Mesh};
use crate::math::rng::Key;
use crate::task::Task;

fn cloud(n: u64, low: Vec3, high: Vec3) -> Vec<Vec3> {
    let key = Key::new(21, "cloud");
    let at = |i: u64| Vec3::new(key.with(i).with(1).unit(), key.with(i).with(2).unit(), key.with(i).with(3).unit());
    (0..n).map(|i| low + (high - low) * at(i)).collect()
}

/// Control points scattered around, 4 to 7 away from the middle.
fn scattered(count: u64) -> Vec<(Option<String>, Vec3)> {
    let key = Key::new(9, "scattered");
    (0..count).map(|i| (None, key.with(i).direction() * (4.0 + 3.0 * key.with(i).with(1).unit()))).collect()
}

fn cube() -> Vec<Vec3> {
    (0..8).map(|i| Vec3::new(i as f32 % 2.0, (i / 2) as f32 % 2.0, (i / 4) as f32) * 8.0 - Vec3::splat(4.0)).collect()
}

/// One of every way to make a cage.
fn cages() -> Vec<Cage> {
    let places: Vec<Vec3> = cloud(500, Vec3::new(-3.0, -6.0, -2.0), Vec3::new(3.0, 4.0, 3.0));
    vec![
        Cage::through(scattered(40)).unwrap(),
        Cage::through(cube().into_iter().map(|p| (None, p)).collect()).unwrap(),
        Cage::around(&places, 2, 0.5).unwrap(),
        Cage::around(&places, 3, 0.0).unwrap(),
        Cage::of(&sphere(8, 5.0)).unwrap(),
    ]
}

fn all(cage: &Cage) -> Vec<u32> {
    (0..cage.count() as u32).collect()
}

fn shaken(cage: Cage, by: f32) -> Cage {
    let key = Key::new(4, "shaken");
    let points = all(&cage);
    cage.placed(&points, |i, p| p + key.with(u64::from(i)).gaussian3() * by).unwrap()
}

fn run(cage: &Cage, points: &[Vec3]) -> Vec<Vec3> {
    super::points(points, &[Deformer::Cage(Arc::new(cage.clone()))], &Task::new()).unwrap()
}

fn bits(points: &[Vec3]) -> Vec<[u32; 3]> {
    points.iter().map(|p| p.to_array().map(f32::to_bits)).collect()
}

fn inside(cage: &Cage) -> Vec<Vec3> {
    let places = cloud(3000, Vec3::splat(-6.0), Vec3::splat(6.0));
    let inside = cage.contains(&places);
    let places: Vec<Vec3> = places.into_iter().zip(inside).filter(|(_, inside)| *inside).map(|(p, _)| p).collect();
    assert!(places.len() > 150, "{}", places.len());
    places
}

#[test]
fn coordinates_sum_to_one_and_reproduce_affine_motions() {
    let map = Affine3A::from_mat3_translation(
        Mat3::from_cols(Vec3::new(1.2, 0.3, 0.0), Vec3::new(-0.2, 0.7, 0.1), Vec3::new(0.4, 0.0, 1.5)),
        Vec3::new(3.0, -1.0, 0.5),
    );
    for (k, cage) in cages().into_iter().enumerate() {
        let places = inside(&cage);
        let shift = Vec3::new(1.0, -2.0, 3.0);
        let shifted = cage.clone().moved(&all(&cage), &Move { by: shift, ..Move::default() }).unwrap();
        for (p, q) in places.iter().zip(run(&shifted, &places)) {
            assert!((*p + shift).distance(q) < 2e-6, "cage {k} {p}: {q}");
        }
        let mapped = cage.clone().placed(&all(&cage), |_, p| map.transform_point3(p)).unwrap();
        for (p, q) in places.iter().zip(run(&mapped, &places)) {
            assert!(map.transform_point3(*p).distance(q) < 1e-5, "cage {k} {p}: {q}");
        }
    }
}

#[test]
fn control_points_go_where_they_go_and_faces_with_them() {
    for cage in cages() {
        let moved = shaken(cage.clone(), 0.3);
        let rest: Vec<Vec3> = (0..cage.count()).map(|i| cage.rest(i)).collect();
        let places: Vec<Vec3> = (0..cage.count()).map(|i| moved.place(i)).collect();
        assert_eq!(bits(&run(&moved, &rest)), bits(&places));
        for ring in cage.faces().iter().filter(|r| r.len() == 3) {
            // On a triangle, and just inside of it, where the weights grow without end.
            let mean = |of: &dyn Fn(usize) -> Vec3| ring.iter().map(|&v| of(v as usize)).sum::<Vec3>() / 3.0;
            let (from, to) = (mean(&|v| cage.rest(v)), mean(&|v| moved.place(v)));
            for share in [1.0, 1.0 - 1e-6, 1.0 - 1e-5, 1.0 - 1e-4] {
                let p = from * share;
                if cage.contains(&[p])[0] {
                    assert!(moved.at(p).distance(to) < 1e-3, "{share} {p} {} {to}", moved.at(p));
                }
            }
        }
    }
}

#[test]
fn nothing_moved_is_identity_to_the_bit_and_nothing_outside_moves() {
    for cage in cages() {
        let mut places = cloud(2000, Vec3::splat(-12.0), Vec3::splat(12.0));
        places.extend([Vec3::new(-0.0, 0.0, -0.0), Vec3::new(-0.0, 1.0, 0.5)]);
        assert_eq!(bits(&run(&cage, &places)), bits(&places));
        let there = cage.clone().moved(&[2], &Move { by: Vec3::X, ..Move::default() }).unwrap();
        assert!(there.placed(&[2], |i, _| cage.rest(i as usize)).unwrap().is_still());
        let moved = run(&shaken(cage.clone(), 1.0), &places);
        let mut counts = [0, 0];
        for ((p, q), is_inside) in places.iter().zip(&moved).zip(cage.contains(&places)) {
            counts[usize::from(is_inside)] += 1;
            assert!(is_inside || p.to_array().map(f32::to_bits) == q.to_array().map(f32::to_bits), "{p} {q}");
            assert!(!is_inside || p != q || *p == Vec3::ZERO, "{p}");
        }
        assert!(counts[0] > 100 && counts[1] > 30, "{counts:?}");
    }
}

#[test]
fn inside_is_inside() {
    // Around a cube every point is on a face of four, which is flat.
    let cage = Cage::through(cube().into_iter().map(|p| (None, p)).collect()).unwrap();
    assert!(cage.faces().len() == 6 && cage.faces().iter().all(|f| f.len() == 4), "{:?}", cage.faces());
    let places = cloud(3000, Vec3::splat(-6.0), Vec3::splat(6.0));
    for (p, is_inside) in places.iter().zip(cage.contains(&places)) {
        assert_eq!(is_inside, p.abs().max_element() <= 4.0, "{p}");
    }
    // On corners, edges, faces, and in their planes beyond.
    let at = |x: f32, y: f32, z: f32| cage.contains(&[Vec3::new(x, y, z)])[0];
    assert!(at(4.0, 4.0, 4.0) && at(4.0, 4.0, 1.0) && at(4.0, 0.3, 1.0) && at(-4.0, 0.0, 0.0) && at(4.0, 2.0, 2.0));
    assert!(!at(4.0, 5.0, 1.0) && !at(4.0, 4.0, 7.0) && !at(4.1, 4.0, 4.0));
}

#[test]
fn a_cage_around_points_encloses_them_closely() {
    let key = Key::new(3, "around");
    // A drop: wide below, thin above.
    let drop: Vec<Vec3> = (0..2000)
        .map(|i| {
            let d = key.with(i).direction();
            Vec3::new(d.x * (6.0 - 2.5 * d.y), 20.0 * d.y, d.z * (4.0 - 1.5 * d.y))
        })
        .collect();
    for (divisions, margin) in [(1, 0.5), (2, 0.5), (3, 0.0), (5, 1.0), (8, 0.2)] {
        let cage = Cage::around(&drop, divisions, margin).unwrap();
        assert!(cage.contains(&drop).into_iter().all(|inside| inside), "{divisions}");
        let bounds = Bounds::of((0..cage.count()).map(|i| cage.rest(i)));
        let most = Bounds::of(drop.iter().copied()).size() * 1.8 + Vec3::splat(4.0 * margin);
        assert!(bounds.size().cmple(most).all(), "{divisions} {bounds:?}");
    }
    // Flat things and single points have cages too.
    for places in [vec![Vec3::ONE], drop.iter().map(|p| p.with_z(0.0)).collect()] {
        let cage = Cage::around(&places, 2, 0.5).unwrap();
        assert!(cage.contains(&places).into_iter().all(|inside| inside));
    }
}

#[test]
fn mirrored_control_points_mirror_the_motion() {
    let flip = |p: Vec3| Vec3::new(-p.x, p.y, p.z);
    let places = cloud(500, Vec3::splat(-3.0), Vec3::splat(3.0));
    let flipped: Vec<Vec3> = places.iter().map(|&p| flip(p)).collect();
    // The second has faces of four corners, which have two ways to be cut in triangles.
    for points in [scattered(30), cube().into_iter().map(|p| (None, p)).collect()] {
        let mirrored = points.iter().map(|(n, p)| (n.clone(), flip(*p))).collect();
        let (one, other) = (Cage::through(points).unwrap(), Cage::through(mirrored).unwrap());
        let one = shaken(one, 0.5);
        let other = other.placed(&all(&one), |i, _| flip(one.place(i as usize))).unwrap();
        for (a, b) in run(&one, &places).into_iter().zip(run(&other, &flipped)) {
            assert!(flip(a).distance(b) < 1e-5, "{a} {b}");
        }
    }
    // A mirrored thing has the mirrored cage around it.
    let thing = cloud(400, Vec3::new(-1.0, -5.0, -2.0), Vec3::new(6.0, 3.0, 2.0));
    let cage = Cage::around(&thing, 3, 0.5).unwrap();
    let mirror = Cage::around(&thing.iter().map(|&p| flip(p)).collect::<Vec<_>>(), 3, 0.5).unwrap();
    for i in 0..cage.count() {
        let p = flip(cage.rest(i));
        assert!((0..mirror.count()).any(|k| mirror.rest(k).distance(p) < 1e-4), "{p}");
    }
}

#[test]
fn the_motion_is_smooth_inside() {
    let cage = Cage::through(scattered(40)).unwrap();
    let cage = cage.moved(&[5], &Move { by: Vec3::Y * 3.0, ..Move::default() }).unwrap();
    // Along a line through the inside, also across the planes of triangles, slopes change little from step to step.
    let line: Vec<Vec3> = (0..=4000).map(|i| Vec3::new(-2.0 + 0.001 * i as f32, 0.31, -0.2)).collect();
    let by: Vec<f32> = run(&cage, &line).iter().zip(&line).map(|(q, p)| q.y - p.y).collect();
    assert!(by.iter().all(|b| b.is_finite() && *b > 0.0 && *b < 3.0));
    for w in by.windows(21) {
        let bend = (w[20] - w[10]) - (w[10] - w[0]);
        assert!(bend.abs() < 1e-4, "{bend}");
    }
}

#[test]
fn results_do_not_depend_on_threads_or_how_points_are_divided() {
    let cage = shaken(Cage::through(scattered(40)).unwrap(), 0.5).holding(&[Vec3::ONE], 2.5).unwrap();
    let places = cloud(20_000, Vec3::splat(-6.0), Vec3::splat(6.0));
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| run(&cage, &places))
    };
    let one = with(1);
    assert_eq!(bits(&one), bits(&with(2)));
    let single: Vec<Vec3> = places.iter().step_by(997).map(|&p| cage.at(p)).collect();
    let picked: Vec<Vec3> = one.iter().step_by(997).copied().collect();
    assert_eq!(bits(&single), bits(&picked));
}

#[test]
fn held_points_kinds_and_steps() {
    let cage = Cage::through(scattered(30)).unwrap();
    let up = Move { by: Vec3::Y, ..Move::default() };
    let held = Vec3::new(0.5, 0.2, -1.0);
    let moved = cage.clone().moved(&all(&cage), &up).unwrap();
    let with = moved.clone().holding(&[held], 4.0).unwrap();
    assert_eq!((with.at(held), moved.at(held) - held), (held, Vec3::Y));
    let near = (with.at(held + Vec3::X * 0.3) - held).y;
    assert!(near > 0.0 && near < 0.9, "{near}");
    // Fixed control points stay, overall ones follow.
    let marked = cage.clone().marked(&[0, 1, 2], PointKind::Fixed).marked(&[3], PointKind::Feature);
    assert_eq!(marked.clone().moved(&[0, 1], &up).unwrap_err(), DeformError::AllFixed { count: 2 });
    let followed = marked.moved(&[0, 3], &up).unwrap().followed(2.0).unwrap();
    let went = |i: usize| (followed.place(i) - followed.rest(i)).length();
    assert_eq!((went(0), went(1), went(3)), (0.0, 0.0, 1.0));
    assert!(went(7) > 0.0);
}

#[test]
fn what_is_no_cage_is_refused() {
    let through = |points: Vec<Vec3>| Cage::through(points.into_iter().map(|p| (None, p)).collect()).unwrap_err();
    let corner = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
    assert!(matches!(through(corner), DeformError::NotAround { .. }));
    assert!(matches!(through(cube()[..4].to_vec()), DeformError::NotAround { .. }), "flat");
    assert!(matches!(through(cube()[..3].to_vec()), DeformError::OutOfRange { .. }));
    let with = |p: Vec3| through([cube(), vec![p]].concat());
    assert!(matches!(with(Vec3::ZERO), DeformError::InTheMiddle { .. }));
    assert!(matches!(with(Vec3::splat(2.0)), DeformError::SameDirection { .. }));
    assert!(matches!(with(Vec3::NAN), DeformError::NotFinite { .. }));
    let twice = cube().into_iter().map(|p| (Some("corner".to_owned()), p)).collect();
    assert!(matches!(Cage::through(twice), Err(DeformError::SameName { .. })));
    assert!(matches!(Cage::around(&[], 2, 1.0), Err(DeformError::Nothing { .. })));
    assert!(matches!(Cage::around(&cube(), 9, 1.0), Err(DeformError::OutOfRange { .. })));

    let ball = sphere(8, 5.0);
    let of = |change: &dyn Fn(&mut Mesh)| {
        let mut mesh = ball.clone();
        change(&mut mesh);
        Cage::of(&mesh)
    };
    assert!(matches!(of(&|m| m.triangles.truncate(m.triangles.len() - 1)), Err(DeformError::Open { count: 1, .. })));
    assert!(matches!(of(&|m| m.triangles.push(m.triangles[3])), Err(DeformError::Open { count: 3, .. })));
    assert!(matches!(of(&|m| m.triangles[9].swap(0, 1)), Err(DeformError::WrongWay { .. })));
    let squeeze = |m: &mut Mesh| {
        let [a, b, c] = m.triangles[20].map(|v| v as usize);
        m.positions[c] = 0.5 * (m.positions[a] + m.positions[b]);
    };
    assert!(matches!(of(&squeeze), Err(DeformError::NoArea { .. })));
    assert!(matches!(Cage::of(&sphere(40, 5.0)), Err(DeformError::OutOfRange { .. })));
    // All of it inside out is the same cage.
    let turned = of(&|m| m.triangles.iter_mut().for_each(|t| t.swap(0, 1))).unwrap();
    assert!(turned.contains(&[Vec3::ZERO])[0]);
}

#[test]
fn folds_are_found_where_they_are() {
    let cage = Cage::around(&cube(), 2, 1.0).unwrap();
    assert_eq!(shaken(cage.clone(), 0.1).folded(), None);
    let turn = Move { turn: glam::Quat::from_rotation_x(2.5), scale: Vec3::new(0.2, 3.0, 1.0), ..Move::default() };
    assert_eq!(cage.clone().moved(&all(&cage), &turn).unwrap().folded(), None, "all of it together");
    let top = all(&cage).into_iter().filter(|&i| cage.rest(i as usize).y > 3.0).collect::<Vec<_>>();
    let through = cage.clone().moved(&top, &Move { by: Vec3::Y * -14.0, ..Move::default() }).unwrap();
    assert!(through.folded().is_some());

    let lattice = Lattice::around(Bounds { min: Vec3::ZERO, max: Vec3::splat(4.0) }, [4, 4, 4]).unwrap();
    let points: Vec<u32> = (0..lattice.count() as u32).collect();
    let whole = lattice.clone().moved(&points, &turn).unwrap();
    assert_eq!(whole.folded(), None);
    let little = lattice.clone().moved(&[62], &Move { by: Vec3::X * 0.9, ..Move::default() }).unwrap();
    assert_eq!(little.folded(), None);
    // The corner 4, 4, 4 is pushed through the opposite one.
    let corner = lattice.index([4, 4, 4]) as u32;
    let far = lattice.moved(&[corner], &Move { by: Vec3::splat(-9.0), ..Move::default() }).unwrap();
    let folded = far.folded().unwrap();
    assert_eq!((folded.points[0].as_str(), folded.place), ("control point 4, 4, 4", Vec3::splat(4.0)));
}

#[test]
fn what_is_torn_from_the_inside_is_counted() {
    let cage = Cage::around(&cube(), 1, 0.5).unwrap();
    let outside: Vec<Vec3> = (0..10).map(|i| Vec3::new(0.1 * i as f32, 0.0, 5.5)).collect();
    let up = cage.clone().moved(&all(&cage), &Move { by: Vec3::Y * 3.0, ..Move::default() }).unwrap();
    assert_eq!((cage.left_behind(&outside), up.left_behind(&outside)), (0, 10));
    assert_eq!(up.left_behind(&outside.iter().map(|p| *p * 4.0).collect::<Vec<_>>()), 0, "far away");
    assert_eq!(up.left_behind(&cube()), 0, "inside");
}
