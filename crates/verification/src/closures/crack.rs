//! A crack that bending half opens, against exact contact on a finer mesh.

use std::collections::BTreeMap;

use kluft_chart::{Axis, Chart};
use kluft_mesh::Shape;
use kluft_solver::LinearMethod;

use super::equal_terms::{below, chart, curves, exponents, misses, of, table};
use super::measured::{Case, Curve, Terms, newton, range, seconds, solve_memory};
use super::memory::Place;
use super::words::{breaks, closure_text, iterations_text, memory_text, ours};
use crate::methods::treatments::{Point, Solved, Treatment, solve, traction_error};
use crate::report::{Effort, Finding, Study};
use crate::scenes::pressed::{bent_crack, crack_traction};

pub const STUDY: Study = Study {
    name: "crack",
    title: "A crack that bending half opens",
    subject: "K_n, K_n0 or r from 1e-4 to 1e4 E/h",
    run,
};

/// Traction along the crack, mean by area of the facet points at a place; the ends, which do not move, left out.
pub fn profile(points: &[Point]) -> impl Fn(f64) -> f64 + use<> {
    let mut places: BTreeMap<i64, (f64, f64)> = BTreeMap::new();
    let key = |x: f64| (1e6 * x).round() as i64;
    for point in points {
        let place = places.entry(key(point.x)).or_default();
        place.0 += point.area;
        place.1 += point.area * point.traction;
    }
    move |x| {
        places
            .get(&key(x))
            .map_or(f64::NAN, |(area, sum)| sum / area)
    }
}

/// The facet points without those at the ends of the crack.
pub fn inside(points: &[Point]) -> Vec<Point> {
    let inside = points.iter().filter(|point| point.x.abs() < 1.0 - 1e-9);
    inside.copied().collect()
}

/// Parts of the cells of the mesh that is compared, and of the one of the reference.
pub fn parts(effort: Effort) -> (usize, usize) {
    match effort {
        Effort::Quick => (1, 2),
        Effort::Full => (1, 4),
    }
}

/// Exact contact on linear hexahedra.
pub fn contact(parts: usize) -> Solved {
    let scene = bent_crack(Shape::Hex8, parts);
    let solved = solve(&scene, Treatment::Contact, 0.0, LinearMethod::Direct);
    solved.expect("contact converges")
}

/// Traction (Pa) of the finer mesh.
pub fn reference(fine: &[Point]) -> impl Fn(&Point) -> f64 + use<> {
    let profile = profile(fine);
    let end = |x: f64| x.abs() > 1.0 - 1e-9;
    // Nothing moves at the ends, so what a treatment carries there is no answer of its own.
    move |point: &Point| {
        if end(point.x) {
            point.traction
        } else {
            profile(point.x)
        }
    }
}

fn run(effort: Effort) -> Finding {
    let (parts, finer) = parts(effort);
    let place = Place::Crack(Shape::Hex8, parts);
    let scene = place.build();
    let fine = contact(finer);
    let exact = reference(&fine.points);
    let terms = Terms::new(place, &scene, &exact);
    let curves = curves(&terms, &exponents(effort));
    let unbounded = traction_error(&inside(&fine.points), |point| crack_traction(point.x));
    let mut misses = misses(&curves);
    if unbounded.is_nan() || unbounded > 0.1 {
        misses.push(format!(
            "reference: {unbounded:.2} from the closed form of an unbounded plate"
        ));
    }
    let open = fine.points.iter().filter(|point| point.opening > 1e-9);
    let from = open.map(|point| point.x).fold(f64::INFINITY, f64::min);
    Finding::new([breaks(&curves), ours(&curves)])
        .text(crack_text(&curves, (parts, finer), (unbounded, from)))
        .charts(crack_charts(&curves))
        .numbers(table(&curves))
        .missing(misses)
}

