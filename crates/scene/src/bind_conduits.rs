//! How the fractures of a mesh conduct.

use std::collections::BTreeSet;

use glam::DVec3;
use kluft_mesh::{Defect, Mesh};
use kluft_solver::Conduit;

use crate::cases::Bound;
use crate::conduit::HydraulicParameter;
use crate::field::FieldEntry;
use crate::history::{Timetable, moments};
use crate::look::Look;
use crate::scene::Scene;

/// How fractures conduct, and facets, if that varies in any.
pub(crate) struct Conduits {
    pub(crate) of_fractures: Vec<Conduit>,
    pub(crate) of_facets: Vec<Conduit>,
}

impl Conduits {
    /// Those of a mesh: facets have the values in their middle, fractures the mean.
    ///
    /// # Errors
    /// Values that are out of their range, or that a table or samples do not reach, and a fluid
    /// that no fracture conducts; `place` is where the scene speaks of it.
    pub(crate) fn of(
        scene: &Scene,
        mesh: &Mesh,
        (bound, place): (&Bound<'_>, &str),
        decisions: &mut Vec<String>,
    ) -> Result<Self, Vec<Defect>> {
        let mut look = Look::of(scene, decisions);
        let conduits = Self::looked_at(mesh, bound, &mut look);
        look_at_pressures(mesh, bound, &mut look);
        look_at_times(bound, &mut look);
        let mut defects = look.defects;
        let is_sealed = |conduit: &Conduit| *conduit == Conduit::Sealed;
        if conduits.of_fractures.iter().all(is_sealed) {
            defects.push(Defect::new(
                place,
                "there is a fluid, but no fracture that conducts it",
                "add a [fracture.NAME] that is not sealed, or remove [fluid]",
            ));
        }
        match defects.is_empty() {
            true => Ok(conduits),
            false => Err(defects),
        }
    }

    fn looked_at(mesh: &Mesh, bound: &Bound<'_>, look: &mut Look<'_>) -> Self {
        let fractures = bound.fractures.iter();
        let of_fractures = fractures.map(|entry| entry.value.conduit.unwrap_or(Conduit::Sealed));
        let mut conduits = Self {
            of_fractures: of_fractures.collect(),
            of_facets: Vec::new(),
        };
        let mut fractures = bound.fractures.iter();
        if fractures.all(|entry| entry.value.hydraulic_fields.is_empty()) {
            return conduits;
        }
        let numbers = mesh.facets.fracture.iter();
        let of_facets = numbers.map(|&number| conduits.of_fractures[number as usize]);
        conduits.of_facets = of_facets.collect();
        for (index, entry) in bound.fractures.iter().enumerate() {
            for (parameter, field) in &entry.value.hydraulic_fields {
                conduits.vary(mesh, index, (*parameter, field), look);
            }
        }
        conduits
    }

    fn vary(
        &mut self,
        mesh: &Mesh,
        fracture: usize,
        (parameter, entry): (HydraulicParameter, &FieldEntry),
        look: &mut Look<'_>,
    ) {
        let own: Vec<usize> = mesh.facets.of_fracture(fracture).collect();
        let middle = |&facet: &usize| {
            let corners = mesh.corners(&mesh.facets.elements, facet);
            corners.iter().sum::<DVec3>() / corners.len() as f64
        };
        let places: Vec<DVec3> = own.iter().map(middle).collect();
        let Some(seen) = look.at(entry, &places, &[0.0]) else {
            return;
        };
        let set = |conduit: &mut Conduit, value: f64| {
            if let Conduit::Open(hydraulic) = conduit {
                parameter.set(hydraulic, value);
            }
        };
        set(&mut self.of_fractures[fracture], seen.mean);
        for (&facet, &place) in own.iter().zip(&places) {
            set(&mut self.of_facets[facet], entry.field.at(place, 0.0));
        }
    }
}

/// Looks at what drives the fluid and is the same everywhere, at the beginning and at the ends of
/// the load steps.
fn look_at_times(bound: &Bound<'_>, look: &mut Look<'_>) {
    let ends = match &look.scene.timetable {
        Timetable::Times { ends, .. } => &ends[..],
        Timetable::Factors(_) => &[],
    };
    let times: Vec<f64> = moments(ends).collect();
    let sources = bound.sources.iter().map(|entry| &entry.value.drive);
    let boundaries = bound.boundaries.iter();
    let boundaries = boundaries.filter_map(|entry| entry.value.fluid.as_ref());
    let fractures = bound.fractures.iter();
    let fractures = fractures.filter_map(|entry| entry.value.given_pressure.as_ref());
    for drive in sources.chain(boundaries).chain(fractures) {
        let rate = drive
            .field
            .as_deref()
            .filter(|_| !drive.drive.is_pressure());
        if let Some(entry) = drive.in_time().or(rate) {
            look.at(entry, &[DVec3::ZERO], &times);
        }
    }
}

/// Looks at pressures and leak-off of the fluid that vary, at the nodes where they may act.
fn look_at_pressures(mesh: &Mesh, bound: &Bound<'_>, look: &mut Look<'_>) {
    let initial = look.scene.fluid.as_ref();
    if let Some(field) = initial.and_then(|fluid| fluid.value.initial_pressure.field.as_ref()) {
        let nodes = mesh.facets.elements.nodes.iter();
        look.at(field, &places(mesh, nodes.copied()), &[0.0]);
    }
    let mut is_fractured = vec![false; mesh.nodes.len()];
    for &node in &mesh.facets.elements.nodes {
        is_fractured[node as usize] = true;
    }
    for (index, entry) in bound.fractures.iter().enumerate() {
        let leakoff = entry.value.leakoff.as_ref();
        let leakoff = leakoff.and_then(|own| own.field.as_deref());
        let given = entry.value.given_pressure.as_ref();
        let given = given.and_then(|own| own.in_space());
        for field in given.into_iter().chain(leakoff) {
            let nodes = nodes_of_fracture(mesh, index);
            look.at(field, &places(mesh, nodes), &[0.0]);
        }
    }
    for entry in &bound.boundaries {
        let drive = entry.value.fluid.as_ref();
        let Some(field) = drive.and_then(|own| own.in_space()) else {
            continue;
        };
        let boundary = mesh.boundaries.iter().find(|own| own.name == entry.name);
        let nodes = boundary.iter().flat_map(|own| &own.elements.nodes);
        let nodes = nodes.filter(|&&node| is_fractured[node as usize]);
        let places = places(mesh, nodes.copied());
        if !places.is_empty() {
            look.at(field, &places, &[0.0]);
        }
    }
}

/// The nodes of a fracture, as often as its facets have them.
pub(crate) fn nodes_of_fracture(mesh: &Mesh, fracture: usize) -> impl Iterator<Item = u32> {
    let own = mesh.facets.of_fracture(fracture);
    let nodes = own.flat_map(|facet| mesh.facets.elements.nodes_of(facet));
    nodes.copied()
}

/// Where nodes are (m), each once.
pub(crate) fn places(mesh: &Mesh, nodes: impl Iterator<Item = u32>) -> Vec<DVec3> {
    let nodes: BTreeSet<u32> = nodes.collect();
    let places = nodes.into_iter().map(|node| mesh.nodes[node as usize]);
    places.collect()
}
