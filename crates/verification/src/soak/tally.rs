//! How cases ended, counted by outcome.

use std::any::Any;
use std::collections::BTreeMap;

use crate::report::{Finding, Table};

/// Cases that did not hold which a page lists by name.
const MOST_LISTED: usize = 20;

/// How one case ended.
#[derive(Debug, Clone)]
pub struct Verdict {
    /// The class that it counts in.
    pub outcome: String,
    /// What did not hold, with all that is needed to see it again.
    pub miss: Option<String>,
}

impl Verdict {
    /// A case as it should be.
    pub fn held(outcome: impl Into<String>) -> Self {
        Self {
            outcome: outcome.into(),
            miss: None,
        }
    }

    /// A case as it should not be.
    pub fn missed(outcome: impl Into<String>, what: impl Into<String>) -> Self {
        Self {
            outcome: outcome.into(),
            miss: Some(what.into()),
        }
    }
}

/// What did not hold in a case.
#[derive(Debug, Clone)]
pub struct Miss {
    /// The class that it counts in.
    pub outcome: &'static str,
    /// What was seen.
    pub what: String,
}

impl Miss {
    /// A miss of a class.
    pub fn of(outcome: &'static str, what: impl Into<String>) -> Self {
        Self {
            outcome,
            what: what.into(),
        }
    }

    /// The verdict of the case of this name.
    pub fn in_case(self, case: &str) -> Verdict {
        let Self { outcome, what } = self;
        Verdict::missed(outcome, format!("case {case}: {outcome}: {what}"))
    }
}

/// All cases by outcome: a sentence, a table, and those that did not hold.
pub fn finding(text: &str, verdicts: &[Verdict]) -> Finding {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    for verdict in verdicts {
        *counts.entry(&verdict.outcome).or_default() += 1;
    }
    let mut counts: Vec<(&str, usize)> = counts.into_iter().collect();
    counts.sort_by_key(|&(_, count)| std::cmp::Reverse(count));
    let mut table = Table::new(&["outcome", "cases"]);
    for (outcome, count) in &counts {
        table.push([(*outcome).to_owned(), count.to_string()]);
    }
    let all = verdicts.len();
    let missed = verdicts
        .iter()
        .filter_map(|verdict| verdict.miss.as_deref());
    let missed: Vec<String> = missed.map(without_folders).collect();
    let most = counts.iter().take(4);
    let most: Vec<String> = most
        .map(|(what, count)| format!("{count} {what}"))
        .collect();
    let finding = Finding::new([all.to_string(), most.join("; "), missed.len().to_string()]);
    let beyond = missed.len().saturating_sub(MOST_LISTED);
    let rest = (beyond > 0).then(|| format!("{beyond} more"));
    let listed = missed.into_iter().take(MOST_LISTED).chain(rest);
    finding.text(text).table(table).missing(listed.collect())
}

/// A text without the temporary folders that it names, which are others in every run.
fn without_folders(text: &str) -> String {
    let temporary = std::env::temp_dir().join("");
    let temporary = temporary.to_string_lossy();
    let mut parts = text.split(&*temporary);
    let first = parts.next().unwrap_or_default().to_owned();
    let behind = |part: &str| {
        part.split_once('/')
            .map_or(part, |(_, name)| name)
            .to_owned()
    };
    first + &parts.map(behind).collect::<String>()
}

/// The words of a panic.
pub fn words_of(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    let text = text.or_else(|| panic.downcast_ref::<&str>().copied());
    text.unwrap_or("no words").to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn temporary_folders_are_not_named() {
        let folder = std::env::temp_dir().join("random");
        let text = format!("gmsh {0}/a.geo -o {0}/out/b.msh", folder.display());
        assert_eq!(without_folders(&text), "gmsh a.geo -o out/b.msh");
    }
}
