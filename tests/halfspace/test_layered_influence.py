"""Influence coefficients of bonded layers: against direct Fourier integrals, the half-space, limits and symmetries."""

from itertools import pairwise

import numpy as np
import pytest

from eigencontact.planning.layered_influence import LayeredInfluence
from eigencontact.plugin import COMPONENTS, Material
from eigencontact_plugins.layered.stack import BondedLayers, Layer, Substrate
from eigencontact_plugins.surface_loads import PressureLoad, ShearLoadX, ShearLoadY

LOADS = {"p": PressureLoad(), "q_x": ShearLoadX(), "q_y": ShearLoadY()}
LAYERED = {name: LayeredInfluence(load) for name, load in LOADS.items()}
AXES = ("x", "y", "z")
NAMES = {"displacement": AXES, "stress": COMPONENTS}
HALF = (0.5, 0.35)


def solid(G, nu):
    return {"young_modulus": 2 * G * (1 + nu), "poisson_ratio": nu}


def medium(layers, substrate):
    """Layers of (thickness, G, nu) on a substrate of (G, nu)."""
    return BondedLayers(
        layers=tuple(Layer(thickness=h, **solid(G, nu)) for h, G, nu in layers),
        substrate=Substrate(**solid(*substrate)),
    )


def fourier_integral(response, x, y, half_widths, decay):
    """Field at one point as the integral over all wavevectors, in polar coordinates; response decays with k decay.

    Gauss-Legendre over k on panels that grow from 0 until they hold 2.5 rad of the fastest wave; midpoints over the
    angle, which converge exponentially.
    """
    a, b = half_widths
    reach = np.hypot(x, y) + np.hypot(a, b)
    edges = [0.0, 1e-4 / decay]
    while edges[-1] < 45 / decay:
        edges.append(min(45 / decay, edges[-1] + min(0.7 * edges[-1], 2.5 / reach)))
    points, weights = np.polynomial.legendre.leggauss(12)
    total = 0.0
    for low, high in pairwise(edges):
        k = low + (high - low) * (points + 1) / 2
        count = 4 * int(0.6 * high * reach + 24)
        angle = 2 * np.pi * (np.arange(count) + 0.5) / count
        kx, ky = np.outer(k, np.cos(angle)), np.outer(k, np.sin(angle))
        load = 4 * a * b * np.sinc(kx * a / np.pi) * np.sinc(ky * b / np.pi) * np.exp(1j * (kx * x + ky * y))
        share = (weights * k * (high - low) / 2)[:, None] * (2 * np.pi / count)
        total = total + np.sum(response(kx, ky) * load * share, axis=(-2, -1)).real
    return total / (4 * np.pi**2)


def direct(body, quantity, traction, x, y, z, half_widths):
    """All components at a point: the top layer's kernel, if the point is in it, and a direct Fourier integral."""
    names, load = NAMES[quantity], LOADS[traction]
    shallow = z < body.interfaces[0]

    def response(kx, ky):
        values = body.response(quantity, names, traction, kx, ky, z)
        if shallow:
            values = values - load.wavenumber_response(quantity, names, kx, ky, z, body.surface_material)
        return values

    value = fourier_integral(response, x, y, half_widths, 2 * body.interfaces[0] - z if shallow else z)
    if shallow:
        evaluate = getattr(load, quantity)
        value = value + evaluate(names, np.array(x), np.array(y), z, half_widths, body.surface_material)
    return value


STACKS = {
    "stiff": medium([(1.0, 3.0, 0.2)], (1.0, 0.3)),
    "soft-on-stiff": medium([(0.5, 0.2, 0.5), (0.7, 8.0, 0.0)], (1.0, 0.3)),
    "very-stiff": medium([(0.5, 100.0, 0.3)], (1.0, 0.3)),
}


@pytest.mark.parametrize("z", [0.0, 0.3, 0.6, 1.5])
@pytest.mark.parametrize("quantity", ["displacement", "stress"])
@pytest.mark.parametrize(("stack", "traction"), [("stiff", "p"), ("soft-on-stiff", "q_x"), ("very-stiff", "q_y")])
def test_direct_fourier_integral(stack, traction, quantity, z):
    body = STACKS[stack]
    points = np.array([[0.0, 0.0], [1.3, -0.7]])
    expected = np.array([direct(body, quantity, traction, x, y, z, HALF) for x, y in points]).T
    evaluate = getattr(LAYERED[traction], quantity)
    values = evaluate(NAMES[quantity], points[:, 0], points[:, 1], z, HALF, body)
    assert np.abs(values - expected).max() < 1e-10 * np.abs(expected).max()


@pytest.mark.parametrize("thickness", [1e-4, 1.0, 1e4])
@pytest.mark.parametrize("traction", ["p", "q_x", "q_y"])
@pytest.mark.parametrize("quantity", ["displacement", "stress"])
def test_identical_layers_are_the_half_space(quantity, traction, thickness):
    body = medium([(thickness, 1.5, 0.3), (thickness, 1.5, 0.3)], (1.5, 0.3))
    x = np.arange(12) * 1.0
    same = Material(**solid(1.5, 0.3))
    for z in (0.0, 0.5 * thickness, 1.7 * thickness):
        values = LAYERED[traction].sample(quantity, NAMES[quantity], x, x, z, (0.5, 0.5), body)
        expected = LOADS[traction].sample(quantity, NAMES[quantity], x, x, z, (0.5, 0.5), same)
        assert np.abs(values - expected).max() < 1e-12 * np.abs(expected).max()
