//! Slivers: two planes that cross at a small angle.

use glam::{DMat3, DVec3};
use kluft_chart::{Axis, Chart, Series};
use kluft_mesh::Survey;
use kluft_solver::{LinearMethod, NewtonSettings, Problem, Solution, StepRecord};
use lie_core::ClosureKind;

use super::counts::{count, entry, height, hold_promise, most};
use crate::methods::split_nodes;
use crate::oracles::closed_aperture;
use crate::report::{Effort, Finding, Study, Table, largest};
use crate::scenes::networks::{self, Polygon};
use crate::scenes::{self, EXACT, joint};

/// The study.
pub const STUDY: Study = Study {
    name: "slivers",
    title: "Fractures that cross at a small angle",
    subject: "angle between two crossing planes from 90 to 1 degree",
    run,
};

/// Cell size (m) in a cube of 1 m.
const SIZE: f64 = 0.25;
/// Error that the closed form may show: that of Newton's method.
const EXACTLY: f64 = 1e-9;

/// Compression with shear on both planes (Pa).
const STRESS: DMat3 = DMat3::from_cols(
    DVec3::new(-5.0e6, 1.0e6, 0.0),
    DVec3::new(1.0e6, -10.0e6, 0.5e6),
    DVec3::new(0.0, 0.5e6, -2.5e6),
);

/// Two upright planes through the middle of the cube at an angle (degrees).
fn planes(angle: f64) -> Vec<Polygon> {
    let plane = |azimuth: f64| {
        let (sin, cos) = azimuth.to_radians().sin_cos();
        let along = DVec3::new(cos, sin, 0.0);
        let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
        let corner = |(a, b): (f64, f64)| DVec3::splat(0.5) + a * along + b * DVec3::Z;
        Polygon {
            corners: corners.map(corner).to_vec(),
            normal: DVec3::new(-sin, cos, 0.0),
        }
    };
    vec![plane(20.0), plane(20.0 + angle)]
}

/// Numbers of one angle.
struct Case {
    angle: f64,
    /// Of the worst cell, 1 for a regular one.
    quality: f64,
    unknowns: usize,
    /// Largest difference of the jumps from the closed form, over the largest jump.
    closed_form: f64,
    /// Largest difference from split nodes, over the largest displacement.
    split: f64,
    newton: StepRecord,
    iterative: StepRecord,
}

fn uniform(problem: &mut Problem) {
    scenes::load_with_stress(problem, STRESS);
    scenes::fix_rigid_motions(problem, [DVec3::ZERO, DVec3::X, DVec3::Y]);
}

/// How far the jumps are from those of the uniform stress.
fn error(problem: &Problem, solution: &Solution) -> f64 {
    let facets = &problem.mesh.facets;
    let mut differences = Vec::new();
    let mut jumps = Vec::new();
    for (facet, area) in problem.mesh.facet_areas().iter().enumerate() {
        let normal = area.normalize();
        let law = &problem.fractures[facets.fracture[facet] as usize].law;
        let traction = STRESS * normal;
        let across = traction.dot(normal);
        let b0 = law.closure.aperture;
        let q = -across / (law.closure.normal_stiffness * b0);
        let slip = (traction - across * normal) / law.shear_stiffness;
        let jump = b0 * (closed_aperture(q) - 1.0) * normal + slip;
        jumps.push(jump.length());
        for index in facets.elements.range(facet) {
            differences.push(solution.facet_points[index].jump.distance(jump));
        }
    }
    largest(differences) / largest(jumps)
}

/// Says what gmsh or the mesh checks object to, if they do.
fn case(angle: f64) -> Result<Case, String> {
    let draft = networks::meshed(&planes(angle), SIZE).map_err(|defects| format!("{defects:?}"))?;
    let mesh = networks::built(draft.clone());
    let survey = Survey::of(&mesh);
    let quality = survey.quality.of_cell.iter().copied().fold(1.0, f64::min);
    let mut closing = scenes::problem(mesh, joint(EXACT));
    uniform(&mut closing);
    let (newton, solution, _) = scenes::try_solve(&closing, NewtonSettings::default());
    let settings = NewtonSettings {
        linear: Some(LinearMethod::Iterative),
        ..NewtonSettings::default()
    };
    let (iterative, ..) = scenes::try_solve(&closing, settings);
    let mut random = scenes::problem(networks::built(draft), joint(ClosureKind::Linear));
    networks::randomise(&mut random, 7);
    let (split, _) = split_nodes::compare(&random, &scenes::solve(&random));
    Ok(Case {
        angle,
        quality,
        unknowns: solution.displacements.len() * 3,
        closed_form: error(&closing, &solution),
        split,
        newton,
        iterative,
    })
}

