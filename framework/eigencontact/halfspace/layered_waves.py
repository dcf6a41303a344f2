"""Response of a medium isotropic about z in all directions, from waves along one axis.

A traction wave along the wavevector (s), across it (t) or along z moves the body in the plane (s, z), along t, or in
(s, z). Two wavevectors, along x and along y, show all of it; for any direction (cos φ, sin φ) the parts are turned.
Each component is then a short Fourier series in φ of a few functions of k (orders up to 3). Each of these goes to space
by a Hankel transform: ``cos lφ`` becomes ``i^l cos lθ`` times the transform with J_l, and the same for the sine.

A shear along y is the shear along x with x and y exchanged.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from eigencontact.core.array_types import ComplexArray, FloatArray
from eigencontact.core.symmetry import parity
from eigencontact.core.tensors import COMPONENTS, SQRT2

__all__ = ["DIRECTIONS", "NAMES", "AxisResponse", "Turning", "radial_functions", "turned"]

#: Response of the named components to waves (kx, ky) of the traction, ``(len(names), nz, n)``.
AxisResponse = Callable[[Sequence[str], FloatArray, FloatArray], ComplexArray]

#: Direction of each traction.
DIRECTIONS = {"p": "z", "q_x": "x", "q_y": "y"}
#: Components of each quantity.
NAMES: dict[str, tuple[str, ...]] = {"displacement": ("x", "y", "z"), "stress": COMPONENTS}
SWAPPED = {"x": "y", "y": "x", "z": "z", "xx": "yy", "yy": "xx", "zz": "zz", "yz": "xz", "xz": "yz", "xy": "xy"}
# Components along x, y, z seen with the wavevector along x, and along y (where t is -x), as names in s, t, z.
ALONG_X = {"x": "s", "y": "t", "z": "z", "xx": "ss", "yy": "tt", "zz": "zz", "yz": "tz", "xz": "sz", "xy": "st"}
ALONG_Y = {SWAPPED[name]: local for name, local in ALONG_X.items()}
# Parts that a traction across the wavevector moves; the others belong to one along it, or along z.
ACROSS = ("t", "tz", "st")


@dataclass(frozen=True)
class Turning:
    """Rule for the components of a field from its parts.

    Parameters
    ----------
    radial : tuple of (order l, {part: share})
        Functions of k: sums of parts, each to be transformed with J_l.
    series : {component: tuple of (number of the function, sign, "cos" or "sin")}
        Series in the angle, each term with the order of its function; a shear along x or a pressure.
    """

    radial: tuple[tuple[int, dict[str, float]], ...]
    series: dict[str, tuple[tuple[int, float, str], ...]]


#: For a pressure and for a shear along x. With m, n = cos φ, sin φ the load of a shear is m along s and -n along t;
#: σ_xx = m² ss + n² tt - 2mn st, σ_xy = mn (ss - tt) + (m² - n²) st and so on, and products of m and n are turned
#: into cosines and sines of multiples of φ.
PRESSURE = {
    "displacement": Turning(
        radial=((1, {"s": 1.0}), (0, {"z": 1.0})),
        series={"x": ((0, 1.0, "cos"),), "y": ((0, 1.0, "sin"),), "z": ((1, 1.0, "cos"),)},
    ),
    "stress": Turning(
        radial=((0, {"ss": 0.5, "tt": 0.5}), (2, {"ss": 0.5, "tt": -0.5}), (0, {"zz": 1.0}), (1, {"sz": 1.0})),
        series={
            "xx": ((0, 1.0, "cos"), (1, 1.0, "cos")),
            "yy": ((0, 1.0, "cos"), (1, -1.0, "cos")),
            "zz": ((2, 1.0, "cos"),),
            "yz": ((3, 1.0, "sin"),),
            "xz": ((3, 1.0, "cos"),),
            "xy": ((1, 1.0, "sin"),),
        },
    ),
}
SHEAR_X = {
    "displacement": Turning(
        radial=((0, {"s": 0.5, "t": 0.5}), (2, {"s": 0.5, "t": -0.5}), (1, {"z": 1.0})),
        series={"x": ((0, 1.0, "cos"), (1, 1.0, "cos")), "y": ((1, 1.0, "sin"),), "z": ((2, 1.0, "cos"),)},
    ),
    "stress": Turning(
        radial=(
            (1, {"ss": 0.5, "tt": 0.5}),
            (1, {"ss": 0.25, "tt": -0.25, "st": 0.5}),
            (3, {"ss": 0.25, "tt": -0.25, "st": -0.5}),
            (1, {"zz": 1.0}),
            (0, {"sz": 0.5, "tz": 0.5}),
            (2, {"sz": 0.5, "tz": -0.5}),
        ),
        series={
            "xx": ((0, 1.0, "cos"), (1, 1.0, "cos"), (2, 1.0, "cos")),
            "yy": ((0, 1.0, "cos"), (1, -1.0, "cos"), (2, -1.0, "cos")),
            "zz": ((3, 1.0, "cos"),),
            "yz": ((5, 1.0, "sin"),),
            "xz": ((4, 1.0, "cos"), (5, 1.0, "cos")),
            "xy": ((1, 1.0, "sin"), (2, 1.0, "sin")),
        },
    ),
}


def _turning(traction: str, quantity: str) -> Turning:
    return (PRESSURE if traction == "p" else SHEAR_X)[quantity]


def radial_functions(
    response: AxisResponse, traction: str, quantity: str, k: FloatArray
) -> tuple[list[FloatArray], list[int]]:
    """Functions R_l(k) times i^l, ``(nz, n)`` each, and their orders l.

    Parameters
    ----------
    response : callable
        Gives components, Mandel, for waves of the traction.
    traction, quantity : str
    k : (n,) float64
        Wavenumbers [rad/m].
    """
    components = _plain_components(response, traction, quantity, k)
    functions, orders = [], []
    for order, shares in _turning(traction, quantity).radial:
        total = sum(share * components[name] for name, share in shares.items())
        functions.append(np.asarray(total * 1j**order).real)
        orders.append(order)
    return functions, orders


def turned(radial: FloatArray, traction: str, quantity: str, x: FloatArray) -> tuple[FloatArray, list[tuple[int, int]]]:
    """Components ``(len(NAMES), nz, n, n)``, Mandel, on the square lattice of coordinates x ``(n,)``; their parities.

    `radial` are the transforms of the functions, ``(functions, nz, n, n)``.
    """
    angle = np.arctan2(x[:, None], x[None, :])
    turning = _turning(traction, quantity)
    lattices = []
    for name in NAMES[quantity]:
        total = 0.0
        for number, sign, wave in turning.series[SWAPPED[name] if traction == "q_y" else name]:
            order = turning.radial[number][0]
            total = total + radial[number] * (sign * (np.cos if wave == "cos" else np.sin)(order * angle))
        values = np.asarray(total) * (1.0 if name[0] == name[-1] else SQRT2)
        lattices.append(np.swapaxes(values, 1, 2) if traction == "q_y" else values)
    return np.array(lattices), [parity(name, DIRECTIONS[traction]) for name in NAMES[quantity]]


def _plain_components(response: AxisResponse, traction: str, quantity: str, k: FloatArray) -> dict[str, ComplexArray]:
    """Components in s, t, z for a unit traction along s (or z), and for one along t (none for a pressure)."""
    nil = np.zeros_like(k)
    waves = {"x": ((k, nil), ALONG_X), "y": ((nil, k), ALONG_Y)}
    in_plane, across = ("y", "x") if traction == "q_y" else ("x", "y")
    components = {}
    for axis, is_across in ((in_plane, False), (across, True)):
        wave, table = waves[axis]
        names = [name for name in NAMES[quantity] if (table[name] in ACROSS) == is_across]
        if is_across and traction == "p":
            continue
        # Along y the axis t is -x: both the load q_x and the components that hold t once change sign.
        for name, values in zip(names, response(names, *wave), strict=True):
            components[table[name]] = values / (1.0 if name[0] == name[-1] else SQRT2)
    return components
