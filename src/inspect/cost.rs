//! Unknowns, and what solving for them will take.

use kluft_mesh::Mesh;
use kluft_solver::{Discretisation, Pattern, Plan, Prediction, SectorNodes, Unknowns, Workload};

use super::findings::{Inspection, SectorCounts, SolverFinding, UnknownFindings};

/// Counts unknowns and predicts memory and time of the solvers.
pub fn predict(
    mesh: &Mesh,
    discretisation: Option<&Discretisation>,
    workload: Workload,
    inspection: &mut Inspection,
) {
    let own = discretisation.is_none().then(|| {
        let points = SectorNodes::of(mesh);
        let pattern = Pattern::of(mesh, &points);
        (points, pattern)
    });
    let (points, pattern) = match (&own, discretisation) {
        (Some((points, pattern)), _) => (points, pattern),
        (None, Some(found)) => (found.points(), found.pattern()),
        (None, None) => return,
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
    match Plan::of(outline, workload, None, usize::MAX) {
        Ok(plan) => inspection
            .solvers
            .extend(plan.predictions.iter().map(|p| finding(&plan, p))),
        Err(failure) => {
            let warning = format!("the direct solver cannot analyse this mesh: {failure:?}");
            inspection.warnings.push(warning);
        }
    }
}

fn finding(plan: &Plan, prediction: &Prediction) -> SolverFinding {
    SolverFinding {
        name: prediction.method.name(),
        is_prediction: true,
        is_chosen: prediction.method == plan.method,
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
