//! The verification book: its pages in the sources and in `docs/verification/book` are the same,
//! and nothing is lost.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use kluft_verification::{book, root};

fn files(folder: &Path) -> BTreeSet<String> {
    let entries = fs::read_dir(folder).expect("a folder");
    let names = entries.map(|entry| entry.expect("an entry").file_name());
    names
        .map(|name| name.to_string_lossy().into_owned())
        .collect()
}

/// What a text links to.
fn links(text: &str) -> BTreeSet<String> {
    let parts = text.split("](").skip(1);
    let targets = parts.filter_map(|part| part.split(')').next());
    targets.map(str::to_owned).collect()
}

#[test]
fn every_page_is_committed_and_linked() {
    let folder = root().join("docs/verification/book");
    let index = fs::read_to_string(folder.join("README.md")).expect("an index");
    let pages = book::report().studies;
    let pages: BTreeSet<String> = pages
        .iter()
        .map(|page| format!("{}.md", page.name))
        .collect();
    assert_eq!(links(&index), pages);
    let mut known: BTreeSet<String> = ["README.md", "index.json"].map(str::to_owned).into();
    for page in pages {
        let text = fs::read_to_string(folder.join(&page)).expect("a page");
        let charts = text.matches(".svg)").count();
        assert!(charts > 0 && text.contains(".csv)"), "{page}");
        assert!(!text.contains("NaN"), "{page}");
        known.extend(links(&text));
        known.insert(page);
    }
    assert_eq!(files(&folder), known);
}
