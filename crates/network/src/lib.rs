//! Networks of planar fractures: lists and random sets in, gmsh geometry and statistics out.
//!
//! A fracture is a convex planar polygon. Whatever is done to one (clipping, mending ends that
//! nearly touch) happens within its plane, so planes never change. All lengths are in metres.

mod clip;
mod fisher;
mod geo;
mod intersections;
mod list;
mod list_row;
mod network;
mod orientation;
mod polygon;
mod random;
mod size;
mod small_features;
mod statistics;
mod stochastic;
mod treat;

pub use clip::{Domain, FACES};
pub use fisher::Fisher;
pub use geo::{Grouping, write_geo};
pub use intersections::{Intersection, distance, intersection};
pub use list::{read_list, repeated_names};
pub use list_row::SIDES;
pub use network::{Fracture, Given, LeftOut, Network, Sizes};
pub use orientation::Orientation;
pub use polygon::{Outline, Polygon, check_name};
pub use random::Stream;
pub use size::SizeLaw;
pub use small_features::{Feature, FeatureKind, small_features};
pub use statistics::{Moments, moments};
pub use stochastic::{Amount, Drawn, Shape, StochasticSet};
