//! Bending towards the shape at rest, in the strand's own frames.
//!
//! Every segment has a wanted vector T: that at rest, seen from the frame of the segment before it, so that a curl that
//! is turned as a whole is still at rest. A spring turns the segment d to it; T in turn rides on the segment before, which
//! is turned the other way, so that bending neither pushes nor spins the strand as a whole. For a straight strand this is
//! the discrete beam: the fourth difference, with stiffness B / r^4.
//!
//! At rest the frames are the rotation-minimising ones. In motion every segment carries its own frame along, turning as
//! little as possible, and gives in to the rotation-minimising one of its neighbour within [`TWIST`]: were it that one at
//! once, a small turn near the root would spin all of a curl, and no step would be short enough for that.
//!
//! Such springs would need tens of thousands of explicit steps a second. They are solved for implicitly instead: a
//! place that inertia alone has led to, x + v h, is moved on by
//!
//! ```text
//! u = (1 + h^2 K)^-1 h^2 (a + F),      K = c sum_k R_k^T R_k,      h^2 F = c sum_k R_k^T T_k
//! ```
//!
//! with a the acceleration of the force objects and F that of the springs at that place. R_k is how segment k turns
//! away from its T when nodes k-2, k-1 and k move,
//!
//! ```text
//! R_k = P_k (d'_k - Q_k d'_(k-1)),     P_k = 1 - d d^T / D,     Q_k v = (v (d . T) - d (v . T)) / D
//! ```
//!
//! with d in Q_k that of segment k-1. Where hair is at rest u vanishes only with a + F. K is symmetric and goes from node
//! to node in blocks of three by three, two off the diagonal: the system is solved exactly, from root to tip and back.

use glam::{Affine3A, Vec3};

use super::lanes::{LANES, Lanes, Plane, add_scaled, cross, dot, each, minus, scaled};
use super::packet::{NONE, Packet};
use crate::math::trig;

/// The time in which a frame gives in to its neighbour's twist, s.
const TWIST: f32 = 1.0 / 12.0;

/// Greatest h^2 B / r^4: beyond it the factors are rounding.
pub const MOST: f32 = 1e6;

/// Bending of eight strands.
#[derive(Clone, Debug)]
pub struct Bend {
    /// The wanted vector of each segment in the frame before it: along tangent, normal, binormal.
    local: Plane,
    /// h^2 times the springs' stiffness.
    strength: Lanes,
    /// The frame of the root at rest, seen from the head.
    tangent: [Lanes; 3],
    normal: [Lanes; 3],
    /// The normal of each segment's frame.
    frames: Plane,
    /// How far a frame gives in to its neighbour in a step.
    give: f32,
}

/// A number of each strand, of double precision: what matters of K is what its large blocks leave of each other, a part
/// of some 10^-6 for long strands, and in single precision soft shapes would gain energy by its loss.
type Wide = [f64; LANES];

/// A matrix of each strand, row by row.
type Matrix = [[Wide; 3]; 3];

const ZERO: Matrix = [[[0.0; LANES]; 3]; 3];

/// Memory of the factors.
#[derive(Clone, Debug, Default)]
pub struct Factors(Vec<Factor>);

/// The factors of one node: its inverse pivot, and the blocks to the node after it and to the one after that. Before they
/// are made: the blocks of K, its own and those to the two nodes before it.
#[derive(Clone, Copy, Debug)]
struct Factor {
    inverse: Matrix,
    near: Matrix,
    far: Matrix,
    /// The right side on its way.
    right: [Wide; 3],
}

impl Factors {
    /// Makes room for `nodes` nodes.
    pub fn resize(&mut self, nodes: usize) {
        self.0.resize(nodes, Factor { inverse: ZERO, near: ZERO, far: ZERO, right: [[0.0; LANES]; 3] });
    }
}

