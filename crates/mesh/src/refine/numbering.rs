//! Numbers for nodes that several elements share, from the nodes between which they lie.

use rayon::prelude::*;

/// Elements of which one task collects what they need.
const ELEMENTS_PER_TASK: usize = 8192;

/// A node that an element needs: the nodes that it is known by, ascending, and who asks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Wish<const W: usize> {
    key: [u32; W],
    asked: Asked,
}

/// Which node of which element.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Asked {
    /// The element.
    pub(super) element: u32,
    /// The place of the node in its division.
    pub(super) place: u32,
}

/// What elements ask for.
#[derive(Default)]
pub(super) struct Wishes {
    edges: Vec<Wish<2>>,
    faces: Vec<Wish<4>>,
}

impl Wishes {
    /// Asks for the node between the ends of an edge.
    pub(super) fn edge(&mut self, key: [u32; 2], asked: Asked) {
        let key = ascending(key);
        self.edges.push(Wish { key, asked });
    }

    /// Asks for the node between four corners.
    pub(super) fn face(&mut self, key: [u32; 4], asked: Asked) {
        let key = ascending(key);
        self.faces.push(Wish { key, asked });
    }

    fn sort(&mut self) {
        self.edges.sort_unstable();
        self.edges.dedup_by_key(|wish| wish.key);
        self.faces.sort_unstable();
        self.faces.dedup_by_key(|wish| wish.key);
    }
}

fn ascending<const W: usize>(mut key: [u32; W]) -> [u32; W] {
    key.sort_unstable();
    key
}

/// New nodes between old ones, numbered in the order of their keys: first those of edges, then
/// those of faces.
pub(super) struct Numbers {
    first: u32,
    edges: Keys<2>,
    faces: Keys<4>,
}

/// Distinct keys, ascending, and where those begin whose first node is a given one.
struct Keys<const W: usize> {
    keys: Vec<[u32; W]>,
    start: Vec<u32>,
}

impl Numbers {
    /// Numbers what `count` elements ask for, from `first` on, and tells for each new node the
    /// first element that asks for it; `ask` appends the wishes of an element, between nodes below
    /// `first`. If the numbers run out, the error is how many nodes there would be.
    pub(super) fn of(
        count: usize,
        first: usize,
        ask: impl Fn(u32, &mut Wishes) + Sync,
    ) -> Result<(Self, Vec<Asked>), u64> {
        let collect = |task: usize| {
            let elements = task * ELEMENTS_PER_TASK..count.min((task + 1) * ELEMENTS_PER_TASK);
            let mut wishes = Wishes::default();
            elements.for_each(|element| ask(element as u32, &mut wishes));
            // Most nodes are shared by elements of one task.
            wishes.sort();
            wishes.edges.shrink_to_fit();
            wishes.faces.shrink_to_fit();
            wishes
        };
        let tasks = (0..count.div_ceil(ELEMENTS_PER_TASK)).into_par_iter();
        let found: Vec<Wishes> = tasks.map(collect).collect();
        let (edges, faces): (Vec<_>, Vec<_>) =
            found.into_iter().map(|w| (w.edges, w.faces)).unzip();
        let (edges, faces) = (distinct(edges), distinct(faces));
        let total = first as u64 + edges.len() as u64 + faces.len() as u64;
        if total >= u64::from(u32::MAX) {
            return Err(total);
        }
        let of_edges = edges.iter().map(|wish| wish.asked);
        let asked = of_edges.chain(faces.iter().map(|wish| wish.asked));
        let asked = asked.collect();
        let numbers = Self {
            first: first as u32,
            edges: Keys::of(edges, first),
            faces: Keys::of(faces, first),
        };
        Ok((numbers, asked))
    }

    /// The node between the ends of an edge.
    pub(super) fn edge(&self, key: [u32; 2]) -> u32 {
        self.first + self.edges.place(ascending(key))
    }

    /// The node between four corners.
    pub(super) fn face(&self, key: [u32; 4]) -> u32 {
        let behind = self.first + self.edges.keys.len() as u32;
        behind + self.faces.place(ascending(key))
    }
}

/// All wishes in the order of their keys, each key once with who asked first.
fn distinct<const W: usize>(lists: Vec<Vec<Wish<W>>>) -> Vec<Wish<W>> {
    let mut wishes = Vec::with_capacity(lists.iter().map(Vec::len).sum());
    for list in lists {
        wishes.extend(list);
    }
    wishes.par_sort_unstable();
    wishes.dedup_by_key(|wish| wish.key);
    wishes
}

impl<const W: usize> Keys<W> {
    fn of(wishes: Vec<Wish<W>>, node_count: usize) -> Self {
        let mut start = match wishes.is_empty() {
            true => Vec::new(),
            false => vec![0; node_count + 1],
        };
        for wish in &wishes {
            start[wish.key[0] as usize + 1] += 1;
        }
        let mut sum = 0;
        for entry in &mut start {
            sum += *entry;
            *entry = sum;
        }
        let keys = wishes.into_iter().map(|wish| wish.key).collect();
        Self { keys, start }
    }

    /// Place of a key that has been asked for.
    fn place(&self, key: [u32; W]) -> u32 {
        let lowest = key[0] as usize;
        let first = self.start[lowest];
        let own = &self.keys[first as usize..self.start[lowest + 1] as usize];
        first + own.partition_point(|other| *other < key) as u32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_asked_for_twice_is_one_node_of_who_asked_first() {
        let keys = [[7, 2], [2, 3], [2, 7], [0, 9]];
        let ask = |element: u32, wishes: &mut Wishes| {
            let asked = Asked { element, place: 5 };
            wishes.edge(keys[element as usize], asked);
            wishes.face([4, 3, 8, element / 2], asked);
        };
        let (numbers, asked) = Numbers::of(4, 10, ask).expect("few");
        assert_eq!(
            [[9, 0], [3, 2], [7, 2]].map(|key| numbers.edge(key)),
            [10, 11, 12]
        );
        assert_eq!([0, 1].map(|low| numbers.face([8, low, 4, 3])), [13, 14]);
        let elements: Vec<u32> = asked.iter().map(|asked| asked.element).collect();
        assert_eq!(elements, [3, 1, 0, 0, 2]);
    }

    #[test]
    fn nodes_without_numbers_are_counted() {
        let ask = |element: u32, wishes: &mut Wishes| {
            let asked = Asked { element, place: 0 };
            wishes.edge([0, 1 + element], asked);
        };
        let found = Numbers::of(3, u32::MAX as usize - 1, ask);
        assert_eq!(found.err(), Some(u64::from(u32::MAX) + 2));
    }
}
