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

/* A group of its own for what must not meet other messages: the arrival of all ranks at the end. */
static MPI_Comm at_the_end = MPI_COMM_NULL;

/* A default that PETSC_OPTIONS may replace. */
static int preset(const char *name, const char *value) {
  PetscBool set;
  PetscCall(PetscOptionsHasName(NULL, NULL, name, &set));
  if (!set) PetscCall(PetscOptionsSetValue(NULL, name, value));
  return 0;
}

int km_ranks(void);

int km_start(void) {
  /* No file that lies about shall change results; PETSC_OPTIONS may. */
  static char name[] = "kluft-mpi", skip[] = "-skip_petscrc";
  char *list[] = {name, skip, NULL}, **arguments = list;
  int count = 2;
  PetscCall(PetscInitialize(&count, &arguments, NULL, NULL));
  PetscCall(PetscPopSignalHandler());
  PetscCall(PetscPushErrorHandler(PetscReturnErrorHandler, NULL));
  PetscCall(PetscLogDefaultBegin());
  if (MPI_Comm_dup(PETSC_COMM_WORLD, &at_the_end)) return PETSC_ERR_MPI;
  /* Strong couplings only: see docs/design/mpi.md. */
  PetscCall(preset("-kluft_mg_coarse_pc_gamg_threshold", "0.02"));
  /* The usual triple product adds what other ranks send in the order in which it comes; one rank
     has no other. */
  return km_ranks() > 1 ? preset("-matptap_via", "allatonce") : 0;
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
/* `counts[r]` triples of rank r, one rank behind the other. */
int km_gather_triples(const double *own, const int *counts, double *all) {
  int rank = km_rank(), ranks = km_ranks(), *starts, failed;
  MPI_Datatype triple;
  int64_t sum = 0;
  PetscCall(PetscMalloc1(ranks, &starts));
  for (int r = 0; r < ranks; r++) { starts[r] = (int)sum; sum += counts[r]; }
  if (sum > INT_MAX) return PETSC_ERR_ARG_OUTOFRANGE;
  MPI_Type_contiguous(3, MPI_DOUBLE, &triple);
  MPI_Type_commit(&triple);
  failed = MPI_Allgatherv(own, counts[rank], triple, all, counts, starts, triple, PETSC_COMM_WORLD);
  MPI_Type_free(&triple);
  PetscCall(PetscFree(starts));
  return failed ? PETSC_ERR_MPI : 0;
}
/* Records of `size` bytes to each rank, and from each: first how many, then what. */
int km_exchange_counts(const int *out, int *in) {
  return MPI_Alltoall(out, 1, MPI_INT, in, 1, MPI_INT, PETSC_COMM_WORLD) ? PETSC_ERR_MPI : 0;
}
int km_exchange(int size, const int *out, const void *sent, const int *in, void *received) {
  int ranks = km_ranks(), *starts, failed;
  int64_t sums[2] = {0, 0};
  MPI_Datatype record;
  PetscCall(PetscMalloc1(2 * ranks, &starts));
  for (int r = 0; r < ranks; r++) {
    starts[r] = (int)sums[0]; sums[0] += out[r];
    starts[ranks + r] = (int)sums[1]; sums[1] += in[r];
  }
  if (sums[0] > INT_MAX || sums[1] > INT_MAX) return PETSC_ERR_ARG_OUTOFRANGE;
  MPI_Type_contiguous(size, MPI_BYTE, &record);
  MPI_Type_commit(&record);
  failed = MPI_Alltoallv(sent, out, starts, record, received, in, starts + ranks, record, PETSC_COMM_WORLD);
  MPI_Type_free(&record);
  PetscCall(PetscFree(starts));
  return failed ? PETSC_ERR_MPI : 0;
}

static int indices(const int64_t *from, size_t count, PetscInt **to) {
  PetscCall(PetscMalloc1(count + 1, to));
  for (size_t k = 0; k < count; k++) (*to)[k] = (PetscInt)from[k];
  return 0;
}

/* A distributed matrix of the rows of each rank, in blocks of m lines of l numbers, each block line
   by line; columns are global numbers of blocks. Square blocks of three stay blocks. */
int km_matrix(int64_t rows, int64_t columns, int m, int l, const int64_t *offset, const int64_t *column, const double *blocks, void **out) {
  Mat a;
  PetscInt *o, *c;
  PetscCall(MatCreate(PETSC_COMM_WORLD, &a));
  PetscCall(MatSetSizes(a, m * rows, l * columns, PETSC_DETERMINE, PETSC_DETERMINE));
  PetscCall(MatSetBlockSizes(a, m, l));
  if (m == 3 && l == 3) {
    PetscCall(MatSetType(a, MATBAIJ));
    PetscCall(indices(offset, rows + 1, &o));
    PetscCall(indices(column, offset[rows], &c));
    PetscCall(MatMPIBAIJSetPreallocationCSR(a, m, o, c, blocks));
    PetscCall(MatSeqBAIJSetPreallocationCSR(a, m, o, c, blocks));
    PetscCall(PetscFree(o));
    PetscCall(PetscFree(c));
  } else {
    size_t n = offset[rows] * m * l, at = 0;
    double *v;
    PetscCall(MatSetType(a, MATAIJ));
    PetscCall(PetscMalloc3(m * rows + 1, &o, n + 1, &c, n + 1, &v));
    for (int64_t r = 0; r < rows; r++)
      for (int i = 0; i < m; i++) {
        o[m * r + i] = at;
        for (int64_t k = offset[r]; k < offset[r + 1]; k++)
          for (int j = 0; j < l; j++) { c[at] = l * column[k] + j; v[at++] = blocks[(k * m + i) * l + j]; }
      }
    o[m * rows] = at;
    PetscCall(MatMPIAIJSetPreallocationCSR(a, o, c, v));
    PetscCall(MatSeqAIJSetPreallocationCSR(a, o, c, v));
    PetscCall(PetscFree3(o, c, v));
  }
  *out = a;
  return 0;
}
int km_free_matrix(void *matrix) {
  Mat a = matrix;
  return MatDestroy(&a);
}

/* What one rank exchanges in iterations, and their number. The first iteration of each solve is left
   out, because smoothers look for the bounds of their spectra in it. */
typedef struct { double iterations, exchanges, messages, bytes, reductions; } Counts;
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

/* `operator` is what the levels were made of; `current`, if any, what is solved with. */
typedef struct { KSP solver; Mat operator, current, inverse, prolongator, next; Vec right, solution; } Solver;

/* Motions of the next level that cost next to nothing, six numbers an unknown. */
static int set_near_null_space(Mat next, const double *modes) {
  Vec mode[6];
  PetscInt n;
  PetscScalar *v;
  PetscReal norm;
  MatNullSpace space;
  int kept = 0;
  for (int q = 0; q < 6; q++) {
    PetscCall(MatCreateVecs(next, &mode[kept], NULL));
    PetscCall(VecGetLocalSize(mode[kept], &n));
    PetscCall(VecGetArray(mode[kept], &v));
    for (PetscInt k = 0; k < n; k++) v[k] = modes[6 * k + q];
    PetscCall(VecRestoreArray(mode[kept], &v));
    PetscCall(VecNormalize(mode[kept], &norm));
    if (norm > 0) for (int twice = 0; twice < 2; twice++) for (int p = 0; p < kept; p++) {
      PetscScalar dot;
      PetscCall(VecDot(mode[kept], mode[p], &dot));
      PetscCall(VecAXPY(mode[kept], -dot, mode[p]));
    }
    PetscCall(VecNorm(mode[kept], NORM_2, &norm));
    if (norm > 1e-8) { PetscCall(VecNormalize(mode[kept], NULL)); kept++; }
    else PetscCall(VecDestroy(&mode[kept]));
  }
  PetscCall(MatNullSpaceCreate(PETSC_COMM_WORLD, PETSC_FALSE, kept, mode, &space));
  PetscCall(MatSetNearNullSpace(next, space));
  PetscCall(MatNullSpaceDestroy(&space));
  for (int q = 0; q < kept; q++) PetscCall(VecDestroy(&mode[q]));
  return 0;
}

/* One solve of the whole by each rank, for what is too small to be coarsened. */
static int set_redundant(Solver *s, PC pc) {
  Mat aij;
  PetscCall(MatConvert(s->operator, MATAIJ, MAT_INITIAL_MATRIX, &aij));
  PetscCall(KSPSetOperators(s->solver, s->operator, aij));
  PetscCall(MatDestroy(&aij));
  return PCSetType(pc, PCREDUNDANT);
}

/* `margin` widens the bounds of the spectra that PETSc estimates for the smoothers. */
static int set_two_levels(Solver *s, PC pc, double margin) {
  KSP smoother, coarse;
  PC smooth_pc, coarse_pc;
  char bounds[64];
  PetscCall(PetscSNPrintf(bounds, sizeof bounds, "0,0.1,0,%g", 1.1 * margin));
  PetscCall(PetscOptionsSetValue(NULL, "-kluft_mg_coarse_mg_levels_ksp_chebyshev_esteig", bounds));
  PetscCall(PCSetType(pc, PCMG));
  PetscCall(PCMGSetLevels(pc, 2, NULL));
  PetscCall(PCMGSetGalerkin(pc, PC_MG_GALERKIN_NONE));
  PetscCall(PCMGSetInterpolation(pc, 1, s->prolongator));
  PetscCall(PCMGGetSmoother(pc, 1, &smoother));
  PetscCall(KSPSetType(smoother, KSPCHEBYSHEV));
  PetscCall(KSPChebyshevEstEigSet(smoother, 0.0, 0.1, 0.0, 1.1 * margin));
  PetscCall(KSPSetTolerances(smoother, PETSC_DEFAULT, PETSC_DEFAULT, PETSC_DEFAULT, 2));
  PetscCall(KSPSetOperators(smoother, s->operator, s->inverse));
  PetscCall(KSPGetPC(smoother, &smooth_pc));
  PetscCall(PCSetType(smooth_pc, PCMAT));
  PetscCall(PCMGGetCoarseSolve(pc, &coarse));
  PetscCall(KSPSetType(coarse, KSPPREONLY));
  PetscCall(KSPSetOperators(coarse, s->next, s->next));
  PetscCall(KSPGetPC(coarse, &coarse_pc));
  return PCSetType(coarse_pc, PCGAMG);
}

/* Conjugate gradients; on the finest level Chebyshev on the inverse diagonal blocks and the given
   prolongator, below it GAMG with the given six modes of each node. Without a next level: `small`
   systems are solved by each rank as a whole, others smoothed only. Takes the matrices over, also
   upon an error. */
int km_solver(void *operator, void *inverse, void *prolongator, void *next, const double *modes, int is_small, double margin, void **out) {
  Solver *s = calloc(1, sizeof *s);
  PC pc;
  if (!s) return PETSC_ERR_MEM;
  s->operator = operator; s->inverse = inverse; s->prolongator = prolongator; s->next = next;
  *out = s;
  PetscCall(MatCreateVecs(s->operator, &s->solution, &s->right));
  PetscCall(KSPCreate(PETSC_COMM_WORLD, &s->solver));
  PetscCall(KSPSetOptionsPrefix(s->solver, "kluft_"));
  PetscCall(KSPSetType(s->solver, KSPCG));
  PetscCall(KSPSetNormType(s->solver, KSP_NORM_UNPRECONDITIONED));
  PetscCall(KSPSetOperators(s->solver, s->operator, s->operator));
  PetscCall(KSPGetPC(s->solver, &pc));
  if (next) {
    PetscCall(set_near_null_space(s->next, modes));
    PetscCall(set_two_levels(s, pc, margin));
  } else if (is_small) {
    PetscCall(set_redundant(s, pc));
  } else {
    PetscCall(KSPSetOperators(s->solver, s->operator, s->inverse));
    PetscCall(PCSetType(pc, PCMAT));
  }
  PetscCall(KSPMonitorSet(s->solver, count_iteration, NULL, NULL));
  PetscCall(KSPSetFromOptions(s->solver));
  PetscCall(KSPSetUp(s->solver));
  return 0;
}

/* Solves with another operator, on the levels as they are; takes it over. */
int km_set_operator(void *solver, void *operator) {
  Solver *s = solver;
  Mat former = s->current, levels;
  s->current = operator;
  PetscCall(KSPGetOperators(s->solver, NULL, &levels));
  PetscCall(KSPSetReusePreconditioner(s->solver, PETSC_TRUE));
  PetscCall(KSPSetOperators(s->solver, s->current, levels));
  return MatDestroy(&former);
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
  PetscCall(MatDestroy(&s->operator));
  PetscCall(MatDestroy(&s->current));
  PetscCall(MatDestroy(&s->inverse));
  PetscCall(MatDestroy(&s->prolongator));
  PetscCall(MatDestroy(&s->next));
  PetscCall(VecDestroy(&s->right));
  PetscCall(VecDestroy(&s->solution));
  free(s);
  return 0;
}

/* What was counted of this rank: iterations, and in them halo exchanges, messages sent, their bytes,
   and reductions; called by any rank. */
int km_counts(double *counts) {
  const double all[] = {counted.iterations, counted.exchanges, counted.messages, counted.bytes, counted.reductions};
  for (int k = 0; k < 5; k++) counts[k] = all[k];
  return 0;
}
