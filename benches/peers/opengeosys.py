"""OpenGeoSys (process SMALL_DEFORMATION_WITH_LIE): its input files, its command, its results."""

import re
import shutil

import numpy as np
from scipy.sparse import csr_array

import problems
import vtu

PROJECT = """<?xml version="1.0" encoding="ISO-8859-1"?>
<OpenGeoSysProject>
    <meshes>
        <mesh>bulk.vtu</mesh>
{meshes}
    </meshes>
    <processes>
        <process>
            <name>SD</name>
            <type>SMALL_DEFORMATION_WITH_LIE</type>
            <integration_order>{integration_order}</integration_order>
            <process_variables>
                <process_variable>displacement</process_variable>
                <process_variable>displacement_jump1</process_variable>
            </process_variables>
            <constitutive_relation>
                <type>LinearElasticIsotropic</type>
                <youngs_modulus>E</youngs_modulus>
                <poissons_ratio>nu</poissons_ratio>
            </constitutive_relation>
            <fracture_model>
                <type>LinearElasticIsotropic</type>
                <normal_stiffness>K</normal_stiffness>
                <shear_stiffness>K</shear_stiffness>
                <penalty_aperture_cutoff>{cutoff!r}</penalty_aperture_cutoff>
                <tension_cutoff>0</tension_cutoff>
            </fracture_model>
            <fracture_properties>
                <material_id>1</material_id>
                <initial_aperture>aperture0</initial_aperture>
            </fracture_properties>
        </process>
    </processes>
    <time_loop>
        <processes>
            <process ref="SD">
                <nonlinear_solver>newton</nonlinear_solver>
                <convergence_criterion>
                    <type>Residual</type>
                    <norm_type>NORM2</norm_type>
                    <reltol>1e-8</reltol>
                </convergence_criterion>
                <time_discretization>
                    <type>BackwardEuler</type>
                </time_discretization>
                <time_stepping>
                    <type>FixedTimeStepping</type>
                    <t_initial>0</t_initial>
                    <t_end>1</t_end>
                    <timesteps>
                        <pair>
                            <repeat>1</repeat>
                            <delta_t>1</delta_t>
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
                    <each_steps>1</each_steps>
                </pair>
            </timesteps>
            <variables>
                <variable>displacement</variable>
                <variable>displacement_jump1</variable>
                <variable>sigma_avg</variable>
                <variable>fracture_stress_avg</variable>
                <variable>fracture_aperture_avg</variable>
                <variable>MaterialIDs</variable>
            </variables>
        </output>
    </time_loop>
    <parameters>
{parameters}
        <parameter>
            <name>rest</name>
            <type>Constant</type>
            <values>0 0 0</values>
        </parameter>
    </parameters>
    <process_variables>
        <process_variable>
            <name>displacement</name>
            <components>3</components>
            <order>{order}</order>
            <initial_condition>rest</initial_condition>
            <boundary_conditions>
{displacement}
            </boundary_conditions>
        </process_variable>
        <process_variable>
            <name>displacement_jump1</name>
            <components>3</components>
            <order>{order}</order>
            <initial_condition>rest</initial_condition>
            <boundary_conditions>
{jump}
            </boundary_conditions>
        </process_variable>
    </process_variables>
    <nonlinear_solvers>
        <nonlinear_solver>
            <name>newton</name>
            <type>Newton</type>
            <max_iter>50</max_iter>
            <linear_solver>linear</linear_solver>
        </nonlinear_solver>
    </nonlinear_solvers>
    <linear_solvers>
        <linear_solver>
            <name>linear</name>
            <eigen>
                <solver_type>CG</solver_type>
                <precon_type>DIAGONAL</precon_type>
                <triangular_matrix>LowerUpper</triangular_matrix>
                <max_iteration_step>20000</max_iteration_step>
                <error_tolerance>1e-10</error_tolerance>
            </eigen>
        </linear_solver>
    </linear_solvers>
</OpenGeoSysProject>
"""

PARAMETER = """        <parameter>
            <name>{}</name>
            <type>Constant</type>
            <value>{!r}</value>
        </parameter>"""

CONDITION = """                <boundary_condition>
                    <mesh>{}</mesh>
                    <type>{}</type>
                    <component>{}</component>
                    <parameter>{}</parameter>
                </boundary_condition>"""


