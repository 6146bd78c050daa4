//! Posing a rig: where the handles are given, the states' weights and all other vertices are found.
//!
//! Wanted are `x` and `w` with the least `|G x - M(w)|^2` (Sumner et al. 2005; equation 8 of Ren, Zhao, Geng 2010). For
//! given weights `x` is linear, so it is eliminated (variable projection, Golub, Pereyra 1973): with the factored
//! `A = G^T G` one iteration solves for `x(w)` and for `dx/dw_i`, all right-hand sides at once, and the weights get the
//! Gauss-Newton step of the small system
//!
//! ```text
//! H_ij = <M_i, M_j> - (G^T M_i) A^-1 (G^T M_j)      g_i = <M_i, M> - (G^T M_i) . x
//! ```
//!
//! damped (Levenberg, Marquardt) only after a step that went uphill. What Gauss-Newton leaves out of the second derivatives
//! is learnt from how the slope changes (the structured secant update of Dennis, Gay, Welsch 1981) and kept from frame to
//! frame: it changes slowly, and with it a frame needs half the iterations.

#![allow(clippy::needless_range_loop, reason = "several lists are gone through in step")]

use glam::{DVec3, Vec3};
use multiversion::multiversion;

use super::cholesky::LANES;
use super::feature::{Blend, FIELDS, PER_BLOCK};
use super::rig::{Fixed, Rig};

/// The iterations are at rest when no vertex moved by more than this share of the mesh's size in the last.
pub const TOLERANCE: f64 = 1e-5;
/// After so many iterations a frame is given up.
const MOST_ITERATIONS: u32 = 60;
/// What a weight beyond the states costs: its distance from 0..=1, squared, times this. A residual of a tenth is a hundredth
/// squared, so a weight of 2 is taken for that, but not one of 6.
const BLENDING: f64 = 0.01;
/// A frame further than this from its blend is looked for from the nearest state too, and that is taken when its energy is
/// less than a quarter: going on from frame to frame may end where the states do not lead.
const SUSPECT: f64 = 0.15;
/// Keeps the small system solvable where weights make no difference: states that are alike.
const FLOOR: f64 = 1e-9;
/// A step of the weights shorter than this teaches nothing: its slopes differ by rounding.
const SHORTEST: f64 = 1e-7;

/// How a frame was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Posed {
    /// Weights of the states without the rest; 1 shows a state itself.
    pub weights: Vec<f64>,
    /// Iterations made, all starts together.
    pub iterations: u32,
    /// How far the triangles are from the blend of the states: the root mean square of how much a length differs, 0 for a state itself, 0.1 for 10 %.
    pub residual: f64,
    /// Greatest movement of a vertex in the last iteration, cm.
    pub step: f64,
    /// Whether the iterations came to rest.
    pub converged: bool,
}

/// Poses one rig frame after frame; each frame starts from the one before.
#[derive(Debug)]
pub struct Poser<'a> {
    rig: &'a Rig,
    /// Of the last frame and the one before it.
    weights: [Option<Vec<f64>>; 2],
    blend: Blend,
    /// Solutions, per block of fields.
    solution: Vec<Vec<[f64; LANES]>>,
    /// What the fixed places add to the right-hand sides of the free ones.
    shift: Vec<[f64; 3]>,
    /// Places by row, from the centre.
    x: Vec<[f64; 3]>,
    /// What the Gauss-Newton matrix leaves out, as far as it is known.
    learnt: Square,
    pub(super) most_iterations: u32,
    /// [`BLENDING`]; tests of the plain energy have 0.
    pub(super) blending: f64,
}

/// One descent.
struct Descent {
    weights: Vec<f64>,
    energy: f64,
    iterations: u32,
    step: f64,
    converged: bool,
}

/// A small symmetric matrix.
type Square = [[f64; FIELDS]; FIELDS];

/// The small system at some weights.
struct Small {
    energy: f64,
    slope: [f64; FIELDS],
    hessian: Square,
}

impl<'a> Poser<'a> {
    pub(super) fn new(rig: &'a Rig) -> Self {
        let blend = rig.features.blend(rig.places.len());
        Self {
            rig,
            weights: [None, None],
            solution: blend.right.clone(),
            blend,
            shift: vec![[0.0; 3]; rig.unknowns()],
            x: rig.places.iter().map(|p| p.to_array()).collect(),
            learnt: [[0.0; FIELDS]; FIELDS],
            most_iterations: MOST_ITERATIONS,
            blending: BLENDING,
        }
    }

