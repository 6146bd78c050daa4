//! Locks that move: paths, posed states, and what comes out.

use std::sync::Arc;

use glam::{Affine3A, Vec2, Vec3};

use super::super::call::{Call, Result};
use super::super::registry::{Entry, Getter, Noun};
use super::super::session::Raised;
use super::clip::MovingLocks;
use super::head::give;
use super::posed::{Posed, posed};
use super::tuft::{head_of, points_of};
use crate::animate::{AnimateError, PathOptions, Rig, animate_all, carried};
use crate::dynamics::{Body, Hair, HairOptions, SimulateOptions, simulate};
use crate::geometry::{Clip, Mesh, Root, Strands};
use crate::head::HeadMotion;
use crate::math::Digest;
use crate::params::{FieldType, Function, Kind, Object, Reader, Value};
use crate::task::{Warned, Warning};

/// Locks of one call that are warned of one by one.
const TOLD: usize = 3;

impl Object for PathOptions {
    const NAME: &'static str = "Path";
}

/// Which vertex of a lock a handle is.
#[derive(Clone, Copy, Debug)]
pub enum At {
    /// The tip.
    Tip,
    /// On the side that faces away from the head, so far from the root (0) to the tip (1).
    Along(f32),
    /// The vertex nearest to this place.
    Place(Vec3),
}

impl FieldType for At {
    fn kind() -> Kind {
        Kind::OneOf(vec![Kind::Choice(&["tip"]), Kind::Number, Kind::Point])
    }
    fn read(value: &Value, reader: &mut Reader) -> Option<Self> {
        match value {
            Value::Text(_) => reader.choice(value, &["tip"]).map(|_| Self::Tip),
            Value::Number(n) if (0.0..=1.0).contains(n) => Some(Self::Along(*n as f32)),
            Value::Number(n) => reader.problem(format!("`{n}` is not between 0 (root) and 1 (tip)"), None),
            Value::Vector(_) | Value::Table(_) => Vec3::read(value, reader).map(Self::Place),
            other => reader.wrong_type("\"tip\", a number from 0 to 1, or a place", other),
        }
    }
    fn show(&self) -> String {
        match self {
            Self::Tip => "\"tip\"".into(),
            Self::Along(t) => t.to_string(),
            Self::Place(p) => p.show(),
        }
    }
}

/// Which vertices of a lock stay.
#[derive(Clone, Copy, Debug)]
pub enum Held {
    /// Those at the root.
    Root,
    /// Those no farther from the root (0) to the tip (1).
    Along(f32),
    /// Those for which a function of the script says so.
    Chosen(Function),
}

impl FieldType for Held {
    fn kind() -> Kind {
        Kind::OneOf(vec![Kind::Choice(&["root"]), Kind::Number, Kind::Function])
    }
    fn read(value: &Value, reader: &mut Reader) -> Option<Self> {
        match value {
            Value::Text(_) => reader.choice(value, &["root"]).map(|_| Self::Root),
            Value::Number(n) if (0.0..1.0).contains(n) => Some(Self::Along(*n as f32)),
            Value::Number(n) => reader.problem(format!("`{n}` is not from 0 (root) to less than 1 (tip)"), None),
            Value::Function(_) => Function::read(value, reader).map(Self::Chosen),
            other => reader.wrong_type("\"root\", a number from 0 to 1, or a function", other),
        }
    }
    fn show(&self) -> String {
        match self {
            Self::Root => "\"root\"".into(),
            Self::Along(t) => t.to_string(),
            Self::Chosen(_) => "function".into(),
        }
    }
}

crate::params! {
    /// A vertex of a lock that follows a path.
    pub struct HandleOptions("coif.handle") {
        /// Which vertex: "tip", a number from 0 (root) to 1 (tip) on the side away from the head, or the one nearest to a
        /// place.
        at: At = At::Tip;
        /// The way it goes.
        path: Arc<PathOptions>;
        /// Only on the lock of this number; on all of them when left out.
        lock: Option<usize>, range(1.0, 1e6);
    }
}

