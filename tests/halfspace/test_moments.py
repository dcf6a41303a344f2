"""Polynomial eigenstrain by potentials of densities: against the uniform theorem, equilibrium, the surface."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from eigencontact.errors import SceneError
from eigencontact.halfspace.moments import degree_of, densities_up_to, moment_field, surface_displacement
from eigencontact.halfspace.points import field_at_points
from eigencontact_plugins.shapes.sphere import SphericalInclusion

BALL = SphericalInclusion(center=(0.3, -0.2, 2.0), radius=1.5)
NU = 0.3
RNG = np.random.default_rng(3)
POINTS = (RNG.normal(size=60) * 2, RNG.normal(size=60) * 2, np.abs(RNG.normal(size=60)) * 2)
UNIFORM = RNG.normal(size=6)


class WithoutSums:
    """The same ball as a stranger's shape: potentials of its densities, and nothing else."""

    def __init__(self, ball):
        self.bounds, self.densities = ball.bounds, ball.densities
        self.density_rule, self.phi_moments = ball.density_rule, ball.phi_moments


def field(shape, coefficients, degree, quantity="stress", space="half", points=POINTS):
    options = {"degree": degree, "poisson_ratio": NU, "quantity": quantity, "space": space}
    return moment_field(shape, coefficients, points, **options)


@pytest.mark.parametrize("space", ["half", "full"])
@pytest.mark.parametrize("quantity", ["displacement", "strain", "stress"])
def test_degree_zero_is_a_uniform_eigenstrain(quantity, space):
    expected = field_at_points(BALL, UNIFORM, POINTS, poisson_ratio=NU, quantity=quantity, space=space)
    found = field(BALL, UNIFORM[:, None], 0, quantity, space)
    np.testing.assert_allclose(found, expected, atol=1e-13 * np.abs(expected).max(), rtol=0)


@pytest.mark.parametrize("quantity", ["displacement", "stress"])
def test_a_shape_without_sums_gives_the_same(quantity):
    coefficients = RNG.normal(size=(2, 6, densities_up_to(2)))
    expected = field(BALL, coefficients, 2, quantity)
    found = field(WithoutSums(BALL), coefficients, 2, quantity)
    np.testing.assert_allclose(found, expected, atol=1e-12 * np.abs(expected).max(), rtol=0)


@settings(max_examples=8, deadline=None)
@given(depth=st.floats(1.0, 3.0), degree=st.integers(0, 6), nu=st.sampled_from([0.0, 0.3, 0.5]))
def test_the_surface_bears_no_traction(depth, degree, nu):
    """Also where the ball touches the surface, and in an incompressible body."""
    ball = SphericalInclusion(center=(0.0, 0.0, depth), radius=1.0)
    coefficients = np.random.default_rng(degree).normal(size=(6, densities_up_to(degree)))
    x, y = np.linspace(-2, 2, 21) + 0.01, np.full(21, 0.3)
    options = {"degree": degree, "poisson_ratio": nu, "quantity": "stress"}
    stress = moment_field(ball, coefficients, (x, y, np.zeros(21)), **options)
    assert np.abs(stress[2:5]).max() < 1e-13 * np.abs(stress).max()


def test_inside_and_outside_are_in_equilibrium():
    """Divergence of stress by differences of fourth order, at points off the boundary."""
    degree, step = 3, 1e-3
    coefficients = RNG.normal(size=(6, densities_up_to(degree)))
    centers = np.array([[0.5, 0.1, 2.2], [0.2, -0.9, 1.4], [2.5, 0.5, 1.0], [0.0, 0.0, 4.5]])
    rows = {0: (0, 5, 4), 1: (5, 1, 3), 2: (4, 3, 2)}  # Mandel places of the components (i, j)
    divergence = np.zeros((3, len(centers)))
    for axis in range(3):
        for shift, weight in ((-2, 1), (-1, -8), (1, 8), (2, -1)):
            at = centers + step * shift * np.eye(3)[axis]
            stress = field(BALL, coefficients, degree, points=tuple(at.T))
            for i in range(3):
                scale = 1.0 if i == axis else np.sqrt(0.5)
                divergence[i] += weight / (12 * step) * scale * stress[rows[i][axis]]
    assert np.abs(divergence).max() < 1e-8 * np.abs(coefficients).max()


def test_displacement_of_the_surface_is_that_of_the_field():
    coefficients = RNG.normal(size=(3, 6, densities_up_to(3)))
    x, y = POINTS[:2]
    expected = field(BALL, coefficients, 3, "displacement", points=(x, y, np.zeros_like(x)))[:, [2, 0]]
    found = surface_displacement(BALL, coefficients, (x, y), [2, 0], degree=3, poisson_ratio=NU)
    np.testing.assert_allclose(found, expected, atol=1e-14 * np.abs(expected).max(), rtol=0)


def test_the_degree_of_coefficients():
    coefficients = np.zeros((6, densities_up_to(4)))
    assert degree_of(coefficients) == 0
    for degree in range(5):
        coefficients[2, densities_up_to(degree) - 1] = 1.0
        assert degree_of(coefficients) == degree


def test_coefficients_of_another_degree_are_refused():
    with pytest.raises(SceneError, match="coefficients"):
        field(BALL, np.zeros((6, 9)), 2)
