"""Profile of a field of the surface along x or y, through the middle of the contact."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from eigencontact.viz.contact_edge import draw_contact_ends, runs_of
from eigencontact.viz.style import COLOURS, heading, new_figure, paper_style, scale_for
from eigencontact.viz.window import cell_edges, contact_middle, line_words

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from eigencontact.results.stored import Results
    from eigencontact.viz.cut import Shown, View

__all__ = ["SURFACE_LINES", "surface_line"]

#: Names of the lines, and their axes.
SURFACE_LINES = {"along-x": "x", "along-y": "y"}
#: Lines of more cells have no markers.
MARKERS = 80


def surface_line(dataset: Results, along: str, numbers: Shown, step: int, view: View) -> Figure:
    """Draw a field of the surface over one row or one column of its cells.

    The line passes through the middle of the contact, or through the largest pressure where the contact is in patches.
    Without a contact it passes through the middle of what the field has, or through its largest value.

    Parameters
    ----------
    along : {"x", "y"}
        Direction of the line.
    numbers : Shown
        Values (ny, nx) of the field.
    view : View
        ``horizontal`` is the part of the line that is seen.
    """
    pressure = np.zeros_like(numbers.values)
    if "pressure" in dataset:
        pressure = np.asarray(dataset["pressure"][step].values, dtype=float)
    row, column, central = contact_middle(pressure if pressure.any() else np.abs(numbers.values))
    axis, where = "xy".index(along), ((row, slice(None)) if along == "x" else (slice(None), column))
    x, y = (np.asarray(dataset[name].values, dtype=float) for name in "xy")
    across, at, places = ("y", float(y[row]), x) if along == "x" else ("x", float(x[column]), y)
    unit, length = scale_for(numbers.values[where], numbers.unit), scale_for(view.horizontal or places, "m")
    with paper_style():
        figure = new_figure(5.2, 3.0)
        axes = figure.add_subplot()
        marker = "o" if places.size <= MARKERS else ""
        axes.plot(length(places), unit(numbers.values[where]), "-", marker=marker, markersize=2.4, color=COLOURS[0])
        axes.axhline(0.0, color="0.6", linewidth=0.6, zorder=0)
        draw_contact_ends(axes, runs_of(pressure[where] != 0, cell_edges(places, dataset, axis)), length)
        axes.set_xlim(*length(view.horizontal or (places[0], places[-1])))
        axes.set(
            xlabel=f"{along} [{length.unit}]", ylabel=f"{numbers.words} [{unit.unit}]" if unit.unit else numbers.words
        )
        line = line_words(along, across, at, central=central)
        axes.set_title(f"{heading(dataset, step, numbers.words)}\n{line}")
    return figure
