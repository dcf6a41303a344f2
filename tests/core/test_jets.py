"""Taylor arithmetic: derivatives of formulas against closed forms written by hand."""

# ruff: noqa: ARG005 - a formula of one coordinate takes all three

import numpy as np
import pytest

from close import close
from eigencontact.core.jets import monomials
from eigencontact.plugin import Jet, derivatives_of, implicit, variables

RNG = np.random.default_rng(7)
X, Y, Z = RNG.uniform(0.4, 1.6, size=(3, 50))
R = np.sqrt(X * X + Y * Y + Z * Z)


def radius(x, y, z):
    return np.sqrt(x * x + y * y + z * z)


# name, formula, derivative, its closed form at X, Y, Z
U = 0.3 * X - 0.5 * Y + 0.7 * Z  # argument of functions of one plane wave: derivatives are powers of 0.3, -0.5, 0.7
CLOSED = [
    ("1/R", lambda x, y, z: 1 / radius(x, y, z), (2, 1, 1), -15 * Y * Z / R**7 + 105 * X**2 * Y * Z / R**9),
    ("1/R fifth", lambda *p: radius(*p) ** -1, (0, 0, 5), -Z * (225 / R**7 - 1050 * Z**2 / R**9 + 945 * Z**4 / R**11)),
    ("R", radius, (1, 1, 1), 3 * X * Y * Z / R**5),
    ("R fourth", radius, (4, 0, 0), -3 / R**3 + 18 * X**2 / R**5 - 15 * X**4 / R**7),
    ("half power", lambda x, y, z: (x * y) ** 1.5, (2, 2, 0), 0.5625 * (X * Y) ** -0.5),
    ("whole power", lambda x, y, z: (x + 2 * y) ** 5, (2, 1, 0), 120 * (X + 2 * Y) ** 2),
    ("negative power", lambda x, y, z: (x * y) ** -2, (2, 1, 0), -12 * X**-4 * Y**-3),
    ("quotient", lambda x, y, z: (x * x) / y, (1, 3, 0), -12 * X / Y**4),
    ("number over jet", lambda x, y, z: np.float64(2.0) / z, (0, 0, 5), -240 / Z**6),
    ("array times jet", lambda x, y, z: X * (x - Y) * (1 - y) + X, (1, 1, 0), -X),
    ("exp", lambda x, y, z: np.exp(0.3 * x - 0.5 * y + 0.7 * z), (1, 2, 2), 0.3 * 0.25 * 0.49 * np.exp(U)),
    ("log", lambda x, y, z: np.log(0.3 * x - 0.5 * y + 0.7 * z + 2), (2, 1, 1), -6 * 0.09 * -0.5 * 0.7 / (U + 2) ** 4),
    ("log(R + z)", lambda x, y, z: np.log(radius(x, y, z) + z), (0, 0, 3), -1 / R**3 + 3 * Z**2 / R**5),
    ("arctan", lambda x, y, z: np.arctan(2 * x), (4, 0, 0), 16 * 24 * 2 * X * (1 - 4 * X * X) / (1 + 4 * X * X) ** 4),
    ("arcsinh", lambda x, y, z: np.arcsinh(z), (0, 0, 3), (2 * Z * Z - 1) / (1 + Z * Z) ** 2.5),
    ("arcsinh fifth", lambda x, y, z: np.arcsinh(z), (0, 0, 5), (24 * Z**4 - 72 * Z**2 + 9) / (1 + Z * Z) ** 4.5),
    ("arctan2", lambda x, y, z: np.arctan2(y, x), (1, 1, 0), (Y * Y - X * X) / (X * X + Y * Y) ** 2),
    ("reciprocal of a square", lambda x, y, z: np.reciprocal(np.square(x)), (3, 0, 0), -24 / X**5),
    ("polynomial beyond its degree", lambda x, y, z: x * y, (2, 1, 1), 0 * X),
]  # fmt: skip


@pytest.mark.parametrize(("formula", "orders", "expected"), [c[1:] for c in CLOSED], ids=[c[0] for c in CLOSED])
def test_derivatives_of_a_formula_equal_the_closed_form(formula, orders, expected):
    (got,) = derivatives_of(formula, [orders], X, Y, Z)
    assert got == close(expected, rel=2e-13, abs=2e-13 * np.abs(expected).max())


