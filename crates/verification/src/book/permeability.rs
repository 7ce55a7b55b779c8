//! Equivalent permeabilities beside Snow's formula, and beside a joint that ends in the rock.

use std::f64::consts::PI;

use glam::{DMat3, DVec3};
use kluft_chart::{Axis, Chart, Rate, Series};
use kluft_mesh::structured::Patch;
use kluft_mesh::{Mesh, Shape};
use kluft_solver::EquivalentPermeability;

use crate::report::{Effort, Finding, Study, Table, largest, percent};
use crate::scenes::flow::{apertures, block, water};

pub const PAGE: Study = Study {
    name: "permeability",
    title: "Equivalent permeability",
    subject: "D. T. Snow, Water Resources Research 5, 1969; Fourier series of a rectangle",
    run,
};

const CLOSED_FORM: &str = "
Joints that go through the body, whatever crosses what, with areas A and unit normals n:

    k = 1/V sum (b^3/12) A (1 - n n^T)           parallel, spaced s:  b^3/(12 s) along them

A joint across a unit cube at z = 1/2 that ends at x = a has under the pressure x on the outer
surface p = x + w, w = 0 at x = 0, y = 0 and y = 1, dw/dx = -1 at x = a, so that

    k_xx = b^3/12 (a - sum_(n odd) 8 tanh(n pi a)/(n pi)^3),    k_yy = b^3/12 a";

const WIDTH: f64 = 1e-4;
const CUBIC: f64 = WIDTH * WIDTH * WIDTH / 12.0;
const TIP: f64 = 0.5;

/// `k_xx` of the joint that ends at [`TIP`] (m^2).
fn across_tip() -> f64 {
    let terms = (0..20_000).rev().map(|k| {
        let n = f64::from(2 * k + 1);
        8.0 * (n * PI * TIP).tanh() / (n * PI).powi(3)
    });
    CUBIC * (TIP - terms.sum::<f64>())
}

fn permeability(mesh: &Mesh) -> EquivalentPermeability {
    let flow = water(mesh, Vec::new());
    let found = EquivalentPermeability::of(mesh, &flow, &apertures(mesh, |_, _| WIDTH));
    found.unwrap_or_else(|why| panic!("{why:?}"))
}

/// A unit cube cut by two planes across each of the axes, leaning by so much in x a metre of z.
fn cut(shape: Shape, axes: &[usize], lean: f64) -> Mesh {
    let planes = axes
        .iter()
        .flat_map(|&axis| [1.0, 2.0].map(|k| (axis, k / 3.0)));
    let planes = planes.map(|(axis, at)| move |x: [f64; 3]| (x[axis] - at).abs() < 1e-9);
    let planes: Vec<_> = planes.collect();
    let names: Vec<String> = (0..planes.len()).map(|k| format!("joint {k}")).collect();
    let surfaces = names.iter().zip(&planes);
    let surfaces: Vec<Patch<'_>> = surfaces.map(|(name, on)| Patch::new(name, on)).collect();
    block(shape, ([3; 3], [1.0; 3]), &surfaces, |[x, y, z]| {
        [x + lean * z, y, z]
    })
}

/// A set of planes across an axis, leaning: area in 1 m3, and `1 - n n^T`.
fn snow(axis: usize, lean: f64) -> DMat3 {
    let normals = [DVec3::new(1.0, 0.0, -lean), DVec3::Y, DVec3::Z];
    let areas = [2.0 * normals[0].length(), 2.0, 2.0];
    let n = normals[axis].normalize();
    let across = DMat3::from_cols(n.x * n, n.y * n, n.z * n);
    areas[axis] * CUBIC * (DMat3::IDENTITY - across)
}

/// A body whose tensor any mesh must reproduce.
struct Exact {
    what: &'static str,
    shape: Shape,
    error: f64,
    asymmetry: f64,
    mass_error: f64,
}

fn exact_cases(shapes: &[Shape]) -> Vec<Exact> {
    let bodies: [(&str, &[usize], f64); 4] = [
        ("one set", &[2], 0.0),
        ("one set that leans 45 degrees", &[0], 1.0),
        ("three sets at right angles", &[0, 1, 2], 0.0),
        ("three sets, one leans 35 degrees", &[0, 1, 2], 0.7),
    ];
    let case = |shape: Shape, (what, axes, lean): (&'static str, &[usize], f64)| {
        let found = permeability(&cut(shape, axes, lean));
        let expected = axes.iter().map(|&axis| snow(axis, lean));
        let expected = expected
            .fold(DMat3::ZERO, |sum, set| sum + set)
            .to_cols_array();
        let scale = largest(expected.iter().map(|value| value.abs()));
        let pairs = found.tensor.components.as_flattened().iter().zip(&expected);
        Exact {
            what,
            shape,
            error: largest(pairs.map(|(found, expected)| (found - expected).abs())) / scale,
            asymmetry: found.asymmetry,
            mass_error: found.mass_error,
        }
    };
    let all = shapes
        .iter()
        .flat_map(|&shape| bodies.map(|body| (shape, body)));
    all.map(|(shape, body)| case(shape, body)).collect()
}

/// The joint that ends in the rock, on one mesh.
struct Ending {
    shape: Shape,
    size: f64,
    /// Of `k_xx` and `k_yy`.
    errors: [f64; 2],
    asymmetry: f64,
}

