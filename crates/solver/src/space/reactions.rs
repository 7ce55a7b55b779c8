//! Reactions of walls that can only push, by non-negative least squares (Lawson and Hanson 1974,
//! ch. 23).
//!
//! ```text
//! min |w + sum r_i a_i|,  r_i >= 0
//! ```
//!
//! The minimum is the projection of `w` onto the cone `a_i . v >= 0` (Moreau 1962). A sweep over
//! one wall after the other converges to it as well, but by the square of the sine of the angle
//! between two of them: hardly at all in the tip of a wedge.

use faer::Mat;
use faer::linalg::solvers::SolveLstsq;

use super::rigid_modes::dot;
use kluft_algebra::dense_kernels::apart;

/// Closing of a wall, against the forces, that counts as none.
const NO_CLOSING: f64 = 1e-10;
/// The same, of walls that others are hardly told from.
const ROUNDING: f64 = 1e-7;
/// Changes of the walls that react, for each component of the forces and once more, before the
/// search ends.
const MOST_CHANGES: usize = 40;

/// Forces, and the walls that stop them.
pub(super) struct Reactions<'a> {
    /// Unit vectors along which each wall opens.
    pub(super) openings: &'a [Vec<f64>],
    /// What is pushed (N).
    pub(super) forces: &'a [f64],
}

impl Reactions<'_> {
    /// The reaction of each wall (N, none negative), and what all of them leave of the forces (N);
    /// none if rounding keeps walls from being told apart.
    pub(super) fn find(&self) -> Option<(Vec<f64>, Vec<f64>)> {
        let size = dot(self.forces, self.forces).sqrt();
        let mut reactions = vec![0.0; self.openings.len()];
        let mut reacting = Vec::new();
        let mut passed_over = Vec::new();
        let mut rest = self.forces.to_vec();
        for _ in 0..MOST_CHANGES * (1 + self.forces.len()) {
            let closing = |wall: usize| -dot(&self.openings[wall], &rest);
            let others = (0..reactions.len())
                .filter(|wall| !reacting.contains(wall) && !passed_over.contains(wall));
            let most = others.max_by(|&a, &b| closing(a).total_cmp(&closing(b)));
            let Some(most) = most.filter(|&wall| closing(wall) > NO_CLOSING * size) else {
                let left = passed_over.iter().map(|&wall| closing(wall));
                let left = left.fold(0.0, f64::max);
                return (left <= ROUNDING * size).then_some((reactions, rest));
            };
            let before = (reactions.clone(), reacting.clone());
            reacting.push(most);
            self.settle(&mut reacting, &mut reactions);
            if reacting.contains(&most) {
                passed_over.clear();
                rest = self.rest(&reactions);
            } else {
                // Lawson and Hanson's test: by rounding it would pull at once.
                (reactions, reacting) = before;
                passed_over.push(most);
            }
        }
        None
    }

    /// Least squares of the reacting walls; those that would pull are let go.
    fn settle(&self, reacting: &mut Vec<usize>, reactions: &mut [f64]) {
        while !reacting.is_empty() {
            let free = self.unconstrained(reacting);
            let pairs = || std::iter::zip(reacting.iter(), &free);
            let shares = pairs()
                .filter(|(_, wanted)| **wanted <= 0.0)
                .map(|(&wall, wanted)| (wall, reactions[wall] / (reactions[wall] - wanted)));
            let first = shares.min_by(|a, b| a.1.total_cmp(&b.1));
            let share = first.map_or(1.0, |(_, share)| share);
            for (&wall, wanted) in pairs() {
                reactions[wall] += share * (wanted - reactions[wall]);
            }
            let Some((wall, _)) = first else { return };
            reactions[wall] = 0.0;
            reacting.retain(|&other| other != wall);
        }
    }

    /// Reactions of some walls that may pull, by least squares.
    fn unconstrained(&self, walls: &[usize]) -> Vec<f64> {
        let count = self.forces.len();
        let columns = Mat::from_fn(count, walls.len(), |i, j| self.openings[walls[j]][i]);
        let right = Mat::from_fn(count, 1, |i, _| -self.forces[i]);
        let solution = apart(|| columns.qr().solve_lstsq(&right));
        (0..walls.len()).map(|j| solution[(j, 0)]).collect()
    }

    fn rest(&self, reactions: &[f64]) -> Vec<f64> {
        let mut rest = self.forces.to_vec();
        for (opening, reaction) in self.openings.iter().zip(reactions) {
            if *reaction > 0.0 {
                let entries = rest.iter_mut().zip(opening);
                entries.for_each(|(entry, opening)| *entry += reaction * opening);
            }
        }
        rest
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a projection onto a cone is told by (Karush, Kuhn and Tucker): it opens no wall
    /// negatively, walls only push, and those that do are not opened.
    fn assert_projects(openings: &[Vec<f64>], forces: &[f64]) -> Vec<f64> {
        let found = Reactions { openings, forces }.find();
        let (reactions, rest) = found.expect("walls told apart");
        let size = dot(forces, forces).sqrt();
        let most = reactions.iter().fold(size, |most, own| most.max(*own));
        for (opening, reaction) in openings.iter().zip(&reactions) {
            let opened = dot(opening, &rest);
            assert!(*reaction >= 0.0 && opened >= -1e-9 * size, "{rest:?}");
            assert!(reaction * opened <= 1e-9 * most * size, "{rest:?}");
        }
        let sum = |i: usize| -> f64 {
            let all = openings.iter().zip(&reactions);
            forces[i] + all.map(|(own, reaction)| reaction * own[i]).sum::<f64>()
        };
        for (i, entry) in rest.iter().enumerate() {
            assert!((entry - sum(i)).abs() <= 1e-9 * most, "{rest:?}");
        }
        rest
    }

    #[test]
    fn a_wedge_of_any_angle_stops_what_is_pushed_into_its_tip() {
        for degrees in [30.0, 5.0, 1.0, 0.01] {
            let (sine, cosine) = f64::to_radians(degrees).sin_cos();
            let openings = [vec![sine, cosine], vec![sine, -cosine]];
            let rest = assert_projects(&openings, &[-3.0, 0.2]);
            assert!(dot(&rest, &rest).sqrt() < 1e-9, "{degrees}: {rest:?}");
            // What moves out of it is not stopped, what moves across slides along one wall.
            assert_eq!(assert_projects(&openings, &[2.0, 0.0]), [2.0, 0.0]);
            let slides = assert_projects(&openings, &[0.0, 1.0]);
            assert!((dot(&slides, &slides).sqrt() - sine).abs() < 1e-9);
        }
    }

    #[test]
    fn many_walls_stop_forces_as_a_projection_onto_their_cone_does() {
        // A multiplicative sequence (Lehmer), so that the same cones are tried everywhere.
        let mut state = 17_u64;
        let mut next = || {
            state = state * 48_271 % 2_147_483_647;
            state as f64 / 1_073_741_823.5 - 1.0
        };
        for (count, walls) in [(1, 3), (3, 2), (3, 8), (6, 30), (12, 40)] {
            for _ in 0..50 {
                let mut unit = || {
                    let entries: Vec<f64> = (0..count).map(|_| next()).collect();
                    let size = dot(&entries, &entries).sqrt();
                    entries.iter().map(|entry| entry / size).collect()
                };
                let openings: Vec<Vec<f64>> = (0..walls).map(|_| unit()).collect();
                assert_projects(&openings, &unit());
                let alike: Vec<Vec<f64>> = openings.iter().chain(&openings).cloned().collect();
                assert_projects(&alike, &unit());
            }
        }
    }
}
