//! What a run tells its user: progress, decisions, iterations, the closing table.

use std::io::{IsTerminal, Write};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use kluft_mesh::Defect;
use kluft_solver::Iteration;

use crate::measures::Measure;
use crate::summary::FractureSummary;

/// How much a run tells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verbosity {
    /// Errors only.
    Quiet,
    /// The report, if the output is a terminal.
    Terminal,
    /// The report always, with gmsh's warnings.
    Verbose,
}

/// Why a run did not end well.
#[derive(Debug, Clone, PartialEq)]
pub enum Failure {
    /// A load step did not converge: where and why.
    NotConverged(String),
    /// The input is wrong.
    BadInput(Vec<Defect>),
    /// A study did not yield what was wanted of it: why, and what to try.
    NotReached(String),
}

impl From<Vec<Defect>> for Failure {
    fn from(defects: Vec<Defect>) -> Self {
        Failure::BadInput(defects)
    }
}

/// Prints a failure to the standard error stream.
pub fn print_failure(failure: &Failure) {
    let mut err = std::io::stderr().lock();
    // With the error stream gone there is nobody left to tell.
    let _ = match failure {
        Failure::NotConverged(why) => writeln!(err, "not converged: {why}"),
        Failure::NotReached(why) => writeln!(err, "not reached: {why}"),
        Failure::BadInput(defects) => {
            let count = defects.len();
            let noun = if count == 1 { "defect" } else { "defects" };
            let lines: Vec<String> = defects.iter().map(ToString::to_string).collect();
            writeln!(err, "{count} {noun} in the input\n{}", lines.join("\n"))
        }
    };
}

/// Where the report goes.
pub struct Report {
    speaks: bool,
    verbose: bool,
    spinner: Option<ProgressBar>,
}

impl Report {
    /// A report of the given verbosity on the standard output stream.
    pub fn new(verbosity: Verbosity) -> Self {
        let terminal = std::io::stdout().is_terminal();
        let speaks = match verbosity {
            Verbosity::Quiet => false,
            Verbosity::Terminal => terminal,
            Verbosity::Verbose => true,
        };
        Self {
            speaks,
            verbose: verbosity == Verbosity::Verbose,
            spinner: None,
        }
    }

    /// Prints one line.
    pub fn line(&self, text: &str) {
        if self.speaks {
            let print = || {
                // A closed pipe (`| head`) ends the report, not the run.
                let _ = writeln!(std::io::stdout().lock(), "{text}");
            };
            match &self.spinner {
                Some(spinner) => spinner.suspend(print),
                None => print(),
            }
        }
    }

    /// Prints one line of a named kind.
    pub fn entry(&self, kind: &str, text: &str) {
        self.line(&format!("{kind:<10} {text}"));
    }

    /// Prints a line that only `-v` asks for.
    pub fn detail(&self, kind: &str, text: &str) {
        if self.verbose {
            self.entry(kind, text);
        }
    }

    /// Runs a stage of the work, showing on a terminal that it is under way; returns its result and
    /// its duration.
    pub fn stage<T>(&mut self, name: &'static str, work: impl FnOnce(&Self) -> T) -> (T, Duration) {
        if self.speaks {
            let style = ProgressStyle::with_template("{spinner} {msg} {elapsed}")
                .unwrap_or_else(|_| ProgressStyle::default_spinner());
            let spinner = ProgressBar::new_spinner()
                .with_style(style)
                .with_message(name);
            spinner.enable_steady_tick(Duration::from_millis(120));
            self.spinner = Some(spinner);
        }
        let start = Instant::now();
        let result = work(self);
        if let Some(spinner) = self.spinner.take() {
            spinner.finish_and_clear();
        }
        (result, start.elapsed())
    }

    /// Prints the head of an iteration table.
    pub fn step(&self, number: usize, count: usize, what: &str) {
        self.line(&format!("\nstep {number} of {count}, {what}"));
        self.line(
            "  iteration  force balance      increment  closure error  smallest aperture [m]",
        );
    }

    /// Prints one iteration.
    pub fn iteration(&self, number: usize, iteration: &Iteration) {
        let aperture = if iteration.smallest_aperture.is_finite() {
            format!("{:>21.4e}", iteration.smallest_aperture)
        } else {
            format!("{:>21}", "-")
        };
        self.line(&format!(
            "  {number:>9}  {:>13.3e}  {:>13.3e}  {:>13.3e}  {aperture}",
            iteration.force_residual, iteration.increment, iteration.closure_error
        ));
    }

    /// Prints the closing table, one line a fracture.
    pub fn fractures(&self, fractures: &[(String, FractureSummary)]) {
        if fractures.is_empty() {
            return;
        }
        let width = fractures
            .iter()
            .map(|(name, _)| name.len())
            .max()
            .unwrap_or(0)
            .max(8);
        self.line(&format!(
            "\n{:<width$}  {:>7}  {:>33}  {:>12}  {:>10}  {:>9}",
            "fracture",
            "facets",
            "aperture min / mean / max [m]",
            "below cutoff",
            "open [m2]",
            "of [m2]"
        ));
        for (name, summary) in fractures {
            let aperture = &summary.aperture;
            self.line(&format!(
                "{name:<width$}  {:>7}  {:>9.3e} / {:>9.3e} / {:>9.3e}  {:>12}  {:>10.4}  {:>9.4}",
                summary.facets,
                aperture.min,
                aperture.mean,
                aperture.max,
                summary.below_cutoff_facets,
                summary.open_area,
                summary.area
            ));
        }
        self.line("");
    }

    /// Prints the errors against closed forms, one line a fracture and kind.
    pub fn comparisons(&self, measures: &[Measure]) {
        for measure in measures {
            let (Some(error), Some(fracture)) = (measure.error, &measure.fracture) else {
                continue;
            };
            let what = measure.name.replace('_', " ");
            self.entry(
                "compared",
                &format!("{fracture}: {what} {:.3} % off", 100.0 * error),
            );
        }
    }
}
