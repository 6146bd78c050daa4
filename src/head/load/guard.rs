//! Checks a glTF's JSON before the `gltf` crate reads it.
//!
//! That crate indexes lists by what the file says and asserts on sizes; so every index, count and byte range on the
//! way from the scene to the geometry is checked here first, against the JSON alone. What does not lead to geometry
//! (pictures, animations, cameras) is not looked at.

use super::schema::Root;
use super::{GltfProblem, LoadError, MAX_VERTICES};

const U8: u64 = 5121;
const U16: u64 = 5123;
const U32: u64 = 5125;
const F32: u64 = 5126;
/// The most entries of a sparse accessor that stands on zeros instead of data: nothing in the file pays for them.
const MAX_BARE: u64 = 1 << 20;

/// i8, u8, i16, u16, f32: what `KHR_mesh_quantization` allows.
const QUANTISED: &[u64] = &[5120, U8, 5122, U16, F32];

/// Parses and checks the JSON; afterwards the crate may follow any path from a scene to its geometry, as far as the
/// buffers marked `is_used` hold their `byte_length`.
pub(super) fn check(json: &[u8]) -> Result<Root, LoadError> {
    let mut root: Root = serde_json::from_slice(json).map_err(|e| json_error(&e))?;
    let version = root
        .asset
        .as_ref()
        .map(|a| a.version.clone())
        .ok_or_else(|| problem("asset", GltfProblem::Missing("version")))?;
    if !version.starts_with("2.") {
        return Err(problem("asset.version", GltfProblem::Unexpected { wanted: "2.0", got: short(&version) }));
    }
    if let Some(name) = root.extensions_required.iter().find(|name| !is_harmless(name)) {
        return Err(LoadError::Extension { name: short(name) });
    }
    root.is_used = vec![false; root.buffers.len()];
    root.tree()?;
    for s in 0..root.skins.len() {
        root.skin(s)?;
    }
    for m in 0..root.meshes.len() {
        for p in 0..root.meshes[m].primitives.len() {
            root.primitive(m, p)?;
        }
    }
    Ok(root)
}

pub(super) fn json_error(e: &serde_json::Error) -> LoadError {
    let text = e.to_string();
    let problem = text.rsplit_once(" at line ").map_or(text.as_str(), |(said, _)| said).to_owned();
    LoadError::Json { line: e.line(), column: e.column(), problem }
}

pub(super) fn problem(path: impl Into<String>, problem: GltfProblem) -> LoadError {
    LoadError::Gltf { path: path.into(), problem }
}

fn short(text: &str) -> String {
    text.chars().take(40).collect()
}

/// Extensions that leave the geometry as it is, or that are understood.
fn is_harmless(name: &str) -> bool {
    const STARTS: &[&str] = &[
        "KHR_materials_",
        "EXT_materials_",
        "KHR_texture_",
        "EXT_texture_",
        "MSFT_texture_",
        "KHR_lights_",
        "EXT_lights_",
        "VRM",
    ];
    const WHOLE: &[&str] = &["KHR_mesh_quantization", "KHR_animation_pointer", "KHR_xmp", "KHR_xmp_json_ld"];
    WHOLE.contains(&name) || STARTS.iter().any(|start| name.starts_with(start))
}

/// What an accessor must be.
struct Wanted {
    text: &'static str,
    shape: &'static str,
    components: &'static [u64],
}

const POSITION: Wanted = Wanted { text: "VEC3 of numbers", shape: "VEC3", components: QUANTISED };
const UV: Wanted = Wanted { text: "VEC2 of numbers", shape: "VEC2", components: QUANTISED };
const JOINTS: Wanted = Wanted { text: "VEC4 of u8 or u16", shape: "VEC4", components: &[U8, U16] };
const WEIGHTS: Wanted = Wanted { text: "VEC4 of f32, u8 or u16", shape: "VEC4", components: &[F32, U8, U16] };
const INDICES: Wanted = Wanted { text: "SCALAR of u8, u16 or u32", shape: "SCALAR", components: &[U8, U16, U32] };
const BINDS: Wanted = Wanted { text: "MAT4 of f32", shape: "MAT4", components: &[F32] };

fn within(index: u64, count: usize, what: &'static str, path: &dyn Fn() -> String) -> Result<usize, LoadError> {
    if index < count as u64 {
        return Ok(index as usize);
    }
    Err(problem(path(), GltfProblem::OutOfRange { what, index, count: count as u64 }))
}

