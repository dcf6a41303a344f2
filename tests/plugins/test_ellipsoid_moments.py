"""Polynomial densities over an ellipsoid: potentials against quadrature, the sphere, turned and scaled bodies."""

import numpy as np
import pytest

from close import close
from eigencontact.core.jets import monomials
from eigencontact.halfspace.moments import moment_field
from eigencontact.plugin import HasMomentIntegrals, HasMomentPotentials, HasMomentSums, derivatives_of
from eigencontact_plugins.shapes.ellipsoid import Ellipsoid
from eigencontact_plugins.shapes.ellipsoid_ferrers import outer_derivatives
from eigencontact_plugins.shapes.sphere import SphericalInclusion

CENTER = (0.1, -0.2, 1.8)
TURN = (0.3, -0.8, 1.9)
SHAPES = {
    "triaxial": (1.3, 1.0, 0.7),
    "prolate": (0.4, 0.4, 1.3),
    "oblate": (1.2, 0.5, 1.2),
    "disc": (1.0, 1.0, 0.05),
    "needle": (0.05, 0.05, 1.0),
    "blade": (1.0, 0.3, 0.05),
    "nearly a sphere": (1.0, 1.0 + 1e-8, 1.0 - 1e-8),
    "sphere": (1.0, 1.0, 1.0),
}
#: Shapes of three kinds, where all would ask the same once more: general, thin, and round but for rounding.
THREE = ("triaxial", "blade", "nearly a sphere")
OTHERS = [name for name in SHAPES if name not in THREE]
every_shape = pytest.mark.parametrize("semi_axes", SHAPES.values(), ids=SHAPES)
DEGREE = 6
CHI = [(i, total - i - k, k) for total in (3, 4) for k in (0, 1) for i in range(total - k, -1, -1)]


def orders_of(*totals):
    return [orders for orders in monomials(max(totals)) if sum(orders) in totals]


def count_of(degree):
    return (degree + 1) * (degree + 2) * (degree + 3) // 6


def directions(count, seed=3):
    d = np.random.default_rng(seed).normal(size=(3, count))
    return d / np.linalg.norm(d, axis=0)


def worst(got, expected):
    """Largest error of derivatives ``(n, orders, points)`` of one order, relative to the largest at its point."""
    return (np.abs(got - expected).max(axis=(0, 1)) / np.abs(expected).max(axis=(0, 1))).max()


def sums_one_by_one(shape, degree, name, orders, points, *, image):
    n = count_of(degree)
    each = np.eye(n * len(orders)).reshape(-1, n, len(orders))
    return shape.moment_sums(degree, {name: (orders, each)}, *points, image=image).reshape(n, len(orders), -1)


def test_abilities():
    assert isinstance(Ellipsoid(center=CENTER, semi_axes=(1, 2, 1.5)), HasMomentPotentials)
    assert isinstance(Ellipsoid(center=CENTER, semi_axes=(1, 2, 1.5)), HasMomentSums)
    assert isinstance(Ellipsoid(center=CENTER, semi_axes=(1, 2, 1.5)), HasMomentIntegrals)


@every_shape
def test_densities_of_a_degree_are_orthogonal_to_lower_degrees_and_of_mean_square_one(semi_axes):
    shape = Ellipsoid(center=CENTER, semi_axes=semi_axes, rotation=TURN)
    points, weights = shape.density_rule((8, 8, 15))
    values = shape.densities(DEGREE, *points.T)
    assert weights.sum() == close(shape.volume, rel=1e-13)
    assert len(values) == count_of(DEGREE)
    gram = (values * weights) @ values.T / shape.volume
    assert np.diag(gram) == close(1.0, rel=1e-12)
    for degree in range(DEGREE):
        assert np.abs(gram[: count_of(degree), count_of(degree) :]).max() < 1e-12
    assert np.linalg.cond(gram) < 100


