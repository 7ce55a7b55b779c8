//! Finds what has the same key among millions of items, in a time linear in their number.
//!
//! Items are dealt out by the first number of their key, a node, into parts that fit a processor's
//! cache, and there into buckets, within which they are compared one by one. Where the elements lie
//! in the order of their nodes, most items of a part come from a few stretches of elements: these
//! are not dealt out but asked for again. Every part is the work of one task.

use std::ops::Range;

use rayon::prelude::*;

/// Elements whose items one task deals out.
const ELEMENTS_PER_TASK: usize = 16_384;
/// So many nodes have a few hundred kilobytes of faces around them.
const NODES_PER_PART: usize = 512;
/// Each task of the dealing has a list as long as there are parts.
const MOST_PARTS: usize = 1024;

/// An item and the three numbers it is matched by, the last two in any order.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct KeyedFace {
    pub(crate) key: [u32; 3],
    pub(crate) item: u32,
}

impl KeyedFace {
    /// The key, the same for all entries that match.
    pub(crate) fn sorted_key(&self) -> [u32; 3] {
        let [first, a, b] = self.key;
        [first, a.min(b), a.max(b)]
    }
}

/// Visits every run of two or more entries with one key, in ascending order of their items, and
/// returns what each task has made of its runs. `emit` appends the entries of one of `count`
/// elements, their keys beginning with a number below `end`; `key_range` gives the lowest of these
/// numbers and one that none of them exceeds. Which run a task visits, and when, depends on the
/// keys alone.
pub(crate) fn visit_runs<A: Default + Send>(
    count: usize,
    end: usize,
    key_range: impl Fn(usize) -> (u32, u32) + Sync,
    emit: impl Fn(usize, &mut Vec<KeyedFace>) + Sync,
    visit: impl Fn(&mut A, &[KeyedFace]) + Sync,
) -> Vec<A> {
    let parts = Parts::of(end);
    let deal = |entries: &mut Vec<KeyedFace>, task: usize| {
        let first = task * ELEMENTS_PER_TASK;
        let elements = first..count.min(first + ELEMENTS_PER_TASK);
        Dealt::in_order(parts, elements.clone(), &key_range, &emit, entries)
            .unwrap_or_else(|| Dealt::all(parts, elements, &emit, entries))
    };
    let tasks = (0..count.div_ceil(ELEMENTS_PER_TASK)).into_par_iter();
    let dealt: Vec<Dealt> = tasks.map_init(Vec::new, deal).collect();
    let visit_part = |buckets: &mut Buckets, part: usize| {
        let mut answer = A::default();
        buckets.entries.clear();
        for dealt in &dealt {
            for element in dealt.own(part) {
                parts.emit_into(part, &mut buckets.entries, |entries| emit(element, entries));
            }
            buckets.entries.extend(dealt.of_part(part));
        }
        buckets.visit_runs(parts, |run| visit(&mut answer, run));
        answer
    };
    let all = (0..parts.count).into_par_iter();
    all.map_init(Buckets::default, visit_part).collect()
}

