"""Influence coefficients of bonded layers: against direct Fourier integrals, the half-space, limits and symmetries."""

from itertools import pairwise, product

import numpy as np
import pytest

from eigencontact.errors import NotConverged, PlanError, SceneError
from eigencontact.halfspace import layered_influence
from eigencontact.halfspace.layered_influence import LayeredInfluence
from eigencontact.plugin import COMPONENTS, HasResponseAtDepths, LayeredMedium, Material, SurfaceInfluence
from eigencontact_plugins.layered.stack import BondedLayers
from eigencontact_plugins.surface_loads import PressureLoad, ShearLoadX, ShearLoadY
from halfspace.stacks import medium, solid

LOADS = {"p": PressureLoad(), "q_x": ShearLoadX(), "q_y": ShearLoadY()}
LAYERED = {name: LayeredInfluence(load) for name, load in LOADS.items()}
AXES = ("x", "y", "z")
NAMES = {"displacement": AXES, "stress": COMPONENTS}
HALF = (0.5, 0.35)
OWN = {"p": "z", "q_x": "x", "q_y": "y"}


def fourier_integral(response, x, y, half_widths, decay):
    """Field at one point as the integral over all wavevectors, in polar coordinates; response decays with k decay.

    Gauss-Legendre over k on panels that grow from 0 until they hold 2.5 rad of the fastest wave; midpoints over the
    angle, which converge exponentially.
    """
    a, b = half_widths
    reach = np.hypot(x, y) + np.hypot(a, b)
    edges = [0.0, 1e-10 / decay]
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


@pytest.mark.parametrize("z", [0.0, 0.6, 1.5])
@pytest.mark.parametrize("quantity", ["displacement", "stress"])
@pytest.mark.parametrize(("stack", "traction"), [("stiff", "p"), ("soft-on-stiff", "q_x"), ("very-stiff", "q_y")])
def test_direct_fourier_integral(stack, traction, quantity, z):
    body = STACKS[stack]
    expected = direct(body, quantity, traction, 0.7, -0.3, z, HALF)
    values = getattr(LAYERED[traction], quantity)(NAMES[quantity], np.array(0.7), np.array(-0.3), z, HALF, body)
    assert np.abs(values - expected).max() < 1e-10 * np.abs(expected).max()


@pytest.mark.parametrize("thickness", [1e-4, 1e4])
@pytest.mark.parametrize("traction", ["p", *(pytest.param(name, marks=pytest.mark.slow) for name in ("q_x", "q_y"))])
@pytest.mark.parametrize("quantity", ["displacement", "stress"])
def test_identical_layers_are_the_half_space(quantity, traction, thickness):
    body = medium([(thickness, 1.5, 0.3), (thickness, 1.5, 0.3)], (1.5, 0.3))
    x = np.arange(12) * 1.0
    same = Material(**solid(1.5, 0.3))
    for z in (0.0, 1.7 * thickness):
        values = LAYERED[traction].sample(quantity, NAMES[quantity], x, x, z, (0.5, 0.5), body)
        # Point by point: the homogeneous lattice itself, of corner sums, is off by 1e-4 at a depth of 17000 cells.
        evaluate = getattr(LOADS[traction], quantity)
        expected = evaluate(NAMES[quantity], x[None, :], x[:, None], z, (0.5, 0.5), same)
        assert np.abs(values - expected).max() < 1e-12 * np.abs(expected).max()


def lattice(traction, quantity, components, body, z=0.0, half=0.5, count=6, side="below"):
    x = 2 * half * np.arange(count)
    return LayeredInfluence(LOADS[traction], side=side).sample(quantity, components, x, x, z, (half, half), body)


@pytest.mark.parametrize(("thicknesses", "alike"), [((1e3, 1e4), (5.0, 0.1)), ((1e-3, 1e-4), (1.0, 0.3))])
@pytest.mark.parametrize("traction", ["p", "q_x"])
def test_thick_layers_are_their_half_space_and_thin_ones_the_substrate(traction, thicknesses, alike):
    """To first order in the cell over the thickness, or in the thickness over the cell."""
    x, own = np.arange(6) * 1.0, [OWN[traction]]
    same = LOADS[traction].sample("displacement", own, x, x, 0.0, (0.5, 0.5), Material(**solid(*alike)))
    change = []
    for thickness in thicknesses:
        values = lattice(traction, "displacement", own, medium([(thickness, 5.0, 0.1)], (1.0, 0.3)))
        change.append(np.abs(values - same).max() / np.abs(same).max())
    assert 9 < change[0] / change[1] < 11
    assert change[1] < 3e-3


