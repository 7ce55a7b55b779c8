"""Solves one linear system with one solver and prints what it took as a line of JSON.

    python linear.py SOLVER FOLDER      (gamg and mumps: mpirun -n 2 python linear.py ...)

FOLDER is written by `cube.py`. Times are in seconds, memory is the peak of the whole process in bytes, summed over
processes. `setup` is everything that depends on the matrix alone: aggregation or ordering, and factorisation.
"""

import json
import sys
import time
from pathlib import Path

import numpy as np

TOLERANCE = 1e-8
"""Residual of the iterative solvers, relative to the right-hand side."""


def load(folder, name):
    """An array of the system, of which only what is used is read."""
    return np.load(Path(folder) / f"{name}.npy", mmap_mode="r")


def peak_memory():
    """The most memory this process has held (bytes)."""
    status = Path("/proc/self/status").read_text(encoding="ascii")
    line = next(line for line in status.splitlines() if line.startswith("VmHWM"))
    return 1024 * int(line.split()[1])


def timed(action, *arguments):
    """What `action` returns, and how long it took (s)."""
    start = time.perf_counter()
    result = action(*arguments)
    return result, time.perf_counter() - start


def petsc_system(folder):
    """Matrix and right-hand side of this process's share of the rows, and its nodes' coordinates."""
    from petsc4py import PETSc

    indptr, coordinates = load(folder, "indptr"), load(folder, "coordinates")
    rank, ranks = PETSc.COMM_WORLD.rank, PETSc.COMM_WORLD.size
    nodes = [len(coordinates) * part // ranks for part in (rank, rank + 1)]
    first, last = 3 * nodes[0], 3 * nodes[1]
    entries = slice(indptr[first], indptr[last])
    starts = indptr[first : last + 1] - indptr[first]
    rows = (starts, np.array(load(folder, "indices")[entries]), np.array(load(folder, "data")[entries]))
    size = ((last - first, len(indptr) - 1),) * 2
    matrix = PETSc.Mat().createAIJ(size, bsize=3, csr=rows)
    matrix.setOption(PETSc.Mat.Option.SPD, True)
    rhs = PETSc.Vec().createWithArray(np.array(load(folder, "rhs")[first:last]), size=size[0], bsize=3)
    return matrix, rhs, np.array(coordinates[nodes[0] : nodes[1]])


def sum_of_processes(value):
    """The sum of a number over the processes."""
    from petsc4py import PETSc

    return PETSc.Vec().createWithArray(np.array([value], dtype=float)).sum()


def petsc(solver, folder):
    """PETSc: smoothed aggregation with the rigid motions of the cube, or the direct solver MUMPS."""
    from petsc4py import PETSc

    matrix, rhs, coordinates = petsc_system(folder)
    ksp = PETSc.KSP().create()
    ksp.setOperators(matrix)
    if solver == "gamg":
        places = PETSc.Vec().createWithArray(coordinates.ravel(), size=rhs.getSizes(), bsize=3)
        matrix.setNearNullSpace(PETSc.NullSpace().createRigidBody(places))
        ksp.setType("cg")
        ksp.setNormType(PETSc.KSP.NormType.UNPRECONDITIONED)
        ksp.setTolerances(rtol=TOLERANCE)
        ksp.getPC().setType("gamg")
    else:
        ksp.setType("preonly")
        ksp.getPC().setType("cholesky")
        ksp.getPC().setFactorSolverType("mumps")
    # Without this call the aggregation has other defaults, which are slower.
    ksp.setFromOptions()
    solution = rhs.duplicate()
    _, setup = timed(ksp.setUp)
    _, solve = timed(ksp.solve, rhs, solution)
    matrix.scale(-1.0)
    residual = matrix * solution
    residual.axpy(1.0, rhs)
    result = {
        "unknowns": rhs.getSize(),
        "setup_seconds": setup,
        "solve_seconds": solve,
        "iterations": ksp.getIterationNumber() if solver == "gamg" else 0,
        "residual": residual.norm() / rhs.norm(),
        "peak_memory_bytes": sum_of_processes(peak_memory()),
    }
    if solver == "mumps":
        result["factor_flops"] = ksp.getPC().getFactorMatrix().getMumpsRinfog(3)
    return result if PETSc.COMM_WORLD.rank == 0 else None


def triangle(folder, upper):
    """Rows, columns and values of the upper or lower triangle, in the order of rows."""
    indptr, columns = load(folder, "indptr"), np.array(load(folder, "indices"))
    rows = np.repeat(np.arange(len(indptr) - 1, dtype=np.int32), np.diff(indptr))
    kept = columns >= rows if upper else columns <= rows
    return rows[kept], columns[kept], np.array(load(folder, "data")[kept])


def cholmod(folder):
    """CHOLMOD, supernodal, with the better of the orderings AMD and METIS."""
    import cvxopt
    import cvxopt.cholmod

    rows, columns, values = triangle(folder, upper=False)
    matrix = cvxopt.spmatrix(cvxopt.matrix(values), cvxopt.matrix(rows.astype(int)), cvxopt.matrix(columns.astype(int)))
    del rows, columns, values
    cvxopt.cholmod.options["supernodal"] = 2
    solution = cvxopt.matrix(np.array(load(folder, "rhs")))

    def factorise():
        factor = cvxopt.cholmod.symbolic(matrix)
        cvxopt.cholmod.numeric(matrix, factor)
        return factor

    factor, setup = timed(factorise)
    _, solve = timed(cvxopt.cholmod.solve, factor, solution)
    return direct_result(folder, setup, solve, np.array(solution).ravel())


def pardiso(folder):
    """PARDISO of the MKL, symmetric positive definite."""
    import pypardiso
    from scipy.sparse import csr_matrix

    rows, columns, values = triangle(folder, upper=True)
    rhs = np.array(load(folder, "rhs"))
    matrix = csr_matrix((values, (rows, columns)), shape=(len(rhs),) * 2)
    del rows, columns, values
    solver = pypardiso.PyPardisoSolver(mtype=2)
    _, setup = timed(solver.factorize, matrix)
    solver.set_phase(33)
    solution, solve = timed(solver._call_pardiso, matrix, rhs.reshape(-1, 1))
    return direct_result(folder, setup, solve, solution.ravel())


def direct_result(folder, setup, solve, solution):
    """What a direct solver reports, its residual computed from the rows of the system."""
    memory = peak_memory()
    rhs, indptr, indices, data = (load(folder, name) for name in ("rhs", "indptr", "indices", "data"))
    residual = rhs - np.add.reduceat(data * solution[indices], indptr[:-1])
    return {
        "unknowns": len(rhs),
        "setup_seconds": setup,
        "solve_seconds": solve,
        "iterations": 0,
        "residual": float(np.linalg.norm(residual) / np.linalg.norm(rhs)),
        "peak_memory_bytes": memory,
    }


def main():
    """Runs the solver of the arguments."""
    solver, folder = sys.argv[1:]
    direct = {"cholmod": cholmod, "pardiso": pardiso}
    result = direct[solver](folder) if solver in direct else petsc(solver, folder)
    if result:
        print(json.dumps({"solver": solver} | result))


main()
