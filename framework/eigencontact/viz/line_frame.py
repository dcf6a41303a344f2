"""Frames of a contact of one row of cells: pressure, or shear between its bounds, as curves where others have maps."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from eigencontact.viz.frame import Film, Frame
from eigencontact.viz.friction import tint_stick
from eigencontact.viz.lines import line_figure, surface_line_at
from eigencontact.viz.style import COLOURS, heading, paper_style, scale_for
from eigencontact.viz.window import view_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from eigencontact.results.stored import Results

__all__ = ["pressure_curve", "shear_curve"]


def pressure_curve(dataset: Results, step: int = -1, on: Frame | None = None) -> Figure:
    """Contact pressure of one step along x."""
    return _curve(dataset, "pressure", "Contact pressure", step, on)


def shear_curve(dataset: Results, step: int = -1, on: Frame | None = None) -> Figure:
    """Shear traction of one step along x, between the bounds of friction; the stick zone is tinted."""
    return _curve(dataset, "shear_x", "Shear traction", step, on)


def _curve(dataset: Results, name: str, words: str, step: int, on: Frame | None) -> Figure:
    film = Film(dataset, (step,)) if on is None else on.film
    bounded = name != "pressure" and "shear_bound" in dataset
    line = surface_line_at(dataset, "x", (0, 0), view_of(film.touched("pressure")))
    low, high = film.limits(name)
    if bounded:
        low, high = -film.limits("shear_bound")[1], film.limits("shear_bound")[1]
    stress, length = scale_for([low, high], "Pa"), scale_for(line.edges, "m")
    with paper_style():
        figure = line_figure(1, 2.9, on)
        axes = figure.add_subplot()
        for sign in (1, -1) if bounded else ():
            bound = sign * np.asarray(dataset["shear_bound"][step].values, dtype=float)[line.where]
            axes.plot(length(line.at), stress(bound), color="0.75", linewidth=2.5)
        if bounded:
            tint_stick(axes, np.asarray(dataset["contact_zone"][step].values)[line.where], length(line.edges))
        values = np.asarray(dataset[name][step].values, dtype=float)
        axes.plot(length(line.at), stress(values[line.where]), color=COLOURS[0], linewidth=1.2)
        axes.axhline(0.0, color="0.6", linewidth=0.6, zorder=0)
        line.finish(axes, length, np.asarray(dataset["pressure"][step].values, dtype=float))
        axes.set_xlim(*length(line.edges[[0, -1]]))
        room = 0.06 * (high - low) or 1.0 / stress.factor
        axes.set_ylim(stress(low - room), stress(high + room))
        axes.set_ylabel(f"{words} [{stress.unit}]")
        axes.set_title(heading(dataset, step, words))
    return figure
