//! Coupled flow whose undrained networks keep what they hold.

use super::balance::ROUNDING;
use super::coupling::{Coupling, FluidState};
use super::loaded::Kept;
use super::operator::FlowOperator;
use super::steady::FlowSystem;
use crate::problem::Load;

impl Coupling<'_> {
    /// `1 / tau` of each network that keeps what it holds (1/s).
    pub(super) fn keeping(
        &self,
        operator: &FlowOperator,
        (fluid, load): (&FluidState, &Load),
        before: &[f64],
    ) -> Vec<f64> {
        if self.undrained.is_empty() {
            return Vec::new();
        }
        let pressures = self.pressures(fluid, load);
        let largest = pressures
            .iter()
            .fold(0.0, |most, p| f64::max(most, p.abs()));
        let networks = self.undrained.iter();
        networks
            .map(|network| network.rate(operator, largest, before))
            .collect()
    }

    /// What networks that keep what they hold drive out of their nodes, at rates (1/s) for these
    /// volumes and those before (m^3); none if there are no such networks.
    pub(super) fn kept(&self, rates: &[f64], volumes: [&[f64]; 2]) -> Option<Kept> {
        if self.undrained.is_empty() {
            return None;
        }
        let mut kept = Kept {
            rates: vec![0.0; self.nodes()],
            moved: 0.0,
            terms: 0.0,
        };
        for (network, rate) in self.undrained.iter().zip(rates) {
            network.keep(&mut kept, *rate, volumes);
        }
        if kept.moved <= ROUNDING * kept.terms {
            kept.moved = 0.0;
        }
        Some(kept)
    }

    /// Potentials of the steady flow under a load through walls as far apart as they are, of
    /// networks that keep what they hold about the mean that they have; none if the flow takes
    /// time, or cannot be solved.
    pub(crate) fn steady(&self, fluid: &FluidState, load: &Load) -> Option<Vec<f64>> {
        if self.is_transient {
            return None;
        }
        let mut potentials = self.solved(fluid, load)?;
        for network in &self.undrained {
            let off = network.sum(|row| fluid.potentials[row] - potentials[row]);
            for &row in network.rows() {
                potentials[row] += off / network.rows().len() as f64;
            }
        }
        Some(potentials)
    }

    /// Potentials under a load of a fluid that has come to rest between walls as far apart as they
    /// are, within the bounds of those that it has; none if a network has no pressure to come to
    /// rest at.
    pub(crate) fn at_rest(&self, fluid: &FluidState, load: &Load) -> Option<Vec<f64>> {
        let networks = &self.topology.networks;
        if !networks.iter().all(|network| network.has_pressure) {
            return None;
        }
        let mut bounds = vec![[f64::INFINITY, f64::NEG_INFINITY]; networks.len()];
        let network_of_row = || self.topology.network_of_row.iter().map(|&of| of as usize);
        for (network, potential) in network_of_row().zip(&fluid.potentials) {
            let [least, most] = bounds[network];
            bounds[network] = [least.min(*potential), most.max(*potential)];
        }
        let mut potentials = self.solved(fluid, load)?;
        for (network, potential) in network_of_row().zip(&mut potentials) {
            let [least, most] = bounds[network];
            *potential = potential.clamp(least, most);
        }
        Some(potentials)
    }

    /// Potentials of the steady flow under a load, counted as a fluid has them.
    fn solved(&self, fluid: &FluidState, load: &Load) -> Option<Vec<f64>> {
        let mut system = self.system(fluid);
        self.factorise(&mut system)?;
        let state = system.solve(load).ok()?;
        let loaded = self.loaded(fluid, load);
        let rows = state.pressures.iter().enumerate();
        Some(rows.map(|(row, p)| p - loaded.weight(row)).collect())
    }

    /// Factorises a steady flow; what its networks without a pressure have at one node stays.
    fn factorise(&self, system: &mut FlowSystem<'_>) -> Option<()> {
        let mut held = vec![0.0; self.nodes()];
        for network in &self.undrained {
            let first = network.rows()[0];
            held[first] = system.operator.conductance.diagonal(first);
        }
        system.factorise_with(|row| held[row]).ok()
    }
}
