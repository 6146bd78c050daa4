//! Equations (5) to (8), intervals, and what they leave alone.

use super::*;
use crate::geometry::frames;
use crate::params::Angle;
use crate::task::Task;
use std::f32::consts::TAU;

pub fn curl(r#box: OrientedBox) -> Curl {
    Curl {
        r#box,
        period: 6.0,
        radius: 0.6,
        radius_tip: None,
        flatness: 1.0,
        turn: Turn::Right,
        smooth: 0.25,
        smooth_end: None,
        phase: Angle::degrees(0.0),
        phase_variation: 0.0,
        radius_variation: 0.0,
        priority: 0,
        noise: 0.0,
        name: None,
    }
}

fn wave(r#box: OrientedBox) -> Natural {
    Natural { shape: Shape::Helix { normal: 0.5, binormal: 0.0, tip: 1.0 }, ..Natural::from(&curl(r#box)) }
}

fn natural(domains: Vec<Natural>) -> NaturalQueue {
    NaturalQueue::new(domains.into_iter().map(|n| Arc::new(Domain::Natural(Arc::new(n)))).collect()).unwrap()
}

fn straight(length: f32, nodes: usize) -> Strands {
    let mut s = Strands::new();
    s.sources.push("test.lua:1".into());
    s.push(root(1, Vec3::ZERO, Vec3::Z), 0, (0..nodes).map(|i| Vec3::NEG_Y * (length * i as f32 / (nodes - 1) as f32)));
    s
}

fn deformed(strands: &Strands, queue: &NaturalQueue) -> Strands {
    let input = Deform { strands, queue, which: &[], solid: None, margin: 0.05, seed: 1 };
    let out = deform(&input, &Task::new()).unwrap().value;
    out.validate().unwrap();
    out
}

#[test]
fn figure_3_as_numbers() {
    let at = |s: f32| scale(s, 1.0, 100.0, 0.25);
    // The interval is 99 long, so it rises over 24.75 and falls over as much.
    for (s, expected) in [
        (1.0, 0.0),
        (1.0 + 0.25 * 24.75, 0.125),
        (13.375, 0.5),
        (1.0 + 0.75 * 24.75, 0.875),
        (25.75, 1.0),
        (50.5, 1.0),
        (75.25, 1.0),
        (87.625, 0.5),
        (100.0, 0.0),
        (0.0, 0.0),
        (101.0, 0.0),
    ] {
        assert!((at(s) - expected).abs() < 1e-5, "{s}: {}", at(s));
    }
    // Symmetric, and with a continuous slope: P is quadratic with slope at most 2 over 24.75.
    for k in 0..=990 {
        let s = 1.0 + 0.1 * k as f32;
        assert!((at(s) - at(101.0 - s)).abs() < 1e-4);
        assert!((at(s + 0.1) - at(s)).abs() <= 0.1 * 2.0 / 24.75 + 1e-5);
    }
    // A sigma of a half meets in the middle without a jump.
    assert!((scale(49.999, 0.0, 100.0, 0.5) - scale(50.001, 0.0, 100.0, 0.5)).abs() < 1e-4);
}

#[test]
fn equations_6_and_7_as_numbers() {
    assert_eq!((fade(0.0, 5.0), fade(-1.0, 5.0)), (0.0, 0.0));
    assert!((fade(5.0, 5.0) - 0.367_879).abs() < 1e-6 && (fade(50.0, 5.0) - 0.904_837).abs() < 1e-6);
    for (b, p) in [(-1.0, 0.0), (0.0, 0.0), (0.25, 0.125), (0.5, 0.5), (0.75, 0.875), (1.0, 1.0), (2.0, 1.0)] {
        assert_eq!(ramp(b), p);
    }
}

#[test]
fn figure_4_as_numbers() {
    // T 50, An = Ab = 0.1 over a whole strand of 200.
    let mut c = curl(everywhere());
    (c.period, c.radius) = (50.0, 0.1);
    let out = deformed(&straight(200.0, 401), &natural(vec![Natural::from(&c)]));
    let points = out.strand(0);
    assert_eq!(points.len(), 401);
    let n = frames::perpendicular(Vec3::Z, Vec3::NEG_Y);
    let b = Vec3::NEG_Y.cross(n);
    for (k, p) in points.iter().enumerate() {
        let s = 0.5 * k as f32;
        let size = 0.1 * scale(s, 0.0, 200.0, 0.25);
        let expected = Vec3::NEG_Y * s
            + n * (size * trig::sin(TAU * s / 50.0))
            + b * (size * fade(s, 50.0) * trig::cos(TAU * s / 50.0));
        assert_near(*p, expected, 1e-3);
    }
    assert_eq!(points[0], Vec3::ZERO);
}

#[test]
fn a_wave_is_plane_and_a_helix_is_round() {
    let out = deformed(&straight(60.0, 30), &natural(vec![wave(everywhere())]));
    assert!(out.strand(0).len() >= 120, "twelve nodes to each of ten periods");
    let furthest = out.points.iter().fold(0.0_f32, |a, p| a.max(p.z.abs()));
    assert!(out.points.iter().all(|p| p.x.abs() < 1e-5) && (furthest - 0.5).abs() < 0.02, "{furthest}");
    // Nodes of the unequal radii of fade apart, a curl winds about its axis; a conical one grows evenly.
    let mut c = curl(everywhere());
    (c.period, c.radius_tip, c.smooth_end) = (2.0, Some(1.8), Some(0.0));
    let out = deformed(&straight(60.0, 400), &natural(vec![Natural::from(&c)]));
    for p in out.points.iter().filter(|p| p.y < -20.0) {
        let radius = trig::hypot(p.x, p.z);
        let expected = 0.6 + 1.2 * (-p.y / 60.0);
        // The binormal's part still lacks fade(20) = 10 % at most.
        assert!(radius <= expected + 1e-3 && radius > 0.88 * expected, "{p}: {radius} against {expected}");
    }
}

#[test]
fn intervals_are_exact_and_follow_the_queue() {
    let slab = |lo: f32, hi: f32, priority| Natural { priority, ..wave(region([-5.0, -hi, -5.0], [5.0, -lo, 5.0])) };
    let axis: Vec<Vec3> = (0..=20).map(|i| Vec3::NEG_Y * i as f32).collect();
    let find = |domains| {
        let mut out = vec![];
        natural(domains).intervals(&axis, None, &mut out);
        out.iter().map(|i| (i.domain, i.s0, i.s1)).collect::<Vec<_>>()
    };
    assert_eq!(find(vec![slab(2.25, 7.5, 0)]), [(0, 2.25, 7.5)]);
    // Boxes that touch give intervals that touch, also within one segment.
    assert_eq!(
        find(vec![slab(7.5, 7.75, 1), slab(2.25, 7.5, 2), slab(7.75, 30.0, 0)]),
        [(1, 2.25, 7.5), (0, 7.5, 7.75), (2, 7.75, 20.0)]
    );
    // One whose stage comes when the strand is past it never acts.
    assert_eq!(find(vec![slab(2.0, 5.0, 0), slab(6.0, 9.0, 1)]), [(1, 6.0, 9.0)]);
    assert_eq!(find(vec![slab(25.0, 30.0, 0)]), []);
    // Left for ever: a bent axis that comes back does not act again.
    let bent: Vec<Vec3> = [0.0, 4.0, 8.0, 4.0, 0.0].iter().map(|&y| Vec3::new(0.0, -y, 0.0)).collect();
    let mut out = vec![];
    natural(vec![slab(2.0, 6.0, 0)]).intervals(&bent, None, &mut out);
    assert_eq!((out.len(), out[0].s0, out[0].s1), (1, 2.0, 6.0));
}

#[test]
fn only_the_part_inside_moves() {
    let strands = straight(40.0, 400);
    let out = deformed(&strands, &natural(vec![wave(region([-5.0, -30.0, -5.0], [5.0, -10.0, 5.0]))]));
    for (a, b) in strands.points.iter().zip(&out.points) {
        if a.y > -10.0 || a.y < -30.0 {
            assert_eq!(a, b);
        }
    }
    assert!(out.points.iter().any(|p| p.z.abs() > 0.45));
    // Strands that are not chosen stay to the bit.
    let queue = natural(vec![wave(everywhere())]);
    let input = Deform { strands: &strands, queue: &queue, which: &[false], solid: None, margin: 0.05, seed: 1 };
    assert_eq!(deform(&input, &Task::new()).unwrap().value.points, strands.points);
}

#[test]
fn custom_curves_follow_their_table() {
    let options = |over, period| Natural {
        shape: Shape::Table { offsets: vec![Vec2::ZERO, Vec2::new(1.0, 0.5), Vec2::ZERO].into(), over },
        period,
        ..wave(everywhere())
    };
    let n = options(Measure::Period, 4.0);
    // In the middle of the interval scale is 1: half of the table, a quarter, three quarters of a period.
    for (s, expected) in [(46.0, 1.0), (45.0, 0.5), (47.0, 0.5), (48.0, 0.0)] {
        assert!(n.offset(s, 0.0, 100.0, 0.0).distance(Vec2::new(1.0, 0.5) * expected) < 1e-4, "{s}");
    }
    assert!(options(Measure::Part, 1.0).offset(25.0, 0.0, 100.0, 0.0).distance(Vec2::new(0.5, 0.25)) < 1e-5);
    assert!(options(Measure::Length, 100.0).offset(75.0, 0.0, 200.0, 0.0).distance(Vec2::new(0.5, 0.25)) < 1e-5);
}

#[test]
fn mirrored_curls_mirror() {
    let mut s = Strands::new();
    s.sources.push("test.lua:1".into());
    for side in [1.0, -1.0] {
        let root = root(if side > 0.0 { 1 } else { 2 }, Vec3::X * side, Vec3::new(side, 0.5, 0.0).normalize());
        s.push(
            root,
            0,
            (0..80).map(|i| {
                let a = 0.03 * i as f32;
                Vec3::new(side * (1.0 + 8.0 * trig::sin(a)), -10.0 * (1.0 - trig::cos(a)), 2.0 * a)
            }),
        );
    }
    let mut c = curl(everywhere());
    c.turn = Turn::Mirrored;
    assert_mirrored(&deformed(&s, &natural(vec![Natural::from(&c)])), 1e-3);
    let tilted = Natural { tilt: 0.7, ..wave(everywhere()) };
    assert_mirrored(&deformed(&s, &natural(vec![tilted])), 1e-3);
}

#[test]
fn curls_keep_out_of_the_body_and_do_not_depend_on_threads() {
    let solid = spiky();
    let g = guides(roots_on(&solid, 120, 3), 20.0, 0.5, 2.0);
    let strands = grow(&input(&g, Some(&storm()), Some(&solid)), &Task::new()).unwrap().value;
    let mut c = curl(everywhere());
    (c.radius, c.period, c.noise, c.phase_variation, c.turn) = (1.5, 3.0, 0.2, 1.0, Turn::Random);
    let queue = natural(vec![Natural::from(&c)]);
    let run = |threads| {
        let input = Deform { strands: &strands, queue: &queue, which: &[], solid: Some(&solid), margin: 0.05, seed: 1 };
        in_pool(threads, || deform(&input, &Task::new()).unwrap())
    };
    let one = run(1);
    one.value.validate().unwrap();
    assert_eq!(count_inside(&one.value, &solid), 0);
    assert!(one.warnings.is_empty());
    assert!(one.value == run(4).value);
}

#[test]
fn natural_domains_out_of_reach_are_named() {
    let queue = natural(vec![wave(region([50.0; 3], [60.0; 3]))]);
    let strands = straight(10.0, 10);
    let input = Deform { strands: &strands, queue: &queue, which: &[], solid: None, margin: 0.05, seed: 1 };
    let warned = deform(&input, &Task::new()).unwrap();
    assert_eq!(warned.warnings.len(), 1);
    assert_eq!(warned.value.points, strands.points);
}
