//! Physics against oracles that do not share code with the solver. One target, so it links once.

mod newton;
mod scenes;
