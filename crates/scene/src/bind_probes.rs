//! Finds what probes hit.

use glam::DVec3;
use kluft_keys::section_head;
use kluft_mesh::{Defect, Elements, Mesh, nearest};
use kluft_solver::{InCell, locate};
use lie_core::load_areas;

use crate::probe::{ProbeEntry, ProbedPart};
use crate::scene::{Named, Scene};
use crate::words::counted;

/// A probe on a mesh.
#[derive(Debug, Clone)]
pub struct Probe {
    /// Its name.
    pub name: String,
    /// Its points.
    pub points: Vec<ProbePoint>,
    /// Whether their mean is written.
    pub mean: bool,
}

/// A point of a probe.
#[derive(Debug, Clone)]
pub struct ProbePoint {
    /// Where the values are taken (m).
    pub position: DVec3,
    /// What it hits.
    pub hit: Hit,
}

/// What a point of a probe hits.
#[derive(Debug, Clone)]
pub enum Hit {
    /// A cell.
    Rock(InCell),
    /// A node of a facet: its index in the flat node list of the facets.
    Fracture(usize),
    /// All of a fracture, by its number.
    WholeFracture(usize),
    /// All of a part of the outer surface, by its number.
    WholeBoundary(usize),
    /// Nothing that is there now.
    Nothing,
}

/// The probes of a scene on a mesh; what they hit goes to `decisions`.
///
/// # Errors
/// Fractures that the mesh has not, and points outside the rock or away from their fracture.
pub(crate) fn bind_probes(
    scene: &Scene,
    mesh: &Mesh,
    decisions: &mut Vec<String>,
) -> Result<Vec<Probe>, Vec<Defect>> {
    let mut defects = Vec::new();
    let mut probes = Vec::new();
    if scene.has_stages() {
        return Ok(scene
            .probes
            .iter()
            .map(|entry| as_far_as_there(mesh, entry))
            .collect());
    }
    for entry in &scene.probes {
        match hits(mesh, entry, decisions) {
            Ok(points) => probes.push(Probe {
                name: entry.name.clone(),
                points,
                mean: entry.value.mean,
            }),
            Err(defect) => defects.push(defect),
        }
    }
    match defects.is_empty() {
        true => Ok(probes),
        false => Err(defects),
    }
}

/// A probe on a mesh that other phases have other volumes of: what it misses now has no values.
fn as_far_as_there(mesh: &Mesh, entry: &Named<ProbeEntry>) -> Probe {
    let absent = |position: DVec3| ProbePoint {
        position,
        hit: Hit::Nothing,
    };
    let point = |&position: &DVec3| {
        let single = Named {
            value: ProbeEntry {
                points: vec![position],
                ..entry.value.clone()
            },
            ..entry.clone()
        };
        let found = hits(mesh, &single, &mut Vec::new()).ok();
        let found = found.and_then(|mut points| points.pop());
        found.unwrap_or_else(|| absent(position))
    };
    let points = match entry.value.points.is_empty() {
        // Where it is without any area, nobody knows.
        true => hits(mesh, entry, &mut Vec::new()).unwrap_or_else(|_| vec![absent(DVec3::NAN)]),
        false => entry.value.points.iter().map(point).collect(),
    };
    Probe {
        name: entry.name.clone(),
        points,
        mean: entry.value.mean,
    }
}

/// Defects of probes on a mesh that has the volumes of all phases.
pub(crate) fn probe_defects(scene: &Scene, mesh: &Mesh) -> Vec<Defect> {
    let probes = scene.probes.iter();
    probes
        // Walls of what is cut later are not there yet; their names have been looked up.
        .filter(|entry| entry.value.boundary().is_none())
        .filter_map(|entry| hits(mesh, entry, &mut Vec::new()).err())
        .collect()
}

/// What the points of a probe hit.
fn hits(
    mesh: &Mesh,
    entry: &Named<ProbeEntry>,
    decisions: &mut Vec<String>,
) -> Result<Vec<ProbePoint>, Defect> {
    match &entry.value.part {
        ProbedPart::Rock => in_rock(mesh, entry, decisions),
        ProbedPart::Boundary(name) => over_boundary(mesh, entry, name, decisions),
        ProbedPart::Fracture(name) => on_fracture(mesh, entry, name, decisions),
    }
}

fn in_rock(
    mesh: &Mesh,
    entry: &Named<ProbeEntry>,
    decisions: &mut Vec<String>,
) -> Result<Vec<ProbePoint>, Defect> {
    let places = &entry.value.points;
    let found = locate(mesh, places);
    let outside: Vec<DVec3> = std::iter::zip(places, &found)
        .filter(|(_, found)| found.is_none())
        .map(|(place, _)| *place)
        .collect();
    if let Some(first) = outside.first() {
        return Err(away(entry, *first, outside.len(), "outside the rock"));
    }
    decisions.push(format!(
        "{}: {} in the rock",
        section_head("probe", &entry.name),
        counted(places.len(), "point")
    ));
    let points = places.iter().zip(found);
    let points = points.filter_map(|(&position, found)| {
        let hit = Hit::Rock(found?);
        Some(ProbePoint { position, hit })
    });
    Ok(points.collect())
}

