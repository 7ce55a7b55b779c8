//! Who touches whom: the two cells at a face, the faces at a facet.

use std::sync::atomic::{AtomicU32, Ordering};

use rayon::prelude::*;

use crate::draft::{Draft, Elements};
use crate::pairing::{KeyedFace, bounds, visit_runs};
use crate::shape::{Face, Shape, TETRAHEDRON};

/// Marks the absence of a neighbour.
pub(crate) const NONE: u32 = u32::MAX;

/// The faces of all cells and how they pair up. The faces of a cell have consecutive numbers, as
/// many a cell as the shape with the most faces needs, or a few more: cell and place in the cell
/// are the upper and lower bits of a number.
#[derive(Debug, Clone)]
pub(crate) struct Adjacency {
    /// Lower bits of a face's number.
    local_bits: u32,
    /// For each cell face the cell face on its other side, or [`NONE`].
    pub(crate) neighbour: Vec<u32>,
    /// Faces that three or more cells share, one entry a surplus cell.
    pub(crate) crowded_cells: Vec<u32>,
    /// Cells that lie on the same side of a face as their neighbour there, ascending.
    pub(crate) overlapping_cells: Vec<u32>,
    /// Where the facets of the draft lie.
    pub(crate) facets: Vec<FacetPlace>,
}

/// Where a facet of the draft lies.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FacetPlace {
    /// The cell faces (none, one or two) that have exactly its corners, ascending, [`NONE`] behind.
    pub(crate) faces: [u32; 2],
    /// The first facet with these corners; mostly this one.
    pub(crate) first: u32,
}

impl Adjacency {
    /// Pairs the faces of the cells, and the facets with them.
    pub(crate) fn of(draft: &Draft) -> Self {
        let cells = &draft.cells.elements;
        let shapes = [cells, &draft.facets.elements].map(Elements::distinct_shapes);
        let tetrahedra = |shape: &Shape| shape.faces().len() <= 4;
        let local_bits = if shapes[0].iter().all(tetrahedra) {
            2
        } else {
            3
        };
        let face_end = cells.len() << local_bits;
        assert!(
            face_end + draft.facets.elements.len() < NONE as usize,
            "fewer than 2^32 faces"
        );
        let unpaired = (0..face_end).into_par_iter().map(|_| AtomicU32::new(NONE));
        Pairing {
            cells,
            facets: &draft.facets.elements,
            local_bits,
            face_end: face_end as u32,
            node_count: draft.nodes.len(),
            triangles_only: shapes
                .iter()
                .flatten()
                .all(|shape| has_triangles_only(*shape)),
            neighbour: unpaired.collect(),
        }
        .run()
    }

    /// The cell of a face.
    pub(crate) fn cell_of(&self, face: u32) -> u32 {
        face >> self.local_bits
    }

    /// Numbers of the faces of a cell.
    pub(crate) fn faces_of(&self, cells: &Elements, cell: usize) -> std::ops::Range<u32> {
        let first = (cell << self.local_bits) as u32;
        first..first + cells.shapes[cell].faces().len() as u32
    }

    /// Faces without a cell on their other side, ascending.
    pub(crate) fn outer_faces(&self, cells: &Elements) -> Vec<u32> {
        let all = (0..cells.len()).into_par_iter();
        let outer = all.flat_map_iter(|cell| {
            let faces = self.faces_of(cells, cell);
            faces.filter(|&face| self.neighbour[face as usize] == NONE)
        });
        outer.collect()
    }

    /// Faces of lower cells that lie at the faces of this one.
    pub(crate) fn lower_neighbours(
        &self,
        cells: &Elements,
        cell: usize,
    ) -> impl Iterator<Item = u32> {
        let faces = self.faces_of(cells, cell);
        let others = &self.neighbour[faces.start as usize..faces.end as usize];
        others
            .iter()
            .copied()
            .filter(move |&other| other < faces.start)
    }

    /// Positions of a face's nodes in the flat node list of the cells, in outward order.
    pub(crate) fn slots<'a>(
        &self,
        cells: &'a Elements,
        face: u32,
    ) -> impl Iterator<Item = usize> + use<'a> {
        let start = cells.offsets[self.cell_of(face) as usize] as usize;
        let nodes = self.shape_of(cells, face).nodes;
        nodes.iter().map(move |&local| start + local as usize)
    }

    /// The face's place in its cell's table of faces.
    pub(crate) fn shape_of(&self, cells: &Elements, face: u32) -> &'static Face {
        shape_of(cells, face, self.local_bits)
    }

    /// Cuts the cells at two faces off from each other.
    pub(crate) fn part(&mut self, faces: [u32; 2]) {
        for face in faces {
            self.neighbour[face as usize] = NONE;
        }
    }
}

