//! Tractions behind a crack front in a stiff joint.

use kluft_solver::Discretisation;
use lie_core::FacetQuadrature;

use super::{Found, Page, digits};
use crate::crack_front;
use crate::studies::{Effort, Table, front};

pub const PAGE: Page = Page {
    name: "oscillation",
    title: "Traction of a stiff joint",
    oracle: "a joint pulled everywhere is in tension everywhere; J. C. J. Schellekens, R. de Borst, Int. J. Numer. Meth. Engng 36, 1993",
    closed_form: "
There is no closed form, but a sign: the loads pull, so every traction of the joint is positive. Rules of quadrature that couple the
nodes of a facet change the sign of some.",
    run,
};

/// Unknowns of the cells that have most.
fn unknowns() -> usize {
    let counts = front::SHAPES.map(|shape| {
        let problem = crack_front::problem(shape, FacetQuadrature::Nodal, 1.0);
        let discretisation = Discretisation::of(&problem).expect("supported");
        discretisation.unknown_count()
    });
    counts.into_iter().max().unwrap_or(0)
}

fn run() -> Found {
    let found = (front::STUDY.run)(Effort::Full);
    let Table { head, rows } = &found.table;
    let column = |name: &str| {
        head.iter()
            .position(|head| *head == name)
            .expect("a column")
    };
    let (rule, ratio) = (column("rule"), column("smallest / largest"));
    let smallest = |name: &str| {
        let own = rows.iter().filter(|row| row[rule] == name);
        let values = own.map(|row| row[ratio].parse().unwrap_or(f64::NAN));
        values.fold(f64::INFINITY, f64::min)
    };
    let (nodal, gauss) = (smallest("nodal"), smallest("Gauss"));
    Found {
        problem: "A unit cube is pulled apart; one half of its middle plane is a free crack, the other half a linear joint of stiffness \
                  K = 1e-3 to 1e8 E/h. Facets are integrated at their nodes, which is what the program does, and at Gauss points."
            .to_owned(),
        reached: format!("no wrong sign: smallest over largest traction {}", digits(nodal)),
        unknowns: unknowns(),
        shows: format!(
            "At nodes no traction has the wrong sign at any stiffness, in any cell; the smallest is {} of the largest. At \
             Gauss points it falls to {} of the largest.",
            digits(nodal),
            digits(gauss)
        ),
        charts: found.charts,
        tables: vec![("oscillation", found.table)],
    }
}
