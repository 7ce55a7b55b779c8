//! Where conditions act, whatever the apertures.

use glam::DVec3;
use kluft_mesh::{Defect, Mesh};
use lie_core::FacetFlow;

use super::conductance::Conductance;
use super::edges;
use super::numbering::FlowNodes;
use super::wells::{self, Borehole};
use crate::problem::{Flow, FlowCondition, FlowDrive, FlowPlace, LineShare};

/// Where a condition acts.
#[derive(Debug, Clone)]
pub(super) enum Place {
    /// At rows, ascending, each with the facets through which it counts.
    Rows(Vec<RowShare>),
    /// At a borehole.
    Well(Borehole),
}

/// By how much a facet makes a row count: by its transmissivity times this.
#[derive(Debug, Clone, Copy)]
pub(super) struct RowShare {
    /// The row.
    pub(super) row: usize,
    /// The conducting facet: index into those of the numbering.
    pub(super) facet: usize,
    /// Length (m) along a boundary or a line, or area (m^2) of a fracture.
    pub(super) weight: f64,
}

impl Place {
    /// Whether it is a borehole.
    pub(super) fn is_well(&self) -> bool {
        matches!(self, Self::Well(_))
    }

    /// Its rows, ascending; some more than once.
    pub(super) fn rows(&self) -> impl Iterator<Item = usize> + '_ {
        let (shares, well) = match self {
            Self::Rows(shares) => (&shares[..], None),
            Self::Well(well) => (&[][..], Some(well.row)),
        };
        shares.iter().map(|share| share.row).chain(well)
    }
}

/// Where each condition of a flow acts.
///
/// # Errors
/// Each that meets no conducting fracture, that shares a rate among nothing that conducts, and each
/// node where two give different pressures.
pub(super) fn find(
    (mesh, flow): (&Mesh, &Flow),
    nodes: &FlowNodes,
    stencils: &[FacetFlow],
    conductance: &Conductance,
) -> Result<Vec<Place>, Vec<Defect>> {
    let mut defects = Vec::new();
    let mut found = Vec::new();
    for (condition, entry) in flow.conditions.iter().enumerate() {
        match place((mesh, &flow.lines), entry, nodes, (stencils, conductance)) {
            Ok(place) => found.push((condition, place)),
            Err(defect) => defects.push(defect),
        }
    }
    defects.extend(contradictions((mesh, flow), nodes, &found));
    match defects.is_empty() {
        true => Ok(found.into_iter().map(|(_, place)| place).collect()),
        false => Err(defects),
    }
}

fn place(
    (mesh, lines): (&Mesh, &[Vec<LineShare>]),
    entry: &FlowCondition,
    nodes: &FlowNodes,
    (stencils, conductance): (&[FacetFlow], &Conductance),
) -> Result<Place, Defect> {
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
        return Ok(Place::Well(well));
    }
    let mut shares = match entry.place {
        FlowPlace::Line(line) => along(nodes, &lines[line]),
        place => shares(mesh, place, nodes, stencils),
    };
    let counted = |share: &RowShare| share.weight * conductance.transmissivity[share.facet];
    let is_met = shares.iter().map(counted).sum::<f64>() > 0.0;
    if let FlowDrive::Leakoff(leakoff) = &entry.drive
        && let Some(field) = &leakoff.varying
    {
        for share in &mut shares {
            let node = nodes.node[share.row] as usize;
            share.weight *= field.at(mesh.nodes[node], 0.0);
        }
    }
    match is_met {
        true => Ok(Place::Rows(shares)),
        false => Err(meets_nothing()),
    }
}

/// Rows of a place, ascending; those of one row in the order of the facets.
fn shares(
    mesh: &Mesh,
    place: FlowPlace,
    nodes: &FlowNodes,
    stencils: &[FacetFlow],
) -> Vec<RowShare> {
    let mut parts: Vec<RowShare> = Vec::new();
    match place {
        FlowPlace::Boundary(boundary) => {
            for edge in edges::on(mesh, nodes, &mesh.boundaries[boundary]) {
                parts.extend(edge.ends.map(|row| RowShare {
                    row,
                    facet: edge.facet,
                    weight: 0.5 * edge.length,
                }));
            }
        }
        FlowPlace::Fracture(fracture) => {
            let own = |facet: u32| mesh.facets.fracture[facet as usize] as usize == fracture;
            let facets = nodes.facets.iter().enumerate();
            for (facet, _) in facets.filter(|(_, facet)| own(**facet)) {
                let corners = nodes.corners.of(facet);
                let weight = stencils[facet].area() / corners.len() as f64;
                parts.extend(corners.iter().map(|&row| RowShare {
                    row: row as usize,
                    facet,
                    weight,
                }));
            }
        }
        FlowPlace::Line(_) | FlowPlace::Well { .. } => {}
    }
    // Stable, so that a row adds up in the order of the facets.
    parts.sort_by_key(|share| share.row);
    parts
}

/// Rows of a line, ascending; those of one row in the order of the line.
fn along(nodes: &FlowNodes, line: &[LineShare]) -> Vec<RowShare> {
    let share = |share: &LineShare| {
        Some(RowShare {
            row: nodes.of_node(share.node)?,
            facet: nodes.facets.binary_search(&share.facet).ok()?,
            weight: share.length,
        })
    };
    let mut parts: Vec<RowShare> = line.iter().filter_map(share).collect();
    parts.sort_by_key(|share| share.row);
    parts
}

/// Nodes where two conditions give pressures that differ.
fn contradictions(
    (mesh, flow): (&Mesh, &Flow),
    nodes: &FlowNodes,
    found: &[(usize, Place)],
) -> Vec<Defect> {
    let mut giver: Vec<Option<usize>> = vec![None; nodes.len()];
    let mut defects = Vec::new();
    let mut told = Vec::new();
    for (condition, place) in found {
        let gives = flow.conditions[*condition].drive.is_pressure();
        if !gives || place.is_well() {
            continue;
        }
        for row in place.rows() {
            let Some(first) = giver[row] else {
                giver[row] = Some(*condition);
                continue;
            };
            let x = &mesh.nodes[nodes.node[row] as usize];
            let [a, b] = [first, *condition].map(|index| &flow.conditions[index]);
            let pressures = [a, b].map(|entry| given_pressure(entry, *x));
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

/// The pressure that a condition gives at a position (m) at load factor 1 (Pa); 0 for one that
/// gives none.
pub(super) fn given_pressure(entry: &FlowCondition, position: DVec3) -> f64 {
    match &entry.drive {
        FlowDrive::Pressure(field) => field.at(position, 0.0),
        FlowDrive::Rate(_) | FlowDrive::Leakoff(_) => 0.0,
    }
}
