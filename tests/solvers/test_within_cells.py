"""What is taken off between the middles of cells, against closed forms of what the cells stand for."""

import numpy as np
import pytest

from close import close
from eigencontact.solvers.cells import Cells
from eigencontact.solvers.eigenstrain import VolumeField
from eigencontact.solvers.within_cells import WithinCells
from eigencontact_plugins.shapes.cuboid import Cuboid

CELL = Cuboid(center=(0.0, 0.0, 1.0), edges=(1.0, 1.0, 1.0))
G, NU = 80.0, 0.3
#: Mandel stiffness of an isotropic body, written out.
LAME = 2.0 * G * NU / (1.0 - 2.0 * NU)
STIFFNESS = 2.0 * G * np.eye(6)
STIFFNESS[:3, :3] += LAME
#: Mandel components (xx, yy, zz, yz, xz, xy) with the normal of a layer across x, y, z in them.
ACROSS = ([0, 4, 5], [1, 3, 5], [2, 3, 4])


def within(cells, region, points, nu=NU):
    return WithinCells(cells, region, tuple(np.asarray(points, float).T), poisson_ratio=nu, shear_modulus=G)


@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize("component", range(6))
def test_is_the_answer_of_layers(axis, component):
    """A body of layers: no traction across them, and no strain in their plane, from what varies across them alone."""
    shape, place = (3, 3, 3), np.zeros(3)
    place[axis] = 0.3
    strain = np.zeros((6, *shape))
    strain[component] = np.moveaxis(np.broadcast_to([0.0, 1.0, 3.0], shape), 2, 2 - axis)
    found = within(Cells(first=(-1.0,) * 3, pitch=(1.0,) * 3, shape=shape), np.ones(shape, int), [place])
    too_much = np.zeros(6)
    too_much[component] = -0.3 * 2.0  # the cell has 1, the line to the next, with 3, has 1.6 there
    normal = ACROSS[axis]
    condensed = STIFFNESS - STIFFNESS[:, normal] @ np.linalg.solve(STIFFNESS[np.ix_(normal, normal)], STIFFNESS[normal])
    stress = -condensed @ too_much
    strain_there = too_much + np.linalg.solve(STIFFNESS, stress)
    np.testing.assert_allclose(found.difference("stress", strain)[:, 0], -stress, atol=1e-12 * G)
    np.testing.assert_allclose(found.difference("strain", strain)[:, 0], -strain_there, atol=1e-14)


def ball_of_linear_swelling(points, radius):
    """Stress inside a ball that swells by x in an unbounded body (Goodier's potential), Mandel ``(6, n)``.

    The potential x (r²/10 - R²/6) has the Laplacian x within the ball, and goes on smoothly to one of x/r³.
    """
    x, y, z = points.T
    scale, zero = 2.0 * G * (1.0 + NU) / (1.0 - NU) / 5.0, np.zeros_like(x)
    assert np.all(x**2 + y**2 + z**2 < radius**2)
    root = np.sqrt(2.0)
    # 2 G k (phi,ij - δij phi,kk) of the potential.
    return scale * np.array([3 * x - 5 * x, x - 5 * x, x - 5 * x, zero, root * z, root * y])


def test_linear_swelling_of_a_ball():
    n, radius = 15, 1.0
    d = 2.0 * radius / n
    middles = (np.arange(n + 2) - 0.5 * (n + 1)) * d
    z, y, x = np.meshgrid(middles, middles, middles, indexing="ij")
    fine = (np.arange(8) - 3.5) / 8.0 * d
    share = np.mean(
        [(x + a) ** 2 + (y + b) ** 2 + (z + c) ** 2 < radius**2 for a in fine for b in fine for c in fine], axis=0
    )
    strain = np.zeros((6, *x.shape))
    strain[:3] = share * x
    cells = Cells(first=(middles[0],) * 3, pitch=(d,) * 3, shape=x.shape)
    offset = np.array([0.31, -0.44, 0.23]) * d  # of the points from the middles of their cells
    target = Cells(first=tuple(middles[0] + offset), pitch=(d,) * 3, shape=x.shape)
    stress = VolumeField(CELL, cells, target, poisson_ratio=NU, shear_modulus=G, space="full").apply(strain)
    points = np.stack([x.ravel(), y.ravel(), z.ravel()], axis=1) + offset
    added = within(cells, (share == 1.0).astype(int), points).difference("stress", strain)
    inner = np.linalg.norm(points, axis=1) < 0.6 * radius
    expected = ball_of_linear_swelling(points[inner], radius)
    largest = np.abs(expected).max()
    before = np.abs(stress.reshape(6, -1)[:, inner] - expected).max() / largest
    after = np.abs((stress.reshape(6, -1) + added)[:, inner] - expected).max() / largest
    assert before > 0.08
    assert after < 0.003


def test_stays_in_a_region_and_is_the_mean_on_its_faces():
    shape = (1, 1, 4)
    cells = Cells(first=(0.0, 0.0, 0.0), pitch=(1.0, 1.0, 1.0), shape=shape)
    strain = np.zeros((6, *shape))
    strain[1] = [0.0, 1.0, 10.0, 30.0]
    x = [-0.4, 0.0, 0.4, 0.5, 0.6, 1.25, 1.75, 2.4, 3.3, 3.6]
    points = [[at, 0.1, 0.1] for at in x]
    found = within(cells, np.array([1, 1, 2, 0]).reshape(shape), points).difference("stress", strain)[1]
    layer = 2.0 * G / (1.0 - NU)
    # Beside another region the line is that to the cell behind; a cell alone, and one of none, stays as it is.
    expected = layer * np.array([0.4, 0.0, -0.4, 0.0, 0.4, -0.25, 0.0, 0.0, 0.0, 0.0])
    np.testing.assert_allclose(found, expected, atol=1e-12 * layer)


def test_faces_count_half_to_either_side():
    shape = (1, 1, 2)
    cells = Cells(first=(0.0, 0.0, 0.0), pitch=(1.0, 1.0, 1.0), shape=shape)
    strain = np.zeros((6, *shape))
    strain[1] = [1.0, 5.0]
    inside, outside = np.array([1, 1]).reshape(shape), np.array([1, 0]).reshape(shape)
    assert within(cells, inside, [[0.5, 0.0, 0.0]]).difference("stress", strain)[1, 0] == close(0.0, abs=1e-12)
    assert not within(cells, outside, [[0.5, 0.0, 0.0]]).difference("stress", strain).any()


def test_incompressible_bodies_are_ordinary():
    shape = (1, 1, 2)
    cells = Cells(first=(0.0, 0.0, 0.0), pitch=(1.0, 1.0, 1.0), shape=shape)
    strain = np.zeros((6, *shape))
    strain[1, ..., 1] = 1.0
    found = within(cells, np.ones(shape, int), [[0.25, 0.0, 0.0]], nu=0.5).difference("stress", strain)[:, 0]
    np.testing.assert_allclose(found, [0.0, -G, -0.5 * G, 0, 0, 0], atol=1e-12 * G)
