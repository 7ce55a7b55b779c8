//! The first guess of a path: walls closed by the mean strain of the body under its loads.
//!
//! Of the displacements `u = a + H x`, held where the body is, those balance the loads that satisfy
//! `V^T K V c = V^T r` (Galerkin), with the twelve columns `V` of `a` and `H`, the stiffness `K` of
//! the rock and the forces `r` out of balance. The normal traction `t = n . C H n` of this strain
//! closes each facet to `b` with `sigma_n(b) + k (b - b_0) = sigma_n(b_0) + t`, where `k` is the
//! stiffness of the rock against the opening of a penny-shaped crack as large as its fracture, by
//! the mean, `k = 3 pi E / (16 (1 - nu^2) a)` (I. N. Sneddon, Proc. R. Soc. Lond. A 187, 1946).
//!
//! No wall has moved by that; it is where the laws are linearised. Where the stress is near its
//! mean, the first linear solve has the stiffness of the last one.

use std::f64::consts::PI;

use glam::{DMat3, DVec3};
use kluft_algebra::small::inverse_factor;
use lie_core::{NormalSpring, Rock, TrialState};
use rayon::prelude::*;

use super::facet_points::interface;
use crate::assembly::facet_point::FacetPoint;
use crate::problem::Load;
use crate::system::{FacetPointState, State, System};

/// Displacements of a uniform strain: translations, and a gradient.
const MODES: usize = 12;
/// Nodes of one sum.
const NODES_PER_SUM: usize = 4096;
/// A mode that depends on those before it but for this share is left out: no force moves it.
const DEPENDENT: f64 = 1e-12;

/// Closes the facet points of a state, whose rock has these forces (N), under another load than the
/// one before, where laws are smooth and no support moves.
pub(super) fn close(system: &System<'_>, before: &Load, rock_forces: &[DVec3], state: &mut State) {
    let is_still = !moves_supports(system, before, &state.load);
    if !(is_still && system.is_smooth() && system.is_nonlinear() && system.coupling().is_none()) {
        return;
    }
    let gradient = gradient(system, rock_forces, state);
    if !gradient.is_finite() {
        return;
    }
    let sizes = crack_sizes(system);
    let points = interface(system).points.par_iter();
    let pairs = points.zip(&mut state.facet_points);
    pairs.for_each(|(point, state)| {
        let size = sizes[point.fracture as usize];
        close_point(system, point, (gradient, size), state);
    });
}

fn moves_supports(system: &System<'_>, before: &Load, load: &Load) -> bool {
    let cases = 0..load.factors.len();
    let mut moving = cases.filter(|&case| before.factor(case) != load.factor(case));
    moving.any(|case| system.discretisation.supports.prescribe(case))
}

fn close_point(
    system: &System<'_>,
    point: &FacetPoint,
    (gradient, size): (DMat3, f64),
    state: &mut FacetPointState,
) {
    let facets = &system.problem.mesh.facets;
    let facet = point.facet as usize;
    let sides = [facets.minus[facet], facets.plus[facet]];
    let rocks = sides.map(|cell| system.problem.rock(cell as usize));
    let across = |rock: &Rock| point.normal.dot(rock.stress(gradient) * point.normal);
    let traction = 0.5 * (across(rocks[0]) + across(rocks[1]));
    if traction >= 0.0 {
        return;
    }
    let law = system.law(point);
    let Rock {
        young_modulus,
        poisson_ratio,
        ..
    } = *rocks[0];
    let plane = young_modulus / (1.0 - poisson_ratio * poisson_ratio);
    let stiffness = 3.0 * PI / 16.0 * plane / size;
    let joint = &state.joint;
    let pressed = joint.normal_traction + traction;
    let spring = NormalSpring {
        stiffness,
        separation: joint.separation,
        traction: pressed,
    };
    let largest = state.history.largest_opening;
    let balance = law.closure.balanced_after(&spring, largest);
    let trial = TrialState {
        separation: balance.separation,
        slip: joint.slip,
        normal_traction: balance.traction,
        shear: joint.shear,
    };
    state.jump_residual += joint.separation.beyond(balance.separation) * point.normal;
    state.joint = law.state_at(&trial);
}

/// Radius of a disc as large as each fracture (m).
fn crack_sizes(system: &System<'_>) -> Vec<f64> {
    let areas = interface(system).areas().into_iter();
    areas.map(|area| (area / PI).sqrt()).collect()
}

