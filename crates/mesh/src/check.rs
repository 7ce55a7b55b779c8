//! Everything that may be wrong with a mesh.

use std::collections::BTreeMap;

use glam::DVec3;
use rayon::prelude::*;

use crate::adjacency::{Adjacency, NONE};
use crate::defect::{Defect, sample};
use crate::draft::Draft;
use crate::geometry::cell_volume;
use crate::mesh::SurfaceRole;

/// A cell is flat when its volume is this small against the cube of its longest edge: there the
/// sign of the volume is rounding.
const FLAT: f64 = 1e-13;

/// A fracture facet of the draft and the two cell faces it lies between.
pub(crate) struct DraftFacet {
    /// Index into [`Surfaces::fractures`].
    pub(crate) fracture: u32,
    /// The two cell faces, in no particular order.
    pub(crate) faces: [u32; 2],
    /// The number the facet has in the file.
    pub(crate) tag: u64,
}

/// The surfaces of a draft, matched to faces of cells.
pub(crate) struct Surfaces {
    /// Groups that are fractures.
    pub(crate) fractures: Vec<usize>,
    /// Their facets.
    pub(crate) facets: Vec<DraftFacet>,
    /// Groups that are boundaries, with their cell faces.
    pub(crate) boundaries: Vec<(usize, Vec<u32>)>,
    /// How many facets a fracture (first) left to another (second) that holds them too.
    pub(crate) shared: BTreeMap<(u32, u32), usize>,
}

/// What can be wrong, and the remedy.
type Kind = (&'static str, &'static str);

const NOT_FINITE: Kind = (
    "a coordinate is not a finite number",
    "mesh the geometry again; if it stays, look for 0/0 in the .geo expressions",
);
const NO_VOLUME: Kind = (
    "the cell has no volume",
    "let gmsh optimise the mesh (Mesh.Optimize = 1) or remove the sliver from the geometry",
);
const INSIDE_OUT: Kind = (
    "the cell is inside out (negative volume)",
    "write the cell's nodes in gmsh's order, or mesh the geometry again",
);
const CROWDED: Kind = (
    "a face is shared by more than two cells",
    "remove the cells that lie on top of others",
);
const OVERLAPPING: Kind = (
    "the cell overlaps its neighbour or stands in the file twice",
    "remove the copy; volumes must be fragmented against each other (BooleanFragments)",
);
const NOT_EMBEDDED: Kind = (
    "the facet is not a face of any cell: the surface is not embedded in the volume",
    "cut the volume with the surface in the .geo file: BooleanFragments (OpenCASCADE) or Surface{..} In Volume{..}",
);
const ON_THE_OUTSIDE: Kind = (
    "the facet lies on the outer boundary: there is rock on one side only",
    "a fracture must lie inside the rock; take this surface out of the fracture's group",
);
const TWICE: Kind = (
    "the facet stands in the file twice",
    "remove the copy (gmsh: Coherence; or BooleanFragments so that surfaces are shared)",
);
const NOT_ON_THE_ROCK: Kind = (
    "the facet is not a face of any cell",
    "mesh volume and surface together, and put the volume in a Physical Volume",
);
const ON_THE_INSIDE: Kind = (
    "the facet lies inside the rock: there are cells on both sides",
    "conditions act on the outer surface; give a fracture a [fracture] entry instead",
);
const LOADED_TWICE: Kind = (
    "the facet stands in the file twice and would be loaded twice",
    "remove the copy from the file",
);

/// Reports the elements that share one kind of defect.
fn report(defects: &mut Vec<Defect>, place: &str, what: &str, tags: &[u64], kind: Kind) {
    if !tags.is_empty() {
        let place = format!("{place}, {what} {}", sample(tags));
        defects.push(Defect::new(place, kind.0, kind.1));
    }
}

