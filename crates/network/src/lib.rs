//! Networks of planar fractures: lists and random sets in, gmsh geometry and statistics out.
//!
//! A fracture is a convex planar polygon. Whatever is done to one (clipping, snapping ends that
//! nearly touch) happens within its plane, so planes never change. All lengths are in metres.

mod aperture_law;
mod arrangement;
mod clip;
mod fisher;
mod foreign;
mod foreign_line;
mod foreign_user;
mod fracture;
mod geo;
mod geo_samples;
mod geo_surfaces;
mod geo_template;
mod intersections;
mod list;
mod list_row;
mod network;
mod polygon;
mod random;
#[cfg(test)]
mod samples;
mod size;
mod small_features;
mod snap;
mod statistics;
mod stochastic;

pub use aperture_law::ApertureLaw;
pub use arrangement::{Arrangement, Face, Moved, Plane, Sheet, collapse, faces};
pub use clip::{Domain, FACES};
pub use fisher::Fisher;
pub use foreign::{ForeignList, read_foreign_list};
pub use fracture::{CellSizes, InputFracture, NetworkFracture, Rejected};
pub use geo::{Grouping, write_geo};
pub use intersections::{Intersection, distance, intersection};
pub use kluft_mesh::Orientation;
pub use list::{read_list, repeated_names};
pub use list_row::SIDES;
pub use network::Network;
pub use polygon::{Outline, Polygon, check_name};
pub use random::Stream;
pub use size::SizeLaw;
pub use small_features::{Feature, FeatureKind, small_features};
pub use statistics::{Moments, moments};
pub use stochastic::{Amount, DrawnFracture, FractureShape, StochasticSet};