impl Bend {
    /// For the strands of a packet as they are at home; `stiffness` in cm^4/s^2, `step` in s.
    ///
    /// With a `load`, an acceleration in cm/s^2, the shape is at rest under it: every segment is wanted turned against it
    /// by as much as the load beyond it bends it, but by no more than about 45 degrees.
    pub fn new(packet: &Packet, stiffness: f32, step: f32, load: Vec3, pose: &Affine3A) -> Self {
        let nodes = packet.nodes;
        let mut bend = Self {
            local: Plane::new(nodes),
            strength: [0.0; LANES],
            tangent: [[0.0; LANES]; 3],
            normal: [[0.0; LANES]; 3],
            frames: Plane::new(nodes),
            give: 1.0 - trig::exp(-step / TWIST),
        };
        for l in 0..LANES {
            if packet.strands[l] != NONE {
                bend.place(packet, l, stiffness * step * step, load * (step * step));
                for k in 0..packet.counts[l] {
                    let n = bend.frames.get(k, l);
                    bend.frames.set(k, l, pose.transform_vector3(n));
                }
            }
        }
        bend
    }

    fn place(&mut self, packet: &Packet, l: usize, stiffness: f32, load: Vec3) {
        let count = packet.counts[l];
        let points: Vec<Vec3> = (0..count).map(|k| packet.home.get(k, l)).collect();
        let mean = points.windows(2).map(|w| w[0].distance(w[1])).sum::<f32>() / (count - 1) as f32;
        let c = stiffness / (mean * mean * mean * mean);
        self.strength[l] = c;
        let mut t = (points[1] - points[0]).normalize();
        let mut n = t.any_orthonormal_vector();
        for k in 0..3 {
            (self.tangent[k][l], self.normal[k][l]) = (t[k], n[k]);
        }
        // The moment that the load on all nodes from each one on has about the node before it.
        let mut moments = vec![Vec3::ZERO; count];
        let (mut sum, mut moment) = (Vec3::ZERO, Vec3::ZERO);
        for k in (1..count).rev() {
            sum += load;
            moment += (points[k] - points[k - 1]).cross(sum);
            moments[k] = moment;
        }
        for k in 1..count {
            let d = points[k] - points[k - 1];
            let against = d.cross(moments[k]) / (c * d.length_squared());
            let wanted = d + against.clamp_length_max(d.length());
            self.local.set(k, l, Vec3::new(wanted.dot(t), wanted.dot(n), wanted.dot(t.cross(n))));
            let next = d.normalize();
            n = carried(n, t, next);
            t = next;
            self.frames.set(k, l, n);
        }
    }

    /// Moves places that inertia has led to on by accelerations times h^2, given in `force`, and by bending; `turn` is the
    /// head's rotation, by columns.
    #[inline(always)]
    pub fn apply(
        &mut self,
        at: &mut Plane,
        strand: (&[Lanes], &[Lanes]),
        turn: &[[f32; 3]; 3],
        force: &mut Plane,
        factors: &mut Factors,
    ) {
        self.gather(at, strand, turn, force, factors);
        factors.factor(strand.0.len());
        factors.solve(at, strand.0, force);
    }

