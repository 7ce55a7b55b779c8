//! Rock that touches without sharing nodes: outer faces that lie on one another.

mod outer;
mod overlap;
mod pairs;
mod places;
mod surfaces;

pub(crate) use outer::OuterFaces;
pub(crate) use pairs::matching;
pub(crate) use places::Places;
pub(crate) use surfaces::{DoubledFaces, doubled_faces, doubled_surfaces};
pub use surfaces::{DoubledSurface, Touch};
