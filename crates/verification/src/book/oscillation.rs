//! Tractions behind a crack front in a stiff joint.

use kluft_solver::Discretisation;
use lie_core::FacetQuadrature;

use crate::report::{Effort, Finding, Study, digits};
use crate::scenes::crack_front;
use crate::stability::front;

pub const PAGE: Study = Study {
    name: "oscillation",
    title: "Traction of a stiff joint",
    subject: "a joint pulled everywhere is in tension everywhere; J. C. J. Schellekens, R. de \
              Borst, Int. J. Numer. Meth. Engng 36, 1993",
    run,
};

const CLOSED_FORM: &str = "
There is no closed form, but a sign: the loads pull, so every traction of the joint is positive.
Rules of quadrature that couple the nodes of a facet change the sign of some.";

/// Unknowns of the cells that have most.
fn unknowns() -> usize {
    let counts = front::SHAPES.map(|shape| {
        let problem = crack_front::problem(shape, FacetQuadrature::Nodal, 1.0);
        let discretisation = Discretisation::of(&problem).expect("supported");
        discretisation.unknown_count()
    });
    counts.into_iter().max().unwrap_or(0)
}

const PROBLEM: &str = "A unit cube is pulled apart; one half of its middle plane is a free crack, \
    the other half a linear joint of stiffness K = 1e-3 to 1e8 E/h. Facets are integrated at their \
    nodes, which is what the program does, and at Gauss points.";

fn run(effort: Effort) -> Finding {
    let found = (front::STUDY.run)(effort);
    let table = found.first_table();
    let (rule, ratio) = (table.column("rule"), table.column("smallest / largest"));
    let smallest = |name: &str| {
        let own = table.rows.iter().filter(|row| row[rule] == name);
        let values = own.map(|row| row[ratio].parse().unwrap_or(f64::NAN));
        values.fold(f64::INFINITY, f64::min)
    };
    let [nodal, gauss] = ["nodal", "Gauss"].map(|name| digits(smallest(name)));
    let reached = format!("no wrong sign: smallest over largest traction {nodal}");
    let charts = found.all_charts();
    Finding::new([reached, unknowns().to_string()])
        .text(PROBLEM)
        .closed_form(CLOSED_FORM, PAGE.subject)
        .charts(charts.map(|(name, chart)| (name, chart.clone())))
        .table(table.clone())
        .shows(format!(
            "At nodes no traction has the wrong sign at any stiffness, in any cell; the smallest \
             is {nodal} of the largest. At Gauss points it falls to {gauss} of the largest."
        ))
}
