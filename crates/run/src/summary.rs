//! `summary.json`: the numbers of a run.

use std::path::Path;

use kluft_io::write_atomically;
use kluft_mesh::Defect;
use kluft_solver::{Step, StepRecord};
use serde::{Deserialize, Serialize};

use crate::ending::Ending;
use crate::flow_summary::{FlowSummary, StepFlow};
use crate::json;
use crate::measure::Measure;
use crate::permeability_summary::PermeabilitySummary;
use crate::provenance::Provenance;
use crate::spread::Spread;
use crate::strength_summary::StrengthSummary;

/// Areas (m^2) of a fracture where the state is not unique, see [`kluft_solver::Determinacy`].
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Undetermined {
    /// Where aperture and slip may be others, because the rock on one side floats.
    pub aperture_area: f64,
    /// Where the slip may be another, because the walls slide freely.
    pub slip_area: f64,
    /// Where closed walls could as well be held open by their slip.
    pub metastable_area: f64,
}

/// Numbers of one fracture.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FractureSummary {
    /// Number of facets.
    pub facets: usize,
    /// Area (m^2).
    pub area: f64,
    /// Aperture (m).
    pub aperture: Spread,
    /// Normal traction (Pa), tension positive.
    pub normal_traction: Spread,
    /// Shear traction (Pa), its length.
    pub shear_traction: Spread,
    /// Slip (m), its length.
    pub slip: Spread,
    /// Largest slip (m).
    pub slip_max: f64,
    /// Resultant (N) of the traction, as it acts on the minus wall.
    pub force: [f64; 3],
    /// Area that is open (m^2).
    pub open_area: f64,
    /// Area that slides (m^2).
    pub sliding_area: f64,
    /// Area that is not open (m^2).
    pub closed_area: f64,
    /// Area below the cutoff of the law (m^2).
    pub below_cutoff_area: f64,
    /// Number of facets with a node below the cutoff.
    pub below_cutoff_facets: usize,
    /// Area whose walls overlap (negative aperture) (m^2).
    pub overlap_area: f64,
    /// Where the state is not unique.
    pub undetermined: Undetermined,
    /// What the mean aperture may be off for the sake of the mesh (m); none if it could not be
    /// estimated.
    pub aperture_uncertainty: Option<f64>,
    /// The same of the mean slip; none also if nothing slips.
    pub slip_uncertainty: Option<f64>,
}

/// Numbers of one fracture after one of the load steps, of which there may be many: the names and
/// meanings are those of [`FractureSummary`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StepFracture {
    /// Aperture (m).
    pub aperture: Spread,
    /// Normal traction (Pa), tension positive.
    pub normal_traction: Spread,
    /// Largest slip (m).
    pub slip_max: f64,
    /// Area that is open (m^2).
    pub open_area: f64,
}

impl StepFracture {
    /// Those of all fractures by name.
    pub fn all(fractures: &[(String, FractureSummary)]) -> Vec<(String, Self)> {
        let own = |own: &FractureSummary| Self {
            aperture: own.aperture,
            normal_traction: own.normal_traction,
            slip_max: own.slip_max,
            open_area: own.open_area,
        };
        let fractures = fractures.iter();
        fractures
            .map(|(name, summary)| (name.clone(), own(summary)))
            .collect()
    }
}

/// Numbers of the mesh.
#[derive(Debug, Clone, Default, Serialize)]
pub struct MeshSummary {
    /// Number of nodes that are in cells.
    pub nodes: usize,
    /// Number of cells.
    pub cells: usize,
    /// Number of facets of all fractures.
    pub fracture_facets: usize,
    /// Largest number of sectors around a node.
    pub max_sectors: u32,
}

/// One mesh on the way to the last.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct MeshTrial {
    /// Its unknowns.
    pub unknowns: usize,
    /// Estimated error on it: what the tolerance speaks of.
    pub error: f64,
    /// Time that it took, meshing included (s).
    pub seconds: f64,
}

/// Numbers of scalar unknowns.
#[derive(Debug, Clone, Default, Serialize)]
pub struct UnknownSummary {
    /// All, held directions left out.
    pub total: usize,
    /// Components of jumps.
    pub jump: usize,
}

/// Numbers of one load step.
#[derive(Debug, Clone, Serialize)]
pub struct StepSummary {
    /// Factor on the loads, if there is one load case only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub load: Option<f64>,
    /// Time at its end; the number of the step if the scene has no times.
    pub time: f64,
    /// Its phase, if the scene names phases.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub phase: Option<String>,
    /// Share of it that was solved: 1, unless it did not converge.
    pub completed: f64,
    /// How it was solved; none in rigid rock.
    #[serde(flatten)]
    pub measures: Option<StepMeasures>,
    /// The flow at its end, if there is a fluid.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub flow: Option<StepFlow>,
    /// The fractures at its end, by name; none in rigid rock, and if it did not converge.
    #[serde(serialize_with = "as_map", skip_serializing_if = "Vec::is_empty")]
    pub fractures: Vec<(String, StepFracture)>,
}

/// How a load step was solved.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct StepMeasures {
    /// Newton iterations, each with one linear solve.
    pub newton_iterations: usize,
    /// Newton iterations of each substep that the step was divided into, and that converged.
    pub substeps: Vec<usize>,
    /// Iterations of an iterative linear solver; 0 with a direct one.
    pub linear_iterations: usize,
    /// Out-of-balance force at the end, against the largest force.
    pub force_residual: f64,
    /// Last change of displacement, against the largest displacement.
    pub increment: f64,
    /// Closure error at the end.
    pub closure_error: f64,
    /// Whether the step converged.
    pub converged: bool,
    /// What of the path of its loads no division of the step resolves, and where.
    pub unresolved: Option<String>,
    /// Estimate of how far its increments lead the jumps off the path of the loads (m); 0 where the
    /// path does not matter.
    pub path_error: f64,
    /// What these errors add up to at the place where they do most (m).
    pub path_error_at_one_place: f64,
    /// Largest difference of a time step of the flow in one increment and in two, where no division
    /// of the step brings it to what is allowed.
    pub time_error: Option<f64>,
}

