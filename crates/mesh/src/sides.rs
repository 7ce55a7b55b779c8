//! Sides of fractures that are known before a mesh is built.

use std::collections::HashMap;

use crate::adjacency::Adjacency;
use crate::surfaces::Surfaces;

/// Which of the two cells at each facet is on its minus side.
#[derive(Debug, Clone, Default)]
pub(crate) struct Sides {
    /// The minus cell of each pair of cells, lower first, that a facet lies between.
    minus: HashMap<[u32; 2], u32>,
}

impl Sides {
    /// Those of facets with these minus and plus cells.
    pub(crate) fn of(minus: &[u32], plus: &[u32]) -> Self {
        let pairs = minus.iter().zip(plus);
        Self {
            minus: pairs.map(|(&a, &b)| ([a.min(b), a.max(b)], a)).collect(),
        }
    }

    /// The same for a part that has these cells, ascending, under numbers from 0.
    pub(crate) fn in_part(&self, cells: &[u32]) -> Self {
        let number = |cell: u32| cells.binary_search(&cell).ok().map(|place| place as u32);
        let pairs = self
            .minus
            .iter()
            .filter_map(|([a, b], &minus)| Some(([number(*a)?, number(*b)?], number(minus)?)));
        Self {
            minus: pairs.collect(),
        }
    }

    /// `(minus face, plus face)` of every facet.
    pub(crate) fn of_facets(&self, adjacency: &Adjacency, surfaces: &Surfaces) -> Vec<(u32, u32)> {
        let facets = surfaces.facets.iter();
        let ordered = facets.map(|facet| {
            let [a, b] = facet.faces;
            let [own, other] = facet.faces.map(|face| adjacency.cell_of(face));
            match self.minus.get(&[own.min(other), own.max(other)]) {
                Some(&minus) if minus == other => (b, a),
                _ => (a, b),
            }
        });
        ordered.collect()
    }
}
