//! Laws of regions, roots and partings, on the head of [`super::tests`].

use std::collections::BTreeSet;
use std::sync::Arc;

use glam::{Vec2, Vec3};

use super::tests::test_head;
use super::*;
use crate::math::rng::Key;
use crate::task::Task;

fn places(count: usize) -> Vec<Sample> {
    let key = Key::new(7, "test places");
    (0..count).map(|i| test_head().patch().stratified(i, count, key)).collect()
}

fn grow(region: &Region, count: usize) -> Vec<Root> {
    roots(test_head(), region, count, 1, &Task::new()).unwrap()
}

fn ids(roots: &[Root]) -> BTreeSet<u64> {
    roots.iter().map(|r| r.id).collect()
}

/// A cap around the vertex.
fn cap(radius: f32) -> Region {
    let head = test_head();
    let ring: Vec<Vec3> = (0..12)
        .map(|i| {
            let a = std::f32::consts::TAU * i as f32 / 12.0;
            let (x, z) = (crate::math::trig::cos(a), crate::math::trig::sin(a));
            head.landmarks.vertex + Vec3::new(x, 0.0, z) * radius
        })
        .collect();
    Region::polygon(head, &ring, true).unwrap()
}

/// Left of the middle, as a density that grows to the left.
fn slope() -> Region {
    let head = test_head();
    let values = Region::sample_points(head).iter().map(|r| (0.5 + r.position.x / 20.0).clamp(0.0, 1.0)).collect();
    Region::sampled(head, values, false).unwrap()
}

#[test]
fn the_scalp_is_where_hair_grows() {
    let head = test_head();
    let scalp = head.scalp();
    let m = &head.landmarks;
    let at = |p: Vec3| scalp.contains(head, &head.closest(p));
    for (name, p) in [
        ("vertex", m.vertex),
        ("occiput", m.occiput),
        ("above the forehead", m.forehead + Vec3::new(0.0, 1.5, -1.0)),
        ("above the nape", m.nape + Vec3::Y),
        ("above the ear", m.left_ear + Vec3::new(0.0, 5.0, -1.0)),
        ("behind the ear", m.right_ear + Vec3::new(0.5, 0.5, -4.5)),
        ("behind the temple", m.left_temple - Vec3::Z * 1.5),
    ] {
        assert!(at(p), "{name}");
    }
    for (name, p) in [
        ("chin", m.chin),
        ("brow", m.forehead - Vec3::new(0.0, 2.0, -1.0)),
        ("cheek", Vec3::new(5.0, -4.0, 6.0)),
        ("left ear", m.left_ear),
        ("right ear", m.right_ear),
        ("neck", m.nape - Vec3::Y * 2.0),
        ("throat", Vec3::new(0.0, -14.0, 3.0)),
    ] {
        assert!(!at(p), "{name}");
    }
    // Young adults have 600 to 750 cm2.
    let area = scalp.area(head);
    assert!((450.0..900.0).contains(&area), "{area}");
    // The head and its outline are symmetric.
    let left = scalp.and(&Region::sampled_left(head, true)).area(head);
    let right = scalp.and(&Region::sampled_left(head, false)).area(head);
    assert!((left - right).abs() < 0.02 * area, "{left} {right}");
}

impl Region {
    fn sampled_left(head: &Head, left: bool) -> Self {
        let values = Self::sample_points(head).iter().map(|r| f32::from((r.position.x > 0.0) == left)).collect();
        Self::sampled(head, values, true).unwrap()
    }
}

#[test]
fn sets_obey_the_algebra_of_sets() {
    let head = test_head();
    let regions = [head.scalp(), cap(5.0), slope(), Region::everything(), Region::group(head, "crown").unwrap()];
    for s in places(600) {
        let d = |r: &Region| r.density(head, &s);
        for a in &regions {
            assert!((d(&a.complement().complement()) - d(a)).abs() < 1e-6);
            assert_eq!(d(&a.or(a)), d(a));
            for b in &regions {
                assert_eq!(d(&a.or(b)), d(&b.or(a)));
                assert_eq!(d(&a.and(b).complement()), d(&a.complement().or(&b.complement())));
                assert_eq!(d(&a.minus(b)), d(&a.and(&b.complement())));
                assert!((0.0..=1.0).contains(&d(&a.times(b))) && d(&a.times(b)) <= d(&a.and(b)));
            }
        }
        let crisp = &regions[1];
        assert!(!crisp.and(&crisp.complement()).contains(head, &s) && crisp.or(&crisp.complement()).contains(head, &s));
    }
}

