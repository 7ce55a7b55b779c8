//! Meshes of surfaces alone: fractures and outer faces without the cells between them.
//!
//! Flow in rigid rock needs no more.

use glam::DVec3;
use kluft_defect::{Defect, sample};
use rayon::prelude::*;

use crate::adjacency::NONE;
use crate::check::facets_of_sets;
use crate::doubled::Places;
use crate::draft::{Draft, Elements};
use crate::facets::{Boundary, Facets};
use crate::geometry::{corners, facet_area_vector};
use crate::mesh::{Mesh, MeshData};
use crate::roles::SurfaceRole;
use crate::sectors::Sectors;

/// A facet is flat when its area is this small against the square of its longest edge.
const FLAT: f64 = 1e-12;

/// Corners of a facet, ascending; those of a triangle end in [`NONE`].
type Key = [u32; 4];

impl Mesh {
    /// The mesh of the surfaces of a draft that has no cells; `roles` has one entry for each of its
    /// groups, of which only those of surfaces count. Facets have nodes and fractures, but neither
    /// sides nor sectors: their normals are those of the file.
    ///
    /// # Errors
    /// Every defect found: coordinates that are not finite, facets without area, facets that stand
    /// in the file twice or belong to a fracture and to the outer surface, fractures without
    /// facets, and nodes that share their place with others.
    pub fn of_surfaces(mut draft: Draft, roles: &[SurfaceRole]) -> Result<Self, Vec<Defect>> {
        let nodes = std::mem::take(&mut draft.nodes).into_iter();
        let nodes: Vec<DVec3> = nodes.map(DVec3::from).collect();
        let defects = broken(&draft, &nodes);
        if !defects.is_empty() {
            return Err(defects);
        }
        let mut taken = Taken::of(&draft, roles);
        taken.defects.extend(doubled_nodes(&draft, &nodes));
        if !taken.defects.is_empty() {
            return Err(taken.defects);
        }
        let group_name = |group: &usize| draft.groups[*group].name.clone();
        let data = MeshData {
            fractures: taken.fractures.iter().map(group_name).collect(),
            shared_facets: taken.shared(),
            facets: Facets {
                elements: chosen(&draft.facets.elements, taken.facets.iter().map(|f| f.1)),
                fracture: taken.facets.iter().map(|f| f.0).collect(),
                ..Facets::default()
            },
            boundaries: taken.boundaries(&draft),
            sectors: Sectors {
                count: vec![0; nodes.len()],
                of_cell_node: Vec::new(),
            },
            nodes,
            block: Vec::new(),
            block_count: 0,
            original: None,
            has_quarter_points: false,
            curves: draft.curves,
            source: draft.source,
            node_tags: draft.node_tags,
            cells: Elements::new(),
            cell_tags: Vec::new(),
            cell_group_set: Vec::new(),
            group_sets: draft.group_sets,
            groups: draft.groups,
        };
        Ok(Self::new(data))
    }
}

/// Defects of nodes and facets by themselves.
fn broken(draft: &Draft, nodes: &[DVec3]) -> Vec<Defect> {
    let facets = &draft.facets.elements;
    if facets.is_empty() {
        return vec![Defect::new(
            &draft.source,
            "nothing to solve: the mesh has no elements of dimension 2 or 3",
            "give the fractures Physical Surfaces and mesh them (gmsh -2)",
        )];
    }
    let lost: Vec<u64> = (0..nodes.len())
        .filter(|&node| !nodes[node].is_finite())
        .map(|node| draft.node_tags[node])
        .collect();
    if !lost.is_empty() {
        return vec![Defect::new(
            format!("{}, node {}", draft.source, sample(&lost)),
            "a coordinate is not a finite number",
            "mesh the geometry again; if it stays, look for 0/0 in the .geo expressions",
        )];
    }
    let is_flat = |facet: &usize| {
        let corners = corners(facets, *facet, nodes);
        let pairs = corners.iter().enumerate();
        let distances =
            pairs.flat_map(|(place, a)| corners[..place].iter().map(|b| a.distance_squared(*b)));
        let longest = distances.fold(0.0, f64::max);
        facet_area_vector(&corners).length() <= FLAT * longest
    };
    let flat: Vec<usize> = (0..facets.len()).into_par_iter().filter(is_flat).collect();
    let tags: Vec<u64> = flat.iter().map(|&facet| draft.facets.tags[facet]).collect();
    let defect = (!tags.is_empty()).then(|| {
        Defect::new(
            format!("{}, facet {}", draft.source, sample(&tags)),
            "the facet has no area",
            "mesh again with other cell sizes, or remove the sliver from the geometry",
        )
    });
    defect.into_iter().collect()
}

/// The defect of nodes at one place: fluid does not pass between them.
fn doubled_nodes(draft: &Draft, nodes: &[DVec3]) -> Option<Defect> {
    let places = Places::of(&draft.facets.elements, nodes);
    let tags = places.pairs();
    let tags: Vec<u64> = tags
        .filter(|(node, lowest)| node != lowest)
        .map(|(node, _)| draft.node_tags[node as usize])
        .collect();
    (!tags.is_empty()).then(|| {
        Defect::new(
            format!("{}, node {}", draft.source, sample(&tags)),
            format!(
                "{} nodes share their place with others: surfaces that touch there do not hang together",
                tags.len()
            ),
            "cut the surfaces with each other in the geometry (BooleanFragments), or make nodes at \
             one place one node (gmsh: Coherence Mesh;)",
        )
    })
}

