//! Networks in steady flow that no pressure is given to and that nothing leaves: what they hold
//! stays, and that is what their pressure follows from.
//!
//! The balances of the nodes of such a network tell its potentials up to a constant. The constant
//! is that at which the network holds as much as in the state before, `sum V_i = sum V_i,before`.
//! What it holds too much is driven out of its nodes, each by its share `s_i` of the area,
//!
//! ```text
//! sum_f T_f sum_j k_ij (phi_j - phi_i) = q_i - s_i (sum V - sum V_before) / tau
//! ```
//!
//! The sum of these equations is that of the volume, since all `q_i` of a network add up to zero;
//! then nothing is driven out. `tau` only makes volumes of rates: it is the time in which the
//! largest pressure would fill the network.

use super::loaded::Kept;
use super::operator::FlowOperator;
use super::topology::Topology;

/// Aperture against the size of a network by which one that holds nothing is measured.
const THINNEST: f64 = 1e-9;

/// A network that keeps what it holds.
#[derive(Debug, Clone)]
pub(super) struct Undrained {
    /// Its rows, ascending.
    rows: Vec<usize>,
    /// Share of each row in its area.
    shares: Vec<f64>,
    /// Its area (m^2).
    area: f64,
}

/// All networks of a steady flow that keep what they hold; `areas` are those of all rows (m^2).
pub(super) fn find(topology: &Topology<'_>, areas: &[f64]) -> Vec<Undrained> {
    let networks = topology.networks.iter().enumerate();
    let kept = networks.filter(|(_, network)| !network.has_pressure);
    let of = |(index, _)| {
        let of_row = topology.network_of_row.iter();
        let own = (0..).zip(of_row).filter(|(_, of)| **of as usize == index);
        let rows: Vec<usize> = own.map(|(row, _)| row).collect();
        let area: f64 = rows.iter().map(|&row| areas[row]).sum();
        Undrained {
            shares: rows.iter().map(|&row| areas[row] / area).collect(),
            rows,
            area,
        }
    };
    kept.map(of).collect()
}

impl Undrained {
    /// Sum over its rows.
    pub(super) fn sum(&self, of_row: impl Fn(usize) -> f64) -> f64 {
        self.rows.iter().fold(0.0, |sum, &row| sum + of_row(row))
    }

    /// `1 / tau` (1/s), for the largest pressure (Pa) and what it held before (m^3).
    pub(super) fn rate(&self, operator: &FlowOperator, pressure: f64, before: &[f64]) -> f64 {
        let conducts = self.sum(|row| operator.conductance.diagonal(row)) / self.rows.len() as f64;
        let thinnest = THINNEST * self.area.powf(1.5);
        // Where nothing has a pressure, nothing flows that a rate would have to be measured by.
        let pressure = if pressure > 0.0 { pressure } else { 1.0 };
        conducts * pressure / self.sum(|row| before[row]).max(thinnest)
    }

    /// Its rows, ascending.
    pub(super) fn rows(&self) -> &[usize] {
        &self.rows
    }

    /// Adds to each row, at its `place` among values, its share of the sum of what a function gives
    /// for the rows.
    pub(super) fn share(
        &self,
        values: &mut [f64],
        of_row: impl Fn(usize) -> f64,
        place: impl Fn(usize) -> usize,
    ) {
        let sum = self.sum(of_row);
        for (&row, share) in self.rows.iter().zip(&self.shares) {
            values[place(row)] += share * sum;
        }
    }

    /// Adds what is driven out at a rate (1/s) of volumes (m^3) beside those before.
    pub(super) fn keep(&self, kept: &mut Kept, rate: f64, [volumes, before]: [&[f64]; 2]) {
        let change = |row: usize| volumes[row] - before[row];
        self.share(&mut kept.rates, |row| rate * change(row), |row| row);
        kept.moved += rate * self.sum(|row| 0.5 * change(row).abs());
        kept.terms += rate * self.sum(|row| volumes[row].abs());
    }
}