impl Root {
    /// Nodes must be trees: at most one parent each, and no ring.
    fn tree(&self) -> Result<(), LoadError> {
        let mut has_parent = vec![false; self.nodes.len()];
        for (n, node) in self.nodes.iter().enumerate() {
            let path = |field: &str| format!("nodes[{n}].{field}");
            for &child in &node.children {
                let child = within(child, self.nodes.len(), "node", &|| path("children"))?;
                if std::mem::replace(&mut has_parent[child], true) {
                    return Err(problem(path("children"), GltfProblem::NotATree(child as u64)));
                }
            }
            if let Some(mesh) = node.mesh {
                within(mesh, self.meshes.len(), "mesh", &|| path("mesh"))?;
            }
            if let Some(skin) = node.skin {
                within(skin, self.skins.len(), "skin", &|| path("skin"))?;
            }
        }
        // With one parent each, what no root reaches goes in a ring.
        let mut is_reached = vec![false; self.nodes.len()];
        let mut open: Vec<usize> = (0..self.nodes.len()).filter(|&n| !has_parent[n]).collect();
        while let Some(n) = open.pop() {
            is_reached[n] = true;
            open.extend(self.nodes[n].children.iter().map(|&c| c as usize));
        }
        if let Some(n) = is_reached.iter().position(|&r| !r) {
            return Err(problem(format!("nodes[{n}]"), GltfProblem::NotATree(n as u64)));
        }
        for (s, scene) in self.scenes.iter().enumerate() {
            let path = || format!("scenes[{s}].nodes");
            let mut is_listed = vec![false; self.nodes.len()];
            for &node in &scene.nodes {
                let node = within(node, self.nodes.len(), "node", &path)?;
                if has_parent[node] || std::mem::replace(&mut is_listed[node], true) {
                    return Err(problem(path(), GltfProblem::NotATree(node as u64)));
                }
            }
        }
        if let Some(scene) = self.scene {
            within(scene, self.scenes.len(), "scene", &|| "scene".into())?;
        }
        Ok(())
    }

    fn skin(&mut self, s: usize) -> Result<(), LoadError> {
        let skin = &self.skins[s];
        let count = skin.joints.len() as u64;
        for &joint in &skin.joints {
            within(joint, self.nodes.len(), "node", &|| format!("skins[{s}].joints"))?;
        }
        if let Some(binds) = skin.inverse_bind_matrices {
            let path = format!("skins[{s}].inverseBindMatrices");
            let matrices = self.accessor(binds, &BINDS, &path)?;
            if matrices < count {
                return Err(problem(
                    path,
                    GltfProblem::OutOfRange { what: "joint", index: count - 1, count: matrices },
                ));
            }
        }
        Ok(())
    }

    fn primitive(&mut self, m: usize, p: usize) -> Result<(), LoadError> {
        let primitive = &self.meshes[m].primitives[p];
        let path = |field: &str| format!("meshes[{m}].primitives[{p}].{field}");
        let attributes = primitive.attributes.clone();
        let indices = primitive.indices;
        if let Some(mode) = primitive.mode.filter(|&mode| mode > 6) {
            return Err(problem(path("mode"), GltfProblem::Unexpected { wanted: "0 to 6", got: mode.to_string() }));
        }
        if let Some(material) = primitive.material {
            within(material, self.materials.len(), "material", &|| path("material"))?;
        }
        let Some(&position) = attributes.get("POSITION") else {
            // Without places there is nothing to see; the format allows it.
            return Ok(());
        };
        let vertices = self.accessor(position, &POSITION, &path("attributes.POSITION"))?;
        for (name, &index) in &attributes {
            let wanted = match name.as_str() {
                "NORMAL" => &POSITION,
                // Also `TEXCOORD_00`, which the crate takes for the same.
                name if name.starts_with("TEXCOORD_") => &UV,
                name if name.starts_with("JOINTS_") => &JOINTS,
                name if name.starts_with("WEIGHTS_") => &WEIGHTS,
                _ => continue,
            };
            let path = path(&format!("attributes.{}", short(name)));
            let count = self.accessor(index, wanted, &path)?;
            if count != vertices {
                return Err(problem(
                    path,
                    GltfProblem::Unexpected { wanted: "one entry per POSITION", got: count.to_string() },
                ));
            }
        }
        if let Some(indices) = indices {
            self.accessor(indices, &INDICES, &path("indices"))?;
        }
        Ok(())
    }