crate::params! {
    /// How the handles of a lock trail behind a head that moves: as hair along the lock's middle does.
    pub struct Lag("coif.lag") {
        /// How well the hair keeps its shape, as in `strands:simulate`: more is stiffer and swings faster.
        hold: f32 = 8.0, unit("cm"), range(0.0, 1000.0);
        /// How strongly the air brakes it: more dies sooner.
        drag: f32 = 3.0, unit("1/s"), range(0.0, 1000.0);
        /// How much of the lag is shown.
        amount: f32 = 1.0, range(0.0, 2.0);
    }
}

crate::params! {
    /// Locks that move: posed states, and paths for their handles. The whole surface follows in the way the states show.
    pub struct AnimateOptions("coif.animate") {
        /// The rest, and the same locks posed in other ways: all tufts with the same number of locks, or all pieces of one
        /// mesh. The rings and sides of tufts are made the same; the rest's look counts.
        states: Vec<Value>, takes("(Tufts|Piece)[]");
        /// The way of the tip of every lock; the same as one handle with `at = "tip"`.
        path: Option<Arc<PathOptions>>;
        /// Vertices that follow paths.
        handles: Vec<HandleOptions> = vec![];
        /// What stays: "root", everything up to a part of the way from root (0) to tip (1), or a function that is asked about
        /// every vertex: its place, and how far along it is.
        held: Held = Held::Root, takes("\"root\"|number|fun(place: vector, along: number): boolean");
        /// Frames in a second; that of `motion` when left out, or 24.
        rate: Option<f32>, unit("1/s"), range(1.0, 240.0);
        /// The first frame follows the last; paths must then end where they began, by `closed` or `back`.
        r#loop: bool = false;
        /// Each lock begins so much later than the one before it.
        stagger: f32 = 0.0, unit("s"), range(-100.0, 100.0);
        /// What the head does meanwhile: the locks are carried along.
        motion: Option<Arc<HeadMotion>>;
        /// Lets the handles trail behind the head's motion, as hair does: `{}`, or how.
        lag: Option<Lag>;
    }
}

/// `coif.path`, `coif.animate`.
pub fn functions() -> Vec<Entry> {
    vec![
        Entry::table::<PathOptions>("coif.path", "Path", path),
        Entry::table::<AnimateOptions>("coif.animate", "LocksClip", animate),
    ]
}

/// A path.
pub fn noun() -> Noun {
    let getters = vec![Getter {
        name: "frames",
        doc: "How many frames it takes.",
        returns: "number",
        get: |h| h.get::<PathOptions>().map_or(Value::Nil, |p| Value::Number(p.frames as f64)),
    }];
    Noun::of::<PathOptions>("The way of a handle; made by `coif.path`.", vec![], getters, |h| {
        h.get::<PathOptions>().map_or_else(String::new, |p| format!("path of {} frames", p.frames))
    })
}

fn path(call: &Call) -> Result<Value> {
    let mut table = call.table().clone();
    if let Some(Value::Table(points)) = table.fields.get_mut("points") {
        // Places over the head need one; plain points do not.
        if points.items.iter().any(|i| matches!(i, Value::Table(t) if !t.fields.is_empty())) {
            let head = head_of(call, None)?;
            points_of(call, &head, "points", &mut points.items)?;
        }
    }
    let options: PathOptions = crate::params::read(&table).map_err(|problems| call.problems(problems))?;
    let given: Vec<&str> = [
        ("points", options.points.is_some()),
        ("offsets", options.offsets.is_some()),
        ("states", options.states.is_some()),
    ]
    .into_iter()
    .filter_map(|(name, given)| given.then_some(name))
    .collect();
    match given.as_slice() {
        [_] => {}
        [] => {
            let hint = "give `points`, `offsets` from where the handle rests, or numbers of `states`".to_owned();
            return Err(call.problem("a path without points", Some(hint)));
        }
        [first, second, ..] => {
            let message = format!("`{first}` and `{second}` exclude one another");
            return Err(call.problem_at(second, message, Some("leave one of them out".into())));
        }
    }
    // What can be told now is told here, where it is written.
    let stand_in: Vec<Vec3> = match (&options.points, &options.offsets, &options.states) {
        (Some(points), ..) | (None, Some(points), _) => points.clone(),
        (None, None, states) => {
            let states = states.iter().flatten();
            if let Some((i, _)) = states.clone().enumerate().find(|(_, s)| **s == 0) {
                let hint = Some("states are counted from 1, the rest".to_owned());
                return Err(call.problem_at(&format!("states[{}]", i + 1), "there is no state 0", hint));
            }
            states.map(|&s| Vec3::X * s as f32).collect()
        }
    };
    options.sample(&stand_in, false).map_err(|e| path_error(call, given[0], &e))?;
    Ok(give(options))
}

