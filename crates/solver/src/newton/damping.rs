//! Damping of walls that nothing holds (Levenberg 1944, Marquardt 1963).
//!
//! Before a contact closes, or once a fracture has let go, a linear solve moves blocks as far as
//! next to nothing holds them: far beyond the gap that would have stopped them, and to another
//! equilibrium than the one that the loads lead to. An iterate that does so is taken back and
//! solved for with springs on all facet points, a share of the stiffness of the rock beside them.
//! They enter the matrix only and no balance.

/// Share while nothing overshoots: walls that nothing holds at all have a tangent too.
pub(super) const LEAST: f64 = 1e-6;
/// Share that holds walls like rock.
const LARGEST: f64 = 1.0;
/// Factor from one share to the next.
const FACTOR: f64 = 100.0;

/// The share to take after an iterate that overshoots; none if that was the largest.
pub(super) fn stronger(damping: f64) -> Option<f64> {
    (damping < LARGEST).then(|| (FACTOR * damping).min(LARGEST))
}

/// The share to take after one that does not.
pub(super) fn weaker(damping: f64) -> f64 {
    (damping / FACTOR).max(LEAST)
}
