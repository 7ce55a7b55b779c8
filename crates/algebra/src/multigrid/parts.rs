//! Parts of aggregates: walls of an interface that press on each other and slide are strong
//! neighbours, but as one aggregate they could not slide on the levels below.

use rayon::prelude::*;

use super::aggregation::{ALONE, Aggregates};
use super::galerkin::Coarse;
use crate::small::{Modes, add, inverse_factor, product, transpose, widen};

/// Smallest resistance of walls, in every direction, against all that resists the motion of nodes
/// there, beyond which they need no motion against each other.
const WHOLE: f64 = 0.1;
/// Translations that have less than this share of the stiffness of the stiffest are not free.
const HELD: f64 = 1e-12;
/// Aggregates that one task treats.
const PER_TASK: usize = 64;

/// The aggregates divided, each along walls that do not resist every translation. The parts of one
/// lie beside each other, so that stiff walls do not lock them as they would other aggregates.
pub(super) fn parts(aggregates: &Aggregates, level: &Coarse) -> Aggregates {
    let members = aggregates.members();
    let divided: Vec<Vec<u32>> = (0..aggregates.count)
        .into_par_iter()
        .with_min_len(PER_TASK)
        .map(|aggregate| level.components(members.of(aggregate)))
        .collect();
    let mut of_node = vec![ALONE; aggregates.of_node.len()];
    let mut count = 0;
    for (aggregate, components) in divided.iter().enumerate() {
        for (&node, &component) in members.of(aggregate).iter().zip(components) {
            of_node[node as usize] = count + component;
        }
        count += 1 + components.iter().max().expect("an aggregate has nodes");
    }
    Aggregates {
        of_node,
        count: count as usize,
    }
}

impl Coarse {
    /// Number of the component of each of some nodes, ascending, components in the order of their
    /// first nodes.
    fn components(&self, nodes: &[u32]) -> Vec<u32> {
        if !self.continuity.divides_any_of(nodes) {
            return vec![0; nodes.len()];
        }
        let mut components = vec![ALONE; nodes.len()];
        let mut count = 0;
        for first in 0..nodes.len() {
            if components[first] != ALONE {
                continue;
            }
            components[first] = count;
            let mut reached = vec![first];
            while let Some(at) = reached.pop() {
                for (neighbour, block) in self.matrix.row(nodes[at] as usize) {
                    let Ok(other) = nodes.binary_search(&(neighbour as u32)) else {
                        continue;
                    };
                    if components[other] == ALONE
                        && self.joins(nodes[at] as usize, neighbour, block)
                    {
                        components[other] = count;
                        reached.push(other);
                    }
                }
            }
            count += 1;
        }
        components
    }

    /// Whether two nodes with this block are to move as one: continuous material joins them, or
    /// walls that resist every translation of one against the other.
    fn joins(&self, node: usize, other: usize, block: &[[f32; 6]; 6]) -> bool {
        !self.continuity.is_broken(node, other) || self.is_whole(node, other, block)
    }

    /// Whether a block of two nodes resists every translation of one against the other: with the
    /// translations `t_i`, `t_j` and `G = (t_i^T t_i + t_j^T t_j) / 2`, whether `-t_i^T A_ij t_j`
    /// is larger than [`WHOLE`] times `G`, as far as they are free.
    fn is_whole(&self, node: usize, other: usize, block: &[[f32; 6]; 6]) -> bool {
        let [own, its] = [&self.modes[node], &self.modes[other]].map(translations);
        let resisted = product(&transpose(&own), &product(&transpose(&widen(block)), &its));
        let sizes = [&own, &its].map(|t| product(&transpose(t), t));
        let (mut size, mut tie) = ([[0.0; 3]; 3], [[0.0; 3]; 3]);
        sizes.iter().for_each(|one| add(&mut size, 0.5, one));
        add(&mut tie, -0.5, &resisted);
        add(&mut tie, -0.5, &transpose(&resisted));
        let (factor, is_free) = inverse_factor(&size, HELD);
        let mut share = product(&product(&factor, &tie), &transpose(&factor));
        for (axis, is_free) in is_free.into_iter().enumerate() {
            share[axis][axis] = if is_free {
                share[axis][axis] - WHOLE
            } else {
                1.0
            };
        }
        inverse_factor(&share, 0.0).1 == [true; 3]
    }
}

/// The translations of a node, as columns of its rows.
fn translations(modes: &Modes<6>) -> [[f64; 3]; 6] {
    modes.map(|[x, y, z, ..]| [x, y, z])
}
