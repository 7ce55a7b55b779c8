//! Rock and flow solved together.
//!
//! With the stiffness `K` of rock and fractures, the push `B` of the pressures and the linearised
//! flow `C o + E d` (see `flow::linearised`),
//!
//! ```text
//! [ K  -B ] [ du ]   [ forces out of balance ]
//! [ C   E ] [ d  ] = [ what is missing       ]
//! ```
//!
//! goes to GMRES, preconditioned from the right by `[ K  -B ; 0  S ]`: the solver for `K` as it
//! stands, and a factor of `S = E + rho / dt B^T diag(K)^-1 B`, in which every node answers by
//! itself.

use std::cell::RefCell;

use glam::{DMat3, DVec3};
use kluft_algebra::{
    ConjugateGradientOutcome, ConjugateGradientSettings, FixedPart, InterfaceBlocks, LinearFailure,
    ScalarCholesky, gmres, norm, trace,
};
use rayon::prelude::*;

use crate::assembly::interface::Interface;
use crate::flow::LinearisedFlow;
use crate::linear::tangent_solver::TangentSolver;

/// Iterations after which a linear solve has failed.
const MAX_ITERATIONS: usize = 240;
/// Residual, as a share of the right-hand side, that an iteration which gains nothing more may
/// leave.
const ROUNDED: f64 = 1e-3;
/// Least share of the residual that a solve removes.
const LEAST_GAIN: f64 = 0.1;
/// Share of the trace of a block that makes it invertible where directions are held.
const BARELY_STIFF: f64 = 1e-12;

/// What is to be brought into balance.
pub(crate) struct CoupledRhs<'a> {
    /// Forces on all unknowns (N).
    pub(crate) forces: &'a [DVec3],
    /// What is missing at the pressures that are not given (m^3/s).
    pub(crate) missing: &'a [f64],
    /// Norms of what may be left of the forces (N) and of what is missing (m^3/s), for the norms
    /// that forces, and what they open, and what is missing, and how it pushes, amount to.
    pub(crate) goals: &'a dyn Fn([f64; 2]) -> [f64; 2],
}

/// Solution of a coupled system.
pub(crate) struct CoupledSolution {
    /// Unknown 3-vectors (m).
    pub(crate) unknowns: Vec<DVec3>,
    /// Changes of the pressures that are not given (Pa).
    pub(crate) potentials: Vec<f64>,
    /// Iterations it took.
    pub(crate) iterations: usize,
}

/// The tangent of a coupled system.
pub(super) struct CoupledTangent<'s, 'a> {
    pub(super) fixed: FixedPart<'s>,
    pub(super) interface: &'s Interface,
    /// Stiffness of the fractures, one block for each of the interface's columns.
    pub(super) stiffness: &'s [DMat3],
    pub(super) flow: &'s LinearisedFlow<'s, 'a>,
}

impl CoupledTangent<'_, '_> {
    /// Factorises the preconditioner of the pressures.
    ///
    /// # Errors
    /// If a number is not finite, or memory runs out.
    pub(super) fn factorise(
        &self,
        factor: &mut Option<ScalarCholesky>,
    ) -> Result<(), LinearFailure> {
        if self.flow.len() == 0 {
            return Ok(());
        }
        self.flow.schur(&self.compliance(), factor)
    }

    /// Openings of the facet points under a unit pressure everywhere (m/Pa), if every unknown
    /// answers by itself.
    fn compliance(&self) -> Vec<f64> {
        let mut forces = vec![DVec3::ZERO; self.fixed.matrix.rows()];
        self.flow.add_unit_push(&mut forces);
        self.interface.openings(&self.alone(&forces))
    }

