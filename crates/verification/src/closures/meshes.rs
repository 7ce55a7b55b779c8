//! Linear and quadratic cells, direct and iterative solvers: the crack in exact contact.

use kluft_mesh::Shape;
use kluft_solver::LinearMethod;

use super::crack::{inside, profile};
use super::measured::megabytes;
use super::memory::{Peak, Place, Run, SHAPES, measured};
use crate::methods::treatments::{Point, Solved, Treatment, apart, solve, traction_error};
use crate::report::{Effort, Finding, Study, Table};
use crate::scenes::pressed::bent_crack;

pub const CELLS: Study = Study {
    name: "cells",
    title: "Linear or quadratic cells",
    subject: "cells of 1/8 to 1/32 m beside the half-open crack, exact contact",
    run: run_cells,
};

pub const SOLVERS: Study = Study {
    name: "solvers",
    title: "Direct or iterative",
    subject: "all linear solvers on equal meshes, exact contact",
    run: run_solvers,
};

/// Force per area between the walls, along the crack: resultant (N/m) and its moment about the
/// middle (N).
fn resultant(points: &[Point]) -> (f64, f64) {
    let width = 0.25;
    let sum = |of: &dyn Fn(&Point) -> f64| points.iter().map(of).sum::<f64>() / width;
    (
        sum(&|point| point.area * point.traction),
        sum(&|point| point.area * point.traction * point.x),
    )
}

/// Largest opening (m).
fn widest(points: &[Point]) -> f64 {
    points.iter().map(|point| point.opening).fold(0.0, f64::max)
}

fn contact(shape: Shape, parts: usize, linear: LinearMethod) -> Option<Solved> {
    solve(&bent_crack(shape, parts), Treatment::Contact, 0.0, linear)
}

/// Memory that the same takes in a process of its own.
fn memory(shape: Shape, parts: usize, linear: LinearMethod) -> Option<Peak> {
    measured(&Run {
        place: Place::Crack(shape, parts),
        treatment: Treatment::Contact,
        stiffness: 0.0,
        linear,
    })
}

/// A mesh with its solution.
struct OnCells {
    shape: Shape,
    /// Cells in 1/8 m.
    parts: usize,
    solved: Solved,
    /// Relative errors of the largest opening and of the resultant.
    errors: [f64; 2],
}

/// Every shape on meshes of some sizes, beside the largest opening and the resultant of the finest;
/// what does not converge is a miss.
fn on_cells(sizes: &[usize], finest: usize, misses: &mut Vec<String>) -> Vec<OnCells> {
    let reference = contact(Shape::Hex8, finest, LinearMethod::Direct).expect("contact converges");
    let exact = [widest(&reference.points), resultant(&reference.points).0];
    let mut cases = Vec::new();
    for shape in SHAPES {
        for &parts in sizes {
            let Some(solved) = contact(shape, parts, LinearMethod::Direct) else {
                misses.push(format!("{shape:?}, 1/{} m: not converged", 8 * parts));
                continue;
            };
            let found = [widest(&solved.points), resultant(&solved.points).0];
            let errors = [0, 1].map(|which| found[which] / exact[which] - 1.0);
            cases.push(OnCells {
                shape,
                parts,
                solved,
                errors,
            });
        }
    }
    cases
}

fn cells_table(cases: &[OnCells]) -> Table {
    let mut table = Table::new(&[
        "cells",
        "1/h (1/m)",
        "unknowns",
        "Newton",
        "largest opening, error",
        "resultant, error",
        "seconds",
        "peak memory measured (MB)",
    ]);
    for case in cases {
        let [opening, force] = case.errors.map(|error| format!("{:+.2} %", 100.0 * error));
        let peak = memory(case.shape, case.parts, LinearMethod::Direct);
        table.push([
            format!("{:?}", case.shape),
            (8 * case.parts).to_string(),
            case.solved.unknowns.to_string(),
            case.solved.newton.to_string(),
            opening,
            force,
            format!("{:.2}", case.solved.seconds),
            megabytes(peak, |peak| peak.process),
        ]);
    }
    table
}

