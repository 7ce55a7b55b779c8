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

/* What the caller makes of the entries of this rank and those of its ghosts. */
typedef void (*Map)(void *map, const double *own, const double *ghosts, double *out);
static Map apply_map;

/* A group of its own for what must not meet other messages: the arrival of all ranks at the end. */
static MPI_Comm at_the_end = MPI_COMM_NULL;

/* `map` calls what the caller gives as maps. */
int km_start(Map map) {
  /* No file that lies about shall change results; PETSC_OPTIONS may. */
  static char name[] = "kluft-mpi", skip[] = "-skip_petscrc";
  char *list[] = {name, skip, NULL}, **arguments = list;
  int count = 2;
  apply_map = map;
#ifdef __GLIBC__
  /* Arrays of levels come and go: in maps of their own they leave no holes. SuperLU_DIST, which PETSc
     may bring along, forbids such maps to the whole process, and keeps what is freed. */
  mallopt(M_MMAP_MAX, 1 << 16);
  mallopt(M_MMAP_THRESHOLD, 1 << 21);
  mallopt(M_TRIM_THRESHOLD, 1 << 23);
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
/* A distributed square matrix with as many block rows of this rank. Of each row the number of blocks
   in columns of this rank, and in those of others. Then come the rows, then the end. */
int km_matrix(int64_t rows, int block, const int *own, const int *others, void **out) {
  Mat a;
  PetscInt *counts[2];
  PetscCall(MatCreate(PETSC_COMM_WORLD, &a));
  *out = a;
  PetscCall(MatSetSizes(a, block * rows, block * rows, PETSC_DETERMINE, PETSC_DETERMINE));
  PetscCall(MatSetBlockSizes(a, block, block));
  PetscCall(PetscMalloc2(rows + 1, &counts[0], rows + 1, &counts[1]));
  for (int64_t r = 0; r < rows; r++) { counts[0][r] = own[r]; counts[1][r] = others[r]; }
  PetscCall(MatSetType(a, MATBAIJ));
  PetscCall(MatSeqBAIJSetPreallocation(a, block, 0, counts[0]));
  PetscCall(MatMPIBAIJSetPreallocation(a, block, 0, counts[0], 0, counts[1]));
  PetscCall(PetscFree2(counts[0], counts[1]));
  return MatSetOption(a, MAT_NO_OFF_PROC_ENTRIES, PETSC_TRUE);
}
/* Blocks of a row by its global number: columns, and all numbers line by line; called by any rank. */
int km_matrix_row(void *matrix, int64_t row, int count, const int64_t *columns, const double *lines) {
  PetscInt at = (PetscInt)row, where[MOST_AT_ONCE];
  for (int k = 0; k < count; k++) where[k] = (PetscInt)columns[k];
  return MatSetValuesBlocked(matrix, 1, &at, count, where, lines, INSERT_VALUES);
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

/* A matrix whose products the caller makes, once its map is known; of the transposed one the caller
   makes what the rows of this rank give to the entries of this rank, and then to the ghosts. */
typedef struct { void *map, *transposed; VecScatter halo; Vec ghosts, both; } Product;

static PetscErrorCode multiply(Mat a, Vec x, Vec y) {
  Product *p;
  const PetscScalar *own, *ghosts;
  PetscScalar *out;
  PetscCall(MatShellGetContext(a, &p));
  PetscCall(VecScatterBegin(p->halo, x, p->ghosts, INSERT_VALUES, SCATTER_FORWARD));
  PetscCall(VecScatterEnd(p->halo, x, p->ghosts, INSERT_VALUES, SCATTER_FORWARD));
  PetscCall(VecGetArrayRead(x, &own));
  PetscCall(VecGetArrayRead(p->ghosts, &ghosts));
  PetscCall(VecGetArrayWrite(y, &out));
  apply_map(p->map, own, ghosts, out);
  PetscCall(VecRestoreArrayWrite(y, &out));
  PetscCall(VecRestoreArrayRead(p->ghosts, &ghosts));
  return VecRestoreArrayRead(x, &own);
}
static PetscErrorCode multiply_transposed(Mat a, Vec x, Vec y) {
  Product *p;
  const PetscScalar *own;
  PetscScalar *both, *out, *ghosts;
  PetscInt rows, count;
  PetscCall(MatShellGetContext(a, &p));
  PetscCall(VecGetLocalSize(y, &rows));
  PetscCall(VecGetLocalSize(p->ghosts, &count));
  PetscCall(VecGetArrayRead(x, &own));
  PetscCall(VecGetArrayWrite(p->both, &both));
  apply_map(p->transposed, own, NULL, both);
  PetscCall(VecRestoreArrayRead(x, &own));
  PetscCall(VecGetArrayWrite(y, &out));
  PetscCall(VecGetArrayWrite(p->ghosts, &ghosts));
  for (PetscInt k = 0; k < rows; k++) out[k] = both[k];
  for (PetscInt k = 0; k < count; k++) ghosts[k] = both[rows + k];
  PetscCall(VecRestoreArrayWrite(p->ghosts, &ghosts));
  PetscCall(VecRestoreArrayWrite(y, &out));
  PetscCall(VecRestoreArrayWrite(p->both, &both));
  PetscCall(VecScatterBegin(p->halo, p->ghosts, y, ADD_VALUES, SCATTER_REVERSE));
  return VecScatterEnd(p->halo, p->ghosts, y, ADD_VALUES, SCATTER_REVERSE);
}
static PetscErrorCode free_product(Mat a) {
  Product *p;
  PetscCall(MatShellGetContext(a, &p));
  PetscCall(VecScatterDestroy(&p->halo));
  PetscCall(VecDestroy(&p->ghosts));
  PetscCall(VecDestroy(&p->both));
  free(p);
  return 0;
}
/* A matrix of as many rows and columns of this rank, and the blocks of ghosts by their global
   numbers. */
int km_product(int64_t rows, int64_t columns, int block, int count, const int64_t *ghosts, void *map, void *transposed, void **out) {
  Product *p = calloc(1, sizeof *p);
  PetscInt *at;
  Vec x;
  IS from;
  Mat a;
  if (!p) return PETSC_ERR_MEM;
  p->map = map; p->transposed = transposed;
  PetscCall(MatCreateShell(PETSC_COMM_WORLD, (PetscInt)rows, (PetscInt)columns, PETSC_DETERMINE, PETSC_DETERMINE, p, &a));
  *out = a;
  PetscCall(MatShellSetOperation(a, MATOP_MULT, (void (*)(void))multiply));
  PetscCall(MatShellSetOperation(a, MATOP_MULT_TRANSPOSE, (void (*)(void))multiply_transposed));
  PetscCall(MatShellSetOperation(a, MATOP_DESTROY, (void (*)(void))free_product));
  PetscCall(PetscMalloc1(count + 1, &at));
  for (int k = 0; k < count; k++) at[k] = (PetscInt)ghosts[k];
  PetscCall(ISCreateBlock(PETSC_COMM_SELF, block, count, at, PETSC_COPY_VALUES, &from));
  PetscCall(PetscFree(at));
  PetscCall(VecCreateSeq(PETSC_COMM_SELF, block * count, &p->ghosts));
  PetscCall(VecCreateSeq(PETSC_COMM_SELF, transposed ? (PetscInt)columns + block * count : 0, &p->both));
  PetscCall(MatCreateVecs(a, &x, NULL));
  PetscCall(VecScatterCreate(x, from, p->ghosts, NULL, &p->halo));
  PetscCall(VecDestroy(&x));
  return ISDestroy(&from);
}

/* The matrix that is solved with, whose map each solve gives; the way to scaled unknowns and back,
   and a cycle in them, if there is one: `count` prolongators, the largest first, and a matrix more,
   or the whole in entries. */
typedef struct {
  KSP solver;
  Mat system, *prolongators, *matrices, coarsest, whole;
  PC cycle;
  int count;
  void *scale, *unscale;
  Vec right, solution, scaled, cycled;
} Solver;

static int mapped(void *map, Vec from, Vec to) {
  const PetscScalar *own;
  PetscScalar *out;
  PetscCall(VecGetArrayRead(from, &own));
  PetscCall(VecGetArrayWrite(to, &out));
  apply_map(map, own, NULL, out);
  PetscCall(VecRestoreArrayWrite(to, &out));
  return VecRestoreArrayRead(from, &own);
}
static PetscErrorCode precondition(PC pc, Vec x, Vec y) {
  Solver *s;
  PetscCall(PCShellGetContext(pc, &s));
  PetscCall(mapped(s->scale, x, s->scaled));
  if (!s->cycle) return mapped(s->unscale, s->scaled, y);
  PetscCall(PCApply(s->cycle, s->scaled, s->cycled));
  return mapped(s->unscale, s->cycled, y);
}

/* Chebyshev of degree two for a spectrum that ends at `largest`. */
static int set_smoother(KSP smoother, Mat matrix, double largest) {
  PC pc;
  PetscCall(KSPSetType(smoother, KSPCHEBYSHEV));
  PetscCall(KSPChebyshevSetEigenvalues(smoother, largest, LOWER_END * largest));
  PetscCall(KSPSetTolerances(smoother, PETSC_DEFAULT, PETSC_DEFAULT, PETSC_DEFAULT, 2));
  PetscCall(KSPSetConvergenceTest(smoother, KSPConvergedSkip, NULL, NULL));
  PetscCall(KSPSetNormType(smoother, KSP_NORM_NONE));
  PetscCall(KSPSetOperators(smoother, matrix, matrix));
  PetscCall(KSPGetPC(smoother, &pc));
  return PCSetType(pc, PCNONE);
}

static int set_levels(Solver *s, const double *largest) {
  KSP smoother, coarsest;
  PC inverse, pc = s->cycle;
  PetscCall(PCSetOperators(pc, s->matrices[0], s->matrices[0]));
  PetscCall(PCSetType(pc, PCMG));
  PetscCall(PCMGSetLevels(pc, s->count + 1, NULL));
  PetscCall(PCMGSetGalerkin(pc, PC_MG_GALERKIN_NONE));
  for (int below = 0; below < s->count; below++) PetscCall(PCMGSetInterpolation(pc, s->count - below, s->prolongators[below]));
  for (int at = 0; at < s->count; at++) {
    PetscCall(PCMGGetSmoother(pc, s->count - at, &smoother));
    PetscCall(set_smoother(smoother, s->matrices[at], largest[at]));
  }
  PetscCall(PCMGGetCoarseSolve(pc, &coarsest));
  if (!s->coarsest) return set_smoother(coarsest, s->matrices[s->count], largest[s->count]);
  PetscCall(KSPSetType(coarsest, KSPPREONLY));
  PetscCall(KSPSetOperators(coarsest, s->matrices[s->count], s->coarsest));
  PetscCall(KSPGetPC(coarsest, &inverse));
  return PCSetType(inverse, PCMAT);
}

static int set_cycle(Solver *s, const double *largest) {
  if (!s->count && !s->whole) return 0;
  PetscCall(PCCreate(PETSC_COMM_WORLD, &s->cycle));
  PetscCall(PCSetOptionsPrefix(s->cycle, "kluft_cycle_"));
  if (s->count) {
    PetscCall(set_levels(s, largest));
  } else {
    PetscCall(MatConvert(s->whole, MATAIJ, MAT_INPLACE_MATRIX, &s->whole));
    PetscCall(PCSetOperators(s->cycle, s->whole, s->whole));
    PetscCall(PCSetType(s->cycle, PCREDUNDANT));
  }
  PetscCall(PCSetFromOptions(s->cycle));
  return PCSetUp(s->cycle);
}

/* Conjugate gradients for `system`, preconditioned in scaled unknowns: by Chebyshev on `count` + 1
   levels, whose matrices have the identity as their diagonal, the finest first, on the last one by
   its inverse, if there is one; without prolongators by one solve of the `whole` by each rank, if it
   is there, or by the scaling alone. `largest` bounds the spectra of all levels. Single ones are
   `system`, the maps to scaled unknowns and back, the inverse and the whole. Takes the matrices over,
   also upon an error. */
int km_solver(void *const *singles, int count, void *const *prolongators, void *const *matrices, const double *largest, void **out) {
  Solver *s = calloc(1, sizeof *s);
  PC pc;
  if (!s) return PETSC_ERR_MEM;
  s->system = singles[0]; s->scale = singles[1]; s->unscale = singles[2]; s->coarsest = singles[3]; s->whole = singles[4];
  s->count = count;
  *out = s;
  counted.levels = count + 1;
  PetscCall(PetscMalloc2(count + 1, &s->prolongators, count + 1, &s->matrices));
  for (int at = 0; at <= count; at++) {
    s->prolongators[at] = at < count ? prolongators[at] : NULL;
    s->matrices[at] = matrices[at];
  }
  PetscCall(MatCreateVecs(s->system, &s->solution, &s->right));
  PetscCall(MatCreateVecs(s->system, &s->cycled, &s->scaled));
  PetscCall(set_cycle(s, largest));
  PetscCall(KSPCreate(PETSC_COMM_WORLD, &s->solver));
  PetscCall(KSPSetOptionsPrefix(s->solver, "kluft_"));
  PetscCall(KSPSetType(s->solver, KSPCG));
  PetscCall(KSPSetNormType(s->solver, KSP_NORM_UNPRECONDITIONED));
  PetscCall(KSPSetOperators(s->solver, s->system, s->system));
  PetscCall(KSPGetPC(s->solver, &pc));
  PetscCall(PCSetType(pc, PCSHELL));
  PetscCall(PCShellSetContext(pc, s));
  PetscCall(PCShellSetApply(pc, precondition));
  PetscCall(KSPMonitorSet(s->solver, count_iteration, NULL, NULL));
  PetscCall(KSPSetFromOptions(s->solver));
  return KSPSetUp(s->solver);
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

/* `map` is that of the matrix for this solve. Reports the iterations, whether it converged, whether a
   matrix or the preconditioner is not positive definite, and the residual as a share of the
   right-hand side. */
int km_solve(void *solver, void *map, const double *right, double *solution, double tolerance, int most, double *report) {
  Solver *s = solver;
  Product *p;
  PetscInt n;
  KSPConvergedReason why;
  PetscReal size, residual;
  int failed;
  PetscCall(put(s->right, right));
  PetscCall(KSPSetTolerances(s->solver, tolerance, 0.0, PETSC_MAX_REAL, most));
  PetscCall(MatShellGetContext(s->system, &p));
  p->map = map;
  failed = KSPSolve(s->solver, s->right, s->solution);
  p->map = NULL;
  if (failed) return failed;
  PetscCall(KSPGetIterationNumber(s->solver, &n));
  PetscCall(KSPGetConvergedReason(s->solver, &why));
  PetscCall(KSPGetResidualNorm(s->solver, &residual));
  PetscCall(VecNorm(s->right, NORM_2, &size));
  report[0] = (double)n;
  report[1] = why > 0;
  report[2] = why == KSP_DIVERGED_INDEFINITE_PC || why == KSP_DIVERGED_INDEFINITE_MAT || why == KSP_DIVERGED_BREAKDOWN;
  report[3] = size > 0 ? residual / size : residual;
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

int km_free(void *solver) {
  Solver *s = solver;
  PetscCall(KSPDestroy(&s->solver));
  PetscCall(PCDestroy(&s->cycle));
  for (int at = 0; at <= s->count; at++) {
    PetscCall(MatDestroy(&s->prolongators[at]));
    PetscCall(MatDestroy(&s->matrices[at]));
  }
  PetscCall(PetscFree2(s->prolongators, s->matrices));
  PetscCall(MatDestroy(&s->system));
  PetscCall(MatDestroy(&s->coarsest));
  PetscCall(MatDestroy(&s->whole));
  PetscCall(VecDestroy(&s->right));
  PetscCall(VecDestroy(&s->solution));
  PetscCall(VecDestroy(&s->scaled));
  PetscCall(VecDestroy(&s->cycled));
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
