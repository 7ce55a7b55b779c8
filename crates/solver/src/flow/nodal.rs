//! Conditions as they act on nodes.

use kluft_mesh::{Defect, Mesh};

use super::conductance::Conductance;
use super::edges;
use super::numbering::FlowNodes;
use super::wells::{self, Well};
use crate::problem::{Flow, FlowCondition, FlowDrive, FlowPlace, Load, Profile};

/// A condition on pressures.
#[derive(Debug, Clone)]
pub(super) enum Nodal {
    /// Given at these rows, ascending.
    Given(Vec<usize>),
    /// A rate that these rows share, ascending, with shares that add up to 1.
    Shared(Vec<(usize, f64)>),
    /// A rate through the wall of a borehole.
    WellRate(Well),
    /// The pressure at the wall of a borehole.
    WellPressure(Well),
}

/// A condition, and what it does to rows.
#[derive(Debug, Clone)]
pub(super) struct NodalCondition {
    /// Index into [`Flow::conditions`].
    pub(super) condition: usize,
    /// What it does.
    pub(super) nodal: Nodal,
}

/// All conditions of a flow.
///
/// # Errors
/// Each that meets no conducting fracture, that shares a rate among nothing that conducts, and each
/// node where two give different pressures.
pub(super) fn conditions(
    mesh: &Mesh,
    flow: &Flow,
    nodes: &FlowNodes,
    conductance: &Conductance,
) -> Result<Vec<NodalCondition>, Vec<Defect>> {
    let mut defects = Vec::new();
    let mut found = Vec::new();
    for (condition, entry) in flow.conditions.iter().enumerate() {
        match nodal(mesh, entry, nodes, conductance) {
            Ok(nodal) => found.push(NodalCondition { condition, nodal }),
            Err(defect) => defects.push(defect),
        }
    }
    defects.extend(contradictions(mesh, flow, nodes, &found));
    match defects.is_empty() {
        true => Ok(found),
        false => Err(defects),
    }
}

fn nodal(
    mesh: &Mesh,
    entry: &FlowCondition,
    nodes: &FlowNodes,
    conductance: &Conductance,
) -> Result<Nodal, Defect> {
    let meets_nothing = || {
        Defect::new(
            &entry.name,
            "no fracture that conducts meets it",
            "give it where a fracture that is not sealed is, or remove it",
        )
    };
    if let FlowPlace::Well { node, radius } = entry.place {
        let row = nodes.of_node(node).ok_or_else(meets_nothing)?;
        let well = wells::at(mesh, nodes, conductance, row, (radius, &entry.name))?;
        return Ok(match entry.drive {
            FlowDrive::Pressure(_) => Nodal::WellPressure(well),
            FlowDrive::Rate(_) => Nodal::WellRate(well),
        });
    }
    let weights = weights(mesh, entry.place, nodes, conductance);
    let whole: f64 = weights.iter().map(|(_, weight)| weight).sum();
    if weights.is_empty() || whole <= 0.0 {
        return Err(meets_nothing());
    }
    Ok(match entry.drive {
        FlowDrive::Pressure(_) => Nodal::Given(weights.into_iter().map(|(row, _)| row).collect()),
        FlowDrive::Rate(_) => {
            let shares = weights.into_iter();
            Nodal::Shared(shares.map(|(row, weight)| (row, weight / whole)).collect())
        }
    })
}

/// Rows of a place, ascending, and by how much each counts: by transmissivity times length or area.
fn weights(
    mesh: &Mesh,
    place: FlowPlace,
    nodes: &FlowNodes,
    conductance: &Conductance,
) -> Vec<(usize, f64)> {
    let mut parts: Vec<(usize, f64)> = Vec::new();
    match place {
        FlowPlace::Boundary(boundary) => {
            for edge in edges::on(mesh, nodes, &mesh.boundaries[boundary]) {
                let weight = 0.5 * conductance.transmissivity[edge.facet] * edge.length;
                parts.extend(edge.ends.map(|row| (row, weight)));
            }
        }
        FlowPlace::Fracture(fracture) => {
            let own = |facet: u32| mesh.facets.fracture[facet as usize] as usize == fracture;
            let facets = nodes.facets.iter().enumerate();
            for (index, _) in facets.filter(|(_, facet)| own(**facet)) {
                let corners = nodes.corners.of(index);
                let weight = conductance.transmissivity[index] * conductance.stencils[index].area()
                    / corners.len() as f64;
                parts.extend(corners.iter().map(|&row| (row as usize, weight)));
            }
        }
        FlowPlace::Well { .. } => {}
    }
    // Stable, so that a row adds up in the order of the facets.
    parts.sort_by_key(|(row, _)| *row);
    let runs = parts.chunk_by(|a, b| a.0 == b.0);
    runs.map(|run| (run[0].0, run.iter().map(|(_, weight)| weight).sum()))
        .collect()
}

/// Nodes where two conditions give pressures that differ.
fn contradictions(
    mesh: &Mesh,
    flow: &Flow,
    nodes: &FlowNodes,
    found: &[NodalCondition],
) -> Vec<Defect> {
    let mut giver: Vec<Option<usize>> = vec![None; nodes.len()];
    let mut defects = Vec::new();
    let mut told = Vec::new();
    for NodalCondition { condition, nodal } in found {
        let Nodal::Given(rows) = nodal else {
            continue;
        };
        for &row in rows {
            let Some(first) = giver[row] else {
                giver[row] = Some(*condition);
                continue;
            };
            let x = mesh.nodes[nodes.node[row] as usize];
            let [a, b] = [first, *condition].map(|index| &flow.conditions[index]);
            let pressures = [a, b].map(|entry| profile(entry).at_elevation(x.z));
            let agree = pressures[0] == pressures[1] && (a.case == b.case || pressures[0] == 0.0);
            if agree || told.contains(&(first, *condition)) {
                continue;
            }
            told.push((first, *condition));
            defects.push(Defect::new(
                &b.name,
                format!(
                    "at ({:.6}, {:.6}, {:.6}), where it meets {}, it gives {} Pa and that one {} Pa",
                    x.x, x.y, x.z, a.name, pressures[1], pressures[0]
                ),
                "let pressures and histories agree where both act, or give one of them only",
            ));
        }
    }
    defects
}

/// The pressure that a condition gives; 0 for a rate.
pub(super) fn profile(entry: &FlowCondition) -> Profile {
    match entry.drive {
        FlowDrive::Pressure(profile) => profile,
        FlowDrive::Rate(_) => Profile::default(),
    }
}

/// The rate that a condition drives under a load (m^3/s); 0 if it gives a pressure.
pub(super) fn rate(entry: &FlowCondition, load: &Load) -> f64 {
    match entry.drive {
        FlowDrive::Pressure(_) => 0.0,
        FlowDrive::Rate(rate) => load.factor(entry.case) * rate,
    }
}
