//! What a converged state means: displacement, stress, jump, aperture, traction.

use glam::{DMat3, DVec3};
use kluft_mesh::Shape;
use lie_core::kernel;
use lie_core::{Closure, FacetQuadrature, SymmetricStress, bezier_function};
use rayon::prelude::*;

use crate::assembly::facet_point::FacetPoint;
use crate::assembly::interface::Interface;
use crate::problem::Problem;
use crate::space::cell::{Cell, components};
use crate::system::{FacetPointState, State, StateScales, System};

/// What a facet point does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FacetState {
    /// Its aperture is at least the initial one, in contact greater than 0, by more than what the
    /// tests of convergence leave; or it carries tension.
    Open = 0,
    /// It is closed and does not slide.
    Stuck = 1,
    /// It is closed and slides.
    Slipping = 2,
    /// Its aperture is below the cutoff of its law.
    BelowCutoff = 3,
}

/// Share of the largest displacement, and of the largest traction, on the way to a state below
/// which walls have not parted: forces balance to no smaller share of the largest force, so which
/// way the walls of a joint without load are off is rounding.
const PARTED: f64 = 1e-9;

/// Results at one facet point.
#[derive(Debug, Clone, Copy)]
pub struct FacetResult {
    /// `u(plus) - u(minus)` (m), since the state of initial stress.
    pub jump: DVec3,
    /// Normal part of the jump (m).
    pub opening: f64,
    /// Tangential part of the jump (m).
    pub slip: DVec3,
    /// Aperture `b` (m).
    pub aperture: f64,
    /// Traction of the law (Pa), without the fluid pressure.
    pub traction: DVec3,
    /// Its normal part (Pa).
    pub normal_traction: f64,
    /// State.
    pub state: FacetState,
}

/// Fields of one converged state.
#[derive(Debug, Clone)]
pub struct Solution {
    /// Displacement of every point (m).
    pub displacements: Vec<DVec3>,
    /// Mean stress of every cell, initial stress included (Pa).
    pub stresses: Vec<SymmetricStress>,
    /// Results of every facet point, as its law sees them: at control points, control values.
    pub facet_points: Vec<FacetResult>,
}

impl Solution {
    /// Results at the nodes of the facets, in the order of their flat node list: the jump is that
    /// of the walls there, traction and state are those of the facet point of the node.
    pub fn facet_nodes(&self, problem: &Problem, interface: &Interface) -> Vec<FacetResult> {
        let facets = &problem.mesh.facets;
        let mut results = self.facet_points[..facets.elements.nodes.len()].to_vec();
        for facet in 0..facets.elements.len() {
            let shape = facets.elements.shapes[facet];
            let control = interface.rule_of(facets.fracture[facet]) == FacetQuadrature::Control;
            if control && shape.is_quadratic() {
                let range = facets.elements.range(facet);
                let points = &interface.points[range.clone()];
                let control = &self.facet_points[range.clone()];
                take_from_control(shape, points, control, &mut results[range]);
            }
        }
        results
    }
}

/// `w_a = sum_q S_qa c_q`.
fn take_from_control(
    shape: Shape,
    points: &[FacetPoint],
    control: &[FacetResult],
    nodes: &mut [FacetResult],
) {
    for node in nodes.iter_mut() {
        (node.aperture, node.jump) = (0.0, DVec3::ZERO);
    }
    for (q, value) in control.iter().enumerate() {
        for (local, share) in bezier_function(shape, q) {
            let node = &mut nodes[local as usize];
            node.aperture += share * value.aperture;
            node.jump += share * value.jump;
        }
    }
    for (node, point) in nodes.iter_mut().zip(points) {
        node.opening = node.jump.dot(point.normal);
        node.slip = node.jump - node.opening * point.normal;
    }
}

/// Derives the fields of a state.
pub fn solution(system: &System<'_>, state: &State) -> Solution {
    let displacements = system.total_displacements(state);
    let cell_count = system.problem.mesh.cells.len();
    let stresses = (0..cell_count)
        .into_par_iter()
        .map(|cell| cell_stress(system, &displacements, cell))
        .collect();
    let interface = &system.discretisation.interface;
    let jumps = system.total_jumps(state);
    let facet_points = (0..jumps.len())
        .into_par_iter()
        .map(|i| {
            let point = &interface.points[i];
            // A joint without load is left with the rounding of the stress beside it.
            let beside = point.spring * state.reached.displacement;
            let reached = StateScales {
                traction: state.reached.traction.max(beside),
                ..state.reached
            };
            let walls = [jumps[i], point.normal];
            let closure = system.law(point).closure;
            facet_result(closure, walls, &state.facet_points[i], reached)
        })
        .collect();
    Solution {
        displacements,
        stresses,
        facet_points,
    }
}

fn cell_stress(system: &System<'_>, displacements: &[DVec3], index: usize) -> SymmetricStress {
    let problem = system.problem;
    let points = &system.discretisation.points;
    let cell =
        Cell::of(problem, points, displacements, index).strained(system.strain_offsets(), index);
    let initial = problem
        .initial_stress_in(index)
        .map_or(DMat3::ZERO, |stress| {
            stress.at(kernel::centre(cell.shape, cell.nodes()))
        });
    let gradient = kernel::mean_gradient(cell.shape, cell.nodes(), cell.moved());
    components(cell.rock.stress(gradient) + initial)
}

fn facet_result(
    closure: Closure,
    [jump, normal]: [DVec3; 2],
    state: &FacetPointState,
    reached: StateScales,
) -> FacetResult {
    let aperture = state.joint.separation.aperture;
    let opening = jump.dot(normal);
    let traction = state.joint.traction(normal);
    FacetResult {
        jump,
        opening,
        slip: jump - opening * normal,
        aperture,
        traction,
        normal_traction: traction.dot(normal),
        state: kind(&closure, state, reached),
    }
}

fn kind(closure: &Closure, state: &FacetPointState, reached: StateScales) -> FacetState {
    let joint = &state.joint;
    let aperture = joint.separation.aperture;
    let small = PARTED * reached.displacement;
    let below = closure.cutoff().is_some_and(|cutoff| aperture < cutoff);
    let gap = closure.gap(joint.separation);
    // Walls of a stiff joint carry tension long before they have moved.
    let in_tension = gap > 0.0 && joint.normal_traction > PARTED * reached.traction;
    let is_free = closure.normal_stiffness == 0.0;
    if below && !closure.is_linear() {
        FacetState::BelowCutoff
    } else if joint.sliding && joint.normal_traction < 0.0 {
        FacetState::Slipping
    } else if gap > small || in_tension || is_free && aperture >= closure.aperture - small {
        FacetState::Open
    } else {
        FacetState::Stuck
    }
}
