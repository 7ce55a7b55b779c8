//! Circles of files of one crate that import from each other: who reads one must read all.
//!
//! A file imports from another where it names something defined there, by whatever way of
//! re-exports. To pass a name on is no import.

use std::collections::{BTreeMap, BTreeSet};

use crate::Violation;
use crate::modules::Modules;
use crate::workspace::Source;

/// Names that a file takes, by the file that defines them.
type Edges = BTreeMap<usize, BTreeSet<String>>;

pub fn check(sources: &[Source]) -> Vec<Violation> {
    let names = sources.iter().map(|source| source.name.as_str());
    let roots = names.filter(|name| is_root(name));
    roots
        .flat_map(|root| circles(&Modules::of(root, sources)))
        .collect()
}

fn is_root(name: &str) -> bool {
    let place = name.rsplit_once('/').map_or("", |(folder, _)| folder);
    let in_source = place == "src" || (place.starts_with("crates/") && place.ends_with("/src"));
    let is_main = name.ends_with("/lib.rs") || name.ends_with("/main.rs");
    (in_source && is_main) || place.ends_with("src/bin")
}

fn circles(modules: &Modules) -> Vec<Violation> {
    let edges: Vec<Edges> = (0..modules.0.len())
        .map(|at| imports(modules, at))
        .collect();
    let reached: Vec<BTreeSet<usize>> = (0..edges.len()).map(|at| reach(&edges, at)).collect();
    let mut found = Vec::new();
    let mut seen = BTreeSet::new();
    for at in 0..edges.len() {
        if !reached[at].contains(&at) || !seen.insert(at) {
            continue;
        }
        let together = reached[at]
            .iter()
            .filter(|&&other| reached[other].contains(&at));
        let circle: BTreeSet<usize> = together.copied().collect();
        seen.extend(&circle);
        found.push(Violation::new(
            &modules.0[at].file,
            1,
            told(modules, &edges, &circle),
        ));
    }
    found
}

fn imports(modules: &Modules, at: usize) -> Edges {
    let outline = &modules.0[at].outline;
    let occurs = |name: &String| outline.body.contains(name);
    let mut edges = Edges::new();
    let mut add = |to: Option<usize>, name: &str| {
        if let Some(to) = to.filter(|&to| to != at) {
            edges.entry(to).or_default().insert(name.to_owned());
        }
    };
    for import in &outline.imports {
        if import.name == "*" {
            let from = modules.module(at, &import.path);
            let items = from.map(|from| modules.0[from].outline.items.iter());
            for item in items.into_iter().flatten().filter(|item| occurs(item)) {
                add(from, item);
            }
        } else if !import.is_public || occurs(&import.name) {
            add(modules.definition(at, &import.path), &import.name);
        }
    }
    for path in outline.paths() {
        add(modules.definition(at, &path), &path.join("::"));
    }
    edges
}

/// What can be reached from a file by one import or more.
fn reach(edges: &[Edges], from: usize) -> BTreeSet<usize> {
    let mut reached = BTreeSet::new();
    let mut next = vec![from];
    while let Some(at) = next.pop() {
        next.extend(edges[at].keys().filter(|&&to| reached.insert(to)));
    }
    reached
}

fn told(modules: &Modules, edges: &[Edges], circle: &BTreeSet<usize>) -> String {
    let mut text = format!("a circle of {} files", circle.len());
    for &from in circle {
        for (to, names) in edges[from].iter().filter(|(to, _)| circle.contains(to)) {
            let names: Vec<&str> = names.iter().map(String::as_str).collect();
            let (from, to) = (&modules.0[from].file, &modules.0[*to].file);
            text += &format!("\n    {from} takes {} from {to}", names.join(", "));
        }
    }
    text
}

#[test]
fn a_circle_is_found_with_its_names_and_passing_on_is_none() {
    let file = |name: &str, text: &str| Source::new(name, text);
    let root = file(
        "src/lib.rs",
        "mod a; mod b; mod c; pub use a::A; pub use c::C;",
    );
    let down = file(
        "src/c.rs",
        "pub struct C; #[cfg(test)] mod tests { use crate::A; }",
    );
    let above = file(
        "src/a.rs",
        "use crate::b::f; use crate::C; pub struct A(C);",
    );
    let sound = file("src/b.rs", "use crate::c; pub fn f() -> c::C {}");
    assert_eq!(check(&[root, down, above, sound]), []);
    let sources = [
        file(
            "src/lib.rs",
            "mod a; mod b; mod c; pub use a::A; pub use c::C;",
        ),
        file("src/a.rs", "use crate::b::f; pub struct A;"),
        file("src/b.rs", "use crate::C; pub fn f() {}"),
        file("src/c.rs", "pub struct C { a: crate::A }"),
    ];
    let found = check(&sources);
    assert_eq!(found.len(), 1, "{found:?}");
    for name in [
        "3 files",
        "src/c.rs takes crate::A from src/a.rs",
        "takes f from",
    ] {
        assert!(found[0].problem.contains(name), "{}", found[0].problem);
    }
}
