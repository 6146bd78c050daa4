//! Mean-value coordinates on a closed cage of triangles (Ju, Schaefer, Warren 2005): the inner loop.
//!
//! Eight places go side by side, in double precision: near the plane of a triangle numbers of nearly the same size are
//! taken from each other. There is no fused arithmetic and no sum over lanes, so the bits are the same on every processor
//! and in any division of the points.

// Lanes are counted: that is the form in which loops over them become single instructions.
#![allow(clippy::needless_range_loop)]

use glam::{DVec3, Vec3};
use multiversion::multiversion;

/// Points that are worked on at once.
const LANES: usize = 8;

/// Numbers of that many points. Every operation is one loop over values, so that it becomes single instructions.
#[derive(Clone, Copy)]
struct Lanes([f64; LANES]);

const ZERO: Lanes = Lanes([0.0; LANES]);

/// A place counts as in the plane of a triangle when the three directions to its corners span less than this.
const PLANE: f64 = 1e-8;
/// The square of half the cosine's distance from -1 at which a place counts as on an edge.
const ON_EDGE: f64 = 1e-14;
/// Terms of the series of the arc tangent: with the angles here the rest is below 1e-10.
const TERMS: usize = 12;

/// A cage, ready for evaluation.
pub struct Shell {
    vertices: Vec<DVec3>,
    moves: Vec<DVec3>,
    edges: Vec<[usize; 2]>,
    triangles: Vec<Facet>,
    low: DVec3,
    high: DVec3,
}

/// A triangle: its corners, and for every corner the edge across from it, with the way in which the triangle goes along
/// that edge.
struct Facet {
    corners: [usize; 3],
    edges: [usize; 3],
    ways: [f64; 3],
}

impl Shell {
    /// From the corners at rest, how far each has moved, and closed triangles that face outward.
    pub fn new(vertices: &[Vec3], moves: &[Vec3], triangles: &[[u32; 3]]) -> Self {
        let mut edges: Vec<[usize; 2]> = vec![];
        let mut known = std::collections::BTreeMap::new();
        let mut facets = Vec::with_capacity(triangles.len());
        for t in triangles {
            let corners = t.map(|v| v as usize);
            let (mut of, mut ways) = ([0; 3], [1.0; 3]);
            for k in 0..3 {
                let (a, b) = (corners[(k + 1) % 3], corners[(k + 2) % 3]);
                let edge = [a.min(b), a.max(b)];
                of[k] = *known.entry(edge).or_insert_with(|| {
                    edges.push(edge);
                    edges.len() - 1
                });
                ways[k] = if a < b { 1.0 } else { -1.0 };
            }
            facets.push(Facet { corners, edges: of, ways });
        }
        let vertices: Vec<DVec3> = vertices.iter().map(|p| p.as_dvec3()).collect();
        let low = vertices.iter().fold(DVec3::INFINITY, |m, &p| m.min(p));
        let high = vertices.iter().fold(DVec3::NEG_INFINITY, |m, &p| m.max(p));
        let moves = moves.iter().map(|m| m.as_dvec3()).collect();
        Self { vertices, moves, edges, triangles: facets, low, high }
    }

    /// How a place on the surface moves: as the flat triangle does that it lies in.
    pub fn on_surface(&self, p: DVec3) -> DVec3 {
        let (at, weights) = self.closest(p);
        let corners = self.triangles[at].corners;
        (0..3).map(|k| self.moves[corners[k]] * weights[k]).sum()
    }

    /// The triangle that is nearest to a place, and the weights of its corners there.
    pub fn closest(&self, p: DVec3) -> (usize, [f64; 3]) {
        let mut best = (0, [1.0, 0.0, 0.0], f64::INFINITY);
        for (t, facet) in self.triangles.iter().enumerate() {
            let [a, b, c] = facet.corners.map(|v| self.vertices[v]);
            let weights = nearest_in(p, a, b, c);
            let distance = (a * weights[0] + b * weights[1] + c * weights[2]).distance_squared(p);
            if distance < best.2 {
                best = (t, weights, distance);
            }
        }
        (best.0, best.1)
    }

    /// A place of a triangle by weights of its corners.
    pub fn place(&self, triangle: usize, weights: [f64; 3]) -> DVec3 {
        let corners = self.triangles[triangle].corners;
        (0..3).map(|k| self.vertices[corners[k]] * weights[k]).sum()
    }

    /// The bounds of the cage at rest.
    pub fn bounds(&self) -> (DVec3, DVec3) {
        (self.low, self.high)
    }
}

