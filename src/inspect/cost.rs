//! Unknowns, and what solving for them will take.

use std::time::Instant;

use lie_mesh::Mesh;
use lie_solver::{Analysis, Discretisation, NodeOrder, Pattern, Points, measured_rate};

use super::findings::{Inspection, SectorCounts, SolverFinding, UnknownFindings};

/// Counts unknowns and predicts memory and time of the direct solver.
pub fn predict(mesh: &Mesh, discretisation: Option<&Discretisation>, inspection: &mut Inspection) {
    let own = discretisation.is_none().then(|| {
        let points = Points::of(mesh);
        let pattern = Pattern::of(mesh, &points);
        (points, pattern)
    });
    let (points, pattern) = match (&own, discretisation) {
        (Some((points, pattern)), _) => (points, pattern),
        (None, Some(found)) => (&found.points, &found.pattern),
        (None, None) => return,
    };
    inspection.unknowns = Some(unknowns(mesh, points, discretisation));
    let start = Instant::now();
    let analysis =
        NodeOrder::of(pattern, points).and_then(|order| Analysis::of(pattern, points, &order, &[]));
    let analysis = match analysis {
        Ok(analysis) => analysis,
        Err(failure) => {
            let warning = format!("the direct solver cannot analyse this mesh: {failure:?}");
            inspection.warnings.push(warning);
            return;
        }
    };
    let analysis_seconds = start.elapsed().as_secs_f64();
    let (operations, rate) = (analysis.factor_operations(), measured_rate());
    inspection.solvers.push(SolverFinding {
        name: "direct",
        is_prediction: true,
        factor_entries: analysis.factor_entries(),
        memory_bytes: analysis.memory_bytes(),
        operations,
        operations_per_second: rate,
        factorisation_seconds: operations / rate,
        analysis_seconds,
    });
}

fn unknowns(
    mesh: &Mesh,
    points: &Points,
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
