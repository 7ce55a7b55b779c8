//! Recovered stresses: around each corner of the cells a polynomial is fitted to the stresses
//! sampled in the cells there that are of one rock and in one sector, so that stresses may jump at
//! fractures and between rocks (O. C. Zienkiewicz and J. Z. Zhu, Int. J. Numer. Meth. Engng 33,
//! 1992).

use std::ops::Range;

use glam::DVec3;
use kluft_mesh::{Elements, Mesh};
use lie_core::kernel::{self, MAX_NODES};
use lie_core::{RulePoint, SymmetricStress, recovery_rule};
use rayon::prelude::*;

use super::corner_groups::CornerGroups;
use super::deformed::DeformedCell;
use crate::problem::Problem;
use crate::space::cell::positions;
use crate::system::Discretisation;
use kluft_algebra::small::inverse_factor;
use kluft_algebra::{Lists, RowOwnership};

/// Terms of a complete linear and a complete quadratic polynomial in space.
const LINEAR: usize = 4;
const QUADRATIC: usize = 10;
/// A term that depends on the ones before it but for this share is left out: what is extrapolated
/// with it would be noise.
const DEPENDENT: f64 = 1e-4;
/// Cells whose samples one task takes.
const CELLS_PER_TASK: usize = 1024;
/// Samples for each term, below which cells farther away help, and then a polynomial of lower
/// degree is fitted.
const SAMPLES_PER_TERM: f64 = 1.5;

/// The corner of a cell belongs to one patch.
pub(super) struct Patches {
    /// See [`CornerGroups::of_slot`].
    pub(super) of_slot: Vec<u32>,
    /// Cells of each patch, ascending.
    cells: Lists,
    /// Middle (m) and size (m) of each patch, 0 of those that nothing is fitted in.
    frames: Vec<(DVec3, f64)>,
    /// Where the stress of each cell is sampled (m); start of each cell's samples, and their
    /// number.
    samples: Vec<DVec3>,
    sample_offset: Vec<usize>,
    /// Number of terms of the polynomials: quadratic ones if any cell is quadratic.
    terms: usize,
}

/// What the recovery in some cells asks for.
struct Selection {
    /// Patches of these cells.
    is_fitted: Vec<bool>,
    /// Cells that these patches may be fitted to.
    is_sampled: Vec<bool>,
}

/// `S` recovered stresses: for each patch the coefficients of each component (Pa), term by term.
pub(super) struct Recovered<const S: usize> {
    coefficients: Vec<[SymmetricStress; S]>,
}

impl Patches {
    /// The patches of a mesh: one for each point that is a corner and each rock around it. Stresses
    /// can be recovered in the cells `wanted`. `slots` are those of each node.
    pub(super) fn of(
        problem: &Problem,
        (discretisation, slots): (&Discretisation, &Lists),
        wanted: Range<usize>,
    ) -> Self {
        let (mesh, cells) = (&problem.mesh, &problem.mesh.cells);
        let CornerGroups {
            of_slot,
            cells: around,
            middles,
        } = CornerGroups::of(problem, discretisation, slots);
        let mut patches = Self {
            of_slot,
            cells: around,
            frames: Vec::new(),
            sample_offset: sample_offset(cells),
            samples: Vec::new(),
            terms: terms(cells),
        };
        let selection = patches.selection(cells, wanted);
        let middles = middles.into_par_iter().enumerate();
        let frame = |(patch, middle): (usize, DVec3)| match selection.is_fitted[patch] {
            true => (middle, patches.size(mesh, patch, middle)),
            false => (middle, 0.0),
        };
        patches.frames = middles.map(frame).collect();
        patches.samples = patches.sampled(
            (cells, &selection.is_sampled),
            || [DVec3::ZERO; MAX_NODES],
            |nodes, cell, point| kernel::position(point, positions(mesh, cell, nodes)),
        );
        patches
    }

    /// What the recovery in the cells `wanted` asks for.
    fn selection(&self, cells: &Elements, wanted: Range<usize>) -> Selection {
        let patches_of = |is_wanted: &dyn Fn(usize) -> bool| {
            let mut is_met = vec![false; self.len()];
            for cell in (0..cells.len()).filter(|&cell| is_wanted(cell)) {
                let corners = cells.range(cell).take(cells.shapes[cell].corner_count());
                corners.for_each(|slot| is_met[self.of_slot[slot] as usize] = true);
            }
            is_met
        };
        let cells_of = |is_met: &[bool]| {
            let mut is_beside = vec![false; cells.len()];
            for patch in (0..self.len()).filter(|&patch| is_met[patch]) {
                self.cells_of(patch).for_each(|cell| is_beside[cell] = true);
            }
            is_beside
        };
        if wanted.len() == cells.len() {
            return Selection {
                is_fitted: vec![true; self.len()],
                is_sampled: vec![true; cells.len()],
            };
        }
        let is_fitted = patches_of(&|cell| wanted.contains(&cell));
        let own = cells_of(&is_fitted);
        // Patches beside lend their cells to those with too few.
        let is_sampled = cells_of(&patches_of(&|cell| own[cell]));
        Selection {
            is_fitted,
            is_sampled,
        }
    }

