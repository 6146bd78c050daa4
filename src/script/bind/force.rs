//! Force objects: what moves hair, where and when.

use std::sync::Arc;

use glam::Vec3;

use super::super::call::{Call, Result};
use super::super::registry::{Entry, Noun};
use super::head::give;
use crate::dynamics::{
    AttractorOptions, Field, Force, GravityOptions, RepellerOptions, VortexOptions, WindOptions, Zone,
};
use crate::geometry::OrientedBox;
use crate::params::{FieldType, Function, Handle, Kind, Object, Reader, Value};

/// How often a function of the time is asked in a second.
const ASKED: usize = 24;
/// For how long it is asked, seconds.
const MINUTE: usize = 60;

crate::params! {
    /// A ball: a part of space for a force to act in, or to pin hair in.
    pub struct BallOptions("coif.ball") {
        /// Its middle.
        centre: Vec3, unit("cm");
        /// Its radius.
        radius: f32, unit("cm"), range(0.01, 1000.0);
    }
}

/// A ball.
#[derive(Clone, Copy, Debug)]
pub struct Ball {
    centre: Vec3,
    radius: f32,
}

impl Object for Ball {
    const NAME: &'static str = "Ball";
}

crate::params! {
    /// Where and when a force acts.
    pub struct ForceExtras("coif.force") {
        /// The box or ball that it acts in; everywhere when left out.
        zone: Option<Place>;
        /// The way inside the zone's border over which it fades out; 0 ends at the border.
        edge: f32 = 0.0, unit("cm"), range(0.0, 1000.0);
        /// Factors on the strength: pairs of a time in seconds and a factor, or a function from the time to the factor,
        /// asked 24 times a second for the first minute. In `settle` it has no say.
        over_time: Option<OverTime>, takes("{ number, number }[] | fun(time: number): number");
        /// True when it moves with the head.
        follows: bool = false;
        /// What messages and the debug view call it.
        name: Option<String>;
    }
}

/// A part of space, given as a `Box` or a `Ball`.
#[derive(Clone, Debug)]
pub struct Place(pub Zone);

impl FieldType for Place {
    fn kind() -> Kind {
        Kind::OneOf(vec![Kind::Object(OrientedBox::NAME), Kind::Object(Ball::NAME)])
    }
    fn read(value: &Value, reader: &mut Reader) -> Option<Self> {
        if let Value::Handle(h) = value {
            if let Some(b) = h.get::<OrientedBox>() {
                return Some(Self(Zone::Box(*b)));
            }
            if let Some(b) = h.get::<Ball>() {
                return Some(Self(Zone::Ball { centre: b.centre, radius: b.radius }));
            }
        }
        reader.wrong_type("a Box or a Ball", value)
    }
}

/// Factors over time, as a script gives them.
#[derive(Clone, Debug)]
pub enum OverTime {
    /// At some times.
    Pairs(Vec<(f32, f32)>),
    /// By a function.
    Function(Function),
}

impl FieldType for OverTime {
    fn kind() -> Kind {
        Kind::OneOf(vec![Kind::List(Box::new(Kind::List(Box::new(Kind::Number)))), Kind::Function])
    }
    fn read(value: &Value, reader: &mut Reader) -> Option<Self> {
        if let Value::Function(n) = value {
            return Some(Self::Function(Function(*n)));
        }
        let pairs: Vec<Vec<f32>> = Vec::read(value, reader)?;
        let mut out: Vec<(f32, f32)> = vec![];
        for (i, pair) in pairs.iter().enumerate() {
            let &[time, factor] = pair.as_slice() else {
                let hint = Some("write { time, factor }, as in { { 0, 1 }, { 2, 0 } }".into());
                let message = format!("expected a time and a factor, got {} numbers", pair.len());
                return reader.inside(format!("[{}]", i + 1), |r| r.problem(message, hint));
            };
            if let Some(&(before, _)) = out.last().filter(|(before, _)| *before >= time) {
                let hint = Some("give the times in their order".into());
                let message = format!("the time `{time}` is not after `{before}`");
                return reader.inside(format!("[{}]", i + 1), |r| r.problem(message, hint));
            }
            out.push((time, factor));
        }
        Some(Self::Pairs(out))
    }
}

