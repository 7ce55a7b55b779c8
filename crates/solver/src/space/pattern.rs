//! Who couples with whom: cells around a node, nodes around a node, blocks of the matrix.

use std::borrow::Cow;
use std::ops::Range;

use kluft_algebra::{BlockPattern, Lists, RowOwnership, sum_up};
use kluft_mesh::{Elements, Mesh};
use rayon::prelude::*;

use crate::space::sector_nodes::SectorNodes;

/// Nodes of one task.
const NODES_PER_TASK: usize = 1024;

/// The cell of each slot.
#[derive(Debug, Clone)]
pub enum CellOfSlot {
    /// All cells have this many nodes.
    Uniform(u32),
    /// Cells of several shapes: one entry a slot.
    Mixed(Vec<u32>),
}

impl CellOfSlot {
    fn of(cells: &Elements) -> Self {
        let count = |cell: usize| cells.offsets[cell + 1] - cells.offsets[cell];
        let first = if cells.is_empty() { 1 } else { count(0) };
        if (0..cells.len())
            .into_par_iter()
            .all(|cell| count(cell) == first)
        {
            return Self::Uniform(first);
        }
        let slots = |cell: usize| std::iter::repeat_n(cell as u32, cells.range(cell).len());
        Self::Mixed((0..cells.len()).flat_map(slots).collect())
    }

    /// Cell of one slot, and all slots of this cell.
    pub fn locate(&self, slot: u32, cells: &Elements) -> (usize, Range<usize>) {
        match self {
            // Tetrahedra: a shift instead of a division, the dearest part of this.
            Self::Uniform(4) => {
                let (cell, start) = (slot / 4, slot - slot % 4);
                (cell as usize, start as usize..(start + 4) as usize)
            }
            Self::Uniform(count) => {
                let (cell, start) = (slot / count, slot - slot % count);
                (cell as usize, start as usize..(start + count) as usize)
            }
            Self::Mixed(cell) => {
                let cell = cell[slot as usize] as usize;
                (cell, cells.range(cell))
            }
        }
    }
}

/// The pattern of the block matrix, which is symmetric. It is fixed for a run.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Pattern {
    /// See [`Self::slots`]; without lists once only the stored blocks are kept.
    slots: Lists,
    /// Cell of each slot.
    pub cell_of_slot: CellOfSlot,
    /// The blocks of the matrix, a row for each point.
    pub blocks: BlockPattern,
}

impl Pattern {
    /// Pattern of a mesh.
    pub fn of(mesh: &Mesh, points: &SectorNodes) -> Self {
        let nodes = points.moving_nodes(mesh);
        let slots = Lists::occurrences(&nodes, mesh.nodes.len());
        let cell_of_slot = CellOfSlot::of(&mesh.cells);
        let neighbours = neighbours((&mesh.cells, &nodes), &slots, &cell_of_slot);
        let blocks = block_pattern(&neighbours, points);
        Self {
            slots,
            cell_of_slot,
            blocks,
        }
    }

    /// Keeps these blocks instead of all, and nothing of what only others would ask for.
    pub(crate) fn keep(&mut self, blocks: BlockPattern) {
        (self.blocks, self.slots) = (blocks, Lists::default());
    }

    /// For each node the nodes that it shares a cell with, as [`NodeOrder::of`] takes them.
    ///
    /// [`NodeOrder::of`]: kluft_algebra::NodeOrder::of
    pub fn node_graph(&self, points: &SectorNodes) -> Lists {
        let nodes = 0..points.offset.len() - 1;
        let around = nodes.map(|node| self.around(node, points).collect());
        Lists::collect(&around.collect::<Vec<_>>())
    }

    /// The nodes with unknowns that a node shares a cell with, itself included, ascending; none
    /// where it has no unknowns.
    pub(crate) fn around<'a>(
        &'a self,
        node: usize,
        points: &'a SectorNodes,
    ) -> impl Iterator<Item = u32> + 'a {
        let columns = points.of_node(node).next().map(|row| self.blocks.row(row));
        let columns = &self.blocks.columns[columns.unwrap_or_default()];
        let nodes = columns
            .iter()
            .map(|&column| (column, points.node[column as usize]));
        let firsts = nodes.filter(|&(column, node)| points.offset[node as usize] == column);
        firsts.map(|(_, node)| node)
    }

    /// For each node of a mesh with this pattern the slots (positions in the cells' flat node list)
    /// where it occurs, ascending.
    pub fn slots(&self, mesh: &Mesh, points: &SectorNodes) -> Cow<'_, Lists> {
        match self.slots.offset.is_empty() {
            false => Cow::Borrowed(&self.slots),
            true => {
                let nodes = points.moving_nodes(mesh);
                Cow::Owned(Lists::occurrences(&nodes, mesh.nodes.len()))
            }
        }
    }

    /// Those of a node, while all blocks are there.
    pub(crate) fn slots_of(&self, node: usize) -> &[u32] {
        self.slots.of(node)
    }
}

