//! The adult mannequin: 23 cm from chin to vertex, 15.5 cm broad, 19.5 cm long, eyes at half height, ears from brow to
//! nose.

use glam::{Vec2, Vec3};

use super::Form;
use super::ear::Ear;
use super::field::{bent_tube, carve, curve, ellipsoid, join, meet, near, sphere, tube};
use super::grid::{Ring, Zone};

const EAR: Ear = Ear {
    centre: Vec3::new(7.6, 0.15, -1.3),
    axes: [Vec3::new(0.2804, -0.1755, -0.9437), Vec3::new(0.0797, 0.984, -0.1594), Vec3::new(0.9566, -0.0305, 0.2899)],
    scale: 1.0,
};

/// Slices of the face without its features: front depth over height.
const FRONT: [[f32; 2]; 9] = [
    [-10.4, 7.6],
    [-9.0, 8.4],
    [-7.3, 8.3],
    [-5.6, 8.85],
    [-3.5, 9.2],
    [-1.0, 8.9],
    [1.7, 8.8],
    [3.4, 9.35],
    [6.0, 9.2],
];
/// The same: half breadth over height.
const SIDE: [[f32; 2]; 7] =
    [[-10.4, 3.9], [-9.0, 4.5], [-7.0, 5.3], [-4.5, 6.0], [-1.0, 6.65], [2.0, 6.75], [6.0, 6.6]];
/// The same: depth behind the ears' plane, where the jaw ends.
const BACK: [[f32; 2]; 4] = [[-8.0, 1.0], [-5.0, 1.6], [-2.0, 3.0], [2.0, 4.0]];

const fn at(x: f32, y: f32, z: f32) -> Vec3 {
    Vec3::new(x, y, z)
}

fn distance(p: Vec3) -> f32 {
    let mut d = f32::MAX;
    if p.y > -16.0 {
        d = skull(p);
        if near(p, d, at(3.2, 1.6, 8.0), 3.9) {
            d = eye(d, p);
        }
        if near(p, d, at(0.0, -1.0, 9.6), 3.6) {
            d = nose(d, p);
        }
        if near(p, d, at(0.0, -5.3, 7.2), 4.2) {
            d = mouth(d, p);
        }
    }
    if p.y - 3.0 < d + 2.0 {
        d = trunk(d, p);
    }
    EAR.join_to(d, p)
}

/// Skull, jaw, chin and cheekbones.
fn skull(p: Vec3) -> f32 {
    let back = ellipsoid(p, at(0.0, 4.2, -2.2), at(7.55, 8.45, 7.5));
    let front = ellipsoid(p, at(0.0, 4.3, 1.7), at(6.6, 8.0, 7.6));
    let mut d = join(back, front, 4.0);
    if p.y > 10.0 {
        return d;
    }
    let jaw = -(p.y + 9.975) * 0.916 - (p.z - 8.0) * 0.40;
    let slice = squircle(p.x, p.z, curve(&SIDE, p.y), if p.z > 0.0 { curve(&FRONT, p.y) } else { curve(&BACK, p.y) });
    let face = meet(meet(slice, jaw, 1.4), p.y - 5.5, 3.0);
    d = join(d, face, 2.2);
    if near(p, d, at(0.0, -8.0, 5.0), 5.4) {
        d = join(d, ellipsoid(p, at(0.0, -8.775, 7.2), at(2.1, 1.3, 1.75)), 1.2);
        // The floor of the mouth, so that chin and neck meet in no sharp corner.
        d = join(d, ellipsoid(p, at(0.0, -7.6, 3.6), at(3.4, 2.1, 4.2)), 1.6);
    }
    if near(p, d, at(4.3, -0.4, 5.2), 3.5) {
        d = join(d, ellipsoid(p, at(4.3, -0.4, 5.2), at(2.1, 1.7, 2.5)), 3.0);
    }
    if near(p, d, at(3.0, -4.0, 4.5), 3.4) {
        d = join(d, ellipsoid(p, at(3.0, -4.0, 4.5), at(2.3, 2.6, 2.6)), 2.8);
    }
    if near(p, d, at(8.9, 3.4, 5.0), 2.4) {
        d = carve(d, ellipsoid(p, at(8.9, 3.4, 5.0), at(1.5, 2.2, 2.4)), 2.0);
    }
    d
}

