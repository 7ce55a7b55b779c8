//! The checked mesh.

use glam::DVec3;
use rayon::prelude::*;

use crate::adjacency::Adjacency;
use crate::draft::{Draft, Elements, Group};
use crate::roles::{Faces, SurfaceRole};
use crate::sectors::{self, Sectors};
use crate::surfaces::{DraftFacet, Surfaces};
use crate::{blocks, check, orient};
use kluft_defect::Defect;

/// Facets of all fractures. The `slots` say where a facet's nodes stand in the flat node list of
/// the cells, and thereby (through [`Sectors::of_cell_node`]) in which sector each side lies.
#[derive(Debug, Clone, Default)]
pub struct Facets {
    /// Shapes and nodes; the right-hand normal points from minus to plus.
    pub elements: Elements,
    /// Index into [`Mesh::fractures`].
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

/// A checked, fractured mesh; see the crate documentation for what it promises.
#[derive(Debug, Clone)]
pub struct Mesh {
    /// Where it came from, for messages.
    pub source: String,
    /// Coordinates of the nodes (m).
    pub nodes: Vec<DVec3>,
    /// Numbers of the nodes in the file.
    pub node_tags: Vec<u64>,
    /// Shapes and nodes of the cells.
    pub cells: Elements,
    /// Numbers of the cells in the file.
    pub cell_tags: Vec<u64>,
    /// Index into `group_sets` for each cell.
    pub cell_group_set: Vec<u32>,
    /// The distinct sets of groups that elements belong to.
    pub group_sets: Vec<Vec<usize>>,
    /// All physical groups.
    pub groups: Vec<Group>,
    /// Names of the fractures.
    pub fractures: Vec<String>,
    /// How many facets a fracture (first) left to another (second) whose group holds them too.
    pub shared_facets: Vec<(u32, u32, usize)>,
    /// Their facets.
    pub facets: Facets,
    /// The named parts of the outer surface.
    pub boundaries: Vec<Boundary>,
    /// Sectors of all nodes.
    pub sectors: Sectors,
    /// The block of each cell: blocks hang together without crossing a fracture.
    pub block: Vec<u32>,
    /// Number of blocks.
    pub block_count: usize,
    /// Whether cells at crack fronts are quarter-point elements, see [`Mesh::move_to_quarter_points`].
    pub has_quarter_points: bool,
}

impl Mesh {
    /// Checks `draft` and builds the mesh; `roles` has one entry for each group of the draft, of
    /// which only those of surfaces count.
    ///
    /// # Errors
    /// Every defect found: cells without volume or inside out, faces that do not fit together,
    /// fractures that are not embedded, lie on the outer boundary, hold a facet twice or have only
    /// one side.
    pub fn build(draft: Draft, roles: &[SurfaceRole]) -> Result<Self, Vec<Defect>> {
        let faces = Faces::of(&draft);
        Self::build_on(draft, faces, roles)
    }

    /// Like [`Mesh::build`], on the faces of this very draft.
    ///
    /// # Errors
    /// As [`Mesh::build`].
    pub fn build_on(
        mut draft: Draft,
        Faces { mut adjacency }: Faces,
        roles: &[SurfaceRole],
    ) -> Result<Self, Vec<Defect>> {
        let nodes = std::mem::take(&mut draft.nodes).into_iter();
        let nodes: Vec<DVec3> = nodes.map(DVec3::from).collect();
        let overlapping = check::faces(&draft, &adjacency);
        if !overlapping.is_empty() {
            // There nothing can be said of the surfaces; defects of the cells may be the cause.
            let broken = check::cells(&draft, &nodes);
            return Err(if broken.is_empty() {
                overlapping
            } else {
                broken
            });
        }
        let (surfaces, mut defects) = check::surfaces(&draft, roles, &adjacency);
        for facet in &surfaces.facets {
            adjacency.part(facet.faces);
        }
        // The fractures are mostly one thread's work, which leaves the others to the cells.
        let ((facets, boundaries, one_sided), (broken, (block, block_count), sectors)) =
            rayon::join(
                || collect(&draft, &nodes, &adjacency, &surfaces),
                || divide(&draft, &nodes, &adjacency, &surfaces),
            );
        if !broken.is_empty() {
            return Err(broken);
        }
        defects.extend(one_sided);
        if !defects.is_empty() {
            return Err(defects);
        }
        let shared = surfaces.shared.iter();
        let shared_facets = shared.map(|(&(left, kept), &count)| (left, kept, count));
        let shared_facets = shared_facets.collect();
        let fractures = surfaces.fractures.iter();
        Ok(Self {
            fractures: fractures.map(|&g| draft.groups[g].name.clone()).collect(),
            nodes,
            shared_facets,
            facets,
            boundaries,
            sectors,
            block,
            block_count,
            has_quarter_points: false,
            source: draft.source,
            node_tags: draft.node_tags,
            cells: draft.cells.elements,
            cell_tags: draft.cells.tags,
            cell_group_set: draft.cells.group_set,
            group_sets: draft.group_sets,
            groups: draft.groups,
        })
    }

    /// Coordinates of the corners of an element of this mesh (m).
    pub fn corners(&self, elements: &Elements, index: usize) -> Vec<DVec3> {
        crate::geometry::corners(elements, index, &self.nodes)
    }

    /// Area vectors of all fracture facets (m^2), from minus to plus.
    pub fn facet_areas(&self) -> Vec<DVec3> {
        (0..self.facets.elements.len())
            .map(|facet| crate::facet_area_vector(&self.corners(&self.facets.elements, facet)))
            .collect()
    }

    /// Lowest and highest coordinates of the nodes that are in cells (m).
    pub fn bounds(&self) -> (DVec3, DVec3) {
        let used = self
            .cells
            .nodes
            .iter()
            .map(|&node| self.nodes[node as usize]);
        used.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), x| {
            (low.min(x), high.max(x))
        })
    }
}

/// The facets of fractures and boundaries, and defects of the fractures.
fn collect(
    draft: &Draft,
    nodes: &[DVec3],
    adjacency: &Adjacency,
    surfaces: &Surfaces,
) -> (Facets, Vec<Boundary>, Vec<Defect>) {
    let (faces, found) = orient::fractures(draft, nodes, adjacency, surfaces);
    let facets = collect_facets(&draft.cells.elements, adjacency, surfaces, &faces);
    (
        facets,
        collect_boundaries(draft, adjacency, surfaces),
        found,
    )
}

/// Defects of the cells, their blocks, the sectors of the nodes.
fn divide(
    draft: &Draft,
    nodes: &[DVec3],
    adjacency: &Adjacency,
    surfaces: &Surfaces,
) -> (Vec<Defect>, (Vec<u32>, usize), Sectors) {
    let cells = &draft.cells.elements;
    let broken = check::cells(draft, nodes);
    let fractured = surfaces.facets.iter().flat_map(|facet| facet.faces);
    let (blocks, sectors) = rayon::join(
        || blocks::find(cells, adjacency),
        || sectors::find(cells, nodes.len(), adjacency, fractured),
    );
    (broken, blocks, sectors)
}

/// Appends the cell face `face` to `elements` and its slots to `slots`.
fn push_face(
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
