//! The facet points of an increment: where each is linearised, and how it follows the linear
//! solves.

use glam::{DMat3, DVec3};
use lie_core::{FractureLaw, JointState, RockStiffness, Separation, Tangent, TrialState};
use rayon::prelude::*;

use crate::assembly::facet_point::FacetPoint;
use crate::assembly::interface::Interface;
use crate::linear::Tangents;
use crate::problem::Load;
use crate::system::{FacetPointState, State, System};

/// Stiffness that stands for walls in contact, against that of the rock beside them. Their
/// tractions follow by increments, so it decides how fast they converge and not where.
const RIGID: f64 = 1e6;

/// Share of its aperture that the walls beside a fluid keep in one iteration.
const LEAST_SHARE: f64 = 0.1;

pub(super) fn interface<'a>(system: &'a System<'_>) -> &'a Interface {
    &system.discretisation.interface
}

/// Where the last linear solve of an increment put a facet point.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct LastTrial {
    /// Where the walls are; none before the first solve.
    walls: Option<Walls>,
    /// The trial state that the rock beside it is told by, if there is one.
    returned: Option<Returned>,
}

/// Where the walls of a facet point are.
#[derive(Debug, Clone, Copy)]
struct Walls {
    separation: Separation,
    /// Tangential jump (m), since the walls last stuck without shear.
    slip: DVec3,
}

/// What a trial state that was mapped back to the law tells of the rock.
#[derive(Debug, Clone, Copy)]
struct Returned {
    separation: Separation,
    /// Normal traction on the tangent plane (Pa).
    traction: f64,
}

impl LastTrial {
    /// Stiffness of the surrounding rock (Pa/m) as two linear solves tell it, `-dt/dw`; 0 where
    /// they tell nothing.
    fn secant_to(&self, trial: &TrialState) -> f64 {
        let secant = self.returned.map(|before| {
            let moved = trial.separation.beyond(before.separation);
            (before.traction - trial.normal_traction) / moved
        });
        secant.filter(|secant| secant.is_finite()).unwrap_or(0.0)
    }

    /// Where the walls are, of what is told by solves of another kind.
    pub(super) fn of_other_kind(&self) -> Self {
        Self {
            returned: None,
            ..*self
        }
    }

    /// Where the walls are at a state. A law that is near closure, and whose tangent is large, can
    /// be thrown so far apart that what its walls are beyond it tells no longer where they are.
    fn walls(&self, point: &FacetPoint, state: &FacetPointState) -> Walls {
        let joint = &state.joint;
        let across = state.jump_residual.dot(point.normal);
        let along = state.jump_residual - across * point.normal;
        let of_state = Walls {
            separation: joint.separation.moved(across),
            slip: joint.slip + along,
        };
        let Some(own) = self.walls else {
            return of_state;
        };
        let size = own.separation.opening.abs() + own.separation.aperture.abs();
        let is_far = joint.separation.opening.abs() > size;
        let slips_far = joint.slip.length() > own.slip.length();
        Walls {
            separation: if is_far {
                own.separation
            } else {
                of_state.separation
            },
            slip: if slips_far { own.slip } else { of_state.slip },
        }
    }
}

/// Takes the state to another load: prescribed displacements move walls that are held.
pub(super) fn move_supports(system: &System<'_>, state: &mut State, load: &Load) {
    let jumps = interface(system).prescribed_change(&state.load, load);
    state.load.clone_from(load);
    let pairs = jumps.par_iter().zip(&mut state.facet_points);
    pairs.for_each(|(jump, state)| state.jump_residual += *jump);
}

/// Makes a converged state the one that the next increment starts from.
pub(super) fn commit(system: &System<'_>, state: &mut State) {
    let points = interface(system).points.par_iter();
    let pairs = points.zip(&mut state.facet_points);
    pairs.for_each(|(point, state)| {
        let law = system.law(point);
        law.commit(&mut state.joint, &mut state.history);
    });
}

