//! The checked mesh.

use std::ops::Deref;

use glam::DVec3;

use crate::adjacency::Adjacency;
use crate::doubled::{DoubledFaces, doubled_faces, doubled_surfaces};
use crate::draft::{Curve, Draft, Elements, Group};
use crate::facets::{self, Boundary, Facets};
use crate::overlap;
use crate::roles::{Faces, SurfaceRole};
use crate::sectors::{self, Sectors};
use crate::sides::Sides;
use crate::surfaces::Surfaces;
use crate::{blocks, check, layers};
use kluft_defect::Defect;

/// A checked, fractured mesh; see the crate documentation for what it promises.
///
/// [`Mesh::build`] is the only way to one, [`Mesh::of_surfaces`] to one without cells; its data can
/// be read but not written, so that the promises hold wherever a mesh is met:
///
/// ```compile_fail
/// fn flatten(mesh: &mut kluft_mesh::Mesh) {
///     mesh.nodes[0].z = 0.0;
/// }
/// ```
#[derive(Debug, Clone)]
pub struct Mesh {
    data: MeshData,
}

/// What a [`Mesh`] holds.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct MeshData {
    /// Where it came from, for messages.
    pub source: String,
    /// Coordinates of the nodes (m).
    pub nodes: Vec<DVec3>,
    /// Numbers of the nodes in the file.
    pub node_tags: Vec<u64>,
    /// Shapes and nodes of the cells.
    pub cells: Elements,
    /// Numbers of the cells in the file.
    pub cell_tags: Vec<u64>,
    /// Index into `group_sets` for each cell.
    pub cell_group_set: Vec<u32>,
    /// The distinct sets of groups that elements belong to.
    pub group_sets: Vec<Vec<usize>>,
    /// All physical groups.
    pub groups: Vec<Group>,
    /// Names of the fractures.
    pub fractures: Vec<String>,
    /// How many facets a fracture (first) left to another (second) whose group holds them too.
    pub shared_facets: Vec<(u32, u32, usize)>,
    /// Their facets.
    pub facets: Facets,
    /// The named parts of the outer surface.
    pub boundaries: Vec<Boundary>,
    /// Sectors of all nodes.
    pub sectors: Sectors,
    /// The block of each cell: blocks hang together without crossing a fracture.
    pub block: Vec<u32>,
    /// Number of blocks.
    pub block_count: usize,
    /// For each node of a mesh of the plane the node that it moves with, itself in the layer below;
    /// none of other meshes.
    pub original: Option<Vec<u32>>,
    /// Whether cells at crack fronts are quarter-point elements, see
    /// [`Mesh::move_to_quarter_points`].
    pub has_quarter_points: bool,
    /// The named curves.
    pub curves: Vec<Curve>,
}

impl Deref for Mesh {
    type Target = MeshData;

    #[inline]
    fn deref(&self) -> &MeshData {
        &self.data
    }
}

impl Mesh {
    /// Checks `draft` and builds the mesh; `roles` has one entry for each group of the draft, of
    /// which only those of surfaces count.
    ///
    /// # Errors
    /// Every defect found: cells without volume or inside out, faces that do not fit together,
    /// outer faces that lie on one another, volumes that overlap, fractures that are not embedded,
    /// lie on the outer boundary, hold a facet twice or have only one side.
    pub fn build(draft: Draft, roles: &[SurfaceRole]) -> Result<Self, Vec<Defect>> {
        let faces = Faces::of(&draft);
        Self::build_on(draft, faces, roles)
    }

    /// Like [`Mesh::build`], on the faces of this very draft.
    ///
    /// # Errors
    /// As [`Mesh::build`].
    pub fn build_on(
        draft: Draft,
        faces: Faces,
        roles: &[SurfaceRole],
    ) -> Result<Self, Vec<Defect>> {
        Self::build_with(draft, faces, roles, None)
    }

