//! Binary glTF 2.0: metres, Y up, one buffer.
//!
//! glTF has no curves, and most programs read triangles alone, so strands are written as flat ribbons that lie on the
//! head: `u` across, `v` from root (0) to tip (1), tangents along the strand, one primitive per part. On request they
//! are lines instead, and the guides are always lines, in a file of their own. Every vertex names its strand
//! (`_STRAND_ID`), its guide (`_GUIDE_ID`), where strands of several script lines are in one part also the line
//! (`_SOURCE`, an index into the node's `extras.coif.sources`), and has the strand's diameter in metres (`_WIDTH`).
//!
//! A scene that moves has one animation. What moves as a whole is an animated node; a surface is a mixture of morph
//! targets, as seen from the node that carries it; strands are that, or follow chains of joints along their guides,
//! whichever takes less. `extras.coif.motion` of a part says what was chosen and how near it comes.
//!
//! Stylised hair is one mesh with one material: uv in an atlas (`v` from root to tip), tangents along `u`, the tuft's
//! colour as vertex colour, `_TUFT_ID`, and `_SOURCE` where several script lines made tufts.

mod basis;
mod buffer;
mod chains;
mod document;
mod frames;
mod keys;
mod locks;
mod material;
mod motion;
mod shapes;
mod skin;
mod told;

use std::borrow::Cow;

use glam::Affine3A;

use self::buffer::{Pen, Plan, Slot};
use self::document::{Buffer, Document, Extras, MeshEntry, Node, PartExtras, Primitive, SceneNodes};
use self::motion::Film;
use self::shapes::{Drawn, METRES};
pub use self::told::{PartMotion, motions};
use super::reduce::reduce;
use super::{ExportError, check_hair, check_motion, check_tolerance, frames_of, with_normals};
use crate::geometry::{Mesh, Strands};
use crate::scene::{Body, HairMaterial, Locks, Part, Scene};
use crate::task::Task;

crate::choices! {
    /// What strands become in a file of triangles.
    pub enum StrandForm {
        /// Flat ribbons: triangles, which every program reads.
        Ribbons = "ribbons",
        /// Lines one pixel wide; some programs leave them out.
        Lines = "lines",
        /// Left out: only the surfaces are written.
        None = "none",
    }
}

crate::choices! {
    /// How strands that move are written.
    pub enum MotionForm {
        /// As shapes or as joints, whichever takes less.
        Auto = "auto",
        /// As mixtures of morph targets.
        Shapes = "shapes",
        /// By chains of joints that they follow.
        Joints = "joints",
    }
}

crate::params! {
    /// How a scene is written as GLB.
    #[derive(PartialEq)]
    pub struct GlbOptions("coif.export.glb") {
        /// What strands become.
        strands: StrandForm = StrandForm::Ribbons;
        /// No point of a strand is farther than this from what is drawn of it; 0 keeps every bend.
        tolerance: f32 = 0.1, unit("cm"), range(0.0, 10.0);
        /// How a scene that moves is written: with its animation, or at the frame of its still pictures.
        animation: bool = true;
        /// At no frame is a vertex of the animation farther than this from its place; when left out 0.1, for strands that move
        /// farther than 5 cm a fiftieth of their way.
        motion_tolerance: Option<f32>, unit("cm"), range(0.0, 10.0);
        /// How strands that move are written.
        motion: MotionForm = MotionForm::Auto;
        /// A larger file is refused; the format itself ends at 4294967295.
        max_bytes: u64 = u64::from(u32::MAX), unit("bytes"), range(0.0, 4294967295.0);
    }
}

impl Default for GlbOptions {
    fn default() -> Self {
        crate::params::read::<Self>(&crate::params::Table::default()).expect("every field has a default")
    }
}

