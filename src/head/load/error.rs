//! Why a file is not a mesh.

/// Why a mesh could not be loaded; [`LoadError::hint`] says what to do.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LoadError {
    /// Stopped from outside.
    #[error(transparent)]
    Cancelled(#[from] crate::task::Cancelled),
    /// No bytes, or nothing but spaces.
    #[error("the file is empty")]
    Empty,
    /// More than can be loaded.
    #[error("`{count}` {what}: the limit is {limit}")]
    TooMuch {
        /// "bytes", "vertices", "triangles", "corners in the face at line 7".
        what: String,
        /// How many.
        count: u64,
        /// How many there may be.
        limit: u64,
    },
    /// Neither OBJ nor glTF.
    #[error("`{name}` is not a mesh: {what}")]
    NotAMesh {
        /// The file's name.
        name: String,
        /// What it seems to be.
        what: &'static str,
    },
    /// A line of an OBJ file is wrong.
    #[error("line {line}: {problem}")]
    Obj {
        /// From 1, as an editor counts.
        line: usize,
        /// What is wrong.
        problem: ObjProblem,
    },
    /// The container of a binary glTF is wrong.
    #[error("byte {offset}: {problem}")]
    Glb {
        /// Offset of the offending field.
        offset: usize,
        /// What is wrong.
        problem: String,
    },
    /// The JSON of a glTF cannot be read.
    #[error("line {line}, column {column} of the JSON: {problem}")]
    Json {
        /// From 1.
        line: usize,
        /// From 1.
        column: usize,
        /// What the JSON reader says.
        problem: String,
    },
    /// A value in a glTF is wrong.
    #[error("{path}: {problem}")]
    Gltf {
        /// Where: `meshes[0].primitives[1].indices`.
        path: String,
        /// What is wrong.
        problem: GltfProblem,
    },
    /// The file needs an extension that changes its geometry.
    #[error("the file needs the extension `{name}`, which is not supported")]
    Extension {
        /// The extension.
        name: String,
    },
    /// A file that belongs to this one is missing or must not be read.
    #[error("`{name}` cannot be read: {problem}")]
    Sibling {
        /// As this file names it.
        name: String,
        /// Why not.
        problem: String,
    },
    /// A reader refused or broke on what looked right.
    #[error("the {format} reader gave up: {problem}")]
    Reader {
        /// "OBJ" or "glTF".
        format: &'static str,
        /// What it said.
        problem: String,
    },
    /// Nothing is left to be a mesh.
    #[error("the file has no triangles")]
    NoTriangles {
        /// Triangles dropped because they have no area.
        dropped: usize,
        /// Points and lines that were left out.
        ignored: usize,
    },
    /// A place that is not finite or too far away.
    #[error("vertex {vertex} lies `{:.0e}` cm away, further than 100 km", .position.abs().max_element())]
    TooFar {
        /// Index among the file's vertices.
        vertex: usize,
        /// Where, in cm.
        position: glam::Vec3,
    },
    /// No group of that name.
    #[error("no group `{name}` in the file")]
    UnknownGroup {
        /// As asked for.
        name: String,
        /// The file's groups.
        groups: Vec<String>,
    },
    /// `up` and `forward` are one axis.
    #[error("`forward = \"{forward}\"` lies along `up = \"{up}\"`")]
    Axes {
        /// The up axis.
        up: &'static str,
        /// The forward axis.
        forward: &'static str,
    },
    /// A head of a size no head has.
    #[error("the head is `{}` tall", super::unit::show_length(*.height))]
    Size {
        /// Height in cm.
        height: f32,
        /// What would make it right.
        advice: String,
    },
    /// The mesh is not one after all.
    #[error(transparent)]
    Mesh(#[from] crate::geometry::MeshError),
}

/// What is wrong in a line of an OBJ file.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ObjProblem {
    /// A coordinate is no number.
    #[error("expected a number, got `{0}`")]
    NotANumber(String),
    /// A coordinate is NaN, infinite or too large.
    #[error("`{0}` is not a finite number")]
    NotFinite(String),
    /// Too few coordinates.
    #[error("expected {wanted} or more numbers after `{keyword}`, got `{got}`")]
    TooFew {
        /// `v`, `vt` or `vn`.
        keyword: &'static str,
        /// How many it needs.
        wanted: usize,
        /// How many there are.
        got: usize,
    },
    /// A face of one or two corners.
    #[error("a face needs 3 corners, got `{0}`")]
    Corners(usize),
    /// A corner is not `v`, `v/vt`, `v//vn` or `v/vt/vn`.
    #[error("`{0}` is not a corner of a face")]
    Corner(String),
    /// One `g` line names a crowd of groups.
    #[error("`{got}` groups at once: the limit is {limit}")]
    Names {
        /// How many names.
        got: usize,
        /// How many there may be.
        limit: usize,
    },
    /// Indices start at 1.
    #[error("`{0}` names vertex 0")]
    Zero(String),
    /// An index beyond what there is.
    #[error("`{corner}` names {what} {index}, but there are only {count}")]
    OutOfRange {
        /// The corner as written.
        corner: String,
        /// "vertex", "uv" or "normal".
        what: &'static str,
        /// As written.
        index: i64,
        /// How many there are: in all for a positive index, above this line for a negative one.
        count: usize,
    },
}

