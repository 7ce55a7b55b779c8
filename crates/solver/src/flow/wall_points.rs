//! Facet points as the flow sees them: which pressures act there, what the aperture there conducts
//! and stores.

use kluft_algebra::Lists;
use kluft_mesh::{Mesh, Shape};
use rayon::prelude::*;

use super::topology::Topology;
use crate::assembly::facet_point::FacetPoint;
use crate::assembly::interface::Interface;

/// Marks a facet that conducts nothing.
const SEALED: u32 = u32::MAX;

/// Lists of indices, each with a weight.
#[derive(Debug, Clone)]
pub(super) struct WeightedLists {
    lists: Lists,
    weights: Vec<f64>,
}

/// The facet points of conducting facets.
#[derive(Debug, Clone)]
pub(super) struct WallPoints {
    /// Of each facet point the rows whose pressures act there, and their shares `s`; none where
    /// nothing flows.
    rows: WeightedLists,
    /// Of each row the facet points where it acts, and the area that its share stands for, `A s`
    /// (m^2).
    of_row: WeightedLists,
    /// Of each conducting facet its points, and their shares of its area; a point without an area
    /// of its own has none.
    of_facet: WeightedLists,
}

impl WeightedLists {
    fn collect(lists: &[Vec<(u32, f64)>]) -> Self {
        let indices: Vec<Vec<u32>> = lists
            .iter()
            .map(|list| list.iter().map(|(index, _)| *index).collect())
            .collect();
        let weights = lists.iter().flatten().map(|(_, weight)| *weight);
        Self {
            lists: Lists::collect(&indices),
            weights: weights.collect(),
        }
    }

    /// Entries of a list.
    pub(super) fn of(&self, list: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let range = self.lists.offset[list]..self.lists.offset[list + 1];
        let indices = self.lists.entries[range.clone()].iter();
        let indices = indices.map(|&index| index as usize);
        indices.zip(self.weights[range].iter().copied())
    }

    /// Sum of the weights times the values of each list.
    fn sums(&self, values: impl Fn(usize) -> f64 + Sync) -> Vec<f64> {
        let lists = (0..self.lists.count()).into_par_iter();
        let sum = |list: usize| {
            let terms = self.of(list).map(|(index, weight)| weight * values(index));
            terms.fold(0.0, |sum, term| sum + term)
        };
        lists.map(sum).collect()
    }
}

impl WallPoints {
    /// The points of an interface.
    pub(super) fn of(topology: &Topology<'_>, interface: &Interface) -> Self {
        let mesh = topology.mesh;
        let elements = &mesh.facets.elements;
        let mut index = vec![SEALED; elements.len()];
        for (conducting, &facet) in (0..).zip(&topology.nodes.facets) {
            index[facet as usize] = conducting;
        }
        let points = interface.points();
        let mut rows = Vec::with_capacity(points.len());
        let mut of_row = vec![Vec::new(); topology.nodes.len()];
        let mut of_facet = vec![Vec::new(); topology.nodes.facets.len()];
        let numbered = (0..).zip(points).zip(interface.node_shares(mesh));
        for ((number, point), own) in numbered {
            let facet = point.facet as usize;
            if index[facet] == SEALED {
                rows.push(Vec::new());
                continue;
            }
            let corners = topology.nodes.corners.of(index[facet] as usize);
            let shares = corner_shares(elements.shapes[facet], &own, corners);
            for &(row, share) in &shares {
                of_row[row as usize].push((number, point.area * share));
            }
            of_facet[index[facet] as usize].push((number, point.area.max(0.0)));
            rows.push(shares);
        }
        for facet in &mut of_facet {
            let whole: f64 = facet.iter().map(|(_, area)| area).sum();
            facet.iter_mut().for_each(|(_, area)| *area /= whole);
        }
        Self {
            rows: WeightedLists::collect(&rows),
            of_row: WeightedLists::collect(&of_row),
            of_facet: WeightedLists::collect(&of_facet),
        }
    }

    /// Values of rows at the facet points; 0 where nothing flows.
    pub(super) fn at_points(&self, of_row: impl Fn(usize) -> f64 + Sync) -> Vec<f64> {
        self.rows.sums(of_row)
    }

    /// Integrals over what belongs to each row of values at the facet points, `sum A s v`.
    pub(super) fn at_rows(&self, of_point: &[f64]) -> Vec<f64> {
        self.of_row.sums(|point| of_point[point])
    }

    /// Means over conducting facets of values at the facet points.
    pub(super) fn at_facets(&self, of_point: impl Fn(usize) -> f64 + Sync) -> Vec<f64> {
        self.of_facet.sums(of_point)
    }

    /// Whether something flows at a facet point.
    pub(super) fn conducts(&self, point: usize) -> bool {
        self.rows.of(point).next().is_some()
    }

    /// The rows whose pressures act at a facet point, and their shares; none where nothing flows.
    pub(super) fn rows_at(&self, point: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.rows.of(point)
    }
}

/// Values of nodes at the facet points of an interface, as the pressure of a fluid is: linear
/// between the corners of facets.
pub(crate) fn between_corners(
    mesh: &Mesh,
    interface: &Interface,
    of_node: impl Fn(usize) -> f64,
) -> Vec<f64> {
    let elements = &mesh.facets.elements;
    let points = interface.points().iter().zip(interface.node_shares(mesh));
    let value = |(point, own): (&FacetPoint, Vec<(u8, f64)>)| {
        let facet = point.facet as usize;
        let shares = corner_shares(elements.shapes[facet], &own, elements.nodes_of(facet));
        let terms = shares.into_iter();
        terms
            .map(|(node, share)| share * of_node(node as usize))
            .sum()
    };
    points.map(value).collect()
}

/// Shares of the corners in the pressure at a point of a facet, of which the shares of the nodes
/// are given.
fn corner_shares(shape: Shape, nodes: &[(u8, f64)], corners: &[u32]) -> Vec<(u32, f64)> {
    let mut shares = vec![0.0; shape.corner_count()];
    for &(local, share) in nodes {
        for (corner, part) in of_corners(shape, local as usize) {
            shares[corner] += share * part;
        }
    }
    let entries = corners.iter().copied().zip(shares);
    entries.filter(|(_, share)| *share != 0.0).collect()
}

/// Shares of the corners in the pressure at a node of a facet: between corners it is the mean of
/// them.
pub(super) fn of_corners(shape: Shape, local: usize) -> Vec<(usize, f64)> {
    let corners = shape.corner_count();
    if local < corners {
        return vec![(local, 1.0)];
    }
    match shape.edges().get(local - corners) {
        Some(&[a, b]) => vec![(a as usize, 0.5), (b as usize, 0.5)],
        None => (0..corners)
            .map(|corner| (corner, 1.0 / corners as f64))
            .collect(),
    }
}
