"""A joint that fills and opens: Kluft beside OpenGeoSys (process HYDRO_MECHANICS_WITH_LIE) on the same meshes.

    python filling.py KLUFT [CASE...]

with the cases `hex`, `tet`, `soft` and `fine` (all but the last if none is named) and Kluft's program. Writes
docs/performance/filling-peers.md, a row for each mesh and program, from what is kept in target/peers/filling.json.

A joint half way up a box of 25 x 1 x 1 m, b = 1e-5 m at 11 MPa, K_n = 1e11 Pa/m, linear; water of 11.9 MPa enters at one
end, in 10 steps of 10 s. The problem is that of OpenGeoSys' own benchmark `single_fracture_3D`, in impermeable rock, with
displacements of first order. Oracle: the similarity solution of Wijesinghe (1986), which neglects what the rock carries from
one part of the joint to the next.
"""

import json
import os
import shutil
import subprocess
import sys
import textwrap
from pathlib import Path

import numpy as np
import opengeosys
import vtu
from meshes import EPSILON, KUHN, Mesh, add_outer_faces, add_traces, faces, grid_hexahedra, write_msh

ROOT = Path(__file__).resolve().parents[2]
KEPT = ROOT / "target/peers/filling.json"
PAGE = ROOT / "docs/performance/filling-peers.md"

MESHES = {"hex": (50, 1, 4), "tet": (60, 4, 6), "soft": (60, 4, 6), "fine": (100, 6, 10)}
"""Cells along x, y and z; six tetrahedra each but in the first."""

SOFT = "1e7"
"""Young's modulus (Pa) of the rock in the case `soft`: it carries nothing along the joint, as the oracle has it."""

LENGTH, GROWTH = 25.0, 1.5
"""Length of the box (m), and the power of the share of it by which cells grow away from the inlet."""

SOLVERS = {"SparseLU": "NONE", "BiCGSTAB": "DIAGONAL"}
"""OpenGeoSys' linear solvers with their preconditioners; only the second one in the case `fine`."""

INITIAL, OPENED, STIFFNESS, VISCOSITY, END = 1e-5, 9e-6, 1e11, 1e-3, 100.0
"""Aperture and by how much the inlet opens (m), stiffness (Pa/m), viscosity (Pa s), time at the end (s)."""

SCENE = """title = "filling"

[mesh]
file = "mesh.msh"

[rock.rock]
young_modulus = {young}
poisson_ratio = 0.0

[fluid]
viscosity = 1e-3
initial_pressure = 11e6

# 1e-5 m open under an effective stress of 39 MPa.
[fracture.fracture]
aperture = 4e-4
normal_stiffness = 1e11
shear_stiffness = 1e11
closure = "linear"

[initial_stress]
xx = -24e6
yy = -24e6
zz = -50e6

[boundary.left]
symmetry = true
fluid_pressure = 11.9e6
history = [[0, 1], [100, 1]]

[boundary.right]
symmetry = true
fluid_pressure = 11e6
history = [[0, 1], [100, 1]]

[boundary.front]
symmetry = true

[boundary.back]
symmetry = true

[boundary.bottom]
symmetry = true

[boundary.top]
pressure = 50e6
history = [[0, 1], [100, 1]]

[load]
times = [10, 20, 30, 40, 50, 60, 70, 80, 90, 100]
"""

