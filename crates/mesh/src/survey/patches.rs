//! Pieces of fractures, and patches of facets without a jump.

use glam::DVec3;

use super::fractures::{FacetGeometry, FractureSurvey};
use crate::disjoint_sets::DisjointSets;
use crate::fracture_edges::FractureEdges;
use crate::mesh::Mesh;

/// Facets that hang together and at none of whose nodes the two sides can move apart: the mesh is
/// too coarse for them.
#[derive(Debug, Clone, PartialEq)]
pub struct MutePatch {
    /// Index into [`crate::MeshData::fractures`].
    pub fracture: u32,
    /// Number of facets.
    pub facets: usize,
    /// Area (m^2).
    pub area: f64,
    /// Middle of the patch, by area (m).
    pub centre: DVec3,
    /// Whether it is a whole piece of the fracture, and not a corner of one that moves.
    pub whole: bool,
}

/// All patches, and the patch of each facet.
pub(super) struct Mute {
    pub(super) patches: Vec<MutePatch>,
    pub(super) patch_of_facet: Vec<Option<u32>>,
}

/// Finds the patches and counts the pieces of the fractures.
pub(super) fn find(
    mesh: &Mesh,
    geometry: &FacetGeometry,
    edges: &FractureEdges,
    fractures: &mut [FractureSurvey],
) -> Mute {
    let count = mesh.facets.fracture.len();
    let mute: Vec<bool> = (0..count).map(|facet| is_mute(mesh, facet)).collect();
    let (mut pieces, mut patches) = (DisjointSets::new(count), DisjointSets::new(count));
    for run in edges.meetings() {
        for own in run.chunk_by(|a, b| a.fracture == b.fracture) {
            let mut last_mute = None;
            for edge in own {
                pieces.join(own[0].facet, edge.facet);
                if mute[edge.facet as usize] {
                    patches.join(*last_mute.get_or_insert(edge.facet), edge.facet);
                }
            }
        }
    }
    let mut moves = vec![false; count];
    for facet in 0..count as u32 {
        let piece = pieces.root(facet);
        if piece == facet {
            fractures[mesh.facets.fracture[facet as usize] as usize].pieces += 1;
        }
        moves[piece as usize] |= !mute[facet as usize];
    }
    let whole = |facet: u32| !moves[pieces.root(facet) as usize];
    collect(mesh, geometry, &mute, &mut patches, whole)
}

fn is_mute(mesh: &Mesh, facet: usize) -> bool {
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
    mute: &[bool],
    sets: &mut DisjointSets,
    mut whole: impl FnMut(u32) -> bool,
) -> Mute {
    let mut patches: Vec<MutePatch> = Vec::new();
    let mut patch_of_facet: Vec<Option<u32>> = vec![None; mute.len()];
    for facet in (0..mute.len()).filter(|&facet| mute[facet]) {
        let root = sets.root(facet as u32) as usize;
        if root == facet {
            patch_of_facet[facet] = Some(patches.len() as u32);
            patches.push(MutePatch {
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
    Mute {
        patches,
        patch_of_facet,
    }
}
