//! Laws of growing, deforming and filling. Here: what the tests share.

mod fill;
mod grow;
mod moving;
mod natural;
mod queue;

use std::sync::Arc;

use glam::{Vec2, Vec3};

use super::*;
use crate::geometry::bvh::tests::sphere;
use crate::geometry::{OrientedBox, Root, Solid, Strands};
use crate::math::{rng::Key, trig};
use crate::params::Direction;

pub fn region(min: [f32; 3], max: [f32; 3]) -> OrientedBox {
    OrientedBox::between(Vec3::from(min), Vec3::from(max))
}

pub fn everywhere() -> OrientedBox {
    region([-500.0; 3], [500.0; 3])
}

pub fn directional(r#box: OrientedBox, direction: Vec3, strength: f32, priority: i32) -> Arc<Domain> {
    let direction = Direction(direction.normalize());
    Arc::new(Domain::Directional(Directional { r#box, direction, strength, priority, noise: 0.0, name: None }))
}

pub fn gather(core: Vec3, core_radius: f32, scatter: Option<(f32, Vec3)>, priority: i32) -> Arc<Domain> {
    Arc::new(Domain::Gather(Gather {
        core,
        core_radius,
        strength: 1.0,
        scatter: scatter.map_or(0.0, |s| s.0),
        direction: scatter.map(|s| Direction(s.1.normalize())),
        priority,
        noise: 0.0,
        name: None,
    }))
}

pub fn queue(domains: &[Arc<Domain>]) -> Queue {
    Queue::new(domains.to_vec()).unwrap()
}

pub fn root(id: u64, position: Vec3, normal: Vec3) -> Root {
    Root { id, position, normal, uv: Vec2::ZERO, triangle: 0 }
}

pub fn guides(roots: Vec<Root>, length: f32, step: f32, stiffness: f32) -> Guides {
    let options = GuideOptions {
        count: roots.len(),
        length,
        length_variation: 0.0,
        step,
        stiffness,
        limit: None,
        lay: None,
        lay_from: None,
        lay_amount: 0.7,
        noise: 0.0,
        seed: 3,
    };
    Guides { roots, options, source: "test.lua:1".into() }
}

pub fn input<'a>(guides: &'a Guides, global: Option<&'a Queue>, solid: Option<&'a Solid>) -> Grow<'a> {
    Grow { guides, global, locals: &[], local_of: &[], solid, margin: 0.05 }
}

pub fn fill_options(nodes: usize) -> FillOptions {
    FillOptions {
        strands: 1,
        nodes: Some(nodes),
        neighbours: 4,
        length_variation: 0.1,
        noise: 0.03,
        flyaway: 0.1,
        clump: 0.2,
        clump_start: 0.1,
        thickness: 0.4,
        margin: 0.03,
        seed: 5,
    }
}

/// A sphere with twenty sharp spikes on it.
pub fn spiky() -> Solid {
    let key = Key::new(4, "spikes");
    let spikes: Vec<Vec3> = (0..20).map(|i| key.with(i).direction()).collect();
    shaped(|d| {
        let near = spikes.iter().map(|s| s.dot(d)).fold(-1.0, f32::max);
        7.0 + 4.0 * trig::smoothstep(0.97, 1.0, near)
    })
}

/// Two balls and a thin neck between them, along y.
pub fn dumbbell() -> Solid {
    shaped(|d| {
        let y = d.y * 12.0;
        let side = trig::hypot(d.x, d.z).max(1e-3);
        // The neck is a cylinder of radius 2.
        let neck = 2.0 / side;
        let ball = 10.0 * trig::smoothstep(4.0, 8.0, y.abs());
        (neck.min(3.5)).max(ball)
    })
}

fn shaped(radius: impl Fn(Vec3) -> f32) -> Solid {
    let mut mesh = sphere(48, 1.0);
    for p in &mut mesh.positions {
        let d = p.normalize();
        *p = d * radius(d);
    }
    Solid::new(&mesh).unwrap()
}

/// Roots spread over the surface of a star-shaped solid.
pub fn roots_on(solid: &Solid, count: u64, seed: u64) -> Vec<Root> {
    let key = Key::new(seed, "roots");
    (0..count)
        .map(|id| {
            let far = key.with(id).direction() * 30.0;
            let hit = solid.segment_hit(far, Vec3::ZERO).unwrap();
            let normal = solid.closest(hit.position).normal;
            root(id, hit.position, normal)
        })
        .collect()
}

/// Draws everything backwards and down, through the body if it could.
pub fn storm() -> Queue {
    queue(&[
        directional(region([-40.0, 2.0, -40.0], [40.0, 40.0, 40.0]), Vec3::new(0.3, -1.0, -0.8), 1.0, 2),
        gather(Vec3::new(0.0, 0.0, -3.0), 1.0, Some((-0.5, Vec3::new(0.2, -0.5, -1.0))), 1),
        directional(everywhere(), Vec3::new(0.0, -1.0, 0.4), 1.0, 0),
    ])
}

pub fn in_pool<T: Send>(threads: usize, f: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(f)
}

pub fn assert_near(a: Vec3, b: Vec3, tolerance: f32) {
    assert!(a.distance(b) <= tolerance, "{a} against {b}");
}

pub fn mirrored(p: Vec3) -> Vec3 {
    Vec3::new(-p.x, p.y, p.z)
}

pub fn assert_mirrored(strands: &Strands, tolerance: f32) {
    for pair in 0..strands.count() / 2 {
        let (a, b) = (strands.strand(2 * pair), strands.strand(2 * pair + 1));
        assert_eq!(a.len(), b.len());
        for (p, q) in a.iter().zip(b) {
            assert_near(*p, mirrored(*q), tolerance);
        }
    }
}
