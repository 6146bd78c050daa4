//! How much a run may make: refused before the work, with what it would need and how to raise the limit.
//!
//! What every call is about to make is added up over the run, found in the memo or not, so that a script is refused
//! in the same place however often it ran before. Time has a limit of its own ([`Options::time_limit`](super::Options)).

use crate::render::sheet::grouped;

/// What a run may need at most.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Memory of all geometry together, bytes; also of the script's own values, which have half a gigabyte at most.
    pub memory: u64,
    /// Points of all strands together.
    pub points: u64,
    /// Triangles of all heads and of all stylised hair together.
    pub triangles: u64,
}

impl Default for Limits {
    /// 4 GB, 200 million points, 20 million triangles: fifty times a full head of hair.
    fn default() -> Self {
        Self { memory: 4_000_000_000, points: 200_000_000, triangles: 20_000_000 }
    }
}

/// What a call is about to make, or all calls so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Need {
    /// Strands.
    pub strands: u64,
    /// Their points.
    pub points: u64,
    /// Triangles.
    pub triangles: u64,
}

/// A limit that would be passed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refusal {
    /// What it would be.
    pub message: String,
    /// What to do about it.
    pub hint: String,
}

impl Need {
    /// So many strands with so many points each.
    pub fn strands(strands: usize, points_each: usize) -> Self {
        let (strands, each) = (strands as u64, points_each as u64);
        Self { strands, points: strands.saturating_mul(each), triangles: 0 }
    }

    /// The same so many times over: for every frame.
    #[must_use]
    pub fn times(self, count: u64) -> Self {
        Self {
            strands: self.strands.saturating_mul(count),
            points: self.points.saturating_mul(count),
            triangles: self.triangles.saturating_mul(count),
        }
    }

    /// So many triangles.
    pub fn triangles(triangles: usize) -> Self {
        Self { triangles: triangles as u64, ..Self::default() }
    }

    /// Both together.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self {
            strands: self.strands.saturating_add(other.strands),
            points: self.points.saturating_add(other.points),
            triangles: self.triangles.saturating_add(other.triangles),
        }
    }

    /// Memory that it takes, roughly, bytes: a point with its stage; a strand with its root, its guide, its source and
    /// its offset; a triangle with its part of the vertices, the tree and the normals.
    pub fn bytes(self) -> u64 {
        let parts = [(self.points, 13), (self.strands, 64), (self.triangles, 250)];
        parts.iter().fold(0, |sum: u64, &(n, each)| sum.saturating_add(n.saturating_mul(each)))
    }
}

impl Limits {
    /// Whether `need` more is within them after `so_far`.
    ///
    /// # Errors
    /// The first limit that it passes.
    pub fn check(&self, so_far: Need, need: Need) -> Result<Need, Refusal> {
        let all = so_far.and(need);
        let counts = [
            ("points of strands", "points", so_far.points, all.points, self.points),
            ("triangles", "triangles", so_far.triangles, all.triangles, self.triangles),
        ];
        for (what, name, before, after, limit) in counts {
            // What adds nothing is not to blame for what was there.
            if after > limit && after > before {
                let (after, limit) = (grouped(after as usize), (grouped(limit as usize), enough(after)));
                let before = if before > 0 {
                    format!(", {} of them made before", grouped(before as usize))
                } else {
                    String::new()
                };
                return Err(Refusal {
                    message: format!("this needs `{after}` {what}{before}: the limit is {}", limit.0),
                    hint: format!("ask for less, or raise it: `--{name}-limit {}`", limit.1),
                });
            }
        }
        let (before, after) = (so_far.bytes(), all.bytes());
        if after > self.memory && after > before {
            let before =
                if before > 0 { format!(", {} of them made before", gigabytes(before)) } else { String::new() };
            return Err(Refusal {
                message: format!(
                    "this needs `{}` of memory for its geometry{before}: the limit is {}",
                    gigabytes(after),
                    gigabytes(self.memory)
                ),
                hint: format!("ask for less, or raise it: `--memory-limit {}B`", enough(after)),
            });
        }
        Ok(all)
    }
}

/// A short number that is no less: `2.6G`, `310M`.
fn enough(n: u64) -> String {
    let (unit, letter) = match n {
        0..1_000_000 => (1_000, "k"),
        1_000_000..1_000_000_000 => (1_000_000, "M"),
        _ => (1_000_000_000, "G"),
    };
    let tenths = n.div_ceil(unit / 10);
    if tenths >= 100 || tenths.is_multiple_of(10) {
        format!("{}{letter}", tenths.div_ceil(10))
    } else {
        format!("{}.{}{letter}", tenths / 10, tenths % 10)
    }
}

fn gigabytes(bytes: u64) -> String {
    if bytes < 100_000_000 { format!("{:.1} MB", bytes as f64 / 1e6) } else { format!("{:.2} GB", bytes as f64 / 1e9) }
}

/// Reads `500k`, `40M`, `1.5G`, `4GB`, `200000`; a power of ten for each letter.
pub fn count(text: &str) -> Option<u64> {
    let text = text.trim();
    let number = text.strip_suffix(['B', 'b']).unwrap_or(text);
    let (number, unit) = match number.chars().last()?.to_ascii_lowercase() {
        'k' => (&number[..number.len() - 1], 1e3),
        'm' => (&number[..number.len() - 1], 1e6),
        'g' => (&number[..number.len() - 1], 1e9),
        _ => (number, 1.0),
    };
    let value = number.trim().parse::<f64>().ok()? * unit;
    (1.0..=1e15).contains(&value).then_some(value.round() as u64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_read_and_written_short() {
        for (text, value) in [("200000", 200_000), ("500k", 500_000), ("1.5G", 1_500_000_000), ("4GB", 4_000_000_000)] {
            assert_eq!(count(text), Some(value), "{text}");
        }
        for bad in ["", "x", "-1", "0", "1e99", "G", "4TB", "nan", "inf"] {
            assert_eq!(count(bad), None, "{bad}");
        }
        for n in [1, 999, 12_345, 3_320_000, 99_999_999, 2_560_000_001, u64::from(u32::MAX)] {
            let short = enough(n);
            let back = count(&short).unwrap();
            assert!(back >= n && back as f64 <= n as f64 * 1.1 + 100.0, "{n}: {short}");
        }
    }

    #[test]
    fn each_limit_is_named_with_what_it_takes() {
        let limits = Limits { memory: 100_000_000, points: 1000, triangles: 50 };
        let first = limits.check(Need::default(), Need::strands(10, 60)).unwrap();
        let refusal = limits.check(first, Need::strands(10, 60)).unwrap_err();
        assert_eq!(
            refusal.message,
            "this needs `1,200` points of strands, 600 of them made before: the limit is 1,000"
        );
        assert!(refusal.hint.contains("--points-limit 1.2k"), "{}", refusal.hint);
        assert!(limits.check(first, Need::triangles(51)).unwrap_err().hint.contains("--triangles-limit"));
        assert_eq!(limits.check(first, Need::triangles(50)).unwrap().triangles, 50);
        let small = Limits { memory: 5000, ..Limits::default() };
        let refusal = small.check(Need::default(), Need::strands(10, 60)).unwrap_err();
        assert!(refusal.message.contains("memory") && refusal.hint.contains("--memory-limit 8.5kB"), "{refusal:?}");
        // Nothing overflows, and a limit that was lowered blames nobody who adds nothing.
        assert!(Limits::default().check(Need::default(), Need::strands(usize::MAX, usize::MAX)).is_err());
        assert!(limits.check(Need::triangles(60), Need::strands(1, 2)).is_ok());
    }
}