fn ending(shape: Shape, n: usize) -> Ending {
    let on = |x: [f64; 3]| x[2] == 0.5 && x[0] <= TIP + 1e-9;
    let surfaces = [Patch::new("joint", &on)];
    let mesh = block(shape, ([n, n, 2], [1.0; 3]), &surfaces, |x| x);
    let found = permeability(&mesh);
    let [[xx, ..], [_, yy, _], _] = found.tensor.components;
    Ending {
        shape,
        size: 1.0 / n as f64,
        errors: [
            (xx / across_tip() - 1.0).abs(),
            (yy / (CUBIC * TIP) - 1.0).abs(),
        ],
        asymmetry: found.asymmetry,
    }
}

fn exact_table(cases: &[Exact]) -> Table {
    let mut table = Table::new(&["joints", "cells", "tensor", "asymmetry", "mass"]);
    for case in cases {
        table.push([
            case.what.to_owned(),
            format!("{:?}", case.shape),
            format!("{:.0e}", case.error),
            format!("{:.0e}", case.asymmetry),
            format!("{:.0e}", case.mass_error),
        ]);
    }
    table
}

fn order(pair: &[Ending]) -> f64 {
    (pair[0].errors[0] / pair[1].errors[0]).ln() / (pair[0].size / pair[1].size).ln()
}

fn ending_table(cases: &[Ending]) -> Table {
    let mut table = Table::new(&[
        "cells",
        "size (m)",
        "k_xx",
        "its order",
        "k_yy",
        "asymmetry",
    ]);
    for (index, case) in cases.iter().enumerate() {
        let pair = index.checked_sub(1).map(|before| &cases[before..=index]);
        let pair = pair.filter(|pair| pair[0].shape == pair[1].shape);
        table.push([
            format!("{:?}", case.shape),
            case.size.to_string(),
            format!("{:.2e}", case.errors[0]),
            pair.map_or_else(String::new, |pair| format!("{:.2}", order(pair))),
            format!("{:.0e}", case.errors[1]),
            format!("{:.0e}", case.asymmetry),
        ]);
    }
    table
}

fn chart(cases: &[Ending]) -> Chart {
    let series = [(Shape::Tet4, "triangles"), (Shape::Hex8, "quadrangles")].map(|(shape, name)| {
        let own = cases.iter().filter(|case| case.shape == shape);
        Series::line(name, own.map(|case| (case.size, case.errors[0])).collect())
    });
    Chart {
        series: series.into(),
        rates: vec![Rate {
            series: 0,
            rate: 2.0,
        }],
        ..Chart::new(
            "Joint that ends in the rock: error of its permeability towards the tip",
            Axis::logarithmic("size of facets (m)"),
            Axis::logarithmic("error of k_xx (relative)"),
        )
    }
}

const PROBLEM: &str = "A unit cube in rigid rock under pressures that are linear all over its outer \
    surface; the mean flux is the permeability tensor. Joints of 0.1 mm go through it, straight and \
    leaning, or end in it.";

fn run(effort: Effort) -> Finding {
    let (shapes, sizes): (&[Shape], &[usize]) = match effort {
        Effort::Quick => (&[Shape::Tet4], &[4, 8]),
        Effort::Full => (
            &[Shape::Tet4, Shape::Tet10, Shape::Hex8, Shape::Prism6],
            &[4, 8, 16, 32, 64],
        ),
    };
    let cases = exact_cases(shapes);
    let endings: Vec<Ending> = [Shape::Tet4, Shape::Hex8]
        .into_iter()
        .flat_map(|shape| sizes.iter().map(move |&n| ending(shape, n)))
        .collect();
    let worst = largest(cases.iter().map(|case| case.error));
    let asymmetry = largest(
        cases
            .iter()
            .map(|case| case.asymmetry)
            .chain(endings.iter().map(|case| case.asymmetry)),
    );
    let finest = 1.0 / sizes[sizes.len() - 1] as f64;
    let last = endings.iter().filter(|case| case.size == finest);
    let last = largest(last.map(|case| case.errors[0]));
    let pairs = endings
        .windows(2)
        .filter(|pair| pair[0].shape == pair[1].shape);
    let lowest = pairs.map(order).fold(f64::INFINITY, f64::min);
    let most = sizes[sizes.len() - 1] * (sizes[sizes.len() - 1] + 1);
    Finding::new([
        format!("through-going joints {worst:.0e}; a tip {}", percent(last)),
        (most / 2).to_string(),
    ])
    .text(PROBLEM)
    .closed_form(CLOSED_FORM, PAGE.subject)
    .text("Joints that go through the body:")
    .table_in("permeability-exact", exact_table(&cases))
    .text("The joint that ends in the rock:")
    .chart("permeability", chart(&endings))
    .table(ending_table(&endings))
    .shows(format!(
        "Of joints that go through the body the tensor is exact on every mesh, the largest error \
         {worst:.0e}. It is symmetric to {asymmetry:.0e} in every case, also where it is not exact. \
         Towards the tip of a joint that ends in the rock it converges with at least the order \
         {lowest:.2}, and is {} off at the finest mesh; along the tip, where pressure is linear, it \
         is exact.",
        percent(last)
    ))
}
