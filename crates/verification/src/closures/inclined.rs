//! An inclined joint whose traction statics knows.

use glam::DVec3;
use kluft_chart::{Axis, Chart};
use kluft_solver::{Discretisation, LinearMethod, System};

use super::equal_terms::{Charted, chart, curves, exponents, misses, of, table};
use super::measured::{Case, Curve, Terms, newton, solve_memory, worst};
use super::memory::Place;
use super::words::{breaks, closure_text, iterations_text, memory_text, ours};
use crate::methods::treatments::{
    APERTURE, Point, Solved, Treatment, solve_assembled, traction_error,
};
use crate::report::{Effort, Finding, Study};
use crate::scenes::pressed::{inclined_slip, inclined_traction};

pub const STUDY: Study = Study {
    name: "inclined",
    title: "An inclined joint in uniform stress",
    subject: "K_n, K_n0 or r from 1e-4 to 1e4 E/h",
    run,
};

fn run(effort: Effort) -> Finding {
    let scene = Place::Inclined.build();
    let terms = Terms::new(Place::Inclined, &scene, &exact);
    let curves = curves(&terms, &exponents(effort));
    let mut misses = misses(&curves);
    let off = worst(&curves, |case, _| case.traction);
    if off > 1e-6 {
        misses.push(format!("a traction is off by {off:.1e}"));
    }
    let texts = [
        format!(
            "A column with a joint that dips 50 degrees, under 10 MPa on top. The stress is \
             uniaxial whatever the joint is, so its normal traction is {:.4} MPa for every \
             treatment that settles; they differ in how far the walls close.",
            inclined_traction() / 1e6
        ),
        closure_text(&curves),
        traction_text(&terms, &curves),
        iterations_text(&curves),
        memory_text(&curves),
    ];
    Finding::new([breaks(&curves), ours(&curves)])
        .story(texts, charts(&curves))
        .numbers(table(&curves))
        .missing(misses)
}

fn charts(curves: &[Curve]) -> [(&'static str, Chart); 4] {
    let closure_axis = Axis::logarithmic("deepest closure / b0").from(1e-16);
    let traction_axis = Axis::logarithmic("error of the traction, L2").from(1e-16);
    let newton_axis = Axis::logarithmic("linear solves");
    let memory_axis = Axis::linear("measured growth of resident memory (MB)");
    let drawn: [(&'static str, &str, Axis, Charted); 4] = [
        ("inclined-closure", "closure", closure_axis, |case| {
            case.closure
        }),
        (
            "inclined-traction",
            "traction against the closed form",
            traction_axis,
            |case| case.traction,
        ),
        ("inclined-iterations", "iterations", newton_axis, newton),
        (
            "inclined-memory",
            "memory of the solve",
            memory_axis,
            solve_memory,
        ),
    ];
    drawn.map(|(name, what, axis, of)| {
        (
            name,
            chart(curves, &format!("Inclined joint: {what}"), axis, of),
        )
    })
}

fn exact(_: &Point) -> f64 {
    inclined_traction()
}

/// Contact with the normals that the mesh gives the facets of the joint, which are one plane: how
/// far the normals are apart, and the error of the traction.
fn with_normals_of_the_mesh(terms: &Terms<'_>) -> (f64, f64) {
    let problem = terms.scene.with(Treatment::Contact.closure(0.0));
    let mut discretisation = Discretisation::of(&problem).expect("supported");
    let normals: Vec<DVec3> = problem.mesh.facet_areas();
    let normals: Vec<DVec3> = normals.iter().map(|area| area.normalize()).collect();
    let apart = normals.iter().map(|normal| normal.distance(normals[0]));
    let apart = apart.fold(0.0, f64::max);
    discretisation.set_normals(|point| normals[point.facet as usize]);
    let system = System::assemble(&problem, discretisation);
    let solved = solve_assembled(&system, Treatment::Contact, 0.0, LinearMethod::Direct);
    let points = solved.expect("contact converges").points;
    (apart, traction_error(&points, exact))
}

/// How exact the tractions are, and what would keep contact from being so.
fn traction_text(terms: &Terms<'_>, curves: &[Curve]) -> String {
    let own = |case: &Case, _: &Solved| case.traction;
    let contact = std::slice::from_ref(of(curves, Treatment::Contact));
    let slip = inclined_slip(terms.scene);
    let (apart, error) = with_normals_of_the_mesh(terms);
    format!(
        "Statics fixes the tractions: those of settled cases are exact to {:.0e}, those of contact \
         to {:.0e}. That takes one normal for the facets of a plane. Those of the mesh differ by \
         {apart:.0e}, because coordinates are rounded, and the walls slip by {:.2} mm: facets \
         around a node, which have one jump, would open by {:.0e} m more or less than each other, \
         and contact, which follows its traction with a stiffness far above that of the rock, \
         would be off by {error:.0e} and by more with every step.{}",
        worst(curves, own),
        worst(contact, own),
        1e3 * slip,
        apart * slip,
        failed_text(terms, curves)
    )
}

/// Why the logarithmic law without cutoff fails where it is softest.
fn failed_text(terms: &Terms<'_>, curves: &[Curve]) -> String {
    let law = &of(curves, Treatment::Logarithmic(None)).cases;
    let failed: Vec<&Case> = law.iter().filter(|case| case.solved.is_none()).collect();
    let Some(first) = failed.first() else {
        return String::new();
    };
    // (1 + ln^2 x) (1 - x) = q, where x is nothing beside 1.
    let load = -inclined_traction() / (first.parameter * terms.scene.scale * APERTURE);
    format!(
        " The logarithmic law without cutoff fails in {} of {} cases: at {:e} E/h its aperture \
         would be {:.0e} m, and the rounding of the slip closes or opens it.",
        failed.len(),
        law.len(),
        first.parameter,
        (-(load - 1.0).sqrt()).exp() * APERTURE,
    )
}
