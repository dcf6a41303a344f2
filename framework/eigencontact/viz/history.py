"""Pictures of the load history."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from eigencontact.viz.frame import draw_way
from eigencontact.viz.style import COLOURS, new_figure, paper_style, scale_for

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from eigencontact.results.stored import Results
    from eigencontact.viz.frame import Frame

__all__ = ["history_words", "load_history"]

#: With more steps than this, only some carry a marker.
MARKERS = 40


def load_history(dataset: Results, step: int = -1, on: Frame | None = None) -> Figure:
    """What was prescribed against what followed, and contact area, through all steps.

    Normal load against approach and contact area against load; where the load stays the same and a moment or a tilt
    changes, moment against tilt and contact area against moment.

    Parameters
    ----------
    dataset : Results
        Results of a run with several steps.
    step : int
        Position along ``step`` up to which a frame draws the curves.
    on : Frame, optional
        Frame of an animation to draw in; without one all steps are drawn.

    Returns
    -------
    matplotlib.figure.Figure
        Two panels; the first step is marked by an open circle, so that loading and unloading can be told apart.
    """
    force, way, words = _driver(dataset)
    loads, ways, area = (np.asarray(dataset[name].values, dtype=float) for name in (force, way, "contact_area"))
    unit = dict.fromkeys(("moment_x", "moment_y"), "N m")
    load_scale = scale_for(loads, unit.get(force, "N"))
    way_scale = scale_for(ways, "m" if way == "approach" else "rad")
    surface = scale_for(area, "m2")
    every = max(1, -(-loads.size // MARKERS))
    with paper_style():
        figure = new_figure(6.6, 2.8, on)
        left, right = figure.subplots(1, 2)
        curves = ((left, way_scale(ways), load_scale(loads)), (right, load_scale(loads), surface(area)))
        for axes, x, y in curves:
            if on is not None:
                draw_way(axes, x, y, step)
                continue
            axes.plot(x, y, "o-", color=COLOURS[0], markevery=every)
            axes.plot(x[:1], y[:1], "o", color=COLOURS[0], markerfacecolor="white", markersize=5)
        left.set(xlabel=f"{words[1]} [{way_scale.unit}]", ylabel=f"{words[0]} [{load_scale.unit}]")
        right.set(xlabel=f"{words[0]} [{load_scale.unit}]", ylabel=f"Contact area [{surface.unit}]")
        left.set_title(f"{words[0]} and {words[1].lower()}")
        right.set_title(f"Contact area and {words[0].lower()}")
    return figure


def history_words(dataset: Results) -> str:
    """What the picture shows, in a sentence."""
    force, way = _driver(dataset)[2]
    return f"{force} against {way.lower()}, and contact area against {force.lower()}."


def _driver(dataset: Results) -> tuple[str, str, tuple[str, str]]:
    """Force and displacement that change most through the history, and their names in words."""
    loads = np.asarray(dataset["normal_load"].values, dtype=float)
    if np.ptp(loads) > 1e-6 * np.abs(loads).max(initial=0.0):
        return "normal_load", "approach", ("Normal load", "Approach")
    for axis in "yx":
        force, way = f"moment_{axis}", f"tilt_{axis}"
        if force in dataset and np.ptp(dataset[way].values) > 0:
            moments = np.asarray(dataset[force].values, dtype=float)
            if np.ptp(moments) > 1e-6 * np.abs(moments).max():
                return force, way, (f"Moment about {axis}", f"Tilt about {axis}")
    return "normal_load", "approach", ("Normal load", "Approach")
