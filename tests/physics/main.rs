//! Physics against oracles that do not share code with the solver. One target, so it links once.
#![allow(
    clippy::print_stdout,
    reason = "tables are what some of these tests are read for"
)]

#[path = "../../benches/closures/augmented.rs"]
#[allow(dead_code, reason = "the benchmark also counts")]
mod augmented;
mod augmented_lagrangian;
mod closed_forms;
mod closing;
mod conditions;
mod contact;
mod crack_front;
mod dice;
mod estimate;
mod families;
mod friction;
mod geometries;
mod junctions;
mod kinks;
mod linear_solvers;
mod load_paths;
mod loops;
mod manufactured;
mod networks;
mod newton;
mod oracles;
mod oscillation;
mod patch;
#[path = "../../benches/closures/pressed.rs"]
#[allow(dead_code, reason = "the benchmark has another scene")]
mod pressed;
mod random_networks;
mod scenes;
mod sphere;
mod spherical_joint;
mod split_nodes;
mod stability;
mod stiff_limit;
#[path = "../../benches/stability/studies/mod.rs"]
#[allow(dead_code, reason = "the benchmark also writes what the studies say")]
mod studies;
mod tangent;
mod torture;
mod voigt;
