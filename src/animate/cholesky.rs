//! Sparse Cholesky factors, solved for many right-hand sides at once.
//!
//! `A = L D L^T` by the up-looking method (Davis 2005, "LDL"): the pattern of a row of `L` is a walk up the elimination
//! tree. The unknowns are numbered in the order of elimination by the caller ([`super::order`]). Everything is plain
//! f64 arithmetic in a fixed order, so the same matrix gives the same bits on every machine and with every width of
//! vector unit: the right-hand sides of one unknown lie side by side and are worked on in step.

use multiversion::multiversion;

/// Right-hand sides in one block: three registers of four.
pub(super) const LANES: usize = 12;

/// A symmetric matrix, its lower triangle by rows.
#[derive(Clone, Debug, Default)]
pub(super) struct Lower {
    /// Per row: columns up to the row's own, ascending, the diagonal last.
    pub(super) rows: Vec<Vec<(u32, f64)>>,
}

/// A factorisation of a positive definite matrix.
#[derive(Clone, Debug)]
pub(super) struct Factor {
    /// Where the columns of `L` start in the two lists that follow; the unit diagonal is left out.
    starts: Vec<u32>,
    rows: Vec<u32>,
    values: Vec<f64>,
    /// One over `D`.
    inverse: Vec<f64>,
}

/// The matrix is not positive definite.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Indefinite {
    /// The unknown at which that showed.
    pub(super) row: usize,
}

const NONE: u32 = u32::MAX;

impl Factor {
    /// Factors a matrix.
    ///
    /// # Errors
    /// The unknown whose pivot is not above rounding.
    pub(super) fn new(matrix: &Lower) -> Result<Self, Indefinite> {
        let n = matrix.rows.len();
        // The elimination tree and the number of entries of every column.
        let (mut parent, mut mark, mut counts) = (vec![NONE; n], vec![NONE; n], vec![0_u32; n]);
        for (k, row) in matrix.rows.iter().enumerate() {
            mark[k] = k as u32;
            for &(j, _) in row {
                let mut i = j as usize;
                while i < k && mark[i] != k as u32 {
                    if parent[i] == NONE {
                        parent[i] = k as u32;
                    }
                    counts[i] += 1;
                    mark[i] = k as u32;
                    i = parent[i] as usize;
                }
            }
        }
        let mut starts = vec![0_u32; n + 1];
        for k in 0..n {
            starts[k + 1] = starts[k] + counts[k];
        }
        let total = starts[n] as usize;
        let (mut rows, mut values) = (vec![0_u32; total], vec![0.0; total]);
        let mut inverse = vec![0.0; n];
        // Row by row: a sparse triangular solve with the columns so far.
        let (mut filled, mut y) = (vec![0_u32; n], vec![0.0; n]);
        let mut pattern = Vec::new();
        mark.fill(NONE);
        for (k, row) in matrix.rows.iter().enumerate() {
            mark[k] = k as u32;
            pattern.clear();
            let mut diagonal = 0.0;
            for &(j, a) in row {
                if j as usize == k {
                    diagonal += a;
                    continue;
                }
                y[j as usize] += a;
                let mut i = j as usize;
                while mark[i] != k as u32 {
                    pattern.push(i as u32);
                    mark[i] = k as u32;
                    i = parent[i] as usize;
                }
            }
            // A parent's number is above its children's, so this is a topological order.
            pattern.sort_unstable();
            let full = diagonal;
            for &i in &pattern {
                let i = i as usize;
                let yi = std::mem::take(&mut y[i]);
                let (start, end) = (starts[i] as usize, (starts[i] + filled[i]) as usize);
                for p in start..end {
                    y[rows[p] as usize] -= values[p] * yi;
                }
                let l = yi * inverse[i];
                diagonal -= l * yi;
                rows[end] = k as u32;
                values[end] = l;
                filled[i] += 1;
            }
            if diagonal.is_nan() || diagonal <= 1e-13 * full {
                return Err(Indefinite { row: k });
            }
            inverse[k] = 1.0 / diagonal;
        }
        Ok(Self { starts, rows, values, inverse })
    }

    /// How many unknowns there are.
    pub(super) fn size(&self) -> usize {
        self.inverse.len()
    }

    /// Numbers in the factor, the diagonal included.
    pub(super) fn entries(&self) -> usize {
        self.values.len() + self.inverse.len()
    }

    /// Solves for the first `size()` rows of a block in place; the first `lanes` right-hand sides at least.
    pub(super) fn solve(&self, x: &mut [[f64; LANES]], lanes: usize) {
        let (starts, rows, values, inverse) = (&self.starts[..], &self.rows[..], &self.values[..], &self.inverse[..]);
        match lanes {
            0 => {}
            1..=4 => solve_few(starts, rows, values, inverse, x),
            _ => solve_block(starts, rows, values, inverse, x),
        }
    }
}

#[multiversion(targets("x86_64+avx2", "x86_64+avx"))]
fn solve_block(starts: &[u32], rows: &[u32], values: &[f64], inverse: &[f64], x: &mut [[f64; LANES]]) {
    substitute::<LANES>(starts, rows, values, inverse, x);
}

