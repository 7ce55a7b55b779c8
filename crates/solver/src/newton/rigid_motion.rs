//! Blocks that nothing holds once fractures have opened or slide, and so move as rigid bodies.

use kluft_mesh::Defect;
use rayon::prelude::*;

use super::facet_points::{interface, tangent};
use super::{Iteration, Step, StepOutcome};
use crate::space::rigid_modes::{self, Tie};
use crate::system::{State, System};

/// Stiffness that counts as none, against that of the rock beside a facet point.
const NO_STIFFNESS: f64 = 1e-9;
/// Iterations of an increment before free blocks are looked for.
const ITERATIONS_BEFORE_SEARCH: usize = 8;
/// Force out of balance, against the largest, that may be due to free blocks.
const UNBALANCED: f64 = 1e-4;
/// Iterations in a row with free blocks after which the loads are taken to push them.
const UNCONSTRAINED_ITERATIONS: usize = 3;

/// The test whether an iteration goes nowhere because blocks move as rigid bodies.
#[derive(Default)]
pub(super) struct RigidBodyMotion {
    /// Iterations in a row that had free blocks.
    unconstrained: usize,
}

impl RigidBodyMotion {
    /// Looks at the state after iteration `count` of an increment.
    ///
    /// # Errors
    /// [`StepOutcome::RigidBodyMotion`], with the blocks in the record.
    pub(super) fn test(
        &mut self,
        step: &mut Step<'_>,
        state: &State,
        iteration: &Iteration,
        count: usize,
    ) -> Result<(), StepOutcome> {
        let is_late = count >= ITERATIONS_BEFORE_SEARCH && !step.system.is_smooth();
        if is_late && iteration.force_residual > UNBALANCED {
            step.record.rigid_motions = find(step.system, state);
            self.unconstrained = if step.record.rigid_motions.is_empty() {
                0
            } else {
                self.unconstrained + 1
            };
        }
        if self.unconstrained == UNCONSTRAINED_ITERATIONS {
            return Err(StepOutcome::RigidBodyMotion);
        }
        Ok(())
    }
}

/// The blocks that can move freely in a state, with the fractures that let them.
pub(super) fn find(system: &System<'_>, state: &State) -> Vec<Defect> {
    let ties = ties(system, state);
    let names = untied_fractures(system, &ties);
    let discretisation = &system.discretisation;
    rigid_modes::find_with(
        system.problem,
        &discretisation.points,
        &discretisation.supports,
        &ties,
        &format!(
            "{} has opened or slides there; hold the block, lower the load, or give the fracture friction, cohesion or stiffness",
            names.join(", ")
        ),
    )
}

/// Names of the fractures with facets that let their sides move.
fn untied_fractures(system: &System<'_>, ties: &[Tie]) -> Vec<String> {
    let mesh = &system.problem.mesh;
    let facets = std::iter::zip(ties, &mesh.facets.fracture);
    let untied = facets.filter(|(tie, _)| !(tie.across && tie.along));
    let mut fractures: Vec<u32> = untied.map(|(_, fracture)| *fracture).collect();
    fractures.sort_unstable();
    fractures.dedup();
    let name = |fracture: &u32| format!("`{}`", mesh.fractures[*fracture as usize]);
    fractures.iter().map(name).collect()
}

/// How each facet holds its two sides together.
fn ties(system: &System<'_>, state: &State) -> Vec<Tie> {
    let none = Tie {
        across: false,
        along: false,
    };
    let mut ties = vec![none; system.problem.mesh.facets.elements.len()];
    let points = &interface(system).points;
    let of_points: Vec<Tie> = points
        .par_iter()
        .zip(&state.facet_points)
        .map(|(point, state)| {
            let stiffness = tangent(system.law(point), point, state).positive;
            let across = point.normal.dot(stiffness * point.normal);
            let trace = stiffness.x_axis.x + stiffness.y_axis.y + stiffness.z_axis.z;
            let enough = NO_STIFFNESS * point.spring;
            Tie {
                across: across > enough,
                along: !state.joint.sliding && trace - across > enough,
            }
        })
        .collect();
    for (point, own) in points.iter().zip(of_points) {
        let tie = &mut ties[point.facet as usize];
        tie.across |= own.across;
        tie.along |= own.along;
    }
    ties
}
