//! Small dense blocks: products, sums, Cholesky factors.

use glam::DMat3;

/// Motions of a node, one row for each of its unknowns and one column for each motion.
pub type Modes<const N: usize> = [[f64; 6]; N];

/// Inverse of the Cholesky factor of a block, `L^-1` with `L L^T = A`, lower triangular, as rows.
///
/// A pivot not above `least` times the largest diagonal entry counts as zero: its row and column
/// are left out of the factor, and the inverse has zeros there. The flags tell which were kept.
pub fn inverse_factor<const N: usize>(
    block: &[[f64; N]; N],
    least: f64,
) -> ([[f64; N]; N], [bool; N]) {
    let largest = (0..N).map(|i| block[i][i]).fold(0.0, f64::max);
    let mut factor = [[0.0; N]; N];
    let mut kept = [false; N];
    for j in 0..N {
        let pivot = block[j][j] - (0..j).map(|k| factor[j][k] * factor[j][k]).sum::<f64>();
        kept[j] = pivot > least * largest && pivot.is_finite();
        if !kept[j] {
            continue;
        }
        factor[j][j] = pivot.sqrt();
        for i in j + 1..N {
            let sum: f64 = (0..j).map(|k| factor[i][k] * factor[j][k]).sum();
            factor[i][j] = (block[i][j] - sum) / factor[j][j];
        }
    }
    (inverse(&factor, &kept), kept)
}

fn inverse<const N: usize>(factor: &[[f64; N]; N], kept: &[bool; N]) -> [[f64; N]; N] {
    let mut inverse = [[0.0; N]; N];
    for j in (0..N).filter(|&j| kept[j]) {
        inverse[j][j] = 1.0 / factor[j][j];
        for i in (j + 1..N).filter(|&i| kept[i]) {
            let sum: f64 = (j..i).map(|k| factor[i][k] * inverse[k][j]).sum();
            inverse[i][j] = -sum / factor[i][i];
        }
    }
    inverse
}

/// `C = A B` of small blocks as rows.
#[inline(always)]
pub fn product<const M: usize, const K: usize, const L: usize>(
    a: &[[f64; K]; M],
    b: &[[f64; L]; K],
) -> [[f64; L]; M] {
    let mut c = [[0.0; L]; M];
    for (c, a) in c.iter_mut().zip(a) {
        for (a, b) in a.iter().zip(b) {
            for (c, b) in c.iter_mut().zip(b) {
                *c += a * b;
            }
        }
    }
    c
}

/// `S += factor B`.
#[inline(always)]
pub fn add<const M: usize, const L: usize>(
    sum: &mut [[f64; L]; M],
    factor: f64,
    block: &[[f64; L]; M],
) {
    let pairs = sum.as_flattened_mut().iter_mut().zip(block.as_flattened());
    pairs.for_each(|(sum, entry)| *sum += factor * entry);
}

/// `S += A B`, with `A` as columns and `B` as rows: line by line, so that a line stays in
/// registers.
#[inline(always)]
pub fn add_columns<const M: usize, const N: usize>(
    sum: &mut [[f64; 6]; M],
    a: &[[f64; M]; N],
    b: &[[f64; 6]; N],
) {
    for (i, sum) in sum.iter_mut().enumerate() {
        let mut line = *sum;
        for (a, b) in a.iter().zip(b) {
            for (entry, b) in line.iter_mut().zip(b) {
                *entry += a[i] * b;
            }
        }
        *sum = line;
    }
}

/// `S += factor A B`, with `A` as columns and `B` as rows.
#[inline(always)]
pub(crate) fn add_product<const N: usize>(
    sum: &mut [[f64; 6]; N],
    factor: f64,
    a: &[[f32; N]; N],
    b: &[[f32; 6]; N],
) {
    let mut a = widen(a);
    a.as_flattened_mut()
        .iter_mut()
        .for_each(|entry| *entry *= factor);
    add_columns(sum, &a, &widen(b));
}

/// Transpose of a small block.
#[inline(always)]
pub fn transpose<T: Copy + Default, const M: usize, const L: usize>(
    block: &[[T; L]; M],
) -> [[T; M]; L] {
    let mut result = [[T::default(); M]; L];
    for (row, line) in block.iter().enumerate() {
        for (column, entry) in line.iter().enumerate() {
            result[column][row] = *entry;
        }
    }
    result
}

/// A block as its rows.
pub fn rows_of(block: &DMat3) -> [[f64; 3]; 3] {
    block.transpose().to_cols_array_2d()
}

/// A block in double precision.
#[inline(always)]
pub fn widen<const M: usize, const L: usize>(block: &[[f32; L]; M]) -> [[f64; L]; M] {
    converted(block, f64::from)
}

/// A block in single precision.
#[inline(always)]
pub(crate) fn narrow<const M: usize, const L: usize>(block: &[[f64; L]; M]) -> [[f32; L]; M] {
    converted(block, |entry| entry as f32)
}

/// In loops, because `map` of arrays may stay a call of its own, which is not vectorised.
#[inline(always)]
fn converted<A: Copy, B: Copy + Default, const M: usize, const L: usize>(
    block: &[[A; L]; M],
    convert: impl Fn(A) -> B,
) -> [[B; L]; M] {
    let mut result = [[B::default(); L]; M];
    for (line, entries) in result.iter_mut().zip(block) {
        for (target, &entry) in line.iter_mut().zip(entries) {
            *target = convert(entry);
        }
    }
    result
}

/// A pivot below this share of its diagonal entry shows a singular block.
const SINGULAR: f64 = 1e-14;

/// The lower triangle of a symmetric matrix, row by row.
pub(crate) struct Packed<'a>(pub(crate) &'a mut [f64]);

impl Packed<'_> {
    /// Replaces `A` by its Cholesky factor `L` and writes `L^-1`.
    ///
    /// # Errors
    /// The row of the first pivot that is not positive, or not finite.
    pub(crate) fn factorise_and_invert(self, inverse: &mut [f64]) -> Result<(), usize> {
        let row = |i: usize| i * (i + 1) / 2;
        let a = self.0;
        let mut size = 0;
        while row(size) < a.len() {
            let i = size;
            let diagonal = a[row(i) + i];
            for j in 0..=i {
                let known: f64 = (0..j).map(|k| a[row(i) + k] * a[row(j) + k]).sum();
                let rest = a[row(i) + j] - known;
                a[row(i) + j] = match j == i {
                    false => rest / a[row(j) + j],
                    true if rest > SINGULAR * diagonal && rest.is_finite() => rest.sqrt(),
                    true => return Err(i),
                };
            }
            size += 1;
        }
        for j in 0..size {
            inverse[row(j) + j] = 1.0 / a[row(j) + j];
            for i in j + 1..size {
                let known: f64 = (j..i).map(|k| a[row(i) + k] * inverse[row(k) + j]).sum();
                inverse[row(i) + j] = -known / a[row(i) + i];
            }
        }
        Ok(())
    }
}
