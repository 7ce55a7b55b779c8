//! A pressure that rises and falls at the end of a joint that stores.

use std::f64::consts::TAU;

use kluft_mesh::Shape;
use lie_core::{Closure, ClosureKind};

use crate::oracles::diffusion::{periodic_inflow, periodic_to_closed_end};
use crate::report::{Effort, Finding, Study, largest, missed, percent};
use crate::scenes::flow::{VISCOSITY, on_side, water};
use crate::scenes::soft_slabs::{DRIVEN, as_given, extrapolated, path, problem, strip, times};

use super::refinement::{Refinement, Shown, largest_left, lowest_order};

pub const PAGE: Study = Study {
    name: "periodic-pressure",
    title: "A pressure that rises and falls at the end of a joint",
    subject: "H. S. Carslaw and J. C. Jaeger, Conduction of Heat in Solids, 1959, section 3.6",
    run,
};

const CLOSED_FORM: &str = "
A joint of aperture b = 1e-4 m stores by the fluid, c = 4.5e-10 1/Pa, and by its stiffness, K_n = 1e11 Pa/m:

    s = b c + 1/K_n     T = b^3/(12 mu)     D = T/s = 8.296001 m2/s     k = sqrt(i w/D)
    p = Re(p1 cosh(k (L - x))/cosh(k L) exp(i w t))         closed at L = 20 m, 2 pi/w = 100 s:
                                                            amplitude 0.6246128 p1 there
    q = Re(p1 T k tanh(k L) exp(i w t))                     amplitude 8.279486e-12 m2/s for 1 Pa";

const APERTURE: f64 = 1e-4;
const STIFFNESS: f64 = 1e11;
const COMPRESSIBILITY: f64 = 4.5e-10;
const LENGTH: f64 = 20.0;
/// So little that apertures hardly change (Pa).
const SWING: f64 = 10.0;
const PERIOD: f64 = 100.0;
/// Periods until what the beginning has left is gone; the last one is compared.
const PERIODS: usize = 4;

/// What a mesh and steps give.
struct Found {
    /// Shares of the way to the closed end.
    places: Vec<f64>,
    /// Cosine and sine of the pressures there, as shares of the swing, one after the other.
    swings: Vec<f64>,
    /// Cosine and sine of what enters (m^3/s).
    inflow: Vec<f64>,
    mass_error: f64,
    unknowns: usize,
}

fn found(shape: Shape, n: usize, steps: usize) -> Found {
    let mesh = strip(shape, n, [LENGTH, 1.0], 1.0);
    let closure = Closure::new(APERTURE, STIFFNESS, ClosureKind::Linear);
    let angle = |step: usize| TAU * step as f64 / steps as f64;
    let time = |step: usize| PERIOD * step as f64 / steps as f64;
    let schedule = times((1..=PERIODS * steps).map(|step| (time(step), angle(step).cos())));
    let problem = problem(&mesh, closure, 0.0, schedule);
    let mut driven = on_side(&mesh, "side left", SWING);
    driven.case = DRIVEN;
    let mut flow = water(&mesh, vec![driven]);
    flow.fluid.compressibility = COMPRESSIBILITY;
    let path = path(&problem, &flow, as_given());
    assert!(path.failed.is_none(), "{:#?}", path.failed);
    let last = path.frames.iter().enumerate();
    let last = last.skip((PERIODS - 1) * steps);
    let last: Vec<_> = last
        .map(|(index, frame)| (angle(index + 1), &frame.flow))
        .collect();
    let share = |of: fn(f64) -> f64, value: &dyn Fn(usize) -> f64| -> f64 {
        let terms = last.iter().enumerate();
        let terms = terms.map(|(index, (angle, _))| of(*angle) * value(index));
        2.0 * terms.sum::<f64>() / steps as f64
    };
    let both = |value: &dyn Fn(usize) -> f64| [share(f64::cos, value), share(f64::sin, value)];
    let rows = 0..path.places.len();
    Found {
        places: path.places.iter().map(|x| x.x / LENGTH).collect(),
        swings: rows
            .flat_map(|row| both(&|index| last[index].1.pressures[row] / SWING))
            .collect(),
        inflow: both(&|index| last[index].1.conditions[0].rate).to_vec(),
        mass_error: path.mass_error(),
        unknowns: path.unknowns,
    }
}

fn transmissivity() -> f64 {
    APERTURE.powi(3) / (12.0 * VISCOSITY)
}