    /// Adds h^2 F to `force`, and writes h^2 K.
    #[inline(always)]
    fn gather(
        &mut self,
        at: &Plane,
        (free, rest): (&[Lanes], &[Lanes]),
        turn: &[[f32; 3]; 3],
        force: &mut Plane,
        factors: &mut Factors,
    ) {
        let nodes = free.len();
        let turned = |v: &[Lanes; 3]| {
            [0, 1, 2].map(|k| each(|l| turn[0][k] * v[0][l] + turn[1][k] * v[1][l] + turn[2][k] * v[2][l]))
        };
        let (mut t, mut n) = (turned(&self.tangent), turned(&self.normal));
        // Of the segment before: its vector, and one over its squared length.
        let (mut before, mut one_over_before) = ([[0.0; LANES]; 3], [0.0; LANES]);
        // The blocks of K that are not complete yet: (k-1, k-1), (k-1, k-2) and (k-2, k-2), (k-2, k-3), (k-2, k-4).
        let (mut middle, mut middle_near, mut middle_far) = (ZERO, ZERO, ZERO);
        let (mut old, mut old_near, mut old_far) = (ZERO, ZERO, ZERO);
        for k in 1..nodes {
            let b = cross(&t, &n);
            let local = self.local.row(k);
            let mut wanted = scaled(&t, &local[0]);
            add_scaled(&mut wanted, &n, &local[1]);
            add_scaled(&mut wanted, &b, &local[2]);
            let d = minus(&at.row(k), &at.row(k - 1));
            let square = dot(&d, &d);
            // A segment that a prediction has squeezed has no shorter a lever than half its length.
            let one_over = each(|l| 1.0 / square[l].max(0.25 * rest[k][l] * rest[k][l]).max(1e-12));
            let (mut here, mut here_near, mut here_far) = (ZERO, ZERO, ZERO);
            if k >= 2 {
                // Idle segments pull at nothing.
                let strength = each(|l| if rest[k][l] > 0.0 { self.strength[l] } else { 0.0 });
                let wanted = wanted.map(wide);
                let p = across(&d.map(wide));
                let q = riding(&before.map(wide), &wanted, &wide(one_over_before));
                let back = product(&p, &q);
                let one = sum(&p, &back, -1.0, -1.0);
                let pull = scaled_wide(&of(&p, &wanted), &wide(strength));
                let reaction = of_transposed(&back, &pull).map(narrow);
                let pull = pull.map(narrow);
                let (mut f0, mut f1, mut f2) = (force.row(k), force.row(k - 1), force.row(k - 2));
                for c in 0..3 {
                    for l in 0..LANES {
                        f0[c][l] += pull[c][l];
                        f1[c][l] -= pull[c][l] + reaction[c][l];
                        f2[c][l] += reaction[c][l];
                    }
                }
                force.put(k, f0);
                force.put(k - 1, f1);
                force.put(k - 2, f2);
                let (w0, w1, w2) = (&free[k], &free[k - 1], &free[k - 2]);
                let weight = |a: &Lanes, b: &Lanes| wide(each(|l| strength[l] * a[l] * b[l]));
                here = times(&p, &weight(w0, w0));
                here_near = times(&one, &weight(w0, w1));
                here_far = times(&back, &weight(w0, w2));
                add(&mut middle, &transposed_product(&one, &one), &weight(w1, w1));
                add(&mut middle_near, &transposed_product(&one, &back), &weight(w1, w2));
                add(&mut old, &transposed_product(&back, &back), &weight(w2, w2));
            }
            if k >= 2 {
                factors.put(k - 2, &old, &old_near, &old_far);
            }
            (old, old_near, old_far) = (middle, middle_near, middle_far);
            (middle, middle_near, middle_far) = (here, here_near, here_far);
            // The frame goes on along the segment as it is.
            let one_over_length = each(|l| 1.0 / square[l].max(1e-12).sqrt());
            let next = scaled(&d, &one_over_length);
            let space = carried_lanes(&n, &t, &next);
            n = if k == 1 { space } else { self.frame(k, &next, &space) };
            self.frames.put(k, n);
            t = next;
            before = d;
            one_over_before = one_over;
        }
        if nodes >= 2 {
            factors.put(nodes - 2, &old, &old_near, &old_far);
        }
        factors.put(nodes - 1, &middle, &middle_near, &middle_far);
    }

    /// The normal of segment `k`, whose tangent is `t`: its own, giving in to that which its neighbour has carried to it.
    #[inline(always)]
    fn frame(&self, k: usize, t: &[Lanes; 3], space: &[Lanes; 3]) -> [Lanes; 3] {
        let own = self.frames.row(k);
        let along = dot(&own, t);
        let own = [0, 1, 2].map(|c| each(|l| own[c][l] - t[c][l] * along[l]));
        let square = dot(&own, &own);
        let one_over = each(|l| 1.0 / square[l].max(1e-12).sqrt());
        let mixed = [0, 1, 2].map(|c| {
            each(|l| {
                let own = own[c][l] * one_over[l];
                // A segment that has turned by a right angle at once has no frame of its own any more.
                if square[l] > 0.05 { own + (space[c][l] - own) * self.give } else { space[c][l] }
            })
        });
        let square = dot(&mixed, &mixed);
        let one_over = each(|l| 1.0 / square[l].max(1e-12).sqrt());
        scaled(&mixed, &one_over)
    }
}

impl Factors {
    /// Takes the blocks of a node of h^2 K.
    #[inline(always)]
    fn put(&mut self, k: usize, own: &Matrix, near: &Matrix, far: &Matrix) {
        self.0[k] = Factor { inverse: *own, near: *near, far: *far, right: [[0.0; LANES]; 3] };
    }

