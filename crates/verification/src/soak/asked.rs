//! What is asked of a suite, and how its cases are run.

use std::fs;
use std::io::{self, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use super::kept_ends::KeptEnds;
use super::records;
use super::tally::Verdict;
use super::workers::{cores, each_by};
use crate::report::Effort;
use crate::root;

/// What is asked of a suite.
#[derive(Debug, Clone)]
pub struct Asked {
    /// How many cases, if `cases` does not say.
    pub effort: Effort,
    /// Seed of all random choices.
    pub seed: u64,
    /// The cases to run, by number.
    pub cases: Option<Range<usize>>,
    /// When no more cases are begun.
    pub until: Option<Instant>,
    /// The folder where verdicts are kept that count too, and whose cases are not run again.
    pub records: Option<PathBuf>,
    /// The program that is run, killed and starved.
    pub program: PathBuf,
}

impl Asked {
    /// The usual cases with the program beside the one that runs.
    pub fn of(effort: Effort) -> Self {
        let here = std::env::current_exe().unwrap_or_default();
        let name = format!("kluft{}", std::env::consts::EXE_SUFFIX);
        Self {
            effort,
            seed: 1,
            cases: None,
            until: None,
            records: None,
            program: here.with_file_name(name),
        }
    }

    /// Runs the first `quick` or `full` cases, or those that are asked for, on as many threads as
    /// the machine has cores; what they return, in their order. Tells how many are done on standard
    /// error.
    ///
    /// # Panics
    /// If a case does.
    pub fn each<T: Send>(
        &self,
        quick: usize,
        full: usize,
        run: impl Fn(usize) -> T + Sync,
    ) -> Vec<T> {
        let cases: Vec<usize> = self.wanted(quick, full).collect();
        let done = self.each_of(&cases, run).into_iter();
        done.map(|(_, result)| result).collect()
    }

    /// Like [`Self::each`]; cases with a verdict in [`Self::records`] are not run, and all that are
    /// kept there count.
    ///
    /// # Panics
    /// If a case does, or records cannot be read or written.
    pub fn verdicts(
        &self,
        suite: &str,
        [quick, full]: [usize; 2],
        run: impl Fn(usize) -> Verdict + Sync,
    ) -> Vec<Verdict> {
        let Some(folder) = &self.records else {
            return self.each(quick, full, run);
        };
        let file = folder.join(format!("{suite}-seed-{}.jsonl", self.seed));
        let mut kept = expected(&file, records::read(&file));
        let is_new = |case: &usize| !kept.contains_key(case);
        let cases: Vec<usize> = self.wanted(quick, full).filter(is_new).collect();
        let unbroken = Mutex::new(());
        let added = self.each_of(&cases, |case| {
            let verdict = run(case);
            let line = unbroken.lock();
            expected(&file, records::add(&file, case, &verdict));
            drop(line);
            verdict
        });
        kept.extend(added);
        expected(&file, records::write(&file, &kept));
        kept.into_values().collect()
    }

    /// The ends of runs of a case that former calls have kept; none are kept without
    /// [`Self::records`].
    ///
    /// # Panics
    /// If they cannot be read.
    pub fn kept_ends(&self, suite: &str, case: usize) -> KeptEnds {
        if self.records.is_none() {
            return KeptEnds::default();
        }
        let folder = root().join("target/verification/soak/ends");
        let name = format!("{suite}-{}-{case}", self.seed);
        expected(&folder, KeptEnds::read(&folder, &name))
    }

    /// Whether one case alone is asked for, to be looked at.
    pub fn is_one_case(&self) -> bool {
        self.cases.as_ref().is_some_and(|cases| cases.len() == 1)
    }

    /// The cases that are asked for.
    fn wanted(&self, quick: usize, full: usize) -> Range<usize> {
        let usual = match self.effort {
            Effort::Quick => 0..quick,
            Effort::Full => 0..full,
        };
        self.cases.clone().unwrap_or(usual)
    }

    /// Runs cases; those that there was time for, with what they return.
    fn each_of<T: Send>(
        &self,
        cases: &[usize],
        run: impl Fn(usize) -> T + Sync,
    ) -> Vec<(usize, T)> {
        let ended = AtomicUsize::new(0);
        let is_time = || self.until.is_none_or(|until| Instant::now() < until);
        let counted = |&case: &usize| {
            let result = run(case);
            tell_progress(1 + ended.fetch_add(1, Ordering::Relaxed), cases.len());
            (case, result)
        };
        let in_time = |case: &usize| is_time().then(|| counted(case));
        each_by(cores(), cases, in_time)
    }

    /// Keeps an input of a case that did not hold in `target/verification/soak`; returns its name
    /// there.
    pub fn keep(&self, name: &str, content: &[u8]) -> String {
        let folder = root().join("target/verification/soak/kept");
        let file = folder.join(name);
        let kept = fs::create_dir_all(&folder).and_then(|()| fs::write(&file, content));
        match kept {
            Ok(()) => name.to_owned(),
            Err(error) => format!("{name}, which cannot be written: {error}"),
        }
    }
}

/// The bytes of a file that the suites need.
///
/// # Panics
/// If it cannot be read.
pub fn bytes_of(file: &Path) -> Vec<u8> {
    expected(file, fs::read(file))
}

/// What comes of a file that must be there and fit to be written to.
fn expected<T>(file: &Path, done: io::Result<T>) -> T {
    done.unwrap_or_else(|error| panic!("{}: {error}", file.display()))
}

/// Runs of less than this are not told one by one.
const LONG: Duration = Duration::from_secs(60);

/// Tells on standard error of a run of a case that took this time, if it is long.
pub fn tell_if_long(time: Duration, told: impl FnOnce() -> String) {
    if time >= LONG {
        let line = format!("{}, {} s", told(), time.as_secs());
        let _ = writeln!(std::io::stderr().lock(), "{line}");
    }
}

/// Words on the progress of a suite.
const WORDS: usize = 20;
/// Fewest cases between two of them.
const FEWEST: usize = 25;

fn tell_progress(count: usize, cases: usize) {
    if count.is_multiple_of((cases / WORDS).max(FEWEST)) {
        let _ = writeln!(std::io::stderr().lock(), "{count} of {cases} cases");
    }
}
