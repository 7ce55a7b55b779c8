//! The studies of the stability map, one file each: a parameter is swept over many decades, beside a
//! method that breaks.
//!
//! A new study is a file here, an entry of [`ALL`] and a test in `tests/physics/stability.rs`.

pub mod blocks;
pub mod contact;
pub mod contrast;
pub mod cutoff;
pub mod cycles;
pub mod front;
pub mod hopeless;
pub mod increments;
pub mod locking;
pub mod opening;
pub mod sliding;
pub mod slivers;
pub mod steps;
pub mod units;

use kluft_chart::Chart;
use kluft_solver::StepRecord;

/// Most Newton iterations of a load step without friction: the promise of the map.
pub const PROMISE: usize = 12;
/// The same with friction.
pub const PROMISE_WITH_FRICTION: usize = 25;

/// How much of a study to run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Effort {
    /// A few values, for tests.
    Quick,
    /// The map.
    Full,
}

/// A study.
pub struct Study {
    /// Name on the command line and of its files.
    pub name: &'static str,
    /// Its heading.
    pub title: &'static str,
    /// What it sweeps, and how far.
    pub sweep: &'static str,
    /// Runs it.
    pub run: fn(Effort) -> Finding,
}

/// All studies, in the order of the map.
pub const ALL: [Study; 13] = [
    cutoff::STUDY,
    contrast::STUDY,
    front::STUDY,
    increments::STUDY,
    contact::STUDY,
    opening::STUDY,
    sliding::STUDY,
    hopeless::STUDY,
    cycles::STUDY,
    locking::STUDY,
    slivers::STUDY,
    units::STUDY,
    steps::STUDY,
];

/// What a study found.
#[derive(Debug, Clone)]
pub struct Finding {
    /// Where the other method breaks, in a few words.
    pub breaks: String,
    /// How the program fares over the whole sweep, in a few words.
    pub ours: String,
    /// What fails, where, why, and what we do.
    pub paragraph: String,
    /// Charts by name.
    pub charts: Vec<(&'static str, Chart)>,
    /// All numbers.
    pub table: Table,
    /// Cases in which the program did not hold what the map promises.
    pub misses: Vec<String>,
}

/// Numbers of a study.
#[derive(Debug, Clone)]
pub struct Table {
    /// Names of the columns, with units.
    pub head: Vec<&'static str>,
    /// One entry for each column.
    pub rows: Vec<Vec<String>>,
}

impl Table {
    /// A table without rows.
    pub fn new(head: &[&'static str]) -> Self {
        Self {
            head: head.to_vec(),
            rows: Vec::new(),
        }
    }

    /// Adds a row.
    pub fn push<const N: usize>(&mut self, row: [String; N]) {
        assert_eq!(row.len(), self.head.len(), "an entry for each column");
        self.rows.push(row.to_vec());
    }
}

/// Newton iterations of a step; none if it did not converge.
pub fn count(record: &StepRecord) -> Option<usize> {
    record.converged().then_some(record.iterations.len())
}

/// The largest of some counts; none if one of them is none.
pub fn most(counts: impl IntoIterator<Item = Option<usize>>) -> Option<usize> {
    let mut counts = counts.into_iter();
    counts.try_fold(0, |most, count| Some(most.max(count?)))
}

/// The step that failed, or took the most iterations.
pub fn worst_step(records: &[StepRecord]) -> &StepRecord {
    let rank = |record: &&StepRecord| (!record.converged(), record.iterations.len());
    records.iter().max_by_key(rank).expect("steps")
}

/// A count for a chart: failures become crosses.
pub fn height(count: Option<usize>) -> f64 {
    count.map_or(f64::NAN, |count| count as f64)
}

/// A count for a table.
pub fn entry(count: Option<usize>) -> String {
    count.map_or("failed".to_owned(), |count| count.to_string())
}

/// Notes a step that did not converge within the promise.
pub fn hold_promise(misses: &mut Vec<String>, case: &str, record: &StepRecord) {
    match count(record) {
        Some(count) if count <= PROMISE => {}
        Some(count) => misses.push(format!("{case}: {count} Newton iterations")),
        None => misses.push(format!("{case}: {:?}", record.outcome)),
    }
}

/// Notes a step with friction that did not converge within the promise: each of the parts that the
/// program divides it into is a step of its own.
pub fn hold_promise_with_friction(misses: &mut Vec<String>, case: &str, record: &StepRecord) {
    match record.parts.iter().max() {
        Some(&most) if record.converged() && most > PROMISE_WITH_FRICTION => {
            misses.push(format!("{case}: {most} Newton iterations in one part"));
        }
        _ if record.converged() => {}
        _ => misses.push(format!("{case}: {:?}", record.outcome)),
    }
}

/// The largest of some numbers; not a number if one of them is not.
pub fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    let larger = |most: f64, value: f64| match most.is_nan() || most >= value {
        true => most,
        false => value,
    };
    values.into_iter().fold(0.0, larger)
}
