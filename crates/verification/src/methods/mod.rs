//! Methods to compare with, none of which the program has.

pub mod augmented_lagrangian;
pub mod plain_newton;
pub mod split_nodes;
pub mod treatments;
mod voigt;
