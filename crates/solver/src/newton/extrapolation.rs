//! A first guess for a load step: the path of the last states, continued.
//!
//! Displacements and tractions are continued alike, as polynomials of the load. Both enter the balance
//! of forces linearly, so the guess is in balance; all that is wrong with it is how far the
//! apertures are from the law.

use std::collections::VecDeque;

use glam::DVec3;
use lie_core::{FractureLaw, Landing};
use rayon::prelude::*;

use crate::system::{FacetPointState, State, System};

/// States that are kept: with the present one enough for a cubic.
const KEPT: usize = 3;
/// Largest sum of the sizes of the weights; 15 for a cubic through equal steps. A longer way would
/// magnify what the states have of error.
const WEIGHTIEST: f64 = 15.0;

/// Converged states, the latest first, beside the one that a step starts from.
#[derive(Debug, Clone, Default)]
pub(super) struct Path(VecDeque<Former>);

#[derive(Debug, Clone)]
struct Former {
    load: f64,
    unknowns: Vec<DVec3>,
    /// Tractions of the laws (Pa).
    tractions: Vec<DVec3>,
}

impl Path {
    /// Remembers a converged state that a step has left.
    pub(super) fn remember(&mut self, system: &System<'_>, state: &State) {
        self.0.truncate(KEPT - 1);
        self.0.push_front(Former {
            load: state.load,
            unknowns: state.unknowns.clone(),
            tractions: system.law_tractions(state),
        });
    }

    /// Continues the path through `state` to `load`, if there is one and `load` is not too far. Tells
    /// whether it did.
    pub(super) fn continue_through(
        &self,
        system: &System<'_>,
        state: &mut State,
        load: f64,
    ) -> bool {
        let smooth = system.is_smooth();
        let Some((own, weights)) = self.weights(state.load, load).filter(|_| smooth) else {
            return false;
        };
        let formers = || self.0.iter().zip(&weights);
        let tractions: Vec<DVec3> = system
            .law_tractions(state)
            .into_par_iter()
            .enumerate()
            .map(|(i, now)| own * now + formers().map(|(f, w)| *w * f.tractions[i]).sum::<DVec3>())
            .collect();
        let interface = &system.discretisation.interface;
        let before = interface.jumps(&state.unknowns, state.load);
        let unknowns = state.unknowns.par_iter_mut().enumerate();
        unknowns.for_each(|(i, now)| {
            *now = own * *now + formers().map(|(f, w)| *w * f.unknowns[i]).sum::<DVec3>();
        });
        state.load = load;
        let after = interface.jumps(&state.unknowns, load);
        for (index, point) in interface.points.iter().enumerate() {
            let moved = after[index] - before[index];
            let state = &mut state.facet_points[index];
            follow(
                system.law(point),
                point.normal,
                state,
                moved,
                tractions[index],
            );
        }
        true
    }

    /// Lagrange's weights of the present state and of the former ones, of as many as are close
    /// enough together; none if there is nothing to continue.
    fn weights(&self, present: f64, load: f64) -> Option<(f64, Vec<f64>)> {
        let loads: Vec<f64> = self.0.iter().map(|former| former.load).collect();
        (1..=loads.len()).rev().find_map(|count| {
            let points: Vec<f64> = [present]
                .into_iter()
                .chain(loads[..count].iter().copied())
                .collect();
            let weight = |i: usize| -> f64 {
                let others = (0..points.len()).filter(|&j| j != i);
                others
                    .map(|j| (load - points[j]) / (points[i] - points[j]))
                    .product()
            };
            let weights: Vec<f64> = (0..points.len()).map(weight).collect();
            let size: f64 = weights.iter().map(|weight| weight.abs()).sum();
            (size <= WEIGHTIEST).then(|| (weights[0], weights[1..].to_vec()))
        })
    }
}

/// Takes a facet point to where its law carries `traction` (Pa), its walls having moved by `moved` (m).
fn follow(
    law: &FractureLaw,
    normal: DVec3,
    state: &mut FacetPointState,
    moved: DVec3,
    traction: DVec3,
) {
    let (opened, across) = (moved.dot(normal), traction.dot(normal));
    let shear = traction - across * normal;
    let former = state.walls.separation;
    let landed = former.moved(state.mismatch.dot(normal) + opened);
    let landing = Landing {
        separation: if law.closure.normal_stiffness == 0.0 {
            landed
        } else {
            law.closure.balanced(0.0, across)
        },
        slip: if law.shear_stiffness == 0.0 {
            state.walls.slip + moved - opened * normal
        } else {
            shear / law.shear_stiffness
        },
        normal_traction: across,
        shear,
    };
    state.walls = law.landed(&landing);
    state.mismatch = landed.beyond(landing.separation) * normal;
}

#[cfg(test)]
mod tests {
    use super::*;

    fn path(loads: &[f64]) -> Path {
        let former = |&load: &f64| Former {
            load,
            unknowns: Vec::new(),
            tractions: Vec::new(),
        };
        Path(loads.iter().map(former).collect())
    }

    #[test]
    fn weights_continue_cubics_through_equal_steps() {
        let (own, weights) = path(&[0.3, 0.2, 0.1]).weights(0.4, 0.5).expect("a path");
        for (weight, exact) in [own].iter().chain(&weights).zip([4.0, -6.0, 4.0, -1.0]) {
            assert!((weight - exact).abs() < 1e-12);
        }
    }

    #[test]
    fn a_return_to_a_former_load_takes_its_state() {
        let (own, weights) = path(&[0.5]).weights(1.0, 0.5).expect("a path");
        assert_eq!((own, weights), (0.0, vec![1.0]));
    }

    #[test]
    fn loads_that_repeat_or_lie_far_off_are_left_out() {
        let (_, weights) = path(&[0.5, 1.0]).weights(1.0, 0.5).expect("a path");
        assert_eq!(weights.len(), 1);
        assert!(path(&[0.99]).weights(1.0, 2.0).is_none());
        assert!(path(&[]).weights(1.0, 2.0).is_none());
        assert!(path(&[1.0]).weights(1.0, 2.0).is_none());
    }
}
