"""Field of one region with uniform eigenstrain at any points, exact up to the surface.

The points are taken in chunks that stay in cache, in parallel. A shape far away is replaced by its point sources, where
its closed form would cancel; a shape without Chi has it integrated from Phi of its mirror image.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.array_types import FloatArray
from eigencontact.core.parallel import available_threads, in_parallel
from eigencontact.halfspace.forms import INSIDE, Form, Kernel
from eigencontact.halfspace.mirror import integrated_chi
from eigencontact.halfspace.point_kernels import source_derivatives
from eigencontact.halfspace.potentials import (
    HasFarField,
    HasMirrorPotential,
    HasPotentials,
    Order,
    PointSources,
    derivatives,
)
from eigencontact.halfspace.theorem import response

__all__ = ["field_at_points", "unit_fields_at_points"]

Points = tuple[FloatArray, FloatArray, FloatArray]

# Points of one chunk: some eighty kernels of this length fit into the second-level cache of a core many times over.
_CHUNK = 2048


def field_at_points(
    shape: HasPotentials,
    eigenstrain: FloatArray,
    points: Points,
    *,
    poisson_ratio: float,
    quantity: str,
    space: str = "half",
    threads: int | None = None,
) -> FloatArray:
    """Field of a region with uniform eigenstrain.

    Parameters
    ----------
    shape : HasPotentials
        The region, in z >= 0.
    eigenstrain : (6,)
        Mandel eigenstrain [-].
    points : three arrays of shape (n,)
        Coordinates x, y, z [m]; z >= 0 in a half-space.
    poisson_ratio : float
        In (-1, 0.5], the end included.
    quantity : {"displacement", "strain", "stress"}
        Displacement [m], total strain, or stress in units of the shear modulus; strain and stress are Mandel vectors.
    space : {"half", "full"}
        With or without the free surface z = 0.

    Returns
    -------
    (3, n) or (6, n)
        Faces of the region take the mean of both sides; edges, where strain and stress are infinite, large values.
    """
    return _fields(shape, _weighted(response(quantity, poisson_ratio, space), eigenstrain), points, space, threads)


def _fields(shape: HasPotentials, forms: Sequence[Form], points: Points, space: str, threads: int | None) -> FloatArray:
    """Values of some forms, ``(len(forms), n)``."""
    x, y, z = (np.ascontiguousarray(values, dtype=float) for values in points)
    z = z + 0.0  # a surface point is seen from inside: no -0.0
    out = np.zeros((len(forms), x.size))
    far = shape.far_field().levels[0] if isinstance(shape, HasFarField) else None  # the fewest: derivatives are dear

    def fill(first: int) -> None:
        chunk = slice(first, first + _CHUNK)
        out[:, chunk] = _evaluate(shape, far, forms, (x[chunk], y[chunk], z[chunk]))

    in_parallel(threads or available_threads(), [partial(fill, first) for first in range(0, x.size, _CHUNK)])
    plane = np.flatnonzero(z == 0.0) if space == "full" else np.empty(0, dtype=int)
    if plane.size:  # no surface there: a face in z = 0 is like any other, the mean of both sides
        above = _evaluate(shape, far, forms, (x[plane], y[plane], np.full(plane.size, -0.0)))
        out[:, plane] = 0.5 * (out[:, plane] + above)
    return out


def unit_fields_at_points(
    shape: HasPotentials,
    points: Points,
    *,
    poisson_ratio: float,
    quantity: str,
    space: str = "half",
    threads: int | None = None,
) -> FloatArray:
    """Fields of a region with each of the six unit Mandel eigenstrains, ``(6, components, n)``.

    Parameters and components are those of `field_at_points`; the region's potentials are evaluated once for all six.
    """
    rows = response(quantity, poisson_ratio, space)
    forms = [form for unit in np.eye(6) for form in _weighted(rows, unit)]
    return _fields(shape, forms, points, space, threads).reshape(6, len(rows), -1)


def _weighted(forms: Sequence[Sequence[Form]], eigenstrain: FloatArray) -> list[Form]:
    """Forms of the field of one eigenstrain."""
    out = []
    for row in forms:
        total = Form()
        for value, form in zip(eigenstrain, row, strict=True):
            if value:
                total = total + Form({(p, k): float(value) * c for p, k, c in form})
        out.append(total)
    return out


def _evaluate(shape: HasPotentials, far: PointSources | None, forms: Sequence[Form], points: Points) -> FloatArray:
    kernels = sorted({kernel for form in forms for _, kernel, _ in form})
    powers = 1 + max((power for form in forms for power, _, _ in form), default=0)
    rows = {kernel: row for row, kernel in enumerate(kernels)}
    weights = np.zeros((powers, len(forms), len(kernels)))
    for component, form in enumerate(forms):
        for power, kernel, value in form:
            weights[power, component, rows[kernel]] = value
    values = _kernel_values(shape, far, kernels, points)
    out: FloatArray = np.einsum("ok,kn->on", weights[-1], values)
    for power in range(powers - 2, -1, -1):
        out = out * points[2] + np.einsum("ok,kn->on", weights[power], values)
    return out


def _kernel_values(
    shape: HasPotentials, far: PointSources | None, kernels: Sequence[Kernel], points: Points
) -> FloatArray:
    """Derivatives of a shape's potentials and of its image's, ``(len(kernels), n)``."""
    x, y, z = points
    out = np.empty((len(kernels), x.size))
    for origin in ("real", "image", "inside"):
        depth = -z if origin == "image" else z
        away = _in_far_field(far, x, y, depth)
        for mask, sources in ((~away, None), (away, far)):
            if not mask.any():
                continue
            everywhere = bool(mask.all())
            at = (x, y, depth) if everywhere else (x[mask], y[mask], depth[mask])
            for name in ("psi", "phi", "chi", ""):
                rows = [row for row, kernel in enumerate(kernels) if kernel[:2] == (origin, name)]
                if not rows:
                    continue
                values = _derivatives(shape, sources, (origin, name), [kernels[row][2] for row in rows], at)
                if everywhere:
                    out[rows] = values
                else:
                    out[np.array(rows)[:, None], np.flatnonzero(mask)] = values
    return out


def _in_far_field(far: PointSources | None, x: FloatArray, y: FloatArray, z: FloatArray) -> NDArray[np.bool_]:
    if far is None:
        return np.zeros(x.shape, dtype=bool)
    cx, cy, cz = far.center
    return np.asarray((x - cx) ** 2 + (y - cy) ** 2 + (z - cz) ** 2 >= far.distance**2)


def _derivatives(
    shape: HasPotentials,
    sources: PointSources | None,
    potential: tuple[str, str],
    orders: list[Order],
    at: Points,
) -> FloatArray:
    """Derivatives of one potential; `at` is the mirrored point for the image."""
    origin, name = potential
    x, y, z = at
    if origin == INSIDE[0]:
        if sources is not None:
            return np.zeros((1, x.size))
        trace = derivatives(shape, "phi", [(2, 0, 0), (0, 2, 0), (0, 0, 2)], x, y, z).sum(axis=0)
        # The Laplacian of Phi is -4 pi inside, a half, quarter or eighth of that on faces, edges and corners: rounding
        # errors are removed. A cell of a voxelised shape has any fraction of it, and keeps that.
        indicator = trace / (-4.0 * np.pi)
        eighths = np.round(8.0 * indicator) / 8.0
        return np.asarray(np.where(np.abs(indicator - eighths) < 1e-6, eighths, indicator))[None]
    if name == "chi":
        if sources is not None:
            return source_derivatives(sources, "chi", orders, x, y, -z)
        if isinstance(shape, HasMirrorPotential):
            return shape.chi(orders, x, y, -z)
        return integrated_chi(shape, orders, x, y, -z)
    if sources is not None:
        values = source_derivatives(sources, name, orders, x, y, z)
    else:
        values = derivatives(shape, name, orders, x, y, z)
    if origin == "image":
        signs = np.array([-1.0 if order[2] % 2 else 1.0 for order in orders])
        values = values * signs[:, None]
    return values
