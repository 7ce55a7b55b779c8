//! The block of the tangent that belongs to the jumps: small, sparse, factorised for each tangent.

use glam::{DMat3, DVec3};
use rayon::prelude::*;

use super::ordering::nested_dissection;
use super::{Analysis, Cholesky, LinearFailure};
use crate::multigrid::{BlockRows, OwnedBlockRows};
use crate::system::System;

/// The jumps' own block of the tangent, and what couples it to the rock.
pub(super) struct JumpBlock {
    /// Unknowns that facet points move with, ascending.
    unknowns: Vec<u32>,
    /// Their block of the stiffness of the rock.
    rock: OwnedBlockRows,
    cholesky: Option<Cholesky>,
    /// Where the blocks of the fractures belong in it: block row, number of the block in it.
    places: Vec<(usize, usize)>,
    coupling: Vec<CoupledRow>,
}

/// What couples an unknown of the rock to the jumps.
struct CoupledRow {
    /// Number among the unknowns of the rock.
    row: u32,
    /// Numbers among the jumps, and addresses of the blocks.
    jumps: Vec<(u32, usize)>,
}

impl JumpBlock {
    /// Collects and orders the block; `rock` are the other unknowns, ascending.
    ///
    /// # Errors
    /// If the ordering or the analysis fails.
    pub(super) fn of(system: &System<'_>, rock: &[u32]) -> Result<Self, LinearFailure> {
        let unknowns = system.discretisation.interface.unknowns.clone();
        let rows = system.rock_rows();
        let own = rows.sub_block(&unknowns);
        let coupling = coupling(rows, rock, &unknowns);
        let cholesky = if unknowns.is_empty() {
            None
        } else {
            let order = nested_dissection(unknowns.len(), |row| {
                own.view()
                    .row(row)
                    .map(|(column, _)| column)
                    .collect::<Vec<_>>()
                    .into_iter()
            })?;
            let analysis = Analysis::of(&own.row_offset, &own.columns, order)?;
            Some(Cholesky::new(analysis, own.view()))
        };
        Ok(Self {
            places: places(system, &own),
            rock: own,
            unknowns,
            cholesky,
            coupling,
        })
    }

    pub(super) fn unknowns(&self) -> &[u32] {
        &self.unknowns
    }

    /// Factorises the block with the stiffness of the fractures.
    ///
    /// # Errors
    /// If it is not positive definite or memory runs out.
    pub(super) fn factorise(
        &mut self,
        system: &System<'_>,
        stiffness: &[DMat3],
    ) -> Result<(), LinearFailure> {
        let Some(cholesky) = &mut self.cholesky else {
            return Ok(());
        };
        for (&(row, place), block) in self.places.iter().zip(stiffness) {
            let rock = self.rock.blocks[self.rock.row_offset[row] + place];
            cholesky.set_block(row, place, rock + *block);
        }
        let unknowns = &system.discretisation.interface.unknowns;
        cholesky.factorise().map_err(|failure| match failure {
            LinearFailure::Indefinite(jump) => LinearFailure::Indefinite(unknowns[jump] as usize),
            other => other,
        })
    }

    /// Solves for forces on the jumps (N).
    pub(super) fn solve(&self, right: &[DVec3]) -> Vec<DVec3> {
        let cholesky = self.cholesky.as_ref();
        cholesky.map_or(Vec::new(), |cholesky| cholesky.solve(right))
    }

    /// The jumps' entries of a vector over all unknowns.
    pub(super) fn gather(&self, vector: &[DVec3]) -> Vec<DVec3> {
        let entries = self.unknowns.iter();
        entries.map(|&unknown| vector[unknown as usize]).collect()
    }

    /// Forces that `vector` over all unknowns causes on the jumps (N), by the rock alone.
    pub(super) fn forces_of(&self, rows: BlockRows<'_>, vector: &[DVec3]) -> Vec<DVec3> {
        let force = |&unknown: &u32| {
            let row = rows.row(unknown as usize);
            row.map(|(column, block)| *block * vector[column as usize])
                .sum()
        };
        self.unknowns.par_iter().map(force).collect()
    }

    /// Subtracts the forces that `jumps` cause from those on the unknowns of the rock (N).
    pub(super) fn subtract_from_rock(
        &self,
        rows: BlockRows<'_>,
        jumps: &[DVec3],
        forces: &mut [DVec3],
    ) {
        let sums: Vec<DVec3> = self
            .coupling
            .par_iter()
            .map(|coupled| {
                let terms = coupled.jumps.iter();
                terms
                    .map(|&(jump, address)| rows.blocks[address] * jumps[jump as usize])
                    .sum()
            })
            .collect();
        for (coupled, sum) in self.coupling.iter().zip(sums) {
            forces[coupled.row as usize] -= sum;
        }
    }
}

fn coupling(rows: BlockRows<'_>, rock: &[u32], jumps: &[u32]) -> Vec<CoupledRow> {
    let mut number = vec![u32::MAX; rows.rows()];
    for (index, &jump) in jumps.iter().enumerate() {
        number[jump as usize] = index as u32;
    }
    let coupled = |(index, &unknown): (usize, &u32)| {
        let range = rows.row_offset[unknown as usize]..rows.row_offset[unknown as usize + 1];
        let jumps: Vec<(u32, usize)> = range
            .map(|address| (number[rows.columns[address] as usize], address))
            .filter(|(jump, _)| *jump != u32::MAX)
            .collect();
        (!jumps.is_empty()).then_some(CoupledRow {
            row: index as u32,
            jumps,
        })
    };
    rock.par_iter().enumerate().filter_map(coupled).collect()
}

fn places(system: &System<'_>, own: &OwnedBlockRows) -> Vec<(usize, usize)> {
    let interface = &system.discretisation.interface;
    let unknowns = &interface.unknowns;
    let number = |unknown: u32| unknowns.partition_point(|&other| other < unknown) as u32;
    (0..unknowns.len())
        .flat_map(|row| {
            let columns = &own.columns[own.row_offset[row]..own.row_offset[row + 1]];
            let blocks = interface.columns.of(row).iter();
            blocks.map(move |&column| {
                let column = number(column);
                (row, columns.partition_point(|&other| other < column))
            })
        })
        .collect()
}
