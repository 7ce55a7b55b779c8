//! Adaptive meshes beside truly uniform ones: Sneddon's disc in a body small enough for both.

use kluft_chart::{Chart, Series};

use super::charts::error_chart;
use super::scene::{self, Outcome};
use crate::report::{Effort, Finding, Study, Table, count, digits, percent, reaches, slope};

pub const PAGE: Study = Study {
    name: "adaptive",
    title: "Adaptive and uniform meshes",
    subject: "an adaptive solution in the same body, far finer, with the uncertainty that it \
              states; I. N. Sneddon, 1946, for the shape",
    run,
};

const CLOSED_FORM: &str = "
None for a disc in a cube. Volume and opening at the centre are compared with those of the
reference, and the opening in L2 with

    w(r) = c sqrt(1 - r²/a²)        c such that the volume is that of the reference

The faces of the cube change this shape a little; how much more the reference is open at the centre
says by how much.";

/// Half the side of the body (m): with more, 1 % is out of reach of uniform meshes.
const HALF: &str = "3.0";
/// Error at which meshes are compared.
const AIM: f64 = 0.01;
/// Pressure of the scene (Pa).
const PRESSURE: f64 = 2e6;
/// Tolerance of the reference.
const FINEST: f64 = 0.005;

/// What others are compared with.
struct Reference {
    volume: f64,
    centre: f64,
    /// Pressure under which the disc in unbounded rock has this volume (Pa).
    pressure: f64,
    /// How much more it is open at the centre than that disc, as a share.
    shape: f64,
    /// Uncertainty that it states, as a share of the mean opening.
    stated: f64,
    unknowns: f64,
}

/// A mesh, and how far it is off.
struct Case {
    /// Size of all cells, or tolerance.
    setting: String,
    unknowns: f64,
    /// Errors of the opening in L2, of the volume, and at the centre.
    errors: [f64; 3],
}

/// Meshes of one kind, from coarse to fine.
struct Family {
    name: &'static str,
    cases: Vec<Case>,
}

const MEASURES: [&str; 3] = ["opening in L2", "volume", "opening at the centre"];

impl Family {
    fn curve(&self, measure: usize) -> Vec<(f64, f64)> {
        let of = |case: &Case| (case.unknowns, case.errors[measure]);
        self.cases.iter().map(of).collect()
    }

    /// Order of the opening in L2 in the third root of the unknowns, over all but the coarsest
    /// mesh.
    fn order(&self) -> f64 {
        let curve = self.curve(0);
        order(curve[1], curve[curve.len() - 1])
    }

    /// Unknowns that the aim takes, if the meshes enclose it.
    fn at_aim(&self, measure: usize) -> Option<f64> {
        let (unknowns, is_continued) = reaches(&self.curve(measure), AIM);
        (!is_continued).then_some(unknowns)
    }
}

fn order(from: (f64, f64), to: (f64, f64)) -> f64 {
    -3.0 * slope(from, to)
}

/// The disc in the small body; the closed form is given this pressure (Pa).
fn solve(mesh: &str, pressure: f64) -> Outcome {
    let form = format!("radius = 1.0\npressure = {pressure}");
    let replaced = [("10.0", HALF), ("radius = 1.0\npressure = 2e6", &form)];
    scene::run("penny", mesh, &replaced)
}

fn uniform(h: f64, more: &str) -> String {
    format!(
        "parameters = {{ h = {h}, h_disc = {h}, h_far = {h}, grow = 0, half = {HALF} }}\n{more}"
    )
}

fn adaptive(tolerance: f64) -> String {
    format!(
        "parameters = {{ h = 0.4, h_disc = 0.4, grow = 0.6, half = {HALF} }}\norder = 2\nadapt = \
         {{ tolerance = {tolerance} }}"
    )
}

impl Reference {
    fn of(tolerance: f64) -> Self {
        let found = solve(&adaptive(tolerance), PRESSURE);
        let (volume, centre) = (found.value("volume"), found.value("centre_opening"));
        let scale = volume / found.exact("volume");
        let stated = found.of_fracture(&["aperture_uncertainty"]);
        Self {
            volume,
            centre,
            pressure: PRESSURE * scale,
            shape: centre / (scale * found.exact("centre_opening")) - 1.0,
            stated: stated.unwrap_or(f64::NAN) * std::f64::consts::PI / volume,
            unknowns: found.unknowns() as f64,
        }
    }

    fn case(&self, setting: f64, mesh: &str) -> Case {
        let outcome = solve(mesh, self.pressure);
        let off = |found: f64, reference: f64| (found / reference - 1.0).abs();
        Case {
            setting: setting.to_string(),
            unknowns: outcome.unknowns() as f64,
            errors: [
                outcome.error("opening_l2"),
                off(outcome.value("volume"), self.volume),
                off(outcome.value("centre_opening"), self.centre),
            ],
        }
    }

    fn family(&self, name: &'static str, settings: &[f64], mesh: impl Fn(f64) -> String) -> Family {
        let cases = settings
            .iter()
            .map(|&setting| self.case(setting, &mesh(setting)));
        Family {
            name,
            cases: cases.collect(),
        }
    }
}

