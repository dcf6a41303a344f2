"""Field of a uniform eigenstrain in any region that can be parametrised, by quadrature of Mindlin's solution.

Two routes, which check each other:

* *inside or outside*: forces on the boundary, `boundary_moments` of positions and outward area vectors;
* *outside*: sources in the volume, `volume_moments` of positions and weights. The derivative with respect to the
  source is taken along a circle in the complex plane (Cauchy's formula). Nothing cancels, however far away the point.

Rules for `cuboid_nodes`, `ball_nodes`, `ellipsoid_nodes`, `torus_nodes`, and the boundaries of the last three, converge
geometrically when the point is off the region: 1e-12 at a distance of about the size of the region divided by
a quarter of the number of nodes along an angle. The results go to `mindlin.displacement`, `mindlin.strain` and
`mindlin.stress`.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eigencontact_verification.oracles import mindlin

__all__ = [
    "ball_nodes",
    "boundary_moments",
    "cuboid_nodes",
    "ellipsoid_boundary",
    "ellipsoid_nodes",
    "numerator",
    "sphere_rule",
    "torus_boundary",
    "torus_nodes",
    "volume_moments",
]

FloatArray = NDArray[np.float64]
#: Positions ``(m, 3)`` [m] with weights ``(m,)`` [m^3] or area vectors ``(m, 3)`` [m^2].
Rule = tuple[FloatArray, FloatArray]

_STEP = 1e-50
_CIRCLE = 0.1 * np.exp(2j * np.pi * np.arange(20) / 20)
_NU = np.array(mindlin.NODES)[:, None]


def sphere_rule(count: int) -> tuple[FloatArray, FloatArray]:
    """Unit vectors and solid angles: Gauss in the polar cosine, trapezoids around."""
    cosine, weight = np.polynomial.legendre.leggauss(count)
    angle = 2 * np.pi * (np.arange(2 * count) + 0.5) / (2 * count)
    sine = np.sqrt(1 - cosine**2)
    unit = np.stack(
        [np.outer(sine, np.cos(angle)), np.outer(sine, np.sin(angle)), np.outer(cosine, np.ones(2 * count))], axis=-1
    )
    return unit.reshape(-1, 3), np.repeat(weight * np.pi / count, 2 * count)


def _axes(semi_axes: ArrayLike, rotation: ArrayLike | None) -> FloatArray:
    turn = np.eye(3) if rotation is None else np.asarray(rotation, dtype=float)
    return np.asarray(turn * np.asarray(semi_axes, dtype=float))


def cuboid_nodes(center: ArrayLike, edges: ArrayLike, count: int | tuple[int, int, int] = 12) -> Rule:
    """Product Gauss rule in a cuboid of full edge lengths `edges` [m]; `count` nodes along each edge."""
    counts = (count,) * 3 if isinstance(count, int) else count
    rules = [np.polynomial.legendre.leggauss(n) for n in counts]
    grid = np.stack(np.meshgrid(*(nodes for nodes, _ in rules), indexing="ij"), axis=-1).reshape(-1, 3)
    half = np.asarray(edges, dtype=float) / 2
    weights = np.einsum("i,j,k->ijk", *(w for _, w in rules)).ravel() * half.prod()
    return np.asarray(center, dtype=float) + grid * half, weights


def ellipsoid_nodes(
    center: ArrayLike, semi_axes: ArrayLike, rotation: ArrayLike | None = None, count: int = 16
) -> Rule:
    """Spherical coordinates of an ellipsoid; the columns of `rotation` are its axes."""
    unit, solid = sphere_rule(count)
    nodes, weight = np.polynomial.legendre.leggauss(count)
    radius = (1 + nodes) / 2
    matrix = _axes(semi_axes, rotation)
    positions = (radius[:, None, None] * (unit @ matrix.T)).reshape(-1, 3)
    volume = np.outer(weight / 2 * radius**2, solid).ravel() * abs(np.linalg.det(matrix))
    return np.asarray(center, dtype=float) + positions, volume


def ellipsoid_boundary(
    center: ArrayLike, semi_axes: ArrayLike, rotation: ArrayLike | None = None, count: int = 32
) -> Rule:
    """Boundary of an ellipsoid; area vectors by Nanson's formula."""
    unit, solid = sphere_rule(count)
    matrix = _axes(semi_axes, rotation)
    area = solid[:, None] * (unit @ np.linalg.inv(matrix)) * abs(np.linalg.det(matrix))
    return np.asarray(center, dtype=float) + unit @ matrix.T, area


def ball_nodes(center: ArrayLike, radius: float, count: int = 16) -> Rule:
    """Spherical coordinates of a ball."""
    return ellipsoid_nodes(center, (radius,) * 3, None, count)


def _ring(count: int) -> tuple[FloatArray, FloatArray]:
    angle = 2 * np.pi * np.arange(count) / count
    return np.cos(angle), np.sin(angle)


