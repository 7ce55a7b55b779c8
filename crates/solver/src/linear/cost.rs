//! What linear solvers cost, predicted before any value is computed.
//!
//! Times are predicted from operations and bytes moved, at fixed rates of an ordinary machine, so
//! the predictions are the same everywhere; only their ratios matter.

use std::fmt;
use std::str::FromStr;

use glam::DVec3;
use kluft_algebra::{Analysis, ScalarCholesky};
use kluft_mesh::Mesh;
use lie_core::{FractureLaw, Rock};

use crate::problem::Problem;
use crate::space::pattern::Pattern;
use crate::space::sector_nodes::SectorNodes;
use crate::system::{Discretisation, System};

/// Operations of a factorisation in a second (1/s).
const OPERATIONS: f64 = 3e10;
/// Time to order and to analyse an unknown (s).
const ANALYSIS: f64 = 5e-6;
/// Bytes read in a second (1/s).
const BYTES: f64 = 2e10;
/// Cholesky factors of solid bodies take about this times the square of the unknowns (operations).
const SOLID: f64 = 18.0;
/// Time below which a direct solver is taken even if the iterative one is faster (s).
const QUICK: f64 = 0.1;
/// Weight of so short a time.
const NEGLIGIBLE: f64 = 1e-3;
/// The linear solvers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LinearMethod {
    /// Cholesky factorisation of the whole tangent, whenever it changes.
    Direct,
    /// Cholesky factorisation of the rock, once; what changes is solved for the jumps alone.
    Condensed,
    /// Conjugate gradients, preconditioned by a multigrid of rock and fractures; the part of the
    /// rock is set up once.
    Iterative,
}

impl LinearMethod {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Direct, Self::Condensed, Self::Iterative];

    /// Its name in scenes and reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Direct => "direct",
            Self::Condensed => "condensed",
            Self::Iterative => "iterative",
        }
    }
}

impl fmt::Display for LinearMethod {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.name())
    }
}

impl FromStr for LinearMethod {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        let found = Self::ALL.into_iter().find(|method| method.name() == name);
        found.ok_or_else(|| format!("there is no solver `{name}`"))
    }
}

/// What there is to solve for.
#[derive(Debug, Clone, Copy)]
pub struct Unknowns<'a> {
    /// Who couples with whom.
    pub pattern: &'a Pattern,
    /// Numbering.
    pub points: &'a SectorNodes,
    /// Unknowns that the fractures act on, ascending.
    pub jumps: &'a [u32],
}

impl<'a> From<&'a Discretisation> for Unknowns<'a> {
    fn from(discretisation: &'a Discretisation) -> Self {
        Self {
            pattern: &discretisation.pattern,
            points: &discretisation.points,
            jumps: &discretisation.interface.unknowns,
        }
    }
}

/// Memory that a run takes beside its linear solver.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct ExtraMemory {
    /// Beside any solver (bytes).
    pub always: usize,
    /// Beside one that iterates (bytes).
    pub iterative: usize,
    /// After the last solve, when there is no solver any more (bytes).
    pub after: usize,
}

impl ExtraMemory {
    /// With what a solver takes (bytes).
    pub fn with(self, solver: usize) -> usize {
        (solver + self.always).max(self.after)
    }
}

/// What will be asked of the solver.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Workload {
    /// Load steps.
    pub steps: usize,
    /// Whether a step takes more than one linear solve.
    pub is_nonlinear: bool,
    /// Whether tangents change gradually, so that a step can be made of the moves of former ones.
    pub is_smooth: bool,
    /// Whether tractions depend on the path, as with friction: each step is solved in one substep
    /// and in two, and the tangents are not symmetric.
    pub is_path_dependent: bool,
    /// Factor on the work of the multigrid, 1 for cells of about equal edges.
    pub difficulty: f64,
    /// The flow that is solved with it, if there is one.
    pub flow: Option<FlowWorkload>,
    /// Memory that others take while the solver stands.
    pub extra: ExtraMemory,
}

