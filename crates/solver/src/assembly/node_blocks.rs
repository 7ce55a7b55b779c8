//! Where the rows of consecutive nodes are stored, of which some blocks are not.

use std::ops::Range;

use glam::DMat3;
use kluft_algebra::BlockPattern;

use crate::space::sector_nodes::SectorNodes;

/// The stored blocks of the rows of some nodes.
pub(crate) struct NodeBlocks<'a> {
    points: &'a SectorNodes,
    pattern: &'a BlockPattern,
    nodes: Range<usize>,
    blocks: &'a mut [DMat3],
}

impl<'a> NodeBlocks<'a> {
    /// `blocks` are those that the pattern stores in the rows of `nodes`.
    pub(crate) fn of(
        points: &'a SectorNodes,
        pattern: &'a BlockPattern,
        nodes: Range<usize>,
        blocks: &'a mut [DMat3],
    ) -> Self {
        Self {
            points,
            pattern,
            nodes,
            blocks,
        }
    }

    /// The nodes.
    pub(crate) fn nodes(&self) -> Range<usize> {
        self.nodes.clone()
    }

    /// Writes zeros.
    pub(crate) fn clear(&mut self) {
        self.blocks.fill(DMat3::ZERO);
    }

    /// Sets the rows of a node; `rows` are all of their blocks, row after row of equal length.
    pub(crate) fn set(&mut self, node: usize, rows: &[DMat3]) {
        self.each(node, rows, |target, block| *target = block);
    }

    /// Adds to the rows of a node, given as in [`Self::set`].
    pub(crate) fn add(&mut self, node: usize, rows: &[DMat3]) {
        self.each(node, rows, |target, block| *target += block);
    }

    #[inline]
    fn each(&mut self, node: usize, rows: &[DMat3], treat: impl Fn(&mut DMat3, DMat3)) {
        let own = self.points.of_node(node);
        let start = self
            .pattern
            .stored_offset(self.points.offset[self.nodes.start] as usize);
        let length = rows.len() / own.len();
        for (row, blocks) in own.zip(rows.chunks(length)) {
            let stored = self.pattern.stored(row);
            let targets = &mut self.blocks[stored.start - start..stored.end - start];
            let places = self.pattern.stored_places(row);
            for (target, place) in targets.iter_mut().zip(places) {
                treat(target, blocks[place]);
            }
        }
    }
}
