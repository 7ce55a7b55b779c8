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

/// Scalar products of vectors with one, as [`dot_of_tasks`].
pub(crate) fn dots_of_tasks(vectors: &[Vec<DVec3>], with: &[DVec3]) -> Vec<f64> {
    let tasks = with.par_chunks(PER_TASK).enumerate();
    let sums = tasks.map(|(task, own)| -> Vec<f64> {
        let start = task * PER_TASK;
        let parts = vectors.iter().map(|v| &v[start..start + own.len()]);
        parts.map(|part| dot(part, own)).collect()
    });
    let sums: Vec<Vec<f64>> = sums.collect();
    let product = |i: usize| sums.iter().map(|of_task| of_task[i]).sum();
    (0..vectors.len()).map(product).collect()
}

/// Adds shares of vectors to one.
pub(crate) fn add_shares(shares: &[f64], vectors: &[Vec<DVec3>], to: &mut [DVec3]) {
    let tasks = to.par_chunks_mut(PER_TASK).enumerate();
    tasks.for_each(|(task, own)| {
        let start = task * PER_TASK;
        for (share, vector) in shares.iter().zip(vectors) {
            let part = &vector[start..start + own.len()];
            for (to, from) in own.iter_mut().zip(part) {
                *to += *share * *from;
            }
        }
    });
}

/// Adds `sum(i)` to the entry of a vector at each `rows[i]`; these ascend.
pub fn add_at(rows: &[u32], sum: impl Fn(usize) -> DVec3 + Sync, to: &mut [DVec3]) {
    let tasks = to.par_chunks_mut(PER_TASK).enumerate();
    tasks.for_each(|(task, own)| {
        let start = task * PER_TASK;
        let before = |end: usize| rows.partition_point(|&row| (row as usize) < end);
        for number in before(start)..before(start + own.len()) {
            own[rows[number] as usize - start] += sum(number);
        }
    });
}

/// Sum of the diagonal of a block.
pub fn trace(block: DMat3) -> f64 {
    block.x_axis.x + block.y_axis.y + block.z_axis.z
}
