//! The adult mannequin. Measures after the means of ANSUR II (head length 19.5, breadth 15.4, tragion to vertex 13).

use glam::Vec3;

use super::Form;
use super::ear::Ear;
use super::field::{bent_tube, carve, curve, ellipsoid, join, meet, soft_abs, sphere, tube};
use super::grid::{Ring, Zone};

const EAR: Ear = Ear {
    centre: Vec3::new(7.75, 0.15, -1.25),
    axes: [Vec3::new(0.342, -0.16, -0.926), Vec3::new(0.10, 0.985, -0.135), Vec3::new(0.934, -0.05, 0.353)],
    scale: 1.0,
};

/// Face slices: front depth over height.
const FACE_FRONT: [[f32; 2]; 9] =
    [[-10.6, 7.9], [-9.0, 8.4], [-7.3, 8.3], [-5.6, 8.9], [-3.5, 9.2], [-1.0, 8.9], [1.7, 8.9], [3.4, 9.4], [6.5, 9.2]];
/// Face slices: half breadth over height.
const FACE_SIDE: [[f32; 2]; 7] =
    [[-10.6, 3.9], [-9.0, 4.6], [-7.0, 5.35], [-4.5, 6.0], [-1.0, 6.7], [2.0, 6.75], [6.0, 6.6]];

fn distance(p: Vec3) -> f32 {
    let at = Vec3::new;
    let m = at(soft_abs(p.x, 0.35), p.y, p.z);

    // Skull.
    let back = ellipsoid(p, at(0.0, 4.2, -2.2), at(7.55, 8.45, 7.5));
    let front = ellipsoid(p, at(0.0, 4.3, 1.7), at(6.6, 8.0, 7.6));
    let mut d = join(back, front, 4.0);

    // Face: slices, cut by the line of the jaw.
    let (zf, w) = (curve(&FACE_FRONT, p.y), curve(&FACE_SIDE, p.y));
    let (qx, qz) = (p.x.abs() / w, p.z.abs() / if p.z > 0.0 { zf } else { 3.5 });
    let s = (qx * qx * qx.sqrt() + qz * qz * qz.sqrt()).max(1e-6);
    let norm = libm_pow04(s);
    let slope = {
        let (gx, gz) = (qx * qx.sqrt() / w, qz * qz.sqrt() / if p.z > 0.0 { zf } else { 3.5 });
        (gx * gx + gz * gz).sqrt() * norm / s
    };
    let slice = (norm - 1.0) / slope.max(0.05);
    let jaw = -(p.y + 10.1) * 0.91 - (p.z - 8.0) * 0.415;
    let face = meet(meet(slice, jaw, 1.4), p.y - 5.5, 3.0);
    d = join(d, face, 2.2);

    // Chin and muzzle.
    d = join(d, ellipsoid(p, at(0.0, -8.75, 7.2), at(2.2, 1.3, 1.75)), 1.2);
    d = join(d, ellipsoid(p, at(0.0, -5.2, 6.9), at(3.2, 2.5, 2.6)), 1.6);

    // Cheekbones, brow.
    d = join(d, ellipsoid(p, at(4.6, -0.5, 5.0), at(2.1, 1.6, 2.5)), 2.6);
    d = join(d, bent_tube::<5>(p, [at(0.9, 2.7, 8.8), at(3.2, 3.6, 8.6), at(5.9, 2.4, 5.3)], [0.45, 0.5, 0.4]), 1.8);

    // Eye sockets and closed eyes.
    d = carve(d, ellipsoid(p, at(3.0, 1.3, 9.9), at(2.0, 1.2, 1.5)), 1.8);
    let ball = ellipsoid(p, at(3.15, 1.3, 7.3), at(1.6, 1.25, 1.45));
    d = join(d, ball, 0.5);
    let lash = bent_tube::<5>(p, [at(1.75, 0.95, 8.2), at(3.1, 0.35, 9.1), at(4.7, 1.1, 7.6)], [0.07, 0.1, 0.07]);
    d = carve(d, lash, 0.18);

    // Nose.
    d = join(d, tube(m, at(0.0, 1.8, 8.5), at(0.0, -2.2, 10.9), 0.55, 0.8), 1.3);
    d = join(d, sphere(m, at(0.0, -2.4, 11.05), 0.82), 0.6);
    d = join(d, ellipsoid(p, at(1.12, -2.7, 9.75), at(0.62, 0.68, 0.95)), 0.6);
    d = carve(d, ellipsoid(p, at(0.62, -3.4, 10.35), at(0.3, 0.4, 0.5)), 0.25);

    // Lips.
    d = carve(d, tube(m, at(0.0, -3.7, 10.3), at(0.0, -4.7, 10.3), 0.1, 0.2), 0.6);
    d = join(
        d,
        bent_tube::<5>(m, [at(0.0, -5.05, 9.5), at(1.1, -4.9, 9.45), at(2.5, -5.65, 8.3)], [0.5, 0.45, 0.12]),
        0.45,
    );
    d = join(
        d,
        bent_tube::<5>(m, [at(0.0, -6.1, 9.3), at(1.1, -6.2, 9.2), at(2.3, -5.7, 8.3)], [0.55, 0.5, 0.1]),
        0.45,
    );
    d = carve(
        d,
        bent_tube::<5>(m, [at(0.0, -5.6, 10.1), at(1.1, -5.45, 9.9), at(2.65, -5.75, 8.8)], [0.08, 0.08, 0.1]),
        0.3,
    );

    // Neck.
    let n = at(p.x, p.y, p.z * 0.93);
    let neck = tube(n, at(0.0, -2.0, -1.7), at(0.0, -19.0, -3.4), 5.1, 5.4);
    d = join(d, neck, 1.6);
    d = EAR.join_to(d, p);
    let scm = tube(p, at(4.6, -3.5, -2.8), at(1.2, -19.0, 1.6), 0.9, 0.7);
    d = join(d, scm, 1.5);
    // Shoulders.
    let trap = tube(p, at(2.0, -12.0, -5.6), at(14.0, -20.6, -3.6), 2.2, 2.4);
    d = join(d, trap, 3.0);
    let body = ellipsoid(p, at(0.0, -26.0, -3.0), at(17.5, 8.0, 8.6));
    d = join(d, body, 4.0);
    let clavicle = tube(p, at(1.5, -19.8, 2.8), at(13.0, -18.8, -1.5), 0.6, 0.8);
    d = join(d, clavicle, 1.5);
    meet(d, -25.5 - p.y, 0.5)
}

