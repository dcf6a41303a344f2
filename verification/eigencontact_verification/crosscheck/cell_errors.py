"""Numerical error of judged values: from runs with fewer cells, and widened where it vanishes by chance."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

__all__ = ["from_coarser", "widened"]

FloatArray = NDArray[np.float64]

#: Least error of a component, in its largest error on the profile.
_LEAST = 0.5


def from_coarser(
    fine: FloatArray, coarser: Iterable[FloatArray], ratios: Sequence[float], *, order: float = 1.0
) -> FloatArray:
    """Error of the finest values if it falls with an order in the cell size; the worst of all comparisons counts.

    Parameters
    ----------
    fine : (n, components) float64
        Values by the smallest cells.
    coarser : iterable of (n, components) float64
        Values by larger cells.
    ratios : sequence of float
        Cell size of each of these over the smallest.
    order : float
        Assumed order of convergence.
    """
    differences = zip(coarser, ratios, strict=True)
    return np.asarray(np.maximum.reduce([np.abs(fine - values) / (ratio**order - 1) for values, ratio in differences]))


def widened(error: FloatArray) -> FloatArray:
    """Largest error of three neighbours, and at least half of the largest error of the profile.

    Errors ``(n, components)`` of a smooth field do not vanish where two values are equal by chance.

    Examples
    --------
    >>> widened(np.array([[0.0], [0.0], [0.0], [4.0]])).ravel().tolist()
    [2.0, 2.0, 4.0, 4.0]
    """
    index = np.arange(len(error))
    near = [error[np.clip(index + step, 0, len(index) - 1)] for step in (-1, 0, 1)]
    return np.asarray(np.maximum.reduce([*near, np.broadcast_to(_LEAST * error.max(axis=0), error.shape)]))
