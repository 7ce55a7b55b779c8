//! Where fractures and faces of the domain meet, as points and edges that they share.
//!
//! `points` merges points, `segments` finds outlines and traces, `crossings` cuts them where they
//! cross, `sheet` is one surface by its points, `arrange` puts all together.

mod arrange;
mod crossings;
mod points;
mod segments;
mod sheet;
#[cfg(test)]
mod tests;

pub use arrange::Arrangement;
pub use sheet::{Plane, Sheet};
