//! Disjoint sets (union-find) that many threads may join.

use std::sync::atomic::{AtomicU32, Ordering};

use rayon::prelude::*;

/// Disjoint sets whose root is always the lowest member: whatever the order of joins, and whoever
/// makes them, the roots are the same in the end.
pub(crate) struct DisjointSets {
    parent: Vec<AtomicU32>,
}

impl DisjointSets {
    pub(crate) fn new(count: usize) -> Self {
        let members = (0..count as u32).into_par_iter();
        Self {
            parent: members.map(AtomicU32::new).collect(),
        }
    }

    /// The lowest member of the set of `member`.
    pub(crate) fn root(&self, mut member: u32) -> u32 {
        loop {
            let above = self.above(member);
            if above == member {
                return member;
            }
            let next = self.above(above);
            if next != above {
                // Another thread may have shortened the way as well; any member further up will do.
                self.parent[member as usize].store(next, Ordering::Relaxed);
            }
            member = next;
        }
    }

    fn above(&self, member: u32) -> u32 {
        self.parent[member as usize].load(Ordering::Relaxed)
    }

    /// Makes one set of two.
    pub(crate) fn join(&self, mut a: u32, mut b: u32) {
        loop {
            (a, b) = (self.root(a), self.root(b));
            if a == b {
                return;
            }
            let (low, high) = (a.min(b), a.max(b));
            // Fails where another thread has put something above `high` meanwhile.
            let order = Ordering::Relaxed;
            if self.parent[high as usize]
                .compare_exchange(high, low, order, order)
                .is_ok()
            {
                return;
            }
        }
    }

    /// The root of every member.
    pub(crate) fn into_roots(self) -> Vec<u32> {
        let members = (0..self.parent.len() as u32).into_par_iter();
        members.for_each(|member| {
            let root = self.root(member);
            self.parent[member as usize].store(root, Ordering::Relaxed);
        });
        let roots = self.parent.into_iter();
        roots.map(AtomicU32::into_inner).collect()
    }
}
