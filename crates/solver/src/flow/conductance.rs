//! Transmissivities of facets, the matrix they make, and rates of potentials.

use kluft_algebra::{Lists, ScalarMatrix};
use kluft_mesh::{Defect, Mesh};
use lie_core::FacetFlow;
use rayon::prelude::*;

use super::numbering::FlowNodes;
use crate::problem::{Conduit, Flow};

/// How the fractures conduct at some apertures.
#[derive(Debug, Clone)]
pub(super) struct Conductance {
    /// Stencil of each conducting facet.
    pub(super) stencils: Vec<FacetFlow>,
    /// Transmissivity of each conducting facet (m^3/(Pa s)): the mean of its corners'.
    pub(super) transmissivity: Vec<f64>,
    /// Over all pressures: `K_ij = sum_f T_f k_ij` beside the diagonal, which makes rows add up to
    /// zero.
    pub(super) matrix: ScalarMatrix,
}

impl Conductance {
    /// That of fractures with these apertures (m), one for each entry of the flat node list of the
    /// facets.
    pub(super) fn of(mesh: &Mesh, flow: &Flow, nodes: &FlowNodes, apertures: &[f64]) -> Self {
        let facets = nodes.facets.par_iter();
        let (stencils, transmissivity): (Vec<_>, Vec<_>) = facets
            .map(|&facet| {
                let facet = facet as usize;
                let elements = &mesh.facets.elements;
                let corners = mesh.corners(elements, facet);
                let own = &apertures[elements.range(facet)][..corners.len()];
                let conduit = flow.conduits[mesh.facets.fracture[facet] as usize];
                (
                    FacetFlow::of(elements.shapes[facet], &corners),
                    transmissivity(conduit, flow.fluid.viscosity, own),
                )
            })
            .unzip();
        let matrix = matrix(nodes, &stencils, &transmissivity);
        Self {
            stencils,
            transmissivity,
            matrix,
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

fn transmissivity(conduit: Conduit, viscosity: f64, apertures: &[f64]) -> f64 {
    let Conduit::Open(hydraulic) = conduit else {
        return 0.0;
    };
    let of = |aperture: &f64| hydraulic.at(*aperture).transmissivity(viscosity);
    apertures.iter().map(of).sum::<f64>() / apertures.len() as f64
}

/// The matrix row by row; each row takes its facets in ascending order.
fn matrix(nodes: &FlowNodes, stencils: &[FacetFlow], transmissivity: &[f64]) -> ScalarMatrix {
    let rows = (0..nodes.len()).into_par_iter();
    let rows: Vec<(Vec<u32>, Vec<f64>)> = rows
        .map(|row| {
            let columns = columns(nodes, row);
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
                    let place = columns.partition_point(|&known| known < column);
                    values[place] += value;
                    own -= value;
                }
            }
            let place = columns.partition_point(|&known| (known as usize) < row);
            values[place] = own;
            (columns, values)
        })
        .collect();
    let (columns, values): (Vec<_>, Vec<_>) = rows.into_iter().unzip();
    ScalarMatrix {
        pattern: Lists::collect(&columns),
        values: values.concat(),
    }
}

/// The pressures that share a facet with one, itself among them, ascending.
fn columns(nodes: &FlowNodes, row: usize) -> Vec<u32> {
    let facets = nodes.around.of(row).iter();
    let mut columns: Vec<u32> = facets
        .flat_map(|&facet| nodes.corners.of(facet as usize))
        .copied()
        .collect();
    columns.sort_unstable();
    columns.dedup();
    columns
}
