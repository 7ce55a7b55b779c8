//! All treatments over eight decades of their own parameter.

use kluft::chart::{Axis, Chart, Series};
use lie_mesh::Shape;
use lie_solver::LinearMethod;

use crate::pressed::{self, Pressed, bent_crack, crack_traction, inclined_traction};
use crate::studies::{Effort, Finding, Study, Table};
use crate::treatments::{self, ALL, Point, Solved, Treatment, solve};
use crate::words::{breaks, closure_text, iterations_text, ours};

pub const INCLINED: Study = Study {
    name: "inclined",
    title: "An inclined joint in uniform stress",
    sweep: "K_n, K_n0 or r from 1e-4 to 1e4 E/h",
    run: run_inclined,
};

pub const CRACK: Study = Study {
    name: "crack",
    title: "A crack that bending half opens",
    sweep: "K_n, K_n0 or r from 1e-4 to 1e4 E/h",
    run: run_crack,
};

/// What is measured of one treatment at one stiffness.
pub struct Case {
    pub contrast: f64,
    /// Nothing if it failed.
    pub solved: Option<Solved>,
    pub closure: f64,
    pub traction: f64,
    pub from_contact: f64,
    pub apart: f64,
    pub aperture: f64,
}

/// All cases of one treatment.
pub struct Curve {
    pub treatment: Treatment,
    pub name: &'static str,
    pub cases: Vec<Case>,
}

impl Curve {
    fn line(&self, of: impl Fn(&Case) -> f64) -> Series {
        let points = self.cases.iter().map(|case| (case.contrast, of(case)));
        Series::line(self.name, points.collect())
    }

    fn converged(&self) -> impl Iterator<Item = (&Case, &Solved)> {
        let cases = self.cases.iter();
        cases.filter_map(|case| Some((case, case.solved.as_ref()?)))
    }

    pub fn failures(&self) -> usize {
        self.cases.len() - self.converged().count()
    }
}

/// Solves all treatments; contact, which has no parameter, once for each of its points.
fn curves(scene: &Pressed, exponents: &[i32], exact: &dyn Fn(&Point) -> f64) -> Vec<Curve> {
    let contact = solve(scene, Treatment::Contact, 0.0, LinearMethod::Direct);
    let contact = contact.expect("contact converges");
    let case = |treatment: Treatment, exponent: i32| {
        let contrast = 10.0_f64.powi(exponent);
        let solved = match treatment {
            Treatment::Contact => Some(contact.clone()),
            _ => solve(
                scene,
                treatment,
                contrast * scene.scale,
                LinearMethod::Direct,
            ),
        };
        let measure = |of: &dyn Fn(&[Point]) -> f64| {
            let solved = solved.as_ref();
            solved.map_or(f64::NAN, |solved| of(&solved.points))
        };
        let same = |points: &[Point]| {
            let (mut squares, mut whole) = (0.0, 0.0);
            for (point, other) in points.iter().zip(&contact.points) {
                squares += point.area * (point.traction - other.traction).powi(2);
                whole += point.area * other.traction.powi(2);
            }
            (squares / whole).sqrt()
        };
        Case {
            contrast,
            closure: measure(&treatments::closure),
            traction: measure(&|points| treatments::traction_error(points, exact)),
            from_contact: measure(&same),
            apart: measure(&|points| treatments::apart(points, &contact.points)),
            aperture: measure(&treatments::aperture_left),
            solved,
        }
    };
    let curve = |&(treatment, name): &(Treatment, &'static str)| Curve {
        treatment,
        name,
        cases: exponents.iter().map(|&e| case(treatment, e)).collect(),
    };
    ALL.iter().map(curve).collect()
}

