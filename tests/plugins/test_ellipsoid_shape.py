"""Ellipsoid as an inclusion: potentials against closed forms, quadrature and each other; orientation; refusals."""

import numpy as np
import pytest
from scipy.special import elliprd, elliprf

import eigencontact
from close import close
from eigencontact.core.jets import monomials
from eigencontact.plugin import (
    HasFarField,
    HasMirrorPotential,
    HasPotentials,
    SceneError,
    derivatives_of,
    integrated_chi,
)
from eigencontact_plugins.shapes.ellipsoid import Ellipsoid
from eigencontact_plugins.shapes.ellipsoid_mirror import chi_degrees, focal_chi
from eigencontact_plugins.shapes.ellipsoid_potentials import ellipsoidal_level

CENTER = (0.1, -0.2, 2.3)
TURN = (0.3, -0.8, 1.9)
SHAPES = {
    "triaxial": (1.5, 1.0, 0.7),
    "prolate": (0.4, 0.4, 1.3),
    "oblate": (1.2, 0.5, 1.2),
    "disc": (1.0, 1.0, 1e-3),
    "needle": (1e-3, 1e-3, 1.0),
    "blade": (1.0, 0.03, 1e-3),
    "nearly a sphere": (1.0, 1.0 + 1e-8, 1.0 - 1e-8),
}
every_shape = pytest.mark.parametrize("semi_axes", SHAPES.values(), ids=SHAPES)
POTENTIALS = [("phi", n) for n in range(5)] + [("psi", n) for n in range(1, 6)]
every_potential = pytest.mark.parametrize(("potential", "order"), POTENTIALS)


def orders_of(total):
    return [orders for orders in monomials(total) if sum(orders) == total]


def radius(x, y, z):
    return np.sqrt(x * x + y * y + z * z)


def point_potential(potential):
    return radius if potential == "psi" else lambda x, y, z: radius(x, y, z) ** -1


def directions(count, seed=3):
    d = np.random.default_rng(seed).normal(size=(3, count))
    return d / np.linalg.norm(d, axis=0)


def worst(got, expected):
    return np.abs(got - expected).max() / np.abs(expected).max()


def ball_rule(n):
    """Points and weights of the unit ball, exact to degree 2n - 2."""
    nodes, weights = np.polynomial.legendre.leggauss(n)
    r, wr, turn = 0.5 * (nodes + 1), 0.5 * weights, np.pi * np.arange(2 * n) / n
    r, c, t = np.meshgrid(r, nodes, turn, indexing="ij")
    s = np.sqrt(1 - c * c)
    w = (wr[:, None, None] * r * r) * weights[None, :, None] * (np.pi / n)
    return np.stack([r * s * np.cos(t), r * s * np.sin(t), r * c]).reshape(3, -1), w.ravel()


# potentials ---------------------------------------------------------------------------------------------------------


@every_potential
def test_equal_axes_are_a_sphere(potential, order):
    a, p = 1.3, np.array(CENTER)[:, None] + directions(60) * np.linspace(0.05, 4, 60)
    sphere = Ellipsoid(center=CENTER, semi_axes=(a, a, a))
    r = np.linalg.norm(p - np.array(CENTER)[:, None], axis=0)
    orders = orders_of(order)

    def outer(x, y, z):
        volume, R = 4 / 3 * np.pi * a**3, radius(x - CENTER[0], y - CENTER[1], z - CENTER[2])
        return volume * (R + a * a / 5 * R**-1) if potential == "psi" else volume * R**-1

    def inner(x, y, z):
        square = (x - CENTER[0]) ** 2 + (y - CENTER[1]) ** 2 + (z - CENTER[2]) ** 2
        phi = 2 * np.pi * (a * a - square * (1 / 3))
        return phi if potential == "phi" else np.pi * (a**4 + square * (2 * a * a / 3) - square * square * (1 / 15))

    expected = np.where(r > a, derivatives_of(outer, orders, *p), derivatives_of(inner, orders, *p))
    assert worst(getattr(sphere, potential)(orders, *p), expected) < 2e-14


