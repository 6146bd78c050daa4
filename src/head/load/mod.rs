//! Loading heads and other meshes from OBJ and glTF.
//!
//! Bytes in, a clean [`Mesh`] out: centimetres, Y up, the face to +Z, triangles with normals, named groups. No file
//! is opened here; what a glTF keeps in files of its own is asked for through [`Siblings`]. Every file is checked
//! before a reader sees it, so that a wrong one is refused with the place of the mistake.
//!
//! ```
//! use coif::head::load::{FileBytes, LoadOptions, NoSiblings, Unit, load};
//!
//! let obj = b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\ng face\nf 1 2 3 4\n";
//! let options = LoadOptions { unit: Some(Unit::M), ..LoadOptions::default() };
//! let loaded = load(&FileBytes { name: "square.obj", bytes: obj }, &options, &NoSiblings)?.value;
//! assert_eq!(loaded.mesh.triangles.len(), 2);
//! assert_eq!(loaded.mesh.bounds().size(), glam::Vec3::new(100.0, 100.0, 0.0));
//! assert_eq!(loaded.mesh.groups[0].name, "face");
//! # Ok::<(), coif::head::load::LoadError>(())
//! ```

mod barrier;
mod build;
mod container;
mod error;
mod gltf;
mod guard;
mod obj;
mod schema;
mod skin;
mod unit;

use std::io;

use glam::Mat3;

use crate::geometry::Mesh;
use crate::task::{Task, Warned};

pub use error::{GltfProblem, LoadError, ObjProblem};
pub use unit::{Axis, LoadOptions, Unit, check_head_size};

/// The largest file that is read, in bytes.
pub const MAX_BYTES: u64 = 1 << 30;
/// The most vertices and the most triangles a file may unfold to.
pub const MAX_VERTICES: u64 = 20_000_000;
/// The most triangles that all groups may hold together; a triangle counts once for each of its groups.
const MAX_NAMED: u64 = 50_000_000;

/// Steps of a loop between two looks at the task.
const STEPS: usize = 4096;

/// A file that was read already.
#[derive(Clone, Copy, Debug)]
pub struct FileBytes<'a> {
    /// Its name or path; only the ending is looked at, and only to word errors.
    pub name: &'a str,
    /// All of it.
    pub bytes: &'a [u8],
}

/// Finds the files that a file refers to, such as the `.bin` of a `.gltf`.
pub trait Siblings {
    /// The bytes of a file by its relative path (decoded, with `/`, never leading out of the folder).
    ///
    /// # Errors
    /// Whatever reading it said.
    fn read(&self, name: &str) -> io::Result<Vec<u8>>;
}

impl<F: Fn(&str) -> io::Result<Vec<u8>>> Siblings for F {
    fn read(&self, name: &str) -> io::Result<Vec<u8>> {
        self(name)
    }
}

/// For a file that stands alone.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoSiblings;

impl Siblings for NoSiblings {
    fn read(&self, _: &str) -> io::Result<Vec<u8>> {
        Err(io::Error::new(io::ErrorKind::NotFound, "the file stands alone"))
    }
}

/// The kinds of files that are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Wavefront OBJ.
    Obj,
    /// glTF 2.0, as JSON or as GLB.
    Gltf,
}

/// A mesh and where it came from.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// In cm, Y up, the face to +Z; valid, with a normal for every vertex.
    pub mesh: Mesh,
    /// The kind of file.
    pub format: Format,
    /// What one unit of the file was taken for.
    pub unit: Unit,
    /// From the file's places to the mesh's: the turn of the axes and the scale to cm.
    pub from_file: Mat3,
}

/// Loads a mesh.
///
/// Polygons are cut into triangles, several objects are merged with their names kept as groups, glTF nodes place
/// their meshes and skins stand as the file rests. Points and lines are left out, triangles without area dropped, both
/// with a warning.
///
/// # Errors
/// A [`LoadError`] with the place in the file; nothing is guessed or repaired.
pub fn load(file: &FileBytes, options: &LoadOptions, siblings: &dyn Siblings) -> Result<Warned<Loaded>, LoadError> {
    load_until(file, options, siblings, &Task::new())
}

/// The same, unless the task is cancelled: it is asked every few thousand lines, triangles and vertices.
///
/// # Errors
/// As [`load`], and [`LoadError::Cancelled`].
pub fn load_until(
    file: &FileBytes,
    options: &LoadOptions,
    siblings: &dyn Siblings,
    task: &Task,
) -> Result<Warned<Loaded>, LoadError> {
    let rotation = options.rotation()?;
    if file.bytes.len() as u64 > MAX_BYTES {
        return Err(LoadError::TooMuch { what: "bytes".into(), count: file.bytes.len() as u64, limit: MAX_BYTES });
    }
    let format = format_of(file)?;
    let (parts, usual) = match format {
        Format::Obj => (obj::read(file, task)?, Unit::Cm),
        Format::Gltf => (gltf::read(file.bytes, siblings, task)?, Unit::M),
    };
    let unit = options.unit.unwrap_or(usual);
    let built = parts.finish(rotation, unit.centimetres(), &options.groups, task)?;
    let from_file = rotation * unit.centimetres() as f32;
    Ok(Warned { value: Loaded { mesh: built.value, format, unit, from_file }, warnings: built.warnings })
}

/// The kind of file, by its contents; the name helps only where they say nothing.
fn format_of(file: &FileBytes) -> Result<Format, LoadError> {
    let bytes = file.bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(file.bytes);
    let ending = file.name.rsplit_once('.').map(|(_, e)| e.to_ascii_lowercase()).unwrap_or_default();
    let not = |what| Err(LoadError::NotAMesh { name: file.name.to_owned(), what });
    let text = bytes.trim_ascii_start();
    match text {
        [] => Err(LoadError::Empty),
        _ if bytes.starts_with(b"glTF") => Ok(Format::Gltf),
        _ if matches!(ending.as_str(), "glb" | "vrm") => {
            let start = bytes.iter().take(4).map(|b| b.escape_ascii().to_string()).collect::<String>();
            Err(LoadError::Glb { offset: 0, problem: format!("expected `glTF`, got `{start}`") })
        }
        [b'{', ..] => Ok(Format::Gltf),
        _ if ending == "gltf" => Ok(Format::Gltf),
        _ if bytes.starts_with(b"Kaydara FBX") => not("it is an FBX file"),
        _ if bytes.starts_with(b"ply\n") || bytes.starts_with(b"ply\r") => not("it is a PLY file"),
        _ if text.starts_with(b"solid ") || ending == "stl" => not("it is an STL file"),
        _ if text.starts_with(b"#usda") || bytes.starts_with(b"PXR-USDC") => not("it is a USD file"),
        _ if bytes.starts_with(b"\x89PNG") || bytes.starts_with(b"\xFF\xD8\xFF") => not("it is a picture"),
        _ if bytes.starts_with(b"BLENDER") => not("it is a Blender file"),
        _ if bytes.starts_with(b"\xFF\xFE") || bytes.starts_with(b"\xFE\xFF") => {
            not("it is UTF-16 text; save it as UTF-8")
        }
        _ => Ok(Format::Obj),
    }
}