#[test]
fn lower_counts_are_subsets_and_guides_are_members() {
    let scalp = test_head().scalp();
    let members = grow(&scalp, 5000);
    for count in [1, 17, 800, 4999] {
        let fewer = grow(&scalp, count);
        assert_eq!(fewer, members[..count]);
    }
    assert_eq!(ids(&members).len(), 5000);
    // Another seed is another set.
    let other = roots(test_head(), &scalp, 800, 2, &Task::new()).unwrap();
    assert!(ids(&other).is_disjoint(&ids(&members)));
}

#[test]
fn a_growing_region_keeps_its_roots() {
    let head = test_head();
    let (small, large) = (cap(4.0), cap(8.0));
    let many = grow(&large, 3000);
    let within: Vec<Root> = many.iter().filter(|r| small.contains(head, &head.closest(r.position))).copied().collect();
    assert!(within.len() > 300);
    // The small region's first roots are those of the large one that lie in it.
    assert_eq!(grow(&small, within.len()), within);
}

#[test]
fn more_density_only_adds() {
    let head = test_head();
    let scalp = head.scalp();
    let thin = grow(&scalp.thinned(0.3), 900);
    let last = thin.last().unwrap().id;
    let mut fuller = grow(&scalp.thinned(0.6), 2400);
    let end = fuller.iter().position(|r| r.id == last).unwrap();
    fuller.truncate(end + 1);
    assert!(ids(&thin).is_subset(&ids(&fuller)));
    let share = thin.len() as f32 / fuller.len() as f32;
    assert!((share - 0.5).abs() < 0.06, "{share}");
}

#[test]
fn roots_follow_the_density() {
    let head = test_head();
    let region = slope().and(&cap(6.0));
    let roots = grow(&region, 4000);
    let expected: f64 = {
        let (mut mass, mut moment) = (0.0, 0.0);
        for s in places(200_000) {
            let d = f64::from(region.density(head, &s));
            mass += d;
            moment += d * f64::from(s.position.x);
        }
        moment / mass
    };
    let mean = roots.iter().map(|r| f64::from(r.position.x)).sum::<f64>() / roots.len() as f64;
    // Standard error: a spread of 3 cm over the root of 4000.
    assert!((mean - expected).abs() < 0.15 && expected > 0.3, "{mean} {expected}");
    let dense = roots_by_density(head, &cap(4.0), 10.0, 1, &Task::new()).unwrap();
    let area = cap(4.0).area(head);
    assert!((dense.len() as f64 - 10.0 * area).abs() < 2.0, "{} on {area}", dense.len());
    // Somewhat less than pi r^2: the ring was laid on the narrow skull below it.
    assert!((36.0..50.0).contains(&area), "{area}");
}

#[test]
fn roots_lie_on_the_skin_with_its_normal() {
    let head = test_head();
    for r in grow(&head.scalp(), 500) {
        assert!(head.solid.signed_distance(r.position).abs() < 1e-3);
        assert!((r.normal.length() - 1.0).abs() < 1e-5);
        let face = head.mesh.area_vector(r.triangle as usize).normalize();
        assert!(r.normal.dot(face) > 0.5, "{} {face}", r.normal);
        let uv =
            (head.placement.transform_point3(r.position) * Vec3::new(0.03, 0.02, 0.0)).truncate() + Vec2::splat(0.5);
        assert!(r.uv.distance(uv) < 1e-3);
        assert!(
            (r.id == head.closest(r.position).id()) || head.closest(r.position).position.distance(r.position) < 1e-3
        );
    }
}

#[test]
fn threads_change_nothing() {
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let head = Head::with_landmarks((*test_head().mesh).clone(), "again", test_head().landmarks).unwrap();
            (roots(&head, &head.scalp(), 3000, 5, &Task::new()).unwrap(), head.scalp().area(&head))
        })
    };
    assert_eq!(run(1), run(4));
}

