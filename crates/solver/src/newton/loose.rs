//! Blocks that nothing holds once fractures have opened or slide.

use kluft_mesh::Defect;
use rayon::prelude::*;

use super::walls::tangent;
use crate::space::rigid_modes::{self, Tie};
use crate::system::{State, System};

/// Stiffness that counts as none, against that of the rock beside a facet point.
const NONE: f64 = 1e-9;

/// The blocks that can move freely in a state, with the fractures that let them.
pub(super) fn find(system: &System<'_>, state: &State) -> Vec<Defect> {
    let ties = ties(system, state);
    let facets = &system.problem.mesh.facets;
    let mut names: Vec<u32> = std::iter::zip(&ties, &facets.fracture)
        .filter(|(tie, _)| !(tie.across && tie.along))
        .map(|(_, fracture)| *fracture)
        .collect();
    names.sort_unstable();
    names.dedup();
    let names = names.iter().map(|&fracture| {
        let name = &system.problem.mesh.fractures[fracture as usize];
        format!("`{name}`")
    });
    let names: Vec<String> = names.collect();
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

fn ties(system: &System<'_>, state: &State) -> Vec<Tie> {
    let none = Tie {
        across: false,
        along: false,
    };
    let mut ties = vec![none; system.problem.mesh.facets.elements.len()];
    let points = &system.discretisation.interface.points;
    let resists: Vec<(bool, bool)> = points
        .par_iter()
        .zip(&state.facet_points)
        .map(|(point, state)| {
            let stiffness = tangent(system.law(point), point, state).positive;
            let across = point.normal.dot(stiffness * point.normal);
            let trace = stiffness.x_axis.x + stiffness.y_axis.y + stiffness.z_axis.z;
            let enough = NONE * point.spring;
            let along = !state.joint.sliding && trace - across > enough;
            (across > enough, along)
        })
        .collect();
    for (point, (across, along)) in points.iter().zip(resists) {
        let tie = &mut ties[point.facet as usize];
        tie.across |= across;
        tie.along |= along;
    }
    ties
}