fn diffusivity() -> f64 {
    transmissivity() / (APERTURE * COMPRESSIBILITY + 1.0 / STIFFNESS)
}

fn size([cosine, sine]: [f64; 2]) -> f64 {
    cosine.hypot(sine)
}

/// Largest error of the swings of pressures, and that of what enters as a share of its amplitude.
fn errors(places: &[f64], swings: &[f64], inflow: &[f64]) -> [f64; 2] {
    let number = LENGTH * (TAU / PERIOD / diffusivity()).sqrt();
    let pairs = places.iter().zip(swings.chunks_exact(2));
    let pressures = pairs.map(|(x, found)| {
        let exact = periodic_to_closed_end(number, *x);
        size([found[0] - exact[0], found[1] - exact[1]])
    });
    let exact = periodic_inflow(number).map(|share| share * SWING * transmissivity() / LENGTH);
    let entering = size([inflow[0] - exact[0], inflow[1] - exact[1]]) / size(exact);
    [largest(pressures), entering]
}

const PROBLEM: &str = "A joint 20 m long whose other end is closed; the pressure at its end is a \
    cosine of time. The slabs beside the joint are soft, so that it opens by what its stiffness \
    gives. Compared are cosine and sine of pressures everywhere, and of what enters, in the fourth \
    period.";

const IN_TIME: Shown = Shown {
    file: "periodic-pressure-time",
    title: "A periodic pressure: errors over the time step",
    size: "time step (periods)",
    rate: Some(1.0),
};

const IN_SPACE: Shown = Shown {
    file: "periodic-pressure",
    title: "A periodic pressure: errors over the size of cells",
    size: "1 / cells along",
    rate: Some(2.0),
};

/// Refinements of pressures and of what enters, by sizes with both errors.
fn refinements(shape: Shape, errors: &[(f64, [f64; 2])]) -> [Refinement; 2] {
    let of = |name: &str, which: usize| {
        let own = errors.iter().map(|(size, both)| (*size, both[which]));
        Refinement::of(format!("{name}, {shape:?}"), own.collect::<Vec<_>>())
    };
    [of("pressures", 0), of("inflow", 1)]
}

fn run(effort: Effort) -> Finding {
    let (cells, steps): (&[usize], &[usize]) = match effort {
        Effort::Quick => (&[4, 8], &[40, 80]),
        Effort::Full => (&[8, 16, 32, 64], &[20, 40, 80, 160]),
    };
    let (most, last) = (cells[cells.len() - 1], steps[steps.len() - 1]);
    let shapes = [Shape::Hex8, Shape::Tet4];
    let mut all = Vec::new();
    let times = shapes.map(|shape| {
        let errors = steps.iter().map(|&count| {
            let found = found(shape, most, count);
            let own = errors(&found.places, &found.swings, &found.inflow);
            all.push(found);
            (1.0 / count as f64, own)
        });
        refinements(shape, &errors.collect::<Vec<_>>())
    });
    let spaces = shapes.map(|shape| {
        let errors = cells.iter().map(|&n| {
            let [few, many] = [last, 2 * last].map(|count| found(shape, n, count));
            let swings = extrapolated(&few.swings, &many.swings);
            let inflow = extrapolated(&few.inflow, &many.inflow);
            let own = errors(&few.places, &swings, &inflow);
            all.extend([few, many]);
            (1.0 / n as f64, own)
        });
        refinements(shape, &errors.collect::<Vec<_>>())
    });
    let flat = |all: [[Refinement; 2]; 2]| all.into_iter().flatten().collect::<Vec<_>>();
    let (times, spaces) = (flat(times), flat(spaces));
    let left = percent(largest_left(&spaces));
    let unknowns = all.iter().map(|found| found.unknowns).max().unwrap_or(0);
    let page = Finding::new([format!("pressures, inflow {left}"), unknowns.to_string()])
        .text(PROBLEM)
        .closed_form(CLOSED_FORM, PAGE.subject)
        .text(format!("Ever shorter steps, {most} cells along:"));
    let twice = 2 * last;
    let page = IN_TIME.on(page, &times).text(format!(
        "Ever finer meshes; extrapolated from {last} and {twice} steps a period:"
    ));
    IN_SPACE.on(page, &spaces).shows(format!(
        "Pressures and what enters are of order {:.2} at least in the time step and of order {:.2} \
         at least in the size of the cells; {left} is left at the finest mesh. {}",
        lowest_order(&times),
        lowest_order(&spaces),
        missed(largest(all.iter().map(|found| found.mass_error)))
    ))
}
