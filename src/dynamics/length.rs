//! Segments brought to their lengths.
//!
//! The paper corrects one segment after the other: the difference vector d times the factor f, half at each end, with
//! f = (d - r) / d, or without a root f = (D - r^2) / (D + r^2), D = d . d (equation 11). Over a strand of many segments
//! that converges slowly. The chain form asks for the correction of all segments together: with node k moved by
//! mu_(k+1) e_(k+1) - mu_k e_k, every segment changes by -f d to first order when
//!
//! ```text
//! (w_(k-1) + w_k) d_k . e_k mu_k  -  w_(k-1) d_k . e_(k-1) mu_(k-1)  -  w_k d_k . e_(k+1) mu_(k+1)  =  f_k D_k
//! ```
//!
//! with w = 1 for a node that moves and 0 for a pinned one: a tridiagonal system, solved exactly from root to tip and
//! back. Without its off-diagonals it is the paper's correction. The directions e are those of the segments at the
//! beginning of the step (as in SHAKE: Ryckaert, Ciccotti, Berendsen 1977), so that the motion neither gains nor loses
//! energy by them. That is explicit in the waves that run along a taut strand, and stable only while such a wave comes no
//! farther than a segment in a step: where a strand is more taut than that, and where it turns far in a step, its own
//! directions d are taken instead, which is always stable and loses energy.

use super::lanes::{LANES, Lanes, Plane, dot, each, minus, scaled, three};

/// The greatest mu at which the directions of the beginning of a step are taken: the square of the part of a segment that
/// a wave along the strand runs in a step. At 1 it would be unstable.
const TAUT: f32 = 0.2;

/// Memory of the chain form.
#[derive(Clone, Debug, Default)]
pub struct Memory {
    /// The directions e.
    along: Plane,
    upper: Vec<Lanes>,
    right: Vec<Lanes>,
    /// 1 for the lanes where segments' own directions are taken.
    own: Lanes,
}

impl Memory {
    /// Makes room for `nodes` nodes.
    pub fn resize(&mut self, nodes: usize) {
        self.along.resize(nodes);
        self.upper.resize(nodes, [0.0; LANES]);
        self.right.resize(nodes, [0.0; LANES]);
    }

    /// Looks which strands must take their own directions: those that were `taut` in the last step, and those with a
    /// segment that turns by more than about 18 degrees in this one, from where on the matrix might lose its pivots.
    #[inline(always)]
    pub fn look(&mut self, at: &Plane, before: &Plane, taut: &Lanes) {
        self.own = each(|l| f32::from(taut[l] > TAUT));
        for k in 1..at.x.len() {
            let (d, e) = (minus(&at.row(k), &at.row(k - 1)), minus(&before.row(k), &before.row(k - 1)));
            let (turned, square, was) = (dot(&d, &e), dot(&d, &d), dot(&e, &e));
            for l in 0..LANES {
                let is_far = (turned[l] < 0.0) | (turned[l] * turned[l] < 0.9 * square[l] * was[l]);
                self.own[l] = if is_far { 1.0 } else { self.own[l] };
            }
        }
    }
}

/// The factor by which a segment of squared length `square` is too long, against `rest`.
#[inline(always)]
fn factor<const ROOT_FREE: bool>(square: &Lanes, rest: &Lanes) -> Lanes {
    let f = if ROOT_FREE {
        each(|l| (square[l] - rest[l] * rest[l]) / (square[l] + rest[l] * rest[l]).max(1e-12))
    } else {
        each(|l| 1.0 - rest[l] / square[l].max(1e-12).sqrt())
    };
    // A segment that has nearly vanished is opened in steps.
    each(|l| f[l].max(-2.0))
}

/// The vector of segment `k`.
#[inline(always)]
fn segment(at: &Plane, k: usize) -> [Lanes; 3] {
    minus(&at.row(k), &at.row(k - 1))
}

/// `a` where `which` is above 0, and `b` elsewhere.
#[inline(always)]
fn either(which: &Lanes, a: &[Lanes; 3], b: &[Lanes; 3]) -> [Lanes; 3] {
    three!(c => each(|l| if which[l] > 0.0 { a[c][l] } else { b[c][l] }))
}

/// One round of corrections, one segment after the other.
#[inline(always)]
pub fn pairs<const ROOT_FREE: bool>(at: &mut Plane, free: &[Lanes], rest: &[Lanes]) {
    for k in 1..free.len() {
        let (mut a, mut b) = (at.row(k - 1), at.row(k));
        let d = minus(&b, &a);
        let f = factor::<ROOT_FREE>(&dot(&d, &d), &rest[k]);
        // Half at each end; all of it at one when the other is pinned.
        let f = each(|l| {
            let ends = free[k - 1][l] + free[k][l];
            if rest[k][l] > 0.0 && ends > 0.0 { f[l] / ends } else { 0.0 }
        });
        for c in 0..3 {
            for l in 0..LANES {
                a[c][l] += d[c][l] * (f[l] * free[k - 1][l]);
                b[c][l] -= d[c][l] * (f[l] * free[k][l]);
            }
        }
        at.put(k - 1, a);
        at.put(k, b);
    }
}

