//! Sneddon's disc: meshes of both orders, uniform, graded and adaptive.

use kluft_chart::{Axis, Chart, Series};

use super::charts::{error_chart, half_circle};
use super::scene::{self, Outcome};
use crate::report::{Effort, Finding, Study, Table, count, digits, percent, reaches, slope};

pub const PAGE: Study = Study {
    name: "penny",
    title: "Penny-shaped crack under pressure",
    subject: "I. N. Sneddon, Proc. R. Soc. A 187, 1946",
    run,
};

const CLOSED_FORM: &str = "
With E = 25 GPa, nu = 0.25, p = 2 MPa, a = 1 m, in unbounded rock:

    opening   w(r) = 8 (1 - nu²) p a / (pi E) sqrt(1 - r²/a²)     1.909859e-4 m at the centre
    volume    V = 16 (1 - nu²) p a³ / (3 E)                       4.000000e-4 m³
    front     K_I = 2 p sqrt(a/pi)                                2.256758 MPa sqrt(m)";

/// Error at which meshes are compared.
const AIM: f64 = 0.01;

/// A mesh and its run.
struct Case {
    /// Size at the front (m), or the tolerance of an adaptive mesh.
    h: f64,
    outcome: Outcome,
}

/// Meshes of one kind.
struct Family {
    name: &'static str,
    cases: Vec<Case>,
}

impl Family {
    fn of(name: &'static str, sizes: &[f64], mesh: impl Fn(f64) -> String) -> Self {
        let case = |&h: &f64| Case {
            h,
            outcome: scene::run("penny", &mesh(h), &[]),
        };
        let cases = sizes.iter().map(case).collect();
        Self { name, cases }
    }

    /// A measure's error over the unknowns.
    fn curve(&self, measure: &str) -> Vec<(f64, f64)> {
        let of = |case: &Case| (case.outcome.unknowns() as f64, case.outcome.error(measure));
        self.cases.iter().map(of).collect()
    }

    /// Observed order of the opening in L2 over the cell size, between the two finest meshes.
    fn order(&self) -> f64 {
        let point = |case: &Case| (case.h, case.outcome.error("opening_l2"));
        let last = self.cases.len() - 1;
        slope(point(&self.cases[last - 1]), point(&self.cases[last]))
    }
}

/// All cells are proportional to `h`.
fn uniform(h: f64, order: u32, quarter_points: bool) -> String {
    let (grow, far) = (1.5 * h, (37.5 * h).min(10.0));
    format!(
        "parameters = {{ h = {h}, h_disc = {h}, grow = {grow}, h_far = {far} }}\norder = \
         {order}\nquarter_points = {quarter_points}"
    )
}

/// Cells three times as large in the middle of the disc, growing by half their distance away from
/// it.
fn graded(h: f64) -> String {
    let middle = 3.0 * h;
    format!("parameters = {{ h = {h}, h_disc = {middle}, grow = 0.5 }}\norder = 2")
}

fn adaptive(tolerance: f64) -> String {
    format!(
        "{}\nadapt = {{ tolerance = {tolerance}, max_unknowns = 2e5 }}",
        uniform(0.4, 2, true)
    )
}

fn families() -> Vec<Family> {
    let sizes = [0.56, 0.4, 0.28, 0.2, 0.14];
    vec![
        Family::of("uniform, order 1", &[0.4, 0.28, 0.2, 0.14, 0.1], |h| {
            uniform(h, 1, false)
        }),
        Family::of("uniform, order 2, plain", &sizes, |h| uniform(h, 2, false)),
        Family::of("uniform, quarter points", &sizes, |h| uniform(h, 2, true)),
        Family::of("graded, plain", &[0.2, 0.1, 0.05, 0.025], |h| {
            graded(h) + "\nquarter_points = false"
        }),
        Family::of("graded, quarter points", &[0.2, 0.1, 0.05, 0.025], graded),
        Family::of("adaptive", &[0.1, 0.05, 0.03, 0.015], adaptive),
    ]
}

fn table(families: &[Family]) -> Table {
    let mut table = Table::new(&[
        "meshes",
        "h (m), or tolerance",
        "unknowns",
        "opening, L2",
        "order of it",
        "centre (m)",
        "error",
        "volume (m³)",
        "error of it",
        "K_I (Pa sqrt(m))",
        "K_I error",
    ]);
    for family in families {
        let mut before: Option<(f64, f64)> = None;
        for Case { h, outcome } in &family.cases {
            let here = (*h, outcome.error("opening_l2"));
            let order = before.filter(|_| family.name != "adaptive");
            let order = order.map_or(String::new(), |before| {
                format!("{:.2}", slope(before, here))
            });
            before = Some(here);
            table.push([
                family.name.to_owned(),
                h.to_string(),
                outcome.unknowns().to_string(),
                percent(here.1),
                order,
                format!("{:.5e}", outcome.value("centre_opening")),
                percent(outcome.error("centre_opening")),
                format!("{:.5e}", outcome.value("volume")),
                percent(outcome.error("volume")),
                format!("{:.4e}", outcome.value("stress_intensity")),
                percent(outcome.error("stress_intensity")),
            ]);
        }
    }
    table
}

