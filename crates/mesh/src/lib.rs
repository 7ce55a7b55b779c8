//! Shape and tags of a meshed, fractured body; no physics and no file formats.
//!
//! A [`Draft`] is what a file holds; it may be joined and refined. [`Mesh::build`] checks it and
//! answers either with every [`Defect`] at once or with a [`Mesh`], which promises:
//!
//! - every cell has a positive volume, no two cells share more than a face;
//! - no two outer faces lie on one another, unless [`Faces::let_touch`] says so: rock that touches
//!   shares its nodes;
//! - every fracture facet lies between exactly two cells, its `minus` and its `plus` cell, and its
//!   nodes run counter-clockwise seen from the plus side: the normal points from minus to plus;
//! - the facets of one connected fracture surface agree in orientation;
//! - every boundary facet belongs to exactly one cell, its nodes run counter-clockwise seen from
//!   outside;
//! - around every node, the cells that reach each other without crossing a fracture facet form one
//!   *sector*, and every cell knows the sector of each of its nodes.
//!
//! A mesh of surfaces alone, [`Mesh::of_surfaces`], has no cells, and promises only that no facet
//! lies on another, and that no two nodes are at one place.
//!
//! Which side of a fracture is plus is decided here, once.

mod adjacency;
mod arrange;
mod blocks;
mod check;
mod disjoint_sets;
mod doubled;
mod draft;
mod element_blocks;
mod extrude;
mod facets;
mod fracture_edges;
mod geometry;
mod join;
mod layers;
mod merge;
mod mesh;
mod orient;
mod orientation;
mod outside;
mod overlap;
mod pairing;
mod part;
mod placed;
mod quarter_points;
mod refine;
mod roles;
mod sectors;
mod shape;
mod sides;
pub mod structured;
mod surface_mesh;
mod surfaces;
mod survey;

pub use check::{
    CONDITION_INSIDE, DOUBLED_NODES, FACES_NOT_MATCHING, FRACTURE_ON_DOUBLED_NODES, cell_defects,
};
pub use disjoint_sets::DisjointSets;
pub use doubled::{DoubledSurface, Touch};
pub use draft::{Curve, Draft, Elements, Group, TaggedElements};
pub use element_blocks::ElementBlock;
pub use facets::{Boundary, Facets};
pub use fracture_edges::{FacetEdge, FractureEdges, FracturesAtNodes};
pub use geometry::{cell_volume, facet_area_vector, facet_centre};
pub use join::{CommonSurface, Joined, Joining};
pub use kluft_defect::{Defect, Excerpt, nearest, sample};
pub use layers::Flat;
pub use mesh::{Mesh, MeshData};
pub use orientation::Orientation;
pub use outside::outer_surfaces;
pub use part::{Part, Whole};
pub use placed::PlacedSurface;
pub use roles::{Faces, SurfaceRole};
pub use sectors::Sectors;
pub use shape::{Face, Shape};
pub use survey::{
    BlockSurvey, CellAngles, CellQuality, Contact, FractureSurvey, MeanOrientation, Survey,
    UnresolvedPatch, bearing, cell_angles,
};
