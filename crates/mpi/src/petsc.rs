//! PETSc and MPI behind safe types: the only `unsafe` of the project.
//!
//! What every block relies on: a [`World`] exists exactly once a process, from the start of PETSc
//! to its end; everything else holds one, so PETSc runs as long as anything calls it. Calls come
//! from the thread that started it, which [`World::here`] checks: so the types may be sent to and
//! shared with other threads, where they do nothing but panic. Lengths of arrays are checked before
//! a pointer is handed over, and the shim keeps none of them.
#![allow(unsafe_code)]

use std::ffi::{c_double, c_int, c_void};
use std::ptr::null_mut;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::ThreadId;
use std::time::Duration;

use kluft_solver::multigrid::BlockList;

pub use crate::answers::{PetscFailure, Solved, Traffic};

unsafe extern "C" {
    fn km_start() -> c_int;
    fn km_end() -> c_int;
    fn km_abort(code: c_int);
    fn km_rank() -> c_int;
    fn km_ranks() -> c_int;
    fn km_on_machine(count: *mut c_int) -> c_int;
    fn km_all_arrive(seconds: c_double, arrived: *mut c_int) -> c_int;
    fn km_gather(own: *const u64, count: c_int, all: *mut u64) -> c_int;
    fn km_gather_triples(own: *const c_double, counts: *const c_int, all: *mut c_double) -> c_int;
    fn km_exchange_counts(out: *const c_int, into: *mut c_int) -> c_int;
    fn km_exchange(
        size: c_int,
        out: *const c_int,
        sent: *const c_void,
        into: *const c_int,
        received: *mut c_void,
    ) -> c_int;
    fn km_matrix(
        rows: i64,
        columns: i64,
        m: c_int,
        l: c_int,
        offset: *const i64,
        column: *const i64,
        blocks: *const c_double,
        out: *mut *mut c_void,
    ) -> c_int;
    fn km_free_matrix(matrix: *mut c_void) -> c_int;
    fn km_solver(
        operator: *mut c_void,
        inverse: *mut c_void,
        prolongator: *mut c_void,
        next: *mut c_void,
        modes: *const c_double,
        is_small: c_int,
        margin: c_double,
        out: *mut *mut c_void,
    ) -> c_int;
    fn km_set_operator(solver: *mut c_void, operator: *mut c_void) -> c_int;
    fn km_solve(
        solver: *mut c_void,
        right: *const c_double,
        solution: *mut c_double,
        tolerance: c_double,
        most: c_int,
        iterations: *mut c_int,
        reason: *mut c_int,
        broke: *mut c_int,
        residual: *mut c_double,
    ) -> c_int;
    fn km_precondition(solver: *mut c_void, right: *const c_double, out: *mut c_double) -> c_int;
    fn km_smooth(solver: *mut c_void, right: *const c_double, out: *mut c_double) -> c_int;
    fn km_free(solver: *mut c_void) -> c_int;
    fn km_counts(counts: *mut c_double) -> c_int;
}

fn done(code: c_int) -> Result<(), PetscFailure> {
    match code {
        0 => Ok(()),
        code => Err(PetscFailure(code)),
    }
}

/// All ranks, from the start of PETSc to its end.
#[derive(Debug)]
pub struct World {
    thread: ThreadId,
    rank: usize,
    ranks: usize,
}

impl World {
    /// Starts PETSc, and MPI with it.
    ///
    /// # Errors
    /// If that fails.
    ///
    /// # Panics
    /// If it was started before.
    pub fn start() -> Result<Arc<Self>, PetscFailure> {
        static STARTED: AtomicBool = AtomicBool::new(false);
        assert!(!STARTED.swap(true, Ordering::SeqCst), "started once");
        // SAFETY: nothing of PETSc was called before, and this is passed once a process.
        done(unsafe { km_start() })?;
        // SAFETY: PETSc runs, see above.
        let (rank, ranks) = unsafe { (km_rank(), km_ranks()) };
        Ok(Arc::new(Self {
            thread: std::thread::current().id(),
            rank: rank as usize,
            ranks: ranks as usize,
        }))
    }

    /// Checks that this is the thread that may call PETSc.
    fn here(&self) {
        let own = std::thread::current().id();
        assert_eq!(
            own, self.thread,
            "PETSc is called by the thread that started it"
        );
    }

