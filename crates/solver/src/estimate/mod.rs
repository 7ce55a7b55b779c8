//! How wrong a solution is, estimated from itself.
//!
//! The error of the stress is taken for the difference between the stress of the elements and a
//! smoother one recovered from it (O. C. Zienkiewicz and J. Z. Zhu, Int. J. Numer. Meth. Engng 24,
//! 1987). What it does to jumps follows from the solution `z` under a unit traction on their walls:
//! with `e` and `e_z` the errors of both solutions, the error of the mean jump is `a(e, e_z) / A <=
//! sum |e|_K |e_z|_K / A`, in energy norms (R. Becker and R. Rannacher, Acta Numerica 10, 2001).

mod corner_groups;
mod deformed;
mod flux;
mod nearest_fracture;
mod patches;
mod sizes;

use glam::DVec3;
use kluft_mesh::{Mesh, Shape};
use lie_core::{FinePoint, Rock, SymmetricStress, kernel, recovery_rule};
use rayon::prelude::*;

use crate::newton::Newton;
use crate::problem::Load;
use crate::system::System;
use deformed::DeformedCell;
use kluft_algebra::{Division, LinearFailure, RowOwnership};
use patches::{Patches, Recovered};

pub use deformed::Deformation;
pub use flux::FluxError;
pub use sizes::target_sizes;

/// Error of the linear solve for `z`, as a share of its forces: the errors of the means are then
/// hardly different from those of an exact `z`, which takes several times the iterations.
const ROUGH: f64 = 0.1;

/// Cells whose stresses are recovered at once. Polynomials at the borders of such pieces are fitted
/// twice; samples and polynomials of all cells take more memory than anything else then.
const CELLS_AT_ONCE: usize = 1 << 18;

/// Memory (bytes) that estimates on a mesh take: patches, samples, polynomials, and what is known
/// of each cell of two states.
pub(crate) fn estimate_bytes(mesh: &Mesh) -> usize {
    const OF_SLOT: usize = 8;
    const OF_SAMPLE: usize = size_of::<DVec3>() + size_of::<SymmetricStress>();
    const OF_CELL: usize = 128;
    let cells = &mesh.cells;
    let samples = cells.shapes.iter();
    let samples: usize = samples
        .map(|&shape| recovery_rule(shape).samples.len())
        .sum();
    let terms = patches::terms(cells) * size_of::<SymmetricStress>();
    OF_SLOT * cells.nodes.len()
        + OF_SAMPLE * samples
        + OF_CELL * cells.len()
        + terms * mesh.nodes.len()
}

/// Recovers stresses on one mesh, for any number of states.
pub struct Estimator {
    /// Cells whose errors each rank estimates.
    division: Division,
    patches: Patches,
    /// The fracture nearest to each cell; beyond all numbers where there is none.
    pub nearest_fracture: Vec<u32>,
}

/// Parts of a cell in the sums of `S` states.
struct CellErrors<const S: usize> {
    /// See [`StressError::of_cell`].
    errors: [f64; S],
    energies: [f64; S],
    volume: f64,
}

/// Error of the stress of one state.
#[derive(Debug, Clone)]
pub struct StressError {
    /// `|e|_K^2`, the square of the energy norm of the error in each cell (J), twice the energy
    /// that it would store.
    pub of_cell: Vec<f64>,
    /// Volume of each cell (m^3).
    pub volumes: Vec<f64>,
    /// The same of the solution itself.
    pub energy: f64,
}

impl StressError {
    /// Gives cells at crack fronts the density of error of the cells next to them: no polynomial
    /// follows the stresses of quarter-point elements.
    fn take_over_at_fronts(&mut self, mesh: &Mesh) {
        let is_at_front = mesh.front_cells();
        let (at_front, beside): (Vec<usize>, Vec<usize>) =
            (0..mesh.cells.len()).partition(|&cell| is_at_front[cell]);
        let mut around = vec![(0.0, 0.0); mesh.nodes.len()];
        for cell in beside {
            for &node in mesh.cells.nodes_of(cell) {
                let (error, volume) = &mut around[node as usize];
                *error += self.of_cell[cell];
                *volume += self.volumes[cell];
            }
        }
        for cell in at_front {
            let nodes = mesh.cells.nodes_of(cell).iter();
            let (error, volume) = nodes.fold((0.0, 0.0), |(error, volume), &node| {
                let (e, v) = around[node as usize];
                (error + e, volume + v)
            });
            if volume > 0.0 {
                self.of_cell[cell] = error / volume * self.volumes[cell];
            }
        }
    }

