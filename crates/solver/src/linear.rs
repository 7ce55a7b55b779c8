//! Sparse Cholesky factorisation under a nested-dissection ordering of the node graph.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{LltError, LltRegularization};
use faer::perm::PermRef;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, Mat, Par, Side};
use feral_metis::{CscPattern, metis_order};
use glam::{DMat3, DVec3};

use crate::matrix::BlockMatrix;
use crate::pattern::Pattern;
use crate::points::Points;

/// Why a linear system could not be solved.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum LinearFailure {
    /// The factor does not fit in memory.
    OutOfMemory,
    /// The matrix is not positive definite; the block row where it showed.
    Indefinite(usize),
    /// The ordering or the symbolic analysis failed.
    Analysis(String),
}

/// Direct solver: the analysis is done once, values change from iteration to iteration.
pub struct DirectSolver {
    symbolic: SymbolicCholesky<usize>,
    column_offset: Vec<usize>,
    row_index: Vec<usize>,
    /// Upper triangle of the matrix, column by column.
    values: Vec<f64>,
    /// Number of blocks left of the diagonal in each block row.
    lower_blocks: Vec<usize>,
    factor: Vec<f64>,
    is_current: bool,
}

impl DirectSolver {
    /// Analyses the pattern and takes over the values of `matrix`.
    ///
    /// # Errors
    /// If ordering or analysis fails or the factor would not fit in memory.
    pub fn new(
        matrix: &BlockMatrix,
        pattern: &Pattern,
        points: &Points,
    ) -> Result<Self, LinearFailure> {
        let lower_blocks: Vec<usize> = (0..points.len())
            .map(|row| pattern.address(row, row) - pattern.row_offset[row])
            .collect();
        let (column_offset, row_index) = upper_triangle(pattern, &lower_blocks);
        let (forward, inverse) = scalar_ordering(pattern, points)?;
        let size = 3 * points.len();
        let shape =
            SymbolicSparseColMatRef::new_checked(size, size, &column_offset, None, &row_index);
        let symbolic = factorize_symbolic_cholesky(
            shape,
            Side::Upper,
            SymmetricOrdering::Custom(PermRef::new_checked(&forward, &inverse, size)),
            CholeskySymbolicParams::default(),
        )
        .map_err(|error| LinearFailure::Analysis(format!("{error:?}")))?;
        let mut solver = Self {
            values: vec![0.0; row_index.len()],
            factor: Vec::new(),
            symbolic,
            column_offset,
            row_index,
            lower_blocks,
            is_current: false,
        };
        for row in 0..points.len() {
            for (place, address) in pattern.row(row).enumerate() {
                solver.set_block(row, place, matrix.blocks[address]);
            }
        }
        Ok(solver)
    }

    /// Sets one block of the matrix: `place` counts the blocks of its row. Blocks right of the
    /// diagonal follow from symmetry and are ignored.
    pub fn set_block(&mut self, row: usize, place: usize, block: DMat3) {
        self.is_current = false;
        let diagonal = self.lower_blocks[row];
        if place > diagonal {
            return;
        }
        for (c, entries) in block.transpose().to_cols_array_2d().iter().enumerate() {
            let start = self.column_offset[3 * row + c] + 3 * place;
            let count = if place == diagonal { c + 1 } else { 3 };
            self.values[start..start + count].copy_from_slice(&entries[..count]);
        }
    }

    /// Number of entries of the factor.
    pub fn factor_entries(&self) -> usize {
        self.symbolic.len_val()
    }

    /// Whether a factor of the present values exists.
    pub fn is_current(&self) -> bool {
        self.is_current
    }

    /// Factorises the present values.
    ///
    /// # Errors
    /// If the matrix is not positive definite or memory runs out.
    pub fn factorise(&mut self) -> Result<(), LinearFailure> {
        let size = self.column_offset.len() - 1;
        let shape = SymbolicSparseColMatRef::new_checked(
            size,
            size,
            &self.column_offset,
            None,
            &self.row_index,
        );
        let length = self.symbolic.len_val();
        self.factor.clear();
        self.factor
            .try_reserve_exact(length)
            .map_err(|_| LinearFailure::OutOfMemory)?;
        self.factor.resize(length, 0.0);
        let par = parallelism();
        let request = self
            .symbolic
            .factorize_numeric_llt_scratch::<f64>(par, faer::Spec::default());
        let mut memory = MemBuffer::try_new(request).map_err(|_| LinearFailure::OutOfMemory)?;
        self.symbolic
            .factorize_numeric_llt(
                &mut self.factor,
                SparseColMatRef::new(shape, &self.values),
                Side::Upper,
                LltRegularization::default(),
                par,
                MemStack::new(&mut memory),
                faer::Spec::default(),
            )
            .map_err(|error| explain(&self.symbolic, &error))?;
        self.is_current = true;
        Ok(())
    }

