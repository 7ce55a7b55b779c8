//! Edges between crates: each may depend on those below it, as its row of the table says.

use toml::{Table, Value};

use crate::Violation;

/// The package of the program.
const PROGRAM: &str = "kluft";

/// Every package of ours with those that it may depend on.
const ALLOWED: [(&str, &[&str]); 18] = [
    ("kluft-defect", &[]),
    ("kluft-algebra", &[]),
    ("kluft-chart", &[]),
    ("kluft-field", &["kluft-defect"]),
    ("kluft-keys", &["kluft-defect"]),
    ("kluft-mesh", &["kluft-defect"]),
    ("lie-core", &["kluft-mesh"]),
    ("kluft-network", &["kluft-defect", "kluft-mesh"]),
    ("kluft-io", &["kluft-defect", "kluft-mesh"]),
    ("kluft-report", &["kluft-io", "kluft-mesh"]),
    (
        "kluft-solver",
        &[
            "kluft-algebra",
            "kluft-defect",
            "kluft-field",
            "kluft-mesh",
            "lie-core",
        ],
    ),
    (
        "kluft-scene",
        &[
            "kluft-defect",
            "kluft-field",
            "kluft-io",
            "kluft-keys",
            "kluft-mesh",
            "kluft-solver",
            "lie-core",
        ],
    ),
    (
        "kluft-run",
        &[
            "kluft-chart",
            "kluft-defect",
            "kluft-io",
            "kluft-mesh",
            "kluft-report",
            "kluft-scene",
            "kluft-solver",
            "lie-core",
        ],
    ),
    (
        "kluft-program",
        &[
            "kluft-defect",
            "kluft-io",
            "kluft-mesh",
            "kluft-run",
            "kluft-solver",
        ],
    ),
    (
        "kluft-mpi",
        &[
            "kluft-io",
            "kluft-mesh",
            "kluft-program",
            "kluft-run",
            "kluft-scene",
            "kluft-solver",
        ],
    ),
    (
        PROGRAM,
        &[
            "kluft-chart",
            "kluft-defect",
            "kluft-io",
            "kluft-keys",
            "kluft-mesh",
            "kluft-network",
            "kluft-program",
            "kluft-report",
            "kluft-run",
            "kluft-scene",
            "kluft-solver",
            "lie-core",
        ],
    ),
    (
        "kluft-python",
        &[
            PROGRAM,
            "kluft-io",
            "kluft-mesh",
            "kluft-program",
            "kluft-run",
            "kluft-scene",
            "kluft-solver",
        ],
    ),
    (
        "kluft-verification",
        &[
            "kluft-algebra",
            "kluft-chart",
            "kluft-defect",
            "kluft-io",
            "kluft-keys",
            "kluft-mesh",
            "kluft-network",
            "kluft-run",
            "kluft-scene",
            "kluft-solver",
            "lie-core",
        ],
    ),
];

/// What tests, examples and measurements of a package may use besides.
const ALLOWED_IN_TESTS: [(&str, &[&str]); 2] = [
    (PROGRAM, &["kluft-algebra", "kluft-verification"]),
    ("kluft-mpi", &["kluft-network"]),
];

pub fn check(manifests: &[(String, String)]) -> Vec<Violation> {
    let mut found = Vec::new();
    for (file, text) in manifests {
        let table: Table = text.parse().expect("cargo has read the manifest");
        let name = table.get("package").and_then(|package| package.get("name"));
        let Some(name) = name.and_then(Value::as_str) else {
            continue;
        };
        let Some(below) = row(&ALLOWED, name) else {
            let problem = format!("`{name}` has no row in the table of allowed edges");
            found.push(Violation::new(file, 1, problem));
            continue;
        };
        let in_tests = row(&ALLOWED_IN_TESTS, name).unwrap_or_default();
        for (section, also) in [
            ("dependencies", [].as_slice()),
            ("build-dependencies", &[]),
            ("dev-dependencies", in_tests),
        ] {
            let used = table.get(section).and_then(Value::as_table);
            let used = used.into_iter().flatten().map(|(used, _)| used.as_str());
            let ours =
                used.filter(|used| row(&ALLOWED, used).is_some() || used.starts_with("kluft"));
            for used in ours.filter(|used| !below.contains(used) && !also.contains(used)) {
                let problem = format!("`{name}` may not depend on `{used}` ([{section}])");
                found.push(Violation::new(file, line_of(text, used), problem));
            }
        }
    }
    found
}

fn row(table: &'static [(&str, &[&str])], name: &str) -> Option<&'static [&'static str]> {
    let row = table.iter().find(|(package, _)| *package == name);
    row.map(|(_, below)| *below)
}

/// The line of a dependency, or the first.
fn line_of(text: &str, dependency: &str) -> usize {
    let is_its = |line: &str| line.split(['=', '.']).next().map(str::trim) == Some(dependency);
    1 + text.lines().position(is_its).unwrap_or(0)
}

#[test]
fn an_edge_upwards_and_an_unknown_package_are_found() {
    let manifest = |name: &str, rest: &str| {
        let file = format!("crates/{name}/Cargo.toml");
        (file, format!("[package]\nname = \"{name}\"\n{rest}"))
    };
    let found = check(&[
        manifest(
            "kluft-mesh",
            "[dependencies]\nkluft-defect.workspace = true\nkluft-io = {}\n",
        ),
        manifest("kluft-attic", ""),
        manifest("kluft-run", "[dev-dependencies]\nkluft-verification = {}\n"),
        manifest(PROGRAM, "[dev-dependencies]\nkluft-verification = {}\n"),
    ]);
    let places: Vec<&str> = found.iter().map(|one| one.place.as_str()).collect();
    assert_eq!(
        places,
        [
            "crates/kluft-mesh/Cargo.toml:5",
            "crates/kluft-attic/Cargo.toml:1",
            "crates/kluft-run/Cargo.toml:4",
        ]
    );
}

#[test]
fn the_table_has_no_circle() {
    // Rows stand below all rows that they name.
    for (rank, (name, below)) in ALLOWED.iter().enumerate() {
        for other in *below {
            let place = ALLOWED.iter().position(|(package, _)| package == other);
            assert!(
                place.is_some_and(|place| place < rank),
                "`{name}` -> `{other}`"
            );
        }
    }
}
