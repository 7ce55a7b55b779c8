//! Problems on structured meshes, and how to solve them.

use glam::DVec3;
use lie_core::{Closure, ClosureKind, FractureLaw, Rock};
use lie_mesh::structured::{Patch, tetrahedra};
use lie_mesh::{Draft, Mesh, SurfaceRole};
use lie_solver::{
    Condition, Discretisation, Fracture, Newton, NewtonSettings, Problem, Solution, State,
    StepRecord, Support, SurfaceLoad, System, solution,
};

/// Rock of the benchmarks: E = 25 GPa, nu = 0.25.
pub const ROCK: Rock = Rock {
    young_modulus: 25e9,
    poisson_ratio: 0.25,
    density: 0.0,
};

/// Joint of the benchmarks: K_n0 = 50 GPa/m, K_s = 20 GPa/m, b0 = 0.1 mm.
pub fn joint(kind: ClosureKind) -> Fracture {
    Fracture {
        law: FractureLaw {
            closure: Closure {
                aperture: 1e-4,
                normal_stiffness: 50e9,
                kind,
            },
            shear_stiffness: 20e9,
        },
        fluid_pressure: 0.0,
    }
}

pub const EXACT: ClosureKind = ClosureKind::Logarithmic { cutoff: None };

/// Names of the six faces of a box: low and high x, y, z.
pub const FACES: [&str; 6] = ["left", "right", "front", "back", "bottom", "top"];

/// A meshed box with its six faces as boundaries and the given fracture patches.
pub fn box_draft(counts: [usize; 3], size: [f64; 3], fractures: &[Patch<'_>]) -> Draft {
    let on = |axis: usize, high: bool| {
        move |x: [f64; 3]| x[axis] == if high { size[axis] } else { 0.0 }
    };
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
        rocks: vec![ROCK],
        rock_of_cell: vec![0; mesh.cells.len()],
        fractures: vec![fracture; mesh.fractures.len()],
        mesh,
        conditions: Vec::new(),
        fixed_points: Vec::new(),
        gravity: DVec3::ZERO,
        initial_stress: None,
        steps: vec![1.0],
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
    let record = newton.step(&mut state, 1.0, |_, _| {});
    let solution = solution(&system, &state);
    (record, solution, state)
}

pub fn solve(problem: &Problem) -> Solution {
    let (record, solution, _) = try_solve(problem, NewtonSettings::default());
    assert!(record.converged(), "{record:?}");
    solution
}
