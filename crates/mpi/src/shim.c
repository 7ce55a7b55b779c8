/* All that the program needs of PETSc and MPI, in types that every ABI has alike: int, int64_t,
   double, pointers. No MPI_Comm, PetscInt or enum crosses the border, so Open MPI, MPICH, 32 and
   64 bit indices look the same from the other side. Every function but those that say otherwise
   returns an error code, 0 if all went well, and is called by all ranks. */
#define _POSIX_C_SOURCE 200809L
#include <petscksp.h>
#include <petscmat.h>
#include <limits.h>
#include <stdint.h>
#include <stdlib.h>
#include <time.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif

/* Lower end of what a smoother damps, as a share of the upper one; the levels below do the rest. */
#define LOWER_END 0.1

/* Most blocks of a row that are given at once. */
#define MOST_AT_ONCE 256
/* Most square blocks of an entry, down or across. */
#define MOST_BLOCKS 2

/* A group of its own for what must not meet other messages: the arrival of all ranks at the end. */
static MPI_Comm at_the_end = MPI_COMM_NULL;

int km_start(void) {
  /* No file that lies about shall change results; PETSC_OPTIONS may. */
  static char name[] = "kluft-mpi", skip[] = "-skip_petscrc";
  char *list[] = {name, skip, NULL}, **arguments = list;
  int count = 2;
#ifdef __GLIBC__
  /* Arrays of levels come and go: in maps of their own they leave no holes. SuperLU_DIST, which PETSc
     may bring along, forbids such maps to the whole process, and keeps what is freed. */
  mallopt(M_MMAP_MAX, 1 << 16);
  mallopt(M_MMAP_THRESHOLD, 1 << 20);
  mallopt(M_TRIM_THRESHOLD, 1 << 20);
#endif
  PetscCall(PetscInitialize(&count, &arguments, NULL, NULL));
  PetscCall(PetscPopSignalHandler());
  PetscCall(PetscPushErrorHandler(PetscReturnErrorHandler, NULL));
  PetscCall(PetscLogDefaultBegin());
  return MPI_Comm_dup(PETSC_COMM_WORLD, &at_the_end) ? PETSC_ERR_MPI : 0;
}
int km_end(void) {
  if (MPI_Comm_free(&at_the_end)) return PETSC_ERR_MPI;
  return PetscFinalize();
}
/* Ends all ranks. Does not return; called by one rank. */
void km_abort(int code) { MPI_Abort(MPI_COMM_WORLD, code); }
/* Not error codes, but the numbers; called by any rank. */
int km_rank(void) { int r = 0; MPI_Comm_rank(PETSC_COMM_WORLD, &r); return r; }
int km_ranks(void) { int s = 1; MPI_Comm_size(PETSC_COMM_WORLD, &s); return s; }
int km_on_machine(int *count) {
  MPI_Comm machine;
  if (MPI_Comm_split_type(PETSC_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &machine)) return PETSC_ERR_MPI;
  if (MPI_Comm_size(machine, count)) return PETSC_ERR_MPI;
  return MPI_Comm_free(&machine) ? PETSC_ERR_MPI : 0;
}
/* Whether all ranks come here within a time; called by each once at its end. */
int km_all_arrive(double seconds, int *arrived) {
  MPI_Request request;
  struct timespec pause = {0, 5000000};
  double limit = MPI_Wtime() + seconds;
  if (MPI_Ibarrier(at_the_end, &request)) return PETSC_ERR_MPI;
  do {
    if (MPI_Test(&request, arrived, MPI_STATUS_IGNORE)) return PETSC_ERR_MPI;
    if (!*arrived) nanosleep(&pause, NULL);
  } while (!*arrived && MPI_Wtime() < limit);
  return 0;
}