def test_reciprocity():
    body = STACKS["soft-on-stiff"]
    lift = lattice("q_x", "displacement", ["z"], body)
    drag = lattice("p", "displacement", ["x"], body)
    np.testing.assert_allclose(lift, -drag, atol=1e-10 * np.abs(drag).max())
    np.testing.assert_allclose(
        lattice("q_x", "displacement", ["y"], body), lattice("q_y", "displacement", ["x"], body), atol=1e-10
    )


@pytest.mark.parametrize(("quantity", "z"), [("displacement", 0.0), ("stress", 0.2), ("stress", 1.5)])
@pytest.mark.parametrize("traction", ["p", "q_y"])
def test_four_cells_are_one_of_double_edge(traction, quantity, z):
    body = STACKS["soft-on-stiff"]
    x, y = np.array([0.3, 2.0, -7.0]), np.array([-0.4, 1.0, 4.0])
    evaluate = getattr(LAYERED[traction], quantity)
    whole = evaluate(NAMES[quantity], x, y, z, (0.8, 0.6), body)
    sx, sy = np.array([0.4, -0.4, 0.4, -0.4]), np.array([0.3, 0.3, -0.3, -0.3])
    parts = evaluate(NAMES[quantity], x[:, None] + sx, y[:, None] + sy, z, (0.4, 0.3), body).sum(axis=-1)
    np.testing.assert_allclose(parts, whole, atol=1e-9 * np.abs(whole).max())


@pytest.mark.parametrize("traction", ["p", "q_x"])
def test_tractions_and_displacements_are_continuous_across_interfaces(traction):
    body = STACKS["soft-on-stiff"]
    for z in body.interfaces[-1:]:
        above, below = (lattice(traction, "stress", COMPONENTS, body, z, side=side) for side in ("above", "below"))
        jump = np.abs(above - below).max(axis=(1, 2)) / np.abs(below).max()
        assert jump[2:5].max() < 1e-8
        assert jump[[0, 1, 5]].min() > 1e-3
        near = lattice(traction, "stress", COMPONENTS, body, z * (1 - 1e-9))
        np.testing.assert_allclose(near, above, atol=1e-7)
        u, v = (lattice(traction, "displacement", AXES, body, depth) for depth in (z * (1 - 1e-9), z))
        np.testing.assert_allclose(u, v, atol=1e-7 * np.abs(v).max())


def test_units_and_mirror_symmetry():
    body, small = STACKS["stiff"], medium([(1e-6, 3e9, 0.2)], (1e9, 0.3))
    x = np.array([-2.0, 0.5, 2.0])
    for traction in ("p", "q_x"):
        u = LAYERED[traction].displacement(AXES, x, 0.7, 0.3, HALF, body)
        half = (HALF[0] * 1e-6, HALF[1] * 1e-6)
        v = LAYERED[traction].displacement(AXES, x * 1e-6, 0.7e-6, 0.3e-6, half, small)
        np.testing.assert_allclose(v * 1e15, u, rtol=1e-9, atol=1e-12)
        odd = np.array([1.0, -1.0, -1.0]) if traction == "q_x" else np.array([-1.0, 1.0, 1.0])
        np.testing.assert_allclose(u[:, 0], odd * u[:, 2], rtol=1e-11)


def test_points_at_many_depths_and_lattices_agree():
    body, x, z = STACKS["soft-on-stiff"], np.arange(4) * 1.0, np.array([0.0, 0.8])
    points = LAYERED["p"].stress(["zz", "xz"], x[None, :, None], x[:, None, None], z, (0.5, 0.5), body)
    for number, depth in enumerate(z):
        values = lattice("p", "stress", ["zz", "xz"], body, depth, count=4)
        np.testing.assert_allclose(points[..., number], values, atol=1e-9)


def test_homogeneous_bodies_and_waves_are_passed_on():
    same, k, nil = Material(**solid(1.0, 0.3)), np.array([1.0, 2.0]), np.zeros(2)
    x = np.arange(3.0)
    for evaluate in ("displacement", "stress"):
        arguments = (NAMES[evaluate], x, x, 0.5, HALF, same)
        expected = getattr(LOADS["p"], evaluate)(*arguments)
        np.testing.assert_array_equal(getattr(LAYERED["p"], evaluate)(*arguments), expected)
        waves = (evaluate, NAMES[evaluate], k, nil, 0.5)
        np.testing.assert_array_equal(
            LAYERED["p"].wavenumber_response(*waves, same), LOADS["p"].wavenumber_response(*waves, same)
        )
    body = STACKS["stiff"]
    np.testing.assert_array_equal(
        LAYERED["q_x"].wavenumber_response("stress", ["xx"], k, nil, 1.0, body),
        body.response("stress", ["xx"], "q_x", k, nil, 1.0),
    )
    assert (LAYERED["q_x"].traction, LAYERED["q_x"].key) == ("q_x", "shear-x")


