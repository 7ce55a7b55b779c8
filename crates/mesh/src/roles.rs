//! The roles of physical surfaces, and what can be told of surfaces before they have one.

use glam::DVec3;

use crate::adjacency::{Adjacency, NONE};
use crate::doubled::{DoubledSurface, doubled_faces, doubled_surfaces};
use crate::draft::Draft;

/// What the scene makes of a physical surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SurfaceRole {
    /// A fracture: it lies inside the rock and its walls can move apart.
    Fracture,
    /// A part of the outer surface that carries a condition.
    Boundary,
    /// Not used: welded where it is inside, free where it is outside.
    Unused,
}

/// How the faces of a draft's cells pair up, and at which of them its facets lie: found once,
/// asked before roles are given and by [`crate::Mesh::build_on`] afterwards.
#[derive(Debug, Clone)]
pub struct Faces {
    pub(crate) adjacency: Adjacency,
    pub(crate) may_touch: bool,
}

impl Faces {
    /// Pairs the faces of the cells of `draft`, and its facets with them.
    pub fn of(draft: &Draft) -> Self {
        Self {
            adjacency: Adjacency::of(draft),
            may_touch: false,
        }
    }

    /// Lets outer faces lie on one another, which is a defect otherwise: for a look at a mesh.
    /// Rock does not hold together there, and nothing keeps it from passing through itself.
    #[must_use]
    pub fn let_touch(self) -> Self {
        Self {
            may_touch: true,
            ..self
        }
    }

    /// The surfaces of the same `draft` on which outer faces lie on one another.
    pub fn doubled_surfaces(&self, draft: &Draft) -> Vec<DoubledSurface> {
        let nodes: Vec<DVec3> = draft.nodes.iter().copied().map(DVec3::from).collect();
        let doubled = doubled_faces(draft, &nodes, &self.adjacency);
        doubled_surfaces(draft, &nodes, &self.adjacency, &doubled)
    }

    /// Roles for the same `draft` without a scene: surfaces with a facet between two cells are
    /// fractures, the others boundaries.
    pub fn guessed_roles(&self, draft: &Draft) -> Vec<SurfaceRole> {
        let inner = self.inner_surfaces(draft);
        let sizes = draft.group_sizes(&draft.facets);
        let groups = draft.groups.iter().zip(inner).zip(sizes);
        groups
            .map(|((group, inside), size)| match (group.dimension, size) {
                (2, 1..) if inside => SurfaceRole::Fracture,
                (2, 1..) => SurfaceRole::Boundary,
                _ => SurfaceRole::Unused,
            })
            .collect()
    }

    /// For each group of the same `draft` whether it is a surface with a facet inside the body,
    /// between two cells.
    pub fn inner_surfaces(&self, draft: &Draft) -> Vec<bool> {
        let mut inner = vec![false; draft.groups.len()];
        for (place, &set) in self.adjacency.facets.iter().zip(&draft.facets.group_set) {
            if place.faces[1] != NONE {
                for &group in &draft.group_sets[set as usize] {
                    inner[group] = true;
                }
            }
        }
        inner
    }
}
