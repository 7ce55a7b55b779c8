//! What facet points between the same two walls, which have one jump, have in common: a spring, and
//! the normal of their plane.
//!
//! Walls in contact, or stuck, are as stiff as their springs say: springs that differ would share a
//! uniform traction unevenly among the facets around a node. Facets of one plane have normals that
//! differ by the rounding of coordinates. Where the jump is a slip they open by different amounts,
//! and no state but an open one closes all of them: walls in contact would trade their tractions,
//! more with every iteration.

use kluft_mesh::{Mesh, facet_area_vector};

use crate::assembly::facet_point::FacetPoint;
use crate::problem::Problem;
use crate::space::sector_nodes::SectorNodes;

/// Roundings of the largest coordinate by which corners of facets of one plane may miss it.
const ROUNDINGS: f64 = 16.0;

/// Gives the facet points at the nodes of facets what they have in common.
pub(crate) fn share(problem: &Problem, points: &SectorNodes, facet_points: &mut [FacetPoint]) {
    let facets = &problem.mesh.facets;
    let slots = std::iter::zip(&facets.plus_slots, &facets.minus_slots);
    let wall = |slot: u32| points.of_cell_node[slot as usize];
    let walls = slots.map(|(&plus, &minus)| (wall(plus), wall(minus)));
    let mut order: Vec<((u32, u32), usize)> = walls.zip(0..facet_points.len()).collect();
    order.sort_unstable();
    let angles = angles(&problem.mesh);
    for group in order.chunk_by(|a, b| a.0 == b.0) {
        let group: Vec<usize> = group.iter().map(|&(_, index)| index).collect();
        share_spring(&group, facet_points);
        share_normals(&group, &angles, facet_points);
    }
}

/// Angles by which the rounding of coordinates may turn each facet: that against its height.
fn angles(mesh: &Mesh) -> Vec<f64> {
    let coordinates = mesh.nodes.iter().map(|node| node.abs().max_element());
    let rounding = ROUNDINGS * f64::EPSILON * coordinates.fold(0.0, f64::max);
    let elements = &mesh.facets.elements;
    let of_facet = |facet: usize| {
        let corners = mesh.corners(elements, facet);
        let next = corners.iter().cycle().skip(1);
        let edges = corners.iter().zip(next).map(|(a, b)| a.distance(*b));
        let height = facet_area_vector(&corners).length() / edges.fold(0.0, f64::max);
        rounding / height
    };
    (0..elements.len()).map(of_facet).collect()
}

/// The mean by area.
fn share_spring(group: &[usize], facet_points: &mut [FacetPoint]) {
    let (mut area, mut weighed, mut sum) = (0.0, 0.0, 0.0);
    for &index in group {
        let point = &facet_points[index];
        area += point.area;
        weighed += point.area * point.spring;
        sum += point.spring;
    }
    let mean = if area > 0.0 {
        weighed / area
    } else {
        sum / group.len() as f64
    };
    for &index in group {
        facet_points[index].spring = mean;
    }
}

/// That of the first point in the same plane.
fn share_normals(group: &[usize], angles: &[f64], facet_points: &mut [FacetPoint]) {
    for (place, &index) in group.iter().enumerate() {
        let own = facet_points[index];
        let angle = |point: &FacetPoint| angles[point.facet as usize];
        let mut former = group[..place].iter().map(|&former| facet_points[former]);
        let plane = former
            .find(|former| former.normal.distance(own.normal) <= angle(former).max(angle(&own)));
        if let Some(plane) = plane {
            facet_points[index].normal = plane.normal;
        }
    }
}
