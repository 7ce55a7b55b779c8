//! Components of fractures, and patches of facets without a jump.

use glam::DVec3;

use super::fractures::{FacetGeometry, FractureSurvey};
use crate::disjoint_sets::DisjointSets;
use crate::fracture_edges::FractureEdges;
use crate::mesh::Mesh;

/// Facets that hang together and at none of whose nodes the two sides can move apart: the mesh is
/// too coarse for them.
#[derive(Debug, Clone, PartialEq)]
pub struct UnresolvedPatch {
    /// Index into [`crate::MeshData::fractures`].
    pub fracture: u32,
    /// Number of facets.
    pub facets: usize,
    /// Area (m^2).
    pub area: f64,
    /// Middle of the patch, by area (m).
    pub centre: DVec3,
    /// Whether it is a whole component of the fracture, and not a corner of one that moves.
    pub whole: bool,
}

/// All patches, and the patch of each facet.
pub(super) struct UnresolvedPatches {
    pub(super) patches: Vec<UnresolvedPatch>,
    pub(super) patch_of_facet: Vec<Option<u32>>,
}

/// Finds the patches and counts the components of the fractures.
pub(super) fn find(
    mesh: &Mesh,
    geometry: &FacetGeometry,
    edges: &FractureEdges,
    fractures: &mut [FractureSurvey],
) -> UnresolvedPatches {
    let count = mesh.facets.fracture.len();
    let unresolved: Vec<bool> = (0..count).map(|facet| is_unresolved(mesh, facet)).collect();
    let (mut components, mut patches) = (DisjointSets::new(count), DisjointSets::new(count));
    for run in edges.meetings() {
        for own in run.chunk_by(|a, b| a.fracture == b.fracture) {
            let mut last_unresolved = None;
            for edge in own {
                components.join(own[0].facet, edge.facet);
                if unresolved[edge.facet as usize] {
                    patches.join(*last_unresolved.get_or_insert(edge.facet), edge.facet);
                }
            }
        }
    }
    let mut moves = vec![false; count];
    for facet in 0..count as u32 {
        let component = components.root(facet);
        if component == facet {
            fractures[mesh.facets.fracture[facet as usize] as usize].components += 1;
        }
        moves[component as usize] |= !unresolved[facet as usize];
    }
    let whole = |facet: u32| !moves[components.root(facet) as usize];
    collect(mesh, geometry, &unresolved, &mut patches, whole)
}

fn is_unresolved(mesh: &Mesh, facet: usize) -> bool {
    if mesh.cells.is_empty() {
        return false;
    }
    let range = mesh.facets.elements.range(facet);
    let (plus, minus) = (
        &mesh.facets.plus_slots[range.clone()],
        &mesh.facets.minus_slots[range],
    );
    let sector = |slot: u32| mesh.sectors.of_cell_node[slot as usize];
    plus.iter()
        .zip(minus)
        .all(|(&a, &b)| sector(a) == sector(b))
}

fn collect(
    mesh: &Mesh,
    geometry: &FacetGeometry,
    unresolved: &[bool],
    sets: &mut DisjointSets,
    mut whole: impl FnMut(u32) -> bool,
) -> UnresolvedPatches {
    let mut patches: Vec<UnresolvedPatch> = Vec::new();
    let mut patch_of_facet: Vec<Option<u32>> = vec![None; unresolved.len()];
    for facet in (0..unresolved.len()).filter(|&facet| unresolved[facet]) {
        let root = sets.root(facet as u32) as usize;
        if root == facet {
            patch_of_facet[facet] = Some(patches.len() as u32);
            patches.push(UnresolvedPatch {
                fracture: mesh.facets.fracture[facet],
                facets: 0,
                area: 0.0,
                centre: DVec3::ZERO,
                whole: whole(facet as u32),
            });
        }
        // The root is the lowest facet, so it has its patch already.
        patch_of_facet[facet] = patch_of_facet[root];
        if let Some(patch) = patch_of_facet[facet] {
            let patch = &mut patches[patch as usize];
            let area = geometry.areas[facet].length();
            patch.facets += 1;
            patch.area += area;
            patch.centre += area * geometry.centres[facet];
        }
    }
    for patch in &mut patches {
        patch.centre /= patch.area;
    }
    UnresolvedPatches {
        patches,
        patch_of_facet,
    }
}
