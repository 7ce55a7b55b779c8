//! Opening and closing: joints without tension over cycles, and a block that nothing presses.

use glam::DVec3;
use kluft_chart::{Axis, Chart, Series};
use kluft_solver::{Discretisation, NewtonSettings, Problem, Solution, StepRecord};
use lie_core::{Closure, ClosureKind, FractureLaw, Tension};

use super::blocks::{fracture, lifted, stack};
use super::counts::{count, entry, height, hold_promise, most, worst_step};
use super::cycles::hysteresis;
use crate::oracles::closed_aperture;
use crate::report::{Effort, Finding, Study, Table, largest};
use crate::scenes::{self, EXACT, ROCK};

/// The study.
pub const STUDY: Study = Study {
    name: "opening",
    title: "Opening and closing",
    subject: "20 cycles of opening and closing without tension; a floating block, the one above \
              lifted by 1e-9 to 0.1 m",
    run,
};

/// Load factors of a cycle of opening and closing.
const CYCLE: [f64; 8] = [0.0, -0.5, -1.0, -0.5, 0.0, 0.5, 1.0, 0.5];
/// The state of the first cycle that each of a cycle must be.
const SAME: [usize; 8] = [0, 1, 2, 1, 0, 5, 6, 5];
/// Hysteresis that the map allows laws without friction.
const NONE: f64 = 1e-10;
/// Error against closed forms: that of Newton's method.
const EXACTLY: f64 = 1e-9;
/// Movement of the top (m) at load factor 1.
const LIFT: f64 = 1e-3;
/// Stiffness and aperture of the joints (Pa/m, m).
const JOINT: (f64, f64) = (50e9, 1e-4);

fn laws() -> Vec<(&'static str, FractureLaw)> {
    let cut = |kind| Closure {
        tension: Tension::CutOff,
        ..Closure::new(JOINT.1, JOINT.0, kind)
    };
    let hyperbolic = ClosureKind::Hyperbolic {
        max_closure: JOINT.1,
    };
    vec![
        (
            "linear, no tension",
            FractureLaw::elastic(cut(ClosureKind::Linear), 20e9),
        ),
        (
            "logarithmic, no tension",
            FractureLaw::elastic(cut(EXACT), 20e9),
        ),
        (
            "hyperbolic, no tension",
            FractureLaw::elastic(cut(hyperbolic), 20e9),
        ),
        ("contact", FractureLaw::elastic(Closure::contact(0.0), 0.0)),
    ]
}

/// Two blocks; the top goes up and down.
fn pair(law: FractureLaw) -> Problem {
    let mut problem = stack(2, fracture(law));
    scenes::support(&mut problem, "top", lifted(LIFT));
    problem
}

/// Opening of the joint (m) when the top of the column is at `z`, and its traction (Pa): the joint
/// in series with 2 m of rock.
fn closed_form(closure: &Closure, z: f64) -> (f64, f64) {
    if z >= 0.0 {
        return (z, 0.0);
    }
    let rock = ROCK.young_modulus / 2.0;
    let (stiffness, b0) = JOINT;
    let opening = |sigma: f64| match closure.kind {
        ClosureKind::Linear => sigma / stiffness,
        ClosureKind::Logarithmic { .. } => b0 * (closed_aperture(-sigma / stiffness / b0) - 1.0),
        ClosureKind::Hyperbolic { max_closure } => sigma / (stiffness - sigma / max_closure),
        ClosureKind::Contact => 0.0,
        ClosureKind::Own(_) => unreachable!("no column here has such a law"),
    };
    let (mut low, mut high) = (rock * z, 0.0);
    for _ in 0..200 {
        let sigma = 0.5 * (low + high);
        if opening(sigma) + sigma / rock < z {
            low = sigma;
        } else {
            high = sigma;
        }
    }
    let sigma = 0.5 * (low + high);
    (opening(sigma), sigma)
}

