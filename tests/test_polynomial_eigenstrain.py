"""Fields of polynomial eigenstrain against quadrature of Mindlin's solution, and faults that this comparison sees."""

import numpy as np
import pytest

import eigencontact as ec
from eigencontact.core.tensors import INDICES, to_mandel, to_matrix
from eigencontact.halfspace.moments import moment_field
from eigencontact_verification.oracles.polynomial_eigenstrain import PolynomialEllipsoid
from moment_faults import FAULTS, planted

DEGREE = 4
CENTER = (0.2, -0.1, 1.5)
#: Outside, at the surface and inside, in radii from the centre; a quadrature of 20 nodes is good to 1e-7 there.
OFFSETS = np.array([[0.3, 0.2, -1.5], [1.2, -0.8, 0.6], [0.2, 0.1, -0.3], [-0.3, 0.25, 0.4]])
OTHERS = [(0.0, "half"), (0.3, "half"), (0.45, "half"), (0.3, "full")]
RNG = np.random.default_rng(7)

ELLIPSOID = ec.make(
    "ellipsoid", kind="inclusion-shape", center=CENTER, semi_axes=(1.0, 0.8, 0.6), rotation=(0.4, 0.3, 0.2)
)


def tensor():
    values = RNG.normal(size=(3, 3))
    return values + values.T


#: Every degree, every parity of x, y and z, all six components.
TERMS = [
    (powers, tensor())
    for powers in (
        (0, 0, 0), (0, 0, 1), (1, 0, 0), (0, 1, 0), (0, 0, 2), (1, 1, 0), (1, 0, 1), (2, 1, 0), (0, 0, 3), (1, 1, 1),
        (0, 0, 4), (2, 0, 2), (3, 1, 0), (0, 1, 3),
    )
]  # fmt: skip


def coefficients_of(shape, oracle, degree):
    """Mandel coefficients of the shape's densities, fitted to values of the oracle's polynomial."""
    places, _ = shape.density_rule((degree + 2, degree + 2, 2 * degree + 4))
    tensors = oracle.eigenstrain(places)
    values = to_mandel([tensors[:, i, j] for i, j in INDICES])
    densities = shape.densities(degree, *places.T)
    found = np.linalg.lstsq(densities.T, values.T, rcond=None)[0].T
    assert np.abs(found @ densities - values).max() < 1e-11 * np.abs(values).max()
    return found


def errors(shape, oracle, reference, nu, space):
    """Largest error of displacement and of stress, in the largest value, by points ``(2, n)``."""
    points = OFFSETS + CENTER
    found = []
    for quantity, expected in zip(("displacement", "stress"), reference, strict=True):
        field = moment_field(
            shape, coefficients_of(shape, oracle, DEGREE), tuple(points.T), degree=DEGREE, poisson_ratio=nu,
            quantity=quantity, space=space,
        )  # fmt: skip
        values = field.T if quantity == "displacement" else to_matrix(field)
        found.append(np.abs(values - expected).reshape(len(points), -1).max(axis=1) / np.abs(expected).max())
    return np.array(found)


def reference_of(oracle, nu, space):
    return oracle.displacement(OFFSETS + CENTER, nu, space), oracle.stress(OFFSETS + CENTER, nu, space)


def ball_oracle(count=20):
    return PolynomialEllipsoid(center=CENTER, semi_axes=(1.0, 1.0, 1.0), terms=TERMS, count=count)


@pytest.fixture(scope="module")
def ball():
    return ec.make("sphere", kind="inclusion-shape", center=CENTER, radius=1.0)


@pytest.mark.parametrize(
    ("nu", "space"),
    [(0.5, "half"), *(pytest.param(*other, marks=pytest.mark.slow) for other in OTHERS)],
)
def test_ball(ball, nu, space):
    oracle = ball_oracle()
    assert errors(ball, oracle, reference_of(oracle, nu, space), nu, space).max() < 1e-7


@pytest.mark.slow
@pytest.mark.parametrize("nu", [0.3, 0.5])
def test_turned_ellipsoid(nu):
    region = {"center": CENTER, "semi_axes": ELLIPSOID.semi_axes, "rotation": ELLIPSOID.axes}
    oracle = PolynomialEllipsoid(**region, terms=TERMS, count=22)
    assert errors(ELLIPSOID, oracle, reference_of(oracle, nu, "half"), nu, "half").max() < 1e-9


@pytest.mark.slow
def test_ball_to_round_off(ball):
    oracle = ball_oracle(30)
    assert errors(ball, oracle, reference_of(oracle, 0.3, "half"), 0.3, "half").max() < 1e-11


@pytest.fixture(scope="module")
def judge():
    oracle = ball_oracle(16)
    return oracle, reference_of(oracle, 0.3, "half")


@pytest.mark.parametrize(
    "fault",
    [
        pytest.param(fault, marks=[pytest.mark.slow] if "inside, even" in fault or "Psi" in fault else [])
        for fault in FAULTS
    ],
)
def test_fault_is_seen(ball, judge, fault):
    oracle, reference = judge
    assert errors(ball, oracle, reference, 0.3, "half").max() < 1e-5
    with planted(fault):
        assert errors(ball, oracle, reference, 0.3, "half").max() > 1e-3