@every_shape
@every_potential
def test_outside_the_potentials_equal_quadrature_over_the_volume(semi_axes, potential, order):
    shape = Ellipsoid(center=CENTER, semi_axes=semi_axes, rotation=TURN)
    nodes, weights = ball_rule(14)
    sources = shape.axes @ (np.array(semi_axes)[:, None] * nodes)
    offset = directions(6) * 3.6 * max(semi_axes)  # where the rule itself holds 1e-13
    got = getattr(shape, potential)(orders_of(order), *(np.array(CENTER)[:, None] + offset))
    parts = derivatives_of(point_potential(potential), orders_of(order), *(offset[:, :, None] - sources[:, None, :]))
    assert worst(got, (parts * weights).sum(axis=-1) * np.prod(semi_axes)) < 1e-12


@pytest.mark.parametrize("semi_axes", [s for n, s in SHAPES.items() if n != "nearly a sphere"])
def test_integrals_inside_are_those_of_carlson(semi_axes):
    """I_i = (4π/3) abc R_D and J_ij = (a_i² I_i - a_j² I_j)/(a_i² - a_j²) for different axes (Mura 1987, 11.12)."""
    square = np.array(semi_axes) ** 2
    others = [np.delete(square, i) for i in range(3)]
    single = np.array([4 / 3 * np.pi * np.prod(semi_axes) * elliprd(*others[i], square[i]) for i in range(3)])
    shape = Ellipsoid(center=(0, 0, 0), semi_axes=semi_axes)
    inside = 0.4 * directions(4) * np.array(semi_axes)[:, None]
    got = shape.phi([(2, 0, 0), (0, 2, 0), (0, 0, 2)], *inside)
    assert got == close(-np.tile(single[:, None], 4), rel=2e-13)
    assert single.sum() == close(4 * np.pi, rel=1e-12)
    whole = 2 * np.pi * np.prod(semi_axes) * 2 * elliprf(*square)
    value = 0.5 * (whole - (single[:, None] * inside**2).sum(axis=0))
    assert shape.phi([(0, 0, 0)], *inside)[0] == close(value, rel=1e-13)
    mixed = {(0, 1): (2, 2, 0), (0, 2): (2, 0, 2), (1, 2): (0, 2, 2)}
    for (i, j), orders in mixed.items():
        if semi_axes[i] != semi_axes[j]:
            expected = -(square[i] * single[i] - square[j] * single[j]) / (square[i] - square[j])
            assert shape.psi([orders], *inside)[0] == close(np.full(4, expected), rel=1e-12)


@every_shape
@pytest.mark.parametrize("level", [1e-9, 1e-6, 1e-3, 1.0, 1e4])
def test_outside_close_by_and_far_the_field_is_that_of_the_confocal_ellipsoid(semi_axes, level):
    """Points with a known λ: Φ,i by Carlson; Φ,12 and Ψ,123 elementary."""
    square = np.array(semi_axes) ** 2
    n = directions(8, seed=9)
    A = square + level
    x = np.sqrt(A)[:, None] * n
    abc = np.prod(semi_axes)
    single = np.array([4 / 3 * np.pi * abc * elliprd(*np.delete(A, i), A[i]) for i in range(3)])
    shape = Ellipsoid(center=(0, 0, 0), semi_axes=semi_axes)
    # the value of λ follows from rounded coordinates: no better than their last digit times a slope
    slack = 4e-16 * (1 + max(semi_axes) ** 2 / (min(semi_axes) ** 2 + level))
    assert worst(ellipsoidal_level(np.array(semi_axes), tuple(x)), min(semi_axes) ** 2 + level) < 1e-15 + 2 * slack
    first = np.stack(shape.phi([(1, 0, 0), (0, 1, 0), (0, 0, 1)], *x))
    assert worst(first, -single[:, None] * x) < 1e-13 + 4 * slack
    y = x / A[:, None]
    h, g = (y * y).sum(axis=0), 2 * np.pi * abc / np.sqrt(A.prod())
    assert worst(shape.phi([(1, 1, 0)], *x)[0], 2 * g * y[0] * y[1] / h) < 1e-13 + 20 * slack
    size = np.abs(shape.psi(orders_of(3), *x)).max(axis=0)
    error = np.abs(shape.psi([(1, 1, 1)], *x)[0] - 2 * g * level * y[0] * y[1] * y[2] / h)
    assert np.all(error < (1e-13 + 20 * slack) * size)


