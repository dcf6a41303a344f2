"""Picture of a geometry that rolls over a body: what its place does to the pressure and to the stress at points."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import numpy as np

from eigencontact.viz.style import COLOURS, Scale, new_figure, paper_style, scale_for

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from eigencontact.results.stored import Results

__all__ = ["passing_history", "rolls"]

#: Points whose stress is drawn.
MOST = 6
#: Pressures that differ by less are the same.
ROUND_OFF = 1e-3


def rolls(dataset: Results) -> bool:
    """Whether the geometry moves along the surface."""
    return any(float(np.ptp(dataset[name].values)) > 0 for name in ("travel_x", "travel_y") if name in dataset)


def passing_history(dataset: Results) -> Figure:
    """Largest pressure, and von Mises stress at the points of regions of points, against the place of the geometry.

    Where the geometry moves along x and y, the place is the length of its path.

    Parameters
    ----------
    dataset : Results
        Results of a run in which `rolls` holds.

    Returns
    -------
    matplotlib.figure.Figure
        One panel, and a second one where there are such points, at most six of which are drawn.
    """
    place, words = _place(dataset)
    length = scale_for(place, "m")
    points = _histories(dataset)
    pressure = np.asarray(dataset["max_pressure"].values, dtype=float)
    with paper_style():
        figure = new_figure(6.8 if points else 3.9, 2.9)
        panels = figure.subplots(1, 2 if points else 1, squeeze=False)[0]
        _curve(panels[0], length, place, pressure, "Largest pressure")
        panels[0].set_title("Largest contact pressure")
        if points:
            stress = scale_for(np.stack(list(points.values())), "Pa")
            for n, (name, values) in enumerate(points.items()):
                panels[1].plot(length(place), stress(values), "-", color=COLOURS[n % len(COLOURS)], label=name)
            panels[1].set(ylabel=f"Von Mises stress [{stress.unit}]", title="Stress at points")
            panels[1].set_ylim(bottom=0)
            figure.legend(loc="outside lower center", ncols=min(3, len(points)))
        for axes in panels:
            axes.set_xlabel(f"{words} [{length.unit}]")
            axes.margins(x=0)
    return figure


def _curve(axes: Axes, length: Scale, place: NDArray[np.float64], values: NDArray[np.float64], label: str) -> None:
    scale = scale_for(values, "Pa")
    axes.plot(length(place), scale(values), "o-", color=COLOURS[0], markersize=3)
    if np.ptp(values) < ROUND_OFF * values.max():  # a body that is the same everywhere: no zoom into round-off
        axes.set_ylim(0.0, 1.1 * float(scale(values.max())))
    axes.set_ylabel(f"{label} [{scale.unit}]")


def _place(dataset: Results) -> tuple[NDArray[np.float64], str]:
    """Place of the geometry in each step [m], and its name."""
    x, y = (np.asarray(dataset[name].values, dtype=float) for name in ("travel_x", "travel_y"))
    if not np.ptp(y):
        return x, "place of the geometry along x"
    if not np.ptp(x):
        return y, "place of the geometry along y"
    return np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(x), np.diff(y)))]), "path of the geometry"


def _histories(dataset: Results) -> dict[str, NDArray[np.float64]]:
    """Von Mises stress in each step, by point."""
    found: dict[str, NDArray[np.float64]] = {}
    for name, region in json.loads(dataset.attrs["regions"]).items():
        if region["shape"] != "points" or f"{name}_von_mises" not in dataset:
            continue
        at = [np.asarray(dataset[f"{name}_{axis}"].values, dtype=float) for axis in "xyz"]
        length = scale_for(np.concatenate(at), "m")
        values = np.asarray(dataset[f"{name}_von_mises"].values, dtype=float)
        for number, (x, y, z) in enumerate(zip(*at, strict=True)):
            if len(found) < MOST:
                where = ", ".join(f"{float(length(value)):.3g}" for value in (x, y, z))
                found[f"{name} ({where}) {length.unit}"] = values[:, number]
    return found