fn shape_of(cells: &Elements, face: u32, local_bits: u32) -> &'static Face {
    let local = face & ((1 << local_bits) - 1);
    &cells.shapes[(face >> local_bits) as usize].faces()[local as usize]
}

/// The search for faces and facets with the same corners. Facets are numbered behind the faces.
struct Pairing<'a> {
    cells: &'a Elements,
    facets: &'a Elements,
    local_bits: u32,
    face_end: u32,
    node_count: usize,
    /// Whether no face or facet is a quadrangle.
    triangles_only: bool,
    /// Written once a face, by the only task that sees it.
    neighbour: Vec<AtomicU32>,
}

/// What one task has found.
#[derive(Default)]
struct FoundFaces {
    /// Surplus faces with their corners, by which their order is that of the nodes.
    crowded: Vec<([u32; 4], u32)>,
    /// The lower of two faces that run the same way round.
    overlapping: Vec<u32>,
    facets: Vec<(u32, FacetPlace)>,
}

impl Pairing<'_> {
    fn run(self) -> Adjacency {
        let count = self.cells.len() + self.facets.len();
        let found = if self.triangles_only {
            visit_runs(
                count,
                self.node_count,
                |i| self.key_range(i),
                |i, out| self.emit(i, out),
                |found, run| self.settle(found, run),
            )
        } else {
            visit_runs(
                count,
                self.node_count,
                |i| self.key_range(i),
                |i, out| self.emit(i, out),
                |found, run| self.split(found, run),
            )
        };
        let lonely = |facet: u32| FacetPlace {
            faces: [NONE; 2],
            first: facet,
        };
        let mut facets: Vec<_> = (0..self.facets.len() as u32).map(lonely).collect();
        let (mut crowded, mut overlapping) = (Vec::new(), Vec::new());
        for mut found in found {
            crowded.append(&mut found.crowded);
            overlapping.append(&mut found.overlapping);
            for (facet, place) in found.facets {
                facets[facet as usize] = place;
            }
        }
        crowded.sort_unstable();
        overlapping.sort_unstable();
        let cell = |face: u32| face >> self.local_bits;
        Adjacency {
            local_bits: self.local_bits,
            crowded_cells: crowded.iter().map(|&(_, face)| cell(face)).collect(),
            overlapping_cells: overlapping.into_iter().map(cell).collect(),
            facets,
            neighbour: self
                .neighbour
                .into_iter()
                .map(AtomicU32::into_inner)
                .collect(),
        }
    }

    /// Appends the faces of a cell, or a facet where the cells are at their end.
    fn emit(&self, element: usize, entries: &mut Vec<KeyedFace>) {
        let Some(facet) = element.checked_sub(self.cells.len()) else {
            let nodes = self.cells.nodes_of(element);
            let first = (element << self.local_bits) as u32;
            let shape = self.cells.shapes[element];
            if let (Shape::Tet4 | Shape::Tet10, Some(corners)) = (shape, nodes.first_chunk()) {
                entries.extend_from_slice(&tetrahedron(*corners, first));
                return;
            }
            let faces = shape.faces();
            entries.extend((first..).zip(faces).map(|(item, face)| {
                let corners = face.corners();
                let key = match *corners {
                    [a, b, c] => turned([a, b, c].map(|local| nodes[local as usize])),
                    _ => lowest(corners.iter().map(|&local| nodes[local as usize])),
                };
                KeyedFace { key, item }
            }));
            return;
        };
        let corners = &self.facets.nodes_of(facet)[..self.facets.shapes[facet].corner_count()];
        let key = match *corners {
            [a, b, c] => turned([a, b, c]),
            _ => lowest(corners.iter().copied()),
        };
        entries.push(KeyedFace {
            key,
            item: self.face_end + facet as u32,
        });
    }

    /// The lowest corner that is the lowest of a face, and one that is not below the others.
    fn key_range(&self, element: usize) -> (u32, u32) {
        let Some(facet) = element.checked_sub(self.cells.len()) else {
            let nodes = self.cells.nodes_of(element);
            let shape = self.cells.shapes[element];
            if let (Shape::Tet4 | Shape::Tet10, Some(corners)) = (shape, nodes.first_chunk()) {
                return lowest_two(*corners);
            }
            return bounds(&nodes[..shape.corner_count()]);
        };
        bounds(&self.facets.nodes_of(facet)[..self.facets.shapes[facet].corner_count()])
    }

    /// Tells triangles from quadrangles, and these by their fourth corner.
    fn split(&self, found: &mut FoundFaces, run: &[KeyedFace]) {
        let mut run: Vec<(u32, KeyedFace)> = run
            .iter()
            .map(|entry| (self.fourth(entry.item), *entry))
            .collect();
        run.sort_by_key(|(fourth, _)| *fourth);
        for alike in run.chunk_by(|a, b| a.0 == b.0) {
            let alike: Vec<KeyedFace> = alike.iter().map(|(_, entry)| *entry).collect();
            self.settle(found, &alike);
        }
    }

    /// The highest corner of a quadrangle; [`NONE`] for a triangle.
    fn fourth(&self, item: u32) -> u32 {
        self.corners(item)
            .nth(3)
            .map_or(NONE, |last| self.corners(item).fold(last, u32::max))
    }

    /// Corner nodes of a face or a facet, in order.
    fn corners(&self, item: u32) -> impl Iterator<Item = u32> {
        let (elements, element, locals) = match item.checked_sub(self.face_end) {
            None => {
                let face = shape_of(self.cells, item, self.local_bits);
                (self.cells, item >> self.local_bits, face.corners())
            }
            Some(facet) => {
                let count = self.facets.shapes[facet as usize].corner_count();
                (self.facets, facet, &[0, 1, 2, 3][..count])
            }
        };
        let nodes = elements.nodes_of(element as usize);
        locals.iter().map(|&local| nodes[local as usize])
    }

    /// Notes what entries with the same corners have to do with each other.
    fn settle(&self, found: &mut FoundFaces, run: &[KeyedFace]) {
        let (faces, facets) = run.split_at(run.partition_point(|e| e.item < self.face_end));
        if let [first, second, surplus @ ..] = faces {
            self.neighbour[first.item as usize].store(second.item, Ordering::Relaxed);
            self.neighbour[second.item as usize].store(first.item, Ordering::Relaxed);
            if self.runs_alike(first, second) {
                found.overlapping.push(first.item);
            }
            let keyed = |entry: &KeyedFace| {
                let [a, b, c] = entry.sorted_key();
                ([a, b, c, self.fourth(entry.item)], entry.item)
            };
            found.crowded.extend(surplus.iter().map(keyed));
        }
        if let Some(first) = facets.first() {
            let face = |place: usize| faces.get(place).map_or(NONE, |face| face.item);
            let place = FacetPlace {
                faces: [face(0), face(1)],
                first: first.item - self.face_end,
            };
            let placed = |facet: &KeyedFace| (facet.item - self.face_end, place);
            found.facets.extend(facets.iter().map(placed));
        }
    }

    /// Whether two faces with the same corners run the same way round, so that both cells lie on
    /// one side.
    fn runs_alike(&self, face: &KeyedFace, other: &KeyedFace) -> bool {
        let [a, b, c] = face.key;
        let is_triangle = || {
            shape_of(self.cells, face.item, self.local_bits)
                .corners()
                .len()
                == 3
        };
        if (self.triangles_only || is_triangle()) && a != b && b != c && a != c {
            return b == other.key[1];
        }
        let mut own = self.corners(face.item);
        let (Some(first), Some(second)) = (own.next(), own.next()) else {
            return false;
        };
        let twin = || self.corners(other.item);
        let after = twin().skip_while(|&node| node != first).nth(1);
        after.or_else(|| twin().next()) == Some(second)
    }
}

