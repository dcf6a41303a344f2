"""Cuboids in any direction: against quadrature over turned nodes, and against the cuboid along the axes."""

from functools import cache
from itertools import product

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import eigencontact as ec
from close import close
from eigencontact.plugin import HasMirrorPotential, SceneError, integrated_chi
from eigencontact_plugins.shapes.cuboid import Cuboid
from eigencontact_verification.oracles import mindlin, volume_quadrature
from point_potentials import kernel, orders

EDGES = (1.0, 0.7, 0.5)
TURNED = {
    "any": ((0.1, -0.2, 1.2), (0.3, 0.5, 0.7)),
    "flush": ((0.1, -0.2, 0.25), (0.4, 0.0, 0.0)),
    "lying": ((0.1, -0.2, 0.35), (0.4, 0.0, np.pi / 2)),  # flush with its side
    "on an edge": ((0.1, -0.2, 0.5 * (1.0 + 0.5) / np.sqrt(2)), (0.2, np.pi / 4, 0.0)),
}
POINTS = np.array([(1.6, 0.9, 0.0), (-1.2, 0.6, 0.0), (0.1, 1.4, 2.0), (1.5, -0.2, 0.6), (-0.4, -1.3, 1.7)])
E = np.array([[1.0, 0.3, -0.4], [0.3, -0.5, 0.2], [-0.4, 0.2, 0.8]])


def turned(name):
    center, angles = TURNED[name]
    return Cuboid(center=center, edges=EDGES, rotation=angles)


def matrix(name):
    return Rotation.from_euler("ZYX", TURNED[name][1]).as_matrix()


def nodes(name, count=10):
    offsets, weights = volume_quadrature.cuboid_nodes((0, 0, 0), EDGES, count)
    return np.array(TURNED[name][0]) + offsets @ matrix(name).T, weights


def tensor(shape, potential, order, points):
    """All derivatives of an order ``(3, ..., 3, n)``."""
    found = dict(zip(orders(order), getattr(shape, potential)(orders(order), *points.T), strict=True))
    out = np.empty((3,) * order + (len(points),))
    for index in product(range(3), repeat=order):
        out[index] = found[tuple(index.count(axis) for axis in range(3))]
    return out


@cache
def moments(name, gradient):
    count = 9 if name == "any" else 8  # within 2e-10 of the moments with 10 nodes an edge
    return volume_quadrature.volume_moments(POINTS, nodes(name, count), gradient=gradient)


@pytest.mark.parametrize(
    "name", ["any", *(pytest.param(name, marks=pytest.mark.slow) for name in TURNED if name != "any")]
)
@pytest.mark.parametrize("quantity", ["displacement", pytest.param("strain", marks=pytest.mark.slow), "stress"])
def test_field_in_the_half_space_is_that_of_quadrature(name, quantity):
    found = ec.inclusion_field(turned(name), E, POINTS, young_modulus=2.6, poisson_ratio=0.3, quantity=quantity)
    known = moments(name, quantity != "displacement")
    if quantity == "stress":
        expected = mindlin.stress(known, E, 0.3, np.zeros(len(POINTS)))
    else:
        expected = {"displacement": mindlin.displacement, "strain": mindlin.strain}[quantity](known, E, 0.3)
    assert np.abs(found - expected).max() < 1e-9 * np.abs(expected).max()


@pytest.mark.parametrize(
    ("potential", "order"), [("phi", 1), ("phi", 2), ("phi", 4), ("psi", 3), ("psi", 4), ("psi", 5)]
)
def test_potentials_turn_as_tensors(potential, order):
    """Inside, on faces, in line with edges and far away; compared with the cuboid along the axes."""
    center, turn = np.array(TURNED["any"][0]), matrix("any")
    half = np.array(EDGES) / 2
    own = half * np.array(
        [(0.2, 0.3, 0.1), (0.1, 0, 0), (1, 0.2, 0.3), (0.1, -1, 0.4), (1, 1, 3), (2, -3, 4), (40, 7, 9)]
    )
    straight = Cuboid(center=(0.0, 0.0, 0.0), edges=EDGES)
    expected = tensor(straight, potential, order, own)
    for axis in range(order):
        expected = np.moveaxis(np.tensordot(turn, expected, axes=(1, axis)), 0, axis)
    found = tensor(turned("any"), potential, order, center + own @ turn.T)
    error, size = (np.abs(values).reshape(-1, len(own)).max(axis=0) for values in (found - expected, expected))
    assert (error / size).max() < 1e-10  # the sum over corners loses 5e-11 at the last point


@pytest.mark.parametrize("name", TURNED)
@pytest.mark.parametrize("order", [3, 4])
def test_chi_is_that_of_quadrature(name, order):
    places, weights = nodes(name)
    asked = [one for one in orders(order) if one[2] <= 1]
    found = turned(name).chi(asked, *POINTS.T)
    offsets = POINTS[:, None] * (1, 1, 1) - places * (1, 1, -1)
    expected = np.array([(kernel("chi", one, tuple(offsets.T)).T * weights).sum(axis=1) for one in asked])
    assert np.abs(found - expected).max() < 1e-9 * np.abs(expected).max()


