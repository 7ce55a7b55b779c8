//! The enriched space: points and unknowns of nodes, who couples with whom, what is held.

pub(crate) mod cell;
pub(crate) mod collapse;
mod corner;
mod demands;
pub(crate) mod folded;
pub(crate) mod mechanism;
pub(crate) mod pattern;
mod reactions;
pub(crate) mod rigid_modes;
pub(crate) mod sector_nodes;
pub(crate) mod supports;

use std::ops::Range;

use crate::problem::Problem;

use pattern::Pattern;
use sector_nodes::SectorNodes;
use supports::Supports;

/// What assembly works from.
#[derive(Clone, Copy)]
pub(crate) struct Space<'a> {
    pub(crate) problem: &'a Problem,
    pub(crate) points: &'a SectorNodes,
    pub(crate) supports: &'a Supports,
    pub(crate) pattern: &'a Pattern,
}

impl Space<'_> {
    /// Slots of a node that lie in a range of slots.
    pub(crate) fn slots(&self, node: usize, within: &Range<usize>) -> &[u32] {
        let slots = self.pattern.slots_of(node);
        let start = slots.partition_point(|&slot| (slot as usize) < within.start);
        let end = slots.partition_point(|&slot| (slot as usize) < within.end);
        &slots[start..end]
    }
}
