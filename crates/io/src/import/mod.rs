//! Meshes of other programs: Abaqus input files, and grids of VTK with numbers of materials.

mod abaqus;
mod abaqus_mesh;
mod abaqus_model;
mod abaqus_sets;
mod grid;
mod imported;
mod piece;
mod same_surfaces;
mod values;
mod vtk_order;

pub use abaqus::parse_abaqus;
pub use grid::read_grid;
pub use imported::Imported;
pub use values::read_values;
