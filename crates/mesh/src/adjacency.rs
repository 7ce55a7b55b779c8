//! Who touches whom: the two cells at a face, the faces at a facet.

use rayon::prelude::*;

use crate::draft::Elements;
use crate::shape::Face;

/// Marks the absence of a neighbour.
pub(crate) const NONE: u32 = u32::MAX;

/// Nodes whose faces one task pairs.
const NODES_PER_TASK: usize = 4096;

/// A face of a cell by its corner nodes, ascending; triangles end in [`NONE`].
pub(crate) type Key = [u32; 4];

/// The faces of all cells and how they pair up.
#[derive(Debug, Clone)]
pub(crate) struct Adjacency {
    /// Start of each cell's faces in `neighbour`; one entry more than there are cells.
    pub(crate) face_offset: Vec<u32>,
    /// For each cell face the cell face on its other side, or [`NONE`].
    pub(crate) neighbour: Vec<u32>,
    /// The cell of each cell face.
    pub(crate) cell_of_face: Vec<u32>,
    /// Faces that three or more cells share, one entry a surplus cell.
    pub(crate) crowded_cells: Vec<u32>,
    /// Start of the faces with each lowest node in `bucket`.
    bucket_offset: Vec<u32>,
    bucket: Vec<u32>,
}

/// Sorted corner nodes of an element's face or of a facet.
pub(crate) fn key(nodes: impl Iterator<Item = u32>) -> Key {
    let mut key = [NONE; 4];
    for (slot, node) in key.iter_mut().zip(nodes) {
        *slot = node;
    }
    key.sort_unstable();
    key
}

impl Adjacency {
    /// Pairs the faces of `cells` over `node_count` nodes, in time linear in the cells:
    /// faces are bucketed by their lowest node, and buckets are short.
    pub(crate) fn of(cells: &Elements, node_count: usize) -> Self {
        let (face_offset, cell_of_face) = number_faces(cells);
        let (bucket_offset, bucket) = bucket_by_lowest_node(cells, node_count);
        let mut adjacency = Self {
            neighbour: vec![NONE; cell_of_face.len()],
            face_offset,
            cell_of_face,
            crowded_cells: Vec::new(),
            bucket_offset,
            bucket,
        };
        adjacency.pair(cells, node_count);
        adjacency
    }

    fn pair(&mut self, cells: &Elements, node_count: usize) {
        let starts: Vec<usize> = (0..node_count).step_by(NODES_PER_TASK).collect();
        let found: Vec<Paired> = starts
            .into_par_iter()
            .map(|start| {
                let nodes = start..(start + NODES_PER_TASK).min(node_count);
                self.pairs_among(cells, nodes)
            })
            .collect();
        for paired in found {
            for (first, second) in paired.pairs {
                self.neighbour[first as usize] = second;
                self.neighbour[second as usize] = first;
            }
            self.crowded_cells.extend(paired.crowded_cells);
        }
    }

    /// Pairs among the faces whose lowest node is one of `nodes`.
    fn pairs_among(&self, cells: &Elements, nodes: std::ops::Range<usize>) -> Paired {
        let mut paired = Paired::default();
        let mut keys: Vec<(Key, u32)> = Vec::new();
        for node in nodes {
            keys.clear();
            keys.extend(
                self.bucket_of(node)
                    .iter()
                    .map(|&face| (self.key_of(cells, face), face)),
            );
            keys.sort_unstable();
            for run in keys.chunk_by(|a, b| a.0 == b.0) {
                if let [(_, first), (_, second), surplus @ ..] = run {
                    paired.pairs.push((*first, *second));
                    let cell = |&(_, face): &(Key, u32)| self.cell_of_face[face as usize];
                    paired.crowded_cells.extend(surplus.iter().map(cell));
                }
            }
        }
        paired
    }

    fn bucket_of(&self, node: usize) -> &[u32] {
        let range = self.bucket_offset[node] as usize..self.bucket_offset[node + 1] as usize;
        &self.bucket[range]
    }

    fn key_of(&self, cells: &Elements, face: u32) -> Key {
        let cell = self.cell_of_face[face as usize] as usize;
        let nodes = cells.nodes_of(cell);
        let corners = self.shape_of(cells, face).corners();
        key(corners.iter().map(|&local| nodes[local as usize]))
    }

    /// The cell faces (none, one or two) that have exactly the corners of a facet.
    pub(crate) fn faces_at(&self, cells: &Elements, corners: &[u32]) -> impl Iterator<Item = u32> {
        let wanted = key(corners.iter().copied());
        let bucket = self.bucket_of(wanted[0] as usize);
        bucket
            .iter()
            .copied()
            .filter(move |&face| self.key_of(cells, face) == wanted)
    }

    /// Number of faces of all cells, shared ones counted twice.
    pub(crate) fn face_count(&self) -> usize {
        self.neighbour.len()
    }

    /// Positions of a face's nodes in the flat node list of the cells, in outward order.
    pub(crate) fn slots<'a>(
        &self,
        cells: &'a Elements,
        face: u32,
    ) -> impl Iterator<Item = usize> + use<'a> {
        let cell = self.cell_of_face[face as usize] as usize;
        let start = cells.offsets[cell] as usize;
        let nodes = self.shape_of(cells, face).nodes;
        nodes.iter().map(move |&local| start + local as usize)
    }

    /// The face's place in its cell's table of faces.
    pub(crate) fn shape_of(&self, cells: &Elements, face: u32) -> &'static Face {
        let cell = self.cell_of_face[face as usize] as usize;
        &cells.shapes[cell].faces()[self.local_face(face)]
    }

    /// Number of `face` within its cell.
    fn local_face(&self, face: u32) -> usize {
        let cell = self.cell_of_face[face as usize] as usize;
        (face - self.face_offset[cell]) as usize
    }
}

/// What one task has found.
#[derive(Default)]
struct Paired {
    pairs: Vec<(u32, u32)>,
    crowded_cells: Vec<u32>,
}

/// Start of each cell's faces, and the cell of each face.
fn number_faces(cells: &Elements) -> (Vec<u32>, Vec<u32>) {
    let mut face_offset = Vec::with_capacity(cells.len() + 1);
    let mut cell_of_face = Vec::new();
    face_offset.push(0);
    for (cell, shape) in cells.shapes.iter().enumerate() {
        cell_of_face.extend(std::iter::repeat_n(cell as u32, shape.faces().len()));
        face_offset.push(cell_of_face.len() as u32);
    }
    (face_offset, cell_of_face)
}

fn bucket_by_lowest_node(cells: &Elements, node_count: usize) -> (Vec<u32>, Vec<u32>) {
    let lowest: Vec<u32> = (0..cells.len())
        .into_par_iter()
        .flat_map_iter(|cell| {
            let nodes = cells.nodes_of(cell);
            cells.shapes[cell].faces().iter().map(|face| {
                let corners = face.corners().iter().map(|&local| nodes[local as usize]);
                corners.min().unwrap_or(NONE)
            })
        })
        .collect();
    let mut offset = vec![0_u32; node_count + 1];
    for &node in &lowest {
        offset[node as usize + 1] += 1;
    }
    for node in 0..node_count {
        offset[node + 1] += offset[node];
    }
    let mut next = offset.clone();
    let mut bucket = vec![NONE; lowest.len()];
    for (face, &node) in lowest.iter().enumerate() {
        let slot = &mut next[node as usize];
        bucket[*slot as usize] = face as u32;
        *slot += 1;
    }
    (offset, bucket)
}
