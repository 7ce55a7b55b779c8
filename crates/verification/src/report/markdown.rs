//! Text of pages: paragraphs in lines that diffs show well.

use super::{Numbers, Part, Study};

/// Columns of a line of prose.
const WIDTH: usize = 100;
/// Longer tables are in their files only.
const MOST_ROWS: usize = 30;
/// Stands for a space at which no line ends.
const TIED: char = '\u{1}';

/// Paragraphs in lines of the width; indented ones, tables and charts stay as they are.
pub fn wrapped(text: &str) -> String {
    let paragraphs = text.trim_matches('\n').split("\n\n");
    let wrap = |paragraph: &str| {
        if paragraph.starts_with(['#', '|', '!', ' ']) {
            paragraph.to_owned()
        } else {
            lines(paragraph, WIDTH).join("\n")
        }
    };
    paragraphs.map(wrap).collect::<Vec<String>>().join("\n\n")
}

/// An item of a list.
pub fn item(text: &str) -> String {
    let lines = lines(text, WIDTH - 2);
    format!("- {}\n", lines.join("\n  "))
}

/// Code, and a number with its percent sign, stay on one line.
fn lines(paragraph: &str, width: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in tied(paragraph).split_whitespace() {
        let line = lines.last_mut().expect("a line");
        if !line.is_empty() && line.chars().count() + 1 + word.chars().count() > width {
            lines.push(word.to_owned());
        } else {
            if !line.is_empty() {
                line.push(' ');
            }
            line.push_str(word);
        }
    }
    let untied = |line: String| line.replace(TIED, " ");
    lines.into_iter().map(untied).collect()
}

fn tied(paragraph: &str) -> String {
    let mut is_code = false;
    let tie = |character: char| {
        is_code ^= character == '`';
        if is_code && character == ' ' {
            TIED
        } else {
            character
        }
    };
    let text: String = paragraph.chars().map(tie).collect();
    text.replace(" %", &format!("{TIED}%"))
}

/// Parts of a page whose files lie in the folder `within`, which ends with a slash or is nothing.
pub fn parts(study: &Study, parts: &[Part], within: &str) -> String {
    let parts = parts.iter().map(|part| match part {
        Part::Heading(heading) => format!("## {heading}"),
        Part::Text(text) => wrapped(text),
        Part::Chart(name, chart) => format!("![{}]({within}{name}.svg)", chart.title),
        Part::Numbers(numbers) => of_numbers(study, numbers, within),
    });
    parts.collect::<Vec<String>>().join("\n\n") + "\n"
}

fn of_numbers(study: &Study, numbers: &Numbers, within: &str) -> String {
    let name = numbers.name.unwrap_or(study.name);
    let link = format!("Numbers: [{name}.csv]({within}{name}.csv)");
    if numbers.is_shown && numbers.table.rows.len() <= MOST_ROWS {
        format!("{}\n{link}", numbers.table.markdown())
    } else {
        link
    }
}

/// The anchor that a heading gets.
pub fn anchor(title: &str) -> String {
    title.to_lowercase().replace(' ', "-").replace(',', "")
}
