"""Pictures of the load history."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from eigencontact.viz.style import COLOURS, new_figure, paper_style, scale_for

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

__all__ = ["load_history"]

#: With more steps than this, only some carry a marker.
MARKERS = 40


def load_history(dataset: xr.Dataset) -> Figure:
    """Normal load against approach, and contact area against normal load, through all steps.

    Parameters
    ----------
    dataset : xarray.Dataset
        Results of a run with several steps.

    Returns
    -------
    matplotlib.figure.Figure
        Two panels; the first step is marked by an open circle, so that loading and unloading can be told apart.
    """
    load, approach, area = (
        np.asarray(dataset[name].values, dtype=float) for name in ("normal_load", "approach", "contact_area")
    )
    force, length, surface = scale_for(load, "N"), scale_for(approach, "m"), scale_for(area, "m2")
    every = max(1, -(-load.size // MARKERS))
    with paper_style():
        figure = new_figure(6.6, 2.8)
        left, right = figure.subplots(1, 2)
        for axes, x, y in ((left, length(approach), force(load)), (right, force(load), surface(area))):
            axes.plot(x, y, "o-", color=COLOURS[0], markevery=every)
            axes.plot(x[:1], y[:1], "o", color=COLOURS[0], markerfacecolor="white", markersize=5)
        left.set(xlabel=f"Approach [{length.unit}]", ylabel=f"Normal load [{force.unit}]")
        right.set(xlabel=f"Normal load [{force.unit}]", ylabel=f"Contact area [{surface.unit}]")
        left.set_title("Load and approach")
        right.set_title("Contact area and load")
    return figure
