//! USD as text (`.usda`): the head as a mesh, hair and guides as linear `BasisCurves`.
//!
//! Centimetres, Y up. The curves carry what the programs read that take them: widths (diameters) per node, root uv as
//! `st`, as `surface_uv_coordinate` (Blender) and as `groom_root_uv` (Unreal), ids and guides as `groom_id` and
//! `groom_guide`, one colour per strand. What moves has time
//! samples, one time code to a frame. Numbers have five decimals: a tenth of a micrometre.

mod motion;
mod text;

use glam::Vec3;
use rayon::prelude::*;

use crate::geometry::{Bounds, Mesh, Strands};
use crate::scene::{Body, Hair, HairMaterial, MeshMaterial, Part, Scene};
use crate::task::{Cancelled, Task};

use self::text::{Names, decimal, quoted, tuple};
use super::reduce::{Block, reduce};
use super::{ExportError, appearance, check_hair, check_motion, check_tolerance, frames_of, with_normals};

crate::params! {
    /// How a scene is written as USD.
    #[derive(PartialEq)]
    pub struct UsdaOptions("coif.export.usda") {
        /// No point of a strand is farther than this from what is written of it; 0 keeps every bend.
        tolerance: f32 = 0.0, unit("cm"), range(0.0, 10.0);
        /// Write the guides too, as curves of purpose `guide`.
        guides: bool = true;
        /// A larger file is refused.
        max_bytes: u64 = 4_294_967_295, unit("bytes"), range(0.0, 1e12);
    }
}

impl Default for UsdaOptions {
    fn default() -> Self {
        Self { tolerance: 0.0, guides: true, max_bytes: 4_294_967_295 }
    }
}

/// The scene as USD text.
///
/// # Errors
/// [`ExportError`]: not finite, indices out of range, too large (found while writing), cancelled.
pub fn usda(scene: &Scene, options: &UsdaOptions, task: &Task) -> Result<Vec<u8>, ExportError> {
    check_tolerance(options.tolerance)?;
    if !scene.placement.is_finite() {
        return Err(ExportError::Placement { placement: scene.placement });
    }
    let mut names = Names::default();
    let timeline = scene.timeline();
    let frames = timeline.map_or(0, |t| t.frames);
    let mut out = Writer { bytes: Vec::new(), limit: options.max_bytes, frames };
    let root = Names::default().take(&scene.name);
    let looks = names.take("Looks");
    out.line(0, "#usda 1.0")?;
    out.line(0, &format!("(\n    defaultPrim = \"{root}\"\n    doc = \"coif {}\"", env!("CARGO_PKG_VERSION")))?;
    if let Some(t) = timeline {
        let (last, rate) = (t.frames - 1, t.rate);
        out.line(1, &format!("startTimeCode = 0\nendTimeCode = {last}"))?;
        out.line(1, &format!("timeCodesPerSecond = {rate}\nframesPerSecond = {rate}"))?;
    }
    out.line(0, "    metersPerUnit = 0.01\n    upAxis = \"Y\"\n)\n")?;
    out.line(0, &format!("def Xform \"{root}\" (\n    kind = \"component\"\n)\n{{"))?;
    out.placement(scene)?;
    let mut materials = Vec::new();
    for (i, part) in scene.parts.iter().enumerate() {
        task.progress("writing usda", i as f32 / scene.parts.len() as f32);
        check_motion(part)?;
        let name = names.take(&part.name);
        let binding = format!("rel material:binding = </{root}/{looks}/{name}>");
        match &part.body {
            Body::Mesh(mesh, look) => {
                mesh.validate().map_err(|error| ExportError::Mesh { part: part.name.clone(), error })?;
                out.mesh(&name, part, &with_normals(mesh), None, &binding, task)?;
                materials.push(Material { name, inputs: surface(look), fallback: None });
            }
            Body::Locks(locks) => {
                let mesh = &locks.mesh.mesh;
                mesh.validate().map_err(|error| ExportError::Mesh { part: part.name.clone(), error })?;
                let colour = |v: usize| locks.look(locks.mesh.tuft[v] as usize).along(locks.place(v).y);
                let colours: Vec<Vec3> = (0..mesh.positions.len()).map(colour).collect();
                out.mesh(&name, part, &with_normals(mesh), Some((&colours, &locks.mesh.tuft)), &binding, task)?;
                let first = locks.look(0);
                let look = MeshMaterial { colour: first.colour, roughness: first.roughness };
                materials.push(Material { name, inputs: surface(&look), fallback: Some(look.colour.to_linear()) });
            }
            Body::Hair(hair) => {
                check_hair(part, hair)?;
                let blocks = reduce(&hair.strands, &frames_of(part), options.tolerance, task)?;
                out.curves(&name, part, (&hair.strands, &blocks, &hair.material), false, &binding, task)?;
                if options.guides {
                    let blocks = reduce(&hair.guides, &[], 0.0, task)?;
                    let name = names.take(&format!("{name}_guides"));
                    out.curves(&name, part, (&hair.guides, &blocks, &hair.material), true, &binding, task)?;
                }
                materials.push(Material { name, inputs: strand(hair), fallback: None });
            }
        }
    }
    out.materials(&root, &looks, &materials)?;
    out.line(0, "}")?;
    Ok(out.bytes)
}

