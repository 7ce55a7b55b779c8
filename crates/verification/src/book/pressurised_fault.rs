//! A fault that slips because water takes from its friction.

use crate::report::{Effort, Finding, Study, largest, percent};

use super::refinement::{Refinement, Shown};
use super::scene::{self, Outcome};

pub const PAGE: Study = Study {
    name: "pressurised-fault",
    title: "Water pressure makes a fault slip",
    subject: "A. T. Starr, Proceedings of the Cambridge Philosophical Society 24, 1928",
    run,
};

const CLOSED_FORM: &str = "
A closed fault |x| < a = 1 m in an unbounded plate in plane strain, E = 25 GPa, nu = 0.25, under a normal stress s0 = 10 MPa
and a shear stress tau0 = 5 MPa; friction f = 0.6, water of p = 5 MPa:

    stress drop   tau0 - f (s0 - p)                                      2 MPa
    slip          4 (1 - nu^2)/E (tau0 - f (s0 - p)) sqrt(a^2 - x^2)     3.000000e-4 m in the middle
    effective normal traction                                           -5 MPa";

/// Numbers of load steps in which the water comes.
const STEPS: [usize; 2] = [1, 20];

fn fault(size: f64, steps: usize) -> Outcome {
    let mesh = format!("parameters = {{ h = {size}, half = 40 }}\norder = 2");
    let factors = (1..=steps).map(|step| format!("{}", step as f64 / steps as f64));
    let factors = format!("steps = [{}]", factors.collect::<Vec<_>>().join(", "));
    scene::run_edited("pressurised-fault", &mesh, &[("steps = [1]", &factors)])
}

fn mass_error(outcome: &Outcome) -> f64 {
    let steps = outcome.summary["steps"].as_array().into_iter().flatten();
    largest(steps.filter_map(|step| step["flow"]["mass_error"].as_f64()))
}

const SHOWN: Shown = Shown {
    file: "pressurised-fault",
    title: "A pressurised fault: errors over the size of cells",
    size: "size of cells at the fronts (m)",
    rate: Some(1.0),
};

const PROBLEM: &str = "The scene `geometries/pressurised-fault`: contact and friction, water from a \
    borehole in the middle of the fault at whose walls it stops. Prisms of second order; the slip is \
    that in L2, the traction the worst but beside the fronts. The sides of the plate are 80 m long.";

fn run(effort: Effort) -> Finding {
    let sizes: &[f64] = match effort {
        Effort::Quick => &[0.32, 0.16],
        Effort::Full => &[0.32, 0.16, 0.08],
    };
    let mut all = Vec::new();
    let mut refinements = Vec::new();
    for steps in STEPS {
        let found = sizes.iter().map(|&size| (size, fault(size, steps)));
        let found: Vec<_> = found.collect();
        let of = |name: &str, measure: &str| {
            let errors = found
                .iter()
                .map(|(size, case)| (*size, case.error(measure)));
            Refinement::of(format!("{name}, {}", in_steps(steps)), errors)
        };
        refinements.push(of("slip", "slip_l2"));
        all.extend(found.into_iter().map(|(_, case)| case));
    }
    let apart = refinements[0].errors.iter().zip(&refinements[1].errors);
    let apart = largest(apart.map(|((_, one), (_, many))| (one - many).abs()));
    let unknowns = all.iter().map(Outcome::unknowns).max().unwrap_or(0);
    let page = Finding::new([
        format!("slip {}", percent(refinements[0].finest())),
        unknowns.to_string(),
    ])
    .text(PROBLEM)
    .closed_form(CLOSED_FORM, PAGE.subject);
    SHOWN.on(page, &refinements).shows(format!(
        "The slip is {} off at the finest mesh, of which 0.1 % is that the plate ends; in {} steps \
         its error differs by {apart:.0e} at most. Nodes miss {:.0e} of what moves at most.",
        percent(refinements[0].finest()),
        STEPS[1],
        largest(all.iter().map(mass_error))
    ))
}

fn in_steps(count: usize) -> String {
    match count {
        1 => "1 step".to_owned(),
        count => format!("{count} steps"),
    }
}
