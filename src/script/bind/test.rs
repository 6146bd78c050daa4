//! Scripted tests: `coif.test` and what a test expects.
//!
//! An expectation that fails is noted with its place, and the test goes on; it returns whether it held, so that
//! `t:require(t:less(a, b))` stops the test there.

use super::super::call::{Call, Result};
use super::super::registry::{Entry, Noun};
use super::super::session::Raised;
use super::super::testing::{Declared, Tests};
use super::golden::{PreviewFields, preview};
use super::head::give;
use super::tested::{RunFields, SceneOf, run, scene_of};
use crate::params::{FieldType, Function, Object, Reader, Value};

/// The `t` of `function(t) ... end`.
#[derive(Clone, Copy, Debug)]
pub struct Tester;

impl Object for Tester {
    const NAME: &'static str = "Test";
}

crate::params! {
    /// Declares a test; it is run by `coif test`, in a fresh state of its own.
    pub struct TestFields("coif.test") {
        /// What it shows, in a few words; unique within the file.
        name: String;
        /// Takes the Test, `t`, whose methods run styles and state what is expected.
        body: Function, takes("(t: Test)");
    }
}

crate::params! {
    /// Expects two values to be the same: numbers, texts, vectors, or tables of them, entry by entry.
    pub struct EqualFields("Test:equal") {
        /// What there is.
        got: Option<Value>;
        /// What there should be.
        want: Option<Value>;
    }
}

crate::params! {
    /// Expects two numbers, or two vectors, to be no farther apart than the tolerance.
    pub struct NearFields("Test:near") {
        /// What there is.
        got: Value;
        /// What there should be.
        want: Value;
        /// How far apart they may be.
        tolerance: f32, range(0.0, 1e30);
    }
}

crate::params! {
    /// Expects a number to be less than another.
    pub struct LessFields("Test:less") {
        /// What there is.
        got: f64_;
        /// What it must stay below.
        limit: f64_;
    }
}

crate::params! {
    /// Expects a number to be greater than another.
    pub struct GreaterFields("Test:greater") {
        /// What there is.
        got: f64_;
        /// What it must exceed.
        limit: f64_;
    }
}

crate::params! {
    /// Expects a number to lie between two others, both allowed.
    pub struct BetweenFields("Test:between") {
        /// What there is.
        got: f64_;
        /// The least allowed.
        least: f64_;
        /// The greatest allowed.
        most: f64_;
    }
}

crate::params! {
    /// Expects a value to be neither false nor nil.
    pub struct OkFields("Test:ok") {
        /// Anything.
        value: Option<Value>;
        /// What it means when it does not hold.
        message: Option<String>;
    }
}

crate::params! {
    /// Stops the test, as failed, unless a value is neither false nor nil: `t:require(t:less(a, b))`.
    pub struct RequireFields("Test:require") {
        /// Anything.
        value: Option<Value>;
        /// What it means when it does not hold.
        message: Option<String>;
    }
}

crate::params! {
    /// Expects a function to raise an error.
    pub struct ErrorFields("Test:error") {
        /// Called without arguments.
        body: Function, takes("(): any?");
        /// What the error must say, as a part of its message.
        text: Option<String>;
    }
}

/// A number of a script in full precision, infinite ones too: figures are compared as they are.
#[expect(non_camel_case_types, reason = "stands for the plain type in the tables above")]
#[derive(Clone, Copy, Debug)]
pub struct f64_(f64);

impl FieldType for f64_ {
    fn kind() -> crate::params::Kind {
        crate::params::Kind::Number
    }
    fn read(value: &Value, reader: &mut Reader) -> Option<Self> {
        match value {
            Value::Number(n) => Some(Self(*n)),
            other => reader.wrong_type("a number", other),
        }
    }
}

/// `coif.test`.
pub fn functions() -> Vec<Entry> {
    vec![Entry::positional::<TestFields>("coif.test", "nil", declare)]
}

/// The test.
pub fn noun() -> Noun {
    let methods = vec![
        Entry::positional::<RunFields>("Test:run", "TestScene", run),
        Entry::positional::<SceneOf>("Test:scene", "TestScene", scene_of),
        Entry::positional::<EqualFields>("Test:equal", "boolean", equal),
        Entry::positional::<NearFields>("Test:near", "boolean", near),
        Entry::positional::<LessFields>("Test:less", "boolean", less),
        Entry::positional::<GreaterFields>("Test:greater", "boolean", greater),
        Entry::positional::<BetweenFields>("Test:between", "boolean", between),
        Entry::positional::<OkFields>("Test:ok", "boolean", ok),
        Entry::positional::<RequireFields>("Test:require", "any", require),
        Entry::positional::<ErrorFields>("Test:error", "boolean", error),
        Entry::positional::<PreviewFields>("Test:preview", "boolean", preview),
    ];
    let doc = "A running test: runs styles, and states what is expected. There is one only under `coif test`.";
    Noun::of::<Tester>(doc, methods, vec![], |_| "test".into())
}

