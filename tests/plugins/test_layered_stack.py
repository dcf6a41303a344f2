"""Bonded layers under traction waves: against the half-space, two other solutions, limits and conservation laws."""

import mpmath
import numpy as np
import pytest

from eigencontact.plugin import COMPONENTS, Material
from eigencontact_plugins.layered.stack import BondedLayers, Layer, Substrate
from eigencontact_plugins.surface_loads import PressureLoad, ShearLoadX, ShearLoadY
from eigencontact_verification.oracles.layered_dense import traction_wave

LOADS = {"p": PressureLoad(), "q_x": ShearLoadX(), "q_y": ShearLoadY()}
UNIT = {"p": (1.0, 0.0, 0.0), "q_x": (0.0, 1.0, 0.0), "q_y": (0.0, 0.0, 1.0)}
AXES = ("x", "y", "z")
BALANCING = ("xz", "yz", "zz")


def medium(layers, substrate):
    """Layers of (thickness, G, nu) on a substrate of (G, nu)."""
    return BondedLayers(
        layers=tuple(Layer(thickness=h, young_modulus=2 * G * (1 + nu), poisson_ratio=nu) for h, G, nu in layers),
        substrate=Substrate(young_modulus=2 * substrate[0] * (1 + substrate[1]), poisson_ratio=substrate[1]),
    )


def random_stack(rng, count, decades=1.0):
    layers = [(10 ** rng.uniform(-1.5, 0.3), 10 ** rng.uniform(-decades, decades), rng.uniform(-0.3, 0.5))
              for _ in range(count)]  # fmt: skip
    return layers, (1.0, 0.3)


def field(body, traction, kx, ky, z, side="below"):
    """Displacement x, y, z and plain stress, (9, ...)."""
    u = body.response("displacement", AXES, traction, kx, ky, z, side=side)
    stress = body.response("stress", COMPONENTS, traction, kx, ky, z, side=side)
    stress[3:] /= np.sqrt(2)
    return np.concatenate([u, stress])


def waves(rng, count, lowest=-3.0, highest=2.0):
    k, angle = 10 ** rng.uniform(lowest, highest, count), rng.uniform(0, 2 * np.pi, count)
    return k * np.cos(angle), k * np.sin(angle)


# --- the same material everywhere ---------------------------------------------------------------------------------


@pytest.mark.parametrize("nu", [-0.5, 0.0, 0.3, 0.5])
@pytest.mark.parametrize("traction", ["p", "q_x", "q_y"])
def test_identical_layers_are_the_half_space(traction, nu):
    body = medium([(0.1, 1.5, nu), (0.5, 1.5, nu), (1e-4, 1.5, nu), (3.0, 1.5, nu)], (1.5, nu))
    same = Material(young_modulus=3.0 * (1 + nu), poisson_ratio=nu)
    kx, ky = waves(np.random.default_rng(1), 60, -6, 3)
    kx, ky = np.append(kx, [0.0, 2.0, 0.0]), np.append(ky, [0.0, 0.0, -2.0])
    k = np.hypot(kx, ky)
    for z in (0.0, 0.05, 0.1, 0.3, 0.6, 2.0, 3.6001, 10.0):
        # relative to the size of the wave at that depth
        size = np.exp(-np.minimum(k * z, 700)) * (1 + k * z)
        for quantity, names in (("displacement", AXES), ("stress", COMPONENTS)):
            expected = LOADS[traction].wavenumber_response(quantity, names, kx, ky, z, same)
            found = body.response(quantity, names, traction, kx, ky, z)
            unit = 1 / np.maximum(k, 1e-300) if quantity == "displacement" else 1.0
            wrong = np.abs(found - expected) / np.where(k > 0, size * unit, 1.0)
            near = k * z < 600
            assert np.all(wrong[:, near] <= 1e-12 * (1 + 0.01 * k * z)[near])  # exp(-kz) itself: k z roundings
            assert np.all(np.isfinite(found))


# --- other solutions of the same problem --------------------------------------------------------------------------


@pytest.mark.parametrize("count", [1, 3, 30])
@pytest.mark.parametrize("traction", ["p", "q_x", "q_y"])
def test_random_layers_agree_with_one_dense_solution(traction, count):
    rng = np.random.default_rng(count)
    layers, substrate = random_stack(rng, count)
    body = medium(layers, substrate)
    kx, ky = waves(rng, 6)
    depths = [0.0, 0.4 * layers[0][0], body.interfaces[0], 0.5 * body.interfaces[-1], 1.2 * body.interfaces[-1]]
    for z in depths:
        for side in ("above", "below"):
            found = field(body, traction, kx, ky, z, side)
            each = [
                traction_wave(layers, substrate, UNIT[traction], *pair, z, side=side)
                for pair in zip(kx, ky, strict=True)
            ]
            expected = np.array([np.concatenate(one) for one in each]).T
            surface = np.abs(field(body, traction, kx, ky, 0.0))
            for part in (slice(0, 3), slice(3, 9)):
                scale = np.maximum(np.abs(expected[part]).max(axis=0), 1e-3 * surface[part].max(axis=0))
                assert np.all(np.abs(found[part] - expected[part]) <= 1e-10 * scale)


