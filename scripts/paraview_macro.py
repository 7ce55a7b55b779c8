"""A macro for ParaView: the results of a run, opened.

With `rock.pvd`, `fractures.pvd` or `results.vtm` as the active source it shows the fractures of the
same folder by their aperture, and behind them one half of the rock, moved by its displacement times
a factor: the largest displacement becomes a tenth of the extent of what moves, a crack or a tunnel,
and at most 6 % of the diagonal of the body.
"""

import os

import numpy as np
from paraview import servermanager
from paraview import simple as pv
from vtkmodules.numpy_interface import dataset_adapter

LARGEST_SHIFT = 0.06
"""Of the diagonal of the body."""
SHIFT_OF_MOVING = 0.1
"""Of the extent of what moves."""
MOVING = 0.5
"""Of the largest displacement, from which on something moves."""
MANY = 10.0
"""Ratio of the largest to the smallest aperture from which on colours are logarithmic."""


def folder_of(source):
    """The folder of the file that a source, or what it is made of, reads."""
    while not hasattr(source, "FileName"):
        if not hasattr(source, "Input"):
            raise RuntimeError("open rock.pvd, fractures.pvd or results.vtm of a run first")
        source = source.Input
    name = source.FileName
    return os.path.dirname(name if isinstance(name, str) else name[0])


def at_last_time(source):
    """A source at its last load step, as arrays."""
    times = source.TimestepValues
    times = list(times) if hasattr(times, "__len__") else [times]
    source.UpdatePipeline(times[-1])
    data = servermanager.Fetch(source)
    if data.IsA("vtkMultiBlockDataSet"):
        data = data.GetBlock(0)
    return dataset_adapter.WrapDataObject(data), times[-1]


def factor_for(points, displacement):
    """What displacements are multiplied by."""
    size = np.linalg.norm(displacement, axis=1)
    largest = size.max(initial=0.0)
    if largest == 0.0:
        return 1.0
    diagonal = np.linalg.norm(np.ptp(points, axis=0))
    extent = np.linalg.norm(np.ptp(points[size >= MOVING * largest], axis=0))
    shift = min(LARGEST_SHIFT * diagonal, SHIFT_OF_MOVING * extent or np.inf)
    return float(f"{shift / largest:.2g}")


def show_rock(reader, view, factor):
    """Half of the rock, moved, with the edges of the whole."""
    moved = pv.WarpByVector(Input=reader, Vectors=["POINTS", "displacement"], ScaleFactor=factor)
    half = pv.Clip(Input=moved, ClipType="Plane", Invert=0)
    half.ClipType.Normal = [0.0, 1.0, 0.0]
    shown = pv.Show(half, view)
    shown.ColorArrayName = [None, ""]
    shown.DiffuseColor = [0.86, 0.85, 0.82]
    edges = pv.FeatureEdges(Input=pv.ExtractSurface(Input=moved))
    lines = pv.Show(edges, view)
    lines.ColorArrayName = [None, ""]
    lines.DiffuseColor = lines.AmbientColor = [0.25, 0.25, 0.25]


def show_fractures(reader, view, aperture):
    """All fractures by their aperture."""
    shown = pv.Show(reader, view)
    pv.ColorBy(shown, ("POINTS", "aperture"))
    colours = pv.GetColorTransferFunction("aperture")
    colours.ApplyPreset("Viridis (matplotlib)", True)
    low, high = float(aperture.min()), float(aperture.max())
    if high > low:
        colours.RescaleTransferFunction(low, high)
    if low > 0.0 and high > MANY * low:
        colours.MapControlPointsToLogSpace()
        colours.UseLogScale = 1
    shown.SetScalarBarVisibility(view, True)
    bar = pv.GetScalarBar(colours, view)
    bar.Title, bar.ComponentTitle = "Aperture (m)", ""


def main():
    """Shows the folder of the active source."""
    active = pv.GetActiveSource()
    if active is None:
        raise RuntimeError("open rock.pvd, fractures.pvd or results.vtm of a run first")
    folder = folder_of(active)
    view = pv.GetActiveViewOrCreate("RenderView")
    pv.Hide(active, view)
    rock = pv.PVDReader(FileName=os.path.join(folder, "rock.pvd"))
    fractures = pv.PVDReader(FileName=os.path.join(folder, "fractures.pvd"))
    arrays, last = at_last_time(rock)
    points = np.asarray(arrays.Points)
    factor = factor_for(points, np.asarray(arrays.PointData["displacement"]))
    show_rock(rock, view, factor)
    sheets, _ = at_last_time(fractures)
    if sheets.GetNumberOfCells():
        show_fractures(fractures, view, np.asarray(sheets.PointData["aperture"]))
    caption = pv.Show(pv.Text(Text=f"displacement x {factor:g}"), view)
    caption.WindowLocation = "Lower Left Corner"
    view.ViewTime = last
    camera = view.GetActiveCamera()
    camera.SetPosition(*(np.asarray(camera.GetFocalPoint()) + [0.75, -1.0, 0.55]))
    camera.SetViewUp(0.0, 0.0, 1.0)
    view.ResetCamera()
    pv.Render(view)


main()
