//! Problems on structured meshes, and how to solve them.

use std::path::Path;

use glam::{DMat3, DVec3};
use kluft_io::{Meshing, load_msh, mesh_geometry};
use kluft_mesh::structured::{Patch, tetrahedra};
use kluft_mesh::{Draft, Mesh, SurfaceRole, TaggedElements};
use kluft_solver::{
    Condition, Discretisation, FixedPoint, Fracture, Load, Newton, NewtonSettings, Problem,
    Solution, State, StepRecord, Support, SurfaceLoad, System, solution,
};
use lie_core::{Closure, ClosureKind, FractureLaw, Rock};

/// Rock of the benchmarks: E = 25 GPa, nu = 0.25.
pub const ROCK: Rock = Rock {
    young_modulus: 25e9,
    poisson_ratio: 0.25,
    density: 0.0,
};

/// Joint of the benchmarks: K_n0 = 50 GPa/m, K_s = 20 GPa/m, b0 = 0.1 mm.
pub fn joint(kind: ClosureKind) -> Fracture {
    Fracture {
        law: FractureLaw::elastic(Closure::new(1e-4, 50e9, kind), 20e9),
        fluid_pressure: 0.0,
    }
}

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

pub fn boundary(problem: &Problem, name: &str) -> usize {
    problem
        .mesh
        .boundaries
        .iter()
        .position(|boundary| boundary.name == name)
        .unwrap_or_else(|| panic!("no boundary {name}"))
}

pub fn support(problem: &mut Problem, name: &str, support: Support) {
    let boundary = boundary(problem, name);
    problem.conditions.push(Condition {
        boundary,
        load: None,
        support: Some(support),
    });
}

pub fn load(problem: &mut Problem, name: &str, traction: DVec3) {
    let boundary = boundary(problem, name);
    problem.conditions.push(Condition {
        boundary,
        load: Some(SurfaceLoad::Traction(traction)),
        support: None,
    });
}

/// Solves one load step at factor 1 with the given settings.
pub fn try_solve(problem: &Problem, settings: NewtonSettings) -> (StepRecord, Solution, State) {
    let discretisation = Discretisation::of(problem).unwrap_or_else(|d| panic!("{d:?}"));
    let system = System::assemble(problem, discretisation);
    let mut newton = Newton::new(&system, settings).expect("analysis");
    let mut state = system.initial_state();
    let record = newton.step(&system, &mut state, &Load::proportional(1.0), |_, _| {});
    let solution = solution(&system, &state);
    (record, solution, state)
}

pub fn solve(problem: &Problem) -> Solution {
    let (record, solution, _) = try_solve(problem, NewtonSettings::default());
    assert!(record.converged(), "{record:?}");
    solution
}

/// The mesh that gmsh makes of `geometries/NAME/NAME.geo`.
pub fn geometry(name: &str, parameters: &[(&str, f64)]) -> Draft {
    geometry_of_order(name, parameters, 1)
}

/// The same of order 1 or 2.
pub fn geometry_of_order(name: &str, parameters: &[(&str, f64)], order: u32) -> Draft {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("mesh.msh");
    let parameters: Vec<(String, f64)> = parameters
        .iter()
        .map(|&(name, value)| (name.to_owned(), value))
        .collect();
    mesh_geometry(&Meshing {
        geometry: &root.join(format!("geometries/{name}/{name}.geo")),
        parameters: &parameters,
        order,
        sizes: None,
        output: &file,
    })
    .unwrap_or_else(|defects| panic!("{defects:?}"));
    load_msh(&file, folder.path()).unwrap_or_else(|defects| panic!("{defects:?}"))
}

/// The problem of `geometries/NAME/scene.toml` on a mesh with these parameters.
pub fn scene_file(name: &str, parameters: &[(&str, f64)]) -> Problem {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let file = root.join(format!("geometries/{name}/scene.toml"));
    bound(&file, geometry(name, parameters))
}

/// The problem of a scene file on a mesh.
pub fn bound(file: &Path, draft: Draft) -> Problem {
    let scene = kluft_scene::Scene::read(file).unwrap_or_else(|defects| panic!("{defects:?}"));
    let bound = scene.problem(draft);
    bound
        .unwrap_or_else(|defects| panic!("{defects:?}"))
        .problem
}

/// Solves load steps one after the other, from the state before any load; the record and the
/// solution of each.
pub fn solve_path(
    problem: &Problem,
    settings: NewtonSettings,
    loads: impl IntoIterator<Item = f64>,
) -> Vec<(StepRecord, Solution)> {
    let discretisation = Discretisation::of(problem).unwrap_or_else(|d| panic!("{d:?}"));
    let system = System::assemble(problem, discretisation);
    let mut newton = Newton::new(&system, settings).expect("analysis");
    let mut state = system.initial_state();
    let solved = loads.into_iter().map(|load| {
        let record = newton.step(&system, &mut state, &Load::proportional(load), |_, _| {});
        (record, solution(&system, &state))
    });
    solved.collect()
}

/// The same mesh with nodes, cells and facets in another order, and other first nodes.
pub fn shuffled(draft: &Draft, seed: u64) -> Draft {
    let new_of_old = permutation(draft.nodes.len(), seed);
    let mut shuffled = draft.clone();
    for (old, &new) in new_of_old.iter().enumerate() {
        shuffled.nodes[new] = draft.nodes[old];
        shuffled.node_tags[new] = draft.node_tags[old];
    }
    for (list, from) in [
        (&mut shuffled.cells, &draft.cells),
        (&mut shuffled.facets, &draft.facets),
    ] {
        *list = TaggedElements::new();
        for index in permutation(from.tags.len(), seed + 1) {
            let mut nodes: Vec<u32> = from.elements.nodes_of(index).to_vec();
            // An even permutation keeps the sign of the volume.
            nodes[..3].rotate_left(index % 3);
            let nodes: Vec<u32> = nodes
                .iter()
                .map(|&node| new_of_old[node as usize] as u32)
                .collect();
            list.elements.push(from.elements.shapes[index], &nodes);
            list.tags.push(from.tags[index]);
            list.group_set.push(from.group_set[index]);
        }
    }
    shuffled
}

fn permutation(count: usize, seed: u64) -> Vec<usize> {
    let mut order: Vec<usize> = (0..count).collect();
    let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
    for last in (1..count).rev() {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        order.swap(last, (state % (last as u64 + 1)) as usize);
    }
    order
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

pub fn node_at(mesh: &Mesh, at: DVec3) -> u32 {
    let found = mesh.nodes.iter().position(|x| x.distance(at) < 1e-9);
    found.unwrap_or_else(|| panic!("no node at {at}")) as u32
}

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
