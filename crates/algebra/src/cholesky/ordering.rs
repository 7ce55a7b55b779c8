//! An order of elimination that keeps the factor sparse: nested dissection of the graph of nodes.

use feral_metis::{CscPattern, metis_order};

use crate::failure::LinearFailure;
use crate::lists::Lists;

/// Nodes that carry unknowns, in an order that keeps the Cholesky factor sparse.
#[derive(Debug, Clone)]
pub struct NodeOrder(Vec<u32>);

impl NodeOrder {
    /// Orders the nodes of a symmetric `graph` by nested dissection. Node `n` has the unknown 3-vectors
    /// `first_unknown[n]..first_unknown[n + 1]`, which may be none; the graph may hold a node among its
    /// own neighbours.
    ///
    /// # Errors
    /// If the graph is too large for the ordering.
    pub fn of(graph: &Lists, first_unknown: &[u32]) -> Result<Self, LinearFailure> {
        let used: Vec<u32> = (0..graph.count())
            .filter(|&node| first_unknown[node] < first_unknown[node + 1])
            .map(|node| node as u32)
            .collect();
        let mut number = vec![0; graph.count()];
        for (index, &node) in used.iter().enumerate() {
            number[node as usize] = index as u32;
        }
        let neighbours = |index: usize| {
            let around = graph.of(used[index] as usize).iter();
            around.map(|&other| number[other as usize])
        };
        let order = nested_dissection(used.len(), neighbours)?;
        Ok(Self(order.iter().map(|&i| used[i]).collect()))
    }

    /// Order of the unknown 3-vectors: a node's unknowns stay together.
    pub fn all(&self, first_unknown: &[u32]) -> Vec<usize> {
        self.with_last(first_unknown, |_| false)
    }

    /// Order of the unknown 3-vectors: a node's unknowns stay together, except those that `is_last`
    /// names, which follow behind all others.
    pub fn with_last(&self, first_unknown: &[u32], is_last: impl Fn(usize) -> bool) -> Vec<usize> {
        let unknowns = |node: &u32| {
            let node = *node as usize;
            first_unknown[node] as usize..first_unknown[node + 1] as usize
        };
        let all = self.0.iter().flat_map(unknowns);
        let (last, mut order): (Vec<usize>, Vec<usize>) = all.partition(|&block| is_last(block));
        order.extend(last);
        order
    }
}

/// Order of elimination for a symmetric graph, which may hold a vertex among its own neighbours.
///
/// # Errors
/// If the graph is too large for the ordering.
fn nested_dissection<I: Iterator<Item = u32>>(
    count: usize,
    neighbours: impl Fn(usize) -> I,
) -> Result<Vec<usize>, LinearFailure> {
    let fault = |what: &str| LinearFailure::Analysis(what.to_owned());
    let too_large = || fault("the graph is too large for the ordering");
    i32::try_from(count).map_err(|_| too_large())?;
    let mut column_offset = vec![0_i32];
    let mut row_index = Vec::new();
    for vertex in 0..count {
        let others = neighbours(vertex).filter(|&other| other as usize != vertex);
        row_index.extend(others.map(|other| other as i32));
        column_offset.push(i32::try_from(row_index.len()).map_err(|_| too_large())?);
    }
    let graph = CscPattern::new(count, &column_offset, &row_index)
        .ok_or_else(|| fault("malformed graph"))?;
    let order = metis_order(&graph).map_err(|error| fault(&error.to_string()))?;
    Ok(order.iter().map(|&vertex| vertex as usize).collect())
}