# Φ -------------------------------------------------------------------------------------------------------------------


@every_shape
@pytest.mark.parametrize("order", [*range(5), pytest.param(5, marks=pytest.mark.slow)])
def test_outside_the_potentials_equal_quadrature_over_the_volume(semi_axes, order):
    shape = Ellipsoid(center=CENTER, semi_axes=semi_axes, rotation=TURN)
    nodes, weights = shape.density_rule((16, 16, 32))
    points = np.array(CENTER)[:, None] + directions(4) * 4.0 * max(semi_axes)
    kernels = derivatives_of(
        lambda x, y, z: np.sqrt(x * x + y * y + z * z) ** -1,
        orders_of(order),
        *(points[:, :, None] - nodes.T[:, None, :]),
    )
    expected = np.einsum("nm,opm->nop", shape.densities(DEGREE, *nodes.T) * weights, kernels)
    assert worst(shape.phi_moments(DEGREE, orders_of(order), *points), expected) < 1e-11


@pytest.mark.slow
@pytest.mark.parametrize("semi_axes", [SHAPES[name] for name in ("triaxial", "nearly a sphere", "prolate", "oblate")])
def test_inside_potential_and_gradient_equal_quadrature_along_rays(semi_axes):
    """∫ρ/R dV = ∫∫ρ R dR dΩ, and of the gradient ∫∫ρ e dR dΩ, with e the direction: no singular integrand."""
    shape = Ellipsoid(center=CENTER, semi_axes=semi_axes, rotation=TURN)
    cosines, gauss = np.polynomial.legendre.leggauss(100)
    angles = np.pi * (np.arange(200) + 0.5) / 100
    sine = np.sqrt(1 - cosines**2)[:, None]
    rays = np.stack([sine * np.cos(angles), sine * np.sin(angles), cosines[:, None] + 0 * angles]).reshape(3, -1)
    nodes, along = np.polynomial.legendre.leggauss(6)
    for own in 0.7 * directions(2).T:
        point = np.array(CENTER) + shape.axes @ (own * semi_axes)
        e = shape.axes.T @ rays / np.array(semi_axes)[:, None]  # |own + t e| = 1 where the ray leaves
        a, b, c = (e * e).sum(axis=0), own @ e, own @ own - 1
        length = (-b + np.sqrt(b * b - a * c)) / a
        R = length[:, None] * (nodes + 1) / 2
        weights = np.repeat(gauss, 200)[:, None] * np.pi / 100 * along * length[:, None] / 2
        places = point[:, None, None] + rays[:, :, None] * R
        density = shape.densities(DEGREE, *places)
        expected = np.stack(
            [
                (density * weights * R).sum(axis=(1, 2)),
                *((density * weights * ray[:, None]).sum(axis=(1, 2)) for ray in rays),
            ],
            axis=1,
        )[..., None]
        got = shape.phi_moments(DEGREE, [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], *point[:, None])
        assert worst(got[:, :1], expected[:, :1]) < 1e-11
        assert worst(got[:, 1:], expected[:, 1:]) < 1e-11


@every_shape
def test_inside_the_laplacian_is_that_of_the_density(semi_axes):
    shape = Ellipsoid(center=CENTER, semi_axes=semi_axes, rotation=TURN)
    points = np.array(CENTER)[:, None] + shape.axes @ (0.8 * directions(20) * np.array(semi_axes)[:, None])
    second = shape.phi_moments(DEGREE, [(2, 0, 0), (0, 2, 0), (0, 0, 2)], *points)
    expected = -4 * np.pi * shape.densities(DEGREE, *points)
    assert worst(second.sum(axis=1, keepdims=True), expected[:, None]) < 1e-11


