//! What a test sees of a style: its scene, the parts by name, their figures.

use std::collections::BTreeMap;
use std::rc::Rc;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use glam::{Affine3A, Vec3};
use mlua::Lua;
use rayon::prelude::*;

use super::super::call::{Call, Result};
use super::super::files::tidy;
use super::super::host::{self, Options, SetBy};
use super::super::registry::{Entry, Lookup, Noun};
use super::super::session::{Raised, Session, session};
use super::super::testing::Tests;
use super::super::{Ending, trace};
use super::head::{give, heads};
use crate::geometry::{Bounds, Bvh, Clip, Mesh, Solid, Strands, measure};
use crate::groom::count_inside;
use crate::head::{Head, roots};
use crate::params::{Handle, Object, Table, Value};
use crate::scene::{Body, Locks, Motion, Part, Scene};
use crate::task::Task;
use crate::tuft::{DipOptions, dips};

/// How near to a strand a place of the scalp is covered, cm.
const REACH: f32 = 1.0;

/// Places of the scalp that coverage is measured at.
const PLACES: usize = 2000;

/// Seed of these places: no style's own, whose roots would be the very places.
const PLACES_SEED: u64 = 0x636f_7665_7265_6421;

crate::params! {
    /// Runs a style: `t:run "ponytail.lua" { length = 60 }`. Its path begins at the test's folder. A table of parameters
    /// gives them as `--set` does; `seed` in it is the run's seed.
    pub struct RunFields("Test:run") {
        /// The style's file.
        script: String;
        /// Parameters by name.
        parameters: Option<Value>, takes("table<string, any>");
    }
}

crate::params! {
    /// The same style with these parameters; `scene { length = 60 }` is short for it.
    pub struct WithFields("TestScene:with") {
        /// Parameters by name.
        parameters: Value, takes("table<string, any>");
    }
}

crate::params! {
    /// A scene that the test itself made, with its parts by name.
    pub struct SceneOf("Test:scene") {
        /// What `coif.scene` gave.
        scene: Arc<Scene>;
        /// Of a scene that moves, which frame, from 1; the one that its still pictures show when left out.
        frame: Option<usize>, range(1.0, 1e9);
    }
}

crate::params! {
    /// A scene that moves as it is at a frame; its figures are then those of that frame. Without it they are those of the
    /// frame that still pictures show.
    pub struct AtFields("TestScene:at") {
        /// Which frame, from 1; past the end a loop begins anew, anything else stands still.
        frame: usize, range(1.0, 1e9);
    }
}

crate::params! {
    /// The fraction of the scalp that has hair within some distance: a strand, or a surface of stylised hair.
    pub struct CoverageFields("TestPart:coverage") {
        /// How near hair must come.
        reach: f32 = REACH, unit("cm"), range(0.01, 100.0);
    }
}

/// A style that a test runs, once its scene is asked for.
pub struct Style {
    /// What to run; none for a scene that is there already.
    wanted: Option<Options>,
    /// Which frame, from 0; the one of still pictures when none is chosen.
    frame: Option<usize>,
    tested: Mutex<Option<Arc<Tested>>>,
}

impl Object for Style {
    const NAME: &'static str = "TestScene";
}

/// A scene with the heads it may stand on.
pub struct Tested {
    /// The scene, still, at the frame that is tested.
    pub scene: Arc<Scene>,
    /// As the style made it.
    moving: Arc<Scene>,
    /// What the head's motion has done by then.
    placed: Affine3A,
    heads: Vec<Arc<Head>>,
    /// Per part, and at the end of the whole.
    figures: Vec<OnceLock<Value>>,
}

/// A part of a tested scene.
pub struct TestPart {
    tested: Arc<Tested>,
    index: usize,
}

impl Object for TestPart {
    const NAME: &'static str = "TestPart";
}

const FIGURES: &str = "Figures. Of hair: `strands`, `points`, `guides`, `mean_length`, `longest`, `shortest` (cm), `inside` (strands with a \
     node or a segment inside the head, and tufts that lie too deep in it beyond their buried bases, `bury` left out), \
     `coverage` (the fraction of the scalp within 1 cm of a strand or of a surface of stylised hair), `symmetry` (mean \
     distance in cm from the hair's mirror image to the hair; where there are strands and locks, of those that have the \
     greater). Of a surface: `points`, `triangles`, `tufts`. Of all: `min` and `max`, the corners of the bounding box.";

