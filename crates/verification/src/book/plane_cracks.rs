//! Cracks in the plane that meet or lie on one line.

use kluft_chart::{Axis, Chart, Series};

use crate::book::scene;
use crate::report::{Effort, Finding, Study, Table, digits, largest, percent};

pub const PAGE: Study = Study {
    name: "plane-cracks",
    title: "Cracks that meet, and cracks on one line",
    subject: "A.-V. Phan, J. A. L. Napier, L. J. Gray, T. Kaplan, Int. J. Numer. Meth. Engng 57, \
              2003; T. J. Willmore, Q. J. Mech. Appl. Math. 2, 1949",
    run,
};

const PROBLEM: &str = "Two scenes in plane strain, second-order triangles with quarter points, the \
    sides of the plate as springs of unbounded rock. `geometries/t-crack`: a crack of 100 m under \
    100 MPa ends in the middle of one of 50 m, which -100 MPa across keep in contact, with a \
    friction of 30 degrees; the numbers of Phan et al. by boundary elements and those of GEOS by \
    finite volumes are as GEOS ships them. `geometries/collinear-cracks`: two cracks of 2 m on one \
    line under 2 MPa, their inner fronts 1 m apart.";

const CLOSED_FORM: &str = "
Two cracks from c to b and from -b to -c on one line, with k^2 = 1 - c^2/b^2 and the complete elliptic
integrals K and E of modulus k, under a pressure p:

    opening   w(x) = 4 (1 - nu^2) p / E  int_c^x (b^2 E/K - t^2) / sqrt((t^2 - c^2)(b^2 - t^2)) dt

The crack that meets another has no closed form.";

/// `4 (1 - nu^2) p / E` of the collinear cracks.
const SCALE: f64 = 4.0 * (1.0 - 0.25 * 0.25) * 2e6 / 25e9;

/// What Phan et al. and GEOS have of the crack that meets another: probe, column, numbers in mm or
/// MPa.
const TABLES: [(&str, &str, f64, Option<f64>); 10] = [
    ("junction", "aperture", 135.4, Some(136.46)),
    ("above", "aperture", 236.6, None),
    ("below", "aperture", 163.0, None),
    ("closed-16", "normal_traction", -118.20, None),
    ("closed-11", "normal_traction", -114.15, None),
    ("closed-7", "normal_traction", -105.32, None),
    ("closed-4", "normal_traction", -90.42, None),
    ("closed-11", "slip", 20.41, None),
    ("closed-7", "slip", 33.30, None),
    ("closed-4", "slip", 44.80, None),
];

fn meeting() -> (Table, f64, usize) {
    let outcome = scene::run("t-crack", "order = 2\ndimension = 2");
    let mut table = Table::new(&["quantity", "Phan et al.", "GEOS", "found", "difference"]);
    let mut differences = Vec::new();
    let mut push = |quantity: String, phan: f64, geos: Option<f64>, found: f64| {
        differences.push((found / phan - 1.0).abs());
        table.push([
            quantity,
            phan.to_string(),
            geos.map_or(String::new(), |value| value.to_string()),
            format!("{found:.2}"),
            percent(found / phan - 1.0),
        ]);
    };
    let most = outcome.of("open", &["aperture", "max"]);
    push(
        "largest aperture, mm".into(),
        282.2,
        Some(280.05),
        1e3 * most,
    );
    for (probe, column, phan, geos) in TABLES {
        let at = |column| outcome.probed(probe, column);
        let (unit, scale) = match column {
            "normal_traction" => ("MPa", 1e-6),
            _ => ("mm", 1e3),
        };
        let place = format!("({}, {})", digits(at("x")), digits(at("y")));
        let quantity = format!("{} at {place}, {unit}", column.replace('_', " "));
        push(quantity, phan, geos, scale * at(column));
    }
    (table, largest(differences), outcome.unknowns())
}

