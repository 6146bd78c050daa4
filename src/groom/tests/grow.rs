//! Algorithm 2: growing, lengths, collision.

use super::*;
use crate::geometry::curve;
use crate::task::Task;

fn grow_one(guides: &Guides, queue: &Queue) -> Vec<Vec3> {
    grow(&input(guides, Some(queue), None), &Task::new()).unwrap().value.points
}

#[test]
fn equations_1_to_3_as_numbers() {
    // Stiffness 1, force to x, first tangent y: the tangent halves its angle to x with each step.
    let g = guides(vec![root(1, Vec3::ZERO, Vec3::Y)], 4.0, 1.0, 1.0);
    let q = queue(&[directional(everywhere(), Vec3::X, 7.0, 0)]);
    let mut worker = vec![Vec3::ZERO];
    for k in 1..=4 {
        let a = std::f32::consts::FRAC_PI_2 / f32::from(1_u16 << k);
        worker.push(worker[k - 1] + Vec3::new(trig::cos(a), trig::sin(a), 0.0));
    }
    // The finished strand is resampled on the spline through those nodes, so both ends agree exactly.
    let points = grow_one(&g, &q);
    assert_eq!(points.len(), 5);
    assert_near(points[4], worker[4], 1e-5);
    for (p, w) in points.iter().zip(&worker) {
        assert_near(*p, *w, 0.05);
    }
    // A very stiff strand does not bend, one without stiffness follows the force at once.
    let g = guides(vec![root(1, Vec3::ZERO, Vec3::Y)], 4.0, 1.0, 1e6);
    assert_near(grow_one(&g, &q)[4], Vec3::Y * 4.0, 1e-4);
    let g = guides(vec![root(1, Vec3::ZERO, Vec3::Y)], 4.0, 1.0, 0.0);
    assert_near(grow_one(&g, &q)[4], Vec3::X * 4.0, 1e-5);
}

#[test]
fn opposite_forces_cancel_and_growth_is_straight() {
    let g = guides(vec![root(1, Vec3::ZERO, Vec3::Y)], 5.0, 0.5, 1.0);
    let q = queue(&[directional(everywhere(), Vec3::X, 1.0, 0), directional(everywhere(), Vec3::NEG_X, 1.0, 0)]);
    assert_near(grow_one(&g, &q)[10], Vec3::Y * 5.0, 1e-5);
}

#[test]
fn global_and_local_queues_have_equal_rank() {
    let g = guides(vec![root(1, Vec3::ZERO, Vec3::Y), root(2, Vec3::ZERO, Vec3::Y)], 3.0, 0.5, 0.0);
    let global = queue(&[directional(everywhere(), Vec3::X, 1.0, 0)]);
    let local = [Arc::new(queue(&[directional(everywhere(), Vec3::Z, 1.0, 9)]))];
    let all = Grow { locals: &local, local_of: &[Some(0), None], ..input(&g, Some(&global), None) };
    let strands = grow(&all, &Task::new()).unwrap().value;
    assert_near(strands.strand(0)[6], Vec3::new(1.0, 0.0, 1.0).normalize() * 3.0, 1e-4);
    assert_near(strands.strand(1)[6], Vec3::X * 3.0, 1e-4);
    // One global stage: the local one is number 2.
    assert_eq!((strands.stage[strands.range(0)][6], strands.stage[strands.range(1)][6]), (2, 1));
    // The same two domains in one queue give the same strand.
    let both = queue(&[directional(everywhere(), Vec3::X, 1.0, 0), directional(everywhere(), Vec3::Z, 1.0, 0)]);
    assert_near(grow_one(&g, &both)[6], strands.strand(0)[6], 1e-6);
}

#[test]
fn a_strand_ends_when_every_queue_is_finished() {
    // The box ends at y = 2: nodes at 0, .5, ... 2 are inside, the one at 2.5 empties the stage, and the step made in
    // that same round is the last.
    let g = guides(vec![root(1, Vec3::ZERO, Vec3::Y)], 50.0, 0.5, 1.0);
    let short = queue(&[directional(region([-1.0, -1.0, -1.0], [1.0, 2.1, 1.0]), Vec3::Y, 1.0, 0)]);
    let points = grow_one(&g, &short);
    assert_near(*points.last().unwrap(), Vec3::Y * 3.0, 1e-4);
    // The other queue still runs: growth goes on to the end of that.
    let long = [Arc::new(queue(&[directional(region([-1.0, -1.0, -1.0], [1.0, 7.1, 1.0]), Vec3::Y, 1.0, 0)]))];
    let all = Grow { locals: &long, local_of: &[Some(0)], ..input(&g, Some(&short), None) };
    let points = grow(&all, &Task::new()).unwrap().value.points;
    assert_near(*points.last().unwrap(), Vec3::Y * 8.0, 1e-4);
}

