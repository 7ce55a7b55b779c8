//! Who couples with whom: cells around a node, nodes around a node, blocks of the matrix.

use lie_mesh::Mesh;
use rayon::prelude::*;

use crate::points::Points;

/// Lists of variable length in one array.
#[derive(Debug, Clone, Default)]
pub struct Lists {
    /// Start of each list; one entry more than there are lists.
    pub offset: Vec<usize>,
    /// All entries.
    pub entries: Vec<u32>,
}

impl Lists {
    /// List `index`.
    pub fn of(&self, index: usize) -> &[u32] {
        &self.entries[self.offset[index]..self.offset[index + 1]]
    }

    /// Puts lists one behind the other.
    pub fn collect(lists: &[Vec<u32>]) -> Self {
        let mut offset = vec![0];
        for list in lists {
            offset.push(offset[offset.len() - 1] + list.len());
        }
        Self {
            offset,
            entries: lists.concat(),
        }
    }

    /// Groups `0..keys.len()` by key, each group ascending.
    pub fn group(keys: impl Iterator<Item = u32> + Clone, key_count: usize) -> Self {
        let mut offset = vec![0_usize; key_count + 1];
        for key in keys.clone() {
            offset[key as usize + 1] += 1;
        }
        for key in 0..key_count {
            offset[key + 1] += offset[key];
        }
        let mut next = offset.clone();
        let mut entries = vec![0; offset[key_count]];
        for (item, key) in keys.enumerate() {
            entries[next[key as usize]] = item as u32;
            next[key as usize] += 1;
        }
        Self { offset, entries }
    }
}

/// The pattern of the block matrix, symmetric and stored whole. It is fixed for a run.
#[derive(Debug, Clone)]
pub struct Pattern {
    /// For each node the slots (positions in the cells' flat node list) where it occurs, ascending.
    pub slots: Lists,
    /// Cell of each slot.
    pub cell_of_slot: Vec<u32>,
    /// For each node the nodes it shares a cell with, itself included, ascending.
    pub neighbours: Lists,
    /// Start of each block row; one entry more than there are points.
    pub row_offset: Vec<usize>,
    /// Column of each block, ascending in each row.
    pub columns: Vec<u32>,
}

impl Pattern {
    /// Pattern of a mesh.
    pub fn of(mesh: &Mesh, points: &Points) -> Self {
        let cells = &mesh.cells;
        let cell_of_slot: Vec<u32> = (0..cells.len())
            .flat_map(|cell| std::iter::repeat_n(cell as u32, cells.range(cell).len()))
            .collect();
        let slots = Lists::group(cells.nodes.iter().copied(), mesh.nodes.len());
        let around: Vec<Vec<u32>> = (0..mesh.nodes.len())
            .into_par_iter()
            .map(|node| {
                let cells_here = slots
                    .of(node)
                    .iter()
                    .map(|&slot| cell_of_slot[slot as usize]);
                let mut nodes: Vec<u32> = cells_here
                    .flat_map(|cell| cells.nodes_of(cell as usize).iter().copied())
                    .collect();
                nodes.sort_unstable();
                nodes.dedup();
                nodes
            })
            .collect();
        let neighbours = Lists::collect(&around);
        let (row_offset, columns) = block_rows(&neighbours, points);
        Self {
            slots,
            cell_of_slot,
            neighbours,
            row_offset,
            columns,
        }
    }

    /// Range of the blocks of a row.
    pub fn row(&self, row: usize) -> std::ops::Range<usize> {
        self.row_offset[row]..self.row_offset[row + 1]
    }

    /// Address of the block at `row`, `column`.
    ///
    /// # Panics
    /// If the pattern has no such block.
    pub fn address(&self, row: usize, column: usize) -> usize {
        let range = self.row(row);
        let found = self.columns[range.clone()].binary_search(&(column as u32));
        range.start + found.expect("coupled points share a cell")
    }
}

fn block_rows(neighbours: &Lists, points: &Points) -> (Vec<usize>, Vec<u32>) {
    let mut row_offset = vec![0];
    let mut columns = Vec::new();
    for node in 0..neighbours.offset.len() - 1 {
        for _ in points.of_node(node) {
            for &other in neighbours.of(node) {
                columns.extend(points.of_node(other as usize).map(|block| block as u32));
            }
            row_offset.push(columns.len());
        }
    }
    (row_offset, columns)
}
