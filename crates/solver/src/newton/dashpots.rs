//! Dashpots beside the laws of the facet points.

use glam::DVec3;

use super::facet_points::interface;
use crate::system::System;

/// Dashpots on the facet points of an iterate.
#[derive(Debug, Clone, Default)]
pub(super) struct Dashpots {
    /// Their stiffness in the step at hand, against that of the rock beside them; 0 of none.
    pub(super) share: f64,
    /// How far they have moved since the step began (m); empty of none.
    moved: Vec<DVec3>,
}

impl Dashpots {
    pub(super) fn at_rest(share: f64, points: usize) -> Self {
        Self {
            share,
            moved: vec![DVec3::ZERO; points],
        }
    }

    /// Whether there are any.
    pub(super) fn hold(&self) -> bool {
        self.share > 0.0
    }

    /// Moves them with the jumps (m).
    pub(super) fn follow(&mut self, changes: &[DVec3]) {
        for (moved, change) in self.moved.iter_mut().zip(changes) {
            *moved += *change;
        }
    }

    /// What each carries (Pa).
    fn tractions<'a>(&'a self, system: &'a System<'_>) -> impl Iterator<Item = DVec3> + 'a {
        let points = interface(system).points.iter().zip(&self.moved);
        points.map(|(point, moved)| self.share * point.spring * *moved)
    }

    /// The largest traction that one carries (Pa).
    pub(super) fn largest(&self, system: &System<'_>) -> f64 {
        let sizes = self.tractions(system).map(|own| own.length());
        sizes.fold(0.0, f64::max)
    }

    /// Adds what they carry to the tractions (Pa) of all facet points.
    pub(super) fn add_to(&self, system: &System<'_>, tractions: &mut [DVec3]) {
        for (traction, own) in tractions.iter_mut().zip(self.tractions(system)) {
            *traction += own;
        }
    }
}
