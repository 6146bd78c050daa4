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
//! u = (1 + c R^T R)^-1 (f + c R^T e),      f = h^2 a,      c = h^2 B / r^4
//! ```
//!
//! with a the acceleration of the force objects. R_k u, two numbers, is how segment k turns away from its T when nodes
//! k-2, k-1 and k move, and e_k, two as well, how far it is from T now:
//!
//! ```text
//! R_k u = A_k (u_k - u_(k-1)) - B_k (u_(k-1) - u_(k-2)),     e_k = A_k T_k,     B_k = A_k Q_k
//! Q_k v = (v (d . T) - d (v . T)) / D
//! ```
//!
//! with the rows of A_k the normal and the binormal of segment k, and d in Q_k the vector of segment k-1. The moments
//! y = c (R u - e) are solved for in place of the way,
//!
//! ```text
//! (1 / c + R R^T) y = R f - e,      u = f - R^T y
//! ```
//!
//! since there are two of them to a segment and three coordinates to a node: a symmetric system in blocks of two by two,
//! two off the diagonal, solved exactly from root to tip and back. Where hair is at rest u vanishes only with a and the
//! springs' forces.

use glam::{Affine3A, Vec3};

use super::lanes::{LANES, Lanes, Plane, add_scaled, cross, dot, each, minus, scaled, three, two};
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

/// Half of the lanes: what is worked on in double precision. What matters of R R^T are its least parts, some 10^-6 of it
/// for long strands, and in single precision soft shapes would gain energy by their loss.
const HALF: usize = LANES / 2;

/// A number of four strands.
type Wide = [f64; HALF];

/// Two rows of three numbers: how a segment turns as a node moves.
type Rows = [[Wide; 3]; 2];

/// A matrix of two by two, row by row.
type Matrix = [[Wide; 2]; 2];

const ZERO: Wide = [0.0; HALF];

/// Memory of the system, node by node.
#[derive(Clone, Debug, Default)]
pub struct Factors(Vec<Joint>);

/// What belongs to the joint in front of a segment.
#[derive(Clone, Copy, Debug)]
struct Joint {
    /// A and B of the segment at its end.
    a: [[Lanes; 3]; 2],
    b: [[Lanes; 3]; 2],
    /// How far the segment is from where it is wanted.
    off: [Lanes; 2],
    /// 1 / c.
    soft: Lanes,
    /// The factors.
    halves: [Half; 2],
}

/// The factors of four strands: the blocks to the two joints before, and the moments on their way.
#[derive(Clone, Copy, Debug)]
struct Half {
    near: Matrix,
    far: Matrix,
    right: [Wide; 2],
    /// The way of the node in the end.
    way: [Wide; 3],
}

const NO_HALF: Half = Half { near: [[ZERO; 2]; 2], far: [[ZERO; 2]; 2], right: [ZERO; 2], way: [ZERO; 3] };
const NO_ROWS: [[Lanes; 3]; 2] = [[[0.0; LANES]; 3]; 2];
const NO_JOINT: Joint =
    Joint { a: NO_ROWS, b: NO_ROWS, off: [[0.0; LANES]; 2], soft: [1.0; LANES], halves: [NO_HALF; 2] };

