//! Joins rock that touches without sharing nodes, and makes surfaces between volumes.

use glam::DVec3;
use kluft_defect::{Defect, sample};

use crate::adjacency::{Adjacency, NONE};
use crate::disjoint_sets::DisjointSets;
use crate::doubled::{OuterFaces, Places, matching};
use crate::draft::{Draft, Elements, Group};
use crate::facets::push_face;
use crate::roles::Faces;

/// What is to be joined.
#[derive(Debug, Clone, Default)]
pub struct Joining {
    /// Whether all nodes at one place become one node.
    pub weld: bool,
    /// Surfaces between volumes that become physical surfaces; nodes that are doubled there become
    /// one node.
    pub surfaces: Vec<CommonSurface>,
}

/// The surface between two volumes.
#[derive(Debug, Clone)]
pub struct CommonSurface {
    /// Name of the physical surface that it becomes.
    pub name: String,
    /// The groups of the volumes: indices into [`Draft::groups`]. All faces between the two; of a
    /// volume and itself, the faces that lie on one another without sharing nodes.
    pub volumes: [usize; 2],
}

/// What came out of it.
pub struct Joined {
    /// The faces of the draft as it is now.
    pub faces: Faces,
    /// How many nodes became one with another.
    pub welded: usize,
    /// How many facets each surface got.
    pub facets: Vec<usize>,
}

impl Draft {
    /// Joins what touches: nodes at one place become the one with the lowest tag, in cells and
    /// facets alike; facets of one set of groups that thereby become the same stay once; nodes that
    /// nothing refers to any more go. `faces` are those of this very draft.
    ///
    /// # Errors
    /// Cells that collapse, and faces whose corners become the same but not their other nodes.
    pub fn join(&mut self, faces: Faces, joining: &Joining) -> Result<Joined, Vec<Defect>> {
        let adjacency = faces.adjacency;
        let nodes: Vec<DVec3> = self.nodes.iter().copied().map(DVec3::from).collect();
        let outer = OuterFaces::of(&self.cells.elements, &adjacency);
        let mut skin = outer.elements.clone();
        if joining.weld {
            self.add_loose_facets(&adjacency, &mut skin);
        }
        let places = Places::of(&skin, &nodes);
        let pairs = matching(&outer, &nodes, &places);
        let pairs = pairs.iter().filter(|pair| pair.back_to_back);
        let pairs: Vec<[u32; 2]> = pairs
            .map(|pair| pair.faces.map(|face| outer.faces[face]))
            .collect();
        let between: Vec<Between> = joining
            .surfaces
            .iter()
            .map(|surface| self.between(surface, &adjacency, &pairs))
            .collect();
        let merged = match joining.weld {
            true => places.pairs().collect(),
            false => self.doubled_at(&between, &adjacency, &places),
        };
        let welded = self.merge(&merged)?;
        for (surface, between) in joining.surfaces.iter().zip(&between) {
            self.add_surface(&surface.name, &adjacency, &between.faces);
        }
        let faces = Faces::of(self);
        self.check_middles(&outer, &faces.adjacency)?;
        Ok(Joined {
            faces,
            welded,
            facets: between.iter().map(|found| found.faces.len()).collect(),
        })
    }

    /// Facets that are no face of any cell: their nodes may stand on those of the cells.
    fn add_loose_facets(&self, adjacency: &Adjacency, skin: &mut Elements) {
        let facets = &self.facets.elements;
        for (facet, place) in adjacency.facets.iter().enumerate() {
            if place.faces[0] == NONE {
                skin.push(facets.shapes[facet], facets.nodes_of(facet));
            }
        }
    }