/// What a flow that follows the walls asks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FlowWorkload {
    /// Pressures.
    pub pressures: usize,
    /// Increments of a load step: three where each is solved in one and in two.
    pub increments: usize,
}

impl FlowWorkload {
    /// Linear solves of a first increment and of later ones, which continue a path, and linear
    /// iterations of each: measured.
    const FIRST: f64 = 5.0;
    const LATER: f64 = 3.0;
    const ITERATIONS: f64 = 16.0;
    /// Time of an iteration of GMRES on rock and pressures against one of conjugate gradients.
    const DEARER: f64 = 1.4;
    /// Memory of the flow beside that of the rock for each pressure, its factor included (bytes).
    const BYTES: f64 = 1500.0;

    fn solves(self, steps: usize) -> f64 {
        Self::FIRST + Self::LATER * (self.increments * steps).saturating_sub(1) as f64
    }

    fn memory_bytes(self, unknowns: Unknowns<'_>) -> usize {
        let vectors = 2.0 * Self::ITERATIONS;
        let basis = vectors * size_of::<DVec3>() as f64 * unknowns.points.len() as f64;
        (basis + Self::BYTES * self.pressures as f64) as usize
    }
}

impl Workload {
    /// What a problem asks for, with the laws that it begins with.
    pub fn of(problem: &Problem) -> Self {
        let laws = problem.fractures.iter().map(|fracture| fracture.law);
        Self::with_laws(problem, &laws.collect::<Vec<_>>())
    }

    /// What a system asks for, with its present laws.
    /// `time` is the accuracy of time steps, see
    /// [`NewtonSettings::time`](crate::NewtonSettings::time).
    pub fn of_system(system: &System<'_>, time: f64) -> Self {
        let flow = system.coupling().map(|coupling| FlowWorkload {
            pressures: coupling.nodes(),
            increments: match coupling.is_transient() && time < 1.0 {
                true => 3,
                false => 1,
            },
        });
        Self::with_laws(system.problem, system.laws()).with_flow(flow)
    }

    fn with_laws(problem: &Problem, laws: &[FractureLaw]) -> Self {
        Self {
            steps: problem.schedule.steps.len(),
            is_nonlinear: laws.iter().any(|law| !law.is_linear()),
            is_smooth: laws.iter().all(FractureLaw::is_smooth),
            is_path_dependent: laws.iter().any(FractureLaw::is_path_dependent),
            ..Self::one_step(&problem.mesh, &problem.rocks)
        }
    }

    /// One step of closing fractures without friction, in a mesh of which the rocks may not be
    /// known.
    pub fn one_step(mesh: &Mesh, rocks: &[Rock]) -> Self {
        Self {
            steps: 1,
            is_nonlinear: true,
            is_smooth: true,
            is_path_dependent: false,
            difficulty: difficulty(mesh, rocks),
            flow: None,
            extra: ExtraMemory::default(),
        }
    }

    /// With a flow that follows the walls.
    pub fn with_flow(self, flow: Option<FlowWorkload>) -> Self {
        Self { flow, ..self }
    }

    /// Linear iterations of a solve with a direct solver inside.
    fn substitutions(self) -> f64 {
        self.flow.map_or(1.0, |_| FlowWorkload::ITERATIONS)
    }

    fn flow_bytes(self, unknowns: Unknowns<'_>) -> usize {
        self.flow.map_or(0, |flow| flow.memory_bytes(unknowns))
    }

    /// Linear solves of the whole run: Newton takes about four iterations in its first step and two
    /// in a step that continues a path. Friction has no path to continue.
    fn solves(self) -> f64 {
        let of_flow = self.flow.map_or(0.0, |flow| flow.solves(self.steps));
        if self.is_path_dependent {
            of_flow.max(15.0 * self.steps as f64)
        } else if self.flow.is_some() {
            of_flow
        } else if self.is_nonlinear {
            2.0 + 2.0 * self.steps as f64
        } else {
            self.steps as f64
        }
    }

    /// Factorisations of the whole tangent in the run.
    fn factorisations(self) -> f64 {
        if self.is_nonlinear {
            self.solves()
        } else {
            // A flow leaves a linear law its stiffness.
            1.0
        }
    }
}

