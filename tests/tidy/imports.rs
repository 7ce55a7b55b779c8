//! What a Rust file defines, declares and imports, read from its words.

/// A name that a file brings in.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Import {
    /// The path as it is written, without the `self` or `*` at its end.
    pub path: Vec<String>,
    /// What the file calls it; `*` for everything.
    pub name: String,
    /// Whether others may take it from here.
    pub is_public: bool,
}

/// The outline of a file, without what is compiled for tests only.
#[derive(Debug, Default)]
pub struct Outline {
    /// Names defined here.
    pub items: Vec<String>,
    /// Modules in files of their own.
    pub children: Vec<String>,
    pub imports: Vec<Import>,
    /// All other words of the file.
    pub body: Vec<String>,
}

const DEFINING: [&str; 8] = [
    "fn", "struct", "enum", "union", "trait", "type", "const", "static",
];

impl Outline {
    /// Reads the masked text of a file.
    pub fn of(code: &str) -> Self {
        let words = without_tests(words(code));
        let mut outline = Self::default();
        let (mut depth, mut at) = (0, 0);
        while at < words.len() {
            let word = words[at].as_str();
            match word {
                "{" => depth += 1,
                "}" => depth -= 1,
                "use" => {
                    let end = at + position(&words[at..], ";");
                    let is_public = at > 0 && matches!(words[at - 1].as_str(), "pub" | ")");
                    outline.import(&words[at + 1..end], is_public);
                    at = end;
                }
                "mod" if words.get(at + 2).is_some_and(|next| next == ";") => {
                    outline.children.push(words[at + 1].clone());
                    at += 2;
                }
                "mod" if depth == 0 => outline.define(words.get(at + 1)),
                _ if depth == 0 && DEFINING.contains(&word) => outline.define(words.get(at + 1)),
                _ => {}
            }
            outline
                .body
                .push(words.get(at).cloned().unwrap_or_default());
            at += 1;
        }
        outline
    }

    fn define(&mut self, name: Option<&String>) {
        self.items
            .extend(name.filter(|name| is_name(name)).cloned());
    }

    fn import(&mut self, words: &[String], is_public: bool) {
        let mut found = Vec::new();
        tree(words, &[], &mut found);
        let imports = found.into_iter().map(|(path, name)| Import {
            path,
            name,
            is_public,
        });
        self.imports.extend(imports);
    }

    /// Paths of two words and more in what is no import.
    pub fn paths(&self) -> Vec<Vec<String>> {
        let mut paths = Vec::new();
        let mut at = 0;
        while at < self.body.len() {
            let mut path = vec![self.body[at].clone()];
            while is_name(&self.body[at])
                && self.body.get(at + 1).is_some_and(|next| next == "::")
                && self.body.get(at + 2).is_some_and(|next| is_name(next))
            {
                at += 2;
                path.push(self.body[at].clone());
            }
            if path.len() > 1 {
                paths.push(path);
            }
            at += 1;
        }
        paths
    }
}

fn is_name(word: &str) -> bool {
    word.starts_with(|c: char| c.is_alphabetic() || c == '_')
}

/// Where a word stands, or the end.
fn position(words: &[String], wanted: &str) -> usize {
    let found = words.iter().position(|word| word == wanted);
    found.unwrap_or(words.len())
}

/// Names, `::` and single signs.
fn words(code: &str) -> Vec<String> {
    let mut words: Vec<String> = Vec::new();
    let mut rest = code.trim_start();
    while let Some(first) = rest.chars().next() {
        let is_part = |c: char| c.is_alphanumeric() || c == '_';
        let length = if is_part(first) {
            rest.find(|c| !is_part(c)).unwrap_or(rest.len())
        } else if rest.starts_with("::") {
            2
        } else {
            first.len_utf8()
        };
        words.push(rest[..length].to_owned());
        rest = rest[length..].trim_start();
    }
    words
}

/// Leaves out items that are compiled for tests only.
fn without_tests(words: Vec<String>) -> Vec<String> {
    const MARK: [&str; 7] = ["#", "[", "cfg", "(", "test", ")", "]"];
    let mut kept = Vec::with_capacity(words.len());
    let mut at = 0;
    while at < words.len() {
        if words[at..].iter().take(MARK.len()).eq(MARK) {
            at += MARK.len();
            at += item_length(&words[at..]);
        } else {
            kept.push(words[at].clone());
            at += 1;
        }
    }
    kept
}

/// How many words an item has: up to its first `;` or the end of its first braces.
fn item_length(words: &[String]) -> usize {
    let (mut curly, mut round) = (0, 0);
    for (at, word) in words.iter().enumerate() {
        match word.as_str() {
            "(" | "[" => round += 1,
            ")" | "]" => round -= 1,
            "{" => curly += 1,
            "}" => {
                curly -= 1;
                // Of an import, braces are not the end.
                if curly == 0 && words.get(at + 1).is_none_or(|next| next != ";") {
                    return at + 1;
                }
            }
            ";" if curly == 0 && round == 0 => return at + 1,
            _ => {}
        }
    }
    words.len()
}

/// Flattens an import: paths and local names.
fn tree(words: &[String], before: &[String], found: &mut Vec<(Vec<String>, String)>) {
    let mut path = before.to_vec();
    for (at, word) in words.iter().enumerate() {
        match word.as_str() {
            "::" => {}
            "{" => {
                for part in parts(&words[at + 1..words.len() - 1]) {
                    tree(part, &path, found);
                }
                return;
            }
            "*" => return found.push((path, "*".to_owned())),
            "as" => {
                let name = words.get(at + 1).cloned().unwrap_or_default();
                return found.push((path, name));
            }
            "self" if !before.is_empty() && at == 0 => {}
            _ => path.push(word.clone()),
        }
    }
    if let Some(name) = path.last().cloned() {
        found.push((path, name));
    }
}

/// What stands between the commas of braces.
fn parts(words: &[String]) -> Vec<&[String]> {
    let mut depth = 0;
    let parts = words.split(|word| {
        match word.as_str() {
            "{" => depth += 1,
            "}" => depth -= 1,
            _ => {}
        }
        word == "," && depth == 0
    });
    parts.filter(|part| !part.is_empty()).collect()
}

#[test]
fn an_outline_has_items_children_and_imports_but_no_tests() {
    let outline = Outline::of(
        "mod child; pub(crate) use child::{A as B, c::{self, D}}; use super::*;\n\
         #[cfg(test)] mod tests { use super::Gone; fn gone() {} }\n\
         #[cfg(test)] use crate::{X, Y};\n\
         pub struct E { f: B } impl E { fn inner() { other::call(crate::g::h) } } const F: u8 = 1;",
    );
    assert_eq!(outline.items, ["E", "F"]);
    assert_eq!(outline.children, ["child"]);
    let imports = outline.imports.iter();
    let told: Vec<String> = imports
        .map(|one| format!("{} {} {}", one.path.join("::"), one.name, one.is_public))
        .collect();
    assert_eq!(
        told,
        [
            "child::A B true",
            "child::c c true",
            "child::c::D D true",
            "super * false"
        ]
    );
    let paths = outline.paths();
    let paths: Vec<String> = paths.iter().map(|path| path.join("::")).collect();
    assert_eq!(paths, ["other::call", "crate::g::h"]);
}
