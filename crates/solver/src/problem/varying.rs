//! What varies within a fracture or a part of the surface.

use glam::DVec3;
use kluft_field::Field;
use kluft_mesh::Shape;
use lie_core::{ClosureKind, FacetQuadrature, FractureLaw, Rock, Tension, facet_points};

use super::field_place::FieldPlace;

/// What of a problem varies in space. All of it is empty where plain numbers serve.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Varying {
    /// Laws of fractures, at most one entry for each.
    pub laws: Vec<VaryingLaw>,
    /// Fluid pressures, beside those of [`crate::Fracture`].
    pub pressures: Vec<VaryingPressure>,
    /// Surface loads, beside those of [`crate::Condition`].
    pub loads: Vec<VaryingLoad>,
    /// Prescribed displacements, beside those of supports and of nodes held by themselves.
    pub displacements: Vec<VaryingDisplacement>,
    /// Where rocks vary, each cell may have one of its own; then these are the numbers of what they
    /// are cells of, one for each cell.
    pub material_of_cell: Option<Vec<u32>>,
}

/// A law some of whose parameters vary within its fracture.
#[derive(Debug, Clone, PartialEq)]
pub struct VaryingLaw {
    /// Index into [`kluft_mesh::MeshData::fractures`].
    pub fracture: usize,
    /// The parameters; the others are those of the fracture's law.
    pub parameters: Vec<(LawParameter, Field)>,
}

/// A parameter of a law, and the unit of its values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LawParameter {
    /// Aperture without load (m).
    Aperture,
    /// Normal stiffness without load (Pa/m).
    NormalStiffness,
    /// Shear stiffness (Pa/m).
    ShearStiffness,
    /// Aperture below which a logarithmic law goes on linearly (m).
    CutoffAperture,
    /// Largest closure of a hyperbolic law (m).
    MaxClosure,
    /// Strength of a bond (Pa).
    TensileStrength,
    /// Energy of a bond (J/m^2).
    FractureEnergy,
    /// Angle of friction (degrees).
    FrictionAngle,
    /// Cohesion (Pa).
    Cohesion,
    /// Angle of dilation (degrees).
    DilationAngle,
}

impl LawParameter {
    /// Gives a law this parameter, if it has it.
    pub fn set(self, law: &mut FractureLaw, value: f64) {
        let closure = &mut law.closure;
        let tangent = |degrees: f64| degrees.to_radians().tan();
        match (self, &mut closure.kind, &mut closure.tension) {
            (Self::Aperture, ..) => closure.aperture = value,
            (Self::NormalStiffness, ..) => closure.normal_stiffness = value,
            (Self::ShearStiffness, ..) => law.shear_stiffness = value,
            (Self::CutoffAperture, ClosureKind::Logarithmic { cutoff }, _) => *cutoff = Some(value),
            (Self::MaxClosure, ClosureKind::Hyperbolic { max_closure }, _) => *max_closure = value,
            (Self::TensileStrength, _, Tension::Cohesive { strength, .. }) => *strength = value,
            (Self::FractureEnergy, _, Tension::Cohesive { energy, .. }) => *energy = value,
            _ => {
                if let Some(friction) = &mut law.friction {
                    match self {
                        Self::FrictionAngle => friction.coefficient = tangent(value),
                        Self::Cohesion => friction.cohesion = value,
                        Self::DilationAngle => friction.dilation = tangent(value),
                        _ => {}
                    }
                }
            }
        }
    }
}

impl VaryingLaw {
    /// The law at a position (m); `law` has the parameters that do not vary.
    pub fn at_position(&self, law: &FractureLaw, position: DVec3) -> FractureLaw {
        self.at(law, &FieldPlace::inside(position))
    }

    /// The law of a facet point; `law` has the parameters that do not vary.
    pub(crate) fn at(&self, law: &FractureLaw, place: &FieldPlace) -> FractureLaw {
        let mut own = *law;
        for (parameter, field) in &self.parameters {
            parameter.set(&mut own, place.kept_value(|at| field.at(at, 0.0)));
        }
        own
    }
}

/// A constant of a rock, and the unit of its values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RockParameter {
    /// Young's modulus (Pa).
    YoungModulus,
    /// Poisson's ratio.
    PoissonRatio,
    /// Density (kg/m^3).
    Density,
}

impl RockParameter {
    /// Gives a rock this constant.
    pub fn set(self, rock: &mut Rock, value: f64) {
        match self {
            Self::YoungModulus => rock.young_modulus = value,
            Self::PoissonRatio => rock.poisson_ratio = value,
            Self::Density => rock.density = value,
        }
    }
}

/// A fluid pressure that varies within a fracture (Pa), opening, at load factor 1.
#[derive(Debug, Clone, PartialEq)]
pub struct VaryingPressure {
    /// Index into [`kluft_mesh::MeshData::fractures`].
    pub fracture: usize,
    /// Its values.
    pub field: Field,
    /// The time for which they are taken.
    pub time: f64,
    /// Its load case.
    pub case: usize,
}

/// A load that varies within a part of the outer surface, at load factor 1.
#[derive(Debug, Clone, PartialEq)]
pub struct VaryingLoad {
    /// Index into [`kluft_mesh::MeshData::boundaries`].
    pub boundary: usize,
    /// Its values.
    pub load: LoadField,
    /// The time for which they are taken.
    pub time: f64,
    /// Its load case.
    pub case: usize,
}

/// A prescribed displacement along one axis that varies, at load factor 1. Its values are those at
/// the nodes; blocks on all sides of a node share them.
#[derive(Debug, Clone, PartialEq)]
pub struct VaryingDisplacement {
    /// What is moved, which must hold this axis.
    pub held: HeldPart,
    /// The axis: 0, 1, 2 for x, y, z.
    pub axis: usize,
    /// Its values (m).
    pub field: Field,
    /// The time for which they are taken.
    pub time: f64,
    /// Its load case.
    pub case: usize,
}

/// What supports hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HeldPart {
    /// A part of the outer surface: index into [`crate::Problem::conditions`].
    Condition(usize),
    /// A node: index into [`crate::Problem::fixed_points`].
    FixedPoint(usize),
}

/// Values of a surface load.
#[derive(Debug, Clone, PartialEq)]
pub enum LoadField {
    /// Force per area in global axes (Pa).
    Traction(Box<[Field; 3]>),
    /// Force per area along the inward normal (Pa).
    Pressure(Field),
}

impl LoadField {
    /// Whether it changes with time.
    pub fn depends_on_time(&self) -> bool {
        match self {
            Self::Traction(fields) => fields.iter().any(Field::depends_on_time),
            Self::Pressure(field) => field.depends_on_time(),
        }
    }
}

impl VaryingLoad {
    /// Forces (N) on the nodes of a facet with these positions (m): `int N t dA` by Gauss's rule.
    pub fn forces(&self, shape: Shape, nodes: &[DVec3]) -> Vec<DVec3> {
        let mut forces = vec![DVec3::ZERO; nodes.len()];
        for point in facet_points(shape, nodes, FacetQuadrature::Gauss) {
            let at = |field: &Field| field.at(point.position, self.time);
            let force = match &self.load {
                LoadField::Traction(fields) => {
                    point.area.length() * DVec3::from([0, 1, 2].map(|axis| at(&fields[axis])))
                }
                LoadField::Pressure(field) => -at(field) * point.area,
            };
            for (local, value) in point.nodes {
                forces[local as usize] += value * force;
            }
        }
        forces
    }
}