    /// Number of this rank.
    pub fn rank(&self) -> usize {
        self.rank
    }

    /// Number of ranks.
    pub fn ranks(&self) -> usize {
        self.ranks
    }

    /// Ends all ranks, whatever they do, with this exit code.
    pub fn abort(code: u8) -> ! {
        // SAFETY: MPI may end all ranks from any thread; it does not return to anything that could
        // be left in a state.
        unsafe { km_abort(c_int::from(code)) };
        std::process::exit(c_int::from(code))
    }

    /// Number of ranks on this machine.
    ///
    /// # Errors
    /// Those of MPI.
    pub fn on_machine(&self) -> Result<usize, PetscFailure> {
        self.here();
        let mut count = 1;
        // SAFETY: PETSc runs on this thread; the number is written before the call returns.
        done(unsafe { km_on_machine(&mut count) })?;
        Ok(count as usize)
    }

    /// Whether all ranks have come here when this time is over. Nothing else may follow if not.
    ///
    /// # Errors
    /// Those of MPI.
    pub fn all_arrive(&self, within: Duration) -> Result<bool, PetscFailure> {
        self.here();
        let mut arrived = 0;
        // SAFETY: PETSc runs on this thread; the number is written before the call returns.
        done(unsafe { km_all_arrive(within.as_secs_f64(), &mut arrived) })?;
        Ok(arrived != 0)
    }

    /// The numbers of all ranks, rank by rank; each gives as many.
    ///
    /// # Errors
    /// Those of MPI.
    pub fn gather(&self, own: &[u64]) -> Result<Vec<u64>, PetscFailure> {
        self.here();
        let mut all = vec![0; own.len() * self.ranks];
        // SAFETY: PETSc runs on this thread; `all` has room for the numbers of all ranks.
        done(unsafe { km_gather(own.as_ptr(), own.len() as c_int, all.as_mut_ptr()) })?;
        Ok(all)
    }

    /// The 3-vectors of all ranks, rank by rank, rank `r` giving `counts[r]`.
    ///
    /// # Errors
    /// Those of MPI.
    ///
    /// # Panics
    /// If `own` has not the length of this rank.
    pub fn gather_vectors(
        &self,
        own: &[[f64; 3]],
        counts: &[i32],
    ) -> Result<Vec<[f64; 3]>, PetscFailure> {
        self.here();
        assert_eq!(counts.len(), self.ranks, "one length a rank");
        assert_eq!(own.len(), counts[self.rank] as usize, "own length");
        let sum: usize = counts.iter().map(|&count| count as usize).sum();
        let mut all = vec![[0.0; 3]; sum];
        let (from, to) = (own.as_ptr().cast(), all.as_mut_ptr().cast());
        // SAFETY: PETSc runs on this thread; both arrays have the lengths that `counts` says.
        done(unsafe { km_gather_triples(from, counts.as_ptr(), to) })?;
        Ok(all)
    }

    /// Sends a list to each rank, and returns those that came, in the order of the ranks.
    ///
    /// # Errors
    /// Those of MPI.
    ///
    /// # Panics
    /// If there is not one list a rank.
    pub fn exchange<const N: usize>(
        &self,
        lists: &[Vec<[f64; N]>],
    ) -> Result<Vec<[f64; N]>, PetscFailure> {
        self.here();
        assert_eq!(lists.len(), self.ranks, "one list a rank");
        let out: Vec<c_int> = lists.iter().map(|list| list.len() as c_int).collect();
        let mut into: Vec<c_int> = vec![0; self.ranks];
        // SAFETY: PETSc runs on this thread; both arrays have one number a rank.
        done(unsafe { km_exchange_counts(out.as_ptr(), into.as_mut_ptr()) })?;
        let sent = lists.concat();
        let sum: usize = into.iter().map(|&count| count as usize).sum();
        let mut received = vec![[0.0; N]; sum];
        let size = size_of::<[f64; N]>() as c_int;
        let (from, to) = (sent.as_ptr().cast(), received.as_mut_ptr().cast());
        // SAFETY: as above; the records are plain numbers of `size` bytes, and both arrays have as
        // many as the counts say.
        done(unsafe { km_exchange(size, out.as_ptr(), from, into.as_ptr(), to) })?;
        Ok(received)
    }