def test_chi_in_closed_form_under_a_yaw_equals_the_integral():
    shape = turned("flush")
    x, y, z = (np.array([0.3, -0.1, 2.0, 30.0]), np.array([0.0, 0.2, 1.0, 10.0]), np.array([0.01, 0.4, 0.0, 3.0]))
    asked = [one for one in (*orders(3), *orders(4)) if one[2] <= 1]
    found, integral = shape.chi(asked, x, y, z), integrated_chi(shape, asked, x, y, z)
    assert (np.abs(found - integral).max(axis=0) / np.abs(integral).max(axis=0)).max() < 2e-10
    assert isinstance(shape, HasMirrorPotential)


@pytest.mark.parametrize(
    ("angles", "edges"),
    [
        ((0.0, 0.0, 0.0), (1.0, 0.7, 0.5)),
        ((np.pi / 2, 0.0, 0.0), (0.7, 1.0, 0.5)),
        ((0.0, np.pi / 2, 0.0), (0.5, 0.7, 1.0)),
        ((np.pi, -np.pi / 2, np.pi / 2), (0.7, 0.5, 1.0)),
    ],
)
def test_quarter_turns_are_other_cuboids_to_the_last_bit(angles, edges):
    found = Cuboid(center=(0.1, -0.2, 1.2), edges=EDGES, rotation=angles)
    straight = Cuboid(center=(0.1, -0.2, 1.2), edges=edges)
    assert found.bounds == straight.bounds
    assert np.array_equal(found.far_field().positions, straight.far_field().positions)
    for potential, order in (("phi", 1), ("phi", 4), ("psi", 3), ("psi", 5), ("chi", 3)):
        asked = [one for one in orders(order) if potential != "chi" or one[2] <= 1]
        assert np.array_equal(
            getattr(found, potential)(asked, *POINTS.T), getattr(straight, potential)(asked, *POINTS.T)
        )


def test_region_and_bounds():
    shape = turned("any")
    low, high = (np.array(corner) for corner in shape.bounds)
    corners = np.array(TURNED["any"][0]) + np.array(list(product(*[(-e / 2, e / 2) for e in EDGES]))) @ matrix("any").T
    assert low == close(corners.min(axis=0), rel=1e-14, abs=1e-15)
    assert high == close(corners.max(axis=0), rel=1e-14, abs=1e-15)
    at = np.random.default_rng(2).uniform(low, high, (2000, 3))
    own = np.abs((at - TURNED["any"][0]) @ matrix("any"))
    assert np.array_equal(shape.contains(*at.T), np.all(own <= np.array(EDGES) / 2, axis=1))


def test_cells_cut_from_it_give_its_field():
    class Hidden(Cuboid):
        phi = psi = chi = far_field = corner = property()

    shape = turned("any")
    hidden = Hidden(center=shape.center, edges=shape.edges, rotation=shape.rotation)
    given = {"young_modulus": 1.0, "poisson_ratio": 0.3, "quantity": "stress"}
    exact = ec.inclusion_field(shape, E, POINTS, **given)
    cut = ec.inclusion_field(hidden, E, POINTS, cells=32, **given)
    assert 0 < np.abs(cut - exact).max() < 2e-3 * np.abs(exact).max()


def test_a_list_of_turned_cuboids_is_summed_like_any_other():
    shapes = [turned("any"), turned("flush"), turned("lying")]
    points = np.vstack([POINTS, POINTS + np.array([20.0, 0.0, 0.0])])
    given = {"young_modulus": 1.0, "poisson_ratio": 0.3, "quantity": "stress"}
    singly = sum(ec.inclusion_field(shape, E, points, **given) for shape in shapes)
    assert np.abs(ec.inclusion_field(shapes, E, points, **given) - singly).max() < 1e-11 * np.abs(singly).max()


@pytest.mark.parametrize("rotation", [(1.0, 2.0), (0.0, np.nan, 0.0), np.ones((3, 3)), -np.eye(3), "east"])
def test_what_is_no_rotation_is_refused(rotation):
    with pytest.raises(SceneError, match=r"cuboid.rotation must be a rotation matrix .* or three finite angles"):
        Cuboid(center=(0, 0, 1), edges=EDGES, rotation=rotation)


def test_a_table_of_a_scene_takes_angles_with_units():
    shape = ec.make("cuboid", center=(0, 0, "2 um"), edges=("1 um",) * 3, rotation=("30 deg", 0.0, 0.0))
    assert shape.rotation[0] == close(np.pi / 6, rel=1e-15)
    assert hash(shape) == hash(ec.make("cuboid", center=(0, 0, "2 um"), edges=("1 um",) * 3, rotation=shape.rotation))


def test_explain_tells_where_the_mirror_image_is_integrated():
    assert turned("flush").method == "closed form"
    assert turned("any").method == "closed form, and quadrature of the mirror image"