# semi-axes, point near the boundary, derivative, its value: Φ,i = -x_i I_i(λ) and Ψ,ij = -x_i x_j J_ij(λ) of different
# axes differentiated further by numerical differences of 60 digits
REFERENCE = [
    ((1.0, 0.9, 0.001), (0.480048, -0.3240324, 0.0008000800000000001), "phi", (0, 0, 4), 0.000625221905545353),
    ((1.0, 0.9, 0.001), (0.480048, -0.3240324, 0.0008000800000000001), "psi", (0, 1, 4), 0.00020535546427264447),
    ((1.0, 0.9, 0.001), (0.480048, -0.3240324, 0.0008000800000000001), "psi", (2, 2, 0), -0.002592760541981097),
    ((1.0, 0.9, 0.001), (0.78, 0.5616000000000001, -8.32e-4), "phi", (0, 0, 3), 50.09343352457033),
    ((1.0, 0.9, 0.001), (0.78, 0.5616000000000001, -8.32e-4), "psi", (1, 1, 3), -7.463373021658017),
    ((1.0, 0.9, 0.001), (0.78, 0.5616000000000001, -8.32e-4), "psi", (4, 1, 0), 17.417190928385835),
    ((1.0, 0.9, 0.001), (1.0496, 0.1418, 0.0501734), "phi", (1, 1, 2), 0.07703956215995884),
    ((1.0, 0.9, 0.001), (1.0496, 0.1418, 0.0501734), "psi", (1, 0, 3), 0.022292105842977313),
    ((0.001, 0.0012, 1.0), (7.8e-4, 7.488e-4, -0.832), "phi", (0, 4, 0), -9238752.507708963),
    ((0.001, 0.0012, 1.0), (7.8e-4, 7.488e-4, -0.832), "psi", (2, 2, 1), -0.11450871516674455),
    ((0.001, 0.0012, 1.0), (7.8e-4, 7.488e-4, -0.832), "psi", (1, 1, 1), -4.225176792431994e-06),
    ((1.0, 0.03, 0.001), (0.78, 0.01872, -8.32e-4), "phi", (2, 1, 0), 0.9659985675047841),
    ((1.0, 0.03, 0.001), (0.78, 0.01872, -8.32e-4), "psi", (0, 1, 4), -951.1845397510696),
    ((1.0, 0.03, 0.001), (1.0496, 0.05306, 0.0501734), "phi", (0, 0, 4), -0.0555806595386871),
    ((1.0, 0.03, 0.001), (1.0496, 0.05306, 0.0501734), "psi", (4, 1, 0), -0.0015994743364089155),
    ((1.5, 1.0, 0.7), (0.720072, -0.36003599999999997, 0.560056), "phi", (1, 1, 2), -3.7011588638617843),
    ((1.5, 1.0, 0.7), (0.720072, -0.36003599999999997, 0.560056), "psi", (2, 2, 0), -0.96459043750701),
    ((1.5, 1.0, 0.7), (1.5494, 0.15200000000000002, 0.17138), "phi", (0, 4, 0), 20.64710684559433),
    ((1.5, 1.0, 0.7), (1.5494, 0.15200000000000002, 0.17138), "psi", (1, 1, 3), -1.1909559491592194),
]  # fmt: skip