    /// Forgets the frames so far: the next one is looked for from every state.
    pub fn forget(&mut self) {
        self.weights = [None, None];
        self.learnt = [[0.0; FIELDS]; FIELDS];
    }

    /// Poses the mesh with its handles at `targets`, one per handle, and writes every vertex. Held vertices and handles
    /// are met exactly. Without a frame before it, or when going on from there does not come to rest, the search starts
    /// from every state and the best is taken.
    ///
    /// # Panics
    /// When `targets` or `out` has the wrong length.
    pub fn pose(&mut self, targets: &[Vec3], out: &mut [Vec3]) -> Posed {
        assert_eq!((targets.len(), out.len()), (self.rig.handles(), self.rig.rest.len()));
        self.fix(targets);
        let warm = self.warm().map(|start| self.descend(start));
        let (best, is_new) = match warm {
            Some(warm) if !warm.converged => (self.search(warm.iterations), true),
            Some(warm) if self.residual(&warm) > SUSPECT => self.doubted(warm, targets),
            Some(warm) => (warm, false),
            None => (self.search(0), true),
        };
        self.write(targets, out);
        // Where the search began anew, the frame before it leads nowhere.
        let before = if is_new { None } else { self.weights[0].take() };
        self.weights = [Some(best.weights.clone()), before];
        let residual = self.residual(&best);
        let Descent { weights, iterations, step, converged, .. } = best;
        Posed { weights, iterations, residual, step, converged }
    }

    /// The weights that show a state, 0 being the rest.
    fn showing(&self, state: usize) -> Vec<f64> {
        (0..self.rig.states).map(|e| if e + 1 == state { 1.0 } else { 0.0 }).collect()
    }

    /// The best of the descents from every state, after so many iterations that led nowhere.
    fn search(&mut self, before: u32) -> Descent {
        let mut best: Option<Descent> = None;
        let mut iterations = before;
        let mut is_last = true;
        for state in 0..=self.rig.states {
            let found = self.descend(self.showing(state));
            iterations += found.iterations;
            let better = best.as_ref().is_none_or(|b| {
                found.converged && !b.converged || found.converged == b.converged && found.energy < b.energy
            });
            is_last = better;
            if better {
                best = Some(found);
            }
        }
        let mut best = best.unwrap_or_else(|| unreachable!("there is at least the rest"));
        if !is_last {
            // The places are those of the last descent: go to the best once more.
            best = self.descend(best.weights);
            iterations += best.iterations;
        }
        Descent { iterations, ..best }
    }

    /// A frame far from its blend, and the descent from the state whose handles are nearest, when that state as it is would
    /// do better already: of the two the new one when it is clearly better, and whether it is.
    fn doubted(&mut self, warm: Descent, targets: &[Vec3]) -> (Descent, bool) {
        let rig = self.rig;
        let off = |state: usize| -> f32 {
            let places =
                targets.iter().enumerate().filter_map(|(h, t)| Some(rig.handle_at(h, state)?.distance_squared(*t)));
            places.sum()
        };
        let nearest = (0..=rig.states).min_by(|&a, &b| off(a).total_cmp(&off(b))).unwrap_or(0);
        let start = self.showing(nearest);
        let kept = self.x.clone();
        let mut iterations = warm.iterations + 1;
        if self.evaluate(&start).energy < warm.energy {
            let other = self.descend(start);
            iterations += other.iterations;
            if other.converged && other.energy < 0.25 * warm.energy {
                return (Descent { iterations, ..other }, true);
            }
        }
        self.x = kept;
        (Descent { iterations, ..warm }, false)
    }

    fn residual(&self, found: &Descent) -> f64 {
        let mut blending = Small { energy: 0.0, slope: [0.0; FIELDS], hessian: [[0.0; FIELDS]; FIELDS] };
        self.blended(&found.weights, &mut blending);
        (found.energy - blending.energy).max(0.0).sqrt()
    }

    /// Where the last two frames lead.
    fn warm(&self) -> Option<Vec<f64>> {
        let [last, before] = &self.weights;
        let last = last.as_ref()?;
        Some(match before {
            Some(before) => last.iter().zip(before).map(|(a, b)| 2.0 * a - b).collect(),
            None => last.clone(),
        })
    }

