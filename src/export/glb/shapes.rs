//! Filling the buffer: surfaces, ribbons, lines.

use glam::{Affine3A, Vec3};
use rayon::prelude::*;

use super::basis::Vertices;
use super::buffer::{Attribute, Pen, Slot};
use super::chains::Way;
use super::document as json;
use super::frames::{Frame, moved, ribbon};
use crate::export::appearance;
use crate::export::reduce::Block;
use crate::geometry::{Bounds, Mesh, Strands};
use crate::scene::HairMaterial;
use crate::task::{Cancelled, Task};

/// Metres in a centimetre.
pub const METRES: f32 = 0.01;

/// What strands carry in both shapes: diameter in metres, index of the strand in its part, index of its guide in the
/// part's guides. As floats, which every program reads and which are exact up to 2^24; more strands than that do not
/// fit into a GLB.
const WIDTH: Attribute = Attribute::floats("_WIDTH", 1);
const STRAND: Attribute = Attribute::floats("_STRAND_ID", 1);
const GUIDE: Attribute = Attribute::floats("_GUIDE_ID", 1);
/// Index into the node's list of sources.
const SOURCE: Attribute = Attribute::floats("_SOURCE", 1);

/// Strands as they are drawn.
pub struct Drawn<'a> {
    /// All of them.
    pub strands: &'a Strands,
    /// Their kept nodes.
    pub blocks: Vec<Block>,
    /// How they look.
    pub look: &'a HairMaterial,
    /// Per kept node how far it is written from its place, cm; none for not at all.
    pub shifts: Vec<Vec3>,
}

