//! The block of the tangent that belongs to the jumps: small, sparse, new for each tangent.
//!
//! The nodes on the fractures are one layer thick, so the rock itself holds their jumps almost node
//! by node: scaled by its diagonal blocks (one a node), the block has a small condition number
//! whatever the stiffness of the fractures, and a Chebyshev polynomial solves with it well enough
//! for a preconditioner.

use std::ops::Range;

use faer::linalg::solvers::SolveCore;
use faer::linalg::triangular_solve::solve_upper_triangular_in_place;
use faer::{Conj, Mat, Par, Side};
use glam::{DMat3, DVec3};
use rayon::prelude::*;

use super::ordering::nested_dissection;
use super::{Analysis, Cholesky, LinearFailure};
use crate::multigrid::{BlockRows, DROPPED, OwnedBlockRows, numbers};
use crate::system::System;

/// Products with the block in one application.
const DEGREE: usize = 3;
/// Ratio of largest to smallest eigenvalue that the polynomial is made for.
const CONDITION: f64 = 8.0;
/// Steps of the power iteration for the largest eigenvalue, and what it may have missed at first.
const POWER_STEPS: usize = 12;
const POWER_MARGIN: f64 = 1.15;
/// Factor by which the margin grows when it was too small.
const WIDENING: f64 = 1.4;

/// The jumps' own block of the tangent, and what couples it to the rock.
pub(super) struct JumpBlock {
    /// Unknowns that facet points move with, ascending.
    unknowns: Vec<u32>,
    /// Their block of the stiffness of the rock.
    rock: Vec<DMat3>,
    /// Their block of the tangent.
    tangent: OwnedBlockRows,
    /// Where the blocks of the fractures belong in it.
    places: Vec<usize>,
    /// The unknowns of each node.
    nodes: Vec<Range<usize>>,
    /// Node of each unknown, as an index into `nodes`.
    node_of: Vec<u32>,
    /// Rows of the inverse of the diagonal block of each node, one behind the other.
    inverses: Vec<DMat3>,
    /// Start of each unknown's row among them.
    inverse_offset: Vec<usize>,
    largest_eigenvalue: f64,
    /// Factor on the result of the power iteration.
    margin: f64,
    /// The block factorised, where laws have kinks: tangents next to each other may then differ by any
    /// factor, and what is not symmetric feeds on the error of a polynomial.
    factor: Option<Cholesky>,
    coupling: Vec<CoupledRow>,
}

/// What couples an unknown of the rock to the jumps.
struct CoupledRow {
    /// Number among the unknowns of the rock.
    row: u32,
    /// Numbers among the jumps, and addresses of the blocks.
    jumps: Vec<(u32, usize)>,
}

/// The diagonal block `D = L L^T` of a node.
struct NodeFactor {
    /// `D^-1`, row by row.
    inverse: Vec<DMat3>,
    /// `L^-T z` with signs `z`: a start vector with equal energy in stiff and soft directions, so that
    /// a power iteration does not take the largest stiffness for the largest eigenvalue.
    start: Vec<DVec3>,
}

/// A fixed pattern of signs without a short period.
fn sign(index: usize) -> f64 {
    if (index * index * 7919 + index * 13) % 101 < 50 {
        1.0
    } else {
        -1.0
    }
}

impl JumpBlock {
    /// Collects the block; `rock` are the other unknowns, ascending.
    ///
    /// # Errors
    /// If the ordering or the analysis of a factor fails.
    pub(super) fn of(system: &System<'_>, rock: &[u32]) -> Result<Self, LinearFailure> {
        let unknowns = system.discretisation.interface.unknowns.clone();
        let rows = system.rock_rows();
        let own = rows.sub_block(&unknowns);
        let node = |index: usize| system.discretisation.points.node[unknowns[index] as usize];
        let mut nodes: Vec<Range<usize>> = Vec::new();
        let mut node_of = Vec::with_capacity(unknowns.len());
        for index in 0..unknowns.len() {
            match nodes.last_mut() {
                Some(last) if node(index) == node(index - 1) => last.end += 1,
                _ => nodes.push(index..index + 1),
            }
            node_of.push(nodes.len() as u32 - 1);
        }
        let lengths = node_of.iter().map(|&node| nodes[node as usize].len());
        let inverse_offset = lengths.scan(0, |next, length| {
            *next += length;
            Some(*next - length)
        });
        let factor = if system.is_smooth() {
            None
        } else {
            Some(unfactorised(&own)?)
        };
        Ok(Self {
            factor,
            inverse_offset: inverse_offset.collect(),
            nodes,
            node_of,
            places: places(system, &own),
            coupling: coupling(rows, rock, &unknowns),
            rock: own.blocks.clone(),
            tangent: own,
            inverses: Vec::new(),
            largest_eigenvalue: 1.0,
            margin: POWER_MARGIN,
            unknowns,
        })
    }

