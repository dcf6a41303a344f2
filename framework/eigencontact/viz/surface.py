"""Pictures of the surface: the pressure as a map and along two lines."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.core.grid import Box
from eigencontact.viz.style import (
    COLOURS,
    box_size,
    colour_range,
    heading,
    label_plane,
    new_figure,
    paper_style,
    place,
    scale_for,
)

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

__all__ = ["pressure_map", "pressure_profiles", "relative_difference"]

#: Room around the contact in a picture, as a part of the larger side of the contact.
MARGIN = 0.25
#: With more cells than this along a profile, only some carry a marker.
MARKERS = 64


def pressure_map(dataset: xr.Dataset, step: int = -1) -> Figure:
    """Contact pressure of one step as a map, cut to the contact and some room around it.

    Parameters
    ----------
    dataset : xarray.Dataset
        Results of a run.
    step : int
        Position along ``step``.

    Returns
    -------
    matplotlib.figure.Figure
        Cells without pressure are grey; the outline of the contact is drawn where it is not ragged.
    """
    pressure, x, y = _surface(dataset, step)
    view = _view(pressure)
    edges_x, edges_y = _edges(x, dataset, 0), _edges(y, dataset, 1)
    extent = (edges_x[view.x0], edges_x[view.x1], edges_y[view.y0], edges_y[view.y1])
    length = scale_for(extent, "m")
    width, height = box_size(extent[1] - extent[0], extent[3] - extent[2])
    with paper_style():
        wide = width > 2.2 * height
        figure = new_figure(width + (0.8 if wide else 1.6), height + (1.5 if wide else 0.7))
        axes = figure.add_subplot()
        shown = pressure[view.slices]
        stress = scale_for(shown, "Pa")
        colours, low, high = colour_range(shown)
        masked = np.ma.masked_where(shown == 0, stress(shown))
        axes.set_facecolor("0.93")
        image = axes.imshow(
            masked,
            origin="lower",
            extent=tuple(length(extent)),
            cmap=colours,
            vmin=low * stress.factor,
            vmax=high * stress.factor,
        )
        label_plane(axes, f"x [{length.unit}]", f"y [{length.unit}]")
        axes.set_title(heading(dataset, step, "Contact pressure"))
        if np.any(shown):
            _outline(axes, shown != 0, length(edges_x[view.x0 : view.x1 + 1]), length(edges_y[view.y0 : view.y1 + 1]))
            bar = figure.colorbar(
                image,
                ax=axes,
                location="bottom" if wide else "right",
                shrink=0.6 if wide else 1.0,
                aspect=30 if wide else 22,
                pad=0.03,
            )
            bar.set_label(f"Pressure [{stress.unit}]")
        else:
            axes.text(0.5, 0.5, "no contact", transform=axes.transAxes, ha="center", va="center", color="0.4")
    return figure


def pressure_profiles(dataset: xr.Dataset, step: int = -1) -> Figure:
    """Contact pressure of one step along x and along y, beside the closed form where the run has one.

    The lines pass through the cell of largest pressure; through the middle of the window when the pressure is
    symmetric about it. Markers are computed cells.

    Parameters
    ----------
    dataset : xarray.Dataset
        Results of a run.
    step : int
        Position along ``step``.

    Returns
    -------
    matplotlib.figure.Figure
        One panel along x, one along y; only one where the other direction has a single cell.
    """
    pressure, x, y = _surface(dataset, step)
    reference = None
    if "reference_pressure" in dataset:
        reference = np.asarray(dataset["reference_pressure"][step].values)
        reference = reference if np.isfinite(reference).all() else None
    row, column = _middle(pressure)
    view = _view(pressure if reference is None else np.abs(pressure) + np.abs(reference))
    stress = scale_for(pressure if reference is None else [pressure.max(), reference.max()], "Pa")
    lines: list[tuple[str, str, NDArray[Any], NDArray[Any], tuple[Any, Any]]] = [
        ("x", place("y", y[row]), x, _edges(x, dataset, 0), (row, slice(view.x0, view.x1))),
        ("y", place("x", x[column]), y, _edges(y, dataset, 1), (slice(view.y0, view.y1), column)),
    ]
    lines = [line for line in lines if line[2].size > 1] or lines[:1]
    with paper_style():
        figure = new_figure(3.3 * len(lines) + (0.3 if len(lines) > 1 else 1.2), 2.9)
        panels = figure.subplots(1, len(lines), sharey=True, squeeze=False)[0]
        thinned = False
        for axes, (along, across, centres, edges, where) in zip(panels, lines, strict=True):
            part = where[along == "x"]
            length = scale_for(edges[part.start : part.stop + 1], "m")
            at = length(centres[part])
            every = max(1, -(-at.size // MARKERS))
            thinned = thinned or every > 1
            if reference is not None:
                axes.plot(at, stress(reference[where]), "-", color=COLOURS[1], label="closed form")
            axes.plot(
                at,
                stress(pressure[where]),
                "o" if reference is not None else "o-",
                color=COLOURS[0],
                markevery=every,
                markerfacecolor="none" if reference is not None else COLOURS[0],
                markeredgewidth=0.8,
                label="computed",
                zorder=3,
            )
            axes.set_xlabel(f"{along} [{length.unit}]")
            axes.set_xlim(float(length(edges[part.start])), float(length(edges[part.stop])))
            axes.set_title(f"along {along} at {across}")
        low = min(0.0, float(pressure.min()))
        high = max(float(pressure.max()), 0.0 if reference is None else float(reference.max())) or 1.0 / stress.factor
        panels[0].set_ylim(stress(low - 0.025 * (high - low)), stress(high + 0.06 * (high - low)))
        panels[0].set_ylabel(f"Pressure [{stress.unit}]")
        handles, labels = panels[0].get_legend_handles_labels()
        words = {
            "closed form": _difference_words(pressure, reference),
            "computed": "computed cells (not all marked)" if thinned else "computed cells",
        }
        order = sorted(range(len(labels)), key=lambda n: labels[n] != "computed")
        figure.legend(
            [handles[n] for n in order],
            [words[labels[n]] for n in order],
            loc="outside lower center",
            ncols=len(lines),
        )
        figure.suptitle(heading(dataset, step, "Contact pressure"), fontsize=9.5)
    return figure


def relative_difference(pressure: NDArray[Any], reference: NDArray[Any]) -> tuple[float, float]:
    """Relative difference from the reference: root of the summed squares over all cells, and of the maxima."""
    size, peak = float(np.linalg.norm(reference)), float(np.max(reference))
    if size == 0 or peak == 0:
        return float("nan"), float("nan")
    return float(np.linalg.norm(pressure - reference)) / size, abs(float(np.max(pressure)) - peak) / peak


def _difference_words(pressure: NDArray[Any], reference: NDArray[Any] | None) -> str:
    if reference is None:
        return "closed form"
    whole, peak = relative_difference(pressure, reference)
    if not np.isfinite(whole):
        return "closed form"
    return f"closed form (relative difference: {100 * whole:.2g} % in the L2 norm, {100 * peak:.2g} % at the maximum)"


def _surface(dataset: xr.Dataset, step: int) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any]]:
    return tuple(np.asarray(v.values, dtype=float) for v in (dataset["pressure"][step], dataset["x"], dataset["y"]))  # type: ignore[return-value]


def _edges(centres: NDArray[Any], dataset: xr.Dataset, axis: int) -> NDArray[Any]:
    """Edges of the cells along one axis [m]."""
    cell = float(np.atleast_1d(dataset.attrs["cell_size"])[axis])
    return np.append(centres - 0.5 * cell, centres[-1] + 0.5 * cell)


def _view(pressure: NDArray[Any]) -> Box:
    """Cells to show: the contact and room around it, all cells where there is no contact."""
    found = Box.around(pressure != 0)
    rows, columns = pressure.shape
    if found is None:
        return Box(0, rows, 0, columns)
    margins = [max(2, round(MARGIN * side)) for side in found.shape]
    return found.grown(margins[0], margins[1], (rows, columns))


def _middle(pressure: NDArray[Any]) -> tuple[int, int]:
    """Row and column of the profiles."""
    tolerance = 1e-6 * float(np.abs(pressure).max())
    if all(np.allclose(pressure, np.flip(pressure, axis), rtol=0, atol=tolerance) for axis in (0, 1)):
        return pressure.shape[0] // 2, pressure.shape[1] // 2
    row, column = np.unravel_index(int(np.argmax(pressure)), pressure.shape)
    return int(row), int(column)


def _outline(axes: Axes, contact: NDArray[np.bool_], x: NDArray[Any], y: NDArray[Any]) -> None:
    """Line along the cell edges around the contact (`x`, `y`: edges of the cells), unless it is ragged."""
    from matplotlib.collections import LineCollection

    box = Box.around(contact)
    rows, columns = np.nonzero(contact[1:] != contact[:-1])
    level = np.stack([np.stack([x[columns + n], y[rows + 1]], axis=-1) for n in (0, 1)], axis=1)
    rows, columns = np.nonzero(contact[:, 1:] != contact[:, :-1])
    upright = np.stack([np.stack([x[columns + 1], y[rows + n]], axis=-1) for n in (0, 1)], axis=1)
    # The outline of one convex patch is as long as that of the box around it.
    if box is None or len(level) + len(upright) > 3 * sum(box.shape):
        return
    axes.add_collection(
        LineCollection([*level, *upright], colors="0.15", linewidths=0.8, capstyle="projecting"), autolim=False
    )
