//! The fill between tufts, equations (1) to (8).

use super::*;

#[test]
fn angles_are_the_papers_turned_to_y_up() {
    for (v, azimuth, elevation) in
        [(Vec3::Z, -PI / 2.0, 0.0), (Vec3::X, 0.0, 0.0), (Vec3::NEG_Z, PI / 2.0, 0.0), (Vec3::Y, 0.0, PI / 2.0)]
    {
        let (a, e) = azimuth_elevation(v);
        assert!((e - elevation).abs() < 1e-6 && (v.y == 1.0 || (a - azimuth).abs() < 1e-6), "{v}: {a} {e}");
        assert!(toward(azimuth, elevation).distance(v) < 1e-6);
    }
    assert!(!grows_hair(-PI / 2.0, -0.01) && grows_hair(-PI / 2.0, 0.01));
    assert!(grows_hair(PI / 2.0, -1.0) && !grows_hair(PI / 2.0, -1.1));
    assert!(grows_hair(-PI / 6.0, -0.5) && !grows_hair(-PI / 6.0 - 0.01, -0.5));
}

#[test]
fn fill_counts_by_hand() {
    // A quarter of the circle with radius 9: gamma = pi/2, e = 14.137; the whole circle: e = 56.549.
    let (a, b) = (toward(0.0, 0.0) * 9.0, toward(PI / 2.0, 0.0) * 9.0);
    let (alpha, beta, e) = distance_around(a, b, false);
    assert!((alpha - PI / 2.0).abs() < 1e-6 && beta.abs() < 1e-6 && (e - 14.137).abs() < 1e-3);
    assert_eq!([100.0, 50.0, 10.0, 1.0].map(|m| count_around(m, e, 1.0)), [14, 7, 1, 0]);
    let (alpha, _, e) = distance_around(b, a, false);
    assert!((alpha - 1.5 * PI).abs() < 1e-5 && (e - 42.412).abs() < 1e-3, "the other way round is the long way");
    assert_eq!(count_around(100.0, e, 1.0), 42);
    let (alpha, _, e) = distance_around(a, a, true);
    assert!(alpha == TAU && (e - 56.549).abs() < 1e-3);
    assert_eq!([count_around(100.0, e, 1.0), count_around(25.0, e, 1.0), count_around(100.0, e, 2.0)], [56, 14, 28]);
    // A difference in elevation: cos g = cos 0.5 cos 1, g = 1.0769; e = 9.692.
    let (_, beta, e) = distance_around(a, toward(1.0, 0.5) * 9.0, false);
    assert!((beta - 0.5).abs() < 1e-6 && (e - 9.692).abs() < 2e-3, "{e}");
    assert!((row_step(100.0) - PI / 20.0).abs() < 1e-6 && (row_step(50.0) - 0.275 * PI).abs() < 1e-6);
}

#[test]
fn fill_gaps_follow_the_diameters() {
    let solid = ball();
    let (a, b) = (falling(0.0, 0.3, 4.0), falling(2.0, 0.3, 1.0));
    let options = FillOptions { around: 60.0, ..FillOptions::default() };
    let made = fill(&[a.clone(), b.clone()], &options, &ground(&solid)).unwrap().value;
    let n = count_around(60.0, distance_around(a.stroke.root(), b.stroke.root(), false).2, 1.0);
    assert_eq!((made.len(), n), (n, 10));
    let azimuths: Vec<f32> =
        [&a].into_iter().chain(&made).chain([&b]).map(|t| azimuth_elevation(t.stroke.root()).0).collect();
    let mut d = vec![];
    for (l, t) in made.iter().enumerate() {
        let Profile::Round { diameter, .. } = t.section.profile else { panic!() };
        assert!((diameter - (4.0 - 3.0 * (l + 1) as f32 / (n + 1) as f32)).abs() < 1e-5);
        assert!(solid.signed_distance(t.stroke.root()).abs() < 1e-3);
        assert!((azimuth_elevation(t.stroke.root()).1 - 0.3).abs() < 1e-4);
        d.push(diameter);
    }
    d.push(1.0);
    let total: f32 = d.iter().sum();
    for (w, d) in azimuths.windows(2).zip(&d) {
        assert!((w[1] - w[0] - 2.0 * d / total).abs() < 1e-3, "gap {} for diameter {d}", w[1] - w[0]);
    }
    // Steps keep their lengths and turn with the root.
    for t in &made {
        let (azimuth, _) = azimuth_elevation(t.stroke.root());
        for (w, v) in t.stroke.points().windows(2).zip(a.stroke.points().windows(2)) {
            assert!((w[0].distance(w[1]) - v[0].distance(v[1])).abs() < 1e-3);
            assert!((w[1] - w[0]).cross(Vec3::Y).normalize().dot(toward(azimuth, 0.0)).abs() < 1e-2);
        }
    }
}

