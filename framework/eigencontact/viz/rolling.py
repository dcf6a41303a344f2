"""Pictures of a geometry that moves along a body: pressure over its position, and impacts at each place."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.viz.history import NOISE, Strand, axis_from_zero, draw_strands, varies
from eigencontact.viz.style import COLOURS, new_figure, paper_style, scale_for
from eigencontact.viz.window import Window, view_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from eigencontact.core.grid import Box
    from eigencontact.results.stored import Results

__all__ = ["coverage_map", "impacts", "passes", "passing_history", "passing_varies", "rolls", "strikes", "struck"]

#: Points whose stress is drawn.
MOST = 6
#: Fewer impacts are no treatment of a surface.
FEWEST = 3
#: Points along the edge of a cell that draw the borders of prints.
FINER = 6
#: Share of touched neighbours from which on a point counts as touched.
HALF = 0.5


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
    """Parts of a path in one direction in contact; a turning point belongs to both parts, a lift to none.

    The arguments, (steps,), are the position along the path and whether the bodies touch.
    """
    strands: list[Strand] = []
    first, direction = None, 0.0
    for step in range(place.size):
        if not pressed[step]:
            first = None
            continue
        if first is None:
            first, direction = step, 0.0
            continue
        move = float(np.sign(place[step] - place[step - 1]))
        if direction and move and move != direction:
            first = step - 1
        direction = move or direction
        if strands and strands[-1].first == first:
            strands[-1] = Strand(first, step, strands[-1].number)
        elif direction:
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


def impacts(dataset: Results) -> list[int]:
    """Positions along ``step`` of the largest load of each impact; steps without pressure separate impacts."""
    loaded = np.asarray(dataset["max_pressure"].values) > 0
    loads = np.asarray(dataset["normal_load"].values, dtype=float)
    ends = np.flatnonzero(np.diff(np.concatenate([[False], loaded, [False]]).astype(int)))
    return [int(first + loads[first:last].argmax()) for first, last in ends.reshape(-1, 2)]


def struck(dataset: Results) -> bool:
    """Whether a geometry is pressed on and lifted at several places."""
    return "max_pressure" in dataset and rolls(dataset) and len(impacts(dataset)) > FEWEST


def strikes(dataset: Results) -> NDArray[np.intp]:
    """Impacts that each cell ``(ny, nx)`` has felt: pressure at their largest load."""
    return np.asarray((dataset["pressure"][impacts(dataset)].values > 0).sum(axis=0))


def _smooth_strikes(dataset: Results, view: Box) -> NDArray[np.intp]:
    """Impacts on points finer than cells of a view; the border of each print passes between the middles of cells."""
    from scipy.ndimage import gaussian_filter, zoom

    count: NDArray[np.intp] = np.zeros([FINER * side for side in view.shape], dtype=np.intp)
    for step in impacts(dataset):
        touched = (dataset["pressure"][step].values > 0).astype(float)
        share = gaussian_filter(touched, 1.0, mode="nearest")[view.slices]
        count += zoom(share, FINER, order=1, mode="nearest", grid_mode=True) > HALF
    return count


def coverage_map(dataset: Results) -> Figure:
    """Map of the number of impacts at each place, with the covered share of a square in the middle.

    Dots are the middles of the impacts. The square reaches to the outermost of them. Borders of prints are smooth; the
    share counts whole cells.
    """
    from matplotlib import colormaps
    from matplotlib.colors import BoundaryNorm

    count = strikes(dataset)
    at = np.array([[float(dataset[f"travel_{axis}"][step]) for axis in "xy"] for step in impacts(dataset)])
    (left, bottom), (right, top) = at.min(axis=0), at.max(axis=0)
    x, y = (np.asarray(dataset[axis].values, dtype=float) for axis in "xy")
    inside = count[(y >= bottom) & (y <= top)][:, (x >= left) & (x <= right)]
    window = Window(dataset, view_of(count > 0))
    with paper_style():
        figure, axes, _ = window.axes_of_map()
        most = int(count.max())
        colours = colormaps["viridis"].resampled(most + 1)
        image = axes.imshow(
            _smooth_strikes(dataset, window.view),
            origin="lower",
            extent=window.extent,
            cmap=colours,
            norm=BoundaryNorm(np.arange(most + 2) - 0.5, most + 1),
        )
        dots: dict[str, Any] = {"color": "white", "markeredgecolor": "black", "markersize": 3.5, "markeredgewidth": 0.6}
        axes.plot(*window.length(at.T), "o", **dots)
        corners = window.length([[left, right, right, left, left], [bottom, bottom, top, top, bottom]])
        axes.plot(*corners, "--", color="white", linewidth=0.8)
        window.label(axes)
        bar = figure.colorbar(image, ax=axes, aspect=22, pad=0.03, ticks=range(0, most + 1, max(1, most // 6)))
        bar.set_label("Impacts")
        share = 100.0 * float((inside > 0).mean()) if inside.size else 0.0
        axes.set_title(f"{len(at)} impacts cover {share:.0f} % of the dashed square")
    return figure