/// The lowest and the highest of some numbers.
pub(crate) fn bounds(numbers: &[u32]) -> (u32, u32) {
    let all = numbers.iter().copied();
    all.fold((u32::MAX, 0), |(low, high), number| {
        (low.min(number), high.max(number))
    })
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

    fn of_number(self, number: u32) -> usize {
        (number >> self.shift) as usize
    }

    fn of_entry(self, entry: &KeyedFace) -> usize {
        self.of_number(entry.key[0])
    }

    /// Appends those entries of an element that belong to a part.
    fn emit_into(
        self,
        part: usize,
        entries: &mut Vec<KeyedFace>,
        emit: impl Fn(&mut Vec<KeyedFace>),
    ) {
        let first = entries.len();
        emit(entries);
        self.keep(entries, first, |entry_part| entry_part == part);
    }

    /// Drops entries of some parts, from `first` on.
    fn keep(self, entries: &mut Vec<KeyedFace>, first: usize, wanted: impl Fn(usize) -> bool) {
        if entries[first..]
            .iter()
            .all(|entry| wanted(self.of_entry(entry)))
        {
            return;
        }
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
    /// The entries of all other elements, and those that do not belong to the part of their
    /// element; those of one part side by side.
    entries: Vec<KeyedFace>,
    start: Vec<u32>,
}

impl Dealt {
    /// Leaves elements to the parts of their lowest keys, if these ascend.
    fn in_order(
        parts: Parts,
        elements: Range<usize>,
        key_range: impl Fn(usize) -> (u32, u32),
        emit: impl Fn(usize, &mut Vec<KeyedFace>),
        entries: &mut Vec<KeyedFace>,
    ) -> Option<Self> {
        let mut own = Vec::with_capacity(parts.count + 1);
        entries.clear();
        for element in elements.clone() {
            let (home, last) = key_range(element);
            let (home, last) = (parts.of_number(home), parts.of_number(last));
            if home + 1 < own.len() {
                return None;
            }
            own.resize(home + 1, element);
            if last > home {
                let first = entries.len();
                emit(element, entries);
                parts.keep(entries, first, |part| part != home);
            }
        }
        own.resize(parts.count + 1, elements.end);
        Some(Self::of(parts, own, entries))
    }

    /// Leaves no element to the parts.
    fn all(
        parts: Parts,
        elements: Range<usize>,
        emit: impl Fn(usize, &mut Vec<KeyedFace>),
        entries: &mut Vec<KeyedFace>,
    ) -> Self {
        entries.clear();
        elements.for_each(|element| emit(element, entries));
        Self::of(parts, vec![0; parts.count + 1], entries)
    }

    fn of(parts: Parts, own: Vec<usize>, entries: &[KeyedFace]) -> Self {
        let mut start = vec![0; parts.count + 1];
        for entry in entries {
            start[parts.of_entry(entry) + 1] += 1;
        }
        for part in 0..parts.count {
            start[part + 1] += start[part];
        }
        let mut next = start.clone();
        let mut dealt = vec![KeyedFace::default(); entries.len()];
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

    fn of_part(&self, part: usize) -> &[KeyedFace] {
        let Range { start, end } = self.start[part]..self.start[part + 1];
        &self.entries[start as usize..end as usize]
    }
}

/// The entries of one part.
#[derive(Default)]
struct Buckets {
    /// As they come.
    entries: Vec<KeyedFace>,
    /// Those whose keys begin with the same number side by side.
    sorted: Vec<KeyedFace>,
    end: Vec<u32>,
}

impl Buckets {
    fn visit_runs(&mut self, parts: Parts, mut visit: impl FnMut(&[KeyedFace])) {
        self.sort(parts);
        let mut start = 0;
        for &end in &self.end {
            visit_bucket(&mut self.sorted[start..end as usize], &mut visit);
            start = end as usize;
        }
    }

    fn sort(&mut self, parts: Parts) {
        let bucket = |entry: &KeyedFace| entry.key[0] as usize & ((1 << parts.shift) - 1);
        self.end.clear();
        self.end.resize(1 << parts.shift, 0);
        for entry in &self.entries {
            self.end[bucket(entry)] += 1;
        }
        let mut sum = 0;
        for end in &mut self.end {
            (*end, sum) = (sum, sum + *end);
        }
        self.sorted.resize(self.entries.len(), KeyedFace::default());
        for entry in &self.entries {
            // A begin that moves on to the end.
            let end = &mut self.end[bucket(entry)];
            self.sorted[*end as usize] = *entry;
            *end += 1;
        }
    }
}

/// Visits the runs among entries whose keys begin alike: around a node there are a few dozen.
fn visit_bucket(bucket: &mut [KeyedFace], visit: &mut impl FnMut(&[KeyedFace])) {
    const MANY: usize = 64;
    if bucket.len() > MANY {
        return visit_sorted(bucket, visit);
    }
    let (mut first, mut end) = (0, bucket.len());
    while first < end {
        let one = bucket[first];
        let key = one.sorted_key();
        let (mut twin, mut twins) = (first, 0);
        // Without a branch, for where the twin is cannot be foreseen.
        for (place, entry) in bucket[..end].iter().enumerate().skip(first + 1) {
            let is_twin = entry.sorted_key() == key;
            twin = if is_twin { place } else { twin };
            twins += usize::from(is_twin);
        }
        if twins > 1 {
            return visit_sorted(&mut bucket[first..end], visit);
        }
        first += 1;
        if twins == 1 {
            let other = bucket[twin];
            end -= 1;
            bucket[twin] = bucket[end];
            visit(&if one.item < other.item {
                [one, other]
            } else {
                [other, one]
            });
        }
    }
}

fn visit_sorted(bucket: &mut [KeyedFace], visit: &mut impl FnMut(&[KeyedFace])) {
    bucket.sort_unstable_by_key(|entry| (entry.sorted_key(), entry.item));
    let runs = bucket.chunk_by(|a, b| a.sorted_key() == b.sorted_key());
    runs.filter(|run| run.len() > 1).for_each(visit);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_hold_all_items_of_a_key() {
        // Element i has the keys of i and i + 1 modulo 50 000, so every key occurs twice, one in
        // turned order; key 0 occurs a thousand times more.
        const COUNT: usize = 50_000;
        let emit = |element: usize, entries: &mut Vec<KeyedFace>| {
            let item = element as u32;
            let key = |i: usize| [i as u32 / 3, i as u32, 7];
            entries.push(KeyedFace {
                key: key(element),
                item,
            });
            let [first, a, b] = key((element + 1) % COUNT);
            entries.push(KeyedFace {
                key: [first, b, a],
                item,
            });
            if element % 50 == 2 {
                entries.push(KeyedFace { key: key(0), item });
            }
        };
        // Element 2 and others lie in two parts; the elements do not all ascend.
        let key_range = |element: usize| {
            let firsts = [element, (element + 1) % COUNT].map(|i| i as u32 / 3);
            let low = if element % 50 == 2 {
                0
            } else {
                firsts[0].min(firsts[1])
            };
            (low, firsts[0].max(firsts[1]))
        };
        let visit = |found: &mut Vec<Vec<u32>>, run: &[KeyedFace]| {
            found.push(run.iter().map(|entry| entry.item).collect());
        };
        let mut runs = visit_runs(COUNT, COUNT, key_range, emit, visit).concat();
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
