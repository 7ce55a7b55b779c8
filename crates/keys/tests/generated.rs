//! What is made of the table and committed: the schemas of `docs/schema` and the pages of
//! `docs/reference`, and the classes of the Python package. With `KLUFT_BLESS=1` they are written
//! again.

use std::path::{Path, PathBuf};

use kluft_keys::{Document, page, python, schema};
use serde_json::Value;

const MADE: [Document; 3] = [Document::Scene, Document::Network, Document::Study];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn is_blessed() -> bool {
    std::env::var_os("KLUFT_BLESS").is_some_and(|value| value == "1")
}

fn compare(file: &Path, made: &str, is_same: impl Fn(&str) -> bool) {
    if is_blessed() {
        std::fs::write(file, made).expect("written");
        return;
    }
    let committed = std::fs::read_to_string(file).unwrap_or_default();
    let name = file.display();
    assert!(
        is_same(&committed),
        "{name} is stale: run this test with KLUFT_BLESS=1"
    );
}

#[test]
fn the_committed_schemas_are_those_of_the_table() {
    for document in MADE {
        let made = schema(document);
        let text = serde_json::to_string_pretty(&made).expect("JSON") + "\n";
        let file = root().join(format!("docs/schema/{}.json", document.name()));
        compare(&file, &text, |committed| {
            serde_json::from_str::<Value>(committed).is_ok_and(|committed| committed == made)
        });
    }
}

#[test]
fn the_committed_pages_are_those_of_the_table() {
    for document in MADE {
        let made = page(document);
        let file = root().join(format!("docs/reference/keys-{}.md", document.name()));
        compare(&file, &made, |committed| committed == made);
    }
}

#[test]
fn the_committed_classes_are_those_of_the_table() {
    let made = python();
    let file = root().join("crates/python/python/kluft/keys.py");
    compare(&file, &made, |committed| committed == made);
}

#[test]
fn prose_of_the_pages_has_at_most_a_hundred_columns() {
    for document in MADE {
        let page = page(document);
        let prose = page.lines().filter(|line| !line.starts_with('|'));
        for line in prose {
            assert!(line.chars().count() <= 100, "{line}");
        }
    }
}
