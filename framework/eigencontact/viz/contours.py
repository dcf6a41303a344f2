"""Filled contours of a section, drawn side by side where the material jumps."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.viz.frame import extremes
from eigencontact.viz.style import colour_range

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from eigencontact.viz.sides import Side, Sides
    from eigencontact.viz.style import Scale

    FloatArray = NDArray[np.float64]

__all__ = ["colour_ends", "contours_by_side", "draw_sides"]

#: Number of filled contours.
LEVELS = 14
#: Values beyond so many times the quantile do not set the range of the colours.
OUTLYING, COMMON = 1.3, 0.995
#: Colours begin at zero, unless all values are larger than this part of the largest.
NARROW = 0.3


def colour_ends(values: FloatArray) -> tuple[float, float]:
    """Smallest and largest value, without those that stand out at few points, as at an edge or beside a void."""
    size = np.abs(values[np.isfinite(values)])
    end = min(float(size.max()), OUTLYING * float(np.quantile(size, COMMON)) or np.inf) if size.size else 0.0
    return extremes(np.clip(values, -end, end))


def contours_by_side(
    axes: Axes,
    at: tuple[FloatArray, FloatArray],
    values: FloatArray,
    sides: Sides,
    *,
    length: Scale,
    limits: FloatArray,
    ends: FloatArray,
    cmap: str | None = None,
) -> Any:
    """Filled contours with round levels, each side by its own values and up to the border itself.

    Parameters
    ----------
    axes : Axes
        With z downwards already, where it is shown.
    at : (n,), (m,)
        Places along the horizontal and the vertical [m].
    values : (m, n)
        In the unit of the colour bar.
    sides : Sides
        Of these points.
    length : Scale
        Unit of both axes.
    limits, ends : arrays
        All values, or the smallest and the largest, and those that the colours are for.
    cmap : str, optional
        Colour map; by default one that suits the signs.

    Returns
    -------
    ContourSet or None
        For a colour bar; None where all limits are zero.
    """
    from matplotlib.ticker import MaxNLocator

    if not np.any(np.nan_to_num(limits)):
        return None
    colours, low, high = colour_range(ends)
    signed = low < 0 < high
    least = float(np.nanmin(limits))
    if low == 0.0 and least > NARROW * high:  # a close-up, whose values differ little
        low = least
    levels = MaxNLocator(nbins=LEVELS, symmetric=signed).tick_values(low, high)
    beyond = {(False, False): "neither", (True, False): "min", (False, True): "max", (True, True): "both"}
    extend = beyond[bool(least < levels[0]), bool(np.nanmax(limits) > levels[-1])]
    inner = [level for level in levels[::2] if np.nanmin(values) < level < np.nanmax(values)]
    lines = {"levels": inner, "colors": "0.15" if signed else "1.0"}
    return draw_sides(
        axes, at, values, sides, length=length, levels=levels, cmap=cmap or colours, extend=extend, lines=lines
    )


def draw_sides(
    axes: Axes,
    at: tuple[FloatArray, FloatArray],
    values: FloatArray,
    sides: Sides,
    *,
    length: Scale,
    levels: Sequence[float],
    cmap: str,
    extend: str = "neither",
    lines: dict[str, Any] | None = None,
) -> Any:
    """Filled contours between given levels, each side by its own values; thin lines at some of them."""
    x, y = length(at[0]), length(at[1])
    drawn = None
    for number, part in enumerate(sides.parts):
        level = 1.0 + number / len(sides.parts)  # bands of a side hide the lines of those below it
        field = np.ma.masked_invalid(sides.filled(values, part))
        bands = axes.contourf(x, y, field, levels=levels, cmap=cmap, extend=extend, zorder=level)
        bands.set_edgecolor("face")  # no seams between bands in a PDF
        bands.set_linewidth(0.1)
        made = [bands]
        if lines and any(field.min() < one < field.max() for one in lines["levels"]):
            made.append(axes.contour(x, y, field, linewidths=0.3, alpha=0.6, zorder=level, **lines))
        if len(sides.parts) > 1:
            for one in made:
                one.set_clip_path(_border(part, at, length), axes.transData)
        drawn = drawn or bands
    return drawn


def _border(part: Side, at: tuple[FloatArray, FloatArray], length: Scale) -> Any:
    """Border of a side, in the unit of the axes."""
    from matplotlib.path import Path

    (left, right), (top, bottom) = ((float(places.min()), float(places.max())) for places in at)
    corners = np.array([[left, top], [right, top], [right, bottom], [left, bottom], [left, top]])
    path = corners if part.outline is None else part.outline
    for depth, sign in zip(part.depths, (1.0, -1.0), strict=True):
        if np.isfinite(depth):
            path = _beyond(path, depth, sign)
    return Path(length(path), closed=False)


def _beyond(path: FloatArray, depth: float, sign: float) -> FloatArray:
    """Part of a closed path below (sign 1) or above (-1) a depth."""
    kept = []
    for a, b in pairwise(path):
        if sign * (a[1] - depth) >= 0:
            kept.append(a)
        if (a[1] - depth) * (b[1] - depth) < 0:
            kept.append(a + (depth - a[1]) / (b[1] - a[1]) * (b - a))
    return np.array([*kept, kept[0]]) if kept else path