    /// Like [`Mesh::build_on`], with the sides of fractures as given, if they are.
    pub(crate) fn build_with(
        mut draft: Draft,
        Faces {
            mut adjacency,
            may_touch,
        }: Faces,
        roles: &[SurfaceRole],
        sides: Option<&Sides>,
    ) -> Result<Self, Vec<Defect>> {
        let nodes = std::mem::take(&mut draft.nodes).into_iter();
        let nodes: Vec<DVec3> = nodes.map(DVec3::from).collect();
        let overlapping = check::faces(&draft, &adjacency);
        if !overlapping.is_empty() {
            // There nothing can be said of the surfaces; defects of the cells may be the cause.
            let broken = check::cells(&draft, &nodes);
            return Err(if broken.is_empty() {
                overlapping
            } else {
                broken
            });
        }
        let doubled = match may_touch {
            true => DoubledFaces::default(),
            false => doubled_faces(&draft, &nodes, &adjacency),
        };
        let touching = doubled_surfaces(&draft, &nodes, &adjacency, &doubled);
        let mut defects: Vec<Defect> = touching.iter().map(check::touching).collect();
        let (surfaces, unfit) = check::surfaces(&draft, roles, &adjacency, &doubled.faces());
        defects.extend(unfit);
        for facet in &surfaces.facets {
            adjacency.part(facet.faces);
        }
        // The fractures are mostly one thread's work, which leaves the others to the cells.
        let ((facets, boundaries, one_sided), (broken, (block, block_count), sectors)) =
            rayon::join(
                || facets::collect(&draft, &nodes, (&adjacency, sides), &surfaces),
                || divide(&draft, &nodes, &adjacency, &surfaces),
            );
        if !broken.is_empty() {
            return Err(broken);
        }
        defects.extend(one_sided);
        let cells = (&draft.cells.elements, nodes.as_slice());
        let inside = overlap::cells_in_others(cells, (&block, block_count), &facets);
        defects.extend(check::inside_others(&draft, &inside));
        if !defects.is_empty() {
            return Err(defects);
        }
        let mut sectors = sectors;
        let original = draft.is_extruded.then(|| {
            let is_below = |low: u32, high: u32| nodes[low as usize].z < nodes[high as usize].z;
            let cells = &draft.cells.elements;
            // The cells around a node and around its copies are the same.
            layers::for_each_slot(cells, is_below, |slot, below| {
                sectors.of_cell_node[slot] = sectors.of_cell_node[below];
            });
            layers::originals(cells, nodes.len(), is_below)
        });
        let shared = surfaces.shared.iter();
        let shared_facets = shared.map(|(&(left, kept), &count)| (left, kept, count));
        let shared_facets = shared_facets.collect();
        let fractures = surfaces.fractures.iter();
        let data = MeshData {
            fractures: fractures.map(|&g| draft.groups[g].name.clone()).collect(),
            original,
            nodes,
            shared_facets,
            facets,
            boundaries,
            sectors,
            block,
            block_count,
            has_quarter_points: false,
            curves: draft.curves,
            source: draft.source,
            node_tags: draft.node_tags,
            cells: draft.cells.elements,
            cell_tags: draft.cells.tags,
            cell_group_set: draft.cells.group_set,
            group_sets: draft.group_sets,
            groups: draft.groups,
        };
        Ok(Self { data })
    }

    /// A mesh of data whose promises have been checked.
    pub(crate) fn new(data: MeshData) -> Self {
        Self { data }
    }

    /// Whether it is a mesh of the plane, one cell thick.
    pub fn is_plane(&self) -> bool {
        self.original.is_some()
    }

    /// Whether a node moves by itself: in a mesh of the plane, that it is in the layer below.
    pub fn is_own(&self, node: u32) -> bool {
        self.layer_below(node) == node
    }

    /// The node of a mesh of the plane in the layer below that a node moves with; the node itself
    /// in a mesh in space.
    pub fn layer_below(&self, node: u32) -> u32 {
        let original = self.original.as_ref();
        original.map_or(node, |original| original[node as usize])
    }

    /// Multiplies all coordinates by a factor, as another unit of length does.
    ///
    /// # Panics
    /// If the factor is not positive and finite: no promise would hold.
    pub fn scale(&mut self, factor: f64) {
        assert!(factor > 0.0 && factor.is_finite(), "a factor of {factor}");
        self.data.nodes.iter_mut().for_each(|x| *x *= factor);
        let curves = self.data.curves.iter_mut();
        for end in curves.flat_map(|curve| &mut curve.pieces).flatten() {
            *end = end.map(|coordinate| factor * coordinate);
        }
    }

    /// Moves the middles of edges, faces and cells; none of what is promised depends on them.
    pub(crate) fn move_middles(&mut self, moves: &[Option<DVec3>]) {
        for (node, by) in self.data.nodes.iter_mut().zip(moves) {
            *node += by.unwrap_or(DVec3::ZERO);
        }
        self.data.has_quarter_points |= moves.iter().any(Option::is_some);
    }

    /// Coordinates of the corners of an element of this mesh (m).
    pub fn corners(&self, elements: &Elements, index: usize) -> Vec<DVec3> {
        crate::geometry::corners(elements, index, &self.nodes)
    }

    /// Area vectors of all fracture facets (m^2), from minus to plus.
    pub fn facet_areas(&self) -> Vec<DVec3> {
        (0..self.facets.elements.len())
            .map(|facet| crate::facet_area_vector(&self.corners(&self.facets.elements, facet)))
            .collect()
    }

    /// Length of the straight edge between two nodes (m).
    pub fn edge_length(&self, [a, b]: [u32; 2]) -> f64 {
        self.nodes[a as usize].distance(self.nodes[b as usize])
    }

    /// Lowest and highest coordinates of the nodes that are in cells (m), or on facets if there are
    /// none.
    pub fn bounds(&self) -> (DVec3, DVec3) {
        let elements = match self.cells.is_empty() {
            true => &self.facets.elements,
            false => &self.cells,
        };
        let used = elements.nodes.iter().map(|&node| self.nodes[node as usize]);
        used.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), x| {
            (low.min(x), high.max(x))
        })
    }
}

/// Defects of the cells, their blocks, the sectors of the nodes.
fn divide(
    draft: &Draft,
    nodes: &[DVec3],
    adjacency: &Adjacency,
    surfaces: &Surfaces,
) -> (Vec<Defect>, (Vec<u32>, usize), Sectors) {
    let cells = &draft.cells.elements;
    let broken = check::cells(draft, nodes);
    let fractured = surfaces.facets.iter().flat_map(|facet| facet.faces);
    let (blocks, sectors) = rayon::join(
        || blocks::find(cells, adjacency),
        || sectors::find(cells, nodes.len(), adjacency, fractured),
    );
    (broken, blocks, sectors)
}
