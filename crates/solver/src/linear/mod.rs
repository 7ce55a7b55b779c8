//! Linear solvers for the tangent: the rock, which never changes, and the fractures, which do.

mod choice;
mod condensed;
mod cost;
mod coupled;
mod direct;
#[cfg(test)]
mod divided_tests;
#[cfg(test)]
pub(crate) mod fractured_tests;
mod iterative;
mod method;
mod moved_points;
#[cfg(test)]
mod multigrid_tests;
mod nonsymmetric;
mod released;
mod split_aggregates;
mod tangent_solver;
mod workload;

pub use choice::Plan;
pub use condensed::Condensed;
pub use cost::{Prediction, Unknowns};
pub(crate) use coupled::CoupledRhs;
pub use direct::Direct;
pub use iterative::{Iterative, first_coarsening, first_guess, serves};
pub use method::LinearMethod;
pub(crate) use nonsymmetric::LARGEST_TOLERANCE;
pub use nonsymmetric::NonsymmetricSolver;
pub(crate) use released::Released;
pub use tangent_solver::{LinearSolution, SolverHistory, TangentSolver, Tangents};
pub use workload::{ExtraMemory, FlowWorkload, Observed, Workload};
