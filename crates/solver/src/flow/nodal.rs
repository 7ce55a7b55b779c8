//! Conditions as they act on nodes at some transmissivities.

use super::conductance::Conductance;
use super::places::{Place, RowShare};
use super::wells::Well;
use crate::problem::{FlowCondition, FlowDrive, Load};

/// A condition on pressures.
#[derive(Debug, Clone)]
pub(super) enum Nodal {
    /// Given at these rows, ascending.
    Given(Vec<usize>),
    /// A rate that these rows share, ascending, with shares that add up to 1.
    Shared(Vec<(usize, f64)>),
    /// A rate per area (m/s) that these rows have (m^2), ascending; areas are times what varies.
    PerArea(Vec<(usize, f64)>),
    /// A rate through the wall of a borehole.
    WellRate(Well),
    /// The pressure at the wall of a borehole.
    WellPressure(Well),
}

/// A condition, and what it does to rows.
#[derive(Debug, Clone)]
pub(super) struct NodalCondition {
    /// Index into [`crate::Flow::conditions`].
    pub(super) condition: usize,
    /// What it does.
    pub(super) nodal: Nodal,
}

/// All conditions of a flow, with the places where they act.
pub(super) fn conditions(
    places: &[Place],
    conditions: &[FlowCondition],
    conductance: &Conductance,
) -> Vec<NodalCondition> {
    let pairs = places.iter().zip(conditions).enumerate();
    let of = |(index, (place, condition)): (usize, (&Place, &FlowCondition))| NodalCondition {
        condition: index,
        nodal: nodal(place, &condition.drive, &conductance.transmissivity),
    };
    pairs.map(of).collect()
}

fn nodal(place: &Place, drive: &FlowDrive, transmissivity: &[f64]) -> Nodal {
    match (place, drive.is_pressure()) {
        (Place::Rows(shares), false) if matches!(drive, FlowDrive::Leakoff(_)) => {
            let runs = shares.chunk_by(|a, b| a.row == b.row);
            let area = |run: &[RowShare]| run.iter().map(|share| share.weight).sum();
            Nodal::PerArea(runs.map(|run| (run[0].row, area(run))).collect())
        }
        (Place::Well(well), true) => Nodal::WellPressure(well.at(transmissivity)),
        (Place::Well(well), false) => Nodal::WellRate(well.at(transmissivity)),
        (Place::Rows(shares), true) => {
            let mut rows: Vec<usize> = shares.iter().map(|share| share.row).collect();
            rows.dedup();
            Nodal::Given(rows)
        }
        (Place::Rows(shares), false) => {
            let weight = |share: &RowShare| share.weight * transmissivity[share.facet];
            let whole: f64 = shares.iter().map(weight).sum();
            let runs = shares.chunk_by(|a, b| a.row == b.row);
            let of_run = |run: &[RowShare]| {
                let own: f64 = run.iter().map(weight).sum();
                (run[0].row, own / whole)
            };
            Nodal::Shared(runs.map(of_run).collect())
        }
    }
}

/// The rate that a condition drives under a load, in m^3/s, or in m/s if it is one per area; 0 if
/// it gives a pressure, and in steady flow for what leaks off.
pub(super) fn rate(entry: &FlowCondition, load: &Load, is_steady: bool) -> f64 {
    match &entry.drive {
        FlowDrive::Rate(rate) => load.factor(entry.case) * rate,
        FlowDrive::Leakoff(leakoff) if !is_steady => leakoff.rate(load.time),
        FlowDrive::Leakoff(_) | FlowDrive::Pressure(_) => 0.0,
    }
}

/// The mean of that rate over an increment between two loads, which change linearly in time: what
/// has entered then is exact, however long the increment.
pub(super) fn mean_rate(entry: &FlowCondition, [from, to]: [&Load; 2]) -> f64 {
    match &entry.drive {
        FlowDrive::Rate(rate) => 0.5 * (from.factor(entry.case) + to.factor(entry.case)) * rate,
        FlowDrive::Leakoff(leakoff) => leakoff.mean_rate(from.time, to.time),
        FlowDrive::Pressure(_) => 0.0,
    }
}
