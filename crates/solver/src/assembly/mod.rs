//! Matrices and forces of a problem over its space.

pub(crate) mod cell_forces;
mod cell_matrices;
mod drawing;
pub(crate) mod facet_point;
mod facet_values;
pub(crate) mod interface;
pub(crate) mod loads;
mod node_blocks;
pub(crate) mod rock;
pub(crate) mod rock_spring;
pub(crate) mod shared_walls;
pub(crate) mod springs;
mod terms;
pub(crate) mod tetrahedra;
