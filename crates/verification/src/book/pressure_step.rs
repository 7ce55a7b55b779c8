//! A pressure that rises at the end of a stiff joint: diffusion into a half space and to a closed
//! end.

use kluft_mesh::Shape;
use lie_core::{Closure, ClosureKind};

use crate::oracles::diffusion::{half_space, taken_up, to_closed_end};
use crate::report::{Effort, Finding, Study, largest, missed, percent};
use crate::scenes::flow::{VISCOSITY, on_side, water};
use crate::scenes::soft_slabs::{self, as_given, equal_steps, path, problem, strip};

use super::refinement::{Refinement, Shown, largest_left, lowest_order};

pub const PAGE: Study = Study {
    name: "pressure-step",
    title: "A pressure that rises at the end of a stiff joint",
    subject: "H. S. Carslaw and J. C. Jaeger, Conduction of Heat in Solids, 1959",
    run,
};

const CLOSED_FORM: &str = "
A joint of aperture b = 1e-4 m stores by the fluid, c = 4.5e-10 1/Pa, and hardly by its stiffness, K_n = 1e14 Pa/m:

    s = b c + 1/K_n     D = b^3/(12 mu s)
    half space          p = p1 erfc(x/(2 sqrt(D t)))
    closed at L = 2 m   p = p1 (1 - sum 2 (-1)^n/k_n exp(-k_n^2 D t/L^2) cos(k_n (1 - x/L))),  k_n = (n + 1/2) pi
                        at the closed end, D t/L^2 = 0.1, 0.2, 0.5, 1:  0.05069464, 0.2276884, 0.6292226, 0.8920230
                        taken up at 0.1 of what is taken up in the end: 0.3568234";

const APERTURE: f64 = 1e-4;
const STIFFNESS: f64 = 1e14;
const COMPRESSIBILITY: f64 = 4.5e-10;
/// So little that apertures and density hardly change (Pa).
const STEP: f64 = 2e4;
const LENGTH: f64 = 2.0;
/// `D t / L^2` at the end.
const CLOSED_TIME: f64 = 0.1;
/// The same of a joint so long that nothing arrives at its other end.
const OPEN_TIME: f64 = 5e-3;

fn stores() -> f64 {
    APERTURE * COMPRESSIBILITY + 1.0 / STIFFNESS
}

fn diffusivity() -> f64 {
    APERTURE.powi(3) / (12.0 * VISCOSITY) / stores()
}

/// What equal steps to a time `D t / L^2` lead to.
struct Reached {
    /// Places (m) and pressures there, as shares of the step.
    places: Vec<f64>,
    pressures: Vec<f64>,
    /// What has entered, as a share of what enters in the end.
    taken: f64,
    mass_error: f64,
    unknowns: usize,
}

fn reached(n: usize, steps: usize, time: f64) -> Reached {
    let mesh = strip(Shape::Hex8, n, [LENGTH, 1.0], 1.0);
    let closure = Closure::new(APERTURE, STIFFNESS, ClosureKind::Linear);
    let end = time * LENGTH * LENGTH / diffusivity();
    let problem = problem(&mesh, closure, 0.0, equal_steps(steps, end));
    let mut flow = water(&mesh, vec![on_side(&mesh, "side left", STEP)]);
    flow.fluid.compressibility = COMPRESSIBILITY;
    let path = path(&problem, &flow, as_given());
    let end = path.end();
    Reached {
        places: path.places.iter().map(|x| x.x).collect(),
        pressures: end.flow.pressures.iter().map(|p| p / STEP).collect(),
        taken: end.flow.entered[0] / (LENGTH * stores() * STEP),
        mass_error: path.mass_error(),
        unknowns: path.unknowns,
    }
}

/// The same with twice as many steps, the error of the steps extrapolated away.
fn extrapolated(n: usize, steps: usize, time: f64) -> Reached {
    let [few, many] = [steps, 2 * steps].map(|steps| reached(n, steps, time));
    Reached {
        pressures: soft_slabs::extrapolated(&few.pressures, &many.pressures),
        taken: 2.0 * many.taken - few.taken,
        mass_error: few.mass_error.max(many.mass_error),
        ..many
    }
}

