//! The outer faces of the cells.

use glam::DVec3;

use crate::adjacency::Adjacency;
use crate::draft::Elements;
use crate::facets::push_face;
use crate::geometry::{corners, facet_area_vector};

/// The outer faces, and the same as elements.
#[derive(Default)]
pub(crate) struct OuterFaces {
    /// Numbers of the faces, ascending.
    pub(crate) faces: Vec<u32>,
    /// Their shapes and nodes; the right-hand normal points out of the body.
    pub(crate) elements: Elements,
}

impl OuterFaces {
    /// Those without a cell on their other side.
    pub(crate) fn of(cells: &Elements, adjacency: &Adjacency) -> Self {
        let faces = adjacency.outer_faces(cells);
        let (mut elements, mut slots) = (Elements::new(), Vec::new());
        for &face in &faces {
            slots.clear();
            push_face(cells, adjacency, face, &mut elements, &mut slots);
        }
        Self { faces, elements }
    }

    /// Coordinates of the corners of one of them (m).
    pub(crate) fn corners(&self, index: usize, nodes: &[DVec3]) -> Vec<DVec3> {
        corners(&self.elements, index, nodes)
    }

    /// Area vector of one of them (m^2), out of the body.
    pub(crate) fn area_vector(&self, index: usize, nodes: &[DVec3]) -> DVec3 {
        facet_area_vector(&self.corners(index, nodes))
    }
}
