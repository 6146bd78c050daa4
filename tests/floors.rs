//! The floors of the house: a room of `src` may use what stands below it, never what stands beside or above.
//!
//! The table is read from `docs/architecture.md`, so the page and this test cannot disagree. Sources are read as text:
//! comments and strings are skipped, and every path that begins with `crate`, `$crate`, `coif`, `self` or `super` is
//! followed to its room, in `use` trees and inline, modules within a file included.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// A word, `::` or one other character, with its line.
#[derive(Clone, Debug, PartialEq)]
struct Token {
    text: String,
    line: usize,
}

/// Rust source as tokens, without comments, strings, characters and lifetimes.
fn tokens(source: &str) -> Vec<Token> {
    let chars: Vec<char> = source.chars().collect();
    let at = |i: usize| chars.get(i).copied().unwrap_or('\0');
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    let (mut out, mut i, mut line) = (Vec::new(), 0, 1);
    while i < chars.len() {
        let start = i;
        match at(i) {
            '/' if at(i + 1) == '/' => {
                while i < chars.len() && at(i) != '\n' {
                    i += 1;
                }
            }
            '/' if at(i + 1) == '*' => {
                let mut depth = 0;
                loop {
                    match (at(i), at(i + 1)) {
                        ('/', '*') => (depth, i) = (depth + 1, i + 2),
                        ('*', '/') => (depth, i) = (depth - 1, i + 2),
                        _ => i += 1,
                    }
                    if depth == 0 || i >= chars.len() {
                        break;
                    }
                }
            }
            '"' => i = string_end(&chars, i),
            '\'' => {
                // `'a` is a lifetime unless a quote follows; `'\n'` is a character.
                if at(i + 1) == '\\' {
                    i += 3;
                    while i < chars.len() && at(i) != '\'' {
                        i += 1;
                    }
                    i += 1;
                } else if at(i + 2) == '\'' {
                    i += 3;
                } else {
                    i += 1;
                    while is_word(at(i)) {
                        i += 1;
                    }
                }
            }
            c if is_word(c) => {
                while is_word(at(i)) {
                    i += 1;
                }
                let word: String = chars[start..i].iter().collect();
                let is_raw = matches!(word.as_str(), "r" | "br" | "cr");
                if is_raw && (at(i) == '"' || at(i) == '#' && (at(i + 1) == '"' || at(i + 1) == '#')) {
                    i = raw_string_end(&chars, i);
                } else if is_raw && at(i) == '#' {
                    // r#type: the word follows as a token of its own.
                    i += 1;
                } else if matches!(word.as_str(), "b" | "c") && at(i) == '"' {
                    i = string_end(&chars, i);
                } else {
                    out.push(Token { text: word, line });
                }
            }
            ':' if at(i + 1) == ':' => {
                out.push(Token { text: "::".into(), line });
                i += 2;
            }
            c => {
                if !c.is_whitespace() {
                    out.push(Token { text: c.to_string(), line });
                }
                i += 1;
            }
        }
        line += chars[start..i.min(chars.len())].iter().filter(|&&c| c == '\n').count();
    }
    out
}

/// After the closing quote of the string that opens at `i`.
fn string_end(chars: &[char], mut i: usize) -> usize {
    i += 1;
    while i < chars.len() && chars[i] != '"' {
        i += if chars[i] == '\\' { 2 } else { 1 };
    }
    i + 1
}

/// After the closing quote and hashes of the raw string whose hashes begin at `i`.
fn raw_string_end(chars: &[char], mut i: usize) -> usize {
    let hashes = chars[i..].iter().take_while(|&&c| c == '#').count();
    i += hashes + 1;
    while i < chars.len() {
        if chars[i] == '"' && chars[i + 1..].iter().take_while(|&&c| c == '#').count() >= hashes {
            return i + 1 + hashes;
        }
        i += 1;
    }
    i
}

/// One mention of something at the root of the crate: (name, line).
type Mention = (String, usize);

