//! What can be told of physical surfaces before roles are given to them.

use crate::adjacency::Adjacency;
use crate::draft::Draft;

/// How the faces of a draft's cells pair up: found once, asked before roles are given and by
/// [`crate::Mesh::build_on`] afterwards.
#[derive(Debug, Clone)]
pub struct Faces {
    pub(crate) adjacency: Adjacency,
}

impl Faces {
    /// Pairs the faces of the cells of `draft`.
    pub fn of(draft: &Draft) -> Self {
        Self {
            adjacency: Adjacency::of(&draft.cells.elements, draft.nodes.len()),
        }
    }

    /// For each group of the same `draft` whether it is a surface with a facet inside the body,
    /// between two cells.
    pub fn inner_surfaces(&self, draft: &Draft) -> Vec<bool> {
        let mut inner = vec![false; draft.groups.len()];
        let facets = &draft.facets;
        for facet in 0..facets.elements.len() {
            let count = facets.elements.shapes[facet].corner_count();
            let corners = &facets.elements.nodes_of(facet)[..count];
            let faces = self.adjacency.faces_at(&draft.cells.elements, corners);
            if faces.count() > 1 {
                for &group in &draft.group_sets[facets.group_set[facet] as usize] {
                    inner[group] = true;
                }
            }
        }
        inner
    }
}
