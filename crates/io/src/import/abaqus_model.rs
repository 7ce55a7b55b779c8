//! What an Abaqus input file holds.

use std::collections::{BTreeMap, BTreeSet};

use kluft_mesh::Shape;

use super::abaqus_sets::{Member, Sets};

/// What becomes of an element.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Kind {
    Solid(Shape),
    /// Two faces without anything between.
    Cohesive(Shape),
}

impl Kind {
    pub(super) fn node_count(self) -> usize {
        match self {
            Self::Solid(shape) => shape.node_count(),
            Self::Cohesive(shape) => 2 * shape.node_count(),
        }
    }
}

/// An element.
pub(super) struct Element {
    pub(super) kind: Kind,
    pub(super) nodes: Vec<u64>,
}

/// A surface.
pub(super) struct Surface {
    pub(super) name: String,
    /// Elements, each with the number of its face.
    pub(super) faces: Vec<(Member, usize)>,
}

/// Nodes, elements and sets by their numbers and names.
#[derive(Default)]
pub(super) struct Model {
    pub(super) nodes: BTreeMap<u64, [f64; 3]>,
    pub(super) elements: BTreeMap<u64, Element>,
    pub(super) sets: Sets,
    pub(super) surfaces: Vec<Surface>,
    /// Keywords that are passed over.
    pub(super) ignored: BTreeSet<String>,
}

impl Model {
    /// The index of the surface of a name, whose case does not count; it is made if there is none.
    pub(super) fn surface(&mut self, name: &str) -> usize {
        let mut surfaces = self.surfaces.iter();
        let known = surfaces.position(|surface| surface.name.eq_ignore_ascii_case(name));
        known.unwrap_or_else(|| {
            self.surfaces.push(Surface {
                name: name.to_owned(),
                faces: Vec::new(),
            });
            self.surfaces.len() - 1
        })
    }

    /// Members that are neither numbers nor sets, by their lines: what is wrong, and a remedy.
    pub(super) fn unknown_members(&self) -> Vec<(usize, [String; 2])> {
        let faces = self.surfaces.iter().flat_map(|surface| &surface.faces);
        let members = self.sets.members().chain(faces.map(|(of, _)| of));
        let unknown = members.filter_map(|member| self.sets.unknown(member));
        let mut unknown: Vec<(usize, [String; 2])> = unknown.collect();
        unknown.sort();
        unknown
    }
}

/// The element of a type.
pub(super) fn kind_of(name: &str) -> Option<Kind> {
    let upper = name.to_uppercase();
    let cohesive = match upper.as_str() {
        "COH3D6" => Some(Shape::Tri3),
        "COH3D8" => Some(Shape::Quad4),
        _ => None,
    };
    if let Some(shape) = cohesive {
        return Some(Kind::Cohesive(shape));
    }
    // R, I, H, M, T, P: reduced, incompatible and other forms of one shape.
    let stem = upper.trim_end_matches(|c: char| c.is_ascii_alphabetic());
    Some(Kind::Solid(match stem {
        "C3D4" | "DC3D4" => Shape::Tet4,
        "C3D10" | "DC3D10" => Shape::Tet10,
        "C3D8" | "DC3D8" => Shape::Hex8,
        "C3D20" => Shape::Hex20,
        "C3D6" | "DC3D6" => Shape::Prism6,
        "C3D15" => Shape::Prism15,
        "C3D5" => Shape::Pyramid5,
        "CPE3" | "CPS3" | "S3" | "M3D3" | "STRI3" | "R3D3" => Shape::Tri3,
        "CPE6" | "CPS6" | "M3D6" | "STRI65" => Shape::Tri6,
        "CPE4" | "CPS4" | "S4" | "M3D4" | "R3D4" => Shape::Quad4,
        "CPE8" | "CPS8" | "S8" | "M3D8" => Shape::Quad8,
        "T2D2" | "T3D2" | "B21" | "B31" => Shape::Line2,
        "T2D3" | "T3D3" | "B22" | "B32" => Shape::Line3,
        _ => return None,
    }))
}

/// Corners of the faces S1, S2 and so on.
pub(super) fn face_corners(shape: Shape) -> Option<&'static [&'static [u8]]> {
    Some(match shape.corner_count() {
        4 if shape.dimension() == 3 => &[&[0, 1, 2], &[0, 3, 1], &[1, 3, 2], &[2, 3, 0]],
        6 => &[
            &[0, 1, 2],
            &[3, 5, 4],
            &[0, 3, 4, 1],
            &[1, 4, 5, 2],
            &[2, 5, 3, 0],
        ],
        8 => &[
            &[0, 1, 2, 3],
            &[4, 7, 6, 5],
            &[0, 4, 5, 1],
            &[1, 5, 6, 2],
            &[2, 6, 7, 3],
            &[3, 7, 4, 0],
        ],
        _ => return None,
    })
}
