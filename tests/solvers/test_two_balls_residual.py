"""Two balls off any axis below a surface: by Mindlin's solution the answer satisfies Hooke's law in both.

By uniqueness an eigenstrain is the right one if the stress that it causes in the body, with the load's, is the stress
that the balls' own constants give to their strain. Its fields come from the quadrature oracle, which shares nothing
with the potentials of the program, at points that are none of its own.
"""

from itertools import pairwise

import numpy as np
import pytest

import eigencontact as ec
from eigencontact.core.elasticity import isotropic_stiffness
from eigencontact.core.material import Material
from eigencontact.solvers.polynomial_inclusions import PolynomialInclusions
from eigencontact_verification.oracles.polynomial_eigenstrain import PolynomialEllipsoid

NU = 0.3
MATRIX = Material(young_modulus=2.0 * (1.0 + NU), poisson_ratio=NU)  # shear modulus 1
PAIRS = (((0, 0), 1), ((1, 1), 1), ((2, 2), 1), ((1, 2), 2**0.5), ((0, 2), 2**0.5), ((0, 1), 2**0.5))
#: Centre, radius and Young's modulus over that of the body.
UNEQUAL = [((-0.5, -0.2, 0.8), 0.5, 3.0), ((0.5, 0.15, 1.1), 0.4, 0.3)]
LEVEL = [((-0.6, 0.0, 0.8), 0.5, 3.0), ((0.6, 0.0, 1.3), 0.5, 0.3)]
REMOTE = np.array([[1.0, 0.4, 0.0], [0.4, -0.3, 0.0], [0.0, 0.0, 0.0]])
#: Points in radii from a centre.
INSIDE = np.array([[0.0, 0.0, 0.0], [0.5, 0.2, 0.1], [-0.3, 0.4, 0.3], [0.1, -0.2, -0.6]])


def mandel(tensor):
    return np.array([factor * tensor[index] for index, factor in PAIRS])


def oracle_of(shape, values, degree, ball):
    """The eigenstrain ``values @ densities`` as monomials, for the oracle."""
    center, radius, _ = ball
    powers = [(i, j, k) for i in range(degree + 1) for j in range(degree + 1 - i) for k in range(degree + 1 - i - j)]
    places, _ = shape.density_rule((degree + 2, degree + 2, 2 * degree + 4))
    offset = (places - center) / radius
    monomials = np.stack([(offset ** np.array(power)).prod(axis=1) for power in powers], axis=1)
    amounts, *_ = np.linalg.lstsq(monomials, (values @ shape.densities(degree, *places.T)).T, rcond=None)
    tensors = np.zeros((len(powers), 3, 3))
    for column, ((i, j), factor) in zip(amounts.T, PAIRS, strict=True):
        tensors[:, i, j] = tensors[:, j, i] = column / factor
    terms = list(zip(powers, tensors, strict=True))
    return PolynomialEllipsoid(center=center, semi_axes=(radius,) * 3, terms=terms, count=16)


def residuals(balls, degree):
    """Largest difference of the stress by a ball's own constants from that in the body, over the remote stress."""
    shapes = [ec.make("sphere", kind="inclusion-shape", center=center, radius=radius) for center, radius, _ in balls]
    constants = [isotropic_stiffness(ratio * MATRIX.young_modulus, NU) for *_, ratio in balls]
    system = PolynomialInclusions(shapes, MATRIX, constants, [degree] * len(balls))
    load = np.repeat(mandel(REMOTE)[:, None], system.points.shape[1], axis=1)
    values = system.solve(system.moments(load), tolerance=1e-11).eigenstrain
    oracles = [oracle_of(shapes[n], values[:, :, n], degree, ball) for n, ball in enumerate(balls)]
    compliance = np.linalg.inv(isotropic_stiffness(MATRIX.young_modulus, NU))
    worst = 0.0
    for number, (center, radius, _) in enumerate(balls):
        points = center + radius * INSIDE
        stress = REMOTE + sum(oracle.stress(points, NU) for oracle in oracles)
        for own, eigenstrain in zip(stress, oracles[number].eigenstrain(points), strict=True):
            strain = compliance @ mandel(own) + mandel(eigenstrain)
            worst = max(worst, np.abs(constants[number] @ strain - mandel(own)).max())
    return worst / np.abs(REMOTE).max()


@pytest.mark.parametrize(
    ("balls", "degrees", "rate", "bound"),
    [
        pytest.param(UNEQUAL, (0, 2), 0.55, 0.06, id="unequal"),
        pytest.param(UNEQUAL, (2, 4), 0.55, 0.013, id="unequal, degree 4", marks=pytest.mark.slow),
        pytest.param(LEVEL, (1, 3, 5), 0.47, 0.001, id="equal radii", marks=pytest.mark.slow),
    ],
)
def test_hooke_law_in_both_balls(balls, degrees, rate, bound):
    """What is left falls per degree at least by the larger rate of reflections of each ball in the other.

    The rate is ``exp(-asinh(c / r))``, ``c² = [(D² - r² - s²)² - 4 r² s²] / (4 D²)`` of radii r, s at a distance D.
    """
    found = [residuals(balls, degree) for degree in degrees]
    assert all(after < rate**2 * before for before, after in pairwise(found))
    assert found[-1] < bound


def test_a_wrong_amount_is_left(monkeypatch):
    """Ten per cent too much of the eigenstrain is seen."""
    sound = PolynomialInclusions.eigenstrain
    monkeypatch.setattr(PolynomialInclusions, "eigenstrain", lambda *given: 1.1 * sound(*given))
    assert residuals(LEVEL, 1) > 0.1
