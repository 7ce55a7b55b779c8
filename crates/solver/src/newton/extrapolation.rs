//! Extrapolation: the path of the last states, continued.
//!
//! Displacements and tractions are continued alike, as polynomials of the load factor, or of time
//! if there are several load cases. Both enter the balance of forces linearly, so the guess is in
//! balance with the loads continued alike; all that is wrong with it is how far the apertures are
//! from the law, and how far the loads are from their own continuation. A path is not continued
//! around a corner. Pressures of a fluid that follows the walls are continued with them.

use std::collections::VecDeque;

use glam::DVec3;
use lie_core::{FractureLaw, TrialState};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::facet_points::interface;
use super::fluid;
use crate::flow::Coupling;
use crate::problem::Load;
use crate::system::{FacetPointState, State, System};

/// States that are kept: with the present one enough for a cubic.
const FORMER_STATES: usize = 3;
/// Largest sum of the sizes of the weights; 15 for a cubic through equal steps. A longer way would
/// magnify what the states have of error.
const LARGEST_WEIGHTS: f64 = 15.0;
/// Largest distance of the loads continued from those wanted, against the whole step.
const LARGEST_LOAD_ERROR: f64 = 0.5;

/// Converged states, the latest first, beside the one that a step starts from.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(super) struct Path(VecDeque<Former>);

#[derive(Debug, Clone, Serialize, Deserialize)]
struct Former {
    load: Load,
    unknowns: Vec<DVec3>,
    /// Tractions of the laws (Pa).
    tractions: Vec<DVec3>,
    /// Potentials of the fluid and what they are counted from (Pa), if there is one.
    potentials: [Vec<f64>; 2],
}

/// Weights of the states of a path.
#[derive(Debug, Clone, PartialEq)]
struct Weights {
    present: f64,
    /// Of former states, the latest first.
    former: Vec<f64>,
}

impl Former {
    fn of(system: &System<'_>, state: &State) -> Self {
        Self {
            load: state.load.clone(),
            unknowns: state.unknowns.clone(),
            tractions: system.law_tractions(state),
            potentials: fluid::potentials(state).map(<[f64]>::to_vec),
        }
    }
}

impl Path {
    /// Remembers a converged state that a step has left.
    pub(super) fn remember(&mut self, system: &System<'_>, state: &State) {
        self.0.truncate(FORMER_STATES - 1);
        self.0.push_front(Former::of(system, state));
    }

    /// Lets the path lead to a state that is only an estimate, until [`Self::lead_on`].
    pub(super) fn lead_to(&mut self, system: &System<'_>, estimate: &State) {
        self.0.push_front(Former::of(system, estimate));
    }

    /// Forgets the estimate.
    pub(super) fn lead_on(&mut self) {
        self.0.pop_front();
    }

    /// Number of its states.
    pub(super) fn len(&self) -> usize {
        self.0.len()
    }

    /// Whether its states have as many numbers as one.
    pub(super) fn fits(&self, state: &State) -> bool {
        let counts = fluid::potentials(state).map(<[f64]>::len);
        let mut formers = self.0.iter();
        formers.all(|former| {
            former.unknowns.len() == state.unknowns.len()
                && former.tractions.len() == state.facet_points.len()
                && [0, 1].map(|part| former.potentials[part].len()) == counts
        })
    }

    /// Continues the path through `state` to `load`, or close to it, by at most `most` former
    /// states, if there is one and `load` is not too far; returns by how many.
    pub(super) fn continue_through(
        &self,
        system: &System<'_>,
        state: &mut State,
        load: &Load,
        most: usize,
    ) -> usize {
        let smooth = system.is_smooth();
        let abscissa = abscissa(system.coupling().is_some_and(Coupling::is_transient));
        let weights = self.weights(abscissa, [&state.load, load], most);
        let Some(weights) = weights.filter(|_| smooth) else {
            return 0;
        };
        let continued = self.continued([&state.load, load], &weights);
        let own = weights.present;
        let formers = || self.0.iter().zip(&weights.former);
        let tractions: Vec<DVec3> = system
            .law_tractions(state)
            .into_par_iter()
            .enumerate()
            .map(|(i, now)| own * now + formers().map(|(f, w)| *w * f.tractions[i]).sum::<DVec3>())
            .collect();
        let interface = interface(system);
        let before = interface.jumps(&state.unknowns, &state.load);
        let unknowns = state.unknowns.par_iter_mut().enumerate();
        unknowns.for_each(|(i, now)| {
            *now = own * *now + formers().map(|(f, w)| *w * f.unknowns[i]).sum::<DVec3>();
        });
        let part = |part: usize, now: &[f64]| -> Vec<f64> {
            let sum = |i| {
                formers()
                    .map(|(f, w)| w * f.potentials[part][i])
                    .sum::<f64>()
            };
            let now = now.iter().enumerate();
            now.map(|(i, now)| own * now + sum(i)).collect()
        };
        let [potentials, references] = fluid::potentials(state);
        let potentials = [part(0, potentials), part(1, references)];
        fluid::set_potentials(state, potentials);
        state.load = continued;
        let after = interface.jumps(&state.unknowns, &state.load);
        let points = interface.points.par_iter().zip(&mut state.facet_points);
        points.enumerate().for_each(|(index, (point, state))| {
            let moved = after[index] - before[index];
            let law = system.law(point);
            follow(law, point.normal, state, moved, tractions[index]);
        });
        fluid::conduct(system, state);
        weights.former.len()
    }

