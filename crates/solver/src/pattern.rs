//! Who couples with whom: cells around a node, nodes around a node, blocks of the matrix.

use std::ops::Range;

use kluft_mesh::{Elements, Mesh};
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

    /// Groups the positions in `keys` by key, each group ascending, in parallel.
    ///
    /// Every task owns a range of keys and passes over all of them twice: to count and to fill.
    fn occurrences(keys: &[u32], key_count: usize) -> Self {
        let length = key_count.div_ceil(rayon::current_num_threads()).max(1);
        let mut offset = vec![0_usize; key_count + 1];
        offset[1..]
            .par_chunks_mut(length)
            .enumerate()
            .for_each(|(task, counts)| {
                let first = task * length;
                for &key in keys {
                    if let Some(count) = counts.get_mut((key as usize).wrapping_sub(first)) {
                        *count += 1;
                    }
                }
            });
        sum_up(&mut offset);
        let mut entries = vec![0; keys.len()];
        let shares = split(&mut entries, &offset, length);
        shares.into_par_iter().for_each(|(owned, share)| {
            let start = offset[owned.start];
            let mut next: Vec<usize> = offset[owned.clone()].iter().map(|at| at - start).collect();
            for (item, &key) in keys.iter().enumerate() {
                if let Some(next) = next.get_mut((key as usize).wrapping_sub(owned.start)) {
                    share[*next] = item as u32;
                    *next += 1;
                }
            }
        });
        Self { offset, entries }
    }

    /// Puts the lists of consecutive tasks, lengths and entries, one behind the other.
    fn join(tasks: &[(Vec<u32>, Vec<u32>)]) -> Self {
        let lengths = tasks.iter().flat_map(|(lengths, _)| lengths);
        let mut offset = vec![0];
        offset.extend(lengths.map(|&length| length as usize));
        sum_up(&mut offset);
        let mut entries = vec![0; offset[offset.len() - 1]];
        let mut rest = entries.as_mut_slice();
        let mut shares = Vec::new();
        for (_, own) in tasks {
            let (share, tail) = rest.split_at_mut(own.len());
            shares.push((share, own));
            rest = tail;
        }
        let copies = shares.into_par_iter();
        copies.for_each(|(share, own)| share.copy_from_slice(own));
        Self { offset, entries }
    }
}

/// From lengths, behind a zero, to offsets.
fn sum_up(lengths: &mut [usize]) {
    let mut sum = 0;
    for length in lengths {
        sum += *length;
        *length = sum;
    }
}

/// Cuts the entries of lists into the shares of `length` consecutive lists.
pub(crate) fn split<'a, T>(
    entries: &'a mut [T],
    offset: &[usize],
    length: usize,
) -> Vec<(Range<usize>, &'a mut [T])> {
    let count = offset.len() - 1;
    let mut rest = entries;
    let mut shares = Vec::new();
    for start in (0..count).step_by(length) {
        let end = (start + length).min(count);
        let (share, tail) = rest.split_at_mut(offset[end] - offset[start]);
        shares.push((start..end, share));
        rest = tail;
    }
    shares
}

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

/// The pattern of the block matrix, symmetric and stored whole. It is fixed for a run.
#[derive(Debug, Clone)]
pub struct Pattern {
    /// For each node the slots (positions in the cells' flat node list) where it occurs, ascending.
    pub slots: Lists,
    /// Cell of each slot.
    pub cell_of_slot: CellOfSlot,
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
        let slots = Lists::occurrences(&mesh.cells.nodes, mesh.nodes.len());
        let cell_of_slot = CellOfSlot::of(&mesh.cells);
        let neighbours = neighbours(&mesh.cells, &slots, &cell_of_slot);
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

/// For each node the nodes it shares a cell with.
fn neighbours(cells: &Elements, slots: &Lists, cell_of_slot: &CellOfSlot) -> Lists {
    let node_count = slots.offset.len() - 1;
    let tasks: Vec<usize> = (0..node_count).step_by(NODES_PER_TASK).collect();
    let around = tasks.into_par_iter().map_init(
        || (Near::default(), vec![u32::MAX; node_count]),
        |(near, last_seen), start| {
            let nodes = start..(start + NODES_PER_TASK).min(node_count);
            near.gather(nodes.clone(), cells, slots, cell_of_slot);
            near.distinct(nodes, slots, last_seen)
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
    fn gather(&mut self, nodes: Range<usize>, cells: &Elements, slots: &Lists, of: &CellOfSlot) {
        self.nodes.clear();
        self.ends.clear();
        for &slot in &slots.entries[slots.offset[nodes.start]..slots.offset[nodes.end]] {
            let (_, own) = of.locate(slot, cells);
            self.nodes.extend_from_slice(&cells.nodes[own]);
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

/// Start of each block row, and the columns.
fn block_rows(neighbours: &Lists, points: &Points) -> (Vec<usize>, Vec<u32>) {
    let node_count = neighbours.offset.len() - 1;
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
    let shares = split(&mut columns, &row_offset, NODES_PER_TASK);
    shares.into_par_iter().for_each(|(rows, share)| {
        let nodes = points.node[rows].iter();
        let all = nodes.flat_map(|&node| neighbours.of(node as usize).iter().flat_map(unknowns));
        for (column, unknown) in share.iter_mut().zip(all) {
            *column = unknown as u32;
        }
    });
    (row_offset, columns)
}
