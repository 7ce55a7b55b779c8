//! Units: the same scene in metres and pascals, millimetres and megapascals, kilometres and
//! gigapascals.

use kluft_chart::{Axis, Chart, Series};
use kluft_solver::{
    Discretisation, LinearMethod, Load, NewtonSettings, Problem, Solution, StepRecord, Support,
    SurfaceLoad, System, norm,
};
use lie_core::ClosureKind;

use super::counts::{count, entry, hold_promise};
use crate::methods::plain_newton;
use crate::report::{Effort, Finding, Study, Table, largest};
use crate::scenes::closing::{inclined_joint, three_planes};
use crate::scenes::networks;
use crate::scenes::{self, EXACT};

/// The study.
pub const STUDY: Study = Study {
    name: "units",
    title: "Units",
    subject: "one scene in m and Pa, mm and MPa, km and GPa; units of force over 24 decades",
    run,
};

/// Agreement that the map promises.
const AGREEMENT: f64 = 1e-9;
/// The failing method: stop when the forces out of balance are below this, in the unit at hand.
const ABSOLUTE: f64 = 1e-6;

/// Columns of the table.
const HEAD: [&str; 6] = [
    "scene",
    "units",
    "linear solver",
    "Newton",
    "linear iterations",
    "difference from m and Pa",
];

/// Metres and pascals in one unit.
const SYSTEMS: [(&str, f64, f64); 3] = [
    ("m, Pa", 1.0, 1.0),
    ("mm, MPa", 1e-3, 1e6),
    ("km, GPa", 1e3, 1e9),
];

/// The same problem with other units of length and stress (in metres and pascals).
fn in_units(problem: &Problem, metre: f64, pascal: f64) -> Problem {
    let (length, stress) = (1.0 / metre, 1.0 / pascal);
    let mut other = problem.clone();
    other.mesh.scale(length);
    other
        .rocks
        .iter_mut()
        .for_each(|rock| rock.young_modulus *= stress);
    for fracture in &mut other.fractures {
        let law = &mut fracture.law;
        law.closure.aperture *= length;
        law.closure.normal_stiffness *= stress / length;
        law.shear_stiffness *= stress / length;
        if let ClosureKind::Logarithmic {
            cutoff: Some(cutoff),
        } = &mut law.closure.kind
        {
            *cutoff *= length;
        }
        fracture.fluid_pressure *= stress;
    }
    for condition in &mut other.conditions {
        match &mut condition.load {
            Some(SurfaceLoad::Traction(traction)) => *traction *= stress,
            Some(SurfaceLoad::Pressure(pressure)) => *pressure *= stress,
            None => {}
        }
        if let Some(Support::Displacement(values)) = &mut condition.support {
            values
                .iter_mut()
                .flatten()
                .for_each(|value| *value *= length);
        }
    }
    other
}

/// Largest difference of the jumps and tractions from those in metres and pascals, relative.
fn difference(reference: &Solution, other: &Solution, metre: f64, pascal: f64) -> f64 {
    let pairs = || reference.facet_points.iter().zip(&other.facet_points);
    let jump = largest(pairs().map(|(a, _)| a.jump.length()));
    let traction = largest(pairs().map(|(a, _)| a.traction.length()));
    let apart = pairs().map(|(a, b)| {
        let jumps = a.jump.distance(metre * b.jump) / jump;
        let aperture = (metre * b.aperture / a.aperture - 1.0).abs();
        jumps
            .max(aperture)
            .max(a.traction.distance(pascal * b.traction) / traction)
    });
    largest(apart)
}

fn solved(problem: &Problem, method: Option<LinearMethod>) -> (StepRecord, Solution) {
    let settings = NewtonSettings {
        linear: method,
        ..NewtonSettings::default()
    };
    let (record, solution, _) = scenes::try_solve(problem, settings);
    (record, solution)
}

/// Error that plain Newton with an absolute test of the forces leaves, in a system with this unit
/// of force (N): what a relative test of the same size leaves.
fn absolute_test(problem: &Problem, exact: &Solution, newton: f64) -> f64 {
    let system = System::assemble(problem, Discretisation::of(problem).expect("supported"));
    let settings = NewtonSettings {
        force: ABSOLUTE * newton / norm(&system.load_forces(&Load::proportional(1.0))),
        increment: f64::INFINITY,
        closure: f64::INFINITY,
        ..NewtonSettings::default()
    };
    let (record, solution) = plain_newton::solve(problem, settings);
    if record.converged() {
        difference(exact, &solution, 1.0, 1.0)
    } else {
        f64::NAN
    }
}