/// Defects of the nodes and cells by themselves.
pub(crate) fn cells(draft: &Draft, nodes: &[DVec3]) -> Vec<Defect> {
    let mut defects = Vec::new();
    let cells = &draft.cells.elements;
    if cells.is_empty() {
        defects.push(Defect::new(
            &draft.source,
            "nothing to solve: the mesh has no cells of dimension 3",
            "give the rock a Physical Volume and mesh it in 3D (gmsh -3)",
        ));
    }
    let tagged = |bad: &dyn Fn(usize) -> bool| -> Vec<u64> {
        let of_bad = (0..cells.len()).filter(|&cell| bad(cell));
        of_bad.map(|cell| draft.cells.tags[cell]).collect()
    };
    let broken: Vec<u64> = (0..nodes.len())
        .filter(|&node| !nodes[node].is_finite())
        .map(|node| draft.node_tags[node])
        .collect();
    report(&mut defects, &draft.source, "node", &broken, NOT_FINITE);
    if !broken.is_empty() {
        return defects;
    }
    let volumes: Vec<f64> = (0..cells.len())
        .into_par_iter()
        .map(|cell| relative_volume(draft, nodes, cell))
        .collect();
    let flat = tagged(&|cell| volumes[cell].abs() <= FLAT);
    report(&mut defects, &draft.source, "cell", &flat, NO_VOLUME);
    let inverted = tagged(&|cell| volumes[cell] < -FLAT);
    report(&mut defects, &draft.source, "cell", &inverted, INSIDE_OUT);
    defects
}

/// Volume over the cube of the longest distance between corners.
fn relative_volume(draft: &Draft, nodes: &[DVec3], cell: usize) -> f64 {
    let cells = &draft.cells.elements;
    let shape = cells.shapes[cell];
    let mut corners = [DVec3::ZERO; 8];
    let corners = &mut corners[..shape.corner_count()];
    for (corner, &node) in corners.iter_mut().zip(cells.nodes_of(cell)) {
        *corner = nodes[node as usize];
    }
    let longest = corners
        .iter()
        .flat_map(|a| corners.iter().map(move |b| a.distance_squared(*b)))
        .fold(0.0, f64::max)
        .sqrt();
    if longest == 0.0 {
        return 0.0;
    }
    cell_volume(shape, corners) / longest.powi(3)
}

/// Defects in how the cells fit together.
pub(crate) fn faces(draft: &Draft, adjacency: &Adjacency) -> Vec<Defect> {
    let mut defects = Vec::new();
    let tag = |cell: u32| draft.cells.tags[cell as usize];
    let crowded: Vec<u64> = adjacency
        .crowded_cells
        .iter()
        .map(|&cell| tag(cell))
        .collect();
    report(&mut defects, &draft.source, "cell", &crowded, CROWDED);
    let mut overlapping: Vec<u64> = (0..adjacency.face_count() as u32)
        .into_par_iter()
        .filter(|&face| {
            let other = adjacency.neighbour[face as usize];
            other != NONE && face < other && runs_alike(draft, adjacency, face, other)
        })
        .map(|face| tag(adjacency.cell_of_face[face as usize]))
        .collect();
    overlapping.dedup();
    report(
        &mut defects,
        &draft.source,
        "cell",
        &overlapping,
        OVERLAPPING,
    );
    defects
}

/// Whether two faces with the same corners run the same way round, so that both cells lie on one
/// side.
fn runs_alike(draft: &Draft, adjacency: &Adjacency, face: u32, other: u32) -> bool {
    let cells = &draft.cells.elements;
    let node = |slot: usize| cells.nodes[slot];
    let count = adjacency.shape_of(cells, face).corners().len();
    let mut own = adjacency.slots(cells, face).take(count).map(node);
    let (Some(first), Some(second)) = (own.next(), own.next()) else {
        return false;
    };
    let twin = || adjacency.slots(cells, other).take(count).map(node);
    let after = twin().skip_while(|&node| node != first).nth(1);
    after.or_else(|| twin().next()) == Some(second)
}

/// Matches the surfaces to faces of cells and collects what does not fit.
pub(crate) fn surfaces(
    draft: &Draft,
    roles: &[SurfaceRole],
    adjacency: &Adjacency,
) -> (Surfaces, Vec<Defect>) {
    let mut surfaces = Surfaces {
        fractures: Vec::new(),
        facets: Vec::new(),
        boundaries: Vec::new(),
        shared: BTreeMap::new(),
    };
    let mut defects = Vec::new();
    let mut taken = vec![NONE; adjacency.face_count()];
    let matches = match_facets(draft, adjacency);
    for (group, role) in roles.iter().enumerate() {
        if draft.groups[group].dimension != 2 {
            continue;
        }
        let facets = facets_of(draft, &matches, group);
        match role {
            SurfaceRole::Fracture => {
                fracture(
                    draft,
                    group,
                    facets,
                    &mut taken,
                    &mut surfaces,
                    &mut defects,
                );
            }
            SurfaceRole::Boundary => boundary(draft, group, facets, &mut surfaces, &mut defects),
            SurfaceRole::Unused => {}
        }
    }
    (surfaces, defects)
}