/// Largest error of opening and traction against the closed form, over the largest of the cycle.
fn error(closure: &Closure, load: f64, solution: &Solution) -> f64 {
    let (opening, traction) = closed_form(closure, load * LIFT);
    let strongest = closed_form(closure, -LIFT).1;
    largest(solution.facet_points.iter().map(|point| {
        let apart = (point.opening - opening).abs() / LIFT;
        apart.max(((point.normal_traction - traction) / strongest).abs())
    }))
}

/// One law over all cycles.
struct Case {
    name: &'static str,
    records: Vec<StepRecord>,
    error: f64,
    hysteresis: Vec<f64>,
}

fn case(name: &'static str, law: FractureLaw, cycles: usize) -> Case {
    let problem = pair(law);
    let loads = (0..cycles).flat_map(|_| CYCLE);
    let path = scenes::solve_path(&problem, NewtonSettings::default(), loads.clone());
    let (records, solutions): (Vec<_>, Vec<_>) = path.into_iter().unzip();
    let errors = loads.zip(&solutions);
    Case {
        name,
        records,
        error: largest(errors.map(|(load, found)| error(&law.closure, load, found))),
        hysteresis: hysteresis(&solutions, &SAME),
    }
}

/// Three blocks of which the top one is lifted by `lift` (m) away from the second, which only its
/// weight holds: the records, and the error of the weight that the lower joint carries.
fn floating(law: FractureLaw, lift: f64) -> (Vec<StepRecord>, f64) {
    let records = rested(law, lift).0;
    // A joint with shear stiffness pushes as it lets go of it, so the weight is compared without.
    let smooth = FractureLaw {
        shear_stiffness: 0.0,
        ..law
    };
    (records, rested(smooth, lift).1)
}

/// The steps of a block that rests on its weight, and the largest error of what its joint carries.
fn rested(law: FractureLaw, lift: f64) -> (Vec<StepRecord>, f64) {
    let mut problem = stack(3, fracture(law));
    scenes::support(&mut problem, "top", lifted(lift));
    problem.rocks[0].density = 2700.0;
    problem.gravity = DVec3::new(0.0, 0.0, -9.81);
    let loads = [0.5, 1.0, 0.5, 0.1];
    let path = scenes::solve_path(&problem, NewtonSettings::default(), loads);
    let interface = Discretisation::of(&problem)
        .expect("supported")
        .into_interface();
    let (mut records, mut errors) = (Vec::new(), Vec::new());
    for (load, (record, solution)) in loads.into_iter().zip(path) {
        let points = interface.points().iter().zip(&solution.facet_points);
        let lower = points.filter(|(point, _)| point.position.z < 1.5);
        let carried: f64 = lower
            .map(|(point, found)| point.area * found.normal_traction)
            .sum();
        errors.push((carried / (-2700.0 * 9.81 * load) - 1.0).abs());
        records.push(record);
    }
    (records, largest(errors))
}

/// What a table and the misses say of a case.
fn note(
    table: &mut Table,
    misses: &mut Vec<String>,
    [law, what]: [&str; 2],
    records: &[StepRecord],
    [error, hysteresis]: [f64; 2],
) {
    let worst = worst_step(records);
    let place = format!("{law}, {what}");
    hold_promise(misses, &place, worst);
    for (name, value, bound) in [("error", error, EXACTLY), ("hysteresis", hysteresis, NONE)] {
        // What a step that failed leaves is no result.
        if worst.converged() && (value.is_nan() || value > bound) {
            misses.push(format!("{place}: {name} {value:.1e}"));
        }
    }
    table.push([
        law.to_owned(),
        what.to_owned(),
        entry(most(records.iter().map(count))),
        format!("{error:.2e}"),
        format!("{hysteresis:.2e}"),
    ]);
}

/// The floating block over eight decades of lift, for all laws; curves for a chart.
fn lifts(effort: Effort, table: &mut Table, misses: &mut Vec<String>) -> Vec<Series> {
    let exponents = match effort {
        Effort::Quick => vec![-3],
        Effort::Full => (-9..=-1).collect(),
    };
    let mut all = Vec::new();
    for (name, law) in laws() {
        let mut points = Vec::new();
        for &exponent in &exponents {
            let lift = 10.0_f64.powi(exponent);
            let (records, error) = floating(law, lift);
            let what = format!("floating block, lifted by {lift:e} m");
            note(table, misses, [name, &what], &records, [error, 0.0]);
            points.push((lift, height(most(records.iter().map(count)))));
        }
        all.push(Series::line(name, points));
    }
    all
}

