//! The nodes that have a pressure: corners of conducting facets.

use kluft_algebra::Lists;
use kluft_mesh::Mesh;
use rayon::prelude::*;

use crate::problem::{Conduit, Flow};

/// Marks a node that has no pressure.
const NONE: u32 = u32::MAX;

/// Numbering of pressures, by ascending nodes, and of conducting facets.
#[derive(Debug, Clone)]
pub(super) struct FlowNodes {
    /// Node of each pressure.
    pub(super) node: Vec<u32>,
    /// Conducting facets, ascending: indices into the facets of the mesh.
    pub(super) facets: Vec<u32>,
    /// Pressures at the corners of each of `facets`.
    pub(super) corners: Lists,
    /// Of each pressure the conducting facets around it, ascending: indices into `facets`.
    pub(super) around: Lists,
    /// Of each pressure those that it shares a facet with, itself among them, ascending.
    pub(super) columns: Lists,
    /// Pressure of each node, or [`NONE`].
    of_node: Vec<u32>,
}

impl FlowNodes {
    /// Numbers the pressures of a mesh.
    pub(super) fn of(mesh: &Mesh, flow: &Flow) -> Self {
        let fractures = mesh.facets.fracture.iter();
        let conducts = |fracture: u32| flow.conduits[fracture as usize] != Conduit::Sealed;
        let is_active = |facet: u32| flow.inactive.binary_search(&facet).is_err();
        let facets: Vec<u32> = (0..)
            .zip(fractures)
            .filter(|(facet, fracture)| conducts(**fracture) && is_active(*facet))
            .map(|(facet, _)| facet)
            .collect();
        let mut of_node = vec![NONE; mesh.nodes.len()];
        for corner in facets.iter().flat_map(|&facet| corners(mesh, facet)) {
            of_node[*corner as usize] = 0;
        }
        let mut node = Vec::new();
        for (index, number) in of_node.iter_mut().enumerate() {
            if *number != NONE {
                *number = node.len() as u32;
                node.push(index as u32);
            }
        }
        let mut offset = vec![0];
        let mut entries = Vec::new();
        for &facet in &facets {
            let own = corners(mesh, facet).iter();
            entries.extend(own.map(|&corner| of_node[corner as usize]));
            offset.push(entries.len());
        }
        let facet_of_entry = offset.windows(2).enumerate();
        let facet_of_entry: Vec<u32> = facet_of_entry
            .flat_map(|(facet, ends)| std::iter::repeat_n(facet as u32, ends[1] - ends[0]))
            .collect();
        let mut around = Lists::occurrences(&entries, node.len());
        for entry in &mut around.entries {
            *entry = facet_of_entry[*entry as usize];
        }
        let corners = Lists { offset, entries };
        Self {
            columns: columns(&corners, &around, node.len()),
            node,
            facets,
            corners,
            around,
            of_node,
        }
    }

    /// Number of pressures.
    pub(super) fn len(&self) -> usize {
        self.node.len()
    }

    /// The pressure of a node, if it has one.
    pub(super) fn of_node(&self, node: u32) -> Option<usize> {
        let number = self.of_node[node as usize];
        (number != NONE).then_some(number as usize)
    }
}

fn columns(corners: &Lists, around: &Lists, rows: usize) -> Lists {
    let of = |row: usize| {
        let facets = around.of(row).iter();
        let near = facets.flat_map(|&facet| corners.of(facet as usize));
        let mut near: Vec<u32> = near.copied().collect();
        near.sort_unstable();
        near.dedup();
        near
    };
    Lists::collect(&(0..rows).into_par_iter().map(of).collect::<Vec<_>>())
}

/// Corners of a facet.
fn corners(mesh: &Mesh, facet: u32) -> &[u32] {
    let elements = &mesh.facets.elements;
    let count = elements.shapes[facet as usize].corner_count();
    &elements.nodes_of(facet as usize)[..count]
}
