"""One step of a run as its results file holds it: plain arrays, the scene, and what the file says of its regions."""

from __future__ import annotations

import json
import tomllib
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from eigencontact.core.numbers import ErrorBar, Number
    from eigencontact.scene.schema import Scene

__all__ = ["Place", "StoredRegion", "StoredStep", "bars_of", "plugin_files", "read_step", "regions_at", "run_name"]

FloatArray = NDArray[np.float64]

_COMPONENTS = ("xx", "yy", "zz", "yz", "xz", "xy")


@dataclass(frozen=True, kw_only=True, eq=False)
class Place:
    """Window of the surface.

    Attributes
    ----------
    x, y : (nx,), (ny,) float64
        Middles of the cells [m].
    cell : (float, float)
        Edges of a cell along x and y [m].
    """

    x: FloatArray
    y: FloatArray
    cell: tuple[float, float]

    @cached_property
    def edges(self) -> tuple[FloatArray, FloatArray]:
        """Edges of the cells along x and y, one more than cells."""
        return tuple(
            line[0] + (np.arange(line.size + 1) - 0.5) * size
            for line, size in zip((self.x, self.y), self.cell, strict=True)
        )


@dataclass(frozen=True, kw_only=True, eq=False)
class StoredRegion:
    """Stress of one region at the step.

    Attributes
    ----------
    name, shape : str
        ``"plane"``, ``"volume"``, ``"line"`` or ``"points"``.
    body : int
        1 or 2; z points into it.
    axes : tuple of str
        Directions of the axes of `stress` after the first: ``("z", "x")``; ``("point",)`` of lines and points.
    points : (..., 3) float64
        Places [m].
    stress : (..., 6) float64
        xx, yy, zz, yz, xz, xy [Pa].
    mean_above : float
        Depth [m] above which the stress by tractions is a mean over cells.
    """

    name: str
    shape: str
    body: int
    axes: tuple[str, ...]
    points: FloatArray
    stress: FloatArray
    mean_above: float


@dataclass(frozen=True, kw_only=True, eq=False)
class StoredStep:
    """Stored step of a run.

    Attributes
    ----------
    name : str
        Of the scene.
    step : int
        From 1, of `steps`.
    time : float
        In load steps.
    scene : Scene
        As it was run, without regions of stress and observers.
    window : Place
    surface : dict of str to (ny, nx) array
        Fields of the surface.
    earlier : dict of str to (ny, nx) array
        Fields of the surface of the step before; empty in the first.
    scalars : dict of str to float
    regions : tuple of StoredRegion
        Those with stress.
    history : dict of str to array
        What bodies remember after this step; empty where it is not stored.
    lattices : dict of int to (x, y, z)
        Middles of the cells that remember, by body [m].
    histories : tuple of int
        Steps whose history is stored.
    """

    name: str
    step: int
    time: float
    scene: Scene
    window: Place
    surface: dict[str, FloatArray]
    earlier: dict[str, FloatArray]
    scalars: dict[str, float]
    regions: tuple[StoredRegion, ...]
    history: dict[str, FloatArray]
    lattices: dict[int, tuple[FloatArray, FloatArray, FloatArray]]
    histories: tuple[int, ...]


