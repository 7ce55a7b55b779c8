"""Grids of points and cells with fields."""

from __future__ import annotations

from typing import Any, Callable

import numpy as np
from numpy.typing import NDArray

from .tables import count

Array = NDArray[Any]
Cells = tuple[Array, Array, Array]


class Grid:
    """Points and cells with fields on them, as VTK has them."""

    def __init__(
        self,
        points: Array,
        point_fields: dict[str, Array],
        cell_fields: dict[str, Array],
        cells: Callable[[], Cells],
    ) -> None:
        self.points = points.reshape(-1, 3)
        """Coordinates (m), a row for each point."""
        self.point_fields = point_fields
        """Fields on the points by name."""
        self.cell_fields = cell_fields
        """Fields on the cells by name."""
        self._make_cells = cells
        self._cells: Cells | None = None

    @property
    def cells(self) -> Cells:
        """Points of all cells one after the other, where each cell ends, and types of VTK."""
        if self._cells is None:
            self._cells = self._make_cells()
        return self._cells

    @property
    def fields(self) -> list[str]:
        """Names of the fields on points, and of those on cells."""
        return [*self.point_fields, *self.cell_fields]

    def require(self, field: str) -> None:
        """Refuses the name of a field that is not there.

        Raises:
            KeyError: with the fields that are.
        """
        if field not in self.fields:
            raise KeyError(f"no field is called {field!r}; there are: {', '.join(self.fields)}")

    def to_pyvista(self) -> Any:
        """The grid as a ``pyvista.UnstructuredGrid``."""
        try:
            import pyvista
        except ImportError as error:
            raise ImportError("pictures need pyvista: pip install pyvista") from error
        connectivity, ends, types = (part.astype(np.int64) for part in self.cells)
        widths = np.diff(ends, prepend=0)
        starts = ends - widths
        cells = np.insert(connectivity, starts, widths)
        grid = pyvista.UnstructuredGrid(cells, types.astype(np.uint8), self.points)
        for name, field in self.point_fields.items():
            grid.point_data[name] = field
        for name, field in self.cell_fields.items():
            grid.cell_data[name] = field
        return grid

    def __repr__(self) -> str:
        return f"Grid({count(len(self.points), 'point')}; {', '.join(self.fields)})"
