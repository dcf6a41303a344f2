"""Picture of a surface that is struck at many places: how often each place has been."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.viz.rolling import rolls
from eigencontact.viz.style import paper_style
from eigencontact.viz.window import Window, view_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from eigencontact.core.grid import Box
    from eigencontact.results.stored import Results

__all__ = ["coverage_map", "impacts", "strikes", "struck"]

#: Fewer impacts are no treatment of a surface.
FEWEST = 3
#: Points along the edge of a cell that draw the borders of prints.
FINER = 6
#: Share of touched neighbours from which on a point counts as touched.
HALF = 0.5


def impacts(dataset: Results) -> list[int]:
    """Positions along ``step`` of the largest load of each impact: what lies between steps without pressure."""
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