fn chart(families: &[Family], measure: &str, what: &str) -> Chart {
    let lines = families.iter();
    let lines = lines.map(|family| Series::line(family.name, family.curve(measure)));
    error_chart("Disc under pressure", what, lines)
}

/// Opening over the radius, in 1e-4 m.
fn profile(outcome: &Outcome) -> Vec<(f64, f64)> {
    let nodes = outcome.facet_nodes();
    let points = nodes
        .iter()
        .map(|(x, result)| (x.length(), 1e4 * result.opening));
    scene::thinned(points.collect(), 1.0, 26)
}

fn profile_chart(families: &[Family]) -> Chart {
    let first = &families[0].cases[2].outcome;
    let closed_form = half_circle(1e4 * first.exact("centre_opening").max(1.909_859e-4));
    let last = |family: &Family| family.cases.last().map(|case| profile(&case.outcome));
    Chart {
        series: vec![
            Series::line("closed form", closed_form),
            Series::scatter("uniform, order 1", last(&families[0]).expect("a mesh")),
            Series::scatter("adaptive", last(&families[5]).expect("a mesh")),
        ],
        ..Chart::new(
            "Disc under pressure: opening from the centre to the front",
            Axis::linear("distance from the centre (m)"),
            Axis::linear("opening (10⁻⁴ m)"),
        )
    }
}

/// Unknowns at which a family reaches the aim, in words, and the number.
fn at_aim(family: &Family, measure: &str) -> (String, f64) {
    let (unknowns, continued) = reaches(&family.curve(measure), AIM);
    let how = if continued { " (extrapolated)" } else { "" };
    (format!("{}{how}", count(unknowns)), unknowns)
}

const PROBLEM: &str = "A free crack, the disc r < 1 m, is opened by a fluid pressure of 2 MPa in \
    the middle of a cube of rock of side 20 m, free of traction (`geometries/penny`). \"Uniform\" \
    meshes have all cell sizes proportional to h; \"graded\" ones h at the front, 3 h in the \
    middle of the disc, growing by 0.5 m a metre; \"adaptive\" ones come from `[mesh] adapt` with \
    a tolerance, starting at h = 0.4 m.";

fn run(_: Effort) -> Finding {
    let families = families();
    let best = families.iter().flat_map(|family| &family.cases);
    let best = best.min_by(|a, b| {
        let of = |case: &Case| case.outcome.error("opening_l2");
        of(a).total_cmp(&of(b))
    });
    let best = &best.expect("cases").outcome;
    let unknowns = families.iter().flat_map(|family| &family.cases);
    let unknowns = unknowns.map(|case| case.outcome.unknowns()).max();
    let [opening, volume] = ["opening_l2", "volume"].map(|measure| percent(best.error(measure)));
    let reached = format!("opening in L2 {opening}, volume {volume}");
    Finding::new([reached, unknowns.expect("cases").to_string()])
        .text(PROBLEM)
        .closed_form(CLOSED_FORM, PAGE.subject)
        .chart(
            "penny-opening",
            chart(&families, "opening_l2", "opening in L2"),
        )
        .chart("penny-volume", chart(&families, "volume", "volume"))
        .chart("penny-profile", profile_chart(&families))
        .table(table(&families))
        .shows(shows(&families))
}

fn shows(families: &[Family]) -> String {
    let orders = families
        .iter()
        .map(|family| format!("{:.2}", family.order()));
    let orders: Vec<String> = orders.collect();
    let [linear, plain, quarter] = [&orders[0], &orders[1], &orders[2]];
    let reached = |measure: &str| -> Vec<(String, f64)> {
        let each = families.iter().map(|family| at_aim(family, measure));
        each.collect()
    };
    let (opening, volume) = (reached("opening_l2"), reached("volume"));
    let [few, many] = [&volume[5], &volume[1]];
    [
        format!(
            "The displacements at the front follow the square root of the distance, and no \
             polynomial does: on uniform meshes the opening converges in L2 with order {linear} in \
             h for cells of order 1 and {plain} for order 2, against {quarter} with quarter points \
             on the same meshes."
        ),
        format!(
            "An opening within 1 % in L2 takes {} unknowns on uniform meshes of order 1, {} of \
             order 2 and {} with quarter points; graded by hand with quarter points {}; adaptive {}.",
            opening[0].0, opening[1].0, opening[2].0, opening[4].0, opening[5].0,
        ),
        format!(
            "So an adaptive mesh has {} of the unknowns of a uniform one of order 2 and {} of \
             order 1, and for a volume within 1 % {} of order 2 ({} against {}).",
            ratio(opening[5].1, opening[1].1),
            ratio(opening[5].1, opening[0].1),
            ratio(few.1, many.1),
            few.0,
            many.0,
        ),
        "Numbers called extrapolated continue the line through the last two meshes, or the first \
         two; no such mesh was solved. \"Uniform\" meshes here still grow away from the disc; \
         [Adaptive and uniform meshes](adaptive.md) has truly uniform ones, none extrapolated, in \
         a smaller body. Errors below some tenths of a percent also hold what the cube of 20 m, \
         which is not unbounded, does to the opening."
            .to_owned(),
    ]
    .join(" ")
}

/// A ratio of unknowns as one over a number.
fn ratio(few: f64, many: f64) -> String {
    format!("1/{}", digits(many / few))
}
