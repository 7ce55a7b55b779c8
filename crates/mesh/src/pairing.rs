//! Finds what has the same key among millions of items, in a time linear in their number.
//!
//! Items are dealt out by the first number of their key, a node, into parts that fit a processor's
//! cache; what has the same key within a part, a hash table finds. Where the elements lie in the
//! order of their nodes, most items of a part come from a few stretches of elements: these are not
//! dealt out but asked for again. Every part is the work of one task.

use std::ops::Range;

use rayon::prelude::*;

/// Elements whose items one task deals out.
const ELEMENTS_PER_TASK: usize = 16_384;
/// So many nodes have a few hundred kilobytes of faces around them.
const NODES_PER_PART: usize = 512;
/// Each task of the dealing has a list as long as there are parts.
const MOST_PARTS: usize = 1024;
/// Marks the end of a chain, and a free place.
const NONE: u32 = u32::MAX;

/// An item and the three numbers it is matched by, the last two in any order.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Entry {
    pub(crate) key: [u32; 3],
    pub(crate) item: u32,
}

impl Entry {
    /// The key, the same for all entries that match.
    pub(crate) fn sorted_key(&self) -> [u32; 3] {
        let [first, a, b] = self.key;
        [first, a.min(b), a.max(b)]
    }

    fn hash(&self) -> u64 {
        // Odd constants without pattern; only the upper bits are used, and these depend on all.
        const FIRST: u64 = 0x9E37_79B9_7F4A_7C15;
        const SECOND: u64 = 0xD6E8_FEB8_6659_FD93;
        let [first, a, b] = self.sorted_key().map(u64::from);
        let mixed = (first | a << 32).wrapping_mul(FIRST).rotate_left(32) ^ b;
        mixed.wrapping_mul(SECOND)
    }
}

/// Visits every run of two or more entries with one key, in ascending order of their items, and
/// returns what each task has made of its runs. `emit` appends the entries of one of `count`
/// elements, one at least, their keys beginning with a number below `end`. Which run a task visits,
/// and when, depends on the keys alone.
pub(crate) fn visit_runs<A: Default + Send>(
    count: usize,
    end: usize,
    emit: impl Fn(usize, &mut Vec<Entry>) + Sync,
    visit: impl Fn(&mut A, &[Entry]) + Sync,
) -> Vec<A> {
    let parts = Parts::of(end);
    let deal = |entries: &mut Vec<Entry>, task: usize| {
        let first = task * ELEMENTS_PER_TASK;
        let elements = first..count.min(first + ELEMENTS_PER_TASK);
        Dealt::in_order(parts, elements.clone(), &emit, entries)
            .unwrap_or_else(|| Dealt::all(parts, elements, &emit, entries))
    };
    let tasks = (0..count.div_ceil(ELEMENTS_PER_TASK)).into_par_iter();
    let dealt: Vec<Dealt> = tasks.map_init(Vec::new, deal).collect();
    let visit_part = |table: &mut Table, part: usize| {
        let mut answer = A::default();
        table.entries.clear();
        for dealt in &dealt {
            for element in dealt.own(part) {
                parts.emit_into(part, &mut table.entries, |entries| emit(element, entries));
            }
            table.entries.extend(dealt.of_part(part));
        }
        table.visit_runs(|run| visit(&mut answer, run));
        answer
    };
    let all = (0..parts.count).into_par_iter();
    all.map_init(Table::default, visit_part).collect()
}

/// How first numbers of keys are divided.
#[derive(Clone, Copy)]
struct Parts {
    shift: u32,
    count: usize,
}

impl Parts {
    fn of(end: usize) -> Self {
        let per_part = end.div_ceil(MOST_PARTS).max(NODES_PER_PART);
        let shift = per_part.next_power_of_two().ilog2();
        let count = (end >> shift) + 1;
        Self { shift, count }
    }

    fn of_entry(self, entry: &Entry) -> usize {
        (entry.key[0] >> self.shift) as usize
    }

    /// Appends those entries of an element that belong to a part.
    fn emit_into(self, part: usize, entries: &mut Vec<Entry>, emit: impl Fn(&mut Vec<Entry>)) {
        let first = entries.len();
        emit(entries);
        self.keep(entries, first, |entry_part| entry_part == part);
    }

    /// Drops entries of some parts, from `first` on.
    fn keep(self, entries: &mut Vec<Entry>, first: usize, wanted: impl Fn(usize) -> bool) {
        let mut end = first;
        for place in first..entries.len() {
            // Without a branch, for which parts come next cannot be foreseen.
            let entry = entries[place];
            entries[end] = entry;
            end += usize::from(wanted(self.of_entry(&entry)));
        }
        entries.truncate(end);
    }
}

/// What one task has dealt out.
struct Dealt {
    /// First of the elements that each part has to ask for again, and of those behind.
    own: Vec<usize>,
    /// The entries of all other elements, and those that do not belong to the part of their element;
    /// those of one part side by side.
    entries: Vec<Entry>,
    start: Vec<u32>,
}