/// `coif.force`, `coif.ball`.
pub fn functions() -> Vec<Entry> {
    vec![
        Entry::table::<BallOptions>("coif.ball", "Ball", ball),
        Entry::both::<GravityOptions, ForceExtras>("coif.force.gravity", "Force", gravity),
        Entry::both::<WindOptions, ForceExtras>("coif.force.wind", "Force", wind),
        Entry::both::<AttractorOptions, ForceExtras>("coif.force.attractor", "Force", attractor),
        Entry::both::<RepellerOptions, ForceExtras>("coif.force.repeller", "Force", repeller),
        Entry::both::<VortexOptions, ForceExtras>("coif.force.vortex", "Force", vortex),
    ]
}

/// Forces and balls.
pub fn nouns() -> Vec<Noun> {
    let force = |h: &Handle| {
        h.get::<Force>().map_or_else(String::new, |f| match &f.name {
            Some(name) => format!("{} `{name}` of {} cm/s^2", f.kind(), f.strength()),
            None => format!("{} of {} cm/s^2", f.kind(), f.strength()),
        })
    };
    let ball = |h: &Handle| {
        h.get::<Ball>().map_or_else(String::new, |b| format!("ball of {} cm about {}", b.radius, b.centre))
    };
    vec![
        Noun::of::<Force>("What moves hair in `settle` and `simulate`.", vec![], vec![], force),
        Noun::of::<Ball>("A part of space.", vec![], vec![], ball),
    ]
}

fn ball(call: &Call) -> Result<Value> {
    let BallOptions { centre, radius } = call.read()?;
    Ok(give(Ball { centre, radius }))
}

fn gravity(call: &Call) -> Result<Value> {
    let (field, extras) = call.read_both()?;
    force(call, Field::Gravity(field), extras)
}

fn wind(call: &Call) -> Result<Value> {
    let (mut field, extras): (WindOptions, ForceExtras) = call.read_both()?;
    field.seed = call.seed(field.seed);
    force(call, Field::Wind(field), extras)
}

fn attractor(call: &Call) -> Result<Value> {
    let (field, extras) = call.read_both()?;
    force(call, Field::Attractor(field), extras)
}

fn repeller(call: &Call) -> Result<Value> {
    let (field, extras) = call.read_both()?;
    force(call, Field::Repeller(field), extras)
}

fn vortex(call: &Call) -> Result<Value> {
    let (field, extras) = call.read_both()?;
    force(call, Field::Vortex(field), extras)
}

fn force(call: &Call, field: Field, extras: ForceExtras) -> Result<Value> {
    let over_time: Arc<[(f32, f32)]> = match extras.over_time {
        None => Arc::new([]),
        Some(OverTime::Pairs(pairs)) => pairs.into(),
        Some(OverTime::Function(function)) => {
            let ask = |i: usize| {
                let time = i as f32 / ASKED as f32;
                match call.script(function, &[Value::Number(i as f64 / ASKED as f64)])? {
                    Value::Number(n) if n.is_finite() && (n as f32).is_finite() => Ok((time, n as f32)),
                    other => {
                        let message = format!("`over_time` returned `{other}` for {time} s");
                        let hint = "it returns the factor on the strength, as in `function(time) return 1 - time end`";
                        Err(call.problem_at("over_time", message, Some(hint.into())))
                    }
                }
            };
            (0..=ASKED * MINUTE).map(ask).collect::<Result<Vec<_>>>()?.into()
        }
    };
    let zone = extras.zone.map(|p| p.0);
    if zone.is_none() && extras.edge > 0.0 {
        let hint = "give the `zone` whose border it fades at".to_owned();
        return Err(call.problem_at("edge", "`edge` needs `zone`", Some(hint)));
    }
    let force = Force { field, zone, edge: extras.edge, over_time, follows: extras.follows, name: extras.name };
    force.check(0).map_err(|e| call.problem(e.to_string(), e.hint()))?;
    Ok(give(force))
}
