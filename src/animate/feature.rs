//! Features: what the states do to every triangle, and their blend, many triangles at a time.
//!
//! A triangle's deformation gradient is `T = R S`. With the fourth vertex of Sumner et al. its product with the rest's
//! normal can be met exactly by moving that vertex alone, so only `F = T P` counts, `P` being the two directions in the
//! rest's plane: three numbers for each. The blend of weights `w` is
//!
//! ```text
//! M(w) = exp(sum w_i log R_i) (I + sum w_i (S_i - I)) P
//! ```
//!
//! with the rest as a state whose weight is one less all others. All triangles count alike.

use glam::{DVec2, DVec3};
use multiversion::multiversion;

use super::cholesky::LANES;

/// Triangles worked on in step: so many that the compiler makes vectors of its loops rather than unrolling them.
pub(super) const TILE: usize = 16;
/// The most states besides the rest.
pub const MOST_STATES: usize = 10;
/// States and the blend itself.
pub(super) const FIELDS: usize = MOST_STATES + 1;
/// Fields in one block of right-hand sides.
pub(super) const PER_BLOCK: usize = LANES / 3;

type Lane = [f64; TILE];

/// A triangle at rest, flat: where its corners lie in its own plane.
#[derive(Clone, Copy, Debug)]
pub(super) struct Flat {
    /// Directions of the plane's axes, unit, at right angles.
    pub(super) axes: [DVec3; 2],
    /// The second and third corner; the first is the origin.
    pub(super) corners: [DVec2; 2],
}

impl Flat {
    /// `None` when the triangle has no area.
    pub(super) fn new([a, b, c]: [DVec3; 3]) -> Option<Self> {
        let (u, v) = (b - a, c - a);
        let normal = u.cross(v);
        if !has_area([a, b, c]) {
            return None;
        }
        let first = u.normalize();
        let second = normal.cross(u).normalize();
        Some(Self {
            axes: [first, second],
            corners: [DVec2::new(u.length(), 0.0), DVec2::new(v.dot(first), v.dot(second))],
        })
    }

    /// Twice the area.
    pub(super) fn double_area(&self) -> f64 {
        self.corners[0].x * self.corners[1].y
    }

    /// How `F` comes from the edges: column 0 is `first.0` times the first edge, column 1 is `second.0` times the first
    /// and `second.1` times the second.
    fn rates(&self) -> (f64, (f64, f64)) {
        let (l, p) = (self.corners[0].x, self.corners[1]);
        (1.0 / l, (-p.x / (l * p.y), 1.0 / p.y))
    }
}

/// True when a triangle's height is more than a millionth of its longest edge.
pub(super) fn has_area([a, b, c]: [DVec3; 3]) -> bool {
    let longest = (b - a).length_squared().max((c - b).length_squared()).max((a - c).length_squared());
    (b - a).cross(c - a).length() > 1e-6 * longest
}

/// What one state does to one triangle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Change {
    /// The rotation as a vector.
    pub(super) turn: DVec3,
    /// `(S - I) P`.
    pub(super) stretch: [DVec3; 2],
}

/// Triangles side by side.
#[derive(Clone, Debug)]
struct Tile {
    corners: [[u32; 3]; TILE],
    /// `P`: two vectors.
    axes: [Lane; 6],
    /// One over the number of triangles; 0 where there is none.
    weight: Lane,
    /// Weight times rate: first edge in column 0, first and second edge in column 1.
    rates: [Lane; 3],
}

/// All triangles and states.
#[derive(Clone, Debug, Default)]
pub(super) struct Features {
    tiles: Vec<Tile>,
    /// Per tile and state: turn, then stretch.
    changes: Vec<[Lane; 9]>,
    states: usize,
}

/// The blend at some weights, in the terms of the linear system.
#[derive(Clone, Debug)]
pub(super) struct Blend {
    /// `G^T M` and `G^T dM/dw_i`, per row of the system; one list per block of fields.
    pub(super) right: Vec<Vec<[f64; LANES]>>,
    /// Inner products of `M` (field 0) and all `dM/dw_i`.
    pub(super) inner: [[f64; FIELDS]; FIELDS],
}