impl Dealt {
    /// Leaves elements to the parts of their lowest keys, if these ascend.
    fn in_order(
        parts: Parts,
        elements: Range<usize>,
        emit: impl Fn(usize, &mut Vec<Entry>),
        entries: &mut Vec<Entry>,
    ) -> Option<Self> {
        let mut own = Vec::with_capacity(parts.count + 1);
        entries.clear();
        for element in elements.clone() {
            let first = entries.len();
            emit(element, entries);
            let home = entries[first..].iter().map(|entry| parts.of_entry(entry));
            let home = home.min()?;
            if home + 1 < own.len() {
                return None;
            }
            own.resize(home + 1, element);
            parts.keep(entries, first, |part| part != home);
        }
        own.resize(parts.count + 1, elements.end);
        Some(Self::of(parts, own, entries))
    }

    /// Leaves no element to the parts.
    fn all(
        parts: Parts,
        elements: Range<usize>,
        emit: impl Fn(usize, &mut Vec<Entry>),
        entries: &mut Vec<Entry>,
    ) -> Self {
        entries.clear();
        elements.for_each(|element| emit(element, entries));
        Self::of(parts, vec![0; parts.count + 1], entries)
    }

    fn of(parts: Parts, own: Vec<usize>, entries: &[Entry]) -> Self {
        let mut start = vec![0; parts.count + 1];
        for entry in entries {
            start[parts.of_entry(entry) + 1] += 1;
        }
        for part in 0..parts.count {
            start[part + 1] += start[part];
        }
        let mut next = start.clone();
        let mut dealt = vec![Entry::default(); entries.len()];
        for entry in entries {
            let place = &mut next[parts.of_entry(entry)];
            dealt[*place as usize] = *entry;
            *place += 1;
        }
        Self {
            own,
            entries: dealt,
            start,
        }
    }

    fn own(&self, part: usize) -> Range<usize> {
        self.own[part]..self.own[part + 1]
    }

    fn of_part(&self, part: usize) -> &[Entry] {
        let Range { start, end } = self.start[part]..self.start[part + 1];
        &self.entries[start as usize..end as usize]
    }
}

/// The entries of one part and where those with equal keys are.
#[derive(Default)]
struct Table {
    entries: Vec<Entry>,
    /// At the hash of a key, or behind: the first entry with this key.
    first: Vec<u32>,
    /// For each entry another one with its key.
    next: Vec<u32>,
    run: Vec<Entry>,
}

impl Table {
    fn visit_runs(&mut self, mut visit: impl FnMut(&[Entry])) {
        self.link();
        for &first in self.first.iter().filter(|&&first| first != NONE) {
            let mut next = self.next[first as usize];
            if next == NONE {
                continue;
            }
            let [one, other] = [first, next].map(|number| self.entries[number as usize]);
            next = self.next[next as usize];
            if next == NONE {
                // What there is in most chains.
                let pair = [one, other];
                visit(&if one.item < other.item {
                    pair
                } else {
                    [other, one]
                });
                continue;
            }
            self.run.clear();
            self.run.extend([one, other]);
            while next != NONE {
                self.run.push(self.entries[next as usize]);
                next = self.next[next as usize];
            }
            self.run.sort_unstable_by_key(|entry| entry.item);
            visit(&self.run);
        }
    }

    /// Puts each entry into the chain of those with its key.
    fn link(&mut self) {
        // At least half of the places stay free, so that a search is short.
        let bits = (2 * self.entries.len()).max(2).next_power_of_two().ilog2();
        self.first.clear();
        self.first.resize(1 << bits, NONE);
        self.next.clear();
        self.next.resize(self.entries.len(), NONE);
        for (number, entry) in self.entries.iter().enumerate() {
            let mut place = (entry.hash() >> (u64::BITS - bits)) as usize;
            let first = loop {
                let first = &mut self.first[place];
                if *first == NONE {
                    *first = number as u32;
                    break number;
                }
                let found = *first as usize;
                if self.entries[found].sorted_key() == entry.sorted_key() {
                    break found;
                }
                place = (place + 1) & ((1 << bits) - 1);
            };
            if first != number {
                self.next[number] = self.next[first];
                self.next[first] = number as u32;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_hold_all_items_of_a_key() {
        // Element i has the keys of i and i + 1 modulo 50 000, so every key occurs twice, one in
        // turned order; key 0 occurs a thousand times more.
        const COUNT: usize = 50_000;
        let emit = |element: usize, entries: &mut Vec<Entry>| {
            let item = element as u32;
            let key = |i: usize| [i as u32 / 3, i as u32, 7];
            entries.push(Entry {
                key: key(element),
                item,
            });
            let [first, a, b] = key((element + 1) % COUNT);
            entries.push(Entry {
                key: [first, b, a],
                item,
            });
            if element % 50 == 2 {
                entries.push(Entry { key: key(0), item });
            }
        };
        let visit = |found: &mut Vec<Vec<u32>>, run: &[Entry]| {
            found.push(run.iter().map(|entry| entry.item).collect());
        };
        let mut runs = visit_runs(COUNT, COUNT, emit, visit).concat();
        runs.sort_by_key(Vec::len);
        assert_eq!(runs.len(), COUNT);
        let longest = runs.pop().expect("runs");
        assert_eq!(longest.len(), 1002);
        assert!(longest.is_sorted());
        assert!(
            runs.iter()
                .all(|run| run.len() == 2 && run[0] + 1 == run[1])
        );
    }
}
