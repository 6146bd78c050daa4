//! Which golden pictures are used, by whom, and which by nobody.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use super::ENDING;
use crate::script::{Diagnostic, Place, Preview};

/// The golden pictures that tests have referred to.
#[derive(Debug)]
pub struct Goldens {
    /// Where each is asked for.
    used: BTreeMap<PathBuf, Option<Place>>,
    /// Folders of test files.
    folders: BTreeSet<PathBuf>,
    /// Names of difference pictures given so far.
    names: BTreeSet<String>,
    /// False once a test was left out or ended early: then nothing is known about unused pictures.
    pub is_complete: bool,
}

impl Default for Goldens {
    fn default() -> Self {
        Self { used: BTreeMap::new(), folders: BTreeSet::new(), names: BTreeSet::new(), is_complete: true }
    }
}

impl Goldens {
    /// Notes a test file.
    pub fn see(&mut self, file: &Path) {
        self.folders.insert(file.parent().map(Path::to_path_buf).unwrap_or_default());
    }

    /// Notes a reference; the error when another test refers to the same picture.
    pub fn refer(&mut self, preview: &Preview) -> Option<Diagnostic> {
        match self.used.insert(preview.golden.clone(), preview.place.clone()) {
            None => None,
            Some(before) => {
                let at = before.map(|p| format!(" at {}:{}", p.file, p.line)).unwrap_or_default();
                let mut error = Diagnostic::error(format!("another test{at} has a preview `{}` too", preview.name));
                error.place.clone_from(&preview.place);
                Some(error.hint("give each golden picture of a folder one test"))
            }
        }
    }

    /// A name for the difference picture: the preview's own, unless another folder has one of that name.
    pub fn out_name(&mut self, preview: &Preview) -> String {
        let name = (1..)
            .map(|n| if n == 1 { preview.name.clone() } else { format!("{}_{n}", preview.name) })
            .find(|name| !self.names.contains(name))
            .unwrap_or_default();
        self.names.insert(name.clone());
        name
    }

    /// Golden pictures that no test refers to, of folders whose every test file was run.
    pub fn unused(&self, run: &[PathBuf]) -> Vec<PathBuf> {
        if !self.is_complete {
            return vec![];
        }
        let mut unused = vec![];
        for folder in &self.folders {
            let here = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
            let listed = |path: &Path, ending: &str| -> Vec<PathBuf> {
                let Ok(entries) = std::fs::read_dir(path) else { return vec![] };
                let names = entries.flatten().map(|e| e.file_name().to_string_lossy().into_owned());
                names.filter(|n| n.ends_with(ending)).map(PathBuf::from).collect()
            };
            if listed(here, ENDING).iter().all(|name| run.contains(&folder.join(name))) {
                let golden = folder.join("golden");
                let all = listed(&here.join("golden"), ".png").into_iter().map(|name| golden.join(name));
                unused.extend(all.filter(|p| !self.used.contains_key(p)));
            }
        }
        unused.sort();
        unused
    }
}