    /// Factors 1 + h^2 K as L D L^T, block by block, from the tip to the root. K is a sum of squares in which the first
    /// node of each is a strand's next one, so that in this order pivots stay large; the other way round they shrink to
    /// the stiffness of the tip, some 10^5 times less, and are lost in rounding.
    #[inline(always)]
    fn factor(&mut self, nodes: usize) {
        // Blocks of K between a node and the two after it, as they were before factoring.
        let (mut near_after, mut far_after, mut far_after_next) = (ZERO, ZERO, ZERO);
        for k in (0..nodes).rev() {
            let Factor { inverse: mut pivot, near, far, .. } = self.0[k];
            for (c, row) in pivot.iter_mut().enumerate() {
                for l in 0..LANES {
                    row[c][l] += 1.0;
                }
            }
            let (mut near_factor, mut far_factor) = (ZERO, ZERO);
            let mut left = transposed(&near_after);
            if k + 2 < nodes {
                let across = transposed(&far_after);
                far_factor = product(&across, &self.0[k + 2].inverse);
                left = sum(&left, &product_transposed(&across, &self.0[k + 1].near), 1.0, -1.0);
                pivot = sum(&pivot, &product_transposed(&far_factor, &across), 1.0, -1.0);
            }
            if k + 1 < nodes {
                near_factor = product(&left, &self.0[k + 1].inverse);
                pivot = sum(&pivot, &product_transposed(&near_factor, &left), 1.0, -1.0);
            }
            self.0[k] =
                Factor { inverse: inverse(&pivot), near: near_factor, far: far_factor, right: [[0.0; LANES]; 3] };
            (near_after, far_after, far_after_next) = (near, far_after_next, far);
        }
    }

    /// Solves for the way and adds it.
    #[inline(always)]
    fn solve(&mut self, at: &mut Plane, free: &[Lanes], force: &Plane) {
        let nodes = free.len();
        let zero = [[0.0; LANES]; 3];
        let (mut one, mut two) = (zero, zero);
        for k in (0..nodes).rev() {
            let mut z = scaled(&force.row(k), &free[k]).map(wide);
            take(&mut z, &of(&self.0[k].near, &one));
            take(&mut z, &of(&self.0[k].far, &two));
            self.0[k].right = z;
            (two, one) = (one, z);
        }
        let (mut one, mut two) = (zero, zero);
        for k in 0..nodes {
            let mut x = of(&self.0[k].inverse, &self.0[k].right);
            if k >= 1 {
                take(&mut x, &of_transposed(&self.0[k - 1].near, &one));
            }
            if k >= 2 {
                take(&mut x, &of_transposed(&self.0[k - 2].far, &two));
            }
            let mut row = at.row(k);
            for c in 0..3 {
                for l in 0..LANES {
                    row[c][l] += if free[k][l] > 0.0 { x[c][l] as f32 } else { 0.0 };
                }
            }
            at.put(k, row);
            (two, one) = (one, x);
        }
    }
}

/// In double precision.
#[inline(always)]
fn wide(a: Lanes) -> Wide {
    let mut out = [0.0; LANES];
    for l in 0..LANES {
        out[l] = f64::from(a[l]);
    }
    out
}

/// In single precision.
#[inline(always)]
fn narrow(a: Wide) -> Lanes {
    each(|l| a[l] as f32)
}

/// Made lane by lane.
#[inline(always)]
fn each_wide(mut make: impl FnMut(usize) -> f64) -> Wide {
    let mut out = [0.0; LANES];
    for (l, to) in out.iter_mut().enumerate() {
        *to = make(l);
    }
    out
}

#[inline(always)]
fn dot_wide(a: &[Wide; 3], b: &[Wide; 3]) -> Wide {
    each_wide(|l| a[0][l] * b[0][l] + a[1][l] * b[1][l] + a[2][l] * b[2][l])
}

#[inline(always)]
fn cross_wide(a: &[Wide; 3], b: &[Wide; 3]) -> [Wide; 3] {
    [
        each_wide(|l| a[1][l] * b[2][l] - a[2][l] * b[1][l]),
        each_wide(|l| a[2][l] * b[0][l] - a[0][l] * b[2][l]),
        each_wide(|l| a[0][l] * b[1][l] - a[1][l] * b[0][l]),
    ]
}

