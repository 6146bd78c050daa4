//! Every snippet in the docs runs, every file that the docs name is there.
//!
//! Blocks of Lua in Markdown are whole scripts. A block opened by "```lua file=PATH" is that file, byte for byte, and one
//! opened by "```lua continued" goes on from the block before it. Blocks marked "```lua test" are test files, and run as
//! such beside the examples. There is no way to leave one out.

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use coif::head::mannequin::{self, Style};
use coif::script::{Disk, Ending, Files, Memory, Options, run, show_all};
use coif::task::Task;
use coif::workbench::test::{TestOptions, test};

/// A block of Lua.
struct Snippet {
    page: PathBuf,
    line: usize,
    file: Option<String>,
    is_test: bool,
    text: String,
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Files with that ending below a folder, sorted.
fn files(folder: &Path, ending: &str) -> Vec<PathBuf> {
    let mut out = vec![];
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            out.extend(files(&path, ending));
        } else if path.extension().is_some_and(|e| e == ending) {
            out.push(path);
        }
    }
    out.sort();
    out
}

fn pages() -> Vec<PathBuf> {
    let mut pages = files(&root().join("docs"), "md");
    pages.push(root().join("README.md"));
    pages
}

/// The blocks of a page, continuations joined to what they go on from.
fn snippets(page: &Path, text: &str) -> Vec<Snippet> {
    let mut out: Vec<Snippet> = vec![];
    let mut lines = text.lines().enumerate();
    while let Some((i, line)) = lines.next() {
        let Some(info) = line.trim_start().strip_prefix("```") else { continue };
        let at = format!("{}:{}", page.display(), i + 1);
        let mut body = String::new();
        for (_, line) in lines.by_ref().take_while(|(_, l)| l.trim_start() != "```") {
            let _ = writeln!(body, "{line}");
        }
        let (language, mark) = info.split_once(' ').unwrap_or((info, ""));
        if language != "lua" {
            continue;
        }
        match mark {
            "continued" => out.last_mut().unwrap_or_else(|| panic!("{at}: goes on from nothing")).text += &body,
            _ => {
                let (file, is_test) = (mark.strip_prefix("file="), mark == "test");
                assert!(mark.is_empty() || is_test || file.is_some(), "{at}: `{mark}` is not a mark of a snippet");
                let file = file.map(ToOwned::to_owned);
                out.push(Snippet { page: page.to_path_buf(), line: i + 1, file, is_test, text: body });
            }
        }
    }
    out
}

/// The mannequin as an OBJ, for snippets that load a head.
fn anna() -> String {
    let mesh = mannequin::mesh(Style::Adult);
    let mut obj = String::new();
    for p in &mesh.positions {
        let _ = writeln!(obj, "v {} {} {}", p.x, p.y, p.z);
    }
    for t in &mesh.triangles {
        let _ = writeln!(obj, "f {} {} {}", t[0] + 1, t[1] + 1, t[2] + 1);
    }
    obj
}

/// Runs a script with few strands; what is wrong with it, if anything.
fn problem(name: &str, text: &str, files: &Memory) -> Option<String> {
    let mut options = Options::new(name);
    let words: Vec<&str> = text.split_whitespace().collect();
    if text.contains("coif.params") && words.windows(3).any(|w| w[..2] == ["strands", "="] && !w[2].starts_with("p.")) {
        options.set.insert("strands".into(), "300".into());
    }
    let outcome = run(&options, Arc::new(files.clone().with(name, text)), &Task::new());
    let told = show_all(&outcome.diagnostics, &outcome.sources, false);
    match outcome.ending {
        Ending::Done if outcome.diagnostics.is_empty() => None,
        Ending::Done | Ending::Failed => Some(told),
        Ending::Cancelled => Some("cancelled".into()),
    }
}