def read_step(path: str | Path, step: int | None = None) -> StoredStep:
    """Read a step of a run.

    Parameters
    ----------
    path : str or Path
        Folder of a run, or its ``results.nc``.
    step : int, optional
        From 1; by default the last one.

    Raises
    ------
    ResultsError, SceneError
        No results, no such step, a scene that cannot be read.
    """
    from eigencontact.errors import ResultsError
    from eigencontact.results.reader import open_results
    from eigencontact.scene.schema import Scene

    with open_results(path) as data:
        steps = [int(number) for number in np.atleast_1d(data["step"].values)]
        number = steps[-1] if step is None else step
        if number not in steps:
            raise ResultsError(f"--step must be one of the stored steps {steps[0]} to {steps[-1]} (got {number})")
        at = steps.index(number)
        tables = tomllib.loads(str(data.attrs["scene"]))
        scene = Scene(**{**tables, "stress": [], "observers": [], "fatigue": []})
        surface, earlier, scalars, history = {}, {}, {}, {}
        histories: tuple[int, ...] = ()
        if "history_step" in data.variables:
            histories = tuple(int(value) for value in np.atleast_1d(data["history_step"].values))
        for name, field in data.variables.items():
            role, values = field.attrs.get("role"), field
            if role == "field" and field.dims == ("step", "y", "x"):
                surface[str(name)] = np.asarray(values[at].values, dtype=float)
                if at:
                    earlier[str(name)] = np.asarray(values[at - 1].values, dtype=float)
            elif role in ("scalar", "observed") and field.dims == ("step",):
                scalars[str(name)] = float(values[at].values)
            elif role == "history" and number in histories:
                history[str(name)] = np.asarray(values[histories.index(number)].values, dtype=float)
        lattices = {
            body: tuple(np.asarray(data[f"cells_{body}_{axis}"].values, dtype=float) for axis in "xyz")
            for body in (1, 2)
            if f"cells_{body}_x" in data.variables
        }
        size = np.asarray(data.attrs["cell_size"], dtype=float)
        return StoredStep(
            name=str(data.attrs["name"]),
            step=number,
            time=float(np.atleast_1d(data["time"].values)[at]),
            scene=scene,
            window=Place(
                x=np.asarray(data["x"].values, dtype=float), y=np.asarray(data["y"].values, dtype=float),
                cell=(float(size[0]), float(size[1])),
            ),
            surface=surface,
            earlier=earlier,
            scalars=scalars,
            regions=tuple(regions_at(data, at)),
            history=history,
            lattices=lattices,  # type: ignore[arg-type]
            histories=histories,
        )  # fmt: skip


def plugin_files(path: str | Path) -> tuple[str, ...]:
    """Plugin files that the scene of a run names: who solves its cases needs them too."""
    from eigencontact.results.reader import open_results

    with open_results(path) as data:
        return tuple(tomllib.loads(str(data.attrs["scene"])).get("plugins", ()))


def run_name(folder: str | Path) -> str:
    """Name of the folder of a run, or of the folder of its ``results.nc``."""
    path = Path(folder)
    return path.parent.name if path.suffix == ".nc" else path.name


def bars_of(path: str | Path) -> dict[str, tuple[Number, ErrorBar]]:
    """Declarations and error bars of the numbers of a run, by name; empty for a run without ``--errors``."""
    from eigencontact.core.numbers import ErrorBar, Number
    from eigencontact.results.reader import results_file

    file = results_file(path).parent / "summary.json"
    summary = json.loads(file.read_text(encoding="utf-8")) if file.is_file() else {}
    bars = {name: ErrorBar.of_dict(table) for name, table in summary.get("errors", {}).items()}
    return {name: (Number(**summary["numbers"][name]), bar) for name, bar in bars.items()}


def regions_at(data: Any, at: int) -> list[StoredRegion]:
    """Regions with stress at a step, from 0, of open results."""
    regions = []
    for name, facts in json.loads(data.attrs["regions"]).items():
        if "stress" not in facts["fields"] or f"{name}_stress" not in data.variables:
            continue
        field = data[f"{name}_stress"]
        axes = tuple(str(dim).removeprefix(f"{name}_") for dim in field.dims[2:])
        stress = np.moveaxis(np.asarray(field[at].values, dtype=float), 0, -1)
        lines = [np.asarray(data[f"{name}_{axis}"].values, dtype=float) for axis in "xyz"]
        if axes == ("point",):
            points = np.stack(np.broadcast_arrays(*lines), axis=-1)
        else:
            shaped = []
            for axis, line in zip("xyz", lines, strict=True):
                shape = [1] * len(axes)
                if axis in axes:
                    shape[axes.index(axis)] = -1
                shaped.append(line.reshape(shape))
            points = np.stack(np.broadcast_arrays(*shaped), axis=-1)
            points = np.broadcast_to(points, (*stress.shape[:-1], 3))
        order = [str(value) for value in data["component"].values]
        stress = stress[..., [order.index(name) for name in _COMPONENTS]]
        regions.append(
            StoredRegion(
                name=name, shape=facts["shape"], body=int(facts["body"]), axes=axes, points=np.array(points),
                stress=stress, mean_above=float(facts["mean_above"]),
            )
        )  # fmt: skip
    return regions
