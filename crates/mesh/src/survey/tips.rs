//! Edges where fractures end in the rock or on the outer surface, and where they branch.

use super::fractures::FractureSurvey;
use crate::fracture_edges::FractureEdges;
use crate::mesh::Mesh;

/// Adds tips, traces and branchings to the fractures; returns the number of tip edges of each
/// facet.
pub(super) fn add(mesh: &Mesh, edges: &FractureEdges, fractures: &mut [FractureSurvey]) -> Vec<u8> {
    let mut tips = vec![0; mesh.facets.fracture.len()];
    for run in edges.meetings() {
        let (is_outer, long) = (edges.is_outer(run[0].nodes), mesh.edge_length(run[0].nodes));
        for own in run.chunk_by(|a, b| a.fracture == b.fracture) {
            let entry = &mut fractures[own[0].fracture as usize];
            entry.closed &= own.len() > 1;
            if is_outer {
                entry.trace_edges += 1;
                entry.trace_length += long;
            } else if run.len() == 1 {
                entry.tip_edges += 1;
                entry.tip_length += long;
                tips[own[0].facet as usize] += 1;
            }
            if own.len() > 2 {
                entry.branching_length += long;
            }
        }
    }
    tips
}