impl StepSummary {
    /// A load step and how it was solved.
    pub fn of(step: &Step, measures: StepMeasures) -> Self {
        Self {
            measures: Some(measures),
            ..Self::without_measures(step)
        }
    }

    /// Without the factor of a load case: where volumes come and go, each body has its own cases.
    pub fn of_stages(self) -> Self {
        Self { load: None, ..self }
    }

    /// A load step alone.
    pub fn without_measures(step: &Step) -> Self {
        Self {
            load: step.load.single_factor(),
            time: step.load.time,
            phase: step.phase.clone(),
            completed: 1.0,
            measures: None,
            flow: None,
            fractures: Vec::new(),
        }
    }
}

impl StepMeasures {
    /// Those of a record, with words for what is not resolved.
    pub fn of(record: &StepRecord, unresolved: Option<String>) -> Self {
        let last = record.iterations.last();
        let measure = |of: fn(&kluft_solver::Iteration) -> f64| last.map_or(f64::NAN, of);
        Self {
            newton_iterations: record.iterations.len(),
            substeps: record.substeps.clone(),
            linear_iterations: record.linear_iterations(),
            force_residual: measure(|last| last.force_residual),
            increment: measure(|last| last.increment),
            closure_error: measure(|last| last.closure_error),
            converged: record.converged(),
            unresolved,
            path_error: record.path_error,
            path_error_at_one_place: record.path_error_at_one_place,
            time_error: record.time_error,
        }
    }
}

/// Wall-clock time of each stage (s).
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct Seconds {
    /// gmsh.
    pub mesh: f64,
    /// gmsh, when it made a mesh that this run found kept.
    pub mesh_spared: f64,
    /// Reading and checking the mesh.
    pub read: f64,
    /// Sectors, unknowns, pattern.
    pub enrich: f64,
    /// Stiffness and loads.
    pub assemble: f64,
    /// Ordering, analysis and factorisations.
    pub factorise: f64,
    /// Everything else of the nonlinear solution.
    pub solve: f64,
    /// Estimating the error.
    pub estimate: f64,
    /// Writing results.
    pub write: f64,
    /// The whole run.
    pub total: f64,
}

/// The processes of a run on several ranks.
#[derive(Debug, Clone, Default, Serialize)]
pub struct RankSummary {
    /// Their number.
    pub count: usize,
    /// Largest resident memory of one of them (bytes).
    pub largest_peak_memory_bytes: u64,
    /// Sum of the largest resident memories of all (bytes).
    pub sum_of_peak_memory_bytes: u64,
}

/// Everything `summary.json` holds.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Summary {
    /// Version of the program.
    pub kluft: &'static str,
    /// Title of the scene.
    pub title: String,
    /// How it ended; none while it runs.
    #[serde(serialize_with = "ending_in_words")]
    pub ending: Option<Ending>,
    /// What it was made with, and of.
    pub provenance: Provenance,
    /// What the grids say of themselves: facts, each with its number.
    #[serde(skip)]
    pub facts: Vec<(String, i32)>,
    /// What the program decided, and why.
    pub decisions: Vec<String>,
    /// What the user should know about the result.
    pub warnings: Vec<String>,
    /// The mesh.
    pub mesh: MeshSummary,
    /// The meshes on the way to this one, if the scene adapts it.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub meshes: Vec<MeshTrial>,
    /// The unknowns.
    pub unknowns: UnknownSummary,
    /// The fractures after the last converged step, by name.
    #[serde(serialize_with = "as_map")]
    pub fractures: Vec<(String, FractureSummary)>,
    /// The flow after the last converged step, if there is a fluid.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub flow: Option<FlowSummary>,
    /// The equivalent permeability of the body, if it is asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub permeability: Option<PermeabilitySummary>,
    /// How far strength could be reduced, if that is asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub strength_reduction: Option<StrengthSummary>,
    /// Estimated error of the stress in the rock, as a share of it in the energy norm.
    pub stress_error: f64,
    /// Numbers by which runs are compared, after the last converged step.
    pub measures: Vec<Measure>,
    /// The load steps.
    pub steps: Vec<StepSummary>,
    /// Where the time went.
    pub seconds: Seconds,
    /// Largest resident memory predicted before the solver was set up: what the process held then,
    /// and what solver and error estimate need (bytes).
    pub predicted_memory_bytes: u64,
    /// Largest resident memory of the process, gmsh left out (bytes).
    pub peak_memory_bytes: u64,
    /// Number of threads, of each rank if there are several.
    pub threads: usize,
    /// The ranks, if the run was shared.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ranks: Option<RankSummary>,
}

fn ending_in_words<S: serde::Serializer>(
    ending: &Option<Ending>,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    let words = ending.as_ref().map(Ending::in_words);
    serializer.serialize_str(words.unwrap_or("not finished"))
}

fn as_map<S: serde::Serializer>(
    fractures: &[(String, impl Serialize)],
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serializer.collect_map(fractures.iter().map(|(name, summary)| (name, summary)))
}

impl Summary {
    /// Writes the summary as JSON.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), Defect> {
        write_atomically(path, |out| json::write(out, self))
    }
}
