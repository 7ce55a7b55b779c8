//! What only one law has: the cutoff of the logarithmic law and the largest closure of the
//! hyperbolic one, each over eight decades.

use kluft_chart::{Axis, Chart};
use kluft_mesh::Shape;

use super::crack;
use super::measured::{Case, Curve, Terms, chart, newton, range, seconds, table, worst};
use super::memory::Place;
use super::words::{memory_text, solved_text};
use crate::methods::treatments::{APERTURE, Point, Treatment};
use crate::report::{Effort, Finding, Study};
use crate::scenes::pressed::inclined_traction;

pub const CUTOFF: Study = Study {
    name: "cutoff",
    title: "The cutoff of the logarithmic law",
    subject: "b_min / b0 from 1e-1 to 1e-9, for K_n0 = 1e-4, 1e-2 and 1 E/h",
    run: run_cutoff,
};

pub const LARGEST: Study = Study {
    name: "max-closure",
    title: "The largest closure of the hyperbolic law",
    subject: "v_m / b0 from 1 to 1e-8, for K_n0 = 1e-4, 1 and 1e4 E/h",
    run: run_largest,
};

/// How far beyond its largest closure a joint may seem to be, against `b0`: the rounding of its
/// slip.
const PASSED: f64 = 1e-12;

/// A law with its own parameter.
struct Sweep {
    treatment: fn(f64) -> Treatment,
    /// Powers of ten of the parameter.
    exponents: Vec<i32>,
    /// Stiffnesses `K_n0` (E/h).
    contrasts: [f64; 3],
}

impl Sweep {
    /// A curve for each scene and stiffness.
    fn curves(&self, effort: Effort) -> Vec<Curve> {
        let (parts, finer) = crack::parts(effort);
        let fine = crack::contact(finer);
        let on_crack = crack::reference(&fine.points);
        let on_joint = |_: &Point| inclined_traction();
        let crack = Place::Crack(Shape::Hex8, parts);
        let (joint_scene, crack_scene) = (Place::Inclined.build(), crack.build());
        let scenes = [
            (
                "joint",
                Terms::new(Place::Inclined, &joint_scene, &on_joint),
            ),
            ("crack", Terms::new(crack, &crack_scene, &on_crack)),
        ];
        let scenes = scenes.iter();
        let each = scenes.flat_map(|(name, terms)| {
            let of = move |contrast: f64| self.curve(name, terms, contrast);
            self.contrasts.map(of)
        });
        each.collect()
    }

    fn curve(&self, scene: &str, terms: &Terms<'_>, contrast: f64) -> Curve {
        let case = |&exponent: &i32| {
            let share = 10.0_f64.powi(exponent);
            terms.case((self.treatment)(share), contrast, share)
        };
        Curve {
            name: format!("{scene}, {contrast:e} E/h"),
            cases: self.exponents.iter().map(case).collect(),
        }
    }
}

/// Powers of ten, the first and the last ones included.
fn powers(effort: Effort, first: i32) -> Vec<i32> {
    match effort {
        Effort::Quick => vec![first - 8, first - 4, first],
        Effort::Full => (first - 8..=first).collect(),
    }
}

/// By how much walls overlap, against `b0`.
fn overlap(case: &Case) -> f64 {
    let solved = case.solved.as_ref();
    solved.map_or(f64::NAN, |solved| {
        let smallest = solved.points.iter().map(|point| point.aperture);
        (-smallest.fold(f64::INFINITY, f64::min)).max(0.0) / APERTURE
    })
}

/// Cases that failed, and tractions of the joint that are not those of statics.
fn misses(curves: &[Curve]) -> Vec<String> {
    let mut misses = Vec::new();
    for curve in curves {
        let mut note = |what: &str, missed: &dyn Fn(&Case) -> bool| {
            let missed = curve.cases.iter().filter(|case| missed(case));
            let parameters: Vec<String> =
                missed.map(|case| format!("{:e}", case.parameter)).collect();
            if !parameters.is_empty() {
                misses.push(format!(
                    "{}: {what} with a parameter of {}",
                    curve.name,
                    parameters.join(", ")
                ));
            }
        };
        let is_joint = curve.name.starts_with("joint");
        note("not converged", &|case| case.solved.is_none());
        note("a traction off by more than 1e-6", &|case| {
            is_joint && case.traction > 1e-6
        });
    }
    misses
}

