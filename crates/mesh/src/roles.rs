//! What can be told of physical surfaces before roles are given to them.

use crate::adjacency::Adjacency;
use crate::draft::Draft;

/// For each group whether it is a surface with a facet inside the body, between two cells.
pub fn inner_surfaces(draft: &Draft) -> Vec<bool> {
    let adjacency = Adjacency::of(&draft.cells.elements, draft.nodes.len());
    let mut inner = vec![false; draft.groups.len()];
    let facets = &draft.facets;
    for facet in 0..facets.elements.len() {
        let count = facets.elements.shapes[facet].corner_count();
        let corners = &facets.elements.nodes_of(facet)[..count];
        if adjacency.faces_at(&draft.cells.elements, corners).count() > 1 {
            for &group in &draft.group_sets[facets.group_set[facet] as usize] {
                inner[group] = true;
            }
        }
    }
    inner
}
