//! The flow as Newton's method sees it: its answer to small changes of apertures and potentials.
//!
//! With the openings `o` of the facet points and the change `d` of the potentials, which is that of
//! the pressures, the balance of node `i` changes by
//!
//! ```text
//! (rho_i / dt) sum A s o + sum_f g_if dT_f + sum_j E_ij d_j,
//! dT_f = mean of (dT/db) o,   g_if = sum_j k_ij (phi_j - phi_i),   E = L + diag(c V_0) / dt
//! ```
//!
//! How a rate is shared among nodes, and the ratio of the radii of a borehole, count as fixed. In
//! networks that keep what they hold (see `undrained`) `s_i / tau sum dV` is added, over all rows.

use glam::DVec3;
use kluft_algebra::{LinearFailure, ScalarCholesky, ScalarMatrix};
use rayon::prelude::*;

use super::coupling::{Coupling, FlowAtWalls, FlowIncrement, FluidState};
use super::places::Place;
use crate::problem::Load;

/// A linearised flow. Its unknowns are the potentials that are not given.
pub(crate) struct LinearisedFlow<'s, 'a> {
    coupling: &'s Coupling<'a>,
    flow: &'s FlowAtWalls,
    /// `E`.
    matrix: ScalarMatrix,
    /// `rho_i / dt` of each row; zero in steady flow.
    storing: Vec<f64>,
    /// `g_if` of each row and conducting facet beside it, in the order of the numbering.
    /// None where transmissivities stay.
    gradients: Option<Vec<Vec<f64>>>,
}

impl<'a> Coupling<'a> {
    /// The flow at some walls, linearised in an increment; `fluid` is that it is of,
    /// `load` that at the end of the increment.
    pub(crate) fn linearised<'s>(
        &'s self,
        flow: &'s FlowAtWalls,
        fluid: &FluidState,
        (increment, load): (&FlowIncrement, &Load),
    ) -> LinearisedFlow<'s, 'a> {
        let compressibility = self.topology.flow.fluid.compressibility;
        let rate = increment.duration(load).map_or(0.0, f64::recip);
        let stored = |row: usize| rate * compressibility * flow.spaces[row];
        LinearisedFlow {
            matrix: flow.operator.free_matrix(&self.topology, stored),
            storing: flow.density.iter().map(|density| rate * density).collect(),
            gradients: Some(self.gradients(fluid, load)),
            coupling: self,
            flow,
        }
    }

    fn gradients(&self, fluid: &FluidState, load: &Load) -> Vec<Vec<f64>> {
        let potentials = &fluid.potentials;
        let topology = &self.topology;
        let nodes = &topology.nodes;
        let rows = (0..nodes.len()).into_par_iter();
        let mut gradients: Vec<Vec<f64>> = rows
            .map(|row| {
                let facets = nodes.around.of(row).iter();
                let gradient = |&facet: &u32| {
                    let corners = nodes.corners.of(facet as usize);
                    let local = corners.iter().position(|&corner| corner as usize == row);
                    let local = local.unwrap_or(0);
                    let stencil = &topology.stencils[facet as usize];
                    let others = corners.iter().enumerate();
                    let terms = others.map(|(other, &column)| {
                        let drop = potentials[column as usize] - potentials[row];
                        stencil.coupling(local, other) * drop
                    });
                    terms.sum()
                };
                facets.map(gradient).collect()
            })
            .collect();
        let loaded = self.loaded(fluid, load);
        for (place, condition) in topology.places.iter().zip(&topology.flow.conditions) {
            let Place::Well(well) = place else {
                continue;
            };
            if !condition.drive.is_pressure() {
                continue;
            }
            let drop = loaded.driven(condition, well.row) - potentials[well.row];
            // The facets of a borehole are those around its row, in the same order.
            for (gradient, (_, angle)) in gradients[well.row].iter_mut().zip(&well.angles) {
                *gradient -= drop * angle / well.logarithm;
            }
        }
        gradients
    }
}

impl LinearisedFlow<'_, '_> {
    /// The same with transmissivities that stay.
    pub(crate) fn frozen(&self) -> Self {
        Self {
            matrix: self.matrix.clone(),
            storing: self.storing.clone(),
            gradients: None,
            ..*self
        }
    }

    /// Number of unknowns.
    pub(crate) fn len(&self) -> usize {
        self.coupling.topology.free.len()
    }

    /// What is missing at the unknowns (m^3/s).
    pub(crate) fn missing(&self) -> Vec<f64> {
        let free = self.coupling.topology.free.iter();
        free.map(|&row| self.flow.missing[row as usize]).collect()
    }

