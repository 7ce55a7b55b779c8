//! The modules of a crate, and in which file a name is defined.

use std::collections::BTreeMap;

use crate::imports::{Import, Outline};
use crate::workspace::Source;

/// A file of a crate.
pub struct Module {
    pub file: String,
    pub outline: Outline,
    parent: Option<usize>,
    children: BTreeMap<String, usize>,
}

/// The files of a crate that its root reaches; the root is the first.
pub struct Modules(pub Vec<Module>);

/// More names in a row than any chain of re-exports has.
const LONGEST_CHAIN: usize = 32;

impl Modules {
    /// Reads the crate with this root file.
    pub fn of(root: &str, sources: &[Source]) -> Self {
        let mut modules = Self(Vec::new());
        modules.add(root, None, sources);
        modules
    }

    fn add(&mut self, file: &str, parent: Option<usize>, sources: &[Source]) -> Option<usize> {
        let source = sources.iter().find(|source| source.name == file)?;
        let own = self.0.len();
        self.0.push(Module {
            file: file.to_owned(),
            outline: Outline::of(&source.code),
            parent,
            children: BTreeMap::new(),
        });
        let (folder, name) = file.rsplit_once('/').unwrap_or(("", file));
        let stem = name.trim_end_matches(".rs");
        let folder = if parent.is_none() || stem == "mod" {
            folder.to_owned()
        } else {
            format!("{folder}/{stem}")
        };
        for child in self.0[own].outline.children.clone() {
            let index = self
                .add(&format!("{folder}/{child}.rs"), Some(own), sources)
                .or_else(|| self.add(&format!("{folder}/{child}/mod.rs"), Some(own), sources));
            if let Some(index) = index {
                self.0[own].children.insert(child, index);
            }
        }
        Some(own)
    }

    /// The module in which a path leads to a definition, as seen from another; none for modules and
    /// what is defined in other crates.
    pub fn definition(&self, from: usize, path: &[String]) -> Option<usize> {
        self.walk(from, path, LONGEST_CHAIN)
    }

    /// The module that a path names.
    pub fn module(&self, from: usize, path: &[String]) -> Option<usize> {
        let mut at = from;
        for name in path {
            at = match name.as_str() {
                "crate" => 0,
                "self" => at,
                "super" => self.0[at].parent?,
                name => *self.0[at].children.get(name)?,
            };
        }
        Some(at)
    }

    fn walk(&self, at: usize, path: &[String], left: usize) -> Option<usize> {
        let (first, rest) = path.split_first()?;
        let left = left.checked_sub(1)?;
        let here = &self.0[at];
        match first.as_str() {
            "crate" => self.walk(0, rest, left),
            "self" => self.walk(at, rest, left),
            "super" => self.walk(here.parent?, rest, left),
            name if here.children.contains_key(name) => self.walk(here.children[name], rest, left),
            name if here.outline.items.iter().any(|item| item == name) => Some(at),
            name => {
                let imports = here.outline.imports.iter();
                let named = imports.filter(|import| import.name == name || import.name == "*");
                let mut targets = named.map(|import| target(import, path));
                targets.find_map(|target| {
                    // Without a word before, a path that begins with itself would never end.
                    (target != path)
                        .then(|| self.walk(at, &target, left))
                        .flatten()
                })
            }
        }
    }
}

/// The path with its first name replaced by what an import says of it.
fn target(import: &Import, path: &[String]) -> Vec<String> {
    let rest = if import.name == "*" { path } else { &path[1..] };
    [&import.path, rest].concat()
}

#[test]
fn names_are_found_through_re_exports() {
    let file = |name: &str, text: &str| Source::new(name, text);
    let sources = [
        file("src/lib.rs", "mod a; pub use a::Deep; mod top;"),
        file(
            "src/a/mod.rs",
            "mod b; pub use b::{self, Deep}; pub fn own() {}",
        ),
        file("src/a/b.rs", "pub struct Deep;"),
        file("src/top.rs", "use crate::a::*;"),
    ];
    let modules = Modules::of("src/lib.rs", &sources);
    let find = |from: &str, path: &str| {
        let from = modules.0.iter().position(|module| module.file == from);
        let path: Vec<String> = path.split("::").map(str::to_owned).collect();
        let found = modules.definition(from.expect("a file"), &path);
        found.map(|found| modules.0[found].file.as_str())
    };
    assert_eq!(find("src/top.rs", "crate::Deep"), Some("src/a/b.rs"));
    assert_eq!(find("src/top.rs", "Deep::new"), Some("src/a/b.rs"));
    assert_eq!(find("src/top.rs", "super::a::own"), Some("src/a/mod.rs"));
    assert_eq!(find("src/a/b.rs", "super::own"), Some("src/a/mod.rs"));
    assert_eq!(find("src/top.rs", "std::fmt"), None);
    assert_eq!(find("src/top.rs", "crate::a::b"), None);
}
