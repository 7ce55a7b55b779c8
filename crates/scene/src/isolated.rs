//! Networks that nothing drives, left out of the flow or keeping what they hold where the scene
//! says so.

use kluft_mesh::Defect;
use kluft_solver::{Flow, FlowSystem, Problem};

use crate::remedies::in_terms_of_scene;
use crate::scene::{Isolated, Scene};

/// Leaves networks that no condition acts on out of a flow, or tells of those that keep what they
/// hold, as the scene wants it, and how many; those that are all
/// there is stay, to be refused.
///
/// # Errors
/// As [`FlowSystem::of`].
pub(crate) fn treat(
    scene: &Scene,
    problem: &Problem,
    flow: &mut Flow,
    decisions: &mut Vec<String>,
) -> Result<(), Vec<Defect>> {
    if flow.is_undrained {
        return keep_undrained(problem, flow, decisions);
    }
    if scene.isolated != Isolated::Inactive || flow.conditions.is_empty() {
        return Ok(());
    }
    let (mesh, apertures) = (&problem.mesh, problem.initial_apertures());
    let system = FlowSystem::of(mesh, flow, &apertures).map_err(in_terms_of_scene)?;
    let (isolated, networks) = (system.isolated_facets(), system.networks());
    let idle = networks
        .iter()
        .filter(|network| network.conditions.is_empty());
    let idle_count = idle.count();
    if idle_count == 0 {
        return Ok(());
    }
    let areas = mesh.facet_areas();
    let area: f64 = isolated
        .iter()
        .map(|&facet| areas[facet as usize].length())
        .sum();
    let whole: f64 = areas.iter().map(|area| area.length()).sum();
    decisions.push(format!(
        "{idle_count} of {} networks are isolated and inactive: no pressure and no rate acts on \
         them; {area:.4e} m2 of fractures, {:.1} % of all",
        networks.len(),
        100.0 * area / whole
    ));
    flow.inactive = isolated;
    Ok(())
}

/// Tells how many networks keep what they hold; lets the flow be as any other if none does.
fn keep_undrained(
    problem: &Problem,
    flow: &mut Flow,
    decisions: &mut Vec<String>,
) -> Result<(), Vec<Defect>> {
    let apertures = problem.initial_apertures();
    let system = FlowSystem::of(&problem.mesh, flow, &apertures).map_err(in_terms_of_scene)?;
    let networks = system.networks();
    let kept = networks.iter().filter(|network| !network.has_pressure);
    let (kept, all) = (kept.count(), networks.len());
    if kept > 0 {
        decisions.push(format!(
            "{kept} of {all} networks are undrained: no pressure is given to them, and they keep \
             the fluid that they hold"
        ));
    }
    flow.is_undrained = kept > 0;
    Ok(())
}