    fn len(&self) -> usize {
        self.cells.count()
    }

    fn cells_of(&self, patch: usize) -> impl Iterator<Item = usize> + '_ {
        self.cells.of(patch).iter().map(|&cell| cell as usize)
    }

    fn samples_of(&self, cell: usize) -> Range<usize> {
        self.sample_offset[cell]..self.sample_offset[cell + 1]
    }

    /// Values at all samples, cell by cell, found with a workspace; zero in cells that are not
    /// `is_sampled`.
    fn sampled<T: Send + Clone + Zero, W>(
        &self,
        (cells, is_sampled): (&Elements, &[bool]),
        workspace: impl Fn() -> W + Sync,
        value: impl Fn(&mut W, usize, &RulePoint) -> T + Sync,
    ) -> Vec<T> {
        let mut values = vec![T::ZERO; self.sample_offset[cells.len()]];
        let tasks = RowOwnership::even(cells.len(), CELLS_PER_TASK);
        let shares = tasks.split(&mut values, &self.sample_offset);
        shares.into_par_iter().for_each(|(owned, mut rest)| {
            let mut workspace = workspace();
            for cell in owned {
                let samples = &recovery_rule(cells.shapes[cell]).samples;
                let (own, tail) = rest.split_at_mut(samples.len());
                rest = tail;
                if !is_sampled[cell] {
                    continue;
                }
                for (target, sample) in own.iter_mut().zip(samples) {
                    *target = value(&mut workspace, cell, sample);
                }
            }
        });
        values
    }

    /// Distance of the farthest corner from the middle of a patch (m).
    fn size(&self, mesh: &Mesh, patch: usize, middle: DVec3) -> f64 {
        let corners = self.cells_of(patch).flat_map(|cell| {
            let count = mesh.cells.shapes[cell].corner_count();
            &mesh.cells.nodes_of(cell)[..count]
        });
        let distance = corners.map(|&node| mesh.nodes[node as usize].distance(middle));
        distance.fold(0.0, f64::max)
    }

    /// Fits polynomials to the stresses of cells, which each task looks at by one of `deformed`, in
    /// every patch that the cells `wanted` ask for: some of those that the patches were made for.
    pub(super) fn recover<'a, const S: usize>(
        &self,
        (cells, wanted): (&Elements, Range<usize>),
        deformed: impl Fn() -> DeformedCell<'a, S> + Sync,
    ) -> Recovered<S> {
        let Selection {
            is_fitted,
            is_sampled,
        } = self.selection(cells, wanted);
        let stresses = self.sampled((cells, &is_sampled), deformed, |deformed, cell, sample| {
            deformed.look_at(cell);
            deformed.stresses(sample).0
        });
        let mut coefficients = vec![[[0.0; 6]; S]; self.terms * self.len()];
        let patches = coefficients.par_chunks_mut(self.terms).enumerate();
        let fitted = patches.filter(|(patch, _)| is_fitted[*patch]);
        fitted.for_each(|(patch, coefficients)| match self.terms {
            QUADRATIC => {
                let fit = self.fit::<QUADRATIC, S>(cells, &stresses, patch);
                coefficients.copy_from_slice(&fit);
            }
            _ => coefficients.copy_from_slice(&self.fit::<LINEAR, S>(cells, &stresses, patch)),
        });
        Recovered { coefficients }
    }

    /// The cells whose stresses a patch is fitted to, and the terms that they suffice for: its own,
    /// and at corners of the body those of the patches beside it too.
    fn around(&self, cells: &Elements, patch: usize) -> (Vec<usize>, usize) {
        let mut around: Vec<usize> = self.cells_of(patch).collect();
        let quadratic = around.iter().any(|&cell| cells.shapes[cell].is_quadratic());
        let wanted = if quadratic { QUADRATIC } else { LINEAR };
        let suffices = |around: &[usize], terms: usize| {
            let samples = around.iter().map(|&cell| self.samples_of(cell).len());
            samples.sum::<usize>() as f64 >= SAMPLES_PER_TERM * terms as f64
        };
        if !suffices(&around, wanted) {
            let corners = around.iter().flat_map(|&cell| {
                let corners = cells.shapes[cell].corner_count();
                cells.range(cell).take(corners)
            });
            let beside = corners.flat_map(|slot| self.cells_of(self.of_slot[slot] as usize));
            around = beside.collect();
            around.sort_unstable();
            around.dedup();
        }
        let fitting = [wanted, LINEAR].into_iter();
        let terms = fitting.into_iter().find(|&terms| suffices(&around, terms));
        (around, terms.unwrap_or(1))
    }

    fn fit<const TERMS: usize, const S: usize>(
        &self,
        cells: &Elements,
        stresses: &[[SymmetricStress; S]],
        patch: usize,
    ) -> [[SymmetricStress; S]; TERMS] {
        let mut normal = [[0.0; TERMS]; TERMS];
        let mut right = [[[0.0; 6]; S]; TERMS];
        let (around, used) = self.around(cells, patch);
        for sample in around.into_iter().flat_map(|cell| self.samples_of(cell)) {
            let terms = self.terms_at::<TERMS>(patch, self.samples[sample]);
            for i in 0..TERMS {
                for j in 0..=i {
                    normal[i][j] += terms[i] * terms[j];
                }
                add(&mut right[i], terms[i], &stresses[sample]);
            }
        }
        // Rows of zeros have no pivot.
        normal[used..].fill([0.0; TERMS]);
        solve(&normal, &right)
    }

    /// The first of `1, x, y, z, x^2, y^2, z^2, xy, yz, xz` in the frame of a patch.
    #[inline]
    fn terms_at<const TERMS: usize>(&self, patch: usize, place: DVec3) -> [f64; TERMS] {
        let (middle, size) = self.frames[patch];
        let DVec3 { x, y, z } = (place - middle) / size;
        let all: [f64; QUADRATIC] = [1.0, x, y, z, x * x, y * y, z * z, x * y, y * z, x * z];
        std::array::from_fn(|term| all[term])
    }

    /// Recovered stresses (Pa) at a place in the cell whose first slot is `first`: the polynomials
    /// of its corners, blended by the linear shape functions `shares`.
    pub(super) fn stresses<const S: usize>(
        &self,
        recovered: &Recovered<S>,
        first: usize,
        shares: &[f64],
        place: DVec3,
    ) -> [SymmetricStress; S] {
        match self.terms {
            QUADRATIC => self.blended::<QUADRATIC, S>(recovered, first, shares, place),
            _ => self.blended::<LINEAR, S>(recovered, first, shares, place),
        }
    }

    #[inline]
    fn blended<const TERMS: usize, const S: usize>(
        &self,
        recovered: &Recovered<S>,
        first: usize,
        shares: &[f64],
        place: DVec3,
    ) -> [SymmetricStress; S] {
        let mut stresses = [[0.0; 6]; S];
        for (share, &patch) in shares.iter().zip(&self.of_slot[first..]) {
            let patch = patch as usize;
            let coefficients = &recovered.coefficients[TERMS * patch..][..TERMS];
            let terms = self.terms_at::<TERMS>(patch, place);
            for (term, coefficients) in terms.iter().zip(coefficients) {
                add(&mut stresses, share * term, coefficients);
            }
        }
        stresses
    }
}