@pytest.mark.parametrize("count", [1, 30])
@pytest.mark.parametrize("modulus", [1e-6, 1e6])
def test_bound_covers_another_grid(modulus, count):
    """The same half-widths at two reaches and depths of the grids: the smaller window is part of the larger."""
    layers = [(10 ** (-3 + 4 * i / 30), modulus if i % 2 == 0 else 1.0, 0.01 * (i + 20)) for i in range(count)]
    body, x = medium(layers, (1.0, 0.3)), np.arange(200) * 1.0
    field = LAYERED["p"].at_depths("displacement", ["z"], np.zeros(1), (0.5, 0.5), x.max(), body)
    wide, bound = field.on_lattice(0, x, x), field.bounds[0]
    narrow = LAYERED["p"].sample("displacement", ["z"], x[:7], x[:7], 0.0, (0.5, 0.5), body)
    assert bound < 1e-6
    assert np.abs(wide[:, :7, :7] - narrow).max() <= bound * np.abs(wide).max()


# --- many depths --------------------------------------------------------------------------------------------------


def at_depths(traction, quantity, body, depths, x, half_widths, components=None):
    names = components or NAMES[quantity]
    reach = float(np.abs(x).max())
    return LayeredInfluence(LOADS[traction]).at_depths(quantity, names, np.array(depths), half_widths, reach, body)


@pytest.mark.parametrize("traction", ["p", "q_x", pytest.param("q_y", marks=pytest.mark.slow)])
@pytest.mark.parametrize("quantity", ["displacement", "stress"])
def test_depths_together_are_depths_alone(quantity, traction):
    """Nodes, wavenumbers and transforms are shared: in the layers and below, in any order, some twice."""
    body, x, y = STACKS["soft-on-stiff"], np.arange(12) * 0.06, np.arange(8) * 0.05
    depths = [3.0, 0.0, 0.02, 0.3, 0.5, 0.3, 1.19, 1.2, 40.0]
    field = at_depths(traction, quantity, body, depths, x, (0.03, 0.025))
    assert field.bounds.shape == (len(depths),)
    assert np.all(field.bounds < 3e-9)
    for number, z in enumerate(depths):
        alone = LAYERED[traction].sample(quantity, NAMES[quantity], x, y, z, (0.03, 0.025), body)
        together = field.on_lattice(number, x, y)
        assert np.abs(together - alone).max() < 1e-10 * np.abs(alone).max()
        points = field.about_points(number, x[:3], y[:3])
        assert np.abs(points - alone[:, range(3), range(3)]).max() < 1e-10 * np.abs(alone).max()


@pytest.mark.parametrize("traction", ["p", "q_x", "q_y"])
@pytest.mark.parametrize(("quantity", "half_widths"), [("stress", (0.03, 0.025)), ("displacement", (0.003, 0.0025))])
def test_sums_of_a_load_are_those_of_tables(quantity, half_widths, traction):
    """On lattices about one place, which share what the load does to the nodes, and about others."""
    body, depths = STACKS["soft-on-stiff"], [0.0, 0.02, 0.3, 0.7, 1.5]
    x, y = (np.arange(-6, 6) * 2 * half for half in half_widths)
    field = at_depths(traction, quantity, body, depths, np.array([1.0]), half_widths)
    load = np.random.default_rng(1).standard_normal((y.size, x.size))
    sums = field.superposing(load)
    for number, (right, down) in product(range(len(depths)), [(0.0, 0.0), (0.1, -0.2)]):
        table = field.on_lattice(number, x + right, y + down)
        expected = (table * load).sum(axis=(1, 2))
        assert np.abs(sums(number, x + right, y + down) - expected).max() < 1e-13 * (np.abs(table * load)).sum()


@pytest.mark.parametrize("z", [0.3, 0.499, 0.7])
@pytest.mark.parametrize("quantity", ["displacement", "stress"])
@pytest.mark.parametrize("traction", ["p", "q_x"])
def test_small_cells_at_depth(traction, quantity, z):
    """More than twenty half-widths down, in the top layer and under it, nothing but the response itself is used."""
    body, half_widths = STACKS["soft-on-stiff"], (0.011, 0.007)
    expected = direct(body, quantity, traction, 0.2, -0.1, z, half_widths)
    found = at_depths(traction, quantity, body, [z], np.array([0.2]), half_widths)
    lattice_value = found.on_lattice(0, np.array([0.2]), np.array([-0.1]))[:, 0, 0]
    assert np.abs(lattice_value - expected).max() < 1e-9 * np.abs(expected).max()