/* `count` numbers of each rank, one rank behind the other. */
int km_gather(const uint64_t *own, int count, uint64_t *all) {
  return MPI_Allgather(own, count, MPI_UINT64_T, all, count, MPI_UINT64_T, PETSC_COMM_WORLD) ? PETSC_ERR_MPI : 0;
}
/* `counts[r]` records of `size` bytes of rank r, one rank behind the other. */
int km_gather_records(int size, const void *own, const int *counts, void *all) {
  int rank = km_rank(), ranks = km_ranks(), *starts, failed;
  MPI_Datatype record;
  int64_t sum = 0;
  PetscCall(PetscMalloc1(ranks, &starts));
  for (int r = 0; r < ranks; r++) { starts[r] = (int)sum; sum += counts[r]; }
  if (sum > INT_MAX) return PETSC_ERR_ARG_OUTOFRANGE;
  MPI_Type_contiguous(size, MPI_BYTE, &record);
  MPI_Type_commit(&record);
  failed = MPI_Allgatherv(own, counts[rank], record, all, counts, starts, record, PETSC_COMM_WORLD);
  MPI_Type_free(&record);
  PetscCall(PetscFree(starts));
  return failed ? PETSC_ERR_MPI : 0;
}
/* A distributed matrix with as many rows and columns of this rank, in entries of m lines of l numbers,
   which it keeps in square blocks; PETSc has none that are not square, and unrolls products of small
   ones. Of each row the number of entries in columns of this rank, and in those of others. Then come
   the rows, then the end. */
int km_matrix(int64_t rows, int64_t columns, int m, int l, int block, const int *own, const int *others, void **out) {
  Mat a;
  PetscInt *counts[2];
  int down = m / block, across = l / block;
  PetscCall(MatCreate(PETSC_COMM_WORLD, &a));
  *out = a;
  PetscCall(MatSetSizes(a, m * rows, l * columns, PETSC_DETERMINE, PETSC_DETERMINE));
  PetscCall(MatSetBlockSizes(a, block, block));
  PetscCall(PetscMalloc2(down * rows + 1, &counts[0], down * rows + 1, &counts[1]));
  for (int64_t r = 0; r < down * rows; r++) { counts[0][r] = across * own[r / down]; counts[1][r] = across * others[r / down]; }
  PetscCall(MatSetType(a, MATBAIJ));
  PetscCall(MatSeqBAIJSetPreallocation(a, block, 0, counts[0]));
  PetscCall(MatMPIBAIJSetPreallocation(a, block, 0, counts[0], 0, counts[1]));
  PetscCall(PetscFree2(counts[0], counts[1]));
  return MatSetOption(a, MAT_NO_OFF_PROC_ENTRIES, PETSC_TRUE);
}
/* Entries of a row by its global number, each of so many blocks down and across: columns, and all
   numbers line by line; called by any rank. */
int km_matrix_row(void *matrix, int64_t row, int down, int across, int count, const int64_t *columns, const double *lines) {
  PetscInt at[MOST_BLOCKS], where[MOST_BLOCKS * MOST_AT_ONCE];
  for (int k = 0; k < down; k++) at[k] = (PetscInt)(down * row + k);
  for (int k = 0; k < across * count; k++) where[k] = (PetscInt)(across * columns[k / across] + k % across);
  return MatSetValuesBlocked(matrix, down, at, across * count, where, lines, INSERT_VALUES);
}
int km_matrix_end(void *matrix) {
  PetscCall(MatAssemblyBegin(matrix, MAT_FINAL_ASSEMBLY));
  return MatAssemblyEnd(matrix, MAT_FINAL_ASSEMBLY);
}
int km_free_matrix(void *matrix) {
  Mat a = matrix;
  return MatDestroy(&a);
}

/* What one rank exchanges in iterations, and their number. The first iteration of each solve is left
   out, because vectors are made in it. */
typedef struct { double iterations, exchanges, messages, bytes, reductions, levels; } Counts;
static Counts counted;