impl Features {
    /// Triangles with their rows in the system, and per state all changes.
    pub(super) fn new(triangles: &[([u32; 3], Flat)], states: &[Vec<Change>]) -> Self {
        let share = 1.0 / triangles.len() as f64;
        let mut features = Self { states: states.len(), ..Self::default() };
        for (t, chunk) in triangles.chunks(TILE).enumerate() {
            // What is missing in the last tile has no weight.
            let mut tile =
                Tile { corners: [[0; 3]; TILE], axes: [[0.0; TILE]; 6], weight: [0.0; TILE], rates: [[0.0; TILE]; 3] };
            for (l, (corners, flat)) in chunk.iter().enumerate() {
                let (first, second) = flat.rates();
                tile.corners[l] = *corners;
                tile.weight[l] = share;
                for (to, rate) in tile.rates.iter_mut().zip([first, second.0, second.1]) {
                    to[l] = share * rate;
                }
                let axes = flat.axes.iter().flat_map(|a| a.to_array());
                tile.axes.iter_mut().zip(axes).for_each(|(to, x)| to[l] = x);
            }
            features.tiles.push(tile);
            for state in states {
                let mut lanes = [[0.0; TILE]; 9];
                for (l, change) in state[t * TILE..].iter().take(TILE).enumerate() {
                    let all = [change.turn, change.stretch[0], change.stretch[1]];
                    let numbers = all.iter().flat_map(|v| v.to_array());
                    lanes.iter_mut().zip(numbers).for_each(|(to, x)| to[l] = x);
                }
                features.changes.push(lanes);
            }
        }
        features
    }

    /// An empty blend for a system of so many rows.
    pub(super) fn blend(&self, rows: usize) -> Blend {
        let blocks = (self.states + 1).div_ceil(PER_BLOCK);
        Blend { right: vec![vec![[0.0; LANES]; rows]; blocks], inner: [[0.0; FIELDS]; FIELDS] }
    }

    /// The blend at `weights`, one per state.
    pub(super) fn evaluate(&self, weights: &[f64], out: &mut Blend) {
        for block in &mut out.right {
            block.fill([0.0; LANES]);
        }
        let mut inner = [[0.0; TILE]; FIELDS * (FIELDS + 1) / 2];
        evaluate(&self.tiles, &self.changes, weights, &mut out.right, &mut inner);
        let mut sums = inner.iter().map(|lanes| lanes.iter().sum::<f64>());
        for a in 0..=self.states {
            for b in 0..=a {
                let sum = sums.next().unwrap_or(0.0);
                out.inner[a][b] = sum;
                out.inner[b][a] = sum;
            }
        }
    }
}

#[multiversion(targets("x86_64+avx2", "x86_64+avx"))]
fn evaluate(
    tiles: &[Tile],
    changes: &[[Lane; 9]],
    weights: &[f64],
    right: &mut [Vec<[f64; LANES]>],
    inner: &mut [Lane],
) {
    let states = weights.len().min(MOST_STATES);
    let mut fields = [[[0.0; TILE]; 6]; FIELDS];
    for (tile, changes) in tiles.iter().zip(changes.chunks_exact(states)) {
        blend_tile(tile, changes, &weights[..states], &mut fields);
        let mut pair = 0;
        for a in 0..=states {
            for b in 0..=a {
                let sum = &mut inner[pair];
                for (fa, fb) in fields[a].iter().zip(&fields[b]) {
                    for l in 0..TILE {
                        sum[l] += tile.weight[l] * fa[l] * fb[l];
                    }
                }
                pair += 1;
            }
        }
        for (block, group) in right.iter_mut().zip(fields[..=states].chunks_mut(PER_BLOCK)) {
            scatter(tile, group, block);
        }
    }
}

/// Adds `G^T` of some fields of a tile to their block; what was in the fields is gone.
#[inline(always)]
fn scatter(tile: &Tile, group: &mut [[Lane; 6]], block: &mut [[f64; LANES]]) {
    let mut second = [[0.0; LANES]; TILE];
    let mut third = [[0.0; LANES]; TILE];
    for (f, field) in group.iter_mut().enumerate() {
        for c in 0..3 {
            for l in 0..TILE {
                let (m0, m1) = (field[c][l], field[c + 3][l]);
                second[l][3 * f + c] = tile.rates[0][l] * m0 + tile.rates[1][l] * m1;
                third[l][3 * f + c] = tile.rates[2][l] * m1;
            }
        }
    }
    for l in 0..TILE {
        let [a, b, c] = tile.corners[l].map(|v| v as usize);
        for k in 0..LANES {
            block[b][k] += second[l][k];
        }
        for k in 0..LANES {
            block[c][k] += third[l][k];
        }
        for k in 0..LANES {
            block[a][k] -= second[l][k] + third[l][k];
        }
    }
}

