//! What a stage leaves to the next one, and what that has of it.

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::state::{FacetPointState, StateScales};
use crate::space::cell::StrainOffsets;

/// What a stage leaves to the next one. Cells are told by their numbers in a mesh that has those of
/// all stages.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct StageEnd {
    /// Its cells, ascending.
    pub(super) cells: Vec<u32>,
    /// Start of each of them in the lists of their nodes.
    pub(super) starts: Vec<u32>,
    /// How far the nodes of the cells have moved (m).
    pub(super) displacements: Vec<DVec3>,
    /// What strains the cells (m), node by node.
    pub(super) strains: Vec<DVec3>,
    /// Cells without the initial stress.
    pub(super) added: Vec<bool>,
    /// Minus and plus cell of each facet.
    pub(super) facets: Vec<[u32; 2]>,
    /// Points of each facet.
    pub(super) facet_points: Vec<Vec<LeftPoint>>,
    pub(super) reached: StateScales,
}

/// A facet point at the end of a stage.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub(super) struct LeftPoint {
    pub(super) state: FacetPointState,
    /// Jump of its walls since the state of initial stress (m).
    pub(super) jump: DVec3,
    /// Jump that its law sees (m).
    pub(super) seen: DVec3,
}

impl StageEnd {
    /// For each of these cells whether it came later than the initial stress, ascending; cells that
    /// this stage had not are new.
    pub fn added(&self, cells: &[u32]) -> Vec<bool> {
        let of = |cell: &u32| self.place(*cell).is_none_or(|place| self.added[place]);
        cells.iter().map(of).collect()
    }

    /// Forgets cells that the next stage has anew, free of stress, and the facets beside them.
    pub fn forget(&mut self, is_renewed: impl Fn(u32) -> bool) {
        let kept: Vec<usize> = (0..self.cells.len())
            .filter(|&place| !is_renewed(self.cells[place]))
            .collect();
        self.starts = kept.iter().map(|&place| self.starts[place]).collect();
        self.added = kept.iter().map(|&place| self.added[place]).collect();
        self.cells = kept.iter().map(|&place| self.cells[place]).collect();
        let facets = self
            .facets
            .iter()
            .zip(std::mem::take(&mut self.facet_points));
        let facets = facets.filter(|(sides, _)| !sides.iter().any(|&cell| is_renewed(cell)));
        (self.facets, self.facet_points) = facets.map(|(sides, own)| (*sides, own)).unzip();
    }

    pub(super) fn place(&self, cell: u32) -> Option<usize> {
        self.cells.binary_search(&cell).ok()
    }
}

/// What a stage has from the one before.
#[derive(Debug, Clone, Default)]
pub(crate) struct Carried {
    /// Displacement of every point where its unknowns and the loads are zero (m).
    pub(super) displacements: Vec<DVec3>,
    /// What strains cells beside.
    pub(super) offsets: StrainOffsets,
    /// Jump of each facet point there (m).
    pub(super) jumps: Vec<DVec3>,
    /// Jump that the law of each facet point sees there (m).
    pub(super) seen: Vec<DVec3>,
    pub(super) facet_points: Vec<FacetPointState>,
    pub(super) reached: StateScales,
}
