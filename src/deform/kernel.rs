//! The inner loops: many points at once, one lane each.
//!
//! Points are laid into lanes, so that every operation is done for all lanes together; there is no fused arithmetic and
//! no sum over lanes, so that results are the same on every processor and in any division of the points.

// Lanes are counted: that is the form in which loops over them become single instructions.
#![allow(clippy::needless_range_loop)]

use glam::{DMat3, Vec3};
use multiversion::multiversion;

/// Points that are worked on at once.
const LANES: usize = 16;
/// Numbers of that many points.
type Lanes = [f32; LANES];
/// Places of that many points: x, y, z.
type Places = [Lanes; 3];

/// Blocks of lanes that go through one step after the other; what is between the steps stays in the nearest cache.
const BLOCKS: usize = 32;
const ZERO: Lanes = [0.0; LANES];

/// A lattice, ready for evaluation.
pub struct Grid {
    origin: Vec3,
    /// Rows of the inverse of the edges.
    rows: [Vec3; 3],
    divisions: [usize; 3],
    moves: Vec<Vec3>,
    /// For every (i, j) whether any of its control points has moved.
    is_moved: Vec<bool>,
    /// Along every axis.
    binomials: [Vec<f32>; 3],
}

impl Grid {
    /// From a corner, the inverse of the edges, the divisions and the displacements of the control points.
    pub fn new(origin: Vec3, inverse: &DMat3, divisions: [usize; 3], moves: &[Vec3]) -> Self {
        let rows = [0, 1, 2].map(|a| inverse.row(a).as_vec3());
        let is_moved = moves.chunks(divisions[2] + 1).map(|row| row.iter().any(|&m| m != Vec3::ZERO)).collect();
        let binomials = divisions.map(|n| {
            let mut row = vec![1.0_f64];
            for k in 0..n {
                row.push(row[k] * (n - k) as f64 / (k + 1) as f64);
            }
            row.into_iter().map(|b| b as f32).collect()
        });
        Self { origin, rows, divisions, moves: moves.to_vec(), is_moved, binomials }
    }
}

/// Points that hold a motion back.
pub struct Limit {
    /// Where the moved control points stood.
    pub moved: Vec<Vec3>,
    /// What stays.
    pub held: Vec<Vec3>,
    /// Exponent of the affinity.
    pub power: f32,
}

/// Fixed points and what each of them does to space for every operated point.
pub struct Pinned {
    /// Fixed points.
    pub fixed: Vec<Vec3>,
    /// Operated points and their targets.
    pub operated: Vec<(Vec3, Vec3)>,
    /// For operated point `j` and fixed point `i` at `j * fixed + i`: rows of the turn and scale, less the identity.
    pub turns: Vec<[Vec3; 3]>,
    /// Exponent of the affinity.
    pub power: f32,
}

/// Scattered centres with a weight each, and an affine motion.
pub struct Radial {
    /// Where the centres are.
    pub centres: Vec<Vec3>,
    /// Their weights.
    pub weights: Vec<Vec3>,
    /// The displacement at `base`.
    pub shift: Vec3,
    /// Rows of the linear part of the displacement.
    pub rows: [Vec3; 3],
    /// What places are measured from.
    pub base: Vec3,
}

/// Moves `from` to `to` by a lattice: in three steps, since a compiler that sees them as one lays their numbers side by
/// side in a way that costs more than the sums.
pub fn lattice(grid: &Grid, from: &[Vec3], to: &mut [Vec3]) {
    let (mut local, mut motion) = (vec![[ZERO; 3]; BLOCKS], vec![[ZERO; 3]; BLOCKS]);
    for (from, to) in from.chunks(BLOCKS * LANES).zip(to.chunks_mut(BLOCKS * LANES)) {
        let blocks = from.len().div_ceil(LANES);
        to_local(grid, from, &mut local[..blocks]);
        evaluate(grid, &local[..blocks], &mut motion[..blocks]);
        displace(from, &motion[..blocks], to);
    }
}

