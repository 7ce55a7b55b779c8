//! Scenes whose joints close under a load given as a multiple of `K_n0 b0`.

use glam::DVec3;
use kluft_mesh::Draft;
use kluft_mesh::structured::Patch;
use kluft_solver::{Problem, Support};
use lie_core::ClosureKind;

use crate::scenes::{self, joint};

/// A column with a horizontal joint at mid-height under the closing load `q K_n0 b0`.
pub fn column(kind: ClosureKind, q: f64) -> Problem {
    let middle = |x: [f64; 3]| x[2] == 1.0;
    let patch = Patch {
        name: "joint",
        contains: &middle,
    };
    let draft = scenes::box_draft([2, 2, 4], [1.0, 1.0, 2.0], &[patch]);
    let mut problem = scenes::problem(scenes::build(draft), joint(kind));
    for face in ["left", "front", "bottom"] {
        scenes::support(&mut problem, face, Support::Symmetry);
    }
    scenes::load(&mut problem, "top", DVec3::new(0.0, 0.0, -q * 50e9 * 1e-4));
    problem
}

/// The geometry `inclined-joint` under the closing load `q K_n0 b0` on top, laterally held on two
/// sides.
pub fn inclined_joint(draft: &Draft, kind: ClosureKind, q: f64) -> Problem {
    let mut problem = scenes::problem(scenes::build(draft.clone()), joint(kind));
    for face in ["left", "front", "bottom"] {
        scenes::support(&mut problem, face, Support::Symmetry);
    }
    scenes::load(&mut problem, "top", DVec3::new(0.0, 0.0, -q * 50e9 * 1e-4));
    problem
}

/// Three orthogonal joints through the middle of a cube, under three principal stresses: eight
/// sectors.
pub fn three_planes(kind: ClosureKind, q: f64) -> Problem {
    three_planes_of(4, kind, q)
}

/// The same of so many cubes an edge, an even number.
pub fn three_planes_of(cubes: usize, kind: ClosureKind, q: f64) -> Problem {
    let planes: [&dyn Fn([f64; 3]) -> bool; 3] =
        [&|x| x[0] == 0.5, &|x| x[1] == 0.5, &|x| x[2] == 0.5];
    let patches: Vec<Patch<'_>> = ["x", "y", "z"]
        .iter()
        .zip(planes)
        .map(|(name, contains)| Patch { name, contains })
        .collect();
    let draft = scenes::box_draft([cubes; 3], [1.0; 3], &patches);
    let mut problem = scenes::problem(scenes::build(draft), joint(kind));
    for face in ["left", "front", "bottom"] {
        scenes::support(&mut problem, face, Support::Symmetry);
    }
    let s = -q * 50e9 * 1e-4;
    scenes::load(&mut problem, "top", DVec3::new(0.0, 0.0, s));
    scenes::load(&mut problem, "right", DVec3::new(0.5 * s, 0.0, 0.0));
    scenes::load(&mut problem, "back", DVec3::new(0.0, 0.25 * s, 0.0));
    problem
}