/// What is wrong with a value of a glTF.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum GltfProblem {
    /// An index beyond its list.
    #[error("names {what} `{index}`, but there are only {count}")]
    OutOfRange {
        /// "accessor", "vertex", "node".
        what: &'static str,
        /// The index.
        index: u64,
        /// How many there are.
        count: u64,
    },
    /// More bytes than there are.
    #[error("reaches to byte `{end}` of {what} with {length} bytes")]
    Range {
        /// `bufferViews[2]`, `buffers[0]`.
        what: String,
        /// One past the last byte.
        end: u64,
        /// How long it is.
        length: u64,
    },
    /// The wrong kind of accessor, and others.
    #[error("expected {wanted}, got `{got}`")]
    Unexpected {
        /// "VEC3 of f32".
        wanted: &'static str,
        /// What it is.
        got: String,
    },
    /// A node is its own ancestor or has two parents.
    #[error("node `{0}` is its own ancestor or has two parents")]
    NotATree(u64),
    /// A mesh without the data it needs.
    #[error("has no `{0}`")]
    Missing(&'static str),
}

impl LoadError {
    /// What to do about it, if there is something to be said.
    pub fn hint(&self) -> Option<String> {
        Some(match self {
            Self::NotAMesh { .. } | Self::Empty => "give a Wavefront .obj, or glTF 2.0 as .glb or .gltf".into(),
            Self::Extension { name } if name.contains("draco") || name.contains("meshopt") => {
                "export it again without mesh compression".into()
            }
            Self::Extension { .. } => "export it again without this extension".into(),
            Self::Glb { problem, .. } if problem.contains("version") => "export it as glTF 2.0".into(),
            Self::Glb { problem, .. } if problem.contains("ends") => {
                "the file was cut off; copy or export it again".into()
            }
            Self::Sibling { name, .. } if name.contains(':') || name.contains("..") => {
                "keep the data beside the file, or export as .glb, which holds everything".into()
            }
            Self::Sibling { name, .. } => {
                format!("put `{name}` beside the file, or export as .glb, which holds everything")
            }
            Self::NoTriangles { dropped, .. } if *dropped > 0 => format!("triangles without area dropped: {dropped}"),
            Self::NoTriangles { ignored, .. } if *ignored > 0 => "it has only points and lines; export faces".into(),
            Self::TooFar { .. } => "look at the unit".into(),
            Self::UnknownGroup { name, groups } => unknown_group(name, groups),
            Self::Axes { .. } => "take two different axes, such as `up = \"z\", forward = \"-y\"`".into(),
            Self::Size { advice, .. } => advice.clone(),
            Self::Gltf { problem: GltfProblem::Missing("bufferView"), .. } => {
                "the data may be compressed; export it again without mesh compression".into()
            }
            Self::Obj { problem, .. } => return problem.hint(),
            Self::Gltf { problem: GltfProblem::Range { .. }, .. } => {
                "the file was cut off or is damaged; export it again".into()
            }
            Self::TooMuch { .. }
            | Self::Glb { .. }
            | Self::Json { .. }
            | Self::Gltf { .. }
            | Self::Reader { .. }
            | Self::NoTriangles { .. }
            | Self::Mesh(_)
            | Self::Cancelled(_) => return None,
        })
    }
}

impl ObjProblem {
    fn hint(&self) -> Option<String> {
        Some(match self {
            Self::NotANumber(text) if text.contains(',') => format!("write `{}`", text.replace(',', ".")),
            Self::Corners(2) => "write an edge as `l`, not `f`".into(),
            Self::Corner(_) => "write a corner as v, v/vt, v//vn or v/vt/vn, with whole numbers".into(),
            Self::Zero(_) => "OBJ counts from 1".into(),
            Self::OutOfRange { index: ..0, .. } => "a negative index counts back from the lines above".into(),
            Self::NotANumber(_)
            | Self::NotFinite(_)
            | Self::TooFew { .. }
            | Self::Names { .. }
            | Self::Corners(_)
            | Self::OutOfRange { .. } => {
                return None;
            }
        })
    }
}

fn unknown_group(name: &str, groups: &[String]) -> String {
    if let Some(near) = crate::params::nearest(name, groups.iter().map(String::as_str)) {
        return format!("did you mean \"{near}\"?");
    }
    match groups.len() {
        0 => "the file names no groups; leave out `groups`".into(),
        n => {
            let some: Vec<String> = groups.iter().take(8).map(|g| format!("\"{g}\"")).collect();
            let more = if n > 8 { format!(" and {} more", n - 8) } else { String::new() };
            format!("it has {}{more}", some.join(", "))
        }
    }
}
