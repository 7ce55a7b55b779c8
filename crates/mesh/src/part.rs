//! Parts of one mesh: some of its cells, numbered and oriented as in the whole.

use std::collections::BTreeMap;

use kluft_defect::Defect;

use crate::adjacency::{Adjacency, NONE};
use crate::draft::{Draft, Elements, TaggedElements};
use crate::mesh::Mesh;
use crate::roles::{Faces, SurfaceRole};
use crate::sides::Sides;

/// A draft that has been checked as a whole, of which parts can be taken: volumes that come and go
/// while nodes, cells and the sides of fractures keep their names.
#[derive(Debug, Clone)]
pub struct Whole {
    draft: Draft,
    roles: Vec<SurfaceRole>,
    adjacency: Adjacency,
    sides: Sides,
}

/// A mesh of some cells of a [`Whole`].
#[derive(Debug, Clone)]
pub struct Part {
    /// The mesh; its nodes are those of the whole.
    pub mesh: Mesh,
    /// Cell of the whole for each of its cells, ascending.
    pub cells: Vec<u32>,
}

impl Whole {
    /// Checks a draft with all its cells, and gives the mesh of them beside; surfaces inside the
    /// rock may be boundaries, of parts where one side of them is not there.
    ///
    /// # Errors
    /// As [`Mesh::build`].
    pub fn of(
        draft: Draft,
        faces: Faces,
        roles: Vec<SurfaceRole>,
    ) -> Result<(Self, Mesh), Vec<Defect>> {
        let inner = faces.inner_surfaces(&draft);
        let whole_roles: Vec<SurfaceRole> = roles.iter().zip(inner).map(of_whole).collect();
        let adjacency = faces.adjacency.clone();
        let mesh = Mesh::build_on(draft.clone(), faces, &whole_roles)?;
        let whole = Self {
            sides: Sides::of(&mesh.facets.minus, &mesh.facets.plus),
            draft,
            roles,
            adjacency,
        };
        Ok((whole, mesh))
    }

    /// The draft, with all cells.
    pub fn draft(&self) -> &Draft {
        &self.draft
    }

    /// The groups that are fractures.
    pub fn fractures(&self) -> Vec<usize> {
        let roles = self.roles.iter().enumerate();
        let fractures = roles.filter(|(_, role)| **role == SurfaceRole::Fracture);
        fractures.map(|(group, _)| group).collect()
    }

    /// The mesh of the cells that are there. A facet of a fracture is where cells are on both its
    /// sides, one of a boundary where a cell is on one; a surface without any has no role. The
    /// walls of fractures that are welded, groups of the draft, are one.
    ///
    /// # Errors
    /// As [`Mesh::build`].
    ///
    /// # Panics
    /// If there is not one entry for each cell of the whole.
    pub fn part(&self, is_there: &[bool], welded: &[usize]) -> Result<Part, Vec<Defect>> {
        let cells: Vec<u32> = (0..self.draft.cells.elements.len() as u32)
            .filter(|&cell| is_there[cell as usize])
            .collect();
        let draft = Draft {
            source: self.draft.source.clone(),
            nodes: self.draft.nodes.clone(),
            node_tags: self.draft.node_tags.clone(),
            groups: self.draft.groups.clone(),
            group_sets: self.group_sets(welded),
            cells: chosen(&self.draft.cells, &cells),
            facets: self.facets(is_there),
            lines: TaggedElements::new(),
            is_extruded: self.draft.is_extruded,
            curves: self.draft.curves.clone(),
        };
        let sizes = draft.group_sizes(&draft.facets);
        let roles: Vec<SurfaceRole> = (self.roles.iter().zip(sizes))
            .map(|(&role, size)| match size {
                0 => SurfaceRole::Unused,
                _ => role,
            })
            .collect();
        let sides = self.sides.in_part(&cells);
        let faces = Faces::of(&draft);
        let mesh = Mesh::build_with(draft, faces, &roles, Some(&sides))?;
        Ok(Part { mesh, cells })
    }

    /// The sets of groups, then each without boundaries and what is welded, then each without
    /// fractures.
    fn group_sets(&self, welded: &[usize]) -> Vec<Vec<usize>> {
        let sets = &self.draft.group_sets;
        let is_inner =
            |&group: &usize| self.roles[group] != SurfaceRole::Boundary && !welded.contains(&group);
        let is_outer = |&group: &usize| self.roles[group] != SurfaceRole::Fracture;
        let inner = sets.iter().map(|set| chosen_of(set, is_inner));
        let outer = sets.iter().map(|set| chosen_of(set, is_outer));
        sets.iter().cloned().chain(inner).chain(outer).collect()
    }

    /// The facets that have a cell beside them, in the sets of [`Self::group_sets`].
    fn facets(&self, is_there: &[bool]) -> TaggedElements {
        let sets = self.draft.group_sets.len() as u32;
        let mut kept = Vec::new();
        let mut group_set = Vec::new();
        for (facet, place) in self.adjacency.facets.iter().enumerate() {
            let faces = place.faces.into_iter().filter(|&face| face != NONE);
            let beside = faces.filter(|&face| is_there[self.adjacency.cell_of(face) as usize]);
            let variant = match beside.count() {
                0 => continue,
                1 => 2,
                _ => 1,
            };
            kept.push(facet as u32);
            group_set.push(self.draft.facets.group_set[facet] + variant * sets);
        }
        TaggedElements {
            group_set,
            ..chosen(&self.draft.facets, &kept)
        }
    }

    /// Boundaries that have a facet between two cells, each with the volumes on its two sides: sets
    /// of groups, lower first.
    pub fn inner_boundaries(&self) -> BTreeMap<usize, Vec<[u32; 2]>> {
        let mut found: BTreeMap<usize, Vec<[u32; 2]>> = BTreeMap::new();
        for (place, &set) in self
            .adjacency
            .facets
            .iter()
            .zip(&self.draft.facets.group_set)
        {
            if place.faces.contains(&NONE) {
                continue;
            }
            let set_of = |face: u32| {
                let cell = self.adjacency.cell_of(face) as usize;
                self.draft.cells.group_set[cell]
            };
            let [a, b] = place.faces.map(set_of);
            let pair = [a.min(b), a.max(b)];
            let groups = self.draft.group_sets[set as usize].iter();
            for &group in groups.filter(|&&g| self.roles[g] == SurfaceRole::Boundary) {
                let pairs = found.entry(group).or_default();
                if !pairs.contains(&pair) {
                    pairs.push(pair);
                }
            }
        }
        found
    }
}

fn chosen_of(set: &[usize], is_chosen: impl Fn(&usize) -> bool) -> Vec<usize> {
    set.iter().copied().filter(is_chosen).collect()
}

/// What a surface is where all cells are there.
fn of_whole((role, inner): (&SurfaceRole, bool)) -> SurfaceRole {
    match (role, inner) {
        (SurfaceRole::Boundary, true) => SurfaceRole::Unused,
        (role, _) => *role,
    }
}

/// Some of the elements, in their order.
fn chosen(all: &TaggedElements, kept: &[u32]) -> TaggedElements {
    let mut elements = Elements::new();
    for &element in kept {
        let element = element as usize;
        elements.push(all.elements.shapes[element], all.elements.nodes_of(element));
    }
    TaggedElements {
        elements,
        tags: kept.iter().map(|&e| all.tags[e as usize]).collect(),
        group_set: kept.iter().map(|&e| all.group_set[e as usize]).collect(),
    }
}
