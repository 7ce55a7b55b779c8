//! How accurate a run says it is.

use glam::DVec3;
use kluft_solver::{
    Deformation, Estimator, MeanError, Newton, Solution, State, StressError, System, dual_solution,
};
use rayon::prelude::*;

use crate::summary::FractureSummary;

/// Estimated errors of one load step.
pub struct Accuracy {
    /// Error of the stress as a share of it, in the energy norm.
    pub relative: f64,
    /// Energy that the loads have stored in the rock (J).
    pub energy: f64,
    /// Error of the stress in each cell (Pa): the uniaxial stress with the same energy.
    pub stress_errors: Vec<f64>,
    /// Share of each cell in the square of `relative`.
    pub energy_shares: Vec<f64>,
    /// Errors of the jumps, if they were asked for.
    pub jumps: Option<JumpAccuracy>,
}

/// Estimated errors of the jumps.
pub struct JumpAccuracy {
    /// What the mean aperture of each fracture may be off (m).
    pub aperture: Vec<f64>,
    /// What the mean slip of each fracture may be off (m), if any slips.
    pub slip: Option<Vec<f64>>,
    /// For each cell the larger of its parts in both, as a share of the mean jump of its fracture.
    pub of_cell: Vec<f64>,
    /// That fracture; beyond all numbers where there is none.
    pub nearest_fracture: Vec<u32>,
}

/// Factor on the estimated error of a mean jump. On closed forms the estimate is 0.48 to 0.87 times
/// the error where plain elements follow a crack front, and 0.5 (curved fractures of flat facets)
/// to 1.2 times elsewhere.
const SAFETY: f64 = 2.0;
const SAFETY_AT_PLAIN_FRONTS: f64 = 3.0;
/// Share of the largest jump that the iterations may leave.
const ITERATION: f64 = 1e-9;
/// Slip, as a share of the largest jump, from which on it has an error of its own.
const SLIPS: f64 = 1e-3;

/// Displacements under unit tractions on the walls, by which errors of stresses become errors of
/// jumps.
pub struct Duals {
    /// Under tractions along the normals.
    opening: Vec<DVec3>,
    /// Under tractions along the slip, if any slips.
    slip: Option<Vec<DVec3>>,
}

/// What errors of jumps in a state are estimated by; none without fractures, or if a linear solve
/// fails.
pub fn duals(system: &System<'_>, newton: &mut Newton, state: &State) -> Option<Duals> {
    let points = system.discretisation().interface().points();
    if points.is_empty() {
        return None;
    }
    let mut dual = |directions: &[DVec3]| dual_solution(system, newton, directions).ok();
    let normals: Vec<DVec3> = points.iter().map(|point| point.normal).collect();
    let opening = dual(&normals)?;
    let mut along = system.total_jumps(state);
    let jump = longest(&along);
    for (jump, normal) in along.iter_mut().zip(&normals) {
        *jump -= jump.dot(*normal) * *normal;
    }
    let slips = longest(&along) > SLIPS * jump;
    for slip in &mut along {
        *slip = slip.normalize_or_zero();
    }
    let slip = if slips { Some(dual(&along)?) } else { None };
    Some(Duals { opening, slip })
}

/// Largest length of a vector.
fn longest(vectors: &[DVec3]) -> f64 {
    vectors.iter().map(|v| v.length()).fold(0.0, f64::max)
}

/// Estimates the errors of a step; those of the jumps if there is something to estimate them by.
pub fn of(
    system: &System<'_>,
    estimator: &Estimator,
    solution: &Solution,
    duals: Option<&Duals>,
) -> Accuracy {
    let (error, of_duals) = errors(system, estimator, solution, duals);
    let cells = (0..error.of_cell.len()).into_par_iter();
    let stress_errors = cells.map(|cell| {
        let modulus = system.problem().rock(cell).young_modulus;
        (modulus * error.of_cell[cell] / error.volumes[cell]).sqrt()
    });
    Accuracy {
        relative: error.relative(),
        energy: 0.5 * error.energy,
        stress_errors: stress_errors.collect(),
        energy_shares: error
            .of_cell
            .par_iter()
            .map(|part| part / error.energy)
            .collect(),
        jumps: of_duals.map(|duals| of_all_jumps(estimator, system, &duals, solution, &error)),
    }
}

