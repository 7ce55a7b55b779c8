//! A mesh as read from a file, before anything about it has been checked.

use std::ops::Range;

use crate::shape::Shape;

/// A physical group of the file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Group {
    /// Dimension of its elements: 0 to 3.
    pub dimension: usize,
    /// Its number in the file.
    pub tag: i32,
    /// Its name; the number as text where the file gives none.
    pub name: String,
}

/// Elements of one dimension, of mixed shapes, in one flat list.
#[derive(Debug, Clone, Default)]
pub struct Elements {
    /// Shape of each element.
    pub shapes: Vec<Shape>,
    /// Start of each element's nodes in `nodes`; one entry more than there are elements.
    pub offsets: Vec<u32>,
    /// Node indices (not tags) of all elements, one after the other.
    pub nodes: Vec<u32>,
}

impl Elements {
    /// No elements.
    pub fn new() -> Self {
        Self {
            shapes: Vec::new(),
            offsets: vec![0],
            nodes: Vec::new(),
        }
    }

    /// Whether any is of second order.
    pub fn has_quadratic(&self) -> bool {
        self.shapes.iter().any(|shape| shape.is_quadratic())
    }

    /// Number of elements.
    pub fn len(&self) -> usize {
        self.shapes.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.shapes.is_empty()
    }

    /// The shapes that occur.
    pub(crate) fn distinct_shapes(&self) -> Vec<Shape> {
        let mut distinct: Vec<Shape> = Vec::new();
        // Elements of one shape mostly stand side by side.
        for alike in self.shapes.chunk_by(|a, b| a == b) {
            if !distinct.contains(&alike[0]) {
                distinct.push(alike[0]);
            }
        }
        distinct
    }

    /// Node indices of element `index`.
    pub fn nodes_of(&self, index: usize) -> &[u32] {
        &self.nodes[self.range(index)]
    }

    /// Where the nodes of element `index` stand in the flat list.
    pub fn range(&self, index: usize) -> Range<usize> {
        self.offsets[index] as usize..self.offsets[index + 1] as usize
    }

    /// So many elements of each of these shapes, all of whose nodes are 0 still.
    ///
    /// # Panics
    /// If the flat list outgrows 32 bits.
    pub fn blank(blocks: &[(Shape, usize)]) -> Self {
        let count = blocks.iter().map(|(_, count)| count).sum();
        let ends = blocks
            .iter()
            .map(|(shape, count)| count * shape.node_count());
        let end: usize = ends.sum();
        assert!(u32::try_from(end).is_ok(), "fewer than 2^32 element nodes");
        let mut blank = Self {
            shapes: Vec::with_capacity(count),
            offsets: Vec::with_capacity(count + 1),
            nodes: vec![0; end],
        };
        blank.offsets.push(0);
        let mut first = 0;
        for &(shape, count) in blocks {
            let width = shape.node_count();
            blank.shapes.resize(blank.shapes.len() + count, shape);
            let ends = (1..=count).map(|element| (first + element * width) as u32);
            blank.offsets.extend(ends);
            first += count * width;
        }
        blank
    }

    /// Appends all elements of another list.
    ///
    /// # Panics
    /// If the flat list outgrows 32 bits.
    pub fn extend(&mut self, other: &Self) {
        let first = u32::try_from(self.nodes.len()).expect("fewer than 2^32 element nodes");
        self.shapes.extend(&other.shapes);
        self.nodes.extend(&other.nodes);
        assert!(
            u32::try_from(self.nodes.len()).is_ok(),
            "fewer than 2^32 element nodes"
        );
        self.offsets
            .extend(other.offsets[1..].iter().map(|end| first + end));
    }

    /// Appends an element.
    ///
    /// # Panics
    /// If the number of nodes is not that of the shape, or the flat list outgrows 32 bits.
    pub fn push(&mut self, shape: Shape, nodes: &[u32]) {
        assert_eq!(nodes.len(), shape.node_count(), "nodes of a {shape:?}");
        self.shapes.push(shape);
        self.nodes.extend_from_slice(nodes);
        let end = u32::try_from(self.nodes.len()).expect("fewer than 2^32 element nodes");
        self.offsets.push(end);
    }
}