#[test]
fn lengths_are_met_exactly_and_limits_kept() {
    let roots: Vec<Root> = (0..50).map(|i| root(i, Vec3::X * i as f32, Vec3::Y)).collect();
    let q = queue(&[directional(everywhere(), Vec3::new(1.0, -1.0, 0.3), 1.0, 0)]);
    let mut g = guides(roots, 10.3, 0.5, 20.0);
    for (i, strand) in grow(&input(&g, Some(&q), None), &Task::new()).unwrap().value.iter().enumerate() {
        assert_eq!(strand.len(), 22, "21 steps, the last a part of one");
        assert!((curve::length(strand) - 10.3).abs() < 0.02, "{i}: {}", curve::length(strand));
    }
    g.options.length_variation = 0.5;
    let strands = grow(&input(&g, Some(&q), None), &Task::new()).unwrap().value;
    let lengths: Vec<f32> = (0..50).map(|i| strands.length(i)).collect();
    for (l, r) in lengths.iter().zip(&g.roots) {
        assert!((l - g.options.length_of(r)).abs() < 0.02);
        assert!((5.1..10.35).contains(l));
    }
    assert!(lengths.iter().any(|&l| l < 6.5) && lengths.iter().any(|&l| l > 9.0));
    g.options.limit = Some(4);
    for strand in grow(&input(&g, Some(&q), None), &Task::new()).unwrap().value.iter() {
        assert_eq!(strand.len(), 5);
    }
}

#[test]
fn lying_strands_leave_the_skin_along_it() {
    let mut g = guides(vec![root(1, Vec3::X, Vec3::Y)], 2.0, 0.5, 1.0);
    g.options.lay = Some(Direction(Vec3::new(0.0, -0.5, 0.8).normalize()));
    g.options.lay_amount = 1.0;
    assert_near(g.options.first_direction(&g.roots[0]), Vec3::Z, 1e-5);
    g.options.lay = None;
    g.options.lay_from = Some(Vec3::new(-3.0, 2.0, 0.0));
    assert_near(g.options.first_direction(&g.roots[0]), Vec3::X, 1e-5);
    g.options.lay_amount = 0.0;
    assert_near(g.options.first_direction(&g.roots[0]), Vec3::Y, 1e-5);
}

#[test]
fn strands_slide_along_the_skin_and_do_not_stall() {
    let ball = Solid::new(&sphere(40, 5.0)).unwrap();
    // Drawn straight down, from a little beside the pole: over the ball, along its side, and off below its middle.
    let roots: Vec<Root> = (0..60)
        .map(|i| {
            let a = 0.105 * i as f32;
            let n = Vec3::new(0.2 * trig::cos(a), 1.0, 0.2 * trig::sin(a)).normalize();
            let at = ball.closest(n * 6.0);
            root(i, at.position, n)
        })
        .collect();
    let g = guides(roots, 20.0, 0.4, 2.0);
    let q = queue(&[directional(everywhere(), Vec3::NEG_Y, 1.0, 0)]);
    let strands = grow(&input(&g, Some(&q), Some(&ball)), &Task::new()).unwrap().value;
    assert_eq!(count_inside(&strands, &ball), 0);
    for (i, strand) in strands.iter().enumerate() {
        let tip = *strand.last().unwrap();
        // 5 * 1.37 cm along the ball, then down: about 8 cm below its middle.
        assert!(tip.y < -6.0, "strand {i} stalled at {tip}");
        assert!((strands.length(i) - 20.0).abs() < 0.6, "{}", strands.length(i));
        for w in strand.windows(3).skip(1) {
            let (a, b) = ((w[1] - w[0]).normalize(), (w[2] - w[1]).normalize());
            assert!(a.dot(b) > 0.75, "a kink at {}", w[1]);
        }
    }
}

#[test]
fn nothing_ends_inside_awkward_bodies() {
    for (solid, name) in [(spiky(), "spikes"), (dumbbell(), "dumbbell")] {
        for step in [0.3, 1.5] {
            let g = guides(roots_on(&solid, 150, 7), 25.0, step, 2.0);
            let warned = grow(&input(&g, Some(&storm()), Some(&solid)), &Task::new()).unwrap();
            let strands = warned.value;
            strands.validate().unwrap();
            assert_eq!(count_inside(&strands, &solid), 0, "{name}, steps of {step}");
            assert!(strands.count() >= 149, "{name}: {} left", strands.count());
        }
    }
}

