//! Strokes, sections and the meshes of tufts.

use super::*;

#[test]
fn strokes_run_through_their_points_and_are_smooth() {
    let stroke = stroke(7);
    let (beziers, knots) = (stroke.beziers(), stroke.knots());
    assert_eq!(beziers.len(), 7);
    assert_eq!(beziers[0][0], stroke.buried_start());
    for (b, p) in beziers.iter().zip(stroke.points()) {
        assert_eq!(b[3], *p);
    }
    for i in 1..beziers.len() {
        let (before, after) =
            (derivative(&beziers[i - 1], 1.0) / knots[i - 1], derivative(&beziers[i], 0.0) / knots[i]);
        assert!(before.distance(after) < 1e-4 * before.length(), "C1 at {i}: {before} {after}");
    }
    let buried = stroke.buried_start();
    assert!((buried.length() - (RADIUS - 1.0)).abs() < 1e-5 && buried.dot(stroke.root()) > 0.0);
}

#[test]
fn strokes_turn_mirror_and_repeat() {
    let solid = ball();
    let s = stroke(5);
    assert_eq!(s.mirrored().mirrored(), s);
    let r = s.rotated(Vec3::Y, 1.0);
    assert_eq!((r.root(), r.buried_start()), (s.root(), s.buried_start()));
    assert!((r.points()[4].distance(r.root()) - s.points()[4].distance(s.root())).abs() < 1e-5);
    let flat = s.planar(Vec3::Z).unwrap();
    assert!(flat.points().iter().all(|p| (p.z - s.root().z).abs() < 1e-5));
    let array = s.array(5, Vec3::Y, TAU / 5.0, &ground(&solid));
    assert_eq!((array.len(), &array[0]), (5, &s));
    for a in &array {
        assert!(solid.signed_distance(a.root()).abs() < 0.03);
        assert!((a.root().y - s.root().y).abs() < 0.05);
    }
}

#[test]
fn every_section_makes_a_closed_manifold_facing_outward() {
    let details = [
        Detail::Counts { rings: 1, sides: 3 },
        Detail::Counts { rings: 19, sides: 40 },
        Detail::Tolerance(0.05),
        Detail::ControlPoints { sides: 12 },
    ];
    for section in sections() {
        for detail in details {
            let t = Tuft { detail, ..tuft(section.clone()) };
            let mesh = t.mesh();
            assert_closed(&mesh);
            // So coarse a mesh of a curved tuft may be turned inside out; any other must not.
            if detail != details[0] {
                assert_sound(&mesh);
            }
            let all = Tufts::new(vec![t], "a");
            assert_eq!(all.triangle_count(), mesh.triangles.len(), "{section:?} {detail:?}");
            all.validate().unwrap();
        }
    }
}

#[test]
fn normals_are_those_of_the_surface() {
    for section in sections().into_iter().filter(|s| s.split.is_none()) {
        let t = Tuft { detail: Detail::Counts { rings: 60, sides: 48 }, ..tuft(section) };
        let mesh = t.mesh();
        let bad = (0..mesh.triangles.len())
            .filter(|&i| {
                let face = mesh.area_vector(i).normalize_or_zero();
                mesh.triangles[i].iter().any(|&v| mesh.normals[v as usize].dot(face) < 0.0)
            })
            .count();
        // The flat end of an open one has its own way of facing.
        assert!(bad * 20 < mesh.triangles.len(), "{bad} of {} for {:?}", mesh.triangles.len(), t.section);
    }
}

#[test]
fn twenty_points_and_forty_samples_are_the_papers_1520_triangles() {
    for section in [Section::round(2.0, 0.5), sections()[1].clone()] {
        let t = Tuft { detail: Detail::ControlPoints { sides: 40 }, ..Tuft::new(stroke(20), section).unwrap() };
        assert_eq!(t.mesh().triangles.len(), 1520);
        let t = Tuft { detail: Detail::Counts { rings: 19, sides: 40 }, ..t };
        assert_eq!(t.mesh().triangles.len(), 1520);
    }
}

