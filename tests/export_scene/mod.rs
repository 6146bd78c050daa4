//! A small scene for the tests of exporters: a ball with hair.

#![allow(dead_code, reason = "not every test file uses everything")]

use std::sync::Arc;

use coif::geometry::{Mesh, Root, Strands};
use coif::math::{rng::Key, trig};
use coif::scene::{Body, Hair, HairMaterial, Look, MeshMaterial, Overlay, Part, Scene, Shown, View};
use glam::{Affine3A, Quat, Vec2, Vec3};

/// Radius of the ball.
pub const RADIUS: f32 = 9.0;

/// A ball with a seam in its uv.
pub fn ball() -> Mesh {
    let (rows, columns) = (12_u32, 24_u32);
    let mut mesh = Mesh::default();
    for r in 0..=rows {
        for c in 0..=columns {
            let (u, v) = (c as f32 / columns as f32, r as f32 / rows as f32);
            let (a, b) = (u * std::f32::consts::TAU, v * std::f32::consts::PI);
            let n = Vec3::new(trig::sin(b) * trig::sin(a), -trig::cos(b), trig::sin(b) * trig::cos(a));
            mesh.positions.push(n * RADIUS);
            mesh.uvs.push(Vec2::new(u, v));
        }
    }
    for r in 0..rows {
        for c in 0..columns {
            let [a, b] = [r * (columns + 1) + c, (r + 1) * (columns + 1) + c];
            if r > 0 {
                mesh.triangles.push([a, a + 1, b + 1]);
            }
            if r + 1 < rows {
                mesh.triangles.push([a, b + 1, b]);
            }
        }
    }
    mesh.compute_normals();
    assert!(mesh.volume() > 0.0);
    mesh
}

/// A hair that leaves the ball along its normal, is combed down over it, and hangs in a curl.
pub fn hair_strand(strands: &mut Strands, id: u64, nodes: usize, source: u16) {
    let key = Key::new(3, "test hair").with(id);
    let mut normal = key.direction();
    normal.y = normal.y.abs() + 0.2;
    let normal = normal.normalize();
    let root = Root { id, position: normal * RADIUS, normal, uv: Vec2::ZERO, triangle: 0 };
    let axis = normal.cross(Vec3::NEG_Y).normalize_or(Vec3::X);
    let phase = key.with(1).range(0.0, std::f32::consts::TAU);
    let points = (0..nodes).map(|i| {
        let s = i as f32 / (nodes - 1) as f32;
        if i == 0 {
            return root.position;
        }
        let turned = Quat::from_axis_angle(axis, s * 1.4) * normal;
        let lift = 0.6 * trig::smoothstep(0.0, 0.1, s);
        let curl = 0.4 * trig::smoothstep(0.4, 0.7, s);
        let a = phase + s * 30.0;
        turned * (RADIUS + lift) + (axis * trig::cos(a) + turned * trig::sin(a)) * curl
    });
    strands.push(root, source, points.collect::<Vec<_>>());
}

/// A ball with `count` strands of 20 to 64 nodes from two lines of a script, and five guides.
pub fn scene(count: u64) -> Scene {
    let mut guides = Strands::new();
    guides.sources = vec!["style.lua:7".into()];
    for id in 0..5 {
        hair_strand(&mut guides, 1000 + id, 30, 0);
    }
    let mut strands = Strands::new();
    strands.sources = vec!["style.lua:7".into(), "style.lua:12".into()];
    for id in 0..count {
        hair_strand(&mut strands, id, 20 + (id % 45) as usize, (id % 2) as u16);
    }
    for (i, g) in strands.guide.iter_mut().enumerate() {
        *g = i as u32 % 5;
    }
    let hair = Hair {
        strands: Arc::new(strands),
        guides: Arc::new(guides),
        material: HairMaterial::default(),
        overlay: Arc::new(Overlay::default()),
    };
    let turn = Quat::from_rotation_y(0.4);
    Scene {
        name: "style".into(),
        parts: vec![
            Part {
                name: "head".into(),
                source: "style.lua:3".into(),
                body: Body::Mesh(Arc::new(ball()), MeshMaterial::default()),
                motion: None,
            },
            Part { name: "hair".into(), source: "style.lua:12".into(), body: Body::Hair(hair), motion: None },
        ],
        views: vec![View::Front],
        look: Look::default(),
        placement: Affine3A::from_rotation_translation(turn, Vec3::new(0.0, 160.0, 2.0)),
        shown: Shown::default(),
        overlay: Arc::default(),
    }
}

/// The hair of [`scene`].
pub fn hair_of(scene: &mut Scene) -> &mut Hair {
    match &mut scene.parts[1].body {
        Body::Hair(hair) => hair,
        Body::Mesh(..) | Body::Locks(_) => panic!("the second part is hair"),
    }
}
