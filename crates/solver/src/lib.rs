//! From a problem to a solution: unknowns, parallel assembly, linear solver, Newton.
//!
//! [`Problem`] -> [`Discretisation`] -> [`System`] -> [`Newton`] -> [`Solution`].
//!
//! Everything nonlinear lives on the jumps: the stiffness of the rock is assembled once, and a
//! Newton iteration changes only the blocks of nodes on fractures. No result depends on the number
//! of threads: every sum has a fixed order.
//!
//! # Rooms
//!
//! Each builds on those above it.
//!
//! | room | what it holds |
//! |---|---|
//! | `problem` | what is solved: mesh, rocks, fractures, conditions, initial stress, load steps |
//! | `space` | points and unknowns of nodes, who couples with whom, what is held, blocks that nothing holds |
//! | `assembly` | stiffness of the rock, forces of cells, loads, the fractures with their laws |
//! | `system` | numbering ([`Discretisation`]), the discrete problem ([`System`]), its [`State`] |
//! | `linear` | solvers for the tangent on top of [`kluft_algebra`], their cost and choice |
//! | `newton` | load steps: guess, iteration, tests, division of a step |
//! | `flow` | pressures in the fractures: numbering, conductance, networks, steady flow |
//! | `estimate` | errors of stresses and of mean jumps, sizes of cells that would mend them |
//!
//! `solution` derives fields from a state, `resultants` what whole parts feel and do, `memory`
//! counts what a run keeps beside its linear solver.
//!
//! The laws of the fractures live in the [`Interface`]: it takes them over from the problem, and
//! [`System::set_laws`] replaces them.

mod assembly;
mod estimate;
mod flow;
mod linear;
mod memory;
mod newton;
mod problem;
mod resultants;
mod sample;
mod solution;
mod space;
mod system;

pub use assembly::facet_point::FacetPoint;
pub use assembly::interface::Interface;
pub use assembly::loads::{CaseLoads, Loads};
pub use estimate::{
    Deformation, Estimator, FluxError, MeanError, StressError, dual_solution, target_sizes,
};
pub use flow::{
    ConditionFlow, Coupling, EquivalentPermeability, FlowBalance, FlowFields, FlowNetwork,
    FlowState, FlowSystem, FluidState, NO_PRESSURE, NoPermeability, PermeabilityTensor, TimeStep,
    TransientFlow, TransientState, unfit_walls,
};
pub use kluft_algebra::{
    AllGather, Analysis, BlockMatrix, BlockRows, Cholesky, Communicator, Division, FixedPart,
    InterfaceBlocks, LinearFailure, Lists, NodeOrder, multigrid, norm, small,
};
pub use linear::{
    Condensed, Direct, ExtraMemory, FlowWorkload, Iterative, LinearMethod, LinearSolution,
    NonsymmetricSolver, Observed, Plan, Prediction, SolverHistory, TangentSolver, Tangents,
    Unknowns, Workload, first_coarsening, first_guess, serves,
};
pub use newton::{
    Determinacy, Iteration, Newton, NewtonSettings, RestartState, StepOutcome, StepRecord,
    UnresolvedCause, UnresolvedPath, determinacy, unobserved,
};
pub use problem::{
    Cases, Condition, Conduit, Field, FixedPoint, Flow, FlowCondition, FlowDrive, FlowPlace, Fluid,
    Fracture, HeldPart, InitialStress, LawParameter, Leakoff, LineShare, Load, LoadField, Problem,
    Profile, RockParameter, Schedule, Spring, SpringStiffness, Step, Support, SurfaceLoad, Varying,
    VaryingDisplacement, VaryingLaw, VaryingLoad, VaryingPressure,
};
pub use resultants::{BlockMotion, SurfaceResultant, block_motions, surface_resultants};
pub use sample::{InCell, RockSample, locate, principal, sample, surface_samples};
pub use solution::{FacetResult, FacetState, Solution, solution};
pub use space::pattern::{CellOfSlot, Pattern};
pub use space::rigid_modes::{FreeBody, UNHELD_BLOCK};
pub use space::sector_nodes::SectorNodes;
pub use space::supports::{Constraint, Supports};
pub use system::{Discretisation, FacetPointState, StageEnd, State, System};
