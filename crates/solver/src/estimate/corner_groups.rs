//! Corners of cells that are of one rock and in one sector of a node, node by node.

use std::sync::atomic::{AtomicU32, Ordering};

use glam::DVec3;
use kluft_algebra::Lists;
use rayon::prelude::*;

use crate::problem::Problem;
use crate::system::Discretisation;

/// No group.
const NONE: u32 = u32::MAX;
/// Nodes of one task.
const NODES_PER_TASK: usize = 1024;

/// Groups of corners, one for each point that is a corner and each rock around it, in this order.
pub(super) struct CornerGroups {
    /// Group of each corner of the cells, by slot in their flat node list; beyond all numbers for
    /// other nodes.
    pub(super) of_slot: Vec<u32>,
    /// Cells of each group, ascending.
    pub(super) cells: Lists,
    /// Where their node is (m).
    pub(super) middles: Vec<DVec3>,
}

/// A corner of a cell.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Corner {
    /// Point and rock.
    key: (u32, u32),
    slot: u32,
    cell: u32,
}

impl CornerGroups {
    /// From the slots of each node.
    pub(super) fn of(problem: &Problem, discretisation: &Discretisation, slots: &Lists) -> Self {
        let (mesh, cells) = (&problem.mesh, &problem.mesh.cells);
        let of_tasks = sorted(problem, discretisation, slots);
        let grouped: Vec<_> = of_tasks.par_iter().map(|task| lengths(task)).collect();
        let slots = cells.nodes.par_iter();
        let of_slot: Vec<AtomicU32> = slots.map(|_| AtomicU32::new(NONE)).collect();
        let firsts = grouped.iter().scan(0, |end, (lengths, _)| {
            *end += lengths.len();
            Some(*end - lengths.len())
        });
        let tasks = of_tasks.par_iter().zip(firsts.collect::<Vec<usize>>());
        let middles = tasks.map(|(corners, first)| {
            let groups = groups(corners).zip(first..);
            let middles = groups.map(|(group, number)| {
                for corner in group {
                    of_slot[corner.slot as usize].store(number as u32, Ordering::Relaxed);
                }
                mesh.nodes[cells.nodes[group[0].slot as usize] as usize]
            });
            middles.collect::<Vec<DVec3>>()
        });
        Self {
            middles: middles.flatten_iter().collect(),
            cells: Lists::join(&grouped),
            of_slot: of_slot.into_par_iter().map(AtomicU32::into_inner).collect(),
        }
    }
}

/// The corners of successive nodes, ascending.
fn sorted(problem: &Problem, discretisation: &Discretisation, slots: &Lists) -> Vec<Vec<Corner>> {
    let cells = &problem.mesh.cells;
    let of_cell_node = &discretisation.points.of_cell_node;
    let materials = problem.material_of_cell();
    let cell_of_slot = &discretisation.pattern.cell_of_slot;
    let corner = |&slot: &u32| {
        let (cell, own) = cell_of_slot.locate(slot, cells);
        let is_corner = slot as usize - own.start < cells.shapes[cell].corner_count();
        is_corner.then(|| Corner {
            key: (of_cell_node[slot as usize], materials[cell]),
            slot,
            cell: cell as u32,
        })
    };
    let tasks: Vec<usize> = (0..slots.count()).step_by(NODES_PER_TASK).collect();
    let of_tasks = tasks.into_par_iter().map(|start| {
        let mut corners = Vec::new();
        // Points are numbered node by node.
        for node in start..(start + NODES_PER_TASK).min(slots.count()) {
            let first = corners.len();
            corners.extend(slots.of(node).iter().filter_map(corner));
            corners[first..].sort_unstable();
        }
        corners
    });
    of_tasks.collect()
}

fn groups(corners: &[Corner]) -> impl Iterator<Item = &[Corner]> {
    corners.chunk_by(|a, b| a.key == b.key)
}

/// Lengths of the groups of corners, and their cells.
fn lengths(corners: &[Corner]) -> (Vec<u32>, Vec<u32>) {
    let lengths = groups(corners).map(|group| group.len() as u32);
    let cells = corners.iter().map(|corner| corner.cell);
    (lengths.collect(), cells.collect())
}
