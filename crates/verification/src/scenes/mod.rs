//! Problems on structured meshes, on meshes of gmsh and from the scenes of `geometries/`, and how
//! to solve them.

pub mod block;
pub mod closing;
pub mod crack_front;
mod files;
pub mod flow;
pub mod flowing_cube;
pub mod joint_sets;
pub mod networks;
pub mod pressed;
mod shuffled;
pub mod soft_slabs;
mod solving;
pub mod uniform_stress;

use glam::{DMat3, DVec3};
use kluft_mesh::structured::{Patch, tetrahedra};
use kluft_mesh::{Draft, Mesh, SurfaceRole};
use kluft_solver::{Condition, FixedPoint, Fracture, Problem, Support, SurfaceLoad};
use lie_core::{Closure, ClosureKind, FractureLaw, Rock};

pub use files::{
    bound, geometry, geometry_in_plane, geometry_of_order, meshed_file, run_scene_file, scene_file,
};
pub use shuffled::shuffled;
pub use solving::{solve, solve_path, try_solve};

/// Rock of the benchmarks: E = 25 GPa, nu = 0.25.
pub const ROCK: Rock = Rock {
    young_modulus: 25e9,
    poisson_ratio: 0.25,
    density: 0.0,
    anisotropy: None,
};

/// Joint of the benchmarks: K_n0 = 50 GPa/m, K_s = 20 GPa/m, b0 = 0.1 mm.
pub fn joint(kind: ClosureKind) -> Fracture {
    Fracture {
        law: FractureLaw::elastic(Closure::new(1e-4, 50e9, kind), 20e9),
        fluid_pressure: 0.0,
    }
}

/// The logarithmic law without cutoff.
pub const EXACT: ClosureKind = ClosureKind::Logarithmic { cutoff: None };

/// Names of the six faces of a box: low and high x, y, z.
pub const FACES: [&str; 6] = ["left", "right", "front", "back", "bottom", "top"];

/// A meshed box with its six faces as boundaries and the given fracture patches.
pub fn box_draft(counts: [usize; 3], size: [f64; 3], fractures: &[Patch<'_>]) -> Draft {
    let on =
        |axis: usize, high: bool| move |x: [f64; 3]| x[axis] == if high { size[axis] } else { 0.0 };
    let faces: Vec<_> = (0..6).map(|face| on(face / 2, face % 2 == 1)).collect();
    let mut patches: Vec<Patch<'_>> = FACES
        .iter()
        .zip(&faces)
        .map(|(name, contains)| Patch { name, contains })
        .collect();
    patches.extend(fractures.iter().map(|patch| Patch {
        name: patch.name,
        contains: patch.contains,
    }));
    tetrahedra(counts, size, &patches)
}

/// Builds the mesh; groups named like a face of the box are boundaries, other surfaces fractures.
pub fn build(draft: Draft) -> Mesh {
    let roles = roles(&draft);
    Mesh::build(draft, &roles).unwrap_or_else(|defects| panic!("{defects:?}"))
}

/// Surfaces named like a face of the box are boundaries, others fractures.
pub fn roles(draft: &Draft) -> Vec<SurfaceRole> {
    let role = |name: &str| {
        if FACES.contains(&name) {
            SurfaceRole::Boundary
        } else {
            SurfaceRole::Fracture
        }
    };
    draft.groups.iter().map(|group| role(&group.name)).collect()
}

/// A problem with one rock and one law for all fractures, no conditions yet.
pub fn problem(mesh: Mesh, fracture: Fracture) -> Problem {
    Problem {
        fractures: vec![fracture; mesh.fractures.len()],
        ..Problem::of_rock(mesh, ROCK)
    }
}

/// Number of a boundary.
///
/// # Panics
/// If there is none of that name.
pub fn boundary(problem: &Problem, name: &str) -> usize {
    problem
        .mesh
        .boundaries
        .iter()
        .position(|boundary| boundary.name == name)
        .unwrap_or_else(|| panic!("no boundary {name}"))
}

/// Supports a boundary.
pub fn support(problem: &mut Problem, name: &str, support: Support) {
    let boundary = boundary(problem, name);
    problem.conditions.push(Condition {
        boundary,
        load: None,
        support: Some(support),
    });
}

/// Loads a boundary with a traction (Pa).
pub fn load(problem: &mut Problem, name: &str, traction: DVec3) {
    let boundary = boundary(problem, name);
    problem.conditions.push(Condition {
        boundary,
        load: Some(SurfaceLoad::Traction(traction)),
        support: None,
    });
}

/// Tractions of a uniform stress on all six faces, which must be flat.
pub fn load_with_stress(problem: &mut Problem, stress: DMat3) {
    load_faces_with_stress(problem, &FACES, stress);
}

/// Tractions of a uniform stress on some faces, which must be flat.
pub fn load_faces_with_stress(problem: &mut Problem, faces: &[&str], stress: DMat3) {
    for name in faces {
        let boundary = &problem.mesh.boundaries[boundary(problem, name)];
        let corners = problem.mesh.corners(&boundary.elements, 0);
        let normal = kluft_mesh::facet_area_vector(&corners).normalize();
        load(problem, name, stress * normal);
    }
}

/// The node at a place.
///
/// # Panics
/// If there is none.
pub fn node_at(mesh: &Mesh, at: DVec3) -> u32 {
    let found = mesh.nodes.iter().position(|x| x.distance(at) < 1e-9);
    found.unwrap_or_else(|| panic!("no node at {at}")) as u32
}

/// Prescribes components of the displacement of the node at a place (m).
pub fn fix(problem: &mut Problem, at: DVec3, displacement: [Option<f64>; 3]) {
    let node = node_at(&problem.mesh, at);
    let name = format!("fixed point at {at}");
    problem.fixed_points.push(FixedPoint {
        node,
        displacement,
        name,
    });
}

/// Holds the six rigid motions at three nodes: all of the first, y and z of the second (on x from
/// the first), z of the third (on y from the first).
pub fn fix_rigid_motions(problem: &mut Problem, at: [DVec3; 3]) {
    fix(problem, at[0], [Some(0.0); 3]);
    fix(problem, at[1], [None, Some(0.0), Some(0.0)]);
    fix(problem, at[2], [None, None, Some(0.0)]);
}