class Counting(BondedLayers):
    asked = 0

    def response_at_depths(self, *arguments, **options):
        type(self).asked += 1
        return super().response_at_depths(*arguments, **options)


def test_more_depths_in_between_ask_the_medium_no_more_often():
    body = Counting(layers=STACKS["stiff"].layers, substrate=STACKS["stiff"].substrate)
    asked = []
    for count in (9, 65):
        Counting.asked = 0
        at_depths("q_x", "stress", body, np.linspace(0.0, 2.0, count), np.arange(20) * 0.1, (0.05, 0.05))
        asked.append(Counting.asked)
    assert asked[1] <= asked[0] + 4  # one more band at most: two wavevectors, two resolutions
    assert asked[0] <= 24


def test_a_second_lattice_and_another_component_ask_nothing_more():
    body = Counting(layers=STACKS["stiff"].layers, substrate=STACKS["stiff"].substrate)
    influence, x = LayeredInfluence(LOADS["p"]), np.arange(20) * 0.1
    influence.sample("displacement", ["z"], x, x, 0.0, (0.05, 0.05), body)
    resolved = Counting.asked
    influence.sample("displacement", ["x"], 0.97 * x, x, 0.0, (0.0485, 0.05), body)
    assert Counting.asked == resolved + 1  # the depth of the substrate's kernel


def test_the_memory_of_fields_is_bounded(monkeypatch):
    monkeypatch.setattr(layered_influence, "FIELD_MEMORY", 1e6)
    influence, depths = LayeredInfluence(LOADS["p"]), np.linspace(0.0, 3.0, 60)
    for part in (depths, depths[::2]):
        influence.at_depths("stress", COMPONENTS, part, (0.05, 0.05), 2.0, STACKS["stiff"])
        assert sum(field.nbytes for field in influence._fields.values()) <= 1e6


def test_an_offset_beyond_the_reach_is_refused():
    field = at_depths("p", "stress", STACKS["stiff"], [0.5], np.array([0.0, 1.0]), HALF)
    with pytest.raises(SceneError, match=r"layers.offset must be at most the reach, 1 \[m\] \(got 1.5\)"):
        field.on_lattice(0, np.array([1.5]), np.array([0.0]))


class OneByOne(LayeredMedium):
    """A stranger's medium: it answers for one depth at a time."""

    key = "one-by-one"
    references = ("none",)
    stack = STACKS["soft-on-stiff"]
    surface_material, deep_material, interfaces = stack.surface_material, stack.deep_material, stack.interfaces

    def material_at(self, z, *, side="below"):
        return self.stack.material_at(z, side=side)

    def response(self, *arguments, **options):
        return self.stack.response(*arguments, **options)


def test_a_medium_may_leave_the_loop_over_depths_to_us():
    x, depths = np.arange(5) * 1.0, [0.0, 0.7, 2.0]
    assert not isinstance(OneByOne(), HasResponseAtDepths)
    assert isinstance(OneByOne.stack, HasResponseAtDepths)
    one, other = (at_depths("q_y", "stress", body, depths, x, HALF) for body in (OneByOne(), OneByOne.stack))
    for number in range(len(depths)):
        expected = other.on_lattice(number, x, x)
        np.testing.assert_allclose(one.on_lattice(number, x, x), expected, atol=1e-13 * np.abs(expected).max())


class NoWaves(SurfaceInfluence):
    key, traction = "no-waves", "p"

    def displacement(self, *arguments):
        raise NotImplementedError

    stress = displacement


class NoInterface(BondedLayers):
    interfaces = ()


class LateInterface(BondedLayers):
    interfaces = (100.0,)


def test_refusals():
    arguments = {"layers": STACKS["stiff"].layers, "substrate": STACKS["stiff"].substrate}
    with pytest.raises(PlanError, match="must have an interface"):
        lattice("p", "displacement", ["z"], NoInterface(**arguments))
    with pytest.raises(NotConverged, match="must agree to 1e-05 between two resolutions"):
        lattice("p", "displacement", ["z"], LateInterface(**arguments))
    with pytest.raises(PlanError, match="'no-waves' must offer wavenumber_response"):
        LayeredInfluence(NoWaves())
