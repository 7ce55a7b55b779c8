"""Reads the output of a run with VTK and prints what it found as one JSON object.

    python read_back.py DIR
    python read_back.py GRID.vtu

reads DIR/rock.pvd and DIR/fractures.pvd with every .vtu they list. Needs vtk==9.7.2 and numpy
installed with pip (sh scripts/setup).
With a single grid it prints its STEP, without "time", "file", "fractures" and "walls".
Prints to standard output:

    {"rock": {"steps": [STEP, ...]}, "fractures": {"steps": [STEP, ...]}}

    STEP = {"time", "file", "number_of_points", "number_of_cells", "cell_types": {NAME: count},
            "min_cell_measure", "total_measure", "duplicate_points",
            "point_data": {NAME: ARRAY}, "cell_data": {NAME: ARRAY}, "fractures": {ID: FRACTURE},
            "walls": {"largest_jump", "largest_mismatch"}}
    ARRAY = {"components", "min": [...], "max": [...], "mean": [...], "any_nan", "any_infinite"}
    FRACTURE = {"facets", "area", "aperture": RANGE, "normal_traction": RANGE, "slip_max",
                "open_area", "stuck_area", "slipping_area", "below_cutoff_area"}
    RANGE = {"min", "mean", "max"}

The measure of a cell is its volume or its area; the volume of a tetrahedron is negative when its
nodes run the wrong way round. Duplicate points are those beyond the first at bitwise equal
coordinates. "fractures" is there when the cells carry an array `fracture`. The mean of an ARRAY is
over its values, that of a RANGE over the area. What is not a finite number is null. "walls" is
there in the fractures' steps: it compares `jump` with the displacements of the two cells at each
facet, plus side (where `normal` points) less minus side.

Exit status 1, with the reason on standard error, when VTK complains or a file does not fit together.
"""

import json
import math
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import VTK_STRING, vtkLogger, vtkOutputWindow
from vtkmodules.vtkFiltersVerdict import vtkCellSizeFilter
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

CELL_NAMES = {
    5: "triangle", 9: "quad", 10: "tetra", 12: "hexahedron", 13: "wedge", 14: "pyramid",
    22: "quadratic_triangle", 24: "quadratic_tetra",
}
TRIANGLES, TETRAHEDRA = (5, 22), (10, 24)
STATES = {"open": 0, "stuck": 1, "slipping": 2, "below_cutoff": 3}


class Broken(Exception):
    """The output cannot be read, or does not fit together."""


class Complaints:
    """Every error and warning VTK utters, from the readers and from the objects inside them."""

    def __init__(self):
        self.texts = []
        # Without this VTK also writes to standard error by itself.
        vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_OFF)
        self.listen(vtkOutputWindow.GetInstance())

    def listen(self, source):
        def note(_source, _event, text):
            self.texts.append(text.strip())

        note.CallDataType = VTK_STRING
        for event in ("ErrorEvent", "WarningEvent"):
            source.AddObserver(event, note)

    def raise_any(self, path):
        if self.texts:
            raise Broken(f"{path}: VTK says: " + " | ".join(self.texts))


def read_collection(path):
    """Times and files of a .pvd, in its order."""
    try:
        root = ElementTree.parse(path).getroot()
    except (OSError, ElementTree.ParseError) as error:
        raise Broken(f"{path}: {error}") from error
    if root.tag != "VTKFile" or root.get("type") != "Collection":
        raise Broken(f"{path}: not a collection")
    return [(float(entry.get("timestep")), entry.get("file")) for entry in root.iter("DataSet")]


def read_grid(path, complaints):
    if not path.is_file():
        raise Broken(f"{path}: there is no such file")
    reader = vtkXMLUnstructuredGridReader()
    complaints.listen(reader)
    reader.SetFileName(str(path))
    reader.Update()
    complaints.raise_any(path)
    if reader.GetErrorCode():
        raise Broken(f"{path}: VTK error code {reader.GetErrorCode()}")
    return reader.GetOutput()


def arrays_of(attributes, count, path):
    """All arrays as name -> values of shape (count, components)."""
    arrays = {}
    for index in range(attributes.GetNumberOfArrays()):
        array, name = attributes.GetArray(index), attributes.GetArrayName(index)
        if array is None:
            raise Broken(f"{path}: array {name} holds no numbers")
        if array.GetNumberOfTuples() != count:
            raise Broken(f"{path}: {name} has {array.GetNumberOfTuples()} values, not {count}")
        arrays[name] = vtk_to_numpy(array).reshape(count, array.GetNumberOfComponents())
    return arrays


def finite(value):
    return float(value) if math.isfinite(value) else None


