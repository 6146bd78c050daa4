//! Bad input, and settings at their limits.

use super::*;
use crate::geometry::Clip;
use glam::Affine3A;

fn refused(start: &Strands, options: &HairOptions) -> DynamicsError {
    let hair = Hair { strands: start, options, pinned: &[], body: None };
    settle(&hair, &SettleOptions { limit: 1.0, rest_speed: 0.5 }, &Task::new()).unwrap_err()
}

#[test]
fn what_would_blow_up_is_refused_with_the_setting_to_change() {
    let start = level(3, 20, 0.5);
    let strong = refused(&start, &options(vec![gravity(), attractor(Vec3::ZERO, 1.0, 1e6)]));
    assert!(matches!(strong, DynamicsError::Stiff { .. }), "{strong}");
    assert_eq!(strong.to_string(), "the attractor (force 2) is too strong for `240` steps per second");
    // What the hint says is enough.
    let DynamicsError::Stiff { needed, .. } = strong else { panic!() };
    let more = HairOptions { steps: needed, ..options(vec![gravity(), attractor(Vec3::ZERO, 1.0, 1e6)]) };
    let again = refused_or_none(&start, &more);
    assert!(!matches!(again, Some(DynamicsError::Stiff { .. })), "{again:?}");

    let fast = refused(&start, &options(vec![wind(Vec3::X, 1e6, 0.0)]));
    let DynamicsError::Fast { needed, .. } = fast else { panic!("{fast}") };
    let more = HairOptions { steps: needed, ..options(vec![wind(Vec3::X, 1e6, 0.0)]) };
    assert_eq!(refused_or_none(&start, &more), None);

    let stiff = refused(&level(3, 200, 0.05), &HairOptions { hold: 300.0, ..options(vec![]) });
    let DynamicsError::Hold { most, .. } = stiff else { panic!("{stiff}") };
    assert_eq!(refused_or_none(&level(3, 200, 0.05), &HairOptions { hold: most, ..options(vec![]) }), None);
    assert!(stiff.hint().unwrap().contains("lower `hold` to"));
}

fn refused_or_none(start: &Strands, options: &HairOptions) -> Option<DynamicsError> {
    let hair = Hair { strands: start, options, pinned: &[], body: None };
    settle(&hair, &SettleOptions { limit: 0.05, rest_speed: 0.5 }, &Task::new()).err()
}

