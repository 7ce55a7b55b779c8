//! What acts on a body, each with a load case of its own.

use kluft_solver::{Cases, Load, Problem, Schedule, Step};

/// Names of what acts, one for each load case.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ActingCases {
    names: Vec<String>,
}

/// Load steps that a linear solver is chosen for: who keeps the rock prepared asks for many.
const EXPECTED_STEPS: usize = 100;

/// How gravity is called.
pub const GRAVITY: &str = "gravity";

impl ActingCases {
    /// Names of the boundaries with a condition, of all fractures (the pressure that the scene
    /// gives them), of the fixed points, and [`GRAVITY`], in the order of the factors.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Number of factors.
    pub fn len(&self) -> usize {
        self.names.len()
    }

    /// Whether nothing can act: never, as there is gravity.
    pub fn is_empty(&self) -> bool {
        self.names.is_empty()
    }
}

/// Gives everything that acts on a problem a load case of its own, in load steps in which all of it
/// acts.
pub fn separate(problem: &mut Problem) -> ActingCases {
    let mesh = &problem.mesh;
    let conditions = problem.conditions.iter();
    let conditions = conditions.map(|condition| mesh.boundaries[condition.boundary].name.clone());
    let fixed_points = problem.fixed_points.iter().map(|point| point.name.clone());
    let mut names: Vec<String> = conditions.collect();
    let of_conditions = 0..names.len();
    names.extend(mesh.fractures.iter().cloned());
    let of_fractures = of_conditions.end..names.len();
    names.extend(fixed_points);
    let of_fixed_points = of_fractures.end..names.len();
    let cases = Cases {
        conditions: of_conditions.collect(),
        boundary_flows: Vec::new(),
        fractures: of_fractures.collect(),
        fixed_points: of_fixed_points.collect(),
        sources: Vec::new(),
        gravity: names.len(),
    };
    names.push(GRAVITY.to_owned());
    let load = Load {
        time: 1.0,
        factors: vec![1.0; names.len()],
    };
    problem.schedule = Schedule {
        cases,
        steps: vec![Step { load, phase: None }; EXPECTED_STEPS],
        is_timed: true,
        goes_on_from: None,
        sudden: Vec::new(),
    };
    ActingCases { names }
}
