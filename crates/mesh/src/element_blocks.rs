//! A draft from arrays: nodes, groups, and blocks of elements of one shape.

use kluft_defect::{Defect, sample};

use crate::draft::{Draft, Elements, Group, TaggedElements};
use crate::shape::Shape;

/// Elements of one shape that belong to the same groups.
#[derive(Debug, Clone)]
pub struct ElementBlock {
    /// Their shape.
    pub shape: Shape,
    /// Their nodes, counted from 0, one element after the other.
    pub nodes: Vec<u32>,
    /// Their numbers, for messages.
    pub tags: Vec<u64>,
    /// Their groups: indices, ascending.
    pub groups: Vec<usize>,
}

impl Draft {
    /// A draft of elements in blocks; `source` says where they come from, `nodes` are coordinates
    /// (m) and `node_tags` the numbers of the nodes for messages.
    ///
    /// # Errors
    /// Elements that refer to nodes that are not there, and blocks whose lists do not fit together.
    pub fn of_blocks(
        source: &str,
        (nodes, node_tags): (Vec<[f64; 3]>, Vec<u64>),
        groups: Vec<Group>,
        blocks: &[ElementBlock],
    ) -> Result<Self, Vec<Defect>> {
        let found = blocks.iter().filter_map(|b| unfit(source, b, nodes.len()));
        let defects: Vec<Defect> = found.collect();
        if !defects.is_empty() {
            return Err(defects);
        }
        let mut draft = Self {
            source: source.to_owned(),
            nodes,
            node_tags,
            groups,
            cells: TaggedElements::new(),
            facets: TaggedElements::new(),
            ..Self::default()
        };
        for dimension in [3, 2] {
            let own = blocks.iter().filter(|b| b.shape.dimension() == dimension);
            let elements = draft.tagged(&own.collect::<Vec<_>>());
            match dimension {
                3 => draft.cells = elements,
                _ => draft.facets = elements,
            }
        }
        Ok(draft)
    }

    /// The elements of blocks, whose sets of groups are added to those known.
    fn tagged(&mut self, blocks: &[&ElementBlock]) -> TaggedElements {
        let sizes = blocks.iter().map(|block| (block.shape, block.tags.len()));
        let mut elements = Elements::blank(&sizes.collect::<Vec<_>>());
        elements.nodes.clear();
        let (mut tags, mut group_set) = (Vec::new(), Vec::new());
        for block in blocks {
            let known = self.group_sets.iter().position(|set| *set == block.groups);
            let set = known.unwrap_or(self.group_sets.len());
            if known.is_none() {
                self.group_sets.push(block.groups.clone());
            }
            elements.nodes.extend(&block.nodes);
            tags.extend(&block.tags);
            group_set.resize(tags.len(), set as u32);
        }
        TaggedElements {
            elements,
            tags,
            group_set,
        }
    }
}

fn unfit(source: &str, block: &ElementBlock, count: usize) -> Option<Defect> {
    let width = block.shape.node_count();
    let place = format!("{source}, elements of shape {:?}", block.shape);
    if block.nodes.len() != width * block.tags.len() {
        let problem = format!(
            "{} nodes stand for {} elements of {width} nodes",
            block.nodes.len(),
            block.tags.len()
        );
        return Some(Defect::new(
            place,
            problem,
            "give one row of nodes for each",
        ));
    }
    let is_dangling = |nodes: &[u32]| nodes.iter().any(|&node| node as usize >= count);
    let rows = block.nodes.chunks(width).zip(&block.tags);
    let dangling = rows.filter(|(nodes, _)| is_dangling(nodes));
    let dangling: Vec<u64> = dangling.map(|(_, tag)| *tag).collect();
    (!dangling.is_empty()).then(|| {
        Defect::new(
            format!("{place}: {}", sample(&dangling)),
            format!("they refer to nodes that are not there; there are {count}"),
            "count nodes from 0, in the order of the coordinates",
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const CORNERS: [[f64; 3]; 4] = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
    ];

    fn block(shape: Shape, nodes: &[u32], groups: &[usize]) -> ElementBlock {
        ElementBlock {
            shape,
            nodes: nodes.to_vec(),
            tags: (1..=nodes.len() as u64 / shape.node_count() as u64).collect(),
            groups: groups.to_vec(),
        }
    }

    fn draft(nodes: &[[f64; 3]], blocks: &[ElementBlock]) -> Result<Draft, Vec<Defect>> {
        let tags = (1..=nodes.len() as u64).collect();
        Draft::of_blocks("arrays", (nodes.to_vec(), tags), Vec::new(), blocks)
    }

    #[test]
    fn blocks_become_elements_with_their_groups() {
        let blocks = [
            block(Shape::Tri3, &[0, 1, 2], &[1]),
            block(Shape::Tet4, &[0, 1, 2, 3], &[0]),
            block(Shape::Tri3, &[0, 1, 3, 0, 2, 3], &[1, 2]),
        ];
        let draft = draft(&CORNERS, &blocks).expect("sound");
        assert_eq!(draft.cells.elements.nodes_of(0), [0, 1, 2, 3]);
        assert_eq!(draft.facets.elements.nodes_of(2), [0, 2, 3]);
        let sets = draft.facets.group_set.iter();
        let sets: Vec<&[usize]> = sets.map(|&s| &draft.group_sets[s as usize][..]).collect();
        assert_eq!(sets, [&[1][..], &[1, 2], &[1, 2]]);
    }

    #[test]
    fn every_defect_of_arrays_is_named() {
        let blocks = [
            block(Shape::Tet4, &[0, 1, 2, 4], &[]),
            block(Shape::Tri3, &[0, 1, 2, 3], &[]),
        ];
        let defects = draft(&CORNERS, &blocks).expect_err("two defects");
        let said: Vec<String> = defects.iter().map(ToString::to_string).collect();
        assert_eq!(said.len(), 2, "{said:?}");
        for (said, word) in said.iter().zip(["there are 4", "4 nodes stand"]) {
            assert!(said.contains(word), "{said}");
        }
    }
}
