//! The mass balance of an iterate whose forces balance.
//!
//! Its test is stricter than those of the forces by so much that a linear solve of rock and flow
//! together would go on for it alone. What a solve leaves is found again where it is missing:
//! pressures and walls answer by themselves, as in the preconditioner. What that does to the forces
//! is as small as what was missing, and is tested.

use super::convergence::Unmet;
use super::facet_points::{self, Linearisation};
use super::iterate::{Correction, Iterate, Update};
use super::{Iteration, Newton, Step};

/// Most corrections.
const MOST: usize = 6;
/// Factor by which each must reduce what is missing.
const HELPS: f64 = 0.7;

impl Newton {
    /// Corrects an iterate that meets all tests but that of the mass, whose last iteration this
    /// is, until it meets that too; keeps it if it does not come to that, and lets the linear
    /// solves see to it then.
    pub(super) fn conserve(
        &self,
        step: &mut Step<'_>,
        iterate: &mut Iterate,
        iteration: Iteration,
    ) -> Iteration {
        if self.settings.unmet(step.system, iterate, &iteration) != Unmet::Mass {
            return iteration;
        }
        let mut found = (iterate.clone(), iteration);
        for _ in 0..MOST {
            let before = found.1.mass_error;
            let Some(corrected) = self.conserved(step, &mut found.0) else {
                break;
            };
            found.1 = Iteration {
                mass_error: corrected.mass_error,
                force_residual: corrected.force_residual,
                closure_error: corrected.closure_error,
                smallest_aperture: corrected.smallest_aperture,
                ..found.1
            };
            match self.settings.unmet(step.system, &found.0, &found.1) {
                Unmet::Nothing => {
                    *iterate = found.0;
                    return found.1;
                }
                Unmet::Mass if found.1.mass_error <= HELPS * before => {}
                _ => break,
            }
        }
        iterate.conserves = false;
        iteration
    }

    /// One correction; none if there is nothing to correct with, or numbers are not finite.
    fn conserved(&self, step: &mut Step<'_>, iterate: &mut Iterate) -> Option<Iteration> {
        let system = step.system;
        let state = &iterate.state;
        let (coupling, fluid) = system.coupling().zip(state.fluid.as_ref())?;
        let planes = facet_points::linearised(system, state, Linearisation::Tangents);
        let flow = iterate.flow.clone()?;
        let linearised = flow.linearised(coupling, fluid, &state.load);
        let missing = linearised.missing();
        let solution = self.linear.conserving(system, &linearised, &missing)?;
        let correction = Correction::of(system, solution.unknowns, false);
        let correction = correction.with_potentials(solution.potentials);
        let update = Update {
            correction: &correction,
            planes: &planes,
        };
        iterate.correct(step, update).ok()
    }
}