impl Drawn<'_> {
    fn shift(&self, node: usize) -> Vec3 {
        self.shifts.get(node).copied().unwrap_or_default()
    }

    fn has_sources(&self) -> bool {
        self.strands.sources.len() > 1
    }

    /// (strands, kept nodes)
    fn counts(&self) -> (u64, u64) {
        let nodes = self.blocks.iter().map(|b| b.nodes.len() as u64).sum();
        (self.strands.count() as u64, nodes)
    }

    /// Ribbons: (attributes, vertices, indices).
    pub fn ribbon_layout(&self) -> (Vec<Attribute>, u64, u64) {
        let mut attributes = vec![
            Attribute::floats("POSITION", 3),
            Attribute::floats("NORMAL", 3),
            Attribute::floats("TANGENT", 4),
            Attribute { name: "TEXCOORD_0", component: json::U16, normalized: true, shape: "VEC2", size: 4 },
            Attribute { name: "COLOR_0", component: json::U8, normalized: true, shape: "VEC4", size: 4 },
            WIDTH,
            STRAND,
            GUIDE,
        ];
        attributes.extend(self.has_sources().then_some(SOURCE));
        let (strands, nodes) = self.counts();
        (attributes, 2 * nodes, 6 * (nodes - strands))
    }

    /// Lines: (attributes, vertices, indices).
    pub fn line_layout(&self) -> (Vec<Attribute>, u64, u64) {
        let mut attributes = vec![
            Attribute::floats("POSITION", 3),
            // Linear and dark: eight bits would show steps.
            Attribute { name: "COLOR_0", component: json::U16, normalized: true, shape: "VEC4", size: 8 },
            WIDTH,
            STRAND,
            GUIDE,
        ];
        attributes.extend(self.has_sources().then_some(SOURCE));
        let (strands, nodes) = self.counts();
        (attributes, nodes, 2 * (nodes - strands))
    }

    /// Writes ribbons; bounds of the positions in metres.
    pub fn write_ribbons(&self, bytes: &mut [u8], slot: &Slot, task: &Task) -> Result<Bounds, Cancelled> {
        self.write(bytes, slot, (2, 6), task, |strand, nodes, first, vertices, indices, scratch| {
            let root = &self.strands.roots[strand];
            ribbon(nodes.iter().map(|&n| self.strands.points[n as usize]), root.normal, scratch);
            let shade =
                (appearance::brightness(self.look, root.id) / appearance::brightest(self.look) * 255.0).round() as u8;
            let mut bounds = Bounds::EMPTY;
            for (k, f) in scratch.iter().enumerate() {
                let width = appearance::width(self.look, f.v);
                let shift = self.shift(first as usize / 2 + k);
                // Seen from outside with the root below, u runs from left to right.
                let side = f.tangent.cross(f.normal) * (0.5 * width);
                for (u, position) in [(0.0, f.position - side), (1.0, f.position + side)] {
                    let position = (position + shift) * METRES;
                    bounds = Bounds { min: bounds.min.min(position), max: bounds.max.max(position) };
                    vertices.vec3(position);
                    vertices.vec3(f.normal);
                    vertices.vec3(f.tangent);
                    // normal x tangent points to smaller u; the fourth number makes the bitangent run with u.
                    vertices.float(-1.0);
                    vertices.fraction(u);
                    vertices.fraction(f.v);
                    vertices.bytes([shade, shade, shade, 255]);
                    vertices.float(width * METRES);
                    self.write_identity(strand, vertices);
                }
            }
            for k in 0..nodes.len() as u32 - 1 {
                let [a, b, c, d] = [0, 1, 2, 3].map(|i| first + 2 * k + i);
                for i in [a, b, d, a, d, c] {
                    indices.index(i);
                }
            }
            bounds
        })
    }

    /// Writes lines; bounds of the positions in metres.
    pub fn write_lines(&self, bytes: &mut [u8], slot: &Slot, task: &Task) -> Result<Bounds, Cancelled> {
        let (root_colour, tip_colour) = (appearance::ramp(self.look, 0.0), appearance::ramp(self.look, 1.0));
        self.write(bytes, slot, (1, 2), task, |strand, nodes, first, vertices, indices, _| {
            let points = nodes.iter().map(|&n| self.strands.points[n as usize]);
            let mut bounds = Bounds::EMPTY;
            for (k, (p, v)) in points.clone().zip(appearance::shares(points)).enumerate() {
                let position = (p + self.shift(first as usize + k)) * METRES;
                bounds = Bounds { min: bounds.min.min(position), max: bounds.max.max(position) };
                vertices.vec3(position);
                for channel in root_colour.lerp(tip_colour, v).to_array() {
                    vertices.fraction(channel);
                }
                vertices.fraction(1.0);
                vertices.float(appearance::width(self.look, v) * METRES);
                self.write_identity(strand, vertices);
            }
            for k in first..first + nodes.len() as u32 - 1 {
                indices.index(k);
                indices.index(k + 1);
            }
            bounds
        })
    }

    /// All vertices of ribbons, or of lines, in the order of the file: at rest, or where the strands of a frame, moved by
    /// a transform, have them.
    pub fn vertices(&self, is_ribbons: bool, at: Option<(&Strands, &Affine3A)>) -> Vertices {
        let point = |n: u32| match at {
            Some((strands, by)) => by.transform_point3(strands.points[n as usize]),
            None => self.strands.points[n as usize],
        };
        let blocks: Vec<Vertices> = self
            .blocks
            .par_iter()
            .map(|block| {
                let (mut rest, mut now, mut out) = (Vec::new(), Vec::new(), Vertices::default());
                for (strand, nodes) in block.strands() {
                    if !is_ribbons {
                        out.positions.extend(nodes.iter().map(|&n| point(n)));
                        continue;
                    }
                    let still = nodes.iter().map(|&n| self.strands.points[n as usize]);
                    ribbon(still, self.strands.roots[strand].normal, &mut rest);
                    if at.is_some() {
                        moved(&rest, nodes.iter().map(|&n| point(n)), &mut now);
                    }
                    for f in if at.is_some() { &now } else { &rest } {
                        out.positions.extend(self.edges(f));
                        out.normals.extend([f.normal; 2]);
                    }
                }
                out
            })
            .collect();
        let mut all = Vertices::default();
        for block in blocks {
            all.positions.extend(block.positions);
            all.normals.extend(block.normals);
        }
        all
    }

    /// The two vertices of a ribbon's node.
    fn edges(&self, f: &Frame) -> [Vec3; 2] {
        let side = f.tangent.cross(f.normal) * (0.5 * appearance::width(self.look, f.v));
        [f.position - side, f.position + side]
    }

    /// The vertices of one strand's ribbon, at rest and at each frame, from its drawn nodes.
    pub fn ribbon_way(&self, strand: usize, drawn: &Way) -> Way {
        let (mut rest, mut now) = (Vec::new(), Vec::new());
        ribbon(drawn.rest.iter().copied(), self.strands.roots[strand].normal, &mut rest);
        let frame = |points: &Vec<Vec3>| {
            moved(&rest, points.iter().copied(), &mut now);
            now.iter().flat_map(|f| self.edges(f)).collect()
        };
        Way {
            frames: drawn.frames.iter().map(frame).collect(),
            rest: rest.iter().flat_map(|f| self.edges(f)).collect(),
        }
    }

    fn write_identity(&self, strand: usize, vertices: &mut Pen) {
        vertices.float(strand as f32);
        vertices.float(self.strands.guide[strand] as f32);
        if self.has_sources() {
            vertices.float(f32::from(self.strands.source[strand]));
        }
    }

    /// Runs `strand` for all strands, blocks in parallel, each with its own piece of the buffer: (index of the strand,
    /// kept nodes, its first vertex, vertices, indices, scratch) to bounds. A node has `per.0` vertices, a segment
    /// `per.1` indices.
    fn write(
        &self,
        bytes: &mut [u8],
        slot: &Slot,
        per: (usize, usize),
        task: &Task,
        strand: impl Fn(usize, &[u32], u32, &mut Pen, &mut Pen, &mut Vec<Frame>) -> Bounds + Sync,
    ) -> Result<Bounds, Cancelled> {
        let (mut vertices, mut indices) = bytes[slot.bytes.clone()].split_at_mut(slot.vertex_bytes);
        let mut first = 0;
        let mut pieces = Vec::with_capacity(self.blocks.len());
        for block in &self.blocks {
            let (nodes, segments) = (block.nodes.len(), block.nodes.len() - block.ends.len());
            let (v, rest) = vertices.split_at_mut(nodes * per.0 * slot.stride);
            let (i, more) = indices.split_at_mut(segments * per.1 * 4);
            (vertices, indices) = (rest, more);
            pieces.push((block, first, Pen(v), Pen(i)));
            first += (nodes * per.0) as u32;
        }
        pieces
            .into_par_iter()
            .map(|(block, mut first, mut vertices, mut indices)| {
                task.check()?;
                let mut scratch = Vec::new();
                let mut bounds = Bounds::EMPTY;
                for (i, nodes) in block.strands() {
                    bounds = bounds.union(strand(i, nodes, first, &mut vertices, &mut indices, &mut scratch));
                    first += (nodes.len() * per.0) as u32;
                }
                debug_assert!(vertices.0.is_empty() && indices.0.is_empty());
                Ok(bounds)
            })
            .try_reduce(|| Bounds::EMPTY, |a, b| Ok(a.union(b)))
    }
}

