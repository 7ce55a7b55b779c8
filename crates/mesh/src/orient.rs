//! Orientation of fractures: which of the two cells at a facet is on the plus side.

use glam::DVec3;

use crate::adjacency::Adjacency;
use crate::check::{DraftFacet, Surfaces};
use crate::defect::Defect;
use crate::draft::Draft;
use crate::geometry::{facet_area_vector, facet_centre};

/// An edge of a facet, as its first face runs along it.
struct Edge {
    key: (u32, u32, u32),
    facet: u32,
    forward: bool,
}

/// Facets that share an edge, and whether their first faces run along it the same way.
type Link = (u32, bool);

/// Returns `(minus face, plus face)` of every facet. Facets of one fracture that share an edge
/// with no third facet of that fracture agree. Each connected surface then points upwards (z, else
/// y, else x), or outwards where it is closed, whatever the numbering.
pub(crate) fn fractures(
    draft: &Draft,
    nodes: &[DVec3],
    adjacency: &Adjacency,
    surfaces: &Surfaces,
) -> (Vec<(u32, u32)>, Vec<Defect>) {
    let links = links(draft, adjacency, surfaces);
    let mut flipped: Vec<Option<bool>> = vec![None; surfaces.facets.len()];
    let mut defects = Vec::new();
    for seed in 0..surfaces.facets.len() {
        if flipped[seed].is_some() {
            continue;
        }
        let (surface, consistent) = spread(seed as u32, &links, &mut flipped);
        if !consistent {
            defects.push(one_sided(draft, surfaces, &surfaces.facets[seed]));
        }
        let areas = surface.iter().map(|&facet| {
            let face = chosen(&surfaces.facets[facet as usize], flipped[facet as usize]).0;
            placed_area(draft, nodes, adjacency, face)
        });
        if points_down(&areas.collect::<Vec<_>>()) {
            for &facet in &surface {
                flipped[facet as usize] = flipped[facet as usize].map(|flip| !flip);
            }
        }
    }
    let pairs = surfaces.facets.iter().zip(&flipped);
    (
        pairs.map(|(facet, &flip)| chosen(facet, flip)).collect(),
        defects,
    )
}

fn chosen(facet: &DraftFacet, flip: Option<bool>) -> (u32, u32) {
    let [a, b] = facet.faces;
    if flip == Some(true) { (b, a) } else { (a, b) }
}

fn placed_area(draft: &Draft, nodes: &[DVec3], adjacency: &Adjacency, face: u32) -> (DVec3, DVec3) {
    let cells = &draft.cells.elements;
    let count = adjacency.shape_of(cells, face).corners().len();
    let slots = adjacency.slots(cells, face).take(count);
    let points: Vec<DVec3> = slots
        .map(|slot| nodes[cells.nodes[slot] as usize])
        .collect();
    (facet_centre(&points), facet_area_vector(&points))
}

/// For every facet its neighbours across edges where exactly two facets of the fracture meet.
fn links(draft: &Draft, adjacency: &Adjacency, surfaces: &Surfaces) -> Vec<Vec<Link>> {
    let cells = &draft.cells.elements;
    let mut edges = Vec::new();
    for (facet, entry) in surfaces.facets.iter().enumerate() {
        let face = entry.faces[0];
        let count = adjacency.shape_of(cells, face).corners().len();
        let slots = adjacency.slots(cells, face).take(count);
        let nodes: Vec<u32> = slots.map(|slot| cells.nodes[slot]).collect();
        for (i, &from) in nodes.iter().enumerate() {
            let to = nodes[(i + 1) % nodes.len()];
            let key = (entry.fracture, from.min(to), from.max(to));
            edges.push(Edge {
                key,
                facet: facet as u32,
                forward: from < to,
            });
        }
    }
    edges.sort_by_key(|edge| (edge.key, edge.facet));
    let mut links = vec![Vec::new(); surfaces.facets.len()];
    for run in edges.chunk_by(|a, b| a.key == b.key) {
        if let [a, b] = run {
            let alike = a.forward == b.forward;
            links[a.facet as usize].push((b.facet, alike));
            links[b.facet as usize].push((a.facet, alike));
        }
    }
    links
}

/// Orients everything that hangs together with `seed`; false if the surface has only one side.
fn spread(seed: u32, links: &[Vec<Link>], flipped: &mut [Option<bool>]) -> (Vec<u32>, bool) {
    flipped[seed as usize] = Some(false);
    let mut surface = vec![seed];
    let mut consistent = true;
    let mut next = 0;
    while next < surface.len() {
        let facet = surface[next] as usize;
        next += 1;
        for &(other, alike) in &links[facet] {
            let wanted = flipped[facet].map(|flip| flip != alike);
            match flipped[other as usize] {
                None => {
                    flipped[other as usize] = wanted;
                    surface.push(other);
                }
                found => consistent &= found == wanted,
            }
        }
    }
    (surface, consistent)
}

/// Whether a surface of these (centre, area vector) points down, or inwards where it is closed.
fn points_down(areas: &[(DVec3, DVec3)]) -> bool {
    // Below this share of the whole area a component of the mean normal is rounding or symmetry.
    const SHARE: f64 = 1e-6;
    let whole: f64 = areas.iter().map(|(_, area)| area.length()).sum();
    let mean: DVec3 = areas.iter().map(|(_, area)| *area).sum();
    let leading = [mean.z, mean.y, mean.x]
        .into_iter()
        .find(|component| component.abs() > SHARE * whole);
    leading.unwrap_or_else(|| areas.iter().map(|(centre, area)| centre.dot(*area)).sum()) < 0.0
}

fn one_sided(draft: &Draft, surfaces: &Surfaces, facet: &DraftFacet) -> Defect {
    let name = &draft.groups[surfaces.fractures[facet.fracture as usize]].name;
    Defect::new(
        format!("fracture `{name}`, the surface around facet {}", facet.tag),
        "the surface has only one side (like a Moebius strip), so plus and minus cannot be told apart",
        "split it into two physical surfaces",
    )
}