impl Factors {
    /// Makes room for `nodes` nodes.
    pub fn resize(&mut self, nodes: usize) {
        self.0.resize(nodes, NO_JOINT);
        // The first two belong to no joint.
        self.0.iter_mut().take(2).for_each(|j| *j = NO_JOINT);
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

    /// Of strands of other packets, each given by its lane and the number of its nodes.
    pub fn regrouped(some: &[(&Self, usize, usize)], nodes: usize) -> Option<Self> {
        let mut bend = Self {
            local: Plane::new(nodes),
            strength: [0.0; LANES],
            tangent: [[0.0; LANES]; 3],
            normal: [[0.0; LANES]; 3],
            frames: Plane::new(nodes),
            give: some.first()?.0.give,
        };
        for (l, &(from, lane, count)) in some.iter().enumerate() {
            bend.strength[l] = from.strength[lane];
            for c in 0..3 {
                bend.tangent[c][l] = from.tangent[c][lane];
                bend.normal[c][l] = from.normal[c][lane];
            }
            for k in 0..count {
                bend.local.set(k, l, from.local.get(k, lane));
                bend.frames.set(k, l, from.frames.get(k, lane));
            }
        }
        Some(bend)
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
        force: &Plane,
        factors: &mut Factors,
    ) {
        self.gather(at, strand, turn, factors);
        for half in 0..2 {
            factors.factor(strand.0, force, half);
            factors.solve(strand.0.len(), force, half);
        }
        factors.go(at, strand.0);
    }

    /// Writes A, B and e of every joint.
    #[inline(always)]
    fn gather(&mut self, at: &Plane, (free, rest): (&[Lanes], &[Lanes]), turn: &[[f32; 3]; 3], factors: &mut Factors) {
        let (mut t, mut n) = (turned(turn, &self.tangent), turned(turn, &self.normal));
        let mut b = cross(&t, &n);
        // Of the segment before: its vector, and one over its squared length.
        let (mut before, mut one_over_before) = ([[0.0; LANES]; 3], [0.0; LANES]);
        let soft = each(|l| 1.0 / self.strength[l].max(1e-12));
        for k in 1..free.len() {
            let local = self.local.row(k);
            let mut wanted = scaled(&t, &local[0]);
            add_scaled(&mut wanted, &n, &local[1]);
            add_scaled(&mut wanted, &b, &local[2]);
            let d = minus(&at.row(k), &at.row(k - 1));
            let square = dot(&d, &d);
            // The frame goes on along the segment as it is.
            let one_over_length = each(|l| 1.0 / square[l].max(1e-12).sqrt());
            let next = scaled(&d, &one_over_length);
            let space = carried_lanes(&n, &t, &next);
            n = if k == 1 { space } else { self.frame(k, &next, &space) };
            self.frames.put(k, n);
            t = next;
            b = cross(&t, &n);
            if k >= 2 {
                let joint = &mut factors.0[k];
                // Idle segments pull at nothing.
                let is_live = each(|l| if rest[k][l] > 0.0 { 1.0 } else { 0.0 });
                let along = dot(&before, &wanted);
                let along = each(|l| along[l] * one_over_before[l]);
                let own = [n, b];
                for i in 0..2 {
                    let across = dot(&own[i], &before);
                    let across = each(|l| across[l] * one_over_before[l]);
                    let a = scaled(&own[i], &is_live);
                    joint.a[i] = a;
                    joint.b[i] = three!(c => each(|l| a[c][l] * along[l] - is_live[l] * wanted[c][l] * across[l]));
                    joint.off[i] = dot(&a, &wanted);
                }
                joint.soft = soft;
            }
            before = d;
            // A segment that a prediction has squeezed has no shorter a lever than half its length.
            one_over_before = each(|l| 1.0 / square[l].max(0.25 * rest[k][l] * rest[k][l]).max(1e-12));
        }
    }

    /// The normal of segment `k`, whose tangent is `t`: its own, giving in to that which its neighbour has carried to it.
    #[inline(always)]
    fn frame(&self, k: usize, t: &[Lanes; 3], space: &[Lanes; 3]) -> [Lanes; 3] {
        let own = self.frames.row(k);
        let along = dot(&own, t);
        let own = three!(c => each(|l| own[c][l] - t[c][l] * along[l]));
        let square = dot(&own, &own);
        let one_over = each(|l| 1.0 / square[l].max(1e-12).sqrt());
        // A segment that has turned by a right angle at once has no frame of its own any more.
        let give = each(|l| if square[l] > 0.05 { self.give } else { 1.0 });
        let mixed = three!(c => each(|l| {
            let own = own[c][l] * one_over[l];
            own + (space[c][l] - own) * give[l]
        }));
        let square = dot(&mixed, &mixed);
        let one_over = each(|l| 1.0 / square[l].max(1e-12).sqrt());
        scaled(&mixed, &one_over)
    }
}

impl Factors {
    /// Factors 1 / c + R R^T of four strands as L D L^T, block by block, from the root to the tip, and goes on with
    /// R f - e. Each segment has a node that none before it has, with rows of length 1 in R: no pivot is less than 1,
    /// but where that node is pinned.
    #[inline(always)]
    fn factor(&mut self, free: &[Lanes], force: &Plane, half: usize) {
        let mut pull = [[ZERO; 3], row_of(force, 0, half), row_of(force, 1, half)];
        let mut weight = [ZERO, half_of(&free[0], half), half_of(&free[1], half)];
        // Of the two joints before: rows, factors, inverse pivots and right sides.
        let (mut a1, mut a2, mut s1) = ([[ZERO; 3]; 2], [[ZERO; 3]; 2], [[ZERO; 3]; 2]);
        let mut near1 = [[ZERO; 2]; 2];
        let (mut inverse1, mut inverse2) = ([ZERO; 3], [ZERO; 3]);
        let (mut right1, mut right2) = ([ZERO; 2], [ZERO; 2]);
        for k in 2..free.len() {
            pull = [pull[1], pull[2], row_of(force, k, half)];
            weight = [weight[1], weight[2], half_of(&free[k], half)];
            let [w2, w1, w0] = &weight;
            let joint = &mut self.0[k];
            let (a, b) = (rows(&joint.a, half), rows(&joint.b, half));
            let s = two!(i => three!(c => made(|l| (a[i][c][l] + b[i][c][l]) * w1[l])));
            let b = two!(i => three!(c => made(|l| b[i][c][l] * w2[l])));
            let a = two!(i => three!(c => made(|l| a[i][c][l] * w0[l])));
            let (soft, off) = (half_of(&joint.soft, half), two!(i => half_of(&joint.off[i], half)));
            let across = two!(i => two!(j => dots(&b[i], &a2[j])));
            let far = times_inverse(&across, &inverse2);
            let left = two!(i => two!(j => {
                let (x, y) = (dots(&s[i], &a1[j]), dots(&b[i], &s1[j]));
                made(|l| -x[l] - y[l] - across[i][0][l] * near1[j][0][l] - across[i][1][l] * near1[j][1][l])
            }));
            let near = times_inverse(&left, &inverse1);
            let pivot = two!(i => two!(j => {
                let (x, y, z) = (dots(&a[i], &a[j]), dots(&s[i], &s[j]), dots(&b[i], &b[j]));
                made(|l| {
                    x[l] + y[l] + z[l] + if i == j { soft[l] } else { 0.0 }
                        - (far[i][0][l] * across[j][0][l] + far[i][1][l] * across[j][1][l])
                        - (near[i][0][l] * left[j][0][l] + near[i][1][l] * left[j][1][l])
                })
            }));
            let inverse = inverse(&[pivot[0][0], pivot[1][0], pivot[1][1]]);
            let right = two!(i => {
                let (x, y, z) = (dots(&a[i], &pull[2]), dots(&s[i], &pull[1]), dots(&b[i], &pull[0]));
                made(|l| {
                    x[l] - y[l] + z[l]
                        - off[i][l]
                        - (near[i][0][l] * right1[0][l] + near[i][1][l] * right1[1][l])
                        - (far[i][0][l] * right2[0][l] + far[i][1][l] * right2[1][l])
                })
            });
            let half = &mut joint.halves[half];
            (half.near, half.far) = (near, far);
            half.right = [
                made(|l| inverse[0][l] * right[0][l] + inverse[1][l] * right[1][l]),
                made(|l| inverse[1][l] * right[0][l] + inverse[2][l] * right[1][l]),
            ];
            (a2, a1, s1, near1) = (a1, a, s, near);
            (inverse2, inverse1, right2, right1) = (inverse1, inverse, right1, right);
        }
    }

