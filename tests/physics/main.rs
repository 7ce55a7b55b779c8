//! Physics against oracles that do not share code with the solver. One target, so it links once.
//!
//! Scenes, oracles and other methods are those of `kluft-verification`.
//!
//! | module | what belongs there |
//! |---|---|
//! | `anisotropy` | uniform stress in rock that depends on the direction |
//! | `augmented_lagrangian` | the method that contact is compared with, against statics |
//! | `closed_forms` | the table of the logarithmic law and a single joint, by simulation |
//! | `conditions` | supports, loads, gravity, initial stress, load steps |
//! | `contact` | walls that close, part and meet again, blocks that nothing holds |
//! | `degenerate_geometry` | fractures in every awkward position, against split nodes |
//! | `element_families` | uniform stress through joints in every shape of cell |
//! | `estimate` | the estimated error against true ones |
//! | `friction` | when joints slide, and how far |
//! | `geometries` | scenes of `geometries/` against the oracle in their heads |
//! | `jump_closure` | jumps add up to zero around every junction |
//! | `junctions` | crossing joint sets as a continuum, T-junctions |
//! | `linear_solvers` | the same state whichever solver |
//! | `load_paths` | histories of loads: superposition, unloading, divided steps |
//! | `manufactured` | order of convergence of the rock without fractures |
//! | `newton` | iterations over loads and cutoffs |
//! | `nonsmooth_laws` | contact with friction on facets of second order |
//! | `oscillation` | signs of the traction behind a crack front |
//! | `patch` | a uniform stress through a joint, whatever the mesh |
//! | `random_networks` | random networks against split nodes |
//! | `sphere` | a curved, closed joint: order of convergence |
//! | `stability` | short forms of the studies of the stability map |
//! | `stiff_limit` | stiff joints weld |
//! | `tangent` | the tangent against differences of the residual |
#![allow(
    clippy::print_stdout,
    reason = "tables are what some of these tests are read for"
)]

mod anisotropy;
mod augmented_lagrangian;
mod closed_forms;
mod conditions;
mod contact;
mod degenerate_geometry;
mod element_families;
mod estimate;
mod flow_pages;
mod friction;
mod geometries;
mod jump_closure;
mod junctions;
mod linear_solvers;
mod load_paths;
mod manufactured;
mod newton;
mod nonsmooth_laws;
mod oscillation;
mod patch;
mod random_networks;
mod sphere;
mod stability;
mod stiff_limit;
mod tangent;