/// Smallest and largest of a measure over the cases of some curves.
fn over(curves: &[Curve], scene: &str, of: impl Fn(&Case) -> f64) -> (f64, f64) {
    let own = curves.iter().filter(|curve| curve.name.starts_with(scene));
    let each = own.map(|curve| range(curve, |case, _| of(case)));
    each.fold((f64::INFINITY, f64::NEG_INFINITY), |all, one| {
        (all.0.min(one.0), all.1.max(one.1))
    })
}

/// A measure of the curve of a name, where the parameter is largest and where it is smallest of
/// those that converged.
fn ends(curves: &[Curve], name: &str, of: impl Fn(&Case) -> f64) -> String {
    let curve = curves.iter().find(|curve| curve.name == name);
    let converged = curve.expect("a curve of the sweep").converged();
    let cases: Vec<&Case> = converged.map(|(case, _)| case).collect();
    match (cases.last(), cases.first()) {
        (Some(largest), Some(smallest)) => format!(
            "{:.1e} to {:.1e} (at {:e})",
            of(largest),
            of(smallest),
            smallest.parameter
        ),
        _ => "nothing".to_owned(),
    }
}

/// What the hyperbolas that fail have in common: `K_n0 v_m` against the largest traction.
fn failed_text(curves: &[Curve]) -> String {
    let cases = || curves.iter().flat_map(|curve| &curve.cases);
    let share = |case: &Case| case.stiffness * case.parameter * APERTURE / case.load;
    let (failed, solved): (Vec<&Case>, Vec<&Case>) =
        cases().partition(|case| case.solved.is_none());
    if failed.is_empty() {
        return String::new();
    }
    let most = failed.iter().map(|case| share(case)).fold(0.0, f64::max);
    let least = solved.iter().map(|case| share(case));
    format!(
        "; what fails is contact in all but name, with K_n0 v_m at most {most:.1e} of the largest \
         traction (the least of what converges is {:.1e}): what is left to close is that share of \
         v_m, and of the digits of v_m too few remain",
        least.fold(f64::INFINITY, f64::min)
    )
}

/// A chart to draw: the name of its file, what of the law it shows, its axis, the measure.
type Drawn = (&'static str, &'static str, Axis, fn(&Case) -> f64);

fn charts(
    curves: &[Curve],
    law: &str,
    x: &str,
    drawn: impl IntoIterator<Item = Drawn>,
) -> Vec<(&'static str, Chart)> {
    let drawn = drawn.into_iter();
    let draw = |(name, what, y, of): Drawn| {
        let title = format!("{law}: {what}");
        (name, chart(curves, &title, x, y, of))
    };
    drawn.map(draw).collect()
}

/// Axes that both laws have charts of.
fn traction_axis() -> Axis {
    Axis::logarithmic("error of the traction, L2").from(1e-16)
}

fn newton_axis() -> Axis {
    Axis::linear("Newton iterations")
}

fn seconds_axis() -> Axis {
    Axis::logarithmic("seconds")
}

fn in_table(curve: &Curve, case: &Case) -> [String; 2] {
    [curve.name.clone(), format!("{:e}", case.parameter)]
}

fn run_cutoff(effort: Effort) -> Finding {
    let sweep = Sweep {
        treatment: |share| Treatment::Logarithmic(Some(share)),
        exponents: powers(effort, -1),
        contrasts: [1e-4, 1e-2, 1.0],
    };
    let curves = sweep.curves(effort);
    let overlap_axis = Axis::logarithmic("overlap of the walls / b0").from(1e-12);
    let drawn: [Drawn; 4] = [
        ("cutoff-overlap", "overlap", overlap_axis, overlap),
        ("cutoff-traction", "traction", traction_axis(), |case| {
            case.traction
        }),
        ("cutoff-iterations", "iterations", newton_axis(), newton),
        ("cutoff-seconds", "time", seconds_axis(), seconds),
    ];
    let most = worst(&curves, |case, _| overlap(case));
    Finding::new([
        format!("walls overlap by up to {most:.1} b0"),
        solved_text(&curves),
    ])
    .story(
        cutoff_text(&curves),
        charts(
            &curves,
            "Cutoff of the logarithmic law",
            "cutoff b_min / b0; lines: scene, K_n0",
            drawn,
        ),
    )
    .numbers(table(&curves, ["scene and K_n0", "b_min / b0"], in_table))
    .missing(misses(&curves))
}

