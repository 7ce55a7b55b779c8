//! The verification book: its pages in the sources and in `docs/book` are the same, and nothing is lost.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

fn root(folder: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(folder)
}

fn files(folder: &Path) -> BTreeSet<String> {
    let entries = fs::read_dir(folder).expect("a folder");
    let names = entries.map(|entry| entry.expect("an entry").file_name());
    names
        .map(|name| name.to_string_lossy().into_owned())
        .collect()
}

/// Names of the pages, each a file of the benchmark with one `name: "NAME"`.
fn pages() -> BTreeSet<String> {
    let folder = root("benches/book/pages");
    let sources = files(&folder).into_iter().filter(|file| file != "mod.rs");
    let name = |file: String| {
        let text = fs::read_to_string(folder.join(&file)).expect("a source");
        let found = text.split("    name: \"").nth(1);
        let found = found.and_then(|rest| rest.split('"').next());
        found
            .unwrap_or_else(|| panic!("{file} has no page"))
            .to_owned()
    };
    sources.map(name).collect()
}

/// What a text links to.
fn links(text: &str) -> BTreeSet<String> {
    let parts = text.split("](").skip(1);
    let targets = parts.filter_map(|part| part.split(')').next());
    targets.map(str::to_owned).collect()
}

#[test]
fn every_page_is_committed_and_linked() {
    let folder = root("docs/book");
    let index = fs::read_to_string(folder.join("README.md")).expect("an index");
    let of_pages: BTreeSet<String> = pages().iter().map(|name| format!("{name}.md")).collect();
    assert_eq!(links(&index), of_pages);
    let mut known: BTreeSet<String> = ["README.md", "index.json"].map(str::to_owned).into();
    for page in of_pages {
        let text = fs::read_to_string(folder.join(&page)).expect("a page");
        let charts = text.matches(".svg)").count();
        assert!(charts > 0 && text.contains(".csv)"), "{page}");
        assert!(!text.contains("NaN"), "{page}");
        known.extend(links(&text));
        known.insert(page);
    }
    assert_eq!(files(&folder), known);
}
