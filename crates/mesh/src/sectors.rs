//! Sectors of a node: groups of cells that reach each other without crossing a fracture.

use crate::adjacency::{Adjacency, NONE};
use crate::draft::Elements;
use crate::pairing::{Entry, visit_runs};

/// How many sectors each node has, and which of them each cell sees at each of its nodes.
///
/// | sectors | the node is |
/// |---|---|
/// | 0 | in no cell |
/// | 1 | in intact rock, or on a fracture tip |
/// | 2 | inside a fracture |
/// | 3, 4, 8 | on a T, on an X, where three planes meet |
#[derive(Debug, Clone)]
pub struct Sectors {
    /// Number of sectors of each node.
    pub count: Vec<u32>,
    /// Sector at each cell node, in the order of the cells' flat node list. A node's sectors are
    /// numbered by the lowest cell in each.
    pub of_cell_node: Vec<u32>,
}

/// Finds the sectors. `fractured` are the cell faces that carry a fracture facet; they have no
/// neighbour any more in `adjacency`.
pub(crate) fn find(
    cells: &Elements,
    node_count: usize,
    adjacency: &Adjacency,
    fractured: &[(u32, u32)],
) -> Sectors {
    let on_fracture = nodes_on_fractures(cells, node_count, adjacency, fractured);
    let numbering = Numbering::of(cells);
    let emit = |cell: usize, entries: &mut Vec<Entry>| {
        let nodes = (0..).zip(cells.nodes_of(cell));
        let split = nodes.filter(|(_, node)| on_fracture[**node as usize]);
        entries.extend(split.map(|(local, &node)| Entry {
            key: [node, 0, 0],
            item: numbering.item(cell as u32, local),
        }));
    };
    let visit = |star: &mut Star, items: &[Entry]| {
        star.split(cells, adjacency, numbering, items);
    };
    let stars = visit_runs(cells.len(), emit, visit);
    let mut count = vec![0; node_count];
    for &node in &cells.nodes {
        count[node as usize] = 1;
    }
    let mut of_cell_node = vec![0; cells.nodes.len()];
    for star in stars {
        for (node, sectors) in star.counts {
            count[node as usize] = sectors;
        }
        for (slot, sector) in star.sectors {
            of_cell_node[slot as usize] = sector;
        }
    }
    Sectors {
        count,
        of_cell_node,
    }
}

fn nodes_on_fractures(
    cells: &Elements,
    node_count: usize,
    adjacency: &Adjacency,
    fractured: &[(u32, u32)],
) -> Vec<bool> {
    let mut on_fracture = vec![false; node_count];
    for face in fractured.iter().flat_map(|&(minus, plus)| [minus, plus]) {
        for slot in adjacency.slots(cells, face) {
            on_fracture[cells.nodes[slot] as usize] = true;
        }
    }
    on_fracture
}

/// A cell node by one number, ascending like the slots: the cell and the place in the cell.
#[derive(Clone, Copy)]
struct Numbering {
    local_bits: u32,
}

impl Numbering {
    fn of(cells: &Elements) -> Self {
        let most = cells.shapes.iter().map(|shape| shape.node_count()).max();
        let local_bits = most.unwrap_or(1).next_power_of_two().ilog2();
        assert!(
            cells.len() >> (u32::BITS - local_bits) == 0,
            "cell nodes fit 32 bits"
        );
        Self { local_bits }
    }

    fn item(self, cell: u32, local: u32) -> u32 {
        cell << self.local_bits | local
    }

    fn cell_and_local(self, item: u32) -> (u32, u32) {
        (item >> self.local_bits, item & ((1 << self.local_bits) - 1))
    }
}

/// The cells around a node, one node after the other, and what has been found there.
#[derive(Default)]
struct Star {
    /// The node's places in cells, ascending.
    items: Vec<u32>,
    /// For each of them an earlier one in the same sector, or itself.
    earlier: Vec<u32>,
    /// Nodes and how many sectors they have.
    counts: Vec<(u32, u32)>,
    /// Slots that lie in another sector than the first, and in which.
    sectors: Vec<(u32, u32)>,
}

impl Star {
    /// Splits the cells around one node into sectors.
    fn split(
        &mut self,
        cells: &Elements,
        adjacency: &Adjacency,
        numbering: Numbering,
        found: &[Entry],
    ) {
        let node = found[0].key[0];
        self.items.clear();
        self.items.extend(found.iter().map(|entry| entry.item));
        self.earlier.clear();
        self.earlier.extend(0..found.len() as u32);
        for place in 0..found.len() {
            let (cell, local) = numbering.cell_and_local(self.items[place]);
            let faces = cells.shapes[cell as usize].faces();
            for (face, shape) in adjacency.faces_of(cells, cell as usize).zip(faces) {
                let other = adjacency.neighbour[face as usize];
                if other == NONE || other < face || !shape.nodes.contains(&(local as u8)) {
                    continue;
                }
                if let Some(twin) = self.twin(cells, adjacency, numbering, (node, other)) {
                    self.join(place, twin);
                }
            }
        }
        self.number(cells, numbering, node);
    }

    /// Where among the items the face `other` has the node.
    fn twin(
        &self,
        cells: &Elements,
        adjacency: &Adjacency,
        numbering: Numbering,
        (node, other): (u32, u32),
    ) -> Option<usize> {
        let beyond = adjacency.cell_of(other);
        // Faster than a search by halves, for all of the few dozen are compared at once.
        let before = |item: u32| self.items.iter().filter(|&&own| own < item).count();
        let first = before(numbering.item(beyond, 0));
        let is_of_cell = |place: usize| {
            let item = self.items.get(place);
            item.is_some_and(|&item| numbering.cell_and_local(item).0 == beyond)
        };
        if is_of_cell(first) && !is_of_cell(first + 1) {
            return Some(first);
        }
        // A collapsed cell has the node more than once, maybe not on this face.
        let nodes = cells.nodes_of(beyond as usize);
        let locals = adjacency.shape_of(cells, other).nodes.iter();
        let local = locals
            .copied()
            .find(|&local| nodes[local as usize] == node)?;
        let item = numbering.item(beyond, local.into());
        self.items.iter().position(|&own| own == item)
    }

    fn root(&self, mut place: usize) -> usize {
        while self.earlier[place] as usize != place {
            place = self.earlier[place] as usize;
        }
        place
    }

    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        self.earlier[a.max(b)] = a.min(b) as u32;
    }

    /// Numbers the sectors by the lowest cell in each.
    fn number(&mut self, cells: &Elements, numbering: Numbering, node: u32) {
        let mut count = 0;
        for place in 0..self.items.len() {
            // Whatever is earlier has the number of its sector already.
            let earlier = self.earlier[place] as usize;
            let sector = if earlier == place {
                count
            } else {
                self.earlier[earlier]
            };
            count = count.max(sector + 1);
            self.earlier[place] = sector;
            if sector > 0 {
                let (cell, local) = numbering.cell_and_local(self.items[place]);
                self.sectors
                    .push((cells.offsets[cell as usize] + local, sector));
            }
        }
        self.counts.push((node, count));
    }
}
