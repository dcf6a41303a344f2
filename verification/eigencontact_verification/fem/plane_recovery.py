"""Stress in plane strain, read where it is most exact and continued to any point on its own side of every boundary.

At the 2 x 2 Gauss points of an element its stress is an order more exact than elsewhere (Barlow's points). On the
straight part of the mesh these lie on lines along x and z: cubics through the nearest ones. In the curved parts around
regions a cubic is fitted to the nearest ones by least squares. Neither reaches across the boundary of a region.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from eigencontact_verification.fem.plane_strain import PlaneBody
from eigencontact_verification.fem.recovery import stencil
from eigencontact_verification.fem.section_recovery import fitted, section_gauss_points

__all__ = ["recovered_plane"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]


def recovered_plane(
    body: PlaneBody,
    field: FloatArray,
    points: FloatArray,
    *,
    breaks: tuple[FloatArray, FloatArray],
    side: Callable[[FloatArray, FloatArray], IntArray],
) -> FloatArray:
    """Field at points, from its values at the 3 x 3 integration points.

    Parameters
    ----------
    body : PlaneBody
        Its mesh.
    field : (k, elements, 9) float64
    points : (n, 2) float64
        x and z, off the boundaries of regions.
    breaks : (n,), (m,) float64
        Lines of the mesh along z and along x that are not reached across.
    side : callable
        Number of the side of curved boundaries that a point lies on.

    Returns
    -------
    (k, n) float64
    """
    x, z = points.T
    grid = body.grid
    (xs, wx), (zs, wz) = (stencil(grid.lines[k], points[:, k], breaks=breaks[k]) for k in (0, 1))
    xs, zs = (np.where(np.isnan(places), places[:, :1], places) for places in (xs, zs))
    shape = (len(points), *xs.shape[1:], *zs.shape[1:])
    sample = np.stack((np.broadcast_to(xs[:, :, None], shape), np.broadcast_to(zs[:, None], shape)), axis=-1)
    straight = len(grid.marks) - len(grid.curved)
    curved = (
        grid.find(*sample.reshape(-1, 2).T)[0].reshape(shape) >= straight if len(grid.curved) else np.zeros(shape, bool)
    )
    loose = np.any(curved, axis=(1, 2))
    field_at_points = np.empty((len(field), len(points)))
    tensor, scattered = np.flatnonzero(~loose), np.flatnonzero(loose)
    if tensor.size:
        values = body.read(field, sample[tensor].reshape(-1, 2)).reshape(-1, *sample[tensor].shape[:-1])
        field_at_points[:, tensor] = np.einsum("ni,nj,cnij->cn", wx[tensor], wz[tensor], values)
    if scattered.size:
        gauss, element = section_gauss_points(grid.nodes)  # of which the second half is mirrored
        gauss, element = gauss[: len(gauss) // 2], element[: len(element) // 2]
        sides = side(*gauss.T)

        def values_at(chosen: IntArray) -> FloatArray:
            return body.read(field, gauss[chosen])

        field_at_points[:, scattered] = fitted(
            values_at, grid.nodes, gauss, element, sides, points[scattered], side(x[scattered], z[scattered])
        )
    return field_at_points
