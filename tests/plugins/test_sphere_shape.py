"""The sphere against quadrature of point potentials that are written out independently."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from close import close
from eigencontact.plugin import HasFarField, HasMirrorPotential, HasPotentials, SceneError
from eigencontact_plugins.shapes.sphere import SphericalInclusion
from point_potentials import kernel, orders
from shape_potentials import DERIVATIVES, RAISED, check_forms, check_gradient, check_scaling, columns, evaluate

CENTER, RADIUS = (0.3, -0.2, 1.4), 0.8
BALL = SphericalInclusion(center=CENTER, radius=RADIUS)
TANGENT = SphericalInclusion(center=(0.0, 0.0, 1.0), radius=1.0)


def ball_integral(potential, chosen, point):
    """Gauss-Legendre in radius and height, trapezoidal around the axis."""
    nodes, weights = np.polynomial.legendre.leggauss(40)
    radius, height = RADIUS * (nodes + 1) / 2, nodes
    turn = 2 * np.pi * np.arange(72) / 72
    r, h, t = np.meshgrid(radius, height, turn, indexing="ij")
    volume = r**2 * np.einsum("i,j->ij", RADIUS / 2 * weights, weights)[:, :, None] * (2 * np.pi / 72)
    across = r * np.sqrt(1 - h * h)
    x, y, z = point
    depth = z + CENTER[2] + r * h if potential == "chi" else z - CENTER[2] - r * h
    offsets, known = (x - CENTER[0] - across * np.cos(t), y - CENTER[1] - across * np.sin(t), depth), {}
    return np.array([np.sum(volume * kernel(potential, one, offsets, known)) for one in chosen])


# Anywhere, on the vertical axis above and below, on a horizontal axis, in line with a diagonal.
OUTSIDE = [(1.9, 0.9, 2.6), (-1.2, 0.3, 0.3), (0.3, -0.2, 0.0), (0.3, -0.2, 3.4), (-1.1, -0.2, 1.4), (1.3, 0.8, 2.4)]
INSIDE = [(0.3, -0.2, 1.4), (0.5, -0.1, 1.2), (0.3, 0.2, 1.4), (-0.1, 0.1, 1.7)]
BOUNDARY = [(0.3, -0.2, 2.2), (1.1, -0.2, 1.4), (0.3, -0.2 + 0.64, 1.4 - 0.48)]


@pytest.mark.parametrize(("potential", "order"), DERIVATIVES)
def test_equals_quadrature_outside(potential, order):
    found = evaluate(BALL, potential, order, columns(OUTSIDE))
    expected = np.stack([ball_integral(potential, orders(order), point) for point in OUTSIDE], axis=1)
    assert np.all(np.abs(found - expected).max(axis=0) <= 2e-12 * np.abs(expected).max(axis=0))


@pytest.mark.parametrize("where", [INSIDE, OUTSIDE], ids=["inside", "outside"])
@pytest.mark.parametrize(("potential", "order"), RAISED)
def test_each_order_is_the_gradient_of_the_one_below(potential, order, where):
    check_gradient(BALL, potential, order, columns(where), step=4e-3, tolerance=1e-11, floor=1.0)


def test_laplacians():
    points = columns([*OUTSIDE, *INSIDE, *BOUNDARY])
    inside = np.array([0.0] * len(OUTSIDE) + [1.0] * len(INSIDE) + [0.5] * len(BOUNDARY))
    for total in (0, 1, 2, 3):
        for one in orders(total):
            second = [tuple(n + 2 * (i == axis) for i, n in enumerate(one)) for axis in range(3)]
            if total < 3:
                expected = -4 * np.pi * inside * (total == 0)
                np.testing.assert_allclose(BALL.phi(second, *points).sum(axis=0), expected, rtol=0, atol=2e-12)
            if total:
                expected = 2 * BALL.phi([one], *points)[0]
                np.testing.assert_allclose(BALL.psi(second, *points).sum(axis=0), expected, rtol=0, atol=2e-12)


@pytest.mark.parametrize("order", [1, 2])
def test_chi_is_harmonic_with_phi_as_its_second_derivative_along_z(order):
    x, y, z = columns([*OUTSIDE, *INSIDE])
    for one in [one for one in orders(order) if one[2] <= 1]:
        second = [tuple(n + 2 * (i == axis) for i, n in enumerate(one)) for axis in range(3)]
        found = BALL.chi(second, x, y, z)
        expected = BALL.phi([one], x, y, -z)[0] * (-1) ** one[2]
        np.testing.assert_allclose(found[2], expected, rtol=0, atol=1e-14)
        np.testing.assert_allclose(found.sum(axis=0), 0.0, atol=1e-13)


def test_values_inside():
    """Psi,ijkl = -8π/15 (three pairs of deltas), Phi,ij = -4π/3 delta; the potentials of Eshelby's tensor."""
    points = columns(INSIDE)
    asked = [(4, 0, 0), (0, 0, 4), (2, 2, 0), (0, 2, 2), (3, 1, 0), (2, 1, 1)]
    expected = -8 * np.pi / 15 * np.array([3, 3, 1, 1, 0, 0])
    np.testing.assert_allclose(BALL.psi(asked, *points), np.tile(expected[:, None], len(INSIDE)), rtol=1e-15)
    assert not BALL.psi(orders(5), *points).any()
    assert not BALL.phi(orders(3) + orders(4), *points).any()


