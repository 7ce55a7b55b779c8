//! Parallel assembly: the stiffness of the rock and the forces of the loads.
//!
//! Every node gathers what the cells around it contribute to its own rows, in ascending order of
//! the cells. One thread owns one row, so there are no locks and no colours, and the values do not
//! depend on the number of threads.

use std::ops::Range;

use glam::{DMat3, DVec3};
use lie_core::enrichment::coefficient;
use lie_core::kernel::{self, MAX_NODES};
use rayon::prelude::*;

use crate::matrix::BlockMatrix;
use crate::pattern::Pattern;
use crate::points::Points;
use crate::problem::Problem;
use crate::supports::Supports;

/// Nodes that one task assembles; small enough to balance, large enough to amortise.
const NODES_PER_TASK: usize = 256;

/// What assembly works from.
#[derive(Clone, Copy)]
pub(crate) struct Frame<'a> {
    pub(crate) problem: &'a Problem,
    pub(crate) points: &'a Points,
    pub(crate) supports: &'a Supports,
    pub(crate) pattern: &'a Pattern,
}

/// One occurrence of a node in a cell.
struct Occurrence<'a> {
    cell: usize,
    /// Number of the node within the cell.
    local: usize,
    /// Points at the cell's nodes.
    points: &'a [u32],
    positions: &'a [DVec3],
}

/// Stiffness of the rock over all unknowns, held directions included: there the diagonal keeps the
/// scale of the rock, so the matrix stays positive definite.
///
/// With `u = g + P T y` it is `T^T (P K P + s (I - P)) T`.
pub(crate) fn rock_stiffness(frame: Frame<'_>) -> BlockMatrix {
    let mut blocks = vec![DMat3::ZERO; frame.pattern.columns.len()];
    split_by_nodes(frame, &mut blocks)
        .into_par_iter()
        .for_each(|(nodes, mut rest)| {
            for node in nodes {
                let own: usize = frame
                    .points
                    .of_node(node)
                    .map(|row| frame.pattern.row(row).len())
                    .sum();
                let (rows, tail) = rest.split_at_mut(own);
                assemble_node(frame, node, rows);
                rest = tail;
            }
        });
    BlockMatrix { blocks }
}

/// Cuts the blocks of the matrix into the shares of consecutive nodes.
fn split_by_nodes<'a>(
    frame: Frame<'_>,
    blocks: &'a mut [DMat3],
) -> Vec<(Range<usize>, &'a mut [DMat3])> {
    let node_count = frame.problem.mesh.nodes.len();
    let mut rest = blocks;
    let mut shares = Vec::new();
    for start in (0..node_count).step_by(NODES_PER_TASK) {
        let end = (start + NODES_PER_TASK).min(node_count);
        let rows = frame.points.offset[start] as usize..frame.points.offset[end] as usize;
        let length = frame.pattern.row_offset[rows.end] - frame.pattern.row_offset[rows.start];
        let (share, tail) = rest.split_at_mut(length);
        shares.push((start..end, share));
        rest = tail;
    }
    shares
}

/// Assembles all rows of one node; `rows` are its blocks, row after row of equal length.
fn assemble_node(frame: Frame<'_>, node: usize, rows: &mut [DMat3]) {
    let own = frame.points.of_node(node);
    let Some(first) = own.clone().next() else {
        return;
    };
    let columns = &frame.pattern.columns[frame.pattern.row(first)];
    let mut diagonal = vec![0.0; own.len()];
    let mut stencil = [DMat3::ZERO; MAX_NODES];
    for_each_occurrence(frame, node, |at| {
        let count = at.points.len();
        stencil[..count].fill(DMat3::ZERO);
        let shape = frame.problem.mesh.cells.shapes[at.cell];
        let rock = frame.problem.rock(at.cell);
        kernel::add_stiffness_row(shape, at.positions, rock, at.local, &mut stencil[..count]);
        let point = at.points[at.local] as usize;
        diagonal[point - own.start] += trace(stencil[at.local]) / 3.0;
        for (local, block) in stencil[..count].iter().enumerate() {
            let other = at.points[local] as usize;
            let block = frame.supports.project_block(point, other, *block);
            scatter(frame.points, point, other, block, columns, rows);
        }
    });
    for (sector, scale) in diagonal.iter().enumerate() {
        let point = own.start + sector;
        if let Some(hold) = frame.supports.hold(point) {
            let block = *scale * (DMat3::IDENTITY - hold.free);
            scatter(frame.points, point, point, block, columns, rows);
        }
    }
}

