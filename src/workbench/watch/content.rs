//! What a run has read, as fingerprints.

use std::collections::{BTreeMap, BTreeSet};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

use xxhash_rust::xxh3::xxh3_128;

use crate::script::Files;

/// What stands at a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fingerprint {
    /// Nothing.
    Missing,
    /// A folder, or a file that cannot be read.
    Unreadable,
    /// A file with this hash.
    Content(u128),
}

impl Fingerprint {
    /// The fingerprint of what a reading gave.
    pub fn of(read: &io::Result<Vec<u8>>) -> Self {
        match read {
            Ok(bytes) => Self::Content(xxh3_128(bytes)),
            Err(e) if matches!(e.kind(), io::ErrorKind::NotFound | io::ErrorKind::NotADirectory) => Self::Missing,
            Err(_) => Self::Unreadable,
        }
    }
}

/// Files that are noted as they are read: what a run saw is compared later, not what stood there when it ended.
pub struct Witness {
    inner: Arc<dyn Files>,
    seen: Mutex<BTreeMap<PathBuf, Fingerprint>>,
    /// Told of every path at its first reading.
    asked: Box<dyn Fn(&Path) + Send + Sync>,
}

impl Witness {
    /// A witness of readings from `inner`.
    pub fn new(inner: Arc<dyn Files>, asked: impl Fn(&Path) + Send + Sync + 'static) -> Self {
        Self { inner, seen: Mutex::default(), asked: Box::new(asked) }
    }

    fn note(&self, path: &Path, fingerprint: Fingerprint) {
        let Ok(mut seen) = self.seen.lock() else { return };
        let is_first = !seen.contains_key(path);
        seen.insert(path.to_path_buf(), fingerprint);
        drop(seen);
        if is_first {
            (self.asked)(path);
        }
    }

    /// Of the given paths, those whose content is no longer what was read. Paths that were not read yet are left out:
    /// whoever reads them later sees what is there then.
    pub fn changed<'a>(&self, paths: impl IntoIterator<Item = &'a PathBuf>) -> BTreeSet<PathBuf> {
        let seen = self.seen.lock().map(|s| s.clone()).unwrap_or_default();
        paths
            .into_iter()
            .filter(|path| {
                seen.get(*path).is_some_and(|fingerprint| *fingerprint != Fingerprint::of(&self.inner.read(path)))
            })
            .cloned()
            .collect()
    }

    /// Notes what stands at those of the paths that were asked for but never read: a file outside of the allowed
    /// folders, say, behind a link that may be turned elsewhere.
    pub fn complete(&self, paths: &BTreeSet<PathBuf>) {
        for path in paths {
            let is_seen = self.seen.lock().is_ok_and(|s| s.contains_key(path));
            if !is_seen {
                self.note(path, Fingerprint::of(&self.inner.read(path)));
            }
        }
    }
}

impl Files for Witness {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        let read = self.inner.read(path);
        self.note(path, Fingerprint::of(&read));
        read
    }

    fn list(&self, folder: &Path) -> Vec<String> {
        self.inner.list(folder)
    }

    fn resolve(&self, path: &Path) -> io::Result<PathBuf> {
        let resolved = self.inner.resolve(path);
        if resolved.as_ref().is_err_and(|e| e.kind() == io::ErrorKind::NotFound) {
            self.note(path, Fingerprint::Missing);
        }
        resolved
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::script::Disk;

    #[test]
    fn what_was_read_is_compared() {
        let dir = tempfile::tempdir().unwrap();
        let [a, b, c] = ["a", "b", "c"].map(|n| dir.path().join(n));
        std::fs::write(&a, "one").unwrap();
        let witness = Witness::new(Arc::new(Disk), |_| {});
        assert_eq!(witness.read(&a).unwrap(), b"one");
        assert!(witness.resolve(&b).is_err());
        let all = [a.clone(), b.clone(), c.clone()];
        assert!(witness.changed(&all).is_empty());
        // Not read, so not changed; then completed as missing.
        std::fs::write(&c, "c").unwrap();
        assert!(witness.changed(&all).is_empty());
        std::fs::remove_file(&c).unwrap();
        witness.complete(&all.iter().cloned().collect());
        std::fs::write(&c, "c").unwrap();
        std::fs::write(&b, "").unwrap();
        std::fs::write(&a, "two").unwrap();
        assert_eq!(witness.changed(&all), all.iter().cloned().collect());
        // Of the same size and, on many systems, the same time.
        std::fs::write(&a, "one").unwrap();
        assert!(!witness.changed(&all).contains(&a));
    }
}
