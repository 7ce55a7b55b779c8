//! The recycled space: its directions, and the corrections in it.

use std::sync::Arc;

use glam::DVec3;
use kluft_algebra::dot;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::newton::iterate::{Correction, LastCorrection};

/// Directions that are left when they are condensed.
pub(super) const PRINCIPAL_DIRECTIONS: usize = 12;
/// Most directions that a guess is made of; beyond, they are condensed to the principal ones.
pub(super) const MOST_DIRECTIONS: usize = 24;
/// Corrections that are kept as coefficients.
const KEPT_CORRECTIONS: usize = 48;
/// Directions that the first load step adds, by experience.
const DIRECTIONS_OF_FIRST_STEP: usize = 5;

/// The space.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(in crate::newton) struct RecycledSpace {
    pub(super) directions: Vec<Vec<DVec3>>,
    /// Corrections of the last steps as coefficients of the directions, the latest first; those of
    /// directions that came later are left out.
    pub(super) corrections: Vec<Vec<f64>>,
    /// What is computed once for each direction.
    pub(super) known: Vec<Known>,
}

/// What is known of a direction.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Known {
    /// `v_i . K v_j` (J) for the directions up to it.
    pub(super) energies: Vec<f64>,
    /// Its largest displacement (m).
    pub(super) size: f64,
}

/// Memory that it takes in a run at most, while the principal directions are made (bytes); of so
/// many `increments`, if they are known.
pub(crate) fn bytes(unknowns: usize, increments: Option<usize>) -> usize {
    let most = MOST_DIRECTIONS + PRINCIPAL_DIRECTIONS;
    let added = increments.map(|count| DIRECTIONS_OF_FIRST_STEP + count);
    let directions = added.map_or(most, |added| added.min(most));
    directions * unknowns * size_of::<DVec3>()
}

impl RecycledSpace {
    /// Whether its directions are of this number of unknowns.
    pub(in crate::newton) fn fits(&self, unknowns: usize) -> bool {
        let count = self.directions.len();
        let known = self.known.iter().zip(1..);
        let mut corrections = self.corrections.iter();
        self.directions.iter().all(|v| v.len() == unknowns)
            && corrections.all(|correction| correction.len() <= count)
            && self.known.len() == count
            && known.into_iter().all(|(k, i)| k.energies.len() == i)
    }

    /// Adds the corrections of an increment that converged: its guess, and those after it whose
    /// forces are known.
    pub(in crate::newton) fn add(
        &mut self,
        guess: Option<LastCorrection>,
        corrections: Vec<Arc<Correction>>,
    ) {
        if let Some(guess) = guess {
            self.corrections.insert(0, guess.coefficients);
        }
        for correction in corrections {
            let correction = Arc::unwrap_or_clone(correction);
            let Some(rock_forces) = correction.rock_forces else {
                continue;
            };
            let mut alone = vec![0.0; self.directions.len()];
            alone.push(1.0);
            self.corrections.insert(0, alone);
            self.add_direction(correction.unknowns, &rock_forces, correction.size);
        }
        self.corrections.truncate(KEPT_CORRECTIONS);
    }

    /// Adds a direction `v`, given `K v` (N) and its largest displacement (m).
    pub(super) fn add_direction(
        &mut self,
        direction: Vec<DVec3>,
        rock_forces: &[DVec3],
        size: f64,
    ) {
        self.directions.push(direction);
        let directions = self.directions.par_iter();
        self.known.push(Known {
            energies: directions.map(|other| dot(other, rock_forces)).collect(),
            size,
        });
    }
}
