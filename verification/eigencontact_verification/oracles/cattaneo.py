"""Spheres pressed together and then sheared: partial slip after Cattaneo and Mindlin, loops, dissipated energy.

Conventions: the normal load P is constant, q acts on body 1 along x and the shift δ is that of body 2 against body 1,
both positive together. `compliance` is C = Σ (2-ν)/G over the elastic bodies [1/Pa] (one elastic body against a rigid
one: its own). Exact for like bodies, or one incompressible against a rigid one, if the shear displacement across the
load is neglected (it vanishes for ν = 0). The slip that is neglected is of order ν/(4-2ν) of the slip.

References
----------
C. Cattaneo 1938; R. D. Mindlin 1949, J. Appl. Mech. 16, 259; K. L. Johnson 1985, Contact Mechanics, section 7.2;
R. D. Mindlin, W. P. Mason, J. F. Osmer, H. Deresiewicz 1952 (energy of a cycle).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = [
    "cycle_energy",
    "cycle_energy_sliding",
    "initial_stiffness",
    "load_of_shift",
    "load_on_loop",
    "shear",
    "shift_of_load",
    "shift_of_sliding",
    "shift_on_loop",
    "stick_ratio",
]

FloatArray = NDArray[np.float64]


def initial_stiffness(radius: float, compliance: float) -> float:
    """Tangential stiffness dQ/dδ before slip, 8a/C [N/m]."""
    return 8.0 * radius / compliance


def shift_of_sliding(friction: float, load: float, radius: float, compliance: float) -> float:
    """Shift at which the whole contact begins to slide, 3 μP C/(16 a) [m]."""
    return 3.0 * friction * load * compliance / (16.0 * radius)


def stick_ratio(load_ratio: ArrayLike) -> FloatArray:
    """Stick radius c/a at Q/(μP) from 0 to 1 on first loading: (1 - Q/(μP))^(1/3)."""
    return np.cbrt(1.0 - np.asarray(load_ratio, dtype=float))


def shift_of_load(load_ratio: ArrayLike) -> FloatArray:
    """Shift over that of sliding at Q/(μP) from 0 to 1 on first loading: 1 - (1 - Q/(μP))^(2/3)."""
    return np.asarray(1.0 - stick_ratio(load_ratio) ** 2)


def load_of_shift(shift_ratio: ArrayLike) -> FloatArray:
    """Q/(μP) at a shift over that of sliding on first loading; 1 from there on."""
    return np.asarray(1.0 - np.maximum(0.0, 1.0 - np.asarray(shift_ratio, dtype=float)) ** 1.5)


def shear(r: ArrayLike, load_ratio: float, radius: float, traction: float) -> FloatArray:
    """Shear traction [Pa] at the radius r [m] on first loading.

    Parameters
    ----------
    r : array_like
        Distance from the axis [m].
    load_ratio : float
        Q/(μP), 0 to 1.
    radius : float
        a [m].
    traction : float
        μ p0 [Pa].
    """
    r = np.asarray(r, dtype=float) / radius
    c = float(stick_ratio(load_ratio))
    inner = np.sqrt(np.maximum(0.0, c * c - r * r))
    return np.asarray(traction * (np.sqrt(np.maximum(0.0, 1.0 - r * r)) - inner))


def shift_on_loop(load_ratio: ArrayLike, peak: float) -> FloatArray:
    """Shift over that of sliding while Q falls from its peak, both loads over μP; |Q| <= peak <= 1.

    The branch of rising Q is minus this at minus Q.
    """
    change = shift_of_load(0.5 * (peak - np.asarray(load_ratio, dtype=float)))
    return np.asarray(shift_of_load(peak) - 2.0 * change)


def load_on_loop(shift_ratio: ArrayLike, peak: float) -> FloatArray:
    """Q/(μP) while the shift falls from its peak; shifts over that of sliding, the peak of any size."""
    turn = float(load_of_shift(peak))
    return np.asarray(turn - 2.0 * load_of_shift(0.5 * (peak - np.asarray(shift_ratio, dtype=float))))


def cycle_energy(load_ratio: float, friction: float, load: float, radius: float, compliance: float) -> float:
    """Energy that friction takes up in a cycle between ±Q [J], Q/(μP) from 0 to 1.

    ``9 μ²P² C/(10 a) (1 - s^(5/3) - 5/6 (Q/μP)(1 + s^(2/3)))`` with s = 1 - Q/(μP). First loading takes up a quarter:
    the same ring slips half as far as in each of the two branches.
    """
    s = 1.0 - load_ratio
    bracket = 1.0 - s ** (5.0 / 3.0) - 5.0 / 6.0 * load_ratio * (1.0 + s ** (2.0 / 3.0))
    return float(0.9 * (friction * load) ** 2 * compliance / radius * bracket)


def cycle_energy_sliding(shift: float, friction: float, load: float, radius: float, compliance: float) -> float:
    """Energy of a cycle between shifts of ± more than that of sliding [J]: the loop at Q = μP and the way beyond."""
    beyond = shift - shift_of_sliding(friction, load, radius, compliance)
    return cycle_energy(1.0, friction, load, radius, compliance) + 4.0 * friction * load * beyond