fn declare(call: &Call) -> Result<Value> {
    let fields: TestFields = call.read()?;
    let tests = Tests::of(call)?;
    if tests.is_running.get() {
        return Err(call.problem("a test within a test", Some("declare it beside the other".into())));
    }
    let name = fields.name.trim().to_owned();
    if name.is_empty() {
        return Err(call.problem_at("name", "a test without a name", None));
    }
    let mut declared = tests.declared.borrow_mut();
    if declared.iter().any(|d| d.name == name) {
        let hint = "give each test of a file a name of its own".to_owned();
        return Err(call.problem_at("name", format!("there is already a test `{name}`"), Some(hint)));
    }
    let number = declared.len();
    let place = call.problem_at("name", "", None).0.pop().and_then(|d| d.place);
    declared.push(Declared { name, place });
    drop(declared);
    if tests.wanted == Some(number) {
        tests.is_running.set(true);
        let result = call.script(fields.body, &[give(Tester)]);
        tests.is_running.set(false);
        if let Err(Raised(diagnostics)) = result {
            tests.failures.borrow_mut().extend(diagnostics);
        }
    }
    Ok(Value::Nil)
}

/// Notes an expectation; a failed one with its place.
pub fn expect(call: &Call, holds: bool, message: impl FnOnce() -> String, hint: Option<String>) -> Result<Value> {
    let tests = Tests::of(call)?;
    tests.checks.set(tests.checks.get() + 1);
    if !holds {
        tests.failures.borrow_mut().extend(call.problem(message(), hint).0);
    }
    Ok(Value::Bool(holds))
}

fn equal(call: &Call) -> Result<Value> {
    let fields: EqualFields = call.read()?;
    let (got, want) = (fields.got.unwrap_or_default(), fields.want.unwrap_or_default());
    match difference(&got, &want, String::new()) {
        None => expect(call, true, String::new, None),
        Some((at, got, want)) => {
            let at = if at.is_empty() { at } else { format!(" at `{at}`") };
            expect(call, false, || format!("expected `{want}`{at}, got `{got}`"), None)
        }
    }
}

/// Where two values differ first, and what stands there in each.
fn difference(got: &Value, want: &Value, at: String) -> Option<(String, Value, Value)> {
    let is_same = match (got, want) {
        (Value::Nil, Value::Nil) => true,
        (Value::Bool(a), Value::Bool(b)) => a == b,
        (Value::Number(a), Value::Number(b)) => a == b,
        (Value::Text(a), Value::Text(b)) => a == b,
        (Value::Vector(a), Value::Vector(b)) => a == b,
        (Value::Table(a), Value::Table(b)) => {
            let items = (0..a.items.len().max(b.items.len())).find_map(|i| {
                let nil = &Value::Nil;
                let (a, b) = (a.items.get(i).unwrap_or(nil), b.items.get(i).unwrap_or(nil));
                difference(a, b, format!("{at}[{}]", i + 1))
            });
            return items.or_else(|| {
                let keys = a.fields.keys().chain(b.fields.keys().filter(|k| !a.fields.contains_key(*k)));
                keys.into_iter().find_map(|key| {
                    let of = |t: &crate::params::Table| t.fields.get(key).cloned().unwrap_or_default();
                    let at = if at.is_empty() { key.clone() } else { format!("{at}.{key}") };
                    difference(&of(a), &of(b), at)
                })
            });
        }
        _ => false,
    };
    (!is_same).then(|| (at, got.clone(), want.clone()))
}

fn near(call: &Call) -> Result<Value> {
    let fields: NearFields = call.read()?;
    let point = |v: &Value| match v {
        Value::Number(_) => None,
        other => <glam::Vec3 as FieldType>::read(other, &mut Reader::default()),
    };
    let (got, want) = (&fields.got, &fields.want);
    let distance = match (got, want) {
        (Value::Number(a), Value::Number(b)) => (a - b).abs(),
        _ => match (point(got), point(want)) {
            (Some(a), Some(b)) => f64::from(a.distance(b)),
            _ => {
                let message = format!("expected two numbers or two vectors, got `{got}` and `{want}`");
                return Err(call.problem(message, None));
            }
        },
    };
    // Through the shortest text: a script's 0.1 is 0.1.
    let tolerance: f64 = fields.tolerance.to_string().parse().unwrap_or(0.0);
    let message = || format!("expected `{want}` to within {tolerance}, got `{got}`, which is {} off", short(distance));
    expect(call, distance <= tolerance, message, None)
}

