//! The terminal: it follows a run, with progress, decisions, iterations and the closing table.

use std::io::{IsTerminal, Write};
use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use clap::builder::styling::{AnsiColor, Style};
use indicatif::{ProgressBar, ProgressStyle};
use kluft_run::{FractureSummary, Measure, Observer, Stage, StepStart};
use kluft_solver::Iteration;

use crate::printing::{in_nine, one_line, shortened, wrapped};

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

impl Verbosity {
    /// The argument of a program that asks for it. A report for a terminal is asked for by name,
    /// because a program that another one starts has none.
    pub fn argument(self) -> Option<&'static str> {
        match self {
            Self::Quiet => Some("--quiet"),
            Self::Verbose => Some("--verbose"),
            Self::Terminal => std::io::stdout().is_terminal().then_some("--verbose"),
        }
    }
}

/// Column in which what an entry says begins, less one.
const INDENT: usize = 10;
/// Rows of the closing table.
const ROWS: usize = 30;
/// Characters of a name in it.
const NAME: usize = 16;

/// The kind of entry that stands out.
const WARNING: &str = "warning";
const YELLOW: Style = AnsiColor::Yellow.on_default().bold();

/// Whether the user has not asked for none (<https://no-color.org>).
pub fn wants_colours() -> bool {
    let set = |name: &str| std::env::var_os(name).filter(|value| !value.is_empty());
    set("NO_COLOR").is_none() && set("TERM").is_none_or(|term| term != "dumb")
}

/// Where the report goes.
pub struct Report {
    speaks: bool,
    verbose: bool,
    /// Whether long lines are broken; those of a log are searched.
    wraps: bool,
    spinner: Option<ProgressBar>,
    /// Whether kinds that warn have a colour.
    colours: bool,
    /// When the first load step began, and its number.
    began: Option<(Instant, usize)>,
    /// The load step at hand.
    step: Progress,
}