    /// `|e| / |u|`: the error as a share of the solution, in the energy norm.
    pub fn relative(&self) -> f64 {
        let error: f64 = self.of_cell.iter().sum();
        if self.energy > 0.0 {
            (error / self.energy).sqrt()
        } else {
            0.0
        }
    }
}

/// What the error does to a mean over each fracture.
#[derive(Debug, Clone)]
pub struct MeanError {
    /// Error of the mean over each fracture (m).
    pub of_fracture: Vec<f64>,
    /// Part of each cell in the error of its nearest fracture (m): where to refine.
    pub of_cell: Vec<f64>,
}

impl Estimator {
    /// Prepares for a system, whose ranks divide the cells.
    pub fn of(system: &System<'_>) -> Self {
        let cells = system.problem.mesh.cells.len();
        let communicator = system.division().communicator();
        let ranks = communicator.size();
        let starts = (0..=ranks).map(|rank| rank * cells / ranks);
        let division = communicator.divide(RowOwnership::of_starts(starts.collect()));
        let (mesh, discretisation) = (&system.problem.mesh, &system.discretisation);
        let pattern = &discretisation.pattern;
        let slots = pattern.slots(mesh, &discretisation.points);
        let (patches, nearest_fracture) = rayon::join(
            || Patches::of(system.problem, (discretisation, &slots), division.own()),
            || nearest_fracture::nearest_fracture(mesh, (&slots, &pattern.cell_of_slot)),
        );
        Self {
            division,
            patches,
            nearest_fracture,
        }
    }

    /// Estimates the error of the stresses of `displacements` (m), one a point. All ranks must ask.
    pub fn stress_error(&self, system: &System<'_>, displacements: &[DVec3]) -> StressError {
        let [error] = self.stress_errors(system, [Deformation::of(system, displacements)]);
        error
    }

