"""Rows as tables: of pandas where it is installed, of HTML for notebooks."""

from __future__ import annotations

import html as _html
import io
from typing import Any, Mapping, Sequence

Rows = Sequence[Mapping[str, Any]]


def frame(rows: Rows) -> Any:
    """Rows as a ``pandas.DataFrame``."""
    return _pandas().DataFrame(list(rows))


def frame_of_csv(text: str) -> Any:
    """A table in CSV as a ``pandas.DataFrame``; names are texts, even those that are numbers."""
    return _pandas().read_csv(io.StringIO(text), dtype={"name": str, "phase": str})


def _pandas() -> Any:
    try:
        import pandas
    except ImportError as error:
        raise ImportError("tables need pandas: pip install pandas") from error
    return pandas


def count(number: int, noun: str) -> str:
    """A number of things in words: ``1 load step``, ``2 load steps``."""
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"


def html(rows: Rows) -> str:
    """Rows as a table in HTML."""
    if not rows:
        return "<p>nothing</p>"
    columns = list(rows[0])
    head = "".join(f"<th>{_html.escape(column)}</th>" for column in columns)
    cells = ("".join(f"<td>{_cell(row[column])}</td>" for column in columns) for row in rows)
    body = "".join(f"<tr>{row}</tr>" for row in cells)
    return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


def _cell(value: Any) -> str:
    if isinstance(value, float):
        return f"{value:.5g}"
    return "" if value is None else _html.escape(str(value))