    /// Lagrange's weights of the present state and of the former ones at a load, of as many up to
    /// `most` as are close enough together and continue the loads as they are; none if there is
    /// nothing to continue. States are a function of the `abscissa` of their loads.
    fn weights(
        &self,
        abscissa: fn(&Load) -> f64,
        [present, load]: [&Load; 2],
        most: usize,
    ) -> Option<Weights> {
        (1..=self.0.len().min(most)).rev().find_map(|count| {
            let formers = self.0.iter().take(count).map(|former| &former.load);
            let points: Vec<f64> = [present].into_iter().chain(formers).map(abscissa).collect();
            let all = lagrange(&points, abscissa(load));
            // Two states at one point have infinite weights, or none that are numbers.
            let size: f64 = all.iter().map(|weight| weight.abs()).sum();
            let weights = Weights {
                present: all[0],
                former: all[1..].to_vec(),
            };
            let continues = || {
                let continued = self.continued([present, load], &weights);
                continued.distance(load) <= LARGEST_LOAD_ERROR * present.distance(load)
            };
            (size <= LARGEST_WEIGHTS && continues()).then_some(weights)
        })
    }

    /// The load that the path leads to on the way to `load`.
    fn continued(&self, [present, load]: [&Load; 2], weights: &Weights) -> Load {
        // A single factor is continued to itself; rounding would only spoil it.
        if load.single_factor().is_some() {
            return load.clone();
        }
        let formers = self.0.iter().zip(&weights.former);
        let terms = formers.map(|(former, weight)| (*weight, &former.load));
        Load::combination([(weights.present, present)].into_iter().chain(terms))
    }
}

/// What a path of states is a function of: time if a flow takes it, or if there are several load
/// cases, else the factor of the only one.
fn abscissa(flow_takes_time: bool) -> fn(&Load) -> f64 {
    if flow_takes_time {
        |load| load.time
    } else {
        |load| load.single_factor().unwrap_or(load.time)
    }
}

/// Weights at `x` of values at `points` (Lagrange).
fn lagrange(points: &[f64], x: f64) -> Vec<f64> {
    let weight = |i: usize| -> f64 {
        let others = (0..points.len()).filter(|&j| j != i);
        others
            .map(|j| (x - points[j]) / (points[i] - points[j]))
            .product()
    };
    (0..points.len()).map(weight).collect()
}

/// Takes a facet point to where its law carries `traction` (Pa), its walls having moved by `moved`
/// (m).
fn follow(
    law: &FractureLaw,
    normal: DVec3,
    state: &mut FacetPointState,
    moved: DVec3,
    traction: DVec3,
) {
    let moved = state.jump_residual + moved;
    let (opened, across) = (moved.dot(normal), traction.dot(normal));
    let shear = traction - across * normal;
    let reached = state.joint.separation.moved(opened);
    let slipped = state.joint.slip + moved - opened * normal;
    let trial = TrialState {
        separation: if law.closure.normal_stiffness == 0.0 {
            reached
        } else {
            law.closure.balanced(0.0, across)
        },
        slip: if law.shear_stiffness == 0.0 {
            slipped
        } else {
            shear / law.shear_stiffness
        },
        normal_traction: across,
        shear,
    };
    state.joint = law.state_at(&trial);
    // What rounding has put between walls and law must not be continued.
    state.jump_residual = reached.beyond(trial.separation) * normal + slipped - trial.slip;
}

#[cfg(test)]
mod tests {
    use lie_core::{Closure, ClosureKind, JointHistory};

    use super::*;

    fn path_of(loads: impl IntoIterator<Item = Load>) -> Path {
        let former = |load| Former {
            load,
            unknowns: Vec::new(),
            tractions: Vec::new(),
            potentials: [Vec::new(), Vec::new()],
        };
        Path(loads.into_iter().map(former).collect())
    }

    fn path(factors: &[f64]) -> Path {
        path_of(factors.iter().map(|&factor| Load::proportional(factor)))
    }

    impl Path {
        fn weights_at(&self, present: f64, load: f64) -> Option<Weights> {
            let loads = [present, load].map(Load::proportional);
            self.weights(abscissa(false), [&loads[0], &loads[1]], FORMER_STATES)
        }
    }

