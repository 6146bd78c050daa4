//! What moves in a file: nodes, morph targets, and the keys of both.
//!
//! One node carries everything that moves more with the head than by itself, so that a part's own motion is written as seen from the head:
//! small, and in few shapes. What is at rest on the head needs no shapes at all.

use glam::{Affine3A, Vec3};

use super::basis::{Basis, Sampled, Vertices};
use super::chains::{Chains, Hair, Most};
use super::document::{
    self as json, Accessor, Animation, AnimationSampler, Channel, MeshExtras, MotionExtras, Node, Sparse,
    SparseIndices, SparseValues, Target,
};
use super::keys::{Placing, placings, reduce, share};
use super::shapes::{Drawn, METRES};
use super::skin::Tracked;
use super::{File, Job, MotionForm, Place};
use crate::export::ExportError;
use crate::geometry::{Bounds, Clip, Mesh, Strands};
use crate::scene::{Body, Motion, Part, Scene, Timeline};
use crate::task::{Cancelled, Task};

/// The part of the tolerance that shapes may use; keys have the rest.
const SHAPES: f32 = 0.6;
/// How far what moves may be from its place, unless it is said, cm.
const USUAL: f32 = 0.1;
/// The same for strands that move far: this part of their way.
const OF_TRAVEL: f32 = 0.02;
/// A displacement that is none, cm.
const NOTHING: f32 = 1e-6;
/// Sparse entries cost an index besides their values: worth it below this share.
const SPARSE: f32 = 0.75;

/// The motion of a whole scene.
pub struct Film {
    name: String,
    timeline: Timeline,
    /// What was asked for, cm.
    given: Option<f32>,
    /// That, or the usual.
    tolerance: f32,
    carrier: Option<Carrier>,
    channels: Vec<Channel>,
    samplers: Vec<AnimationSampler>,
}

/// The node that moves with the head.
struct Carrier {
    clip: Clip<Affine3A>,
    node: u32,
    /// Per frame what the file's keys make of it.
    played: Vec<Placing>,
    keys: usize,
    error: f32,
}

impl Carrier {
    /// True when points move less as seen from here than as seen from the scene.
    fn carries<T>(&self, rest: &[Vec3], clip: &Clip<T>, points: impl Fn(&T) -> &[Vec3]) -> bool {
        let (mut here, mut there) = (0.0_f64, 0.0_f64);
        for (frame, placing) in clip.frames.iter().zip(&self.played) {
            let by = placing.transform().inverse();
            // Some hundred points tell.
            let step = (rest.len() / 256).max(1);
            for (now, rest) in points(frame).iter().zip(rest).step_by(step) {
                here += f64::from(by.transform_point3(*now).distance_squared(*rest));
                there += f64::from(now.distance_squared(*rest));
            }
        }
        here < there
    }
}

impl Film {
    /// Frames with the one that closes a loop.
    fn moments(&self) -> usize {
        self.timeline.frames + usize::from(self.timeline.looped)
    }

    /// What is told of the motion of a part.
    fn extras(&self, form: &'static str, keys: usize, error_cm: f32) -> MotionExtras {
        let Timeline { frames, rate, looped } = self.timeline;
        let (joints, chains) = (None, None);
        MotionExtras { form, frames, rate, looped, shapes: 0, joints, chains, bytes: 0, keys, error_cm }
    }
}

