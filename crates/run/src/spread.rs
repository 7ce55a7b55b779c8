//! How far the values of a field lie apart.

use serde::{Deserialize, Serialize};

/// Smallest, area-weighted mean and largest value of a field over a fracture.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    /// Smallest.
    pub min: f64,
    /// Mean.
    pub mean: f64,
    /// Largest.
    pub max: f64,
}