#[test]
fn counts_that_make_no_sense_are_refused() {
    let head = test_head();
    let task = Task::new();
    let scalp = head.scalp();
    assert_eq!(roots(head, &scalp, 0, 1, &task), Err(RootsError::Zero));
    let error = roots(head, &scalp, MOST_ROOTS + 1, 1, &task).unwrap_err();
    assert!(error.to_string().contains("GB"), "{error}");
    assert!(matches!(roots(head, &cap(0.2), 1_000_000, 1, &task), Err(RootsError::TooDense { .. })));
    let nothing = scalp.minus(&scalp);
    assert_eq!(roots(head, &nothing, 10, 1, &task), Err(RootsError::Empty));
    assert_eq!(nothing.check(head), Err(RegionError::Empty));
    assert_eq!(roots_by_density(head, &nothing, 10.0, 1, &task), Err(RootsError::Empty));
    for density in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        assert!(matches!(roots_by_density(head, &scalp, density, 1, &task), Err(RootsError::BadDensity { .. })));
    }
    task.cancel();
    assert_eq!(roots(head, &scalp, 10, 99, &task), Err(RootsError::Cancelled(crate::task::Cancelled)));
}

#[test]
fn bad_regions_say_why() {
    let head = test_head();
    assert!(matches!(Region::polygon(head, &[Vec3::Y, Vec3::X], false), Err(RegionError::TooFewPoints { count: 2 })));
    let bad = [Vec3::Y, Vec3::X, Vec3::NAN];
    assert!(matches!(Region::polygon(head, &bad, false), Err(RegionError::PointNotFinite { index: 3, .. })));
    let error = Region::group(head, "crwn").unwrap_err();
    assert_eq!(error.hint().as_deref(), Some("did you mean `crown`?"));
    assert!(matches!(Region::sampled(head, vec![1.0], true), Err(RegionError::ValueCount { count: 1, .. })));
    let count = Region::sample_points(head).len();
    assert!(matches!(Region::sampled(head, vec![1.5; count], true), Err(RegionError::BadDensity { .. })));
    assert!(matches!(Region::sampled(head, vec![f32::NAN; count], true), Err(RegionError::BadDensity { .. })));
    let wrong = Arc::new(Mask { width: 2, height: 2, values: vec![] });
    assert!(matches!(Region::mask(head, wrong), Err(RegionError::BadMask { .. })));
}

#[test]
fn a_mask_and_a_predicate_agree() {
    let head = test_head();
    // The right half of the picture is u > 0.5, which is x > 0 on the test head's uv.
    let values = (0..64 * 64).map(|i| f32::from(i % 64 >= 32)).collect();
    let mask = Region::mask(head, Arc::new(Mask { width: 64, height: 64, values })).unwrap();
    let half = Region::sampled_left(head, true);
    for s in places(2000).iter().filter(|s| s.position.x.abs() > 0.9) {
        assert_eq!(mask.density(head, s), half.density(head, s), "{s:?}");
    }
}

#[test]
fn a_parting_parts_left_from_right() {
    let head = test_head();
    let m = &head.landmarks;
    let parting = Parting::new(head, &[m.forehead, m.vertex, m.occiput]).unwrap();
    // It lies on the skin.
    for p in parting.curtain.line() {
        assert!(head.solid.signed_distance(*p).abs() < 1e-2, "{p}");
    }
    let roots = grow(&head.scalp(), 400);
    let (mut parted, mut joined) = (0, 0);
    for (i, a) in roots.iter().enumerate() {
        if a.position.x.abs() > 0.3 && a.position.y > m.occiput.y {
            assert_eq!(parting.side(a.position), a.position.x.signum(), "{}", a.position);
        }
        for b in roots[..i].iter().filter(|b| b.position.distance(a.position) < 4.0) {
            let across = a.position.x * b.position.x < 0.0;
            let low =
                a.position.y.min(b.position.y) < m.occiput.y + 1.0 || a.position.x.abs().min(b.position.x.abs()) < 0.1;
            if !low {
                assert_eq!(parting.separates(a.position, b.position), across, "{} {}", a.position, b.position);
                *(if across { &mut parted } else { &mut joined }) += 1;
            }
        }
    }
    assert!(parted > 50 && joined > 500, "{parted} {joined}");
    assert!(matches!(Parting::new(head, &[m.vertex]), Err(PartingError::TooFewPoints { count: 1 })));
    assert!(matches!(Parting::new(head, &[m.vertex, Vec3::NAN]), Err(PartingError::PointNotFinite { index: 2, .. })));
}