/// An error of a path, about the field that it comes from.
fn path_error(call: &Call, points: &str, error: &AnimateError) -> Raised {
    let field = match error {
        AnimateError::PathPoints { .. } => points.to_owned(),
        AnimateError::PathPoint { number, .. } => format!("{points}[{number}]"),
        AnimateError::TimeCount { .. } => "times".to_owned(),
        AnimateError::TimeOrder { number, .. } => format!("times[{number}]"),
        _ => String::new(),
    };
    call.problem_at(&field, error.to_string(), error.hint())
}

/// A lock with the vertices that are fixed.
struct Job {
    rest: Mesh,
    states: Vec<Vec<Vec3>>,
    held: Vec<u32>,
    /// A vertex, its path, and the field that gave it.
    handles: Vec<(u32, Arc<PathOptions>, String)>,
}

fn animate(call: &Call) -> Result<Value> {
    let options: AnimateOptions = call.read()?;
    let posed = posed(call, &options.states)?;
    let time = Timing::new(call, &options)?;
    let jobs = jobs(call, &options, &posed)?;
    let mut key = Digest::new("animate 2");
    key.key(posed.rest.head().key());
    key.data(&(time.rate, options.r#loop, options.stagger, &options.lag));
    for frame in options.motion.iter().flat_map(|m| &m.clip.frames) {
        key.data(&**frame);
    }
    for job in &jobs {
        job.rest.digest(&mut key);
        job.states.iter().for_each(|s| _ = key.vectors(s));
        key.numbers(&job.held);
        job.handles.iter().for_each(|(vertex, path, _)| _ = key.data(&(vertex, path)));
    }
    let surface = call.memo(&key, || frames(call, &options, &time, &posed, &jobs))?;
    let (motion, surface) = match (&options.motion, &options.lag) {
        // The lag is the head's own: what it does is in the frames.
        (Some(motion), Some(_)) => (Some(Arc::clone(motion)), carried(&surface, &motion.clip)),
        (Some(motion), None) => {
            let mut whole = surface.as_ref().clone();
            whole.looped &= motion.clip.looped;
            (Some(Arc::clone(motion)), carried(&whole, &motion.clip))
        }
        (None, _) => (None, surface.as_ref().clone()),
    };
    Ok(give(MovingLocks { rest: posed.rest, surface, motion, source: call.source() }))
}

/// How many frames, how fast, from what.
struct Timing {
    rate: f32,
    /// The frames of the head's motion.
    of_motion: Option<usize>,
}

impl Timing {
    fn new(call: &Call, options: &AnimateOptions) -> Result<Self> {
        let rate = match (options.rate, &options.motion) {
            (Some(own), Some(motion)) if own != motion.clip.rate => {
                let message = format!("`rate` is {own}, the motion of the head has {}", motion.clip.rate);
                return Err(call.problem_at("rate", message, Some("leave it out".into())));
            }
            (_, Some(motion)) => motion.clip.rate,
            (own, None) => own.unwrap_or(24.0),
        };
        match (&options.motion, &options.lag) {
            (None, Some(_)) => {
                let hint = "give the head's motion: `motion = head:motion { ... }`".to_owned();
                return Err(call.problem_at("lag", "there is nothing to lag behind", Some(hint)));
            }
            (Some(motion), _) if options.r#loop && !motion.clip.looped => {
                let hint = "make it with `loop = true`".to_owned();
                return Err(call.problem_at("motion", "the motion of the head does not loop", Some(hint)));
            }
            _ => {}
        }
        let still = options.path.is_none() && options.handles.is_empty();
        if still && options.lag.is_none() {
            let hint = "give the tips a `path`, as in `path = coif.path { states = { 1, 2, 1, 3 }, closed = true }`";
            return Err(call.problem("nothing moves", Some(hint.into())));
        }
        Ok(Self { rate, of_motion: options.motion.as_ref().map(|m| m.clip.count()) })
    }
}

/// Every lock with what is fixed on it.
fn jobs(call: &Call, options: &AnimateOptions, posed: &Posed) -> Result<Vec<Job>> {
    let count = posed.locks.len();
    if let Some((i, lock)) =
        options.handles.iter().enumerate().find_map(|(i, h)| Some((i, h.lock.filter(|&l| l > count)?)))
    {
        let hint = Some(if count == 1 { "there is 1".to_owned() } else { format!("there are {count}") });
        return Err(call.problem_at(&format!("handles[{}].lock", i + 1), format!("there is no lock `{lock}`"), hint));
    }
    let mut jobs = Vec::with_capacity(count);
    for (number, lock) in posed.locks.iter().enumerate() {
        let rest = posed.mesh_of(lock);
        let held = match options.held {
            Held::Root => posed.up_to(call, lock, 0.0)?,
            Held::Along(t) => posed.up_to(call, lock, t)?,
            Held::Chosen(test) => {
                let mut held = vec![];
                for (v, p) in rest.positions.iter().enumerate() {
                    let along = posed.along(lock, v as u32).map_or(Value::Nil, |t| Value::Number(f64::from(t)));
                    match call.script(test, &[Value::Vector(*p), along])? {
                        Value::Bool(true) => held.push(v as u32),
                        Value::Bool(false) => {}
                        other => {
                            let message = format!("the function returned {} `{other}`", other.type_name());
                            let hint = "it must return true or false, as in `function(place) return place.y > 0 end`";
                            return Err(call.problem_at("held", message, Some(hint.into())));
                        }
                    }
                }
                held
            }
        };
        let mut handles = vec![];
        // Locks that only trail behind the head are led by their tips.
        let still = options.handles.is_empty() && options.path.is_none();
        let rests = still.then(|| Arc::new(resting(posed.frames_at_rest(options))));
        for path in options.path.iter().chain(&rests) {
            handles.push((posed.handle(call, "path", lock, At::Tip)?, Arc::clone(path), "path".to_owned()));
        }
        for (i, handle) in options.handles.iter().enumerate() {
            if handle.lock.is_none_or(|l| l == number + 1) {
                let field = format!("handles[{}]", i + 1);
                let vertex = posed.handle(call, &format!("{field}.at"), lock, handle.at)?;
                handles.push((vertex, Arc::clone(&handle.path), format!("{field}.path")));
            }
        }
        for (_, path, field) in &handles {
            if options.r#loop && !path.returns() {
                let hint = "make it with `closed = true`, or with `back = true` to come back the same way".to_owned();
                return Err(call.problem_at(field, "a loop wants a path that ends where it began", Some(hint)));
            }
            if count > 1 && path.points.is_some() {
                let hint = "give `offsets` from where each rests, numbers of `states`, or a handle with `lock = 1`";
                let all = options.handles.iter().all(|h| h.lock.is_none()) || field == "path";
                if all {
                    let message = format!("the tips of {count} locks cannot all be in one place");
                    return Err(call.problem_at(field, message, Some(hint.into())));
                }
            }
        }
        jobs.push(Job { states: posed.states_of(lock), rest, held, handles });
    }
    Ok(jobs)
}

