"""Corner functions of a uniformly loaded rectangle on a homogeneous half-space, finite at every point of z >= 0.

With R = sqrt(x² + y² + z²), s = 1 - 2ν and the function W with the derivative W_xy = z ln(R + z) - R, all fields follow
from derivatives of W, in a form without cancellation and without 0/0 at the surface:

==========  ==========================================================================================
A           W_zzz = -A, A = arctan(xy / (zR)); at z = 0 its limit from inside the body
T           W_zxx = T(x, y) = arctan(xy / (x² + z² + zR)); T' = T(y, x) = W_zyy = A - T, as W is harmonic
L_y, L_x    W_zzx = L_y = arsinh(y / sqrt(x² + z²)); L_x likewise
M           W_zx = M = y ln(R + z) + z L_y + x T; M' = W_zy likewise
V           W_zz = V = x L_y + y L_x - z A
==========  ==========================================================================================

The displacement is ``2 dF/dz - dH/dx + 2ν dψ₁/dx - z dψ/dx`` along x and ``dH/dz + s ψ - z dψ/dz`` along z, over 4πG
(thesis 2.15-2.22, with 2.22 corrected), with F₁ = W for a shear along x and H₁ = W for a pressure.

A shear along y follows from the shear along x by exchange of x and y. All lengths are in one arbitrary unit; a change
of unit adds terms that the sum over the four corners removes.
"""

# ruff: noqa: N802 - symbols of the table above

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property

import numpy as np

from eigencontact.plugin import SQRT2, FloatArray, Material

__all__ = ["SWAPPED", "corner_field", "mandel_factor", "per_traction", "surface_lift"]


#: Smallest distance in a logarithm or a quotient, in the unit of length of the coordinates.
FLOOR = 1e-30

#: Names of components after x and y are exchanged.
SWAPPED = {"x": "y", "y": "x", "z": "z", "xx": "yy", "yy": "xx", "zz": "zz", "yz": "xz", "xz": "yz", "xy": "xy"}


def mandel_factor(component: str) -> float:
    """Factor from a plain tensor component to its Mandel component."""
    return 1.0 if component[0] == component[1] else SQRT2


class Corner:
    """Shared sub-expressions at the points (x, y, z) relative to a corner, each computed at first use."""

    def __init__(self, x: FloatArray, y: FloatArray, z: FloatArray | float) -> None:
        self.x, self.y, self.z = x, y, z + 0.0  # replaces a depth of -0.0, which arctan2 distinguishes, by 0.0
        self.xz2 = x * x + self.z * self.z
        self.yz2 = y * y + self.z * self.z
        self.R = np.sqrt(self.xz2 + y * y)

    @cached_property
    def A(self) -> FloatArray:
        return np.arctan2(self.x * self.y, self.z * self.R)

    @cached_property
    def T(self) -> FloatArray:
        return np.arctan2(self.x * self.y, self.xz2 + self.z * self.R)

    @cached_property
    def T_swapped(self) -> FloatArray:
        return self.A - self.T

    @cached_property
    def L_x(self) -> FloatArray:
        return _arsinh(self.x, self.yz2, self.R)

    @cached_property
    def L_y(self) -> FloatArray:
        return _arsinh(self.y, self.xz2, self.R)

    @cached_property
    def log(self) -> FloatArray:
        """Logarithm of R + z; finite at the corner, where its factor is 0 or singular."""
        return np.log(np.maximum(self.R + self.z, FLOOR))

    @cached_property
    def R_safe(self) -> FloatArray:
        return np.maximum(self.R, FLOOR)

    @cached_property
    def V(self) -> FloatArray:
        return self.x * self.L_y + self.y * self.L_x - self.z * self.A

    @cached_property
    def M(self) -> FloatArray:
        return self.y * self.log + self.z * self.L_y + self.x * self.T

    @cached_property
    def M_swapped(self) -> FloatArray:
        return self.x * self.log + self.z * self.L_x + self.y * self.T_swapped

    @cached_property
    def B(self) -> FloatArray:
        """Quotient z / ((x² + z²) R), 0 on the edge line x = z = 0."""
        return self.z / (np.maximum(self.xz2, FLOOR**2) * self.R_safe)

    @cached_property
    def B_swapped(self) -> FloatArray:
        return self.z / (np.maximum(self.yz2, FLOOR**2) * self.R_safe)

    @cached_property
    def inv(self) -> FloatArray:
        """Quotient 1 / (R + z), finite at the corner."""
        return 1.0 / np.maximum(self.R + self.z, FLOOR)


def _arsinh(t: FloatArray, distance2: FloatArray, R: FloatArray) -> FloatArray:
    """Inverse hyperbolic sine of t / sqrt(distance2), with R = sqrt(t² + distance2), by the faster np.log."""
    quotient = np.maximum(np.abs(t) + R, FLOOR) / np.maximum(np.sqrt(distance2), FLOOR)
    return np.sign(t) * np.log(quotient)


