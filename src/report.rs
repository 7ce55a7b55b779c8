//! The terminal: it follows a run, with progress, decisions, iterations and the closing table.

use std::io::{IsTerminal, Write};
use std::ops::ControlFlow;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};
use kluft_run::{FractureSummary, Measure, Observer, Stage, StepStart};
use kluft_solver::Iteration;

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

    /// Shows on a terminal that work is under way.
    pub fn work_begins(&mut self, what: &'static str) {
        if !self.speaks {
            return;
        }
        let style = ProgressStyle::with_template("{spinner} {msg} {elapsed}")
            .unwrap_or_else(|_| ProgressStyle::default_spinner());
        let spinner = ProgressBar::new_spinner()
            .with_style(style)
            .with_message(what);
        spinner.enable_steady_tick(Duration::from_millis(120));
        self.spinner = Some(spinner);
    }

    /// Ends what [`Report::work_begins`] shows.
    pub fn work_ends(&mut self) {
        if let Some(spinner) = self.spinner.take() {
            spinner.finish_and_clear();
        }
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

impl Observer for Report {
    fn stage_begins(&mut self, stage: Stage) {
        self.work_begins(stage.name());
    }

    fn stage_ends(&mut self, _stage: Stage, _took: Duration) {
        self.work_ends();
    }

    fn note(&mut self, kind: &str, text: &str) {
        self.entry(kind, text);
    }

    fn detail(&mut self, kind: &str, text: &str) {
        if self.verbose {
            self.entry(kind, text);
        }
    }

    fn step_begins(&mut self, step: StepStart<'_>) {
        let StepStart {
            number,
            count,
            what,
        } = step;
        self.line(&format!("\nstep {number} of {count}, {what}"));
        self.line(
            "  iteration  force balance      increment  closure error  smallest aperture [m]",
        );
    }

    fn iteration(&mut self, number: usize, iteration: &Iteration) -> ControlFlow<()> {
        let aperture = if iteration.smallest_aperture.is_finite() {
            format!("{:>21.4e}", iteration.smallest_aperture)
        } else {
            format!("{:>21}", "-")
        };
        self.line(&format!(
            "  {number:>9}  {:>13.3e}  {:>13.3e}  {:>13.3e}  {aperture}",
            iteration.force_residual, iteration.increment, iteration.closure_error
        ));
        ControlFlow::Continue(())
    }
}
