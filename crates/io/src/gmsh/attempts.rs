//! The ways in which a mesh is tried.

use kluft_mesh::Defect;

use super::options::{Dimension, NOT_MESHED};
use super::script::{Token, Tokens};

/// The option of gmsh that chooses how volumes are meshed.
const ALGORITHM: &str = "Mesh.Algorithm3D";
/// What the geometry says, or gmsh's own choice, which is Delaunay.
const AS_GIVEN: Attempt = Attempt {
    name: "gmsh's usual way",
    options: &[],
};
/// Marot, Pellerin and Remacle (2019), One machine, one minute, three billion tetrahedra. On more
/// threads than one it makes another mesh each time.
const HXT: Attempt = Attempt {
    name: "HXT",
    options: &[(ALGORITHM, 10.0), ("Mesh.MaxNumThreads3D", 1.0)],
};

/// How a geometry of `kluft network` names the forms that it offers.
const FORM: &str = "form";
/// What `kluft network` writes in the first line.
const MADE_BY: &str = "made by `kluft network`";
/// The option of gmsh that chooses how surfaces are meshed; 5 is Delaunay.
const ALGORITHM_2D: &str = "Mesh.Algorithm";
/// Whole fractures with lines embedded in them, then fractures split along closed loops of lines,
/// then polygons that OpenCASCADE cuts: no form wins always.
const FORMS: [Attempt; 5] = [
    way("whole fractures", &[(FORM, 0.0)]),
    way("split fractures", &[(FORM, 1.0)]),
    way(
        "whole fractures, surfaces by Delaunay",
        &[(FORM, 0.0), (ALGORITHM_2D, 5.0)],
    ),
    way(
        "split fractures, surfaces by Delaunay",
        &[(FORM, 1.0), (ALGORITHM_2D, 5.0)],
    ),
    way("fractures cut by OpenCASCADE", &[(FORM, 2.0)]),
];

/// One way to mesh a geometry.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Attempt {
    /// How it is called.
    pub(super) name: &'static str,
    /// The options of gmsh that make it.
    pub(super) options: &'static [(&'static str, f64)],
}

const fn way(name: &'static str, options: &'static [(&'static str, f64)]) -> Attempt {
    Attempt { name, options }
}

/// The ways to try: the forms that a network offers, or gmsh's usual way and another where that
/// fails; one way if the geometry, a file that it opens, or a parameter chooses.
pub(super) fn attempts(
    scripts: &[Vec<u8>],
    parameters: &[(String, f64)],
    dimension: Dimension,
) -> &'static [Attempt] {
    let is_given = parameters.iter().any(|(name, _)| name == ALGORITHM);
    let any = |holds: fn(&[u8]) -> bool| scripts.iter().any(|script| holds(script));
    if is_given || any(chooses) {
        &[AS_GIVEN]
    } else if !is_any_given(parameters) && any(offers_forms) {
        &FORMS
    } else if dimension == Dimension::Surfaces {
        &[AS_GIVEN]
    } else {
        &[AS_GIVEN, HXT]
    }
}

fn is_any_given(parameters: &[(String, f64)]) -> bool {
    let given = |(name, _): &(String, f64)| [FORM, ALGORITHM_2D].contains(&name.as_str());
    parameters.iter().any(given)
}

/// Whether a script is one of `kluft network` with forms to choose from.
fn offers_forms(script: &[u8]) -> bool {
    let first = script
        .split(|&byte| byte == b'\n')
        .next()
        .unwrap_or_default();
    let is_network = memchr::memmem::find(first, MADE_BY.as_bytes()).is_some();
    let is_form = |token| token == Token::Text(FORM.as_bytes());
    is_network && Tokens::of(script).any(|(_, token)| is_form(token))
}

fn chooses(script: &[u8]) -> bool {
    let is_choice = |token| token == Token::Word("Algorithm3D");
    Tokens::of(script).any(|(_, token)| is_choice(token))
}

/// Whether gmsh could fare better in another way: nothing is wrong with a line of the geometry, and
/// neither time nor space ran out.
pub(super) fn is_worth_another(defects: &[Defect]) -> bool {
    let of_a_line = |defect: &Defect| defect.place.contains(", line ");
    let of_machine = |defect: &Defect| defect.code == Some(NOT_MESHED);
    !defects
        .iter()
        .any(|defect| of_a_line(defect) || of_machine(defect))
}
