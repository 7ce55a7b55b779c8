//! Methods to compare with, none of which the program has.

pub mod augmented_lagrangian;
pub mod split_nodes;
pub mod treatments;
mod voigt;