/// Weights of the corners at the place of a triangle that is nearest to `p`, by the regions of its corners, edges and
/// inside (Ericson 2005, 5.1.5).
fn nearest_in(p: DVec3, a: DVec3, b: DVec3, c: DVec3) -> [f64; 3] {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return [1.0, 0.0, 0.0];
    }
    let bp = p - b;
    let (d3, d4) = (ab.dot(bp), ac.dot(bp));
    if d3 >= 0.0 && d4 <= d3 {
        return [0.0, 1.0, 0.0];
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        let v = d1 / (d1 - d3);
        return [1.0 - v, v, 0.0];
    }
    let cp = p - c;
    let (d5, d6) = (ab.dot(cp), ac.dot(cp));
    if d6 >= 0.0 && d5 <= d6 {
        return [0.0, 0.0, 1.0];
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        let w = d2 / (d2 - d6);
        return [1.0 - w, 0.0, w];
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 {
        let w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return [0.0, 1.0 - w, w];
    }
    let whole = va + vb + vc;
    [va / whole, vb / whole, vc / whole]
}

/// What is known of a block of places, per corner, edge and lane.
struct Work {
    /// Unit vectors to the corners.
    towards: Vec<[Lanes; 3]>,
    /// Their inverse distances.
    near: Vec<Lanes>,
    /// Per edge the cross product of the unit vectors to its ends.
    normals: Vec<[Lanes; 3]>,
    /// Per edge the angle between these vectors over its sine.
    angles: Vec<Lanes>,
    /// Weights of the corners.
    weights: Vec<Lanes>,
}

impl Work {
    fn new(shell: &Shell) -> Self {
        let (corners, edges) = (shell.vertices.len(), shell.edges.len());
        Self {
            towards: vec![[ZERO; 3]; corners],
            near: vec![ZERO; corners],
            normals: vec![[ZERO; 3]; edges],
            angles: vec![ZERO; edges],
            weights: vec![ZERO; corners],
        }
    }
}

/// Moves `from` to `to` by a cage. Places outside stay.
pub fn cage(shell: &Shell, from: &[Vec3], to: &mut [Vec3]) {
    let mut work = Work::new(shell);
    let is_near = |p: &Vec3| {
        let p = p.as_dvec3();
        p.cmpge(shell.low).all() && p.cmple(shell.high).all()
    };
    for (from, to) in from.chunks(LANES).zip(to.chunks_mut(LANES)) {
        if !from.iter().any(is_near) {
            to.copy_from_slice(from);
            continue;
        }
        let mut at = [ZERO; 3];
        for c in 0..LANES {
            let p = from.get(c).unwrap_or(&from[0]).as_dvec3();
            (at[0].0[c], at[1].0[c], at[2].0[c]) = (p.x, p.y, p.z);
        }
        let on = weigh(shell, &at, &mut work);
        let (whole, motion) = mean(shell, &work);
        for (c, (p, q)) in from.iter().zip(to).enumerate() {
            let by = if !is_near(p) {
                DVec3::ZERO
            } else if on.0[c] != 0.0 {
                shell.on_surface(p.as_dvec3())
            } else if whole.0[c] > 0.0 {
                DVec3::new(motion[0].0[c], motion[1].0[c], motion[2].0[c]) / whole.0[c]
            } else {
                // The weights of a place outside sum to less than 0.
                DVec3::ZERO
            };
            *q = if by == DVec3::ZERO { *p } else { (p.as_dvec3() + by).as_vec3() };
        }
    }
}

/// Which places are inside or on the surface.
pub fn inside(shell: &Shell, places: &[Vec3]) -> Vec<bool> {
    let mut work = Work::new(shell);
    let mut out = Vec::with_capacity(places.len());
    for block in places.chunks(LANES) {
        let mut at = [ZERO; 3];
        for c in 0..LANES {
            let p = block.get(c).unwrap_or(&block[0]).as_dvec3();
            (at[0].0[c], at[1].0[c], at[2].0[c]) = (p.x, p.y, p.z);
        }
        let on = weigh(shell, &at, &mut work);
        let (whole, _) = mean(shell, &work);
        out.extend((0..block.len()).map(|c| on.0[c] != 0.0 || whole.0[c] > 0.0));
    }
    out
}

