//! glTF 2.0, as JSON or GLB.
//!
//! [`guard`](super::guard) has checked the JSON; here the `gltf` crate reads it, behind the last barrier.

use std::borrow::Cow;
use std::fmt;

use glam::{DMat4, DQuat, DVec3, Vec2, Vec3};
use gltf::accessor::{DataType, Item, Iter};
use gltf::mesh::{Mode, Semantic};

use super::build::Parts;
use super::guard::{self, problem};
use super::schema::Root;
use super::{GltfProblem, LoadError, MAX_BYTES, MAX_VERTICES, Siblings, barrier, container, skin};
use crate::task::{Task, Warning};

/// The bytes of the buffers that geometry lies in; the others are empty.
pub(super) struct Buffers<'a>(Vec<Cow<'a, [u8]>>);

impl Buffers<'_> {
    /// The bytes of a buffer.
    pub fn get(&self, buffer: &gltf::Buffer<'_>) -> Option<&[u8]> {
        self.0.get(buffer.index()).map(AsRef::as_ref)
    }
}

/// Where in the file a primitive stands.
#[derive(Clone, Copy)]
pub(super) struct PrimitivePath(usize, usize);

impl fmt::Display for PrimitivePath {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "meshes[{}].primitives[{}]", self.0, self.1)
    }
}

/// Reads a glTF file.
pub(super) fn read(bytes: &[u8], siblings: &dyn Siblings, task: &Task) -> Result<Parts, LoadError> {
    let (json, blob) = container::open(bytes)?;
    // Some exporters fill the chunk up with zeros instead of spaces.
    let json = &json[..json.len() - json.iter().rev().take_while(|&&b| b == 0).count()];
    task.check()?;
    let root = guard::check(json)?;
    task.check()?;
    let buffers = fill(&root, blob, siblings)?;
    task.check()?;
    barrier::guarded("glTF", || {
        let document = gltf::Gltf::from_slice_without_validation(json).map_err(|e| match e {
            gltf::Error::Deserialize(e) => guard::json_error(&e),
            other => LoadError::Reader { format: "glTF", problem: other.to_string() },
        })?;
        Reader { buffers: &buffers, parts: Parts::default(), left_over: 0, task }.run(&document)
    })
}

/// Fetches every buffer that geometry lies in.
fn fill<'a>(root: &Root, blob: Option<&'a [u8]>, siblings: &dyn Siblings) -> Result<Buffers<'a>, LoadError> {
    let mut buffers = Vec::with_capacity(root.buffers.len());
    let mut total = 0;
    for (b, buffer) in root.buffers.iter().enumerate() {
        let bytes = match (&buffer.uri, blob) {
            _ if !root.is_used[b] => Cow::Borrowed(&[][..]),
            (Some(uri), _) => Cow::Owned(container::fetch(uri, siblings)?),
            (None, Some(blob)) if b == 0 => Cow::Borrowed(blob),
            (None, _) => return Err(problem(format!("buffers[{b}]"), GltfProblem::Missing("uri"))),
        };
        if root.is_used[b] && (bytes.len() as u64) < buffer.byte_length {
            let what = buffer.uri.as_deref().filter(|u| u.len() < 60 && !u.starts_with("data:")).unwrap_or("its data");
            let (what, end, length) = (what.to_owned(), buffer.byte_length, bytes.len() as u64);
            return Err(problem(format!("buffers[{b}]"), GltfProblem::Range { what, end, length }));
        }
        total += bytes.len() as u64;
        if total > MAX_BYTES {
            return Err(LoadError::TooMuch { what: "bytes in buffers".into(), count: total, limit: MAX_BYTES });
        }
        buffers.push(bytes);
    }
    Ok(Buffers(buffers))
}

/// What is to be done with a node on the way through the tree.
enum Step {
    Enter(usize),
    /// Every triangle since the given one is under the node.
    Leave(usize, usize),
}