/// A number with as many digits as a person reads.
fn short(n: f64) -> String {
    let text = format!("{n:.4}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

fn less(call: &Call) -> Result<Value> {
    let LessFields { got: f64_(got), limit: f64_(limit) } = call.read()?;
    expect(call, got < limit, || format!("expected less than `{limit}`, got `{got}`"), None)
}

fn greater(call: &Call) -> Result<Value> {
    let GreaterFields { got: f64_(got), limit: f64_(limit) } = call.read()?;
    expect(call, got > limit, || format!("expected more than `{limit}`, got `{got}`"), None)
}

fn between(call: &Call) -> Result<Value> {
    let BetweenFields { got: f64_(got), least: f64_(least), most: f64_(most) } = call.read()?;
    if least > most {
        let message = format!("nothing lies between `{least}` and `{most}`");
        return Err(call.problem_at("least", message, Some("the smaller one comes first".into())));
    }
    expect(call, (least..=most).contains(&got), || format!("expected `{least}` to `{most}`, got `{got}`"), None)
}

fn holds(value: Option<&Value>) -> bool {
    !matches!(value, None | Some(Value::Nil | Value::Bool(false)))
}

fn said(value: Option<Value>, message: Option<String>) -> String {
    message.unwrap_or_else(|| format!("expected anything but false or nil, got `{}`", value.unwrap_or_default()))
}

fn ok(call: &Call) -> Result<Value> {
    let OkFields { value, message } = call.read()?;
    expect(call, holds(value.as_ref()), || said(value, message), None)
}

fn require(call: &Call) -> Result<Value> {
    let RequireFields { value, message } = call.read()?;
    let tests = Tests::of(call)?;
    if holds(value.as_ref()) {
        return Ok(value.unwrap_or_default());
    }
    // A failed expectation in the brackets has already said what is wrong.
    let problem = call.problem(said(value, message.clone()), None);
    let line = |d: &super::super::Diagnostic| d.place.as_ref().map(|p| (p.file.clone(), p.line));
    let last = tests.failures.borrow().last().and_then(line);
    let is_known = message.is_none() && last.is_some() && last == problem.0.first().and_then(line);
    Err(if is_known { Raised(vec![]) } else { problem })
}

fn error(call: &Call) -> Result<Value> {
    let ErrorFields { body, text } = call.read()?;
    let wanted = text.unwrap_or_default();
    match call.script(body, &[]) {
        // Out of time or cancelled: not the error that was expected.
        Err(raised) if call.task().is_cancelled() => Err(raised),
        Err(Raised(diagnostics)) => {
            let said = |text: &str| text.contains(&wanted);
            let holds = diagnostics.iter().any(|d| said(&d.message) || d.hints.iter().any(|h| said(h)));
            let got: Vec<&str> = diagnostics.iter().map(|d| d.message.as_str()).collect();
            expect(call, holds, || format!("expected an error that says `{wanted}`, got `{}`", got.join("; ")), None)
        }
        Ok(value) => expect(call, false, || format!("expected an error, but the function returned `{value}`"), None),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::params::Table;

    fn table(items: Vec<Value>, fields: &[(&str, Value)]) -> Value {
        let fields = fields.iter().map(|(k, v)| ((*k).to_owned(), v.clone())).collect();
        Value::Table(Table { items, fields })
    }

    #[test]
    fn differences_are_found_where_they_are() {
        let n = Value::Number;
        let at = |a: &Value, b: &Value| difference(a, b, String::new()).map(|(at, a, b)| format!("{at}: {a} {b}"));
        let one = table(vec![n(1.0), table(vec![], &[("x", n(2.0))])], &[("y", n(3.0))]);
        assert_eq!(at(&one, &one), None);
        let other = table(vec![n(1.0), table(vec![], &[("x", n(5.0))])], &[("y", n(3.0))]);
        assert_eq!(at(&one, &other).as_deref(), Some("[2].x: 2 5"));
        let more = table(vec![n(1.0), table(vec![], &[("x", n(2.0))])], &[("y", n(3.0)), ("z", n(0.0))]);
        assert_eq!(at(&one, &more).as_deref(), Some("z: nil 0"));
        assert_eq!(at(&more, &one).as_deref(), Some("z: 0 nil"));
        assert_eq!(at(&n(1.0), &Value::Text("1".into())).as_deref(), Some(": 1 \"1\""));
        assert!(at(&n(f64::NAN), &n(f64::NAN)).is_some());
    }
}
