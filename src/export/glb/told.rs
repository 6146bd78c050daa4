//! What a file says about its own motion.

use serde::Deserialize;

/// How a part of a file moves.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct PartMotion {
    /// The name of the part.
    #[serde(skip)]
    pub part: String,
    /// What moves it: `node`, `shapes` or `joints`.
    pub form: String,
    /// Frames of the motion.
    pub frames: usize,
    /// Morph targets.
    pub shapes: usize,
    /// Joints.
    #[serde(default)]
    pub joints: usize,
    /// The chains that the joints make up.
    #[serde(default)]
    pub chains: usize,
    /// About the bytes that the motion takes.
    pub bytes: usize,
    /// Frames that have keys; of chains, those of the one that has most.
    pub keys: usize,
    /// No vertex is farther than this from its place at any frame, cm.
    pub error_cm: f32,
}

/// The motions that a GLB of Coif tells of, part by part; none for a scene that does not move, or another file.
pub fn motions(file: &[u8]) -> Vec<PartMotion> {
    #[derive(Deserialize)]
    struct Document {
        #[serde(default)]
        nodes: Vec<Node>,
    }
    #[derive(Deserialize)]
    struct Node {
        #[serde(default)]
        name: String,
        #[serde(default)]
        extras: Option<Extras>,
    }
    #[derive(Deserialize)]
    struct Extras {
        coif: Option<Coif>,
    }
    #[derive(Deserialize)]
    struct Coif {
        motion: Option<PartMotion>,
    }
    let length = file.get(12..16).and_then(|l| l.try_into().ok()).map_or(0, u32::from_le_bytes) as usize;
    let text = file.get(20..20 + length).unwrap_or_default();
    let document: Document = serde_json::from_slice(text).unwrap_or(Document { nodes: vec![] });
    let motion = |node: Node| Some(PartMotion { part: node.name, ..node.extras?.coif?.motion? });
    document.nodes.into_iter().filter_map(motion).collect()
}
