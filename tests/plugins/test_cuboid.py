"""The cuboid against quadrature of point potentials that are written out independently."""

from itertools import permutations, product
from types import SimpleNamespace

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from close import close
from eigencontact.plugin import HasCornerPotentials, HasFarField, HasMirrorPotential, HasPotentials, SceneError
from eigencontact_plugins.shapes.cuboid import Cuboid
from point_potentials import integrated, kernel, orders
from shape_potentials import DERIVATIVES, RAISED, check_forms, check_gradient, check_scaling, columns, evaluate

CENTER, EDGES = (0.3, -0.2, 1.1), (1.0, 0.7, 0.5)
BLOCK = Cuboid(center=CENTER, edges=EDGES)
FLUSH = Cuboid(center=(0.0, 0.0, 0.5), edges=(1.0, 1.0, 1.0))


# Outside: anywhere, in line with an axis, a face, an edge and a corner.
OUTSIDE = [
    (1.9, 0.9, 2.6), (-1.2, 0.3, 2.0), (0.3, -0.2, 0.0), (0.8, -0.55, 0.1), (0.8, 1.15, 1.35),
    (0.3, 1.9, 1.1), (-1.4, -1.3, 0.2), (1.8, 0.15, 1.35), (0.8, 1.1, 0.85), (-0.2, 0.15, 2.4),
]  # fmt: skip


def expected_loss(potential, points):
    """Five times the law of the module on sums over corners: 5e-16 d (d + c)² / (abc)."""
    x, y, z = points
    offsets = np.abs([x - CENTER[0], y - CENTER[1], z + CENTER[2] if potential == "chi" else z - CENTER[2]])
    d = np.linalg.norm(np.maximum(offsets - np.array(EDGES)[:, None] / 2, 0), axis=0)
    return np.maximum(2.5e-15 * d * (d + max(EDGES)) ** 2 / np.prod(EDGES), 5e-15)


@pytest.mark.parametrize(("potential", "order"), DERIVATIVES)
def test_equals_quadrature_outside(potential, order):
    points = columns(OUTSIDE)
    found = evaluate(BLOCK, potential, order, points)
    expected = np.stack([integrated(potential, orders(order), CENTER, EDGES, point) for point in OUTSIDE], axis=1)
    error = np.abs(found - expected).max(axis=0) / np.abs(expected).max(axis=0)
    assert np.all(error <= expected_loss(potential, points))


def test_recursion_of_the_tests_equals_differentiation():
    potentials = {
        "psi": lambda x, y, z: mpmath.sqrt(x * x + y * y + z * z),
        "phi": lambda x, y, z: 1 / mpmath.sqrt(x * x + y * y + z * z),
        "chi": lambda x, y, z: (
            z * mpmath.log(mpmath.sqrt(x * x + y * y + z * z) + z) - mpmath.sqrt(x * x + y * y + z * z)
        ),
    }
    with mpmath.workdps(30):
        for potential, order in DERIVATIVES:
            for one in orders(order):
                expected = mpmath.diff(potentials[potential], (0.3, -0.7, 0.4), one)
                assert kernel(potential, one, (0.3, -0.7, 0.4)) == close(float(expected), rel=1e-12, abs=1e-12)


INSIDE = [(0.3, -0.2, 1.1), (0.45, -0.1, 1.2), (0.0, -0.4, 0.95), (0.3, 0.05, 1.25)]


@pytest.mark.parametrize("where", [INSIDE, OUTSIDE], ids=["inside", "outside"])
@pytest.mark.parametrize(("potential", "order"), RAISED)
def test_each_order_is_the_gradient_of_the_one_below(potential, order, where):
    check_gradient(BLOCK, potential, order, columns(where), step=2e-3, tolerance=3e-11)


EVERYWHERE = [
    *OUTSIDE, *INSIDE,
    (0.8, -0.1, 1.0), (0.3, 0.15, 1.2), (0.2, -0.3, 0.85), (0.2, -0.3, 1.35),  # on faces
]  # fmt: skip


def inside_part(points):
    half = np.array(EDGES)[:, None] / 2
    gap = np.abs(np.array(points) - np.array(CENTER)[:, None]) - half
    on_face = np.any(np.abs(gap) < 1e-14, axis=0)
    return np.where(np.any(gap > 1e-14, axis=0), 0.0, np.where(on_face, 0.5, 1.0))