/// A path that stays where it is, as long as a motion.
fn resting(frames: usize) -> PathOptions {
    PathOptions {
        points: None,
        offsets: Some(vec![Vec3::ZERO; 2]),
        states: None,
        frames,
        curve: crate::animate::PathCurve::Line,
        ease: crate::geometry::Ease::Linear,
        times: None,
        closed: true,
        back: false,
    }
}

/// The frames of all locks, as the head sees them.
fn frames(
    call: &Call,
    options: &AnimateOptions,
    time: &Timing,
    posed: &Posed,
    jobs: &[Job],
) -> Result<Warned<Clip<Vec<Vec3>>>> {
    let mut warnings = vec![];
    let shift = |lock: usize| (lock as f32 * options.stagger * time.rate).round() as i64;
    let latest = (0..jobs.len()).map(shift).max().unwrap_or(0).max(0);
    let first = (0..jobs.len()).map(shift).min().unwrap_or(0).min(0);
    let mut rigs = vec![];
    let mut which = vec![];
    for (number, job) in jobs.iter().enumerate() {
        call.task().check().map_err(|e| call.problem(e.to_string(), None))?;
        let states: Vec<&[Vec3]> = job.states.iter().map(Vec::as_slice).collect();
        let vertices: Vec<u32> = job.handles.iter().map(|h| h.0).collect();
        let rig = Rig::new(&job.rest, &states, &job.held, &vertices);
        let rig = rig.map_err(|e| animate_error(call, posed, number, &job.handles, &e))?;
        warnings.extend(rig.warnings.into_iter().map(|w| posed.about(number, w)));
        let rig = rig.value;
        if job.handles.is_empty() {
            continue;
        }
        let trail = match (&options.motion, &options.lag) {
            (Some(motion), Some(lag)) => Some(Trail::new(call, posed, number, motion, lag, options.r#loop)?),
            _ => None,
        };
        let mut paths = vec![];
        for (h, (_, path, field)) in job.handles.iter().enumerate() {
            let rest = rig.handle_at(h, 0).unwrap_or_default();
            let points = match (&path.points, &path.offsets, &path.states) {
                (Some(points), ..) => points.clone(),
                (None, Some(offsets), _) => offsets.iter().map(|o| rest + *o).collect(),
                (None, None, states) => {
                    let mut points = vec![];
                    for &state in states.iter().flatten() {
                        let Some(at) = rig.handle_at(h, state - 1) else {
                            let hint = Some(format!("there are {}, the rest is 1", rig.states()));
                            return Err(call.problem_at(field, format!("there is no state `{state}`"), hint));
                        };
                        points.push(at);
                    }
                    points
                }
            };
            let way = path.sample(&points, options.r#loop).map_err(|e| path_error(call, field, &e))?;
            let own = shift(number);
            let way: Vec<Vec3> = if options.r#loop {
                let n = way.len() as i64;
                (0..n).map(|f| way[(f - own).rem_euclid(n) as usize]).collect()
            } else {
                let n = way.len() as i64;
                (0..n + latest - first).map(|f| way[(f - (own - first)).clamp(0, n - 1) as usize]).collect()
            };
            if let Some(of_motion) = time.of_motion.filter(|&n| n != way.len()) {
                let message = format!("the path has {} frames, the motion of the head {of_motion}", way.len());
                return Err(call.problem_at(field, message, Some(format!("give it `frames = {of_motion}`"))));
            }
            paths.push(match &trail {
                Some(trail) => trail.added(&way, rest),
                None => way,
            });
        }
        rigs.push((rig, paths));
        which.push(number);
    }
    let made = animate_all(&rigs, time.rate, options.r#loop, call.task());
    let made = made.map_err(|(i, e)| animate_error(call, posed, which[i], &jobs[which[i]].handles, &e))?;
    let count = made.first().map_or(0, |a| a.value.clip.count());
    for (animation, &number) in made.iter().zip(&which) {
        if animation.value.clip.count() != count {
            let (own, first) = (animation.value.clip.count(), which[0] + 1);
            let message = format!("the paths of lock {} have {own} frames, those of lock {first} {count}", number + 1);
            return Err(call.problem(message, Some("give all paths the same `frames`".into())));
        }
        warnings.extend(animation.warnings.iter().map(|w| posed.about(number, w.clone())));
    }
    let more = warnings.len().saturating_sub(TOLD);
    warnings.truncate(TOLD);
    if more > 0 {
        warnings
            .push(Warning::new(format!("{more} more warning{} about other locks", if more == 1 { "" } else { "s" })));
    }
    let frame = |f: usize| {
        let mut all = posed.states[0].clone();
        for (animation, &number) in made.iter().zip(&which) {
            let range = &posed.locks[number].vertices;
            all[range.start as usize..range.end as usize].copy_from_slice(&animation.value.clip.frames[f]);
        }
        Arc::new(all)
    };
    let value = Clip { rate: time.rate, looped: options.r#loop, frames: (0..count).map(frame).collect() };
    Ok(Warned { value, warnings })
}

/// How a strand along the middle of a lock trails behind the head.
struct Trail {
    /// Its nodes at rest.
    rest: Vec<Vec3>,
    /// Per frame how far each is from there, as the head sees it.
    frames: Vec<Vec<Vec3>>,
}

/// Nodes of the strand that shows how a lock trails.
const NODES: usize = 24;

impl Trail {
    fn new(call: &Call, posed: &Posed, number: usize, motion: &HeadMotion, lag: &Lag, looped: bool) -> Result<Self> {
        let head = posed.rest.head();
        let rest = posed.middle(number, NODES);
        let normal = (rest[1] - rest[0]).normalize_or(Vec3::Y);
        let root = Root { id: number as u64, position: rest[0], normal, uv: Vec2::ZERO, triangle: 0 };
        let mut strands = Strands::new();
        strands.push(root, 0, rest.iter().copied());
        let options = HairOptions { hold: lag.hold, drag: Some(lag.drag), ..HairOptions::default() };
        let skin = super::dynamics::skin(call, head)?;
        let body = Some(Body { solid: &head.solid, skin: &skin });
        let hair = Hair { strands: &strands, options: &options, pinned: &[], body };
        // Posed by hand, it is at rest as it is.
        let how = SimulateOptions { duration: None, rate: None, balanced: true, r#loop: Some(looped) };
        let made = simulate(&hair, &how, Some(&motion.clip), call.task())
            .map_err(|e| call.problem_at("lag", e.to_string(), e.hint()))?;
        let seen = |f: usize| {
            let back = motion.clip.at(f).map_or(Affine3A::IDENTITY, |t| t.inverse());
            let now = made.value.at(f).map_or(&[][..], |s| &s.points);
            now.iter().zip(&rest).map(|(p, rest)| (back.transform_point3(*p) - *rest) * lag.amount).collect()
        };
        Ok(Self { frames: (0..motion.clip.count()).map(seen).collect(), rest })
    }

    /// A path with what the strand does near the place where the handle rests.
    fn added(&self, way: &[Vec3], rest: Vec3) -> Vec<Vec3> {
        let near = |a: &usize, b: &usize| {
            self.rest[*a].distance_squared(rest).total_cmp(&self.rest[*b].distance_squared(rest))
        };
        let node = (0..self.rest.len()).min_by(near).unwrap_or(0);
        let by = |f: usize| self.frames.get(f).and_then(|o| o.get(node)).copied().unwrap_or_default();
        way.iter().enumerate().map(|(f, p)| *p + by(f)).collect()
    }
}

/// An error of the method, about the field that it comes from.
fn animate_error(
    call: &Call,
    posed: &Posed,
    number: usize,
    handles: &[(u32, Arc<PathOptions>, String)],
    error: &AnimateError,
) -> Raised {
    let handle = |n: usize| handles.get(n - 1).map_or(String::new(), |h| h.2.clone());
    let field = match error {
        AnimateError::NoStates | AnimateError::TooManyStates { .. } => "states".to_owned(),
        AnimateError::VertexCount { state, .. }
        | AnimateError::Topology { state, .. }
        | AnimateError::NotFinite { state, .. }
        | AnimateError::Degenerate { state, .. } => format!("states[{state}]"),
        AnimateError::HeldHandle { handle: n, .. } | AnimateError::Target { handle: n, .. } => handle(*n),
        AnimateError::RepeatedHandle { second, .. } => handle(*second),
        AnimateError::PathFrames { handle: n, .. } => handle(*n),
        AnimateError::Loose { .. } => "held".to_owned(),
        _ => String::new(),
    };
    let lock = if posed.locks.len() > 1 { format!("lock {}: ", number + 1) } else { String::new() };
    call.problem_at(&field, format!("{lock}{error}"), error.hint())
}
