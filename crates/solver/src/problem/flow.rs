//! What flows in the fractures, and what drives it.

use glam::DVec3;
use kluft_field::Field;
use kluft_mesh::Mesh;
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
    /// Along a line within fractures: index into [`Flow::lines`].
    Line(usize),
    /// A borehole through a node of fractures.
    Well {
        /// The node.
        node: u32,
        /// Its radius (m).
        radius: f64,
    },
}

/// What a corner of a facet has of a line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LineShare {
    /// The node at the corner.
    pub node: u32,
    /// The facet: index into [`kluft_mesh::MeshData::facets`].
    pub facet: u32,
    /// Its share of the length (m).
    pub length: f64,
}

/// How the fluid is driven, at load factor 1.
#[derive(Debug, Clone, PartialEq)]
pub enum FlowDrive {
    /// Its pressure (Pa), by position but not by time.
    Pressure(Field),
    /// What enters in all (m^3/s); negative where it leaves.
    Rate(f64),
    /// What leaks off into the rock, whatever the load factor; nothing in steady flow.
    Leakoff(Leakoff),
}

/// What fluid leaks off into rock through the walls of a fracture, by Carter's law: through each
/// wall with the velocity `C / sqrt(t - t_0)` (Howard & Fast 1957).
#[derive(Debug, Clone, PartialEq)]
pub struct Leakoff {
    /// `C` (m/s^0.5); where it varies, a factor on its values.
    pub coefficient: f64,
    /// Values of `C` (m/s^0.5) by position, at the corners of facets.
    pub varying: Option<Field>,
    /// `t_0`, when the walls first meet the fluid (s).
    pub exposed: f64,
}

impl Leakoff {
    /// What enters through both walls at a time (m/s), which is negative; 0 up to the exposure.
    pub fn rate(&self, time: f64) -> f64 {
        match time > self.exposed {
            true => -2.0 * self.coefficient / (time - self.exposed).sqrt(),
            false => 0.0,
        }
    }

    /// What enters through both walls in the mean of a time (m/s), which is negative: the integral
    /// is exact, also where it begins with the exposure.
    pub fn mean_rate(&self, from: f64, to: f64) -> f64 {
        let root = |time: f64| (time - self.exposed).max(0.0).sqrt();
        -4.0 * self.coefficient * (root(to) - root(from)) / (to - from)
    }
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
    /// One entry for each of [`kluft_mesh::MeshData::facets`] where fractures conduct otherwise in
    /// one place than in another; then those of fractures are what is usual in them. Empty if none
    /// does.
    pub of_facets: Vec<Conduit>,
    /// Facets, ascending, in which nothing flows although their fractures conduct: indices into
    /// [`kluft_mesh::MeshData::facets`].
    pub inactive: Vec<u32>,
    /// What drives it. Outer surfaces without a condition are closed.
    pub conditions: Vec<FlowCondition>,
    /// Lines within fractures, each by the corners that share it.
    pub lines: Vec<Vec<LineShare>>,
    /// Pressure before any load (Pa), in equilibrium with the initial stress, which is total; by
    /// position but not by time.
    pub initial_pressure: Field,
    /// Acceleration of gravity (m/s^2).
    pub gravity: DVec3,
    /// Load case of gravity.
    pub gravity_case: usize,
    /// Whether in steady flow networks without a given pressure keep the fluid that they hold, in
    /// place of being refused; only where walls follow.
    pub is_undrained: bool,
}

impl Flow {
    /// How a facet of the mesh conducts.
    pub fn conduit(&self, mesh: &Mesh, facet: usize) -> Conduit {
        let of_fracture = || self.conduits[mesh.facets.fracture[facet] as usize];
        self.of_facets
            .get(facet)
            .copied()
            .unwrap_or_else(of_fracture)
    }

    /// Whether the flow depends on how the walls move in rock that deforms: by their apertures, or,
    /// where it takes time or networks keep what they hold, by what they store.
    pub fn follows_walls(&self, takes_time: bool) -> bool {
        let of_walls = |conduit: &Conduit| match conduit {
            Conduit::Sealed => false,
            Conduit::Open(hydraulic) => !hydraulic.is_constant(),
        };
        takes_time || self.is_undrained || self.conduits.iter().any(of_walls)
    }

    /// Whether fractures whose walls do not move store fluid in a run in time: if pressure
    /// compresses it.
    pub fn is_stored(&self, is_timed: bool) -> bool {
        is_timed && self.fluid.compressibility > 0.0
    }
}