@pytest.mark.parametrize(("semi_axes", "point", "potential", "orders", "expected"), REFERENCE)
def test_close_to_discs_and_needles_high_orders_keep_their_digits(semi_axes, point, potential, orders, expected):
    """Directly differentiated, λ would cost a factor 1000 for each order along the thickness of the disc."""
    shape = Ellipsoid(center=(0, 0, 0), semi_axes=semi_axes)
    size = np.abs(getattr(shape, potential)(orders_of(sum(orders)), *np.array(point)[:, None])).max()
    got = getattr(shape, potential)([orders], *np.array(point)[:, None])[0, 0]
    assert abs(got - expected) < 1e-13 * size


@every_shape
@pytest.mark.parametrize("scale", [0.9, 1.0 + 1e-9, 1.1, 1e5])
def test_laplacians(semi_axes, scale):
    """∇²Φ = -4π inside, 0 outside; ∇²Ψ = 2Φ; differentiated up to the orders that stress needs.

    In scene axes: the outer derivatives rest on these relations in the ellipsoid's own.
    """
    shape = Ellipsoid(center=CENTER, semi_axes=semi_axes, rotation=TURN)
    p = np.array(CENTER)[:, None] + shape.axes @ (scale * np.array(semi_axes)[:, None] * directions(20, seed=5))

    def laplacian(potential, lower):
        raised = [tuple(n + 2 * (a == axis) for a, n in enumerate(lower)) for axis in range(3)]
        parts = getattr(shape, potential)(raised, *p)
        whole = np.abs(getattr(shape, potential)(orders_of(sum(lower) + 2), *p)).max(axis=0)
        return parts.sum(axis=0), whole

    trace, size = laplacian("phi", (0, 0, 0))
    assert np.abs(trace + (4 * np.pi if scale < 1 else 0)).max() < 1e-12 * size.max()
    for lower in ((1, 0, 0), (0, 1, 1), (0, 0, 2)):
        trace, size = laplacian("phi", lower)
        assert np.all(np.abs(trace) <= 1e-11 * size)
        trace, size = laplacian("psi", lower)
        assert np.all(np.abs(trace - 2 * shape.phi([lower], *p)[0]) <= 1e-11 * (size + np.abs(trace)))
    trace, size = laplacian("psi", (1, 1, 1))
    assert np.all(np.abs(trace - 2 * shape.phi([(1, 1, 1)], *p)[0]) <= 1e-11 * size)


@every_potential
def test_nearly_equal_axes_pass_smoothly_through_equal_ones(potential, order):
    """What two axes that differ by 1e-8 add to the sphere is the slope taken from differences of 1e-3, four points."""
    p = np.concatenate([0.6 * directions(5), 1.4 * directions(5, seed=8), 40 * directions(5)], axis=1)

    def values(e):
        shape = Ellipsoid(center=(0, 0, 0), semi_axes=(1, 1 + e, 1 - 2 * e))
        return getattr(shape, potential)(orders_of(order), *p)

    h = 1e-3
    slope = (8 * (values(h) - values(-h)) - (values(2 * h) - values(-2 * h))) / (12 * h)
    for e in (1e-8, 1e-6, 1e-12):
        size = np.abs(values(0)).max(axis=0) + np.abs(slope).max(axis=0)
        error = np.abs(values(e) - values(0) - e * slope).max(axis=0)
        assert np.all(error <= (1e-13 + 40 * e * e) * size)


