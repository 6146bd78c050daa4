//! What hair looks like: rest shapes, sag, force objects.

use super::*;
use crate::geometry::Clip;
use glam::Affine3A;

fn simulated(start: &Strands, options: &HairOptions, balanced: bool, seconds: f32) -> Clip<Strands> {
    let hair = Hair { strands: start, options, pinned: &[], body: None };
    let sim = SimulateOptions { duration: Some(seconds), rate: Some(24.0), balanced, r#loop: None };
    simulate(&hair, &sim, None, &Task::new()).unwrap().value
}

/// With no force every shape is at rest, whatever the hold.
#[test]
fn the_shape_at_rest_is_a_fixed_point() {
    let key = Key::new(4, "walks");
    let walk = strands(8, 30, |i, k| {
        let turn = |n: u64| (key.with(i).with(n).direction() * 0.5 + Vec3::X).normalize();
        (0..k as u64).map(|n| turn(n) * 0.5).sum::<Vec3>() + Vec3::Z * 3.0 * i as f32
    });
    for hold in [0.0, 1.0, 4.0, 15.0, 40.0] {
        for start in [&walk, &curl(60, 0.4, 0.8, 0.45), &level(3, 20, 0.7)] {
            let options = HairOptions { hold, ..options(vec![]) };
            let clip = simulated(start, &options, false, 1.0);
            let off = apart(&clip.frames[24], start);
            assert!(off < 2e-3, "hold {hold}: {off} cm");
        }
    }
}

/// A strand that sticks out level sags by a tenth of its length when that is what it holds: the beam's law. With few
/// nodes it is the law of so many masses on joints.
#[test]
fn a_strand_as_long_as_its_hold_sags_by_a_tenth() {
    for (hold, nodes) in [(4.0_f32, 9), (4.0, 33), (12.0, 25), (25.0, 41)] {
        let r = hold / (nodes - 1) as f32;
        let start = level(2, nodes, r);
        let options = HairOptions { hold, ..options(vec![gravity()]) };
        let out = settled(&start, &options, None);
        assert!(out.rested.is_some());
        let sag = -out.strands.strand(0)[nodes - 1].y / hold;
        // Joint j, from the clamped node 1 on, turns by the moment of all nodes beyond it over B / r.
        let turn =
            |j: usize| (j + 1..nodes).map(|k| EARTH * r * (k - j) as f32 * r).sum::<f32>() * r / options.stiffness();
        let expected = (1..nodes - 1).map(|j| turn(j) * (nodes - 1 - j) as f32 * r).sum::<f32>() / hold;
        assert!((sag / expected - 1.0).abs() < 0.06, "hold {hold}, {nodes} nodes: {sag} against {expected}");
        assert!((sag - 0.1).abs() < 0.013, "{sag}");
    }
}

#[test]
fn balanced_hair_stays_until_something_moves_it() {
    // A lock that leaves the head level, turns down and hangs, with a wave.
    let start = strands(1, 60, |_, k| {
        let s = k as f32 * 0.4;
        let bow = (s / 8.0).min(1.0) * std::f32::consts::FRAC_PI_2;
        let r = 8.0 / std::f32::consts::FRAC_PI_2;
        let down = (s - 8.0).max(0.0);
        Vec3::new(r * trig::sin(bow), r * (trig::cos(bow) - 1.0) - down, 0.3 * trig::sin(0.5 * s))
    });
    let options = HairOptions { hold: 8.0, ..options(vec![gravity()]) };
    let stays = apart(&simulated(&start, &options, true, 1.5).frames[36], &start);
    let falls = apart(&simulated(&start, &options, false, 1.5).frames[36], &start);
    assert!(stays < 0.5 && falls > 1.0 && falls > 4.0 * stays, "{stays} and {falls}");
    let blown = HairOptions { forces: Some(vec![gravity(), wind(Vec3::X, 800.0, 0.0)]), ..options };
    assert!(apart(&simulated(&start, &blown, true, 1.0).frames[24], &start) > 2.0);
}

#[test]
fn curls_survive_gravity_when_they_are_held() {
    let start = curl(80, 0.4, 0.9, 0.4);
    let drop = |hold: f32| {
        let out = settled(&start, &HairOptions { hold, ..options(vec![gravity()]) }, None).strands;
        let nodes = out.strand(0);
        nodes[0].y - nodes[79].y
    };
    let length = 0.4 * 79.0;
    let at_rest = start.points[0].y - start.points[79].y;
    let (limp, held) = (drop(0.0), drop(12.0));
    assert!(limp > 0.98 * length, "limp hair hangs straight: {limp} of {length}");
    assert!(held < at_rest + 0.35 * (length - at_rest), "{held}, {at_rest} at rest, {length} in all");
}

#[test]
fn hair_that_is_turned_as_a_whole_keeps_its_shape() {
    let start = curl(50, 0.4, 0.9, 0.4);
    let poses: Vec<_> = (0..49)
        .map(|i| Arc::new(Affine3A::from_rotation_z(0.5 * std::f32::consts::PI * (i as f32 / 36.0).min(1.0))))
        .collect();
    let options = HairOptions { hold: 6.0, drag: Some(12.0), ..options(vec![]) };
    let hair = Hair { strands: &start, options: &options, pinned: &[], body: None };
    let sim = SimulateOptions { duration: Some(3.0), rate: None, balanced: true, r#loop: None };
    let clip = simulate(&hair, &sim, Some(&Clip::new(24.0, poses)), &Task::new()).unwrap().value;
    let turned = start.transformed(&Affine3A::from_rotation_z(0.5 * std::f32::consts::PI));
    let last = clip.frames.last().unwrap();
    // What twist is left still runs out along the curl.
    assert!(apart(last, &turned) < 0.6, "{}", apart(last, &turned));
    // Half way it lagged behind.
    let half = start.transformed(&Affine3A::from_rotation_z(0.25 * std::f32::consts::PI));
    assert!(apart(&clip.frames[18], &half) > 0.5);
}

#[test]
fn an_attractor_ties_and_a_repeller_fluffs() {
    let start = strands(40, 30, |i, k| {
        let a = i as f32 * 0.157;
        Vec3::new(4.0 * trig::cos(a), -0.8 * k as f32, 4.0 * trig::sin(a))
    });
    let tie = Vec3::new(0.0, -12.0, 0.0);
    let wide = |s: &Strands, k: usize| {
        (0..s.count()).map(|i| trig::hypot(s.strand(i)[k].x, s.strand(i)[k].z)).sum::<f32>() / s.count() as f32
    };
    let tied = settled(&start, &options(vec![gravity(), attractor(tie, 1.0, 3000.0)]), None).strands;
    assert!(wide(&tied, 15) < 2.0 && wide(&start, 15) > 3.9, "{}", wide(&tied, 15));
    let repeller = RepellerOptions { centre: tie, core: 1.0, strength: 900.0, fall_off: FallOff::Inverse };
    let fluffed = settled(&start, &options(vec![gravity(), Arc::new(Field::Repeller(repeller).into())]), None).strands;
    assert!(wide(&fluffed, 15) > 6.0, "{}", wide(&fluffed, 15));
}

#[test]
fn a_vortex_turns_anticlockwise_and_a_zone_bounds_it() {
    let start = strands(8, 30, |i, k| {
        let a = i as f32 * 0.785;
        Vec3::new(6.0 * trig::cos(a), -0.6 * k as f32, 6.0 * trig::sin(a))
    });
    let field = |strength| {
        Field::Vortex(VortexOptions {
            centre: Vec3::ZERO,
            axis: Direction(Vec3::Y),
            core: 1.0,
            strength,
            fall_off: FallOff::Constant,
        })
    };
    let turned = |force: Force| {
        let out = settled(&start, &options(vec![gravity(), Arc::new(force)]), None).strands;
        // The swirl of the tips about the axis.
        (0..8)
            .map(|i| {
                let (a, b) = (start.strand(i)[29], out.strand(i)[29] - start.strand(i)[29]);
                a.cross(b).y
            })
            .sum::<f32>()
    };
    assert!(turned(field(900.0).into()) > 100.0);
    let above = Zone::Ball { centre: Vec3::Y * 30.0, radius: 10.0 };
    assert!(turned(Force { zone: Some(above), ..field(900.0).into() }).abs() < 1.0);
}

#[test]
fn crowded_hair_spreads() {
    let start = strands(60, 30, |i, k| {
        let key = Key::new(1, "bundle").with(i);
        Vec3::new(key.with(1).range(-0.6, 0.6), -0.6 * k as f32, key.with(2).range(-0.6, 0.6))
    });
    let wide = |repulsion: f32| {
        let out = settled(&start, &HairOptions { repulsion, ..options(vec![gravity()]) }, None).strands;
        (0..60).map(|i| trig::hypot(out.strand(i)[29].x, out.strand(i)[29].z)).sum::<f32>() / 60.0
    };
    let (bare, spread) = (wide(0.0), wide(400.0));
    assert!(spread > 2.0 * bare, "{bare} to {spread}");
}

#[test]
fn a_loop_comes_round() {
    let start = level(4, 20, 0.8);
    let options = options(vec![gravity(), wind(Vec3::X, 600.0, 1.0)]);
    let hair = Hair { strands: &start, options: &options, pinned: &[], body: None };
    let sim = SimulateOptions { duration: Some(1.5), rate: Some(24.0), balanced: false, r#loop: Some(true) };
    let clip = simulate(&hair, &sim, None, &Task::new()).unwrap().value;
    assert_eq!((clip.count(), clip.looped), (36, true));
    let ways: Vec<f32> = (0..36).map(|i| apart(&clip.frames[i], &clip.frames[(i + 1) % 36])).collect();
    let most = ways[..35].iter().copied().fold(0.0, f32::max);
    assert!(ways[35] <= 1.5 * most && most > 0.1, "{ways:?}");
    assert!(clip.frames.iter().all(|f| stretch(f, &start) < 1e-3));
}
