//! Compressed rows: lists of variable length in one array.

use rayon::prelude::*;

use crate::ownership::RowOwnership;

/// Lists of variable length in one array.
#[derive(Debug, Clone, Default)]
pub struct Lists {
    /// Start of each list; one entry more than there are lists.
    pub offset: Vec<usize>,
    /// All entries.
    pub entries: Vec<u32>,
}

impl Lists {
    /// List `index`.
    pub fn of(&self, index: usize) -> &[u32] {
        &self.entries[self.offset[index]..self.offset[index + 1]]
    }

    /// Number of lists.
    pub fn count(&self) -> usize {
        self.offset.len() - 1
    }

    /// Bytes of storage.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.offset[..]) + size_of_val(&self.entries[..])
    }

    /// Puts lists one behind the other.
    pub fn collect(lists: &[Vec<u32>]) -> Self {
        let mut offset = vec![0];
        for list in lists {
            offset.push(offset[offset.len() - 1] + list.len());
        }
        Self {
            offset,
            entries: lists.concat(),
        }
    }

    /// Groups `0..keys.len()` by key, each group ascending.
    pub fn group(keys: impl Iterator<Item = u32> + Clone, key_count: usize) -> Self {
        let mut offset = vec![0_usize; key_count + 1];
        for key in keys.clone() {
            offset[key as usize + 1] += 1;
        }
        sum_up(&mut offset);
        let mut next = offset.clone();
        let mut entries = vec![0; offset[key_count]];
        for (item, key) in keys.enumerate() {
            entries[next[key as usize]] = item as u32;
            next[key as usize] += 1;
        }
        Self { offset, entries }
    }

    /// Groups the positions in `keys` by key, each group ascending, in parallel.
    ///
    /// Every task owns a range of keys and passes over all of them twice: to count and to fill.
    pub fn occurrences(keys: &[u32], key_count: usize) -> Self {
        let length = key_count.div_ceil(rayon::current_num_threads()).max(1);
        let mut offset = vec![0_usize; key_count + 1];
        offset[1..]
            .par_chunks_mut(length)
            .enumerate()
            .for_each(|(task, counts)| {
                let first = task * length;
                for &key in keys {
                    if let Some(count) = counts.get_mut((key as usize).wrapping_sub(first)) {
                        *count += 1;
                    }
                }
            });
        sum_up(&mut offset);
        let mut entries = vec![0; keys.len()];
        let tasks = RowOwnership::even(key_count, length);
        let shares = tasks.split(&mut entries, &offset);
        shares.into_par_iter().for_each(|(owned, share)| {
            let start = offset[owned.start];
            let own = offset[owned.clone()].iter();
            let mut next: Vec<usize> = own.map(|at| at - start).collect();
            for (item, &key) in keys.iter().enumerate() {
                if let Some(next) = next.get_mut((key as usize).wrapping_sub(owned.start)) {
                    share[*next] = item as u32;
                    *next += 1;
                }
            }
        });
        Self { offset, entries }
    }

    /// Puts the lists of consecutive tasks, lengths and entries, one behind the other.
    pub fn join(tasks: &[(Vec<u32>, Vec<u32>)]) -> Self {
        let lengths = tasks.iter().flat_map(|(lengths, _)| lengths);
        let mut offset = vec![0];
        offset.extend(lengths.map(|&length| length as usize));
        sum_up(&mut offset);
        let mut entries = vec![0; offset[offset.len() - 1]];
        let mut rest = entries.as_mut_slice();
        let mut shares = Vec::new();
        for (_, own) in tasks {
            let (share, tail) = rest.split_at_mut(own.len());
            shares.push((share, own));
            rest = tail;
        }
        let copies = shares.into_par_iter();
        copies.for_each(|(share, own)| share.copy_from_slice(own));
        Self { offset, entries }
    }
}

/// From lengths, behind a zero, to offsets.
pub fn sum_up(lengths: &mut [usize]) {
    let mut sum = 0;
    for length in lengths {
        sum += *length;
        *length = sum;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn occurrences_are_grouped_alike_in_one_task_and_in_many() {
        let keys = [3, 0, 3, 1, 0, 3];
        let expected = Lists::group(keys.into_iter(), 5);
        let found = Lists::occurrences(&keys, 5);
        assert_eq!(found.of(3), [0, 2, 5]);
        assert_eq!(found.count(), 5);
        assert_eq!(
            (found.offset, found.entries),
            (expected.offset, expected.entries)
        );
    }

    #[test]
    fn lists_of_tasks_are_put_one_behind_the_other() {
        let tasks = [(vec![2, 0], vec![7, 8]), (vec![1], vec![9])];
        let lists = Lists::join(&tasks);
        assert_eq!(lists.offset, [0, 2, 2, 3]);
        assert_eq!(lists.entries, [7, 8, 9]);
    }
}
