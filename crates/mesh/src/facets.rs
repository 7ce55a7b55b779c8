//! Facets of fractures and boundaries, with the cells on their sides.

use glam::DVec3;
use kluft_defect::Defect;
use rayon::prelude::*;

use crate::adjacency::Adjacency;
use crate::draft::{Draft, Elements};
use crate::orient;
use crate::sides::Sides;
use crate::surfaces::{DraftFacet, Surfaces};

/// Facets of all fractures. The `slots` say where a facet's nodes stand in the flat node list of
/// the cells, and thereby (through [`crate::Sectors::of_cell_node`]) in which sector each side
/// lies.
#[derive(Debug, Clone, Default)]
pub struct Facets {
    /// Shapes and nodes; the right-hand normal points from minus to plus.
    pub elements: Elements,
    /// Index into [`crate::MeshData::fractures`].
    pub fracture: Vec<u32>,
    /// The cell on the minus side.
    pub minus: Vec<u32>,
    /// The cell on the plus side.
    pub plus: Vec<u32>,
    /// Slots of the facet nodes in the minus cell, parallel to `elements.nodes`.
    pub minus_slots: Vec<u32>,
    /// Slots of the facet nodes in the plus cell, parallel to `elements.nodes`.
    pub plus_slots: Vec<u32>,
}

impl Facets {
    /// The facets of a fracture, ascending.
    pub fn of_fracture(&self, fracture: usize) -> impl Iterator<Item = usize> + Clone {
        let all = 0..self.fracture.len();
        all.filter(move |&facet| self.fracture[facet] as usize == fracture)
    }
}

/// Facets of one named part of the outer surface.
#[derive(Debug, Clone)]
pub struct Boundary {
    /// Name of the physical group.
    pub name: String,
    /// Shapes and nodes; the right-hand normal points out of the body.
    pub elements: Elements,
    /// The cell behind each facet.
    pub cell: Vec<u32>,
    /// Slots of the facet nodes in that cell, parallel to `elements.nodes`.
    pub slots: Vec<u32>,
}

/// The facets of fractures and boundaries, and defects of the fractures.
pub(crate) fn collect(
    draft: &Draft,
    nodes: &[DVec3],
    (adjacency, sides): (&Adjacency, Option<&Sides>),
    surfaces: &Surfaces,
) -> (Facets, Vec<Boundary>, Vec<Defect>) {
    let (faces, found) = match sides {
        Some(sides) => (sides.of_facets(adjacency, surfaces), Vec::new()),
        None => orient::fractures(draft, nodes, adjacency, surfaces),
    };
    let facets = collect_facets(&draft.cells.elements, adjacency, surfaces, &faces);
    (
        facets,
        collect_boundaries(draft, adjacency, surfaces),
        found,
    )
}

/// Appends the cell face `face` to `elements` and its slots to `slots`.
pub(crate) fn push_face(
    cells: &Elements,
    adjacency: &Adjacency,
    face: u32,
    elements: &mut Elements,
    slots: &mut Vec<u32>,
) {
    let first = slots.len();
    slots.extend(adjacency.slots(cells, face).map(|slot| slot as u32));
    // No face has more nodes than a quadratic quadrangle.
    let mut nodes = [0; 9];
    let own = &slots[first..];
    for (node, &slot) in nodes.iter_mut().zip(own) {
        *node = cells.nodes[slot as usize];
    }
    elements.push(adjacency.shape_of(cells, face).shape, &nodes[..own.len()]);
}

fn collect_facets(
    cells: &Elements,
    adjacency: &Adjacency,
    surfaces: &Surfaces,
    faces: &[(u32, u32)],
) -> Facets {
    const PER_TASK: usize = 4096;
    let tasks = surfaces.facets.par_chunks(PER_TASK);
    let parts: Vec<Facets> = tasks
        .zip(faces.par_chunks(PER_TASK))
        .map(|(facets, faces)| facets_between(cells, adjacency, facets, faces))
        .collect();
    let mut whole = room_for(faces.len());
    for part in parts {
        whole.elements.extend(&part.elements);
        whole.fracture.extend(part.fracture);
        whole.minus.extend(part.minus);
        whole.plus.extend(part.plus);
        whole.minus_slots.extend(part.minus_slots);
        whole.plus_slots.extend(part.plus_slots);
    }
    whole
}

/// No facets, and room for so many triangles.
fn room_for(count: usize) -> Facets {
    let mut elements = Elements::new();
    elements.shapes.reserve(count);
    elements.offsets.reserve(count);
    elements.nodes.reserve(3 * count);
    Facets {
        elements,
        fracture: Vec::with_capacity(count),
        minus: Vec::with_capacity(count),
        plus: Vec::with_capacity(count),
        minus_slots: Vec::with_capacity(3 * count),
        plus_slots: Vec::with_capacity(3 * count),
    }
}

/// The facets between these pairs of minus and plus faces.
fn facets_between(
    cells: &Elements,
    adjacency: &Adjacency,
    drafts: &[DraftFacet],
    faces: &[(u32, u32)],
) -> Facets {
    let mut facets = room_for(faces.len());
    for (draft, &(minus, plus)) in drafts.iter().zip(faces) {
        push_face(
            cells,
            adjacency,
            minus,
            &mut facets.elements,
            &mut facets.minus_slots,
        );
        for slot in adjacency.slots(cells, minus) {
            let node = cells.nodes[slot];
            let mut twins = adjacency.slots(cells, plus);
            let twin = twins.find(|&slot| cells.nodes[slot] == node);
            facets.plus_slots.extend(twin.map(|slot| slot as u32));
        }
        facets.fracture.push(draft.fracture);
        facets.minus.push(adjacency.cell_of(minus));
        facets.plus.push(adjacency.cell_of(plus));
    }
    facets
}

fn collect_boundaries(draft: &Draft, adjacency: &Adjacency, surfaces: &Surfaces) -> Vec<Boundary> {
    let cells = &draft.cells.elements;
    let collect = |(group, faces): &(usize, Vec<u32>)| {
        let mut boundary = Boundary {
            name: draft.groups[*group].name.clone(),
            elements: Elements::new(),
            cell: Vec::new(),
            slots: Vec::new(),
        };
        for &face in faces {
            boundary.cell.push(adjacency.cell_of(face));
            push_face(
                cells,
                adjacency,
                face,
                &mut boundary.elements,
                &mut boundary.slots,
            );
        }
        boundary
    };
    surfaces.boundaries.iter().map(collect).collect()
}
