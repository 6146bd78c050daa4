//! Laws of the motion, before any numbers.

mod laws;
mod limits;
mod shapes;

use std::sync::Arc;

use glam::{Vec2, Vec3};

use super::*;
use crate::geometry::{Mesh, Root, Solid, Strands};
use crate::math::{rng::Key, trig};
use crate::params::Direction;
use crate::task::Task;

/// Strands whose nodes `place` tells, each with a root of its own.
pub fn strands(count: u64, nodes: usize, place: impl Fn(u64, usize) -> Vec3) -> Strands {
    let mut out = Strands { sources: vec!["test.lua:1".into()], ..Strands::new() };
    for i in 0..count {
        let at = |k| place(i, k);
        let normal = (at(1) - at(0)).normalize();
        out.push(Root { id: i, position: at(0), normal, uv: Vec2::ZERO, triangle: 0 }, 0, (0..nodes).map(at));
    }
    out.stage = vec![0; out.points.len()];
    out
}

/// Straight level strands, 2 cm apart.
pub fn level(count: u64, nodes: usize, segment: f32) -> Strands {
    strands(count, nodes, |i, k| Vec3::new(k as f32 * segment, 0.0, 2.0 * i as f32))
}

/// A right-handed curl that hangs from the origin.
pub fn curl(nodes: usize, segment: f32, radius: f32, turn: f32) -> Strands {
    strands(1, nodes, |_, k| {
        let a = k as f32 * turn;
        let rise = (segment * segment - (2.0 * radius * trig::sin(0.5 * turn)).powi(2)).max(0.0).sqrt();
        Vec3::new(radius * trig::cos(a), -rise * k as f32, radius * trig::sin(a))
    })
}

/// A ball about the origin, and hair that stands on its upper half.
pub fn ball(radius: f32, rings: usize) -> Solid {
    let around = 2 * rings;
    let mut mesh = Mesh::default();
    for i in 0..=rings {
        for j in 0..around {
            let (a, b) =
                (std::f32::consts::PI * i as f32 / rings as f32, std::f32::consts::TAU * j as f32 / around as f32);
            let ring = if i == 0 || i == rings { 0.0 } else { trig::sin(a) };
            mesh.positions.push(Vec3::new(ring * trig::cos(b), trig::cos(a), ring * trig::sin(b)) * radius);
        }
    }
    for i in 0..rings {
        for j in 0..around {
            let at = |i: usize, j: usize| (i * around + j % around) as u32;
            if i > 0 {
                mesh.triangles.push([at(i, j), at(i, j + 1), at(i + 1, j)]);
            }
            if i + 1 < rings {
                mesh.triangles.push([at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)]);
            }
        }
    }
    Solid::new(&mesh).unwrap()
}

/// Hair that stands out of a ball's upper half.
pub fn standing(count: u64, radius: f32, nodes: usize, segment: f32) -> Strands {
    let key = Key::new(3, "standing");
    strands(count, nodes, |i, k| {
        let d = key.with(i).direction();
        Vec3::new(d.x, d.y.abs(), d.z) * (radius + k as f32 * segment)
    })
}

pub fn gravity() -> Arc<Force> {
    Arc::new(Field::Gravity(GravityOptions { strength: EARTH, direction: Direction(Vec3::NEG_Y) }).into())
}

pub fn wind(direction: Vec3, strength: f32, gust: f32) -> Arc<Force> {
    let direction = Direction(direction.normalize());
    Arc::new(Field::Wind(WindOptions { direction, strength, gust, period: 0.7, speed: 200.0, seed: 0 }).into())
}

pub fn attractor(centre: Vec3, radius: f32, strength: f32) -> Arc<Force> {
    let fall_off = FallOff::Proportional;
    Arc::new(Field::Attractor(AttractorOptions { centre, radius, rim: 0.2, strength, fall_off }).into())
}

pub fn options(forces: Vec<Arc<Force>>) -> HairOptions {
    HairOptions { forces: Some(forces), ..HairOptions::default() }
}

pub fn settled(strands: &Strands, options: &HairOptions, body: Option<Body>) -> Settled {
    let hair = Hair { strands, options, pinned: &[], body };
    settle(&hair, &SettleOptions { limit: 20.0, rest_speed: 0.2 }, &Task::new()).unwrap().value
}

/// The greatest part by which a segment differs from its length.
pub fn stretch(one: &Strands, rest: &Strands) -> f32 {
    let mut most = 0.0_f32;
    for i in 0..rest.count() {
        for (a, b) in one.strand(i).windows(2).zip(rest.strand(i).windows(2)) {
            most = most.max((a[0].distance(a[1]) / b[0].distance(b[1]) - 1.0).abs());
        }
    }
    most
}

/// The greatest distance between nodes of the same number.
pub fn apart(one: &Strands, other: &Strands) -> f32 {
    let far = |(a, b): (&Vec3, &Vec3)| if a.is_finite() && b.is_finite() { a.distance(*b) } else { f32::INFINITY };
    one.points.iter().zip(&other.points).map(far).fold(0.0, f32::max)
}
