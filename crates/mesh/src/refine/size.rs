//! How many elements dividing makes, known before anything is divided.

use super::division::division;
use crate::draft::Elements;
use crate::shape::Shape;

/// Elements by shape.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Counts([u64; 16]);

impl Counts {
    pub(super) fn of(elements: &Elements) -> Self {
        let mut counts = [0; 16];
        // Elements of one shape mostly stand side by side.
        for alike in elements.shapes.chunk_by(|a, b| a == b) {
            counts[alike[0] as usize] += alike.len() as u64;
        }
        Self(counts)
    }

    /// After each element has been divided once; more than any list can hold stays more.
    pub(super) fn divided(self) -> Self {
        let mut after = [0_u64; 16];
        for (shape, count) in self.shapes() {
            for child in &division(shape).children[0] {
                let own = &mut after[child.shape as usize];
                *own = own.saturating_add(count);
            }
        }
        Self(after)
    }

    pub(super) fn elements(self) -> u64 {
        let counts = self.0.into_iter();
        counts.fold(0, u64::saturating_add)
    }

    /// Nodes of all elements, one after the other.
    pub(super) fn nodes(self) -> u64 {
        let all = self.shapes().into_iter();
        all.map(|(shape, count)| count.saturating_mul(shape.node_count() as u64))
            .fold(0, u64::saturating_add)
    }

    /// Numbers that the faces of the cells take: four a cell, eight where one has more faces.
    pub(super) fn face_numbers(self) -> u64 {
        let shapes = self.shapes();
        let tetrahedra = shapes.iter().all(|(shape, _)| shape.faces().len() <= 4);
        self.elements()
            .saturating_mul(if tetrahedra { 4 } else { 8 })
    }

    fn shapes(self) -> Vec<(Shape, u64)> {
        let all = Shape::CELLS.into_iter().chain(Shape::FACETS);
        let counted = all.map(|shape| (shape, self.0[shape as usize]));
        counted.filter(|(_, count)| *count > 0).collect()
    }
}