/// The facets of fractures and outer surface, and what stands against them.
struct Taken {
    /// Groups that are fractures.
    fractures: Vec<usize>,
    /// Fracture and index of each facet.
    facets: Vec<(u32, u32)>,
    /// Groups that are boundaries with their facets.
    outer: Vec<(usize, Vec<u32>)>,
    /// Fractures that left facets to others.
    left: Vec<(u32, u32)>,
    defects: Vec<Defect>,
}

impl Taken {
    fn of(draft: &Draft, roles: &[SurfaceRole]) -> Self {
        let mut taken = Self {
            fractures: Vec::new(),
            facets: Vec::new(),
            outer: Vec::new(),
            left: Vec::new(),
            defects: Vec::new(),
        };
        let first = first_alike(&draft.facets.elements);
        let of_set = facets_of_sets(draft);
        let own = |group: usize| -> Vec<u32> {
            let sets = draft.group_sets.iter().zip(&of_set);
            let own = sets.filter(|(set, _)| set.contains(&group));
            own.flat_map(|(_, facets)| facets).copied().collect()
        };
        let groups = || {
            let groups = roles.iter().enumerate();
            groups.filter(|(group, _)| draft.groups[*group].dimension == 2)
        };
        let mut is_outer = vec![false; first.len()];
        for (group, _) in groups().filter(|(_, role)| **role == SurfaceRole::Boundary) {
            let facets = own(group);
            facets
                .iter()
                .for_each(|&f| is_outer[first[f as usize] as usize] = true);
            taken.outer.push((group, facets));
        }
        let mut owner = vec![NONE; first.len()];
        for (group, _) in groups().filter(|(_, role)| **role == SurfaceRole::Fracture) {
            taken.fracture(draft, (group, own(group)), &first, (&is_outer, &mut owner));
        }
        taken
    }

    /// Adds a fracture. A facet that two fractures hold belongs to the first.
    fn fracture(
        &mut self,
        draft: &Draft,
        (group, facets): (usize, Vec<u32>),
        first: &[u32],
        (is_outer, owner): (&[bool], &mut [u32]),
    ) {
        let number = self.fractures.len() as u32;
        self.fractures.push(group);
        let (mut outer, mut double) = (Vec::new(), Vec::new());
        let before = self.facets.len();
        for facet in facets {
            let tag = draft.facets.tags[facet as usize];
            let place = first[facet as usize] as usize;
            match owner[place] {
                _ if is_outer[place] => outer.push(tag),
                NONE => {
                    owner[place] = number;
                    self.facets.push((number, facet));
                }
                other if other == number => double.push(tag),
                other => self.left.push((number, other)),
            }
        }
        let place = format!("fracture `{}`", draft.groups[group].name);
        for (tags, problem, remedy) in [
            (
                &outer,
                "the facet lies on the outer boundary: there is rock on one side only",
                "a fracture must lie inside the rock; take this surface out of the fracture's group",
            ),
            (
                &double,
                "the facet stands in the file twice",
                "remove the copy (gmsh: Coherence; or BooleanFragments so that surfaces are shared)",
            ),
        ] {
            if !tags.is_empty() {
                let at = format!("{place}, facet {}", sample(tags));
                self.defects.push(Defect::new(at, problem, remedy));
            }
        }
        if self.facets.len() == before && outer.is_empty() {
            self.defects.push(Defect::new(
                place,
                "the group holds no facets of its own",
                "check that its surfaces still exist after fragments were made, and that no other \
                 fracture holds the same facets",
            ));
        }
    }

    /// How many facets a fracture left to another.
    fn shared(&self) -> Vec<(u32, u32, usize)> {
        let mut left = self.left.clone();
        left.sort_unstable();
        let runs = left.chunk_by(|a, b| a == b);
        runs.map(|run| (run[0].0, run[0].1, run.len())).collect()
    }

    fn boundaries(&self, draft: &Draft) -> Vec<Boundary> {
        let outer = self.outer.iter();
        let boundary = |(group, facets): &(usize, Vec<u32>)| Boundary {
            name: draft.groups[*group].name.clone(),
            elements: chosen(&draft.facets.elements, facets.iter().copied()),
            cell: Vec::new(),
            slots: Vec::new(),
        };
        outer.map(boundary).collect()
    }
}

/// Some of the elements.
fn chosen(all: &Elements, which: impl Iterator<Item = u32>) -> Elements {
    let mut chosen = Elements::new();
    for index in which {
        let index = index as usize;
        chosen.push(all.shapes[index], all.nodes_of(index));
    }
    chosen
}

/// For each facet the first one with the same corners.
fn first_alike(facets: &Elements) -> Vec<u32> {
    let mut keys: Vec<(Key, u32)> = (0..facets.len())
        .into_par_iter()
        .map(|facet| {
            let mut key = [NONE; 4];
            let corners = facets.shapes[facet].corner_count();
            key[..corners].copy_from_slice(&facets.nodes_of(facet)[..corners]);
            key.sort_unstable();
            (key, facet as u32)
        })
        .collect();
    keys.par_sort_unstable();
    let mut first: Vec<u32> = vec![0; facets.len()];
    for run in keys.chunk_by(|a, b| a.0 == b.0) {
        run.iter()
            .for_each(|entry| first[entry.1 as usize] = run[0].1);
    }
    first
}

#[cfg(test)]
mod tests;
