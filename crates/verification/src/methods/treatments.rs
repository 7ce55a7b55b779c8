//! The treatments that are compared, and what is measured of each.

use std::time::Instant;

use kluft_solver::{
    Discretisation, LinearMethod, Load, Newton, NewtonSettings, Plan, Problem, System, Unknowns,
    Workload, solution, unobserved,
};
use lie_core::{Closure, ClosureKind, Tension};

use crate::methods::augmented_lagrangian::augmented;
use crate::scenes::pressed::Pressed;

/// Aperture without load of all laws (m); contact and the augmented Lagrangian touch where it
/// begins to close.
pub const APERTURE: f64 = 1e-4;

/// How walls are kept from passing each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Treatment {
    /// A constant stiffness `K_n`.
    Linear,
    /// The logarithmic law, with a cutoff as a share of the aperture or without.
    Logarithmic(Option<f64>),
    /// The hyperbolic law, with its largest closure as a share of the aperture.
    Hyperbolic(f64),
    /// Exact contact.
    Contact,
    /// Uzawa's iteration.
    Augmented,
}

/// Those of the sweep, with their names.
pub const ALL: [(Treatment, &str); 6] = [
    (Treatment::Linear, "linear penalty"),
    (
        Treatment::Logarithmic(Some(0.01)),
        "logarithmic, cutoff b0/100",
    ),
    (Treatment::Logarithmic(None), "logarithmic"),
    (Treatment::Hyperbolic(1.0), "hyperbolic"),
    (Treatment::Augmented, "augmented Lagrangian"),
    (Treatment::Contact, "contact"),
];

impl Treatment {
    /// Its law; that of the augmented Lagrangian is only asked for its shear.
    pub fn closure(self, stiffness: f64) -> Closure {
        let kind = match self {
            Self::Contact | Self::Augmented => return Closure::contact(0.0),
            Self::Linear => ClosureKind::Linear,
            Self::Logarithmic(share) => ClosureKind::Logarithmic {
                cutoff: share.map(|share| share * APERTURE),
            },
            Self::Hyperbolic(share) => ClosureKind::Hyperbolic {
                max_closure: share * APERTURE,
            },
        };
        Closure {
            tension: Tension::CutOff,
            ..Closure::new(APERTURE, stiffness, kind)
        }
    }
}

/// One facet point.
#[derive(Debug, Clone, Copy)]
pub struct Point {
    /// Along the crack (m).
    pub x: f64,
    /// Area (m^2).
    pub area: f64,
    /// Opening (m).
    pub opening: f64,
    /// Normal traction (Pa).
    pub traction: f64,
    /// Aperture (m), `b0` more than the opening for laws that have one, to full precision near 0.
    pub aperture: f64,
}

/// What came out.
#[derive(Debug, Clone)]
pub struct Solved {
    /// Facet points, in the order of the nodes of the facets.
    pub points: Vec<Point>,
    /// Newton iterations, all inner ones of the augmented Lagrangian: linear solves.
    pub newton: usize,
    /// Outer iterations; 1 for all but the augmented Lagrangian.
    pub outer: usize,
    /// Factorisations of the matrix.
    pub factorisations: usize,
    /// Iterations of the linear solver.
    pub linear: usize,
    /// Unknowns.
    pub unknowns: usize,
    /// Time without assembly (s).
    pub seconds: f64,
    /// Memory that the linear solver was predicted to take (bytes).
    pub memory: usize,
}

/// The settings of all treatments.
fn settings(linear: LinearMethod) -> NewtonSettings {
    NewtonSettings {
        linear: Some(linear),
        max_iterations: 50,
        ..NewtonSettings::default()
    }
}

/// Solves a scene with a stiffness (Pa/m); nothing if that fails.
pub fn solve(
    scene: &Pressed,
    treatment: Treatment,
    stiffness: f64,
    linear: LinearMethod,
) -> Option<Solved> {
    let problem = scene.with(treatment.closure(stiffness));
    let discretisation = Discretisation::of(&problem).ok()?;
    let system = System::assemble(&problem, discretisation);
    solve_assembled(&system, treatment, stiffness, linear)
}

