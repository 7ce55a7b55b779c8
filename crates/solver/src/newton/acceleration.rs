//! Anderson's acceleration (Anderson 1965; Walker and Ni 2011) of the splitting of rock and laws.
//!
//! With `q = t + rho w` at the facet points the splitting repeats `q' = F(q)`, and
//! `F(q) - q = rho (B y - w)`. Where walls travel far before they touch, or rock turns that hardly
//! resists, it takes many small steps in one direction. Of the last iterates the combination is
//! taken whose residuals cancel best:
//!
//! ```text
//! q' = F(q) - sum_j c_j (F_j - F_{j-1}),     |r - sum_j c_j (r_j - r_{j-1})| smallest
//! ```
//!
//! Residuals are weighed by the energy that they stand for. Where they grow, it begins anew.

use std::collections::VecDeque;

use faer::Mat;
use glam::DVec3;
use kluft_algebra::{dot, norm};

use super::dense;
use super::facet_points::interface;
use crate::system::{State, System};

/// Iterates that are combined.
const MEMORY: usize = 8;
/// Growth of the residual after which former iterates tell nothing of the present one: a wall has
/// begun or ceased to touch or to slide.
const GROWTH: f64 = 2.0;

/// The last iterates of a splitting.
#[derive(Debug, Clone, Default)]
pub(super) struct Acceleration {
    last: Option<Mapped>,
    /// Differences between iterates, the latest first.
    differences: VecDeque<Mapped>,
}

/// An iterate: what the splitting makes of it.
#[derive(Debug, Clone)]
struct Mapped {
    /// `F(q)` (Pa).
    image: Vec<DVec3>,
    /// `F(q) - q` (Pa), weighed.
    residual: Vec<DVec3>,
}

impl Acceleration {
    /// What to add to the tractions (Pa) of the state before the laws are balanced, after the rock
    /// has been solved and moved the walls by `changes` (m).
    pub(super) fn advance(
        &mut self,
        system: &System<'_>,
        state: &State,
        changes: &[DVec3],
    ) -> Vec<DVec3> {
        self.after(Mapped::of(system, state, changes))
    }

    /// What to add to the image of an iterate.
    fn after(&mut self, here: Mapped) -> Vec<DVec3> {
        let mut advance = vec![DVec3::ZERO; here.image.len()];
        if let Some(last) = self.last.take() {
            if here.size() > GROWTH * last.size() {
                self.differences.clear();
            } else {
                self.differences.truncate(MEMORY - 1);
                self.differences.push_front(here.beyond(&last));
            }
        }
        for (share, difference) in std::iter::zip(self.shares(&here), &self.differences) {
            for (entry, image) in advance.iter_mut().zip(&difference.image) {
                *entry -= share * *image;
            }
        }
        self.last = Some(here);
        advance
    }

    /// Of each difference, what of it leaves the smallest residual.
    fn shares(&self, here: &Mapped) -> Vec<f64> {
        let count = self.differences.len();
        if count == 0 {
            return Vec::new();
        }
        let between = |i: usize, j: usize| {
            let [a, b] = [i, j].map(|k| &self.differences[k].residual);
            dot(a, b)
        };
        let matrix = Mat::from_fn(count, count, between);
        let differences = self.differences.iter();
        let right: Vec<f64> = differences
            .map(|difference| dot(&difference.residual, &here.residual))
            .collect();
        dense::solve(matrix, &right).unwrap_or_default()
    }
}

impl Mapped {
    fn of(system: &System<'_>, state: &State, changes: &[DVec3]) -> Self {
        let points = interface(system).points.iter().zip(&state.facet_points);
        let (image, residual) = points
            .zip(changes)
            .map(|((point, state), change)| {
                if system.law(point).is_linear() {
                    return (DVec3::ZERO, DVec3::ZERO);
                }
                let beyond = state.jump_residual + *change;
                let joint = &state.joint;
                let jump = joint.separation.opening * point.normal + joint.slip + beyond;
                let image = joint.traction(point.normal) + point.spring * jump;
                let weight = (point.area.max(0.0) * point.spring).sqrt();
                (image, weight * beyond)
            })
            .unzip();
        Self { image, residual }
    }

    fn size(&self) -> f64 {
        norm(&self.residual)
    }

    fn beyond(&self, other: &Self) -> Self {
        let difference = |a: &[DVec3], b: &[DVec3]| a.iter().zip(b).map(|(a, b)| *a - *b).collect();
        Self {
            image: difference(&self.image, &other.image),
            residual: difference(&self.residual, &other.residual),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Iterates that close in on `end` by shares of their own: one that hardly moves among them.
    const SHARES: DVec3 = DVec3::new(0.5, 0.1, 1e-3);

    fn map(at: DVec3, end: DVec3) -> Mapped {
        let residual = SHARES * (end - at);
        Mapped {
            image: vec![at + residual],
            residual: vec![residual],
        }
    }

    /// Three directions are known after a few differences: the slowest share alone would take
    /// seven thousand iterations to a thousandth.
    #[test]
    fn slow_directions_are_taken_at_once() {
        let end = DVec3::new(1.0, -2.0, 3.0);
        let (mut accelerated, mut at) = (Acceleration::default(), DVec3::ZERO);
        for _ in 0..6 {
            let here = map(at, end);
            at = here.image[0] + accelerated.after(here)[0];
        }
        assert!(at.distance(end) < 1e-6, "{at}");
    }

    /// What former iterates told is forgotten where the map becomes another.
    #[test]
    fn it_begins_anew_where_residuals_grow() {
        let (near, far) = (DVec3::ONE, DVec3::new(-4.0, 50.0, 9.0));
        let (mut accelerated, mut at) = (Acceleration::default(), DVec3::ZERO);
        for _ in 0..3 {
            let here = map(at, near);
            at = here.image[0] + accelerated.after(here)[0];
        }
        let there = map(at, far);
        assert_eq!(accelerated.after(there), [DVec3::ZERO]);
    }
}
