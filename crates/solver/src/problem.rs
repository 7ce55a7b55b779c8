//! Everything a solve needs: mesh, materials, conditions, load steps.

use glam::{DMat3, DVec3};
use kluft_mesh::Mesh;
use lie_core::{FacetQuadrature, FractureLaw, Rock};

use crate::schedule::Schedule;

/// A fracture's law and what fills it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fracture {
    /// Its law.
    pub law: FractureLaw,
    /// Fluid pressure on both walls (Pa), opening.
    pub fluid_pressure: f64,
}

/// A load on a part of the outer surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SurfaceLoad {
    /// Force per area in global axes (Pa).
    Traction(DVec3),
    /// Force per area along the inward normal (Pa).
    Pressure(f64),
}

/// A support of a part of the outer surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Support {
    /// Prescribed displacement of the named components (m); the others are free.
    Displacement([Option<f64>; 3]),
    /// No displacement along the normal: a roller on any plane.
    Symmetry,
}

/// What acts on one part of the outer surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Condition {
    /// Index into [`kluft_mesh::MeshData::boundaries`].
    pub boundary: usize,
    /// Its load, if any.
    pub load: Option<SurfaceLoad>,
    /// Its support, if any.
    pub support: Option<Support>,
}

/// A node held in some components, in all its sectors.
#[derive(Debug, Clone, PartialEq)]
pub struct FixedPoint {
    /// Node index.
    pub node: u32,
    /// Prescribed components (m).
    pub displacement: [Option<f64>; 3],
    /// How the user calls it, for messages.
    pub name: String,
}

/// A stress component that varies linearly with elevation: `value + per_metre (z - at)` (Pa).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Profile {
    /// Elevation of reference, `at` (m).
    pub at: f64,
    /// Stress there (Pa).
    pub value: f64,
    /// Change per metre of elevation (Pa/m).
    pub per_metre: f64,
}

/// Stress before any load, components `xx, yy, zz, xy, yz, xz`. Rock and fractures start in
/// equilibrium with it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct InitialStress {
    /// The six components.
    pub components: [Profile; 6],
}

impl InitialStress {
    /// Stress at a position (Pa).
    pub fn at(&self, position: DVec3) -> DMat3 {
        let [xx, yy, zz, xy, yz, xz] = self
            .components
            .map(|profile| profile.value + profile.per_metre * (position.z - profile.at));
        DMat3::from_cols(
            DVec3::new(xx, xy, xz),
            DVec3::new(xy, yy, yz),
            DVec3::new(xz, yz, zz),
        )
    }
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
    /// How fractures are integrated over their facets; see also [`Self::rule_of`].
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

    /// Rock of a cell.
    pub fn rock(&self, cell: usize) -> &Rock {
        &self.rocks[self.rock_of_cell[cell] as usize]
    }

    /// How a fracture is integrated: at control points instead of nodes if its law has kinks, because
    /// walls that may be rigid at more points than there are jumps do not know how to share a load.
    pub fn rule_of(&self, fracture: u32) -> FacetQuadrature {
        match self.facet_quadrature {
            FacetQuadrature::Nodal if !self.fractures[fracture as usize].law.is_smooth() => {
                FacetQuadrature::Control
            }
            chosen => chosen,
        }
    }
}
