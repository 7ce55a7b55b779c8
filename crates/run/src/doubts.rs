//! What of a result is possible but hardly meant.

use kluft_scene::{Doubt, Scene};
use kluft_solver::{FacetResult, Load, Problem, Solution, System};

use crate::summary::FractureSummary;

/// Displacements beyond this share of the body are not small.
const SMALL_DISPLACEMENT: f64 = 0.1;
/// Forces below this share of what the initial stress exerts across the body are in balance.
const IN_BALANCE: f64 = 0.01;

/// What the user should know of a result; `nodes` are its results at the nodes of the facets.
pub fn of_result(
    scene: &Scene,
    problem: &Problem,
    solution: &Solution,
    nodes: &[FacetResult],
    fractures: &[(String, FractureSummary)],
) -> Vec<String> {
    let warn = |doubt: Doubt| move |text: String| scene.warning(doubt, &text);
    let moved = large_displacements(problem, solution);
    let moved = moved.and_then(warn(Doubt::LargeDisplacements));
    let wide = wide_apertures(problem, nodes).into_iter();
    let overlapping = overlapping_walls(fractures).into_iter();
    moved
        .into_iter()
        .chain(wide.filter_map(warn(Doubt::WideApertures)))
        .chain(overlapping.filter_map(warn(Doubt::OverlappingWalls)))
        .collect()
}

fn large_displacements(problem: &Problem, solution: &Solution) -> Option<String> {
    let (low, high) = problem.mesh.bounds();
    let body = (high - low).max_element();
    let lengths = solution.displacements.iter().map(|u| u.length());
    let largest = lengths.fold(0.0, f64::max);
    (largest > SMALL_DISPLACEMENT * body).then(|| {
        format!(
            "the rock moves by up to {largest:.3e} m in a body of {body:.3e} m: the method takes displacements for small; look at the units of young_modulus, stiffness and loads"
        )
    })
}

/// Fractures that have become wider than a facet is long; those that were from the start are told
/// before.
fn wide_apertures(problem: &Problem, nodes: &[FacetResult]) -> Vec<String> {
    let facets = &problem.mesh.facets;
    let mut widest: Vec<Option<Wide>> = vec![None; problem.mesh.fractures.len()];
    for facet in 0..facets.elements.len() {
        let fracture = facets.fracture[facet] as usize;
        let corners = problem.mesh.corners(&facets.elements, facet);
        let ends = corners.iter().cycle().skip(1);
        let lengths = corners.iter().zip(ends).map(|(a, b)| a.distance(*b));
        let size = lengths.sum::<f64>() / corners.len() as f64;
        let own = &nodes[facets.elements.range(facet)];
        let aperture = own.iter().map(|node| node.aperture).fold(0.0, f64::max);
        let was_narrow = problem.fractures[fracture].law.closure.aperture <= size;
        let is_wider = |former: Wide| aperture * former.size > former.aperture * size;
        if was_narrow && aperture > size && widest[fracture].is_none_or(is_wider) {
            widest[fracture] = Some(Wide { aperture, size });
        }
    }
    let names = problem.mesh.fractures.iter().zip(widest);
    names
        .filter_map(|(name, widest)| {
            let Wide { aperture, size } = widest?;
            Some(format!(
                "the aperture of `{name}` grows to {aperture:.3e} m on a facet of {size:.3e} m: the method takes walls for close"
            ))
        })
        .collect()
}

/// A facet whose walls are further apart than it is long.
#[derive(Clone, Copy)]
struct Wide {
    /// Largest aperture at its nodes (m).
    aperture: f64,
    /// Mean length of its edges (m).
    size: f64,
}

fn overlapping_walls(fractures: &[(String, FractureSummary)]) -> Vec<String> {
    let overlapping = fractures
        .iter()
        .filter(|(_, summary)| summary.overlap_area > 0.0);
    overlapping
        .map(|(name, summary)| {
            format!(
                "the walls of `{name}` overlap on {:.4} m2 (smallest aperture {:.3e} m): closure = \"logarithmic\" without cutoff_aperture never does",
                summary.overlap_area, summary.aperture.min
            )
        })
        .collect()
}

/// An initial stress that the loads balance at the end of no load step, nor before the first.
pub fn of_initial_stress(scene: &Scene, system: &System<'_>) -> Option<String> {
    let problem = system.problem();
    let across = across(problem)?;
    let steps = problem.schedule.steps.iter().map(|step| &step.load);
    let start = problem.schedule.start();
    let forces = steps.chain([&start]);
    let forces = forces.map(|load| out_of_balance(system, load));
    let force = forces.fold(f64::INFINITY, f64::min);
    if force <= IN_BALANCE * across {
        return None;
    }
    let text = format!(
        "the initial stress is out of balance: {force:.3e} N, {:.0} % of what it exerts across the body, are met by no traction, support or weight, and move the rock; surfaces that carry it need a traction or a support, a stress that grows with depth needs gravity",
        100.0 * force / across
    );
    scene.warning(Doubt::InitialStress, &text)
}

/// Force that the initial stress exerts across the body (N): the largest that its components reach
/// at the bottom or the top, on the mean section of the box around it.
fn across(problem: &Problem) -> Option<f64> {
    let stress = problem.initial_stress.as_ref()?;
    let (low, high) = problem.mesh.bounds();
    let largest = |x| {
        let stress = stress.at(x);
        let columns = [stress.x_axis, stress.y_axis, stress.z_axis];
        let sizes = columns.map(|column| column.abs().max_element());
        sizes.into_iter().fold(0.0, f64::max)
    };
    let section = (high - low).element_product().powf(2.0 / 3.0);
    Some(largest(low).max(largest(high)) * section)
}

/// Sum of the sizes of the forces that stress and loads leave on the nodes, as far as nothing holds
/// them (N). The walls of fractures start in balance: at a node whose copies are held alike, what
/// the walls do to each other cancels in the force on all copies; other nodes are left out.
fn out_of_balance(system: &System<'_>, load: &Load) -> f64 {
    let (points, supports) = (
        system.discretisation().points(),
        system.discretisation().supports(),
    );
    let loads = system.loads();
    let free = |point: usize| supports.constraint(point).map(|constraint| constraint.free);
    let nodes = points.offset.windows(2).filter(|ends| ends[0] < ends[1]);
    let copies = nodes.map(|ends| ends[0] as usize..ends[1] as usize);
    let held_alike = copies.filter(|copies| copies.clone().all(|p| free(p) == free(copies.start)));
    let forces = held_alike.map(|copies| {
        // The first unknown of a node moves all its copies.
        let unknown = copies.start;
        let cases = loads.cases().iter().zip(&load.factors);
        let applied = cases.map(|(case, factor)| *factor * case.applied[unknown]);
        applied.fold(loads.initial()[unknown], |sum, force| sum + force)
    });
    // In the order of the nodes, whatever the number of threads.
    forces.fold(0.0, |sum, force| sum + force.length())
}
