//! Nodes and cells in an order that keeps neighbours together.
//!
//! gmsh numbers nodes and cells as it finds them: cells that share a face lie half a file apart.
//! Every loop over a large mesh then waits for memory. Along a space-filling curve it does not.

use rayon::prelude::*;

use crate::draft::{Draft, Elements, TaggedElements, split};

/// Bits of a coordinate on the curve.
const BITS: u32 = 21;

/// Elements that one task takes in hand.
const ELEMENTS_PER_TASK: usize = 8192;

impl Draft {
    /// Numbers the nodes along a Morton curve and sorts the cells by their first node on it. Tags,
    /// shapes and groups go along; facets and lines keep their order.
    pub fn arrange(&mut self) {
        let order = along_curve(&self.nodes);
        let mut number = vec![0_u32; order.len()];
        for (new, &old) in order.iter().enumerate() {
            number[old as usize] = new as u32;
        }
        let mut cells = std::mem::take(&mut self.cells);
        let lowest = renumber(&mut cells.elements, &number);
        // The sorting is one thread's work, which leaves the others to the nodes.
        let (cell_order, ()) = rayon::join(
            || sorted(&lowest, number.len()),
            || self.renumber_nodes(&order, &number),
        );
        self.cells = TaggedElements {
            elements: permuted_elements(cells.elements, &cell_order),
            tags: permuted(&cells.tags, &cell_order),
            group_set: arranged(cells.group_set, &cell_order),
        };
    }

    fn renumber_nodes(&mut self, order: &[u32], number: &[u32]) {
        self.nodes = permuted(&self.nodes, order);
        self.node_tags = permuted(&self.node_tags, order);
        for elements in [&mut self.facets, &mut self.lines] {
            let nodes = elements.elements.nodes.par_iter_mut();
            nodes.for_each(|node| *node = number[*node as usize]);
        }
    }
}

/// Values in another order; nothing is done where all are the same.
fn arranged<T: Copy + PartialEq + Send + Sync>(values: Vec<T>, order: &[u32]) -> Vec<T> {
    if values.windows(2).all(|pair| pair[0] == pair[1]) {
        return values;
    }
    permuted(&values, order)
}

fn permuted<T: Copy + Send + Sync>(values: &[T], order: &[u32]) -> Vec<T> {
    let order = order.par_iter();
    order.map(|&old| values[old as usize]).collect()
}

/// Nodes in the order of the curve; those at one place in the order they had.
fn along_curve(nodes: &[[f64; 3]]) -> Vec<u32> {
    let mut low = [f64::INFINITY; 3];
    let mut high = [f64::NEG_INFINITY; 3];
    for node in nodes {
        for axis in 0..3 {
            low[axis] = low[axis].min(node[axis]);
            high[axis] = high[axis].max(node[axis]);
        }
    }
    let extent = (0..3)
        .map(|axis| high[axis] - low[axis])
        .fold(0.0, f64::max);
    let scale = f64::from((1_u32 << BITS) - 1) / extent;
    let key = |node: &[f64; 3]| {
        // Conversion saturates, so coordinates that are not finite get some place as well.
        let spread = |axis: usize| spread_bits(((node[axis] - low[axis]) * scale) as u64);
        spread(0) | spread(1) << 1 | spread(2) << 2
    };
    let indexed = nodes.par_iter().enumerate();
    let mut keys: Vec<(u64, u32)> = indexed.map(|(i, node)| (key(node), i as u32)).collect();
    keys.par_sort_unstable();
    keys.into_iter().map(|(_, index)| index).collect()
}

/// Puts two zeros behind each of the lowest [`BITS`] bits.
fn spread_bits(value: u64) -> u64 {
    let mut bits = value.min((1 << BITS) - 1);
    bits = (bits | bits << 32) & 0x001f_0000_0000_ffff;
    bits = (bits | bits << 16) & 0x001f_0000_ff00_00ff;
    bits = (bits | bits << 8) & 0x100f_00f0_0f00_f00f;
    bits = (bits | bits << 4) & 0x10c3_0c30_c30c_30c3;
    (bits | bits << 2) & 0x1249_2492_4924_9249
}

/// Gives the nodes of elements other numbers and returns the lowest of each element.
fn renumber(elements: &mut Elements, number: &[u32]) -> Vec<u32> {
    let offsets = &elements.offsets;
    let mut lowest = vec![0; elements.shapes.len()];
    let tasks = split(offsets, ELEMENTS_PER_TASK, &mut elements.nodes).into_par_iter();
    let tasks = tasks.zip(lowest.par_chunks_mut(ELEMENTS_PER_TASK));
    tasks.for_each(|((stretch, nodes), lowest)| {
        let start = offsets[stretch.start];
        for (element, lowest) in stretch.zip(lowest) {
            let [first, end] = [0, 1].map(|behind| (offsets[element + behind] - start) as usize);
            let own = &mut nodes[first..end];
            own.iter_mut()
                .for_each(|node| *node = number[*node as usize]);
            *lowest = own.iter().copied().min().unwrap_or(0);
        }
    });
    lowest
}

