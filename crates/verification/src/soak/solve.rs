//! One scene in this process, however it ends.

use std::any::Any;
use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use kluft_io::{Grid, Values};
use kluft_mesh::{Defect, Draft};
use kluft_run::{Ending, MeshInput, Observer, Outcome, Request};
use kluft_scene::Scene;
use kluft_solver::Iteration;
use rayon::ThreadPool;
use serde::{Deserialize, Serialize};

use super::tally::words_of;

/// How a run ended.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub enum End {
    /// All load steps converged.
    Solved(Fields),
    /// A load step did not converge: the kind of reason.
    Failed(String),
    /// The input has defects: the first.
    Refused(String),
    /// It was stopped after its iterations.
    OutOfIterations,
    /// It panicked, with these words.
    Panicked(String),
}

/// What is compared of a solution.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Fields {
    /// Jump at each node of each facet (m).
    pub jumps: Vec<f64>,
    /// Largest displacement of the rock (m).
    pub displacement: f64,
    /// What the run estimates of the error of its increments, all load steps added (m).
    pub path_error: f64,
    /// Whether the run says that the state is not unique.
    pub is_declared: bool,
    /// Whether it warns of what the errors of its increments add up to.
    pub warns_of_sums: bool,
}

/// Stops a run after so many iterations of Newton's method: the same on any machine.
struct Countdown(usize);

impl Observer for Countdown {
    fn iteration(&mut self, _number: usize, _iteration: &Iteration) -> ControlFlow<()> {
        self.0 = self.0.saturating_sub(1);
        match self.0 {
            0 => ControlFlow::Break(()),
            _ => ControlFlow::Continue(()),
        }
    }
}

/// Runs a scene on a mesh for at most so many iterations of Newton's method.
pub fn solve(text: &str, draft: Draft, pool: &ThreadPool, most: usize) -> End {
    let mut countdown = Countdown(most);
    let run = || -> Result<Outcome, Vec<Defect>> {
        let scene = Scene::parse(text, "scene.toml", Path::new("."))?;
        let mesh = MeshInput::Draft(Box::new(draft));
        kluft_run::run(Request::in_memory(&scene, mesh, pool), &mut countdown)
    };
    catch_unwind(AssertUnwindSafe(run)).map_or_else(panicked, ended)
}

fn panicked(panic: Box<dyn Any + Send>) -> End {
    End::Panicked(words_of(&*panic))
}

fn ended(result: Result<Outcome, Vec<Defect>>) -> End {
    match result {
        Err(defects) => End::Refused(defects.first().map_or(String::new(), ToString::to_string)),
        Ok(outcome) => match &outcome.ending {
            Ending::Solved | Ending::NothingLeft => End::Solved(fields(&outcome)),
            Ending::NotConverged(why) => End::Failed(kind_of(why)),
            Ending::Stopped => End::OutOfIterations,
        },
    }
}

fn fields(outcome: &Outcome) -> Fields {
    let last = outcome.steps.last();
    let values = |grid: fn(&kluft_run::StepResult) -> &Grid, name: &str| -> Vec<f64> {
        let mut fields = last.iter().flat_map(|step| &grid(step).point_fields);
        let field = fields.find(|field| field.name == name);
        match field.map(|field| &field.values) {
            Some(Values::Real(values)) => values.clone(),
            _ => Vec::new(),
        }
    };
    let displacements = values(|step| &step.rock, "displacement");
    let measures = outcome.summary.steps.iter();
    let measures = measures.filter_map(|step| step.measures.as_ref());
    let warnings = &outcome.summary.warnings;
    let warns_of_sums = |warning: &String| warning.contains("errors of the increments");
    Fields {
        jumps: values(|step| &step.fracture_grid, "jump"),
        displacement: longest(&displacements),
        path_error: measures.map(|measures| measures.path_error).sum(),
        is_declared: warnings.iter().any(|warning| is_declaration(warning)),
        warns_of_sums: warnings.iter().any(warns_of_sums),
    }
}

/// Whether a warning says that the scene has other answers.
fn is_declaration(warning: &str) -> bool {
    let says = |words: &&str| warning.contains(*words);
    ["not unique", "path of the loads is not resolved"]
        .iter()
        .any(says)
}

/// Length of the longest of vectors, three numbers each.
pub fn longest(vectors: &[f64]) -> f64 {
    let lengths = vectors
        .chunks(3)
        .map(|v| v.iter().map(|x| x * x).sum::<f64>().sqrt());
    lengths.fold(0.0, f64::max)
}

/// The kind of reason that a step did not converge, without its place and numbers.
pub fn kind_of(why: &str) -> String {
    let kinds = [
        ("nothing holds", "the loads push rock that nothing holds"),
        ("tests do not hold", "the tests do not hold"),
        ("no longer finite", "a number is no longer finite"),
        (
            "not positive definite",
            "the stiffness is not positive definite",
        ),
        ("gave up", "the linear solver gave up"),
        ("not finite", "a number in the linear system is not finite"),
        ("not unique", "the state is not unique"),
    ];
    let known = kinds.iter().find(|(words, _)| why.contains(words));
    let words = || why.split([':', ';']).nth(1).unwrap_or(why).trim();
    let first = || words().split(' ').take(8).collect::<Vec<_>>().join(" ");
    known.map_or_else(first, |(_, kind)| (*kind).to_owned())
}
