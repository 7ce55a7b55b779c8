"""Reads the grids that a run has written."""

from __future__ import annotations

import base64
import xml.etree.ElementTree as ElementTree
import zlib
from pathlib import Path

import numpy as np

from .grid import Array, Grid

_TYPES = {"Float64": "<f8", "Int32": "<i4", "UInt64": "<u8", "UInt8": "u1"}


def read_grid(path: Path) -> Grid:
    """The grid of a ``.vtu`` file of a run."""
    piece = ElementTree.parse(path).getroot().find("UnstructuredGrid/Piece")
    if piece is None:
        raise ValueError(f"{path} is no unstructured grid of VTK")
    arrays = {
        part: {array.get("Name", ""): _array(array) for array in piece.findall(f"{part}/DataArray")}
        for part in ("Points", "Cells", "PointData", "CellData")
    }
    cells = arrays["Cells"]
    topology = (cells["connectivity"], cells["offsets"], cells["types"])
    points = arrays["Points"]["Points"]
    return Grid(points, arrays["PointData"], arrays["CellData"], lambda: topology)


def _array(element: ElementTree.Element) -> Array:
    """Blocks compressed with zlib: in base64 the number of blocks, the size of a block and of the
    last one, and the compressed size of each; then the blocks."""
    text = "".join((element.text or "").split())
    count = int(np.frombuffer(base64.b64decode(text[:12])[:8], "<u8")[0])
    head_bytes = 8 * (3 + count)
    head_text = 4 * -(-head_bytes // 3)
    head = np.frombuffer(base64.b64decode(text[:head_text])[:head_bytes], "<u8")
    body = base64.b64decode(text[head_text:])
    ends = np.cumsum(head[3:], dtype=np.int64)
    starts = ends - head[3:].astype(np.int64)
    raw = b"".join(zlib.decompress(body[start:end]) for start, end in zip(starts, ends))
    values = np.frombuffer(bytearray(raw), _TYPES[element.get("type", "")])
    components = int(element.get("NumberOfComponents", "1"))
    return values if components == 1 else values.reshape(-1, components)