    pub(super) fn unknowns(&self) -> &[u32] {
        &self.unknowns
    }

    /// Takes over the stiffness of the fractures.
    ///
    /// # Errors
    /// If the block of a node is not positive definite.
    pub(super) fn update(&mut self, stiffness: &[DMat3]) -> Result<(), LinearFailure> {
        self.tangent.blocks.copy_from_slice(&self.rock);
        for (&place, block) in self.places.iter().zip(stiffness) {
            self.tangent.blocks[place] += *block;
        }
        let factors = self.nodes.par_iter().map(|own| self.factorise(own.clone()));
        let factors = factors.collect::<Result<Vec<_>, _>>()?;
        self.inverses = factors
            .iter()
            .flat_map(|f| f.inverse.iter().copied())
            .collect();
        let start = factors
            .iter()
            .flat_map(|f| f.start.iter().copied())
            .collect();
        self.largest_eigenvalue = self.margin * self.power_iteration(start);
        if let Some(factor) = &mut self.factor {
            for row in 0..self.unknowns.len() {
                for (place, (_, block)) in self.tangent.view().row(row).enumerate() {
                    factor.set_block(row, place, *block);
                }
            }
            let factorised = factor.factorise();
            factorised.map_err(|failure| match failure {
                LinearFailure::Indefinite(row) => {
                    LinearFailure::Indefinite(self.unknowns[row] as usize)
                }
                other => other,
            })?;
        }
        Ok(())
    }

    /// Takes the spectrum for wider than before, because the polynomial turned out not to be positive: a
    /// power iteration misses eigenvectors that live on a few bad cells.
    pub(super) fn widen(&mut self) {
        self.margin *= WIDENING;
        self.largest_eigenvalue *= WIDENING;
    }

    /// The largest eigenvalue as it was found or widened, and the factor on the next one.
    pub(super) fn spectrum(&self) -> (f64, f64) {
        (self.largest_eigenvalue, self.margin)
    }

    /// Takes over what [`Self::spectrum`] told.
    pub(super) fn take_spectrum(&mut self, (largest_eigenvalue, margin): (f64, f64)) {
        (self.largest_eigenvalue, self.margin) = (largest_eigenvalue, margin);
    }

    /// The diagonal block of a node, factorised.
    fn factorise(&self, own: Range<usize>) -> Result<NodeFactor, LinearFailure> {
        let count = own.len();
        let mut block = Mat::<f64>::zeros(3 * count, 3 * count);
        for row in own.clone() {
            for (column, value) in self.tangent.view().row(row) {
                let column = column as usize;
                if !own.contains(&column) {
                    continue;
                }
                for (r, c) in (0..3).flat_map(|r| (0..3).map(move |c| (r, c))) {
                    block[(3 * (row - own.start) + r, 3 * (column - own.start) + c)] =
                        value.col(c)[r];
                }
            }
        }
        let factor = block
            .llt(Side::Lower)
            .map_err(|_| LinearFailure::Indefinite(self.unknowns[own.start] as usize))?;
        let mut inverse = Mat::<f64>::identity(3 * count, 3 * count);
        factor.solve_in_place_with_conj(Conj::No, inverse.as_mut());
        let entry = |row: usize, column: usize| {
            let column_of = |c: usize| {
                DVec3::from_array([0, 1, 2].map(|r| inverse[(3 * row + r, 3 * column + c)]))
            };
            DMat3::from_cols(column_of(0), column_of(1), column_of(2))
        };
        let mut start = Mat::from_fn(3 * count, 1, |i, _| sign(3 * own.start + i));
        solve_upper_triangular_in_place(factor.L().transpose(), start.as_mut(), Par::Seq);
        Ok(NodeFactor {
            inverse: (0..count * count)
                .map(|k| entry(k / count, k % count))
                .collect(),
            start: (0..count)
                .map(|i| DVec3::from_array([0, 1, 2].map(|c| start[(3 * i + c, 0)])))
                .collect(),
        })
    }

    /// Largest eigenvalue of `D^-1 A` by its Rayleigh quotient.
    fn power_iteration(&self, mut vector: Vec<DVec3>) -> f64 {
        let mut image = vector.clone();
        let mut largest = 1.0_f64;
        for _ in 0..POWER_STEPS {
            self.tangent.view().multiply(&vector, &mut image);
            let scaled = self.scaled(&image);
            let energy = dot(&vector, &image);
            let length = dot(&image, &scaled);
            if energy <= 0.0 || length <= 0.0 {
                break;
            }
            largest = length / energy;
            let unit = length.sqrt().recip();
            vector = scaled.into_iter().map(|v| unit * v).collect();
        }
        largest.max(1.0)
    }

    /// `D^-1 r`.
    pub(super) fn scaled(&self, vector: &[DVec3]) -> Vec<DVec3> {
        let indices = (0..vector.len()).into_par_iter();
        indices
            .map(|index| self.scaled_entry(vector, index))
            .collect()
    }

