"""Unstructured grids of VTK: writing them from arrays, and reading the fields of results."""

import numpy as np
import vtk
from vtk.util import numpy_support

TYPES = {1: vtk.VTK_VERTEX, 2: vtk.VTK_LINE, 3: vtk.VTK_TRIANGLE, 8: vtk.VTK_HEXAHEDRON}
VOLUME_TYPES = TYPES | {4: vtk.VTK_TETRA, 10: vtk.VTK_QUADRATIC_TETRA}
SURFACE_TYPES = TYPES | {4: vtk.VTK_QUAD, 6: vtk.VTK_QUADRATIC_TRIANGLE}


def write(path, points, blocks, point_data, cell_data):
    """Writes a grid; a block is (dimension, nodes of its elements), the data are arrays by name."""
    grid = vtk.vtkUnstructuredGrid()
    held = vtk.vtkPoints()
    held.SetDataTypeToDouble()
    held.SetData(numpy_support.numpy_to_vtk(np.ascontiguousarray(points, dtype=float), deep=True))
    grid.SetPoints(held)
    grid.SetCells(*element_arrays(blocks))
    for data, fields in ((grid.GetPointData(), point_data), (grid.GetCellData(), cell_data)):
        for name, values in fields.items():
            array = numpy_support.numpy_to_vtk(np.ascontiguousarray(values), deep=True)
            array.SetName(name)
            data.AddArray(array)
    writer = vtk.vtkXMLUnstructuredGridWriter()
    writer.SetFileName(str(path))
    writer.SetInputData(grid)
    writer.SetCompressorTypeToNone()
    writer.Write()


def element_arrays(blocks):
    """VTK's types and connectivity of blocks of elements."""
    types, widths, nodes = [], [], []
    for dimension, elements in blocks:
        width = elements.shape[1]
        kind = (VOLUME_TYPES if dimension == 3 else SURFACE_TYPES)[width]
        types.append(np.full(len(elements), kind, dtype=np.uint8))
        widths.append(np.full(len(elements), width))
        nodes.append(elements.ravel())
    offsets = np.concatenate([[0], np.cumsum(np.concatenate(widths))]).astype(np.int64)
    cells = vtk.vtkCellArray()
    cells.SetData(
        numpy_support.numpy_to_vtkIdTypeArray(offsets, deep=True),
        numpy_support.numpy_to_vtkIdTypeArray(np.concatenate(nodes).astype(np.int64), deep=True),
    )
    return numpy_support.numpy_to_vtk(np.concatenate(types), deep=True, array_type=vtk.VTK_UNSIGNED_CHAR), cells


def read(path):
    """Points, nodes of the elements as (offsets, nodes), point data and cell data of a file."""
    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(path))
    reader.Update()
    grid = reader.GetOutput()
    as_numpy = numpy_support.vtk_to_numpy
    data = []
    for held in (grid.GetPointData(), grid.GetCellData()):
        count = held.GetNumberOfArrays()
        data.append({held.GetArrayName(i): as_numpy(held.GetArray(i)) for i in range(count)})
    cells = grid.GetCells()
    nodes = (as_numpy(cells.GetOffsetsArray()), as_numpy(cells.GetConnectivityArray()))
    points = as_numpy(grid.GetPoints().GetData())
    return points, nodes, *data