/// How far a load step is.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct Progress {
    /// Iterations so far.
    iterations: usize,
    /// Increments that were tried: a step is divided where one increment does not do.
    increments: usize,
    /// The share of the step that the last one leads to.
    share: f64,
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
            wraps: terminal,
            spinner: None,
            colours: terminal && wants_colours(),
            began: None,
            step: Progress::default(),
        }
    }

    /// Prints one line, of which nothing commands the terminal.
    pub fn line(&self, text: &str) {
        self.print(&one_line(text));
    }

    /// Prints a line that only who looks closely wants to see.
    fn detail_line(&self, text: &str) {
        if self.verbose {
            self.line(text);
        }
    }

    fn print(&self, text: &str) {
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
        let line = format!("{kind:<INDENT$} {}", one_line(text));
        let line = match self.wraps {
            true => wrapped(&line, INDENT + 1),
            false => line,
        };
        match line
            .strip_prefix(kind)
            .filter(|_| self.colours && kind == WARNING)
        {
            Some(rest) => self.print(&format!("{YELLOW}{kind}{YELLOW:#}{rest}")),
            None => self.print(&line),
        }
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

    /// Prints the closing table, one line a fracture; `summary.json` has all of them.
    pub fn fractures(&self, fractures: &[(String, FractureSummary)]) {
        if fractures.is_empty() {
            return;
        }
        self.line("");
        for line in table(fractures) {
            self.line(&line);
        }
        self.line("");
        for (name, summary) in fractures.iter().take(ROWS) {
            let count = summary.below_cutoff_facets;
            if count > 0 {
                self.entry("cutoff", &format!("{name}: {count} facets are below it"));
            }
        }
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

impl Progress {
    fn in_words(self) -> String {
        let noun = if self.iterations == 1 {
            "iteration"
        } else {
            "iterations"
        };
        let increments = match self.increments {
            0 | 1 => String::new(),
            count => format!(" of {count} increments"),
        };
        format!("  {} {noun}{increments}", self.iterations)
    }
}

/// How long the steps that are left take, if they are like those that are done; nothing before one
/// is done, and for less than some seconds.
fn left(passed: Duration, done: usize, steps: usize) -> String {
    const WORTH_SAYING: f64 = 5.0;
    let seconds = passed.as_secs_f64() / done as f64 * steps as f64;
    match seconds {
        seconds if done == 0 || seconds < WORTH_SAYING => String::new(),
        seconds if seconds < 100.0 => format!(" (about {seconds:.0} s left)"),
        seconds if seconds < 6000.0 => format!(" (about {:.0} min left)", seconds / 60.0),
        seconds => format!(" (about {:.1} h left)", seconds / 3600.0),
    }
}

/// The lines of the closing table, none longer than a terminal is wide.
fn table(fractures: &[(String, FractureSummary)]) -> Vec<String> {
    let shown = &fractures[..fractures.len().min(ROWS)];
    let names: Vec<String> = shown
        .iter()
        .map(|(name, _)| shortened(name, NAME))
        .collect();
    let widths = names.iter().map(|name| name.chars().count());
    let width = widths.max().unwrap_or(0).max(8);
    let mut lines = vec![format!(
        "{:<width$}  {:>7}  {:>29}  {:>9}  {:>9}",
        "fracture", "facets", "aperture min / mean / max [m]", "open [m2]", "of [m2]"
    )];
    for (name, (_, summary)) in names.iter().zip(shown) {
        let aperture = &summary.aperture;
        lines.push(format!(
            "{name:<width$}  {:>7}  {:>9.3e} {:>9.3e} {:>9.3e}  {:>9}  {:>9}",
            summary.facets,
            aperture.min,
            aperture.mean,
            aperture.max,
            in_nine(summary.open_area),
            in_nine(summary.area)
        ));
    }
    let more = fractures.len() - shown.len();
    if more > 0 {
        lines.push(format!("... and {more} more, see summary.json"));
    }
    lines
}

impl Observer for Report {
    fn stage_begins(&mut self, stage: Stage) {
        self.work_begins(stage.name());
    }

    fn stage_ends(&mut self, stage: Stage, _took: Duration) {
        self.work_ends();
        if stage == Stage::Solve && !self.verbose {
            self.line(&self.step.in_words());
        }
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
        self.line("");
        let (began, first) = *self.began.get_or_insert((Instant::now(), number));
        let left = left(began.elapsed(), number - first, count + 1 - number);
        self.line(&format!("step {number} of {count}, {what}{left}"));
        self.step = Progress::default();
        self.detail_line(
            "  iteration  force balance      increment  closure error  smallest aperture [m]",
        );
    }

    fn iteration(&mut self, number: usize, iteration: &Iteration) -> ControlFlow<()> {
        let is_next = self.step.share != iteration.share;
        self.step = Progress {
            iterations: number,
            increments: self.step.increments + usize::from(is_next),
            share: iteration.share,
        };
        if self.step.increments > 1 && is_next {
            let share = 100.0 * iteration.share;
            self.detail_line(&format!("  up to {share:.4} % of the step:"));
        }
        if let Some(spinner) = &self.spinner {
            let residual = iteration.force_residual;
            spinner.set_message(format!("iteration {number}, force balance {residual:.1e}"));
        }
        let aperture = if iteration.smallest_aperture.is_finite() {
            format!("{:>21.4e}", iteration.smallest_aperture)
        } else {
            format!("{:>21}", "-")
        };
        self.detail_line(&format!(
            "  {number:>9}  {:>13.3e}  {:>13.3e}  {:>13.3e}  {aperture}",
            iteration.force_residual, iteration.increment, iteration.closure_error
        ));
        ControlFlow::Continue(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::printing::WIDTH;
    use kluft_run::Spread;

    fn summary(value: f64) -> FractureSummary {
        let spread = Spread {
            min: -value,
            mean: value,
            max: value,
        };
        FractureSummary {
            facets: 1_000_000,
            area: value,
            aperture: spread,
            normal_traction: spread,
            shear_traction: spread,
            slip: spread,
            slip_max: 0.0,
            force: [0.0; 3],
            open_area: value,
            sliding_area: 0.0,
            closed_area: 0.0,
            below_cutoff_area: 0.0,
            below_cutoff_facets: 0,
            overlap_area: 0.0,
            undetermined: Default::default(),
            aperture_uncertainty: None,
            slip_uncertainty: None,
        }
    }

    #[test]
    fn a_divided_step_says_so() {
        let said = |iterations, increments| {
            let share = 1.0;
            Progress {
                iterations,
                increments,
                share,
            }
            .in_words()
        };
        assert_eq!(said(1, 1), "  1 iteration");
        assert_eq!(said(9, 3), "  9 iterations of 3 increments");
    }

    #[test]
    fn what_is_left_is_told_in_units_that_suit() {
        let seconds = Duration::from_secs;
        assert_eq!(left(seconds(60), 0, 9), "");
        assert_eq!(left(seconds(1), 2, 4), "");
        assert_eq!(left(seconds(10), 2, 8), " (about 40 s left)");
        assert_eq!(left(seconds(600), 2, 3), " (about 15 min left)");
        assert_eq!(left(seconds(3600), 1, 2), " (about 2.0 h left)");
    }

    #[test]
    fn the_table_of_a_thousand_fractures_is_short_and_narrow() {
        let values = [0.0, 1.5e-7, 0.5, 9_999.5, 3.25e8];
        let rows: Vec<(String, FractureSummary)> = (0..1000)
            .map(|i| {
                let name = format!("FRACTURE_OF_THE_SECOND_SET_{i:04}");
                (name, summary(values[i % values.len()]))
            })
            .collect();
        let lines = table(&rows);
        assert_eq!(lines.len(), 1 + ROWS + 1);
        for line in &lines {
            assert!(line.chars().count() <= WIDTH, "{line}");
        }
        assert!(lines[ROWS + 1].contains("970 more, see summary.json"));
        assert!(lines[1].starts_with("FRACTURE…ET_0000  "), "{}", lines[1]);
        assert_eq!(table(&rows[..3]).len(), 4);
    }
}
