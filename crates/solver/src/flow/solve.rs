//! The steady flow under a load.
//!
//! Potentials are counted from the mean of those given to a network, so that a pressure which is
//! large beside its differences costs them no digits.

use kluft_algebra::{LinearFailure, ScalarCholesky};

use super::loaded::{FlowState, Loaded};
use super::steady::FlowSystem;
use super::topology::Topology;
use crate::problem::Load;

/// Most corrections of a solution by what it leaves over.
const CORRECTIONS: usize = 4;
/// A correction is worth another if it leaves less than this share of what was left before.
const GAIN: f64 = 0.5;

impl FlowSystem<'_> {
    /// The flow under a load; [`Self::factorise`] comes first.
    ///
    /// # Errors
    /// If a number is not finite.
    pub fn solve(&self, load: &Load) -> Result<FlowState, LinearFailure> {
        let loaded = Loaded::of(&self.topology, load).counted_from_means();
        let mut potentials = vec![0.0; self.topology.nodes.len()];
        loaded.set_given(&mut potentials);
        let factor = self.factor.as_ref();
        corrected(&mut potentials, (&self.topology, factor), |potentials| {
            free_of(&self.topology, &loaded.missing(&self.operator, potentials))
        });
        match potentials.iter().all(|value| value.is_finite()) {
            true => Ok(loaded.state(&self.operator, potentials)),
            false => Err(LinearFailure::NotFinite),
        }
    }
}

/// Values at the rows whose pressure is not given.
pub(super) fn free_of(topology: &Topology<'_>, values: &[f64]) -> Vec<f64> {
    let free = topology.free.iter();
    free.map(|&row| values[row as usize]).collect()
}

/// Corrects potentials by what they leave `missing` (m^3/s) until that gains nothing more.
pub(super) fn corrected(
    potentials: &mut [f64],
    (topology, factor): (&Topology<'_>, Option<&ScalarCholesky>),
    mut missing: impl FnMut(&[f64]) -> Vec<f64>,
) {
    let Some(factor) = factor else {
        return;
    };
    let mut left = f64::INFINITY;
    for _ in 0..CORRECTIONS {
        let rhs = missing(potentials);
        let size: f64 = rhs.iter().map(|value| value.abs()).sum();
        // Written so that what is not finite ends it too.
        if !(size > 0.0 && size < GAIN * left) {
            break;
        }
        left = size;
        for (&row, change) in topology.free.iter().zip(factor.solve(&rhs)) {
            potentials[row as usize] += change;
        }
    }
}