    /// The faces of a surface between volumes; `pairs` are those that lie on one another without
    /// sharing nodes.
    fn between(
        &self,
        surface: &CommonSurface,
        adjacency: &Adjacency,
        pairs: &[[u32; 2]],
    ) -> Between {
        let cells = &self.cells;
        let set = |face: u32| cells.group_set[adjacency.cell_of(face) as usize];
        let holds = |face: u32, group: usize| self.group_sets[set(face) as usize].contains(&group);
        let [one, other] = surface.volumes;
        let divides = |[a, b]: [u32; 2]| {
            (holds(a, one) && holds(b, other)) || (holds(b, one) && holds(a, other))
        };
        let doubled = pairs.iter().copied().filter(|pair| divides(*pair));
        let doubled: Vec<[u32; 2]> = doubled.collect();
        let mut faces: Vec<u32> = doubled.iter().map(|pair| pair[0]).collect();
        if one != other {
            let neighbours = (0..).zip(&adjacency.neighbour);
            let shared = neighbours.filter(|&(face, &twin)| {
                // Cells of one set lie in the same volumes, both of which may hold the other.
                twin != NONE && face < twin && set(face) != set(twin) && divides([face, twin])
            });
            faces.extend(shared.map(|(face, _)| face));
            faces.sort_unstable();
        }
        Between { faces, doubled }
    }

    /// Nodes of the doubled faces of such surfaces, each with one that it becomes one with.
    fn doubled_at(
        &self,
        between: &[Between],
        adjacency: &Adjacency,
        places: &Places,
    ) -> Vec<(u32, u32)> {
        let cells = &self.cells.elements;
        let nodes_of = |face: u32| adjacency.slots(cells, face).map(|slot| cells.nodes[slot]);
        let mut sets = DisjointSets::new(self.nodes.len());
        let mut members = Vec::new();
        for [a, b] in between.iter().flat_map(|found| &found.doubled).copied() {
            for node in nodes_of(a) {
                let place = places.lowest(node);
                let twin = nodes_of(b).find(|&twin| places.lowest(twin) == place);
                if let Some(twin) = twin.filter(|&twin| twin != node) {
                    sets.join(node, twin);
                    members.extend([node, twin]);
                }
            }
        }
        members.sort_unstable();
        members.dedup();
        let pairs = members.into_iter().map(|node| (node, sets.root(node)));
        pairs.collect()
    }

    /// Appends a physical surface of these faces.
    pub(crate) fn add_surface(&mut self, name: &str, adjacency: &Adjacency, faces: &[u32]) {
        let surfaces = self.groups.iter().filter(|group| group.dimension == 2);
        let tag = surfaces.map(|group| group.tag).max().unwrap_or(0) + 1;
        let set = self.group_sets.len() as u32;
        self.group_sets.push(vec![self.groups.len()]);
        self.groups.push(Group {
            dimension: 2,
            tag,
            name: name.to_owned(),
        });
        let first = self.facets.tags.iter().max().map_or(1, |tag| tag + 1);
        let (cells, facets) = (&self.cells.elements, &mut self.facets);
        if facets.elements.offsets.is_empty() {
            facets.elements = Elements::new();
        }
        let mut slots = Vec::new();
        for (&face, tag) in faces.iter().zip(first..) {
            slots.clear();
            push_face(cells, adjacency, face, &mut facets.elements, &mut slots);
            facets.tags.push(tag);
            facets.group_set.push(set);
        }
    }

    /// Finds faces that came together by their corners alone.
    fn check_middles(&self, outer: &OuterFaces, now: &Adjacency) -> Result<(), Vec<Defect>> {
        let cells = &self.cells.elements;
        let sorted = |face: u32| {
            let slots = now.slots(cells, face);
            let mut nodes: Vec<u32> = slots.map(|slot| cells.nodes[slot]).collect();
            nodes.sort_unstable();
            nodes
        };
        let unlike = outer.faces.iter().copied().filter(|&face| {
            let twin = now.neighbour[face as usize];
            twin != NONE && face < twin && sorted(face) != sorted(twin)
        });
        let tags = unlike.map(|face| self.cells.tags[now.cell_of(face) as usize]);
        let tags: Vec<u64> = tags.collect();
        if tags.is_empty() {
            return Ok(());
        }
        Err(vec![Defect::new(
            format!("{}, cell {}", self.source, sample(&tags)),
            "the corners of a face are at those of another, but not the middles of its edges",
            "mesh both sides with elements of one order, and share their faces (BooleanFragments)",
        )])
    }
}

/// What lies between two volumes.
struct Between {
    /// One face of each pair, ascending.
    faces: Vec<u32>,
    /// Those pairs that share no nodes.
    doubled: Vec<[u32; 2]>,
}