/// Gradient `H` of the displacements that balance what is out of balance in a state.
fn gradient(system: &System<'_>, rock_forces: &[DVec3], state: &State) -> DMat3 {
    let residual = system.residual(rock_forces, &system.law_tractions(state), &state.load);
    let centre = centre(system);
    let mut work = [[0.0; MODES]; MODES];
    for (mode, work) in work.iter_mut().enumerate() {
        let moved = moved(system, centre, mode);
        *work = along_modes(system, centre, &system.rock_forces(&moved));
    }
    let (inverse, _) = inverse_factor(&work, DEPENDENT);
    let loads = along_modes(system, centre, &residual);
    let half = inverse.map(|line| line.iter().zip(&loads).map(|(a, b)| a * b).sum::<f64>());
    let coefficient = |mode: usize| -> f64 {
        (mode..MODES)
            .map(|row| inverse[row][mode] * half[row])
            .sum()
    };
    let column = |j: usize| DVec3::from_array([0, 1, 2].map(|i| coefficient(3 + 3 * j + i)));
    DMat3::from_cols(column(0), column(1), column(2))
}

fn centre(system: &System<'_>) -> DVec3 {
    let (low, high) = system.problem.mesh.bounds();
    0.5 * (low + high)
}

/// Displacement of a place, so far from the centre, by a mode.
fn displacement(mode: usize, arm: DVec3) -> DVec3 {
    match mode {
        0..3 => DVec3::AXES[mode],
        _ => arm[(mode - 3) / 3] * DVec3::AXES[(mode - 3) % 3],
    }
}

/// A mode as unknowns, as far as points are not held.
fn moved(system: &System<'_>, centre: DVec3, mode: usize) -> Vec<DVec3> {
    let points = &system.discretisation.points;
    let supports = &system.discretisation.supports;
    let unknowns = (0..points.len()).into_par_iter().map(|unknown| {
        let node = points.node[unknown] as usize;
        match points.of_node(node).start == unknown {
            true => {
                let arm = system.problem.mesh.nodes[node] - centre;
                supports.project(unknown, displacement(mode, arm))
            }
            false => DVec3::ZERO,
        }
    });
    unknowns.collect()
}

/// Work of forces on the unknowns along all modes.
fn along_modes(system: &System<'_>, centre: DVec3, forces: &[DVec3]) -> [f64; MODES] {
    let points = &system.discretisation.points;
    let supports = &system.discretisation.supports;
    let nodes = &system.problem.mesh.nodes;
    let of_nodes = nodes
        .par_chunks(NODES_PER_SUM)
        .enumerate()
        .map(|(chunk, places)| {
            let mut sums = [0.0; MODES];
            for (node, place) in (chunk * NODES_PER_SUM..).zip(places) {
                let own = points.of_node(node);
                if own.is_empty() {
                    continue;
                }
                let force = supports.project(own.start, forces[own.start]);
                let arm = *place - centre;
                for (mode, sum) in sums.iter_mut().enumerate() {
                    *sum += displacement(mode, arm).dot(force);
                }
            }
            sums
        });
    let of_nodes: Vec<[f64; MODES]> = of_nodes.collect();
    let mut all = [0.0; MODES];
    for sums in of_nodes {
        all.iter_mut().zip(sums).for_each(|(all, sum)| *all += sum);
    }
    all
}

#[cfg(test)]
pub(super) mod tests {
    use kluft_mesh::structured::{Patch, tetrahedra};
    use kluft_mesh::{Mesh, SurfaceRole};
    use lie_core::{Closure, ClosureKind, FractureLaw};

    use super::*;
    use crate::problem::{Condition, Fracture, Problem, Support, SurfaceLoad};
    use crate::system::Discretisation;

    const YOUNG: f64 = 3e10;
    const RATIO: f64 = 0.2;
    pub(in crate::newton) const PRESSURE: f64 = 5e6;

