"""Balls with polynomial eigenstrain by elements: the elements' own eigenstrain, agreement, and faults that they see."""

import numpy as np
import pytest

from close import close
from eigencontact_verification.crosscheck import cases
from eigencontact_verification.crosscheck.polynomials import COMPONENTS, polynomial_case
from eigencontact_verification.oracles.polynomial_eigenstrain import PolynomialEllipsoid
from moment_faults import FAULTS, planted
from verdicts import references, words

AGREES = {"displacement": "agrees", "stress": "agrees"}
#: Every family of densities of a field of revolution, so of degree 4.
MIXED = [[1.0, "plane", 0, 0], [-0.7, "zz", 1, 1], [0.8, "radial", 0, 2], [0.6, "shear", 0, 3], [0.5, "uniform", 0, 3]]


@pytest.fixture(scope="module")
def mixed():
    case = polynomial_case(MIXED, depth=0.75)
    return case, references(case)


@pytest.mark.slow
def test_sound_code_agrees(mixed):
    assert words(*mixed) == AGREES


@pytest.mark.slow
@pytest.mark.parametrize("fault", [name for name in FAULTS if name != "image sign of l alone"])
def test_fault_disagrees(mixed, fault):
    """That sign matters with m odd alone, of which a field of revolution has none."""
    with planted(fault):
        assert "disagrees" in words(*mixed).values()


@pytest.mark.slow
def test_elements_are_judged_by_mindlin_too(mixed):
    """Displacement of the surface by quadrature, none of the program's code: within the uncertainty of the elements."""
    case, found = mixed
    center, radius = case.parameters["shape"]["center"], case.parameters["shape"]["radius"]
    terms = [((0, 0, 0), np.diag([1.0, 1.0, 0.0])), ((2, 0, 1), -0.7 * np.diag([0, 0, 1.0]))]
    terms += [((0, 2, 1), -0.7 * np.diag([0, 0, 1.0])), ((0, 0, 3), 0.5 * np.eye(3))]
    x, y, z = np.eye(3)
    for a, b, powers in ((x, x, (2, 0, 2)), (x, y, (1, 1, 2)), (y, x, (1, 1, 2)), (y, y, (0, 2, 2))):
        terms.append((powers, 0.8 * np.outer(a, b)))
    for a, powers in ((x, (1, 0, 3)), (y, (0, 1, 3))):
        terms.append((powers, 0.6 * (np.outer(a, z) + np.outer(z, a))))
    ball = PolynomialEllipsoid(center=tuple(center), semi_axes=(radius,) * 3, terms=terms, count=16)
    profile = next(profile for profile in case.profiles if profile.quantity == "displacement")
    points = profile.points[::6]
    assert case.tensor_at(points) == close(ball.eigenstrain(points), abs=1e-12)
    mindlin = ball.displacement(points, case.parameters["poisson_ratio"])[:, [0, 2]]
    estimate = found[profile.name]
    assert np.all(np.abs(estimate.value[::6] - mindlin) <= estimate.uncertainty[::6] + 1e-7)


def test_cases_reach_every_component_and_degree():
    listed = cases.cases_of("polynomial-eigenstrain")
    assert {name for case in listed for _, name, _, _ in case.terms} == set(COMPONENTS)
    assert {case.degree for case in listed} == {1, 2, 3, 4}
    assert sum(case.quick for case in listed) == 2


def test_coefficients_of_a_density_alone():
    """The fitted coefficients give back the polynomial at points that the fit has not seen."""
    case = polynomial_case(MIXED, depth=0.9, poisson_ratio=0.2)
    points = np.random.default_rng(5).normal(size=(30, 3)) + case.parameters["shape"]["center"]
    values = case.coefficients @ case.shape.densities(case.degree, *points.T)
    assert values[:3] == close(np.einsum("nii->in", case.tensor_at(points)), abs=1e-9)
