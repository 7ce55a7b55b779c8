//! Results that were held in memory become files: those that a run into the folder writes.

use std::io::Write;
use std::path::Path;

use kluft_io::{Grid, write_atomically};
use kluft_mesh::Defect;

use crate::ending::Ending;
use crate::flow::{SOURCES, write_sources};
use crate::history;
use crate::output::{OWN, Output, SUMMARY};
use crate::page::{self, Iterations, Told};
use crate::summary::Summary;

/// A folder that takes the results of a run, load step by load step.
pub struct Saving<'a> {
    output: Output,
    summary: &'a Summary,
    history: &'a str,
}

impl<'a> Saving<'a> {
    /// Prepares a folder for a run of this summary and history, and removes what a former run has
    /// written there.
    ///
    /// # Errors
    /// If the folder cannot be written to, if another run writes there, and if a file would be
    /// written over that is no result.
    pub fn into(
        folder: &Path,
        summary: &'a Summary,
        history: &'a str,
    ) -> Result<Self, Vec<Defect>> {
        let mut names = OWN.to_vec();
        names.push(page::NAME);
        if has_flow(summary) {
            names.push(SOURCES);
        }
        let mut output = Output::prepare(folder, &names, &[])?.with_page(true);
        output.tell(summary.facts.clone());
        output.expect_steps(summary.steps.len())?;
        output.remove_former().map_err(|defect| vec![defect])?;
        Ok(Self {
            output,
            summary,
            history,
        })
    }

    /// Writes the grids of the next load step, which ends at a time.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub fn step(&mut self, time: f64, rock: Grid, fractures: Grid) -> Result<(), Defect> {
        self.output.write_step(time, || rock, || fractures, || ())
    }

    /// Writes what speaks of the whole run.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub fn finish(mut self) -> Result<(), Defect> {
        let output = &self.output;
        if !self.history.is_empty() {
            output.write(history::NAME, |path| {
                write_atomically(path, |out| out.write_all(self.history.as_bytes()))
            })?;
        }
        if has_flow(self.summary) {
            output.write(SOURCES, |path| write_sources(path, &self.summary.steps))?;
        }
        let summary = ended(self.summary);
        output.write(SUMMARY, |path| summary.write(path))?;
        let told = Told {
            summary: &summary,
            history: self.history,
            probes: "",
            iterations: &Iterations::default(),
            shown: output.shown(),
            strength: None,
            scene: None,
        };
        let html = told.html();
        output.write(page::NAME, |path| {
            write_atomically(path, |out| out.write_all(html.as_bytes()))
        })?;
        output.sync()?;
        self.output.close()
    }
}

/// The summary of a run that ends where it is saved, if it has not ended before.
fn ended(summary: &Summary) -> Summary {
    let mut summary = summary.clone();
    let failed = summary.steps.iter().position(|step| step.completed < 1.0);
    summary.ending.get_or_insert_with(|| match failed {
        None => Ending::Solved,
        Some(step) => Ending::NotConverged(format!("load step {} did not converge", step + 1)),
    });
    summary
}

fn has_flow(summary: &Summary) -> bool {
    summary.steps.iter().any(|step| step.flow.is_some())
}
