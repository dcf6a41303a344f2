"""Field of a uniformly loaded strip |x| <= a on a homogeneous half-space in plane strain, exact at every z >= 0.

It is the limit of the rectangle of `surface_loads_corner` for an infinite half width along y. The formulas contain
differences over the two edges explicitly, without cancellation far from the strip. With θ = arctan(x/z) and ρ² = x² +
z², a capital letter is the difference of a function over the edges, f(x + a) - f(x - a):

==========  ===============================================================================
angle       Θ of θ
log         Λ of ln ρ
V           of x - x ln ρ - zθ: its derivative along x is -ln ρ
M           of xθ - z ln ρ: its derivative along x is θ
S, Q        of xz/ρ² and z²/ρ²
==========  ===============================================================================

The displacement of a strip has a free constant, the same at all points and proportional to the load.
"""

# ruff: noqa: N802 - symbols of the table above

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property

import numpy as np

from eigencontact.plugin import FloatArray, Material
from eigencontact_plugins.surface_loads_corner import FLOOR, mandel_factor

__all__ = ["strip_field"]


class Strip:
    """Shared differences over the edges of a strip at the points (x, z), each computed at first use."""

    def __init__(self, x: FloatArray, z: FloatArray | float, a: float) -> None:
        self.x, self.z = np.broadcast_arrays(np.asarray(x, dtype=float), np.asarray(z, dtype=float) + 0.0)
        self.a = a
        self.right, self.left = self.x + a, self.x - a
        # Squared distances from the two edges, finite in quotients and logarithms at the edges.
        self.rho2_left, self.rho2_right = (
            np.maximum(offset * offset + self.z * self.z, FLOOR**2) for offset in (self.right, self.left)
        )

    @cached_property
    def angle(self) -> FloatArray:
        value = np.arctan2(2.0 * self.a * self.z, self.right * self.left + self.z * self.z)
        edge = (self.z == 0) & ((self.right == 0) | (self.left == 0))
        return np.where(edge, 0.5 * np.pi, value)

    @cached_property
    def log(self) -> FloatArray:
        nearer = np.minimum(self.rho2_left, self.rho2_right)
        return np.asarray(0.5 * np.sign(self.x) * np.log1p(4.0 * self.a * np.abs(self.x) / nearer))

    @cached_property
    def x_log(self) -> FloatArray:
        """Difference of x ln ρ."""
        logs = np.log(self.rho2_left) + np.log(self.rho2_right)
        return np.asarray(self.x * self.log + 0.5 * self.a * logs)

    @cached_property
    def V(self) -> FloatArray:
        return np.asarray(2.0 * self.a - self.x_log - self.z * self.angle)

    @cached_property
    def M(self) -> FloatArray:
        angles = np.arctan2(self.right, self.z) + np.arctan2(self.left, self.z)
        return np.asarray(self.x * self.angle + self.a * angles - self.z * self.log)

    @cached_property
    def S(self) -> FloatArray:
        top = 2.0 * self.a * (self.z * self.z - self.right * self.left)
        return np.asarray(self.z * (top / self.rho2_left) / self.rho2_right)

    @cached_property
    def Q(self) -> FloatArray:
        return np.asarray(-4.0 * self.a * self.x * (self.z / self.rho2_left) * (self.z / self.rho2_right))


Formula = Callable[[Strip, float], FloatArray]

# 2πG times the displacement and π times the stress (plain components). Missing components are zero.
PRESSURE: dict[str, Formula] = {
    "x": lambda s, nu: -(1 - 2 * nu) * s.M + s.z * s.log,
    "z": lambda s, nu: 2 * (1 - nu) * s.V + s.z * s.angle,
    "xx": lambda s, _: -s.angle + s.S,
    "yy": lambda s, nu: -2 * nu * s.angle,
    "zz": lambda s, _: -s.angle - s.S,
    "xz": lambda s, _: s.Q,
}
SHEAR_X: dict[str, Formula] = {
    "x": lambda s, nu: 2 * s.V + 2 * nu * (s.z * s.angle + s.x_log) - s.z * s.angle - 4 * nu * s.a,
    "z": lambda s, nu: (1 - 2 * nu) * s.M + s.z * s.log,
    "xx": lambda s, _: -2 * s.log - s.Q,
    "yy": lambda s, nu: -2 * nu * s.log,
    "zz": lambda s, _: s.Q,
    "xz": lambda s, _: -s.angle + s.S,
}
SHEAR_Y: dict[str, Formula] = {
    "y": lambda s, _: 2 * s.V,
    "xy": lambda s, _: -s.log,
    "yz": lambda s, _: -s.angle,
}
_TABLES = {"z": PRESSURE, "x": SHEAR_X, "y": SHEAR_Y}


def strip_field(
    direction: str,
    quantity: str,
    components: Sequence[str],
    points: tuple[FloatArray, FloatArray, FloatArray | float],
    half_width: float,
    material: Material,
) -> FloatArray:
    """``"displacement"`` [m/Pa] or Mandel ``"stress"`` [-] of a unit traction along `direction`, ``(n, ...)``.

    Parameters
    ----------
    points : (x, y, z)
        Field points, which broadcast against each other; the field is the same for all y.
    half_width : float
        Half width a along x, in the unit of length of the points.

    References
    ----------
    K. L. Johnson 1985, Contact Mechanics, sec. 2.5, doi:10.1017/CBO9781139171731
    """
    x, y, z = points
    unit = float(2.0 ** (np.frexp(half_width)[1] - 1))  # the same digits for strips of 1 nm and of 1 m
    out = np.zeros((len(components), *np.broadcast_shapes(np.shape(x), np.shape(y), np.shape(z))))
    strip, table = Strip(x / unit, z / unit, half_width / unit), _TABLES[direction]
    for row, name in enumerate(components):
        if name in table:
            out[row] = table[name](strip, material.poisson_ratio)
            scale = unit / (2.0 * material.shear_modulus) if quantity == "displacement" else mandel_factor(name)
            out[row] *= scale / np.pi
    return out