fn families(reference: &Reference) -> Vec<Family> {
    vec![
        reference.family("uniform, order 1", &[0.56, 0.4, 0.28, 0.2], |h| {
            uniform(h, "order = 1")
        }),
        reference.family("uniform, order 2, plain", &[0.56, 0.4, 0.28], |h| {
            uniform(h, "order = 2\nquarter_points = false")
        }),
        reference.family(
            "uniform, quarter points",
            &[0.56, 0.4, 0.28, 0.2, 0.15],
            |h| uniform(h, "order = 2"),
        ),
        reference.family("adaptive", &[0.2, 0.1, 0.05, 0.025, 0.0125], adaptive),
    ]
}

fn table(families: &[Family]) -> Table {
    let mut table = Table::new(&[
        "meshes",
        "h (m), or tolerance",
        "unknowns",
        MEASURES[0],
        "order of it",
        MEASURES[1],
        MEASURES[2],
    ]);
    for family in families {
        let mut before: Option<(f64, f64)> = None;
        for case in &family.cases {
            let here = (case.unknowns, case.errors[0]);
            let order = before.map_or(String::new(), |before| {
                format!("{:.2}", order(before, here))
            });
            before = Some(here);
            table.push([
                family.name.to_owned(),
                case.setting.clone(),
                case.unknowns.to_string(),
                percent(case.errors[0]),
                order,
                percent(case.errors[1]),
                percent(case.errors[2]),
            ]);
        }
    }
    table
}

fn chart(families: &[Family], measure: usize) -> Chart {
    let what = MEASURES[measure];
    let lines = families.iter();
    let lines = lines.map(|family| Series::line(family.name, family.curve(measure)));
    error_chart("Disc in a cube", what, lines)
}

/// How many times fewer unknowns adaptive meshes take for the aim, in words.
fn comparison(families: &[Family], measure: usize) -> String {
    let [uniform, adaptive] = [2, 3].map(|family: usize| families[family].at_aim(measure));
    let what = MEASURES[measure];
    match (uniform, adaptive) {
        (Some(many), Some(few)) => format!(
            "{what}: {} on uniform meshes, {} on adaptive ones, {} times fewer",
            count(many),
            count(few),
            digits(many / few)
        ),
        _ => format!("{what}: not enclosed by these meshes"),
    }
}

fn problem() -> String {
    format!(
        "A free crack, the disc r < 1 m, is opened by a fluid pressure of 2 MPa in the middle of a \
         cube of rock of side 6 m (`geometries/penny` with half = {HALF}). \"Uniform\" meshes have \
         cells of one size h in the whole body; \"adaptive\" ones come from `[mesh] adapt` with a \
         tolerance, starting with 0.4 m at the disc. Both are of order 2 with quarter points, \
         unless named otherwise. The body is that small so that uniform meshes reach 1 %: in a \
         larger one they need more unknowns, in proportion to its volume, and adaptive ones hardly \
         any. Orders are in the third root of the unknowns, which is 1/h on uniform meshes."
    )
}

fn run(_: Effort) -> Finding {
    let reference = Reference::of(FINEST);
    let families = families(&reference);
    let all = || families.iter().flat_map(|family| &family.cases);
    let unknowns = all().map(|case| case.unknowns as usize).max();
    let compared: Vec<String> = (0..3)
        .map(|measure| comparison(&families, measure))
        .collect();
    Finding::new([
        format!("for 1 %: {}", compared[0]),
        unknowns.expect("cases").to_string(),
    ])
    .text(problem())
    .closed_form(CLOSED_FORM, PAGE.subject)
    .chart("adaptive-opening", chart(&families, 0))
    .chart("adaptive-volume", chart(&families, 1))
    .table(table(&families))
    .shows(shows(&families, &reference, &compared))
}

fn shows(families: &[Family], reference: &Reference, compared: &[String]) -> String {
    let plain = families[1].cases.last().expect("meshes");
    let orders = families
        .iter()
        .map(|family| format!("{:.2}", family.order()));
    let orders: Vec<String> = orders.collect();
    [
        format!(
            "An error of 1 % takes, every number between two meshes that were solved: {}. Without \
             quarter points no uniform mesh here comes near: {} are still {} off in L2.",
            compared.join("; "),
            count(plain.unknowns),
            percent(plain.errors[0]),
        ),
        format!(
            "The opening in L2 converges with order {} on uniform meshes of order 1, {} of order 2 \
             without and {} with quarter points, and {} on adaptive ones.",
            orders[0], orders[1], orders[2], orders[3],
        ),
        format!(
            "The reference has {} unknowns and says that its mean opening is off by at most {}; \
             all meshes open too little, so true errors are larger than the listed ones by up to \
             that, in all families alike. At the centre it is {} more open than the shape to which \
             L2 errors refer.",
            count(reference.unknowns),
            percent(reference.stated),
            percent(reference.shape),
        ),
    ]
    .join(" ")
}