@pytest.mark.parametrize("ratio", [0.01, 0.5, 0.999, 1.001, 2.0, 50.0])
def test_eshelby_tensor_of_a_spheroid(ratio):
    """Axis 3 is that of revolution; Eshelby's tensor in closed form as in Tandon & Weng 1984, appendix."""
    nu, t = 0.3, ratio
    if t > 1:
        g = t / (t * t - 1) ** 1.5 * (t * np.sqrt(t * t - 1) - np.arccosh(t))
    else:
        g = t / (1 - t * t) ** 1.5 * (np.arccos(t) - t * np.sqrt(1 - t * t))
    q = t * t - 1
    expected = {
        "3333": (1 - 2 * nu + (3 * t * t - 1) / q - (1 - 2 * nu + 3 * t * t / q) * g) / (2 * (1 - nu)),
        "1111": 3 / (8 * (1 - nu)) * t * t / q + (1 - 2 * nu - 9 / (4 * q)) * g / (4 * (1 - nu)),
        "1122": (t * t / (2 * q) - (1 - 2 * nu + 3 / (4 * q)) * g) / (4 * (1 - nu)),
        "1133": -t * t / q / (2 * (1 - nu)) + (3 * t * t / q - (1 - 2 * nu)) * g / (4 * (1 - nu)),
        "3311": -(1 - 2 * nu + 1 / q) / (2 * (1 - nu)) + (1 - 2 * nu + 3 / (2 * q)) * g / (2 * (1 - nu)),
        "1212": (t * t / (2 * q) + (1 - 2 * nu - 3 / (4 * q)) * g) / (4 * (1 - nu)),
        "1313": (1 - 2 * nu - (t * t + 1) / q - 0.5 * (1 - 2 * nu - 3 * (t * t + 1) / q) * g) / (4 * (1 - nu)),
    }
    shape = Ellipsoid(center=(0, 0, 0), semi_axes=(1.0, 1.0, t))
    delta, inside = np.eye(3), 0.1 * min(1, t) * np.ones((3, 1))

    def value(potential, *axes):
        orders = tuple(axes.count(a) for a in range(3))
        return getattr(shape, potential)([orders], *inside)[0, 0]

    def eshelby(i, j, k, l):
        """Mura 1987, eq. 11.34."""
        pairs = ((k, j, l, i), (k, i, l, j), (l, j, k, i), (l, i, k, j))
        sheared = sum(delta[a, b] * value("phi", c, d) for a, b, c, d in pairs)
        whole = value("psi", i, j, k, l) - 2 * nu * delta[k, l] * value("phi", i, j) - (1 - nu) * sheared
        return whole / (8 * np.pi * (1 - nu))

    cancelled = 1e-13 / min(1, abs(q)) ** 2  # the closed forms lose digits near the sphere, ours do not
    for name, wanted in expected.items():
        got = eshelby(*(int(digit) - 1 for digit in name))
        assert got == close(wanted, rel=cancelled, abs=cancelled)


@every_shape
@pytest.mark.parametrize(
    ("potential", "order"), [("phi", 2), ("phi", 4), ("psi", 3), pytest.param("psi", 5, marks=pytest.mark.slow)]
)
def test_far_field(semi_axes, potential, order):
    shape = Ellipsoid(center=CENTER, semi_axes=semi_axes, rotation=TURN)
    levels = shape.far_field().levels
    assert [far.distance for far in levels] == sorted((far.distance for far in levels), reverse=True)
    assert [far.volumes.size for far in levels] == sorted(far.volumes.size for far in levels)
    for far in levels:
        assert far.volumes.sum() == close(shape.volume, rel=1e-14)
        for distance in (1.0, 30.0):
            p = far.center[:, None] + np.hstack([directions(10), shape.axes]) * distance * far.distance
            offset = p[:, :, None] - far.positions.T[:, None]
            parts = derivatives_of(point_potential(potential), orders_of(order), *offset) * far.volumes
            if potential == "psi":  # a point with a spread: V (R + k/R)
                extra = derivatives_of(point_potential("phi"), orders_of(order), *offset)
                parts += extra * (far.volumes * far.spreads)
            assert worst(parts.sum(axis=-1), getattr(shape, potential)(orders_of(order), *p)) < 1e-12


# mirror image -------------------------------------------------------------------------------------------------------

