"""Field of a uniform eigenstrain in a cuboid, by quadrature of Mindlin's solution over the six faces.

No potential, no corner sum: forces on the faces of the cuboid (see `mindlin`), point by point, inside, outside and on
the boundary. Derivatives of the point force's displacement are taken by complex steps.

Quadrature
----------
A face that is farther away than 3/4 of its longer edge takes a product Gauss rule. A nearer one is halved until what is
still near holds the foot of the field point and is no longer than twice its width. That part is the sum of triangles
that join its edges to the foot. In a triangle of height d, ``distance along the edge = d sinh s`` and
``radius = z sinh t`` (z the height of the field point above the face) make the integrand smooth at every scale.
Mirrored faces are treated alike about the foot of the field point in them.

A height of zero counts as 1e-18 of the shorter edge: on both sides with the mean taken, or on the inner side of the
body for a face in the surface. On an edge of the cuboid the strain is infinite and its result means nothing; the
displacement is right. Agreement with a twice finer rule is 1e-13 of the largest component (tests).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cache, partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eigencontact_verification.oracles import mindlin

__all__ = ["gradient_moments", "inside", "moments"]

FloatArray = NDArray[np.float64]

_GAUSS = 16
_PANEL = 2.0
_FLAT = 1e-18
_STEP = 1e-50
_NU = np.array(mindlin.NODES)[:, None]

# A rectangle seen from the foot of the field point in its plane: ranges of the two coordinates.
Box = tuple[float, float, float, float]


@cache
def _gauss_legendre(count: int) -> tuple[FloatArray, FloatArray]:
    nodes, weights = np.polynomial.legendre.leggauss(count)
    return nodes, weights


def _distance(box: Box, height: float) -> float:
    u0, u1, v0, v1 = box
    du, dv = max(u0, -u1, 0.0), max(v0, -v1, 0.0)
    return float(np.sqrt(du * du + dv * dv + height * height))


def _pieces(box: Box, height: float) -> Iterator[tuple[Box, bool]]:
    """Parts of the rectangle, and whether each is far; those that are not hold the foot of the field point."""
    u0, u1, v0, v1 = box
    a, b = u1 - u0, v1 - v0
    if _distance(box, height) >= 0.75 * max(a, b):
        yield box, True
    elif max(a, b) <= 2 * min(a, b) and u0 <= 0 <= u1 and v0 <= 0 <= v1:
        yield box, False
    elif a > b:
        middle = (u0 + u1) / 2
        yield from _pieces((u0, middle, v0, v1), height)
        yield from _pieces((middle, u1, v0, v1), height)
    else:
        middle = (v0 + v1) / 2
        yield from _pieces((u0, u1, v0, middle), height)
        yield from _pieces((u0, u1, middle, v1), height)


def _panels(start: float, stop: float, gauss: int) -> tuple[FloatArray, FloatArray]:
    count = max(1, int(np.ceil((stop - start) / _PANEL)))
    nodes, weights = _gauss_legendre(gauss)
    edges = np.linspace(start, stop, count + 1)
    half = 0.5 * (stop - start) / count
    return (0.5 * (edges[1:] + edges[:-1])[:, None] + half * nodes).ravel(), np.tile(half * weights, count)


def _product(box: Box, gauss: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    nodes, weights = _gauss_legendre(gauss)
    u0, u1, v0, v1 = box
    u = (u0 + u1) / 2 + (u1 - u0) / 2 * nodes
    v = (v0 + v1) / 2 + (v1 - v0) / 2 * nodes
    area = (u1 - u0) * (v1 - v0) / 4 * np.outer(weights, weights)
    return np.repeat(u, gauss), np.tile(v, gauss), area.ravel()


def _triangles(box: Box, height: float, gauss: int) -> Iterator[tuple[FloatArray, FloatArray, FloatArray]]:
    u0, u1, v0, v1 = box
    size = abs(u0) + abs(u1) + abs(v0) + abs(v1)
    # distance of the edge from the foot, its outward direction, its range along the other coordinate
    for signed, across_u, outward, start, stop in (
        (u1, True, 1, v0, v1), (-u0, True, -1, v0, v1), (v1, False, 1, u0, u1), (-v0, False, -1, u0, u1),
    ):  # fmt: skip
        d = abs(signed)
        if d < 1e-15 * size:
            continue  # a triangle without area
        s, weight_s = _panels(float(np.arcsinh(start / d)), float(np.arcsinh(stop / d)), gauss)
        top = np.arcsinh(d * np.cosh(s) / height)
        t, weight_t = _panels(0.0, float(top.max()), gauss)
        t, weight_t = t / top.max(), weight_t / top.max()
        radius = height * np.sinh(top[:, None] * t)
        slope = height * np.cosh(top[:, None] * t)
        weight = (np.sign(signed) * weight_s / np.cosh(s) * top)[:, None] * weight_t * radius * slope
        normal = radius * (np.sign(signed) * outward / np.cosh(s))[:, None]
        along = radius * np.tanh(s)[:, None]
        u, v = (normal, along) if across_u else (along, normal)
        yield u.ravel(), v.ravel(), weight.ravel()


def _rule(box: Box, height: float, gauss: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Nodes relative to the foot and weights on one rectangle."""
    rules: list[tuple[FloatArray, FloatArray, FloatArray]] = []
    for piece, far in _pieces(box, height):
        rules.extend([_product(piece, gauss)] if far else _triangles(piece, height, gauss))
    u, v, w = (np.concatenate(columns) for columns in zip(*rules, strict=True))
    return u, v, w