# semi-axes, point near the boundary, n, derivative of the potential of (1 - Σ x_i²/a_i²)^n, its value: the integral of
# Ferrers and Dyson at 130 digits, differentiated by central differences of step 1e-8
REFERENCE = [
    ((1.0, 0.8, 0.05), (0.4, 0.3, 0.0441), 1, (2, 2, 1), -3.605004104697545),
    ((1.0, 0.8, 0.05), (0.4, 0.3, 0.0441), 3, (5, 2, 1), -483.9628630103565),
    ((1.0, 0.8, 0.05), (0.4, 0.3, 0.0441), 6, (6, 4, 1), -431523.7864849021),
    ((1.0, 0.06, 0.05), (0.5, 0.03, 0.0362), 1, (2, 2, 1), 133.4173476526425),
    ((1.0, 0.06, 0.05), (0.5, 0.03, 0.0362), 6, (6, 4, 1), 4503587221.886447),
    ((1.0, 0.06, 0.05), (0.5, 0.03, 0.0362), 7, (3, 8, 0), 3868264736207.563),
    ((1.0, 0.9, 0.05), (1.02, 0.1, 0.01), 3, (5, 2, 1), 34374.80308025784),
    ((1.0, 0.9, 0.05), (1.02, 0.1, 0.01), 6, (6, 4, 1), 2549080.55307196),
    ((1.0, 0.9, 0.001), (0.480048, -0.3240324, 0.00080008), 3, (5, 2, 1), -10.99791424668393),
    ((1.0, 0.9, 0.001), (0.480048, -0.3240324, 0.00080008), 7, (3, 8, 0), -58932.72205920391),
]


@pytest.mark.parametrize(("semi_axes", "point", "n", "order", "expected"), REFERENCE)
def test_close_to_discs_and_needles_high_orders_keep_their_digits(semi_axes, point, n, order, expected):
    got = outer_derivatives(np.array(semi_axes), [(n, order)], tuple(np.array([x]) for x in point))
    assert got[0, 0] == close(expected, rel=1e-11)


# Ψ and Χ -------------------------------------------------------------------------------------------------------------


@every_shape
@pytest.mark.parametrize("order", [3, 4, 5])
def test_psi_equals_quadrature_over_the_volume(semi_axes, order):
    shape = Ellipsoid(center=CENTER, semi_axes=semi_axes, rotation=TURN)
    nodes, weights = shape.density_rule((16, 16, 32))
    points = np.array(CENTER)[:, None] + directions(4) * 4.0 * max(semi_axes)
    distances = points[:, :, None] - nodes.T[:, None, :]
    kernels = derivatives_of(lambda x, y, z: np.sqrt(x * x + y * y + z * z), orders_of(order), *distances)
    expected = np.einsum("nm,opm->nop", shape.densities(4, *nodes.T) * weights, kernels)
    got = sums_one_by_one(shape, 4, "psi", orders_of(order), points, image=False)
    assert worst(got, expected) < 1e-11


@every_shape
@pytest.mark.parametrize("order", [3, 4])
def test_chi_equals_quadrature_over_the_volume(semi_axes, order):
    shape = Ellipsoid(center=CENTER, semi_axes=semi_axes, rotation=TURN)
    nodes, weights = shape.density_rule((16, 16, 32))
    points = np.abs(directions(4)) * [[3.0], [3.0], [1.5]] + np.array([[0.0], [0.0], [2.5]])
    orders = [chi for chi in CHI if sum(chi) == order]
    kernels = derivatives_of(
        lambda x, y, z: z * np.log(np.sqrt(x * x + y * y + z * z) + z) - np.sqrt(x * x + y * y + z * z),
        orders,
        *(points[:, :, None] - nodes.T[:, None, :] * np.array([1.0, 1.0, -1.0])[:, None, None]),
    )
    expected = np.einsum("nm,opm->nop", shape.densities(4, *nodes.T) * weights, kernels)
    assert worst(sums_one_by_one(shape, 4, "chi", orders, points, image=True), expected) < 1e-11


# Integrals ---------------------------------------------------------------------------------------------------------