/// Fills `work.weights` for the places `at`; 1 in the answer for a place on the surface, where weights have no end.
#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2"))]
fn weigh(shell: &Shell, at: &[Lanes; 3], work: &mut Work) -> Lanes {
    let (at, one) = (*at, Lanes::all(1.0));
    let mut on = ZERO;
    for ((v, towards), near) in shell.vertices.iter().zip(&mut work.towards).zip(&mut work.near) {
        let arm = [Lanes::all(v.x) - at[0], Lanes::all(v.y) - at[1], Lanes::all(v.z) - at[2]];
        let square = dot(arm, arm).max(1e-30);
        let inverse = one / square.sqrt();
        *near = inverse;
        *towards = [arm[0] * inverse, arm[1] * inverse, arm[2] * inverse];
        on = one.or(on, square.below(1e-20));
    }
    for ((&[a, b], normal), angle) in shell.edges.iter().zip(&mut work.normals).zip(&mut work.angles) {
        let (u, w) = (work.towards[a], work.towards[b]);
        *normal = [u[1] * w[2] - u[2] * w[1], u[2] * w[0] - u[0] * w[2], u[0] * w[1] - u[1] * w[0]];
        // The angle over its sine, from the cosines of its half, h, and its quarter, s; its eighth has the tangent
        // z = sin / (1 + s), whose square is (1 - s) / (1 + s).
        let half = Lanes::all(0.5) + dot(u, w) * Lanes::all(0.5);
        on = one.or(on, half.below(ON_EDGE));
        let h = half.max(ON_EDGE).sqrt();
        let s = (Lanes::all(0.5) + h * Lanes::all(0.5)).sqrt();
        let inverse = one / (s * h * (one + s));
        let square = (one - s).max(0.0) * s * h * inverse;
        let mut series = Lanes::all(-1.0 / (2 * TERMS - 1) as f64);
        for k in (0..TERMS - 1).rev() {
            let term = if k % 2 == 0 { 1.0 } else { -1.0 } / (2 * k + 1) as f64;
            series = series * square + Lanes::all(term);
        }
        *angle = (series + series) * inverse;
    }
    work.weights.fill(ZERO);
    for facet in &shell.triangles {
        let ways = facet.ways.map(Lanes::all);
        let n = facet.edges.map(|e| work.normals[e]);
        let g = facet.edges.map(|e| work.angles[e]);
        let g = [g[0] * ways[0], g[1] * ways[1], g[2] * ways[2]];
        let mean = [0, 1, 2].map(|a| g[0] * n[0][a] + g[1] * n[1][a] + g[2] * n[2][a]);
        let span = dot(work.towards[facet.corners[0]], n[0]) * ways[0];
        // In the plane of the triangle the mean vector is 0 outside of it, and of length 2 pi inside.
        let is_flat = span.abs().below(PLANE);
        on = one.or(on, is_flat.and(one.below_other(dot(mean, mean))));
        let inverse = ZERO.or(one / span, is_flat);
        for k in 0..3 {
            let corner = facet.corners[k];
            let weight = dot(n[k], mean) * ways[k] * inverse * work.near[corner];
            work.weights[corner] = work.weights[corner] + weight;
        }
    }
    on
}

/// The sum of the weights, and that of the weighted motions.
#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2"))]
fn mean(shell: &Shell, work: &Work) -> (Lanes, [Lanes; 3]) {
    let (mut whole, mut motion) = (ZERO, [ZERO; 3]);
    for (&weight, by) in work.weights.iter().zip(&shell.moves) {
        whole = whole + weight;
        motion[0] = motion[0] + weight * Lanes::all(by.x);
        motion[1] = motion[1] + weight * Lanes::all(by.y);
        motion[2] = motion[2] + weight * Lanes::all(by.z);
    }
    (whole, motion)
}

/// Per lane whether something holds.
type Mask = [bool; LANES];

/// Masks that hold together.
trait Both {
    fn and(self, other: Self) -> Self;
}

impl Both for Mask {
    #[inline(always)]
    fn and(mut self, other: Self) -> Self {
        for c in 0..LANES {
            self[c] &= other[c];
        }
        self
    }
}

macro_rules! operators {
    ($($name:ident $method:ident $op:tt),*) => {$(
        impl std::ops::$name for Lanes {
            type Output = Self;
            #[inline(always)]
            fn $method(mut self, other: Self) -> Self {
                for c in 0..LANES {
                    self.0[c] $op other.0[c];
                }
                self
            }
        }
    )*};
}
operators!(Add add +=, Sub sub -=, Mul mul *=, Div div /=);

impl Lanes {
    #[inline(always)]
    fn all(value: f64) -> Self {
        Self([value; LANES])
    }

    #[inline(always)]
    fn sqrt(mut self) -> Self {
        for c in 0..LANES {
            self.0[c] = self.0[c].sqrt();
        }
        self
    }

    #[inline(always)]
    fn abs(mut self) -> Self {
        for c in 0..LANES {
            self.0[c] = self.0[c].abs();
        }
        self
    }

    #[inline(always)]
    fn max(mut self, least: f64) -> Self {
        for c in 0..LANES {
            self.0[c] = if self.0[c] > least { self.0[c] } else { least };
        }
        self
    }

    #[inline(always)]
    fn below(self, most: f64) -> Mask {
        let mut out = [false; LANES];
        for c in 0..LANES {
            out[c] = self.0[c] <= most;
        }
        out
    }

    #[inline(always)]
    fn below_other(self, other: Self) -> Mask {
        let mut out = [false; LANES];
        for c in 0..LANES {
            out[c] = self.0[c] < other.0[c];
        }
        out
    }

    /// These where the mask holds, the others elsewhere.
    #[inline(always)]
    fn or(mut self, other: Self, mask: Mask) -> Self {
        for c in 0..LANES {
            self.0[c] = if mask[c] { self.0[c] } else { other.0[c] };
        }
        self
    }
}

#[inline(always)]
fn dot(a: [Lanes; 3], b: [Lanes; 3]) -> Lanes {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
