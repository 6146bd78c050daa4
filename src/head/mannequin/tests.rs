//! Laws of both mannequins: closed, outward, mirrored, evenly meshed, with landmarks where a head has them.

use std::collections::BTreeMap;

use glam::Vec3;

use super::*;

const STYLES: [Style; 2] = [Style::Adult, Style::Cartoon];

/// Bits of a place, with one zero.
fn bits(p: Vec3) -> [u32; 3] {
    (p + Vec3::ZERO).to_array().map(f32::to_bits)
}

/// Distance from a point to a triangle: to its plane above the inside, else to the nearest edge.
fn distance_to_triangle(p: Vec3, [a, b, c]: [Vec3; 3]) -> f32 {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let n = ab.cross(ac);
    let (u, v) = (ap.cross(ac).dot(n) / n.dot(n), ab.cross(ap).dot(n) / n.dot(n));
    if u >= 0.0 && v >= 0.0 && u + v <= 1.0 {
        return (ap.dot(n) / n.length()).abs();
    }
    let edge = |a: Vec3, b: Vec3| {
        let t = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
        p.distance(a + (b - a) * t)
    };
    edge(a, b).min(edge(b, c)).min(edge(c, a))
}

fn mark(style: Style, name: &str) -> Vec3 {
    landmarks(style).into_iter().find(|l| l.0 == name).map(|l| l.1).expect("a landmark")
}

#[test]
fn closed_outward_and_of_the_size_of_a_head() {
    for style in STYLES {
        let mesh = mesh(style);
        mesh.validate().unwrap();
        assert!((12_000..=25_000).contains(&mesh.triangles.len()), "{style:?}: {}", mesh.triangles.len());
        let weld = mesh.weld();
        let mut edges: BTreeMap<(u32, u32), i32> = BTreeMap::new();
        for t in &mesh.triangles {
            let t = t.map(|v| weld[v as usize]);
            for k in 0..3 {
                assert!(edges.insert((t[k], t[(k + 1) % 3]), 1).is_none(), "{style:?}: an edge twice in one direction");
            }
        }
        for &(a, b) in edges.keys() {
            assert!(edges.contains_key(&(b, a)), "{style:?}: an open edge at {}", mesh.positions[a as usize]);
        }
        // One component of genus 0: V - E + F = 2.
        let vertices = weld.iter().enumerate().filter(|&(i, &w)| i as u32 == w).count() as i64;
        assert_eq!(vertices - edges.len() as i64 / 2 + mesh.triangles.len() as i64, 2, "{style:?}");
        let volume = mesh.volume();
        assert!((3500.0..9000.0).contains(&volume), "{style:?}: {volume}");
    }
}

#[test]
fn one_piece() {
    for style in STYLES {
        let mesh = mesh(style);
        let weld = mesh.weld();
        let mut root: Vec<u32> = (0..weld.len() as u32).collect();
        fn find(root: &mut [u32], mut v: u32) -> u32 {
            while root[v as usize] != v {
                root[v as usize] = root[root[v as usize] as usize];
                v = root[v as usize];
            }
            v
        }
        for t in &mesh.triangles {
            let a = find(&mut root, weld[t[0] as usize]);
            for &v in &t[1..] {
                let b = find(&mut root, weld[v as usize]);
                root[b as usize] = a;
            }
        }
        let first = find(&mut root, weld[0]);
        assert!(weld.iter().all(|&w| find(&mut root, w) == first));
    }
}

#[test]
fn left_and_right_are_mirror_images_to_the_bit() {
    for style in STYLES {
        let mesh = mesh(style);
        let mirror = |p: Vec3| Vec3::new(-p.x, p.y, p.z);
        let sorted = |flip: bool| {
            let mut all: Vec<_> = mesh
                .triangles
                .iter()
                .map(|t| {
                    let mut corners = t.map(|v| {
                        let (p, n) = (mesh.positions[v as usize], mesh.normals[v as usize]);
                        if flip { (bits(mirror(p)), bits(mirror(n))) } else { (bits(p), bits(n)) }
                    });
                    corners.sort_unstable();
                    corners
                })
                .collect();
            all.sort_unstable();
            all
        };
        assert!(sorted(false) == sorted(true), "{style:?}");
    }
}

#[test]
fn triangles_are_well_shaped() {
    for style in STYLES {
        let mesh = mesh(style);
        let (mut sharp, mut folded) = (0, 0);
        for t in 0..mesh.triangles.len() {
            let p = mesh.corners(t);
            let area = mesh.area_vector(t).length() / 2.0;
            let angle = (0..3)
                .map(|k| (p[(k + 1) % 3] - p[k]).angle_between(p[(k + 2) % 3] - p[k]).to_degrees())
                .fold(180.0, f32::min);
            assert!(area > 4e-3 && angle > 4.0, "{style:?}: area {area}, angle {angle} at {}", p[0]);
            sharp += usize::from(angle < 15.0);
            let normal: Vec3 = mesh.triangles[t].iter().map(|&v| mesh.normals[v as usize]).sum();
            folded += usize::from(mesh.area_vector(t).dot(normal) <= 0.0);
        }
        assert!(sharp * 100 < mesh.triangles.len() * 5, "{style:?}: {sharp} triangles sharper than 15 degrees");
        assert_eq!(folded, 0, "{style:?}: triangles against their normals");
    }
}

