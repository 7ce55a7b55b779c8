//! From what an Abaqus input file holds to a mesh.

use std::collections::{BTreeMap, BTreeSet};

use kluft_mesh::{Defect, DisjointSets, Draft, Group, Shape, TaggedElements, sample};

use super::abaqus_model::{Kind, Model, Surface, face_corners};
use super::imported::Imported;
use super::vtk_order::from_vtk;

/// The mesh of a model; `source` names the file.
pub(super) fn build(model: &Model, source: &str) -> Result<Imported, Vec<Defect>> {
    let all = model.elements.values().flat_map(|element| &element.nodes);
    let missing: BTreeSet<u64> = all
        .copied()
        .filter(|node| !model.nodes.contains_key(node))
        .collect();
    if !missing.is_empty() {
        let missing: Vec<u64> = missing.into_iter().collect();
        let problem = format!(
            "elements refer to nodes that are not there: {}",
            sample(&missing)
        );
        let remedy = "write the file again with all nodes";
        return Err(vec![Defect::new(source, problem, remedy)]);
    }
    let tags: Vec<u64> = model.nodes.keys().copied().collect();
    let place = |tag: u64| tags.partition_point(|other| *other < tag) as u32;
    let mut sets = DisjointSets::new(tags.len());
    let mut cohesive = 0_usize;
    for element in model.elements.values() {
        if let Kind::Cohesive(shape) = element.kind {
            let (below, above) = element.nodes.split_at(shape.node_count());
            for (&low, &high) in below.iter().zip(above) {
                sets.join(place(low), place(high));
            }
            cohesive += 1;
        }
    }
    let roots: Vec<u64> = (0..tags.len() as u32)
        .map(|node| tags[sets.root(node) as usize])
        .collect();
    let root = |tag: u64| roots[place(tag) as usize];
    let all = model.elements.values().flat_map(|element| &element.nodes);
    let used: BTreeSet<u64> = all.map(|&node| root(node)).collect();
    let index: BTreeMap<u64, u32> = used.iter().copied().zip(0..).collect();
    let mut made = Made::new(model, index, &root);
    made.add_elements();
    made.add_surfaces();
    let mut notes = made.notes;
    if cohesive > 0 {
        notes.push(format!(
            "{cohesive} cohesive elements became fracture facets, the nodes on their two sides one"
        ));
    }
    if !model.ignored.is_empty() {
        let names: Vec<&str> = model.ignored.iter().map(String::as_str).collect();
        notes.push(format!("not taken over: {}", names.join(", ")));
    }
    let mut draft = made.draft;
    draft.source = source.to_owned();
    draft.node_tags = used.iter().copied().collect();
    draft.nodes = used.iter().map(|tag| model.nodes[tag]).collect();
    Ok(Imported { draft, notes })
}

/// The mesh under construction.
struct Made<'a> {
    model: &'a Model,
    index: BTreeMap<u64, u32>,
    root: &'a dyn Fn(u64) -> u64,
    sets_of: BTreeMap<u64, Vec<&'a str>>,
    sets: BTreeMap<Vec<usize>, u32>,
    draft: Draft,
    notes: Vec<String>,
}

impl<'a> Made<'a> {
    fn new(model: &'a Model, index: BTreeMap<u64, u32>, root: &'a dyn Fn(u64) -> u64) -> Self {
        let mut sets_of: BTreeMap<u64, Vec<&str>> = BTreeMap::new();
        for (name, elements) in model.sets.named(&model.elements) {
            for element in elements {
                sets_of.entry(element).or_default().push(name);
            }
        }
        Self {
            model,
            index,
            root,
            sets_of,
            sets: BTreeMap::new(),
            draft: Draft {
                cells: TaggedElements::new(),
                facets: TaggedElements::new(),
                lines: TaggedElements::new(),
                ..Draft::default()
            },
            notes: Vec::new(),
        }
    }