fn charts(cases: &[Case], lifts: &[Series]) -> Vec<(&'static str, Chart)> {
    let series = |case: &Case| {
        let points = case.hysteresis.iter().enumerate();
        let points = points.map(|(cycle, value)| (cycle as f64 + 1.0, *value));
        Series::line(case.name, points.collect())
    };
    vec![
        (
            "floating",
            Chart {
                series: lifts.to_vec(),
                failure: "no convergence".into(),
                ..Chart::new(
                    "A block that floats between an open and a closed joint: iterations",
                    Axis::logarithmic("lift of the block above (m); b0 is 10⁻⁴ m"),
                    Axis::linear("most Newton iterations of a step"),
                )
            },
        ),
        (
            "opening",
            Chart {
                series: cases.iter().map(series).collect(),
                ..Chart::new(
                    "Opening and closing without tension: hysteresis",
                    Axis::linear("cycle"),
                    Axis::logarithmic("difference from the first cycle (relative)").from(1e-17),
                )
            },
        ),
    ]
}

/// All laws over all cycles, noted in the table and the misses.
fn cases(cycles: usize, misses: &mut Vec<String>) -> (Vec<Case>, Table) {
    let mut table = Table::new(&[
        "law",
        "case",
        "most Newton iterations of a step",
        "error against the closed form",
        "hysteresis",
    ]);
    let mut cases = Vec::new();
    for (name, law) in laws() {
        let case = case(name, law, cycles);
        let hysteresis = largest(case.hysteresis.iter().copied());
        let what = format!("{cycles} cycles");
        let numbers = [case.error, hysteresis];
        note(&mut table, misses, [name, &what], &case.records, numbers);
        cases.push(case);
    }
    (cases, table)
}

fn run(effort: Effort) -> Finding {
    let cycles = if effort == Effort::Quick { 2 } else { 20 };
    let mut misses = Vec::new();
    let (cases, mut table) = cases(cycles, &mut misses);
    let lifts = lifts(effort, &mut table, &mut misses);
    let floats = || lifts.iter().flat_map(|series| &series.points);
    let failed = floats().filter(|point| point.1.is_nan()).count();
    let slowest = floats()
        .map(|point| point.1)
        .filter(|count| count.is_finite());
    let slowest = slowest.fold(0.0, f64::max);
    let of_all = floats().count();
    let newton = entry(most(
        cases.iter().flat_map(|case| case.records.iter().map(count)),
    ));
    let error = largest(cases.iter().map(|case| case.error));
    let hysteresis = largest(
        cases
            .iter()
            .flat_map(|case| case.hysteresis.iter().copied()),
    );
    let pull = LIFT / (1.0 / JOINT.0 + 2.0 / ROCK.young_modulus);
    Finding::new([
        "a law with tension where there is none: the joint would pull the blocks back".to_owned(),
        format!(
            "closed forms to {error:.0e}, hysteresis {hysteresis:.0e}, at most {newton} iterations \
             a step; {failed} of {of_all} floating blocks fail"
        ),
    ])
    .text(format!(
        "Contact that opens and closes makes methods cycle between two states. Two blocks are \
         pressed together and pulled apart by 1 mm, where a linear law with tension would hold \
         them back by {:.0} MPa, {cycles} times, with `tension_cutoff` (linear, logarithmic, \
         hyperbolic) and with `contact`: openings and tractions follow the closed form (a joint in \
         series with 2 m of rock; none once open) to {error:.0e}, cycles repeat to \
         {hysteresis:.0e}, steps take at most {newton} iterations. A block between two joints, the \
         upper one lifted off by 1e-9 to 0.1 m, floats on the lower one by its weight alone: \
         {failed} of {of_all} such cases fail, the others take up to {slowest} iterations a step.",
        1e-6 * pull
    ))
    .charts(charts(&cases, &lifts))
    .numbers(table)
    .missing(misses)
}