/// A material of the file.
struct Material {
    name: String,
    /// Inputs of its `UsdPreviewSurface`.
    inputs: String,
    /// The colour where there is no `displayColor`, for a material that takes its colour from there.
    fallback: Option<Vec3>,
}

/// Inputs of a `UsdPreviewSurface`.
fn surface(look: &MeshMaterial) -> String {
    let colour = text::of(&look.colour.to_linear().to_array());
    format!("color3f inputs:diffuseColor = {colour}\nfloat inputs:roughness = {}", look.roughness)
}

fn strand(hair: &Hair) -> String {
    let (root, tip) = (hair.material.root_colour.to_linear(), hair.material.tip_colour.to_linear());
    format!(
        "color3f inputs:diffuseColor = {}\nfloat inputs:roughness = {}\n\
         custom color3f coif:rootColour = {}\ncustom color3f coif:tipColour = {}",
        text::of(&((root + tip) * 0.5).to_array()),
        hair.material.roughness,
        text::of(&root.to_array()),
        text::of(&tip.to_array()),
    )
}

/// The text so far, never longer than the limit.
struct Writer {
    bytes: Vec<u8>,
    limit: u64,
    /// Frames of a scene that moves, else 0.
    frames: usize,
}

impl Writer {
    fn check(&self) -> Result<(), ExportError> {
        let bytes = self.bytes.len() as u64;
        if bytes > self.limit { Err(ExportError::TooLarge { bytes, limit: self.limit }) } else { Ok(()) }
    }

    /// Some lines, all indented.
    fn line(&mut self, indent: usize, text: &str) -> Result<(), ExportError> {
        for line in text.split('\n') {
            let spaces = if line.is_empty() { 0 } else { 4 * indent };
            self.bytes.resize(self.bytes.len() + spaces, b' ');
            self.bytes.extend_from_slice(line.as_bytes());
            self.bytes.push(b'\n');
        }
        self.check()
    }

    fn placement(&mut self, scene: &Scene) -> Result<(), ExportError> {
        let m = glam::Mat4::from(scene.placement);
        // USD multiplies rows: its rows are our columns. Shortest exact text: angles want more than five decimals.
        let rows = m.to_cols_array_2d().map(|r| format!("({}, {}, {}, {})", r[0], r[1], r[2], r[3]));
        self.line(1, &format!("matrix4d xformOp:transform = ({})", rows.join(", ")))?;
        self.line(1, "uniform token[] xformOpOrder = [\"xformOp:transform\"]")
    }

    /// `head = [a, b, ...]` with `item` writing each one, in parallel pieces; `tail` follows the bracket.
    fn array<T: Sync>(
        &mut self,
        head: &str,
        items: &[T],
        item: impl Fn(&mut Vec<u8>, &T) + Sync,
        tail: &str,
        task: &Task,
    ) -> Result<(), ExportError> {
        self.list(&format!("        {head} = "), items, item, tail, task)
    }

    /// The same after any text; a line of its own.
    fn list<T: Sync>(
        &mut self,
        before: &str,
        items: &[T],
        item: impl Fn(&mut Vec<u8>, &T) + Sync,
        tail: &str,
        task: &Task,
    ) -> Result<(), ExportError> {
        self.bytes.extend_from_slice(before.as_bytes());
        self.bytes.push(b'[');
        // Some pieces at a time, so that the limit holds and no second copy of everything exists.
        for (k, some) in items.chunks(1 << 18).enumerate() {
            let pieces: Vec<Vec<u8>> = some
                .par_chunks(1 << 12)
                .map(|piece| {
                    task.check()?;
                    let mut out = Vec::new();
                    for (i, x) in piece.iter().enumerate() {
                        if i > 0 {
                            out.extend_from_slice(b", ");
                        }
                        item(&mut out, x);
                    }
                    Ok(out)
                })
                .collect::<Result<_, Cancelled>>()?;
            for (i, piece) in pieces.iter().enumerate() {
                if k + i > 0 {
                    self.bytes.extend_from_slice(b",\n");
                }
                self.bytes.extend_from_slice(piece);
            }
            self.check()?;
        }
        self.bytes.push(b']');
        self.bytes.extend_from_slice(tail.as_bytes());
        self.bytes.push(b'\n');
        self.check()
    }

