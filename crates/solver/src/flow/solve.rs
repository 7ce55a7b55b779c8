//! The steady flow under a load.
//!
//! Potentials are counted from the mean of those given to a network, so that a pressure which is
//! large beside its differences costs them no digits.

use kluft_algebra::LinearFailure;

use super::balance::{ConditionFlow, FlowBalance};
use super::nodal::{self, Nodal, NodalCondition};
use super::places;
use super::steady::FlowSystem;
use crate::problem::Load;

/// Most corrections of a solution by what it leaves over.
const CORRECTIONS: usize = 4;
/// A correction is worth another if it leaves less than this share of what was left before.
const GAIN: f64 = 0.5;

/// The flow at a load.
#[derive(Debug, Clone, PartialEq)]
pub struct FlowState {
    /// Pressure at each node that has one (Pa), nodes ascending.
    pub pressures: Vec<f64>,
    /// `p - rho g . x` there (Pa), less the mean of those given to the network.
    pub potentials: Vec<f64>,
    /// Flow through each of [`crate::Flow::conditions`].
    pub conditions: Vec<ConditionFlow>,
    /// The mass balance.
    pub balance: FlowBalance,
}

/// A flow under a load.
struct Loaded<'s, 'a> {
    system: &'s FlowSystem<'a>,
    load: &'s Load,
    /// What potentials are counted from in each network (Pa).
    references: Vec<f64>,
}

impl FlowSystem<'_> {
    /// The flow under a load; [`Self::factorise`] comes first.
    ///
    /// # Errors
    /// If a number is not finite.
    pub fn solve(&self, load: &Load) -> Result<FlowState, LinearFailure> {
        let mut loaded = Loaded {
            system: self,
            load,
            references: vec![0.0; self.topology.networks.len()],
        };
        loaded.references = loaded.mean_potentials();
        let mut potentials = loaded.first_guess();
        if let Some(factor) = &self.factor {
            let mut left = f64::INFINITY;
            for _ in 0..CORRECTIONS {
                let missing = loaded.missing(&potentials);
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
            true => Ok(loaded.state(potentials)),
            false => Err(LinearFailure::NotFinite),
        }
    }
}

impl Loaded<'_, '_> {
    /// Mean of the potentials that are given to each network (Pa).
    fn mean_potentials(&self) -> Vec<f64> {
        let mut sums = vec![(0.0, 0_usize); self.references.len()];
        let mut add = |entry: &NodalCondition, row: usize| {
            let (sum, count) = &mut sums[self.system.topology.network_of_row[row] as usize];
            *sum += self.driven(entry, row);
            *count += 1;
        };
        for entry in &self.system.conditions {
            match &entry.nodal {
                Nodal::Given(rows) => rows.iter().for_each(|&row| add(entry, row)),
                Nodal::WellPressure(well) => add(entry, well.row),
                Nodal::Shared(_) | Nodal::WellRate(_) => {}
            }
        }
        let mean = |(sum, count): (f64, usize)| sum / count.max(1) as f64;
        sums.into_iter().map(mean).collect()
    }

    /// Potentials where they are given, elsewhere the reference.
    fn first_guess(&self) -> Vec<f64> {
        let mut potentials = vec![0.0; self.system.topology.nodes.len()];
        for entry in &self.system.conditions {
            if let Nodal::Given(rows) = &entry.nodal {
                for &row in rows {
                    potentials[row] = self.driven(entry, row);
                }
            }
        }
        potentials
    }

    /// The potential that a condition gives at a row (Pa).
    fn driven(&self, entry: &NodalCondition, row: usize) -> f64 {
        let condition = &self.system.topology.flow.conditions[entry.condition];
        let node = self.system.topology.nodes.node[row] as usize;
        let elevation = self.system.topology.mesh.nodes[node].z;
        let pressure = places::profile(condition).at_elevation(elevation);
        self.load.factor(condition.case) * pressure - self.weight(row)
    }

    /// What is to be added to the potential of a row for its pressure (Pa): `rho g . x` and the
    /// reference.
    fn weight(&self, row: usize) -> f64 {
        let flow = self.system.topology.flow;
        let gravity = self.load.factor(flow.gravity_case) * flow.gravity;
        let node = self.system.topology.nodes.node[row] as usize;
        let network = self.system.topology.network_of_row[row] as usize;
        flow.fluid.density * gravity.dot(self.system.topology.mesh.nodes[node])
            + self.references[network]
    }

    /// What conditions drive into each row, less what enters under some potentials (m^3/s). At rows
    /// whose pressure is given this is less what enters through that.
    fn missing(&self, potentials: &[f64]) -> Vec<f64> {
        let entering = self.system.conductance.rates(potentials);
        let mut missing: Vec<f64> = entering.into_iter().map(|rate| -rate).collect();
        for entry in &self.system.conditions {
            let condition = &self.system.topology.flow.conditions[entry.condition];
            let rate = nodal::rate(condition, self.load);
            match &entry.nodal {
                Nodal::Given(_) => {}
                Nodal::Shared(shares) => {
                    for &(row, share) in shares {
                        missing[row] += share * rate;
                    }
                }
                Nodal::WellRate(well) => missing[well.row] += rate,
                Nodal::WellPressure(well) => {
                    let wall = self.driven(entry, well.row);
                    missing[well.row] += well.conductance * (wall - potentials[well.row]);
                }
            }
        }
        missing
    }

    fn state(&self, potentials: Vec<f64>) -> FlowState {
        let system = self.system;
        let sums = potentials.iter().enumerate();
        let sums = sums.map(|(row, potential)| potential + self.weight(row));
        let pressures: Vec<f64> = sums.collect();
        let mut missing = self.missing(&potentials);
        let missed = system.topology.free.iter();
        let missed = missed.map(|&row| missing[row as usize].abs()).sum();
        let of = |entry: &NodalCondition| self.through(entry, &pressures, &mut missing);
        let conditions: Vec<ConditionFlow> = system.conditions.iter().map(of).collect();
        let terms = system.conductance.sizes(&potentials);
        let entering = conditions.iter().map(|flow| flow.rate);
        FlowState {
            balance: FlowBalance::of(entering, missed, terms.iter().sum()),
            pressures,
            potentials,
            conditions,
        }
    }

    /// The flow through a condition; what enters at given pressures is taken out of `missing`, so
    /// that a node which two conditions give is counted once.
    fn through(
        &self,
        entry: &NodalCondition,
        pressures: &[f64],
        missing: &mut [f64],
    ) -> ConditionFlow {
        let condition = &self.system.topology.flow.conditions[entry.condition];
        let rate = nodal::rate(condition, self.load);
        match &entry.nodal {
            Nodal::Given(rows) => {
                let sum: f64 = rows.iter().map(|&row| pressures[row]).sum();
                let entering = rows.iter().map(|&row| -std::mem::take(&mut missing[row]));
                ConditionFlow {
                    pressure: sum / rows.len() as f64,
                    // An empty sum of floats is -0.0.
                    rate: entering.fold(0.0, |sum, rate| sum + rate),
                }
            }
            Nodal::Shared(shares) => {
                let parts = shares.iter().map(|&(row, share)| share * pressures[row]);
                ConditionFlow {
                    pressure: parts.sum(),
                    rate,
                }
            }
            Nodal::WellRate(well) => ConditionFlow {
                pressure: pressures[well.row] + rate / well.conductance,
                rate,
            },
            Nodal::WellPressure(well) => {
                let wall = self.driven(entry, well.row) + self.weight(well.row);
                ConditionFlow {
                    pressure: wall,
                    rate: well.conductance * (wall - pressures[well.row]),
                }
            }
        }
    }
}
