//! The steady flow under a load.
//!
//! Potentials are counted from the mean of those given to a network, so that a pressure which is
//! large beside its differences costs them no digits.

use kluft_algebra::LinearFailure;

use super::loaded::{FlowState, Loaded};
use super::steady::FlowSystem;
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
        if let Some(factor) = &self.factor {
            let mut left = f64::INFINITY;
            for _ in 0..CORRECTIONS {
                let missing = loaded.missing(&self.operator, &potentials);
                let rhs: Vec<f64> = self
                    .topology
                    .free
                    .iter()
                    .map(|&row| missing[row as usize])
                    .collect();
                let size: f64 = rhs.iter().map(|value| value.abs()).sum();
                // Written so that what is not finite ends it too.
                if !(size > 0.0 && size < GAIN * left) {
                    break;
                }
                left = size;
                for (&row, change) in self.topology.free.iter().zip(factor.solve(&rhs)) {
                    potentials[row as usize] += change;
                }
            }
        }
        match potentials.iter().all(|value| value.is_finite()) {
            true => Ok(loaded.state(&self.operator, potentials)),
            false => Err(LinearFailure::NotFinite),
        }
    }
}