def random_weights(orders_by_name, degree, seed=7):
    rng = np.random.default_rng(seed)
    return {
        name: (orders, rng.normal(size=(2, count_of(degree), len(orders)))) for name, orders in orders_by_name.items()
    }


KERNELS = {
    "phi": lambda x, y, z: np.sqrt(x * x + y * y + z * z) ** -1,
    "psi": lambda x, y, z: np.sqrt(x * x + y * y + z * z),
    "chi": lambda x, y, z: z * np.log(np.sqrt(x * x + y * y + z * z) + z) - np.sqrt(x * x + y * y + z * z),
}


@every_shape
@pytest.mark.parametrize("image", [False, True], ids=["region", "image"])
def test_integrals_equal_quadrature_over_the_volume_at_each_point(semi_axes, image):
    """Sum over points of test function times Σ weight ∫ρ ∂^γ kernel dV; kernels differentiated by jets."""
    shape = Ellipsoid(center=CENTER, semi_axes=semi_axes, rotation=TURN)
    nodes, of_node = shape.density_rule((14, 14, 28))
    mirror = np.array([1.0, 1.0, -1.0 if image else 1.0])
    points = np.array(CENTER)[:, None] + directions(5) * 4.0 * max(semi_axes)
    points[2] = np.abs(points[2]) + (2.5 if image else 0.0)
    weights = random_weights({"phi": orders_of(3), "psi": orders_of(4), **({"chi": CHI} if image else {})}, 3)
    tests = np.random.default_rng(8).normal(size=(3, points.shape[1]))
    offset = points[:, :, None] - (nodes * mirror).T[:, None, :]
    of_density = shape.densities(3, *nodes.T) * of_node
    expected, scale = 0.0, 0.0
    for name, (orders, of_orders) in weights.items():
        kernels = derivatives_of(KERNELS[name], orders, *offset)
        terms = np.einsum("kno,nm,opm,dp->kdnop", of_orders, of_density, kernels, tests, optimize=True)
        expected, scale = expected + terms.sum(axis=(2, 3, 4)), scale + np.abs(terms).sum(axis=(2, 3, 4))
    got = shape.moment_integrals(3, weights, *points, tests, image=image)
    assert got.shape == (2, 3)
    assert (np.abs(got - expected) / scale).max() < 1e-12


@pytest.mark.parametrize("name", THREE)
def test_integrals_add_sums_at_points_inside_on_the_boundary_and_outside(name):
    shape = Ellipsoid(center=CENTER, semi_axes=SHAPES[name], rotation=TURN)
    own = directions(90) * np.repeat([0.5, 1.0, 1.3], 30)
    points = np.array(CENTER)[:, None] + shape.axes @ (own * np.array(SHAPES[name])[:, None])
    weights = random_weights({"phi": orders_of(2, 3), "psi": orders_of(4)}, 4)
    tests = np.random.default_rng(8).normal(size=(3, 90))
    sums = shape.moment_sums(4, weights, *points, image=False)
    expected, scale = sums @ tests.T, np.abs(sums) @ np.abs(tests).T
    assert (np.abs(shape.moment_integrals(4, weights, *points, tests, image=False) - expected) / scale).max() < 1e-12


def test_integrals_of_an_image_next_to_a_disc_equal_the_sums():
    """Some points are so close that Chi is integrated along a line."""
    shape = Ellipsoid(center=(0.0, 0.0, 0.06), semi_axes=SHAPES["disc"])
    points = np.array([[0.0, 0.4, 1.0, 3.0], [0.0, 0.1, 0.0, 1.0], [0.0, 0.02, 0.05, 2.0]])
    weights = random_weights({"phi": orders_of(3), "psi": orders_of(4), "chi": CHI}, 2)
    tests = np.random.default_rng(8).normal(size=(2, 4))
    sums = shape.moment_sums(2, weights, *points, image=True)
    expected, scale = sums @ tests.T, np.abs(sums) @ np.abs(tests).T
    assert (np.abs(shape.moment_integrals(2, weights, *points, tests, image=True) - expected) / scale).max() < 1e-12


