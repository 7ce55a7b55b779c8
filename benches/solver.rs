//! The stages of a run on a structured block cut by three closing planes; see README.md.

#![allow(
    clippy::print_stdout,
    reason = "the bandwidth is printed beside the kernels"
)]

use std::hint::black_box;
use std::time::Instant;

use criterion::{BatchSize, BenchmarkId, Criterion, criterion_group, criterion_main};
use glam::DVec3;
use kluft_solver::{
    Discretisation, LinearMethod, Load, Newton, NewtonSettings, Pattern, Plan, System, Unknowns,
    Workload, unobserved,
};
use rayon::prelude::*;

use kluft_verification::scenes::block::{THREE_PLANES, draft, mesh, problem};

/// Cubes along an edge: 9, 34 and 111 thousand unknowns.
const SIZES: [usize; 3] = [12, 20, 32];
/// Cubes along an edge for the kernels: a million tetrahedra.
const KERNEL_CUBES: usize = 56;

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
            let unknowns = Unknowns::from(system.discretisation());
            let workload = Workload::of(&problem);
            bencher.iter(|| Plan::of(unknowns, workload, Some(LinearMethod::Direct), usize::MAX));
        });
        group.bench_function(BenchmarkId::new("one load step", cubes), |bencher| {
            let mut newton = Newton::new(&system, NewtonSettings::default()).expect("analysis");
            bencher.iter(|| {
                newton.solve_step(
                    &system,
                    &mut system.initial_state(),
                    &Load::proportional(1.0),
                    unobserved,
                )
            });
        });
    }
    group.finish();
}

/// Doubles in each array of the triad, 128 MB: far more than any cache holds.
const TRIAD: usize = 1 << 24;

/// Bytes a second that all threads together read and write, in GB/s: the best of some passes of
/// `a = b + 3 c`. Reading `a` into the cache before it is overwritten is not counted.
fn bandwidth() -> f64 {
    let (b, c) = (vec![1.0; TRIAD], vec![2.0; TRIAD]);
    let mut a = vec![0.0; TRIAD];
    let pass = |_| {
        let start = Instant::now();
        let sources = b.par_iter().zip(&c);
        a.par_iter_mut()
            .zip(sources)
            .with_min_len(1 << 16)
            .for_each(|(a, (b, c))| *a = b + 3.0 * c);
        black_box(&mut a);
        (3 * 8 * TRIAD) as f64 / start.elapsed().as_secs_f64()
    };
    1e-9 * (0..8).map(pass).fold(0.0, f64::max)
}

/// Seconds that all threads together take to write so many bytes into memory fresh from the system,
/// and to read them back: the best of some passes. Whatever is assembled into fresh memory pays for
/// its pages.
fn write_and_read(bytes: usize) -> f64 {
    let pass = |_| {
        let start = Instant::now();
        let mut fresh = vec![0.0; bytes / 8];
        fresh.par_chunks_mut(1 << 16).for_each(|own| own.fill(1.0));
        let sums = black_box(&fresh).par_chunks(1 << 16).map(sum);
        black_box(sums.sum::<f64>());
        start.elapsed().as_secs_f64()
    };
    (0..8).map(pass).fold(f64::INFINITY, f64::min)
}

/// Sum in an order that lets the processor add several at a time.
fn sum(values: &[f64]) -> f64 {
    let mut sums = [0.0; 16];
    for values in values.chunks_exact(16) {
        for (sum, value) in sums.iter_mut().zip(values) {
            *sum += value;
        }
    }
    sums.iter().sum()
}

/// What moves most of the bytes, with the time that the bytes alone take.
fn kernels(criterion: &mut Criterion) {
    let problem = problem(KERNEL_CUBES, &THREE_PLANES);
    let discretisation = Discretisation::of(&problem).expect("supported");
    let system = System::assemble(&problem, discretisation.clone());
    let pattern = system.discretisation().pattern();
    let vector = vec![DVec3::ONE; system.discretisation().points().len()];
    let mut product = vector.clone();
    let values = size_of_val(system.rock_rows().blocks) + size_of_val(&*pattern.blocks.columns);
    let mesh = size_of_val(&*problem.mesh.cells.nodes) + size_of_val(&*problem.mesh.nodes);
    let rate = bandwidth();
    let alone = |bytes: usize| 1e-6 * bytes as f64 / rate;
    println!(
        "kernels: {} cells, {} blocks, {rate:.1} GB/s on {} threads; the bytes alone take {:.1} ms \
         (assemble) and {:.1} ms (product); written to fresh memory and read back {:.1} ms (assemble)",
        problem.mesh.cells.len(),
        pattern.blocks.columns.len(),
        rayon::current_num_threads(),
        alone(values + mesh),
        alone(values + 2 * size_of_val(&*vector)),
        1e3 * write_and_read(values + mesh),
    );
    let mut group = criterion.benchmark_group("kernels");
    group.sample_size(10);
    group.bench_function("pattern", |bencher| {
        bencher.iter(|| Pattern::of(&problem.mesh, system.discretisation().points()));
    });
    group.bench_function("assemble", |bencher| {
        bencher.iter_batched(
            || discretisation.clone(),
            |discretisation| System::assemble(&problem, discretisation),
            BatchSize::PerIteration,
        );
    });
    let rock = system.rock_rows();
    group.bench_function("product", |bencher| {
        bencher.iter(|| rock.multiply(&vector, &mut product));
    });
    group.finish();
}

criterion_group!(benches, kernels, stages);
criterion_main!(benches);
