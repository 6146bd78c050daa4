//! Signs of change from the file system, through `notify`.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use notify::event::{AccessKind, AccessMode, EventKind};
use notify::{RecommendedWatcher, RecursiveMode, Watcher};

/// What was heard.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Heard {
    /// Something happened at these paths.
    Paths(Vec<PathBuf>),
    /// Events were lost: anything may have happened.
    Anything,
}

/// Listens in folders, not in what lies deeper.
pub struct Ears {
    watcher: RecommendedWatcher,
    folders: BTreeSet<PathBuf>,
}

impl Ears {
    /// Ears that tell `heard`, from a thread of their own.
    ///
    /// # Errors
    /// When the system has no events to give.
    pub fn new(heard: impl Fn(Heard) + Send + 'static) -> notify::Result<Self> {
        let handler = move |event: notify::Result<notify::Event>| match event {
            Ok(event) if event.need_rescan() => heard(Heard::Anything),
            // Reading is no change, and we read these files ourselves.
            Ok(event) if is_reading(event.kind) => {}
            Ok(event) => heard(Heard::Paths(event.paths)),
            Err(_) => heard(Heard::Anything),
        };
        let config = notify::Config::default().with_follow_symlinks(false);
        Ok(Self { watcher: RecommendedWatcher::new(handler, config)?, folders: BTreeSet::new() })
    }

    /// Listens in exactly these folders from now on. True when one of them is new.
    ///
    /// # Errors
    /// When the system refuses a folder that exists, its limit reached say.
    pub fn listen(&mut self, folders: &BTreeSet<PathBuf>) -> notify::Result<bool> {
        for gone in self.folders.difference(folders) {
            let _ = self.watcher.unwatch(gone);
        }
        self.folders.retain(|f| folders.contains(f));
        let mut is_new = false;
        for folder in folders {
            if self.folders.contains(folder) {
                continue;
            }
            match self.watcher.watch(folder, RecursiveMode::NonRecursive) {
                Ok(()) => {
                    self.folders.insert(folder.clone());
                    is_new = true;
                }
                // Deleted just now, or a folder above ours that may not be read: the others are there still.
                Err(_) if std::fs::read_dir(folder).is_err() => {}
                Err(e) => return Err(e),
            }
        }
        Ok(is_new)
    }

    /// Takes a folder for gone: the next [`Ears::listen`] listens anew. What the system listens in is not a path but
    /// the folder that stood there, which may have been renamed or deleted, and another made in its place.
    pub fn forget(&mut self, folder: &Path) {
        if self.folders.remove(folder) {
            let _ = self.watcher.unwatch(folder);
        }
    }
}

fn is_reading(kind: EventKind) -> bool {
    matches!(kind, EventKind::Access(access) if access != AccessKind::Close(AccessMode::Write))
}