/// Everything at the root of the crate that a file names. `module` is the file's path of modules: `["head", "load"]`.
fn mentions(module: &[String], tokens: &[Token]) -> Vec<Mention> {
    let text = |i: usize| tokens.get(i).map_or("", |t| t.text.as_str());
    let mut found = Vec::new();
    // Modules within the file, each with the depth of braces at which it ends.
    let (mut depth, mut inner): (usize, Vec<(String, usize)>) = (0, Vec::new());
    for i in 0..tokens.len() {
        match text(i) {
            "{" => depth += 1,
            "}" => {
                depth = depth.saturating_sub(1);
                inner.retain(|&(_, end)| end < depth + 1);
            }
            "mod" if text(i + 2) == "{" => inner.push((text(i + 1).to_owned(), depth + 1)),
            "crate" | "self" | "super" | "coif" if text(i + 1) == "::" && (i == 0 || text(i - 1) != "::") => {
                let mut at: Vec<String> = match text(i) {
                    "crate" | "coif" => Vec::new(),
                    _ => module.iter().cloned().chain(inner.iter().map(|(name, _)| name.clone())).collect(),
                };
                // A tree of `super`s and groups is walked to the names below it.
                if text(i) == "super" {
                    at.pop();
                }
                follow(tokens, i + 2, at, &mut found);
            }
            _ => {}
        }
    }
    found
}

/// Follows the path whose next part is token `i`, below the module `at`; returns the token after it.
fn follow(tokens: &[Token], mut i: usize, mut at: Vec<String>, found: &mut Vec<Mention>) -> usize {
    let text = |i: usize| tokens.get(i).map_or("", |t| t.text.as_str());
    loop {
        match text(i) {
            "super" => _ = at.pop(),
            "self" => {}
            "{" => {
                i += 1;
                while i < tokens.len() && text(i) != "}" {
                    i = if text(i) == "," { i + 1 } else { follow(tokens, i, at.clone(), found) };
                }
                return i + 1;
            }
            name => {
                if at.is_empty() {
                    found.push((name.to_owned(), tokens.get(i).map_or(0, |t| t.line)));
                }
                // Below a named room nothing can lead back to the root: skip to the end of this branch.
                let mut depth = 0;
                while i < tokens.len() {
                    match text(i) {
                        "{" => depth += 1,
                        "}" if depth == 0 => return i,
                        "}" => depth -= 1,
                        "," | ";" if depth == 0 => return i,
                        _ => {}
                    }
                    if depth == 0 && !matches!(text(i), "}" | "::" | "*" | "as") && !is_name(text(i)) {
                        return i + 1;
                    }
                    i += 1;
                }
                return i;
            }
        }
        if text(i + 1) != "::" {
            return i + 1;
        }
        i += 2;
    }
}

fn is_name(text: &str) -> bool {
    text.chars().next().is_some_and(|c| c.is_alphabetic() || c == '_')
}

/// Floors by room, from the table of `docs/architecture.md`.
fn floors(page: &str) -> BTreeMap<String, u32> {
    let mut floors = BTreeMap::new();
    for row in page.lines().filter(|l| l.starts_with('|')) {
        let cells: Vec<&str> = row.split('|').map(str::trim).collect();
        let (Some(Ok(floor)), Some(rooms)) = (cells.get(1).map(|c| c.parse::<u32>()), cells.get(2)) else { continue };
        for room in rooms.split(',').map(|r| r.trim().trim_matches('`')) {
            assert_eq!(floors.insert(room.to_owned(), floor), None, "`{room}` stands twice in the table");
        }
    }
    floors
}

/// A file of `src`, or a made-up one.
struct Source {
    /// Relative to `src`, with `/`.
    path: String,
    tokens: Vec<Token>,
}

impl Source {
    fn new(path: &str, text: &str) -> Self {
        Self { path: path.to_owned(), tokens: tokens(text) }
    }

    /// `head/load/obj.rs` is `["head", "load", "obj"]`, `head/mod.rs` is `["head"]`.
    fn module(&self) -> Vec<String> {
        let path = self.path.trim_end_matches(".rs");
        let mut parts: Vec<String> = path.split('/').map(str::to_owned).collect();
        if parts.last().is_some_and(|p| p == "mod") {
            parts.pop();
        }
        parts
    }

    /// The doors of the house: they belong to no room.
    fn is_door(&self) -> bool {
        self.path == "lib.rs" || self.path == "main.rs"
    }
}

