//! From a problem to a solution: unknowns, parallel assembly, linear solver, Newton.
//!
//! [`Problem`] -> [`Discretisation`] -> [`System`] -> [`Newton`] -> [`Solution`].
//!
//! Everything nonlinear lives on the jumps: the stiffness of the rock is assembled once, and a
//! Newton iteration changes only the blocks of nodes on fractures. No result depends on the number
//! of threads: every sum has a fixed order.

mod assembly;
mod cell;
mod cell_forces;
mod conjugate_gradients;
mod dense;
mod estimate;
mod folded;
mod gmres;
mod interface;
mod linear;
mod loads;
mod matrix;
pub mod multigrid;
mod newton;
mod pattern;
mod points;
mod problem;
mod rigid_modes;
mod schedule;
mod shared_walls;
mod solution;
mod supports;
mod system;
mod tetrahedra;

pub use conjugate_gradients::{
    ConjugateGradientOutcome, ConjugateGradientReport, ConjugateGradientSettings,
    conjugate_gradients,
};
pub use estimate::{Estimator, MeanError, StressError, target_sizes};
pub use interface::{FacetPoint, Interface};
pub use linear::{
    Analysis, AnyTangent, Cholesky, Condensed, Iterative, LinearFailure, LinearMethod,
    LinearSolution, NodeOrder, Plan, Prediction, SolverHistory, TangentSolver, Tangents, Unknowns,
    Whole, Workload,
};
pub use loads::{CaseLoads, Loads};
pub use matrix::BlockMatrix;
pub use newton::{
    Iteration, Linearisation, Newton, NewtonSettings, Outcome, RestartState, StepRecord,
};
pub use pattern::{Lists, Pattern};
pub use points::Points;
pub use problem::{
    Condition, FixedPoint, Fracture, InitialStress, Problem, Profile, Support, SurfaceLoad,
};
pub use schedule::{Cases, Load, Schedule, Step};
pub use solution::{FacetResult, FacetState, Solution, solution};
pub use supports::{Hold, Supports};
pub use system::{Discretisation, FacetPointState, State, System, norm};