struct Reader<'a> {
    buffers: &'a Buffers<'a>,
    parts: Parts,
    /// Indices beyond the last whole triangle.
    left_over: usize,
    task: &'a Task,
}

impl Reader<'_> {
    fn run(mut self, document: &gltf::Document) -> Result<Parts, LoadError> {
        let nodes: Vec<gltf::Node<'_>> = document.nodes().collect();
        let mut is_child = vec![false; nodes.len()];
        for child in nodes.iter().flat_map(gltf::Node::children) {
            is_child[child.index()] = true;
        }
        let roots: Vec<usize> = (0..nodes.len()).filter(|&n| !is_child[n]).collect();
        let globals = place(&nodes, &roots)?;
        let skins: Vec<Vec<DMat4>> = document.skins().map(|s| skin::joints(&s, &globals, self.buffers)).collect();
        let scene = document.default_scene().or_else(|| document.scenes().next());
        let shown = scene.map_or(roots, |s| s.nodes().map(|n| n.index()).collect());

        let mut open: Vec<Step> = shown.into_iter().rev().map(Step::Enter).collect();
        while let Some(step) = open.pop() {
            self.task.check()?;
            match step {
                Step::Enter(n) => {
                    open.push(Step::Leave(n, self.parts.triangles.len()));
                    open.extend(
                        nodes[n].children().map(|c| Step::Enter(c.index())).collect::<Vec<_>>().into_iter().rev(),
                    );
                    self.node(&nodes[n], &globals, &skins)?;
                }
                Step::Leave(n, since) => self.name(nodes[n].name(), since)?,
            }
        }
        if nodes.is_empty() && document.meshes().len() > 0 {
            self.parts.warnings.push(Warning::new("no node shows a mesh, so all meshes were taken"));
            for mesh in document.meshes() {
                self.mesh(&mesh, DMat4::IDENTITY, None)?;
            }
        }
        if self.left_over > 0 {
            let message = format!("indices beyond the last whole triangle left out: `{}`", self.left_over);
            self.parts.warnings.push(Warning::new(message));
        }
        Ok(self.parts)
    }

    /// Puts all triangles from `since` on into the group of that name.
    fn name(&mut self, name: Option<&str>, since: usize) -> Result<(), LoadError> {
        let Some(name) = name.filter(|name| !name.is_empty() && since < self.parts.triangles.len()) else {
            return Ok(());
        };
        let group = self.parts.group(name);
        self.parts.enlist(group, since)
    }

    fn node(&mut self, node: &gltf::Node<'_>, globals: &[DMat4], skins: &[Vec<DMat4>]) -> Result<(), LoadError> {
        let Some(mesh) = node.mesh() else { return Ok(()) };
        let joints = node.skin().map(|s| skins[s.index()].as_slice());
        self.mesh(&mesh, globals[node.index()], joints)
    }

    fn mesh(&mut self, mesh: &gltf::Mesh<'_>, global: DMat4, joints: Option<&[DMat4]>) -> Result<(), LoadError> {
        let since = self.parts.triangles.len();
        for primitive in mesh.primitives() {
            self.task.check()?;
            let first = self.parts.triangles.len();
            self.primitive(&primitive, global, joints, PrimitivePath(mesh.index(), primitive.index()))?;
            self.name(primitive.material().name(), first)?;
        }
        self.name(mesh.name(), since)
    }

    fn primitive(
        &mut self,
        primitive: &gltf::Primitive<'_>,
        global: DMat4,
        joints: Option<&[DMat4]>,
        path: PrimitivePath,
    ) -> Result<(), LoadError> {
        let Some(position) = primitive.get(&Semantic::Positions) else { return Ok(()) };
        let indices = primitive.indices();
        if matches!(primitive.mode(), Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip) {
            self.parts.ignored += 1;
            return Ok(());
        }
        // A small file may show one mesh many times.
        let vertices = (self.parts.positions.len() + position.count()) as u64;
        let corners = indices.as_ref().map_or(position.count(), gltf::Accessor::count);
        let per_triangle = if primitive.mode() == Mode::Triangles { 3 } else { 1 };
        let triangles = (self.parts.triangles.len() + corners / per_triangle) as u64;
        for (what, count) in [("vertices", vertices), ("triangles", triangles)] {
            if count > MAX_VERTICES {
                return Err(LoadError::TooMuch { what: what.into(), count, limit: MAX_VERTICES });
            }
        }
        // Vertices.
        let base = self.parts.positions.len() as u32;
        let bend = joints.map(|j| skin::blend(primitive, j, self.buffers, path)).transpose()?.flatten();
        let transform = |v: usize| bend.as_ref().map_or(global, |b| b[v]);
        let places = vectors(&position, self.buffers);
        let normals = primitive.get(&Semantic::Normals).map(|a| vectors(&a, self.buffers)).unwrap_or_default();
        let uvs = primitive.get(&Semantic::TexCoords(0)).map(|a| pairs(&a, self.buffers)).unwrap_or_default();
        for (v, place) in places.iter().enumerate() {
            if !place.is_finite() {
                let got = place.to_string();
                return Err(problem(
                    format!("{path}.attributes.POSITION"),
                    GltfProblem::Unexpected { wanted: "finite numbers", got },
                ));
            }
            let transform = transform(v);
            self.parts.positions.push(transform.transform_point3(place.as_dvec3()).as_vec3());
            let normal = normals.get(v).filter(|n| n.is_finite());
            self.parts.normals.push(normal.map_or(Vec3::ZERO, |&n| skin::normal(&transform, n)));
            // glTF counts v downwards.
            self.parts.uvs.push(uvs.get(v).map(|uv| Vec2::new(uv.x, 1.0 - uv.y)));
        }
        // Triangles; a mirroring transform turns them over.
        let count = places.len() as u32;
        let corners: Vec<u32> = match &indices {
            Some(a) => scalars(a, self.buffers),
            None => (0..count).collect(),
        };
        if let Some(&index) = corners.iter().find(|&&i| i >= count) {
            let (index, count) = (u64::from(index), u64::from(count));
            return Err(problem(format!("{path}.indices"), GltfProblem::OutOfRange { what: "vertex", index, count }));
        }
        if corners.len() < 3 || (primitive.mode() == Mode::Triangles && !corners.len().is_multiple_of(3)) {
            self.left_over += if corners.len() < 3 { corners.len() } else { corners.len() % 3 };
        }
        for [a, b, c] in unfold(primitive.mode(), &corners) {
            let is_mirrored = transform(a as usize).determinant() < 0.0;
            let [b, c] = if is_mirrored { [c, b] } else { [b, c] };
            self.parts.triangles.push([a, b, c].map(|v| base + v));
        }
        Ok(())
    }
}

