//! Files on their way to the disk.

use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::task::{Cancelled, Task};

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

/// Why nothing was written.
#[derive(Debug, thiserror::Error)]
pub enum Unwritten {
    /// The disk would not.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// Stopped from outside, before anything was in place.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// Writes all of them into a folder, making it if need be; either all get into place or, as far as the system lets
/// know beforehand, none.
///
/// # Errors
/// [`WriteError`] with the file at fault.
pub fn write_all(folder: &Path, outputs: &[Output]) -> Result<Vec<Written>, WriteError> {
    write_until(folder, outputs, &Task::new()).map_err(|e| match e {
        Unwritten::Write(error) => error,
        // Nobody holds that task.
        Unwritten::Cancelled(_) => {
            WriteError { path: folder.to_path_buf(), error: io::Error::from(io::ErrorKind::Interrupted) }
        }
    })
}

/// The same, unless the task is cancelled before the last byte is written: then there is nothing new in the folder.
///
/// # Errors
/// [`Unwritten`], with the file at fault.
pub fn write_until(folder: &Path, outputs: &[Output], task: &Task) -> Result<Vec<Written>, Unwritten> {
    let failed = |path: &Path| {
        let path = path.to_path_buf();
        move |error| WriteError { path, error }
    };
    std::fs::create_dir_all(folder).map_err(failed(folder))?;
    let mut ready = vec![];
    for output in outputs {
        let path = folder.join(&output.name);
        if path.is_dir() {
            return Err(WriteError { path, error: io::Error::from(io::ErrorKind::IsADirectory) }.into());
        }
        if let Some(parent) = path.parent() {
            std::fs::create_dir_all(parent).map_err(failed(parent))?;
        }
        let mut file = beside(folder).map_err(failed(&path))?;
        for some in output.bytes.chunks(PIECE) {
            task.check()?;
            file.write_all(some).map_err(failed(&path))?;
        }
        file.flush().map_err(failed(&path))?;
        ready.push((file, path, output.bytes.len()));
    }
    task.check()?;
    let placed: Result<Vec<Written>, WriteError> = ready
        .into_iter()
        .map(|(file, path, bytes)| match file.persist(&path) {
            Ok(_) => Ok(Written { path, bytes }),
            Err(e) => Err(WriteError { path, error: e.error }),
        })
        .collect();
    Ok(placed?)
}

/// Bytes that are written between two looks at the task: a few milliseconds even on a slow disk.
const PIECE: usize = 1 << 20;

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
    fn a_cancelled_write_leaves_the_folder_as_it_was() {
        use std::sync::atomic::{AtomicUsize, Ordering};
        let dir = tempfile::tempdir().unwrap();
        std::fs::write(dir.path().join("x.png"), "old").unwrap();
        let large = Output { name: "x.glb".into(), bytes: Arc::new(vec![7; 5 * PIECE]) };
        let outputs = [output("x.png"), large];
        let polls = |at: usize| {
            let (task, count) = (Task::new(), Arc::new(AtomicUsize::new(0)));
            let (own, counted) = (task.clone(), Arc::clone(&count));
            let task = task.with_polls(move || {
                if counted.fetch_add(1, Ordering::SeqCst) + 1 == at {
                    own.cancel();
                }
            });
            let written = write_until(dir.path(), &outputs, &task);
            (count.load(Ordering::SeqCst), written)
        };
        // One look for each piece, and one before the files are put into place.
        for at in 1..=7 {
            let (count, written) = polls(at);
            assert!(matches!(written, Err(Unwritten::Cancelled(_))) && count == at, "{at}: {count}");
            let names: Vec<_> = std::fs::read_dir(dir.path()).unwrap().map(|e| e.unwrap().file_name()).collect();
            assert_eq!(names, ["x.png"]);
            assert_eq!(std::fs::read(dir.path().join("x.png")).unwrap(), b"old");
        }
        let (count, written) = polls(8);
        assert_eq!((count, written.unwrap().len()), (7, 2));
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
