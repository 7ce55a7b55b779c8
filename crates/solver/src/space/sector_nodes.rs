//! Points: one copy of a node for each of its sectors, and the unknowns that move them.
//!
//! A node with `s` sectors has `s` points and `s` unknown 3-vectors, numbered alike: point
//! `offset[node] + i` is the node as sector `i` sees it, unknown `offset[node] + k` is the
//! continuous displacement (`k = 0`) or a jump of that node. [`SectorNodes::displacements`] and
//! [`SectorNodes::gather`] are the enrichment table and its transpose, applied to all nodes.

use std::borrow::Cow;

use glam::DVec3;
use kluft_mesh::Mesh;
use lie_core::enrichment::coefficient;
use rayon::prelude::*;

/// Numbering of points and unknowns.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct SectorNodes {
    /// First point of each node; one entry more than there are nodes.
    pub offset: Vec<u32>,
    /// Node of each point.
    pub node: Vec<u32>,
    /// Point at each cell node, in the order of the cells' flat node list.
    pub of_cell_node: Vec<u32>,
}

impl SectorNodes {
    /// Numbers the points of a mesh, node by node.
    pub fn of(mesh: &Mesh) -> Self {
        let mut offset = Vec::with_capacity(mesh.nodes.len() + 1);
        let mut node = Vec::new();
        offset.push(0);
        for (index, &sectors) in mesh.sectors.count.iter().enumerate() {
            let sectors = match &mesh.original {
                // A copy moves with its original.
                Some(original) if original[index] != index as u32 => 0,
                _ => sectors,
            };
            node.extend(std::iter::repeat_n(index as u32, sectors as usize));
            offset.push(node.len() as u32);
        }
        let slots = mesh.cells.nodes.par_iter().zip(&mesh.sectors.of_cell_node);
        let of_cell_node = match &mesh.original {
            None => slots
                .map(|(&node, &sector)| offset[node as usize] + sector)
                .collect(),
            Some(original) => slots
                .map(|(&node, &sector)| offset[original[node as usize] as usize] + sector)
                .collect(),
        };
        Self {
            offset,
            node,
            of_cell_node,
        }
    }

    /// Node that moves each cell node, in the order of the cells' flat node list.
    pub fn moving_nodes<'a>(&self, mesh: &'a Mesh) -> Cow<'a, [u32]> {
        match mesh.is_plane() {
            false => Cow::Borrowed(&mesh.cells.nodes),
            true => {
                let points = self.of_cell_node.iter();
                Cow::Owned(points.map(|&point| self.node[point as usize]).collect())
            }
        }
    }

    /// Number of points, which is the number of unknown 3-vectors.
    pub fn len(&self) -> usize {
        self.node.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.node.is_empty()
    }

    /// Points (and unknowns) of a node.
    pub fn of_node(&self, node: usize) -> std::ops::Range<usize> {
        self.offset[node] as usize..self.offset[node + 1] as usize
    }

    /// Sector that a point stands for, and the number of sectors of its node.
    pub fn sector(&self, point: usize) -> (u32, u32) {
        let node = self.node[point] as usize;
        let (first, last) = (self.offset[node], self.offset[node + 1]);
        (point as u32 - first, last - first)
    }

    /// Number of jump unknowns (3-vectors).
    pub fn jump_count(&self) -> usize {
        self.len() - self.node_count()
    }

    /// Number of nodes that carry unknowns.
    pub fn node_count(&self) -> usize {
        self.offset
            .windows(2)
            .filter(|pair| pair[0] < pair[1])
            .count()
    }

    /// Displacement of one point: `u_i = sum_k coefficient(s, i, k) y_k`.
    pub fn displacement(&self, unknowns: &[DVec3], point: usize) -> DVec3 {
        let (sector, sectors) = self.sector(point);
        let first = point - sector as usize;
        (0..sectors)
            .map(|k| coefficient(sectors, sector, k) * unknowns[first + k as usize])
            .sum()
    }

    /// Force on one unknown from the forces on its node's points:
    /// `r_k = sum_i coefficient(s, i, k) f_i`.
    pub fn gather(&self, forces: &[DVec3], unknown: usize) -> DVec3 {
        let (k, sectors) = self.sector(unknown);
        let first = unknown - k as usize;
        (0..sectors)
            .map(|i| coefficient(sectors, i, k) * forces[first + i as usize])
            .sum()
    }

    /// Force on one point from the forces on its node's unknowns: the inverse of [`Self::gather`],
    /// `f_i = r_0 / s + r_i` for `i > 0`, and `f_0` such that all add up to `r_0`.
    pub fn point_force(&self, forces: &[DVec3], point: usize) -> DVec3 {
        let (sector, sectors) = self.sector(point);
        let first = point - sector as usize;
        let mean = forces[first] / f64::from(sectors);
        match sector {
            0 => {
                mean - forces[first + 1..first + sectors as usize]
                    .iter()
                    .sum::<DVec3>()
            }
            _ => mean + forces[point],
        }
    }
}
