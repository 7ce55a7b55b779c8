//! Sticking and sliding: friction over cycles, and a wedge between two joints.

use glam::DVec3;
use kluft_chart::{Axis, Chart, Series};
use kluft_solver::{
    Discretisation, Field, InitialStress, NewtonSettings, Problem, Profile, Solution, StepRecord,
    Support,
};
use lie_core::{Closure, ClosureKind, FractureLaw, Friction};

use super::blocks::{fracture, stack, wedge};
use super::counts::{
    count, entry, height, hold_promise, hold_promise_with_friction, most, worst_step,
};
use super::cycles::hysteresis;
use super::steps::difference;
use crate::report::{Effort, Finding, Study, Table, largest};
use crate::scenes::{self, EXACT};

/// The study.
pub const STUDY: Study = Study {
    name: "sliding",
    title: "Sticking and sliding",
    subject: "10 cycles of shear with friction; wedges of 5 to 40 degrees between two joints",
    run,
};

/// Load factors of a cycle of shear.
const CYCLE: [f64; 4] = [1.0, 0.0, -1.0, 0.0];
/// Normal stress (Pa), there before any load.
const NORMAL: f64 = -5e6;
/// Movement of the top along x (m) at load factor 1: most of it slips.
const SHIFT: f64 = 2e-3;
/// Friction coefficient.
const FRICTION: f64 = 0.6;
/// How far a shear traction may be beyond the limit, over the limit: Newton's error.
const ADMISSIBLE: f64 = 1e-9;
/// How far equilibrium of the wedge may be off.
const BALANCED: f64 = 1e-9;

fn rubbing(closure: Closure, shear_stiffness: f64, dilation: f64) -> FractureLaw {
    FractureLaw {
        closure,
        shear_stiffness,
        friction: Some(Friction {
            coefficient: FRICTION,
            cohesion: 0.0,
            dilation,
        }),
    }
}

