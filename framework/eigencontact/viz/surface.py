"""Pictures of the surface: the pressure as a map and along two lines."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.viz.contact_edge import draw_contact_ends, runs_of
from eigencontact.viz.fitting import legend_below
from eigencontact.viz.outline import draw_outline_below
from eigencontact.viz.style import COLOURS, heading, new_figure, paper_style, scale_for
from eigencontact.viz.window import alike, cell_edges, contact_middle, contact_window, line_words, masked_map, view_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from eigencontact.core.grid import Box
    from eigencontact.results.stored import Results
    from eigencontact.viz.frame import Frame

__all__ = ["homogeneous_words", "pressure_map", "pressure_profiles", "relative_difference"]

#: With more cells than this along a profile, only some carry a marker.
MARKERS = 64


def pressure_map(dataset: Results, step: int = -1, on: Frame | None = None) -> Figure:
    """Contact pressure of one step as a map, cut to the contact and some room around it.

    Cells without pressure are grey; the outline of the contact is drawn where it is not ragged, those of inclusions
    below it are dashed.
    """
    pressure, _, _ = _surface(dataset, step)
    window = contact_window(dataset, pressure != 0 if on is None else on.film.touched("pressure"))
    figure = masked_map(
        window,
        pressure,
        unit="Pa",
        label="Pressure",
        title=heading(dataset, step, "Contact pressure"),
        outline=pressure != 0,
        empty="no contact",
        limits=None if on is None else on.film.limits("pressure"),
        on=on,
    )
    draw_outline_below(figure.axes[0], dataset, window.length)
    return figure


def pressure_profiles(dataset: Results, step: int = -1) -> Figure:
    """Contact pressure of one step along x and along y, beside the closed form where the run has one.

    Beside a contact with layers, inclusions or eigenstrain it is the closed form without them, under the same load.

    The lines pass through the middle of the contact; where it is in patches, through the cell of largest pressure.
    Markers are computed cells; faint lines are the ends of the contact.

    One panel along x, one along y; only one where the other direction has a single cell.
    """
    pressure, x, y = _surface(dataset, step)
    reference = None
    homogeneous = homogeneous_words(dataset)
    if homogeneous or "reference_pressure" in dataset:
        reference = np.asarray(dataset["homogeneous_pressure" if homogeneous else "reference_pressure"][step].values)
        reference = reference if np.isfinite(reference).all() else None
    row, column, central = contact_middle(pressure)
    pressed = pressure != 0 if reference is None else (pressure != 0) | (reference != 0)
    view = view_of(pressed)
    stress = scale_for(pressure if reference is None else [pressure.max(), reference.max()], "Pa")
    across, down = slice(view.x0, view.x1), slice(view.y0, view.y1)
    dx, dy = np.atleast_1d(dataset.attrs["cell_size"])
    titles = (
        line_words("x", "y", y[row], central=central, cell=dy),
        line_words("y", "x", x[column], central=central, cell=dx),
    )
    lines: list[tuple[str, str, NDArray[Any], NDArray[Any], tuple[Any, Any]]] = [
        ("x", titles[0], x, cell_edges(x, dataset, 0), (row, across)),
        ("y", titles[1], y, cell_edges(y, dataset, 1), (down, column)),
    ]
    lines = [line for line in lines if line[2].size > 1] or lines[:1]
    if alike(dataset, [pressure] if reference is None else [pressure, reference], [line[4] for line in lines]):
        lines = [("x", f"{lines[0][1]}, the same along y", *lines[0][2:])]
    with paper_style():
        figure = new_figure(3.3 * len(lines) + (0.3 if len(lines) > 1 else 1.2), 2.9)
        panels = figure.subplots(1, len(lines), sharey=True, squeeze=False)[0]
        thinned = False
        for axes, (along, line_title, centres, edges, where) in zip(panels, lines, strict=True):
            span = where[along == "x"]
            length = scale_for(edges[span.start : span.stop + 1], "m")
            at = length(centres[span])
            mark_every = max(1, -(-at.size // MARKERS))
            thinned = thinned or mark_every > 1
            if reference is not None:
                style = "--" if homogeneous else "-"
                axes.plot(at, stress(reference[where]), style, color=COLOURS[1], label="closed form")
            axes.plot(
                at,
                stress(pressure[where]),
                "o" if reference is not None and not homogeneous else "o-",
                color=COLOURS[0],
                markevery=mark_every,
                markerfacecolor="none" if reference is not None else COLOURS[0],
                markeredgewidth=0.8,
                linewidth=0.8 if homogeneous else None,
                label="computed",
                zorder=3,
            )
            axes.set_xlabel(f"{along} [{length.unit}]")
            axes.set_xlim(float(length(edges[span.start])), float(length(edges[span.stop])))
            axes.set_title(line_title)
            draw_contact_ends(axes, runs_of(pressure[where] != 0, edges[span.start : span.stop + 1]), length)
        low = min(0.0, float(pressure.min()))
        high = max(float(pressure.max()), 0.0 if reference is None else float(reference.max())) or 1.0 / stress.factor
        panels[0].set_ylim(stress(low - 0.025 * (high - low)), stress(high + 0.06 * (high - low)))
        panels[0].set_ylabel(f"Pressure [{stress.unit}]")
        handles, labels = panels[0].get_legend_handles_labels()
        legend_of = {
            "closed form": f"{homogeneous} (closed form)"
            if homogeneous
            else _difference_words(pressure, reference, view),
            "computed": "computed cells (not all marked)" if thinned else "computed cells",
        }
        order = sorted(range(len(labels)), key=lambda n: labels[n] != "computed")
        legend_below(figure, [handles[n] for n in order], [legend_of[labels[n]] for n in order], len(lines))
        figure.suptitle(heading(dataset, step, "Contact pressure"))
    return figure


def homogeneous_words(dataset: Results) -> str:
    """Body that the closed form beside a contact of inhomogeneous bodies describes; empty without a closed form."""
    if "homogeneous_pressure" not in dataset:
        return ""
    return "homogeneous body" if "residual_displacement_z" in dataset else "bare substrate"


def relative_difference(pressure: NDArray[Any], reference: NDArray[Any]) -> tuple[float, float]:
    """Relative difference from the reference: root of the summed squares over all cells, and of the maxima."""
    size, peak = float(np.linalg.norm(reference)), float(np.max(reference))
    if size == 0 or peak == 0:
        return float("nan"), float("nan")
    return float(np.linalg.norm(pressure - reference)) / size, abs(float(np.max(pressure)) - peak) / peak


def _difference_words(pressure: NDArray[Any], reference: NDArray[Any] | None, view: Box) -> str:
    """Label of the closed form with its relative difference from the pressure; both are zero outside the view."""
    if reference is None:
        return "closed form"
    in_norm, peak = relative_difference(pressure[view.slices], reference[view.slices])
    if not np.isfinite(in_norm):
        return "closed form"
    return f"closed form (relative difference: {100 * in_norm:.2g} % in the L2 norm, {100 * peak:.2g} % at the maximum)"


def _surface(dataset: Results, step: int) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any]]:
    return tuple(np.asarray(v.values, dtype=float) for v in (dataset["pressure"][step], dataset["x"], dataset["y"]))  # type: ignore[return-value]