/// Tested scenes and their parts.
pub fn nouns() -> Vec<Noun> {
    let methods = vec![
        Entry::positional::<WithFields>("TestScene:with", "TestScene", with),
        Entry::positional::<AtFields>("TestScene:at", "TestScene", at),
        Entry::plain("TestScene:stats", FIGURES, "table", scene_stats)
            .about("The figures of all parts together; see `TestPart:stats`.")
            .sealed("the table of figures"),
    ];
    let doc = "The scene of a style, in a test; its parts are reached by name: `scene.hair`, `scene.head`. The style is \
               run when its scene is first asked for.";
    let lookup = Lookup { returns: "TestPart", names: part_names, get: part };
    let style = Noun::of::<Style>(doc, methods, vec![], |h| {
        let script = h.get::<Style>().and_then(|s| s.wanted.as_ref().map(|o| o.script.display().to_string()));
        script.map_or_else(|| "scene".into(), |script| format!("scene of {script}"))
    });
    let methods = vec![
        Entry::plain("TestPart:stats", FIGURES, "table", part_stats).sealed("the table of figures"),
        Entry::positional::<CoverageFields>("TestPart:coverage", "number", coverage),
    ];
    let part = Noun::of::<TestPart>("A part of a tested scene: hair, or a head.", methods, vec![], |h| {
        h.get::<TestPart>().and_then(|p| p.part().map(|p| format!("part {}", p.name))).unwrap_or_default()
    });
    vec![style.with_lookup(lookup), part]
}

/// `Test:run`.
pub fn run(call: &Call) -> Result<Value> {
    let fields: RunFields = call.read()?;
    let script = tidy(&call.session.options.folder().join(&fields.script));
    // Read here too: the test file's own limits hold, and a misspelt path is told at once.
    call.session.access.read(&script).map_err(|e| call.problem_at("script", e.to_string(), e.hint()))?;
    let options = Options { script, set: BTreeMap::new(), set_by: SetBy::Table, ..call.session.options.clone() };
    let options = match &fields.parameters {
        Some(parameters) => set(call, options, parameters)?,
        None => options,
    };
    Ok(give(Style { wanted: Some(options), frame: None, tested: Mutex::default() }))
}

/// `Test:scene`.
pub fn scene_of(call: &Call) -> Result<Value> {
    let fields: SceneOf = call.read()?;
    let frame = fields.frame.map(|f| f - 1);
    let tested = Tested::new(fields.scene, heads(call.session), frame);
    Ok(give(Style { wanted: None, frame, tested: Mutex::new(Some(Arc::new(tested))) }))
}

fn with(call: &Call) -> Result<Value> {
    let (this, fields) = (call.this::<Style>()?, call.read::<WithFields>()?);
    let Some(wanted) = &this.wanted else {
        return Err(call.problem("this scene is not of a style, so it has no parameters", None));
    };
    let wanted = Some(set(call, wanted.clone(), &fields.parameters)?);
    Ok(give(Style { wanted, frame: this.frame, tested: Mutex::default() }))
}

fn at(call: &Call) -> Result<Value> {
    let (this, fields) = (call.this::<Style>()?, call.read::<AtFields>()?);
    let frame = Some(fields.frame - 1);
    let known = this.tested.lock().unwrap_or_else(PoisonError::into_inner).clone();
    let tested = known.map(|t| Arc::new(t.at(fields.frame - 1)));
    Ok(give(Style { wanted: this.wanted.clone(), frame, tested: Mutex::new(tested) }))
}

/// The options with more parameters.
fn set(call: &Call, mut options: Options, parameters: &Value) -> Result<Options> {
    let wrong = |message: String| {
        Err(call.problem_at("parameters", message, Some("as in `t:run \"style.lua\" { length = 60 }`".into())))
    };
    let table = match parameters {
        Value::Table(table) if table.items.is_empty() => table,
        other => return wrong(format!("expected parameters by name, got {} `{other}`", other.type_name())),
    };
    for (name, value) in &table.fields {
        let text = match value {
            Value::Number(n) if name == "seed" => {
                if n.fract() != 0.0 || !(0.0..=9_007_199_254_740_992.0).contains(n) {
                    return wrong(format!("`{n}` is not a seed: a whole number, 0 or more"));
                }
                (options.seed, options.names_seed) = (*n as u64, true);
                continue;
            }
            Value::Number(n) => n.to_string(),
            Value::Bool(b) => b.to_string(),
            Value::Text(t) => t.clone(),
            Value::Vector(v) => format!("{},{},{}", v.x, v.y, v.z),
            Value::Table(t) if !t.items.is_empty() && t.items.iter().all(|i| matches!(i, Value::Number(_))) => {
                t.items.iter().map(ToString::to_string).collect::<Vec<_>>().join(",")
            }
            other => return wrong(format!("`{name}` cannot be {} `{other}`", other.type_name())),
        };
        options.set.insert(name.clone(), text);
    }
    Ok(options)
}

