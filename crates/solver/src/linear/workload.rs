//! What will be asked of the linear solver in a run, foreseen or learnt from its first load steps.

use glam::DVec3;
use kluft_mesh::Mesh;
use lie_core::{FractureLaw, Rock};
use serde::{Deserialize, Serialize};

use crate::linear::method::LinearMethod;
use crate::problem::Problem;
use crate::system::System;

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
    /// What load steps of the run have taken, if any are solved.
    pub observed: Observed,
    /// The solver that stands already.
    pub present: Option<LinearMethod>,
}

/// What the load steps of a run have taken that continue a path.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Observed {
    /// Load steps.
    pub steps: usize,
    /// Their linear solves.
    pub solves: usize,
    /// Those of them that were made by the iterative solver.
    pub iterative_solves: usize,
    /// Linear iterations of these.
    pub iterations: usize,
}

impl Observed {
    /// Counts in a load step that a solver took so many linear solves and iterations for.
    pub fn add(&mut self, method: LinearMethod, solves: usize, iterations: usize) {
        self.steps += 1;
        self.solves += solves;
        if method == LinearMethod::Iterative {
            self.iterative_solves += solves;
            self.iterations += iterations;
        }
    }

    /// Linear solves of a load step, if there was one.
    fn solves_of_step(self) -> Option<f64> {
        (self.steps > 0).then(|| self.solves as f64 / self.steps as f64)
    }

    /// Linear iterations of a solve, if the iterative solver made one.
    fn iterations_of_solve(self) -> Option<f64> {
        (self.iterative_solves > 0).then(|| self.iterations as f64 / self.iterative_solves as f64)
    }
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

    fn memory_bytes(self, unknowns: usize) -> usize {
        let vectors = 2.0 * Self::ITERATIONS;
        let basis = vectors * size_of::<DVec3>() as f64 * unknowns as f64;
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
            observed: Observed::default(),
            present: None,
        }
    }

    /// With a flow that follows the walls.
    pub fn with_flow(self, flow: Option<FlowWorkload>) -> Self {
        Self { flow, ..self }
    }

    /// For so many load steps, by a run that has taken this so far and may have a solver.
    pub fn left(self, steps: usize, observed: Observed, present: Option<LinearMethod>) -> Self {
        Self {
            steps,
            observed,
            present,
            ..self
        }
    }

    /// Linear iterations of a solve with a direct solver inside.
    pub(super) fn substitutions(self) -> f64 {
        self.flow.map_or(1.0, |_| FlowWorkload::ITERATIONS)
    }

    /// Memory of the flow beside so many unknown 3-vectors (bytes).
    pub(super) fn flow_bytes(self, unknowns: usize) -> usize {
        self.flow.map_or(0, |flow| flow.memory_bytes(unknowns))
    }

    /// Linear solves of the whole run, as those of the load steps so far; before any is solved,
    /// Newton takes about four iterations in its first step and two in a step that continues a
    /// path. Friction has no path to continue.
    pub(super) fn solves(self) -> f64 {
        if let Some(solves) = self.observed.solves_of_step() {
            return solves * self.steps as f64;
        }
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
    pub(super) fn factorisations(self) -> f64 {
        if self.is_nonlinear {
            self.solves()
        } else if self.present == Some(LinearMethod::Direct) {
            0.0
        } else {
            // A flow leaves a linear law its stiffness.
            1.0
        }
    }

    /// Linear iterations of the multigrid for the whole run, of regular cells.
    pub(super) fn iterations(self) -> f64 {
        /// Iterations of a solve that is not symmetric: most take fewer.
        const UNSYMMETRIC: f64 = 15.0;
        let weight = match self.flow {
            Some(_) => FlowWorkload::DEARER,
            None => 1.0,
        };
        if let Some(of_solve) = self.observed.iterations_of_solve() {
            return weight * of_solve * self.solves();
        }
        let iterations = if self.is_path_dependent {
            UNSYMMETRIC * self.solves()
        } else if self.flow.is_some() {
            weight * FlowWorkload::ITERATIONS * self.solves()
        } else {
            let first = if self.is_nonlinear { 40.0 } else { 20.0 };
            // Steps made of the moves of former ones, what it takes to make them included.
            let later = if self.is_smooth { 10.0 } else { 20.0 };
            first + later * (self.steps as f64 - 1.0).max(0.0)
        };
        self.difficulty * iterations
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
