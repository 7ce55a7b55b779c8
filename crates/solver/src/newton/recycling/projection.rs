//! Vectors and matrices of the system in the recycled space.

use faer::Mat;
use glam::{DMat3, DVec3};
use kluft_algebra::dot;
use rayon::prelude::*;

use super::space::RecycledSpace;
use crate::assembly::interface::Interface;
use crate::linear::Tangents;
use crate::newton::facet_points::{self, interface};
use crate::system::{State, System};

impl RecycledSpace {
    /// `v_i . K v_j` (J).
    fn energy(&self, i: usize, j: usize) -> f64 {
        self.known[i.max(j)].energies[i.min(j)]
    }

    /// `V^T K V c` (J).
    pub(super) fn rock_forces(&self, coefficients: &[f64]) -> Vec<f64> {
        let terms = |i: usize| coefficients.iter().enumerate().map(move |(j, c)| (i, j, c));
        (0..coefficients.len())
            .map(|i| terms(i).map(|(i, j, c)| self.energy(i, j) * c).sum())
            .collect()
    }

    /// The tangent in the space, `V^T (K + fractures) V` (J), with these blocks of the fractures;
    /// they may be said to be symmetric, which halves the work.
    pub(super) fn tangent(
        &self,
        system: &System<'_>,
        stiffness: &[DMat3],
        is_symmetric: bool,
    ) -> Mat<f64> {
        let interface = interface(system);
        let jumps: Vec<Vec<DVec3>> = self
            .directions
            .par_iter()
            .map(|v| of_fractures(interface, v))
            .collect();
        let columns = self.directions.par_iter().enumerate();
        let images: Vec<Vec<f64>> = columns
            .map(|(j, v)| {
                let image = interface.resistance(stiffness, v);
                let count = if is_symmetric { j + 1 } else { jumps.len() };
                jumps[..count].iter().map(|own| dot(own, &image)).collect()
            })
            .collect();
        Mat::from_fn(jumps.len(), jumps.len(), |i, j| {
            let (row, column) = if is_symmetric {
                (i.min(j), i.max(j))
            } else {
                (i, j)
            };
            self.energy(i, j) + images[column][row]
        })
    }

    /// Forces of the fractures on the tangent planes of the laws, `V^T fractures` (J).
    pub(super) fn fracture_forces(
        &self,
        system: &System<'_>,
        state: &State,
        tangents: &Tangents,
    ) -> Vec<f64> {
        let interface = interface(system);
        let tractions = facet_points::linearised_tractions(system, state, tangents);
        let mut forces = vec![DVec3::ZERO; state.unknowns.len()];
        interface.add_forces(&tractions, 1.0, &mut forces);
        let directions = self.directions.par_iter();
        directions
            .map(|v| {
                let unknowns = interface.unknowns.iter().map(|&unknown| unknown as usize);
                unknowns
                    .map(|unknown| v[unknown].dot(forces[unknown]))
                    .sum()
            })
            .collect()
    }

    /// `V c`, on the unknowns that move facet points only (m).
    pub(super) fn combined_on_fractures(
        &self,
        system: &System<'_>,
        coefficients: &[f64],
    ) -> Vec<DVec3> {
        let mut combined = vec![DVec3::ZERO; system.discretisation.points.len()];
        for &unknown in &interface(system).unknowns {
            combined[unknown as usize] = self.combined(coefficients, unknown as usize);
        }
        combined
    }

    /// `V^T f` for forces `f` (N): the work that they do (J).
    pub(super) fn projected(&self, forces: &[DVec3]) -> Vec<f64> {
        let directions = self.directions.par_iter();
        directions.map(|v| dot(v, forces)).collect()
    }

    /// `V c`, on all unknowns (m), of which there are so many.
    pub(super) fn combination(&self, coefficients: &[f64], unknowns: usize) -> Vec<DVec3> {
        let entries = (0..unknowns).into_par_iter();
        entries.map(|i| self.combined(coefficients, i)).collect()
    }

    /// Entry of `V c` (m).
    pub(super) fn combined(&self, coefficients: &[f64], entry: usize) -> DVec3 {
        let directions = self.directions.iter().zip(coefficients);
        directions.map(|(v, c)| *c * v[entry]).sum()
    }
}

/// The part of a vector that moves facet points.
fn of_fractures(interface: &Interface, vector: &[DVec3]) -> Vec<DVec3> {
    let unknowns = interface.unknowns.iter();
    unknowns.map(|&unknown| vector[unknown as usize]).collect()
}
