//! Orientation of fractures: which of the two cells at a facet is on the plus side.

use glam::DVec3;
use rayon::prelude::*;

use crate::adjacency::{Adjacency, NONE};
use crate::draft::Draft;
use crate::geometry::{facet_area_vector, facet_centre};
use crate::pairing::{KeyedFace, bounds, visit_runs};
use crate::surfaces::{DraftFacet, Surfaces};
use kluft_defect::Defect;

/// The facet on the other side of an edge, or [`NONE`], and whether the first faces of both run
/// along it the same way.
type Link = (u32, bool);

/// The links of a facet, in ascending order of the edges' nodes.
type Links = [Link; 4];

/// Returns `(minus face, plus face)` of every facet. Facets of one fracture that share an edge
/// with no third facet of that fracture agree. Each connected surface then points upwards (z, else
/// y, else x), or outwards where it is closed, whatever the numbering.
pub(crate) fn fractures(
    draft: &Draft,
    nodes: &[DVec3],
    adjacency: &Adjacency,
    surfaces: &Surfaces,
) -> (Vec<(u32, u32)>, Vec<Defect>) {
    let faces = surfaces.facets.par_iter().map(|facet| facet.faces[0]);
    let rings: Vec<Ring> = faces.map(|face| Ring::of(draft, adjacency, face)).collect();
    let links = links(surfaces, &rings, nodes.len());
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
        let areas = surface.par_iter().map(|&facet| {
            let (centre, area) = rings[facet as usize].centre_and_area(nodes);
            let flip = flipped[facet as usize] == Some(true);
            (centre, if flip { -area } else { area })
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

/// The corners of a facet as its first face runs round them, and how many they are.
#[derive(Clone, Copy)]
struct Ring {
    corners: [u32; 4],
    count: usize,
}

impl Ring {
    fn of(draft: &Draft, adjacency: &Adjacency, face: u32) -> Self {
        let cells = &draft.cells.elements;
        let mut corners = [NONE; 4];
        let count = adjacency.shape_of(cells, face).corners().len();
        let slots = adjacency.slots(cells, face).take(count);
        for (corner, slot) in corners.iter_mut().zip(slots) {
            *corner = cells.nodes[slot];
        }
        Self { corners, count }
    }

    fn centre_and_area(&self, nodes: &[DVec3]) -> (DVec3, DVec3) {
        let points = self.corners.map(|node| nodes.get(node as usize));
        let points = points.map(|point| point.copied().unwrap_or_default());
        let points = &points[..self.count];
        (facet_centre(points), facet_area_vector(points))
    }

    /// Lower and higher node of each edge, ascending, and whether the ring runs from the lower to
    /// the higher; [`NONE`] behind.
    fn edges(&self) -> [(u32, u32, bool); 4] {
        let mut edges = [(NONE, NONE, false); 4];
        for (place, edge) in edges[..self.count].iter_mut().enumerate() {
            let (from, to) = (self.corners[place], self.corners[(place + 1) % self.count]);
            *edge = (from.min(to), from.max(to), from < to);
        }
        edges.sort_unstable();
        edges
    }
}

/// For every facet its neighbours across edges where exactly two facets of the fracture meet.
fn links(surfaces: &Surfaces, rings: &[Ring], node_count: usize) -> Vec<Links> {
    let emit = |facet: usize, entries: &mut Vec<KeyedFace>| {
        let fracture = surfaces.facets[facet].fracture;
        let edges = rings[facet].edges();
        for (place, &(low, high, forward)) in edges[..rings[facet].count].iter().enumerate() {
            let facet = facet as u32;
            let edge = Edge {
                facet,
                place,
                forward,
            };
            entries.push(KeyedFace {
                // No node has a number as high as that.
                key: [low, high, NONE - fracture],
                item: edge.pack(),
            });
        }
    };
    let key_range = |facet: usize| {
        let corners = &rings[facet].corners[..rings[facet].count];
        bounds(corners)
    };
    let visit = |pairs: &mut Vec<[Edge; 2]>, run: &[KeyedFace]| {
        if let [a, b] = run {
            pairs.push([a, b].map(|entry| Edge::unpack(entry.item)));
        }
    };
    let mut links = vec![[(NONE, false); 4]; surfaces.facets.len()];
    for [a, b] in visit_runs(surfaces.facets.len(), node_count, key_range, emit, visit)
        .into_iter()
        .flatten()
    {
        let alike = a.forward == b.forward;
        links[a.facet as usize][a.place] = (b.facet, alike);
        links[b.facet as usize][b.place] = (a.facet, alike);
    }
    links
}

/// An edge of a facet.
struct Edge {
    facet: u32,
    /// Its place among the edges of the facet.
    place: usize,
    /// Whether the facet's first face runs from its lower node to its higher.
    forward: bool,
}

impl Edge {
    fn pack(&self) -> u32 {
        self.facet << 3 | (self.place as u32) << 1 | u32::from(self.forward)
    }

    fn unpack(item: u32) -> Self {
        Self {
            facet: item >> 3,
            place: (item >> 1 & 3) as usize,
            forward: item & 1 == 1,
        }
    }
}

/// Orients everything that hangs together with `seed`; false if the surface has only one side.
fn spread(seed: u32, links: &[Links], flipped: &mut [Option<bool>]) -> (Vec<u32>, bool) {
    flipped[seed as usize] = Some(false);
    let mut surface = vec![seed];
    let mut consistent = true;
    let mut next = 0;
    while next < surface.len() {
        let facet = surface[next] as usize;
        next += 1;
        for &(other, alike) in links[facet].iter().filter(|link| link.0 != NONE) {
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
