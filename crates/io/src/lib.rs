//! Files: gmsh's meshes in, ParaView's results out; no scene, no physics.

mod about;
mod atomic;
mod claimed_folder;
mod fingerprint;
pub mod gmsh;
pub mod import;
mod load;
pub mod msh;
pub mod printable;
mod pvd;
mod pvtu;
mod vtm;
mod vtu;
mod vtu_array;
mod xml;

pub use about::About;
pub use atomic::{NOT_WRITTEN, sync_folder, write_atomically};
pub use claimed_folder::ClaimedFolder;
pub use fingerprint::{Fingerprint, fingerprint, fingerprint_of};
pub use gmsh::{
    Dimension, GmshOptions, MeshCache, Meshed, Meshing, mesh_geometry, write_size_field,
};
pub use load::{arrange_large, load_msh};
pub use msh::{parse_msh, read_msh, shape_of_gmsh_element, write_msh};
pub use pvd::write_pvd;
pub use pvtu::write_pvtu;
pub use vtm::write_vtm;
pub use vtu::{
    EncodedGrid, Field, Grid, Values, shape_of_vtk_cell, vtk_cell, vtk_connectivity, write_vtu,
};
