"""Whole inclusions of every degree against the oracle of multipoles, which knows neither eigenstrain nor potentials."""

import numpy as np
import pytest

import eigencontact as ec
from eigencontact.core.elasticity import isotropic_stiffness
from eigencontact.core.material import Material
from eigencontact.core.tensors import INDICES, to_mandel, to_matrix
from eigencontact.halfspace.moments import moment_field
from eigencontact.solvers.polynomial_inclusions import PolynomialInclusions
from eigencontact_verification.oracles.ball_multipoles import BallMultipoles, remote_field, tension

NU, INNER_NU = 0.3, 0.2
#: Twice the shear modulus is 1, as in the oracle.
MATRIX = Material(young_modulus=1.0 + NU, poisson_ratio=NU)
RIGID = 1e11
#: Axis of revolution; in a half-space it is z.
AXES = {"z": np.eye(3), "oblique": np.linalg.qr(np.array([[0.3, 1.0, 0.2], [-1.0, 0.4, 0.5], [0.6, 0.2, 0.9]]))[0]}


def stiffness(ratio, inner_nu):
    """Of a ball with a ratio of shear moduli."""
    ratio = min(ratio, RIGID)
    return isotropic_stiffness(ratio * (1.0 + inner_nu), inner_nu) if ratio else np.zeros((6, 6))


def tensors(field, turn, angle):
    """Stress ``(n, 3, 3)`` of the six of the oracle at an angle about the axis, the last column of `turn`."""
    s_rr, s_tt, s_zz, s_rz = field[2:]
    polar = np.zeros((len(s_rr), 3, 3))
    polar[:, 0, 0], polar[:, 1, 1], polar[:, 2, 2], polar[:, 0, 2], polar[:, 2, 0] = s_rr, s_tt, s_zz, s_rz, s_rz
    frame = np.zeros((len(s_rr), 3, 3))
    frame[:, 0, 0], frame[:, 1, 0], frame[:, 0, 1] = np.cos(angle), np.sin(angle), -np.sin(angle)
    frame[:, 1, 1], frame[:, 2, 2] = np.cos(angle), 1.0
    return np.einsum("ai,nij,njk,nlk,bl->nab", turn, frame, polar, frame, turn)


def stress_at(load, turn, points):
    """Stress of a load of revolution at Cartesian points ``(n, 3)`` from the ball's centre."""
    local = points @ turn
    return tensors(load(np.hypot(local[:, 0], local[:, 1]), local[:, 2]), turn, np.arctan2(local[:, 1], local[:, 0]))


def worst(ratio, degree, load, *, turn=AXES["z"], boundary="none", depth=2.0, oracle_degree=None, inner_nu=INNER_NU):
    """Largest difference of the stress outside from the oracle's, over the largest change by the balls."""
    oracle = BallMultipoles(
        nu=NU, ratio=ratio, inner_nu=inner_nu, degree=degree if oracle_degree is None else oracle_degree,
        boundary=boundary, depth=depth,
    )  # fmt: skip
    half = boundary == "free"
    centers = [np.array([0.0, 0.0, depth if half else 0.0])]
    if boundary == "mirror":
        centers.append(centers[0] - 2 * depth * turn[:, 2])
    balls = [ec.make("sphere", kind="inclusion-shape", center=tuple(center), radius=1.0) for center in centers]
    constants = stiffness(ratio, inner_nu)
    space = "half" if half else "full"
    system = PolynomialInclusions(balls, MATRIX, [constants] * len(balls), [degree] * len(balls), space=space)
    here = stress_at(load, turn, system.points.T - centers[0])
    answer = system.solve(system.moments(to_mandel([here[:, i, j] for i, j in INDICES])), tolerance=1e-13)
    r, z = np.array([1.0, 0.7, 0.2, 1.9]), np.array([0.4, -0.9, 1.3, -1.0])
    angle = np.array([0.3, 1.7, -2.0, 0.9])
    points = np.stack([r * np.cos(angle), r * np.sin(angle), z], axis=1) @ turn.T + centers[0]
    found = 0.0
    for number, ball in enumerate(balls):
        field = moment_field(
            ball, answer.eigenstrain[:, :, number], tuple(points.T), degree=degree, poisson_ratio=NU, quantity="stress",
            space=space,
        )  # fmt: skip
        found = found + to_matrix(field * MATRIX.shear_modulus)
    expected = tensors(oracle.field(load, r, z), turn, angle) - stress_at(load, turn, points - centers[0])
    return np.abs(found - expected).max() / np.abs(expected).max()


@pytest.mark.parametrize("axis", ["oblique", pytest.param("z", marks=pytest.mark.slow)])
@pytest.mark.parametrize("ratio", [0.0, 0.1, 2.0, np.inf])
@pytest.mark.parametrize("degree", [0, 1, 2, 3])
def test_remote_stress_of_a_degree_is_answered_exactly_at_that_degree(degree, ratio, axis):
    for l, family in ((degree, 1), (degree + 2, 0)):
        assert worst(ratio, degree, remote_field(l, family, NU), turn=AXES[axis], oracle_degree=degree + 4) < 1e-10


def test_a_degree_too_low_is_seen():
    assert worst(2.0, 1, remote_field(2, 1, NU), oracle_degree=6) > 1e-2


def across(r, z):
    """Tension 1 in the plane, which leaves the surface free."""
    zero = np.zeros_like(r)
    return np.stack([(1 - NU) * r / (1 + NU), -2 * NU * z / (1 + NU), zero + 1.0, zero + 1.0, zero, zero])


SURFACE = [(2.0, 1.3, 3), (0.0, 1.5, 2), (np.inf, 1.5, 3), pytest.param(0.1, 1.15, 6, marks=pytest.mark.slow)]


@pytest.mark.parametrize(("ratio", "depth", "degree"), SURFACE)
def test_every_degree_below_a_surface(ratio, depth, degree):
    for lower in range(degree + 1):
        assert worst(ratio, lower, across, boundary="free", depth=depth, inner_nu=NU) < 1e-10


PAIRS = [
    (2.0, 0.5, 3, "oblique"),
    (0.0, 0.5, 3, "z"),
    (np.inf, 0.5, 3, "z"),
    pytest.param(10.0, 0.2, 5, "z", marks=pytest.mark.slow),
]


@pytest.mark.parametrize(("ratio", "gap", "degree", "axis"), PAIRS)
def test_every_degree_of_two_balls(ratio, gap, degree, axis):
    for lower in range(degree + 1):
        difference = worst(
            ratio, lower, tension(NU), turn=AXES[axis], boundary="mirror", depth=1 + gap / 2, inner_nu=NU
        )
        assert difference < 1e-10