fn cutoff_text(curves: &[Curve]) -> [String; 5] {
    let [joint, crack] =
        ["joint, 1e-4 E/h", "crack, 1e-4 E/h"].map(|name| ends(curves, name, overlap));
    let [joint_2, crack_2] =
        ["joint, 1e-2 E/h", "crack, 1e-2 E/h"].map(|name| ends(curves, name, overlap));
    let traction = |case: &Case| case.traction;
    [
        "Below its cutoff b_min the logarithmic law goes on with a stiffness that grows linearly, \
         so walls can pass each other. The joint and the crack of the studies above, with the \
         cutoff over eight decades, for three stiffnesses."
            .to_owned(),
        format!(
            "From the largest cutoff to the smallest the overlap goes from {joint} b0 on the joint \
             and {crack} on the crack with K_n0 = 1e-4 E/h, from {joint_2} and {crack_2} with \
             1e-2; with 1 E/h neither comes to its cutoff. A law without cutoff has none."
        ),
        format!(
            "On the joint tractions are those of statics to {:.0e}. Those of the crack are off by \
             {} with K_n0 = 1e-4 E/h and {} with 1 E/h: a cutoff that is too large adds to what a \
             soft law does wrong, a small one changes nothing.",
            over(curves, "joint", traction).1,
            ends(curves, "crack, 1e-4 E/h", traction),
            ends(curves, "crack, 1e0 E/h", traction),
        ),
        format!("{}.", solved_text(curves)),
        memory_text(curves),
    ]
}

fn run_largest(effort: Effort) -> Finding {
    let sweep = Sweep {
        treatment: Treatment::Hyperbolic,
        exponents: powers(effort, 0),
        contrasts: [1e-4, 1.0, 1e4],
    };
    let curves = sweep.curves(effort);
    let closure_axis = Axis::logarithmic("deepest closure / b0").from(1e-12);
    let apart_axis = Axis::logarithmic("mean difference of the openings / b0").from(1e-12);
    let against = "openings against contact";
    let drawn: [Drawn; 5] = [
        ("max-closure-closure", "closure", closure_axis, |case| {
            case.closure
        }),
        ("max-closure-apart", against, apart_axis, |case| case.apart),
        (
            "max-closure-traction",
            "traction",
            traction_axis(),
            |case| case.traction,
        ),
        (
            "max-closure-iterations",
            "iterations",
            newton_axis(),
            newton,
        ),
        ("max-closure-seconds", "time", seconds_axis(), seconds),
    ];
    let mut misses = misses(&curves);
    for (curve, case) in curves
        .iter()
        .flat_map(|c| c.cases.iter().map(move |x| (c, x)))
    {
        if case.closure > case.parameter + PASSED {
            misses.push(format!(
                "{}: closure of {:e} b0 beyond {:e}",
                curve.name, case.closure, case.parameter
            ));
        }
    }
    let most = worst(&curves, |case, _| case.closure / case.parameter);
    Finding::new([
        format!("nothing passes: closure at most {most:.6} v_m"),
        solved_text(&curves),
    ])
    .story(
        largest_text(&curves),
        charts(
            &curves,
            "Largest closure of the hyperbolic law",
            "largest closure v_m / b0; lines: scene, K_n0",
            drawn,
        ),
    )
    .numbers(table(&curves, ["scene and K_n0", "v_m / b0"], in_table))
    .missing(misses)
}

fn largest_text(curves: &[Curve]) -> [String; 6] {
    let names = ["crack, 1e-4 E/h", "crack, 1e0 E/h", "crack, 1e4 E/h"];
    let apart = names.map(|name| ends(curves, name, |case| case.apart));
    let traction = names.map(|name| ends(curves, name, |case| case.traction));
    [
        "The hyperbolic law closes by v_m at most, whatever the load: with a small v_m it is \
         contact of walls that give way by v_m. The joint and the crack of the studies above, with \
         v_m over eight decades, for three stiffnesses."
            .to_owned(),
        format!(
            "Walls close by up to {:.6} v_m.",
            worst(curves, |case, _| case.closure / case.parameter)
        ),
        format!(
            "From where exact contact has them on the same mesh, the walls of the crack are, from \
             the largest v_m to the smallest that converges, {} b0 away with K_n0 = 1e-4 E/h, {} \
             with 1 and {} with 1e4.",
            apart[0], apart[1], apart[2],
        ),
        format!(
            "Tractions of the joint are those of statics to {:.0e}. Those of the crack are off by \
             {} with K_n0 = 1e-4 E/h, {} with 1 and {} with 1e4, where the mesh is what is left.",
            over(curves, "joint", |case| case.traction).1,
            traction[0],
            traction[1],
            traction[2],
        ),
        format!("{}{}.", solved_text(curves), failed_text(curves)),
        memory_text(curves),
    ]
}
