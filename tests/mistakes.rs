//! The gallery of mistakes: every `tests/mistakes/NAME.lua` must be answered with the text in `NAME.txt`.
//!
//! `COIF_ACCEPT=1 cargo test --test mistakes` writes the texts anew; read the difference before it is kept. A first line
//! `-- set: a=1 b=2` gives parameters as `--set` does.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use coif::script::{Disk, Ending, Options, run, show_all};
use coif::task::Task;

fn scripts() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/mistakes");
    let mut all: Vec<PathBuf> = std::fs::read_dir(folder)
        .unwrap()
        .map(|e| e.unwrap().path())
        .filter(|p| p.extension().is_some_and(|e| e == "lua"))
        .collect();
    all.sort();
    all
}

/// What a person sees.
fn answer(path: &Path) -> String {
    // Named as from the project's folder, so that the texts do not depend on where it lies.
    let name = Path::new("tests/mistakes").join(path.file_name().unwrap());
    let mut options = Options::new(&name);
    options.time_limit = Duration::from_secs(20);
    let text = std::fs::read_to_string(path).unwrap();
    if let Some(set) = text.lines().next().and_then(|l| l.strip_prefix("-- set: ")) {
        options.set = set.split(' ').filter_map(|s| s.split_once('=')).map(|(k, v)| (k.into(), v.into())).collect();
    }
    let outcome = run(&options, Arc::new(Disk), &Task::new());
    let head = match outcome.ending {
        Ending::Done => "done\n\n",
        Ending::Failed => "",
        Ending::Cancelled => "cancelled\n\n",
    };
    format!("{head}{}", show_all(&outcome.diagnostics, &outcome.sources, false))
}

#[test]
fn every_mistake_is_answered() {
    std::env::set_current_dir(env!("CARGO_MANIFEST_DIR")).unwrap();
    let scripts = scripts();
    assert!(scripts.len() >= 25, "only {} mistakes", scripts.len());
    let accept = std::env::var_os("COIF_ACCEPT").is_some();
    let mut failed = vec![];
    for path in scripts {
        let got = answer(&path);
        let expected_path = path.with_extension("txt");
        if accept {
            std::fs::write(&expected_path, &got).unwrap();
            continue;
        }
        let expected = std::fs::read_to_string(&expected_path).unwrap_or_default();
        if got != expected {
            failed.push(format!("--- {}\nexpected:\n{expected}\ngot:\n{got}", path.display()));
        }
    }
    assert!(failed.is_empty(), "{}", failed.join("\n"));
}
