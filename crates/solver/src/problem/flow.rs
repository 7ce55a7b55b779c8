//! What flows in the fractures, and what drives it.

use glam::DVec3;
use kluft_field::Profile;
use lie_core::HydraulicAperture;

/// A fluid that fills fractures.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fluid {
    /// Viscosity (Pa s).
    pub viscosity: f64,
    /// Density (kg/m^3) under the initial pressure; 0 where gravity plays no part.
    pub density: f64,
    /// Relative change of density with pressure (1/Pa); 0 for a fluid that does not give way.
    pub compressibility: f64,
}

/// A fracture as the fluid sees it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Conduit {
    /// Nothing flows in it. What crosses it flows across.
    Sealed,
    /// The fluid flows along it.
    Open(HydraulicAperture),
}

/// Where the fluid is driven.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FlowPlace {
    /// Where fractures meet a part of the outer surface: index into
    /// [`kluft_mesh::MeshData::boundaries`].
    Boundary(usize),
    /// All of a fracture: index into [`kluft_mesh::MeshData::fractures`].
    Fracture(usize),
    /// A borehole through a node of fractures.
    Well {
        /// The node.
        node: u32,
        /// Its radius (m).
        radius: f64,
    },
}

/// How the fluid is driven, at load factor 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FlowDrive {
    /// Its pressure (Pa), by elevation.
    Pressure(Profile),
    /// What enters in all (m^3/s); negative where it leaves.
    Rate(f64),
}

impl FlowDrive {
    /// Whether the pressure is given.
    pub fn is_pressure(&self) -> bool {
        matches!(self, Self::Pressure(_))
    }
}

/// A condition on the flow.
#[derive(Debug, Clone, PartialEq)]
pub struct FlowCondition {
    /// How the user calls it, for messages and results.
    pub name: String,
    /// Where it acts.
    pub place: FlowPlace,
    /// What it does.
    pub drive: FlowDrive,
    /// Its load case.
    pub case: usize,
}

/// Flow in the fractures of a mesh. The rock conducts nothing.
#[derive(Debug, Clone, PartialEq)]
pub struct Flow {
    /// The fluid.
    pub fluid: Fluid,
    /// One entry for each of [`kluft_mesh::MeshData::fractures`].
    pub conduits: Vec<Conduit>,
    /// Facets, ascending, in which nothing flows although their fractures conduct: indices into
    /// [`kluft_mesh::MeshData::facets`].
    pub inactive: Vec<u32>,
    /// What drives it. Outer surfaces without a condition are closed.
    pub conditions: Vec<FlowCondition>,
    /// Pressure before any load (Pa), in equilibrium with the initial stress, which is total.
    pub initial_pressure: Profile,
    /// Acceleration of gravity (m/s^2).
    pub gravity: DVec3,
    /// Load case of gravity.
    pub gravity_case: usize,
}

impl Flow {
    /// Whether the flow depends on how the walls move in rock that deforms: by their apertures, or,
    /// where it takes time, by what they store.
    pub fn follows_walls(&self, takes_time: bool) -> bool {
        let of_walls = |conduit: &Conduit| match conduit {
            Conduit::Sealed => false,
            Conduit::Open(hydraulic) => !hydraulic.is_constant(),
        };
        takes_time || self.conduits.iter().any(of_walls)
    }

    /// Whether fractures whose walls do not move store fluid in a run in time: if pressure
    /// compresses it.
    pub fn is_stored(&self, is_timed: bool) -> bool {
        is_timed && self.fluid.compressibility > 0.0
    }
}
