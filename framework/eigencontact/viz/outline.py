"""Outlines of inclusions over a picture."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

    from eigencontact.viz.style import Scale

__all__ = ["draw_outline"]


def draw_outline(axes: Axes, dataset: xr.Dataset, name: str, length: Scale) -> None:
    """Draw stored line segments, dark on a light ground so that they show on every colour; nothing where none are."""
    from matplotlib.collections import LineCollection

    if name not in dataset:
        return
    segments = length(np.asarray(dataset[name].values, dtype=float))
    for colour, width in (("1.0", 1.8), ("0.1", 0.8)):
        lines = LineCollection(list(segments), colors=colour, linewidths=width, capstyle="round", zorder=3)
        axes.add_collection(lines, autolim=False)