/// Writes `M` into field 0 and `dM/dw_i` into field `i`.
#[inline(always)]
fn blend_tile(tile: &Tile, changes: &[[Lane; 9]], weights: &[f64], fields: &mut [[Lane; 6]; FIELDS]) {
    let mut turn = [[0.0; TILE]; 3];
    let mut flat = tile.axes;
    for (change, &w) in changes.iter().zip(weights) {
        for c in 0..3 {
            for l in 0..TILE {
                turn[c][l] += w * change[c][l];
            }
        }
        for c in 0..6 {
            for l in 0..TILE {
                flat[c][l] += w * change[c + 3][l];
            }
        }
    }
    // R v = cos v + a (turn x v) + b turn (turn . v); the left derivative is a dv + b (turn x dv) + c turn (turn . dv).
    let [mut cos, mut a, mut b, mut c] = [[0.0; TILE]; 4];
    for l in 0..TILE {
        let s = turn[0][l] * turn[0][l] + turn[1][l] * turn[1][l] + turn[2][l] * turn[2][l];
        let (al, bl, cl, cosl) = rodrigues(s);
        (a[l], b[l], c[l], cos[l]) = (al, bl, cl, cosl);
    }
    let (blend, derivatives) = fields.split_at_mut(1);
    for half in 0..2 {
        let [x, y, z] = [0, 1, 2].map(|c| 3 * half + c);
        for l in 0..TILE {
            let t = [turn[0][l], turn[1][l], turn[2][l]];
            let v = [flat[x][l], flat[y][l], flat[z][l]];
            let r = rotate(t, v, cos[l], a[l], b[l]);
            (blend[0][x][l], blend[0][y][l], blend[0][z][l]) = (r[0], r[1], r[2]);
        }
    }
    for (field, change) in derivatives.iter_mut().zip(changes) {
        let mut spin = [[0.0; TILE]; 3];
        for l in 0..TILE {
            let t = [turn[0][l], turn[1][l], turn[2][l]];
            let d = [change[0][l], change[1][l], change[2][l]];
            let s = rotate(t, d, a[l], b[l], c[l]);
            (spin[0][l], spin[1][l], spin[2][l]) = (s[0], s[1], s[2]);
        }
        for half in 0..2 {
            let [x, y, z] = [0, 1, 2].map(|c| 3 * half + c);
            for l in 0..TILE {
                let t = [turn[0][l], turn[1][l], turn[2][l]];
                let v = [change[x + 3][l], change[y + 3][l], change[z + 3][l]];
                let r = rotate(t, v, cos[l], a[l], b[l]);
                let m = [blend[0][x][l], blend[0][y][l], blend[0][z][l]];
                let s = cross([spin[0][l], spin[1][l], spin[2][l]], m);
                (field[x][l], field[y][l], field[z][l]) = (r[0] + s[0], r[1] + s[1], r[2] + s[2]);
            }
        }
    }
}

#[inline(always)]
fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// `p v + q (t x v) + r t (t . v)`.
#[inline(always)]
fn rotate(t: [f64; 3], v: [f64; 3], p: f64, q: f64, r: f64) -> [f64; 3] {
    let x = cross(t, v);
    let along = r * (t[0] * v[0] + t[1] * v[1] + t[2] * v[2]);
    [p * v[0] + q * x[0] + along * t[0], p * v[1] + q * x[1] + along * t[1], p * v[2] + q * x[2] + along * t[2]]
}

