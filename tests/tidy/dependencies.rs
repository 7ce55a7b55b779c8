//! Packages of others: their licences, where they come from, and those that nobody may use, as
//! `deny.toml` says it. Known weaknesses are a matter of `cargo deny`, which needs the network.

use std::collections::BTreeSet;
use std::process::Command;

use serde_json::Value;
use toml::Table;

use crate::Violation;
use crate::workspace::root;

const POLICY: &str = "deny.toml";
const REGISTRY: &str = "registry+https://github.com/rust-lang/crates.io-index";

/// What may be used.
struct Policy {
    licences: BTreeSet<String>,
    banned: BTreeSet<String>,
}

/// A package as cargo sees it.
struct Package {
    name: String,
    version: String,
    licence: String,
    /// None for packages of the workspace.
    source: Option<String>,
}

pub fn check() -> Vec<Violation> {
    let text = std::fs::read_to_string(root().join(POLICY)).expect("a policy");
    violations(&Policy::of(&text), &packages())
}

impl Policy {
    fn of(text: &str) -> Self {
        let table: Table = text.parse().expect("a policy in TOML");
        let names = |section: &str, key: &str| -> BTreeSet<String> {
            let list = table.get(section).and_then(|section| section.get(key));
            let list = list.and_then(toml::Value::as_array).into_iter().flatten();
            let name = |entry: &toml::Value| {
                let name = entry.get("crate").unwrap_or(entry);
                name.as_str().map(str::to_owned)
            };
            list.filter_map(name).collect()
        };
        Self {
            licences: names("licenses", "allow"),
            banned: names("bans", "deny"),
        }
    }

    /// Whether an expression such as `(MIT OR Apache-2.0) AND Unicode-3.0` can be fulfilled.
    fn allows(&self, licence: &str) -> bool {
        let spaced = licence
            .replace('(', " ( ")
            .replace(')', " ) ")
            .replace('/', " OR ");
        let words: Vec<&str> = spaced.split_whitespace().collect();
        let (allowed, rest) = self.any_of(&words);
        allowed && rest.is_empty()
    }

    fn any_of<'a>(&self, words: &'a [&'a str]) -> (bool, &'a [&'a str]) {
        let (mut allowed, mut rest) = self.all_of(words);
        while let Some(("OR", behind)) = rest.split_first().map(|(word, behind)| (*word, behind)) {
            let (other, left) = self.all_of(behind);
            (allowed, rest) = (allowed | other, left);
        }
        (allowed, rest)
    }

    fn all_of<'a>(&self, words: &'a [&'a str]) -> (bool, &'a [&'a str]) {
        let (mut allowed, mut rest) = self.one(words);
        while let Some(("AND", behind)) = rest.split_first().map(|(word, behind)| (*word, behind)) {
            let (other, left) = self.one(behind);
            (allowed, rest) = (allowed & other, left);
        }
        (allowed, rest)
    }

    fn one<'a>(&self, words: &'a [&'a str]) -> (bool, &'a [&'a str]) {
        match words {
            ["(", inner @ ..] => {
                let (allowed, rest) = self.any_of(inner);
                (
                    allowed,
                    rest.split_first().map_or(rest, |(_, behind)| behind),
                )
            }
            [name, "WITH", exception, rest @ ..] => {
                let whole = format!("{name} WITH {exception}");
                (
                    self.licences.contains(&whole) || self.licences.contains(*name),
                    rest,
                )
            }
            [name, rest @ ..] => (self.licences.contains(*name), rest),
            [] => (false, words),
        }
    }
}

fn violations(policy: &Policy, packages: &[Package]) -> Vec<Violation> {
    let mut found = Vec::new();
    for package in packages {
        let mut report = |problem: String| {
            let problem = format!("{} {}: {problem}", package.name, package.version);
            found.push(Violation::new("Cargo.lock", 1, problem));
        };
        if !policy.allows(&package.licence) {
            report(format!("licence `{}` is not in {POLICY}", package.licence));
        }
        if policy.banned.contains(&package.name) {
            report(format!("banned in {POLICY}"));
        }
        if let Some(source) = package.source.as_ref().filter(|source| *source != REGISTRY) {
            report(format!("from `{source}`, not from crates.io"));
        }
    }
    found
}

/// All packages that are built on this machine, by the lock file.
fn packages() -> Vec<Package> {
    let version = cargo(&["--version", "--verbose"]);
    let host = version.lines().find_map(|line| line.strip_prefix("host: "));
    let host = host.expect("cargo names its host");
    let options = [
        "--locked",
        "--offline",
        "--format-version",
        "1",
        "--filter-platform",
        host,
    ];
    let output = cargo(&[["metadata"].as_slice(), &options].concat());
    let metadata: Value = serde_json::from_str(&output).expect("metadata in JSON");
    let text = |package: &Value, key: &str| package[key].as_str().map(str::to_owned);
    let packages = metadata["packages"].as_array().into_iter().flatten();
    let read = |package: &Value| Package {
        name: text(package, "name").unwrap_or_default(),
        version: text(package, "version").unwrap_or_default(),
        licence: text(package, "license").unwrap_or_default(),
        source: text(package, "source"),
    };
    packages.map(read).collect()
}

fn cargo(arguments: &[&str]) -> String {
    let mut command = Command::new(env!("CARGO"));
    let output = command.args(arguments).current_dir(root()).output();
    let output = output.expect("cargo runs");
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "cargo {arguments:?}: {told}");
    String::from_utf8(output.stdout).expect("an answer in UTF-8")
}

#[test]
fn licences_bans_and_sources_are_told() {
    let policy = Policy::of(
        "[licenses]\nallow = ['MIT', 'Unicode-3.0']\n[bans]\ndeny = [{ crate = 'left-pad' }]\n",
    );
    for (licence, fits) in [
        ("MIT", true),
        ("GPL-3.0", false),
        ("MIT OR GPL-3.0", true),
        ("MIT/Apache-2.0", true),
        ("MIT AND GPL-3.0", false),
        ("(MIT OR Apache-2.0) AND Unicode-3.0", true),
        ("Apache-2.0 OR (MIT AND GPL-3.0)", false),
        ("MIT WITH LLVM-exception", true),
        ("", false),
    ] {
        assert_eq!(policy.allows(licence), fits, "{licence}");
    }
    let package = |name: &str, source: &str| Package {
        name: name.to_owned(),
        version: "1.0.0".to_owned(),
        licence: "MIT".to_owned(),
        source: Some(source.to_owned()),
    };
    let git = "git+https://example.org/a";
    let found = violations(
        &policy,
        &[
            package("good", REGISTRY),
            package("left-pad", REGISTRY),
            package("far", git),
        ],
    );
    assert_eq!(found.len(), 2, "{found:?}");
}
