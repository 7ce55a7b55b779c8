//! Fractures between which fluid passes through a single node: they touch in a point, where in
//! truth hardly anything passes, or a mesh of other sizes would let more or nothing pass.

use std::collections::{BTreeMap, BTreeSet};

use kluft_mesh::{DisjointSets, Mesh};
use kluft_solver::{Conduit, Flow};

use crate::scene::Scene;
use crate::warning::Doubt;

/// Most contacts that a warning names.
const NAMED: usize = 3;

/// What the user should look at twice of how fractures connect.
pub(crate) fn warning(scene: &Scene, mesh: &Mesh, flow: &Flow) -> Option<String> {
    let contacts = Sheets::of(mesh, flow).contacts(mesh);
    let (first, rest) = contacts.split_first()?;
    let mut text = format!("fluid passes {first}");
    for contact in rest.iter().take(NAMED - 1) {
        text += &format!("; {contact}");
    }
    if contacts.len() > NAMED {
        text += &format!("; and through {} nodes more", contacts.len() - NAMED);
    }
    text += ": what flows there depends on the mesh; let them meet along a line, or not at all";
    scene.warning(Doubt::PointContacts, &text)
}

/// Conducting facets that hang together by their edges.
struct Sheets {
    /// The conducting facets, ascending.
    facets: Vec<usize>,
    /// The sheet of each of them, by its lowest facet.
    of_facet: Vec<u32>,
}

impl Sheets {
    fn of(mesh: &Mesh, flow: &Flow) -> Self {
        let elements = &mesh.facets.elements;
        let conducts = |facet: &usize| {
            let is_active = flow.inactive.binary_search(&(*facet as u32)).is_err();
            is_active && flow.conduit(mesh, *facet) != Conduit::Sealed
        };
        let facets: Vec<usize> = (0..elements.len()).filter(conducts).collect();
        let mut edges: Vec<([u32; 2], u32)> = Vec::new();
        for (index, &facet) in (0..).zip(&facets) {
            let nodes = elements.nodes_of(facet);
            for &[a, b] in elements.shapes[facet].edges() {
                let [a, b] = [a, b].map(|local| nodes[local as usize]);
                edges.push(([a.min(b), a.max(b)], index));
            }
        }
        edges.sort_unstable();
        let mut sets = DisjointSets::new(facets.len());
        for pair in edges.windows(2).filter(|pair| pair[0].0 == pair[1].0) {
            sets.join(pair[0].1, pair[1].1);
        }
        let of_facet = (0..facets.len() as u32).map(|facet| sets.root(facet));
        Self {
            of_facet: of_facet.collect(),
            facets,
        }
    }

    /// Each pair of sheets that share one node and no other, in words.
    fn contacts(&self, mesh: &Mesh) -> Vec<String> {
        let elements = &mesh.facets.elements;
        let mut at_nodes: Vec<(u32, u32)> = Vec::new();
        for (&facet, &sheet) in self.facets.iter().zip(&self.of_facet) {
            let corners = elements.shapes[facet].corner_count();
            let nodes = elements.nodes_of(facet)[..corners].iter();
            at_nodes.extend(nodes.map(|&node| (node, sheet)));
        }
        at_nodes.sort_unstable();
        at_nodes.dedup();
        let mut shared: BTreeMap<(u32, u32), Vec<u32>> = BTreeMap::new();
        for own in at_nodes.chunk_by(|a, b| a.0 == b.0) {
            for (place, &(node, a)) in own.iter().enumerate() {
                for &(_, b) in &own[place + 1..] {
                    shared.entry((a, b)).or_default().push(node);
                }
            }
        }
        let single = shared.into_iter().filter(|(_, nodes)| nodes.len() == 1);
        single
            .map(|((a, b), nodes)| self.told(mesh, [a, b], nodes[0]))
            .collect()
    }

    fn told(&self, mesh: &Mesh, sheets: [u32; 2], node: u32) -> String {
        let [a, b] = sheets.map(|sheet| self.fractures_at(mesh, sheet, node));
        let [x, y, z] = mesh.nodes[node as usize].to_array();
        format!("between {a} and {b} through the one node at ({x:.4}, {y:.4}, {z:.4})")
    }

    /// Names of the fractures of a sheet at a node.
    fn fractures_at(&self, mesh: &Mesh, sheet: u32, node: u32) -> String {
        let facets = self.facets.iter().zip(&self.of_facet);
        let own = facets.filter(|(facet, own)| {
            **own == sheet && mesh.facets.elements.nodes_of(**facet).contains(&node)
        });
        let names: BTreeSet<&str> = own
            .map(|(&facet, _)| &mesh.fractures[mesh.facets.fracture[facet] as usize][..])
            .collect();
        let names: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
        names.join(", ")
    }
}
