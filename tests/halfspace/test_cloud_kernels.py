"""Compiled sums over point sources against the potentials of a ball, which is one point source outside."""

import numpy as np
import pytest

import eigencontact as ec
from eigencontact.core.tensors import from_mandel, to_mandel
from eigencontact.halfspace.points import field_at_points

pytest.importorskip("numba")
from eigencontact.halfspace.cloud_kernels import sum_sources

NU, RADIUS, CENTER = 0.3, 0.2, np.array([0.1, -0.2, 0.7])
BALL = ec.make("sphere", kind="inclusion-shape", center=tuple(CENTER), radius=RADIUS)
STRAIN = np.array([0.3, -1.0, 0.7, 0.4, -0.6, 0.5])
NO_TREE = (np.zeros((0, 5)), np.zeros(0, dtype=np.intp), 0.0)


def summed(points, components, half, least=0.0):
    """Sum in two blocks of points; `least` is the least distance of the region."""
    volume = 4.0 / 3.0 * np.pi * RADIUS**3
    scale = volume * (1.0 if components == 3 else 2.0) / (8.0 * np.pi * (1.0 - NU))
    rows = np.array([[*CENTER, scale, RADIUS**2 / 5.0, *from_mandel(STRAIN)]])
    sources = (rows, np.array([[*CENTER, 0.0, least]]), np.array([0, 1]), np.array([[least**2, 0.0, 1.0]]))
    count = points.shape[1]
    blocks = np.array([[0, count // 2, -1, 0], [count // 2, count, -1, 0]])
    out = np.zeros((components, count))
    sum_sources(*np.ascontiguousarray(points), blocks, NO_TREE, sources, NU, half, out)
    return out


@pytest.mark.parametrize(("quantity", "components"), [("stress", 6), ("displacement", 3)])
@pytest.mark.parametrize(("space", "half"), [("half", True), ("full", False)])
def test_one_source_is_a_ball_seen_from_outside(quantity, components, space, half):
    points = np.random.default_rng(2).uniform([-1, -1, 0], [1, 1, 2], (60, 3)).T
    points = points[:, np.linalg.norm(points.T - CENTER, axis=1) > 1.1 * RADIUS]
    expected = field_at_points(BALL, STRAIN, tuple(points), poisson_ratio=NU, quantity=quantity, space=space)
    found = summed(points, components, half)
    found = found if quantity == "displacement" else to_mandel(found)
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-12 * np.abs(expected).max())


def test_points_closer_than_the_least_distance_get_nothing():
    points = CENTER[:, None] + np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.1, 0.24, 0.26]])
    found = summed(points, 6, False, least=0.25)
    assert not found[:, :2].any()
    np.testing.assert_allclose(found[:, 2], summed(points, 6, False)[:, 2], rtol=1e-13)
