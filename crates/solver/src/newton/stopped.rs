//! Walls that slide on for a part of an increment, until they stop.
//!
//! At its end they stick, and the laws take walls that stick there to have stuck all along; so do
//! its halves, if they stop early in the first. What friction bears beyond their shear traction
//! tells: 0 at the start, `m_1` in the middle and `m_2` at the end. If it rises so fast that a
//! parabola through the three falls below 0 first, to `-d`, the walls would carry `d` more than
//! they can, had they not slid on:
//!
//! ```text
//! m(t) = b t^2 - a t,   a = (m_2 - 4 m_1) / 2,   b = (m_2 - 2 m_1) / 2,   d = a^2 / (4 b)
//! ```
//!
//! with `t = 1` in the middle. The rock beside them then takes the slip `d / k` to carry it.

use super::facet_points::interface;
use crate::system::{State, System};

/// How far the walls of a facet point slide on (m) in an increment, whose start, middle and end are
/// known.
pub(super) fn slip(system: &System<'_>, states: [&State; 3], i: usize) -> f64 {
    let states = states.map(|state| &state.facet_points[i]);
    if states.map(|state| state.joint.sliding) != [true, false, false] {
        return 0.0;
    }
    let point = &interface(system).points[i];
    let law = system.law(point);
    let [_, middle, end] = states.map(|state| -law.overload(&state.joint, &state.history));
    depth(middle, end) / point.rock_stiffness().shear
}

/// How far a parabola from 0 falls below it before it passes `middle`, which is below 0 by rounding
/// only, and then `end`.
fn depth(middle: f64, end: f64) -> f64 {
    let middle = middle.max(0.0);
    let a = 0.5 * (end - 4.0 * middle);
    let b = 0.5 * (end - 2.0 * middle);
    if a > 0.0 { a * a / (4.0 * b) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parabola_that_falls_first_is_as_deep_as_its_lowest_point() {
        let of = |t: f64| t * t - 0.5 * t;
        assert!((depth(of(1.0), of(2.0)) + of(0.25)).abs() < 1e-15);
        assert_eq!(depth(1.0, 4.0), 0.0);
        assert_eq!(depth(1.0, 1.0), 0.0);
        assert_eq!(depth(0.0, 0.0), 0.0);
        assert_eq!(depth(-1e-12, -2e-12), 0.0);
    }
}
