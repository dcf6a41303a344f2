"""Picture of a geometry that moves along a body: pressure and stress at points over its position."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import numpy as np

from eigencontact.viz.informative import NOISE, axis_from_zero, varies
from eigencontact.viz.strands import Strand, draw_strands
from eigencontact.viz.style import COLOURS, new_figure, paper_style, scale_for

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from eigencontact.results.stored import Results

__all__ = ["passes", "passing_history", "passing_varies", "rolls"]

#: Points whose stress is drawn.
MOST = 6


def rolls(dataset: Results) -> bool:
    """Whether the geometry moves along the surface."""
    return any(float(np.ptp(dataset[name].values)) > 0 for name in ("travel_x", "travel_y") if name in dataset)


def passing_history(dataset: Results) -> Figure:
    """Largest pressure, and von Mises stress at the points of regions of points, over the position of the geometry.

    Where the geometry moves along x and y, the position is the length of its path.

    One panel, in which each pass has the colour of its number, and a second one where there are such points, at most
    six of which are drawn.
    """
    place, label_of_place = _place(dataset)
    length = scale_for(place, "m")
    points = _histories(dataset)
    pressure = np.asarray(dataset["max_pressure"].values, dtype=float)
    scale = scale_for(pressure, "Pa")
    runs = passes(place, pressure > 0)
    with paper_style():
        figure = new_figure(7.2 if points else 4.6, 2.9)
        panels = figure.subplots(1, 2 if points else 1, squeeze=False)[0]
        draw_strands(figure, panels[0], length(place), scale(pressure), runs, "Pass")
        pressures = np.concatenate([pressure[run.first : run.last + 1] for run in runs])
        if axis_from_zero(pressures):
            panels[0].set_ylim(0.0, 1.1 * float(scale(pressures.max())))
        panels[0].set(ylabel=f"Largest pressure [{scale.unit}]", title="Largest contact pressure")
        if points:
            stress = scale_for(np.stack(list(points.values())), "Pa")
            for n, (name, values) in enumerate(points.items()):
                for run in runs:
                    steps, label = slice(run.first, run.last + 1), name if run is runs[0] else "_"
                    style = {"color": COLOURS[n % len(COLOURS)], "label": label}
                    panels[1].plot(length(place[steps]), stress(values[steps]), "-", **style)
            panels[1].set(ylabel=f"Von Mises stress [{stress.unit}]", title="Stress at fixed points of the body")
            panels[1].set_ylim(bottom=0)
            figure.legend(loc="outside lower center", ncols=min(2, len(points)))
        for axes in panels:
            axes.set_xlabel(f"{label_of_place} [{length.unit}]")
            axes.margins(x=0)
    return figure


def passing_varies(dataset: Results) -> bool:
    """Whether the stress is stored at points, or the pressure of passes changes by more than the noise of cells."""
    pressure = np.asarray(dataset["max_pressure"].values, dtype=float)
    runs = passes(_place(dataset)[0], pressure > 0)
    pressures = [pressure[run.first : run.last + 1] for run in runs]
    return bool(runs) and (bool(_histories(dataset)) or varies(np.concatenate(pressures), NOISE))


def passes(place: NDArray[np.float64], pressed: NDArray[np.bool_]) -> list[Strand]:
    """Pieces of a path that go one way in contact; a turn belongs to both its pieces, a lift to none.

    Parameters
    ----------
    place : (steps,)
        Position along the path.
    pressed : (steps,) bool
        Whether the bodies touch.
    """
    strands: list[Strand] = []
    first, way = None, 0.0
    for step in range(place.size):
        if not pressed[step]:
            first = None
            continue
        if first is None:
            first, way = step, 0.0
            continue
        move = float(np.sign(place[step] - place[step - 1]))
        if way and move and move != way:
            first = step - 1
        way = move or way
        if strands and strands[-1].first == first:
            strands[-1] = Strand(first, step, strands[-1].number)
        elif way:
            strands.append(Strand(first, step, len(strands) + 1.0))
    return strands


def _place(dataset: Results) -> tuple[NDArray[np.float64], str]:
    """Position of the geometry in each step [m], and its name."""
    x, y = (np.asarray(dataset[name].values, dtype=float) for name in ("travel_x", "travel_y"))
    if not np.ptp(y):
        return x, "Position of the moving body along x"
    if not np.ptp(x):
        return y, "Position of the moving body along y"
    return np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(x), np.diff(y)))]), "Path of the moving body"


def _histories(dataset: Results) -> dict[str, NDArray[np.float64]]:
    """Von Mises stress in each step, by point."""
    histories: dict[str, NDArray[np.float64]] = {}
    for name, region in json.loads(dataset.attrs["regions"]).items():
        if region["shape"] != "points" or f"{name}_von_mises" not in dataset:
            continue
        at = [np.asarray(dataset[f"{name}_{axis}"].values, dtype=float) for axis in "xyz"]
        length = scale_for(np.concatenate(at), "m")
        values = np.asarray(dataset[f"{name}_von_mises"].values, dtype=float)
        for number, (x, y, z) in enumerate(zip(*at, strict=True)):
            if len(histories) < MOST:
                where = ", ".join(f"{float(length(value)):.3g}" for value in (x, y, z))
                histories[f"{name}, at (x, y, z) = ({where}) {length.unit}"] = values[:, number]
    return histories
