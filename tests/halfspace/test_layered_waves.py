"""Turning of wave responses about z, against plane waves of all directions added up one by one."""

import numpy as np
import pytest
from scipy.special import jv

from eigencontact.core.tensors import SQRT2
from eigencontact.halfspace.layered_waves import DIRECTIONS, NAMES, radial_functions, turned

AXES = {"x": 0, "y": 1, "z": 2}
K = np.array([0.7, 2.0])
X = np.array([-1.1, -0.2, 0.5, 1.7])
#: Real amplitudes of two depths by wavenumber: in the plane of the wave, then across it. Real ones are in phase with
#: the load, others a quarter of a wave behind it.
RANDOM = np.random.default_rng(3).normal(size=(12, 2, K.size))


def local(traction, angle):
    """Displacement and stress ``(3 or 3, 3, depth, k)`` along the wavevector, across it and along z."""
    u, s = np.zeros((3, 2, K.size), complex), np.zeros((3, 3, 2, K.size), complex)
    direction = {"p": (0, 0, 1), "q_x": (1, 0, 0), "q_y": (0, 1, 0)}[traction]
    along = direction[0] * np.cos(angle) + direction[1] * np.sin(angle)
    across = direction[1] * np.cos(angle) - direction[0] * np.sin(angle)
    normal, shear = (1, 1j) if traction == "p" else (1j, 1)
    size = 1.0 if traction == "p" else along
    u[0], u[2] = size * shear * RANDOM[0], size * normal * RANDOM[1]
    for axis in range(3):
        s[axis, axis] = size * normal * RANDOM[2 + axis]
    s[0, 2] = s[2, 0] = size * shear * RANDOM[5]
    u[1] = across * RANDOM[6]
    s[1, 2] = s[2, 1] = across * RANDOM[7]
    s[0, 1] = s[1, 0] = across * 1j * RANDOM[8]
    return u, s


def plane_wave(traction, quantity, angle):
    """Components of a wave in this direction, Mandel, ``(names, depth, k)``."""
    u, s = local(traction, angle)
    turn = np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
    if quantity == "displacement":
        return np.einsum("ij,jzk->izk", turn, u)
    s = np.einsum("ia,jb,abzk->ijzk", turn, turn, s)
    return np.array([s[AXES[n[0]], AXES[n[1]]] * (1 if n[0] == n[1] else SQRT2) for n in NAMES["stress"]])


@pytest.mark.parametrize("quantity", NAMES)
@pytest.mark.parametrize("traction", DIRECTIONS)
def test_two_waves_show_those_of_all_directions(traction, quantity):
    """The mean over a ring of wavevectors is the sum of the radial functions times J_l, turned."""

    def response(names, kx, ky):
        values = plane_wave(traction, quantity, np.arctan2(ky[0], kx[0]))
        return values[[NAMES[quantity].index(name) for name in names]]

    functions, orders = radial_functions(response, traction, quantity, K)
    radius = np.hypot(X[:, None], X[None, :])
    angles = 2 * np.pi * np.arange(64) / 64
    for number, k in enumerate(K):
        radial = np.array([
            f[:, number, None, None] * jv(l, k * radius) for f, l in zip(functions, orders, strict=True)
        ])  # fmt: skip
        fields, parities = turned(radial, traction, quantity, X)
        ring = 0.0
        for angle in angles:
            phase = np.exp(1j * k * (X[None, :] * np.cos(angle) + X[:, None] * np.sin(angle)))
            ring = ring + plane_wave(traction, quantity, angle)[..., number, None, None] * phase / angles.size
        np.testing.assert_allclose(fields, ring, rtol=0, atol=1e-13)
    assert len(parities) == len(NAMES[quantity])
