//! Forces on the unknowns: applied loads, initial stress, prescribed displacements.

use glam::DVec3;
use kluft_algebra::norm;
use lie_core::load_areas;
use rayon::prelude::*;

use crate::assembly::cell_forces;
use crate::assembly::interface::Interface;
use crate::assembly::springs;
use crate::space::Space;
use crate::space::cell::StrainOffsets;

/// Forces of one load case on all unknowns at load factor 1 (N).
#[derive(Debug, Clone)]
pub struct CaseLoads {
    /// Surface loads, gravity and fluid pressure.
    pub applied: Vec<DVec3>,
    /// What the prescribed displacements ask of the rock.
    pub prescribed: Vec<DVec3>,
}

impl CaseLoads {
    fn sizes(&self) -> CaseSizes {
        CaseSizes {
            applied: norm(&self.applied),
            prescribed: norm(&self.prescribed),
        }
    }
}

/// Euclidean norms of [`CaseLoads`] over all unknowns (N).
#[derive(Debug, Clone, Copy)]
pub(crate) struct CaseSizes {
    pub(crate) applied: f64,
    pub(crate) prescribed: f64,
}

/// Forces on all unknowns (N), and how large they are.
#[derive(Debug, Clone)]
pub struct Loads {
    cases: Vec<CaseLoads>,
    initial: Vec<DVec3>,
    case_sizes: Vec<CaseSizes>,
    initial_size: f64,
}

impl Loads {
    /// Those of each load case, and what the initial stress of the rock does, which is never
    /// scaled.
    pub fn new(cases: Vec<CaseLoads>, initial: Vec<DVec3>) -> Self {
        Self {
            case_sizes: cases.iter().map(CaseLoads::sizes).collect(),
            initial_size: norm(&initial),
            cases,
            initial,
        }
    }

    pub(crate) fn of(space: Space<'_>, interface: &Interface) -> Self {
        let of_case = |case| CaseLoads {
            applied: applied(space, interface, case),
            prescribed: negative(space, prescribed(space, case)),
        };
        let cases = 0..space.problem.schedule.case_count();
        Self::new(
            cases.map(of_case).collect(),
            negative(space, cell_forces::initial_stress(space)),
        )
    }

    /// Forces on the unknowns (N) that balance what the rock does when all points have moved (m),
    /// and what strains cells beside.
    pub(crate) fn resistance(
        space: Space<'_>,
        displacements: &[DVec3],
        offsets: &StrainOffsets,
    ) -> Vec<DVec3> {
        negative(
            space,
            Some(cell_forces::elastic(space, displacements, offsets)),
        )
    }

    /// Forces of each load case at load factor 1.
    pub fn cases(&self) -> &[CaseLoads] {
        &self.cases
    }

    /// What the initial stress of the rock does.
    pub fn initial(&self) -> &[DVec3] {
        &self.initial
    }

    /// Norms of the forces of each load case at load factor 1.
    pub(crate) fn case_sizes(&self) -> &[CaseSizes] {
        &self.case_sizes
    }

    /// Norm of [`Self::initial`].
    pub(crate) fn initial_size(&self) -> f64 {
        self.initial_size
    }
}

/// Forces (N) by which rock and springs resist the prescribed displacements of a load case, if
/// there are any.
fn prescribed(space: Space<'_>, case: usize) -> Option<Vec<DVec3>> {
    let mut forces = cell_forces::prescribed(space, case)?;
    springs::add_prescribed(space, case, &mut forces);
    Some(forces)
}