#[multiversion(targets("x86_64+avx2", "x86_64+avx"))]
fn solve_few(starts: &[u32], rows: &[u32], values: &[f64], inverse: &[f64], x: &mut [[f64; LANES]]) {
    substitute::<4>(starts, rows, values, inverse, x);
}

#[inline(always)]
fn substitute<const W: usize>(starts: &[u32], rows: &[u32], values: &[f64], inverse: &[f64], x: &mut [[f64; LANES]]) {
    let n = inverse.len();
    let x = &mut x[..n];
    for j in 0..n {
        let own = x[j];
        let (start, end) = (starts[j] as usize, starts[j + 1] as usize);
        for (&i, &l) in rows[start..end].iter().zip(&values[start..end]) {
            let to = &mut x[i as usize];
            for c in 0..W {
                to[c] -= l * own[c];
            }
        }
    }
    for j in (0..n).rev() {
        let mut own = x[j];
        for o in own.iter_mut().take(W) {
            *o *= inverse[j];
        }
        let (start, end) = (starts[j] as usize, starts[j + 1] as usize);
        for (&i, &l) in rows[start..end].iter().zip(&values[start..end]) {
            let from = &x[i as usize];
            for c in 0..W {
                own[c] -= l * from[c];
            }
        }
        x[j] = own;
    }
}

#[cfg(test)]
mod tests {
    use super::super::order::minimum_degree;
    use super::*;
    use crate::math::rng::Key;

    /// The Laplacian of a tube of quads with one diagonal each, with one vertex tied to the ground.
    fn tube(rings: usize, sides: usize) -> Vec<Vec<(usize, f64)>> {
        let n = rings * sides;
        let mut dense = vec![vec![]; n];
        let key = Key::new(5, "tube");
        let mut add = |a: usize, b: usize| {
            let w = f64::from(key.with(a as u64).with(b as u64).range(0.1, 2.0));
            dense[a].extend([(a, w), (b, -w)]);
            dense[b].extend([(b, w), (a, -w)]);
        };
        for r in 0..rings {
            for s in 0..sides {
                let (a, right) = (r * sides + s, r * sides + (s + 1) % sides);
                add(a, right);
                if r + 1 < rings {
                    add(a, a + sides);
                    add(right, a + sides);
                }
            }
        }
        dense[0].push((0, 1.0));
        dense
    }

    fn lower(dense: &[Vec<(usize, f64)>], order: &[u32]) -> Lower {
        let mut place = vec![0; order.len()];
        order.iter().enumerate().for_each(|(k, &v)| place[v as usize] = k);
        let row = |&v: &u32| {
            let mut row = std::collections::BTreeMap::new();
            for &(u, a) in &dense[v as usize] {
                if place[u] <= place[v as usize] {
                    *row.entry(place[u] as u32).or_insert(0.0) += a;
                }
            }
            row.into_iter().collect()
        };
        Lower { rows: order.iter().map(row).collect() }
    }

    const RINGS: usize = 19;
    const SIDES: usize = 40;
    const COUNT: usize = RINGS * SIDES;

    #[test]
    fn a_solve_gives_back_what_was_multiplied() {
        let dense = tube(RINGS, SIDES);
        let neighbours: Vec<Vec<u32>> = dense
            .iter()
            .enumerate()
            .map(|(i, row)| {
                let all: std::collections::BTreeSet<u32> =
                    row.iter().map(|&(j, _)| j as u32).filter(|&j| j as usize != i).collect();
                all.into_iter().collect()
            })
            .collect();
        let order = minimum_degree(&neighbours);
        let natural: Vec<u32> = (0..COUNT as u32).collect();
        let (ordered, plain) = (lower(&dense, &order), lower(&dense, &natural));
        let factor = Factor::new(&ordered).unwrap();
        let (few, many) = (factor.entries(), Factor::new(&plain).unwrap().entries());
        assert!(2 * few < many, "{few} {many}");
        let truth: Vec<[f64; LANES]> = (0..COUNT as u64)
            .map(|i| std::array::from_fn(|c| f64::from(Key::new(1, "x").with(i).with(c as u64).range(-1.0, 1.0))))
            .collect();
        let mut b = vec![[0.0; LANES]; COUNT];
        for (k, row) in ordered.rows.iter().enumerate() {
            for &(j, a) in row {
                let j = j as usize;
                for c in 0..LANES {
                    b[k][c] += a * truth[j][c];
                    if j != k {
                        b[j][c] += a * truth[k][c];
                    }
                }
            }
        }
        let mut few = b.clone();
        factor.solve(&mut b, LANES);
        factor.solve(&mut few, 3);
        for (k, (x, t)) in b.iter().zip(&truth).enumerate() {
            for c in 0..LANES {
                assert!((x[c] - t[c]).abs() < 1e-11, "{k} {c}: {} {}", x[c], t[c]);
            }
            assert_eq!(few[k][..3], x[..3]);
        }
    }

    #[test]
    fn what_nothing_ties_down_is_refused() {
        let mut dense = tube(3, 4);
        dense[0].pop();
        let order: Vec<u32> = (0..12).collect();
        assert!(matches!(Factor::new(&lower(&dense, &order)), Err(Indefinite { row: 11 })));
        assert_eq!(Factor::new(&Lower::default()).unwrap().size(), 0);
    }
}