/// Runs a test file beside the examples, once to keep its pictures and once in earnest; what is wrong, if anything.
fn test_problem(text: &str) -> Option<String> {
    let dir = tempfile::tempdir().unwrap();
    for example in files(&root().join("examples"), "lua") {
        std::fs::copy(&example, dir.path().join(example.file_name().unwrap())).unwrap();
    }
    let path = dir.path().join("snippet_test.lua");
    std::fs::write(&path, text).unwrap();
    let run = |accept| {
        let script = Options::new(&path);
        let options = TestOptions { path: path.clone(), filter: None, accept, out: dir.path().join("out"), script };
        let files: Arc<dyn Files> = Arc::new(Disk);
        let mut told = String::new();
        let report = test(&options, &files, &Task::new(), |result| {
            told += &show_all(&result.failures, &result.sources, false);
        });
        (report.unwrap().is_passed(), told)
    };
    run(true);
    let (is_passed, told) = run(false);
    (!is_passed).then_some(told)
}

#[test]
fn every_snippet_runs() {
    let files = Memory::default().with("anna.obj", anna());
    let (mut problems, mut count) = (vec![], 0);
    for page in pages() {
        let text = std::fs::read_to_string(&page).unwrap();
        for snippet in snippets(&page, &text) {
            count += 1;
            let at = format!("{}:{}", snippet.page.strip_prefix(root()).unwrap().display(), snippet.line);
            if let Some(file) = &snippet.file {
                let path = snippet.page.with_file_name("").join(file);
                let same = std::fs::read_to_string(&path).is_ok_and(|t| t == snippet.text);
                if !same {
                    problems.push(format!("{at}: not the text of {file}"));
                }
            }
            let problem = match snippet.is_test {
                true => test_problem(&snippet.text),
                false => problem("snippet.lua", &snippet.text, &files),
            };
            if let Some(problem) = problem {
                problems.push(format!("{at}:\n{problem}"));
            }
        }
    }
    assert!(problems.is_empty(), "{}", problems.join("\n"));
    assert!(count >= 15, "only {count} snippets found");
}

/// What `coif new` makes runs as it is, and is short enough to be read.
#[test]
fn the_starter_style_runs() {
    let text = include_str!("../scripts/new/style.lua");
    assert_eq!(problem("NAME.lua", text, &Memory::default()), None);
    assert!(text.lines().count() <= 60);
}

#[test]
fn every_link_leads_somewhere() {
    let mut broken = vec![];
    for page in files(&root().join("docs"), "md") {
        let text = std::fs::read_to_string(&page).unwrap();
        for link in text.split("](").skip(1).filter_map(|rest| rest.split(')').next()) {
            let (file, anchor) = link.split_once('#').unwrap_or((link, ""));
            if file.contains("://") {
                continue;
            }
            let target = if file.is_empty() { page.clone() } else { page.with_file_name("").join(file) };
            let is_there = if anchor.is_empty() { target.exists() } else { has_heading(&target, anchor) };
            if !is_there {
                broken.push(format!("{}: {link}", page.display()));
            }
        }
    }
    assert!(broken.is_empty(), "{}", broken.join("\n"));
}

/// Whether a page has the heading that an anchor stands for.
fn has_heading(page: &Path, anchor: &str) -> bool {
    let plain = |heading: &str| -> String {
        let kept = heading.trim().to_lowercase();
        kept.chars()
            .filter(|c| c.is_alphanumeric() || "_- ".contains(*c))
            .map(|c| if c == ' ' { '-' } else { c })
            .collect()
    };
    std::fs::read_to_string(page)
        .is_ok_and(|t| t.lines().filter(|l| l.starts_with('#')).any(|l| plain(l.trim_start_matches('#')) == anchor))
}

#[test]
fn marks_of_snippets_are_read() {
    let page = Path::new("page.md");
    let read =
        snippets(page, "```lua\na\n```\ntext\n```lua continued\nb\n```\n```sh\nx\n```\n```lua file=f.lua\nc\n```\n");
    let texts: Vec<(&str, Option<&str>, usize)> =
        read.iter().map(|s| (s.text.as_str(), s.file.as_deref(), s.line)).collect();
    assert_eq!(texts, [("a\nb\n", None, 1), ("c\n", Some("f.lua"), 11)]);
    let ignored = std::panic::catch_unwind(|| snippets(page, "```lua ignore\na\n```\n").len());
    assert!(ignored.is_err());
}
