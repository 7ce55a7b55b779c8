//! Newton's method that does not see the cutoff.
//!
//! The law stiffens so fast that plain Newton, linearising at the opening where its last linear
//! solve put the walls, overshoots. Here each facet point is linearised at the aperture that
//! balances the law with the rock around it: after the linear solve gives opening `w` and traction
//! `t`, the monotone scalar equation `sigma_n(w~) + k w~ = t + k w` gives `w~`, and the tangent is
//! taken there. The iteration sees loads and stiffnesses only, whatever the cutoff.
//!
//! `k` is the stiffness of the rock as the facet point feels it, measured by the secant through the
//! last two linear solves of the step, `-dt/dw`, between 0 and `E/h`; 0 for the first. Too large a
//! `k` overshoots towards closure, where the tangent is enormous and the way back is long; too
//! small a `k` comes down from the open side step by step. A fixed `E/h` fails for joints that are
//! soft against their elements.
//!
//! A load step is solved in one increment or in several ([`substepping`]). An increment is
//! predicted ([`predictor`]), iterated ([`iteration`]) until the tests hold ([`convergence`]), and
//! committed. Where contact and friction lead Newton's method around in circles, the laws and the
//! rock are solved in turn ([`splitting`]) until it finds its way. Where neither comes to an end,
//! however short the increment, walls snap, and dashpots lead them to an equilibrium
//! ([`relaxation`]).

mod acceleration;
mod acceptance;
mod comparison;
mod conservation;
mod convergence;
mod damping;
mod dashpots;
mod dense;
mod determinacy;
mod drained;
mod extrapolation;
mod facet_points;
mod fluid;
mod forcing_term;
mod free_blocks;
mod iterate;
mod iteration;
mod last_trial;
mod line_search;
mod load_step;
mod mean_strain;
mod path_error;
mod predictor;
mod record;
mod recycling;
mod relaxation;
mod relieved;
mod restart;
mod rigid_motion;
mod settings;
mod solver;
mod splitting;
mod step;
mod stopped;
mod substep;
mod substepping;
mod way;

use step::Step;

pub use determinacy::{Determinacy, determinacy};
pub use record::{Iteration, StepOutcome, StepRecord, UnresolvedCause, UnresolvedPath};
pub(crate) use recycling::bytes as recycling_bytes;
pub use restart::RestartState;
pub use settings::NewtonSettings;
pub use solver::Newton;
pub use step::unobserved;
