"""Bonded layers under traction waves: against the half-space, two other solutions, limits and conservation laws."""

from itertools import pairwise, product

import mpmath
import numpy as np
import pytest

from bodies import STEEL
from close import close
from eigencontact.errors import SceneError
from eigencontact.hooks.manager import load_plugins
from eigencontact.plugin import COMPONENTS, KINDS, Material
from eigencontact.scene.components import build_component
from eigencontact_plugins.layered import stack
from eigencontact_plugins.layered.stack import BondedLayers, Layer, Substrate
from eigencontact_plugins.surface_loads import PressureLoad, ShearLoadX, ShearLoadY
from eigencontact_verification.oracles.layered_dense import traction_wave
from halfspace.stacks import medium

LOADS = {"p": PressureLoad(), "q_x": ShearLoadX(), "q_y": ShearLoadY()}
UNIT = {"p": (1.0, 0.0, 0.0), "q_x": (0.0, 1.0, 0.0), "q_y": (0.0, 0.0, 1.0)}
AXES = ("x", "y", "z")


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


@pytest.mark.parametrize(
    ("traction", "count"),
    [
        *product(["p", "q_x", "q_y"], [1, 3]),
        ("p", 30),
        *(pytest.param(traction, 30, marks=pytest.mark.slow) for traction in ("q_x", "q_y")),
    ],
)
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
                assert np.all(np.abs(found[part] - expected[part]) <= 1e-12 * scale)


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


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=pytest.mark.slow) if n.startswith("thirty") else n for n in EXTREMES]
)
def test_extreme_layers_agree_with_many_digits(name):
    layers, substrate = EXTREMES[name]
    body = medium(layers, substrate)
    h = max(layers[0][0], 0.2)
    for k in (1e-4, 0.5, 0.99 / h, 1.01 / h):  # both sides of k h = 1, where the formula changes
        C = propagated(layers, substrate, k, 60 + int(2 * k * body.interfaces[-1]))
        kx = np.array([k])
        p = body.response("displacement", AXES, "p", kx, 0 * kx, 0.0)[:, 0]
        q = body.response("displacement", AXES, "q_x", kx, 0 * kx, 0.0)[:, 0]
        r = body.response("displacement", AXES, "q_y", kx, 0 * kx, 0.0)[:, 0]
        found = np.array([[p[2].real, (1j * q[2]).real], [p[0].imag, q[0].real]])
        diagonal = np.sqrt(np.diag(C)[:2])
        assert np.all(np.abs(found - C[:2, :2]) <= 1e-13 * np.outer(diagonal, diagonal))
        assert abs(r[1] - C[2, 2]) <= 1e-14 * C[2, 2]


# --- what must hold for any layers --------------------------------------------------------------------------------

COATED = ([(0.2, 8.0, 0.2), (0.05, 0.02, 0.5), (1.5, 300.0, 0.35)], (1.0, 0.3))


@pytest.mark.parametrize("traction", ["p", "q_x", "q_y"])
def test_displacement_and_traction_are_continuous_and_in_plane_stress_jumps(traction):
    body = medium(*COATED)
    kx, ky = waves(np.random.default_rng(3), 40)
    surface = np.abs(field(body, traction, kx, ky, 0.0))
    for depth in body.interfaces:
        # Extrapolated to the interface from points inside either layer, where that layer is cut; then asked for there.
        points = [depth * (1 + step * 1e-9) for step in (-2, -1, 1, 2)]
        inside = [field(body, traction, kx, ky, z) for z in points]
        over, under = 2 * inside[1] - inside[0], 2 * inside[2] - inside[3]
        sizes = [np.maximum(np.abs(over[part]), surface[part]).max(axis=0) for part in (slice(3), slice(3, 9))]
        scale = np.array([sizes[0]] * 3 + [sizes[1]] * 6)
        steady = [0, 1, 2, 5, 6, 7]
        assert np.all(np.abs(over - under)[steady] <= 1e-12 * scale[steady])
        for side, expected in (("above", over), ("below", under)):
            assert np.all(np.abs(field(body, traction, kx, ky, depth, side) - expected) <= 1e-12 * scale)
        shown = np.exp(-np.hypot(kx, ky) * depth) > 0.1
        assert np.all(np.abs(over - under)[[3, 4, 8]].max(axis=0)[shown] > 1e-3 * np.abs(over[3:]).max(axis=0)[shown])