#[test]
fn texture_and_groups_cover_everything_once() {
    for style in STYLES {
        let mesh = mesh(style);
        assert_eq!(mesh.uvs.len(), mesh.positions.len());
        assert!(mesh.uvs.iter().all(|uv| (0.0..=1.0).contains(&uv.x) && (0.0..=1.0).contains(&uv.y)));
        for t in &mesh.triangles {
            let u = t.map(|v| mesh.uvs[v as usize].x);
            let width = u.iter().copied().fold(0.0, f32::max) - u.iter().copied().fold(1.0, f32::min);
            assert!(width <= 0.26, "{style:?}: a triangle across the seam");
        }
        let mut seen = vec![0; mesh.triangles.len()];
        for group in &mesh.groups {
            assert!(group.triangles.is_sorted() && group.triangles.len() > 100, "{style:?}: {}", group.name);
            for &t in &group.triangles {
                seen[t as usize] += 1;
            }
        }
        assert!(seen.iter().all(|&n| n == 1));
        let names: Vec<&str> = mesh.groups.iter().map(|g| g.name.as_str()).collect();
        assert_eq!(names, ["ear_left", "ear_right", "face", "head", "neck", "shoulders"]);
        for (name, sign) in [("ear_left", 1.0), ("ear_right", -1.0)] {
            let group = mesh.group(name).unwrap();
            assert!(group.triangles.iter().all(|&t| mesh.corners(t as usize).iter().all(|p| p.x * sign > 4.0)));
        }
    }
}

#[test]
fn normals_are_unit_and_face_outward_at_the_extremes() {
    for style in STYLES {
        let mesh = mesh(style);
        assert!(mesh.normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-4));
        let top =
            (0..mesh.positions.len()).max_by(|&a, &b| mesh.positions[a].y.total_cmp(&mesh.positions[b].y)).unwrap();
        assert!(mesh.normals[top].y > 0.95);
    }
}

#[test]
fn fields_have_no_jumps() {
    for style in STYLES {
        let form = form(style);
        let mesh = mesh(style);
        for (i, (&p, &n)) in mesh.positions.iter().zip(&mesh.normals).enumerate().filter(|(_, (p, _))| p.x >= 0.0) {
            // Along a line through the surface, slanted differently at every vertex.
            let slant = (i as f32 * 0.618).fract();
            let along = n.any_orthonormal_vector() * slant + n * (1.0 - slant);
            for k in -40..40 {
                let [mut a, mut b] = [k, k + 1].map(|k| p + along * (k as f32 * 0.05));
                if a.x < 0.0 || b.x < 0.0 {
                    continue;
                }
                // A steep place is none: a jump stays when it is looked at closely.
                let change = |a, b| ((form.distance)(a) - (form.distance)(b)).abs();
                while change(a, b) > 2.0 * a.distance(b) && a.distance(b) > 1e-3 {
                    let middle = (a + b) / 2.0;
                    (a, b) = if change(a, middle) > change(middle, b) { (a, middle) } else { (middle, b) };
                }
                assert!(
                    change(a, b) < (2.0 * a.distance(b)).max(0.02),
                    "{style:?}: from {a} to {b} by {}",
                    change(a, b)
                );
            }
        }
    }
}

#[test]
fn landmarks_lie_on_the_surface() {
    for style in STYLES {
        let mesh = mesh(style);
        for (name, p) in landmarks(style) {
            let nearest =
                (0..mesh.triangles.len()).map(|t| distance_to_triangle(p, mesh.corners(t))).fold(f32::MAX, f32::min);
            assert!(nearest < 0.2, "{style:?}: {name} at {p} is {nearest} cm from the mesh");
        }
    }
}

#[test]
fn landmarks_stand_as_on_a_head() {
    for style in STYLES {
        let at = |name| mark(style, name);
        let (left, right) = (at("left_ear"), at("right_ear"));
        assert_eq!((left.x, left.y, left.z), (-right.x, right.y, right.z));
        assert_eq!(left + right, Vec3::ZERO, "the origin is the middle between the ears");
        assert!(left.x > 5.0, "left is +x");
        let heights = ["vertex", "forehead", "left_temple", "left_ear", "nape", "chin"].map(|n| at(n).y);
        assert!(heights.is_sorted_by(|a, b| a > b), "{style:?}: {heights:?}");
        let depths = ["forehead", "left_temple", "left_ear", "nape", "occiput"].map(|n| at(n).z);
        assert!(depths.is_sorted_by(|a, b| a > b), "{style:?}: {depths:?}");
        assert!(at("chin").z > left.z && at("left_temple").x > 4.0);
        for middle in ["vertex", "forehead", "occiput", "nape", "chin"] {
            assert_eq!(at(middle).x, 0.0);
        }
    }
}

#[test]
fn the_adult_has_the_measures_of_an_adult() {
    let mesh = mesh(Style::Adult);
    let height = mark(Style::Adult, "vertex").y - mark(Style::Adult, "chin").y;
    assert!((height - 23.0).abs() < 0.1, "chin to vertex {height}");
    let skull: Vec<Vec3> = mesh.positions.iter().copied().filter(|p| p.y > 4.5).collect();
    let breadth = 2.0 * skull.iter().map(|p| p.x).fold(0.0, f32::max);
    assert!((breadth - 15.5).abs() < 0.4, "breadth {breadth}");
    let glabella =
        mesh.positions.iter().filter(|p| p.x == 0.0 && (2.5..4.0).contains(&p.y)).map(|p| p.z).fold(0.0, f32::max);
    let length = glabella - skull.iter().map(|p| p.z).fold(0.0, f32::min);
    assert!((length - 19.5).abs() < 0.5, "length {length}");
}

#[test]
fn the_same_bytes_on_any_number_of_threads() {
    for style in STYLES {
        let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap().install(|| mesh(style));
        let three = rayon::ThreadPoolBuilder::new().num_threads(3).build().unwrap().install(|| mesh(style));
        assert!(one == three, "{style:?}");
    }
}