impl Style {
    /// The scene; the style is run the first time.
    fn tested(&self, lua: &Lua) -> mlua::Result<Arc<Tested>> {
        let mut tested = self.tested.lock().unwrap_or_else(PoisonError::into_inner);
        if let (None, Some(wanted)) = (&*tested, &self.wanted) {
            *tested = Some(Arc::new(ran(lua, &*session(lua)?, wanted, self.frame)?));
        }
        tested.clone().ok_or_else(|| mlua::Error::runtime("a scene without a style"))
    }
}

/// Runs a style in a VM and a session of its own.
fn ran(lua: &Lua, outer: &Session, wanted: &Options, frame: Option<usize>) -> mlua::Result<Tested> {
    let inner = Rc::new(Session::new(wanted, outer.access.files(), [], &outer.task.child()));
    let outcome = host::run_session(&inner);
    outer.sources.borrow_mut().extend(outcome.sources);
    outer.log.borrow_mut().extend(outcome.log);
    if let Some(tests) = Tests::in_vm(lua) {
        tests.dependencies.borrow_mut().extend(outcome.dependencies);
    }
    let frames = trace::frames(lua, 0);
    let mut diagnostics = outcome.diagnostics;
    for diagnostic in &mut diagnostics {
        diagnostic.trace.extend_from_slice(&frames);
    }
    match (outcome.ending, outcome.scene) {
        (Ending::Done, Some(scene)) => {
            diagnostics.into_iter().for_each(|d| outer.warn(d));
            Ok(Tested::new(Arc::new(scene), heads(&inner), frame))
        }
        _ => Err(Raised(diagnostics).into()),
    }
}

impl Tested {
    fn new(moving: Arc<Scene>, heads: Vec<Arc<Head>>, frame: Option<usize>) -> Self {
        let frame = frame.unwrap_or(moving.shown.still);
        let placed = moving.parts.iter().find_map(|p| match (&p.body, &p.motion) {
            (Body::Mesh(..), Some(Motion::Rigid(clip))) => clip.at(frame).map(|t| **t),
            _ => None,
        });
        let scene = if moving.timeline().is_some() { Arc::new(moving.at(frame)) } else { Arc::clone(&moving) };
        let figures = vec![OnceLock::new(); scene.parts.len() + 1];
        Self { scene, moving, placed: placed.unwrap_or(Affine3A::IDENTITY), heads, figures }
    }

    /// Some of the parts as seen from the head.
    fn seen(&self, parts: &[Part]) -> Vec<Part> {
        let back = Clip::new(1.0, vec![Arc::new(self.placed.inverse())]);
        let still = |part: &Part| match self.placed == Affine3A::IDENTITY {
            true => part.clone(),
            false => Part { motion: Some(Motion::Rigid(back.clone())), ..part.clone() }.at(0),
        };
        parts.iter().map(still).collect()
    }

    /// The tested scene in a field: what `t:run` gave, or a scene of the test's own.
    ///
    /// # Errors
    /// Another value, or what the style raised.
    pub fn from(call: &Call, value: &Value, path: &str) -> Result<Arc<Self>> {
        if let Value::Handle(handle) = value {
            if let Some(style) = handle.get::<Style>() {
                return style
                    .tested(call.lua())
                    .map_err(|e| Raised::inside(&e).unwrap_or_else(|| call.problem_at(path, e.to_string(), None)));
            }
            if let Some(scene) = handle.get::<Scene>() {
                return Ok(Arc::new(Self::new(scene, heads(call.session), None)));
            }
        }
        let message = format!("expected a scene, got {} `{value}`", value.type_name());
        Err(call.problem_at(path, message, Some("as `t:run \"style.lua\" {}` gives one".into())))
    }

    /// The same scene at another frame, from 0.
    #[must_use]
    pub fn at(&self, frame: usize) -> Self {
        Self::new(Arc::clone(&self.moving), self.heads.clone(), Some(frame))
    }