    /// Puts the fixed places where they belong, and what they add to the system.
    fn fix(&mut self, targets: &[Vec3]) {
        let free = self.rig.unknowns();
        for (i, fixed) in self.rig.fixed.iter().enumerate() {
            if let Fixed::Handle(h) = fixed {
                self.x[free + i] = (targets[*h].as_dvec3() - self.rig.centre).to_array();
            }
        }
        self.shift.fill([0.0; 3]);
        for &(fixed, row, a) in &self.rig.coupling {
            if let Some(to) = self.shift.get_mut(row as usize) {
                let from = self.x[free + fixed as usize];
                (0..3).for_each(|c| to[c] += a * from[c]);
            }
        }
    }

    /// From some weights down to where the energy is least.
    fn descend(&mut self, start: Vec<f64>) -> Descent {
        let limit = TOLERANCE * self.rig.size;
        let mut damping = 0.0;
        let mut weights = start;
        // The last weights that went downhill, and their system.
        let mut held: Option<(Vec<f64>, Small)> = None;
        let mut step = f64::INFINITY;
        for iterations in 1..=self.most_iterations {
            let small = self.evaluate(&weights);
            let above = |h: &Small| small.energy.is_nan() || small.energy > h.energy + 1e-12 * (1.0 + h.energy);
            let uphill = held.as_ref().is_some_and(|(_, h)| above(h));
            let (from, small) = match held.take() {
                Some(before) if uphill => {
                    damping = if damping == 0.0 { 1e-2 } else { 8.0 * damping };
                    before
                }
                before => {
                    damping = if damping > 1e-3 { damping / 8.0 } else { 0.0 };
                    if let Some((from, held)) = before {
                        self.learn(&from, &held, &weights, &small);
                    }
                    (weights, small)
                }
            };
            if uphill {
                self.learnt = [[0.0; FIELDS]; FIELDS];
            }
            let delta = self.step(&small, damping);
            if uphill {
                // The fields are not those of `from`: only the weights can tell whether it still goes anywhere.
                let size = delta.iter().fold(0.0, |m: f64, d| m.max(d.abs()));
                if size < 1e-9 {
                    let energy = self.evaluate(&from).energy;
                    return Descent { weights: from, energy, iterations, step: 0.0, converged: true };
                }
            } else {
                // A step that is short for its damping only says nothing.
                let full = if damping > 0.0 { self.step(&small, 0.0) } else { delta.clone() };
                step = self.movement(&full);
                if step <= limit {
                    self.advance(&full);
                    let weights = from.iter().zip(&full).map(|(w, d)| w + d).collect();
                    return Descent { weights, energy: small.energy, iterations, step, converged: true };
                }
            }
            weights = from.iter().zip(&delta).map(|(w, d)| w + d).collect();
            held = Some((from, small));
        }
        let energy = held.map_or(f64::INFINITY, |(_, s)| s.energy);
        Descent { weights, energy, iterations: self.most_iterations, step, converged: false }
    }

    /// Solves for the places and their derivatives at some weights.
    fn evaluate(&mut self, weights: &[f64]) -> Small {
        let rig = self.rig;
        let free = rig.unknowns();
        rig.features.evaluate(weights, &mut self.blend);
        let fields = rig.states + 1;
        for (b, (solution, right)) in self.solution.iter_mut().zip(&self.blend.right).enumerate() {
            solution[..free].copy_from_slice(&right[..free]);
            if b == 0 {
                for (to, shift) in solution.iter_mut().zip(&self.shift) {
                    (0..3).for_each(|c| to[c] -= shift[c]);
                }
            }
            rig.factor.solve(solution, 3 * (fields - b * PER_BLOCK).min(PER_BLOCK));
        }
        for (x, s) in self.x[..free].iter_mut().zip(&self.solution[0]) {
            x.copy_from_slice(&s[..3]);
        }
        // Inner products of right-hand sides with places and with their derivatives.
        let mut with_places = [0.0; FIELDS];
        for (b, right) in self.blend.right.iter().enumerate() {
            let sums = against_places(right, &self.x);
            for (f, sum) in with_places[b * PER_BLOCK..fields].iter_mut().zip(sums.chunks_exact(3)) {
                *f = sum.iter().sum();
            }
        }
        let inner = &self.blend.inner;
        let mut small = Small { energy: 0.0, slope: [0.0; FIELDS], hessian: [[0.0; FIELDS]; FIELDS] };
        for e in 0..rig.states {
            small.slope[e] = inner[e + 1][0] - with_places[e + 1];
            for f in 0..=e {
                let value = inner[e + 1][f + 1] - self.product(e + 1, f + 1);
                small.hessian[e][f] = value;
                small.hessian[f][e] = value;
            }
        }
        // |M|^2 - 2 b.x + x.A x, where A x = b in the free rows.
        let dot = |a: &[f64], x: &[f64; 3]| a[0] * x[0] + a[1] * x[1] + a[2] * x[2];
        let at_fixed: f64 = self.blend.right[0][free..].iter().zip(&self.x[free..]).map(|(b, x)| dot(&b[..3], x)).sum();
        let pull = |&(fixed, row, a): &(u32, u32, f64)| a * dot(&self.x[free + fixed as usize], &self.x[row as usize]);
        let pulled: f64 = rig.coupling.iter().map(pull).sum();
        small.energy = inner[0][0] - with_places[0] - at_fixed + pulled;
        self.blended(weights, &mut small);
        small
    }

