//! All treatments over eight decades of their stiffness.

use kluft_chart::{Axis, Chart};

use super::measured::{self, Case, Curve, Terms};
use crate::methods::treatments::{ALL, Treatment};
use crate::report::{Effort, Table};

/// What all charts are over.
const STIFFNESS: &str = "parameter: K_n, K_n0 or r in E/h";

/// Solves all treatments with stiffnesses of powers of ten (E/h).
pub fn curves(terms: &Terms<'_>, exponents: &[i32]) -> Vec<Curve> {
    let curve = |&(treatment, name): &(Treatment, &'static str)| {
        let case = |&exponent: &i32| {
            let contrast = 10.0_f64.powi(exponent);
            terms.case(treatment, contrast, contrast)
        };
        Curve {
            name: name.to_owned(),
            cases: exponents.iter().map(case).collect(),
        }
    };
    ALL.iter().map(curve).collect()
}

pub fn table(curves: &[Curve]) -> Table {
    let head = ["treatment", "parameter (E/h)"];
    measured::table(curves, head, |curve, case| {
        [curve.name.clone(), format!("{:e}", case.parameter)]
    })
}

pub fn chart(curves: &[Curve], title: &str, y: Axis, of: impl Fn(&Case) -> f64) -> Chart {
    measured::chart(curves, title, STIFFNESS, y, of)
}

/// A number of a case that is charted.
pub type Charted = fn(&Case) -> f64;

/// The curve of a treatment.
pub fn of(curves: &[Curve], treatment: Treatment) -> &Curve {
    let found = curves
        .iter()
        .find(|curve| curve.cases[0].treatment == treatment);
    found.expect("a treatment of the sweep")
}

/// What must hold in both scenes.
pub fn misses(curves: &[Curve]) -> Vec<String> {
    let mut misses = Vec::new();
    for curve in curves {
        let treatment = curve.cases[0].treatment;
        if treatment != Treatment::Augmented && curve.failures() > 0 {
            misses.push(format!("{}: {} failures", curve.name, curve.failures()));
        }
        for (case, solved) in curve.converged() {
            let smallest = solved.points.iter().map(|point| point.aperture);
            let smallest = smallest.fold(f64::INFINITY, f64::min);
            let positive = [Treatment::Logarithmic(None), Treatment::Hyperbolic(1.0)];
            if positive.contains(&treatment) && smallest <= 0.0 {
                misses.push(format!(
                    "{} at {:e} E/h: aperture {smallest:e} m",
                    curve.name, case.parameter
                ));
            }
            if treatment == Treatment::Augmented && case.from_contact > 1e-6 {
                misses.push(format!(
                    "augmented Lagrangian at r = {:e} E/h: {:.1e} from contact",
                    case.parameter, case.from_contact
                ));
            }
        }
    }
    misses
}

/// From where on a measure of a curve stays below a bound (E/h).
pub fn below(curve: &Curve, bound: f64, of: impl Fn(&Case) -> f64) -> String {
    let above = curve.cases.iter().rposition(|case| {
        let value = of(case);
        value.is_nan() || value > bound
    });
    let next = above.map_or(0, |last| last + 1);
    let case = curve.cases.get(next);
    case.map_or("nowhere".into(), |case| {
        format!("from {:e} E/h on", case.parameter)
    })
}

pub fn exponents(effort: Effort) -> Vec<i32> {
    match effort {
        Effort::Quick => vec![-4, 0, 4],
        Effort::Full => (-4..=4).collect(),
    }
}