    #[test]
    fn weights_continue_cubics_through_equal_steps() {
        let weights = path(&[0.3, 0.2, 0.1]).weights_at(0.4, 0.5);
        let Weights { present, former } = weights.expect("a path");
        for (weight, exact) in [present].iter().chain(&former).zip([4.0, -6.0, 4.0, -1.0]) {
            assert!((weight - exact).abs() < 1e-12);
        }
    }

    #[test]
    fn a_return_to_a_former_load_takes_its_state() {
        let weights = path(&[0.5]).weights_at(1.0, 0.5);
        let expected = Weights {
            present: 0.0,
            former: vec![1.0],
        };
        assert_eq!(weights, Some(expected));
    }

    #[test]
    fn loads_that_repeat_or_lie_far_off_are_left_out() {
        let weights = path(&[0.5, 1.0]).weights_at(1.0, 0.5);
        assert_eq!(weights.expect("a path").former.len(), 1);
        assert!(path(&[0.99]).weights_at(1.0, 2.0).is_none());
        assert!(path(&[]).weights_at(1.0, 2.0).is_none());
        assert!(path(&[1.0]).weights_at(1.0, 2.0).is_none());
    }

    /// Times and factors of two load cases.
    fn loads(of: &[[f64; 3]]) -> Vec<Load> {
        let load = |&[time, a, b]: &[f64; 3]| Load {
            time,
            factors: vec![a, b],
        };
        of.iter().map(load).collect()
    }

    #[test]
    fn several_cases_are_continued_in_time_and_not_around_corners() {
        let straight = loads(&[[3.0, 3.0, 1.0], [2.0, 2.0, 1.0], [1.0, 1.0, 1.0]]);
        let further = loads(&[[4.0, 4.0, 1.0], [4.0, 3.0, 2.0], [4.0, 3.0, 1.0]]);
        let path = path_of(straight[1..].to_vec());
        let weights = path
            .weights(abscissa(false), [&straight[0], &further[0]], FORMER_STATES)
            .expect("a path");
        let expected = Weights {
            present: 3.0,
            former: vec![-3.0, 1.0],
        };
        assert_eq!(weights, expected);
        let continued = path.continued([&straight[0], &further[0]], &weights);
        assert_eq!(continued, further[0]);
        for corner in &further[1..] {
            assert!(
                path.weights(abscissa(false), [&straight[0], corner], FORMER_STATES)
                    .is_none()
            );
        }
    }

    #[test]
    fn one_case_is_followed_by_its_factor_and_several_or_a_flow_by_time() {
        let [one, two] = [vec![0.5], vec![0.5, 1.0]].map(|factors| Load { time: 3.0, factors });
        assert_eq!(abscissa(false)(&one), 0.5);
        assert_eq!(abscissa(false)(&two), 3.0);
        assert_eq!(abscissa(true)(&one), 3.0);
    }

    #[test]
    fn two_states_of_one_time_are_never_used_together() {
        let same = loads(&[[1.0, 0.0, 0.0], [1.0, 1.0, 1.0], [2.0, 2.0, 2.0]]);
        let path = path_of(same[..1].to_vec());
        assert!(
            path.weights(abscissa(false), [&same[1], &same[2]], FORMER_STATES)
                .is_none()
        );
        assert!(
            path.weights(abscissa(false), [&same[1], &same[1]], FORMER_STATES)
                .is_none()
        );
    }

    /// What rounding has put between walls and law stays known, whatever the traction: else it
    /// would be continued from step to step, and grow.
    #[test]
    fn walls_stay_where_the_unknowns_have_put_them() {
        let law = FractureLaw::elastic(Closure::new(1e-4, 1e11, ClosureKind::Linear), 4e10);
        let normal = DVec3::Z;
        let joint = law.state_at(&TrialState {
            separation: law.closure.opened(2e-6),
            slip: DVec3::new(5e-6, 0.0, 0.0),
            normal_traction: 0.0,
            shear: DVec3::ZERO,
        });
        let mut state = FacetPointState {
            joint,
            jump_residual: DVec3::new(3e-9, -2e-9, 1e-9),
            history: JointHistory::default(),
        };
        let jump = |state: &FacetPointState| {
            let joint = &state.joint;
            joint.separation.opening * normal + joint.slip + state.jump_residual
        };
        let moved = DVec3::new(1e-7, 4e-7, -2e-7);
        let reached = jump(&state) + moved;
        let traction = DVec3::new(3e5, -1e5, 2e5);
        follow(&law, normal, &mut state, moved, traction);
        assert!((jump(&state) - reached).length() < 1e-20, "{state:?}");
        let carried = state.joint.traction(normal);
        assert!((carried - traction).length() < 1e-9, "{carried}");
    }
}
