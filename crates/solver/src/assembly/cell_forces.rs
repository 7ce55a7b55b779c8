//! Forces that cells exert on their nodes: weight, initial stress, prescribed displacements.
//!
//! Each cell is integrated once, in waves that bound the memory. Every thread owns a range of
//! points and adds what the cells of the wave have for them, in ascending order, so no sum depends
//! on the number of threads.

use glam::{DMat3, DVec3};
use lie_core::kernel::{self, MAX_NODES};
use rayon::prelude::*;

use crate::space::Space;
use crate::space::cell::{self, Cell, StrainOffsets};

/// Cells of one task.
const CELLS_PER_TASK: usize = 256;
/// Cells whose forces are kept at a time.
const CELLS_PER_WAVE: usize = 1 << 16;

/// Weight of the rock (N) on all points: `f_a = int N_a rho g dV`.
pub(crate) fn gravity(space: Space<'_>) -> Vec<DVec3> {
    let problem = space.problem;
    if problem.gravity == DVec3::ZERO {
        return vec![DVec3::ZERO; space.points.len()];
    }
    gather(space, |cell, positions, forces| {
        let weight = problem.rock(cell).density * problem.gravity;
        let shape = problem.mesh.cells.shapes[cell];
        kernel::add_body_forces(shape, positions, |_| weight, forces);
    })
}

/// Forces (N) by which the initial stress, if there is one, resists on all points:
/// `f_a = int sigma_0 . grad N_a dV`.
pub(crate) fn initial_stress(space: Space<'_>) -> Option<Vec<DVec3>> {
    let problem = space.problem;
    problem.initial_stress.as_ref()?;
    Some(gather(space, |cell, positions, forces| {
        let shape = problem.mesh.cells.shapes[cell];
        if let Some(stress) = problem.initial_stress_in(cell) {
            kernel::add_stress_forces(shape, positions, |at| stress.at(at), forces);
        }
    }))
}

/// Forces (N) by which the rock resists displacements of all points (m), and what strains cells
/// beside: `f_a = int sigma(u) . grad N_a dV`.
pub(crate) fn elastic(
    space: Space<'_>,
    displacements: &[DVec3],
    offsets: &StrainOffsets,
) -> Vec<DVec3> {
    let problem = space.problem;
    gather(space, |index, _, forces| {
        let cell = Cell::of(problem, space.points, displacements, index).strained(offsets, index);
        let nodes = (cell.nodes(), cell.moved());
        kernel::add_elastic_forces(cell.shape, nodes, cell.rock, forces);
    })
}

/// Forces (N) on all points, where `of_cell` adds one cell's nodal forces.
fn gather(space: Space<'_>, of_cell: impl Fn(usize, &[DVec3], &mut [DVec3]) + Sync) -> Vec<DVec3> {
    let offsets = &space.problem.mesh.cells.offsets;
    let cell_count = space.problem.mesh.cells.len();
    let share = space
        .points
        .len()
        .div_ceil(rayon::current_num_threads())
        .max(1);
    let mut sums = vec![DVec3::ZERO; space.points.len()];
    for start in (0..cell_count).step_by(CELLS_PER_WAVE) {
        let cells = start..(start + CELLS_PER_WAVE).min(cell_count);
        let slots = offsets[cells.start] as usize..offsets[cells.end] as usize;
        let of_slot = of_cells(space, cells, &of_cell);
        let points = &space.points.of_cell_node[slots];
        sums.par_chunks_mut(share)
            .enumerate()
            .for_each(|(task, sums)| {
                for (force, &point) in of_slot.iter().zip(points) {
                    if let Some(sum) = sums.get_mut((point as usize).wrapping_sub(task * share)) {
                        *sum += *force;
                    }
                }
            });
    }
    sums
}

/// Nodal forces of consecutive cells, slot by slot.
fn of_cells(
    space: Space<'_>,
    cells: std::ops::Range<usize>,
    of_cell: &(impl Fn(usize, &[DVec3], &mut [DVec3]) + Sync),
) -> Vec<DVec3> {
    let elements = &space.problem.mesh.cells;
    let first = elements.offsets[cells.start] as usize;
    let mut forces = vec![DVec3::ZERO; elements.offsets[cells.end] as usize - first];
    let mut rest = forces.as_mut_slice();
    let mut tasks = Vec::new();
    for start in cells.clone().step_by(CELLS_PER_TASK) {
        let cells = start..(start + CELLS_PER_TASK).min(cells.end);
        let length = elements.offsets[cells.end] - elements.offsets[cells.start];
        let (share, tail) = rest.split_at_mut(length as usize);
        tasks.push((cells, share));
        rest = tail;
    }
    tasks.into_par_iter().for_each(|(cells, mut rest)| {
        let mut positions = [DVec3::ZERO; MAX_NODES];
        for cell in cells {
            let positions = cell::positions(&space.problem.mesh, cell, &mut positions);
            let (own, tail) = rest.split_at_mut(positions.len());
            of_cell(cell, positions, own);
            rest = tail;
        }
    });
    forces
}

/// Forces (N) by which the rock resists the prescribed displacements of a load case alone, `f = K
/// g`, if it prescribes any.
pub(crate) fn prescribed(space: Space<'_>, case: usize) -> Option<Vec<DVec3>> {
    if !space.supports.prescribe(case) {
        return None;
    }
    let (problem, points) = (space.problem, space.points);
    let cells = &problem.mesh.cells;
    let is_moved = |point: u32| space.supports.prescribed(point as usize, case) != DVec3::ZERO;
    // Few cells have prescribed displacements: those along a part of the surface.
    let moved: Vec<usize> = (0..cells.len())
        .into_par_iter()
        .filter(|&cell| {
            points.of_cell_node[cells.range(cell)]
                .iter()
                .copied()
                .any(is_moved)
        })
        .collect();
    let forces: Vec<[DVec3; MAX_NODES]> = moved
        .par_iter()
        .map_init(
            || [DMat3::ZERO; MAX_NODES * MAX_NODES],
            |matrix, &cell| prescribed_cell(space, case, cell, matrix),
        )
        .collect();
    let mut sums = vec![DVec3::ZERO; points.len()];
    for (cell, forces) in moved.into_iter().zip(forces) {
        let own = points.of_cell_node[cells.range(cell)].iter();
        for (&point, force) in own.zip(forces) {
            sums[point as usize] += force;
        }
    }
    Some(sums)
}

fn prescribed_cell(
    space: Space<'_>,
    case: usize,
    cell: usize,
    matrix: &mut [DMat3],
) -> [DVec3; MAX_NODES] {
    let cells = &space.problem.mesh.cells;
    let mut positions = [DVec3::ZERO; MAX_NODES];
    let positions = cell::positions(&space.problem.mesh, cell, &mut positions);
    let count = positions.len();
    let matrix = &mut matrix[..count * count];
    let rock = space.problem.rock(cell);
    kernel::stiffness(cells.shapes[cell], positions, rock, matrix);
    let points = &space.points.of_cell_node[cells.range(cell)];
    let mut forces = [DVec3::ZERO; MAX_NODES];
    for (force, row) in forces.iter_mut().zip(matrix.chunks(count)) {
        let held = points
            .iter()
            .map(|&b| space.supports.prescribed(b as usize, case));
        *force = row.iter().zip(held).map(|(block, u)| *block * u).sum();
    }
    forces
}
