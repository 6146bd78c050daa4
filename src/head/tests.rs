//! Laws of heads, tried on a head made of ellipsoids.

use std::collections::BTreeMap;

use glam::{Affine3A, Quat, Vec3};

use super::*;
use crate::geometry::Group;
use crate::task::Task;

/// (centre, radii) of what the test head is made of: skull, jaw, chin, nose, ears.
const PARTS: [(Vec3, Vec3); 6] = [
    (Vec3::new(0.0, 2.5, -1.0), Vec3::new(7.3, 9.5, 9.3)),
    (Vec3::new(0.0, -4.0, 2.5), Vec3::new(5.5, 7.3, 6.5)),
    (Vec3::new(0.0, -9.5, 6.3), Vec3::new(2.0, 2.0, 2.2)),
    (Vec3::new(0.0, -2.5, 9.3), Vec3::new(1.4, 2.2, 2.0)),
    (Vec3::new(7.4, 0.0, -0.7), Vec3::new(1.5, 3.1, 1.8)),
    (Vec3::new(-7.4, 0.0, -0.7), Vec3::new(1.5, 3.1, 1.8)),
];

/// A closed head with a neck, mirror-symmetric about x = 0, in its own head space but for the ears' exact middle.
pub(super) fn mesh(rings: usize) -> Mesh {
    let mut mesh = crate::geometry::bvh::tests::sphere(rings, 1.0);
    let centre = Vec3::new(0.0, 1.0, -1.0);
    let inside = |p: Vec3| {
        let neck = p.y > -20.0 && p.y < -4.0 && (p - Vec3::new(0.0, p.y, -2.5)).length() < 5.4;
        neck || PARTS.iter().any(|(c, r)| ((p - c) / r).length() < 1.0)
    };
    for p in &mut mesh.positions {
        // The outermost surface in this direction.
        let direction = *p;
        let mut out = 30.0_f32;
        while out > 0.1 && !inside(centre + direction * out) {
            out -= 0.1;
        }
        let (mut lo, mut hi) = (out, out + 0.1);
        for _ in 0..12 {
            let mid = (lo + hi) * 0.5;
            *(if inside(centre + direction * mid) { &mut lo } else { &mut hi }) = mid;
        }
        *p = centre + direction * lo;
    }
    mesh.uvs = mesh.positions.iter().map(|p| Vec2::new(p.x * 0.03 + 0.5, p.y * 0.02 + 0.5)).collect();
    mesh.groups.push(Group { name: "crown".into(), triangles: (0..60).collect() });
    mesh
}

fn moved(mesh: &Mesh, by: &Affine3A) -> Mesh {
    let mut mesh = mesh.clone();
    mesh.positions.iter_mut().for_each(|p| *p = by.transform_point3(*p));
    mesh
}

fn head(mesh: Mesh) -> Head {
    Head::from_mesh(mesh, "test", &BTreeMap::new()).unwrap().value
}

fn test_head() -> &'static Head {
    static HEAD: std::sync::OnceLock<Head> = std::sync::OnceLock::new();
    HEAD.get_or_init(|| head(mesh(90)))
}

fn near(a: Vec3, b: Vec3, limit: f32, what: &str) {
    assert!(a.distance(b) < limit, "{what}: {a} is {:.2} from {b}", a.distance(b));
}

#[test]
fn landmarks_lie_where_the_shape_says() {
    let head = test_head();
    let m = head.placement;
    let own = head.landmarks.transformed(&m);
    near(own.vertex, Vec3::new(0.0, 12.0, -1.0), 0.6, "vertex");
    near(own.chin, Vec3::new(0.0, -10.9, 7.8), 0.5, "chin");
    near(own.occiput, Vec3::new(0.0, 2.5, -10.3), 0.7, "occiput");
    assert!((own.left_ear.y).abs() < 0.6 && (own.left_ear.z + 0.3).abs() < 1.2, "{}", own.left_ear);
    assert!(own.left_ear.x > 7.3);
    assert!((6.0..9.5).contains(&own.forehead.y) && own.forehead.z > 5.0, "{}", own.forehead);
    assert!((-12.0..-6.0).contains(&own.nape.y) && own.nape.z < -5.0, "{}", own.nape);
    assert!((head.scale - 1.0).abs() < 0.03, "{}", head.scale);
}
