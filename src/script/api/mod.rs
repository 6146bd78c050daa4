//! What editors and readers get of the language: definitions that a Lua language server reads, and the reference.
//!
//! Both are made from the [registry](super::registry) alone, so they say what the bindings do. `coif api` writes them;
//! `tests/api.rs` fails when the ones in `docs/reference` are stale.

mod definitions;
mod pages;
mod words;

use super::module::LIBRARY;
use super::registry::registry;

/// A file that was made from the registry.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Document {
    /// Its name below the folder they are written to, with `/`.
    pub name: String,
    /// Its content.
    pub text: String,
}

/// What an editor needs: `coif.lua` with the definitions, and the shipped library where `require` finds it.
pub fn definitions() -> Vec<Document> {
    let library = LIBRARY.iter().map(|(name, text)| Document { name: format!("{name}.lua"), text: (*text).to_owned() });
    let definitions = Document { name: "coif.lua".into(), text: definitions::definitions(registry()) };
    [definitions].into_iter().chain(library).collect()
}

/// The reference: `README.md`, `functions.md` and one page per noun.
pub fn pages() -> Vec<Document> {
    pages::pages(registry())
}
