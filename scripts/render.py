"""Draws the output of a run: the rock cut open, the fractures coloured by their aperture.

    python scripts/render.py OUT_DIR PICTURE.png [--warp FACTOR] [--step NUMBER]

Rock and fractures are moved by the displacement times FACTOR; without one, the largest displacement
becomes 5 % of the body's diagonal. Draws the last step unless another is named (the first is 1).

Needs pyvista==0.49.1 and vtk==9.7.2 from PyPI. No X server is needed: VTK falls back to EGL, for
which Debian has the packages libegl1 and libgl1-mesa-dri.
"""

import argparse
from pathlib import Path

import numpy as np
import pyvista as pv
from vtkmodules.vtkCommonCore import vtkLogger

LARGEST_SHIFT = 0.05  # of the diagonal
WIDE = 1e-3  # largest aperture from which on millimetres read better than micrometres
VIEW = np.array([0.75, -1.0, 0.55])  # from the body's centre to the camera
CUT = (0.0, -1.0, 0.0)  # normal of the cutting plane, into the half that is taken away
ROCK_COLOURS = ["#d9d4cc", "#b9c4cf", "#cfc0a8", "#b7c7b3", "#c9b8c4"]
SIZE = (1600, 1200)


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
    largest = np.linalg.norm(rock["displacement"], axis=1).max(initial=0.0)
    return LARGEST_SHIFT * rock.length / largest if largest > 0.0 else 1.0


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


def moved(grid, displacement, factor):
    shifted = grid.copy()
    shifted.points = np.asarray(grid.points) + factor * displacement
    return shifted


def aperture_in_unit(fractures):
    """Adds the aperture in a readable unit and returns the title of its scalar bar."""
    aperture = fractures["aperture"]
    unit, per_metre = ("mm", 1e3) if aperture.max() >= WIDE else ("µm", 1e6)
    title = f"Aperture ({unit})"
    fractures[title] = aperture * per_metre
    return title


def colour_range(values):
    """Limits that keep a uniform aperture from being coloured by rounding errors."""
    low, high = float(values.min()), float(values.max())
    if high - low > 1e-6 * max(abs(low), abs(high)):
        return low, high
    middle, half = 0.5 * (low + high), 0.05 * max(abs(low), abs(high)) or 1.0
    return middle - half, middle + half


def add_rock(plotter, rock, centre):
    """The half behind a plane through the centre, and the edges of the whole."""
    # Off the centre by a little, because a plane through cell faces cuts no cell.
    origin = np.asarray(centre) + [0.0, 1e-3 * rock.length, 0.0]
    for colour, number in enumerate(np.unique(rock["rock"])):
        part = rock.extract_cells(np.flatnonzero(rock["rock"] == number))
        face = part.slice(normal=CUT, origin=origin)
        behind = outside(part).clip(normal=CUT, origin=origin)
        for half, opacity in ((behind, 0.35), (face, 0.8)):
            if half.n_cells:
                shade = ROCK_COLOURS[colour % len(ROCK_COLOURS)]
                plotter.add_mesh(half, color=shade, opacity=opacity, ambient=0.3)
    walls = outside(rock)
    edges = walls.extract_feature_edges(feature_angle=30.0, non_manifold_edges=False)
    outline = walls.slice(normal=CUT, origin=origin)
    for lines, width in ((edges, 2), (outline, 3)):
        if lines.n_cells:
            plotter.add_mesh(lines, color="#404040", line_width=width)


def outside(grid):
    """The outer faces, the walls of the fractures among them."""
    return grid.extract_surface(algorithm="dataset_surface")


def add_fractures(plotter, fractures, title):
    plotter.add_mesh(
        fractures,
        scalars=title,
        cmap="viridis",
        clim=colour_range(fractures[title]),
        show_edges=False,
        ambient=0.35,
        scalar_bar_args={
            "title": title + "\n",
            "color": "black",
            "fmt": "%.4g",
            "n_labels": 5,
            "title_font_size": 34,
            "label_font_size": 28,
            "vertical": True,
            "position_x": 0.84,
            "position_y": 0.2,
            "width": 0.07,
            "height": 0.6,
        },
    )


def draw(folder, picture, factor, step):
    rock, time = read_step(folder / "rock.pvd", step)
    fractures, _ = read_step(folder / "fractures.pvd", step)
    factor = automatic_factor(rock) if factor is None else factor
    plotter = pv.Plotter(off_screen=True, window_size=SIZE)
    plotter.set_background("white")
    plotter.enable_anti_aliasing("ssaa")
    plotter.enable_depth_peeling(8)
    warped = moved(rock, rock["displacement"], factor)
    add_rock(plotter, warped, rock.center)
    if fractures.n_cells:
        title = aperture_in_unit(fractures)
        sheets = moved(fractures, fracture_displacement(fractures, rock), factor)
        add_fractures(plotter, sheets, title)
    caption = f"load {time:g}, displacement x {factor:.3g}"
    plotter.add_text(caption, position=(40, 30), font_size=14, color="black")
    plotter.add_axes(color="black", viewport=(0.0, 0.06, 0.16, 0.28))
    plotter.view_vector(VIEW, viewup=(0.0, 0.0, 1.0))
    # Leaves room for the scalar bar.
    plotter.camera.SetWindowCenter(0.12, 0.0)
    plotter.screenshot(str(picture))
    plotter.close()


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