@pytest.mark.parametrize("traction", ["p", "q_x", "q_y"])
def test_the_stress_on_the_surface_is_the_load(traction):
    kx, ky = waves(np.random.default_rng(4), 40, -6, 4)
    stress = field(medium(*COATED), traction, kx, ky, 0.0)[3:]
    p, q_x, q_y = UNIT[traction]
    for row, expected in ((2, -p), (3, -q_y), (4, -q_x)):
        assert np.all(np.abs(stress[row] - expected) <= 1e-15)


@pytest.mark.parametrize("traction", ["p", "q_x", "q_y"])
def test_long_waves_feel_the_substrate_and_short_ones_the_top_layer(traction):
    body = medium(*COATED)
    angle = np.linspace(0.1, 6.0, 9)
    errors = []
    for material, numbers in ((body.deep_material, (1e-5, 1e-6, 1e-7)), (body.surface_material, (60.0, 90.0, 200.0))):
        half_space = LOADS[traction].wavenumber_response
        for k in numbers:
            wave = (k * np.cos(angle), k * np.sin(angle))
            expected = half_space("displacement", AXES, *wave, 0.0, material)
            found = body.response("displacement", AXES, traction, *wave, 0.0)
            errors.append(np.abs(found - expected).max() / np.abs(expected).max())
    long, short = errors[:3], errors[3:]
    assert all(0.09 < after / before < 0.11 for before, after in pairwise(long))  # first order in k h
    assert long[-1] < 2e-4
    # (k h)² exp(-2 k h) with k h = 12, 18, 40
    assert short[0] < 1e-7
    assert short[1] < 1e-12
    assert short[2] < 1e-14


def test_a_layer_cut_in_two_changes_nothing():
    layers, substrate = COATED
    whole = medium(layers, substrate)
    h, G, nu = layers[0]
    cut = medium(
        [(1e-5 * h, G, nu), (0.4 * h, G, nu), ((0.6 - 1e-5) * h, G, nu), *layers[1:], (0.7, *substrate)], substrate
    )
    kx, ky = waves(np.random.default_rng(5), 60, -6, 2)
    k = np.hypot(kx, ky)
    for traction in UNIT:
        for z in (0.0, 0.1 * h, 0.7 * h, 0.22, 1.0, 1.9, 4.0):
            a, b = field(whole, traction, kx, ky, z), field(cut, traction, kx, ky, z)
            for part in (slice(0, 3), slice(3, 9)):
                scale = np.abs(a[part]).max(axis=0) * (1 + 0.1 * k * z)
                assert np.all(np.abs(a - b)[part] <= 1e-12 * scale)


def test_the_surface_compliance_is_hermitian_and_positive():
    rng = np.random.default_rng(6)
    for count in (1, 4, 30):
        layers, substrate = random_stack(rng, count, decades=3.0)
        body = medium(layers, substrate)
        kx, ky = waves(rng, 50, -5, 4)
        loads = [body.response("displacement", AXES, traction, kx, ky, 0.0) for traction in ("q_x", "q_y", "p")]
        C = np.moveaxis(np.array(loads), (0, 1, 2), (2, 1, 0))
        size = np.abs(C).max(axis=(1, 2))
        assert np.all(np.abs(C - np.conj(np.swapaxes(C, 1, 2))).max(axis=(1, 2)) <= 1e-14 * size)
        assert np.all(np.linalg.eigvalsh(C) > 0)


def test_incompressible_layers_are_the_limit():
    kx, ky = waves(np.random.default_rng(7), 30, -3, 1.5)

    def fields(nu):
        body = medium([(0.3, 0.1, nu), (0.2, 3.0, nu)], (1.0, nu))
        return np.array([field(body, traction, kx, ky, z) for traction in UNIT for z in (0.0, 0.2, 0.3, 0.45, 1.0)])

    limit = fields(0.5)
    assert np.all(np.isfinite(limit))
    steps = [np.abs(fields(0.5 - gap) - limit).max(axis=(0, 1)) for gap in (1e-6, 1e-8)]
    assert np.all(steps[0] <= 1e-3 * np.abs(limit).max(axis=(0, 1)))
    assert np.all(np.abs(steps[1] / steps[0] - 0.01) < 1e-3)  # first order in the distance from 1/2


