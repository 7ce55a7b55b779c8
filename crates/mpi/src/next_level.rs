//! The matrix of the next level, put together from what the rows of all ranks give to it.

use std::sync::Arc;

use kluft_solver::multigrid::{BlockList, CoarseBasis, LevelPart};
use kluft_solver::small::{Modes, inverse_factor, product, transpose};

use crate::petsc::{Matrix, PetscFailure, World};

/// A motion with less than this share of the energy of the stiffest one of its node costs nothing,
/// and is left out.
const COSTS_NOTHING: f64 = 1e-6;

type Block6 = [[f64; 6]; 6];
/// Row, column and entries of a block.
type BlockRecord = [f64; 38];
/// Node and entries of its factor.
type FactorRecord = [f64; 37];

/// The nodes of the next level, each on the rank of the first row that it moves.
#[derive(Debug)]
pub struct NextNodes {
    owner: Vec<u32>,
    number: Vec<i64>,
    own: Vec<u32>,
}

impl NextNodes {
    /// The nodes of a basis whose rows have these owners.
    pub fn of(basis: &CoarseBasis, owner_of_row: &[u32], world: &World) -> Self {
        let nodes = basis.modes().len();
        let mut owner = vec![u32::MAX; nodes];
        for (row, rank) in owner_of_row.iter().enumerate() {
            for (node, _) in basis.row(row) {
                if owner[node] == u32::MAX {
                    owner[node] = *rank;
                }
            }
        }
        for rank in &mut owner {
            *rank = if *rank == u32::MAX { 0 } else { *rank };
        }
        let mut next = vec![0_i64; world.ranks() + 1];
        for &rank in &owner {
            next[rank as usize + 1] += 1;
        }
        for rank in 0..world.ranks() {
            next[rank + 1] += next[rank];
        }
        let number = owner.iter().map(|&rank| {
            let next = &mut next[rank as usize];
            *next += 1;
            *next - 1
        });
        let number = number.collect();
        let is_own = |node: &u32| owner[*node as usize] as usize == world.rank();
        Self {
            number,
            own: (0..nodes as u32).filter(is_own).collect(),
            owner,
        }
    }

    /// Prolongator, matrix and modes of the next level, in unknowns that scale its diagonal blocks
    /// to the identity: with `A_ii = L L^T`, the prolongator is `P L^-T`, the matrix
    /// `L^-1 A L^-T`, and the modes are `L^T B`. A motion that costs nothing, as one that supports
    /// forbid, moves nothing and gets the diagonal 1.
    ///
    /// # Errors
    /// Those of PETSc and MPI.
    pub fn level(
        &self,
        world: &Arc<World>,
        part: &mut LevelPart,
        modes: &[Modes<6>],
    ) -> Result<(Matrix, Matrix, Vec<[f64; 6]>), PetscFailure> {
        let (mut matrix, needed_by) = self.assembled(world, part)?;
        let (factors, modes) = self.own_factors(&matrix, modes);
        let factors = self.all_factors(world, &factors, &needed_by)?;
        self.scale(&mut matrix, &factors);
        let columns = &part.prolongator.columns;
        for (block, &column) in part.prolongator.blocks.iter_mut().zip(columns) {
            *block = product(block, &transpose(&factors[column as usize]));
        }
        let number = |node: u32| self.number[node as usize];
        let prolongator = Matrix::new(world, &part.prolongator, self.own.len(), number)?;
        let matrix = Matrix::new(world, &matrix, self.own.len(), number)?;
        Ok((prolongator, matrix, modes))
    }

    /// The rows of this rank, summed in the order of the ranks; and for each of its nodes the ranks
    /// that have something to do with it.
    fn assembled(
        &self,
        world: &World,
        part: &LevelPart,
    ) -> Result<(BlockList<6, 6>, Vec<Vec<u32>>), PetscFailure> {
        let mut lists: Vec<Vec<BlockRecord>> = vec![Vec::new(); world.ranks()];
        for row in 0..part.next.rows() {
            for (column, block) in part.next.row(row) {
                let (i, j) = (row as u32, column);
                lists[self.owner[row] as usize].push(record(i, j, block));
                if i != j {
                    let list = &mut lists[self.owner[j as usize] as usize];
                    list.push(record(j, i, &transpose(block)));
                }
            }
        }
        // Who moves a node needs its factor, whether or not the node moves with others.
        let moved = &part.prolongator.columns;
        let mut moved: Vec<u32> = moved.clone();
        moved.sort_unstable();
        moved.dedup();
        let mut notices: Vec<Vec<[f64; 2]>> = vec![Vec::new(); world.ranks()];
        for node in moved {
            let rank = world.rank() as f64;
            notices[self.owner[node as usize] as usize].push([f64::from(node), rank]);
        }
        let mut received = world.exchange(&lists)?;
        drop(lists);
        received.sort_by_key(|record| (record[0] as u32, record[1] as u32));
        let matrix = self.summed(&received);
        let mut needed_by = vec![Vec::new(); self.own.len()];
        for [node, rank] in world.exchange(&notices)? {
            needed_by[self.place(node as u32)].push(rank as u32);
        }
        for (place, ranks) in needed_by.iter_mut().enumerate() {
            let columns = matrix.row(place);
            ranks.extend(columns.map(|(column, _)| self.owner[column as usize]));
            ranks.sort_unstable();
            ranks.dedup();
        }
        Ok((matrix, needed_by))
    }