def each(reduce, values):
    """One number a component; null for a component without any number."""
    if len(values) == 0:
        return [None] * values.shape[1]
    missing = np.isnan(values).all(axis=0)
    # The mean of infinities of both signs is no number, and becomes null.
    with np.errstate(invalid="ignore"):
        reduced = reduce(np.where(missing, 0.0, values), axis=0)
    return [None if gone else finite(number) for gone, number in zip(missing, reduced)]


def describe_array(values):
    values = values.astype(np.float64)
    return {
        "components": values.shape[1],
        "min": each(np.nanmin, values),
        "max": each(np.nanmax, values),
        "mean": each(np.nanmean, values),
        "any_nan": bool(np.isnan(values).any()),
        "any_infinite": bool(np.isinf(values).any()),
    }


class Cells:
    """Connectivity, types, corner nodes and measures of the cells of one grid."""

    def __init__(self, grid, path):
        self.points = points_of(grid)
        count = grid.GetNumberOfCells()
        self.types = vtk_to_numpy(grid.GetCellTypes()) if count else np.empty(0, dtype=np.uint8)
        offsets = vtk_to_numpy(grid.GetCells().GetOffsetsArray()) if count else np.zeros(1, int)
        self.starts = offsets[:-1].astype(np.int64)
        self.nodes = vtk_to_numpy(grid.GetCells().GetConnectivityArray()) if count else offsets[:0]
        if len(self.nodes) and not 0 <= self.nodes.min() <= self.nodes.max() < len(self.points):
            raise Broken(f"{path}: a cell names a point that is not there")
        self.measures = self.measure(grid)

    def corners(self, chosen, count):
        """The first `count` nodes of the chosen cells; corners come first in VTK's node order."""
        return self.nodes[self.starts[chosen][:, None] + np.arange(count)]

    def measure(self, grid):
        measures = np.full(len(self.types), np.nan)
        flat, solid = np.isin(self.types, TRIANGLES), np.isin(self.types, TETRAHEDRA)
        measures[flat] = triangle_areas(self.points[self.corners(flat, 3)])
        measures[solid] = tetrahedron_volumes(self.points[self.corners(solid, 4)])
        others = ~(flat | solid)
        if others.any():
            measures[others] = vtk_measures(grid)[others]
        return measures


def points_of(grid):
    if grid.GetNumberOfPoints() == 0:
        return np.empty((0, 3))
    return vtk_to_numpy(grid.GetPoints().GetData())


def triangle_areas(corners):
    first, second, third = corners[:, 0], corners[:, 1], corners[:, 2]
    return 0.5 * np.linalg.norm(np.cross(second - first, third - first), axis=1)


def tetrahedron_volumes(corners):
    edges = corners[:, 1:] - corners[:, :1]
    return np.linalg.det(edges) / 6.0 if len(edges) else np.empty(0)


def vtk_measures(grid):
    sizes = vtkCellSizeFilter()
    sizes.SetInputData(grid)
    sizes.Update()
    arrays = sizes.GetOutput().GetCellData()
    return sum(vtk_to_numpy(arrays.GetArray(name)) for name in ("Area", "Volume"))


def count_duplicates(points):
    bits = np.ascontiguousarray(points, dtype=np.float64).view(np.uint64)
    return len(points) - len(np.unique(bits, axis=0))


def facet_values(name, cells, chosen, point_data, cell_data):
    """The values at the three corners of the chosen facets: shape (facets, 3, components)."""
    if name in point_data:
        return point_data[name][cells.corners(chosen, 3)]
    if name in cell_data:
        return np.repeat(cell_data[name][chosen][:, None, :], 3, axis=1)
    return None


def describe_range(values, areas):
    if values is None:
        return None
    corners = values[:, :, 0]
    mean = (corners.mean(axis=1) * areas).sum() / areas.sum()
    return {"min": finite(corners.min()), "mean": finite(mean), "max": finite(corners.max())}


def describe_fracture(cells, chosen, point_data, cell_data):
    areas = cells.measures[chosen]

    def values(name):
        return facet_values(name, cells, chosen, point_data, cell_data)

    slip, state = values("slip"), values("state")
    described = {
        "facets": int(chosen.sum()),
        "area": finite(areas.sum()),
        "aperture": describe_range(values("aperture"), areas),
        "normal_traction": describe_range(values("normal_traction"), areas),
        "slip_max": None if slip is None else finite(np.linalg.norm(slip, axis=2).max()),
    }
    for name, code in STATES.items():
        # Each corner owns a third of its facet.
        share = None if state is None else (state[:, :, 0] == code).sum(axis=1) / 3.0
        described[f"{name}_area"] = None if share is None else finite((share * areas).sum())
    return described


