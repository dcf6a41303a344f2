"""A field on the surface drawn on axes that may be a part of somebody's figure."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from eigencontact.viz.style import colour_range, label_plane, scale_for
from eigencontact.viz.window import cell_edges

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from eigencontact.results.stored import Results

__all__ = ["draw_field"]


def draw_field(dataset: Results, field: str, step: int, axes: Axes | None = None) -> Axes:
    """Map of a surface field of one step on axes, by default those of a new figure.

    A new figure is one of pyplot, which notebooks show.
    """
    if axes is None:
        from matplotlib import pyplot as plt

        axes = plt.subplots(figsize=(4.6, 3.7), layout="constrained")[1]
    values = np.asarray(dataset[field][step].values, dtype=float)
    x, y = (cell_edges(np.asarray(dataset[name].values), dataset, side) for side, name in enumerate("xy"))
    length, unit = scale_for([*x, *y], "m"), scale_for(values, str(dataset[field].attrs["units"]))
    colours, low, high = colour_range(unit(values))
    drawn = axes.pcolormesh(length(x), length(y), unit(values), cmap=colours, vmin=low, vmax=high or None)
    axes.set_aspect("equal")
    label_plane(axes, f"x in {length.unit}", f"y in {length.unit}")
    axes.set_title(str(dataset[field].attrs["long_name"]), fontsize="medium")
    axes.figure.colorbar(drawn, ax=axes, label=f"in {unit.unit}" if unit.unit else None)
    return axes
