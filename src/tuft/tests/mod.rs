//! Laws of tufts, and what bad input gives.

mod fill;
mod pieces;
mod shape;
mod tables;

use std::collections::BTreeMap;
use std::f32::consts::{PI, TAU};

use glam::Vec3;

use super::*;
use crate::geometry::bvh::tests::sphere;
use crate::geometry::{Bvh, Mesh, Solid};
use crate::math::trig;
use crate::params::{self, Params, Table, Value};
use crate::task::Task;
use crate::tuft::detail::Plan;
use crate::tuft::fill::{count_around, distance_around, grows_hair, row_step};
use crate::tuft::stroke::derivative;

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

/// A tuft that falls from a root at (azimuth, elevation) on the ball.
fn falling(azimuth: f32, elevation: f32, diameter: f32) -> Tuft {
    let root = toward(azimuth, elevation) * RADIUS;
    let out = toward(azimuth, 0.0);
    let points = vec![root, root + out * 3.0 - Vec3::Y, root + out * 4.0 - Vec3::Y * 6.0];
    Tuft::new(Stroke::new(points, Vec3::ZERO, 1.0).unwrap(), Section::round(diameter, 0.3)).unwrap()
}