#[test]
fn a_single_tuft_goes_all_the_way_around() {
    let solid = ball();
    let a = falling(0.4, 0.6, 2.0);
    let options = FillOptions { around: 25.0, everywhere: true, ..FillOptions::default() };
    let made = fill(std::slice::from_ref(&a), &options, &ground(&solid)).unwrap().value;
    assert_eq!(made.len(), 14);
    assert_eq!(made, fill(&[a.clone(), a.clone()], &options, &ground(&solid)).unwrap().value);
    for (l, t) in made.iter().enumerate() {
        let want = a.stroke.turned(glam::Quat::from_rotation_y(TAU * (l + 1) as f32 / 15.0));
        for (p, q) in t.stroke.points().iter().zip(want.points()) {
            assert!(p.distance(*q) < 0.05, "{l}: {p} {q}");
        }
    }
}

#[test]
fn chains_and_rows() {
    let solid = ball();
    let g = ground(&solid);
    let three = [falling(-0.4, 0.4, 2.0), falling(1.0, 0.6, 2.0), falling(2.4, 0.4, 2.0)];
    let options = FillOptions { around: 30.0, everywhere: true, ..FillOptions::default() };
    let chain = fill(&three, &options, &g).unwrap().value;
    let parts: Vec<Tuft> = three.windows(2).flat_map(|w| fill(w, &options, &g).unwrap().value).collect();
    assert_eq!(chain, parts);

    // Rows at 0.4 + y pi/20 below pi/2: 7; downward in the allowed region: 0.4 - y pi/20 > -pi/3: 9.
    let rows = FillOptions { around: 1.0, up: Some(100.0), ..FillOptions::default() };
    let pair = [falling(0.2, 0.4, 2.0), falling(0.5, 0.4, 2.0)];
    assert_eq!(fill(&pair, &rows, &g).unwrap().value.len(), 2 * 7);
    let down = FillOptions { up: None, down: Some(100.0), ..rows.clone() };
    assert_eq!(fill(&pair, &down, &g).unwrap().value.len(), 2 * 9);
    let one = fill(&pair, &FillOptions { up: Some(50.0), ..rows }, &g).unwrap().value;
    assert_eq!(one.len(), 2);
    assert!((azimuth_elevation(one[0].stroke.root()).1 - (0.4 + 0.275 * PI)).abs() < 1e-2);
    // No roots on the face: one on its edge, rows downward from 0.1.
    let face = [falling(-1.2, 0.1, 2.0)];
    let down = FillOptions { around: 1.0, down: Some(100.0), ..FillOptions::default() };
    assert_eq!(fill(&face, &down, &g).unwrap_err(), TuftError::NoRoot { candidates: 10 });
}

#[test]
fn jitter_stays_within_nine_degrees_and_on_the_head() {
    let solid = ball();
    let g = ground(&solid);
    let a = [falling(0.0, 0.5, 2.0)];
    let still = FillOptions { around: 80.0, everywhere: true, up: Some(90.0), ..FillOptions::default() };
    let strewn = FillOptions { jitter: 1.0, seed: 4, ..still.clone() };
    let (still, moved) = (fill(&a, &still, &g).unwrap().value, fill(&a, &strewn, &g).unwrap().value);
    let around = count_around(80.0, TAU * 9.0, 1.0);
    let mut far = 0.0_f32;
    for (s, m) in still.iter().zip(&moved).take(around) {
        let ((a, e), (b, f)) = (azimuth_elevation(s.stroke.root()), azimuth_elevation(m.stroke.root()));
        let by = ((b - a + PI).rem_euclid(TAU) - PI).abs().max((f - e).abs());
        assert!(by <= PI / 20.0 + 1e-3, "{by}");
        assert!(solid.signed_distance(m.stroke.root()).abs() < 1e-3);
        far = far.max(by);
    }
    assert!(far > PI / 30.0);
    assert_eq!(moved, fill(&a, &strewn, &g).unwrap().value);
    assert_ne!(moved, fill(&a, &FillOptions { seed: 5, ..strewn }, &g).unwrap().value);
}

#[test]
fn fills_refuse_what_does_not_fit() {
    let solid = ball();
    let g = ground(&solid);
    let options = FillOptions::default();
    let a = falling(0.0, 0.5, 2.0);
    assert_eq!(fill(&[], &options, &g).unwrap_err(), TuftError::NoTufts);
    let b = Tuft::new(stroke(5), Section::round(2.0, 0.3)).unwrap();
    let e = fill(&[a.clone(), b], &options, &g).unwrap_err();
    assert_eq!(e, TuftError::PointCounts { number: 2, count: 5, before: 3 });
    let b = Tuft { section: sections()[1].clone(), ..falling(1.0, 0.5, 2.0) };
    let e = fill(&[a.clone(), b.clone()], &options, &g).unwrap_err();
    assert_eq!(e, TuftError::SectionKinds { number: 2, kind: "elliptic", before: "round" });
    for bad in [0.0, 101.0, f32::NAN] {
        let options = FillOptions { around: bad, ..FillOptions::default() };
        assert!(matches!(
            fill(std::slice::from_ref(&a), &options, &g),
            Err(TuftError::OutOfRange { what: "around", .. })
        ));
    }
    let near = fill(&[a, falling(0.05, 0.5, 2.0)], &options, &g).unwrap();
    assert!(near.value.is_empty() && near.warnings.len() == 1);
}
