//! The committed reference and editor definitions are what the program makes.

use std::collections::BTreeMap;
use std::path::Path;

use coif::script::api;

/// Every file below a folder, by its name with `/`.
fn files(folder: &Path, below: &str, out: &mut BTreeMap<String, Vec<u8>>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let entry = entry.unwrap();
        let name = format!("{below}{}", entry.file_name().to_string_lossy());
        if entry.path().is_dir() {
            files(&entry.path(), &format!("{name}/"), out);
        } else {
            out.insert(name, std::fs::read(entry.path()).unwrap());
        }
    }
}

#[test]
fn the_reference_is_fresh() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/reference");
    let mut committed = BTreeMap::new();
    files(&folder, "", &mut committed);
    let mut stale = vec![];
    for made in api::definitions().into_iter().chain(api::pages()) {
        if committed.remove(&made.name).as_deref() != Some(made.text.as_bytes()) {
            stale.push(format!("{} is stale", made.name));
        }
    }
    stale.extend(committed.keys().map(|name| format!("{name} is made no more: delete it")));
    assert!(stale.is_empty(), "in docs/reference:\n{}\nrun: cargo run -- api --out docs/reference", stale.join("\n"));
}

/// Every name of the language stands in the definitions and in the pages.
#[test]
fn nothing_is_left_out() {
    let registry = coif::script::registry::registry();
    let definitions = &api::definitions()[0].text;
    let pages: String = api::pages().iter().map(|p| p.text.as_str()).collect();
    let methods = registry.nouns.iter().flat_map(|n| &n.methods);
    for entry in registry.functions.iter().chain(&registry.test_functions).chain(methods) {
        assert!(definitions.contains(&format!("function {}(", entry.name)), "{}", entry.name);
        assert!(pages.contains(&format!("## {}\n", entry.name)), "{}", entry.name);
        for field in (entry.fields)() {
            assert!(!field.doc.is_empty(), "{} of {}", field.name, entry.name);
        }
    }
    // No class is spoken of that is not declared.
    let declared: Vec<&str> = definitions
        .lines()
        .filter_map(|l| l.strip_prefix("---@class ").or_else(|| l.strip_prefix("---@alias ")))
        .filter_map(|l| l.trim_start_matches("(exact) ").split(' ').next())
        .collect();
    for line in
        definitions.lines().filter(|l| ["---@field", "---@param", "---@return"].iter().any(|t| l.starts_with(t)))
    {
        let code = line.split(" # ").next().unwrap();
        for word in code.split(|c: char| !(c.is_ascii_alphanumeric() || c == '_' || c == '.')) {
            if word.starts_with("coif.") {
                assert!(declared.contains(&word), "`{word}` in {line}");
            }
        }
    }
    let mut twice = declared.clone();
    twice.sort_unstable();
    twice.dedup();
    assert_eq!(twice.len(), declared.len(), "a class is declared twice");
}