/// Distance in a slice to a rounded square with half axes `w` and `l`: `a^4 + 1.5 a^2 b^2 + b^4 = 1`, to first order.
fn squircle(x: f32, z: f32, w: f32, l: f32) -> f32 {
    let (a, b) = (x / w, z / l);
    let (aa, bb) = (a * a, b * b);
    let norm = (aa * aa + 1.5 * aa * bb + bb * bb).max(1e-6).sqrt().sqrt();
    let slope =
        Vec2::new(a * (4.0 * aa + 3.0 * bb) / w, b * (4.0 * bb + 3.0 * aa) / l).length() / (4.0 * norm * norm * norm);
    (norm - 1.0) / slope.max(0.05)
}

/// Brow, socket and closed lids.
fn eye(d: f32, p: Vec3) -> f32 {
    let brow = bent_tube::<4>(p, [at(0.8, 2.6, 8.75), at(3.2, 3.6, 8.75), at(5.6, 2.3, 5.3)], [0.45, 0.5, 0.2]);
    let mut d = join(d, brow, 1.8);
    d = carve(d, ellipsoid(p, at(3.0, 1.25, 9.9), at(2.0, 1.2, 1.5)), 1.8);
    let ball = ellipsoid(p, at(3.15, 1.25, 7.05), at(1.7, 1.3, 1.5));
    d = join(d, ball, 0.5);
    // The upper lid lies a little over the lower one, down to the lashes.
    let off = p.x - 3.2;
    let lid = meet(ball - 0.18, 0.62 + 0.11 * off * off - p.y, 0.1);
    join(d, lid, 0.1)
}

/// Bridge, tip, wings and nostrils.
fn nose(d: f32, p: Vec3) -> f32 {
    let mut d = join(d, tube(p, at(0.0, 1.9, 8.65), at(0.0, -1.9, 10.5), 0.5, 0.66), 0.9);
    d = join(d, ellipsoid(p, at(0.0, -1.5, 8.9), at(1.35, 2.2, 1.25)), 0.9);
    d = join(d, sphere(p, at(0.0, -2.2, 10.78), 0.68), 0.8);
    d = join(d, ellipsoid(p, at(1.02, -2.7, 9.75), at(0.52, 0.62, 1.1)), 0.9);
    d = join(d, ellipsoid(p, at(0.0, -3.0, 10.1), at(0.36, 0.42, 0.85)), 0.8);
    carve(d, ellipsoid(p, at(0.55, -3.5, 10.1), at(0.32, 0.42, 0.55)), 0.6)
}

/// Muzzle, philtrum and lips.
fn mouth(d: f32, p: Vec3) -> f32 {
    let mut d = join(d, ellipsoid(p, at(0.0, -5.3, 6.9), at(3.4, 2.7, 2.15)), 2.2);
    d = carve(d, tube(p, at(0.0, -4.0, 10.15), at(0.0, -4.7, 10.15), 0.12, 0.2), 1.0);
    let upper = bent_tube::<4>(p, [at(0.0, -5.1, 9.56), at(1.2, -4.88, 9.52), at(2.55, -5.6, 8.5)], [0.36, 0.4, 0.14]);
    let lower = bent_tube::<4>(p, [at(0.0, -6.08, 9.36), at(1.1, -6.2, 9.3), at(2.4, -5.72, 8.5)], [0.45, 0.44, 0.12]);
    let line = bent_tube::<4>(p, [at(0.0, -5.6, 9.84), at(1.1, -5.46, 9.74), at(2.75, -5.74, 8.75)], [0.2, 0.19, 0.17]);
    d = join(d, upper, 0.5);
    d = join(d, lower, 0.45);
    carve(d, line, 0.25)
}

/// Neck and shoulders.
fn trunk(d: f32, p: Vec3) -> f32 {
    let mut d = join(d, tube(p, at(0.0, -3.0, -1.45), at(0.0, -18.0, -3.0), 4.85, 5.2), 2.2);
    d = join(d, tube(p, at(4.2, -3.4, -2.6), at(1.1, -17.4, 2.2), 0.75, 0.55), 1.5);
    if p.y > -4.0 {
        return d;
    }
    let slope = tube(at(p.x, p.y, p.z * 0.7), at(0.5, -12.2, -2.4), at(11.5, -18.8, -2.2), 2.0, 1.5);
    d = join(d, slope, 3.5);
    d = join(d, ellipsoid(p, at(0.0, -22.6, -2.8), at(16.2, 6.4, 7.6)), 5.0);
    d = join(d, tube(p, at(1.3, -17.5, 2.3), at(11.0, -17.5, -0.9), 0.5, 0.6), 1.5);
    meet(d, -24.0 - p.y, 2.4)
}

