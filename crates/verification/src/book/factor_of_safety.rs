//! Factors of safety by reduced strength.

use glam::DVec3;
use kluft_chart::{Axis, Chart, Series};
use serde_json::Value;

use crate::oracles::wedge::{Wall, normal, on_plane, toppling, wedge};
use crate::report::{Effort, Finding, Study, Table, largest, percent};

use super::scene::{self, Outcome};

pub const PAGE: Study = Study {
    name: "factor-of-safety",
    title: "Factors of safety of wedges and of a block that topples",
    subject: "E. Hoek and J. W. Bray, Rock Slope Engineering, 1981; R. E. Goodman and J. W. Bray, \
              ASCE Conference on Rock Engineering for Foundations and Slopes, 1976",
    run,
};

const PROBLEM: &str = "Scenes with `[strength_reduction]`, to a thousandth. `geometries/cliff-wedge`: a \
    symmetric wedge in a vertical cliff, dry and with 5 kPa of water in both joints. \
    `geometries/wedge-slope`: a wedge between joints of unlike attitude, friction and cohesion, dry and \
    with the pyramid of water that Hoek and Bray assume. `geometries/toppling-block`: a slender block \
    that leans on a low one, in the plane. Rock deforms; limit equilibrium is that of rigid blocks.";

const CLOSED_FORM: &str = "
A wedge slides along the line where its joints meet. N_i balance weight and water U_i = A_i p_i across the line, S is the
weight along it:

    F = sum (c_i A_i + (N_i - U_i) tan phi_i) / S

The slender block (three times as high as wide, on a slope of a = 20 degrees) turns about its lower corner and pushes the low
one by P; that slides, with t = tan phi / F and weights in units of the low one's:

    P = 3 (3 sin a - cos a)/2      sin a + P = (cos a + P t) t";

/// A scene with its factor of safety.
struct Case {
    name: &'static str,
    scene: &'static str,
    mesh: &'static str,
    edits: Vec<(&'static str, &'static str)>,
    factor: f64,
    /// The direction in which the wedge slides.
    line: Option<DVec3>,
}

/// The wedge of the cliff under a pressure (Pa): line and factor.
fn cliff(pressure: f64) -> (DVec3, f64) {
    let (sin, cos) = 40_f64.to_radians().sin_cos();
    let half = 6.0 * cos;
    let top = DVec3::new(-6.0 * cos / sin, 0.0, 6.0);
    let sides = [-half, half].map(|y| DVec3::new(0.0, y, 6.0));
    let wall = |side: DVec3| {
        let across = top.cross(side);
        Wall {
            normal: across.normalize() * across.z.signum(),
            area: across.length() / 2.0,
            pressure,
            friction_angle: 40.0,
            cohesion: 0.0,
        }
    };
    let weight = 2700.0 * 9.81 * top.dot(sides[0].cross(sides[1])).abs() / 6.0;
    (-top.normalize(), wedge(weight, sides.map(wall)))
}

/// The wedge of the slope under a pressure halfway up its line (Pa), of which the pyramid leaves a
/// third in the mean.
fn slope(pressure: f64) -> (DVec3, f64) {
    let joints = [normal(45.0, 105.0), normal(70.0, 235.0)];
    let (face, ground) = (normal(65.0, 185.0), normal(12.0, 195.0));
    let top = on_plane(joints, DVec3::Z, DVec3::new(0.0, 0.0, 40.0));
    let crest = joints.map(|joint| on_plane([joint, face], ground, top));
    let weight = 2548.42 * 9.81 * top.cross(crest[0]).dot(crest[1]).abs() / 6.0;
    let wall = |joint: usize, friction_angle: f64, cohesion: f64| Wall {
        normal: joints[joint],
        area: top.cross(crest[joint]).length() / 2.0,
        pressure: pressure / 3.0,
        friction_angle,
        cohesion,
    };
    let walls = [wall(0, 30.0, 24e3), wall(1, 20.0, 48e3)];
    (-top.normalize(), wedge(weight, walls))
}

