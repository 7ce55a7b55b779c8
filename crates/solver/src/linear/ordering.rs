//! Nested dissection of the graph of nodes.

use feral_metis::{CscPattern, metis_order};

use super::LinearFailure;
use crate::pattern::Pattern;
use crate::points::Points;

/// Nodes that carry unknowns, in an order that keeps the Cholesky factor sparse.
#[derive(Debug, Clone)]
pub struct NodeOrder(Vec<u32>);

impl NodeOrder {
    /// Orders the nodes by nested dissection.
    ///
    /// # Errors
    /// If the graph is too large for the ordering.
    pub fn of(pattern: &Pattern, points: &Points) -> Result<Self, LinearFailure> {
        let fault = |what: &str| LinearFailure::Analysis(what.to_owned());
        let used: Vec<u32> = (0..points.offset.len() - 1)
            .filter(|&node| !points.of_node(node).is_empty())
            .map(|node| node as u32)
            .collect();
        let mut number = vec![0_i32; points.offset.len() - 1];
        for (index, &node) in used.iter().enumerate() {
            number[node as usize] = i32::try_from(index).map_err(|_| fault("too many nodes"))?;
        }
        let mut column_offset = vec![0_i32];
        let mut row_index = Vec::new();
        for &node in &used {
            let around = pattern.neighbours.of(node as usize).iter();
            let others = around.filter(|&&other| other != node);
            row_index.extend(others.map(|&other| number[other as usize]));
            let end = i32::try_from(row_index.len()).map_err(|_| fault("node graph too large"))?;
            column_offset.push(end);
        }
        let graph = CscPattern::new(used.len(), &column_offset, &row_index)
            .ok_or_else(|| fault("malformed node graph"))?;
        let order = metis_order(&graph).map_err(|error| fault(&error.to_string()))?;
        Ok(Self(order.iter().map(|&i| used[i as usize]).collect()))
    }

    /// Order of the unknown 3-vectors: a node's unknowns stay together, except those that `is_last`
    /// names, which follow behind all others.
    pub(super) fn unknowns(&self, points: &Points, is_last: impl Fn(usize) -> bool) -> Vec<usize> {
        let all = self
            .0
            .iter()
            .flat_map(|&node| points.of_node(node as usize));
        let (last, mut order): (Vec<usize>, Vec<usize>) = all.partition(|&block| is_last(block));
        order.extend(last);
        order
    }
}