/// Values at samples of which nothing is known.
trait Zero {
    const ZERO: Self;
}

impl Zero for DVec3 {
    const ZERO: Self = Self::ZERO;
}

impl<const S: usize> Zero for [SymmetricStress; S] {
    const ZERO: Self = [[0.0; 6]; S];
}

/// Number of terms of polynomials on these cells.
pub(super) fn terms(cells: &Elements) -> usize {
    match cells.has_quadratic() {
        true => QUADRATIC,
        false => LINEAR,
    }
}

/// Start of each cell's samples, and their number.
fn sample_offset(cells: &Elements) -> Vec<usize> {
    let mut offset = vec![0];
    offset.extend(cells.shapes.iter().scan(0, |end, &shape| {
        *end += recovery_rule(shape).samples.len();
        Some(*end)
    }));
    offset
}

/// `A c = b` for positive semidefinite `A`, given by its lower triangle, with zeros for terms that
/// depend on those before them.
fn solve<const TERMS: usize, const S: usize>(
    normal: &[[f64; TERMS]; TERMS],
    right: &[[SymmetricStress; S]; TERMS],
) -> [[SymmetricStress; S]; TERMS] {
    let (inverse, _) = inverse_factor(normal, DEPENDENT);
    let mut half = [[[0.0; 6]; S]; TERMS];
    let mut solution = [[[0.0; 6]; S]; TERMS];
    for i in 0..TERMS {
        for j in 0..=i {
            add(&mut half[i], inverse[i][j], &right[j]);
        }
    }
    for i in 0..TERMS {
        for j in i..TERMS {
            add(&mut solution[i], inverse[j][i], &half[j]);
        }
    }
    solution
}

#[inline]
fn add<const S: usize>(sum: &mut [SymmetricStress; S], factor: f64, terms: &[SymmetricStress; S]) {
    let sum = sum.as_flattened_mut().iter_mut();
    for (sum, term) in sum.zip(terms.as_flattened()) {
        *sum += factor * term;
    }
}
