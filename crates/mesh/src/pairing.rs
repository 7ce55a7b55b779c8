//! Finds what has the same key among millions of items, in a time linear in their number.
//!
//! Items are dealt out by a hash of their key, first into parts that fit a processor's cache, then
//! into buckets of a few; only within a bucket they are sorted. Every part is the work of one task.

use std::ops::Range;

use rayon::prelude::*;

/// Elements whose items one task deals out.
const ELEMENTS_PER_TASK: usize = 16_384;
/// The hash has this many bits for the part.
const PART_BITS: u32 = 7;
const PARTS: usize = 1 << PART_BITS;

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

    /// Orders entries by key, those of one key by item.
    fn rank(&self) -> u128 {
        let digits = |sum: u128, digit: u32| sum << u32::BITS | u128::from(digit);
        self.sorted_key()
            .into_iter()
            .chain([self.item])
            .fold(0, digits)
    }

    fn hash(&self) -> u64 {
        // Odd constants without pattern; only the upper bits are used, and these depend on all.
        const FIRST: u64 = 0x9E37_79B9_7F4A_7C15;
        const SECOND: u64 = 0xD6E8_FEB8_6659_FD93;
        let [first, a, b] = self.sorted_key().map(u64::from);
        let mixed = (first | a << 32).wrapping_mul(FIRST).rotate_left(32) ^ b;
        mixed.wrapping_mul(SECOND)
    }

    fn part(&self) -> usize {
        (self.hash() >> (u64::BITS - PART_BITS)) as usize
    }

    /// The bucket within the part, of `2^bits`.
    fn bucket(&self, bits: u32) -> usize {
        (self.hash() << PART_BITS >> (u64::BITS - bits)) as usize
    }
}

/// Visits every run of two or more entries with one key, in ascending order of their items, and
/// returns what each task has made of its runs. `emit` appends the entries of one of `count`
/// elements; items ascend from element to element. Which run a task visits, and when, depends on the keys alone.
pub(crate) fn visit_runs<A: Default + Send>(
    count: usize,
    emit: impl Fn(usize, &mut Vec<Entry>) + Sync,
    visit: impl Fn(&mut A, &[Entry]) + Sync,
) -> Vec<A> {
    let deal = |entries: &mut Vec<Entry>, task: usize| {
        let first = task * ELEMENTS_PER_TASK;
        entries.clear();
        (first..count.min(first + ELEMENTS_PER_TASK)).for_each(|element| emit(element, entries));
        Dealt::of(entries)
    };
    let tasks = (0..count.div_ceil(ELEMENTS_PER_TASK)).into_par_iter();
    let dealt: Vec<Dealt> = tasks.map_init(Vec::new, deal).collect();
    let visit_part = |buckets: &mut Buckets, part: usize| {
        let mut answer = A::default();
        buckets.fill(&dealt, part);
        buckets.visit_runs(|run| visit(&mut answer, run));
        answer
    };
    let parts = (0..PARTS).into_par_iter();
    parts.map_init(Buckets::default, visit_part).collect()
}

/// The entries of one task, those of one part side by side.
struct Dealt {
    entries: Vec<Entry>,
    start: [u32; PARTS + 1],
}

impl Dealt {
    fn of(entries: &[Entry]) -> Self {
        let mut start = [0; PARTS + 1];
        for entry in entries {
            start[entry.part() + 1] += 1;
        }
        for part in 0..PARTS {
            start[part + 1] += start[part];
        }
        let mut next = start;
        let mut dealt = vec![Entry::default(); entries.len()];
        for entry in entries {
            let place = &mut next[entry.part()];
            dealt[*place as usize] = *entry;
            *place += 1;
        }
        Self {
            entries: dealt,
            start,
        }
    }

    fn of_part(&self, part: usize) -> &[Entry] {
        let Range { start, end } = self.start[part]..self.start[part + 1];
        &self.entries[start as usize..end as usize]
    }
}

/// The entries of one part, those of one bucket side by side.
#[derive(Default)]
struct Buckets {
    entries: Vec<Entry>,
    start: Vec<u32>,
}

impl Buckets {
    fn fill(&mut self, dealt: &[Dealt], part: usize) {
        let entries = || dealt.iter().flat_map(|dealt| dealt.of_part(part));
        let count: usize = dealt.iter().map(|dealt| dealt.of_part(part).len()).sum();
        // One or two entries a bucket: most keys occur twice.
        let bits = count.max(2).ilog2();
        self.start.clear();
        self.start.resize(1 << bits, 0);
        for entry in entries() {
            self.start[entry.bucket(bits)] += 1;
        }
        let mut end = 0;
        for start in &mut self.start {
            (*start, end) = (end, end + *start);
        }
        self.entries.resize(count, Entry::default());
        for entry in entries() {
            let place = &mut self.start[entry.bucket(bits)];
            self.entries[*place as usize] = *entry;
            *place += 1;
        }
        // By now each start has moved on to the next.
    }

    fn visit_runs(&mut self, mut visit: impl FnMut(&[Entry])) {
        let mut start = 0;
        for &end in &self.start {
            let bucket = &mut self.entries[start as usize..end as usize];
            start = end;
            if let [first, second] = bucket {
                // What there is in most buckets, in the order of the items already.
                if first.sorted_key() == second.sorted_key() {
                    visit(bucket);
                }
            } else if bucket.len() > 2 {
                bucket.sort_unstable_by_key(Entry::rank);
                let runs = bucket.chunk_by(|a, b| a.sorted_key() == b.sorted_key());
                runs.filter(|run| run.len() > 1).for_each(&mut visit);
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
        let mut runs = visit_runs(COUNT, emit, visit).concat();
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
