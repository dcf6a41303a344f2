"""Values between the middles of cells, their continuation into cut cells, normals, and the step across a boundary."""

import numpy as np
import pytest

from eigencontact.core.material import Material
from eigencontact.solvers.beside_boundaries import Between, continued, outer_stress, outward
from eigencontact.solvers.cells import Cells

CELLS = Cells(first=(-1.0, 0.5, 0.25), pitch=(0.5, 1.0, 0.25), shape=(6, 5, 7))
MATRIX = Material(young_modulus=2.0, poisson_ratio=0.3)


def lattice():
    z, y, x = np.meshgrid(CELLS.centres(2), CELLS.centres(1), CELLS.centres(0), indexing="ij")
    return x, y, z


def linear(x, y, z):
    return np.array([1.0 + 2.0 * x - y + 0.5 * z, z - 3.0 * x])


def points(count=40):
    rng = np.random.default_rng(0)
    low = [CELLS.centres(axis)[0] for axis in range(3)]
    high = [CELLS.centres(axis)[-1] for axis in range(3)]
    x, y, z = (rng.uniform(lo, hi, count) for lo, hi in zip(low, high, strict=True))
    z[:10] = np.linspace(0.0, 0.25, 10)  # above the first middles
    return x, y, z


def test_linear_fields_are_exact_up_to_the_surface():
    at = points()
    found = Between(CELLS, at).values(linear(*lattice()), np.arange(at[0].size))
    np.testing.assert_allclose(found, linear(*at), atol=1e-12)


def test_points_on_middles_and_faces_know_their_cells():
    x, y, z = CELLS.centres(0), CELLS.centres(1), CELLS.centres(2)
    at = (np.array([x[2] + 1e-12, x[2] + 0.25]), np.array([y[1], y[1]]), np.array([z[3], z[3]]))
    between = Between(CELLS, at)
    middle = np.ravel_multi_index((3, 1, 2), CELLS.shape)
    assert set(between.about[:, 0].tolist()) == {middle}
    assert set(between.on[:, 0].tolist()) == {middle}
    assert set(between.on[:, 1].tolist()) == {middle, middle + 1}


def test_continuation_is_straight():
    """Cells without a value have that of the linear field through the others, but for the share drawn to the mean."""
    values = linear(*lattice())
    weight = np.ones(CELLS.shape)
    weight[:, :, 5:] = 0.0
    where = np.ravel_multi_index((np.array([2, 3]), np.array([2, 1]), np.array([5, 5])), CELLS.shape)
    wrong = values.copy()
    wrong[:, :, :, 5:] = 1e3
    found = continued(wrong, weight, where)
    np.testing.assert_allclose(found, values.reshape(2, -1)[:, where], atol=0.01 * np.abs(values).max())


def test_a_region_of_one_layer_goes_on_level():
    values, weight = np.full((1, 5, 5, 5), 7.0), np.zeros((5, 5, 5))
    weight[2] = 1.0
    values[:, weight == 0.0] = np.nan_to_num(1e9)
    found = continued(values, weight, np.array([np.ravel_multi_index((3, 2, 2), (5, 5, 5))]))
    np.testing.assert_allclose(found, 7.0)


@pytest.mark.parametrize(("pitch", "bound"), [((1.0, 1.0, 1.0), 3.0), ((1.0, 1.0, 0.5), 8.0)])
def test_normals_of_a_ball(pitch, bound):
    """Degrees, 5 cells a radius; differences of next neighbours alone are off by 14 degrees in cubes."""
    n, radius = 16, 5.3
    axes = [(np.arange(n * int(1.0 / d)) + 0.5) * d - 0.5 * n for d in pitch[::-1]]
    z, y, x = np.meshgrid(*axes, indexing="ij")
    parts = (np.arange(6) + 0.5) / 6 - 0.5
    share = np.mean(
        [
            (x + a * pitch[0]) ** 2 + (y + b * pitch[1]) ** 2 + (z + c * pitch[2]) ** 2 < radius**2
            for a in parts for b in parts for c in parts
        ],
        axis=0,
    )  # fmt: skip
    normal = outward(share, pitch, flush=False)
    cut = (share > 0.0) & (share < 1.0)
    place = np.array([x, y, z])[:, cut]
    way, out = (vectors / np.linalg.norm(vectors, axis=0) for vectors in (normal[:, cut], place))
    angles = np.rad2deg(np.arccos((way * out).sum(axis=0)))
    assert angles.max() < bound
    assert not normal[:, share == 1.0][:, np.linalg.norm([x, y, z], axis=0)[share == 1.0] < radius - 3.0].any()


def test_a_region_goes_on_above_the_surface():
    share = np.ones((3, 3, 3))
    assert not outward(share, (1.0, 1.0, 1.0), flush=True)[2, 0, 1, 1]
    assert outward(share, (1.0, 1.0, 1.0), flush=False)[2, 0, 1, 1] < 0.0


def test_the_step_leaves_traction_and_strain_in_the_plane():
    """From the inside, F, to the outside: e = M F + E there, M (F + T E) here."""
    normal, eigenstrain = np.array([0.0, 0.0, 2.0]), np.array([1.0, -0.4, 0.7, 0.2, 0.3, -0.6])
    stress = np.array([0.3, 0.1, -0.2, 0.5, 0.4, 0.9])
    found = outer_stress(stress[:, None], eigenstrain[:, None], normal[:, None], MATRIX)[:, 0]
    np.testing.assert_allclose(found[[2, 3, 4]], stress[[2, 3, 4]], atol=1e-14)
    compliance = 1.3 * np.eye(6)
    compliance[:3, :3] -= 0.3
    inside, outside = compliance / 2.0 @ stress + eigenstrain, compliance / 2.0 @ found
    np.testing.assert_allclose(outside[[0, 1, 5]], inside[[0, 1, 5]], atol=1e-14)


def test_without_a_boundary_nothing_steps():
    stress = np.ones((6, 1))
    np.testing.assert_array_equal(outer_stress(stress, np.ones((6, 1)), np.zeros((3, 1)), MATRIX), stress)
