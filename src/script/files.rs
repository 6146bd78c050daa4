//! The one door to files.
//!
//! A script's world is what [`Files`] shows: the real disk, or a table in memory for tests. [`Access`] stands before
//! it: it remembers every path that was asked for, missing ones too, so that a watcher knows what to watch, and lets
//! nothing through that does not lie below an allowed folder, symbolic links resolved.

use std::collections::{BTreeMap, BTreeSet};
use std::io;
use std::path::{Component, Path, PathBuf};
use std::sync::{Arc, Mutex};

/// Where bytes come from.
pub trait Files: Send + Sync {
    /// The whole content of a file.
    ///
    /// # Errors
    /// As the file system says.
    fn read(&self, path: &Path) -> io::Result<Vec<u8>>;

    /// Names of what lies in a folder, sorted; empty when there is no such folder.
    fn list(&self, folder: &Path) -> Vec<String>;

    /// The path with every symbolic link resolved.
    ///
    /// # Errors
    /// When there is no such file.
    fn resolve(&self, path: &Path) -> io::Result<PathBuf>;
}

/// The real file system.
#[derive(Clone, Copy, Debug, Default)]
pub struct Disk;

impl Files for Disk {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        // A pipe or a device would block or never end.
        if !std::fs::metadata(path)?.is_file() {
            return Err(io::Error::new(io::ErrorKind::InvalidInput, "not a file"));
        }
        std::fs::read(path)
    }

    fn list(&self, folder: &Path) -> Vec<String> {
        let Ok(entries) = std::fs::read_dir(folder) else { return vec![] };
        let mut names: Vec<String> = entries.flatten().map(|e| e.file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }

    fn resolve(&self, path: &Path) -> io::Result<PathBuf> {
        path.canonicalize()
    }
}

/// Files in memory, for tests.
#[derive(Clone, Debug, Default)]
pub struct Memory(pub BTreeMap<PathBuf, Vec<u8>>);

impl Memory {
    /// With one more file.
    #[must_use]
    pub fn with(mut self, path: impl Into<PathBuf>, content: impl Into<Vec<u8>>) -> Self {
        self.0.insert(tidy(&path.into()), content.into());
        self
    }
}

impl Files for Memory {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        self.0.get(&tidy(path)).cloned().ok_or_else(|| io::ErrorKind::NotFound.into())
    }

    fn list(&self, folder: &Path) -> Vec<String> {
        let folder = tidy(folder);
        let names: BTreeSet<String> = self
            .0
            .keys()
            .filter_map(|p| p.strip_prefix(&folder).ok()?.components().next())
            .map(|c| c.as_os_str().to_string_lossy().into_owned())
            .collect();
        names.into_iter().collect()
    }

    fn resolve(&self, path: &Path) -> io::Result<PathBuf> {
        let path = tidy(path);
        if !self.0.keys().any(|p| p.starts_with(&path)) {
            return Err(io::ErrorKind::NotFound.into());
        }
        // Absolute, as on a disk; the working folder is deep enough for a few steps up.
        Ok(tidy(&Path::new("/the/working/folder").join(path)))
    }
}

/// The path without `.` and with every `..` taken back as far as it goes, by text alone.
pub fn tidy(path: &Path) -> PathBuf {
    let mut out = PathBuf::new();
    for part in path.components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir if matches!(out.components().next_back(), Some(Component::Normal(_))) => {
                out.pop();
            }
            Component::ParentDir | Component::Normal(_) | Component::RootDir | Component::Prefix(_) => out.push(part),
        }
    }
    out
}

/// Why a file was not read.
#[derive(Debug, thiserror::Error)]
pub enum AccessError {
    /// It lies outside of every allowed folder.
    #[error("`{}` lies outside of the script's folder", .0.display())]
    Outside(PathBuf),
    /// There is no such file.
    #[error("there is no file `{}`", .path.display())]
    Missing {
        /// The path that was asked for.
        path: PathBuf,
        /// A name in the same folder that is nearly the same.
        nearest: Option<String>,
    },
    /// It is too large.
    #[error("`{}` has {size} bytes, more than the {limit} that are allowed", .path.display())]
    TooLarge {
        /// The path that was asked for.
        path: PathBuf,
        /// Its size.
        size: usize,
        /// The limit.
        limit: usize,
    },
    /// The file system said no.
    #[error("cannot read `{}`: {error}", .path.display())]
    Unreadable {
        /// The path that was asked for.
        path: PathBuf,
        /// What the system says.
        error: io::Error,
    },
}

impl AccessError {
    /// What to do about it.
    pub fn hint(&self) -> Option<String> {
        match self {
            Self::Outside(path) => {
                let folder = path.parent().filter(|f| !f.as_os_str().is_empty()).unwrap_or(Path::new("."));
                Some(format!("move it there, or allow its folder: `--allow {}`", folder.display()))
            }
            Self::Missing { nearest, .. } => nearest.as_ref().map(|n| format!("did you mean `{n}`?")),
            Self::TooLarge { .. } | Self::Unreadable { .. } => None,
        }
    }
}

/// True when a tidy path lies at or below a tidy folder. The working folder is an empty path, which everything starts with.
fn is_below(path: &Path, folder: &Path) -> bool {
    if folder.as_os_str().is_empty() { path.is_relative() && !path.starts_with("..") } else { path.starts_with(folder) }
}

/// Largest file that a script may read, bytes.
const LARGEST_FILE: usize = 1 << 30;

