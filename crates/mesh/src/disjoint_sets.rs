//! Disjoint sets (union-find).

/// Disjoint sets whose root is always the lowest member, so numbering by roots is reproducible.
pub struct DisjointSets {
    parent: Vec<u32>,
}

impl DisjointSets {
    /// Sets of one member each.
    pub fn new(count: usize) -> Self {
        Self {
            parent: (0..count as u32).collect(),
        }
    }

    /// The lowest member of a set.
    pub fn root(&mut self, member: u32) -> u32 {
        self.stretch().root(member)
    }

    /// Makes one set of those of two members.
    pub fn join(&mut self, a: u32, b: u32) {
        self.stretch().join(a, b);
    }

    fn stretch(&mut self) -> Stretch<'_> {
        Stretch::of(0, &mut self.parent)
    }
}

/// Successive members of disjoint sets that one task looks after: no set reaches beyond them yet.
pub(crate) struct Stretch<'a> {
    first: u32,
    /// For each member one of its set that is not higher; the lowest names itself.
    parent: &'a mut [u32],
}

impl<'a> Stretch<'a> {
    /// The members from `first` on.
    pub(crate) fn of(first: u32, parent: &'a mut [u32]) -> Self {
        Self { first, parent }
    }

    /// Makes a member a set of its own.
    pub(crate) fn single(&mut self, member: u32) {
        *self.above(member) = member;
    }

    pub(crate) fn join(&mut self, a: u32, b: u32) {
        if *self.above(a) == *self.above(b) {
            // As it is most often, where much hangs together.
            return;
        }
        let (a, b) = (self.root(a), self.root(b));
        let (low, high) = (a.min(b), a.max(b));
        *self.above(high) = low;
    }

    fn root(&mut self, mut member: u32) -> u32 {
        loop {
            let above = *self.above(member);
            if above == member {
                return member;
            }
            let next = *self.above(above);
            *self.above(member) = next;
            member = next;
        }
    }

    fn above(&mut self, member: u32) -> &mut u32 {
        &mut self.parent[(member - self.first) as usize]
    }
}
