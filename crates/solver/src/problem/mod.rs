//! Everything a solve needs: mesh, materials, conditions, load steps.

mod conditions;
mod flow;
mod initial_stress;
mod schedule;

use glam::DVec3;
use kluft_mesh::Mesh;
use lie_core::{FacetQuadrature, FractureLaw, Rock};

pub use conditions::{Condition, FixedPoint, Support, SurfaceLoad};
pub use flow::{Conduit, Flow, FlowCondition, FlowDrive, FlowPlace, Fluid};
pub use initial_stress::{InitialStress, Profile};
pub use schedule::{Cases, Load, Schedule, Step};

/// A fracture's law and what fills it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fracture {
    /// The law that a discretisation takes over; later ones are given to the system.
    pub law: FractureLaw,
    /// Fluid pressure on both walls (Pa), opening.
    pub fluid_pressure: f64,
}

/// A problem: what is solved, and for which loads.
#[derive(Debug, Clone)]
pub struct Problem {
    /// The mesh.
    pub mesh: Mesh,
    /// Rocks that occur.
    pub rocks: Vec<Rock>,
    /// Index into `rocks` for each cell.
    pub rock_of_cell: Vec<u32>,
    /// One entry for each of [`kluft_mesh::MeshData::fractures`].
    pub fractures: Vec<Fracture>,
    /// Conditions on the outer surface.
    pub conditions: Vec<Condition>,
    /// Nodes held by themselves.
    pub fixed_points: Vec<FixedPoint>,
    /// Acceleration of gravity (m/s^2).
    pub gravity: DVec3,
    /// Stress before any load.
    pub initial_stress: Option<InitialStress>,
    /// Load cases and load steps.
    pub schedule: Schedule,
    /// How fractures are integrated over their facets. Fractures whose laws have kinks are
    /// integrated at control points where this says nodes.
    pub facet_quadrature: FacetQuadrature,
}

impl Problem {
    /// A body of one rock in one load step, with neither laws of fractures nor conditions yet.
    pub fn of_rock(mesh: Mesh, rock: Rock) -> Self {
        Self {
            rocks: vec![rock],
            rock_of_cell: vec![0; mesh.cells.len()],
            fractures: Vec::new(),
            conditions: Vec::new(),
            fixed_points: Vec::new(),
            gravity: DVec3::ZERO,
            initial_stress: None,
            schedule: Schedule::proportional(vec![1.0]),
            facet_quadrature: FacetQuadrature::Nodal,
            mesh,
        }
    }

    /// Apertures without load (m), one for each entry of the flat node list of the facets.
    pub fn initial_apertures(&self) -> Vec<f64> {
        let facets = &self.mesh.facets;
        let all = facets.fracture.iter().enumerate();
        let apertures = all.flat_map(|(facet, &fracture)| {
            let aperture = self.fractures[fracture as usize].law.closure.aperture;
            std::iter::repeat_n(aperture, facets.elements.range(facet).len())
        });
        apertures.collect()
    }

    /// Rock of a cell.
    pub fn rock(&self, cell: usize) -> &Rock {
        &self.rocks[self.rock_of_cell[cell] as usize]
    }

    /// How a fracture is integrated: at control points instead of nodes if its law has kinks,
    /// because walls that may be rigid at more points than there are jumps do not know how to share
    /// a load.
    pub(crate) fn rule_of(&self, fracture: u32) -> FacetQuadrature {
        match self.facet_quadrature {
            FacetQuadrature::Nodal if !self.fractures[fracture as usize].law.is_smooth() => {
                FacetQuadrature::Control
            }
            chosen => chosen,
        }
    }
}