def propagated(layers, substrate, k, digits):
    """Surface compliance (w, a) from (p, q) and v from r at wavenumber k: series of the transfer matrices, many digits.

    The only waves left in the substrate are those that decay. Signs as in `recursion`; nothing scaled or split.
    """
    mp = mpmath.mp

    def rates(G, nu):
        """d/dz of (w, a, p, q, v, r), from Hooke's law and equilibrium."""
        G, nu = mp.mpf(G), mp.mpf(nu)
        N = mp.zeros(6)
        N[0, 1], N[0, 2] = k * nu / (1 - nu), -(1 - 2 * nu) / (2 * G * (1 - nu))
        N[1, 0], N[1, 3] = -k, -1 / G
        N[2, 3] = k
        N[3, 1], N[3, 2] = -2 * G * k * k / (1 - nu), -k * nu / (1 - nu)
        N[4, 5], N[5, 4] = -1 / G, -G * k * k
        return N

    with mpmath.workdps(digits):
        k = mp.mpf(k)
        G, nu = (mp.mpf(value) for value in substrate)
        state = mp.zeros(6, 3)  # half-space: columns p, q, r
        state[0, 0] = state[1, 1] = (1 - nu) / (G * k)
        state[0, 1] = state[1, 0] = (1 - 2 * nu) / (2 * G * k)
        state[4, 2] = 1 / (G * k)
        state[2, 0] = state[3, 1] = state[5, 2] = mp.mpf(1)
        for h, G, nu in reversed(layers):
            step = -rates(G, nu) * mp.mpf(h)
            term, power = state, 1
            while True:
                term = step * term / power
                state = state + term
                power += 1
                if power > abs(k * h) + 5 and mp.norm(term) < mp.mpf(10) ** (-digits) * mp.norm(state):
                    break
        over = mp.matrix([[state[row, column] for column in range(3)] for row in (0, 1, 4)])
        load = mp.matrix([[state[row, column] for column in range(3)] for row in (2, 3, 5)])
        C = over * load**-1
        return np.array([[float(C[row, column]) for column in range(3)] for row in range(3)])


EXTREMES = {
    "thin stiff": ([(1e-4, 1e6, 0.3)], (1.0, 0.3)),
    "thin soft": ([(1e-4, 1e-6, 0.3)], (1.0, 0.3)),
    "thin incompressible": ([(1e-2, 1e-3, 0.5)], (1.0, 0.3)),
    "stiff on soft on stiff": ([(0.05, 1e3, 0.2), (0.3, 1e-3, 0.5)], (1.0, 0.0)),
    "nearly void under": ([(1.0, 1.0, 0.3)], (1e-6, 0.3)),
    "thick": ([(30.0, 2.0, 0.4), (5.0, 0.5, 0.1)], (1.0, 0.5)),
    "thirty alternating": ([(0.1, 10.0 ** (2 * (j % 2)), 0.5 if j % 3 == 0 else 0.25) for j in range(30)], (5.0, 0.3)),
}


@pytest.mark.parametrize("name", EXTREMES)
def test_extreme_layers_agree_with_many_digits(name):
    layers, substrate = EXTREMES[name]
    body = medium(layers, substrate)
    for k in (1e-4, 1e-2, 0.5, 1.01 / layers[0][0] if layers[0][0] > 0.01 else 3.0, 7.0):
        C = propagated(layers, substrate, k, 60 + int(2 * k * body.interfaces[-1]))
        kx = np.array([k])
        p = body.response("displacement", AXES, "p", kx, 0 * kx, 0.0)[:, 0]
        q = body.response("displacement", AXES, "q_x", kx, 0 * kx, 0.0)[:, 0]
        r = body.response("displacement", AXES, "q_y", kx, 0 * kx, 0.0)[:, 0]
        found = np.array([[p[2].real, (1j * q[2]).real], [p[0].imag, q[0].real]])
        diagonal = np.sqrt(np.diag(C)[:2])
        assert np.all(np.abs(found - C[:2, :2]) <= 1e-10 * np.outer(diagonal, diagonal))
        assert abs(r[1] - C[2, 2]) <= 1e-12 * C[2, 2]