/// Every import that goes up or aside, and everything that stands on no floor.
fn complaints(floors: &BTreeMap<String, u32>, sources: &[Source]) -> Vec<String> {
    let mut complaints = Vec::new();
    // `#[macro_export]` lifts a macro to the root; it still belongs to the room that defines it.
    let mut macros = BTreeMap::new();
    for source in sources {
        for w in source.tokens.windows(3) {
            if w[0].text == "macro_rules" && w[1].text == "!" {
                macros.insert(w[2].text.clone(), source.module()[0].clone());
            }
        }
    }
    for source in sources.iter().filter(|s| !s.is_door()) {
        let module = source.module();
        let room = &module[0];
        let Some(floor) = floors.get(room) else {
            complaints.push(format!("src/{}: `{room}` has no floor in docs/architecture.md", source.path));
            continue;
        };
        for (name, line) in mentions(&module, &source.tokens) {
            let target = macros.get(&name).unwrap_or(&name);
            if target == room {
                continue;
            }
            let place = format!("src/{}:{line}", source.path);
            match floors.get(target) {
                None => complaints.push(format!("{place}: `{name}` is no room of the house")),
                Some(other) if other >= floor => {
                    complaints.push(format!("{place}: `{room}` (floor {floor}) uses `{target}` (floor {other})"));
                }
                Some(_) => {}
            }
        }
    }
    complaints.dedup();
    complaints
}

/// Everything outside `cli` that writes to the terminal.
fn prints(sources: &[Source]) -> Vec<String> {
    const MACROS: [&str; 5] = ["println", "eprintln", "print", "eprint", "dbg"];
    let mut found = Vec::new();
    for source in sources.iter().filter(|s| s.module()[0] != "cli") {
        let text = |i: usize| source.tokens.get(i).map_or("", |t| t.text.as_str());
        for (i, token) in source.tokens.iter().enumerate() {
            let name = token.text.as_str();
            let is_macro = MACROS.contains(&name) && text(i + 1) == "!";
            let is_method = i > 0 && text(i - 1) == ".";
            let is_stream = matches!(name, "stdout" | "stderr") && text(i + 1) == "(" && text(i + 2) == ")";
            if is_macro || is_stream && !is_method {
                found.push(format!("src/{}:{}: only `cli` prints, but here is `{name}`", source.path, token.line));
            }
        }
    }
    found
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn house() -> (BTreeMap<String, u32>, Vec<Source>) {
    let page = fs::read_to_string(root().join("docs/architecture.md")).expect("docs/architecture.md");
    let mut files = Vec::new();
    collect(&root().join("src"), &mut files);
    files.sort();
    let sources = files
        .iter()
        .map(|file| {
            let path = file.strip_prefix(root().join("src")).expect("below src").to_string_lossy().replace('\\', "/");
            Source::new(&path, &fs::read_to_string(file).expect("a source file"))
        })
        .collect();
    (floors(&page), sources)
}

fn collect(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("a folder of src") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            collect(&path, files);
        } else if path.extension().is_some_and(|e| e == "rs") {
            files.push(path);
        }
    }
}

#[test]
fn imports_go_down_only() {
    let (floors, sources) = house();
    assert!(sources.len() > 20, "only {} files were read", sources.len());
    let complaints = complaints(&floors, &sources);
    assert!(complaints.is_empty(), "\n{}", complaints.join("\n"));
    // The checker sees the imports that are there: without any, it would pass on everything.
    let seen: usize = sources.iter().map(|s| mentions(&s.module(), &s.tokens).len()).sum();
    assert!(seen > 20, "only {seen} mentions were found");
}

#[test]
fn the_table_names_the_rooms_that_are_there() {
    let (floors, sources) = house();
    let mut rooms: Vec<String> = sources.iter().filter(|s| !s.is_door()).map(|s| s.module()[0].clone()).collect();
    rooms.sort();
    rooms.dedup();
    assert_eq!(rooms, floors.keys().cloned().collect::<Vec<_>>(), "rooms of src beside those of the table");
}

#[test]
fn only_the_command_line_prints() {
    let (_, sources) = house();
    let found = prints(&sources);
    assert!(found.is_empty(), "\n{}", found.join("\n"));
}

// --- the checker itself, on made-up houses -------------------------------------------------------------------------

const PAGE: &str = "\
| floor | rooms | knows |\n| --- | --- | --- |\n| 9 | `cli` | x |\n| 5 | `scene` | x |\n| 4 | `groom`, `tuft` | x |\n\
| 2 | `geometry` | x |\n| 1 | `params` | x |\n";

fn complain(path: &str, text: &str) -> Vec<String> {
    let macros = Source::new("params/mod.rs", "#[macro_export] macro_rules! params { () => {} }");
    complaints(&floors(PAGE), &[macros, Source::new(path, text)])
}

