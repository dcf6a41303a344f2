"""Field of a uniformly loaded rectangle far from it: Gauss-Legendre sums of the point-force solutions.

The sum over the four corners of a rectangle of edges h >= w loses a relative (h/w)(d/h)² times a few rounding errors at
the distance d from the rectangle. From d = 1.25 h on (h/4 for a rectangle more elongated than 8, with a larger loss)
the integrand is so smooth that a Gauss rule of n points along an edge of half width c converges like q^(-2n), q = e +
sqrt(e² + 1), e = d/c. Each shell of distance has an n for an error of 1e-15.

Point forces: Boussinesq (along z) and Cerruti (along x), K. L. Johnson 1985, eqs. 3.18-3.19 and 3.75-3.76, with
1 - z/R in the form (x² + y²) / (R (R + z)). Here R > 0, s = 1 - 2ν, and

g = 1/(R (R + z)),  h = (2R + z)/(R³ (R + z)²),  k = 1/(R (R + z)²),  m = (3R + z)/(R³ (R + z)³).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache, cached_property

import numpy as np
from numpy.typing import NDArray

from eigencontact.plugin import FloatArray, Material
from eigencontact_plugins.surface_loads_corner import SWAPPED, per_traction

__all__ = ["gauss_field", "is_far"]

HalfWidths = tuple[float, float]

#: Inner radii of the shells with a common Gauss rule, as distances from the rectangle in longest edges.
SHELLS = (0.25, 0.5, 1.25, 3.0, 12.0, 200.0)


class PointForce:
    """Shared sub-expressions at the points (x, y, z) relative to the force, each computed at first use."""

    def __init__(self, x: FloatArray, y: FloatArray, z: FloatArray) -> None:
        self.x, self.y, self.z = x, y, z
        self.R = np.sqrt(x * x + y * y + z * z)
        self.R3 = self.R**3
        self.R5 = self.R3 * self.R**2
        self.Rz = self.R + z

    @cached_property
    def g(self) -> FloatArray:
        return 1.0 / (self.R * self.Rz)

    @cached_property
    def h(self) -> FloatArray:
        return (self.R + self.Rz) / (self.R3 * self.Rz**2)

    @cached_property
    def k(self) -> FloatArray:
        return 1.0 / (self.R * self.Rz**2)

    @cached_property
    def m(self) -> FloatArray:
        return (2 * self.R + self.Rz) / (self.R3 * self.Rz**3)


Formula = Callable[[PointForce, float], FloatArray]

# 4πG times the displacement and 2π times the stress (plain components) of a unit force along z and along x.
FORCE_Z: dict[str, Formula] = {
    "x": lambda f, s: f.x * (f.z / f.R3 - s * f.g),
    "y": lambda f, s: f.y * (f.z / f.R3 - s * f.g),
    "z": lambda f, s: (1 + s) / f.R + f.z**2 / f.R3,
    "xx": lambda f, s: -3 * f.x**2 * f.z / f.R5 + s * (f.z / f.R3 - f.g + f.x**2 * f.h),
    "yy": lambda f, s: -3 * f.y**2 * f.z / f.R5 + s * (f.z / f.R3 - f.g + f.y**2 * f.h),
    "zz": lambda f, _: -3 * f.z**3 / f.R5,
    "yz": lambda f, _: -3 * f.y * f.z**2 / f.R5,
    "xz": lambda f, _: -3 * f.x * f.z**2 / f.R5,
    "xy": lambda f, s: f.x * f.y * (s * f.h - 3 * f.z / f.R5),
}
FORCE_X: dict[str, Formula] = {
    "x": lambda f, s: 1 / f.R + f.x**2 / f.R3 + s * (1 / f.Rz - f.x**2 * f.k),
    "y": lambda f, s: f.x * f.y * (1 / f.R3 - s * f.k),
    "z": lambda f, s: f.x * (f.z / f.R3 + s * f.g),
    "xx": lambda f, s: f.x * (-3 * f.x**2 / f.R5 + s * (1 / f.R3 - 3 * f.k + f.x**2 * f.m)),
    "yy": lambda f, s: f.x * (-3 * f.y**2 / f.R5 + s * (1 / f.R3 - f.k + f.y**2 * f.m)),
    "zz": lambda f, _: -3 * f.x * f.z**2 / f.R5,
    "yz": lambda f, _: -3 * f.x * f.y * f.z / f.R5,
    "xz": lambda f, _: -3 * f.x**2 * f.z / f.R5,
    "xy": lambda f, s: f.y * (-3 * f.x**2 / f.R5 + s * (f.x**2 * f.m - f.k)),
}


def _distance(points: tuple[FloatArray, FloatArray, FloatArray], half_widths: HalfWidths) -> FloatArray:
    """Distance from the rectangle, in longest edges."""
    x, y, z = points
    dx, dy = np.maximum(np.abs(x) - half_widths[0], 0.0), np.maximum(np.abs(y) - half_widths[1], 0.0)
    distance: FloatArray = np.sqrt(dx * dx + dy * dy + z * z) / (2 * max(half_widths))
    return distance


def is_far(points: tuple[FloatArray, FloatArray, FloatArray], half_widths: HalfWidths) -> NDArray[np.bool_]:
    """Points for Gauss sums instead of corner sums, as booleans; the points broadcast."""
    elongated = max(half_widths) > 8 * min(half_widths)
    return np.asarray(_distance(points, half_widths) >= (SHELLS[0] if elongated else SHELLS[2]))


@cache
def _gauss(count: int) -> tuple[FloatArray, FloatArray]:
    return np.polynomial.legendre.leggauss(count)


def _rule(half_width: float, distance: float) -> list[tuple[float, float]]:
    """Gauss points and weights on [-half_width, half_width] for fields at `distance` or more."""
    e = distance / half_width
    n = int(np.ceil(15.5 / (2 * np.log10(e + np.sqrt(e * e + 1))))) + 1
    nodes, weights = _gauss(n)
    return list(zip((half_width * nodes).tolist(), (half_width * weights).tolist(), strict=True))


def gauss_field(
    direction: str,
    quantity: str,
    components: Sequence[str],
    points: tuple[FloatArray, FloatArray, FloatArray],
    half_widths: HalfWidths,
    material: Material,
) -> FloatArray:
    """Displacement [m/Pa] or Mandel stress [-] per unit traction at flat arrays of far points, ``(n, points)``."""
    names = [SWAPPED[name] for name in components] if direction == "y" else list(components)
    table = FORCE_Z if direction == "z" else FORCE_X
    edge, nu = 2 * max(half_widths), material.poisson_ratio
    x, y, z = points
    distance = _distance(points, half_widths)
    out = np.zeros((len(names), x.size))
    for inner, outer in zip(SHELLS, (*SHELLS[1:], np.inf), strict=True):
        shell = np.flatnonzero((distance >= inner) & (distance < outer))
        if not shell.size:
            continue
        xs, ys, zs = x[shell], y[shell], z[shell]
        values = np.zeros((len(names), shell.size))
        rule_x, rule_y = (_rule(half_width, inner * edge) for half_width in half_widths)
        for dx, weight_x in rule_x:
            for dy, weight_y in rule_y:
                force = PointForce(ys - dy, xs - dx, zs) if direction == "y" else PointForce(xs - dx, ys - dy, zs)
                for row, name in enumerate(names):
                    values[row] += (weight_x * weight_y) * table[name](force, 1 - 2 * nu)
        out[:, shell] = values
    return per_traction(quantity, components, out, material)