/// The facets of each set of groups, with the cell faces at each: none, one or two.
type Matches = Vec<Vec<(u64, Vec<u32>)>>;

fn match_facets(draft: &Draft, adjacency: &Adjacency) -> Matches {
    let facets = &draft.facets;
    let mut matches: Matches = vec![Vec::new(); draft.group_sets.len()];
    for facet in 0..facets.elements.len() {
        let count = facets.elements.shapes[facet].corner_count();
        let corners = &facets.elements.nodes_of(facet)[..count];
        let faces = adjacency.faces_at(&draft.cells.elements, corners).collect();
        matches[facets.group_set[facet] as usize].push((facets.tags[facet], faces));
    }
    matches
}

fn facets_of<'a>(
    draft: &'a Draft,
    matches: &'a Matches,
    group: usize,
) -> impl Iterator<Item = &'a (u64, Vec<u32>)> {
    let sets = draft.group_sets.iter().zip(matches);
    sets.filter(move |(set, _)| set.contains(&group))
        .flat_map(|(_, facets)| facets)
}

/// A facet that two fractures share belongs to the first; one that a fracture lists twice is a
/// defect.
fn fracture<'a>(
    draft: &Draft,
    group: usize,
    facets: impl Iterator<Item = &'a (u64, Vec<u32>)>,
    taken: &mut [u32],
    surfaces: &mut Surfaces,
    defects: &mut Vec<Defect>,
) {
    let number = surfaces.fractures.len() as u32;
    surfaces.fractures.push(group);
    let (mut loose, mut outer, mut double) = (Vec::new(), Vec::new(), Vec::new());
    for &(tag, ref faces) in facets {
        match faces[..] {
            [] => loose.push(tag),
            [_] => outer.push(tag),
            [a, ..] if taken[a as usize] == number => double.push(tag),
            [a, ..] if taken[a as usize] != NONE => {
                *surfaces
                    .shared
                    .entry((number, taken[a as usize]))
                    .or_default() += 1;
            }
            [a, b, ..] => {
                taken[a as usize] = number;
                taken[b as usize] = number;
                surfaces.facets.push(DraftFacet {
                    fracture: number,
                    faces: [a, b],
                    tag,
                });
            }
        }
    }
    let place = format!("fracture `{}`", draft.groups[group].name);
    report(defects, &place, "facet", &loose, NOT_EMBEDDED);
    report(defects, &place, "facet", &outer, ON_THE_OUTSIDE);
    report(defects, &place, "facet", &double, TWICE);
    empty(
        draft,
        group,
        surfaces.facets.iter().all(|f| f.fracture != number)
            && loose.is_empty()
            && outer.is_empty(),
        defects,
    );
}

fn boundary<'a>(
    draft: &Draft,
    group: usize,
    facets: impl Iterator<Item = &'a (u64, Vec<u32>)>,
    surfaces: &mut Surfaces,
    defects: &mut Vec<Defect>,
) {
    let (mut loose, mut inner, mut double) = (Vec::new(), Vec::new(), Vec::new());
    let mut faces_seen = std::collections::HashSet::new();
    let mut faces_kept = Vec::new();
    for &(tag, ref faces) in facets {
        match faces[..] {
            [] => loose.push(tag),
            [face] if faces_seen.insert(face) => faces_kept.push(face),
            [_] => double.push(tag),
            [..] => inner.push(tag),
        }
    }
    let place = format!("boundary `{}`", draft.groups[group].name);
    report(defects, &place, "facet", &loose, NOT_ON_THE_ROCK);
    report(defects, &place, "facet", &inner, ON_THE_INSIDE);
    report(defects, &place, "facet", &double, LOADED_TWICE);
    let nothing = faces_kept.is_empty() && loose.is_empty() && inner.is_empty();
    empty(draft, group, nothing, defects);
    surfaces.boundaries.push((group, faces_kept));
}

fn empty(draft: &Draft, group: usize, nothing: bool, defects: &mut Vec<Defect>) {
    if nothing {
        defects.push(Defect::new(
            format!("physical surface `{}`", draft.groups[group].name),
            "the group holds no facets of its own",
            "check that its surfaces still exist after fragments were made, and that no other fracture holds the same facets",
        ));
    }
}
