//! An order of elimination that keeps the factor sparse: nested dissection of the graph of nodes.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::amd;
use feral_metis::{CscPattern, metis_order};

use crate::failure::LinearFailure;
use crate::lists::Lists;

/// Nodes that carry unknowns, in an order that keeps the Cholesky factor sparse.
#[derive(Debug, Clone)]
pub struct NodeOrder(Vec<u32>);

impl NodeOrder {
    /// Orders the nodes of a symmetric `graph` by nested dissection. Node `n` has the unknown
    /// 3-vectors `first_unknown[n]..first_unknown[n + 1]`, which may be none; the graph may hold a
    /// node among its own neighbours.
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
    or_minimum_degree(metis_order(&graph).ok(), &column_offset, &row_index)
}

/// What an ordering has answered, if it is a permutation; another ordering otherwise.
fn or_minimum_degree(
    answer: Option<Vec<i32>>,
    column_offset: &[i32],
    row_index: &[i32],
) -> Result<Vec<usize>, LinearFailure> {
    let count = column_offset.len() - 1;
    let order = answer.and_then(|order| permutation(&order, count));
    order.map_or_else(|| minimum_degree(column_offset, row_index), Ok)
}

/// An order as indices, if it names each of `count` vertices once.
fn permutation(order: &[i32], count: usize) -> Option<Vec<usize>> {
    let mut is_missing = vec![true; count];
    let take = |&vertex: &i32| {
        let vertex = usize::try_from(vertex).ok()?;
        let is_new = std::mem::take(is_missing.get_mut(vertex)?);
        is_new.then_some(vertex)
    };
    let order: Vec<usize> = order.iter().map(take).collect::<Option<_>>()?;
    (order.len() == count).then_some(order)
}

/// Approximate minimum degree, for graphs that nested dissection has no valid answer to.
fn minimum_degree(column_offset: &[i32], row_index: &[i32]) -> Result<Vec<usize>, LinearFailure> {
    let wide = |numbers: &[i32]| -> Vec<usize> { numbers.iter().map(|&n| n as usize).collect() };
    let (offsets, rows) = (wide(column_offset), wide(row_index));
    let count = offsets.len() - 1;
    let graph = SymbolicSparseColMatRef::new_unsorted_checked(count, count, &offsets, None, &rows);
    let (mut order, mut place) = (vec![0; count], vec![0; count]);
    let scratch = amd::order_maybe_unsorted_scratch::<usize>(count, rows.len());
    let mut memory = MemBuffer::try_new(scratch)
        .map_err(|_| LinearFailure::Analysis("no memory for the ordering".to_owned()))?;
    let stack = MemStack::new(&mut memory);
    amd::order_maybe_unsorted(
        &mut order,
        &mut place,
        graph,
        amd::Control::default(),
        stack,
    )
    .map_err(|error| LinearFailure::Analysis(format!("no ordering: {error:?}")))?;
    Ok(order)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_order_that_is_no_permutation_is_none() {
        assert_eq!(permutation(&[2, 0, 1], 3), Some(vec![2, 0, 1]));
        for broken in [
            &[0, 1][..],
            &[0, 1, 1],
            &[0, 1, 3],
            &[0, 1, -1],
            &[0, 1, 2, 0],
        ] {
            assert_eq!(permutation(broken, 3), None, "{broken:?}");
        }
    }

    #[test]
    fn broken_answers_are_replaced_by_an_order_that_keeps_the_factor_sparse() {
        // A star: its centre, vertex 2, joins all vertices that come after it.
        const COUNT: i32 = 9;
        let leaves: Vec<i32> = (0..COUNT).filter(|&vertex| vertex != 2).collect();
        let (mut offsets, mut rows) = (vec![0], Vec::new());
        for vertex in 0..COUNT {
            rows.extend_from_slice(if vertex == 2 { &leaves } else { &[2] });
            offsets.push(rows.len() as i32);
        }
        let sound: Vec<i32> = (0..COUNT).rev().collect();
        let kept = or_minimum_degree(Some(sound.clone()), &offsets, &rows).expect("an order");
        assert!(kept.iter().map(|&vertex| vertex as i32).eq(sound));
        for broken in [None, Some(vec![2; 9]), Some(vec![0, 1])] {
            let order = or_minimum_degree(broken, &offsets, &rows).expect("an order");
            let mut sorted = order.clone();
            sorted.sort_unstable();
            assert!(sorted.into_iter().eq(0..9), "{order:?}");
            let centre = order.iter().position(|&vertex| vertex == 2);
            assert!(centre >= Some(7), "{order:?}");
        }
    }
}