    fn head(&mut self, kind: &str, name: &str, part: &Part, bounds: Bounds, binding: &str) -> Result<(), ExportError> {
        self.line(1, &format!("\ndef {kind} \"{name}\" (\n    prepend apiSchemas = [\"MaterialBindingAPI\"]\n)\n{{"))?;
        let (min, max) = (bounds.min.to_array(), bounds.max.to_array());
        if !bounds.is_empty() {
            self.line(2, &format!("float3[] extent = [{}, {}]", text::of(&min), text::of(&max)))?;
        }
        if !part.source.is_empty() {
            self.line(2, &format!("custom string coif:source = {}", quoted(&part.source)))?;
        }
        self.line(2, binding)
    }

    fn mesh(
        &mut self,
        name: &str,
        part: &Part,
        mesh: &Mesh,
        locks: Option<(&[Vec3], &[u32])>,
        binding: &str,
        task: &Task,
    ) -> Result<(), ExportError> {
        self.head("Mesh", name, part, mesh.bounds(), binding)?;
        self.line(2, "uniform token subdivisionScheme = \"none\"")?;
        if part.is_garment() {
            // Cloth is seen from inside too: in a sleeve, below a hem.
            self.line(2, "uniform bool doubleSided = 1")?;
        }
        let number = |out: &mut Vec<u8>, n: &u32| out.extend_from_slice(n.to_string().as_bytes());
        let triangle = |out: &mut Vec<u8>, t: &[u32; 3]| {
            out.extend_from_slice(format!("{}, {}, {}", t[0], t[1], t[2]).as_bytes());
        };
        self.array("int[] faceVertexCounts", &vec![3_u32; mesh.triangles.len()], number, "", task)?;
        self.array("int[] faceVertexIndices", &mesh.triangles, triangle, "", task)?;
        self.array("point3f[] points", &mesh.positions, |o, p| tuple(o, &p.to_array()), "", task)?;
        self.array("normal3f[] normals", &mesh.normals, |o, n| tuple(o, &n.to_array()), VERTEX, task)?;
        if let Some((colours, tufts)) = locks {
            self.array("color3f[] primvars:displayColor", colours, |o, c| tuple(o, &c.to_array()), VERTEX, task)?;
            self.array("int[] primvars:coif_tuft", tufts, number, VERTEX, task)?;
        }
        if !mesh.uvs.is_empty() {
            self.array("texCoord2f[] primvars:st", &mesh.uvs, |o, uv| tuple(o, &uv.to_array()), VERTEX, task)?;
        }
        self.mesh_moves(part, mesh, task)?;
        self.line(1, "}")
    }

