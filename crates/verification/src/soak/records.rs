//! Verdicts kept in a file, one a line, so that a long suite can be run in several goes.

use std::collections::BTreeMap;
use std::fs::{self, OpenOptions};
use std::io::{self, ErrorKind, Write};
use std::path::Path;

use serde_json::{Value, json};

use super::tally::Verdict;

/// Verdicts by the number of their case.
pub type Verdicts = BTreeMap<usize, Verdict>;

/// What a file holds; nothing if there is none.
///
/// # Errors
/// If it cannot be read, or holds something else.
pub fn read(file: &Path) -> io::Result<Verdicts> {
    text_of(file)?.lines().map(record).collect()
}

/// The text of a file; empty if there is none.
///
/// # Errors
/// If it cannot be read.
pub fn text_of(file: &Path) -> io::Result<String> {
    match fs::read_to_string(file) {
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(String::new()),
        read => read,
    }
}

/// Adds a verdict to a file.
///
/// # Errors
/// If it cannot be written.
pub fn add(file: &Path, case: usize, verdict: &Verdict) -> io::Result<()> {
    append(file, &line(case, verdict))
}

/// Adds text to the end of a file, which is made if it is not there.
///
/// # Errors
/// If it cannot be written.
pub fn append(file: &Path, text: &str) -> io::Result<()> {
    let mut file = OpenOptions::new().create(true).append(true).open(file)?;
    file.write_all(text.as_bytes())
}

/// Writes verdicts in the order of their cases.
///
/// # Errors
/// If the file cannot be written.
pub fn write(file: &Path, verdicts: &Verdicts) -> io::Result<()> {
    let lines = verdicts.iter().map(|(case, verdict)| line(*case, verdict));
    fs::write(file, lines.collect::<String>())
}

fn line(case: usize, verdict: &Verdict) -> String {
    let Verdict { outcome, miss } = verdict;
    format!(
        "{}\n",
        json!({"case": case, "outcome": outcome, "miss": miss})
    )
}

fn record(line: &str) -> io::Result<(usize, Verdict)> {
    let fields: Value = serde_json::from_str(line)?;
    let wrong = || io::Error::new(ErrorKind::InvalidData, format!("no verdict: {line}"));
    let case = fields["case"].as_u64().ok_or_else(wrong)?;
    let verdict = Verdict {
        outcome: fields["outcome"].as_str().ok_or_else(wrong)?.to_owned(),
        miss: fields["miss"].as_str().map(str::to_owned),
    };
    Ok((case as usize, verdict))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn verdicts_come_back_in_the_order_of_their_cases() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("cases.jsonl");
        assert!(read(&file).expect("no file").is_empty());
        let missed = Verdict::missed("differ", "case 7: by \"much\",\nand more");
        add(&file, 7, &missed).expect("a line");
        add(&file, 3, &Verdict::held("agree")).expect("a line");
        let kept = read(&file).expect("two lines");
        write(&file, &kept).expect("a file");
        let text = fs::read_to_string(&file).expect("the file");
        assert!(text.starts_with("{\"case\":3,"), "{text}");
        let again = read(&file).expect("two lines");
        assert_eq!(again[&7].miss, missed.miss);
        assert_eq!(
            (again[&3].outcome.as_str(), &again[&3].miss),
            ("agree", &None)
        );
        fs::write(&file, "{}\n").expect("a file");
        read(&file).expect_err("not a verdict");
    }
}
