//! Everything a solve needs: mesh, materials, conditions, load steps.

mod conditions;
mod field_place;
mod flow;
mod initial_stress;
mod schedule;
mod springs;
mod varying;

use glam::DVec3;
use kluft_mesh::Mesh;
use lie_core::{FacetQuadrature, FacetRulePoint, FractureLaw, Rock, facet_points};

pub(crate) use field_place::FieldPlace;

pub use conditions::{Condition, FixedPoint, Support, SurfaceLoad};
pub use flow::{Conduit, Flow, FlowCondition, FlowDrive, FlowPlace, Fluid, Leakoff, LineShare};
pub use initial_stress::InitialStress;
pub use kluft_field::{Field, Profile};
pub use schedule::{Cases, Load, Schedule, Step};
pub use springs::{Spring, SpringStiffness};
pub use varying::{
    HeldPart, LawParameter, LoadField, RockParameter, Varying, VaryingDisplacement, VaryingLaw,
    VaryingLoad, VaryingPressure,
};

/// A fracture's law and what fills it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fracture {
    /// The law that a discretisation takes over; later ones are given to the system. Where
    /// parameters vary, it has their means.
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
    /// Springs on the outer surface.
    pub springs: Vec<Spring>,
    /// Nodes held by themselves.
    pub fixed_points: Vec<FixedPoint>,
    /// Acceleration of gravity (m/s^2).
    pub gravity: DVec3,
    /// Stress before any load.
    pub initial_stress: Option<InitialStress>,
    /// Cells that came later than the initial stress, and are without it; empty if there are none.
    pub added: Vec<bool>,
    /// What varies within fractures and parts of the surface.
    pub varying: Varying,
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
            springs: Vec::new(),
            fixed_points: Vec::new(),
            gravity: DVec3::ZERO,
            initial_stress: None,
            added: Vec::new(),
            varying: Varying::default(),
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
            let law = self.fractures[fracture as usize].law;
            let mut varying = self.varying.laws.iter();
            let varying = varying.find(|varying| varying.fracture == fracture as usize);
            let nodes = facets.elements.nodes_of(facet).iter();
            nodes.map(move |&node| {
                let own = varying.map(|own| own.at_position(&law, self.mesh.nodes[node as usize]));
                own.unwrap_or(law).closure.aperture
            })
        });
        apertures.collect()
    }

    /// Stress before any load in a cell, if it has been there as long.
    pub fn initial_stress_in(&self, cell: usize) -> Option<&InitialStress> {
        let stress = self.initial_stress.as_ref()?;
        (!self.added.get(cell).is_some_and(|&added| added)).then_some(stress)
    }

    /// Rock of a cell.
    pub fn rock(&self, cell: usize) -> &Rock {
        &self.rocks[self.rock_of_cell[cell] as usize]
    }

    /// What each cell is of: its rock, or the material whose rock varies.
    pub fn material_of_cell(&self) -> &[u32] {
        let own = self.varying.material_of_cell.as_ref();
        own.unwrap_or(&self.rock_of_cell)
    }

    /// The law of a fracture at a facet point, where it varies; `node` is the position (m) of the
    /// node that the point belongs to, if it belongs to one.
    ///
    /// Laws with kinks are taken at the nodes: points that have one jump touch and slide together.
    pub(crate) fn varying_law(
        &self,
        facet: usize,
        point: &FacetRulePoint,
        node: Option<DVec3>,
    ) -> Option<FractureLaw> {
        let fracture = self.mesh.facets.fracture[facet];
        let mut all = self.varying.laws.iter();
        let varying = all.find(|law| law.fracture == fracture as usize)?;
        let place = match (self.rule_of(fracture), node) {
            (FacetQuadrature::Control, Some(node)) => FieldPlace::inside(node),
            _ => self.field_place(facet, point.position),
        };
        Some(varying.at(&self.fractures[fracture as usize].law, &place))
    }

    /// Where a value that varies is taken for a facet point at a position (m).
    pub(crate) fn field_place(&self, facet: usize, position: DVec3) -> FieldPlace {
        let corners = self.mesh.corners(&self.mesh.facets.elements, facet);
        FieldPlace::of(&corners, position)
    }

    /// Positions (m) at which a law and a fluid pressure of a fracture are asked for.
    pub fn places_of_fracture(&self, fracture: usize) -> Vec<DVec3> {
        let facets = &self.mesh.facets;
        let places = facets.of_fracture(fracture).flat_map(|facet| {
            let nodes = facets.elements.nodes_of(facet).iter();
            let nodes: Vec<DVec3> = nodes.map(|&node| self.mesh.nodes[node as usize]).collect();
            let rule = self.rule_of(fracture as u32);
            let points = facet_points(facets.elements.shapes[facet], &nodes, rule).into_iter();
            let places: Vec<DVec3> = points
                .flat_map(|point| self.field_place(facet, point.position).positions())
                .collect();
            let at_nodes = match rule {
                FacetQuadrature::Control => nodes,
                FacetQuadrature::Nodal | FacetQuadrature::Gauss => Vec::new(),
            };
            places.into_iter().chain(at_nodes)
        });
        places.collect()
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
