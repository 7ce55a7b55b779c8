//! Parameters of a geometry: gmsh ignores unknown names, and an assignment in the script wins over
//! the caller's value. Both happen silently, so they are looked for here.

use kluft_mesh::Defect;

use super::script::{comment_length, string_length};

/// One defect for each parameter that would have no effect. Names with a dot are gmsh's own
/// options.
pub(super) fn check(place: &str, script: &str, parameters: &[(String, f64)]) -> Vec<Defect> {
    let script = Script::parse(script);
    let check_one = |(name, value): &(String, f64)| {
        let (problem, remedy) = script.objection(name, *value)?;
        Some(Defect::new(
            format!("{place}, parameter {name}"),
            problem,
            remedy,
        ))
    };
    parameters.iter().filter_map(check_one).collect()
}

/// The names in `DefineConstant[...]` that a caller may set, with their defaults, as far as those
/// are plain numbers.
pub fn constants(script: &str) -> Vec<(String, f64)> {
    let (_, bodies) = take_declarations(&without_comments(script));
    let script = Script::parse(script);
    let all = bodies.iter().flat_map(|body| declarations(body));
    all.filter_map(with_default)
        .filter(|(name, value)| script.objection(name, *value).is_none())
        .collect()
}

/// A script without comments, taken apart.
struct Script {
    /// Names in `DefineConstant[...]`.
    declared: Vec<String>,
    /// Everything outside `DefineConstant[...]`; line breaks stay.
    rest: String,
    includes_others: bool,
}

impl Script {
    fn parse(script: &str) -> Self {
        let (rest, bodies) = take_declarations(&without_comments(script));
        let declared = bodies
            .iter()
            .flat_map(|body| declared_names(body))
            .collect();
        let includes_others = has_word(&rest, "Include") || has_word(&rest, "Merge");
        Self {
            declared,
            rest,
            includes_others,
        }
    }

    /// What is wrong with a parameter, and its remedy.
    fn objection(&self, name: &str, value: f64) -> Option<(String, String)> {
        if !value.is_finite() {
            return Some((
                format!("its value is {value}"),
                "give a finite value".to_owned(),
            ));
        }
        if let Some(line) = self.assignment(name) {
            let problem = format!("the geometry sets it itself, which wins: `{line}`");
            return Some((
                problem,
                format!("write `DefineConstant[ {name} = ... ];` instead"),
            ));
        }
        let known = self.declared.iter().any(|declared| declared == name)
            || name.contains('.')
            || self.includes_others
            || has_word(&self.rest, name);
        (!known).then(|| (unknown(name), self.suggestion(name)))
    }

    fn suggestion(&self, name: &str) -> String {
        let likeness = |known: &&String| strsim::damerau_levenshtein(known, name);
        match self.declared.iter().min_by_key(likeness) {
            Some(nearest) => format!("did you mean `{nearest}`?"),
            None => format!("add `DefineConstant[ {name} = ... ];` to the geometry"),
        }
    }

    /// The statement that gives `name` a value regardless of what it has. `Exists(name)` anywhere
    /// shows that the script takes care of that itself.
    fn assignment(&self, name: &str) -> Option<&str> {
        let asked = ["Exists(", "Exists["].iter().any(|ask| {
            let squeezed: String = self.rest.split_whitespace().collect();
            squeezed.contains(&format!("{ask}{name}"))
        });
        let sets = |statement: &&str| {
            let value = assigned_value(statement, name);
            value.is_some_and(|value| !has_word(value, name))
        };
        let statements = self.rest.split(['\n', ';', '{', '}']).map(str::trim);
        statements.filter(|_| !asked).find(sets)
    }
}

fn unknown(name: &str) -> String {
    format!("the geometry has no `{name}`, and gmsh would ignore it silently")
}

/// The right-hand side of `name = value`.
fn assigned_value<'s>(statement: &'s str, name: &str) -> Option<&'s str> {
    let value = statement
        .strip_prefix(name)?
        .trim_start()
        .strip_prefix('=')?;
    (!value.starts_with('=')).then_some(value)
}

/// Blanks comments; line breaks stay.
fn without_comments(script: &str) -> String {
    let mut kept = Vec::with_capacity(script.len());
    let mut rest = script.as_bytes();
    while let Some(at) = rest
        .iter()
        .position(|byte| matches!(byte, b'/' | b'"' | b'\''))
    {
        kept.extend_from_slice(&rest[..at]);
        rest = &rest[at..];
        let length = match comment_length(rest) {
            Some(length) => {
                kept.extend(rest[..length].iter().filter(|&&byte| byte == b'\n'));
                kept.push(b' ');
                length
            }
            None => {
                let length = if rest[0] == b'/' {
                    1
                } else {
                    string_length(rest)
                };
                kept.extend_from_slice(&rest[..length]);
                length
            }
        };
        rest = &rest[length..];
    }
    kept.extend_from_slice(rest);
    String::from_utf8_lossy(&kept).into_owned()
}

/// Cuts the bodies of `DefineConstant[...]` out of a script.
fn take_declarations(script: &str) -> (String, Vec<String>) {
    const KEYWORD: &str = "DefineConstant";
    let (mut outside, mut bodies) = (String::new(), Vec::new());
    let mut rest = script;
    while let Some(at) = rest.find(KEYWORD) {
        outside.push_str(&rest[..at]);
        let after = rest[at + KEYWORD.len()..].trim_start();
        let length = bracketed(after);
        bodies.push(
            after[..length]
                .trim_matches(['[', ']', '(', ')'])
                .to_owned(),
        );
        rest = &after[length..];
    }
    outside.push_str(rest);
    (outside, bodies)
}