static int count(Counts *now) {
  PetscLogEvent scatter = -1;
  PetscEventPerfInfo info;
  PetscCall(PetscLogEventGetId("VecScatterBegin", &scatter));
  now->exchanges = 0;
  if (scatter >= 0) {
    PetscCall(PetscLogEventGetPerfInfo(PETSC_DETERMINE, scatter, &info));
    now->exchanges = info.count;
  }
  now->messages = petsc_isend_ct + petsc_send_ct;
  now->bytes = petsc_isend_len + petsc_send_len;
  now->reductions = petsc_allreduce_ct;
  return 0;
}
static PetscErrorCode count_iteration(KSP solver, PetscInt iteration, PetscReal residual, void *context) {
  static Counts last;
  Counts now;
  if (iteration == 0) return 0;
  PetscCall(count(&now));
  if (iteration > 1) {
    counted.iterations += 1;
    counted.exchanges += now.exchanges - last.exchanges;
    counted.messages += now.messages - last.messages;
    counted.bytes += now.bytes - last.bytes;
    counted.reductions += now.reductions - last.reductions;
  }
  last = now;
  return 0;
}

/* The tangent is the sum of the rock and of the fractures, which are few rows of it. */
typedef struct { Mat rock, fractures, sum; } Tangent;

static PetscErrorCode times(Mat sum, Vec x, Vec y) {
  Tangent *t;
  PetscCall(MatShellGetContext(sum, &t));
  PetscCall(MatMult(t->rock, x, y));
  return MatMultAdd(t->fractures, x, y, y);
}
static int set_tangent(Tangent *t, Mat rock, Mat fractures) {
  PetscInt rows, columns;
  t->rock = rock; t->fractures = fractures;
  PetscCall(PetscObjectReference((PetscObject)rock));
  PetscCall(MatGetLocalSize(rock, &rows, &columns));
  PetscCall(MatCreateShell(PETSC_COMM_WORLD, rows, columns, PETSC_DETERMINE, PETSC_DETERMINE, t, &t->sum));
  return MatShellSetOperation(t->sum, MATOP_MULT, (void (*)(void))times);
}
static int free_tangent(Tangent *t) {
  PetscCall(MatDestroy(&t->sum));
  PetscCall(MatDestroy(&t->fractures));
  return MatDestroy(&t->rock);
}

/* `built` is what the levels were made of; `current`, if there is one, what is solved with.
   Prolongators and matrices of `count` levels below, the largest first, and the inverse of the last
   one. */
typedef struct {
  KSP solver;
  Tangent built, current;
  Mat inverse, *prolongators, *matrices, coarsest;
  int count;
  Vec right, solution;
} Solver;

/* One solve of the whole by each rank, for what is too small to be coarsened. */
static int set_redundant(Solver *s, PC pc) {
  Mat whole;
  PetscCall(MatDuplicate(s->built.rock, MAT_COPY_VALUES, &whole));
  PetscCall(MatAXPY(whole, 1.0, s->built.fractures, SUBSET_NONZERO_PATTERN));
  PetscCall(MatConvert(whole, MATAIJ, MAT_INPLACE_MATRIX, &whole));
  PetscCall(KSPSetOperators(s->solver, s->built.sum, whole));
  PetscCall(MatDestroy(&whole));
  return PCSetType(pc, PCREDUNDANT);
}

/* Chebyshev of degree two for a spectrum that ends at `largest`. */
static int set_smoother(KSP smoother, PCType type, Mat matrix, Mat preconditioner, double largest) {
  PC pc;
  PetscCall(KSPSetType(smoother, KSPCHEBYSHEV));
  PetscCall(KSPChebyshevSetEigenvalues(smoother, largest, LOWER_END * largest));
  PetscCall(KSPSetTolerances(smoother, PETSC_DEFAULT, PETSC_DEFAULT, PETSC_DEFAULT, 2));
  PetscCall(KSPSetConvergenceTest(smoother, KSPConvergedSkip, NULL, NULL));
  PetscCall(KSPSetNormType(smoother, KSP_NORM_NONE));
  PetscCall(KSPSetOperators(smoother, matrix, preconditioner));
  PetscCall(KSPGetPC(smoother, &pc));
  return PCSetType(pc, type);
}