    /// Adds the forces (N) by which changes of the unknowns (Pa) push, `sign` times, to those on
    /// all unknowns of the rock.
    pub(crate) fn add_push(&self, change: &[f64], sign: f64, forces: &mut [DVec3]) {
        let number = &self.coupling.topology.number;
        let of_row = |row: usize| change.get(number[row] as usize).copied().unwrap_or(0.0);
        self.coupling.push.add(|row| sign * of_row(row), forces);
    }

    /// Adds the forces (N/Pa) of a unit pressure everywhere.
    pub(crate) fn add_unit_push(&self, forces: &mut [DVec3]) {
        self.coupling.push.add(|_| 1.0, forces);
    }

    /// The change of the balance at the unknowns (m^3/s) for openings of the facet points (m) and
    /// changes of the unknowns (Pa).
    pub(crate) fn answer(&self, openings: &[f64], change: &[f64]) -> Vec<f64> {
        let topology = &self.coupling.topology;
        let spaces = self.coupling.points.at_rows(openings);
        let slopes = &self.flow.slopes;
        let of_facets = self
            .coupling
            .points
            .at_facets(|point| slopes[point] * openings[point]);
        let unknowns = topology.free.par_iter().enumerate();
        let answer = |(unknown, &row): (usize, &u32)| {
            let row = row as usize;
            let followed = self.gradients.as_ref().map_or(0.0, |gradients| {
                let facets = topology.nodes.around.of(row).iter();
                let pairs = facets.zip(&gradients[row]);
                pairs.map(|(&f, g)| g * of_facets[f as usize]).sum()
            });
            let entries = self.matrix.row(unknown);
            let driven: f64 = entries.map(|(column, value)| value * change[column]).sum();
            self.storing[row] * spaces[row] + followed + driven
        };
        let mut answers: Vec<f64> = unknowns.map(answer).collect();
        self.keep(&mut answers, &spaces, change);
        answers
    }

    /// Adds the answer of networks that keep what they hold, for the openings integrated over what
    /// belongs to each row (m^3) and changes of the unknowns (Pa).
    fn keep(&self, answers: &mut [f64], spaces: &[f64], change: &[f64]) {
        let topology = &self.coupling.topology;
        let undrained = self.coupling.undrained.iter().zip(&self.flow.keeping);
        for (network, rate) in undrained {
            let kept = |row: usize| {
                let pressed = self.compressed(row) * change[topology.number[row] as usize];
                rate * (self.flow.density[row] * spaces[row] + pressed)
            };
            network.share(answers, kept, |row| topology.number[row] as usize);
        }
    }

    /// `c V_0` of a row (m^3/Pa).
    fn compressed(&self, row: usize) -> f64 {
        let fluid = &self.coupling.topology.flow.fluid;
        fluid.compressibility * self.flow.spaces[row]
    }

    /// A factor of the Schur complement of the unknowns, where the openings of the facet points
    /// under a unit pressure everywhere (m/Pa) stand for the compliance of the rock.
    ///
    /// # Errors
    /// If a number is not finite.
    pub(crate) fn schur(
        &self,
        compliance: &[f64],
        factor: &mut Option<ScalarCholesky>,
    ) -> Result<(), LinearFailure> {
        let topology = &self.coupling.topology;
        let spaces = self.coupling.points.at_rows(compliance);
        let mut extra: Vec<f64> = spaces.iter().map(|space| space.max(0.0)).collect();
        for (row, extra) in extra.iter_mut().enumerate() {
            *extra *= self.storing[row];
        }
        // Each node keeps its part by itself, which is the same for a pressure that is even.
        for (network, rate) in self.coupling.undrained.iter().zip(&self.flow.keeping) {
            for &row in network.rows() {
                let opened = self.flow.density[row] * spaces[row].max(0.0);
                extra[row] = rate * (opened + self.compressed(row));
            }
        }
        let mut matrix = self.matrix.clone();
        for (unknown, &row) in topology.free.iter().enumerate() {
            let range = matrix.pattern.offset[unknown]..matrix.pattern.offset[unknown + 1];
            let columns = &matrix.pattern.entries[range.clone()];
            let own = columns.partition_point(|&column| (column as usize) < unknown);
            matrix.values[range.start + own] += extra[row as usize];
        }
        if matrix.values.iter().any(|value| !value.is_finite()) {
            return Err(LinearFailure::NotFinite);
        }
        let mut made = match factor.take() {
            Some(made) => made,
            None => ScalarCholesky::of(&matrix.pattern)?,
        };
        made.factorise(&matrix)?;
        *factor = Some(made);
        Ok(())
    }
}