#[test]
fn diameters_are_met_where_they_should_be() {
    // A straight spike, so that sections are circles about a known axis; buried 1 cm, 10 cm long in all.
    let spike = Stroke::new(vec![Vec3::Y * 9.0, Vec3::Y * 18.0], Vec3::ZERO, 1.0).unwrap();
    for (d, p) in [(2.5, 0.1), (10.0, 0.8), (0.3, 0.5)] {
        let t = Tuft {
            detail: Detail::Counts { rings: 99, sides: 64 },
            ..Tuft::new(spike.clone(), Section::round(d, p)).unwrap()
        };
        let mesh = t.mesh();
        let widest = mesh.positions.iter().map(|v| Vec3::new(v.x, 0.0, v.z).length()).fold(0.0, f32::max);
        assert!((2.0 * widest - d).abs() < 1e-4 * d, "{widest}");
        for v in &mesh.positions {
            let t = (v.y - 8.0) / 10.0;
            let r = Vec3::new(v.x, 0.0, v.z).length();
            let f = if t <= p { t / p } else { (1.0 - t) / (1.0 - p) };
            assert!((r - 0.5 * d * trig::sin(0.5 * PI * f)).abs() < 2e-3 * d, "{t} {r}");
        }
    }
    // Paper 3: greatest at the middle; closed at both ends without alpha and beta, open with.
    let e = |alpha, beta| Section::of(Profile::Elliptic { horizontal: 2.0, vertical: 1.0, alpha, beta });
    assert_eq!((e(0.0, 0.0).radii(0.0), e(0.0, 0.0).radii(1.0)), ((0.0, 0.0), (0.0, 0.0)));
    assert!((e(0.0, 0.0).radii(0.5).0 - 2.0).abs() < 1e-6 && (e(0.0, 0.0).radii(0.5).1 - 1.0).abs() < 1e-6);
    assert!((e(0.5, 0.0).radii(0.0).0 - 2.0 * trig::sin(PI / 3.0)).abs() < 1e-5);
    assert!((e(0.0, 1.0).radii(1.0).0 - 2.0).abs() < 1e-5);
    // With p = 50 both papers give the same tuft.
    let (round, ellipse) = (
        Section::round(2.0, 0.5),
        Section::of(Profile::Elliptic { horizontal: 1.0, vertical: 1.0, alpha: 0.0, beta: 0.0 }),
    );
    for i in 0..=10 {
        let t = i as f32 / 10.0;
        assert!((round.radii(t).0 - ellipse.radii(t).0).abs() < 1e-5);
    }
}

#[test]
fn profiles_meet_their_points_and_never_overshoot() {
    let s = Section::of(profile(&[(0.0, 0.2, 0.1), (0.2, 3.0, 1.0), (0.7, 3.0, 0.2), (1.0, 0.0, 0.0)]));
    assert_eq!(s.radii(0.0), (0.1, 0.05));
    assert!((s.radii(0.2).0 - 1.5).abs() < 1e-5 && (s.radii(0.7).1 - 0.1).abs() < 1e-5);
    for i in 0..=100 {
        let (w, h) = s.radii(i as f32 / 100.0);
        assert!((0.0..1.5001).contains(&w) && (0.0..0.5001).contains(&h), "{i}: {w} {h}");
    }
    let sampled = Section::sampled(33, |t| (2.0 * t * (1.0 - t), t * (1.0 - t)));
    sampled.validate().unwrap();
    assert!((sampled.radii(0.5).0 - 0.25).abs() < 1e-4);
}

#[test]
fn frames_do_not_turn_and_face_away_from_the_head() {
    let t = tuft(Section::round(2.0, 0.3));
    let surface = t.surface();
    let mut turned = 0.0;
    for i in 0..400 {
        let (a, b) = (surface.sweep.at(i as f32 / 400.0), surface.sweep.at((i + 1) as f32 / 400.0));
        assert!((a.normal.length() - 1.0).abs() < 1e-4 && a.normal.dot(a.tangent).abs() < 1e-4);
        assert!(a.tangent.cross(a.normal).distance(a.binormal) < 1e-4);
        // Rotation-minimising: the normal changes along the tangent only.
        turned += (b.normal - a.normal).dot(a.binormal);
    }
    assert!(turned.abs() < 0.01, "{turned}");
    let middle = surface.sweep.at(0.6);
    assert!(middle.normal.dot(middle.centre.normalize()) > 0.7);
}

#[test]
fn the_mesh_keeps_its_tolerance() {
    for section in sections() {
        for tolerance in [0.2, 0.05] {
            let t = Tuft { detail: Detail::Tolerance(tolerance), ..tuft(section.clone()) };
            let mesh = t.mesh();
            let bvh = Bvh::new(&mesh.positions, &mesh.triangles);
            let fine = Tuft { detail: Detail::Counts { rings: 200, sides: 90 }, ..t.clone() }.mesh();
            let off =
                fine.positions.iter().filter_map(|&p| bvh.closest(p, 1e3)).map(|c| c.distance).fold(0.0, f32::max);
            assert!(off <= tolerance, "{off} > {tolerance}: {section:?}");
            assert!(mesh.triangles.len() < fine.triangles.len() / 4);
        }
    }
}

