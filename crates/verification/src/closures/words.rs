//! What the comparison on equal terms says in words.

use super::equal_terms::of;
use super::measured::{Case, Curve, range};
use super::memory::Peak;
use crate::methods::treatments::{Solved, Treatment};

/// How far walls close.
pub fn closure_text(curves: &[Curve]) -> String {
    let [linear, cut, augmented, contact] = [
        Treatment::Linear,
        Treatment::Logarithmic(Some(0.01)),
        Treatment::Augmented,
        Treatment::Contact,
    ]
    .map(|treatment| range(of(curves, treatment), |case, _| case.closure));
    let [logarithmic, hyperbolic] = [Treatment::Logarithmic(None), Treatment::Hyperbolic(1.0)]
        .map(|treatment| range(of(curves, treatment), |case, _| case.aperture))
        .map(|(low, high)| format!("{low:.1e} to {high:.2}"));
    format!(
        "Walls pass each other above 1. The linear penalty closes by {:.1e} to {:.1e} b0, the \
         logarithmic law with a cutoff by up to {:.2e} b0. Without cutoff, and with the hyperbolic \
         law, penetration is impossible: the mean aperture of what is pressed is {logarithmic} and \
         {hyperbolic} b0. The settled augmented Lagrangian leaves at most {:.0e} b0, contact {:.0e}.",
        linear.0, linear.1, cut.1, augmented.1, contact.1
    )
}

/// How many iterations each treatment takes.
pub fn iterations_text(curves: &[Curve]) -> String {
    let over = |treatment, count: fn(&Solved) -> usize| {
        let (low, high) = range(of(curves, treatment), |_, solved| count(solved) as f64);
        format!("{low} to {high}")
    };
    let newton = |treatment| over(treatment, |solved| solved.newton);
    let [linear, logarithmic, cut, hyperbolic] = [
        Treatment::Linear,
        Treatment::Logarithmic(None),
        Treatment::Logarithmic(Some(0.01)),
        Treatment::Hyperbolic(1.0),
    ]
    .map(newton);
    let contact = range(of(curves, Treatment::Contact), |_, solved| {
        solved.newton as f64
    });
    let augmented = of(curves, Treatment::Augmented);
    let laws = format!(
        "Newton iterations, one factorisation each: linear {linear}, logarithmic {logarithmic} \
         ({cut} with cutoff), hyperbolic {hyperbolic}, contact {}.",
        contact.0
    );
    let multipliers = format!(
        "The augmented Lagrangian takes {} linear solves in {} outer iterations, with {} \
         factorisations, because its matrix changes with the active set only; {} of its {} cases \
         fail: more than 200 outer iterations, or 50 in one of them.",
        newton(Treatment::Augmented),
        over(Treatment::Augmented, |solved| solved.outer),
        over(Treatment::Augmented, |solved| solved.factorisations),
        augmented.failures(),
        augmented.cases.len(),
    );
    format!("{laws} {multipliers}")
}

/// Where others break, in a few words.
pub fn breaks(curves: &[Curve]) -> String {
    let linear = range(of(curves, Treatment::Linear), |case, _| case.closure);
    let augmented = of(curves, Treatment::Augmented);
    format!(
        "linear penalty: closure up to {:.0e} b0; augmented Lagrangian: {} of {} cases not converged",
        linear.1,
        augmented.failures(),
        augmented.cases.len()
    )
}

/// How the laws fare, in a few words.
pub fn ours(curves: &[Curve]) -> String {
    let laws = || {
        curves
            .iter()
            .filter(|c| c.cases[0].treatment != Treatment::Augmented)
    };
    let most = laws().map(|curve| range(curve, |_, solved| solved.newton as f64).1);
    let contact = range(of(curves, Treatment::Contact), |case, _| case.closure).1;
    let (cases, failures) = laws().fold((0, 0), |(cases, failures), curve| {
        (cases + curve.cases.len(), failures + curve.failures())
    });
    format!(
        "{} of {cases} cases of the laws in at most {} iterations; contact leaves {contact:.0e} b0",
        cases - failures,
        most.fold(0.0, f64::max)
    )
}

/// What all cases took of memory, measured and predicted.
pub fn memory_text(curves: &[Curve]) -> String {
    let over = |of: &dyn Fn(&Case, &Solved) -> f64| {
        let each = curves.iter().map(|curve| range(curve, of));
        each.fold((f64::INFINITY, 0.0_f64), |all, one| {
            (all.0.min(one.0), all.1.max(one.1))
        })
    };
    let peak = |case: &Case, of: &dyn Fn(Peak) -> usize| {
        case.peak.map_or(f64::NAN, |peak| of(peak) as f64 / 1e6)
    };
    let solve = over(&|case, _| peak(case, &|peak| peak.solve));
    let process = over(&|case, _| peak(case, &|peak| peak.process));
    let predicted = over(&|_, solved| solved.memory as f64 / 1e6);
    format!(
        "Memory is measured: every case runs once more in a process of its own, whose resident \
         memory grows by {} MB at most during the solve; {} MB were predicted for the linear \
         solver. The whole process has {} MB at its peak, with mesh and assembly. On one mesh all \
         have the same matrix; what they differ by is mostly threads and allocator.",
        between(solve),
        between(predicted),
        between(process)
    )
}

/// How many cases of some curves converged, and in how many iterations.
pub fn solved_text(curves: &[Curve]) -> String {
    let cases: usize = curves.iter().map(|curve| curve.cases.len()).sum();
    let failures: usize = curves.iter().map(Curve::failures).sum();
    let count = |curve: &Curve| range(curve, |_, solved| solved.newton as f64);
    let fewest = curves.iter().map(|curve| count(curve).0);
    let most = curves.iter().map(|curve| count(curve).1);
    format!(
        "{} of {cases} cases converge in {} to {} iterations, one factorisation each",
        cases - failures,
        fewest.fold(f64::INFINITY, f64::min),
        most.fold(0.0, f64::max)
    )
}

/// Smallest and largest, to a tenth; one number if they are the same.
fn between((low, high): (f64, f64)) -> String {
    let [low, high] = [low, high].map(|value| format!("{value:.1}"));
    if low == high {
        low
    } else {
        format!("{low} to {high}")
    }
}