#[test]
fn upward_and_sideways_imports_are_caught() {
    let up = "src/groom/grow.rs:1: `groom` (floor 4) uses `scene` (floor 5)";
    for text in [
        "use crate::scene::Scene;",
        "use crate::{scene};",
        "use crate::{geometry::{Mesh, Strands}, scene::Scene};",
        "use crate::{geometry, {scene::{self, View}}};",
        "pub(crate) use crate::scene as stage;",
        "fn f(s: &crate::scene::Scene) {}",
        "fn f() { let x = (crate::scene::make)(crate::geometry::y); }",
        "use super::super::scene;",
        "use super::super::{geometry::Mesh, scene::Scene};",
        "use self::super::super::scene;",
        "mod tests { use super::super::super::scene::Scene; }",
        "mod a { mod b {} } use super::super::scene::Scene;",
        "macro_rules! m { () => { $crate::scene::Scene } }",
        "/* /* nested */ crate::cli */ use crate::scene::Scene; // crate::cli",
        "fn f<'a>(x: &'a str) -> char { g('\"'); g('\\''); crate::scene::NAME }",
        r##"const S: &str = r#"crate::cli" "#; use crate::scene::X;"##,
        "impl crate::scene::Trait for X {}",
        "vec![crate::scene::View::Front];",
    ] {
        assert_eq!(complain("groom/grow.rs", text), [up], "{text}");
    }
    assert_eq!(
        complain("groom/mod.rs", "\n\nuse crate::tuft::Tuft;"),
        ["src/groom/mod.rs:3: `groom` (floor 4) uses `tuft` (floor 4)"]
    );
    assert_eq!(
        complain("geometry/mesh.rs", "use crate::{\n    params,\n    groom::Grow,\n    cli,\n};").len(),
        2,
        "several complaints of one file"
    );
    assert_eq!(
        complain("params/read.rs", "use super::super::geometry::Mesh;"),
        ["src/params/read.rs:1: `params` (floor 1) uses `geometry` (floor 2)"]
    );
    assert_eq!(complain("attic/mod.rs", ""), ["src/attic/mod.rs: `attic` has no floor in docs/architecture.md"]);
    assert_eq!(complain("groom/mod.rs", "use crate::Scene;"), ["src/groom/mod.rs:1: `Scene` is no room of the house"]);
}

#[test]
fn downward_imports_and_mere_words_are_not() {
    for text in [
        "use crate::geometry::{Mesh, Strands};",
        "use crate::{geometry::{self, Mesh}, params};",
        "use super::scene;",
        "use super::{scene, cli};",
        "mod tests { use super::super::scene; use super::*; }",
        "use self::scene::Local;",
        "// use crate::scene::Scene;",
        "/// [`Scene`](crate::scene::Scene)\nfn f() {}",
        "const S: &str = \"crate::scene \\\" crate::cli\";",
        "const S: &str = r\"crate::scene\\\";",
        "const S: &str = r##\"crate::\"#scene\"##;",
        "crate::params! { struct X { } }",
        "use crate::groom::inner; use crate::params;",
        "use other::crate_like::scene; use std::scene::x;",
        "pub(crate) fn scene() {} pub(in crate::groom) fn g() {}",
    ] {
        assert_eq!(complain("groom/grow.rs", text), Vec::<String>::new(), "{text}");
    }
    assert_eq!(complain("lib.rs", "pub mod scene; use crate::cli;"), Vec::<String>::new());
}

#[test]
fn printing_is_caught() {
    let found = |path: &str, text: &str| prints(&[Source::new(path, text)]);
    for text in ["println!(\"x\")", "std::eprintln!()", "dbg!(x)", "std::io::stdout().lock()", "stderr()"] {
        assert_eq!(found("render/mod.rs", text).len(), 1, "{text}");
        assert!(found("cli/mod.rs", text).is_empty(), "{text}");
    }
    for text in ["// println!()", "\"println!()\"", "command.stdout(x)", "output.stdout()", "fn print() {}"] {
        assert!(found("render/mod.rs", text).is_empty(), "{text}");
    }
    assert_eq!(
        found("script/host.rs", "\n\n\"\n\"; print!(\"x\")"),
        ["src/script/host.rs:4: only `cli` prints, but here is `print`"]
    );
}