    /// What forces (N) move the unknowns by (m) if every one answers by itself; those away from
    /// fractures stay.
    fn alone(&self, forces: &[DVec3]) -> Vec<DVec3> {
        let blocks = InterfaceBlocks {
            pattern: self.fixed.interface,
            blocks: self.stiffness,
        };
        let answers: Vec<(u32, DVec3)> = (0..self.interface.unknowns.len())
            .into_par_iter()
            .map(|row| {
                let unknown = self.interface.unknowns[row];
                let own = blocks.row(row).find(|(column, _)| *column == unknown);
                let own = own.map_or(DMat3::ZERO, |(_, block)| *block);
                let block = self.fixed.diagonal(row) + own;
                let block = block + BARELY_STIFF * trace(block) * DMat3::IDENTITY;
                (unknown, block.inverse() * forces[unknown as usize])
            })
            .collect();
        let mut moved = vec![DVec3::ZERO; forces.len()];
        for (unknown, answer) in answers {
            moved[unknown as usize] = answer;
        }
        moved
    }

    /// Solves, preconditioned by a solver for the stiffness and by the factor of
    /// [`Self::factorise`].
    ///
    /// # Errors
    /// If the iteration fails.
    pub(super) fn solve(
        &self,
        inner: &mut dyn TangentSolver,
        factor: Option<&ScalarCholesky>,
        rhs: &CoupledRhs<'_>,
    ) -> Result<CoupledSolution, LinearFailure> {
        let packing = Packing {
            unknowns: rhs.forces.len(),
            pressures: rhs.missing.len(),
            scales: self.scales(inner, factor, rhs)?,
        };
        let packed = packing.scaled(rhs.forces, rhs.missing);
        let size = norm(&packed);
        if !size.is_finite() {
            return Err(LinearFailure::NotFinite);
        }
        let tolerance = size.recip().min(LEAST_GAIN);
        let mut solution = vec![DVec3::ZERO; packed.len()];
        let mut failure = None;
        // The iteration asks for one of them at a time.
        let inner = RefCell::new(inner);
        let report = gmres(
            |vector, image| {
                let (unknowns, pressures) = packing.split(vector);
                let (forces, rest) = image.split_at_mut(packing.unknowns);
                let rates = self.product(&**inner.borrow(), (unknowns, &pressures), forces);
                pack_scalars(&rates, rest);
                packing.scale(image);
            },
            |residual, correction| {
                let (forces, missing) = packing.unscaled(residual);
                let rest = (forces, &missing[..]);
                match self.precondition(&mut **inner.borrow_mut(), factor, rest) {
                    Ok((unknowns, pressures)) => packing.pack(&unknowns, &pressures, correction),
                    Err(error) => failure = Some(error),
                }
            },
            &packed,
            &mut solution,
            ConjugateGradientSettings {
                tolerance,
                max_iterations: MAX_ITERATIONS,
            },
        );
        let last = report.residuals.last().copied().unwrap_or(f64::NAN);
        let (unknowns, potentials) = packing.split(&solution);
        match (failure, report.outcome) {
            (Some(failure), _) => Err(failure),
            (_, ConjugateGradientOutcome::NotFinite) => Err(LinearFailure::NotFinite),
            _ if last <= tolerance.max(ROUNDED) => Ok(CoupledSolution {
                unknowns: unknowns.to_vec(),
                potentials,
                iterations: report.iterations,
            }),
            _ => Err(LinearFailure::Stalled(report.iterations)),
        }
    }

    /// The change that leaves nothing missing if every unknown answers by itself.
    pub(super) fn conserving(
        &self,
        factor: &ScalarCholesky,
        missing: &[f64],
    ) -> (Vec<DVec3>, Vec<f64>) {
        let pressures = factor.solve(missing);
        let mut push = vec![DVec3::ZERO; self.fixed.matrix.rows()];
        self.flow.add_push(&pressures, 1.0, &mut push);
        (self.alone(&push), pressures)
    }

