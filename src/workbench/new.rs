//! What `coif new` and `coif api` write.

use std::io;
use std::path::{Path, PathBuf};

use super::output::{Output, WriteError, Written, write_all};
use crate::script::api;

/// Folder of the editor definitions within a style's folder.
pub const DEFINITIONS: &str = ".coif";

/// Stands for the style's name in the templates.
const PLACEHOLDER: &str = "NAME";

/// Files of a new style; the placeholder stands in names too.
const TEMPLATES: [(&str, &str); 5] = [
    ("NAME.lua", include_str!("../../scripts/new/style.lua")),
    ("NAME_test.lua", include_str!("../../scripts/new/style_test.lua")),
    (".luarc.json", include_str!("../../scripts/new/luarc.json")),
    (".emmyrc.json", include_str!("../../scripts/new/emmyrc.json")),
    (".gitignore", include_str!("../../scripts/new/gitignore")),
];

/// Why there is no new style.
#[derive(Debug, thiserror::Error)]
pub enum NewError {
    /// Its name would not do for files and modules.
    #[error("`{0}` cannot be the name of a style: letters, digits, `_` and `-` can, beginning with a letter")]
    Name(String),
    /// There is something already.
    #[error("`{}` exists already; nothing was written", .0.display())]
    Exists(PathBuf),
    /// The disk would not.
    #[error(transparent)]
    Write(#[from] WriteError),
}

/// Makes the folder of a new style, named after the last part of the path. It appears whole or not at all.
///
/// # Errors
/// [`NewError`] when the name will not do, when anything is there already, or when it cannot be written.
pub fn new(folder: &Path) -> Result<Vec<PathBuf>, NewError> {
    let name = folder.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    let letters = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    if !name.starts_with(|c: char| c.is_ascii_alphabetic()) || !name.chars().all(letters) {
        return Err(NewError::Name(folder.display().to_string()));
    }
    if folder.symlink_metadata().is_ok() {
        return Err(NewError::Exists(folder.to_path_buf()));
    }
    let outputs: Vec<Output> = TEMPLATES
        .iter()
        .map(|(file, text)| (file.replace(PLACEHOLDER, &name), text.replace(PLACEHOLDER, &name)))
        .chain(api::definitions().into_iter().map(|d| (format!("{DEFINITIONS}/{}", d.name), d.text)))
        .map(|(name, text)| Output { name, bytes: text.into_bytes().into() })
        .collect();
    let failed = |error: io::Error| WriteError { path: folder.to_path_buf(), error };
    let parent = folder.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    std::fs::create_dir_all(parent).map_err(failed)?;
    let beside = tempfile::Builder::new().prefix(".coif-").tempdir_in(parent).map_err(failed)?;
    let ready = beside.path().join(&name);
    write_all(&ready, &outputs)?;
    // A folder that came in the meantime is not replaced: the new one is never empty.
    std::fs::rename(&ready, folder).map_err(failed)?;
    Ok(outputs.iter().map(|o| folder.join(&o.name)).collect())
}

/// Writes the editor definitions and the reference into a folder.
///
/// # Errors
/// [`WriteError`] with the file at fault.
pub fn api(folder: &Path) -> Result<Vec<Written>, WriteError> {
    let documents = api::definitions().into_iter().chain(api::pages());
    let outputs: Vec<Output> = documents.map(|d| Output { name: d.name, bytes: d.text.into_bytes().into() }).collect();
    write_all(folder, &outputs)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_new_style_is_whole_and_named() {
        let dir = tempfile::tempdir().unwrap();
        let folder = dir.path().join("styles/fringe");
        let files = new(&folder).unwrap();
        assert_eq!(files.len(), 5 + api::definitions().len());
        for file in &files {
            let text = std::fs::read_to_string(file).unwrap();
            // The definitions speak of names too.
            assert!(file.starts_with(folder.join(DEFINITIONS)) || !text.contains(PLACEHOLDER), "{}", file.display());
        }
        assert!(folder.join("fringe.lua").is_file() && folder.join(".coif/coif.lua").is_file());
        assert!(std::fs::read_to_string(folder.join("fringe_test.lua")).unwrap().contains("t:run \"fringe.lua\""));
        // Nothing else was left beside it.
        assert_eq!(std::fs::read_dir(dir.path().join("styles")).unwrap().count(), 1);
    }

    #[test]
    fn nothing_is_overwritten() {
        let dir = tempfile::tempdir().unwrap();
        let folder = dir.path().join("bob");
        std::fs::write(&folder, "mine").unwrap();
        let error = new(&folder).unwrap_err();
        assert!(error.to_string().contains(&folder.display().to_string()), "{error}");
        assert_eq!(std::fs::read_to_string(&folder).unwrap(), "mine");
        assert_eq!(std::fs::read_dir(dir.path()).unwrap().count(), 1);
    }

    #[test]
    fn names_that_would_not_do_are_refused() {
        for name in ["", "..", "a b", "1st", "-x", "naïve", "a.lua", "/"] {
            assert!(matches!(new(Path::new(name)), Err(NewError::Name(_))), "{name}");
        }
    }
}
