//! Strands that follow joints: nodes, a skin, what every vertex follows, and the keys of the joints.

use glam::{Affine3A, Mat4, Quat, Vec3};

use super::chains::{Along, Chain, Chains, Hair, Way, sixteenth};
use super::document::{self as json, Accessor, Node, Skin};
use super::shapes::{Drawn, METRES};
use super::{File, Job, Place};
use crate::geometry::Strands;

/// Strands as they are drawn, frame by frame, with the guides that they follow.
pub struct Tracked<'a> {
    drawn: &'a Drawn<'a>,
    is_ribbons: bool,
    /// Per frame: the strands, and what leads to the carrier's space.
    frames: Vec<(&'a Strands, Affine3A)>,
    /// The guides at rest and at each frame; none when they are the strands, or do not move.
    guides: Option<(&'a Strands, Vec<&'a Strands>)>,
    /// Per strand its drawn nodes, and how many come before them; one entry more at the end.
    nodes: Vec<(&'a [u32], usize)>,
}

impl<'a> Tracked<'a> {
    pub fn new(
        drawn: &'a Drawn<'a>,
        is_ribbons: bool,
        frames: Vec<(&'a Strands, Affine3A)>,
        guides: Option<(&'a Strands, Vec<&'a Strands>)>,
    ) -> Self {
        let mut nodes = Vec::with_capacity(drawn.strands.count() + 1);
        let mut first = 0;
        for block in &drawn.blocks {
            for (_, kept) in block.strands() {
                nodes.push((kept, first));
                first += kept.len();
            }
        }
        nodes.push((&[][..], first));
        Self { drawn, is_ribbons, frames, guides, nodes }
    }
}

impl Hair for Tracked<'_> {
    fn count(&self) -> usize {
        self.nodes.len() - 1
    }

    fn guides(&self) -> usize {
        self.guides.as_ref().map_or(0, |(rest, _)| rest.count())
    }

    fn guide(&self, strand: usize) -> Option<usize> {
        self.drawn.strands.guide.get(strand).map(|&g| g as usize)
    }

    fn way(&self, along: Along) -> Way {
        let moved = |points: &[Vec3], by: &Affine3A| points.iter().map(|p| by.transform_point3(*p)).collect();
        match (along, &self.guides) {
            (Along::Guide(g), Some((rest, frames))) => Way {
                rest: rest.strand(g).to_vec(),
                frames: frames.iter().zip(&self.frames).map(|(f, (_, by))| moved(f.strand(g), by)).collect(),
            },
            (Along::Guide(s) | Along::Strand(s), _) => Way {
                rest: self.drawn.strands.strand(s).to_vec(),
                frames: self.frames.iter().map(|(f, by)| moved(f.strand(s), by)).collect(),
            },
        }
    }

    fn drawn(&self, strand: usize) -> Way {
        let nodes = self.nodes[strand].0;
        let of =
            |points: &[Vec3], by: &Affine3A| nodes.iter().map(|&n| by.transform_point3(points[n as usize])).collect();
        Way {
            rest: of(&self.drawn.strands.points, &Affine3A::IDENTITY),
            frames: self.frames.iter().map(|(f, by)| of(&f.points, by)).collect(),
        }
    }

    fn first(&self, strand: usize) -> usize {
        self.nodes[strand].1
    }

    fn vertices(&self, strand: usize, drawn: &Way) -> Way {
        if self.is_ribbons { self.drawn.ribbon_way(strand, drawn) } else { drawn.clone() }
    }

    fn each(&self) -> usize {
        if self.is_ribbons { 2 } else { 1 }
    }
}

/// Floats of one block that are read as many lists.
#[derive(Default)]
struct Numbers(Vec<u8>);

impl Numbers {
    /// Adds some; where they begin.
    fn add(&mut self, numbers: impl IntoIterator<Item = f32>) -> u64 {
        let at = self.0.len() as u64;
        self.0.extend(numbers.into_iter().flat_map(f32::to_le_bytes));
        at
    }
}

impl File<'_> {
    /// Makes a mesh follow chains: joints below the node that carried it, which a mesh with a skin must not be below.
    pub(super) fn skin(&mut self, place: Place, chains: &Chains, each: usize, rate: f32) {
        let Some(mesh) = place.mesh else { return };
        let name = self.document.nodes[place.node as usize].name.clone();
        let group = self.document.nodes.len() as u32;
        self.document.nodes.push(Node { name: format!("{name} joints"), ..Node::default() });
        let parent = &mut self.document.nodes[place.parent as usize];
        parent.children.retain(|&c| c != place.node);
        parent.children.push(group);
        self.document.scenes[0].nodes.push(place.node);

        let mut joints = vec![];
        let mut numbers = Numbers::default();
        let mut tracks = vec![];
        for chain in &chains.chains {
            let first = self.document.nodes.len() as u32;
            for (k, rest) in chain.rest.iter().enumerate() {
                let (before, turn) = match k {
                    0 => (Vec3::ZERO, Quat::IDENTITY),
                    _ => (chain.rest[k - 1].shift, chain.rest[k - 1].turn.inverse()),
                };
                let index = self.document.nodes.len() as u32;
                self.document.nodes.push(Node {
                    name: joint_name(&name, chain, k),
                    translation: Some((turn * (rest.shift - before) * METRES).to_array()),
                    rotation: Some((turn * rest.turn).normalize().to_array()),
                    ..Node::default()
                });
                let above = if k == 0 { group } else { index - 1 };
                self.document.nodes[above as usize].children.push(index);
                joints.push(index);
            }
            if chain.keys.len() < 2 {
                continue;
            }
            let times: Vec<f32> = chain.keys.iter().map(|&f| f as f32 / rate).collect();
            let span = (f64::from(times[0]), f64::from(times[times.len() - 1]));
            let times = (numbers.add(times), chain.keys.len(), span);
            for k in 0..chain.rest.len() {
                let node = first + k as u32;
                if let Some(turns) = &chain.turns[k] {
                    let at = numbers.0.len() as u64;
                    numbers.0.extend(turns.iter().flat_map(|t| sixteenth(*t).0).flat_map(i16::to_le_bytes));
                    tracks.push((node, "rotation", "VEC4", times, at));
                }
                if let Some(shifts) = &chain.shifts[k] {
                    let at = numbers.add(shifts.iter().flat_map(|s| (*s * METRES).to_array()));
                    tracks.push((node, "translation", "VEC3", times, at));
                }
            }
        }
        let matrices: Vec<u8> = chains
            .chains
            .iter()
            .flat_map(|c| &c.rest)
            .flat_map(|rest| {
                let metric = Affine3A::from_rotation_translation(rest.turn, rest.shift * METRES);
                let mut matrix = Mat4::from(metric.inverse()).to_cols_array();
                // Exactly so, whatever rounding says.
                (matrix[3], matrix[7], matrix[11], matrix[15]) = (0.0, 0.0, 0.0, 1.0);
                matrix
            })
            .flat_map(f32::to_le_bytes)
            .collect();
        let matrices = self.block(matrices, None);
        let inverse_bind_matrices = self.list(matrices, 0, json::F32, joints.len(), "MAT4");
        let skin = Skin { name: format!("{name} joints"), inverse_bind_matrices, skeleton: group, joints };
        self.document.skins.push(skin);
        self.document.nodes[place.node as usize].skin = Some(self.document.skins.len() as u32 - 1);

        // What every vertex follows
        let vertices = || chains.followed.iter().flat_map(|f| std::iter::repeat_n(f, each));
        let count = chains.followed.len() * each;
        let indices = vertices().flat_map(|f| f.joints).flat_map(u16::to_le_bytes).collect();
        let weights = vertices().flat_map(|f| f.weights).flat_map(u16::to_le_bytes).collect();
        let indices = self.block(indices, Some(json::VERTICES));
        let weights = self.block(weights, Some(json::VERTICES));
        let indices = self.list(indices, 0, json::U16, count, "VEC4");
        let weights = self.list(weights, 0, json::U16, count, "VEC4");
        self.document.accessors[weights as usize].normalized = true;
        if let Some(primitive) = self.document.meshes[mesh as usize].primitives.first_mut() {
            primitive.attributes.extend([("JOINTS_0", indices), ("WEIGHTS_0", weights)]);
        }

        // Keys
        if tracks.is_empty() {
            return;
        }
        let view = self.block(numbers.0, None);
        let mut inputs: Option<(u64, u32)> = None;
        for (node, path, shape, (at, keys, span), output) in tracks {
            let input = match inputs {
                Some((from, input)) if from == at => input,
                _ => {
                    let input = self.list(view, at, json::F32, keys, "SCALAR");
                    let entry = &mut self.document.accessors[input as usize];
                    (entry.min, entry.max) = (Some(vec![span.0]), Some(vec![span.1]));
                    inputs = Some((at, input));
                    input
                }
            };
            let kind = if path == "rotation" { json::I16 } else { json::F32 };
            let output = self.list(view, output, kind, keys, shape);
            self.document.accessors[output as usize].normalized = kind == json::I16;
            self.channel(node, path, input, output);
        }
    }

    fn block(&mut self, bytes: Vec<u8>, target: Option<u32>) -> u32 {
        let (place, view) = self.plan.aimed(&mut self.document, bytes.len(), target);
        self.jobs.push(Job::Blob(bytes, place));
        view
    }

    /// A list within a block.
    fn list(&mut self, view: u32, byte_offset: u64, component_type: u32, count: usize, shape: &'static str) -> u32 {
        let (buffer_view, normalized, count) = (Some(view), false, count as u64);
        let (min, max, sparse) = (None, None, None);
        let accessor =
            Accessor { buffer_view, byte_offset, component_type, normalized, count, shape, min, max, sparse };
        self.document.accessors.push(accessor);
        self.document.accessors.len() as u32 - 1
    }
}

/// `hair guide 12.3`: the part, what the chain lies along, and the joint, all counted from 1.
fn joint_name(part: &str, chain: &Chain, joint: usize) -> String {
    match chain.along {
        Along::Guide(g) => format!("{part} guide {}.{}", g + 1, joint + 1),
        Along::Strand(s) => format!("{part} strand {}.{}", s + 1, joint + 1),
    }
}
