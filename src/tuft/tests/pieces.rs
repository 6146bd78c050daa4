//! Dips, caps, buns and rings.

use super::*;

#[test]
fn dips_are_found_and_lifted() {
    let solid = ball();
    let g = ground(&solid);
    let options = DipOptions::default();
    let find = |t: &Tuft| dips(&Tufts::new(vec![t.clone()], ""), &options, &g, &Task::new()).unwrap();
    // A spike and a tuft that stays clear
    let clear = falling(0.5, 0.7, 1.5);
    assert_eq!(find(&clear), []);
    // Two chords of the ball: each is deepest near its middle.
    let points = vec![Vec3::Y * RADIUS, toward(0.0, 0.9) * RADIUS, toward(0.0, 0.1) * RADIUS, toward(0.0, -0.3) * 11.0];
    let through = Tuft::new(Stroke::new(points, Vec3::ZERO, 1.0).unwrap(), Section::round(0.8, 0.4)).unwrap();
    let found = find(&through);
    assert_eq!(found.len(), 2, "{found:?}");
    let d = found[1];
    assert!((solid.signed_distance(d.position) + d.depth).abs() < 1e-4 && d.depth > 0.5 * d.thickness);
    assert!(d.t > dip::base_end(&through) && d.warning().message.starts_with("tuft 1 dips"));
    let lifted = lift(&through, &options, &g).unwrap();
    assert_eq!((lifted.left, find(&lifted.tuft).len()), (0.0, 0));
    assert!(lifted.moved > 0.1 && lifted.moved < 3.0, "{}", lifted.moved);
    assert_eq!(lifted.tuft.stroke.root(), through.stroke.root());
    // Asked for
    assert_eq!(find(&Tuft { bury: true, ..through.clone() }), []);
    let stopped = Task::new();
    stopped.cancel();
    assert!(dips(&Tufts::new(vec![through], ""), &options, &g, &stopped).is_err());
}

#[test]
fn caps_cover_the_head_and_are_closed() {
    let solid = ball();
    let g = ground(&solid);
    let border: Vec<Vec3> =
        (0..10).map(|i| toward(TAU * i as f32 / 10.0, -0.3 + 0.3 * (i % 3) as f32) * RADIUS).collect();
    let back: Vec<Vec3> = border.iter().rev().copied().collect();
    for border in [border, back] {
        for (refine, smooth) in [(1, true), (2, false), (4, true)] {
            let options = CapOptions { refine, smooth, ..CapOptions::new(border.clone()) };
            let cap = options.build(&g).unwrap();
            assert_eq!(cap.warnings, []);
            assert_sound(&cap.value);
            let rows = 1 << refine;
            assert_eq!(cap.value.triangles.len(), 2 * 10 * rows * rows + 2 * 10 * rows);
        }
        // Above the crown the thickness is whole, under the sheet lies the skin.
        let cap = CapOptions::new(border).build(&g).unwrap().value;
        let top = cap.positions.iter().map(|p| p.length()).fold(0.0, f32::max);
        assert!((top - RADIUS - 0.5).abs() < 0.05, "{top}");
        let half = cap.positions.len() / 2;
        assert!(cap.positions[..half].iter().all(|&p| solid.signed_distance(p) > 0.05));
        assert!(cap.positions[half..].iter().all(|&p| solid.signed_distance(p) < -0.05));
        let bvh = Bvh::new(&cap.positions, &cap.triangles);
        for i in 0..50 {
            let hit = bvh.first_hit(toward(i as f32, 0.8) * 20.0, -toward(i as f32, 0.8), 20.0).unwrap();
            assert!(hit.position.length() > RADIUS + 0.1, "the outer side covers the head");
        }
    }
    let few = CapOptions::new(vec![Vec3::X * 9.0, Vec3::Z * 9.0]).build(&g).unwrap_err();
    assert_eq!(few, TuftError::TooFewPoints { what: "a cap's border", least: 3, count: 2 });
    let far = CapOptions::new(vec![Vec3::X * 12.0, Vec3::Z * 9.0, Vec3::NEG_X * 9.0]).build(&g).unwrap();
    assert!(far.warnings[0].message.starts_with("border point 1 lies `3.0"));
    let same = CapOptions::new(vec![Vec3::X * 9.0, Vec3::X * 9.0, Vec3::Z * 9.0]).build(&g).unwrap_err();
    assert!(matches!(same, TuftError::RepeatedPoint { number: 2, .. }));
}

#[test]
fn buns_and_rings_are_closed() {
    for (grooves, length) in [(0, None), (6, Some(4.0)), (9, Some(9.0))] {
        let bun = BunOptions { grooves, length, ..BunOptions::at(Vec3::Y * 11.0) };
        let mesh = bun.build().unwrap();
        assert_sound(&mesh);
        let size = mesh.bounds().size();
        let along = length.unwrap_or(6.0);
        assert!((size.y - along).abs() < 1e-4 && size.x < 6.001 && size.x > 5.2, "{size}");
        if grooves == 0 {
            let ball = 4.0 / 3.0 * std::f64::consts::PI * 27.0;
            assert!(mesh.volume() < ball && mesh.volume() > 0.95 * ball);
        }
    }
    for section in sections() {
        let t = tuft(section);
        for shape in [RingShape::Round, RingShape::Flat] {
            let ring = RingOptions { shape, ..RingOptions::at(0.4) }.build(&t).unwrap();
            assert_sound(&ring);
        }
    }
    let t = tuft(Section::round(2.0, 0.3));
    assert!(matches!(RingOptions::at(1.0).build(&t), Err(TuftError::NoSize { .. })));
    assert!(matches!(RingOptions::at(f32::NAN).build(&t), Err(TuftError::OutOfRange { .. })));
    let split = tuft(Section { split: Some(Split { tips: 2, from: 0.5, spread: 0.0 }), ..Section::round(2.0, 0.3) });
    assert!(matches!(RingOptions::at(0.7).build(&split), Err(TuftError::OutOfRange { .. })));
    assert!(BunOptions::at(Vec3::splat(f32::INFINITY)).build().is_err());
}