    /// Adds what weights beyond the states cost, the rest's included. Between the states, and at each of them, nothing: so
    /// every state is still met exactly.
    fn blended(&self, weights: &[f64], small: &mut Small) {
        let beyond = |w: f64| w - w.clamp(0.0, 1.0);
        let of_rest = beyond(1.0 - weights.iter().sum::<f64>());
        let cost = self.blending;
        small.energy += cost * of_rest * of_rest;
        for (i, w) in weights.iter().enumerate() {
            let own = beyond(*w);
            small.energy += cost * own * own;
            small.slope[i] += cost * (own - of_rest);
            if own != 0.0 {
                small.hessian[i][i] += cost;
            }
            if of_rest != 0.0 {
                small.hessian[i][..weights.len()].iter_mut().for_each(|h| *h += cost);
            }
        }
    }

    /// The product of the right-hand side of one field with the solution of another, over the free rows.
    fn product(&self, e: usize, f: usize) -> f64 {
        let free = self.rig.unknowns();
        let (a, b) = (3 * (e % PER_BLOCK), 3 * (f % PER_BLOCK));
        product(&self.blend.right[e / PER_BLOCK][..free], &self.solution[f / PER_BLOCK][..free], a, b)
    }

    /// Learns from how the slope changed between two weights: afterwards the matrix of the second, with what is learnt, takes
    /// their difference to that of the slopes.
    fn learn(&mut self, from: &[f64], before: &Small, to: &[f64], now: &Small) {
        let n = self.rig.states;
        let mut s = [0.0; FIELDS];
        let mut y = [0.0; FIELDS];
        for i in 0..n {
            s[i] = to[i] - from[i];
            y[i] = now.slope[i] - before.slope[i];
        }
        let times = |m: &Square, i: usize| (0..n).map(|j| m[i][j] * s[j]).sum::<f64>();
        let dot = |a: &[f64; FIELDS], b: &[f64; FIELDS]| (0..n).map(|i| a[i] * b[i]).sum::<f64>();
        let mut left = [0.0; FIELDS];
        for (i, left) in left.iter_mut().enumerate().take(n) {
            *left = y[i] - times(&now.hessian, i) - times(&self.learnt, i);
        }
        let curvature: f64 = (0..n).map(|i| s[i] * times(&now.hessian, i)).sum();
        let along = dot(&y, &s);
        // Of steps too short, or against what they should show, nothing is learnt.
        if along.is_nan() || along <= 0.1 * curvature || dot(&s, &s) < SHORTEST * SHORTEST {
            return;
        }
        let rest = dot(&left, &s) / (along * along);
        for i in 0..n {
            for j in 0..n {
                self.learnt[i][j] += (left[i] * y[j] + y[i] * left[j]) / along - rest * y[i] * y[j];
            }
        }
    }

    /// The step of the small system with what is learnt, as long as that leaves it well above zero; else it is forgotten.
    fn step(&mut self, small: &Small, damping: f64) -> Vec<f64> {
        let n = self.rig.states;
        let mut whole = small.hessian;
        for i in 0..n {
            for j in 0..n {
                whole[i][j] += self.learnt[i][j];
            }
        }
        match solved(&whole, small, n, damping, 0.1) {
            Some(delta) => delta,
            None => {
                self.learnt = [[0.0; FIELDS]; FIELDS];
                solved(&small.hessian, small, n, damping, 0.0).unwrap_or_default()
            }
        }
    }

