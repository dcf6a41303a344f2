"""Half-space under a uniformly loaded rectangle, by quadrature of the point-force solutions of Boussinesq and Cerruti.

Independent of every closed form of a rectangle. The point forces are K. L. Johnson 1985, Contact Mechanics,
eqs. 3.18-3.19 (normal) and 3.75-3.76 (tangential, corrected where equilibrium demands it), with 1 - z/R written as
r²/(R (R + z)) so that the axis r = 0 is no special place; `tests/plugins/test_surface_loads.py` checks them by
equilibrium and by Hooke's law.

Quadrature
----------
A rectangle that is farther away than its longest edge takes a product Gauss rule. A nearer one is halved until its
edges differ by a factor of two at most; what is then still near is the sum of four signed triangles that join its edges
to the foot of the field point. In a triangle of height d, the substitutions ``distance along the edge = d sinh s`` and
``radius = z sinh t`` make the integrand smooth at every scale, however small d and z are; panels of length two at most
carry a Gauss rule each.

Range of validity: z >= 0. A depth below 1e-18 of the shorter edge is taken as that depth: this is the limit from
inside the body. Where the stress itself is infinite (``xy`` of p at the corners, ``xx, yy, xy`` of a shear on the
edges, all at z = 0) the result is finite and means nothing. Elsewhere the results agree with closed forms to about
1e-12 of the largest component.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["point_force", "rectangle"]

FloatArray = NDArray[np.float64]

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(16)
_PANEL = 2.0
_FLAT = 1e-18


def point_force(load: str, x: FloatArray, y: FloatArray, z: FloatArray, nu: float) -> FloatArray:
    """Field of a unit force at the origin of the surface.

    Parameters
    ----------
    load : str
        ``"p"`` (force along +z), ``"q_x"`` or ``"q_y"``.
    x, y, z : array_like
        Field points [m], z > 0 or off the origin; z into the body.
    nu : float
        Poisson's ratio.

    Returns
    -------
    (9, ...) array
        G times the displacement along x, y, z [N/m], then the plain stress components xx, yy, zz, yz, xz, xy [Pa],
        tension positive.
    """
    if load == "q_y":
        v, u, w, syy, sxx, szz, sxz, syz, sxy = point_force("q_x", y, x, z, nu)
        return np.array([u, v, w, sxx, syy, szz, syz, sxz, sxy])
    x, y, z = np.broadcast_arrays(x, y, z)
    n = 1 - 2 * nu
    R = np.sqrt(x**2 + y**2 + z**2)
    S = R + z
    if load == "p":
        factor = 1 / (R * S)
        # (1 - z/R)/r² = 1/(R (R + z)); the terms of Johnson 3.19 in (x² - y²)/r⁴ and z y²/(r² R³) are then
        # 1/(R (R + z)) - y² (2R + z)/(R³ (R + z)²) with the sign of the second chosen by x or y.
        bend = (2 * R + z) / (R**3 * S**2)
        u = x * z / R**3 - n * x * factor
        v = y * z / R**3 - n * y * factor
        w = 2 * (1 - nu) / R + z**2 / R**3
        sxx = n * (factor - y**2 * bend) - 3 * z * x**2 / R**5
        syy = n * (factor - x**2 * bend) - 3 * z * y**2 / R**5
        szz = -3 * z**3 / R**5
        sxy = n * x * y * bend - 3 * x * y * z / R**5
        sxz = -3 * x * z**2 / R**5
        syz = -3 * y * z**2 / R**5
    else:
        u = 1 / R + x**2 / R**3 + n * (1 / S - x**2 / (R * S**2))
        v = x * y / R**3 - n * x * y / (R * S**2)
        w = x * z / R**3 + n * x / (R * S)
        tail = 1 / (R**3 * S**2) + 2 / (R**2 * S**3)
        sxx = -3 * x**3 / R**5 + n * (x / R**3 - 3 * x / (R * S**2) + x**3 * tail)
        syy = -3 * x * y**2 / R**5 + n * (x / R**3 - x / (R * S**2) + x * y**2 * tail)
        szz = -3 * x * z**2 / R**5
        sxy = -3 * x**2 * y / R**5 + n * (-y / (R * S**2) + x**2 * y * tail)
        sxz = -3 * x**2 * z / R**5
        syz = -3 * x * y * z / R**5
    out = np.array([u, v, w, sxx, syy, szz, syz, sxz, sxy]) / (2 * np.pi)
    out[:3] /= 2
    return out


def rectangle(
    load: str,
    point: tuple[float, float, float],
    half_widths: tuple[float, float],
    nu: float,
    shear_modulus: float = 1.0,
) -> FloatArray:
    """Field at one point of a unit traction on |x| <= a, |y| <= b.

    Parameters
    ----------
    load : str
        ``"p"`` (pushes along +z), ``"q_x"`` or ``"q_y"`` (act on the body along +x, +y).
    point : (float, float, float)
        Field point minus centre of the rectangle [m], z >= 0 into the body.
    half_widths : (float, float)
        a, b [m].
    nu : float
        Poisson's ratio.
    shear_modulus : float
        G [Pa].

    Returns
    -------
    (9,) array
        Displacement along x, y, z [m/Pa] and plain stress components xx, yy, zz, yz, xz, xy [-], tension positive.

    Examples
    --------
    >>> field = rectangle("p", (0.0, 0.0, 0.0), (1.0, 1.0), 0.3)
    >>> love = 8 * np.arcsinh(1) * 0.7 / (2 * np.pi)
    >>> round(float(field[2] / love), 12), round(float(field[5]), 12)
    (1.0, -1.0)
    """
    x, y, z = point
    z = max(z, _FLAT * min(half_widths))
    out = np.zeros(9)
    for box in _pieces((x, y, *half_widths), z):
        out += _gauss_box(load, box, z, nu) if _is_far(box, z) else _triangles(load, box, z, nu)
    out[:3] /= shear_modulus
    return out


# Part of the loaded rectangle: the field point minus its centre, and its half widths.
Box = tuple[float, float, float, float]


def _is_far(box: Box, z: float) -> bool:
    x, y, a, b = box
    dx, dy = max(abs(x) - a, 0.0), max(abs(y) - b, 0.0)
    return bool(dx * dx + dy * dy + z * z >= (2 * max(a, b)) ** 2)


def _pieces(box: Box, z: float) -> Iterator[Box]:
    """Halve the longer edge of what is near and elongated."""
    x, y, a, b = box
    if _is_far(box, z) or max(a, b) <= 2 * min(a, b):
        yield box
        return
    halves = ((x - s * a / 2, y, a / 2, b) if a > b else (x, y - s * b / 2, a, b / 2) for s in (-1, 1))
    for half in halves:
        yield from _pieces(half, z)


def _panels(start: float, stop: float) -> tuple[FloatArray, FloatArray]:
    """Composite Gauss rule on panels no longer than `_PANEL`."""
    count = max(1, int(np.ceil((stop - start) / _PANEL)))
    edges = np.linspace(start, stop, count + 1)
    half = 0.5 * (stop - start) / count
    middles = 0.5 * (edges[1:] + edges[:-1])
    return (middles[:, None] + half * _NODES).ravel(), np.tile(half * _WEIGHTS, count)


def _gauss_box(load: str, box: Box, z: float, nu: float) -> FloatArray:
    x, y, a, b = box
    values = point_force(load, (x - a * _NODES)[:, None], (y - b * _NODES)[None, :], np.array(z), nu)
    return np.asarray(np.einsum("cij,i,j->c", values, a * _WEIGHTS, b * _WEIGHTS))


def _triangles(load: str, box: Box, z: float, nu: float) -> FloatArray:
    """Four signed triangles from the foot of the field point to the edges, in (s, t) of the module docstring."""
    x, y, a, b = box
    x0, x1, y0, y1 = x - a, x + a, y - b, y + b
    out = np.zeros(9)
    # distance of the edge from the foot, outward normal, range along the edge
    edges = ((x1, (1, 0), y0, y1), (-x0, (-1, 0), y0, y1), (y1, (0, 1), x0, x1), (-y0, (0, -1), x0, x1))
    for signed, (nx, ny), start, stop in edges:
        d = abs(signed)
        if d < 1e-14 * (abs(x0) + abs(x1) + abs(y0) + abs(y1)):
            continue  # a triangle without area
        s, weight_s = _panels(float(np.arcsinh(start / d)), float(np.arcsinh(stop / d)))
        side = np.sign(signed)
        normal, along = side / np.cosh(s), np.tanh(s)  # direction of the ray, its normal part outward or inward
        ray_x = normal * nx + along * abs(ny)
        ray_y = normal * ny + along * abs(nx)
        top = np.arcsinh(d * np.cosh(s) / z)
        u, weight_u = _panels(0.0, float(top.max()))
        u, weight_u = u / top.max(), weight_u / top.max()
        t = top[:, None] * u
        rho = z * np.sinh(t)
        area = (side * weight_s / np.cosh(s) * top)[:, None] * weight_u * rho * z * np.cosh(t)
        values = point_force(load, rho * ray_x[:, None], rho * ray_y[:, None], np.array(z), nu)
        out += np.einsum("cij,ij->c", values, area)
    return out
