//! The scripted scenes of `tests/scenes`, and that golden pictures stay small.

use std::path::Path;
use std::sync::Arc;

use coif::script::{Disk, Files, Options, show_all};
use coif::task::Task;
use coif::workbench::test::{TestOptions, test};

/// Largest golden picture, bytes.
const LARGEST: u64 = 30 * 1024;

#[test]
fn every_scene_holds() {
    std::env::set_current_dir(env!("CARGO_MANIFEST_DIR")).unwrap();
    let out = Path::new(env!("CARGO_TARGET_TMPDIR")).join("scenes");
    let options = TestOptions {
        path: "tests/scenes".into(),
        filter: None,
        accept: false,
        out: out.clone(),
        script: Options::new("tests/scenes"),
    };
    let mut failed = vec![];
    let files: Arc<dyn Files> = Arc::new(Disk);
    let report = test(&options, &files, &Task::new(), |result| {
        if !result.failures.is_empty() {
            let text = show_all(&result.failures, &result.sources, false);
            failed.push(format!("{}: {}\n{text}", result.file.display(), result.name));
        }
    });
    let report = report.unwrap();
    assert!(failed.is_empty(), "difference pictures are in {}\n{}", out.display(), failed.join("\n"));
    assert!(report.is_passed(), "unused golden pictures: {:?}", report.unused);
    assert!(report.results.len() >= 20, "only {} tests", report.results.len());
}

#[test]
fn every_example_has_a_test_and_a_small_picture() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let tests = [
        ("examples", "examples_test.lua"),
        ("examples/cartoon", "cartoon_test.lua"),
        ("examples/dynamics", "dynamics_test.lua"),
        ("examples/garments", "garments_test.lua"),
        ("examples/moving", "moving_test.lua"),
    ];
    for (folder, test) in tests {
        let text = std::fs::read_to_string(root.join("tests/scenes").join(test)).unwrap();
        for entry in std::fs::read_dir(root.join(folder)).unwrap() {
            let path = entry.unwrap().path();
            let name = path.file_stem().unwrap().to_string_lossy().into_owned();
            let is_tested = path.extension().is_none_or(|e| e != "lua")
                || text.lines().any(|l| l.split('=').next().is_some_and(|key| key.trim() == name));
            assert!(is_tested, "{} is not in {test}", path.display());
        }
    }
    let mut count = 0;
    for entry in std::fs::read_dir(root.join("tests/scenes/golden")).unwrap() {
        let entry = entry.unwrap();
        let size = entry.metadata().unwrap().len();
        assert!(size <= LARGEST, "{} has {size} bytes", entry.path().display());
        count += 1;
    }
    assert!(count >= 16, "only {count} golden pictures");
}