    /// Row `index` of `D^-1 r`.
    fn scaled_entry(&self, vector: &[DVec3], index: usize) -> DVec3 {
        let own = &vector[self.nodes[self.node_of[index] as usize].clone()];
        let row = &self.inverses[self.inverse_offset[index]..][..own.len()];
        row.iter()
            .zip(own)
            .map(|(block, entry)| *block * *entry)
            .sum()
    }

    /// An approximate solution for forces on the jumps (N): Chebyshev polynomial of the first kind
    /// (Saad 2003, algorithm 12.1) in `D^-1 A`, or the exact one if the block is factorised.
    pub(super) fn solve(&self, right: &[DVec3]) -> Vec<DVec3> {
        if let Some(factor) = &self.factor {
            return factor.solve(right);
        }
        let (high, low) = (self.largest_eigenvalue, self.largest_eigenvalue / CONDITION);
        let (middle, half) = (0.5 * (high + low), 0.5 * (high - low));
        let sigma = middle / half;
        let mut rho = 1.0 / sigma;
        let indices = || (0..right.len()).into_par_iter();
        let mut step: Vec<DVec3> = indices()
            .map(|i| self.scaled_entry(right, i) / middle)
            .collect();
        let mut solution = step.clone();
        let mut residual = vec![DVec3::ZERO; right.len()];
        let tangent = self.tangent.view();
        for _ in 1..DEGREE {
            let remaining = |i: usize| right[i] - tangent.row_product(i, &solution);
            residual
                .par_iter_mut()
                .enumerate()
                .for_each(|(i, entry)| *entry = remaining(i));
            let next = 1.0 / (2.0 * sigma - rho);
            let pairs = step.par_iter_mut().zip(&mut solution).enumerate();
            pairs.for_each(|(i, (step, entry))| {
                *step = rho * next * *step + 2.0 * next / half * self.scaled_entry(&residual, i);
                *entry += *step;
            });
            rho = next;
        }
        solution
    }

    /// The jumps' entries of a vector over all unknowns.
    pub(super) fn gather(&self, vector: &[DVec3]) -> Vec<DVec3> {
        let entries = self.unknowns.par_iter();
        entries.map(|&unknown| vector[unknown as usize]).collect()
    }

    /// Forces on the jumps (N) that remain of `forces` once jumps `own`, and the rock as in
    /// `vector` over all unknowns, resist them.
    pub(super) fn remaining(
        &self,
        rows: BlockRows<'_>,
        forces: &[DVec3],
        own: &[DVec3],
        vector: &[DVec3],
    ) -> Vec<DVec3> {
        let tangent = self.tangent.view();
        let pairs = self.unknowns.par_iter().zip(forces).enumerate();
        pairs
            .map(|(index, (&unknown, force))| {
                let rock = rows.row_product(unknown as usize, vector);
                *force - tangent.row_product(index, own) - rock
            })
            .collect()
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

fn unfactorised(own: &OwnedBlockRows) -> Result<Cholesky, LinearFailure> {
    let rows = own.view();
    let neighbours = |row: usize| rows.row(row).map(|(column, _)| column);
    let count = own.row_offset.len() - 1;
    let order = nested_dissection(count, neighbours)?;
    let analysis = Analysis::of(&own.row_offset, &own.columns, order)?;
    Ok(Cholesky::new(analysis, rows))
}

/// Scalar product, summed in a fixed order.
fn dot(a: &[DVec3], b: &[DVec3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.dot(*b)).sum()
}

fn coupling(rows: BlockRows<'_>, rock: &[u32], jumps: &[u32]) -> Vec<CoupledRow> {
    let number = numbers(rows.rows(), jumps);
    let coupled = |(index, &unknown): (usize, &u32)| {
        let range = rows.row_offset[unknown as usize]..rows.row_offset[unknown as usize + 1];
        let jumps: Vec<(u32, usize)> = range
            .map(|address| (number[rows.columns[address] as usize], address))
            .filter(|(jump, _)| *jump != DROPPED)
            .collect();
        (!jumps.is_empty()).then_some(CoupledRow {
            row: index as u32,
            jumps,
        })
    };
    rock.par_iter().enumerate().filter_map(coupled).collect()
}

/// Addresses of the interface's blocks in the jumps' own matrix.
fn places(system: &System<'_>, own: &OwnedBlockRows) -> Vec<usize> {
    let interface = &system.discretisation.interface;
    let unknowns = &interface.unknowns;
    let number = |unknown: u32| unknowns.partition_point(|&other| other < unknown) as u32;
    (0..unknowns.len())
        .flat_map(|row| {
            let start = own.row_offset[row];
            let columns = &own.columns[start..own.row_offset[row + 1]];
            let blocks = interface.columns.of(row).iter();
            blocks.map(move |&column| {
                let column = number(column);
                start + columns.partition_point(|&other| other < column)
            })
        })
        .collect()
}
