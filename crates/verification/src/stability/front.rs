//! Traction behind a crack front: facets integrated at Gauss points or at their nodes.

use std::collections::BTreeMap;

use kluft_chart::{Axis, Chart, Series};
use kluft_mesh::Shape;
use lie_core::FacetQuadrature;

use crate::report::{Effort, Finding, Study, Table};
use crate::scenes::crack_front::{CUBES, tractions};

/// The study.
pub const STUDY: Study = Study {
    name: "front",
    title: "Traction behind a crack front",
    subject: "stiffness of the joint, K h/E from 1e-3 to 1e8",
    run,
};

const RULES: [(FacetQuadrature, &str); 2] = [
    (FacetQuadrature::Gauss, "Gauss"),
    (FacetQuadrature::Nodal, "nodal"),
];

/// Cells of the whole study.
pub const SHAPES: [Shape; 3] = [Shape::Tet4, Shape::Tet10, Shape::Hex8];

/// One curve: a shape and a rule.
struct Curve {
    shape: Shape,
    rule: &'static str,
    /// `K h/E`, smallest over largest traction, share of facet points with the wrong sign.
    points: Vec<(f64, f64, f64)>,
}

/// Smallest over largest traction, and the share of tractions below zero.
fn worst(shape: Shape, quadrature: FacetQuadrature, stiffness: f64) -> (f64, f64) {
    let tractions = tractions(shape, quadrature, stiffness);
    let values = || tractions.iter().map(|(_, traction)| *traction);
    let largest = values().fold(0.0, f64::max);
    let smallest = values().fold(f64::INFINITY, f64::min);
    let wrong = values().filter(|value| *value < 0.0).count();
    (smallest / largest, wrong as f64 / tractions.len() as f64)
}

fn curves(effort: Effort) -> Vec<Curve> {
    let (shapes, exponents): (&[Shape], Vec<i32>) = match effort {
        Effort::Quick => (&[Shape::Tet4], vec![-3, 4, 8]),
        Effort::Full => (&SHAPES, (-3..=8).collect()),
    };
    let mut curves = Vec::new();
    for &shape in shapes {
        for (quadrature, rule) in RULES {
            let point = |&exponent: &i32| {
                let stiffness = 10.0_f64.powi(exponent);
                let (ratio, wrong) = worst(shape, quadrature, stiffness);
                (stiffness, ratio, wrong)
            };
            let points = exponents.iter().map(point).collect();
            curves.push(Curve {
                shape,
                rule,
                points,
            });
        }
    }
    curves
}

/// Smallest traction over the largest, over the distance from the front in cells.
fn profile(quadrature: FacetQuadrature) -> Vec<(f64, f64)> {
    let tractions = tractions(Shape::Tet4, quadrature, 1e4);
    let largest = tractions.iter().map(|point| point.1).fold(0.0, f64::max);
    // Distances of all rules are multiples of a twelfth of a cell.
    let column = |x: f64| (12.0 * CUBES as f64 * (x - 0.5)).round() as i32;
    let mut smallest = BTreeMap::new();
    for (place, traction) in tractions {
        let own: &mut f64 = smallest.entry(column(place.x)).or_insert(traction);
        *own = own.min(traction);
    }
    let points = smallest.into_iter();
    points
        .map(|(column, traction)| (f64::from(column) / 12.0, traction / largest))
        .collect()
}

fn charts(curves: &[Curve]) -> Vec<(&'static str, Chart)> {
    let series = curves.iter().map(|curve| {
        let points = curve.points.iter().map(|point| (point.0, point.1));
        Series::line(
            format!("{:?}, {}", curve.shape, curve.rule),
            points.collect(),
        )
    });
    vec![
        (
            "front",
            Chart {
                series: series.collect(),
                ..Chart::new(
                    "A joint in tension ahead of a crack: its smallest traction",
                    Axis::logarithmic("stiffness of the joint, K h/E"),
                    Axis::linear("smallest over largest traction (wrong sign below 0)"),
                )
            },
        ),
        (
            "front-profile",
            Chart {
                series: vec![
                    Series::line("Gauss", profile(FacetQuadrature::Gauss)),
                    Series::line("nodal, Kluft", profile(FacetQuadrature::Nodal)),
                ],
                ..Chart::new(
                    "Traction behind the front, linear tetrahedra, K h/E = 10⁴",
                    Axis::linear("distance from the front (cells)"),
                    Axis::linear("smallest traction there over the largest of all"),
                )
            },
        ),
    ]
}

fn run(effort: Effort) -> Finding {
    let curves = curves(effort);
    let mut table = Table::new(&[
        "cells",
        "rule",
        "K h/E",
        "smallest / largest",
        "wrong sign (share)",
    ]);
    let mut misses = Vec::new();
    for curve in &curves {
        for &(stiffness, ratio, wrong) in &curve.points {
            table.push([
                format!("{:?}", curve.shape),
                curve.rule.to_owned(),
                format!("{stiffness:e}"),
                format!("{ratio:.4}"),
                format!("{wrong:.3}"),
            ]);
            if curve.rule == "nodal" && ratio <= 0.0 {
                misses.push(format!(
                    "{:?}, K h/E = {stiffness:e}: ratio {ratio:.3}",
                    curve.shape
                ));
            }
        }
    }
    let wrong = curves
        .iter()
        .flat_map(|curve| &curve.points)
        .filter(|point| point.1 < 0.0);
    let first = wrong.map(|point| point.0).fold(f64::INFINITY, f64::min);
    let smallest = |rule: &str| {
        let own = curves.iter().filter(|curve| curve.rule == rule);
        let ratios = own.flat_map(|curve| &curve.points).map(|point| point.1);
        ratios.fold(f64::INFINITY, f64::min)
    };
    let (gauss, nodal) = (smallest("Gauss"), smallest("nodal"));
    Finding::new([
        format!(
            "Gauss points: tractions of the wrong sign from K h/E = {first} on, down to {gauss:.2} \
             of the largest"
        ),
        format!("never a wrong sign; the smallest is {nodal:.2} of the largest"),
    ])
    .text(format!(
        "A cube is pulled apart; half of its middle plane is a free crack, the other half a joint \
         in tension everywhere. Gauss points couple the jumps of neighbouring nodes, and a stiff \
         joint then oscillates behind the front: from K h/E = {first} on there are tractions of \
         the wrong sign, down to {gauss:.2} of the largest. A law that opens and closes would take \
         them for open. Kluft integrates facets at their nodes, so that the fractures couple no \
         two nodes: no wrong sign at any stiffness, the smallest traction is {nodal:.2} of the \
         largest. [facet-quadrature.md](facet-quadrature.md) has all cells."
    ))
    .charts(charts(&curves))
    .numbers(table)
    .missing(misses)
}