def test_one_formula_serves_numbers_and_jets():
    formula = lambda x, y, z: np.exp(-x) * np.arctan2(y, z) + np.log(x * x + 2) / np.arcsinh(z)  # noqa: E731
    assert derivatives_of(formula, [(0, 0, 0)], X, Y, Z)[0] == close(formula(X, Y, Z), rel=1e-15)


def test_laplacians_of_the_distance_up_to_fifth_order():
    """Laplacian of R is 2/R and of 1/R zero, for every derivative that order 5 leaves."""
    raised = lambda n, axis: tuple(count + 2 * (a == axis) for a, count in enumerate(n))  # noqa: E731
    for lower in monomials(3):
        laplacian = derivatives_of(radius, [raised(lower, a) for a in range(3)], X, Y, Z).sum(axis=0)
        (twice,) = derivatives_of(lambda x, y, z: 2 / radius(x, y, z), [lower], X, Y, Z)
        assert laplacian == close(twice, abs=1e-11)
        harmonic = derivatives_of(lambda *p: 1 / radius(*p), [raised(lower, a) for a in range(3)], X, Y, Z).sum(axis=0)
        assert np.abs(harmonic).max() < 1e-10


def test_arctan2_is_regular_where_its_quotient_is_not():
    x, y, _ = variables(np.array([0.0, -1.0, 0.0]), np.array([1.0, 0.5, -2.0]), 0.0, order=3)
    angle = np.arctan2(y, x)
    assert angle.value == close(np.arctan2([1.0, 0.5, -2.0], [0.0, -1.0, 0.0]))
    assert angle.derivative((1, 0, 0)) == close([-1.0, -0.4, 0.5])
    third = y.value * (2 * y.value**2 - 6 * x.value**2) / (x.value**2 + y.value**2) ** 3
    assert angle.derivative((3, 0, 0)) == close(third, rel=1e-14)


def test_whole_powers_hold_at_zero():
    assert derivatives_of(lambda x, y, z: x**4, [(3, 0, 0), (4, 0, 0)], 0.0, 1.0, 1.0).tolist() == [0.0, 24.0]


def test_a_gradient_gives_the_jet_back():
    x, y, z = variables(X, Y, Z, 4)
    whole = np.exp(x * y) / z
    inner = variables(X, Y, Z, 3)
    part = np.exp(inner[0] * inner[1]) / inner[2]
    gradient = (inner[1] * part, inner[0] * part, -part / inner[2])
    assert np.allclose(
        Jet.from_gradient(whole.value, gradient).coefficients, whole.coefficients, rtol=1e-13, atol=1e-13
    )


def test_an_implicit_function_has_the_derivatives_of_its_solution():
    x, y, z = variables(X, Y, Z, 5)
    root = np.sqrt(1 + X * Y) - Z  # w² + 2 w z + z² = 1 + x y
    w = implicit(lambda w: (w + z) * (w + z) - x * y - 1, root, 2 * (root + Z), 5)
    assert np.allclose(w.coefficients, (np.sqrt(1 + x * y) - z).coefficients, rtol=1e-12, atol=1e-12)


def test_points_of_any_shape_broadcast_and_are_split_alike():
    grid = np.linspace(1, 2, 71)[:, None], np.linspace(-1, 1, 90), 0.5
    whole = derivatives_of(radius, [(1, 0, 2), (0, 3, 0)], *grid)  # 6390 points: two parts
    assert whole.shape == (2, 71, 90)
    single = derivatives_of(radius, [(1, 0, 2), (0, 3, 0)], grid[0][70, 0], grid[1][89], 0.5)
    assert whole[:, 70, 89] == close(single, rel=1e-15)


def test_an_order_too_high_is_refused():
    x, _, _ = variables(1.0, 2.0, 3.0, order=2)
    with pytest.raises(ValueError, match=r"total order 0 to 2 \(got \(1, 1, 1\)\)"):
        x.derivative((1, 1, 1))
