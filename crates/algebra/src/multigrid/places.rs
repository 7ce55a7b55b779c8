//! Where nodes are, told by their rigid motions, and which of them are near.

use glam::{DMat3, DVec3};
use rayon::prelude::*;

use crate::small::Modes;
use crate::vectors::trace;

/// Neighbours further away than so many times the nearest one are far.
const FAR: f64 = 2.5;
/// Cosine of the angle between directions beyond which they are one.
const PARALLEL: f64 = 0.9;
/// Determinant below which motions do not tell a place, of a unit trace.
const SINGULAR: f64 = 1e-6;

/// Places of nodes; none where the motions do not tell it, as on supports.
pub(super) struct Places(Vec<Option<DVec3>>);

/// Which nodes are near to one.
pub(super) struct Near<'p> {
    places: &'p Places,
    node: usize,
    /// Distance up to which they are.
    reach: f64,
}

impl Places {
    /// Places of nodes with these modes.
    pub(super) fn of<const N: usize>(modes: &[Modes<N>]) -> Self {
        Self(modes.par_iter().map(place).collect())
    }

    /// The way from a node to another; none if a place is not known.
    fn way(&self, node: usize, other: usize) -> DVec3 {
        match (self.0[node], self.0[other]) {
            (Some(from), Some(to)) => to - from,
            _ => DVec3::ZERO,
        }
    }

    /// Which of its neighbours are near to a node: across slender cells the others are not. Where
    /// the near ones lie on a line with it, as across flat cells, all are.
    pub(super) fn near<I: Iterator<Item = usize>>(
        &self,
        node: usize,
        neighbours: impl Fn() -> I,
    ) -> Near<'_> {
        let ways = || neighbours().map(|at| self.way(node, at));
        let lengths = ways().map(DVec3::length).filter(|&length| length > 0.0);
        let reach = FAR * lengths.fold(f64::INFINITY, f64::min);
        let directions = || {
            let near = ways().filter(|way| way.length() <= reach);
            near.map(DVec3::normalize_or_zero)
        };
        let first = directions().next().unwrap_or_default();
        let is_line = directions().all(|direction| direction.dot(first).abs() > PARALLEL);
        Near {
            places: self,
            node,
            reach: if is_line { f64::INFINITY } else { reach },
        }
    }
}

impl Near<'_> {
    /// Whether a node is among them.
    pub(super) fn contains(&self, other: usize) -> bool {
        self.places.way(self.node, other).length() <= self.reach
    }
}

/// The place `x` for which `r_k - T (e_k x x)` is least, with the translations `T` and the
/// rotations `r_k` about the axes `e_k`. That of an aggregate is its centre.
fn place<const N: usize>(modes: &Modes<N>) -> Option<DVec3> {
    let (mut matrix, mut rhs) = (DMat3::ZERO, DVec3::ZERO);
    for row in modes {
        let translation = DVec3::new(row[0], row[1], row[2]);
        for (axis, rotation) in [DVec3::X, DVec3::Y, DVec3::Z].iter().zip(&row[3..]) {
            // `t . (e x x) = (t x e) . x`.
            let line = translation.cross(*axis);
            matrix += DMat3::from_cols(line.x * line, line.y * line, line.z * line);
            rhs += *rotation * line;
        }
    }
    let is_known = matrix.determinant() > SINGULAR * trace(matrix).powi(3);
    is_known.then(|| matrix.inverse() * rhs)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::multigrid::rigid_modes;

    /// Modes of a node, one row an unknown.
    fn modes(position: DVec3, free: DMat3) -> Modes<3> {
        let motions = rigid_modes(position, DVec3::ZERO, free);
        std::array::from_fn(|row| motions.map(|motion| motion[row]))
    }

    #[test]
    fn motions_tell_a_place_as_far_as_they_are_free() {
        let position = DVec3::new(1.0, -2.0, 3.0);
        let found = place(&modes(position, DMat3::IDENTITY)).expect("a place");
        assert!((found - position).length() < 1e-12);
        let on_rollers = DMat3::from_diagonal(DVec3::new(0.0, 1.0, 1.0));
        let found = place(&modes(position, on_rollers)).expect("a place");
        assert!((found - position).length() < 1e-12);
        assert_eq!(place(&modes(position, DMat3::ZERO)), None);
    }

    #[test]
    fn the_ends_of_slender_cells_are_far_and_the_sides_of_flat_ones_are_not() {
        let around = |height: f64| {
            let places = [DVec3::ZERO, DVec3::X, DVec3::Y, height * DVec3::Z];
            let of = |place: DVec3| modes(place, DMat3::IDENTITY);
            Places::of(&places.map(of))
        };
        let found = |height: f64| {
            let places = around(height);
            let near = places.near(0, || 1..4);
            [1, 2, 3].map(|node| near.contains(node))
        };
        assert_eq!(found(2.0), [true; 3]);
        assert_eq!(found(4.0), [true, true, false]);
        assert_eq!(found(0.2), [true; 3]);
    }
}