/// `x` to the power of 0.4.
fn libm_pow04(x: f32) -> f32 {
    crate::math::trig::pow(x, 0.4)
}

fn edge(p: Vec3) -> f32 {
    let ear = (p - EAR.centre).length();
    let face = (p - Vec3::new(1.5, -2.5, 9.0)).length();
    let detail = (0.26 + 0.1 * (ear - 2.6).max(0.0)).min(0.30 + 0.08 * (face - 3.5).max(0.0));
    detail.min(0.62 + 0.03 * (-12.0 - p.y).max(0.0))
}

fn zone(p: Vec3) -> Zone {
    if p.y < -14.0 - 0.45 * (p.x - 4.0).max(0.0) - 0.2 * p.z {
        Zone::Shoulders
    } else if (p - EAR.centre).length() < 3.3 && p.x > 7.1 {
        Zone::Ear
    } else if p.y * 0.86 + p.z * 0.5 < -5.6 || (p.z < -2.0 && p.y < -4.0 + 0.3 * (p.z + 2.0)) {
        Zone::Neck
    } else if p.z > 1.0 && p.y < 8.5 - 0.12 * p.x * p.x + 0.0 * p.z {
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
    ring(8, [6.5, 9.2], [7.3, 7.0, -0.8], [6.0, -9.3]),
    ring(8, [3.2, 9.7], [7.6, 3.4, -1.0], [2.5, -9.8]),
    ring(11, [0.0, 9.6], [7.4, 0.0, -1.0], [-0.3, -9.4]),
    ring(11, [-3.3, 9.8], [7.0, -3.0, -1.2], [-2.8, -8.3]),
    ring(8, [-5.6, 9.8], [6.3, -4.6, -1.5], [-4.3, -7.4]),
    ring(6, [-8.0, 8.9], [6.0, -6.0, -1.8], [-6.0, -6.8]),
    ring(5, [-10.0, 8.2], [5.6, -7.5, -2.0], [-7.6, -6.8]),
    ring(5, [-10.6, 5.5], [5.4, -8.8, -2.0], [-9.0, -6.9]),
    ring(4, [-12.5, 3.8], [5.4, -10.8, -2.4], [-11.3, -7.2]),
    ring(5, [-16.5, 2.8], [6.0, -13.8, -3.0], [-14.0, -8.1]),
    ring(5, [-19.5, 2.8], [8.0, -15.8, -3.2], [-16.3, -9.4]),
    ring(4, [-21.5, 4.0], [12.0, -17.5, -3.3], [-18.5, -10.5]),
    ring(4, [-23.2, 5.0], [16.0, -20.0, -3.3], [-21.0, -11.2]),
    ring(3, [-25.5, 5.2], [16.6, -25.5, -3.3], [-25.5, -11.0]),
];

/// The form of the adult.
pub fn form() -> Form {
    let at = Vec3::new;
    Form {
        distance,
        edge,
        rings: &RINGS,
        columns: &[(19, 42.0), (11, 36.0), (18, 32.0), (12, 70.0)],
        zone,
        landmarks: [
            ("vertex", at(0.0, 20.0, -0.5), at(0.0, -1.0, 0.0)),
            ("forehead", at(0.0, 9.5, 20.0), at(0.0, 0.0, -1.0)),
            ("left_temple", at(20.0, 3.5, 5.0), at(-1.0, 0.0, 0.0)),
            ("right_temple", at(-20.0, 3.5, 5.0), at(-1.0, 0.0, 0.0)),
            ("left_ear", at(20.0, 0.0, 0.0), at(-1.0, 0.0, 0.0)),
            ("right_ear", at(-20.0, 0.0, 0.0), at(-1.0, 0.0, 0.0)),
            ("occiput", at(0.0, 2.5, -20.0), at(0.0, 0.0, 1.0)),
            ("nape", at(0.0, -6.0, -20.0), at(0.0, 0.0, 1.0)),
            ("chin", at(0.0, -20.0, 7.8), at(0.0, 1.0, 0.0)),
        ],
    }
}