/// Confined and recorded reading.
pub struct Access {
    files: Arc<dyn Files>,
    allowed: Vec<PathBuf>,
    asked: Mutex<BTreeSet<PathBuf>>,
}

impl Access {
    /// Reading from `files`, below the folders (or the very files) `allowed`.
    pub fn new(files: Arc<dyn Files>, allowed: impl IntoIterator<Item = PathBuf>) -> Self {
        let folder = |p: PathBuf| if p.as_os_str().is_empty() { PathBuf::from(".") } else { p };
        Self { files, allowed: allowed.into_iter().map(folder).collect(), asked: Mutex::default() }
    }

    /// Every path that was asked for, missing ones too, sorted.
    pub fn asked(&self) -> BTreeSet<PathBuf> {
        self.asked.lock().map(|a| a.clone()).unwrap_or_default()
    }

    /// The files behind it.
    pub fn files(&self) -> Arc<dyn Files> {
        Arc::clone(&self.files)
    }

    /// Reads a file.
    ///
    /// # Errors
    /// An [`AccessError`] when it is outside, missing, too large or unreadable.
    pub fn read(&self, path: &Path) -> Result<Vec<u8>, AccessError> {
        let path = tidy(path);
        // By text first: the answer to "is there a file outside?" must not depend on whether there is.
        if !self.allowed.iter().any(|a| is_below(&path, &tidy(a))) && !self.is_below_resolved(&path) {
            return Err(AccessError::Outside(path));
        }
        if let Ok(mut asked) = self.asked.lock() {
            asked.insert(path.clone());
        }
        match self.files.resolve(&path) {
            Ok(real) if self.allowed.iter().any(|a| self.files.resolve(a).is_ok_and(|a| real.starts_with(a))) => {}
            Ok(_) => return Err(AccessError::Outside(path)),
            Err(e) if e.kind() == io::ErrorKind::NotFound => return Err(self.missing(path)),
            Err(error) => return Err(AccessError::Unreadable { path, error }),
        }
        match self.files.read(&path) {
            Ok(bytes) if bytes.len() > LARGEST_FILE => {
                Err(AccessError::TooLarge { path, size: bytes.len(), limit: LARGEST_FILE })
            }
            Ok(bytes) => Ok(bytes),
            Err(e) if e.kind() == io::ErrorKind::NotFound => Err(self.missing(path)),
            Err(error) => Err(AccessError::Unreadable { path, error }),
        }
    }

    /// True when the resolved parent lies below a resolved allowed folder: `/tmp/x` may be written `/private/tmp/x`.
    fn is_below_resolved(&self, path: &Path) -> bool {
        let (Some(parent), Some(_)) = (path.parent(), path.file_name()) else { return false };
        let Ok(parent) = self.files.resolve(parent) else { return false };
        self.allowed.iter().any(|a| self.files.resolve(a).is_ok_and(|a| parent.starts_with(a)))
    }

    fn missing(&self, path: PathBuf) -> AccessError {
        let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let names = self.files.list(folder);
        let wrong = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
        let nearest = crate::params::nearest(&wrong, names.iter().map(String::as_str)).map(ToOwned::to_owned);
        AccessError::Missing { path, nearest }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn above_the_working_folder_is_outside_whether_there_is_a_file_or_not() {
        let files = Memory::default().with("a.obj", "a").with("../there", "b");
        let access = Access::new(Arc::new(files), [PathBuf::from(".")]);
        assert_eq!(access.read(Path::new("./a.obj")).unwrap(), b"a");
        for outside in ["../there", "../not_there", "x/../../not_there", "/etc/not_there", ".."] {
            assert!(matches!(access.read(Path::new(outside)), Err(AccessError::Outside(_))), "{outside}");
        }
    }

    #[test]
    fn reading_is_confined_and_recorded() {
        let files = Memory::default().with("style/a.obj", "a").with("other/b.obj", "b");
        let access = Access::new(Arc::new(files), [PathBuf::from("style")]);
        assert_eq!(access.read(Path::new("style/./x/../a.obj")).unwrap(), b"a");
        for outside in ["other/b.obj", "style/../other/b.obj", "/etc/passwd", "../style/a.obj", "stylex/a.obj"] {
            assert!(matches!(access.read(Path::new(outside)), Err(AccessError::Outside(_))), "{outside}");
        }
        let missing = access.read(Path::new("style/a.ojb")).unwrap_err();
        assert_eq!(missing.hint().as_deref(), Some("did you mean `a.obj`?"));
        let asked: Vec<_> = access.asked().into_iter().collect();
        assert_eq!(asked, [PathBuf::from("style/a.obj"), PathBuf::from("style/a.ojb")]);
    }

    #[cfg(unix)]
    #[test]
    fn links_do_not_lead_out() {
        let dir = tempfile::tempdir().unwrap();
        let (inside, outside) = (dir.path().join("in"), dir.path().join("out"));
        std::fs::create_dir_all(&inside).unwrap();
        std::fs::create_dir_all(&outside).unwrap();
        std::fs::write(outside.join("secret"), "s").unwrap();
        std::os::unix::fs::symlink(outside.join("secret"), inside.join("link")).unwrap();
        std::os::unix::fs::symlink(&outside, inside.join("folder")).unwrap();
        let access = Access::new(Arc::new(Disk), [inside.clone()]);
        for path in ["link", "folder/secret"] {
            assert!(matches!(access.read(&inside.join(path)), Err(AccessError::Outside(_))), "{path}");
        }
    }
}