    /// A cube on rollers under a pressure from above, cut through level.
    pub(in crate::newton) fn problem(kind: ClosureKind) -> Problem {
        let patches = [
            Patch {
                name: "joint",
                contains: &|x: [f64; 3]| x[2] == 0.5,
            },
            Patch {
                name: "left",
                contains: &|x: [f64; 3]| x[0] == 0.0,
            },
            Patch {
                name: "front",
                contains: &|x: [f64; 3]| x[1] == 0.0,
            },
            Patch {
                name: "bottom",
                contains: &|x: [f64; 3]| x[2] == 0.0,
            },
            Patch {
                name: "top",
                contains: &|x: [f64; 3]| x[2] == 1.0,
            },
        ];
        let draft = tetrahedra([4; 3], [1.0; 3], &patches);
        let mut roles = vec![SurfaceRole::Boundary; draft.groups.len()];
        (roles[0], roles[1]) = (SurfaceRole::Unused, SurfaceRole::Fracture);
        let mesh = Mesh::build(draft, &roles).expect("a sound mesh");
        let rock = Rock {
            young_modulus: YOUNG,
            poisson_ratio: RATIO,
            density: 0.0,
            anisotropy: None,
        };
        let law = FractureLaw::elastic(Closure::new(1e-4, 1e11, kind), 1e10);
        let condition = |boundary: usize| Condition {
            boundary,
            load: (boundary == 3).then_some(SurfaceLoad::Pressure(PRESSURE)),
            support: (boundary < 3).then_some(Support::Symmetry),
        };
        Problem {
            fractures: vec![Fracture {
                law,
                fluid_pressure: 0.0,
            }],
            conditions: (0..4).map(condition).collect(),
            ..Problem::of_rock(mesh, rock)
        }
    }

    fn loaded(system: &System<'_>) -> State {
        let mut state = system.initial_state();
        state.load = system.problem.schedule.steps[0].load.clone();
        state
    }

    /// `H = diag(nu, nu, -1) p / E`.
    #[test]
    fn the_mean_strain_is_that_of_a_pressed_cube() {
        let problem = problem(ClosureKind::Logarithmic { cutoff: None });
        let system = System::assemble(&problem, Discretisation::of(&problem).expect("held"));
        let state = loaded(&system);
        let found = gradient(&system, &system.rock_forces(&state.unknowns), &state);
        let wanted = DMat3::from_diagonal(DVec3::new(RATIO, RATIO, -1.0)) * (PRESSURE / YOUNG);
        let off = (found - wanted).to_cols_array().map(f64::abs);
        assert!(
            off.iter().all(|off| *off < 1e-12 * PRESSURE / YOUNG),
            "{found}"
        );
    }

    /// With `K` and `k` of the law and the rock, `t = -p K / (K + k)` where the law is linear.
    #[test]
    fn walls_bear_what_the_rock_beside_them_leaves() {
        let mut problem = problem(ClosureKind::Linear);
        let radius = (1.0 / PI).sqrt();
        let rock = 3.0 * PI / 16.0 * YOUNG / (1.0 - RATIO * RATIO) / radius;
        problem.fractures[0].law.closure.normal_stiffness = 3.0 * rock;
        let system = System::assemble(&problem, Discretisation::of(&problem).expect("held"));
        let mut state = loaded(&system);
        let point = &interface(&system).points[0];
        let own = &mut state.facet_points[0];
        let gradient = DMat3::from_diagonal(DVec3::new(RATIO, RATIO, -1.0)) * (PRESSURE / YOUNG);
        close_point(&system, point, (gradient, radius), own);
        let traction = own.joint.normal_traction;
        assert!(
            (traction + 0.75 * PRESSURE).abs() < 1e-9 * PRESSURE,
            "{traction}"
        );
        // The walls are where they were.
        let moved = own.joint.separation.opening + own.jump_residual.dot(point.normal);
        assert!(moved.abs() < 1e-18, "{moved}");
    }

    #[test]
    fn supports_that_move_and_linear_laws_change_nothing() {
        let mut problem = problem(ClosureKind::Linear);
        let closed = |problem: &Problem| {
            let system = System::assemble(problem, Discretisation::of(problem).expect("held"));
            let mut state = loaded(&system);
            let rock_forces = system.rock_forces(&state.unknowns);
            let before = system.problem.schedule.start();
            close(&system, &before, &rock_forces, &mut state);
            state
                .facet_points
                .iter()
                .any(|own| own.joint.normal_traction != 0.0)
        };
        assert!(!closed(&problem));
        let closure = &mut problem.fractures[0].law.closure;
        *closure = Closure::new(1e-4, 1e11, ClosureKind::Logarithmic { cutoff: None });
        assert!(closed(&problem));
        problem.conditions[3].support = Some(Support::Displacement([None, None, Some(-1e-5)]));
        assert!(!closed(&problem));
    }
}
