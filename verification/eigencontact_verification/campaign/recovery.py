"""Stress of a solid model at points, recovered from where it is most exact.

Differentiated displacement is one order less exact than displacement, and its error changes sign within each element,
so that values at given points do not fall smoothly from mesh to mesh. At the 2 x 2 x 2 Gauss points of quadratic
hexahedra it is an order more exact (Barlow's points). On a tensor mesh these lie on lines along x, y and z: the stress
at a point is interpolated by cubics from the nearest ones on the point's own side of every face of the source.

References
----------
J. Barlow 1976, Int. J. Numer. Methods Eng. 10, 243-251 (optimal stress points); O. C. Zienkiewicz and J. Z. Zhu 1992,
Int. J. Numer. Methods Eng. 33, 1331-1364 (superconvergent patch recovery).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

__all__ = ["recovered_stress"]

FloatArray = NDArray[np.float64]
Contains = Callable[[FloatArray, FloatArray, FloatArray], NDArray[np.bool_]]

_COUNT = 4
_OFFSETS = (0.5 - 0.5 / 3**0.5, 0.5 + 0.5 / 3**0.5)


class SolidSolution(Protocol):
    """What is asked of a solution."""

    model: Any
    grid: Any

    def stress(self, points: FloatArray) -> FloatArray:
        """Stress ``(n, 3, 3)`` at points ``(n, 3)``."""
        ...


def recovered_stress(
    solution: SolidSolution,
    points: FloatArray,
    *,
    breaks: Sequence[Sequence[float]] = ((), (), ()),
    contains: Contains | None = None,
) -> FloatArray:
    """Stress ``(n, 3, 3)`` at points ``(n, 3)``.

    Parameters
    ----------
    solution : Solution
        Of `eigencontact_verification.fem.solve`.
    points : (n, 3) array
        Places off the boundary of the source.
    breaks : three sequences of float
        Coordinates along x, y, z that the interpolation must not reach across.
    contains : callable, optional
        The source, where its boundary is not made of planes at `breaks`. A point whose neighbours do not all lie on
        its own side of it keeps its own value.
    """
    stencils = [
        _stencil(solution.grid.lines[axis], points[:, axis], np.sort(np.asarray(breaks[axis], dtype=float)),
                 mirrored=axis < 2 and solution.model.symmetry[axis] != "none")
        for axis in range(3)
    ]  # fmt: skip
    (xs, wx), (ys, wy), (zs, wz) = stencils
    shape = (len(points), _COUNT, _COUNT, _COUNT)
    samples = np.stack(
        [
            np.broadcast_to(xs[:, :, None, None], shape),
            np.broadcast_to(ys[:, None, :, None], shape),
            np.broadcast_to(zs[:, None, None, :], shape),
        ],
        axis=-1,
    )
    values = solution.stress(samples.reshape(-1, 3)).reshape(*shape, 3, 3)
    found: FloatArray = np.einsum("ni,nj,nk,nijkab->nab", wx, wy, wz, values)
    if contains is not None:
        own = np.asarray(contains(*points.T))
        others = np.asarray(contains(*np.moveaxis(samples, -1, 0)))
        mixed = np.flatnonzero(np.any(others != own[:, None, None, None], axis=(1, 2, 3)))
        if mixed.size:
            found[mixed] = solution.stress(points[mixed])
    return found


def _stencil(line: FloatArray, at: FloatArray, breaks: FloatArray, *, mirrored: bool) -> tuple[FloatArray, FloatArray]:
    """Places ``(n, count)`` of Gauss points around coordinates `at`, and the weights of Lagrange's interpolation."""
    gauss = (line[:-1, None] + np.diff(line)[:, None] * np.array(_OFFSETS)).ravel()
    if mirrored:
        gauss = np.concatenate([-gauss[::-1], gauss])
        breaks = np.sort(np.concatenate([breaks, -breaks]))
    side = np.searchsorted(breaks, gauss)
    places = np.empty((at.size, _COUNT))
    for row, (x, own) in enumerate(zip(at, np.searchsorted(breaks, at), strict=True)):
        choice = gauss[side == own]
        first = int(np.clip(np.searchsorted(choice, x) - _COUNT // 2, 0, max(choice.size - _COUNT, 0)))
        chosen = choice[first : first + _COUNT]
        # a part of the body one element thick has two Gauss points: the line through them
        places[row] = np.concatenate([chosen, np.full(_COUNT - chosen.size, np.nan)])
    weights = np.ones_like(places)
    for i in range(_COUNT):
        for j in range(_COUNT):
            if i != j:
                factor = (at - places[:, j]) / (places[:, i] - places[:, j])
                weights[:, i] *= np.where(np.isnan(places[:, j]), 1.0, factor)
    lost = np.isnan(places)
    return np.where(lost, at[:, None], places), np.where(lost, 0.0, weights)
