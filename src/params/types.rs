//! The types that fields can have.

use std::sync::Arc;

use glam::Vec3;

use super::{Field, FieldType, Kind, Object, Reader, Value};
use crate::math::Colour;

/// A unit vector, given as a vector of any length but zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Direction(pub Vec3);

/// An angle: degrees in a script, radians here.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Angle {
    /// Radians.
    pub radians: f32,
}

impl Angle {
    /// From degrees.
    pub fn degrees(degrees: f32) -> Self {
        Self { radians: degrees.to_radians() }
    }
}

/// A script's function, by its number in the call's list of functions; whoever reads the table samples it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Function(pub usize);

fn number(value: &Value, reader: &mut Reader) -> Option<f64> {
    match value {
        Value::Number(n) if n.is_finite() => Some(*n),
        Value::Number(n) => reader.problem(format!("`{n}` is not a finite number"), None),
        Value::Text(t) => {
            let digits: String = t.chars().take_while(|c| c.is_ascii_digit() || *c == '.').collect();
            let hint = (!digits.is_empty()).then(|| format!("write the number without quotes or unit: {digits}"));
            reader.problem(format!("expected a number, got a string `{value}`"), hint)
        }
        other => reader.wrong_type("a number", other),
    }
}

fn integer(value: &Value, reader: &mut Reader, lo: f64, hi: f64) -> Option<f64> {
    let n = number(value, reader)?;
    if n.fract() != 0.0 {
        return reader
            .problem(format!("`{n}` is not a whole number"), Some(format!("write {} or {}", n.floor(), n.ceil())));
    }
    if n < lo || n > hi {
        return reader.problem(format!("`{n}` is out of range"), Some(format!("it takes {lo} to {hi}")));
    }
    Some(n)
}

macro_rules! integers {
    ($($ty:ty),*) => {$(
        impl FieldType for $ty {
            fn kind() -> Kind { Kind::Integer }
            fn read(value: &Value, reader: &mut Reader) -> Option<Self> {
                // 2^53: beyond it a script's number no longer tells neighbours apart.
                let limit = 9_007_199_254_740_992.0_f64;
                let n = integer(value, reader, (<$ty>::MIN as f64).max(-limit), (<$ty>::MAX as f64).min(limit))?;
                Some(n as $ty)
            }
            fn number(&self) -> Option<f64> { Some(*self as f64) }
            fn show(&self) -> String { self.to_string() }
        }
    )*};
}
integers!(i32, u32, u64, usize);

impl FieldType for f32 {
    fn kind() -> Kind {
        Kind::Number
    }
    fn read(value: &Value, reader: &mut Reader) -> Option<Self> {
        let n = number(value, reader)? as f32;
        if n.is_finite() { Some(n) } else { reader.problem(format!("`{value}` is too large"), None) }
    }
    fn number(&self) -> Option<f64> {
        // Through the shortest text, so that a script's 0.1 compares as 0.1 and not as 0.10000000149.
        self.to_string().parse().ok()
    }
    fn show(&self) -> String {
        self.to_string()
    }
}

impl FieldType for Angle {
    fn kind() -> Kind {
        Kind::Number
    }
    fn read(value: &Value, reader: &mut Reader) -> Option<Self> {
        f32::read(value, reader).map(Self::degrees)
    }
    fn unit() -> Option<&'static str> {
        Some("degrees")
    }
    fn number(&self) -> Option<f64> {
        // Back from radians the last digits are rounding.
        Some((f64::from(self.radians).to_degrees() * 1e4).round() / 1e4)
    }
    fn show(&self) -> String {
        self.number().map(|n| n.to_string()).unwrap_or_default()
    }
}

impl FieldType for bool {
    fn kind() -> Kind {
        Kind::Bool
    }
    fn read(value: &Value, reader: &mut Reader) -> Option<Self> {
        match value {
            Value::Bool(b) => Some(*b),
            other => reader.wrong_type("true or false", other),
        }
    }
    fn show(&self) -> String {
        self.to_string()
    }
}

impl FieldType for String {
    fn kind() -> Kind {
        Kind::Text
    }
    fn read(value: &Value, reader: &mut Reader) -> Option<Self> {
        match value {
            Value::Text(t) => Some(t.clone()),
            other => reader.wrong_type("a string", other),
        }
    }
    fn show(&self) -> String {
        format!("{self:?}")
    }
}

