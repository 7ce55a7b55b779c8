//! Gives displacements that vary to what supports of a problem hold.

use glam::DVec3;
use kluft_mesh::Mesh;
use kluft_solver::{HeldPart, Problem, VaryingDisplacement};

use crate::cases::Bound;
use crate::field::FieldEntry;
use crate::history::LoadHistory;
use crate::look::Look;
use crate::timed_cases::cases;

/// What a section of the scene holds.
struct Held<'a> {
    part: HeldPart,
    /// Its load case, which a time in the values takes the place of.
    case: usize,
    /// Its nodes (m).
    places: Vec<DVec3>,
    /// Its components that vary, by axis.
    fields: &'a [(usize, FieldEntry)],
    history: &'a Option<LoadHistory>,
}

/// Gives a problem the displacements that vary on parts of its surface and at its held nodes.
pub(crate) fn bind_displacements(problem: &mut Problem, bound: &Bound<'_>, look: &mut Look<'_>) {
    for (index, entry) in bound.boundaries.iter().enumerate() {
        let fields = &entry.value.displacement_fields[..];
        if fields.is_empty() {
            continue;
        }
        let held = Held {
            part: HeldPart::Condition(index),
            case: problem.schedule.cases.of_condition(index),
            places: nodes_of_boundary(&problem.mesh, problem.conditions[index].boundary),
            fields,
            history: &entry.value.history,
        };
        bind_held(problem, &held, look);
    }
    for (index, entry) in bound.fixed_points.iter().enumerate() {
        let node = problem.fixed_points[index].node;
        let held = Held {
            part: HeldPart::FixedPoint(index),
            case: problem.schedule.cases.of_fixed_point(index),
            places: vec![problem.mesh.nodes[node as usize]],
            fields: &entry.value.fields,
            history: &entry.value.history,
        };
        bind_held(problem, &held, look);
    }
}

fn bind_held(problem: &mut Problem, held: &Held<'_>, look: &mut Look<'_>) {
    for (axis, entry) in held.fields {
        let in_time = (entry.field.depends_on_time(), held.case);
        let Some(cases) = cases(problem, in_time, held.history, look, &entry.place) else {
            continue;
        };
        let times: Vec<f64> = cases.iter().map(|(time, _)| *time).collect();
        look.at(entry, &held.places, &times);
        let of_case = |(time, case)| VaryingDisplacement {
            held: held.part,
            axis: *axis,
            field: entry.field.clone(),
            time,
            case,
        };
        let own = cases.into_iter().map(of_case);
        problem.varying.displacements.extend(own);
    }
}

/// Positions (m) of the nodes of a part of the outer surface, each once; in a mesh of the plane
/// those that move, without their copies.
fn nodes_of_boundary(mesh: &Mesh, boundary: usize) -> Vec<DVec3> {
    let nodes = mesh.boundaries[boundary].elements.nodes.iter();
    let mut moving: Vec<u32> = nodes.map(|&node| mesh.layer_below(node)).collect();
    moving.sort_unstable();
    moving.dedup();
    let places = moving.into_iter().map(|node| mesh.nodes[node as usize]);
    places.collect()
}
