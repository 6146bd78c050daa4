//! Algorithm 1, step by step.

use super::*;

fn judge(walk: &mut Walk, v: [f32; 3]) -> Vec3 {
    walk.judge(Vec3::from(v), &mut Vec3::Y.clone(), Key::new(0, "test")).0
}

#[test]
fn a_box_acts_while_the_growth_end_is_inside_and_once_only() {
    let q = queue(&[directional(region([-1.0, 2.0, -1.0], [1.0, 4.0, 1.0]), Vec3::X, 2.0, 0)]);
    let mut walk = Walk::new(Some(&q));
    // Visible but not entered: no force, and not dismissed either.
    for y in [0.0, 1.0, 1.9] {
        assert_eq!(judge(&mut walk, [0.0, y, 0.0]), Vec3::ZERO);
        assert!(!walk.is_finished());
    }
    assert_eq!(judge(&mut walk, [0.0, 2.0, 0.0]), Vec3::X * 2.0);
    assert_eq!(judge(&mut walk, [0.5, 4.0, 0.0]), Vec3::X * 2.0);
    // Left: dismissed in this very step, and coming back changes nothing.
    assert_eq!(judge(&mut walk, [0.5, 4.1, 0.0]), Vec3::ZERO);
    assert!(walk.is_finished());
    assert_eq!(judge(&mut walk, [0.0, 3.0, 0.0]), Vec3::ZERO);
}

#[test]
fn an_emptied_stage_makes_the_next_visible_in_the_next_step() {
    let first = directional(region([-1.0, 0.0, -1.0], [1.0, 1.0, 1.0]), Vec3::X, 1.0, 5);
    let second = directional(everywhere(), Vec3::Z, 1.0, 4);
    // Written in the wrong order: the priority counts.
    let q = queue(&[second, first]);
    let mut walk = Walk::new(Some(&q));
    assert_eq!(walk.head(), None);
    assert_eq!(judge(&mut walk, [0.0, 0.5, 0.0]), Vec3::X);
    // Leaves the first box, and is in the second: which does not act yet.
    assert_eq!(judge(&mut walk, [0.0, 1.5, 0.0]), Vec3::ZERO);
    assert_eq!(walk.head(), Some(0));
    assert_eq!(judge(&mut walk, [0.0, 2.0, 0.0]), Vec3::Z);
    assert_eq!(walk.head(), Some(1));
}

#[test]
fn equal_priorities_share_a_stage_and_all_of_it_must_be_left() {
    let low = directional(region([-1.0, 0.0, -1.0], [1.0, 2.0, 1.0]), Vec3::X, 1.0, 1);
    let high = directional(region([-1.0, 1.0, -1.0], [1.0, 4.0, 1.0]), Vec3::Z, 3.0, 1);
    let aside = directional(region([9.0, 9.0, 9.0], [10.0, 10.0, 10.0]), Vec3::Y, 1.0, 1);
    let next = directional(everywhere(), Vec3::NEG_Y, 1.0, 0);
    let q = queue(&[low, high, next.clone()]);
    assert_eq!(q.stages().iter().map(|s| s.domains.clone()).collect::<Vec<_>>(), [vec![0, 1], vec![2]]);
    let mut walk = Walk::new(Some(&q));
    assert_eq!(judge(&mut walk, [0.0, 0.5, 0.0]), Vec3::X);
    assert_eq!(judge(&mut walk, [0.0, 1.5, 0.0]), Vec3::new(1.0, 0.0, 3.0));
    assert_eq!(judge(&mut walk, [0.0, 3.0, 0.0]), Vec3::Z * 3.0);
    assert_eq!(judge(&mut walk, [0.0, 5.0, 0.0]), Vec3::ZERO);
    assert_eq!(judge(&mut walk, [0.0, 5.0, 0.0]), Vec3::NEG_Y);

    // One that is never entered keeps the stage from being empty.
    let q = queue(&[directional(region([-1.0, 0.0, -1.0], [1.0, 1.0, 1.0]), Vec3::X, 1.0, 1), aside, next]);
    let mut walk = Walk::new(Some(&q));
    judge(&mut walk, [0.0, 0.5, 0.0]);
    for y in [2.0, 3.0, 4.0] {
        assert_eq!(judge(&mut walk, [0.0, y, 0.0]), Vec3::ZERO);
        assert_eq!(walk.head(), Some(0));
    }
}

#[test]
fn a_gather_domain_pulls_within_its_sphere_until_the_core() {
    let core = Vec3::new(0.0, 4.0, 0.0);
    let q = queue(&[gather(core, 0.5, None, 0)]);
    // To the core.
    let mut walk = Walk::new(Some(&q));
    for v in [[0.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.5, 3.4, 0.0]] {
        assert_near(judge(&mut walk, v), (core - Vec3::from(v)).normalize(), 1e-6);
    }
    assert_eq!(judge(&mut walk, [0.0, 3.5, 0.0]), Vec3::ZERO);
    assert!(walk.is_finished());
    // Out of the sphere about the start point, whose radius is 4: the core is not its centre.
    let mut walk = Walk::new(Some(&q));
    judge(&mut walk, [0.0, 0.0, 0.0]);
    assert_ne!(judge(&mut walk, [3.9, 0.0, 0.0]), Vec3::ZERO);
    assert!(!walk.is_finished());
    assert_eq!(judge(&mut walk, [4.1, 0.0, 0.0]), Vec3::ZERO);
    assert!(walk.is_finished());
}

