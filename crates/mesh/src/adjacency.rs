//! Who touches whom: the two cells at a face, the faces at a facet.

use crate::draft::Elements;
use crate::shape::Face;

/// Marks the absence of a neighbour.
pub(crate) const NONE: u32 = u32::MAX;

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
    bucket_offset: Vec<u32>,
    bucket: Vec<(Key, u32)>,
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
        let (face_offset, cell_of_face, keys) = list_faces(cells);
        let (bucket_offset, bucket) = bucket_by_lowest_node(&keys, node_count);
        let mut adjacency = Self {
            face_offset,
            neighbour: vec![NONE; keys.len()],
            cell_of_face,
            crowded_cells: Vec::new(),
            bucket_offset,
            bucket,
        };
        adjacency.pair();
        adjacency
    }

    fn pair(&mut self) {
        for run in self.bucket.chunk_by(|a, b| a.0 == b.0) {
            if let [(_, first), (_, second), surplus @ ..] = run {
                self.neighbour[*first as usize] = *second;
                self.neighbour[*second as usize] = *first;
                let crowded = surplus
                    .iter()
                    .map(|&(_, face)| self.cell_of_face[face as usize]);
                self.crowded_cells.extend(crowded);
            }
        }
    }

    /// The cell faces (none, one or two) that have exactly the corners of a facet.
    pub(crate) fn faces_at(&self, corners: &[u32]) -> impl Iterator<Item = u32> + '_ {
        let wanted = key(corners.iter().copied());
        let lowest = wanted[0] as usize;
        let range = self.bucket_offset[lowest] as usize..self.bucket_offset[lowest + 1] as usize;
        self.bucket[range]
            .iter()
            .filter(move |(candidate, _)| *candidate == wanted)
            .map(|&(_, face)| face)
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

fn list_faces(cells: &Elements) -> (Vec<u32>, Vec<u32>, Vec<Key>) {
    let count: usize = cells.shapes.iter().map(|shape| shape.faces().len()).sum();
    let mut face_offset = Vec::with_capacity(cells.len() + 1);
    let mut cell_of_face = Vec::with_capacity(count);
    let mut keys = Vec::with_capacity(count);
    for (cell, shape) in cells.shapes.iter().enumerate() {
        face_offset.push(keys.len() as u32);
        let nodes = cells.nodes_of(cell);
        for face in shape.faces() {
            let corners = face.corners().iter();
            keys.push(key(corners.map(|&local| nodes[local as usize])));
            cell_of_face.push(cell as u32);
        }
    }
    face_offset.push(keys.len() as u32);
    (face_offset, cell_of_face, keys)
}

fn bucket_by_lowest_node(keys: &[Key], node_count: usize) -> (Vec<u32>, Vec<(Key, u32)>) {
    let mut offset = vec![0_u32; node_count + 1];
    for key in keys {
        offset[key[0] as usize + 1] += 1;
    }
    for node in 0..node_count {
        offset[node + 1] += offset[node];
    }
    let mut next = offset.clone();
    let mut bucket = vec![([NONE; 4], NONE); keys.len()];
    for (face, key) in keys.iter().enumerate() {
        let slot = &mut next[key[0] as usize];
        bucket[*slot as usize] = (*key, face as u32);
        *slot += 1;
    }
    for range in offset.windows(2) {
        bucket[range[0] as usize..range[1] as usize].sort_unstable();
    }
    (offset, bucket)
}
