//! Stiff and soft joints: jump unknowns against split nodes.

use faer::Side;
use faer::sparse::{SparseColMat, Triplet};
use kluft_chart::{Axis, Chart, Rate, Series};
use kluft_solver::{Discretisation, LinearMethod, Load, NewtonSettings, Problem, System};
use lie_core::ClosureKind;

use super::counts::{entry, height, hold_promise, most};
use crate::methods::plain_newton;
use crate::methods::split_nodes;
use crate::report::{Effort, Finding, Study, Table};
use crate::scenes::closing::three_planes_of;
use crate::scenes::{self, ROCK};

/// The study.
pub const STUDY: Study = Study {
    name: "contrast",
    title: "Stiffness contrast",
    subject: "K h/E of all joints from 1e-3 to 1e8",
    run,
};

/// Error of conjugate gradients, as a share of the right-hand side.
const TOLERANCE: f64 = 1e-8;
/// Iterations after which they have failed.
const MOST: usize = 10_000;

/// Three crossing planes of linear joints with `K h/E = contrast`, normal and shear.
fn problem(cubes: usize, contrast: f64) -> Problem {
    let mut problem = three_planes_of(cubes, ClosureKind::Linear, 1.0);
    let stiffness = contrast * ROCK.young_modulus * cubes as f64;
    for fracture in &mut problem.fractures {
        fracture.law.closure.normal_stiffness = stiffness;
        fracture.law.shear_stiffness = stiffness;
    }
    problem
}

/// A symmetric matrix and a right-hand side.
struct Equations {
    matrix: SparseColMat<usize, f64>,
    right: Vec<f64>,
}

/// In the program's unknowns.
fn of_jumps(problem: &Problem) -> Equations {
    let system = System::assemble(problem, Discretisation::of(problem).expect("supported"));
    let load = Load::proportional(1.0);
    let unknowns = system.initial_state().unknowns;
    let responses = plain_newton::responses(&system, &unknowns, &load);
    let tangents: Vec<_> = responses.iter().map(|response| response.tangent).collect();
    let tangent = system.tangent(&tangents);
    let rows = tangent.rows(&system.discretisation().pattern().blocks);
    let mut triplets = Vec::new();
    for row in 0..rows.rows() {
        for (column, block) in rows.row(row) {
            let entries = (0..9).map(|n| (n / 3, n % 3));
            triplets.extend(entries.map(|(i, j)| {
                let value = block.col(j)[i];
                Triplet::new(3 * row + i, 3 * column as usize + j, value)
            }));
        }
    }
    let size = 3 * rows.rows();
    let matrix = SparseColMat::try_new_from_triplets(size, size, &triplets);
    let forces = system.load_forces(&load);
    Equations {
        matrix: matrix.expect("indices in range"),
        right: forces.iter().flat_map(|force| force.to_array()).collect(),
    }
}

/// On split nodes.
fn of_split_nodes(problem: &Problem) -> Equations {
    let system = split_nodes::system(problem);
    Equations {
        matrix: system.matrix,
        right: system.right,
    }
}

impl Equations {
    /// Divides rows and columns by the roots of the diagonal.
    fn scaled(self) -> Self {
        let mut root = vec![0.0; self.right.len()];
        let entries = || self.matrix.triplet_iter();
        for entry in entries().filter(|entry| entry.row == entry.col) {
            root[entry.row] = entry.val.sqrt();
        }
        let triplets: Vec<_> = entries()
            .map(|entry| {
                let value = entry.val / (root[entry.row] * root[entry.col]);
                Triplet::new(entry.row, entry.col, value)
            })
            .collect();
        let size = root.len();
        let matrix = SparseColMat::try_new_from_triplets(size, size, &triplets);
        let right = self
            .right
            .iter()
            .zip(&root)
            .map(|(force, root)| force / root);
        Self {
            matrix: matrix.expect("the same pattern"),
            right: right.collect(),
        }
    }

    /// Largest over smallest eigenvalue.
    fn condition(&self) -> f64 {
        let values = self.matrix.to_dense().self_adjoint_eigenvalues(Side::Lower);
        let values = values.expect("eigenvalues");
        let largest = values.iter().copied().fold(0.0, f64::max);
        // Rounding makes the smallest eigenvalue of a hopeless matrix any small number.
        let smallest = values.iter().copied().fold(f64::INFINITY, f64::min);
        largest / smallest.max(f64::EPSILON * largest)
    }

    fn times(&self, vector: &[f64]) -> Vec<f64> {
        let mut product = vec![0.0; vector.len()];
        for entry in self.matrix.triplet_iter() {
            product[entry.row] += entry.val * vector[entry.col];
        }
        product
    }

    /// Iterations of plain conjugate gradients; none if they fail.
    fn iterations(&self) -> Option<usize> {
        let dot = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
        let mut residual = self.right.clone();
        let mut direction = residual.clone();
        let mut energy = dot(&residual, &residual);
        let enough = TOLERANCE * TOLERANCE * energy;
        for iteration in 0..=MOST {
            if energy <= enough {
                return Some(iteration);
            }
            let image = self.times(&direction);
            let step = energy / dot(&direction, &image);
            residual
                .iter_mut()
                .zip(&image)
                .for_each(|(r, i)| *r -= step * i);
            let last = std::mem::replace(&mut energy, dot(&residual, &residual));
            let turn = energy / last;
            direction
                .iter_mut()
                .zip(&residual)
                .for_each(|(d, r)| *d = r + turn * *d);
        }
        None
    }
}