Formula = Callable[[Corner, float], FloatArray]

# 4πG times the displacement and 2π times the stress (plain components) of a pressure and of a shear along x.
PRESSURE: dict[str, Formula] = {
    "x": lambda c, nu: -(1 - 2 * nu) * c.M - c.z * c.L_y,
    "y": lambda c, nu: -(1 - 2 * nu) * c.M_swapped - c.z * c.L_x,
    "z": lambda c, nu: 2 * (1 - nu) * c.V + c.z * c.A,
    "xx": lambda c, nu: -2 * nu * c.A - (1 - 2 * nu) * c.T + c.x * c.y * c.B,
    "yy": lambda c, nu: -2 * nu * c.A - (1 - 2 * nu) * c.T_swapped + c.x * c.y * c.B_swapped,
    "zz": lambda c, _: -c.A - c.x * c.y * (c.B + c.B_swapped),
    "yz": lambda c, _: c.x * c.z * c.B_swapped,
    "xz": lambda c, _: c.y * c.z * c.B,
    "xy": lambda c, nu: -c.z / c.R_safe - (1 - 2 * nu) * c.log,
}
SHEAR_X: dict[str, Formula] = {
    "x": lambda c, nu: 2 * c.V + 2 * nu * (c.z * c.T - c.x * c.L_y) - c.z * c.T,
    "y": lambda c, nu: -2 * nu * c.R - (1 - 2 * nu) * c.z * c.log,
    "z": lambda c, nu: (1 - 2 * nu) * c.M - c.z * c.L_y,
    "xx": lambda c, nu: 2 * c.L_y + c.y * (_ratio(c) - (1 - 2 * nu) * c.inv),
    "yy": lambda c, nu: 2 * nu * c.L_y - c.y / c.R_safe + (1 - 2 * nu) * c.y * c.inv,
    "zz": lambda c, _: c.y * c.z * c.B,
    "yz": lambda c, _: -c.z / c.R_safe,
    "xz": lambda c, _: -c.A + c.x * c.y * c.B,
    "xy": lambda c, nu: c.L_x - c.x / c.R_safe + (1 - 2 * nu) * c.x * c.inv,
}


def _ratio(c: Corner) -> FloatArray:
    """Quotient x² / ((x² + z²) R), 0 on the edge line x = z = 0."""
    return c.x * c.x / (np.maximum(c.xz2, FLOOR**2) * c.R_safe)


def corner_field(
    direction: str,
    quantity: str,
    components: Sequence[str],
    points: tuple[FloatArray, FloatArray, FloatArray | float],
    material: Material,
) -> FloatArray:
    """Corner function of ``"displacement"`` [m/Pa] or Mandel ``"stress"`` [-] at offsets (x, y, z), ``(n, ...)``.

    It is that of a unit traction along `direction` (x, y or z).
    """
    x, y, z = points
    names = [SWAPPED[name] for name in components] if direction == "y" else list(components)
    corner = Corner(y, x, z) if direction == "y" else Corner(x, y, z)
    table = PRESSURE if direction == "z" else SHEAR_X
    out = np.empty((len(names), *np.broadcast_shapes(np.shape(x), np.shape(y), np.shape(z))))
    for row, name in enumerate(names):
        out[row] = table[name](corner, material.poisson_ratio)
    return per_traction(quantity, components, out, material)


def per_traction(quantity: str, components: Sequence[str], values: FloatArray, material: Material) -> FloatArray:
    """Displacement or Mandel stress, in place, from 4πG times the displacement or 2π times the stress components."""
    if quantity == "displacement":
        values /= 4 * np.pi * material.shear_modulus
        return values
    for row, name in enumerate(components):
        values[row] *= mandel_factor(name) / (2 * np.pi)
    return values


def surface_lift(x: FloatArray, y: FloatArray) -> FloatArray:
    """Values of x L_y + y L_x at z = 0 on the lattice of nodes ``x (nx,)``, ``y (ny,)``, ``(ny, nx)``.

    It is odd in x and in y and 0 on both axes, so the logarithms use absolute values. On a lattice with equal x and y
    one of the two terms is the transpose of the other.
    """
    ax, ay = np.maximum(np.abs(x), FLOOR), np.maximum(np.abs(y), FLOOR)
    r: FloatArray = np.sqrt((ay * ay)[:, None] + ax * ax)
    term: FloatArray = r + ay[:, None]
    term *= 1.0 / ax
    np.log(term, out=term)
    term *= ax
    if np.array_equal(ax, ay):
        out: FloatArray = term + term.T
    else:
        r += ax
        r *= (1.0 / ay)[:, None]
        np.log(r, out=r)
        r *= ay[:, None]
        out = np.add(term, r, out=r)
    if np.any(x <= 0):
        out *= np.sign(x)
    if np.any(y <= 0):
        out *= np.sign(y)[:, None]
    return out