/// Surfaces: (attributes, vertices, indices).
pub fn surface_layout(mesh: &Mesh) -> (Vec<Attribute>, u64, u64) {
    let mut attributes = vec![Attribute::floats("POSITION", 3), Attribute::floats("NORMAL", 3)];
    if !mesh.uvs.is_empty() {
        attributes.push(Attribute::floats("TEXCOORD_0", 2));
    }
    (attributes, mesh.positions.len() as u64, 3 * mesh.triangles.len() as u64)
}

/// Writes a surface that has normals; bounds of the positions in metres.
pub fn write_surface(mesh: &Mesh, bytes: &mut [u8], slot: &Slot) -> Bounds {
    let (vertices, indices) = bytes[slot.bytes.clone()].split_at_mut(slot.vertex_bytes);
    let (mut vertices, mut indices) = (Pen(vertices), Pen(indices));
    let mut bounds = Bounds::EMPTY;
    for (i, (p, n)) in mesh.positions.iter().zip(&mesh.normals).enumerate() {
        let position = *p * METRES;
        bounds = Bounds { min: bounds.min.min(position), max: bounds.max.max(position) };
        vertices.vec3(position);
        vertices.vec3(n.try_normalize().unwrap_or(Vec3::Y));
        if let Some(uv) = mesh.uvs.get(i) {
            // glTF counts v from the top of the picture.
            let uv = if uv.is_finite() { *uv } else { glam::Vec2::ZERO };
            vertices.float(uv.x);
            vertices.float(1.0 - uv.y);
        }
    }
    for i in mesh.triangles.iter().flatten() {
        indices.index(*i);
    }
    bounds
}
