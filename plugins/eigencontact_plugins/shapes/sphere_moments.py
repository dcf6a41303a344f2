"""Potentials of polynomial densities over the unit ball, as sums of solid harmonics about its centre.

Densities are ρ = s r^(2k) R_l^m with 2k + l up to a degree, real and imaginary parts, with s for a mean square of one
over the boundary. Outside, with c = (l-m)! (l+m)! and n = 2k + 2,

    Phi = K I_l^m,    K = 4 pi / [(2l+1)(2l+2k+3) c]
    Psi = 4 pi / [(2l+1)(2l+3)(2l+2k+5) c] I_l^m - K/(2l-1) r² I_l^m

and inside

    Phi = -4 pi r^n R_l / [n(n+2l+1)] + 4 pi R_l / [n(2l+1)]
    Psi = -8 pi r^(n+2) R_l / [n(n+2l+1)(n+2)(n+2l+3)] + 4 pi r² R_l / [n(2l+1)(2l+3)] - 4 pi R_l / [(2l+1)(2l-1)(n+2)].

The mirror image has the density (-1)^(l+m) ρ at the mirror centre, and Chi = (-1)^(l+m) K I_(l-2)^m.

References
----------
E. W. Hobson 1931, The Theory of Spherical and Ellipsoidal Harmonics, ch. III (Newtonian potentials of such densities).
The biharmonic potentials and Chi were derived for this project from Laplacian Psi = 2 Phi and Chi,zz = Phi.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache, lru_cache
from math import factorial, pi, sqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact.plugin import FloatArray, Order
from eigencontact_plugins.shapes.solid_harmonics import ladder

__all__ = ["densities_of", "moment_sums", "rule"]

#: Points per block; their functions fit into the cache.
_CHUNK = 1024
#: Number of weighted sums per block.
_ROWS = 64
#: Largest number of derivatives for the half-space theorem.
_MOST = 5

Weights = Mapping[str, tuple[Sequence[Order], FloatArray]]


@cache
def _densities(degree: int) -> tuple[tuple[int, int, int, bool, float], ...]:
    """(k, l, m, imaginary, s) of the densities up to a degree, lower degrees first."""
    densities = []
    for total in range(degree + 1):
        for k in range(total // 2 + 1):
            low = total - 2 * k
            for m in range(low + 1):
                scale = sqrt((2 * low + 1) * factorial(low - m) * factorial(low + m) * (2 if m else 1))
                densities += [(k, low, m, imaginary, scale) for imaginary in (False, True)[: 2 if m else 1]]
    return tuple(densities)


def densities_of(degree: int, x: FloatArray, y: FloatArray, z: FloatArray) -> FloatArray:
    """Values of the densities at points in units of the radius from the centre, ``(n, points)``."""
    functions = ladder("inner", degree)
    rows = np.zeros((len(_densities(degree)), len(functions.indices)), dtype=complex)
    for row, (k, low, m, imaginary, scale) in enumerate(_densities(degree)):
        rows[row, functions.row[k, low, m]] = -1j * scale if imaginary else scale
    return np.asarray(functions.real_part(rows) @ functions.values(x, y, z))


@lru_cache(64)
def rule(counts: tuple[int, int, int]) -> tuple[FloatArray, FloatArray]:
    """Points ``(m, 3)`` and weights of the unit ball: Gauss along r with r², Gauss along cos, equal angles."""
    radial, polar, turns = counts
    # Gauss-Jacobi with weight r² on (0, 1) would save one or two points; Gauss-Legendre is simpler.
    r, of_r = np.polynomial.legendre.leggauss(radial)
    t, of_t = np.polynomial.legendre.leggauss(polar)
    r = 0.5 * (1.0 + r)
    of_r = 0.5 * of_r * r**2
    angle = 2 * pi * (np.arange(turns) + 0.5) / turns
    sine = np.sqrt(1.0 - t * t)
    across = sine[:, None, None] * np.array([np.cos(angle), np.sin(angle)]).T
    directions = np.concatenate((across, np.broadcast_to(t[:, None, None], (polar, turns, 1))), axis=2)
    points = (r[:, None, None, None] * directions).reshape(-1, 3)
    weights = (of_r[:, None, None] * of_t[:, None] * np.full(turns, 2 * pi / turns)).ravel()
    return points, weights


@cache
def _potentials(degree: int, where: str) -> dict[str, NDArray[np.complex128]]:
    """Coefficients ``(n, functions)`` of phi, psi and chi of the complex densities; imaginary parts have factor -i."""
    functions = ladder(where, degree + _MOST if where != "inner" else degree + 4)
    names = ("phi", "psi", "chi") if where == "image" else ("phi", "psi")
    out = {name: np.zeros((len(_densities(degree)), len(functions.indices)), dtype=complex) for name in names}
    for row, (k, low, m, imaginary, scale) in enumerate(_densities(degree)):
        n, size = 2 * k + 2, 2 * low + 1
        factor = scale * (-1j if imaginary else 1.0)
        if where == "inner":
            top = n * (n + size)
            phi = {(k + 1, low, m): -4 * pi / top, (0, low, m): 4 * pi / (n * size)}
            psi = {
                (k + 2, low, m): -8 * pi / (top * (n + 2) * (n + size + 2)),
                (1, low, m): 4 * pi / (n * size * (size + 2)),
                (0, low, m): -4 * pi / (size * (size - 2) * (n + 2)),
            }
            chi = {}
        else:
            c = factorial(low - m) * factorial(low + m)
            factor *= (-1.0) ** (low + m) if where == "image" else 1.0
            charge = 4 * pi / (size * (size + n) * c)
            phi = {(0, low, m): charge}
            psi = {
                (0, low, m): 4 * pi / (size * (size + 2) * (size + n + 2) * c),
                (1, low, m): -charge / (size - 2),
            }
            chi = {(0, low - 2, m): charge}
        for name, terms in zip(names, (phi, psi, chi), strict=False):
            for index, value in terms.items():
                out[name][row, functions.row[index]] = factor * value
    return out


@lru_cache(maxsize=64)
def _derivatives(degree: int, where: str, name: str, orders: tuple[Order, ...]) -> Any:
    """Real coefficients of derivatives of a potential, ``(2 half, n len(orders))``; sparse, because most are zero."""
    from scipy.sparse import csr_array  # late: most runs need no moments

    rows = _potentials(degree, where)[name]
    functions = ladder(where, degree + _MOST if where != "inner" else degree + 4)
    table = np.stack([functions.real_part(functions.differentiated(rows, order)) for order in orders], axis=1)
    return csr_array(table.reshape(-1, table.shape[2]).T)


def moment_sums(
    degree: int,
    where: str,
    weights: Weights,
    radius: float,
    points: tuple[FloatArray, FloatArray, FloatArray],
    tests: FloatArray | None = None,
) -> FloatArray:
    """Weighted sums ``(k, points)`` of derivatives of potentials; see `HasMomentSums` and `HasMomentIntegrals`.

    `where` is ``"inner"``, ``"outer"`` or ``"image"``; points are in units of the radius, from the corresponding
    centre. With `tests` ``(d, points)`` the sums are multiplied by each and summed over the points, ``(k, d)``.
    """
    functions = ladder(where, degree + _MOST if where != "inner" else degree + 4)
    count = len(next(iter(weights.values()))[1])
    total = np.zeros((count, 2 * len(functions.half)))
    for name, (orders, of_orders) in weights.items():
        scales = np.array([radius ** ((2 if name == "phi" else 4) - sum(order)) for order in orders])
        derivatives = _derivatives(degree, where, name, tuple(orders))
        for first in range(0, count, _ROWS):  # transposed sums that fit into a cache
            block = (of_orders[first : first + _ROWS] * scales).reshape(-1, derivatives.shape[1])
            total[first : first + _ROWS] += (derivatives @ block.T).T
    x, y, z = (np.ravel(axis) for axis in points)
    if tests is not None:
        products = np.zeros((2 * len(functions.half), len(tests)))
        for first in range(0, x.size, _CHUNK):
            span = slice(first, first + _CHUNK)
            products += functions.values(x[span], y[span], z[span]) @ tests[:, span].T
        return np.asarray(total @ products)
    out = np.empty((len(np.atleast_2d(total)), x.size))
    for first in range(0, x.size, _CHUNK):
        span = slice(first, first + _CHUNK)
        out[:, span] = total @ functions.values(x[span], y[span], z[span])
    return out.reshape(len(out), *np.shape(points[0]))
