//! Joints that fill from one end and open: Wijesinghe's similarity solution, of a linear and of the
//! logarithmic law.

use kluft_mesh::Shape;
use kluft_solver::{Field, NewtonSettings};
use lie_core::{Closure, ClosureKind};

use crate::oracles::similarity::Filling;
use crate::report::{Effort, Finding, Study, Table, largest, missed, percent};
use crate::scenes::EXACT;
use crate::scenes::flow::{VISCOSITY, on_side, water};
use crate::scenes::soft_slabs::{Path, as_given, equal_steps, extrapolated, path, problem, strip};

use super::refinement::{Refinement, Shown, largest_left, lowest_order};

pub const PAGE: Study = Study {
    name: "filling-joint",
    title: "Joints that fill and open",
    subject: "A. M. Wijesinghe, 1986, the similarity solution by Runge and Kutta",
    run,
};

const CLOSED_FORM: &str = "
Between rigid blocks under a constant normal stress the fluid fills what the joint opens, and nothing else gives way:

    b_t = (b^3 p'(b) b_x)_x/(12 mu)        b is a function of x/sqrt(t) alone

    linear         b 1e-5 -> 1.9e-5 m, K_n 1e11 Pa/m               q = 1.023310 b0 sqrt(D0/t),  D0 = b0^3 K_n/(12 mu) = 8.333333e-3 m2/s
    logarithmic    b0 1e-4 m, K_n 1e11 Pa/m, normal stress 30 MPa  q = 0.1103601 b0 sqrt(D0/t), D0 = 8.333333 m2/s
                   pressure 10 -> 25 MPa: b 2.681209e-5 -> 6.022628e-5 m";

/// A joint, what drives it, and how it fills.
struct Joint {
    name: &'static str,
    closure: Closure,
    /// Normal stress (Pa, pressure positive).
    pressed: f64,
    /// Pressure before and at the end (Pa).
    pressures: [f64; 2],
    /// Apertures then (m).
    apertures: [f64; 2],
    /// Where nothing has arrived at the end (m), and the end (s).
    length: f64,
    end: f64,
    exact: Filling,
}

fn linear() -> Joint {
    let slope = 1e11 / (12.0 * VISCOSITY);
    Joint {
        name: "linear",
        closure: Closure::new(1e-5, 1e11, ClosureKind::Linear),
        pressed: 0.0,
        pressures: [0.0, 9e5],
        apertures: [1e-5, 1.9e-5],
        length: 12.0,
        end: 100.0,
        exact: Filling::of(|b| b.powi(3) * slope, [1.9e-5, 1e-5]),
    }
}

/// The law by hand: `sigma = K_n b0 (1 - x) (1 + ln^2 x)`, `x = b / b0`.
fn logarithmic() -> Joint {
    let (b0, stiffness) = (1e-4, 1e11);
    let apertures = [2.681_209e-5, 6.022_628e-5];
    let slope = |b: f64| {
        let logarithm = (b / b0).ln();
        let drop = 2.0 * (1.0 - b / b0) * logarithm * b0 / b;
        stiffness * (1.0 + logarithm * logarithm - drop)
    };
    let k = |b: f64| b.powi(3) * slope(b) / (12.0 * VISCOSITY);
    Joint {
        name: "logarithmic",
        closure: Closure::new(b0, stiffness, EXACT),
        pressed: 30e6,
        pressures: [10e6, 25e6],
        apertures,
        length: 10.0,
        end: 1.0,
        exact: Filling::of(k, [apertures[1], apertures[0]]),
    }
}

/// What a mesh and steps give.
struct Found {
    /// What has entered over what should have, and apertures less those they should be, as a share
    /// of how far the end opens.
    entered: f64,
    off: Vec<f64>,
    parts: usize,
    mass_error: f64,
    iterations: usize,
    unknowns: usize,
}

impl Joint {
    /// Fills a mesh of so many cells, which grow away from the end, in so many steps.
    fn filled(&self, n: usize, steps: usize, settings: NewtonSettings) -> Found {
        let mesh = strip(Shape::Hex8, n, [self.length, 1.0], 1.5);
        let schedule = equal_steps(steps, self.end);
        let problem = problem(&mesh, self.closure, self.pressed, schedule);
        let mut flow = water(&mesh, vec![on_side(&mesh, "side left", self.pressures[1])]);
        flow.initial_pressure = Field::constant(self.pressures[0]);
        let path = path(&problem, &flow, settings);
        let parts = path.frames.iter().map(|frame| frame.record.substeps.len());
        let parts = parts.sum();
        Found {
            entered: path.end().flow.entered[0] / self.exact.entered(self.end),
            off: self.off(&path),
            parts,
            mass_error: path.mass_error(),
            iterations: path.iterations(),
            unknowns: path.unknowns,
        }
    }

    fn off(&self, path: &Path) -> Vec<f64> {
        let opened = self.apertures[1] - self.apertures[0];
        let found = path.places.iter().zip(&path.end().apertures);
        let off = found.map(|(x, b)| (b - self.exact.aperture(x.x, self.end)) / opened);
        off.collect()
    }

    /// The same as [`Self::filled`] with twice as many steps too, their error extrapolated away.
    fn in_no_time(&self, n: usize, steps: usize) -> Found {
        let [few, many] = [steps, 2 * steps].map(|steps| self.filled(n, steps, as_given()));
        Found {
            entered: 2.0 * many.entered - few.entered,
            off: extrapolated(&few.off, &many.off),
            mass_error: few.mass_error.max(many.mass_error),
            iterations: few.iterations.max(many.iterations),
            ..many
        }
    }
}

impl Found {
    /// Of what has entered, and the largest of an aperture.
    fn errors(&self) -> [f64; 2] {
        let off = self.off.iter().map(|off| off.abs());
        [(self.entered - 1.0).abs(), largest(off)]
    }
}

fn refinements(joint: &Joint, cases: &[(f64, Found)]) -> [Refinement; 2] {
    let names = ["entered", "apertures"];
    [0, 1].map(|which| {
        let errors = cases
            .iter()
            .map(|(size, case)| (*size, case.errors()[which]));
        Refinement::of(format!("{}, {}", joint.name, names[which]), errors)
    })
}

/// How the program divides ten steps to keep to an accuracy in time.
fn divided(joint: &Joint, n: usize, accuracies: &[f64]) -> Vec<(f64, Found)> {
    let of = |&time: &f64| {
        let settings = NewtonSettings {
            time,
            ..NewtonSettings::default()
        };
        (time, joint.filled(n, 10, settings))
    };
    accuracies.iter().map(of).collect()
}

fn divided_table(all: &[(&Joint, Vec<(f64, Found)>)]) -> Table {
    let mut table = Table::new(&[
        "law",
        "time_accuracy",
        "parts",
        "most Newton iterations",
        "entered",
        "apertures",
        "mass",
    ]);
    for (joint, cases) in all {
        for (accuracy, case) in cases {
            table.push([
                joint.name.to_owned(),
                format!("{accuracy:e}"),
                case.parts.to_string(),
                case.iterations.to_string(),
                format!("{:.2e}", case.errors()[0]),
                format!("{:.2e}", case.errors()[1]),
                format!("{:.0e}", case.mass_error),
            ]);
        }
    }
    table
}

const PROBLEM: &str = "A strip of hexahedra between soft slabs, 12 m long (linear, 100 s) or 10 m \
    (logarithmic, 1 s), cells growing away from the end at which the fluid enters. Errors are those \
    of the volume that has entered, and the largest of an aperture as a share of how far the end \
    opens.";

const IN_TIME: Shown = Shown {
    file: "filling-joint-time",
    title: "A joint that fills: errors over the time step",
    size: "time step over the whole time",
    rate: Some(1.0),
};

const IN_SPACE: Shown = Shown {
    file: "filling-joint",
    title: "A joint that fills: errors over the size of cells",
    size: "1 / cells along",
    rate: Some(2.0),
};

struct Swept {
    refinements: [Refinement; 2],
    found: Vec<Found>,
}

/// A sweep over numbers of steps or cells.
fn sweep(joint: &Joint, counts: &[usize], of: impl Fn(usize) -> Found) -> Swept {
    let found = counts.iter().map(|&count| (1.0 / count as f64, of(count)));
    let found: Vec<_> = found.collect();
    Swept {
        refinements: refinements(joint, &found),
        found: found.into_iter().map(|(_, found)| found).collect(),
    }
}

fn run(effort: Effort) -> Finding {
    let (cells, steps, accuracies): (&[usize], &[usize], &[f64]) = match effort {
        Effort::Quick => (&[24, 48], &[10, 20], &[1e-1, 1e-2]),
        Effort::Full => (&[24, 48, 96], &[10, 20, 40, 80], &[1e-1, 1e-2, 1e-3]),
    };
    let (most, last) = (cells[cells.len() - 1], 2 * steps[steps.len() - 1]);
    let joints = [linear(), logarithmic()];
    let mut all = Vec::new();
    let (mut times, mut spaces) = (Vec::new(), Vec::new());
    for joint in &joints {
        let swept = sweep(joint, steps, |count| {
            joint.filled(2 * most, count, as_given())
        });
        times.extend(swept.refinements);
        all.extend(swept.found);
        let swept = sweep(joint, cells, |n| joint.in_no_time(n, last));
        spaces.extend(swept.refinements);
        all.extend(swept.found);
    }
    let walked = joints.each_ref();
    let walked = walked.map(|joint| (joint, divided(joint, most, accuracies)));
    let table = divided_table(&walked);
    for (_, cases) in walked {
        all.extend(cases.into_iter().map(|(_, found)| found));
    }
    let left = percent(largest_left(&spaces));
    let unknowns = all.iter().map(|case| case.unknowns).max().unwrap_or(0);
    let page = Finding::new([format!("apertures, volumes {left}"), unknowns.to_string()])
        .text(PROBLEM)
        .closed_form(CLOSED_FORM, PAGE.subject)
        .text(format!("Ever shorter steps, {} cells along:", 2 * most));
    let twice = 2 * last;
    let page = IN_TIME.on(page, &times).text(format!(
        "Ever finer meshes; extrapolated from {last} and {twice} steps:"
    ));
    let page = IN_SPACE.on(page, &spaces).text(format!(
        "Ten steps that the program divides by `time_accuracy`, {most} cells along:"
    ));
    page.table_in("filling-joint-accuracy", table).shows(format!(
        "Volumes and apertures are of order {:.2} at least in the time step, and of order {:.2} at \
         least in the size of the cells; {left} is left at the finest mesh, where the error of the \
         steps has been extrapolated away. Errors follow `time_accuracy` down to what the mesh \
         leaves. No part of a step takes more than {} Newton iterations. {}",
        lowest_order(&times),
        lowest_order(&spaces),
        all.iter().map(|case| case.iterations).max().unwrap_or(0),
        missed(largest(all.iter().map(|case| case.mass_error)))
    ))
}
