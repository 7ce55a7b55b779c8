//! Patches of fractures: neighbouring rows, then neighbouring patches, until nothing joins.

use kluft_algebra::Lists;
use kluft_algebra::multigrid::neighbourhoods;

/// Nested patches of the rows of a flow.
#[derive(Debug, Clone)]
pub(super) struct Patches {
    /// The narrowest first.
    pub(super) levels: Vec<PatchLevel>,
}

/// Patches of about one width.
#[derive(Debug, Clone)]
pub(super) struct PatchLevel {
    /// The patch in which each row lies, or each patch of the level before.
    pub(super) parents: Vec<u32>,
    /// Number of patches.
    pub(super) count: usize,
}

impl Patches {
    /// The patches of rows of which the neighbours are given, themselves among them.
    pub(super) fn of(neighbours: &Lists) -> Self {
        let mut levels = Vec::new();
        let mut graph = neighbours.clone();
        loop {
            let (parents, count) = neighbourhoods(&graph);
            if count == graph.count() {
                break Self { levels };
            }
            graph = joined(&graph, &parents, count);
            levels.push(PatchLevel { parents, count });
        }
    }
}

/// Which patches have neighbours in each other, themselves among them.
fn joined(graph: &Lists, parents: &[u32], count: usize) -> Lists {
    let mut neighbours = vec![Vec::new(); count];
    for (row, &own) in parents.iter().enumerate() {
        let others = graph.of(row).iter().map(|&other| parents[other as usize]);
        neighbours[own as usize].extend(others);
    }
    for list in &mut neighbours {
        list.sort_unstable();
        list.dedup();
    }
    Lists::collect(&neighbours)
}