def describe_fractures(cells, point_data, cell_data, path):
    if not np.isin(cells.types, TRIANGLES).all():
        raise Broken(f"{path}: a fracture facet is not a triangle")
    ids = cell_data["fracture"][:, 0]
    return {
        str(int(number)): describe_fracture(cells, ids == number, point_data, cell_data)
        for number in np.unique(ids)
    }


def describe_grid(grid, path, of_run=True):
    cells = Cells(grid, path)
    point_data = arrays_of(grid.GetPointData(), grid.GetNumberOfPoints(), path)
    cell_data = arrays_of(grid.GetCellData(), grid.GetNumberOfCells(), path)
    types, counts = np.unique(cells.types, return_counts=True)
    described = {
        "number_of_points": grid.GetNumberOfPoints(),
        "number_of_cells": grid.GetNumberOfCells(),
        "cell_types": {CELL_NAMES.get(int(t), str(t)): int(n) for t, n in zip(types, counts)},
        "min_cell_measure": finite(cells.measures.min()) if len(types) else None,
        "total_measure": finite(cells.measures.sum()),
        "duplicate_points": count_duplicates(cells.points),
        "point_data": {name: describe_array(values) for name, values in point_data.items()},
        "cell_data": {name: describe_array(values) for name, values in cell_data.items()},
    }
    if of_run and "fracture" in cell_data:
        described["fractures"] = describe_fractures(cells, point_data, cell_data, path)
    return described


def faces_of(cells, numbers):
    """Cells by the place of a face: {three numbers, ascending: [cell, ...]}."""
    faces = {}
    tetrahedra = np.flatnonzero(np.isin(cells.types, TETRAHEDRA))
    placed = numbers[cells.corners(tetrahedra, 4)]
    for left_out in range(4):
        for cell, face in zip(tetrahedra, np.sort(np.delete(placed, left_out, axis=1), axis=1)):
            faces.setdefault(tuple(face), []).append(cell)
    return faces


def compare_walls(rock, fractures, path):
    """The field `jump` against what the rock does on both sides of each facet."""
    rock_cells, facets = Cells(rock, path), Cells(fractures, path)
    count = len(rock_cells.points)
    places = np.concatenate([rock_cells.points, facets.points])
    numbers = np.unique(places, axis=0, return_inverse=True)[1].reshape(-1)
    faces = faces_of(rock_cells, numbers[:count])
    moved = vtk_to_numpy(rock.GetPointData().GetArray("displacement"))
    jumps = vtk_to_numpy(fractures.GetPointData().GetArray("jump"))
    normals = vtk_to_numpy(fractures.GetCellData().GetArray("normal"))
    largest = mismatch = 0.0
    for facet, corners in enumerate(facets.corners(np.full(len(facets.types), True), 3)):
        own = numbers[count:][corners]
        sides = faces.get(tuple(np.sort(own)), [])
        if len(sides) != 2:
            raise Broken(f"{path}: facet {facet} lies between {len(sides)} cells")
        walls = {}
        for cell in sides:
            nodes = rock_cells.corners(np.array([cell]), 4)[0]
            away = rock_cells.points[nodes].mean(axis=0) - facets.points[corners[0]]
            by_place = dict(zip(numbers[nodes], moved[nodes]))
            walls[away @ normals[facet] > 0] = np.array([by_place[place] for place in own])
        if len(walls) != 2:
            raise Broken(f"{path}: both cells at facet {facet} lie on one side")
        error = np.abs(jumps[corners] - (walls[True] - walls[False])).max()
        mismatch, largest = max(mismatch, error), max(largest, np.abs(jumps[corners]).max())
    return {"largest_jump": finite(largest), "largest_mismatch": finite(mismatch)}


def describe_collections(folder, complaints):
    """Both collections, step by step; the fractures are compared with the rock of the same time."""
    found, grids = {}, {}
    for name in ("rock", "fractures"):
        steps = []
        for time, file in read_collection(folder / f"{name}.pvd"):
            path = folder / file
            grid = grids[name, time] = read_grid(path, complaints)
            described = describe_grid(grid, path)
            if name == "fractures" and grid.GetNumberOfCells():
                described["walls"] = compare_walls(grids["rock", time], grid, path)
            complaints.raise_any(path)
            steps.append({"time": time, "file": file, **described})
        found[name] = {"steps": steps}
    return found


def main(arguments):
    if len(arguments) != 1:
        print("usage: python read_back.py DIR|GRID.vtu", file=sys.stderr)
        return 2
    complaints = Complaints()
    try:
        path = Path(arguments[0])
        if path.suffix == ".vtu":
            found = describe_grid(read_grid(path, complaints), path, of_run=False)
            complaints.raise_any(path)
        else:
            found = describe_collections(path, complaints)
    except Broken as broken:
        print(broken, file=sys.stderr)
        return 1
    print(json.dumps(found, allow_nan=False))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
