//! Unknowns, and what solving for them will take.

use kluft_mesh::{Defect, Mesh};
use kluft_run::{RunFlow, too_large};
use kluft_scene::{Binding, Scene, SolverEntry, in_terms_of_scene};
use kluft_solver::{
    Discretisation, Flow, Pattern, Plan, Prediction, Problem, SectorNodes, Unknowns, Workload,
};

use super::findings::{Inspection, SectorCounts, SolverFinding, UnknownFindings};

/// Directions in which a permeability is asked for.
const AXES: usize = 3;

/// Counts unknowns and predicts memory and time of the solvers; returns what is wrong if the one
/// that a scene asks for, or else all of them, take more memory than it allows.
pub fn predict(
    mesh: &Mesh,
    discretisation: Option<&Discretisation>,
    (workload, asked): (Workload, &SolverEntry),
    inspection: &mut Inspection,
) -> Option<Defect> {
    let own = discretisation.is_none().then(|| {
        let points = SectorNodes::of(mesh);
        let pattern = Pattern::of(mesh, &points);
        (points, pattern)
    });
    let (points, pattern) = match (&own, discretisation) {
        (Some((points, pattern)), _) => (points, pattern),
        (None, Some(found)) => (found.points(), found.pattern()),
        (None, None) => return None,
    };
    inspection.unknowns = Some(unknowns(mesh, points, discretisation));
    let jumps: Vec<u32> = match discretisation {
        Some(found) => found.interface().unknowns().to_vec(),
        None => (0..points.len())
            .filter(|&unknown| points.sector(unknown).0 > 0)
            .map(|unknown| unknown as u32)
            .collect(),
    };
    let outline = Unknowns {
        pattern,
        points,
        jumps: &jumps,
    };
    let workload = workload.with_extra_memory(mesh, points.len());
    let limit = asked
        .memory_limit
        .map_or(usize::MAX, |limit| limit as usize);
    match Plan::of(outline, workload, asked.linear, limit) {
        Ok(plan) => {
            let all = plan.predictions.iter();
            let all = all.map(|own| finding(own, own.method == plan.method));
            inspection.solvers.extend(all);
            let is_too_large = plan.prediction().memory_bytes > limit;
            is_too_large.then(|| too_large(&plan, asked, limit))
        }
        Err(failure) => {
            let warning = format!("the direct solver cannot analyse this mesh: {failure:?}");
            inspection.warnings.push(warning);
            None
        }
    }
}

/// Predicts memory and time of a flow in rigid rock, whose matrix is factorised once, or where it
/// takes time for each length of its increments; of a permeability there are three solves more.
///
/// # Errors
/// A flow that cannot be made.
pub fn predict_flow(
    scene: &Scene,
    binding: &Binding,
    inspection: &mut Inspection,
) -> Result<(), Vec<Defect>> {
    let (problem, Some(flow)) = (&binding.problem, &binding.flow) else {
        return Ok(());
    };
    let made = RunFlow::of(problem, flow).map_err(in_terms_of_scene)?;
    let mut times = increments(scene, problem, flow);
    if scene.equivalent_permeability {
        times[0] += 1;
        times[1] += AXES;
    }
    let pressures = made.system().unknown_count();
    match made.system().analysis() {
        Ok(analysis) => {
            let found = analysis.map(|own| Prediction::of_rigid_flow(&own, pressures, times));
            let found = found.iter().map(|own| finding(own, true));
            inspection.solvers.extend(found);
        }
        Err(failure) => {
            let warning = format!("the flow cannot be analysed: {failure:?}");
            inspection.warnings.push(warning);
        }
    }
    Ok(())
}

/// Factorisations and solves of the load steps of a flow: one step is one increment, or one and two
/// where the accuracy in time is asked for.
fn increments(scene: &Scene, problem: &Problem, flow: &Flow) -> [usize; 2] {
    let schedule = &problem.schedule;
    if flow.conditions.is_empty() && scene.equivalent_permeability {
        return [0, 0];
    }
    if !flow.is_stored(schedule.is_timed) {
        return [1, schedule.steps.len()];
    }
    let is_divided = scene.solver.time_accuracy.is_none_or(|share| share < 1.0);
    let mut lengths = Vec::new();
    let mut now = schedule.start().time;
    for step in &schedule.steps {
        lengths.push((step.load.time - now).to_bits());
        now = step.load.time;
    }
    lengths.sort_unstable();
    lengths.dedup();
    let (of_each, solves) = if is_divided { (2, 3) } else { (1, 1) };
    [of_each * lengths.len(), solves * schedule.steps.len()]
}

fn finding(prediction: &Prediction, is_chosen: bool) -> SolverFinding {
    SolverFinding {
        name: prediction.method.name(),
        is_prediction: true,
        is_chosen,
        factor_entries: prediction.factor_entries,
        memory_bytes: prediction.memory_bytes,
        operations: prediction.operations,
        seconds: prediction.seconds,
    }
}

fn unknowns(
    mesh: &Mesh,
    points: &SectorNodes,
    discretisation: Option<&Discretisation>,
) -> UnknownFindings {
    let mut nodes = [0; 9];
    for &sectors in &mesh.sectors.count {
        nodes[sectors.min(8) as usize] += 1;
    }
    let [_, plain_nodes, fracture_nodes, junctions @ ..] = nodes;
    UnknownFindings {
        total: discretisation.map_or(3 * points.len(), Discretisation::unknown_count),
        without_held: discretisation.is_some(),
        jumps: 3 * points.jump_count(),
        plain_nodes,
        fracture_nodes,
        junction_nodes: SectorCounts::from(junctions),
    }
}