    /// Heads that stand in the scene; any that its hair can have grown on when none does.
    fn standing(&self) -> Vec<&Arc<Head>> {
        let is_in = |head: &&Arc<Head>| {
            self.moving.parts.iter().any(|p| matches!(&p.body, Body::Mesh(mesh, _) if Arc::ptr_eq(mesh, &head.mesh)))
        };
        let found: Vec<&Arc<Head>> = self.heads.iter().filter(is_in).collect();
        if found.is_empty() { self.heads.iter().collect() } else { found }
    }

    /// Figures of some of the parts; `slot` is where they are kept.
    fn figures(&self, parts: &[Part], slot: usize, task: &Task) -> Value {
        let compute = || figures(parts, &self.seen(parts), &self.standing(), task);
        self.figures.get(slot).map_or_else(compute, |kept| kept.get_or_init(compute).clone())
    }
}

impl TestPart {
    fn part(&self) -> Option<&Part> {
        self.tested.scene.parts.get(self.index)
    }
}

fn strands(parts: &[Part]) -> Vec<&Strands> {
    parts.iter().filter_map(|p| if let Body::Hair(hair) = &p.body { Some(&*hair.strands) } else { None }).collect()
}

fn locks(parts: &[Part]) -> Vec<&Locks> {
    parts.iter().filter_map(|p| if let Body::Locks(locks) = &p.body { Some(locks) } else { None }).collect()
}

/// `seen` are the parts as seen from the head.
fn figures(parts: &[Part], seen: &[Part], heads: &[&Arc<Head>], task: &Task) -> Value {
    let (hair, locks) = (strands(seen), locks(seen));
    let mut bounds = Bounds::EMPTY;
    let (mut points, mut triangles, mut guides, mut tufts) = (0, 0, 0, 0);
    for part in parts {
        match &part.body {
            Body::Mesh(mesh, _) => {
                bounds = bounds.union(mesh.bounds());
                points += mesh.positions.len();
                triangles += mesh.triangles.len();
            }
            Body::Locks(locks) => {
                bounds = bounds.union(locks.mesh.mesh.bounds());
                points += locks.mesh.mesh.positions.len();
                triangles += locks.mesh.mesh.triangles.len();
                tufts += locks.tufts.count();
            }
            Body::Hair(hair) => {
                bounds = bounds.union(hair.strands.bounds());
                points += hair.strands.points.len();
                guides += hair.guides.count();
            }
        }
    }
    let mut fields: BTreeMap<String, Value> = BTreeMap::new();
    let mut put = |name: &str, value: f64| drop(fields.insert(name.to_owned(), Value::Number(value)));
    put("points", points as f64);
    if triangles > 0 {
        put("triangles", triangles as f64);
    }
    if tufts > 0 {
        put("tufts", tufts as f64);
    }
    if !hair.is_empty() {
        let lengths: Vec<f32> = hair.iter().flat_map(|s| (0..s.count()).map(|i| s.length(i))).collect();
        let sum: f64 = lengths.iter().copied().map(f64::from).sum();
        put("strands", lengths.len() as f64);
        put("guides", guides as f64);
        put("mean_length", plain((sum / lengths.len().max(1) as f64) as f32));
        put("longest", plain(lengths.iter().copied().fold(0.0, f32::max)));
        put("shortest", plain(lengths.iter().copied().reduce(f32::min).unwrap_or(0.0)));
    }
    if !hair.is_empty() || !locks.is_empty() {
        let strands: usize = heads.iter().map(|h| within(&h.solid, &hair)).sum();
        let tufts: usize = heads.iter().map(|h| sunk(h, &locks, task)).sum();
        put("inside", (strands + tufts) as f64);
        let surface = surface(&locks);
        let of_locks = surface.as_ref().map_or(0.0, |s| s.mirror_distance());
        put("symmetry", plain(measure::mirror_distance(&hair).max(of_locks)));
        if let Some(fraction) = covered(heads, &hair, surface.as_ref(), REACH, task) {
            put("coverage", fraction);
        }
    }
    if !bounds.is_empty() {
        fields.insert("min".into(), Value::Vector(bounds.min));
        fields.insert("max".into(), Value::Vector(bounds.max));
    }
    Value::Table(Table { fields, ..Table::default() })
}

/// The number that a person would write: 4.51 and not 4.510000228881836.
fn plain(n: f32) -> f64 {
    n.to_string().parse().unwrap_or_else(|_| f64::from(n))
}