/// Largest error of a pressure, as a share of the step.
fn off(reached: &Reached, exact: impl Fn(f64) -> f64) -> f64 {
    let found = reached.places.iter().zip(&reached.pressures);
    largest(found.map(|(x, pressure)| (pressure - exact(*x)).abs()))
}

/// Errors of pressures and of what was taken up, to the closed end; of pressures in the half space.
struct Errors {
    errors: [f64; 3],
    mass_error: f64,
    unknowns: usize,
}

fn errors(of: impl Fn(f64) -> Reached) -> Errors {
    let [closed, open] = [CLOSED_TIME, OPEN_TIME].map(of);
    let time = OPEN_TIME * LENGTH * LENGTH / diffusivity();
    Errors {
        errors: [
            off(&closed, |x| to_closed_end(x / LENGTH, CLOSED_TIME)),
            (closed.taken / taken_up(CLOSED_TIME) - 1.0).abs(),
            off(&open, |x| half_space(diffusivity(), x, time)),
        ],
        mass_error: closed.mass_error.max(open.mass_error),
        unknowns: closed.unknowns,
    }
}

const NAMES: [&str; 3] = [
    "pressures, closed",
    "taken up, closed",
    "pressures, half space",
];

fn refinements(cases: &[(f64, Errors)]) -> Vec<Refinement> {
    let names = NAMES.into_iter().enumerate();
    let of = |(which, name): (usize, &str)| {
        let errors = cases.iter().map(|(size, case)| (*size, case.errors[which]));
        Refinement::of(name, errors)
    };
    names.map(of).collect()
}

const PROBLEM: &str = "A joint of hexahedra, 2 m long, whose other end is closed, and the same for \
    so short a time that nothing arrives there. The pressure of 20 kPa stands from the beginning.";

const IN_TIME: Shown = Shown {
    file: "pressure-step-time",
    title: "A pressure that rises: errors over the time step",
    size: "time step over the whole time",
    rate: Some(1.0),
};

const IN_SPACE: Shown = Shown {
    file: "pressure-step",
    title: "A pressure that rises: errors over the size of cells",
    size: "size of cells (m)",
    rate: Some(2.0),
};

fn run(effort: Effort) -> Finding {
    let (cells, steps): (&[usize], &[usize]) = match effort {
        Effort::Quick => (&[16, 32], &[10, 20]),
        Effort::Full => (&[16, 32, 64, 128], &[10, 20, 40, 80, 160]),
    };
    let (most, last) = (cells[cells.len() - 1], steps[steps.len() - 1]);
    let in_time = steps.iter().map(|&steps| {
        let errors = errors(|time| reached(2 * most, steps, time));
        (1.0 / steps as f64, errors)
    });
    let in_time: Vec<_> = in_time.collect();
    let in_space = cells.iter().map(|&n| {
        let errors = errors(|time| extrapolated(n, last, time));
        (LENGTH / n as f64, errors)
    });
    let in_space: Vec<_> = in_space.collect();
    let all = || in_time.iter().chain(&in_space).map(|(_, case)| case);
    let unknowns = all().map(|case| case.unknowns).max().unwrap_or(0);
    let (times, spaces) = (refinements(&in_time), refinements(&in_space));
    let left = percent(largest_left(&spaces));
    let page = Finding::new([format!("pressures, volumes {left}"), unknowns.to_string()])
        .text(PROBLEM)
        .closed_form(CLOSED_FORM, PAGE.subject)
        .text(format!("Ever shorter steps, {} cells along:", 2 * most));
    let twice = 2 * last;
    let page = IN_TIME.on(page, &times).text(format!(
        "Ever finer meshes; extrapolated from {last} and {twice} steps:"
    ));
    IN_SPACE.on(page, &spaces).shows(format!(
        "Pressures and volumes are of order {:.2} at least in the time step, and of order {:.2} at \
         least in the size of the cells; {left} is left at the finest mesh. {}",
        lowest_order(&times),
        lowest_order(&spaces),
        missed(largest(all().map(|case| case.mass_error)))
    ))
}
