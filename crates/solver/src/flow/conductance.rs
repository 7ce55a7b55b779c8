//! Transmissivities of facets, the matrix they make, and rates of potentials.

use kluft_algebra::ScalarMatrix;
use kluft_mesh::{Defect, Mesh};
use lie_core::FacetFlow;
use rayon::prelude::*;

use super::numbering::FlowNodes;
use crate::problem::{Conduit, Flow};

/// How the fractures conduct.
#[derive(Debug, Clone)]
pub(super) struct Conductance {
    /// Transmissivity of each conducting facet (m^3/(Pa s)).
    pub(super) transmissivity: Vec<f64>,
    /// Over all pressures: `K_ij = sum_f T_f k_ij` beside the diagonal, which makes rows add up to
    /// zero.
    pub(super) matrix: ScalarMatrix,
}

impl Conductance {
    /// That of facets with these stencils and transmissivities (m^3/(Pa s)).
    pub(super) fn of(nodes: &FlowNodes, stencils: &[FacetFlow], transmissivity: Vec<f64>) -> Self {
        Self {
            matrix: matrix(nodes, stencils, &transmissivity),
            transmissivity,
        }
    }

    /// Fractures with facets that conduct nothing.
    pub(super) fn shut(&self, mesh: &Mesh, nodes: &FlowNodes) -> Vec<Defect> {
        let mut count = vec![0_usize; mesh.fractures.len()];
        for (&facet, &transmissivity) in nodes.facets.iter().zip(&self.transmissivity) {
            let is_shut = transmissivity.is_nan() || transmissivity <= 0.0;
            count[mesh.facets.fracture[facet as usize] as usize] += usize::from(is_shut);
        }
        let shut = mesh
            .fractures
            .iter()
            .zip(count)
            .filter(|(_, count)| *count > 0);
        shut.map(|(name, count)| {
            Defect::new(
                format!("fracture `{name}`"),
                format!("nothing can flow through {count} of its facets: they have no hydraulic aperture"),
                "give it a residual hydraulic aperture, or seal it",
            )
        })
        .collect()
    }

    /// The rates (m^3/s) that enter at all nodes under these potentials (Pa).
    pub(super) fn rates(&self, potentials: &[f64]) -> Vec<f64> {
        let rows = (0..potentials.len()).into_par_iter();
        rows.map(|row| {
            self.sum(row, |value, column| {
                value * (potentials[column] - potentials[row])
            })
        })
        .collect()
    }

    /// What the entries of [`Self::rates`] are made of: the sums of the sizes of their terms
    /// (m^3/s), of which rounding is a small share.
    pub(super) fn sizes(&self, potentials: &[f64]) -> Vec<f64> {
        let rows = (0..potentials.len()).into_par_iter();
        rows.map(|row| {
            self.sum(row, |value, column| {
                value.abs() * (potentials[column].abs() + potentials[row].abs())
            })
        })
        .collect()
    }

    /// `K_ii` (m^3/(Pa s)).
    pub(super) fn diagonal(&self, row: usize) -> f64 {
        -self.sum(row, |value, _| value)
    }

    /// A sum over the entries beside the diagonal of a row, columns ascending.
    fn sum(&self, row: usize, term: impl Fn(f64, usize) -> f64) -> f64 {
        let others = self.matrix.row(row).filter(|(column, _)| *column != row);
        others.map(|(column, value)| term(value, column)).sum()
    }
}

/// The stencil of each conducting facet.
pub(super) fn stencils(mesh: &Mesh, nodes: &FlowNodes) -> Vec<FacetFlow> {
    let elements = &mesh.facets.elements;
    let of = |facet: usize| FacetFlow::of(elements.shapes[facet], &mesh.corners(elements, facet));
    let facets = nodes.facets.par_iter();
    facets.map(|&facet| of(facet as usize)).collect()
}

/// Transmissivity of each conducting facet (m^3/(Pa s)), the mean of its corners', at apertures
/// (m), one for each entry of the flat node list of the facets.
pub(super) fn transmissivities(
    mesh: &Mesh,
    flow: &Flow,
    nodes: &FlowNodes,
    apertures: &[f64],
) -> Vec<f64> {
    let elements = &mesh.facets.elements;
    let of = |facet: usize| {
        let Conduit::Open(hydraulic) = flow.conduit(mesh, facet) else {
            return 0.0;
        };
        let corners = elements.shapes[facet].corner_count();
        let own = apertures[elements.range(facet)][..corners].iter();
        let at = |aperture: &f64| {
            let conduction = hydraulic.at(*aperture);
            conduction.transmissivity(flow.fluid.viscosity)
        };
        own.map(at).sum::<f64>() / corners as f64
    };
    let facets = nodes.facets.par_iter();
    facets.map(|&facet| of(facet as usize)).collect()
}

/// The matrix row by row; each row takes its facets in ascending order.
fn matrix(nodes: &FlowNodes, stencils: &[FacetFlow], transmissivity: &[f64]) -> ScalarMatrix {
    let rows = (0..nodes.len()).into_par_iter();
    let rows: Vec<Vec<f64>> = rows
        .map(|row| {
            let columns = nodes.columns.of(row);
            let place = |column: u32| columns.partition_point(|&known| known < column);
            let mut values = vec![0.0; columns.len()];
            let mut own = 0.0;
            for &facet in nodes.around.of(row) {
                let facet = facet as usize;
                let corners = nodes.corners.of(facet);
                let local = corners.iter().position(|&corner| corner as usize == row);
                let local = local.unwrap_or(0);
                for (other, &column) in corners.iter().enumerate() {
                    if other == local {
                        continue;
                    }
                    let value = transmissivity[facet] * stencils[facet].coupling(local, other);
                    values[place(column)] += value;
                    own -= value;
                }
            }
            values[place(row as u32)] = own;
            values
        })
        .collect();
    ScalarMatrix {
        pattern: nodes.columns.clone(),
        values: rows.concat(),
    }
}