/// Predicted cost of a solver.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Prediction {
    /// The solver.
    pub method: LinearMethod,
    /// Time of all linear solves of the run on an ordinary machine (s).
    pub seconds: f64,
    /// Memory that solver and error estimate need beside mesh and matrix (bytes).
    pub memory_bytes: usize,
    /// Entries of its Cholesky factor; 0 if it has none.
    pub factor_entries: usize,
    /// Operations of its factorisation; 0 if it has none.
    pub operations: f64,
}

impl Prediction {
    /// Cost of factorising a flow in rigid rock, of this analysis and number of pressures, so often
    /// and of solving it so often.
    pub fn of_rigid_flow(
        factor: &ScalarCholesky,
        pressures: usize,
        [factorisations, solves]: [usize; 2],
    ) -> Self {
        let factorise = ANALYSIS * pressures as f64 + factor.factor_operations() / OPERATIONS;
        let substitute = 16.0 * factor.factor_entries() as f64 / BYTES;
        Self {
            method: LinearMethod::Direct,
            seconds: factorisations as f64 * factorise + solves as f64 * substitute,
            memory_bytes: factor.memory_bytes(),
            factor_entries: factor.factor_entries(),
            operations: factor.factor_operations(),
        }
    }

    /// The time that counts: direct solvers are exact to rounding, so one that is over in no time
    /// is as good as any.
    pub(super) fn effective_seconds(&self) -> f64 {
        let is_exact = self.method != LinearMethod::Iterative;
        if is_exact && self.seconds < QUICK {
            self.seconds * NEGLIGIBLE
        } else {
            self.seconds
        }
    }
}

/// Time of the factorisations of a direct solver in a solid body, without an analysis (s).
pub(super) fn in_solid(unknowns: Unknowns<'_>, workload: Workload, method: LinearMethod) -> f64 {
    let factorise = SOLID * (3.0 * unknowns.points.len() as f64).powi(2) / OPERATIONS;
    match method {
        LinearMethod::Condensed => factorise + 3.0 * dense(unknowns),
        _ => workload.factorisations() * factorise,
    }
}

/// Time to factorise the condensed problem (s).
fn dense(unknowns: Unknowns<'_>) -> f64 {
    (3.0 * unknowns.jumps.len() as f64).powi(3) / 3.0 / OPERATIONS
}

pub(super) fn predict(
    unknowns: Unknowns<'_>,
    workload: Workload,
    method: LinearMethod,
    analysis: &Analysis,
) -> Prediction {
    let solves = workload.solves();
    let factorise = analysis.factor_operations() / OPERATIONS;
    let substitute = 16.0 * analysis.factor_entries() as f64 / BYTES;
    let jumps = 3.0 * unknowns.jumps.len() as f64;
    let dense = dense(unknowns);
    let (seconds, extra) = match method {
        LinearMethod::Condensed => {
            let iterations = 8.0 * 16.0 * jumps.powi(2) / BYTES;
            let each = workload.substitutions() * (substitute + iterations.min(dense));
            (
                factorise + 3.0 * dense + solves * each,
                24.0 * jumps.powi(2),
            )
        }
        _ => {
            let factorise = workload.factorisations() * factorise;
            let substitute = workload.substitutions() * substitute;
            (factorise + solves * substitute, 0.0)
        }
    };
    Prediction {
        method,
        seconds: seconds + ANALYSIS * 3.0 * unknowns.points.len() as f64,
        memory_bytes: workload
            .extra
            .with(analysis.memory_bytes() + extra as usize + workload.flow_bytes(unknowns)),
        factor_entries: analysis.factor_entries(),
        operations: analysis.factor_operations(),
    }
}