fn cases(effort: Effort) -> Vec<Case> {
    let of = |name, scene, edits, (line, factor): (DVec3, f64)| Case {
        name,
        scene,
        mesh: "",
        edits,
        factor,
        line: Some(line),
    };
    let wet = "friction_angle = 40\nfluid_pressure = 5e3\ntension_cutoff = true";
    let block = Case {
        name: "slender block on a low one",
        scene: "toppling-block",
        mesh: "dimension = 2",
        edits: Vec::new(),
        factor: toppling(20.0, 3.0, 40.0),
        line: None,
    };
    if effort == Effort::Quick {
        return vec![block];
    }
    let dry = ("expression = \"max(", "expression = \"0 * max(");
    vec![
        of(
            "wedge in a cliff, dry",
            "cliff-wedge",
            Vec::new(),
            cliff(0.0),
        ),
        of(
            "wedge in a cliff, water",
            "cliff-wedge",
            vec![("friction_angle = 40", wet)],
            cliff(5e3),
        ),
        of(
            "wedge in a slope, dry",
            "wedge-slope",
            vec![dry],
            slope(0.0),
        ),
        of(
            "wedge in a slope, water",
            "wedge-slope",
            Vec::new(),
            slope(9.81e3 * 40.0 / 2.0),
        ),
        block,
    ]
}

/// How far the block that moves most at the failing factor is off a direction (degrees).
fn off_line(found: &Value, line: DVec3) -> f64 {
    let motions = found["failing_motions"].as_array().into_iter().flatten();
    let motions = motions.map(|motion| {
        let part = |axis: usize| motion["displacement"][axis].as_f64().unwrap_or(f64::NAN);
        DVec3::new(part(0), part(1), part(2))
    });
    let most = motions.max_by(|a, b| a.length().total_cmp(&b.length()));
    most.map_or(f64::NAN, |motion| motion.angle_between(line).to_degrees())
}

/// Largest motion (m) over the factor against that of limit equilibrium, of all trials that held.
fn curve(case: &Case, found: &Value) -> Series {
    let trials = found["trials"].as_array().into_iter().flatten();
    let points = trials.filter_map(|trial| {
        let factor = trial["factor"].as_f64()? / case.factor;
        Some((factor, trial["largest_motion"].as_f64()?))
    });
    let mut points: Vec<(f64, f64)> = points.collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    Series::line(case.name, points)
}

fn run(effort: Effort) -> Finding {
    let mut table = Table::new(&[
        "blocks",
        "limit equilibrium",
        "last stable",
        "first failing",
        "middle of both, off",
        "motion off the line, degrees",
    ]);
    let (mut errors, mut turned, mut series, mut unknowns) = (vec![], vec![], vec![], 0);
    for case in cases(effort) {
        let outcome: Outcome = scene::run_edited(case.scene, case.mesh, &case.edits);
        let found = &outcome.summary["strength_reduction"];
        let [stable, failing] = ["stable", "failing"].map(|key| found[key].as_f64());
        let [stable, failing] = [stable, failing].map(|factor| factor.unwrap_or(f64::NAN));
        let off = 0.5 * (stable + failing) / case.factor - 1.0;
        let off_line = case.line.map(|line| off_line(found, line));
        errors.push(off.abs());
        turned.extend(off_line);
        series.push(curve(&case, found));
        unknowns = unknowns.max(outcome.unknowns());
        table.push([
            case.name.to_owned(),
            format!("{:.6}", case.factor),
            format!("{stable:.5}"),
            format!("{failing:.5}"),
            percent(off),
            off_line.map_or(String::new(), |angle| format!("{angle:.2}")),
        ]);
    }
    let (worst, turned) = (percent(largest(errors)), largest(turned));
    let chart = Chart {
        series,
        ..Chart::new(
            "How far blocks move before they fail",
            Axis::linear("factor against that of limit equilibrium"),
            Axis::logarithmic("largest motion since full strength, m"),
        )
    };
    Finding::new([format!("factors {worst}"), unknowns.to_string()])
        .text(PROBLEM)
        .closed_form(CLOSED_FORM, PAGE.subject)
        .table(table)
        .chart("factor-of-safety", chart)
        .shows(format!(
            "Factors are within {worst} of limit equilibrium. At the failing factor wedges move within \
             {turned:.2} degrees of the line where their joints meet."
        ))
}
