"""Meshes from files, from gmsh, meshio and pyvista, and from arrays."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from . import _kluft, tables
from .errors import InputError
from .grid import Array

_VTK = {
    "triangle": 5,
    "triangle6": 22,
    "quad": 9,
    "quad8": 23,
    "quad9": 28,
    "tetra": 10,
    "tetra10": 24,
    "hexahedron": 12,
    "hexahedron20": 25,
    "hexahedron27": 29,
    "wedge": 13,
    "wedge15": 26,
    "wedge18": 32,
    "pyramid": 14,
    "pyramid13": 27,
}
_SURFACES = {5, 22, 9, 23, 28}
_BOUNDING = "gmsh:bounding_entities"

Elements = Mapping[str, Any]
"""Nodes of elements by their type, as meshio calls it: ``{"tetra": rows of four nodes}``."""


class Survey:
    """What a mesh is like, before anything is solved on it."""

    def __init__(self, found: dict[str, Any]) -> None:
        self.fractures: list[dict[str, Any]] = found["fractures"]
        """One row for each fracture: area (m2), dip and dip direction (degrees), lengths of tips in
        the rock and of traces on the surface (m)."""
        self.contacts: list[dict[str, Any]] = found["contacts"]
        """One row for each pair of fractures that meet."""
        self.blocks: list[dict[str, Any]] = found["blocks"]
        """One row for each block of rock that fractures cut out: cells, volume (m3)."""
        self.mean_quality: float = found["mean_quality"]
        """Mean quality of the cells by their angles; 1 is regular, 0 is flat."""
        self.worst_quality: float = found["worst_quality"]
        """Quality of the worst cell."""

    def table(self) -> Any:
        """The fractures as a ``pandas.DataFrame``."""
        return tables.frame(self.fractures)

    def __repr__(self) -> str:
        fractures = tables.count(len(self.fractures), "fracture")
        return f"Survey({fractures}, {tables.count(len(self.blocks), 'block')})"

    def _repr_html_(self) -> str:
        quality = f"worst cell {self.worst_quality:.3f}, mean {self.mean_quality:.3f} of 1"
        head = f"<p>{tables.count(len(self.blocks), 'block')}; {quality}</p>"
        return head + tables.html(self.fractures)


class Mesh:
    """A mesh with named volumes (rocks) and surfaces (fractures, parts of the outer surface)."""

    def __init__(self, mesh: _kluft.Mesh) -> None:
        self._mesh = mesh

    @classmethod
    def from_file(cls, file: str | os.PathLike[str]) -> Mesh:
        """Reads a ``.msh`` file; those before version 4.1 are converted by gmsh.

        Raises:
            InputError: with every defect of the file.
        """
        return cls(_kluft.Mesh.read(os.fspath(file)))

    @classmethod
    def from_arrays(
        cls,
        points: Any,
        volumes: Mapping[str | tuple[str, ...], Elements],
        surfaces: Mapping[str | tuple[str, ...], Elements],
    ) -> Mesh:
        """Takes coordinates (m), a row of three for each node, and elements by the name of their
        volume or surface. Elements are rows of nodes, counted from 0, by type, in the node order of
        VTK and meshio. A tuple of names stands for elements that belong to several.

        Raises:
            InputError: if elements refer to nodes that are not there, or have an unknown type.
        """
        groups = _Groups()
        for dimension, named in ((3, volumes), (2, surfaces)):
            for name, elements in named.items():
                names = (name,) if isinstance(name, str) else name
                own = [groups.number(dimension, one) for one in names]
                for kind, nodes in elements.items():
                    groups.add("vtk", _number(dimension, name, kind), nodes, own)
        return cls._of_groups("arrays", points, groups)

    @classmethod
    def from_gmsh(cls, model: str | None = None) -> Mesh:
        """Takes the mesh of the current model of gmsh's Python package, or of a named one."""
        import gmsh

        if model is not None:
            gmsh.model.setCurrent(model)
        tags, coordinates, _ = gmsh.model.mesh.getNodes()
        order = np.argsort(tags)
        groups = _Groups()
        for dimension in (2, 3):
            for _, tag in gmsh.model.getPhysicalGroups(dimension):
                name = gmsh.model.getPhysicalName(dimension, tag) or str(tag)
                groups.number(dimension, name, tag)
        for dimension in (2, 3):
            for _, entity in gmsh.model.getEntities(dimension):
                of_entity = gmsh.model.getPhysicalGroupsForEntity(dimension, entity)
                own = [groups.index(dimension, int(tag)) for tag in of_entity]
                kinds = zip(*gmsh.model.mesh.getElements(dimension, entity))
                for kind, elements, nodes in kinds:
                    places = order[np.searchsorted(tags, nodes, sorter=order)]
                    rows = places.reshape(len(elements), -1)
                    groups.add("gmsh", int(kind), rows, own, elements)
        source = f"model {gmsh.model.getCurrent() or 'of gmsh'}"
        return cls._of_groups(source, coordinates.reshape(-1, 3), groups, tags)

    @classmethod
    def from_meshio(cls, mesh: Any) -> Mesh:
        """Takes a ``meshio.Mesh`` whose groups are in ``cell_sets`` or, as meshio reads files of
        gmsh, in the cell data ``gmsh:physical`` with names in ``field_data``."""
        physical = mesh.cell_data.get("gmsh:physical")
        if physical is not None:
            return cls._of_tags("meshio", mesh.points, _blocks(mesh), physical, mesh.field_data)
        groups = _Groups()
        # What meshio notes of a file of gmsh 4.1 here are tags of surfaces, no places of elements.
        sets = {name: of for name, of in mesh.cell_sets.items() if name != _BOUNDING}
        names = list(sets)
        for index, (number, nodes) in enumerate(_blocks(mesh)):
            dimension = 2 if number in _SURFACES else 3
            member = np.zeros((len(sets), len(nodes)), bool)
            for row, blocks in zip(member, sets.values()):
                places = blocks[index]
                row[np.asarray(places if places is not None else [], np.int64)] = True
            for columns in np.unique(member, axis=1).T if len(names) else [np.zeros(0, bool)]:
                own = [groups.number(dimension, names[i]) for i in np.flatnonzero(columns)]
                chosen = (member == columns[:, None]).all(axis=0)
                groups.add("vtk", number, nodes[chosen], own)
        return cls._of_groups("meshio", mesh.points, groups)

    @classmethod
    def from_pyvista(
        cls, grid: Any, names: Mapping[int, str] | None = None, groups: str = "gmsh:physical"
    ) -> Mesh:
        """Takes a ``pyvista.UnstructuredGrid`` with volumes and surfaces; the cell data ``groups``
        hold a number for each cell, 0 for none, and ``names`` the name of each number.

        Raises:
            InputError: if the grid has no such cell data.
        """
        if groups not in grid.cell_data:
            raise _without_groups(groups, list(grid.cell_data.keys()))
        tags = np.asarray(grid.cell_data[groups])
        blocks = [(int(kind), nodes) for kind, nodes in grid.cells_dict.items()]
        blocks = [(kind, nodes) for kind, nodes in blocks if kind in _VTK.values()]
        of_blocks = [tags[grid.celltypes == kind] for kind, _ in blocks]
        named = {name: (number, 0) for number, name in (names or {}).items()}
        return cls._of_tags("pyvista", grid.points, blocks, of_blocks, named)

    @classmethod
    def _of_tags(
        cls,
        source: str,
        points: Any,
        blocks: Iterable[tuple[int, Array]],
        tags: Sequence[Array],
        named: Mapping[str, Any],
    ) -> Mesh:
        """Blocks of VTK types with a number for each element; ``named`` holds the number of each
        name and its dimension, 0 for any."""
        names = {(int(tag), int(dimension)): name for name, (tag, dimension) in named.items()}
        groups = _Groups()
        for (number, nodes), of_elements in zip(blocks, tags):
            dimension = 2 if number in _SURFACES else 3
            for tag in np.unique(of_elements):
                name = names.get((int(tag), dimension), names.get((int(tag), 0), str(tag)))
                own = [groups.number(dimension, name, int(tag))] if tag != 0 else []
                groups.add("vtk", number, nodes[of_elements == tag], own)
        return cls._of_groups(source, points, groups)

    @classmethod
    def _of_groups(cls, source: str, points: Any, groups: _Groups, tags: Any = None) -> Mesh:
        points = np.ascontiguousarray(points, np.float64).reshape(-1, 3)
        tags = np.arange(1, len(points) + 1) if tags is None else tags
        nodes = (points, np.ascontiguousarray(tags, np.uint64))
        return cls(_kluft.Mesh.of_blocks(source, nodes, groups.groups, groups.blocks))

    @property
    def groups(self) -> list[dict[str, Any]]:
        """Named volumes and surfaces with their dimension, tag and number of elements."""
        keys = ("name", "dimension", "tag", "elements")
        return [dict(zip(keys, group)) for group in self._mesh.groups()]

    def survey(self, fractures: Iterable[str] | None = None) -> Survey:
        """What the mesh is like with these surfaces as fractures, or with all inner ones.

        Raises:
            InputError: with every defect of the mesh.
        """
        return Survey(self._mesh.survey(None if fractures is None else list(fractures)))

    def __repr__(self) -> str:
        return f"Mesh({self._mesh.source!r}, {self._size()})"

    def _size(self) -> str:
        nodes = tables.count(self._mesh.node_count, "node")
        return f"{nodes}, {tables.count(self._mesh.cell_count, 'cell')}"

    def _repr_html_(self) -> str:
        return f"<p>{self._size()}</p>{tables.html(self.groups)}"