/// What stands for the laws in a linear solve.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Linearisation {
    /// Their tangents, as Newton's method has it.
    Tangents,
    /// Springs as stiff as the rock beside them, see `splitting`.
    Springs,
}

/// The planes on which a linear solve takes the laws to be.
pub(super) struct Linearised {
    /// Stiffnesses (Pa/m).
    pub(super) tangents: Tangents,
    /// Where they come from.
    pub(super) by: Linearisation,
}

/// The planes of the laws at the state.
pub(super) fn linearised(system: &System<'_>, state: &State, by: Linearisation) -> Linearised {
    let tangents = match by {
        Linearisation::Tangents => tangents(system, state),
        Linearisation::Springs => springs(system, state),
    };
    Linearised { tangents, by }
}

/// Tangents of the laws at the state (Pa/m).
pub(super) fn tangents(system: &System<'_>, state: &State) -> Tangents {
    let points = interface(system).points.par_iter().zip(&state.facet_points);
    let tangents = points.map(|(point, state)| tangent(system.law(point), point, state));
    if system.is_smooth() {
        let exact: Vec<DMat3> = tangents.map(|tangent| tangent.exact).collect();
        return exact.into();
    }
    let (exact, positive): (Vec<DMat3>, Vec<DMat3>) = tangents
        .map(|tangent| (tangent.exact, tangent.positive))
        .unzip();
    Tangents {
        positive: (positive != exact).then_some(positive),
        exact,
    }
}

/// Stiffness of the rock beside each point in place of the tangents, except those of linear laws.
fn springs(system: &System<'_>, state: &State) -> Tangents {
    let points = interface(system).points.par_iter();
    let all: Vec<DMat3> = points
        .zip(&state.facet_points)
        .map(|(point, state)| match system.law(point) {
            law if law.is_linear() => tangent(law, point, state).exact,
            _ => point.spring * DMat3::IDENTITY,
        })
        .collect();
    all.into()
}

/// The tangents with stiffness against sudden motions of walls: `damping` times that of the rock
/// beside them.
pub(super) fn damped(system: &System<'_>, tangents: &Tangents, damping: f64) -> Tangents {
    let points = &interface(system).points;
    let damped = |tangents: &Vec<DMat3>| {
        let pairs = tangents.iter().zip(points);
        pairs
            .map(|(tangent, point)| *tangent + damping * point.spring * DMat3::IDENTITY)
            .collect()
    };
    Tangents {
        exact: damped(&tangents.exact),
        positive: tangents.positive.as_ref().map(damped),
    }
}

pub(super) fn tangent(law: &FractureLaw, point: &FacetPoint, state: &FacetPointState) -> Tangent {
    law.tangent(
        &state.joint,
        &state.history,
        point.normal,
        RIGID * point.spring,
    )
}

/// Tractions on the tangent planes of the laws (Pa).
pub(super) fn linearised_tractions(
    system: &System<'_>,
    state: &State,
    tangents: &Tangents,
) -> Vec<DVec3> {
    let points = interface(system).points.par_iter();
    points
        .zip(&state.facet_points)
        .zip(&tangents.exact)
        .map(|((point, state), tangent)| {
            state.joint.traction(point.normal) + *tangent * state.jump_residual
        })
        .collect()
}

/// Adds to the tractions (Pa) of all facet points.
pub(super) fn pull(system: &System<'_>, state: &mut State, tractions: &[DVec3]) {
    let points = interface(system).points.iter().zip(tractions);
    for ((point, traction), state) in points.zip(&mut state.facet_points) {
        let across = traction.dot(point.normal);
        state.joint.normal_traction += across;
        state.joint.shear += *traction - across * point.normal;
    }
}