#[test]
fn a_head_that_jumps_is_refused() {
    let start = level(3, 20, 0.5);
    let jump =
        Clip::new(24.0, vec![Arc::default(), Arc::new(Affine3A::from_translation(Vec3::X * 90.0)), Arc::default()]);
    let options = options(vec![gravity()]);
    let hair = Hair { strands: &start, options: &options, pinned: &[], body: None };
    let sim = |rate| SimulateOptions { duration: None, rate, balanced: true, r#loop: None };
    let error = simulate(&hair, &sim(None), Some(&jump), &Task::new()).unwrap_err();
    assert!(matches!(error, DynamicsError::Head { .. }), "{error}");
    let error = simulate(&hair, &sim(Some(30.0)), Some(&jump), &Task::new()).unwrap_err();
    assert_eq!(error.to_string(), "the motion of the head has `24` frames per second, the clip 30");
    let grown = Clip::new(24.0, vec![Arc::default(), Arc::new(Affine3A::from_scale(Vec3::splat(1.2)))]);
    assert!(matches!(simulate(&hair, &sim(None), Some(&grown), &Task::new()), Err(DynamicsError::Value { .. })));
}

#[test]
fn bad_strands_and_numbers_are_refused() {
    let gravity = options(vec![gravity()]);
    assert_eq!(refused(&Strands::new(), &gravity), DynamicsError::Nothing);
    let folded = strands(2, 5, |i, k| if i == 1 && k == 3 { Vec3::Z * 2.0 } else { Vec3::new(0.0, 0.0, k as f32) });
    assert!(matches!(refused(&folded, &gravity), DynamicsError::Segment { strand: 1, segment: 3, .. }));
    let mut nan = level(2, 5, 1.0);
    nan.points[3].y = f32::NAN;
    assert!(matches!(refused(&nan, &gravity), DynamicsError::Strands(_)));
    for bad in [f32::NAN, -1.0, f32::INFINITY] {
        let hold = HairOptions { hold: bad, ..gravity.clone() };
        assert!(matches!(refused(&level(2, 5, 1.0), &hold), DynamicsError::Value { .. }), "{bad}");
    }
    let nowhere = options(vec![attractor(Vec3::splat(f32::NAN), 1.0, 100.0)]);
    assert!(matches!(refused(&level(2, 5, 1.0), &nowhere), DynamicsError::Value { .. }));
}

#[test]
fn a_cancelled_task_ends_it() {
    let (start, options) = (level(20, 60, 0.5), options(vec![gravity()]));
    let hair = Hair { strands: &start, options: &options, pinned: &[], body: None };
    let task = Task::new();
    task.cancel();
    let settle_options = SettleOptions { limit: 600.0, rest_speed: 0.001 };
    assert_eq!(settle(&hair, &settle_options, &task).unwrap_err(), DynamicsError::Cancelled(crate::task::Cancelled));
}

#[test]
fn what_never_rests_says_so() {
    let (start, mut options) = (level(2, 20, 0.5), options(vec![gravity()]));
    options.drag = Some(0.0);
    options.hold = 0.0;
    let hair = Hair { strands: &start, options: &options, pinned: &[], body: None };
    let run = |limit: f32| settle(&hair, &SettleOptions { limit, rest_speed: 0.1 }, &Task::new()).unwrap();
    let out = run(0.2);
    assert!(out.value.rested.is_none() && out.value.moving == 2 && out.value.speed > 1.0);
    assert!(out.warnings[0].message.starts_with("hair still moved at up to"), "{:?}", out.warnings);
    // It stops where it is fastest, so that limp hair without air comes to rest as well.
    let out = run(20.0);
    assert!(out.value.rested == Some(out.value.time) && out.value.moving == 0 && out.warnings.is_empty());
    assert!((out.value.steps as f32 / 240.0 - out.value.time).abs() < 1e-4);
}

/// Whatever passes the checks stays finite and whole.
#[test]
fn no_setting_tears_hair() {
    let key = Key::new(2, "settings");
    let tangle = strands(9, 40, |i, k| {
        (0..k as u64).map(|n| key.with(i).with(n).direction() * (0.2 + 0.6 * key.with(n).unit())).sum::<Vec3>()
            + Vec3::X * i as f32
    });
    let mut tried = 0;
    for i in 0..20 {
        let key = key.with(1000 + i);
        let pick = |n: u64, lo: f32, hi: f32| key.with(n).range(lo, hi);
        let forces = vec![
            gravity(),
            wind(key.direction(), pick(1, 0.0, 6000.0), pick(2, 0.0, 3.0)),
            attractor(key.with(3).direction() * 10.0, pick(4, 0.0, 4.0), pick(5, 0.0, 9000.0)),
        ];
        let options = HairOptions {
            hold: pick(6, 0.0, 25.0),
            drag: Some(pick(7, 0.0, 4.0)),
            clamped: i % 2 == 0,
            steps: pick(8, 60.0, 400.0),
            repulsion: pick(9, 0.0, 500.0) * (i % 3) as f32,
            iterations: 1 + i as usize % 3,
            lengths: if i % 5 < 2 { Lengths::RootFree } else { Lengths::Exact },
            ..options(forces)
        };
        let hair = Hair { strands: &tangle, options: &options, pinned: &[], body: None };
        let sim = SimulateOptions { duration: Some(0.7), rate: Some(24.0), balanced: i % 4 < 2, r#loop: None };
        match simulate(&hair, &sim, Some(&super::laws::turn(2.0)), &Task::new()) {
            Ok(clip) => {
                tried += 1;
                for frame in &clip.value.frames {
                    assert!(frame.validate().is_ok() && stretch(frame, &tangle) < 1e-3, "setting {i}: {options:?}");
                }
            }
            Err(
                DynamicsError::Stiff { .. }
                | DynamicsError::Fast { .. }
                | DynamicsError::Head { .. }
                | DynamicsError::Hold { .. },
            ) => {}
            Err(other) => panic!("setting {i}: {other}"),
        }
    }
    assert!(tried > 4, "{tried}");
}

#[test]
fn nodes_in_a_pinned_zone_ride_on_the_head() {
    let start = level(4, 20, 0.5);
    let options = HairOptions { hold: 0.0, ..options(vec![gravity()]) };
    let zone = Zone::Ball { centre: Vec3::new(5.0, 0.0, 3.0), radius: 4.0 };
    let hair = Hair { strands: &start, options: &options, pinned: &[zone], body: None };
    let sim = SimulateOptions { duration: None, rate: None, balanced: false, r#loop: None };
    let motion = super::laws::turn(0.8);
    let clip = simulate(&hair, &sim, Some(&motion), &Task::new()).unwrap().value;
    for (frame, pose) in clip.frames.iter().zip(&motion.frames) {
        for (p, home) in frame.points.iter().zip(&start.points) {
            if zone.contains(*home) {
                assert!(p.distance(pose.transform_point3(*home)) < 1e-3);
            }
        }
    }
    assert!(clip.frames[19].points[79].y < -1.0, "the rest hangs down");
}
