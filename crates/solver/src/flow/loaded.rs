//! What a load does to a flow: pressures that it gives, rates that it drives, what is missing.

use super::balance::{ConditionFlow, FlowBalance};
use super::nodal::{self, Nodal, NodalCondition};
use super::operator::FlowOperator;
use super::places::{self, Place};
use super::topology::Topology;
use crate::problem::{Field, FlowCondition, Load};

/// The flow at a load.
#[derive(Debug, Clone, PartialEq)]
pub struct FlowState {
    /// Pressure at each node that has one (Pa), nodes ascending.
    pub pressures: Vec<f64>,
    /// `p - rho g . x` there (Pa), less the mean of those given to the network.
    pub potentials: Vec<f64>,
    /// Flow through each of [`crate::Flow::conditions`].
    pub conditions: Vec<ConditionFlow>,
    /// What has entered through each of them since the run began (m^3); zero in steady flow.
    pub entered: Vec<f64>,
    /// The mass balance.
    pub balance: FlowBalance,
}

/// A flow under a load.
pub(super) struct Loaded<'s, 'a> {
    topology: &'s Topology<'a>,
    load: &'s Load,
    /// What potentials are counted from in each network (Pa).
    pub(super) references: Vec<f64>,
    /// What the increment begins with that ends here; none in steady flow.
    pub(super) from: Option<&'s Load>,
    /// What is stored at each row (m^3/s), if the flow takes time.
    pub(super) stored: Option<Stored>,
    /// What networks that keep what they hold drive out, if there are any.
    pub(super) kept: Option<Kept>,
}

/// What is stored at rows.
pub(super) struct Stored {
    /// Rates (m^3/s).
    pub(super) rates: Vec<f64>,
    /// Sum of the sizes of their terms (m^3/s).
    pub(super) terms: f64,
}

/// What networks that keep what they hold drive out where they hold too much.
pub(super) struct Kept {
    /// At rows (m^3/s).
    pub(super) rates: Vec<f64>,
    /// What moves between the nodes of such networks (m^3/s).
    pub(super) moved: f64,
    /// Sum of the sizes of the terms (m^3/s).
    pub(super) terms: f64,
}

impl<'s, 'a> Loaded<'s, 'a> {
    /// A steady flow; potentials are counted from zero.
    pub(super) fn of(topology: &'s Topology<'a>, load: &'s Load) -> Self {
        Self {
            references: vec![0.0; topology.networks.len()],
            topology,
            load,
            from: None,
            stored: None,
            kept: None,
        }
    }

    /// Counts potentials from the mean of those that are given to each network, and elsewhere from
    /// the initial pressure.
    pub(super) fn counted_from_means(self) -> Self {
        let topology = self.topology;
        let elsewhere = match &topology.flow.initial_pressure {
            Field::Profile(profile) => profile.value,
            varying => {
                let first = topology.nodes.node[0] as usize;
                varying.at(topology.mesh.nodes[first], 0.0)
            }
        };
        let elsewhere = vec![elsewhere; self.references.len()];
        self.counted_from_given(&elsewhere)
    }

    /// Counts potentials from the mean of those that are given to each network, else from
    /// `elsewhere` (Pa).
    fn counted_from_given(mut self, elsewhere: &[f64]) -> Self {
        let mut sums = vec![(0.0, 0_usize); self.references.len()];
        for (place, condition) in self.places() {
            if !condition.drive.is_pressure() {
                continue;
            }
            let mut former = None;
            for row in place
                .rows()
                .filter(|row| former.replace(*row) != Some(*row))
            {
                let (sum, count) = &mut sums[self.topology.network_of_row[row] as usize];
                *sum += self.driven(condition, row);
                *count += 1;
            }
        }
        let pairs = sums.into_iter().zip(elsewhere);
        let mean = |((sum, count), elsewhere): ((f64, usize), &f64)| match count {
            0 => *elsewhere,
            _ => sum / count as f64,
        };
        self.references = pairs.map(mean).collect();
        self
    }

    /// Counts potentials from given pressures, one of each network (Pa).
    pub(super) fn counted_from(mut self, references: &[f64]) -> Self {
        self.references = references.to_vec();
        self
    }

    /// Counts potentials from the mean of those that are given to each network, and elsewhere from
    /// that of `pressures` (Pa), less the weight of the fluid: what is stored of a potential is
    /// as exact as the differences that drive the flow.
    pub(super) fn counted_from_means_of(self, pressures: impl Iterator<Item = f64>) -> Self {
        let mut sums = vec![(0.0, 0_usize); self.references.len()];
        for (row, pressure) in pressures.enumerate() {
            let (sum, count) = &mut sums[self.topology.network_of_row[row] as usize];
            *sum += pressure - self.weight(row);
            *count += 1;
        }
        let means = sums
            .into_iter()
            .map(|(sum, count)| sum / count.max(1) as f64);
        self.counted_from_given(&means.collect::<Vec<f64>>())
    }

    /// Sets the potentials that are given.
    pub(super) fn set_given(&self, potentials: &mut [f64]) {
        for (place, condition) in self.places() {
            if condition.drive.is_pressure() && !place.is_well() {
                for row in place.rows() {
                    potentials[row] = self.driven(condition, row);
                }
            }
        }
    }

    fn places(&self) -> impl Iterator<Item = (&'s Place, &'a FlowCondition)> {
        self.topology
            .places
            .iter()
            .zip(&self.topology.flow.conditions)
    }

