"""Studies: what meshes, orders, laws and values of a scene yield, and what each costs."""

from __future__ import annotations

import html as _html
import os
import tempfile
from pathlib import Path
from typing import Any, Mapping, Sequence

from . import program, tables
from .scene import Scene


class Setting:
    """A setting of a study: its scene, its error and its cost."""

    def __init__(self, row: Mapping[str, Any], folder: Path) -> None:
        self.row = row
        """Its row of the table."""
        self._folder = folder / "points" / str(row["folder"])

    @property
    def scene(self) -> Scene:
        """The scene with this setting."""
        return Scene.read(self._folder / "scene.toml")

    @property
    def error(self) -> float:
        """Its relative error."""
        return float(self.row["error"])

    @property
    def seconds(self) -> float:
        """Time that it took (s), meshing included."""
        return float(self.row["seconds"])

    def __repr__(self) -> str:
        return f"Setting({self.row['folder']}: error {self.error:.3g}, {self.seconds:.3g} s)"


class Study:
    """A study that has been run."""

    def __init__(self, folder: str | os.PathLike[str], kept: Any = None) -> None:
        self.folder = Path(folder)
        # A folder of its own lasts as long as the study.
        self._kept = kept

    @property
    def table(self) -> Any:
        """A row for each setting, a ``pandas.DataFrame``: what was swept, unknowns, seconds, memory,
        value and error of the measure, and why a setting failed."""
        text = (self.folder / "study.csv").read_text("utf-8")
        return tables.frame_of_csv(text)

    @property
    def page(self) -> Path:
        """The page with its charts, ``study.html``."""
        return self.folder / "study.html"

    def cheapest(self, error: str | float) -> Setting:
        """The setting that takes least time among those with at most an error: ``"1 %"`` or 0.01.

        Raises:
            LookupError: if none is so accurate.
        """
        most = share(error)
        table = self.table
        good = table[table["error"] <= most].sort_values("seconds")
        if good.empty:
            best = table["error"].min()
            raise LookupError(f"no setting has an error of {most:g} or less; the best has {best:g}")
        return Setting(good.iloc[0].to_dict(), self.folder)

    def plot(self, x: str = "seconds", y: str = "error", **options: Any) -> Any:
        """Draws one column against another on logarithmic axes, a line for each combination of what
        is swept beside the mesh; ``options`` go to ``pandas.DataFrame.plot``. Returns the axes."""
        table = self.table.dropna(subset=[x, y])
        swept = ["order", "quarter_points", "closure", "facets", "solver"]
        swept = [name for name in swept if table[name].nunique() > 1]
        groups = table.groupby(swept) if swept else [((), table)]
        axes = options.pop("ax", None)
        for key, group in groups:
            key = key if isinstance(key, tuple) else (key,)
            label = ", ".join(map(str, key)) or y
            own = {"marker": "o", "loglog": True, "label": label, "ax": axes, **options}
            axes = group.sort_values(x).plot(x=x, y=y, **own)
        if axes is not None:
            axes.set_xlabel(x)
            axes.set_ylabel(y)
        return axes

    def __repr__(self) -> str:
        return f"Study({os.fspath(self.folder)!r})"

    def _repr_html_(self) -> str:
        columns = ["mesh", "order", "closure", "solver", "unknowns", "seconds", "value", "error"]
        rows = self.table.reindex(columns=columns).to_dict("records")
        return f"<p>{_html.escape(str(self.page))}</p>" + tables.html(rows)


def share(error: str | float) -> float:
    """A share as a number: ``"1 %"`` is 0.01."""
    if isinstance(error, str):
        text = error.strip()
        return float(text[:-1]) / 100.0 if text.endswith("%") else float(text)
    return float(error)


def study(
    scene: Scene,
    *,
    meshes: Sequence[Mapping[str, float]] | None = None,
    orders: Sequence[int] | None = None,
    closures: Sequence[Any] | None = None,
    solvers: Sequence[str] | None = None,
    values: Mapping[str, Sequence[float]] | None = None,
    measure: str | None = None,
    fracture: str | None = None,
    tolerance: str | float | None = None,
    threads: int | None = None,
    out: str | os.PathLike[str] | None = None,
    **more: Any,
) -> Study:
    """Runs a scene with many settings, each combination of what is given, cheapest first.

    The scene names its geometry, since meshes differ. ``values`` sweeps numbers of the scene:
    ``{"normal_stiffness": [1e10, 1e11], "boundary.top.pressure": [5e6, 10e6]}``. ``more`` are other
    keys of ``[study]``. With ``tolerance`` it ends at the first setting that is so accurate. Without
    ``out`` the files go with the study. Settings that a former study of ``out`` has run are kept.

    Raises:
        InputError: with every defect of scene and study.
    """
    asked = {
        "meshes": meshes,
        "orders": orders,
        "closures": closures,
        "solvers": solvers,
        "values": values,
        "measure": measure,
        "fracture": fracture,
        **more,
    }
    asked = {key: value for key, value in asked.items() if value is not None}
    kept = tempfile.TemporaryDirectory(prefix="kluft-study-") if out is None else None
    folder = Path(kept.name if kept else os.fspath(out or "")).absolute()
    folder.mkdir(parents=True, exist_ok=True)
    text = _with_paths(scene).replace(study=asked).to_toml() if asked else _with_paths(scene).to_toml()
    file = folder / "studied.toml"
    file.write_text(text, "utf-8")
    arguments = ["study", os.fspath(file), "--out", os.fspath(folder), "--quiet"]
    if tolerance is not None:
        arguments += ["--tolerance", f"{share(tolerance):g}"]
    if threads is not None:
        arguments += ["--threads", str(threads)]
    program.run(arguments, folder)
    return Study(folder, kept)


def _with_paths(scene: Scene) -> Scene:
    """The scene with the paths of its mesh from the root, so that it may stand in any folder."""
    mesh = scene._plain().get("mesh", {})
    paths = {
        key: os.fspath((scene._folder / mesh[key]).absolute())
        for key in ("geometry", "file")
        if key in mesh
    }
    if not paths:
        raise ValueError("a study needs a scene that names its geometry: mesh=kluft.MeshSource(...)")
    return scene.replace(mesh=paths)