@pytest.mark.parametrize("name", [*THREE, *(pytest.param(name, marks=pytest.mark.slow) for name in OTHERS)])
@pytest.mark.parametrize("degree", [2, 6])
def test_stress_is_in_equilibrium_and_leaves_the_surface_free_of_traction(name, degree):
    """Differences of sixth order along each axis, steps of 0.003. The top is 0.3 below the surface."""
    shape = Ellipsoid(center=(0.0, 0.0, 5.0), semi_axes=SHAPES[name], rotation=TURN)
    shape = Ellipsoid(center=(0.0, 0.0, 5.3 - shape.bounds[0][2]), semi_axes=SHAPES[name], rotation=TURN)
    coefficients = np.random.default_rng(1).normal(size=(6, count_of(degree)))

    def stress(points):
        shared = {"degree": degree, "poisson_ratio": 0.3, "quantity": "stress", "threads": 1}
        return moment_field(shape, coefficients, tuple(points.reshape(3, -1)), **shared).reshape(6, *points.shape[1:])

    places = directions(6) * np.array([[1.0], [1.0], [0.0]]) + [[0.4], [0.3], [0.15]]  # between region and image
    steps = 0.003 * np.arange(-3, 4)
    factors = np.array([-1, 9, -45, 0, 45, -9, 1]) / 60 / 0.003
    slopes = [stress(places[:, :, None] + steps * np.eye(3)[:, axis, None, None]) @ factors for axis in range(3)]
    rows = [(0, 5, 4), (5, 1, 3), (4, 3, 2)]
    size = np.array([1, 1, 1, *[np.sqrt(0.5)] * 3])
    terms = np.array([[size[row] * slopes[axis][row] for axis, row in enumerate(of)] for of in rows])
    assert np.abs(terms.sum(axis=1)).max() < 1e-9 * np.abs(terms).max()
    top = stress(places * [[1.0], [1.0], [0.0]])
    assert np.abs(top[2:5]).max() < 1e-12 * np.abs(top).max()


# limits and symmetries -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("spread", [0.0, 1e-12])
def test_equal_axes_are_a_sphere(spread):
    a, degree = 1.3, 4
    sphere = SphericalInclusion(center=CENTER, radius=a)
    shape = Ellipsoid(center=CENTER, semi_axes=(a, a * (1 + spread), a * (1 - spread)))
    places, _ = sphere.density_rule((8, 8, 15))
    own, others = shape.densities(degree, *places.T), sphere.densities(degree, *places.T)
    table = np.linalg.lstsq(others.T, own.T, rcond=None)[0].T
    points = np.array(CENTER)[:, None] + directions(40) * np.linspace(0.05, 4, 40)
    points[2] = np.abs(points[2])
    for image, name, totals in (
        (False, "phi", range(6)),
        (False, "psi", (3, 4, 5)),
        (True, "psi", (3, 4, 5)),
        (True, "chi", (3, 4)),
    ):
        for total in totals:
            orders = [chi for chi in CHI if sum(chi) == total] if name == "chi" else orders_of(total)
            got, expected = (
                sums_one_by_one(body, degree, name, orders, points, image=image) for body in (shape, sphere)
            )
            # terms of order L alternate: they lose (1 + √2)^L, 3000 at L = degree + 5, of some round-off of moments
            assert worst(got, np.einsum("nk,kop->nop", table, expected)) < 2e-11 + 50 * spread, (name, total)


