//! Strands in motion: what is decided at rest stays decided.

use glam::Affine3A;

use super::*;
use crate::geometry::Clip;
use crate::task::Task;

/// One curl in that box.
fn curled(r#box: OrientedBox) -> NaturalQueue {
    let curl = Curl { period: 2.0, radius: 0.5, ..super::natural::curl(r#box) };
    NaturalQueue::new(vec![Arc::new(Domain::Natural(Arc::new(Natural::from(&curl))))]).unwrap()
}

/// Guides that hang from a line, bent to the front.
fn guides() -> Strands {
    let mut s = Strands::new();
    s.sources.push("test.lua:1".into());
    for g in 0..12_u64 {
        let at = Vec3::new(g as f32 - 6.0, 0.3 * (g % 3) as f32, 0.0);
        let node = |k: usize| at + Vec3::new(0.0, 0.6 * k as f32, 0.02 * (k * k) as f32);
        s.push(root(g, at, Vec3::Y), 0, (0..20).map(node));
    }
    s
}

/// Guides bent sideways about their roots by so many radians at the tip.
fn swayed(rest: &Strands, angle: f32) -> Strands {
    let mut s = rest.clone();
    for g in 0..s.count() {
        let base = rest.strand(g)[0];
        for (k, i) in s.range(g).enumerate() {
            let turn = Affine3A::from_rotation_z(angle * k as f32 / 19.0);
            s.points[i] = base + turn.transform_vector3(rest.points[i] - base);
        }
    }
    s
}

fn clip(frames: impl IntoIterator<Item = Strands>) -> Clip<Strands> {
    Clip::new(24.0, frames.into_iter().map(Arc::new).collect())
}

fn roots() -> Vec<Root> {
    let key = Key::new(3, "line");
    let at = |k: Key| Vec3::new(k.with(1).range(-6.0, 5.0), k.with(2).range(0.0, 0.6), 0.0);
    (0..80).map(|i| root(i, at(key.with(i)), Vec3::Y)).collect()
}

fn filled(guides: &Strands, frames: &Clip<Strands>, head: Option<&Clip<Affine3A>>) -> Moving {
    let (roots, options, source) = (roots(), fill_options(24), "test.lua:2".into());
    let input = Fill { guides, roots: &roots, options: &options, separated: None, solid: None, source: &source };
    let moving = fill_clip(&input, frames, head, &Task::new()).unwrap().value;
    moving.rest.validate().unwrap();
    for frame in &moving.frames.frames {
        frame.validate().unwrap();
        assert_eq!((&frame.offsets, &frame.guide), (&moving.rest.offsets, &moving.rest.guide));
    }
    moving
}

fn farthest(a: &Strands, b: &Strands) -> f32 {
    a.points.iter().zip(&b.points).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max)
}

#[test]
fn members_of_guides_at_rest_are_those_of_a_still_fill() {
    let rest = guides();
    let moving = filled(&rest, &clip([rest.clone(), rest.clone()]), None);
    let (roots, options, source) = (roots(), fill_options(24), "test.lua:2".into());
    let input = Fill { guides: &rest, roots: &roots, options: &options, separated: None, solid: None, source: &source };
    let still = fill(&input, &Task::new()).unwrap().value;
    assert_eq!(moving.rest, still);
    assert!(farthest(&moving.frames.frames[1], &still) < 1e-4);
}

#[test]
fn members_move_no_farther_than_guides_bend() {
    // Hundred small steps through the upright, where the guides' bend changes its side.
    let rest = guides();
    let angle = |i: i32| 1.2 * (i - 50) as f32 / 50.0;
    let frames = clip((0..=100).map(|i| swayed(&rest, angle(i))));
    let moving = filled(&rest, &frames, None);
    for i in 0..100 {
        let (a, b) = (&frames.frames[i], &frames.frames[i + 1]);
        let (x, y) = (&moving.frames.frames[i], &moving.frames.frames[i + 1]);
        assert!(farthest(x, y) < 1.5 * farthest(a, b), "{i}: {} {}", farthest(x, y), farthest(a, b));
    }
}

#[test]
fn with_a_motion_of_the_head_everything_turns_with_it() {
    let rest = guides();
    let head: Vec<_> = [0.0, 0.7, 2.0].map(|a| Arc::new(Affine3A::from_rotation_y(a))).into();
    let frames = clip(head.iter().map(|by| rest.transformed(by)));
    let head = Clip::new(24.0, head);
    let moving = filled(&rest, &frames, Some(&head));
    for (frame, by) in moving.frames.frames.iter().zip(&head.frames) {
        let wanted = moving.rest.transformed(by);
        assert!(farthest(frame, &wanted) < 1e-3);
        assert!(frame.roots.iter().zip(&wanted.roots).all(|(a, b)| a.position.distance(b.position) < 1e-4));
    }
    let queue = curled(everywhere());
    let input = Deform { strands: &rest, queue: &queue, which: &[], solid: None, margin: 0.05, seed: 1 };
    let bent = deform_clip(&input, &frames, Some(&head), &Task::new()).unwrap().value;
    for (frame, by) in bent.frames.frames.iter().zip(&head.frames) {
        assert!(farthest(frame, &bent.rest.transformed(by)) < 2e-3);
    }
}

#[test]
fn curls_stay_where_they_are_on_strands_that_move() {
    // A box that only the upper half is in at rest; swayed, strands leave it altogether.
    let rest = guides();
    let upper = region([-20.0, 6.0, -20.0], [20.0, 60.0, 60.0]);
    let queue = curled(upper);
    let input = Deform { strands: &rest, queue: &queue, which: &[], solid: None, margin: 0.05, seed: 1 };
    let frames = clip((0..=40).map(|i| swayed(&rest, 3.0 * trig::sin(i as f32 * 0.1))));
    let bent = deform_clip(&input, &frames, None, &Task::new()).unwrap().value;
    for i in 0..40 {
        let step = farthest(&frames.frames[i], &frames.frames[i + 1]).max(0.01);
        let (a, b) = (&bent.frames.frames[i], &bent.frames.frames[i + 1]);
        assert!(farthest(a, b) < 2.0 * step, "{i}: {} {step}", farthest(a, b));
        // As far from the axis as at rest.
        let off = |s: &Strands, axis: &Strands, k: usize| {
            let fine = crate::geometry::curve::resampled(axis.strand(k), s.strand(k).len());
            s.strand(k).iter().zip(fine).map(|(p, q)| p.distance(q)).fold(0.0, f32::max)
        };
        assert!((off(b, &frames.frames[i + 1], 5) - off(&bent.rest, &rest, 5)).abs() < 0.08);
    }
}

#[test]
fn frames_of_other_strands_and_too_many_frames_are_refused() {
    let rest = guides();
    let mut other = rest.clone();
    other.points.pop();
    *other.offsets.last_mut().unwrap() -= 1;
    let (roots, options, source) = (roots(), fill_options(24), "test.lua:2".into());
    let input = Fill { guides: &rest, roots: &roots, options: &options, separated: None, solid: None, source: &source };
    let refused = |frames: &Clip<Strands>| fill_clip(&input, frames, None, &Task::new()).unwrap_err();
    assert_eq!(refused(&clip([rest.clone(), other])), GroomError::Topology { frame: 2 });
    let still = Arc::new(rest.clone());
    let long = Clip::new(24.0, vec![still; 200_000]);
    assert!(matches!(refused(&long), GroomError::Clip { frames: 200_001, .. }));
    let cancelled = Task::new();
    cancelled.cancel();
    let frames = clip([rest.clone()]);
    assert!(matches!(fill_clip(&input, &frames, None, &cancelled), Err(GroomError::Cancelled(_))));
}

#[test]
fn poses_are_passed_through_with_the_length_kept() {
    let rest = Arc::new(guides());
    let poses = [Arc::clone(&rest), Arc::new(swayed(&rest, 1.5)), Arc::new(swayed(&rest, -1.5))];
    let ways: Vec<_> = (0..=20).map(|i| (1, 2, i as f32 / 20.0)).collect();
    let frames = pass_through(&poses, &ways, None, &Task::new()).unwrap();
    assert!(Arc::ptr_eq(&frames[0], &poses[1]) && Arc::ptr_eq(&frames[20], &poses[2]));
    for frame in &frames {
        frame.validate().unwrap();
        for g in 0..12 {
            assert!((frame.length(g) - poses[1].length(g)).abs() < 1e-3 * rest.length(g), "{g}");
        }
    }
    let most = farthest(&frames[0], &frames[20]);
    assert!(frames.windows(2).all(|w| farthest(&w[0], &w[1]) < 3.0 * most / 20.0));
    let mut other = Strands::clone(&rest);
    other.points.pop();
    *other.offsets.last_mut().unwrap() -= 1;
    let poses = [rest, Arc::new(other)];
    assert_eq!(pass_through(&poses, &ways, None, &Task::new()), Err(GroomError::Topology { frame: 2 }));
}