@pytest.mark.parametrize("order", [0, 1, 2])
def test_laplacian_of_phi(order):
    points = columns(EVERYWHERE)
    for one in orders(order):
        second = [tuple(n + 2 * (i == axis) for i, n in enumerate(one)) for axis in range(3)]
        found = BLOCK.phi(second, *points)
        expected = -4 * np.pi * inside_part(points) if order == 0 else 0.0
        np.testing.assert_allclose(found.sum(axis=0), expected, rtol=0, atol=1e-12 * np.abs(found).max())


@pytest.mark.parametrize("order", [1, 2, 3])
def test_laplacian_of_psi_is_twice_phi(order):
    points = columns(EVERYWHERE)
    for one in orders(order):
        second = [tuple(n + 2 * (i == axis) for i, n in enumerate(one)) for axis in range(3)]
        found, expected = BLOCK.psi(second, *points), 2 * BLOCK.phi([one], *points)[0]
        np.testing.assert_allclose(found.sum(axis=0), expected, rtol=0, atol=1e-12 * np.abs(found).max())


@pytest.mark.parametrize("order", [1, 2])
def test_chi_is_harmonic_with_phi_as_its_second_derivative_along_z(order):
    x, y, z = columns(EVERYWHERE)
    for one in [one for one in orders(order) if one[2] <= 1]:
        found = BLOCK.chi([(one[0] + 2, one[1], one[2]), (one[0], one[1] + 2, one[2])], x, y, z)
        expected = BLOCK.phi([one], x, y, -z)[0] * (-1) ** one[2]
        np.testing.assert_allclose(-found.sum(axis=0), expected, rtol=0, atol=1e-12 * np.abs(expected).max())
        third = BLOCK.chi([(one[0], one[1], one[2] + 2)], x, y, z)[0]
        np.testing.assert_allclose(third, expected, rtol=0, atol=1e-14 * np.abs(expected).max())


def test_centre_of_a_cube():
    cube = Cuboid(center=(0.0, 0.0, 5.0), edges=(2.0, 2.0, 2.0))
    middle = (np.zeros(1), np.zeros(1), np.full(1, 5.0))
    assert cube.psi([(2, 2, 0)], *middle)[0, 0] == close(-4 / np.sqrt(3), rel=1e-14)
    np.testing.assert_allclose(cube.phi([(2, 0, 0), (1, 1, 0)], *middle)[:, 0], [-4 * np.pi / 3, 0.0], atol=1e-14)


@pytest.mark.parametrize(("axis", "sign"), [(axis, sign) for axis in range(3) for sign in (-1, 1)])
@pytest.mark.parametrize(("potential", "order"), [("phi", 2), ("psi", 4), ("phi", 3), ("psi", 5)])
def test_mean_of_both_sides_on_a_face(axis, sign, potential, order):
    middle = np.array(CENTER) + np.array([0.11, 0.07, -0.06])
    middle[axis] = CENTER[axis] + sign * EDGES[axis] / 2
    away = np.zeros(3)
    away[axis] = 1e-6
    at, below, above = (
        evaluate(BLOCK, potential, order, columns([point])) for point in (middle, middle - away, middle + away)
    )
    np.testing.assert_allclose(at, (below + above) / 2, rtol=0, atol=1e-9 * np.abs(at).max())


@pytest.mark.parametrize(("potential", "order"), [("phi", 2), ("phi", 3), ("phi", 4), ("psi", 4), ("psi", 5)])
def test_face_in_the_surface_is_seen_from_the_side_that_is_asked_for(potential, order):
    """Whatever the sign of zero; without a side it is the mean of both, as on any other face."""
    x, y = np.array([0.1, -0.3, 0.0, 0.7, 0.5]), np.array([0.2, 0.0, 0.0, 0.1, 0.8])
    found = {}
    for side, zero in ((1.0, 0.0), (1.0, -0.0), (-1.0, 0.0), (-1.0, -0.0)):
        at = getattr(FLUSH, potential)(orders(order), x, y, np.full(5, zero), np.full(5, side))
        near = evaluate(FLUSH, potential, order, (x, y, np.full(5, 1e-10 * side)))
        np.testing.assert_allclose(at, near, rtol=0, atol=2e-7)
        found[side] = at
    mean = evaluate(FLUSH, potential, order, (x, y, np.zeros(5)))
    np.testing.assert_allclose(mean, (found[1.0] + found[-1.0]) / 2, rtol=0, atol=1e-13 * np.abs(mean).max())
    inside, above = (FLUSH.phi([(0, 0, 2)], x, y, 0.0 * x, side)[0] for side in (1.0, -1.0))
    np.testing.assert_allclose(inside - above, [-4 * np.pi] * 3 + [0.0] * 2, atol=1e-13)


