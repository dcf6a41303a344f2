"""Window, scales and colours that all frames of an animation share, and the place of a frame in its figure."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.viz.style import COLOURS

if TYPE_CHECKING:
    from collections.abc import Callable

    from matplotlib.axes import Axes
    from matplotlib.figure import SubFigure
    from numpy.typing import ArrayLike, NDArray

    from eigencontact.results.stored import Results

__all__ = ["Film", "Frame", "draw_way", "extremes"]


def extremes(values: NDArray[Any]) -> tuple[float, float]:
    """Smallest and largest number; zeros without any."""
    finite = values[np.isfinite(values)]
    return (float(finite.min()), float(finite.max())) if finite.size else (0.0, 0.0)


@dataclass(frozen=True)
class Film:
    """Fields of the steps of an animation (positions along ``step``, in order), and their common data."""

    dataset: Results
    steps: tuple[int, ...]
    _cache: dict[Any, Any] = field(default_factory=dict, repr=False)

    def limits(self, name: str, of: Callable[[NDArray[Any]], tuple[float, float]] = extremes) -> NDArray[np.float64]:
        """Smallest lower and largest upper limit (2,) of a field over the frames, in its SI unit."""
        if (name, of) not in self._cache:
            ranges = [of(np.asarray(self.dataset[name][step].values, dtype=float)) for step in self.steps]
            self._cache[name, of] = np.array([min(low for low, _ in ranges), max(high for _, high in ranges)])
        return np.asarray(self._cache[name, of])

    def touched(self, name: str) -> NDArray[np.bool_]:
        """Cells (ny, nx) in which a field is nonzero in at least one frame."""
        if name not in self._cache:
            cells = np.zeros(self.dataset[name].shape[-2:], dtype=bool)
            for step in self.steps:
                cells |= self.dataset[name][step].values != 0
            self._cache[name] = cells
        return np.asarray(self._cache[name])


@dataclass(frozen=True)
class Frame:
    """Request to draw a picture into a frame with the common view and colours of all frames.

    It is drawn in a subfigure, by default in a figure of its own.
    """

    film: Film
    subfigure: SubFigure | None = None


def draw_way(
    axes: Axes, x: ArrayLike, y: ArrayLike, until: int, *, colour: str = COLOURS[0], line: bool = True
) -> None:
    """Draw a curve up to a point: the whole curve faint, the part up to the point, and a dot at the point."""
    x, y = np.asarray(x), np.asarray(y)
    axes.plot(x, y, "-", color="0.82", linewidth=1.0, zorder=1, label="_")
    if line:
        axes.plot(x[: until + 1], y[: until + 1], "-", color=colour, zorder=2, label="_")
    axes.plot(x[until], y[until], "o", color=colour, markersize=5.5, zorder=5, label="_")
