//! A borehole that pumps into a joint that stores, and out of it, in turn.

use std::f64::consts::TAU;

use kluft_mesh::Shape;
use lie_core::{Closure, ClosureKind};

use crate::oracles::diffusion::periodic_source;
use crate::report::{Effort, Finding, Study, largest, missed, percent};
use crate::scenes::flow::{VISCOSITY, fed_from_side, water};
use crate::scenes::soft_slabs::{
    DRIVEN, SECTOR, as_given, extrapolated, logarithmic, path, problem, sector, times,
};

use super::refinement::{Refinement, Shown, largest_left, lowest_order};

pub const PAGE: Study = Study {
    name: "periodic-source",
    title: "A borehole that pumps in and out of a joint",
    subject: "H. S. Carslaw and J. C. Jaeger, Conduction of Heat in Solids, 1959, section 10.4",
    run,
};

const CLOSED_FORM: &str = "
A joint of aperture b = 1e-4 m stores by the fluid, c = 4.5e-10 1/Pa, and by its stiffness, K_n = 1e11 Pa/m:

    s = b c + 1/K_n     T = b^3/(12 mu)     D = T/s = 8.296001 m2/s     k = sqrt(i w/D)
    p = Re(Q/(2 pi T) K_0(k r) exp(i w t))  Q = 1e-6 m3/s, 2 pi/w = 10 s, r = 1, 2, 5 m:
                                            amplitudes 3059.283, 1929.161, 727.3513 Pa";

const APERTURE: f64 = 1e-4;
const STIFFNESS: f64 = 1e11;
const COMPRESSIBILITY: f64 = 4.5e-10;
/// So little that apertures hardly change (m^3/s).
const RATE: f64 = 1e-8;
const PERIOD: f64 = 10.0;
/// Periods until what the beginning has left is gone; the last one is compared.
const PERIODS: usize = 4;
/// Of the hole and of the end of the mesh (m).
const RADII: [f64; 2] = [0.01, 40.0];

/// What a mesh and steps give.
struct Found {
    /// Radii (m) from 1 m on.
    radii: Vec<f64>,
    /// Cosine and sine of the pressures there in the last period (Pa), one after the other.
    swings: Vec<f64>,
    mass_error: f64,
    unknowns: usize,
}

fn found(shape: Shape, n: usize, steps: usize) -> Found {
    let mesh = sector(shape, n, logarithmic(RADII));
    let closure = Closure::new(APERTURE, STIFFNESS, ClosureKind::Linear);
    let angle = |step: usize| TAU * step as f64 / steps as f64;
    let time = |step: usize| PERIOD * step as f64 / steps as f64;
    let schedule = times((1..=PERIODS * steps).map(|step| (time(step), angle(step).cos())));
    let problem = problem(&mesh, closure, 0.0, schedule);
    let rate = RATE * SECTOR / TAU;
    let mut fed = fed_from_side(&mesh, "side left", rate);
    fed.case = DRIVEN;
    let mut flow = water(&mesh, vec![fed]);
    flow.fluid.compressibility = COMPRESSIBILITY;
    let path = path(&problem, &flow, as_given());
    assert!(path.failed.is_none(), "{:#?}", path.failed);
    let far = |row: &usize| path.places[*row].truncate().length() >= 1.0;
    let rows: Vec<usize> = (0..path.places.len()).filter(far).collect();
    let last = path.frames.iter().enumerate().skip((PERIODS - 1) * steps);
    let last: Vec<_> = last
        .map(|(index, frame)| (angle(index + 1), frame))
        .collect();
    let share = |row: usize, of: fn(f64) -> f64| -> f64 {
        let terms = last
            .iter()
            .map(|(angle, frame)| of(*angle) * frame.flow.pressures[row]);
        2.0 * terms.sum::<f64>() / steps as f64
    };
    Found {
        radii: rows
            .iter()
            .map(|&row| path.places[row].truncate().length())
            .collect(),
        swings: rows
            .iter()
            .flat_map(|&row| [share(row, f64::cos), share(row, f64::sin)])
            .collect(),
        mass_error: path.mass_error(),
        unknowns: path.unknowns,
    }
}

/// Largest error of some swings, as a share of the amplitude at 1 m.
fn error(radii: &[f64], swings: &[f64]) -> f64 {
    let conducts = APERTURE.powi(3) / (12.0 * VISCOSITY);
    let stores = APERTURE * COMPRESSIBILITY + 1.0 / STIFFNESS;
    let exact = |r: f64| periodic_source([conducts / stores, conducts], RATE, r, TAU / PERIOD);
    let size = |[cosine, sine]: [f64; 2]| cosine.hypot(sine);
    let pairs = radii.iter().zip(swings.chunks_exact(2));
    let errors = pairs.map(|(r, found)| {
        let exact = exact(*r);
        size([found[0] - exact[0], found[1] - exact[1]])
    });
    largest(errors) / size(exact(1.0))
}

const PROBLEM: &str = "A thin sector between 0.01 m and 40 m, cells growing with the radius; water \
    enters and leaves at the inner end by a cosine of time. The slabs beside the joint are soft, so \
    that it opens by what its stiffness gives. Compared are the cosine and the sine in the fourth \
    period, from 1 m on; errors are shares of the amplitude at 1 m.";

const IN_TIME: Shown = Shown {
    file: "periodic-source-time",
    title: "A periodic source: errors over the time step",
    size: "time step (periods)",
    rate: Some(1.0),
};

const IN_SPACE: Shown = Shown {
    file: "periodic-source",
    title: "A periodic source: errors over the size of cells",
    size: "1 / cells along",
    rate: Some(2.0),
};

fn run(effort: Effort) -> Finding {
    let (cells, steps): (&[usize], &[usize]) = match effort {
        Effort::Quick => (&[20, 40], &[80, 160]),
        Effort::Full => (&[20, 40, 80, 160], &[20, 40, 80, 160]),
    };
    let (most, last) = (cells[cells.len() - 1], steps[steps.len() - 1]);
    let shapes = [Shape::Hex8, Shape::Tet4];
    let mut all = Vec::new();
    let times = shapes.map(|shape| {
        let errors = steps.iter().map(|&count| {
            let found = found(shape, most, count);
            let error = error(&found.radii, &found.swings);
            all.push(found);
            (1.0 / count as f64, error)
        });
        Refinement::of(format!("{shape:?}"), errors.collect::<Vec<_>>())
    });
    let spaces = shapes.map(|shape| {
        let errors = cells.iter().map(|&n| {
            let [few, many] = [last, 2 * last].map(|count| found(shape, n, count));
            let error = error(&few.radii, &extrapolated(&few.swings, &many.swings));
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
        .text(format!("Ever shorter steps, {most} cells along:"));
    let twice = 2 * last;
    let page = IN_TIME.on(page, &times).text(format!(
        "Ever finer meshes; pressures extrapolated from {last} and {twice} steps a period:"
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