/// Time and memory of the multigrid, both by the number of blocks of the matrix: measured.
pub(super) fn iterative(unknowns: Unknowns<'_>, workload: Workload) -> Prediction {
    const SETUP_BYTES: f64 = 8_500.0;
    const ITERATION_BYTES: f64 = 400.0;
    const MEMORY_BYTES: f64 = 225.0;
    /// Iterations of a solve that is not symmetric, which cost more than those of one that is.
    const UNSYMMETRIC: f64 = 40.0;
    let blocks = unknowns.pattern.blocks.columns.len() as f64;
    let iterations = if workload.is_path_dependent {
        UNSYMMETRIC * workload.solves()
    } else if workload.flow.is_some() {
        FlowWorkload::DEARER * FlowWorkload::ITERATIONS * workload.solves()
    } else {
        let first = if workload.is_nonlinear { 40.0 } else { 20.0 };
        // Steps made of the moves of former ones, what it takes to make them included.
        let later = if workload.is_smooth { 10.0 } else { 20.0 };
        first + later * (workload.steps as f64 - 1.0).max(0.0)
    };
    Prediction {
        method: LinearMethod::Iterative,
        seconds: blocks * (SETUP_BYTES + workload.difficulty * iterations * ITERATION_BYTES)
            / BYTES,
        memory_bytes: workload.extra.with(
            (blocks * MEMORY_BYTES) as usize
                + workload.flow_bytes(unknowns)
                + workload.extra.iterative,
        ),
        factor_entries: 0,
        operations: 0.0,
    }
}

/// How many times the work of regular cells flat or slender ones and nearly incompressible rocks
/// ask of the multigrid: fitted to layers of flat prisms and to Poisson's ratios near 1/2. The
/// flatter the cells, the more of them the smoother inverts at once, up to a limit.
fn difficulty(mesh: &Mesh, rocks: &[Rock]) -> f64 {
    /// Cells looked at.
    const SAMPLE: usize = 5000;
    const REGULAR: f64 = 3.0;
    const FLATTEST: f64 = 5.0;
    let step = (mesh.cells.len() / SAMPLE).max(1);
    let mut ratios: Vec<f64> = (0..mesh.cells.len())
        .step_by(step)
        .map(|cell| edge_ratio(mesh, cell))
        .collect();
    ratios.sort_by(f64::total_cmp);
    let flat = ratios.get(ratios.len() * 9 / 10).copied().unwrap_or(1.0);
    let of_shape = (1.0 + 0.16 * (flat - REGULAR).max(0.0)).min(FLATTEST);
    let of_rock = |rock: &Rock| (0.1 / (1.0 - 2.0 * rock.poisson_ratio)).max(1.0).powf(0.75);
    rocks.iter().map(of_rock).fold(of_shape, f64::max)
}

/// Longest edge of a cell against its shortest.
fn edge_ratio(mesh: &Mesh, cell: usize) -> f64 {
    let corners = mesh.corners(&mesh.cells, cell);
    let edges = mesh.cells.shapes[cell].edges().iter();
    let lengths = edges.map(|&[a, b]| corners[a as usize].distance(corners[b as usize]));
    let (low, high) = lengths.fold((f64::INFINITY, 0.0_f64), |(low, high), length| {
        (low.min(length), high.max(length))
    });
    high / low
}

#[cfg(test)]
mod tests {
    use super::*;
    use kluft_mesh::Shape;
    use kluft_mesh::structured::cells_of;

    const ROCK: Rock = Rock {
        young_modulus: 1e9,
        poisson_ratio: 0.25,
        density: 0.0,
        anisotropy: None,
    };

    #[test]
    fn flat_cells_and_incompressible_rocks_are_difficult() {
        let layer = |thickness: f64| {
            let draft = cells_of(Shape::Hex8, [4, 4, 1], [1.0, 1.0, thickness], &[]);
            let roles = vec![kluft_mesh::SurfaceRole::Unused; draft.groups.len()];
            Mesh::build(draft, &roles).expect("a sound mesh")
        };
        assert_eq!(difficulty(&layer(0.25), &[ROCK]), 1.0);
        assert_eq!(difficulty(&layer(0.0025), &[ROCK]), 5.0);
        let soft = Rock {
            poisson_ratio: 0.4999,
            ..ROCK
        };
        assert!(difficulty(&layer(0.25), &[soft, ROCK]) > 50.0);
    }
}