#[inline(always)]
fn scaled_wide(a: &[Wide; 3], s: &Wide) -> [Wide; 3] {
    [each_wide(|l| a[0][l] * s[l]), each_wide(|l| a[1][l] * s[l]), each_wide(|l| a[2][l] * s[l])]
}

/// `a^T`.
#[inline(always)]
fn transposed(a: &Matrix) -> Matrix {
    [[a[0][0], a[1][0], a[2][0]], [a[0][1], a[1][1], a[2][1]], [a[0][2], a[1][2], a[2][2]]]
}

/// 1 - d d^T / D: exactly a projector, for K relies on it.
#[inline(always)]
fn across(d: &[Wide; 3]) -> Matrix {
    let one_over = dot_wide(d, d);
    let one_over = each_wide(|l| 1.0 / one_over[l].max(1e-24));
    let mut out = ZERO;
    for r in 0..3 {
        for c in 0..3 {
            let own = if r == c { 1.0 } else { 0.0 };
            out[r][c] = each_wide(|l| own - d[r][l] * d[c][l] * one_over[l]);
        }
    }
    out
}

/// The matrix Q of `v (d . T) / D - d (v . T) / D`.
#[inline(always)]
fn riding(d: &[Wide; 3], wanted: &[Wide; 3], one_over: &Wide) -> Matrix {
    let along = dot_wide(d, wanted);
    let mut out = ZERO;
    for r in 0..3 {
        for c in 0..3 {
            out[r][c] = each_wide(|l| {
                let own = if r == c { along[l] } else { 0.0 };
                (own - d[r][l] * wanted[c][l]) * one_over[l]
            });
        }
    }
    out
}

/// `a b`.
#[inline(always)]
fn product(a: &Matrix, b: &Matrix) -> Matrix {
    let mut out = ZERO;
    for r in 0..3 {
        for c in 0..3 {
            out[r][c] = each_wide(|l| a[r][0][l] * b[0][c][l] + a[r][1][l] * b[1][c][l] + a[r][2][l] * b[2][c][l]);
        }
    }
    out
}

/// `a b^T`.
#[inline(always)]
fn product_transposed(a: &Matrix, b: &Matrix) -> Matrix {
    let mut out = ZERO;
    for r in 0..3 {
        for c in 0..3 {
            out[r][c] = dot_wide(&a[r], &b[c]);
        }
    }
    out
}

/// `a^T b`.
#[inline(always)]
fn transposed_product(a: &Matrix, b: &Matrix) -> Matrix {
    let mut out = ZERO;
    for r in 0..3 {
        for c in 0..3 {
            out[r][c] = each_wide(|l| a[0][r][l] * b[0][c][l] + a[1][r][l] * b[1][c][l] + a[2][r][l] * b[2][c][l]);
        }
    }
    out
}

/// `a s + b t`.
#[inline(always)]
fn sum(a: &Matrix, b: &Matrix, s: f64, t: f64) -> Matrix {
    let mut out = ZERO;
    for r in 0..3 {
        for c in 0..3 {
            out[r][c] = each_wide(|l| a[r][c][l] * s + b[r][c][l] * t);
        }
    }
    out
}

/// `a` times a number of each strand.
#[inline(always)]
fn times(a: &Matrix, s: &Wide) -> Matrix {
    [scaled_wide(&a[0], s), scaled_wide(&a[1], s), scaled_wide(&a[2], s)]
}

/// Adds `b` times a number of each strand.
#[inline(always)]
fn add(a: &mut Matrix, b: &Matrix, s: &Wide) {
    for (a, b) in a.iter_mut().zip(b) {
        for (a, b) in a.iter_mut().zip(b) {
            for l in 0..LANES {
                a[l] += b[l] * s[l];
            }
        }
    }
}

/// `a v`.
#[inline(always)]
fn of(a: &Matrix, v: &[Wide; 3]) -> [Wide; 3] {
    [dot_wide(&a[0], v), dot_wide(&a[1], v), dot_wide(&a[2], v)]
}

