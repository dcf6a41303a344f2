"""Strips on layered bodies in plane strain: against Fourier integrals, and the homogeneous half-space."""

from itertools import pairwise

import numpy as np
import pytest

from eigencontact.halfspace.layered_influence import LayeredInfluence
from eigencontact.plugin import COMPONENTS, Material
from eigencontact_plugins.surface_loads import PressureLoad, ShearLoadX, ShearLoadY
from halfspace.stacks import medium, solid

LOADS = {"p": PressureLoad(), "q_x": ShearLoadX(), "q_y": ShearLoadY()}
NAMES = {"displacement": ("x", "y", "z"), "stress": COMPONENTS}
A = 0.5
X = np.array([-0.9, 0.0, 0.5, 2.3])


STACKS = {
    "stiff": medium([(1.0, 3.0, 0.2)], (1.0, 0.3)),
    "soft-on-stiff": medium([(0.5, 0.2, 0.5), (0.7, 8.0, 0.0)], (1.0, 0.3)),
    "thin": medium([(0.02, 10.0, 0.3)], (1.0, 0.3)),
}


def fourier_integral(body, quantity, traction, x, z):
    """Field of a strip at depth z > 0 from all waves along x, those of displacement less the field at x = 0.

    Gauss-Legendre on panels that grow from 0 until they hold 2.5 rad of the fastest wave.
    """
    edges, reach = [0.0, 1e-9 / z], np.abs(x).max() + A
    while edges[-1] < 45 / z:
        edges.append(min(45 / z, edges[-1] + min(0.7 * edges[-1], 2.5 / reach)))
    points, weights = np.polynomial.legendre.leggauss(12)
    k = np.concatenate([low + (high - low) * (points + 1) / 2 for low, high in pairwise(edges)])
    w = np.concatenate([weights * (high - low) / 2 for low, high in pairwise(edges)])
    total = 0.0
    for sign in (1.0, -1.0):
        response = body.response(quantity, NAMES[quantity], traction, sign * k, np.zeros_like(k), z)
        waves = np.exp(1j * sign * np.outer(x, k)) - (1.0 if quantity == "displacement" else 0.0)
        total = total + (waves @ (response * (2 * A * np.sinc(k * A / np.pi) * w)).T).T.real
    return total / (2 * np.pi)


CASES = [
    (stack, z, traction, quantity)
    for stack, z in (("stiff", 0.6), ("stiff", 1.7), ("soft-on-stiff", 0.4), ("thin", 0.3))
    for traction in LOADS
    for quantity in NAMES
]
#: Each takes about a second; the others are run with the slow tests.
FEW = [("stiff", 0.6, "p", "displacement"), ("thin", 0.3, "q_x", "stress")]


@pytest.mark.parametrize(
    "case", [case if case in FEW else pytest.param(case, marks=pytest.mark.slow) for case in CASES]
)
def test_fourier_integral(case):
    stack, z, traction, quantity = case
    body, influence = STACKS[stack], LayeredInfluence(LOADS[traction])
    values = influence.sample(quantity, NAMES[quantity], X, np.zeros(1), z, (A, np.inf), body)[:, 0]
    if quantity == "displacement":
        middle = influence.sample(quantity, NAMES[quantity], np.zeros(1), np.zeros(1), z, (A, np.inf), body)[:, 0]
        values = values - middle
    expected = fourier_integral(body, quantity, traction, X, z)
    assert np.abs(values - expected).max() < 1e-7 * np.abs(expected).max()


@pytest.mark.parametrize("traction", ["p", *(pytest.param(name, marks=pytest.mark.slow) for name in ("q_x", "q_y"))])
def test_identical_layers_are_the_half_space(traction):
    body, same = medium([(0.4, 1.5, 0.3)], (1.5, 0.3)), Material(**solid(1.5, 0.3))
    for quantity, names in NAMES.items():
        for z in (0.0, 0.3, 2.0):
            at = (names, X, np.zeros(1), z, (A, np.inf))
            values = LayeredInfluence(LOADS[traction]).sample(quantity, *at, body)
            # What the extrapolation along the strip leaves.
            np.testing.assert_allclose(values, LOADS[traction].sample(quantity, *at, same), rtol=0, atol=2e-9)