PROJECT = """<?xml version="1.0" encoding="ISO-8859-1"?>
<OpenGeoSysProject>
    <meshes>
        <mesh>bulk.vtu</mesh>
{meshes}
    </meshes>
    <processes>
        <process>
            <name>HM</name>
            <type>HYDRO_MECHANICS_WITH_LIE</type>
            <integration_order>2</integration_order>
            <process_variables>
                <process_variable>pressure</process_variable>
                <process_variable>displacement</process_variable>
                <process_variable>displacement_jump1</process_variable>
            </process_variables>
            <constitutive_relation>
                <type>LinearElasticIsotropic</type>
                <youngs_modulus>E</youngs_modulus>
                <poissons_ratio>zero</poissons_ratio>
            </constitutive_relation>
            <specific_body_force>0 0 0</specific_body_force>
            <initial_effective_stress>stress0</initial_effective_stress>
            <fracture_model>
                <type>LinearElasticIsotropic</type>
                <normal_stiffness>K</normal_stiffness>
                <shear_stiffness>K</shear_stiffness>
                <penalty_aperture_cutoff>1e-5</penalty_aperture_cutoff>
                <tension_cutoff>1</tension_cutoff>
            </fracture_model>
            <fracture_properties>
                <material_id>1</material_id>
                <initial_aperture>aperture0</initial_aperture>
            </fracture_properties>
            <initial_fracture_effective_stress>traction0</initial_fracture_effective_stress>
            <deactivate_matrix_in_flow>true</deactivate_matrix_in_flow>
        </process>
    </processes>
    <time_loop>
        <processes>
            <process ref="HM">
                <nonlinear_solver>newton</nonlinear_solver>
                <convergence_criterion>
                    <type>PerComponentResidual</type>
                    <norm_type>NORM2</norm_type>
                    <abstols>1e-16 1e-5 1e-5 1e-5 1e-6 1e-6 1e-6 1e-16 1e-16 1e-16</abstols>
                </convergence_criterion>
                <time_discretization>
                    <type>BackwardEuler</type>
                </time_discretization>
                <time_stepping>
                    <type>FixedTimeStepping</type>
                    <t_initial>0</t_initial>
                    <t_end>100</t_end>
                    <timesteps>
                        <pair>
                            <repeat>10</repeat>
                            <delta_t>10</delta_t>
                        </pair>
                    </timesteps>
                </time_stepping>
            </process>
        </processes>
        <output>
            <type>VTK</type>
            <prefix>result</prefix>
            <suffix>_{{:timestep}}</suffix>
            <timesteps>
                <pair>
                    <repeat>1</repeat>
                    <each_steps>10</each_steps>
                </pair>
            </timesteps>
            <variables>
                <variable>pressure</variable>
                <variable>displacement_jump1</variable>
                <variable>fracture_aperture_avg</variable>
                <variable>MaterialIDs</variable>
            </variables>
        </output>
    </time_loop>
    <media>
{media}
    </media>
    <parameters>
{parameters}
    </parameters>
    <process_variables>
{variables}
    </process_variables>
    <nonlinear_solvers>
        <nonlinear_solver>
            <name>newton</name>
            <type>Newton</type>
            <max_iter>15</max_iter>
            <linear_solver>linear</linear_solver>
        </nonlinear_solver>
    </nonlinear_solvers>
    <linear_solvers>
        <linear_solver>
            <name>linear</name>
            <eigen>
                <solver_type>{solver}</solver_type>
                <precon_type>{preconditioner}</precon_type>
                <scaling>1</scaling>
                <max_iteration_step>10000</max_iteration_step>
                <error_tolerance>1e-12</error_tolerance>
            </eigen>
        </linear_solver>
    </linear_solvers>
</OpenGeoSysProject>
"""

MEDIUM = """        <medium id="{number}">
            <phases>
                <phase>
                    <type>AqueousLiquid</type>
                    <properties>
                        <property><name>viscosity</name><type>Constant</type><value>1e-3</value></property>
                        <property><name>density</name><type>Constant</type><value>1e3</value></property>
                    </properties>
                </phase>
                <phase>
                    <type>Solid</type>
                    <properties>
                        <property><name>density</name><type>Constant</type><value>0</value></property>
                    </properties>
                </phase>
            </phases>
            <properties>
{properties}
                <property><name>biot_coefficient</name><type>Constant</type><value>1</value></property>
                <property><name>reference_temperature</name><type>Constant</type><value>293.15</value></property>
            </properties>
        </medium>"""

OF_ROCK = """                <property><name>permeability</name><type>Constant</type><value>1e-21</value></property>
                <property><name>porosity</name><type>Constant</type><value>1e-3</value></property>
                <property><name>storage</name><type>Constant</type><value>1e-10</value></property>"""

OF_JOINT = """                <property><name>permeability</name><type>CubicLawPermeability</type></property>
                <property><name>storage</name><type>Constant</type><value>1e-16</value></property>"""

VALUES = {
    "K": "1e11",
    "aperture0": "1e-5",
    "zero": "0",
    "rest": "0 0 0",
    "load": "-50e6",
    "p0": "11e6",
    "p_in": "11.9e6",
    "stress0": "-13e6 -13e6 -39e6 0 0 0",
    "traction0": "0 0 -39e6",
}

PARAMETER = "        <parameter><name>{}</name><type>Constant</type><values>{}</values></parameter>"

VARIABLE = """        <process_variable>
            <name>{name}</name>
            <components>{components}</components>
            <order>1</order>
            <initial_condition>{initial}</initial_condition>
            <boundary_conditions>
{conditions}
            </boundary_conditions>
        </process_variable>"""

SIDES = {"left": 0, "right": 0, "front": 1, "back": 1, "bottom": 2}
"""The component of displacement that each side holds."""


def box(name):
    """The mesh of a name."""
    nx, ny, nz = MESHES[name]
    along = LENGTH * np.linspace(0.0, 1.0, nx + 1) ** GROWTH
    z, y, x = np.meshgrid(np.linspace(0.0, 1.0, nz + 1), np.linspace(0.0, 1.0, ny + 1), along, indexing="ij")
    points = np.column_stack([x.ravel(), y.ravel(), z.ravel()])
    hexahedra = grid_hexahedra(nx, ny, nz)
    cells = hexahedra if name == "hex" else hexahedra[:, KUHN].reshape(-1, 4)
    every, _ = faces(cells)
    on = np.abs(points[:, 2] - 0.5) < EPSILON
    mesh = Mesh(points, cells, every[on[every].all(axis=1)])
    add_outer_faces(mesh)
    add_traces(mesh, ["left", "right", "front", "back"])
    return mesh