/// Length of the bracketed text that `text` begins with; brackets inside count.
fn bracketed(text: &str) -> usize {
    let mut depth = 0_usize;
    for (at, character) in text.char_indices() {
        match character {
            '[' | '(' | '{' => depth += 1,
            ']' | ')' | '}' => depth = depth.saturating_sub(1),
            _ => {}
        }
        if depth == 0 {
            return at + character.len_utf8();
        }
    }
    text.len()
}

/// The parts of `a = 1, b = {2, Name "b"}, c`; gmsh asks for no comma behind a brace.
fn declarations(body: &str) -> impl Iterator<Item = &str> {
    let mut depth = 0_i32;
    let separates = move |character: char| {
        match character {
            '{' | '(' | '[' => depth += 1,
            '}' | ')' | ']' => depth -= 1,
            _ => {}
        }
        matches!(character, ',' | '}') && depth == 0
    };
    body.split(separates)
}

/// The names before each `=` of declarations.
fn declared_names(body: &str) -> Vec<String> {
    let name = |item: &str| item.split('=').next().unwrap_or_default().trim().to_owned();
    let names = declarations(body).map(name);
    names.filter(|name| !name.is_empty()).collect()
}

/// The name and the number of `a = 1` or `b = {2, Name "b"}`.
fn with_default(item: &str) -> Option<(String, f64)> {
    let (name, value) = item.split_once('=')?;
    let value = value.trim_start().trim_start_matches('{');
    let number: f64 = value.split([',', '}']).next()?.trim().parse().ok()?;
    let name = name.trim();
    (number.is_finite() && !name.is_empty()).then(|| (name.to_owned(), number))
}

/// Whether `word` occurs and is not part of a longer name.
fn has_word(text: &str, word: &str) -> bool {
    let part = |c: char| c.is_alphanumeric() || c == '_';
    text.match_indices(word).any(|(at, _)| {
        let before = text[..at].chars().next_back();
        let after = text[at + word.len()..].chars().next();
        !before.is_some_and(part) && !after.is_some_and(part)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn objection(script: &str, name: &str) -> Option<(String, String)> {
        Script::parse(script).objection(name, 1.0)
    }

    #[test]
    fn names_that_gmsh_honours() {
        for script in [
            "DefineConstant[ h = 0.5 ];",
            "DefineConstant[\n k = {1, Name \"a, h = 2\"},\n h = {0.5, Min 0, Max 1}\n];\n",
            "DefineConstant[ k = (1+2), h = 3 ];\nh = 2*h;\n",
            "If(!Exists(h))\n h = 1;\nEndIf",
            "Point(1) = {0, 0, 0, h};",
            "Include \"h.geo\";",
            "DefineConstant[ h = 1 ]; // h = 3;\n/* h = 4; */ w = 2; If (h == 2) x = 1; EndIf",
        ] {
            assert_eq!(objection(script, "h"), None, "{script}");
        }
        assert_eq!(objection("", "Mesh.Algorithm3D"), None);
    }

    #[test]
    fn names_that_gmsh_ignores() {
        for (script, problem, remedy) in [
            (
                "DefineConstant[ h = 0.5, width = 2 ];",
                "no `widht`",
                "`width`",
            ),
            ("x = 1;", "no `widht`", "add `DefineConstant[ widht"),
            (
                "DefineConstant[ widht = 1 ]; widht = 3;",
                "sets it itself",
                "DefineConstant",
            ),
            ("  widht=0.5;", "`widht=0.5`", "DefineConstant"),
            (
                "widht = DefineNumber[ 4, Name \"n\" ];",
                "sets it itself",
                "DefineConstant",
            ),
            ("// widht", "no `widht`", "add"),
            ("widht2 = 1; \"/*\"", "no `widht`", "add"),
        ] {
            let (found, cure) = objection(script, "widht").expect(script);
            assert!(found.contains(problem), "{script}: {found}");
            assert!(cure.contains(remedy), "{script}: {cure}");
        }
        let nan = Script::parse("DefineConstant[ h = 1 ];").objection("h", f64::NAN);
        assert!(nan.is_some());
    }

    #[test]
    fn constants_are_those_with_a_number_that_may_be_set() {
        let script = "DefineConstant[\n h = {0.02, Name \"h, 3\"}, // size\n half = -20,\n\
                      w = half / 2, n, Name = \"a\", inf = inf, fixed = 1\n];\nfixed = 2;\n\
                      DefineConstant[\n a = {3, Name \"a\"}\n b = {4, Name \"b\"}\n];\n";
        let expected = [("h", 0.02), ("half", -20.0), ("a", 3.0), ("b", 4.0)];
        let expected = expected.map(|(name, value)| (name.to_owned(), value));
        assert_eq!(constants(script), expected);
        assert!(constants("x = 1; // DefineConstant[ h = 1 ];").is_empty());
    }

    #[test]
    fn broken_scripts_do_not_panic() {
        for script in [
            "DefineConstant[",
            "\"",
            "/*",
            "//",
            "DefineConstant",
            "DefineConstant é",
            "=",
        ] {
            let _ = objection(script, "h");
            let _ = objection(script, "");
            let _ = constants(script);
        }
    }
}