/// The same of a system that is assembled with the law of the treatment.
pub fn solve_assembled(
    system: &System<'_>,
    treatment: Treatment,
    stiffness: f64,
    linear: LinearMethod,
) -> Option<Solved> {
    let (problem, settings) = (system.problem(), settings(linear));
    let start = Instant::now();
    let mut solved = if treatment == Treatment::Augmented {
        by_multipliers(problem, system, stiffness, settings)?
    } else {
        by_law(problem, system, settings)?
    };
    solved.seconds = start.elapsed().as_secs_f64();
    Some(solved)
}

/// The facet points with their openings, tractions and apertures.
fn points(
    problem: &Problem,
    system: &System<'_>,
    of: impl Fn(usize) -> (f64, f64, f64),
) -> Vec<Point> {
    let nodes = &problem.mesh.facets.elements.nodes;
    let each = nodes
        .iter()
        .zip(system.discretisation().interface().points());
    each.enumerate()
        .map(|(index, (&node, point))| {
            let (opening, traction, aperture) = of(index);
            Point {
                x: problem.mesh.nodes[node as usize].x,
                area: point.area,
                opening,
                traction,
                aperture,
            }
        })
        .collect()
}

fn by_law(problem: &Problem, system: &System<'_>, settings: NewtonSettings) -> Option<Solved> {
    let unknowns = Unknowns::from(system.discretisation());
    let count = system.discretisation().points().len();
    let workload = Workload::of(problem).with_extra_memory(&problem.mesh, count);
    let plan = Plan::of(unknowns, workload, settings.linear, usize::MAX).ok()?;
    let memory = plan.prediction().memory_bytes;
    let mut newton = Newton::planned(system, settings, plan).ok()?;
    let mut state = system.initial_state();
    let record = newton.solve_step(system, &mut state, &Load::proportional(1.0), unobserved);
    if !record.converged() {
        return None;
    }
    let solution = solution(system, &state);
    let results = solution.facet_nodes(problem, system.discretisation().interface());
    Some(Solved {
        points: points(problem, system, |index| {
            let result = &results[index];
            (result.opening, result.normal_traction, result.aperture)
        }),
        newton: record.iterations.len(),
        outer: 1,
        factorisations: record.iterations.len(),
        linear: record.linear_iterations(),
        unknowns: system.discretisation().unknown_count(),
        seconds: 0.0,
        memory,
    })
}

fn by_multipliers(
    problem: &Problem,
    system: &System<'_>,
    stiffness: f64,
    settings: NewtonSettings,
) -> Option<Solved> {
    let found = augmented(system, stiffness, settings)?;
    Some(Solved {
        points: points(problem, system, |index| {
            let opening = found.openings[index];
            (opening, found.tractions[index], opening)
        }),
        newton: found.newton,
        outer: found.outer,
        factorisations: found.factorisations,
        linear: 0,
        unknowns: system.discretisation().unknown_count(),
        seconds: 0.0,
        memory: found.memory,
    })
}

/// Deepest closure beyond touching, against `b0`: walls of that aperture pass each other above 1.
pub fn closure(points: &[Point]) -> f64 {
    let deepest = points.iter().map(|point| -point.opening);
    deepest.fold(0.0, f64::max) / APERTURE
}

/// Difference of the tractions from exact ones, L2 over L2.
pub fn traction_error(points: &[Point], exact: impl Fn(&Point) -> f64) -> f64 {
    let (mut squares, mut whole) = (0.0, 0.0);
    for point in points {
        let exact = exact(point);
        squares += point.area * (point.traction - exact).powi(2);
        whole += point.area * exact.powi(2);
    }
    (squares / whole).sqrt()
}

/// Mean difference of the openings from those of exact contact on the same mesh, against `b0`.
pub fn apart(points: &[Point], contact: &[Point]) -> f64 {
    let (mut sum, mut area) = (0.0, 0.0);
    for (point, contact) in points.iter().zip(contact) {
        sum += point.area * (point.opening - contact.opening).abs();
        area += point.area;
    }
    sum / area / APERTURE
}

/// Mean aperture of what is pressed, against `b0`; negative where walls pass each other.
pub fn aperture_left(points: &[Point]) -> f64 {
    let pressed = || points.iter().filter(|point| point.traction < 0.0);
    let area: f64 = pressed().map(|point| point.area).sum();
    pressed()
        .map(|point| point.area * point.aperture)
        .sum::<f64>()
        / area
        / APERTURE
}
