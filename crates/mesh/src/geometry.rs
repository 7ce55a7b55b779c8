//! Lengths, areas and volumes of elements from their corners.

use glam::DVec3;

use crate::draft::Elements;
use crate::shape::{Face, Shape};

/// Area vector of a facet (m^2): its area along the right-hand normal of its corners.
///
/// `A = 1/2 sum_i (x_i - x_0) x (x_{i+1} - x_0)`, exact for flat facets, the mean area vector
/// for warped ones.
pub fn facet_area_vector(corners: &[DVec3]) -> DVec3 {
    let origin = corners[0];
    corners[1..]
        .windows(2)
        .map(|edge| (edge[0] - origin).cross(edge[1] - origin))
        .sum::<DVec3>()
        * 0.5
}

/// Mean of the corners of a facet (m).
pub fn facet_centre(corners: &[DVec3]) -> DVec3 {
    corners.iter().sum::<DVec3>() / corners.len() as f64
}

/// Signed volume of a cell (m^3) from its corners, by the divergence theorem over its faces:
/// `V = 1/3 sum_f (c_f - x_0) . A_f`.
pub fn cell_volume(shape: Shape, corners: &[DVec3]) -> f64 {
    let origin = corners[0];
    if shape == Shape::Tet4 {
        let edge = |to: usize| corners[to] - origin;
        return edge(1).cross(edge(2)).dot(edge(3)) / 6.0;
    }
    let flux = |face: &Face| {
        let points: Vec<DVec3> = face
            .corners()
            .iter()
            .map(|&local| corners[local as usize])
            .collect();
        (facet_centre(&points) - origin).dot(facet_area_vector(&points))
    };
    shape.faces().iter().map(flux).sum::<f64>() / 3.0
}

/// Corner coordinates of an element.
pub(crate) fn corners(elements: &Elements, index: usize, nodes: &[DVec3]) -> Vec<DVec3> {
    elements.nodes_of(index)[..elements.shapes[index].corner_count()]
        .iter()
        .map(|&node| nodes[node as usize])
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_tetrahedron_has_a_sixth_and_outward_faces() {
        let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
        assert!((cell_volume(Shape::Tet4, &corners) - 1.0 / 6.0).abs() < 1e-15);
        let centre = facet_centre(&corners);
        for face in Shape::Tet4.faces() {
            let points: Vec<DVec3> = face.nodes.iter().map(|&i| corners[i as usize]).collect();
            let outward = facet_centre(&points) - centre;
            assert!(facet_area_vector(&points).dot(outward) > 0.0);
        }
    }
}