static int set_levels(Solver *s, PC pc, const double *largest) {
  KSP smoother, coarsest;
  PC inverse;
  PetscCall(PCSetType(pc, PCMG));
  PetscCall(PCMGSetLevels(pc, s->count + 1, NULL));
  PetscCall(PCMGSetGalerkin(pc, PC_MG_GALERKIN_NONE));
  for (int below = 0; below < s->count; below++) PetscCall(PCMGSetInterpolation(pc, s->count - below, s->prolongators[below]));
  PetscCall(PCMGGetSmoother(pc, s->count, &smoother));
  PetscCall(set_smoother(smoother, PCMAT, s->built.sum, s->inverse, largest[0]));
  for (int at = 1; at < s->count; at++) {
    Mat matrix = s->matrices[at - 1];
    PetscCall(PCMGGetSmoother(pc, s->count - at, &smoother));
    PetscCall(set_smoother(smoother, PCNONE, matrix, matrix, largest[at]));
  }
  PetscCall(PCMGGetCoarseSolve(pc, &coarsest));
  if (!s->coarsest) return set_smoother(coarsest, PCNONE, s->matrices[s->count - 1], s->matrices[s->count - 1], largest[s->count]);
  PetscCall(KSPSetType(coarsest, KSPPREONLY));
  PetscCall(KSPSetOperators(coarsest, s->matrices[s->count - 1], s->coarsest));
  PetscCall(KSPGetPC(coarsest, &inverse));
  return PCSetType(inverse, PCMAT);
}

/* Conjugate gradients; on the finest level Chebyshev on the inverse diagonal blocks, on `count`
   levels below Chebyshev on matrices whose diagonal is the identity, on the last one its inverse, if
   there is one. `largest` bounds the spectra of all levels, the finest first. Without a level below:
   `small` systems are solved by each rank as a whole, others smoothed only. Takes the matrices over,
   also upon an error, but for the rock, which it shares. */
int km_solver(void *rock, void *fractures, void *inverse, int count, void *const *prolongators, void *const *matrices, void *coarsest, const double *largest, int is_small, void **out) {
  Solver *s = calloc(1, sizeof *s);
  PC pc;
  if (!s) return PETSC_ERR_MEM;
  s->inverse = inverse; s->coarsest = coarsest;
  *out = s;
  counted.levels = count + 1;
  PetscCall(PetscMalloc2(count + 1, &s->prolongators, count + 1, &s->matrices));
  for (s->count = 0; s->count < count; s->count++) {
    s->prolongators[s->count] = prolongators[s->count];
    s->matrices[s->count] = matrices[s->count];
  }
  PetscCall(set_tangent(&s->built, rock, fractures));
  PetscCall(MatCreateVecs(rock, &s->solution, &s->right));
  PetscCall(KSPCreate(PETSC_COMM_WORLD, &s->solver));
  PetscCall(KSPSetOptionsPrefix(s->solver, "kluft_"));
  PetscCall(KSPSetType(s->solver, KSPCG));
  PetscCall(KSPSetNormType(s->solver, KSP_NORM_UNPRECONDITIONED));
  PetscCall(KSPSetOperators(s->solver, s->built.sum, s->built.sum));
  PetscCall(KSPGetPC(s->solver, &pc));
  if (count) {
    PetscCall(set_levels(s, pc, largest));
  } else if (is_small) {
    PetscCall(set_redundant(s, pc));
  } else {
    PetscCall(KSPSetOperators(s->solver, s->built.sum, s->inverse));
    PetscCall(PCSetType(pc, PCMAT));
  }
  PetscCall(KSPMonitorSet(s->solver, count_iteration, NULL, NULL));
  PetscCall(KSPSetFromOptions(s->solver));
  PetscCall(KSPSetUp(s->solver));
  return 0;
}

/* What the fractures have in the tangent, which may change then; what the levels were made of stays
   as it is, because the finest one is smoothed with it. The solver keeps what it hands out. */
