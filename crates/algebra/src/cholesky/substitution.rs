//! Forward and backward substitution with a supernodal factor, stopping at a given scalar.
//!
//! With the first `count` scalars called `a` and the others `b`, the factor is
//! `L = [L_a 0; L_ba L_b]`, and `L_b L_b^T` is the Schur complement of `a`.

use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::{
    solve_lower_triangular_in_place, solve_upper_triangular_in_place,
};
use faer::sparse::linalg::cholesky::supernodal::SupernodalLltRef;
use faer::{Accum, ColMut, ColRef, Mat, MatRef, Par};

type Factor<'a> = SupernodalLltRef<'a, usize, f64>;

/// Columns of one supernode.
struct Panel<'a> {
    /// First column.
    start: usize,
    /// Triangle on the diagonal.
    triangle: MatRef<'a, f64>,
    /// The rows below it.
    below: MatRef<'a, f64>,
    /// Number of rows that follow the triangle without a gap; the others are in `pattern`.
    following: usize,
    pattern: &'a [usize],
}

impl<'a> Panel<'a> {
    /// The columns of supernode `index` that are less than `count`.
    fn of(factor: Factor<'a>, index: usize, count: usize) -> Self {
        let supernode = factor.supernode(index);
        let (start, values) = (supernode.start(), supernode.val());
        let width = values.ncols().min(count - start);
        let (triangle, below) = values.subcols(0, width).split_at_row(width);
        Self {
            start,
            triangle,
            below,
            following: values.ncols() - width,
            pattern: supernode.pattern(),
        }
    }

    fn columns(&self) -> std::ops::Range<usize> {
        self.start..self.start + self.triangle.ncols()
    }

    /// Numbers of the rows of `below`.
    fn rows(&self) -> impl Iterator<Item = usize> {
        let end = self.columns().end;
        let following = end..end + self.following;
        following.chain(self.pattern.iter().copied())
    }
}

/// The supernodes that hold the first `count` columns.
fn panels(factor: Factor<'_>, count: usize) -> impl DoubleEndedIterator<Item = Panel<'_>> {
    let begin = factor.symbolic().supernode_begin();
    let number = begin.partition_point(|&start| start < count);
    (0..number).map(move |index| Panel::of(factor, index, count))
}

/// Replaces `(x_a, x_b)` by `(L_a^-1 x_a, x_b - L_ba L_a^-1 x_a)`.
pub(super) fn eliminate(factor: Factor<'_>, count: usize, x: &mut [f64]) {
    let mut product = Vec::new();
    for panel in panels(factor, count) {
        let own = &mut x[panel.columns()];
        let column = ColMut::from_slice_mut(own).as_mat_mut();
        solve_lower_triangular_in_place(panel.triangle, column, Par::Seq);
        product.resize(panel.below.nrows(), 0.0);
        matmul(
            ColMut::from_slice_mut(&mut product).as_mat_mut(),
            Accum::Replace,
            panel.below,
            ColRef::from_slice(own).as_mat(),
            1.0,
            Par::Seq,
        );
        for (row, change) in panel.rows().zip(&product) {
            x[row] -= change;
        }
    }
}

/// Replaces `(x_a, x_b)` by `(L_a^-T (x_a - L_ba^T x_b), x_b)`.
pub(super) fn substitute(factor: Factor<'_>, count: usize, x: &mut [f64]) {
    let mut known = Vec::new();
    for panel in panels(factor, count).rev() {
        known.clear();
        known.extend(panel.rows().map(|row| x[row]));
        let mut column = ColMut::from_slice_mut(&mut x[panel.columns()]).as_mat_mut();
        matmul(
            column.as_mut(),
            Accum::Add,
            panel.below.transpose(),
            ColRef::from_slice(&known).as_mat(),
            -1.0,
            Par::Seq,
        );
        solve_upper_triangular_in_place(panel.triangle.transpose(), column, Par::Seq);
    }
}

/// `L_b` as a full lower triangle.
pub(super) fn trailing_factor(factor: Factor<'_>, count: usize) -> Mat<f64> {
    let symbolic = factor.symbolic();
    let size = symbolic.nrows() - count;
    let mut trailing = Mat::zeros(size, size);
    let first = symbolic
        .supernode_end()
        .partition_point(|&end| end <= count);
    for index in first..symbolic.n_supernodes() {
        let supernode = factor.supernode(index);
        let (start, values) = (supernode.start(), supernode.val());
        let width = values.ncols();
        for local in count.saturating_sub(start)..width {
            let column = start + local - count;
            for row in local..width {
                trailing[(start + row - count, column)] = values[(row, local)];
            }
            for (k, &row) in supernode.pattern().iter().enumerate() {
                trailing[(row - count, column)] = values[(width + k, local)];
            }
        }
    }
    trailing
}
