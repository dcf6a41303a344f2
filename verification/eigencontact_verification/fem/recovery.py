"""Stress of a model at points, recovered from where it is most exact.

Differentiated displacement is one order less exact than displacement, and its error changes sign within each element,
so that values at given points do not fall smoothly from mesh to mesh. At the 2 x 2 x 2 Gauss points of quadratic
hexahedra it is an order more exact (Barlow's points). On a tensor mesh these lie on lines along x, y and z: the stress
at a point is interpolated by cubics from the nearest ones on the point's own side of every face of the source. For the
axisymmetric meshes see `section_recovery`.

References
----------
J. Barlow 1976, Int. J. Numer. Methods Eng. 10, 243-251 (optimal stress points).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["COUNT", "OFFSETS", "gauss_lines", "lagrange_weights", "recovered", "recovered_stress"]

FloatArray = NDArray[np.float64]
Contains = Callable[[FloatArray, FloatArray, FloatArray], NDArray[np.bool_]]

#: Gauss points along an axis that a cubic interpolates.
COUNT = 4
#: Points whose 64 neighbours are evaluated together, for memory.
_AT_ONCE = 500
#: Places of the Gauss points in an element, in its edge.
OFFSETS = (0.5 - 0.5 / 3**0.5, 0.5 + 0.5 / 3**0.5)


class SolidSolution(Protocol):
    """Interface of a solution for the recovery of stress."""

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
    return recovered(solution.stress, solution.grid, solution.model.symmetry, points, breaks=breaks, side=contains)


def recovered(
    field: Callable[[FloatArray], FloatArray],
    grid: Any,
    symmetry: tuple[str, str],
    points: FloatArray,
    *,
    breaks: Sequence[ArrayLike] = ((), (), ()),
    side: Callable[[FloatArray, FloatArray, FloatArray], NDArray[Any]] | None = None,
) -> FloatArray:
    """A tensor ``(n, 3, 3)`` at points ``(n, 3)``, interpolated from the Gauss points of a tensor-product mesh.

    Parameters
    ----------
    field : callable
        Tensor ``(m, 3, 3)`` at points ``(m, 3)``.
    grid : Grid
        Mesh of `eigencontact_verification.fem.mesh`.
    symmetry : (str, str)
        As in `eigencontact_verification.fem.model.Model`.
    points, breaks
        As in `recovered_stress`.
    side : callable, optional
        As `contains` there; any numbers that tell sides apart.
    """
    stencils = [
        _stencil(grid.lines[axis], points[:, axis], np.sort(np.asarray(breaks[axis], dtype=float)),
                 mirrored=axis < 2 and symmetry[axis] != "none")
        for axis in range(3)
    ]  # fmt: skip
    (xs, wx), (ys, wy), (zs, wz) = stencils
    shape = (len(points), COUNT, COUNT, COUNT)
    samples = np.stack(
        [
            np.broadcast_to(xs[:, :, None, None], shape),
            np.broadcast_to(ys[:, None, :, None], shape),
            np.broadcast_to(zs[:, None, None, :], shape),
        ],
        axis=-1,
    )
    values = np.empty((*shape, 3, 3))
    for chunk in (slice(k, k + _AT_ONCE) for k in range(0, len(points), _AT_ONCE)):
        values[chunk] = field(samples[chunk].reshape(-1, 3)).reshape(*values[chunk].shape)
    tensor: FloatArray = np.einsum("ni,nj,nk,nijkab->nab", wx, wy, wz, values, optimize=True)
    if side is not None:
        side_of_points = np.asarray(side(*points.T))
        side_of_samples = np.asarray(side(*np.moveaxis(samples, -1, 0)))
        mixed = np.flatnonzero(np.any(side_of_samples != side_of_points[:, None, None, None], axis=(1, 2, 3)))
        if mixed.size:
            tensor[mixed] = field(points[mixed])
    return tensor


def _stencil(line: FloatArray, at: FloatArray, breaks: FloatArray, *, mirrored: bool) -> tuple[FloatArray, FloatArray]:
    """Places ``(n, count)`` of Gauss points around coordinates `at`, and the weights of Lagrange's interpolation.

    Raises
    ------
    ValueError
        No element lies between the breaks on both sides of a coordinate.
    """
    gauss = gauss_lines(line, mirrored=mirrored)
    if mirrored:
        breaks = np.sort(np.concatenate([breaks, -breaks]))
        # a face and its image that differ by round-off are one: nothing lies between them to interpolate from
        breaks = breaks[np.append(True, np.diff(breaks) > 1e-9 * np.ptp(line))[: breaks.size]]
    side = np.searchsorted(breaks, gauss)
    places = np.empty((at.size, COUNT))
    for row, (x, stretch) in enumerate(zip(at, np.searchsorted(breaks, at), strict=True)):
        choice = gauss[side == stretch]
        if not choice.size:
            raise ValueError(f"faces must have elements between them (got none around {x:.9g}); merge them")
        first = int(np.clip(np.searchsorted(choice, x) - COUNT // 2, 0, max(choice.size - COUNT, 0)))
        chosen = choice[first : first + COUNT]
        # a part of the body one element thick has two Gauss points: the line through them
        places[row] = np.concatenate([chosen, np.full(COUNT - chosen.size, np.nan)])
    return np.where(np.isnan(places), at[:, None], places), lagrange_weights(at, places)


def gauss_lines(line: FloatArray, *, mirrored: bool) -> FloatArray:
    """Coordinates of the Gauss points between the lines of a mesh along one axis; mirrored at 0 on request."""
    gauss = (line[:-1, None] + np.diff(line)[:, None] * np.array(OFFSETS)).ravel()
    return np.concatenate([-gauss[::-1], gauss]) if mirrored else gauss


def lagrange_weights(at: FloatArray, places: FloatArray) -> FloatArray:
    """Weights ``(n, COUNT)`` of Lagrange's interpolation from places to coordinates; 0 for a place that is NaN."""
    weights = np.ones_like(places)
    for i in range(COUNT):
        for j in range(COUNT):
            if i != j:
                factor = (at - places[:, j]) / (places[:, i] - places[:, j])
                weights[:, i] *= np.where(np.isnan(places[:, j]), 1.0, factor)
    return np.where(np.isnan(places), 0.0, weights)