    /// Solves for the moments, and for the way of every node.
    #[inline(always)]
    fn solve(&mut self, nodes: usize, force: &Plane, half: usize) {
        // What the segments that are done already ask for: y of the two after, and the way of the two nodes before.
        let (mut near, mut far, mut far_next) = ([ZERO; 2], [ZERO; 2], [ZERO; 2]);
        let (mut one, mut other) = ([ZERO; 3], [ZERO; 3]);
        for k in (0..nodes).rev() {
            let joint = &self.0[k];
            let own = &joint.halves[half];
            let y = two!(i => made(|l| own.right[i][l] - near[i][l] - far[i][l]));
            let (a, b) = (rows(&joint.a, half), rows(&joint.b, half));
            let by_a = three!(c => made(|l| a[0][c][l] * y[0][l] + a[1][c][l] * y[1][l]));
            let by_b = three!(c => made(|l| b[0][c][l] * y[0][l] + b[1][c][l] * y[1][l]));
            let force = row_of(force, k, half);
            self.0[k].halves[half].way = three!(c => made(|l| force[c][l] - by_a[c][l] + one[c][l]));
            let own = &self.0[k].halves[half];
            one = three!(c => made(|l| by_a[c][l] + by_b[c][l] + other[c][l]));
            other = three!(c => made(|l| -by_b[c][l]));
            near = two!(j => made(|l| own.near[0][j][l] * y[0][l] + own.near[1][j][l] * y[1][l]));
            far = far_next;
            far_next = two!(j => made(|l| own.far[0][j][l] * y[0][l] + own.far[1][j][l] * y[1][l]));
        }
    }
}

impl Factors {
    /// Moves nodes by their ways.
    #[inline(always)]
    fn go(&self, at: &mut Plane, free: &[Lanes]) {
        for (k, free) in free.iter().enumerate() {
            let halves = &self.0[k].halves;
            let row = at.row(k);
            let row = three!(c => each(|l| {
                let way = halves[l / HALF].way[c][l % HALF] as f32;
                row[c][l] + if free[l] > 0.0 { way } else { 0.0 }
            }));
            at.put(k, row);
        }
    }
}

/// Four of the lanes, in double precision.
#[inline(always)]
fn half_of(a: &Lanes, half: usize) -> Wide {
    made(|l| f64::from(a[half * HALF + l]))
}

#[inline(always)]
fn rows(a: &[[Lanes; 3]; 2], half: usize) -> Rows {
    two!(i => three!(c => half_of(&a[i][c], half)))
}

#[inline(always)]
fn row_of(plane: &Plane, k: usize, half: usize) -> [Wide; 3] {
    [half_of(&plane.x[k], half), half_of(&plane.y[k], half), half_of(&plane.z[k], half)]
}

/// Made lane by lane.
#[inline(always)]
fn made(mut make: impl FnMut(usize) -> f64) -> Wide {
    let mut out = ZERO;
    for (l, to) in out.iter_mut().enumerate() {
        *to = make(l);
    }
    out
}

#[inline(always)]
fn dots(a: &[Wide; 3], b: &[Wide; 3]) -> Wide {
    made(|l| a[0][l] * b[0][l] + a[1][l] * b[1][l] + a[2][l] * b[2][l])
}

/// `a` times a symmetric matrix, of which there are the upper three numbers.
#[inline(always)]
fn times_inverse(a: &Matrix, m: &[Wide; 3]) -> Matrix {
    two!(i => [
        made(|l| a[i][0][l] * m[0][l] + a[i][1][l] * m[1][l]),
        made(|l| a[i][0][l] * m[1][l] + a[i][1][l] * m[2][l]),
    ])
}

/// The inverse of a symmetric matrix.
#[inline(always)]
fn inverse(a: &[Wide; 3]) -> [Wide; 3] {
    let one_over = made(|l| 1.0 / (a[0][l] * a[2][l] - a[1][l] * a[1][l]));
    [made(|l| a[2][l] * one_over[l]), made(|l| -a[1][l] * one_over[l]), made(|l| a[0][l] * one_over[l])]
}

/// Turned with the head.
#[inline(always)]
fn turned(turn: &[[f32; 3]; 3], v: &[Lanes; 3]) -> [Lanes; 3] {
    three!(k => each(|l| turn[0][k] * v[0][l] + turn[1][k] * v[1][l] + turn[2][k] * v[2][l]))
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
    let n = three!(c => each(|l| n[c][l] - (t[c][l] + next[c][l]) * factor[l]));
    let along = dot(&n, next);
    let n = three!(c => each(|l| n[c][l] - next[c][l] * along[l]));
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

    fn gathered(bend: &Bend, packet: &Packet, at: &Plane) -> Factors {
        let (mut bend, mut factors) = (bend.clone(), Factors::default());
        bend.give = 0.0;
        factors.resize(packet.nodes);
        bend.gather(at, (&packet.free, &packet.rest), &STILL, &mut factors);
        factors
    }

    fn some(key: Key, packet: &Packet, size: f32) -> Plane {
        let mut plane = Plane::new(packet.nodes);
        for k in 2..packet.nodes {
            plane.set(k, 0, key.with(k as u64).direction() * size);
        }
        plane
    }

    /// c R^T (R v - e), node by node; with `rests` e is left out.
    fn pulls(factors: &Factors, packet: &Packet, v: &Plane, rests: bool) -> Vec<Vec3> {
        let row = |r: &[Lanes; 3]| Vec3::new(r[0][0], r[1][0], r[2][0]);
        let mut out = vec![Vec3::ZERO; packet.nodes];
        for (k, joint) in factors.0.iter().enumerate().skip(2) {
            for i in 0..2 {
                let (a, b) = (row(&joint.a[i]), row(&joint.b[i]));
                let turn = a.dot(v.get(k, 0) - v.get(k - 1, 0)) - b.dot(v.get(k - 1, 0) - v.get(k - 2, 0));
                let y = (turn - if rests { 0.0 } else { joint.off[i][0] }) / joint.soft[0];
                out[k] += a * y;
                out[k - 1] -= (a + b) * y;
                out[k - 2] += b * y;
            }
        }
        out
    }

    #[test]
    fn the_matrix_is_the_derivative_of_the_force() {
        let packet = packet(2e5);
        let bend = packet.bend.clone().unwrap();
        let rest = gathered(&bend, &packet, &packet.at);
        let by = some(Key::new(1, "by"), &packet, 2e-3);
        let mut moved = packet.at.clone();
        for k in 0..packet.nodes {
            moved.set(k, 0, packet.at.get(k, 0) + by.get(k, 0));
        }
        let none = Plane::new(packet.nodes);
        let force = pulls(&gathered(&bend, &packet, &moved), &packet, &none, false);
        let expected = pulls(&rest, &packet, &by, true);
        for k in 2..packet.nodes {
            let (change, expected) = (force[k], expected[k]);
            assert!(change.distance(expected) < 0.03 * expected.length() + 2e-3, "node {k}: {change} {expected}");
        }
    }

    #[test]
    fn the_system_is_solved() {
        for stiffness in [1e2, 1e4, 1e6] {
            let packet = packet(stiffness);
            let mut bend = packet.bend.clone().unwrap();
            bend.give = 0.0;
            let plain = gathered(&bend, &packet, &packet.at);
            let mut factors = plain.clone();
            let right = some(Key::new(2, "right"), &packet, 1.0);
            let mut at = packet.at.clone();
            bend.apply(&mut at, (&packet.free, &packet.rest), &STILL, &right, &mut factors);
            let mut way = Plane::new(packet.nodes);
            for k in 0..packet.nodes {
                way.set(k, 0, at.get(k, 0) - packet.at.get(k, 0));
            }
            let pulls = pulls(&plain, &packet, &way, false);
            for k in 2..packet.nodes {
                let left = way.get(k, 0) + pulls[k];
                // The way is known to about 10^-6 cm, and c times that comes back.
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
                let (mut bend, force, mut factors) = (bend.clone(), Plane::new(packet.nodes), Factors::default());
                bend.give = 0.0;
                factors.resize(packet.nodes);
                let mut at = packet.at.clone();
                for k in 0..packet.nodes {
                    at.set(k, 0, packet.at.get(k, 0) + by.get(k, 0));
                }
                bend.apply(&mut at, (&packet.free, &packet.rest), &STILL, &force, &mut factors);
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