/// Moves all facet points by the change of their jumps (m) to where they are linearised next;
/// returns their closure errors (Pa).
pub(super) fn follow(
    system: &System<'_>,
    state: &mut State,
    last: &mut [LastTrial],
    changes: &[DVec3],
    planes: &Linearised,
) -> Vec<f64> {
    let flow = system.coupling().filter(|_| system.is_smooth());
    let follows = |law: &FractureLaw, trial: &TrialState, state: &FacetPointState| {
        flow.is_some_and(|flow| opens(trial, state) || (law.lets_walls_pass() && flow.traps()))
    };
    let points = interface(system).points.par_iter();
    points
        .zip(changes)
        .zip(&planes.tangents.exact)
        .zip(state.facet_points.par_iter_mut().zip(last))
        .map(|(((point, change), tangent), (state, last))| {
            let law = system.law(point);
            let trial = trial(point, (state, last), *tangent, *change);
            match planes.by {
                Linearisation::Springs if !law.is_linear() => split(law, point, trial, state),
                Linearisation::Tangents if follows(law, &trial, state) => {
                    at_jump(law, point, &trial, state)
                }
                _ => follow_point(law, point, &trial, state, last),
            }
        })
        .collect()
}

/// Where a change of the jump (m) takes a facet point on the tangent plane of its law.
fn trial(
    point: &FacetPoint,
    (state, last): (&FacetPointState, &mut LastTrial),
    tangent: DMat3,
    change: DVec3,
) -> TrialState {
    let walls = last.walls(point, state);
    let opening = change.dot(point.normal);
    let slip = walls.slip + change - opening * point.normal;
    // Rounding leaves a part of the slip across the walls. Added up over a path it is more than
    // what walls without load open by.
    let rounded = slip.dot(point.normal);
    let traction = state.joint.traction(point.normal) + tangent * (state.jump_residual + change);
    let across = traction.dot(point.normal);
    let walls = Walls {
        separation: walls.separation.moved(opening + rounded),
        slip: slip - rounded * point.normal,
    };
    last.walls = Some(walls);
    TrialState {
        separation: walls.separation,
        slip: walls.slip,
        normal_traction: across,
        shear: traction - across * point.normal,
    }
}

fn follow_point(
    law: &FractureLaw,
    point: &FacetPoint,
    trial: &TrialState,
    state: &mut FacetPointState,
    last: &mut LastTrial,
) -> f64 {
    let secant = last.secant_to(trial).clamp(0.0, point.spring);
    last.returned = Some(Returned {
        separation: trial.separation,
        traction: trial.normal_traction,
    });
    let rock = rock_stiffness(law, point, trial, secant);
    update_state(law, point, trial, rock, state)
}

/// Whether a linear solve opens a facet point.
fn opens(trial: &TrialState, state: &FacetPointState) -> bool {
    trial.separation.beyond(state.joint.separation) > 0.0
}

/// Moves a facet point, whose law is smooth, to where a linear solve has put its walls, but no
/// closer than to a share of its aperture; returns its closure error (Pa).
fn at_jump(
    law: &FractureLaw,
    point: &FacetPoint,
    trial: &TrialState,
    state: &mut FacetPointState,
) -> f64 {
    let before = state.joint.separation;
    let least = LEAST_SHARE * before.aperture;
    let separation = match trial.separation.aperture < least {
        true => before.moved(least - before.aperture),
        false => trial.separation,
    };
    state.jump_residual = trial.separation.beyond(separation) * point.normal;
    state.joint = law.state_at(&TrialState {
        separation,
        ..*trial
    });
    let traction = trial.normal_traction * point.normal + trial.shear;
    (traction - state.joint.traction(point.normal)).length()
}

/// The half step of the laws in the splitting: from the traction that the law had, not from what
/// the spring made of it.
fn split(
    law: &FractureLaw,
    point: &FacetPoint,
    trial: TrialState,
    state: &mut FacetPointState,
) -> f64 {
    let trial = TrialState {
        normal_traction: state.joint.normal_traction,
        shear: state.joint.shear,
        ..trial
    };
    let spring = RockStiffness {
        normal: point.spring,
        shear: point.spring,
    };
    update_state(law, point, &trial, spring, state)
}