fn within(solid: &Solid, hair: &[&Strands]) -> usize {
    hair.iter().map(|s| count_inside(s, solid)).sum()
}

/// How many tufts lie in the head by more than half their thickness beyond their buried bases.
fn sunk(head: &Head, locks: &[&Locks], task: &Task) -> usize {
    let ground = super::tuft::ground(head);
    let count = |locks: &&Locks| {
        let mut found = dips(&locks.tufts, &DipOptions::default(), &ground, task).unwrap_or_default();
        found.dedup_by_key(|dip| dip.tuft);
        found.len()
    };
    locks.iter().map(count).sum()
}

/// All surfaces of stylised hair.
struct Surface {
    places: Vec<Vec3>,
    tree: Bvh,
}

/// The surfaces as one; none without triangles.
fn surface(locks: &[&Locks]) -> Option<Surface> {
    let mut all = Mesh::default();
    for locks in locks {
        let (mesh, first) = (&locks.mesh.mesh, all.positions.len() as u32);
        all.positions.extend_from_slice(&mesh.positions);
        all.triangles.extend(mesh.triangles.iter().map(|t| t.map(|v| v + first)));
    }
    (!all.triangles.is_empty())
        .then(|| Surface { tree: Bvh::new(&all.positions, &all.triangles), places: all.positions })
}

impl Surface {
    /// Mean distance in cm from the mirror images of the corners to the surfaces.
    fn mirror_distance(&self) -> f32 {
        let off: Vec<f32> = self
            .places
            .par_iter()
            .map(|p| {
                let mirrored = Vec3::new(-p.x, p.y, p.z);
                self.tree.closest(mirrored, f32::INFINITY).map_or(0.0, |c| c.position.distance(mirrored))
            })
            .collect();
        let sum: f64 = off.iter().copied().map(f64::from).sum();
        (sum / off.len().max(1) as f64) as f32
    }
}

/// The fraction of the scalp within `reach` cm of hair; `None` without a head.
fn covered(heads: &[&Arc<Head>], hair: &[&Strands], surface: Option<&Surface>, reach: f32, task: &Task) -> Option<f64> {
    let mut places = vec![];
    for head in heads {
        let found = roots(head, &head.scalp(), PLACES, PLACES_SEED, task).ok()?;
        places.extend(found.into_iter().map(|r| r.position));
    }
    let strands = measure::covered(&places, hair, reach);
    let under = |p: Vec3| surface.is_some_and(|s| s.tree.closest(p, reach).is_some());
    let hits = places.iter().zip(strands).filter(|&(&p, near)| near || under(p)).count();
    (!places.is_empty()).then(|| hits as f64 / places.len() as f64)
}

fn scene_stats(call: &Call) -> Result<Value> {
    let tested = Tested::from(call, &Value::Handle(Handle::new(call.this::<Style>()?)), "")?;
    Ok(tested.figures(&tested.scene.parts, tested.scene.parts.len(), call.task()))
}

fn part_stats(call: &Call) -> Result<Value> {
    let this = call.this::<TestPart>()?;
    let part = this.tested.scene.parts.get(this.index..=this.index).unwrap_or(&[]);
    Ok(this.tested.figures(part, this.index, call.task()))
}

fn coverage(call: &Call) -> Result<Value> {
    let (this, fields) = (call.this::<TestPart>()?, call.read::<CoverageFields>()?);
    let part = this.tested.scene.parts.get(this.index..=this.index).unwrap_or(&[]);
    let part = this.tested.seen(part);
    let surface = surface(&locks(&part));
    let fraction = covered(&this.tested.standing(), &strands(&part), surface.as_ref(), fields.reach, call.task());
    fraction.map(Value::Number).ok_or_else(|| call.problem("there is no head whose scalp could be covered", None))
}

fn part_names(lua: &Lua, handle: &Handle) -> mlua::Result<Vec<String>> {
    let Some(style) = handle.get::<Style>() else { return Ok(vec![]) };
    Ok(style.tested(lua)?.scene.parts.iter().map(|p| p.name.clone()).collect())
}

fn part(lua: &Lua, handle: &Handle, name: &str) -> mlua::Result<Value> {
    let Some(style) = handle.get::<Style>() else { return Ok(Value::Nil) };
    let tested = style.tested(lua)?;
    let index = tested.scene.parts.iter().position(|p| p.name == name);
    Ok(index.map_or(Value::Nil, |index| give(TestPart { tested, index })))
}