/// For each node the nodes it shares a cell with; `nodes` are those of the cells.
fn neighbours(
    (cells, nodes): (&Elements, &[u32]),
    slots: &Lists,
    cell_of_slot: &CellOfSlot,
) -> Lists {
    let node_count = slots.count();
    let tasks: Vec<usize> = (0..node_count).step_by(NODES_PER_TASK).collect();
    let around = tasks.into_par_iter().map_init(
        || (Near::default(), vec![u32::MAX; node_count]),
        |(near, last_seen), start| {
            let own = start..(start + NODES_PER_TASK).min(node_count);
            near.gather(own.clone(), (cells, nodes), slots, cell_of_slot);
            near.distinct(own, slots, last_seen)
        },
    );
    Lists::join(&around.collect::<Vec<_>>())
}

/// The nodes of all cells around the nodes of one task, with repetitions.
#[derive(Default)]
struct Near {
    nodes: Vec<u32>,
    /// End of each slot's cell in `nodes`.
    ends: Vec<u32>,
}

impl Near {
    /// Apart from [`Near::distinct`], because the cells lie anywhere in memory: here nothing waits
    /// for them.
    fn gather(
        &mut self,
        own: Range<usize>,
        (cells, nodes): (&Elements, &[u32]),
        slots: &Lists,
        of: &CellOfSlot,
    ) {
        self.nodes.clear();
        self.ends.clear();
        for &slot in &slots.entries[slots.offset[own.start]..slots.offset[own.end]] {
            let (_, own) = of.locate(slot, cells);
            self.nodes.extend_from_slice(&nodes[own]);
            self.ends.push(self.nodes.len() as u32);
        }
    }

    /// Number of distinct nodes around each node, and these nodes, ascending.
    fn distinct(
        &self,
        nodes: Range<usize>,
        slots: &Lists,
        last_seen: &mut [u32],
    ) -> (Vec<u32>, Vec<u32>) {
        let mut found = Vec::with_capacity(self.nodes.len() / 4);
        let mut lengths = Vec::with_capacity(nodes.len());
        let mut start = 0;
        let mut ends = self.ends.iter();
        for node in nodes {
            let first = found.len();
            let end = ends.by_ref().take(slots.of(node).len()).last();
            let end = end.map_or(start, |&end| end as usize);
            for &other in &self.nodes[start..end] {
                let seen = &mut last_seen[other as usize];
                if *seen != node as u32 {
                    *seen = node as u32;
                    found.push(other);
                }
            }
            found[first..].sort_unstable();
            lengths.push((found.len() - first) as u32);
            start = end;
        }
        (lengths, found)
    }
}

fn block_pattern(neighbours: &Lists, points: &SectorNodes) -> BlockPattern {
    let node_count = neighbours.count();
    let unknowns = |&other: &u32| points.of_node(other as usize);
    let lengths: Vec<usize> = (0..node_count)
        .into_par_iter()
        .map(|node| {
            neighbours
                .of(node)
                .iter()
                .map(|other| unknowns(other).len())
                .sum()
        })
        .collect();
    let mut row_offset = vec![0];
    row_offset.extend(points.node.iter().map(|&node| lengths[node as usize]));
    sum_up(&mut row_offset);
    let mut columns = vec![0; row_offset[points.len()]];
    let tasks = RowOwnership::even(points.len(), NODES_PER_TASK);
    let shares = tasks.split(&mut columns, &row_offset);
    shares.into_par_iter().for_each(|(rows, share)| {
        let nodes = points.node[rows].iter();
        let all = nodes.flat_map(|&node| neighbours.of(node as usize).iter().flat_map(unknowns));
        for (column, unknown) in share.iter_mut().zip(all) {
            *column = unknown as u32;
        }
    });
    BlockPattern::new(row_offset, columns).halved(0..points.len())
}
