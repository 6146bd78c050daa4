//! The cartoon mannequin: the skull of an adult 1.25 times, with a small face low on it.

use glam::Vec3;

use super::Form;
use super::ear::Ear;
use super::field::{bent_tube, carve, ellipsoid, join, meet, near, tube};
use super::grid::{Ring, Zone};

const EAR: Ear = Ear {
    centre: Vec3::new(9.2, 0.3, -1.35),
    axes: [Vec3::new(0.2989, -0.1916, -0.9349), Vec3::new(0.2408, 0.9631, -0.1204), Vec3::new(0.9234, -0.1891, 0.334)],
    scale: 0.98,
};

const fn at(x: f32, y: f32, z: f32) -> Vec3 {
    Vec3::new(x, y, z)
}

fn distance(p: Vec3) -> f32 {
    let mut d = f32::MAX;
    if p.y > -13.0 {
        d = skull(p);
        if near(p, d, at(3.9, 0.4, 7.6), 4.6) {
            d = eye(d, p);
        }
        if near(p, d, at(0.0, -3.2, 8.6), 4.2) {
            d = nose_and_mouth(d, p);
        }
    }
    if p.y - 1.5 < d + 2.5 {
        d = trunk(d, p);
    }
    EAR.join_to(d, p)
}

/// Skull, cheeks and chin.
fn skull(p: Vec3) -> f32 {
    let mut d = ellipsoid(p, at(0.0, 4.75, -0.7), at(9.7, 10.5, 10.7));
    if p.y > 9.0 {
        return d;
    }
    d = join(d, ellipsoid(p, at(0.0, -2.0, 2.4), at(7.2, 5.2, 6.6)), 4.0);
    if near(p, d, at(0.0, -3.8, 5.5), 8.2) {
        d = join(d, ellipsoid(p, at(3.8, -2.9, 5.4), at(2.6, 2.3, 2.6)), 3.4);
        d = join(d, ellipsoid(p, at(0.0, -5.4, 5.7), at(2.9, 2.25, 2.6)), 3.6);
    }
    d
}

/// Brow, shallow socket and a large closed eye.
fn eye(d: f32, p: Vec3) -> f32 {
    let brow = bent_tube::<4>(p, [at(1.6, 3.0, 9.1), at(3.9, 4.2, 9.0), at(6.4, 2.8, 6.6)], [0.3, 0.35, 0.2]);
    let mut d = join(d, brow, 1.8);
    d = carve(d, ellipsoid(p, at(3.8, -0.1, 10.3), at(2.7, 2.4, 2.0)), 2.0);
    let ball = ellipsoid(p, at(3.85, -0.25, 6.65), at(2.35, 2.1, 1.8));
    d = join(d, ball, 0.6);
    // The upper lid lies over the lower one, down to lashes in a calm curve.
    let off = p.x - 3.9;
    let lid = meet(ball - 0.24, 0.13 * off * off - 1.0 - p.y, 0.12);
    join(d, lid, 0.12)
}

/// A button of a nose and a small mouth.
fn nose_and_mouth(d: f32, p: Vec3) -> f32 {
    let mut d = join(d, tube(p, at(0.0, 0.3, 8.6), at(0.0, -1.9, 9.1), 0.35, 0.5), 1.6);
    d = join(d, ellipsoid(p, at(0.0, -2.3, 9.35), at(0.8, 0.65, 0.75)), 0.8);
    d = join(d, ellipsoid(p, at(0.7, -2.45, 8.95), at(0.5, 0.45, 0.6)), 0.6);
    let upper = bent_tube::<4>(p, [at(0.0, -4.4, 8.82), at(0.8, -4.25, 8.78), at(1.5, -4.45, 8.35)], [0.24, 0.26, 0.1]);
    let lower = bent_tube::<4>(p, [at(0.0, -5.15, 8.62), at(0.7, -5.15, 8.55), at(1.4, -4.7, 8.25)], [0.32, 0.3, 0.1]);
    let line = bent_tube::<4>(p, [at(0.0, -4.8, 9.05), at(1.0, -4.85, 8.92), at(1.9, -4.35, 8.45)], [0.27, 0.25, 0.2]);
    d = join(d, upper, 0.5);
    d = join(d, lower, 0.5);
    carve(d, line, 0.3)
}