    /// The same for several deformations at once. All ranks must ask.
    pub fn stress_errors<const S: usize>(
        &self,
        system: &System<'_>,
        deformations: [Deformation<'_>; S],
    ) -> [StressError; S] {
        let mesh = &system.problem.mesh;
        let points = &system.discretisation.points;
        let deformed = || DeformedCell::of(system.problem, points, deformations);
        let own = self.division.own();
        let mut of_cells: Vec<CellErrors<S>> = Vec::with_capacity(own.len());
        for start in own.clone().step_by(CELLS_AT_ONCE) {
            let piece = start..own.end.min(start + CELLS_AT_ONCE);
            let cells = (&mesh.cells, piece.clone());
            let recovered = self.patches.recover(cells, deformed);
            let found = piece.into_par_iter().map_init(deformed, |deformed, cell| {
                let rock = system.problem.rock(cell);
                self.of_cell(&recovered, deformed, (cell, rock))
            });
            of_cells.par_extend(found);
        }
        let gathered = |of: &(dyn Fn(&CellErrors<S>) -> f64 + Sync)| {
            let own = of_cells.par_iter().map(of);
            self.division.gathered(own.collect::<Vec<f64>>())
        };
        let volumes = gathered(&|cell| cell.volume);
        std::array::from_fn(|at| {
            let mut error = StressError {
                of_cell: gathered(&|cell| cell.errors[at]),
                energy: gathered(&|cell| cell.energies[at]).iter().sum(),
                volumes: volumes.clone(),
            };
            if mesh.has_quarter_points {
                error.take_over_at_fronts(mesh);
            }
            error
        })
    }

    fn of_cell<const S: usize>(
        &self,
        recovered: &Recovered<S>,
        deformed: &mut DeformedCell<'_, S>,
        (cell, rock): (usize, &Rock),
    ) -> CellErrors<S> {
        let shape = deformed.look_at(cell);
        let first = deformed.first_slot();
        let mut sums = CellErrors {
            errors: [0.0; S],
            energies: [0.0; S],
            volume: 0.0,
        };
        let at = |fine: &FinePoint| {
            let (stresses, volume) = deformed.stresses(&fine.point);
            let energies = stresses.each_ref().map(|found| rock.energy_density(found));
            (stresses, energies, volume / fine.point.weight)
        };
        let rule = &recovery_rule(shape).fine;
        let uniform = (shape == Shape::Tet4).then(|| at(&rule[0]));
        for fine in rule {
            let place = kernel::position(&fine.point, deformed.nodes());
            let (found, energies, density) = uniform.unwrap_or_else(|| at(fine));
            let volume = density * fine.point.weight;
            let smooth = self
                .patches
                .stresses(recovered, first, &fine.corners, place);
            for state in 0..S {
                let difference = std::array::from_fn(|i| smooth[state][i] - found[state][i]);
                sums.errors[state] += volume * rock.energy_density(&difference);
                sums.energies[state] += volume * energies[state];
            }
            sums.volume += volume;
        }
        sums
    }

    /// Estimates the error of the mean over each fracture of the jump along some directions, given
    /// the error of the [`dual_solution`] along these.
    pub fn mean_error(
        &self,
        system: &System<'_>,
        dual: &StressError,
        stress: &StressError,
    ) -> MeanError {
        let areas = system.discretisation.interface.areas();
        let parts = stress.of_cell.par_iter().zip(&dual.of_cell);
        let parts = parts.zip(&self.nearest_fracture);
        let part = |((e, z), &fracture): ((&f64, &f64), &u32)| {
            let area = areas.get(fracture as usize);
            area.map_or(0.0, |area| (e * z).sqrt() / area)
        };
        let of_cell: Vec<f64> = parts.map(part).collect();
        let mut of_fracture = vec![0.0; areas.len()];
        for (part, &fracture) in of_cell.iter().zip(&self.nearest_fracture) {
            if let Some(sum) = of_fracture.get_mut(fracture as usize) {
                *sum += part;
            }
        }
        MeanError {
            of_cell,
            of_fracture,
        }
    }
}

/// Displacements `z` (m), one a point, under a unit traction on the walls along `directions`, one
/// for each facet point: with normals they tell of the mean opening, with the directions of slip of
/// the mean slip, see [`Estimator::mean_error`]. It costs one rough linear solve with the tangent
/// that `newton` used last.
///
/// # Errors
/// If that solve fails.
pub fn dual_solution(
    system: &System<'_>,
    newton: &mut Newton,
    directions: &[DVec3],
) -> Result<Vec<DVec3>, LinearFailure> {
    let mut forces = vec![DVec3::ZERO; system.discretisation.points.len()];
    let interface = &system.discretisation.interface;
    interface.add_forces(directions, 1.0, &mut forces);
    let pressed = newton.respond(system, &forces, ROUGH)?;
    Ok(system.displacements(&pressed, &Load::NONE))
}

#[cfg(test)]
mod tests {
    use kluft_algebra::thread_ranks::on_threads;

    use super::*;
    use crate::linear::fractured_tests::{problem, system};
    use crate::system::Discretisation;

    #[test]
    fn ranks_estimate_the_errors_of_one_to_the_last_bit() {
        let problem = problem(|z| z * z);
        let whole = system(&problem);
        let points = &whole.discretisation.points;
        let moved = points.node.iter().enumerate().map(|(point, &node)| {
            let place = problem.mesh.nodes[node as usize];
            place * place.x + DVec3::splat(1e-2 * (point % 7) as f64)
        });
        let moved: Vec<DVec3> = moved.collect();
        let expected = Estimator::of(&whole).stress_error(&whole, &moved);
        assert!(expected.relative() > 0.1);
        let found = on_threads(3, |communicator| {
            let discretisation = Discretisation::of(&problem).expect("held");
            let divided = System::divided(&problem, discretisation, communicator);
            Estimator::of(&divided).stress_error(&divided, &moved)
        });
        for found in found {
            assert!(found.of_cell == expected.of_cell);
            assert!(found.volumes == expected.volumes);
            assert_eq!(found.energy, expected.energy);
        }
    }
}
