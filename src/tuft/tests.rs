//! Laws of tufts, and what bad input gives.

use std::collections::BTreeMap;
use std::f32::consts::{PI, TAU};

use glam::Vec3;

use super::detail::Plan;
use super::fill::{count_around, distance_around, grows_hair, row_step};
use super::stroke::derivative;
use super::*;
use crate::geometry::bvh::tests::sphere;
use crate::geometry::{Bvh, Mesh, Solid};
use crate::math::trig;
use crate::params::{self, Params, Table, Value};
use crate::task::Task;

const RADIUS: f32 = 9.0;

fn ball() -> Solid {
    Solid::new(&sphere(48, RADIUS)).unwrap()
}

fn ground(solid: &Solid) -> Ground<'_> {
    Ground { solid, reference: Vec3::ZERO, scale: 1.0 }
}

/// From the top of a ball over its side, hanging free at the end.
fn points(n: usize) -> Vec<Vec3> {
    (0..n)
        .map(|i| {
            let s = i as f32 / (n - 1) as f32;
            let out = toward(0.3 + 0.4 * s, 0.9 - 1.3 * s);
            out * (RADIUS + 2.5 * trig::sin(s * PI).max(0.0) + 0.8 * s)
        })
        .collect()
}

fn stroke(n: usize) -> Stroke {
    Stroke::new(points(n), Vec3::ZERO, 1.0).unwrap()
}

fn tuft(section: Section) -> Tuft {
    Tuft::new(stroke(6), section).unwrap()
}

fn profile(places: &[(f32, f32, f32)]) -> Profile {
    Profile::Points(places.iter().map(|&(t, width, thickness)| ProfilePoint { t, width, thickness }).collect())
}

/// Every kind of section, with and without all wishes.
fn sections() -> Vec<Section> {
    let round = Section::round(2.5, 0.3);
    let ellipse = |alpha, beta| Section::of(Profile::Elliptic { horizontal: 1.5, vertical: 0.5, alpha, beta });
    let points = Section::of(profile(&[(0.0, 0.5, 0.3), (0.4, 3.0, 0.8), (0.9, 1.5, 0.6), (1.0, 0.0, 0.0)]));
    let mut all = vec![round.clone(), ellipse(0.0, 0.0), ellipse(0.3, 0.4), points, Section::round(2.0, 1.0)];
    for base in all.clone() {
        all.push(Section { flatten: 0.7, twist: 2.5, ..base.clone() });
        all.push(Section { bend: 2.0, flatten: 0.6, ..base.clone() });
        for tips in [2, 3, 5] {
            all.push(Section { split: Some(Split { tips, from: 0.6, spread: 0.6 }), bend: -0.8, ..base.clone() });
        }
    }
    all
}

/// Closed and manifold, facing outward, one normal to a place.
#[track_caller]
fn assert_sound(mesh: &Mesh) {
    assert_closed(mesh);
    assert!(mesh.volume() > 0.0, "volume {}", mesh.volume());
}

#[track_caller]
fn assert_closed(mesh: &Mesh) {
    mesh.validate().unwrap();
    assert_eq!((mesh.normals.len(), mesh.uvs.len()), (mesh.positions.len(), mesh.positions.len()));
    let weld = mesh.weld();
    let mut edges: BTreeMap<(u32, u32), i32> = BTreeMap::new();
    for t in &mesh.triangles {
        let t = t.map(|v| weld[v as usize]);
        assert!(t[0] != t[1] && t[1] != t[2] && t[2] != t[0], "a triangle without area");
        for k in 0..3 {
            *edges.entry((t[k], t[(k + 1) % 3])).or_default() += 1;
        }
    }
    for (&(a, b), &n) in &edges {
        assert_eq!(
            (n, edges.get(&(b, a))),
            (1, Some(&1)),
            "edge {} {}",
            mesh.positions[a as usize],
            mesh.positions[b as usize]
        );
    }
    for (v, n) in mesh.normals.iter().enumerate() {
        assert!((n.length() - 1.0).abs() < 1e-4, "normal {n}");
        assert_eq!(*n, mesh.normals[weld[v] as usize], "one place, two normals: an outline would tear");
    }
    assert!(mesh.uvs.iter().all(|uv| uv.min_element() >= -1e-6 && uv.max_element() <= 1.0 + 1e-6));
}

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

