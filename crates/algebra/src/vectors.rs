//! Sums over vectors, in a fixed order.

use glam::{DMat3, DVec3};
use rayon::prelude::*;

/// Entries that one task sums; fixed, so that no sum depends on the number of threads.
pub(crate) const PER_TASK: usize = 4096;

/// Euclidean norm, summed in a fixed order.
pub fn norm(vector: &[DVec3]) -> f64 {
    vector
        .iter()
        .map(|v| v.length_squared())
        .sum::<f64>()
        .sqrt()
}

/// Scalar product, summed from the first entry to the last.
pub fn dot(a: &[DVec3], b: &[DVec3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.dot(*b)).sum()
}

/// Length of the largest vector.
pub fn largest(vectors: &[DVec3]) -> f64 {
    vectors.iter().map(|v| v.length()).fold(0.0, f64::max)
}

/// Scalar product by all threads: the sums of the tasks are added in their order.
pub(crate) fn dot_of_tasks(a: &[DVec3], b: &[DVec3]) -> f64 {
    if a.len() <= PER_TASK {
        return dot(a, b);
    }
    let tasks = a.par_chunks(PER_TASK).zip(b.par_chunks(PER_TASK));
    let sums: Vec<f64> = tasks.map(|(a, b)| dot(a, b)).collect();
    sums.iter().sum()
}

/// Sum of the diagonal of a block.
pub fn trace(block: DMat3) -> f64 {
    block.x_axis.x + block.y_axis.y + block.z_axis.z
}
