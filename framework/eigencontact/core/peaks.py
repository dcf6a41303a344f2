"""Largest value of a surface from its cell means."""

from __future__ import annotations

import numpy as np

from eigencontact.core.array_types import FloatArray

__all__ = ["peak_of_means"]


def peak_of_means(means: FloatArray) -> float:
    """Largest value at a point of a surface, from its means over cells ``(ny, nx)``.

    A parabola along each axis has the means of the largest cell and its two neighbours. Along an axis on which the
    largest cell is the last, or the means have no maximum, the mean counts. The result is exact for a paraboloid, and
    does not depend, to second order in the edge of the cells, on where in a cell the maximum lies.

    Examples
    --------
    >>> edges = np.linspace(-2.2, 2.8, 6)
    >>> means = 1.0 - np.diff(edges**3) / 3.0
    >>> round(peak_of_means(means[None, :]), 12)
    1.0
    """
    j, i = np.unravel_index(int(np.argmax(means)), means.shape)
    rise = 0.0
    for line, n in ((means[:, i], int(j)), (means[j], int(i))):
        if not 0 < n < line.size - 1:
            continue
        slope, curvature = 0.5 * (line[n + 1] - line[n - 1]), line[n + 1] - 2.0 * line[n] + line[n - 1]
        if curvature < 0.0:
            offset = min(max(-slope / curvature, -0.5), 0.5)
            rise += -curvature / 24.0 + slope * offset + 0.5 * curvature * offset**2
    return float(means[j, i] + rise)
