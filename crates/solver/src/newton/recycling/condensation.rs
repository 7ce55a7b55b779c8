//! The principal directions of the recycled space (proper orthogonal decomposition).

use glam::DVec3;
use kluft_algebra::largest;

use super::space::{MOST_DIRECTIONS, PRINCIPAL_DIRECTIONS, RecycledSpace};
use crate::newton::dense;
use crate::newton::facet_points;
use crate::problem::Load;
use crate::system::{State, System};

/// Factor by which each correction counts less than the next.
const FADING: f64 = 0.95;

impl RecycledSpace {
    /// Replaces the directions, once there are too many, by the principal ones of the last
    /// corrections, by their energy on the tangent at a state.
    pub(in crate::newton) fn condense(&mut self, system: &System<'_>, state: &State) {
        if self.directions.len() <= MOST_DIRECTIONS {
            return;
        }
        let scale = self.energy_norms(system, state);
        let scaled = |correction: &Vec<f64>| -> Vec<f64> {
            let pairs = correction.iter().zip(&scale);
            let mut scaled: Vec<f64> = pairs.map(|(c, s)| c * s).collect();
            scaled.resize(scale.len(), 0.0);
            scaled
        };
        let corrections: Vec<Vec<f64>> = self.corrections.iter().map(scaled).collect();
        let axes = dense::principal_axes(&corrections, FADING, PRINCIPAL_DIRECTIONS);
        let direction = |axis: &Vec<f64>| -> Vec<DVec3> {
            let weights: Vec<f64> = axis.iter().zip(&scale).map(|(a, s)| a / s).collect();
            self.combination(&weights, state.unknowns.len())
        };
        let directions: Vec<Vec<DVec3>> = axes.iter().map(direction).collect();
        let along = |correction: &Vec<f64>| -> Vec<f64> {
            let axes = axes.iter();
            axes.map(|axis| axis.iter().zip(correction).map(|(a, c)| a * c).sum())
                .collect()
        };
        self.corrections = corrections.iter().map(along).collect();
        self.replace_directions(system, directions);
    }

    /// Norms of the directions by the energy of the tangent at a state.
    fn energy_norms(&self, system: &System<'_>, state: &State) -> Vec<f64> {
        let tangents = facet_points::tangents(system, state);
        let stiffness = facet_points::interface(system).stiffness(&tangents.exact);
        let matrix = self.tangent(system, &stiffness, true);
        let norm = |i: usize| matrix[(i, i)].max(f64::MIN_POSITIVE).sqrt();
        (0..self.directions.len()).map(norm).collect()
    }

    fn replace_directions(&mut self, system: &System<'_>, directions: Vec<Vec<DVec3>>) {
        self.directions.clear();
        self.known.clear();
        for direction in directions {
            let rock_forces = system.rock_forces(&direction);
            let size = largest(&system.displacements(&direction, &Load::NONE));
            self.add_direction(direction, &rock_forces, size);
        }
    }
}