    fn curves(
        &mut self,
        name: &str,
        part: &Part,
        (strands, blocks, look): (&Strands, &[Block], &HairMaterial),
        is_guide: bool,
        binding: &str,
        task: &Task,
    ) -> Result<(), ExportError> {
        let each: Vec<(usize, &[u32])> = blocks.iter().flat_map(Block::strands).collect();
        let points = |nodes: &[u32]| -> Vec<glam::Vec3> { nodes.iter().map(|&n| strands.points[n as usize]).collect() };
        // Half the greatest width on every side, as USD itself computes it.
        let (widest, bounds) = (0.5 * look.width, strands.bounds());
        self.head("BasisCurves", name, part, if bounds.is_empty() { bounds } else { bounds.grown(widest) }, binding)?;
        if is_guide {
            self.line(2, "uniform token purpose = \"guide\"")?;
        }
        self.line(2, "uniform token type = \"linear\"\nuniform token wrap = \"nonperiodic\"")?;
        let sources: Vec<String> = strands.sources.iter().map(|s| quoted(s)).collect();
        self.line(2, &format!("custom string[] coif:sources = [{}]", sources.join(", ")))?;
        self.line(2, &format!("string[] primvars:groom_group_name = [{}] ({CONSTANT})", quoted(&part.name)))?;
        self.line(2, &format!("int[] primvars:groom_guide = [{}] ({CONSTANT})", u8::from(is_guide)))?;

        let number = |out: &mut Vec<u8>, n: usize| out.extend_from_slice(n.to_string().as_bytes());
        self.array("int[] curveVertexCounts", &each, |o, (_, nodes)| number(o, nodes.len()), "", task)?;
        let list = |o: &mut Vec<u8>, nodes: &[u32], write: &dyn Fn(&mut Vec<u8>, glam::Vec3, f32)| {
            let points = points(nodes);
            for (k, v) in appearance::shares(points.iter().copied()).enumerate() {
                if k > 0 {
                    o.extend_from_slice(b", ");
                }
                write(o, points[k], v);
            }
        };
        let point = |o: &mut Vec<u8>, p: glam::Vec3, _: f32| tuple(o, &p.to_array());
        let width = |o: &mut Vec<u8>, _: glam::Vec3, v: f32| decimal(o, appearance::width(look, v));
        self.array("point3f[] points", &each, |o, (_, nodes)| list(o, nodes, &point), "", task)?;
        self.array("float[] widths", &each, |o, (_, nodes)| list(o, nodes, &width), VERTEX, task)?;
        let middle = appearance::ramp(look, 0.5);
        let colour = |o: &mut Vec<u8>, i: usize| {
            tuple(o, &(middle * appearance::brightness(look, strands.roots[i].id)).to_array());
        };
        self.array("color3f[] primvars:displayColor", &each, |o, &(i, _)| colour(o, i), UNIFORM, task)?;
        for uv in [
            "texCoord2f[] primvars:st",
            "float2[] primvars:surface_uv_coordinate",
            "texCoord2f[] primvars:groom_root_uv",
        ] {
            self.array(uv, &each, |o, &(i, _)| tuple(o, &strands.roots[i].uv.to_array()), UNIFORM, task)?;
        }
        self.array("int[] primvars:groom_id", &each, |o, &(i, _)| number(o, i), UNIFORM, task)?;
        self.array(
            "int[] primvars:coif_guide",
            &each,
            |o, &(i, _)| number(o, strands.guide[i] as usize),
            UNIFORM,
            task,
        )?;
        let source = |o: &mut Vec<u8>, i: usize| number(o, usize::from(strands.source[i]));
        self.array("int[] primvars:coif_source", &each, |o, &(i, _)| source(o, i), UNIFORM, task)?;
        self.curves_move(part, &each, is_guide, widest, task)?;
        self.line(1, "}")
    }

    fn materials(&mut self, root: &str, looks: &str, materials: &[Material]) -> Result<(), ExportError> {
        self.line(1, &format!("\ndef Scope \"{looks}\"\n{{"))?;
        for Material { name, inputs, fallback } in materials {
            self.line(2, &format!("def Material \"{name}\"\n{{"))?;
            let path = format!("{root}/{looks}/{name}");
            let surface = format!("</{path}/Surface.outputs:surface>");
            self.line(3, &format!("token outputs:surface.connect = {surface}\n\ndef Shader \"Surface\"\n{{"))?;
            let inputs = match fallback {
                Some(_) => inputs
                    .lines()
                    .map(|line| match line.starts_with("color3f inputs:diffuseColor") {
                        true => format!("color3f inputs:diffuseColor.connect = </{path}/Colour.outputs:result>"),
                        false => line.to_owned(),
                    })
                    .collect::<Vec<_>>()
                    .join("\n"),
                None => inputs.clone(),
            };
            self.line(4, &format!("uniform token info:id = \"UsdPreviewSurface\"\n{inputs}\ntoken outputs:surface"))?;
            self.line(3, "}")?;
            if let Some(colour) = fallback {
                // Each tuft has its own colour, from root to tip.
                self.line(3, "\ndef Shader \"Colour\"\n{")?;
                let fallback = text::of(&colour.to_array());
                self.line(
                    4,
                    &format!(
                        "uniform token info:id = \"UsdPrimvarReader_float3\"\nfloat3 inputs:fallback = {fallback}\n\
                         string inputs:varname = \"displayColor\"\nfloat3 outputs:result"
                    ),
                )?;
                self.line(3, "}")?;
            }
            self.line(2, "}")?;
        }
        self.line(1, "}")
    }
}

const CONSTANT: &str = "interpolation = \"constant\"";
const UNIFORM: &str = " (interpolation = \"uniform\")";
const VERTEX: &str = " (interpolation = \"vertex\")";
