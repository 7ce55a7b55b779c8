//! A cube of 10 m whose joint half way up carries 10 MPa beside water of 10 MPa.

use glam::DVec3;
use kluft_mesh::structured::Patch;
use kluft_mesh::{Mesh, Shape};
use kluft_solver::{
    Condition, Field, Flow, Fracture, InitialStress, NewtonSettings, Problem, Schedule, Support,
    SurfaceLoad,
};
use lie_core::{Closure, FractureLaw, Rock};

use super::flow::{VISCOSITY, block, on_side, water};
use super::soft_slabs::{Path, as_given, path, steady, times};
use super::{EXACT, ROCK};

/// Normal stress before any load (Pa).
pub const STRESS: f64 = 20e6;
/// Pressure of the water before any load (Pa).
pub const PRESSURE: f64 = 10e6;
/// Aperture without load (m).
pub const APERTURE: f64 = 1e-4;
/// Edge of the cube (m).
pub const EDGE: f64 = 10.0;

/// What is done to the cube in one step.
#[derive(Debug, Clone, Copy)]
pub struct Trial {
    /// Normal stiffness of the joint (Pa/m).
    pub stiffness: f64,
    /// Length of the step in diffusion times; none for the steady state.
    pub step: Option<f64>,
    /// Pressure on the left end (Pa); none closes it. In steady flow the right end keeps its own.
    pub inlet: Option<f64>,
    /// What is added to the normal stress (Pa); none holds the top.
    pub load: Option<f64>,
    /// Of the fluid (1/Pa).
    pub compressibility: f64,
    /// Of the rock (Pa).
    pub young_modulus: f64,
}

impl Trial {
    /// A joint that is held and closed to all sides, of a fluid that does not give way.
    pub fn of(stiffness: f64, step: Option<f64>) -> Self {
        Self {
            stiffness,
            step,
            inlet: None,
            load: None,
            compressibility: 0.0,
            young_modulus: ROCK.young_modulus,
        }
    }

    /// The law of the joint.
    pub fn closure(&self) -> Closure {
        Closure::new(APERTURE, self.stiffness, EXACT)
    }

    /// Aperture before any load (m).
    pub fn aperture(&self) -> f64 {
        let law = FractureLaw::elastic(self.closure(), self.stiffness);
        let traction = (PRESSURE - STRESS) * DVec3::Z;
        law.under_initial_stress(traction, DVec3::Z)
            .separation
            .aperture
    }

    /// `L^2 / D` with the stiffness and the transmissivity before any load (s).
    pub fn diffusion_time(&self) -> f64 {
        let law = FractureLaw::elastic(self.closure(), self.stiffness);
        let traction = (PRESSURE - STRESS) * DVec3::Z;
        let walls = law.under_initial_stress(traction, DVec3::Z).separation;
        let conducts = walls.aperture.powi(3) / (12.0 * VISCOSITY);
        EDGE * EDGE / (self.closure().at(walls).tangent * conducts)
    }

    /// Takes the step.
    pub fn taken(&self, mesh: &Mesh) -> Path {
        let schedule = match self.step {
            None => steady(),
            Some(step) => times([(step * self.diffusion_time(), 1.0)]),
        };
        self.path(mesh, schedule, as_given())
    }

    /// Goes through load steps.
    pub fn path(&self, mesh: &Mesh, schedule: Schedule, settings: NewtonSettings) -> Path {
        path(&self.problem(mesh, schedule), &self.flow(mesh), settings)
    }

    /// The body.
    pub fn problem(&self, mesh: &Mesh, schedule: Schedule) -> Problem {
        let condition = |boundary: usize| {
            let load = self.load.filter(|_| mesh.boundaries[boundary].name == TOP);
            Condition {
                boundary,
                load: load.map(|load| SurfaceLoad::Pressure(STRESS + load)),
                support: load.is_none().then_some(Support::Symmetry),
            }
        };
        let mut initial_stress = InitialStress::default();
        initial_stress.components[2] = Field::constant(-STRESS);
        Problem {
            fractures: vec![Fracture {
                law: FractureLaw::elastic(self.closure(), self.stiffness),
                fluid_pressure: 0.0,
            }],
            conditions: (0..mesh.boundaries.len()).map(condition).collect(),
            schedule,
            initial_stress: Some(initial_stress),
            ..Problem::of_rock(mesh.clone(), self.rock())
        }
    }

    fn rock(&self) -> Rock {
        Rock {
            young_modulus: self.young_modulus,
            ..ROCK
        }
    }

    /// What flows.
    pub fn flow(&self, mesh: &Mesh) -> Flow {
        let inlet = self.inlet.map(|inlet| on_side(mesh, "side left", inlet));
        let outlet = self.inlet.filter(|_| self.step.is_none());
        let outlet = outlet.map(|_| on_side(mesh, "side right", PRESSURE));
        let mut flow = water(mesh, inlet.into_iter().chain(outlet).collect());
        flow.initial_pressure = Field::constant(PRESSURE);
        flow.fluid.compressibility = self.compressibility;
        flow
    }
}

const TOP: &str = "side top";

/// The cube of so many cells an edge.
pub fn cube(shape: Shape, n: usize) -> Mesh {
    layered(shape, [n; 3], |z| z)
}

/// The cube of so many hexahedra along the joint and eight layers across, thin beside it.
pub fn fine_along(n: usize) -> Mesh {
    let half = 0.5 * EDGE;
    layered(Shape::Hex8, [n, n, 8], |z| {
        let share = z / half - 1.0;
        half * (1.0 + share * share.abs())
    })
}

/// The cube of so many cells along its edges, their heights moved by `height` (m).
fn layered(shape: Shape, counts: [usize; 3], height: impl Fn(f64) -> f64) -> Mesh {
    let surfaces = [
        Patch::new("joint", &|x| x[2] == 5.0),
        Patch::new("side left", &|x| x[0] == 0.0),
        Patch::new("side right", &|x| x[0] == 10.0),
        Patch::new("side bottom", &|x| x[2] == 0.0),
        Patch::new(TOP, &|x| x[2] == 10.0),
        Patch::new("side front", &|x| x[1] == 0.0),
        Patch::new("side back", &|x| x[1] == 10.0),
    ];
    block(shape, (counts, [EDGE; 3]), &surfaces, |[x, y, z]| {
        [x, y, height(z)]
    })
}