fn laws() -> [(&'static str, FractureLaw); 5] {
    let closure = |kind| Closure::new(1e-4, 50e9, kind);
    [
        ("linear", rubbing(closure(ClosureKind::Linear), 20e9, 0.0)),
        ("logarithmic", rubbing(closure(EXACT), 20e9, 0.0)),
        (
            "logarithmic, rigid shear",
            rubbing(closure(EXACT), f64::INFINITY, 0.0),
        ),
        ("logarithmic, dilating", rubbing(closure(EXACT), 20e9, 0.1)),
        (
            "contact",
            rubbing(Closure::contact(0.0), f64::INFINITY, 0.0),
        ),
    ]
}

/// A shear box: two blocks, pressed together from the start, the upper one pushed to and fro.
fn shear_box(law: FractureLaw) -> Problem {
    let mut problem = stack(2, fracture(law));
    let former = ["left", "bottom"].map(|name| scenes::boundary(&problem, name));
    problem
        .conditions
        .retain(|condition| !former.contains(&condition.boundary));
    let held = |x| Support::Displacement([Some(x), None, Some(0.0)]);
    scenes::support(&mut problem, "bottom", held(0.0));
    scenes::support(&mut problem, "top", held(SHIFT));
    let mut components = [Profile::default(); 6];
    components[2].value = NORMAL;
    problem.initial_stress = Some(InitialStress {
        components: components.map(Field::from),
    });
    problem
}

/// Largest shear traction beyond what friction allows, over the largest limit.
fn beyond_limit(solution: &Solution) -> f64 {
    let points = || solution.facet_points.iter();
    let limit = largest(points().map(|point| FRICTION * point.normal_traction.abs()));
    let excess = points().map(|point| {
        let across = point.normal_traction;
        let shear = (point.traction.length_squared() - across * across)
            .max(0.0)
            .sqrt();
        (shear + FRICTION * across.min(0.0)).max(0.0)
    });
    largest(excess) / limit
}

/// One law over all cycles of shear.
struct Case {
    name: &'static str,
    records: Vec<StepRecord>,
    beyond: f64,
    /// Of each cycle after the first against the second.
    hysteresis: Vec<f64>,
}

fn case(name: &'static str, law: FractureLaw, cycles: usize) -> Case {
    let problem = shear_box(law);
    let loads = (0..cycles).flat_map(|_| CYCLE);
    let path = scenes::solve_path(&problem, NewtonSettings::default(), loads);
    let (records, solutions): (Vec<_>, Vec<_>) = path.into_iter().unzip();
    Case {
        name,
        records,
        beyond: largest(solutions.iter().map(beyond_limit)),
        hysteresis: hysteresis(&solutions[CYCLE.len()..], &[0, 1, 2, 3]),
    }
}

/// There and back in so many steps each, divided by the program or not: iterations in all, and the
/// state in the end.
fn there_and_back(law: FractureLaw, steps: usize, divided: bool) -> (Option<usize>, Solution) {
    let share = |step: usize| step as f64 / steps as f64;
    let there = (1..=steps).map(share);
    let back = (1..=steps).map(|step| 1.0 - 2.0 * share(step));
    let mut settings = NewtonSettings::default();
    if !divided {
        settings.path = f64::INFINITY;
    }
    let path = scenes::solve_path(&shear_box(law), settings, there.chain(back));
    let (records, solutions): (Vec<_>, Vec<_>) = path.into_iter().unzip();
    let counts = records.iter().map(count);
    let all = counts.sum::<Option<usize>>();
    (all, solutions.into_iter().next_back().expect("a step"))
}

/// What dividing the steps costs and brings: errors over the iterations, against many small steps.
fn paths(effort: Effort) -> Vec<Series> {
    let (finest, steps): (usize, &[usize]) = match effort {
        Effort::Quick => (16, &[1, 4]),
        Effort::Full => (512, &[1, 2, 4, 8, 16, 32, 64]),
    };
    let [(_, law), ..] = laws();
    let (_, reference) = there_and_back(law, finest, false);
    let curve = |name: &str, divided: bool| {
        let point = |&steps: &usize| {
            let (count, end) = there_and_back(law, steps, divided);
            (height(count), difference(&reference, &end))
        };
        Series::line(name, steps.iter().map(point).collect())
    };
    vec![
        curve("steps as given", false),
        curve("divided, Kluft", true),
    ]
}

/// A wedge pressed between two joints, without friction and with it: records, how far the joints
/// are from carrying the load, and shear beyond the limit of friction.
fn wedged(angle: f64, rubs: bool) -> (StepRecord, f64, f64) {
    let pressure = 5e6;
    let law = if rubs {
        rubbing(Closure::contact(0.0), f64::INFINITY, 0.0)
    } else {
        FractureLaw::elastic(Closure::contact(0.0), 0.0)
    };
    let problem = wedge(fracture(law), angle, pressure);
    let (record, solution, _) = scenes::try_solve(&problem, NewtonSettings::default());
    let interface = Discretisation::of(&problem)
        .expect("supported")
        .into_interface();
    // What the joints do to the wedge: plus or minus the traction, by the side it is on.
    let middle = |point: DVec3| if point.x < 1.5 { 1.0 } else { -1.0 };
    let pairs = interface.points().iter().zip(&solution.facet_points);
    let carried: DVec3 = pairs
        .map(|(point, found)| {
            let side = middle(point.position) * point.normal.x.signum();
            side * point.area * found.traction
        })
        .sum();
    let top = area_of_top(&problem);
    let error = (carried.z.abs() / (pressure * top) - 1.0).abs();
    let beyond = if rubs { beyond_limit(&solution) } else { 0.0 };
    (record, error, beyond)
}

fn area_of_top(problem: &Problem) -> f64 {
    let top = &problem.mesh.boundaries[scenes::boundary(problem, "top")].elements;
    let area = |facet| kluft_mesh::facet_area_vector(&problem.mesh.corners(top, facet)).length();
    (0..top.len()).map(area).sum()
}

/// Most iterations of one part of a step.
fn most_of_part(records: &[StepRecord]) -> usize {
    let parts = records.iter().flat_map(|record| &record.substeps);
    parts.copied().max().unwrap_or(0)
}

/// Rows of the wedges, and the counts for the chart.
fn wedges(effort: Effort, table: &mut Table, misses: &mut Vec<String>) -> Vec<Series> {
    let angles: &[f64] = match effort {
        Effort::Quick => &[20.0],
        Effort::Full => &[5.0, 10.0, 15.0, 20.0, 25.0, 30.0, 35.0, 40.0],
    };
    let mut all = Vec::new();
    for (rubs, name) in [(false, "without friction"), (true, "with friction")] {
        let mut points = Vec::new();
        for &angle in angles {
            let (record, error, beyond) = wedged(angle, rubs);
            let case = format!("wedge of {angle} degrees {name}");
            if rubs {
                hold_promise_with_friction(misses, &case, &record);
            } else {
                hold_promise(misses, &case, &record);
            }
            for (what, value, bound) in
                [("balance", error, BALANCED), ("limit", beyond, ADMISSIBLE)]
            {
                if value.is_nan() || value > bound {
                    misses.push(format!("{case}: {what} off by {value:.1e}"));
                }
            }
            points.push((angle, height(count(&record))));
            table.push([
                case,
                String::new(),
                entry(count(&record)),
                record.substeps.len().to_string(),
                most_of_part(std::slice::from_ref(&record)).to_string(),
                format!("{beyond:.2e}"),
                format!("{error:.2e}"),
            ]);
        }
        all.push(Series::line(name, points));
    }
    all
}

fn charts(cases: &[Case], paths: Vec<Series>, wedges: Vec<Series>) -> Vec<(&'static str, Chart)> {
    let series = |case: &Case| {
        let of_cycle = |(cycle, records): (usize, &[StepRecord])| {
            (cycle as f64 + 1.0, height(most(records.iter().map(count))))
        };
        let chunks = case.records.chunks(CYCLE.len()).enumerate();
        Series::line(case.name, chunks.map(of_cycle).collect())
    };
    vec![
        (
            "sliding",
            Chart {
                series: cases.iter().map(series).collect(),
                failure: "no convergence".into(),
                ..Chart::new(
                    "Shear to and fro: most iterations of a step, all parts together",
                    Axis::linear("cycle"),
                    Axis::linear("Newton iterations"),
                )
            },
        ),
        (
            "sliding-path",
            Chart {
                series: paths,
                failure: "no convergence".into(),
                front: true,
                ..Chart::new(
                    "There and back in 1 to 64 steps each: error over cost",
                    Axis::logarithmic("Newton iterations in all"),
                    Axis::logarithmic("error of jumps and tractions (relative)").from(1e-12),
                )
            },
        ),
        (
            "wedge",
            Chart {
                series: wedges,
                failure: "no convergence".into(),
                ..Chart::new(
                    "A wedge between two joints in contact",
                    Axis::linear("angle of the flanks (degrees)"),
                    Axis::linear("Newton iterations"),
                )
            },
        ),
    ]
}

/// All laws over all cycles of shear, noted in the table and the misses.
fn shear(cycles: usize) -> (Vec<Case>, Table, Vec<String>) {
    let mut misses = Vec::new();
    let mut table = Table::new(&[
        "case",
        "cycle",
        "most Newton iterations of a step",
        "most parts of a step",
        "most iterations of a part",
        "shear beyond the limit",
        "difference from the second cycle; of the wedge, balance",
    ]);
    let mut cases = Vec::new();
    for (name, law) in laws() {
        let case = case(name, law, cycles);
        let place = format!("shear, {name}, worst step");
        hold_promise_with_friction(&mut misses, &place, worst_step(&case.records));
        if case.beyond.is_nan() || case.beyond > ADMISSIBLE {
            misses.push(format!(
                "shear, {name}: {:.1e} beyond the limit",
                case.beyond
            ));
        }
        for (cycle, records) in case.records.chunks(CYCLE.len()).enumerate() {
            let repeats = cycle.checked_sub(1).map(|before| case.hysteresis[before]);
            table.push([
                name.to_owned(),
                (cycle + 1).to_string(),
                entry(most(records.iter().map(count))),
                entry(most(
                    records.iter().map(|record| Some(record.substeps.len())),
                )),
                most_of_part(records).to_string(),
                format!("{:.2e}", case.beyond),
                repeats.map_or(String::new(), |value| format!("{value:.2e}")),
            ]);
        }
        cases.push(case);
    }
    (cases, table, misses)
}

fn run(effort: Effort) -> Finding {
    let cycles = if effort == Effort::Quick { 3 } else { 10 };
    let (cases, mut table, mut misses) = shear(cycles);
    let wedges = wedges(effort, &mut table, &mut misses);
    let newton = entry(most(
        cases.iter().flat_map(|case| case.records.iter().map(count)),
    ));
    let part = cases
        .iter()
        .map(|case| most_of_part(&case.records))
        .max()
        .unwrap_or(0);
    let repeats = largest(
        cases
            .iter()
            .filter(|case| !case.name.ends_with("dilating"))
            .flat_map(|case| case.hysteresis.iter().copied()),
    );
    let beyond = largest(cases.iter().map(|case| case.beyond));
    let paths = paths(effort);
    let coarsest = |series: &Series| series.points[0];
    let (given, divided) = (coarsest(&paths[0]), coarsest(&paths[1]));
    Finding::new([
        format!(
            "steps taken as given: jumps and tractions wrong by {:.0e} after one step there and \
             one back, {:.0e} if the program divides them",
            given.1, divided.1
        ),
        format!(
            "at most {newton} iterations a step of shear, all its parts together; shear beyond the \
             limit {beyond:.0e}"
        ),
    ])
    .text(format!(
        "Friction makes the way matter: a step from one side to the other in one go is wrong by \
         {:.1e} of the largest jump or traction, though it converges in {} iterations. Kluft walks \
         each part of a step in one go and in two, and divides it where they differ: wrong by \
         {:.1e}, for {} iterations. A shear box under 5 MPa is pushed to and fro by 2 mm, {cycles} \
         times, with five laws: a step takes at most {newton} iterations in all its parts, one \
         part at most {part}; shear stays within the limit of friction to {beyond:.0e}, and from \
         the second cycle on the loop repeats to {repeats:.0e} (without dilation, which never goes \
         back). A wedge pressed between two joints is held by them at every angle, with friction \
         and without.",
        given.1, given.0, divided.1, divided.0
    ))
    .charts(charts(&cases, paths, wedges))
    .numbers(table)
    .missing(misses)
}