/// Moves a facet point to where its law balances the rock; returns its closure error (Pa).
fn update_state(
    law: &FractureLaw,
    point: &FacetPoint,
    trial: &TrialState,
    rock: RockStiffness,
    state: &mut FacetPointState,
) -> f64 {
    let joint = if law.is_linear() {
        law.state_at(trial)
    } else {
        law.return_map(trial, rock, &state.history)
    };
    state.joint = joint;
    state.jump_residual = jump_beyond(point, trial, &joint);
    let traction = trial.normal_traction * point.normal + trial.shear;
    (traction - joint.traction(point.normal))
        .length()
        .max(point.spring * state.jump_residual.length())
}

/// How much further apart the walls are at a trial state than a law has them (m).
pub(super) fn jump_beyond(point: &FacetPoint, trial: &TrialState, joint: &JointState) -> DVec3 {
    let opening = trial.separation.beyond(joint.separation);
    opening * point.normal + trial.slip - joint.slip
}

/// The secant serves where the law is smooth. Two linear solves on different sides of a kink tell
/// nothing of the rock, so there it is the bound.
fn rock_stiffness(
    law: &FractureLaw,
    point: &FacetPoint,
    trial: &TrialState,
    secant: f64,
) -> RockStiffness {
    let bound = point.rock_stiffness();
    let touching = law.closure.normal_stiffness.is_infinite();
    let parted = trial.normal_traction + bound.normal * law.closure.gap(trial.separation) > 0.0;
    let kinked = touching || (parted && !law.closure.is_smooth());
    RockStiffness {
        normal: if kinked { bound.normal } else { secant },
        ..bound
    }
}

#[cfg(test)]
mod tests {
    use lie_core::{Closure, ClosureKind, JointHistory};

    use super::*;

    /// Nearly closed walls, of which an inexact solve makes so much tension that the law balances
    /// it kilometres away, are where the solves have put them.
    #[test]
    fn walls_are_found_again_where_solves_have_put_them() {
        let aperture = 1e-5;
        let kind = ClosureKind::Hyperbolic {
            max_closure: aperture,
        };
        let law = FractureLaw::elastic(Closure::new(aperture, 1e9, kind), 1e9);
        let point = FacetPoint {
            facet: 0,
            fracture: 0,
            law: 0,
            position: DVec3::ZERO,
            area: 1.0,
            normal: DVec3::Z,
            spring: 1e11,
            initial: JointState::default(),
        };
        let still = TrialState {
            separation: law.closure.opened(0.0),
            slip: DVec3::ZERO,
            normal_traction: -1e20,
            shear: DVec3::ZERO,
        };
        let history = JointHistory::default();
        let joint = law.return_map(&still, point.rock_stiffness(), &history);
        let start = joint.separation;
        let mut state = FacetPointState {
            joint,
            jump_residual: DVec3::ZERO,
            history,
        };
        let mut last = LastTrial::default();
        let mut farthest: f64 = 0.0;
        for change in [2e-6, -1e-6, -0.5e-6] {
            let exact = tangent(&law, &point, &state).exact;
            let trial = trial(
                &point,
                (&state, &mut last),
                exact,
                DVec3::new(0.0, 1e-6, change),
            );
            follow_point(&law, &point, &trial, &mut state, &mut last);
            farthest = farthest.max(state.joint.separation.opening);
        }
        assert!(farthest > 1e3, "{farthest} m");
        let walls = last.walls(&point, &state);
        let moved = walls.separation.beyond(start);
        assert!((moved - 0.5e-6).abs() < 1e-20, "{moved:e} m");
        assert!((walls.slip - DVec3::new(0.0, 3e-6, 0.0)).length() < 1e-20);
    }
}
