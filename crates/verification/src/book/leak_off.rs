//! A joint that is filled from one end and loses fluid to the rock.

use kluft_mesh::{Mesh, Shape};
use kluft_solver::{FlowCondition, FlowDrive, FlowPlace, FlowSystem, Leakoff, TransientFlow};

use crate::oracles::diffusion::{half_space, leaking};
use crate::report::{Effort, Finding, Study, largest, percent};
use crate::scenes::flow::{VISCOSITY, apertures, on_side, water};
use crate::scenes::soft_slabs::{equal_steps, extrapolated, strip};

use super::refinement::{Refinement, Shown, largest_left, lowest_order};

pub const PAGE: Study = Study {
    name: "leak-off",
    title: "A joint that loses fluid to the rock",
    subject: "G. C. Howard and C. R. Fast, 1957; H. S. Carslaw and J. C. Jaeger, 1959, section 2.5",
    run,
};

const CLOSED_FORM: &str = "
A joint of aperture b = 1e-4 m and s = b c, c = 4.5e-10 1/Pa, at whose end a pressure p1 = 1e5 Pa stands from the
beginning; through each wall fluid leaks off by C/sqrt(t), C = 1e-9 m/s^0.5:

    D = b^2/(12 mu c)     y = x/(2 sqrt(D t))
    p = p1 erfc(y) - 4 C sqrt(t)/s (1 - exp(-y^2) + sqrt(pi) y erfc(y))
    lost from an area A   4 A C sqrt(t)";

const APERTURE: f64 = 1e-4;
const COMPRESSIBILITY: f64 = 4.5e-10;
const COEFFICIENT: f64 = 1e-9;
const PRESSURE: f64 = 1e5;
const LENGTH: f64 = 10.0;
/// So early that nothing of the end arrives at the other (s).
const END: f64 = 1e-3;

/// What a mesh and steps give.
struct Found {
    places: Vec<f64>,
    pressures: Vec<f64>,
    /// Error of what is lost.
    lost: f64,
    mass_error: f64,
    unknowns: usize,
}

fn flow_of(mesh: &Mesh) -> kluft_solver::Flow {
    let mut flow = water(mesh, vec![on_side(mesh, "side left", PRESSURE)]);
    flow.fluid.compressibility = COMPRESSIBILITY;
    flow.conditions.push(FlowCondition {
        name: "leak-off".into(),
        place: FlowPlace::Fracture(0),
        drive: FlowDrive::Leakoff(Leakoff {
            coefficient: COEFFICIENT,
            varying: None,
            exposed: 0.0,
        }),
        case: 0,
    });
    flow
}

fn found(shape: Shape, n: usize, steps: usize) -> Found {
    let mesh = strip(shape, n, [LENGTH, 1.0], 1.0);
    let flow = flow_of(&mesh);
    let apertures = apertures(&mesh, |_, _| APERTURE);
    let system = FlowSystem::of(&mesh, &flow, &apertures).unwrap_or_else(|d| panic!("{d:?}"));
    let schedule = equal_steps(steps, END);
    let mut transient = TransientFlow::of(&system, &apertures, &schedule, 1.0);
    let states = schedule.steps.iter().map(|step| {
        let solved = transient.step(&schedule, &step.load);
        solved.unwrap_or_else(|failure| panic!("{failure:?}")).state
    });
    let states: Vec<_> = states.collect();
    let end = &states[states.len() - 1];
    let lost = 4.0 * COEFFICIENT * LENGTH * END.sqrt();
    Found {
        places: system
            .nodes()
            .iter()
            .map(|&node| mesh.nodes[node as usize].x)
            .collect(),
        pressures: end.pressures.clone(),
        lost: (-end.entered[1] / lost - 1.0).abs(),
        mass_error: largest(states.iter().map(|state| state.balance.mass_error)),
        unknowns: system.unknown_count(),
    }
}

/// Largest error of a pressure, as a share of that at the end.
fn error(places: &[f64], pressures: &[f64]) -> f64 {
    let stores = APERTURE * COMPRESSIBILITY;
    let diffusivity = APERTURE.powi(3) / (12.0 * VISCOSITY) / stores;
    let fallen = 4.0 * COEFFICIENT * END.sqrt() / stores;
    let pairs = places.iter().zip(pressures);
    let errors = pairs.map(|(&x, found)| {
        let exact = PRESSURE * half_space(diffusivity, x, END);
        let exact = exact - fallen * leaking(diffusivity, x, END);
        (found - exact).abs() / PRESSURE
    });
    largest(errors)
}

const PROBLEM: &str = "A joint in rigid rock, 10 m long, so early that nothing arrives at its other \
    end; far from the inlet its pressure falls by what it loses, to some -2.8 kPa.";

const IN_TIME: Shown = Shown {
    file: "leak-off-time",
    title: "Leak-off: errors over the time step",
    size: "time step over the whole time",
    rate: Some(1.0),
};

const IN_SPACE: Shown = Shown {
    file: "leak-off",
    title: "Leak-off: errors over the size of cells",
    size: "size of cells (m)",
    rate: Some(2.0),
};

fn run(effort: Effort) -> Finding {
    let (cells, steps): (&[usize], &[usize]) = match effort {
        Effort::Quick => (&[40, 80], &[20, 40]),
        Effort::Full => (&[40, 80, 160, 320], &[20, 40, 80, 160, 320]),
    };
    let (most, last) = (cells[cells.len() - 1], steps[steps.len() - 1]);
    let shapes = [Shape::Hex8, Shape::Tet4];
    let mut all = Vec::new();
    let times = shapes.map(|shape| {
        let errors = steps.iter().map(|&count| {
            let found = found(shape, 2 * most, count);
            let error = error(&found.places, &found.pressures);
            all.push(found);
            (1.0 / count as f64, error)
        });
        Refinement::of(format!("{shape:?}"), errors.collect::<Vec<_>>())
    });
    let spaces = shapes.map(|shape| {
        let errors = cells.iter().map(|&n| {
            let [few, many] = [4 * last, 8 * last].map(|count| found(shape, n, count));
            let error = error(&few.places, &extrapolated(&few.pressures, &many.pressures));
            all.extend([few, many]);
            (LENGTH / n as f64, error)
        });
        Refinement::of(format!("{shape:?}"), errors.collect::<Vec<_>>())
    });
    let left = percent(largest_left(&spaces));
    let unknowns = all.iter().map(|found| found.unknowns).max().unwrap_or(0);
    let page = Finding::new([format!("pressures {left}"), unknowns.to_string()])
        .text(PROBLEM)
        .closed_form(CLOSED_FORM, PAGE.subject)
        .text(format!("Ever shorter steps, {} cells along:", 2 * most));
    let (few, many) = (4 * last, 8 * last);
    let page = IN_TIME.on(page, &times).text(format!(
        "Ever finer meshes; pressures extrapolated from {few} and {many} steps:"
    ));
    IN_SPACE.on(page, &spaces).shows(format!(
        "Pressures are of order {:.2} at least in the time step and of order {:.2} at least in the \
         size of the cells; {left} is left at the finest mesh. What is lost is that of the closed \
         form to {:.0e}, whatever the steps, and nodes miss {:.0e} of what moves at most.",
        lowest_order(&times),
        lowest_order(&spaces),
        largest(all.iter().map(|found| found.lost)),
        largest(all.iter().map(|found| found.mass_error))
    ))
}
