//! The tentative prolongator: the rigid motions of each aggregate, made orthonormal.

use rayon::prelude::*;

use super::aggregation::{ALONE, Aggregates};
use crate::small::Modes;

/// A mode of an aggregate that depends on the ones before it but for this share is left out.
const DEPENDENT: f64 = 1e-8;
/// Aggregates that one task treats.
const PER_TASK: usize = 64;

/// `B = T R` on every aggregate, with `T^T T = I` but for dependent modes, whose columns are zero.
pub(super) struct Tentative<const N: usize> {
    /// `T`, one block a node; zero where the node has no aggregate.
    pub(super) blocks: Vec<[[f32; 6]; N]>,
    /// `R`, upper triangular, one block an aggregate: the modes of the next level.
    pub(super) modes: Vec<Modes<6>>,
}

impl<const N: usize> Tentative<N> {
    /// What `T` would have for a node with these modes in an aggregate.
    pub(super) fn extended(&self, modes: &Modes<N>, aggregate: u32) -> [[f32; 6]; N] {
        modes.map(|row| solve(row, &self.modes[aggregate as usize]))
    }
}

/// Builds the tentative prolongator of given modes.
pub(super) fn tentative<const N: usize>(
    aggregates: &Aggregates,
    modes: &[Modes<N>],
) -> Tentative<N> {
    let members = aggregates.members();
    let triangles: Vec<Modes<6>> = (0..aggregates.count)
        .into_par_iter()
        .with_min_len(PER_TASK)
        .map_init(Vec::new, |rows, aggregate| {
            rows.clear();
            let nodes = members.of(aggregate).iter();
            rows.extend(nodes.flat_map(|&node| modes[node as usize]));
            orthogonalise(rows)
        })
        .collect();
    let solved = aggregates.of_node.par_iter().zip(modes);
    let blocks = solved.map(|(&aggregate, modes)| match aggregate {
        ALONE => [[0.0; 6]; N],
        aggregate => modes.map(|row| solve(row, &triangles[aggregate as usize])),
    });
    Tentative {
        blocks: blocks.collect(),
        modes: triangles,
    }
}

/// Gram-Schmidt, twice for the sake of rounding: replaces the columns of `B` by those of `T` and
/// returns `R`. A dependent column has a zero row in `R`.
fn orthogonalise(rows: &mut [[f64; 6]]) -> Modes<6> {
    let mut triangle = [[0.0; 6]; 6];
    for j in 0..6 {
        let original = column_dot(rows, j, j).sqrt();
        for _ in 0..2 {
            for k in 0..j {
                let share = column_dot(rows, k, j);
                triangle[k][j] += share;
                rows.iter_mut().for_each(|row| row[j] -= share * row[k]);
            }
        }
        let rest = column_dot(rows, j, j).sqrt();
        let is_kept = rest > DEPENDENT * original;
        triangle[j][j] = if is_kept { rest } else { 0.0 };
        let scale = if is_kept { 1.0 / rest } else { 0.0 };
        rows.iter_mut().for_each(|row| row[j] *= scale);
    }
    triangle
}

fn column_dot(rows: &[[f64; 6]], a: usize, b: usize) -> f64 {
    rows.iter().map(|row| row[a] * row[b]).sum()
}

/// The row of `T` that belongs to a row of `B`: `t R = b`, with zeros for dependent modes.
fn solve(row: [f64; 6], triangle: &Modes<6>) -> [f32; 6] {
    let mut solution = [0.0; 6];
    for j in (0..6).filter(|&j| triangle[j][j] > 0.0) {
        let known: f64 = (0..j).map(|k| solution[k] * triangle[k][j]).sum();
        solution[j] = (row[j] - known) / triangle[j][j];
    }
    solution.map(|entry| entry as f32)
}
