"""The sections of a scene as classes; made from the table of keys, do not edit.

Every class takes the keys of its section as keywords. Numbers are in the unit that is given; a text
has its unit with it: `"60 GPa"`. What is left out has the value of a scene file without the key.
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import Any, Literal, TypeAlias

Quantity: TypeAlias = float | str
"""A number in SI units, or a text with a number and its unit."""


class Section:
    """Keys of a section with their values."""

    def __init__(self, **keys: Any) -> None:
        self.tables: dict[str, Any] = {key: value for key, value in keys.items() if value is not None}
        """The keys that are given."""

    def __repr__(self) -> str:
        keys = ", ".join(f"{key}={value!r}" for key, value in self.tables.items())
        return f"{type(self).__name__}({keys})"


class Probe(Section):
    """Points or surfaces whose values `probes.csv` has after each load step, in rock or on fractures.

    Args:
        at: One point (m). Required, unless the other is given, or all of a surface is meant.
        from_: Where a line begins (m). Required, unless the other is given, or all of a surface is
            meant.
        to: Where it ends (m). Without it: required with `from`.
        count: Points on the line, both ends included; 2 to 10000. Without it 11.
        across: Vector by which the last of `rows` lines is moved from the first: a plane (m).
            Without it: a line.
        rows: Lines of a plane; 2 to 10000. Without it 11.
        fracture: The fracture whose nearest nodes are taken, with aperture, jump and tractions, and
            with `[fluid]` pressure and hydraulic aperture; without points, their mean by area over
            all of it. Without it: in the rock.
        boundary: The part of the outer surface over which displacement, stress and strain are
            averaged by area. Without it: in the rock.
        mean: Whether the mean of the points is written instead of each; over a whole surface it
            always is. Without it false.
    """

    def __init__(
        self,
        *,
        at: Sequence[Quantity] | None = None,
        from_: Sequence[Quantity] | None = None,
        to: Sequence[Quantity] | None = None,
        count: int | None = None,
        across: Sequence[Quantity] | None = None,
        rows: int | None = None,
        fracture: str | None = None,
        boundary: str | None = None,
        mean: bool | None = None,
    ) -> None:
        super().__init__(
            at=at,
            **{"from": from_},
            to=to,
            count=count,
            across=across,
            rows=rows,
            fracture=fracture,
            boundary=boundary,
            mean=mean,
        )


class Oracle(Section):
    """A closed form to compare the fracture NAME with.

    Args:
        form: A disc (penny) or a strip in plane strain (line) in unbounded rock, a uniform jump, a
            joint that carries a pressure (column), or one between core and shell (sphere).
            Required.
        centre: Centre of a penny, or a point of the middle of a line (m). Required, unless the form
            is neither penny nor line.
        radius: Radius of a penny, or of the joint in a sphere (m); > 0. Required, unless the form
            is neither penny nor sphere.
        outer_radius: Radius of the shell around the joint of a sphere (m); > 0. Required, unless
            the form is no sphere.
        along: Direction from the middle of a line to its front. Required, unless the form is no
            line.
        half_length: Half the length of a line (m); > 0. Required, unless the form is no line.
        pressure: Pressure that opens a penny or line; that closes a column (without fluid
            pressure), or acts outside of a sphere, required there (Pa). Without it: not compared.
        stress_drop: Stress drop that shears a penny or line (Pa). Without it: not compared.
        opening: Opening of a uniform jump (m). Without it: not compared.
        slip: Magnitude of the slip of a uniform jump (m). Without it: not compared.
        normal_traction: Normal traction everywhere, tension positive (Pa). Without it: not
            compared.
        ring: Share of the radius next to the front that measures "inside" leave out; > 0, < 1.
            Without it 0.1.
    """

    def __init__(
        self,
        *,
        form: Literal["penny", "line", "uniform", "column", "sphere"] | None = None,
        centre: Sequence[Quantity] | None = None,
        radius: Quantity | None = None,
        outer_radius: Quantity | None = None,
        along: Sequence[Quantity] | None = None,
        half_length: Quantity | None = None,
        pressure: Quantity | None = None,
        stress_drop: Quantity | None = None,
        opening: Quantity | None = None,
        slip: Quantity | None = None,
        normal_traction: Quantity | None = None,
        ring: Quantity | None = None,
    ) -> None:
        super().__init__(
            form=form,
            centre=centre,
            radius=radius,
            outer_radius=outer_radius,
            along=along,
            half_length=half_length,
            pressure=pressure,
            stress_drop=stress_drop,
            opening=opening,
            slip=slip,
            normal_traction=normal_traction,
            ring=ring,
        )


class Warnings(Section):
    """What is possible but hardly meant is warned of; here stands what is meant.

    Args:
        silence: Warnings that are left out; each warning ends with its name. Without it [].
    """

    def __init__(
        self,
        *,
        silence: Sequence[Literal["values", "body_size", "wide_apertures", "large_displacements", "idle_histories", "initial_stress", "unnamed_surfaces", "overlapping_walls", "not_unique", "unresolved_path", "long_time_steps", "fluid_times", "point_contacts"]] | None = None,
    ) -> None:
        super().__init__(
            silence=silence,
        )


class StrengthReduction(Section):
    """Friction and cohesion divided by a growing factor until blocks move: the factor of safety.

    Args:
        fractures: Fractures whose strength is reduced. Without it: all that have friction.
        accuracy: Largest difference between the last stable and the first failing factor, as a
            share of the former; 0.000001 to 0.5. Without it 0.01.
        most: Factor at which the search ends, if nothing has moved by then; 1 to 1000000. Without
            it 10.
    """

    def __init__(
        self,
        *,
        fractures: Sequence[str] | None = None,
        accuracy: Quantity | None = None,
        most: Quantity | None = None,
    ) -> None:
        super().__init__(
            fractures=fractures,
            accuracy=accuracy,
            most=most,
        )


class Solver(Section):
    """What is asked of the solver, only to overrule the program.

    Args:
        linear: The linear solver; without it the program chooses. Without it: the cheapest.
        memory_limit: Memory that the linear solver may take (bytes); > 0. Without it: what is free.
        path_accuracy: Largest difference between a part of the way in one go and in two, against
            the largest jump; > 0, < 1. Without it 1e-3.
        time_accuracy: Largest difference between a step in time in one go and in two, of jumps and
            pressures of a flow against the largest; from 1 on steps are taken as they are given; >
            0. Without it 1e-2.
        facets: Where fractures are evaluated: at nodes, or for comparison at Gauss points. Without
            it "nodal".
    """

    def __init__(
        self,
        *,
        linear: Literal["direct", "condensed", "iterative"] | None = None,
        memory_limit: Quantity | None = None,
        path_accuracy: Quantity | None = None,
        time_accuracy: Quantity | None = None,
        facets: Literal["nodal", "gauss"] | None = None,
    ) -> None:
        super().__init__(
            linear=linear,
            memory_limit=memory_limit,
            path_accuracy=path_accuracy,
            time_accuracy=time_accuracy,
            facets=facets,
        )


class Phase(Section):
    """Load steps with a name.

    Args:
        name: What the report and `summary.json` call it. Required.
        until: End of the phase; the first begins at 0 (time); > 0. Required.
        steps: Number of equal load steps in the phase; 1 to 100000. Without it 1.
        remove: Physical volumes that are not there from its beginning on, with the fractures in
            them; and fractures whose walls are one from then on, as far apart as they are. Without
            it: nothing.
        add: Physical volumes and fractures that are there from its beginning on, free of stress;
            one that none has removed before is not there until then. Without it: nothing.
        added_as: Rock of what it adds, a section `[rock.NAME]`. Without it: the rock of the volume.
        release: Share, of the forces that hold the walls of what was removed or cut at its
            beginning, that it lets go step by step; 0 to 1. Without it 1.
    """

    def __init__(
        self,
        *,
        name: str | None = None,
        until: float | None = None,
        steps: int | None = None,
        remove: Sequence[str] | None = None,
        add: Sequence[str] | None = None,
        added_as: str | None = None,
        release: Quantity | None = None,
    ) -> None:
        super().__init__(
            name=name,
            until=until,
            steps=steps,
            remove=remove,
            add=add,
            added_as=added_as,
            release=release,
        )


class Load(Section):
    """Load steps: one of `steps`, `times` and `phase`.

    Args:
        steps: One load step for each factor on everything; `[1.0]` without `[load]`. Required,
            unless there are `times` or phases.
        times: Ends of the load steps, ascending; for histories (time); > 0. Without it: none.
        phase: Load steps with a name; for histories. Without it: none.
    """

    def __init__(
        self,
        *,
        steps: Sequence[Quantity] | None = None,
        times: Sequence[float] | None = None,
        phase: Sequence[Phase | Mapping[str, Any]] | None = None,
    ) -> None:
        super().__init__(
            steps=steps,
            times=times,
            phase=phase,
        )


class StressProfile(Section):
    """A component `value + per_metre (z - at)`, or one that varies otherwise.

    Args:
        value: Stress at the elevation `at` (Pa); -1e12 to 1e12. Required.
        per_metre: Increase with the elevation (Pa/m); -1e9 to 1e9. Without it 0.
        at: Elevation of `value`, positive upwards (m). Without it 0.
        table: Rows `[coordinate, value]` with linear values between, in any order. Without it:
            `expression` or `file`.
        over: What the rows of the table are over; the time is that of the load steps. Without it:
            required with `table`.
        ground: Elevation z of the ground: the depth is `ground` - z (m). Without it 0.
        expression: Value by x, y, z, depth (m) and time, with + - * / ^, min(a, b), max(a, b),
            sqrt, exp, ln, log10, sin, cos, tan, abs, step (0 below 0, else 1) and PI. Without it:
            `table` or `file`.
        file: CSV file of samples: columns x, y, z (m), of which those may be missing along which
            nothing varies; or a grid of VTK (.vtu), whose values stand at its points, or in the
            middle of its cells. Without it: `table` or `expression`.
        column: Column, or array of the grid, with the values. Without it: required with `file`.
        method: Between samples: the nearest one, or linear along their line, in the Delaunay
            triangles of their plane, or on their grid. Without it "nearest".
        reach: Largest distance from a sample: a point beyond it is a gap, and refused (m); > 0.
            Without it: any; the run tells the largest.
        beyond: Beyond the table or the samples between which values are linear: a defect, or the
            nearest value. Without it "refuse".
        unit: Unit of the values. Without it: SI units, angles in degrees.
    """

    def __init__(
        self,
        *,
        value: Quantity | None = None,
        per_metre: Quantity | None = None,
        at: Quantity | None = None,
        table: Sequence[Sequence[float]] | None = None,
        over: Literal["x", "y", "z", "depth", "time"] | None = None,
        ground: Quantity | None = None,
        expression: str | None = None,
        file: str | os.PathLike[str] | None = None,
        column: str | None = None,
        method: Literal["nearest", "linear"] | None = None,
        reach: Quantity | None = None,
        beyond: Literal["refuse", "nearest"] | None = None,
        unit: str | None = None,
    ) -> None:
        super().__init__(
            value=value,
            per_metre=per_metre,
            at=at,
            table=table,
            over=over,
            ground=ground,
            expression=expression,
            file=file,
            column=column,
            method=method,
            reach=reach,
            beyond=beyond,
            unit=unit,
        )


class InitialStress(Section):
    """Stress that rock and fractures are in equilibrium with before any load.

    Args:
        xx: Component of the stress, tension positive: constant, linear in the elevation, or any
            value that varies but not with time (Pa); -1e12 to 1e12. Without it 0.
        yy: Component of the stress, tension positive: constant, linear in the elevation, or any
            value that varies but not with time (Pa); -1e12 to 1e12. Without it 0.
        zz: Component of the stress, tension positive: constant, linear in the elevation, or any
            value that varies but not with time (Pa); -1e12 to 1e12. Without it 0.
        xy: Component of the stress, tension positive: constant, linear in the elevation, or any
            value that varies but not with time (Pa); -1e12 to 1e12. Without it 0.
        yz: Component of the stress, tension positive: constant, linear in the elevation, or any
            value that varies but not with time (Pa); -1e12 to 1e12. Without it 0.
        xz: Component of the stress, tension positive: constant, linear in the elevation, or any
            value that varies but not with time (Pa); -1e12 to 1e12. Without it 0.
    """

    def __init__(
        self,
        *,
        xx: Quantity | StressProfile | Mapping[str, Any] | None = None,
        yy: Quantity | StressProfile | Mapping[str, Any] | None = None,
        zz: Quantity | StressProfile | Mapping[str, Any] | None = None,
        xy: Quantity | StressProfile | Mapping[str, Any] | None = None,
        yz: Quantity | StressProfile | Mapping[str, Any] | None = None,
        xz: Quantity | StressProfile | Mapping[str, Any] | None = None,
    ) -> None:
        super().__init__(
            xx=xx,
            yy=yy,
            zz=zz,
            xy=xy,
            yz=yz,
            xz=xz,
        )


class SourcePressure(Section):
    """Pressure `value + per_metre (z - at)`, or one that varies.

    Args:
        value: Pressure at the elevation `at` (Pa); -1e12 to 1e12. This or `water_table` is
            required.
        per_metre: Increase with the elevation (Pa/m); -1e9 to 1e9. Without it 0.
        at: Elevation of `value`, positive upwards (m). Without it 0.
        water_table: Instead: elevation below which a fluid at rest has this pressure, by `density`
            and gravity; 0 there, negative above (m). This or `value` is required.
        table: Rows `[coordinate, value]` with linear values between, in any order. Without it:
            `expression` or `file`.
        over: What the rows of the table are over; the time is that of the load steps. Without it:
            required with `table`.
        ground: Elevation z of the ground: the depth is `ground` - z (m). Without it 0.
        expression: Value by x, y, z, depth (m) and time, with + - * / ^, min(a, b), max(a, b),
            sqrt, exp, ln, log10, sin, cos, tan, abs, step (0 below 0, else 1) and PI. Without it:
            `table` or `file`.
        file: CSV file of samples: columns x, y, z (m), of which those may be missing along which
            nothing varies; or a grid of VTK (.vtu), whose values stand at its points, or in the
            middle of its cells. Without it: `table` or `expression`.
        column: Column, or array of the grid, with the values. Without it: required with `file`.
        method: Between samples: the nearest one, or linear along their line, in the Delaunay
            triangles of their plane, or on their grid. Without it "nearest".
        reach: Largest distance from a sample: a point beyond it is a gap, and refused (m); > 0.
            Without it: any; the run tells the largest.
        beyond: Beyond the table or the samples between which values are linear: a defect, or the
            nearest value. Without it "refuse".
        unit: Unit of the values. Without it: SI units, angles in degrees.
    """

    def __init__(
        self,
        *,
        value: Quantity | None = None,
        per_metre: Quantity | None = None,
        at: Quantity | None = None,
        water_table: Quantity | None = None,
        table: Sequence[Sequence[float]] | None = None,
        over: Literal["x", "y", "z", "depth", "time"] | None = None,
        ground: Quantity | None = None,
        expression: str | None = None,
        file: str | os.PathLike[str] | None = None,
        column: str | None = None,
        method: Literal["nearest", "linear"] | None = None,
        reach: Quantity | None = None,
        beyond: Literal["refuse", "nearest"] | None = None,
        unit: str | None = None,
    ) -> None:
        super().__init__(
            value=value,
            per_metre=per_metre,
            at=at,
            water_table=water_table,
            table=table,
            over=over,
            ground=ground,
            expression=expression,
            file=file,
            column=column,
            method=method,
            reach=reach,
            beyond=beyond,
            unit=unit,
        )


class Source(Section):
    """A borehole, a line within fractures or a whole fracture, by its rate or its pressure.

    Args:
        name: What messages and results call it. Without it: source number 1, 2, ....
        at: Where it is; the nearest node of a fracture is taken, and the run names it if it lies
            elsewhere (m). Required, unless there is `from`, `fracture`, `curve` or `points`.
        from_: Where a borehole begins that is open to every fracture it crosses; its `pressure` is
            that here, and hydrostatic along it (m). Without it: `at`.
        to: Where it ends (m). Required, unless there is no `from`.
        fracture: The fracture all of which it feeds, a rate by area times transmissivity; no
            borehole, and without `radius`. Without it: `at`.
        curve: The physical curve of the mesh that it feeds where it lies within fractures, a rate
            by length times transmissivity; without `radius`. Without it: `at`.
        points: Such a line by its points, straight between them; its rate needs no edges along it,
            its pressure does (m). Without it: `at`.
        rate: What flows in; negative where it flows out; one that varies does so with time alone
            (m3/s). This or `pressure` is required.
        pressure: Pressure of the fluid at its wall: constant, linear in the elevation, or any value
            that varies with time or from place to place; in a borehole `from` and `to` a number is
            that where it begins, and the fluid in it rests (Pa); -1e12 to 1e12. This or `rate` is
            required.
        radius: Its radius, small beside the facets around it; the pressure at its wall depends on
            it (m); > 0. Required, unless there is `fracture`, `curve` or `points`.
        history: Factor on its rate or pressure at times. Without it: grows once.
    """

    def __init__(
        self,
        *,
        name: str | None = None,
        at: Sequence[Quantity] | None = None,
        from_: Sequence[Quantity] | None = None,
        to: Sequence[Quantity] | None = None,
        fracture: str | None = None,
        curve: str | None = None,
        points: Sequence[Sequence[float]] | None = None,
        rate: Quantity | Varying | Mapping[str, Any] | None = None,
        pressure: Quantity | SourcePressure | Mapping[str, Any] | None = None,
        radius: Quantity | None = None,
        history: Sequence[Sequence[float]] | None = None,
    ) -> None:
        super().__init__(
            name=name,
            at=at,
            **{"from": from_},
            to=to,
            fracture=fracture,
            curve=curve,
            points=points,
            rate=rate,
            pressure=pressure,
            radius=radius,
            history=history,
        )


class InitialPressure(Section):
    """Pressure `value + per_metre (z - at)`, or one that varies.

    Args:
        value: Pressure at the elevation `at` (Pa); -1e12 to 1e12. This or `water_table` is
            required.
        per_metre: Increase with the elevation (Pa/m); -1e9 to 1e9. Without it 0.
        at: Elevation of `value`, positive upwards (m). Without it 0.
        water_table: Instead: elevation below which a fluid at rest has this pressure, by `density`
            and gravity; 0 there, negative above (m). This or `value` is required.
        table: Rows `[coordinate, value]` with linear values between, in any order. Without it:
            `expression` or `file`.
        over: What the rows of the table are over; the time is that of the load steps. Without it:
            required with `table`.
        ground: Elevation z of the ground: the depth is `ground` - z (m). Without it 0.
        expression: Value by x, y, z, depth (m) and time, with + - * / ^, min(a, b), max(a, b),
            sqrt, exp, ln, log10, sin, cos, tan, abs, step (0 below 0, else 1) and PI. Without it:
            `table` or `file`.
        file: CSV file of samples: columns x, y, z (m), of which those may be missing along which
            nothing varies; or a grid of VTK (.vtu), whose values stand at its points, or in the
            middle of its cells. Without it: `table` or `expression`.
        column: Column, or array of the grid, with the values. Without it: required with `file`.
        method: Between samples: the nearest one, or linear along their line, in the Delaunay
            triangles of their plane, or on their grid. Without it "nearest".
        reach: Largest distance from a sample: a point beyond it is a gap, and refused (m); > 0.
            Without it: any; the run tells the largest.
        beyond: Beyond the table or the samples between which values are linear: a defect, or the
            nearest value. Without it "refuse".
        unit: Unit of the values. Without it: SI units, angles in degrees.
    """

    def __init__(
        self,
        *,
        value: Quantity | None = None,
        per_metre: Quantity | None = None,
        at: Quantity | None = None,
        water_table: Quantity | None = None,
        table: Sequence[Sequence[float]] | None = None,
        over: Literal["x", "y", "z", "depth", "time"] | None = None,
        ground: Quantity | None = None,
        expression: str | None = None,
        file: str | os.PathLike[str] | None = None,
        column: str | None = None,
        method: Literal["nearest", "linear"] | None = None,
        reach: Quantity | None = None,
        beyond: Literal["refuse", "nearest"] | None = None,
        unit: str | None = None,
    ) -> None:
        super().__init__(
            value=value,
            per_metre=per_metre,
            at=at,
            water_table=water_table,
            table=table,
            over=over,
            ground=ground,
            expression=expression,
            file=file,
            column=column,
            method=method,
            reach=reach,
            beyond=beyond,
            unit=unit,
        )


class Fluid(Section):
    """A fluid that flows in the fractures; without this section nothing flows.

    Args:
        viscosity: Viscosity mu; a fracture conducts b_h^3 / (12 mu) (Pa s); > 0. Required.
        density: Mass per volume (kg/m3); > 0. Required, unless there is no gravity.
        compressibility: Relative change of density with pressure c; counts where the flow takes
            time, which in rigid rock it does only if the fluid is compressible (1/Pa); >= 0.
            Without it 0.
        initial_pressure: Pressure before any load, in balance with `[initial_stress]`, which is
            total: constant, linear in the elevation, or any value that varies but not with time
            (Pa); -1e12 to 1e12. Without it 0.
        isolated: Networks of fractures that no pressure and no rate acts on are refused, or left
            out of the flow; or, undrained, in steady flow between walls that move, they keep the
            fluid that they hold, and so do those whose rates add up to zero. Without it "refuse".
        equivalent_permeability: Whether the permeability tensor of the whole body is computed, by
            linear pressures on all of its outer surface; in rock that deforms, before the loads and
            after each load step. Without it false.
    """

    def __init__(
        self,
        *,
        viscosity: Quantity | None = None,
        density: Quantity | None = None,
        compressibility: Quantity | None = None,
        initial_pressure: Quantity | InitialPressure | Mapping[str, Any] | None = None,
        isolated: Literal["refuse", "inactive", "undrained"] | None = None,
        equivalent_permeability: bool | None = None,
    ) -> None:
        super().__init__(
            viscosity=viscosity,
            density=density,
            compressibility=compressibility,
            initial_pressure=initial_pressure,
            isolated=isolated,
            equivalent_permeability=equivalent_permeability,
        )


class Body(Section):
    """What acts in all of the rock.

    Args:
        gravity: Acceleration of gravity (m/s2). Required.
        history: Factor on gravity at times. Without it: grows once.
    """

    def __init__(
        self,
        *,
        gravity: Sequence[Quantity] | None = None,
        history: Sequence[Sequence[float]] | None = None,
    ) -> None:
        super().__init__(
            gravity=gravity,
            history=history,
        )


class FixedPoint(Section):
    """One node held by itself, to remove rigid motions.

    Args:
        at: Where it is; the nearest node is taken, and the run names it if it lies elsewhere (m).
            Required.
        displacement: Prescribed components; they hold the blocks on all sides of the node.
            Required.
        history: Factor on its displacement at times. Without it: grows once.
    """

    def __init__(
        self,
        *,
        at: Sequence[Quantity] | None = None,
        displacement: Displacement | Mapping[str, Any] | None = None,
        history: Sequence[Sequence[float]] | None = None,
    ) -> None:
        super().__init__(
            at=at,
            displacement=displacement,
            history=history,
        )


class FluidPressure(Section):
    """Pressure `value + per_metre (z - at)`, or one that varies.

    Args:
        value: Pressure at the elevation `at` (Pa); -1e12 to 1e12. This or `water_table` is
            required.
        per_metre: Increase with the elevation (Pa/m); -1e9 to 1e9. Without it 0.
        at: Elevation of `value`, positive upwards (m). Without it 0.
        water_table: Instead: elevation below which a fluid at rest has this pressure, by `density`
            and gravity; 0 there, negative above (m). This or `value` is required.
        table: Rows `[coordinate, value]` with linear values between, in any order. Without it:
            `expression` or `file`.
        over: What the rows of the table are over; the time is that of the load steps. Without it:
            required with `table`.
        ground: Elevation z of the ground: the depth is `ground` - z (m). Without it 0.
        expression: Value by x, y, z, depth (m) and time, with + - * / ^, min(a, b), max(a, b),
            sqrt, exp, ln, log10, sin, cos, tan, abs, step (0 below 0, else 1) and PI. Without it:
            `table` or `file`.
        file: CSV file of samples: columns x, y, z (m), of which those may be missing along which
            nothing varies; or a grid of VTK (.vtu), whose values stand at its points, or in the
            middle of its cells. Without it: `table` or `expression`.
        column: Column, or array of the grid, with the values. Without it: required with `file`.
        method: Between samples: the nearest one, or linear along their line, in the Delaunay
            triangles of their plane, or on their grid. Without it "nearest".
        reach: Largest distance from a sample: a point beyond it is a gap, and refused (m); > 0.
            Without it: any; the run tells the largest.
        beyond: Beyond the table or the samples between which values are linear: a defect, or the
            nearest value. Without it "refuse".
        unit: Unit of the values. Without it: SI units, angles in degrees.
    """

    def __init__(
        self,
        *,
        value: Quantity | None = None,
        per_metre: Quantity | None = None,
        at: Quantity | None = None,
        water_table: Quantity | None = None,
        table: Sequence[Sequence[float]] | None = None,
        over: Literal["x", "y", "z", "depth", "time"] | None = None,
        ground: Quantity | None = None,
        expression: str | None = None,
        file: str | os.PathLike[str] | None = None,
        column: str | None = None,
        method: Literal["nearest", "linear"] | None = None,
        reach: Quantity | None = None,
        beyond: Literal["refuse", "nearest"] | None = None,
        unit: str | None = None,
    ) -> None:
        super().__init__(
            value=value,
            per_metre=per_metre,
            at=at,
            water_table=water_table,
            table=table,
            over=over,
            ground=ground,
            expression=expression,
            file=file,
            column=column,
            method=method,
            reach=reach,
            beyond=beyond,
            unit=unit,
        )


class Displacement(Section):
    """Prescribed components of a displacement, at least one.

    Args:
        x: Along x (m). Without it: free.
        y: Along y (m). Without it: free.
        z: Along z (m). Without it: free.
    """

    def __init__(
        self,
        *,
        x: Quantity | Varying | Mapping[str, Any] | None = None,
        y: Quantity | Varying | Mapping[str, Any] | None = None,
        z: Quantity | Varying | Mapping[str, Any] | None = None,
    ) -> None:
        super().__init__(
            x=x,
            y=y,
            z=z,
        )


class Boundary(Section):
    """Surface NAME, or outer faces at a place; load, support, fluid may act together.

    Args:
        where: Where its faces lie, for meshes whose outer faces have no names: comparisons of
            expressions in x, y, z, all of which hold, such as `x > 1, x < 3, z = max`. Without it:
            the physical surface of that name.
        traction: Force per area in global axes (Pa). Without it: none.
        pressure: Force per area along the inward normal, instead of `traction` (Pa). Without it:
            none.
        displacement: Prescribed components; those not named are free. Without it: free.
        symmetry: No displacement along the normal, a roller on any plane; instead of
            `displacement`. Without it false.
        spring: Stiffness of springs against displacement of the surface, an elastic bed (Pa/m); >=
            0. Without it: none.
        shear_spring: Stiffness of the springs along the surface; `spring` is that along its normal
            then (Pa/m); >= 0. Without it: that of `spring`.
        far_field: Springs as stiff as unbounded rock outside, going by the distance from this
            centre of what happens inside; instead of `spring` (m). Without it: none.
        fluid_pressure: Pressure of the fluid where fractures meet the surface: constant, linear in
            the elevation, or any value that varies with time or from place to place (Pa); -1e12 to
            1e12. Without it: closed to the fluid.
        fluid_inflow: What flows into the fractures that meet the surface, in all, shared by length
            times transmissivity; one that varies does so with time alone; instead of
            `fluid_pressure` (m3/s). Without it: closed to the fluid.
        history: Factor on its load, its displacement and its fluid at times. Without it: grows
            once.
    """

    def __init__(
        self,
        *,
        where: str | None = None,
        traction: Sequence[Quantity | Varying | Mapping[str, Any]] | None = None,
        pressure: Quantity | Varying | Mapping[str, Any] | None = None,
        displacement: Displacement | Mapping[str, Any] | None = None,
        symmetry: bool | None = None,
        spring: Quantity | Varying | Mapping[str, Any] | None = None,
        shear_spring: Quantity | Varying | Mapping[str, Any] | None = None,
        far_field: Sequence[Quantity] | None = None,
        fluid_pressure: Quantity | FluidPressure | Mapping[str, Any] | None = None,
        fluid_inflow: Quantity | Varying | Mapping[str, Any] | None = None,
        history: Sequence[Sequence[float]] | None = None,
    ) -> None:
        super().__init__(
            where=where,
            traction=traction,
            pressure=pressure,
            displacement=displacement,
            symmetry=symmetry,
            spring=spring,
            shear_spring=shear_spring,
            far_field=far_field,
            fluid_pressure=fluid_pressure,
            fluid_inflow=fluid_inflow,
            history=history,
        )


class Fracture(Section):
    """The physical surface NAME; `[fracture.default]` serves all inner surfaces not named.

    Args:
        aperture: Aperture b0 without load, greater than 0; contact allows 0 (m); >= 0. Required,
            unless the rock is rigid and there is a `hydraulic_aperture`.
        normal_stiffness: Stiffness K_n0 at b0; 0 is a free crack, whose walls may overlap (Pa/m);
            >= 0. Required, unless the closure is `"contact"`, which has none, or the rock is rigid.
        shear_stiffness: Stiffness K_s, constant (Pa/m); >= 0. Required, unless there is friction
            (nothing moves before it slides) or contact, or the rock is rigid.
        closure: Law of the normal traction; under the linear one walls may overlap. Without it
            "linear".
        cutoff_aperture: Aperture b_cut below which the stiffness goes on linearly, at most b0;
            logarithmic only (m); > 0. Without it: none: exact.
        max_closure: Closure v_m that no load reaches, at most b0; hyperbolic only (m); > 0. Without
            it: `aperture`.
        tension_cutoff: Whether an open fracture carries nothing. Without it false.
        tensile_strength: Strength of a bond that breaks in tension, together with `fracture_energy`
            (Pa); > 0. Without it: no bond.
        fracture_energy: Energy that breaks the bond, more than strength^2 / (2 K_n0) (J/m2); > 0.
            Without it: no bond.
        friction_angle: Angle phi of friction; the shear traction is at most c - tan(phi) sigma_n
            (degrees); 0 to 89. Without it: none: elastic.
        cohesion: Cohesion c; lost where tension is cut off and the fracture opens, and as a bond
            breaks (Pa); >= 0. Without it 0.
        dilation_angle: Opening per slip beyond the elastic slip; at most the friction angle
            (degrees); 0 to 89. Without it 0.
        between: Physical volumes whose common surface is the fracture, nodes shared or doubled; one
            name twice for the doubled faces within it. Without it: the physical surface NAME.
        fluid_pressure: Pressure on both walls, opening; with `[fluid]` given all over the fracture
            (Pa). Without it 0.
        hydraulic_aperture: Aperture b_h that the fluid sees, whatever the walls do; needs `[fluid]`
            (m); > 0. Without it: follows the walls; in rigid rock they stay at `aperture`.
        residual_hydraulic_aperture: Hydraulic aperture r that closed walls leave, b_h^3 = e^3 +
            r^3; where there is no `hydraulic_aperture` (m); >= 0. Without it 0.
        roughness: Factor f by which rough walls lower the transmissivity, e^3 = b^3 / f; 1 to
            1000000. Without it 1.
        joint_roughness: Barton's coefficient JRC instead: e = b^2 / JRC^2.5 in micrometres, at most
            b; 0 to 20. Without it: `roughness`.
        sealed: Whether nothing flows in it; fractures that cross it stay connected. Without it
            false.
        leakoff: Carter's coefficient C (m/s^0.5): through each wall fluid leaks off into the rock
            with the velocity C / sqrt(t - t_0); where the flow takes time (m/s^0.5); >= 0. Without
            it 0.
        exposed_at: Time t_0 at which the walls first meet the fluid that leaks off, in seconds;
            beside `leakoff` (time). Without it 0.
        history: Factor on the fluid pressure at times. Without it: grows once.
    """

    def __init__(
        self,
        *,
        aperture: Quantity | Varying | Mapping[str, Any] | None = None,
        normal_stiffness: Quantity | Varying | Mapping[str, Any] | None = None,
        shear_stiffness: Quantity | Varying | Mapping[str, Any] | None = None,
        closure: Literal["linear", "logarithmic", "hyperbolic", "contact"] | None = None,
        cutoff_aperture: Quantity | Varying | Mapping[str, Any] | None = None,
        max_closure: Quantity | Varying | Mapping[str, Any] | None = None,
        tension_cutoff: bool | None = None,
        tensile_strength: Quantity | Varying | Mapping[str, Any] | None = None,
        fracture_energy: Quantity | Varying | Mapping[str, Any] | None = None,
        friction_angle: Quantity | Varying | Mapping[str, Any] | None = None,
        cohesion: Quantity | Varying | Mapping[str, Any] | None = None,
        dilation_angle: Quantity | Varying | Mapping[str, Any] | None = None,
        between: Sequence[str] | None = None,
        fluid_pressure: Quantity | Varying | Mapping[str, Any] | None = None,
        hydraulic_aperture: Quantity | Varying | Mapping[str, Any] | None = None,
        residual_hydraulic_aperture: Quantity | Varying | Mapping[str, Any] | None = None,
        roughness: Quantity | Varying | Mapping[str, Any] | None = None,
        joint_roughness: Quantity | Varying | Mapping[str, Any] | None = None,
        sealed: bool | None = None,
        leakoff: float | Varying | Mapping[str, Any] | None = None,
        exposed_at: float | None = None,
        history: Sequence[Sequence[float]] | None = None,
    ) -> None:
        super().__init__(
            aperture=aperture,
            normal_stiffness=normal_stiffness,
            shear_stiffness=shear_stiffness,
            closure=closure,
            cutoff_aperture=cutoff_aperture,
            max_closure=max_closure,
            tension_cutoff=tension_cutoff,
            tensile_strength=tensile_strength,
            fracture_energy=fracture_energy,
            friction_angle=friction_angle,
            cohesion=cohesion,
            dilation_angle=dilation_angle,
            between=between,
            fluid_pressure=fluid_pressure,
            hydraulic_aperture=hydraulic_aperture,
            residual_hydraulic_aperture=residual_hydraulic_aperture,
            roughness=roughness,
            joint_roughness=joint_roughness,
            sealed=sealed,
            leakoff=leakoff,
            exposed_at=exposed_at,
            history=history,
        )


class Varying(Section):
    """Keys in braces in the place of a number: `table`, `expression` or `file`.

    Args:
        table: Rows `[coordinate, value]` with linear values between, in any order. Without it:
            `expression` or `file`.
        over: What the rows of the table are over; the time is that of the load steps. Without it:
            required with `table`.
        ground: Elevation z of the ground: the depth is `ground` - z (m). Without it 0.
        expression: Value by x, y, z, depth (m) and time, with + - * / ^, min(a, b), max(a, b),
            sqrt, exp, ln, log10, sin, cos, tan, abs, step (0 below 0, else 1) and PI. Without it:
            `table` or `file`.
        file: CSV file of samples: columns x, y, z (m), of which those may be missing along which
            nothing varies; or a grid of VTK (.vtu), whose values stand at its points, or in the
            middle of its cells. Without it: `table` or `expression`.
        column: Column, or array of the grid, with the values. Without it: required with `file`.
        method: Between samples: the nearest one, or linear along their line, in the Delaunay
            triangles of their plane, or on their grid. Without it "nearest".
        reach: Largest distance from a sample: a point beyond it is a gap, and refused (m); > 0.
            Without it: any; the run tells the largest.
        beyond: Beyond the table or the samples between which values are linear: a defect, or the
            nearest value. Without it "refuse".
        unit: Unit of the values. Without it: SI units, angles in degrees.
    """

    def __init__(
        self,
        *,
        table: Sequence[Sequence[float]] | None = None,
        over: Literal["x", "y", "z", "depth", "time"] | None = None,
        ground: Quantity | None = None,
        expression: str | None = None,
        file: str | os.PathLike[str] | None = None,
        column: str | None = None,
        method: Literal["nearest", "linear"] | None = None,
        reach: Quantity | None = None,
        beyond: Literal["refuse", "nearest"] | None = None,
        unit: str | None = None,
    ) -> None:
        super().__init__(
            table=table,
            over=over,
            ground=ground,
            expression=expression,
            file=file,
            column=column,
            method=method,
            reach=reach,
            beyond=beyond,
            unit=unit,
        )


class Rock(Section):
    """The physical volume NAME; `[rock.default]` serves all volumes not named.

    Args:
        young_modulus: Young's modulus E; with `normal_young_modulus` that in the plane of isotropy
            (Pa); 1 to 1e15. Required, unless there are `young_moduli`, or `[fluid]`: all rock
            without it is rigid.
        poisson_ratio: Poisson's ratio nu; with `normal_poisson_ratio` that in the plane of
            isotropy; > -1, < 0.5. Required, unless there are `poisson_ratios`, or the rock is
            rigid.
        normal_young_modulus: Young's modulus E' across the plane of isotropy (bedding, schistosity)
            (Pa); 1 to 1e15. Without it: the same in all directions.
        normal_poisson_ratio: Poisson's ratio nu': a stress s across the plane strains it by -nu'
            s/E'; nu'^2 < (E'/E) (1 - nu)/2. Without it: required with `normal_young_modulus`.
        normal_shear_modulus: Shear modulus G' across the plane of isotropy (Pa); 1 to 1e15. Without
            it: required with `normal_young_modulus`.
        young_moduli: Young's moduli E1, E2, E3 of orthotropic rock: 1 down the dip, 2 along the
            strike, 3 across the plane; without dip x, y, z (Pa); 1 to 1e15. Without it:
            `young_modulus`.
        poisson_ratios: Poisson's ratios nu12, nu23, nu13: a stress s along i strains j by -nu_ij
            s/E_i. Without it: required with `young_moduli`.
        shear_moduli: Shear moduli G12, G23, G13 (Pa); 1 to 1e15. Without it: required with
            `young_moduli`.
        dip: Angle between the plane of isotropy, or of the axes 1 and 2, and the horizontal
            (degrees); 0 to 90. Without it 0.
        dip_direction: Direction towards which that plane falls, clockwise from north (y) (degrees).
            Without it 90.
        density: Mass per volume; required where gravity acts (kg/m3); >= 0. Without it 0.
    """

    def __init__(
        self,
        *,
        young_modulus: Quantity | Varying | Mapping[str, Any] | None = None,
        poisson_ratio: Quantity | Varying | Mapping[str, Any] | None = None,
        normal_young_modulus: Quantity | Varying | Mapping[str, Any] | None = None,
        normal_poisson_ratio: Quantity | Varying | Mapping[str, Any] | None = None,
        normal_shear_modulus: Quantity | Varying | Mapping[str, Any] | None = None,
        young_moduli: Sequence[Quantity | Varying | Mapping[str, Any]] | None = None,
        poisson_ratios: Sequence[Quantity | Varying | Mapping[str, Any]] | None = None,
        shear_moduli: Sequence[Quantity | Varying | Mapping[str, Any]] | None = None,
        dip: Quantity | Varying | Mapping[str, Any] | None = None,
        dip_direction: Quantity | Varying | Mapping[str, Any] | None = None,
        density: Quantity | Varying | Mapping[str, Any] | None = None,
    ) -> None:
        super().__init__(
            young_modulus=young_modulus,
            poisson_ratio=poisson_ratio,
            normal_young_modulus=normal_young_modulus,
            normal_poisson_ratio=normal_poisson_ratio,
            normal_shear_modulus=normal_shear_modulus,
            young_moduli=young_moduli,
            poisson_ratios=poisson_ratios,
            shear_moduli=shear_moduli,
            dip=dip,
            dip_direction=dip_direction,
            density=density,
        )


class Adapt(Section):
    """How far a mesh follows the estimated error.

    Args:
        tolerance: Largest estimated error of the mean jump of a fracture, as a share of it; > 0, <
            1. Required.
        max_unknowns: Unknowns beyond which no mesh goes; > 0. Without it 1e6.
        by: Whether gmsh makes each mesh anew, with sizes by the error, or tetrahedra of the first
            mesh, triangles of one of the plane, are cut in two where it asks for that, which starts
            no gmsh; surfaces stay as the first mesh has them. Without it "meshing".
        max_rounds: Most meshes; > 0. Without it 8.
    """

    def __init__(
        self,
        *,
        tolerance: Quantity | None = None,
        max_unknowns: Quantity | None = None,
        by: Literal["meshing", "bisection"] | None = None,
        max_rounds: Quantity | None = None,
    ) -> None:
        super().__init__(
            tolerance=tolerance,
            max_unknowns=max_unknowns,
            by=by,
            max_rounds=max_rounds,
        )


class MeshSource(Section):
    """Where the mesh comes from: a gmsh geometry or a mesh file, relative to the scene.

    Args:
        geometry: gmsh geometry, meshed on every run. This or `file` is required.
        file: gmsh mesh, MSH 4.1; gmsh converts older versions. This or `geometry` is required.
        parameters: Plain numbers handed to gmsh, `{ h = 0.1 }` as `-setnumber h 0.1`; with
            `geometry` only. Without it {}.
        order: Order of the elements; with `geometry` only; 1 to 2. Without it 1.
        dimension: 2 meshes surfaces alone: those of a plane are a scene in plane strain, whose
            fractures are lines; others are the fractures and outer faces of rigid rock; with
            `geometry` only; 2 to 3. Without it 3.
        scale: Metres that one unit of the coordinates of the mesh is: 1000 for kilometres; not with
            `adapt`; > 0. Without it 1.
        quarter_points: Whether cells of order 2 at crack fronts follow the square root of the
            distance. Without it true.
        weld: Whether nodes at one place become one node; without it rock that touches without
            sharing nodes is refused. Without it false.
        refine: How many times each cell is divided into eight, in a mesh of the plane into four,
            fractures and groups with it; not with `adapt`; 0 to 5. Without it 0.
        adapt: Meshes until the estimated error is below a tolerance; with `geometry` only. Without
            it: one mesh, as the geometry says.
    """

    def __init__(
        self,
        *,
        geometry: str | os.PathLike[str] | None = None,
        file: str | os.PathLike[str] | None = None,
        parameters: Mapping[str, float] | None = None,
        order: int | None = None,
        dimension: int | None = None,
        scale: Quantity | None = None,
        quarter_points: bool | None = None,
        weld: bool | None = None,
        refine: int | None = None,
        adapt: Adapt | Mapping[str, Any] | None = None,
    ) -> None:
        super().__init__(
            geometry=geometry,
            file=file,
            parameters=parameters,
            order=order,
            dimension=dimension,
            scale=scale,
            quarter_points=quarter_points,
            weld=weld,
            refine=refine,
            adapt=adapt,
        )


class SceneSections(Section):
    """The top of a scene, before its first section.

    Args:
        title: What reports and `summary.json` call it. Without it "untitled".
        mesh: Where the mesh comes from. Required.
        rock: Rocks by physical volume. Required, unless there is `[fluid]`, and the rock is rigid.
        fracture: Fractures by physical surface. Without it: no surface is a fracture.
        boundary: Conditions by physical surface; surfaces that are not named are free. Without it:
            free.
        fixed_point: Nodes held by themselves. Without it: none.
        body: What acts in all of the rock. Without it: weightless.
        fluid: A fluid that flows in the fractures. Without it: nothing flows.
        source: Boreholes. Without it: none.
        initial_stress: Stress before any load. Without it: none.
        load: Load steps. Without it: one load step.
        solver: What is asked of the solver. Without it: the program chooses.
        strength_reduction: How far the strength of fractures can be reduced until blocks move.
            Without it: no factor of safety.
        warnings: What is meant, however unlikely it looks. Without it: all are told.
        oracle: Closed forms by fracture, to compare it with. Without it: nothing is compared.
        probe: Points whose values are written down after each load step. Without it: none.
    """

    def __init__(
        self,
        *,
        title: str | None = None,
        mesh: MeshSource | Mapping[str, Any] | None = None,
        rock: Mapping[str, Rock | Mapping[str, Any]] | None = None,
        fracture: Mapping[str, Fracture | Mapping[str, Any]] | None = None,
        boundary: Mapping[str, Boundary | Mapping[str, Any]] | None = None,
        fixed_point: Sequence[FixedPoint | Mapping[str, Any]] | None = None,
        body: Body | Mapping[str, Any] | None = None,
        fluid: Fluid | Mapping[str, Any] | None = None,
        source: Sequence[Source | Mapping[str, Any]] | None = None,
        initial_stress: InitialStress | Mapping[str, Any] | None = None,
        load: Load | Mapping[str, Any] | None = None,
        solver: Solver | Mapping[str, Any] | None = None,
        strength_reduction: StrengthReduction | Mapping[str, Any] | None = None,
        warnings: Warnings | Mapping[str, Any] | None = None,
        oracle: Mapping[str, Oracle | Mapping[str, Any]] | None = None,
        probe: Mapping[str, Probe | Mapping[str, Any]] | None = None,
    ) -> None:
        super().__init__(
            title=title,
            mesh=mesh,
            rock=rock,
            fracture=fracture,
            boundary=boundary,
            fixed_point=fixed_point,
            body=body,
            fluid=fluid,
            source=source,
            initial_stress=initial_stress,
            load=load,
            solver=solver,
            strength_reduction=strength_reduction,
            warnings=warnings,
            oracle=oracle,
            probe=probe,
        )


__all__ = [
    "Adapt",
    "Body",
    "Boundary",
    "Displacement",
    "FixedPoint",
    "Fluid",
    "FluidPressure",
    "Fracture",
    "InitialPressure",
    "InitialStress",
    "Load",
    "MeshSource",
    "Oracle",
    "Phase",
    "Probe",
    "Rock",
    "Solver",
    "Source",
    "SourcePressure",
    "StrengthReduction",
    "StressProfile",
    "Varying",
    "Warnings",
]