impl File<'_> {
    /// Makes ready for a scene that moves: with a node for everything that the head's motion carries.
    pub(super) fn begin(&mut self, scene: &Scene, given: Option<f32>) {
        let Some(timeline) = scene.timeline() else { return };
        let (channels, samplers) = (vec![], vec![]);
        let tolerance = given.unwrap_or(USUAL);
        let mut film = Film { name: scene.name.clone(), timeline, given, tolerance, carrier: None, channels, samplers };
        // The head's motion before any other's.
        let rigid = |head: bool| {
            scene.parts.iter().find_map(move |p| match (&p.body, &p.motion) {
                (body, Some(Motion::Rigid(clip))) if matches!(body, Body::Mesh(..)) == head => Some(clip),
                _ => None,
            })
        };
        let clip = rigid(true).or_else(|| rigid(false)).cloned();
        if let Some(clip) = clip {
            let node = self.document.nodes.len() as u32;
            self.document.nodes.push(Node { name: format!("{} motion", scene.name), ..Node::default() });
            self.document.nodes[0].children.push(node);
            self.film = Some(film);
            let (keys, played, error) = self.animate(node, &clip, scene.bounds());
            let Some(film) = &mut self.film else { return };
            film.carrier = Some(Carrier { clip, node, played, keys, error });
        } else {
            film.carrier = None;
            self.film = Some(film);
        }
    }

    /// The node that a part stands below: the carrier, when that does the greater part of its motion.
    pub(super) fn parent(&self, part: &Part) -> u32 {
        let Some(carrier) = self.film.as_ref().and_then(|f| f.carrier.as_ref()) else { return 0 };
        let is_carried = match (&part.motion, &part.body) {
            (Some(Motion::Rigid(clip)), _) => *clip == carrier.clip,
            (Some(Motion::Surface(clip)), Body::Mesh(mesh, _)) => {
                carrier.carries(&mesh.positions, clip, |f| f.as_slice())
            }
            (Some(Motion::Surface(clip)), Body::Locks(locks)) => {
                carrier.carries(&locks.mesh.mesh.positions, clip, |f| f.as_slice())
            }
            (Some(Motion::Strands { strands, .. }), Body::Hair(hair)) => {
                carrier.carries(&hair.strands.points, strands, |f| f.points.as_slice())
            }
            _ => false,
        };
        if is_carried { carrier.node } else { 0 }
    }

    /// The motion of a surface.
    pub(super) fn surface(&mut self, part: &Part, place: Place, mesh: &Mesh, task: &Task) -> Result<(), Cancelled> {
        match &part.motion {
            Some(Motion::Rigid(clip)) => self.rigid(place, clip, mesh.bounds()),
            Some(Motion::Surface(clip)) => {
                let unit = |normals: &[Vec3]| normals.iter().map(|n| n.try_normalize().unwrap_or(Vec3::Y)).collect();
                let rest = Vertices { positions: mesh.positions.clone(), normals: unit(&mesh.normals) };
                let unplaced = self.unplaced(place);
                let at = |frame: usize| {
                    let by = unplaced(frame);
                    let still = &mesh.positions;
                    let positions: Vec<Vec3> = match clip.at(frame) {
                        Some(now) => now.iter().map(|p| by.transform_point3(*p)).collect(),
                        None => still.clone(),
                    };
                    let normals = unit(&mesh.moved(&positions).normals);
                    Vertices { positions, normals }
                };
                self.morph(place, &rest, at, task)?;
            }
            Some(Motion::Strands { .. }) | None => {}
        }
        Ok(())
    }

    /// The motion of strands: by shapes or by joints, whichever takes less, unless one of them is asked for. Gives how far
    /// each drawn node is to be shifted at rest, if at all.
    pub(super) fn hair(
        &mut self,
        part: &Part,
        place: Place,
        drawn: &Drawn,
        is_ribbons: bool,
        form: MotionForm,
        task: &Task,
    ) -> Result<Vec<Vec3>, ExportError> {
        match (&part.motion, &part.body) {
            (Some(Motion::Rigid(clip)), _) => self.rigid(place, clip, drawn.strands.bounds()),
            (Some(Motion::Strands { strands, guides }), Body::Hair(hair)) => {
                let Some(film) = &self.film else { return Ok(vec![]) };
                let (frames, moments, rate) = (film.timeline.frames, film.moments(), film.timeline.rate);
                let unplaced = self.unplaced(place);
                let travel = || {
                    let way = |f: usize| {
                        let by = unplaced(f);
                        let now = strands.at(f).map_or(&[][..], |s| &s.points);
                        let ways = now.iter().zip(&drawn.strands.points);
                        ways.map(|(p, rest)| by.transform_point3(*p).distance(*rest)).fold(0.0, f32::max)
                    };
                    (0..frames).map(way).fold(0.0, f32::max)
                };
                let tolerance = film.given.unwrap_or_else(|| film.tolerance.max(OF_TRAVEL * travel()));
                let rest = drawn.vertices(is_ribbons, None);
                let at = |frame: usize| {
                    let now: Option<(&Strands, Affine3A)> = strands.at(frame).map(|s| (&**s, unplaced(frame)));
                    drawn.vertices(is_ribbons, now.as_ref().map(|(s, by)| (*s, by)))
                };
                let sampled = match form {
                    MotionForm::Joints => None,
                    MotionForm::Auto | MotionForm::Shapes => {
                        Some(Sampled::new(&rest, frames, at, SHAPES * tolerance, task)?)
                    }
                };
                let most = match (form, &sampled) {
                    (MotionForm::Joints, _) | (_, None) => Some(Most::ALL),
                    (MotionForm::Auto, Some(sampled)) => {
                        Some(Most { joints: Most::EASY, bytes: shape_bytes(&rest, sampled.wanted(), frames) })
                    }
                    (MotionForm::Shapes, Some(_)) => None,
                };
                if let Some(most) = most {
                    let placed = |f: usize| strands.at(f).map(|s| (&**s, unplaced(f)));
                    // Guides that do not move, though the strands do, show nothing.
                    let moves = !std::sync::Arc::ptr_eq(&hair.guides, &hair.strands)
                        && guides.frames.windows(2).any(|w| w[0].points != w[1].points);
                    let led = moves
                        .then(|| (&*hair.guides, (0..frames).filter_map(|f| guides.at(f).map(|g| &**g)).collect()));
                    let tracked = Tracked::new(drawn, is_ribbons, (0..frames).filter_map(placed).collect(), led);
                    if let Some(chains) = Chains::new(&tracked, moments, tolerance, most, task)? {
                        self.skin(place, &chains, tracked.each(), rate);
                        let keys = chains.chains.iter().map(|c| c.keys.len()).max().unwrap_or(0);
                        if let Some(film) = &self.film {
                            let extras = film.extras("joints", keys, chains.error);
                            let (joints, count) = (Some(chains.joints()), Some(chains.chains.len()));
                            let bytes = chains.bytes(rest.positions.len());
                            self.note(place, MotionExtras { joints, chains: count, bytes, ..extras });
                        }
                        return Ok(chains.shifts);
                    }
                }
                match sampled {
                    Some(sampled) => self.shapes(place, &rest, sampled, at, tolerance, task)?,
                    None => return Err(ExportError::Joints { part: part.name.clone(), tolerance }),
                }
            }
            _ => {}
        }
        Ok(vec![])
    }

    /// Leads from a frame to the carrier's own space, as the file has it.
    fn unplaced(&self, place: Place) -> impl Fn(usize) -> Affine3A + 'static {
        let carrier = self.film.as_ref().and_then(|f| f.carrier.as_ref()).filter(|c| c.node == place.parent);
        let played = carrier.map(|c| c.played.clone()).unwrap_or_default();
        move |frame| played.get(frame).map_or(Affine3A::IDENTITY, |p| p.transform().inverse())
    }

    /// A part that moves as a whole: with the carrier, or by itself.
    fn rigid(&mut self, place: Place, clip: &Clip<Affine3A>, bounds: Bounds) {
        let Some(film) = &self.film else { return };
        let (keys, error) = match &film.carrier {
            Some(carrier) if carrier.clip == *clip => (carrier.keys, carrier.error),
            _ => {
                let (keys, _, error) = self.animate(place.node, clip, bounds);
                (keys, error)
            }
        };
        let Some(film) = &self.film else { return };
        let extras = film.extras("node", keys, error);
        self.note(place, MotionExtras { bytes: 32 * keys, ..extras });
    }

    fn note(&mut self, place: Place, motion: MotionExtras) {
        if let Some(extras) = &mut self.document.nodes[place.node as usize].extras {
            extras.coif.motion = Some(motion);
        }
    }

    /// Moves a node: (how many frames have keys, what is played at each frame, the greatest error in cm).
    fn animate(&mut self, node: u32, clip: &Clip<Affine3A>, bounds: Bounds) -> (usize, Vec<Placing>, f32) {
        let Some(film) = &self.film else { return (0, vec![], 0.0) };
        let (count, frames, rate) = (film.moments(), film.timeline.frames, film.timeline.rate);
        let at = |i: usize| clip.at(i % frames).map_or(Affine3A::IDENTITY, |t| **t);
        let all = Placing::of((0..count).map(at));
        let (kept, mut played, error) = placings(&all, bounds, film.tolerance);
        played.truncate(frames);
        let times = self.times(&kept, rate);
        let shifts = kept.iter().flat_map(|&f| (all[f].shift * METRES).to_array());
        let turns = kept.iter().flat_map(|&f| all[f].turn.to_array());
        let (shifts, turns) = (self.numbers(shifts, "VEC3", 3), self.numbers(turns, "VEC4", 4));
        self.channel(node, "translation", times, shifts);
        self.channel(node, "rotation", times, turns);
        (kept.len(), played, error)
    }

    /// Gives a mesh the shapes and weights that follow `at(frame)`.
    fn morph(
        &mut self,
        place: Place,
        rest: &Vertices,
        at: impl Fn(usize) -> Vertices,
        task: &Task,
    ) -> Result<(), Cancelled> {
        let Some(film) = &self.film else { return Ok(()) };
        let film_tolerance = film.tolerance;
        let sampled = Sampled::new(rest, film.timeline.frames, &at, SHAPES * film_tolerance, task)?;
        self.shapes(place, rest, sampled, at, film_tolerance, task)
    }

    /// The same, when some of the vertices were looked at.
    fn shapes(
        &mut self,
        place: Place,
        rest: &Vertices,
        sampled: Sampled,
        at: impl Fn(usize) -> Vertices,
        tolerance: f32,
        task: &Task,
    ) -> Result<(), Cancelled> {
        let (Some(film), Some(mesh)) = (&self.film, place.mesh) else { return Ok(()) };
        let (frames, count, rate) = (film.timeline.frames, film.moments(), film.timeline.rate);
        let found: Basis = sampled.basis(rest, at, SHAPES * tolerance, task)?.with_weights_from_zero();
        let before = self.plan.length();
        let Some(film) = &self.film else { return Ok(()) };
        let told = film.extras("shapes", 0, 0.0);
        let reaches = found.reaches();
        let weight = |frame: usize, k: usize| found.weights[frame % frames][k];
        let missed = |from: usize, to: usize, frame: usize| -> f32 {
            let t = share(from, to, frame);
            let off = |k: usize| {
                let (a, b) = (weight(from, k), weight(to, k));
                (a + (b - a) * t - weight(frame, k)).abs() * reaches[k]
            };
            (0..reaches.len()).map(off).sum()
        };
        let kept = reduce(count, (tolerance - found.error).max(0.0), missed);
        let between = kept.windows(2).flat_map(|w| (w[0] + 1..w[1]).map(|f| missed(w[0], w[1], f)));
        let error = found.error + between.fold(0.0, f32::max);

        let targets: Vec<Vec<(&'static str, u32)>> = found
            .shapes
            .iter()
            .map(|shape| {
                let mut target = vec![("POSITION", self.deltas(&shape.positions, METRES, true))];
                if !shape.normals.is_empty() {
                    target.push(("NORMAL", self.deltas(&shape.normals, 1.0, false)));
                }
                target
            })
            .collect();
        let shapes = targets.len();
        if shapes > 0 {
            let times = self.times(&kept, rate);
            let weights = kept.iter().flat_map(|&f| (0..shapes).map(move |k| (f, k))).map(|(f, k)| weight(f, k));
            let weights = self.numbers(weights, "SCALAR", 1);
            self.channel(place.node, "weights", times, weights);
            let entry = &mut self.document.meshes[mesh as usize];
            entry.weights = vec![0.0; shapes];
            let target_names = (1..=shapes).map(|k| format!("shape {k}")).collect();
            entry.extras = Some(MeshExtras { target_names });
            if let Some(primitive) = entry.primitives.first_mut() {
                primitive.targets = targets;
            }
        }
        let bytes = (self.plan.length() - before) as usize;
        self.note(place, MotionExtras { shapes, bytes, keys: kept.len(), error_cm: error, ..told });
        Ok(())
    }

    pub(super) fn channel(&mut self, node: u32, path: &'static str, input: u32, output: u32) {
        let Some(film) = &mut self.film else { return };
        let sampler = film.samplers.len() as u32;
        film.samplers.push(AnimationSampler { input, output });
        film.channels.push(Channel { sampler, target: Target { node, path } });
    }

    /// The times of frames, seconds.
    fn times(&mut self, frames: &[usize], rate: f32) -> u32 {
        let times: Vec<f32> = frames.iter().map(|&f| f as f32 / rate).collect();
        let (first, last) = (times.first().copied().unwrap_or(0.0), times.last().copied().unwrap_or(0.0));
        let accessor = self.numbers(times, "SCALAR", 1);
        let entry = &mut self.document.accessors[accessor as usize];
        (entry.min, entry.max) = (Some(vec![f64::from(first)]), Some(vec![f64::from(last)]));
        accessor
    }

    /// Floats that are no vertices, `each` of them to an entry.
    fn numbers(&mut self, numbers: impl IntoIterator<Item = f32>, shape: &'static str, each: usize) -> u32 {
        let bytes: Vec<u8> = numbers.into_iter().flat_map(f32::to_le_bytes).collect();
        let count = (bytes.len() / 4 / each) as u64;
        let (range, view) = self.plan.blob(&mut self.document, bytes.len());
        self.jobs.push(Job::Blob(bytes, range));
        self.accessor(Some(view), count, shape)
    }

    fn accessor(&mut self, buffer_view: Option<u32>, count: u64, shape: &'static str) -> u32 {
        let (byte_offset, component_type, normalized) = (0, json::F32, false);
        let (min, max, sparse) = (None, None, None);
        let accessor =
            Accessor { buffer_view, byte_offset, component_type, normalized, count, shape, min, max, sparse };
        self.document.accessors.push(accessor);
        self.document.accessors.len() as u32 - 1
    }

    /// Displacements of a morph target, of which only those that are some are written where that is less.
    fn deltas(&mut self, deltas: &[Vec3], unit: f32, has_bounds: bool) -> u32 {
        let some: Vec<u32> =
            (0..deltas.len() as u32).filter(|&v| deltas[v as usize].abs().max_element() > NOTHING).collect();
        let is_sparse = (some.len() as f32) < SPARSE * deltas.len() as f32 && !some.is_empty();
        let write = |d: &Vec3| (*d * unit).to_array().map(f32::to_le_bytes);
        let accessor = if is_sparse {
            let values: Vec<u8> = some.iter().flat_map(|&v| write(&deltas[v as usize])).flatten().collect();
            let indices: Vec<u8> = some.iter().flat_map(|i| i.to_le_bytes()).collect();
            let (place, index_view) = self.plan.blob(&mut self.document, indices.len());
            self.jobs.push(Job::Blob(indices, place));
            let (place, value_view) = self.plan.blob(&mut self.document, values.len());
            self.jobs.push(Job::Blob(values, place));
            let accessor = self.accessor(None, deltas.len() as u64, "VEC3");
            self.document.accessors[accessor as usize].sparse = Some(Sparse {
                count: some.len() as u64,
                indices: SparseIndices { buffer_view: index_view, component_type: json::U32 },
                values: SparseValues { buffer_view: value_view },
            });
            accessor
        } else {
            let bytes: Vec<u8> = deltas.iter().flat_map(write).flatten().collect();
            let (place, view) = self.plan.aimed(&mut self.document, bytes.len(), Some(json::VERTICES));
            self.jobs.push(Job::Blob(bytes, place));
            self.accessor(Some(view), deltas.len() as u64, "VEC3")
        };
        if has_bounds {
            let zero = if is_sparse { Bounds::of([Vec3::ZERO]) } else { Bounds::EMPTY };
            let written = |v: &u32| deltas[*v as usize] * unit;
            let bounds = if is_sparse {
                zero.union(Bounds::of(some.iter().map(written)))
            } else {
                Bounds::of(deltas.iter().map(|d| *d * unit))
            };
            let entry = &mut self.document.accessors[accessor as usize];
            let array = |v: Vec3| Some(v.as_dvec3().to_array().to_vec());
            (entry.min, entry.max) = (array(bounds.min), array(bounds.max));
        }
        accessor
    }

    /// Puts the animation into the document.
    pub(super) fn end(&mut self) {
        if let Some(film) = self.film.take().filter(|f| !f.channels.is_empty()) {
            let Film { name, channels, samplers, .. } = film;
            self.document.animations.push(Animation { name, channels, samplers });
        }
    }
}

/// About the bytes that so many shapes take.
fn shape_bytes(rest: &Vertices, shapes: usize, frames: usize) -> usize {
    // One more for the weights that would go below 0.
    12 * (shapes + 1) * (rest.positions.len() + rest.normals.len()) + 4 * shapes * frames
}