impl FieldType for Vec3 {
    fn kind() -> Kind {
        Kind::Point
    }
    fn read(value: &Value, reader: &mut Reader) -> Option<Self> {
        let v = match value {
            Value::Vector(v) => *v,
            Value::Table(t) if t.fields.is_empty() && t.items.len() == 3 => {
                let mut v = [0.0; 3];
                for (i, item) in t.items.iter().enumerate() {
                    v[i] = reader.inside(format!("[{}]", i + 1), |r| f32::read(item, r))?;
                }
                Self::from_array(v)
            }
            Value::Table(t) if t.fields.is_empty() && !t.items.is_empty() => {
                return reader.problem(format!("expected three numbers, got {}: `{value}`", t.items.len()), None);
            }
            Value::Table(t) if ["x", "y", "z"].iter().any(|k| t.fields.contains_key(*k)) => {
                return reader.problem(
                    format!("expected {{ x, y, z }}, got `{value}`"),
                    Some("leave out the names: { 0, 1, 0 }".into()),
                );
            }
            other => return reader.wrong_type("{ x, y, z } or a vector", other),
        };
        if v.is_finite() { Some(v) } else { reader.problem(format!("`{value}` is not finite"), None) }
    }
    fn show(&self) -> String {
        format!("{{ {}, {}, {} }}", self.x, self.y, self.z)
    }
}

impl FieldType for Direction {
    fn kind() -> Kind {
        Kind::Direction
    }
    fn read(value: &Value, reader: &mut Reader) -> Option<Self> {
        let v = Vec3::read(value, reader)?;
        // Scaled first: squares of very large or very small components leave the range of f32.
        let largest = v.abs().max_element();
        match (v / largest).try_normalize() {
            Some(unit) if largest > 0.0 => Some(Self(unit)),
            _ => reader
                .problem("a direction of length zero", Some("give it at least one component that is not 0".into())),
        }
    }
    fn show(&self) -> String {
        self.0.show()
    }
}

impl FieldType for Colour {
    fn kind() -> Kind {
        Kind::Colour
    }
    fn read(value: &Value, reader: &mut Reader) -> Option<Self> {
        if let Value::Text(text) = value {
            return Self::parse(text).or_else(|| {
                reader.problem(
                    format!("`\"{text}\"` is not a colour"),
                    Some("write \"#rrggbb\", as in \"#3b2417\", or { r, g, b } with 0 to 1".into()),
                )
            });
        }
        let v = Vec3::read(value, reader)?;
        if v.min_element() < 0.0 || v.max_element() > 1.0 {
            let hint =
                (v.max_element() > 1.0).then(|| "channels go from 0 to 1; divide by 255, or write \"#rrggbb\"".into());
            return reader.problem(format!("`{value}` is not a colour"), hint);
        }
        Some(Self::new(v.x, v.y, v.z))
    }
    fn show(&self) -> String {
        format!("\"{self}\"")
    }
}

impl FieldType for Function {
    fn kind() -> Kind {
        Kind::Function
    }
    fn read(value: &Value, reader: &mut Reader) -> Option<Self> {
        match value {
            Value::Function(n) => Some(Self(*n)),
            other => reader.wrong_type("a function", other),
        }
    }
    fn show(&self) -> String {
        "function".into()
    }
}

impl FieldType for Value {
    fn kind() -> Kind {
        Kind::Any
    }
    fn read(value: &Value, _: &mut Reader) -> Option<Self> {
        Some(value.clone())
    }
    fn show(&self) -> String {
        self.to_string()
    }
}

impl<T: Object> FieldType for Arc<T> {
    fn kind() -> Kind {
        Kind::Object(T::NAME)
    }
    fn read(value: &Value, reader: &mut Reader) -> Option<Self> {
        match value {
            Value::Handle(h) => h.get().or_else(|| reader.wrong_type(&format!("a {}", T::NAME), value)),
            other => reader.wrong_type(&format!("a {}", T::NAME), other),
        }
    }
}

impl<T: FieldType> FieldType for Option<T> {
    fn kind() -> Kind {
        T::kind()
    }
    fn read(value: &Value, reader: &mut Reader) -> Option<Self> {
        T::read(value, reader).map(Some)
    }
    fn absent() -> Option<Self> {
        Some(None)
    }
    fn unit() -> Option<&'static str> {
        T::unit()
    }
    fn nested() -> Option<fn() -> Vec<Field>> {
        T::nested()
    }
    fn number(&self) -> Option<f64> {
        self.as_ref().and_then(T::number)
    }
    fn show(&self) -> String {
        self.as_ref().map_or_else(|| "nil".into(), T::show)
    }
}

