//! Everything that may be wrong with a mesh.

use std::collections::{BTreeSet, HashSet};

use glam::DVec3;
use rayon::prelude::*;

use crate::adjacency::{Adjacency, FacetPlace, NONE};
use crate::doubled::{DoubledSurface, Touch};
use crate::draft::{Draft, Elements};
use crate::geometry::cell_volume;
use crate::roles::SurfaceRole;
use crate::shape::Shape;
use crate::surfaces::{DraftFacet, Surfaces};
use kluft_defect::{Defect, sample};

/// A cell is flat when its volume is this small against the cube of its longest edge: there the
/// sign of the volume is rounding.
const FLAT: f64 = 1e-13;

/// The code of a condition on a surface inside the rock.
pub const CONDITION_INSIDE: &str = "condition-inside";
/// The code of outer faces that lie on one another node on node.
pub const DOUBLED_NODES: &str = "doubled-nodes";
/// The code of outer faces that lie on one another with nodes at different places.
pub const FACES_NOT_MATCHING: &str = "faces-not-matching";
/// The code of a fracture on outer faces that lie on one another.
pub const FRACTURE_ON_DOUBLED_NODES: &str = "fracture-on-doubled-nodes";

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
const INSIDE_ANOTHER: Kind = (
    "the cell lies in the place of cells with which it hangs together nowhere: volumes overlap",
    "fragment the volumes against each other (BooleanFragments), or remove one of them",
);
const NOT_EMBEDDED: Kind = (
    "the facet is not a face of any cell: the surface is not embedded in the volume",
    "cut the volume with the surface in the .geo file: BooleanFragments (OpenCASCADE) or Surface{..} In Volume{..}",
);
const ON_THE_OUTSIDE: Kind = (
    "the facet lies on the outer boundary: there is rock on one side only",
    "a fracture must lie inside the rock; take this surface out of the fracture's group",
);
const ON_DOUBLED_NODES: Kind = (
    "the facet lies where nodes are doubled: the rock on its two sides shares no nodes",
    "make nodes at one place one node (gmsh: Coherence Mesh;), so that the facet lies inside",
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
    "conditions act on the outer surface; make a surface inside the rock a fracture",
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

/// A boundary that holds facets inside the rock beside so many on its surface.
fn mixed(place: &str, outer: usize, inner: &[u64]) -> Defect {
    Defect::new(
        format!("{place}, facet {}", sample(inner)),
        format!(
            "the group mixes {outer} facets of the outer surface with {} inside the rock, which have \
             cells on both sides",
            inner.len()
        ),
        "give the surfaces inside the rock a physical group of their own: conditions act on the outer \
         surface only",
    )
}

/// Defects of the nodes and cells of a draft: nothing to solve, coordinates that are not finite,
/// cells without volume or inside out; if there are none, cells that lie on top of others.
pub fn cell_defects(draft: &Draft) -> Vec<Defect> {
    let nodes: Vec<DVec3> = draft.nodes.iter().map(|node| DVec3::from(*node)).collect();
    let defects = cells(draft, &nodes);
    if defects.is_empty() {
        faces(draft, &Adjacency::of(draft))
    } else {
        defects
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
    let broken: Vec<u64> = (0..nodes.len())
        .filter(|&node| !nodes[node].is_finite())
        .map(|node| draft.node_tags[node])
        .collect();
    report(&mut defects, &draft.source, "node", &broken, NOT_FINITE);
    if !broken.is_empty() {
        return defects;
    }
    let wrong: Vec<(usize, bool)> = (0..cells.len())
        .into_par_iter()
        .filter(|&cell| !is_surely_sound(cells, nodes, cell))
        .filter_map(|cell| {
            let volume = relative_volume(draft, nodes, cell);
            let is_flat = volume.abs() <= FLAT;
            (is_flat || volume < 0.0).then_some((cell, is_flat))
        })
        .collect();
    for (flat, kind) in [(true, NO_VOLUME), (false, INSIDE_OUT)] {
        let of_kind = wrong.iter().filter(|(_, is_flat)| *is_flat == flat);
        let tags: Vec<u64> = of_kind.map(|&(cell, _)| draft.cells.tags[cell]).collect();
        report(&mut defects, &draft.source, "cell", &tags, kind);
    }
    defects
}

/// Whether a glance shows that the cell is a tetrahedron of positive volume and not flat. Its
/// longest edge `l` is at most twice the longest `e` of those from one corner, so
/// `V^2 > (2e)^6 f^2` is more than `V > l^3 f`, and takes neither roots nor quotients. The factor
/// leaves room for rounding.
fn is_surely_sound(cells: &Elements, nodes: &[DVec3], cell: usize) -> bool {
    const LIMIT: f64 = 100.0 * FLAT * FLAT;
    let (Shape::Tet4, Some(corners)) = (cells.shapes[cell], cells.nodes_of(cell).first_chunk())
    else {
        return false;
    };
    let [origin, a, b, c] = corners.map(|node: u32| nodes[node as usize]);
    let (a, b, c) = (a - origin, b - origin, c - origin);
    let volume = a.cross(b).dot(c) / 6.0;
    let longest = 4.0
        * a.length_squared()
            .max(b.length_squared())
            .max(c.length_squared());
    volume > 0.0 && volume * volume > LIMIT * longest * longest * longest
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
    let pairs = corners.iter().enumerate();
    let distances =
        pairs.flat_map(|(place, a)| corners[..place].iter().map(|b| a.distance_squared(*b)));
    let longest = distances.fold(0.0, f64::max).sqrt();
    if longest == 0.0 {
        return 0.0;
    }
    cell_volume(shape, corners) / longest.powi(3)
}

/// Cells in the place of cells of another part of the body.
pub(crate) fn inside_others(draft: &Draft, cells: &[u32]) -> Vec<Defect> {
    let mut defects = Vec::new();
    let tags = tags_of(draft, cells);
    report(&mut defects, &draft.source, "cell", &tags, INSIDE_ANOTHER);
    defects
}

fn tags_of(draft: &Draft, cells: &[u32]) -> Vec<u64> {
    let tags = cells.iter().map(|&cell| draft.cells.tags[cell as usize]);
    tags.collect()
}

/// Defects in how the cells fit together.
pub(crate) fn faces(draft: &Draft, adjacency: &Adjacency) -> Vec<Defect> {
    let mut defects = Vec::new();
    let crowded = tags_of(draft, &adjacency.crowded_cells);
    report(&mut defects, &draft.source, "cell", &crowded, CROWDED);
    let mut overlapping = tags_of(draft, &adjacency.overlapping_cells);
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

/// The defect of outer faces that lie on one another.
pub(crate) fn touching(surface: &DoubledSurface) -> Defect {
    let (what, remedy, code) = match surface.touch {
        Touch::Matching => (
            "nodes are doubled there, so the rock does not hold together",
            "share the faces in the geometry (BooleanFragments), or make nodes at one place one \
             node (gmsh: Coherence Mesh;)",
            Some(DOUBLED_NODES),
        ),
        Touch::NotMatching => (
            "their nodes do not match, so the rock does not hold together there",
            "share the faces in the geometry (BooleanFragments) and mesh it again; nodes at \
             different places cannot be welded",
            Some(FACES_NOT_MATCHING),
        ),
        Touch::SameSide => (
            "with rock on the same side, so cells lie on top of others",
            "remove the copy (gmsh: Coherence; or BooleanFragments)",
            None,
        ),
    };
    let DoubledSurface {
        faces, area, at, ..
    } = surface;
    let held = match surface.surfaces.as_slice() {
        [] => String::new(),
        names => format!(" (physical surface `{}`)", names.join("`, `")),
    };
    let problem = format!(
        "{faces} outer faces{held} lie on one another over {area:.6} m2, one of the largest at \
         ({:.6}, {:.6}, {:.6}): {what}",
        at.x, at.y, at.z
    );
    Defect {
        code,
        ..Defect::new(volumes(&surface.volumes), problem, remedy)
    }
}

/// Physical volumes, or the cells in none, in words.
fn volumes(names: &[String]) -> String {
    let named = |name: &String| match name.is_empty() {
        true => "the cells in no physical volume".to_owned(),
        false => format!("`{name}`"),
    };
    let names: Vec<String> = names.iter().map(named).collect();
    let what = if names.len() == 1 {
        "physical volume"
    } else {
        "physical volumes"
    };
    format!("{what} {}", names.join(" and "))
}

/// Matches the surfaces to faces of cells and collects what does not fit; `doubled` are the outer
/// faces that lie on others.
pub(crate) fn surfaces(
    draft: &Draft,
    roles: &[SurfaceRole],
    adjacency: &Adjacency,
    doubled: &BTreeSet<u32>,
) -> (Surfaces, Vec<Defect>) {
    let mut matching = Matching {
        draft,
        doubled,
        surfaces: Surfaces::default(),
        defects: Vec::new(),
        taken: vec![NONE; draft.facets.elements.len()],
    };
    let of_set = facets_of_sets(draft);
    for (group, role) in roles.iter().enumerate() {
        if draft.groups[group].dimension != 2 {
            continue;
        }
        let sets = draft.group_sets.iter().zip(&of_set);
        let own = sets.filter(|(set, _)| set.contains(&group));
        let facets = own.flat_map(|(_, facets)| facets).map(|&facet| Placed {
            tag: draft.facets.tags[facet as usize],
            place: adjacency.facets[facet as usize],
        });
        match role {
            SurfaceRole::Fracture => matching.fracture(group, facets),
            SurfaceRole::Boundary => matching.boundary(group, facets),
            SurfaceRole::Unused => {}
        }
    }
    (matching.surfaces, matching.defects)
}

/// A facet of the draft and where it lies.
struct Placed {
    tag: u64,
    place: FacetPlace,
}

/// The facets of each set of groups, in the order of the file.
pub(crate) fn facets_of_sets(draft: &Draft) -> Vec<Vec<u32>> {
    let mut of_set = vec![Vec::new(); draft.group_sets.len()];
    for (facet, &set) in (0..).zip(&draft.facets.group_set) {
        of_set[set as usize].push(facet);
    }
    of_set
}

/// The surfaces matched so far, and what did not fit.
struct Matching<'a> {
    draft: &'a Draft,
    /// Outer faces that lie on others.
    doubled: &'a BTreeSet<u32>,
    surfaces: Surfaces,
    defects: Vec<Defect>,
    /// The fracture that holds a facet, at the first facet with its corners.
    taken: Vec<u32>,
}

impl Matching<'_> {
    /// Adds a fracture. A facet that two fractures share belongs to the first; one that a fracture
    /// lists twice is a defect.
    fn fracture(&mut self, group: usize, facets: impl Iterator<Item = Placed>) {
        let surfaces = &mut self.surfaces;
        let number = surfaces.fractures.len() as u32;
        let already = surfaces.facets.len();
        surfaces.fractures.push(group);
        let (mut loose, mut outer, mut double) = (Vec::new(), Vec::new(), Vec::new());
        let mut split = Vec::new();
        for Placed { tag, place } in facets {
            let owner = &mut self.taken[place.first as usize];
            match place.faces {
                [NONE, _] => loose.push(tag),
                [face, NONE] if self.doubled.contains(&face) => split.push(tag),
                [_, NONE] => outer.push(tag),
                _ if *owner == number => double.push(tag),
                _ if *owner != NONE => {
                    *surfaces.shared.entry((number, *owner)).or_default() += 1;
                }
                faces => {
                    *owner = number;
                    surfaces.facets.push(DraftFacet {
                        fracture: number,
                        faces,
                        tag,
                    });
                }
            }
        }
        let has_none = [&loose, &outer, &split].iter().all(|tags| tags.is_empty());
        let is_empty = surfaces.facets.len() == already && has_none;
        let place = format!("fracture `{}`", self.draft.groups[group].name);
        let defects = &mut self.defects;
        report(defects, &place, "facet", &loose, NOT_EMBEDDED);
        report(defects, &place, "facet", &outer, ON_THE_OUTSIDE);
        report(defects, &place, "facet", &double, TWICE);
        let before = defects.len();
        report(defects, &place, "facet", &split, ON_DOUBLED_NODES);
        for defect in &mut defects[before..] {
            defect.code = Some(FRACTURE_ON_DOUBLED_NODES);
        }
        let owners: Vec<u32> = self
            .surfaces
            .shared
            .keys()
            .copied()
            .filter_map(|(own, owner)| (own == number).then_some(owner))
            .collect();
        match is_empty {
            true if owners.is_empty() => self.report_empty(group),
            true => self.report_taken(group, &owners),
            false => {}
        }
    }

    /// A fracture all of whose facets belong to others too.
    fn report_taken(&mut self, group: usize, owners: &[u32]) {
        let name = |group: usize| format!("`{}`", self.draft.groups[group].name);
        let owners = owners
            .iter()
            .map(|&owner| name(self.surfaces.fractures[owner as usize]));
        let owners: Vec<String> = owners.collect();
        self.defects.push(Defect::new(
            format!("fracture {}", name(group)),
            format!(
                "all its facets belong to fracture {} too: several physical groups hold one surface, \
                 which can follow one law only",
                owners.join(" and ")
            ),
            "let one group hold the surface, or make a fracture of one of the groups only",
        ));
    }

    /// Adds a boundary.
    fn boundary(&mut self, group: usize, facets: impl Iterator<Item = Placed>) {
        let (mut loose, mut inner, mut double) = (Vec::new(), Vec::new(), Vec::new());
        let mut faces_seen = HashSet::new();
        let mut faces_kept = Vec::new();
        for Placed { tag, place } in facets {
            match place.faces {
                [NONE, _] => loose.push(tag),
                [face, NONE] if faces_seen.insert(face) => faces_kept.push(face),
                [_, NONE] => double.push(tag),
                _ => inner.push(tag),
            }
        }
        let is_empty = faces_kept.is_empty() && loose.is_empty() && inner.is_empty();
        let place = format!("boundary `{}`", self.draft.groups[group].name);
        let defects = &mut self.defects;
        report(defects, &place, "facet", &loose, NOT_ON_THE_ROCK);
        if !inner.is_empty() && !faces_kept.is_empty() {
            defects.push(mixed(&place, faces_kept.len(), &inner));
        } else {
            let before = defects.len();
            report(defects, &place, "facet", &inner, ON_THE_INSIDE);
            for defect in &mut defects[before..] {
                defect.code = Some(CONDITION_INSIDE);
            }
        }
        report(defects, &place, "facet", &double, LOADED_TWICE);
        if is_empty {
            self.report_empty(group);
        }
        self.surfaces.boundaries.push((group, faces_kept));
    }

    fn report_empty(&mut self, group: usize) {
        self.defects.push(Defect::new(
            format!("physical surface `{}`", self.draft.groups[group].name),
            "the group holds no facets of its own",
            "check that its surfaces still exist after fragments were made, and that no other \
             fracture holds the same facets",
        ));
    }
}
