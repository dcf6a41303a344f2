"""Strokes and cycles of a history drawn over each other, each in the colour of its number."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from eigencontact.viz.style import COLOURS

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from matplotlib.colors import Normalize
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

__all__ = ["Strand", "draw_strands"]

#: Colours of the numbers.
COLOUR_MAP = "viridis"
#: End of the colour map in use: white paper swallows the yellow beyond it.
BRIGHTEST = 0.88
#: Ticks of a colour bar lie at least this part of its length apart.
TICK_ROOM = 0.08
#: Numbers of which half lie below this part of the largest have a logarithmic colour bar.
EARLY = 0.25
#: Strands of more points than this have no markers.
MARKERS = 60


@dataclass(frozen=True)
class Strand:
    """Consecutive steps of a history: one stroke or one cycle.

    Attributes
    ----------
    first, last : int
        Positions along ``step`` of its two ends.
    number : float
        Number of the stroke or cycle.
    """

    first: int
    last: int
    number: float


def draw_strands(
    figure: Figure,
    axes: Axes,
    x: NDArray[np.float64],
    y: NDArray[np.float64],
    strands: Sequence[Strand],
    bar_label: str,
    *,
    markers: bool = True,
) -> None:
    """Draw each strand in its colour and a colour bar of the numbers; a single strand in blue, without a bar.

    Parameters
    ----------
    figure : Figure
        Takes the colour bar.
    axes : Axes
        Takes the curves.
    x, y : (steps,)
        Coordinates of all steps, in the units of the axes.
    strands : sequence of Strand
        In order of their numbers.
    bar_label : str
        Label of the colour bar: ``"Cycle"``.
    markers : bool
        Whether short strands have a marker at each step.
    """
    from matplotlib import colormaps
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import ListedColormap, LogNorm, Normalize

    numbers = [strand.number for strand in strands]
    several = len(strands) > 1
    low, high = numbers[0], numbers[-1]
    norm = LogNorm(low, high) if several and low > 0 and np.median(numbers) < EARLY * high else Normalize(low, high)
    colours = ListedColormap(colormaps[COLOUR_MAP](np.linspace(0.0, BRIGHTEST, 256)))
    for strand in strands:
        colour = colours(float(norm(np.array(strand.number)))) if several else COLOURS[0]
        steps = slice(strand.first, strand.last + 1)
        marker = "o" if markers and strand.last - strand.first < MARKERS else ""
        axes.plot(x[steps], y[steps], linestyle="-", marker=marker, markersize=2.2, color=colour, linewidth=1.0)
    if several:
        ticks = _ticks(numbers, norm)
        bar = figure.colorbar(ScalarMappable(norm, colours), ax=axes, ticks=ticks, pad=0.03, aspect=22)
        bar.ax.set_yticks(ticks, [f"{number:.7g}" for number in ticks])
        bar.ax.set_yticks([], minor=True)
        bar.set_label(bar_label)


def _ticks(numbers: Sequence[float], norm: Normalize) -> list[float]:
    """Numbers that have room on the colour bar, the last one among them."""
    ticks = [numbers[-1]]
    for number in reversed(numbers[:-1]):
        if float(norm(ticks[-1])) - float(norm(number)) >= TICK_ROOM:
            ticks.append(number)
    return ticks[::-1]
