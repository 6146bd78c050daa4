//! Files on their way to the disk.

use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A file to be written.
#[derive(Clone, Debug)]
pub struct Output {
    /// Name within the output folder, with `/` when it lies in a folder there.
    pub name: String,
    /// Its content.
    pub bytes: Arc<Vec<u8>>,
}

/// A file that was written.
#[derive(Clone, Debug)]
pub struct Written {
    /// Where.
    pub path: PathBuf,
    /// Its size.
    pub bytes: usize,
}

/// Why a file could not be written.
#[derive(Debug, thiserror::Error)]
#[error("cannot write `{}`: {error}", .path.display())]
pub struct WriteError {
    /// The file or folder.
    pub path: PathBuf,
    /// What the system says.
    pub error: io::Error,
}

/// Writes all of them into a folder, making it if need be; either all get into place or, as far as the system lets
/// know beforehand, none.
///
/// # Errors
/// [`WriteError`] with the file at fault.
pub fn write_all(folder: &Path, outputs: &[Output]) -> Result<Vec<Written>, WriteError> {
    let failed = |path: &Path| {
        let path = path.to_path_buf();
        move |error| WriteError { path, error }
    };
    std::fs::create_dir_all(folder).map_err(failed(folder))?;
    let mut ready = vec![];
    for output in outputs {
        let path = folder.join(&output.name);
        if path.is_dir() {
            return Err(WriteError { path, error: io::Error::from(io::ErrorKind::IsADirectory) });
        }
        if let Some(parent) = path.parent() {
            std::fs::create_dir_all(parent).map_err(failed(parent))?;
        }
        let mut file = beside(folder).map_err(failed(&path))?;
        file.write_all(&output.bytes).and_then(|()| file.flush()).map_err(failed(&path))?;
        ready.push((file, path, output.bytes.len()));
    }
    ready
        .into_iter()
        .map(|(file, path, bytes)| match file.persist(&path) {
            Ok(_) => Ok(Written { path, bytes }),
            Err(e) => Err(WriteError { path, error: e.error }),
        })
        .collect()
}

/// A temporary file in the folder; it vanishes unless it is renamed.
fn beside(folder: &Path) -> io::Result<tempfile::NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".coif-");
    // Temporary files are private by default; these become the user's own, under his mask.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.tempfile_in(folder)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn output(name: &str) -> Output {
        Output { name: name.into(), bytes: Arc::new(b"new".to_vec()) }
    }

    #[test]
    fn all_or_none() {
        let dir = tempfile::tempdir().unwrap();
        let out = dir.path().join("a/b");
        write_all(&out, &[output("x.png"), output("x.glb")]).unwrap();
        std::fs::write(out.join("x.png"), "old").unwrap();
        std::fs::create_dir(out.join("y.glb")).unwrap();
        let error = write_all(&out, &[output("x.png"), output("y.glb")]).unwrap_err();
        assert!(error.path.ends_with("y.glb"));
        assert_eq!(std::fs::read(out.join("x.png")).unwrap(), b"old");
        // Nothing is left lying about.
        let mut names: Vec<_> = std::fs::read_dir(&out).unwrap().map(|e| e.unwrap().file_name()).collect();
        names.sort();
        assert_eq!(names, ["x.glb", "x.png", "y.glb"]);
    }
}
