//! The ways in which a mesh is tried.

use std::path::PathBuf;

use kluft_mesh::Defect;

use super::options::NOT_MESHED;
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

/// One way to mesh a geometry.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Attempt {
    /// How it is called.
    pub(super) name: &'static str,
    /// The options of gmsh that make it.
    pub(super) options: &'static [(&'static str, f64)],
}

/// The ways to try: gmsh's usual one, and another where that fails, unless the geometry, a file
/// that it opens, or a parameter chooses.
pub(super) fn attempts(scripts: &[PathBuf], parameters: &[(String, f64)]) -> &'static [Attempt] {
    let is_given = parameters.iter().any(|(name, _)| name == ALGORITHM);
    if is_given || scripts.iter().any(chooses) {
        &[AS_GIVEN]
    } else {
        &[AS_GIVEN, HXT]
    }
}

fn chooses(script: &PathBuf) -> bool {
    let script = std::fs::read(script).unwrap_or_default();
    let is_choice = |token| token == Token::Word("Algorithm3D");
    Tokens::of(&script).any(|(_, token)| is_choice(token))
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
