//! Words and numbers of USD's text format.

use std::collections::BTreeSet;

/// Appends a number with at most five decimals, rounded to nearest. `x` must be finite.
pub fn decimal(out: &mut Vec<u8>, x: f32) {
    const DECIMALS: usize = 5;
    let x = f64::from(x);
    // Beyond 2^53 / 10^5 a float has no decimals worth writing, and the integer would overflow.
    if x.abs() > 9e10 {
        out.extend_from_slice(format!("{x}").as_bytes());
        return;
    }
    let scaled = (x * 1e5).round() as i64;
    if scaled < 0 {
        out.push(b'-');
    }
    let mut digits = [b'0'; 20];
    let (mut rest, mut first) = (scaled.unsigned_abs(), digits.len());
    while rest > 0 || first > digits.len() - DECIMALS - 1 {
        first -= 1;
        digits[first] = b'0' + (rest % 10) as u8;
        rest /= 10;
    }
    let (whole, part) = digits[first..].split_at(digits.len() - first - DECIMALS);
    out.extend_from_slice(whole);
    let kept = part.iter().rposition(|&d| d != b'0').map_or(0, |i| i + 1);
    if kept > 0 {
        out.push(b'.');
        out.extend_from_slice(&part[..kept]);
    }
}

/// Appends `(a, b, ...)`; what is not finite becomes 0, for uv of a broken file must not break ours.
pub fn tuple(out: &mut Vec<u8>, numbers: &[f32]) {
    out.push(b'(');
    for (i, &x) in numbers.iter().enumerate() {
        if i > 0 {
            out.extend_from_slice(b", ");
        }
        decimal(out, if x.is_finite() { x } else { 0.0 });
    }
    out.push(b')');
}

/// The text of [`tuple`].
pub fn of(numbers: &[f32]) -> String {
    let mut out = Vec::new();
    tuple(&mut out, numbers);
    String::from_utf8_lossy(&out).into_owned()
}

/// A string in quotes; control characters become spaces.
pub fn quoted(text: &str) -> String {
    let inner: String = text
        .chars()
        .flat_map(|c| {
            let escaped = matches!(c, '"' | '\\').then_some('\\');
            escaped.into_iter().chain(std::iter::once(if c.is_control() { ' ' } else { c }))
        })
        .collect();
    format!("\"{inner}\"")
}

/// Names of prims side by side: letters, digits and underscores, each name once.
#[derive(Default)]
pub struct Names {
    taken: BTreeSet<String>,
}

impl Names {
    /// The nearest free name.
    pub fn take(&mut self, wish: &str) -> String {
        let mut name: String = wish.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
        if !name.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_') {
            name.insert(0, '_');
        }
        let free = (1..).map(|n| if n == 1 { name.clone() } else { format!("{name}_{n}") });
        let name = free.into_iter().find(|n| !self.taken.contains(n)).unwrap_or(name.clone());
        self.taken.insert(name.clone());
        name
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(x: f32) -> String {
        let mut out = Vec::new();
        decimal(&mut out, x);
        String::from_utf8(out).unwrap()
    }

    #[test]
    fn numbers_are_rounded_and_short() {
        for (x, wanted) in [
            (0.0, "0"),
            (-0.0, "0"),
            (1.0, "1"),
            (-2.5, "-2.5"),
            (0.00001, "0.00001"),
            (0.000_004, "0"),
            (-0.000_004, "0"),
            (123.456_78, "123.45678"),
            (10.1, "10.1"),
            (1e6, "1000000"),
            (3e12, "3000000053248"),
        ] {
            assert_eq!(text(x), wanted);
        }
        for i in 0..20_000 {
            let x = crate::math::rng::Key::new(i, "decimal").range(-300.0, 300.0);
            let back: f64 = text(x).parse().unwrap();
            assert!((back - f64::from(x)).abs() <= 0.500_001e-5, "{x} became {back}");
        }
    }

    #[test]
    fn names_and_strings_are_safe() {
        let mut names = Names::default();
        let taken: Vec<_> = ["hair", "hair", "hair-2", "hair_2", "3d", "", "größe"].map(|n| names.take(n)).into();
        assert_eq!(taken, ["hair", "hair_2", "hair_2_2", "hair_2_3", "_3d", "_", "gr__e"]);
        assert_eq!(quoted("a\"b\\c\nd"), "\"a\\\"b\\\\c d\"");
    }
}
