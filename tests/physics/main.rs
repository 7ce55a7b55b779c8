//! Physics against oracles that do not share code with the solver. One target, so it links once.
#![allow(
    clippy::print_stdout,
    reason = "tables are what some of these tests are read for"
)]

mod closed_forms;
mod conditions;
mod contact;
mod dice;
mod families;
mod friction;
mod geometries;
mod junctions;
mod linear_solvers;
mod load_paths;
mod loops;
mod manufactured;
mod networks;
mod newton;
mod oracles;
mod oscillation;
mod patch;
mod random_networks;
mod scenes;
mod sphere;
mod split_nodes;
mod stiff_limit;
mod tangent;
mod torture;
mod voigt;
