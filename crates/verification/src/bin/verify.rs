//! Runs studies and writes their pages into `docs/verification`.
#![allow(clippy::print_stdout, reason = "progress is what one waits for")]

use std::error::Error;
use std::ops::Range;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use clap::{Args, Parser, Subcommand};
use kluft_verification::report::{Effort, Finding, Report};
use kluft_verification::soak::{self, Asked};
use kluft_verification::{book, closures, root, stability};

#[derive(Parser)]
#[command(
    about = "Runs studies of Kluft beside closed forms and other methods, and writes their \
                   pages"
)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Parameters swept over many decades beside methods that break
    Stability(Choice),
    /// Treatments of closing walls on equal terms
    Closures(Choice),
    /// Real runs beside closed forms, a page for each benchmark
    Book(Choice),
    /// Random and damaged input, runs that are killed, race or find the disk full
    Soak(SoakChoice),
    /// Runs one case in this process and prints the memory that it took
    #[command(hide = true)]
    Memory { case: Vec<String> },
}

#[derive(Args)]
struct Choice {
    /// A few values only, into target/verification
    #[arg(long)]
    quick: bool,
    /// Run nothing: write the overview again from what was found before
    #[arg(long, conflicts_with = "names")]
    rewrite: bool,
    /// The studies to run [default: all]
    names: Vec<String>,
}

#[derive(Args)]
struct SoakChoice {
    /// A few cases only, into target/verification
    #[arg(long)]
    quick: bool,
    /// Run nothing: write the overview again from what was found before
    #[arg(long, conflicts_with = "only")]
    rewrite: bool,
    /// A suite to run, may be given several times [default: all]
    #[arg(long, value_name = "NAME")]
    only: Vec<String>,
    /// Seed of all random choices
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// The number of cases [default: that of each suite]
    #[arg(long, value_name = "COUNT")]
    cases: Option<usize>,
    /// Begin no more cases after this time, min
    #[arg(long, value_name = "MINUTES")]
    minutes: Option<u32>,
    /// Keep the results in docs/verification although the cases are not the usual ones
    #[arg(long, conflicts_with = "quick")]
    keep: bool,
    /// Add to the cases of the random materials that former calls with this option have kept in
    /// docs/verification, without running them again; of a case that was stopped midway, runs that
    /// had ended are not made again
    #[arg(long, conflicts_with_all = ["quick", "keep"])]
    add: bool,
    /// One case by its number, or the first of several
    #[arg(long, value_name = "NUMBER")]
    case: Option<usize>,
    /// The program that is run and killed [default: kluft beside this one]
    #[arg(long, value_name = "FILE")]
    program: Option<PathBuf>,
}

impl SoakChoice {
    /// The cases to run, if not the usual ones: a case alone, unless there is a count.
    fn cases(&self) -> Option<Range<usize>> {
        let first = self.case.unwrap_or(0);
        let count = self.cases.or(self.case.map(|_| 1))?;
        Some(first..first + count)
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    match Cli::parse().command {
        Command::Stability(choice) => write(&stability::report(), &choice),
        Command::Closures(choice) => write(&closures::report(), &choice),
        Command::Book(choice) => write(&book::report(), &choice),
        Command::Soak(choice) => write_soak(&choice),
        Command::Memory { case } => {
            println!(
                "{}",
                closures::measure_memory(&case).ok_or("no memory of a run")?
            );
            Ok(())
        }
    }
}

fn write(report: &Report, choice: &Choice) -> Result<(), Box<dyn Error>> {
    let (effort, folder) = target(choice.quick);
    let chosen = if choice.rewrite {
        Vec::new()
    } else {
        report.chosen(&choice.names)?
    };
    for study in chosen {
        tell(study.name, &report.run(study, effort, &folder)?);
    }
    Ok(report.write_overview(&folder)?)
}

/// Suites that ran other cases than the usual ones leave the committed page alone, unless they are
/// to be kept.
fn write_soak(choice: &SoakChoice) -> Result<(), Box<dyn Error>> {
    let report = soak::report();
    let is_usual = choice.cases().is_none() && choice.minutes.is_none();
    let is_other = !is_usual && !choice.keep && !choice.add;
    let (effort, folder) = target(choice.quick || is_other);
    let mut asked = Asked::of(effort);
    asked.seed = choice.seed;
    asked.cases = choice.cases();
    let time = choice
        .minutes
        .map(|count| Duration::from_secs(60 * u64::from(count)));
    asked.until = time.map(|time| Instant::now() + time);
    asked.records = choice.add.then(|| folder.join(report.name));
    asked.program = choice.program.clone().unwrap_or(asked.program);
    report.chosen(&choice.only)?;
    let is_chosen = |name: &str| choice.only.is_empty() || choice.only.iter().any(|n| n == name);
    for soak::Suite { study, run } in soak::ALL {
        if !choice.rewrite && is_chosen(study.name) {
            tell(study.name, &report.run_as(&study, || run(&asked), &folder)?);
        }
    }
    Ok(report.write_overview(&folder)?)
}

fn target(is_short: bool) -> (Effort, PathBuf) {
    if is_short {
        (Effort::Quick, root().join("target/verification"))
    } else {
        (Effort::Full, root().join("docs/verification"))
    }
}

fn tell(name: &str, (finding, seconds): &(Finding, f64)) {
    println!("{name}: {seconds:.0} s. {}", finding.summary.join("; "));
    for miss in &finding.misses {
        println!("  did not hold: {miss}");
    }
}