/// Numbers for one stiffness.
struct Case {
    contrast: f64,
    /// Condition numbers and iterations in jump unknowns and on split nodes.
    jumps: (f64, Option<usize>),
    split: (f64, Option<usize>),
    /// Iterations of the program's iterative solver.
    ours: Option<usize>,
}

fn cases(effort: Effort, misses: &mut Vec<String>) -> Vec<Case> {
    let (small, cubes, exponents): (usize, usize, Vec<i32>) = match effort {
        Effort::Quick => (2, 4, vec![-3, 0, 4, 8]),
        Effort::Full => (4, 10, (-3..=8).collect()),
    };
    let case = |exponent: i32| {
        let contrast = 10.0_f64.powi(exponent);
        let both = |equations: fn(&Problem) -> Equations| {
            let condition = equations(&problem(small, contrast)).scaled().condition();
            (
                condition,
                equations(&problem(cubes, contrast)).scaled().iterations(),
            )
        };
        let settings = NewtonSettings {
            linear: Some(LinearMethod::Iterative),
            ..NewtonSettings::default()
        };
        let (record, ..) = scenes::try_solve(&problem(cubes, contrast), settings);
        hold_promise(misses, &format!("K h/E = {contrast:e}"), &record);
        Case {
            contrast,
            jumps: both(of_jumps),
            split: both(of_split_nodes),
            ours: record.converged().then(|| record.linear_iterations()),
        }
    };
    exponents.into_iter().map(case).collect()
}

fn table(cases: &[Case]) -> Table {
    let mut table = Table::new(&[
        "K h/E",
        "condition, split nodes",
        "condition, jumps",
        "iterations, split nodes",
        "iterations, jumps",
        "iterations, Kluft",
    ]);
    for case in cases {
        table.push([
            format!("{:e}", case.contrast),
            format!("{:.3e}", case.split.0),
            format!("{:.3e}", case.jumps.0),
            entry(case.split.1),
            entry(case.jumps.1),
            entry(case.ours),
        ]);
    }
    table
}

fn curve(cases: &[Case], of: impl Fn(&Case) -> f64) -> Vec<(f64, f64)> {
    cases.iter().map(|case| (case.contrast, of(case))).collect()
}

fn charts(cases: &[Case]) -> Vec<(&'static str, Chart)> {
    let x = || Axis::logarithmic("stiffness of the joints, K h/E");
    vec![
        (
            "contrast-condition",
            Chart {
                series: vec![
                    Series::line("split nodes", curve(cases, |case| case.split.0)),
                    Series::line("jump unknowns", curve(cases, |case| case.jumps.0)),
                ],
                rates: vec![Rate {
                    series: 0,
                    rate: 1.0,
                }],
                ..Chart::new(
                    "Three crossing joints: condition number, diagonal scaled",
                    x(),
                    Axis::logarithmic("condition number"),
                )
            },
        ),
        (
            "contrast-iterations",
            Chart {
                series: vec![
                    Series::line("split nodes", curve(cases, |case| height(case.split.1))),
                    Series::line("jump unknowns", curve(cases, |case| height(case.jumps.1))),
                    Series::line("Kluft, multigrid", curve(cases, |case| height(case.ours))),
                ],
                failure: format!("not solved in {MOST} iterations"),
                ..Chart::new(
                    "Conjugate gradients with the diagonal, and Kluft's solver",
                    x(),
                    Axis::logarithmic("iterations"),
                )
            },
        ),
    ]
}

fn run(effort: Effort) -> Finding {
    let mut misses = Vec::new();
    let cases = cases(effort, &mut misses);
    let stiffest = cases.last().expect("cases");
    let unit = cases
        .iter()
        .find(|case| case.contrast >= 1.0)
        .expect("K h/E = 1");
    let softest = &cases[0];
    let ours = entry(most(cases.iter().map(|case| case.ours)));
    Finding::new([
        format!(
            "split nodes: condition number {:.0e} at K h/E = 1, {:.0e} at {:e}",
            unit.split.0, stiffest.split.0, stiffest.contrast
        ),
        format!(
            "condition number {:.0e} and {:.0e} there; {} to {ours} iterations of the multigrid \
             solver",
            unit.jumps.0,
            stiffest.jumps.0,
            entry(softest.ours),
        ),
    ])
    .text(format!(
        "On split nodes a stiff joint ties two unknowns by a large number, and what the joint does \
         is their small difference: the condition number grows with the stiffness, from {:.1e} at \
         K h/E = 1 to {:.1e} at {:e}, although the diagonal is scaled, and conjugate gradients \
         take {} iterations instead of {}. In jump unknowns the stiffness stands on the diagonal \
         of the jumps alone: {:.1e} and {:.1e}, {} and {} iterations. Soft joints, by which the \
         three planes hold eight blocks almost free, are hard for both: {} and {} at {:e}. Kluft's \
         own solver, with a multigrid of rock and joints, takes {} there, {} at K h/E = 1 and at \
         most {ours}, where joints are stiff.",
        unit.split.0,
        stiffest.split.0,
        stiffest.contrast,
        entry(stiffest.split.1),
        entry(unit.split.1),
        unit.jumps.0,
        stiffest.jumps.0,
        entry(unit.jumps.1),
        entry(stiffest.jumps.1),
        entry(softest.split.1),
        entry(softest.jumps.1),
        softest.contrast,
        entry(softest.ours),
        entry(unit.ours),
    ))
    .charts(charts(&cases))
    .numbers(table(&cases))
    .missing(misses)
}
