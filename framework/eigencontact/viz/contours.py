"""Filled contours of a section, drawn side by side where the material jumps."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.viz.frame import extremes
from eigencontact.viz.sides import twice_area
from eigencontact.viz.style import colour_range

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.colors import Colormap
    from numpy.typing import NDArray

    from eigencontact.viz.sides import Side, Sides
    from eigencontact.viz.style import Scale

    FloatArray = NDArray[np.float64]

__all__ = ["colour_ends", "contour_lines", "contours_by_side", "draw_sides", "growing_levels", "grows", "name_largest"]

#: Number of filled contours.
LEVELS = 14
#: Values beyond so many times the quantile do not set the range of the colours.
OUTLYING = 1.3
#: Quantile of the values that sets the range of the colours.
COMMON = 0.995
#: Colours begin at zero, unless all values are larger than this part of the largest.
NARROW = 0.3
#: Levels grow by ratios where more than this part of a section has low values.
MOSTLY = 0.8
#: Values are low below this part of the end of the colours.
LOW = 0.12
#: Decades of levels that grow by ratios.
DECADES = 2
#: Levels in each decade.
IN_A_DECADE = (1.0, 1.5, 2.0, 3.0, 5.0, 7.0)


def colour_ends(values: FloatArray) -> tuple[float, float]:
    """Smallest and largest value without outliers at few points, such as at an edge or near a void."""
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
    visible: FloatArray,
    cmap: str | None = None,
) -> Any:
    """Filled contours with round levels, each side from its own values up to the border.

    The axes have z downwards already, where it is shown.

    Parameters
    ----------
    at : (n,), (m,)
        Places along the horizontal and the vertical [m].
    values : (m, n)
        In the unit of the colour bar.
    limits, ends : arrays
        All values, or the smallest and the largest, and those that the colours are for.
    visible : array
        Values in the part that is shown. Where most of them are small, the levels grow by ratios.

    Returns
    -------
    ContourSet or None
        For a colour bar; None where all limits are zero.
    """
    from matplotlib.colors import BoundaryNorm
    from matplotlib.ticker import MaxNLocator

    if not np.any(np.nan_to_num(limits)):
        return None
    colours, low, high = colour_range(ends)
    signed = low < 0 < high
    least = float(np.nanmin(limits))
    if low == 0.0 and least > NARROW * high:  # a close-up, whose values differ little
        low = least
    levels = np.asarray(MaxNLocator(nbins=LEVELS, symmetric=signed).tick_values(low, high))
    norm = None
    if low == 0.0 and float(np.mean(np.abs(visible[np.isfinite(visible)]) < LOW * high)) > MOSTLY:
        levels = growing_levels(high)
        norm = BoundaryNorm(levels, 256, extend="max" if np.nanmax(limits) > levels[-1] else "neither")
    extends = {(False, False): "neither", (True, False): "min", (False, True): "max", (True, True): "both"}
    extend = extends[bool(least < levels[0]), bool(np.nanmax(limits) > levels[-1])]
    inner = [level for level in levels[::2] if np.nanmin(values) < level < np.nanmax(values)]
    lines = {"levels": inner, "colors": "0.15" if signed else "1.0"}
    return draw_sides(
        axes, at, values, sides, length=length, levels=levels, cmap=cmap or colours, extend=extend, lines=lines,
        norm=norm,
    )  # fmt: skip


def growing_levels(end: float) -> FloatArray:
    """Levels 0, ..., 1, 1.5, 2, 3, ... up to the end of the colours, for fields with mostly small values.

    Examples
    --------
    >>> growing_levels(140.0).tolist()
    [0.0, 1.5, 2.0, 3.0, 5.0, 7.0, 10.0, 15.0, 20.0, 30.0, 50.0, 70.0, 100.0, 150.0]
    """
    first = math.floor(math.log10(end)) - DECADES
    steps = [factor * 10.0**power for power in range(first, first + DECADES + 2) for factor in IN_A_DECADE]
    above = next(n for n, level in enumerate(steps) if level >= end * (1 - 1e-9))
    return np.array([0.0, *steps[max(0, above - len(IN_A_DECADE) * DECADES) : above + 1]])


def grows(filled: Any) -> bool:
    """Whether the levels of filled contours grow by ratios."""
    return len(filled.levels) > 2 and not np.allclose(np.diff(filled.levels, 2), 0.0, atol=1e-6 * filled.levels[-1])


def name_largest(bar: Any, filled: Any, largest: float, text: str) -> None:
    """Write the largest value beside the end of a colour bar that does not reach it."""
    if largest > filled.levels[-1]:
        at: dict[str, Any] = {"xy": (0.5, 1.0), "xytext": (0, 11), "ha": "center", "va": "bottom"}
        if bar.orientation == "horizontal":
            at = {"xy": (1.0, 0.5), "xytext": (12, 0), "ha": "left", "va": "center"}
        bar.ax.annotate(text, xycoords="axes fraction", textcoords="offset points", fontsize="small", **at)


def draw_sides(
    axes: Axes,
    at: tuple[FloatArray, FloatArray],
    values: FloatArray,
    sides: Sides,
    *,
    length: Scale,
    levels: FloatArray,
    cmap: str | Colormap,
    extend: str = "neither",
    lines: dict[str, Any] | None = None,
    norm: Any = None,
) -> Any:
    """Filled contours between levels, each side from its own values; thin lines at some levels."""
    x, y = length(at[0]), length(at[1])
    lowest = None
    for number, side in enumerate(sides.parts):
        level = 1.0 + number / len(sides.parts)  # bands of a side hide the lines of those below it
        field = np.ma.masked_invalid(sides.filled(values, side))
        bands = axes.contourf(x, y, field, levels=levels, cmap=cmap, norm=norm, extend=extend, zorder=level)
        bands.set_edgecolor("face")  # no seams between bands in a PDF
        bands.set_linewidth(0.1)
        artists = [bands]
        if lines and any(field.min() < artist < field.max() for artist in lines["levels"]):
            artists.append(axes.contour(x, y, field, zorder=level, **{"linewidths": 0.3, "alpha": 0.6, **lines}))
        if len(sides.parts) > 1:
            for artist in artists:
                artist.set_clip_path(_border(side, at, length), axes.transData)
        lowest = lowest or bands
    return lowest


def contour_lines(
    axes: Axes, at: tuple[FloatArray, FloatArray], values: FloatArray, sides: Sides, *, length: Scale, level: float
) -> list[Any]:
    """Line at one level, each side from its own values up to its border; returns the lines of each side."""
    contours = []
    for side in sides.parts:
        field = sides.filled(values, side)
        if not field.min() < level < field.max():
            continue
        contours.append(axes.contour(length(at[0]), length(at[1]), field, levels=[level]))
        if len(sides.parts) > 1:
            contours[-1].set_clip_path(_border_with_holes(sides, side, at, length), axes.transData)
    return contours


def _border_with_holes(sides: Sides, side: Side, at: tuple[FloatArray, FloatArray], length: Scale) -> Any:
    """Border of a side with holes for inclusions: paths of opposite orientation."""
    from matplotlib.path import Path

    paths = [_border(side, at, length)]
    if side.outline is None:
        holes = [replace(side, outline=inclusion.outline) for inclusion in sides.parts if inclusion.outline is not None]
        paths += [_border(hole, at, length) for hole in holes]
    turned = [
        path.vertices[:: 1 if (twice_area(path.vertices) > 0) == (n == 0) else -1] for n, path in enumerate(paths)
    ]
    return Path.make_compound_path(*map(Path, turned))


def _border(side: Side, at: tuple[FloatArray, FloatArray], length: Scale) -> Any:
    """Border of a side, in the unit of the axes."""
    from matplotlib.path import Path

    (left, right), (top, bottom) = ((float(places.min()), float(places.max())) for places in at)
    corners = np.array([[left, top], [right, top], [right, bottom], [left, bottom], [left, top]])
    path = corners if side.outline is None else side.outline
    for depth, sign in zip(side.depths, (1.0, -1.0), strict=True):
        if np.isfinite(depth):
            path = _clipped_at_depth(path, depth, sign)
    return Path(length(path), closed=False)


def _clipped_at_depth(path: FloatArray, depth: float, sign: float) -> FloatArray:
    """Part of a closed path below (sign 1) or above (-1) a depth."""
    corners = []
    for a, b in pairwise(path):
        if sign * (a[1] - depth) >= 0:
            corners.append(a)
        if (a[1] - depth) * (b[1] - depth) < 0:
            corners.append(a + (depth - a[1]) / (b[1] - a[1]) * (b - a))
    return np.array([*corners, corners[0]]) if corners else path