/// The scene as a binary glTF file.
///
/// # Errors
/// [`ExportError`]: too large, not finite, indices out of range, a placement that is not rigid, cancelled.
pub fn glb(scene: &Scene, options: &GlbOptions, task: &Task) -> Result<Vec<u8>, ExportError> {
    check_tolerance(options.tolerance)?;
    options.motion_tolerance.map_or(Ok(()), check_tolerance)?;
    if !options.animation && scene.timeline().is_some() {
        return glb(&scene.still(), options, task);
    }
    let mut file = File::new(scene)?;
    file.begin(scene, options.motion_tolerance);
    for part in &scene.parts {
        check_motion(part)?;
        match &part.body {
            Body::Mesh(mesh, look) => {
                mesh.validate().map_err(|error| ExportError::Mesh { part: part.name.clone(), error })?;
                let mesh = with_normals(mesh);
                let (attributes, vertices, indices) = shapes::surface_layout(&mesh);
                let slot = file.plan.primitive(&mut file.document, &attributes, vertices, indices);
                // Cloth is seen from inside too: in a sleeve, below a hem.
                let material = material::surface(&mut file.document, &part.name, look, part.is_garment());
                let kind = if part.is_garment() { "garment" } else { "head" };
                let extras = PartExtras { kind, source: part.source.clone(), ..PartExtras::default() };
                let place = file.part(part, Some((&slot, material, document::TRIANGLES)), extras);
                file.surface(part, place, &mesh, task)?;
                file.jobs.push(Job::Surface(mesh, slot));
            }
            Body::Locks(locks) => {
                locks.mesh.mesh.validate().map_err(|error| ExportError::Mesh { part: part.name.clone(), error })?;
                let (attributes, vertices, indices) = locks::layout(locks);
                let slot = file.plan.primitive(&mut file.document, &attributes, vertices, indices);
                let material = material::locks(&mut file.document, &part.name, locks);
                let count = locks.tufts.count();
                let extras = PartExtras {
                    kind: locks.kind.text(),
                    source: part.source.clone(),
                    tufts: (count > 0).then_some(count),
                    sources: locks.tufts.sources.iter().map(|s| s.as_ref().to_owned()).collect(),
                    ..PartExtras::default()
                };
                let place = file.part(part, Some((&slot, material, document::TRIANGLES)), extras);
                file.surface(part, place, &locks.mesh.mesh, task)?;
                file.jobs.push(Job::Locks(locks, slot));
            }
            Body::Hair(hair) => {
                check_hair(part, hair)?;
                file.strands(
                    part,
                    &hair.strands,
                    &hair.material,
                    (options.strands, options.tolerance, options.motion),
                    task,
                    |e| {
                        e.guides = Some(hair.guides.count());
                    },
                )?;
            }
        }
    }
    file.finish(options.max_bytes, task)
}

/// The guides of every part that is hair, as lines with all their nodes, and nothing else.
///
/// The nodes are those of [`glb`] with ` guides` after their names; of `options` only `max_bytes` counts. The strand
/// with `_GUIDE_ID` n in the one file is the line with `_STRAND_ID` n in the other. What moves is written at rest.
///
/// # Errors
/// [`ExportError`]: as for [`glb`].
pub fn guides_glb(scene: &Scene, options: &GlbOptions, task: &Task) -> Result<Vec<u8>, ExportError> {
    let mut file = File::new(scene)?;
    for (part, hair) in scene.hair() {
        check_hair(part, hair)?;
        let named = Part { name: format!("{} guides", part.name), motion: None, ..part.clone() };
        file.strands(&named, &hair.guides, &hair.material, (StrandForm::Lines, 0.0, MotionForm::Auto), task, |e| {
            e.kind = "guides";
        })?;
    }
    file.finish(options.max_bytes, task)
}

