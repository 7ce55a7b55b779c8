//! The stages of a run on a structured block cut by three closing planes; see README.md.

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use glam::DVec3;
use lie_core::{Closure, ClosureKind, FacetQuadrature, FractureLaw, Rock};
use lie_mesh::structured::{Patch, tetrahedra};
use lie_mesh::{Draft, Mesh, SurfaceRole};
use lie_solver::{
    Condition, DirectSolver, Discretisation, Fracture, Newton, NewtonSettings, Problem, Support,
    SurfaceLoad, System,
};

/// Cubes along an edge: 9, 34 and 111 thousand unknowns.
const SIZES: [usize; 3] = [12, 20, 32];

fn draft(cubes: usize) -> Draft {
    let on = |axis: usize, at: f64| move |x: [f64; 3]| x[axis] == at;
    let places = [
        (0, 0.5),
        (1, 0.5),
        (2, 0.5),
        (0, 0.0),
        (1, 0.0),
        (2, 0.0),
        (2, 1.0),
    ];
    let contains: Vec<_> = places.iter().map(|&(axis, at)| on(axis, at)).collect();
    let names = ["x", "y", "z", "left", "front", "bottom", "top"];
    let patches: Vec<Patch<'_>> = names
        .iter()
        .zip(&contains)
        .map(|(name, contains)| Patch { name, contains })
        .collect();
    tetrahedra([cubes; 3], [1.0; 3], &patches)
}

fn mesh(draft: Draft) -> Mesh {
    let role = |group: usize| match group {
        1..=3 => SurfaceRole::Fracture,
        _ => SurfaceRole::Boundary,
    };
    let roles: Vec<SurfaceRole> = (0..draft.groups.len()).map(role).collect();
    Mesh::build(draft, &roles).expect("a good mesh")
}

fn problem(cubes: usize) -> Problem {
    let mesh = mesh(draft(cubes));
    let law = FractureLaw {
        closure: Closure {
            aperture: 1e-4,
            normal_stiffness: 50e9,
            kind: ClosureKind::Logarithmic { cutoff: None },
        },
        shear_stiffness: 20e9,
    };
    let condition = |boundary: usize| Condition {
        boundary,
        load: (boundary == 3).then_some(SurfaceLoad::Traction(DVec3::new(0.0, 0.0, -28.4e6))),
        support: (boundary < 3).then_some(Support::Symmetry),
    };
    Problem {
        rocks: vec![Rock {
            young_modulus: 25e9,
            poisson_ratio: 0.25,
            density: 0.0,
        }],
        rock_of_cell: vec![0; mesh.cells.len()],
        fractures: vec![
            Fracture {
                law,
                fluid_pressure: 0.0
            };
            3
        ],
        conditions: (0..4).map(condition).collect(),
        fixed_points: Vec::new(),
        gravity: DVec3::ZERO,
        initial_stress: None,
        steps: vec![1.0],
        facet_quadrature: FacetQuadrature::Nodal,
        mesh,
    }
}

fn stages(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("stages");
    group.sample_size(10);
    for cubes in SIZES {
        let draft = draft(cubes);
        group.bench_function(BenchmarkId::new("check and sector", cubes), |bencher| {
            bencher.iter(|| mesh(black_box(draft.clone())));
        });
        let problem = problem(cubes);
        group.bench_function(BenchmarkId::new("enrich", cubes), |bencher| {
            bencher.iter(|| Discretisation::of(black_box(&problem)));
        });
        let discretisation = Discretisation::of(&problem).expect("supported");
        group.bench_function(BenchmarkId::new("assemble", cubes), |bencher| {
            bencher.iter(|| System::assemble(&problem, black_box(discretisation.clone())));
        });
        let system = System::assemble(&problem, discretisation);
        let (pattern, points) = (
            &system.discretisation.pattern,
            &system.discretisation.points,
        );
        group.bench_function(BenchmarkId::new("order and analyse", cubes), |bencher| {
            bencher.iter(|| DirectSolver::new(&system.rock, pattern, points));
        });
        group.bench_function(BenchmarkId::new("one load step", cubes), |bencher| {
            let mut newton = Newton::new(&system, NewtonSettings::default()).expect("analysis");
            bencher.iter(|| newton.step(&mut system.initial_state(), 1.0, |_, _| {}));
        });
    }
    group.finish();
}

criterion_group!(benches, stages);
criterion_main!(benches);
