"""From waves along one axis to all directions: the response of a medium that is isotropic about z.

A traction wave along the wavevector (s), across it (t) or along z moves the body in the plane (s, z), along t, or in
(s, z). Two wavevectors, along x and along y, show all of it; for any direction (cos φ, sin φ) the parts are turned.
Each component is then a short Fourier series in φ (orders up to 3), and each order goes to space by a Hankel transform:
``cos lφ`` becomes ``i^l cos lθ`` times the transform with J_l.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.symmetry import parity
from eigencontact.core.tensors import SQRT2

__all__ = ["DIRECTIONS", "AxisResponse", "angular_orders"]

FloatArray = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]
Parts = dict[str, ComplexArray]
# Response of all components of a quantity, (3 or 6, n), to waves (kx, ky) of the traction.
AxisResponse = Callable[[FloatArray, FloatArray], ComplexArray]

# Components along x, y, z seen with the wavevector along x, and along y (where t is -x), as names in s, t, z.
ALONG_X = {"x": "s", "y": "t", "z": "z", "xx": "ss", "yy": "tt", "zz": "zz", "yz": "tz", "xz": "sz", "xy": "st"}
ALONG_Y = {"x": "t", "y": "s", "z": "z", "xx": "tt", "yy": "ss", "zz": "zz", "yz": "sz", "xz": "tz", "xy": "st"}
# Parts that a traction along s or z moves; the others belong to one along t.
IN_PLANE = ("s", "z", "ss", "tt", "zz", "sz")
DIRECTIONS = {"p": "z", "q_x": "x", "q_y": "y"}
# Angles in an octant-symmetric set, enough for orders up to 3 of products with components of order 3.
ANGLES = 16


def angular_orders(
    response: AxisResponse, traction: str, names: Sequence[str], components: Sequence[str], k: FloatArray
) -> list[dict[int, FloatArray]]:
    """Amplitudes i^l F_l(k) of ``cos lφ`` (components even in y) or ``sin lφ`` (odd), ``(n,)``, for each component.

    Parameters
    ----------
    response : callable
        Gives all components `names` for waves of the traction, Mandel.
    names : sequence of str
        All components of the quantity.
    components : sequence of str
        Those wanted.
    k : (n,) float64
        Wavenumbers [rad/m].
    """
    along, across = _parts(response, traction, names, k)
    angle = 2 * np.pi * np.arange(ANGLES) / ANGLES
    found = []
    for name in components:
        values = np.array([_turned(name, traction, along, across, np.cos(a), np.sin(a)) for a in angle])
        values *= 1.0 if name[0] == name[-1] else SQRT2
        in_y, in_x = parity(name, DIRECTIONS[traction])
        wave = np.cos if in_y > 0 else np.sin
        odd = (in_x < 0) != (in_y < 0)
        orders: dict[int, FloatArray] = {}
        for order in (1, 3) if odd else (0, 2):
            share = 1.0 if order == 0 else 2.0
            if order == 0 and in_y < 0:
                continue
            amplitude = share / ANGLES * (wave(order * angle) @ values) * 1j**order
            orders[order] = amplitude.real
        found.append(orders)
    return found


def _parts(response: AxisResponse, traction: str, names: Sequence[str], k: FloatArray) -> tuple[Parts, Parts]:
    """Plain components in s, t, z for a unit traction along s (or z), and for one along t (none for a pressure)."""
    nil = np.zeros_like(k)
    along: Parts = {}
    across: Parts = {}
    directions = {"p": [(ALONG_X, along)], "q_x": [(ALONG_X, along), (ALONG_Y, across)],
                  "q_y": [(ALONG_Y, along), (ALONG_X, across)]}[traction]  # fmt: skip
    for table, target in directions:
        values = response(k, nil) if table is ALONG_X else response(nil, k)
        for name, row in zip(names, values, strict=True):
            local = table[name]
            if (local in IN_PLANE) == (target is along):
                # Along y the axis t is -x: both the load q_x and the components that hold t once change sign.
                target[local] = row / (1.0 if local[0] == local[-1] else SQRT2)
    return along, across


def _turned(name: str, traction: str, along: Parts, across: Parts, m: float, n: float) -> ComplexArray:
    """Plain component in x, y, z for the wavevector k (m, n)."""
    share_s, share_t = {"p": (1.0, 0.0), "q_x": (m, -n), "q_y": (n, m)}[traction]

    def part(local: str) -> ComplexArray:
        if local in along:
            return share_s * along[local]
        return share_t * across[local] if local in across else np.zeros(1, dtype=complex)

    match name:
        case "x":
            value = m * part("s") - n * part("t")
        case "y":
            value = n * part("s") + m * part("t")
        case "xx":
            value = m * m * part("ss") + n * n * part("tt") - 2 * m * n * part("st")
        case "yy":
            value = n * n * part("ss") + m * m * part("tt") + 2 * m * n * part("st")
        case "xy":
            value = m * n * (part("ss") - part("tt")) + (m * m - n * n) * part("st")
        case "xz":
            value = m * part("sz") - n * part("tz")
        case "yz":
            value = n * part("sz") + m * part("tz")
        case _:  # z and zz
            value = part(name)
    return value
