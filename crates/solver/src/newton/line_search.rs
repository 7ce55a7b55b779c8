//! How far an iterate follows the correction of a linear solve.
//!
//! All the way, as long as the iteration is on its way. Once it has taken more iterations than it
//! should and its errors grow, the correction is halved until they do not: a search for a smaller
//! residual. Beside a fluid and smooth laws corrections stay whole: errors grow there on the way,
//! as joints fill and choke, and short corrections only make it longer.

use super::iterate::{Iterate, Update};
use super::{Iteration, Step, StepOutcome};

/// Iterations that take the whole correction.
const WHOLE_CORRECTIONS: usize = 6;
/// How often a correction is halved.
const HALVINGS: usize = 4;
/// Share of its errors that a shorter correction must gain: until a block that moves freely meets a
/// wall, all leave the same forces out of balance, and the longest is the best.
const LEAST_GAIN: f64 = 1e-2;

/// What a search compares: both measures are against what is large.
pub(super) fn merit(iteration: &Iteration) -> f64 {
    iteration.force_residual + iteration.closure_error + iteration.mass_error
}

/// Corrects an iterate in iteration `count` of its increment.
///
/// # Errors
/// If numbers are no longer finite.
pub(super) fn advance(
    step: &mut Step<'_>,
    iterate: &mut Iterate,
    update: Update<'_>,
    count: usize,
) -> Result<Iteration, StepOutcome> {
    let searches =
        count > WHOLE_CORRECTIONS && !(step.system.is_smooth() && iterate.flow.is_some());
    let former = iterate.merit.filter(|_| searches);
    let best = former.and_then(|former| search(step, iterate, update, former));
    let Some((iteration, next)) = best else {
        return iterate.correct(step, update);
    };
    *iterate = next;
    Ok(iteration)
}

/// The first share of a correction that makes the errors smaller than `former`, else the best one;
/// none if all lead to numbers that are not finite.
fn search(
    step: &mut Step<'_>,
    start: &Iterate,
    update: Update<'_>,
    former: f64,
) -> Option<(Iteration, Iterate)> {
    let mut best: Option<(Iteration, Iterate)> = None;
    for halvings in 0..=HALVINGS {
        let share = 0.5_f64.powi(halvings as i32);
        let scaled = update.correction.scaled(share);
        let mut next = start.clone();
        let part = Update {
            correction: &scaled,
            ..update
        };
        let Ok(iteration) = next.correct(step, part) else {
            continue;
        };
        let gained =
            (1.0 - LEAST_GAIN) * best.as_ref().map_or(f64::INFINITY, |best| merit(&best.0));
        if merit(&iteration) < gained {
            best = Some((iteration, next));
        }
        if merit(&iteration) < former {
            break;
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use kluft_mesh::structured::{Patch, cells_of};
    use kluft_mesh::{Mesh, Shape, SurfaceRole};
    use lie_core::Rock;

    use super::*;
    use crate::newton::facet_points::{self, Linearisation};
    use crate::newton::iterate::Correction;
    use crate::newton::{Newton, NewtonSettings, unobserved};
    use crate::problem::Load;
    use crate::{Condition, Discretisation, Problem, Support, SurfaceLoad, System};

    /// A block on a fixed base, pulled at its top.
    fn block() -> Problem {
        let (bottom, top) = (|x: [f64; 3]| x[2] == 0.0, |x: [f64; 3]| x[2] == 1.0);
        let patches = [
            Patch {
                name: "bottom",
                contains: &bottom,
            },
            Patch {
                name: "top",
                contains: &top,
            },
        ];
        let draft = cells_of(Shape::Tet4, [2; 3], [1.0; 3], &patches);
        let mesh = Mesh::build(draft, &[SurfaceRole::Boundary; 3]).expect("a box");
        let condition = |boundary, load, support| Condition {
            boundary,
            load,
            support,
        };
        let pull = SurfaceLoad::Traction(DVec3::new(1e6, 0.0, 2e6));
        let rock = Rock {
            young_modulus: 25e9,
            poisson_ratio: 0.25,
            density: 0.0,
            anisotropy: None,
        };
        Problem {
            conditions: vec![
                condition(0, None, Some(Support::Displacement([Some(0.0); 3]))),
                condition(1, Some(pull), None),
            ],
            ..Problem::of_rock(mesh, rock)
        }
    }

    /// Without fractures the correction of one solve is exact. Four times of it leaves three times
    /// the loads out of balance; a search halves it twice and is there.
    #[test]
    fn a_correction_that_goes_too_far_is_halved_once_the_iteration_is_late() {
        let problem = block();
        let system = System::assemble(&problem, Discretisation::of(&problem).expect("held"));
        let mut newton = Newton::new(&system, NewtonSettings::default()).expect("analysis");
        let load = Load::proportional(1.0);
        let start = newton.predict(&system, &system.initial_state(), &load);
        let tangents = Linearisation::Tangents;
        let planes = facet_points::linearised(&system, &start.state, tangents);
        newton
            .linear
            .update(&system, &planes.tangents)
            .expect("definite");
        let residual = system.residual(&start.rock_forces, &[], &load);
        let solved = newton.linear.solve(&system, &residual, 1e-12);
        let exact = solved.expect("solvable").unknowns;
        let far: Vec<DVec3> = exact.iter().map(|change| 4.0 * *change).collect();
        let far = [true, false].map(|recycled| Correction::of(&system, far.clone(), recycled));
        let mut observe = unobserved;
        let mut step = Step::new(&system, &load, &mut observe);
        let mut residual_in = |correction: &Correction, count: usize| {
            let mut iterate = start.clone();
            iterate.merit = Some(1e-3);
            let update = Update {
                correction,
                planes: &planes,
            };
            let reached = advance(&mut step, &mut iterate, update, count);
            reached.expect("finite").force_residual
        };
        for far in &far {
            // Forces are measured against the largest, which then are those of the rock: 3 / 4.
            assert!((residual_in(far, 1) - 0.75).abs() < 1e-9);
            assert!(residual_in(far, NewtonSettings::default().max_iterations) < 1e-9);
        }
    }
}