/// Of an angle with the square `s`: sin/angle, (1 - cos)/s, (angle - sin)/(angle s), and cos. Without branches, and with
/// additions and products only besides a root and two divisions, so that lanes go in step and bits are the same everywhere.
#[inline(always)]
fn rodrigues(s: f64) -> (f64, f64, f64, f64) {
    const SMALL: f64 = 0.25;
    // Series, good to the last bit up to an angle of one half.
    let q = s * (1.0 / 156.0);
    let tail = 1.0 - s * (1.0 / 42.0) * (1.0 - s * (1.0 / 72.0) * (1.0 - s * (1.0 / 110.0) * (1.0 - q)));
    let c0 = (1.0 / 6.0) * (1.0 - s * (1.0 / 20.0) * tail);
    let a0 = 1.0 - s * c0;
    let deep = 1.0 - s * (1.0 / 56.0) * (1.0 - s * (1.0 / 90.0) * (1.0 - s * (1.0 / 132.0)));
    let b0 = 0.5 * (1.0 - s * (1.0 / 12.0) * (1.0 - s * (1.0 / 30.0) * deep));
    let cos0 = 1.0 - s * b0;
    // Beyond it, sine and cosine.
    let large = if s < SMALL { SMALL } else { s };
    let angle = large.sqrt();
    let (sin, cos) = sin_cos(angle);
    let over = 1.0 / large;
    let a1 = sin / angle;
    let b1 = (1.0 - cos) * over;
    let c1 = (1.0 - a1) * over;
    if s < SMALL { (a0, b0, c0, cos0) } else { (a1, b1, c1, cos) }
}

/// Sine and cosine of an angle from 0 to some hundred radians, to about 1e-15: reduction to an eighth turn by parts of pi / 2
/// (Cody, Waite 1980), then the Cephes library's polynomials.
#[inline(always)]
fn sin_cos(angle: f64) -> (f64, f64) {
    // Adding and taking away 1.5 * 2^52 rounds to whole numbers.
    const ROUND: f64 = 6_755_399_441_055_744.0;
    const HALF_PI: [f64; 3] = [1.570_796_251_296_997, 7.549_789_415_861_596e-8, 5.390_302_858_158_119e-15];
    let n = (angle * std::f64::consts::FRAC_2_PI + ROUND) - ROUND;
    let x = ((angle - n * HALF_PI[0]) - n * HALF_PI[1]) - n * HALF_PI[2];
    let z = x * x;
    let s = x + x
        * z
        * (((((1.589_623_015_765_465_7e-10 * z - 2.505_074_776_285_780_7e-8) * z + 2.755_731_362_138_572_5e-6) * z
            - 1.984_126_982_958_954e-4)
            * z
            + 8.333_333_333_322_118e-3)
            * z
            - 1.666_666_666_666_663e-1);
    let c = 1.0 - 0.5 * z
        + z * z
            * (((((-1.135_853_652_138_768e-11 * z + 2.087_570_084_197_473e-9) * z - 2.755_731_417_929_674e-7) * z
                + 2.480_158_728_885_171_8e-5)
                * z
                - 1.388_888_888_887_305_6e-3)
                * z
                + 4.166_666_666_666_659e-2);
    // The quarter: -2 to 2, where both ends are the half turn.
    let quarter = n - 4.0 * ((n * 0.25 + ROUND) - ROUND);
    let odd = quarter * quarter == 1.0;
    let (sin, cos) = if odd { (c, s) } else { (s, c) };
    let half = quarter * quarter == 4.0;
    let sin = if half || quarter == -1.0 { -sin } else { sin };
    let cos = if half || quarter == 1.0 { -cos } else { cos };
    (sin, cos)
}

#[cfg(test)]
mod tests {
    use super::super::rotation::exponential;
    use super::*;
    use crate::math::rng::Key;
    use glam::DMat3;

    #[test]
    fn sine_and_cosine_are_those_of_the_library() {
        for i in 0..100_000 {
            let angle = f64::from(i) * 4e-4;
            let (sin, cos) = sin_cos(angle);
            assert!((sin - libm::sin(angle)).abs() < 4e-15, "{angle}");
            assert!((cos - libm::cos(angle)).abs() < 4e-15, "{angle}");
        }
    }

    #[test]
    fn both_sides_of_the_series_agree() {
        let (below, above) = (rodrigues(0.25 - 1e-12), rodrigues(0.25 + 1e-12));
        for (b, a) in [(below.0, above.0), (below.1, above.1), (below.2, above.2), (below.3, above.3)] {
            assert!((b - a).abs() < 1e-12, "{b} {a}");
        }
        let (a, b, c, cos) = rodrigues(0.0);
        assert_eq!((a, b, cos), (1.0, 0.5, 1.0));
        assert!((c - 1.0 / 6.0).abs() < 1e-16);
    }

