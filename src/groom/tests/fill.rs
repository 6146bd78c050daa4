//! Members: tangents, sides of partings, wisps, and the body.

use super::*;
use crate::geometry::curve;
use crate::task::{Task, Warned};

fn strands_from(roots: &[Root], nodes: usize, at: impl Fn(&Root, f32) -> Vec3) -> Strands {
    let mut s = Strands::new();
    s.sources.push("test.lua:1".into());
    for r in roots {
        s.push(*r, 0, (0..nodes).map(|i| at(r, i as f32 / (nodes - 1) as f32)));
    }
    s
}

/// Roots on a square of 10 cm in the plane y = 0.
fn square(count: u64, seed: u64) -> Vec<Root> {
    let key = Key::new(seed, "square");
    (0..count)
        .map(|i| {
            let k = key.with(i);
            root(i, Vec3::new(k.with(1).range(-5.0, 5.0), 0.0, k.with(2).range(-5.0, 5.0)), Vec3::Y)
        })
        .collect()
}

fn run(
    guides: &Strands,
    roots: &[Root],
    options: &FillOptions,
    separated: Option<&Separated>,
    solid: Option<&Solid>,
) -> Warned<Strands> {
    let source = "test.lua:2".into();
    let warned = fill(&Fill { guides, roots, options, separated, solid, source: &source }, &Task::new()).unwrap();
    warned.value.validate().unwrap();
    warned
}

fn plain(nodes: usize) -> FillOptions {
    FillOptions { noise: 0.0, flyaway: 0.0, clump: 0.0, thickness: 0.0, length_variation: 0.0, ..fill_options(nodes) }
}

#[test]
fn members_of_equal_guides_are_their_translates() {
    let shape = |u: f32| Vec3::new(3.0 * trig::sin(2.0 * u), 2.0 * u - 20.0 * u * u, u);
    let guides = strands_from(&square(30, 1), 40, |r, u| r.position + shape(u));
    let roots = square(200, 2);
    let out = run(&guides, &roots, &plain(40), None, None).value;
    let even = curve::resampled(guides.strand(0), 40);
    for (i, r) in roots.iter().enumerate() {
        for (k, p) in out.strand(i).iter().enumerate() {
            assert_near(*p, r.position + (even[k] - even[0]), 0.02);
        }
        assert!((out.length(i) - guides.length(0)).abs() < 0.05);
        // The guide named is the nearest.
        let nearest = (0..30).min_by(|&a, &b| {
            let d = |g: usize| guides.roots[g].position.distance(r.position);
            d(a).total_cmp(&d(b))
        });
        assert_eq!(Some(out.guide[i] as usize), nearest);
    }
    // A member on a guide's own root is that guide.
    let same = run(&guides, &guides.roots.clone(), &plain(40), None, None).value;
    for i in 0..30 {
        for (a, b) in same.strand(i).iter().zip(curve::resampled(guides.strand(i), 40)) {
            assert_near(*a, b, 0.02);
        }
    }
}

#[test]
fn members_do_not_cross_a_parting() {
    // Combed to both sides of the plane x = 0.
    let lean = |r: &Root, u: f32| {
        let side = if r.position.x < 0.0 { -1.0 } else { 1.0 };
        r.position + Vec3::new(side * 0.5, 0.8, 0.0) * (10.0 * u)
    };
    let guides = strands_from(&square(60, 1), 20, lean);
    let roots = square(1500, 2);
    let parted = |a: Vec3, b: Vec3| (a.x < 0.0) != (b.x < 0.0);
    let out = run(&guides, &roots, &fill_options(20), Some(&parted), None).value;
    for (i, r) in out.roots.iter().enumerate() {
        let guide = &guides.roots[out.guide[i] as usize];
        assert!(!parted(r.position, guide.position));
        let tip = *out.strand(i).last().unwrap();
        assert!(tip.x * r.position.x > 0.0 && (tip.x - r.position.x).abs() > 1.5, "{} to {tip}", r.position);
    }
    // A side without any guide stays bald, and a warning says so.
    let left = square(60, 1).into_iter().filter(|r| r.position.x < 0.0).collect::<Vec<_>>();
    let warned = run(&strands_from(&left, 20, lean), &roots, &fill_options(20), Some(&parted), None);
    assert!(warned.value.roots.iter().all(|r| r.position.x < 0.0));
    assert!(warned.warnings[0].message.ends_with("no guide grows on their side of the parting"));
}

#[test]
fn a_member_between_pigtails_follows_one_of_them() {
    // No parting is given: guides on the left run left and then down, those on the right the other way.
    let tail = |r: &Root, u: f32| {
        let side = if r.position.x < 0.0 { -1.0 } else { 1.0 };
        let out = (u * 3.0).min(1.0);
        r.position.lerp(Vec3::new(side * 9.0, 0.0, 0.0), out) + Vec3::NEG_Y * (20.0 * (u - 1.0 / 3.0).max(0.0))
    };
    let guides = strands_from(&square(80, 1), 30, tail);
    let out = run(&guides, &square(1000, 2), &plain(30), None, None).value;
    for strand in out.iter() {
        let tip = *strand.last().unwrap();
        assert!(tip.x.abs() > 6.0, "{tip}: half-way between");
    }
}