#[test]
fn equation_4_as_numbers() {
    let q = queue(&[gather(Vec3::new(0.0, 4.0, 0.0), 1.0, Some((-0.5, Vec3::new(0.0, 0.0, -1.0))), 0)]);
    let (mut walk, mut t) = (Walk::new(Some(&q)), Vec3::Y);
    walk.judge(Vec3::ZERO, &mut t, Key::new(0, "test"));
    assert_eq!(t, Vec3::Y, "no correction while it holds");
    t = Vec3::new(0.6, 0.8, 0.0);
    walk.judge(Vec3::new(0.0, 3.5, 0.0), &mut t, Key::new(0, "test"));
    // p + d t = (-0.3, -0.4, -1), of length sqrt(1.25).
    assert_near(t, Vec3::new(-0.268_328, -0.357_771, -0.894_427), 1e-6);
}

#[test]
fn a_start_point_in_the_core_is_let_go_at_once_and_corrected() {
    let q = queue(&[gather(Vec3::ZERO, 1.0, Some((2.0, Vec3::X)), 1), directional(everywhere(), Vec3::NEG_Y, 1.0, 0)]);
    let (mut walk, mut t) = (Walk::new(Some(&q)), Vec3::Y);
    let (force, acted) = walk.judge(Vec3::new(0.0, 0.5, 0.0), &mut t, Key::new(0, "test"));
    assert_eq!((force, acted), (Vec3::ZERO, false));
    assert_near(t, Vec3::new(1.0, 2.0, 0.0).normalize(), 1e-6);
    // The next stage only in the next step.
    assert_eq!(walk.judge(Vec3::ZERO, &mut t, Key::new(0, "test")).0, Vec3::NEG_Y);
    // p + d t = 0 leaves the tangent alone.
    let q = queue(&[gather(Vec3::ZERO, 1.0, Some((-1.0, Vec3::Y)), 1)]);
    let mut t = Vec3::Y;
    Walk::new(Some(&q)).judge(Vec3::ZERO, &mut t, Key::new(0, "test"));
    assert_eq!(t, Vec3::Y);
}

#[test]
fn bad_domains_are_refused() {
    let flat = directional(region([0.0, 0.0, 0.0], [1.0, 0.0, 1.0]), Vec3::X, 1.0, 0);
    let message = Queue::new(vec![flat]).unwrap_err().to_string();
    assert_eq!(
        message,
        "the box of the directional domain 1 (in the order written) has no volume: its size is `[1, 0, 1]`"
    );
    let nan = gather(Vec3::new(f32::NAN, 0.0, 0.0), 1.0, None, 0);
    assert!(matches!(Queue::new(vec![nan]), Err(GroomError::Value { .. })));
    let pull = gather(Vec3::ZERO, 1.0, None, 0);
    assert!(matches!(NaturalQueue::new(vec![pull]), Err(GroomError::WrongKind { .. })));
}

#[test]
fn boxes_read_from_tables() {
    use crate::params::{FieldType, Reader, Table, Value};
    let table = |fields: &[(&str, [f32; 3])]| {
        let fields = fields.iter().map(|(k, v)| ((*k).to_owned(), Value::Vector(Vec3::from(*v)))).collect();
        Value::Table(Table { items: vec![], fields })
    };
    let read = |value: &Value| {
        let mut reader = Reader::default();
        OrientedBox::read(value, &mut reader).ok_or_else(|| reader.problems()[0].message.clone())
    };
    let b = read(&table(&[("centre", [1.0, 2.0, 3.0]), ("size", [2.0, 4.0, 2.0]), ("rotation", [0.0, 0.0, 90.0])]))
        .unwrap();
    assert!(b.contains(Vec3::new(2.9, 2.0, 3.0)) && !b.contains(Vec3::new(1.0, 3.5, 3.0)));
    assert_eq!(read(&table(&[("max", [1.0; 3]), ("min", [-1.0; 3])])).unwrap(), region([-1.0; 3], [1.0; 3]));
    assert_eq!(
        read(&table(&[("centre", [0.0; 3])])).unwrap_err(),
        "a box needs `centre` and `size`, or `min` and `max`"
    );
    let flat = read(&table(&[("centre", [0.0; 3]), ("size", [1.0, 0.0, 1.0])]));
    assert_eq!(flat.unwrap_err(), "a box of size `[1, 0, 1]` has no volume");
    // A field that is a word of Rust is called by its plain name.
    use crate::params::Params;
    assert_eq!(Directional::fields()[0].name, "box");
}