def test_a_face_within_rounding_of_the_surface_counts_as_flush():
    shape = Cuboid(center=(0.0, 0.0, 0.5 * (1 + 4e-16)), edges=(1.0, 1.0, 1.0))
    o = np.zeros(2)
    found = shape.phi([(0, 0, 2)], o, o, o, np.array([1.0, -1.0]))[0]
    np.testing.assert_allclose(found[0] - found[1], -4 * np.pi, rtol=1e-13)


@pytest.mark.parametrize("potential", ["phi", "psi", "chi"])
def test_finite_and_silent_on_every_singular_point(potential):
    lattice = np.array([-1e4, -1.0, -0.5, -1e-14, 0.0, 0.5, 0.5 + 1e-16, 1.0, 1e4])
    depths = np.array([-1e4, -1.0, -0.0, 0.0, 0.5, 1.0, 2.0, 1e4])
    x, y, z = (t.ravel() for t in np.meshgrid(lattice, lattice, depths))
    for _, order in [case for case in DERIVATIVES if case[0] == potential]:
        found = evaluate(FLUSH, potential, order, (x, y, np.abs(z) if potential == "chi" else z))
        assert np.all(np.isfinite(found))


def test_logarithm_on_an_edge_is_large_with_the_right_sign():
    """Phi,xy of a cube is minus the logarithm of the distance from the edge x = y = 1/2."""
    near, on = (
        FLUSH.phi([(1, 1, 0)], np.array([0.5 + gap]), np.array([0.5 + gap]), np.array([0.4]))[0, 0]
        for gap in (1e-6, 0.0)
    )
    assert near > 10 < on
    assert on > near


# 1 : 1000, from beside a bar to far beyond its end; pieces as long as the distance make the quadrature exact.
BARS = [((1000.0, 1.0, 1.0), 0), ((1.0, 1000.0, 1.0), 1), ((1.0, 1.0, 1000.0), 2)]


@pytest.mark.parametrize(("edges", "along"), BARS)
@pytest.mark.parametrize(("potential", "order"), DERIVATIVES)
@pytest.mark.parametrize("distance", [25.0, 60.0, 500.0])
def test_bar_of_1_to_1000(edges, along, potential, order, distance):
    center = np.array([0.0, 0.0, edges[2] / 2 + 3.0])
    direction = np.array([0.6, 0.48, 0.64])
    direction[along] = 0.0
    point = center + distance * direction
    point[along] += 300.0
    if potential == "chi":
        point[2] = distance
    pieces = [1, 1, 1]
    pieces[along] = int(np.ceil(3000 / distance))
    counts = [6 if axis != along else 12 for axis in range(3)]
    shape = Cuboid(center=tuple(center), edges=edges)
    chosen = orders(order)
    found = evaluate(shape, potential, order, columns([point]))[:, 0]
    expected = integrated(potential, chosen, center, edges, point, counts, pieces)
    np.testing.assert_allclose(found, expected, rtol=0, atol=3e-11 * np.abs(expected).max())


# Textbook corner functions of derivatives along (i, j, k), for 60 digits.
TEXTBOOK = {
    ("psi", (1, 1, 1)): lambda c: c.R,
    ("psi", (2, 1, 0)): lambda c: c.x * mpmath.log(c.R + c.z),
    ("psi", (2, 1, 1)): lambda c: c.x / c.R,
    ("psi", (2, 2, 0)): lambda c: c.x * c.y / (c.R * (c.R + c.z)),
    ("psi", (2, 2, 1)): lambda c: -c.x * c.y / c.R**3,
    ("psi", (3, 1, 1)): lambda c: 1 / c.R - c.x**2 / c.R**3,
    ("phi", (1, 0, 0)): lambda c: (
        c.y * mpmath.log(c.R + c.z) + c.z * mpmath.log(c.R + c.y) - c.x * mpmath.atan(c.y * c.z / (c.x * c.R))
    ),
    ("phi", (1, 1, 0)): lambda c: mpmath.log(c.R + c.z),
    ("phi", (2, 0, 0)): lambda c: -mpmath.atan(c.y * c.z / (c.x * c.R)),
    ("phi", (1, 1, 1)): lambda c: 1 / c.R,
    ("phi", (2, 1, 0)): lambda c: c.x / (c.R * (c.R + c.z)),
}