/// A tuft that falls from a root at (azimuth, elevation) on the ball.
fn falling(azimuth: f32, elevation: f32, diameter: f32) -> Tuft {
    let root = toward(azimuth, elevation) * RADIUS;
    let out = toward(azimuth, 0.0);
    let points = vec![root, root + out * 3.0 - Vec3::Y, root + out * 4.0 - Vec3::Y * 6.0];
    Tuft::new(Stroke::new(points, Vec3::ZERO, 1.0).unwrap(), Section::round(diameter, 0.3)).unwrap()
}

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

fn table(fields: &[(&str, Value)]) -> Table {
    Table { items: vec![], fields: fields.iter().map(|(k, v)| ((*k).to_owned(), v.clone())).collect() }
}

fn list(items: Vec<Value>) -> Value {
    Value::Table(Table { items, ..Table::default() })
}

#[test]
fn tables_become_tufts() {
    let solid = ball();
    let line = list(vec![Value::Vector(Vec3::Y * 9.0), Value::Vector(Vec3::Y * 15.0)]);
    let read = |more: &[(&str, Value)]| {
        let mut fields = vec![("stroke", line.clone())];
        fields.extend_from_slice(more);
        params::read::<TuftOptions>(&table(&fields))
    };
    let built = read(&[("diameter", Value::Number(25.0)), ("peak", Value::Number(80.0))]).unwrap();
    let t = built.build(&ground(&solid)).unwrap().value;
    assert_eq!(t.section.profile, Profile::Round { diameter: 2.5, peak: 0.8 });
    for (field, bad) in [("diameter", 0.5), ("diameter", 101.0), ("peak", 0.0), ("peak", 100.5)] {
        let problems = read(&[(field, Value::Number(bad))]).unwrap_err();
        assert_eq!(
            (problems[0].path.as_str(), problems[0].message.clone()),
            (field, format!("`{bad}` is out of range"))
        );
    }
    assert!(params::read::<FillOptions>(&table(&[("up", Value::Number(0.0))])).is_err());
    let row = |a: f64, b: f64, c: f64| list([a, b, c].map(Value::Number).to_vec());
    let sizes = list(vec![row(0.0, 1.0, 0.5), row(0.5, 2.0, 1.0), row(1.0, 0.0, 0.0)]);
    let profile = read(&[("profile", sizes.clone()), ("tips", Value::Number(2.0))]).unwrap();
    assert_eq!(profile.section().unwrap().split.map(|s| s.tips), Some(2));
    let radii = [("horizontal", Value::Number(1.0)), ("vertical", Value::Number(0.5))];
    let both = read(&[("profile", sizes), ("ellipse", Value::Table(table(&radii)))]).unwrap();
    assert_eq!(both.section().unwrap_err(), TuftError::Exclusive { first: "ellipse", second: "profile" });
    let rings = read(&[("rings", Value::Number(5.0))]).unwrap();
    assert_eq!(rings.detail().unwrap_err(), TuftError::RingsWithoutSides);
    // Every description can be read back from nothing but its required fields.
    assert!(FillOptions::fields().iter().all(|f| !f.is_required()));
    assert!(RingOptions::fields().iter().filter(|f| f.is_required()).map(|f| f.name).eq(["at"]));
}

#[test]
fn ids_are_unique_and_stable() {
    let t = tuft(Section::round(2.0, 0.3));
    let twice = Tufts::new(vec![t.clone(), t.clone(), t.clone()], "a");
    twice.validate().unwrap();
    assert_eq!(twice.tufts[0].id, t.id);
    let mut all = Tufts::new(vec![t.clone()], "b");
    all.extend(&twice);
    all.validate().unwrap();
    assert_eq!((all.sources.len(), all.tufts[3].source), (2, 1));
    assert_eq!(Tufts::default().mesh().mesh, Mesh::default());
}