#[test]
fn clumps_gather_round_their_guides() {
    let guides = strands_from(&square(10, 1), 20, |r, u| r.position + Vec3::NEG_Y * (10.0 * u));
    let roots = square(400, 2);
    let spread = |clump: f32| {
        let options = FillOptions { clump, clump_start: 0.0, ..plain(20) };
        let out = run(&guides, &roots, &options, None, None).value;
        let far = (0..400).map(|i| out.strand(i)[19].distance(guides.strand(out.guide[i] as usize)[19]));
        far.sum::<f32>() / 400.0
    };
    let (loose, half, tight) = (spread(0.0), spread(0.5), spread(1.0));
    assert!((half / loose - 0.5).abs() < 0.02 && tight < 1e-3, "{loose} {half} {tight}");
}

#[test]
fn lengths_vary_and_the_layer_has_depth() {
    let guides = strands_from(&square(40, 1), 30, |r, u| {
        // Hanging over an edge: up, then out along z and down.
        r.position + Vec3::new(0.0, 4.0 * u - 14.0 * u * u, 6.0 * u)
    });
    let roots = square(600, 2);
    let options = FillOptions { length_variation: 0.4, ..plain(30) };
    let out = run(&guides, &roots, &options, None, None).value;
    let lengths: Vec<f32> = (0..600).map(|i| out.length(i) / guides.length(0)).collect();
    assert!(lengths.iter().all(|l| (0.59..1.01).contains(l)) && lengths.iter().any(|&l| l < 0.65));
    let flat = run(&guides, &roots, &plain(30), None, None).value;
    let thick = run(&guides, &roots, &FillOptions { thickness: 1.0, ..plain(30) }, None, None).value;
    let mut lift: Vec<f32> =
        (0..600).map(|i| (thick.strand(i)[25] - flat.strand(i)[25]).dot(Vec3::new(0.0, 0.4, 0.9))).collect();
    lift.sort_by(f32::total_cmp);
    // Evenly through the layer, and outward, never inward.
    assert!(
        lift[0] >= -0.01 && lift[60] < 0.25 && lift[540] > 0.7 && lift[599] <= 1.01,
        "{} {} {}",
        lift[0],
        lift[300],
        lift[599]
    );
}

#[test]
fn no_member_is_inside_an_awkward_body() {
    for (solid, name) in [(spiky(), "spikes"), (dumbbell(), "dumbbell")] {
        let g = guides(roots_on(&solid, 120, 3), 22.0, 0.5, 2.0);
        let guides = grow(&input(&g, Some(&storm()), Some(&solid)), &Task::new()).unwrap().value;
        let roots = roots_on(&solid, 2500, 8);
        // Few nodes make long segments, which cut corners.
        for nodes in [8, 48] {
            let mut options = fill_options(nodes);
            options.noise = 0.15;
            let out = run(&guides, &roots, &options, None, Some(&solid)).value;
            assert_eq!(count_inside(&out, &solid), 0, "{name} with {nodes} nodes");
            assert!(out.count() > 2470, "{name}: {} of 2500", out.count());
        }
    }
}

#[test]
fn same_bytes_on_any_number_of_threads_and_in_any_company() {
    let solid = dumbbell();
    let g = guides(roots_on(&solid, 80, 3), 15.0, 0.5, 2.0);
    let guides = grow(&input(&g, Some(&storm()), Some(&solid)), &Task::new()).unwrap().value;
    let roots = roots_on(&solid, 1000, 8);
    let options = fill_options(32);
    let with = |threads| in_pool(threads, || run(&guides, &roots, &options, None, Some(&solid)).value);
    let one = with(1);
    assert!(one == with(4));
    let few: Vec<Root> = roots.iter().filter(|r| r.id % 7 == 0).copied().collect();
    let some = run(&guides, &few, &options, None, Some(&solid)).value;
    for (i, r) in some.roots.iter().enumerate() {
        let j = one.roots.iter().position(|o| o.id == r.id).unwrap();
        assert_eq!(some.strand(i), one.strand(j));
    }
}

#[test]
fn absurd_fills_are_refused() {
    let guides = strands_from(&square(4, 1), 5, |r, u| r.position + Vec3::Y * u);
    let roots = square(3, 2);
    let source: Arc<str> = "test.lua:2".into();
    let go = |guides: &Strands, roots: &[Root], options: &FillOptions| {
        let input = Fill { guides, roots, options, separated: None, solid: None, source: &source };
        fill(&input, &Task::new()).map(|_| ()).unwrap_err().to_string()
    };
    assert_eq!(go(&Strands::new(), &roots, &plain(5)), "there are no guides");
    assert_eq!(go(&guides, &[], &plain(5)), "there are no roots");
    assert_eq!(go(&guides, &roots, &FillOptions { noise: f32::NAN, ..plain(5) }), "the noise is `NaN`");
    let many = plain(1_000_000_000);
    assert_eq!(
        go(&guides, &roots, &many),
        "`3000000000` nodes would take about 39.0 GB; at most 2000000000 are allowed"
    );
}
