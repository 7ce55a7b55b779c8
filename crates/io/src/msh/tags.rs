//! From node tags to node indices.

use std::collections::HashMap;

/// Marks a tag that no node has.
const NONE: u32 = u32::MAX;

/// Looks up where a node stands in the file.
pub(super) enum TagIndex {
    /// Index by tag, for tags that leave few gaps.
    Dense(Vec<u32>),
    /// For all others.
    Sparse(HashMap<u64, u32>),
}

impl TagIndex {
    /// Indexes tags in file order, of which there must be fewer than 2^32 - 1.
    pub(super) fn new(tags: &[u64]) -> Self {
        let numbered = || tags.iter().copied().zip(0_u32..);
        let largest = tags.iter().copied().max().unwrap_or(0);
        if largest >= 4 * tags.len() as u64 + 1024 {
            return Self::Sparse(numbered().collect());
        }
        let mut index = vec![NONE; largest as usize + 1];
        for (tag, position) in numbered() {
            index[tag as usize] = position;
        }
        Self::Dense(index)
    }

    /// The index of the node with this tag.
    pub(super) fn get(&self, tag: u64) -> Option<u32> {
        match self {
            Self::Dense(index) => index.get(usize::try_from(tag).ok()?).copied(),
            Self::Sparse(index) => index.get(&tag).copied(),
        }
        .filter(|&position| position != NONE)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dense_and_sparse_tags() {
        for tags in [[3, 1, 7], [3, 1, u64::MAX]] {
            let index = TagIndex::new(&tags);
            for (position, &tag) in (0..).zip(&tags) {
                assert_eq!(index.get(tag), Some(position));
            }
            assert_eq!(index.get(2), None);
            assert_eq!(index.get(1 << 40), None);
        }
    }
}
