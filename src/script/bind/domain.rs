//! Constraint domains, queues and boxes.

use std::sync::Arc;

use glam::{Vec2, Vec3};

use super::super::call::{Call, Result};
use super::super::registry::{Entry, Getter, Noun};
use super::head::give;
use crate::geometry::OrientedBox;
use crate::groom::{BoxOptions, Curl, Directional, Domain, Gather, Natural, NaturalOptions, Queue, QueueOptions, Wave};
use crate::params::{Handle, Value};

/// How often a custom curve is asked.
const CURVE_SAMPLES: usize = 257;

crate::params! {
    /// Tells whether a point is inside the box.
    pub struct ContainsFields("Box:contains") {
        /// Any point.
        point: Vec3, unit("cm");
    }
}

/// `coif.domain`, `coif.queue`, `coif.box`.
pub fn functions() -> Vec<Entry> {
    vec![
        Entry::table::<BoxOptions>("coif.box", "Box", make_box),
        Entry::table::<Directional>("coif.domain.directional", "Domain", directional),
        Entry::table::<Gather>("coif.domain.gather", "Domain", gather),
        Entry::table::<Wave>("coif.domain.wave", "Domain", wave),
        Entry::table::<Curl>("coif.domain.curl", "Domain", curl),
        Entry::table::<NaturalOptions>("coif.domain.natural", "Domain", natural),
        Entry::table::<QueueOptions>("coif.queue", "Queue", queue),
    ]
}

/// Boxes, domains and queues.
pub fn nouns() -> Vec<Noun> {
    let contains = vec![Entry::positional::<ContainsFields>("Box:contains", "boolean", contains)];
    let getters = vec![
        Getter {
            name: "centre",
            doc: "Its middle.",
            returns: "vector",
            get: |h| h.get::<OrientedBox>().map_or(Value::Nil, |b| Value::Vector(b.centre)),
        },
        Getter {
            name: "size",
            doc: "Its edge lengths.",
            returns: "vector",
            get: |h| h.get::<OrientedBox>().map_or(Value::Nil, |b| Value::Vector(b.half * 2.0)),
        },
    ];
    let box_text = |h: &Handle| {
        h.get::<OrientedBox>().map_or_else(String::new, |b| format!("box of {} about {}", b.half * 2.0, b.centre))
    };
    let domain_text = |h: &Handle| {
        h.get::<Domain>().map_or_else(String::new, |d| match d.name() {
            Some(name) => format!("{} domain `{name}`", d.kind()),
            None => format!("{} domain", d.kind()),
        })
    };
    let queue_text = |h: &Handle| {
        h.get::<Queue>().map_or_else(String::new, |q| {
            format!("queue of {} domains in {} stages", q.domains().len(), q.stages().len())
        })
    };
    vec![
        Noun::of::<OrientedBox>("A box, whose axes may be turned.", contains, getters, box_text),
        Noun::of::<Domain>("A styling constraint with a region where it acts.", vec![], vec![], domain_text),
        Noun::of::<Queue>(
            "Domains in stages; a stage acts when the one before it has let go.",
            vec![],
            vec![],
            queue_text,
        ),
    ]
}

fn make_box(call: &Call) -> Result<Value> {
    let options: BoxOptions = call.read()?;
    options.build().map(give).map_err(|(message, hint)| call.problem(message, Some(hint)))
}

fn contains(call: &Call) -> Result<Value> {
    let (this, fields) = (call.this::<OrientedBox>()?, call.read::<ContainsFields>()?);
    Ok(Value::Bool(this.contains(fields.point)))
}

fn directional(call: &Call) -> Result<Value> {
    Ok(give(Domain::Directional(call.read()?)))
}

fn gather(call: &Call) -> Result<Value> {
    let gather: Gather = call.read()?;
    if gather.scatter != 0.0 && gather.direction.is_none() {
        let hint = "give the `direction` in which hair leaves the core".to_owned();
        return Err(call.problem_at("scatter", "`scatter` needs `direction`", Some(hint)));
    }
    Ok(give(Domain::Gather(gather)))
}

fn wave(call: &Call) -> Result<Value> {
    let wave: Wave = call.read()?;
    Ok(give(Domain::Natural(Arc::new(Natural::from(&wave)))))
}

fn curl(call: &Call) -> Result<Value> {
    let curl: Curl = call.read()?;
    Ok(give(Domain::Natural(Arc::new(Natural::from(&curl)))))
}

fn natural(call: &Call) -> Result<Value> {
    let options: NaturalOptions = call.read()?;
    let ask = |i: usize| {
        let u = i as f64 / (CURVE_SAMPLES - 1) as f64;
        let value = call.script(options.curve, &[Value::Number(u)])?;
        let two = match &value {
            Value::Table(t) => match t.items.as_slice() {
                [Value::Number(n), Value::Number(b)] => Some((*n, *b)),
                _ => None,
            },
            // One number waves in a plane.
            Value::Number(n) => Some((*n, 0.0)),
            _ => None,
        };
        match two {
            Some((n, b)) if n.is_finite() && b.is_finite() => Ok(Vec2::new(n as f32, b as f32)),
            _ => {
                let hint = "it returns two offsets in cm: away from the head, and to the side".to_owned();
                Err(call.problem_at("curve", format!("`curve` returned `{value}` for {u}"), Some(hint)))
            }
        }
    };
    let offsets: Vec<Vec2> = (0..CURVE_SAMPLES).map(ask).collect::<Result<_>>()?;
    Ok(give(Domain::Natural(Arc::new(Natural::custom(&options, offsets.into())))))
}

fn queue(call: &Call) -> Result<Value> {
    let options: QueueOptions = call.read()?;
    Queue::new(options.domains).map(give).map_err(|e| call.problem(e.to_string(), None))
}
