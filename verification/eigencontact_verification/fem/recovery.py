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

__all__ = ["COUNT", "OFFSETS", "recovered", "recovered_stress", "stencil"]

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
        stencil(grid.lines[axis], points[:, axis], breaks=breaks[axis], mirrored=axis < 2 and symmetry[axis] != "none")
        for axis in range(3)
    ]
    (xs, wx), (ys, wy), (zs, wz) = stencils
    xs, ys, zs = (np.where(np.isnan(places), points[:, axis, None], places) for axis, places in enumerate((xs, ys, zs)))
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


def stencil(
    line: FloatArray, at: FloatArray, *, breaks: ArrayLike = (), mirrored: bool = False
) -> tuple[FloatArray, FloatArray]:
    """Places ``(n, COUNT)`` of Gauss points around coordinates, and the weights of Lagrange's interpolation.

    A stretch between breaks that is one element thick has two Gauss points: other places are NaN, their weights 0.

    Parameters
    ----------
    line : (m,) array
        Lines of the mesh along one axis.
    at : (n,) array
        Coordinates.
    breaks : sequence of float
        Lines of the mesh that are not reached across.
    mirrored : bool
        Whether mesh and breaks continue beyond 0 as their image.

    Raises
    ------
    ValueError
        No element lies between the breaks on both sides of a coordinate.
    """
    gauss, faces = _gauss_lines(line, mirrored=mirrored), np.sort(np.asarray(breaks, dtype=float))
    if mirrored:
        faces = np.sort(np.concatenate([faces, -faces]))
        # a face and its image that differ by round-off are one: nothing lies between them to interpolate from
        faces = faces[np.append(True, np.diff(faces) > 1e-9 * np.ptp(line))[: faces.size]]
    faces = np.concatenate([[-np.inf], faces, [np.inf]])
    stretch = np.searchsorted(faces, at) - 1
    low, high = np.searchsorted(gauss, faces[stretch]), np.searchsorted(gauss, faces[stretch + 1])
    if np.any(low == high):
        place = at[low == high][0]
        raise ValueError(f"faces must have elements between them (got none around {place:.9g}); merge them")
    first = np.clip(np.searchsorted(gauss, at) - COUNT // 2, low, np.maximum(high - COUNT, low))
    index = first[:, None] + np.arange(COUNT)
    places = np.where(index < high[:, None], gauss[np.minimum(index, gauss.size - 1)], np.nan)
    return places, _lagrange_weights(at, places)


def _gauss_lines(line: FloatArray, *, mirrored: bool) -> FloatArray:
    """Coordinates of the Gauss points between the lines of a mesh along one axis; mirrored at 0 on request."""
    gauss = (line[:-1, None] + np.diff(line)[:, None] * np.array(OFFSETS)).ravel()
    return np.concatenate([-gauss[::-1], gauss]) if mirrored else gauss


def _lagrange_weights(at: FloatArray, places: FloatArray) -> FloatArray:
    """Weights ``(n, COUNT)`` of Lagrange's interpolation from places to coordinates; 0 for a place that is NaN."""
    weights = np.ones_like(places)
    for i in range(COUNT):
        for j in range(COUNT):
            if i != j:
                factor = (at - places[:, j]) / (places[:, i] - places[:, j])
                weights[:, i] *= np.where(np.isnan(places[:, j]), 1.0, factor)
    return np.where(np.isnan(places), 0.0, weights)
