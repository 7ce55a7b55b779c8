"""Draws the output of a run: the rock cut open, the fractures coloured by their aperture.

    python scripts/render.py OUT_DIR PICTURE.png [--warp FACTOR] [--step NUMBER]

Rock and fractures are moved by the displacement times FACTOR; without one, the largest displacement
becomes a tenth of the extent of what moves, a crack or a tunnel, and at most 6 % of the body's
diagonal. Draws the last step unless another is named (the first is 1).
`sh scripts/setup --pictures` installs what this needs in target/venv. No X server is needed: VTK
then draws with EGL.
"""

import argparse
from itertools import product
from pathlib import Path

import numpy as np
import pyvista as pv
from vtkmodules.vtkCommonCore import vtkLogger

LARGEST_SHIFT = 0.06  # of the diagonal
SHIFT_OF_MOVING = 0.1  # of the extent of what moves
MOVING = 0.5  # of the largest displacement, from which on something moves
WIDE = 1e-3  # largest aperture from which on millimetres read better than micrometres
MANY = 10.0  # ratio of the largest to the smallest aperture from which the colours are logarithmic
MANY_DECADES = 4  # of a scale, from which on only powers of ten are written
VIEW = np.array([0.75, -1.0, 0.55])  # from the body's centre to the camera
CUT_DEPTH = 0.51  # of the body's depth, measured from the front
CUT = (0.0, -1.0, 0.0)  # normal of the cutting plane, into the half that is taken away
ROCK_COLOURS = ["#e3ded5", "#d3dbe2", "#e0d6c4", "#d3ddd0", "#ded3da"]
SIZE = (1200, 720)
ROOM = ((-0.95, 0.62), (-0.9, 0.94))  # for the body, of the picture's width and height, each -1 to 1


def read_step(path, step):
    """The grid of one step (the last when `step` is None) and its time."""
    reader = pv.PVDReader(str(path))
    count = len(reader.time_values)
    index = count - 1 if step is None else step - 1
    if not 0 <= index < count:
        raise SystemExit(f"{path}: there is no step {step}, it has {count}")
    reader.set_active_time_value(reader.time_values[index])
    return reader.read()[0], reader.time_values[index]


def automatic_factor(rock):
    size = np.linalg.norm(rock["displacement"], axis=1)
    largest = size.max(initial=0.0)
    if largest == 0.0:
        return 1.0
    extent = np.linalg.norm(np.ptp(rock.points[size >= MOVING * largest], axis=0))
    shift = min(LARGEST_SHIFT * rock.length, SHIFT_OF_MOVING * extent or np.inf)
    return rounded(shift / largest, 2)


def rounded(value, digits):
    return float(f"{value:.{digits}g}")


def fracture_displacement(fractures, rock):
    """The mean over the sectors' copies of each node, which lies halfway between two walls."""
    together = np.vstack([rock.points, fractures.points])
    _, label = np.unique(together, axis=0, return_inverse=True)
    label = label.ravel()
    of_rock, of_fracture = label[: rock.n_points], label[rock.n_points :]
    copies = np.bincount(of_rock, minlength=label.max() + 1)
    sums = np.zeros((len(copies), 3))
    np.add.at(sums, of_rock, rock["displacement"])
    return (sums / np.maximum(copies, 1)[:, None])[of_fracture]


def blocks_of(rock):
    """A number for each cell: cells of one rock that share points are one block."""
    connected = rock.connectivity("all").cell_data["RegionId"]
    return np.unique(np.stack([connected, rock["rock"]]), axis=1, return_inverse=True)[1].ravel()


def moved(grid, displacement, factor):
    shifted = grid.copy()
    shifted.points = np.asarray(grid.points) + factor * displacement
    return shifted


def colouring(fractures):
    """Adds the aperture in a readable unit, or its logarithm; title, limits and ticks of its bar."""
    aperture = np.asarray(fractures["aperture"])
    unit, per_metre = ("mm", 1e3) if aperture.max() >= WIDE else ("µm", 1e6)
    title = f"Aperture ({unit})"
    low, high = colour_range(aperture * per_metre)
    spread = low > 0.0 and high > MANY * low
    scale = np.log10 if spread else np.asarray
    fractures[title] = scale(aperture * per_metre)
    limits = (float(scale(low)), float(scale(high)))
    values = decade_ticks(low, high) if spread else ticks(low, high)
    return title, limits, {float(scale(value)): f"{value:.6g}" for value in values}


def decade_ticks(low, high):
    """The numbers 1, 2, 5 of each decade between two limits; of many decades the first alone."""
    decades = 10.0 ** np.arange(np.floor(np.log10(low)), np.ceil(np.log10(high)) + 1)
    parts = [1.0, 2.0, 5.0] if len(decades) <= MANY_DECADES else [1.0]
    steps = np.sort(np.outer(decades, parts).ravel())
    return steps[(steps >= low) & (steps <= high)]