fn check(misses: &mut Vec<String>, case: &Case) {
    let name = format!("{} degrees", case.angle);
    hold_promise(misses, &name, &case.newton);
    hold_promise(
        misses,
        &format!("{name}, iterative solver"),
        &case.iterative,
    );
    let off = |error: f64, bound: f64| error.is_nan() || error > bound;
    if off(case.closed_form, EXACTLY) {
        misses.push(format!(
            "{name}: {:.1e} from the closed form",
            case.closed_form
        ));
    }
    if off(case.split, split_nodes::TOLERANCE) {
        misses.push(format!("{name}: {:.1e} from split nodes", case.split));
    }
}

fn table(cases: &[Case]) -> Table {
    let mut table = Table::new(&[
        "angle (degrees)",
        "quality of the worst cell",
        "unknowns",
        "jumps against the closed form",
        "displacements against split nodes",
        "Newton",
        "Newton, iterative solver",
        "linear iterations, iterative solver",
    ]);
    for case in cases {
        table.push([
            case.angle.to_string(),
            format!("{:.4}", case.quality),
            case.unknowns.to_string(),
            format!("{:.2e}", case.closed_form),
            format!("{:.2e}", case.split),
            entry(count(&case.newton)),
            entry(count(&case.iterative)),
            entry(linear(case)),
        ]);
    }
    table
}

fn linear(case: &Case) -> Option<usize> {
    let record = &case.iterative;
    record.converged().then(|| record.linear_iterations())
}

fn curve(cases: &[Case], name: &str, of: impl Fn(&Case) -> f64) -> Series {
    Series::line(
        name,
        cases.iter().map(|case| (case.angle, of(case))).collect(),
    )
}

fn charts(cases: &[Case]) -> Vec<(&'static str, Chart)> {
    let x = || Axis::logarithmic("angle between the planes (degrees)");
    vec![
        (
            "slivers",
            Chart {
                series: vec![
                    curve(cases, "jumps, closed form", |case| case.closed_form),
                    curve(cases, "split nodes", |case| case.split),
                    curve(cases, "quality of the worst cell", |case| case.quality),
                ],
                ..Chart::new(
                    "Two crossing planes: errors, and the worst cell",
                    x(),
                    Axis::logarithmic("error (relative); quality (1 is regular)").from(1e-17),
                )
            },
        ),
        (
            "slivers-iterations",
            Chart {
                series: vec![
                    curve(cases, "multigrid, one load step", |case| {
                        height(linear(case))
                    }),
                    curve(cases, "Newton", |case| height(count(&case.newton))),
                ],
                failure: "no convergence".into(),
                ..Chart::new(
                    "Two crossing planes: iterations",
                    x(),
                    Axis::logarithmic("iterations of one load step"),
                )
            },
        ),
    ]
}

fn run(effort: Effort) -> Finding {
    let angles: &[f64] = match effort {
        Effort::Quick => &[90.0, 5.0],
        Effort::Full => &[90.0, 60.0, 45.0, 30.0, 20.0, 10.0, 5.0, 3.0, 2.0, 1.0],
    };
    let (mut cases, mut misses) = (Vec::new(), Vec::new());
    for &angle in angles {
        match case(angle) {
            Ok(case) => {
                check(&mut misses, &case);
                cases.push(case);
            }
            Err(problem) => misses.push(format!("{angle} degrees: not meshed: {problem}")),
        }
    }
    let (first, last) = (
        cases.first().expect("a mesh"),
        cases.last().expect("a mesh"),
    );
    let worst = |of: fn(&Case) -> f64| largest(cases.iter().map(of));
    let newton = entry(most(cases.iter().map(|case| count(&case.newton))));
    let (closed, split) = (worst(|case| case.closed_form), worst(|case| case.split));
    Finding::new([
        format!(
            "the mesh: the worst cell's quality falls from {:.2} to {:.4} at {}°, and the \
             multigrid takes {} iterations instead of {}",
            first.quality,
            last.quality,
            last.angle,
            entry(linear(last)),
            entry(linear(first))
        ),
        format!(
            "the closed form to {closed:.0e}, split nodes to {split:.0e}; at most {newton} Newton \
             iterations"
        ),
    ])
    .text(format!(
        "Between two planes that cross at a small angle there is room for flat cells only: at {}° \
         the worst has a quality of {:.4} (1 is regular, {:.2} at {}°). Many programs refuse such \
         geometries. Here the answer stays: the jumps of a uniform stress agree with the closed \
         form to {closed:.0e}, displacements under random loads with a formulation on split nodes \
         to {split:.0e}, in at most {newton} Newton iterations. What suffers is the multigrid: {} \
         iterations for the whole step instead of {}. The program takes a direct solver where that \
         is cheaper, `kluft inspect` shows the worst cells, and `kluft network` lists small angles.",
        last.angle,
        last.quality,
        first.quality,
        first.angle,
        entry(linear(last)),
        entry(linear(first))
    ))
    .charts(charts(&cases))
    .numbers(table(&cases))
    .missing(misses)
}