/// `int_0^{pi/2} dt / sqrt(1 - k^2 sin^2 t)` and `int_0^{pi/2} sqrt(1 - k^2 sin^2 t) dt`, by the
/// arithmetic-geometric mean.
fn elliptic(k: f64) -> (f64, f64) {
    let (mut a, mut b, mut c) = (1.0, (1.0 - k * k).sqrt(), k);
    let (mut sum, mut power) = (0.5 * c * c, 1.0);
    for _ in 0..20 {
        (a, b, c) = (0.5 * (a + b), (a * b).sqrt(), 0.5 * (a - b));
        sum += power * c * c;
        power *= 2.0;
    }
    let first = std::f64::consts::FRAC_PI_2 / a;
    (first, first * (1.0 - sum))
}

/// Opening (m) at a place, the inner front at `c` and the outer one at `b`.
fn opening(x: f64, c: f64, b: f64) -> f64 {
    const PARTS: usize = 20_000;
    let (first, second) = elliptic((1.0 - c * c / (b * b)).sqrt());
    // With t^2 = c^2 + (b^2 - c^2) sin^2 s the integrand is regular.
    let end = ((x * x - c * c) / (b * b - c * c)).sqrt().asin();
    let part = |number: usize| {
        let s = (number as f64 + 0.5) / PARTS as f64 * end;
        let t = (c * c + (b * b - c * c) * s.sin().powi(2)).sqrt();
        (b * b * second / first - t * t) / t
    };
    let integral = (0..PARTS).map(part).sum::<f64>() * end / PARTS as f64;
    SCALE * integral
}

/// The openings of the two cracks on one line, over the place.
fn chart(found: &[(f64, f64)]) -> Chart {
    let places = (1..80).map(|number| 0.5 + 2.0 * f64::from(number) / 80.0);
    let closed_form = places.map(|x| (x, 1e6 * opening(x, 0.5, 2.5)));
    Chart {
        series: vec![
            Series::line("closed form", closed_form.collect()),
            Series::scatter("Kluft", found.to_vec()),
        ],
        ..Chart::new(
            "Two cracks on one line: the opening of the right one",
            Axis::linear("x, m"),
            Axis::linear("opening, micrometres"),
        )
    }
}

fn on_one_line() -> (Table, Chart, f64, usize) {
    let outcome = scene::run("collinear-cracks", "order = 2\ndimension = 2");
    let mut table = Table::new(&["at x, m", "closed form, m", "found, m", "error"]);
    let (mut errors, mut found_at) = (Vec::new(), Vec::new());
    for probe in [
        "inner-near",
        "inner-far",
        "middle",
        "outer-far",
        "outer-near",
    ] {
        let x = outcome.probed(probe, "x");
        let exact = opening(x, 0.5, 2.5);
        let found = outcome.probed(probe, "aperture") - 1e-5;
        errors.push((found / exact - 1.0).abs());
        found_at.push((x, 1e6 * found));
        table.push([
            digits(x),
            format!("{exact:.6e}"),
            format!("{found:.6e}"),
            percent(found / exact - 1.0),
        ]);
    }
    (table, chart(&found_at), largest(errors), outcome.unknowns())
}

fn run(_: Effort) -> Finding {
    let (meeting, apart, of_meeting) = meeting();
    let (line, chart, error, of_line) = on_one_line();
    let reached = format!(
        "{} from the tables, {} of openings",
        percent(apart),
        percent(error)
    );
    Finding::new([reached, of_meeting.max(of_line).to_string()])
        .text(PROBLEM)
        .closed_form(CLOSED_FORM, PAGE.subject)
        .table(meeting)
        .table_in("plane-cracks-collinear", line)
        .chart("plane-cracks", chart)
        .shows(format!(
            "Contact, friction and opening at a junction are within {} of boundary elements at all \
             points of the tables. Openings of two cracks on one line are within {} of the closed \
             form, a twentieth of a half-length behind the fronts too.",
            percent(apart),
            percent(error)
        ))
}
