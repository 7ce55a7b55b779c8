"""Draws a flow in fractures: their pressure, in the frame of the body.

    python scripts/render_flow.py OUT_DIR PICTURE.png [--field NAME] [--step NUMBER]

Facets in which nothing flows are grey. Needs the VTK of `sh scripts/setup` only, and no X server.
"""

import argparse
from pathlib import Path

import numpy as np
import vtk
from vtk.util.numpy_support import vtk_to_numpy

SIZE = (1200, 800)
VIEW = np.array([0.75, -1.0, 0.55])  # from the body's centre to the camera
COLOURS = [(0.27, 0.23, 0.58), (0.20, 0.52, 0.80), (0.30, 0.78, 0.66), (0.98, 0.80, 0.30), (0.80, 0.20, 0.12)]
IDLE = (0.78, 0.78, 0.76)


def grid_of(folder, step):
    """The fractures at the end of a load step, the last one by default."""
    files = sorted(folder.glob("fractures_*.vtu"))
    if not files:
        raise SystemExit(f"{folder}: there are no fractures_NNNN.vtu")
    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(files[-1 if step is None else step - 1]))
    reader.Update()
    return reader.GetOutput()


def chosen(grid, flowing):
    """The facets that conduct, or the others."""
    threshold = vtk.vtkThreshold()
    threshold.SetInputData(grid)
    threshold.SetInputArrayToProcess(0, 0, 0, vtk.vtkDataObject.FIELD_ASSOCIATION_CELLS, "transmissivity")
    threshold.SetThresholdFunction(vtk.vtkThreshold.THRESHOLD_UPPER if flowing else vtk.vtkThreshold.THRESHOLD_LOWER)
    threshold.SetUpperThreshold(np.finfo(float).tiny)
    threshold.SetLowerThreshold(0.0)
    threshold.Update()
    return threshold.GetOutput()


def actor_of(mapper, colour=None, opacity=1.0):
    actor = vtk.vtkActor()
    actor.SetMapper(mapper)
    actor.GetProperty().SetOpacity(opacity)
    actor.GetProperty().SetAmbient(0.5)
    actor.GetProperty().SetDiffuse(0.5)
    if colour:
        actor.GetProperty().SetColor(*colour)
    return actor


def coloured(grid, field, colours):
    mapper = vtk.vtkDataSetMapper()
    mapper.SetInputData(grid)
    mapper.SetScalarModeToUsePointFieldData()
    mapper.SelectColorArray(field)
    mapper.SetLookupTable(colours)
    mapper.UseLookupTableScalarRangeOn()
    return actor_of(mapper)


def colours_of(grid, field):
    values = vtk_to_numpy(grid.GetPointData().GetArray(field))
    if values.ndim > 1:
        values = np.linalg.norm(values, axis=1)
    low, high = float(values.min()), float(values.max())
    transfer = vtk.vtkColorTransferFunction()
    transfer.SetVectorModeToMagnitude()
    for place, colour in zip(np.linspace(low, high, len(COLOURS)), COLOURS):
        transfer.AddRGBPoint(place, *colour)
    return transfer


def legend(colours, title):
    bar = vtk.vtkScalarBarActor()
    bar.SetLookupTable(colours)
    bar.SetTitle(title)
    bar.SetNumberOfLabels(5)
    bar.SetLabelFormat("%.3g")
    bar.UnconstrainedFontSizeOn()
    for text, size in [(bar.GetTitleTextProperty(), 20), (bar.GetLabelTextProperty(), 18)]:
        text.SetColor(0.1, 0.1, 0.1)
        text.SetFontSize(size)
        text.ItalicOff()
        text.BoldOff()
        text.ShadowOff()
    bar.SetPosition(0.87, 0.2)
    bar.SetWidth(0.08)
    bar.SetHeight(0.6)
    return bar


def frame(grid):
    outline = vtk.vtkOutlineFilter()
    outline.SetInputData(grid)
    mapper = vtk.vtkPolyDataMapper()
    mapper.SetInputConnection(outline.GetOutputPort())
    return actor_of(mapper, (0.2, 0.2, 0.2))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("picture", type=Path)
    parser.add_argument("--field", default="pressure")
    parser.add_argument("--step", type=int)
    asked = parser.parse_args()
    grid = grid_of(asked.folder, asked.step)
    colours = colours_of(grid, asked.field)
    renderer = vtk.vtkRenderer()
    renderer.SetBackground(1.0, 1.0, 1.0)
    renderer.AddActor(coloured(chosen(grid, True), asked.field, colours))
    idle = vtk.vtkDataSetMapper()
    idle.SetInputData(chosen(grid, False))
    idle.ScalarVisibilityOff()
    renderer.AddActor(actor_of(idle, IDLE, 0.35))
    renderer.AddActor(frame(grid))
    unit = {"pressure": "Pa", "hydraulic_aperture": "m", "slip": "m"}.get(asked.field, "")
    renderer.AddViewProp(legend(colours, f"{asked.field.replace('_', ' ')}  {unit}"))
    camera = renderer.GetActiveCamera()
    centre = np.array(grid.GetCenter())
    camera.SetFocalPoint(*centre)
    camera.SetPosition(*(centre + VIEW * grid.GetLength()))
    camera.SetViewUp(0, 0, 1)
    renderer.ResetCamera()
    camera.Zoom(1.0)
    window = vtk.vtkRenderWindow()
    window.SetOffScreenRendering(True)
    window.SetMultiSamples(8)
    window.SetSize(*SIZE)
    window.AddRenderer(renderer)
    window.Render()
    picture = vtk.vtkWindowToImageFilter()
    picture.SetInput(window)
    picture.ReadFrontBufferOff()
    writer = vtk.vtkPNGWriter()
    writer.SetFileName(str(asked.picture))
    writer.SetInputConnection(picture.GetOutputPort())
    writer.Write()


main()