/// `a^T v`.
#[inline(always)]
fn of_transposed(a: &Matrix, v: &[Wide; 3]) -> [Wide; 3] {
    [0, 1, 2].map(|c| each_wide(|l| a[0][c][l] * v[0][l] + a[1][c][l] * v[1][l] + a[2][c][l] * v[2][l]))
}

/// Takes `b` from `a`.
#[inline(always)]
fn take(a: &mut [Wide; 3], b: &[Wide; 3]) {
    for (a, b) in a.iter_mut().zip(b) {
        for l in 0..LANES {
            a[l] -= b[l];
        }
    }
}

/// The inverse of a symmetric matrix that is at least 1.
#[inline(always)]
fn inverse(a: &Matrix) -> Matrix {
    // What rounding has left unsymmetric would grow from node to node.
    let mut s = *a;
    for r in 0..3 {
        for c in 0..3 {
            s[r][c] = each_wide(|l| 0.5 * (a[r][c][l] + a[c][r][l]));
        }
    }
    let a = &s;
    let (r0, mut r1, mut r2) = (cross_wide(&a[1], &a[2]), cross_wide(&a[2], &a[0]), cross_wide(&a[0], &a[1]));
    (r1[0], r2[0], r2[1]) = (r0[1], r0[2], r1[2]);
    // Below 1 it is by rounding only.
    let one_over = dot_wide(&a[0], &r0);
    let one_over = each_wide(|l| 1.0 / one_over[l].max(1.0));
    [scaled_wide(&r0, &one_over), scaled_wide(&r1, &one_over), scaled_wide(&r2, &one_over)]
}

/// The normal `n` of the unit tangent `t` after the smallest turn that takes `t` to `next`.
fn carried(n: Vec3, t: Vec3, next: Vec3) -> Vec3 {
    let n = n - (t + next) * (n.dot(next) / (1.0 + t.dot(next)).max(1e-3));
    let n = n - next * n.dot(next);
    n * (1.0 / n.length_squared().max(1e-12)).sqrt()
}

/// The same for eight strands.
#[inline(always)]
fn carried_lanes(n: &[Lanes; 3], t: &[Lanes; 3], next: &[Lanes; 3]) -> [Lanes; 3] {
    let (along, same) = (dot(n, next), dot(t, next));
    let factor = each(|l| along[l] / (1.0 + same[l]).max(1e-3));
    let n = [0, 1, 2].map(|c| each(|l| n[c][l] - (t[c][l] + next[c][l]) * factor[l]));
    let along = dot(&n, next);
    let n = [0, 1, 2].map(|c| each(|l| n[c][l] - next[c][l] * along[l]));
    let square = dot(&n, &n);
    let one_over = each(|l| 1.0 / square[l].max(1e-12).sqrt());
    scaled(&n, &one_over)
}

#[cfg(test)]
mod tests {
    use super::super::packet::{Making, pack};
    use super::super::tests::curl;
    use super::*;
    use crate::math::rng::Key;

    /// A packet with one curl, whose first two nodes are pinned.
    fn packet(stiffness: f32) -> Packet {
        let making = Making {
            pinned: &[],
            clamped: true,
            stiffness,
            load: Vec3::ZERO,
            step: 1.0 / 240.0,
            margin: 0.0,
            repels: false,
            pose: Affine3A::IDENTITY,
            loose: false,
        };
        pack(&curl(60, 0.4, 0.3, 0.45), &making).remove(0)
    }