/// The lowest corner of a tetrahedron, and the lowest of the face across.
fn lowest_two([a, b, c, d]: [u32; 4]) -> (u32, u32) {
    let (low, high) = (a.min(b), a.max(b));
    let (other_low, other_high) = (c.min(d), c.max(d));
    let second = low.max(other_low).min(high).min(other_high);
    (low.min(other_low), second)
}

/// The faces of a tetrahedron, numbered from `first` on.
fn tetrahedron(nodes: [u32; 4], first: u32) -> [KeyedFace; 4] {
    let mut faces = [KeyedFace::default(); 4];
    for ((face, item), [a, b, c]) in faces.iter_mut().zip(first..).zip(TETRAHEDRON) {
        let key = turned([nodes[a], nodes[b], nodes[c]]);
        *face = KeyedFace { key, item };
    }
    faces
}

fn has_triangles_only(shape: Shape) -> bool {
    if shape.dimension() == 2 {
        return shape.corner_count() == 3;
    }
    shape.faces().iter().all(|face| face.corners().len() == 3)
}

/// The corners of a triangle from the lowest on; the order of the others tells which way round.
fn turned([a, b, c]: [u32; 3]) -> [u32; 3] {
    if a <= b && a <= c {
        [a, b, c]
    } else if b <= c {
        [b, c, a]
    } else {
        [c, a, b]
    }
}

/// The three lowest corners of a quadrangle, ascending.
fn lowest(nodes: impl Iterator<Item = u32>) -> [u32; 3] {
    let mut corners = [NONE; 4];
    for (corner, node) in corners.iter_mut().zip(nodes) {
        *corner = node;
    }
    corners.sort_unstable();
    [corners[0], corners[1], corners[2]]
}
