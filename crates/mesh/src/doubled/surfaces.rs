//! Surfaces on which rock touches without sharing nodes, by the volumes on their sides.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec3;

use super::outer::OuterFaces;
use super::overlap::covering;
use super::pairs::{FacePair, matching};
use super::places::Places;
use crate::adjacency::{Adjacency, NONE};
use crate::draft::Draft;
use crate::geometry::facet_centre;

/// How two outer faces lie on one another.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Touch {
    /// Back to back, node on node: the nodes are doubled.
    Matching,
    /// Back to back, but with nodes at different places.
    NotMatching,
    /// Node on node, and the rock of both is on the same side.
    SameSide,
}

/// Outer faces of one or two volumes that lie on one another.
#[derive(Debug, Clone, PartialEq)]
pub struct DoubledSurface {
    /// Names of the physical volumes, one or two; an empty one for cells in none.
    pub volumes: Vec<String>,
    /// Names of the physical surfaces that hold some of the faces.
    pub surfaces: Vec<String>,
    /// How the faces lie on one another.
    pub touch: Touch,
    /// Number of outer faces, those of both sides.
    pub faces: usize,
    /// Area on which they lie on one another (m^2).
    pub area: f64,
    /// Middle of one of the largest faces (m).
    pub at: DVec3,
}

/// All pairs of outer faces that lie on one another.
#[derive(Default)]
pub(crate) struct DoubledFaces {
    outer: OuterFaces,
    pairs: Vec<(Touch, FacePair)>,
}

/// Finds them, in a time that is linear in the cells but for the sorting of the outer faces.
pub(crate) fn doubled_faces(draft: &Draft, nodes: &[DVec3], adjacency: &Adjacency) -> DoubledFaces {
    let outer = OuterFaces::of(&draft.cells.elements, adjacency);
    let places = Places::of(&outer.elements, nodes);
    let found = matching(&outer, nodes, &places);
    let mut taken = vec![false; outer.faces.len()];
    for face in found.iter().flat_map(|pair| pair.faces) {
        taken[face] = true;
    }
    let touch = |pair: &FacePair| match pair.back_to_back {
        true => Touch::Matching,
        false => Touch::SameSide,
    };
    let mut pairs: Vec<(Touch, FacePair)> =
        found.into_iter().map(|pair| (touch(&pair), pair)).collect();
    let covering = covering(&outer, nodes, &taken).into_iter();
    pairs.extend(covering.map(|pair| (Touch::NotMatching, pair)));
    DoubledFaces { outer, pairs }
}

impl DoubledFaces {
    /// Numbers of the cell faces that lie on others.
    pub(crate) fn faces(&self) -> BTreeSet<u32> {
        let faces = self.pairs.iter().flat_map(|(_, pair)| pair.faces);
        faces.map(|face| self.outer.faces[face]).collect()
    }
}

/// What is found of one pair of volumes.
#[derive(Default)]
struct Sum {
    faces: BTreeSet<usize>,
    area: f64,
    largest: Option<FacePair>,
}

/// The pairs put together by volumes, in the order in which the file names these.
pub(crate) fn doubled_surfaces(
    draft: &Draft,
    nodes: &[DVec3],
    adjacency: &Adjacency,
    doubled: &DoubledFaces,
) -> Vec<DoubledSurface> {
    let outer = &doubled.outer;
    let set = |face: usize| {
        let cell = adjacency.cell_of(outer.faces[face]);
        draft.cells.group_set[cell as usize]
    };
    let mut sums: BTreeMap<(Touch, [u32; 2]), Sum> = BTreeMap::new();
    for (touch, pair) in &doubled.pairs {
        let mut sets = pair.faces.map(set);
        sets.sort_unstable();
        let sum = sums.entry((*touch, sets)).or_default();
        sum.faces.extend(pair.faces);
        sum.area += pair.area;
        if sum.largest.is_none_or(|largest| pair.area > largest.area) {
            sum.largest = Some(*pair);
        }
    }
    let surfaces = if sums.is_empty() {
        BTreeMap::new()
    } else {
        sets_of_facets(draft, adjacency)
    };
    let told = sums.into_iter().map(|((touch, sets), sum)| {
        let holding = sum.faces.iter();
        let holding = holding.filter_map(|&face| surfaces.get(&outer.faces[face]));
        let holding: BTreeSet<u32> = holding.flatten().copied().collect();
        let count = if sets[0] == sets[1] { 1 } else { 2 };
        let middle = |pair: FacePair| facet_centre(&outer.corners(pair.faces[0], nodes));
        DoubledSurface {
            volumes: sets[..count]
                .iter()
                .map(|&set| names(draft, set, 3))
                .collect(),
            surfaces: holding
                .into_iter()
                .map(|set| names(draft, set, 2))
                .filter(|names| !names.is_empty())
                .collect(),
            touch,
            faces: sum.faces.len(),
            area: sum.area,
            at: sum.largest.map(middle).unwrap_or_default(),
        }
    });
    told.collect()
}

/// For each outer face with facets their sets of groups.
fn sets_of_facets(draft: &Draft, adjacency: &Adjacency) -> BTreeMap<u32, Vec<u32>> {
    let mut sets: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    for (place, &set) in adjacency.facets.iter().zip(&draft.facets.group_set) {
        if let [face, NONE] = place.faces
            && face != NONE
        {
            sets.entry(face).or_default().push(set);
        }
    }
    sets
}

/// Names of the groups of a set.
fn names(draft: &Draft, set: u32, dimension: usize) -> String {
    let groups = draft.group_sets[set as usize].iter();
    let groups = groups.map(|&group| &draft.groups[group]);
    let own = groups.filter(|group| group.dimension == dimension);
    let names: Vec<&str> = own.map(|group| group.name.as_str()).collect();
    names.join("`, `")
}