    const STILL: [[f32; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

    fn gathered(bend: &Bend, packet: &Packet, at: &Plane) -> (Plane, Factors) {
        let (mut bend, mut force, mut factors) = (bend.clone(), Plane::new(packet.nodes), Factors::default());
        bend.give = 0.0;
        factors.resize(packet.nodes);
        bend.gather(at, (&packet.free, &packet.rest), &STILL, &mut force, &mut factors);
        (force, factors)
    }

    fn some(key: Key, packet: &Packet, size: f32) -> Plane {
        let mut plane = Plane::new(packet.nodes);
        for k in 2..packet.nodes {
            plane.set(k, 0, key.with(k as u64).direction() * size);
        }
        plane
    }

    fn times_k(factors: &Factors, v: &Plane, k: usize, nodes: usize) -> Vec3 {
        let at =
            |m: &Matrix, v: Vec3| Vec3::from_array([0, 1, 2].map(|r| (0..3).map(|c| m[r][c][0] as f32 * v[c]).sum()));
        let f = &factors.0;
        let mut sum = at(&f[k].inverse, v.get(k, 0));
        for (other, far) in [(1, false), (2, true)] {
            if k >= other {
                sum += at(if far { &f[k].far } else { &f[k].near }, v.get(k - other, 0));
            }
            if k + other < nodes {
                let m = transposed(if far { &f[k + other].far } else { &f[k + other].near });
                sum += at(&m, v.get(k + other, 0));
            }
        }
        sum
    }

    #[test]
    fn the_matrix_is_the_derivative_of_the_force() {
        let packet = packet(2e5);
        let bend = packet.bend.clone().unwrap();
        let (rest, factors) = gathered(&bend, &packet, &packet.at);
        let by = some(Key::new(1, "by"), &packet, 2e-3);
        let mut moved = packet.at.clone();
        for k in 0..packet.nodes {
            moved.set(k, 0, packet.at.get(k, 0) + by.get(k, 0));
        }
        let (force, _) = gathered(&bend, &packet, &moved);
        for k in 2..packet.nodes {
            let (change, expected) = (force.get(k, 0) - rest.get(k, 0), -times_k(&factors, &by, k, packet.nodes));
            assert!(change.distance(expected) < 0.03 * expected.length() + 2e-3, "node {k}: {change} {expected}");
        }
    }

    #[test]
    fn the_system_is_solved() {
        for stiffness in [1e2, 1e4, 1e6] {
            let packet = packet(stiffness);
            let bend = packet.bend.clone().unwrap();
            let (_, plain) = gathered(&bend, &packet, &packet.at);
            let mut factors = plain.clone();
            factors.factor(packet.nodes);
            let right = some(Key::new(2, "right"), &packet, 1.0);
            let mut way = Plane::new(packet.nodes);
            factors.solve(&mut way, &packet.free, &right);
            for k in 2..packet.nodes {
                let left = way.get(k, 0) + times_k(&plain, &way, k, packet.nodes);
                assert!(left.distance(right.get(k, 0)) < 0.03, "{stiffness}, node {k}: {left} {}", right.get(k, 0));
            }
        }
    }

    /// Near rest, what is left of a small displacement after bending is (1 + h^2 K)^-1 of it: never more of it than there
    /// was, and the same seen from any other displacement.
    #[test]
    fn bending_only_ever_calms() {
        for stiffness in [1e3, 1e5, 6e5] {
            let packet = packet(stiffness);
            let bend = packet.bend.clone().unwrap();
            let left = |by: &Plane| {
                let (mut bend, mut force, mut factors) = (bend.clone(), Plane::new(packet.nodes), Factors::default());
                bend.give = 0.0;
                factors.resize(packet.nodes);
                let mut at = packet.at.clone();
                for k in 0..packet.nodes {
                    at.set(k, 0, packet.at.get(k, 0) + by.get(k, 0));
                }
                bend.apply(&mut at, (&packet.free, &packet.rest), &STILL, &mut force, &mut factors);
                let mut left = Plane::new(packet.nodes);
                for k in 0..packet.nodes {
                    left.set(k, 0, at.get(k, 0) - packet.at.get(k, 0));
                }
                left
            };
            let dot = |a: &Plane, b: &Plane| (0..packet.nodes).map(|k| a.get(k, 0).dot(b.get(k, 0))).sum::<f32>();
            for i in 0..6 {
                let (a, b) = (some(Key::new(i, "a"), &packet, 1e-3), some(Key::new(i, "b"), &packet, 1e-3));
                let (ma, mb) = (left(&a), left(&b));
                let size = (dot(&a, &a) * dot(&b, &b)).sqrt();
                assert!(dot(&ma, &ma) <= 1.001 * dot(&a, &a), "{stiffness}: {} of {}", dot(&ma, &ma), dot(&a, &a));
                let (one, other) = (dot(&b, &ma), dot(&a, &mb));
                assert!((one - other).abs() < 0.01 * size, "{stiffness}: {one} and {other} of {size}");
            }
        }
    }
}
