"""Stress intensity factors of edge cracks: published numbers, weights, symmetry, order of the error, elements."""

import numpy as np
import pytest

from close import close
from eigencontact.errors import SceneError
from eigencontact.solvers.edge_crack import EdgeCrack
from eigencontact_verification.fem.edge_crack import energy_release

#: K / (sigma sqrt(pi a)) of a crack along z, of the stress (z/a)^power on its faces.
NORMAL = {0: 1.1215, 1: 0.68286, 2: 0.52549}


def factors(angle, stress, nodes=200, length=1.0):
    """(K_I, K_II) / sqrt(pi a) of a uniform stress (xx, zz, xz)."""
    crack = EdgeCrack(angle, nodes=nodes)
    tensor = np.array([[stress[0], stress[2]], [stress[2], stress[1]]])
    ones = np.ones(nodes)
    traction = tensor @ crack.normal
    k = crack.intensity(ones * (traction @ crack.normal), ones * (traction @ crack.tangent), np.array(length))
    return k / np.sqrt(np.pi * length)


@pytest.mark.parametrize(("power", "expected"), NORMAL.items())
def test_a_crack_along_the_normal_has_the_published_factors(power, expected):
    crack = EdgeCrack(0.0)
    stress = crack.positions**power
    opening = crack.intensity(stress, np.zeros_like(stress), np.array(1.0)) / np.sqrt(np.pi)
    assert opening == close([expected, 0.0], rel=0, abs=3e-5)
    sliding = crack.intensity(np.zeros_like(stress), stress, np.array(1.0)) / np.sqrt(np.pi)
    assert sliding == close([0.0, expected], rel=0, abs=3e-5)


def test_a_crack_at_45_degrees_has_the_published_factors():
    """K = .705 and .364, Y. Murakami (ed.) 1987, Stress Intensity Factors Handbook, of tension along the surface."""
    assert factors(np.pi / 4, (1, 0, 0)) == close([0.705, 0.3645], rel=0, abs=5e-4)


@pytest.mark.parametrize("degrees", [10.0, 35.0, 60.0])
def test_the_mirrored_crack_has_the_mirrored_factors(degrees):
    angle = np.radians(degrees)
    right, left = factors(angle, (1.0, 0.3, 0.5)), factors(-angle, (1.0, 0.3, -0.5))
    assert left == close(right * [1, -1], rel=0, abs=1e-10)


def test_the_factor_grows_with_the_root_of_the_length():
    crack = EdgeCrack(0.3)
    stress = np.ones((3, crack.positions.size))
    k = crack.intensity(stress, 0.5 * stress, np.array([1.0, 4.0, 9.0]))
    np.testing.assert_allclose(k, k[:, :1] * [1, 2, 3], rtol=1e-13)


@pytest.mark.parametrize("degrees", [0.0, 30.0, 60.0])
def test_the_error_falls_with_the_square_of_the_number_of_dislocations(degrees):
    values = [factors(np.radians(degrees), (1, 0, 0), nodes)[0] for nodes in (50, 100, 200, 400)]
    steps = np.abs(np.diff(values))
    orders = np.log2(steps[:-1] / steps[1:])
    assert np.all((orders > 1.7) & (orders < 2.3))
    assert steps[-1] < 5e-4


@pytest.mark.parametrize("angle", [np.radians(70.0), -1.3, np.nan])
def test_a_crack_nearly_along_the_surface_is_refused(angle):
    with pytest.raises(SceneError, match=r"crack.inclination must be within -65 and 65 degrees"):
        EdgeCrack(angle)


@pytest.mark.slow
@pytest.mark.parametrize("degrees", [0.0, 30.0, 45.0])
def test_elements_release_the_same_energy(degrees):
    """J = (K_I^2 + K_II^2) (1 - nu^2) / E. The rate by energies is of first order in the size of the elements."""
    angle, poisson = np.radians(degrees), 0.3
    crack = EdgeCrack(angle)
    stress = crack.normal[0] ** 2, crack.normal[0] * crack.tangent[0]
    k = crack.intensity(*(np.full(crack.positions.size, value) for value in stress), np.array(1.0))
    expected = float((k**2).sum()) * (1 - poisson**2)
    coarse, fine = (energy_release(angle, *stress, poisson, cells) for cells in (6, 12))
    assert 1.7 < (coarse - expected) / (fine - expected) < 2.3
    assert 2 * fine - coarse == close(expected, rel=1e-3)
