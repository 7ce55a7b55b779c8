//! The scene of the measurements: a block of cubes, six tetrahedra each, cut by closing planes.

use glam::DVec3;
use kluft_mesh::structured::{Patch, tetrahedra};
use kluft_mesh::{Draft, Mesh, SurfaceRole};
use kluft_solver::{Condition, Fracture, Problem, Support, SurfaceLoad};
use lie_core::{Closure, ClosureKind, FractureLaw, Rock};

/// A fracture on faces of the cubes: whether a point is on it.
pub type Plane = fn([f64; 3]) -> bool;

/// Three planes through the middle of the block.
pub const THREE_PLANES: [Plane; 3] = [|x| x[0] == 0.5, |x| x[1] == 0.5, |x| x[2] == 0.5];

/// A level plane and an upright one that ends on it.
pub const TWO_PLANES: [Plane; 2] = [|x| x[2] == 0.5, |x| x[0] == 0.5 && x[2] <= 0.5];

/// A level patch and an upright one that end in the rock.
pub const PATCHES: [Plane; 2] = [
    |x| x[2] == 0.5 && x[..2].iter().all(|x| (0.25..=0.75).contains(x)),
    |x| x[0] == 0.25 && (0.25..=0.75).contains(&x[1]) && (0.125..=0.375).contains(&x[2]),
];

/// So many cubes an edge in a unit cube, with its outer faces.
pub fn draft(cubes: usize, planes: &[Plane]) -> Draft {
    let sides: [Plane; 4] = [
        |x| x[0] == 0.0,
        |x| x[1] == 0.0,
        |x| x[2] == 0.0,
        |x| x[2] == 1.0,
    ];
    let names: Vec<String> = (1..=planes.len())
        .map(|number| format!("plane {number}"))
        .collect();
    let names = names.iter().map(String::as_str);
    let patches: Vec<Patch<'_>> = names
        .chain(["left", "front", "bottom", "top"])
        .zip(planes.iter().chain(&sides))
        .map(|(name, contains)| Patch { name, contains })
        .collect();
    tetrahedra([cubes; 3], [1.0; 3], &patches)
}

/// The checked mesh of a draft with these planes.
pub fn mesh(draft: Draft, planes: &[Plane]) -> Mesh {
    let role = |group: usize| {
        if (1..=planes.len()).contains(&group) {
            SurfaceRole::Fracture
        } else {
            SurfaceRole::Boundary
        }
    };
    let roles: Vec<SurfaceRole> = (0..draft.groups.len()).map(role).collect();
    Mesh::build(draft, &roles).expect("a good mesh")
}

/// The block, pressed from above until its level fractures have closed to a tenth.
pub fn problem(cubes: usize, planes: &[Plane]) -> Problem {
    let mesh = mesh(draft(cubes, planes), planes);
    let law = FractureLaw::elastic(
        Closure::new(1e-4, 50e9, ClosureKind::Logarithmic { cutoff: None }),
        20e9,
    );
    let condition = |boundary: usize| Condition {
        boundary,
        load: (boundary == 3).then_some(SurfaceLoad::Traction(DVec3::new(0.0, 0.0, -28.4e6))),
        support: (boundary < 3).then_some(Support::Symmetry),
    };
    let rock = Rock {
        young_modulus: 25e9,
        poisson_ratio: 0.25,
        density: 0.0,
        anisotropy: None,
    };
    Problem {
        fractures: vec![
            Fracture {
                law,
                fluid_pressure: 0.0
            };
            planes.len()
        ],
        conditions: (0..4).map(condition).collect(),
        ..Problem::of_rock(mesh, rock)
    }
}
