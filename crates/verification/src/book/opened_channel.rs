//! Steady flow through joints that it opens.

use kluft_mesh::Shape;
use kluft_solver::Field;
use lie_core::{Closure, ClosureKind};

use crate::report::{Effort, Finding, Study, largest, percent};
use crate::scenes::EXACT;
use crate::scenes::flow::{VISCOSITY, on_side, water};
use crate::scenes::soft_slabs::{Path, as_given, path, problem, steady, strip};

use super::refinement::{Refinement, Shown, largest_left, lowest_order};

pub const PAGE: Study = Study {
    name: "opened-channel",
    title: "Steady flow that opens its joint",
    subject: "the cubic law integrated over the effective stress",
    run,
};

const CLOSED_FORM: &str = "
With an effective stress s that falls by the pressure, q = 1/(12 mu L) int b(s)^3 ds over the stresses between the ends:

    linear         b 1.9e-5 -> 1e-5 m, K_n 1e11 Pa/m, L 2 m        q = K_n (b1^4 - b2^4)/(48 mu L) = 1.253344e-7 m2/s
                                                                   b(1 m) = 1.627508e-5 m
    logarithmic    b0 1e-4 m, K_n 1e11 Pa/m, normal stress 30 MPa, pressures 25 and 10 MPa, L 2 m
                                                                   q = 4.362297e-5 m2/s, b(1 m) = 4.639237e-5 m";

/// A joint and what flows through it.
struct Joint {
    name: &'static str,
    closure: Closure,
    /// Normal stress and pressures at both ends (Pa).
    pressed: f64,
    ends: [f64; 2],
    /// Rate for each metre of width (m^2/s) and aperture in the middle (m).
    exact: [f64; 2],
}

const LENGTH: f64 = 2.0;

fn linear() -> Joint {
    let [inner, outer]: [f64; 2] = [1.9e-5, 1e-5];
    let fall = inner.powi(4) - outer.powi(4);
    Joint {
        name: "linear",
        closure: Closure::new(outer, 1e11, ClosureKind::Linear),
        pressed: 0.0,
        ends: [9e5, 0.0],
        exact: [
            1e11 * fall / (48.0 * VISCOSITY * LENGTH),
            (outer.powi(4) + 0.5 * fall).powf(0.25),
        ],
    }
}

/// Its numbers are those of another computation.
fn logarithmic() -> Joint {
    Joint {
        name: "logarithmic",
        closure: Closure::new(1e-4, 1e11, EXACT),
        pressed: 30e6,
        ends: [25e6, 10e6],
        exact: [4.362_297e-5, 4.639_237e-5],
    }
}

impl Joint {
    fn flowing(&self, shape: Shape, n: usize) -> Path {
        let mesh = strip(shape, n, [LENGTH, LENGTH / n as f64], 1.0);
        let problem = problem(&mesh, self.closure, self.pressed, steady());
        let conditions = ["side left", "side right"].into_iter().zip(self.ends);
        let conditions = conditions.map(|(side, end)| on_side(&mesh, side, end));
        let mut flow = water(&mesh, conditions.collect());
        flow.initial_pressure = Field::constant(self.ends[1]);
        path(&problem, &flow, as_given())
    }

    fn errors(&self, path: &Path, n: usize) -> [f64; 2] {
        let middle = path.places.iter().zip(&path.end().apertures);
        let middle = middle.filter(|(x, b)| (x.x - 0.5 * LENGTH).abs() < 1e-9 && b.is_finite());
        let off = middle.map(|(_, b)| (b / self.exact[1] - 1.0).abs());
        let rate = path.end().flow.conditions[0].rate * n as f64 / LENGTH;
        [(rate / self.exact[0] - 1.0).abs(), largest(off)]
    }
}

const PROBLEM: &str = "A strip of 2 m between soft slabs, its cells as wide as long; one step from the joint at \
    rest to the steady state. Errors are those of the rate and of the aperture in the middle.";

const SHOWN: Shown = Shown {
    file: "opened-channel",
    title: "A flow that opens its joint: errors over the size of cells",
    size: "size of cells (m)",
    rate: Some(2.0),
};

const QUADRATIC: Shown = Shown {
    file: "opened-channel-quadratic",
    title: "The same where jumps are of second order",
    ..SHOWN
};

/// Errors of rate and aperture of a joint on cells of a shape; all paths go to `seen`.
fn refined(joint: &Joint, shape: Shape, sizes: &[usize], seen: &mut Vec<Path>) -> [Refinement; 2] {
    let found = sizes.iter().map(|&n| {
        let path = joint.flowing(shape, n);
        let errors = joint.errors(&path, n);
        seen.push(path);
        (LENGTH / n as f64, errors)
    });
    let found: Vec<_> = found.collect();
    [0, 1].map(|which| {
        let quantity = ["rate", "aperture"][which];
        let name = format!("{}, {quantity}, {shape:?}", joint.name);
        Refinement::of(
            name,
            found.iter().map(|(size, errors)| (*size, errors[which])),
        )
    })
}

fn run(effort: Effort) -> Finding {
    let sizes: &[usize] = match effort {
        Effort::Quick => &[16, 32],
        Effort::Full => &[8, 16, 32, 64, 128],
    };
    let mut seen = Vec::new();
    let mut of = |shapes: &[Shape]| {
        let joints = [linear(), logarithmic()];
        let pairs = joints
            .iter()
            .flat_map(|joint| shapes.iter().map(move |shape| (joint, *shape)));
        let all = pairs.flat_map(|(joint, shape)| refined(joint, shape, sizes, &mut seen));
        all.collect::<Vec<Refinement>>()
    };
    let linear = of(&[Shape::Tet4, Shape::Hex8]);
    let quadratic = of(&[Shape::Tet10, Shape::Hex20]);
    let left = percent(largest_left(&linear));
    let unknowns = seen.iter().map(|path| path.unknowns).max().unwrap_or(0);
    let iterations = seen.iter().map(Path::iterations).max().unwrap_or(0);
    let page = Finding::new([format!("rates, apertures {left}"), unknowns.to_string()])
        .text(PROBLEM)
        .closed_form(CLOSED_FORM, PAGE.subject);
    let page = SHOWN
        .on(page, &linear)
        .text("Jumps of second order, pressures of first:");
    QUADRATIC.on(page, &quadratic).shows(format!(
        "Rates and apertures are of order {:.2} at least, and {left} off at the finest mesh; where \
         jumps are of second order they are {} off. The step takes at most {iterations} Newton \
         iterations, and nodes miss {:.0e} of what flows.",
        lowest_order(&linear),
        percent(largest_left(&quadratic)),
        largest(seen.iter().map(Path::mass_error))
    ))
}
