//! The stages of a run on a structured block cut by three closing planes; see README.md.

mod block;

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use lie_solver::{
    Discretisation, LinearMethod, Newton, NewtonSettings, Plan, System, Unknowns, Workload,
};

use block::{THREE_PLANES, draft, mesh, problem};

/// Cubes along an edge: 9, 34 and 111 thousand unknowns.
const SIZES: [usize; 3] = [12, 20, 32];

fn stages(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("stages");
    group.sample_size(10);
    for cubes in SIZES {
        let draft = draft(cubes, &THREE_PLANES);
        group.bench_function(BenchmarkId::new("check and sector", cubes), |bencher| {
            bencher.iter(|| mesh(black_box(draft.clone()), &THREE_PLANES));
        });
        let problem = problem(cubes, &THREE_PLANES);
        group.bench_function(BenchmarkId::new("enrich", cubes), |bencher| {
            bencher.iter(|| Discretisation::of(black_box(&problem)));
        });
        let discretisation = Discretisation::of(&problem).expect("supported");
        group.bench_function(BenchmarkId::new("assemble", cubes), |bencher| {
            bencher.iter(|| System::assemble(&problem, black_box(discretisation.clone())));
        });
        let system = System::assemble(&problem, discretisation);
        group.bench_function(BenchmarkId::new("order and analyse", cubes), |bencher| {
            let unknowns = Unknowns::from(&system.discretisation);
            let workload = Workload::of(&problem);
            bencher.iter(|| Plan::of(unknowns, workload, Some(LinearMethod::Direct), usize::MAX));
        });
        group.bench_function(BenchmarkId::new("one load step", cubes), |bencher| {
            let mut newton = Newton::new(&system, NewtonSettings::default()).expect("analysis");
            bencher.iter(|| newton.step(&system, &mut system.initial_state(), 1.0, |_, _| {}));
        });
    }
    group.finish();
}

criterion_group!(benches, stages);
criterion_main!(benches);
