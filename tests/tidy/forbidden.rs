//! Words that stand nowhere: files from elsewhere, unsafe code, and, in libraries, printing.

use crate::Violation;
use crate::workspace::{Source, line_of};

const EVERYWHERE: [(&str, &str); 2] = [
    (
        "#[path",
        "a file belongs to one module: share it as a crate",
    ),
    ("unsafe ", "no unsafe code"),
];

/// The one file that speaks to a library of C.
const SPEAKS_C: &str = "crates/mpi/src/petsc.rs";

const PRINTING: [&str; 5] = ["println!", "eprintln!", "print!", "eprint!", "dbg!"];

pub fn check(source: &Source) -> Vec<Violation> {
    let mut found = Vec::new();
    let is_meant = |word: &str| !(word == "unsafe " && source.name == SPEAKS_C);
    for (word, problem) in EVERYWHERE.into_iter().filter(|(word, _)| is_meant(word)) {
        found.extend(places(source, word).map(|line| Violation::new(&source.name, line, problem)));
    }
    if !may_print(&source.name) {
        for word in PRINTING {
            let problem = format!("`{word}` in a library: answer with a value or tell an observer");
            let lines = places(source, word);
            found.extend(lines.map(|line| Violation::new(&source.name, line, &*problem)));
        }
    }
    found
}

/// The programs, the tool that writes pages, and what is no library.
fn may_print(name: &str) -> bool {
    if name.ends_with("/tests.rs") || name.ends_with("_tests.rs") {
        return true;
    }
    let Some(inside) = name.strip_prefix("crates/") else {
        return true;
    };
    let (name, in_crate) = inside.split_once('/').unwrap_or_default();
    if ["mpi", "program"].contains(&name) {
        return true;
    }
    in_crate == "src/main.rs" || in_crate.starts_with("src/bin/") || !in_crate.starts_with("src/")
}

/// Lines where a word begins.
fn places<'a>(source: &'a Source, word: &'a str) -> impl Iterator<Item = usize> + 'a {
    let code = source.code.as_bytes();
    let begins =
        move |at: usize| at == 0 || !(code[at - 1].is_ascii_alphanumeric() || code[at - 1] == b'_');
    let all = source.code.match_indices(word).map(|(at, _)| at);
    all.filter(move |&at| begins(at))
        .map(|at| line_of(&source.code, at))
}

#[test]
fn each_word_is_found_where_it_is_code() {
    let text = "// println!\n#[path = \"a.rs\"]\nmod a;\nfn f() { println!(\"unsafe \"); }\n";
    let lines = |name: &str| -> Vec<String> {
        let found = check(&Source::new(name, text));
        found.into_iter().map(|violation| violation.place).collect()
    };
    assert_eq!(
        lines("crates/mesh/src/x.rs"),
        ["crates/mesh/src/x.rs:2", "crates/mesh/src/x.rs:4"]
    );
    assert_eq!(lines("src/x.rs"), ["src/x.rs:2"]);
    assert_eq!(lines("crates/mesh/tests/x.rs").len(), 1);
    let bad = Source::new("src/y.rs", "fn f() { unsafe { g() } }");
    assert_eq!(check(&bad).len(), 1);
}