#[test]
fn finer_tolerances_keep_the_coarser_rings() {
    let t = tuft(sections()[6].clone());
    let surface = t.surface();
    let plans: Vec<Plan> = [0.5, 0.1, 0.02, 0.004].map(|e| Plan::new(&surface, Detail::Tolerance(e), 6)).into();
    for w in plans.windows(2) {
        assert!(w[0].rings.iter().all(|r| w[1].rings.contains(r)), "{:?} {:?}", w[0].rings, w[1].rings);
        assert!(w[0].sides <= w[1].sides && w[0].rings.len() < w[1].rings.len());
    }
}

#[test]
fn mirrored_tufts_are_mirror_images() {
    for section in sections() {
        let t = Tuft { detail: Detail::Counts { rings: 9, sides: 12 }, ..tuft(section) };
        let (mesh, mirrored) = (t.mesh(), t.mirrored().mesh());
        assert_eq!(mesh.positions.len(), mirrored.positions.len());
        assert!(
            (mesh.volume() - mirrored.volume()).abs() < 5e-3 * mesh.volume(),
            "{} {} {:?}",
            mesh.volume(),
            mirrored.volume(),
            t.section
        );
        for p in &mesh.positions {
            let image = Vec3::new(-p.x, p.y, p.z);
            let near = mirrored.positions.iter().map(|q| q.distance(image)).fold(f32::INFINITY, f32::min);
            assert!(near < 2e-3, "{near} for {:?}", t.section);
        }
        assert_eq!(t.mirrored().mirrored().section, t.section);
    }
}

fn many() -> Tufts {
    let tufts = sections().into_iter().enumerate().map(|(i, s)| {
        let stroke = stroke(4 + i % 5).turned(glam::Quat::from_rotation_y(i as f32));
        Tuft { detail: Detail::Counts { rings: 15, sides: 24 }, ..Tuft::new(stroke, s).unwrap() }
    });
    Tufts::new(tufts.collect(), "style.lua:3")
}

#[test]
fn the_mesh_does_not_depend_on_threads() {
    let tufts = many();
    let on = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(|| tufts.mesh());
    let one = on(1);
    assert_eq!(one, on(3));
    assert_sound(&one.mesh);
    for (i, range) in one.vertices.iter().enumerate() {
        assert!(range.clone().all(|v| one.tuft[v as usize] == i as u32));
    }
    for (range, vertices) in one.triangles.iter().zip(&one.vertices) {
        for t in &one.mesh.triangles[range.start as usize..range.end as usize] {
            assert!(t.iter().all(|v| vertices.contains(v)));
        }
    }
}

#[test]
fn atlas_islands_lie_apart() {
    let mesh = many().mesh();
    let area: f32 = mesh.islands.iter().map(|i| (i.max - i.min).element_product()).sum();
    assert!(area > 0.5, "the atlas is used: {area}");
    for (i, a) in mesh.islands.iter().enumerate() {
        assert!(a.min.min_element() >= 0.0 && a.max.max_element() <= 1.0);
        for b in &mesh.islands[..i] {
            let apart = a.min.cmpge(b.max).any() || b.min.cmpge(a.max).any();
            assert!(apart, "{a:?} {b:?}");
        }
        // v runs from root to tip.
        let uvs = &mesh.mesh.uvs[mesh.vertices[i].start as usize..mesh.vertices[i].end as usize];
        assert!(uvs.iter().all(|uv| uv.cmpge(a.min - 1e-5).all() && uv.cmple(a.max + 1e-5).all()));
    }
}

#[test]
fn a_budget_is_met_and_spent_where_it_shows() {
    let tufts = many();
    let before = tufts.triangle_count();
    for budget in [before, before / 2, before / 5] {
        let r = reduce(&tufts, &[], budget).unwrap();
        assert_eq!((r.before, r.after), (before, r.tufts.triangle_count()));
        assert!(r.after <= budget && r.after * 10 > budget * 7, "{} of {budget}", r.after);
        assert_eq!(r.tolerance.is_none(), budget == before);
        assert_sound(&r.tufts.mesh().mesh);
        assert_eq!(r.lowered.iter().map(|l| l.1 - l.2).sum::<usize>(), before - r.after);
    }
    // A thin straight tuft gives before a thick curly one does.
    let thin =
        Tuft::new(Stroke::new(vec![Vec3::Y * 9.0, Vec3::Y * 18.0], Vec3::ZERO, 1.0).unwrap(), Section::round(0.2, 0.5))
            .unwrap();
    let detail = Detail::Counts { rings: 19, sides: 40 };
    let two = Tufts::new(vec![Tuft { detail, ..thin }, Tuft { detail, ..tuft(Section::round(3.0, 0.5)) }], "");
    let counts = reduce(&two, &[], 1600).unwrap().tufts.mesh().triangles;
    assert!(counts[0].len() * 4 < counts[1].len(), "{counts:?}");
    assert!(matches!(reduce(&tufts, &[], 10), Err(TuftError::Budget { budget: 10, .. })));
}