fn crack_text(
    curves: &[Curve],
    (parts, finer): (usize, usize),
    (unbounded, from): (f64, f64),
) -> String {
    let contact = range(of(curves, Treatment::Contact), |case, _| case.traction).0;
    let linear = of(curves, Treatment::Linear);
    let logarithmic = of(curves, Treatment::Logarithmic(None));
    let hyperbolic = of(curves, Treatment::Hyperbolic(1.0));
    let ends = |curve: &Curve, of: &dyn Fn(&Case) -> f64| {
        let (first, last) = (&curve.cases[0], &curve.cases[curve.cases.len() - 1]);
        format!("{:.1e} to {:.1e}", of(first), of(last))
    };
    let apart = |case: &Case| case.apart;
    let times = |treatment| range(of(curves, treatment), |_, solved| solved.seconds);
    format!(
        "A frictionless crack of 2 m through a plate of 8 m in plane strain, bent in its plane (10 MPa at the end of the crack) and \
         pressed by a fifth of that: it is open from x = {from:.2} m to its end at 1 m and closed elsewhere. Cells are 1/{} m; the \
         reference is exact contact on the nested mesh with cells of 1/{} m, which is {:.1} % (L2) from the closed form of an \
         unbounded plate (open from -0.07 m, where K_I of the open part vanishes).\n\n{}\n\nAgainst the reference, contact itself is \
         {contact:.1e} off: that is the mesh. The linear penalty comes within twice that {}, the \
         logarithmic law {}, the hyperbolic one {}. A soft penalty does not know that walls touch. A soft law with \
         an asymptote acts as contact of walls that are b0 further apart, a stiff one as contact where it begins to \
         resist.\n\nHow far the walls are from where exact contact has them, on the same mesh, in b0: linear {}, \
         logarithmic {}, hyperbolic {}; the laws with an asymptote are wrong by b0 or so at most, and the \
         stiffness decides where in between.\n\n{}\n\nSeconds with the analysis of the matrix: \
         linear {:.2} to {:.2}, logarithmic {:.2} to {:.2}, hyperbolic {:.2} to {:.2}, augmented Lagrangian {:.2} to {:.2}, contact \
         {:.2}.\n\n{}",
        8 * parts,
        8 * finer,
        100.0 * unbounded,
        closure_text(curves),
        below(linear, 2.0 * contact, |case| case.traction),
        below(logarithmic, 2.0 * contact, |case| case.traction),
        below(hyperbolic, 2.0 * contact, |case| case.traction),
        ends(linear, &apart),
        ends(logarithmic, &apart),
        ends(hyperbolic, &apart),
        iterations_text(curves),
        times(Treatment::Linear).0,
        times(Treatment::Linear).1,
        times(Treatment::Logarithmic(None)).0,
        times(Treatment::Logarithmic(None)).1,
        times(Treatment::Hyperbolic(1.0)).0,
        times(Treatment::Hyperbolic(1.0)).1,
        times(Treatment::Augmented).0,
        times(Treatment::Augmented).1,
        times(Treatment::Contact).0,
        memory_text(curves),
    )
}

fn crack_charts(curves: &[Curve]) -> Vec<(&'static str, Chart)> {
    vec![
        (
            "crack-closure",
            chart(
                curves,
                "Half-open crack: deepest closure",
                Axis::logarithmic("deepest closure / b0").from(1e-16),
                |case| case.closure,
            ),
        ),
        (
            "crack-traction",
            chart(
                curves,
                "Half-open crack: traction against the finer mesh",
                Axis::logarithmic("error of the traction, L2"),
                |case| case.traction,
            ),
        ),
        (
            "crack-apart",
            chart(
                curves,
                "Half-open crack: openings against exact contact",
                Axis::logarithmic("mean difference / b0").from(1e-12),
                |case| case.apart,
            ),
        ),
        (
            "crack-iterations",
            chart(
                curves,
                "Half-open crack: iterations",
                Axis::logarithmic("linear solves"),
                newton,
            ),
        ),
        (
            "crack-seconds",
            chart(
                curves,
                "Half-open crack: time",
                Axis::logarithmic("seconds"),
                seconds,
            ),
        ),
        (
            "crack-memory",
            chart(
                curves,
                "Half-open crack: memory of the solve",
                Axis::linear("measured growth of resident memory (MB)"),
                solve_memory,
            ),
        ),
    ]
}
