//! A borehole that begins to feed a joint that stores: Theis' solution.

use std::f64::consts::TAU;

use kluft_mesh::Shape;
use lie_core::{Closure, ClosureKind};

use crate::oracles::diffusion::theis;
use crate::report::{Effort, Finding, Study, largest, missed, percent};
use crate::scenes::flow::{VISCOSITY, fed_from_side, water};
use crate::scenes::soft_slabs::{
    SECTOR, as_given, equal_steps, extrapolated, logarithmic, path, problem, sector,
};

use super::refinement::{Refinement, Shown, largest_left, lowest_order};

pub const PAGE: Study = Study {
    name: "line-source",
    title: "A borehole that begins to feed a joint",
    subject: "C. V. Theis, Transactions AGU 16, 1935",
    run,
};

const CLOSED_FORM: &str = "
A joint of aperture b = 1e-4 m stores by the fluid, c = 4.5e-10 1/Pa, and by its stiffness, K_n = 1e11 Pa/m:

    s = b c + 1/K_n     T = b^3/(12 mu)     D = T/s = 8.296001 m2/s
    p = Q/(4 pi T) E_1(r^2/(4 D t))         Q = 1e-6 m3/s, t = 1 s, r = 1, 2, 5, 10 m:
                                            2821.590, 1580.944, 322.9797, 12.24826 Pa";

const APERTURE: f64 = 1e-4;
const STIFFNESS: f64 = 1e11;
const COMPRESSIBILITY: f64 = 4.5e-10;
/// So little that apertures hardly change (m^3/s).
const RATE: f64 = 1e-8;
/// Of the hole and of the end of the mesh (m).
const RADII: [f64; 2] = [0.01, 40.0];
const END: f64 = 1.0;

/// What a mesh and steps give.
struct Found {
    /// Radii (m) from 1 m on, and pressures there (Pa).
    radii: Vec<f64>,
    pressures: Vec<f64>,
    mass_error: f64,
    unknowns: usize,
}

fn found(shape: Shape, n: usize, steps: usize) -> Found {
    let mesh = sector(shape, n, logarithmic(RADII));
    let closure = Closure::new(APERTURE, STIFFNESS, ClosureKind::Linear);
    let problem = problem(&mesh, closure, 0.0, equal_steps(steps, END));
    let rate = RATE * SECTOR / TAU;
    let mut flow = water(&mesh, vec![fed_from_side(&mesh, "side left", rate)]);
    flow.fluid.compressibility = COMPRESSIBILITY;
    let path = path(&problem, &flow, as_given());
    let pressures = path.places.iter().zip(&path.end().flow.pressures);
    let pressures = pressures.map(|(x, pressure)| (x.truncate().length(), *pressure));
    let (radii, pressures) = pressures.filter(|(r, _)| *r >= 1.0).unzip();
    Found {
        radii,
        pressures,
        mass_error: path.mass_error(),
        unknowns: path.unknowns,
    }
}

/// Largest error of some pressures, as a share of that at 1 m.
fn error(radii: &[f64], pressures: &[f64]) -> f64 {
    let conducts = APERTURE.powi(3) / (12.0 * VISCOSITY);
    let stores = APERTURE * COMPRESSIBILITY + 1.0 / STIFFNESS;
    let exact = |r: f64| theis([conducts / stores, conducts], RATE, r, END);
    let pairs = radii.iter().zip(pressures);
    largest(pairs.map(|(r, pressure)| (pressure - exact(*r)).abs())) / exact(1.0)
}

const PROBLEM: &str = "A thin sector between 0.01 m and 40 m, cells growing with the radius; water \
    begins to enter at the inner end. The slabs beside the joint are soft, so that it opens by what \
    its stiffness gives. Pressures are those from 1 m on, errors shares of the pressure at 1 m.";

const IN_TIME: Shown = Shown {
    file: "line-source-time",
    title: "A line source: errors over the time step",
    size: "time step (s)",
    rate: Some(1.0),
};

const IN_SPACE: Shown = Shown {
    file: "line-source",
    title: "A line source: errors over the size of cells",
    size: "1 / cells along",
    rate: Some(2.0),
};

fn run(effort: Effort) -> Finding {
    let (cells, steps): (&[usize], &[usize]) = match effort {
        Effort::Quick => (&[24, 48], &[20, 40]),
        Effort::Full => (&[24, 48, 96, 192], &[10, 20, 40, 80]),
    };
    let (most, last) = (cells[cells.len() - 1], 2 * steps[steps.len() - 1]);
    let shapes = [Shape::Hex8, Shape::Tet4];
    let mut all = Vec::new();
    let times = shapes.map(|shape| {
        let errors = steps.iter().map(|&count| {
            let found = found(shape, 2 * most, count);
            let error = error(&found.radii, &found.pressures);
            all.push(found);
            (END / count as f64, error)
        });
        Refinement::of(format!("{shape:?}"), errors.collect::<Vec<_>>())
    });
    let spaces = shapes.map(|shape| {
        let errors = cells.iter().map(|&n| {
            let [few, many] = [last, 2 * last].map(|count| found(shape, n, count));
            let error = error(&few.radii, &extrapolated(&few.pressures, &many.pressures));
            all.extend([few, many]);
            (1.0 / n as f64, error)
        });
        Refinement::of(format!("{shape:?}"), errors.collect::<Vec<_>>())
    });
    let left = largest_left(&spaces);
    let unknowns = all.iter().map(|found| found.unknowns).max().unwrap_or(0);
    let page = Finding::new([format!("pressures {}", percent(left)), unknowns.to_string()])
        .text(PROBLEM)
        .closed_form(CLOSED_FORM, PAGE.subject)
        .text(format!("Ever shorter steps, {} cells along:", 2 * most));
    let twice = 2 * last;
    let page = IN_TIME.on(page, &times).text(format!(
        "Ever finer meshes; pressures extrapolated from {last} and {twice} steps:"
    ));
    IN_SPACE.on(page, &spaces).shows(format!(
        "Pressures are of order {:.2} in the time step and of order {:.2} in the size of the cells; \
         {} is left at the finest mesh. {}",
        lowest_order(&times),
        lowest_order(&spaces),
        percent(left),
        missed(largest(all.iter().map(|found| found.mass_error)))
    ))
}