/// Cuts a list parallel to the nodes of elements with these offsets: so many elements at a time,
/// and their share of the list.
pub(crate) fn split<'a, T>(
    offsets: &[u32],
    at_a_time: usize,
    mut values: &'a mut [T],
) -> Vec<(Range<usize>, &'a mut [T])> {
    let count = offsets.len().saturating_sub(1);
    let firsts = (0..count).step_by(at_a_time);
    let stretches = firsts.map(|first| first..count.min(first + at_a_time));
    let mut cut = |stretch: Range<usize>| {
        let length = (offsets[stretch.end] - offsets[stretch.start]) as usize;
        let own = values.split_off_mut(..length).unwrap_or_default();
        (stretch, own)
    };
    stretches.map(&mut cut).collect()
}

/// Elements as they stand in the file: with their tags and physical groups.
#[derive(Debug, Clone, Default)]
pub struct TaggedElements {
    /// Shapes and nodes.
    pub elements: Elements,
    /// The number each element has in the file, for messages.
    pub tags: Vec<u64>,
    /// Index into [`Draft::group_sets`] for each element.
    pub group_set: Vec<u32>,
}

impl TaggedElements {
    /// No elements.
    pub fn new() -> Self {
        Self {
            elements: Elements::new(),
            ..Self::default()
        }
    }
}

/// A named curve, by its places: nothing that is done to the elements of a mesh changes it.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Its name.
    pub name: String,
    /// Ends of its pieces (m), in no order.
    pub pieces: Vec<[[f64; 3]; 2]>,
}

/// A mesh as read: nodes, cells, facets and all their tags. Nothing is checked
/// except that node indices are valid. [`crate::Mesh::build`] turns it into a [`crate::Mesh`].
#[derive(Debug, Clone, Default)]
pub struct Draft {
    /// Where it came from, for messages.
    pub source: String,
    /// Coordinates of the nodes (m).
    pub nodes: Vec<[f64; 3]>,
    /// The number each node has in the file, for messages.
    pub node_tags: Vec<u64>,
    /// All physical groups.
    pub groups: Vec<Group>,
    /// The distinct sets of groups that elements belong to: indices into `groups`, ascending.
    pub group_sets: Vec<Vec<usize>>,
    /// Elements of dimension 3.
    pub cells: TaggedElements,
    /// Elements of dimension 2.
    pub facets: TaggedElements,
    /// Elements of dimension 1, of meshes without cells.
    pub lines: TaggedElements,
    /// Whether its cells are those of a mesh of the plane, see [`Draft::extruded`].
    pub is_extruded: bool,
    /// The named curves.
    pub curves: Vec<Curve>,
}

impl Draft {
    /// Takes the places of its lines for its named curves.
    pub fn name_curves(&mut self) {
        let lines = &self.lines;
        let is_curve = |group: &Group| group.dimension == 1;
        let named = self.groups.iter().enumerate();
        let named = named.filter(|(_, group)| is_curve(group));
        let curve = |(index, group): (usize, &Group)| {
            let own = |line: &usize| {
                let set = lines.group_set[*line] as usize;
                self.group_sets[set].contains(&index)
            };
            let ends = |line: usize| {
                let nodes = lines.elements.nodes_of(line);
                [nodes[0], nodes[1]].map(|node| self.nodes[node as usize])
            };
            Curve {
                name: group.name.clone(),
                pieces: (0..lines.elements.len()).filter(own).map(ends).collect(),
            }
        };
        let curves: Vec<Curve> = named.map(curve).collect();
        self.curves = curves;
    }

    /// Number of the given elements of this draft in each group.
    pub fn group_sizes(&self, elements: &TaggedElements) -> Vec<usize> {
        let mut of_set = vec![0; self.group_sets.len()];
        for &set in &elements.group_set {
            of_set[set as usize] += 1;
        }
        let mut of_group = vec![0; self.groups.len()];
        for (set, count) in self.group_sets.iter().zip(of_set) {
            for &group in set {
                of_group[group] += count;
            }
        }
        of_group
    }
}
