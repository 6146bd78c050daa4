//! The JSON of a glTF 2.0 file: only what Coif writes, in the order it is written.

use serde::Serialize;

/// `ARRAY_BUFFER`.
pub const VERTICES: u32 = 34962;
/// `ELEMENT_ARRAY_BUFFER`.
pub const INDICES: u32 = 34963;
/// Component type `UNSIGNED_BYTE`.
pub const U8: u32 = 5121;
/// Component type `SHORT`.
pub const I16: u32 = 5122;
/// Component type `UNSIGNED_SHORT`.
pub const U16: u32 = 5123;
/// Component type `UNSIGNED_INT`.
pub const U32: u32 = 5125;
/// Component type `FLOAT`.
pub const F32: u32 = 5126;
/// Primitive mode `LINES`.
pub const LINES: u32 = 1;
/// Primitive mode `TRIANGLES`.
pub const TRIANGLES: u32 = 4;

#[derive(Serialize, Default)]
#[serde(rename_all = "camelCase")]
pub struct Document {
    pub asset: Asset,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub extensions_used: Vec<&'static str>,
    pub scene: u32,
    pub scenes: Vec<SceneNodes>,
    pub nodes: Vec<Node>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub meshes: Vec<MeshEntry>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub skins: Vec<Skin>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub animations: Vec<Animation>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub materials: Vec<Material>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub textures: Vec<Texture>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub images: Vec<Image>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub samplers: Vec<Sampler>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub accessors: Vec<Accessor>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub buffer_views: Vec<BufferView>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub buffers: Vec<Buffer>,
}

impl Document {
    /// The text of the JSON chunk.
    pub fn to_json(&self) -> Vec<u8> {
        // Plain structs with texts for keys, written to memory: nothing can fail.
        serde_json::to_vec(self).unwrap_or_default()
    }
}

#[derive(Serialize)]
pub struct Asset {
    pub version: &'static str,
    pub generator: &'static str,
}

impl Default for Asset {
    fn default() -> Self {
        Self { version: "2.0", generator: concat!("coif ", env!("CARGO_PKG_VERSION")) }
    }
}

#[derive(Serialize)]
pub struct SceneNodes {
    pub name: String,
    pub nodes: Vec<u32>,
}

