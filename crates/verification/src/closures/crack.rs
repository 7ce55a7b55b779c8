//! A crack that bending half opens, against exact contact on a finer mesh.

use std::collections::BTreeMap;

use kluft_chart::{Axis, Chart};
use kluft_mesh::Shape;
use kluft_solver::LinearMethod;

use super::equal_terms::{Charted, below, chart, curves, exponents, misses, of, table};
use super::measured::{Curve, Terms, newton, range, seconds, solve_memory};
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

/// Traction along the crack, mean by area of the facet points at a place; the ends, which do not
/// move, left out.
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
    let reference = Reference {
        parts: (parts, finer),
        unbounded,
        open_from: open.map(|point| point.x).fold(f64::INFINITY, f64::min),
    };
    Finding::new([breaks(&curves), ours(&curves)])
        .story(texts(&curves, &reference), crack_charts(&curves))
        .numbers(table(&curves))
        .missing(misses)
}

/// The paragraphs of the page, which its charts follow one by one.
fn texts(curves: &[Curve], reference: &Reference) -> [String; 7] {
    [
        scene_text(reference),
        closure_text(curves),
        traction_text(curves),
        apart_text(curves),
        iterations_text(curves),
        seconds_text(curves),
        memory_text(curves),
    ]
}

/// What the treatments are compared with.
struct Reference {
    /// Cells in 1/8 m of the meshes, and of that of the reference.
    parts: (usize, usize),
    /// Difference from the closed form of an unbounded plate, L2.
    unbounded: f64,
    /// Where it begins to be open (m).
    open_from: f64,
}

fn scene_text(reference: &Reference) -> String {
    let (parts, finer) = reference.parts;
    format!(
        "A frictionless crack of 2 m through a plate of 8 m in plane strain, bent in its plane (10 \
         MPa at the end of the crack) and pressed by a fifth of that: it is open from x = {:.2} m \
         to its end at 1 m and closed elsewhere. Cells are 1/{} m; the reference is exact contact \
         on the nested mesh with cells of 1/{} m, which is {:.1} % (L2) from the closed form of an \
         unbounded plate (open from -0.07 m, where K_I of the open part vanishes).",
        reference.open_from,
        8 * parts,
        8 * finer,
        100.0 * reference.unbounded,
    )
}

fn traction_text(curves: &[Curve]) -> String {
    let contact = range(of(curves, Treatment::Contact), |case, _| case.traction).0;
    let [linear, logarithmic, hyperbolic] =
        LAWS.map(|law| below(of(curves, law), 2.0 * contact, |case| case.traction));
    format!(
        "Against the reference, contact itself is {contact:.1e} off: that is the mesh. The linear \
         penalty comes within twice that {linear}, the logarithmic law {logarithmic}, the \
         hyperbolic one {hyperbolic}. A soft penalty does not know that walls touch. A soft law \
         with an asymptote acts as contact of walls that are b0 further apart, a stiff one as \
         contact where it begins to resist."
    )
}

/// Laws that have a stiffness.
const LAWS: [Treatment; 3] = [
    Treatment::Linear,
    Treatment::Logarithmic(None),
    Treatment::Hyperbolic(1.0),
];

fn apart_text(curves: &[Curve]) -> String {
    let [linear, logarithmic, hyperbolic] = LAWS.map(|law| {
        let cases = &of(curves, law).cases;
        format!(
            "{:.1e} to {:.1e}",
            cases[0].apart,
            cases[cases.len() - 1].apart
        )
    });
    format!(
        "How far the walls are from where exact contact has them, on the same mesh, in b0: linear \
         {linear}, logarithmic {logarithmic}, hyperbolic {hyperbolic}; the laws with an asymptote \
         are wrong by b0 or so at most, and the stiffness decides where in between."
    )
}

fn seconds_text(curves: &[Curve]) -> String {
    let times = |treatment| range(of(curves, treatment), |_, solved| solved.seconds);
    let [linear, logarithmic, hyperbolic] = LAWS.map(|law| between(times(law)));
    format!(
        "Seconds with the analysis of the matrix: linear {linear}, logarithmic {logarithmic}, \
         hyperbolic {hyperbolic}, augmented Lagrangian {}, contact {:.2}.",
        between(times(Treatment::Augmented)),
        times(Treatment::Contact).0,
    )
}

fn between((low, high): (f64, f64)) -> String {
    format!("{low:.2} to {high:.2}")
}

fn crack_charts(curves: &[Curve]) -> [(&'static str, Chart); 6] {
    let closure_axis = Axis::logarithmic("deepest closure / b0").from(1e-16);
    let traction_axis = Axis::logarithmic("error of the traction, L2");
    let apart_axis = Axis::logarithmic("mean difference / b0").from(1e-12);
    let newton_axis = Axis::logarithmic("linear solves");
    let seconds_axis = Axis::logarithmic("seconds");
    let memory_axis = Axis::linear("measured growth of resident memory (MB)");
    let against = [
        "traction against the finer mesh",
        "openings against exact contact",
    ];
    let drawn: [(&'static str, &str, Axis, Charted); 6] = [
        ("crack-closure", "deepest closure", closure_axis, |case| {
            case.closure
        }),
        ("crack-traction", against[0], traction_axis, |case| {
            case.traction
        }),
        ("crack-apart", against[1], apart_axis, |case| case.apart),
        ("crack-iterations", "iterations", newton_axis, newton),
        ("crack-seconds", "time", seconds_axis, seconds),
        (
            "crack-memory",
            "memory of the solve",
            memory_axis,
            solve_memory,
        ),
    ];
    drawn.map(|(name, what, axis, of)| {
        let title = format!("Half-open crack: {what}");
        (name, chart(curves, &title, axis, of))
    })
}
