//! Two-dimensional meshes, extruded to cells of one metre.

use glam::DVec3;

use crate::draft::{Draft, Elements, TaggedElements};
use crate::geometry::{corners, facet_area_vector};
use crate::shape::Shape;

/// Nodes off a plane by less than this share of the size of the mesh are on it.
const ON_PLANE: f64 = 1e-9;
/// Thickness of the cells (m): forces and areas are those of one metre.
const THICKNESS: f64 = 1.0;

impl Draft {
    /// Whether it is a mesh of the plane: surface elements alone, all at one elevation.
    pub fn is_plane(&self) -> bool {
        let facets = &self.facets.elements;
        if !self.cells.elements.is_empty() || facets.is_empty() {
            return false;
        }
        let places = facets
            .nodes
            .iter()
            .map(|&node| DVec3::from(self.nodes[node as usize]));
        let (low, high) = places.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), x| {
            (low.min(x), high.max(x))
        });
        high.z - low.z <= ON_PLANE * (high - low).length()
    }

    /// A mesh of the plane as cells one metre thick: surface elements become cells, lines become
    /// facets, and the groups of both with them. The mesh that is built of it knows which nodes
    /// move together.
    #[must_use]
    pub fn extruded(mut self) -> Self {
        let flat = std::mem::take(&mut self.facets);
        let lines = std::mem::take(&mut self.lines);
        let without_middles = flat.elements.shapes.contains(&Shape::Quad8);
        let is_quadratic = flat.elements.has_quadratic();
        let count = self.nodes.len() as u32;
        let layers = |height: i8| match height {
            -1 => 0,
            1 => count,
            _ => 2 * count,
        };
        let places: Vec<DVec3> = self.nodes.iter().copied().map(DVec3::from).collect();
        let is_turned = |element: usize| {
            let corners = corners(&flat.elements, element, &places);
            facet_area_vector(&corners).z < 0.0
        };
        let turned: Vec<bool> = (0..flat.elements.len()).map(is_turned).collect();
        let never = vec![false; lines.elements.len()];
        let raised = |elements: &TaggedElements, turned: &[bool]| {
            let mut all = Elements::new();
            for (element, &is_turned) in turned.iter().enumerate() {
                let own = elements.elements.nodes_of(element);
                let shape = elements.elements.shapes[element].extruded(without_middles);
                let Some((shape, over)) = shape.and_then(|shape| Some((shape, shape.flat()?)))
                else {
                    continue;
                };
                let node = |(&flat, &height): (&u8, &i8)| {
                    let height = if is_turned { -height } else { height };
                    own[flat as usize] + layers(height)
                };
                let nodes: Vec<u32> = over.node.iter().zip(&over.height).map(node).collect();
                all.push(shape, &nodes);
            }
            TaggedElements {
                elements: all,
                tags: elements.tags.clone(),
                group_set: elements.group_set.clone(),
            }
        };
        self.cells = raised(&flat, &turned);
        self.facets = raised(&lines, &never);
        self.lines = TaggedElements::new();
        let heights = match is_quadratic {
            true => vec![0.0, THICKNESS, THICKNESS / 2.0],
            false => vec![0.0, THICKNESS],
        };
        let on_plane = flat.elements.nodes.first();
        let elevation = on_plane.map_or(0.0, |&node| self.nodes[node as usize][2]);
        self.nodes = raised_to(&heights, elevation, &self.nodes);
        self.node_tags = self.node_tags.repeat(heights.len());
        for group in self.groups.iter_mut().filter(|group| group.dimension > 0) {
            group.dimension += 1;
        }
        self.is_extruded = true;
        self
    }
}

/// Nodes of a plane at heights above it (m). All have its `elevation`: rounding in that of the
/// nodes would tilt the faces of the cells.
fn raised_to(heights: &[f64], elevation: f64, nodes: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let layer = |height: &f64| {
        let z = elevation + height;
        nodes.iter().map(move |[x, y, _]| [*x, *y, z])
    };
    heights.iter().flat_map(layer).collect()
}