CHI = [
    (3, 0, 0),
    (2, 1, 0),
    (0, 3, 0),
    (2, 0, 1),
    (1, 1, 1),
    (4, 0, 0),
    (3, 1, 0),
    (2, 2, 0),
    (0, 4, 0),
    (3, 0, 1),
    (1, 2, 1),
]


@every_shape
@pytest.mark.parametrize("rotation", [None, TURN])
@pytest.mark.parametrize("depth", [1.0, 1.2, 5.0], ids=["touching", "shallow", "deep"])
def test_chi_equals_the_integral_of_phi(semi_axes, rotation, depth):
    """Two ways that share no formula: sources on the focal ellipse, and Phi of the image along a line."""
    top = Ellipsoid(center=(0, 0, 0), semi_axes=semi_axes, rotation=rotation).bounds[1][2]
    shape = Ellipsoid(center=(0.1, -0.2, depth * top), semi_axes=semi_axes, rotation=rotation)
    x, y, z = np.random.default_rng(4).uniform(-2, 2, (3, 30)) * max(semi_axes)
    z = np.where(np.arange(30) < 15, 0.0, np.abs(z))
    got, expected = shape.chi(CHI, x, y, z), integrated_chi(shape, CHI, x, y, z)
    for order in (3, 4):
        rows = [row for row, n in enumerate(CHI) if sum(n) == order]
        size = np.abs(expected[rows]).max(axis=0)
        assert np.all(np.abs(got[rows] - expected[rows]).max(axis=0) < 2e-11 * size)  # the integral's own error
    own = tuple(shape.axes.T @ np.stack([x - 0.1, y + 0.2, -z - shape.center[2]]))
    across, around = chi_degrees(np.array(semi_axes), own)
    finer = (int(across.max() * 1.5), int(around.max() * 1.5))
    if max(finer) < 300 and np.all(around > 0):  # where all points have a cubature, a finer one adds nothing
        again = focal_chi(np.array(semi_axes), shape.axes, CHI, (x - 0.1, y + 0.2, z + shape.center[2]), finer)
        assert worst(got, again) < 1e-12


