//! Sizes and places of blocks.

use glam::DVec3;

use crate::mesh::Mesh;

/// A part of the body that hangs together without crossing a fracture.
#[derive(Debug, Clone, PartialEq)]
pub struct BlockSurvey {
    /// Number of cells.
    pub cells: usize,
    /// Volume between the corners of the cells (m^3).
    pub volume: f64,
    /// Lowest and highest coordinates (m).
    pub bounds: (DVec3, DVec3),
    /// Whether it has a facet on each of [`crate::MeshData::boundaries`].
    pub on_boundary: Vec<bool>,
    /// Whether it has a facet of each of [`crate::MeshData::fractures`].
    pub on_fracture: Vec<bool>,
}

/// Surveys the blocks of a mesh, given the volumes of its cells (m^3).
pub(super) fn survey(mesh: &Mesh, volumes: &[f64]) -> Vec<BlockSurvey> {
    if mesh.cells.is_empty() {
        return Vec::new();
    }
    let empty = BlockSurvey {
        cells: 0,
        volume: 0.0,
        bounds: (DVec3::INFINITY, DVec3::NEG_INFINITY),
        on_boundary: vec![false; mesh.boundaries.len()],
        on_fracture: vec![false; mesh.fractures.len()],
    };
    let mut blocks = vec![empty; mesh.block_count];
    for (cell, &block) in mesh.block.iter().enumerate() {
        let block = &mut blocks[block as usize];
        block.cells += 1;
        block.volume += volumes[cell];
        let (low, high) = &mut block.bounds;
        for &node in mesh.cells.nodes_of(cell) {
            *low = low.min(mesh.nodes[node as usize]);
            *high = high.max(mesh.nodes[node as usize]);
        }
    }
    for (index, boundary) in mesh.boundaries.iter().enumerate() {
        for &cell in &boundary.cell {
            blocks[mesh.block[cell as usize] as usize].on_boundary[index] = true;
        }
    }
    let facets = &mesh.facets;
    for (facet, &fracture) in facets.fracture.iter().enumerate() {
        for cell in [facets.minus[facet], facets.plus[facet]] {
            let block = mesh.block[cell as usize] as usize;
            blocks[block].on_fracture[fracture as usize] = true;
        }
    }
    blocks
}