/// Every scene in every system with every solver; rows of the table.
fn compare(effort: Effort, table: &mut Table, misses: &mut Vec<String>) -> f64 {
    let draft = scenes::geometry("inclined-joint", &[("h", 0.4)]);
    let mut problems = vec![
        ("three planes", three_planes(EXACT, 20.0)),
        ("inclined joint", inclined_joint(&draft, EXACT, 5.0)),
    ];
    if effort == Effort::Full {
        let network = networks::meshed(&networks::polygons(3), 0.25).expect("a network");
        problems.push(("network, linear", networks::random_problem(network, 3)));
        problems.push((
            "closing blocks",
            scenes::scene_file("closing-blocks", &[("h", 0.4)]),
        ));
    }
    let methods = [
        ("default", None),
        ("direct", Some(LinearMethod::Direct)),
        ("condensed", Some(LinearMethod::Condensed)),
        ("iterative", Some(LinearMethod::Iterative)),
    ];
    let mut worst = 0.0_f64;
    for (scene, problem) in &problems {
        for (solver, method) in methods {
            let (expected, reference) = solved(problem, method);
            for (units, metre, pascal) in SYSTEMS {
                let (record, solution) = solved(&in_units(problem, metre, pascal), method);
                let apart = difference(&reference, &solution, metre, pascal);
                worst = worst.max(apart);
                let name = format!("{scene}, {units}, {solver}");
                hold_promise(misses, &name, &record);
                let counts = [&expected, &record].map(|r| (count(r), r.linear_iterations()));
                if counts[0] != counts[1] {
                    misses.push(format!(
                        "{name}: iterations {:?} instead of {:?}",
                        counts[1], counts[0]
                    ));
                }
                if apart.is_nan() || apart > AGREEMENT {
                    misses.push(format!("{name}: {apart:.1e} apart"));
                }
                table.push([
                    (*scene).to_owned(),
                    units.to_owned(),
                    solver.to_owned(),
                    entry(count(&record)),
                    record.linear_iterations().to_string(),
                    format!("{apart:.2e}"),
                ]);
            }
        }
    }
    worst
}

fn charts(absolute: Vec<(f64, f64)>, ours: Vec<(f64, f64)>) -> Vec<(&'static str, Chart)> {
    vec![(
        "units",
        Chart {
            series: vec![
                Series::line(format!("force test, {ABSOLUTE:e} units"), absolute),
                Series::line("Kluft", ours),
            ],
            failure: "no convergence".into(),
            ..Chart::new(
                "Three crossing planes: what the unit of force does to the answer",
                Axis::logarithmic("unit of force (N)"),
                Axis::logarithmic("error of jumps and tractions (relative)").from(1e-16),
            )
        },
    )]
}

fn run(effort: Effort) -> Finding {
    let mut table = Table::new(&HEAD);
    let mut misses = Vec::new();
    let worst = compare(effort, &mut table, &mut misses);
    // Plain Newton needs a cutoff.
    let kind = ClosureKind::Logarithmic { cutoff: Some(1e-6) };
    let problem = three_planes(kind, 20.0);
    let (_, exact) = solved(&problem, None);
    let step = if effort == Effort::Quick { 8 } else { 1 };
    let units: Vec<f64> = (-9..=15)
        .step_by(step)
        .map(|exponent| 10.0_f64.powi(exponent))
        .collect();
    let absolute = units
        .iter()
        .map(|&unit| (unit, absolute_test(&problem, &exact, unit)));
    let absolute: Vec<(f64, f64)> = absolute.collect();
    let ours = units.iter().map(|&unit| {
        // Newtons in a unit of force are pascals in a unit of stress while lengths are in metres.
        let (_, solution) = solved(&in_units(&problem, 1.0, unit), None);
        (unit, difference(&exact, &solution, 1.0, unit))
    });
    let ours: Vec<(f64, f64)> = ours.collect();
    let wrong = absolute.iter().find(|point| point.1 > 1e-3);
    let hopeless = absolute
        .iter()
        .filter(|point| point.1.is_nan())
        .map(|point| point.0);
    let hopeless = hopeless.fold(0.0, f64::max);
    let wrong = wrong.map_or(f64::NAN, |point| point.0);
    if let Some(point) = ours
        .iter()
        .find(|point| point.1.is_nan() || point.1 > AGREEMENT)
    {
        misses.push(format!(
            "unit of force {:e} N: {:.1e} apart",
            point.0, point.1
        ));
    }
    Finding::new([
        format!(
            "a test of the forces against {ABSOLUTE:e}: never met in units up to {hopeless:e} N, \
             wrong by more than 1e-3 from {wrong:e} N on"
        ),
        format!("the same iterations, the same answer to {worst:.0e}"),
    ])
    .text(format!(
        "A tolerance with a unit means something else in every system of units. With forces out of \
         balance below {ABSOLUTE:e} as the only test, the same scene never converges if the unit \
         of force is {hopeless:e} N or less, and is accepted with apertures or tractions wrong by \
         more than 1e-3 from {wrong:e} N on (km and GPa have a unit of 1e15 N). All tests of Kluft \
         are ratios: in m and Pa, mm and MPa, km and GPa, with every linear solver, it takes the \
         same number of Newton and linear iterations to the same answer, to {worst:.0e}."
    ))
    .charts(charts(absolute, ours))
    .numbers(table)
    .missing(misses)
}
