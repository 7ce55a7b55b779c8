//! The files of the workspace.

use std::fs;
use std::path::{Path, PathBuf};

use crate::masked::mask;

/// Folders with Rust files.
const ROOTS: [&str; 5] = ["benches", "crates", "examples", "src", "tests"];

/// A Rust file.
pub struct Source {
    /// Its path from the root of the workspace, with `/`.
    pub name: String,
    pub text: String,
    /// The text with blanks for comments and the insides of strings, byte for byte.
    pub code: String,
}

impl Source {
    pub fn new(name: &str, text: &str) -> Self {
        Self {
            name: name.to_owned(),
            text: text.to_owned(),
            code: mask(text),
        }
    }
}

/// The line of a byte of a text, from 1 on.
pub fn line_of(text: &str, at: usize) -> usize {
    1 + text.as_bytes()[..at]
        .iter()
        .filter(|&&b| b == b'\n')
        .count()
}

/// All Rust files, by name.
pub fn rust_files() -> Vec<Source> {
    let texts = ROOTS.iter().flat_map(|root| text_files(root, "rs"));
    texts
        .map(|(name, text)| Source::new(&name, &text))
        .collect()
}

/// Manifests of all packages, by name.
pub fn manifests() -> Vec<(String, String)> {
    let mut all = text_files("crates", "toml");
    all.retain(|(name, _)| name.ends_with("/Cargo.toml"));
    all.push(("Cargo.toml".to_owned(), read(&root().join("Cargo.toml"))));
    all
}

/// Files below a folder whose names end in `.extension`, by name, with their texts.
pub fn text_files(folder: &str, extension: &str) -> Vec<(String, String)> {
    let mut paths = Vec::new();
    collect(&root().join(folder), extension, &mut paths);
    paths.sort();
    let named = paths.iter().map(|path| {
        let relative = path.strip_prefix(root()).expect("a path in the workspace");
        let parts = relative.iter().map(|part| part.to_string_lossy());
        (parts.collect::<Vec<_>>().join("/"), read(path))
    });
    named.collect()
}

pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn collect(folder: &Path, extension: &str, paths: &mut Vec<PathBuf>) {
    let Ok(entries) = fs::read_dir(folder) else {
        return;
    };
    for entry in entries.flatten() {
        let path = entry.path();
        let name = entry.file_name();
        if path.is_dir() && name != "target" && !name.to_string_lossy().starts_with('.') {
            collect(&path, extension, paths);
        } else if path.extension().is_some_and(|own| own == extension) {
            paths.push(path);
        }
    }
}

fn read(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}
