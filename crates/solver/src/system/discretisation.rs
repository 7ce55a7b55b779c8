//! Numbering and topology of a problem.

use glam::DVec3;
use kluft_mesh::Defect;

use crate::assembly::facet_point::FacetPoint;
use crate::assembly::interface::Interface;
use crate::problem::Problem;
use crate::space::pattern::Pattern;
use crate::space::sector_nodes::SectorNodes;
use crate::space::supports::Supports;
use crate::space::{Space, folded, rigid_modes};

/// Numbering and topology of a problem, before any value is computed.
#[derive(Debug, Clone)]
pub struct Discretisation {
    /// Copies of nodes, and unknowns.
    pub(crate) points: SectorNodes,
    /// What is held.
    pub(crate) supports: Supports,
    /// Pattern of the matrix.
    pub(crate) pattern: Pattern,
    /// The fractures.
    pub(crate) interface: Interface,
}

impl Discretisation {
    /// What assembly works from.
    pub(crate) fn space<'a>(&'a self, problem: &'a Problem) -> Space<'a> {
        Space {
            problem,
            points: &self.points,
            supports: &self.supports,
            pattern: &self.pattern,
        }
    }

    /// Enriches and numbers a problem.
    ///
    /// # Errors
    /// Cells that fold over themselves, conditions that contradict each other, and blocks of rock
    /// that nothing holds, each named with the motions left free.
    pub fn of(problem: &Problem) -> Result<Self, Vec<Defect>> {
        if let Some(defect) = folded::find(problem) {
            return Err(vec![defect]);
        }
        let points = SectorNodes::of(&problem.mesh);
        let supports = Supports::of(problem, &points)?;
        let interface = Interface::of(problem, &points, &supports);
        let defects = rigid_modes::find(problem, &points, &supports, interface.laws());
        if !defects.is_empty() {
            return Err(defects);
        }
        let pattern = Pattern::of(&problem.mesh, &points);
        Ok(Self {
            points,
            supports,
            pattern,
            interface,
        })
    }

    /// Number of scalar unknowns, held directions left out.
    pub fn unknown_count(&self) -> usize {
        3 * self.points.len() - self.supports.held_directions
    }

    /// Copies of nodes, and unknowns.
    pub fn points(&self) -> &SectorNodes {
        &self.points
    }

    /// What is held.
    pub fn supports(&self) -> &Supports {
        &self.supports
    }

    /// Pattern of the matrix.
    pub fn pattern(&self) -> &Pattern {
        &self.pattern
    }

    /// The fractures.
    pub fn interface(&self) -> &Interface {
        &self.interface
    }

    /// The fractures alone.
    pub fn into_interface(self) -> Interface {
        self.interface
    }

    /// Gives each facet point another unit normal, from minus to plus, as one that the mesh gives
    /// its facet. The jumps stay what they are; what of them opens the fracture changes.
    pub fn set_normals(&mut self, normal: impl Fn(&FacetPoint) -> DVec3) {
        for point in &mut self.interface.points {
            point.normal = normal(point);
        }
    }
}