    /// Checks an accessor and everything it reaches; returns its count.
    fn accessor(&mut self, index: u64, wanted: &Wanted, user: &str) -> Result<u64, LoadError> {
        let i = within(index, self.accessors.len(), "accessor", &|| user.to_owned())?;
        let path = || format!("accessors[{i}]");
        let a = &self.accessors[i];
        if a.shape != wanted.shape || !wanted.components.contains(&a.component_type) {
            let got = format!("{} of {}", short(&a.shape), component_name(a.component_type));
            return Err(problem(user, GltfProblem::Unexpected { wanted: wanted.text, got }));
        }
        if a.count == 0 {
            return Err(problem(path() + ".count", GltfProblem::Unexpected { wanted: "at least 1", got: "0".into() }));
        }
        let limit = if a.buffer_view.is_some() { 3 * MAX_VERTICES } else { MAX_BARE };
        if a.count > limit {
            return Err(LoadError::TooMuch { what: format!("entries in {}", path()), count: a.count, limit });
        }
        let size = component_size(a.component_type) * components(wanted.shape);
        let mut spans = Vec::new();
        if let Some(view) = a.buffer_view {
            spans.push((view, a.byte_offset, a.count, size, path()));
        }
        if let Some(sparse) = &a.sparse {
            let path = path() + ".sparse";
            let kind = sparse.indices.component_type;
            if !INDICES.components.contains(&kind) {
                let got = component_name(kind);
                return Err(problem(path + ".indices", GltfProblem::Unexpected { wanted: "u8, u16 or u32", got }));
            }
            if sparse.count == 0 || sparse.count > a.count {
                let got = sparse.count.to_string();
                return Err(problem(
                    path + ".count",
                    GltfProblem::Unexpected { wanted: "1 to the accessor's count", got },
                ));
            }
            let (at, values) = (&sparse.indices, &sparse.values);
            spans.push((at.buffer_view, at.byte_offset, sparse.count, component_size(kind), path.clone() + ".indices"));
            spans.push((values.buffer_view, values.byte_offset, sparse.count, size, path + ".values"));
        }
        let count = a.count;
        if spans.is_empty() {
            return Err(problem(path(), GltfProblem::Missing("bufferView")));
        }
        for (view, offset, count, size, path) in spans {
            self.span(view, offset, count, size, path)?;
        }
        Ok(count)
    }

    /// Checks that `count` elements of `size` bytes from `offset` lie in the view and the view in its buffer.
    fn span(&mut self, view: u64, offset: u64, count: u64, size: u64, path: String) -> Result<(), LoadError> {
        let v = within(view, self.buffer_views.len(), "bufferView", &|| path.clone())?;
        let view = &self.buffer_views[v];
        let buffer = within(view.buffer, self.buffers.len(), "buffer", &|| format!("bufferViews[{v}]"))?;
        let length = self.buffers[buffer].byte_length;
        let range = |what, end: Option<u64>, length| GltfProblem::Range { what, end: end.unwrap_or(u64::MAX), length };
        let end = view.byte_offset.checked_add(view.byte_length);
        if end.is_none_or(|end| end > length) {
            return Err(problem(format!("bufferViews[{v}]"), range(format!("buffers[{buffer}]"), end, length)));
        }
        let stride = view.byte_stride.unwrap_or(size);
        // 252 is the format's greatest; in practice a stride is that of a struct of attributes.
        if stride < size || stride > 4096 {
            let got = stride.to_string();
            return Err(problem(
                format!("bufferViews[{v}].byteStride"),
                GltfProblem::Unexpected { wanted: "the size of an element", got },
            ));
        }
        let end = (count - 1).checked_mul(stride).and_then(|o| o.checked_add(size)).and_then(|o| o.checked_add(offset));
        if end.is_none_or(|end| end > view.byte_length) {
            return Err(problem(path, range(format!("bufferViews[{v}]"), end, view.byte_length)));
        }
        self.is_used[buffer] = true;
        Ok(())
    }
}

fn components(shape: &str) -> u64 {
    match shape {
        "VEC2" => 2,
        "VEC3" => 3,
        "VEC4" => 4,
        "MAT4" => 16,
        _ => 1,
    }
}

fn component_size(kind: u64) -> u64 {
    match kind {
        5120 | U8 => 1,
        5122 | U16 => 2,
        _ => 4,
    }
}

fn component_name(kind: u64) -> String {
    match kind {
        5120 => "i8".into(),
        U8 => "u8".into(),
        5122 => "i16".into(),
        U16 => "u16".into(),
        U32 => "u32".into(),
        F32 => "f32".into(),
        other => other.to_string(),
    }
}
