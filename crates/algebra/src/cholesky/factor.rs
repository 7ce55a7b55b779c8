//! The factor of a scalar matrix, symbolic and numeric, whatever its unknowns stand for.

use faer::Side;
use faer::dyn_stack::MemStack;
use faer::linalg::cholesky::llt::factor::{LltError, LltRegularization};
use faer::perm::PermRef;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::supernodal::SymbolicSupernodalCholesky;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};

use crate::dense_kernels::{parallelism, reserve_panels, scratch};
use crate::failure::LinearFailure;

/// Analyses the upper triangle of a matrix whose scalars are eliminated in the order `forward` (new
/// to old).
///
/// # Errors
/// If the analysis fails.
pub(super) fn symbolic(
    shape: SymbolicSparseColMatRef<'_, usize>,
    forward: &[usize],
) -> Result<SymbolicCholesky<usize>, LinearFailure> {
    let mut inverse = vec![0; forward.len()];
    for (new, &old) in forward.iter().enumerate() {
        inverse[old] = new;
    }
    factorize_symbolic_cholesky(
        shape,
        Side::Upper,
        SymmetricOrdering::Custom(PermRef::new_checked(forward, &inverse, forward.len())),
        CholeskySymbolicParams {
            supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
            ..Default::default()
        },
    )
    .map_err(|error| LinearFailure::Analysis(format!("{error:?}")))
}

/// The supernodes of an analysis.
pub(super) fn supernodal(symbolic: &SymbolicCholesky<usize>) -> &SymbolicSupernodalCholesky<usize> {
    match symbolic.raw() {
        SymbolicCholeskyRaw::Supernodal(symbolic) => symbolic,
        SymbolicCholeskyRaw::Simplicial(_) => unreachable!("supernodes were asked for"),
    }
}

/// Floating-point operations of a factorisation: the sum over the columns of the factor of the
/// square of the number of their entries.
pub(super) fn operations(factor: &SymbolicSupernodalCholesky<usize>) -> f64 {
    let squares = |tallest: usize, columns: usize| -> f64 {
        (0..columns).map(|j| ((tallest - j) as f64).powi(2)).sum()
    };
    (0..factor.n_supernodes())
        .map(|index| {
            let columns = factor.supernode_end()[index] - factor.supernode_begin()[index];
            let below = factor.supernode(index).pattern().len();
            squares(below + columns, columns)
        })
        .sum()
}

/// Factorises the upper triangle of a matrix; the error of a matrix that is not positive definite
/// holds the place in the order of elimination where it showed.
///
/// # Errors
/// If the matrix is not positive definite or memory runs out.
pub(super) fn numeric(
    symbolic: &SymbolicCholesky<usize>,
    upper: SparseColMatRef<'_, usize, f64>,
    factor: &mut Vec<f64>,
) -> Result<(), LinearFailure> {
    let length = symbolic.len_val();
    factor.clear();
    factor
        .try_reserve_exact(length)
        .map_err(|_| LinearFailure::OutOfMemory(length * size_of::<f64>()))?;
    factor.resize(length, 0.0);
    let par = parallelism();
    let request = symbolic.factorize_numeric_llt_scratch::<f64>(par, faer::Spec::default());
    let mut memory = scratch(request)?;
    reserve_panels()?;
    symbolic
        .factorize_numeric_llt(
            factor,
            upper,
            Side::Upper,
            LltRegularization::default(),
            par,
            MemStack::new(&mut memory),
            faer::Spec::default(),
        )
        .map_err(|LltError::NonPositivePivot { index }| LinearFailure::Indefinite(index))?;
    Ok(())
}