def precise(potential, canonical, shape, point):
    """Exact derivatives of all permutations of `canonical`, with the orders."""
    found = {}
    with mpmath.workdps(60):
        offset = [mpmath.mpf(float(p)) - mpmath.mpf(float(c)) for p, c in zip(point, shape.center, strict=True)]
        half = [mpmath.mpf(float(edge)) / 2 for edge in shape.edges]
        for axes in permutations(range(3)):
            order = tuple(canonical[axes.index(axis)] for axis in range(3))
            total = mpmath.mpf(0)
            for signs in product((-1, 1), repeat=3):
                x, y, z = (offset[axis] + signs[axis] * half[axis] for axis in axes)
                corner = SimpleNamespace(x=x, y=y, z=z, R=mpmath.sqrt(x * x + y * y + z * z))
                total += signs[0] * signs[1] * signs[2] * TEXTBOOK[potential, canonical](corner)
            found[order] = float(total)
    return list(found), np.array(list(found.values()))


FAR = [(1.0, 1.0, 1.0), (1.0, 0.2, 0.5), (1000.0, 1.0, 1.0), (1.0, 1.0, 1000.0), (1000.0, 1000.0, 1.0)]
DIRECTIONS = [(1, 0, 0), (0, 0, 1), (0.6, 0, 0.8), (2 / 3, 2 / 3, 1 / 3)]


@pytest.mark.parametrize("edges", FAR)
@pytest.mark.parametrize("factor", [1e3, *(pytest.param(f, marks=pytest.mark.slow) for f in (0.0, 10.0, 1e5))])
def test_far_away(edges, factor):
    """Gauss points of the shape, and the shape itself, against 60 digits, out to 1e5 edges."""
    shape = Cuboid(center=(0.0, 0.0, edges[2]), edges=edges)
    far = shape.far_field()
    reach = max(far.distance, factor * max(edges))
    for direction in DIRECTIONS:
        point = np.array(shape.center) + reach * np.array(direction)
        offsets = tuple((point - far.positions).T)
        scales, errors = {}, {}
        for potential, canonical in TEXTBOOK:
            chosen, exact = precise(potential, canonical, shape, point)
            case = potential, sum(canonical)
            scales[case] = max(scales.get(case, 0.0), np.abs(exact).max())
            sources = [np.sum(far.volumes * kernel(potential, one, offsets)) for one in chosen]
            itself = getattr(shape, potential)(chosen, *columns([point]))[:, 0]
            found = np.abs(sources - exact).max(), np.abs(itself - exact).max()
            errors[case] = np.maximum(errors.get(case, 0.0), found)
        for case, (of_sources, of_itself) in errors.items():
            assert of_sources <= 5e-14 * scales[case]
            assert of_itself <= 1e-10 * scales[case]


@pytest.mark.parametrize("edges", FAR)
def test_far_field_stands_for_the_region(edges):
    shape = Cuboid(center=(0.0, 0.0, edges[2] / 2), edges=edges)
    far = shape.far_field()
    assert far.volumes.sum() == close(np.prod(edges), rel=1e-14)
    assert np.all(shape.contains(*far.positions.T))
    assert far.volumes.size <= 500
    for potential, order in DERIVATIVES:
        point = np.array([0.48, -0.6, 0.64]) * far.distance + (0.0, 0.0, edges[2] / 2)
        if potential == "chi":
            point[2] -= edges[2]
        x, y, z = point
        offsets = x - far.positions[:, 0], y - far.positions[:, 1]
        depth = z + far.positions[:, 2] if potential == "chi" else z - far.positions[:, 2]
        sources = [np.sum(far.volumes * kernel(potential, one, (*offsets, depth))) for one in orders(order)]
        itself = evaluate(shape, potential, order, columns([point]))[:, 0]
        np.testing.assert_allclose(itself, sources, rtol=0, atol=1e-10 * np.abs(sources).max())


@pytest.mark.parametrize("factor", [1e-9, 1e3])
@pytest.mark.parametrize(("potential", "order"), DERIVATIVES)
def test_scaling_of_all_lengths(factor, potential, order):
    scaled = Cuboid(center=tuple(factor * c for c in CENTER), edges=tuple(factor * e for e in EDGES))
    check_scaling(BLOCK, scaled, factor, potential, order, columns(EVERYWHERE))