fn table(curves: &[Curve]) -> Table {
    let mut table = Table::new(&[
        "treatment",
        "parameter (E/h)",
        "deepest closure / b0",
        "traction error",
        "traction against contact",
        "mean opening against contact / b0",
        "mean aperture of what is pressed / b0",
        "Newton",
        "outer",
        "factorisations",
        "seconds",
        "memory predicted (MB)",
    ]);
    for curve in curves {
        for case in &curve.cases {
            let count = |of: &dyn Fn(&Solved) -> String| {
                let solved = case.solved.as_ref();
                solved.map_or("failed".to_owned(), of)
            };
            table.push([
                curve.name.to_owned(),
                format!("{:e}", case.contrast),
                format!("{:.3e}", case.closure),
                format!("{:.2e}", case.traction),
                format!("{:.2e}", case.from_contact),
                format!("{:.3e}", case.apart),
                format!("{:.3e}", case.aperture),
                count(&|s| s.newton.to_string()),
                count(&|s| s.outer.to_string()),
                count(&|s| s.factorisations.to_string()),
                count(&|s| format!("{:.3}", s.seconds)),
                count(&|s| format!("{:.0}", s.memory as f64 / 1e6)),
            ]);
        }
    }
    table
}

/// A chart of one measure of all treatments.
fn chart(curves: &[Curve], title: &str, y: Axis, of: impl Fn(&Case) -> f64) -> Chart {
    Chart {
        series: curves.iter().map(|curve| curve.line(&of)).collect(),
        failure: "not converged".into(),
        ..Chart::new(
            title,
            Axis::logarithmic("parameter: K_n, K_n0 or r in E/h"),
            y,
        )
    }
}

fn newton(case: &Case) -> f64 {
    let solved = case.solved.as_ref();
    solved.map_or(f64::NAN, |solved| solved.newton as f64)
}

fn seconds(case: &Case) -> f64 {
    let solved = case.solved.as_ref();
    solved.map_or(f64::NAN, |solved| solved.seconds)
}

/// The curve of a treatment.
pub fn of(curves: &[Curve], treatment: Treatment) -> &Curve {
    let found = curves.iter().find(|curve| curve.treatment == treatment);
    found.expect("a treatment of the sweep")
}

/// Smallest and largest of a measure where a curve converged.
pub fn range(curve: &Curve, of: impl Fn(&Case, &Solved) -> f64) -> (f64, f64) {
    let values = curve.converged().map(|(case, solved)| of(case, solved));
    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
        (low.min(value), high.max(value))
    })
}

/// What must hold in both scenes.
fn misses(curves: &[Curve]) -> Vec<String> {
    let mut misses = Vec::new();
    for curve in curves {
        if curve.treatment != Treatment::Augmented && curve.failures() > 0 {
            misses.push(format!("{}: {} failures", curve.name, curve.failures()));
        }
        for (case, solved) in curve.converged() {
            let smallest = solved.points.iter().map(|point| point.aperture);
            let smallest = smallest.fold(f64::INFINITY, f64::min);
            let positive = [Treatment::Logarithmic(None), Treatment::Hyperbolic(1.0)];
            if positive.contains(&curve.treatment) && smallest <= 0.0 {
                misses.push(format!(
                    "{} at {:e} E/h: aperture {smallest:e} m",
                    curve.name, case.contrast
                ));
            }
            if curve.treatment == Treatment::Augmented && case.from_contact > 1e-6 {
                misses.push(format!(
                    "augmented Lagrangian at r = {:e} E/h: {:.1e} from contact",
                    case.contrast, case.from_contact
                ));
            }
        }
    }
    misses
}

/// From where on a measure of a curve stays below a bound (E/h).
fn below(curve: &Curve, bound: f64, of: impl Fn(&Case) -> f64) -> String {
    let above = curve.cases.iter().rposition(|case| {
        let value = of(case);
        value.is_nan() || value > bound
    });
    let next = above.map_or(0, |last| last + 1);
    let case = curve.cases.get(next);
    case.map_or("nowhere".into(), |case| {
        format!("from {:e} E/h on", case.contrast)
    })
}

fn exponents(effort: Effort) -> Vec<i32> {
    match effort {
        Effort::Quick => vec![-4, 0, 4],
        Effort::Full => (-4..=4).collect(),
    }
}

