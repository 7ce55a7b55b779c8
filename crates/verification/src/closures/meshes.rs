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

/// Force per area between the walls, along the crack: resultant (N/m) and its moment about the middle (N).
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

fn run_cells(effort: Effort) -> Finding {
    let (sizes, finest): (&[usize], usize) = match effort {
        Effort::Quick => (&[1], 2),
        Effort::Full => (&[1, 2], 4),
    };
    let reference = contact(Shape::Hex8, finest, LinearMethod::Direct).expect("contact converges");
    let exact = (widest(&reference.points), resultant(&reference.points).0);
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
    let mut misses = Vec::new();
    let mut errors = Vec::new();
    for shape in SHAPES {
        for &parts in sizes {
            let case = format!("{shape:?}, 1/{} m", 8 * parts);
            let Some(solved) = contact(shape, parts, LinearMethod::Direct) else {
                misses.push(format!("{case}: not converged"));
                continue;
            };
            let opening = widest(&solved.points) / exact.0 - 1.0;
            let force = resultant(&solved.points).0 / exact.1 - 1.0;
            errors.push((shape, parts, opening));
            table.push([
                format!("{shape:?}"),
                (8 * parts).to_string(),
                solved.unknowns.to_string(),
                solved.newton.to_string(),
                format!("{:+.2} %", 100.0 * opening),
                format!("{:+.2} %", 100.0 * force),
                format!("{:.2}", solved.seconds),
                megabytes(memory(shape, parts, LinearMethod::Direct), |peak| {
                    peak.process
                }),
            ]);
        }
    }
    let of = |shape: Shape| {
        let own = errors.iter().filter(|error| error.0 == shape);
        let each =
            own.map(|(_, parts, error)| format!("{:+.2} % at 1/{} m", 100.0 * error, 8 * parts));
        each.collect::<Vec<String>>().join(", ")
    };
    Finding::new([format!("linear tetrahedra: largest opening {}", of(Shape::Tet4)), format!("quadratic tetrahedra: {}", of(Shape::Tet10))])
.text(format!(
            "Errors against exact contact on linear hexahedra of 1/{} m, which is no closed form. The largest opening is off by: Tet4 {}; \
             Hex8 {}; Tet10 {}; Hex20 {}. Cells of second order evaluate contact at control points, as many as \
             jumps.",
            8 * finest,
            of(Shape::Tet4),
            of(Shape::Hex8),
            of(Shape::Tet10),
            of(Shape::Hex20),
        ))
.numbers(table)
.missing(misses)
}

fn run_solvers(effort: Effort) -> Finding {
    let (sizes, finest): (&[usize], usize) = match effort {
        Effort::Quick => (&[1], 2),
        Effort::Full => (&[1, 2, 4], 8),
    };
    let reference = contact(Shape::Hex8, finest, LinearMethod::Direct).expect("contact converges");
    let reference = profile(&reference.points);
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
    let mut misses = Vec::new();
    let mut farthest: f64 = 0.0;
    for &parts in sizes {
        let direct = contact(Shape::Hex8, parts, LinearMethod::Direct).expect("contact converges");
        for method in LinearMethod::ALL {
            let Some(solved) = contact(Shape::Hex8, parts, method) else {
                misses.push(format!("{method}, 1/{} m: not converged", 8 * parts));
                continue;
            };
            let differs = apart(&solved.points, &direct.points);
            farthest = farthest.max(differs);
            let peak = memory(Shape::Hex8, parts, method);
            let error = traction_error(&inside(&solved.points), |point| reference(point.x));
            table.push([
                method.to_string(),
                (8 * parts).to_string(),
                solved.unknowns.to_string(),
                solved.newton.to_string(),
                solved.linear.to_string(),
                format!("{error:.3e}"),
                format!("{differs:.0e}"),
                format!("{:.2}", solved.seconds),
                megabytes(peak, |peak| peak.process),
                megabytes(peak, |peak| peak.solve),
                format!("{:.0}", solved.memory as f64 / 1e6),
            ]);
        }
    }
    Finding::new(["nothing".into(), format!("openings of all solvers within {farthest:.0e} b0")])
.text(format!(
            "The same contact with each linear solver on linear hexahedra. The error of the traction against the mesh of 1/{} m is that \
             of the mesh; openings differ between solvers by at most {farthest:.0e} b0. Times are of one run.",
            8 * finest
        ))
.numbers(table)
.missing(misses)
}