@pytest.mark.parametrize("h", [1e-4, 1e4])
def test_thicknesses_from_1e_4_to_1e4_give_finite_answers(h):
    body = medium([(h, 5.0, 0.3), (h, 0.2, 0.5)], (1.0, 0.3))
    kx, ky = np.meshgrid(np.linspace(0, 300, 9), np.linspace(-300, 300, 9))
    for z in (0.0, 1e-4, 1.0, 2e4):
        values = field(body, "p", kx, ky, z)
        assert values.shape == (9, 9, 9)
        assert np.all(np.isfinite(values))


def test_the_zero_wave_carries_the_load_and_nothing_else():
    zero = np.zeros(1)
    for row, traction in ((4, "q_x"), (3, "q_y"), (2, "p")):
        expected = np.zeros((9, 1))
        expected[3 + row] = -1.0
        for z in (0.0, 0.1, 5.0):
            assert np.all(field(medium(*COATED), traction, zero, zero, z) == close(expected, abs=1e-15))


# --- table and messages -------------------------------------------------------------------------------------------


def test_bonded_layers_are_registered():
    registry = load_plugins(KINDS, discovered=(), extra=[stack])
    assert not registry.broken
    assert [entry.key for entry in registry.of_kind("layered-medium")] == ["bonded-layers"]
    body = medium(*COATED)
    assert body.interfaces == close((0.2, 0.25, 1.75))
    assert (body.surface_material.poisson_ratio, body.deep_material.poisson_ratio) == (0.2, 0.3)


def build(table):
    registry = load_plugins(KINDS, discovered=(), extra=[stack])
    return build_component(registry, "layered-medium", {"type": "bonded-layers", **table}, "body")


def test_the_table_of_a_scene_takes_units():
    coating = {"thickness": "2 um", "young_modulus": "420 GPa", "poisson_ratio": 0.25}
    body = build({"layers": [coating, {**STEEL, "thickness": 1e-5}], "substrate": STEEL})
    assert body.interfaces == close((2e-6, 12e-6))
    assert body.surface_material == Material(young_modulus=420e9, poisson_ratio=0.25)
    assert body.deep_material == Material(**STEEL)


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ({"layers": [{**STEEL, "thickness": "2 GPa"}], "substrate": STEEL}, "thickness"),
        ({"layers": [{**STEEL, "thicknes": 1.0}], "substrate": STEEL}, "thickness"),
        ({"layers": [{**STEEL, "thickness": 1.0}]}, "substrate"),
    ],
)
def test_a_wrong_table_is_refused_by_name(table, message):
    with pytest.raises(SceneError, match=message):
        build(table)


@pytest.mark.parametrize(
    ("layer", "message"),
    [
        (
            {**STEEL, "thickness": 0.0},
            r"bonded-layers.layers.0.thickness must be positive and finite \[m\] \(got 0.0\)",
        ),
        ({**STEEL, "thickness": np.inf}, "thickness must be positive and finite"),
        ({"thickness": 1.0, "young_modulus": -1.0, "poisson_ratio": 0.3}, "young_modulus must be positive and finite"),
        ({"thickness": 1.0, "young_modulus": 1.0, "poisson_ratio": 0.6}, r"poisson_ratio must be in \(-1, 0.5\]"),
    ],
)
def test_impossible_layers_are_refused(layer, message):
    with pytest.raises(SceneError, match=message):
        BondedLayers(layers=(Layer(**layer),), substrate=Substrate(**STEEL))


def test_a_stack_without_layers_is_refused():
    with pytest.raises(SceneError, match=r"bonded-layers.layers must hold at least one layer \(got none\)"):
        BondedLayers(layers=(), substrate=Substrate(**STEEL))


@pytest.mark.parametrize(
    ("request_", "message"),
    [
        (("strain", ("x",), "p", 0.0), "quantity must be 'displacement' or 'stress'"),
        (("stress", ("x",), "p", 0.0), "components must be of xx, yy, zz, yz, xz, xy"),
        (("stress", ("xx",), "q", 0.0), "traction must be 'p', 'q_x' or 'q_y'"),
        (("stress", ("xx",), "p", -1.0), "z must be zero or positive"),
    ],
)
def test_impossible_requests_are_refused(request_, message):
    quantity, components, traction, z = request_
    with pytest.raises(SceneError, match=message):
        medium(*COATED).response(quantity, components, traction, np.ones(1), np.ones(1), z)