/// Errors of the largest opening on cells of a shape.
fn openings(cases: &[OnCells], shape: Shape) -> String {
    let own = cases.iter().filter(|case| case.shape == shape);
    let each = own.map(|case| {
        let percent = 100.0 * case.errors[0];
        format!("{percent:+.2} % at 1/{} m", 8 * case.parts)
    });
    each.collect::<Vec<String>>().join(", ")
}

fn run_cells(effort: Effort) -> Finding {
    let (sizes, finest): (&[usize], usize) = match effort {
        Effort::Quick => (&[1], 2),
        Effort::Full => (&[1, 2], 4),
    };
    let mut misses = Vec::new();
    let cases = on_cells(sizes, finest, &mut misses);
    let each = SHAPES.map(|shape| format!("{shape:?} {}", openings(&cases, shape)));
    Finding::new([
        format!(
            "linear tetrahedra: largest opening {}",
            openings(&cases, Shape::Tet4)
        ),
        format!("quadratic tetrahedra: {}", openings(&cases, Shape::Tet10)),
    ])
    .text(format!(
        "Errors against exact contact on linear hexahedra of 1/{} m, which is no closed form. The \
         largest opening is off by: {}. Cells of second order evaluate contact at control points, \
         as many as jumps.",
        8 * finest,
        each.join("; "),
    ))
    .table(cells_table(&cases))
    .missing(misses)
}

/// A linear solver on a mesh.
struct BySolver {
    method: LinearMethod,
    /// Cells in 1/8 m.
    parts: usize,
    solved: Solved,
    /// Error of the traction against the finer mesh, L2.
    error: f64,
    /// From the openings of the direct solver, over `b0`.
    apart: f64,
}

fn by_solvers(sizes: &[usize], finest: usize, misses: &mut Vec<String>) -> Vec<BySolver> {
    let reference = contact(Shape::Hex8, finest, LinearMethod::Direct).expect("contact converges");
    let reference = profile(&reference.points);
    let mut cases = Vec::new();
    for &parts in sizes {
        let direct = contact(Shape::Hex8, parts, LinearMethod::Direct).expect("contact converges");
        for method in LinearMethod::ALL {
            let Some(solved) = contact(Shape::Hex8, parts, method) else {
                misses.push(format!("{method}, 1/{} m: not converged", 8 * parts));
                continue;
            };
            cases.push(BySolver {
                method,
                parts,
                error: traction_error(&inside(&solved.points), |point| reference(point.x)),
                apart: apart(&solved.points, &direct.points),
                solved,
            });
        }
    }
    cases
}

fn solvers_table(cases: &[BySolver]) -> Table {
    let mut table = Table::new(&[
        "solver",
        "1/h (1/m)",
        "unknowns",
        "Newton",
        "linear iterations",
        "traction error",
        "openings against direct / b0",
        "seconds",
        "peak memory measured (MB)",
        "of it during the solve (MB)",
        "solve, memory predicted (MB)",
    ]);
    for case in cases {
        let peak = memory(Shape::Hex8, case.parts, case.method);
        table.push([
            case.method.to_string(),
            (8 * case.parts).to_string(),
            case.solved.unknowns.to_string(),
            case.solved.newton.to_string(),
            case.solved.linear.to_string(),
            format!("{:.3e}", case.error),
            format!("{:.0e}", case.apart),
            format!("{:.2}", case.solved.seconds),
            megabytes(peak, |peak| peak.process),
            megabytes(peak, |peak| peak.solve),
            format!("{:.0}", case.solved.memory as f64 / 1e6),
        ]);
    }
    table
}

fn run_solvers(effort: Effort) -> Finding {
    let (sizes, finest): (&[usize], usize) = match effort {
        Effort::Quick => (&[1], 2),
        Effort::Full => (&[1, 2, 4], 8),
    };
    let mut misses = Vec::new();
    let cases = by_solvers(sizes, finest, &mut misses);
    let farthest = cases.iter().map(|case| case.apart).fold(0.0, f64::max);
    Finding::new([
        "nothing".to_owned(),
        format!("openings of all solvers within {farthest:.0e} b0"),
    ])
    .text(format!(
        "The same contact with each linear solver on linear hexahedra. The error of the traction \
         against the mesh of 1/{} m is that of the mesh; openings differ between solvers by at \
         most {farthest:.0e} b0. Times are of one run.",
        8 * finest
    ))
    .table(solvers_table(&cases))
    .missing(misses)
}