@pytest.mark.parametrize(("potential", "order"), [("phi", 2), ("phi", 3), ("psi", 4), ("psi", 5)])
def test_mean_of_both_sides_on_the_boundary(potential, order):
    on = np.array(BOUNDARY)
    normal = (on - np.array(CENTER)) / RADIUS
    at, inner, outer = (evaluate(BALL, potential, order, columns(on + s * 1e-9 * normal)) for s in (0, -1, 1))
    np.testing.assert_allclose(at, (inner + outer) / 2, rtol=0, atol=1e-6)


def test_touching_point_has_the_limit_along_the_surface():
    """Neighbours on the surface are outside, so a surface stress stays continuous there."""
    o, zeros = np.zeros(2), np.array([0.0, -0.0])
    found = TANGENT.phi([(0, 0, 2), (2, 0, 0)], o, o, zeros)
    np.testing.assert_allclose(found, 4 * np.pi / 3 * np.array([[2, 2], [-1, -1]]), rtol=1e-14)


@pytest.mark.parametrize("potential", ["phi", "psi", "chi"])
def test_finite_and_silent_everywhere(potential):
    x, y, z = (t.ravel() for t in np.meshgrid(*[np.array([-1e8, -1.0, -1e-14, -0.0, 0.0, 1.0, 2.0, 1e8])] * 3))
    for _, order in [case for case in DERIVATIVES if case[0] == potential]:
        for shape in (TANGENT, BALL):
            assert np.all(
                np.isfinite(evaluate(shape, potential, order, (x, y, np.abs(z) if potential == "chi" else z)))
            )


@pytest.mark.parametrize("distance", [1.0, 10.0, 1e5])
def test_far_field_is_the_closed_form(distance):
    far = BALL.far_field()
    assert far.volumes.sum() == close(4 * np.pi / 3 * RADIUS**3, rel=1e-15)
    assert far.distance == close(RADIUS, rel=1e-11)
    point = np.array(CENTER) + distance * np.array([0.48, -0.6, 0.64])
    offsets = tuple(point - far.positions[0])
    for order in (3, 4, 5):
        sources = [
            far.volumes[0] * (kernel("psi", one, offsets) + far.spreads[0] * kernel("phi", one, offsets))
            for one in orders(order)
        ]
        found = evaluate(BALL, "psi", order, columns([point]))[:, 0]
        np.testing.assert_allclose(found, sources, rtol=0, atol=1e-14 * np.abs(found).max())


@pytest.mark.parametrize("factor", [1e-9, 1e3])
@pytest.mark.parametrize(("potential", "order"), DERIVATIVES)
def test_scaling_of_all_lengths(factor, potential, order):
    scaled = SphericalInclusion(center=tuple(factor * c for c in CENTER), radius=factor * RADIUS)
    check_scaling(BALL, scaled, factor, potential, order, columns([*OUTSIDE, *INSIDE]))


@settings(max_examples=40, deadline=None)
@given(st.tuples(*[st.floats(-3, 3)] * 3), st.sampled_from(DERIVATIVES), st.permutations(range(3)))
def test_parity_and_permutation(offset, derivative, axes):
    potential, order = derivative
    shape = SphericalInclusion(center=(0.0, 0.0, 0.0 if potential != "chi" else 1.0), radius=1.0)
    signs = np.array((-1, 1, 1) if potential == "chi" else (-1, 1, -1))
    offset = np.array(offset) if potential != "chi" else np.abs(offset)
    if potential == "chi":
        axes = (1, 0, 2) if axes[0] > axes[1] else (0, 1, 2)
    found = evaluate(shape, potential, order, columns([offset]))
    reflected = evaluate(shape, potential, order, columns([offset * signs]))
    swapped = evaluate(shape, potential, order, columns([offset[list(axes)]]))
    for row, one in enumerate(orders(order)):
        parity = np.prod(signs ** np.array(one))
        np.testing.assert_allclose(reflected[row], parity * found[row], rtol=0, atol=1e-13)
        other = orders(order).index(tuple(one[axis] for axis in axes))
        np.testing.assert_allclose(swapped[other], found[row], rtol=0, atol=2e-12)


def test_abilities_shapes_and_purity():
    for ability in (HasPotentials, HasMirrorPotential, HasFarField):
        assert isinstance(BALL, ability)
    check_forms(BALL)
    np.testing.assert_allclose(BALL.bounds, [(-0.5, -1.0, 0.6), (1.1, 0.6, 2.2)], rtol=1e-14)
    assert BALL.contains(np.array([1.1, 1.11]), -0.2, 1.4).tolist() == [True, False]


@pytest.mark.parametrize(
    ("center", "radius", "message"),
    [
        ((0, 0, 1), 0.0, r"sphere.radius must be positive and finite \[m\] \(got 0.0\)"),
        ((0, 0, 1), float("nan"), "sphere.radius must be positive and finite"),
        ((0, 0, 1), float("inf"), "sphere.radius must be positive and finite"),
        ((0, float("nan"), 1), 1.0, "sphere.center must be three finite lengths"),
        ((0, 1), 1.0, "sphere.center must be three finite lengths"),
    ],
)
def test_refusals(center, radius, message):
    with pytest.raises(SceneError, match=message):
        SphericalInclusion(center=center, radius=radius)
