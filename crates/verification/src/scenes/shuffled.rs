//! The same mesh in another order.

use kluft_mesh::{Draft, TaggedElements};

/// The same mesh with nodes, cells and facets in another order, and other first nodes.
pub fn shuffled(draft: &Draft, seed: u64) -> Draft {
    let new_of_old = permutation(draft.nodes.len(), seed);
    let mut shuffled = draft.clone();
    for (old, &new) in new_of_old.iter().enumerate() {
        shuffled.nodes[new] = draft.nodes[old];
        shuffled.node_tags[new] = draft.node_tags[old];
    }
    for (list, from) in [
        (&mut shuffled.cells, &draft.cells),
        (&mut shuffled.facets, &draft.facets),
    ] {
        *list = TaggedElements::new();
        for index in permutation(from.tags.len(), seed + 1) {
            let mut nodes: Vec<u32> = from.elements.nodes_of(index).to_vec();
            // An even permutation keeps the sign of the volume.
            nodes[..3].rotate_left(index % 3);
            let nodes: Vec<u32> = nodes
                .iter()
                .map(|&node| new_of_old[node as usize] as u32)
                .collect();
            list.elements.push(from.elements.shapes[index], &nodes);
            list.tags.push(from.tags[index]);
            list.group_set.push(from.group_set[index]);
        }
    }
    shuffled
}

fn permutation(count: usize, seed: u64) -> Vec<usize> {
    let mut order: Vec<usize> = (0..count).collect();
    let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
    for last in (1..count).rev() {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        order.swap(last, (state % (last as u64 + 1)) as usize);
    }
    order
}