coordinate = st.floats(-3, 3, allow_subnormal=False)


@settings(max_examples=40, deadline=None)
@given(st.tuples(coordinate, coordinate, coordinate), st.sampled_from(DERIVATIVES), st.permutations(range(3)))
def test_parity_and_permutation(offset, derivative, axes):
    potential, order = derivative
    edges = np.array([1.0, 0.7, 0.5])
    if potential == "chi":  # only x and y are alike
        axes = (1, 0, 2) if axes[0] > axes[1] else (0, 1, 2)
    shape = Cuboid(center=(0.0, 0.0, 2.0), edges=tuple(edges))
    turned = Cuboid(center=(0.0, 0.0, 2.0), edges=tuple(edges[list(axes)]))
    signs = (-1, 1, 1) if potential == "chi" else (-1, 1, -1)
    offset = np.array(offset) if potential != "chi" else np.abs(offset)
    middle = np.array([0.0, 0.0, 0.0 if potential == "chi" else 2.0])
    found = evaluate(shape, potential, order, columns([middle + offset]))
    reflected = evaluate(shape, potential, order, columns([middle + offset * signs]))
    swapped = evaluate(turned, potential, order, columns([middle + offset[list(axes)]]))
    # Points that close to an edge, where derivatives are infinite, see the rounding of 2 + z.
    atol = 1e-12 * max(1.0, np.abs(found).max()) ** 2
    for row, one in enumerate(orders(order)):
        parity = np.prod([sign**n for sign, n in zip(signs, one, strict=True)])
        np.testing.assert_allclose(reflected[row], parity * found[row], rtol=0, atol=atol)
        other = orders(order).index(tuple(one[axis] for axis in axes))
        np.testing.assert_allclose(swapped[other], found[row], rtol=0, atol=atol)


@pytest.mark.parametrize(("potential", "order"), DERIVATIVES)
def test_corner_functions_on_a_lattice_of_nodes(potential, order):
    """What grids do: difference the corner function of a lattice; cells of edge 1 at odd multiples of 1/2."""
    nodes = np.arange(-2, 3) + 0.5
    depths = np.arange(0, 4) + 0.5
    values = BLOCK.corner(potential, orders(order), nodes, nodes[:, None], depths[:, None, None])
    assert values.shape == (len(orders(order)), 4, 5, 5)
    cells = np.diff(np.diff(np.diff(values, axis=1), axis=2), axis=3)
    x, y, z = np.meshgrid(np.arange(-1, 3), np.arange(-1, 3), np.arange(1, 4), indexing="ij")
    cube = Cuboid(center=(0.0, 0.0, 0.5), edges=(1.0, 1.0, 1.0))
    depth = z - 0.5 if potential == "chi" else z + 0.5
    expected = evaluate(cube, potential, order, (x.astype(float), y.astype(float), depth)).transpose(0, 3, 2, 1)
    np.testing.assert_allclose(cells, expected, rtol=0, atol=3e-14 * max(1, np.abs(expected).max()))


def test_abilities_shapes_and_purity():
    for ability in (HasPotentials, HasMirrorPotential, HasFarField, HasCornerPotentials):
        assert isinstance(BLOCK, ability)
    check_forms(BLOCK)
    np.testing.assert_allclose(BLOCK.bounds, [(-0.2, -0.55, 0.85), (0.8, 0.15, 1.35)], rtol=1e-15)
    assert BLOCK.contains(np.array([0.8, 0.81]), -0.2, 1.35).tolist() == [True, False]


@pytest.mark.parametrize(
    ("center", "edges", "message"),
    [
        ((0, 0, 1), (1, 0, 1), r"cuboid.edges must be three positive, finite lengths .*\(got \(1, 0, 1\)\)"),
        ((0, 0, 1), (1, float("nan"), 1), "cuboid.edges must be three positive"),
        ((0, 0, 1), (1, 1, float("inf")), "cuboid.edges must be three positive"),
        ((0, 0, 1), (1, 1), "cuboid.edges must be three positive"),
        ((0, float("nan"), 1), (1, 1, 1), "cuboid.center must be three finite"),
    ],
)
def test_refusals(center, edges, message):
    with pytest.raises(SceneError, match=message):
        Cuboid(center=center, edges=edges)
