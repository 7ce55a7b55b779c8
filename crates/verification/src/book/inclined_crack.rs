//! A closed crack that slides against friction under compression.

use glam::DVec3;
use kluft_chart::{Axis, Chart, Series};

use super::charts::half_circle;
use super::scene::{self, Outcome};
use crate::report::{Effort, Finding, Study, Table, percent};

pub const PAGE: Study = Study {
    name: "inclined-crack",
    title: "Inclined crack with friction",
    subject: "A.-V. Phan, J. A. L. Napier, L. J. Gray, T. Kaplan, Int. J. Numer. Meth. Engng 57, \
              2003",
    run,
};

const CLOSED_FORM: &str = "
With E = 25 GPa, nu = 0.25, p = 100 MPa, psi = 20 degrees, phi = 30 degrees, a = 1 m, in an
unbounded plate in plane strain:

    normal traction   -p sin²psi                                                    -11.697778 MPa
    slip              4 (1 - nu²)/E p sin psi (cos psi - sin psi tan phi) sqrt(a² - x²)   3.807850e-3 m in the middle";

const SIZES: [f64; 4] = [0.16, 0.08, 0.04, 0.02];

/// The table of a sliding crack: sizes at the front (m), and what came of them.
pub fn table(cases: &[(f64, Outcome)]) -> Table {
    let mut table = Table::new(&[
        "h (m)",
        "unknowns",
        "largest slip (m)",
        "slip, L2",
        "slip, L2 inside",
        "slip, largest inside",
        "normal traction, L2",
        "normal traction, L2 inside",
    ]);
    for (h, outcome) in cases {
        let error = |measure: &str| percent(outcome.error(measure));
        table.push([
            h.to_string(),
            outcome.unknowns().to_string(),
            format!("{:.5e}", outcome.value("max_slip")),
            error("slip_l2"),
            error("slip_l2_inside"),
            error("slip_max_inside"),
            error("normal_traction_l2"),
            error("normal_traction_l2_inside"),
        ]);
    }
    table
}

/// Its errors in a few words.
pub fn reached(outcome: &Outcome) -> String {
    format!(
        "slip in L2 {}, inside {}",
        percent(outcome.error("slip_l2")),
        percent(outcome.error("slip_l2_inside"))
    )
}

/// Slip over the `distance` from the middle, in 1e-3 m, of a closed form and some meshes.
pub fn profiles(
    what: &str,
    height: f64,
    distance: fn(DVec3) -> f64,
    meshes: &[(f64, &Outcome)],
) -> Chart {
    let profile = |&(h, outcome): &(f64, &Outcome)| {
        let nodes = outcome.facet_nodes();
        let points = nodes
            .iter()
            .map(|(x, found)| (distance(*x), 1e3 * found.slip.length()));
        Series::scatter(
            format!("Kluft, h = {h} m"),
            scene::thinned(points.collect(), 1.0, 26),
        )
    };
    let closed_form = Series::line("closed form", half_circle(1e3 * height));
    Chart {
        series: std::iter::once(closed_form)
            .chain(meshes.iter().map(profile))
            .collect(),
        ..Chart::new(
            format!("{what}: slip from the middle to the front"),
            Axis::linear("distance from the middle (m)"),
            Axis::linear("slip (10⁻³ m)"),
        )
    }
}

const PROBLEM: &str = "A closed crack of half-length 1 m in a plate of side 40 m in plane strain, \
    pressed by 100 MPa at 20 degrees to the crack, slides against a friction of 30 degrees; its \
    walls are in contact without a stiffness (`geometries/inclined-crack`). Second-order prisms \
    with quarter points. \"Inside\" leaves out the tenth next to each front.";

fn run(_: Effort) -> Finding {
    let mesh = |h: f64| format!("parameters = {{ h = {h} }}\norder = 2");
    let cases = SIZES.map(|h| (h, scene::run("inclined-crack", &mesh(h), &[])));
    let [(coarsest, coarse), .., (finest, fine)] = &cases;
    let chart = profiles(
        "Line crack with friction",
        3.807_850e-3,
        |x| x.x.abs(),
        &[(*coarsest, coarse), (*finest, fine)],
    );
    Finding::new([reached(fine), fine.unknowns().to_string()])
        .text(PROBLEM)
        .closed_form(CLOSED_FORM, PAGE.subject)
        .chart("inclined-crack-slip", chart)
        .table(table(&cases))
        .shows(format!(
            "The whole crack slides and stays closed. With h = {finest} m the slip is {} off in \
             L2, inside {} at most; with h = {coarsest} m {} in L2. The normal traction, which no \
             stiffness carries, is {} off in L2 inside.",
            percent(fine.error("slip_l2")),
            percent(fine.error("slip_max_inside")),
            percent(coarse.error("slip_l2")),
            percent(fine.error("normal_traction_l2_inside")),
        ))
}
