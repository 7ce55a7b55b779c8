//! Where fractures and faces of the domain meet, as points and edges that they share.
//!
//! `points` merges points, `segments` finds outlines and traces, `crossings` cuts them where they
//! cross, `sheet` is one surface by its points, `arrange` puts all together. `collapse` removes
//! what is too small for cells: each `change` of surfaces around one point, which `place` puts on
//! all their planes, is tried before it is made. `faces` splits a surface along closed loops.

mod arrange;
mod change;
mod collapse;
mod crossings;
mod faces;
mod place;
mod points;
mod segments;
mod sheet;
#[cfg(test)]
mod tests;

pub use arrange::Arrangement;
pub use collapse::{Moved, collapse};
pub use faces::{Face, faces};
pub use sheet::{Plane, Sheet};