def test_densities_turn_with_the_body():
    """Potentials of a turned body are those of the straight one at turned points, gradients turned back."""
    semi_axes = SHAPES["triaxial"]
    turned = Ellipsoid(center=CENTER, semi_axes=semi_axes, rotation=TURN)
    straight = Ellipsoid(center=CENTER, semi_axes=semi_axes)
    own = directions(30) * np.linspace(0.1, 5, 30)
    at, there = np.array(CENTER)[:, None] + own, np.array(CENTER)[:, None] + turned.axes @ own
    assert worst(turned.densities(3, *there)[:, None], straight.densities(3, *at)[:, None]) < 1e-13
    first = [(1, 0, 0), (0, 1, 0), (0, 0, 1)]
    gradient = np.einsum("ij,njp->nip", turned.axes, straight.phi_moments(3, first, *at))
    assert worst(turned.phi_moments(3, first, *there), gradient) < 1e-13
    second = [tuple(int(k in (i, j)) + int(k == i == j) for k in range(3)) for i in range(3) for j in range(3)]
    hessian = straight.phi_moments(3, second, *at).reshape(20, 3, 3, -1)
    expected = np.einsum("ik,jl,nklp->nijp", turned.axes, turned.axes, hessian).reshape(20, 9, -1)
    assert worst(turned.phi_moments(3, second, *there), expected) < 1e-13


@pytest.mark.parametrize("scale", [1e-6, 3e4])
def test_potentials_scale_with_the_size(scale):
    """The order-th derivative of Φ scales with the size to 2 - order, of Ψ and Χ to 4 - order."""
    one = Ellipsoid(center=CENTER, semi_axes=SHAPES["triaxial"], rotation=TURN)
    other = Ellipsoid(
        center=tuple(scale * x for x in CENTER), semi_axes=tuple(scale * a for a in SHAPES["triaxial"]), rotation=TURN
    )
    points = np.abs(np.array(CENTER)[:, None] + directions(30) * np.linspace(0.1, 5, 30))
    for name, order, power in [("phi", n, 2 - n) for n in range(6)] + [("psi", 4, 0), ("psi", 5, -1), ("chi", 3, 1)]:
        orders = [chi for chi in CHI if sum(chi) == order] if name == "chi" else orders_of(order)
        got, expected = (
            sums_one_by_one(body, 3, name, orders, size * points, image=True)
            for body, size in ((other, scale), (one, 1.0))
        )
        assert worst(got, scale**power * expected) < 1e-11


def test_on_the_boundary_the_mean_of_both_sides_and_at_a_point_of_touch_the_outer():
    shape = Ellipsoid(center=(0, 0, 0.5), semi_axes=(1.5, 1.0, 0.5))
    poles = np.array([[1.5, 0, 0.5], [0, -1.0, 0.5], [0, 0, 1.0], [0.9, 0, 0.9]]).T
    middle = np.array([[0], [0], [0.5]])
    inner, outer = (shape.phi_moments(2, orders_of(2), *(middle + (poles - middle) * (1 + s * 1e-9))) for s in (-1, 1))
    assert worst(shape.phi_moments(2, orders_of(2), *poles), 0.5 * (inner + outer)) < 1e-7
    assert worst(inner, outer) > 0.1
    touch = shape.phi_moments(2, [(2, 0, 0), (0, 2, 0), (0, 0, 2)], *np.zeros((3, 1)))
    assert np.abs(touch.sum(axis=1)).max() < 1e-11


@pytest.mark.parametrize("form", [(), (0,), (3, 2, 2)])
def test_any_shape_of_points(form):
    shape = Ellipsoid(center=CENTER, semi_axes=SHAPES["triaxial"])
    points = [np.full(form, x) for x in (0.3, 0.1, 2.0)]
    assert shape.densities(2, *points).shape == (10, *form)
    assert shape.phi_moments(2, orders_of(1), *points).shape == (10, 3, *form)
    weights = {"psi": (orders_of(3), np.ones((2, 10, 10))), "chi": (CHI, np.ones((2, 10, len(CHI))))}
    assert shape.moment_sums(2, weights, *points, image=True).shape == (2, *form)