def write(problem, mesh, folder):
    """Writes the project and its meshes. The fastest solver of the package that was found: CG on all threads."""
    blocks = [(3, mesh.cells), (2, mesh.facets)]
    material = np.repeat([0, 1], [len(mesh.cells), len(mesh.facets)]).astype(np.int32)
    vtu.write(folder / "bulk.vtu", mesh.points, blocks, {}, {"MaterialIDs": material})
    names = sorted({name for name, _ in problem.held + problem.jumps} | {"top"})
    for name in names:
        write_patch(mesh, mesh.patches[name], folder / f"{name}.vtu")
    (folder / "closed.prj").write_text(project(problem, names, problems.LOAD))
    (folder / "opened.prj").write_text(project(problem, names, -problems.LOAD))


def project(problem, names, pressure):
    """The text of the project; `names` are those of the patches that conditions act on."""
    values = {
        "E": problems.YOUNG_MODULUS,
        "nu": problems.POISSON_RATIO,
        "K": problems.STIFFNESS,
        "aperture0": problems.APERTURE,
        "load": -pressure,
        "zero": 0.0,
    }
    displacement = [CONDITION.format(name, "Dirichlet", component, "zero") for name, component in problem.held]
    displacement.append(CONDITION.format("top", "Neumann", 2, "load"))
    jump = [
        CONDITION.format(name, "Dirichlet", component, "zero")
        for name, components in problem.jumps
        for component in components
    ]
    return PROJECT.format(
        meshes="\n".join(f"        <mesh>{name}.vtu</mesh>" for name in names),
        cutoff=problems.CUTOFF,
        order=1,
        integration_order=2,
        parameters="\n".join(PARAMETER.format(*item) for item in values.items()),
        displacement="\n".join(displacement),
        jump="\n".join(jump),
    )


def write_patch(mesh, elements, path):
    """Writes the elements of a face, a line or points with the numbers of their nodes and cells in the whole mesh."""
    nodes = np.unique(elements)
    own = np.searchsorted(nodes, elements)
    dimension = {1: 0, 2: 1}.get(elements.shape[1], 2)
    point_data = {"bulk_node_ids": nodes.astype(np.uint64)}
    cell_data = {"bulk_element_ids": owners(mesh, elements).astype(np.uint64)}
    vtu.write(path, mesh.points[nodes], [(dimension, own)], point_data, cell_data)


def owners(mesh, elements):
    """For every element the first cell that has all its nodes."""
    shared = incidence(elements, len(mesh.points)) @ incidence(mesh.cells, len(mesh.points)).T
    shared = shared.tocoo()
    whole = shared.data == elements.shape[1]
    _, first = np.unique(shared.row[whole], return_index=True)
    return shared.col[whole][first]


def incidence(elements, count):
    """The matrix with a one where the element of a row has the node of a column."""
    width = elements.shape[1]
    starts = np.arange(0, elements.size + 1, width)
    return csr_array((np.ones(elements.size, dtype=np.int8), elements.ravel(), starts), shape=(len(elements), count))


def command(root, folder, case="closed"):
    """What to run: the package's `ogs`, writing its results into `folder`/out."""
    shutil.rmtree(folder / "out", ignore_errors=True)
    (folder / "out").mkdir()
    # By its interpreter, because the first line of a script names the folder in which it was installed.
    programs = root / "target/peers/venv/bin"
    return [programs / "python", programs / "ogs", "-o", folder / "out", folder / f"{case}.prj"]


def facets(folder):
    """Centres (m) and mean apertures (m) of all facets after the load step."""
    points, (offsets, nodes), _, data = vtu.read(folder / "out/result_1.vtu")
    on = np.flatnonzero(data["MaterialIDs"] == 1)
    centres = np.array([points[nodes[offsets[cell] : offsets[cell + 1]]].mean(axis=0) for cell in on])
    return centres, data["fracture_aperture_avg"][on].ravel()


def iterations(folder):
    """Newton iterations, and the sum of the iterations of the linear solver, from what `ogs` printed."""
    log = (folder / "log").read_text(errors="replace")
    newton = len(re.findall(r"Iteration #\d+ started", log))
    return newton, sum(int(count) for count in re.findall(r"iteration: (\d+)/", log))
