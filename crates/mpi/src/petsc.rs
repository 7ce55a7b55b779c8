//! PETSc and MPI behind safe types: the only `unsafe` of the project.
//!
//! What every block relies on: a [`World`] exists exactly once a process, from the start of PETSc
//! to its end; everything else holds one, so PETSc runs as long as anything calls it. Calls come
//! from the thread that started it, which [`World::here`] checks: so the types may be sent to and
//! shared with other threads, where they do nothing but panic. Lengths of arrays are checked before
//! a pointer is handed over, and the shim keeps none of them.
#![allow(unsafe_code)]

use std::ffi::{c_int, c_void};
use std::ptr::null_mut;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::ThreadId;
use std::time::Duration;

use crate::lines::{EntryShape, checked, in_lines};
use crate::parts::SolverParts;

pub use crate::answers::{PetscFailure, Preconditioner, Solved, Traffic};

/// What the shim makes.
type Handle = *mut c_void;

unsafe extern "C" {
    fn km_start() -> c_int;
    fn km_end() -> c_int;
    fn km_abort(code: c_int);
    fn km_rank() -> c_int;
    fn km_ranks() -> c_int;
    fn km_on_machine(count: *mut c_int) -> c_int;
    fn km_all_arrive(seconds: f64, arrived: *mut c_int) -> c_int;
    fn km_gather(own: *const u64, count: c_int, all: *mut u64) -> c_int;
    fn km_gather_records(
        size: c_int,
        own: *const c_void,
        counts: *const c_int,
        all: Handle,
    ) -> c_int;
    fn km_matrix(
        rows: i64,
        columns: i64,
        m: c_int,
        l: c_int,
        block: c_int,
        own: *const c_int,
        others: *const c_int,
        out: *mut Handle,
    ) -> c_int;
    fn km_matrix_row(
        matrix: Handle,
        row: i64,
        down: c_int,
        across: c_int,
        count: c_int,
        columns: *const i64,
        lines: *const f64,
    ) -> c_int;
    fn km_matrix_end(matrix: Handle) -> c_int;
    fn km_free_matrix(matrix: Handle) -> c_int;
    fn km_solver(
        rock: Handle,
        fractures: Handle,
        inverse: Handle,
        count: c_int,
        prolongators: *const Handle,
        matrices: *const Handle,
        coarsest: Handle,
        largest: *const f64,
        is_small: c_int,
        out: *mut Handle,
    ) -> c_int;
    fn km_current_fractures(solver: Handle, out: *mut Handle) -> c_int;
    fn km_solve(
        solver: Handle,
        right: *const f64,
        solution: *mut f64,
        tolerance: f64,
        most: c_int,
        iterations: *mut c_int,
        reason: *mut c_int,
        broke: *mut c_int,
        residual: *mut f64,
    ) -> c_int;
    fn km_precondition(solver: Handle, right: *const f64, out: *mut f64) -> c_int;
    fn km_smooth(solver: Handle, right: *const f64, out: *mut f64) -> c_int;
    fn km_free(solver: Handle) -> c_int;
    fn km_counts(counts: *mut f64) -> c_int;
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

    /// Writes the records of `size` bytes of all ranks one behind the other, rank `r` giving
    /// `counts[r]`.
    ///
    /// # Errors
    /// Those of MPI.
    ///
    /// # Panics
    /// If `own` or `all` has not the length that the counts say.
    pub fn gather_records(
        &self,
        size: usize,
        own: &[u8],
        counts: &[usize],
        all: &mut [u8],
    ) -> Result<(), PetscFailure> {
        self.here();
        assert_eq!(counts.len(), self.ranks, "one length a rank");
        assert_eq!(own.len(), size * counts[self.rank], "own length");
        assert_eq!(all.len(), size * counts.iter().sum::<usize>(), "length");
        let counts: Vec<c_int> = counts.iter().map(|&count| count as c_int).collect();
        let (from, to) = (own.as_ptr().cast(), all.as_mut_ptr().cast());
        // SAFETY: PETSc runs on this thread; the records are plain numbers of `size` bytes, and
        // both arrays have the lengths that `counts` says.
        done(unsafe { km_gather_records(size as c_int, from, counts.as_ptr(), to) })
    }

    /// What was counted on this rank so far.
    ///
    /// # Errors
    /// Those of PETSc.
    pub fn traffic(&self) -> Result<Traffic, PetscFailure> {
        self.here();
        let mut counts = [0.0; 6];
        // SAFETY: PETSc runs on this thread; the shim writes six numbers.
        done(unsafe { km_counts(counts.as_mut_ptr()) })?;
        let [iterations, exchanges, messages, bytes, reductions, levels] = counts;
        Ok(Traffic {
            iterations,
            exchanges,
            messages,
            bytes,
            reductions,
            levels,
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
    pointer: Handle,
    shape: EntryShape,
    world: Arc<World>,
}

// SAFETY: the pointer is used on the thread of its world only, which every use checks.
unsafe impl Send for Matrix {}
// SAFETY: as above.
unsafe impl Sync for Matrix {}

impl Matrix {
    /// A matrix of entries of this shape, yet without them, with the numbers of entries in each row
    /// of this rank: in its own `columns`, and in those of others.
    ///
    /// # Errors
    /// Those of PETSc.
    ///
    /// # Panics
    /// If there are not both numbers of each row.
    pub(crate) fn allocated(
        world: &Arc<World>,
        shape: EntryShape,
        columns: usize,
        [own, others]: [&[i32]; 2],
    ) -> Result<Self, PetscFailure> {
        world.here();
        assert_eq!(own.len(), others.len(), "both numbers of each row");
        let mut matrix = Self {
            pointer: null_mut(),
            shape,
            world: Arc::clone(world),
        };
        let (rows, columns) = (own.len() as i64, columns as i64);
        let [m, l, block] = [shape.lines, shape.numbers, shape.block].map(|size| size as c_int);
        let (own, others) = (own.as_ptr(), others.as_ptr());
        let out = &mut matrix.pointer;
        // SAFETY: PETSc runs on this thread; both arrays have one number a row.
        done(unsafe { km_matrix(rows, columns, m, l, block, own, others, out) })?;
        Ok(matrix)
    }

    /// Sets entries of a row: columns, ascending, and all numbers line by line.
    ///
    /// # Errors
    /// Those of PETSc.
    ///
    /// # Panics
    /// If there are more than there is room for, or not as many numbers.
    pub(crate) fn set_row(
        &self,
        row: i64,
        columns: &[i64],
        lines: &[f64],
    ) -> Result<(), PetscFailure> {
        self.world.here();
        let [m, l, block] = [self.shape.lines, self.shape.numbers, self.shape.block];
        let count = checked(columns, lines, m * l);
        let (down, across) = ((m / block) as c_int, (l / block) as c_int);
        let (columns, lines) = (columns.as_ptr(), lines.as_ptr());
        // SAFETY: PETSc runs on this thread, the matrix lives, and both arrays were checked.
        done(unsafe { km_matrix_row(self.pointer, row, down, across, count, columns, lines) })
    }

    /// Ends the setting of rows on all ranks.
    ///
    /// # Errors
    /// Those of PETSc.
    pub(crate) fn end(&self) -> Result<(), PetscFailure> {
        self.world.here();
        // SAFETY: PETSc runs on this thread, and the matrix lives.
        done(unsafe { km_matrix_end(self.pointer) })
    }

    /// Hands it over.
    fn into_pointer(mut self) -> Handle {
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

/// Conjugate gradients with multigrid.
#[derive(Debug)]
pub struct Solver {
    pointer: Handle,
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
    pub fn new(
        world: &Arc<World>,
        rows: usize,
        parts: SolverParts<Matrix>,
    ) -> Result<Self, PetscFailure> {
        world.here();
        let (levels, bounds) = (parts.matrices.len(), &parts.largest_eigenvalues);
        assert_eq!(parts.prolongators.len(), levels, "a prolongator a level");
        assert!(bounds.len() > levels, "one bound a level");
        let pointers = |list: Vec<Matrix>| list.into_iter().map(Matrix::into_pointer).collect();
        let prolongators: Vec<Handle> = pointers(parts.prolongators);
        let matrices: Vec<Handle> = pointers(parts.matrices);
        let coarsest = parts.coarsest.map_or(null_mut(), Matrix::into_pointer);
        let mut solver = Self {
            pointer: null_mut(),
            rows,
            world: Arc::clone(world),
        };
        // SAFETY: PETSc runs on this thread; the shim counts itself among the holders of the rock,
        // and takes the others over, whose pointers nobody else has. It reads as many of them as
        // there are levels, and a bound more.
        done(unsafe {
            km_solver(
                parts.rock.pointer,
                parts.fractures.into_pointer(),
                parts.inverse.into_pointer(),
                levels as c_int,
                prolongators.as_ptr(),
                matrices.as_ptr(),
                coarsest,
                bounds.as_ptr(),
                c_int::from(parts.is_small),
                &mut solver.pointer,
            )
        })?;
        Ok(solver)
    }

    /// Changes rows of what the fractures have in the tangent, given by their global numbers and
    /// all their blocks, and lets the levels be as they are. All ranks must call it.
    ///
    /// # Errors
    /// Those of PETSc.
    pub fn update(
        &mut self,
        mut rows: impl Iterator<Item = (i64, Vec<(i64, [[f64; 3]; 3])>)>,
    ) -> Result<(), PetscFailure> {
        self.world.here();
        let mut pointer = null_mut();
        // SAFETY: PETSc runs on this thread, and the solver lives.
        done(unsafe { km_current_fractures(self.pointer, &mut pointer) })?;
        let current = Matrix {
            pointer,
            shape: EntryShape::square(3),
            world: Arc::clone(&self.world),
        };
        let done = rows.try_for_each(|(row, mut blocks)| {
            in_lines(&mut blocks, |at, lines| current.set_row(row, at, lines))
        });
        let done = done.and_then(|()| current.end());
        // The solver keeps it.
        current.into_pointer();
        done
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

    /// What a part of the preconditioner makes of the entries of this rank.
    ///
    /// # Errors
    /// Those of PETSc.
    ///
    /// # Panics
    /// If `right` has not one entry a row of this rank.
    pub fn apply(
        &mut self,
        part: Preconditioner,
        right: &[[f64; 3]],
    ) -> Result<Vec<[f64; 3]>, PetscFailure> {
        self.check(right);
        let mut out = vec![[0.0; 3]; self.rows];
        let (from, to) = (right.as_ptr().cast(), out.as_mut_ptr().cast());
        let map = match part {
            Preconditioner::Cycle => km_precondition,
            Preconditioner::Clusters => km_smooth,
        };
        // SAFETY: PETSc runs on this thread, the solver lives; both vectors have its length.
        done(unsafe { map(self.pointer, from, to) })?;
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