/// Surface loads, gravity and fluid pressure of a load case.
fn applied(space: Space<'_>, interface: &Interface, case: usize) -> Vec<DVec3> {
    let cases = &space.problem.schedule.cases;
    let mut on_points = match cases.gravity == case {
        true => cell_forces::gravity(space),
        false => vec![DVec3::ZERO; space.points.len()],
    };
    add_surface_loads(space, case, &mut on_points);
    let mut applied = on_unknowns(space, &on_points);
    let pressures = interface.points.iter().map(|point| {
        let fracture = point.fracture as usize;
        if cases.of_fracture(fracture) == case {
            space.problem.fractures[fracture].fluid_pressure
        } else {
            0.0
        }
    });
    let mut pressures: Vec<f64> = pressures.collect();
    add_varying_pressures(space, interface, case, &mut pressures);
    interface.add_pressures(&pressures, &mut applied);
    applied
}

/// Fluid pressures (Pa) that vary within fractures, on those of all facet points.
fn add_varying_pressures(
    space: Space<'_>,
    interface: &Interface,
    case: usize,
    pressures: &mut [f64],
) {
    let varying = space.problem.varying.pressures.iter();
    for entry in varying.filter(|entry| entry.case == case) {
        let points = interface.points.iter().zip(&mut *pressures);
        let own = points.filter(|(point, _)| point.fracture as usize == entry.fracture);
        own.for_each(|(point, sum)| {
            let place = space
                .problem
                .field_place(point.facet as usize, point.position);
            *sum += place.value(|at| entry.field.at(at, entry.time));
        });
    }
}

/// Forces on the unknowns that balance `forces` on the points, if there are any.
fn negative(space: Space<'_>, forces: Option<Vec<DVec3>>) -> Vec<DVec3> {
    let Some(forces) = forces else {
        return vec![DVec3::ZERO; space.points.len()];
    };
    let forces: Vec<DVec3> = forces.into_iter().map(|force| -force).collect();
    on_unknowns(space, &forces)
}

/// Forces on the unknowns from forces on the points: `T^T P f`.
fn on_unknowns(space: Space<'_>, forces: &[DVec3]) -> Vec<DVec3> {
    let (points, supports) = (space.points, space.supports);
    let projected: Vec<DVec3> = (0..points.len())
        .into_par_iter()
        .map(|point| supports.project(point, forces[point]))
        .collect();
    (0..points.len())
        .into_par_iter()
        .map(|unknown| points.gather(&projected, unknown))
        .collect()
}

fn add_surface_loads(space: Space<'_>, case: usize, forces: &mut [DVec3]) {
    let mesh = &space.problem.mesh;
    let cases = &space.problem.schedule.cases;
    let conditions = space.problem.conditions.iter().enumerate();
    for (_, condition) in conditions.filter(|(index, _)| cases.of_condition(*index) == case) {
        let Some(load) = condition.load else {
            continue;
        };
        let boundary = &mesh.boundaries[condition.boundary];
        for facet in 0..boundary.elements.len() {
            let nodes = boundary.elements.nodes_of(facet).iter();
            let positions: Vec<DVec3> = nodes.map(|&node| mesh.nodes[node as usize]).collect();
            let areas = load_areas(boundary.elements.shapes[facet], &positions);
            let slots = &boundary.slots[boundary.elements.range(facet)];
            for (&slot, area) in slots.iter().zip(areas) {
                forces[space.points.of_cell_node[slot as usize] as usize] += load.force(area);
            }
        }
    }
    add_varying_loads(space, case, forces);
}

fn add_varying_loads(space: Space<'_>, case: usize, forces: &mut [DVec3]) {
    let mesh = &space.problem.mesh;
    let loads = space.problem.varying.loads.iter();
    for load in loads.filter(|load| load.case == case) {
        let boundary = &mesh.boundaries[load.boundary];
        for facet in 0..boundary.elements.len() {
            let nodes = boundary.elements.nodes_of(facet).iter();
            let positions: Vec<DVec3> = nodes.map(|&node| mesh.nodes[node as usize]).collect();
            let of_nodes = load.forces(boundary.elements.shapes[facet], &positions);
            let slots = &boundary.slots[boundary.elements.range(facet)];
            for (&slot, force) in slots.iter().zip(of_nodes) {
                forces[space.points.of_cell_node[slot as usize] as usize] += force;
            }
        }
    }
}