#[derive(Serialize, Default)]
pub struct Node {
    pub name: String,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub children: Vec<u32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mesh: Option<u32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub skin: Option<u32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub translation: Option<[f32; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rotation: Option<[f32; 4]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scale: Option<[f32; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub extras: Option<Extras<PartExtras>>,
}

/// Coif's own entries, under its name, beside those of other programs.
#[derive(Serialize)]
pub struct Extras<T> {
    pub coif: T,
}

/// Where a part comes from and what it holds.
#[derive(Serialize, Default)]
pub struct PartExtras {
    /// What it is: `head`, `hair`, `guides`, `tufts`, `cap`, `bun` or `ring`.
    pub kind: &'static str,
    /// Place in the script that made the part.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub source: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub strands: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub guides: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tufts: Option<usize>,
    /// Places in the script that made strands or tufts; the attribute `_SOURCE` is an index into it, 0 where it is missing.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub sources: Vec<String>,
    /// No strand is farther than this from what is drawn of it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tolerance_cm: Option<f32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub motion: Option<MotionExtras>,
}

/// Joints, and where they are when the mesh is at rest.
#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Skin {
    pub name: String,
    pub inverse_bind_matrices: u32,
    pub skeleton: u32,
    pub joints: Vec<u32>,
}

/// How near the animation is to the motion that it was made from.
#[derive(Serialize, Clone, Debug)]
pub struct MotionExtras {
    /// What moves it: `node`, `shapes` or `joints`.
    pub form: &'static str,
    /// Frames of the motion.
    pub frames: usize,
    /// Of these in a second.
    pub rate: f32,
    /// True when the first follows the last.
    pub looped: bool,
    /// Morph targets.
    pub shapes: usize,
    /// Joints, and the chains that they make up.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub joints: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub chains: Option<usize>,
    /// About the bytes that the motion takes.
    pub bytes: usize,
    /// Frames that have keys; of chains, those of the one that has most.
    pub keys: usize,
    /// No vertex is farther than this from its place at any frame.
    pub error_cm: f32,
}

#[derive(Serialize)]
pub struct MeshEntry {
    pub name: String,
    pub primitives: Vec<Primitive>,
    /// One for each morph target.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub weights: Vec<f32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub extras: Option<MeshExtras>,
}

/// What Blender and three.js take the names of morph targets from.
#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
pub struct MeshExtras {
    pub target_names: Vec<String>,
}

/// One animation: everything that moves, at once.
#[derive(Serialize)]
pub struct Animation {
    pub name: String,
    pub channels: Vec<Channel>,
    pub samplers: Vec<AnimationSampler>,
}

#[derive(Serialize)]
pub struct Channel {
    pub sampler: u32,
    pub target: Target,
}

#[derive(Serialize)]
pub struct Target {
    pub node: u32,
    /// `translation`, `rotation` or `weights`.
    pub path: &'static str,
}

#[derive(Serialize)]
/// Linear interpolation, as when nothing is said.
pub struct AnimationSampler {
    /// The accessor of the times, seconds.
    pub input: u32,
    pub output: u32,
}

#[derive(Serialize)]
pub struct Primitive {
    #[serde(serialize_with = "in_order")]
    pub attributes: Vec<(&'static str, u32)>,
    pub indices: u32,
    pub material: u32,
    pub mode: u32,
    #[serde(skip_serializing_if = "Vec::is_empty", serialize_with = "each_in_order")]
    pub targets: Vec<Vec<(&'static str, u32)>>,
}

fn each_in_order<S: serde::Serializer>(targets: &[Vec<(&'static str, u32)>], serializer: S) -> Result<S::Ok, S::Error> {
    struct Target<'a>(&'a [(&'static str, u32)]);
    impl Serialize for Target<'_> {
        fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
            in_order(self.0, serializer)
        }
    }
    serializer.collect_seq(targets.iter().map(|t| Target(t)))
}

fn in_order<S: serde::Serializer>(pairs: &[(&'static str, u32)], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_map(pairs.iter().copied())
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Material {
    pub name: String,
    pub pbr_metallic_roughness: Pbr,
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub double_sided: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub extensions: Option<MaterialExtensions>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub extras: Option<Extras<HairExtras>>,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Pbr {
    pub base_color_factor: [f32; 4],
    #[serde(skip_serializing_if = "Option::is_none")]
    pub base_color_texture: Option<TextureInfo>,
    pub metallic_factor: f32,
    pub roughness_factor: f32,
}

#[derive(Serialize)]
pub struct TextureInfo {
    pub index: u32,
}

#[derive(Serialize, Default)]
pub struct MaterialExtensions {
    #[serde(rename = "KHR_materials_anisotropy", skip_serializing_if = "Option::is_none")]
    pub anisotropy: Option<Anisotropy>,
    #[serde(rename = "KHR_materials_unlit", skip_serializing_if = "Option::is_none")]
    pub unlit: Option<Unlit>,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Anisotropy {
    pub anisotropy_strength: f32,
    pub anisotropy_rotation: f32,
}

#[derive(Serialize)]
pub struct Unlit {}

/// The script's own words for the hair's look.
#[derive(Serialize)]
pub struct HairExtras {
    pub root_colour: String,
    pub tip_colour: String,
    pub variation: f32,
    pub width_cm: f32,
    pub taper: f32,
}

#[derive(Serialize)]
pub struct Texture {
    pub sampler: u32,
    pub source: u32,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Image {
    pub name: String,
    pub buffer_view: u32,
    pub mime_type: &'static str,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Sampler {
    pub mag_filter: u32,
    pub min_filter: u32,
    pub wrap_s: u32,
    pub wrap_t: u32,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Accessor {
    /// None for zeros.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub buffer_view: Option<u32>,
    #[serde(skip_serializing_if = "is_zero")]
    pub byte_offset: u64,
    pub component_type: u32,
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub normalized: bool,
    pub count: u64,
    #[serde(rename = "type")]
    pub shape: &'static str,
    /// As doubles: the shortest text of a float is another number than the float in the buffer.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub min: Option<Vec<f64>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max: Option<Vec<f64>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sparse: Option<Sparse>,
}

/// Entries that are not zero.
#[derive(Serialize)]
pub struct Sparse {
    pub count: u64,
    pub indices: SparseIndices,
    pub values: SparseValues,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
pub struct SparseIndices {
    pub buffer_view: u32,
    pub component_type: u32,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
pub struct SparseValues {
    pub buffer_view: u32,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
pub struct BufferView {
    pub buffer: u32,
    #[serde(skip_serializing_if = "is_zero")]
    pub byte_offset: u64,
    pub byte_length: u64,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub byte_stride: Option<u32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub target: Option<u32>,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Buffer {
    pub byte_length: u64,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde's signature")]
fn is_zero(n: &u64) -> bool {
    *n == 0
}