def condition(mesh, component, parameter, kind="Dirichlet"):
    """A condition on a component of a variable."""
    return opengeosys.CONDITION.format(mesh, kind, component, parameter)


def project(solver, young):
    """The text of OpenGeoSys' project, and the names of the patches it needs."""
    names = [*SIDES, "top", *(f"fracture_{side}" for side in ("left", "right", "front", "back"))]
    pressure = [condition("fracture_left", 0, "p_in"), condition("fracture_right", 0, "p0")]
    held = [condition(side, component, "zero") for side, component in SIDES.items()]
    jumps = [
        condition(f"fracture_{side}", component, "zero") for side, component in SIDES.items() if side != "bottom"
    ]
    variables = [
        ("pressure", 1, "p0", pressure),
        ("displacement", 3, "rest", [*held, condition("top", 2, "load", "Neumann")]),
        ("displacement_jump1", 3, "rest", jumps),
    ]
    text = PROJECT.format(
        meshes="\n".join(f"        <mesh>{name}.vtu</mesh>" for name in names),
        media="\n".join(MEDIUM.format(number=n, properties=of) for n, of in enumerate((OF_ROCK, OF_JOINT))),
        parameters="\n".join(PARAMETER.format(*item) for item in (VALUES | {"E": young}).items()),
        variables="\n".join(
            VARIABLE.format(name=name, components=count, initial=initial, conditions="\n".join(conditions))
            for name, count, initial, conditions in variables
        ),
        solver=solver,
        preconditioner=SOLVERS[solver],
    )
    return text, names


def write(mesh, young, folder):
    """Writes the input of both programs; `young` is the modulus of the rock (Pa)."""
    folder.mkdir(parents=True, exist_ok=True)
    write_msh(mesh, folder / "mesh.msh", [*SIDES, "top"])
    scene = SCENE.replace("{young}", young)
    (folder / "scene.toml").write_text(scene)
    (folder / "given.toml").write_text(scene + "\n[solver]\ntime_accuracy = 1\n")
    blocks = [(3, mesh.cells), (2, mesh.facets)]
    material = np.repeat([0, 1], [len(mesh.cells), len(mesh.facets)]).astype(np.int32)
    vtu.write(folder / "bulk.vtu", mesh.points, blocks, {}, {"MaterialIDs": material})
    for solver in SOLVERS:
        text, names = project(solver, young)
        (folder / f"{solver}.prj").write_text(text)
    for name in names:
        opengeosys.write_patch(mesh, mesh.patches[name], folder / f"{name}.vtu")


def similarity(places):
    """Apertures (m) of the similarity solution at places (m) after 100 s: shooting for the flux at the inlet."""
    k = lambda b: b**3 * STIFFNESS / (12 * VISCOSITY)
    reach = 14 * np.sqrt(k(INITIAL + OPENED))
    steps = 4000
    h = reach / steps

    def slope(xi, state):
        change = state[1] / k(state[0])
        return np.array([change, -0.5 * xi * change])

    def profile(flux):
        state, found = np.array([INITIAL + OPENED, -flux]), []
        for index in range(steps + 1):
            found.append(state[0])
            if state[0] < INITIAL:
                break
            xi = index * h
            first = slope(xi, state)
            second = slope(xi + h / 2, state + h / 2 * first)
            third = slope(xi + h / 2, state + h / 2 * second)
            fourth = slope(xi + h, state + h * third)
            state = state + h / 6 * (first + 2 * second + 2 * third + fourth)
        return np.array(found)

    low, high = 0.0, 4 * np.sqrt(k(INITIAL + OPENED)) * OPENED
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if profile(middle)[-1] > INITIAL else (low, middle)
    found = profile(low)
    return np.interp(places / np.sqrt(END), h * np.arange(len(found)), found)


def of_kluft(folder):
    """Places along the joint (m) and mean apertures (m) of the facets; Newton and linear iterations."""
    points, (offsets, nodes), data, _ = vtu.read(sorted(folder.glob("fractures*.vtu"))[-1])
    count = np.diff(offsets)
    mean = lambda values: np.add.reduceat(values[nodes], offsets[:-1]) / count
    steps = json.loads((folder / "summary.json").read_text())["steps"]
    totals = [sum(step[key] for step in steps) for key in ("newton_iterations", "linear_iterations")]
    return mean(points[:, 0]), mean(data["aperture"].ravel()), totals


