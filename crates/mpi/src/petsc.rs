//! PETSc and MPI behind safe types: the only `unsafe` of the project.
//!
//! What every block relies on: a [`World`] exists exactly once a process, from the start of PETSc
//! to its end; everything else holds one, so PETSc runs as long as anything calls it. Calls come
//! from the thread that started it, which [`World::here`] checks: so the types may be sent to and
//! shared with other threads, where they do nothing but panic. Lengths of arrays are checked before
//! a pointer is handed over, and the shim keeps none of them; of maps it keeps those of a solver,
//! which live as long as that.
#![allow(unsafe_code)]

use std::ffi::{c_int, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::ptr::null_mut;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::ThreadId;
use std::time::Duration;

use crate::lines::checked;
use crate::parts::{LocalFunction, LocalMap, MappedMatrix, SolverParts};

pub use crate::answers::{PetscFailure, Solved, Traffic};

/// What the shim makes.
type Handle = *mut c_void;
/// Calls a [`LocalMap`] of the shim.
type Callback = unsafe extern "C" fn(Handle, *const f64, *const f64, *mut f64);

unsafe extern "C" {
    fn km_start(map: Callback) -> c_int;
    fn km_end() -> c_int;
    fn km_abort(code: c_int);
    fn km_rank() -> c_int;
    fn km_ranks() -> c_int;
    fn km_on_machine(count: *mut c_int) -> c_int;
    fn km_all_arrive(seconds: f64, arrived: *mut c_int) -> c_int;
    fn km_gather_records(
        size: c_int,
        own: *const c_void,
        counts: *const c_int,
        all: Handle,
    ) -> c_int;
    fn km_matrix(
        rows: i64,
        block: c_int,
        own: *const c_int,
        others: *const c_int,
        out: *mut Handle,
    ) -> c_int;
    fn km_matrix_row(
        matrix: Handle,
        row: i64,
        count: c_int,
        columns: *const i64,
        lines: *const f64,
    ) -> c_int;
    fn km_matrix_end(matrix: Handle) -> c_int;
    fn km_free_matrix(matrix: Handle) -> c_int;
    fn km_product(
        rows: i64,
        columns: i64,
        block: c_int,
        count: c_int,
        ghosts: *const i64,
        map: Handle,
        transposed: Handle,
        out: *mut Handle,
    ) -> c_int;
    fn km_solver(
        singles: *const Handle,
        count: c_int,
        prolongators: *const Handle,
        matrices: *const Handle,
        largest: *const f64,
        out: *mut Handle,
    ) -> c_int;
    fn km_solve(
        solver: Handle,
        map: Handle,
        right: *const f64,
        solution: *mut f64,
        tolerance: f64,
        most: c_int,
        report: *mut f64,
    ) -> c_int;
    fn km_precondition(solver: Handle, right: *const f64, out: *mut f64) -> c_int;
    fn km_free(solver: Handle) -> c_int;
    fn km_counts(counts: *mut f64) -> c_int;
}

/// An array of the shim, which may be nowhere if it is empty.
///
/// # Safety
/// As [`std::slice::from_raw_parts`] unless it is empty.
unsafe fn array<'a>(start: *const f64, length: usize) -> &'a [f64] {
    match length {
        0 => &[],
        // SAFETY: what the caller says.
        length => unsafe { std::slice::from_raw_parts(start, length) },
    }
}

/// Calls a map; one that panics gives no numbers, and whoever iterates with them ends.
///
/// # Safety
/// `map` points to a [`LocalMap`] that nobody else uses meanwhile, the others to arrays of its
/// lengths, `out` to one that nothing else shares.
unsafe extern "C" fn call_map(map: Handle, own: *const f64, ghosts: *const f64, out: *mut f64) {
    // SAFETY: what the caller says.
    let map = unsafe { &mut *map.cast::<LocalMap<'_>>() };
    if map.image == 0 {
        return;
    }
    // SAFETY: as above.
    let (own, ghosts) = unsafe { (array(own, map.own), array(ghosts, map.ghosts)) };
    // SAFETY: as above; it is not empty.
    let out = unsafe { std::slice::from_raw_parts_mut(out, map.image) };
    let called = catch_unwind(AssertUnwindSafe(|| (map.function)(own, ghosts, out)));
    if called.is_err() {
        out.fill(f64::NAN);
    }
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
        done(unsafe { km_start(call_map) })?;
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
        Ok(Traffic::from(counts))
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

/// A distributed square matrix.
#[derive(Debug)]
pub struct Matrix {
    pointer: Handle,
    world: Arc<World>,
}

impl Matrix {
    fn nowhere(world: &Arc<World>) -> Self {
        world.here();
        Self {
            pointer: null_mut(),
            world: Arc::clone(world),
        }
    }

    /// A matrix of blocks of this size, yet without them, with the numbers of blocks in each row of
    /// this rank: in its own columns, and in those of others.
    ///
    /// # Panics
    /// If there are not both numbers of each row.
    pub(crate) fn allocated(
        world: &Arc<World>,
        block: usize,
        [own, others]: [&[i32]; 2],
    ) -> Result<Self, PetscFailure> {
        assert_eq!(own.len(), others.len(), "both numbers of each row");
        let mut matrix = Self::nowhere(world);
        let (rows, block) = (own.len() as i64, block as c_int);
        let (own, others, out) = (own.as_ptr(), others.as_ptr(), &mut matrix.pointer);
        // SAFETY: PETSc runs on this thread; both arrays have one number a row.
        done(unsafe { km_matrix(rows, block, own, others, out) })?;
        Ok(matrix)
    }

    /// Sets blocks of a row: columns, ascending, and all numbers line by line.
    ///
    /// # Panics
    /// If there are more than there is room for, or not as many numbers.
    pub(crate) fn set_row<const N: usize>(
        &self,
        row: i64,
        columns: &[i64],
        lines: &[f64],
    ) -> Result<(), PetscFailure> {
        self.world.here();
        let count = checked(columns, lines, N * N);
        let (columns, lines) = (columns.as_ptr(), lines.as_ptr());
        // SAFETY: PETSc runs on this thread, the matrix lives, and both arrays were checked.
        done(unsafe { km_matrix_row(self.pointer, row, count, columns, lines) })
    }

    /// Ends the setting of rows on all ranks.
    pub(crate) fn end(&self) -> Result<(), PetscFailure> {
        self.world.here();
        // SAFETY: PETSc runs on this thread, and the matrix lives.
        done(unsafe { km_matrix_end(self.pointer) })
    }

    /// A matrix whose products these maps make.
    fn of_products(
        world: &Arc<World>,
        mapped: &MappedMatrix,
        [map, transposed]: [Handle; 2],
    ) -> Result<Self, PetscFailure> {
        let mut matrix = Self::nowhere(world);
        let (rows, columns) = (mapped.rows as i64, mapped.columns as i64);
        let (block, count) = (mapped.block as c_int, mapped.ghosts.len() as c_int);
        let (ghosts, out) = (mapped.ghosts.as_ptr(), &mut matrix.pointer);
        // SAFETY: PETSc runs on this thread, and the array has as many numbers.
        done(unsafe { km_product(rows, columns, block, count, ghosts, map, transposed, out) })?;
        Ok(matrix)
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
    /// The maps that the shim calls; made of boxes.
    maps: Vec<*mut LocalMap<'static>>,
    /// Numbers of this rank, and of its ghosts.
    sizes: [usize; 2],
    world: Arc<World>,
}

// SAFETY: the pointers are used on the thread of its world only, which every use checks.
unsafe impl Send for Solver {}
// SAFETY: as above.
unsafe impl Sync for Solver {}

impl Solver {
    /// Sets up a solver.
    ///
    /// # Errors
    /// Those of PETSc.
    ///
    /// # Panics
    /// If there are not as many parts as levels ask for.
    pub fn new(world: &Arc<World>, parts: SolverParts<Matrix>) -> Result<Self, PetscFailure> {
        world.here();
        let (levels, bounds) = (parts.prolongators.len(), &parts.largest_eigenvalues);
        assert_eq!(parts.matrices.len(), levels + 1, "a prolongator a level");
        assert_eq!(bounds.len(), levels + 1, "one bound a level");
        let mut solver = Self {
            pointer: null_mut(),
            maps: Vec::new(),
            sizes: [parts.system.rows, parts.system.ghost_numbers()],
            world: Arc::clone(world),
        };
        let [scale, unscale] = parts.scaling.map(|map| solver.keep(Some(map)));
        let system = solver.mapped(parts.system)?;
        let mut all = |list: Vec<MappedMatrix>| {
            let list = list.into_iter().map(|matrix| solver.mapped(matrix));
            list.collect::<Result<Vec<Matrix>, PetscFailure>>()
        };
        let (matrices, prolongators) = (all(parts.matrices)?, all(parts.prolongators)?);
        let pointers = |list: Vec<Matrix>| list.into_iter().map(Matrix::into_pointer).collect();
        let (matrices, prolongators): (Vec<Handle>, Vec<Handle>) =
            (pointers(matrices), pointers(prolongators));
        let last = [parts.coarsest, parts.whole];
        let [coarsest, whole] = last.map(|last| last.map_or(null_mut(), Matrix::into_pointer));
        let singles = [system.into_pointer(), scale, unscale, coarsest, whole];
        // SAFETY: PETSc runs on this thread; the shim takes over matrices whose pointers nobody
        // else has, and reads as many of them as there are levels. The maps live until it is freed.
        done(unsafe {
            km_solver(
                singles.as_ptr(),
                levels as c_int,
                prolongators.as_ptr(),
                matrices.as_ptr(),
                bounds.as_ptr(),
                &mut solver.pointer,
            )
        })?;
        Ok(solver)
    }

    fn mapped(&mut self, mut mapped: MappedMatrix) -> Result<Matrix, PetscFailure> {
        let maps = [mapped.product.take(), mapped.transposed.take()];
        let maps = maps.map(|map| self.keep(map));
        Matrix::of_products(&self.world, &mapped, maps)
    }

    /// Keeps a map where it is for as long as this solver lives.
    fn keep(&mut self, map: Option<LocalMap<'static>>) -> Handle {
        let Some(map) = map else {
            return null_mut();
        };
        let map = Box::into_raw(Box::new(map));
        self.maps.push(map);
        map.cast()
    }

    fn check(&self, right: &[[f64; 3]]) {
        self.world.here();
        assert_eq!(3 * right.len(), self.sizes[0], "one entry a row");
    }

    /// Solves for the rows of this rank, with the matrix whose products `product` makes.
    ///
    /// # Errors
    /// Those of PETSc.
    ///
    /// # Panics
    /// If `right` has not one entry a row of this rank.
    pub fn solve(
        &mut self,
        product: Box<LocalFunction<'_>>,
        right: &[[f64; 3]],
        tolerance: f64,
        most: usize,
    ) -> Result<(Vec<[f64; 3]>, Solved), PetscFailure> {
        self.check(right);
        let mut solution = vec![[0.0; 3]; right.len()];
        let mut map = LocalMap {
            own: self.sizes[0],
            ghosts: self.sizes[1],
            image: self.sizes[0],
            function: product,
        };
        let (map, most) = ((&raw mut map).cast(), most as c_int);
        let (from, to) = (right.as_ptr().cast(), solution.as_mut_ptr().cast());
        let mut report = [0.0; 4];
        let out = report.as_mut_ptr();
        // SAFETY: PETSc runs on this thread, the solver lives; both vectors have its length. The
        // shim forgets the map before it returns, and writes four numbers.
        done(unsafe { km_solve(self.pointer, map, from, to, tolerance, most, out) })?;
        Ok((solution, Solved::from(report)))
    }

    /// What the preconditioner makes of the entries of this rank.
    ///
    /// # Errors
    /// Those of PETSc.
    ///
    /// # Panics
    /// If `right` has not one entry a row of this rank.
    pub fn precondition(&mut self, right: &[[f64; 3]]) -> Result<Vec<[f64; 3]>, PetscFailure> {
        self.check(right);
        let mut out = vec![[0.0; 3]; right.len()];
        let (from, to) = (right.as_ptr().cast(), out.as_mut_ptr().cast());
        // SAFETY: PETSc runs on this thread, the solver lives; both vectors have its length.
        done(unsafe { km_precondition(self.pointer, from, to) })?;
        Ok(out)
    }
}

impl Drop for Solver {
    fn drop(&mut self) {
        if std::thread::current().id() != self.world.thread {
            return;
        }
        if !self.pointer.is_null() {
            // SAFETY: PETSc runs, and nobody else has the pointer.
            unsafe { km_free(self.pointer) };
        }
        for map in self.maps.drain(..) {
            // SAFETY: it was made of a box, and the shim that used it is gone.
            drop(unsafe { Box::from_raw(map) });
        }
    }
}