fn run_inclined(effort: Effort) -> Finding {
    let scene = pressed::inclined();
    let curves = curves(&scene, &exponents(effort), &|_| inclined_traction());
    let mut misses = misses(&curves);
    let worst = curves
        .iter()
        .map(|curve| range(curve, |case, _| case.traction).1);
    let worst = worst.fold(0.0, f64::max);
    if worst > 1e-6 {
        misses.push(format!("a traction is off by {worst:.1e}"));
    }
    let floor = || Axis::logarithmic("deepest closure / b0").from(1e-16);
    Finding {
        breaks: breaks(&curves),
        ours: ours(&curves),
        paragraph: format!(
            "A column with a joint that dips 50 degrees, under 10 MPa on top. The stress is uniaxial whatever the joint is, so its \
             normal traction is {:.4} MPa for every treatment that settles; they differ in how far the walls close.\n\n{}\n\nStatics \
             fixes the tractions: those of settled cases are exact to {worst:.0e}.\n\n{}",
            inclined_traction() / 1e6,
            closure_text(&curves),
            iterations_text(&curves)
        ),
        charts: vec![
            (
                "inclined-closure",
                chart(&curves, "Inclined joint: closure", floor(), |case| {
                    case.closure
                }),
            ),
            (
                "inclined-traction",
                chart(
                    &curves,
                    "Inclined joint: traction against the closed form",
                    Axis::logarithmic("error of the traction, L2").from(1e-16),
                    |case| case.traction,
                ),
            ),
            (
                "inclined-iterations",
                chart(
                    &curves,
                    "Inclined joint: iterations",
                    Axis::logarithmic("linear solves"),
                    newton,
                ),
            ),
        ],
        table: table(&curves),
        misses,
    }
}

/// Traction along the crack, mean by area of the facet points at a place; the ends, which do not move, left out.
pub fn profile(points: &[Point]) -> impl Fn(f64) -> f64 + use<> {
    let mut places: std::collections::BTreeMap<i64, (f64, f64)> = std::collections::BTreeMap::new();
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

fn run_crack(effort: Effort) -> Finding {
    let (parts, finer) = match effort {
        Effort::Quick => (1, 2),
        Effort::Full => (1, 4),
    };
    let scene = bent_crack(Shape::Hex8, parts);
    let fine = bent_crack(Shape::Hex8, finer);
    let fine =
        solve(&fine, Treatment::Contact, 0.0, LinearMethod::Direct).expect("contact converges");
    let reference = profile(&fine.points);
    let end = |x: f64| x.abs() > 1.0 - 1e-9;
    // Nothing moves at the ends, so what a treatment carries there is no answer of its own.
    let exact = |point: &Point| {
        if end(point.x) {
            point.traction
        } else {
            reference(point.x)
        }
    };
    let curves = curves(&scene, &exponents(effort), &exact);
    let unbounded =
        treatments::traction_error(&inside(&fine.points), |point| crack_traction(point.x));
    let mut misses = misses(&curves);
    if unbounded.is_nan() || unbounded > 0.1 {
        misses.push(format!(
            "reference: {unbounded:.2} from the closed form of an unbounded plate"
        ));
    }
    let open = fine.points.iter().filter(|point| point.opening > 1e-9);
    let from = open.map(|point| point.x).fold(f64::INFINITY, f64::min);
    Finding {
        breaks: breaks(&curves),
        ours: ours(&curves),
        paragraph: crack_text(&curves, (parts, finer), (unbounded, from)),
        charts: crack_charts(&curves),
        table: table(&curves),
        misses,
    }
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
    let memory = of(curves, Treatment::Contact).converged().next();
    let memory = memory.map_or(f64::NAN, |(_, solved)| solved.memory as f64 / 1e6);
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
         stiffness decides where in between.\n\n{}\n\nSeconds of one run with the analysis of the matrix, for what they are worth: \
         linear {:.2} to {:.2}, logarithmic {:.2} to {:.2}, hyperbolic {:.2} to {:.2}, augmented Lagrangian {:.2} to {:.2}, contact \
         {:.2}. All have the same matrix, and a predicted {memory:.0} MB for its factor.",
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
    ]
}