fn away(entry: &Named<ProbeEntry>, first: DVec3, count: usize, what: &str) -> Defect {
    let others = match count {
        1 => String::new(),
        count => format!(", and {} more points", count - 1),
    };
    let [x, y, z] = first.to_array();
    let problem = format!("({x:.6}, {y:.6}, {z:.6}) is {what}{others}");
    Defect::new(&entry.place, problem, "move the probe, or make it shorter")
}

fn over_boundary(
    mesh: &Mesh,
    entry: &Named<ProbeEntry>,
    name: &str,
    decisions: &mut Vec<String>,
) -> Result<Vec<ProbePoint>, Defect> {
    let mut all = mesh.boundaries.iter();
    let Some(index) = all.position(|boundary| boundary.name == name) else {
        let known = mesh.boundaries.iter().map(|own| own.name.as_str());
        let known: Vec<&str> = known.collect();
        let problem = format!("`{name}` is no part of the outer surface");
        let remedy = format!("parts that have names: {}", known.join(", "));
        return Err(Defect::new(&entry.place, problem, remedy));
    };
    let elements = &mesh.boundaries[index].elements;
    let facets: Vec<usize> = (0..elements.len()).collect();
    let hit = Hit::WholeBoundary(index);
    whole(mesh, (elements, &facets), (entry, name, hit), decisions)
}

/// The one point of a probe that is on facets as a whole: their centre.
fn whole(
    mesh: &Mesh,
    (elements, facets): (&Elements, &[usize]),
    (entry, name, hit): (&Named<ProbeEntry>, &str, Hit),
    decisions: &mut Vec<String>,
) -> Result<Vec<ProbePoint>, Defect> {
    let (mut area, mut moment) = (0.0, DVec3::ZERO);
    for &facet in facets {
        let nodes = elements.nodes_of(facet).iter();
        let places: Vec<DVec3> = nodes.map(|&node| mesh.nodes[node as usize]).collect();
        let sizes = load_areas(elements.shapes[facet], &places);
        for (place, (size, _)) in places.iter().zip(sizes) {
            area += size;
            moment += size * *place;
        }
    }
    if area == 0.0 {
        let problem = format!("`{name}` has no area");
        return Err(Defect::new(&entry.place, problem, "remove the probe"));
    }
    decisions.push(format!(
        "{}: mean over {area:.6e} m2 of `{name}`, {}",
        section_head("probe", &entry.name),
        counted(facets.len(), "facet")
    ));
    let position = moment / area;
    Ok(vec![ProbePoint { position, hit }])
}

/// The fracture of a name.
fn fracture_called(mesh: &Mesh, entry: &Named<ProbeEntry>, name: &str) -> Result<usize, Defect> {
    let found = mesh.fractures.iter().position(|own| own == name);
    found.ok_or_else(|| {
        let known = mesh.fractures.iter().map(String::as_str);
        let remedy = match nearest(name, known) {
            Some(near) => format!("did you mean `{near}`?"),
            None => format!("fractures of the mesh: {}", mesh.fractures.join(", ")),
        };
        let problem = format!("`{name}` is no fracture of the mesh");
        Defect::new(&entry.place, problem, remedy)
    })
}

fn on_fracture(
    mesh: &Mesh,
    entry: &Named<ProbeEntry>,
    fracture: &str,
    decisions: &mut Vec<String>,
) -> Result<Vec<ProbePoint>, Defect> {
    let index = fracture_called(mesh, entry, fracture)?;
    let elements = &mesh.facets.elements;
    let own = mesh.facets.of_fracture(index);
    if entry.value.points.is_empty() {
        let hit = Hit::WholeFracture(index);
        let own: Vec<usize> = own.collect();
        return whole(mesh, (elements, &own), (entry, fracture, hit), decisions);
    }
    let nodes: Vec<usize> = own.flat_map(|facet| elements.range(facet)).collect();
    let position = |slot: usize| mesh.nodes[elements.nodes[slot] as usize];
    let mut farthest = 0.0_f64;
    let mut beside = Vec::new();
    let mut points = Vec::new();
    for &at in &entry.value.points {
        let distance = |slot: &usize| position(*slot).distance_squared(at);
        let found = nodes
            .iter()
            .min_by(|a, b| distance(a).total_cmp(&distance(b)));
        let Some(&slot) = found else {
            continue;
        };
        let reach = position(slot).distance(at);
        farthest = farthest.max(reach);
        if reach > longest_edge(mesh, slot) {
            beside.push(at);
        }
        points.push(ProbePoint {
            position: position(slot),
            hit: Hit::Fracture(slot),
        });
    }
    if let Some(first) = beside.first() {
        let what = format!("farther from `{fracture}` than its facets are long");
        return Err(away(entry, *first, beside.len(), &what));
    }
    decisions.push(format!(
        "{}: {} of `{fracture}`, at most {farthest:.3e} m from where it was asked for",
        section_head("probe", &entry.name),
        counted(points.len(), "node")
    ));
    Ok(points)
}

/// The longest edge of the facet that a node of the flat list belongs to (m).
fn longest_edge(mesh: &Mesh, slot: usize) -> f64 {
    let elements = &mesh.facets.elements;
    let facet = elements
        .offsets
        .partition_point(|&start| start as usize <= slot)
        - 1;
    let corners = mesh.corners(elements, facet);
    let ends = corners.iter().cycle().skip(1);
    let edges = corners.iter().zip(ends).map(|(a, b)| a.distance(*b));
    edges.fold(0.0, f64::max)
}
