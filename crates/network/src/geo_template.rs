//! Fills in a template: text with values in it, and parts that stand there under a condition.
//!
//! `<<name>>` is the place of a value. A line `//: condition` begins a part, which is left out
//! where the condition does not hold.

use std::fmt::{self, Display};

/// Numbers in braces, each with all its digits.
pub(crate) struct List<'a>(pub(crate) &'a [f64]);

impl Display for List<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let numbers: Vec<String> = self.0.iter().map(|number| format!("{number:?}")).collect();
        write!(out, "{{{}}}", numbers.join(", "))
    }
}

/// The template with its values, and those of its parts whose condition holds.
pub(crate) fn fill(
    template: &str,
    holds: impl Fn(&str) -> bool,
    value: impl Fn(&str) -> String,
) -> String {
    let mut out = String::new();
    let mut is_in = true;
    for line in template.split_inclusive('\n') {
        if let Some(condition) = line.strip_prefix("//: ") {
            is_in = holds(condition.trim_end());
        } else if is_in {
            fill_line(&mut out, line, &value);
        }
    }
    out
}

fn fill_line(out: &mut String, line: &str, value: impl Fn(&str) -> String) {
    let mut rest = line;
    while let Some((before, name, behind)) = next_place(rest) {
        out.push_str(before);
        out.push_str(&value(name));
        rest = behind;
    }
    out.push_str(rest);
}

/// What stands before the next place of a value, its name, and what stands behind.
fn next_place(text: &str) -> Option<(&str, &str, &str)> {
    let (before, from) = text.split_once("<<")?;
    let (name, behind) = from.split_once(">>")?;
    Some((before, name, behind))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_stand_in_their_places_and_parts_under_their_conditions() {
        let template = "a <<x>><<y>>;\n//: no\nleft out\n//: yes\n<<x>>\n";
        let value = |name: &str| format!("[{name} <<x>>]");
        let filled = fill(template, |condition| condition == "yes", value);
        assert_eq!(filled, "a [x <<x>>][y <<x>>];\n[x <<x>>]\n");
    }
}