/// Thin neck and narrow shoulders.
fn trunk(d: f32, p: Vec3) -> f32 {
    let mut d = join(d, tube(p, at(0.0, -2.0, -1.2), at(0.0, -13.5, -2.0), 3.4, 3.6), 2.4);
    if p.y > -3.0 {
        return d;
    }
    let slope = tube(at(p.x, p.y, p.z * 0.75), at(0.3, -9.9, -1.9), at(7.4, -13.8, -1.7), 1.4, 1.3);
    d = join(d, slope, 2.8);
    d = join(d, ellipsoid(p, at(0.0, -16.4, -2.1), at(10.9, 4.8, 5.4)), 3.5);
    meet(d, -17.2 - p.y, 2.0)
}

fn edge(p: Vec3) -> f32 {
    let ear = (p - EAR.centre).length();
    let face = (p - Vec3::new(2.0, -2.0, 8.6)).length();
    let detail = (0.28 + 0.1 * (ear - 2.8).max(0.0)).min(0.30 + 0.07 * (face - 3.6).max(0.0));
    detail.min(0.66)
}

fn zone(p: Vec3) -> Zone {
    if p.y < -10.3 - 0.4 * (p.x - 3.0).max(0.0) - 0.1 * p.z {
        Zone::Shoulders
    } else if (p - EAR.centre).length() < 3.7 && p.x > 8.75 {
        Zone::Ear
    } else if p.y * 0.93 + p.z * 0.36 < -5.2 {
        Zone::Neck
    } else if p.z > 1.5 && p.y < 7.0 - 0.09 * p.x * p.x {
        Zone::Face
    } else {
        Zone::Head
    }
}

const fn ring(rows: usize, front: [f32; 2], side: [f32; 3], back: [f32; 2]) -> Ring {
    Ring { rows, front, side, back }
}

const RINGS: [Ring; 14] = [
    ring(0, [12.2, 7.2], [6.8, 12.2, -0.6], [12.0, -8.0]),
    ring(7, [7.5, 9.9], [9.5, 7.5, -0.6], [7.0, -11.2]),
    ring(8, [3.0, 9.9], [9.4, 3.2, -0.8], [2.5, -11.0]),
    ring(12, [-1.0, 9.2], [8.6, -0.5, -1.0], [-1.0, -9.5]),
    ring(10, [-3.6, 9.3], [7.4, -3.0, -1.2], [-3.2, -7.6]),
    ring(8, [-5.6, 8.7], [5.6, -4.8, -1.6], [-5.0, -5.8]),
    ring(7, [-7.5, 7.2], [4.4, -6.0, -2.0], [-6.4, -5.6]),
    ring(7, [-7.9, 4.0], [3.8, -7.4, -2.2], [-7.8, -5.6]),
    ring(6, [-9.0, 1.6], [3.6, -8.4, -2.3], [-8.9, -5.7]),
    ring(5, [-10.8, 1.2], [4.0, -9.8, -2.4], [-10.0, -6.2]),
    ring(5, [-12.2, 2.0], [6.0, -11.4, -2.4], [-11.4, -7.0]),
    ring(4, [-13.7, 2.8], [8.6, -12.9, -2.3], [-12.9, -7.6]),
    ring(4, [-15.0, 3.3], [10.8, -14.6, -2.2], [-14.8, -8.0]),
    ring(3, [-17.0, 3.6], [11.3, -17.0, -2.2], [-17.0, -8.1]),
];

/// The form of the cartoon.
pub fn form() -> Form {
    Form {
        distance,
        edge,
        rings: &RINGS,
        columns: &[(20, 44.0), (11, 36.0), (17, 32.0), (12, 68.0)],
        zone,
        landmarks: [
            ("vertex", at(0.0, 20.0, -0.7), at(0.0, -1.0, 0.0)),
            ("forehead", at(0.0, 8.0, 20.0), at(0.0, 0.0, -1.0)),
            ("left_temple", at(20.0, 3.0, 5.2), at(-1.0, 0.0, 0.0)),
            ("right_temple", at(-20.0, 3.0, 5.2), at(-1.0, 0.0, 0.0)),
            ("left_ear", at(20.0, 0.0, 0.0), at(-1.0, 0.0, 0.0)),
            ("right_ear", at(-20.0, 0.0, 0.0), at(-1.0, 0.0, 0.0)),
            ("occiput", at(0.0, 3.0, -20.0), at(0.0, 0.0, 1.0)),
            ("nape", at(0.0, -5.6, -20.0), at(0.0, 0.0, 1.0)),
            ("chin", at(0.0, -20.0, 6.4), at(0.0, 1.0, 0.0)),
        ],
    }
}
