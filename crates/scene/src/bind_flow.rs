//! Where what a scene says of a fluid meets a mesh.

use std::collections::BTreeSet;

use kluft_keys::section_head;
use kluft_mesh::{Defect, Mesh};
use kluft_solver::{Cases, Conduit, Flow, FlowCondition, FlowDrive, FlowPlace, Profile};

use crate::cases::Bound;
use crate::fluid::SourceEntry;
use crate::scene::{Named, Scene};

/// A borehole further from its node than this share of the edges there is told.
const BESIDE: f64 = 1e-6;

/// The flow of a scene, if it has a fluid; what the user should know of it goes to `decisions`.
///
/// # Errors
/// A fluid that no fracture conducts, and boreholes that hit no fracture.
pub(crate) fn bind_flow(
    scene: &Scene,
    mesh: &Mesh,
    bound: &Bound<'_>,
    cases: &Cases,
    decisions: &mut Vec<String>,
) -> Result<Option<Flow>, Vec<Defect>> {
    let Some(fluid) = &scene.fluid else {
        return Ok(None);
    };
    let conduits = bound.fractures.iter();
    let conduits: Vec<Conduit> = conduits
        .map(|entry| entry.value.conduit.unwrap_or(Conduit::Sealed))
        .collect();
    if conduits.iter().all(|conduit| *conduit == Conduit::Sealed) {
        return Err(vec![Defect::new(
            &fluid.place,
            "there is a fluid, but no fracture that conducts it",
            "add a [fracture.NAME] that is not sealed, or remove [fluid]",
        )]);
    }
    let mut conditions = on_boundaries(mesh, bound, cases);
    conditions.extend(in_fractures(mesh, bound, cases));
    let mut defects = Vec::new();
    for (index, entry) in bound.sources.iter().enumerate() {
        match well(mesh, &conduits, entry, decisions) {
            Ok(place) => conditions.push(FlowCondition {
                name: entry.name.clone(),
                place,
                drive: entry.value.drive,
                case: cases.of_source(index),
            }),
            Err(defect) => defects.push(defect),
        }
    }
    if !defects.is_empty() {
        return Err(defects);
    }
    decisions.extend(decided(scene));
    Ok(Some(Flow {
        fluid: fluid.value,
        conduits,
        inactive: Vec::new(),
        conditions,
        gravity: scene.body.gravity,
        gravity_case: cases.gravity,
    }))
}

fn on_boundaries(mesh: &Mesh, bound: &Bound<'_>, cases: &Cases) -> Vec<FlowCondition> {
    let entries = bound.boundaries.iter().enumerate();
    let conditions = entries.filter_map(|(index, entry)| {
        let boundary = mesh.boundaries.iter().position(|b| b.name == entry.name)?;
        Some(FlowCondition {
            name: section_head("boundary", &entry.name),
            place: FlowPlace::Boundary(boundary),
            drive: entry.value.fluid?,
            case: cases.of_condition(index),
        })
    });
    conditions.collect()
}

/// Pressures that are given all over a fracture.
fn in_fractures(mesh: &Mesh, bound: &Bound<'_>, cases: &Cases) -> Vec<FlowCondition> {
    let entries = bound.fractures.iter().zip(&mesh.fractures).enumerate();
    let conditions = entries.filter_map(|(index, (entry, name))| {
        let pressure = entry.value.given_pressure?;
        Some(FlowCondition {
            name: section_head("fracture", name),
            place: FlowPlace::Fracture(index),
            drive: FlowDrive::Pressure(Profile {
                value: pressure,
                ..Profile::default()
            }),
            case: cases.of_fracture(index),
        })
    });
    conditions.collect()
}

/// The node of a borehole.
fn well(
    mesh: &Mesh,
    conduits: &[Conduit],
    entry: &Named<SourceEntry>,
    decisions: &mut Vec<String>,
) -> Result<FlowPlace, Defect> {
    let at = entry.value.at;
    let facets = &mesh.facets;
    let conducts = |facet: &usize| conduits[facets.fracture[*facet] as usize] != Conduit::Sealed;
    let all = (0..facets.elements.len()).filter(conducts);
    let corners = |facet: usize| {
        let count = facets.elements.shapes[facet].corner_count();
        &facets.elements.nodes_of(facet)[..count]
    };
    let nodes: BTreeSet<u32> = all.clone().flat_map(corners).copied().collect();
    let distance = |node: u32| mesh.nodes[node as usize].distance(at);
    let nearest = nodes.into_iter();
    let nearest = nearest.min_by(|a, b| distance(*a).total_cmp(&distance(*b)));
    let Some(node) = nearest else {
        return Err(Defect::new(&entry.place, "it hits no fracture", "add one"));
    };
    let around = all.filter(|facet| corners(*facet).contains(&node));
    let edges = around
        .flat_map(corners)
        .map(|&other| mesh.edge_length([node, other]));
    let longest = edges.fold(0.0, f64::max);
    let (x, tag) = (mesh.nodes[node as usize], mesh.node_tags[node as usize]);
    let found = format!("node {tag} at ({:.6}, {:.6}, {:.6})", x.x, x.y, x.z);
    let wanted = format!("({}, {}, {})", at.x, at.y, at.z);
    if distance(node) > longest {
        return Err(Defect::new(
            &entry.place,
            format!("the borehole at {wanted} hits no fracture that conducts"),
            format!("the nearest such is {found}"),
        ));
    }
    if distance(node) > BESIDE * longest {
        let name = &entry.name;
        decisions.push(format!(
            "{name}: no node of a fracture at {wanted}; {found} is taken instead"
        ));
    }
    Ok(FlowPlace::Well {
        node,
        radius: entry.value.radius,
    })
}

/// How much model the flow needs.
fn decided(scene: &Scene) -> Vec<String> {
    let how = match scene.is_rigid() {
        true => "no young_modulus: the rock is rigid, flow alone in fractures of constant aperture",
        false => {
            "hydraulic apertures are constant: the flow is solved first, and its pressure pushes \
             the walls apart"
        }
    };
    let steady = "the flow is steady at the end of every load step: no fluid is stored";
    vec![how.to_owned(), steady.to_owned()]
}