/// Elements sorted by their lowest nodes, by counting.
fn sorted(lowest: &[u32], node_count: usize) -> Vec<u32> {
    let mut next = vec![0_u32; node_count + 1];
    for &node in lowest {
        next[node as usize + 1] += 1;
    }
    for node in 0..node_count {
        next[node + 1] += next[node];
    }
    let mut order = vec![0; lowest.len()];
    for (element, &node) in lowest.iter().enumerate() {
        let place = &mut next[node as usize];
        order[*place as usize] = element as u32;
        *place += 1;
    }
    order
}

fn permuted_elements(elements: Elements, order: &[u32]) -> Elements {
    let mut nodes = vec![0; elements.nodes.len()];
    let distinct = elements.distinct_shapes();
    let offsets = if let [shape] = distinct.as_slice() {
        // The offsets, which would have to be looked up in any order, are known.
        let width = shape.node_count();
        let nodes_of = |element: usize| &elements.nodes[element * width..][..width];
        permute_nodes(&elements.offsets, order, &mut nodes, nodes_of);
        elements.offsets
    } else {
        let offsets = new_offsets(&elements, order);
        let nodes_of = |element: usize| elements.nodes_of(element);
        permute_nodes(&offsets, order, &mut nodes, nodes_of);
        offsets
    };
    Elements {
        shapes: arranged(elements.shapes, order),
        offsets,
        nodes,
    }
}

/// Fills the nodes of elements with these offsets from those they had in another order.
fn permute_nodes<'a>(
    offsets: &[u32],
    order: &[u32],
    nodes: &mut [u32],
    old: impl Fn(usize) -> &'a [u32] + Sync,
) {
    let tasks = split(offsets, ELEMENTS_PER_TASK, nodes).into_par_iter();
    tasks.for_each(|(stretch, mut nodes)| {
        for &element in &order[stretch] {
            let old = old(element as usize);
            let own = nodes.split_off_mut(..old.len()).unwrap_or_default();
            own.copy_from_slice(old);
        }
    });
}

fn new_offsets(elements: &Elements, order: &[u32]) -> Vec<u32> {
    let mut end = 0;
    let ends = order.iter().map(|&old| {
        end += elements.shapes[old as usize].node_count() as u32;
        end
    });
    std::iter::once(0).chain(ends).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::structured::tetrahedra;

    /// Tag, group set, tags of nodes and bits of their coordinates.
    type Content = (u64, u32, Vec<u64>, Vec<[u64; 3]>);

    /// Everything an arranged draft says of its elements, whatever their order.
    fn content(draft: &Draft) -> Vec<Content> {
        let mut all = Vec::new();
        for part in [&draft.cells, &draft.facets] {
            for element in 0..part.elements.len() {
                let nodes = part.elements.nodes_of(element).iter();
                let nodes: Vec<usize> = nodes.map(|&node| node as usize).collect();
                all.push((
                    part.tags[element],
                    part.group_set[element],
                    nodes.iter().map(|&node| draft.node_tags[node]).collect(),
                    nodes
                        .iter()
                        .map(|&node| draft.nodes[node].map(f64::to_bits))
                        .collect(),
                ));
            }
        }
        all.sort();
        all
    }

    #[test]
    fn nothing_is_lost_and_neighbours_come_together() {
        let mut draft = tetrahedra([5, 6, 7], [1.0, 2.0, 0.5], &[]);
        let before = content(&draft);
        draft.arrange();
        assert_eq!(content(&draft), before);
        let cells = &draft.cells.elements;
        let lowest: Vec<u32> = (0..cells.len())
            .map(|cell| cells.nodes_of(cell).iter().copied().min().expect("nodes"))
            .collect();
        assert!(lowest.is_sorted());
        let once = draft.nodes.clone();
        draft.arrange();
        assert_eq!(draft.nodes, once);
    }

    #[test]
    fn bits_are_spread() {
        assert_eq!(spread_bits(0b1011), 0b001_000_001_001);
        assert_eq!(spread_bits(u64::MAX).count_ones(), BITS);
    }

    #[test]
    fn nodes_without_a_place_do_no_harm() {
        let mut draft = tetrahedra([2, 2, 2], [1.0; 3], &[]);
        draft.nodes[5] = [f64::NAN, f64::INFINITY, 0.0];
        draft.arrange();
        assert_eq!(draft.nodes.len(), 27);
    }
}