impl<T: FieldType> FieldType for Vec<T> {
    fn kind() -> Kind {
        Kind::List(Box::new(T::kind()))
    }
    fn nested() -> Option<fn() -> Vec<Field>> {
        T::nested()
    }
    fn read(value: &Value, reader: &mut Reader) -> Option<Self> {
        let Value::Table(table) = value else { return reader.wrong_type("a list", value) };
        if let Some(key) = table.fields.keys().next() {
            return reader.problem(
                format!("expected a list, got a table with the field `{key}`"),
                Some("write { a, b }, without names".into()),
            );
        }
        let read: Vec<Option<T>> = table
            .items
            .iter()
            .enumerate()
            .map(|(i, item)| reader.inside(format!("[{}]", i + 1), |r| T::read(item, r)))
            .collect();
        read.into_iter().collect()
    }
    fn show(&self) -> String {
        if self.is_empty() {
            return "{}".into();
        }
        format!("{{ {} }}", self.iter().map(T::show).collect::<Vec<_>>().join(", "))
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Table, read};
    use super::*;

    crate::choices! {
        /// Which way.
        pub enum Way { /// Up.
            Up = "up", /// Down.
            Down = "down" }
    }

    crate::params! {
        /// For the tests.
        pub struct Sample("coif.sample") {
            /// How far.
            length: f32, unit("cm"), range(0.1, 500.0);
            /// Which way.
            way: Way = Way::Down;
            /// Where to.
            direction: Direction = Direction(Vec3::Y);
            /// Maybe a turn.
            turn: Option<Angle>, range(-90.0, 90.0);
            /// Some numbers.
            list: Vec<f32> = vec![];
        }
    }

    fn table(fields: &[(&str, Value)]) -> Table {
        Table { items: vec![], fields: fields.iter().map(|(k, v)| ((*k).to_owned(), v.clone())).collect() }
    }

    fn list(values: &[f64]) -> Value {
        Value::Table(Table { items: values.iter().map(|&n| Value::Number(n)).collect(), ..Table::default() })
    }

    #[test]
    fn a_good_table_reads() {
        let t = table(&[
            ("length", Value::Number(3.0)),
            ("turn", Value::Number(90.0)),
            ("direction", list(&[0.0, 2e30, 0.0])),
        ]);
        let s = read::<Sample>(&t).unwrap();
        assert_eq!((s.length, s.way, s.direction.0), (3.0, Way::Down, Vec3::Y));
        assert_eq!(s.turn.unwrap().radians, std::f32::consts::FRAC_PI_2);
        assert!(s.list.is_empty());
    }

    #[test]
    fn all_problems_are_told_at_once() {
        let t = table(&[
            ("length", Value::Text("45cm".into())),
            ("way", Value::Text("dwn".into())),
            ("direction", list(&[0.0, 0.0, 0.0])),
            ("turn", Value::Number(91.0)),
            ("list", Value::Table(Table { items: vec![Value::Number(1.0), Value::Bool(true)], ..Table::default() })),
            ("lenth", Value::Number(1.0)),
        ]);
        let problems = read::<Sample>(&t).unwrap_err();
        let lines: Vec<String> = problems
            .iter()
            .map(|p| format!("{}: {}: {}", p.path, p.message, p.hint.clone().unwrap_or_default()))
            .collect();
        assert_eq!(
            lines,
            [
                ": unknown field `lenth`: did you mean `length`?",
                "length: expected a number, got a string `\"45cm\"`: write the number without quotes or unit: 45",
                "way: `\"dwn\"` is not one of the choices: did you mean \"down\"?",
                "direction: a direction of length zero: give it at least one component that is not 0",
                "turn: `91` is out of range: it takes -90 to 90 degrees",
                "list[2]: expected a number, got a boolean `true`: ",
            ]
        );
    }

    #[test]
    fn numbers_that_are_none_are_refused() {
        for bad in [f64::NAN, f64::INFINITY, 1e300] {
            assert!(read::<Sample>(&table(&[("length", Value::Number(bad))])).is_err(), "{bad}");
        }
        assert!(read::<Sample>(&table(&[])).unwrap_err()[0].message.contains("missing field `length`"));
    }
}