def ticks(low, high):
    """Round numbers between two limits, four to ten of them."""
    rough = (high - low) / 4.0
    decade = 10.0 ** np.floor(np.log10(rough))
    step = max(part * decade for part in (1.0, 2.0, 5.0) if part * decade <= rough)
    return step * np.arange(np.ceil(low / step), np.floor(high / step) + 1)


def colour_range(values):
    """Limits that keep a uniform aperture from being coloured by rounding errors."""
    low, high = float(values.min()), float(values.max())
    if high - low > 1e-6 * max(abs(low), abs(high)):
        return low, high
    middle, half = 0.5 * (low + high), 0.05 * max(abs(low), abs(high)) or 1.0
    return middle - half, middle + half


def add_rock(plotter, rock, origin):
    """The blocks behind a plane through `origin`, and the edges of the whole."""
    for number in np.unique(rock["block"]):
        block = rock.extract_cells(np.flatnonzero(rock["block"] == number))
        shade = ROCK_COLOURS[number % len(ROCK_COLOURS)]
        for half in (block.slice(normal=CUT, origin=origin), cut(outside(block), origin)):
            if half.n_cells:
                plotter.add_mesh(half, color=shade, ambient=0.65, diffuse=0.4)
    walls = outside(rock)
    edges = walls.extract_feature_edges(feature_angle=30.0, non_manifold_edges=False)
    outline = walls.slice(normal=CUT, origin=origin)
    for lines, width in ((edges, 1.5), (outline, 2.5)):
        if lines.n_cells:
            plotter.add_mesh(lines, color="#404040", line_width=width)


def cut_origin(bounds):
    """Off the middle, where scenes like to have a joint: a plane through cell faces cuts no cell."""
    middle = 0.5 * (np.array(bounds[::2]) + bounds[1::2])
    middle[1] = bounds[2] + CUT_DEPTH * (bounds[3] - bounds[2])
    return middle


def cut(surface, origin):
    return surface.clip(normal=CUT, origin=origin)


def outside(grid):
    """The outer faces, the walls of the fractures among them."""
    return grid.extract_surface(algorithm="dataset_surface")


def add_fractures(plotter, fractures):
    title, limits, labels = colouring(fractures)
    plotter.add_mesh(
        fractures,
        scalars=title,
        cmap="viridis",
        clim=limits,
        annotations=labels,
        # Mostly flat, so that a colour means the same on every joint.
        ambient=0.7,
        diffuse=0.3,
        scalar_bar_args={
            "title": title + "\n",
            "color": "black",
            "n_labels": 0,
            "title_font_size": 26,
            "label_font_size": 22,
            "vertical": True,
            "position_x": 0.88,
            "position_y": 0.18,
            "width": 0.06,
            "height": 0.64,
        },
    )


def draw(folder, picture, factor, step):
    rock, time = read_step(folder / "rock.pvd", step)
    fractures, _ = read_step(folder / "fractures.pvd", step)
    factor = automatic_factor(rock) if factor is None else factor
    plotter = pv.Plotter(off_screen=True, window_size=SIZE)
    plotter.set_background("white")
    plotter.enable_anti_aliasing("ssaa")
    rock["block"] = blocks_of(rock)
    add_rock(plotter, moved(rock, rock["displacement"], factor), cut_origin(rock.bounds))
    if fractures.n_cells:
        sheets = moved(fractures, fracture_displacement(fractures, rock), factor)
        add_fractures(plotter, sheets)
    caption = f"step {time:g}, displacement x {factor:g}"
    plotter.add_text(caption, position=(30, 20), font_size=11, color="black")
    plotter.add_axes(color="black", viewport=(0.0, 0.06, 0.14, 0.28))
    plotter.view_vector(VIEW, viewup=(0.0, 0.0, 1.0))
    frame(plotter)
    plotter.screenshot(str(picture))
    plotter.close()


def frame(plotter):
    """Zooms and shifts the view so that what is drawn fills ROOM, left of the scalar bar."""
    renderer = plotter.renderer
    seen = []
    for corner in product(*np.reshape(plotter.bounds, (3, 2))):
        renderer.SetWorldPoint(*corner, 1.0)
        renderer.WorldToView()
        seen.append(renderer.GetViewPoint()[:2])
    low, high = np.min(seen, axis=0), np.max(seen, axis=0)
    room = np.array(ROOM)
    zoom = ((room[:, 1] - room[:, 0]) / (high - low)).min()
    plotter.camera.zoom(zoom)
    shift = 0.5 * zoom * (low + high) - room.mean(axis=1)
    plotter.camera.SetWindowCenter(*shift)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path, metavar="OUT_DIR")
    parser.add_argument("picture", type=Path, metavar="PICTURE.png")
    parser.add_argument("--warp", type=float, metavar="FACTOR")
    parser.add_argument("--step", type=int, metavar="NUMBER")
    arguments = parser.parse_args()
    # VTK warns when it finds no X server, although it then draws without one.
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_ERROR)
    draw(arguments.folder, arguments.picture, arguments.warp, arguments.step)


if __name__ == "__main__":
    main()
