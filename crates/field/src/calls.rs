//! Turns functions of two arguments into operators between them. The parser does so itself, but not
//! for one that stands in the second argument of another.

/// An open parenthesis, in the text as it is written again.
#[derive(Debug)]
struct Open {
    /// Where the name before it begins, if there is one.
    name: Option<usize>,
    /// Where the parenthesis stands.
    at: usize,
    has_comma: bool,
}

/// The expression with `((a) min (b))` in the place of `min(a, b)`.
///
/// # Errors
/// A comma that parts no two arguments of a function, and how to write it.
pub(crate) fn between(text: &str) -> Result<String, [String; 2]> {
    let mut out = String::with_capacity(2 * text.len());
    let mut open: Vec<Open> = Vec::new();
    for character in text.chars() {
        match character {
            '(' => {
                let (name, at) = (name_start(&out), out.len());
                open.push(Open {
                    name,
                    at,
                    has_comma: false,
                });
                out.push('(');
            }
            ',' => part(&mut out, open.last_mut())?,
            ')' => {
                let closed = open.pop();
                out.push_str(if closed.is_some_and(|own| own.has_comma) {
                    "))"
                } else {
                    ")"
                });
            }
            other => out.push(other),
        }
    }
    Ok(out)
}

/// Moves the name before an open parenthesis to the end, which a comma has reached.
fn part(out: &mut String, call: Option<&mut Open>) -> Result<(), [String; 2]> {
    let unfit = |problem: &str| Err([problem.to_owned(), "write min(a, b)".to_owned()]);
    let Some(call) = call else {
        return unfit("a comma stands in no function");
    };
    let Some(start) = call.name else {
        return unfit("a comma stands in no function");
    };
    if call.has_comma {
        return unfit("a function has more than two arguments");
    }
    call.has_comma = true;
    let name = out[start..call.at].trim_end().to_owned();
    out.replace_range(start..call.at, "(");
    out.push_str(&format!(") {name} ("));
    Ok(())
}

/// Names before an open parenthesis that are none of `functions`.
pub(crate) fn unknown<'a>(text: &'a str, functions: &[String]) -> Vec<&'a str> {
    let before = text.match_indices('(').map(|(at, _)| &text[..at]);
    let names = before.filter_map(|before| Some(before[name_start(before)?..].trim_end()));
    names
        .filter(|name| !functions.iter().any(|function| function == name))
        .collect()
}

/// Where the name that ends a text begins.
fn name_start(text: &str) -> Option<usize> {
    let text = text.trim_end();
    let belongs = |c: char| c.is_alphanumeric() || c == '_';
    let start = text.len()
        - text
            .chars()
            .rev()
            .take_while(|c| belongs(*c))
            .map(char::len_utf8)
            .sum::<usize>();
    text[start..]
        .starts_with(char::is_alphabetic)
        .then_some(start)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn functions_stand_between_their_arguments() {
        for (text, wanted) in [
            ("min(1, x)", "((1) min ( x))"),
            ("2*max (0, min(x, (y)))", "2*((0) max ( ((x) min ( (y)))))"),
            ("sqrt(x) - (y)", "sqrt(x) - (y)"),
            ("(", "("),
            (")", ")"),
        ] {
            assert_eq!(between(text).as_deref(), Ok(wanted), "{text}");
        }
        let functions = ["min", "sqrt"].map(str::to_owned);
        assert!(unknown("min(1, sqrt (x)) * (y)", &functions).is_empty());
        assert_eq!(
            unknown("(x) + foo(sqrt(bar (1)))", &functions),
            ["foo", "bar"]
        );
        for text in ["1, 2", "2*(1, 2)", "min(1, 2, 3)", "min(1, 2), 3", ","] {
            assert!(between(text).is_err(), "{text}");
        }
    }
}
