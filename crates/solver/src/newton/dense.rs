//! Small dense algebra of directions: of a recycled space, of an acceleration.

use faer::Mat;

use kluft_algebra::dense_kernels::apart;

/// Singular value, against the largest, below which directions are not told from each other.
const DEPENDENT: f64 = 1e-12;

/// Solves a small system of directions with energies on the diagonal, which need not be symmetric,
/// leaving out what they do not tell apart; none if the singular values are not found.
pub(super) fn solve(mut matrix: Mat<f64>, right: &[f64]) -> Option<Vec<f64>> {
    let count = right.len();
    let scale: Vec<f64> = (0..count)
        .map(|i| matrix[(i, i)].abs().max(f64::MIN_POSITIVE).sqrt().recip())
        .collect();
    for (i, j) in (0..count).flat_map(|i| (0..count).map(move |j| (i, j))) {
        matrix[(i, j)] *= scale[i] * scale[j];
    }
    let parts = apart(|| matrix.thin_svd()).ok()?;
    let (left, values, axes) = (parts.U(), parts.S(), parts.V());
    let mut solution = vec![0.0; count];
    for k in (0..count).filter(|&k| values[k] > DEPENDENT * values[0]) {
        let entries = 0..count;
        let part: f64 = entries.map(|i| left[(i, k)] * scale[i] * right[i]).sum();
        for (i, entry) in solution.iter_mut().enumerate() {
            *entry += part / values[k] * axes[(i, k)] * scale[i];
        }
    }
    Some(solution)
}

/// The directions along which vectors lie, the most important first, at most `count`; each vector
/// counts `fading` times the one before it. Singular vectors, because the eigenvectors of the sum
/// of squares would lose half of the digits.
pub(super) fn principal_axes(vectors: &[Vec<f64>], fading: f64, count: usize) -> Vec<Vec<f64>> {
    let length = vectors.first().map_or(0, Vec::len);
    let weight = |j: usize| fading.powi(j as i32);
    let matrix = Mat::from_fn(length, vectors.len(), |i, j| weight(j) * vectors[j][i]);
    let Ok(parts) = apart(|| matrix.thin_svd()) else {
        return Vec::new();
    };
    let (axes, values) = (parts.U(), parts.S());
    let most = length.min(vectors.len());
    let told = (0..most).filter(|&k| values[k] > f64::EPSILON * values[0]);
    told.take(count)
        .map(|k| (0..length).map(|i| axes[(i, k)]).collect())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_told_apart_is_solved_for() {
        // Solutions of ones, by rows that add up to the right-hand sides.
        let solve_rows = |rows: [[f64; 3]; 3]| {
            let right = rows.map(|row| row.iter().sum());
            solve(Mat::from_fn(3, 3, |i, j| rows[i][j]), &right).expect("eigenvalues")
        };
        let independent = [[4.0, 0.0, 4.0], [0.0, 1e-20, 0.0], [4.0, 0.0, 5.0]];
        let alike = [[4.0, 0.0, 4.0], [0.0, 1e-20, 0.0], [4.0, 0.0, 4.0]];
        for rows in [independent, alike] {
            let solution = solve_rows(rows);
            let error = solution.iter().map(|entry| (entry - 1.0).abs());
            assert!(error.fold(0.0, f64::max) < 1e-12, "{solution:?}");
        }
    }

    #[test]
    fn principal_axes_tell_small_components() {
        let vectors = [
            vec![1.0, 0.0, 0.0],
            vec![1.0, 1e-10, 0.0],
            vec![1.0, 0.0, 0.0],
        ];
        let axes = principal_axes(&vectors, 1.0, 5);
        assert_eq!(axes.len(), 2);
        assert!((axes[0][0].abs() - 1.0).abs() < 1e-12, "{axes:?}");
        assert!((axes[1][1].abs() - 1.0).abs() < 1e-5, "{axes:?}");
        assert_eq!(principal_axes(&vectors, 1.0, 1).len(), 1);
    }
}
