//! The real program, run as a process in a folder of its own.

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::Duration;

const SCRIPT: &str = r#"
local p = coif.params { count = { 12, min = 1, max = 100, integer = true, doc = "how many guides" } }
local head = coif.head()
local down = coif.queue { coif.domain.directional { box = head:box("all"), direction = coif.down, noise = 0.2 } }
local hair = head:scalp():guides { count = p.count, length = 4, step = 1 }:grow { global = down }:fill { strands = 120 }
print("grown", hair.count)
return coif.scene { head, hair, views = { "front" } }
"#;

/// A folder with `style.lua`.
fn folder(script: &str) -> tempfile::TempDir {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("style.lua"), script).unwrap();
    dir
}

fn coif(dir: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_coif")).args(arguments).current_dir(dir).stdin(Stdio::null()).output().unwrap()
}

fn code(output: &Output) -> i32 {
    output.status.code().unwrap_or(-1)
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Names in a folder, sorted; none when there is no folder.
fn names(dir: &Path) -> Vec<String> {
    let Ok(entries) = std::fs::read_dir(dir) else { return vec![] };
    let mut names: Vec<String> = entries.map(|e| e.unwrap().file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

#[test]
fn a_run_writes_its_picture_and_files() {
    let dir = folder(SCRIPT);
    let small = ["run", "style.lua", "--size", "64"];
    let output = coif(dir.path(), &small);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    assert!(output.stdout.is_empty());
    assert!(stderr(&output).contains("grown\t120") && stderr(&output).contains("120 strands"), "{}", stderr(&output));
    assert_eq!(names(&dir.path().join("out")), ["style.glb", "style.png"]);
    let png = std::fs::read(dir.path().join("out/style.png")).unwrap();
    let glb = std::fs::read(dir.path().join("out/style.glb")).unwrap();
    assert!(png.starts_with(b"\x89PNG") && glb.starts_with(b"glTF"));

    // The same bytes again, on one thread and on two, into another folder.
    for threads in ["1", "2"] {
        let out = format!("again{threads}");
        let more = ["--threads", threads, "--out", &out, "--debug", "--guides", "--stats", "--quiet"];
        let output = coif(dir.path(), &[&small[..], &more].concat());
        assert_eq!(code(&output), 0, "{}", stderr(&output));
        let folder = dir.path().join(&out);
        assert_eq!(names(&folder), ["style.debug.png", "style.glb", "style.guides.glb", "style.png"]);
        assert_eq!(std::fs::read(folder.join("style.png")).unwrap(), png, "{threads} threads");
        assert_eq!(std::fs::read(folder.join("style.glb")).unwrap(), glb, "{threads} threads");
        let stats: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        let hair = &stats["parts"][1];
        assert_eq!((&hair["strands"], &hair["inside"]), (&120.into(), &0.into()), "{stats}");
        assert!(stats["ms"]["script"].is_number() && stats["files"].as_array().is_some_and(|f| f.len() == 4));
        assert_eq!(stderr(&output), "grown\t120\n");
    }
    // Another seed, another hair.
    let output = coif(dir.path(), &[&small[..], &["--seed", "1", "-o", "other"]].concat());
    assert_eq!(code(&output), 0);
    assert_ne!(std::fs::read(dir.path().join("other/style.glb")).unwrap(), glb);
}

#[test]
fn after_an_error_nothing_is_written() {
    let dir = folder(&SCRIPT.replace("coif.down", "coif.dwon"));
    std::fs::create_dir(dir.path().join("out")).unwrap();
    std::fs::write(dir.path().join("out/style.png"), "the last good one").unwrap();
    let output = coif(dir.path(), &["run", "style.lua", "--size", "64"]);
    assert_eq!(code(&output), 1);
    let text = stderr(&output);
    assert!(text.contains("style.lua:4:") && text.contains("did you mean `down`?") && !text.contains('\x1b'), "{text}");
    assert_eq!(names(&dir.path().join("out")), ["style.png"]);
    assert_eq!(std::fs::read(dir.path().join("out/style.png")).unwrap(), b"the last good one");

    let output = coif(dir.path(), &["run", "stlye.lua"]);
    assert_eq!(code(&output), 1);
    assert!(stderr(&output).contains("did you mean `style.lua`?"), "{}", stderr(&output));
    assert_eq!(names(dir.path()), ["out", "style.lua"]);
}

#[test]
fn the_command_line_is_checked() {
    let dir = folder(SCRIPT);
    for bad in [
        &["run"][..],
        &["rnu", "style.lua"],
        &["run", "style.lua", "--szie", "64"],
        &["run", "style.lua", "--size", "0"],
        &["run", "style.lua", "--views", "frnt"],
        &["run", "style.lua", "--set", "count"],
        &["run", "style.lua", "--time-limit", "-1"],
        &["run", "style.lua", "--tolerance", "nan"],
        &["run", "style.lua", "--threads", "0"],
        &[],
    ] {
        assert_eq!(code(&coif(dir.path(), bad)), 2, "{bad:?}");
    }
    assert_eq!(names(dir.path()), ["style.lua"]);
    for good in ["--help", "--version"] {
        assert_eq!(code(&coif(dir.path(), &[good])), 0);
    }
    let output = coif(dir.path(), &["run", "style.lua", "--set", "count=101"]);
    assert_eq!(code(&output), 1);
    assert!(stderr(&output).contains("`--set count=101`: `101` is out of range"), "{}", stderr(&output));
}

#[test]
fn a_folder_that_cannot_be_written_is_told() {
    let dir = folder(SCRIPT);
    std::fs::write(dir.path().join("out"), "a file").unwrap();
    let output = coif(dir.path(), &["run", "style.lua", "--size", "64"]);
    assert_eq!(code(&output), 3, "{}", stderr(&output));
    assert!(stderr(&output).contains("cannot write `out`"), "{}", stderr(&output));
    assert_eq!(names(dir.path()), ["out", "style.lua"]);
}

#[test]
fn endless_scripts_end_in_time() {
    let dir = folder("while true do pcall(function() while true do end end) end");
    let output = coif(dir.path(), &["run", "style.lua", "--time-limit", "0.3"]);
    assert_eq!(code(&output), 1);
    assert!(stderr(&output).contains("ran longer than 0.3 s"), "{}", stderr(&output));
}

#[cfg(unix)]
#[test]
fn an_interrupt_cancels_and_leaves_nothing() {
    let dir = folder("while true do end");
    let mut child = Command::new(env!("CARGO_BIN_EXE_coif"))
        .args(["run", "style.lua"])
        .current_dir(dir.path())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // Until it listens, the signal would simply end it; so ask again until it has answered.
    let mut status = None;
    for _ in 0..200 {
        std::thread::sleep(Duration::from_millis(50));
        let kill = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
        std::thread::sleep(Duration::from_millis(50));
        status = child.try_wait().unwrap();
        if status.is_some() {
            break;
        }
        assert!(kill.success());
    }
    let code = status.and_then(|s| s.code());
    // Killed before it listened: no code at all. Either way nothing may lie there.
    assert!(code == Some(130) || code.is_none(), "{code:?}");
    assert_eq!(names(dir.path()), ["style.lua"]);
}

#[test]
fn parameters_are_listed() {
    let dir = folder(SCRIPT);
    let output = coif(dir.path(), &["params", "style.lua", "--set", "count=20"]);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    let text = String::from_utf8(output.stdout).unwrap();
    assert_eq!(text, "count = 20 (default 12)  [integer 1 to 100]: how many guides\n");
    let output = coif(dir.path(), &["params", "style.lua", "--json"]);
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(
        (&json[0]["name"], &json[0]["default"], &json[0]["max"]),
        (&"count".into(), &12.0.into(), &100.0.into())
    );
}

#[test]
fn parameters_are_listed_as_they_are_declared() {
    let dir = folder(
        "local p = coif.params { width = 3, length = { 45, doc = 'a = 1, apple = 2' },\n  apple = true, a = 1 }\n\
         local q = coif.params { first = 1 }\nreturn coif.scene { coif.head() }",
    );
    let output = coif(dir.path(), &["params", "style.lua", "--json"]);
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let names: Vec<_> = json.as_array().unwrap().iter().map(|p| p["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["width", "length", "apple", "a", "first"]);
}

#[test]
fn what_needs_too_much_is_refused_with_the_limit_to_raise() {
    let dir = folder(SCRIPT);
    for (limit, wrong) in [
        (["--points-limit", "100"], "the limit is 100"),
        (["--triangles-limit", "1k"], "the limit is 1,000"),
        (["--memory-limit", "6.1MB"], "of memory"),
    ] {
        let output = coif(dir.path(), &[&["run", "style.lua"], &limit[..]].concat());
        let text = stderr(&output);
        assert_eq!(code(&output), 1, "{limit:?}: {text}");
        assert!(text.contains(wrong) && text.contains(&format!("raise it: `{} ", limit[0])), "{limit:?}: {text}");
        assert!(text.contains("style.lua:"), "{text}");
        assert_eq!(names(dir.path()), ["style.lua"]);
    }
    for command in ["run", "watch", "params", "sheet", "test", "diff"] {
        let text = String::from_utf8(coif(dir.path(), &[command, "--help"]).stdout).unwrap();
        for option in ["--time-limit", "--memory-limit", "--points-limit", "--triangles-limit"] {
            assert!(text.contains(option), "{command} has no {option}");
        }
    }
    assert_eq!(code(&coif(dir.path(), &["run", "style.lua", "--points-limit", "many"])), 2);
}

#[test]
fn another_head_takes_the_place() {
    let dir = folder(SCRIPT);
    let missing = coif(dir.path(), &["run", "style.lua", "--head", "elsewhere/anna.obj"]);
    assert_eq!(code(&missing), 1);
    assert!(stderr(&missing).contains("there is no file `elsewhere/anna.obj`"), "{}", stderr(&missing));
    let not: PathBuf = dir.path().join("anna.obj");
    std::fs::write(&not, "v 1 2\n").unwrap();
    let broken = coif(dir.path(), &["run", "style.lua", "--head", "anna.obj"]);
    assert_eq!(code(&broken), 1);
    assert!(stderr(&broken).contains("anna.obj"), "{}", stderr(&broken));
    assert_eq!(names(dir.path()), ["anna.obj", "style.lua"]);
}

#[test]
fn a_new_style_runs_and_is_never_overwritten() {
    let dir = tempfile::tempdir().unwrap();
    let made = coif(dir.path(), &["new", "fringe"]);
    assert_eq!(code(&made), 0, "{}", stderr(&made));
    let folder = dir.path().join("fringe");
    let all = [".coif", ".emmyrc.json", ".gitignore", ".luarc.json", "fringe.lua", "fringe_test.lua"];
    assert_eq!(names(&folder), all);
    let params = coif(&folder, &["params", "fringe.lua", "--json", "--set", "strands=300"]);
    assert_eq!(code(&params), 0, "{}", stderr(&params));
    for settings in [".emmyrc.json", ".luarc.json"] {
        let text = std::fs::read_to_string(folder.join(settings)).unwrap();
        let json: serde_json::Value = serde_json::from_str(&text).unwrap();
        let library = json.pointer("/workspace/library").or(json.get("workspace.library")).unwrap();
        assert!(folder.join(library[0].as_str().unwrap()).join("coif.lua").is_file());
    }
    std::fs::write(folder.join("fringe.lua"), "mine").unwrap();
    let again = coif(dir.path(), &["new", "fringe"]);
    assert_eq!((code(&again), stderr(&again).as_str()), (3, "error: `fringe` exists already; nothing was written\n"));
    assert_eq!(std::fs::read_to_string(folder.join("fringe.lua")).unwrap(), "mine");
    assert_eq!(code(&coif(dir.path(), &["new", "a b"])), 2);
    assert_eq!(names(dir.path()), ["fringe"]);
}

#[test]
fn the_definitions_are_written() {
    let dir = tempfile::tempdir().unwrap();
    let output = coif(dir.path(), &["api"]);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    let folder = dir.path().join(".coif");
    assert!(std::fs::read_to_string(folder.join("coif.lua")).unwrap().starts_with("---@meta\n"));
    assert!(folder.join("coif/looks.lua").is_file() && folder.join("README.md").is_file());
    std::fs::write(dir.path().join("file"), "").unwrap();
    assert_eq!(code(&coif(dir.path(), &["api", "--out", "file"])), 3);
}