def _values(offset: Sequence[FloatArray], depth: float | None, *, gradient: bool) -> FloatArray:
    """Kelvin's numerator (depth None) or the image's, ``(i, j, nu, nodes)``; its gradient ``(i, j, l, nu, nodes)``."""

    def kernel(moved: Sequence[NDArray[Any]], shift: complex) -> NDArray[Any]:
        x, y, z = moved
        return mindlin.kelvin(x, y, z, _NU) if depth is None else mindlin.image(x, y, z, depth + shift, _NU)

    if not gradient:
        return kernel(offset, 0.0)
    slopes = []
    for axis in range(3):
        moved = [o + 1j * _STEP if i == axis else o for i, o in enumerate(offset)]
        slopes.append(kernel(moved, 1j * _STEP if axis == 2 else 0.0).imag / _STEP)
    return np.stack(slopes, axis=2)


def _one_point(
    point: FloatArray, center: FloatArray, edges: FloatArray, *, half: bool, gradient: bool, gauss: int
) -> FloatArray:
    floor = _FLAT * float(edges.min())
    total = np.zeros((3, 3, 3, 3, 3) if gradient else (3, 3, 3, 3))
    lower, upper = center - edges / 2, center + edges / 2
    lower = np.where(np.abs(lower) < 1e-15 * edges, 0.0, lower)
    for mirrored in (False, True) if half else (False,):
        sign = np.array([1.0, 1.0, -1.0]) if mirrored else np.ones(3)
        ends = np.sort(np.stack([lower * sign, upper * sign]), axis=0)
        for axis in range(3):
            p, q = [i for i in range(3) if i != axis]
            box = tuple(float(ends[e, i] - point[i]) for i in (p, q) for e in (0, 1))
            for face, plane in enumerate((lower[axis], upper[axis])):
                height = float(point[axis] - plane * sign[axis])
                heights: tuple[float, ...] = (height,)
                if abs(height) < floor:
                    in_surface = half and axis == 2 and point[2] == 0.0
                    heights = (floor,) if in_surface else (floor, -floor)
                u, v, weight = _rule(box, abs(heights[0]), gauss)  # type: ignore[arg-type]
                outward = (-1.0, 1.0)[face]
                for h in heights:
                    offset: list[FloatArray] = [np.empty(0)] * 3
                    offset[axis], offset[p], offset[q] = np.full_like(u, h), -u, -v
                    values = _values(offset, float(point[2]) if mirrored else None, gradient=gradient)
                    total[..., axis] += outward / len(heights) * np.moveaxis(values @ weight, -1, 0)
    # (nu, i, j, [l], k) -> (nu, i, [l], j, k)
    return np.swapaxes(total, 2, 3) if gradient else total


def _all_points(
    points: ArrayLike, center: ArrayLike, edges: ArrayLike, space: str, *, gradient: bool, gauss: int
) -> FloatArray:
    evaluate = partial(
        _one_point,
        center=np.asarray(center, dtype=float),
        edges=np.asarray(edges, dtype=float),
        half=space == "half",
        gradient=gradient,
        gauss=gauss,
    )
    return np.stack([evaluate(point) for point in np.atleast_2d(np.asarray(points, dtype=float))], axis=1)


def moments(
    points: ArrayLike, center: ArrayLike, edges: ArrayLike, space: str = "half", *, gauss: int = _GAUSS
) -> FloatArray:
    """Integrals of N_ij n_k over the faces, ``(3, n, i, j, k)`` [m], for `mindlin.displacement`.

    Parameters
    ----------
    points : (n, 3) array_like
        Field points [m], z >= 0 in a half-space.
    center, edges : (3,) array_like
        Middle and full edge lengths of the cuboid [m].
    space : str
        ``"half"`` or ``"full"``.
    gauss : int
        Nodes per panel.
    """
    return _all_points(points, center, edges, space, gradient=False, gauss=gauss)


def gradient_moments(
    points: ArrayLike, center: ArrayLike, edges: ArrayLike, space: str = "half", *, gauss: int = _GAUSS
) -> FloatArray:
    """Integrals of dN_ij/dx_l n_k, ``(3, n, i, l, j, k)``, for `mindlin.strain` and `mindlin.stress`."""
    return _all_points(points, center, edges, space, gradient=True, gauss=gauss)


def inside(points: ArrayLike, center: ArrayLike, edges: ArrayLike, space: str = "half") -> FloatArray:
    """Share of the cuboid at each point: 1 inside, 1/2 on a face, 1 on a face in the surface of the half-space."""
    x = np.atleast_2d(np.asarray(points, dtype=float))
    size = np.asarray(edges, dtype=float)
    depth = (np.abs(x - np.asarray(center, dtype=float)) - size / 2) / size
    share = np.where(depth > 1e-15, 0.0, np.where(depth < -1e-15, 1.0, 0.5))
    if space == "half":
        share[:, 2] = np.where((x[:, 2] == 0.0) & (share[:, 2] > 0.0), 1.0, share[:, 2])
    return np.asarray(share.prod(axis=1))
