"""The linear system of the comparison: a unit cube of linear elasticity, clamped below, under a random load.

    python cube.py COUNT FOLDER

COUNT cubes an edge, six tetrahedra each; Young's modulus 1, Poisson's ratio 0.3, no displacement at z = 0. Written once
as arrays that every solver reads: the matrix by rows (`indptr`, `indices`, `data`), the right-hand side `rhs`, and the
`coordinates` of the free nodes, three unknowns each.
"""

import sys
from pathlib import Path

import numpy as np
from scipy.sparse import bsr_array

from meshes import KUHN

CORNERS = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]])
"""Places of a cube's nodes in the grid, as steps along x, y and z."""

POISSON_RATIO = 0.3


def elasticity():
    """Stress over strain (xx, yy, zz, xy, yz, zx; engineering shear) for Young's modulus 1."""
    shear = 0.5 / (1.0 + POISSON_RATIO)
    lame = POISSON_RATIO / ((1.0 + POISSON_RATIO) * (1.0 - 2.0 * POISSON_RATIO))
    matrix = np.diag([2.0 * shear] * 3 + [shear] * 3)
    matrix[:3, :3] += lame
    return matrix


def tetrahedron_stiffness(corners):
    """The 3 x 3 blocks of the stiffness of a linear tetrahedron, by pairs of its corners."""
    edges = corners[1:] - corners[0]
    inner = np.linalg.inv(edges).T
    gradients = np.vstack([-inner.sum(axis=0), inner])
    volume = abs(np.linalg.det(edges)) / 6.0
    strain = np.zeros((6, 12))
    for node, (x, y, z) in enumerate(gradients):
        strain[:, 3 * node : 3 * node + 3] = [[x, 0, 0], [0, y, 0], [0, 0, z], [y, x, 0], [0, z, y], [z, 0, x]]
    stiffness = volume * strain.T @ elasticity() @ strain
    return stiffness.reshape(4, 3, 4, 3).swapaxes(1, 2)


def stencil(count):
    """For every step between neighbours in the grid the blocks of all nodes, as arrays (z, y, x, 3, 3)."""
    nodes = count + 1
    arrays = {}
    for tetrahedron in KUHN:
        corners = CORNERS[tetrahedron]
        blocks = tetrahedron_stiffness(corners / count)
        for a in range(4):
            x, y, z = corners[a]
            for b in range(4):
                step = tuple((corners[b] - corners[a]).tolist())
                values = arrays.setdefault(step, np.zeros((nodes, nodes, nodes, 3, 3)))
                values[z : z + count, y : y + count, x : x + count] += blocks[a, b]
    return arrays


def matrix(count):
    """The stiffness of the free nodes, in 3 x 3 blocks."""
    nodes = count + 1
    z, y, x = np.meshgrid(*[np.arange(nodes)] * 3, indexing="ij")
    number = x + nodes * (y + nodes * (z - 1))
    columns, blocks = [], []
    # Ascending along z, then y, then x: so the columns of every row ascend.
    for step, values in sorted(stencil(count).items(), key=lambda item: item[0][::-1]):
        other = [axis + by for axis, by in zip((x, y, z), step)]
        inside = np.all([(0 <= at) & (at < nodes) for at in other], axis=0) & (other[2] > 0) & (z > 0)
        column = number + step[0] + nodes * (step[1] + nodes * step[2])
        columns.append(np.where(inside, column, -1)[1:].ravel())
        blocks.append(values[1:].reshape(-1, 3, 3))
    columns = np.stack(columns, axis=1)
    there = columns >= 0
    ends = np.concatenate([[0], np.cumsum(there.sum(axis=1))])
    return bsr_array((np.stack(blocks, axis=1)[there], columns[there], ends), shape=(3 * len(columns),) * 2)


def write(count, folder):
    """Writes the system of `count` cubes an edge."""
    rows = matrix(count).tocsr()
    rows.sort_indices()
    layers = np.arange(count + 1) / count
    z, y, x = (axis.ravel() for axis in np.meshgrid(layers[1:], layers, layers, indexing="ij"))
    arrays = {
        "indptr": rows.indptr.astype(np.int32),
        "indices": rows.indices.astype(np.int32),
        "data": rows.data,
        "rhs": np.random.default_rng(1).uniform(-1.0, 1.0, rows.shape[0]),
        "coordinates": np.column_stack([x, y, z]),
    }
    folder.mkdir(parents=True, exist_ok=True)
    for name, values in arrays.items():
        np.save(folder / f"{name}.npy", values)


if __name__ == "__main__":
    write(int(sys.argv[1]), Path(sys.argv[2]))