/// Local coordinates (2)-(4).
#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2"))]
fn to_local(grid: &Grid, from: &[Vec3], local: &mut [Places]) {
    for (from, local) in from.chunks(LANES).zip(local) {
        let places = load(from);
        let from_corner =
            [less(places[0], grid.origin.x), less(places[1], grid.origin.y), less(places[2], grid.origin.z)];
        for a in 0..3 {
            local[a] = dot(&from_corner, grid.rows[a]);
        }
    }
}

/// The motion at local coordinates; none outside.
#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2"))]
fn evaluate(grid: &Grid, local: &[Places], motion: &mut [Places]) {
    let [l, m, n] = grid.divisions;
    let mut basis = [vec![ZERO; l + 1], vec![ZERO; m + 1], vec![ZERO; n + 1]];
    for (local, motion) in local.iter().zip(motion) {
        // How far inside: negative outside.
        let mut depth = [1.0; LANES];
        for local in local {
            for c in 0..LANES {
                depth[c] = f32::min(depth[c], f32::min(local[c], 1.0 - local[c]));
            }
        }
        if !depth.iter().any(|&d| d >= 0.0) {
            *motion = [ZERO; 3];
            continue;
        }
        for a in 0..3 {
            bernstein(&local[a], &grid.binomials[a], &mut basis[a]);
        }
        *motion = match n {
            1 => contract::<2>(grid, &basis),
            2 => contract::<3>(grid, &basis),
            3 => contract::<4>(grid, &basis),
            4 => contract::<5>(grid, &basis),
            5 => contract::<6>(grid, &basis),
            6 => contract::<7>(grid, &basis),
            _ => contract_any(grid, &basis),
        };
        for motion in motion {
            for c in 0..LANES {
                motion[c] = if depth[c] >= 0.0 { motion[c] } else { 0.0 };
            }
        }
    }
}

/// Writes places moved by `motion`; a point that does not move keeps its bits.
#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2"))]
fn displace(from: &[Vec3], motion: &[Places], to: &mut [Vec3]) {
    for ((from, motion), to) in from.chunks(LANES).zip(motion).zip(to.chunks_mut(LANES)) {
        for (c, (p, q)) in from.iter().zip(to).enumerate() {
            // Adding -0 keeps the sign of a 0.
            let by = |a: usize| if motion[a][c] == 0.0 { -0.0 } else { motion[a][c] };
            *q = *p + Vec3::new(by(0), by(1), by(2));
        }
    }
}

/// Equation (5) for displacements, one axis after the other, with `N` control points along the innermost one.
#[inline(always)]
fn contract<const N: usize>(grid: &Grid, basis: &[Vec<Lanes>; 3]) -> Places {
    let mut weights = [ZERO; N];
    weights.copy_from_slice(&basis[2]);
    let mut motion = [ZERO; 3];
    for (i, across) in basis[0].iter().enumerate() {
        let mut plane = [ZERO; 3];
        for (j, along) in basis[1].iter().enumerate() {
            let row = i * basis[1].len() + j;
            if !grid.is_moved[row] {
                continue;
            }
            let moves = &grid.moves[row * N..(row + 1) * N];
            let first = moves[0];
            let mut line = [scaled(weights[0], first.x), scaled(weights[0], first.y), scaled(weights[0], first.z)];
            for (weight, by) in weights[1..].iter().zip(&moves[1..]) {
                gather(&mut line, weight, *by);
            }
            add(&mut plane, along, &line);
        }
        add(&mut motion, across, &plane);
    }
    motion
}

/// The same for any number of control points.
#[inline(always)]
fn contract_any(grid: &Grid, basis: &[Vec<Lanes>; 3]) -> Places {
    let n = basis[2].len();
    let mut motion = [ZERO; 3];
    for (i, across) in basis[0].iter().enumerate() {
        let mut plane = [ZERO; 3];
        for (j, along) in basis[1].iter().enumerate() {
            let row = i * basis[1].len() + j;
            if !grid.is_moved[row] {
                continue;
            }
            let mut line = [ZERO; 3];
            for (weight, by) in basis[2].iter().zip(&grid.moves[row * n..(row + 1) * n]) {
                gather(&mut line, weight, *by);
            }
            add(&mut plane, along, &line);
        }
        add(&mut motion, across, &plane);
    }
    motion
}