/// Errors of the stresses under unit tractions on the walls.
struct DualErrors {
    opening: StressError,
    slip: Option<StressError>,
}

fn errors(
    system: &System<'_>,
    estimator: &Estimator,
    solution: &Solution,
    duals: Option<&Duals>,
) -> (StressError, Option<DualErrors>) {
    let Some(Duals { opening, slip }) = duals else {
        return (
            estimator.stress_error(system, &solution.displacements),
            None,
        );
    };
    let state = Deformation::of(system, &solution.displacements);
    let opening = Deformation::of_dual(opening);
    let (error, opening, slip) = match slip {
        None => {
            let [error, opening] = estimator.stress_errors(system, [state, opening]);
            (error, opening, None)
        }
        Some(slip) => {
            let all = [state, opening, Deformation::of_dual(slip)];
            let [error, opening, slip] = estimator.stress_errors(system, all);
            (error, opening, Some(slip))
        }
    };
    (error, Some(DualErrors { opening, slip }))
}

fn of_all_jumps(
    estimator: &Estimator,
    system: &System<'_>,
    duals: &DualErrors,
    solution: &Solution,
    stress: &StressError,
) -> JumpAccuracy {
    let points = system.discretisation().interface().points();
    let results = &solution.facet_points;
    let mesh = &system.problem().mesh;
    let has_plain_fronts = !mesh.has_quarter_points && mesh.front_nodes().contains(&true);
    let safety = if has_plain_fronts {
        SAFETY_AT_PLAIN_FRONTS
    } else {
        SAFETY
    };
    let jumps = results.iter().map(|result| result.jump.length());
    let floor = ITERATION * jumps.fold(0.0, f64::max);
    let mean_error = |dual: &StressError| estimator.mean_error(system, dual, stress);
    let opening = mean_error(&duals.opening);
    let slip = duals.slip.as_ref().map(mean_error);
    let mut mean_jump = vec![(0.0, 0.0); system.problem().fractures.len()];
    for (point, result) in points.iter().zip(results) {
        let (sum, area) = &mut mean_jump[point.fracture as usize];
        *sum += point.area * result.jump.length();
        *area += point.area;
    }
    let of_cell = (0..stress.of_cell.len()).into_par_iter().map(|cell| {
        let fracture = estimator.nearest_fracture[cell] as usize;
        let Some((sum, area)) = mean_jump.get(fracture).filter(|(sum, _)| *sum > 0.0) else {
            return 0.0;
        };
        let of_slip = slip.as_ref().map_or(0.0, |slip| slip.of_cell[cell]);
        safety * opening.of_cell[cell].max(of_slip) * area / sum
    });
    let uncertainty = |error: &MeanError| -> Vec<f64> {
        let errors = error.of_fracture.iter();
        errors.map(|error| safety * error + floor).collect()
    };
    JumpAccuracy {
        of_cell: of_cell.collect(),
        nearest_fracture: estimator.nearest_fracture.clone(),
        aperture: uncertainty(&opening),
        slip: slip.as_ref().map(uncertainty),
    }
}

impl Accuracy {
    /// What a tolerance speaks of: the largest, over the fractures, of the errors of mean opening
    /// and slip as shares of the mean jump; without fractures the error of the stress.
    pub fn to_meet(&self) -> f64 {
        let Some(jumps) = &self.jumps else {
            return self.relative;
        };
        let mut sums = vec![0.0; jumps.aperture.len()];
        for (error, &fracture) in jumps.of_cell.iter().zip(&jumps.nearest_fracture) {
            if let Some(sum) = sums.get_mut(fracture as usize) {
                *sum += error;
            }
        }
        sums.into_iter().fold(0.0, f64::max)
    }

    /// Adds the errors of jumps to the numbers of the fractures.
    pub fn note_in(&self, fractures: &mut [(String, FractureSummary)]) {
        let Some(jumps) = &self.jumps else {
            return;
        };
        for (index, (_, summary)) in fractures.iter_mut().enumerate() {
            summary.aperture_uncertainty = Some(jumps.aperture[index]);
            summary.slip_uncertainty = jumps.slip.as_ref().map(|slip| slip[index]);
        }
    }
}
