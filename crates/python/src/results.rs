//! Results of a run, held in memory.

use std::path::PathBuf;

use kluft_run::{FractureSummary, Saving, StepResult, Summary};
use pyo3::exceptions::PyIndexError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{CellArrays, GridArrays};
use crate::asked::threads;
use crate::errors::{input_error, sound};

/// The results of a load step.
pub struct StepArrays {
    time: f64,
    summary: String,
    fractures: Vec<(String, String)>,
    rock: GridArrays,
    fracture_grid: GridArrays,
}

impl StepArrays {
    /// Moves the results of a load step; those of a `former` one are on the same mesh.
    pub fn of(py: Python<'_>, result: StepResult, former: Option<&Self>) -> Self {
        let has_rock = !result.rock.shapes.is_empty();
        let rock = former.filter(|former| has_rock == former.rock.has_cells());
        Self {
            time: result.summary.time,
            summary: json(&result.summary),
            fractures: summaries(&result.fractures),
            rock: GridArrays::of(py, result.rock, rock.map(|former| &former.rock)),
            fracture_grid: GridArrays::of(
                py,
                result.fracture_grid,
                former.map(|former| &former.fracture_grid),
            ),
        }
    }

    fn grid(&self, of_rock: bool) -> &GridArrays {
        match of_rock {
            true => &self.rock,
            false => &self.fracture_grid,
        }
    }
}

fn summaries(fractures: &[(String, FractureSummary)]) -> Vec<(String, String)> {
    let fractures = fractures.iter();
    fractures
        .map(|(name, summary)| (name.clone(), json(summary)))
        .collect()
}

/// A summary as JSON; its types cannot fail.
fn json(value: &impl serde::Serialize) -> String {
    serde_json::to_string(value).unwrap_or_default()
}

/// Results of the load steps of a run.
#[pyclass]
pub struct Results {
    /// Its numbers.
    summary: Summary,
    /// The text of `history.csv`.
    history: String,
    steps: Vec<StepArrays>,
}

impl Results {
    /// Moves the results of a run.
    pub fn of(py: Python<'_>, summary: Summary, history: String, steps: Vec<StepResult>) -> Self {
        let mut moved: Vec<StepArrays> = Vec::with_capacity(steps.len());
        for step in steps {
            let step = StepArrays::of(py, step, moved.first());
            moved.push(step);
        }
        Self {
            summary,
            history,
            steps: moved,
        }
    }

    /// Moves the results of a further load step, with the numbers so far.
    pub fn add(&mut self, py: Python<'_>, step: StepResult, summary: Summary, history: String) {
        let step = StepArrays::of(py, step, self.steps.first());
        self.steps.push(step);
        (self.summary, self.history) = (summary, history);
    }

    fn step(&self, index: usize) -> PyResult<&StepArrays> {
        let found = self.steps.get(index);
        found.ok_or_else(|| PyIndexError::new_err(format!("there is no load step {index}")))
    }
}

#[pymethods]
impl Results {
    /// `summary.json`.
    #[getter]
    fn summary(&self) -> String {
        json(&self.summary)
    }

    /// `history.csv`.
    #[getter]
    fn history(&self) -> &str {
        &self.history
    }

    /// Number of load steps.
    fn __len__(&self) -> usize {
        self.steps.len()
    }

    /// The numbers of a load step as JSON, and those of each fracture.
    fn numbers(&self, index: usize) -> PyResult<(&str, Vec<(String, String)>)> {
        let step = self.step(index)?;
        Ok((&step.summary, step.fractures.clone()))
    }

    /// The rock or the fractures of a load step.
    fn grid<'py>(
        &self,
        py: Python<'py>,
        index: usize,
        of_rock: bool,
    ) -> PyResult<Bound<'py, PyDict>> {
        self.step(index)?.grid(of_rock).dict(py)
    }

    /// Connectivity, ends and types of the cells of that grid.
    fn cells<'py>(
        &self,
        py: Python<'py>,
        index: usize,
        of_rock: bool,
    ) -> PyResult<CellArrays<'py>> {
        Ok(self.step(index)?.grid(of_rock).cells(py))
    }

    /// Writes the files that a run into the folder writes.
    fn save(&self, py: Python<'_>, folder: PathBuf) -> PyResult<()> {
        let one = |defect| input_error(py, vec![defect]);
        let pool = threads(None).map_err(one)?;
        let saving = Saving::into(&folder, &self.summary, &self.history);
        let mut saving = sound(py, saving)?;
        for step in &self.steps {
            let (rock, fractures) = (step.rock.grid(py)?, step.fracture_grid.grid(py)?);
            let time = step.time;
            py.detach(|| pool.install(|| saving.step(time, rock, fractures)))
                .map_err(one)?;
        }
        saving.finish().map_err(one)
    }
}
