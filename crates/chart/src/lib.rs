//! Charts as SVG: lines and points over linear or logarithmic axes, with what failed at the edge.
//!
//! Every colour stands out from white and from dark pages alike, by a style sheet that follows the
//! viewer's scheme, and the background is transparent.

mod axis;
mod chart;
mod drawing;
mod names;
mod notes;
mod style;

pub use axis::{Axis, Scale};
pub use chart::{Band, Chart, Rate, Series, front};

#[cfg(test)]
mod tests;