def _number(dimension: int, name: Any, kind: str) -> int:
    """The number of VTK for a type of elements of a volume (3) or a surface (2).

    Raises:
        InputError: if the type is unknown.
    """
    if kind in _VTK:
        return _VTK[kind]
    fitting = [one for one, number in _VTK.items() if (number in _SURFACES) == (dimension == 2)]
    place = f"{'surface' if dimension == 2 else 'volume'} {name!r}"
    remedy = f"take one of {', '.join(fitting)}"
    raise InputError([(place, f"`{kind}` is no type of elements", remedy)])


def _without_groups(groups: str, found: list[str]) -> InputError:
    """What is wrong with a grid whose cells have no numbers of groups."""
    remedy = "name the cell data that have a number for each volume and surface: groups=..."
    there = f"there are {', '.join(map(repr, found))}" if found else "there are none"
    return InputError([("cell data of the grid", f"there is no {groups!r}; {there}", remedy)])


def _blocks(mesh: Any) -> list[tuple[int, Array]]:
    """Blocks of a mesh of meshio by the numbers of VTK; 0 for those of lower dimension."""
    return [(_VTK.get(block.type, 0), np.asarray(block.data)) for block in mesh.cells]


class _Groups:
    """Groups and blocks of elements as they are gathered."""

    def __init__(self) -> None:
        self.groups: list[tuple[int, int, str]] = []
        self.blocks: list[tuple[str, int, Array, Array, list[int]]] = []
        self._count = 0

    def number(self, dimension: int, name: str, tag: int | None = None) -> int:
        """Index of a group by its name; a new one if there is none."""
        for index, (known, _, other) in enumerate(self.groups):
            if (known, other) == (dimension, name):
                return index
        self.groups.append((dimension, len(self.groups) + 1 if tag is None else tag, name))
        return len(self.groups) - 1

    def index(self, dimension: int, tag: int) -> int:
        """Index of a group by its tag."""
        return next(
            index
            for index, (known, other, _) in enumerate(self.groups)
            if (known, other) == (dimension, abs(tag))
        )

    def add(
        self, numbering: str, kind: int, nodes: Any, own: Iterable[int], tags: Any = None
    ) -> None:
        """Adds elements of one type and of the same groups; points and lines are left out."""
        rows = np.ascontiguousarray(nodes, np.int64)
        if kind == 0 or len(rows) == 0:
            return
        if tags is None:
            tags = np.arange(self._count + 1, self._count + len(rows) + 1)
        self._count += len(rows)
        groups = sorted(set(own))
        self.blocks.append((numbering, kind, rows, np.ascontiguousarray(tags, np.uint64), groups))