    /// Place of a node of this rank among its own.
    fn place(&self, node: u32) -> usize {
        self.own.partition_point(|&own| own < node)
    }

    /// Rows of blocks, sorted by row and column. Every row has a diagonal.
    fn summed(&self, records: &[BlockRecord]) -> BlockList<6, 6> {
        let mut matrix = BlockList {
            offset: vec![0],
            ..BlockList::default()
        };
        let mut rest = records.iter().peekable();
        for &node in &self.own {
            let start = matrix.columns.len();
            while let Some(record) = rest.next_if(|record| record[0] as u32 == node) {
                let column = record[1] as u32;
                if matrix.columns[start..].last() != Some(&column) {
                    matrix.columns.push(column);
                    matrix.blocks.push([[0.0; 6]; 6]);
                }
                let last = matrix.blocks.len() - 1;
                let sum = matrix.blocks[last].as_flattened_mut();
                sum.iter_mut().zip(&record[2..]).for_each(|(s, e)| *s += e);
            }
            let place = start + matrix.columns[start..].partition_point(|&at| at < node);
            if matrix.columns.get(place) != Some(&node) {
                matrix.columns.insert(place, node);
                matrix.blocks.insert(place, [[0.0; 6]; 6]);
            }
            matrix.offset.push(matrix.columns.len());
        }
        matrix
    }

    /// `L^-1` of the nodes of this rank, and their modes.
    fn own_factors(
        &self,
        matrix: &BlockList<6, 6>,
        modes: &[Modes<6>],
    ) -> (Vec<Block6>, Vec<[f64; 6]>) {
        let mut factors = Vec::with_capacity(self.own.len());
        let mut scaled = Vec::with_capacity(6 * self.own.len());
        for (place, &node) in self.own.iter().enumerate() {
            let diagonal = matrix.row(place).find(|(column, _)| *column == node);
            let diagonal = diagonal.map_or([[0.0; 6]; 6], |(_, block)| *block);
            let (factor, _) = inverse_factor(&diagonal, COSTS_NOTHING);
            scaled.extend(product(&product(&factor, &diagonal), &modes[node as usize]));
            factors.push(factor);
        }
        (factors, scaled)
    }

    /// The factors of all nodes that this rank has to do with; zero for the others.
    fn all_factors(
        &self,
        world: &World,
        own: &[Block6],
        needed_by: &[Vec<u32>],
    ) -> Result<Vec<Block6>, PetscFailure> {
        let mut lists: Vec<Vec<FactorRecord>> = vec![Vec::new(); world.ranks()];
        for ((&node, factor), ranks) in self.own.iter().zip(own).zip(needed_by) {
            let mut record = [f64::from(node); 37];
            record[1..].copy_from_slice(factor.as_flattened());
            for &rank in ranks {
                lists[rank as usize].push(record);
            }
        }
        let mut factors = vec![[[0.0; 6]; 6]; self.owner.len()];
        for record in world.exchange(&lists)? {
            let factor = factors[record[0] as usize].as_flattened_mut();
            factor.copy_from_slice(&record[1..]);
        }
        for (&node, factor) in self.own.iter().zip(own) {
            factors[node as usize] = *factor;
        }
        Ok(factors)
    }

    fn scale(&self, matrix: &mut BlockList<6, 6>, factors: &[Block6]) {
        for (place, &node) in self.own.iter().enumerate() {
            let left = &factors[node as usize];
            for at in matrix.offset[place]..matrix.offset[place + 1] {
                let column = matrix.columns[at];
                let right = transpose(&factors[column as usize]);
                let block = &mut matrix.blocks[at];
                *block = match column == node {
                    true => std::array::from_fn(|i| {
                        std::array::from_fn(|j| if i == j { 1.0 } else { 0.0 })
                    }),
                    false => product(&product(left, block), &right),
                };
            }
        }
    }
}

fn record(row: u32, column: u32, block: &Block6) -> BlockRecord {
    let mut record = [0.0; 38];
    (record[0], record[1]) = (f64::from(row), f64::from(column));
    record[2..].copy_from_slice(block.as_flattened());
    record
}
