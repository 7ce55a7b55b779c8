//! What a mesh is like, before anything is solved on it: tips, junctions, traces, blocks, cells.

mod blocks;
mod contacts;
mod edges;
mod orientation;
mod patches;
mod quality;

use glam::DVec3;

use crate::draft::Elements;
use crate::geometry::{facet_area_vector, facet_centre};
use crate::mesh::Mesh;

pub use blocks::BlockSurvey;
pub use contacts::Contact;
pub use orientation::Orientation;
pub use patches::MutePatch;
pub use quality::{CellAngles, CellQuality, cell_angles};

use edges::FacetEdges;

/// One fracture.
#[derive(Debug, Clone, PartialEq)]
pub struct FractureSurvey {
    /// Number of facets.
    pub facets: usize,
    /// Area between the corners of the facets (m^2).
    pub area: f64,
    /// How it lies in space.
    pub orientation: Orientation,
    /// Lowest and highest coordinates (m).
    pub bounds: (DVec3, DVec3),
    /// Number of surfaces that do not share an edge.
    pub pieces: usize,
    /// Whether no edge belongs to one facet only: a sphere, not a disc.
    pub closed: bool,
    /// Number of edges where the fracture ends in the rock.
    pub tip_edges: usize,
    /// Their length (m).
    pub tip_length: f64,
    /// Number of edges on the outer surface.
    pub trace_edges: usize,
    /// Their length (m).
    pub trace_length: f64,
    /// Length of the edges where three or more of its own facets meet (m).
    pub branching_length: f64,
    /// Number of its nodes with 3, 4, 5, 6, 7 and at least 8 sectors.
    pub junction_nodes: [usize; 6],
}

/// The whole mesh.
#[derive(Debug, Clone)]
pub struct Survey {
    /// One entry for each of [`Mesh::fractures`].
    pub fractures: Vec<FractureSurvey>,
    /// Fractures that share nodes, by pair.
    pub contacts: Vec<Contact>,
    /// Parts of fractures without a jump of their own.
    pub mute_patches: Vec<MutePatch>,
    /// Entry of `mute_patches` for each facet that belongs to one.
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
        let at_nodes = FracturesAtNodes::find(mesh);
        let edges = FacetEdges::of(mesh, &at_nodes);
        let quality = CellQuality::of(mesh, &at_nodes);
        let mut fractures: Vec<FractureSurvey> = (0..mesh.fractures.len())
            .map(|_| FractureSurvey::empty())
            .collect();
        add_facets(mesh, &facets, &mut fractures);
        add_nodes(mesh, &at_nodes, &mut fractures);
        let tip_edges_of_facet = edges.add_to(mesh, &mut fractures);
        let mute = patches::find(mesh, &facets, &edges, &mut fractures);
        Self {
            contacts: contacts::find(mesh, &facets, &edges, &at_nodes),
            mute_patches: mute.patches,
            patch_of_facet: mute.patch_of_facet,
            tip_edges_of_facet,
            blocks: blocks::survey(mesh, &quality.volumes),
            fractures,
            quality,
            at_nodes,
        }
    }
}

impl FractureSurvey {
    fn empty() -> Self {
        Self {
            facets: 0,
            area: 0.0,
            orientation: Orientation::default(),
            bounds: (DVec3::INFINITY, DVec3::NEG_INFINITY),
            pieces: 0,
            closed: true,
            tip_edges: 0,
            tip_length: 0.0,
            trace_edges: 0,
            trace_length: 0.0,
            branching_length: 0.0,
            junction_nodes: [0; 6],
        }
    }
}

/// Area vectors and centres of all facets.
struct FacetGeometry {
    areas: Vec<DVec3>,
    centres: Vec<DVec3>,
}

impl FacetGeometry {
    fn of(mesh: &Mesh) -> Self {
        let elements = &mesh.facets.elements;
        let corners = (0..elements.len()).map(|facet| mesh.corners(elements, facet));
        let (areas, centres) = corners
            .map(|corners| (facet_area_vector(&corners), facet_centre(&corners)))
            .unzip();
        Self { areas, centres }
    }
}

fn add_facets(mesh: &Mesh, geometry: &FacetGeometry, fractures: &mut [FractureSurvey]) {
    let of_facet = &mesh.facets.fracture;
    for (&area, &fracture) in geometry.areas.iter().zip(of_facet) {
        let entry = &mut fractures[fracture as usize];
        entry.facets += 1;
        entry.area += area.length();
    }
    let orientations = orientation::of_fractures(&geometry.areas, of_facet, fractures.len());
    for (entry, orientation) in fractures.iter_mut().zip(orientations) {
        entry.orientation = orientation;
    }
}

fn add_nodes(mesh: &Mesh, at_nodes: &FracturesAtNodes, fractures: &mut [FractureSurvey]) {
    for node in 0..mesh.nodes.len() {
        for &fracture in at_nodes.of(node) {
            let entry = &mut fractures[fracture as usize];
            let (low, high) = &mut entry.bounds;
            *low = low.min(mesh.nodes[node]);
            *high = high.max(mesh.nodes[node]);
            let sectors = mesh.sectors.count[node] as usize;
            if sectors > 2 {
                entry.junction_nodes[sectors.min(8) - 3] += 1;
            }
        }
    }
}

/// The fractures at each node, ascending.
#[derive(Debug, Clone)]
pub struct FracturesAtNodes {
    offset: Vec<u32>,
    fractures: Vec<u32>,
}

impl FracturesAtNodes {
    fn find(mesh: &Mesh) -> Self {
        let Elements { nodes, .. } = &mesh.facets.elements;
        let mut pairs = Vec::with_capacity(nodes.len());
        for (facet, &fracture) in mesh.facets.fracture.iter().enumerate() {
            let own = mesh.facets.elements.nodes_of(facet);
            pairs.extend(own.iter().map(|&node| (node, fracture)));
        }
        pairs.sort_unstable();
        pairs.dedup();
        let mut offset = vec![0_u32; mesh.nodes.len() + 1];
        for &(node, _) in &pairs {
            offset[node as usize + 1] += 1;
        }
        for node in 0..mesh.nodes.len() {
            offset[node + 1] += offset[node];
        }
        Self {
            offset,
            fractures: pairs.into_iter().map(|(_, fracture)| fracture).collect(),
        }
    }

    /// Fractures at a node: indices into [`Mesh::fractures`], ascending.
    pub fn of(&self, node: usize) -> &[u32] {
        &self.fractures[self.offset[node] as usize..self.offset[node + 1] as usize]
    }

    /// Whether a fracture goes through a node or ends there.
    pub fn any(&self, node: u32) -> bool {
        self.offset[node as usize] < self.offset[node as usize + 1]
    }
}