fn edge(p: Vec3) -> f32 {
    let ear = (p - EAR.centre).length();
    let face = (p - Vec3::new(1.5, -2.5, 9.0)).length();
    let detail = (0.26 + 0.1 * (ear - 2.6).max(0.0)).min(0.30 + 0.08 * (face - 3.5).max(0.0));
    detail.min(0.62 + 0.03 * (-12.0 - p.y).max(0.0))
}

fn zone(p: Vec3) -> Zone {
    if p.y < -13.0 - 0.45 * (p.x - 4.0).max(0.0) - 0.2 * p.z {
        Zone::Shoulders
    } else if (p - EAR.centre).length() < 3.3 && p.x > 7.1 {
        Zone::Ear
    } else if p.y * 0.86 + p.z * 0.5 < -5.6 || (p.z < -2.0 && p.y < -4.0 + 0.3 * (p.z + 2.0)) {
        Zone::Neck
    } else if p.z > 1.0 && p.y < 8.5 - 0.12 * p.x * p.x {
        Zone::Face
    } else {
        Zone::Head
    }
}

const fn ring(rows: usize, front: [f32; 2], side: [f32; 3], back: [f32; 2]) -> Ring {
    Ring { rows, front, side, back }
}

const RINGS: [Ring; 15] = [
    ring(0, [10.3, 7.0], [5.6, 10.3, -0.5], [10.0, -6.9]),
    ring(7, [6.5, 9.2], [7.3, 7.0, -0.8], [6.0, -9.3]),
    ring(7, [3.2, 9.7], [7.6, 3.4, -1.0], [2.5, -9.8]),
    ring(11, [0.0, 9.6], [7.4, 0.0, -1.0], [-0.3, -9.4]),
    ring(11, [-3.3, 9.8], [7.0, -3.0, -1.2], [-2.8, -8.3]),
    ring(8, [-5.6, 9.8], [6.3, -4.6, -1.5], [-4.3, -7.4]),
    ring(6, [-8.0, 8.9], [6.0, -6.0, -1.8], [-6.0, -6.8]),
    ring(5, [-10.0, 8.2], [5.6, -7.5, -2.0], [-7.6, -6.8]),
    ring(7, [-10.6, 5.5], [5.4, -8.8, -2.0], [-9.0, -6.9]),
    ring(5, [-12.3, 2.8], [5.0, -10.4, -2.4], [-10.8, -7.4]),
    ring(5, [-15.5, 2.0], [5.6, -12.8, -3.0], [-13.2, -8.1]),
    ring(4, [-18.0, 2.4], [8.0, -14.6, -3.2], [-15.3, -9.4]),
    ring(4, [-19.8, 3.6], [12.0, -16.4, -3.3], [-17.3, -10.3]),
    ring(4, [-21.6, 4.6], [15.8, -18.8, -3.3], [-19.8, -10.9]),
    ring(3, [-23.6, 5.0], [16.5, -23.6, -3.3], [-23.6, -11.0]),
];

/// The form of the adult.
pub fn form() -> Form {
    Form {
        distance,
        edge,
        rings: &RINGS,
        columns: &[(22, 42.0), (10, 36.0), (17, 32.0), (11, 70.0)],
        zone,
        landmarks: [
            ("vertex", at(0.0, 20.0, -0.5), at(0.0, -1.0, 0.0)),
            ("forehead", at(0.0, 9.5, 20.0), at(0.0, 0.0, -1.0)),
            ("left_temple", at(20.0, 5.2, 5.4), at(-1.0, 0.0, 0.0)),
            ("right_temple", at(-20.0, 5.2, 5.4), at(-1.0, 0.0, 0.0)),
            ("left_ear", at(20.0, 0.0, 0.0), at(-1.0, 0.0, 0.0)),
            ("right_ear", at(-20.0, 0.0, 0.0), at(-1.0, 0.0, 0.0)),
            ("occiput", at(0.0, 2.5, -20.0), at(0.0, 0.0, 1.0)),
            ("nape", at(0.0, -6.0, -20.0), at(0.0, 0.0, 1.0)),
            ("chin", at(0.0, -20.0, 7.8), at(0.0, 1.0, 0.0)),
        ],
    }
}
