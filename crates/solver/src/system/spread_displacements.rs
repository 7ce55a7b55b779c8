//! Displacements of points that come, from those of points that were there.

use glam::DVec3;
use kluft_mesh::Mesh;
use rayon::prelude::*;

use crate::space::sector_nodes::SectorNodes;

/// Fills what is not known: across a facet the walls begin without a jump, all other points begin
/// with the nearest of those known that they share cells with; with none at zero.
///
/// Where a point that comes begins has no part in any stress; only the displacement that is shown
/// has it for its origin.
pub(super) fn spread(
    mesh: &Mesh,
    points: &SectorNodes,
    mut moved: Vec<Option<DVec3>>,
) -> Vec<DVec3> {
    if moved.iter().any(Option::is_none) {
        while across_facets(mesh, points, &mut moved) {}
    }
    let sources = beside_unknown(mesh, points, &moved);
    let place = |point: usize| mesh.nodes[points.node[point] as usize];
    let nearest = |point: usize| {
        let at = place(point);
        let distance = |source: &usize| place(*source).distance_squared(at);
        let source = sources
            .iter()
            .copied()
            .min_by(|a, b| distance(a).total_cmp(&distance(b)));
        source.and_then(|source| moved[source]).unwrap_or_default()
    };
    let all = (0..moved.len()).into_par_iter();
    all.map(|point| moved[point].unwrap_or_else(|| nearest(point)))
        .collect()
}

/// Whether any point got what the one on the other side of a facet has.
fn across_facets(mesh: &Mesh, points: &SectorNodes, moved: &mut [Option<DVec3>]) -> bool {
    let facets = &mesh.facets;
    let pairs = facets.minus_slots.iter().zip(&facets.plus_slots);
    let mut found = false;
    for (&minus, &plus) in pairs {
        let [minus, plus] = [minus, plus].map(|slot| points.of_cell_node[slot as usize] as usize);
        for (here, there) in [(minus, plus), (plus, minus)] {
            if let (None, Some(known)) = (moved[here], moved[there]) {
                moved[here] = Some(known);
                found = true;
            }
        }
    }
    found
}

/// Points whose displacement is known in cells where not all are, ascending.
fn beside_unknown(mesh: &Mesh, points: &SectorNodes, moved: &[Option<DVec3>]) -> Vec<usize> {
    let mut found = Vec::new();
    for cell in 0..mesh.cells.len() {
        let own = points.of_cell_node[mesh.cells.range(cell)].iter();
        let own = own.map(|&point| point as usize);
        if own.clone().any(|point| moved[point].is_none()) {
            found.extend(own.filter(|&point| moved[point].is_some()));
        }
    }
    found.sort_unstable();
    found.dedup();
    found
}