    fn vector(key: Key, size: f64) -> DVec3 {
        DVec3::from_array([0, 1, 2].map(|c| size * f64::from(key.with(c as u64).range(-1.0, 1.0))))
    }

    type Triangles = Vec<([u32; 3], Flat)>;

    /// 11 triangles about 12 rows with 3 states.
    fn features() -> (Triangles, Vec<Vec<Change>>, Features) {
        let key = Key::new(3, "features");
        let triangle = |i: u64| {
            let k = key.with(i);
            let corners = [0, 1, 2].map(|c| vector(k.with(10 + c), 2.0));
            ([i as u32, (i as u32 + 1) % 12, (i as u32 + 5) % 12], Flat::new(corners).unwrap())
        };
        let triangles: Vec<_> = (0..11).map(triangle).collect();
        let change = |s: u64, i: u64| {
            let k = key.with(100 + s).with(i);
            let m = DMat3::from_cols(vector(k.with(1), 0.3), vector(k.with(2), 0.3), vector(k.with(3), 0.3));
            let extra = m + m.transpose();
            let axes = triangles[i as usize].1.axes;
            Change { turn: vector(k, 3.0), stretch: axes.map(|a| extra * a) }
        };
        let states: Vec<Vec<Change>> = (0..3).map(|s| (0..11).map(|i| change(s, i)).collect()).collect();
        let features = Features::new(&triangles, &states);
        (triangles, states, features)
    }

    /// The blend written out plainly: one `F` per triangle.
    fn plain(triangles: &[([u32; 3], Flat)], states: &[Vec<Change>], w: &[f64]) -> Vec<[DVec3; 2]> {
        let one = |(i, (_, flat)): (usize, &([u32; 3], Flat))| {
            let turn: DVec3 = states.iter().zip(w).map(|(s, &w)| s[i].turn * w).sum();
            [0, 1].map(|h| {
                let stretched: DVec3 = states.iter().zip(w).map(|(s, &w)| s[i].stretch[h] * w).sum();
                exponential(turn) * (flat.axes[h] + stretched)
            })
        };
        triangles.iter().enumerate().map(one).collect()
    }

    #[test]
    fn a_blend_is_what_it_says_and_its_derivatives_are_its_slopes() {
        let (triangles, states, features) = features();
        let weight = 1.0 / triangles.len() as f64;
        for w in [[0.0, 0.0, 0.0], [0.3, 0.9, -0.4], [1.0, 0.0, 0.0], [1.7, 1.1, 2.0]] {
            let mut blend = features.blend(12);
            features.evaluate(&w, &mut blend);
            let at = |w: &[f64]| plain(&triangles, &states, w);
            let slope = |e: usize| {
                let (mut up, mut down) = (w, w);
                up[e] += 1e-5;
                down[e] -= 1e-5;
                let pair = |(a, b): ([DVec3; 2], [DVec3; 2])| [0, 1].map(|h| (a[h] - b[h]) / 2e-5);
                at(&up).into_iter().zip(at(&down)).map(pair).collect::<Vec<_>>()
            };
            let fields = [at(&w), slope(0), slope(1), slope(2)];
            // Right-hand sides and inner products from the plain fields.
            let mut right = vec![[0.0; LANES]; 12];
            for (f, field) in fields.iter().enumerate() {
                for ((corners, flat), m) in triangles.iter().zip(field) {
                    let (first, second) = flat.rates();
                    let b = (m[0] * first + m[1] * second.0) * weight;
                    let c = m[1] * second.1 * weight;
                    for (row, v) in corners.iter().zip([-b - c, b, c]) {
                        for k in 0..3 {
                            right[*row as usize][3 * f + k] += v[k];
                        }
                    }
                }
            }
            for (got, want) in blend.right[0].iter().zip(&right) {
                for k in 0..LANES {
                    assert!((got[k] - want[k]).abs() < 1e-8, "{w:?} {k}: {} {}", got[k], want[k]);
                }
            }
            for a in 0..4 {
                for b in 0..4 {
                    let want: f64 = triangles
                        .iter()
                        .zip(fields[a].iter().zip(&fields[b]))
                        .map(|(_, (m, n))| weight * (m[0].dot(n[0]) + m[1].dot(n[1])))
                        .sum();
                    assert!((blend.inner[a][b] - want).abs() < 1e-6, "{a} {b}: {} {want}", blend.inner[a][b]);
                }
            }
        }
    }
}
