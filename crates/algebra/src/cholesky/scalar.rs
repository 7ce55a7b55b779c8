//! `A = L L^T` of a matrix of scalars.

use faer::sparse::linalg::cholesky::SymbolicCholesky;
use faer::sparse::linalg::cholesky::supernodal::SupernodalLltRef;
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};

use super::ordering::NodeOrder;
use super::{factor, substitution};
use crate::dense_kernels::parallelism;
use crate::failure::LinearFailure;
use crate::lists::Lists;

/// A symmetric sparse matrix of scalars, row by row, both triangles and the diagonal stored.
#[derive(Debug, Clone)]
pub struct ScalarMatrix {
    /// Columns of each row, ascending.
    pub pattern: Lists,
    /// One value for each entry of the pattern.
    pub values: Vec<f64>,
}

impl ScalarMatrix {
    /// Columns and values of a row.
    pub fn row(&self, row: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let range = self.pattern.offset[row]..self.pattern.offset[row + 1];
        let columns = self.pattern.entries[range.clone()].iter();
        let columns = columns.map(|&column| column as usize);
        columns.zip(self.values[range].iter().copied())
    }
}

/// The factor of a [`ScalarMatrix`]. The analysis is done once; values may change.
pub struct ScalarCholesky {
    /// Scalars in the order of their elimination.
    order: Vec<usize>,
    symbolic: SymbolicCholesky<usize>,
    column_offset: Vec<usize>,
    row_index: Vec<usize>,
    factor: Vec<f64>,
}

impl ScalarCholesky {
    /// Analyses the pattern of a matrix; nothing is factorised yet.
    ///
    /// # Errors
    /// If the ordering or the analysis fails.
    pub fn of(pattern: &Lists) -> Result<Self, LinearFailure> {
        let count = pattern.count();
        let first: Vec<u32> = (0..=count as u32).collect();
        let order = NodeOrder::of(pattern, &first)?.all(&first);
        let (mut column_offset, mut row_index) = (vec![0], Vec::new());
        for column in 0..count {
            // By symmetry column `j` up to the diagonal is row `j` up to the diagonal.
            let upper = pattern.of(column).iter().map(|&row| row as usize);
            row_index.extend(upper.take_while(|&row| row <= column));
            column_offset.push(row_index.len());
        }
        let shape =
            SymbolicSparseColMatRef::new_checked(count, count, &column_offset, None, &row_index);
        Ok(Self {
            symbolic: factor::symbolic(shape, &order)?,
            order,
            column_offset,
            row_index,
            factor: Vec::new(),
        })
    }

    /// Number of entries of the factor.
    pub fn factor_entries(&self) -> usize {
        self.symbolic.len_val()
    }

    /// Floating-point operations of one factorisation.
    pub fn factor_operations(&self) -> f64 {
        factor::operations(factor::supernodal(&self.symbolic))
    }

    /// Memory of a solve (bytes): the factor, its work space, and the entries of the matrix.
    pub fn memory_bytes(&self) -> usize {
        let work = self
            .symbolic
            .factorize_numeric_llt_scratch::<f64>(parallelism(), faer::Spec::default());
        let entries = self.row_index.len() * (size_of::<f64>() + size_of::<usize>());
        self.factor_entries() * size_of::<f64>() + work.unaligned_bytes_required() + entries
    }

    /// Factorises a matrix of the pattern that was analysed.
    ///
    /// # Errors
    /// If the matrix is not positive definite (with the row where it showed) or memory runs out.
    ///
    /// # Panics
    /// If the matrix has another pattern.
    pub fn factorise(&mut self, matrix: &ScalarMatrix) -> Result<(), LinearFailure> {
        let count = self.order.len();
        let rows = 0..count;
        let values: Vec<f64> = rows
            .flat_map(|row| {
                matrix
                    .row(row)
                    .take_while(move |(column, _)| *column <= row)
            })
            .map(|(_, value)| value)
            .collect();
        assert_eq!(values.len(), self.row_index.len(), "the analysed pattern");
        let shape = SymbolicSparseColMatRef::new_checked(
            count,
            count,
            &self.column_offset,
            None,
            &self.row_index,
        );
        let upper = SparseColMatRef::new(shape, &values);
        let done = factor::numeric(&self.symbolic, upper, &mut self.factor);
        done.map_err(|failure| match failure {
            LinearFailure::Indefinite(place) => LinearFailure::Indefinite(self.order[place]),
            other => other,
        })
    }

    /// Solves for one right-hand side.
    ///
    /// # Panics
    /// If nothing was factorised.
    pub fn solve(&self, rhs: &[f64]) -> Vec<f64> {
        let mut column: Vec<f64> = self.order.iter().map(|&row| rhs[row]).collect();
        let size = column.len();
        let lower = SupernodalLltRef::new(factor::supernodal(&self.symbolic), &self.factor);
        substitution::eliminate(lower, size, &mut column);
        substitution::substitute(lower, size, &mut column);
        let mut solution = vec![0.0; size];
        for (&row, value) in self.order.iter().zip(column) {
            solution[row] = value;
        }
        solution
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Laplace's matrix on a grid of `n` by `n` points, held outside.
    fn grid(n: usize) -> ScalarMatrix {
        let mut lists = Vec::new();
        let mut values = Vec::new();
        for row in 0..n * n {
            let (x, y) = (row % n, row / n);
            let around = [
                (y > 0).then(|| row - n),
                (x > 0).then(|| row - 1),
                Some(row),
                (x + 1 < n).then_some(row + 1),
                (y + 1 < n).then_some(row + n),
            ];
            let own: Vec<usize> = around.into_iter().flatten().collect();
            values.extend(
                own.iter()
                    .map(|&column| if column == row { 4.0 } else { -1.0 }),
            );
            lists.push(own.into_iter().map(|column| column as u32).collect());
        }
        ScalarMatrix {
            pattern: Lists::collect(&lists),
            values,
        }
    }

    #[test]
    fn a_solution_fulfils_its_equations() {
        let matrix = grid(23);
        let mut cholesky = ScalarCholesky::of(&matrix.pattern).expect("an analysis");
        cholesky.factorise(&matrix).expect("positive definite");
        let rhs: Vec<f64> = (0..23 * 23).map(|i| ((7 * i) % 11) as f64 - 5.0).collect();
        let solution = cholesky.solve(&rhs);
        for (row, expected) in rhs.iter().enumerate() {
            let found: f64 = matrix.row(row).map(|(j, a)| a * solution[j]).sum();
            assert!(
                (found - expected).abs() < 1e-11,
                "{row}: {found} {expected}"
            );
        }
    }

    #[test]
    fn a_matrix_that_is_not_positive_definite_is_named_by_its_row() {
        let mut matrix = grid(4);
        let row = 6;
        let place = matrix.row(row).position(|(column, _)| column == row);
        matrix.values[matrix.pattern.offset[row] + place.expect("a diagonal")] = -1.0;
        let mut cholesky = ScalarCholesky::of(&matrix.pattern).expect("an analysis");
        let failure = cholesky.factorise(&matrix);
        assert!(
            matches!(failure, Err(LinearFailure::Indefinite(_))),
            "{failure:?}"
        );
    }
}