def test_chi_needs_few_nodes_where_the_image_is_far():
    shape = Ellipsoid(center=(0.1, -0.2, 3.0), semi_axes=(1.5, 1.0, 0.7))
    x, y = np.linspace(-3, 3, 40), np.linspace(2, -2, 40)
    own = (x - 0.1, y + 0.2, np.full(40, -3.0))
    across, around = chi_degrees(np.array(shape.semi_axes), own)
    assert np.all(around > 0)
    assert np.all((across // 4 + 1) * (around + 1) < 500)


# boundary -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("potential", "order"), [("phi", 1), ("phi", 2), ("psi", 4), ("psi", 5)])
def test_on_the_boundary_the_mean_of_both_sides(potential, order):
    shape = Ellipsoid(center=(0, 0, 2), semi_axes=(1.5, 1.0, 0.5))
    poles = np.array([[1.5, 0, 2], [0, -1.0, 2], [0, 0, 2.5], [0.9, 0, 2.4]]).T
    near = [np.array([0, 0, 2])[:, None] + (poles - [[0], [0], [2]]) * (1 + s * 1e-9) for s in (-1, 1)]
    inner, outer = (getattr(shape, potential)(orders_of(order), *p) for p in near)
    got = getattr(shape, potential)(orders_of(order), *poles)
    assert worst(got, 0.5 * (inner + outer)) < 1e-7
    if order >= 2:
        assert worst(inner, outer) > 0.1  # the jump is there


def test_a_touching_ellipsoid_has_the_limit_along_the_surface():
    """Neighbours on the surface are outside, so a surface stress stays continuous there."""
    shape = Ellipsoid(center=(0.3, 0, 0.5), semi_axes=(1.5, 1.0, 0.5))
    trace = [shape.phi(orders_of(2), np.array([0.3]), np.array([0.0]), np.array([z])) for z in (0.0, -0.0)]
    laplacians = [values[[0, 3, 5], 0].sum() for values in trace]
    assert laplacians == close([0.0, 0.0], abs=1e-12)


# orientation --------------------------------------------------------------------------------------------------------


def test_columns_of_the_matrix_are_the_directions_of_the_axes():
    turn = np.array([[0, 0, 1], [1, 0, 0], [0, 1, 0.0]])  # first axis along y, second along z, third along x
    turned = Ellipsoid(center=CENTER, semi_axes=(3, 2, 1), rotation=turn)
    straight = Ellipsoid(center=CENTER, semi_axes=(1, 3, 2))
    p = np.array(CENTER)[:, None] + directions(30) * np.linspace(0.1, 5, 30)
    np.testing.assert_allclose(turned.bounds, straight.bounds, rtol=1e-15)
    for potential, order in POTENTIALS:
        got = getattr(turned, potential)(orders_of(order), *p)
        assert worst(got, getattr(straight, potential)(orders_of(order), *p)) < 1e-14


def test_angles_are_yaw_pitch_and_roll():
    yaw, pitch, roll = TURN
    c, s = np.cos, np.sin
    first = [c(yaw) * c(pitch), s(yaw) * c(pitch), -s(pitch)]
    third = [
        c(yaw) * s(pitch) * c(roll) + s(yaw) * s(roll),
        s(yaw) * s(pitch) * c(roll) - c(yaw) * s(roll),
        c(pitch) * c(roll),
    ]
    axes = Ellipsoid(center=CENTER, semi_axes=(3, 2, 1), rotation=TURN).axes
    assert np.allclose(axes[:, 0], first, atol=1e-15)
    assert np.allclose(axes[:, 2], third, atol=1e-15)
    assert np.allclose(axes[:, 1], np.cross(third, first), atol=1e-15)


def test_turned_derivatives_are_those_of_a_tensor():
    """Ψ,ijkl of the turned ellipsoid at turned points is the turned tensor."""
    semi_axes = (1.5, 1.0, 0.7)
    straight = Ellipsoid(center=(0, 0, 0), semi_axes=semi_axes)
    turned = Ellipsoid(center=(0, 0, 0), semi_axes=semi_axes, rotation=TURN)
    p = directions(12) * np.linspace(0.2, 3, 12)
    indices = np.moveaxis(np.indices((3,) * 4), 0, -1).reshape(-1, 4)
    orders = [tuple(int(n) for n in np.bincount(index, minlength=3)) for index in indices]
    tensor = straight.psi(orders, *p).reshape(3, 3, 3, 3, -1)
    R = turned.axes
    expected = np.einsum("ia,jb,kc,ld,abcdn->ijkln", R, R, R, R, tensor)
    assert worst(turned.psi(orders, *(R @ p)).reshape(expected.shape), expected) < 1e-14


# the region ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("rotation", [None, TURN])
def test_contains_fills_the_volume_within_the_bounds(rotation):
    shape = Ellipsoid(center=CENTER, semi_axes=(1.5, 1.0, 0.7), rotation=rotation)
    low, high = (np.array(corner) for corner in shape.bounds)
    axes = [np.linspace(a, b, 121)[:-1] + (b - a) / 240 for a, b in zip(low, high, strict=True)]
    inside = shape.contains(axes[0][:, None, None], axes[1][:, None], axes[2])
    assert inside.shape == (120, 120, 120)
    assert inside.mean() * np.prod(high - low) == close(shape.volume, rel=1e-3)
    for axis in range(3):  # the outermost layers are hit: the bounds are tight
        layers = inside.any(axis=tuple({0, 1, 2} - {axis}))
        assert layers[[1, -2]].all()


def test_points_of_any_shape_and_their_purity():
    shape = Ellipsoid(center=CENTER, semi_axes=(1.5, 1.0, 0.7), rotation=TURN)
    x, y, z = np.meshgrid(np.linspace(-2, 2, 3), np.linspace(-2, 2, 2), np.linspace(0, 4, 2), indexing="ij")
    for t in (x, y, z):
        t.flags.writeable = False
    whole = shape.psi([(2, 1, 1), (4, 0, 0)], x, y, z)
    assert whole.shape == (2, 3, 2, 2)
    single = shape.psi([(2, 1, 1), (4, 0, 0)], x[1, 1, 0], y[1, 1, 0], z[1, 1, 0])
    assert whole[:, 1, 1, 0] == close(single, rel=1e-14)
    assert shape.phi([(1, 0, 0)], *np.empty((3, 0))).shape == (1, 0)


@pytest.mark.parametrize("unit", [1e-9, 1e-6, 1e3])
def test_lengths_scale(unit):
    p = directions(10) * np.linspace(0.2, 3, 10)
    one = Ellipsoid(center=(0, 0, 0), semi_axes=(1.5, 1.0, 0.7), rotation=TURN)
    other = Ellipsoid(center=(0, 0, 0), semi_axes=(1.5 * unit, unit, 0.7 * unit), rotation=TURN)
    for potential, order in POTENTIALS:
        power = (2 if potential == "phi" else 4) - order
        got = getattr(other, potential)(orders_of(order), *(unit * p)) * unit**-power
        assert worst(got, getattr(one, potential)(orders_of(order), *p)) < 1e-13


def test_abilities():
    shape = Ellipsoid(center=CENTER, semi_axes=(1, 2, 3))
    assert isinstance(shape, HasPotentials)
    assert isinstance(shape, HasFarField)
    assert isinstance(shape, HasMirrorPotential)
    assert shape.references


def test_made_from_arrays_text_and_angles():
    made = eigencontact.make(
        "ellipsoid", center=np.array(CENTER), semi_axes=["3 um", "2 um", 1e-6], rotation=["30 deg", 0, "0.1 rad"]
    )
    assert made == Ellipsoid(center=CENTER, semi_axes=(3e-6, 2e-6, 1e-6), rotation=(np.pi / 6, 0, 0.1))
    assert len({made, Ellipsoid(center=CENTER, semi_axes=(3e-6, 2e-6, 1e-6), rotation=(np.pi / 6, 0, 0.1))}) == 1
    matrix = eigencontact.make("ellipsoid", center=CENTER, semi_axes=(3, 2, 1), rotation=made.axes)
    assert np.allclose(matrix.axes, made.axes, atol=1e-15)
    listed = eigencontact.make("ellipsoid", center=CENTER, semi_axes=(3, 2, 1), rotation=made.axes.tolist())
    assert listed == matrix


REFUSED = [
    ({"center": (0, 0)}, r"ellipsoid.center must be three finite lengths \(x, y, z\) \[m\] \(got \(0, 0\)\)"),
    ({"center": (0, 0, np.nan)}, r"center must be three finite"),
    ({"semi_axes": (1, 0, 1)}, r"semi_axes must be three positive, finite lengths \[m\] \(got \(1, 0, 1\)\)"),
    ({"semi_axes": (1, np.inf, 1)}, r"semi_axes must be three positive"),
    ({"semi_axes": (1, 1)}, r"semi_axes must be three positive"),
    ({"rotation": (1, 2)}, r"rotation must be a rotation matrix .*or three finite angles yaw, pitch, roll \[rad\]"),
    ({"rotation": np.eye(3) * 1.001}, r"orthogonal to 1e-9"),
    ({"rotation": np.diag([1, 1, -1])}, r"determinant \+1"),
    ({"rotation": "30 deg"}, r"rotation must be a rotation matrix"),
]


@pytest.mark.parametrize(("change", "message"), REFUSED)
def test_refusals(change, message):
    with pytest.raises(SceneError, match=message):
        Ellipsoid(**({"center": (0, 0, 2), "semi_axes": (1, 1, 1)} | change))
