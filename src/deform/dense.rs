//! Small dense systems of linear equations.

/// Solves `a x = b` for several right-hand sides by elimination with row pivots; `a` is `n` x `n`, row by row, and `b` has
/// `N` numbers per row. `None` when the system is as good as singular.
pub fn solve<const N: usize>(mut a: Vec<f64>, mut b: Vec<[f64; N]>) -> Option<Vec<[f64; N]>> {
    let n = b.len();
    let largest = a.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    for k in 0..n {
        let pivot = (k..n).max_by(|&i, &j| a[i * n + k].abs().total_cmp(&a[j * n + k].abs()))?;
        let size = a[pivot * n + k].abs();
        if size.is_nan() || size <= 1e-12 * largest {
            return None;
        }
        if pivot != k {
            for c in 0..n {
                a.swap(k * n + c, pivot * n + c);
            }
            b.swap(k, pivot);
        }
        for i in k + 1..n {
            let factor = a[i * n + k] / a[k * n + k];
            if factor == 0.0 {
                continue;
            }
            for c in k..n {
                a[i * n + c] -= factor * a[k * n + c];
            }
            let known = b[k];
            b[i].iter_mut().zip(known).for_each(|(x, known)| *x -= factor * known);
        }
    }
    for k in (0..n).rev() {
        let mut x = b[k];
        for (c, x) in x.iter_mut().enumerate() {
            let known: f64 = (k + 1..n).map(|j| a[k * n + j] * b[j][c]).sum();
            *x = (*x - known) / a[k * n + k];
        }
        b[k] = x;
    }
    Some(b)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solves_what_needs_a_pivot_and_refuses_what_is_singular() {
        let x = solve(vec![0.0, 2.0, 1.0, 1.0, 0.0, 3.0, 2.0, 1.0, 0.0], vec![[7.0], [10.0], [4.0]]).unwrap();
        for (got, want) in x.iter().zip([1.0, 2.0, 3.0]) {
            assert!((got[0] - want).abs() < 1e-12);
        }
        assert!(solve(vec![1.0, 2.0, 2.0, 4.0], vec![[1.0], [2.0]]).is_none());
        assert!(solve(vec![f64::NAN], vec![[1.0]]).is_none());
    }
}