#[inline(always)]
fn gather(line: &mut Places, weight: &Lanes, by: Vec3) {
    line[0] = sum(line[0], scaled(*weight, by.x));
    line[1] = sum(line[1], scaled(*weight, by.y));
    line[2] = sum(line[2], scaled(*weight, by.z));
}

/// Pulls back what `to` has moved from `from`, by the part of the affinity that belongs to the held points.
#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2"))]
pub fn limit(limit: &Limit, from: &[Vec3], to: &mut [Vec3]) {
    let mut squares = vec![ZERO; limit.moved.len() + limit.held.len()];
    for (from, to) in from.chunks(LANES).zip(to.chunks_mut(LANES)) {
        let places = load(from);
        let least = distances(&places, limit.moved.iter().chain(&limit.held), &mut squares);
        let (mut free, mut all) = (ZERO, ZERO);
        for (k, squares) in squares.iter().enumerate() {
            let weight = affinity(squares, &least, limit.power);
            for c in 0..LANES {
                all[c] += weight[c];
                free[c] += if k < limit.moved.len() { weight[c] } else { 0.0 };
            }
        }
        let part = share(&free, &all);
        for (c, (p, q)) in from.iter().zip(to).enumerate() {
            if p != q {
                let is_held = limit.held.contains(p);
                *q = if is_held { *p } else { *p + (*q - *p) * part[c] };
            }
        }
    }
}

/// Moves `from` to `to` by fixed and operated points.
#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2"))]
pub fn pins(pins: &Pinned, from: &[Vec3], to: &mut [Vec3]) {
    let fixed = pins.fixed.len();
    let (mut squares, mut weights) = (vec![ZERO; fixed], vec![ZERO; fixed]);
    let mut far = vec![ZERO; pins.operated.len()];
    for (from, to) in from.chunks(LANES).zip(to.chunks_mut(LANES)) {
        let places = load(from);
        let least = distances(&places, pins.fixed.iter(), &mut squares);
        let mut total = ZERO;
        for (squares, weight) in squares.iter().zip(&mut weights) {
            *weight = affinity(squares, &least, pins.power);
            total = sum(total, *weight);
        }
        // Several operated points: each alone gives a field that keeps the fixed points; the mean of the fields, by the
        // affinity to the operated points, goes through every target.
        let nearest = distances(&places, pins.operated.iter().map(|(p, _)| p), &mut far);
        let (mut motion, mut whole) = ([ZERO; 3], ZERO);
        for (j, far) in far.iter().enumerate() {
            let mut field = [ZERO; 3];
            let turns = &pins.turns[j * fixed..(j + 1) * fixed];
            for ((o, rows), weight) in pins.fixed.iter().zip(turns).zip(&weights) {
                let arm = [less(places[0], o.x), less(places[1], o.y), less(places[2], o.z)];
                let by = [dot(&arm, rows[0]), dot(&arm, rows[1]), dot(&arm, rows[2])];
                add(&mut field, weight, &by);
            }
            let own = if pins.operated.len() == 1 { [1.0; LANES] } else { affinity(far, &nearest, pins.power) };
            add(&mut motion, &own, &field);
            whole = sum(whole, own);
        }
        let whole = product(total, whole);
        motion = [share(&motion[0], &whole), share(&motion[1], &whole), share(&motion[2], &whole)];
        store(from, &motion, &[1.0; LANES], to);
        // Exactly there, whatever rounding says.
        for (p, q) in from.iter().zip(to) {
            if let Some((_, target)) = pins.operated.iter().find(|(o, _)| o == p) {
                *q = *target;
            } else if pins.fixed.contains(p) {
                *q = *p;
            }
        }
    }
}

