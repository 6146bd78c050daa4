//! Variations of a style: `length=20..60:5`, `style=a,b,c`, and every combination of several.

/// Most values of one parameter.
const MOST_VALUES: usize = 1000;

/// Most combinations.
pub const MOST_COMBINATIONS: usize = 2500;

/// A parameter and the values it takes in turn.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Variation {
    /// The parameter; `seed` is the seed of the run.
    pub name: String,
    /// Its values as `--set` takes them, at least one.
    pub values: Vec<String>,
}

/// Why a variation is none.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum VariationError {
    /// Not `NAME=VALUES`.
    #[error("write NAME=FROM..TO:STEP, as in length=20..60:5, or NAME=A,B,C")]
    NoName,
    /// No value, or an empty one.
    #[error("`{0}` has an empty value")]
    Empty(String),
    /// A range whose ends or step are no numbers.
    #[error("`{0}` is not a range of numbers; write FROM..TO:STEP")]
    BadRange(String),
    /// A step that does not lead from one end to the other.
    #[error("a step of `{step}` does not lead from {from} to {to}")]
    BadStep {
        /// The step.
        step: f64,
        /// First value.
        from: f64,
        /// Last value.
        to: f64,
    },
    /// More values than anybody looks at.
    #[error("`{name}` has {count} values, more than {MOST_VALUES}")]
    TooMany {
        /// The parameter.
        name: String,
        /// How many values.
        count: f64,
    },
}

impl Variation {
    /// Reads `NAME=FROM..TO:STEP` (both ends included, step 1 when left out) or `NAME=A,B,C`.
    ///
    /// # Errors
    /// [`VariationError`].
    pub fn parse(text: &str) -> Result<Self, VariationError> {
        let (name, values) = text.split_once('=').ok_or(VariationError::NoName)?;
        let name = name.trim().to_owned();
        if name.is_empty() {
            return Err(VariationError::NoName);
        }
        let values = match values.split_once("..") {
            Some((from, rest)) => range(&name, values, from, rest)?,
            None => values.split(',').map(|v| v.trim().to_owned()).collect(),
        };
        if values.iter().any(String::is_empty) {
            return Err(VariationError::Empty(name));
        }
        if values.len() > MOST_VALUES {
            return Err(VariationError::TooMany { name, count: values.len() as f64 });
        }
        Ok(Self { name, values })
    }
}

fn range(name: &str, whole: &str, from: &str, rest: &str) -> Result<Vec<String>, VariationError> {
    let (to, step) = rest.split_once(':').unwrap_or((rest, "1"));
    let number = |t: &str| t.trim().parse::<f64>().ok().filter(|n| n.is_finite() && n.abs() < 1e15);
    let (Some(from), Some(to), Some(step)) = (number(from), number(to), number(step)) else {
        return Err(VariationError::BadRange(whole.to_owned()));
    };
    if from == to {
        return Ok(vec![from.to_string()]);
    }
    let count = (to - from) / step;
    if !count.is_finite() || count < 0.0 {
        return Err(VariationError::BadStep { step, from, to });
    }
    if count >= MOST_VALUES as f64 {
        return Err(VariationError::TooMany { name: name.to_owned(), count: count.floor() + 1.0 });
    }
    // The last value counts although 0.1 + 0.1 + 0.1 is a little more than 0.3; such tails are rounded off.
    let values = (0..=(count + 1e-6).floor() as usize).map(|i| {
        let value = (from + i as f64 * step) * 1e9;
        let rounded = value.round() / 1e9;
        (if rounded == 0.0 { 0.0 } else { rounded }).to_string()
    });
    Ok(values.collect())
}

/// Every combination, the first variation changing fastest; one without any value when there are no variations.
pub fn combinations(variations: &[Variation]) -> Vec<Vec<(String, String)>> {
    let mut all = vec![vec![]];
    for v in variations.iter().rev() {
        all = all
            .into_iter()
            .flat_map(|rest: Vec<(String, String)>| {
                v.values.iter().map(move |value| {
                    let mut one = vec![(v.name.clone(), value.clone())];
                    one.extend(rest.iter().cloned());
                    one
                })
            })
            .collect();
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values(text: &str) -> Vec<String> {
        Variation::parse(text).unwrap().values
    }

    #[test]
    fn ranges_and_lists() {
        assert_eq!(values("length=20..60:10"), ["20", "30", "40", "50", "60"]);
        assert_eq!(values("length=20..59:10"), ["20", "30", "40", "50"]);
        assert_eq!(values("seed=1..4"), ["1", "2", "3", "4"]);
        assert_eq!(values("a=0..0.3:0.1"), ["0", "0.1", "0.2", "0.3"]);
        assert_eq!(values("a=-0.2..0.2:0.2"), ["-0.2", "0", "0.2"]);
        assert_eq!(values("a=3..1:-1"), ["3", "2", "1"]);
        assert_eq!(values("a=5..5:0"), ["5"]);
        assert_eq!(values("style=a, b,c"), ["a", "b", "c"]);
    }

    #[test]
    fn what_is_none_is_refused() {
        for bad in
            ["length", "=1..3", "a=", "a=1,,2", "a=1..x", "a=1..2:0", "a=1..2:-1", "a=2..1", "a=0..1:1e-9", "a=1..inf"]
        {
            assert!(Variation::parse(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn combinations_run_through_the_first_fastest() {
        let all = combinations(&[Variation::parse("a=1..2").unwrap(), Variation::parse("b=x,y").unwrap()]);
        let texts: Vec<String> =
            all.iter().map(|c| c.iter().map(|(k, v)| format!("{k}{v}")).collect::<String>()).collect();
        assert_eq!(texts, ["a1bx", "a2bx", "a1by", "a2by"]);
        assert_eq!(combinations(&[]), [vec![]]);
    }
}
