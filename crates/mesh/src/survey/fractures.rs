//! Fractures one by one: size, place, tips, junctions.

use glam::DVec3;

use super::orientation::{self, MeanOrientation};
use crate::fracture_edges::FracturesAtNodes;
use crate::geometry::{facet_area_vector, facet_centre};
use crate::mesh::Mesh;

/// One fracture.
#[derive(Debug, Clone, PartialEq)]
pub struct FractureSurvey {
    /// Number of facets.
    pub facets: usize,
    /// Area between the corners of the facets (m^2).
    pub area: f64,
    /// How it lies in space.
    pub orientation: MeanOrientation,
    /// Lowest and highest coordinates (m).
    pub bounds: (DVec3, DVec3),
    /// Number of surfaces that do not share an edge.
    pub components: usize,
    /// Whether no edge belongs to one facet only: a sphere, not a disc.
    pub closed: bool,
    /// Number of edges where the fracture ends in the rock.
    pub tip_edges: usize,
    /// Their length (m).
    pub tip_length: f64,
    /// Number of edges on the outer surface.
    pub trace_edges: usize,
    /// Their length (m).
    pub trace_length: f64,
    /// Length of the edges where three or more of its own facets meet (m).
    pub branching_length: f64,
    /// Number of its nodes with 3, 4, 5, 6, 7 and at least 8 sectors.
    pub junction_nodes: [usize; 6],
}

impl FractureSurvey {
    pub(super) fn empty() -> Self {
        Self {
            facets: 0,
            area: 0.0,
            orientation: MeanOrientation::default(),
            bounds: (DVec3::INFINITY, DVec3::NEG_INFINITY),
            components: 0,
            closed: true,
            tip_edges: 0,
            tip_length: 0.0,
            trace_edges: 0,
            trace_length: 0.0,
            branching_length: 0.0,
            junction_nodes: [0; 6],
        }
    }
}

/// Area vectors and centres of all facets.
pub(super) struct FacetGeometry {
    pub(super) areas: Vec<DVec3>,
    pub(super) centres: Vec<DVec3>,
}

impl FacetGeometry {
    pub(super) fn of(mesh: &Mesh) -> Self {
        let elements = &mesh.facets.elements;
        let corners = (0..elements.len()).map(|facet| mesh.corners(elements, facet));
        let (areas, centres) = corners
            .map(|corners| (facet_area_vector(&corners), facet_centre(&corners)))
            .unzip();
        Self { areas, centres }
    }
}

pub(super) fn add_facets(mesh: &Mesh, geometry: &FacetGeometry, fractures: &mut [FractureSurvey]) {
    let of_facet = &mesh.facets.fracture;
    for (&area, &fracture) in geometry.areas.iter().zip(of_facet) {
        let entry = &mut fractures[fracture as usize];
        entry.facets += 1;
        entry.area += area.length();
    }
    let orientations = orientation::of_fractures(&geometry.areas, of_facet, fractures.len());
    for (entry, orientation) in fractures.iter_mut().zip(orientations) {
        entry.orientation = orientation;
    }
}

pub(super) fn add_nodes(
    mesh: &Mesh,
    at_nodes: &FracturesAtNodes,
    fractures: &mut [FractureSurvey],
) {
    for node in 0..mesh.nodes.len() {
        for &fracture in at_nodes.of(node) {
            let entry = &mut fractures[fracture as usize];
            let (low, high) = &mut entry.bounds;
            *low = low.min(mesh.nodes[node]);
            *high = high.max(mesh.nodes[node]);
            let sectors = mesh.sectors.count[node] as usize;
            if sectors > 2 {
                entry.junction_nodes[sectors.min(8) - 3] += 1;
            }
        }
    }
}