    /// Solves for one right-hand side with the present factor.
    ///
    /// # Panics
    /// If there is no factor.
    pub fn solve(&self, right: &[DVec3]) -> Vec<DVec3> {
        assert!(self.is_current, "factorise before solving");
        let mut column = Mat::from_fn(3 * right.len(), 1, |i, _| right[i / 3][i % 3]);
        let request = self.symbolic.solve_in_place_scratch::<f64>(1, Par::Seq);
        let mut memory = MemBuffer::new(request);
        LltRef::new(&self.symbolic, &self.factor).solve_in_place_with_conj(
            Conj::No,
            column.as_mut(),
            Par::Seq,
            MemStack::new(&mut memory),
        );
        (0..right.len())
            .map(|i| {
                DVec3::new(
                    column[(3 * i, 0)],
                    column[(3 * i + 1, 0)],
                    column[(3 * i + 2, 0)],
                )
            })
            .collect()
    }
}

/// Translates the failing pivot to the block row it belongs to.
fn explain(symbolic: &SymbolicCholesky<usize>, error: &LltError) -> LinearFailure {
    let LltError::NonPositivePivot { index } = error;
    let original = symbolic
        .perm()
        .map_or(*index, |perm| perm.arrays().0[*index]);
    LinearFailure::Indefinite(original / 3)
}

fn parallelism() -> Par {
    Par::rayon(0)
}

/// Column offsets and row indices of the upper triangle. Column `3 i + c` holds the blocks of block
/// row `i` up to the diagonal, which by symmetry are those of block column `i`.
fn upper_triangle(pattern: &Pattern, lower_blocks: &[usize]) -> (Vec<usize>, Vec<usize>) {
    let mut column_offset = vec![0];
    let mut row_index = Vec::new();
    for (row, &lower) in lower_blocks.iter().enumerate() {
        let columns = &pattern.columns[pattern.row(row)][..lower];
        for c in 0..3 {
            let left = columns
                .iter()
                .flat_map(|&block| (0..3).map(move |r| 3 * block as usize + r));
            row_index.extend(left);
            row_index.extend((0..=c).map(|r| 3 * row + r));
            column_offset.push(row_index.len());
        }
    }
    (column_offset, row_index)
}

/// Nested dissection of the graph of nodes that carry unknowns; a node's unknowns stay together.
/// Returns the scalar permutation (new to old) and its inverse.
fn scalar_ordering(
    pattern: &Pattern,
    points: &Points,
) -> Result<(Vec<usize>, Vec<usize>), LinearFailure> {
    let fault = |what: &str| LinearFailure::Analysis(what.to_owned());
    let used: Vec<usize> = (0..points.offset.len() - 1)
        .filter(|&node| !points.of_node(node).is_empty())
        .collect();
    let mut number = vec![0_i32; points.offset.len() - 1];
    for (index, &node) in used.iter().enumerate() {
        number[node] = i32::try_from(index).map_err(|_| fault("too many nodes"))?;
    }
    let mut column_offset = vec![0_i32];
    let mut row_index = Vec::new();
    for &node in &used {
        let others = pattern
            .neighbours
            .of(node)
            .iter()
            .filter(|&&other| other as usize != node);
        row_index.extend(others.map(|&other| number[other as usize]));
        let end = i32::try_from(row_index.len()).map_err(|_| fault("node graph too large"))?;
        column_offset.push(end);
    }
    let graph = CscPattern::new(used.len(), &column_offset, &row_index)
        .ok_or_else(|| fault("malformed node graph"))?;
    let order = metis_order(&graph).map_err(|error| fault(&error.to_string()))?;
    let forward: Vec<usize> = order
        .iter()
        .flat_map(|&index| points.of_node(used[index as usize]))
        .flat_map(|block| [3 * block, 3 * block + 1, 3 * block + 2])
        .collect();
    let mut inverse = vec![0; forward.len()];
    for (new, &old) in forward.iter().enumerate() {
        inverse[old] = new;
    }
    Ok((forward, inverse))
}