int km_current_fractures(void *solver, void **out) {
  Solver *s = solver;
  Mat levels, fractures;
  if (!s->current.sum) {
    PetscCall(MatDuplicate(s->built.fractures, MAT_COPY_VALUES, &fractures));
    PetscCall(set_tangent(&s->current, s->built.rock, fractures));
    PetscCall(KSPGetOperators(s->solver, NULL, &levels));
    PetscCall(KSPSetReusePreconditioner(s->solver, PETSC_TRUE));
    PetscCall(KSPSetOperators(s->solver, s->current.sum, levels));
  }
  *out = s->current.fractures;
  return 0;
}

static int put(Vec to, const double *from) {
  PetscInt n;
  PetscScalar *v;
  PetscCall(VecGetLocalSize(to, &n));
  PetscCall(VecGetArrayWrite(to, &v));
  for (PetscInt k = 0; k < n; k++) v[k] = from[k];
  return VecRestoreArrayWrite(to, &v);
}
static int take(Vec from, double *to) {
  PetscInt n;
  const PetscScalar *v;
  PetscCall(VecGetLocalSize(from, &n));
  PetscCall(VecGetArrayRead(from, &v));
  for (PetscInt k = 0; k < n; k++) to[k] = v[k];
  return VecRestoreArrayRead(from, &v);
}

/* `reason` is PETSc's, positive if it converged; `broke` tells that a matrix or the preconditioner
   is not positive definite; `residual` is a share of the right-hand side. */
int km_solve(void *solver, const double *right, double *solution, double tolerance, int most, int *iterations, int *reason, int *broke, double *residual) {
  Solver *s = solver;
  PetscInt n;
  KSPConvergedReason why;
  PetscReal size;
  PetscCall(put(s->right, right));
  PetscCall(KSPSetTolerances(s->solver, tolerance, 0.0, PETSC_MAX_REAL, most));
  PetscCall(KSPSolve(s->solver, s->right, s->solution));
  PetscCall(KSPGetIterationNumber(s->solver, &n));
  PetscCall(KSPGetConvergedReason(s->solver, &why));
  PetscCall(KSPGetResidualNorm(s->solver, residual));
  PetscCall(VecNorm(s->right, NORM_2, &size));
  if (size > 0) *residual /= size;
  *iterations = (int)n; *reason = (int)why;
  *broke = why == KSP_DIVERGED_INDEFINITE_PC || why == KSP_DIVERGED_INDEFINITE_MAT || why == KSP_DIVERGED_BREAKDOWN;
  return take(s->solution, solution);
}

/* One cycle. */
int km_precondition(void *solver, const double *right, double *solution) {
  Solver *s = solver;
  PC pc;
  PetscCall(KSPGetPC(s->solver, &pc));
  PetscCall(put(s->right, right));
  PetscCall(PCApply(pc, s->right, s->solution));
  return take(s->solution, solution);
}
/* The inverse diagonal blocks alone. */
int km_smooth(void *solver, const double *right, double *solution) {
  Solver *s = solver;
  PetscCall(put(s->right, right));
  PetscCall(MatMult(s->inverse, s->right, s->solution));
  return take(s->solution, solution);
}

int km_free(void *solver) {
  Solver *s = solver;
  PetscCall(KSPDestroy(&s->solver));
  PetscCall(free_tangent(&s->built));
  PetscCall(free_tangent(&s->current));
  PetscCall(MatDestroy(&s->inverse));
  for (int at = 0; at < s->count; at++) {
    PetscCall(MatDestroy(&s->prolongators[at]));
    PetscCall(MatDestroy(&s->matrices[at]));
  }
  PetscCall(PetscFree2(s->prolongators, s->matrices));
  PetscCall(MatDestroy(&s->coarsest));
  PetscCall(VecDestroy(&s->right));
  PetscCall(VecDestroy(&s->solution));
  free(s);
  return 0;
}

/* What was counted of this rank: iterations, and in them halo exchanges, messages sent, their bytes,
   and reductions; then the levels of the last solver. Called by any rank. */
int km_counts(double *counts) {
  const double all[] = {counted.iterations, counted.exchanges, counted.messages, counted.bytes, counted.reductions, counted.levels};
  for (int k = 0; k < 6; k++) counts[k] = all[k];
  return 0;
}