    /// What was counted on this rank so far.
    ///
    /// # Errors
    /// Those of PETSc.
    pub fn traffic(&self) -> Result<Traffic, PetscFailure> {
        self.here();
        let mut counts = [0.0; 5];
        // SAFETY: PETSc runs on this thread; the shim writes five numbers.
        done(unsafe { km_counts(counts.as_mut_ptr()) })?;
        let [iterations, exchanges, messages, bytes, reductions] = counts;
        Ok(Traffic {
            iterations,
            exchanges,
            messages,
            bytes,
            reductions,
        })
    }
}

impl Drop for World {
    fn drop(&mut self) {
        if std::thread::current().id() == self.thread {
            // SAFETY: the last holder is gone, so nothing calls PETSc after this.
            unsafe { km_end() };
        }
    }
}

/// A distributed matrix.
#[derive(Debug)]
pub struct Matrix {
    pointer: *mut c_void,
    world: Arc<World>,
}

// SAFETY: the pointer is used on the thread of its world only, which every use checks.
unsafe impl Send for Matrix {}
// SAFETY: as above.
unsafe impl Sync for Matrix {}

impl Matrix {
    /// The matrix whose rows of this rank are given in blocks; `number` gives a column its global
    /// number, and `columns` of all of them are this rank's own.
    ///
    /// # Errors
    /// Those of PETSc.
    pub fn new<const M: usize, const L: usize>(
        world: &Arc<World>,
        rows: &BlockList<M, L>,
        columns: usize,
        number: impl Fn(u32) -> i64,
    ) -> Result<Self, PetscFailure> {
        world.here();
        let offset: Vec<i64> = rows.offset.iter().map(|&at| at as i64).collect();
        let mut order: Vec<(i64, usize)> = Vec::new();
        let mut numbers = Vec::with_capacity(rows.columns.len());
        let mut blocks = Vec::with_capacity(rows.blocks.len());
        for row in rows.offset.windows(2) {
            order.clear();
            order.extend((row[0]..row[1]).map(|at| (number(rows.columns[at]), at)));
            order.sort_unstable();
            numbers.extend(order.iter().map(|(number, _)| *number));
            blocks.extend(order.iter().map(|&(_, at)| rows.blocks[at]));
        }
        assert_eq!(offset.last(), Some(&(blocks.len() as i64)), "the end");
        let mut pointer = null_mut();
        // SAFETY: PETSc runs on this thread; the arrays have the lengths that `offset` says, and
        // PETSc copies them.
        done(unsafe {
            km_matrix(
                rows.rows() as i64,
                columns as i64,
                M as c_int,
                L as c_int,
                offset.as_ptr(),
                numbers.as_ptr(),
                blocks.as_ptr().cast(),
                &mut pointer,
            )
        })?;
        Ok(Self {
            pointer,
            world: Arc::clone(world),
        })
    }

    /// Hands it over.
    fn into_pointer(mut self) -> *mut c_void {
        std::mem::replace(&mut self.pointer, null_mut())
    }
}

impl Drop for Matrix {
    fn drop(&mut self) {
        if !self.pointer.is_null() && std::thread::current().id() == self.world.thread {
            // SAFETY: PETSc runs, and nobody else has the pointer.
            unsafe { km_free_matrix(self.pointer) };
        }
    }
}

/// The matrices of a solver.
pub struct SolverParts {
    /// The tangent.
    pub operator: Matrix,
    /// The inverses of its diagonal blocks of clusters.
    pub inverse: Matrix,
    /// Prolongator and matrix of the next level, with six modes for each scalar unknown of this
    /// rank, if there is a next level.
    pub next: Option<(Matrix, Matrix, Vec<[f64; 6]>)>,
    /// Whether the whole is small enough for each rank to factorise.
    pub is_small: bool,
    /// Factor on the bounds of spectra.
    pub margin: f64,
}

/// Conjugate gradients with multigrid.
#[derive(Debug)]
pub struct Solver {
    pointer: *mut c_void,
    rows: usize,
    world: Arc<World>,
}

// SAFETY: the pointer is used on the thread of its world only, which every use checks.
unsafe impl Send for Solver {}
// SAFETY: as above.
unsafe impl Sync for Solver {}