/// One round of corrections, all segments of a strand at once, for the lanes in `which`. `before` is where nodes were
/// when the step began. Gives the greatest mu of each strand, and takes the strands' own directions from then on where it
/// is too great.
#[inline(always)]
pub fn chain<const ROOT_FREE: bool>(
    at: &mut Plane,
    before: &Plane,
    (free, rest): (&[Lanes], &[Lanes]),
    which: &Lanes,
    memory: &mut Memory,
) -> Lanes {
    let nodes = free.len();
    let mut most = [0.0_f32; LANES];
    if nodes < 2 {
        return most;
    }
    let own_way = memory.own;
    let mut d = segment(at, 1);
    let mut e = either(&own_way, &d, &segment(before, 1));
    let mut e_before = [[0.0; LANES]; 3];
    let (mut upper_before, mut right_before) = ([0.0; LANES], [0.0; LANES]);
    for k in 1..nodes {
        let last = k + 1 == nodes;
        let d_next = if last { d } else { segment(at, k + 1) };
        let e_next = if last { e } else { either(&own_way, &d_next, &segment(before, k + 1)) };
        let (w0, w1, r) = (&free[k - 1], &free[k], &rest[k]);
        let square = dot(&d, &d);
        let f = factor::<ROOT_FREE>(&square, r);
        let (own, down, up) = (dot(&d, &e), dot(&d, &e_before), dot(&d, &e_next));
        let has_next = if last { 0.0 } else { 1.0 };
        let pivot = each(|l| {
            let p = (w0[l] + w1[l]) * own[l] + w0[l] * down[l] * upper_before[l];
            // Between two pins that a strand only just spans there may be no way out.
            p.max(0.05 * r[l] * r[l]).max(1e-12)
        });
        let is_live = each(|l| f32::from(r[l] > 0.0 && w0[l] + w1[l] > 0.0));
        let one_over = each(|l| is_live[l] / pivot[l]);
        let upper = each(|l| -w1[l] * up[l] * has_next * one_over[l]);
        let right = each(|l| (f[l] * square[l] + w0[l] * down[l] * right_before[l]) * one_over[l]);
        memory.upper[k] = upper;
        memory.right[k] = right;
        memory.along.put(k, e);
        (upper_before, right_before, e_before) = (upper, right, e);
        (d, e) = (d_next, e_next);
    }
    let mut mu_after = [0.0; LANES];
    let mut pull_after = [[0.0; LANES]; 3];
    for k in (1..nodes).rev() {
        let (upper, right) = (&memory.upper[k], &memory.right[k]);
        let mu = each(|l| right[l] - upper[l] * mu_after[l]);
        most = each(|l| most[l].max(mu[l].abs()));
        let pull = scaled(&memory.along.row(k), &mu);
        let mut row = at.row(k);
        for c in 0..3 {
            for l in 0..LANES {
                let by = pull_after[c][l] - pull[c][l];
                row[c][l] += if free[k][l] * which[l] > 0.0 { by } else { 0.0 };
            }
        }
        at.put(k, row);
        (mu_after, pull_after) = (mu, pull);
    }
    let mut row = at.row(0);
    for c in 0..3 {
        for l in 0..LANES {
            row[c][l] += if free[0][l] * which[l] > 0.0 { pull_after[c][l] } else { 0.0 };
        }
    }
    at.put(0, row);
    memory.own = each(|l| if most[l] > TAUT { 1.0 } else { memory.own[l] });
    most
}

/// How far from its length a segment may be before another round of corrections, as a part of it.
pub const NEAR: f32 = 0.005;
/// Most such rounds.
pub const MORE: usize = 6;
/// How far it may be after them before all of the strand is laid again.
pub const LOOSE: f32 = 0.01;

/// 1 for the lanes in which a segment is off its length by more than a part `by`.
#[inline(always)]
pub fn off(at: &Plane, free: &[Lanes], rest: &[Lanes], by: f32) -> Lanes {
    let (low, high) = ((1.0 - by) * (1.0 - by), (1.0 + by) * (1.0 + by));
    let mut which = [0.0_f32; LANES];
    for k in 1..free.len() {
        let d = minus(&at.row(k), &at.row(k - 1));
        let square = dot(&d, &d);
        let r = &rest[k];
        // Written so that NaN is off.
        let is_off = each(|l| {
            let r = r[l] * r[l];
            if (square[l] >= low * r) & (square[l] <= high * r) { 0.0 } else { 1.0 }
        });
        which = each(|l| which[l].max(is_off[l] * free[k][l]));
    }
    which
}

/// Lays the strands of the lanes in `which` again, from the root to the tip, each segment in its own direction, so that
/// every segment has its length: whatever happens in a step, no strand is torn.
#[inline(always)]
pub fn lay(at: &mut Plane, before: &Plane, (free, rest): (&[Lanes], &[Lanes]), which: &Lanes) {
    for k in 1..free.len() {
        let (a, mut b) = (at.row(k - 1), at.row(k));
        let (d, old) = (minus(&b, &a), minus(&before.row(k), &before.row(k - 1)));
        let square = dot(&d, &d);
        for l in 0..LANES {
            if which[l] * free[k][l] > 0.0 && rest[k][l] > 0.0 {
                let is_sound = square[l] > 1e-12 && square[l] < f32::MAX;
                let s = rest[k][l] / square[l].sqrt();
                for c in 0..3 {
                    b[c][l] = a[c][l] + if is_sound { d[c][l] * s } else { old[c][l] };
                }
            }
        }
        at.put(k, b);
    }
}