/// The triangles of a list, a strip or a fan.
fn unfold(mode: Mode, corners: &[u32]) -> Vec<[u32; 3]> {
    match mode {
        Mode::TriangleStrip => {
            let turn = |(i, w): (usize, &[u32])| if i % 2 == 0 { [w[0], w[1], w[2]] } else { [w[1], w[0], w[2]] };
            corners.windows(3).enumerate().map(turn).collect()
        }
        // glTF lists a fan's triangles as { 1, 2, 0 }; turned, that is { 0, 1, 2 }.
        Mode::TriangleFan => {
            corners.get(1..).unwrap_or_default().windows(2).map(|w| [corners[0], w[0], w[1]]).collect()
        }
        Mode::Triangles => corners.chunks_exact(3).map(|w| [w[0], w[1], w[2]]).collect(),
        Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip => Vec::new(),
    }
}

/// The transform of every node to the scene.
fn place(nodes: &[gltf::Node<'_>], roots: &[usize]) -> Result<Vec<DMat4>, LoadError> {
    let mut globals = vec![DMat4::IDENTITY; nodes.len()];
    let mut open: Vec<(usize, DMat4)> = roots.iter().map(|&n| (n, DMat4::IDENTITY)).collect();
    while let Some((n, parent)) = open.pop() {
        let local = match nodes[n].transform() {
            gltf::scene::Transform::Matrix { matrix } => glam::Mat4::from_cols_array_2d(&matrix).as_dmat4(),
            gltf::scene::Transform::Decomposed { translation, rotation, scale } => {
                DMat4::from_scale_rotation_translation(
                    DVec3::from_array(scale.map(f64::from)),
                    // Rounded by the exporter, so not quite of length one.
                    DQuat::from_array(rotation.map(f64::from)).normalize(),
                    DVec3::from_array(translation.map(f64::from)),
                )
            }
        };
        globals[n] = parent * local;
        // The last row of a transform that only turns, scales, shears and moves.
        let is_affine = globals[n].row(3) == glam::DVec4::W;
        if !globals[n].is_finite() || !is_affine {
            let got = if globals[n].is_finite() { "perspective" } else { "not finite" }.to_owned();
            return Err(problem(format!("nodes[{n}]"), GltfProblem::Unexpected { wanted: "an affine transform", got }));
        }
        open.extend(nodes[n].children().map(|c| (c.index(), globals[n])));
    }
    Ok(globals)
}

fn items<T: Item>(accessor: &gltf::Accessor<'_>, buffers: &Buffers) -> Vec<T> {
    // The guard has seen to it that there is data; `take`, for an iterator of the crate must not outrun the count.
    let iter = Iter::<T>::new(accessor.clone(), |buffer| buffers.get(&buffer));
    iter.map(|iter| iter.take(accessor.count()).collect()).unwrap_or_default()
}

/// Quantised components as numbers (glTF 2.0, 3.6.2.2).
fn numbers<const N: usize>(accessor: &gltf::Accessor<'_>, buffers: &Buffers) -> Vec<[f32; N]>
where
    [f32; N]: Item,
    [i8; N]: Item,
    [u8; N]: Item,
    [i16; N]: Item,
    [u16; N]: Item,
{
    macro_rules! scaled {
        ($ty:ty) => {{
            let divisor = if accessor.normalized() { f32::from(<$ty>::MAX) } else { 1.0 };
            items::<[$ty; N]>(accessor, buffers)
                .into_iter()
                .map(|v| v.map(|c| (f32::from(c) / divisor).max(if accessor.normalized() { -1.0 } else { f32::MIN })))
                .collect()
        }};
    }
    match accessor.data_type() {
        DataType::F32 => items(accessor, buffers),
        DataType::I8 => scaled!(i8),
        DataType::U8 => scaled!(u8),
        DataType::I16 => scaled!(i16),
        DataType::U16 => scaled!(u16),
        DataType::U32 => Vec::new(),
    }
}

fn vectors(accessor: &gltf::Accessor<'_>, buffers: &Buffers) -> Vec<Vec3> {
    numbers::<3>(accessor, buffers).into_iter().map(Vec3::from_array).collect()
}

fn pairs(accessor: &gltf::Accessor<'_>, buffers: &Buffers) -> Vec<Vec2> {
    numbers::<2>(accessor, buffers).into_iter().map(Vec2::from_array).collect()
}

fn scalars(accessor: &gltf::Accessor<'_>, buffers: &Buffers) -> Vec<u32> {
    match accessor.data_type() {
        DataType::U8 => items::<u8>(accessor, buffers).into_iter().map(u32::from).collect(),
        DataType::U16 => items::<u16>(accessor, buffers).into_iter().map(u32::from).collect(),
        DataType::U32 => items(accessor, buffers),
        DataType::I8 | DataType::I16 | DataType::F32 => Vec::new(),
    }
}

/// Matrices, by columns.
pub(super) fn matrices(accessor: &gltf::Accessor<'_>, buffers: &Buffers) -> Vec<DMat4> {
    let all = items::<[[f32; 4]; 4]>(accessor, buffers);
    all.into_iter().map(|m| glam::Mat4::from_cols_array_2d(&m).as_dmat4()).collect()
}