/// Adds a block between two points to the unknowns of their nodes:
/// `K_kl += c_ik c_jl K_ij`.
fn scatter(
    points: &Points,
    point: usize,
    other: usize,
    block: DMat3,
    columns: &[u32],
    rows: &mut [DMat3],
) {
    let (sector, sectors) = points.sector(point);
    let (other_sector, other_sectors) = points.sector(other);
    let first = other as u32 - other_sector;
    let start = columns.partition_point(|&column| column < first);
    for k in 0..sectors {
        let row = &mut rows[k as usize * columns.len()..][start..];
        let weight = coefficient(sectors, sector, k);
        for l in 0..other_sectors {
            row[l as usize] += weight * coefficient(other_sectors, other_sector, l) * block;
        }
    }
}

fn trace(block: DMat3) -> f64 {
    block.x_axis.x + block.y_axis.y + block.z_axis.z
}

fn for_each_occurrence(frame: Frame<'_>, node: usize, mut visit: impl FnMut(&Occurrence<'_>)) {
    let mesh = &frame.problem.mesh;
    let mut positions = [DVec3::ZERO; MAX_NODES];
    for &slot in frame.pattern.slots.of(node) {
        let cell = frame.pattern.cell_of_slot[slot as usize] as usize;
        let range = mesh.cells.range(cell);
        let nodes = &mesh.cells.nodes[range.clone()];
        for (position, &node) in positions.iter_mut().zip(nodes) {
            *position = mesh.nodes[node as usize];
        }
        visit(&Occurrence {
            cell,
            local: slot as usize - range.start,
            points: &frame.points.of_cell_node[range],
            positions: &positions[..nodes.len()],
        });
    }
}

/// Forces on all points (N), where `of_cell` adds one cell's nodal forces.
fn gather_cells(
    frame: Frame<'_>,
    of_cell: impl Fn(usize, &[DVec3], &[u32], &mut [DVec3]) + Sync,
) -> Vec<DVec3> {
    let per_node: Vec<Vec<DVec3>> = (0..frame.problem.mesh.nodes.len())
        .into_par_iter()
        .map(|node| {
            let own = frame.points.of_node(node);
            let mut sum = vec![DVec3::ZERO; own.len()];
            let mut forces = [DVec3::ZERO; MAX_NODES];
            for_each_occurrence(frame, node, |at| {
                let count = at.points.len();
                forces[..count].fill(DVec3::ZERO);
                of_cell(at.cell, at.positions, at.points, &mut forces[..count]);
                sum[at.points[at.local] as usize - own.start] += forces[at.local];
            });
            sum
        })
        .collect();
    per_node.concat()
}

/// Weight of the rock (N) on all points: `f_a = int N_a rho g dV`.
pub(crate) fn gravity_forces(frame: Frame<'_>) -> Vec<DVec3> {
    let problem = frame.problem;
    gather_cells(frame, |cell, positions, _, forces| {
        let weight = problem.rock(cell).density * problem.gravity;
        let shape = problem.mesh.cells.shapes[cell];
        kernel::add_body_forces(shape, positions, |_| weight, forces);
    })
}

/// Forces (N) by which the initial stress resists on all points: `f_a = int sigma_0 . grad N_a dV`.
pub(crate) fn initial_stress_forces(frame: Frame<'_>) -> Vec<DVec3> {
    let problem = frame.problem;
    let Some(stress) = &problem.initial_stress else {
        return vec![DVec3::ZERO; frame.points.len()];
    };
    gather_cells(frame, |cell, positions, _, forces| {
        let shape = problem.mesh.cells.shapes[cell];
        kernel::add_stress_forces(shape, positions, |at| stress.at(at), forces);
    })
}

/// Forces (N) by which the rock resists the prescribed displacements alone: `f = K g`.
pub(crate) fn prescribed_forces(frame: Frame<'_>) -> Vec<DVec3> {
    let problem = frame.problem;
    gather_cells(frame, |cell, positions, points, forces| {
        let prescribed = |local: usize| frame.supports.prescribed(points[local] as usize);
        if (0..points.len()).all(|local| prescribed(local) == DVec3::ZERO) {
            return;
        }
        let shape = problem.mesh.cells.shapes[cell];
        let mut row = [DMat3::ZERO; MAX_NODES];
        for (a, force) in forces.iter_mut().enumerate() {
            row[..points.len()].fill(DMat3::ZERO);
            kernel::add_stiffness_row(
                shape,
                positions,
                problem.rock(cell),
                a,
                &mut row[..points.len()],
            );
            *force += (0..points.len())
                .map(|b| row[b] * prescribed(b))
                .sum::<DVec3>();
        }
    })
}