def torus_nodes(center: ArrayLike, ring_radius: float, tube_radius: float, count: int = 32) -> Rule:
    """Torus about an axis parallel to z; `tube_radius` < `ring_radius`."""
    nodes, weight = np.polynomial.legendre.leggauss(max(8, count // 2))
    rho = tube_radius * (1 + nodes) / 2
    tube_cos, tube_sin = _ring(count)
    around_cos, around_sin = _ring(2 * count)
    radius = (ring_radius + np.outer(rho, tube_cos)).ravel()
    height = np.outer(rho, tube_sin).ravel()
    area = np.outer(tube_radius / 2 * weight * rho, np.full(count, 2 * np.pi / count)).ravel()
    positions = np.stack(
        [np.outer(radius, around_cos), np.outer(radius, around_sin), np.outer(height, np.ones(2 * count))], axis=-1
    )
    volume = np.repeat(area * radius * np.pi / count, 2 * count)
    return np.asarray(center, dtype=float) + positions.reshape(-1, 3), volume


def torus_boundary(center: ArrayLike, ring_radius: float, tube_radius: float, count: int = 64) -> Rule:
    """Boundary of a torus about an axis parallel to z."""
    tube_cos, tube_sin = _ring(count)
    around_cos, around_sin = _ring(2 * count)
    radius = ring_radius + tube_radius * tube_cos
    ones = np.ones(2 * count)
    positions = np.stack(
        [np.outer(radius, around_cos), np.outer(radius, around_sin), np.outer(tube_radius * tube_sin, ones)], axis=-1
    )
    normal = np.stack(
        [np.outer(tube_cos, around_cos), np.outer(tube_cos, around_sin), np.outer(tube_sin, ones)], axis=-1
    )
    area = tube_radius * radius * (2 * np.pi / count) * (np.pi / count)
    return np.asarray(center, dtype=float) + positions.reshape(-1, 3), (normal * area[:, None, None]).reshape(-1, 3)


def numerator(field: NDArray[Any], source: NDArray[Any], space: str) -> NDArray[Any]:
    """N_ij ``(3, 3, nu, nodes)`` of points ``(3, nodes)`` (or one field point, ``(3, 1)``)."""
    x, y = field[0] - source[0], field[1] - source[1]
    total = mindlin.kelvin(x, y, field[2] - source[2], _NU)
    if space == "half":
        total = total + mindlin.image(x, y, field[2] + source[2], field[2], _NU)
    return total


def boundary_moments(points: ArrayLike, rule: Rule, space: str = "half", *, gradient: bool = False) -> FloatArray:
    """Integrals of N_ij n_k over a boundary, ``(3, n, i, j, k)``, or of dN_ij/dx_l n_k, ``(3, n, i, l, j, k)``.

    For points inside and outside, off the boundary.
    """
    positions, area = rule
    out = []
    for point in np.atleast_2d(np.asarray(points, dtype=float)):
        x = point[:, None].astype(complex)
        if gradient:
            slopes = [
                numerator(x + 1j * _STEP * np.eye(3)[:, [axis]], positions.T, space).imag / _STEP for axis in range(3)
            ]
            out.append(np.einsum("lijvm,mk->viljk", np.array(slopes), area))
        else:
            out.append(np.einsum("ijvm,mk->vijk", numerator(x, positions.T, space).real, area))
    return np.stack(out, axis=1)


def _taylor(field: FloatArray, source: FloatArray, a: FloatArray, b: FloatArray, order: int, space: str) -> FloatArray:
    """Coefficient of t^order of N(field + t a, source + t b) for the points ``(3, m)``, by Cauchy's formula."""
    distance = np.sqrt(((field - source) ** 2).sum(axis=0))
    t = distance * _CIRCLE[:, None]
    x = field[:, None] + a[:, None, None] * t
    s = source[:, None] + b[:, None, None] * t
    values = numerator(x.reshape(3, -1), s.reshape(3, -1), space).reshape(3, 3, len(_NU), *t.shape)
    return np.asarray((values / t**order).mean(axis=-2).real)


def volume_moments(points: ArrayLike, rule: Rule, space: str = "half", *, gradient: bool = False) -> FloatArray:
    """Moments of `boundary_moments` as volume integrals of dN_ij/dx'_k; for points outside the region.

    Accuracy 1e-13 of the largest moment where the rule itself has converged.
    """
    positions, weights = rule
    unit, zero = np.eye(3), np.zeros(3)
    out = []
    for point in np.atleast_2d(np.asarray(points, dtype=float)):
        x = np.broadcast_to(point[:, None], positions.T.shape)
        s = positions.T
        if not gradient:
            first = np.stack([_taylor(x, s, zero, unit[k], 1, space) for k in range(3)], axis=-1)
            out.append(np.einsum("ijvmk,m->vijk", first, weights))
            continue
        field = [_taylor(x, s, unit[axis], zero, 2, space) for axis in range(3)]
        source = [_taylor(x, s, zero, unit[k], 2, space) for k in range(3)]
        mixed = np.array(
            [[_taylor(x, s, unit[m], unit[k], 2, space) - field[m] - source[k] for k in range(3)] for m in range(3)]
        )
        out.append(np.einsum("lkijvm,m->viljk", mixed, weights))
    return np.stack(out, axis=1)