    fn condition(&self, entry: &NodalCondition) -> &'a FlowCondition {
        &self.topology.flow.conditions[entry.condition]
    }

    /// The potential that a condition gives at a row (Pa).
    pub(super) fn driven(&self, condition: &FlowCondition, row: usize) -> f64 {
        let node = self.topology.nodes.node[row] as usize;
        let pressure = places::given_pressure(condition, self.topology.mesh.nodes[node]);
        self.load.factor(condition.case) * pressure - self.weight(row)
    }

    /// What is to be added to the potential of a row for its pressure (Pa): `rho g . x` and the
    /// reference.
    pub(super) fn weight(&self, row: usize) -> f64 {
        let flow = self.topology.flow;
        let gravity = self.load.factor(flow.gravity_case) * flow.gravity;
        let node = self.topology.nodes.node[row] as usize;
        let network = self.topology.network_of_row[row] as usize;
        flow.fluid.density * gravity.dot(self.topology.mesh.nodes[node]) + self.references[network]
    }

    /// What conditions drive into each row, less what enters under some potentials and what is
    /// stored (m^3/s). At rows whose pressure is given this is less what enters through that.
    pub(super) fn missing(&self, operator: &FlowOperator, potentials: &[f64]) -> Vec<f64> {
        let entering = operator.conductance.rates(potentials);
        let mut missing: Vec<f64> = entering.into_iter().map(|rate| -rate).collect();
        for (missing, stored) in missing.iter_mut().zip(self.stored_rates()) {
            *missing -= stored;
        }
        let kept = self.kept.iter().flat_map(|kept| &kept.rates);
        for (missing, kept) in missing.iter_mut().zip(kept) {
            *missing -= kept;
        }
        for entry in &operator.conditions {
            let condition = self.condition(entry);
            let rate = self.mean_rate(condition);
            match &entry.nodal {
                Nodal::Given(_) => {}
                Nodal::PerArea(areas) => {
                    for &(row, area) in areas {
                        missing[row] += area * rate;
                    }
                }
                Nodal::Shared(shares) => {
                    for &(row, share) in shares {
                        missing[row] += share * rate;
                    }
                }
                Nodal::WellRate(well) => missing[well.row] += rate,
                Nodal::WellPressure(well) => {
                    let wall = self.driven(condition, well.row);
                    missing[well.row] += well.conductance * (wall - potentials[well.row]);
                }
            }
        }
        missing
    }

    fn mean_rate(&self, condition: &FlowCondition) -> f64 {
        match self.from {
            Some(from) => nodal::mean_rate(condition, [from, self.load]),
            None => nodal::rate(condition, self.load, true),
        }
    }

    fn stored_rates(&self) -> &[f64] {
        let rates = self.stored.as_ref().map(|stored| &stored.rates[..]);
        rates.unwrap_or_default()
    }

    /// The state with these potentials (Pa).
    pub(super) fn state(&self, operator: &FlowOperator, potentials: Vec<f64>) -> FlowState {
        let sums = potentials.iter().enumerate();
        let sums = sums.map(|(row, potential)| potential + self.weight(row));
        let pressures: Vec<f64> = sums.collect();
        let mut missing = self.missing(operator, &potentials);
        let missed = self.topology.free.iter();
        // An empty sum of floats is -0.0.
        let missed = missed.fold(0.0, |sum, &row| sum + missing[row as usize].abs());
        let of = |entry: &NodalCondition| self.through(entry, &pressures, &mut missing);
        let conditions: Vec<ConditionFlow> = operator.conditions.iter().map(of).collect();
        let mut terms: f64 = operator.conductance.sizes(&potentials).iter().sum();
        terms += self.stored.as_ref().map_or(0.0, |stored| stored.terms);
        let mut within = 0.0;
        if let Some(kept) = &self.kept {
            within = kept.moved;
            terms += kept.terms;
        }
        let entering = conditions.iter().map(|flow| flow.mean_rate);
        let stored = (self.stored_rates(), within);
        let balance = FlowBalance::of(entering, stored, [missed, terms]);
        FlowState {
            balance,
            pressures,
            potentials,
            entered: vec![0.0; conditions.len()],
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
        let condition = self.condition(entry);
        let rate = nodal::rate(condition, self.load, self.from.is_none());
        let mean_rate = self.mean_rate(condition);
        match &entry.nodal {
            Nodal::Given(rows) => {
                let sum: f64 = rows.iter().map(|&row| pressures[row]).sum();
                let entering = rows.iter().map(|&row| -std::mem::take(&mut missing[row]));
                // An empty sum of floats is -0.0.
                let entering = entering.fold(0.0, |sum, rate| sum + rate);
                ConditionFlow::steady(sum / rows.len() as f64, entering)
            }
            Nodal::Shared(shares) => {
                let parts = shares.iter().map(|&(row, share)| share * pressures[row]);
                ConditionFlow {
                    pressure: parts.sum(),
                    rate,
                    mean_rate,
                }
            }
            Nodal::PerArea(areas) => {
                let area: f64 = areas.iter().map(|(_, area)| area).sum();
                let parts = areas.iter().map(|&(row, area)| area * pressures[row]);
                ConditionFlow {
                    pressure: parts.sum::<f64>() / area,
                    rate: area * rate,
                    mean_rate: area * mean_rate,
                }
            }
            Nodal::WellRate(well) => ConditionFlow {
                pressure: pressures[well.row] + rate / well.conductance,
                rate,
                mean_rate,
            },
            Nodal::WellPressure(well) => {
                let wall = self.driven(condition, well.row) + self.weight(well.row);
                let entering = well.conductance * (wall - pressures[well.row]);
                ConditionFlow::steady(wall, entering)
            }
        }
    }
}