    /// Movement of a row when the weights change.
    fn moved(&self, row: usize, delta: &[f64]) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for (e, d) in delta.iter().enumerate() {
            let at = 3 * ((e + 1) % PER_BLOCK);
            let s = &self.solution[(e + 1) / PER_BLOCK][row];
            for c in 0..3 {
                sum[c] += s[at + c] * d;
            }
        }
        sum
    }

    /// The greatest movement when the weights change, cm.
    fn movement(&self, delta: &[f64]) -> f64 {
        let mut most = 0.0_f64;
        for row in 0..self.rig.unknowns() {
            let [x, y, z] = self.moved(row, delta);
            most = most.max(x * x + y * y + z * z);
        }
        most.sqrt()
    }

    /// Moves the places along with the weights.
    fn advance(&mut self, delta: &[f64]) {
        for r in 0..self.rig.unknowns() {
            let by = self.moved(r, delta);
            (0..3).for_each(|c| self.x[r][c] += by[c]);
        }
    }

    fn write(&self, targets: &[Vec3], out: &mut [Vec3]) {
        let rig = self.rig;
        let free = rig.unknowns();
        for ((to, row), rest) in out.iter_mut().zip(&rig.row).zip(&rig.rest) {
            *to = match row.map(|r| r as usize) {
                None => *rest,
                Some(r) if r < free => (DVec3::from_array(self.x[r]) + rig.centre).as_vec3(),
                Some(r) => match rig.fixed[r - free] {
                    Fixed::Held => *rest,
                    Fixed::Handle(h) => targets[h],
                },
            };
        }
    }
}

/// The solution of `(matrix + damping) d = -slope` by Cholesky; none when a pivot is below that part of the Gauss-Newton
/// matrix's diagonal.
fn solved(matrix: &Square, small: &Small, n: usize, damping: f64, least: f64) -> Option<Vec<f64>> {
    let greatest = (0..n).map(|i| small.hessian[i][i]).fold(0.0, f64::max);
    let mut l = *matrix;
    let mut d: Vec<f64> = small.slope[..n].iter().map(|g| -g).collect();
    for (i, row) in l.iter_mut().enumerate().take(n) {
        row[i] += damping * small.hessian[i][i].max(0.0) + (FLOOR + 1e-3 * damping) * greatest + f64::MIN_POSITIVE;
    }
    for i in 0..n {
        for j in 0..=i {
            let sum: f64 = (0..j).map(|k| l[i][k] * l[j][k]).sum();
            let rest = l[i][j] - sum;
            if i == j && rest < least * small.hessian[i][i] {
                return None;
            }
            // Rounding may leave nothing of a direction that makes no difference.
            l[i][j] =
                if i == j { rest.max(FLOOR * FLOOR * greatest + f64::MIN_POSITIVE).sqrt() } else { rest / l[j][j] };
        }
    }
    for i in 0..n {
        let sum: f64 = (0..i).map(|k| l[i][k] * d[k]).sum();
        d[i] = (d[i] - sum) / l[i][i];
    }
    for i in (0..n).rev() {
        let sum: f64 = (i + 1..n).map(|k| l[k][i] * d[k]).sum();
        d[i] = (d[i] - sum) / l[i][i];
    }
    Some(d)
}

#[multiversion(targets("x86_64+avx2", "x86_64+avx"))]
fn against_places(right: &[[f64; LANES]], x: &[[f64; 3]]) -> [f64; LANES] {
    let mut sums = [0.0; LANES];
    let n = right.len().min(x.len());
    let (right, x) = (&right[..n], &x[..n]);
    for i in 0..n {
        for k in 0..LANES {
            sums[k] += right[i][k] * x[i][k % 3];
        }
    }
    sums
}

/// The sum over rows of three right-hand sides, from `a` on, times three of the solution, from `b` on. A plain loop: it is
/// compiled as one whichever way the crate is cut.
fn product(right: &[[f64; LANES]], solution: &[[f64; LANES]], a: usize, b: usize) -> f64 {
    let n = right.len().min(solution.len());
    let (right, solution) = (&right[..n], &solution[..n]);
    let mut sum = 0.0;
    for i in 0..n {
        let (r, s) = (&right[i][a..a + 3], &solution[i][b..b + 3]);
        sum += r[0] * s[0] + r[1] * s[1] + r[2] * s[2];
    }
    sum
}