/// Moves `from` to `to` by radial functions and an affine motion.
#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2"))]
pub fn radial(radial: &Radial, from: &[Vec3], to: &mut [Vec3]) {
    for (from, to) in from.chunks(LANES).zip(to.chunks_mut(LANES)) {
        let places = load(from);
        let arm = [less(places[0], radial.base.x), less(places[1], radial.base.y), less(places[2], radial.base.z)];
        let mut motion = [
            less(dot(&arm, radial.rows[0]), -radial.shift.x),
            less(dot(&arm, radial.rows[1]), -radial.shift.y),
            less(dot(&arm, radial.rows[2]), -radial.shift.z),
        ];
        for (centre, weight) in radial.centres.iter().zip(&radial.weights) {
            let mut r = square(&places, *centre);
            for c in 0..LANES {
                r[c] = r[c].sqrt();
            }
            gather(&mut motion, &r, *weight);
        }
        store(from, &motion, &[1.0; LANES], to);
    }
}

/// Lays up to [`LANES`] points into lanes; lanes that are left over repeat the first point.
#[inline(always)]
fn load(from: &[Vec3]) -> Places {
    let mut places = [ZERO; 3];
    if from.len() == LANES {
        for (c, p) in from.iter().enumerate() {
            (places[0][c], places[1][c], places[2][c]) = (p.x, p.y, p.z);
        }
    } else {
        for c in 0..LANES {
            let p = from.get(c).or(from.first()).copied().unwrap_or_default();
            (places[0][c], places[1][c], places[2][c]) = (p.x, p.y, p.z);
        }
    }
    places
}

/// Writes places moved by `motion` where `depth` is not negative; a point that does not move keeps its bits (adding 0 would lose the sign of -0).
#[inline(always)]
fn store(from: &[Vec3], motion: &Places, depth: &Lanes, to: &mut [Vec3]) {
    for (c, (p, q)) in from.iter().zip(to).enumerate() {
        let by = Vec3::new(motion[0][c], motion[1][c], motion[2][c]);
        *q = if depth[c] >= 0.0 && by != Vec3::ZERO { *p + by } else { *p };
    }
}

#[inline(always)]
fn dot(a: &Places, b: Vec3) -> Lanes {
    sum(sum(scaled(a[0], b.x), scaled(a[1], b.y)), scaled(a[2], b.z))
}

#[inline(always)]
fn add(to: &mut Places, weight: &Lanes, what: &Places) {
    to[0] = sum(to[0], product(*weight, what[0]));
    to[1] = sum(to[1], product(*weight, what[1]));
    to[2] = sum(to[2], product(*weight, what[2]));
}

#[inline(always)]
fn sum(mut a: Lanes, b: Lanes) -> Lanes {
    for c in 0..LANES {
        a[c] += b[c];
    }
    a
}

#[inline(always)]
fn less(mut a: Lanes, b: f32) -> Lanes {
    for c in 0..LANES {
        a[c] -= b;
    }
    a
}

#[inline(always)]
fn product(mut a: Lanes, b: Lanes) -> Lanes {
    for c in 0..LANES {
        a[c] *= b[c];
    }
    a
}

#[inline(always)]
fn scaled(mut a: Lanes, by: f32) -> Lanes {
    for c in 0..LANES {
        a[c] *= by;
    }
    a
}

/// All Bernstein polynomials of degree `basis.len() - 1`.
#[inline(always)]
fn bernstein(at: &Lanes, binomials: &[f32], basis: &mut [Lanes]) {
    let last = basis.len() - 1;
    // Powers of what is left, from the last one down.
    basis[last] = [1.0; LANES];
    for k in (0..last).rev() {
        for c in 0..LANES {
            basis[k][c] = basis[k + 1][c] * (1.0 - at[c]);
        }
    }
    let mut power = *at;
    for k in 1..=last {
        for c in 0..LANES {
            basis[k][c] *= power[c] * binomials[k];
            power[c] *= at[c];
        }
    }
}

/// Squared distances to a place.
#[inline(always)]
fn square(places: &Places, o: Vec3) -> Lanes {
    let (x, y, z) = (less(places[0], o.x), less(places[1], o.y), less(places[2], o.z));
    sum(sum(product(x, x), product(y, y)), product(z, z))
}

