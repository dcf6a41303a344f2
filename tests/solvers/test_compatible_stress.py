"""Projection of a stress in cells onto those of an elastic body: what is kept, what is taken off."""

import numpy as np
import pytest

from close import close
from eigencontact.solvers.compatible_stress import CompatibleStress

PITCH = (0.5, 0.8, 0.6)
SHAPE = (7, 6, 8)


def isotropic(nu):
    """Mandel stiffness for E = 3."""
    out = 3.0 / (1 + nu) * np.eye(6)
    out[:3, :3] += 3.0 * nu / ((1 + nu) * (1 - 2 * nu))
    return out


def any_stiffness():
    root = np.random.default_rng(4).normal(size=(6, 6))
    return root @ root.T + np.eye(6)


def share_of_ball():
    z, y, x = (np.arange(n) + 0.5 - 0.5 * n for n in SHAPE)
    reach = np.sqrt((z[:, None, None] / 3) ** 2 + (y[None, :, None] / 2.5) ** 2 + (x[None, None, :] / 3.5) ** 2)
    return np.clip(3.0 * (1.0 - reach), 0.0, 1.0)


def middles():
    """x, y, z of the middles of cells, ``(nz, ny, nx)``."""
    axes = [(np.arange(n) + 0.5 - 0.5 * n) * d for n, d in zip(SHAPE, PITCH[::-1], strict=True)]
    z, y, x = np.meshgrid(*axes, indexing="ij")
    return x, y, z


@pytest.mark.parametrize(
    "stiffness", [isotropic(0.3), isotropic(0.4999), any_stiffness()], ids=["0.3", "0.4999", "any"]
)
def test_a_uniform_stress_is_kept(stiffness):
    """Any one is compatible; shares of cells are weights of both sides."""
    stress = np.random.default_rng(1).normal(size=6)
    share = share_of_ball()
    assert np.any((share > 0.0) & (share < 1.0))
    found = CompatibleStress(share, stiffness, PITCH).of(np.broadcast_to(stress.reshape(6, 1, 1, 1), (6, *SHAPE)))
    np.testing.assert_allclose(
        found[:, share > 0.0].T, np.broadcast_to(stress, (np.count_nonzero(share), 6)), atol=1e-3
    )
    assert not found[:, share == 0.0].any()


@pytest.mark.parametrize("nu", [0.0, 0.3])
def test_bending_is_kept(nu):
    """A beam along x in pure bending: σ_xx = z, a displacement of second degree; exact but for the finite cells."""
    stress = np.zeros((6, *SHAPE))
    stress[0] = middles()[2]
    found = CompatibleStress(np.ones(SHAPE), isotropic(nu), PITCH).of(stress)
    assert np.abs(found - stress)[:, 2:-2, 2:-2, 2:-2].max() < 0.05 * np.abs(stress).max()


def test_a_stress_without_tractions_is_taken_off():
    """σ_yy = φ,zz, σ_zz = φ,yy, σ_yz = -φ,yz of Airy's φ that vanishes with its slope on the boundary of a bar.

    Such a stress has no virtual work with any displacement, and as the values of a body of finite elements it is small.
    """
    n = 24
    at = (np.arange(n) + 0.5) / n * 2.0 - 1.0
    z, y = at[:, None, None], at[None, :, None]

    def hump(s):
        return (1 - s**2) ** 2, -4 * s * (1 - s**2), -4 + 12 * s**2

    (fz, dz, ddz), (fy, dy, ddy) = hump(z), hump(y)
    stress = np.zeros((6, n, n, 4))
    stress[1], stress[2], stress[3] = ddz * fy, fz * ddy, -np.sqrt(2.0) * dz * dy
    found = CompatibleStress(np.ones((n, n, 4)), isotropic(0.3), (1.0 / n,) * 3).of(stress)
    assert np.abs(found).max() < 0.02 * np.abs(stress).max()


def test_it_is_linear_wherever_it_starts():
    """The displacement of the last stress is the start for the next."""
    projection = CompatibleStress(share_of_ball(), any_stiffness(), PITCH)
    one, other = np.random.default_rng(2).normal(size=(2, 6, *SHAPE))
    apart = projection.of(one) + 3.0 * projection.of(other)
    whole = share_of_ball() > 0.3
    assert np.abs(projection.of(one + 3.0 * other) - apart)[:, whole].max() < 1e-3 * np.abs(apart).max()
    assert np.abs(projection.of(0.0 * one)).max() == close(0.0, abs=1e-3 * np.abs(apart).max())