#[test]
fn strokes_refuse_what_makes_no_line() {
    let h = Vec3::ZERO;
    let new = |p: &[Vec3]| Stroke::new(p.to_vec(), h, 1.0).unwrap_err();
    assert_eq!(new(&[]), TuftError::TooFewPoints { what: "a stroke", least: 2, count: 0 });
    assert_eq!(new(&[Vec3::X]), TuftError::TooFewPoints { what: "a stroke", least: 2, count: 1 });
    assert_eq!(new(&[Vec3::X, Vec3::Y, Vec3::Y]), TuftError::RepeatedPoint { number: 3, point: Vec3::Y });
    assert!(matches!(new(&[Vec3::X, Vec3::splat(f32::NAN)]), TuftError::NotFinite { number: 2, .. }));
    assert_eq!(new(&[h, Vec3::X]), TuftError::NoOutside { point: h });
    assert!(matches!(Stroke::new(points(3), h, 0.0), Err(TuftError::OutOfRange { what: "depth", .. })));
    assert_eq!(
        TuftError::RepeatedPoint { number: 3, point: Vec3::Y }.to_string(),
        "control points 2 and 3 are the same: `[0, 1, 0]`"
    );

    let solid = ball();
    let off = Stroke::grounded(vec![Vec3::Y * 10.5, Vec3::Y * 15.0], 1.0, &ground(&solid)).unwrap();
    assert!((off.value.root().y - 9.0).abs() < 0.01);
    assert_eq!(off.warnings[0].message, "the stroke starts `1.50` cm outside the head; it was moved to the skin");
    let on = Stroke::grounded(vec![Vec3::Y * 9.0, Vec3::Y * 15.0], 1.0, &ground(&solid)).unwrap();
    assert!(on.warnings.is_empty());
}

#[test]
fn strokes_that_turn_back_still_make_a_mesh() {
    // Straight there and back again, and a right angle far tighter than the tuft is thick.
    let back = vec![Vec3::Y * 9.0, Vec3::Y * 14.0, Vec3::Y * 10.0];
    let corner = vec![Vec3::Y * 9.0, Vec3::Y * 9.5, Vec3::new(8.0, 9.5, 0.0)];
    for points in [back, corner] {
        let t = Tuft::new(Stroke::new(points, Vec3::ZERO, 1.0).unwrap(), Section::round(4.0, 0.5)).unwrap();
        let mesh = t.mesh();
        mesh.validate().unwrap();
        assert!(mesh.normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-3));
    }
}

#[test]
fn sections_refuse_what_has_no_shape() {
    let bad = |s: Section| s.validate().unwrap_err();
    assert!(matches!(bad(Section::round(0.0, 0.5)), TuftError::OutOfRange { what: "diameter", .. }));
    assert!(matches!(bad(Section::round(1.0, f32::NAN)), TuftError::OutOfRange { what: "peak", .. }));
    assert!(matches!(bad(Section::of(profile(&[]))), TuftError::ProfileOrder { number: 1, .. }));
    assert!(matches!(bad(Section::of(profile(&[(0.0, 1.0, 1.0)]))), TuftError::ProfileOrder { number: 1, .. }));
    let unordered = profile(&[(0.0, 1.0, 1.0), (0.6, 1.0, 1.0), (0.5, 1.0, 1.0), (1.0, 0.0, 0.0)]);
    assert!(matches!(bad(Section::of(unordered)), TuftError::ProfileOrder { number: 3, .. }));
    assert!(matches!(
        bad(Section::of(profile(&[(0.0, 1.0, 1.0), (0.9, 1.0, 1.0)]))),
        TuftError::ProfileOrder { number: 2, .. }
    ));
    assert_eq!(bad(Section::of(profile(&[(0.0, 1.0, 0.0), (1.0, 1.0, 0.0)]))), TuftError::NoSize { what: "thickness" });
    let split = Some(Split { tips: 1, from: 0.5, spread: 0.0 });
    assert!(matches!(bad(Section { split, ..Section::round(1.0, 0.5) }), TuftError::OutOfRange { what: "tips", .. }));
}