/// Squared distances to `centres`, and the least of them; never 0, so that ratios of them are numbers.
#[inline(always)]
fn distances<'a>(places: &Places, centres: impl Iterator<Item = &'a Vec3>, squares: &mut [Lanes]) -> Lanes {
    let mut least = [f32::MAX; LANES];
    for (o, squares) in centres.zip(squares) {
        *squares = square(places, *o);
        for c in 0..LANES {
            squares[c] = f32::max(squares[c], f32::MIN_POSITIVE);
            least[c] = f32::min(least[c], squares[c]);
        }
    }
    least
}

/// The inverse distance to the power of `power`, relative to that of the nearest point, which is 1.
#[inline(always)]
fn affinity(squares: &Lanes, least: &Lanes, power: f32) -> Lanes {
    let mut out = ZERO;
    for c in 0..LANES {
        out[c] = least[c] / squares[c];
    }
    if power == 2.0 {
    } else if power == 4.0 {
        for c in 0..LANES {
            out[c] *= out[c];
        }
    } else if power == 1.0 {
        for c in 0..LANES {
            out[c] = out[c].sqrt();
        }
    } else if power == 3.0 {
        for c in 0..LANES {
            out[c] *= out[c].sqrt();
        }
    } else {
        for c in 0..LANES {
            out[c] = pow(out[c], 0.5 * power);
        }
    }
    out
}

/// `x` to the power of `y`, for `x` in 0..=1 and `y` of at least 0.25: 2 to the power of y log2 x, within 1e-5 of the value.
/// Of plain operations only, so that lanes go side by side and the bits are the same everywhere.
#[inline(always)]
fn pow(x: f32, y: f32) -> f32 {
    /// Adding and taking away 1.5 * 2^23 rounds to a whole number, which then stands in the low bits.
    const ROUND: f32 = 12_582_912.0;
    // The mantissa between the roots of 1/2 and 2.
    let bits = f32::max(x, f32::MIN_POSITIVE).to_bits();
    let exponent = (bits.wrapping_sub(0x3f35_04f3) as i32) >> 23;
    let mantissa = f32::from_bits(bits.wrapping_sub((exponent as u32) << 23));
    // log m = 2 artanh((m - 1) / (m + 1))
    let s = (mantissa - 1.0) / (mantissa + 1.0);
    let q = s * s;
    let series = 1.0 + q * (1.0 / 3.0 + q * (0.2 + q * (1.0 / 7.0 + q * (1.0 / 9.0))));
    let log2 = exponent as f32 + std::f32::consts::LOG2_E * 2.0 * s * series;
    let power = f32::max(y * log2, -126.0);
    let whole = power + ROUND;
    let f = (power - (whole - ROUND)) * std::f32::consts::LN_2;
    let e = 1.0 + f * (1.0 + f * (0.5 + f * (1.0 / 6.0 + f * (1.0 / 24.0 + f * (1.0 / 120.0 + f * (1.0 / 720.0))))));
    e * f32::from_bits(whole.to_bits().wrapping_sub(ROUND.to_bits()).wrapping_add(127) << 23)
}

#[inline(always)]
fn share(part: &Lanes, whole: &Lanes) -> Lanes {
    let mut out = ZERO;
    for c in 0..LANES {
        out[c] = part[c] / whole[c];
    }
    out
}

#[cfg(test)]
mod tests {
    use super::pow;
    use crate::math::trig;

    #[test]
    fn the_lane_power_is_a_power() {
        for y in [0.25, 0.5, 1.0, 1.35, 4.0] {
            for i in 0..=1000 {
                let x = i as f32 / 1000.0;
                assert!((pow(x, y) - trig::pow(x, y)).abs() < 1e-5, "{x} {y}: {}", pow(x, y));
            }
            assert_eq!(pow(1.0, y), 1.0);
            assert!(pow(1e-30, y) > 0.0);
        }
    }
}