def of_opengeosys(folder):
    """The same."""
    points, (offsets, nodes), _, data = vtu.read(folder / "result_10.vtu")
    on = np.flatnonzero(data["MaterialIDs"] == 1)
    places = np.array([points[nodes[offsets[cell] : offsets[cell + 1]], 0].mean() for cell in on])
    return places, data["fracture_aperture_avg"][on].ravel(), opengeosys.iterations(folder)


def run(kluft, name, program, solver):
    """Runs a program on the mesh of a name: a row of the table."""
    folder = ROOT / "target/peers/filling" / name
    out = folder / f"{program}-{solver}"
    shutil.rmtree(out, ignore_errors=True)
    out.mkdir(parents=True)
    programs = ROOT / "target/peers/venv/bin"
    if program == "Kluft":
        command = [kluft, "run", folder / f"{solver}.toml", "--out", out / "results", "--threads", "1"]
    else:
        command = [programs / "python", programs / "ogs", "-o", out, folder / f"{solver}.prj"]
    measured = [sys.executable, Path(__file__).with_name("measure.py"), out / "log", *command]
    done = subprocess.run([*map(str, measured)], stdout=subprocess.PIPE, text=True, env=os.environ | {"OMP_NUM_THREADS": "1"})
    row = {"mesh": name, "program": program, "solver": solver, **json.loads(done.stdout)}
    if done.returncode:
        return row | {"failed": (out / "log").read_text(errors="replace").strip().split("\n")[-1]}
    places, apertures, (newton, linear) = of_kluft(out / "results") if program == "Kluft" else of_opengeosys(out)
    off = np.abs(apertures / similarity(places) - 1)
    # The first cells carry the mean of what changes over their length.
    inlet = off[places <= places.min() + 1e-3].max()
    return row | {"newton": newton, "linear": linear, "inlet": inlet, "largest": off.max()}


def table(rows):
    """The rows as a table of Markdown."""
    head = "case|program|solver|s|processor s|MB|Newton|linear iterations|aperture at the inlet|largest error of an aperture"
    lines = ["| " + head.replace("|", " | ") + " |", "|---" * 10 + "|"]
    for row in rows:
        numbers = [f"{row['seconds']:.2f}", f"{row['processor_seconds']:.2f}", f"{row['peak_memory_bytes'] / 1e6:.0f}"]
        errors = [f"{100 * row[key]:.2f} %" for key in ("inlet", "largest")] if "inlet" in row else ["failed", ""]
        counts = [str(row.get(key, "")) for key in ("newton", "linear")]
        lines.append("| " + " | ".join([row["mesh"], row["program"], row["solver"], *numbers, *counts, *errors]) + " |")
    return "\n".join(lines)


def main():
    """Runs what is named, and writes the page from all that is kept."""
    kluft, *names = sys.argv[1:]
    kept = json.loads(KEPT.read_text()) if KEPT.exists() else {}
    for name in names or ["hex", "tet", "soft"]:
        mesh = box(name)
        write(mesh, SOFT if name == "soft" else "60e9", ROOT / "target/peers/filling" / name)
        tried = ["BiCGSTAB"] if name == "fine" else SOLVERS
        pairs = [("Kluft", "scene"), ("Kluft", "given"), *(("OpenGeoSys", solver) for solver in tried)]
        for program, solver in pairs:
            row = run(Path(kluft).resolve(), name, program, solver)
            print(row, flush=True)
            kept[f"{name} {program} {solver}"] = row
            KEPT.write_text(json.dumps(kept, indent=1))
    rows = [row for mesh in MESHES for row in kept.values() if row["mesh"] == mesh]
    PAGE.write_text(page(rows))


def page(rows):
    """The text of the page."""
    sizes = {name: (nx + 1) * (ny + 1) * (nz + 2) * 3 for name, (nx, ny, nz) in MESHES.items()}
    told = ", ".join(f"`{name}` {size}" for name, size in sizes.items())
    text = f"""Written by `python benches/peers/filling.py`, in the environment that `benches/peers/setup` makes. A joint
through a box of 25 x 1 x 1 m fills with water from one end and opens, ten steps of 10 s: OpenGeoSys' own benchmark
`single_fracture_3D` in impermeable rock, displacements of first order, both programs on the same nodes and cells and
on one thread. Errors are those of mean apertures of facets against the similarity solution (Wijesinghe 1986), in which
the rock carries nothing from one part of the joint to the next. In rock of 60 GPa it does, and spreads the opening at
the inlet; in the case `soft` (10 MPa) it does not. Unknown components of displacements and jumps: {told}. `scene`
divides steps for the accuracy in time, as by default; `given` takes them as they are, as OpenGeoSys does. Times are of
whole runs."""
    return f"# A joint that fills, beside OpenGeoSys\n\n{textwrap.fill(text, 100)}\n\n{table(rows)}\n"


main()
