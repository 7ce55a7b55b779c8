//! Makes several nodes of a draft one.

use std::collections::BTreeMap;

use kluft_defect::{Defect, sample};

use crate::draft::{Draft, Elements};

impl Draft {
    /// Makes nodes one, given as nodes with one of their set, and returns how many have gone.
    pub(crate) fn merge(&mut self, merged: &[(u32, u32)]) -> Result<usize, Vec<Defect>> {
        if merged.is_empty() {
            return Ok(0);
        }
        let mut lowest_tag: BTreeMap<u32, u32> = BTreeMap::new();
        let tag = |node: u32| self.node_tags[node as usize];
        for &(node, root) in merged {
            let kept = lowest_tag.entry(root).or_insert(node);
            if tag(node) < tag(*kept) {
                *kept = node;
            }
        }
        let mut target: Vec<u32> = (0..self.nodes.len() as u32).collect();
        for &(node, root) in merged {
            target[node as usize] = lowest_tag[&root];
        }
        let collapsed = self.collapsed(&target);
        if !collapsed.is_empty() {
            return Err(vec![Defect::new(
                format!("{}, cell {}", self.source, sample(&collapsed)),
                "the cell collapses when nodes at one place become one node",
                "remove the sliver from the geometry and mesh it again",
            )]);
        }
        self.drop_copies(&target);
        Ok(self.renumber(target))
    }

    /// Tags of cells of which different nodes become one.
    fn collapsed(&self, target: &[u32]) -> Vec<u64> {
        let cells = &self.cells.elements;
        let becomes = |node: u32| target[node as usize];
        let is_collapsed = |cell: &usize| {
            let nodes = cells.nodes_of(*cell);
            let is_moved = nodes.iter().any(|&node| becomes(node) != node);
            is_moved
                && nodes.iter().enumerate().any(|(place, &a)| {
                    let before = nodes[..place].iter();
                    before.copied().any(|b| a != b && becomes(a) == becomes(b))
                })
        };
        let found = (0..cells.len()).filter(is_collapsed);
        found.map(|cell| self.cells.tags[cell]).collect()
    }

    /// Drops facets that become the same as one before them of the same groups. Those that were
    /// the same already stay, to be told of.
    fn drop_copies(&mut self, target: &[u32]) {
        let elements = &self.facets.elements;
        let mut seen: BTreeMap<(Vec<u32>, u32), Vec<u32>> = BTreeMap::new();
        let mut kept = Elements::new();
        let mut is_kept = Vec::with_capacity(elements.len());
        for facet in 0..elements.len() {
            let sorted = |nodes: &mut dyn Iterator<Item = u32>| {
                let mut nodes: Vec<u32> = nodes.collect();
                nodes.sort_unstable();
                nodes
            };
            let own = elements.nodes_of(facet);
            let before = sorted(&mut own.iter().copied());
            let after = sorted(&mut own.iter().map(|&node| target[node as usize]));
            let key = (after, self.facets.group_set[facet]);
            let first = seen.entry(key).or_insert_with(|| before.clone());
            let stays = *first == before;
            is_kept.push(stays);
            if stays {
                kept.push(elements.shapes[facet], own);
            }
        }
        let mut flags = is_kept.iter();
        self.facets.tags.retain(|_| flags.next() == Some(&true));
        let mut flags = is_kept.iter();
        self.facets
            .group_set
            .retain(|_| flags.next() == Some(&true));
        self.facets.elements = kept;
    }

    /// Gives the nodes of all elements their new numbers, without those that have gone, and
    /// returns how many these are.
    fn renumber(&mut self, target: Vec<u32>) -> usize {
        let stays = |node: usize| target[node] == node as u32;
        let mut number = vec![0_u32; target.len()];
        let mut next = 0;
        for (node, number) in number.iter_mut().enumerate() {
            *number = next;
            next += u32::from(stays(node));
        }
        let cells = self.cells.elements.nodes.iter_mut();
        for node in cells.chain(&mut self.facets.elements.nodes) {
            *node = number[target[*node as usize] as usize];
        }
        let mut flags = (0..target.len()).map(stays);
        self.nodes.retain(|_| flags.next() == Some(true));
        let mut flags = (0..target.len()).map(stays);
        self.node_tags.retain(|_| flags.next() == Some(true));
        target.len() - next as usize
    }
}
