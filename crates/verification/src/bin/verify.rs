//! Runs studies and writes their pages into `docs/verification`.
#![allow(clippy::print_stdout, reason = "progress is what one waits for")]

use std::error::Error;

use clap::{Args, Parser, Subcommand};
use kluft_verification::report::{Effort, Report};
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

fn main() -> Result<(), Box<dyn Error>> {
    match Cli::parse().command {
        Command::Stability(choice) => write(&stability::report(), &choice),
        Command::Closures(choice) => write(&closures::report(), &choice),
        Command::Book(choice) => write(&book::report(), &choice),
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
    let (effort, folder) = if choice.quick {
        (Effort::Quick, root().join("target/verification"))
    } else {
        (Effort::Full, root().join("docs/verification"))
    };
    let chosen = if choice.rewrite {
        Vec::new()
    } else {
        report.chosen(&choice.names)?
    };
    for study in chosen {
        let (finding, seconds) = report.run(study, effort, &folder)?;
        let summary = finding.summary.join("; ");
        println!("{}: {seconds:.0} s. {summary}", study.name);
        for miss in &finding.misses {
            println!("  did not hold: {miss}");
        }
    }
    Ok(report.write_overview(&folder)?)
}