    /// The set of groups of these names, of a dimension.
    fn set(&mut self, names: &[&str], dimension: usize) -> u32 {
        let mut groups: Vec<usize> = names
            .iter()
            .map(|name| self.group(name, dimension))
            .collect();
        groups.sort_unstable();
        groups.dedup();
        let next = self.draft.group_sets.len() as u32;
        let set = *self.sets.entry(groups.clone()).or_insert(next);
        if set == next {
            self.draft.group_sets.push(groups);
        }
        set
    }

    fn group(&mut self, name: &str, dimension: usize) -> usize {
        let groups = &mut self.draft.groups;
        let known = groups
            .iter()
            .position(|g| g.dimension == dimension && g.name == name);
        known.unwrap_or_else(|| {
            let tag = groups.iter().filter(|g| g.dimension == dimension).count() as i32 + 1;
            groups.push(Group {
                dimension,
                tag,
                name: name.to_owned(),
            });
            groups.len() - 1
        })
    }

    fn push(&mut self, tag: u64, shape: Shape, nodes: &[u32], set: u32) {
        let target = match shape.dimension() {
            3 => &mut self.draft.cells,
            2 => &mut self.draft.facets,
            _ => &mut self.draft.lines,
        };
        target.elements.push(shape, nodes);
        target.tags.push(tag);
        target.group_set.push(set);
    }

    fn add_elements(&mut self) {
        let model = self.model;
        for (&tag, element) in &model.elements {
            let (shape, count) = match element.kind {
                Kind::Solid(shape) | Kind::Cohesive(shape) => (shape, shape.node_count()),
            };
            let tags = element.nodes[..count].iter();
            let nodes: Vec<u32> = tags.map(|&node| self.index[&(self.root)(node)]).collect();
            let nodes = from_vtk(shape, &nodes);
            let names = self.sets_of.get(&tag).cloned().unwrap_or_default();
            let set = self.set(&names, shape.dimension());
            self.push(tag, shape, &nodes, set);
        }
    }

    fn add_surfaces(&mut self) {
        let model = self.model;
        let last = model.elements.keys().max().copied().unwrap_or(0);
        let mut next = last.saturating_add(1);
        for surface in &model.surfaces {
            let set = self.set(&[&surface.name], 2);
            let mut count = 0;
            for (element, face) in faces_of(model, surface) {
                if let Some((shape, nodes)) = self.face(element, face) {
                    self.push(next, shape, &nodes, set);
                    next = next.saturating_add(1);
                    count += 1;
                }
            }
            let note = format!("surface `{}`: {count} faces", surface.name);
            self.notes.push(note);
        }
    }

    /// The face of a cell by its number in Abaqus.
    fn face(&self, element: u64, face: usize) -> Option<(Shape, Vec<u32>)> {
        let found = self.model.elements.get(&element)?;
        let Kind::Solid(shape) = found.kind else {
            return None;
        };
        let wanted = face_corners(shape)?.get(face.checked_sub(1)?)?;
        let mut faces = shape.faces().iter();
        let own = faces.find(|own| {
            let corners = own.corners();
            corners.len() == wanted.len() && wanted.iter().all(|corner| corners.contains(corner))
        })?;
        let nodes = found.nodes.iter();
        let nodes: Vec<u32> = nodes.map(|&node| self.index[&(self.root)(node)]).collect();
        let nodes = from_vtk(shape, &nodes);
        Some((
            own.shape,
            own.nodes.iter().map(|&n| nodes[n as usize]).collect(),
        ))
    }
}

/// The elements of a surface with numbers of their faces, each face once.
fn faces_of(model: &Model, surface: &Surface) -> Vec<(u64, usize)> {
    let mut seen = BTreeSet::new();
    let mut faces = Vec::new();
    for (of, face) in &surface.faces {
        let elements = model
            .sets
            .elements(std::slice::from_ref(of), &model.elements);
        let own = elements.into_iter().map(|element| (element, *face));
        faces.extend(own.filter(|own| seen.insert(*own)));
    }
    faces
}