/// What is still to be written into the buffer, once it exists.
enum Job<'a> {
    Surface(Cow<'a, Mesh>, Slot),
    Locks(&'a Locks, Slot),
    Ribbons(Drawn<'a>, Slot),
    Lines(Drawn<'a>, Slot),
    Blob(Vec<u8>, std::ops::Range<usize>),
}

/// A file being made: everything gets its place first, is then checked against the limit, and written last.
struct File<'a> {
    document: Document,
    plan: Plan,
    jobs: Vec<Job<'a>>,
    film: Option<Film>,
}

/// Where a part is in the document.
#[derive(Clone, Copy)]
struct Place {
    node: u32,
    parent: u32,
    mesh: Option<u32>,
}

impl<'a> File<'a> {
    /// A file with one root node that leads from head space to the space of the head's own file.
    fn new(scene: &Scene) -> Result<Self, ExportError> {
        let mut document = Document::default();
        let mut root = Node { name: scene.name.clone(), ..Node::default() };
        place(&mut root, scene.placement)?;
        document.nodes.push(root);
        document.scenes.push(SceneNodes { name: scene.name.clone(), nodes: vec![0] });
        Ok(Self { document, plan: Plan::default(), jobs: Vec::new(), film: None })
    }

    /// Adds a node below the one that carries the part, with a mesh of one primitive: (place, material, mode). Gives the
    /// indices of the node and its mesh.
    fn part(&mut self, part: &Part, primitive: Option<(&Slot, u32, u32)>, extras: PartExtras) -> Place {
        let name = &part.name;
        let mesh = primitive.map(|(slot, material, mode)| {
            let (attributes, targets) = (slot.attributes.clone(), vec![]);
            let primitive = Primitive { attributes, indices: slot.indices, material, mode, targets };
            let (primitives, weights, extras) = (vec![primitive], vec![], None);
            self.document.meshes.push(MeshEntry { name: name.clone(), primitives, weights, extras });
            self.document.meshes.len() as u32 - 1
        });
        let node = Node { name: name.clone(), mesh, extras: Some(Extras { coif: extras }), ..Node::default() };
        let index = self.document.nodes.len() as u32;
        self.document.nodes.push(node);
        let parent = self.parent(part);
        self.document.nodes[parent as usize].children.push(index);
        Place { node: index, parent, mesh }
    }

    fn strands(
        &mut self,
        part: &Part,
        strands: &'a Strands,
        look: &'a HairMaterial,
        (form, tolerance, motion): (StrandForm, f32, MotionForm),
        task: &Task,
        more: impl FnOnce(&mut PartExtras),
    ) -> Result<(), ExportError> {
        if form == StrandForm::None {
            return Ok(());
        }
        let mut extras = PartExtras {
            kind: "hair",
            source: part.source.clone(),
            strands: Some(strands.count()),
            guides: None,
            sources: strands.sources.iter().map(|s| s.as_ref().to_owned()).collect(),
            tolerance_cm: Some(tolerance),
            ..PartExtras::default()
        };
        more(&mut extras);
        if strands.count() == 0 {
            self.part(part, None, extras);
            return Ok(());
        }
        task.progress("reducing strands", 0.0);
        let blocks = reduce(strands, &frames_of(part), tolerance, task)?;
        let mut drawn = Drawn { strands, blocks, look, shifts: vec![] };
        let document = &mut self.document;
        if form == StrandForm::Ribbons {
            let (attributes, vertices, indices) = drawn.ribbon_layout();
            let slot = self.plan.primitive(document, &attributes, vertices, indices);
            let ramp = material::ramp_png(look);
            let (range, view) = self.plan.blob(document, ramp.len());
            let material = material::ribbons(document, &part.name, look, view);
            let place = self.part(part, Some((&slot, material, document::TRIANGLES)), extras);
            drawn.shifts = self.hair(part, place, &drawn, true, motion, task)?;
            self.jobs.push(Job::Blob(ramp, range));
            self.jobs.push(Job::Ribbons(drawn, slot));
        } else {
            let (attributes, vertices, indices) = drawn.line_layout();
            let slot = self.plan.primitive(document, &attributes, vertices, indices);
            let material = material::lines(document, &part.name, look);
            let place = self.part(part, Some((&slot, material, document::LINES)), extras);
            drawn.shifts = self.hair(part, place, &drawn, false, motion, task)?;
            self.jobs.push(Job::Lines(drawn, slot));
        }
        Ok(())
    }

    /// Writes the file: header, JSON chunk, binary chunk (glTF 2.0 specification, section 4).
    ///
    /// The JSON comes first, but has the bounds of what comes after it. It gets a place that is surely large enough and
    /// is padded with spaces, so that the buffer is written where it stays: a copy would take as long as the rest.
    fn finish(mut self, max_bytes: u64, task: &Task) -> Result<Vec<u8>, ExportError> {
        self.end();
        let byte_length = self.plan.length();
        if byte_length > 0 {
            self.document.buffers.push(Buffer { byte_length });
        }
        let json = self.document.to_json().len().next_multiple_of(4);
        let bin = byte_length as usize;
        let start = if bin == 0 { 20 + json } else { 28 + json };
        let length = start as u64 + byte_length;
        let limit = max_bytes.min(u64::from(u32::MAX));
        if length > limit {
            return Err(ExportError::TooLarge { bytes: length, limit });
        }

        let mut file = vec![0; length as usize];
        let (head, buffer) = file.split_at_mut(start);
        let count = self.jobs.len() as f32;
        for (i, job) in self.jobs.into_iter().enumerate() {
            task.progress("writing glb", i as f32 / count);
            let (bounds, slot) = match job {
                Job::Surface(mesh, slot) => (shapes::write_surface(&mesh, buffer, &slot), slot),
                Job::Locks(locks, slot) => (locks::write(locks, buffer, &slot), slot),
                Job::Ribbons(drawn, slot) => (drawn.write_ribbons(buffer, &slot, task)?, slot),
                Job::Lines(drawn, slot) => (drawn.write_lines(buffer, &slot, task)?, slot),
                Job::Blob(bytes, range) => {
                    buffer[range].copy_from_slice(&bytes);
                    continue;
                }
            };
            slot.set_bounds(&mut self.document, bounds);
        }

        let mut text = self.document.to_json();
        debug_assert!(text.len() <= json);
        text.resize(json, b' ');
        let mut pen = Pen(head);
        pen.bytes(*b"glTF");
        pen.index(2);
        pen.index(length as u32);
        pen.index(json as u32);
        pen.bytes(*b"JSON");
        pen.slice(&text);
        pen.index(bin as u32);
        pen.bytes(*b"BIN\0");
        task.progress("writing glb", 1.0);
        Ok(file)
    }
}

/// Sets a node's move, turn and scale, where they are not those of no placement.
fn place(node: &mut Node, placement: Affine3A) -> Result<(), ExportError> {
    let refused = ExportError::Placement { placement };
    if !placement.is_finite() {
        return Err(refused);
    }
    if placement == Affine3A::IDENTITY {
        return Ok(());
    }
    let (scale, rotation, translation) = placement.to_scale_rotation_translation();
    let back = Affine3A::from_scale_rotation_translation(scale, rotation, translation);
    let size = scale.abs().max_element();
    if !rotation.is_finite() || scale.min_element() == 0.0 || !back.matrix3.abs_diff_eq(placement.matrix3, 1e-4 * size)
    {
        return Err(refused);
    }
    node.translation = Some((translation * METRES).to_array());
    node.rotation = Some(rotation.normalize().to_array());
    if !scale.abs_diff_eq(glam::Vec3::ONE, 1e-6) {
        node.scale = Some(scale.to_array());
    }
    Ok(())
}
