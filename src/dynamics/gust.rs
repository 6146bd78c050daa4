//! Gusts: a smooth random function of time.

use super::lanes::{LANES, Lanes};
use crate::math::rng::Key;

/// Values between two random numbers.
const FINE: usize = 16;

/// Random numbers between -1 and 1, one for each period, and a smooth curve (Catmull-Rom) through them, as a table.
#[derive(Clone, Debug)]
pub struct Gusts {
    table: Vec<f32>,
    /// Periods before time 0: gusts that have passed already.
    before: f32,
}

impl Gusts {
    /// The curve from `before` periods before time 0 until `after` periods after it. With `round` it repeats after so
    /// many periods.
    pub fn new(key: Key, before: f32, after: f32, round: Option<u64>) -> Self {
        let first = -(before.ceil() as i64) - 1;
        let count = (after.ceil() as i64 - first + 2).max(2) as usize;
        let at = |k: i64| {
            let k = round.map_or(k, |n| k.rem_euclid(n.max(1) as i64));
            key.with(k as u64).range(-1.0, 1.0)
        };
        let table = (0..count * FINE).map(|i| {
            let (k, u) = (first + (i / FINE) as i64, (i % FINE) as f32 / FINE as f32);
            let (a, b, c, d) = (at(k - 1), at(k), at(k + 1), at(k + 2));
            b + (c - a) * (0.5 * u)
                + (a * 2.0 - b * 5.0 + c * 4.0 - d) * (0.5 * u * u)
                + (b * 3.0 - a - c * 3.0 + d) * (0.5 * u * u * u)
        });
        Self { table: table.collect(), before: -first as f32 }
    }

    /// The curve at these times, in periods.
    #[inline(always)]
    pub fn at(&self, times: &Lanes) -> Lanes {
        let mut out = [0.0; LANES];
        for l in 0..LANES {
            let x = ((times[l] + self.before) * FINE as f32).max(0.0);
            let i = (x as usize).min(self.table.len() - 2);
            let u = (x - i as f32).min(1.0);
            out[l] = self.table[i] + (self.table[i + 1] - self.table[i]) * u;
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gusts_are_smooth_bounded_and_come_round() {
        let gusts = Gusts::new(Key::new(1, "gusts"), 3.0, 20.0, Some(8));
        let at = |t: f32| gusts.at(&[t; LANES])[0];
        for i in -290..1990 {
            let t = i as f32 * 0.01;
            // Catmull-Rom leaves the range of its points by less than a quarter of it.
            assert!(at(t).abs() <= 1.5 && (at(t + 0.01) - at(t)).abs() < 0.06, "{t}");
            if t < 10.0 {
                assert!((at(t) - at(t + 8.0)).abs() < 1e-4, "{t}");
            }
        }
        let calm = (0..100).filter(|&i| at(i as f32 * 0.1).abs() < 0.05).count();
        assert!(calm < 60, "the wind must not be constant");
    }
}