impl Solver {
    /// Sets up a solver with `rows` block rows on this rank.
    ///
    /// # Errors
    /// Those of PETSc.
    pub fn new(world: &Arc<World>, rows: usize, parts: SolverParts) -> Result<Self, PetscFailure> {
        world.here();
        let (prolongator, next, modes) = match parts.next {
            Some((prolongator, next, modes)) => {
                (prolongator.into_pointer(), next.into_pointer(), modes)
            }
            None => (null_mut(), null_mut(), Vec::new()),
        };
        let mut solver = Self {
            pointer: null_mut(),
            rows,
            world: Arc::clone(world),
        };
        // SAFETY: PETSc runs on this thread; the shim takes the matrices over, whose pointers
        // nobody else has, and reads six modes for each row of `next`, as the caller promises.
        done(unsafe {
            km_solver(
                parts.operator.into_pointer(),
                parts.inverse.into_pointer(),
                prolongator,
                next,
                modes.as_ptr().cast(),
                c_int::from(parts.is_small),
                parts.margin,
                &mut solver.pointer,
            )
        })?;
        Ok(solver)
    }

    /// Solves with another operator from now on, on the levels as they are.
    ///
    /// # Errors
    /// Those of PETSc.
    pub fn set_operator(&mut self, operator: Matrix) -> Result<(), PetscFailure> {
        self.world.here();
        // SAFETY: PETSc runs on this thread, the solver lives; it takes the matrix over, whose
        // pointer nobody else has.
        done(unsafe { km_set_operator(self.pointer, operator.into_pointer()) })
    }

    fn check(&self, right: &[[f64; 3]]) {
        self.world.here();
        assert_eq!(right.len(), self.rows, "one entry a row");
    }

    /// Solves for the rows of this rank.
    ///
    /// # Errors
    /// Those of PETSc.
    ///
    /// # Panics
    /// If `right` has not one entry a row of this rank.
    pub fn solve(
        &mut self,
        right: &[[f64; 3]],
        tolerance: f64,
        most: usize,
    ) -> Result<(Vec<[f64; 3]>, Solved), PetscFailure> {
        self.check(right);
        let mut solution = vec![[0.0; 3]; self.rows];
        let (mut iterations, mut reason, mut broke, mut residual) = (0, 0, 0, 0.0);
        // SAFETY: PETSc runs on this thread, the solver lives; both vectors have its length.
        done(unsafe {
            km_solve(
                self.pointer,
                right.as_ptr().cast(),
                solution.as_mut_ptr().cast(),
                tolerance,
                most as c_int,
                &mut iterations,
                &mut reason,
                &mut broke,
                &mut residual,
            )
        })?;
        let solved = Solved {
            iterations: iterations as usize,
            converged: reason > 0,
            broke: broke != 0,
            residual,
        };
        Ok((solution, solved))
    }

    /// One cycle of the preconditioner.
    ///
    /// # Errors
    /// Those of PETSc.
    ///
    /// # Panics
    /// If `right` has not one entry a row of this rank.
    pub fn precondition(&mut self, right: &[[f64; 3]]) -> Result<Vec<[f64; 3]>, PetscFailure> {
        self.check(right);
        let mut out = vec![[0.0; 3]; self.rows];
        let (from, to) = (right.as_ptr().cast(), out.as_mut_ptr().cast());
        // SAFETY: PETSc runs on this thread, the solver lives; both vectors have its length.
        done(unsafe { km_precondition(self.pointer, from, to) })?;
        Ok(out)
    }

    /// The inverses of the diagonal blocks alone.
    ///
    /// # Errors
    /// Those of PETSc.
    ///
    /// # Panics
    /// If `right` has not one entry a row of this rank.
    pub fn clusters_alone(&mut self, right: &[[f64; 3]]) -> Result<Vec<[f64; 3]>, PetscFailure> {
        self.check(right);
        let mut out = vec![[0.0; 3]; self.rows];
        let (from, to) = (right.as_ptr().cast(), out.as_mut_ptr().cast());
        // SAFETY: PETSc runs on this thread, the solver lives; both vectors have its length.
        done(unsafe { km_smooth(self.pointer, from, to) })?;
        Ok(out)
    }
}

impl Drop for Solver {
    fn drop(&mut self) {
        if !self.pointer.is_null() && std::thread::current().id() == self.world.thread {
            // SAFETY: PETSc runs, and nobody else has the pointer.
            unsafe { km_free(self.pointer) };
        }
    }
}
