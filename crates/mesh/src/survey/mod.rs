//! What a mesh is like, before anything is solved on it: tips, junctions, traces, blocks, cells.

mod blocks;
mod contacts;
mod fractures;
mod orientation;
mod patches;
mod quality;
mod tips;

use crate::fracture_edges::{FractureEdges, FracturesAtNodes};
use crate::mesh::Mesh;
use fractures::{FacetGeometry, add_facets, add_nodes};

pub use blocks::BlockSurvey;
pub use contacts::Contact;
pub use fractures::FractureSurvey;
pub use orientation::{MeanOrientation, bearing};
pub use patches::UnresolvedPatch;
pub use quality::{CellAngles, CellQuality, cell_angles};

/// The whole mesh.
#[derive(Debug, Clone)]
pub struct Survey {
    /// One entry for each of [`crate::MeshData::fractures`].
    pub fractures: Vec<FractureSurvey>,
    /// Fractures that share nodes, by pair.
    pub contacts: Vec<Contact>,
    /// Parts of fractures without a jump of their own.
    pub unresolved_patches: Vec<UnresolvedPatch>,
    /// Entry of `unresolved_patches` for each facet that belongs to one.
    pub patch_of_facet: Vec<Option<u32>>,
    /// Number of edges of each facet where its fracture ends in the rock.
    pub tip_edges_of_facet: Vec<u8>,
    /// One entry for each block.
    pub blocks: Vec<BlockSurvey>,
    /// Quality of the cells.
    pub quality: CellQuality,
    /// Fractures at each node.
    pub at_nodes: FracturesAtNodes,
}

impl Survey {
    /// Surveys a mesh, in time linear in the cells.
    pub fn of(mesh: &Mesh) -> Self {
        let facets = FacetGeometry::of(mesh);
        let at_nodes = FracturesAtNodes::of_mesh(mesh);
        let edges = FractureEdges::of(mesh, &at_nodes);
        let quality = CellQuality::of(mesh, &at_nodes);
        let mut fractures: Vec<FractureSurvey> = (0..mesh.fractures.len())
            .map(|_| FractureSurvey::empty())
            .collect();
        add_facets(mesh, &facets, &mut fractures);
        add_nodes(mesh, &at_nodes, &mut fractures);
        let tip_edges_of_facet = tips::add(mesh, &edges, &mut fractures);
        let unresolved = patches::find(mesh, &facets, &edges, &mut fractures);
        Self {
            contacts: contacts::find(mesh, &facets, &edges, &at_nodes),
            unresolved_patches: unresolved.patches,
            patch_of_facet: unresolved.patch_of_facet,
            tip_edges_of_facet,
            blocks: blocks::survey(mesh, &quality.volumes),
            fractures,
            quality,
            at_nodes,
        }
    }
}