#[test]
fn mirrored_roots_and_domains_grow_mirrored_strands() {
    let ball = Solid::new(&sphere(32, 5.0)).unwrap();
    let key = Key::new(1, "mirror");
    let roots = (0..40)
        .flat_map(|i| {
            let d = key.with(i).direction();
            let at = d * 4.99;
            [root(2 * i, at, d), root(2 * i + 1, mirrored(at), mirrored(d))]
        })
        .collect();
    let g = guides(roots, 15.0, 0.5, 2.0);
    let side = |x: f32| {
        Arc::new(queue(&[gather(Vec3::new(7.0 * x, 0.0, -3.0), 1.0, Some((-0.5, Vec3::new(x, -1.0, 0.0))), 0)]))
    };
    let global = queue(&[directional(region([-20.0, -30.0, -20.0], [20.0, 3.0, 20.0]), Vec3::NEG_Y, 0.7, 0)]);
    let locals = [side(1.0), side(-1.0)];
    let local_of: Vec<Option<u16>> = g.roots.iter().map(|r| Some(u16::from(r.position.x < 0.0))).collect();
    let all = Grow { locals: &locals, local_of: &local_of, ..input(&g, Some(&global), Some(&ball)) };
    let strands = grow(&all, &Task::new()).unwrap().value;
    // The ball's triangles are not mirrored in all their diagonals.
    assert_mirrored(&strands, 0.35);
    let free = grow(&Grow { solid: None, ..all }, &Task::new()).unwrap().value;
    assert_mirrored(&free, 1e-4);
}

#[test]
fn same_bytes_on_any_number_of_threads() {
    let solid = spiky();
    let mut g = guides(roots_on(&solid, 300, 7), 20.0, 0.5, 2.0);
    g.options.noise = 0.1;
    g.options.length_variation = 0.3;
    let q = storm();
    let run = |threads| in_pool(threads, || grow(&input(&g, Some(&q), Some(&solid)), &Task::new()).unwrap().value);
    let one = run(1);
    assert!(one == run(4) && one == run(1));
    // A subset of the roots gives the same strands.
    let mut fewer = g.clone();
    fewer.roots.retain(|r| r.id % 3 == 0);
    let some = grow(&input(&fewer, Some(&q), Some(&solid)), &Task::new()).unwrap().value;
    for (i, r) in some.roots.iter().enumerate() {
        let j = one.roots.iter().position(|o| o.id == r.id).unwrap();
        assert_eq!(some.strand(i), one.strand(j));
    }
}

#[test]
fn domains_out_of_reach_are_named() {
    let g = guides(vec![root(1, Vec3::ZERO, Vec3::Y)], 5.0, 0.5, 1.0);
    let far = Directional {
        r#box: region([90.0; 3], [91.0; 3]),
        direction: Direction(Vec3::X),
        strength: 1.0,
        priority: 1,
        noise: 0.0,
        name: Some("fringe".into()),
    };
    let q = queue(&[Arc::new(Domain::Directional(far)), gather(Vec3::X, 0.5, None, 0)]);
    let warnings = grow(&input(&g, Some(&q), None), &Task::new()).unwrap().warnings;
    let texts: Vec<&str> = warnings.iter().map(|w| &*w.message).collect();
    assert_eq!(
        texts,
        [
            "no strand ever entered the directional domain `fringe` of the global queue",
            "no strand ever entered the gather domain 2 (in the order written) of the global queue",
        ]
    );
    assert!(warnings[0].hint.as_ref().unwrap().starts_with("strands come as near as 15"), "{:?}", warnings[0]);
}

#[test]
fn absurd_requests_are_refused_with_a_figure() {
    let one = vec![root(1, Vec3::ZERO, Vec3::Y)];
    let run = |g: &Guides| grow(&input(g, None, None), &Task::new()).map(|_| ()).unwrap_err().to_string();
    assert_eq!(run(&guides(vec![], 5.0, 0.5, 1.0)), "there are no roots");
    assert_eq!(run(&guides(one.clone(), 0.2, 0.5, 1.0)), "a step of `0.5` cm does not fit a length of `0.2` cm");
    assert_eq!(run(&guides(one.clone(), 5.0, f32::NAN, 1.0)), "a step of `NaN` cm does not fit a length of `5` cm");
    assert_eq!(run(&guides(one.clone(), 5.0, 0.5, f32::INFINITY)), "the stiffness is `inf`");
    assert_eq!(run(&guides(vec![root(7, Vec3::NAN, Vec3::Y)], 5.0, 0.5, 1.0)), "the root 0x0000000000000007 is `NaN`");
    let many = run(&guides(vec![one[0]; 3000], 1000.0, 1e-3, 1.0));
    assert_eq!(many, "`3000003000` nodes would take about 39.0 GB; at most 2000000000 are allowed");
}

#[test]
fn a_cancelled_task_stops() {
    let task = Task::new();
    task.cancel();
    let g = guides(vec![root(1, Vec3::ZERO, Vec3::Y)], 5.0, 0.5, 1.0);
    assert!(matches!(grow(&input(&g, None, None), &task), Err(GroomError::Cancelled(_))));
}