    /// Factors of forces (1/N) and rates (s/m^3) that make what may be left of each 1. Either may
    /// be in balance as long as the other is not, so each counts with what the other makes of it:
    /// loads far from a fracture reach it through the rock.
    fn scales(
        &self,
        inner: &mut dyn TangentSolver,
        factor: Option<&ScalarCholesky>,
        rhs: &CoupledRhs<'_>,
    ) -> Result<[f64; 2], LinearFailure> {
        let moved = inner.precondition(self.fixed, rhs.forces)?;
        let openings = self.interface.openings(&moved);
        let rates = self.flow.answer(&openings, &vec![0.0; rhs.missing.len()]);
        let pressures = factor.map_or_else(Vec::new, |factor| factor.solve(rhs.missing));
        let mut push = vec![DVec3::ZERO; rhs.forces.len()];
        self.flow.add_push(&pressures, 1.0, &mut push);
        let goals = (rhs.goals)([
            norm(rhs.forces).max(norm(&push)),
            length(rhs.missing).max(length(&rates)),
        ]);
        Ok(goals.map(|goal| if goal > 0.0 { goal.recip() } else { 1.0 }))
    }

    /// Forces (N) and rates (m^3/s) that changes of the unknowns (m) and pressures (Pa) ask for.
    fn product(
        &self,
        inner: &dyn TangentSolver,
        (unknowns, pressures): (&[DVec3], &[f64]),
        forces: &mut [DVec3],
    ) -> Vec<f64> {
        inner.multiply(self.fixed, self.stiffness, unknowns, forces);
        self.flow.add_push(pressures, -1.0, forces);
        let openings = self.interface.openings(unknowns);
        self.flow.answer(&openings, pressures)
    }

    fn precondition(
        &self,
        inner: &mut dyn TangentSolver,
        factor: Option<&ScalarCholesky>,
        (mut forces, missing): (Vec<DVec3>, &[f64]),
    ) -> Result<(Vec<DVec3>, Vec<f64>), LinearFailure> {
        let pressures = factor.map_or_else(Vec::new, |factor| factor.solve(missing));
        self.flow.add_push(&pressures, 1.0, &mut forces);
        Ok((inner.precondition(self.fixed, &forces)?, pressures))
    }
}

/// Euclidean norm.
fn length(rates: &[f64]) -> f64 {
    rates.iter().map(|rate| rate * rate).sum::<f64>().sqrt()
}

/// How unknowns and pressures, or forces and rates, stand in one vector: 3-vectors, then scalars by
/// threes.
struct Packing {
    unknowns: usize,
    pressures: usize,
    /// Factors of forces (1/N) and rates (s/m^3).
    scales: [f64; 2],
}

fn pack_scalars(scalars: &[f64], blocks: &mut [DVec3]) {
    for (block, three) in blocks.iter_mut().zip(scalars.chunks(3)) {
        let of = |index: usize| three.get(index).copied().unwrap_or(0.0);
        *block = DVec3::new(of(0), of(1), of(2));
    }
}

impl Packing {
    fn pack(&self, vectors: &[DVec3], scalars: &[f64], packed: &mut [DVec3]) {
        let (first, rest) = packed.split_at_mut(self.unknowns);
        first.copy_from_slice(vectors);
        pack_scalars(scalars, rest);
    }

    fn scaled(&self, forces: &[DVec3], rates: &[f64]) -> Vec<DVec3> {
        let mut packed = vec![DVec3::ZERO; self.unknowns + self.pressures.div_ceil(3)];
        self.pack(forces, rates, &mut packed);
        self.scale(&mut packed);
        packed
    }

    fn scale(&self, packed: &mut [DVec3]) {
        let (first, rest) = packed.split_at_mut(self.unknowns);
        let [of_forces, of_rates] = self.scales;
        first.par_iter_mut().for_each(|force| *force *= of_forces);
        rest.iter_mut().for_each(|rate| *rate *= of_rates);
    }

    fn split<'v>(&self, packed: &'v [DVec3]) -> (&'v [DVec3], Vec<f64>) {
        let (first, rest) = packed.split_at(self.unknowns);
        let scalars = rest.iter().flat_map(|block| block.to_array());
        (first, scalars.take(self.pressures).collect())
    }

    fn unscaled(&self, packed: &[DVec3]) -> (Vec<DVec3>, Vec<f64>) {
        let (forces, mut rates) = self.split(packed);
        let [of_forces, of_rates] = self.scales;
        rates.iter_mut().for_each(|rate| *rate /= of_rates);
        (
            forces.par_iter().map(|force| *force / of_forces).collect(),
            rates,
        )
    }
}
