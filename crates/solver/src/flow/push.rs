//! How the pressures of a flow push on the walls: the sparse matrix `B` between pressures and
//! unknowns.
//!
//! Facets are integrated at their nodes, so nearly every unknown is pushed by the pressure of its
//! own node alone, whatever the number of facets around it.

use glam::DVec3;
use kluft_algebra::{Lists, add_at};
use rayon::prelude::*;

use super::wall_points::WallPoints;
use crate::assembly::interface::Interface;

/// Forces on the unknowns of an interface under pressures of the nodes of a flow.
#[derive(Debug, Clone)]
pub(super) struct Push {
    /// Unknowns that move facet points, ascending.
    unknowns: Vec<u32>,
    /// Of each of them the rows of the flow that push it.
    rows: Lists,
    /// The force of a unit pressure (N/Pa), of each of these.
    forces: Vec<DVec3>,
}

impl Push {
    /// That of the pressures at the facet points of an interface.
    pub(super) fn of(interface: &Interface, points: &WallPoints) -> Self {
        let numbers = (0..interface.unknowns().len()).into_par_iter();
        let entries: Vec<Vec<(u32, DVec3)>> = numbers
            .map(|number| entries(interface, points, number))
            .collect();
        let rows: Vec<Vec<u32>> = entries
            .iter()
            .map(|entries| entries.iter().map(|(row, _)| *row).collect())
            .collect();
        Self {
            unknowns: interface.unknowns().to_vec(),
            rows: Lists::collect(&rows),
            forces: entries.iter().flatten().map(|(_, force)| *force).collect(),
        }
    }

    /// Adds the forces (N) under the pressures of the rows (Pa) to those on all unknowns.
    pub(super) fn add(&self, of_row: impl Fn(usize) -> f64 + Sync, forces: &mut [DVec3]) {
        let sum = |number: usize| {
            let range = self.rows.offset[number]..self.rows.offset[number + 1];
            let entries = self.rows.entries[range.clone()].iter();
            let pairs = entries.zip(&self.forces[range]);
            pairs
                .map(|(&row, force)| of_row(row as usize) * *force)
                .sum()
        };
        add_at(&self.unknowns, sum, forces);
    }
}

/// Rows that push an unknown, ascending, and the force of a unit pressure in each.
fn entries(interface: &Interface, points: &WallPoints, number: usize) -> Vec<(u32, DVec3)> {
    let pushes = interface.pushes(number);
    let mut single: Vec<(u32, DVec3)> = pushes
        .flat_map(|(point, force)| {
            let rows = points.rows_at(point);
            rows.map(move |(row, share)| (row as u32, share * force))
        })
        .collect();
    single.sort_by_key(|(row, _)| *row);
    let mut merged: Vec<(u32, DVec3)> = Vec::new();
    for (row, force) in single {
        match merged.last_mut() {
            Some((last, sum)) if *last == row => *sum += force,
            _ => merged.push((row, force)),
        }
    }
    merged
}
