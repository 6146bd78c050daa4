//! Where to listen: the folders through which files are reached, and the names in them that matter.

use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::ffi::OsString;
use std::path::{Component, Path, PathBuf};

/// Most symbolic links on the way to one file, as Linux has it.
const MOST_LINKS: usize = 40;

/// Folders to listen in, and what an event in them concerns.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Places {
    /// Existing folders, free of symbolic links.
    pub folders: BTreeSet<PathBuf>,
    /// Every file, link and folder on the way to a dependency, with the dependencies behind it.
    steps: BTreeMap<PathBuf, BTreeSet<PathBuf>>,
}

impl Places {
    /// The places of some files, present or missing. Relative paths are taken from the current folder.
    ///
    /// Listened in are: the folder of each file and the folder above it (the folder itself may be renamed and made
    /// anew), likewise for every symbolic link on the way, and for a missing folder the nearest one that exists.
    pub fn of<'a>(files: impl IntoIterator<Item = &'a PathBuf>) -> Self {
        let mut places = Self::default();
        for file in files {
            places.add(file);
        }
        places
    }

    /// The dependencies that an event at `path` may have changed.
    pub fn concerned(&self, path: &Path) -> Option<&BTreeSet<PathBuf>> {
        self.steps.get(path)
    }

    fn add(&mut self, file: &Path) {
        let absolute = std::path::absolute(file).unwrap_or_else(|_| file.to_path_buf());
        let mut rest: VecDeque<OsString> = absolute.components().map(|c| c.as_os_str().to_owned()).collect();
        let (mut at, mut links) = (PathBuf::new(), 0);
        while let Some(part) = rest.pop_front() {
            let part = PathBuf::from(part);
            match part.components().next() {
                Some(Component::Normal(_)) => {}
                Some(Component::ParentDir) => {
                    at.pop();
                    continue;
                }
                Some(Component::CurDir) | None => continue,
                Some(Component::RootDir | Component::Prefix(_)) => {
                    at.push(part);
                    continue;
                }
            }
            let folder = at.clone();
            at.push(part);
            self.steps.entry(at.clone()).or_default().insert(file.to_path_buf());
            match std::fs::symlink_metadata(&at) {
                Ok(meta) if meta.is_symlink() && links < MOST_LINKS => {
                    links += 1;
                    self.listen(&folder);
                    let Ok(target) = std::fs::read_link(&at) else { return };
                    at = if target.is_absolute() { PathBuf::new() } else { folder };
                    for part in target.components().rev() {
                        rest.push_front(part.as_os_str().to_owned());
                    }
                }
                Ok(_) if rest.is_empty() => self.listen(&folder),
                Ok(meta) if meta.is_dir() => {}
                Ok(_) | Err(_) => return self.listen(&folder),
            }
        }
    }

    /// Listens in a folder and in the one above it.
    fn listen(&mut self, folder: &Path) {
        self.folders.insert(folder.to_path_buf());
        self.folders.extend(folder.parent().map(Path::to_path_buf));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dir() -> (tempfile::TempDir, PathBuf) {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().canonicalize().unwrap();
        (dir, path)
    }

    #[test]
    fn a_file_is_reached_through_its_folder() {
        let (_dir, root) = dir();
        std::fs::create_dir(root.join("a")).unwrap();
        let file = root.join("a/x.lua");
        let expected: BTreeSet<_> = [root.clone(), root.join("a")].into();
        for _ in 0..2 {
            let places = Places::of([&file]);
            assert_eq!(places.folders, expected, "present or missing");
            assert!(places.concerned(&file).is_some_and(|d| d.contains(&file)));
            assert!(places.concerned(&root.join("a")).is_some(), "the folder itself");
            assert!(places.concerned(&root.join("a/y.lua")).is_none());
            std::fs::write(&file, "").unwrap();
        }
    }

    #[test]
    fn a_missing_folder_is_awaited_in_the_nearest_one() {
        let (_dir, root) = dir();
        let file = root.join("a/b/c/x.lua");
        let places = Places::of([&file]);
        assert!(places.folders.contains(&root));
        assert!(places.concerned(&root.join("a")).is_some());
        assert!(!places.folders.contains(&root.join("a")));
    }

    #[cfg(unix)]
    #[test]
    fn links_are_followed_step_by_step() {
        use std::os::unix::fs::symlink;
        let (_dir, root) = dir();
        std::fs::create_dir_all(root.join("real/deep")).unwrap();
        std::fs::create_dir_all(root.join("here")).unwrap();
        std::fs::write(root.join("real/deep/x.lua"), "").unwrap();
        symlink(root.join("real"), root.join("here/folder")).unwrap();
        symlink("../here/folder/deep/x.lua", root.join("here/x.lua")).unwrap();
        let file = root.join("here/x.lua");
        let places = Places::of([&file]);
        for folder in ["here", "real/deep"] {
            assert!(places.folders.contains(&root.join(folder)), "{folder}");
        }
        for step in ["here/x.lua", "here/folder", "real", "real/deep", "real/deep/x.lua"] {
            assert!(places.concerned(&root.join(step)).is_some(), "{step}");
        }
        // A link to itself ends.
        symlink("loop", root.join("loop")).unwrap();
        Places::of([&root.join("loop")]);
    }
}
