//! Blocks that nothing holds once fractures have opened or slide.

use kluft_mesh::Defect;
use rayon::prelude::*;

use super::facet_points::{interface, tangent};
use crate::space::rigid_modes::{self, Tie};
use crate::system::{State, System};

/// Stiffness that counts as none, against that of the rock beside a facet point.
const NO_STIFFNESS: f64 = 1e-9;

/// The blocks that can move freely in a state, with the fractures that let them.
pub(super) fn find(system: &System<'_>, state: &State) -> Vec<Defect> {
    let ties = ties(system, state);
    let names = untied_fractures(system, &ties);
    let discretisation = &system.discretisation;
    rigid_modes::find_with(
        system.problem,
        &discretisation.points,
        &discretisation.supports,
        &ties,
        &format!(
            "{} has opened or slides there; hold the block, lower the load, or give the fracture friction, cohesion or stiffness",
            names.join(", ")
        ),
    )
}

/// Names of the fractures with facets that let their sides move.
fn untied_fractures(system: &System<'_>, ties: &[Tie]) -> Vec<String> {
    let mesh = &system.problem.mesh;
    let facets = std::iter::zip(ties, &mesh.facets.fracture);
    let untied = facets.filter(|(tie, _)| !(tie.across && tie.along));
    let mut fractures: Vec<u32> = untied.map(|(_, fracture)| *fracture).collect();
    fractures.sort_unstable();
    fractures.dedup();
    let name = |fracture: &u32| format!("`{}`", mesh.fractures[*fracture as usize]);
    fractures.iter().map(name).collect()
}

/// How each facet holds its two sides together.
pub(super) fn ties(system: &System<'_>, state: &State) -> Vec<Tie> {
    let none = Tie {
        across: false,
        along: false,
    };
    let mut ties = vec![none; system.problem.mesh.facets.elements.len()];
    let points = &interface(system).points;
    let of_points: Vec<Tie> = points
        .par_iter()
        .zip(&state.facet_points)
        .map(|(point, state)| {
            let stiffness = tangent(system.law(point), point, state).positive;
            let across = point.normal.dot(stiffness * point.normal);
            let trace = stiffness.x_axis.x + stiffness.y_axis.y + stiffness.z_axis.z;
            let enough = NO_STIFFNESS * point.spring;
            Tie {
                across: across > enough,
                along: !state.joint.sliding && trace - across > enough,
            }
        })
        .collect();
    for (point, own) in points.iter().zip(of_points) {
        let tie = &mut ties[point.facet as usize];
        tie.across |= own.across;
        tie.along |= own.along;
    }
    ties
}
